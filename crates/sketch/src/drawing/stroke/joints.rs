//! Joints of the shapes of a stroke: corners where they meet, and the pieces between these.

use super::cells::StrokeCells;
use super::shapes::{FittedRun, StrokeShape};
use super::{StrokeKind, StrokePiece, cross, distance, dot, to};
use std::f64::consts::PI;

/// Sine of the angle of two lines below which they meet between their samples.
const PARALLEL: f64 = 0.08;

/// The pieces of shapes, each from the joint before it to the joint after it.
pub(super) fn joined(cells: &StrokeCells, fitted: &[FittedRun], closed: bool) -> Vec<StrokePiece> {
    let n = fitted.len();
    if let [one] = fitted
        && matches!(one.shape, StrokeShape::Circle(..) | StrokeShape::Ellipse(_))
    {
        return vec![piece(cells, one, [[0.0; 2]; 2])];
    }
    let joint = |k: usize| -> [f64; 2] {
        let (one, two) = (&fitted[k], &fitted[(k + 1) % n]);
        meeting(cells, one, two)
    };
    let mut joints: Vec<[f64; 2]> = (0..n - 1).map(joint).collect();
    if closed {
        joints.push(if n > 1 { joint(n - 1) } else { own_end(cells, &fitted[0], false) });
    }
    let start = |k: usize| match k {
        0 if closed => joints[n - 1],
        0 => own_end(cells, &fitted[0], false),
        k => joints[k - 1],
    };
    let end = |k: usize| joints.get(k).copied().unwrap_or_else(|| own_end(cells, &fitted[k], true));
    (0..n).map(|k| piece(cells, &fitted[k], [start(k), end(k)])).collect()
}

/// The end of a shape, near the first or last sample.
fn own_end(cells: &StrokeCells, fitted: &FittedRun, last: bool) -> [f64; 2] {
    let own = &cells.samples[fitted.cells.clone()];
    let sample = match last {
        true => own.last().and_then(|s| s.last()),
        false => own.first().and_then(|s| s.first()),
    };
    let Some(&p) = sample else { return [0.0; 2] };
    match &fitted.shape {
        StrokeShape::Spline(points) => points[if last { points.len() - 1 } else { 0 }],
        shape => foot(shape, p),
    }
}

/// The point of a shape near a position.
fn foot(shape: &StrokeShape, p: [f64; 2]) -> [f64; 2] {
    match shape {
        StrokeShape::Line(q, d) => {
            let s = dot(to(*q, p), *d);
            [q[0] + s * d[0], q[1] + s * d[1]]
        }
        StrokeShape::Arc(c, r) | StrokeShape::Circle(c, r) => {
            let way = to(*c, p);
            let length = libm::hypot(way[0], way[1]);
            if length == 0.0 { p } else { [0, 1].map(|k| c[k] + r * way[k] / length) }
        }
        StrokeShape::EllipseArc(e) | StrokeShape::Ellipse(e) => e.at(e.parameter(p)),
        StrokeShape::Spline(_) => p,
    }
}

/// The point where two consecutive shapes meet.
fn meeting(cells: &StrokeCells, one: &FittedRun, two: &FittedRun) -> [f64; 2] {
    let [a, b] = [cells.at[one.cells.end - 1], cells.at[two.cells.start]];
    let middle = [0, 1].map(|k| 0.5 * (a[k] + b[k]));
    let gap = distance(a, b);
    let near = |p: &[f64; 2], sine: f64| {
        distance(*p, middle) <= 1.5 * gap + 6.0 * cells.noise / sine.max(PARALLEL)
    };
    let found: Option<[f64; 2]> = match (&one.shape, &two.shape) {
        (StrokeShape::Line(p, d), StrokeShape::Line(q, e)) => {
            let sine = cross(*d, *e);
            let s = cross(to(*p, *q), *e) / sine;
            let at = [p[0] + s * d[0], p[1] + s * d[1]];
            (sine.abs() > PARALLEL && near(&at, sine.abs())).then_some(at)
        }
        (StrokeShape::Line(p, d), StrokeShape::Arc(c, r))
        | (StrokeShape::Arc(c, r), StrokeShape::Line(p, d)) => {
            let s = dot(to(*p, *c), *d);
            let foot = [p[0] + s * d[0], p[1] + s * d[1]];
            let square = r * r - distance(foot, *c).powi(2);
            let half = square.max(0.0).sqrt();
            let both = [half, -half].map(|h| [foot[0] + h * d[0], foot[1] + h * d[1]]);
            nearest(both, middle).filter(|p| square >= 0.0 && near(p, half / r))
        }
        (StrokeShape::Arc(c, r), StrokeShape::Arc(e, q)) => {
            let (way, apart) = (to(*c, *e), distance(*c, *e));
            let along = 0.5 * (apart + (r * r - q * q) / apart);
            let square = r * r - along * along;
            let half = square.max(0.0).sqrt();
            let unit = way.map(|x| x / apart);
            let both = [half, -half].map(|h| {
                [c[0] + along * unit[0] - h * unit[1], c[1] + along * unit[1] + h * unit[0]]
            });
            nearest(both, middle).filter(|p| square >= 0.0 && near(p, half / r.min(*q)))
        }
        _ => None,
    };
    found.unwrap_or_else(|| {
        let feet = [foot(&one.shape, middle), foot(&two.shape, middle)];
        [0, 1].map(|k| 0.5 * (feet[0][k] + feet[1][k]))
    })
}

fn nearest(both: [[f64; 2]; 2], to: [f64; 2]) -> Option<[f64; 2]> {
    both.into_iter()
        .filter(|p| p[0].is_finite() && p[1].is_finite())
        .min_by(|a, b| distance(*a, to).total_cmp(&distance(*b, to)))
}

/// The piece of a shape between two joints.
fn piece(cells: &StrokeCells, fitted: &FittedRun, [start, end]: [[f64; 2]; 2]) -> StrokePiece {
    let at = &cells.at[fitted.cells.clone()];
    let samples = cells.samples[fitted.cells.clone()].iter().flatten();
    let count = samples.clone().count().max(1) as f64;
    let rms = |off: &dyn Fn([f64; 2]) -> f64| {
        (samples.clone().map(|p| off(*p).powi(2)).sum::<f64>() / count).sqrt()
    };
    let mut piece = StrokePiece {
        kind: StrokeKind::Line,
        points: vec![start, end],
        centre: None,
        radius: None,
        half_axes: None,
        residual: 0.0,
        smooth: fitted.smooth,
    };
    match &fitted.shape {
        StrokeShape::Line(..) => {
            let (way, length) = (to(start, end), distance(start, end).max(f64::MIN_POSITIVE));
            piece.residual = rms(&|p| cross(way, to(start, p)) / length);
        }
        StrokeShape::Arc(c, r) => {
            let sense = sense(*c, at);
            let (centre, radius) = through([start, end], *c, *r, at);
            piece.kind = StrokeKind::Arc;
            piece.points = vec![start, middle_of_arc(centre, radius, start, end, sense), end];
            (piece.centre, piece.radius) = (Some(centre), Some(radius));
            piece.residual = rms(&|p| distance(centre, p) - radius);
        }
        StrokeShape::Circle(c, r) => {
            piece.kind = StrokeKind::Circle;
            piece.points.clear();
            (piece.centre, piece.radius) = (Some(*c), Some(*r));
            piece.residual = rms(&|p| distance(*c, p) - r);
        }
        StrokeShape::EllipseArc(e) | StrokeShape::Ellipse(e) => {
            let whole = matches!(fitted.shape, StrokeShape::Ellipse(_));
            piece.kind = if whole { StrokeKind::Ellipse } else { StrokeKind::EllipseArc };
            (piece.centre, piece.half_axes) = (Some(e.centre), Some(e.axes()));
            piece.residual = rms(&|p| e.squares(&[p]).sqrt());
            if whole {
                piece.points.clear();
            } else {
                let [from, until] = e.sweep(at);
                piece.points = vec![start, e.at(0.5 * (from + until)), end];
            }
        }
        StrokeShape::Spline(points) => {
            let mut points = points.clone();
            let last = points.len() - 1;
            let closed = distance(points[0], points[last]) < 1e-12;
            let ends = if closed { [points[0], points[last]] } else { [start, end] };
            // The ends move to the joints, with the tangents beside them.
            for (k, beside, wanted) in [(0, 1, ends[0]), (last, last - 1, ends[1])] {
                let by = to(points[k], wanted);
                points[k] = wanted;
                points[beside] = [0, 1].map(|x| points[beside][x] + by[x]);
            }
            piece.kind = StrokeKind::Spline;
            piece.residual = rms(&|p| off_chain(&points, p));
            piece.points = points;
        }
    }
    piece
}

/// The sense in which cells run round a centre: 1 counter-clockwise.
fn sense(c: [f64; 2], at: &[[f64; 2]]) -> f64 {
    let sum: f64 = at.windows(2).map(|w| cross(to(c, w[0]), to(c, w[1]))).sum();
    sum.signum()
}

/// The circle through both ends of an arc that is nearest to its cells.
fn through(
    [start, end]: [[f64; 2]; 2],
    centre: [f64; 2],
    radius: f64,
    at: &[[f64; 2]],
) -> ([f64; 2], f64) {
    let chord = distance(start, end);
    if chord < 1e-6 * radius || chord >= 2.0 * radius {
        return (centre, radius);
    }
    let middle = [0, 1].map(|k| 0.5 * (start[k] + end[k]));
    let across = to(start, end).map(|x| x / chord);
    let across = [-across[1], across[0]];
    // The centre is `offset` from the chord, to its left.
    let circle = |offset: f64| {
        let c = [0, 1].map(|k| middle[k] + offset * across[k]);
        (c, libm::hypot(offset, 0.5 * chord))
    };
    let squares = |offset: f64| -> f64 {
        let (c, r) = circle(offset);
        at.iter().map(|p| (distance(c, *p) - r).powi(2)).sum()
    };
    let mut offset = dot(to(middle, centre), across);
    let mut step = 0.1 * radius;
    let mut best = squares(offset);
    while step > 1e-7 * radius {
        let tried = [offset - step, offset + step].map(|o| (squares(o), o));
        let (found, at) = if tried[0].0 < tried[1].0 { tried[0] } else { tried[1] };
        if found < best {
            (best, offset) = (found, at);
        } else {
            step *= 0.4;
        }
    }
    circle(offset)
}

/// The middle of an arc.
fn middle_of_arc(c: [f64; 2], r: f64, start: [f64; 2], end: [f64; 2], sense: f64) -> [f64; 2] {
    let [a, b] = [start, end].map(|p| libm::atan2(p[1] - c[1], p[0] - c[0]));
    let mut sweep = sense * (b - a);
    if sweep <= 0.0 {
        sweep += 2.0 * PI;
    }
    if sweep > 2.0 * PI {
        sweep -= 2.0 * PI;
    }
    let m = a + 0.5 * sense * sweep;
    [c[0] + r * libm::cos(m), c[1] + r * libm::sin(m)]
}

/// Distance of a point from a chain of cubics, by chords.
fn off_chain(points: &[[f64; 2]], p: [f64; 2]) -> f64 {
    let mut best = f64::INFINITY;
    let mut before = points[0];
    for k in (0..points.len() - 1).step_by(3) {
        for j in 1..=8 {
            let (s, w) = (f64::from(j) / 8.0, 1.0 - f64::from(j) / 8.0);
            let b = [w * w * w, 3.0 * w * w * s, 3.0 * w * s * s, s * s * s];
            let q = [0, 1].map(|x| (0..4).map(|i| b[i] * points[k + i][x]).sum::<f64>());
            let way = to(before, q);
            let part = (dot(to(before, p), way) / dot(way, way).max(1e-30)).clamp(0.0, 1.0);
            best = best.min(distance(p, [before[0] + part * way[0], before[1] + part * way[1]]));
            before = q;
        }
    }
    best
}
