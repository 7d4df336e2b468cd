//! Places at which a surface turns over itself: its normal vanishes and continues in the opposite
//! direction, so that areas and volumes count the fold more than once.
//!
//! The normals of a smooth cell are compared between neighbouring samples. Between two that are
//! more than a right angle apart, halving finds the place; a tight bend has normals of usual size
//! there, a fold has none.

use crate::bernstein::place_and_tangent;
use crate::cell::PolynomialCell;
use moldloft_num::{Real, Vec3};

/// Samples of a surface in each direction, shared by its cells, and the least of a cell.
const SAMPLES: f64 = 24.0;
const LEAST_SAMPLES: usize = 6;

/// Size of a normal, relative to the largest of the cell, below which its direction is rounding.
const NO_NORMAL: f64 = 1e-6;

/// Halvings between two samples.
const HALVINGS: usize = 20;

/// Size of the normals after the halvings, relative to the largest of the cell, and cosine of the
/// angle between them, up to which the place is a fold.
const SMALL: f64 = 1e-3;
const OPPOSITE: f64 = -0.9;

/// A place at which the surface of these cells turns over itself.
pub(crate) fn fold<T: Real>(cells: &[PolynomialCell<T>]) -> Option<Vec3> {
    let count = (SAMPLES / (cells.len() as f64).sqrt()).ceil() as usize;
    cells.iter().find_map(|cell| fold_in(&cell.re(), count.max(LEAST_SAMPLES)))
}

/// The point of a cell and its normal, not of unit length.
fn normal(cell: &PolynomialCell<f64>, [u, v]: [f64; 2]) -> (Vec3, Vec3) {
    let (mut at, mut by) = (Vec::new(), Vec::new());
    cell.line(0, v, &mut at, &mut by);
    let (p, along) = place_and_tangent(&at, u);
    (p, along.cross(place_and_tangent(&by, u).0))
}

fn fold_in(cell: &PolynomialCell<f64>, count: usize) -> Option<Vec3> {
    // Denser at the edges, which are included: rulings cross there first.
    let angle = |k: usize| std::f64::consts::FRAC_PI_2 * k as f64 / (count - 1) as f64;
    let steps: Vec<f64> = (0..count).map(|k| libm::pow(libm::sin(angle(k)), 2.0)).collect();
    let mut normals = Vec::with_capacity(count * count);
    let (mut at, mut by) = (Vec::new(), Vec::new());
    for &v in &steps {
        cell.line(0, v, &mut at, &mut by);
        for &u in &steps {
            let along = place_and_tangent(&at, u).1;
            normals.push(along.cross(place_and_tangent(&by, u).0));
        }
    }
    let most = normals.iter().map(|n| n.norm()).fold(0.0, f64::max);
    let opposite = |a: Vec3, b: Vec3| a.dot(b) < 0.0 && a.norm().min(b.norm()) > NO_NORMAL * most;
    for j in 0..count {
        for i in 0..count {
            let place = |i: usize, j: usize| ([steps[i], steps[j]], normals[j * count + i]);
            let next = [(i + 1, j), (i, j + 1)].into_iter().filter(|&(i, j)| i.max(j) < count);
            for (k, l) in next {
                let (one, other) = (place(i, j), place(k, l));
                if !opposite(one.1, other.1) {
                    continue;
                }
                let found = halved(cell, [one, other], most);
                if found.is_some() {
                    return found;
                }
            }
        }
    }
    None
}

/// The fold between two places with opposite normals; `None` for a bend.
fn halved(
    cell: &PolynomialCell<f64>,
    [mut low, mut high]: [([f64; 2], Vec3); 2],
    most: f64,
) -> Option<Vec3> {
    for _ in 0..HALVINGS {
        let middle = [0, 1].map(|k| 0.5 * (low.0[k] + high.0[k]));
        let (_, n) = normal(cell, middle);
        if n.dot(low.1) < 0.0 {
            high = (middle, n);
        } else if n.dot(high.1) < 0.0 {
            low = (middle, n);
        } else {
            return None;
        }
    }
    let sizes = [low.1.norm(), high.1.norm()];
    let turn = low.1.dot(high.1) / (sizes[0] * sizes[1]);
    (turn < OPPOSITE && sizes[0].max(sizes[1]) <= SMALL * most).then(|| normal(cell, low.0).0)
}
