//! The language server: the language server protocol on standard input and output.
//!
//! `editor <-> front, which keeps the texts <-> engine, a process that runs them`
//!
//! Every open text is a [`moldloft::document::Document`] that is run at each change, without
//! writing any file, on a thread of its own; all answers come from there. A change stops the
//! current run; one that exceeds the time limit is stopped and reported. If a text ends its
//! process, another engine starts with all texts, and that text waits until it is changed.
//!
//! It has no process of its own: the program `moldloft-lsp` and the Python package both call [`serve`], and start
//! themselves once more for [`engine`](engine()).

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod answers;
mod engine;
mod front;
mod index;
mod lines;
mod places;
mod server;
mod wire;

pub use engine::run as engine;
pub use front::{EngineCommand, run as serve};
pub use wire::editors_messages;
