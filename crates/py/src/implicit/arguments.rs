//! Arguments and results that fields, sets and facets share.

use super::oracle::Slots;
use crate::arrays;
use crate::error::plain_error;
use moldloft::field::SetAttributes;
use moldloft::num::{Box3, Vec3};
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::fmt::Display;

/// Points of an array (n, 3).
pub fn points(array: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Vec3>> {
    if array.shape()[1] != 3 {
        return Err(plain_error(format!("points have the shape (n, 3), not {:?}", array.shape())));
    }
    let flat = array.as_slice()?;
    Ok(flat.chunks_exact(3).map(|p| Vec3::of(p[0], p[1], p[2])).collect())
}

pub fn box_of(low: [f64; 3], high: [f64; 3]) -> Box3 {
    Box3 { low: Vec3::from(low), high: Vec3::from(high) }
}

/// The exception that a Python function raised meanwhile, if any.
pub fn check_raised(py: Python<'_>, slots: &Slots) -> PyResult<()> {
    let Some(raised) = slots.take() else { return Ok(()) };
    let error = plain_error(format!("a field's function failed: {}", raised.value(py)));
    error.set_cause(py, Some(raised));
    Err(error)
}

/// The result, or the exception that a Python function raised meanwhile, or the fault.
pub fn finished<R>(py: Python<'_>, slots: &Slots, outcome: Result<R, impl Display>) -> PyResult<R> {
    check_raised(py, slots)?;
    outcome.map_err(plain_error)
}

/// Attributes as data.
pub fn attributes<'py>(py: Python<'py>, a: &SetAttributes) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("name", &a.name)?;
    dict.set_item("colour", a.colour)?;
    dict.set_item("material", &a.material)?;
    dict.set_item("tolerance", a.tolerance)?;
    dict.set_item("tags", a.tags.clone())?;
    Ok(dict)
}

/// Points as an array (n, 3).
pub fn array<'py>(py: Python<'py>, points: &[Vec3]) -> Bound<'py, numpy::PyArray2<f64>> {
    arrays::filled(py, [points.len(), 3], |out| out.copy_from_slice(points)).0
}
