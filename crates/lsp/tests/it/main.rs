//! The language server, as an editor speaks to it.

mod client;
mod editing;
mod engine;
mod protocol;
mod workspace;
