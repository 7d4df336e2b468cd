//! Functions of the registry that take and give fields and sets, called from Python.

use super::arguments::finished;
use super::field::PyField;
use super::oracle::Slots;
use super::set::PySet;
use crate::error::{plain_error, unknown_name};
use crate::value::to_python;
use moldloft::field::{field_value, primitive_of, set_of, set_value};
use moldloft::num::Vec3;
use moldloft::rows::{
    CallError, Class, Context, Given, Registry, Row, Scalar, Value, bind_arguments,
};
use pyo3::prelude::*;
use std::sync::LazyLock;

static REGISTRY: LazyLock<Registry> = LazyLock::new(moldloft::document::registry);

/// Result of a function, its arguments in order: `None` for an omitted one, a point and a direction
/// for a line, a list for several.
#[pyfunction]
pub fn call_row<'py>(
    py: Python<'py>,
    name: &str,
    args: Vec<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let Some(row) = REGISTRY.get(name) else {
        return Err(unknown_name(format!("the language has no function `{name}`")));
    };
    let mut slots = Slots::default();
    let read = |(k, arg): (usize, &Bound<'py, PyAny>)| {
        let class = row.fields.get(k).map_or(Class::Any, |field| field.class);
        argument(class, arg, &mut slots)
    };
    let positional: PyResult<Vec<_>> = args.iter().enumerate().map(read).collect();
    let positional = positional?;
    // Fields of Python functions wait for the interpreter's lock.
    let made = py.detach(|| called(row, positional)).map_err(|error| described(&error));
    let value = finished(py, &slots, made)?;
    if let Some(inner) = primitive_of(&value).filter(|_| matches!(value, Value::Field(_))) {
        return Ok(Bound::new(py, PyField { inner, slots })?.into_any());
    }
    match set_of(&value) {
        Some(inner) => Ok(Bound::new(py, PySet { inner, slots })?.into_any()),
        None => to_python(py, &value),
    }
}

/// The message with the expected input.
fn described(error: &CallError) -> String {
    match error.expected.as_ref().filter(|expected| !error.message.contains(*expected)) {
        Some(expected) => format!("{}: expected {expected}", error.message),
        None => error.message.clone(),
    }
}

fn called(row: &Row, positional: Vec<Value<f64>>) -> Result<Value<f64>, CallError> {
    let given = Given { positional, named: Vec::new() };
    let (args, _) = bind_arguments(row, given, |_| Class::Any)?;
    f64::call(row, &args, &Context::default())
}

fn argument(class: Class, arg: &Bound<'_, PyAny>, slots: &mut Slots) -> PyResult<Value<f64>> {
    if arg.is_none() {
        return Ok(Value::Unset);
    }
    if let Ok(field) = arg.cast::<PyField>() {
        let field = field.get();
        *slots = slots.with(&field.slots);
        return Ok(field_value(field.inner.clone()));
    }
    if let Ok(set) = arg.cast::<PySet>() {
        let set = set.get();
        *slots = slots.with(&set.slots);
        return Ok(set_value(set.inner.clone()));
    }
    if class == Class::Axis {
        let (point, direction) = arg.extract::<([f64; 3], [f64; 3])>()?;
        return line(Vec3::from(point), Vec3::from(direction))
            .map_err(|error| plain_error(described(&error)));
    }
    if let Ok(text) = arg.extract::<String>() {
        return Ok(Value::text(&text));
    }
    if let Ok(x) = arg.extract::<f64>() {
        return Ok(Value::Number(x));
    }
    if let (Class::Point | Class::Vector, Ok(v)) = (class, arg.extract::<[f64; 3]>()) {
        return Ok(Value::Vector(Vec3::from(v)));
    }
    let items: PyResult<Vec<_>> =
        arg.try_iter()?.map(|item| argument(class, &item?, slots)).collect();
    Ok(Value::list(items?))
}

/// A line through a point, so long that the difference of its ends keeps the digits of the direction.
fn line(point: Vec3, direction: Vec3) -> Result<Value<f64>, CallError> {
    let far = point.norm() / direction.norm();
    // A power of two: the product is exact.
    let mut size = 1.0;
    while size < far && far.is_finite() {
        size *= 2.0;
    }
    let row = REGISTRY.get("Line").expect("the kind of straight lines");
    called(row, vec![Value::Vector(point), Value::Vector(point + direction * size)])
}
