//! Why there is no foil, in words for its user.

use std::fmt;

/// Reason why there is no such foil.
#[derive(Clone, Debug, PartialEq)]
pub enum FoilError {
    /// There is no thickness form of this name.
    Family {
        /// The given name.
        name: String,
    },
    /// There is no mean line of this name.
    Mean {
        /// The given name.
        name: String,
    },
    /// A number of the section is outside its range.
    Range {
        /// Name of the number.
        name: &'static str,
        /// The number.
        value: f64,
        /// The smallest allowed.
        min: f64,
        /// The largest allowed.
        max: f64,
    },
    /// The ordinates do not cover x from 0 to 1 in order.
    Ordinates {
        /// Index of the first wrong ordinate, from 0.
        index: usize,
        /// Description of the fault.
        what: &'static str,
    },
    /// A foil requires 3, 4 or 5 points.
    Points {
        /// The number given.
        actual: usize,
    },
    /// Nose and tail coincide.
    NoChord,
    /// The metric is not positive definite.
    Metric,
    /// The mean line of the section has no slope, which offsets along the normal need.
    NoSlope,
    /// A coordinate is NaN or infinite.
    NotFinite {
        /// Index of the point.
        index: usize,
    },
}

impl fmt::Display for FoilError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Family { name } => write!(f, "unknown foil family \"{name}\""),
            Self::Mean { name } => write!(f, "unknown mean line \"{name}\""),
            Self::Range { name, value, min, max } => {
                write!(f, "expected {name} from {min} to {max}, found {value}")
            }
            Self::Ordinates { index, what } => write!(f, "ordinate {} {what}", index + 1),
            Self::Points { actual } => {
                write!(f, "expected 3, 4 or 5 points of a foil, found {actual}")
            }
            Self::NoChord => write!(f, "the leading and the trailing edge of the foil coincide"),
            Self::Metric => write!(f, "the metric of the foil is not positive"),
            Self::NoSlope => {
                write!(f, "a section given by ordinates cannot be set off along the normal")
            }
            Self::NotFinite { index } => write!(f, "point {} of the foil is not finite", index + 1),
        }
    }
}

impl std::error::Error for FoilError {}
