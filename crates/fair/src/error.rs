//! Errors of fairing.

use std::fmt;

/// Reason why a curve or surface cannot be faired.
#[derive(Clone, Debug, PartialEq)]
pub enum FairError {
    /// Too few control points for the degree.
    TooFew {
        /// The minimum number.
        expected: usize,
        /// The number given.
        actual: usize,
    },
    /// Coordinates are so large or small that squares in the measures leave the range of double
    /// precision.
    Range {
        /// The largest coordinate.
        size: f64,
    },
    /// A coordinate is NaN or infinite.
    NotFinite {
        /// Index of the point, from 0.
        index: usize,
    },
    /// Two neighbouring data points coincide, but need different parameters.
    Coincident {
        /// Index of the first of the two, from 0.
        first: usize,
    },
    /// Points are not monotone along the direction that defines their parameters.
    TurnsAlong {
        /// Index of the first point that reverses, from 0.
        index: usize,
    },
    /// A datum is farther than its tolerance from every spline with this number of control points.
    OutOfReach {
        /// Index of the datum with the largest distance relative to its tolerance.
        index: usize,
        /// Distance of the best curve found.
        distance: f64,
    },
    /// A budget or share is out of range or does not apply to the measure.
    Goal(&'static str),
    /// The derivative is not available.
    NoDerivative(&'static str),
    /// A tolerance is negative, NaN or infinite.
    Tolerance {
        /// The number given.
        value: f64,
    },
    /// A closed curve without a tolerance would shrink to a point.
    ClosedWithoutTolerance,
    /// A mark is not the index of a control point.
    Mark {
        /// The mark.
        index: usize,
        /// The number of control points.
        count: usize,
    },
    /// A weight is not a positive number.
    Weight {
        /// Its index.
        index: usize,
        /// The weight.
        weight: f64,
    },
    /// Two lists that belong together differ in length.
    Count {
        /// Counted items.
        what: &'static str,
        /// The required number.
        expected: usize,
        /// The number given.
        actual: usize,
    },
    /// Knots or parameters are not increasing.
    Unsorted {
        /// Index of the first value that is smaller than the one before it.
        index: usize,
    },
    /// The knots are invalid.
    Knots(moldloft_spline::KnotError),
    /// The degree is too low for the measure.
    Degree {
        /// The lowest degree at which the measure exists.
        expected: usize,
        /// The degree given.
        actual: usize,
    },
    /// Steps of single points need a measure of squares.
    Squares,
    /// Linear conditions cannot all hold within the tolerance.
    Contradiction {
        /// The conditions that could not be met, by position in the list given.
        conditions: Vec<usize>,
        /// Conditions that keep the ends are among them.
        ends: bool,
        /// The largest amount by which one of them is missed.
        miss: f64,
    },
    /// Shape conditions cannot hold within the tolerance.
    Shape {
        /// Violated shape conditions, by index in the given list.
        shapes: Vec<usize>,
        /// Largest violation, as a distance.
        miss: f64,
    },
    /// No curve within the tolerance has so small a measure.
    Energy {
        /// The requested measure.
        asked: f64,
        /// The least there is.
        least: f64,
    },
    /// A shape condition that these data cannot have.
    Shapeless {
        /// Index of the shape condition in the given list.
        shape: usize,
        /// Reason and remedy.
        why: String,
    },
    /// A curve has the opposite direction to the neighbour that it continues.
    TurnsBack,
    /// Two surfaces cannot be joined at an edge.
    Seam {
        /// Index of the seam in the given list.
        number: usize,
        /// Why.
        why: String,
    },
    /// Local steps can preserve only the position of a seam.
    SeamsByPasses,
    /// A solver could not factor its matrix.
    Singular,
    /// The problem is too large for the direct solver.
    TooLarge {
        /// Number of stored entries that the factor needs.
        needed: usize,
        /// Maximum number allowed.
        allowed: usize,
    },
}

impl From<moldloft_spline::KnotError> for FairError {
    fn from(error: moldloft_spline::KnotError) -> Self {
        Self::Knots(error)
    }
}

impl fmt::Display for FairError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Seam { number, why } => write!(f, "seam {}: {why}", number + 1),
            Self::SeamsByPasses => write!(
                f,
                "passes and sweeps keep only the position of seams; tangents and curvature need the joint optimum"
            ),
            Self::TooFew { expected, actual } => {
                write!(f, "expected at least {expected} points, found {actual}")
            }
            Self::Range { size } => write!(
                f,
                "coordinates of {size:.1e} are out of range: expected 1e-60 to 1e60, or take another unit"
            ),
            Self::NotFinite { index } => write!(f, "point {} is not finite", index + 1),
            Self::Coincident { first } => {
                write!(f, "points {} and {} coincide", first + 1, first + 2)
            }
            Self::TurnsAlong { index } => {
                write!(
                    f,
                    "point {} is behind the point before it along the direction of the \
                    parameters: use `chord`",
                    index + 1
                )
            }
            Self::OutOfReach { index, distance } => {
                write!(
                    f,
                    "the spline is {distance:.3e} from point {}: use more control points or a \
                    larger tolerance",
                    index + 1
                )
            }
            Self::Goal(why) | Self::NoDerivative(why) => f.write_str(why),
            Self::Tolerance { value } => {
                write!(f, "expected a tolerance of at least 0, found {value}")
            }
            Self::ClosedWithoutTolerance => {
                write!(f, "a closed curve without a tolerance shrinks to a point: give a tolerance")
            }
            Self::Mark { index, count } => {
                write!(f, "expected points from 1 to {count}, found {}", index.wrapping_add(1))
            }
            Self::Weight { index, weight } => {
                write!(f, "weight {} is {weight}, expected a positive number", index + 1)
            }
            Self::Count { what, expected, actual } => {
                write!(f, "expected {expected} {what}, found {actual}")
            }
            Self::Unsorted { index } => {
                write!(f, "parameter or knot {} is not larger than the one before it", index + 1)
            }
            Self::Knots(error) => error.fmt(f),
            Self::Degree { expected, actual } => {
                write!(f, "this measure needs degree {expected} or more, found {actual}")
            }
            Self::Contradiction { conditions, ends, miss } => {
                let own = ends.then(|| "of the ends".to_string());
                let list: Vec<_> =
                    conditions.iter().map(|c| (c + 1).to_string()).chain(own).collect();
                write!(
                    f,
                    "conditions {} cannot hold within the tolerance (missed by {miss:.3e})",
                    list.join(", ")
                )
            }
            Self::Shape { shapes, miss } => {
                let list: Vec<_> = shapes.iter().map(|c| (c + 1).to_string()).collect();
                write!(
                    f,
                    "shape {} cannot hold within the tolerance (missed by {miss:.3e})",
                    list.join(", ")
                )
            }
            Self::Energy { asked, least } => write!(
                f,
                "no curve within the tolerance has a measure of {asked:.6e}: the minimum is \
                {least:.6e}"
            ),
            Self::Shapeless { shape, why } => write!(f, "shape {}: {why}", shape + 1),
            Self::Squares => {
                write!(f, "local steps do not apply to a sum of lengths: use the optimum")
            }
            Self::TurnsBack => {
                write!(f, "the curve reverses at the common end with its neighbour: a cusp")
            }
            Self::Singular => write!(f, "the equations have no unique solution"),
            Self::TooLarge { needed, allowed } => {
                write!(f, "the factor needs {needed} numbers, {allowed} are allowed")
            }
        }
    }
}

impl std::error::Error for FairError {}

impl FairError {
    /// A contradiction between single equations as one between those that ask for them.
    pub(crate) fn owned_by(self, owners: &[usize]) -> Self {
        let Self::Contradiction { conditions, ends, miss } = self else { return self };
        let owner = |c: usize| owners.get(c).copied();
        let mut conditions: Vec<usize> = conditions.into_iter().filter_map(owner).collect();
        conditions.dedup();
        Self::Contradiction { conditions, ends, miss }
    }
}

/// Refuses points that are not finite, or too large or small for sixth differences to be squared.
pub(crate) fn check_finite(points: &[moldloft_num::Vec3<f64>]) -> Result<(), FairError> {
    if let Some(index) = points.iter().position(|p| !p.is_finite()) {
        return Err(FairError::NotFinite { index });
    }
    let all = points.iter().flat_map(|p| p.to_array());
    let size = all.fold(0.0f64, |size, x| size.max(x.abs()));
    if size == 0.0 || (1e-60..=1e60).contains(&size) {
        Ok(())
    } else {
        Err(FairError::Range { size })
    }
}
