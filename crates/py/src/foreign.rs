//! A user's Python function as a row of the registry.

use crate::work::visit_python;
use moldloft::num::{Dual, Dual4, Real, Vec3};
use moldloft::rows::{
    Array, CallError, Class, Context, FieldSpec, Foreign, Implementation, Row, Value, Vectors,
};
use pyo3::prelude::*;
use pyo3::types::PyList;
use std::sync::Arc;

/// An argument as `moldloft.numbers._call` takes it: a text, or a shape and its numbers.
type Encoded = (Option<String>, Vec<usize>, Vec<Vec<f64>>);

struct PythonFunction {
    name: String,
    function: Py<PyAny>,
}

/// The row of a function with the given names of arguments.
pub fn row(name: String, arguments: Vec<String>, doc: String, function: Py<PyAny>) -> Row {
    let fields: Vec<FieldSpec> = arguments
        .into_iter()
        .map(|argument| {
            // Names of a registry's fields live as long as the program; a user has few functions.
            let name = Box::leak(argument.into_boxed_str());
            FieldSpec::new(name, Class::Any, "An argument of the Python function.")
        })
        .collect();
    Row::new(name.clone(), Implementation::Foreign(Arc::new(PythonFunction { name, function })))
        .doc(doc)
        .fields(fields)
}

/// A field or set made in Python, as a function without arguments.
enum ImplicitShape {
    Field(moldloft::field::Primitive),
    Set(moldloft::field::Set),
}

impl ImplicitShape {
    fn value<T: Real>(&self) -> Value<T> {
        match self {
            ImplicitShape::Field(f) => moldloft::field::field_value(f.constant()),
            ImplicitShape::Set(s) => moldloft::field::set_value(s.constant()),
        }
    }
}

impl Foreign for ImplicitShape {
    fn call_plain(&self, _: &[Value<f64>], _: &Context) -> Result<Value<f64>, CallError> {
        Ok(self.value())
    }
    fn call_dual(&self, _: &[Value<Dual4>], _: &Context) -> Result<Value<Dual4>, CallError> {
        Ok(self.value())
    }
}

/// The row of a field or set: a call without arguments gives it. `None` for anything else.
pub fn shape_row(name: &str, object: &Bound<'_, PyAny>) -> Option<Row> {
    let shape = if let Ok(field) = object.cast::<crate::implicit::PyField>() {
        ImplicitShape::Field(field.get().inner.clone())
    } else {
        ImplicitShape::Set(object.cast::<crate::implicit::PySet>().ok()?.get().inner.clone())
    };
    let row = Row::new(name.to_owned(), Implementation::Foreign(Arc::new(shape)));
    Some(row.doc("A field or set made in Python."))
}

impl PythonFunction {
    fn call<T: ScalarParts>(&self, args: &[Value<T>]) -> Result<Value<T>, CallError> {
        let mut encoded = Vec::with_capacity(args.len());
        for (k, arg) in args.iter().enumerate() {
            encoded.push(encode(arg).ok_or_else(|| {
                CallError::new(
                    "wrong-class",
                    format!("a Python function does not take {}", arg.class().with_article()),
                )
                .expected("numbers, vectors, rows and grids of them, or texts")
                .found(arg.class().with_article())
                .in_field(moldloft::rows::export::field_id(k))
            })?);
        }
        let called = visit_python(|py| {
            self.call_python(py, encoded).map_err(|e| {
                let text = e.value(py).to_string();
                let kind = e.get_type(py).name().map(|n| n.to_string()).unwrap_or_default();
                CallError::new("function-failed", format!("{} raised {kind}: {text}", self.name))
            })
        });
        let (shape, numbers) = called.unwrap_or_else(|| {
            Err(CallError::new("cancelled", "the interpreter of the Python function is ending"))
        })?;
        decode(&shape, &numbers).ok_or_else(|| {
            CallError::new(
                "wrong-result",
                format!("{} returned an array of shape {shape:?}", self.name),
            )
            .expected("a number, a vector (3,), a row (n,) or (n, 3), or a grid (m, n, 3)")
            .found(format!("{shape:?}"))
        })
    }

    fn call_python(
        &self,
        py: Python<'_>,
        args: Vec<Encoded>,
    ) -> PyResult<(Vec<usize>, Vec<Vec<f64>>)> {
        let list = PyList::empty(py);
        for (text, shape, numbers) in args {
            match text {
                Some(text) => list.append((text, py.None()))?,
                None => list.append((shape, numbers))?,
            }
        }
        py.import("moldloft.numbers")?
            .getattr("_call")?
            .call1((self.function.bind(py), list))?
            .extract()
    }
}

impl Foreign for PythonFunction {
    fn call_plain(&self, args: &[Value<f64>], _: &Context) -> Result<Value<f64>, CallError> {
        self.call(args)
    }
    fn call_dual(&self, args: &[Value<Dual4>], _: &Context) -> Result<Value<Dual4>, CallError> {
        self.call(args)
    }
}

/// A scalar as its parts.
trait ScalarParts: Real {
    fn parts(self) -> Vec<f64>;
    fn of_parts(parts: &[f64]) -> Self;
}

impl ScalarParts for f64 {
    fn parts(self) -> Vec<f64> {
        vec![self]
    }
    fn of_parts(parts: &[f64]) -> Self {
        parts[0]
    }
}

impl ScalarParts for Dual4 {
    fn parts(self) -> Vec<f64> {
        let [a, b, c, d] = self.eps;
        vec![self.re, a, b, c, d]
    }
    fn of_parts(parts: &[f64]) -> Self {
        let mut eps = [0.0; 4];
        for (e, part) in eps.iter_mut().zip(&parts[1..]) {
            *e = *part;
        }
        Dual { re: parts[0], eps }
    }
}

fn encode<T: ScalarParts>(value: &Value<T>) -> Option<Encoded> {
    let vector = |v: &Vec3<T>| v.to_array().map(ScalarParts::parts);
    let extents = |shape: moldloft::rows::ArrayShape| match shape {
        moldloft::rows::ArrayShape::Row(n) => vec![n],
        moldloft::rows::ArrayShape::Grid(m, n) => vec![m, n],
    };
    Some(match value {
        Value::Text(text) => (Some(text.to_string()), Vec::new(), Vec::new()),
        Value::Number(x) => (None, Vec::new(), vec![x.parts()]),
        Value::Vector(v) => (None, vec![3], vector(v).to_vec()),
        Value::Point(p) => (None, vec![3], vector(&p.xyz).to_vec()),
        Value::Numbers(a) => (None, extents(a.shape), a.items.iter().map(|x| x.parts()).collect()),
        Value::Vectors(a) => {
            let mut shape = extents(a.shape);
            shape.push(3);
            (None, shape, a.iter().flat_map(|v| vector(&v)).collect())
        }
        Value::Block(layers) => {
            let layers: Option<Vec<_>> = layers
                .iter()
                .map(|layer| if let Value::Vectors(a) = layer { Some(a) } else { None })
                .collect();
            let layers = layers?;
            let mut shape = extents(layers.first()?.shape);
            shape.extend([layers.len(), 3]);
            let columns = 0..layers.first()?.len();
            let points = columns.flat_map(|at| layers.iter().map(move |layer| layer.at(at)));
            (None, shape, points.flat_map(|v| vector(&v)).collect())
        }
        _ => return None,
    })
}

fn decode<T: ScalarParts>(shape: &[usize], numbers: &[Vec<f64>]) -> Option<Value<T>> {
    let all: Vec<T> = numbers.iter().map(|parts| T::of_parts(parts)).collect();
    let vectors = || all.chunks_exact(3).map(|v| Vec3::new(v[0], v[1], v[2])).collect::<Vec<_>>();
    Some(match *shape {
        [] => Value::Number(*all.first()?),
        [3] => Value::Vector(vectors()[0]),
        [_] => Value::Numbers(Arc::new(Array::row(all))),
        [_, 3] => Value::Vectors(Arc::new(Vectors::row(vectors()))),
        [m, n] => Value::Numbers(Arc::new(Array::grid(m, n, all))),
        [m, n, 3] => Value::Vectors(Arc::new(Vectors::grid(m, n, vectors()))),
        [ni, nj, nk, 3] => {
            let points = vectors();
            let layer = |k: usize| (0..ni * nj).map(|at| points[at * nk + k]).collect();
            let layers = (0..nk).map(|k| Value::Vectors(Arc::new(Vectors::grid(ni, nj, layer(k)))));
            Value::block(layers)?
        }
        _ => return None,
    })
}
