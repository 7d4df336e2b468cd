//! Fairing of curves, surfaces and networks within a certified tolerance, and their interrogation.
//!
//! A fair curve has no more bends than its designer meant. Data that were digitised, rounded or
//! fitted have many; this crate takes them out, never farther from the original than a tolerance,
//! and says how near the result is to the best there is.
//!
//! `points -> (fit) -> Job { Space, control points, Limit, marks, ends } -> knot_removal | optimum -> Report`
//!
//! # A tour
//!
//! - [`Space`]: splines of any degree on any knots, open or closed. Data used directly as control
//!   points are [`Space::floating`]; [`interpolate`] and [`least_squares`] make a spline of data
//!   points.
//! - [`Job`]: a curve to be faired with its conditions: [`Limit`] (balls, boxes, one direction, one
//!   plane; per control point), `marks` (intended breaks), [`EndContinuity`]s, weights.
//! - [`KnotJumps`]: how unfair each knot is, exactly; [`findings`] separates corners and wrong digits,
//!   [`with_findings`] takes them into account.
//! - [`knot_removal()`]: the classical method, knots removed and re-inserted one by one, the worst
//!   first, with a log ([`replay`]) and the reason of the end ([`Stopped`]); [`sweeps`] and
//!   [`multilevel()`] for large data and long waves.
//! - [`optimum`]: the least of a [`Measure`] under hard bounds ([`Bound`]) and linear
//!   [`Condition`]s, with a [`Certificate`] that does not trust the solver.
//! - [`deviation`]: certified and sampled distance from the original.
//! - [`Network`]: nets of surfaces and curves that share points, by passes or jointly;
//!   [`Network::joined`] fairs surfaces with common edges as one, tangents and curvature across these
//!   included ([`Seam`]).
//! - [`shape`] and [`surface`]: curvature, torsion, combs, monotone pieces, inflections,
//!   logarithmic curvature graphs, orthotomics; Gaussian and mean curvature, isophotes, highlight
//!   and reflection lines, zebra, the metric of grids.
//! - [`report()`]: figures of a fairing, as data ([`FairingReport`]) and as text, as printed by the
//!   command line. Rows of a file are control points ([`Job::of_points`]), points moved directly
//!   (the same, and the faired points are the result), or interpolated first ([`interpolate`], then
//!   [`Job::new`] with [`Fit::space`]). `deviation_certified`, `deviation_sampled`, `jumps_before`,
//!   `jumps_after` and `gap` are [`Deviation::certified`], [`Deviation::sampled`],
//!   [`CurveStatistics::jumps`] of [`FairingReport::before`] and [`FairingReport::after`], and
//!   [`Certificate::gap`]. [`Network::report`] does the same for nets.
//! - [`rows`]: the kinds `FairCurve`, `FairSnake`, `FairSurf`, `FairNet` and the functions `fair`, `jumps`,
//!   `curvature` of the language, with derivatives ([`optimum_with`], [`replay_with`]).
//!
//! ```
//! use moldloft_fair::{Job, Measure, Mode, OptimumOptions, findings, report, with_findings};
//! use moldloft_num::Vec3;
//!
//! // A digitised arc: two decimals, and one wrong digit.
//! let digitised = |i: i32| {
//!     let x = f64::from(i) / 20.0;
//!     let y = (100.0 * (1.0 - x * x / 4.0).sqrt()).round() / 100.0;
//!     Vec3::of(x, if i == 9 { y + 0.2 } else { y }, 0.0)
//! };
//! let job = Job::of_points(3, (-20..=20).map(digitised).collect(), false, 0.005).unwrap();
//! let found = findings(&job);
//! assert_eq!(found.len(), 1);
//! let job = with_findings(&job, &found);
//! let faired = report(&job, &Mode::Optimum(OptimumOptions::of(Measure::Second))).unwrap();
//! assert!(faired.after.jumps < 1e-2 * faired.before.jumps);
//! assert!(faired.after.pieces < faired.before.pieces / 2);
//! assert!(faired.certificate.relative() < 1e-6);
//! ```
//!
//! # Where things are
//!
//! `curve/`: spaces, fits, limits, conditions and knot removal of one curve. `optimum/`: the
//! interior point method and its certificates. `net/`: surfaces and networks. `interrogate/`:
//! curvature, deviation, reports. `kinds/`: rows of the registry. All are based on [`SparseRows`]
//! and [`Measure`].
//!
//! # Conventions
//!
//! Jumps and measures are free of the parameter's unit (uniform knots count as spaced by 1), so
//! they are lengths, squared lengths or sums of them. Curvature of a plane curve is positive where
//! it turns left seen against +z. A measure of squares is given as the sum, not half of it.
//! Indices of control points count from 0 here and from 1 in messages and in the language.
//!
//! Invariants: no control point leaves its limit by a bit; points that stay fixed and points that
//! no local step touched keep their bits; results do not depend on threads, earlier results or
//! time; this crate performs no input or output.
//!
//! Sources: Farin, Rein, Sapidis and Worsey, CAGD 4 (1987); Farin and Sapidis, IEEE CG&A 9 (1989);
//! Sapidis and Farin, CAD 22 (1990); Eck and Hadenfeld, Computing Suppl. 10 (1995); NASA CR-188796
//! (1991).

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod curve;
mod error;
mod indexed_heap;
mod interrogate;
mod kinds;
mod measure;
mod net;
mod optimum;
mod sparse_rows;
pub mod words;

pub use curve::breaks::{Finding, findings, with_findings};
pub use curve::condition::{Condition, joined};
pub use curve::corners::{FitWithCorners, interpolate_with_corners};
pub use curve::data::{Data, DataFit, DataOptions, Merged, fair_data, merged};
pub use curve::data_moved::{MovingFit, fair_data_with};
pub use curve::demand::Demand;
pub use curve::exact::{are_exact, is_exact};
pub use curve::fit::{
    Fit, ParameterSpacing, fit, fit_rational, fit_with, interpolate, least_squares, parameters,
    parameters_across, parameters_with,
};
pub use curve::job::{EndContinuity, Job};
pub use curve::jumps::KnotJumps;
pub use curve::knot_removal::{
    KnotRemoval, KnotRemovalOptions, Move, RemovalStep, Rule, Stopped, Stops, knot_removal,
    knot_removal_from, replay, replay_from_with, replay_with, sweeps,
};
pub use curve::layout::InterpolationSpace;
pub use curve::limit::{Limit, Motion};
pub use curve::multilevel::multilevel;
pub use curve::request::{CurveRequest, NearCurve, PointSpacing};
pub use curve::shape_condition::ShapeCondition;
pub use curve::shaping::{FoundArc, ShapeConstraints};
pub use curve::space::Space;
pub use curve::thinning::thinned;
pub use curve::turning::{curvature_parameters, near_budget};
pub use error::FairError;
pub use interrogate::deviation::{Deviation, certified, deviation};
pub use interrogate::lines::{line_findings, shared_knuckles};
pub use interrogate::outliers::{DataFinding, data_findings, detectable, predicted};
pub use interrogate::report::{CurveStatistics, FairingReport, Mode, data_report, numbers, report};
pub use interrogate::{shape, surface};
pub use kinds::{BUDGET as SURFACE_BUDGET, NETWORK_BUDGET, rows};
pub use measure::{Measure, RowNorm, value};
pub use net::arcs::NetworkArc;
pub use net::condition_text::NamedCurves;
pub use net::curves::{CurvePair, CurveSwing, SWING};
pub use net::grid::{
    GridData, GridFit, MovingGrid, fair_grid, fair_grid_with, grid_parameters, grid_spacing,
};
pub use net::network;
pub use net::network::Network;
pub use net::patches::{NetEdge, PatchNet, Seam};
pub use net::report::{NetworkMode, NetworkReport};
pub use net::shapes::{NetworkCondition, one_way};
pub use net::strand::NetworkCurve;
pub use net::toward::NetworkFit;
pub use optimum::certificate::{Certificate, ball_gap};
pub use optimum::goal::Goal;
pub use optimum::{Bound, Optimum, OptimumOptions, optimum, optimum_with};
pub use sparse_rows::SparseRows;
