//! What a page may ask.

use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// A request: who asks, and what.
#[derive(Clone, Debug, Deserialize)]
pub struct Request {
    /// Comes back with the reply.
    #[serde(default)]
    pub id: u64,
    /// The viewer that asks: each is sent what it has not.
    #[serde(default)]
    pub tab: u64,
    /// The version of the text that the viewer's words refer to; comes back with replies.
    #[serde(default)]
    pub version: Option<u64>,
    /// What is asked.
    #[serde(flatten)]
    pub ask: Ask,
}

/// How a number may change.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Adjusted {
    /// How much a change of it counts beside the others'.
    #[serde(default = "one")]
    pub weight: f64,
    /// The value from which changes are counted.
    #[serde(default)]
    pub home: Option<f64>,
}

fn one() -> f64 {
    1.0
}

/// The requests. Places in the text count UTF-16 units.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Ask {
    /// All that there is, as to a viewer that has nothing.
    Open,
    /// What is new since the last reply to this viewer.
    Sync,
    /// The viewer has gone.
    Close,
    /// The whole text anew.
    Text {
        /// The text.
        text: String,
    },
    /// A change set of the text, or several.
    Splice {
        /// Lengths that are kept, and `[removed, line, line ...]`; a list of such lists.
        changes: Vec<Value>,
    },
    /// Values of parameters, and of numbers of objects, before they are written into the text.
    Set {
        /// By name.
        values: BTreeMap<String, f64>,
    },
    /// Gives numbers of the model values by the least change of others, before these are written into the text.
    SolveFor {
        /// Values by expression.
        targets: BTreeMap<String, f64>,
        /// The numbers that may change, by name.
        by: BTreeMap<String, Adjusted>,
    },
    /// Writes what was set into the text; the reply has the edits.
    Commit,
    /// Takes back what was set and not written.
    Reset,
    /// Sets numbers of objects or parameters and writes them; the reply has the edits.
    Write {
        /// By name.
        values: BTreeMap<String, f64>,
    },
    /// What may be dragged at a place, and what moves it.
    DragBegin {
        /// The object.
        object: String,
        /// The parameters of the place: none of a point, t of a curve, u and v of a surface.
        #[serde(default)]
        at: Vec<f64>,
    },
    /// Moves what is dragged as near to a place as it goes.
    DragTo {
        /// The place.
        target: [f64; 3],
        /// Orthogonal unit vectors: only the distance along these counts.
        basis: Vec<[f64; 3]>,
        /// Numbers that follow besides the object's own; by default what the motion needs.
        #[serde(default)]
        names: Vec<String>,
        /// A length that does not matter, such as that of a picture point: numbers are rounded to it.
        #[serde(default)]
        grain: f64,
    },
    /// Ends a drag; the reply has the edits.
    DragEnd {
        /// False to take it back.
        commit: bool,
    },
    /// All about an object.
    Inspect {
        /// Its name.
        name: String,
        /// A parameter to differentiate its numbers by.
        #[serde(default)]
        by: Option<String>,
    },
    /// Expressions to watch; the reply has their values.
    Watch {
        /// The expressions.
        expressions: Vec<String>,
    },
    /// The values of what is watched.
    Measure,
    /// Values of expressions, once.
    Evaluate {
        /// The expressions.
        expressions: Vec<String>,
        /// A parameter to differentiate by.
        #[serde(default)]
        by: Option<String>,
    },
    /// What else is drawn.
    Show {
        /// Sections.
        #[serde(default)]
        contours: Option<bool>,
        /// Objects that the model hides.
        #[serde(default)]
        revealed: Option<Vec<String>>,
    },
    /// Numbers at the vertices of all patches.
    Field {
        /// Which: a name of [`crate::FIELDS`], or `derivative`.
        field: String,
        /// The parameter of `derivative`.
        #[serde(default)]
        by: Option<String>,
    },
    /// Curvature along curves.
    Combs {
        /// The curves.
        names: Vec<String>,
    },
    /// Volume blocks with their quality, the cells that are folded, and a plane of one of them.
    Blocks {
        /// The block of the plane; none without one.
        #[serde(default)]
        block: Option<String>,
        /// The axis along which the plane has one number: 0, 1 or 2.
        #[serde(default)]
        axis: usize,
        /// That number, from 0.
        #[serde(default)]
        index: usize,
    },
    /// Lays a foreign mesh or a table of points over the model; the reply has the overlays.
    Overlay {
        /// The name of the file: its ending says what it is.
        name: String,
        /// Its bytes in base64.
        data: String,
    },
    /// Takes an overlay away, or all; the reply has those that are left.
    RemoveOverlay {
        /// Which.
        #[serde(default)]
        name: Option<String>,
    },
    /// How far the overlays are from the surfaces.
    Deviation,
    /// Immersed areas of sections across x along the model.
    SectionAreas {
        /// How many sections.
        count: usize,
    },
    /// The lines plan on one sheet, as SVG.
    LinesPlan {
        /// Its title.
        #[serde(default)]
        title: String,
    },
    /// Closure and quality of the mesh.
    Mesh,
    /// The hydrostatics.
    Hydrostatics,
    /// Files in one of the formats.
    Export {
        /// Its name.
        format: String,
        /// The name of the files without ending.
        stem: String,
    },
    /// The names of the formats.
    Formats,
    /// What may be typed at a place.
    Complete {
        /// The place.
        offset: usize,
    },
    /// What the name at a place means.
    Hover {
        /// The place.
        offset: usize,
    },
    /// Where the name at a place is declared.
    Definition {
        /// The place.
        offset: usize,
    },
    /// Where an object is declared.
    Locate {
        /// Its name.
        name: String,
    },
    /// The edits that give the name at a place another spelling everywhere.
    Rename {
        /// The place.
        offset: usize,
        /// The new name.
        new: String,
    },
    /// The kinds of objects, with their arguments.
    Kinds,
    /// Writes a statement where it belongs; the reply has the edits.
    Add {
        /// A statement that makes one object or parameter.
        statement: String,
    },
    /// Deletes an object and its statement; the reply has the edits.
    Delete {
        /// Its name.
        name: String,
    },
    /// Writes a statement like that of an object behind it; the reply has the edits and the new name.
    Duplicate {
        /// The object.
        name: String,
    },
    /// Gives an object another name everywhere; the reply has the edits.
    RenameObject {
        /// Its name.
        name: String,
        /// The new name.
        new: String,
    },
    /// The edit that formats the text.
    Format,
    /// The words of the language, for highlighting.
    Words,
    /// Nothing.
    Ping,
}

impl Ask {
    /// True when the scene may change.
    pub fn changes(&self) -> bool {
        matches!(
            self,
            Ask::Open
                | Ask::Sync
                | Ask::Text { .. }
                | Ask::Splice { .. }
                | Ask::Set { .. }
                | Ask::Commit
                | Ask::Reset
                | Ask::Write { .. }
                | Ask::SolveFor { .. }
                | Ask::DragTo { .. }
                | Ask::DragEnd { .. }
                | Ask::Add { .. }
                | Ask::Delete { .. }
                | Ask::Duplicate { .. }
                | Ask::RenameObject { .. }
                | Ask::Show { .. }
        )
    }
}
