//! Blocks: grids of three dimensions, as their layers k, each a surface, or numbers of its shape.

use crate::value::subarray::{ArraySection, Selection};
use crate::value::variables::{self, Called as _};
use moldloft_diag::Diagnostic;
use moldloft_num::Real;
use moldloft_registry::{Array, ArrayShape, Value, Vectors};
use std::sync::Arc;

/// The extents of a block; `None` for other values.
pub(crate) fn size<T: Real>(value: &Value<T>) -> Option<[usize; 3]> {
    let Value::Block(layers) = value else { return None };
    let shape = match layers.first()? {
        Value::Vectors(a) => a.shape,
        Value::Numbers(a) => a.shape,
        _ => return None,
    };
    let ArrayShape::Grid(m, n) = shape else { return None };
    Some([m, n, layers.len()])
}

/// The block that a list of surfaces of one shape spells in a block context; any other value
/// unchanged.
pub(crate) fn spelled_by<T: Real>(value: Value<T>) -> Value<T> {
    let Value::List(layers) = &value else { return value };
    let gathered = layers.iter().map(|layer| moldloft_arrays::gathered(layer).into_owned());
    Value::block(gathered).unwrap_or(value)
}

/// A block of points at the origin.
pub(crate) fn zeros<T: Real>([ni, nj, nk]: [usize; 3]) -> Value<T> {
    let layer = || {
        Value::Vectors(Arc::new(Vectors::filled(
            ArrayShape::Grid(ni, nj),
            moldloft_num::Vec3::zero(),
        )))
    };
    Value::Block((0..nk).map(|_| layer()).collect())
}

/// A function applied to each layer; `None` for other values.
pub(crate) fn by_layer<T: Real, E>(
    value: &Value<T>,
    f: impl FnMut(&Value<T>) -> Result<Value<T>, E>,
) -> Option<Result<Value<T>, E>> {
    let Value::Block(layers) = value else { return None };
    let layers: Result<Arc<[Value<T>]>, E> = layers.iter().map(f).collect();
    Some(layers.map(Value::Block))
}

/// An operator applied to two blocks, or a block and a single value, layer by layer; `None` without
/// a block.
pub(crate) fn by_layers<T: Real, E>(
    a: &Value<T>,
    b: &Value<T>,
    mut f: impl FnMut(&Value<T>, &Value<T>) -> Result<Value<T>, E>,
    differ: impl FnOnce(String) -> E,
) -> Option<Result<Value<T>, E>> {
    let single = |v: &Value<T>| matches!(v, Value::Number(_) | Value::Vector(_) | Value::Point(_));
    match (size(a), size(b)) {
        (Some(m), Some(n)) if m == n => {
            let (Value::Block(a), Value::Block(b)) = (a, b) else { return None };
            let layers: Result<Arc<[_]>, E> =
                a.iter().zip(b.iter()).map(|(a, b)| f(a, b)).collect();
            Some(layers.map(Value::Block))
        }
        (Some(m), Some(n)) => Some(Err(differ(format!("{} and {}", spelled(m), spelled(n))))),
        (Some(_), None) if single(b) => by_layer(a, |a| f(a, b)),
        (None, Some(_)) if single(a) => by_layer(b, |b| f(a, b)),
        _ => None,
    }
}

/// All numbers, or all points, of a block as one row.
pub(crate) fn flat<T: Real>(value: &Value<T>) -> Option<Value<T>> {
    let Value::Block(layers) = value else { return None };
    let (mut numbers, mut points) = (Vec::new(), Vec::new());
    for layer in layers.iter() {
        match layer {
            Value::Numbers(a) => numbers.extend_from_slice(&a.items),
            Value::Vectors(a) => points.extend(a.iter()),
            _ => return None,
        }
    }
    Some(match points.is_empty() {
        true => Value::Numbers(Arc::new(Array::row(numbers))),
        false => Value::Vectors(Arc::new(Vectors::row(points))),
    })
}

/// Extents as the language writes them.
pub(crate) fn spelled(size: [usize; 3]) -> String {
    let [ni, nj, nk] = size;
    format!("[{ni},{nj},{nk}]")
}

/// The selected part of a block: a block, surface, curve or vector (or the same of numbers).
pub(crate) fn part<T: Real>(
    layers: &[Value<T>],
    [a, b, c]: [Selection; 3],
) -> Result<Value<T>, Diagnostic> {
    let inner = ArraySection::Grid(a, b);
    if !c.keeps {
        return variables::part(&layers[c.start], inner);
    }
    let mut parts = Vec::with_capacity(c.count);
    for k in c.positions() {
        parts.push(variables::part(&layers[k], inner)?);
    }
    if a.keeps && b.keeps {
        return Ok(Value::Block(parts.into()));
    }
    Ok(match &parts[0] {
        Value::Number(_) => Value::Numbers(Arc::new(Array::row(
            parts
                .iter()
                .filter_map(|p| if let Value::Number(x) = p { Some(*x) } else { None })
                .collect(),
        ))),
        Value::Vector(_) => Value::Vectors(Arc::new(Vectors::row(
            parts
                .iter()
                .filter_map(|p| if let Value::Vector(v) = p { Some(*v) } else { None })
                .collect(),
        ))),
        // Lines of the layers, side by side: the first index along them, the second that of the layers.
        Value::Numbers(first) => {
            let shape = ArrayShape::Grid(first.items.len(), parts.len());
            let lines: Vec<&[T]> = parts
                .iter()
                .filter_map(|p| if let Value::Numbers(a) = p { Some(&a.items[..]) } else { None })
                .collect();
            Value::Numbers(Arc::new(Array { shape, items: across(&lines) }))
        }
        Value::Vectors(first) => {
            let shape = ArrayShape::Grid(first.len(), parts.len());
            let planes = [0, 1, 2].map(|axis| {
                let lines: Vec<&[T]> = parts
                    .iter()
                    .filter_map(|p| match p {
                        Value::Vectors(a) => Some(&a.planes[axis][..]),
                        _ => None,
                    })
                    .collect();
                across(&lines)
            });
            Value::Vectors(Arc::new(Vectors { shape, planes }))
        }
        other => return Err(no_part(other)),
    })
}

/// Rows as the columns of a grid.
fn across<T: Copy>(lines: &[&[T]]) -> Vec<T> {
    let length = lines.first().map_or(0, |line| line.len());
    (0..length).flat_map(|i| lines.iter().map(move |line| line[i])).collect()
}

fn no_part<T: Real>(value: &Value<T>) -> Diagnostic {
    Diagnostic::error("not-indexable", format!("{} has no such part", value.called()))
}

/// Writes a value into the selected points of a block, or one component of them.
pub(crate) fn fill<T: Real>(
    layers: &mut Arc<[Value<T>]>,
    size: [usize; 3],
    section: Option<ArraySection>,
    component: Option<usize>,
    value: &Value<T>,
) -> Result<(), Diagnostic> {
    let section = section.unwrap_or(ArraySection::whole_block(size));
    let ArraySection::Block(a, b, c) = section else {
        return Err(Diagnostic::error("wrong-subscripts", "wrong number of subscripts")
            .expected("three subscripts, as in b[2,3,4]"));
    };
    let single = matches!(value, Value::Number(_) | Value::Vector(_) | Value::Point(_));
    let (extents, count) = section.extents();
    if !single {
        let found = variables::extents(value).unwrap_or_default();
        if found != extents[..count] {
            let bracketed = |n: &[usize]| {
                let all: Vec<String> = n.iter().map(usize::to_string).collect();
                format!("[{}]", all.join(","))
            };
            let (to, from) = (bracketed(&extents[..count]), bracketed(&found));
            if found.is_empty() {
                return Err(Diagnostic::error(
                    "wrong-type",
                    format!("expected points {to}, found {}", value.called()),
                )
                .expected(format!("points {to}, or a single one"))
                .found(value.called()));
            }
            return Err(Diagnostic::error(
                "shapes-differ",
                format!("shapes differ: {to} = {from}"),
            )
            .expected(format!("a value of shape {to}, or a single one"))
            .found(from));
        }
    }
    let of_layer = |n: usize| -> Result<Value<T>, Diagnostic> {
        if single || !c.keeps {
            return Ok(value.clone());
        }
        match value {
            Value::Block(items) => Ok(items[n].clone()),
            grid if count == 2 => {
                let line = Selection::whole(extents[0]);
                variables::part(grid, ArraySection::Grid(line, Selection::at(n)))
            }
            row => variables::part(row, ArraySection::Row(Selection::at(n))),
        }
    };
    let write = |layers: &mut [Value<T>]| -> Result<(), Diagnostic> {
        for (n, k) in c.positions().enumerate() {
            let value = of_layer(n)?;
            variables::fill(&mut layers[k], Some(ArraySection::Grid(a, b)), component, value)?;
        }
        Ok(())
    };
    match Arc::get_mut(layers) {
        Some(layers) => write(layers),
        None => {
            let mut copy = layers.to_vec();
            write(&mut copy)?;
            *layers = copy.into();
            Ok(())
        }
    }
}
