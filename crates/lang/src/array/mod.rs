//! Array expressions as tapes of the machine in `moldloft-elementwise`: how they are lowered, and what is
//! kept of one that is executed again.

mod cache;
pub(crate) mod lanes;
mod lower;
pub(crate) mod machine;
pub(crate) mod recipe;
