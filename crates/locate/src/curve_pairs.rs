//! Intersections and nearest points of two curves: pairs of pieces with bounds of the distance and
//! its slopes.
//!
//! A pair is excluded if it is too far apart for an intersection, or if the distance decreases
//! towards a side beyond which a neighbour continues. If the distance is convex over a pair there
//! is one minimum, found by a descent within the pair. Other pairs are halved. So on curves whose
//! pieces are exact (see [`crate::pieces`]) no intersection is missed; contacts are resolved to
//! `SMALLEST` of the size. Without an intersection, the same search with the smallest distance as
//! its bound finds the nearest points; for parallel curves it finds one such pair.

use crate::newton::NewtonResult;
use crate::pieces::{CurvePiece, ball, size_of};
use crate::report::{FoundRoot, LocateReport, Roots, Solution};
use crate::roots::{RootCollector, TANGENT, from_all, taken};
use crate::tree::CurveTree;
use moldloft_num::{Box3, Curve, CurveJet, Order, Vec3};

/// Distance, relative to the size, below which curves intersect: curves in space that are
/// constructed to intersect do so to rounding only.
const JOINED: f64 = 1e-9;

/// Minimum distance, relative to the size, of separate contacts without a transversal crossing.
const TOUCH: f64 = 1e-10;

/// Size of pairs, relative to that of the curves, below which they are not halved.
const SMALLEST: f64 = 1e-6;

/// Maximum number of pairs in the search for the nearest points of curves that do not intersect.
const MOST_NEAREST: usize = 20_000;

/// Relative difference of distances below which a pair of points is not nearer.
const NEARER: f64 = 1e-12;

const MOST_STEPS: u32 = 40;

/// A point at which the distance is least in a rectangle of parameters.
struct LeastPlace {
    at: [f64; 2],
    distance: f64,
    steps: u32,
}

/// Result of the bounds for a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PairVerdict {
    /// The least distance is that of a neighbouring pair.
    Elsewhere,
    /// There is at most one such point.
    One,
    Unknown,
}

fn sine_between(a: &dyn Curve<f64>, b: &dyn Curve<f64>, [t, s]: [f64; 2]) -> f64 {
    let (x, y) = (a.jet(t, Order::First)[1], b.jet(s, Order::First)[1]);
    x.cross(y).norm() / (x.norm() * y.norm()).max(f64::MIN_POSITIVE)
}

/// The least distance of two boxes.
fn between_boxes(p: &Box3, q: &Box3) -> f64 {
    let out = |l: f64, h: f64, m: f64, n: f64| (l - n).max(m - h).max(0.0);
    let d = Vec3::of(
        out(p.low.x, p.high.x, q.low.x, q.high.x),
        out(p.low.y, p.high.y, q.low.y, q.high.y),
        out(p.low.z, p.high.z, q.low.z, q.high.z),
    );
    d.norm()
}

/// A distance that a pair is apart at least: of the boxes, or across the first piece towards the second.
fn apart(p: &CurvePiece, q: &CurvePiece) -> f64 {
    let boxes = between_boxes(&p.bounds(), &q.bounds());
    let chord = p.net[3] - p.net[0];
    let away = (q.net[0] + q.net[3] - p.net[0] - p.net[3]) * 0.5;
    let along = chord.norm_sq();
    let across = if along > 0.0 { away - chord * (away.dot(chord) / along) } else { away };
    let Some(n) = across.normalized() else { return boxes };
    let reach = |net: &[Vec3; 4], sign: f64| {
        net.iter().map(|x| sign * n.dot(*x - p.net[0])).fold(f64::NEG_INFINITY, f64::max)
    };
    boxes.max(-reach(&q.net, -1.0) - reach(&p.net, 1.0) - p.slack - q.slack)
}

/// A set of vectors: its centre, and its radius.
type VectorBall = (Vec3, f64);

/// Positions, slopes and curvatures of a piece with respect to its relative parameter.
fn balls(piece: &CurvePiece) -> [VectorBall; 3] {
    let b = &piece.net;
    let first = [0, 1, 2].map(|k| (b[k + 1] - b[k]) * 3.0);
    let second = [0, 1].map(|k| (first[k + 1] - first[k]) * 2.0);
    let (s, w) = (piece.slack, piece.share);
    let with = |all: &[Vec3], slack: f64| {
        let (c, r) = ball(all);
        (c, r + slack)
    };
    // An error between nodes of size s has slopes of some 10 s and curvatures of 40 s.
    [with(b, s), with(&first, 10.0 * s * w), with(&second, 40.0 * s * w * w)]
}

/// Result of the derivatives of the distance over a whole pair.
fn verdict(p: &CurvePiece, q: &CurvePiece) -> PairVerdict {
    let ([x, d, dd], [y, e, ee]) = (balls(p), balls(q));
    let (away, reach) = (x.0 - y.0, x.1 + y.1);
    let far = away.norm();
    let mut held = [false; 2];
    for (k, ((slope, turn), sign, piece)) in [(d, 1.0, p), (e, -1.0, q)].into_iter().enumerate() {
        let by = sign * slope.dot(away);
        if by.abs() > slope.norm() * reach + turn * (far + reach) {
            if !piece.open[usize::from(by < 0.0)] {
                return PairVerdict::Elsewhere;
            }
            held[k] = true;
        }
    }
    let curvature = |slope: VectorBall, bend: VectorBall, sign: f64| {
        let change = 2.0 * slope.0.norm() * slope.1
            + slope.1 * slope.1
            + far * bend.1
            + reach * (bend.0.norm() + bend.1);
        slope.0.norm_sq() + sign * bend.0.dot(away) - change
    };
    let (along_p, along_q) = (curvature(d, dd, 1.0), curvature(e, ee, -1.0));
    let one = match held {
        [true, true] => true,
        [true, false] => along_q > 0.0,
        [false, true] => along_p > 0.0,
        [false, false] => {
            let mixed = d.0.dot(e.0).abs() + d.0.norm() * e.1 + e.0.norm() * d.1 + d.1 * e.1;
            along_p > 0.0 && along_q > 0.0 && along_p * along_q > mixed * mixed
        }
    };
    if one { PairVerdict::One } else { PairVerdict::Unknown }
}

/// A curve at the parameter `t` of a cell, with the derivatives of its inner side: at a joint a curve has those of what follows.
fn within(curve: &dyn Curve<f64>, t: f64, [_, end]: [f64; 2]) -> CurveJet<f64> {
    if t < end || end >= 1.0 {
        return curve.jet(t, Order::Second);
    }
    let [_, d, dd] = curve.jet(end.next_down(), Order::Second);
    [curve.jet(t, Order::Zero)[0], d, dd]
}

/// Half the square of the distance, its slopes and its second derivatives.
fn square(
    a: &dyn Curve<f64>,
    b: &dyn Curve<f64>,
    [t, s]: [f64; 2],
    cell: [[f64; 2]; 2],
) -> (f64, [f64; 2], [f64; 3], [f64; 2]) {
    let (x, y) = (within(a, t, cell[0]), within(b, s, cell[1]));
    let r = x[0] - y[0];
    let plain = [x[1].norm_sq(), y[1].norm_sq()];
    let second = [plain[0] + x[2].dot(r), -x[1].dot(y[1]), plain[1] - y[2].dot(r)];
    (0.5 * r.norm_sq(), [x[1].dot(r), -y[1].dot(r)], second, plain)
}

/// Descent to a minimum of the distance within a rectangle: Newton's steps, projected to the
/// rectangle and halved while the distance does not decrease; terms with second derivatives are
/// left out if they are not convex. Where the step along both parameters is stopped by a side, those
/// along one of them lead on: the minimum of a convex distance is that along both.
fn descend(
    a: &dyn Curve<f64>,
    b: &dyn Curve<f64>,
    start: [f64; 2],
    cell: [[f64; 2]; 2],
) -> LeastPlace {
    let mut at = start;
    let mut here = square(a, b, at, cell);
    let mut steps = 0;
    let nearer = |at: [f64; 2], step: [f64; 2], value: f64| {
        (0..30).find_map(|halvings| {
            let share = 0.5f64.powi(halvings);
            let next: [f64; 2] =
                std::array::from_fn(|k| (at[k] + share * step[k]).clamp(cell[k][0], cell[k][1]));
            let there = (next != at).then(|| square(a, b, next, cell))?;
            (there.0 < value).then_some((next, there))
        })
    };
    while steps < MOST_STEPS {
        let (value, slope, second, plain) = here;
        let out = |k: usize| {
            at[k] <= cell[k][0] && slope[k] > 0.0 || at[k] >= cell[k][1] && slope[k] < 0.0
        };
        let free = [!out(0), !out(1)];
        let alone = [[free[0], false], [false, free[1]]];
        let found = [free]
            .into_iter()
            .chain(alone)
            .find_map(|along| nearer(at, newton_step(slope, second, plain, along), value));
        let Some(next) = found else { break };
        (at, here) = next;
        steps += 1;
    }
    LeastPlace { at, distance: (2.0 * here.0).sqrt(), steps }
}

/// Newton's step along the free parameters.
fn newton_step(slope: [f64; 2], [h, m, k]: [f64; 3], plain: [f64; 2], free: [bool; 2]) -> [f64; 2] {
    match free {
        [false, false] => [0.0; 2],
        [true, false] => [-slope[0] / if h > 0.0 { h } else { plain[0] }, 0.0],
        [false, true] => [0.0, -slope[1] / if k > 0.0 { k } else { plain[1] }],
        [true, true] => {
            let convex = |h: f64, k: f64| h > 0.0 && k > 0.0 && h * k - m * m > 1e-14 * h * k;
            let (mut h, mut k) = (h, k);
            if !convex(h, k) {
                [h, k] = plain;
            }
            if !convex(h, k) {
                (h, k) = (h * (1.0 + 1e-6), k * (1.0 + 1e-6));
            }
            let det = h * k - m * m;
            if det > 0.0 {
                [(m * slope[1] - k * slope[0]) / det, (m * slope[0] - h * slope[1]) / det]
            } else {
                [
                    -slope[0] / plain[0].max(f64::MIN_POSITIVE),
                    -slope[1] / plain[1].max(f64::MIN_POSITIVE),
                ]
            }
        }
    }
}

/// Intersection of two curves, as (t, s): the result of descent from a start. Without a start, or
/// if that fails, the one of all intersections nearest to the start in parameters.
///
/// # Errors
/// The report if there is none: with the nearest points of the curves, ends included, and their
/// distance.
pub fn curve_curve(
    a: &dyn Curve<f64>,
    b: &dyn Curve<f64>,
    start: Option<[f64; 2]>,
    tolerance: f64,
) -> Result<Solution<2>, LocateReport> {
    let closed = [a.closed(), b.closed()];
    if let Some(q) = start {
        let size = [a, b].map(CurveTree::new).map(|tree| tree.size);
        let cell = closed.map(|round| if round { [-1.0, 2.0] } else { [0.0, 1.0] });
        let least = descend(a, b, q, cell);
        let found = least.distance <= tolerance.max(JOINED * size[0].min(size[1]));
        let (residual, iterations) = (least.distance, least.steps);
        let walk = NewtonResult { at: least.at, residual, iterations, found, singular: false };
        let walk = walk.within(&closed);
        if let Some(found) = taken(&walk, &q, sine_between(a, b, walk.at)) {
            return Ok(found);
        }
    }
    let all = all_curve_curve(a, b, tolerance);
    let from = start.unwrap_or([0.5; 2]);
    from_all(all, start.as_ref().map(<[f64; 2]>::as_slice), |all| all.nearest_to(&from))
}

/// All intersections of two curves, as (t, s); [`Roots::closest`] is the pair of nearest points if
/// there is none. Curves closer to each other than `tolerance`, or than 1e-9 of their size,
/// intersect.
pub fn all_curve_curve(a: &dyn Curve<f64>, b: &dyn Curve<f64>, tolerance: f64) -> Roots<2> {
    let (ta, tb) = (CurveTree::new(a), CurveTree::new(b));
    PairSearch::new(a, b, size_of_both(&ta, &tb), tolerance).run(&ta, &tb)
}

fn size_of_both(a: &CurveTree, b: &CurveTree) -> f64 {
    a.size.min(b.size).max(1e-15 * size_of(&a.bounds.union(b.bounds)))
}

struct PairSearch<'a> {
    a: &'a dyn Curve<f64>,
    b: &'a dyn Curve<f64>,
    size: f64,
    /// A distance at which curves meet where they cross.
    near: f64,
    closed: [bool; 2],
    found: RootCollector<2>,
    /// A distance that the curves have somewhere.
    bound: f64,
    /// Remaining number of pairs for the nearest points, if these are searched instead of
    /// intersections.
    nearest: Option<usize>,
}

impl<'a> PairSearch<'a> {
    fn new(a: &'a dyn Curve<f64>, b: &'a dyn Curve<f64>, size: f64, tolerance: f64) -> Self {
        let closed = [a.closed(), b.closed()];
        let found = RootCollector::new(size, &[0.5; 2], closed);
        let near = tolerance.max(JOINED * size);
        Self { a, b, size, near, closed, found, bound: f64::INFINITY, nearest: None }
    }

    /// Pairs farther apart are of no interest.
    fn limit(&self) -> f64 {
        if self.nearest.is_some() { self.bound * (1.0 - NEARER) } else { self.near }
    }

    /// Counts a pair; true when there were too many.
    fn exhausted(&mut self) -> bool {
        match &mut self.nearest {
            Some(0) => true,
            Some(left) => {
                *left -= 1;
                false
            }
            None => self.found.exhausted(),
        }
    }

    fn run(mut self, ta: &CurveTree, tb: &CurveTree) -> Roots<2> {
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (i, p) in ta.pieces.iter().enumerate() {
            for (j, q) in tb.pieces.iter().enumerate() {
                self.bound = self.bound.min(p.net[0].distance(q.net[0]) + p.slack + q.slack);
                pairs.push((apart(p, q), i, j));
            }
        }
        // No pair of points has that distance yet: beginnings may be the nearest points.
        self.bound *= 1.0 + 3.0 * NEARER;
        pairs.retain(|pair| pair.0 <= self.bound.max(self.near));
        pairs.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        for nearest in [None, Some(MOST_NEAREST)] {
            self.nearest = nearest;
            for &(low, i, j) in &pairs {
                if low > self.limit() {
                    break;
                }
                self.search(ta.pieces[i], tb.pieces[j]);
            }
            if self.found.any() {
                break;
            }
        }
        self.found.finish()
    }

    fn search(&mut self, p: CurvePiece, q: CurvePiece) {
        let mut stack = vec![(p, q)];
        while let Some((p, q)) = stack.pop() {
            if apart(&p, &q) > self.limit() {
                continue;
            }
            if self.exhausted() {
                return;
            }
            let [la, lb] = [&p, &q].map(|piece| Box3::around(piece.net).diagonal());
            let tiny = la.max(lb) < SMALLEST * self.size;
            let verdict = verdict(&p, &q);
            if verdict == PairVerdict::Elsewhere {
                continue;
            }
            if verdict == PairVerdict::One || tiny {
                let cell = [p.t, q.t];
                let middle = cell.map(|[a, b]| 0.5 * (a + b));
                let least = descend(self.a, self.b, middle, cell);
                self.take(least, verdict == PairVerdict::One);
                continue;
            }
            if la >= lb {
                stack.extend(p.halves().map(|half| (half, q)));
            } else {
                stack.extend(q.halves().map(|half| (p, half)));
            }
        }
    }

    /// Records a point as an intersection, or as the nearest so far.
    fn take(&mut self, least: LeastPlace, convex: bool) {
        if !least.distance.is_finite() {
            return;
        }
        self.bound = self.bound.min(least.distance);
        let (residual, iterations) = (least.distance, least.steps);
        let walk =
            NewtonResult { at: least.at, residual, iterations, found: true, singular: false };
        let at = walk.within(&self.closed).at;
        let tangent = sine_between(self.a, self.b, at) < TANGENT;
        let near = if convex && !tangent { self.near } else { TOUCH * self.size };
        self.found.note(at, residual);
        if residual <= near {
            let xyz = self.a.jet(at[0], Order::Zero)[0];
            self.found.insert(FoundRoot {
                at,
                xyz,
                residual,
                iterations,
                tangent: tangent || !convex,
            });
        }
    }
}
