//! The tests of the crate, one program.

mod apart;
mod boolean;
mod common;
mod dimensions;
mod dxf_lines;
mod errors;
mod errors_enumerated;
mod expressions;
mod faces;
mod generators;
mod gradient;
mod json;
mod letters;
mod near_misses;
mod pictures;
mod projection;
mod session;
mod solids;
mod svg_shapes;
mod tangent;
mod treatments;
mod typed;
mod verbs;
mod words;
mod work;
