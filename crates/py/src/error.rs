//! The only module that turns faults of Rust into Python's exceptions.

use crate::diagnostics::PyDiagnostic;
use moldloft::diag::Sources;
use moldloft::io::{FilePosition, ReadError};
use pyo3::prelude::*;

mod raised {
    pyo3::import_exception!(moldloft.errors, Error);
    pyo3::import_exception!(moldloft.errors, FormatError);
    pyo3::import_exception!(moldloft.errors, ModelError);
    pyo3::import_exception!(moldloft.errors, UnknownNameError);
}

/// The ids of diagnostics about a name that is not there.
const UNKNOWN: [&str; 3] = ["unknown-name", "unknown-object", "unknown-parameter"];

/// An exception that carries diagnostics and prints as they do.
pub fn model_error(diagnostics: &[moldloft::diag::Diagnostic], sources: &Sources) -> PyErr {
    let data: Vec<PyDiagnostic> = diagnostics.iter().map(|d| d.to_data(sources).into()).collect();
    let text: Vec<&str> = data.iter().map(PyDiagnostic::rendered).collect();
    let text = text.join("\n");
    let mut errors = diagnostics.iter().filter(|d| d.is_error());
    if errors.all(|d| UNKNOWN.contains(&d.id.as_ref())) && !diagnostics.is_empty() {
        raised::UnknownNameError::new_err((text, data))
    } else {
        raised::ModelError::new_err((text, data))
    }
}

/// An exception without a position in a model.
pub fn plain_error(message: impl std::fmt::Display) -> PyErr {
    raised::Error::new_err(message.to_string())
}

/// An exception about a name.
pub fn unknown_name(message: impl std::fmt::Display) -> PyErr {
    raised::UnknownNameError::new_err(message.to_string())
}

/// An exception about bytes that are not a file of their format.
pub fn format_error(error: ReadError) -> PyErr {
    let (place, number) = match error.place {
        FilePosition::Line(line) => ("line", line),
        FilePosition::Byte(byte) => ("byte", byte),
        FilePosition::Block(block) => ("block", block),
    };
    let message = error.to_string();
    let ReadError { format, expected, found, .. } = error;
    raised::FormatError::new_err((message, format, place, number, expected, found))
}
