//! Intersections of curves with planes, curves and surfaces: from a start, and all of them.
//!
//! Searches for all roots subdivide the pieces of both shapes while their boxes intersect, until
//! the pieces are so flat that Newton's method from the middle finds the only possible root, or
//! leaves; then the roots are refined to full accuracy on the shapes themselves. On shapes whose
//! pieces are exact (see [`crate::pieces`]) every transversal root is found. If the search reaches
//! its limit, as it does for coincident shapes, [`Roots::complete`] is false.

use crate::newton::{NewtonResult, OUTSIDE, UnknownBounds, newton};
use crate::pieces::{BezierPatch, CurvePiece, meet, size_of};
use crate::report::{FoundRoot, LocateReport, LocateStatus, Roots, Solution};
use crate::tree::{CurveTree, SurfaceTree};
use moldloft_num::period::parameter_distance;
use moldloft_num::{Box3, Curve, CurveJet, Field, Order, Surface, Vec3};

/// Maximum number of pairs of pieces in a search.
const MOST_PAIRS: usize = 100_000;

/// Relative flatness at which a piece has at most one root.
pub(crate) const FLAT: f64 = 0.05;

/// A contact whose sine of the angle is below this is tangent.
pub(crate) const TANGENT: f64 = 1e-6;

/// Residual, relative to the size, of contacts without a transversal root.
const TOUCH: f64 = 1e-10;

/// A function g of space whose zeros along a curve are sought.
#[derive(Clone, Copy)]
pub enum Level<'a> {
    /// n . X - offset, with a unit normal n.
    Plane {
        /// The unit normal.
        normal: Vec3,
        /// n . X of the points of the plane.
        offset: f64,
    },
    /// (|X - c|^2 - r^2) / 2 r.
    Sphere {
        /// The centre.
        centre: Vec3,
        /// The radius.
        radius: f64,
    },
    /// An implicit function.
    Field(&'a dyn Field<f64>),
}

impl Level<'_> {
    /// g along the jet of a curve: value and two derivatives by t.
    pub fn along(&self, [p, d, dd]: CurveJet<f64>) -> [f64; 3] {
        match *self {
            Level::Plane { normal, offset } => {
                [normal.dot(p) - offset, normal.dot(d), normal.dot(dd)]
            }
            Level::Sphere { centre, radius } => {
                let r = p - centre;
                let half = 0.5 / radius;
                [
                    (r.norm_sq() - radius * radius) * half,
                    2.0 * r.dot(d) * half,
                    2.0 * (r.dot(dd) + d.norm_sq()) * half,
                ]
            }
            Level::Field(field) => {
                let (f, g, h) = field.second_order(p);
                let bent = Vec3::new(h[0].dot(d), h[1].dot(d), h[2].dot(d)).dot(d);
                [f, g.dot(d), g.dot(dd) + bent]
            }
        }
    }
}

/// The values of a level along a curve, as a curve on the x axis.
struct LevelProfile<'a> {
    curve: &'a dyn Curve<f64>,
    level: &'a Level<'a>,
}

impl Curve<f64> for LevelProfile<'_> {
    fn jet(&self, t: f64, order: Order) -> CurveJet<f64> {
        self.level.along(self.curve.jet(t, order)).map(|g| Vec3::of(g, 0.0, 0.0))
    }
    fn breaks(&self) -> Vec<f64> {
        self.curve.breaks()
    }
    fn joints(&self) -> Vec<f64> {
        self.curve.joints()
    }
    fn closed(&self) -> bool {
        self.curve.closed()
    }

    moldloft_num::curve_facts!(kinks_at_breaks, not_rational);
    moldloft_num::curve_one_by_one!(f64);
}

fn size_of_curve(curve: &dyn Curve<f64>) -> f64 {
    let ts = [0.0, 0.25, 0.5, 0.75, 1.0];
    let mut x = [Vec3::zero(); 5];
    curve.grid(&ts, &mut x);
    size_of(&Box3::around(x))
}

fn size_of_surface(surface: &dyn Surface<f64>) -> f64 {
    let ts = [0.0, 0.5, 1.0];
    let mut x = [Vec3::zero(); 9];
    surface.grid(&ts, &ts, &mut x, None);
    size_of(&Box3::around(x))
}

/// A walk from a start that was given, as a solution; `None` when it found nothing.
pub(crate) fn taken<const N: usize>(
    walk: &NewtonResult<N>,
    start: &[f64],
    sine: f64,
) -> Option<Solution<N>> {
    if !walk.found {
        return None;
    }
    let status = if sine < TANGENT { LocateStatus::Tangent } else { LocateStatus::Ok };
    let report = LocateReport {
        status,
        residual: walk.residual,
        iterations: walk.iterations,
        start: start.iter().copied().collect(),
        last: walk.at.iter().copied().collect(),
        alternatives: Vec::new(),
    };
    Some(Solution { at: walk.at, joint: [false; N], report })
}

/// Result without a start, or after a failure from it: of all roots, the one nearest to the start.
pub(crate) fn from_all<const N: usize>(
    all: Roots<N>,
    start: Option<&[f64]>,
    choose: impl Fn(&Roots<N>) -> Option<usize>,
) -> Result<Solution<N>, LocateReport> {
    let from: Vec<f64> = start.map_or_else(|| vec![0.5; N], <[f64]>::to_vec);
    match choose(&all) {
        Some(k) => Ok(all.choose(k, &from, start.is_some())),
        None => Err(all.none(&from)),
    }
}

/// Intersection of a curve with a level. From a `start` it is the result of Newton's method;
/// otherwise, or if that fails, the intersection nearest to the start (default 0.5).
///
/// # Errors
/// The report if there is none.
pub fn curve_level(
    curve: &dyn Curve<f64>,
    level: &Level<'_>,
    start: Option<f64>,
) -> Result<Solution<1>, LocateReport> {
    if let Some(t) = start {
        let size = size_of_curve(curve);
        let closed = curve.closed();
        let walk = newton([t], &[UnknownBounds::parameter(closed)], size, |[t]| {
            let [g, d, _] = level.along(curve.jet(t, Order::First));
            ([g], [[d]])
        })
        .within(&[closed]);
        let sine = sine_to_level(curve, level, walk.at[0]);
        if let Some(found) = taken(&walk, &[t], sine) {
            return Ok(found);
        }
    }
    let all = all_on_level(curve, level);
    let from = start.unwrap_or(0.5);
    from_all(all, start.as_ref().map(std::slice::from_ref), |all| all.nearest_to(&[from]))
}

fn sine_to_level(curve: &dyn Curve<f64>, level: &Level<'_>, t: f64) -> f64 {
    let jet = curve.jet(t, Order::First);
    level.along(jet)[1].abs() / jet[1].norm().max(f64::MIN_POSITIVE)
}

/// All crossings of a curve and a level.
pub fn all_on_level(curve: &dyn Curve<f64>, level: &Level<'_>) -> Roots<1> {
    let size = size_of_curve(curve);
    let along = LevelProfile { curve, level };
    let tree = CurveTree::new(&along);
    let value = |t: f64| level.along(curve.jet(t, Order::Second));
    let closed = curve.closed();
    let mut search = RootCollector::<1>::new(size, &[1.0], [closed]);
    for piece in &tree.pieces {
        let mut stack = vec![*piece];
        while let Some(piece) = stack.pop() {
            let b = piece.bounds();
            if b.low.x > 0.0 || b.high.x < 0.0 || search.exhausted() {
                continue;
            }
            let slopes = [0, 1, 2].map(|k| piece.net[k + 1].x - piece.net[k].x);
            let low = slopes.iter().copied().fold(f64::INFINITY, f64::min);
            let high = slopes.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            // Nearly even slope: Newton's method from the middle cannot miss.
            let steady = low > 0.0 && high < 3.0 * low || high < 0.0 && low > 3.0 * high;
            let [t0, t1] = piece.t;
            let middle = 0.5 * (t0 + t1);
            if steady {
                let walk = newton([middle], &[UnknownBounds::parameter(closed)], size, |[t]| {
                    let [g, d, _] = value(t);
                    ([g], [[d]])
                });
                search.offer(&walk, [[t0, t1]], |[t]| {
                    (curve.jet(t, Order::Zero)[0], sine_to_level(curve, level, t) < TANGENT)
                });
            } else if t1 - t0 > 1e-7 {
                stack.extend(piece.halves());
            } else {
                // The turning point nearby touches the level, or nothing does.
                let mut t = middle;
                for _ in 0..20 {
                    let [_, d, dd] = value(t);
                    let step = d / dd;
                    if !step.is_finite() || step.abs() > 1e-3 {
                        break;
                    }
                    t = (t - step).clamp(0.0, 1.0);
                }
                search.touch([t], value(t)[0].abs(), curve.jet(t, Order::Zero)[0]);
            }
        }
    }
    search.finish()
}

/// Collects roots: brings candidates together, drops those found twice.
pub(crate) struct RootCollector<const N: usize> {
    size: f64,
    pairs: usize,
    roots: Vec<FoundRoot<N>>,
    closest: Option<([f64; N], f64)>,
    slack: [f64; N],
    closed: [bool; N],
}

impl<const N: usize> RootCollector<N> {
    /// `closed` is true for closed unknowns.
    pub fn new(size: f64, slack: &[f64; N], closed: [bool; N]) -> Self {
        Self { size, pairs: 0, roots: Vec::new(), closest: None, slack: *slack, closed }
    }

    /// Counts a pair; true when the limit is exceeded.
    pub fn exhausted(&mut self) -> bool {
        self.pairs += 1;
        self.pairs > MOST_PAIRS || self.roots.len() > 2_000
    }

    /// True if there is a root.
    pub fn any(&self) -> bool {
        !self.roots.is_empty()
    }

    pub fn note(&mut self, at: [f64; N], residual: f64) {
        if residual.is_finite() && self.closest.is_none_or(|(_, best)| residual < best) {
            self.closest = Some((at, residual));
        }
    }

    /// Adds the result of an iteration that began in the cell, if it ended in or near it.
    pub fn offer(
        &mut self,
        walk: &NewtonResult<N>,
        cell: [[f64; 2]; N],
        facts: impl Fn([f64; N]) -> (Vec3, bool),
    ) {
        self.note(walk.at, walk.residual);
        let near = (0..N).all(|k| {
            let [a, b] = cell[k];
            let reach = self.slack[k] * (b - a) + OUTSIDE;
            walk.at[k] >= a - reach && walk.at[k] <= b + reach
        });
        if walk.found && near {
            let walk = walk.within(&self.closed);
            let (xyz, tangent) = facts(walk.at);
            self.insert(FoundRoot {
                at: walk.at,
                xyz,
                residual: walk.residual,
                iterations: walk.iterations,
                tangent,
            });
        }
    }

    fn touch(&mut self, at: [f64; N], residual: f64, xyz: Vec3) {
        self.note(at, residual);
        if residual <= TOUCH * self.size {
            self.insert(FoundRoot { at, xyz, residual, iterations: 0, tangent: true });
        }
    }

    pub fn insert(&mut self, root: FoundRoot<N>) {
        let closed = self.closed;
        let near = |a: &FoundRoot<N>, reach: f64| {
            (0..N).all(|k| parameter_distance(a.at[k], root.at[k], closed[k]) <= reach)
        };
        // Touching points are found only to the root of the accuracy.
        let reach = |a: &FoundRoot<N>| if a.tangent || root.tangent { 1e-4 } else { 1e-9 };
        match self.roots.iter_mut().find(|a| near(a, reach(a))) {
            Some(same) if root.residual < same.residual && same.tangent => *same = root,
            Some(_) => {}
            None => self.roots.push(root),
        }
    }

    pub fn finish(mut self) -> Roots<N> {
        let complete = self.pairs <= MOST_PAIRS && self.roots.len() <= 2_000;
        self.roots.sort_by(|a, b| {
            let pairs = a.at.iter().zip(&b.at);
            pairs.fold(std::cmp::Ordering::Equal, |o, (x, y)| o.then(x.total_cmp(y)))
        });
        Roots { roots: self.roots, complete, closest: self.closest, closed: self.closed }
    }
}

/// Residual and matrix of C(t) - S(u, v).
fn curve_on_surface(
    curve: &dyn Curve<f64>,
    surface: &dyn Surface<f64>,
    [t, u, v]: [f64; 3],
) -> ([f64; 3], [[f64; 3]; 3]) {
    let c = curve.jet(t, Order::First);
    let s = surface.jet(u, v, Order::First);
    let r = (c[0] - s.p).to_array();
    let columns = [c[1].to_array(), (-s.u).to_array(), (-s.v).to_array()];
    (r, std::array::from_fn(|a| std::array::from_fn(|b| columns[b][a])))
}

/// Sine of the angle between curve and surface.
fn sine_to_surface(curve: &dyn Curve<f64>, surface: &dyn Surface<f64>, [t, u, v]: [f64; 3]) -> f64 {
    let d = curve.jet(t, Order::First)[1];
    let n = surface.jet(u, v, Order::First).normal();
    n.dot(d).abs() / d.norm().max(f64::MIN_POSITIVE)
}

/// For each of (t, u, v), true if closed.
fn round_of(curve: &dyn Curve<f64>, surface: &dyn Surface<f64>) -> [bool; 3] {
    let [u, v] = surface.closed();
    [curve.closed(), u, v]
}

/// Intersection of a curve with a surface, as (t, u, v); see [`curve_level`].
///
/// # Errors
/// The report when they do not meet.
pub fn curve_surface(
    curve: &dyn Curve<f64>,
    surface: &dyn Surface<f64>,
    start: Option<[f64; 3]>,
) -> Result<Solution<3>, LocateReport> {
    if let Some(q) = start {
        let size = size_of_curve(curve).max(size_of_surface(surface));
        let f = |q| curve_on_surface(curve, surface, q);
        let closed = round_of(curve, surface);
        let walk = newton(q, &closed.map(UnknownBounds::parameter), size, f).within(&closed);
        if let Some(found) = taken(&walk, &q, sine_to_surface(curve, surface, walk.at)) {
            return Ok(found);
        }
    }
    let all = all_curve_surface(curve, surface);
    let from = start.unwrap_or([0.5; 3]);
    from_all(all, start.as_ref().map(<[f64; 3]>::as_slice), |all| all.nearest_to(&from))
}

/// All intersections of a curve and a surface, as (t, u, v).
pub fn all_curve_surface(curve: &dyn Curve<f64>, surface: &dyn Surface<f64>) -> Roots<3> {
    let (a, b) = (CurveTree::new(curve), SurfaceTree::new(surface));
    meetings(curve, &a, surface, &b)
}

/// As `all_curve_surface`, for shapes divided before.
pub fn meetings(
    curve: &dyn Curve<f64>,
    curve_tree: &CurveTree,
    surface: &dyn Surface<f64>,
    surface_tree: &SurfaceTree,
) -> Roots<3> {
    let size = curve_tree.size.min(surface_tree.size);
    let closed = round_of(curve, surface);
    let ranges = closed.map(UnknownBounds::parameter);
    let mut search = RootCollector::<3>::new(size, &[0.5; 3], closed);
    let mut stack: Vec<(CurvePiece, BezierPatch)> = Vec::new();
    for piece in &curve_tree.pieces {
        for k in surface_tree.meeting(&piece.bounds()) {
            stack.push((*piece, surface_tree.patches[k as usize]));
            while let Some((piece, patch)) = stack.pop() {
                if search.exhausted() {
                    return search.finish();
                }
                if !meet(&piece.bounds(), &patch.bounds()) {
                    continue;
                }
                let chord = piece.net[0].distance(piece.net[3]);
                let [lu, lv] = patch.lengths();
                let bent = piece.bend().max(patch.bend());
                let flat = bent <= FLAT * chord.min(lu).min(lv).max(1e-300)
                    || piece.bend() <= FLAT * chord && patch.bend() <= FLAT * lu.min(lv);
                let tiny = chord.max(lu).max(lv) < 1e-6 * size;
                let cell = [piece.t, patch.uv[0], patch.uv[1]];
                if flat || tiny {
                    let middle = cell.map(|[a, b]| 0.5 * (a + b));
                    let f = |q| curve_on_surface(curve, surface, q);
                    let walk = newton(middle, &ranges, size, f);
                    let facts = |q: [f64; 3]| {
                        let sine = sine_to_surface(curve, surface, q);
                        (curve.jet(q[0], Order::Zero)[0], sine < TANGENT)
                    };
                    let left = (0..3).any(|k| {
                        let [a, b] = cell[k];
                        walk.at[k] < a - 2.0 * (b - a) || walk.at[k] > b + 2.0 * (b - a)
                    });
                    search.offer(&walk, cell, facts);
                    if tiny {
                        if !walk.found {
                            search.touch(walk.at, walk.residual, facts(walk.at).0);
                        }
                        continue;
                    }
                    // One root, found or far away: nothing else can be here.
                    let steep = sine_to_surface(curve, surface, middle) > 0.2;
                    if steep && (walk.found || left) {
                        continue;
                    }
                }
                let longest = chord.max(lu).max(lv);
                if chord == longest {
                    stack.extend(piece.halves().map(|half| (half, patch)));
                } else {
                    let halves = patch.halves(usize::from(lv > lu));
                    stack.extend(halves.map(|half| (piece, half)));
                }
            }
        }
    }
    search.finish()
}

/// Intersection of the line through `p` along `d` with a surface, as (u, v, distance in lengths of
/// `d`). From a start (u, v) it is the result of Newton's method; without one, or if that fails,
/// the intersection nearest to `p`.
///
/// # Errors
/// The report when the line misses the surface.
pub fn line_surface(
    surface: &dyn Surface<f64>,
    p: Vec3,
    d: Vec3,
    start: Option<[f64; 2]>,
) -> Result<Solution<3>, LocateReport> {
    let speed = d.norm();
    let residual = |[u, v, s]: [f64; 3]| {
        let j = surface.jet(u, v, Order::First);
        let columns = [j.u.to_array(), j.v.to_array(), (-d).to_array()];
        let r = (j.p - p - d * s).to_array();
        (r, std::array::from_fn(|a| std::array::from_fn(|b| columns[b][a])))
    };
    let sine = |[u, v, _]: [f64; 3]| {
        surface.jet(u, v, Order::First).normal().dot(d).abs() / speed.max(f64::MIN_POSITIVE)
    };
    let [round_u, round_v] = surface.closed();
    let closed = [round_u, round_v, false];
    let ranges =
        [UnknownBounds::parameter(round_u), UnknownBounds::parameter(round_v), UnknownBounds::FREE];
    if let Some([u, v]) = start {
        let s = (surface.jet(u, v, Order::Zero).p - p).dot(d) / (speed * speed);
        let size = size_of_surface(surface);
        let walk = newton([u, v, s], &ranges, size, residual).within(&closed);
        if let Some(found) = taken(&walk, &[u, v, s], sine(walk.at)) {
            return Ok(found);
        }
    }
    let tree = SurfaceTree::new(surface);
    // The part of the line that passes the surface's box, and a little more.
    let centre = tree.bounds.centre();
    let s = (centre - p).dot(d) / (speed * speed);
    let reach = tree.bounds.diagonal() / speed;
    let line = LineSegment { from: p + d * (s - reach), to: p + d * (s + reach) };
    let found = meetings(&line, &CurveTree::new(&line), surface, &tree);
    let roots = found.roots.iter().map(|root| {
        let [t, u, v] = root.at;
        FoundRoot { at: [u, v, s - reach + 2.0 * reach * t], ..*root }
    });
    let closest = found.closest.map(|([t, u, v], r)| ([u, v, s - reach + 2.0 * reach * t], r));
    let mut all = Roots { roots: roots.collect(), complete: found.complete, closest, closed };
    for root in &mut all.roots {
        // To full accuracy in the measure of the line itself.
        let walk = newton(root.at, &ranges, tree.size, residual).within(&closed);
        if walk.found {
            root.at = walk.at;
            root.residual = walk.residual;
        }
    }
    let from: Option<[f64; 2]> = start;
    let given: Vec<f64> = from.map_or_else(|| vec![0.5, 0.5], |q| q.to_vec());
    let chosen = match from {
        Some(uv) => all.nearest_to(&uv),
        None => {
            let away = |k: &usize| all.roots[*k].at[2].abs();
            (0..all.roots.len()).min_by(|a, b| away(a).total_cmp(&away(b)).then(a.cmp(b)))
        }
    };
    match chosen {
        Some(k) => Ok(all.choose(k, &given, from.is_some())),
        None => Err(all.none(&given)),
    }
}

/// A straight line run evenly.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LineSegment {
    pub from: Vec3,
    pub to: Vec3,
}

impl Curve<f64> for LineSegment {
    fn jet(&self, t: f64, _: Order) -> CurveJet<f64> {
        [self.from * (1.0 - t) + self.to * t, self.to - self.from, Vec3::zero()]
    }

    moldloft_num::curve_facts!(smooth, open, not_rational);
    moldloft_num::curve_one_by_one!(f64);
}
