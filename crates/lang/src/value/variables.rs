//! Variables: types, sections, and assignment.

use crate::value::blocks;
use crate::value::subarray::{ArraySection, PathStep, Place, ValuePath, picked, put, put_all};
use moldloft_arrays::{MORE_MEMORY, within_share};
use moldloft_budget::Budget;
use moldloft_diag::Diagnostic;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Array, ArrayShape, Class, Value, Vectors};
use moldloft_syntax::sdl::{ItemType, Type};
use std::sync::Arc;

/// Bound on integers: from here on, not all integers are representable.
pub const MOST_INT: f64 = 9_007_199_254_740_992.0;

/// Adding it and taking it away rounds numbers below `MOST_ROUNDED` to whole ones.
pub const ROUNDS: f64 = 6_755_399_441_055_744.0;
const MOST_ROUNDED: f64 = 2_251_799_813_685_248.0;

/// True when an int does not hold it.
#[inline(always)]
pub fn is_no_int(x: f64) -> bool {
    let small = x.abs() < MOST_ROUNDED && (x + ROUNDS) - ROUNDS == x;
    // The general test takes several times as long.
    !small && (x.fract() != 0.0 || x.abs() >= MOST_INT)
}

/// The variable that a value is stored into.
pub struct Taken<'a> {
    /// The declared type.
    pub ty: Type,
    /// True when the dimensions were declared.
    pub fixed: bool,
    /// The name, for messages.
    pub name: &'a str,
}

/// The type of variable that holds a value unchanged.
pub fn type_of<T: Real>(value: &Value<T>) -> Type {
    match value {
        Value::Text(_) => Type::String,
        Value::Vector(_) | Value::Point(_) => Type::Vector,
        Value::Block(_) => Type::Block,
        Value::Record(_) => Type::Record,
        Value::List(items) => {
            let mut kinds = items.iter().map(type_of);
            let first = kinds.next().filter(|first| kinds.all(|ty| ty == *first));
            match first.and_then(Type::list) {
                Some(Type::List(ItemType::String)) => Type::String,
                Some(list) => list,
                None => Type::Float,
            }
        }
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

pub use moldloft_arrays::type_name as a;

/// [`a`] as a method.
pub trait Called {
    /// The name of the value's type, with its article.
    fn called(&self) -> &'static str;
}

impl<T: Real> Called for Value<T> {
    fn called(&self) -> &'static str {
        a(self)
    }
}

/// Name of a type and description of its content.
pub fn described(ty: Type) -> &'static str {
    match ty {
        Type::Int => "a whole number",
        Type::Float => "a number",
        Type::String => "a text",
        Type::File => "a file",
        Type::Vector => "a vector",
        Type::Farray => "an farray (a row of numbers)",
        Type::Curve => "a curve (a row of points)",
        Type::Surface => "a surface (a grid of vectors)",
        Type::Pcurve => "a parametric curve",
        Type::Psurface => "a parametric surface",
        Type::Field => "a field",
        Type::Set => "a set",
        Type::Block => "a block (layers of surfaces)",
        Type::Routine => "the name of a function or subroutine",
        Type::Other(_) => "an object",
        Type::Record => "a record",
        Type::List(item) => match item {
            ItemType::Curve => "a list of curves",
            ItemType::Surface => "a list of surfaces",
            ItemType::Block => "a list of blocks",
            ItemType::Farray => "a list of farrays",
            ItemType::Pcurve => "a list of parametric curves",
            ItemType::Psurface => "a list of parametric surfaces",
            ItemType::Field => "a list of fields",
            ItemType::Set => "a list of sets",
            ItemType::String => "a list of texts",
            ItemType::Other(_) => "a list of objects",
            ItemType::Record => "a list of records",
        },
    }
}

/// The value converted to a variable of type `ty`.
///
/// # Errors
/// When the type holds no such value.
pub fn converted<T: Real>(ty: Type, value: Value<T>) -> Result<Value<T>, Diagnostic> {
    let wrong = |value: &Value<T>| {
        let found = a(value);
        let help = match (ty, value) {
            (Type::Curve, Value::Curve(_)) => Some("take points of it: distc(c, uniform(0, 1, n))"),
            (Type::Surface, Value::Surface(_)) => Some("take points of it: dists(s, u, v)"),
            (Type::Pcurve, Value::Vectors(_)) => {
                Some("put a spline through the points: makecc(c, \"quadratic\", \"arc\")")
            }
            (Type::Psurface, Value::Vectors(_)) => {
                Some("put a spline through the points: makecs(s, \"quadratic\", \"arc\")")
            }
            (Type::Block, Value::List(_)) => {
                Some("the layers of a block are surfaces of one shape")
            }
            (Type::List(_), Value::Block(_)) => Some("`foreach (s in b)` walks its layers"),
            (Type::List(_), _) => Some("a list is written in braces: {a, b}"),
            _ => None,
        };
        Diagnostic::error("wrong-type", format!("expected {}, found {found}", described(ty)))
            .expected(described(ty))
            .found(found)
            .maybe_help(help)
    };
    Ok(match (ty, value) {
        (Type::Other(_), value) => value,
        (Type::Int, Value::Number(x)) if x.re().fract() != 0.0 => {
            return Err(Diagnostic::error("not-whole", "an int holds whole numbers")
                .expected("a whole number")
                .found(x.re().to_string())
                .help("declare it as float, or use round(), floor() or ceil()"));
        }
        (Type::Int, Value::Number(x)) if x.re().abs() >= MOST_INT => {
            return Err(Diagnostic::error("int-overflow", "an int holds whole numbers below 2^53")
                .expected("a whole number between -9007199254740991 and 9007199254740991")
                .found(moldloft_syntax::number::plain(x.re()))
                .help("beyond them not every integer can be represented; a float is rounded"));
        }
        (Type::Block, value @ Value::Block(_)) | (Type::Record, value @ Value::Record(_)) => value,
        (Type::Block, value @ Value::List(_)) => match blocks::spelled_by(value) {
            block @ Value::Block(_) => block,
            other => return Err(wrong(&other)),
        },
        (Type::List(item), Value::List(items)) => {
            let each = |(k, value): (usize, &Value<T>)| match value {
                Value::Unset => Ok(Value::Unset),
                value => converted(item.ty(), value.clone()).map_err(|mut d| {
                    d.message = format!("item {}: {}", k + 1, d.message);
                    d
                }),
            };
            Value::List(items.iter().enumerate().map(each).collect::<Result<_, _>>()?)
        }
        (Type::String, Value::List(items))
            if !items.is_empty() && items.iter().all(|v| matches!(v, Value::Text(_))) =>
        {
            Value::List(items)
        }
        (Type::Int | Type::Float | Type::File, value @ Value::Number(_))
        | (Type::String, value @ Value::Text(_))
        | (Type::Vector, value @ Value::Vector(_))
        | (Type::Farray, value @ Value::Numbers(_))
        | (Type::Pcurve, value @ Value::Curve(_))
        | (Type::Psurface, value @ Value::Surface(_))
        | (Type::Field, value @ Value::Field(_))
        | (Type::Set, value @ Value::Set(_)) => value,
        // A plane is converted to its half-space, a number to a constant, a field to its solid
        // side.
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
        (Type::Farray, Value::List(items)) => match rows_of_numbers(&items) {
            Some(array) => Value::Numbers(Arc::new(array)),
            None => return Err(wrong(&Value::List(items))),
        },
        (Type::Curve, Value::List(items)) if items.is_empty() => {
            Value::Vectors(Arc::new(Vectors::row(Vec::new())))
        }
        (Type::Curve | Type::Surface, value @ Value::List(_)) => {
            match &*moldloft_arrays::gathered(&value) {
                Value::Vectors(a)
                    if matches!(a.shape, ArrayShape::Grid(..)) == (ty == Type::Surface) =>
                {
                    Value::Vectors(a.clone())
                }
                _ => return Err(wrong(&value)),
            }
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

/// Numbers in braces as a row; rows of equal length in braces as a grid, including rows of three
/// numbers.
fn rows_of_numbers<T: Real>(items: &[Value<T>]) -> Option<Array<T>> {
    if let Some(row) =
        items.iter().map(|v| if let Value::Number(x) = v { Some(*x) } else { None }).collect()
    {
        return Some(Array::row(row));
    }
    let (mut all, mut width) = (Vec::new(), None);
    for item in items {
        let before = all.len();
        match &*moldloft_arrays::gathered(item) {
            Value::Numbers(a) if matches!(a.shape, ArrayShape::Row(_)) => all.extend(&a.items),
            Value::Vector(v) => all.extend(v.to_array()),
            _ => return None,
        }
        let n = all.len() - before;
        if *width.get_or_insert(n) != n {
            return None;
        }
    }
    Some(Array { shape: ArrayShape::Grid(items.len(), width?), items: all })
}

/// A declared dimension.
///
/// # Errors
/// When it is not a whole number in range.
pub fn extent(n: f64) -> Result<usize, Diagnostic> {
    if n.fract() == 0.0 && (1.0..MOST_INT).contains(&n) {
        return Ok(n as usize);
    }
    Err(Diagnostic::error("wrong-dimension", "a dimension is a positive whole number")
        .expected("a whole number from 1 on")
        .found(n.to_string()))
}

/// Checks that an array of `count` elements may be declared; gives its cost in steps.
///
/// # Errors
/// More elements than a single array may have, or memory for no more of them.
pub fn has_room<T>(ty: Type, count: f64, budget: &Budget) -> Result<u64, Diagnostic> {
    let numbers = match ty {
        Type::Farray => 1,
        Type::String => 8,
        _ => 3,
    };
    within_share(count, numbers).map_err(|most| {
        Diagnostic::error("too-many-elements", "the array is too large")
            .expected(most)
            .found(format!("{count}"))
            .help(MORE_MEMORY)
    })?;
    // And a byte for whether it was given a value.
    let bytes = count as u64 * (numbers * size_of::<T>() as u64 + 1);
    match budget.grow(bytes) {
        Ok(()) => Ok(count as u64 / 64),
        Err(spent) => Err(Diagnostic::error(spent.id(), spent.to_string()).help(spent.help())),
    }
}

/// The initial value of a variable with declared dimensions `dims`.
///
/// # Errors
/// When dimensions, type and value do not match. The caller has checked the memory.
pub fn initial<T: Real>(
    ty: Type,
    dims: &[usize],
    value: Option<Value<T>>,
) -> Result<Value<T>, Diagnostic> {
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
        (Type::Block, &[ni, nj, nk]) => blocks::zeros([ni, nj, nk]),
        (Type::String, [n]) => Value::list(vec![Value::text(""); *n]),
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
            .expected("farray a[n], curve c[n], surface s[m,n], block b[l,m,n] or string s[n]")
            .maybe_help(match ty {
                Type::Int | Type::Float => Some("a row of numbers is an `farray`"),
                Type::Vector => Some("a row of vectors is a `curve`"),
                _ => None,
            }));
        }
    };
    let Some(value) = value else { return Ok(empty) };
    let mut filled = empty;
    fill(&mut filled, None, None, value)?;
    Ok(filled)
}

/// Stores a value into a variable or a part of it; the whole right side is evaluated first. Returns
/// a whole array that was replaced, so that its memory can be reused.
///
/// # Errors
/// When type or shape differ.
pub fn store<T: Real>(
    taken: Taken<'_>,
    old: &mut Value<T>,
    place: &Place,
    value: Value<T>,
) -> Result<Option<Value<T>>, Diagnostic> {
    let whole = place.section.is_none() && place.component.is_none();
    let array = matches!(taken.ty, Type::Farray | Type::Curve | Type::Surface | Type::Block);
    if let (true, Value::Record(old), Value::Record(new)) = (whole, &*old, &value)
        && old.of != new.of
    {
        return Err(Diagnostic::error("wrong-type", format!("`{}` is a {}", taken.name, old.of))
            .expected(format!("a {}", old.of))
            .found(format!("a {}", new.of)));
    }
    let texts = taken.ty == Type::String && matches!(old, Value::List(_));
    if whole && taken.fixed && (texts || matches!(old, Value::Block(_))) {
        fill(old, None, None, value)?;
        return Ok(None);
    }
    if whole {
        let alike = match (&*old, &value) {
            (Value::Numbers(a), Value::Numbers(b)) => a.shape == b.shape,
            (Value::Vectors(a), Value::Vectors(b)) => a.shape == b.shape,
            _ => false,
        };
        if alike {
            return Ok(Some(std::mem::replace(old, value)));
        }
        if !(array && (taken.fixed || !is_array(&value))) {
            return Ok(Some(std::mem::replace(old, converted(taken.ty, value)?)));
        }
    }
    if matches!(old, Value::Unset) {
        return Err(Diagnostic::error(
            "no-shape",
            format!("`{}` has no dimensions yet", taken.name),
        )
        .help("declare them, or assign a whole array first"));
    }
    let value = match (taken.ty, &*old, &value) {
        (list @ Type::List(_), Value::List(_), Value::List(_)) => converted(list, value)?,
        (Type::List(item), Value::List(_), _) => converted(item.ty(), value)?,
        _ => value,
    };
    fill(old, place.section, place.component, value)?;
    Ok(None)
}

fn is_array<T: Real>(value: &Value<T>) -> bool {
    matches!(value, Value::Numbers(_) | Value::Vectors(_) | Value::List(_) | Value::Block(_))
}

/// The section, or the whole; checked against the dimensions.
fn section_of(
    shape: ArrayShape,
    section: Option<ArraySection>,
) -> Result<ArraySection, Diagnostic> {
    match (shape, section) {
        (_, None) => Ok(ArraySection::whole(shape)),
        (ArrayShape::Row(_), Some(s @ ArraySection::Row(_)))
        | (ArrayShape::Grid(..), Some(s @ ArraySection::Grid(..))) => Ok(s),
        (_, Some(section)) => {
            let found = section.parts().len();
            Err(Diagnostic::error("wrong-subscripts", "wrong number of subscripts")
                .expected(match shape {
                    ArrayShape::Row(_) => "one subscript, as in c[3]",
                    ArrayShape::Grid(..) => "two subscripts, as in s[3,4]",
                })
                .found(format!("{found} subscripts")))
        }
    }
}

/// Writes `value` into the selected elements, or one component of them.
pub(crate) fn fill<T: Real>(
    old: &mut Value<T>,
    section: Option<ArraySection>,
    component: Option<usize>,
    value: Value<T>,
) -> Result<(), Diagnostic> {
    let differ = |to: ArraySection, from: ArrayShape| {
        let to = to.shape().map_or("a single element".to_string(), |s| s.to_string());
        Diagnostic::error("shapes-differ", format!("shapes differ: {to} = {from}"))
            .expected(format!("a value of shape {to}, or a single one"))
            .found(from.to_string())
    };
    let wrong = |expected: &str, value: &Value<T>| {
        let found = a(value);
        Diagnostic::error("wrong-type", format!("expected {expected}, found {found}"))
            .expected(expected.to_string())
            .found(found)
    };
    if let Some(size) = blocks::size(old)
        && let Value::Block(layers) = old
    {
        return blocks::fill(layers, size, section, component, &blocks::spelled_by(value));
    }
    if let Value::List(items) = old {
        return fill_list(items, section, value);
    }
    let value = match value {
        Value::Point(p) => Value::Vector(p.xyz),
        Value::List(_) | Value::Vector(_) if matches!(old, Value::Numbers(_)) => {
            converted(Type::Farray, value)?
        }
        Value::List(_) | Value::Vector(_) if component.is_some() => converted(Type::Farray, value)?,
        Value::List(_) => match &*moldloft_arrays::gathered(&value) {
            grid @ Value::Vectors(_) => grid.clone(),
            _ => converted(Type::Curve, value)?,
        },
        other => other,
    };
    let alike = |section: ArraySection, from: ArrayShape| match section.shape() == Some(from) {
        true => Ok(()),
        false => Err(differ(section, from)),
    };
    match (&mut *old, component) {
        (Value::Numbers(array), None) => {
            let shape = array.shape;
            let section = section_of(shape, section)?;
            let items = &mut Arc::make_mut(array).items;
            match &value {
                Value::Number(x) => put_all(items, shape, section, *x),
                Value::Numbers(from) => {
                    alike(section, from.shape)?;
                    put(items, shape, section, &from.items);
                }
                other => return Err(wrong("a number or an farray", other)),
            }
        }
        (Value::Vectors(array), None) => {
            let shape = array.shape;
            let section = section_of(shape, section)?;
            let planes = &mut Arc::make_mut(array).planes;
            match &value {
                Value::Vector(v) => {
                    for (plane, x) in planes.iter_mut().zip(v.to_array()) {
                        put_all(plane, shape, section, x);
                    }
                }
                Value::Vectors(from) => {
                    alike(section, from.shape)?;
                    for (plane, from) in planes.iter_mut().zip(&from.planes) {
                        put(plane, shape, section, from);
                    }
                }
                other => return Err(wrong("a vector, a curve or a surface", other)),
            }
        }
        (Value::Vectors(array), Some(c)) => {
            let shape = array.shape;
            let section = section_of(shape, section)?;
            let plane = &mut Arc::make_mut(array).planes[c];
            match &value {
                Value::Number(x) => put_all(plane, shape, section, *x),
                Value::Numbers(from) => {
                    alike(section, from.shape)?;
                    put(plane, shape, section, &from.items);
                }
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
                format!("{} has no such part", class.with_article()),
            ));
        }
    }
    Ok(())
}

/// Writes into a list: one value for all selected items, or one for each.
fn fill_list<T: Real>(
    items: &mut Arc<[Value<T>]>,
    section: Option<ArraySection>,
    value: Value<T>,
) -> Result<(), Diagnostic> {
    let positions: Vec<usize> = match section {
        None => (0..items.len()).collect(),
        Some(ArraySection::Row(selection)) => selection.positions().collect(),
        Some(_) => {
            return Err(Diagnostic::error("wrong-subscripts", "a list has one subscript"));
        }
    };
    let texts = items.iter().any(|item| matches!(item, Value::Text(_)));
    let values = match value {
        Value::List(from) if !texts || from.iter().all(|v| matches!(v, Value::Text(_))) => {
            if from.len() != positions.len() {
                let (to, from) = (positions.len(), from.len());
                return Err(Diagnostic::error(
                    "shapes-differ",
                    format!("shapes differ: [{to}] = [{from}]"),
                )
                .expected(format!("{to} values, or a single one"))
                .found(format!("{from} values")));
            }
            from.to_vec()
        }
        value if !texts || matches!(value, Value::Text(_)) => vec![value; positions.len()],
        other => {
            let found = a(&other);
            return Err(Diagnostic::error("wrong-type", format!("expected a text, found {found}"))
                .expected("a text, or as many as there are elements")
                .found(found));
        }
    };
    let mut all = items.to_vec();
    for (k, value) in positions.into_iter().zip(values) {
        all[k] = value;
    }
    *items = all.into();
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
/// When subscripts and dimensions do not match.
pub fn part<T: Real>(value: &Value<T>, section: ArraySection) -> Result<Value<T>, Diagnostic> {
    Ok(match value {
        Value::Numbers(array) => {
            let section = section_of(array.shape, Some(section))?;
            let items = picked(&array.items, array.shape, section);
            match section.shape() {
                None => Value::Number(items[0]),
                Some(shape) => Value::Numbers(Arc::new(Array { shape, items })),
            }
        }
        Value::Vectors(array) => {
            let section = section_of(array.shape, Some(section))?;
            let planes = array.planes.each_ref().map(|p| picked(p, array.shape, section));
            match section.shape() {
                None => Value::Vector(Vec3::from(planes.map(|p| p[0]))),
                Some(shape) => Value::Vectors(Arc::new(Vectors { shape, planes })),
            }
        }
        Value::List(items) => match section {
            ArraySection::Row(one) if !one.keeps => items[one.start].clone(),
            ArraySection::Row(some) => Value::list(some.positions().map(|k| items[k].clone())),
            ArraySection::Grid(..) | ArraySection::Block(..) => {
                return Err(Diagnostic::error("wrong-subscripts", "a list has one subscript"));
            }
        },
        Value::Block(layers) => match section {
            ArraySection::Block(a, b, c) => blocks::part(layers, [a, b, c])?,
            _ => {
                return Err(Diagnostic::error("wrong-subscripts", "a block has three subscripts"));
            }
        },
        other => {
            return Err(Diagnostic::error(
                "not-indexable",
                format!("{} has no elements to index", other.called()),
            )
            .expected("a row, grid or list")
            .found(other.called()));
        }
    })
}

/// The value of a component of vectors; `None` for other values.
pub fn component<T: Real>(value: &Value<T>, c: usize) -> Option<Value<T>> {
    Some(match value {
        Value::Vector(v) => Value::Number(v[c]),
        Value::Point(p) => Value::Number(p.xyz[c]),
        Value::Vectors(a) => {
            Value::Numbers(Arc::new(Array { shape: a.shape, items: a.planes[c].clone() }))
        }
        Value::Block(_) => {
            return blocks::by_layer(value, |layer| component(layer, c).ok_or(()))?.ok();
        }
        _ => return None,
    })
}

/// The value inside lists and records at the end of a path.
pub fn inside<'v, T: Real>(root: &'v Value<T>, path: &ValuePath) -> Option<&'v Value<T>> {
    path.steps().iter().try_fold(root, |value, step| match (value, step) {
        (Value::List(items), PathStep::Item(k)) => items.get(*k as usize),
        (Value::Record(record), PathStep::Member(k)) => record.values.get(*k as usize),
        _ => None,
    })
}

/// The value inside lists and records at the end of a path, for changes.
pub fn inside_mut<'v, T: Real>(
    root: &'v mut Value<T>,
    path: &ValuePath,
) -> Option<&'v mut Value<T>> {
    path.steps().iter().try_fold(root, |value, step| match (value, step) {
        (Value::List(items), PathStep::Item(k)) => Arc::make_mut(items).get_mut(*k as usize),
        (Value::Record(record), PathStep::Member(k)) => {
            Arc::make_mut(record).values.get_mut(*k as usize)
        }
        _ => None,
    })
}

/// The value at a place of a variable whose value is `root`.
///
/// # Errors
/// When it has no such part.
pub fn at_place<T: Real>(root: &Value<T>, place: &Place) -> Result<Value<T>, Diagnostic> {
    let within = inside(root, &place.path)
        .ok_or_else(|| Diagnostic::error("not-indexable", "there is no such item or member"))?;
    let value = match place.section {
        Some(section) => part(within, section)?,
        None => within.clone(),
    };
    match place.component {
        None => Ok(value),
        Some(c) => component(&value, c).ok_or_else(|| {
            Diagnostic::error("not-indexable", format!("{} has no components", value.called()))
        }),
    }
}

/// The type of the value at a place of a variable of type `ty` and value `root`.
pub fn type_at<T: Real>(ty: Type, root: &Value<T>, place: &Place) -> Type {
    let Some(value) = inside(root, &place.path) else { return ty };
    let ty = match (ty, place.path.steps()) {
        (ty, []) => ty,
        (Type::List(item), [PathStep::Item(_)]) => item.ty(),
        _ => type_of(value),
    };
    let of =
        |dimensions: usize, vectors: bool| match (vectors && place.component.is_none(), dimensions)
        {
            (true, 0) => Type::Vector,
            (true, 1) => Type::Curve,
            (true, 2) => Type::Surface,
            (_, 3) => Type::Block,
            (true, _) => Type::Surface,
            (false, 0) => Type::Float,
            (false, _) => Type::Farray,
        };
    let dimensions =
        |shape: ArrayShape| place.section.unwrap_or(ArraySection::whole(shape)).extents().1;
    match value {
        Value::Numbers(a) => of(dimensions(a.shape), false),
        Value::Vectors(a) => of(dimensions(a.shape), true),
        Value::Vector(_) => of(0, true),
        Value::Block(_) => place.section.map_or(ty, |section| of(section.extents().1, true)),
        _ => ty,
    }
}

/// A type with the extents of a value: `curve[60]`, `surface[60,25]`, `number`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SizedType {
    /// Numbers, and their extents.
    Numbers(ArrayShape),
    /// Vectors, and their extents.
    Vectors(ArrayShape),
    /// A block, and its extents.
    Block([usize; 3]),
    /// A list, and its length.
    List(usize),
    /// A value of another class, without extents.
    Other(Class),
}

impl std::fmt::Display for SizedType {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            SizedType::Numbers(shape) => write!(f, "farray{shape}"),
            SizedType::Vectors(shape @ ArrayShape::Row(_)) => write!(f, "curve{shape}"),
            SizedType::Vectors(shape) => write!(f, "surface{shape}"),
            SizedType::Block(size) => write!(f, "block{}", blocks::spelled(*size)),
            SizedType::List(n) => write!(f, "list[{n}]"),
            SizedType::Other(class) => f.write_str(class.name()),
        }
    }
}

/// The type and extents of a value.
pub fn shape_of<T: Real>(value: &Value<T>) -> SizedType {
    match value {
        Value::Numbers(a) => SizedType::Numbers(a.shape),
        Value::Vectors(a) => SizedType::Vectors(a.shape),
        Value::List(items) => SizedType::List(items.len()),
        Value::Block(_) => {
            blocks::size(value).map_or(SizedType::Other(Class::Block), SizedType::Block)
        }
        other => SizedType::Other(other.class()),
    }
}

/// The type and extents of a value as text.
pub fn shape_text<T: Real>(value: &Value<T>) -> String {
    shape_of(value).to_string()
}

/// The type and extents of the value at a place.
pub fn shape_at<T: Real>(root: &Value<T>, place: &Place) -> String {
    at_place(root, place).map_or_else(|_| shape_text(root), |value| shape_text(&value))
}

/// The extents of a value that can be indexed.
pub fn extents<T: Real>(value: &Value<T>) -> Option<Vec<usize>> {
    let of = |shape: ArrayShape| match shape {
        ArrayShape::Row(n) => vec![n],
        ArrayShape::Grid(m, n) => vec![m, n],
    };
    match value {
        Value::Numbers(a) => Some(of(a.shape)),
        Value::Vectors(a) => Some(of(a.shape)),
        Value::List(items) => Some(vec![items.len()]),
        Value::Block(_) => blocks::size(value).map(|size| size.to_vec()),
        _ => None,
    }
}
