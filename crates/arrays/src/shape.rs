//! Arrays from arrays: reversed, joined, spread, stacked.

use crate::value::{Items, MORE_MEMORY, Points, farray, gathered, vectors, within_share};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{
    ArrayShape, Build, CallError, Context, FieldId, FromValue, Kind, Scalar, Value,
};

/// The same array with its elements in the opposite order; of a surface or grid of numbers along the
/// first index, or along the second.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    cheap,
    name = "reverse",
    example = "farray a = reverse(list(1, 2, 3)); assert a[1] == 3;"
)]
pub struct Reverse<T: Scalar> {
    /// The array.
    a: Items<T>,
    /// The index of a grid to reverse: 1 or 2.
    #[field(default = 1, min = 1, max = 2)]
    index: usize,
}

impl<T: Scalar> Build<T> for Reverse<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let shape = self.a.shape();
        match (shape, self.index) {
            (ArrayShape::Row(n), 1) => Ok(self.a.picked(shape, |k| n - 1 - k)),
            (ArrayShape::Row(_), _) => Err(CallError::new("out-of-range", "a row has one index")
                .expected("index 1")
                .found("2")
                .in_field(Self::INDEX)),
            (ArrayShape::Grid(m, n), 1) => {
                Ok(self.a.picked(shape, |k| (m - 1 - k / n) * n + k % n))
            }
            (ArrayShape::Grid(_, n), _) => Ok(self.a.picked(shape, |k| k / n * n + n - 1 - k % n)),
        }
    }
}

/// The surface or grid of numbers with its two indices exchanged: swap(s)[i,j] = s[j,i].
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    cheap,
    name = "swap",
    example = "surface s[2,3]; surface t = swap(s); assert t.d1 == 3;"
)]
pub struct Swap<T: Scalar> {
    /// The grid.
    s: Items<T>,
}

impl<T: Scalar> Build<T> for Swap<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        match self.s.shape() {
            ArrayShape::Grid(m, n) => {
                Ok(self.s.picked(ArrayShape::Grid(n, m), |k| k % m * n + k / m))
            }
            shape => Err(CallError::new("wrong-shape", format!("expected [m,n], found {shape}"))
                .expected("a surface or a grid of numbers")
                .found(shape.to_string())
                .in_field(Self::S)),
        }
    }
}

/// Distance relative to the curves' size within which two ends are one point.
const SAME: f64 = 1e-12;

/// Curves (or farrays) joined end to end; a point common to two neighbours is kept once.
///
/// Ends count as one when they differ by less than 1e-12 of the size: by rounding. The point of the
/// first of the two stays.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    cheap,
    name = "join",
    example = "curve c = join(points({0, 0, 0}, {1, 0, 0}), points({1, 0, 0}, {1, 1, 0})); \
               assert c.d1 == 3; farray a = join(list(1, 2), list(3, 4)); assert a.d1 == 4;"
)]
pub struct Concatenation<T: Scalar> {
    /// The curves, or farrays.
    #[field(variadic, min_items = 1)]
    parts: Vec<Value<T>>,
}

impl<T: Scalar> Build<T> for Concatenation<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let place = |k: usize| move |fault: CallError| fault.in_item(k).in_field(Self::PARTS);
        if matches!(self.parts[0], Value::Numbers(_)) {
            let mut all: Vec<T> = Vec::with_capacity(self.item_count());
            for (k, part) in self.parts.iter().enumerate() {
                let Items::Numbers(row) = Items::from_value(part).map_err(place(k))? else {
                    let message = format!(
                        "expected an farray like the first, found {}",
                        part.class().with_article()
                    );
                    return Err(place(k)(
                        CallError::new("wrong-class", message)
                            .expected("an farray")
                            .found(part.class().with_article()),
                    ));
                };
                let row = row.row().map_err(place(k))?;
                let size = all.iter().chain(&row).fold(0.0f64, |m, x| m.max(x.re().abs()));
                let same = |a: &T, b: &T| (*a - *b).re().abs() <= SAME * size;
                let skip = all.last().zip(row.first()).is_some_and(|(a, b)| same(a, b));
                all.extend(row.into_iter().skip(usize::from(skip)));
            }
            return Ok(farray(all));
        }
        let mut all: Vec<Vec3<T>> = Vec::with_capacity(self.item_count());
        for (k, part) in self.parts.iter().enumerate() {
            let Points(row) = Points::from_value(part).map_err(place(k))?;
            let first = row.first().map_or(Vec3::zero(), |p| p.re());
            let size = all.iter().chain(&row).fold(0.0f64, |m, p| m.max(p.re().distance(first)));
            let same = |a: &Vec3<T>, b: &Vec3<T>| a.re().distance(b.re()) <= SAME * size;
            let skip = all.last().zip(row.first()).is_some_and(|(a, b)| same(a, b));
            all.extend(row.into_iter().skip(usize::from(skip)));
        }
        Ok(vectors(ArrayShape::Row(all.len()), all))
    }
}

impl<T: Scalar> Concatenation<T> {
    /// Maximum number of items of the result.
    fn item_count(&self) -> usize {
        let items = |part: &Value<T>| match part {
            Value::Numbers(a) => a.items.len(),
            Value::Vectors(a) => a.shape.count(),
            _ => 1,
        };
        self.parts.iter().map(items).sum()
    }
}

fn row_of<T: Real>(a: &Items<T>, field: FieldId) -> Result<usize, CallError> {
    match a.shape() {
        ArrayShape::Row(n) => Ok(n),
        shape => Err(CallError::new("wrong-shape", format!("expected a row [n], found {shape}"))
            .expected("an farray [n] or a curve [n]")
            .found(shape.to_string())
            .in_field(field)),
    }
}

/// The grid [m,n] of a row a[m] repeated along the second index: g[i,j] = a[i].
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    cheap,
    name = "spread_i",
    example = "surface s[3,5]; s = spread_i(list(1, 2, 3), 5) * {0, 1, 0}; assert s[3,4].y == 3;"
)]
pub struct SpreadI<T: Scalar> {
    /// The row, of numbers or vectors.
    a: Items<T>,
    /// The number of columns: the second extent.
    #[field(min = 1, max = 1e6)]
    n: usize,
}

impl<T: Scalar> Build<T> for SpreadI<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (m, n) = (row_of(&self.a, Self::A)?, self.n);
        grid(&self.a, [m, n], Self::N)?;
        Ok(self.a.picked(ArrayShape::Grid(m, n), |k| k / n))
    }
}

/// The grid [m,n] of a row a[n] repeated along the first index: g[i,j] = a[j].
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    cheap,
    name = "spread_j",
    example = "surface s = spread_j(points({0, 0, 0}, {1, 0, 0}), 4); assert s.d1 == 4;"
)]
pub struct SpreadJ<T: Scalar> {
    /// The row, of numbers or vectors.
    a: Items<T>,
    /// The number of rows: the first extent.
    #[field(min = 1, max = 1e6)]
    m: usize,
}

impl<T: Scalar> Build<T> for SpreadJ<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (n, m) = (row_of(&self.a, Self::A)?, self.m);
        grid(&self.a, [m, n], Self::M)?;
        Ok(self.a.picked(ArrayShape::Grid(m, n), |k| k % n))
    }
}

/// Refuses grids too large to hold.
fn grid<T>(of: &Items<T>, [m, n]: [usize; 2], field: FieldId) -> Result<(), CallError> {
    let numbers = if matches!(of, Items::Vectors(_)) { 3 } else { 1 };
    let count = m as f64 * n as f64;
    within_share(count, numbers).map_err(|most| {
        CallError::new("too-large", format!("a grid [{m},{n}] is too large"))
            .expected(most)
            .found(format!("{count}"))
            .help(MORE_MEMORY)
            .in_field(field)
    })
}

/// The farray of these numbers.
#[derive(Kind)]
#[kind(
    class = Numbers,
    function,
    cheap,
    name = "list",
    example = "farray a = list(1, 4, 9); assert a.d1 == 3;"
)]
pub struct List<T: Scalar> {
    /// The numbers.
    #[field(variadic)]
    numbers: Vec<T>,
}

impl<T: Scalar> Build<T> for List<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(farray(self.numbers))
    }
}

/// The curve of these points.
#[derive(Kind)]
#[kind(
    class = Vectors,
    function,
    cheap,
    name = "points",
    example = "curve c = points({0, 0, 0}, {1, 2, 0}); assert c[2].y == 2;"
)]
pub struct PointsOf<T: Scalar> {
    /// The points.
    #[field(variadic)]
    points: Vec<Vec3<T>>,
}

impl<T: Scalar> Build<T> for PointsOf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(vectors(ArrayShape::Row(self.points.len()), self.points))
    }
}

/// The surface with these curves, of equal length, as lines s[1,], s[2,], ...; or the block with
/// these surfaces, of equal shape, as layers b[,,1], b[,,2], ....
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    cheap,
    name = "stack",
    example = "surface s = stack(points({0, 0, 0}, {1, 0, 0}), points({0, 1, 0}, {1, 1, 0})); \
               assert s[2,1].y == 1; block b = stack(s, s + {0, 0, 1}); assert b.d3 == 2;"
)]
pub struct Stack<T: Scalar> {
    /// The curves or surfaces.
    #[field(variadic, min_items = 1)]
    parts: Vec<Value<T>>,
}

impl<T: Scalar> Build<T> for Stack<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (mut all, mut n) = (Vec::new(), None);
        let m = self.parts.len();
        let gathered: Vec<Value<T>> =
            self.parts.iter().map(|part| gathered(part).into_owned()).collect();
        let grid = |v: &Value<T>| matches!(v, Value::Vectors(a) if matches!(a.shape, ArrayShape::Grid(..)));
        if gathered.iter().all(grid) {
            return layered(gathered, Self::PARTS);
        }
        for (k, part) in self.parts.iter().enumerate() {
            let place = |fault: CallError| fault.in_item(k).in_field(Self::PARTS);
            let Points(row) = Points::from_value(part).map_err(place)?;
            let expected = *n.get_or_insert(row.len());
            if row.len() != expected {
                let message = format!("curve {} has {} points", k + 1, row.len());
                return Err(place(
                    CallError::new("shapes-differ", message)
                        .expected(format!("{expected} points, like the first curve"))
                        .found(format!("{} points", row.len())),
                ));
            }
            all.extend(row);
        }
        Ok(vectors(ArrayShape::Grid(m, n.unwrap_or(0)), all))
    }
}

/// The block of these surfaces.
fn layered<T: Scalar>(layers: Vec<Value<T>>, field: FieldId) -> Result<Value<T>, CallError> {
    let shapes: Vec<ArrayShape> = layers
        .iter()
        .filter_map(|layer| if let Value::Vectors(a) = layer { Some(a.shape) } else { None })
        .collect();
    if let Some(k) = shapes.iter().position(|shape| *shape != shapes[0]) {
        let message = format!("layers 1 and {} differ in shape", k + 1);
        return Err(CallError::new("shapes-differ", message)
            .expected(format!("surface{}", shapes[0]))
            .found(format!("surface{}", shapes[k]))
            .in_item(k)
            .in_field(field));
    }
    let fault = || CallError::new("wrong-class", "a block has layers").in_field(field);
    Value::block(layers).ok_or_else(fault)
}

fn extents<T: Scalar>(a: &Value<T>, field: FieldId) -> Result<ArrayShape, CallError> {
    match &*gathered(a) {
        Value::Numbers(a) => Ok(a.shape),
        Value::Vectors(a) => Ok(a.shape),
        other => {
            let found = other.class().with_article();
            Err(CallError::new("wrong-class", format!("expected an array, found {found}"))
                .expected("an farray, a curve or a surface")
                .found(found)
                .in_field(field))
        }
    }
}

/// The first extent of an array: the same as `a.d1`, for any expression.
#[derive(Kind)]
#[kind(class = Number, function, cheap, name = "d1", example = "assert d1(uniform(0, 1, 7)) == 7;")]
pub struct D1<T: Scalar> {
    /// The array.
    a: Value<T>,
}

impl<T: Scalar> Build<T> for D1<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (ArrayShape::Row(n) | ArrayShape::Grid(n, _)) = extents(&self.a, Self::A)?;
        Ok(Value::Number(T::from(n as f64)))
    }
}

/// The second extent of a surface or grid of numbers.
#[derive(Kind)]
#[kind(
    class = Number,
    function,
    cheap,
    name = "d2",
    example = "assert d2(spread_i(uniform(0, 1, 7), 3)) == 3;"
)]
pub struct D2<T: Scalar> {
    /// The grid.
    a: Value<T>,
}

impl<T: Scalar> Build<T> for D2<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        match extents(&self.a, Self::A)? {
            ArrayShape::Grid(_, n) => Ok(Value::Number(T::from(n as f64))),
            shape => Err(CallError::new("wrong-shape", format!("a row {shape} has one extent"))
                .expected("a surface or a grid of numbers")
                .found(shape.to_string())
                .in_field(Self::A)),
        }
    }
}
