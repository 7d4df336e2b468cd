//! The languages of Moldloft: texts into syntax trees and back.
//!
//! `text -> tokens -> tree (+ diagnostics)`. Parsing never fails and never panics: it gives a
//! complete tree and a list of the errors in the text. The crate does not depend on geometry.
//!
//! - [`sdl`]: the language of `.sdl` programs (grammar in `docs/grammar.ebnf`), with its formatter.
//! - [`model_file`]: MultiSurf model files 0.35 and 1.x.
//! - [`number`]: the shortest spelling of a double.
//! - [`decode`]: bytes into text, telling binary files apart.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod decode;
pub mod model_file;
pub mod number;
pub mod sdl;

pub use decode::{MAX_BYTES, decode};

use moldloft_diag::Span;

/// The text with pieces replaced; `edits` are in the order of the text and do not overlap.
pub(crate) fn splice(text: &str, edits: &[(Span, String)]) -> String {
    let mut out = String::with_capacity(text.len() + 16 * edits.len());
    let mut from = 0;
    for (span, replacement) in edits {
        out.push_str(&text[from..span.start as usize]);
        out.push_str(replacement);
        from = span.end as usize;
    }
    out.push_str(&text[from..]);
    out
}
