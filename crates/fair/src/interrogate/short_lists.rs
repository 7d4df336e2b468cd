//! Knuckles of short lists, and neighbours in the wrong order.
//!
//! A station of a boat has seven to twelve points, a line along it up to forty: too few for a scale
//! from other points. A hinge in a cubic is compared with a cubic by their residuals, and with a
//! polynomial of two degrees more, which follows a smooth curve better than a hinge does.

use crate::interrogate::outliers::{DOUBLES_BACK, DataFinding, STANDS_OUT, ThinQr};
use moldloft_num::{Real, Vec3};

/// Points that such a list has, at least and at most: of more the windows have more chances than the
/// scores allow for.
pub(super) const SHORT: [usize; 2] = [7, 44];

/// Maximum number of points used for a hinge, and minimum on either side.
const WINDOW: usize = 11;
const SIDE: usize = 2;

/// Minimum ratio of a hinge to its deviation, by the remaining degrees of freedom, from two on: one
/// false finding in a thousand for Gaussian noise by Student's law, over all positions of a list.
const SCORES: [f64; 6] = [32.0, 13.0, 9.0, 7.5, 6.7, 6.2];

/// Minimum ratio of the squared residuals of a smooth polynomial with one more coefficient to those
/// of the hinge.
const SMOOTHER: f64 = 4.0;

/// Turn, in radians, beyond which both sides of a hinge must turn by less than `BESIDE` of it;
/// otherwise it can be a nose.
const SHARP: f64 = 0.44;
const BESIDE: f64 = 0.5;

/// Turns beside a nose: minimum in radians, and minimum ratio to those next to them.
const LEADS: f64 = 0.02;
const GROWS: f64 = 1.3;

/// Squared residual of a least-squares fit, and its coefficients.
fn left<const C: usize>(
    rows: Vec<[f64; C]>,
    points: &[Vec3<f64>],
) -> Option<(f64, [Vec3<f64>; C], f64)> {
    let columns = ThinQr::new(rows.clone())?;
    let c = columns.solve(points);
    let off = |(row, p): (&[f64; C], &Vec3<f64>)| {
        let on = row.iter().zip(&c).fold(Vec3::zero(), |s, (&x, &c)| s + c * x);
        (*p - on).norm_sq()
    };
    let last = columns.last();
    Some((rows.iter().zip(points).map(off).sum(), c, last))
}

/// The hinge at a position of a list, if there is one.
fn hinge(points: &[Vec3<f64>], at: usize, floor: f64) -> Option<DataFinding> {
    let n = points.len();
    let half = WINDOW / 2;
    let low = at.saturating_sub(half).min(n.saturating_sub(WINDOW));
    let high = (low + WINDOW).min(n);
    if at < low + SIDE || at + SIDE >= high {
        return None;
    }
    let own = &points[low..high];
    let mut chord = vec![0.0];
    for w in own.windows(2) {
        chord.push(chord.last()? + (w[1] - w[0]).norm());
    }
    let size = chord[own.len() - 1].max(f64::MIN_POSITIVE);
    let t: Vec<f64> = chord.iter().map(|c| 2.0 * (c - chord[at - low]) / size).collect();
    let smooth = |x: f64| [1.0, x, x * x, x * x * x];
    let hinged = |x: f64| [1.0, x, x * x, x * x * x, x.max(0.0)];
    let higher = |x: f64| [1.0, x, x * x, x.powi(3), x.powi(4), x.powi(5)];
    let freedom = own.len() - 5;
    let (squares, c, last) = left(t.iter().map(|&x| hinged(x)).collect(), own)?;
    let (without, ..) = left(t.iter().map(|&x| smooth(x)).collect(), own)?;
    let squares = squares.max(freedom as f64 * floor * floor);
    if own.len() > 6 {
        let (followed, ..) = left(t.iter().map(|&x| higher(x)).collect(), own)?;
        if followed < SMOOTHER * squares {
            return None;
        }
    }
    if without <= squares {
        return None;
    }
    let middle = c[1] + c[4] * 0.5;
    let speed = middle.norm();
    let across = c[4] - middle * (c[4].dot(middle) / (speed * speed));
    let deviation = (squares / freedom as f64).sqrt() / last;
    let score = across.norm() / deviation.max(f64::MIN_POSITIVE);
    let least = SCORES[(freedom - 2).min(SCORES.len() - 1)];
    let angle = Real::atan2(across.norm(), speed);
    let turned = |a: usize, b: usize| {
        let (u, v) = (own[a + 1] - own[a], own[b] - own[b - 1]);
        Real::atan2(u.cross(v).norm(), u.dot(v))
    };
    let beside = turned(0, at - low).max(turned(at - low, own.len() - 1));
    let turn = |k: usize| {
        let (u, v) = (points[k] - points[k - 1], points[k + 1] - points[k]);
        Real::atan2(u.cross(v).norm(), u.dot(v))
    };
    let turns = |range: std::ops::Range<usize>| range.map(turn).fold(0.0, f64::max);
    let inner = (low + 1, high - 1);
    let others = turns(inner.0..at).max(turns(at + 1..inner.1));
    // The largest hinge of the polygon is its own; of a nose it doubles back, or turns lead up to
    // it.
    let (own_turn, near) = (turn(at), turn(at - 1).min(turn(at + 1)));
    let farther = turns(inner.0..at - 1).max(turns((at + 2).min(inner.1)..inner.1));
    let led = near > LEADS && near > GROWS * farther;
    let nose = angle > SHARP
        && (beside > BESIDE * angle
            || own_turn > DOUBLES_BACK
            || led
            || own_turn < STANDS_OUT * others);
    let largest = own_turn >= others;
    (score >= least && !nose && largest).then_some(DataFinding::Knuckle { index: at, angle, score })
}

/// The clearest hinge of each side, hinge after hinge.
pub(super) fn short_knuckles(points: &[Vec3<f64>], floor: f64) -> Vec<DataFinding> {
    let score = |f: &DataFinding| match f {
        DataFinding::Knuckle { score, .. } => *score,
        _ => 0.0,
    };
    let mut out: Vec<DataFinding> = Vec::new();
    let mut parts = vec![(0, points.len())];
    while let Some((from, to)) = parts.pop() {
        if to - from < SHORT[0] {
            continue;
        }
        let own = &points[from..to];
        let found = (1..own.len() - 1).filter_map(|k| hinge(own, k, floor));
        let Some(best) = found.max_by(|a, b| score(a).total_cmp(&score(b))) else { continue };
        let DataFinding::Knuckle { index, angle, score } = best else { continue };
        parts.extend([(from, from + index + 1), (from + index, to)]);
        out.push(DataFinding::Knuckle { index: from + index, angle, score });
    }
    out.sort_by_key(DataFinding::index);
    out
}

/// Reversed order of points: the minimum backward step relative to its neighbours, the maximum
/// length of the reordered path relative to the given one, and the maximum fraction of backward
/// steps in a list; with more of them noise exceeds the steps.
const BACK: f64 = 0.25;
const SHORTER: f64 = 0.8;
const FEW: f64 = 0.1;

/// The first of each two neighbours in the wrong order: the polyline through them reverses, and in
/// the other order it does not.
pub(super) fn swapped(points: &[Vec3<f64>], closed: bool) -> Vec<usize> {
    let n = points.len();
    if n < SHORT[0] {
        return Vec::new();
    }
    let place = |k: usize| points[k % n];
    let range = if closed { 0..n } else { 0..n - 3 };
    let wrong = |&k: &usize| {
        let [a, b, c, d] = [place(k), place(k + 1), place(k + 2), place(k + 3)];
        let way = d - a;
        let square = way.norm_sq();
        let forward = |from: Vec3<f64>, to: Vec3<f64>| (to - from).dot(way) / square;
        let before = (b - a).norm() + (c - b).norm() + (d - c).norm();
        let after = (c - a).norm() + (b - c).norm() + (d - b).norm();
        forward(b, c) < -BACK
            && [(a, c), (c, b), (b, d)].into_iter().all(|(from, to)| forward(from, to) > 0.0)
            && after < SHORTER * before
    };
    let found: Vec<usize> = range.filter(wrong).map(|k| (k + 1) % n).collect();
    let back = (0..n - 2)
        .filter(|&k| (points[k + 1] - points[k]).dot(points[k + 2] - points[k + 1]) < 0.0)
        .count();
    // A pair reverses the polygon twice.
    if back as f64 > 2.0 * found.len() as f64 + FEW * n as f64 { Vec::new() } else { found }
}
