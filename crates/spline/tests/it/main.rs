//! Splines, arcs and arc length against closed forms and laws.

mod arc;
mod bspline_curve;
mod bspline_surface;
mod common;
mod distribution;
mod interpolating;
mod nurbs;
mod relabel_arclen;
