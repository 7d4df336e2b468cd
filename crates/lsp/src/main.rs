//! The language server `moldloft-lsp`: the language server protocol on standard input and output.
//!
//! `editor <-> front, which keeps the texts <-> engine, a process that runs them`
//!
//! Every open text is a [`moldloft::document::Document`] that is run at each change, without writing any
//! file, on a thread of its own; all answers come from there. A change stops the run under way, and one
//! that does not come to an end soon is stopped and reported. A text that ends its process takes nothing
//! with it: another engine begins with all texts, and that text waits until it is changed.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod answers;
mod engine;
mod front;
mod index;
mod lines;
mod places;
mod server;

use std::process::ExitCode;

/// Counts the bytes that are held, for [`moldloft::budget::Budget`].
#[global_allocator]
static ALLOCATOR: moldloft::budget::Counting = moldloft::budget::Counting::new();

fn main() -> ExitCode {
    match std::env::args().nth(1).as_deref() {
        None | Some("--stdio") => front::run(),
        // What the front starts.
        Some("--engine") => engine::run(),
        Some("--version" | "-V") => {
            println!("moldloft-lsp {}", env!("CARGO_PKG_VERSION"));
            ExitCode::SUCCESS
        }
        Some(word) => {
            eprintln!(
                "error: unknown argument `{word}`; moldloft-lsp speaks on standard input and output"
            );
            ExitCode::from(2)
        }
    }
}
