//! Sketch files: run once, laid out in every run.
//!
//! `load "dam.skt"` runs the commands of the file and keeps its objects. Each run of the model then
//! computes their coordinates from the present values of the dimensions, which are parameters, and
//! declares ordinary objects: points, lines, curves, faces, the solid.

use super::sketch_numbers::{NumberPlaces, literals};
use crate::World;
use moldloft_diag::{Diagnostic, FileId, Span};
use moldloft_sketch::{
    DimensionRole, Estimate, Files, Planes, SketchObject, SketchSession, json_format,
};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Files that a sketch may read through one another.
const MOST_FILES: usize = 32;

/// More refused commands than this are not reported one by one.
const MOST_FAULTS: usize = 100;

/// A file of sketches after its commands have run.
#[derive(Debug)]
pub struct SketchFile {
    /// The name that the world gave it.
    pub path: String,
    /// Its text.
    pub file: FileId,
    /// Its objects.
    pub objects: Vec<Drawn>,
    /// Refused commands and warnings.
    pub faults: Vec<Diagnostic>,
}

/// A sketched object with the data that depend on its drawing only.
#[derive(Debug)]
pub struct Drawn {
    /// The object.
    pub object: SketchObject,
    /// Its dimensioning planes.
    pub planes: Planes,
    /// True if it is a result of the file and not only an operand.
    pub result: bool,
    /// Where the text states its numbers, by their keys.
    places: BTreeMap<String, Span>,
    estimate: OnceLock<Option<Estimate>>,
}

impl Drawn {
    /// Depths estimated from the picture, computed on first use.
    pub fn estimate(&self) -> Option<Estimate> {
        let drawing = &self.object.drawing;
        let compute =
            || Estimate::of(drawing, &self.planes, self.object.reference().map(|r| r.point)?);
        self.estimate.get_or_init(compute).clone()
    }

    /// The numbers that become parameters of the model (driving dimensions, and variables that are
    /// plain numbers), as key, name, value and range.
    pub fn parameters(&self) -> impl Iterator<Item = (&String, &String, f64, Option<[f64; 2]>)> {
        let variables = (self.object.variables.iter())
            .filter_map(|(key, v)| Some((key, &v.name, v.value.literal()?, v.range)));
        let dimensions = (self.object.dimensions.iter())
            .filter(|(_, d)| d.role == DimensionRole::Driving)
            .filter_map(|(key, d)| Some((key, &d.name, d.value.as_ref()?.literal()?, d.range)));
        variables.chain(dimensions)
    }

    /// Where the text states a number; `None` if another file or an expression does.
    pub fn place(&self, key: &str) -> Option<Span> {
        self.places.get(key).copied()
    }
}

/// True for the names of sketch files.
pub fn is_sketch(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    name.ends_with(".skt") || name.ends_with(".skt.json")
}

/// Files read by a session, and files that it requested.
#[derive(Debug, Default)]
struct Shelf {
    read: BTreeMap<String, Result<Arc<[u8]>, String>>,
    wanted: Option<String>,
}

struct ShelfFiles(Arc<Mutex<Shelf>>);

impl Files for ShelfFiles {
    fn read(&self, name: &str) -> Result<String, String> {
        let bytes = self.font(name)?;
        let text = moldloft_syntax::decode(&bytes, name).map_err(|d| d.message.clone())?;
        Ok(text.to_string())
    }

    fn font(&self, name: &str) -> Result<Arc<[u8]>, String> {
        let mut shelf = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = shelf.read.get(name) {
            return known.clone();
        }
        shelf.wanted.get_or_insert_with(|| name.to_owned());
        Err("it has not been read yet".to_owned())
    }
}

impl SketchFile {
    /// Runs the commands of a text. Other files are read through `world`, relative to this one.
    pub fn open(path: &str, text: &str, file: FileId, world: &dyn World) -> SketchFile {
        let shelf = Arc::new(Mutex::new(Shelf::default()));
        let whole = Span::new(file, 0, text.find('\n').unwrap_or(text.len()) as u32);
        let script = if text.trim_start().starts_with(['{', '[']) {
            match json_format::from_json(text) {
                Ok(script) => Some(script),
                Err(why) => {
                    let fault = Diagnostic::error("no-sketch", format!("not a sketch: {why}"))
                        .at(whole)
                        .help("SAVE writes files that can be read");
                    return SketchFile {
                        path: path.into(),
                        file,
                        objects: Vec::new(),
                        faults: vec![fault],
                    };
                }
            }
        } else {
            None
        };
        // A session cannot wait for files, so it is run again with each file that it requests.
        for _ in 0..=MOST_FILES {
            let mut session = SketchSession::with_files(Box::new(ShelfFiles(shelf.clone())));
            let mut faults = Vec::new();
            let commands = script.as_deref().unwrap_or(text);
            let mut at = 0;
            let mut places = NumberPlaces::default();
            for line in commands.split_inclusive('\n') {
                let start = at;
                at += line.len();
                let line = line.trim_end_matches(['\n', '\r']);
                let span = match script {
                    Some(_) => whole,
                    None => Span::new(file, start as u32, (start + line.len()) as u32),
                };
                faults.extend(session.run_line(line).into_iter().filter_map(|r| reported(r, span)));
                if let (None, Some(object)) = (&script, session.active_object()) {
                    places.take(object, line, start);
                }
                if session.over() {
                    break;
                }
            }
            let wanted = shelf.lock().unwrap_or_else(PoisonError::into_inner).wanted.take();
            let Some(name) = wanted else {
                let beyond = faults.len().saturating_sub(MOST_FAULTS);
                faults.truncate(MOST_FAULTS);
                if beyond > 0 {
                    let text = format!("{beyond} more replies of the sketch are not listed");
                    faults.push(Diagnostic::warning("too-many-errors", text).at(whole));
                }
                let names = session.names();
                let all: Vec<&SketchObject> =
                    names.iter().filter_map(|name| session.object(name)).collect();
                let objects: Vec<Drawn> = (all.iter().zip(moldloft_sketch::results(&all)))
                    .map(|(&object, result)| Drawn {
                        planes: Planes::of(&object.drawing),
                        object: object.clone(),
                        result,
                        places: stated(object, &places, text, file),
                        estimate: OnceLock::new(),
                    })
                    .collect();
                faults.extend(different_units(&objects).map(|fault| fault.at(whole)));
                return SketchFile { path: path.into(), file, objects, faults };
            };
            let read = world.read(&name, Some(path)).map(|r| r.bytes).map_err(|e| e.message);
            shelf.lock().unwrap_or_else(PoisonError::into_inner).read.insert(name, read);
        }
        let fault = Diagnostic::error("too-many-files", "the sketch reads too many files")
            .at(whole)
            .expected(format!("at most {MOST_FILES} files"));
        SketchFile { path: path.into(), file, objects: Vec::new(), faults: vec![fault] }
    }

    /// The unit of length of the objects, spelled as in models; `None` if not stated.
    pub fn unit(&self) -> Option<String> {
        let stated = self.objects.iter().find_map(|drawn| drawn.object.units.as_ref())?;
        Some(stated.to_ascii_lowercase())
    }

    /// The name of an object in the model: the name of the file if it has only this object of that
    /// name, otherwise the object's name.
    pub fn prefix(&self, drawn: &Drawn) -> String {
        let base = self.path.rsplit(['/', '\\']).next().unwrap_or(&self.path);
        let stem = base.split('.').next().unwrap_or(base);
        let name = &drawn.object.name;
        let chosen =
            if self.objects.len() == 1 && stem.eq_ignore_ascii_case(name) { stem } else { name };
        crate::model_file::names::identifier(chosen)
    }
}

/// Where a text states the plain numbers of an object, by their keys.
fn stated(
    object: &SketchObject,
    places: &NumberPlaces,
    text: &str,
    file: FileId,
) -> BTreeMap<String, Span> {
    let one = |(key, value): (&String, f64)| {
        let range = places.of(&object.name, key, value, text)?;
        Some((key.clone(), Span::new(file, range.start as u32, range.end as u32)))
    };
    literals(object).filter_map(|(key, _, value)| one((key, value))).collect()
}

/// The fault of objects whose numbers are not of one unit: together they are no model.
fn different_units(objects: &[Drawn]) -> Option<Diagnostic> {
    let mut stated =
        objects.iter().filter_map(|d| Some((&d.object.name, d.object.units.as_ref()?)));
    let (first, unit) = stated.next()?;
    let (other, another) = stated.find(|(_, other)| *other != unit)?;
    let message = format!("`{first}` is in {unit}, `{other}` in {another}");
    Some(
        Diagnostic::error("units-differ", message)
            .expected("one unit for all objects of a sketch")
            .help(format!("SET UNITS {unit} CONVERT in `{other}` converts its numbers")),
    )
}

/// A reply as a diagnostic; notes are nothing wrong.
fn reported(reply: moldloft_sketch::CommandReply, span: Span) -> Option<Diagnostic> {
    let code = reply.code.map_or(String::new(), |c| format!(" [{c}]"));
    let text = format!("{}{code}", reply.text);
    let diagnostic = match reply.severity {
        moldloft_diag::Severity::Error => Diagnostic::error("refused-command", text),
        moldloft_diag::Severity::Warning => Diagnostic::warning("sketch", text),
        _ => return None,
    };
    Some(diagnostic.at(span).maybe_help(reply.next))
}
