//! Sections as they come: listings of aerofoils, and blades of cascades.
//!
//! `MOLDLOFT_AEROFOILS` names a folder of listings in Selig's order (tail, upper side, nose, lower
//! side, tail), such as the UIUC collection; the default is the three sections below.

use crate::walls::{Wall, geometric, with_base};
use moldloft_num::Vec3;
use std::f64::consts::PI;

/// Stations, upper and lower ordinates of sections, in per cent of the chord: Clark Y (NACA Report 352), and two of
/// listings that are as uneven as old ones are, with a blunt tail and a reflexed one.
const TABLES: [(&str, &[[f64; 3]]); 3] = [
    (
        "Clark Y",
        &[
            [0.0, 3.50, 3.50],
            [1.25, 5.45, 1.93],
            [2.5, 6.50, 1.47],
            [5.0, 7.90, 0.93],
            [7.5, 8.85, 0.63],
            [10.0, 9.60, 0.42],
            [15.0, 10.68, 0.15],
            [20.0, 11.36, 0.03],
            [30.0, 11.70, 0.0],
            [40.0, 11.40, 0.0],
            [50.0, 10.52, 0.0],
            [60.0, 9.15, 0.0],
            [70.0, 7.35, 0.0],
            [80.0, 5.22, 0.0],
            [90.0, 2.80, 0.0],
            [95.0, 1.49, 0.0],
            [100.0, 0.12, 0.0],
        ],
    ),
    (
        "blunt",
        &[
            [0.0, 0.0, 0.0],
            [2.0, 3.1, -2.2],
            [5.0, 4.9, -3.1],
            [10.0, 6.8, -3.9],
            [20.0, 9.0, -4.6],
            [35.0, 10.1, -4.8],
            [50.0, 9.2, -4.2],
            [70.0, 6.1, -2.6],
            [85.0, 3.3, -1.4],
            [100.0, 0.8, -0.6],
        ],
    ),
    (
        "reflexed",
        &[
            [0.0, 0.0, 0.0],
            [1.0, 1.9, -1.2],
            [5.0, 4.6, -2.3],
            [15.0, 7.4, -3.0],
            [30.0, 8.4, -3.3],
            [50.0, 6.8, -3.2],
            [70.0, 3.9, -2.5],
            [90.0, 0.9, -1.1],
            [100.0, 0.0, 0.0],
        ],
    ),
];

fn point(x: f64, y: f64) -> Vec3 {
    Vec3::of(x, y, 0.0)
}

/// The listings: names and points, from the tail below round the nose, so that the left side is outside.
fn listings() -> Vec<(String, Vec<Vec3>)> {
    let mut all = Vec::new();
    for (name, table) in TABLES {
        let lower = table.iter().rev().map(|[x, _, y]| point(x / 100.0, y / 100.0));
        let upper = table[1..].iter().map(|[x, y, _]| point(x / 100.0, y / 100.0));
        all.push((name.to_string(), lower.chain(upper).collect()));
    }
    let Some(folder) = std::env::var_os("MOLDLOFT_AEROFOILS") else { return all };
    let files = std::fs::read_dir(folder).expect("the folder of listings can be read");
    let mut paths: Vec<_> = files.map(|file| file.unwrap().path()).collect();
    paths.sort();
    for path in paths {
        let Ok(text) = std::fs::read_to_string(&path) else { continue };
        let numbers = |line: &str| -> Option<[f64; 2]> {
            let mut words = line.split_whitespace().map(str::parse::<f64>);
            match (words.next(), words.next(), words.next()) {
                (Some(Ok(x)), Some(Ok(y)), None) => Some([x, y]),
                _ => None,
            }
        };
        let mut points: Vec<Vec3> =
            text.lines().filter_map(numbers).map(|[x, y]| point(x, y)).collect();
        points.dedup();
        let inside = points.iter().all(|p| p.x > -0.5 && p.x < 1.5 && p.y.abs() < 0.5);
        if points.len() < 20 || !inside || crosses_itself(&points) {
            continue;
        }
        let area: f64 = points.windows(2).map(|w| w[0].x * w[1].y - w[0].y * w[1].x).sum();
        if area > 0.0 {
            points.reverse();
        }
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        all.push((name, points));
    }
    all
}

/// True when two edges that are not neighbours cross.
fn crosses_itself(points: &[Vec3]) -> bool {
    let n = points.len() - 1;
    let side = |a: Vec3, b: Vec3, c: Vec3| (b - a).cross(c - a).z;
    for i in 0..n {
        for j in i + 2..n {
            let (a, b, c, d) = (points[i], points[i + 1], points[j], points[j + 1]);
            let apart = side(a, b, c) * side(a, b, d) > 0.0 || side(c, d, a) * side(c, d, b) > 0.0;
            let neighbours = i == 0 && j + 1 == n;
            if !apart && !neighbours {
                return true;
            }
        }
    }
    false
}

/// Points of the natural cubic spline through points, by chord length, at the given fractions of
/// it.
fn spline(points: &[Vec3], at: &[f64]) -> Vec<Vec3> {
    let n = points.len();
    let mut t = vec![0.0];
    for w in points.windows(2) {
        t.push(t[t.len() - 1] + w[0].distance(w[1]));
    }
    // Second derivatives, by elimination.
    let (mut upper, mut second) = (vec![0.0; n], vec![Vec3::zero(); n]);
    for k in 1..n - 1 {
        let (h, g) = (t[k] - t[k - 1], t[k + 1] - t[k]);
        let right = ((points[k + 1] - points[k]) / g - (points[k] - points[k - 1]) / h) * 6.0;
        let pivot = 2.0 * (h + g) - h * upper[k - 1];
        upper[k] = g / pivot;
        second[k] = (right - second[k - 1] * h) / pivot;
    }
    for k in (1..n - 1).rev() {
        let next = second[k + 1];
        second[k] -= next * upper[k];
    }
    let whole = t[n - 1];
    at.iter()
        .map(|share| {
            let s = share * whole;
            let k = t[1..n - 1].iter().filter(|x| **x <= s).count();
            let h = t[k + 1] - t[k];
            let (a, b) = ((t[k + 1] - s) / h, (s - t[k]) / h);
            let bent = second[k] * (a * a * a - a) + second[k + 1] * (b * b * b - b);
            points[k] * a + points[k + 1] * b + bent * (h * h / 6.0)
        })
        .collect()
}

/// Shares along a section of `n` points, dense at the tail on both sides and round the nose, which is at `nose`.
fn shares(n: usize, nose: f64) -> Vec<f64> {
    let half = n / 2;
    let cosine = |k: usize, n: usize| 0.5 - 0.5 * (PI * k as f64 / n as f64).cos();
    let first = (0..=half).map(|k| nose * cosine(k, half));
    let last = (1..n - half).map(|k| nose + (1.0 - nose) * cosine(k, n - 1 - half));
    first.chain(last).collect()
}

/// Closes a section: to the bit where the tail is sharp, with cells across it where it is blunt.
fn closed(mut points: Vec<Vec3>) -> Vec<Vec3> {
    let n = points.len();
    let gap = points[0].distance(points[n - 1]);
    if gap < 1e-9 {
        points[n - 1] = points[0];
        return points;
    }
    // Cells across the base about as long as those beside it.
    let beside = points[0].distance(points[1]).min(points[n - 1].distance(points[n - 2]));
    with_base(&points, ((gap / beside).round() as usize).clamp(1, 12))
}

/// A blade of a cascade: a round nose and a round tail on an arc that turns the flow.
fn blade(n: usize, turning: f64, thickness: f64, tail: f64) -> Vec<Vec3> {
    let turning = turning.to_radians();
    let radius = 0.5 / (0.5 * turning).sin();
    let arc = |x: f64| {
        let a = (x - 0.5) * turning;
        let centre = point(0.5 + radius * a.sin(), radius * (a.cos() - (0.5 * turning).cos()));
        (centre, point(a.sin(), a.cos()))
    };
    // Half thickness: a parabola's nose that becomes a circle's tail.
    let half = |x: f64| {
        let form =
            1.4845 * x.sqrt() - 0.63 * x - 1.758 * x * x + 1.4215 * x.powi(3) - 0.518 * x.powi(4);
        let end = tail * (1.0 - ((x - 1.0 + tail).max(0.0) / tail).powi(2)).max(0.0).sqrt();
        thickness * form + end * x
    };
    let sides: Vec<Vec3> = (0..=800)
        .map(|k| {
            let b = 2.0 * PI * f64::from(k) / 800.0;
            let x = 0.5 * (1.0 + b.cos());
            let (centre, out) = arc(x);
            centre + out * half(x) * if b <= PI { -1.0 } else { 1.0 }
        })
        .collect();
    let mut points = spline(&sides, &shares(n, 0.49));
    *points.last_mut().unwrap() = points[0];
    points
}

/// The listings as they are and with three counts of points, and blades, each for three first cells.
pub fn sections(every: usize) -> Vec<Wall> {
    let mut all = Vec::new();
    let mut add = |name: String, points: Vec<Vec3>, total: f64| {
        for first in [1e-3, 1e-4, 1e-5] {
            let heights = geometric(total, first, 61);
            let name = format!("{name} first={first:e}");
            all.push(Wall {
                name,
                points: points.clone(),
                heights,
                closed: true,
                constant_ends: false,
            });
        }
    };
    for (name, listing) in listings().into_iter().step_by(every) {
        add(name.clone(), closed(listing.clone()), 10.0);
        let n = listing.len();
        let nose = (0..n).fold(0, |k, j| if listing[j].x < listing[k].x { j } else { k });
        let lengths: Vec<f64> = listing.windows(2).map(|w| w[0].distance(w[1])).collect();
        let share = lengths[..nose].iter().sum::<f64>() / lengths.iter().sum::<f64>();
        for n in [81, 161, 321] {
            let points = closed(spline(&listing, &shares(n, share)));
            if !crosses_itself(&points) {
                add(format!("{name} n={n}"), points, 10.0);
            }
        }
    }
    for turning in [20.0, 45.0, 70.0, 95.0, 120.0] {
        for thickness in [0.06, 0.12, 0.2] {
            for n in [81, 161, 321] {
                let name = format!("blade {turning} {thickness} n={n}");
                // Half way to the next blade of a pitch of one chord.
                add(name, blade(n, turning, thickness, 0.012), 0.3);
            }
        }
    }
    all
}
