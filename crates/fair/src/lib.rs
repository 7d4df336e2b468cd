//! Fairing of curves, surfaces and networks within a certified tolerance.

mod band;
mod breaks;
mod certificate;
mod cone;
mod deviation;
mod entity;
mod error;
mod fit;
mod heap;
mod job;
mod jump;
mod levels;
mod limit;
mod local;
mod measure;
pub mod network;
mod optimum;
mod report;
mod rows;
pub mod shape;
mod solver;
mod space;
pub mod surface;
#[cfg(test)]
mod testing;

pub use breaks::{Finding, findings, with_findings};
pub use certificate::{Certificate, ball_gap};
pub use deviation::{Deviation, certified, deviation};
pub use entity::rows;
pub use error::FairError;
pub use fit::{Fit, Spacing, fit, fit_with, interpolate, least_squares, parameters};
pub use job::{End, Job};
pub use jump::Jumps;
pub use levels::levels;
pub use limit::{Limit, Motion};
pub use local::{
    Local, LocalOptions, Move, Rule, Step, Stopped, Stops, local, local_from, replay, replay_with,
    sweeps,
};
pub use measure::{Measure, Norm, value};
pub use network::{Network, Strand};
pub use optimum::{Bound, Condition, Optimum, OptimumOptions, optimum, optimum_with};
pub use report::{Mode, Numbers, Report, numbers, report};
pub use rows::Rows;
pub use space::Space;
