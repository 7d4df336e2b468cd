//! Calls with numbers of a tape: the row's own body, or for functions without one their Jacobian as one node a number.

use crate::{CallError, Context, Implementation, Row, Scalar, Value};
use moldloft_num::{DerivativeTape, Dual4, Real, Rev};
use std::collections::HashMap;

/// A body for numbers of a tape; in a page, whose engine has no reverse differentiation, none.
#[doc(hidden)]
#[cfg(not(target_family = "wasm"))]
#[macro_export]
macro_rules! taped {
    ($body:expr) => {
        Some($body)
    };
}
#[doc(hidden)]
#[cfg(target_family = "wasm")]
#[macro_export]
macro_rules! taped {
    ($body:expr) => {
        None
    };
}

impl Scalar for Rev {
    fn call(row: &Row, args: &[Value<Rev>], context: &Context) -> Result<Value<Rev>, CallError> {
        match &row.body {
            Implementation::Native { rev: Some(rev), .. } => rev(args, context),
            _ => by_jacobian(row, args, context),
        }
    }
}

/// Directions of a dual number.
const DIRECTIONS: usize = 4;

/// The value of numbers by a function that knows no tape, from its Jacobian by the nodes of its arguments.
fn by_jacobian(row: &Row, args: &[Value<Rev>], context: &Context) -> Result<Value<Rev>, CallError> {
    if !args.iter().all(is_of_numbers) {
        return Err(no_tape(row));
    }
    // A number may be in several arguments.
    let mut inputs: Vec<Rev> = Vec::new();
    let mut places: HashMap<u64, usize> = HashMap::new();
    for x in args.iter().filter_map(Value::numbers).flatten().filter(|x| !x.is_constant()) {
        if !x.is_finite() {
            return Err(no_tape(row));
        }
        places.entry(x.node()).or_insert_with(|| {
            inputs.push(x);
            inputs.len() - 1
        });
    }
    // By more numbers than the gradient has it would take longer than forward differentiation as a whole.
    if inputs.len() > DerivativeTape::inputs().max(DIRECTIONS) {
        return Err(no_tape(row));
    }
    let mut rates: Vec<Vec<(f64, Rev)>> = Vec::new();
    let mut value = Value::Unset;
    for from in (0..inputs.len().max(1)).step_by(DIRECTIONS) {
        let directions = &inputs[from..inputs.len().min(from + DIRECTIONS)];
        let seeded = |x: Rev| {
            let mut dual = Dual4::from(x.re());
            if let Some(place) = places.get(&x.node()).filter(|_| !x.is_constant())
                && (from..from + DIRECTIONS).contains(place)
            {
                dual.eps[place - from] = 1.0;
            }
            dual
        };
        let lifted: Option<Vec<Value<Dual4>>> =
            args.iter().map(|arg| arg.map_numbers(&mut { seeded })).collect();
        value = Dual4::call(row, &lifted.ok_or_else(|| no_tape(row))?, context)?;
        if !is_of_numbers(&value) {
            return Err(no_tape(row));
        }
        let found = value.numbers().ok_or_else(|| no_tape(row))?;
        rates.resize(found.len(), Vec::new());
        for (rates, x) in rates.iter_mut().zip(found) {
            rates.extend(x.eps.into_iter().zip(directions.iter().copied()));
        }
    }
    let mut rates = rates.iter();
    let taped = value.map_numbers(&mut |x: Dual4| match rates.next() {
        Some(rates) => Rev::linear(x.re, rates),
        None => Rev::from(x.re),
    });
    taped.ok_or_else(|| no_tape(row))
}

/// True for a value that is known by its numbers: a point may also know where it is on a curve.
fn is_of_numbers<T: Real>(value: &Value<T>) -> bool {
    match value {
        Value::List(items) | Value::Block(items) => items.iter().all(is_of_numbers),
        Value::Unset
        | Value::Number(_)
        | Value::Text(_)
        | Value::Vector(_)
        | Value::Numbers(_)
        | Value::Vectors(_) => true,
        _ => false,
    }
}

/// A fault of the row, not of the model: forward differentiation takes its place.
fn no_tape(row: &Row) -> CallError {
    CallError::new("no-reverse", format!("`{}` has derivatives in forward mode only", row.name))
}
