//! Intersections of a surface with a plane or another surface: marching along them.
//!
//! A point of the intersection has the unknowns (u, v) on the first surface and, on a second
//! surface, (p, r). A step is along the tangent n1 x n2 and is corrected by Newton's method in the
//! normal plane. Branches end at the edges of the surfaces, or return to their start. An edge that
//! is joined to its own opposite edge (the seam of a cylinder) is not an end: the branch continues
//! from the opposite edge, with two stations at the same point. The same applies where a surface
//! has a crease along one of its joints and the branch turns by more than a step may.
//!
//! The search for all branches is in [`crate::branches`].

use crate::cells::{Lanes, Polynomials};
use crate::implicit::solve;
use crate::newton::{OUTSIDE, UnknownBounds, newton};
use crate::pieces::size_of;
use crate::predictor::predict;
use moldloft_num::period::closed_sides;
use moldloft_num::{Box3, Field, Order, Plane, SurfJet, Surface, Vec3, slope_scale};

/// Unknowns of a point of an intersection: (u, v, p, r), the last two 0 for a plane.
pub type Unknowns = [f64; 4];

/// The shape that the first surface is intersected with.
#[derive(Clone, Copy)]
pub enum Other<'a> {
    /// A plane.
    Plane(Plane<f64>),
    /// A surface.
    Surface(&'a dyn Surface<f64>),
    /// The zero set of an implicit function.
    Level(&'a dyn Field<f64>),
}

/// A surface and the shape it is intersected with.
#[derive(Clone, Copy)]
pub struct Crossing<'a> {
    /// The surface.
    pub first: &'a dyn Surface<f64>,
    /// The plane or the other surface.
    pub other: Other<'a>,
    /// The reference length of accuracies.
    pub size: f64,
    /// For each unknown, true if its 0 and 1 are the same seam of a closed surface.
    pub closed: [bool; 4],
    /// The pieces of both surfaces where they are at hand and the surfaces themselves, to rounding.
    pub(crate) quick: [Option<&'a Polynomials>; 2],
}

/// A point of an intersection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracePoint {
    /// The unknowns.
    pub q: Unknowns,
    /// Derivatives of the unknowns by arc length along the branch.
    pub rate: Unknowns,
    /// Position.
    pub x: Vec3,
    /// The unit tangent of the branch.
    pub tangent: Vec3,
}

/// Why a branch ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BranchEnd {
    /// Unknown `k` reached `value`, an edge of a surface.
    Edge {
        /// Index of the unknown.
        unknown: usize,
        /// 0 or 1.
        value: f64,
    },
    /// The branch returned to its start.
    Closed,
    /// The surfaces are tangent there, so the branch has no direction.
    Tangent,
    /// The maximum number of steps was reached.
    Lost,
}

/// A connected part of an intersection.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// Points along it; on a closed branch the last equals the first.
    pub stations: Vec<TracePoint>,
    /// Reasons why the branch ends, at its start and its end.
    pub ends: [BranchEnd; 2],
}

impl Branch {
    /// True when the branch returns to its start.
    pub fn closed(&self) -> bool {
        self.ends[0] == BranchEnd::Closed
    }
}

/// Distance in parameters from a crease of the start of a branch that would begin on it.
const BESIDE: f64 = 1e-4;

/// The most steps of a branch.
const MOST_STATIONS: usize = 20_000;

/// No branch begins at a point where the sine of the angle is less than this.
pub(crate) const TANGENT: f64 = 1e-5;

/// Length of a step, relative to the size, after which the error (its square) is below rounding.
const CLOSE: f64 = 1e-8;

/// Both shapes at a point, and the residuals of the equations there, as lengths.
struct MarchResidual {
    /// Between the shapes.
    gap: f64,
    /// Distance from the normal plane.
    off: f64,
    /// Normal of the second shape; not normalised.
    normal: Vec3,
    j: Tangents,
    k: Option<Tangents>,
}

/// When a few Newton steps are enough.
#[derive(Clone, Copy, PartialEq)]
enum Until {
    /// The residual is zero to rounding.
    There,
    /// The last step is [`CLOSE`].
    Close,
    /// That, or the error after it is below rounding.
    Near,
}

/// Position and first derivatives of a surface.
type Tangents = [Vec3; 3];

#[inline]
fn tangents(surface: &dyn Surface<f64>, u: f64, v: f64) -> Tangents {
    let j = surface.jet(u, v, Order::First);
    [j.p, j.u, j.v]
}

/// The turn between neighbours that steps aim at, and cosine of the largest, 0.43 rad.
const TURN: f64 = 0.28;
const LARGEST_TURN: f64 = 0.909;

/// Length of a step, relative to the size, after which the iteration on a branch may end, if the
/// last two steps show that the error is below rounding.
const LAST_STEP: f64 = 1e-7;

/// At a crease the surface, and with it the branch, turns by an angle of at least this cosine.
const CREASE: f64 = 0.9999;

/// A station is at a joint if its parameter differs from that by rounding.
const AT_JOINT: f64 = 1e-12;

/// A distance from a joint that separates its sides.
const SAME_POINT: f64 = 1e-9;

/// Maximum deviation of a step's end from the extrapolation of the last two stations, relative to
/// the step: larger ones indicate another branch, or a bend that requires shorter steps.
const MAX_STEP_DEVIATION: f64 = 0.05;

/// Steps of a walk, relative to the size: the first, the longest, the least.
const STEPS: [f64; 3] = [1.0 / 48.0, 1.0 / 24.0, 1e-8];

impl<'a> Crossing<'a> {
    /// A surface and a plane.
    pub fn with_plane(first: &'a dyn Surface<f64>, plane: Plane<f64>) -> Self {
        let size = size_by_samples(first);
        let [u, v] = closed_sides(first);
        Self {
            first,
            other: Other::Plane(plane),
            size,
            closed: [u, v, false, false],
            quick: [None; 2],
        }
    }

    /// Two surfaces.
    pub fn with_surface(first: &'a dyn Surface<f64>, second: &'a dyn Surface<f64>) -> Self {
        let size = size_by_samples(first).min(size_by_samples(second));
        let ([u, v], [p, r]) = (closed_sides(first), closed_sides(second));
        Self { first, other: Other::Surface(second), size, closed: [u, v, p, r], quick: [None; 2] }
    }

    /// A surface and the zero set of an implicit function.
    pub fn with_level(first: &'a dyn Surface<f64>, field: &'a dyn Field<f64>) -> Self {
        let size = size_by_samples(first);
        let [u, v] = closed_sides(first);
        Self {
            first,
            other: Other::Level(field),
            size,
            closed: [u, v, false, false],
            quick: [None; 2],
        }
    }

    /// For single points of an intersection, given the size; branches are not followed across
    /// seams.
    pub fn local(first: &'a dyn Surface<f64>, other: Other<'a>, size: f64) -> Self {
        Self { first, other, size, closed: [false; 4], quick: [None; 2] }
    }

    /// The number of unknowns.
    pub fn unknowns(&self) -> usize {
        match self.other {
            Other::Plane(_) | Other::Level(_) => 2,
            Other::Surface(_) => 4,
        }
    }

    /// The solution near `guess` with one more equation: `extra` gives its value, a length, and
    /// its derivatives by the unknowns, from the unknowns and the first surface's jet.
    fn solved(
        &self,
        guess: Unknowns,
        extra: impl Fn(Unknowns, &SurfJet<f64>) -> (f64, Unknowns),
    ) -> Option<Unknowns> {
        let wide = UnknownBounds { low: -0.5, high: 1.5, step: 0.2 };
        match self.other {
            Other::Plane(plane) => {
                let walk = newton([guess[0], guess[1]], &[wide; 2], self.size, |[u, v]| {
                    let j = self.first.jet(u, v, Order::First);
                    let (e, de) = extra([u, v, 0.0, 0.0], &j);
                    let n = plane.normal;
                    ([plane.distance(j.p), e], [[n.dot(j.u), n.dot(j.v)], [de[0], de[1]]])
                });
                walk.found.then_some([walk.at[0], walk.at[1], 0.0, 0.0])
            }
            Other::Level(field) => {
                // As a length, by the gradient where the walk begins.
                let begin = self.first.jet(guess[0], guess[1], Order::Zero).p;
                let scale = slope_scale(field.value_and_gradient(begin).1);
                let walk = newton([guess[0], guess[1]], &[wide; 2], self.size, |[u, v]| {
                    let j = self.first.jet(u, v, Order::First);
                    let (e, de) = extra([u, v, 0.0, 0.0], &j);
                    let (f, g) = field.value_and_gradient(j.p);
                    let g = g * scale;
                    ([f * scale, e], [[g.dot(j.u), g.dot(j.v)], [de[0], de[1]]])
                });
                walk.found.then_some([walk.at[0], walk.at[1], 0.0, 0.0])
            }
            Other::Surface(second) => {
                let walk = newton(guess, &[wide; 4], self.size, |q| {
                    let j = self.first.jet(q[0], q[1], Order::First);
                    let k = second.jet(q[2], q[3], Order::First);
                    let (e, de) = extra(q, &j);
                    let r = (j.p - k.p).to_array();
                    let c = [j.u, j.v, -k.u, -k.v].map(Vec3::to_array);
                    let row = |a: usize| [c[0][a], c[1][a], c[2][a], c[3][a]];
                    ([r[0], r[1], r[2], e], [row(0), row(1), row(2), de])
                });
                walk.found.then_some(walk.at)
            }
        }
    }

    /// The point of the intersection in the plane through `x` perpendicular to `d`, near `guess`.
    pub fn across(&self, guess: Unknowns, x: Vec3, d: Vec3) -> Option<Unknowns> {
        self.solved(guess, |_, j| (d.dot(j.p - x), [d.dot(j.u), d.dot(j.v), 0.0, 0.0]))
    }

    /// As `across`, from a guess that is usually good: some plain Newton steps before damped ones.
    pub fn across_near(&self, guess: Unknowns, x: Vec3, d: Vec3) -> Option<Unknowns> {
        let settled = self.settled(guess, x, d).map(|s| s.q);
        settled.or_else(|| self.across(guess, x, d))
    }

    /// As `across`, from a guess with half of the digits, which one Newton step doubles. After a
    /// longer step the iteration continues.
    pub fn across_close(&self, guess: Unknowns, x: Vec3, d: Vec3) -> Option<Unknowns> {
        let view = self.view(guess, x, d);
        if let Some((q, way)) = self.next(guess, &view, d)
            && way <= CLOSE * self.size
        {
            return Some(q);
        }
        self.across_near(guess, x, d)
    }

    /// The point of the intersection in the plane through `x` perpendicular to `d`, with its
    /// tangent, from a guess that is usually good.
    pub fn station_across(&self, guess: Unknowns, x: Vec3, d: Vec3) -> Option<TracePoint> {
        let q = self.steps(guess, x, d, Until::Close).map(|s| s.q);
        self.station(q.or_else(|| self.across(guess, x, d))?)
    }

    /// The point of the intersection with a given value of unknown `k`, near `guess`.
    pub fn at_line(&self, guess: Unknowns, k: usize, value: f64) -> Option<Unknowns> {
        let size = self.size;
        self.solved(guess, |q, _| {
            let mut d = [0.0; 4];
            d[k] = size;
            (size * (q[k] - value), d)
        })
    }

    /// Both shapes at a point, the first one's unit normal, and a normal of the second.
    fn normals(&self, q: Unknowns) -> (Tangents, Option<Tangents>, Vec3, Vec3) {
        let view = self.view(q, Vec3::zero(), Vec3::zero());
        let [_, u, v] = view.j;
        (view.j, view.k, u.cross(v).normalized().unwrap_or_default(), view.normal)
    }

    /// The direction n1 x n2 at a point that may be off the intersection; its length is the sine of
    /// the angle between the shapes.
    pub fn direction(&self, q: Unknowns) -> Vec3 {
        let (_, _, a, b) = self.normals(q);
        a.cross(b.normalized().unwrap_or_default())
    }

    /// Distance of two points with nearly the same unknowns: the larger of the distances on both
    /// shapes.
    pub fn distance(&self, a: &Unknowns, b: &Unknowns) -> f64 {
        let on = |surface: &dyn Surface<f64>, k: usize| {
            let j = surface.jet(a[k], a[k + 1], Order::First);
            (j.u * (b[k] - a[k]) + j.v * (b[k + 1] - a[k + 1])).norm()
        };
        match self.other {
            Other::Surface(second) => on(self.first, 0).max(on(second, 2)),
            Other::Plane(_) | Other::Level(_) => on(self.first, 0),
        }
    }

    /// The point with its tangent; `None` if the shapes are tangent there.
    pub fn station(&self, q: Unknowns) -> Option<TracePoint> {
        let (j, k, _, b) = self.normals(q);
        self.station_of(q, &j, k.as_ref(), b)
    }

    #[inline(always)]
    fn station_of(
        &self,
        q: Unknowns,
        j: &Tangents,
        k: Option<&Tangents>,
        normal: Vec3,
    ) -> Option<TracePoint> {
        let m = j[1].cross(j[2]);
        let d = m.cross(normal);
        let length = d.norm();
        let whole = (m.norm_sq() * normal.norm_sq()).sqrt();
        if !(length >= 1e-7 * whole && length > 0.0) {
            return None;
        }
        let tangent = d / length;
        let along = |[_, u, v]: &Tangents| {
            let m = [[u.norm_sq(), u.dot(*v)], [u.dot(*v), v.norm_sq()]];
            solve(&m, [tangent.dot(*u), tangent.dot(*v)])
        };
        let [u, v] = along(j)?;
        let [p, r] = match k {
            Some(k) => along(k)?,
            None => [0.0; 2],
        };
        Some(TracePoint { q, rate: [u, v, p, r], x: j[0], tangent })
    }

    /// Both shapes near the point in the plane through `x` normal to `d`.
    fn view(&self, q: Unknowns, x: Vec3, d: Vec3) -> MarchResidual {
        struct Look<'a>(&'a Crossing<'a>, Unknowns, [Vec3; 2]);
        impl pulp::WithSimd for Look<'_> {
            type Output = MarchResidual;

            #[inline(always)]
            fn with_simd<S: pulp::Simd>(self, simd: S) -> MarchResidual {
                let Self(crossing, q, [x, d]) = self;
                crossing.view_by(simd, q, x, d)
            }
        }
        Lanes::new().run(Look(self, q, [x, d]))
    }

    /// Both shapes near the point, by the registers at hand.
    #[inline(always)]
    fn view_by<S: pulp::Simd>(&self, simd: S, q: Unknowns, x: Vec3, d: Vec3) -> MarchResidual {
        if let [Some(a), Some(b)] = self.quick {
            let [j, k] = Polynomials::both(simd, a, b, q);
            let (gap, off) = ((j[0] - k[0]).norm(), d.dot(j[0] - x));
            return MarchResidual { gap, off, normal: k[1].cross(k[2]), j, k: Some(k) };
        }
        let j = tangents(self.first, q[0], q[1]);
        let off = d.dot(j[0] - x);
        match self.other {
            Other::Plane(plane) => {
                MarchResidual { gap: plane.distance(j[0]), off, normal: plane.normal, j, k: None }
            }
            Other::Level(field) => {
                // As a length, by the gradient.
                let (f, g) = field.value_and_gradient(j[0]);
                let scale = slope_scale(g);
                MarchResidual { gap: f * scale, off, normal: g * scale, j, k: None }
            }
            Other::Surface(second) => {
                let k = tangents(second, q[2], q[3]);
                let gap = (j[0] - k[0]).norm();
                MarchResidual { gap, off, normal: k[1].cross(k[2]), j, k: Some(k) }
            }
        }
    }

    /// The result of a Newton step, and the length of the step in space.
    #[inline(always)]
    fn next(&self, q: Unknowns, view: &MarchResidual, d: Vec3) -> Option<(Unknowns, f64)> {
        let ([p, u, v], n) = (view.j, view.normal);
        let m = [[n.dot(u), n.dot(v)], [d.dot(u), d.dot(v)]];
        let Some([s, k, l]) = view.k else {
            let [du, dv] = solve(&m, [view.gap, view.off])?;
            return Some(([q[0] - du, q[1] - dv, 0.0, 0.0], (u * du + v * dv).norm()));
        };
        // The second surface's plane cuts the plane across: two unknowns are left.
        let gap = p - s;
        let [du, dv] = solve(&m, [n.dot(gap), view.off])?;
        let way = u * du + v * dv;
        let rest = gap - way;
        let m = [[k.norm_sq(), k.dot(l)], [k.dot(l), l.norm_sq()]];
        let by = [k.dot(rest), l.dot(rest)];
        let [dp, dr] = solve(&m, by)?;
        let way = way.norm().max(rest.norm());
        Some(([q[0] - du, q[1] - dv, q[2] + dp, q[3] + dr], way))
    }

    /// A few plain Newton steps from a good guess towards the point in the plane through `x` across
    /// `d`; `None` when they do not settle at once.
    pub(crate) fn settled(&self, guess: Unknowns, x: Vec3, d: Vec3) -> Option<TracePoint> {
        self.steps(guess, x, d, Until::There)
    }

    fn steps(&self, guess: Unknowns, x: Vec3, d: Vec3, until: Until) -> Option<TracePoint> {
        struct NewtonSteps<'a>(&'a Crossing<'a>, Unknowns, [Vec3; 2], Until);
        impl pulp::WithSimd for NewtonSteps<'_> {
            type Output = Option<TracePoint>;

            #[inline(always)]
            fn with_simd<S: pulp::Simd>(self, simd: S) -> Option<TracePoint> {
                let Self(crossing, guess, [x, d], until) = self;
                crossing.steps_by(simd, guess, [x, d], until)
            }
        }
        Lanes::new().run(NewtonSteps(self, guess, [x, d], until))
    }

    /// Newton steps up to one so short that nothing is evaluated again: the tangent is then that of
    /// the previous point.
    #[inline(always)]
    fn steps_by<S: pulp::Simd>(
        &self,
        simd: S,
        guess: Unknowns,
        [x, d]: [Vec3; 2],
        until: Until,
    ) -> Option<TracePoint> {
        let mut q = guess;
        let goal = 1e-13 * self.size;
        let mut before = 0.0;
        for round in 0..6 {
            let goal = if round < 5 { goal } else { 10.0 * goal };
            let view = self.view_by(simd, q, x, d);
            let station = |q: Unknowns| self.station_of(q, &view.j, view.k.as_ref(), view.normal);
            if until == Until::There && view.gap.abs().max(view.off.abs()) <= goal {
                return station(q);
            }
            let (next, way) = self.next(q, &view, d)?;
            let last = match until {
                Until::There => false,
                Until::Close => way <= CLOSE * self.size,
                // Each error is a multiple of the square of the one before.
                Until::Near => {
                    way <= CLOSE * self.size
                        || way <= LAST_STEP * self.size && way * way * way <= goal * before * before
                }
            };
            before = way;
            if last {
                let [u, v, ..] = std::array::from_fn::<f64, 4, _>(|k| next[k] - q[k]);
                return Some(TracePoint {
                    x: view.j[0] + view.j[1] * u + view.j[2] * v,
                    ..station(next)?
                });
            }
            q = next;
            let most = if round == 0 { 0.5 } else { 0.1 };
            if !(0..4).all(|k| (q[k] - guess[k]).abs() < most) {
                return None;
            }
        }
        None
    }

    /// One direction from a station until an edge, the start, or a contact.
    fn walk(&self, start: TracePoint, sign: f64) -> (Vec<TracePoint>, BranchEnd) {
        struct Walk<'a>(&'a Crossing<'a>, TracePoint, f64);
        impl pulp::WithSimd for Walk<'_> {
            type Output = (Vec<TracePoint>, BranchEnd);

            #[inline(always)]
            fn with_simd<S: pulp::Simd>(self, simd: S) -> (Vec<TracePoint>, BranchEnd) {
                let Self(crossing, start, sign) = self;
                crossing.walk_by(simd, start, sign)
            }
        }
        Lanes::new().run(Walk(self, start, sign))
    }

    #[inline(always)]
    fn walk_by<S: pulp::Simd>(
        &self,
        simd: S,
        start: TracePoint,
        sign: f64,
    ) -> (Vec<TracePoint>, BranchEnd) {
        let n = self.unknowns();
        let mut all = vec![start];
        let [first, longest, least] = STEPS.map(|share| share * self.size);
        let mut step = first;
        // The stations since the last seam or crease: the two before tell where the next one is.
        let mut since = 0;
        let lines = self.lines();
        while all.len() < MOST_STATIONS {
            let last = *all.last().expect("it begins with one");
            // Not more than a tenth of a surface at once.
            let fastest = last.rate[..n].iter().fold(0.0_f64, |a, r| a.max(r.abs()));
            step = step.min(0.1 / fastest);
            let tangent = last.tangent * sign;
            let (guess, ahead) = if since > 0 {
                onward(&all[all.len() - 2], &last, step, sign)
            } else {
                let q = std::array::from_fn(|k| last.q[k] + sign * step * last.rate[k]);
                (q, last.x + tangent * step)
            };
            let x = last.x + tangent * step;
            let near = if since > 0 { MAX_STEP_DEVIATION * step } else { 1.5 * step };
            // A better guess; not used to detect deviations, since its steps would differ.
            let guess = match &all[..] {
                [.., a, b, c] if since > 1 => predict([a, b, c], step, sign),
                _ => guess,
            };
            let next = self
                .steps_by(simd, guess, [x, last.tangent], Until::Near)
                .or_else(|| {
                    // Shorter steps are cheaper than damped ones.
                    let short = step < 0.1 * first;
                    short
                        .then(|| self.across(guess, x, last.tangent))
                        .flatten()
                        .and_then(|q| self.station(q))
                })
                .filter(|s| {
                    s.tangent.dot(last.tangent) > LARGEST_TURN
                        && s.x.distance(last.x) < 1.5 * step
                        && s.x.distance(ahead) < near
                });
            let Some(next) = next else {
                if let Some(both) = self.crease(&lines, &last, guess, sign) {
                    if self.over_crease(&mut all, &start, both, sign) {
                        return (all, BranchEnd::Closed);
                    }
                    since = 0;
                    continue;
                }
                if let Some(edge) = self.sharp_seam(&last, guess, step, sign) {
                    if let Some(end) = self.over_edge(&mut all, &start, edge) {
                        return (all, end);
                    }
                    since = 0;
                    continue;
                }
                step *= 0.5;
                if step < least {
                    return (all, BranchEnd::Tangent);
                }
                continue;
            };
            let out = |q: Unknowns| q[..n].iter().any(|x| *x < -1e-12 || *x > 1.0 + 1e-12);
            if out(next.q) {
                let Some((station, end)) = self.edge_between(&last, &next) else {
                    step *= 0.5;
                    if step < least {
                        return (all, BranchEnd::Lost);
                    }
                    continue;
                };
                if let Some(both) = self.crease(&lines, &last, station.q, sign) {
                    if self.over_crease(&mut all, &start, both, sign) {
                        return (all, BranchEnd::Closed);
                    }
                    since = 0;
                    continue;
                }
                // The start may be between the last station and the edge.
                if all.len() > 2 && self.passes(&start, [&last, &station], sign) {
                    self.close(&mut all, &lines, start, sign);
                    return (all, BranchEnd::Closed);
                }
                if let Some(end) = self.over_edge(&mut all, &start, (station, end)) {
                    return (all, end);
                }
                since = 0;
                continue;
            }
            if strays(&last, &next, sign, n) {
                // It leaves and comes back in between.
                step *= 0.5;
                if step < least {
                    return (all, BranchEnd::Lost);
                }
                continue;
            }
            if all.len() > 2 && self.passes(&start, [&last, &next], sign) {
                self.close(&mut all, &lines, start, sign);
                return (all, BranchEnd::Closed);
            }
            if let Some(both) = self.crease(&lines, &last, next.q, sign) {
                // A bend within the step: the continuation is on one side of it.
                if self.over_crease(&mut all, &start, both, sign) {
                    return (all, BranchEnd::Closed);
                }
                since = 0;
                continue;
            }
            let turn = next.tangent.distance(last.tangent);
            all.push(next);
            since += 1;
            step = (step * (TURN / turn).clamp(0.5, 1.5)).min(longest);
        }
        (all, BranchEnd::Lost)
    }

    /// Continues a branch to both stations at a crease, or closes it if its start is in front of them.
    fn over_crease(
        &self,
        branch: &mut Vec<TracePoint>,
        start: &TracePoint,
        both: [TracePoint; 2],
        sign: f64,
    ) -> bool {
        let last = *branch.last().expect("it begins with the start");
        let closes = branch.len() > 2 && self.passes(start, [&last, &both[0]], sign);
        match closes {
            true => branch.push(*start),
            false => self.extend_over_crease(branch, both),
        }
        closes
    }

    /// True if the branch passes its start between two stations.
    fn passes(&self, start: &TracePoint, [last, next]: [&TracePoint; 2], sign: f64) -> bool {
        let [before, after] =
            [last, next].map(|station| (station.x - start.x).dot(start.tangent) * sign);
        let (away, way) = (start.x - last.x, next.x - last.x);
        if !(before < 0.0 && after >= 0.0 && away.norm() <= 1.01 * way.norm()) {
            return false;
        }
        let share = away.dot(way) / way.norm_sq();
        // Near a pole one step spans a large part of the turn.
        let same = |k: usize| {
            let spanned = (next.q[k] - last.q[k]).abs();
            (last.q[k] - start.q[k]).abs() < f64::max(0.3, spanned)
        };
        away.distance(way * share) <= 0.1 * way.norm()
            && last.tangent.dot(start.tangent) > 0.5
            && (0..self.unknowns()).all(same)
    }

    /// Ends a branch with its start, after a crease on the way.
    fn close(
        &self,
        branch: &mut Vec<TracePoint>,
        lines: &[(usize, f64)],
        start: TracePoint,
        sign: f64,
    ) {
        let last = *branch.last().expect("it begins with the start");
        if let Some(both) = self.crease(lines, &last, start.q, sign) {
            self.extend_over_crease(branch, both);
        }
        branch.push(start);
    }

    /// The joints of the surfaces: numbers of unknowns and their values there.
    fn lines(&self) -> Vec<(usize, f64)> {
        let mut lines = Vec::new();
        let mut add = |at: usize, all: [Vec<f64>; 2]| {
            for (k, values) in all.into_iter().enumerate() {
                lines.extend(values.into_iter().map(|x| (at + k, x)));
            }
        };
        add(0, self.first.joints());
        if let Other::Surface(second) = self.other {
            add(2, second.joints());
        }
        lines
    }

    /// True if the normals on both sides of a joint differ near a point.
    fn creased(&self, q: Unknowns, k: usize, value: f64) -> bool {
        let normal = |by: f64| {
            let mut q = q;
            q[k] = value + by;
            let j = match self.other {
                Other::Surface(second) if k > 1 => tangents(second, q[2], q[3]),
                _ => tangents(self.first, q[0], q[1]),
            };
            j[1].cross(j[2]).normalized().unwrap_or_default()
        };
        normal(-SAME_POINT).dot(normal(SAME_POINT)) < CREASE
    }

    /// Both stations at a crease, the first but where it is the last of the branch already.
    fn extend_over_crease(&self, branch: &mut Vec<TracePoint>, both: [TracePoint; 2]) {
        let near = |last: &TracePoint| both[0].x.distance(last.x) <= 1e-12 * self.size;
        let skipped = branch.last().is_some_and(near);
        branch.extend(&both[usize::from(skipped)..]);
    }

    /// The point on the step to `ahead` at which a surface has a crease, so that the branch turns
    /// there: two stations with the tangents of both sides. It is in front of `from`: the step to a
    /// guess may lead back over a crease that the branch has passed.
    fn crease(
        &self,
        lines: &[(usize, f64)],
        from: &TracePoint,
        ahead: Unknowns,
        sign: f64,
    ) -> Option<[TracePoint; 2]> {
        let share = |&(k, x): &(usize, f64)| (x - from.q[k]) / (ahead[k] - from.q[k]);
        let begins_at = |&(k, x): &(usize, f64)| (from.q[k] - x).abs() <= AT_JOINT;
        let crosses = |line: &(usize, f64)| {
            let &(k, x) = line;
            (from.q[k] - x) * (ahead[k] - x) < 0.0 || begins_at(line) && ahead[k] != from.q[k]
        };
        let mut on_way: Vec<&(usize, f64)> = lines.iter().filter(|line| crosses(line)).collect();
        on_way.sort_by(|a, b| share(a).total_cmp(&share(b)));
        on_way.into_iter().find_map(|line| {
            let &(k, value) = line;
            let guess: Unknowns =
                std::array::from_fn(|i| from.q[i] + share(line) * (ahead[i] - from.q[i]));
            if !self.creased(guess, k, value) {
                return None;
            }
            let mut at = self.at_line(guess, k, value)?;
            at[k] = value;
            let inside = |q: &f64| (-OUTSIDE..=1.0 + OUTSIDE).contains(q);
            let x = self.first.jet(at[0], at[1], Order::Zero).p;
            let side = |by: f64| {
                let mut q = at;
                q[k] += by * SAME_POINT * (ahead[k] - from.q[k]).signum();
                Some(TracePoint { q: at, x, ..self.station(q)? })
            };
            let (before, after) = (side(-1.0)?, side(1.0)?);
            let turned = before.tangent.dot(after.tangent) < CREASE;
            let smooth = before.tangent.dot(from.tangent) > LARGEST_TURN;
            let onward = sign * (x - from.x).dot(from.tangent) >= -1e-12 * self.size;
            // A branch that begins at the crease may be beyond it.
            let turn = |side: &TracePoint| side.tangent.distance(from.tangent);
            let ahead = !begins_at(line) || turn(&before) < turn(&after);
            (turned && smooth && onward && ahead && at[..self.unknowns()].iter().all(inside))
                .then_some([before, after])
        })
    }

    /// Continues a branch over the edge at a station; its end, if it ends there.
    fn over_edge(
        &self,
        branch: &mut Vec<TracePoint>,
        start: &TracePoint,
        (station, end): (TracePoint, BranchEnd),
    ) -> Option<BranchEnd> {
        // It may have begun at the seam, and towards it.
        if branch.len() > 2 && self.same_place(&station, start) {
            branch.push(*start);
            return Some(BranchEnd::Closed);
        }
        let last = branch.last().expect("it begins with the start");
        if station.x.distance(last.x) > 1e-12 * self.size {
            branch.push(station);
        }
        let Some(beyond) = self.beyond_seam(&station, end) else { return Some(end) };
        if branch.len() > 2 && self.same_place(&beyond, start) {
            branch.push(*start);
            return Some(BranchEnd::Closed);
        }
        branch.push(beyond);
        None
    }

    /// The point on the step to `ahead` at a seam, such as a trailing edge, beyond which the surface turns so much that no point
    /// of the intersection is ahead.
    fn sharp_seam(
        &self,
        last: &TracePoint,
        ahead: Unknowns,
        step: f64,
        sign: f64,
    ) -> Option<(TracePoint, BranchEnd)> {
        let n = self.unknowns();
        let mut best: Option<(f64, TracePoint, BranchEnd)> = None;
        for unknown in (0..n).filter(|k| self.closed[*k]) {
            let (p, q) = (last.q[unknown], ahead[unknown]);
            let value = f64::from(u8::from(q > 0.5));
            if (0.0..=1.0).contains(&q) || best.is_some_and(|(s, ..)| s <= (value - p) / (q - p)) {
                continue;
            }
            let share = ((value - p) / (q - p)).clamp(0.0, 1.0);
            let guess = std::array::from_fn(|k| last.q[k] + share * (ahead[k] - last.q[k]));
            let Some(mut at) = self.at_line(guess, unknown, value) else { continue };
            at[unknown] = value;
            if at[..n].iter().any(|x| *x < -OUTSIDE || *x > 1.0 + OUTSIDE) {
                continue;
            }
            let Some(station) = self.station(at) else { continue };
            let way = station.x - last.x;
            let onward = sign * way.dot(last.tangent) >= 0.9 * way.norm() - 1e-12 * self.size;
            let turn = station.tangent.dot(last.tangent);
            let end = BranchEnd::Edge { unknown, value };
            let smooth = self
                .beyond_seam(&station, end)
                .is_some_and(|beyond| beyond.tangent.dot(station.tangent) >= CREASE);
            if onward && !smooth && way.norm() <= 1.5 * step && turn > LARGEST_TURN {
                best = Some((share, station, end));
            }
        }
        best.map(|(_, station, end)| (station, end))
    }

    /// Continuation of a branch at an edge, if the edge is a seam.
    fn beyond_seam(&self, at: &TracePoint, end: BranchEnd) -> Option<TracePoint> {
        let BranchEnd::Edge { unknown, value } = end else { return None };
        if !self.closed[unknown] {
            return None;
        }
        let mut q = at.q;
        q[unknown] = 1.0 - value;
        let mut q = self.at_line(q, unknown, 1.0 - value)?;
        q[unknown] = 1.0 - value;
        let station = self.station(q)?;
        let near = station.x.distance(at.x) <= 1e-7 * self.size;
        // A seam may be a crease, as sharp as a trailing edge.
        (near && station.tangent.dot(at.tangent) > -1.0 + 1e-9).then_some(station)
    }

    fn same_place(&self, a: &TracePoint, b: &TracePoint) -> bool {
        let same = (0..4).all(|k| (a.q[k] - b.q[k]).abs() < 1e-6);
        same && a.x.distance(b.x) <= 1e-7 * self.size
    }

    /// The first edge between two stations; the second one is outside.
    fn edge_between(&self, a: &TracePoint, b: &TracePoint) -> Option<(TracePoint, BranchEnd)> {
        let n = self.unknowns();
        let mut best: Option<(f64, TracePoint, BranchEnd)> = None;
        for unknown in 0..n {
            for value in [0.0, 1.0] {
                let (p, q) = (a.q[unknown], b.q[unknown]);
                let beyond = if value == 0.0 { q < 0.0 } else { q > 1.0 };
                if !beyond {
                    continue;
                }
                let share = ((value - p) / (q - p)).clamp(0.0, 1.0);
                let guess = std::array::from_fn(|k| a.q[k] + share * (b.q[k] - a.q[k]));
                let Some(mut at) = self.at_line(guess, unknown, value) else { continue };
                at[unknown] = value;
                if at[..n].iter().any(|x| *x < -OUTSIDE || *x > 1.0 + OUTSIDE) {
                    continue;
                }
                let Some(station) = self.station(at) else { continue };
                // Between them and not where the branch comes back.
                let way = b.x - a.x;
                let along = (station.x - a.x).dot(way) / way.norm_sq();
                let turn = station.tangent.dot(a.tangent);
                if !(-1e-6..=1.0 + 1e-6).contains(&along) || turn < LARGEST_TURN {
                    continue;
                }
                if best.as_ref().is_none_or(|(s, ..)| share < *s) {
                    best = Some((share, station, BranchEnd::Edge { unknown, value }));
                }
            }
        }
        best.map(|(_, station, end)| (station, end))
    }

    /// The whole branch through a point of the intersection, in the direction n1 x n2.
    pub fn branch(&self, seed: Unknowns) -> Option<Branch> {
        // A seed may be outside by `OUTSIDE`.
        let mut seed = seed;
        for k in 0..self.unknowns() {
            let edge = seed[k].clamp(0.0, 1.0);
            if seed[k] != edge {
                seed = self.at_line(seed, k, edge)?;
                seed[k] = edge;
            }
        }
        let seed = self.beside_crease(seed);
        // Shapes that touch cross at such angles within the rounding of the position.
        let start = self.station(seed).filter(|_| self.direction(seed).norm() >= TANGENT)?;
        let (mut forward, end) = self.walk(start, 1.0);
        if end == BranchEnd::Closed {
            return Some(Branch { stations: forward, ends: [BranchEnd::Closed; 2] });
        }
        let (mut stations, begin) = self.walk(start, -1.0);
        stations.reverse();
        if begin == BranchEnd::Closed {
            // In the opposite direction it did not pass a narrow point, such as near a saddle.
            return Some(Branch { stations, ends: [BranchEnd::Closed; 2] });
        }
        stations.extend(forward.drain(1..));
        Some(Branch { stations, ends: [begin, end] })
    }

    /// A seed, or a point of the branch beside it where it is on a crease: there the branch has two directions.
    fn beside_crease(&self, seed: Unknowns) -> Unknowns {
        let on = |(k, value): &(usize, f64)| (seed[*k] - value).abs() <= SAME_POINT;
        let mut lines = self.lines().into_iter().filter(on);
        let Some((k, value)) = lines.find(|&(k, value)| self.creased(seed, k, value)) else {
            return seed;
        };
        let inside = |q: &Unknowns| q[..self.unknowns()].iter().all(|x| (0.0..=1.0).contains(x));
        let beside = [BESIDE, -BESIDE].map(|by| self.at_line(seed, k, value + by));
        beside.into_iter().flatten().find(inside).unwrap_or(seed)
    }

    /// The point of the intersection near the point (u, v) of the first surface, in the plane of
    /// both normals there.
    pub fn near(&self, [u, v]: [f64; 2], second: Option<[f64; 2]>) -> Option<Unknowns> {
        let x = self.first.jet(u, v, Order::Zero).p;
        let [p, r] = match (self.other, second) {
            (Other::Plane(_) | Other::Level(_), _) => [0.0; 2],
            (_, Some(pr)) => pr,
            (Other::Surface(second), None) => crate::nearest_on_surface(second, x, None).at,
        };
        let guess = [u, v, p, r];
        let d = self.direction(guess).normalized()?;
        let q = self.across(guess, x, d)?;
        let n = self.unknowns();
        q[..n].iter().all(|x| *x >= -OUTSIDE && *x <= 1.0 + OUTSIDE).then_some(q)
    }

    /// The branch's own point across from `x`, between two neighbouring stations; `None` when it is
    /// not there.
    pub(crate) fn between(&self, a: &TracePoint, b: &TracePoint, x: Vec3) -> Option<Vec3> {
        let chord = b.x - a.x;
        let share = (x - a.x).dot(chord) / chord.norm_sq();
        if !(-0.05..=1.05).contains(&share) {
            return None;
        }
        let guess = std::array::from_fn(|k| a.q[k] + share * (b.q[k] - a.q[k]));
        let own = self.across_near(guess, x, a.tangent)?;
        Some(self.first.jet(own[0], own[1], Order::Zero).p)
    }
}

/// The point a step beyond two stations, by extrapolation of their cubic in the length. Also in
/// space.
#[inline(always)]
fn onward(a: &TracePoint, b: &TracePoint, step: f64, sign: f64) -> (Unknowns, Vec3) {
    // A chord of turn w is shorter than its arc by w^2 / 24, the path along a tangent by w^2 / 6.
    let (chord, turn) = (a.x.distance(b.x), a.tangent.distance(b.tangent));
    let arc = chord * (1.0 + turn * turn / 24.0);
    let turn = turn * step / arc;
    let x = 1.0 + step * (1.0 + turn * turn / 6.0) / arc;
    let (xx, rate) = (x * x, sign * arc);
    let shares = [
        1.0 + xx * (2.0 * x - 3.0),
        (x + xx * (x - 2.0)) * rate,
        xx * (3.0 - 2.0 * x),
        xx * (x - 1.0) * rate,
    ];
    let [p, r, q, s] = shares;
    let unknowns = std::array::from_fn(|k| a.q[k] * p + a.rate[k] * r + b.q[k] * q + b.rate[k] * s);
    (unknowns, a.x * p + a.tangent * r + b.x * q + b.tangent * s)
}

/// True if the cubic of two inner stations leaves the domain and returns between them.
#[inline(always)]
fn strays(a: &TracePoint, b: &TracePoint, sign: f64, unknowns: usize) -> bool {
    let run = sign * a.x.distance(b.x);
    (0..unknowns).any(|k| {
        [(0.0, 1.0), (1.0, -1.0)].iter().any(|(edge, inward)| {
            // The distance from the edge and its slope at both.
            let [d, e] = [a, b].map(|s| inward * (s.q[k] - edge));
            let [p, r] = [a, b].map(|s| inward * run * s.rate[k]);
            if !(p < 0.0 && r > 0.0) {
                return false;
            }
            let (bend, twist) = (3.0 * (e - d) - 2.0 * p - r, p + r - 2.0 * (e - d));
            let x = -p / (bend + (bend * bend - 3.0 * twist * p).max(0.0).sqrt());
            d + x * (p + x * (bend + x * twist)) < -1e-9
        })
    })
}

fn size_by_samples(surface: &dyn Surface<f64>) -> f64 {
    let ts = [0.0, 0.25, 0.5, 0.75, 1.0];
    let mut x = [Vec3::zero(); 25];
    surface.grid(&ts, &ts, &mut x, None);
    size_of(&Box3::around(x))
}
