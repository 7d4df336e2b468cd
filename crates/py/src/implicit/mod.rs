//! Implicit fields and sets: classes over `moldloft_field`, no logic.

mod facets;
mod field;
mod oracle;
mod set;

pub use facets::PyFacets;
pub use field::PyField;
pub use set::PySet;

use crate::error::plain_error;
use moldloft_field::FieldError;
use moldloft_num::{Box3, Vec3};
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use oracle::Slots;
use pyo3::prelude::*;

/// Points of an array (n, 3).
pub(crate) fn points(array: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Vec3>> {
    if array.shape()[1] != 3 {
        return Err(plain_error(format!("points have the shape (n, 3), not {:?}", array.shape())));
    }
    let flat = array.as_slice()?;
    Ok(flat.chunks_exact(3).map(|p| Vec3::of(p[0], p[1], p[2])).collect())
}

pub(crate) fn box_of(low: [f64; 3], high: [f64; 3]) -> Box3 {
    Box3 { low: Vec3::from(low), high: Vec3::from(high) }
}

/// The result, or the exception that a Python function raised meanwhile, or the fault.
pub(crate) fn finished<R>(
    py: Python<'_>,
    slots: &Slots,
    outcome: Result<R, FieldError>,
) -> PyResult<R> {
    if let Some(raised) = slots.take() {
        let error = plain_error(format!("a field's function failed: {}", raised.value(py)));
        error.set_cause(py, Some(raised));
        return Err(error);
    }
    outcome.map_err(plain_error)
}
