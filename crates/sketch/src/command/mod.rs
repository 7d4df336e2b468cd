//! The command language: lines in, replies out.

mod args;
mod boolean;
mod curves;
mod dims;
mod draw;
mod error;
mod files;
mod info;
mod objects;
mod sensitivity;
mod session;
mod solids;
pub mod verbs;
pub mod words;

pub use error::CommandError;
pub(crate) use session::Picture;
pub use session::{Files, NoFiles, OutFile, Reply, Session};
