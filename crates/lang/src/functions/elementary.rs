//! Elementary functions, as rows: element by element over numbers and rows of numbers.

use crate::value::variables::Called as _;
use moldloft_num::Real;
use moldloft_registry::export::field_id;
use moldloft_registry::{
    Array, Body, CallError, Class, Context, DefaultValue, Field, Row, Unit, Value,
};
use std::borrow::Cow;
use std::sync::Arc;

const fn argument(name: &'static str, help: &'static str) -> Field {
    Field {
        name,
        help,
        class: Class::Any,
        many: false,
        default: None,
        unit: Unit::None,
        min: None,
        max: None,
        min_items: 0,
        variadic: false,
    }
}

fn not_a_number<T: Real>(value: &Value<T>, position: usize) -> CallError {
    let found = value.called();
    CallError::new("wrong-class", format!("expected a number or a row of numbers, found {found}"))
        .expected("a number or an farray")
        .found(found)
        .in_field(field_id(position))
}

fn each<T: Real>(name: &str, value: &Value<T>, f: impl Fn(T) -> T) -> Result<Value<T>, CallError> {
    if let Some(field) = crate::functions::sets::function(name, value) {
        return field;
    }
    match value {
        Value::Number(x) => Ok(Value::Number(f(*x))),
        Value::Numbers(a) => {
            let items = a.items.iter().map(|&x| f(x)).collect();
            Ok(Value::Numbers(Arc::new(Array { shape: a.shape, items })))
        }
        other => Err(not_a_number(other, 0)),
    }
}

fn pairs<T: Real>(
    a: &Value<T>,
    b: &Value<T>,
    f: impl Fn(T, T) -> T,
) -> Result<Value<T>, CallError> {
    let array = |shape, items| Ok(Value::Numbers(Arc::new(Array { shape, items })));
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => Ok(Value::Number(f(*a, *b))),
        (Value::Numbers(a), Value::Number(b)) => {
            array(a.shape, a.items.iter().map(|&x| f(x, *b)).collect())
        }
        (Value::Number(a), Value::Numbers(b)) => {
            array(b.shape, b.items.iter().map(|&y| f(*a, y)).collect())
        }
        (Value::Numbers(a), Value::Numbers(b)) if a.shape == b.shape => {
            array(a.shape, a.items.iter().zip(&b.items).map(|(&x, &y)| f(x, y)).collect())
        }
        (Value::Numbers(a), Value::Numbers(b)) => Err(CallError::new(
            "shapes-differ",
            format!("shapes differ: {} and {}", a.shape, b.shape),
        )
        .expected("equal shapes, or a single number on one side")),
        (Value::Number(_) | Value::Numbers(_), other) => Err(not_a_number(other, 1)),
        (other, _) => Err(not_a_number(other, 0)),
    }
}

/// All numbers of the arguments: of `max(a)`, of `max(a, b, c)`.
fn reduced<T: Real>(
    name: &str,
    args: &[Value<T>],
    f: impl Fn(T, T) -> T,
) -> Result<Value<T>, CallError> {
    if let Some(field) = crate::functions::sets::functions(name, args) {
        return field;
    }
    let mut numbers = Vec::new();
    for (k, arg) in args.iter().enumerate() {
        match arg {
            Value::Number(x) => numbers.push(*x),
            Value::Numbers(a) => numbers.extend(&a.items),
            Value::Vector(v) => numbers.extend(v.to_array()),
            Value::Unset => {}
            other => return Err(not_a_number(other, k)),
        }
    }
    numbers
        .into_iter()
        .reduce(f)
        .map(Value::Number)
        .ok_or_else(|| CallError::new("empty", "an empty row has no such number"))
}

macro_rules! row {
    ($name:literal, $doc:literal, $fields:expr, $example:literal, $body:ident) => {
        Row {
            name: Cow::Borrowed($name),
            doc: Cow::Borrowed($doc),
            class: Class::Any,
            fields: Cow::Owned($fields),
            kind: false,
            columns: None,
            sweep: None,
            example: Cow::Borrowed($example),
            body: Body::Native { plain: $body::<f64>, dual: $body::<moldloft_num::Dual4> },
        }
    };
}

/// A function of numbers, element by element.
#[derive(Clone, Copy)]
pub(crate) enum Elementary<T> {
    Unary(fn(T) -> T),
    Binary(fn(T, T) -> T),
}

/// Functions of arrays that take no longer than comparing their arguments with remembered ones.
const QUICK: [&str; 30] = [
    "min",
    "max",
    "sum",
    "prod",
    "argmin",
    "argmax",
    "dot",
    "norm",
    "len",
    "cumlen",
    "centroid",
    "bbox_min",
    "bbox_max",
    "list",
    "points",
    "join",
    "stack",
    "reverse",
    "swap",
    "spread_i",
    "spread_j",
    "d1",
    "d2",
    "translate",
    "scale",
    "mirror",
    "rotate",
    "uniform",
    "cosine",
    "tfi",
];

/// True for functions that take no longer than finding their remembered values.
pub(crate) fn is_quick(row: &Row) -> bool {
    let own = QUICK.contains(&&*row.name) || elementary::<f64>(&row.name).is_some();
    own && matches!(row.body, Body::Native { .. })
}

/// The value of an elementary function.
pub(crate) fn apply<T: Real>(
    name: &str,
    f: Elementary<T>,
    args: &[Value<T>],
) -> Result<Value<T>, CallError> {
    match f {
        Elementary::Unary(f) => each(name, &args[0], f),
        Elementary::Binary(f) => match crate::functions::sets::functions(name, args) {
            Some(field) => field,
            None => pairs(&args[0], &args[1], f),
        },
    }
}

/// Declares the elementary functions: their rows, and the list by which the interpreter takes them
/// into element-wise passes.
macro_rules! elementary {
    (
        unary { $($u:literal, $u_doc:literal, $u_f:expr;)* }
        binary { $($b:literal, $b_doc:literal, $x:literal, $y:literal, $b_f:expr;)* }
    ) => {
        /// The elementary function of that name.
        pub(crate) fn elementary<T: Real>(name: &str) -> Option<(&'static str, Elementary<T>)> {
            Some(match name {
                $($u => ($u, Elementary::Unary($u_f)),)*
                $($b => ($b, Elementary::Binary($b_f)),)*
                _ => return None,
            })
        }

        fn elementary_rows() -> Vec<Row> {
            vec![
                $({
                    fn body<T: Real>(args: &[Value<T>], _: &Context) -> Result<Value<T>, CallError> {
                        each($u, &args[0], $u_f)
                    }
                    row!($u, $u_doc, vec![argument("x", "A number, a row of numbers or a field.")],
                        "assert sin(0) == 0;", body)
                },)*
                $({
                    fn body<T: Real>(args: &[Value<T>], _: &Context) -> Result<Value<T>, CallError> {
                        apply($b, Elementary::Binary($b_f), args)
                    }
                    let fields =
                        vec![argument($x, "A number or a row."), argument($y, "A number or a row.")];
                    row!($b, $b_doc, fields, "assert hypot(3, 4) == 5;", body)
                },)*
            ]
        }
    };
}

/// A number without derivatives: what the steps of floor and round give.
fn step<T: Real>(x: T, f: fn(f64) -> f64) -> T {
    T::from(f(x.re()))
}

elementary! {
    unary {
        "sqrt", "Square root.", T::sqrt;
        "sin", "Sine of an angle in radians.", T::sin;
        "cos", "Cosine of an angle in radians.", T::cos;
        "tan", "Tangent of an angle in radians.", T::tan;
        "asin", "Arc sine, in radians.", T::asin;
        "acos", "Arc cosine, in radians.", T::acos;
        "atan", "Arc tangent, in radians.", T::atan;
        "exp", "Exponential.", T::exp;
        "log", "Natural logarithm.", T::ln;
        "log10", "Logarithm to the base 10.", |x: T| x.ln() / T::from(10.0).ln();
        "sinh", "Hyperbolic sine.", T::sinh;
        "cosh", "Hyperbolic cosine.", T::cosh;
        "tanh", "Hyperbolic tangent.", T::tanh;
        "abs", "Absolute value; of a field its sheet, which has no solid side.", T::abs;
        "s_sqrt", "sgn(x) sqrt|x|.", |x: T| if x.re() < 0.0 { -(-x).sqrt() } else { x.sqrt() };
        "floor", "The greatest whole number that is not greater.", |x: T| step(x, f64::floor);
        "ceil", "The least whole number that is not less.", |x: T| step(x, f64::ceil);
        "round", "The nearest whole number; halves away from zero.", |x: T| step(x, f64::round);
        "sign", "-1, 0 or 1.", |x: T| step(x, |x| if x == 0.0 { 0.0 } else { x.signum() });
        "radians", "An angle given in degrees, in radians.", |x: T| x * (std::f64::consts::PI / 180.0);
        "degrees", "An angle given in radians, in degrees.", |x: T| x * (180.0 / std::f64::consts::PI);
    }
    binary {
        "atan2", "Angle of the point (x, y), in radians: atan2(y, x).", "y", "x", T::atan2;
        "hypot", "Length of (a, b).", "a", "b", |a: T, b: T| (a * a + b * b).sqrt();
        "mod", "Remainder of a / b, with the sign of b.", "a", "b", |a: T, b: T| {
            a - b * T::from((a.re() / b.re()).floor())
        };
        "div", "Whole quotient of a / b, rounded down.", "a", "b", |a: T, b: T| {
            T::from((a.re() / b.re()).floor())
        };
    }
}

fn optional(name: &'static str) -> Field {
    Field { default: Some(DefaultValue::Unset), ..argument(name, "Another number.") }
}

fn several() -> Vec<Field> {
    vec![
        argument("a", "A number, vector or row of numbers."),
        optional("b"),
        optional("c"),
        optional("d"),
    ]
}

/// The rows of this file.
pub fn rows() -> Vec<Row> {
    fn least<T: Real>(args: &[Value<T>], _: &Context) -> Result<Value<T>, CallError> {
        reduced("min", args, T::min)
    }
    fn greatest<T: Real>(args: &[Value<T>], _: &Context) -> Result<Value<T>, CallError> {
        reduced("max", args, T::max)
    }
    fn total<T: Real>(args: &[Value<T>], _: &Context) -> Result<Value<T>, CallError> {
        reduced("sum", args, |a, b| a + b)
    }
    let mut rows = Vec::new();
    rows.extend(elementary_rows());
    rows.push(row!(
        "min",
        "The least of all numbers given.",
        several(),
        "assert min(3, 1) == 1;",
        least
    ));
    rows.push(row!(
        "max",
        "The greatest of all numbers given.",
        several(),
        "assert max(3, 1) == 3;",
        greatest
    ));
    rows.push(row!(
        "sum",
        "The sum of all numbers given.",
        several(),
        "assert sum({1, 2, 4}) == 7;",
        total
    ));
    rows
}
