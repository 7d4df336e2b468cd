//! Subject of a reply, as data beside its text.

use crate::{CoordinateAxis, FaceId, LineId, PointId};

/// Subject of a reply: its kind, and the parts of the object concerned.
///
/// ```
/// use moldloft_sketch::{PointId, SketchSession};
/// let mut s = SketchSession::new();
/// s.run_text("SKETCH A 2D XZ\nPOINT 1 0 0; POINT 2 90 0; LINE 1 2");
/// let missing = s.run_line("CHECK").into_iter().find(|r| r.about.kind == "missing-dimension");
/// let about = missing.unwrap().about;
/// assert_eq!(about.points, [PointId(2)]);
/// assert_eq!(about.suggestion.map(|s| s.value), Some(90.0));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReplySubject {
    /// Kind of the reply, a stable word such as `missing-dimension`; every error has one, plain
    /// text is "".
    pub kind: &'static str,
    /// Points, in the order of the text; those of a chain from its start to its end.
    pub points: Vec<PointId>,
    /// Lines.
    pub lines: Vec<LineId>,
    /// Faces.
    pub faces: Vec<FaceId>,
    /// Dimensions, variables, curves and objects.
    pub names: Vec<String>,
    /// The axis.
    pub axis: Option<CoordinateAxis>,
    /// The number in the text: a distance, a coordinate, or a confidence from 0 to 1.
    pub value: Option<f64>,
    /// The position in space.
    pub place: Option<[f64; 3]>,
    /// The dimension that would supply a missing one.
    pub suggestion: Option<Suggestion>,
}

/// A dimension suggested by the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Suggestion {
    /// Its axis.
    pub axis: CoordinateAxis,
    /// From.
    pub p: PointId,
    /// End point, on the positive side.
    pub q: PointId,
    /// The distance, to three digits.
    pub value: f64,
    /// True if the picture does not determine the depth, so that the value is a guess.
    pub open: bool,
}

impl ReplySubject {
    /// A kind without parts.
    pub fn of(kind: &'static str) -> ReplySubject {
        ReplySubject { kind, ..ReplySubject::default() }
    }

    pub(super) fn points(mut self, points: impl IntoIterator<Item = PointId>) -> ReplySubject {
        self.points.extend(points);
        self
    }

    pub(super) fn lines(mut self, lines: impl IntoIterator<Item = LineId>) -> ReplySubject {
        self.lines.extend(lines);
        self
    }

    pub(super) fn faces(mut self, faces: impl IntoIterator<Item = FaceId>) -> ReplySubject {
        self.faces.extend(faces);
        self
    }

    pub(super) fn names<'a>(mut self, names: impl IntoIterator<Item = &'a String>) -> ReplySubject {
        self.names.extend(names.into_iter().cloned());
        self
    }

    pub(super) fn axis(mut self, axis: CoordinateAxis) -> ReplySubject {
        self.axis = Some(axis);
        self
    }

    pub(super) fn value(mut self, value: impl Into<Option<f64>>) -> ReplySubject {
        self.value = value.into();
        self
    }

    pub(super) fn place(mut self, at: moldloft_num::Vec3) -> ReplySubject {
        self.place = Some(at.to_array());
        self
    }
}

/// Subject of an error about all missing dimensions: their points, and the first suggestion.
pub(super) fn all_missing(lines: Vec<(String, ReplySubject)>) -> ReplySubject {
    let mut all = ReplySubject::of("missing-dimension");
    for (_, about) in lines {
        all.points.extend(about.points);
        if all.suggestion.is_none() {
            (all.axis, all.suggestion) = (about.axis, about.suggestion);
        }
    }
    all
}
