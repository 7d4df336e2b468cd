//! The tests of the crate, one program.

mod boolean;
mod common;
mod dimensions;
mod errors;
mod faces;
mod generators;
mod session;
mod solids;
mod treatments;
mod typed;
mod work;
