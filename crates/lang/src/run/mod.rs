//! The interpreter: statements, expressions, objects, loops, calls, components, sketches and solve sets.

mod array_type;
pub(crate) mod compiled;
mod component;
mod declarations;
pub(crate) mod expr;
mod families;
pub(crate) mod forward_reference;
mod implicit_objects;
pub mod inserted;
pub mod interpreter;
mod loops;
mod objects;
mod parts;
pub mod program;
mod read_log;
mod records;
mod routine;
mod sections;
mod semantics;
mod sketches;
pub(crate) mod solve_set;
pub(crate) mod tables;
mod unused;
pub(crate) mod usage;
pub mod weight;
pub mod whole;
