//! Moldloft for Rust programs: a model is a program; run it again, and only what changed is recomputed.
//!
//! # Tour
//! ```
//! use moldloft::{Document, NoFiles, Value, WriteOptions, format_named, registry, write};
//!
//! let text = "param float beam = 2 in [1, 3]; AbsPoint A(0, beam/2, 0); AbsPoint B(0, beam/2, -1);
//!     AbsPoint C(4, beam/2, 0); AbsPoint D(4, beam/2, -1); Line a(A, B); Line b(C, D);
//!     Model info(symmetry = \"y\"); RuledSurf side(a, b, divisions = {2, 4});";
//! let mut model = Document::from_text(registry(), Box::new(NoFiles), "box.sdl", text);
//! assert!(!model.has_errors(), "{:?}", model.diagnostics());
//! model.set(&[("beam".into(), 3.0)]).unwrap();
//! assert!(matches!(model.eval("side(0.5, 0.5).y"), Ok(Value::Number(y)) if y == 1.5));
//! let slope = model.derivatives(&["side(0.5, 0.5).y".into()], &["beam".into()]).unwrap();
//! assert!(matches!(slope[0][0], Value::Number(s) if s == 0.5));
//! assert_eq!(model.panelled().unwrap().mesh.faces().len(), 8);
//! let obj = format_named("obj").unwrap();
//! assert_eq!(write(&mut model, obj, "box.obj", &WriteOptions::default()).unwrap()[0].name, "box.obj");
//! ```
//!
//! Two programs to start from: `cargo run -p moldloft --example hull_to_gdf` and
//! `cargo run -p moldloft --example derivative`.
//!
//! Modules: [`document`] opens, runs, measures and differentiates; [`export`] writes; the kinds and
//! algorithms are in [`fair`], [`field`], [`sketch`], [`spline`], [`locate`]; [`mesh`] and
//! [`panel`] have the panels; [`session`] edits a document interactively, as the workbench does.
//!
//! Invariant: re-exports only. Files are opened by [`FileWorld`] alone, and by the caller.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub use moldloft_brep as brep;
pub use moldloft_budget as budget;
pub use moldloft_diag as diag;
pub use moldloft_document as document;
pub use moldloft_export as export;
pub use moldloft_fair as fair;
pub use moldloft_field as field;
pub use moldloft_font as font;
pub use moldloft_host as host;
pub use moldloft_io as io;
pub use moldloft_lang as lang;
pub use moldloft_locate as locate;
pub use moldloft_mesh as mesh;
pub use moldloft_model as model;
pub use moldloft_num as num;
pub use moldloft_panel as panel;
pub use moldloft_picture as picture;
pub use moldloft_registry as rows;
pub use moldloft_session as session;
pub use moldloft_sketch as sketch;
pub use moldloft_spline as spline;
pub use moldloft_syntax as syntax;

pub use moldloft_diag::{Diagnostic, Severity, Sources, Span, render};
pub use moldloft_document::{
    Completion, CompletionKind, Document, ModelFormat as TextFormat, NoFiles, Panelled, Param,
    ReadText, TextReadError, World, registry,
};
pub use moldloft_export::{FORMATS, Format, NamedFile, WriteOptions, format_named, write};
pub use moldloft_host::FileWorld;
pub use moldloft_mesh::Mesh;
pub use moldloft_num::Vec3;
pub use moldloft_registry::Value;
