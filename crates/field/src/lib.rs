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
mod cache;
mod curved;
mod error;
mod faces;
mod facet;
mod facing;
mod foot;
mod form;
mod gap;
mod interval;
mod kinds;
mod lifted;
mod mass;
mod nearest;
mod oracle;
mod portrait;
mod primitive;
mod ray;
mod roomy;
mod set;
mod shapes;
mod sheets;
mod tape;
mod transform;

pub use algebra::{Gradient, GradientRange, Hessian, Unary};
pub use blend::{
    Blend, CIRCULAR, check_rail, check_rails, fillet, liming, liming_on_rail, round, setback_rail,
    transition, zhang,
};
pub use bounds::bounds;
pub use error::FieldError;
pub use faces::{Profile, Round, Sides, faced};
pub use facet::{Facets, Options, Resolution, crossing_faces, facet, refacet};
pub use form::Form;
pub use gap::{Gap, Shell, gap};
pub use interval::Interval;
pub use lifted::{Lifted, Lifter, On};
pub use mass::{Mass, Moments, bracket, bracket_until, mass};
pub use nearest::{Contour, Nearest, nearest};
pub use oracle::{Affine, Constant, Oracle};
pub use portrait::{Light, Portrait, portrait};
pub use primitive::{Binary, Primitive};
pub use ray::{Caster, Hit, Ray, roots};
pub use set::{Attributes, Leaf, Membership, Set};
pub use shapes::{Beside, Inside, Near, NotClosed, Tube};
pub use sheets::{Dot, Mixed, Sheet, Wire, facet_mixed, solid_part};

pub use kinds::body::{Pieces, facets_of};
pub use kinds::read::{field_value, primitive_of, set_of, set_value};
pub use kinds::region::around;
pub use kinds::rows;
