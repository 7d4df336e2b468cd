//! Element-wise statements in one pass.
//!
//! `expression -> tape -> orders -> chunks`
//!
//! A [`Tape`] is the element-wise part of an array expression, one instruction for each operation on one
//! component. Its instructions become a program of the machine in `vm`, through which the elements go in
//! chunks.
//!
//! Invariant: independent of interpreter, syntax and files; each operation is rounded separately,
//! so that the bits depend neither on the processor nor on the order of the passes.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod codegen;
mod tape;
mod vm;

pub use tape::{Code, LONGEST, Src, Tape};
