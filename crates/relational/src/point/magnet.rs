//! Magnets: points on surfaces by their parameters.

use crate::arguments::Magnet;
use moldloft_num::Real;
use moldloft_registry::{Build, CallError, Context, Kind, Point, SurfaceRef, Value};

/// A point on a surface at given parameters: X = S(u, v).
///
/// Outside [0, 1] it continues the surface's formula.
#[derive(Kind)]
#[kind(
    class = Magnet,
    columns = "surface u v",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.25, 0.5);"
)]
pub struct AbsMagnet<T: Real> {
    /// Host surface.
    surface: SurfaceRef<T>,
    /// Its first parameter.
    u: T,
    /// Its second parameter.
    v: T,
}

impl<T: Real> Build<T> for AbsMagnet<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(Value::Point(Box::new(Point::on_surface(self.surface, self.u, self.v))))
    }
}

/// A point on the surface of another magnet, at a fixed difference of parameters:
/// X = S(u + du, v + dv).
#[derive(Kind)]
#[kind(
    class = Magnet,
    columns = "magnet du dv",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.25, 0.5); \
               RelMagnet q(p, 0.5, 0.125);"
)]
pub struct RelMagnet<T: Real> {
    /// Reference magnet.
    magnet: Magnet<T>,
    /// Difference of the first parameter.
    #[field(default = 0)]
    du: T,
    /// Difference of the second parameter.
    #[field(default = 0)]
    dv: T,
}

impl<T: Real> Build<T> for RelMagnet<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Magnet { surface, uv: [u, v], .. } = self.magnet;
        Ok(Value::Point(Box::new(Point::on_surface(surface, u + self.du, v + self.dv))))
    }
}
