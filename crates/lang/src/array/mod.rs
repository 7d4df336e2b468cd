//! Array expressions as tapes of the machine in `moldloft-elementwise`: lowering, and recipes for
//! repeated execution.

mod cache;
pub(crate) mod lanes;
mod lower;
pub(crate) mod machine;
pub(crate) mod recipe;
