//! The intrinsics of the array language, called as the language does.

mod common;
mod intrinsics;
mod splines;
