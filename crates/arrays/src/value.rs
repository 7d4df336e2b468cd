//! Arrays in and out: the only module that depends on the representation of numbers and vectors in
//! a value.

use moldloft_grid::{SurfaceGrid, VolumeGrid};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{
    Array, ArrayShape, CallError, Class, FieldId, FromValue, Scalar, Value, Vectors as Planes,
};
use std::borrow::Cow;
use std::marker::PhantomData;
use std::sync::Arc;

/// A row or grid of numbers.
pub struct Farray<T> {
    pub shape: ArrayShape,
    pub items: Vec<T>,
}

/// A row of vectors: the language's `curve`.
pub struct Points<T>(pub Vec<Vec3<T>>);

/// A grid of vectors: the language's `surface`; (i, j) at `i * n + j`.
pub struct VectorGrid<T> {
    pub m: usize,
    pub n: usize,
    pub points: Vec<Vec3<T>>,
}

/// A row or grid of vectors.
pub struct VectorArray<T> {
    pub shape: ArrayShape,
    pub items: Vec<Vec3<T>>,
}

/// A number or an farray; results element by element have its shape.
pub enum Numbers<T> {
    One(T),
    Many(Farray<T>),
}

/// Refuses neighbouring points of a curve that coincide.
pub fn distinct_neighbours<T: Real>(points: &[Vec3<T>], field: FieldId) -> Result<(), CallError> {
    let no_distance = |pair: &[Vec3<T>]| (pair[1] - pair[0]).norm_sq().re() == 0.0;
    match points.windows(2).position(no_distance) {
        None => Ok(()),
        Some(k) => {
            let message = format!("points {} and {} coincide", k + 1, k + 2);
            Err(CallError::new("coincident-points", message)
                .expected("distinct neighbouring points")
                .in_item(k + 1)
                .in_field(field))
        }
    }
}

fn not_finite(index: usize) -> CallError {
    CallError::new("not-finite", format!("element {} is not finite", index + 1))
        .expected("finite numbers")
        .in_item(index)
}

/// Type of a value, in the terms of the array language.
pub fn type_name<T: Real>(value: &Value<T>) -> &'static str {
    match value {
        Value::Numbers(_) => "an farray",
        Value::Vectors(a) if matches!(a.shape, ArrayShape::Grid(..)) => "a surface",
        Value::Vectors(_) => "a curve",
        Value::Curve(_) => "a parametric curve (pcurve)",
        Value::Surface(_) => "a parametric surface (psurface)",
        other => other.class().with_article(),
    }
}

fn wrong<T: Real, R>(expected: &'static str, value: &Value<T>) -> Result<R, CallError> {
    let found = type_name(value);
    let fault = CallError::new("wrong-class", format!("expected {expected}, found {found}"))
        .expected(expected)
        .found(found);
    Err(match value {
        Value::Unset => CallError::new("missing-argument", format!("{expected} is missing")),
        // Arrays of points and shapes with parameters are easily taken for each other.
        Value::Curve(_) => fault.help("take points of it first: distc(curve, uniform(0, 1, 50))"),
        Value::Surface(_) => fault
            .help("take points of it first: dists(surface, uniform(0, 1, 50), uniform(0, 1, 30))"),
        _ => fault,
    })
}

impl<T: Scalar> FromValue<T> for Farray<T> {
    const CLASS: Class = Class::Number;
    const MANY: bool = true;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        let (shape, items) = match &*gathered(value) {
            Value::Numbers(a) => (a.shape, a.items.clone()),
            _ => {
                let items: Vec<T> = FromValue::from_value(value)?;
                (ArrayShape::Row(items.len()), items)
            }
        };
        match items.iter().position(|x| !x.is_finite()) {
            Some(index) => Err(not_finite(index)),
            None => Ok(Self { shape, items }),
        }
    }
}

impl<T> Farray<T> {
    /// The numbers of a row; a grid is refused.
    pub fn row(self) -> Result<Vec<T>, CallError> {
        match self.shape {
            ArrayShape::Row(_) => Ok(self.items),
            shape => {
                Err(CallError::new("wrong-shape", format!("expected an farray [n], found {shape}"))
                    .expected("one row of numbers")
                    .found(shape.to_string())
                    .help("take one of its rows: a[1,]"))
            }
        }
    }
}

impl<T: Scalar> FromValue<T> for VectorArray<T> {
    const CLASS: Class = Class::Vectors;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        let (shape, items) = match &*gathered(value) {
            Value::Vectors(a) => (a.shape, a.points()),
            Value::List(items) => {
                let each = |(k, v): (usize, &Value<T>)| {
                    <Vec3<T>>::from_value(v).map_err(|fault| fault.in_item(k))
                };
                let points = items.iter().enumerate().map(each).collect::<Result<Vec<_>, _>>()?;
                (ArrayShape::Row(points.len()), points)
            }
            _ => return wrong("a curve or a surface", value),
        };
        match items.iter().position(|p| !p.is_finite()) {
            Some(index) => Err(not_finite(index)),
            None => Ok(Self { shape, items }),
        }
    }
}

impl<T: Scalar> FromValue<T> for Points<T> {
    const CLASS: Class = Class::Vectors;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        if !matches!(value, Value::Vectors(_) | Value::List(_)) {
            return wrong("a curve", value);
        }
        let VectorArray { shape, items } = VectorArray::from_value(value)?;
        match shape {
            ArrayShape::Row(_) => Ok(Self(items)),
            _ => Err(CallError::new("wrong-shape", format!("expected a curve [n], found {shape}"))
                .expected("a curve [n]")
                .found(format!("a surface {shape}"))
                .help("take one of its lines: s[1,] or s[,1]")),
        }
    }
}

impl<T: Scalar> FromValue<T> for VectorGrid<T> {
    const CLASS: Class = Class::Vectors;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        if !matches!(value, Value::Vectors(_) | Value::List(_)) {
            return wrong("a surface", value);
        }
        let VectorArray { shape, items } = VectorArray::from_value(value)?;
        match shape {
            ArrayShape::Grid(m, n) => Ok(Self { m, n, points: items }),
            _ => Err(CallError::new(
                "wrong-shape",
                format!("expected a surface [m,n], found {shape}"),
            )
            .expected("a surface [m,n]")
            .found(format!("a curve {shape}"))),
        }
    }
}

impl<T: Scalar> FromValue<T> for Numbers<T> {
    const CLASS: Class = Class::Any;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Number(_) => Ok(Self::One(T::from_value(value)?)),
            Value::Numbers(_) | Value::List(_) | Value::Vector(_) => {
                Ok(Self::Many(Farray::from_value(value)?))
            }
            other => {
                let found = other.class().with_article();
                let message = format!("expected a number or an farray, found {found}");
                Err(CallError::new("wrong-class", message)
                    .expected("a number or an farray")
                    .found(found))
            }
        }
    }
}

impl<T: Real> Numbers<T> {
    /// The numbers in order.
    pub fn items(&self) -> &[T] {
        match self {
            Self::One(x) => std::slice::from_ref(x),
            Self::Many(a) => &a.items,
        }
    }

    /// A vector for each number, in their shape.
    pub fn vectors(&self, items: Vec<Vec3<T>>) -> Value<T> {
        match self {
            Self::One(_) => Value::Vector(items[0]),
            Self::Many(a) => vectors(a.shape, items),
        }
    }

    /// A number for each number, in their shape.
    pub fn numbers(&self, items: Vec<T>) -> Value<T> {
        match self {
            Self::One(_) => Value::Number(items[0]),
            Self::Many(a) => numbers(a.shape, items),
        }
    }
}

/// Fraction of the allowed memory that one array may take: a statement needs several such arrays at
/// a time.
const SHARE_OF_MEMORY: u64 = 16;

/// True if an array of `count` elements of `numbers` numbers each is within the limit.
///
/// # Errors
/// Otherwise: the limit, as text.
pub fn within_share(count: f64, numbers: u64) -> Result<(), String> {
    let allowed = moldloft_budget::limits().memory;
    let most = allowed / SHARE_OF_MEMORY / (8 * numbers);
    if count <= most as f64 {
        return Ok(());
    }
    let gib = allowed as f64 / f64::from(1 << 30);
    Err(format!(
        "at most {most} elements, which take a sixteenth of the {gib:.2} GiB that are allowed"
    ))
}

/// Remedy for an array above the limit.
pub const MORE_MEMORY: &str = "allow more: `--limit memory=8G`, `moldloft.limits(memory=...)`";

/// Numbers as a value.
pub fn numbers<T: Real>(shape: ArrayShape, items: Vec<T>) -> Value<T> {
    Value::Numbers(Arc::new(Array { shape, items }))
}

/// Vectors as a value.
pub fn vectors<T: Real>(shape: ArrayShape, items: Vec<Vec3<T>>) -> Value<T> {
    Value::Vectors(Arc::new(Planes::new(shape, items)))
}

/// A row of numbers as a value.
pub fn farray<T: Real>(items: Vec<T>) -> Value<T> {
    numbers(ArrayShape::Row(items.len()), items)
}

/// A list of numbers, of vectors, of rows of equal length, or of three coordinates at least one an
/// array, converted to an array; any other value unchanged.
pub fn gathered<T: Real>(value: &Value<T>) -> Cow<'_, Value<T>> {
    let Value::List(items) = value else { return Cow::Borrowed(value) };
    let all_numbers: Option<Vec<T>> = items
        .iter()
        .map(|item| if let Value::Number(x) = item { Some(*x) } else { None })
        .collect();
    if let Some(items) = all_numbers.filter(|items| !items.is_empty()) {
        return Cow::Owned(farray(items));
    }
    let all_vectors: Option<Vec<Vec3<T>>> = items
        .iter()
        .map(|item| match item {
            Value::Vector(v) => Some(*v),
            Value::Point(p) => Some(p.xyz),
            _ => None,
        })
        .collect();
    if let Some(items) = all_vectors.filter(|items| !items.is_empty()) {
        return Cow::Owned(vectors(ArrayShape::Row(items.len()), items));
    }
    if let Some(points) = by_coordinates(items) {
        return Cow::Owned(points);
    }
    let mut width = None;
    let mut row = |shape: ArrayShape| match shape {
        ArrayShape::Row(n) if width.is_none_or(|width| width == n) => {
            width = Some(n);
            true
        }
        _ => false,
    };
    let (mut flat, mut points) = (Vec::new(), Vec::new());
    for item in items.iter() {
        match &*gathered(item) {
            Value::Numbers(a) if points.is_empty() && row(a.shape) => flat.extend(&a.items),
            Value::Vectors(a) if flat.is_empty() && row(a.shape) => points.extend(a.points()),
            _ => return Cow::Borrowed(value),
        }
    }
    let Some(n) = width else { return Cow::Borrowed(value) };
    let shape = ArrayShape::Grid(items.len(), n);
    Cow::Owned(match points.is_empty() {
        true => numbers(shape, flat),
        false => vectors(shape, points),
    })
}

/// The points of coordinates that are arrays of one shape, with single numbers beside them: `{x, y, 0}`.
fn by_coordinates<T: Real>(items: &[Value<T>]) -> Option<Value<T>> {
    let [x, y, z] = items else { return None };
    // Three rows in braces of their own are those of a grid.
    if !items.iter().any(|v| matches!(v, Value::Number(_))) {
        return None;
    }
    let [x, y, z] = [&*gathered(x), &*gathered(y), &*gathered(z)];
    let shape = |v: &Value<T>| if let Value::Numbers(a) = v { Some(a.shape) } else { None };
    let all = [x, y, z].into_iter().find_map(shape)?;
    let plane = |v: &Value<T>| match v {
        Value::Number(x) => Some(vec![*x; all.count()]),
        Value::Numbers(a) if a.shape == all => Some(a.items.clone()),
        _ => None,
    };
    Some(Value::Vectors(Arc::new(Planes { shape: all, planes: [plane(x)?, plane(y)?, plane(z)?] })))
}

/// A vector, a curve or a surface; a motion keeps the shape.
pub enum Shaped<T> {
    One(Vec3<T>),
    Many(VectorArray<T>),
}

impl<T: Scalar> FromValue<T> for Shaped<T> {
    const CLASS: Class = Class::Any;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Vector(_) | Value::Point(_) => Ok(Self::One(FromValue::from_value(value)?)),
            Value::Vectors(_) | Value::List(_) => Ok(Self::Many(FromValue::from_value(value)?)),
            other => {
                let found = other.class().with_article();
                let message = format!("expected a vector, a curve or a surface, found {found}");
                let fault = CallError::new("wrong-class", message)
                    .expected("a vector, a curve [n] or a surface [m,n]")
                    .found(found);
                Err(match other {
                    Value::Curve(_) | Value::Surface(_) => {
                        fault.help("take points of it first, with distc or dists")
                    }
                    _ => fault,
                })
            }
        }
    }
}

impl<T: Real> Shaped<T> {
    /// Every point replaced by `f` of it.
    pub fn mapped(self, f: impl Fn(Vec3<T>) -> Vec3<T>) -> Value<T> {
        match self {
            Self::One(p) => Value::Vector(f(p)),
            Self::Many(VectorArray { shape, items }) => {
                vectors(shape, items.into_iter().map(f).collect())
            }
        }
    }
}

/// An array of numbers or of vectors.
pub enum Items<T> {
    Numbers(Farray<T>),
    Vectors(VectorArray<T>),
}

impl<T: Scalar> FromValue<T> for Items<T> {
    const CLASS: Class = Class::Any;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match &*gathered(value) {
            numbers @ Value::Numbers(_) => Ok(Self::Numbers(FromValue::from_value(numbers)?)),
            vectors @ Value::Vectors(_) => Ok(Self::Vectors(FromValue::from_value(vectors)?)),
            other => {
                let found = other.class().with_article();
                let message = format!("expected an array, found {found}");
                Err(CallError::new("wrong-class", message)
                    .expected("an farray, a curve or a surface")
                    .found(found))
            }
        }
    }
}

impl<T: Real> Items<T> {
    /// The shape.
    pub fn shape(&self) -> ArrayShape {
        match self {
            Self::Numbers(a) => a.shape,
            Self::Vectors(a) => a.shape,
        }
    }

    /// The array whose element k is element `from(k)` of this one.
    pub fn picked(&self, shape: ArrayShape, from: impl Fn(usize) -> usize) -> Value<T> {
        let count = shape.count();
        match self {
            Self::Numbers(a) => numbers(shape, (0..count).map(|k| a.items[from(k)]).collect()),
            Self::Vectors(a) => vectors(shape, (0..count).map(|k| a.items[from(k)]).collect()),
        }
    }
}

/// A grid of vectors as the grid that grid functions work on.
pub struct GridArg<T>(pub SurfaceGrid<T>);

impl<T: Scalar> FromValue<T> for GridArg<T> {
    const CLASS: Class = Class::Vectors;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Vectors(a) => match a.shape {
                ArrayShape::Grid(m, n) => Ok(Self(SurfaceGrid::new(m, n, a.planes.clone()))),
                shape => {
                    Err(CallError::new("wrong-shape", format!("expected a surface, found {shape}"))
                        .expected("a surface [m,n]")
                        .found(format!("a curve {shape}")))
                }
            },
            other => wrong("a surface", other),
        }
    }
}

/// A text.
pub struct TextArg<T> {
    /// Its characters.
    pub text: Arc<str>,
    marker: PhantomData<T>,
}

impl<T: Scalar> FromValue<T> for TextArg<T> {
    const CLASS: Class = Class::Text;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        Ok(Self { text: FromValue::<T>::from_value(value)?, marker: PhantomData })
    }
}

/// A block, as the grid that functions of blocks work on: it has cells.
pub struct BlockArg<T>(pub VolumeGrid<T>);

impl<T: Scalar> FromValue<T> for BlockArg<T> {
    const CLASS: Class = Class::Block;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        let (Value::Block(layers) | Value::List(layers)) = value else {
            return wrong("a block", value);
        };
        let mut grids: Vec<SurfaceGrid<T>> = Vec::with_capacity(layers.len());
        for (k, layer) in layers.iter().enumerate() {
            grids.push(GridArg::from_value(layer).map_err(|fault| fault.in_item(k))?.0);
        }
        let grid = VolumeGrid::from_layers(&grids).map_err(|error| {
            CallError::new("no-grid", error.to_string()).expected("surfaces of one shape")
        })?;
        if grid.size.iter().any(|n| *n < 2) {
            let [ni, nj, nk] = grid.size;
            return Err(CallError::new(
                "too-few-items",
                format!("a block [{ni},{nj},{nk}] has no cells"),
            )
            .expected("at least 2 points along each index"));
        }
        Ok(Self(grid))
    }
}

/// The layers of a grid as a block.
///
/// # Panics
/// For no layers, or layers of different shapes.
pub fn block<T: Real>(layers: impl IntoIterator<Item = SurfaceGrid<T>>) -> Value<T> {
    Value::block(layers.into_iter().map(surface)).expect("layers of one shape")
}

/// A grid as a value.
pub fn surface<T: Real>(grid: SurfaceGrid<T>) -> Value<T> {
    let shape = ArrayShape::Grid(grid.m, grid.n);
    Value::Vectors(Arc::new(Planes { shape, planes: grid.planes }))
}

/// A row of vectors as a value.
pub fn curve<T: Real>(items: Vec<Vec3<T>>) -> Value<T> {
    vectors(ArrayShape::Row(items.len()), items)
}
