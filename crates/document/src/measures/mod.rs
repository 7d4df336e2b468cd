//! Numbers and fields of a model: values of expressions, derivatives, hydrostatics, contour lines, blocks.

pub(crate) mod blocks;
pub(crate) mod bodied;
pub(crate) mod contour_lines;
pub(crate) mod expressions;
pub(crate) mod floating;
#[cfg(not(target_family = "wasm"))]
pub(crate) mod gradients;
pub(crate) mod hydrostatics;
pub(crate) mod parts;
#[cfg(not(target_family = "wasm"))]
mod pulled;
pub(crate) mod surface_fields;
