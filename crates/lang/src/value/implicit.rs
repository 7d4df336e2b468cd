//! Operators and functions on fields and sets.

use crate::value::variables::Called as _;
use moldloft_diag::Diagnostic;
use moldloft_field::{Primitive, field_value, primitive_of, set_of, set_value};
use moldloft_num::{Real, Vec3};
use moldloft_registry::export::field_id;
use moldloft_registry::{Array, CallError, Class, Value};
use moldloft_syntax::sdl::{BinaryOp, Type};
use std::sync::Arc;

fn is_implicit<T: Real>(value: &Value<T>) -> bool {
    matches!(value, Value::Field(_) | Value::Set(_))
}

fn undefined<T: Real>(op: BinaryOp, a: &Value<T>, b: &Value<T>) -> Diagnostic {
    let (word, found) = (op.spelling(), format!("{} and {}", a.called(), b.called()));
    let d = Diagnostic::error("wrong-operand", format!("`{word}` is not defined for {found}"))
        .found(found);
    match op {
        BinaryOp::Caret if matches!(a, Value::Set(_)) || matches!(b, Value::Set(_)) => d.help(
            "between sets ^ is the symmetric difference; the power of a field in a chain with sets \
             needs parentheses: (k^2)",
        ),
        BinaryOp::Add | BinaryOp::Mul | BinaryOp::Div => {
            d.help("arithmetic is for fields; sets are combined by |, &, - and ^")
        }
        BinaryOp::Union | BinaryOp::Intersection => {
            d.expected("sets, fields or planes").help("a field's solid side is set(f)")
        }
        _ => d.expected("fields and numbers, or sets"),
    }
}

/// The value of `a op b` with a field or set as an operand; `None` for other operands.
pub(crate) fn binary<T: Real>(
    op: BinaryOp,
    a: &Value<T>,
    b: &Value<T>,
) -> Option<Result<Value<T>, Diagnostic>> {
    let combined = matches!(op, BinaryOp::Union | BinaryOp::Intersection);
    let plane = |v: &Value<T>| matches!(v, Value::Plane(_));
    // The solid sides of planes alone can be combined too.
    let concerned = is_implicit(a) || is_implicit(b) || combined && plane(a) && plane(b);
    if !concerned {
        return None;
    }
    let sets = matches!(a, Value::Set(_)) || matches!(b, Value::Set(_)) || combined;
    Some(if sets { of_sets(op, a, b) } else { of_fields(op, a, b) })
}

fn of_sets<T: Real>(op: BinaryOp, a: &Value<T>, b: &Value<T>) -> Result<Value<T>, Diagnostic> {
    let (Some(x), Some(y)) = (set_of(a), set_of(b)) else { return Err(undefined(op, a, b)) };
    Ok(set_value(match op {
        BinaryOp::Union => x | y,
        BinaryOp::Intersection => x & y,
        BinaryOp::Sub => x - y,
        BinaryOp::Caret => x ^ y,
        _ => return Err(undefined(op, a, b)),
    }))
}

fn of_fields<T: Real>(op: BinaryOp, a: &Value<T>, b: &Value<T>) -> Result<Value<T>, Diagnostic> {
    let (Some(x), Some(y)) = (primitive_of(a), primitive_of(b)) else {
        return Err(undefined(op, a, b));
    };
    Ok(field_value(match op {
        BinaryOp::Add => x + y,
        BinaryOp::Sub => x - y,
        BinaryOp::Mul => x * y,
        BinaryOp::Div => x.over(&y).map_err(|_| {
            let help = if matches!(b, Value::Number(_)) {
                "the divisor is 0"
            } else {
                "multiply out, or divide by a number: f / g = 0 is f = 0"
            };
            Diagnostic::error("field-division", "a field can only be divided by a non-zero number")
                .expected("a non-zero number")
                .found(b.called())
                .help(help)
        })?,
        BinaryOp::Caret => {
            let Value::Number(n) = b else { return Err(undefined(op, a, b)) };
            x.to_power(n.re()).map_err(|e| {
                Diagnostic::error("field-power", e.to_string())
                    .expected("a whole number from 0 to 1000")
                    .found(n.re().to_string())
                    .help("roots are sqrt(f) and s_sqrt(f)")
            })?
        }
        _ => return Err(undefined(op, a, b)),
    }))
}

/// `-a` of a field, or the complement of a set; `None` for other values.
pub(crate) fn negated<T: Real>(a: &Value<T>) -> Option<Value<T>> {
    match a {
        Value::Field(_) => primitive_of(a).map(|f| field_value(-f)),
        Value::Set(_) => set_of(a).map(|s| set_value(-s)),
        _ => None,
    }
}

/// `|a|` of a field: its sheet; `None` for other values.
pub(crate) fn magnitude<T: Real>(a: &Value<T>) -> Option<Value<T>> {
    match a {
        Value::Field(_) => primitive_of(a).map(|f| field_value(f.abs())),
        _ => None,
    }
}

/// A function of one number applied to a field; `None` for other values.
pub(crate) fn function<T: Real>(name: &str, a: &Value<T>) -> Option<Result<Value<T>, CallError>> {
    if let Value::Set(_) = a {
        return Some(Err(CallError::new("wrong-class", format!("{name} takes no set"))
            .expected("a number, a row of numbers or a field")
            .found("a set")
            .help("apply it to the field, then make the set")
            .in_field(field_id(0))));
    }
    let Value::Field(_) = a else { return None };
    let f = primitive_of(a)?;
    Some(Ok(field_value(match name {
        "abs" => f.abs(),
        "sign" => f.sign(),
        "sqrt" => f.sqrt(),
        "s_sqrt" => f.s_sqrt(),
        "sin" => f.sin(),
        "cos" => f.cos(),
        "exp" => f.exp(),
        "log" => f.ln(),
        "tan" => f.tan(),
        _ => {
            return Some(Err(CallError::new("wrong-class", format!("{name} takes no field"))
                .expected(
                    "of fields abs, sign, sqrt, s_sqrt, sin, cos, tan, exp, log, min, max, atan2",
                )
                .found("a field")
                .in_field(field_id(0))));
        }
    })))
}

/// A function of several numbers applied to fields; `None` when there is no field among them.
pub(crate) fn functions<T: Real>(
    name: &str,
    args: &[Value<T>],
) -> Option<Result<Value<T>, CallError>> {
    let at = args.iter().position(is_implicit)?;
    let mut fields = Vec::new();
    for (k, arg) in args.iter().enumerate().filter(|(_, a)| !matches!(a, Value::Unset)) {
        match primitive_of(arg) {
            Some(f) => fields.push(f),
            None => {
                return Some(Err(
                    CallError::wrong_class(Class::Field, arg.class()).in_field(field_id(k))
                ));
            }
        }
    }
    let combined = |f: fn(&Primitive<T>, &Primitive<T>) -> Primitive<T>| {
        fields.iter().skip(1).fold(fields[0].clone(), |a, b| f(&a, b))
    };
    Some(Ok(field_value(match name {
        "min" => combined(Primitive::min),
        "max" => combined(Primitive::max),
        "sum" => combined(|a, b| a + b),
        "atan2" => fields[0].atan2(&fields[1]),
        "hypot" => combined(|a, b| (a * a + b * b).sqrt()),
        _ => {
            return Some(Err(CallError::new("wrong-class", format!("{name} takes no field"))
                .expected("numbers or rows of numbers")
                .found("a field")
                .in_field(field_id(at))));
        }
    })))
}

/// A set or field with the name that it is declared under, for its faces; one that was given by
/// `attributes` stays.
pub(crate) fn called<T: Real>(ty: Type, value: Value<T>, name: &str) -> Value<T> {
    match (ty, value) {
        (Type::Field, Value::Field(f)) => Value::Field(f.called(name)),
        (Type::Set, value @ Value::Set(_)) => match set_of(&value) {
            Some(set) if set.attributes().is_none_or(|a| !a.given) => set_value(set.named(name)),
            _ => value,
        },
        (_, value) => value,
    }
}

/// The values of a field or set at a point, or at each of a row or grid.
pub(crate) fn at<T: Real>(shape: &Value<T>, place: &Value<T>) -> Result<Value<T>, Diagnostic> {
    let values = |points: &[Vec3<T>]| -> Vec<T> {
        match shape {
            Value::Field(f) => points.iter().map(|p| f.value(*p)).collect(),
            _ => match set_of(shape) {
                Some(set) => points.iter().map(|p| set.value(*p)).collect(),
                None => Vec::new(),
            },
        }
    };
    let one = |p: Vec3<T>| Ok(Value::Number(values(&[p])[0]));
    match place {
        Value::Vector(p) => one(*p),
        Value::Point(p) => one(p.xyz),
        Value::Vectors(a) => {
            Ok(Value::Numbers(Arc::new(Array { shape: a.shape, items: values(&a.points()) })))
        }
        other => Err(Diagnostic::error("wrong-type", "a field is evaluated at a point")
            .expected("a point, a vector, or a row or grid of vectors")
            .found(other.called())),
    }
}

/// Description of a field or set in one line.
pub(crate) fn described<T: Real>(value: &Value<T>) -> Option<String> {
    match value {
        Value::Field(_) => {
            let f = primitive_of(value)?;
            let form = f.form().name();
            let word = if form == "field" { "field".to_string() } else { format!("{form} field") };
            Some(format!("{word} of degree {}", f.degree()))
        }
        Value::Set(_) => {
            let set = set_of(value)?;
            Some(match set.contents() {
                0 if set.is_everything() => "set of everything".into(),
                0 => "empty set".into(),
                1 => format!("set of 1 primitive of degree {}", set.degree()),
                n => format!("set of {n} primitives, of degree {}", set.degree()),
            })
        }
        _ => None,
    }
}
