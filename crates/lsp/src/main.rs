//! The language server as a program without Python, `moldloft-lsp`.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

use moldloft_lsp::EngineCommand;
use std::process::ExitCode;

/// Counts the bytes that are held, for [`moldloft::budget::Budget`].
#[global_allocator]
static ALLOCATOR: moldloft::budget::Counting = moldloft::budget::Counting::new();

fn main() -> ExitCode {
    match std::env::args().nth(1).as_deref() {
        None | Some("--stdio") => {
            let Ok(program) = std::env::current_exe() else {
                eprintln!("error: this program's own path cannot be found");
                return ExitCode::FAILURE;
            };
            let arguments = vec!["--engine".into()];
            moldloft_lsp::serve(EngineCommand { program, arguments })
        }
        // The engine, started by the front.
        Some("--engine") => moldloft_lsp::engine(),
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
