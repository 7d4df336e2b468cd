//! Nearest points and intersections against closed forms and exhaustive searches.

mod batch;
mod branches;
mod closed_forms;
mod common;
mod curve_pairs;
mod far;
