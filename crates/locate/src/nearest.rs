//! Nearest points on curves and surfaces.

use crate::newton::{ACCURACY, LONGEST_STEP, MOST_STEPS};
use crate::pieces::{BezierPatch, Feet, distance_sq, size_of};
use crate::report::{Alternative, LocateReport, LocateStatus, Solution};
use crate::tree::{CurveTree, SurfaceTree};
use moldloft_num::period::{breaks_between, principal};
use moldloft_num::{Box3, Curve, Order, Surface, Vec3};
use smallvec::SmallVec;

/// Difference of distances, relative to the size, within which feet are equally near.
const TIE: f64 = 1e-9;

/// Distance, in sizes, at which a farther point is replaced by one in the same direction: from
/// there on all distances agree to 1e-8 of the size in the order given by the direction, and
/// differences would be lost in rounding.
const FAR: f64 = 1e8;

/// Descents follow slopes, which keep their digits farther out, as long as squares do not overflow.
const FARTHEST: f64 = 1e60;

/// Pieces that one search looks at before it takes the best it has, as where all points of a curve or
/// surface are equally near.
const MOST_LOOKS: [u32; 2] = [4_000, 20_000];

const MOST_FEET: usize = 256;

/// The point whose nearest one is searched.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sought {
    /// At most [`FAR`] away: for distances.
    pub near: Vec3,
    /// At most [`FARTHEST`] away: for descents.
    pub p: Vec3,
    /// Rounding error of distances.
    pub slop: f64,
}

impl Sought {
    /// A point seen from a shape of some size in a box.
    pub fn new(p: Vec3, bounds: &Box3, size: f64) -> Self {
        let centre = bounds.centre();
        let [near, p] = [FAR, FARTHEST].map(|most| pulled(p, centre, most * size));
        Self { near, p, slop: TIE * size + 4.0 * f64::EPSILON * near.distance(centre) }
    }
}

/// The point, or the one in its direction that is as far from the centre as may be.
fn pulled(p: Vec3, centre: Vec3, most: f64) -> Vec3 {
    let away = p - centre;
    let largest = away.x.abs().max(away.y.abs()).max(away.z.abs());
    // A square of the largest may overflow.
    if largest <= most && away.norm() <= most {
        return p;
    }
    let direction = away / largest;
    centre + direction * (most / direction.norm())
}

/// Distance of two points, also if its square overflows.
pub(crate) fn apart(a: Vec3, b: Vec3) -> f64 {
    let d = a - b;
    let largest = d.x.abs().max(d.y.abs()).max(d.z.abs());
    if largest < 1e150 { d.norm() } else { (d / largest).norm() * largest }
}

/// End of a descent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot<const N: usize> {
    pub at: [f64; N],
    pub xyz: Vec3,
    /// Residual slope of the distance, as a length.
    residual: f64,
    iterations: u32,
    /// True when the unknown is held at an end of its range.
    pub held: [bool; N],
    /// True when the distance has no definite second derivative there.
    pub flat: bool,
    pub converged: bool,
    /// True when the unknown is that of a joint at which the shape is bent.
    pub joint: [bool; N],
}

/// The slope of the distance along the free unknowns, as a length.
fn slope_of<const N: usize>(d: &[Vec3; N], r: Vec3, held: &[bool; N]) -> f64 {
    let along = |k: usize| {
        let length = d[k].norm();
        if held[k] || length == 0.0 { 0.0 } else { d[k].dot(r).abs() / length }
    };
    (0..N).map(along).fold(0.0, f64::max)
}

/// Minimises |X(q) - p|^2 over the box `low`..`high` by Newton's method, with Gauss-Newton as a
/// safeguard: every step decreases it. `f` gives the position, first derivatives, and second ones
/// in the order uu, uv, vv.
fn descend<const N: usize>(
    p: Vec3,
    start: [f64; N],
    [low, high]: [[f64; N]; 2],
    size: f64,
    f: impl Fn([f64; N]) -> (Vec3, [Vec3; N], [[Vec3; N]; N]),
) -> Foot<N> {
    let clamp = |q: [f64; N]| -> [f64; N] { std::array::from_fn(|k| q[k].clamp(low[k], high[k])) };
    let mut q = clamp(start);
    let (mut x, mut d, mut dd) = f(q);
    let mut foot = Foot {
        at: q,
        xyz: x,
        residual: f64::INFINITY,
        iterations: 0,
        held: [false; N],
        flat: false,
        converged: false,
        joint: [false; N],
    };
    for _ in 0..MOST_STEPS {
        let r = x - p;
        let slope: [f64; N] = std::array::from_fn(|k| d[k].dot(r));
        let held: [bool; N] = std::array::from_fn(|k| {
            q[k] <= low[k] && slope[k] > 0.0 || q[k] >= high[k] && slope[k] < 0.0
        });
        let residual = slope_of(&d, r, &held);
        (foot.at, foot.xyz, foot.residual, foot.held) = (q, x, residual, held);
        // The slope's own rounding grows with the distance.
        let goal = ACCURACY * size.max(r.norm());
        let done = residual <= goal;
        foot.converged |= done;
        let mut metric = [[0.0; N]; N];
        let mut hessian = [[0.0; N]; N];
        for a in 0..N {
            for b in 0..N {
                metric[a][b] = d[a].dot(d[b]);
                hessian[a][b] = metric[a][b] + dd[a][b].dot(r);
            }
        }
        let scale = metric.iter().enumerate().map(|(k, row)| row[k]).fold(0.0, f64::max);
        let definite = |m: &[[f64; N]; N], least: f64| {
            let free: SmallVec<[usize; 2]> = (0..N).filter(|&k| !held[k]).collect();
            match free.as_slice() {
                [] => true,
                [k] => m[*k][*k] > least * scale,
                _ => {
                    m[0][0] > least * scale
                        && m[0][0] * m[1][1] - m[0][1] * m[1][0] > least * scale * m[1][1].abs()
                }
            }
        };
        foot.flat = !definite(&hessian, 1e-9);
        if done && residual <= 1e-3 * goal || held.iter().all(|h| *h) {
            foot.converged = true;
            break;
        }
        let mut matrix = if definite(&hessian, 1e-6) { hessian } else { metric };
        if !definite(&matrix, 1e-14) {
            for (k, row) in matrix.iter_mut().enumerate() {
                row[k] += 1e-9 * scale.max(f64::MIN_POSITIVE);
            }
        }
        // A step that would leave the box from its side is taken along the side instead.
        let mut fixed = held;
        let step = loop {
            let (mut m, mut rest) = (matrix, slope);
            for k in (0..N).filter(|&k| fixed[k]) {
                for a in 0..N {
                    (m[k][a], m[a][k]) = (0.0, 0.0);
                }
                (m[k][k], rest[k]) = (1.0, 0.0);
            }
            let Some(step) = crate::implicit::solve(&m, rest) else { break None };
            let leaves = |k: &usize| {
                !fixed[*k]
                    && (q[*k] <= low[*k] && step[*k] > 0.0 || q[*k] >= high[*k] && step[*k] < 0.0)
            };
            match (0..N).find(leaves) {
                Some(k) => fixed[k] = true,
                None => break Some(step),
            }
        };
        let Some(step) = step else { break };
        let longest = step.iter().fold(0.0_f64, |a, s| a.max(s.abs()));
        if !longest.is_finite() || longest == 0.0 {
            break;
        }
        let mut share = (LONGEST_STEP / longest).min(1.0);
        let before = r.norm_sq();
        let mut moved = false;
        for _ in 0..30 {
            let next = clamp(std::array::from_fn(|k| q[k] - share * step[k]));
            if next == q {
                break;
            }
            let (x2, d2, dd2) = f(next);
            let after = (x2 - p).norm_sq();
            // Near the foot the distance is dominated by rounding, but its slope is not.
            let level = (after - before).abs() <= 1e-14 * (before + size * size);
            if after < before && !level || level && slope_of(&d2, x2 - p, &held) < residual {
                (q, x, d, dd) = (next, x2, d2, dd2);
                moved = true;
                break;
            }
            share *= 0.5;
        }
        if !moved {
            // No step decreases it: converged to rounding.
            foot.converged |= residual <= 1e-7 * size.max(r.norm());
            break;
        }
        foot.iterations += 1;
        if done {
            (foot.at, foot.xyz, foot.residual) = (q, x, slope_of(&d, x - p, &held));
            break;
        }
    }
    foot
}

fn curve_foot(curve: &dyn Curve<f64>, p: Vec3, start: f64, ends: [f64; 2], size: f64) -> Foot<1> {
    descend(p, [start], [[ends[0]], [ends[1]]], size, |[t]| {
        let [x, d, dd] = curve.jet(t, Order::Second);
        (x, [d], [[dd]])
    })
}

pub(crate) fn surface_foot(
    surface: &dyn Surface<f64>,
    p: Vec3,
    start: [f64; 2],
    [us, vs]: [[f64; 2]; 2],
    size: f64,
) -> Foot<2> {
    descend(p, start, [[us[0], vs[0]], [us[1], vs[1]]], size, |[u, v]| {
        let j = surface.jet(u, v, Order::Second);
        (j.p, [j.u, j.v], [[j.uu, j.uv], [j.uv, j.vv]])
    })
}

/// The range of a descent over a whole shape from `at`: round and round a closed one.
fn whole_range(at: f64, closed: bool) -> [f64; 2] {
    if closed { [at - 1.0, at + 1.0] } else { [0.0, 1.0] }
}

/// The foot on a whole curve that descent from `start` leads to, over the seam of a closed one; corners count.
fn on_whole_curve(curve: &dyn Curve<f64>, p: Vec3, start: f64, size: f64) -> Foot<1> {
    let closed = curve.closed();
    let range = whole_range(start, closed);
    let mut foot = curve_foot(curve, p, start, range, size);
    if !foot.converged
        && let Some(corner) = at_corner(curve, p, &foot, range, size)
    {
        foot = corner;
    }
    if closed {
        foot.at = foot.at.map(principal);
    }
    foot
}

/// Distance on both sides of a joint at which its slopes are evaluated.
const BESIDE: f64 = 1e-8;

/// The joint nearest to a parameter.
fn joint_near(breaks: &[f64], closed: bool, [low, high]: [f64; 2], at: f64) -> Option<f64> {
    let inside = breaks_between(breaks, closed, low, high);
    inside.into_iter().min_by(|a, b| (a - at).abs().total_cmp(&(b - at).abs()))
}

/// True when the distance rises on both sides of a joint: its slopes there, as lengths.
fn rises([before, after]: [f64; 2], goal: f64) -> bool {
    before <= goal && after >= -goal
}

/// The corner near a point at which a descent did not converge, if the distance is least there.
fn at_corner(
    curve: &dyn Curve<f64>,
    p: Vec3,
    stuck: &Foot<1>,
    range: [f64; 2],
    size: f64,
) -> Option<Foot<1>> {
    let t = joint_near(&curve.breaks(), curve.closed(), range, stuck.at[0])?;
    let xyz = curve.jet(t, Order::Zero)[0];
    if xyz.distance(p) > stuck.xyz.distance(p) + 1e-12 * size {
        return None;
    }
    let slopes = [-BESIDE, BESIDE].map(|h| {
        let [x, d, _] = curve.jet(t + h, Order::First);
        d.dot(x - p) / d.norm().max(f64::MIN_POSITIVE)
    });
    let goal = 1e-7 * size.max(xyz.distance(p));
    rises(slopes, goal).then_some(Foot {
        at: [t],
        xyz,
        residual: 0.0,
        held: [false],
        converged: true,
        joint: [true],
        ..*stuck
    })
}

/// The foot on a whole surface that descent from `start` leads to, over the seams of a closed one; knuckles
/// along its joints count.
pub(crate) fn on_whole_surface(
    surface: &dyn Surface<f64>,
    p: Vec3,
    start: [f64; 2],
    size: f64,
) -> Foot<2> {
    let closed = surface.closed();
    let ranges = [0, 1].map(|k| whole_range(start[k], closed[k]));
    let mut foot = surface_foot(surface, p, start, ranges, size);
    if !foot.converged
        && let Some(knuckle) = at_knuckle(surface, p, &foot, ranges, size)
    {
        foot = knuckle;
    }
    for k in (0..2).filter(|k| closed[*k]) {
        foot.at[k] = principal(foot.at[k]);
    }
    foot
}

/// The foot along a joint, or at the junction of two, near a point at which a descent did not
/// converge, if that is where the distance is least.
fn at_knuckle(
    surface: &dyn Surface<f64>,
    p: Vec3,
    stuck: &Foot<2>,
    ranges: [[f64; 2]; 2],
    size: f64,
) -> Option<Foot<2>> {
    let (breaks, closed) = (surface.breaks(), surface.closed());
    let near = [0, 1].map(|k| joint_near(&breaks[k], closed[k], ranges[k], stuck.at[k]));
    let along = |fixed: [bool; 2]| -> Option<Foot<2>> {
        let (mut start, mut within) = (stuck.at, ranges);
        for k in (0..2).filter(|k| fixed[*k]) {
            start[k] = near[k]?;
            within[k] = [start[k]; 2];
        }
        let mut foot = surface_foot(surface, p, start, within, size);
        if !foot.converged || foot.xyz.distance(p) > stuck.xyz.distance(p) + 1e-12 * size {
            return None;
        }
        let goal = 1e-7 * size.max(foot.xyz.distance(p));
        for k in (0..2).filter(|k| fixed[*k]) {
            let slopes = [-BESIDE, BESIDE].map(|h| {
                let mut q = foot.at;
                q[k] += h;
                let j = surface.jet(q[0], q[1], Order::First);
                let d = [j.u, j.v][k];
                d.dot(j.p - p) / d.norm().max(f64::MIN_POSITIVE)
            });
            if !rises(slopes, goal) {
                return None;
            }
            foot.held[k] = false;
        }
        Some(Foot { joint: fixed, ..foot })
    };
    let found = [[true, false], [false, true], [true, true]].into_iter().filter_map(along);
    found.min_by(|a, b| a.xyz.distance(p).total_cmp(&b.xyz.distance(p)))
}

/// Directions in which a descent may leave a pole.
const AROUND: usize = 24;

/// A descent that ends at a pole continues from there on the side of steepest decrease.
fn across_poles(surface: &dyn Surface<f64>, p: Vec3, mut foot: Foot<2>, size: f64) -> Foot<2> {
    for _ in 0..3 {
        let Some(k) = (0..2).find(|k| foot.held[*k]) else { break };
        let end = foot.at[k];
        let inward = if end < 0.5 { 1.0 } else { -1.0 };
        let along = |w: f64| {
            let [u, v] = if k == 0 { [end, w] } else { [w, end] };
            surface.jet(u, v, Order::First)
        };
        let here = along(foot.at[1 - k]);
        if [here.v, here.u][k].norm() > 1e-9 * size {
            break;
        }
        let fall = |w: f64| {
            let j = along(w);
            let d = [j.u, j.v][k] * inward;
            d.dot(j.p - p) / d.norm().max(f64::MIN_POSITIVE)
        };
        let sides = (0..AROUND).map(|i| (i as f64 + 0.5) / AROUND as f64);
        let Some(w) = sides.min_by(|a, b| fall(*a).total_cmp(&fall(*b))) else { break };
        if fall(w) >= -1e-9 * size {
            break;
        }
        let (a, b) = (end + 1e-3 * inward, w);
        let next = on_whole_surface(surface, p, if k == 0 { [a, b] } else { [b, a] }, size);
        if next.xyz.distance(p).total_cmp(&foot.xyz.distance(p)).is_ge() {
            break;
        }
        foot = next;
    }
    foot
}

/// Distance from a position at which the normals on both sides are compared; with a larger angle
/// than this cosine there is a crease between.
const CREASE_WITHIN: f64 = 1e-4;
const CREASE: f64 = 0.9999;

/// The minimum distance from `p` along a crease near `near` that is not at a joint: where a
/// spline's knots depend on the other parameter. Descent does not converge there, since the
/// distance has a kink across the crease. `None` without a crease, or without such a minimum.
///
/// With one parameter given, the other one's place on the crease is found by halving; along the crease,
/// whose tangent is n1 x n2 with the normals of its sides, the slope of the distance is brought to zero
/// by the secant method.
pub(crate) fn on_crease(
    surface: &dyn Surface<f64>,
    p: Vec3,
    near: [f64; 2],
    size: f64,
) -> Option<Foot<2>> {
    let normal = |q: [f64; 2]| surface.jet(q[0], q[1], Order::First).normal();
    // The parameter that leads over the crease.
    let sides = |q: [f64; 2], axis: usize, by: f64| {
        [-by, by].map(|by| {
            let mut q = q;
            q[axis] = (q[axis] + by).clamp(0.0, 1.0);
            (q[axis], normal(q))
        })
    };
    let bent = |axis: usize| {
        let [(_, m), (_, n)] = sides(near, axis, CREASE_WITHIN);
        m.dot(n)
    };
    let axis = usize::from(bent(1) < bent(0));
    // The point on the crease at a value of the other parameter: parameters, position, and the
    // crease's tangent.
    let place = |q: [f64; 2]| -> Option<([f64; 2], Vec3, Vec3)> {
        let [(mut low, m), (mut high, n)] = sides(q, axis, CREASE_WITHIN);
        if m.dot(n) > CREASE || m == Vec3::zero() || n == Vec3::zero() {
            return None;
        }
        let mut q = q;
        for _ in 0..60 {
            q[axis] = 0.5 * (low + high);
            if q[axis] <= low || q[axis] >= high {
                break;
            }
            let k = normal(q);
            if k.dot(m) > k.dot(n) { low = q[axis] } else { high = q[axis] }
        }
        let x = surface.jet(q[0], q[1], Order::Zero).p;
        Some((q, x, m.cross(n).normalized()?))
    };
    let other = 1 - axis;
    let slope = |(_, x, t): &([f64; 2], Vec3, Vec3)| t.dot(*x - p);
    let mut before = place(near)?;
    let mut step = if near[other] < 0.5 { 1e-5 } else { -1e-5 };
    // Derivative of the crease's parameter with respect to the other one.
    let mut rate = 0.0;
    for iterations in 1..80 {
        let mut q = before.0;
        q[other] += step;
        q[axis] += rate * step;
        if !(0.0..=1.0).contains(&q[other]) {
            return None;
        }
        // Within the range in which the crease is unique.
        let Some(next) = place(q) else {
            step *= 0.25;
            continue;
        };
        let (f, g) = (slope(&before), slope(&next));
        if g.abs() <= 1e-13 * size.max(next.1.distance(p)) {
            return Some(Foot {
                at: next.0,
                xyz: next.1,
                residual: g.abs(),
                iterations,
                held: [false; 2],
                flat: false,
                converged: true,
                joint: [false; 2],
            });
        }
        let run = next.0[other] - before.0[other];
        if run.abs() > 1e-9 {
            rate = (next.0[axis] - before.0[axis]) / run;
        }
        step = (-g * run / (g - f)).clamp(-0.1, 0.1);
        if !step.is_finite() || step == 0.0 {
            return None;
        }
        before = next;
    }
    None
}

/// The foot on a crease near the feet that were found, if it is as near as they are: the others about
/// it are where descents on both sides gave up.
fn creased(surface: &dyn Surface<f64>, p: Vec3, feet: Vec<Foot<2>>, size: f64) -> Vec<Foot<2>> {
    let best = feet.iter().min_by(|a, b| a.xyz.distance(p).total_cmp(&b.xyz.distance(p)));
    let found = best.and_then(|best| {
        let foot = on_crease(surface, p, best.at, size)?;
        (foot.xyz.distance(p) <= best.xyz.distance(p) + 1e-12 * size).then_some(foot)
    });
    let Some(foot) = found else { return feet };
    let away = |f: &Foot<2>| f.xyz.distance(foot.xyz) > 1e-2 * size;
    let least = foot.xyz.distance(p) + TIE * size;
    let others = feet.into_iter().filter(|f| away(f) && f.xyz.distance(p) <= least);
    std::iter::once(foot).chain(others).collect()
}

/// The status of a foot: the nearest point of a shape exists always.
fn judged<const N: usize>(foot: &Foot<N>) -> LocateStatus {
    if !foot.converged {
        LocateStatus::Diverged
    } else if foot.held.iter().any(|h| *h) {
        LocateStatus::EdgeClamped
    } else if foot.flat {
        LocateStatus::Tangent
    } else {
        LocateStatus::Ok
    }
}

fn solution<const N: usize>(start: &[f64], feet: Vec<Foot<N>>) -> Solution<N> {
    let foot = &feet[0];
    let mut status = judged(foot);
    if feet.len() > 1 {
        let next = feet[1..].iter().map(|f| f.xyz.distance(foot.xyz)).fold(f64::INFINITY, f64::min);
        status = LocateStatus::Multiple { count: feet.len(), chosen: 0, next };
    }
    let alternatives = feet[1..]
        .iter()
        .map(|f| Alternative { parameters: f.at.iter().copied().collect(), xyz: f.xyz })
        .collect();
    let report = LocateReport {
        status,
        residual: foot.residual,
        iterations: foot.iterations,
        start: start.iter().copied().collect(),
        last: foot.at.iter().copied().collect(),
        alternatives,
    };
    Solution { at: foot.at, joint: foot.joint, report }
}

/// Keeps the nearest feet: those within `TIE` of the nearest, in the order of the parameters.
fn nearest_of<const N: usize>(mut feet: Vec<Foot<N>>, p: Vec3, size: f64) -> Vec<Foot<N>> {
    let away = |f: &Foot<N>| f.xyz.distance(p);
    let best = feet.iter().map(away).fold(f64::INFINITY, f64::min);
    feet.retain(|f| away(f) <= best + TIE * size);
    feet.sort_by(|a, b| {
        let pairs = a.at.iter().zip(&b.at);
        pairs.fold(std::cmp::Ordering::Equal, |o, (x, y)| o.then(x.total_cmp(y)))
    });
    let mut kept: Vec<Foot<N>> = Vec::new();
    for foot in feet {
        if kept.len() >= MOST_FEET {
            break;
        }
        // The same foot, reached from two sides of a seam or of a border between pieces.
        if kept.iter().all(|k| k.xyz.distance(foot.xyz) > 1e-6 * size) {
            kept.push(foot);
        } else if let Some(same) = kept.iter_mut().find(|k| k.xyz.distance(foot.xyz) <= 1e-6 * size)
        {
            let better = foot.converged && !same.converged
                || foot.converged == same.converged && foot.residual < same.residual;
            // A foot inside is more than one that was held at the border of a piece.
            if better && !foot.held.iter().any(|h| *h) {
                *same = foot;
            }
        }
    }
    kept
}

/// The point of a curve nearest to `p`.
///
/// From a `start` it is the foot that descent from there leads to, a local minimum; if the descent
/// fails, the nearest point of all, reported as [`LocateStatus::Fallback`]. Without a start it is
/// the nearest point of all; equally near ones (to 1e-9 of the size) are reported as
/// [`LocateStatus::Multiple`]. Ends count: [`LocateStatus::EdgeClamped`].
pub fn nearest_on_curve(curve: &dyn Curve<f64>, p: Vec3, start: Option<f64>) -> Solution<1> {
    if let Some(t) = start {
        let ends = [curve.jet(0.0, Order::Zero)[0], curve.jet(0.5, Order::Zero)[0]];
        let around = Box3::around([ends[0], ends[1], curve.jet(1.0, Order::Zero)[0]]);
        let size = size_of(&around);
        let sought = Sought::new(p, &around, size);
        let foot = on_whole_curve(curve, sought.p, t, size);
        if foot.converged {
            return solution(&[t], vec![foot]);
        }
    }
    let tree = CurveTree::new(curve);
    let mut found = nearest_in_curve(curve, &tree, p, start);
    if start.is_some() && found.report.status.is_solution() {
        found.report.status = LocateStatus::Fallback;
    }
    found
}

/// As `nearest_on_curve`, on a curve divided before and without a start.
pub fn nearest_in_curve(
    curve: &dyn Curve<f64>,
    tree: &CurveTree,
    p: Vec3,
    start: Option<f64>,
) -> Solution<1> {
    let Sought { near, p, slop } = Sought::new(p, &tree.bounds, tree.size);
    let mut looks = 0;
    let mut order: Vec<(f64, usize)> = tree
        .pieces
        .iter()
        .enumerate()
        .map(|(k, piece)| (distance_sq(&piece.bounds(), near), k))
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut best = f64::INFINITY;
    let mut feet = Vec::new();
    for (low, k) in order {
        if low.sqrt() > best + slop {
            break;
        }
        let mut stack = vec![tree.pieces[k]];
        while let Some(piece) = stack.pop() {
            if distance_sq(&piece.bounds(), near).sqrt() > best + slop {
                continue;
            }
            looks += 1;
            let [t0, t1] = piece.t;
            let feet_there = piece.feet(near);
            if feet_there == Feet::Elsewhere {
                continue;
            }
            if t1 - t0 < 1e-5 || feet_there == Feet::One || looks > MOST_LOOKS[0] {
                let foot = curve_foot(curve, near, 0.5 * (t0 + t1), [t0, t1], tree.size);
                best = best.min(foot.xyz.distance(near));
                feet.push(foot);
            } else {
                stack.extend(piece.halves());
            }
        }
    }
    // From the border of a piece into the neighbours, and to full accuracy.
    let whole = |foot: Foot<1>| on_whole_curve(curve, p, foot.at[0], tree.size);
    let feet = nearest_of(feet, near, tree.size).into_iter().map(whole).collect();
    let mut feet = nearest_of(feet, near, tree.size);
    if feet.is_empty() {
        // Distances beyond all numbers: no piece is nearer than another.
        feet.push(Foot {
            converged: false,
            ..whole(curve_foot(curve, p, 0.5, [0.0, 1.0], tree.size))
        });
    }
    solution(&[start.unwrap_or(0.5)], feet)
}

/// The point of a surface nearest to `p`; see [`nearest_on_curve`].
pub fn nearest_on_surface(
    surface: &dyn Surface<f64>,
    p: Vec3,
    start: Option<[f64; 2]>,
) -> Solution<2> {
    if let Some(uv) = start {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 0.5]];
        let corners = corners.map(|[u, v]| surface.jet(u, v, Order::Zero).p);
        let around = Box3::around(corners);
        let size = size_of(&around);
        let sought = Sought::new(p, &around, size);
        let foot = on_whole_surface(surface, sought.p, uv, size);
        let foot = across_poles(surface, sought.p, foot, size);
        if foot.converged {
            return solution(&uv, vec![foot]);
        }
        let feet = creased(surface, p, vec![foot], size);
        if feet[0].converged {
            return solution(&uv, feet);
        }
    }
    let tree = SurfaceTree::new(surface);
    let mut found = nearest_in_surface(surface, &tree, p, start);
    if start.is_some() && found.report.status.is_solution() {
        found.report.status = LocateStatus::Fallback;
    }
    found
}

/// As `nearest_on_surface`, on a surface divided before and without a start. For many points see
/// [`crate::NearestSurface`].
pub fn nearest_in_surface(
    surface: &dyn Surface<f64>,
    tree: &SurfaceTree,
    p: Vec3,
    start: Option<[f64; 2]>,
) -> Solution<2> {
    let Sought { near, p, slop } = Sought::new(p, &tree.bounds, tree.size);
    let mut looks = 0;
    // A good bound before anything else: the foot near the nearest corner of a piece.
    let from = tree.patches.iter().map(|patch| patch.net[0].distance(near));
    let corner = from.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |c| c.0);
    let [[u, _], [v, _]] = tree.patches[corner].uv;
    let foot = surface_foot(surface, near, [u, v], [[0.0, 1.0]; 2], tree.size);
    let mut best = tree.reach_sq(near).sqrt().min(foot.xyz.distance(near));
    let mut order: Vec<(f64, usize)> = Vec::new();
    tree.boxes.visit(
        |b| distance_sq(b, near).sqrt() <= best + slop,
        |k| order.push((distance_sq(&tree.patches[k as usize].bounds(), near), k as usize)),
    );
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut feet: Vec<Foot<2>> = Vec::new();
    for (low, k) in order {
        if low.sqrt() > best + slop {
            break;
        }
        let mut stack: Vec<BezierPatch> = vec![tree.patches[k]];
        while let Some(patch) = stack.pop() {
            let low = distance_sq(&patch.bounds(), near).sqrt();
            if low > best + slop {
                continue;
            }
            looks += 1;
            let [a, b] = patch.lengths();
            let feet_there = patch.feet(near);
            if feet_there == Feet::Elsewhere {
                continue;
            }
            let small = a.max(b) < 1e-5 * tree.size || looks > MOST_LOOKS[1];
            if small || feet_there == Feet::One {
                let foot = surface_foot(surface, near, patch.middle(), patch.uv, tree.size);
                best = best.min(foot.xyz.distance(near));
                feet.push(foot);
                continue;
            }
            // The nearer half last, so that it is tested first.
            let mut parts =
                patch.halves(usize::from(b > a)).map(|q| (distance_sq(&q.bounds(), near), q));
            if parts[0].0 < parts[1].0 {
                parts.swap(0, 1);
            }
            stack.extend(parts.map(|(_, q)| q));
        }
    }
    feet.push(foot);
    // From the border of a piece into the neighbours, and to full accuracy.
    let whole = |foot: Foot<2>| on_whole_surface(surface, p, foot.at, tree.size);
    let feet = nearest_of(feet, near, tree.size).into_iter().map(whole).collect();
    let mut feet = nearest_of(feet, near, tree.size);
    if !tree.exact && (feet.len() > 1 || !feet[0].converged) {
        feet = creased(surface, p, feet, tree.size);
    }
    solution(&start.unwrap_or([0.5, 0.5]), feet)
}
