//! Commands and answers as data, for programs and canvases: edits written as commands, their
//! changes, several moves as one step, and missing dimensions.

use super::CommandError;
use super::info::suggestions;
use super::session::{CommandReply, SessionState, SketchSession, Transaction};
use super::solids::face_of;
use crate::{
    CoordinateAxis, DimensionExpr, DimensionMark, FaceId, Free, LineId, MeasuredQuantity, PointId,
    SketchObject, SketchSolid, Suggestion,
};
use moldloft_num::Vec3;
use moldloft_syntax::number::plain;
use std::collections::BTreeSet;
use std::sync::Arc;

/// An edit of the active object, as data.
///
/// ```
/// use moldloft_sketch::{PointId, SketchCommand};
/// let put = SketchCommand::Point { id: Some(PointId(3)), at: [2.5, -1.0] };
/// assert_eq!(put.to_string(), "POINT 3 AT 2.5 -1");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum SketchCommand {
    /// A new object, a cross section perpendicular to an axis if there is one.
    Sketch {
        /// Its name.
        name: String,
        /// The axis.
        section: Option<CoordinateAxis>,
    },
    /// A point, drawn or moved on the page.
    Point {
        /// Its label; `None` for the next free one.
        id: Option<PointId>,
        /// The position on the page.
        at: [f64; 2],
    },
    /// A line drawn.
    Line {
        /// From.
        p: PointId,
        /// To.
        q: PointId,
        /// Its type; `None` to derive it from the slope.
        free: Option<Free>,
    },
    /// The shapes of a stroke of a pen.
    Stroke {
        /// Positions of the pen on the page.
        samples: Vec<[f64; 2]>,
    },
    /// The type of a line.
    Type {
        /// The line.
        line: LineId,
        /// Coordinates that vary along it.
        free: Free,
    },
    /// A dimension.
    Dimension {
        /// Its name; `None` for a new one.
        name: Option<String>,
        /// Measured quantity.
        measure: MeasuredQuantity,
        /// Its value.
        value: DimensionExpr,
    },
    /// A named number.
    Variable {
        /// Its name.
        name: String,
        /// Its value.
        value: DimensionExpr,
    },
    /// Changes the value of a dimension or variable.
    Set {
        /// Its name.
        name: String,
        /// The value.
        value: DimensionExpr,
    },
    /// Deletes a point with its lines, faces, curves and dimensions.
    DeletePoint(PointId),
    /// A line removed.
    DeleteLine(LineId),
    /// Removes a dimension or variable.
    DeleteDimension(String),
    /// The faces found.
    GenerateFaces,
    /// Makes a solid of a cross section.
    Extrude(DimensionExpr),
    /// Takes back the last step.
    Undo,
    /// It is done again.
    Redo,
}

impl std::fmt::Display for SketchCommand {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        use crate::format::script::{measure_text, quoted};
        let value = |e: &DimensionExpr| quoted(e.text());
        match self {
            SketchCommand::Sketch { name, section } => {
                let plane = match section {
                    Some(CoordinateAxis::X) => " 2D YZ",
                    Some(CoordinateAxis::Y) => " 2D XZ",
                    Some(CoordinateAxis::Z) => " 2D XY",
                    None => "",
                };
                write!(f, "SKETCH {}{plane}", quoted(name))
            }
            SketchCommand::Point { id, at: [u, v] } => {
                let id = id.map(|p| format!("{p} AT ")).unwrap_or_else(|| "AT ".to_owned());
                write!(f, "POINT {id}{} {}", plain(*u), plain(*v))
            }
            SketchCommand::Line { p, q, free } => {
                write!(f, "LINE FROM {p} TO {q}")?;
                free.map_or(Ok(()), |free| write!(f, " TYPE {}", free.spelling()))
            }
            SketchCommand::Stroke { samples } => {
                f.write_str("STROKES SAMPLES")?;
                samples.iter().try_for_each(|[u, v]| write!(f, " {} {}", plain(*u), plain(*v)))
            }
            SketchCommand::Type { line, free } => write!(f, "TYPE {line} AS {}", free.spelling()),
            SketchCommand::Dimension { name, measure, value: v } => {
                let name = name.as_ref().map(|n| format!("{n} ")).unwrap_or_default();
                write!(f, "DIMENSION {name}{} = {}", measure_text(measure), value(v))
            }
            SketchCommand::Variable { name, value: v } => write!(f, "VARIABLE {name} {}", value(v)),
            SketchCommand::Set { name, value: v } => write!(f, "SET {name} {}", value(v)),
            SketchCommand::DeletePoint(p) => write!(f, "DELETE POINT {p}"),
            SketchCommand::DeleteLine(l) => write!(f, "DELETE LINE {l}"),
            SketchCommand::DeleteDimension(name) => write!(f, "DELETE DIMENSION {name}"),
            SketchCommand::GenerateFaces => f.write_str("GENERATE FACES"),
            SketchCommand::Extrude(v) => write!(f, "EXTRUDE {}", value(v)),
            SketchCommand::Undo => f.write_str("UNDO"),
            SketchCommand::Redo => f.write_str("REDO"),
        }
    }
}

/// Change of an object.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjectChange {
    /// Its name.
    pub name: String,
    /// True if the object is new.
    pub added: bool,
    /// True if the object was deleted.
    pub removed: bool,
    /// Points that are new or have moved on the page.
    pub drawn: Vec<PointId>,
    /// Points whose coordinates have changed, become known or become unknown.
    pub moved: Vec<PointId>,
    /// Points that are gone.
    pub removed_points: Vec<PointId>,
    /// Lines that are new, changed or removed.
    pub lines: Vec<LineId>,
    /// Dimensions, variables and curves that are new, changed or removed.
    pub numbers: Vec<String>,
    /// Faces that are new, removed, or have moved corners.
    pub faces: Vec<FaceId>,
    /// True if the finished body changed.
    pub body: bool,
}

/// The answer to a typed command, or to a series of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CommandReport {
    /// Replies.
    pub replies: Vec<CommandReply>,
    /// Changes by object.
    pub changes: Vec<ObjectChange>,
}

impl SketchSession {
    /// Runs a command given as data, and returns its changes.
    ///
    /// ```
    /// use moldloft_sketch::{PointId, SketchCommand, SketchSession};
    /// let mut s = SketchSession::new();
    /// s.run_text("SKETCH A 2D XZ\nPOINT 1 0 0; POINT 2 90 0; LINE 1 2; DIM W X 1 2 = 8");
    /// let set = SketchCommand::Set { name: "W".into(), value: moldloft_sketch::DimensionExpr::number(9.0) };
    /// let report = s.edit(&set);
    /// assert_eq!(report.changes[0].moved, [PointId(2)]);
    /// ```
    pub fn edit(&mut self, command: &SketchCommand) -> CommandReport {
        self.report(&command.to_string())
    }

    /// Runs a line, and returns its changes.
    pub fn report(&mut self, line: &str) -> CommandReport {
        let before = self.state.clone();
        let replies = self.run_line(line);
        let changes = self.changes_since(&before);
        CommandReport { replies, changes }
    }

    /// Begins a series of edits that count as one step of UNDO and one line of the journal, such as
    /// the moves of a drag.
    ///
    /// # Errors
    /// One that has begun is not ended; a question is open.
    pub fn begin(&mut self) -> Result<(), CommandError> {
        if self.transaction.is_some() || self.question.is_some() {
            let text =
                if self.question.is_some() { "a question is open" } else { "a drag is open" };
            return Err(CommandError::text(text, "answer it, or end it first"));
        }
        self.transaction = Some(Transaction {
            before: self.state.clone(),
            journal: self.journal.len(),
            unchecked: self.unchecked.clone(),
        });
        Ok(())
    }

    /// Ends a series of edits, and returns the changes of all of them, with warnings of features that lost their
    /// bodies by it.
    pub fn commit(&mut self) -> CommandReport {
        let mut report = CommandReport::default();
        let Some(Transaction { before, journal, .. }) = self.transaction.take() else {
            return report;
        };
        let own = self.journal.split_off(journal);
        // Only the last of several moves of a point counts.
        let mut kept: Vec<String> = Vec::new();
        for (k, line) in own.iter().enumerate() {
            let again = moved_point(line).is_some_and(|p| {
                let rest = own[k + 1..].iter().map(|l| moved_point(l));
                // Only among moves: another command may have read the position.
                rest.take_while(Option::is_some).any(|q| q == Some(p))
            });
            if !again {
                kept.push(line.clone());
            }
        }
        if !super::session::same(&before, &self.state) {
            self.journal.push(kept.join("; "));
            report.changes = self.changes_since(&before);
            self.push_undo(before);
        }
        if self.running == 0 {
            report.replies = self.check_bodies();
        }
        report
    }

    /// Ends a series of edits and reverts it.
    pub fn rollback(&mut self) {
        if let Some(Transaction { before, journal, unchecked }) = self.transaction.take() {
            self.state = before;
            self.unchecked = unchecked;
            self.journal.truncate(journal);
            self.question = None;
        }
    }

    /// Number of settled lines of the journal, without those of an open series of edits.
    pub(super) fn settled(&self) -> usize {
        self.transaction.as_ref().map_or(self.journal.len(), |t| t.journal)
    }

    /// For each part of an object without connection to the reference, the suggested dimension;
    /// `None` without a suggestion.
    pub fn suggestions(&mut self, name: &str) -> Option<Vec<Option<Suggestion>>> {
        let object = self.object(name)?.clone();
        let (view, layout) = self.laid_out(&object);
        Some(suggestions(&object, &view, &layout).collect())
    }

    /// The solids that fit the wireframe of an object, likeliest first, whether their faces are accepted or not.
    ///
    /// # Errors
    /// Results of GENERATE FACES without a change of the object.
    pub fn candidates(&mut self, name: &str) -> Result<Vec<SketchSolid<f64>>, CommandError> {
        let object = self.known(name)?.clone();
        let outer = std::mem::take(&mut self.out);
        let found = self.wireframe(&object);
        self.out = outer;
        let (ids, fitted) = found?;
        let mut out = Vec::new();
        for fit in &fitted.fits {
            let mut one = object.clone();
            one.faces = (1..).map(FaceId).zip(fit.faces.iter().map(|p| face_of(p, &ids))).collect();
            out.extend(self.solid_of(&one));
        }
        Ok(out)
    }

    /// Positions of an object's dimensions: on the page as drawn, or in a view of the body (`TOP`,
    /// `FRONT`, `SIDE` or the name of a projection). `None` for an unknown object or view.
    ///
    /// ```
    /// use moldloft_sketch::SketchSession;
    /// let mut s = SketchSession::new();
    /// s.run_text("SKETCH A 2D XZ\nPOINT 1 0 0; POINT 2 90 0; LINE 1 2; DIM W X 1 2 = 8");
    /// let mark = &s.dimension_marks("a", None).unwrap()[0];
    /// let [from, to] = mark.line.unwrap();
    /// assert_eq!((mark.text.as_str(), from[0], to[0]), ("W 8", 0.0, 90.0));
    /// ```
    pub fn dimension_marks(
        &mut self,
        name: &str,
        view: Option<&str>,
    ) -> Option<Vec<DimensionMark>> {
        let view = match view {
            Some(view) => Some(crate::format::svg::projection(&view.to_ascii_uppercase())?),
            None => None,
        };
        let object = Arc::clone(self.state.objects.get(&name.to_lowercase())?);
        if object.dimensions.is_empty() {
            return Some(vec![]);
        }
        let (planes, data) = (Arc::clone(&self.view(&object).planes), self.data(&object));
        Some(crate::format::svg::marks(&object, &planes, &data, view.as_ref()))
    }

    fn changes_since(&mut self, before: &SessionState) -> Vec<ObjectChange> {
        let mut out = Vec::new();
        for (key, old) in &before.objects {
            if !self.state.objects.contains_key(key) {
                let name = old.name.clone();
                out.push(ObjectChange { name, removed: true, ..ObjectChange::default() });
            }
        }
        let now: Vec<(String, Arc<SketchObject>)> =
            self.state.objects.iter().map(|(k, o)| (k.clone(), Arc::clone(o))).collect();
        for (key, object) in now {
            match before.objects.get(&key) {
                Some(old)
                    if Arc::ptr_eq(old, &object)
                        && before.others(old) == self.state.others(old) => {}
                old => out.extend(self.change(old, &object, before)),
            }
        }
        out
    }

    fn change(
        &mut self,
        old: Option<&Arc<SketchObject>>,
        new: &Arc<SketchObject>,
        before: &SessionState,
    ) -> Option<ObjectChange> {
        let nothing = Arc::new(SketchObject::new(&new.name, new.drawing.section));
        let mut change = ObjectChange {
            name: new.name.clone(),
            added: old.is_none(),
            ..ObjectChange::default()
        };
        let old = old.unwrap_or(&nothing);
        let (a, b) = (&old.drawing, &new.drawing);
        let (work_a, work_b) = (self.worked_with(old, before.others(old)), self.worked(new));
        let place = |w: &super::session::Worked, p: PointId| {
            CoordinateAxis::ALL.map(|axis| w.layout.coordinate(&w.view.planes, axis, p))
        };
        for (id, p) in &b.points {
            if a.points.get(id) != Some(p) {
                change.drawn.push(*id);
            }
            let there = a.points.contains_key(id).then(|| place(&work_a, *id));
            if there != Some(place(&work_b, *id)) {
                change.moved.push(*id);
            }
        }
        change.removed_points.extend(a.points.keys().filter(|p| !b.points.contains_key(p)));
        let lines: BTreeSet<LineId> = a.lines.keys().chain(b.lines.keys()).copied().collect();
        change.lines.extend(lines.into_iter().filter(|l| a.lines.get(l) != b.lines.get(l)));
        macro_rules! numbers {
            ($field:ident) => {
                for (key, entry) in &new.$field {
                    if old.$field.get(key) != Some(entry) {
                        change.numbers.push(entry.name.clone());
                    }
                }
                let gone = old.$field.iter().filter(|(key, _)| !new.$field.contains_key(*key));
                change.numbers.extend(gone.map(|(_, entry)| entry.name.clone()));
            };
        }
        numbers!(variables);
        numbers!(dimensions);
        numbers!(curves);
        let moved: BTreeSet<PointId> = change.moved.iter().copied().collect();
        let faces: BTreeSet<FaceId> = old.faces.keys().chain(new.faces.keys()).copied().collect();
        change.faces.extend(faces.into_iter().filter(|f| {
            let (x, y) = (old.faces.get(f), new.faces.get(f));
            x != y || y.is_some_and(|y| y.loops().flatten().any(|p| moved.contains(p)))
        }));
        let corners = |w: &super::session::Worked| -> Option<(Vec<Vec3>, usize)> {
            let solid = w.solid()?;
            Some((solid.vertices.iter().map(|v| v.at).collect(), solid.faces.len()))
        };
        change.body = corners(&work_a) != corners(&work_b) || old.curves != new.curves;
        let quiet = ObjectChange { name: new.name.clone(), ..ObjectChange::default() };
        (change != quiet).then_some(change)
    }
}

/// The point that a command `POINT p AT u v` moves.
fn moved_point(line: &str) -> Option<u32> {
    let words: Vec<&str> = line.split_whitespace().collect();
    match words[..] {
        ["POINT", id, "AT", _, _] => id.parse().ok(),
        _ => None,
    }
}
