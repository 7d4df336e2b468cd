//! Functions of space: expressions of planes and reals, the compiled form of them, and the numbers they are
//! evaluated in.
//!
//! `planes, reals -> Primitive -> Tape -> values, gradients, ranges`

pub(crate) mod algebra;
pub(crate) mod blend;
pub(crate) mod branches;
pub(crate) mod form;
pub(crate) mod interval;
pub(crate) mod oracle;
pub(crate) mod primitive;
pub(crate) mod quadric;
pub(crate) mod remap;
pub(crate) mod second_order;
pub(crate) mod smooth;
pub(crate) mod tape;
mod transform;
