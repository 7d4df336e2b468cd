//! Values as a person reads them.

use moldloft_num::Real;
use moldloft_registry::Value;
use moldloft_syntax::number;

/// The value on one line, numbers in their shortest exact spelling.
pub fn plain<T: Real>(value: &Value<T>) -> String {
    let number = |x: T| number::plain(if x.re() == 0.0 { 0.0 } else { x.re() });
    let vector =
        |v: moldloft_num::Vec3<T>| format!("{{{}, {}, {}}}", number(v.x), number(v.y), number(v.z));
    let list = |items: Vec<String>| format!("{{{}}}", items.join(", "));
    match value {
        Value::Unset => "nothing".into(),
        Value::Number(x) => number(*x),
        Value::Text(text) => text.to_string(),
        Value::Vector(v) => vector(*v),
        Value::Point(p) => vector(p.xyz),
        Value::Numbers(a) => list(a.items.iter().map(|&x| number(x)).collect()),
        Value::Vectors(a) => list(a.iter().map(vector).collect()),
        Value::List(items) => list(items.iter().map(plain).collect()),
        Value::Plane(p) => {
            format!("plane through {} with normal {}", vector(p.point), vector(p.normal))
        }
        other => crate::functions::sets::described(other)
            .unwrap_or_else(|| other.class().with_article().to_string()),
    }
}
