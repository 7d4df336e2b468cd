//! Values as a person reads them.

use moldloft_num::Real;
use moldloft_registry::{ArrayShape, Value};
use moldloft_syntax::number;

/// The value on one line, with numbers in their shortest exact spelling. It can be read back in an
/// array context.
pub fn plain<T: Real>(value: &Value<T>) -> String {
    spelled(value, ", ")
}

/// As [`plain`], with each row of a grid on a line of its own.
pub fn by_rows<T: Real>(value: &Value<T>) -> String {
    spelled(value, ",\n ")
}

/// The value, `between` the rows of a grid.
fn spelled<T: Real>(value: &Value<T>, between: &str) -> String {
    let number = |x: T| number::plain(if x.re() == 0.0 { 0.0 } else { x.re() });
    let vector =
        |v: moldloft_num::Vec3<T>| format!("{{{}, {}, {}}}", number(v.x), number(v.y), number(v.z));
    let list = |items: Vec<String>| format!("{{{}}}", items.join(", "));
    let shaped = |shape: ArrayShape, items: Vec<String>| match shape {
        ArrayShape::Row(_) => list(items),
        ArrayShape::Grid(_, n) => {
            let rows: Vec<String> = items.chunks(n.max(1)).map(|row| list(row.to_vec())).collect();
            format!("{{{}}}", rows.join(between))
        }
    };
    match value {
        Value::Unset => "nothing".into(),
        Value::Number(x) => number(*x),
        Value::Text(text) => text.to_string(),
        Value::Vector(v) => vector(*v),
        Value::Point(p) => vector(p.xyz),
        Value::Numbers(a) => shaped(a.shape, a.items.iter().map(|&x| number(x)).collect()),
        Value::Vectors(a) => shaped(a.shape, a.iter().map(vector).collect()),
        Value::List(items) | Value::Block(items) => {
            list(items.iter().map(|item| spelled(item, between)).collect())
        }
        Value::Record(record) => {
            let member = |(name, value)| format!("{name} = {}", spelled(value, between));
            let members: Vec<String> =
                record.names.iter().zip(&record.values).map(member).collect();
            format!("{}({})", record.of, members.join(", "))
        }
        Value::Plane(p) => {
            format!("plane through {} with normal {}", vector(p.point), vector(p.normal))
        }
        other => crate::value::implicit::described(other)
            .unwrap_or_else(|| other.class().with_article().to_string()),
    }
}
