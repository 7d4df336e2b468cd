//! Primitives that are Python functions.

use crate::work::visit_python;
use moldloft::field::{Interval, Oracle};
use moldloft::num::{Box3, Field, Vec3};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};

/// Storage of a function's first exception until the call ends.
type Slot = Arc<Mutex<Option<PyErr>>>;

/// The slots of all functions in an expression.
#[derive(Clone, Default)]
pub struct Slots(Vec<Slot>);

impl Slots {
    pub fn one(slot: Slot) -> Self {
        Self(vec![slot])
    }

    pub fn with(&self, o: &Self) -> Self {
        let mut all = self.0.clone();
        for slot in &o.0 {
            if !all.iter().any(|s| Arc::ptr_eq(s, slot)) {
                all.push(slot.clone());
            }
        }
        Self(all)
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns and clears the first exception.
    pub fn take(&self) -> Option<PyErr> {
        let mut taken = self.0.iter().filter_map(|s| lock(s).take());
        let first = taken.next();
        taken.for_each(drop);
        first
    }
}

fn lock(slot: &Slot) -> std::sync::MutexGuard<'_, Option<PyErr>> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A function of points (n, 3), perhaps with its gradient and a range over boxes.
pub struct PythonOracle {
    value: Arc<Py<PyAny>>,
    gradient: Option<Arc<Py<PyAny>>>,
    range: Option<Arc<Py<PyAny>>>,
    /// No two values differ by more than this times the distance of their points.
    lipschitz: Option<f64>,
    slot: Slot,
}

/// Step of the differences for a gradient, relative to the coordinates.
const STEP: f64 = 1e-6;

impl PythonOracle {
    pub fn new(
        value: Py<PyAny>,
        gradient: Option<Py<PyAny>>,
        range: Option<Py<PyAny>>,
        lipschitz: Option<f64>,
    ) -> (Self, Slot) {
        let slot = Slot::default();
        let oracle = Self {
            value: Arc::new(value),
            gradient: gradient.map(Arc::new),
            range: range.map(Arc::new),
            lipschitz,
            slot: slot.clone(),
        };
        (oracle, slot)
    }

    /// The result, or NaN with the exception kept; NaN too once the interpreter is ending.
    fn kept<R>(&self, nothing: R, call: impl FnOnce(Python<'_>) -> PyResult<R>) -> R {
        if lock(&self.slot).is_some() {
            return nothing;
        }
        match visit_python(call) {
            Some(Ok(result)) => result,
            Some(Err(error)) => {
                lock(&self.slot).get_or_insert(error);
                nothing
            }
            None => nothing,
        }
    }

    fn array<'py>(py: Python<'py>, points: &[Vec3]) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let flat: Vec<f64> = points.iter().flat_map(|p| p.to_array()).collect();
        PyArray1::from_vec(py, flat).reshape([points.len(), 3])
    }

    fn all_values(&self, points: &[Vec3], out: &mut [f64]) {
        let values = self.kept(None, |py| {
            let result = self.value.bind(py).call1((Self::array(py, points)?,))?;
            let array = numpy_of(py, &result)?;
            let array: PyReadonlyArray1<'_, f64> =
                array.extract().map_err(|_| wrong_shape(&array, format!("({},)", points.len())))?;
            let values = array.as_array().to_vec();
            if values.len() != points.len() {
                return Err(wrong_shape(array.as_any(), format!("({},)", points.len())));
            }
            Ok(Some(values))
        });
        match values {
            Some(values) => out.copy_from_slice(&values),
            None => out.fill(f64::NAN),
        }
    }

    fn all_gradients(&self, gradient: &Py<PyAny>, points: &[Vec3]) -> Vec<Vec3> {
        let nan = Vec3::of(f64::NAN, f64::NAN, f64::NAN);
        let found = self.kept(None, |py| {
            let result = gradient.bind(py).call1((Self::array(py, points)?,))?;
            let array = numpy_of(py, &result)?;
            let rows: PyReadonlyArray2<'_, f64> =
                array.extract().map_err(|_| wrong_shape(&array, "(n, 3)".into()))?;
            if rows.as_array().dim() != (points.len(), 3) {
                return Err(wrong_shape(&array, format!("({}, 3)", points.len())));
            }
            let row = |r: numpy::ndarray::ArrayView1<'_, f64>| Vec3::of(r[0], r[1], r[2]);
            Ok(Some(rows.as_array().rows().into_iter().map(row).collect()))
        });
        found.unwrap_or_else(|| vec![nan; points.len()])
    }

    /// Values and gradients, these by central differences unless they are given: one call for all.
    fn jets(&self, points: &[Vec3]) -> Vec<(f64, Vec3)> {
        if let Some(gradient) = &self.gradient {
            let mut values = vec![0.0; points.len()];
            self.all_values(points, &mut values);
            return values.into_iter().zip(self.all_gradients(gradient, points)).collect();
        }
        let step = |p: Vec3| STEP * (1.0 + p.norm());
        let mut around = Vec::with_capacity(7 * points.len());
        for &p in points {
            let h = step(p);
            around.push(p);
            for k in 0..3 {
                let mut aside = [0.0; 3];
                aside[k] = h;
                around.extend([p + Vec3::from(aside), p - Vec3::from(aside)]);
            }
        }
        let mut f = vec![0.0; around.len()];
        self.all_values(&around, &mut f);
        let jet = |(&p, f): (&Vec3, &[f64])| {
            (f[0], Vec3::of(f[1] - f[2], f[3] - f[4], f[5] - f[6]) / (2.0 * step(p)))
        };
        points.iter().zip(f.chunks_exact(7)).map(jet).collect()
    }
}

/// The result as an array of doubles.
fn numpy_of<'py>(py: Python<'py>, result: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let numpy = py.import("numpy")?;
    numpy.call_method1("asarray", (result, "float64"))
}

fn wrong_shape(array: &Bound<'_, PyAny>, expected: String) -> PyErr {
    let shape = array.getattr("shape").map_or_else(|_| "?".into(), |s| s.to_string());
    PyValueError::new_err(format!("it returned the shape {shape}, expected {expected}"))
}

impl Field<f64> for PythonOracle {
    fn value_and_gradient(&self, p: Vec3) -> (f64, Vec3) {
        self.jets(&[p])[0]
    }
    fn value(&self, p: Vec3) -> f64 {
        let mut out = [0.0];
        self.all_values(&[p], &mut out);
        out[0]
    }

    moldloft::num::field_facts!(f64: second_by_differences, no_bounds);
}

impl Oracle<f64> for PythonOracle {
    fn range(&self, over: &Box3) -> Interval {
        if let Some(range) = &self.range {
            let ends = self.kept(None, |py| {
                let corners = (over.low.to_array(), over.high.to_array());
                let result = range.bind(py).call1(corners)?;
                let (low, high): (f64, f64) = result.extract().map_err(|_| {
                    PyTypeError::new_err("its range must be a pair of numbers (low, high)")
                })?;
                if low <= high {
                    Ok(Some(Interval { low, high }))
                } else {
                    Err(PyValueError::new_err(format!("its range ({low}, {high}) is empty")))
                }
            });
            return ends.unwrap_or(Interval::ENTIRE);
        }
        match self.lipschitz {
            Some(rate) => {
                let middle = Field::value(self, over.centre());
                let reach = rate * 0.5 * over.diagonal() * (1.0 + 1e-12);
                if middle.is_finite() {
                    Interval { low: middle - reach, high: middle + reach }
                } else {
                    Interval::ENTIRE
                }
            }
            None => Interval::ENTIRE,
        }
    }

    fn gradient_range(&self, _: &Box3) -> [Interval; 3] {
        match self.lipschitz {
            Some(rate) => [Interval { low: -rate, high: rate }; 3],
            None => [Interval::ENTIRE; 3],
        }
    }

    fn values(&self, points: &[Vec3], out: &mut [f64]) {
        self.all_values(points, out);
    }

    fn values_and_gradients(&self, points: &[Vec3]) -> Vec<(f64, Vec3)> {
        self.jets(points)
    }

    fn re(&self) -> Arc<dyn Oracle<f64>> {
        Arc::new(Self {
            value: self.value.clone(),
            gradient: self.gradient.clone(),
            range: self.range.clone(),
            lipschitz: self.lipschitz,
            slot: self.slot.clone(),
        })
    }
}
