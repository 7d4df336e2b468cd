//! Reductions of an array: products, lengths, boxes, centroids.

use crate::value::{Farray, Items, Points, Shaped, VectorArray, farray};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{ArrayShape, Build, CallError, Context, FieldId, Kind, Scalar, Value};

fn empty(field: FieldId) -> CallError {
    CallError::new("empty", "an empty array has no such element")
        .expected("at least one element")
        .in_field(field)
}

/// The root, or zero with derivative zero.
fn root<T: Real>(square: T) -> T {
    if square.re() > 0.0 { square.sqrt() } else { T::zero() }
}

fn steps<T: Real>(points: &[Vec3<T>]) -> impl Iterator<Item = T> + '_ {
    points.windows(2).map(|w| root((w[1] - w[0]).norm_sq()))
}

/// The product of all numbers of an array.
#[derive(Kind)]
#[kind(class = Number, function, cheap, name = "prod", example = "assert prod(list(2, 3, 4)) == 24;")]
pub struct Prod<T: Scalar> {
    /// The numbers.
    a: Farray<T>,
}

impl<T: Scalar> Build<T> for Prod<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(Value::Number(self.a.items.into_iter().fold(T::one(), |x, y| x * y)))
    }
}

fn position<T: Real>(
    row: &[T],
    field: FieldId,
    better: impl Fn(f64, f64) -> bool,
) -> Result<Value<T>, CallError> {
    if row.is_empty() {
        return Err(empty(field));
    }
    let best = (0..row.len()).fold(0, |k, i| if better(row[i].re(), row[k].re()) { i } else { k });
    Ok(Value::Number(T::from((best + 1) as f64)))
}

/// The index, from 1, of the least number of a row; of equal ones the first.
#[derive(Kind)]
#[kind(class = Number, function, cheap, name = "argmin", example = "assert argmin(list(3, 1, 2)) == 2;")]
pub struct Argmin<T: Scalar> {
    /// The row.
    a: Farray<T>,
}

impl<T: Scalar> Build<T> for Argmin<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        position(&self.a.row().map_err(|fault| fault.in_field(Self::A))?, Self::A, |x, y| x < y)
    }
}

/// The index, from 1, of the greatest number of a row; of equal ones the first.
#[derive(Kind)]
#[kind(class = Number, function, cheap, name = "argmax", example = "assert argmax(list(3, 1, 4)) == 3;")]
pub struct Argmax<T: Scalar> {
    /// The row.
    a: Farray<T>,
}

impl<T: Scalar> Build<T> for Argmax<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        position(&self.a.row().map_err(|fault| fault.in_field(Self::A))?, Self::A, |x, y| x > y)
    }
}

/// The scalar product of two arrays of numbers of equal shape: the sum of a b.
///
/// Vectors have the operator: a . b.
#[derive(Kind)]
#[kind(
    class = Number,
    function,
    cheap,
    name = "dot",
    example = "assert dot(list(1, 2, 3, 4), list(1, 0, 1, 0)) == 4;"
)]
pub struct Dot<T: Scalar> {
    /// Numbers.
    a: Farray<T>,
    /// Second row, of equal length.
    b: Farray<T>,
}

impl<T: Scalar> Build<T> for Dot<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (a, b) = (self.a, self.b);
        if a.shape != b.shape {
            let message = format!("shapes differ: {} and {}", a.shape, b.shape);
            return Err(CallError::new("shapes-differ", message)
                .expected("equal shapes")
                .found(format!("{} and {}", a.shape, b.shape))
                .in_field(Self::B));
        }
        let products = a.items.into_iter().zip(b.items).map(|(x, y)| x * y);
        Ok(Value::Number(products.fold(T::zero(), |x, y| x + y)))
    }
}

/// The root of the sum of squares of an array of numbers, or of the coordinates of vectors.
#[derive(Kind)]
#[kind(class = Number, function, cheap, name = "norm", example = "assert norm(list(3, 4)) == 5;")]
pub struct Norm<T: Scalar> {
    /// Numbers, or vectors.
    a: Value<T>,
}

impl<T: Scalar> Build<T> for Norm<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let square = match &self.a {
            Value::Vector(v) => v.norm_sq(),
            other => match <Items<T> as moldloft_registry::FromValue<T>>::from_value(other)
                .map_err(|fault| fault.in_field(Self::A))?
            {
                Items::Numbers(a) => a.items.iter().fold(T::zero(), |sum, &x| sum + x * x),
                Items::Vectors(a) => a.items.iter().fold(T::zero(), |sum, v| sum + v.norm_sq()),
            },
        };
        Ok(Value::Number(root(square)))
    }
}

/// The number of items: elements of a row, lines of a grid, layers of a block, items of a list, characters of a text.
///
/// The length of a curve is `length`.
#[derive(Kind)]
#[kind(
    class = Number,
    function,
    cheap,
    name = "len",
    example = "assert len(list(5, 6)) == 2 and len(\"wing\") == 4;"
)]
pub struct Len<T: Scalar> {
    /// The array, list or text.
    a: Value<T>,
}

impl<T: Scalar> Build<T> for Len<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let first = |shape: ArrayShape| match shape {
            ArrayShape::Row(n) | ArrayShape::Grid(n, _) => n,
        };
        let count = match &self.a {
            Value::Text(text) => text.chars().count(),
            Value::Vector(_) => 3,
            Value::Numbers(a) => first(a.shape),
            Value::Vectors(a) => first(a.shape),
            Value::List(items) | Value::Block(items) => items.len(),
            other => {
                let found = other.class().with_article();
                return Err(CallError::new("wrong-class", format!("{found} has no items"))
                    .expected("an array, a list or a text")
                    .found(found)
                    .in_field(Self::A));
            }
        };
        Ok(Value::Number(T::from(count as f64)))
    }
}

/// The length of a curve of points: the sum of its steps.
pub fn polyline_length<T: Real>(points: &[Vec3<T>]) -> T {
    steps(points).fold(T::zero(), |sum, s| sum + s)
}

/// The arc lengths of the points of a curve, from its first point, from 0 to `length`.
#[derive(Kind)]
#[kind(
    class = Numbers,
    function,
    cheap,
    name = "cumlen",
    example = "farray s = cumlen(points({0, 0, 0}, {3, 4, 0}, {3, 4, 1})); assert s[2] == 5;"
)]
pub struct Cumlen<T: Scalar> {
    /// The points.
    curve: Points<T>,
}

impl<T: Scalar> Build<T> for Cumlen<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let points = self.curve.0;
        if points.is_empty() {
            return Err(empty(Self::CURVE));
        }
        let mut sum = T::zero();
        let mut all = vec![sum];
        for step in steps(&points) {
            sum += step;
            all.push(sum);
        }
        Ok(farray(all))
    }
}

/// The centroid of a curve of points (segments weighted by length) or of a surface (cells weighted
/// by area); for zero length or area, the mean of the points.
#[derive(Kind)]
#[kind(
    class = Vector,
    function,
    cheap,
    name = "centroid",
    example = "assert |centroid(points({0, 0, 0}, {1, 0, 0}, {3, 0, 0})) - {1.5, 0, 0}| < 1e-15;"
)]
pub struct Centroid<T: Scalar> {
    /// The points.
    o: VectorArray<T>,
}

impl<T: Scalar> Build<T> for Centroid<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let VectorArray { shape, items } = self.o;
        if items.is_empty() {
            return Err(empty(Self::O));
        }
        let (mut sum, mut whole) = (Vec3::zero(), T::zero());
        let mut take = |centre: Vec3<T>, size: T| {
            sum += centre * size;
            whole += size;
        };
        match shape {
            ArrayShape::Row(_) => {
                for (w, step) in items.windows(2).zip(steps(&items)) {
                    take((w[0] + w[1]) * T::from(0.5), step);
                }
            }
            ArrayShape::Grid(m, n) => {
                for k in 0..m.saturating_sub(1) * n {
                    let (i, j) = (k / n, k % n);
                    if j + 1 == n {
                        continue;
                    }
                    let at = |i: usize, j: usize| items[i * n + j];
                    let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
                    for [p, q, r] in [[a, b, c], [a, c, d]] {
                        let area = root((q - p).cross(r - p).norm_sq());
                        take((p + q + r) * T::from(1.0 / 3.0), area);
                    }
                }
            }
        }
        Ok(Value::Vector(if whole.re() > 0.0 {
            sum / whole
        } else {
            items.iter().fold(Vec3::zero(), |sum, p| sum + *p) / T::from(items.len() as f64)
        }))
    }
}

fn corner<T: Real>(
    o: Shaped<T>,
    field: FieldId,
    pick: impl Fn(T, T) -> T,
) -> Result<Value<T>, CallError> {
    let points = match o {
        Shaped::One(p) => vec![p],
        Shaped::Many(a) => a.items,
    };
    let both = |a: Vec3<T>, b: Vec3<T>| Vec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z));
    points.into_iter().reduce(both).map(Value::Vector).ok_or_else(|| empty(field))
}

/// The least x, y and z of a curve or surface of points.
#[derive(Kind)]
#[kind(
    class = Vector,
    function,
    cheap,
    name = "bbox_min",
    example = "assert |bbox_min(points({0, 5, 0}, {1, 2, -3})) - {0, 2, -3}| == 0;"
)]
pub struct BboxMin<T: Scalar> {
    /// The points.
    o: Shaped<T>,
}

impl<T: Scalar> Build<T> for BboxMin<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        corner(self.o, Self::O, T::min)
    }
}

/// The greatest x, y and z of a curve or surface of points.
#[derive(Kind)]
#[kind(
    class = Vector,
    function,
    cheap,
    name = "bbox_max",
    example = "assert |bbox_max(points({0, 5, 0}, {1, 2, -3})) - {1, 5, 0}| == 0;"
)]
pub struct BboxMax<T: Scalar> {
    /// The points.
    o: Shaped<T>,
}

impl<T: Scalar> Build<T> for BboxMax<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        corner(self.o, Self::O, T::max)
    }
}
