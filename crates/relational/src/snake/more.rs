//! Arcs, interpolating splines, NURBS and conics in the parameter plane of a surface.

use super::through::{flat, snake};
use crate::arguments::{EndRule, Magnet, Snake, common_surface};
use crate::curve::{Moved, Oblique, clamped_ends, spline};
use crate::faults;
use moldloft_num::trace::Trace;
use moldloft_num::{Curve, CurveJet, Order, Real, Reparametrization, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, FieldId, Kind, SurfaceRef, Value};
use moldloft_spline::InterpolatingSpline;

/// Parameters of magnets and their common surface; the magnets are the list in `field`.
fn places<T: Real>(
    magnets: &[Magnet<T>],
    field: FieldId,
) -> Result<(SurfaceRef<T>, Vec<Vec3<T>>), CallError> {
    if magnets.len() < 2 {
        return Err(CallError::new("too-few-items", "a snake needs at least 2 magnets")
            .expected("at least 2 magnets")
            .found(magnets.len().to_string())
            .in_field(field));
    }
    let items: Vec<_> = magnets.iter().map(|m| (m.key, &m.surface)).collect();
    let surface = common_surface(&items, |fault, k| fault.in_item(k).in_field(field))?;
    Ok((surface, magnets.iter().map(|m| flat(m.uv)).collect()))
}

/// Parameters of the magnets in these three fields.
fn three<T: Real>(
    m: [&Magnet<T>; 3],
    fields: [FieldId; 3],
) -> Result<(SurfaceRef<T>, [Vec3<T>; 3]), CallError> {
    let items = m.map(|m| (m.key, &m.surface));
    let surface = common_surface(&items, |fault, k| fault.in_field(fields[k]))?;
    Ok((surface, m.map(|m| flat(m.uv))))
}

/// A circular arc in the parameter plane of a surface, of the six types of an arc.
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel type m1 m2 m3",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               AbsMagnet p(S, 0.2, 0.1); AbsMagnet q(S, 0.5, 0.3); AbsMagnet r(S, 0.8, 0.2); \
               ArcSnake s(p, q, r);"
)]
pub struct ArcSnake<T: Real> {
    /// First magnet.
    m1: Magnet<T>,
    /// Second magnet, on the same surface.
    m2: Magnet<T>,
    /// Third magnet, on the same surface.
    m3: Magnet<T>,
    /// One of the six types.
    #[field(default = 1, min = 1, max = 6)]
    r#type: u32,
}

impl<T: Real> Build<T> for ArcSnake<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { m1, m2, m3, r#type } = self;
        let (surface, places) = three([&m1, &m2, &m3], [Self::M1, Self::M2, Self::M3])?;
        let Some(arc) = moldloft_spline::CircularArc::of_type(r#type, places) else {
            return Err(CallError::new("out-of-range", format!("unknown arc type {}", r#type))
                .expected("a type from 1 to 6")
                .found(r#type.to_string())
                .in_field(Self::TYPE));
        };
        let end = match r#type {
            2 => None,
            5 => m2.key,
            6 => m1.key,
            _ => m3.key,
        };
        snake(surface, arc.map_err(|error| faults::of_arc(error, Self::M1))?, [m1.key, end], 0)
    }
}

/// An interpolating spline in the parameter plane of a surface, as a C-curve.
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel degree magnets",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               AbsMagnet p(S, 0.2, 0.1); AbsMagnet q(S, 0.5, 0.3); AbsMagnet r(S, 0.8, 0.2); \
               CSnake s({p, q, r}); CSnake t({p, q, r}, ends = \"clamped\", start = {1, 1, 0}, \
               end = {1, -0.5, 0});"
)]
pub struct CSnake<T: Real> {
    /// Magnets of one surface, two or more.
    #[field(min_items = 2)]
    magnets: Vec<Magnet<T>>,
    /// 3 for the cubic spline, 1 for a polyline.
    #[field(default = 3, min = 1, max = 3)]
    degree: usize,
    /// End conditions: "notaknot", "natural", "bessel", "quadratic", "clamped" or "periodic".
    #[field(default = "notaknot")]
    ends: EndRule,
    /// Slope {du/dt, dv/dt, 0} at the start, for clamped ends.
    start: Option<Vec3<T>>,
    /// Slope {du/dt, dv/dt, 0} at the end, for clamped ends.
    end: Option<Vec3<T>>,
}

impl<T: Real> Build<T> for CSnake<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (surface, places) = places(&self.magnets, Self::MAGNETS)?;
        let level = |slope: Option<Vec3<T>>| slope.map(|d| Vec3::new(d.x, d.y, T::zero()));
        let ends =
            clamped_ends(self.ends, level(self.start), level(self.end), [Self::START, Self::END])?;
        let path = match self.degree {
            1 => InterpolatingSpline::polyline(&places),
            2 if places.len() > 3 => InterpolatingSpline::of_type(2, &places),
            _ => InterpolatingSpline::with_ends(&places, ends),
        }
        .map_err(|error| {
            faults::of_interpolation(error, "magnet", [Self::MAGNETS, Self::DEGREE, Self::ENDS])
        })?;
        let names = [0, places.len() - 1].map(|k| self.magnets[k].key);
        snake(surface, path, names, 0)
    }
}

/// A rational B-spline in the parameter plane of a surface, as a NURB-curve.
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel degree knots magnets weights",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               AbsMagnet p(S, 0.2, 0.1); AbsMagnet q(S, 0.5, 0.3); AbsMagnet r(S, 0.8, 0.2); \
               NURBSnake s({p, q, r}, 2, weights = {1, 0.7, 1}); \
               NURBSnake w({p, r}, 2, places = {0.5, 0.3});"
)]
pub struct NURBSnake<T: Real> {
    /// Magnets of one surface, two or more.
    #[field(min_items = 2)]
    magnets: Vec<Magnet<T>>,
    /// Polynomial degree.
    #[field(default = 3, min = 1, max = 25)]
    degree: usize,
    /// Knots, end knots included, ascending.
    knots: Option<Vec<T>>,
    /// Weights of the magnets, positive; those of `places` are between those of the two magnets.
    weights: Option<Vec<T>>,
    /// Control points between the first and the second magnet that are not objects, as u, v, u, v,
    /// ...; there are no other magnets then.
    places: Option<Vec<T>>,
}

impl<T: Real> Build<T> for NURBSnake<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (surface, mut places) = places(&self.magnets, Self::MAGNETS)?;
        let names = [0, places.len() - 1].map(|k| self.magnets[k].key);
        if let Some(between) = &self.places {
            if places.len() != 2 || between.len() % 2 != 0 {
                return Err(CallError::new("out-of-range", "control points between two magnets")
                    .expected("two magnets, and u and v of each control point")
                    .found(format!("{} magnets, {} numbers", places.len(), between.len()))
                    .in_field(Self::PLACES));
            }
            let inner = between.chunks_exact(2).map(|p| Vec3::new(p[0], p[1], T::zero()));
            places.splice(1..1, inner);
        }
        let fields = [Self::MAGNETS, Self::DEGREE, Self::KNOTS, Self::WEIGHTS];
        let path = spline(places, self.degree, self.knots, self.weights, fields)?;
        let clamped = path.clamped_ends();
        let ends = [0, 1].map(|k| if clamped[k] { names[k] } else { None });
        snake(surface, path, ends, 0)
    }
}

/// A conic section in the parameter plane of a surface, as a conic.
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel type m1 m2 m3 a1 a2",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               AbsMagnet p(S, 0.5, 0.5); AbsMagnet q(S, 0.8, 0.4); AbsMagnet r(S, 0.6, 0.7); \
               ConicSnake s(p, q, r, 0.5, 5);"
)]
pub struct ConicSnake<T: Real> {
    /// Centre, or vertex of a parabola.
    m1: Magnet<T>,
    /// The point of angle 0 on an ellipse or hyperbola, on the same surface.
    m2: Magnet<T>,
    /// The end of the conjugate half diameter, on the same surface.
    m3: Magnet<T>,
    /// Start of the snake.
    #[field(angle, default = 0)]
    a1: T,
    /// End angle; default: a full turn.
    #[field(angle, default = std::f64::consts::TAU)]
    a2: T,
    /// 1 for an ellipse, 2 for a hyperbola, 3 for a parabola.
    #[field(default = 1, min = 1, max = 3)]
    r#type: u32,
}

impl<T: Real> Build<T> for ConicSnake<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { m1, m2, m3, a1, a2, r#type } = self;
        let (surface, [centre, p, q]) = three([&m1, &m2, &m3], [Self::M1, Self::M2, Self::M3])?;
        let path = Oblique { centre, first: p - centre, second: q - centre, a1, a2, kind: r#type };
        let ends = path.ends([m2.key, m3.key]);
        snake(surface, path, ends, 0)
    }
}

/// A snake moved to new ends in the parameter plane: w(t) + (1 - t) (w1 - w(0)) + t (w2 - w(1)).
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel snake m1 m2",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               AbsMagnet p(S, 0.2, 0.1); AbsMagnet q(S, 0.5, 0.3); AbsMagnet r(S, 0.8, 0.2); \
               BSnake s({p, q, r}); AbsMagnet a(S, 0.2, 0.5); AbsMagnet b(S, 0.9, 0.7); \
               RelSnake t(s, a, b);"
)]
pub struct RelSnake<T: Real> {
    /// Reference snake.
    snake: Snake<T>,
    /// Start, on the same surface.
    m1: Magnet<T>,
    /// End, on the same surface.
    m2: Magnet<T>,
}

impl<T: Real> Build<T> for RelSnake<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { snake: Snake { curve, surface }, m1, m2 } = self;
        let items = [(curve.key, &surface), (m1.key, &m1.surface), (m2.key, &m2.surface)];
        let fields = [Self::SNAKE, Self::M1, Self::M2];
        common_surface(&items, |fault, k| fault.in_field(fields[k]))?;
        let nesting = curve.depth;
        let path = Moved::path(curve, flat(m1.uv), flat(m2.uv));
        snake(surface, path, [m1.key, m2.key], nesting)
    }
}

/// The snake of another surface with the same path in the parameter plane: X = S(w(t)).
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel snake surface",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               RuledSurf T(m, l); AbsMagnet p(S, 0.2, 0.1); AbsMagnet q(S, 0.8, 0.3); \
               LineSnake s(p, q); CopySnake t(s, T);"
)]
pub struct CopySnake<T: Real> {
    /// Snake with the path.
    snake: Snake<T>,
    /// The target surface.
    surface: SurfaceRef<T>,
}

impl<T: Real> Build<T> for CopySnake<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Snake { curve, .. } = self.snake;
        let nesting = curve.depth;
        snake(self.surface, Path(curve), [None, None], nesting)
    }
}

/// The path of a snake as a curve of its own.
struct Path<T: Real>(CurveRef<T>);

impl<T: Real> Curve<T> for Path<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        self.0.on_surface(t, order).unwrap_or_default()
    }
    fn trace(&self) -> Trace<T> {
        Trace::own()
    }

    fn law(&self) -> Option<std::sync::Arc<dyn Reparametrization<T>>> {
        self.0.law()
    }

    moldloft_num::curve_facts!(breaks of [self.0], open, not_rational);
    moldloft_num::curve_one_by_one!(T);
}
