//! Walls that grids are marched from: aerofoils, corners, steps, cascades, and the heights of layers.

use moldloft_num::Vec3;
use std::f64::consts::PI;

/// A curve with the layers to march off it.
pub struct Wall {
    pub name: String,
    /// Closed ones end in their first point.
    pub points: Vec<Vec3>,
    pub heights: Vec<f64>,
    pub closed: bool,
    /// C-grids end in lines of constant x.
    pub constant_ends: bool,
}

/// Heights from 0 to `total` that begin with `first`, in `n` points, each cell in one ratio to the one before.
pub fn geometric(total: f64, first: f64, n: usize) -> Vec<f64> {
    let cells = n - 1;
    let sum = |ratio: f64| (0..cells).fold(0.0, |sum, k| sum + first * ratio.powi(k as i32));
    let (mut low, mut high) = (1e-3, 100.0f64);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if sum(middle) < total { low = middle } else { high = middle }
    }
    let mut heights = vec![0.0];
    for k in 0..cells {
        heights.push(heights[k] + first * low.powi(k as i32));
    }
    heights
}

fn point(x: f64, y: f64) -> Vec3 {
    Vec3::of(x, y, 0.0)
}

fn closed(mut points: Vec<Vec3>) -> Vec<Vec3> {
    points.push(points[0]);
    points
}

/// A section of the four-digit family, clockwise from the tail below; a sharp tail ends in its first point, a blunt
/// one is open.
pub fn naca4(n: usize, camber: f64, at: f64, thickness: f64, sharp: bool) -> Vec<Vec3> {
    let last = if sharp { -0.1036 } else { -0.1015 };
    let mut points: Vec<Vec3> = (0..n)
        .map(|k| {
            let b = 2.0 * PI * k as f64 / (n - 1) as f64;
            let x = 0.5 * (1.0 + b.cos());
            let y = 5.0
                * thickness
                * (0.2969 * x.sqrt() - 0.126 * x - 0.3516 * x * x
                    + 0.2843 * x.powi(3)
                    + last * x.powi(4));
            let side = if b <= PI { -1.0 } else { 1.0 };
            let (mean, slope) = match camber {
                0.0 => (0.0, 0.0),
                c if x < at => (c / at / at * (2.0 * at * x - x * x), 2.0 * c / at / at * (at - x)),
                c => {
                    let whole = (1.0 - at) * (1.0 - at);
                    let mean = c / whole * (1.0 - 2.0 * at + 2.0 * at * x - x * x);
                    (mean, 2.0 * c / whole * (at - x))
                }
            };
            let turn = slope.atan();
            point(x - side * y * turn.sin(), mean + side * y * turn.cos())
        })
        .collect();
    if sharp {
        points[n - 1] = points[0];
    }
    points
}

/// A blunt section closed over its base with `cells` cells.
pub fn with_base(section: &[Vec3], cells: usize) -> Vec<Vec3> {
    let (a, b) = (section[section.len() - 1], section[0]);
    let mut points = section.to_vec();
    points.extend((1..=cells).map(|k| a + (b - a) * (k as f64 / cells as f64)));
    *points.last_mut().unwrap() = b;
    points
}

/// A Joukowski section with a cusp, from a circle round (-e, m) through (1, 0).
pub fn joukowski(n: usize, e: f64, m: f64) -> Vec<Vec3> {
    let (cx, cy) = (-e, m);
    let radius = ((1.0 - cx).powi(2) + cy * cy).sqrt();
    let start = (-cy).atan2(1.0 - cx);
    let points = (0..n - 1)
        .map(|k| {
            let a = start - 2.0 * PI * k as f64 / (n - 1) as f64;
            let (x, y) = (cx + radius * a.cos(), cy + radius * a.sin());
            let square = x * x + y * y;
            point((x + x / square) / 4.0 + 0.5, (y - y / square) / 4.0)
        })
        .collect();
    closed(points)
}

/// A sharp section with its wake, from the far end of the wake below.
pub fn c_curve(section: &[Vec3], wake: f64, count: usize) -> Vec<Vec3> {
    let tail = section[0];
    let first = section[1].distance(tail);
    let steps = geometric(wake, first, count);
    let line = |k: usize| tail + point(steps[k], 0.0);
    let mut points: Vec<Vec3> = (1..count).rev().map(line).collect();
    points.extend_from_slice(section);
    points.extend((1..count).map(line));
    points
}

/// Two legs of length 1 that enclose `angle` degrees on the left; points evenly, or clustered to `first`.
pub fn corner(angle: f64, n: usize, first: Option<f64>) -> Vec<Vec3> {
    let along = match first {
        Some(first) => geometric(1.0, first, n),
        None => (0..n).map(|k| k as f64 / (n - 1) as f64).collect(),
    };
    let turn = (180.0 - angle).to_radians();
    let mut points: Vec<Vec3> = along.iter().rev().map(|u| point(-u, 0.0)).collect();
    points.extend(along[1..].iter().map(|u| point(u * turn.cos(), u * turn.sin())));
    points
}

/// A section as in a listing: coordinates rounded to a number of decimals.
pub fn listed(section: &[Vec3], decimals: i32) -> Vec<Vec3> {
    let scale = 10f64.powi(decimals);
    section
        .iter()
        .map(|p| point((p.x * scale).round() / scale, (p.y * scale).round() / scale))
        .collect()
}

/// A polygon with `n` points along each side; closed ones end in their first point.
pub fn polygon(corners: &[[f64; 2]], n: usize, first: Option<f64>, is_closed: bool) -> Vec<Vec3> {
    let count = if is_closed { corners.len() } else { corners.len() - 1 };
    let mut points = Vec::new();
    for k in 0..count {
        let ([ax, ay], [bx, by]) = (corners[k], corners[(k + 1) % corners.len()]);
        let (a, b) = (point(ax, ay), point(bx, by));
        let along: Vec<f64> = match first {
            Some(first) => {
                let half = geometric(0.5, first / a.distance(b), n / 2 + 1);
                let back: Vec<f64> = half.iter().rev().skip(1).map(|u| 1.0 - u).collect();
                half.into_iter().chain(back).collect()
            }
            None => (0..n).map(|k| k as f64 / (n - 1) as f64).collect(),
        };
        points.extend(along[..along.len() - 1].iter().map(|u| a + (b - a) * *u));
    }
    if is_closed {
        return closed(points);
    }
    let [x, y] = corners[corners.len() - 1];
    points.push(point(x, y));
    points
}

/// A round curve r(angle), clockwise.
pub fn round(n: usize, f: impl Fn(f64) -> [f64; 2]) -> Vec<Vec3> {
    let each = (0..n).map(|k| {
        let [x, y] = f(-2.0 * PI * k as f64 / n as f64);
        point(x, y)
    });
    closed(each.collect())
}

/// Two hundred walls and more, each for three first cells and three counts of points.
pub fn walls() -> Vec<Wall> {
    let mut all = Vec::new();
    let mut add = |name: String, points: Vec<Vec3>, heights: Vec<f64>, is_closed: bool, c: bool| {
        all.push(Wall { name, points, heights, closed: is_closed, constant_ends: c });
    };
    let cells = [1e-3, 1e-4, 1e-5];
    for n in [81, 161, 321] {
        for first in cells {
            let far = || geometric(20.0, first, 81);
            let label = |s: &str| format!("{s} n={n} first={first:e}");
            for (m, p, t) in sections() {
                let name = format!("NACA {:.0}{:.0}{:02.0}", m * 100.0, p * 10.0, t * 100.0);
                add(label(&name), naca4(n, m, p, t, true), far(), true, false);
            }
            for (m, p, t) in [(0.0, 0.4, 0.12), (0.04, 0.4, 0.24), (0.02, 0.4, 0.15)] {
                let blunt = naca4(n, m, p, t, false);
                add(label("blunt 1"), with_base(&blunt, 1), far(), true, false);
                add(label("blunt 4"), with_base(&blunt, 4), far(), true, false);
            }
            for (m, p, t) in [(0.0, 0.4, 0.12), (0.02, 0.4, 0.15), (0.04, 0.3, 0.09)] {
                // Listings of five decimals have about this many points.
                if n < 161 {
                    let listing = walls_listing(n, m, p, t);
                    add(label("listing"), listing, far(), true, false);
                }
            }
            for (e, m) in [(0.1, 0.0), (0.1, 0.15), (0.05, 0.05), (0.2, 0.1)] {
                add(label(&format!("Joukowski {e} {m}")), joukowski(n, e, m), far(), true, false);
            }
            for (m, p, t) in sections() {
                let name = format!("C {:.0}{:.0}{:02.0}", m * 100.0, p * 10.0, t * 100.0);
                let curve = c_curve(&naca4(n, m, p, t, true), 10.0, 41);
                add(label(&name), curve, geometric(10.0, first, 81), false, true);
            }
        }
    }
    for n in [11, 21, 41] {
        for first in [1e-2, 1e-3, 1e-4] {
            let label = |s: &str| format!("{s} n={n} first={first:e}");
            let mut open = |name: &str, points: Vec<Vec3>, total: f64, layers: usize| {
                add(label(name), points, geometric(total, first, layers), false, false);
            };
            for angle in [160, 135, 120, 90, 60, 45, 200, 225, 240, 270, 300, 315, 330] {
                let angle = f64::from(angle);
                open(&format!("corner {angle}"), corner(angle, n, None), 0.8, 31);
                open(&format!("clustered {angle}"), corner(angle, n, Some(0.01)), 0.8, 31);
            }
            let steps: [(&str, &[[f64; 2]], f64); 5] = [
                ("step up", &[[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [2.0, 0.5]], 2.0),
                ("step down", &[[0.0, 0.5], [1.0, 0.5], [1.0, 0.0], [2.0, 0.0]], 2.0),
                ("ramp 45", &[[0.0, 0.0], [1.0, 0.0], [2.0, 1.0], [3.0, 1.0]], 2.0),
                ("ramp 30", &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.577], [3.0, 0.577]], 2.0),
                (
                    "cavity",
                    &[[0.0, 0.0], [1.0, 0.0], [1.0, -0.5], [2.0, -0.5], [2.0, 0.0], [3.0, 0.0]],
                    1.5,
                ),
            ];
            for (name, corners, total) in steps {
                open(name, polygon(corners, n, None, false), total, 51);
            }
            let mut ring = |name: &str, points: Vec<Vec3>, total: f64| {
                add(label(name), points, geometric(total, first, 51), true, false);
            };
            let square = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
            ring("square", polygon(&square, n, None, true), 5.0);
            ring("square clustered", polygon(&square, n, Some(0.005), true), 5.0);
            ring("triangle", polygon(&[[0.0, 0.0], [0.5, 0.866], [1.0, 0.0]], n, None, true), 5.0);
            let plus = [
                [1.0, 0.0],
                [1.0, 1.0],
                [0.0, 1.0],
                [0.0, 2.0],
                [1.0, 2.0],
                [1.0, 3.0],
                [2.0, 3.0],
                [2.0, 2.0],
                [3.0, 2.0],
                [3.0, 1.0],
                [2.0, 1.0],
                [2.0, 0.0],
            ];
            ring("cross", polygon(&plus, n / 2 + 1, None, true), 6.0);
        }
    }
    for n in [81, 121, 161] {
        for first in cells {
            let label = |s: &str| format!("{s} n={n} first={first:e}");
            let mut ring = |name: &str, points: Vec<Vec3>, total: f64| {
                add(label(name), points, geometric(total, first, 51), true, false);
            };
            ring("circle", round(n, |a| [a.cos(), a.sin()]), 5.0);
            ring("ellipse .1", round(n, |a| [a.cos(), 0.1 * a.sin()]), 5.0);
            ring("ellipse .5", round(n, |a| [a.cos(), 0.5 * a.sin()]), 5.0);
            for (k, amplitude) in [(5.0, 0.3), (8.0, 0.2), (3.0, 0.3)] {
                let gear = round(n, |a| {
                    let r = 1.0 + amplitude * (k * a).cos();
                    [r * a.cos(), r * a.sin()]
                });
                ring(&format!("gear {k}"), gear, 5.0);
            }
            for amplitude in [0.05, 0.1, 0.25] {
                let wave = (0..n).map(|k| {
                    let x = 2.0 * k as f64 / (n - 1) as f64;
                    point(x, amplitude * (2.0 * PI * x).sin())
                });
                let name = label(&format!("wave {amplitude}"));
                add(name, wave.collect(), geometric(2.0, first, 51), false, false);
            }
        }
    }
    all
}

fn walls_listing(n: usize, m: f64, p: f64, t: f64) -> Vec<Vec3> {
    listed(&naca4(n, m, p, t, true), 5)
}

/// Camber, its position, and thickness.
fn sections() -> Vec<(f64, f64, f64)> {
    let mut all = Vec::new();
    for t in [0.06, 0.08, 0.09, 0.10, 0.12, 0.15, 0.18, 0.21, 0.24] {
        all.push((0.0, 0.4, t));
    }
    for m in [0.01, 0.02, 0.04, 0.06] {
        for p in [0.2, 0.3, 0.4, 0.6] {
            for t in [0.06, 0.09, 0.12, 0.18] {
                all.push((m, p, t));
            }
        }
    }
    all
}
