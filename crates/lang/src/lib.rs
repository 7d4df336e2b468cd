//! The language: texts into models.
//!
//! `text -> syntax tree -> run -> Graph -> numbers, panels, derivatives`
//!
//! A [`Document`] holds a model as its user sees it: a text, its parameters, the objects it makes.
//! It is run again at every change; only what changed is evaluated. A run with seeded dual numbers
//! gives exact derivatives of everything that a plain run computes.
//!
//! ```
//! use moldloft_lang::{Document, NoFiles, registry};
//! use moldloft_registry::Value;
//!
//! let text = "param float w = 2 in [1, 3]; AbsPoint A(0, 0, 0); AbsPoint B(w, 0, 0); Line l(A, B);";
//! let mut model = Document::from_text(registry(), Box::new(NoFiles), "line.sdl", text);
//! assert!(!model.has_errors());
//! assert!(matches!(model.eval("l(0.5).x"), Ok(Value::Number(x)) if x == 1.0));
//! model.set(&[("w".into(), 3.0)]).unwrap();
//! assert!(matches!(model.eval("l.length"), Ok(Value::Number(x)) if (x - 3.0).abs() < 1e-12));
//! ```
//!
//! Invariant: this crate opens no file; what it reads comes from the host's [`World`].

mod analysis;
mod arithmetic;
mod builtins;
mod component;
mod convert;
mod document;
mod env;
mod expr;
mod files;
mod floating;
mod format;
mod fused;
mod grid_files;
mod header;
mod hydro;
mod interpreter;
mod intrinsics;
mod known;
mod later;
mod library;
mod looks;
mod loops;
mod machine;
mod measures;
mod member;
mod model_file;
mod model_file_formula;
mod model_file_names;
mod module;
mod objects;
mod ops;
mod panel_attributes;
mod place;
mod plan;
mod program;
mod recipe;
mod rename;
mod routine;
mod section;
mod sections;
mod sets;
pub mod show;
mod sketch_file;
mod sketches;
mod solve;
mod variables;
mod volume;
mod world;

pub use analysis::{Completion, CompletionKind};
pub use builtins::{BUILTINS, Builtin, MOST_REFINED};
pub use convert::Format;
pub use document::{Document, Panelled};
pub use env::Param;
pub use floating::{AfloatOptions, FloatAnswer, FloatRequest, Immersion};
pub use hydro::{Options as FloatOptions, named as named_hydrostatics};
pub use interpreter::MOST_STEPS;
pub use library::LIBRARIES;
pub use looks::PatchFields;
pub use sections::Section;
pub use solve::{SolveStatus, Solved};
pub use volume::Blocked;
pub use world::{NoFiles, ReadError, ReadText, World};

use moldloft_registry::Registry;

/// All rows of the project: every crate's list, joined.
pub fn registry() -> Registry {
    let rows = moldloft_relational::rows().into_iter().chain(moldloft_fair::rows());
    let rows = rows.chain(moldloft_field::rows()).chain(moldloft_sketch::entity::rows());
    let rows = rows.chain(moldloft_arrays::rows());
    Registry::new(rows.chain(intrinsics::rows()).chain(header::rows()))
}
