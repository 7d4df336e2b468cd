//! Gradients of models: products with Jacobians, and the inputs that they may be by.

use crate::document::PyDocument;
use moldloft::document::{GradientMode, WeightedOutput};
use numpy::{PyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;

/// Gradients of weighted sums, (sums, by); and the outputs that were differentiated in forward mode. The weights of an
/// output are (sums, numbers). `mode` is "forward", "reverse" or anything else for the faster one.
#[pyfunction]
pub fn vjp<'py>(
    py: Python<'py>,
    document: &PyDocument,
    outputs: Vec<(String, PyReadonlyArray2<'py, f64>)>,
    by: Vec<String>,
    mode: &str,
) -> PyResult<(Bound<'py, PyArray2<f64>>, Vec<String>)> {
    let mode = match mode {
        "forward" => GradientMode::Forward,
        "reverse" => GradientMode::Reverse,
        _ => GradientMode::Automatic,
    };
    let weighted = |(name, weights): (String, PyReadonlyArray2<'py, f64>)| {
        let rows = weights.as_array().rows().into_iter().map(|row| row.to_vec()).collect();
        WeightedOutput { name, weights: rows }
    };
    let weighted: Vec<WeightedOutput> = outputs.into_iter().map(weighted).collect();
    let shape = [weighted.first().map_or(0, |w| w.weights.len()), by.len()];
    let found = document.long_checked(py, move |d| d.vjp(&weighted, &by, mode))?;
    Ok((PyArray::from_vec(py, found.rows.concat()).reshape(shape)?, found.forward))
}

/// The change of each output, flat, when the inputs change at these rates.
#[pyfunction]
pub fn jvp<'py>(
    py: Python<'py>,
    document: &PyDocument,
    outputs: Vec<String>,
    directions: Vec<(String, f64)>,
) -> PyResult<Vec<Bound<'py, PyArray1<f64>>>> {
    let found = document.long_checked(py, move |d| d.jvp(&outputs, &directions))?;
    Ok(found.into_iter().map(|change| PyArray::from_vec(py, change)).collect())
}

/// The names of the literals that derivatives may be by.
#[pyfunction]
pub fn literals(py: Python<'_>, document: &PyDocument) -> PyResult<Vec<String>> {
    document.long_checked(py, |d| Ok(d.literals()))
}

/// A number that changes with values, parameters and the text.
#[pyfunction]
pub fn state(py: Python<'_>, document: &PyDocument) -> PyResult<u64> {
    document.long_checked(py, |d| Ok(d.state()))
}
