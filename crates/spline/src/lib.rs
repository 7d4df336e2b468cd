//! Splines, arcs, arc length, distributions and relabellings.
//!
//! Pure mathematics, generic over the scalar [`moldloft_num::Real`]; the entities of the language
//! are declared elsewhere on top of it. Curves and surfaces here implement
//! [`moldloft_num::Curve`] and [`moldloft_num::Surface`], with parameters in [0, 1].
//!
//! `points, knots -> curve or surface -> jets, grids, lengths -> distributed points`
//!
//! # Example
//! ```
//! use moldloft_num::{Curve, Order, Vec3};
//! use moldloft_spline::BSplineCurve;
//! let points = [[0.0, 0.0], [1.0, 2.0], [3.0, 2.0], [4.0, 0.0]];
//! let points = points.map(|[x, y]| Vec3::of(x, y, 0.0)).to_vec();
//! let curve = BSplineCurve::<f64>::uniform(2, points).unwrap();
//! assert_eq!(curve.jet(0.5, Order::Zero)[0], Vec3::of(2.0, 2.0, 0.0));
//! ```
//!
//! Invariant: this crate knows no entity, no file and no language, and depends on `num` only.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod arc;
mod arclen;
mod basis;
mod by_arclen;
mod curvature_jumps;
mod curve;
mod curve_edit;
pub mod distribution;
mod even_functions;
pub mod foil;
mod interpolating;
mod knot_vector;
pub mod nurbs;
mod parametrization;
mod patches;
mod piecewise;
mod relabel;
mod spline_with_knot_derivatives;
mod surface;
mod surface_grid;
mod surface_taped;
mod tensor;

pub use arc::{ArcError, CircularArc};
pub use arclen::{BeyondEnd, arclen, curve_integral, inv_arclen, smooth_pieces};
pub use basis::Basis;
pub use by_arclen::ByArclen;
pub use curvature_jumps::curvature_breaks;
pub use curve::{BSplineCurve, SplineError};
pub use interpolating::{End, Ends, InterpolatingSpline, InterpolationError};
pub use knot_vector::{KnotError, KnotVector, MAX_DEGREE};
pub use parametrization::Parametrization;
pub use piecewise::PiecewiseCubic;
pub use relabel::{Dense, RelabelError, ReparametrizationForm};
pub use spline_with_knot_derivatives::SplineWithKnotDerivatives;
pub use surface::BSplineSurface;
pub use tensor::GridSpline;
