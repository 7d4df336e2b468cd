//! Errors of grids, with the position.

use crate::GridSide;
use crate::marching::JoinFault;
use crate::marching::outcome::{MarchFailure, MarchPlace};
use moldloft_budget::Spent;
use std::fmt;

/// A corner of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corner {
    /// The edge that it is an end of.
    pub edge: GridSide,
    /// The edge that should end there, too.
    pub other: GridSide,
    /// The indices of the corner, from 1.
    pub at: [usize; 2],
}

/// Why there is no such grid.
#[derive(Clone, Debug, PartialEq)]
pub enum GridError {
    /// Too few points in a direction.
    TooFew {
        /// The fewest.
        expected: usize,
        /// The numbers in both directions.
        actual: [usize; 2],
    },
    /// A point is NaN or infinite.
    NotFinite {
        /// Its indices, from 1.
        at: [usize; 2],
    },
    /// Two edges do not meet in their common corner.
    EdgesApart {
        /// The corner.
        corner: Corner,
        /// Distance at this position.
        gap: f64,
    },
    /// Two faces of a block do not have an edge in common.
    FacesApart {
        /// The faces, 1 to 6.
        faces: [usize; 2],
        /// The point of the first face at which they differ most, from 1.
        at: [usize; 2],
        /// Distance at this position.
        gap: f64,
    },
    /// The sizes of the faces of a block do not fit.
    FaceSizes {
        /// The face, 1 to 6.
        face: usize,
        /// The size it must have.
        expected: [usize; 2],
        /// The size it has.
        actual: [usize; 2],
    },
    /// The grid has cells that are turned over.
    Folded {
        /// Number.
        count: usize,
        /// The first one, from 1.
        at: [usize; 2],
        /// The layer, from 1, of a marched grid.
        layer: Option<usize>,
    },
    /// A point of a volume grid is NaN or infinite.
    PointNotFinite {
        /// Its indices, from 1.
        at: [usize; 3],
    },
    /// A grid cannot be marched farther.
    March(Box<MarchFailure>),
    /// The iteration grew beyond bounds.
    Diverged {
        /// The sweep or layer, from 1.
        step: usize,
    },
    /// The call was cancelled, or memory or time are used up.
    Spent(Spent),
    /// Heights do not ascend from 0.
    Heights {
        /// The index, from 1, of the one that does not.
        at: usize,
        /// Its value.
        value: f64,
    },
    /// Edges that should be periodic are not the same line.
    NotPeriodic {
        /// The indices of the first point that differs, from 1.
        at: [usize; 2],
        /// Its distance from its place.
        gap: f64,
    },
    /// A surface has no normal at a point.
    NoNormal {
        /// The point.
        at: MarchPlace,
    },
    /// Surfaces that are no front together.
    Join(Box<JoinFault>),
}

impl fmt::Display for GridError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFew { expected, actual: [m, n] } => {
                write!(f, "expected at least {expected} points in each direction, found [{m},{n}]")
            }
            Self::NotFinite { at: [i, j] } => write!(f, "point [{i},{j}] is not finite"),
            Self::EdgesApart { corner, gap } => {
                let Corner { edge, other, at: [i, j] } = corner;
                write!(f, "edges {edge} and {other} do not meet: at [{i},{j}] they are {gap} apart")
            }
            Self::FacesApart { faces: [a, b], at: [i, j], gap } => {
                write!(
                    f,
                    "faces {a} and {b} do not meet: at [{i},{j}] of face {a} they are {gap} apart"
                )
            }
            Self::FaceSizes { face, expected: [a, b], actual: [m, n] } => {
                write!(f, "face {face} is [{m},{n}] where the others require [{a},{b}]")
            }
            Self::Folded { count, at: [i, j], layer } => {
                write!(f, "{count} cells are folded, the first at [{i},{j}]")?;
                layer.map_or(Ok(()), |layer| write!(f, " of layer {layer}"))
            }
            Self::PointNotFinite { at: [i, j, k] } => {
                write!(f, "point [{i},{j},{k}] is not finite")
            }
            Self::March(failure) => write!(f, "{failure}"),
            Self::Diverged { step } => write!(f, "the grid diverged in step {step}"),
            Self::Spent(spent) => write!(f, "{spent}"),
            Self::Heights { at, value } => {
                write!(f, "heights ascend from 0, but height {at} is {value}")
            }
            Self::NotPeriodic { at: [i, j], gap } => {
                write!(
                    f,
                    "the edges are not periodic: point [{i},{j}] is {gap} off the place of its partner"
                )
            }
            Self::NoNormal { at } => write!(f, "no normal at point {at}"),
            Self::Join(fault) => write!(f, "{fault}"),
        }
    }
}

impl std::error::Error for GridError {}

impl From<Spent> for GridError {
    fn from(spent: Spent) -> Self {
        Self::Spent(spent)
    }
}
