//! Array expressions as tapes of the machine in `moldloft-elementwise`: how they are lowered, and what is
//! kept of one that is executed again.

pub(crate) mod cache;
pub(crate) mod lower;
