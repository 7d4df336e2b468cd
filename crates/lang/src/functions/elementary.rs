//! Elementary functions, as rows: element by element over numbers and rows of numbers.

use crate::value::blocks;
use crate::value::variables::{Called as _, ROUNDS};
use moldloft_num::{Real, Vec3, log10, modulo, whole_quotient};
use moldloft_registry::export::field_id;
use moldloft_registry::{
    Array, ArrayShape, CallError, Class, Context, FieldSpec, Implementation, Row, Value, Vectors,
};
use std::borrow::Cow;
use std::sync::Arc;

const fn argument(name: &'static str, help: &'static str) -> FieldSpec {
    FieldSpec::new(name, Class::Any, help)
}

fn not_a_number<T: Real>(value: &Value<T>, position: usize) -> CallError {
    let found = value.called();
    CallError::new("wrong-class", format!("expected a number or a row of numbers, found {found}"))
        .expected("a number or an farray")
        .found(found)
        .in_field(field_id(position))
}

/// The row of numbers that braces spell: `{1, 2, 3}`, of any length.
fn spelled<T: Real>(value: &Value<T>) -> Option<Value<T>> {
    match value {
        Value::Vector(v) => {
            let (shape, items) = (ArrayShape::Row(3), vec![v.x, v.y, v.z]);
            Some(Value::Numbers(Arc::new(Array { shape, items })))
        }
        Value::List(_) => match moldloft_arrays::gathered(value).into_owned() {
            row @ Value::Numbers(_) => Some(row),
            _ => None,
        },
        _ => None,
    }
}

fn each<T: Real>(name: &str, value: &Value<T>, f: &dyn Fn(T) -> T) -> Result<Value<T>, CallError> {
    if let Some(field) = crate::value::implicit::function(name, value) {
        return field;
    }
    match value {
        Value::Number(x) => Ok(Value::Number(f(*x))),
        Value::Numbers(a) => {
            let items = a.items.iter().map(|&x| f(x)).collect();
            Ok(Value::Numbers(Arc::new(Array { shape: a.shape, items })))
        }
        other => match (spelled(other), blocks::by_layer(other, |layer| each(name, layer, f))) {
            (Some(row), _) => each(name, &row, f),
            (None, Some(layers)) => layers,
            (None, None) => Err(not_a_number(other, 0)),
        },
    }
}

fn pairs<T: Real>(
    a: &Value<T>,
    b: &Value<T>,
    f: &dyn Fn(T, T) -> T,
) -> Result<Value<T>, CallError> {
    let differ = |found: String| {
        CallError::new("shapes-differ", format!("shapes differ: {found}"))
            .expected("equal shapes, or a single number on one side")
    };
    if let Some(layers) = blocks::by_layers(a, b, |a, b| pairs(a, b, f), differ) {
        return layers;
    }
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
        (Value::Number(_) | Value::Numbers(_), other) => match spelled(other) {
            Some(row) => pairs(a, &row, f),
            None => Err(not_a_number(other, 1)),
        },
        (other, _) => match spelled(other) {
            Some(row) => pairs(&row, b, f),
            None => Err(not_a_number(other, 0)),
        },
    }
}

/// The numbers of one argument reduced to one, or along an axis; those of several combined element by element.
///
/// `max(a)` is a number, `max(a, 0)` has the shape of a, `max(s.x, axis = 1)` is a row of the greatest of each
/// column.
fn reduced<T: Real>(
    name: &str,
    args: &[Value<T>],
    f: impl Fn(T, T) -> T + Copy,
) -> Result<Value<T>, CallError> {
    let (axis, args) = args.split_last().expect("the axis is the last argument");
    if let Some(field) = crate::value::implicit::functions(name, args) {
        return field;
    }
    let given: Vec<(usize, Cow<'_, Value<T>>)> = args
        .iter()
        .enumerate()
        .filter(|(_, arg)| !matches!(arg, Value::Unset))
        .map(|(k, arg)| (k, moldloft_arrays::gathered(arg)))
        .collect();
    if let ([(_, value)], Value::Unset) = (&given[..], axis)
        && let Some(flat) = blocks::flat(value)
    {
        return reduced(name, &[flat, Value::Unset], f);
    }
    if let Value::Number(axis) = axis {
        return match &given[..] {
            [(_, value)] => along_axis(value, axis.re(), &f),
            _ => Err(CallError::new("unused-argument", "an axis needs exactly one array")
                .expected("one array")
                .in_field(field_id(4))),
        };
    }
    if let [(_, value)] = &given[..]
        && let Value::Vectors(a) = &**value
    {
        // By component.
        let [x, y, z] = a.planes.each_ref().map(|plane| plane.iter().copied().reduce(f));
        return match (x, y, z) {
            (Some(x), Some(y), Some(z)) => Ok(Value::Vector([x, y, z].into())),
            _ if name == "sum" => Ok(Value::Vector(Vec3::zero())),
            _ => Err(CallError::new("empty", "an empty row has no such vector")),
        };
    }
    if let [(k, value)] = &given[..] {
        let numbers = match &**value {
            Value::Number(x) => vec![*x],
            Value::Numbers(a) => a.items.clone(),
            Value::Vector(v) => v.to_array().to_vec(),
            other => return Err(not_a_number(other, *k)),
        };
        return numbers
            .into_iter()
            .reduce(f)
            .or_else(|| (name == "sum").then(T::zero))
            .map(Value::Number)
            .ok_or_else(|| CallError::new("empty", "an empty row has no such number"));
    }
    let mut all: Option<Value<T>> = None;
    for (k, value) in given {
        let place = |fault: CallError| fault.in_field(field_id(k));
        all = Some(match all {
            None => value.into_owned(),
            Some(all) => componentwise(&all, &value, f).map_err(place)?,
        });
    }
    all.ok_or_else(|| CallError::new("empty", "there are no numbers"))
}

/// As `pairs`, of vectors by component.
fn componentwise<T: Real>(
    a: &Value<T>,
    b: &Value<T>,
    f: impl Fn(T, T) -> T + Copy,
) -> Result<Value<T>, CallError> {
    let parts = |v: &Value<T>| match v {
        Value::Vector(v) => Some(v.to_array()),
        Value::Number(x) => Some([*x; 3]),
        _ => None,
    };
    // Three numbers in braces beside a row of three are a row.
    let row = |v: &Value<T>| match v {
        Value::Vector(v) => Value::Numbers(Arc::new(Array::row(v.to_array().to_vec()))),
        other => other.clone(),
    };
    match (a, b) {
        (Value::Vector(_), Value::Numbers(_)) | (Value::Numbers(_), Value::Vector(_)) => {
            pairs(&row(a), &row(b), &f)
        }
        (Value::Vector(_), _) | (_, Value::Vector(_)) => match (parts(a), parts(b)) {
            (Some(a), Some(b)) => {
                let c: [T; 3] = std::array::from_fn(|k| f(a[k], b[k]));
                Ok(Value::Vector(c.into()))
            }
            _ => Err(CallError::new(
                "wrong-class",
                "a vector can be combined with a vector or a number only",
            )
            .expected("a number or a vector, or arrays of numbers in all arguments")),
        },
        _ => pairs(a, b, &f),
    }
}

/// A grid of numbers reduced along its first index (1) or its second (2).
fn along_axis<T: Real>(
    value: &Value<T>,
    axis: f64,
    f: &dyn Fn(T, T) -> T,
) -> Result<Value<T>, CallError> {
    if let Value::Vectors(a) = value {
        let plane = |c: usize| {
            let items = a.planes[c].clone();
            along_axis(&Value::Numbers(Arc::new(Array { shape: a.shape, items })), axis, f)
        };
        let (Value::Numbers(x), Value::Numbers(y), Value::Numbers(z)) =
            (plane(0)?, plane(1)?, plane(2)?)
        else {
            return Err(not_a_number(value, 0));
        };
        let planes = [x.items.clone(), y.items.clone(), z.items.clone()];
        return Ok(Value::Vectors(Arc::new(Vectors { shape: x.shape, planes })));
    }
    let Value::Numbers(a) = value else { return Err(not_a_number(value, 0)) };
    let ArrayShape::Grid(m, n) = a.shape else {
        return Err(CallError::new("wrong-shape", format!("an farray {} has one axis", a.shape))
            .expected("numbers [m,n]")
            .in_field(field_id(0)));
    };
    if axis != 1.0 && axis != 2.0 {
        return Err(CallError::new("out-of-range", format!("there is no axis {axis}"))
            .expected("1 or 2")
            .found(axis.to_string())
            .in_field(field_id(4)));
    }
    let (count, length) = if axis == 1.0 { (n, m) } else { (m, n) };
    let at = |k: usize, l: usize| if axis == 1.0 { a.items[l * n + k] } else { a.items[k * n + l] };
    let mut items = Vec::with_capacity(count);
    for k in 0..count {
        let one = (0..length).map(|l| at(k, l)).reduce(f);
        items.push(one.ok_or_else(|| CallError::new("empty", "an empty row has no such number"))?);
    }
    Ok(Value::Numbers(Arc::new(Array { shape: ArrayShape::Row(count), items })))
}

macro_rules! row {
    ($name:literal, $doc:literal, $fields:expr, $example:literal, $body:ident) => {
        Row::new(
            $name,
            Implementation::Native {
                plain: $body::<f64>,
                dual: $body::<moldloft_num::Dual4>,
                rev: moldloft_registry::taped!($body::<moldloft_num::Rev>),
            },
        )
        .doc($doc)
        .fields($fields)
        .example($example)
    };
}

/// A function of numbers, element by element.
#[derive(Clone, Copy)]
pub(crate) enum Elementary<T> {
    Unary(fn(T) -> T),
    Binary(fn(T, T) -> T),
}

/// The lesser of two numbers; NaN when one of them is, whichever it is.
fn lesser<T: Real>(a: T, b: T) -> T {
    if b.re().is_nan() { b } else { a.min(b) }
}

/// The greater of two numbers; NaN when one of them is, whichever it is.
fn greater<T: Real>(a: T, b: T) -> T {
    if b.re().is_nan() { b } else { a.max(b) }
}

/// The operation on two numbers, for `min`, `max` and `sum` of several arguments.
pub(crate) fn combining<T: Real>(name: &str) -> Option<(&'static str, Elementary<T>)> {
    Some(match name {
        "min" => ("min", Elementary::Binary(lesser)),
        "max" => ("max", Elementary::Binary(greater)),
        "sum" => ("sum", Elementary::Binary(|a, b| a + b)),
        _ => return None,
    })
}

/// `min`, `max` or `sum` of several numbers, which need not be finite.
pub(crate) fn combined<T: Real>(name: &str, args: &[Value<T>]) -> Option<Value<T>> {
    let (_, Elementary::Binary(f)) = combining(name)? else { return None };
    let number = |v: &Value<T>| if let Value::Number(x) = v { Some(*x) } else { None };
    let numbers: Vec<T> = args.iter().map(number).collect::<Option<_>>()?;
    (2..=4).contains(&numbers.len()).then(|| numbers.into_iter().reduce(f).map(Value::Number))?
}

/// True for functions that are faster than a look-up of cached values.
pub(crate) fn is_quick(row: &Row) -> bool {
    row.cheap && matches!(row.body, Implementation::Native { .. })
}

/// The value of an elementary function.
pub(crate) fn apply<T: Real>(
    name: &str,
    f: Elementary<T>,
    args: &[Value<T>],
) -> Result<Value<T>, CallError> {
    match f {
        Elementary::Unary(f) => each(name, &args[0], &f),
        Elementary::Binary(f) => match crate::value::implicit::functions(name, args) {
            Some(field) => field,
            None => pairs(&args[0], &args[1], &f),
        },
    }
}

/// Declares the elementary functions: their rows, and the list by which the interpreter takes them
/// into element-wise passes.
macro_rules! elementary {
    (
        unary { $($u:literal, $u_doc:literal, $u_example:literal, $u_f:expr;)* }
        binary { $($b:literal, $b_doc:literal, $b_example:literal, $x:literal, $y:literal, $b_f:expr;)* }
    ) => {
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
                        let f: fn(T) -> T = $u_f;
                        each($u, &args[0], &f)
                    }
                    row!($u, $u_doc, vec![argument("x", "A number, a row of numbers or a field.")],
                        $u_example, body).cheap()
                },)*
                $({
                    fn body<T: Real>(args: &[Value<T>], _: &Context) -> Result<Value<T>, CallError> {
                        apply($b, Elementary::Binary($b_f), args)
                    }
                    let fields =
                        vec![argument($x, "A number or a row."), argument($y, "A number or a row.")];
                    row!($b, $b_doc, fields, $b_example, body).cheap()
                },)*
            ]
        }
    };
}

/// A number without derivatives, the result of floor and round.
fn step<T: Real>(x: T, f: fn(f64) -> f64) -> T {
    T::from(f(x.re()))
}

/// The remainder of small positive integers, several times faster than the general one.
#[inline(always)]
pub fn small_remainder(a: f64, b: f64) -> Option<f64> {
    const MOST: f64 = 1_073_741_824.0;
    let rounded = |x: f64| (x + ROUNDS) - ROUNDS;
    let small = |x: f64| x > 0.0 && x < MOST && rounded(x) == x;
    (small(a) && small(b)).then(|| {
        // All is exact except the quotient, which is rounded anyway.
        let rest = a - rounded(a / b) * b;
        if rest < 0.0 { rest + b } else { rest }
    })
}

elementary! {
    unary {
        "sqrt", "Square root.", "assert sqrt(9) == 3;", T::sqrt;
        "sin", "Sine of an angle in radians.", "assert abs(sin(PI/6) - 0.5) < 1e-15;", T::sin;
        "cos", "Cosine of an angle in radians.", "assert cos(0) == 1;", T::cos;
        "tan", "Tangent of an angle in radians.", "assert abs(tan(PI/4) - 1) < 1e-15;", T::tan;
        "asin", "Arc sine, in radians.", "assert abs(asin(1) - PI/2) < 1e-15;", T::asin;
        "acos", "Arc cosine, in radians.", "assert acos(1) == 0;", T::acos;
        "atan", "Arc tangent, in radians.", "assert abs(atan(1) - PI/4) < 1e-15;", T::atan;
        "exp", "Exponential.", "assert abs(exp(1) - 2.718281828459045) < 1e-15;", T::exp;
        "log", "Natural logarithm.", "assert log(1) == 0;", T::ln;
        "log10", "Logarithm to base 10; exact for powers of ten.", "assert log10(1000) == 3;", log10;
        "sinh", "Hyperbolic sine.", "assert sinh(0) == 0;", T::sinh;
        "cosh", "Hyperbolic cosine.", "assert cosh(0) == 1;", T::cosh;
        "tanh", "Hyperbolic tangent.", "assert tanh(0) == 0;", T::tanh;
        "abs", "Absolute value; for a field its zero set as a sheet, without a solid side.", "assert abs(-2) == 2;", T::abs;
        "s_sqrt", "sgn(x) sqrt|x|.", "assert s_sqrt(-4) == -2;", |x: T| if x.re() < 0.0 { -(-x).sqrt() } else { x.sqrt() };
        "floor", "The greatest integer not above x.", "assert floor(-1.5) == -2;", |x: T| step(x, f64::floor);
        "ceil", "The least integer not below x.", "assert ceil(-1.5) == -1;", |x: T| step(x, f64::ceil);
        "round", "The nearest integer; halves are rounded away from zero.", "assert round(2.5) == 3;", |x: T| step(x, f64::round);
        "sign", "-1, 0 or 1.", "assert sign(-7) == -1;", |x: T| step(x, |x| if x == 0.0 { 0.0 } else { x.signum() });
        "radians", "Converts degrees to radians.", "assert abs(radians(180) - PI) < 1e-15;", |x: T| x * (std::f64::consts::PI / 180.0);
        "degrees", "Converts radians to degrees.", "assert abs(degrees(PI) - 180) < 1e-13;", |x: T| x * (180.0 / std::f64::consts::PI);
    }
    binary {
        "atan2", "Angle of the point (x, y), in radians: atan2(y, x).", "assert abs(atan2(1, -1) - 3*PI/4) < 1e-15;", "y", "x", T::atan2;
        "hypot", "Length of (a, b).", "assert hypot(3, 4) == 5;", "a", "b", hypotenuse;
        "mod", "Remainder of a / b, with the sign of b; exact.", "assert mod(-1, 3) == 2;", "a", "b", |a: T, b: T| {
            match small_remainder(a.re(), b.re()) {
                Some(exact) if T::PARTS == 1 => T::from(exact),
                _ => modulo(a, b),
            }
        };
        "div", "Integer quotient of a / b, rounded down.", "assert div(-1, 3) == -1;", "a", "b", |a: T, b: T| {
            T::from(whole_quotient(a.re(), b.re()))
        };
    }
}

/// Squares of numbers beyond this, or of both below its reciprocal, leave the range of floating-point numbers.
const LARGE_TO_SQUARE: f64 = 1e150;

/// The length of (a, b), at any size.
fn hypotenuse<T: Real>(a: T, b: T) -> T {
    let size = a.re().abs().max(b.re().abs());
    let squared = |a: T, b: T| (a * a + b * b).sqrt();
    if size == 0.0 || !size.is_finite() || (1.0 / LARGE_TO_SQUARE..LARGE_TO_SQUARE).contains(&size)
    {
        return squared(a, b);
    }
    // A power of two, so that scaling is exact.
    let scale = if size > 1.0 { libm::exp2(-600.0) } else { libm::exp2(600.0) };
    squared(a * scale, b * scale) / scale
}

fn optional(name: &'static str) -> FieldSpec {
    argument(name, "Another number.").optional()
}

fn several() -> Vec<FieldSpec> {
    vec![
        argument("a", "A number, vector or row of numbers."),
        optional("b"),
        optional("c"),
        optional("d"),
        argument("axis", "1 or 2: reduces numbers [m,n] along that index to a row.").optional(),
    ]
}

/// The rows of this file.
pub fn rows() -> Vec<Row> {
    fn least<T: Real>(args: &[Value<T>], _: &Context) -> Result<Value<T>, CallError> {
        reduced("min", args, lesser)
    }
    fn greatest<T: Real>(args: &[Value<T>], _: &Context) -> Result<Value<T>, CallError> {
        reduced("max", args, greater)
    }
    fn total<T: Real>(args: &[Value<T>], _: &Context) -> Result<Value<T>, CallError> {
        reduced("sum", args, |a, b| a + b)
    }
    fn average<T: Real>(args: &[Value<T>], _: &Context) -> Result<Value<T>, CallError> {
        let gathered = moldloft_arrays::gathered(&args[0]);
        let shape = match &*gathered {
            Value::Numbers(a) => Some(a.shape),
            Value::Vectors(a) => Some(a.shape),
            _ => None,
        };
        let count = match (&*gathered, &args[1]) {
            (Value::Numbers(_) | Value::Vectors(_), Value::Number(axis)) => {
                match shape.unwrap_or(ArrayShape::Row(1)) {
                    ArrayShape::Grid(m, n) => {
                        if axis.re() == 1.0 {
                            m
                        } else {
                            n
                        }
                    }
                    ArrayShape::Row(n) => n,
                }
            }
            (Value::Numbers(_) | Value::Vectors(_), _) => shape.map_or(1, ArrayShape::count),
            (Value::Vector(_), _) => 3,
            _ => 1,
        };
        let unset = || Value::Unset;
        let all = [args[0].clone(), unset(), unset(), unset(), args[1].clone()];
        Ok(match reduced("average", &all, |a, b| a + b)? {
            Value::Number(x) => Value::Number(x / count as f64),
            Value::Numbers(a) => {
                let items = a.items.iter().map(|x| *x / count as f64).collect();
                Value::Numbers(Arc::new(Array { shape: a.shape, items }))
            }
            Value::Vector(v) => Value::Vector(v / T::from(count as f64)),
            Value::Vectors(a) => {
                let planes = a
                    .planes
                    .each_ref()
                    .map(|plane| plane.iter().map(|x| *x / count as f64).collect());
                Value::Vectors(Arc::new(Vectors { shape: a.shape, planes }))
            }
            other => return Err(not_a_number(&other, 0)),
        })
    }
    let mut rows = Vec::new();
    rows.extend(elementary_rows());
    rows.push(
        row!(
            "min",
            "The least number of an array; with several arguments, the least element by element.",
            several(),
            "assert min(3, 1) == 1;",
            least
        )
        .cheap(),
    );
    rows.push(row!(
        "max",
        "The greatest number of an array; with several arguments, the greatest element by element.",
        several(),
        "assert max(3, 1) == 3;",
        greatest
    ).cheap());
    rows.push(
        row!(
            "sum",
            "The sum of the numbers of an array; with several arguments, the sum element by element.",
            several(),
            "assert sum({1, 2, 4}) == 7;",
            total
        )
        .cheap(),
    );
    rows.push(row!(
        // Called `mean` as well: that of a surface is its mean curvature.
        "average",
        "The mean of the numbers or vectors of an array; `mean` is the same.",
        vec![
            argument("a", "A row or grid of numbers."),
            argument("axis", "1 or 2: the means along that index, a row.").optional(),
        ],
        "assert average(list(1, 2, 6)) == 3;",
        average
    ));
    rows
}
