//! Beads and rings at a length along curves, and copies of beads and magnets.

use crate::arguments::{Bead, Magnet, Ring, Snake, Start};
use moldloft_num::period::principal;
use moldloft_num::{Order, Real};
use moldloft_registry::{
    Build, CallError, Context, CurveRef, FieldId, Kind, Point, SurfaceRef, Value,
};
use moldloft_spline::inv_arclen;

fn on<T: Real>(curve: CurveRef<T>, t: T) -> Result<Value<T>, CallError> {
    Ok(Value::Point(Box::new(Point::on_curve(curve, t))))
}

/// The bead at a signed length along a curve.
fn at_length<T: Real>(
    start: Start<T>,
    length: T,
    fields: [FieldId; 2],
) -> Result<Value<T>, CallError> {
    let Start { curve, t } = start;
    let speed = |k: i32| curve.jet(T::from(f64::from(k) / 16.0), Order::First)[1].re().norm();
    let size = (0..=16).map(speed).fold(0.0, f64::max);
    if size == 0.0 {
        return Err(CallError::new("no-length", "the curve has no length")
            .expected("a curve with length")
            .related(curve.key, "has a zero tangent")
            .in_field(fields[0]));
    }
    let found = inv_arclen(&*curve, t, length, 1e-12 * size);
    let found = found.map_err(|error| {
        CallError::new("beyond-end", error.to_string())
            .expected(format!("a length up to {} on that side", error.available))
            .found(error.asked.to_string())
            .related(curve.key, "is too short")
            .in_field(fields[1])
    })?;
    let place = if curve.closed() { principal(found) } else { found };
    on(curve, place)
}

/// The bead at a signed arc length along a curve from another bead or from the curve's start;
/// negative lengths run backwards.
#[derive(Kind)]
#[kind(
    class = Bead,
    columns = "start length",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
               ArcLenBead b(c, 1.5); ArcLenBead d(b, -0.5);"
)]
pub struct ArcLenBead<T: Real> {
    /// A bead, or a curve for its start.
    start: Start<T>,
    /// The length.
    length: T,
}

impl<T: Real> Build<T> for ArcLenBead<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        at_length(self.start, self.length, [Self::START, Self::LENGTH])
    }
}

/// The ring at a signed arc length along a snake from another ring or from the snake's start;
/// negative lengths run backwards.
#[derive(Kind)]
#[kind(
    class = Ring,
    columns = "start length",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, \"u\", 0.4); \
               ArcLenRing r(s, 0.5); ArcLenRing q(r, 0.25);"
)]
pub struct ArcLenRing<T: Real> {
    /// A ring, or a snake for its start.
    start: Start<T>,
    /// The length.
    length: T,
}

impl<T: Real> Build<T> for ArcLenRing<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        if self.start.curve.surface.is_none() {
            return Err(CallError::new("wrong-class", "expected a snake or a ring on one")
                .expected("a snake, or a ring on one")
                .found("a curve that is not on a surface")
                .in_field(Self::START));
        }
        at_length(self.start, self.length, [Self::START, Self::LENGTH])
    }
}

/// The bead of another curve at the parameter of a bead: X = C(t).
#[derive(Kind)]
#[kind(
    class = Bead,
    columns = "bead curve",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
               Line l(A, C); AbsBead b(c, 0.25); CopyBead d(b, l);"
)]
pub struct CopyBead<T: Real> {
    /// The bead whose parameter is copied.
    bead: Bead<T>,
    /// The target curve.
    curve: CurveRef<T>,
}

impl<T: Real> Build<T> for CopyBead<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        on(self.curve, self.bead.t)
    }
}

/// The magnet of another surface at the parameters of a magnet: X = S(u, v).
#[derive(Kind)]
#[kind(
    class = Magnet,
    columns = "magnet surface",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); RuledSurf T(m, l); \
               AbsMagnet p(S, 0.25, 0.375); CopyMagnet q(p, T);"
)]
pub struct CopyMagnet<T: Real> {
    /// The magnet whose parameters are copied.
    magnet: Magnet<T>,
    /// The target surface.
    surface: SurfaceRef<T>,
}

impl<T: Real> Build<T> for CopyMagnet<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let [u, v] = self.magnet.uv;
        Ok(Value::Point(Box::new(Point::on_surface(self.surface, u, v))))
    }
}

/// The ring of another snake at the parameter of a ring: X = S(w(t)).
#[derive(Kind)]
#[kind(
    class = Ring,
    columns = "ring snake",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, \"u\", 0.4); \
               UVSnake t(S, \"v\", 0.3); AbsRing r(s, 0.3); CopyRing q(r, t);"
)]
pub struct CopyRing<T: Real> {
    /// The ring whose parameter is copied.
    ring: Ring<T>,
    /// The target snake.
    snake: Snake<T>,
}

impl<T: Real> Build<T> for CopyRing<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        on(self.snake.curve, self.ring.0.t)
    }
}
