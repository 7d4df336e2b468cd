//! The requests of the workbench.

use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// A request with its sender.
#[derive(Clone, Debug, Deserialize)]
pub struct Request {
    /// Id, repeated in the reply.
    #[serde(default)]
    pub id: u64,
    /// The viewer that sends it; replies contain the changes since the last reply to it.
    #[serde(default)]
    pub tab: u64,
    /// The version of the text that offsets refer to; repeated in the reply.
    #[serde(default)]
    pub version: Option<u64>,
    /// Number of halvings by which the cells of bodies of sets are larger than stated, for a change
    /// while a number moves; see [`Ask::settles`].
    #[serde(default)]
    pub coarser: u32,
    /// The request.
    #[serde(flatten)]
    pub ask: Ask,
}

/// Options of a number that may change.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Adjusted {
    /// Weight of its change.
    #[serde(default = "one")]
    pub weight: f64,
    /// The value from which changes are measured.
    #[serde(default)]
    pub home: Option<f64>,
}

fn one() -> f64 {
    1.0
}

/// The requests. Offsets in the text are UTF-16 units.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Ask {
    /// The complete state, for a new viewer.
    Open,
    /// Changes since the last reply to this viewer.
    Sync,
    /// Makes bodies exact that a change with `coarser` has made coarser.
    Settle,
    /// Ends the viewer.
    Close,
    /// Replaces the text.
    Text {
        /// The text.
        text: String,
    },
    /// Replaces the text of a file beside the document.
    TextBeside {
        /// The file's name, as in the fact `reads`.
        name: String,
        /// The text; without one the file counts again.
        text: Option<String>,
    },
    /// The files that the text reads, directly or through other files.
    Reads,
    /// Applies one or several change sets to the text.
    Splice {
        /// Change sets of CodeMirror: lists of retained lengths and of `[removed, line, line ...]`.
        changes: Vec<Value>,
    },
    /// Sets parameters and numbers of objects without writing them to the text.
    Set {
        /// Values by name.
        values: BTreeMap<String, f64>,
    },
    /// Adjusts numbers by the least change that gives expressions the stated values, without
    /// writing them to the text.
    SolveFor {
        /// Target values by expression.
        targets: BTreeMap<String, f64>,
        /// Names of the numbers that may change.
        by: BTreeMap<String, Adjusted>,
    },
    /// Writes the set values to the text; the reply has the edits.
    Commit,
    /// Reverts set values that are not written to the text.
    Reset,
    /// Sets parameters and numbers of objects and writes them to the text; the reply has the edits.
    Write {
        /// Values by name.
        values: BTreeMap<String, f64>,
    },
    /// Starts a drag; the reply has the numbers that move the point.
    DragBegin {
        /// The object.
        object: String,
        /// Parameters of the point on the object: none for a point, t for a curve, u and v for a
        /// surface.
        #[serde(default)]
        at: Vec<f64>,
    },
    /// Moves the dragged point as near to a target as possible.
    DragTo {
        /// The target position.
        target: [f64; 3],
        /// Orthonormal vectors; only distances along these are minimised.
        basis: Vec<[f64; 3]>,
        /// Numbers to adjust in addition to the object's own; by default those that the motion
        /// requires.
        #[serde(default)]
        names: Vec<String>,
        /// Rounding unit of numbers, as a length, such as the size of a pixel.
        #[serde(default)]
        grain: f64,
    },
    /// Ends a drag; the reply has the edits.
    DragEnd {
        /// False to revert the drag.
        commit: bool,
    },
    /// Details of an object.
    Inspect {
        /// Its name.
        name: String,
        /// A parameter with respect to which its numbers are differentiated.
        #[serde(default)]
        by: Option<String>,
    },
    /// Expressions to watch; the reply has their values.
    Watch {
        /// The expressions.
        expressions: Vec<String>,
    },
    /// Values of the watched expressions.
    Measure,
    /// Values of expressions, without watching them.
    Evaluate {
        /// The expressions.
        expressions: Vec<String>,
        /// A parameter with respect to which they are differentiated.
        #[serde(default)]
        by: Option<String>,
    },
    /// Selects additional items of the scene.
    Show {
        /// True to draw sections.
        #[serde(default)]
        contours: Option<bool>,
        /// Hidden objects to draw.
        #[serde(default)]
        revealed: Option<Vec<String>>,
    },
    /// A field at the vertices of all patches.
    Field {
        /// A name of [`crate::FIELDS`], or `derivative`.
        field: String,
        /// The parameter of `derivative`.
        #[serde(default)]
        by: Option<String>,
    },
    /// Curvature combs of curves.
    Combs {
        /// The curves.
        names: Vec<String>,
    },
    /// Volume blocks with their quality, folded cells, and one grid plane.
    Blocks {
        /// The block of the grid plane, if one is requested.
        #[serde(default)]
        block: Option<String>,
        /// The axis of constant index: 0, 1 or 2.
        #[serde(default)]
        axis: usize,
        /// The index, from 0.
        #[serde(default)]
        index: usize,
    },
    /// Lays a mesh or a table of points over the model; the reply has the overlays.
    Overlay {
        /// File name; its extension gives the format.
        name: String,
        /// File content in base64.
        data: String,
    },
    /// Removes an overlay, or all; the reply has the remaining ones.
    RemoveOverlay {
        /// Its name; all without one.
        #[serde(default)]
        name: Option<String>,
    },
    /// Distances of the overlays from the surfaces.
    Deviation,
    /// The curve of immersed section areas along x.
    SectionAreas {
        /// Number of sections.
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
    /// Exports the model.
    Export {
        /// Its name.
        format: String,
        /// File name without extension.
        stem: String,
    },
    /// The names of the formats.
    Formats,
    /// Completions at an offset.
    Complete {
        /// The offset.
        offset: usize,
    },
    /// Description of the name at an offset.
    Hover {
        /// The offset.
        offset: usize,
    },
    /// Declaration of the name at an offset.
    Definition {
        /// The offset.
        offset: usize,
    },
    /// Declaration of an object.
    Locate {
        /// Its name.
        name: String,
    },
    /// Edits that rename all uses of the name at an offset.
    Rename {
        /// The offset.
        offset: usize,
        /// The new name.
        new: String,
    },
    /// The kinds of objects, with their arguments.
    Kinds,
    /// Inserts a statement; the reply has the edits.
    Add {
        /// A statement that declares one object or parameter.
        statement: String,
    },
    /// Deletes an object and its statement; the reply has the edits.
    Delete {
        /// Its name.
        name: String,
    },
    /// Copies the statement of an object; the reply has the edits and the new name.
    Duplicate {
        /// The object.
        name: String,
    },
    /// Moves the statement of an object before that of another one; the reply has the edits.
    Reorder {
        /// The object.
        name: String,
        /// The object beside which it comes.
        beside: String,
        /// True for behind it.
        #[serde(default)]
        behind: bool,
    },
    /// Renames an object and all its uses; the reply has the edits.
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
    /// Does nothing; the reply shows that the engine is running.
    Ping,
}

impl Ask {
    /// True when a request without `coarser` makes coarser bodies exact first: it changes the model
    /// or answers with figures of it. The scene follows by `settle`.
    pub fn settles(&self) -> bool {
        match self {
            Ask::Open | Ask::Sync | Ask::Show { .. } => false,
            Ask::Settle
            | Ask::Inspect { .. }
            | Ask::Measure
            | Ask::Evaluate { .. }
            | Ask::Field { .. }
            | Ask::Deviation
            | Ask::SectionAreas { .. }
            | Ask::LinesPlan { .. }
            | Ask::Mesh
            | Ask::Hydrostatics
            | Ask::Export { .. } => true,
            other => other.changes(),
        }
    }

    /// True when the request may change the scene.
    pub fn changes(&self) -> bool {
        matches!(
            self,
            Ask::Open
                | Ask::Sync
                | Ask::Settle
                | Ask::Text { .. }
                | Ask::TextBeside { .. }
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
                | Ask::Reorder { .. }
                | Ask::RenameObject { .. }
                | Ask::Show { .. }
        )
    }
}
