//! Values of the language: types of variables, parts of arrays, members, operators, and their
//! display.

pub(crate) mod blocks;
pub(crate) mod chosen;
pub mod contours;
pub mod display;
pub(crate) mod implicit;
pub(crate) mod initialised;
pub mod member;
pub mod number_path;
pub(crate) mod ops;
pub(crate) mod subarray;
pub mod variables;
