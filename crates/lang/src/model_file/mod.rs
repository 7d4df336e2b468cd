//! A model file as a producer of objects.
//!
//! Every object is a call of the row named by its entity word; the row's `columns` assign the
//! fields of the line to arguments. Parents may follow their children in the file: objects are
//! declared in order of dependency.

mod alone;
mod divisions;
mod formula;
pub mod header;
pub(crate) mod names;
pub(crate) mod panel_attributes;
mod producer;
mod relations;
mod reread;
mod source;
pub mod text;
mod to_model_file;
mod to_program;
pub mod units;

pub use alone::converted;
pub use producer::Producer;
pub use source::{ModelFileSource, ModelNumber, Outcome, Sorted, Trouble, wrong};
pub use to_model_file::{ModelFileText, to_model_file};
pub use to_program::{prevents_conversion, quoted, to_program};
