//! Errors of primitives, sets, blends and queries.

use moldloft_budget::Spent;
use moldloft_num::{Box3, Vec3};
use std::fmt;

/// Reason why a primitive, set, blend or query is refused.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FieldError {
    /// A number that is infinite or not a number.
    NotFinite {
        /// Name of the quantity.
        what: &'static str,
    },
    /// A size that must be positive.
    NotPositive {
        /// Name of the quantity.
        what: &'static str,
        /// Given value.
        value: f64,
    },
    /// A direction of zero length, or points that coincide or are coplanar.
    Degenerate {
        /// Name of the quantity.
        what: &'static str,
    },
    /// Primitives may be divided only by a real other than zero.
    Division,
    /// Exponents are whole numbers from 0 to 1000.
    Exponent {
        /// Given value.
        value: f64,
    },
    /// The weight of a blend must be strictly between 0 and 1.
    Lambda {
        /// Given value.
        value: f64,
    },
    /// The two rails of a transition meet, or could not be proved to be apart.
    RailsMeet {
        /// Position of the fault.
        place: Box3,
    },
    /// The blend meets an inverted body on its rail: the rail is inside the other body.
    RailInside {
        /// Number of the body that the rail should leave outside.
        body: usize,
        /// Position of the fault.
        place: Box3,
    },
    /// The body has no direction at its rail (zero gradient), so nothing can be tangent to it.
    RailSingular {
        /// Number of the body.
        body: usize,
        /// Position of the fault.
        place: Box3,
    },
    /// The box has no volume, or is not finite.
    EmptyBox {
        /// Low corner.
        low: Vec3,
        /// High corner.
        high: Vec3,
    },
    /// The set is unbounded along an axis, so a box must be given.
    Unbounded {
        /// The axis, 0 to 2.
        axis: usize,
        /// 1 for its positive end, -1 for its negative.
        sign: f64,
    },
    /// The accuracy would need more boxes than allowed.
    TooFine {
        /// Estimated number of boxes needed.
        boxes: f64,
        /// Maximum number of boxes.
        limit: f64,
    },
    /// The box is so far from the origin that rounding does not resolve its cells.
    FarAway {
        /// The greatest coordinate.
        far: f64,
        /// The side of a cell.
        step: f64,
    },
    /// Nearly all cells of large parts of the box contain the surface: the set has waves smaller
    /// than these.
    TooRough {
        /// Number of such cells found.
        cells: usize,
        /// The side of a cell.
        step: f64,
    },
    /// Part of the set is thinner than the cells.
    Thin {
        /// Position of the fault.
        place: Box3,
        /// The side of a cell.
        step: f64,
        /// Approximate minimum depth for small enough cells.
        depth: u32,
    },
    /// The accuracy was not reached with the allowed number of cells.
    NotReached {
        /// Requested accuracy.
        asked: f64,
        /// Accuracy reached.
        reached: f64,
        /// Number of cells used.
        cells: usize,
    },
    /// The box is thinner than one cell, so its content would be lost.
    ThinBox {
        /// Axis along which it is thin, 0 to 2.
        axis: usize,
        /// Its side.
        side: f64,
        /// The side of a cell.
        step: f64,
        /// Minimum depth for small enough cells.
        depth: u32,
    },
    /// The body is not closed, so it has no inside.
    NotClosed {
        /// Number of edges without an equal number of triangles on both sides.
        edges: usize,
    },
    /// A body with too many faces for a set.
    ManyFaces {
        /// Maximum number of primitives in a set.
        most: usize,
    },
    /// Round sides of a body touch or cross, so no auxiliary plane separates them.
    RoundSides,
    /// An edge inside a body, or in one of its faces, whose mitre would protrude from the offset
    /// body.
    HiddenEdge {
        /// A point of it.
        place: Vec3,
    },
    /// A primitive without a distance in closed form.
    NoDistance {
        /// Kind of primitive.
        kind: &'static str,
    },
    /// Sets without a convex hull or Minkowski sum in closed form.
    NoHull {
        /// The set found.
        found: String,
    },
    /// Two faces without a common edge in the set.
    NoEdge {
        /// Their names.
        faces: [String; 2],
    },
    /// A function without a text, from outside the language.
    Outside,
    /// Cancelled by the caller, or memory or time is used up.
    Spent(Spent),
    /// A primitive had no finite value.
    NoValue {
        /// Position of the fault.
        at: Vec3,
    },
}

impl fmt::Display for FieldError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::NotFinite { what } => write!(f, "the {what} is not a finite number"),
            Self::NotPositive { what, value } => {
                write!(f, "the {what} must be above 0, found {value}")
            }
            Self::Degenerate { what } => write!(f, "the {what} is degenerate"),
            Self::Division => {
                write!(f, "a field can be divided by a number or a field other than 0 only")
            }
            Self::Exponent { value } => {
                write!(f, "the exponent of a field is a whole number from 0 to 1000, found {value}")
            }
            Self::Lambda { value } => {
                write!(f, "the weight of a blend must be between 0 and 1, found {value}")
            }
            Self::RailsMeet { place } => write!(f, "the rails meet near {}", Corners(place)),
            Self::RailInside { body, place } => write!(
                f,
                "the rail is inside body {body} near {}, where the blend would be inside out",
                Corners(place)
            ),
            Self::RailSingular { body, place } => {
                write!(f, "body {body} has no normal on its rail near {}", Corners(place))
            }
            Self::EmptyBox { low, high } => write!(
                f,
                "the box from ({}, {}, {}) to ({}, {}, {}) has no volume",
                low.x, low.y, low.z, high.x, high.y, high.z
            ),
            Self::TooFine { boxes, limit } => write!(
                f,
                "this accuracy needs about {boxes:.1e} boxes, more than the {limit:.0e} allowed: ask for less, or give a larger \
                 `limit` where there is one"
            ),
            Self::FarAway { far, step } => write!(
                f,
                "coordinates of {far:.1e} do not distinguish cells of {step:.1e}: move the box towards the origin"
            ),
            Self::TooRough { cells, step } => write!(
                f,
                "the surface is in nearly all of {cells} cells of {step:.3e}: the set has waves smaller than they are"
            ),
            Self::Thin { place, step, depth } => write!(
                f,
                "near {} a part of the set is thinner than cells of {step:.3e}, and would be \
                lost: depth = {depth} resolves it",
                Corners(place)
            ),
            Self::NotReached { asked, reached, cells } => write!(
                f,
                "with {cells} cells the volume is known to {reached:.3e}, not to the required {asked:.3e}: require \
                 less, or allow more `cells`"
            ),
            Self::Unbounded { axis, sign } => {
                let (end, axis) = (if *sign > 0.0 { '+' } else { '-' }, ["x", "y", "z"][*axis]);
                write!(f, "the set is unbounded towards {end}{axis}: give a box")
            }
            Self::ThinBox { axis, side, step, .. } => write!(
                f,
                "the box is {side:.3e} thick along {}, less than its cells of {step:.3e}: its contents would be missed",
                ["x", "y", "z"][*axis]
            ),
            Self::NotClosed { edges } => {
                write!(f, "the body is not closed at {edges} edges, so it has no inside")
            }
            Self::ManyFaces { most } => {
                write!(f, "the faces cross each other so much that their set has over {most} parts")
            }
            Self::RoundSides => {
                write!(f, "round sides touch each other and cannot be distinguished")
            }
            Self::HiddenEdge { place } => write!(
                f,
                "at ({:.6}, {:.6}, {:.6}) two parts of the set meet in an internal edge, whose \
                mitre would protrude from the offset body",
                place.x, place.y, place.z
            ),
            Self::NoDistance { kind } => write!(
                f,
                "the distance from a {kind} has no closed form; planes, balls, cylinders, cones and tori have one"
            ),
            Self::NoHull { found } => {
                write!(f, "there is no closed form of the convex hull or Minkowski sum of {found}")
            }
            Self::NoEdge { faces: [a, b] } => {
                write!(f, "there is no edge between faces called `{a}` and `{b}`")
            }
            Self::Outside => {
                write!(
                    f,
                    "a function from outside (a scan, a surface, a Python function) has no text"
                )
            }
            Self::Spent(spent) => write!(f, "{spent}"),
            Self::NoValue { at } => {
                write!(f, "the field has no finite value at ({}, {}, {})", at.x, at.y, at.z)
            }
        }
    }
}

impl std::error::Error for FieldError {}

struct Corners<'a>(&'a Box3);

impl fmt::Display for Corners<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let c = self.0.centre();
        write!(f, "({:.4}, {:.4}, {:.4})", c.x, c.y, c.z)
    }
}

/// The box with a positive, finite volume, or an error.
pub(crate) fn solid_box(b: Box3) -> Result<Box3, FieldError> {
    let sound =
        (0..3).all(|k| b.low[k] < b.high[k] && b.low[k].is_finite() && b.high[k].is_finite());
    if sound { Ok(b) } else { Err(FieldError::EmptyBox { low: b.low, high: b.high }) }
}

/// `value`, if it is finite and above zero.
pub(crate) fn positive<T: moldloft_num::Real>(
    what: &'static str,
    value: T,
) -> Result<T, FieldError> {
    if !value.is_finite() {
        return Err(FieldError::NotFinite { what });
    }
    if value.re() > 0.0 {
        Ok(value)
    } else {
        Err(FieldError::NotPositive { what, value: value.re() })
    }
}

/// `v`, if it is finite.
pub(crate) fn finite<T: moldloft_num::Real>(
    what: &'static str,
    v: moldloft_num::Vec3<T>,
) -> Result<moldloft_num::Vec3<T>, FieldError> {
    if v.is_finite() { Ok(v) } else { Err(FieldError::NotFinite { what }) }
}

/// The unit vector along `v`, if it has a direction.
pub(crate) fn unit<T: moldloft_num::Real>(
    what: &'static str,
    v: moldloft_num::Vec3<T>,
) -> Result<moldloft_num::Vec3<T>, FieldError> {
    finite(what, v)?.normalized().ok_or(FieldError::Degenerate { what })
}

impl From<Spent> for FieldError {
    fn from(spent: Spent) -> Self {
        Self::Spent(spent)
    }
}
