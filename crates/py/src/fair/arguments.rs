//! Arguments, errors and results that curves, nets and networks share.

use moldloft::budget::Budget;
use moldloft::fair::{Certificate, FairError, Measure, Space};
use moldloft::num::Vec3;
use moldloft::spline::KnotVector;
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

mod raised {
    pyo3::import_exception!(moldloft.errors, FairingError);
}

/// Long work without Python's lock; Ctrl-C leaves it behind.
pub fn long<R: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<R, FairError> + Send + 'static,
) -> PyResult<R> {
    crate::work::interruptible(py, &Budget::default(), work)?.map_err(fair_error)
}

/// A refusal, with the number of the point that it is about.
pub fn fair_error(error: FairError) -> PyErr {
    let index = match &error {
        FairError::NotFinite { index }
        | FairError::Mark { index, .. }
        | FairError::Weight { index, .. } => Some(*index),
        FairError::Coincident { first } => Some(first + 1),
        _ => None,
    };
    raised::FairingError::new_err((error.to_string(), Vec::<Py<PyAny>>::new(), index))
}

/// A refusal that is not about one point.
pub fn refused(message: impl std::fmt::Display) -> PyErr {
    raised::FairingError::new_err((message.to_string(),))
}

pub fn vectors(points: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Vec3>> {
    let rows = points.as_array();
    if rows.ncols() != 3 {
        return Err(refused(format!("expected points (n, 3), found {} columns", rows.ncols())));
    }
    Ok(rows.rows().into_iter().map(|r| Vec3::of(r[0], r[1], r[2])).collect())
}

pub fn floats(numbers: Option<PyReadonlyArray1<'_, f64>>) -> Option<Vec<f64>> {
    numbers.map(|a| a.as_array().to_vec())
}

pub fn measure(name: &str) -> PyResult<Measure> {
    moldloft::fair::words::measure(name).map_err(refused)
}

/// The space of these knots; without knots one of the uniform forms.
pub fn space(
    degree: usize,
    count: usize,
    form: &str,
    knots: Option<Vec<f64>>,
    period: Option<f64>,
) -> Result<Space, FairError> {
    let few = |expected| FairError::TooFew { expected, actual: count };
    match (form, knots) {
        ("closed", None) if count < 2 * degree + 2 => Err(few(2 * degree + 2)),
        ("closed", None) => Space::closed(degree, count),
        ("closed", Some(knots)) => {
            let period = period.unwrap_or(f64::NAN);
            Space::periodic(degree, knots, period)
        }
        (_, Some(knots)) => {
            // Knots must be sorted; the error names the first that is not.
            if let Some(k) = knots.windows(2).position(|w| w[1] < w[0]) {
                return Err(FairError::Unsorted { index: k + 1 });
            }
            if knots.len() != count + degree + 1 {
                let (expected, actual) = (count + degree + 1, knots.len());
                return Err(FairError::Count { what: "knots", expected, actual });
            }
            Space::open(KnotVector::new(degree, knots)?)
        }
        _ if count < degree + 2 => Err(few(degree + 2)),
        ("clamped", None) => Space::clamped(degree, count),
        (_, None) => Space::floating(degree, count),
    }
}

pub fn certificate<'py>(py: Python<'py>, c: &Certificate) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("value", c.value)?;
    dict.set_item("gap", c.gap)?;
    dict.set_item("relative", c.relative())?;
    Ok(dict)
}
