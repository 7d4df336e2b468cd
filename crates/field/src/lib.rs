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
mod error;
mod facet;
mod form;
mod interval;
mod lifted;
mod mass;
mod oracle;
mod primitive;
mod set;
mod tape;
mod transform;

#[cfg(test)]
mod random;

pub use algebra::{Gradient, GradientRange, Hessian, Unary};
pub use error::FieldError;
pub use facet::{Facets, Options, Resolution, crossing_faces, facet, refacet};
pub use form::Form;
pub use interval::Interval;
pub use lifted::Lifted;
pub use mass::{Mass, Moments, bracket, mass};
pub use oracle::{Affine, Oracle};
pub use primitive::{Binary, Primitive};
pub use set::{Attributes, Leaf, Membership, Set};
