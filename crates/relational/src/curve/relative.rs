//! Copies of curves: with new ends, scaled, rotated.

use super::Ended;
use crate::affine::{Mapped, PivotTransform};
use moldloft_num::{Axis, Curve, CurveJet, Order, Real, Reparametrization, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, Point, Value};
use std::sync::Arc;

/// A curve moved to new ends: C(t) = c(t) + (1 - t) (P1 - c(0)) + t (P2 - c(1)).
///
/// Ends moved alike give a parallel copy.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel curve p1 p2",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
               AbsPoint D(0, 0, 1); AbsPoint E(3.5, 2, 1.5); RelCurve d(c, D, E);"
)]
pub struct RelCurve<T: Real> {
    /// Reference curve.
    curve: CurveRef<T>,
    /// Start.
    p1: Point<T>,
    /// End.
    p2: Point<T>,
}

impl<T: Real> Build<T> for RelCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { curve, p1, p2 } = self;
        let nesting = curve.depth;
        let shape = Moved::new(curve, p1.xyz, p2.xyz);
        Ok(Value::Curve(CurveRef::new(Ended::between(shape, [p1.key, p2.key]), nesting)))
    }
}

/// A curve (or the path of a snake) moved to new ends.
pub struct Moved<T: Real> {
    curve: CurveRef<T>,
    /// True for the path on the surface instead of the curve.
    path: bool,
    ends: [Vec3<T>; 2],
    old: [Vec3<T>; 2],
}

impl<T: Real> Moved<T> {
    fn new(curve: CurveRef<T>, from: Vec3<T>, to: Vec3<T>) -> Self {
        let old = [curve.end(0.0), curve.end(1.0)];
        Self { curve, path: false, ends: [from, to], old }
    }

    /// The path of a snake, moved in the parameter plane.
    pub fn path(snake: CurveRef<T>, from: Vec3<T>, to: Vec3<T>) -> Self {
        let at = |t: f64| snake.on_surface(T::from(t), Order::Zero).unwrap_or_default()[0];
        let old = [at(0.0), at(1.0)];
        Self { curve: snake, path: true, ends: [from, to], old }
    }
}

impl<T: Real> Curve<T> for Moved<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        let [p, d, dd] = if self.path {
            self.curve.on_surface(t, order).unwrap_or_default()
        } else {
            self.curve.jet(t, order)
        };
        let [from, to] = [0, 1].map(|k| self.ends[k] - self.old[k]);
        [
            p + from * (-t + 1.0) + to * t,
            if order >= Order::First { d + (to - from) } else { d },
            dd,
        ]
    }
    fn law(&self) -> Option<Arc<dyn Reparametrization<T>>> {
        self.curve.law()
    }

    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        if self.path {
            for (x, &t) in out.iter_mut().zip(ts) {
                *x = self.jet(T::from(t), Order::Zero)[0];
            }
            return;
        }
        self.curve.grid(ts, out);
        let [from, to] = [0, 1].map(|k| self.ends[k] - self.old[k]);
        for (x, &t) in out.iter_mut().zip(ts) {
            let t = T::from(t);
            *x = *x + from * (-t + 1.0) + to * t;
        }
    }

    moldloft_num::curve_facts!(breaks of [self.curve], open, not_rational);
}

/// A curve copied from one reference point to another and scaled along the axes: C(t) = to + (sx,
/// sy, sz) (c(t) - from), component by component.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel curve from to sx sy sz",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
               CopyCurve d(c, A, C, 2, 0.5, -1);"
)]
pub struct CopyCurve<T: Real> {
    /// The curve to copy.
    curve: CurveRef<T>,
    /// The reference point that is moved to `to`.
    from: Point<T>,
    /// The image of `from`.
    to: Point<T>,
    /// Scale along x.
    #[field(default = 1)]
    sx: T,
    /// Scale along y.
    #[field(default = 1)]
    sy: T,
    /// Scale along z.
    #[field(default = 1)]
    sz: T,
}

impl<T: Real> Build<T> for CopyCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { curve, from, to, sx, sy, sz } = self;
        let nesting = curve.depth;
        let map = PivotTransform::scaled(from.xyz, to.xyz, [sx, sy, sz]);
        Ok(Value::Curve(CurveRef::new(Mapped { curve, map }, nesting)))
    }
}

/// A curve rotated about a line by an angle, right-handed.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel curve line angle",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
               Line axis(A, C); RotatCurve d(c, axis, 0.75);"
)]
pub struct RotatCurve<T: Real> {
    /// The curve to turn.
    curve: CurveRef<T>,
    /// The axis, from the line's first end to its last.
    line: Axis<T>,
    /// The angle.
    #[field(angle)]
    angle: T,
}

impl<T: Real> Build<T> for RotatCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let nesting = self.curve.depth;
        let map = PivotTransform::turned(self.line, self.angle);
        Ok(Value::Curve(CurveRef::new(Mapped { curve: self.curve, map }, nesting)))
    }
}
