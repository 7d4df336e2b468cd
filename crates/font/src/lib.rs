//! Fonts: text as closed outlines of lines and Bézier curves.
//!
//! `bytes of a font -> glyphs at their advances -> outlines without crossings -> loops round regions and their holes`
//!
//! The curves are those of the font, quadratic or cubic, up to rounding. A region is what the outlines wind around
//! (non-zero winding, the rule of TrueType and CFF), so that outlines of one text may overlap.
//!
//! Invariant: this crate reads no file and knows no entity; bytes of any kind give outlines or an error.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod bezier;
mod layout;
mod region;

pub use bezier::Bezier;
pub use layout::{
    Font, FontError, HorizontalAlign, SYSTEM_FONT, TextLayout, VerticalAlign, font_file, font_names,
};
pub use region::{OutlineFault, OutlineLoop};
