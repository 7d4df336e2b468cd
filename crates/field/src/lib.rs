//! Implicit solids: primitives from arithmetic, sets, and queries to them.
//!
//! `planes, reals -> Primitive -> Set -> tape -> values, gradients, ranges -> facets`
//!
//! Conventions: a function is negative in the solid, zero on the surface and positive in air; normals
//! point from solid to air; angles are radians.
//!
//! Invariant: this crate is independent of graph, language and files. Ranges are rounded outward;
//! sums and maps have a fixed order, so their bits do not depend on threads.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod design;
mod error;
mod expr;
mod facet;
mod kinds;
mod measure;
mod query;
mod set;
mod shapes;
mod text;

pub use design::{Edges, chamfer_edges, convex_hull, fillet_sets, minkowski_sum, round_edges};
pub use error::FieldError;
pub use expr::algebra::{GradientRange, Hessian, Unary, ValueGradient};
pub use expr::blend::{
    CIRCULAR, SetBlend, check_rail, check_rails, fillet, liming, liming_on_rail, round,
    setback_rail, transition, zhang,
};
pub use expr::form::Form;
pub use expr::interval::Interval;
pub use expr::oracle::{Affine, Constant, Oracle};
pub use expr::primitive::{Binary, Primitive};
pub use expr::quadric::{QuadricAxes, QuadricClass};
pub use expr::remap::twist;
pub use expr::smooth::{SmoothShape, smooth_minimum};
pub use facet::memo::FacetMemo;
pub use facet::sheets::{
    BehindSheet, Mixed, Sheet, TriplePoint, behind_sheets, facet_mixed, solid_part,
};
pub use facet::shells::FacetShell;
pub use facet::types::LeafIncidence;
pub use facet::wires::FacetWire;
pub use facet::{FacetOptions, Facets, Resolution, Unresolved, crossing_faces, facet, refacet};
pub use measure::certified::{Certified, Effort, certified};
pub use measure::implicit_derivatives::{Lifted, Lifter};
pub use measure::mass::{BracketedMass, IntegralOptions, bracket, mass, mass_of};
pub use measure::moments::Moments;
pub use query::bounds::bounds;
pub use query::distance::{SetDistance, distance};
pub use query::nearest::{CertifiedNearest, SetContour, nearest};
pub use query::ray::{Caster, Hit, Ray, roots};
pub use query::ray_trace::{Light, RayTrace, ray_trace};
pub use set::body::SurfacedSet;
pub use set::{Leaf, Membership, Set, SetAttributes};
pub use shapes::faces::{Round, RoundProfile, Sides, faced};
pub use shapes::{Beside, Inside, Near, NotClosed, Tube};
pub use text::{TextError, read_fidget, read_libfive};

pub use kinds::body::Pieces;
pub use kinds::read::{field_value, primitive_of, set_of, set_value};
pub use kinds::rows;
pub use query::bounds::around;
