//! Diagnostics as Python objects.

use moldloft::diag::{DiagnosticData, LabelData};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A span of a text: lines and columns from 1, the end exclusive.
#[pyclass(frozen, get_all, name = "Label", module = "moldloft")]
#[derive(Clone)]
pub struct PyLabel {
    file: String,
    line: u32,
    column: u32,
    end_line: u32,
    end_column: u32,
    text: String,
}

impl From<LabelData> for PyLabel {
    fn from(label: LabelData) -> Self {
        let LabelData { file, line, column, end_line, end_column, text } = label;
        Self { file, line, column, end_line, end_column, text }
    }
}

impl PyLabel {
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("file", &self.file)?;
        dict.set_item("line", self.line)?;
        dict.set_item("column", self.column)?;
        dict.set_item("end_line", self.end_line)?;
        dict.set_item("end_column", self.end_column)?;
        dict.set_item("text", &self.text)?;
        Ok(dict)
    }
}

/// One error, warning or note. `str()` gives it as the command prints it.
#[pyclass(frozen, get_all, name = "Diagnostic", module = "moldloft")]
#[derive(Clone)]
pub struct PyDiagnostic {
    id: String,
    severity: &'static str,
    message: String,
    primary: Option<PyLabel>,
    secondary: Vec<PyLabel>,
    expected: Option<String>,
    found: Option<String>,
    notes: Vec<String>,
    help: Vec<String>,
    object: Option<String>,
    rendered: String,
}

impl From<DiagnosticData> for PyDiagnostic {
    fn from(data: DiagnosticData) -> Self {
        Self {
            id: data.id,
            severity: data.severity,
            message: data.message,
            primary: data.primary.map(PyLabel::from),
            secondary: data.secondary.into_iter().map(PyLabel::from).collect(),
            expected: data.expected,
            found: data.found,
            notes: data.notes,
            help: data.help,
            object: data.object,
            rendered: data.rendered,
        }
    }
}

impl PyDiagnostic {
    /// The text that the command prints.
    pub fn rendered(&self) -> &str {
        &self.rendered
    }
}

#[pymethods]
impl PyDiagnostic {
    #[getter]
    fn is_error(&self) -> bool {
        self.severity == moldloft::diag::Severity::Error.word()
    }

    /// The facts as plain data, as `moldloft check --json` prints them.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Fields by name; labels and the correction are dictionaries, absent facts None.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let labels = |labels: &[PyLabel]| -> PyResult<Vec<Bound<'py, PyDict>>> {
            labels.iter().map(|label| label.to_dict(py)).collect()
        };
        let dict = PyDict::new(py);
        dict.set_item("id", &self.id)?;
        dict.set_item("severity", self.severity)?;
        dict.set_item("message", &self.message)?;
        dict.set_item("primary", self.primary.as_ref().map(|l| l.to_dict(py)).transpose()?)?;
        dict.set_item("secondary", labels(&self.secondary)?)?;
        dict.set_item("expected", &self.expected)?;
        dict.set_item("found", &self.found)?;
        dict.set_item("notes", &self.notes)?;
        dict.set_item("help", &self.help)?;
        dict.set_item("object", &self.object)?;
        dict.set_item("rendered", &self.rendered)?;
        Ok(dict)
    }

    fn __str__(&self) -> &str {
        &self.rendered
    }

    fn __repr__(&self) -> String {
        format!("<{} {}: {}>", self.severity, self.id, self.message)
    }
}
