//! Functions of masks: choices, counts, positions; sorting, cumulative sums and interpolation of
//! rows.
//!
//! A mask is an array of 0 and 1, as comparisons of arrays give; any number but 0 counts as 1.

use crate::value::{Farray, Numbers, farray, numbers};
use moldloft_budget::{Budget, Spent};
use moldloft_grid::GridError;
use moldloft_num::Vec3;
use moldloft_registry::{
    ArrayShape, Build, CallError, Context, FieldId, FromValue, Kind, Scalar, Value,
};
use std::sync::Arc;

fn truth(holds: bool) -> f64 {
    if holds { 1.0 } else { 0.0 }
}

fn differ(a: ArrayShape, b: ArrayShape, field: FieldId) -> CallError {
    CallError::new("shapes-differ", format!("shapes differ: {a} and {b}"))
        .expected("equal shapes, or a single value")
        .found(format!("{a} and {b}"))
        .in_field(field)
}

/// Choice by a mask: `a` where the mask is true, else `b`, element by element.
///
/// Numbers or vectors; each a single one or an array of the mask's shape. Both are computed before one is chosen.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    name = "where",
    example = "farray a = list(-1, 2, -3, 4); assert sum(where(a > 0, a, 0)) == 6;"
)]
pub struct Where<T: Scalar> {
    /// The mask.
    mask: Numbers<T>,
    /// Value where the mask is true.
    a: Value<T>,
    /// Value where it is false.
    b: Value<T>,
}

/// Numbers or vectors, one for all or one for each element.
enum Choice<T> {
    Numbers(Vec<T>),
    Vectors(Vec<Vec3<T>>),
}

impl<T: Scalar> Where<T> {
    fn choice(
        value: &Value<T>,
        shape: Option<ArrayShape>,
        field: FieldId,
    ) -> Result<Choice<T>, CallError> {
        let fits = |found: ArrayShape| match shape {
            Some(shape) if shape == found => Ok(()),
            Some(shape) => Err(differ(shape, found, field)),
            None => Err(differ(ArrayShape::Row(1), found, field)),
        };
        Ok(match value {
            Value::Number(x) => Choice::Numbers(vec![*x]),
            Value::Vector(v) => Choice::Vectors(vec![*v]),
            Value::Vectors(a) => {
                fits(a.shape)?;
                Choice::Vectors(a.points())
            }
            other => {
                let a = Farray::from_value(other).map_err(|fault| fault.in_field(field))?;
                fits(a.shape)?;
                Choice::Numbers(a.items)
            }
        })
    }
}

impl<T: Scalar> Build<T> for Where<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (shape, mask) = match &self.mask {
            Numbers::One(x) => {
                return Ok(if x.re() == 0.0 { self.b } else { self.a });
            }
            Numbers::Many(a) => (a.shape, &a.items),
        };
        fn picked<T: Scalar, E: Copy>(mask: &[T], a: &[E], b: &[E]) -> Vec<E> {
            let at = |items: &[E], k: usize| if items.len() == 1 { items[0] } else { items[k] };
            let each = mask.iter().enumerate();
            each.map(|(k, x)| if x.re() == 0.0 { at(b, k) } else { at(a, k) }).collect()
        }
        let a = Self::choice(&self.a, Some(shape), Self::A)?;
        let b = Self::choice(&self.b, Some(shape), Self::B)?;
        Ok(match (a, b) {
            (Choice::Numbers(a), Choice::Numbers(b)) => numbers(shape, picked(mask, &a, &b)),
            (Choice::Vectors(a), Choice::Vectors(b)) => {
                crate::value::vectors(shape, picked(mask, &a, &b))
            }
            _ => {
                return Err(CallError::new(
                    "wrong-class",
                    "a choice between numbers and vectors is not possible",
                )
                .expected("numbers in both arguments, or vectors in both")
                .in_field(Self::B));
            }
        })
    }
}

/// Numbers kept between two bounds, element by element; the bounds are numbers or arrays of the same shape.
///
/// The derivative is that of the number or bound that is returned.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    name = "clamp",
    example = "assert sum(clamp(list(-1, 0.5, 3), 0, 1)) == 1.5;"
)]
pub struct Clamp<T: Scalar> {
    /// The numbers.
    a: Numbers<T>,
    /// The least.
    low: Numbers<T>,
    /// The greatest.
    high: Numbers<T>,
}

impl<T: Scalar> Build<T> for Clamp<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let all = [&self.a, &self.low, &self.high];
        let mut shape = None;
        for (field, part) in [Self::A, Self::LOW, Self::HIGH].into_iter().zip(all) {
            if let Numbers::Many(a) = part {
                match shape {
                    None => shape = Some(a.shape),
                    Some(shape) if shape == a.shape => {}
                    Some(shape) => return Err(differ(shape, a.shape, field)),
                }
            }
        }
        let at = |part: &Numbers<T>, k: usize| match part {
            Numbers::One(x) => *x,
            Numbers::Many(a) => a.items[k],
        };
        let count = shape.map_or(1, ArrayShape::count);
        let mut items = Vec::with_capacity(count);
        for k in 0..count {
            let [x, low, high] = all.map(|part| at(part, k));
            if low.re() > high.re() {
                let message =
                    format!("the bounds {} and {} are in the wrong order", low.re(), high.re());
                return Err(CallError::new("out-of-range", message)
                    .expected("a lower bound that is not above the upper one")
                    .in_field(Self::HIGH));
            }
            items.push(x.max(low).min(high));
        }
        Ok(match shape {
            None => Value::Number(items[0]),
            Some(shape) => numbers(shape, items),
        })
    }
}

/// 1 when a mask holds somewhere, else 0.
#[derive(Kind)]
#[kind(class = Number, function, name = "any", example = "assert any(list(1, 2, 3) > 2);")]
pub struct Any<T: Scalar> {
    /// The mask.
    mask: Numbers<T>,
}

impl<T: Scalar> Build<T> for Any<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let holds = self.mask.items().iter().any(|x| x.re() != 0.0);
        Ok(Value::Number(T::from(truth(holds))))
    }
}

/// 1 when a mask holds everywhere, else 0.
#[derive(Kind)]
#[kind(class = Number, function, name = "all", example = "assert all(list(1, 2, 3) > 0);")]
pub struct All<T: Scalar> {
    /// The mask.
    mask: Numbers<T>,
}

impl<T: Scalar> Build<T> for All<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let holds = self.mask.items().iter().all(|x| x.re() != 0.0);
        Ok(Value::Number(T::from(truth(holds))))
    }
}

/// The positions, from 1, of the true elements of a row; empty if there are none. For a text: the
/// position of the first occurrence of a part, or 0.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    name = "find",
    example = "farray k = find(list(5, 1, 7) > 4); assert k[1] == 1 and k[2] == 3; \
               assert find(\"wing.dat\", \".\") == 5;"
)]
pub struct Find<T: Scalar> {
    /// The mask, or the text.
    a: Value<T>,
    /// Part of the text to find.
    part: Option<Arc<str>>,
}

impl<T: Scalar> Build<T> for Find<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let place = |fault: CallError| fault.in_field(Self::A);
        match (&self.a, &self.part) {
            (Value::Text(text), Some(part)) => return Ok(crate::texts::place_in(text, part)),
            (Value::Text(_), None) => {
                return Err(CallError::new("missing-argument", "nothing is looked for")
                    .expected("find(text, part)")
                    .in_field(Self::PART));
            }
            (_, Some(_)) => {
                return Err(CallError::new(
                    "unused-argument",
                    "a part can be found in a text only",
                )
                .expected("a text, or a mask alone")
                .in_field(Self::PART));
            }
            (_, None) => {}
        }
        let mask = Farray::from_value(&self.a).and_then(|a| a.row()).map_err(place)?;
        let held = mask.iter().enumerate().filter(|(_, x)| x.re() != 0.0);
        Ok(farray(held.map(|(k, _)| T::from((k + 1) as f64)).collect()))
    }
}

/// A row in ascending order; equal numbers keep their order.
#[derive(Kind)]
#[kind(
    class = Numbers,
    function,
    name = "sort",
    example = "farray a = sort(list(3, 1, 2)); assert a[1] == 1 and a[3] == 3;"
)]
pub struct Sort<T: Scalar> {
    /// The row.
    a: Farray<T>,
}

impl<T: Scalar> Build<T> for Sort<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let row = self.a.row().map_err(|fault| fault.in_field(Self::A))?;
        let sorted = sorted_until(row, &context.budget);
        let spent = |spent| crate::grids::fault(GridError::Spent(spent), Self::A);
        sorted.map(farray).map_err(spent)
    }
}

/// Numbers sorted between two checks of the remaining budget.
const SORTED_AT_ONCE: usize = 1 << 16;

/// The numbers in order, equal ones as they were: long rows piece by piece, then merged.
fn sorted_until<T: Scalar>(mut row: Vec<T>, budget: &Budget) -> Result<Vec<T>, Spent> {
    for piece in row.chunks_mut(SORTED_AT_ONCE) {
        budget.poll()?;
        piece.sort_by(|a, b| a.re().total_cmp(&b.re()));
    }
    let mut width = SORTED_AT_ONCE;
    while width < row.len() {
        let mut merged = Vec::with_capacity(row.len());
        for pair in row.chunks(2 * width) {
            let (mut a, mut b) = pair.split_at(width.min(pair.len()));
            while let ([x, ..], [y, ..]) = (a, b) {
                let from = if y.re().total_cmp(&x.re()).is_lt() { &mut b } else { &mut a };
                merged.push(from[0]);
                *from = &from[1..];
                if merged.len() % SORTED_AT_ONCE == 0 {
                    budget.poll()?;
                }
            }
            merged.extend_from_slice(a);
            merged.extend_from_slice(b);
        }
        row = merged;
        width *= 2;
    }
    Ok(row)
}

/// The sums of the first, the first two, ... numbers of a row.
#[derive(Kind)]
#[kind(
    class = Numbers,
    function,
    name = "cumsum",
    example = "farray s = cumsum(list(1, 2, 3)); assert s[3] == 6;"
)]
pub struct CumSum<T: Scalar> {
    /// The row.
    a: Farray<T>,
}

impl<T: Scalar> Build<T> for CumSum<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let row = self.a.row().map_err(|fault| fault.in_field(Self::A))?;
        let mut sum: Option<T> = None;
        let sums = row.into_iter().map(|x| {
            let now = sum.map_or(x, |sum| sum + x);
            sum = Some(now);
            now
        });
        Ok(farray(sums.collect()))
    }
}

/// The differences of neighbours in a row of numbers: one element fewer than the row.
#[derive(Kind)]
#[kind(
    class = Numbers,
    function,
    name = "diff",
    example = "farray d = diff(list(1, 4, 9)); assert d[2] == 5;"
)]
pub struct Diff<T: Scalar> {
    /// The row.
    a: Farray<T>,
}

impl<T: Scalar> Build<T> for Diff<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let row = self.a.row().map_err(|fault| fault.in_field(Self::A))?;
        if row.len() < 2 {
            return Err(CallError::new("too-few-items", "one number has no difference")
                .expected("at least 2 numbers")
                .found(row.len().to_string())
                .in_field(Self::A));
        }
        Ok(farray(row.windows(2).map(|w| w[1] - w[0]).collect()))
    }
}

/// The piecewise linear function through the points (xs, ys), evaluated at x, a number or an array;
/// constant beyond the ends.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    name = "interp",
    example = "assert interp(1.5, list(0, 1, 2), list(0, 10, 30)) == 20;"
)]
pub struct Interp<T: Scalar> {
    /// Positions.
    x: Numbers<T>,
    /// Ascending.
    xs: Farray<T>,
    /// Ordinates, one for each abscissa.
    ys: Farray<T>,
}

impl<T: Scalar> Build<T> for Interp<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let xs = self.xs.row().map_err(|fault| fault.in_field(Self::XS))?;
        let ys = self.ys.row().map_err(|fault| fault.in_field(Self::YS))?;
        if xs.is_empty() || xs.len() != ys.len() {
            return Err(differ(ArrayShape::Row(xs.len()), ArrayShape::Row(ys.len()), Self::YS));
        }
        if let Some(k) = xs.windows(2).position(|w| !(w[1].re() > w[0].re())) {
            return Err(CallError::new(
                "not-monotone",
                format!("element {} does not ascend", k + 2),
            )
            .expected("numbers that ascend")
            .found(xs[k + 1].re().to_string())
            .in_item(k + 1)
            .in_field(Self::XS));
        }
        let last = xs.len() - 1;
        let at = |x: T| {
            let k = xs.partition_point(|low| low.re() <= x.re());
            if k == 0 {
                return ys[0];
            }
            if k > last {
                return ys[last];
            }
            let slope = (ys[k] - ys[k - 1]) / (xs[k] - xs[k - 1]);
            slope * (x - xs[k - 1]) + ys[k - 1]
        };
        let items = self.x.items().iter().map(|x| at(*x)).collect();
        Ok(self.x.numbers(items))
    }
}
