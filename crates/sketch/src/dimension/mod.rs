//! Dimensions: measured quantities, values, and the resulting coordinates.
//!
//! `expressions -> values -> coordinates of planes`; dimensions that are not along an axis are solved
//! for last.

pub(crate) mod expr;
pub(crate) mod layout;
pub(crate) mod solver;

use crate::{CoordinateAxis, DimensionExpr, LineId, PointId};

/// The quantity that a dimension fixes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeasuredQuantity {
    /// `coordinate(q) - coordinate(p)` on an axis, with its sign.
    Along {
        /// The axis.
        axis: CoordinateAxis,
        /// From.
        p: PointId,
        /// To.
        q: PointId,
    },
    /// The coordinate of a point (and so of its plane).
    Datum {
        /// The axis.
        axis: CoordinateAxis,
        /// The point.
        point: PointId,
    },
    /// The true length of a line.
    Length(LineId),
    /// Run per rise of a line: horizontal length divided by the difference in height (1V : n H).
    Slope(LineId),
    /// The angle between two lines in degrees, as vectors away from their common point.
    Angle(LineId, LineId),
    /// The second line is `value` times as long as the first.
    Equal(LineId, LineId),
}

/// Role of a dimension on its axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DimensionRole {
    /// It does.
    Driving,
    /// It shows a value that the others determine.
    Reference,
}

/// A dimension.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimension {
    /// The name as written by the user.
    pub name: String,
    /// The quantity.
    pub measure: MeasuredQuantity,
    /// Its value, in model units or degrees; `None` when it was unset.
    pub value: Option<DimensionExpr>,
    /// Driving or measuring.
    pub role: DimensionRole,
    /// The valid range, for sliders and studies.
    pub range: Option<[f64; 2]>,
}

/// A named number.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// As the user wrote it.
    pub name: String,
    /// Its value.
    pub value: DimensionExpr,
    /// The valid range.
    pub range: Option<[f64; 2]>,
}
