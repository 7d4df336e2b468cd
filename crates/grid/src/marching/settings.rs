//! How a grid is marched, and when a march ends early.

use moldloft_num::Real;

/// What happens at an edge of the surface, or an end of the curve, that a grid is marched from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MarchBoundary {
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
    /// Ends below the first layer in which the ratio of a cell to the one below exceeds this or is
    /// less than its reciprocal.
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
    pub sides: [MarchBoundary; 4],
    /// How strongly lines that converge are smoothed apart; 1 for nearly everything, 0 for not at all.
    pub smoothing: f64,
    /// When to end early.
    pub stop: Stop,
}

impl<T: Real> Hyperbolic<T> {
    /// Free edges, ordinary smoothing, and no early end.
    pub fn new(heights: Vec<T>) -> Self {
        Self { heights, sides: [MarchBoundary::Free; 4], smoothing: 1.0, stop: Stop::default() }
    }

    /// The same with sides.
    pub fn with_sides(mut self, sides: [MarchBoundary; 4]) -> Self {
        self.sides = sides;
        self
    }
}
