//! Calling rows as the language does, and comparing their derivatives with differences.
#![allow(dead_code)]

use moldloft_num::{Dual4, Real, Vec3};
use moldloft_registry::{
    Array, CallError, Context, Given, Row, Scalar, Value, Vectors, bind_arguments,
};
use std::sync::Arc;

pub fn row(name: &str) -> Row {
    moldloft_arrays::rows()
        .into_iter()
        .find(|row| row.name == name)
        .unwrap_or_else(|| panic!("{name}"))
}

/// Calls an intrinsic.
pub fn call<T: Scalar>(name: &str, args: &[Value<T>]) -> Result<Value<T>, CallError> {
    let row = row(name);
    let given = Given { positional: args.to_vec(), named: vec![] };
    let (args, _) = bind_arguments(&row, given, |_| unreachable!("no objects here"))?;
    T::call(&row, &args, &Context::default())
}

pub fn ok(name: &str, args: &[Value<f64>]) -> Value<f64> {
    call(name, args).unwrap_or_else(|fault| panic!("{name}: {fault:?}"))
}

pub fn number(x: f64) -> Value<f64> {
    Value::Number(x)
}

pub fn text(word: &str) -> Value<f64> {
    Value::text(word)
}

pub fn farray(items: &[f64]) -> Value<f64> {
    Value::Numbers(Arc::new(Array::row(items.to_vec())))
}

pub fn curve(items: &[[f64; 3]]) -> Value<f64> {
    Value::Vectors(Arc::new(Vectors::row(items.iter().map(|p| Vec3::from(*p)).collect())))
}

pub fn surface(m: usize, n: usize, f: impl Fn(usize, usize) -> [f64; 3]) -> Value<f64> {
    let items = (0..m * n).map(|k| Vec3::from(f(k / n, k % n))).collect();
    Value::Vectors(Arc::new(Vectors::grid(m, n, items)))
}

pub fn numbers(value: &Value<f64>) -> Vec<f64> {
    match value {
        Value::Number(x) => vec![*x],
        Value::Numbers(a) => a.items.clone(),
        Value::Vector(v) => v.to_array().to_vec(),
        Value::Vectors(a) => a.iter().flat_map(|v| v.to_array()).collect(),
        other => panic!("{other:?}"),
    }
}

pub fn points(value: &Value<f64>) -> Vec<Vec3> {
    match value {
        Value::Vectors(a) => a.points(),
        Value::Vector(v) => vec![*v],
        other => panic!("{other:?}"),
    }
}

pub fn close(a: f64, b: f64, accuracy: f64) {
    assert!((a - b).abs() <= accuracy, "{a} against {b}");
}

/// The id of the fault of a call, with the field and item that it is about.
pub fn refused(name: &str, args: &[Value<f64>]) -> (&'static str, Option<usize>, Option<usize>) {
    let fault = call(name, args).err().unwrap_or_else(|| panic!("{name} did not refuse"));
    assert!(!fault.message.is_empty());
    (fault.id, fault.field(), fault.item())
}

/// Every number in `value` becomes x + h times its component of a direction that depends on `seed`.
fn moved<T: Real>(value: &Value<f64>, move_by: &mut impl FnMut(f64) -> T) -> Value<T> {
    let mut vector = |v: &Vec3| Vec3::new(move_by(v.x), move_by(v.y), move_by(v.z));
    match value {
        Value::Vector(v) => Value::Vector(vector(v)),
        Value::Vectors(a) => {
            let items: Vec<_> = a.iter().map(|v| vector(&v)).collect();
            Value::Vectors(Arc::new(Vectors::new(a.shape, items)))
        }
        Value::Number(x) => Value::Number(move_by(*x)),
        Value::Numbers(a) => {
            let items = a.items.iter().map(|x| move_by(*x)).collect();
            Value::Numbers(Arc::new(Array { shape: a.shape, items }))
        }
        Value::Text(text) => Value::Text(text.clone()),
        Value::List(items) => Value::list(items.iter().map(|v| moved(v, move_by))),
        Value::Unset => Value::Unset,
        other => panic!("{other:?} cannot be moved"),
    }
}

fn noise(k: usize) -> f64 {
    // A low-discrepancy sequence in [-1, 1].
    2.0 * ((k as f64 + 1.0) * 0.618_033_988_749_894_9).fract() - 1.0
}

fn flat<T: Real>(value: &Value<T>, part: usize) -> Vec<f64> {
    match value {
        Value::Number(x) => vec![x.part(part)],
        Value::Vector(v) => v.to_array().iter().map(|x| x.part(part)).collect(),
        Value::Numbers(a) => a.items.iter().map(|x| x.part(part)).collect(),
        Value::Vectors(a) => a.iter().flat_map(|v| v.to_array()).map(|x| x.part(part)).collect(),
        other => panic!("{other:?}"),
    }
}

/// Asserts that the derivative of a pipeline in a direction that moves every number of the
/// `active` arguments equals its central difference (Richardson's, of steps h and h/2), to
/// `accuracy` of the largest.
pub fn law(
    args: &[Value<f64>],
    active: &[usize],
    accuracy: f64,
    plain: impl Fn(&[Value<f64>]) -> Value<f64>,
    dual: impl Fn(&[Value<Dual4>]) -> Value<Dual4>,
) {
    let at = |h: f64| -> Vec<f64> {
        let mut k = 0;
        let mut step = |x: f64| {
            k += 1;
            x + h * noise(k)
        };
        let moved_args: Vec<Value<f64>> = args
            .iter()
            .enumerate()
            .map(|(k, v)| if active.contains(&k) { moved(v, &mut step) } else { v.clone() })
            .collect();
        flat(&plain(&moved_args), 0)
    };
    let mut k = 0;
    let mut seeded = |x: f64| {
        k += 1;
        Dual4::from_parts(|part| match part {
            0 => x,
            1 => noise(k),
            _ => 0.0,
        })
    };
    let dual_args: Vec<Value<Dual4>> = args
        .iter()
        .enumerate()
        .map(|(k, v)| {
            if active.contains(&k) {
                moved(v, &mut seeded)
            } else {
                moved(v, &mut |x| Dual4::from(x))
            }
        })
        .collect();
    let value = dual(&dual_args);
    let (real, exact) = (flat(&value, 0), flat(&value, 1));
    let base = at(0.0);
    for (a, b) in real.iter().zip(&base) {
        assert!(
            (a - b).abs() <= 1e-12 * (1.0 + b.abs()),
            "value with derivatives {a}, without {b}"
        );
    }
    let h = 1e-4;
    let central = |h: f64| -> Vec<f64> {
        at(h).iter().zip(at(-h)).map(|(a, b)| (a - b) / (2.0 * h)).collect()
    };
    let (coarse, fine) = (central(h), central(0.5 * h));
    let largest = exact.iter().fold(1e-3f64, |m, x| m.max(x.abs()));
    for (i, x) in exact.iter().enumerate() {
        let difference = (4.0 * fine[i] - coarse[i]) / 3.0;
        assert!(
            (x - difference).abs() <= accuracy * largest,
            "derivative {i}: {x}, differences {difference}"
        );
    }
}
