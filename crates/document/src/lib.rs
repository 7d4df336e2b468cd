//! Operations on a model: open, run, set, rename, convert, solve, measure, differentiate.
//!
//! `text -> run -> Graph -> numbers, panels, derivatives`
//! A [`Document`] holds the text of a model, its parameters and its objects. It runs at every
//! change and evaluates only what changed. A run with seeded dual numbers gives exact derivatives
//! of everything that a plain run computes.
//!
//! ```
//! use moldloft_document::{Document, NoFiles, registry};
//! use moldloft_registry::Value;
//!
//! let text = "param float w = 2 in [1, 3]; AbsPoint A(0, 0, 0); AbsPoint B(w, 0, 0); Line l(A, B);";
//! let mut model = Document::from_text(registry(), Box::new(NoFiles), "line.sdl", text);
//! assert!(!model.has_errors());
//! assert!(matches!(model.eval("l(0.5).x"), Ok(Value::Number(x)) if x == 1.0));
//! model.set(&[("w".into(), 3.0)]).unwrap();
//! assert!(matches!(model.eval("l.length"), Ok(Value::Number(x)) if (x - 3.0).abs() < 1e-12));
//! ```
//! Invariant: this crate opens no file; the host's [`World`] reads them.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod convert;
mod degenerate;
mod document;
mod editor;
mod faired;
pub mod follow;
mod measures;
mod places;
mod rename;
pub mod searches;
mod set;
mod solve;
mod solve_for;
mod stated_units;
mod statements;

pub use convert::ModelFormat;
pub use degenerate::has_no_area;
pub use document::{Document, Panelled};
pub use editor::{
    ArgumentHint, CallSignature, Completion, CompletionKind, NameRole, NameToken, Workspace,
    WorkspacePlace,
};
pub use measures::blocks::Blocked;
pub use measures::contour_lines::ContourSection;
pub use measures::floating::{FloatAnswer, FloatRequest, FlotationOptions, Immersion, WeightItem};
#[cfg(not(target_family = "wasm"))]
pub use measures::gradients::{GradientMode, Gradients, WeightedOutput};
pub use measures::hydrostatics::{HydrostaticsOptions as FloatOptions, WettedPatch};
pub use measures::parts::PartMeasures;
pub use measures::surface_fields::PatchAnalysis;
pub use moldloft_hydro::Attitude;
pub use moldloft_lang::run::program::ArgumentInText;
pub use moldloft_lang::{
    NoFiles, OpenFiles, OpenTexts, Param, ReadAs, ReadText, SolveStatus, TextReadError, World,
    registry,
};
pub use set::LiteralCoefficient;
pub use solve::SolveReport;
pub use solve_for::{Adjustable, Adjustment, SolvedNumbers, WantedNumber, round_to};
