//! The language server on this process' standard input and output.

use moldloft_lsp::EngineCommand;
use pyo3::prelude::*;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

/// Serves an editor until it disconnects; texts are run by a process that the command starts, which
/// calls [`language_engine`]. False if the editor left without the protocol's shutdown.
#[pyfunction]
pub fn language_server(py: Python<'_>, program: PathBuf, arguments: Vec<OsString>) -> bool {
    let command = EngineCommand { program, arguments };
    py.detach(|| moldloft_lsp::serve(command) == ExitCode::SUCCESS)
}

/// Confines this process and runs the texts of a [`language_server`] until it ends.
#[pyfunction]
pub fn language_engine(py: Python<'_>) -> bool {
    py.detach(|| moldloft_lsp::engine() == ExitCode::SUCCESS)
}
