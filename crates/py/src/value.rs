//! Values of the language as Python objects.

use crate::arrays;
use crate::implicit::{PyField, PySet};
use moldloft::num::Vec3;
use moldloft::rows::{Array, ArrayShape, Class, Value, Vectors};
use numpy::{PyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyList, PyString};

/// A value that has no form in Python, such as a curve; it knows its class.
#[pyclass(frozen, module = "moldloft._core")]
pub struct Shape {
    class: Class,
}

#[pymethods]
impl Shape {
    #[getter]
    fn class_(&self) -> &'static str {
        self.class.name()
    }

    fn __repr__(&self) -> String {
        format!("<{}>", self.class.name())
    }
}

/// Numbers as floats, vectors as arrays, lists as lists; shapes by their class only.
pub fn to_python<'py>(py: Python<'py>, value: &Value<f64>) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Unset => py.None().into_bound(py),
        // -0 is a rounding accident to whoever reads it.
        Value::Number(x) => PyFloat::new(py, x + 0.0).into_any(),
        Value::Text(text) => PyString::new(py, text).into_any(),
        Value::Vector(v) => vector(py, *v),
        Value::Point(p) => vector(py, p.xyz),
        Value::Numbers(a) => numbers(py, a)?,
        Value::Vectors(a) => vectors(py, a),
        Value::List(items) => {
            let items: PyResult<Vec<_>> = items.iter().map(|item| to_python(py, item)).collect();
            PyList::new(py, items?)?.into_any()
        }
        Value::Block(layers) => block(py, layers)?,
        Value::Record(record) => {
            let dict = pyo3::types::PyDict::new(py);
            for (name, value) in record.names.iter().zip(&record.values) {
                dict.set_item(&**name, to_python(py, value)?)?;
            }
            dict.into_any()
        }
        Value::Body(mesh) => {
            let dict = pyo3::types::PyDict::new(py);
            let fill = |out: &mut [Vec3]| out.copy_from_slice(&mesh.points);
            dict.set_item("vertices", arrays::filled(py, [mesh.points.len(), 3], fill).0)?;
            let corners = PyArray::from_slice(py, mesh.triangles.as_flattened());
            dict.set_item("triangles", corners.reshape([mesh.triangles.len(), 3])?)?;
            let measures = mesh.measures();
            dict.set_item("volume", measures.map(|m| m.volume))?;
            dict.set_item("area", measures.map(|m| m.area))?;
            dict.set_item("centroid", measures.map(|m| vector(py, m.centroid)))?;
            let groups: PyResult<Vec<_>> = mesh.groups.iter().map(|g| group(py, g)).collect();
            dict.set_item("groups", groups?)?;
            dict.into_any()
        }
        Value::Field(_) => match moldloft::field::primitive_of(value) {
            Some(field) => Bound::new(py, PyField::of(field))?.into_any(),
            None => py.None().into_bound(py),
        },
        Value::Set(_) => match moldloft::field::set_of(value) {
            Some(set) => Bound::new(py, PySet::of(set))?.into_any(),
            None => py.None().into_bound(py),
        },
        other => Bound::new(py, Shape { class: other.class() })?.into_any(),
    })
}

/// The arguments of an object by name, as they were given.
pub fn arguments<'py>(
    py: Python<'py>,
    graph: &moldloft::model::Graph<f64>,
    object: &moldloft::model::Object<f64>,
) -> PyResult<Bound<'py, pyo3::types::PyDict>> {
    let dict = pyo3::types::PyDict::new(py);
    for (field, value) in object.row.fields.iter().zip(&object.args) {
        let name: &str = field.name;
        dict.set_item(name, argument(py, graph, value)?)?;
    }
    Ok(dict)
}

/// An argument as it was given; objects by name.
fn argument<'py>(
    py: Python<'py>,
    graph: &moldloft::model::Graph<f64>,
    value: &Value<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    match value {
        Value::Object(key) => {
            Ok(graph.get(*key).map(|object| object.name.to_string()).into_pyobject(py)?)
        }
        Value::List(items) => {
            let items: PyResult<Vec<_>> = items.iter().map(|v| argument(py, graph, v)).collect();
            Ok(PyList::new(py, items?)?.into_any())
        }
        other => to_python(py, other),
    }
}

/// A block as an array (ni, nj, nk, 3), or of numbers (ni, nj, nk).
fn block<'py>(py: Python<'py>, layers: &[Value<f64>]) -> PyResult<Bound<'py, PyAny>> {
    let nk = layers.len();
    match &layers[0] {
        Value::Vectors(first) => {
            let ArrayShape::Grid(ni, nj) = first.shape else { return Ok(py.None().into_bound(py)) };
            let fill = |out: &mut [Vec3]| {
                for (k, layer) in layers.iter().enumerate() {
                    let Value::Vectors(a) = layer else { continue };
                    a.iter().enumerate().for_each(|(at, v)| out[at * nk + k] = v);
                }
            };
            Ok(arrays::filled(py, [ni, nj, nk, 3], fill).0.into_any())
        }
        Value::Numbers(first) => {
            let ArrayShape::Grid(ni, nj) = first.shape else { return Ok(py.None().into_bound(py)) };
            let mut all = vec![0.0; ni * nj * nk];
            for (k, layer) in layers.iter().enumerate() {
                let Value::Numbers(a) = layer else { continue };
                a.items.iter().enumerate().for_each(|(at, x)| all[at * nk + k] = *x);
            }
            Ok(PyArray::from_vec(py, all).reshape([ni, nj, nk])?.into_any())
        }
        _ => Ok(py.None().into_bound(py)),
    }
}

/// A piece of a body: its name, and its triangles.
fn group<'py>(
    py: Python<'py>,
    group: &moldloft::rows::Group,
) -> PyResult<Bound<'py, pyo3::types::PyDict>> {
    let dict = pyo3::types::PyDict::new(py);
    dict.set_item("name", &group.name)?;
    dict.set_item("kind", &group.kind)?;
    dict.set_item("colour", group.colour)?;
    dict.set_item("tags", &group.tags)?;
    dict.set_item("tolerance", group.tolerance)?;
    dict.set_item("start", group.triangles.start)?;
    dict.set_item("stop", group.triangles.end)?;
    Ok(dict)
}

fn vector<'py>(py: Python<'py>, v: Vec3) -> Bound<'py, PyAny> {
    arrays::filled(py, [3], |out| out[0] = v.map(|x| x + 0.0)).0.into_any()
}

fn numbers<'py>(py: Python<'py>, a: &Array<f64>) -> PyResult<Bound<'py, PyAny>> {
    let row = PyArray::from_slice(py, &a.items);
    Ok(match a.shape {
        ArrayShape::Row(_) => row.into_any(),
        ArrayShape::Grid(m, n) => row.reshape([m, n])?.into_any(),
    })
}

fn vectors<'py>(py: Python<'py>, a: &Vectors<f64>) -> Bound<'py, PyAny> {
    let fill = |out: &mut [Vec3]| out.iter_mut().zip(a.iter()).for_each(|(o, v)| *o = v);
    match a.shape {
        ArrayShape::Row(n) => arrays::filled(py, [n, 3], fill).0.into_any(),
        ArrayShape::Grid(m, n) => arrays::filled(py, [m, n, 3], fill).0.into_any(),
    }
}
