//! Sketches: a session of the command language.

use crate::arrays;
use crate::error::{plain_error, unknown_name};
use crate::work::interruptible;
use moldloft::brep::Brep;
use moldloft::budget::Budget;
use moldloft::diag::Severity;
use moldloft::font::SYSTEM_FONT;
use moldloft::host::{FileWorld, read_regular, system_font};
use moldloft::io::step::{self, Protocol, StepHeader};
use moldloft::lang::World;
use moldloft::mesh::Mesh;
use moldloft::num::Vec3;
use moldloft::picture::{Camera, Options, StyledPolyline, render};
use moldloft::sketch::command::words::{CommandToken, TextCommand, text_commands};
use moldloft::sketch::{
    CommandReply, CoordinateAxis, DimensionMark, DrawingHit, Files, Free, ObjectChange, PenSample,
    PointId, ReplySubject, SketchCommand, SketchSession, SketchSolid, Snap, StrokeFault,
    StrokePiece, Suggestion, TypeProposal, drawable_faces, fit_stroke, pen_positions, scripts,
};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::PyBytes;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Edges on pictures: dark grey.
const EDGE_COLOUR: [u8; 3] = [0x30, 0x36, 0x40];

/// In picture points.
const EDGE_WIDTH: f32 = 1.5;

/// Reads files named by the user: beside the running script first, then from the current folder.
/// Files named in the lines of a file are read as in a model: inside the folder only.
struct Disk {
    folder: Option<PathBuf>,
    confined: Arc<AtomicBool>,
}

impl Files for Disk {
    fn read(&self, name: &str) -> Result<String, String> {
        match std::str::from_utf8(&self.font(name)?) {
            Ok(text) => Ok(text.to_owned()),
            Err(_) => Err("it is not UTF-8 text".into()),
        }
    }

    fn font(&self, name: &str) -> Result<Arc<[u8]>, String> {
        if let Some(font) = name.strip_prefix(SYSTEM_FONT) {
            return system_font(font);
        }
        if self.confined.load(Ordering::Relaxed) {
            let folder = self.folder.clone().unwrap_or_else(|| PathBuf::from("."));
            let from = folder.join("sketch");
            let read = FileWorld::new(Some(&folder), &[]).read(name, from.to_str());
            return read.map(|read| read.bytes).map_err(|error| error.message);
        }
        let beside = self.folder.iter().map(|f| f.join(name)).find(|p| p.exists());
        let path = beside.unwrap_or_else(|| PathBuf::from(name));
        read_regular(&path).map(Into::into).map_err(|fault| fault.to_string())
    }

    fn step(&self, brep: &Brep, title: &str, metres: f64) -> Result<Vec<u8>, String> {
        let version = env!("CARGO_PKG_VERSION");
        let header = StepHeader { title, metres, version, protocol: Protocol::Ap242 };
        step::write(brep, &header).map_err(|error| error.to_string())
    }
}

/// A dimension that the picture suggests: axis, from, to, value, and whether the depth is a guess.
type Suggested = (String, u32, u32, f64, bool);

/// Subject of a reply: kind, points, lines, faces, names, axis, value, position, suggestion.
type About = (
    &'static str,
    Vec<u32>,
    Vec<u32>,
    Vec<u32>,
    Vec<String>,
    Option<String>,
    Option<f64>,
    Option<[f64; 3]>,
    Option<Suggested>,
);

/// A reply: severity, code, text, next step, a file to write, and its subject.
type Answer<'py> = (
    &'static str,
    Option<u16>,
    String,
    Option<String>,
    Option<(String, Bound<'py, PyBytes>)>,
    Option<About>,
);

/// A dimension on the page: name, text, value, whether it only measures, axis, position of the text, dimension line,
/// witness lines.
type Mark = (
    String,
    String,
    Option<f64>,
    bool,
    Option<String>,
    [f64; 2],
    Option<[[f64; 2]; 2]>,
    Vec<[[f64; 2]; 2]>,
);

/// A snap: position, kind, point, line with the part of its length, directions, points that these start from.
type SnapRow = ([f64; 2], &'static str, Option<u32>, Option<(u32, f64)>, Vec<String>, Vec<u32>);

/// A proposed type: line, type, probability, alternatives.
type ProposalRow = (u32, &'static str, f64, Vec<(Option<&'static str>, f64)>);

/// A piece of a stroke: kind, points, centre, radius, half-axes, residual, smoothness of its end.
type PieceRow =
    (&'static str, Vec<[f64; 2]>, Option<[f64; 2]>, Option<f64>, Option<[[f64; 2]; 2]>, f64, bool);

fn suggested(s: Suggestion) -> Suggested {
    (s.axis.to_string(), s.p.0, s.q.0, s.value, s.open)
}

fn about(subject: ReplySubject) -> Option<About> {
    (!subject.kind.is_empty()).then(|| {
        (
            subject.kind,
            subject.points.into_iter().map(|p| p.0).collect(),
            subject.lines.into_iter().map(|l| l.0).collect(),
            subject.faces.into_iter().map(|f| f.0).collect(),
            subject.names,
            subject.axis.map(|a| a.to_string()),
            subject.value,
            subject.place,
            subject.suggestion.map(suggested),
        )
    })
}

/// A session of the sketch language.
#[pyclass(frozen, name = "SketchSession", module = "moldloft._core")]
pub struct PySketch {
    inner: Arc<Mutex<SketchSession>>,
    /// True while lines of a file are run.
    confined: Arc<AtomicBool>,
}

impl PySketch {
    fn lock<'a>(&'a self, py: Python<'_>) -> MutexGuard<'a, SketchSession> {
        // A panic is our own bug and was shown as such; the session is still in one piece.
        self.inner.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }

    /// Work without Python's lock that Ctrl-C can leave.
    fn long<R: Send + 'static>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut SketchSession) -> R + Send + 'static,
    ) -> PyResult<R> {
        let inner = self.inner.clone();
        let never = Budget::default();
        interruptible(py, &never, move || {
            work(&mut inner.lock().unwrap_or_else(PoisonError::into_inner))
        })
    }

    fn solid(&self, py: Python<'_>, name: &str) -> PyResult<SketchSolid<f64>> {
        let wanted = name.to_owned();
        let data = self.long(py, move |s| {
            s.objects().into_iter().find(|o| o.name.eq_ignore_ascii_case(&wanted))
        })?;
        let Some(data) = data else { return Err(no_object(name)) };
        data.solid.ok_or_else(|| {
            plain_error(format!(
                "`{name}` has no faces yet, or misses dimensions: see CHECK and GENERATE FACES"
            ))
        })
    }
}

fn no_object(name: &str) -> PyErr {
    unknown_name(format!("unknown object `{name}` in this sketch"))
}

fn answer(py: Python<'_>, reply: CommandReply) -> Answer<'_> {
    let severity = match reply.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        _ => "note",
    };
    let file = reply.file.map(|f| (f.name, PyBytes::new(py, &f.bytes)));
    (severity, reply.code, reply.text, reply.next, file, about(reply.about))
}

/// Chords of curves within a thousandth of the body's size, unless a tolerance is given.
fn mesh_of(solid: &SketchSolid<f64>, tolerance: Option<f64>) -> Mesh<f64> {
    let size = solid.vertices.iter().map(|v| v.at.norm()).fold(0.0, f64::max);
    solid.mesh(tolerance.filter(|t| *t > 0.0).unwrap_or(1e-3 * size))
}

/// Vertices and faces of a body.
#[allow(clippy::type_complexity)]
fn mesh_arrays<'py>(
    py: Python<'py>,
    solid: &SketchSolid<f64>,
    tolerance: Option<f64>,
) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>)> {
    let mesh = py.detach(|| mesh_of(solid, tolerance));
    let positions = mesh.positions();
    let fill = |out: &mut [Vec3]| out.copy_from_slice(positions);
    let vertices = arrays::filled(py, [positions.len(), 3], fill).0;
    let faces = PyArray2::<u32>::zeros(py, [mesh.faces().len(), 4], false);
    faces.readwrite().as_slice_mut()?.copy_from_slice(mesh.faces().as_flattened());
    Ok((vertices, faces))
}

/// The face of each facet of a body.
fn facet_faces(solid: &SketchSolid<f64>) -> Vec<usize> {
    let mesh = mesh_of(solid, None);
    let mut own = vec![0; mesh.faces().len()];
    for (face, patch) in mesh.patches().iter().enumerate() {
        own[patch.faces.clone()].fill(face);
    }
    own
}

/// The plane across an axis, as `SKETCH 2D` names it.
fn plane_of(axis: CoordinateAxis) -> String {
    axis.others().iter().map(|a| a.letter()).collect()
}

/// Verb, words with the positions of their first and past their last character, and whether the
/// command is the last one of its line.
type WrittenCommand = (String, Vec<(String, usize, usize)>, bool);

/// Name, angle and scale of an axis on the page.
type PageAxis = (String, f64, f64);

/// Counts code points of a text at increasing byte positions.
struct PointCount<'a> {
    text: &'a str,
    byte: usize,
    point: usize,
}

impl PointCount<'_> {
    fn at(&mut self, byte: usize) -> usize {
        self.point += self.text[self.byte..byte].chars().count();
        self.byte = byte;
        self.point
    }
}

/// Change of an object: its name; added, removed, changed body; points drawn, moved, removed;
/// lines; faces; numbers.
type Changed = (String, [bool; 3], [Vec<u32>; 5], Vec<String>);

fn changed(c: ObjectChange) -> Changed {
    let points = |p: Vec<PointId>| p.into_iter().map(|p| p.0).collect();
    let parts = [
        points(c.drawn),
        points(c.moved),
        points(c.removed_points),
        c.lines.into_iter().map(|l| l.0).collect(),
        c.faces.into_iter().map(|f| f.0).collect(),
    ];
    (c.name, [c.added, c.removed, c.body], parts, c.numbers)
}

#[pymethods]
impl PySketch {
    #[new]
    fn new(folder: Option<String>) -> Self {
        let folder = folder.as_deref().map(Path::new).map(Path::to_path_buf);
        let confined = Arc::<AtomicBool>::default();
        let disk = Disk { folder, confined: confined.clone() };
        Self { inner: Arc::new(Mutex::new(SketchSession::with_files(Box::new(disk)))), confined }
    }

    /// From now on lines may read files in the folder only, as lines of a file may, or anywhere.
    fn confine(&self, on: bool) {
        self.confined.store(on, Ordering::Relaxed);
    }

    fn run_line<'py>(&self, py: Python<'py>, line: String) -> PyResult<Vec<Answer<'py>>> {
        let replies = self.long(py, move |s| s.run_line(&line))?;
        Ok(replies.into_iter().map(|r| answer(py, r)).collect())
    }

    /// The answers to lines of a text, each with the index of its line.
    fn run_lines<'py>(
        &self,
        py: Python<'py>,
        lines: Vec<String>,
    ) -> PyResult<Vec<(usize, Answer<'py>)>> {
        let replies = self.long(py, move |s| -> Vec<(usize, CommandReply)> {
            let run = |(k, line): (usize, &String)| {
                s.run_line(line).into_iter().map(move |reply| (k, reply))
            };
            lines.iter().enumerate().flat_map(run).collect()
        })?;
        Ok(replies.into_iter().map(|(k, reply)| (k, answer(py, reply))).collect())
    }

    /// Keeps no steps to undo from now on.
    fn forgo_steps(&self, py: Python<'_>) {
        self.lock(py).forgo_steps();
    }

    /// True once UNDO or REDO was run.
    fn stepped(&self, py: Python<'_>) -> bool {
        self.lock(py).stepped()
    }

    /// Begins a run of lines.
    fn hold(&self, py: Python<'_>) {
        self.lock(py).hold();
    }

    /// Ends it: the warnings of features without a body.
    fn settle<'py>(&self, py: Python<'py>) -> PyResult<Vec<Answer<'py>>> {
        let replies = self.long(py, |s| s.settle())?;
        Ok(replies.into_iter().map(|r| answer(py, r)).collect())
    }

    /// The answers to a line, and its changes as JSON.
    fn report<'py>(
        &self,
        py: Python<'py>,
        line: String,
    ) -> PyResult<(Vec<Answer<'py>>, Vec<Changed>)> {
        let report = self.long(py, move |s| s.report(&line))?;
        let replies = report.replies.into_iter().map(|r| answer(py, r)).collect();
        Ok((replies, report.changes.into_iter().map(changed).collect()))
    }

    /// Begins a run of edits that count as one.
    fn begin(&self, py: Python<'_>) -> PyResult<()> {
        self.lock(py).begin().map_err(|fault| plain_error(fault.text))
    }

    /// Ends it, and returns warnings and its changes.
    fn commit<'py>(&self, py: Python<'py>) -> PyResult<(Vec<Answer<'py>>, Vec<Changed>)> {
        let report = self.long(py, |s| s.commit())?;
        let replies = report.replies.into_iter().map(|r| answer(py, r)).collect();
        Ok((replies, report.changes.into_iter().map(changed).collect()))
    }

    /// Ends it as if it had not been.
    fn rollback(&self, py: Python<'_>) {
        self.lock(py).rollback();
    }

    /// Meanings of a position on the page, the likeliest first: position, kind, a point, a line with the part of its
    /// length, directions, and the points that these start from.
    fn snaps(
        &self,
        py: Python<'_>,
        name: &str,
        at: [f64; 2],
        reach: f64,
        start: Option<[f64; 2]>,
        awake: Vec<u32>,
    ) -> PyResult<Vec<SnapRow>> {
        let session = self.lock(py);
        let object = session.object(name).ok_or_else(|| no_object(name))?;
        let awake: Vec<PointId> = awake.into_iter().map(PointId).collect();
        let row = |snap: Snap| {
            let (point, line) = match snap.hit {
                Some(DrawingHit::Point(p)) => (Some(p.0), None),
                Some(DrawingHit::Line { line, part }) => (None, Some((line.0, part))),
                None => (None, None),
            };
            let directions = snap.directions.iter().map(ToString::to_string).collect();
            let of = snap.of.into_iter().map(|p| p.0).collect();
            (snap.at, snap.kind.word(), point, line, directions, of)
        };
        Ok(object.drawing.snaps(at, reach, start, &awake).into_iter().map(row).collect())
    }

    /// Types of lines by the judgement of the whole drawing: line, type, probability, and the
    /// alternatives with their probabilities.
    fn type_proposals(&self, py: Python<'_>, name: &str) -> PyResult<Vec<ProposalRow>> {
        let session = self.lock(py);
        let drawing = session.object(name).ok_or_else(|| no_object(name))?.drawing.clone();
        drop(session);
        let found = py.detach(move || drawing.type_proposals());
        let row = |p: TypeProposal| {
            let others = p.alternatives.iter();
            let others = others.map(|(f, p)| (f.map(Free::spelling), *p)).collect();
            (p.line.0, p.free.spelling(), p.probability, others)
        };
        Ok(found.into_iter().map(row).collect())
    }

    /// Dimensions that the picture suggests: axis, from, to, value, and whether the depth is a guess.
    fn suggestions(&self, py: Python<'_>, name: &str) -> PyResult<Vec<Option<Suggested>>> {
        let wanted = name.to_owned();
        let found = self.long(py, move |s| s.suggestions(&wanted))?;
        Ok(found.ok_or_else(|| no_object(name))?.into_iter().map(|s| s.map(suggested)).collect())
    }

    /// Positions of the dimensions on the page, or in a view of the body.
    #[pyo3(signature = (name, view=None))]
    fn marks(&self, py: Python<'_>, name: &str, view: Option<String>) -> PyResult<Vec<Mark>> {
        self.lock(py).object(name).ok_or_else(|| no_object(name))?;
        let (wanted, from) = (name.to_owned(), view.clone());
        let found = self.long(py, move |s| s.dimension_marks(&wanted, from.as_deref()))?;
        let found = found.ok_or_else(|| {
            unknown_name(format!("unknown view `{}`", view.as_deref().unwrap_or_default()))
        })?;
        let row = |m: DimensionMark| {
            let axis = m.axis.map(|a| a.to_string());
            (m.name, m.text, m.value, m.reference, axis, m.at, m.line, m.witnesses)
        };
        Ok(found.into_iter().map(row).collect())
    }

    /// The bodies that fit a wireframe, likeliest first; or with `preview` the one body that the picture and
    /// the dimensions suggest.
    #[allow(clippy::type_complexity)]
    fn candidates<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        preview: bool,
    ) -> PyResult<Vec<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>)>> {
        let wanted = name.to_owned();
        let found = self.long(py, move |s| {
            if preview {
                Ok(s.preview(&wanted).map(|p| p.0).into_iter().collect())
            } else {
                s.candidates(&wanted)
            }
        })?;
        let solids = found.map_err(|fault| plain_error(fault.text))?;
        solids.iter().map(|solid| mesh_arrays(py, solid, None)).collect()
    }

    /// The journal's commands from number `start` on.
    fn journal(&self, py: Python<'_>, start: usize) -> Vec<String> {
        let session = self.lock(py);
        session.journal().get(start..).unwrap_or_default().to_vec()
    }

    fn journal_length(&self, py: Python<'_>) -> usize {
        self.lock(py).journal().len()
    }

    /// The commands of the open series of edits.
    fn pending(&self, py: Python<'_>) -> Vec<String> {
        self.lock(py).pending().to_vec()
    }

    fn complete(&self, py: Python<'_>, line: &str) -> Vec<String> {
        self.lock(py).complete(line)
    }

    fn over(&self, py: Python<'_>) -> bool {
        self.lock(py).over()
    }

    fn begun(&self, py: Python<'_>) -> bool {
        self.lock(py).begun()
    }

    fn asks(&self, py: Python<'_>) -> bool {
        self.lock(py).asks()
    }

    /// The active object's name.
    fn active(&self, py: Python<'_>) -> Option<String> {
        self.lock(py).active_object().map(|o| o.name.clone())
    }

    /// The commands of a text: verb in full or empty, words with their spans in code points, and
    /// whether it is the last one of its line.
    #[staticmethod]
    fn commands(text: &str) -> Vec<WrittenCommand> {
        let mut points = PointCount { text, byte: 0, point: 0 };
        let mut words = |command: TextCommand| {
            let word = |(token, span): (CommandToken, Range<usize>)| {
                (token.text, points.at(span.start), points.at(span.end))
            };
            let verb = command.verb.unwrap_or_default().to_owned();
            (verb, command.tokens.into_iter().map(word).collect(), command.last)
        };
        text_commands(text).into_iter().map(&mut words).collect()
    }

    /// The plane of a section, and name, page angle in degrees and page scale of each axis of the
    /// drawing.
    fn axes(&self, py: Python<'_>, name: &str) -> PyResult<(Option<String>, Vec<PageAxis>)> {
        let session = self.lock(py);
        let drawing = &session.object(name).ok_or_else(|| no_object(name))?.drawing;
        let page = &drawing.projection;
        let all = [CoordinateAxis::X, CoordinateAxis::Y, CoordinateAxis::Z];
        let drawn: Vec<CoordinateAxis> =
            all.into_iter().filter(|a| drawing.section != Some(*a)).collect();
        let plane = drawing.section.map(|_| drawn.iter().map(|a| a.letter()).collect());
        let axis = |a: &CoordinateAxis| {
            (a.letter().to_owned(), page.angle_deg[a.index()], page.scale[a.index()])
        };
        Ok((plane, drawn.iter().map(axis).collect()))
    }

    fn names(&self, py: Python<'_>) -> Vec<String> {
        self.lock(py).names()
    }

    fn objects_json(&self, py: Python<'_>) -> PyResult<String> {
        self.long(py, |s| s.objects_json().to_string())
    }

    /// The commands that make the objects, or one of them.
    fn text(&self, py: Python<'_>, name: Option<&str>) -> PyResult<String> {
        let session = self.lock(py);
        let names = name.map_or_else(|| session.names(), |n| vec![n.to_owned()]);
        let objects = names.iter().map(|n| session.object(n).ok_or_else(|| no_object(n)));
        let objects = objects.collect::<PyResult<Vec<_>>>()?;
        Ok(scripts(&objects).into_iter().map(|(_, text)| text).collect())
    }

    /// Rows of name, value, low, high of dimensions and variables; `None` for no value or range.
    #[allow(clippy::type_complexity)]
    fn numbers(
        &self,
        py: Python<'_>,
        name: &str,
    ) -> PyResult<Vec<(String, Option<f64>, Option<f64>, Option<f64>)>> {
        let mut session = self.lock(py);
        let rows = session.numbers(name).ok_or_else(|| no_object(name))?;
        let row = |(n, v, r): (String, Option<f64>, Option<[f64; 2]>)| {
            (n, v, r.map(|r| r[0]), r.map(|r| r[1]))
        };
        Ok(rows.into_iter().map(row).collect())
    }

    /// Labels and coordinates of the points; NaN where they are free.
    #[allow(clippy::type_complexity)]
    fn points<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<(Bound<'py, PyArray1<u32>>, Bound<'py, PyArray2<f64>>)> {
        let wanted = name.to_owned();
        let data = self.long(py, move |s| {
            s.objects().into_iter().find(|o| o.name.eq_ignore_ascii_case(&wanted))
        })?;
        let Some(data) = data else { return Err(no_object(name)) };
        let labels: Vec<u32> = data.points.iter().map(|p| p.0.0).collect();
        let at: Vec<Vec3> =
            data.points.iter().map(|p| p.1.map(|x| x.unwrap_or(f64::NAN)).into()).collect();
        let array = arrays::filled(py, [at.len(), 3], |out| out.copy_from_slice(&at)).0;
        Ok((PyArray1::from_vec(py, labels), array))
    }

    /// Vertices and faces of four corners, the last twice for a triangle.
    #[allow(clippy::type_complexity)]
    #[pyo3(signature = (name, tolerance=None))]
    fn mesh<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        tolerance: Option<f64>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>)> {
        let solid = self.solid(py, name)?;
        mesh_arrays(py, &solid, tolerance)
    }

    /// The body as `mesh` gives it, the face of each facet, and for each face on which a section can be
    /// drawn its name in commands and the plane of that section.
    #[allow(clippy::type_complexity)]
    fn faces<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<(
        Bound<'py, PyArray2<f64>>,
        Bound<'py, PyArray2<u32>>,
        Vec<usize>,
        Vec<Option<(String, String)>>,
    )> {
        let solid = self.solid(py, name)?;
        let (vertices, facets) = mesh_arrays(py, &solid, None)?;
        let named = drawable_faces(&solid).into_iter();
        let named = named.map(|face| face.map(|(name, axis)| (name, plane_of(axis))));
        Ok((vertices, facets, facet_faces(&solid), named.collect()))
    }

    /// Of a section on a face: the body and the face; the place of the section by the images of the unit vectors and of
    /// the origin; 1 if a positive extrusion is outside the body, else -1; the body as `mesh` gives it, and the
    /// facets of the face.
    #[allow(clippy::type_complexity)]
    fn section_place<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<
        Option<(
            (String, String),
            [[f64; 3]; 4],
            f64,
            (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>),
            Vec<usize>,
        )>,
    > {
        let wanted = name.to_owned();
        let Some(frame) = self.long(py, move |s| s.section_frame(&wanted))? else {
            return Ok(None);
        };
        let [a, b, c] = frame.place.columns.map(|v| v.to_array());
        let place = [a, b, c, frame.place.shift.to_array()];
        let own = facet_faces(&frame.body);
        let facets = (0..own.len()).filter(|k| frame.faces.contains(&own[*k])).collect();
        let on = (frame.on.body, frame.on.face.to_string());
        Ok(Some((on, place, frame.outward, mesh_arrays(py, &frame.body, None)?, facets)))
    }

    /// Derivatives by dimensions: of the volume, of the area, of the centroid `(n, 3)`, of the body's
    /// vertices `(n, vertices, 3)`; and where a measure has two, one on each side.
    #[allow(clippy::type_complexity)]
    fn gradient<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        by: Vec<String>,
    ) -> PyResult<(
        Bound<'py, PyArray1<f64>>,
        Bound<'py, PyArray1<f64>>,
        Bound<'py, PyArray2<f64>>,
        Bound<'py, PyArray3<f64>>,
        Vec<Option<String>>,
    )> {
        // The object or one of the numbers is missing.
        self.lock(py).object(name).ok_or_else(|| no_object(name))?;
        let wanted = name.to_owned();
        let gradient = self.long(py, move |s| s.gradient(&wanted, &by))?;
        let gradient = gradient.map_err(|missing| match missing.as_str() {
            "" => plain_error(format!("`{name}` has no faces yet, or misses dimensions")),
            other => unknown_name(format!("unknown dimension or variable `{other}`")),
        })?;
        let vertices = gradient.points.first().map_or(0, Vec::len);
        let n = gradient.volume.len();
        let points: Vec<Vec3> = gradient.points.into_iter().flatten().collect();
        Ok((
            PyArray1::from_vec(py, gradient.volume),
            PyArray1::from_vec(py, gradient.area),
            arrays::filled(py, [n, 3], |out| out.copy_from_slice(&gradient.centroid)).0,
            arrays::filled(py, [n, vertices, 3], |out| out.copy_from_slice(&points)).0,
            gradient.kinks.iter().map(|k| k.map(|k| k.to_string())).collect(),
        ))
    }

    /// Rows of volume, area and centroid at each value of a dimension; NaN where there is no body.
    fn sweep<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        by: String,
        values: Vec<f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.lock(py).object(name).ok_or_else(|| no_object(name))?;
        let wanted = name.to_owned();
        let swept = self.long(py, move |s| s.sweep(&wanted, &by, &values))?;
        let swept = swept.map_err(|missing| {
            unknown_name(format!("unknown dimension or variable `{missing}`"))
        })?;
        let rows: Vec<Vec<f64>> = (swept.iter())
            .map(|s| match s.mass {
                Some(m) => vec![m.volume, m.area, m.centroid.x, m.centroid.y, m.centroid.z],
                None => vec![f64::NAN; 5],
            })
            .collect();
        if rows.is_empty() {
            return Ok(PyArray2::zeros(py, [0, 5], false));
        }
        PyArray2::from_vec2(py, &rows).map_err(plain_error)
    }

    /// A picture of the body.
    #[pyo3(signature = (name, width, height, azimuth=-60.0, elevation=25.0))]
    fn picture<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        width: usize,
        height: usize,
        azimuth: f64,
        elevation: f64,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let solid = self.solid(py, name)?;
        let png = py.detach(|| {
            let mesh = mesh_of(&solid, None);
            let lines: Vec<StyledPolyline> = (0..solid.edges.len())
                .map(|e| StyledPolyline {
                    points: solid.polyline(e, 24),
                    colour: EDGE_COLOUR,
                    width: EDGE_WIDTH,
                    on_surface: false,
                })
                .collect();
            let camera =
                Camera { azimuth_deg: azimuth, elevation_deg: elevation, ..Camera::default() };
            render(&mesh, &lines, &Options { width, height, camera, ..Options::default() })
        });
        let png = png.map_err(plain_error)?;
        Ok(PyBytes::new(py, &png))
    }
}

/// The pieces of a stroke of a pen, whether it is closed, its noise, the tolerance of its ends, and the
/// command that draws it. Samples are rows of u and v, of time, of pressure.
#[pyfunction]
#[allow(clippy::type_complexity)]
pub fn sketch_stroke(
    py: Python<'_>,
    at: Vec<[f64; 2]>,
    times: Option<Vec<f64>>,
    pressures: Option<Vec<f64>>,
) -> PyResult<(Vec<PieceRow>, bool, f64, f64, String)> {
    let value = |all: &Option<Vec<f64>>, k: usize| all.as_ref().and_then(|a| a.get(k).copied());
    let samples: Vec<PenSample> = (at.iter().enumerate())
        .map(|(k, at)| PenSample {
            at: *at,
            time: value(&times, k),
            pressure: value(&pressures, k),
        })
        .collect();
    let found: Result<_, StrokeFault> =
        py.detach(|| Ok((fit_stroke(&samples)?, pen_positions(&samples)?)));
    let (fit, samples) = found.map_err(plain_error)?;
    let row = |p: StrokePiece| {
        (p.kind.word(), p.points, p.centre, p.radius, p.half_axes, p.residual, p.smooth)
    };
    let pieces = fit.pieces.into_iter().map(row).collect();
    let command = SketchCommand::Stroke { samples }.to_string();
    Ok((pieces, fit.closed, fit.noise, fit.tolerance, command))
}

/// The command reference as Markdown.
#[pyfunction]
pub fn sketch_reference() -> String {
    moldloft::sketch::command::verbs::reference()
}
