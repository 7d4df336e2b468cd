//! The language server, as an editor speaks to it.

mod client;
mod editing;
mod engine;
mod frames;
mod protocol;
mod workspace;
