//! The registry as data.

use moldloft::rows::{DefaultValue, FieldSpec, Implementation, Row};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// All kinds and functions with their classes and arguments, in the order of the reference.
#[pyfunction]
pub fn reference(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let registry = moldloft::document::registry();
    registry.rows().map(|row| describe(py, row)).collect()
}

/// The named arguments that every kind takes besides its own.
#[pyfunction]
pub fn attributes(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    moldloft::rows::ATTRIBUTES.iter().map(|field| argument(py, field)).collect()
}

/// Name and text of each library that comes with the program.
#[pyfunction]
pub fn libraries() -> Vec<(&'static str, &'static str)> {
    moldloft::lang::LIBRARIES.to_vec()
}

/// The words of the language.
#[pyfunction]
pub fn keywords() -> Vec<&'static str> {
    moldloft::syntax::sdl::keywords().collect()
}

/// The statements that insert files, as data.
#[pyfunction]
pub fn statements(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let describe = |row: &moldloft::lang::InsertedFile| {
        let dict = PyDict::new(py);
        dict.set_item("name", row.name)?;
        dict.set_item("signature", row.signature)?;
        dict.set_item("doc", row.doc)?;
        dict.set_item("arguments", row.arguments.to_vec())?;
        dict.set_item("example", row.example)?;
        Ok(dict)
    };
    moldloft::lang::INSERTED_FILES.iter().map(describe).collect()
}

fn describe<'py>(py: Python<'py>, row: &Row) -> PyResult<Bound<'py, PyDict>> {
    let fields: PyResult<Vec<_>> = row.fields.iter().map(|field| argument(py, field)).collect();
    let dict = PyDict::new(py);
    dict.set_item("name", row.name.as_ref())?;
    dict.set_item("class", row.class.name())?;
    dict.set_item("is_kind", row.kind)?;
    dict.set_item("in_run", matches!(row.body, Implementation::Foreign(_)))?;
    dict.set_item("summary", row.summary())?;
    dict.set_item("doc", row.doc.as_ref())?;
    dict.set_item("fields", fields?)?;
    dict.set_item("columns", row.columns)?;
    dict.set_item("example", row.example.as_ref())?;
    Ok(dict)
}

fn argument<'py>(py: Python<'py>, field: &FieldSpec) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("name", field.name)?;
    dict.set_item("class", field.class.name())?;
    dict.set_item("many", field.many)?;
    dict.set_item("required", field.default.is_none())?;
    match field.default {
        Some(DefaultValue::Number(x)) => dict.set_item("default", x)?,
        Some(DefaultValue::Text(text)) => dict.set_item("default", text)?,
        Some(DefaultValue::Unset) | None => dict.set_item("default", py.None())?,
    }
    dict.set_item("min", field.min)?;
    dict.set_item("max", field.max)?;
    dict.set_item("help", field.help)?;
    dict.set_item("variadic", field.variadic)?;
    Ok(dict)
}
