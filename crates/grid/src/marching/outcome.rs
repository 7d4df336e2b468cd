//! The report of a march, and the reason of its end.

use moldloft_num::Vec3;
use std::fmt;

/// A node or cell of a front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MarchPlace {
    /// The surface, from 1, of a front of several.
    pub surface: Option<usize>,
    /// The indices, from 1; 1 in the second index off curves.
    pub at: [usize; 2],
}

impl fmt::Display for MarchPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [i, j] = self.at;
        write!(f, "[{i},{j}]")?;
        self.surface.map_or(Ok(()), |surface| write!(f, " of surface {surface}"))
    }
}

/// Why a march ended before its last height.
#[derive(Clone, Debug, PartialEq)]
pub enum StopReason {
    /// The next layer cannot be marched.
    Failure(MarchFailure),
    /// The next layer has a cell of this scaled Jacobian.
    Jacobian(f64),
    /// The next layer has a cell of this skewness.
    Skewness(f64),
    /// The next layer has a cell with this ratio to the one below.
    Growth(f64),
    /// Cells are as high as they are long.
    Isotropic,
}

impl fmt::Display for StopReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Failure(failure) => write!(f, "{failure}"),
            Self::Jacobian(x) => write!(f, "the next layer has a scaled Jacobian of {x:.3}"),
            Self::Skewness(x) => write!(f, "the next layer has a skewness of {x:.3}"),
            Self::Growth(x) => write!(f, "cells of the next layer grow by {x:.3}"),
            Self::Isotropic => write!(f, "cells are as high as they are long"),
        }
    }
}

/// Report of a march.
#[derive(Clone, Debug, PartialEq)]
pub struct MarchReport {
    /// Layers, the wall among them.
    pub layers: usize,
    /// Steps that were made for them.
    pub steps: usize,
    /// Number of the required setting: 1, 2 without a cap on smoothed volumes, 3 with more
    /// smoothing.
    pub rung: usize,
    /// The least scaled Jacobian at a corner of a cell.
    pub jacobian: f64,
    /// Position: layer above the cell, from 1, and the cell.
    pub layer: usize,
    /// The cell.
    pub at: MarchPlace,
    /// The largest equiangle skewness of a cell's corners.
    pub skewness: f64,
    /// The least and the greatest distance of the first layer from the wall.
    pub first_cell: [f64; 2],
    /// The largest angle between a line and the bisecting normal at the wall, in radians.
    pub wall_angle: f64,
    /// The largest ratio of a line's cell to the one below, or of that to it.
    pub growth: f64,
    /// Why it ended before the last height.
    pub stopped: Option<StopReason>,
}

/// Why a layer cannot be marched.
#[derive(Clone, Debug, PartialEq)]
pub enum FailureCause {
    /// The first cell does not fit into a concave corner: lines off the neighbours of the corner cross those off
    /// the corner.
    CornerTooTight {
        /// The angle of the corner on the grid's side, in degrees.
        angle: f64,
        /// The spacing of the points beside the corner.
        spacing: f64,
        /// The given first cell height.
        height: f64,
        /// The largest one that fits.
        fits: f64,
    },
    /// A corner of a cell is turned over; its scaled Jacobian.
    Folded(f64),
    /// Grid lines meet: an edge of the layer has shrunk to nothing.
    LinesMeet,
    /// The layer crosses that above another part of the wall, or the wall there.
    LayersMeet {
        /// The node of that part.
        other: MarchPlace,
        /// The point of the wall there.
        wall: Vec3,
    },
    /// The layer takes more steps than are made.
    TooManySteps(usize),
    /// The equations have no finite solution.
    NotFinite,
}

/// Position and reason of a march's end.
#[derive(Clone, Debug, PartialEq)]
pub struct MarchFailure {
    /// The layer, from 1 (the wall).
    pub layer: usize,
    /// The node or cell of it.
    pub at: MarchPlace,
    /// The point of the wall below it.
    pub wall: Vec3,
    /// Why.
    pub cause: FailureCause,
}

impl fmt::Display for MarchFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let at = self.at;
        let Vec3 { x, y, z } = self.wall;
        let layer = self.layer;
        match &self.cause {
            FailureCause::CornerTooTight { angle, spacing, height, fits } => write!(
                f,
                "the first cell of {height:.3e} does not fit into the concave corner of {angle:.1} degrees at \
                 {at}, where points are {spacing:.3e} apart: it fits up to {fits:.3e}"
            ),
            FailureCause::Folded(jacobian) => write!(
                f,
                "layer {layer} folds at {at} above ({x:.4}, {y:.4}, {z:.4}): scaled Jacobian {jacobian:.3}"
            ),
            FailureCause::LinesMeet => {
                write!(f, "grid lines meet in layer {layer} at {at} above ({x:.4}, {y:.4}, {z:.4})")
            }
            FailureCause::LayersMeet { other, wall: Vec3 { x: u, y: v, z: w } } => write!(
                f,
                "layer {layer} at {at} above ({x:.4}, {y:.4}, {z:.4}) meets the grid at {other} above \
                 ({u:.4}, {v:.4}, {w:.4})"
            ),
            FailureCause::TooManySteps(steps) => {
                write!(f, "layer {layer} is not reached in {steps} steps")
            }
            FailureCause::NotFinite => write!(
                f,
                "layer {layer} has no finite solution at {at} above ({x:.4}, {y:.4}, {z:.4})"
            ),
        }
    }
}
