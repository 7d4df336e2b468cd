//! Marches in slots, coves and bulbs: no accepted grid overlaps itself, by the test's own search of all pairs.

use crate::walls::geometric;
use moldloft_grid::*;
use moldloft_num::Vec3;
use std::f64::consts::PI;

const UP: Vec3 = Vec3 { x: 0.0, y: 0.0, z: 1.0 };

/// Numbers in [0, 1) from a seed (Knuth's multiplicative congruence).
struct Draws(u64);

impl Draws {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }
}

/// A polygon as a curve with points at most `spacing` apart.
fn divided(corners: &[[f64; 2]], spacing: f64) -> Vec<Vec3> {
    let at = |[x, y]: [f64; 2]| -> Vec3 { Vec3::of(x, y, 0.0) };
    let mut points = vec![at(corners[0])];
    for pair in corners.windows(2) {
        let (a, b) = (at(pair[0]), at(pair[1]));
        let count = (a.distance(b) / spacing).ceil().max(1.0) as usize;
        points.extend((1..=count).map(|k| a.lerp(b, k as f64 / count as f64)));
    }
    points
}

/// A slot of this width and depth, or with a cavity at its foot.
fn slot(width: f64, depth: f64, cavity: Option<[f64; 2]>, lean: f64) -> Vec<[f64; 2]> {
    let w = 0.5 * width;
    let mut all = vec![[-3.0, 0.0], [-w, 0.0], [lean - w, -depth]];
    match cavity {
        None => all.push([lean + w, -depth]),
        Some([wide, deep]) => {
            let (left, right) = (lean - 0.5 * wide, lean + 0.5 * wide);
            let foot = -depth - deep;
            all.extend([
                [left, -depth],
                [left, foot],
                [right, foot],
                [right, -depth],
                [lean + w, -depth],
            ]);
        }
    }
    all.extend([[w, 0.0], [3.0, 0.0]]);
    all
}

/// A round bulb under a neck.
fn bulb(width: f64, radius: f64) -> Vec<[f64; 2]> {
    let half = (0.5 * width / radius).asin();
    let drop = 0.3 + radius * half.cos();
    let mut all = vec![[-3.0, 0.0], [-0.5 * width, 0.0]];
    for k in 0..=60 {
        let a = 0.5 * PI + half + (2.0 * PI - 2.0 * half) * f64::from(k) / 60.0;
        all.push([radius * a.cos(), radius * a.sin() - drop]);
    }
    all.extend([[0.5 * width, 0.0], [3.0, 0.0]]);
    all
}

fn crosses([a, b]: [Vec3; 2], [c, d]: [Vec3; 2]) -> bool {
    let side = |p: Vec3, q: Vec3, r: Vec3| (q - p).cross(r - p).z;
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// True if the boundary of the grid — wall, last layer, ends — crosses itself.
fn overlaps(grid: &SurfaceGrid<f64>) -> bool {
    let line = |k: usize| (1..grid.n).map(move |j| [grid.at(k, j - 1), grid.at(k, j)]);
    let end = |j: usize| (1..grid.m).map(move |k| [grid.at(k - 1, j), grid.at(k, j)]);
    let all: Vec<[Vec3; 2]> =
        line(0).chain(line(grid.m - 1)).chain(end(0)).chain(end(grid.n - 1)).collect();
    (0..all.len()).any(|a| (0..a).any(|b| crosses(all[a], all[b])))
}

#[test]
fn fronts_that_meet_are_refused_below_their_crossing() {
    let soak = std::env::var_os("MOLDLOFT_SOAK").is_some();
    let mut draws = Draws(7);
    let (mut passed, mut met, mut other, mut wrong) = (0, 0, 0, Vec::new());
    for case in 0..if soak { 1000 } else { 60 } {
        let width = draws.between(0.1, 0.6);
        let corners = match case % 4 {
            0 => slot(width, draws.between(0.5, 2.0), None, 0.0),
            1 => slot(
                width,
                draws.between(0.3, 1.0),
                Some([width + draws.between(0.3, 1.5), draws.between(0.6, 2.0)]),
                0.0,
            ),
            2 => slot(width, draws.between(0.5, 1.5), None, draws.between(-0.6, 0.6)),
            _ => bulb(width, draws.between(0.4, 1.0)),
        };
        let wall = divided(&corners, 0.02);
        let last = draws.between(0.2, 0.9) * width;
        let mut options = Hyperbolic::new(geometric(last, 2e-3, 13));
        match hyperbolic_curve(&wall, UP, &options) {
            Ok(marched) => {
                passed += 1;
                if overlaps(&marched.layers[0]) {
                    wrong.push(format!("{case}: width {width}, height {last}: overlaps"));
                }
            }
            Err(GridError::March(failure)) => {
                let meets = matches!(failure.cause, FailureCause::LayersMeet { .. });
                if meets {
                    met += 1
                } else {
                    other += 1
                }
                options.stop.keep = true;
                let kept = hyperbolic_curve(&wall, UP, &options).unwrap();
                let grid = &kept.layers[0];
                if overlaps(grid) || (meets && grid.m + 1 != failure.layer) {
                    wrong.push(format!("{case}: kept {} layers of {failure}", grid.m));
                }
                // Fronts of a neck meet in its middle.
                if meets && options.heights[failure.layer - 1] < 0.3 * width {
                    wrong.push(format!("{case}: width {width}, refused early: {failure}"));
                }
            }
            Err(error) => wrong.push(format!("{case}: {error}")),
        }
    }
    println!("{passed} passed, {met} met, {other} refused otherwise, {} wrong", wrong.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(passed > 10 && met > 10);
}

/// The neck of a cavity as a surface: its walls face each other.
#[test]
fn fronts_off_surfaces_meet_too() {
    for (width, height, fits) in [(0.5, 0.2, true), (0.5, 0.3, false)] {
        let profile = divided(&slot(width, 1.0, Some([width + 1.2, 1.5]), 0.0), 0.05);
        // s_i x s_j points out of the wall.
        let surface = SurfaceGrid::<f64>::from_fn(profile.len(), 6, |i, j| {
            profile[i] + Vec3::of(0.0, 0.0, -0.1 * j as f64)
        });
        let options = Hyperbolic::new(geometric(height, 5e-3, 11));
        match (fits, hyperbolic(&surface, &options)) {
            (true, marched) => assert!(marched.is_ok(), "{width} {height}: {marched:?}"),
            (false, Err(GridError::March(failure))) => {
                let meets = matches!(failure.cause, FailureCause::LayersMeet { .. });
                assert!(meets, "{width} {height}: {failure}");
                let reached = options.heights[failure.layer - 1];
                assert!((0.4 * width..0.65 * width).contains(&reached), "{failure}");
            }
            (false, marched) => panic!("{width} {height}: {:?}", marched.map(|m| m.report)),
        }
    }
}
