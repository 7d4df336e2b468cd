//! Numbers in the arguments of objects by name: `P21.y`, `knots.values[3]`.

use moldloft_num::Vec3;
use moldloft_registry::{Row, Scalar, Value};

/// A number in the arguments of an object: `P21.y`, `knots.values[3]`, `l.p1.x`.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberPath {
    /// The argument, by its index in the row.
    pub field: usize,
    /// The item of a list, from 0.
    pub item: Option<usize>,
    /// The component of a vector, from 0.
    pub component: Option<usize>,
}

impl NumberPath {
    /// Parses the part after the object's name: `.field`, `.field[item]`, `.field.x`.
    pub fn parse(row: &Row, text: &str) -> Option<Self> {
        let text = text.strip_prefix('.')?;
        let end = text.find(['.', '[']).unwrap_or(text.len());
        let field = row.field(&text[..end])?;
        let mut rest = &text[end..];
        let mut item = None;
        if let Some(after) = rest.strip_prefix('[') {
            let (index, after) = after.split_once(']')?;
            item = Some(index.trim().parse::<usize>().ok()?.checked_sub(1)?);
            rest = after;
        }
        let component = match rest {
            "" => None,
            ".x" => Some(0),
            ".y" => Some(1),
            ".z" => Some(2),
            _ => return None,
        };
        Some(Self { field, item, component })
    }

    /// Changes the number in the arguments; `None` when there is no number at the path.
    pub fn change<T: Scalar>(&self, args: &mut [Value<T>], f: impl FnOnce(T) -> T) -> Option<()> {
        fn at<T: Scalar>(
            value: &mut Value<T>,
            item: Option<usize>,
            component: Option<usize>,
            f: impl FnOnce(T) -> T,
        ) -> Option<()> {
            match (value, item, component) {
                (Value::List(items), Some(k), _) => {
                    let mut list = items.to_vec();
                    at(list.get_mut(k)?, None, component, f)?;
                    *items = list.into();
                }
                (Value::Number(x), None, None) => *x = f(*x),
                // {a, b, c} of numbers may be a list or a vector.
                (Value::Vector(v), k, c) if k.is_some() != c.is_some() => {
                    let mut xyz = v.to_array();
                    let x = xyz.get_mut(k.or(c)?)?;
                    *x = f(*x);
                    *v = Vec3::from(xyz);
                }
                _ => return None,
            }
            Some(())
        }
        at(args.get_mut(self.field)?, self.item, self.component, f)
    }
}

/// Seeds the literals of an object for differentiation.
pub fn seed<T: Scalar>(
    row: &Row,
    args: &mut [Value<T>],
    object: &str,
    seed: crate::source::env::Seed<'_, T>,
) {
    // The few paths an object can have are tried: the seeding function knows the names.
    const AXES: [&str; 3] = ["x", "y", "z"];
    for (at, field) in row.fields.iter().enumerate() {
        let name = field.name;
        let count = if field.many { length(&args[at]) } else { 0 };
        let mut try_path = |item: Option<usize>, component: Option<usize>| {
            let path = NumberPath { field: at, item, component };
            let _ = path.change(args, |x| {
                let item = item.map(|k| format!("[{}]", k + 1)).unwrap_or_default();
                let name = match component {
                    Some(c) => format!("{object}.{name}{item}.{}", AXES[c]),
                    None => format!("{object}.{name}{item}"),
                };
                seed(&name, x)
            });
        };
        let components = || std::iter::once(None).chain((0..3).map(Some));
        components().for_each(|component| try_path(None, component));
        for k in 0..count {
            components().for_each(|component| try_path(Some(k), component));
        }
    }
}

fn length<T: Scalar>(value: &Value<T>) -> usize {
    match value {
        Value::List(items) => items.len(),
        Value::Vector(_) => 3,
        _ => 0,
    }
}
