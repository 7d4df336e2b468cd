//! The language: texts into a graph of objects.
//!
//! `text -> syntax tree -> run -> Graph`
//!
//! [`run::program::RunContext`] runs the text of a program, [`model_file::ModelFileSource`] that of
//! a model file; both declare objects in the graph of an [`Evaluation`] and leave the names for
//! later expressions. A run with seeded dual numbers gives exact derivatives of all results of a
//! plain run.
//!
//! Invariant: this crate opens no file; its input comes from the host's [`World`]. It does not
//! depend on documents.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod array;
mod closed;
pub mod functions;
pub mod model_file;
pub mod run;
pub mod source;
pub mod value;

pub use closed::RunScalar;
pub use functions::builtins::MOST_REFINED;
pub use run::inserted::{INSERTED_FILES, InsertedFile};
pub use source::env::{Evaluation, Param, SolveStatus};
pub use source::{
    LIBRARIES, NoFiles, OpenFiles, OpenTexts, ReadAs, ReadText, TextReadError, World,
};
pub use value::display;

/// Inner parts, public for the integration tests of this crate; unit tests would compile it a
/// second time.
#[doc(hidden)]
pub mod parts {
    pub use crate::functions::elementary::small_remainder;
    pub use crate::functions::files::inside;
    pub use crate::functions::format::{FormatArgument, format};
    pub use crate::value::subarray::{ArraySection, Selection, picked, put};
    /// Attributes of panels in model files.
    pub mod panel_attributes {
        pub use crate::model_file::panel_attributes::{read, written};
    }
}

use moldloft_registry::Registry;

/// All rows of the project: every crate's list, joined.
pub fn registry() -> Registry {
    let rows = moldloft_relational::rows().into_iter().chain(moldloft_fair::rows());
    let rows = rows.chain(moldloft_field::rows()).chain(moldloft_sketch::entity::rows());
    let rows = rows.chain(moldloft_arrays::rows());
    let own =
        [model_file::header::row(), run::solve_set::row()].into_iter().chain(run::weight::rows());
    let rows = rows.chain(functions::elementary::rows()).chain(own);
    Registry::new(rows.chain(functions::builtins::rows()))
}
