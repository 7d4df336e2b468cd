//! Array expressions as tapes of the machine in `moldloft-elementwise`.

pub(crate) mod lanes;
pub(crate) mod lower;
pub(crate) mod machine;
