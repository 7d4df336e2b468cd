//! Lists under a name: of numbers, of knots, of objects.

use moldloft_num::Real;
use moldloft_registry::{Array, Build, CallError, Context, Kind, Value};
use std::sync::Arc;

/// A list of numbers under a name, accepted wherever a list of numbers is expected.
#[derive(Kind)]
#[kind(
    class = Numbers,
    columns = "values",
    example = "RealList spacing({0, 0.25, 0.5, 1}); AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); \
               TableRelabel r(spacing, {0, 0.1, 0.4, 1}); Line l(A, B, relabel = r);"
)]
pub struct RealList<T: Real> {
    /// The numbers.
    values: Vec<T>,
}

impl<T: Real> Build<T> for RealList<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(Value::Numbers(Arc::new(Array::row(self.values))))
    }
}

/// A named list of knots: non-decreasing numbers, accepted as any list of numbers.
///
/// The spline determines the number of knots and their multiplicity.
#[derive(Kind)]
#[kind(class = Numbers, columns = "values", example = "KnotList k({0, 0, 0, 0.4, 1, 1, 1});")]
pub struct KnotList<T: Real> {
    /// The knots, two or more, in ascending order; equal ones are multiple knots.
    #[field(min_items = 2)]
    values: Vec<T>,
}

impl<T: Real> Build<T> for KnotList<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let descends = self.values.windows(2).position(|w| w[1].re() < w[0].re());
        if let Some(k) = descends {
            let [before, value] = [self.values[k].re(), self.values[k + 1].re()];
            return Err(CallError::new("not-monotone", "knots must not descend")
                .expected(format!("a knot of at least {before}"))
                .found(value.to_string())
                .in_item(k + 1)
                .in_field(Self::VALUES));
        }
        Ok(Value::Numbers(Arc::new(Array::row(self.values))))
    }
}

/// Objects under a common name, accepted wherever a list of such objects is expected: the wetted
/// surfaces, the points of a curve.
///
/// A list among the objects adds its own.
#[derive(Kind)]
#[kind(
    class = List,
    role = List,
    columns = "objects",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(2, 2, 1); \
               EntityList ends({A, B}); EntityList all({ends, C}); BCurve c(all, degree = 2);"
)]
pub struct EntityList<T: Real> {
    /// The objects.
    objects: Vec<Value<T>>,
}

impl<T: Real> Build<T> for EntityList<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let mut all = Vec::with_capacity(self.objects.len());
        for object in self.objects {
            match object {
                Value::List(items) => all.extend(items.iter().cloned()),
                other => all.push(other),
            }
        }
        Ok(Value::list(all))
    }
}
