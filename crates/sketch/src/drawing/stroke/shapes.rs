//! Shapes of the runs of a stroke; smooth sequences of runs as ellipses and splines.

use super::cells::StrokeCells;
use super::division::{ARC, StrokeRun, end_directions, sum_of};
use super::{SMOOTH, cross, distance, dot, to, turn};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Cost of a parameter of an ellipse or a spline.
const PARAMETER: f64 = 3.0;

/// Cost of a control point of a spline: neighbours follow each other.
const CONTROL: f64 = 5.0;

/// Length of a line or arc that continues a spline and is a part of it, relative to the spline.
const BESIDE: f64 = 0.35;

/// Greatest root mean square distance of a spline that replaces several shapes, in standard deviations.
const AS_NEAR: f64 = 1.5;

/// Turn of a joint, in radians, from which it is a corner of any shape.
const BENT: f64 = 1.5;

/// Ratio of the half-axes of an ellipse from which it is a circle drawn by hand.
const ROUND: f64 = 0.9;

/// Sums of squares of an algebraic ellipse above this multiple of the limit are not refined.
const FAR: f64 = 30.0;

/// Least ratio of the half-axes, and greatest half-axis.
const FLATTEST: f64 = 0.08;
const LARGEST: f64 = 4.0;

/// Least description length of a shape that replaces several runs.
pub(super) const LEAST: f64 = 4.0 * PARAMETER;

/// Most runs that one shape replaces.
const MOST_RUNS: usize = 10;

/// Control points of a spline.
const CONTROLS: Range<usize> = 4..33;

/// A fitted shape.
#[derive(Clone, Debug)]
pub(super) enum StrokeShape {
    /// Through a point, in a direction.
    Line([f64; 2], [f64; 2]),
    /// Centre and radius.
    Arc([f64; 2], f64),
    /// A whole circle.
    Circle([f64; 2], f64),
    /// An arc of an ellipse.
    EllipseArc(StrokeEllipse),
    /// A whole ellipse.
    Ellipse(StrokeEllipse),
    /// Bézier points.
    Spline(Vec<[f64; 2]>),
}

/// A shape with its cells.
#[derive(Clone, Debug)]
pub(super) struct FittedRun {
    pub cells: Range<usize>,
    pub shape: StrokeShape,
    /// True if the next shape continues it.
    pub smooth: bool,
}

/// The shapes of runs, smooth sequences of them replaced by one ellipse or spline where that is shorter to
/// describe.
pub(super) fn fitted(
    cells: &StrokeCells,
    runs: &[StrokeRun],
    closed: bool,
) -> (Vec<FittedRun>, f64) {
    let n = runs.len();
    let ends: Vec<[[f64; 2]; 2]> = runs.iter().map(|r| end_directions(cells, r)).collect();
    let turned = |k: usize| turn(ends[k][1], ends[(k + 1) % n][0]).abs();
    let costs: Vec<f64> = runs.iter().map(|r| r.cost).collect();
    let arcs = runs.iter().any(|r| r.arc);
    let ring = closed && arcs && (n == 1 || (0..n).all(|k| turned(k) < BENT));
    if ring && let Some((shape, cost)) = whole_shape(cells, costs.iter().sum()) {
        return (vec![FittedRun { cells: 0..cells.len(), shape, smooth: true }], cost);
    }
    // The cheapest way to each run, by one shape from a run before it on.
    let mut best: Vec<(f64, usize, Option<StrokeShape>)> = vec![(0.0, 0, None)];
    for end in 1..=n {
        let mut found = (best[end - 1].0 + costs[end - 1], end - 1, None);
        let mut cost = costs[end - 1];
        for start in (0..end - 1).rev() {
            cost += costs[start];
            if turned(start) >= BENT || end - start > MOST_RUNS {
                break;
            }
            if !runs[start..end].iter().any(|r| r.arc) {
                continue;
            }
            let range = runs[start].cells.start..runs[end - 1].cells.end;
            if let Some((shape, price)) = joined_shape(cells, range, cost)
                && best[start].0 + price < found.0
            {
                found = (best[start].0 + price, start, Some(shape));
            }
        }
        best.push(found);
    }
    let mut out: Vec<FittedRun> = Vec::new();
    let mut end = n;
    while end > 0 {
        let (_, start, shape) = best[end].clone();
        let range = runs[start].cells.start..runs[end - 1].cells.end;
        let shape = shape.unwrap_or_else(|| {
            let sum = sum_of(cells, range.clone());
            match sum.circle().filter(|_| runs[start].arc) {
                Some((centre, radius, _)) => StrokeShape::Arc(centre, radius),
                None => StrokeShape::Line([sum.x / sum.n, sum.y / sum.n], sum.direction()),
            }
        });
        let next = end % n;
        let smooth = (closed || end < n)
            && (runs[end - 1].arc || runs[next].arc)
            && turned(end - 1) < SMOOTH;
        out.push(FittedRun { cells: range, shape, smooth });
        end = start;
    }
    out.reverse();
    (with_neighbours(cells, out), best[n].0)
}

/// Splines with those that continue them, and with short lines and arcs beside them, where one spline is as near.
fn with_neighbours(cells: &StrokeCells, fitted: Vec<FittedRun>) -> Vec<FittedRun> {
    let length = |f: &FittedRun| -> f64 {
        cells.at[f.cells.clone()].windows(2).map(|w| distance(w[0], w[1])).sum()
    };
    let mut out: Vec<FittedRun> = Vec::new();
    for next in fitted {
        let joined = out.last().filter(|one| one.smooth).and_then(|one| {
            let [a, b] = [one, &next].map(length);
            let wanted = match (&one.shape, &next.shape) {
                (StrokeShape::Spline(_), StrokeShape::Spline(_)) => true,
                (StrokeShape::Spline(_), StrokeShape::Line(..) | StrokeShape::Arc(..)) => {
                    b < BESIDE * a
                }
                (StrokeShape::Line(..) | StrokeShape::Arc(..), StrokeShape::Spline(_)) => {
                    a < BESIDE * b
                }
                _ => false,
            };
            let range = one.cells.start..next.cells.end;
            let at = &cells.at[range.clone()];
            let precision = cells.precision();
            let (points, cost) = spline(at, false, precision, f64::INFINITY).filter(|_| wanted)?;
            let controls = (points.len() - 1) / 3 + 3;
            let squares = (cost - controls as f64 * CONTROL) / precision;
            let near = squares <= at.len() as f64 * (AS_NEAR * cells.noise).powi(2);
            let shape = StrokeShape::Spline(points);
            near.then_some(FittedRun { cells: range, shape, smooth: next.smooth })
        });
        match joined {
            Some(one) => {
                out.pop();
                out.push(one);
            }
            None => out.push(next),
        }
    }
    out
}

/// A closed smooth outline as a circle, ellipse or closed spline that costs less than its runs.
fn whole_shape(cells: &StrokeCells, cost: f64) -> Option<(StrokeShape, f64)> {
    let precision = cells.precision();
    let sum = sum_of(cells, 0..cells.len());
    let circle = sum.circle().filter(|c| c.1 < LARGEST);
    let ellipse =
        StrokeEllipse::fit(&cells.at, cost / precision).map(|c| (c, c.squares(&cells.at)));
    let spline = spline(&cells.at, true, precision, cost);
    let by_circle = circle.map_or(f64::INFINITY, |c| precision * c.2 + ARC);
    let by_ellipse = ellipse.map_or(f64::INFINITY, |e| precision * e.1 + 6.0 * PARAMETER);
    let by_spline = spline.as_ref().map_or(f64::INFINITY, |s| s.1);
    let least = by_circle.min(by_ellipse).min(by_spline);
    if least > cost + 1e-9 {
        return None;
    }
    let round = ellipse.is_none_or(|(c, _)| c.half[1] >= ROUND * c.half[0]);
    let shape = if by_spline < by_circle.min(by_ellipse) {
        spline.map(|s| StrokeShape::Spline(s.0))
    } else if by_circle <= by_ellipse || round {
        circle.map(|(centre, radius, _)| StrokeShape::Circle(centre, radius))
    } else {
        ellipse.map(|(conic, _)| StrokeShape::Ellipse(conic))
    };
    shape.map(|shape| (shape, least))
}

/// Smooth runs as a part of an ellipse or a spline that costs less, with its cost.
fn joined_shape(cells: &StrokeCells, range: Range<usize>, cost: f64) -> Option<(StrokeShape, f64)> {
    let precision = cells.precision();
    let at = &cells.at[range];
    let conic = StrokeEllipse::fit(at, cost / precision).filter(|c| c.follows(at));
    let ellipse = conic.map(|c| (c, precision * c.squares(at) + 7.0 * PARAMETER));
    let spline = spline(at, false, precision, cost);
    let by_ellipse = ellipse.map_or(f64::INFINITY, |e| e.1);
    let by_spline = spline.as_ref().map_or(f64::INFINITY, |s| s.1);
    if cost <= by_ellipse.min(by_spline) {
        None
    } else if by_ellipse <= by_spline {
        ellipse.map(|e| (StrokeShape::EllipseArc(e.0), e.1))
    } else {
        spline.map(|s| (StrokeShape::Spline(s.0), s.1))
    }
}

/// An ellipse.
#[derive(Clone, Copy, Debug)]
pub(super) struct StrokeEllipse {
    pub centre: [f64; 2],
    /// Half-axes, the longer one first.
    pub half: [f64; 2],
    /// Angle of the longer one.
    pub angle: f64,
}

impl StrokeEllipse {
    /// The ellipse of least Sampson distances, from that of Halíř and Flusser on; `None` if the sum of their squares
    /// is far above `most`.
    fn fit(at: &[[f64; 2]], most: f64) -> Option<StrokeEllipse> {
        let mut conic = halir_flusser(at)?;
        let mut squares = conic.squares(at);
        if squares.is_nan() || squares >= FAR * most {
            return None;
        }
        let mut damping = 1e-3;
        for _ in 0..30 {
            let own = conic.parameters();
            let base: Vec<f64> = at.iter().map(|p| conic.off(*p)).collect();
            let step = 1e-6;
            let columns: Vec<Vec<f64>> = (0..5)
                .map(|k| {
                    let mut moved = own;
                    moved[k] += step;
                    let moved = StrokeEllipse::of(moved);
                    at.iter().zip(&base).map(|(p, b)| (moved.off(*p) - b) / step).collect()
                })
                .collect();
            let mut matrix = vec![vec![0.0; 6]; 5];
            for i in 0..5 {
                for j in 0..5 {
                    matrix[i][j] = columns[i].iter().zip(&columns[j]).map(|(a, b)| a * b).sum();
                }
                matrix[i][i] *= 1.0 + damping;
                matrix[i][5] = -columns[i].iter().zip(&base).map(|(a, b)| a * b).sum::<f64>();
            }
            let Some(change) = solved(matrix) else { break };
            let mut next = own;
            next.iter_mut().zip(&change).for_each(|(a, b)| *a += b[0]);
            let next = StrokeEllipse::of(next);
            let found = next.squares(at);
            if found < squares {
                let done = squares - found <= 1e-9 * squares;
                (conic, squares, damping) = (next, found, damping * 0.2);
                if done {
                    break;
                }
            } else {
                damping *= 10.0;
                if damping > 1e6 {
                    break;
                }
            }
        }
        let [a, b] = conic.half;
        let good = b >= FLATTEST * a && a <= LARGEST && squares.is_finite();
        good.then_some(conic)
    }

    fn parameters(&self) -> [f64; 5] {
        [self.centre[0], self.centre[1], self.half[0], self.half[1], self.angle]
    }

    fn of([x, y, a, b, angle]: [f64; 5]) -> StrokeEllipse {
        let (a, b) = (a.abs(), b.abs());
        let quarter = if b > a { 0.5 * PI } else { 0.0 };
        StrokeEllipse { centre: [x, y], half: [a.max(b), a.min(b)], angle: angle + quarter }
    }

    /// A point in units of the half-axes.
    fn local(&self, p: [f64; 2]) -> [f64; 2] {
        let (c, s) = (libm::cos(self.angle), libm::sin(self.angle));
        let d = to(self.centre, p);
        [(d[0] * c + d[1] * s) / self.half[0], (d[1] * c - d[0] * s) / self.half[1]]
    }

    /// The point at an angle of its parameter.
    pub fn at(&self, t: f64) -> [f64; 2] {
        let [a, b] = self.axes();
        let (c, s) = (libm::cos(t), libm::sin(t));
        [0, 1].map(|k| self.centre[k] + c * a[k] + s * b[k])
    }

    /// The half-axes as vectors.
    pub fn axes(&self) -> [[f64; 2]; 2] {
        let (c, s) = (libm::cos(self.angle), libm::sin(self.angle));
        [[self.half[0] * c, self.half[0] * s], [-self.half[1] * s, self.half[1] * c]]
    }

    /// The parameter of a point.
    pub fn parameter(&self, p: [f64; 2]) -> f64 {
        let [x, y] = self.local(p);
        libm::atan2(y, x)
    }

    /// Sampson's distance of a point.
    fn off(&self, p: [f64; 2]) -> f64 {
        let [x, y] = self.local(p);
        let slope = 2.0 * libm::hypot(x / self.half[0], y / self.half[1]);
        (x * x + y * y - 1.0) / slope.max(1e-9)
    }

    /// Sum of the squared distances.
    pub fn squares(&self, at: &[[f64; 2]]) -> f64 {
        at.iter().map(|p| self.off(*p).powi(2)).sum()
    }

    /// The parameters along a stroke, each within half a turn of the one before.
    pub fn sweep(&self, at: &[[f64; 2]]) -> [f64; 2] {
        let start = at.first().map_or(0.0, |p| self.parameter(*p));
        let end = at.iter().skip(1).fold(start, |before, p| {
            let next = self.parameter(*p);
            next - TAU * ((next - before) / TAU).round()
        });
        [start, end]
    }

    /// True if a stroke follows it in one sense over a part that determines it.
    fn follows(&self, at: &[[f64; 2]]) -> bool {
        let [start, end] = self.sweep(at);
        let sweep = (end - start).abs();
        let length: f64 = at.windows(2).map(|w| distance(w[0], w[1])).sum();
        let n = 64;
        let step = (end - start) / f64::from(n);
        let own: f64 = (0..n)
            .map(|k| {
                let t = start + step * f64::from(k);
                distance(self.at(t), self.at(t + step))
            })
            .sum();
        (0.6 * PI..1.05 * TAU).contains(&sweep) && own > 0.8 * length && own < 1.2 * length
    }
}

/// The ellipse of least algebraic distances.
fn halir_flusser(at: &[[f64; 2]]) -> Option<StrokeEllipse> {
    let n = at.len() as f64;
    if at.len() < 6 {
        return None;
    }
    let mean = at.iter().fold([0.0; 2], |m, p| [m[0] + p[0] / n, m[1] + p[1] / n]);
    let scale = (at.iter().map(|p| distance(mean, *p).powi(2)).sum::<f64>() / n).sqrt();
    if scale <= 0.0 {
        return None;
    }
    let (mut s1, mut s2, mut s3) = ([[0.0; 3]; 3], [[0.0; 3]; 3], [[0.0; 3]; 3]);
    for p in at {
        let [x, y] = [0, 1].map(|k| (p[k] - mean[k]) / scale);
        let (d1, d2) = ([x * x, x * y, y * y], [x, y, 1.0]);
        for i in 0..3 {
            for j in 0..3 {
                s1[i][j] += d1[i] * d1[j];
                s2[i][j] += d1[i] * d2[j];
                s3[i][j] += d2[i] * d2[j];
            }
        }
    }
    // T = -S3⁻¹ S2ᵀ, M = C1⁻¹ (S1 + S2 T).
    let rows =
        (0..3).map(|i| s3[i].into_iter().chain((0..3).map(|j| -s2[j][i])).collect()).collect();
    let t = solved(rows)?;
    let mut m = s1;
    for i in 0..3 {
        for j in 0..3 {
            m[i][j] += (0..3).map(|k| s2[i][k] * t[k][j]).sum::<f64>();
        }
    }
    let m = [m[2].map(|x| 0.5 * x), m[1].map(|x| -x), m[0].map(|x| 0.5 * x)];
    let trace = m[0][0] + m[1][1] + m[2][2];
    let minor = |i: usize, j: usize| m[i][i] * m[j][j] - m[i][j] * m[j][i];
    let second = minor(0, 1) + minor(0, 2) + minor(1, 2);
    let det = dot3(m[0], cross3(m[1], m[2]));
    for root in cubic_roots(-trace, second, -det) {
        let shifted: Vec<[f64; 3]> = (0..3)
            .map(|i| {
                let mut row = m[i];
                row[i] -= root;
                row
            })
            .collect();
        // The null vector: the longest product of two rows.
        let products = [(0, 1), (0, 2), (1, 2)].map(|(i, j)| cross3(shifted[i], shifted[j]));
        let a1 = products.into_iter().max_by(|p, q| dot3(*p, *p).total_cmp(&dot3(*q, *q)))?;
        if 4.0 * a1[0] * a1[2] - a1[1] * a1[1] <= 0.0 {
            continue;
        }
        let a2 = [0, 1, 2].map(|i| dot3([t[i][0], t[i][1], t[i][2]], a1));
        let conic = ellipse_of([a1[0], a1[1], a1[2], a2[0], a2[1], a2[2]])?;
        let centre = [0, 1].map(|k| mean[k] + scale * conic.centre[k]);
        return Some(StrokeEllipse {
            centre,
            half: conic.half.map(|h| scale * h),
            angle: conic.angle,
        });
    }
    None
}

/// The ellipse a x² + b x y + c y² + d x + e y + f = 0.
fn ellipse_of([a, b, c, d, e, f]: [f64; 6]) -> Option<StrokeEllipse> {
    let det = 4.0 * a * c - b * b;
    let x = (b * e - 2.0 * c * d) / det;
    let y = (b * d - 2.0 * a * e) / det;
    let level = -(f + 0.5 * (d * x + e * y));
    let angle = 0.5 * libm::atan2(b, a - c);
    let (cos, sin) = (libm::cos(angle), libm::sin(angle));
    let along = a * cos * cos + b * cos * sin + c * sin * sin;
    let across = a * sin * sin - b * cos * sin + c * cos * cos;
    let half = [level / along, level / across].map(f64::sqrt);
    let good = half.iter().all(|h| h.is_finite() && *h > 0.0);
    good.then(|| StrokeEllipse::of([x, y, half[0], half[1], angle]))
}

/// Real roots of x³ + a x² + b x + c.
fn cubic_roots(a: f64, b: f64, c: f64) -> Vec<f64> {
    let q = (a * a - 3.0 * b) / 9.0;
    let r = (2.0 * a * a * a - 9.0 * a * b + 27.0 * c) / 54.0;
    if r * r < q * q * q {
        let theta = libm::acos(r / (q * q * q).sqrt());
        let size = -2.0 * q.sqrt();
        [0.0, 1.0, -1.0].map(|k| size * libm::cos((theta + k * TAU) / 3.0) - a / 3.0).to_vec()
    } else {
        let one = -r.signum() * libm::cbrt(r.abs() + (r * r - q * q * q).max(0.0).sqrt());
        let two = if one == 0.0 { 0.0 } else { q / one };
        vec![one + two - a / 3.0]
    }
}

fn cross3(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot3(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Solutions of a linear system with its right sides beside the matrix: a row for each unknown.
fn solved(mut rows: Vec<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    let n = rows.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs()))?;
        rows.swap(k, pivot);
        let own = rows[k].clone();
        if own[k].is_nan() || own[k].abs() <= 1e-14 {
            return None;
        }
        for (r, row) in rows.iter_mut().enumerate() {
            if r != k {
                let factor = row[k] / own[k];
                row.iter_mut().zip(&own).skip(k).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
    Some((0..n).map(|k| rows[k][n..].iter().map(|x| x / rows[k][k]).collect()).collect())
}

/// The uniform cubic B-spline of least description length below a bound, as Bézier points, with its cost.
fn spline(
    at: &[[f64; 2]],
    closed: bool,
    precision: f64,
    bound: f64,
) -> Option<(Vec<[f64; 2]>, f64)> {
    let mut along = vec![0.0];
    for w in at.windows(2) {
        along.push(along.last().copied().unwrap_or(0.0) + distance(w[0], w[1]));
    }
    let gap = if closed { distance(at[at.len() - 1], at[0]) } else { 0.0 };
    let length = along.last().copied().unwrap_or(0.0) + gap;
    if length <= 0.0 {
        return None;
    }
    let mut best: Option<(Vec<[f64; 2]>, f64)> = None;
    for m in CONTROLS {
        let base = m as f64 * CONTROL;
        if 2 * m > at.len() || base >= best.as_ref().map_or(bound, |b| b.1) {
            break;
        }
        let spans = if closed { m } else { m - 3 };
        let mut t: Vec<f64> = along.iter().map(|s| s / length).collect();
        let mut found: Option<(Vec<[f64; 2]>, f64)> = None;
        for _ in 0..4 {
            let Some(controls) = controls(at, &t, m, spans) else { break };
            let mut squares = 0.0;
            for (p, t) in at.iter().zip(&mut t) {
                let (place, speed) = spline_at(&controls, spans, *t);
                let off = to(place, *p);
                let size = dot(speed, speed).max(1e-12);
                squares += cross(speed, off).powi(2) / size;
                let part = *t + dot(speed, off) / size;
                *t = if closed { part - part.floor() } else { part.clamp(0.0, 1.0) };
            }
            found = Some((controls, squares));
        }
        let Some((controls, squares)) = found else { continue };
        let cost = precision * squares + base;
        if cost < best.as_ref().map_or(bound, |b| b.1) {
            best = Some((controls, cost));
        }
    }
    let (controls, cost) = best?;
    let m = controls.len();
    let spans = if closed { m } else { m - 3 };
    let mut points = Vec::new();
    for k in 0..spans {
        let c = [0, 1, 2, 3].map(|j| controls[(k + j) % m]);
        let mix = |w: [f64; 4]| [0, 1].map(|x| (0..4).map(|j| w[j] * c[j][x]).sum::<f64>());
        if k == 0 {
            points.push(mix([1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0, 0.0]));
        }
        points.push(mix([0.0, 2.0 / 3.0, 1.0 / 3.0, 0.0]));
        points.push(mix([0.0, 1.0 / 3.0, 2.0 / 3.0, 0.0]));
        points.push(mix([0.0, 1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0]));
    }
    Some((points, cost))
}

/// The span of a parameter, and the weights of its four controls.
fn weights(t: f64, spans: usize) -> (usize, [f64; 4], [f64; 4]) {
    let x = t * spans as f64;
    let span = (x as usize).min(spans - 1);
    let s = x - span as f64;
    let w = 1.0 - s;
    let value = [
        w * w * w / 6.0,
        (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0,
        (3.0 * w * w * w - 6.0 * w * w + 4.0) / 6.0,
        s * s * s / 6.0,
    ];
    let scale = spans as f64;
    let slope = [
        -0.5 * w * w * scale,
        (1.5 * s * s - 2.0 * s) * scale,
        (-1.5 * w * w + 2.0 * w) * scale,
        0.5 * s * s * scale,
    ];
    (span, value, slope)
}

fn spline_at(controls: &[[f64; 2]], spans: usize, t: f64) -> ([f64; 2], [f64; 2]) {
    let (span, value, slope) = weights(t, spans);
    let m = controls.len();
    let mix = |w: &[f64; 4]| {
        [0, 1].map(|x| (0..4).map(|j| w[j] * controls[(span + j) % m][x]).sum::<f64>())
    };
    (mix(&value), mix(&slope))
}

/// Controls of least squares, with a light penalty on their third differences.
fn controls(at: &[[f64; 2]], t: &[f64], m: usize, spans: usize) -> Option<Vec<[f64; 2]>> {
    let mut rows = vec![vec![0.0; m + 2]; m];
    for (p, t) in at.iter().zip(t) {
        let (span, value, _) = weights(*t, spans);
        for i in 0..4 {
            let row = &mut rows[(span + i) % m];
            for j in 0..4 {
                row[(span + j) % m] += value[i] * value[j];
            }
            row[m] += value[i] * p[0];
            row[m + 1] += value[i] * p[1];
        }
    }
    for (k, row) in rows.iter_mut().enumerate() {
        row[k] += 1e-9;
    }
    solved(rows).map(|rows| rows.into_iter().map(|r| [r[0], r[1]]).collect())
}
