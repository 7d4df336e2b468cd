//! Rings: points on snakes by their parameter.

use crate::arguments::{Bead, Ring, Snake};
use moldloft_num::Real;
use moldloft_registry::{Build, CallError, Context, Kind, Point, Value};

/// A point on a snake at a given parameter: X = S(w(t)).
///
/// It is both a bead of the snake and a magnet of the surface.
#[derive(Kind)]
#[kind(
    class = Ring,
    columns = "snake t",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, \"u\", 0.4); \
               AbsRing r(s, 0.5);"
)]
pub struct AbsRing<T: Real> {
    /// The snake of the ring.
    snake: Snake<T>,
    /// Its parameter.
    t: T,
}

impl<T: Real> Build<T> for AbsRing<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(Value::Point(Box::new(Point::on_curve(self.snake.curve, self.t))))
    }
}

/// A point on the snake of another ring, at a fixed difference of parameter: X = S(w(t + dt)).
#[derive(Kind)]
#[kind(
    class = Ring,
    columns = "ring dt",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, \"u\", 0.4); \
               AbsRing r(s, 0.5); RelRing q(r, 0.25);"
)]
pub struct RelRing<T: Real> {
    /// Reference ring.
    ring: Ring<T>,
    /// Difference of parameter.
    dt: T,
}

impl<T: Real> Build<T> for RelRing<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Ring(Bead { curve, t, .. }) = self.ring;
        Ok(Value::Point(Box::new(Point::on_curve(curve, t + self.dt))))
    }
}
