//! Implicit solids: primitives by arithmetic, and what can be asked of them.
//!
//! `planes, reals -> Primitive -> Set -> tape -> values, gradients, ranges -> facets`
//!
//! Conventions: a function is negative in the solid, zero on the surface and positive in air; normals
//! point from solid to air; angles are radians.
//!
//! Invariant: this crate knows no graph, no language and no file. Ranges are rounded outward; sums and
//! maps run in fixed order, so their bits do not depend on threads.

mod algebra;
mod blend;
mod bounds;
mod error;
mod facet;
mod form;
mod interval;
mod kinds;
mod lifted;
mod mass;
mod nearest;
mod oracle;
mod primitive;
mod ray;
mod set;
mod sheets;
mod tape;
mod transform;

#[cfg(test)]
mod random;

pub use algebra::{Gradient, GradientRange, Hessian, Unary};
pub use blend::{
    Blend, CIRCULAR, check_rail, check_rails, fillet, liming, liming_on_rail, round, setback_rail,
    transition, zhang,
};
pub use bounds::bounds;
pub use error::FieldError;
pub use facet::{Facets, Options, Resolution, crossing_faces, facet, refacet};
pub use form::Form;
pub use interval::Interval;
pub use lifted::Lifted;
pub use mass::{Mass, Moments, bracket, mass};
pub use nearest::{Contour, Nearest, nearest};
pub use oracle::{Affine, Oracle};
pub use primitive::{Binary, Primitive};
pub use ray::{Hit, Ray, roots};
pub use set::{Attributes, Leaf, Membership, Set};
pub use sheets::{Mixed, Sheet, Wire, facet_mixed};

use moldloft_registry::Row;
use moldloft_registry::export::StaticRow;

/// The primitives as rows of the registry, in the order of the reference.
///
/// # Example
/// ```
/// let rows = moldloft_field::rows();
/// assert!(rows.iter().any(|row| row.name == "torus"));
/// ```
pub fn rows() -> Vec<Row> {
    vec![
        kinds::HalfSpace::<f64>::row(),
        kinds::Sphere::<f64>::row(),
        kinds::Cylinder::<f64>::row(),
        kinds::Cone::<f64>::row(),
        kinds::Torus::<f64>::row(),
        kinds::Cyclide::<f64>::row(),
    ]
}
