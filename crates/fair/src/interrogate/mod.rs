//! Analysis of fairness: curvature and its derivatives, distances, and reports of a fairing.

pub(crate) mod deviation;
pub(crate) mod lines;
pub(crate) mod outliers;
pub(crate) mod report;
pub mod shape;
mod short_lists;
pub(crate) mod soft_counts;
pub(crate) mod spans;
pub mod surface;
