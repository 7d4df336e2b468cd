//! Numbers, vectors and the promises of shapes.
//!
//! Everything that evaluates geometry in Moldloft is generic over one scalar trait, [`Real`], with
//! that one bound. Plain runs use `f64`; a run with derivatives uses [`Dual`], a number that carries
//! its exact derivative in a few directions, or [`Rev`], a number that records what it is made of, for
//! derivatives by many inputs at once. Derivatives by the shape parameters `t`, `u`, `v` are
//! *jets* ([`Jet`]): truncated Taylor numbers over the scalar, so a shape is written once, as a
//! formula, and yields its tangents and curvatures by the same code.
//!
//! `scalar -> vector -> jet -> Curve, Surface, Field`
//!
//! Invariant: this crate knows no entity, no file and no language; it performs no input or output.
//! Transcendental functions come from `libm`, so results are the same bits on every platform.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod box_tree;
mod boxes;
mod division;
mod dual;
mod facts;
mod fineness;
mod frame;
mod jet;
mod linear;
mod logarithm;
pub mod period;
mod quadrature;
mod rational;
mod real;
mod reparametrization;
mod rev;
mod roots;
mod shape;
mod solid;
pub mod trace;
mod triangle;
pub mod union_find;
mod vec3;

pub use box_tree::BoxTree;
pub use boxes::Box3;
pub use division::{modulo, remainder, whole_quotient};
pub use dual::{Dual, Dual4};
pub use fineness::{Fineness, unit_normal};
pub use frame::{Axis, Frame, Plane};
pub use jet::{Bi1, Bi2, Jet, Tri1, Uni1, Uni2, lift_curve, lift_surface};
pub use linear::{Banded, SingularMatrix, determinant, solve_dense, solve_pivoting_fully};
pub use logarithm::log10;
pub use quadrature::{
    GAUSS_2_UNIT, GAUSS_4, GAUSS_8_UNIT, MAX_GAUSS_POINTS, gauss_legendre, gauss_points,
    gauss_rule, integrate,
};
pub use rational::{Pace, Rational, Weight};
pub use real::Real;
pub use reparametrization::{
    Composed, Reparametrization, ReparametrizationJet, inv_reparametrization,
    inv_reparametrization_in, lift_reparametrization,
};
pub use rev::{Adjoints, DerivativeTape, Rev};
pub use roots::{NoRoot, find_root};
pub use shape::{
    Curve, CurveFormula, CurveJet, Field, InnerPlane, Order, SurfJet, Surface, SurfaceFormula,
    field_differences, line_crossings, slope_scale,
};
pub use solid::{Solid, SolidFormula, SolidJet};
pub use triangle::{nearest_on_triangle, triangle_foot};
pub use vec3::{Vec2, Vec3};
