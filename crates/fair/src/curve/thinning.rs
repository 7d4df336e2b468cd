//! Few knots for many data.
//!
//! With a knot at each of ten thousand data, third derivatives have no digits left, and most knots
//! are determined by noise. The number of knots is therefore chosen from the data: a span is halved
//! while the least-squares residuals on it have a pattern. For white noise the squared sums of
//! blocks are as large as differences between consecutive data predict; they are larger where the
//! spline is too stiff. All spans are halved once more, to leave freedom for fairing, and those on
//! which the tolerances do not hold. Parameters are those of the feet on the resulting curve
//! (Hoschek 1988), so that residuals are distances from it.

use crate::curve::centre::centre;
use crate::curve::exact::is_exact;
use crate::curve::fit::{released, values};
use crate::curve::least_squares::LeastSquares;
use crate::curve::space::BezierExtraction;
use crate::measure::gauss;
use crate::{EndContinuity, FairError, InterpolationSpace, Limit, Motion, Space};
use moldloft_num::Vec3;
use moldloft_spline::KnotVector;

/// Fewer data have a knot each.
pub(crate) const MANY_DATA: usize = 500;

/// Spans to begin with, and data that a span has at least.
const FIRST_SPANS: usize = 8;
const SPAN_DATA: usize = 8;

/// Minimum number of data per span for halving because of tolerances, and minimum average over all
/// spans.
const NARROW_DATA: usize = 4;
const SPARSE: usize = 3;

/// Blocks of a span, and the number of standard deviations beyond which their sums are not noise.
const BLOCKS: usize = 8;
const DEVIATIONS: f64 = 4.0;

/// Residuals below this fraction of the tolerance are small enough.
const FINE: f64 = 1e-4;

/// Rounds of halving at most, and of feet once no span is halved.
const ROUNDS: usize = 24;
const FOOT_ROUNDS: usize = 3;

/// Maximum ratio of the lengths of averages over n and 2n points at which the difference is noise.
const SAME_LENGTH: f64 = 1.03;

/// Averages at least.
const FEWEST_BLOCKS: usize = 64;

/// The curvature, in means, from which on parameters run faster, and parts of a span that are as long as each other.
const SHARP: f64 = 2.0;
const PARTS: usize = 8;

/// Curves beside the data on a spline of few knots.
#[derive(Clone, Debug)]
pub(crate) struct CurvesBesideData {
    /// The control points of the curve of least squares, each over its tolerance.
    pub nearest: Vec<Vec3<f64>>,
    /// Control points of a curve strictly inside the tolerances.
    pub centre: Vec<Vec3<f64>>,
}

/// A spline with few knots for many data within tolerances, and the parameters of the data. `None`
/// if the data are few or exact, if some have no tolerance of their own, if their motion is
/// restricted (except along one direction, from stations on a line, which are then the parameters),
/// or if no such spline is within the tolerances. With `turning`, parameters advance faster where
/// the curve turns, as in [`crate::curvature_parameters`].
///
/// # Errors
/// [`FairError`] of the spaces of splines.
///
/// # Example
/// ```
/// use moldloft_fair::{EndContinuity, Limit, thinned};
/// use moldloft_num::Vec3;
/// let noise = |i: usize| 1e-3 * ((i * i * 7919 % 1009) as f64 / 1009.0 - 0.5);
/// let points: Vec<_> = (0..2000).map(|i| Vec3::of(i as f64 / 2e3, (i as f64 / 700.0).sin() + noise(i), 0.0)).collect();
/// let limit = Limit::ball(points.len(), 1e-3).unwrap();
/// let free = [EndContinuity::Free; 2];
/// let layout = thinned(&points, &limit, free, 3, false, true).unwrap().unwrap();
/// assert!(4 * layout.space.count() < points.len());
/// ```
pub fn thinned(
    points: &[Vec3<f64>],
    limit: &Limit,
    ends: [EndContinuity; 2],
    degree: usize,
    closed: bool,
    turning: bool,
) -> Result<Option<InterpolationSpace>, FairError> {
    let n = points.len();
    let kept = |e: &EndContinuity| matches!(e, EndContinuity::Free | EndContinuity::Position);
    let some = limit.radii.iter().all(|r| *r > 0.0 && r.is_finite());
    let plain = some && (closed || ends.iter().all(kept));
    if n < MANY_DATA || degree < 3 || !plain || is_exact(points, &[], closed) {
        return Ok(None);
    }
    let stations = match limit.motion {
        Motion::Ball => None,
        Motion::Along(d) if !closed => match stations(points, d) {
            None => return Ok(None),
            some => some,
        },
        _ => return Ok(None),
    };
    let mut thinning = Thinning::new(points, limit, degree, closed);
    if let Some(at) = stations {
        thinning.knots = thinning.bounds.iter().map(|&b| at[b]).collect();
        (thinning.at, thinning.stationed) = (at, true);
    }
    thinning.hold = ends.map(|e| e != EndContinuity::Free && !closed);
    thinning.run(turning)
}

/// Deviation of stations from a line, relative to the extent, up to which they are on it.
const IN_LINE: f64 = 1e-12;

/// Increasing parameters in [0, 1] of points that move in one direction, from their stations;
/// `None` if these are not on a line or coincide.
fn stations(points: &[Vec3<f64>], along: Vec3<f64>) -> Option<Vec<f64>> {
    let flat = |p: &Vec3<f64>| *p - along * along.dot(*p);
    let (first, last) = (flat(points.first()?), flat(points.last()?));
    let way = last - first;
    let length = way.norm();
    let axis = way.normalized()?;
    let mut at = Vec::with_capacity(points.len());
    for p in points {
        let off = flat(p) - first;
        let t = axis.dot(off) / length;
        let aside = (off - axis * axis.dot(off)).norm();
        if aside > IN_LINE * length || at.last().is_some_and(|before| t <= *before) {
            return None;
        }
        at.push(t);
    }
    at[points.len() - 1] = 1.0;
    Some(at)
}

/// A spline whose spans grow in number.
struct Thinning<'a> {
    points: &'a [Vec3<f64>],
    radii: &'a [f64],
    /// Weights of the squared residuals.
    weights: Vec<f64>,
    degree: usize,
    closed: bool,
    /// True for the ends that stay at their data.
    hold: [bool; 2],
    /// The data at which spans begin, and of an open curve the last one.
    bounds: Vec<usize>,
    /// The parameters of these, and of the data.
    knots: Vec<f64>,
    at: Vec<f64>,
    /// True if the data keep their parameters.
    stationed: bool,
}

/// The spline, the control points and the residuals of a fit.
struct FittedSpline {
    space: Space,
    control: Vec<Vec3<f64>>,
    pieces: BezierCurve,
}

impl<'a> Thinning<'a> {
    fn new(points: &'a [Vec3<f64>], limit: &'a Limit, degree: usize, closed: bool) -> Self {
        let n = points.len();
        let open = released(points, &limit.radii);
        let weight = |(r, open): (&f64, bool)| if open { 0.0 } else { 1.0 / (r * r) };
        let at = pilot(points, closed);
        let spans = FIRST_SPANS.max(2 * degree + 2);
        let last = if closed { n } else { n - 1 };
        let mut bounds: Vec<usize> = (0..spans).map(|k| k * last / spans).collect();
        if !closed {
            bounds.push(last);
        }
        let knots = bounds.iter().map(|&b| at[b]).collect();
        Self {
            points,
            radii: &limit.radii,
            weights: limit.radii.iter().zip(open).map(weight).collect(),
            degree,
            closed,
            hold: [false; 2],
            bounds,
            knots,
            at,
            stationed: false,
        }
    }

    fn run(&mut self, turning: bool) -> Result<Option<InterpolationSpace>, FairError> {
        let mut feet = 0;
        for _ in 0..ROUNDS {
            let Some(fitted) = self.fitted()? else { return Ok(None) };
            let split = self.patterned(&fitted);
            if split.contains(&true) {
                self.halve(&split);
                continue;
            }
            if feet == FOOT_ROUNDS {
                break;
            }
            feet += 1;
            self.place_at_feet(&fitted);
        }
        let Some(fitted) = self.fitted()? else { return Ok(None) };
        self.place_by_length(&fitted, turning);
        for _ in 0..FOOT_ROUNDS {
            let Some(fitted) = self.fitted()? else { return Ok(None) };
            self.place_at_feet(&fitted);
        }
        let wide = self.spans().map(|s| s.len() >= 2 * SPAN_DATA).collect::<Vec<_>>();
        self.halve(&wide);
        for _ in 0..ROUNDS {
            let Some(fitted) = self.fitted()? else { return Ok(None) };
            self.place_at_feet(&fitted);
            let Some(fitted) = self.fitted()? else { return Ok(None) };
            let rows = values(&fitted.space, &self.at);
            let least = self.least(&fitted.space);
            let free: Vec<bool> = least.free();
            match centre(&rows, self.points, self.radii, &fitted.control, &least.order, &free)? {
                Ok(centre) => {
                    let thin = CurvesBesideData { nearest: fitted.control, centre };
                    let at = std::mem::take(&mut self.at);
                    return Ok(Some(InterpolationSpace::thin(fitted.space, at, rows, thin)));
                }
                Err(beyond) => {
                    // Spans on which the tolerances do not hold are halved.
                    let narrow = |s: &std::ops::Range<usize>| {
                        s.len() >= 2 * NARROW_DATA && s.clone().any(|i| beyond[i])
                    };
                    let split: Vec<bool> = self.spans().map(|s| narrow(&s)).collect();
                    if !split.contains(&true) || SPARSE * self.bounds.len() > self.points.len() {
                        return Ok(None);
                    }
                    self.halve(&split);
                }
            }
        }
        Ok(None)
    }

    /// The data of each span.
    fn spans(&self) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        let n = self.points.len();
        let last = if self.closed { self.bounds.len() } else { self.bounds.len() - 1 };
        (0..last).map(move |k| self.bounds[k]..self.bounds.get(k + 1).copied().unwrap_or(n))
    }

    fn halve(&mut self, split: &[bool]) {
        let n = self.points.len();
        let (mut bounds, mut knots) = (Vec::new(), Vec::new());
        let spans: Vec<_> = self.spans().collect();
        for (k, span) in spans.iter().enumerate() {
            bounds.push(self.bounds[k]);
            knots.push(self.knots[k]);
            if split[k] {
                let end = self.knots.get(k + 1).copied().unwrap_or(1.0);
                // Feet need not be in the order of the data.
                let middle = (span.start + span.end) / 2;
                let own = self.at[middle];
                let low = self.knots[k] + 0.1 * (end - self.knots[k]);
                let high = end - 0.1 * (end - self.knots[k]);
                bounds.push(middle);
                knots.push(own.clamp(low, high));
            }
        }
        if !self.closed {
            bounds.push(n - 1);
            knots.push(1.0);
        }
        (self.bounds, self.knots) = (bounds, knots);
    }

    fn space(&self) -> Result<Space, FairError> {
        if self.closed {
            return Space::periodic(self.degree, self.knots.clone(), 1.0);
        }
        let p = self.degree;
        let inner = &self.knots[1..self.knots.len() - 1];
        let mut knots = vec![0.0; p + 1];
        knots.extend_from_slice(inner);
        knots.extend(std::iter::repeat_n(1.0, p + 1));
        Space::open(KnotVector::new(p, knots)?)
    }

    fn least(&self, space: &Space) -> LeastSquares {
        let n = self.points.len();
        let mut fixed = Vec::new();
        if self.hold[0] {
            fixed.push((0, self.points[0]));
        }
        if self.hold[1] {
            fixed.push((space.count() - 1, self.points[n - 1]));
        }
        LeastSquares::new(space, fixed)
    }

    /// The curve of least squares.
    fn fitted(&self) -> Result<Option<FittedSpline>, FairError> {
        let space = self.space()?;
        let rows = values(&space, &self.at);
        let control = self.least(&space).solve(&rows, self.points, &self.weights)?;
        Ok(control.map(|control| {
            let pieces = BezierCurve::of(&space, &control);
            FittedSpline { space, control, pieces }
        }))
    }

    /// For each span, true if its residuals have a pattern.
    fn patterned(&self, fitted: &FittedSpline) -> Vec<bool> {
        let across: Vec<Vec3<f64>> = (0..self.points.len())
            .map(|i| {
                let [p, along, _] = fitted.pieces.at(self.at[i]);
                let off = p - self.points[i];
                // Relative to the tolerance; released data have no influence.
                let scale = self.weights[i].sqrt();
                let normal =
                    off - along * (off.dot(along) / along.norm_sq().max(f64::MIN_POSITIVE));
                normal * scale
            })
            .collect();
        let of = |span: std::ops::Range<usize>| {
            let n = span.len();
            let own = &across[span];
            let rms = (own.iter().map(|r| r.norm_sq()).sum::<f64>() / n as f64).sqrt();
            if n < 2 * SPAN_DATA || rms <= FINE {
                return false;
            }
            let steps: f64 = own.windows(2).map(|w| (w[1] - w[0]).norm_sq()).sum();
            let noise = 0.5 * steps / (n - 1) as f64;
            let blocks = (0..BLOCKS).map(|b| &own[b * n / BLOCKS..(b + 1) * n / BLOCKS]);
            let sums = blocks.map(|b| {
                let sum = b.iter().fold(Vec3::zero(), |s, &r| s + r);
                sum.norm_sq() / b.len() as f64
            });
            // In one direction: the squares of eight sums have the mean 8 and the variance 16.
            let most = BLOCKS as f64 + DEVIATIONS * (2.0 * BLOCKS as f64).sqrt();
            sums.sum::<f64>() > most * noise
        };
        self.spans().map(of).collect()
    }

    /// Takes for parameters those of the feet of the data; ends stay at the ends.
    fn place_at_feet(&mut self, fitted: &FittedSpline) {
        if self.stationed {
            return;
        }
        let n = self.points.len();
        let inner = if self.closed { 0..n } else { 1..n - 1 };
        for i in inner {
            let mut t = self.at[i];
            for _ in 0..2 {
                let [p, along, bend] = fitted.pieces.at(t);
                let off = p - self.points[i];
                let square = along.norm_sq();
                let full = square + off.dot(bend);
                let by = if full > 0.2 * square { full } else { square };
                if by <= 0.0 {
                    break;
                }
                let longest = fitted.pieces.longest_step(t);
                t -= (off.dot(along) / by).clamp(-longest, longest);
                t = if self.closed { t.rem_euclid(1.0) } else { t.clamp(0.0, 1.0) };
            }
            self.at[i] = if t < 1.0 || !self.closed { t } else { 0.0 };
        }
    }

    /// Takes lengths for parameters, longer ones where the curve turns.
    fn place_by_length(&mut self, fitted: &FittedSpline, turning: bool) {
        if self.stationed {
            return;
        }
        let pieces = &fitted.pieces;
        let rule = gauss(3);
        let mut stops: Vec<f64> = Vec::new();
        let mut parts: Vec<(f64, f64)> = Vec::new();
        for piece in &pieces.all {
            for k in 0..PARTS {
                let h = (piece.end - piece.start) / PARTS as f64;
                let a = piece.start + h * k as f64;
                stops.push(a);
                let (mut length, mut turn) = (0.0, 0.0);
                for &(x, w) in &rule {
                    let [_, d1, d2] = pieces.at(a + h * 0.5 * (1.0 + x));
                    let square = d1.norm_sq().max(f64::MIN_POSITIVE);
                    length += square.sqrt() * h * 0.5 * w;
                    turn += d1.cross(d2).norm() / square * h * 0.5 * w;
                }
                parts.push((length, turn));
            }
        }
        stops.push(1.0);
        let sum = |of: fn(&(f64, f64)) -> f64| parts.iter().map(of).sum::<f64>();
        let mean = SHARP * sum(|p| p.1) / sum(|p| p.0).max(f64::MIN_POSITIVE);
        let mut run = vec![0.0];
        for &(length, turn) in &parts {
            let ratio =
                if mean > 0.0 { turn / (length * mean).max(f64::MIN_POSITIVE) } else { 0.0 };
            let by = if turning { (1.0 + ratio * ratio).sqrt().sqrt() } else { 1.0 };
            run.push(run[run.len() - 1] + length * by);
        }
        let total = run[run.len() - 1];
        if !(total.is_finite() && total > 0.0) {
            return;
        }
        let moved = |t: f64| {
            let k = stops.partition_point(|&s| s <= t).clamp(1, stops.len() - 1);
            let share = (t - stops[k - 1]) / (stops[k] - stops[k - 1]);
            (run[k - 1] + (run[k] - run[k - 1]) * share) / total
        };
        let rising = |all: &[f64]| all.windows(2).all(|w| w[0] < w[1]);
        let knots: Vec<f64> = self.knots.iter().map(|&t| moved(t)).collect();
        if rising(&knots) {
            self.at = self.at.iter().map(|&t| moved(t)).collect();
            self.knots = knots;
            if let (Some(last), false) = (self.knots.last_mut(), self.closed) {
                *last = 1.0;
                let n = self.at.len();
                self.at[n - 1] = 1.0;
            }
        }
    }
}

/// Parameters in [0, 1] from the lengths between averages over enough neighbours for noise not to
/// lengthen them, interpolated linearly.
fn pilot(points: &[Vec3<f64>], closed: bool) -> Vec<f64> {
    let n = points.len();
    let averages = |size: usize| -> Vec<(f64, Vec3<f64>)> {
        let blocks = n / size;
        (0..blocks)
            .map(|k| {
                let own = k * n / blocks..(k + 1) * n / blocks;
                let count = own.len() as f64;
                let sum = points[own.clone()].iter().fold(Vec3::zero(), |s, &p| s + p);
                ((own.start + own.end - 1) as f64 / 2.0, sum * (1.0 / count))
            })
            .collect()
    };
    let length = |all: &[(f64, Vec3<f64>)]| -> f64 {
        let inner: f64 = all.windows(2).map(|w| (w[1].1 - w[0].1).norm()).sum();
        let last = (all[0].1 - all[all.len() - 1].1).norm();
        // Averages leave out half a block at each end.
        let share = (all.len() - 1) as f64 / all.len() as f64;
        if closed { inner + last } else { inner / share.max(f64::MIN_POSITIVE) }
    };
    let mut size = 1;
    let mut own = averages(1);
    while n / (2 * size) >= FEWEST_BLOCKS {
        let wider = averages(2 * size);
        let calm = length(&own) <= SAME_LENGTH * length(&wider);
        if calm {
            break;
        }
        (own, size) = (wider, 2 * size);
    }
    let mut run = vec![0.0];
    for w in own.windows(2) {
        run.push(run[run.len() - 1] + (w[1].1 - w[0].1).norm());
    }
    let closing = (own[0].1 - own[own.len() - 1].1).norm();
    let blocks = own.len();
    let place = |i: usize| -> f64 {
        let i = i as f64;
        let after = own.partition_point(|b| b.0 <= i);
        if closed {
            let (a, b) = match after {
                0 => ((own[blocks - 1].0 - n as f64, -closing), (own[0].0, 0.0)),
                k if k == blocks => {
                    ((own[k - 1].0, run[k - 1]), (own[0].0 + n as f64, run[blocks - 1] + closing))
                }
                k => ((own[k - 1].0, run[k - 1]), (own[k].0, run[k])),
            };
            return a.1 + (b.1 - a.1) * (i - a.0) / (b.0 - a.0);
        }
        let k = after.clamp(1, blocks - 1);
        run[k - 1] + (run[k] - run[k - 1]) * (i - own[k - 1].0) / (own[k].0 - own[k - 1].0)
    };
    let first = place(0);
    let total = if closed { run[blocks - 1] + closing } else { place(n - 1) - first };
    let mut at: Vec<f64> =
        (0..n).map(|i| (place(i) - first) / total.max(f64::MIN_POSITIVE)).collect();
    if !closed {
        at[n - 1] = 1.0;
    }
    at
}

/// The Bézier pieces of a curve.
pub(crate) struct BezierCurve {
    pub all: Vec<BezierPart>,
}

/// One of them.
pub(crate) struct BezierPart {
    pub start: f64,
    pub end: f64,
    points: Vec<Vec3<f64>>,
}

impl BezierCurve {
    pub fn of(space: &Space, control: &[Vec3<f64>]) -> Self {
        let mut bezier = BezierExtraction::default();
        let all = space
            .spans()
            .map(|k| {
                let rows = bezier.rows(space, k);
                let columns: Vec<usize> = space.columns(k).collect();
                let point = |row: &Vec<f64>| {
                    let both = columns.iter().zip(row);
                    both.fold(Vec3::zero(), |s, (&c, &f)| s + control[c] * f)
                };
                let points = rows.iter().map(point).collect();
                BezierPart { start: space.knot(k), end: space.knot(k + 1), points }
            })
            .collect();
        Self { all }
    }

    fn piece(&self, t: f64) -> &BezierPart {
        let k = self.all.partition_point(|p| p.start <= t);
        &self.all[k.clamp(1, self.all.len()) - 1]
    }

    /// The longest step of a search that trusts a piece.
    fn longest_step(&self, t: f64) -> f64 {
        let piece = self.piece(t);
        0.5 * (piece.end - piece.start)
    }

    /// The point, the first and the second derivative.
    pub fn at(&self, t: f64) -> [Vec3<f64>; 3] {
        let piece = self.piece(t);
        let h = piece.end - piece.start;
        let s = (t - piece.start) / h;
        let mut work = piece.points.clone();
        let p = work.len() - 1;
        let (mut d1, mut d2) = (Vec3::zero(), Vec3::zero());
        for level in (0..p).rev() {
            if level == 1 {
                d2 = (work[2] - work[1] * 2.0 + work[0]) * ((p * (p - 1)) as f64 / (h * h));
            }
            if level == 0 {
                d1 = (work[1] - work[0]) * (p as f64 / h);
            }
            for j in 0..=level {
                work[j] = work[j] * (1.0 - s) + work[j + 1] * s;
            }
        }
        [work[0], d1, d2]
    }
}
