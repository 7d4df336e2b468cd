//! Files: sketches as commands and as JSON, drawings of other programs, bodies and pictures for others.

pub(crate) mod dimension_marks;
pub mod dxf;
pub mod export;
pub(crate) mod hidden_lines;
pub mod json;
pub mod json_format;
pub mod page_curve;
pub(crate) mod page_meets;
pub mod page_shapes;
pub mod page_spline;
pub(crate) mod painted_faces;
pub(crate) mod script;
pub(crate) mod svg;
pub(crate) mod svg_shapes;
pub(crate) mod svg_transform;
