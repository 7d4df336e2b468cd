//! Open questions of the program.

use crate::object::SketchFace;
use crate::{CoordinateAxis, PointId};

/// A question that waits for ACCEPT, REJECT, REVERSE, REPEAT, YES or NO.
#[derive(Clone, Debug)]
pub(crate) enum Question {
    /// Is the estimated value right?
    Dimension { name: String, axis: CoordinateAxis, p: PointId, q: PointId, value: f64 },
    /// Is this candidate a face?
    Face { object: String, left: Vec<Vec<Vec<PointId>>>, taken: Vec<SketchFace> },
    /// Selection of one of several solids.
    Solid { object: String, faces: Vec<Vec<SketchFace>> },
}
