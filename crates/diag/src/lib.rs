//! Source spans and diagnostics as data.
//!
//! Every user error is a [`Diagnostic`]: a stable kebab-case id, a severity, a self-contained
//! message, its positions, expected and found input, and a remedy. The terminal, Python and the
//! viewer show the same object; [`render`] prints it, [`Diagnostic::to_data`] resolves its
//! positions to lines and columns for everything else.
//!
//! ```
//! use moldloft_diag::{Diagnostic, Sources, Span, render};
//!
//! let mut sources = Sources::new();
//! let file = sources.add("boat.sdl", "AbsPoint P(1, 2, 3);\nBCurve C({Q}, degree = 2);\n");
//! let diagnostic = Diagnostic::error("unknown-name", "no object called `Q`")
//!     .at(Span::new(file, 31, 32))
//!     .expected("the name of a point")
//!     .found("`Q`")
//!     .help("a name with a similar spelling exists: `P`");
//! assert_eq!(
//!     render(&diagnostic, &sources),
//!     "error[unknown-name]: no object called `Q`
//!  --> boat.sdl:2:11
//!   |
//! 2 | BCurve C({Q}, degree = 2);
//!   |           ^ expected the name of a point, found `Q`
//!   |
//!   = help: a name with a similar spelling exists: `P`
//! "
//! );
//! ```

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod data;
mod diagnostic;
mod nearest;
mod render;
mod sources;
mod span;

pub use data::{DiagnosticData, EditData, LabelData};
pub use diagnostic::{Diagnostic, DiagnosticFields, Edit, Label, Severity};
pub use nearest::{did_you_mean, edit_distance, nearest};
pub use render::{render, render_all};
pub use sources::{Location, Sources};
pub use span::{FileId, Span};
