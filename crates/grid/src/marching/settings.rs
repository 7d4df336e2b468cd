//! Options of a march, and criteria of an early end.

use moldloft_num::Real;

/// Condition at an edge of the surface, or an end of the curve, that is marched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MarchBoundary {
    /// The edge follows the equations, which are one-sided there.
    #[default]
    Free,
    /// The edge stays in its plane x = const (0), y = const (1) or z = const (2), a plane of
    /// symmetry to which the grid lines are perpendicular.
    Symmetry(usize),
    /// The edge keeps its x (0), y (1) or z (2) and is free otherwise.
    Constant(usize),
    /// The edge is a point (a nose, a tail), and all its points move as one.
    Pole,
    /// The edge and the opposite one are the same line: the surface closes.
    Periodic,
}

/// Criteria for an end before the last height. By default there is none: a march that cannot reach
/// the last height is an error.
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

/// Options of hyperbolic marching.
#[derive(Clone, Debug, PartialEq)]
pub struct Hyperbolic<T> {
    /// The distances of the layers from the wall, the first 0. The first cell is kept everywhere; further out
    /// heights are means, since volumes are smoothed.
    pub heights: Vec<T>,
    /// At the edges `s[1,]`, `s[m,]`, `s[,1]`, `s[,n]`; of a curve the first two.
    pub sides: [MarchBoundary; 4],
    /// Factor of the smoothing where lines converge: 1 suits nearly every wall, 0 is none.
    pub smoothing: f64,
    /// When to end early.
    pub stop: Stop,
}

impl<T: Real> Hyperbolic<T> {
    /// Free edges, ordinary smoothing, and no early end.
    pub fn new(heights: Vec<T>) -> Self {
        Self { heights, sides: [MarchBoundary::Free; 4], smoothing: 1.0, stop: Stop::default() }
    }

    /// The settings with these sides.
    pub fn with_sides(mut self, sides: [MarchBoundary; 4]) -> Self {
        self.sides = sides;
        self
    }
}
