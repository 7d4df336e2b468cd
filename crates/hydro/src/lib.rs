//! Measures, hydrostatics and stability of bodies bounded by surfaces.
//!
//! `surfaces -> polynomial cells = Body -> integrals below a water plane -> figures, equilibrium, stability`
//!
//! Figures are integrals over the surfaces, with the waterline solved on them; each main figure has a bound: the sum
//! of the estimates of its quadrature and of what the interpolation of the surfaces leaves. Everything is generic
//! over [`moldloft_num::Real`]: decisions look at real parts, so derivatives come from the same code.
//!
//! Invariant: this crate knows surfaces and panels only, no names, no files; no result depends on threads.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod bernstein;
mod body;
mod cell;
mod chart;
mod descent;
mod equilibrium;
mod figures;
mod flotation;
mod hydrostatics;
mod integrals;
mod measures;
mod section;
mod strip;

pub use body::{Body, BodyMeasures, HullSide, USUAL_ACCURACY, surface_measures};
pub use cell::PolynomialCell;
pub use equilibrium::{Equilibrium, FloatError, Loading, Status, equilibrium};
pub use figures::hydrostatics;
pub use flotation::{Attitude, Flotation, Water, bottom, bounds, flotation};
pub use hydrostatics::{FormCoefficients, Hydrostatics, Symmetry, VolumeForms, Waterplane};
pub use measures::{curve_measures, solid_measures};
pub use section::section_area;

#[cfg(test)]
mod mesh_tests;
#[cfg(test)]
mod part_tests;
#[cfg(test)]
mod tests;
