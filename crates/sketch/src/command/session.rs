//! A session: objects, undo, journal, and the dispatch of commands.

use super::args::Args;
use super::others::OtherNumbers;
use super::question::Question;
use super::subject::ReplySubject;
use super::words::{self, Command};
use super::{CommandError, verbs};
use crate::solid::feature::SessionBodies;
use crate::solid::feature::{NoBody, body_kept};
use crate::solid::{SketchSolid, solid};
use crate::{DimensionLayout, Estimate, Planes, PointId, SketchObject, solve};
use indexmap::IndexMap;
use moldloft_diag::Severity;
use moldloft_num::Real;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Access of a session to files.
pub trait Files: Send + Sync {
    /// The text of a file.
    ///
    /// # Errors
    /// The reason in words.
    fn read(&self, name: &str) -> Result<String, String>;

    /// The bytes of a font: of a file, or of the system where `name` begins with [`moldloft_font::SYSTEM_FONT`].
    ///
    /// # Errors
    /// The reason in words.
    fn font(&self, _: &str) -> Result<Arc<[u8]>, String> {
        Err("no fonts can be read here".to_owned())
    }

    /// A boundary representation as a STEP file, of a title and the unit of length in metres, for hosts that
    /// can write one.
    ///
    /// # Errors
    /// The reason in words.
    fn step(&self, _: &moldloft_brep::Brep, _: &str, _: f64) -> Result<Vec<u8>, String> {
        Err("STEP is not written here".to_owned())
    }
}

/// A world without files.
#[derive(Clone, Copy, Debug, Default)]
pub struct NullFiles;

impl Files for NullFiles {
    fn read(&self, _: &str) -> Result<String, String> {
        Err("no files can be read here".to_owned())
    }
}

/// A file to be written by the host.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutFile {
    /// Name as given in the command.
    pub name: String,
    /// Content.
    pub bytes: Vec<u8>,
}

/// An answer to a command.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandReply {
    /// Error, warning or note.
    pub severity: Severity,
    /// The code of 1983, for errors that have one.
    pub code: Option<u16>,
    /// Text of the reply; may have several lines.
    pub text: String,
    /// The next step, for errors and questions.
    pub next: Option<String>,
    /// A file to write.
    pub file: Option<OutFile>,
    /// Subject, as data.
    pub about: ReplySubject,
}

impl CommandReply {
    /// A plain answer.
    pub fn note(text: impl Into<String>) -> CommandReply {
        CommandReply {
            severity: Severity::Note,
            code: None,
            text: text.into(),
            next: None,
            file: None,
            about: ReplySubject::default(),
        }
    }

    /// A warning.
    pub fn warning(text: impl Into<String>) -> CommandReply {
        CommandReply { severity: Severity::Warning, ..CommandReply::note(text) }
    }

    /// A fault that does not stop the command.
    pub(super) fn warning_of(fault: CommandError) -> CommandReply {
        CommandReply {
            code: Some(fault.code).filter(|c| *c > 0),
            next: Some(fault.next),
            about: *fault.about,
            ..CommandReply::warning(fault.text)
        }
    }

    /// A file to write, with a line about it.
    pub fn output(name: &str, bytes: Vec<u8>) -> CommandReply {
        let text = format!("{name}: {} bytes", bytes.len());
        CommandReply {
            file: Some(OutFile { name: name.to_owned(), bytes }),
            ..CommandReply::note(text)
        }
    }

    /// True if the command was refused.
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}

impl From<CommandError> for CommandReply {
    fn from(f: CommandError) -> CommandReply {
        let code = (f.code > 0).then_some(f.code);
        let severity = Severity::Error;
        let about = *f.about;
        CommandReply { severity, code, text: f.text, next: Some(f.next), file: None, about }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Picture {
    pub labels: bool,
    pub planes: bool,
    /// Dimension lines, also without the planes.
    pub dimensions: bool,
    pub types: bool,
    /// `SKETCH`, `TOP`, `FRONT`, `SIDE` or the name of a projection.
    pub view: String,
    /// Highlighted face.
    pub face: Option<crate::FaceId>,
    /// The window on the page: left, bottom, right, top.
    pub window: Option<[f64; 4]>,
}

/// Everything that commands change.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SessionState {
    /// Objects by folded name.
    pub objects: IndexMap<String, Arc<SketchObject>>,
    pub active: Option<String>,
    pub picture: Picture,
    /// Objects outside of the feature that is being read, with the active one and the feature's name.
    pub outside: Vec<Outside>,
    /// Words are cut at 32 characters, as in 1983.
    pub sketch83: bool,
}

/// The objects around a feature: all, the active one, and the name of the feature.
pub(crate) type Outside = (IndexMap<String, Arc<SketchObject>>, Option<String>, String);

/// Data derived from a drawing, kept while it is the same.
pub(crate) struct DrawingCache {
    drawing: Arc<crate::Drawing>,
    reference: Option<PointId>,
    pub planes: Arc<Planes>,
    estimate: std::sync::OnceLock<Option<Estimate>>,
}

impl DrawingCache {
    pub fn estimate(&self) -> Option<&Estimate> {
        let compute = || Estimate::of(&self.drawing, &self.planes, self.reference?);
        self.estimate.get_or_init(compute).as_ref()
    }
}

/// An object with its derived data, kept while it is the same.
pub(crate) struct Worked {
    pub object: Arc<SketchObject>,
    pub view: Arc<DrawingCache>,
    pub layout: DimensionLayout<f64>,
    /// Numbers of other objects that it reads.
    others: OtherNumbers,
    kept: Arc<SessionBodies>,
    body: std::sync::OnceLock<Result<SketchSolid<f64>, NoBody>>,
}

impl Worked {
    /// The valid body, or the reason for its absence.
    pub fn body(&self) -> Result<&SketchSolid<f64>, &NoBody> {
        let make = || body_kept(&self.object, &self.view.planes, &self.layout, &self.kept);
        self.body.get_or_init(make).as_ref()
    }

    /// The body, once there are faces and all dimensions and it is valid.
    pub fn solid(&self) -> Option<&SketchSolid<f64>> {
        self.body().ok()
    }
}

/// The state before a run of edits that count as one.
pub(super) struct Transaction {
    pub(super) before: SessionState,
    pub(super) journal: usize,
    pub(super) unchecked: IndexMap<String, bool>,
}

/// Runs commands on objects.
///
/// ```
/// use moldloft_sketch::SketchSession;
/// let mut s = SketchSession::new();
/// for line in ["SKETCH PLATE 2D XY", "POINT 1 0 0; POINT 2 4 0; POINT 3 4 3; POINT 4 0 3",
///              "POLYLINE 1 2 3 4 CLOSE", "DIM W X 1 2 = 40; DIM H Y 2 3 = 30", "GENERATE FACES"] {
///     assert!(s.run_line(line).iter().all(|r| !r.is_error()));
/// }
/// assert_eq!(s.objects()[0].area, Some(1200.0));
/// ```
pub struct SketchSession {
    pub(crate) state: SessionState,
    undo: Vec<SessionState>,
    /// Number of states discarded as too old.
    forgotten: usize,
    redo: Vec<SessionState>,
    pub(super) history: Vec<String>,
    pub(super) journal: Vec<String>,
    pub(super) files: Box<dyn Files>,
    pub(crate) question: Option<Question>,
    begun: String,
    views: Vec<Arc<DrawingCache>>,
    pub(super) worked: Vec<Arc<Worked>>,
    kept: Arc<SessionBodies>,
    depth: usize,
    over: bool,
    /// Files written by SAVE and EXPORT in the current line, not passed to the host yet.
    pub(crate) written: BTreeMap<String, Vec<u8>>,
    /// Text for the journal instead of the current command.
    pub(crate) recorded: Option<String>,
    /// Replies of the command that is running.
    pub(crate) out: Vec<CommandReply>,
    /// A run of edits that count as one.
    pub(super) transaction: Option<Transaction>,
    /// Runs of lines that are open, one in the other.
    pub(super) running: usize,
    /// Features to be checked after them, by folded name; true for those whose numbers were changed.
    pub(super) unchecked: IndexMap<String, bool>,
    /// False if the host keeps no steps to undo.
    pub(super) keeps_steps: bool,
    /// True once UNDO or REDO was run.
    stepped: bool,
    /// The last wireframe, and its solids.
    pub(super) fitted: Option<(Wireframe, crate::solid::faces::Fitted)>,
}

/// Positions, edges and the plane of a section.
pub(super) type Wireframe =
    (Vec<moldloft_num::Vec3>, Vec<[usize; 2]>, Option<crate::CoordinateAxis>);

/// Commands that only look: an open question stays open.
const LOOKS: [&str; 12] = [
    "HELP",
    "LIST",
    "SHOW",
    "MEASURE",
    "CHECK",
    "WHY",
    "ESTIMATE",
    "EXTENSIONS",
    "HISTORY",
    "DUMP",
    "END",
    "EXPORT",
];
/// Commands that can invalidate a body and do not check it themselves.
const LOSES: [&str; 7] = ["WELD", "DELETE", "TYPE", "ALIGN", "UNALIGN", "LINE", "POLYLINE"];
/// Objects whose derived data are kept.
const MAX_WORKED: usize = 8;
/// Maximum number of undo steps.
const MAX_UNDO: usize = 500;
/// Maximum number of points, lines and faces in all undo states together.
const MAX_PARTS: usize = 2_000_000;
/// Longer lines are refused.
const MAX_LINE: usize = 1 << 22;
/// Files that run files.
const MAX_DEPTH: usize = 8;
/// More points than this in one object are refused.
pub(crate) const MAX_POINTS: usize = 20_000;

impl Default for SketchSession {
    fn default() -> Self {
        SketchSession::new()
    }
}

impl SketchSession {
    /// A session without files to read.
    pub fn new() -> SketchSession {
        SketchSession::with_files(Box::new(NullFiles))
    }

    /// A session that reads files through `files`.
    pub fn with_files(files: Box<dyn Files>) -> SketchSession {
        let picture = Picture {
            labels: true,
            planes: false,
            dimensions: false,
            types: true,
            view: "SKETCH".into(),
            face: None,
            window: None,
        };
        SketchSession {
            state: SessionState {
                objects: IndexMap::new(),
                active: None,
                picture,
                outside: vec![],
                sketch83: false,
            },
            undo: Vec::new(),
            forgotten: 0,
            redo: Vec::new(),
            history: Vec::new(),
            journal: Vec::new(),
            files,
            question: None,
            begun: String::new(),
            views: Vec::new(),
            worked: Vec::new(),
            kept: Arc::default(),
            depth: 0,
            over: false,
            written: BTreeMap::new(),
            recorded: None,
            out: Vec::new(),
            transaction: None,
            running: 0,
            unchecked: IndexMap::new(),
            keeps_steps: true,
            stepped: false,
            fitted: None,
        }
    }

    /// Keeps no steps to undo from now on, for hosts that run a text anew after each edit: a drawing of n points
    /// takes time in proportion to n, not to its square.
    pub fn forgo_steps(&mut self) {
        self.keeps_steps = false;
    }

    /// True once UNDO or REDO was run, of which [`forgo_steps`](SketchSession::forgo_steps) leaves nothing.
    pub fn stepped(&self) -> bool {
        self.stepped
    }

    /// Runs a line: one or more commands, or a part of one that ends in `&`. A refused command
    /// changes nothing; those after it in the line are run. The bodies of features that they change are
    /// made once, after the line.
    pub fn run_line(&mut self, line: &str) -> Vec<CommandReply> {
        if line.contains('\n') {
            return self.run_text(line);
        }
        self.hold();
        let mut replies = self.run_one_line(line);
        let said = |lost: &CommandReply| replies.iter().any(|r| r.text == lost.text);
        let lost: Vec<_> = self.settle().into_iter().filter(|lost| !said(lost)).collect();
        replies.extend(lost);
        replies
    }

    fn run_one_line(&mut self, line: &str) -> Vec<CommandReply> {
        if self.depth == 0 {
            self.written.clear();
        }
        if self.begun.len() + line.len() > MAX_LINE {
            self.begun.clear();
            let text = format!("the line is longer than {MAX_LINE} bytes");
            return vec![CommandError::text(text, "divide it").into()];
        }
        if let Some(part) = words::continued(line) {
            self.begun.push_str(part);
            self.begun.push(' ');
            return vec![];
        }
        let line = std::mem::take(&mut self.begun) + line;
        let parsed = words::parse(&line, self.state.sketch83.then_some(32));
        let mut replies = Vec::new();
        for command in parsed.commands {
            match command {
                Ok(command) => replies.extend(self.run_command(&command)),
                Err(fault) => replies.push(fault.into()),
            }
        }
        replies
    }

    /// Runs a text line by line, as one run.
    pub fn run_text(&mut self, text: &str) -> Vec<CommandReply> {
        self.hold();
        let mut replies: Vec<_> = text.lines().flat_map(|line| self.run_line(line)).collect();
        replies.extend(self.settle());
        replies
    }

    /// Begins a run of lines: features that they change are checked when [`settle`](SketchSession::settle) ends it.
    pub fn hold(&mut self) {
        self.running += 1;
    }

    /// Ends a run of lines, and warns of the features without a body. In a series of edits this waits for
    /// [`commit`](SketchSession::commit).
    pub fn settle(&mut self) -> Vec<CommandReply> {
        self.running = self.running.saturating_sub(1);
        let open = self.running > 0 || self.transaction.is_some();
        if open { vec![] } else { self.check_bodies() }
    }

    fn run_command(&mut self, command: &Command) -> Vec<CommandReply> {
        let value = self.is_value(command);
        let found = if value { Ok(("ACCEPT", None)) } else { verbs::find(&command.tokens[0].text) };
        if let Ok((verb, None)) = found
            && self.only_draws(verb)
        {
            return self.draw_only(verb, command);
        }
        let before = self.state.clone();
        let marks = (self.undo.len() + self.forgotten, self.journal.len());
        let unchecked = self.unchecked.clone();
        let outer = std::mem::take(&mut self.out);
        let verb = found.as_ref().map_or("", |f| f.0);
        let result = found.and_then(|(verb, note)| {
            self.out.extend(note.map(CommandReply::note));
            if value { self.answer_value(command) } else { self.dispatch(verb, command) }
        });
        if result.is_ok() && LOSES.contains(&verb) {
            self.report_lost(&before);
        }
        if result.is_ok() && !same_objects(&before, &self.state) {
            self.follow(&before);
        }
        let mut replies = std::mem::replace(&mut self.out, outer);
        match result {
            Ok(()) => {
                self.history.push(command.text.clone());
                let changed = !same(&before, &self.state);
                // The commands of a file were recorded one by one.
                let nested = matches!(verb, "RUN" | "INPUT");
                // Drawing from a file is recorded as commands, since the file may not exist later.
                let text = self.recorded.take().unwrap_or_else(|| command.text.clone());
                let steps = matches!(verb, "UNDO" | "REDO");
                // Questions and answers count too: an answer means nothing without its question.
                let asked = self.question.is_some() && !LOOKS.contains(&verb);
                let answered = matches!(verb, "ACCEPT" | "REJECT" | "REVERSE" | "YES" | "NO");
                if !nested && (changed || steps || asked || answered) {
                    self.journal.push(text);
                }
                if !nested && !steps && changed && self.transaction.is_none() && self.keeps_steps {
                    self.push_undo(before);
                }
            }
            Err(fault) => {
                // Changes by a file before its refused command are undone too.
                self.state = before;
                self.recorded = None;
                self.unchecked = unchecked;
                self.undo.truncate(marks.0.saturating_sub(self.forgotten));
                self.journal.truncate(marks.1);
                replies.push(fault.into());
            }
        }
        replies
    }

    /// True if an object had a body that was computed already: a text of many commands does not make one for each.
    pub(super) fn had_body(&self, before: &SessionState, key: &str) -> bool {
        let Some(old) = before.objects.get(key) else { return false };
        let had = |w: &Arc<Worked>| {
            Arc::ptr_eq(&w.object, old) && w.body.get().is_some_and(Result::is_ok)
        };
        self.worked.iter().any(had)
    }

    /// Reports that the active object has lost its body by a command.
    fn report_lost(&mut self, before: &SessionState) {
        let Some(key) = self.state.active.clone() else { return };
        let (Some(old), Some(new)) = (before.objects.get(&key), self.state.objects.get(&key))
        else {
            return;
        };
        let (old, new) = (Arc::clone(old), Arc::clone(new));
        if Arc::ptr_eq(&old, &new) || !self.had_body(before, &key) {
            return;
        }
        let worked = self.worked(&new);
        if let Err(why) = worked.body() {
            let reply = CommandReply::warning_of(super::no_body::no_body(&new, why));
            if self.out.iter().all(|r| r.text != reply.text) {
                self.out.push(reply);
            }
        }
    }

    pub(super) fn push_undo(&mut self, before: SessionState) {
        self.undo.push(before);
        self.forget();
        self.redo.clear();
    }

    /// Forgets the oldest states: beyond a number of steps, or of parts that they hold.
    fn forget(&mut self) {
        let parts = |s: &SessionState| -> usize {
            let of = |o: &Arc<SketchObject>| {
                o.drawing.points.len() + o.drawing.lines.len() + o.faces.len() + 1
            };
            s.objects.values().map(of).sum()
        };
        let steps = match self.undo.last().map(parts) {
            Some(n) => (MAX_PARTS / n.max(1)).clamp(1, MAX_UNDO),
            None => MAX_UNDO,
        };
        let beyond = self.undo.len().saturating_sub(steps);
        self.undo.drain(..beyond);
        self.forgotten += beyond;
    }

    pub(super) fn dispatch(
        &mut self,
        verb: &'static str,
        command: &Command,
    ) -> Result<(), CommandError> {
        let usage = verbs::row(verb).map_or(String::new(), verbs::Verb::usage);
        let args = &mut Args::new(&command.tokens[1..], &usage);
        let answer = matches!(verb, "ACCEPT" | "REJECT" | "REPEAT" | "YES" | "NO")
            || (verb == "REVERSE" && args.len() == 0);
        if verb == "ACCEPT" && args.take_short("ALL") {
            args.end()?;
            return self.accept_all();
        }
        if answer {
            args.end()?;
            return self.answer(verb);
        }
        self.question = self.question.take().filter(|_| verb == "CHOOSE" || LOOKS.contains(&verb));
        match verb {
            "SKETCH" => self.sketch(args),
            "MODIFY" => self.using(args, false),
            "POINT" => self.point(args),
            "LINE" => self.line(args),
            "POLYLINE" => self.polyline(args),
            "STROKES" => self.strokes(args),
            "RECTANGLE" | "SLOT" | "POLYGON" => self.section_shape(args, verb),
            "SPLIT" => self.split(args),
            "WELD" => self.weld(args),
            "DELETE" => self.delete(args),
            "AXES" => self.axes(args),
            "TYPE" => self.types(args),
            "ALIGN" | "UNALIGN" => self.align(args, verb == "ALIGN"),
            "DIMENSION" => self.dimension(args),
            "SET" => self.set(args),
            "UNSET" => self.unset(args),
            "VARIABLE" => self.variable(args),
            "REFERENCE" => self.reference(args),
            "REVERSE" => self.reverse(args),
            "EXTENSIONS" => self.extensions(args),
            "CHECK" => self.check(args),
            "WHY" => self.why(args),
            "ESTIMATE" => self.estimate(args),
            "CONVERT" => self.convert(args),
            "GENERATE" | "CREATE" => self.generate(args),
            "FACE" => self.face(args),
            "CHOOSE" => self.choose(args),
            "OFFSET" => self.offset(args),
            "TEXT" => self.text(args),
            "LOFT" => self.loft(args),
            "SWEEP" => self.sweep_section(args),
            "EXTRUDE" => self.extrude(args),
            "REVOLVE" => self.revolve(args),
            "CLEAN" => self.clean(args),
            "MERGE" => self.merge(args),
            "UNION" | "CUT" | "COMMON" => self.combine(args, verb),
            "PATTERN" => self.pattern(args),
            "CHAMFER" | "FILLET" => self.blend(args, verb),
            "HOLE" => self.hole(args),
            "SHELL" => self.shell(args),
            "DRAFT" => self.draft(args),
            "WITHIN" => self.within(args),
            "LEAVE" => self.leave(args),
            "MEASURE" => self.measure(args),
            "CIRCLE" if args.at("DIAMETER") => self.section_shape(args, verb),
            "ARC" | "CIRCLE" | "ELLIPSE" | "BEZIER" => self.corner_curve(args, verb),
            "QUADRATIC" | "PARABOLA" => self.chain_curve(args, 3),
            "CUBIC" | "OVERHAUSER" => self.chain_curve(args, 4),
            "USING" => self.using(args, true),
            "RENAME" => self.rename(args),
            "COPY" => self.copy(args),
            "MOVE" | "ROTATE" | "MIRROR" | "SCALE" => self.transform(args, verb),
            "DUMP" => self.dump(args),
            "SAVE" => self.save(args),
            "INPUT" | "RUN" => self.input(args, verb == "INPUT"),
            "IMPORT" => self.import(args),
            "EXPORT" => self.export(args),
            "GIVE" => self.give(args),
            "DECLARE" => self.declare(args),
            "DISPLAY" | "ERASE" => self.display(args, verb == "DISPLAY"),
            "KEEP" => self.keep(args),
            "SHOW" => self.show(args),
            "ZOOM" => self.zoom(args),
            "PAN" => self.pan(args),
            "VIEW" => self.view_from(args),
            "LIST" => self.list(args),
            "UNDO" | "REDO" => self.step(args, verb == "UNDO"),
            "HISTORY" => {
                args.end()?;
                self.out.push(CommandReply::note(self.history.join("\n")));
                Ok(())
            }
            "HELP" => self.help(args),
            "QUIT" => {
                args.end()?;
                self.over = true;
                Ok(())
            }
            "END" => {
                args.end()?;
                if self.active().is_ok() { self.report_open() } else { Ok(()) }
            }
            _ => args.end(),
        }
    }

    /// The commands that led to the present state, for a journal. A host appends new ones to its
    /// file after each line; running them again restores the session.
    pub fn journal(&self) -> &[String] {
        &self.journal[..self.settled()]
    }

    /// The commands of the open series of edits, which [`commit`](SketchSession::commit) joins to one line of the
    /// journal.
    pub fn pending(&self) -> &[String] {
        &self.journal[self.settled()..]
    }

    /// True if a question is open.
    pub fn asks(&self) -> bool {
        self.question.is_some()
    }

    /// True if the last line ended in `&`, so that the next one continues it.
    pub fn begun(&self) -> bool {
        !self.begun.is_empty()
    }

    /// All commands so far.
    pub fn history(&self) -> &[String] {
        &self.history
    }

    /// True after QUIT.
    pub fn over(&self) -> bool {
        self.over
    }

    /// Completions of the last word of a line: verbs, then names of objects and dimensions.
    pub fn complete(&self, line: &str) -> Vec<String> {
        let last = line.rsplit([' ', ',', '=', ';']).next().unwrap_or("").to_ascii_uppercase();
        let first = line.rsplit(';').next().unwrap_or("").trim_start().len() <= last.len();
        let starts = |name: &str| name.to_ascii_uppercase().starts_with(&last);
        if first {
            let verbs = verbs::VERBS.iter().map(|v| v.name.to_owned());
            return verbs.filter(|v| starts(v)).collect();
        }
        let objects = self.state.objects.values().map(|o| o.name.clone());
        let inner = self.active_object().into_iter().flat_map(|o| {
            let dimensions = o.dimensions.values().map(|d| d.name.clone());
            dimensions.chain(o.variables.values().map(|v| v.name.clone()))
        });
        objects.chain(inner).filter(|n| starts(n)).collect()
    }

    /// The object of that name.
    pub fn object(&self, name: &str) -> Option<&SketchObject> {
        self.state.objects.get(&name.to_lowercase()).map(|o| &**o)
    }

    /// The names of all objects, in the order they were made.
    pub fn names(&self) -> Vec<String> {
        self.state.objects.values().map(|o| o.name.clone()).collect()
    }

    /// Dimensions and variables of an object with value and range, in the order of entry, followed
    /// by those of the objects that it follows, as `object.number`.
    pub fn numbers(&mut self, name: &str) -> Option<Vec<(String, Option<f64>, Option<[f64; 2]>)>> {
        let object = Arc::clone(self.state.objects.get(&name.to_lowercase())?);
        let worked = self.worked(&object);
        let values = &worked.layout.values;
        let variables = object.variables.iter().map(|(k, v)| (k, &v.name, v.range));
        let dimensions = object.dimensions.iter().map(|(k, d)| (k, &d.name, d.range));
        let row = |(k, n, r): (&String, &String, _)| (n.clone(), values.get(k).copied(), r);
        let stands = object.variables.values().filter(|v| object.alias(&v.name).is_some());
        let known: Vec<String> = stands.map(|v| object.source(&v.name)).collect();
        let followed = object.followed_numbers().into_iter();
        let followed = followed.filter(|n| !known.contains(&n.0.to_ascii_lowercase()));
        let followed = followed.map(|(n, _, r)| {
            let value = values.get(&n.to_ascii_lowercase()).copied();
            (n, value, r)
        });
        Some(variables.chain(dimensions).map(row).chain(followed).collect())
    }

    /// The body of an object, once it has faces and all dimensions.
    pub fn solid(&mut self, name: &str) -> Option<SketchSolid<f64>> {
        let object = Arc::clone(self.state.objects.get(&name.to_lowercase())?);
        self.worked(&object).solid().cloned()
    }

    /// The active object.
    pub fn active_object(&self) -> Option<&SketchObject> {
        self.object(self.state.active.as_deref()?)
    }

    /// Adds an object, or replaces the one of the same name, and makes it active.
    pub fn insert(&mut self, object: SketchObject) {
        let key = object.name.to_lowercase();
        self.state.objects.insert(key.clone(), Arc::new(object));
        self.state.active = Some(key);
    }

    /// A file that the host writes.
    pub(crate) fn write(&mut self, name: &str, bytes: Vec<u8>) {
        self.written.insert(name.to_owned(), bytes.clone());
        self.out.push(CommandReply::output(name, bytes));
    }

    pub(crate) fn read(&self, name: &str) -> Result<String, CommandError> {
        if let Some(text) = self.written.get(name).and_then(|b| String::from_utf8(b.clone()).ok()) {
            return Ok(text);
        }
        self.files.read(name).map_err(|why| {
            CommandError::new(600, format!("cannot read \"{name}\": {why}"), "check the name")
        })
    }

    /// The object of a name, or 110.
    pub(crate) fn known(&self, name: &str) -> Result<&SketchObject, CommandError> {
        self.object(name).ok_or_else(|| self.unknown(name))
    }

    /// The error of a name that no object has.
    pub(super) fn unknown(&self, name: &str) -> CommandError {
        let names = self.state.objects.values().map(|o| o.name.as_str());
        let next = match moldloft_diag::nearest(name, names) {
            Some(near) => format!("did you mean {near}?"),
            None => "LIST OBJECTS lists them".to_owned(),
        };
        CommandError::new(110, format!("there is no object {name}"), next)
            .about(ReplySubject::of("unknown-object").names([&name.to_owned()]))
    }

    pub(crate) fn active_mut(&mut self) -> Result<&mut SketchObject, CommandError> {
        let none = || {
            CommandError::new(
                112,
                "no object is active",
                "start one with SKETCH, or name one with USING",
            )
        };
        let key = self.state.active.clone().ok_or_else(none)?;
        self.state.objects.get_mut(&key).map(Arc::make_mut).ok_or_else(none)
    }

    pub(crate) fn active(&self) -> Result<&SketchObject, CommandError> {
        self.active_object().ok_or_else(|| {
            CommandError::new(
                112,
                "no object is active",
                "start one with SKETCH, or name one with USING",
            )
        })
    }

    pub(crate) fn active_arc(&self) -> Result<Arc<SketchObject>, CommandError> {
        self.active()?;
        let key = self.state.active.as_deref().unwrap_or_default();
        Ok(Arc::clone(&self.state.objects[key]))
    }

    /// Replaces the active object by another state.
    pub(crate) fn replace_active(&mut self, object: Arc<SketchObject>) {
        if let Some(key) = self.state.active.clone() {
            self.state.objects.insert(key, object);
        }
    }

    /// Takes an object's name if one is next, and makes it active.
    pub(crate) fn take_object(&mut self, args: &mut Args) -> Result<(), CommandError> {
        if let Some(token) =
            args.peek().filter(|t| !matches!(t.kind, words::CommandTokenKind::Number(..)))
        {
            let key = token.text.to_lowercase();
            if self.state.objects.contains_key(&key) {
                args.skip();
                self.state.active = Some(key);
            }
        }
        self.active().map(|_| ())
    }

    /// Derived data of an object's drawing.
    pub(crate) fn view(&mut self, object: &SketchObject) -> Arc<DrawingCache> {
        let reference = object.reference().map(|r| r.point);
        let same = |v: &&Arc<DrawingCache>| {
            Arc::ptr_eq(&v.drawing, &object.drawing) && v.reference == reference
        };
        if let Some(view) = self.views.iter().find(same) {
            return Arc::clone(view);
        }
        let view = Arc::new(DrawingCache {
            drawing: Arc::clone(&object.drawing),
            reference,
            planes: Arc::new(Planes::of(&object.drawing)),
            estimate: std::sync::OnceLock::new(),
        });
        if self.views.len() >= 8 {
            self.views.remove(0);
        }
        self.views.push(Arc::clone(&view));
        view
    }

    /// An object with its layout and body, from memory when it is the very same.
    pub(crate) fn worked(&mut self, object: &Arc<SketchObject>) -> Arc<Worked> {
        self.worked_with(object, self.state.others(object))
    }

    /// An object with its layout and body, with the numbers of other objects as they were or are.
    pub(super) fn worked_with(
        &mut self,
        object: &Arc<SketchObject>,
        others: OtherNumbers,
    ) -> Arc<Worked> {
        let same = |w: &&Arc<Worked>| Arc::ptr_eq(&w.object, object) && w.others == others;
        if let Some(known) = self.worked.iter().find(same) {
            return Arc::clone(known);
        }
        let view = self.view(object);
        let layout = lay_out(object, &view, &others);
        let (kept, body) = (Arc::clone(&self.kept), std::sync::OnceLock::new());
        let object = Arc::clone(object);
        let worked = Arc::new(Worked { object, view, layout, others, kept, body });
        if self.worked.len() >= MAX_WORKED {
            self.worked.remove(0);
        }
        self.worked.push(Arc::clone(&worked));
        worked
    }

    /// Planes and layout of an object.
    pub(crate) fn laid_out(
        &mut self,
        object: &SketchObject,
    ) -> (Arc<DrawingCache>, DimensionLayout<f64>) {
        let view = self.view(object);
        let layout = lay_out(object, &view, &self.state.others(object));
        (view, layout)
    }

    pub(crate) fn solid_of(&mut self, object: &SketchObject) -> Option<SketchSolid<f64>> {
        let (view, layout) = self.laid_out(object);
        solid(object, &view.planes, &layout)
    }

    fn step(&mut self, args: &mut Args, back: bool) -> Result<(), CommandError> {
        self.stepped = true;
        if self.transaction.is_some() {
            return Err(CommandError::text("a drag is open", "end it first"));
        }
        let n = if args.at_number() { args.count("how many steps")? } else { 1 };
        args.end()?;
        let mut done = 0;
        while done < n {
            let (from, to) = if back {
                (&mut self.undo, &mut self.redo)
            } else {
                (&mut self.redo, &mut self.undo)
            };
            let Some(state) = from.pop() else { break };
            to.push(std::mem::replace(&mut self.state, state));
            done += 1;
        }
        if done == 0 {
            let what = if back { "nothing to undo" } else { "nothing to redo" };
            return Err(CommandError::text(what, "HISTORY lists the commands"));
        }
        let word = if back { "undone" } else { "done again" };
        self.out.push(CommandReply::note(format!("{word}: {done}")));
        Ok(())
    }

    fn help(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let text = match args.peek() {
            None => {
                let mut group = "";
                let mut lines = Vec::new();
                for verb in verbs::VERBS.iter() {
                    if verb.group != group {
                        group = verb.group;
                        lines.push(format!("{group}:"));
                    }
                    lines.push(format!("  {:<11}{}", verb.name, verb.does));
                }
                lines.join("\n")
            }
            Some(token) => {
                args.skip();
                args.end()?;
                let row = verbs::row(verbs::find(&token.text)?.0);
                row.map_or(String::new(), |v| format!("{}\n    {}", v.forms.join("\n"), v.does))
            }
        };
        self.out.push(CommandReply::note(text));
        Ok(())
    }

    pub(crate) fn nested(&mut self, text: &str) -> Result<(), CommandError> {
        if self.depth >= MAX_DEPTH {
            return Err(CommandError::text(
                "files run each other too deeply",
                "let no file run itself",
            ));
        }
        self.depth += 1;
        let begun = std::mem::take(&mut self.begun);
        let mut replies = Vec::new();
        for (number, line) in text.lines().enumerate() {
            for mut reply in self.run_line(line) {
                if reply.is_error() {
                    reply.text = format!("line {}: {}", number + 1, reply.text);
                }
                replies.push(reply);
            }
        }
        self.begun = begun;
        self.depth -= 1;
        self.out.extend(replies);
        Ok(())
    }
}

/// Computes the layout of an object with some values replaced.
pub(crate) fn lay_out<T: Real>(
    object: &SketchObject,
    view: &DrawingCache,
    overrides: &BTreeMap<String, T>,
) -> DimensionLayout<T> {
    solve(object, &view.planes, overrides, &|| view.estimate().cloned())
}

/// True if all objects are as they were.
fn same_objects(a: &SessionState, b: &SessionState) -> bool {
    let pairs = || a.objects.iter().zip(&b.objects);
    a.objects.len() == b.objects.len() && pairs().all(|(x, y)| x.0 == y.0 && Arc::ptr_eq(x.1, y.1))
}

/// True if nothing was changed: unchanged objects are shared.
pub(super) fn same(a: &SessionState, b: &SessionState) -> bool {
    a.active == b.active
        && a.sketch83 == b.sketch83
        && a.picture == b.picture
        && a.outside.len() == b.outside.len()
        && a.objects.len() == b.objects.len()
        && a.objects
            .iter()
            .zip(&b.objects)
            .all(|(x, y)| x.0 == y.0 && (Arc::ptr_eq(x.1, y.1) || x.1 == y.1))
}
