//! Strokes as a hand draws them: the pen follows a path, slower at corners and in bends, with tremor and
//! jitter, and is sampled at 30 to 240 Hz. The truth is the path.

use moldloft_testing::Random;
use std::f64::consts::{PI, TAU};

pub type Place = [f64; 2];

/// A piece of a path.
#[derive(Clone, Debug)]
pub enum Way {
    Line(Place, Place),
    /// Centre, radius, start angle, sweep.
    Arc(Place, f64, f64, f64),
    /// Centre, half-axes, turn, start of the parameter, sweep.
    Ellipse(Place, [f64; 2], f64, f64, f64),
    /// A closed or open curve by closely spaced points.
    Curve(Vec<Place>),
}

impl Way {
    pub fn at(&self, s: f64) -> Place {
        match self {
            Way::Line(a, b) => [0, 1].map(|k| a[k] + s * (b[k] - a[k])),
            Way::Arc(c, r, start, sweep) => {
                let t = start + s * sweep;
                [c[0] + r * t.cos(), c[1] + r * t.sin()]
            }
            Way::Ellipse(c, [a, b], turn, start, sweep) => {
                let t = start + s * sweep;
                let (x, y) = (a * t.cos(), b * t.sin());
                [c[0] + x * turn.cos() - y * turn.sin(), c[1] + x * turn.sin() + y * turn.cos()]
            }
            Way::Curve(points) => {
                let x = s * (points.len() - 1) as f64;
                let k = (x as usize).min(points.len() - 2);
                [0, 1].map(|j| points[k][j] + (x - k as f64) * (points[k + 1][j] - points[k][j]))
            }
        }
    }

    fn scaled(&self, s: f64) -> Way {
        let p = |p: &Place| [s * p[0], s * p[1]];
        match self {
            Way::Line(a, b) => Way::Line(p(a), p(b)),
            Way::Arc(c, r, start, sweep) => Way::Arc(p(c), s * r, *start, *sweep),
            Way::Ellipse(c, half, turn, start, sweep) => {
                Way::Ellipse(p(c), p(half), *turn, *start, *sweep)
            }
            Way::Curve(points) => Way::Curve(points.iter().map(p).collect()),
        }
    }

    pub fn word(&self) -> &'static str {
        match self {
            Way::Line(..) => "line",
            Way::Arc(.., sweep) if sweep.abs() > 6.2 => "circle",
            Way::Arc(..) => "arc",
            Way::Ellipse(.., sweep) if sweep.abs() > 6.2 => "ellipse",
            Way::Ellipse(..) => "elliptical arc",
            Way::Curve(_) => "spline",
        }
    }
}

/// A drawn stroke with its truth.
pub struct Drawn {
    pub ways: Vec<Way>,
    /// Corners: for each piece, true if the next one continues it smoothly.
    pub smooth: Vec<bool>,
    pub closed: bool,
    /// Time in seconds, u, v.
    pub samples: Vec<[f64; 3]>,
}

fn away(a: Place, b: Place) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

pub fn normal(r: &mut Random) -> f64 {
    (-2.0 * r.unit().max(1e-300).ln()).sqrt() * (TAU * r.unit()).cos()
}

fn polyline(r: &mut Random, corners: usize) -> Vec<Place> {
    loop {
        let mut heading = r.between(0.0, TAU);
        let mut points = vec![[0.0, 0.0]];
        let mut sense = if r.chance(50) { 1.0 } else { -1.0 };
        for k in 0..=corners {
            let (length, [x, y]) = (r.between(60.0, 200.0), points[k]);
            points.push([x + length * heading.cos(), y + length * heading.sin()]);
            if r.chance(60) {
                sense = -sense;
            }
            // Interior angles of 20 to 160 degrees.
            heading += sense * (180.0 - r.between(20.0, 160.0)).to_radians();
        }
        let points = sized(points);
        if points.windows(2).all(|w| away(w[0], w[1]) > 25.0) {
            return points;
        }
    }
}

fn polygon(r: &mut Random, corners: usize) -> Vec<Place> {
    loop {
        let start = r.between(0.0, TAU);
        let point = |k: usize, r: &mut Random| {
            let a = start + TAU * (k as f64 + r.between(-0.3, 0.3)) / corners as f64;
            let d = r.between(80.0, 200.0);
            [d * a.cos(), d * a.sin()]
        };
        let points = sized((0..corners).map(|k| point(k, r)).collect());
        let n = corners;
        let good = (0..n).all(|k| {
            let [a, b, c] = [points[k], points[(k + 1) % n], points[(k + 2) % n]];
            let (d, e) = ([a[0] - b[0], a[1] - b[1]], [c[0] - b[0], c[1] - b[1]]);
            let angle = (d[0] * e[1] - d[1] * e[0]).atan2(d[0] * e[0] + d[1] * e[1]).abs();
            (20.0..160.0).contains(&angle.to_degrees()) && away(a, b) > 40.0
        });
        if good {
            return points;
        }
    }
}

/// Scaled to a size of 400.
fn sized(points: Vec<Place>) -> Vec<Place> {
    let range = |k: usize| {
        let all = points.iter().map(|p| p[k]);
        let (low, high) = all.fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
        (low, high)
    };
    let (u, v) = (range(0), range(1));
    let scale = 400.0 / (u.1 - u.0).hypot(v.1 - v.0);
    points.iter().map(|p| [(p[0] - u.0) * scale, (p[1] - v.0) * scale]).collect()
}

fn lines(points: &[Place], closed: bool) -> Vec<Way> {
    let n = points.len();
    let count = if closed { n } else { n - 1 };
    (0..count).map(|k| Way::Line(points[k], points[(k + 1) % n])).collect()
}

/// A smooth curve whose curvature varies: Fourier terms about a circle, or a wave.
fn curve(r: &mut Random, closed: bool) -> Vec<Place> {
    let n = 400;
    let (a, b) = (r.between(0.0, TAU), r.between(0.0, TAU));
    let points = if closed {
        let (two, three) = (r.between(0.05, 0.12), r.between(0.12, 0.22));
        (0..=n)
            .map(|k| {
                let t = TAU * f64::from(k) / f64::from(n);
                let d = 150.0 * (1.0 + two * (2.0 * t + a).cos() + three * (3.0 * t + b).cos());
                [d * t.cos(), d * t.sin()]
            })
            .collect()
    } else {
        let (waves, height) = (r.between(1.0, 2.2), r.between(40.0, 90.0));
        (0..=n)
            .map(|k| {
                let s = f64::from(k) / f64::from(n);
                let x = 320.0 * s;
                let y = height * (TAU * waves * s + a).sin() * (0.5 + s);
                [x * b.cos() - y * b.sin(), x * b.sin() + y * b.cos()]
            })
            .collect()
    };
    sized(points)
}

/// A path of a family.
fn path(r: &mut Random, family: &'static str) -> (Vec<Way>, Vec<bool>, bool) {
    let corners = |ways: Vec<Way>, closed: bool| {
        let smooth = vec![false; ways.len()];
        (ways, smooth, closed)
    };
    match family {
        "polyline" => {
            let n = 2 + r.below(11);
            corners(lines(&polyline(r, n), false), false)
        }
        "polygon" => {
            let n = 3 + r.below(6);
            corners(lines(&polygon(r, n), true), true)
        }
        "line" => {
            let a = r.between(0.0, TAU);
            corners(vec![Way::Line([0.0, 0.0], [400.0 * a.cos(), 400.0 * a.sin()])], false)
        }
        "arc" => {
            let sweep = r.between(60.0, 290.0).to_radians();
            let radius = (200.0 / (0.5 * sweep.min(PI)).sin()).min(900.0);
            let sign = if r.chance(50) { 1.0 } else { -1.0 };
            corners(vec![Way::Arc([0.0, 0.0], radius, r.between(0.0, TAU), sign * sweep)], false)
        }
        "circle" => {
            let sign = if r.chance(50) { 1.0 } else { -1.0 };
            let way = Way::Arc([0.0, 0.0], 140.0, r.between(0.0, TAU), sign * TAU);
            (vec![way], vec![true], true)
        }
        "ellipse" => {
            let half = [190.0, 190.0 * r.between(0.3, 0.8)];
            let (turn, start) = (r.between(0.0, PI), r.between(0.0, TAU));
            (vec![Way::Ellipse([0.0, 0.0], half, turn, start, TAU)], vec![true], true)
        }
        "spline" => corners(vec![Way::Curve(curve(r, false))], false),
        "closed spline" => (vec![Way::Curve(curve(r, true))], vec![true], true),
        "slot" => {
            let (d, l) = (r.between(50.0, 110.0), r.between(120.0, 280.0));
            let ways = vec![
                Way::Line([0.0, -d], [l, -d]),
                Way::Arc([l, 0.0], d, -0.5 * PI, PI),
                Way::Line([l, d], [0.0, d]),
                Way::Arc([0.0, 0.0], d, 0.5 * PI, PI),
            ];
            (ways, vec![true; 4], true)
        }
        "rounded corner" => {
            let d = r.between(40.0, 100.0);
            let (a, b) = (r.between(80.0, 250.0), r.between(80.0, 250.0));
            let ways = vec![
                Way::Line([-a, 0.0], [0.0, 0.0]),
                Way::Arc([0.0, d], d, -0.5 * PI, 0.5 * PI),
                Way::Line([d, d], [d, d + b]),
            ];
            (ways, vec![true, true, false], false)
        }
        "half disc" => {
            let d = r.between(100.0, 180.0);
            let ways = vec![Way::Line([-d, 0.0], [d, 0.0]), Way::Arc([0.0, 0.0], d, 0.0, PI)];
            (ways, vec![false, false], true)
        }
        _ => {
            // Lines and arcs in turn, with corners.
            let d = r.between(60.0, 100.0);
            let e = d + r.between(60.0, 120.0);
            let bulge = r.between(0.5, 0.9) * PI;
            let ways = vec![
                Way::Line([-e, -e], [-e, 0.0]),
                Way::Line([-e, 0.0], [-d, 0.0]),
                Way::Arc([0.0, 0.0], d, PI, -bulge),
            ];
            let end = ways[2].at(1.0);
            // Away from the arc by 40 to 100 degrees.
            let leave = PI - bulge - 0.5 * PI + r.between(40.0, 100.0).to_radians();
            let tip = [end[0] + e * leave.cos(), end[1] + e * leave.sin()];
            corners([ways, vec![Way::Line(end, tip)]].concat(), false)
        }
    }
}

pub const FAMILIES: [&str; 12] = [
    "line",
    "polyline",
    "polygon",
    "arc",
    "circle",
    "ellipse",
    "spline",
    "closed spline",
    "slot",
    "rounded corner",
    "half disc",
    "mixed",
];

/// A stroke of a family, of a noise in units of a size of 400.
pub fn drawn(r: &mut Random, family: &'static str, noise: f64) -> Drawn {
    let (mut ways, smooth, closed) = path(r, family);
    if closed && matches!(family, "polygon" | "slot" | "half disc") && r.chance(30) {
        // Begun within the first piece.
        let first = ways.remove(0);
        let s = r.between(0.3, 0.7);
        let part = |a: f64, b: f64| match &first {
            Way::Line(..) => Way::Line(first.at(a), first.at(b)),
            other => other.clone(),
        };
        let (one, two) = (part(s, 1.0), part(0.0, s));
        ways.insert(0, one);
        ways.push(two);
    }
    let size = {
        let all: Vec<Place> =
            ways.iter().flat_map(|w| (0..=40).map(|k| w.at(f64::from(k) / 40.0))).collect();
        let range = |k: usize| {
            let (low, high) =
                all.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p[k]), h.max(p[k])));
            high - low
        };
        range(0).hypot(range(1))
    };
    ways = ways.iter().map(|w| w.scaled(400.0 / size)).collect();
    // Dense points of the path with the distance to the next corner.
    let mut dense: Vec<(Place, f64)> = Vec::new();
    for way in &ways {
        dense.extend((0..200).map(|k| (way.at(f64::from(k) / 200.0), 0.0)));
    }
    dense.push((ways[ways.len() - 1].at(1.0), 0.0));
    if closed && r.chance(40) {
        // It overshoots the start, or retraces a part of it.
        let more = r.between(2.0, 14.0);
        let mut left = if family == "circle" { 6.0 * more } else { more };
        for k in 1..200 {
            let (p, q) = (dense[k - 1].0, dense[k].0);
            dense.push((q, 0.0));
            left -= away(p, q);
            if left < 0.0 {
                break;
            }
        }
    }
    let n = dense.len();
    let mut slow = vec![f64::INFINITY; n];
    let direction = |k: usize| {
        let (a, b) = (dense[k.saturating_sub(1)].0, dense[(k + 1).min(n - 1)].0);
        (b[1] - a[1]).atan2(b[0] - a[0])
    };
    for (k, s) in slow.iter_mut().enumerate() {
        let (a, b) = (direction(k.saturating_sub(2)), direction((k + 2).min(n - 1)));
        let bend = ((b - a + PI).rem_euclid(TAU) - PI).abs();
        if bend > 0.3 || k == 0 || k == n - 1 {
            *s = 0.0;
        }
    }
    for k in 1..n {
        slow[k] = slow[k].min(slow[k - 1] + away(dense[k - 1].0, dense[k].0));
    }
    for k in (0..n - 1).rev() {
        slow[k] = slow[k].min(slow[k + 1] + away(dense[k + 1].0, dense[k].0));
    }
    // The pen, in steps of a millisecond, lags a little behind.
    let (speed, rate) = (r.between(250.0, 900.0), r.between(30.0, 240.0));
    let lag = r.between(0.004, 0.012);
    let (reach, correlation) = (r.between(15.0, 45.0), r.between(12.0, 45.0));
    let (white, tremor) = (0.35 * noise, 0.93 * noise);
    let mut shake = [tremor * normal(r), tremor * normal(r)];
    let mut samples = Vec::new();
    let (mut k, mut part, mut time, mut due) = (0, 0.0, 0.0, 0.0);
    let mut pen = dense[0].0;
    while k + 1 < n {
        let (p, q) = (dense[k].0, dense[k + 1].0);
        let target = [0, 1].map(|j| p[j] + part * (q[j] - p[j]));
        let follow = 1.0 - (-0.001 / lag).exp();
        pen = [0, 1].map(|j| pen[j] + follow * (target[j] - pen[j]));
        let way = speed * (0.12 + 0.88 * (slow[k] / reach).min(1.0)) * 0.001;
        let keep = (-way / correlation).exp();
        let fresh = tremor * (1.0 - keep * keep).sqrt();
        shake = shake.map(|x| keep * x + fresh * normal(r));
        if time >= due {
            due = time + r.between(0.7, 1.3) / rate;
            let sample = [0, 1].map(|j| pen[j] + shake[j] + white * normal(r));
            samples.push([time, sample[0], sample[1]]);
            if r.chance(4) {
                samples.push([time, sample[0], sample[1]]);
            }
        }
        time += 0.001;
        let mut left = way;
        while k + 1 < n {
            let length = away(dense[k].0, dense[k + 1].0);
            if part * length + left < length {
                part += left / length;
                break;
            }
            left -= (1.0 - part) * length;
            (k, part) = (k + 1, 0.0);
        }
    }
    let end = dense[n - 1].0;
    samples.push([time, end[0] + shake[0], end[1] + shake[1]]);
    Drawn { ways, smooth, closed, samples }
}
