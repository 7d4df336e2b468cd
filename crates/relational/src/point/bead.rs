//! Beads: points on curves by their parameter.

use crate::arguments::Bead;
use moldloft_num::Real;
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, Point, Value};

/// A point on a curve at a given parameter: X = C(t).
///
/// Outside [0, 1] it continues the curve's formula. On a snake the bead is a ring and has a
/// position on the surface too.
#[derive(Kind)]
#[kind(
    class = Bead,
    columns = "curve t",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); Line l(A, B); AbsBead b(l, 0.25);"
)]
pub struct AbsBead<T: Real> {
    /// Host curve.
    curve: CurveRef<T>,
    /// Its parameter.
    t: T,
}

impl<T: Real> Build<T> for AbsBead<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(Value::Point(Box::new(Point::on_curve(self.curve, self.t))))
    }
}

/// A point on the curve of another bead, at a fixed difference of parameter: X = C(t + dt).
///
/// When the other bead moves, the difference of parameters stays the same, not the length
/// of the curve between them.
#[derive(Kind)]
#[kind(
    class = Bead,
    columns = "bead dt",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); Line l(A, B); AbsBead b(l, 0.25); \
               RelBead c(b, 0.5);"
)]
pub struct RelBead<T: Real> {
    /// Reference bead.
    bead: Bead<T>,
    /// Difference of parameter.
    dt: T,
}

impl<T: Real> Build<T> for RelBead<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Bead { curve, t, .. } = self.bead;
        Ok(Value::Point(Box::new(Point::on_curve(curve, t + self.dt))))
    }
}
