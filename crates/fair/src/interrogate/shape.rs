//! Curvature and its relatives along a spline, as numbers.

use crate::Space;
use crate::interrogate::spans::{SpanBasis, each_span};
use moldloft_num::{Real, Vec3, gauss_points};

/// A curve at one parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The parameter, in the space's own knots.
    pub t: f64,
    /// Position.
    pub point: Vec3<f64>,
    /// First, second and third derivative by `t`.
    pub derivatives: [Vec3<f64>; 3],
}

impl Sample {
    /// From the sums of basis functions and their derivatives times control points, and for a
    /// rational curve the same with weights (Piegl and Tiller 1997, eq. 4.8).
    pub(crate) fn of_sums(t: f64, a: [Vec3<f64>; 4], weights: Option<[f64; 4]>) -> Self {
        let Some(w) = weights else {
            let [point, derivatives @ ..] = a;
            return Self { t, point, derivatives };
        };
        let point = a[0] * (1.0 / w[0]);
        let d1 = (a[1] - point * w[1]) * (1.0 / w[0]);
        let d2 = (a[2] - d1 * (2.0 * w[1]) - point * w[2]) * (1.0 / w[0]);
        let d3 = (a[3] - d2 * (3.0 * w[1]) - d1 * (3.0 * w[2]) - point * w[3]) * (1.0 / w[0]);
        Self { t, point, derivatives: [d1, d2, d3] }
    }

    /// The curvature vector's length, |x' x x''| / |x'|^3; 0 where the curve has a zero tangent.
    pub fn curvature(&self) -> f64 {
        let [d1, d2, _] = self.derivatives;
        let speed = d1.norm();
        if speed == 0.0 { 0.0 } else { d1.cross(d2).norm() / speed.powi(3) }
    }

    /// The curvature with the sign of x' x x'' along `normal`: positive where a plane curve turns
    /// left, seen against the normal.
    pub fn signed_curvature(&self, normal: Vec3<f64>) -> f64 {
        let [d1, d2, _] = self.derivatives;
        let speed = d1.norm();
        if speed == 0.0 { 0.0 } else { d1.cross(d2).dot(normal) / speed.powi(3) }
    }

    /// The torsion det(x', x'', x''') / |x' x x''|^2; 0 at inflections.
    pub fn torsion(&self) -> f64 {
        let [d1, d2, d3] = self.derivatives;
        let cross = d1.cross(d2);
        let square = cross.norm_sq();
        if square == 0.0 { 0.0 } else { cross.dot(d3) / square }
    }

    /// The derivative of the signed curvature by arc length, for curves in the plane of `normal`:
    /// (det(x', x''') |x'|^2 - 3 det(x', x'') (x' . x'')) / |x'|^6.
    pub fn curvature_slope(&self, normal: Vec3<f64>) -> f64 {
        let [d1, d2, d3] = self.derivatives;
        let square = d1.norm_sq();
        if square == 0.0 {
            return 0.0;
        }
        let det = |a: Vec3<f64>, b: Vec3<f64>| a.cross(b).dot(normal);
        (det(d1, d3) * square - 3.0 * det(d1, d2) * d1.dot(d2)) / square.powi(3)
    }

    /// The principal normal: the direction the curve bends to; zero at inflections.
    pub fn bend(&self) -> Vec3<f64> {
        let [d1, d2, _] = self.derivatives;
        let square = d1.norm_sq();
        if square == 0.0 {
            return Vec3::zero();
        }
        (d2 - d1 * (d1.dot(d2) / square)).normalized().unwrap_or_default()
    }
}

/// The curve at `t` by the polynomials of span `k`.
pub fn sample_in(
    space: &Space,
    points: &[Vec3<f64>],
    weights: Option<&[f64]>,
    k: isize,
    t: f64,
) -> Sample {
    let mut a = [Vec3::zero(); 4];
    let mut w = [0.0; 4];
    let basis = space.basis(k, t);
    let third = space.derivative(k, t, 3);
    let rows: [&[f64]; 4] = [&basis.rows[0], &basis.rows[1], &basis.rows[2], &third];
    for (order, row) in rows.into_iter().enumerate() {
        for (c, &b) in space.columns(k).zip(row) {
            let weight = weights.map_or(1.0, |w| w[c]);
            a[order] += points[c] * (weight * b);
            w[order] += weight * b;
        }
    }
    Sample::of_sums(t, a, weights.is_some().then_some(w))
}

/// The curve at `t`.
pub fn sample_at(space: &Space, points: &[Vec3<f64>], weights: Option<&[f64]>, t: f64) -> Sample {
    let (k, t) = space.locate(t);
    sample_in(space, points, weights, k, t)
}

/// `per_span + 1` samples on each span, both ends included: at a knot the curve is sampled from
/// either side.
pub fn samples(
    space: &Space,
    points: &[Vec3<f64>],
    weights: Option<&[f64]>,
    per_span: usize,
) -> Vec<Sample> {
    let mut out = Vec::new();
    let shares = (0..=per_span).map(|i| i as f64 / per_span as f64);
    each_span(space, points, weights, (shares, true), |samples| out.extend(samples));
    out
}

/// Samples without third derivatives, for counts of inflections.
pub(crate) fn bends(space: &Space, points: &[Vec3<f64>]) -> Vec<Sample> {
    let mut out = Vec::new();
    each_span(space, points, None, (counting(), false), |samples| out.extend(samples));
    out
}

/// The basis for the same samples of many curves.
pub(crate) fn counting_basis(space: &Space) -> SpanBasis {
    SpanBasis::new(space, counting())
}

fn counting() -> impl Iterator<Item = f64> {
    (0..=COUNTING).map(|i| i as f64 / COUNTING as f64)
}

/// The unit normal of the plane that the samples bend in, if they all do: their largest bend's
/// axis, +z or the nearest to it.
pub fn plane_normal(samples: &[Sample]) -> Option<Vec3<f64>> {
    let axis = |s: &Sample| s.derivatives[0].cross(s.derivatives[1]);
    let largest = samples
        .iter()
        .map(axis)
        .fold(Vec3::zero(), |best, a| if a.norm_sq() > best.norm_sq() { a } else { best });
    let Some(normal) = largest.normalized() else {
        return Some(Vec3::of(0.0, 0.0, 1.0));
    };
    let flip = [normal.z, normal.y, normal.x].into_iter().find(|c| c.abs() > 1e-9);
    let normal = if flip.is_some_and(|c| c < 0.0) { -normal } else { normal };
    let origin = samples.first().map_or(Vec3::zero(), |s| s.point);
    let size = samples.iter().map(|s| (s.point - origin).norm()).fold(0.0, f64::max);
    let flat = samples.iter().all(|s| (s.point - origin).dot(normal).abs() <= 1e-9 * size);
    flat.then_some(normal)
}

/// Curvatures of the samples: signed for a plane curve, otherwise lengths.
pub fn curvatures(samples: &[Sample]) -> Vec<f64> {
    match plane_normal(samples) {
        Some(normal) => samples.iter().map(|s| s.signed_curvature(normal)).collect(),
        None => samples.iter().map(Sample::curvature).collect(),
    }
}

/// The monotone pieces of a curve's curvature, one at least of each part between corners: reversals below `share` of its range are
/// not counted, nor those of a straight line's or a circle's curvature, nor those that a cubic has between
/// its knots because its second derivative is linear there, nor where the points at the knots are on one
/// circle those that a spline has between such points.
///
/// Samples are those of [`samples`], the same number on each span.
pub fn monotone_pieces(samples: &[Sample], share: f64) -> usize {
    let parts = parts_between_corners(samples);
    let Some(floors) = curvature_floors(samples, share) else { return parts.len() };
    let values = curvatures(samples);
    let runs =
        |part: std::ops::Range<usize>| runs_above(&values[part.clone()], &floors[part]).max(1);
    parts.into_iter().map(runs).sum()
}

/// Reversal of the curvature at each sample below which it does not count; `None` if the whole
/// range does not count.
fn curvature_floors(samples: &[Sample], share: f64) -> Option<Vec<f64>> {
    let values = curvatures(samples);
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let most = low.abs().max(high.abs());
    let far = |s: &Sample| (s.point - samples[0].point).norm();
    let extent = samples.iter().map(far).fold(0.0, f64::max);
    if high - low <= SAME * most || most * extent <= 1e-9 {
        return None;
    }
    let least = share * (high - low);
    let spans = spans_of(samples);
    let circles = circles(samples, &spans);
    let own = own_errors(samples, &spans, &circles);
    let ripples = ripples(samples, &spans, &circles);
    Some(ripples.into_iter().zip(own).map(|(r, e)| r.max(e).max(least)).collect())
}

/// The samples of each span: both sides of a knot are samples at its parameter.
fn spans_of(samples: &[Sample]) -> Vec<std::ops::Range<usize>> {
    let mut starts: Vec<usize> =
        (1..samples.len()).filter(|&i| samples[i].t <= samples[i - 1].t).collect();
    starts.insert(0, 0);
    starts.push(samples.len());
    starts.windows(2).map(|w| w[0]..w[1]).collect()
}

/// The curvatures of the circles through each three neighbouring knots, 4 area / (a b c).
fn circles(samples: &[Sample], spans: &[std::ops::Range<usize>]) -> Vec<f64> {
    let knots: Vec<Vec3<f64>> = spans
        .iter()
        .map(|s| samples[s.start].point)
        .chain(samples.last().map(|s| s.point))
        .collect();
    let curvature = |w: &[Vec3<f64>]| {
        let (a, b) = (w[1] - w[0], w[2] - w[1]);
        let sides = a.norm() * b.norm() * (w[2] - w[0]).norm();
        if sides > 0.0 { 2.0 * a.cross(b).norm() / sides } else { 0.0 }
    };
    knots.windows(3).map(curvature).collect()
}

/// The circles through knots near span `k`, at least three, with the least and the largest
/// curvature; `None` for fewer.
fn circles_near(circles: &[f64], k: usize) -> Option<(&[f64], f64, f64)> {
    let last = circles.len().checked_sub(3)?;
    let near = &circles[k.saturating_sub(2).min(last)..(k + 2).clamp(3, circles.len())];
    let low = near.iter().copied().fold(f64::INFINITY, f64::min);
    Some((near, low, near.iter().copied().fold(0.0, f64::max)))
}

/// Curvature beside span `k`, if the points determine it: the circles through them reverse once at
/// most and differ by no more than half.
fn known_beside(circles: &[f64], k: usize) -> Option<f64> {
    let (near, low, high) = circles_near(circles, k)?;
    let steps = near.windows(2).map(|w| w[1] - w[0]).filter(|d| d.abs() > UNCOUNTED * high);
    let steps: Vec<f64> = steps.collect();
    let turns = steps.windows(2).filter(|d| d[0] * d[1] < 0.0).count();
    (high - low <= 0.5 * high && turns <= 1).then_some(high)
}

/// Error of a cubic's second derivative, in units of the squared length of the longest adjacent
/// span times the fourth derivative there: an eighth is that of the straight line between its
/// values at the knots (de Boor 2001, ch. II), a quarter that of these values: the equation of a
/// knot between steps h and k has an error of (h^2 - h k + k^2) / 4 of it, and its 2 on the
/// diagonal dominates the 1 beside it.
const OWN_ERROR: f64 = 0.375;

/// Spans on either side that are averaged for the fourth derivative: noise of the points, whose
/// third derivatives alternate, cancels.
const SMOOTH: usize = 3;

/// For each sample, the estimated error of a cubic's curvature, from its pieces alone; zero for
/// other degrees, for rational splines, and if the knots are not on such a curve.
fn own_errors(samples: &[Sample], spans: &[std::ops::Range<usize>], circles: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; samples.len()];
    let second = |i: usize| samples[i].derivatives[1];
    let width = |s: &std::ops::Range<usize>| samples[s.end - 1].t - samples[s.start].t;
    let most = samples.iter().map(|s| s.derivatives[1].norm()).fold(0.0, f64::max);
    let linear = |s: &std::ops::Range<usize>| {
        let (a, b, middle) = (s.start, s.end - 1, s.start + s.len() / 2);
        let share = (samples[middle].t - samples[a].t) / width(s);
        let between = second(a) + (second(b) - second(a)) * share;
        width(s) > 0.0 && (second(middle) - between).norm() <= 1e-6 * most
    };
    if !spans.iter().all(linear) {
        return out;
    }
    let third =
        |s: &std::ops::Range<usize>| (second(s.end - 1) - second(s.start)) * (1.0 / width(s));
    // A jump of the second derivative separates two curves.
    let smooth = |a: &std::ops::Range<usize>, b: &std::ops::Range<usize>| {
        (second(b.start) - second(a.end - 1)).norm() <= 1e-6 * most
    };
    let mut at = 0;
    for run in spans.chunk_by(smooth) {
        let begin = at;
        at += run.len();
        let thirds: Vec<Vec3<f64>> = run.iter().map(third).collect();
        let widths: Vec<f64> = run.iter().map(width).collect();
        let window = (2 * SMOOTH + 1).min(run.len());
        let squares = felt(&widths);
        for (k, span) in run.iter().enumerate() {
            let Some(bend) = known_beside(circles, begin + k) else { continue };
            let first = k.saturating_sub(SMOOTH).min(run.len() - window);
            let last = first + window - 1;
            let apart =
                widths[first..=last].iter().sum::<f64>() - 0.5 * (widths[first] + widths[last]);
            let fourth = (thirds[last] - thirds[first]).norm() / apart;
            for i in span.clone() {
                let square = samples[i].derivatives[0].norm_sq();
                if square > 0.0 {
                    // At most that of a circle.
                    let fourth = (fourth / square).min(bend * bend * bend * square);
                    out[i] = OWN_ERROR * squares[k] * fourth;
                }
            }
        }
    }
    out
}

/// The most that is left of the error at a knot at the next one, by the same equations; of even knots it is
/// 2 - sqrt(3).
const LEFT: f64 = 0.5;

/// The square of the longest span as each span feels it: whole beside it, less from knot to knot.
fn felt(widths: &[f64]) -> Vec<f64> {
    let last = widths.len();
    let beside = |k: usize| &widths[k.saturating_sub(1)..(k + 2).min(last)];
    let longest = |k: usize| beside(k).iter().copied().fold(0.0, f64::max);
    let mut out: Vec<f64> = (0..last).map(|k| longest(k) * longest(k)).collect();
    for k in 1..last {
        out[k] = out[k].max(LEFT * out[k - 1]);
    }
    for k in (1..last).rev() {
        out[k - 1] = out[k - 1].max(LEFT * out[k]);
    }
    out
}

/// Relative range of curvature of a circle: the ripple of a cubic with about forty spans around it.
pub(crate) const SAME: f64 = 4e-3;

/// Additional reversals of curvature of a cubic through points on a circle at uneven spacing, in
/// squares of the angle of the longest span: the factor per ratio of the longest to the shortest
/// span, its maximum, and the maximum relative to the curvature. Of 150 random draws of 12 to 52
/// points only those with a span of a radian or more exceed it.
const RIPPLE: f64 = 0.25;
const UNEVEN_RIPPLE: f64 = 2.0;
const LARGEST_RIPPLE: f64 = 0.25;

/// At each sample the reversal of the curvature that says nothing: where the circles through each
/// three neighbouring knots are the same, points at the knots know no more than these.
fn ripples(samples: &[Sample], spans: &[std::ops::Range<usize>], circles: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; samples.len()];
    let round = |k: usize| {
        let (_, low, high) = circles_near(circles, k)?;
        (high - low <= SAME * high).then_some(high)
    };
    let length = |s: &std::ops::Range<usize>| -> f64 {
        samples[s.clone()].windows(2).map(|w| (w[1].point - w[0].point).norm()).sum()
    };
    let own: Vec<Option<f64>> = (0..spans.len()).map(round).collect();
    let mut at = 0;
    for run in own.chunk_by(|a, b| a.is_some() == b.is_some()) {
        let all = at..at + run.len();
        at = all.end;
        let angle = |k: usize| own[k].map_or(0.0, |bend| bend * length(&spans[k]));
        let widest = all.clone().map(angle).fold(0.0, f64::max);
        let narrowest = all.clone().map(angle).fold(widest, f64::min);
        let uneven = widest / narrowest.max(f64::MIN_POSITIVE) - 1.0;
        let ripple = (RIPPLE * uneven).min(UNEVEN_RIPPLE) * widest * widest;
        let ripple = ripple.min(LARGEST_RIPPLE);
        for k in all {
            out[spans[k].clone()].fill(ripple * own[k].unwrap_or(0.0));
        }
    }
    out
}

/// The number of monotone runs in a list of numbers when reversals smaller than `share` of the
/// range are ignored; 0 for a constant list.
///
/// The first run begins where the numbers have left their first one by that much: ripples before do
/// not count. So a list read backwards may have a few runs more or fewer.
pub fn monotone_runs(values: &[f64], share: f64) -> usize {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let size = low.abs().max(high.abs());
    // A range within rounding is not a range.
    if high - low <= 1e-9 * size {
        return 0;
    }
    runs_above(values, &vec![share * (high - low); values.len()])
}

/// The runs when reversals are ignored that are no greater than the floors of both their numbers.
fn runs_above(values: &[f64], floors: &[f64]) -> usize {
    let (mut runs, mut rising) = (0, None);
    // The extreme since the last turn: of a rising run its top, of a falling one its bottom.
    let mut extreme = (values[0], floors[0]);
    for (&v, &floor) in values.iter().zip(floors) {
        let on = match rising {
            None => false,
            Some(true) => v >= extreme.0,
            Some(false) => v <= extreme.0,
        };
        if on {
            extreme = (v, floor);
        } else if (v - extreme.0).abs() > floor.max(extreme.1) {
            (runs, rising, extreme) = (runs + 1, Some(v > extreme.0), (v, floor));
        }
    }
    runs
}

/// The turn over a whole curve's extent, in radians, below which a curvature is that of a straight line.
pub(crate) const STRAIGHT: f64 = 1e-8;

/// The curvature, at each sample, that rounding of the points leaves of a straight line, or [`STRAIGHT`].
fn straight_floors(samples: &[Sample]) -> Vec<f64> {
    let most = |f: &dyn Fn(&Sample) -> f64| samples.iter().map(f).fold(0.0, f64::max);
    let extent = most(&|s| (s.point - samples[0].point).norm());
    let rounding = 64.0 * f64::EPSILON * most(&|s| s.point.norm());
    let mut out = vec![STRAIGHT / extent; samples.len()];
    for span in spans_of(samples) {
        let (first, last) = (samples[span.start].point, samples[span.end - 1].point);
        let floor = rounding / (last - first).norm_sq().max(f64::MIN_POSITIVE);
        out[span].iter_mut().for_each(|f| *f = f.max(floor));
    }
    out
}

/// The turn of the tangent at a knot, in radians, from which it is a corner.
const CORNER: f64 = 1e-6;

/// Jump of the derivative at a knot, relative to the largest, that rounding leaves.
const SMOOTH_JUMP: f64 = 1e-9;

/// The samples of each part between corners.
fn parts_between_corners(samples: &[Sample]) -> Vec<std::ops::Range<usize>> {
    let largest = samples.iter().map(|s| s.derivatives[0].norm()).fold(0.0, f64::max);
    let is_corner = |k: &usize| {
        let [a, b] = [k - 1, *k].map(|k| samples[k].derivatives[0]);
        let turns = a.cross(b).norm() > CORNER * a.norm() * b.norm() || a.dot(b) < 0.0;
        samples[*k].t <= samples[k - 1].t && turns && (a - b).norm() > SMOOTH_JUMP * largest
    };
    let inner = (1..samples.len()).filter(is_corner);
    let bounds: Vec<usize> = [0].into_iter().chain(inner).chain([samples.len()]).collect();
    bounds.windows(2).map(|w| w[0]..w[1]).collect()
}

/// Minimum number of spans of a straight run; half as many at an end. Shorter straight parts occur
/// in rounded data.
const LONG_STRETCH: usize = 4;

/// For each sample, true in a straight run.
fn in_straight_runs(samples: &[Sample]) -> Vec<bool> {
    let floors = straight_floors(samples);
    let mut out = vec![false; samples.len()];
    let spans = spans_of(samples);
    let straight: Vec<bool> =
        spans.iter().map(|s| s.clone().all(|i| samples[i].curvature() <= floors[i])).collect();
    let mut at = 0;
    for run in straight.chunk_by(|a, b| a == b) {
        let at_end = at == 0 || at + run.len() == spans.len();
        let least = if at_end { LONG_STRETCH / 2 } else { LONG_STRETCH };
        if run[0] && run.len() >= least {
            out[spans[at].start..spans[at + run.len() - 1].end].fill(true);
        }
        at += run.len();
    }
    out
}

/// Number of sign changes of the curvature: reversals of x' x x'', of each part between corners. A zero without a change of sign
/// counts as two inflections at one parameter; a straight part counts at its begin and at its end,
/// but a straight run (four spans or more, two at an end) counts at most once, if the curve turns
/// the other way after it. A curve that is straight within rounding has none.
///
/// On rounded data, whose second differences are often exactly zero, rounding decides whether the
/// curvature touches zero.
pub fn inflections(samples: &[Sample]) -> usize {
    let most = |f: &dyn Fn(&Sample) -> f64| samples.iter().map(f).fold(0.0, f64::max);
    if most(&Sample::curvature) * most(&|s| (s.point - samples[0].point).norm()) <= 1e-9 {
        return 0;
    }
    let (runs, floors) = (in_straight_runs(samples), straight_floors(samples));
    let signs = |part: std::ops::Range<usize>| {
        let straight = part.clone().all(|i| samples[i].curvature() <= floors[i]);
        if straight { 0 } else { sign_changes(&samples[part.clone()], &runs[part]) }
    };
    parts_between_corners(samples).into_iter().map(signs).sum()
}

/// The inflections of a part without corners, with its straight runs.
fn sign_changes(samples: &[Sample], runs: &[bool]) -> usize {
    let mut last: Option<Vec3<f64>> = None;
    let mut changes = 0;
    // Start and end of a straight part; both sides of a knot are the same parameter.
    let mut straight: Option<[f64; 2]> = None;
    // A zero next to a straight run is part of it.
    let mut after_run = false;
    for (s, &run) in samples.iter().zip(runs) {
        if run {
            (straight, after_run) = (None, true);
            continue;
        }
        let [d1, d2, _] = s.derivatives;
        let axis = d1.cross(d2);
        if axis.norm() <= 1e-9 * d1.norm() * d2.norm() {
            if !after_run {
                straight = Some([straight.map_or(s.t, |[from, _]| from), s.t]);
            }
            continue;
        }
        after_run = false;
        if let Some(before) = last {
            let turned = before.dot(axis) < 0.0;
            changes += match straight {
                None => usize::from(turned),
                Some([from, to]) if from < to => 2,
                Some(_) => 2 - usize::from(turned),
            };
        } else if straight.is_some_and(|[from, to]| from < to) {
            changes += 1;
        }
        straight = None;
        last = Some(axis);
    }
    let ends_straight = straight.is_some_and(|[from, to]| from < to);
    changes + usize::from(last.is_some() && ends_straight)
}

/// Samples on each span for counts.
pub(crate) const COUNTING: usize = 16;

/// The number of monotone pieces of the curvature, reversals below a thousandth of its range
/// ignored (Dill 1981; Farin 2002, ch. 23: few pieces are fair).
pub fn pieces(space: &Space, points: &[Vec3<f64>]) -> usize {
    monotone_pieces(&bends(space, points), UNCOUNTED)
}

/// Fraction of the curvature's range below which a reversal is not counted.
pub(crate) const UNCOUNTED: f64 = 1e-3;

/// The length of the curve, by the 8-point Gauss-Legendre rule on each span.
pub fn arc_length(space: &Space, points: &[Vec3<f64>], weights: Option<&[f64]>) -> f64 {
    let rule = gauss_points(0.0, 1.0);
    let mut lengths = Vec::new();
    let mut widths = space.spans().map(|k| space.knot(k + 1) - space.knot(k));
    each_span(space, points, weights, (rule.iter().map(|r| r.0), false), |samples| {
        let speed = |(s, (_, w)): (Sample, &(f64, f64))| w * s.derivatives[0].norm();
        let sum: f64 = samples.zip(&rule).map(speed).sum();
        lengths.push(sum * widths.next().expect("a width for each span"));
    });
    crate::sparse_rows::chunked_sum(lengths.len(), |i| lengths[i])
}

/// A point of the logarithmic curvature graph (Yoshida and Saito 2006).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Logarithmic {
    /// log of the radius of curvature.
    pub radius: f64,
    /// log |radius ds / d radius|.
    pub rate: f64,
}

/// The logarithmic curvature graph of a plane curve: a straight line of slope alpha for
/// log-aesthetic curves (-1 clothoid, 1 logarithmic spiral, 2 involute of a circle). Samples where
/// curvature or its slope vanishes are left out.
pub fn logarithmic_graph(samples: &[Sample]) -> Vec<Logarithmic> {
    let Some(normal) = plane_normal(samples) else { return Vec::new() };
    let point = |s: &Sample| {
        let (curvature, slope) = (s.signed_curvature(normal), s.curvature_slope(normal));
        // rho = 1/k, so rho ds/drho = -k / k'.
        let rate = (curvature / slope).abs();
        let fits = curvature != 0.0 && slope != 0.0 && rate.is_finite();
        fits.then(|| Logarithmic { radius: -Real::ln(curvature.abs()), rate: Real::ln(rate) })
    };
    samples.iter().filter_map(point).collect()
}

/// Points of the curvature comb: x + scale k n, with n to the left of the curve in its plane, or
/// away from the bend for space curves.
pub fn comb(samples: &[Sample], scale: f64) -> Vec<Vec3<f64>> {
    match plane_normal(samples) {
        Some(normal) => samples
            .iter()
            .map(|s| {
                let left = normal.cross(s.derivatives[0]).normalized().unwrap_or_default();
                s.point - left * (scale * s.signed_curvature(normal))
            })
            .collect(),
        None => samples.iter().map(|s| s.point - s.bend() * (scale * s.curvature())).collect(),
    }
}

/// The k-orthotomic of a plane curve for a point p: p + k ((x - p) . n) n. It has cusps exactly at
/// inflections if no tangent passes through p (Hoschek 1985).
pub fn orthotomic(samples: &[Sample], p: Vec3<f64>, k: f64) -> Vec<Vec3<f64>> {
    let normal = plane_normal(samples).unwrap_or(Vec3::of(0.0, 0.0, 1.0));
    samples
        .iter()
        .map(|s| {
            let n = normal.cross(s.derivatives[0]).normalized().unwrap_or_default();
            p + n * (k * (s.point - p).dot(n))
        })
        .collect()
}

/// Second divided differences of points at parameters `t`, one per inner point: twice the second
/// derivative of the parabola through each three.
///
/// # Errors
/// [`crate::FairError`] when the lists differ in length or parameters do not increase.
pub fn divided_differences(
    points: &[Vec3<f64>],
    t: &[f64],
) -> Result<Vec<Vec3<f64>>, crate::FairError> {
    if points.len() != t.len() {
        let (expected, actual) = (points.len(), t.len());
        return Err(crate::FairError::Count { what: "parameters", expected, actual });
    }
    if let Some(k) =
        t.windows(2).position(|w| w[1].partial_cmp(&w[0]) != Some(std::cmp::Ordering::Greater))
    {
        return Err(crate::FairError::Unsorted { index: k + 1 });
    }
    let slope = |k: usize| (points[k + 1] - points[k]) * (1.0 / (t[k + 1] - t[k]));
    let inner = 1..points.len().saturating_sub(1);
    Ok(inner.map(|k| (slope(k) - slope(k - 1)) * (1.0 / (t[k + 1] - t[k - 1]))).collect())
}
