//! Input of a run: files from the host, libraries, parsed modules, sketches, and scopes of names.

pub mod env;
pub mod fault_location;
pub(crate) mod library;
pub mod module;
pub mod scope;
pub mod sketch_file;
mod sketch_numbers;
pub(crate) mod world;

pub use library::LIBRARIES;
pub use world::{NoFiles, OpenFiles, OpenTexts, ReadAs, ReadText, TextReadError, World};
