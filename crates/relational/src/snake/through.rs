//! Snakes through magnets: straight and B-spline in the parameter plane.

use crate::arguments::{Magnet, common_surface};
use crate::curve::Segment;
use crate::faults;
use crate::snake::OnSurface;
use moldloft_num::trace::{Key, Trace};
use moldloft_num::{Curve, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, SurfaceRef, Value};
use moldloft_spline::BSplineCurve;

/// The snake of a path on a surface between two point objects, which holds on to shapes nested
/// `nesting` deep besides the surface.
pub(super) fn snake<T: Real>(
    surface: SurfaceRef<T>,
    path: impl Curve<T> + 'static,
    ends: [Option<Key>; 2],
    nesting: u32,
) -> Result<Value<T>, CallError> {
    let shape = OnSurface { surface: surface.clone(), path, trace: Trace::Own(ends) };
    Ok(Value::Curve(CurveRef::snake(shape, surface, nesting)))
}

/// The nameless snake of a path on a surface.
pub fn on_surface<T: Real>(surface: &SurfaceRef<T>, path: impl Curve<T> + 'static) -> CurveRef<T> {
    let shape = OnSurface { surface: surface.clone(), path, trace: Trace::Own([None; 2]) };
    CurveRef::snake(shape, surface.clone(), 0)
}

/// A point of the parameter plane.
pub(super) fn flat<T: Real>([u, v]: [T; 2]) -> Vec3<T> {
    Vec3::new(u, v, T::zero())
}

/// The curve on a surface that is straight in the parameter plane:
/// X(t) = S((1 - t) w1 + t w2), with w1, w2 the parameters of two magnets.
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel m1 m2",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               AbsMagnet p(S, 0.2, 0.1); AbsMagnet q(S, 0.9, 0.8); LineSnake s(p, q);"
)]
pub struct LineSnake<T: Real> {
    /// Start.
    m1: Magnet<T>,
    /// End, on the same surface.
    m2: Magnet<T>,
}

impl<T: Real> Build<T> for LineSnake<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { m1, m2 } = self;
        let items = [(m1.key, &m1.surface), (m2.key, &m2.surface)];
        let fields = [Self::M1, Self::M2];
        let surface = common_surface(&items, |fault, k| fault.in_field(fields[k]))?;
        let path = Segment { from: flat(m1.uv), to: flat(m2.uv) };
        snake(surface, path, [m1.key, m2.key], 0)
    }
}

/// The curve on a surface that is a B-spline in the parameter plane:
/// X(t) = S(sum N_i(t) w_i), with w_i the parameters of the magnets and clamped uniform knots.
///
/// With N magnets the degree is at most N - 1: a higher one is lowered to that.
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel degree magnets",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               AbsMagnet p(S, 0.2, 0.1); AbsMagnet q(S, 0.9, 0.3); AbsMagnet r(S, 0.8, 0.9); \
               BSnake s({p, q, r}, degree = 2);"
)]
pub struct BSnake<T: Real> {
    /// Magnets of one surface, two or more.
    #[field(min_items = 2)]
    magnets: Vec<Magnet<T>>,
    /// Polynomial degree of the path.
    #[field(default = 3, min = 1, max = 25)]
    degree: usize,
}

impl<T: Real> Build<T> for BSnake<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { magnets, degree } = self;
        let [first, .., last] = magnets.as_slice() else {
            return Err(CallError::new("too-few-items", "a snake needs at least 2 magnets")
                .expected("at least 2 magnets")
                .found(magnets.len().to_string())
                .in_field(Self::MAGNETS));
        };
        let ends = [first.key, last.key];
        let items: Vec<_> = magnets.iter().map(|m| (m.key, &m.surface)).collect();
        let surface = common_surface(&items, |fault, k| fault.in_item(k).in_field(Self::MAGNETS))?;
        let path = magnets.iter().map(|m| flat(m.uv)).collect();
        let path = BSplineCurve::uniform(degree.min(magnets.len() - 1), path)
            .map_err(|error| faults::of_spline(error, Self::MAGNETS, Self::DEGREE))?;
        snake(surface, path, ends, 0)
    }
}
