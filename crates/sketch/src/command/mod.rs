//! The command language: lines in, replies out.

mod args;
mod boolean;
mod curves;
mod dims;
mod draw;
mod fault;
mod files;
mod info;
mod objects;
mod session;
mod solids;
pub mod verbs;
pub mod words;

pub use fault::Fault;
pub(crate) use session::Picture;
pub use session::{Files, NoFiles, OutFile, Reply, Session};
