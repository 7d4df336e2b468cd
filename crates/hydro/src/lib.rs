//! Areas, volumes, hydrostatics and stability of bodies bounded by surfaces.
//!
//! `surfaces -> polynomial cells = Body -> integrals below a water plane -> figures, equilibrium, stability`
//! Figures are integrals over the surfaces up to the exact waterline. Each main figure has an error
//! bound: the sum of the estimates for quadrature and for the interpolation of the surfaces.
//! Everything is generic over [`moldloft_num::Real`]; decisions use real parts, so the same code
//! gives derivatives.
//! Invariant: this crate uses surfaces and panels only, no names and no files; no result depends on
//! the number of threads.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod attitude;
mod bernstein;
mod body;
mod cell;
mod chart;
mod descent;
mod equilibrium;
mod figures;
mod flotation;
mod folds;
mod hydrostatics;
mod integrals;
mod measures;
mod moments;
mod pulled;
mod pulled_strip;
mod section;
mod strip;
mod trimmed;

pub use attitude::Attitude;
pub use body::{Body, BodyMeasures, HullSide, USUAL_ACCURACY, part_measures, surface_measures};
pub use cell::PolynomialCell;
pub use equilibrium::{Equilibrium, FloatError, Loading, Status, equilibrium};
pub use figures::hydrostatics;
pub use flotation::{Flotation, Water, bottom, bounds, flotation};
pub use hydrostatics::{FormCoefficients, Hydrostatics, Symmetry, VolumeForms, Waterplane};
pub use measures::{curve_measures, solid_measures};
pub use pulled::{PulledBody, pull_hydrostatics};
pub use section::section_area;
pub use trimmed::{TrimCurve, TrimLoops, bounds_part};

#[cfg(test)]
mod folds_tests;
#[cfg(test)]
mod mesh_tests;
#[cfg(test)]
mod part_tests;
#[cfg(test)]
mod pulled_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod trimmed_tests;
