use super::chunk::{Chunk, LANES, Part, Plane, widest};
use super::masters::{Masters, Points};
use crate::arguments::EndRule;
use crate::faults;
use moldloft_num::trace::Edges;
use moldloft_num::{Curve, CurveJet, Jet, Order, Real, SurfJet, Surface, Uni1, Uni2, Vec3};
use moldloft_registry::{Build, Context, CurveRef, Fault, Kind, SurfaceRef, Value};
use moldloft_spline::{Ends, InterpolatingSpline, InterpolationError, PiecewiseCubic};

/// A surface that passes through its master curves: S(u, v) is the interpolating spline through
/// the points C_1(u) ... C_N(u), evaluated at v; its knots are their chord lengths at that u.
///
/// Two masters give rulings, three parabolas, four or more cubic splines, as for a C-curve (Letcher
/// and Shook 1995). Neighbouring masters must not meet, unless all meet in one point.
#[derive(Kind)]
#[kind(
    class = Surface,
    relabel,
    columns = "degree curves",
    example = "AbsPoint A(0, 0, 2); AbsPoint B(1, 0, -1); AbsPoint C(4, 2, 2); AbsPoint D(4, 1.5, -1); \
               AbsPoint E(4, 0, -1.5); AbsPoint F(8, 1.5, 2); AbsPoint G(8, 0, -0.5); Line a(A, B); \
               BCurve b({C, D, E}); Line c(F, G); CLoftSurf hull({a, b, c}, divisions = {6, 8});"
)]
pub struct CLoftSurf<T: Real> {
    /// Master curves, two or more, in order of v.
    #[field(min_items = 2)]
    curves: Vec<CurveRef<T>>,
    /// 3 for cubic splines across the masters, 1 for polylines.
    #[field(default = 3, min = 1, max = 3)]
    degree: usize,
    /// End conditions: "notaknot", "natural", "bessel", "quadratic" or "periodic".
    #[field(default = "notaknot")]
    ends: EndRule,
}

/// The parameters u at which a new loft is tried.
const TRIALS: [f64; 9] = [0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0];

impl<T: Real> Build<T> for CLoftSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, Fault> {
        let Self { curves, degree, ends } = self;
        let count = curves.len();
        if ends == EndRule::Clamped {
            return Err(Fault::new("unknown-ends", "a loft cannot be clamped")
                .expected("\"notaknot\", \"natural\", \"bessel\", \"quadratic\" or \"periodic\"")
                .found("\"clamped\"")
                .in_field(2));
        }
        if degree == 2 && count > 3 {
            let error = InterpolationError::Type { actual: degree };
            return Err(faults::of_interpolation(error, "curve", [0, 1, 2]));
        }
        let loft = Loft { masters: Masters::new(curves, 0)?, polyline: degree == 1, ends };
        for u in TRIALS {
            let points: Points<f64> =
                loft.masters.at(T::from(u)).into_iter().map(|p| p.re()).collect();
            if let Err(error) = loft.spline(&points)
                && !is_one_point(&points)
            {
                return Err(faults::of_interpolation(error, "curve", [0, 1, 2])
                    .help(format!("this happens at u = {u}")));
            }
        }
        Ok(Value::Surface(SurfaceRef::new(loft, context.nesting)))
    }
}

/// True when all points are one, to rounding.
fn is_one_point(points: &[Vec3<f64>]) -> bool {
    let near = |p: &Vec3<f64>| p.distance(points[0]) <= 8.0 * f64::EPSILON * p.norm();
    points.iter().all(near)
}

struct Loft<T: Real> {
    masters: Masters<T>,
    polyline: bool,
    ends: EndRule,
}

impl<T: Real> Loft<T> {
    fn spline<S: Real>(
        &self,
        points: &[Vec3<S>],
    ) -> Result<InterpolatingSpline<S>, InterpolationError> {
        if self.polyline {
            return InterpolatingSpline::polyline(points);
        }
        let ends = self.ends.ends().unwrap_or_default();
        InterpolatingSpline::with_ends(points, ends)
    }

    /// The spline of one column. Where masters meet, which only a column that is one point was let
    /// pass with, its knots are uniform; where a master is not finite there is none.
    fn column<S: Real>(&self, points: &[Vec3<S>]) -> Option<InterpolatingSpline<S>> {
        let spline = self.spline(points).or_else(|_| {
            let last = (points.len() - 1) as f64;
            let knots: Vec<S> = (0..points.len()).map(|k| S::from(k as f64 / last)).collect();
            InterpolatingSpline::with_knots(&knots, points, Ends::default())
        });
        spline.ok()
    }

    /// Position and derivatives by v, carrying their derivatives by u.
    fn across<J: Jet<T>>(&self, u: J, v: T, order: Order) -> CurveJet<J> {
        match self.column(&self.masters.at(u)) {
            Some(spline) => spline.jet(J::fixed(v), order),
            None => [nowhere(); 3],
        }
    }

    #[inline(always)]
    fn columns(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        mut normals: Option<&mut [Vec3<T>]>,
    ) {
        let mut chunk = Chunk::new();
        for (i, &u) in us.iter().enumerate() {
            let row = i * vs.len()..(i + 1) * vs.len();
            let points = &mut points[row.clone()];
            let Some(normals) = normals.as_deref_mut() else {
                match self.column(&self.masters.at(T::from(u))) {
                    Some(spline) => fill(spline.pieces(), vs, &mut chunk, points),
                    None => points.fill(nowhere()),
                }
                continue;
            };
            let normals = &mut normals[row];
            match self.column(&self.masters.with_slopes(u)) {
                Some(spline) => {
                    fill_with_normals(spline.pieces(), vs, &mut chunk, points, normals);
                }
                None => {
                    points.fill(nowhere());
                    normals.fill(Vec3::zero());
                }
            }
        }
    }
}

fn nowhere<S: Real>() -> Vec3<S> {
    Vec3::of(f64::NAN, f64::NAN, f64::NAN)
}

impl<T: Real> Surface<T> for Loft<T> {
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        let mut jet = SurfJet::default();
        match order {
            Order::Zero => jet.p = self.across(u, v, order)[0],
            Order::First => {
                let [p, d, _] = self.across(Uni1::parameter(u), v, order);
                (jet.p, jet.u, jet.v) = (p.map(|a| a.f), p.map(|a| a.t), d.map(|a| a.f));
            }
            Order::Second => {
                let [p, d, dd] = self.across(Uni2::parameter(u), v, order);
                (jet.p, jet.u, jet.v) = (p.map(|a| a.f), p.map(|a| a.t), d.map(|a| a.f));
                (jet.uu, jet.uv, jet.vv) = (p.map(|a| a.tt), d.map(|a| a.t), dd.map(|a| a.f));
            }
        }
        jet
    }

    fn grid(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        normals: Option<&mut [Vec3<T>]>,
    ) {
        widest(
            #[inline(always)]
            || self.columns(us, vs, points, normals),
        );
    }

    /// The knots across the masters move with u, so no line v = const is one at which only
    /// derivatives jump; of those lines none is told.
    fn breaks(&self) -> [Vec<f64>; 2] {
        [self.masters.breaks(), Vec::new()]
    }

    fn edges(&self) -> Edges<T> {
        self.masters.edges()
    }
}

/// A cubic in s = v - base, with plain `base`: its knot's derivatives are in the coefficients.
fn rebased<S: Real>(spline: &PiecewiseCubic<S>, piece: usize) -> (f64, [Vec3<S>; 4]) {
    let (knot, [a, b, c, d]) = (spline.knots()[piece], spline.coefficients()[piece]);
    let base = knot.re();
    if knot.is_constant() {
        return (base, [a, b, c, d]);
    }
    // v - knot = s + shift, where the shift is zero but for its derivatives.
    let shift = -knot + base;
    let (double, triple) = (shift * 2.0, shift * 3.0);
    let bent = c + d * shift;
    (
        base,
        [
            a + (b + bent * shift) * shift,
            b + (c * double) + d * (triple * shift),
            c + d * triple,
            d,
        ],
    )
}

/// The pieces of the spline with the stretch of `vs`, at most [`LANES`] long, that each serves.
fn stretches<'a, S: Real>(
    spline: &'a PiecewiseCubic<S>,
    vs: &'a [f64],
) -> impl Iterator<Item = (usize, std::ops::Range<usize>)> + 'a {
    let knots = spline.knots();
    let last = knots.len() - 1;
    let mut begin = 0;
    std::iter::from_fn(move || {
        let v = *vs.get(begin)?;
        let first = knots[1..].iter().take_while(|k| k.re() <= v).count();
        let low = if first == 0 { f64::NEG_INFINITY } else { knots[first].re() };
        let high = if first == last { f64::INFINITY } else { knots[first + 1].re() };
        let rest = &vs[begin..(begin + LANES).min(vs.len())];
        let length = rest.iter().position(|&v| v < low || v >= high).unwrap_or(rest.len());
        let end = begin + length;
        let stretch = begin..end;
        begin = end;
        Some((first, stretch))
    })
}

#[inline(always)]
fn steps(vs: &[f64], base: f64) -> Plane {
    let mut s = [0.0; LANES];
    for (s, &v) in s.iter_mut().zip(vs) {
        *s = v - base;
    }
    s
}

/// The cubic of coefficients `[a, b, c, d]` at the first `n` of the numbers `s`.
#[inline(always)]
fn horner([a, b, c, d]: [f64; 4], s: &Plane, n: usize, out: &mut Plane) {
    let out = out.iter_mut().zip(s).take(n);
    // Parabolas are frequent: lofts through three masters.
    if d == 0.0 {
        out.for_each(|(o, &s)| *o = (c * s + b) * s + a);
    } else {
        out.for_each(|(o, &s)| *o = ((d * s + c) * s + b) * s + a);
    }
}

#[inline(always)]
fn fill<T: Real>(
    spline: &PiecewiseCubic<T>,
    vs: &[f64],
    chunk: &mut Chunk<T>,
    points: &mut [Vec3<T>],
) {
    for (piece, stretch) in stretches(spline, vs) {
        let (base, cubic) = rebased(spline, piece);
        let s = steps(&vs[stretch.clone()], base);
        for axis in 0..3 {
            for k in 0..T::PARTS {
                let coefficients = std::array::from_fn(|r| cubic[r][axis].part(k));
                horner(coefficients, &s, stretch.len(), chunk.plane(Part::Point, axis, k));
            }
        }
        chunk.write_points(&mut points[stretch]);
    }
}

#[inline(always)]
fn fill_with_normals<T: Real>(
    spline: &PiecewiseCubic<Uni1<T>>,
    vs: &[f64],
    chunk: &mut Chunk<T>,
    points: &mut [Vec3<T>],
    normals: &mut [Vec3<T>],
) {
    for (piece, stretch) in stretches(spline, vs) {
        let (base, cubic) = rebased(spline, piece);
        let (s, n) = (steps(&vs[stretch.clone()], base), stretch.len());
        for axis in 0..3 {
            for k in 0..T::PARTS {
                let position: [f64; 4] = std::array::from_fn(|r| cubic[r][axis].f.part(k));
                horner(position, &s, n, chunk.plane(Part::Point, axis, k));
                let by_u = std::array::from_fn(|r| cubic[r][axis].t.part(k));
                horner(by_u, &s, n, chunk.plane(Part::ByU, axis, k));
                let [_, b, c, d] = position;
                let (c2, d3) = (c * 2.0, d * 3.0);
                let by_v = chunk.plane(Part::ByV, axis, k);
                for (o, &s) in by_v.iter_mut().zip(&s).take(n) {
                    *o = (d3 * s + c2) * s + b;
                }
            }
        }
        chunk.write_points(&mut points[stretch.clone()]);
        chunk.write_normals(&mut normals[stretch]);
    }
}
