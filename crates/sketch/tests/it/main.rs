//! The tests of the crate, one program.

mod boolean;
mod common;
mod dimensions;
mod errors;
mod faces;
mod session;
mod solids;
mod work;
