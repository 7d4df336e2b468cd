//! Options of a march, and criteria of an early end.

use super::line::{Matrix, add, mirrored};
use moldloft_num::{Real, Vec3};

/// Condition at an edge of the surface, or an end of the curve, that is marched.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum MarchBoundary {
    /// The edge follows the equations, which are one-sided there.
    #[default]
    Free,
    /// The edge stays in its plane x = const (0), y = const (1) or z = const (2), a plane of
    /// symmetry to which the grid lines are perpendicular.
    Symmetry(usize),
    /// The edge is free and leans outward: the surface is continued beyond it by cells that are longer than the
    /// last one by this share, and steps are extrapolated by it (0 is [`MarchBoundary::Free`]).
    Splay(f64),
    /// The edge keeps its x (0), y (1) or z (2) and is free otherwise.
    Constant(usize),
    /// The edge moves along x (0), y (1) or z (2) and keeps the other two coordinates.
    Along(usize),
    /// The edge is a point (a nose, a tail), and all its points move as one.
    Pole,
    /// The edge and the opposite one are the same line: the surface closes.
    Periodic,
}

impl MarchBoundary {
    /// The coordinates that points of the edge keep.
    pub(super) fn kept(self) -> [bool; 3] {
        let mut kept = [false; 3];
        match self {
            Self::Symmetry(axis) | Self::Constant(axis) => kept[axis] = true,
            Self::Along(axis) => kept = [0, 1, 2].map(|k| k != axis),
            _ => {}
        }
        kept
    }

    /// The ghost beyond an edge, opposite to the neighbour inside.
    pub(super) fn beyond<T: Real>(self, here: Vec3<T>, inner: Vec3<T>) -> Vec3<T> {
        match self {
            Self::Symmetry(plane) => reflected(inner, plane, here[plane]),
            Self::Splay(share) => here * T::from(2.0 + share) - inner * T::from(1.0 + share),
            _ => here * T::from(2.0) - inner,
        }
    }

    /// The step of the ghost: that of the edge, its extrapolation, or the mirror image of that inside.
    pub(super) fn beyond_step<T: Real>(self, here: Vec3<T>, inner: Vec3<T>) -> Vec3<T> {
        match self {
            Self::Symmetry(plane) => reflected(inner, plane, T::zero()),
            Self::Splay(share) => here * T::from(1.0 + share) - inner * T::from(share),
            _ => here,
        }
    }

    /// Adds the term of the ghost's step, `outer`, to those of the edge and of the neighbour inside.
    pub(super) fn close<T: Real>(
        self,
        middle: &mut Matrix<T>,
        outer: &Matrix<T>,
        inner: &mut Matrix<T>,
    ) {
        match self {
            Self::Symmetry(plane) => add(inner, &mirrored(outer, plane)),
            Self::Splay(share) => {
                add(middle, &outer.map(|row| row.map(|x| x * (1.0 + share))));
                add(inner, &outer.map(|row| row.map(|x| x * -share)));
            }
            _ => add(middle, outer),
        }
    }
}

/// A point reflected in the plane where a coordinate has a value.
pub(super) fn reflected<T: Real>(point: Vec3<T>, coordinate: usize, value: T) -> Vec3<T> {
    let mut image = point.to_array();
    image[coordinate] = value * T::from(2.0) - image[coordinate];
    image.into()
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
