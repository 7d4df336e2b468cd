//! Elliptic smoothing of volume grids, with cells and angles at walls.
//!
//! Solves sum over l, m of g^lm r_lm + sum over l of g^ll p_l r_l = 0 (Thompson, Warsi and Mastin 1985) line by line, in
//! four colours. Holds: faces stay to the bit; the same bits at any number of threads.

use crate::{GridError, GridFace, VolumeGrid};
use moldloft_budget::Budget;
use moldloft_num::{Real, Vec3};
use moldloft_parallel::prelude::*;

/// A face at which the grid shall have a first cell, at right angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceWall<T> {
    /// The face.
    pub face: GridFace,
    /// The first cell.
    pub spacing: T,
}

/// Options of elliptic smoothing of a volume grid.
#[derive(Clone, Debug, PartialEq)]
pub struct EllipticVolume<T> {
    /// True to carry the spacing of the edges inward (Thomas and Middlecoff 1980); otherwise lines
    /// become uniform.
    pub keep_spacing: bool,
    /// Maximum number of sweeps.
    pub sweeps: usize,
    /// Converged if no point moves by more than this, relative to the size, and the walls are as
    /// specified.
    pub tolerance: f64,
    /// Over-relaxation, between 0 and 2.
    pub omega: f64,
    /// Walls (the iteration of Hilgenstock 1988).
    pub walls: Vec<FaceWall<T>>,
}

/// Deviations of a wall from its specification.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceWallReport {
    /// The face.
    pub face: GridFace,
    /// Smallest and largest first cell height, relative to the given one.
    pub cells: [f64; 2],
    /// The largest deviation from a right angle, in radians.
    pub angle: f64,
}

/// A smoothed volume grid.
#[derive(Clone, Debug, PartialEq)]
pub struct SmoothedVolume<T> {
    /// The grid.
    pub grid: VolumeGrid<T>,
    /// The sweeps that were done.
    pub sweeps: usize,
    /// Largest step of each sweep, relative to the size.
    pub history: Vec<f64>,
    /// Deviations of the walls from their specification.
    pub walls: Vec<FaceWallReport>,
    /// The least scaled Jacobian.
    pub jacobian: f64,
    /// True if the points have converged and the walls are as specified.
    pub converged: bool,
}

/// Fraction of an error that is added to a control in one sweep, and decay of controls per cell
/// from the wall.
const SHARE: f64 = 0.2;
const FADE: f64 = 0.3;

/// Walls count as met when cells, relatively, and angles, in radians, are off by no more.
const WALL_ACCURACY: f64 = 1e-6;

/// The grid with its inner points moved towards a solution; its faces stay. Ends when `budget` is spent.
///
/// # Errors
/// [`GridError::TooFew`] with fewer than 3 points along an index; [`GridError::PointNotFinite`];
/// [`GridError::Diverged`]; [`GridError::Spent`].
pub fn elliptic_volume_until<T: Real>(
    grid: &VolumeGrid<T>,
    options: &EllipticVolume<T>,
    budget: &Budget,
) -> Result<SmoothedVolume<T>, GridError> {
    let least = grid.size.into_iter().min().unwrap_or(0);
    if least < 3 {
        return Err(GridError::TooFew { expected: 3, actual: [least, least] });
    }
    grid.check_finite()?;
    let size = grid.extent();
    // Lines run away from the walls.
    let axis = options.walls.first().map_or(2, |wall| wall.face.axis);
    let base = options.keep_spacing.then(|| edge_controls(grid));
    let mut terms: Vec<Vec<[T; 3]>> = options
        .walls
        .iter()
        .map(|wall| {
            let [a, b] = wall.face.others();
            vec![[T::zero(); 3]; grid.size[a] * grid.size[b]]
        })
        .collect();
    let mut grid = grid.clone();
    let mut history = Vec::new();
    let mut converged = false;
    while history.len() < options.sweeps && !converged {
        let mut met = true;
        for (wall, terms) in options.walls.iter().zip(&mut terms) {
            let report = wall_step(&grid, wall, Some(terms));
            met &= off(&report) <= WALL_ACCURACY;
        }
        let control =
            |at: [usize; 3]| controls(&grid.size, base.as_ref(), &options.walls, &terms, at);
        let planes: Vec<[T; 3]> = {
            let [ni, nj, nk] = grid.size;
            (0..ni * nj * nk)
                .into_par_iter()
                .map(|p| control([p / (nj * nk), p / nk % nj, p % nk]))
                .collect()
        };
        let mut most = 0.0f64;
        for colour in 0..4 {
            budget.poll()?;
            let step = pass(&mut grid, axis, colour, options.omega, &planes, budget);
            most = if step <= most { most } else { step };
        }
        budget.poll()?;
        if !most.is_finite() {
            return Err(GridError::Diverged { step: history.len() + 1 });
        }
        let change = most / size;
        history.push(change);
        converged = change <= options.tolerance && met;
    }
    let walls = options.walls.iter().map(|wall| wall_step(&grid, wall, None)).collect();
    let jacobian = grid.cell_quality().iter().map(|q| q[0]).fold(f64::INFINITY, f64::min);
    Ok(SmoothedVolume { sweeps: history.len(), grid, history, walls, jacobian, converged })
}

fn off(report: &FaceWallReport) -> f64 {
    (report.cells[1] - 1.0).max(1.0 - report.cells[0]).max(report.angle)
}

/// -r' . r'' / |r'|^2 along the four edges of each direction: `edges[axis][corner][k]`.
type EdgeControls<T> = [[Vec<T>; 4]; 3];

fn edge_controls<T: Real>(grid: &VolumeGrid<T>) -> EdgeControls<T> {
    [0, 1, 2].map(|axis| {
        let [a, b] = GridFace { axis, last: false }.others();
        std::array::from_fn(|corner| {
            let mut at = [0; 3];
            at[a] = corner / 2 * (grid.size[a] - 1);
            at[b] = corner % 2 * (grid.size[b] - 1);
            let mut point = |k: usize| {
                at[axis] = k;
                grid.at(at[0], at[1], at[2])
            };
            let n = grid.size[axis];
            let mut all = vec![T::zero(); n];
            for k in 1..n - 1 {
                let (last, here, next) = (point(k - 1), point(k), point(k + 1));
                let first = (next - last) * T::from(0.5);
                let square = first.norm_sq();
                if square.re() > 0.0 {
                    all[k] = -(first.dot(next + last - here * T::from(2.0)) / square);
                }
            }
            all
        })
    })
}

/// The controls at a point: of the edges, blended by index, and of the walls, fading.
fn controls<T: Real>(
    size: &[usize; 3],
    base: Option<&EdgeControls<T>>,
    walls: &[FaceWall<T>],
    terms: &[Vec<[T; 3]>],
    at: [usize; 3],
) -> [T; 3] {
    let mut p = [T::zero(); 3];
    if let Some(base) = base {
        for axis in 0..3 {
            let [a, b] = GridFace { axis, last: false }.others();
            let share = |axis: usize| at[axis] as f64 / (size[axis] - 1) as f64;
            let (u, v) = (share(a), share(b));
            let weights = [(1.0 - u) * (1.0 - v), (1.0 - u) * v, u * (1.0 - v), u * v];
            for (edge, weight) in base[axis].iter().zip(weights) {
                p[axis] += edge[at[axis]] * weight;
            }
        }
    }
    for (wall, terms) in walls.iter().zip(terms) {
        let GridFace { axis, last } = wall.face;
        let [a, b] = wall.face.others();
        let depth = if last { size[axis] - 1 - at[axis] } else { at[axis] };
        let fade = libm::exp(-FADE * depth as f64);
        let [away, first, second] = terms[at[a] * size[b] + at[b]];
        // Depth counts backwards from the far face: the sense of its control turns.
        p[axis] += away * if last { -fade } else { fade };
        p[a] += first * fade;
        p[b] += second * fade;
    }
    p
}

/// Deviations of a wall, and with `terms` one step of its controls.
fn wall_step<T: Real>(
    grid: &VolumeGrid<T>,
    wall: &FaceWall<T>,
    mut terms: Option<&mut Vec<[T; 3]>>,
) -> FaceWallReport {
    let GridFace { axis, last } = wall.face;
    let [a, b] = wall.face.others();
    let (na, nb) = (grid.size[a], grid.size[b]);
    let depth = |d: usize| if last { grid.size[axis] - 1 - d } else { d };
    let point = |p: usize, q: usize, d: usize| {
        let mut at = [depth(d); 3];
        (at[a], at[b]) = (p, q);
        grid.at(at[0], at[1], at[2])
    };
    let mut report = FaceWallReport { face: wall.face, cells: [f64::INFINITY, 0.0], angle: 0.0 };
    for p in 1..na - 1 {
        for q in 1..nb - 1 {
            let inward = point(p, q, 1) - point(p, q, 0);
            let square = inward.norm_sq();
            if !(square.re() > 0.0) {
                continue;
            }
            let length = square.sqrt();
            let share = length.re() / wall.spacing.re();
            report.cells = [report.cells[0].min(share), report.cells[1].max(share)];
            let tangents =
                [point(p + 1, q, 0) - point(p - 1, q, 0), point(p, q + 1, 0) - point(p, q - 1, 0)];
            let leans = tangents.map(|t| {
                let across = t.cross(inward).norm_sq();
                if !(across.re() > 0.0) {
                    return T::zero();
                }
                across.sqrt().atan2(t.dot(inward)) - std::f64::consts::FRAC_PI_2
            });
            for lean in leans {
                report.angle = report.angle.max(lean.re().abs());
            }
            if let Some(terms) = &mut terms {
                let term = &mut terms[p * nb + q];
                term[0] += ((wall.spacing - length) / wall.spacing).atan() * SHARE;
                for (term, lean) in term[1..].iter_mut().zip(leans) {
                    *term += (lean * std::f64::consts::FRAC_2_PI).atan() * SHARE;
                }
            }
        }
    }
    report
}

/// Solves the lines of one colour along an axis; the greatest step.
fn pass<T: Real>(
    grid: &mut VolumeGrid<T>,
    axis: usize,
    colour: usize,
    omega: f64,
    controls: &[[T; 3]],
    budget: &Budget,
) -> f64 {
    let [a, b] = GridFace { axis, last: false }.others();
    let (na, nb, n) = (grid.size[a], grid.size[b], grid.size[axis]);
    let lines: Vec<(usize, usize)> = (1..na - 1)
        .flat_map(|p| (1..nb - 1).map(move |q| (p, q)))
        .filter(|(p, q)| p % 2 + q % 2 * 2 == colour)
        .collect();
    let now = &*grid;
    let solve = |&(p, q): &(usize, usize)| -> Vec<Vec3<T>> {
        if budget.is_spent() {
            return Vec::new();
        }
        let at = |p: usize, q: usize, k: usize| {
            let mut at = [k; 3];
            (at[a], at[b]) = (p, q);
            at
        };
        let point = |p: usize, q: usize, k: usize| {
            let [i, j, l] = at(p, q, k);
            now.at(i, j, l)
        };
        let half = T::from(0.5);
        let mut upper = vec![T::zero(); n];
        let mut x = vec![Vec3::zero(); n];
        x[0] = point(p, q, 0);
        for k in 1..n - 1 {
            let sides = [
                [point(p + 1, q, k), point(p - 1, q, k)],
                [point(p, q + 1, k), point(p, q - 1, k)],
                [point(p, q, k + 1), point(p, q, k - 1)],
            ];
            let r = sides.map(|[next, last]| (next - last) * half);
            let g = |l: usize, m: usize| r[l].dot(r[m]);
            let (g12, g13, g23) = (g(0, 1), g(0, 2), g(1, 2));
            let (g11, g22, g33) = (g(0, 0), g(1, 1), g(2, 2));
            let whole = [g22 * g33 - g23 * g23, g11 * g33 - g13 * g13, g11 * g22 - g12 * g12];
            let mixed = [g13 * g23 - g12 * g33, g12 * g23 - g13 * g22, g12 * g13 - g23 * g11];
            let [i, j, l] = at(p, q, k);
            let control = controls[(i * now.size[1] + j) * now.size[2] + l];
            let control = [control[a], control[b], control[axis]];
            // Upwind where central differences would lose their dominance.
            let pair = |d: usize| {
                let c = control[d];
                if c.re().abs() <= 2.0 {
                    [whole[d] * (T::one() + c * half), whole[d] * (T::one() - c * half)]
                } else {
                    [
                        whole[d] * (T::one() + c.max(T::zero())),
                        whole[d] * (T::one() + (-c).max(T::zero())),
                    ]
                }
            };
            let [[e, w], [u, d], [high, low]] = [pair(0), pair(1), pair(2)];
            let diagonal = |pp: Vec3<T>, mp: Vec3<T>, pm: Vec3<T>, mm: Vec3<T>| {
                (pp - mp - pm + mm) * T::from(0.25)
            };
            let r12 = diagonal(
                point(p + 1, q + 1, k),
                point(p - 1, q + 1, k),
                point(p + 1, q - 1, k),
                point(p - 1, q - 1, k),
            );
            let r13 = diagonal(
                point(p + 1, q, k + 1),
                point(p - 1, q, k + 1),
                point(p + 1, q, k - 1),
                point(p - 1, q, k - 1),
            );
            let r23 = diagonal(
                point(p, q + 1, k + 1),
                point(p, q - 1, k + 1),
                point(p, q + 1, k - 1),
                point(p, q - 1, k - 1),
            );
            let right = sides[0][0] * e
                + sides[0][1] * w
                + sides[1][0] * u
                + sides[1][1] * d
                + (r12 * mixed[0] + r13 * mixed[1] + r23 * mixed[2]) * T::from(2.0);
            let middle = e + w + u + d + high + low - low * upper[k - 1];
            if middle.re() == 0.0 {
                x[k] = point(p, q, k);
                continue;
            }
            upper[k] = high / middle;
            x[k] = (right + x[k - 1] * low) / middle;
        }
        x[n - 1] = point(p, q, n - 1);
        for k in (1..n - 1).rev() {
            let next = x[k + 1];
            x[k] += next * upper[k];
        }
        (1..n - 1)
            .map(|k| {
                let here = point(p, q, k);
                here + (x[k] - here) * T::from(omega)
            })
            .collect()
    };
    let solved: Vec<Vec<Vec3<T>>> = lines.par_iter().map(solve).collect();
    let mut most = 0.0f64;
    for ((p, q), line) in lines.into_iter().zip(solved) {
        for (k, new) in line.into_iter().enumerate() {
            let mut at = [k + 1; 3];
            (at[a], at[b]) = (p, q);
            let [i, j, l] = at;
            let step = new.re().distance(grid.at(i, j, l).re());
            most = if step <= most { most } else { step };
            grid.set(i, j, l, new);
        }
    }
    most
}
