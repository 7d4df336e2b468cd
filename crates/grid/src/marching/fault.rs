//! Reasons why surfaces are no front together.

use super::outcome::MarchPlace;
use crate::GridSide;
use std::fmt;

/// Why several surfaces cannot be marched as one front.
#[derive(Clone, Debug, PartialEq)]
pub enum JoinFault {
    /// There is no surface, or the conditions are those of another number of surfaces.
    Count {
        /// Number of surfaces.
        surfaces: usize,
        /// Number of their conditions.
        conditions: usize,
    },
    /// A surface is too small, or a point of it is not finite.
    Surface {
        /// The surface, from 1.
        surface: usize,
        /// Why.
        cause: Box<crate::GridError>,
    },
    /// Two neighbouring points of an edge coincide, but the edge is not one point.
    Coincident {
        /// The second of the points.
        at: MarchPlace,
    },
    /// More than two cells meet at an edge between two points.
    ThreeMeet {
        /// An end of the edge.
        at: MarchPlace,
    },
    /// An edge ends, or has points, inside another surface or between the points of another edge.
    Hanging {
        /// The point.
        at: MarchPlace,
        /// The point of the other surface, or the one before it.
        other: MarchPlace,
    },
    /// An edge is nearly one with others.
    Apart {
        /// The point of the edge that is farthest from them.
        at: MarchPlace,
        /// Its distance.
        gap: f64,
    },
    /// No choice of sides is consistent, as on a Moebius strip.
    NotOrientable {
        /// A point at which both sides meet.
        at: MarchPlace,
    },
    /// Parts of the front have only a point in common.
    Pinched {
        /// The point.
        at: MarchPlace,
    },
    /// Two cells, or one, are all around a point, as at the end of a pinched edge: its line is in the plane of
    /// two edges of a cell, which is flat there in any grid.
    TwoCells {
        /// The point.
        at: MarchPlace,
    },
    /// More than three cells at a point of a free edge.
    Crowded {
        /// The point.
        at: MarchPlace,
        /// Number of cells.
        cells: usize,
    },
    /// A condition for an edge that is joined or collapsed.
    NotOpen {
        /// The surface, from 1.
        surface: usize,
        /// The edge.
        edge: GridSide,
    },
    /// A condition of a collapsed or periodic edge for an open one.
    Open {
        /// The surface, from 1.
        surface: usize,
        /// The edge.
        edge: GridSide,
    },
    /// An open edge is not in a plane of constant coordinate.
    NotPlane {
        /// The point that is out of it.
        at: MarchPlace,
        /// x (0), y (1) or z (2).
        axis: usize,
        /// Its distance from the plane of the edge's first point.
        gap: f64,
    },
}

impl fmt::Display for JoinFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count { surfaces: 0, .. } => write!(f, "there is no surface"),
            Self::Count { surfaces, conditions } => {
                write!(f, "{conditions} conditions were given for {surfaces} surfaces")
            }
            Self::Surface { surface, cause } => write!(f, "surface {surface}: {cause}"),
            Self::Coincident { at } => write!(
                f,
                "point {at} coincides with the point before it, but the edge is not one point"
            ),
            Self::ThreeMeet { at } => write!(f, "more than two cells meet at the edge at {at}"),
            Self::Hanging { at, other } => write!(
                f,
                "the edge at {at} meets an edge or the inside at {other} without joining it point by point"
            ),
            Self::Apart { at, gap } => write!(
                f,
                "the edge at {at} is {gap:.3e} from other edges: they nearly meet, but are not joined"
            ),
            Self::NotOrientable { at } => {
                write!(f, "the surfaces have no consistent side: both sides meet at {at}")
            }
            Self::Pinched { at } => {
                write!(f, "parts of the surfaces have only the point {at} in common")
            }
            Self::TwoCells { at } => write!(
                f,
                "two cells are all around {at}, where any grid has a flat cell: close a tip with surfaces, or in a point"
            ),
            Self::Crowded { at, cells } => {
                write!(f, "{cells} cells meet at {at} of a free edge, where at most 3 can")
            }
            Self::NotOpen { surface, edge } => {
                write!(f, "edge {edge} of surface {surface} is joined and takes no condition")
            }
            Self::Open { surface, edge } => {
                write!(f, "edge {edge} of surface {surface} is neither one point nor joined")
            }
            Self::NotPlane { at, axis, gap } => write!(
                f,
                "the open edge at {at} is {gap:.3e} off the plane of constant {}",
                ["x", "y", "z"][*axis]
            ),
        }
    }
}
