//! Implicit functions.

use super::arguments::{box_of, check_raised, points};
use super::oracle::{PythonOracle, Slots};
use crate::arrays;
use crate::error::plain_error;
use crate::work::unlocked_if;
use moldloft::field::{Affine, FieldError, Form, Primitive};
use moldloft::num::{Axis, Vec3};
use moldloft_parallel::prelude::*;
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;

/// Number of points from which work is done in another thread.
pub const LARGE: usize = 20_000;

/// An implicit function.
#[pyclass(frozen, name = "Field", module = "moldloft._core")]
pub struct PyField {
    pub inner: Primitive,
    pub slots: Slots,
}

/// Number of points that a thread evaluates at a time.
const CHUNK: usize = 1 << 14;

impl PyField {
    pub fn of(inner: Primitive) -> Self {
        Self { inner, slots: Slots::default() }
    }

    fn from(&self, inner: Primitive) -> Self {
        Self { inner, slots: self.slots.clone() }
    }

    fn both(&self, o: &Self, inner: Primitive) -> Self {
        Self { inner, slots: self.slots.with(&o.slots) }
    }
}

/// The values at many points, spread over threads.
fn values(
    points: &[Vec3],
    out: &mut [f64],
    serial: bool,
    evaluate: impl Fn(&[Vec3], &mut [f64]) + Sync,
) {
    if serial || points.len() <= CHUNK {
        return evaluate(points, out);
    }
    let chunks = points.par_chunks(CHUNK).zip(out.par_chunks_mut(CHUNK));
    chunks.for_each(|(points, out)| evaluate(points, out));
}

/// An array of the values at the rows of another; without the interpreter's lock where no Python function takes part.
pub fn values_at<'py>(
    py: Python<'py>,
    slots: &Slots,
    at: &PyReadonlyArray2<'py, f64>,
    evaluate: impl Fn(&[Vec3], &mut [f64]) + Sync + Send + 'static,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (points, serial) = (points(at)?, !slots.is_empty());
    let out = unlocked_if(py, !serial && points.len() > LARGE, move || {
        let mut out = vec![0.0; points.len()];
        values(&points, &mut out, serial, evaluate);
        out
    })?;
    check_raised(py, slots)?;
    Ok(PyArray1::from_vec(py, out))
}

#[pymethods]
impl PyField {
    #[staticmethod]
    fn real(value: f64) -> PyResult<Self> {
        match value.is_finite() {
            true => Ok(Self::of(Primitive::real(value))),
            false => Err(plain_error(FieldError::NotFinite { what: "number" })),
        }
    }

    /// A primitive that is a Python function of points (n, 3).
    #[staticmethod]
    fn user(
        value: Py<PyAny>,
        gradient: Option<Py<PyAny>>,
        range: Option<Py<PyAny>>,
        lipschitz: Option<f64>,
    ) -> Self {
        let (oracle, slot) = PythonOracle::new(value, gradient, range, lipschitz);
        Self { inner: Primitive::user(Arc::new(oracle)), slots: Slots::one(slot) }
    }

    fn binary(&self, name: &str, o: &Self) -> PyResult<Self> {
        let (a, b) = (&self.inner, &o.inner);
        let inner = match name {
            "+" => a + b,
            "-" => a - b,
            "*" => a * b,
            "/" => a.over(b).map_err(plain_error)?,
            "%" => a.remainder(b).map_err(plain_error)?,
            "min" => a.min(b),
            "max" => a.max(b),
            "atan2" => a.atan2(b),
            _ => return Err(plain_error(format!("there is no operator {name}"))),
        };
        Ok(self.both(o, inner))
    }

    fn unary(&self, name: &str) -> PyResult<Self> {
        let a = &self.inner;
        Ok(self.from(match name {
            "-" => -a,
            "abs" => a.abs(),
            "sign" => a.sign(),
            "sqrt" => a.sqrt(),
            "s_sqrt" => a.s_sqrt(),
            "sin" => a.sin(),
            "cos" => a.cos(),
            "exp" => a.exp(),
            "ln" => a.ln(),
            "tan" => a.tan(),
            _ => return Err(plain_error(format!("there is no function {name} of fields"))),
        }))
    }

    fn power(&self, exponent: f64) -> PyResult<Self> {
        self.inner.to_power(exponent).map(|p| self.from(p)).map_err(plain_error)
    }

    fn values<'py>(
        &self,
        py: Python<'py>,
        at: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let inner = self.inner.clone();
        values_at(py, &self.slots, &at, move |p, o| inner.values(p, o))
    }

    fn gradients<'py>(
        &self,
        py: Python<'py>,
        at: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>)> {
        let points = points(&at)?;
        let (inner, many) = (self.inner.clone(), self.slots.is_empty());
        let all = unlocked_if(py, many && points.len() > LARGE, move || match many {
            true => points.par_iter().map(|p| inner.gradient(*p)).collect::<Vec<_>>(),
            false => points.iter().map(|p| inner.gradient(*p)).collect(),
        })?;
        check_raised(py, &self.slots)?;
        let fill = |out: &mut [Vec3]| out.iter_mut().zip(&all).for_each(|(o, g)| *o = g.slope);
        let slopes = arrays::filled(py, [all.len(), 3], fill).0;
        Ok((PyArray1::from_vec(py, all.iter().map(|g| g.value).collect()), slopes))
    }

    /// The matrices of second derivatives, row by row.
    fn hessians<'py>(
        &self,
        py: Python<'py>,
        at: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = points(&at)?;
        let (inner, many) = (self.inner.clone(), self.slots.is_empty());
        let all = unlocked_if(py, many && points.len() > LARGE, move || match many {
            true => points.par_iter().map(|p| inner.hessian(*p).second).collect::<Vec<_>>(),
            false => points.iter().map(|p| inner.hessian(*p).second).collect(),
        })?;
        check_raised(py, &self.slots)?;
        let fill = |out: &mut [Vec3]| out.copy_from_slice(all.as_flattened());
        Ok(arrays::filled(py, [3 * all.len(), 3], fill).0)
    }

    fn range(&self, py: Python<'_>, low: [f64; 3], high: [f64; 3]) -> PyResult<(f64, f64)> {
        let over = box_of(low, high);
        let range = py.detach(|| self.inner.range(&over));
        check_raised(py, &self.slots)?;
        Ok((range.low, range.high))
    }

    fn mapped(&self, rows: [[f64; 3]; 3], shift: [f64; 3]) -> PyResult<Self> {
        let map = Affine { rows: rows.map(Vec3::from), shift: Vec3::from(shift) };
        self.inner.mapped(&map).map(|p| self.from(p)).map_err(plain_error)
    }

    fn remapped(&self, x: &Self, y: &Self, z: &Self) -> Self {
        let coordinates = [&x.inner, &y.inner, &z.inner].map(Clone::clone);
        let slots = self.slots.with(&x.slots).with(&y.slots).with(&z.slots);
        Self { inner: self.inner.remapped(&coordinates), slots }
    }

    /// The field as text.
    fn to_text(&self) -> PyResult<String> {
        self.inner.to_text().map_err(plain_error)
    }

    /// The field of a text: ours, fidget's or libfive's.
    #[staticmethod]
    fn from_text(text: &str, format: &str) -> PyResult<Self> {
        let made = match format {
            "fidget" => moldloft::field::read_fidget(text),
            "libfive" => moldloft::field::read_libfive(text),
            _ => Primitive::from_text(text),
        };
        made.map(Self::of).map_err(plain_error)
    }

    fn same(&self, o: &Self) -> bool {
        self.inner.same(&o.inner)
    }

    #[getter]
    fn degree(&self) -> u32 {
        self.inner.degree()
    }

    #[getter]
    fn is_sheet(&self) -> bool {
        self.inner.is_sheet()
    }

    /// Constructor with dimensions.
    fn form<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let form = self.inner.form();
        let dict = PyDict::new(py);
        dict.set_item("kind", form.name())?;
        let vector = |v: Vec3| v.to_array();
        let axial = |a: &Axis<f64>| -> PyResult<()> {
            dict.set_item("point", vector(a.point))?;
            dict.set_item("direction", vector(a.direction))
        };
        match form {
            Form::Real(c) => dict.set_item("value", *c)?,
            Form::Plane(p) => {
                dict.set_item("point", vector(p.point))?;
                dict.set_item("normal", vector(p.normal))?;
            }
            Form::Sphere { centre, radius } => {
                dict.set_item("centre", vector(*centre))?;
                dict.set_item("radius", *radius)?;
            }
            Form::Cylinder { axis, radius } => {
                axial(axis)?;
                dict.set_item("radius", *radius)?;
            }
            Form::Cone { axis, angle } => {
                axial(axis)?;
                dict.set_item("angle", *angle)?;
            }
            Form::Torus { axis, major, minor } => {
                axial(axis)?;
                dict.set_item("major", *major)?;
                dict.set_item("minor", *minor)?;
            }
            Form::Cyclide { axis, along, major, minor, change } => {
                axial(axis)?;
                dict.set_item("along", vector(*along))?;
                dict.set_item("major", *major)?;
                dict.set_item("minor", *minor)?;
                dict.set_item("change", *change)?;
            }
            Form::General => {}
        }
        Ok(dict)
    }
}
