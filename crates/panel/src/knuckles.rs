//! Knuckles of a surface, as parameters.
//!
//! A knuckle is a parameter line at which the surface is continuous and its tangents across are not: the
//! joint of a poly-curve, a knot of degree 1, a crease. It is a row of the patch, on all sides alike, so
//! that no panel spans it.

use moldloft_num::period::breaks_between;
use moldloft_num::{InnerPlane, Order, Surface, Vec3, find_root};

/// Tangents that differ in direction by more than this, in radians, make a knuckle.
const TURN: f64 = 1e-5;

/// Distance before and after a break at which tangents are evaluated; a break is known to rounding
/// only, since it may have been divided among pieces.
pub(crate) const ASIDE: f64 = 1e-9;

/// Breaks nearer than this are one: those of opposite sides, each found by a search of its own.
const SAME_KNUCKLE: f64 = 4.0 * ASIDE;

/// Number of points along a break at which it is tested.
const TRIALS: usize = 5;

/// The knuckles along u and along v, ascending, between 0 and 1.
pub(crate) fn knuckles(surface: &dyn Surface<f64>) -> [Vec<f64>; 2] {
    let [mut us, mut vs] = surface.kinks();
    let along = |u| surface.line(u, &trials(), Order::First).into_iter().map(|jet| jet.u).collect();
    us.retain(|&at| turns(at, along));
    let across = |v| trials().iter().map(|&u| surface.jet(u, v, Order::First).v).collect();
    vs.retain(|&at| turns(at, across));
    [us, vs].map(|mut all| {
        all.dedup_by(|next, kept| *next - *kept <= SAME_KNUCKLE);
        all
    })
}

/// The positions along a break.
fn trials() -> [f64; TRIALS] {
    std::array::from_fn(|i| (i as f64 + 0.37) / TRIALS as f64)
}

/// True when the tangents before and after a break differ in direction somewhere along it.
fn turns(at: f64, tangents: impl Fn(f64) -> Vec<Vec3>) -> bool {
    let differ = |(a, b): (Vec3, Vec3)| {
        let size = a.norm() * b.norm();
        size > 0.0 && (a.cross(b).norm() > TURN * size || a.dot(b) < 0.0)
    };
    let inside = ASIDE < at && at < 1.0 - ASIDE;
    inside && tangents(at - ASIDE).into_iter().zip(tangents(at + ASIDE)).any(differ)
}

/// Number of steps in each direction in which a part is examined.
const STEPS: usize = 16;

/// A point (u, v) of a part at which a knuckle of the original surface crosses its panels: along
/// none of its own knuckles.
pub(crate) fn knuckle_across(surface: &dyn Surface<f64>, own: &[Vec<f64>; 2]) -> Option<[f64; 2]> {
    let planes = surface.inner_planes();
    planes.iter().find_map(|plane| across_in(surface, own, plane))
}

fn across_in(
    surface: &dyn Surface<f64>,
    own: &[Vec<f64>; 2],
    plane: &InnerPlane<'_>,
) -> Option<[f64; 2]> {
    if plane.kinks.iter().all(Vec::is_empty) && plane.closed == [false; 2] {
        return None;
    }
    let step = |k: usize| k as f64 / STEPS as f64;
    let place = |i: usize, j: usize| (plane.place)([step(i), step(j)]);
    let grid: Vec<Vec<[f64; 2]>> =
        (0..=STEPS).map(|i| (0..=STEPS).map(|j| place(i, j)).collect()).collect();
    for axis in 0..2 {
        let all = grid.iter().flatten().map(|w| w[axis]);
        let (low, high) =
            all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        for line in breaks_between(&plane.kinks[axis], plane.closed[axis], low, high) {
            for (i, j) in (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (i, j))) {
                for (along, next) in [(0, [i + 1, j]), (1, [i, j + 1])] {
                    let [a, b] = [grid[i][j], grid[next[0]][next[1]]].map(|w| w[axis] - line);
                    if (a < 0.0) == (b < 0.0) {
                        continue;
                    }
                    let at = |t: f64| if along == 0 { [t, step(j)] } else { [step(i), t] };
                    let from = [i, j][along];
                    let beyond = |t: f64| (plane.place)(at(t))[axis] - line;
                    let Ok(t) = find_root(beyond, step(from), step(from + 1)) else { continue };
                    let known = own[along].iter().any(|k| (k - t).abs() < 1e-6);
                    let tangents = |t: f64| {
                        let [u, v] = at(t);
                        let jet = surface.jet(u, v, Order::First);
                        vec![if along == 0 { jet.u } else { jet.v }]
                    };
                    if !known && turns(t, tangents) {
                        return Some(at(t));
                    }
                }
            }
        }
    }
    None
}
