//! Hyperbolic marching: volume grids off surfaces, plane grids off curves, collars on surfaces.
//!
//! The first layer is placed on the bisecting normals, so that it has the height asked for at corners, too; each
//! further layer is made by implicit steps (Steger and Chaussee 1980; Chan and Steger 1992) whose volumes
//! smooth themselves over a length of the height reached. Holds: every cell of a grid that is returned has
//! positive Jacobians at all its corners; control flow follows real parts only, so derivatives are those of the
//! steps that were made.
//!
//! `heights, wall -> first layer -> steps, each tested -> layers, report`

mod curve;
mod front;
mod line;
mod report;
mod surface;

pub use curve::{Support, hyperbolic_curve, hyperbolic_curve_until};
pub use front::{FailureCause, MarchFailure};
pub(crate) use report::hexahedron;
pub use report::{MarchReport, StopReason};
pub use surface::{hyperbolic, hyperbolic_until};

use crate::{GridError, SurfaceGrid};
use moldloft_num::Real;

/// What happens at an edge of the surface, or an end of the curve, that a grid is marched from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// The edge goes where the equations, one-sided there, take it.
    #[default]
    Free,
    /// The edge stays in the plane x = const (0), y = const (1) or z = const (2) that it lies in: a
    /// plane of symmetry, which the grid lines cross at right angles.
    Symmetry(usize),
    /// The edge keeps its x (0), y (1) or z (2) and is free otherwise.
    Constant(usize),
    /// The edge is a point (a nose, a tail), and all its points move as one.
    Pole,
    /// The edge and the opposite one are the same line: the surface closes.
    Periodic,
}

/// When a march ends before its last height. With the default it never does: what cannot be marched to the
/// last height is an error.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop {
    /// Keeps the layers below the one that cannot be marched, instead of refusing all.
    pub keep: bool,
    /// Ends below the first layer with a scaled Jacobian less than this.
    pub jacobian: f64,
    /// Ends below the first layer with an equiangle skewness greater than this.
    pub skewness: f64,
    /// Ends below the first layer in which a line's cell is more than so many times the one below, or less
    /// than its reciprocal.
    pub growth: f64,
    /// Ends with the first layer whose mean cell is at least as high as it is long.
    pub isotropic: bool,
}

impl Default for Stop {
    fn default() -> Self {
        Self {
            keep: false,
            jacobian: 0.0,
            skewness: f64::INFINITY,
            growth: f64::INFINITY,
            isotropic: false,
        }
    }
}

/// How a grid is marched.
#[derive(Clone, Debug, PartialEq)]
pub struct Hyperbolic<T> {
    /// The distances of the layers from the wall, the first 0. The first cell is kept everywhere; further out
    /// heights are means, since volumes are smoothed.
    pub heights: Vec<T>,
    /// At the edges s[1,], s[m,], s[,1], s[,n]; of a curve the first two.
    pub sides: [Side; 4],
    /// How strongly lines that converge are smoothed apart; 1 for nearly everything, 0 for not at all.
    pub smoothing: f64,
    /// When to end early.
    pub stop: Stop,
}

impl<T: Real> Hyperbolic<T> {
    /// Free edges, ordinary smoothing, and no early end.
    pub fn new(heights: Vec<T>) -> Self {
        Self { heights, sides: [Side::Free; 4], smoothing: 1.0, stop: Stop::default() }
    }

    /// The same with sides.
    pub fn with_sides(mut self, sides: [Side; 4]) -> Self {
        self.sides = sides;
        self
    }

    fn check(&self) -> Result<(), GridError> {
        for (k, height) in self.heights.iter().enumerate() {
            let before = if k == 0 { -f64::MIN_POSITIVE } else { self.heights[k - 1].re() };
            let ascends = height.re() > before && height.is_finite();
            if !ascends || (k == 0 && height.re() != 0.0) {
                return Err(GridError::Heights { at: k + 1, value: height.re() });
            }
        }
        Ok(())
    }
}

/// A marched grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Marched<T> {
    /// The layers, the wall first; off a curve one grid whose line s\[k,\] is layer k.
    pub layers: Vec<SurfaceGrid<T>>,
    /// How it went.
    pub report: MarchReport,
}
