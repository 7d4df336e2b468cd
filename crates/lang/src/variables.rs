//! Variables: types, sections, and assignment.

use crate::module::Name;
use moldloft_diag::Diagnostic;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Array, ArrayShape, Class, Value, Vectors};
use moldloft_syntax::sdl::Type;
use std::sync::Arc;

/// The most elements of an array.
const MOST_ELEMENTS: f64 = 1e7;

/// A part of a variable that is assigned to, or passed by reference.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    pub name: Name,
    /// The subscripts, when there are some.
    pub section: Option<Vec<Selection>>,
    /// The component x, y, z as 0, 1, 2.
    pub component: Option<usize>,
}

/// What a subscript selects from a dimension: positions from 0, and whether the dimension stays.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Selection {
    pub positions: Vec<usize>,
    pub keeps_dimension: bool,
}

/// What is known of the variable that a value is stored into.
pub(crate) struct Taken<'a> {
    pub ty: Type,
    pub fixed: bool,
    pub name: &'a str,
}

/// The type that holds a value as it is.
pub(crate) fn type_of<T: Real>(value: &Value<T>) -> Type {
    match value {
        Value::Text(_) => Type::String,
        Value::Vector(_) | Value::Point(_) => Type::Vector,
        Value::Numbers(_) => Type::Farray,
        Value::Vectors(a) if matches!(a.shape, ArrayShape::Grid(..)) => Type::Surface,
        Value::Vectors(_) => Type::Curve,
        Value::Curve(_) => Type::Pcurve,
        Value::Surface(_) => Type::Psurface,
        Value::Field(_) => Type::Field,
        Value::Set(_) => Type::Set,
        _ => Type::Float,
    }
}

/// The word of a type and what it holds.
fn described(ty: Type) -> &'static str {
    match ty {
        Type::Int => "a whole number",
        Type::Float => "a number",
        Type::String => "a text",
        Type::File => "a file",
        Type::Vector => "a vector",
        Type::Farray => "an farray (a row of numbers)",
        Type::Curve => "a curve (a row of vectors)",
        Type::Surface => "a surface (a grid of vectors)",
        Type::Pcurve => "a parametric curve",
        Type::Psurface => "a parametric surface",
        Type::Field => "a field",
        Type::Set => "a set",
        Type::Other(_) => "an object",
    }
}

/// The value as a variable of type `ty` holds it.
///
/// # Errors
/// When the type holds no such value.
pub(crate) fn converted<T: Real>(ty: Type, value: Value<T>) -> Result<Value<T>, Diagnostic> {
    let wrong = |value: &Value<T>| {
        let found = value.class().a();
        Diagnostic::error("wrong-type", format!("expected {}, found {found}", described(ty)))
            .expected(described(ty))
            .found(found)
    };
    Ok(match (ty, value) {
        (Type::Other(_), value) => value,
        (Type::Int, Value::Number(x)) if x.re().fract() != 0.0 => {
            return Err(Diagnostic::error("not-whole", "an int holds whole numbers")
                .expected("a whole number")
                .found(x.re().to_string())
                .help("declare it as float, or use round(), floor() or ceil()"));
        }
        (Type::Int | Type::Float, value @ Value::Number(_))
        | (Type::String, value @ Value::Text(_))
        | (Type::Vector, value @ Value::Vector(_))
        | (Type::Farray, value @ Value::Numbers(_))
        | (Type::Pcurve, value @ Value::Curve(_))
        | (Type::Psurface, value @ Value::Surface(_))
        | (Type::Field, value @ Value::Field(_))
        | (Type::Set, value @ Value::Set(_)) => value,
        // A plane stands for its half-space, a number for a constant, a field for its solid side.
        (Type::Field, value @ (Value::Plane(_) | Value::Number(_))) => {
            match moldloft_field::primitive_of(&value) {
                Some(f) => moldloft_field::field_value(f),
                None => return Err(wrong(&value)),
            }
        }
        (Type::Set, value @ (Value::Field(_) | Value::Plane(_))) => {
            match moldloft_field::set_of(&value) {
                Some(s) => moldloft_field::set_value(s),
                None => return Err(wrong(&value)),
            }
        }
        (Type::Vector, Value::Point(p)) => Value::Vector(p.xyz),
        (Type::Farray, Value::Vector(v)) => {
            Value::Numbers(Arc::new(Array::row(v.to_array().to_vec())))
        }
        (Type::Farray, Value::List(items)) => {
            let numbers: Option<Vec<T>> = items
                .iter()
                .map(|item| match item {
                    Value::Number(x) => Some(*x),
                    _ => None,
                })
                .collect();
            let Some(numbers) = numbers else { return Err(wrong(&Value::List(items))) };
            Value::Numbers(Arc::new(Array::row(numbers)))
        }
        (Type::Curve, Value::List(items)) => {
            let vectors: Option<Vec<Vec3<T>>> = items
                .iter()
                .map(|item| match item {
                    Value::Vector(v) => Some(*v),
                    Value::Point(p) => Some(p.xyz),
                    _ => None,
                })
                .collect();
            let Some(vectors) = vectors else { return Err(wrong(&Value::List(items))) };
            Value::Vectors(Arc::new(Vectors::row(vectors)))
        }
        (Type::Curve, Value::Vectors(a)) if matches!(a.shape, ArrayShape::Row(_)) => {
            Value::Vectors(a)
        }
        (Type::Surface, Value::Vectors(a)) if matches!(a.shape, ArrayShape::Grid(..)) => {
            Value::Vectors(a)
        }
        (_, value) => return Err(wrong(&value)),
    })
}

/// A declared dimension.
///
/// # Errors
/// When it is not a whole number in range.
pub(crate) fn extent(n: f64) -> Result<usize, Diagnostic> {
    if n.fract() == 0.0 && (1.0..=MOST_ELEMENTS).contains(&n) {
        return Ok(n as usize);
    }
    Err(Diagnostic::error("wrong-dimension", "a dimension is a positive whole number")
        .expected(format!("a whole number from 1 to {MOST_ELEMENTS}"))
        .found(n.to_string()))
}

/// More elements than there may be.
pub(crate) fn too_many(found: f64, most: f64) -> Diagnostic {
    Diagnostic::error("too-many-elements", "the array is too large")
        .expected(format!("at most {most} elements"))
        .found(format!("{found}"))
}

/// The first value of a variable with declared dimensions `dims`.
///
/// # Errors
/// When dimensions, type and value do not go together.
pub(crate) fn initial<T: Real>(
    ty: Type,
    dims: &[usize],
    value: Option<Value<T>>,
) -> Result<Value<T>, Diagnostic> {
    let count = dims.iter().map(|&n| n as f64).product::<f64>();
    if count > MOST_ELEMENTS {
        return Err(too_many(count, MOST_ELEMENTS));
    }
    let empty = match (ty, dims) {
        (Type::Farray, [n]) => Value::Numbers(Arc::new(Array::row(vec![T::zero(); *n]))),
        (Type::Farray, [m, n]) => {
            Value::Numbers(Arc::new(Array::grid(*m, *n, vec![T::zero(); m * n])))
        }
        (Type::Curve, [n]) => {
            Value::Vectors(Arc::new(Vectors::filled(ArrayShape::Row(*n), Vec3::zero())))
        }
        (Type::Surface, [m, n]) => {
            Value::Vectors(Arc::new(Vectors::filled(ArrayShape::Grid(*m, *n), Vec3::zero())))
        }
        (_, []) => {
            return Ok(value.unwrap_or_else(|| match ty {
                Type::Int | Type::Float => Value::Number(T::zero()),
                Type::Vector => Value::Vector(Vec3::zero()),
                Type::String => Value::text(""),
                _ => Value::Unset,
            }));
        }
        _ => {
            return Err(Diagnostic::error(
                "wrong-dimension",
                format!("{} does not have {} dimensions", described(ty), dims.len()),
            )
            .expected("farray a[n], curve c[n] or surface s[m,n]"));
        }
    };
    let Some(value) = value else { return Ok(empty) };
    let mut filled = empty;
    fill(&mut filled, None, None, value)?;
    Ok(filled)
}

/// Stores a value into a variable or a part of it.
///
/// # Errors
/// When type or shape differ.
pub(crate) fn store<T: Real>(
    taken: Taken<'_>,
    old: &mut Value<T>,
    place: &Place,
    value: Value<T>,
) -> Result<(), Diagnostic> {
    let whole = place.section.is_none() && place.component.is_none();
    let array = matches!(taken.ty, Type::Farray | Type::Curve | Type::Surface);
    if whole && !(array && (taken.fixed || !is_array(&value))) {
        *old = converted(taken.ty, value)?;
        return Ok(());
    }
    if matches!(old, Value::Unset) {
        return Err(Diagnostic::error(
            "no-shape",
            format!("`{}` has no dimensions yet", taken.name),
        )
        .help("declare them, or assign a whole array first"));
    }
    fill(old, place.section.as_deref(), place.component, value)
}

fn is_array<T: Real>(value: &Value<T>) -> bool {
    matches!(value, Value::Numbers(_) | Value::Vectors(_) | Value::List(_))
}

/// The flat positions of a section and its shape; `None` for a single element.
pub(crate) fn positions(
    shape: ArrayShape,
    section: Option<&[Selection]>,
) -> Result<(Vec<usize>, Option<ArrayShape>), Diagnostic> {
    let (m, n) = match shape {
        ArrayShape::Row(n) => (None, n),
        ArrayShape::Grid(m, n) => (Some(m), n),
    };
    match (m, section) {
        (None, None) => Ok(((0..n).collect(), Some(shape))),
        (Some(m), None) => Ok(((0..m * n).collect(), Some(shape))),
        (None, Some([a])) => {
            let kept = a.keeps_dimension.then_some(ArrayShape::Row(a.positions.len()));
            Ok((a.positions.clone(), kept))
        }
        (Some(_), Some([a, b])) => {
            let flat = a
                .positions
                .iter()
                .flat_map(|i| b.positions.iter().map(move |j| i * n + j))
                .collect();
            let (ka, kb) = (a.positions.len(), b.positions.len());
            let kept = match (a.keeps_dimension, b.keeps_dimension) {
                (true, true) => Some(ArrayShape::Grid(ka, kb)),
                (true, false) => Some(ArrayShape::Row(ka)),
                (false, true) => Some(ArrayShape::Row(kb)),
                (false, false) => None,
            };
            Ok((flat, kept))
        }
        (_, Some(section)) => {
            Err(Diagnostic::error("wrong-subscripts", "wrong number of subscripts")
                .expected(match shape {
                    ArrayShape::Row(_) => "one subscript, as in c[3]",
                    ArrayShape::Grid(..) => "two subscripts, as in s[3,4]",
                })
                .found(format!("{} subscripts", section.len())))
        }
    }
}

/// Writes `value` into the selected elements (or one component of them): the whole right side is
/// known before anything is stored.
fn fill<T: Real>(
    old: &mut Value<T>,
    section: Option<&[Selection]>,
    component: Option<usize>,
    value: Value<T>,
) -> Result<(), Diagnostic> {
    let differ = |to: Option<ArrayShape>, from: ArrayShape| {
        let to = to.map_or("a single element".to_string(), |s| s.to_string());
        Diagnostic::error("shapes-differ", format!("shapes differ: {to} = {from}"))
            .expected(format!("a value of shape {to}, or a single one"))
            .found(from.to_string())
    };
    let wrong = |expected: &str, value: &Value<T>| {
        let found = value.class().a();
        Diagnostic::error("wrong-type", format!("expected {expected}, found {found}"))
            .expected(expected.to_string())
            .found(found)
    };
    let value = match value {
        Value::Point(p) => Value::Vector(p.xyz),
        Value::List(_) | Value::Vector(_) if matches!(old, Value::Numbers(_)) => {
            converted(Type::Farray, value)?
        }
        Value::List(_) | Value::Vector(_) if component.is_some() => converted(Type::Farray, value)?,
        Value::List(_) => converted(Type::Curve, value)?,
        other => other,
    };
    match (&mut *old, component) {
        (Value::Numbers(array), None) => {
            let (at, shape) = positions(array.shape, section)?;
            let items = &mut Arc::make_mut(array).items;
            match &value {
                Value::Number(x) => at.iter().for_each(|&k| items[k] = *x),
                Value::Numbers(from) if Some(from.shape) == shape => {
                    at.iter().zip(&from.items).for_each(|(&k, x)| items[k] = *x);
                }
                Value::Numbers(from) => return Err(differ(shape, from.shape)),
                other => return Err(wrong("a number or an farray", other)),
            }
        }
        (Value::Vectors(array), None) => {
            let (at, shape) = positions(array.shape, section)?;
            let planes = &mut Arc::make_mut(array).planes;
            match &value {
                Value::Vector(v) => {
                    for (plane, x) in planes.iter_mut().zip(v.to_array()) {
                        at.iter().for_each(|&k| plane[k] = x);
                    }
                }
                Value::Vectors(from) if Some(from.shape) == shape => {
                    for (plane, from) in planes.iter_mut().zip(&from.planes) {
                        at.iter().zip(from).for_each(|(&k, x)| plane[k] = *x);
                    }
                }
                Value::Vectors(from) => return Err(differ(shape, from.shape)),
                other => return Err(wrong("a vector, or a row or grid of them", other)),
            }
        }
        (Value::Vectors(array), Some(c)) => {
            let (at, shape) = positions(array.shape, section)?;
            let plane = &mut Arc::make_mut(array).planes[c];
            let mut put = |k: usize, x: T| plane[k] = x;
            match &value {
                Value::Number(x) => at.iter().for_each(|&k| put(k, *x)),
                Value::Numbers(from) if Some(from.shape) == shape => {
                    at.iter().zip(&from.items).for_each(|(&k, x)| put(k, *x));
                }
                Value::Numbers(from) => return Err(differ(shape, from.shape)),
                other => return Err(wrong("a number or an farray", other)),
            }
        }
        (Value::Vector(v), Some(c)) if section.is_none() => match value {
            Value::Number(x) => *component_mut(v, c) = x,
            other => return Err(wrong("a number", &other)),
        },
        (other, _) => {
            let class: Class = other.class();
            return Err(Diagnostic::error(
                "not-indexable",
                format!("{} has no such part", class.a()),
            ));
        }
    }
    Ok(())
}

fn component_mut<T>(v: &mut Vec3<T>, component: usize) -> &mut T {
    match component {
        0 => &mut v.x,
        1 => &mut v.y,
        _ => &mut v.z,
    }
}

/// The selected part of an array.
///
/// # Errors
/// When subscripts and dimensions do not go together.
pub(crate) fn part<T: Real>(
    value: &Value<T>,
    section: &[Selection],
) -> Result<Value<T>, Diagnostic> {
    fn pick<E: Copy>(items: &[E], at: &[usize]) -> Vec<E> {
        at.iter().map(|&k| items[k]).collect()
    }
    Ok(match value {
        Value::Numbers(array) => match positions(array.shape, Some(section))? {
            (at, None) => Value::Number(array.items[at[0]]),
            (at, Some(shape)) => {
                Value::Numbers(Arc::new(Array { shape, items: pick(&array.items, &at) }))
            }
        },
        Value::Vectors(array) => match positions(array.shape, Some(section))? {
            (at, None) => Value::Vector(array.at(at[0])),
            (at, Some(shape)) => {
                let planes = array.planes.each_ref().map(|plane| pick(plane, &at));
                Value::Vectors(Arc::new(Vectors { shape, planes }))
            }
        },
        Value::List(items) => match section {
            [one] if !one.keeps_dimension => items[one.positions[0]].clone(),
            [some] => Value::list(some.positions.iter().map(|&k| items[k].clone())),
            _ => {
                return Err(Diagnostic::error("wrong-subscripts", "a list has one subscript"));
            }
        },
        other => {
            return Err(Diagnostic::error(
                "not-indexable",
                format!("{} has no elements to index", other.class().a()),
            )
            .expected("a row, grid or list")
            .found(other.class().a()));
        }
    })
}

/// The extents of what can be indexed.
pub(crate) fn extents<T: Real>(value: &Value<T>) -> Option<Vec<usize>> {
    let of = |shape: ArrayShape| match shape {
        ArrayShape::Row(n) => vec![n],
        ArrayShape::Grid(m, n) => vec![m, n],
    };
    match value {
        Value::Numbers(a) => Some(of(a.shape)),
        Value::Vectors(a) => Some(of(a.shape)),
        Value::List(items) => Some(vec![items.len()]),
        _ => None,
    }
}
