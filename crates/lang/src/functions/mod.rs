//! Functions of the language that are no kinds: those that need the interpreter, element-wise ones, and
//! those of sets; the files that a run opens.

mod apart;
pub mod block_files;
pub mod builtins;
mod cgns_files;
pub mod context;
pub(crate) mod elementary;
mod enclosed;
pub mod files;
pub(crate) mod format;
mod grid_checks;
mod grid_files;
pub(crate) mod grid_formats;
pub(crate) mod grid_values;
mod hanging;
mod joint_report;
pub mod named_blocks;
mod outlines;
pub mod plots;
pub(crate) mod run_call;
mod shape_measures;
mod solver_conditions;
