//! What a run reads: files by the host's leave, libraries, parsed modules, sketches, and what names mean.

pub mod env;
pub mod fault_location;
pub(crate) mod library;
pub mod module;
pub mod scope;
pub mod sketch_file;
pub(crate) mod world;

pub use library::LIBRARIES;
pub use world::{NoFiles, ReadText, TextReadError, World};
