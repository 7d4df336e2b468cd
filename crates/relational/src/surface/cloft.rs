//! Interpolating lofts: through their master curves. A grid of points builds the loft of each column once.

use super::about::{About, step};
use super::chunk::{Chunk, ChunkQuantity, LANES, Plane, widest};
use super::masters::{Masters, Points};
use crate::arguments::EndRule;
use crate::faults;
use moldloft_num::trace::Edges;
use moldloft_num::{
    Axis, Curve, CurveJet, DerivativeTape, Jet, Order, Real, SurfJet, Surface, Uni1, Uni2, Vec3,
};
use moldloft_registry::{Build, CallError, Context, CurveRef, FieldId, Kind, SurfaceRef, Value};
use moldloft_spline::{End, Ends, InterpolatingSpline, InterpolationError, PiecewiseCubic};
use std::ops::Range;

/// A surface that interpolates its master curves: S(u, v) is the interpolating spline through the
/// points C_1(u) ... C_N(u), evaluated at v; its knots are their chord lengths at that u.
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
               BCurve b({C, D, E}); Line c(F, G); CLoftSurf hull({a, b, c}, divisions = {6, 8}); \
               AbsPoint O(0, -5, 0); AbsPoint X(2, -5, 0); Line shaft(O, X); Line p({0, -5, 1}, {0, -5, 3}); \
               Line q({1, -4.6, 0.9}, {1.2, -4, 2.8}); Line r({2, -4.3, 0.7}, {2.4, -3.2, 2.4}); \
               CLoftSurf blade({p, q, r}, about = shaft);"
)]
pub struct CLoftSurf<T: Real> {
    /// Master curves, two or more, in order of v.
    #[field(min_items = 2)]
    curves: Vec<CurveRef<T>>,
    /// 3 for cubic splines across the masters, 1 for polylines.
    #[field(default = 3, min = 1, max = 3)]
    degree: usize,
    /// End conditions: "notaknot", "natural", "bessel", "quadratic", "clamped" or "periodic".
    #[field(default = "notaknot")]
    ends: EndRule,
    /// Slope dX/dv at the first master, constant along it, for clamped ends.
    start: Option<Vec3<T>>,
    /// Slope dX/dv at the last master, constant along it, for clamped ends.
    end: Option<Vec3<T>>,
    /// A line for lofting in cylindrical coordinates: r, theta (less than half a turn between
    /// masters) and the length along the line, as for blades.
    about: Option<Axis<T>>,
}

/// A surface that interpolates its master curves by an explicit spline at each u: one coordinate is
/// linear in v, the others are cubic splines of that coordinate.
///
/// Unlike those of a C-loft its knots are that coordinate of the masters, which must increase or
/// decrease from master to master at every u.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "relabel axis curves",
    example = "AbsPoint A(0, 0, 2); AbsPoint B(1, 0, -1); AbsPoint C(4, 2, 2); AbsPoint D(4, 1.5, -1); \
               AbsPoint E(4, 0, -1.5); AbsPoint F(8, 1.5, 2); AbsPoint G(8, 0, -0.5); AbsPoint H(9, 1, 2); \
               AbsPoint I(9.5, 0, 0); Line a(A, B); BCurve b({C, D, E}); Line c(F, G); Line d(H, I); \
               XLoftSurf hull(1, {a, b, c, d}); \
               AbsPoint O(0, -5, 0); AbsPoint X(2, -5, 0); Line shaft(O, X); Line p({0, -5, 1}, {0, -5, 3}); \
               Line q({1, -4.6, 0.9}, {1.2, -4, 2.8}); Line r({2, -4.3, 0.7}, {2.4, -3.2, 2.4}); \
               XLoftSurf blade(3, {r, q, p}, about = shaft);"
)]
pub struct XLoftSurf<T: Real> {
    /// The independent coordinate: 1 for x, 2 for y, 3 for z; with `about` 1 for r, 2 for theta, 3 for the
    /// length along the line.
    #[field(default = 1, min = 1, max = 3)]
    axis: usize,
    /// Master curves, two or more, in order of v.
    #[field(min_items = 2)]
    curves: Vec<CurveRef<T>>,
    /// End conditions: "notaknot", "natural", "bessel" or "quadratic".
    #[field(default = "notaknot")]
    ends: EndRule,
    /// A line about which the loft is made in cylinder coordinates, r, theta (within half a turn from master
    /// to master) and the length along it, as for blades.
    about: Option<Axis<T>>,
}

/// The parameters u at which a new loft is tried.
const TRIALS: [f64; 9] = [0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0];

impl<T: Real> CLoftSurf<T> {
    /// The loft through curves, without conditions at its ends.
    pub fn through(curves: Vec<CurveRef<T>>, degree: usize) -> Self {
        Self { curves, degree, ends: EndRule::NotAKnot, start: None, end: None, about: None }
    }
}

impl<T: Real> Build<T> for CLoftSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { curves, degree, ends, start, end, about } = self;
        let count = curves.len();
        if degree == 2 && count > 3 {
            let error = InterpolationError::Type { actual: degree };
            return Err(faults::of_interpolation(
                error,
                "curve",
                [Self::CURVES, Self::DEGREE, Self::ENDS],
            ));
        }
        let slopes = slopes(ends, start, end, [Self::START, Self::END])?;
        let knots = if degree == 1 { Knots::Polyline } else { Knots::Chords };
        let masters = Masters::new(curves, Self::CURVES)?;
        let loft = Loft { masters, knots, ends, slopes, about: about.as_ref().map(About::new) };
        loft.check_off_axis(Self::ABOUT)?;
        if let Some((u, error, _)) = loft.fault(|points| !is_one_point(points)) {
            return Err(faults::of_interpolation(
                error,
                "curve",
                [Self::CURVES, Self::DEGREE, Self::ENDS],
            )
            .help(format!("this happens at u = {u}")));
        }
        Ok(Value::Surface(SurfaceRef::new(loft, context.nesting)))
    }
}

/// The end slopes of a clamped loft.
fn slopes<T: Real>(
    ends: EndRule,
    start: Option<Vec3<T>>,
    end: Option<Vec3<T>>,
    fields: [FieldId; 2],
) -> Result<Option<[Vec3<T>; 2]>, CallError> {
    match (ends, start, end) {
        (EndRule::Clamped, Some(start), Some(end)) => Ok(Some([start, end])),
        (EndRule::Clamped, start, _) => Err(CallError::new(
            "missing-argument",
            "clamped ends need the slopes `start` and `end`",
        )
        .expected("start = {x, y, z}, end = {x, y, z}")
        .in_field(fields[usize::from(start.is_some())])),
        (_, None, None) => Ok(None),
        (_, start, _) => Err(CallError::new("unused-argument", "slopes are for clamped ends only")
            .help("add ends = \"clamped\", or leave the slopes out")
            .in_field(fields[usize::from(start.is_none())])),
    }
}

impl<T: Real> Build<T> for XLoftSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { axis, curves, ends, about } = self;
        if matches!(ends, EndRule::Clamped | EndRule::Periodic) {
            let found = if ends == EndRule::Clamped { "\"clamped\"" } else { "\"periodic\"" };
            let message = format!("an explicit loft has no {found} ends");
            return Err(CallError::new("unknown-ends", message)
                .expected("\"notaknot\", \"natural\", \"bessel\" or \"quadratic\"")
                .found(found)
                .in_field(Self::ENDS));
        }
        let masters = Masters::new(curves, Self::CURVES)?;
        let about = about.as_ref().map(About::new);
        let names = if about.is_some() { ["r", "theta", "s"] } else { ["x", "y", "z"] };
        let loft = Loft { masters, knots: Knots::Axis(axis - 1), ends, slopes: None, about };
        loft.check_off_axis(Self::ABOUT)?;
        if let Some((u, error, points)) = loft.fault(|_| true) {
            let name = names[axis - 1];
            let InterpolationError::Coincident { second, .. } = error else {
                return Err(faults::of_interpolation(
                    error,
                    "curve",
                    [Self::CURVES, Self::CURVES, Self::ENDS],
                ));
            };
            let values: Vec<String> = points.iter().map(|p| p[axis - 1].to_string()).collect();
            let message = format!("{name} is not monotone from curve to curve at u = {u}");
            return Err(CallError::new("not-monotone", message)
                .expected(format!(
                    "{name} increasing, or decreasing, from the first curve to the last"
                ))
                .found(format!("{name} = {}", values.join(", ")))
                .help("take another axis, or a CLoftSurf")
                .in_item(second)
                .in_field(Self::CURVES));
        }
        Ok(Value::Surface(SurfaceRef::new(loft, context.nesting)))
    }
}

/// True when all points are one, to rounding.
fn is_one_point<T: Real>(points: &[Vec3<T>]) -> bool {
    let first = points[0].re();
    let near = |p: Vec3<f64>| p.distance(first) <= 8.0 * f64::EPSILON * p.norm();
    points.iter().all(|p| near(p.re()))
}

#[derive(Clone, Copy)]
enum Knots {
    /// At chord lengths.
    Chords,
    /// At chord lengths, with straight pieces.
    Polyline,
    /// At this coordinate of the points.
    Axis(usize),
}

struct Loft<T: Real> {
    masters: Masters<T>,
    knots: Knots,
    ends: EndRule,
    /// End slopes of clamped ends.
    slopes: Option<[Vec3<T>; 2]>,
    about: Option<About<T>>,
}

impl<T: Real> Loft<T> {
    /// The points of a column, in the coordinates in which it is interpolated.
    fn points<J: Jet<T>>(&self, u: J) -> Points<J> {
        let mut points = self.masters.at(u);
        if let Some(about) = &self.about {
            about.coordinates(&mut points);
        }
        points
    }

    /// The first of the parameters at which a new loft is tried without a spline through its points, if these
    /// are to have one.
    fn fault(
        &self,
        needed: impl Fn(&[Vec3<T>]) -> bool,
    ) -> Option<(f64, InterpolationError, Vec<Vec3>)> {
        TRIALS.into_iter().find_map(|u| {
            let points: Points<T> = self.points(T::from(u));
            let fault = || self.spline(&points).err();
            // Masters may keep what they evaluate, the spline is dropped.
            let error = if T::TAPED { DerivativeTape::unrecorded(fault) } else { fault() };
            let error = error.filter(|_| needed(&points))?;
            Some((u, error, points.iter().map(|p| p.re()).collect()))
        })
    }

    /// On the line itself there is no angle about it.
    fn check_off_axis(&self, field: FieldId) -> Result<(), CallError> {
        let Some(_) = &self.about else { return Ok(()) };
        for u in TRIALS {
            let points: Points<T> = self.points(T::from(u));
            let size = points.iter().map(|p| p.x.re().max(p.z.re().abs())).fold(0.0, f64::max);
            let Some(k) = points.iter().position(|p| p.x.re() <= 1e-9 * size) else { continue };
            return Err(CallError::new("on-axis", "a master meets the line of `about`")
                .expected("masters that keep away from the line")
                .found(format!("curve {} on the line at u = {u}", k + 1))
                .help("end the loft at a small radius, or leave out `about`")
                .in_field(field));
        }
        Ok(())
    }

    fn spline<S: Jet<T>>(
        &self,
        points: &[Vec3<S>],
    ) -> Result<InterpolatingSpline<S>, InterpolationError> {
        let ends = match self.slopes {
            Some([start, end]) => {
                let clamped = |v: Vec3<T>| End::Clamped(v.map(S::fixed));
                Ends::Open(clamped(start), clamped(end))
            }
            None => self.ends.ends().unwrap_or_default(),
        };
        match self.knots {
            Knots::Polyline => InterpolatingSpline::polyline(points),
            Knots::Chords if self.about.is_some() => {
                let mut knots = vec![S::zero()];
                for pair in points.windows(2) {
                    knots.push(knots[knots.len() - 1] + step(pair[0], pair[1]));
                }
                let total = knots[knots.len() - 1];
                if total.re() > 0.0 {
                    knots.iter_mut().for_each(|knot| *knot = *knot / total);
                }
                InterpolatingSpline::with_knots(&knots, points, ends)
            }
            Knots::Chords => InterpolatingSpline::with_ends(points, ends),
            Knots::Axis(axis) => {
                let (first, last) = (points[0][axis], points[points.len() - 1][axis]);
                let share = |p: &Vec3<S>| (p[axis] - first) / (last - first);
                let mut knots: Vec<S> = points.iter().map(share).collect();
                if first.re() == last.re() {
                    // The knots identify the two masters at fault.
                    knots = points.iter().map(|p| p[axis] - first).collect();
                }
                InterpolatingSpline::with_knots(&knots, points, ends)
            }
        }
    }

    /// The masters at which one polynomial across ends and another begins.
    fn joints_across(&self) -> Range<usize> {
        let last = self.masters.curves().len() - 1;
        match (self.knots, self.ends) {
            (Knots::Polyline, _) => 1..last,
            (_, EndRule::NotAKnot) => 2..last - 1,
            (_, EndRule::Bessel | EndRule::Quadratic) if last == 2 => 1..1,
            _ => 1..last,
        }
    }

    /// The spline of one column. Coincident masters, accepted only for a column of one point, have
    /// uniform knots; with a master that is not finite there is no spline.
    fn column<S: Jet<T>>(&self, points: &[Vec3<S>]) -> Option<InterpolatingSpline<S>> {
        let spline = self.spline(points).or_else(|_| {
            let last = (points.len() - 1) as f64;
            let knots: Vec<S> = (0..points.len()).map(|k| S::from(k as f64 / last)).collect();
            InterpolatingSpline::with_knots(&knots, points, Ends::default())
        });
        spline.ok()
    }

    /// Position and derivatives by v on a column, carrying their derivatives by u.
    fn across<J: Jet<T>>(
        &self,
        column: Option<&InterpolatingSpline<J>>,
        v: T,
        order: Order,
    ) -> CurveJet<J> {
        match (column.map(|spline| spline.jet(J::fixed(v), order)), &self.about) {
            (Some(jet), Some(about)) => about.places(jet),
            (Some(jet), None) => jet,
            (None, _) => [nowhere(); 3],
        }
    }

    /// The jets at one u and each of `vs`: the column is interpolated once.
    fn on_column(&self, u: T, vs: &[T], order: Order, jets: &mut [SurfJet<T>]) {
        let zero = SurfJet::default();
        match order {
            Order::Zero => {
                let column = self.column(&self.points(u));
                for (jet, &v) in jets.iter_mut().zip(vs) {
                    *jet = SurfJet { p: self.across(column.as_ref(), v, order)[0], ..zero };
                }
            }
            Order::First => {
                let column = self.column(&self.points(Uni1::parameter(u)));
                for (jet, &v) in jets.iter_mut().zip(vs) {
                    let [p, d, _] = self.across(column.as_ref(), v, order);
                    let (u, v) = (p.map(|a| a.t), d.map(|a| a.f));
                    *jet = SurfJet { p: p.map(|a| a.f), u, v, ..zero };
                }
            }
            Order::Second => {
                let column = self.column(&self.points(Uni2::parameter(u)));
                for (jet, &v) in jets.iter_mut().zip(vs) {
                    let [p, d, dd] = self.across(column.as_ref(), v, order);
                    let (u, v) = (p.map(|a| a.t), d.map(|a| a.f));
                    let (uu, uv, vv) = (p.map(|a| a.tt), d.map(|a| a.t), dd.map(|a| a.f));
                    *jet = SurfJet { p: p.map(|a| a.f), u, v, uu, uv, vv };
                }
            }
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

impl<T: Real> Loft<T> {
    fn column_by_column(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        mut normals: Option<&mut [Vec3<T>]>,
    ) {
        let order = if normals.is_some() { Order::First } else { Order::Zero };
        let places: Vec<T> = vs.iter().map(|&v| T::from(v)).collect();
        let mut jets = vec![SurfJet::default(); vs.len()];
        for (i, &u) in us.iter().enumerate() {
            self.on_column(T::from(u), &places, order, &mut jets);
            for (k, jet) in (i * vs.len()..).zip(&jets) {
                points[k] = jet.p;
                if let Some(normals) = normals.as_deref_mut() {
                    normals[k] = jet.normal();
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
        let mut jet = [SurfJet::default()];
        self.on_column(u, &[v], order, &mut jet);
        jet[0]
    }

    fn line(&self, u: T, vs: &[f64], order: Order) -> Vec<SurfJet<T>> {
        let places: Vec<T> = vs.iter().map(|&v| T::from(v)).collect();
        let mut jets = vec![SurfJet::default(); vs.len()];
        self.on_column(u, &places, order, &mut jets);
        jets
    }

    fn grid(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        normals: Option<&mut [Vec3<T>]>,
    ) {
        if self.about.is_some() {
            return self.column_by_column(us, vs, points, normals);
        }
        widest(
            #[inline(always)]
            || self.columns(us, vs, points, normals),
        );
    }

    /// The knots across the masters depend on u, so no line v = const has jumps of derivatives
    /// alone; none of those lines is reported.
    fn breaks(&self) -> [Vec<f64>; 2] {
        [self.masters.breaks(), Vec::new()]
    }

    fn kinks(&self) -> [Vec<f64>; 2] {
        [self.masters.kinks(), Vec::new()]
    }

    fn between_joints(&self, us: &[f64], shares: &[f64]) -> Option<Vec<Vec3<T>>> {
        let joints = self.joints_across();
        // About an axis the pieces are no cubics.
        if self.about.is_some() || joints.is_empty() {
            return None;
        }
        let mut ends = vec![0, self.masters.curves().len() - 1];
        ends.splice(1..1, joints);
        let mut points = Vec::with_capacity(us.len() * ends.len() * shares.len());
        for &u in us {
            let column = self.column(&self.points(T::from(u)))?;
            let (knots, cubics) = (column.knots(), column.pieces().coefficients());
            for piece in ends.windows(2) {
                let (cubic, width) = (&cubics[piece[0]], knots[piece[1]] - knots[piece[0]]);
                points.extend(shares.iter().map(|&share| along_cubic(cubic, width, share)));
            }
        }
        Some(points)
    }

    fn edge_made_of(&self, k: usize) -> Vec<moldloft_num::trace::Key> {
        self.masters.edge_made_of(k)
    }

    fn edges(&self) -> Edges<T> {
        self.masters.edges()
    }

    moldloft_num::surface_facts!(joints_at_breaks, breaks_along_lines, open, not_rational);
    moldloft_num::surface_one_by_one!(T: scattered);
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

/// The pieces of the spline, each with its interval of `vs` of at most [`LANES`] parameters.
fn stretches<'a, S: Real>(
    spline: &'a PiecewiseCubic<S>,
    vs: &'a [f64],
) -> impl Iterator<Item = (usize, Range<usize>)> + 'a {
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
        if T::TAPED {
            fill_on_tape(&cubic, &s, &mut points[stretch]);
            continue;
        }
        for axis in 0..3 {
            for k in 0..T::PARTS {
                let coefficients = std::array::from_fn(|r| cubic[r][axis].part(k));
                horner(coefficients, &s, stretch.len(), chunk.plane(ChunkQuantity::Point, axis, k));
            }
        }
        chunk.write_points(&mut points[stretch]);
    }
}

/// The cubic at the numbers `s`, each coordinate one node of a tape.
fn fill_on_tape<T: Real>(cubic: &[Vec3<T>; 4], s: &Plane, points: &mut [Vec3<T>]) {
    for (p, &s) in points.iter_mut().zip(s) {
        let coordinate = |axis: usize| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|r| cubic[r][axis]);
            let bent = if d.re() == 0.0 { c.re() } else { d.re() * s + c.re() };
            let value = (bent * s + b.re()) * s + a.re();
            T::linear(value, &[(1.0, a), (s, b), (s * s, c), (s * s * s, d)])
        };
        *p = Vec3::from([0, 1, 2].map(coordinate));
    }
}

/// The cubic at a share of the width of its interval, each coordinate one node of a tape.
fn along_cubic<T: Real>(&[a, b, c, d]: &[Vec3<T>; 4], width: T, share: f64) -> Vec3<T> {
    let s = width.re() * share;
    let coordinate = |axis: usize| {
        let [a, b, c, d] = [a, b, c, d].map(|x| x[axis]);
        let value = ((d.re() * s + c.re()) * s + b.re()) * s + a.re();
        let slope = (3.0 * d.re() * s + 2.0 * c.re()) * s + b.re();
        let terms = [(1.0, a), (s, b), (s * s, c), (s * s * s, d), (share * slope, width)];
        T::linear(value, &terms)
    };
    Vec3::from([0, 1, 2].map(coordinate))
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
                horner(position, &s, n, chunk.plane(ChunkQuantity::Point, axis, k));
                let by_u = std::array::from_fn(|r| cubic[r][axis].t.part(k));
                horner(by_u, &s, n, chunk.plane(ChunkQuantity::ByU, axis, k));
                let [_, b, c, d] = position;
                let (c2, d3) = (c * 2.0, d * 3.0);
                let by_v = chunk.plane(ChunkQuantity::ByV, axis, k);
                for (o, &s) in by_v.iter_mut().zip(&s).take(n) {
                    *o = (d3 * s + c2) * s + b;
                }
            }
        }
        chunk.write_points(&mut points[stretch.clone()]);
        chunk.write_normals(&mut normals[stretch]);
    }
}
