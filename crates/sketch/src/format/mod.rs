//! Files: sketches as commands and as JSON, drawings of other programs, bodies and pictures for others.

pub mod dxf;
pub mod export;
pub mod json;
pub mod json_format;
pub(crate) mod page_shapes;
pub(crate) mod script;
pub(crate) mod svg;
pub(crate) mod svg_shapes;
