//! The solid before its dimensions: a least-squares guess of all planes from the picture.
//!
//! Unknown are the plane positions (one per plane; the reference point's are zero) and where the
//! origin was drawn; every point gives two equations, as its projection should be where it was
//! drawn. The equations are linear, so the solution is immediate, and the rank that is missing is
//! the exact number of depths that the picture leaves open; each of these has its likeliest value.

use crate::drawing::open_depths::OpenDepths;
use crate::drawing::planes::Planes;
use crate::{Align, CoordinateAxis, Drawing, PointId};
use moldloft_num::Vec3;

/// Maximum number of planes for an estimate (the work grows with the cube).
pub const MAX_PLANES: usize = 1500;

/// A depth that the picture does not determine: planes that can move together without changing it.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeDepth {
    /// The planes with their relative motion.
    pub planes: Vec<(CoordinateAxis, usize, f64)>,
    /// The points on these planes.
    pub points: Vec<PointId>,
    /// Planes of the part that coincide with planes of the rest at the likeliest depth.
    pub aligns: Vec<Align>,
}

/// Estimated plane positions, in units of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    coordinates: [Vec<f64>; 3],
    /// The undetermined depths; their number is the rank deficiency.
    pub depths: Vec<FreeDepth>,
}

impl Estimate {
    /// Solves for the planes; `reference` is the point whose planes are at zero. `None` for an empty
    /// drawing or one of more than [`MAX_PLANES`] planes.
    pub fn of(drawing: &Drawing, planes: &Planes, reference: PointId) -> Option<Estimate> {
        let counts = planes.counts();
        if drawing.points.is_empty() || counts.iter().sum::<usize>() > MAX_PLANES {
            return None;
        }
        // Columns: planes other than the reference's, then where the origin was drawn.
        let zero = CoordinateAxis::ALL.map(|a| planes.plane(a, reference));
        let mut column = [const { Vec::new() }; 3];
        let mut owner = Vec::new();
        for axis in CoordinateAxis::ALL {
            let k = axis.index();
            for plane in 0..counts[k] {
                let free = zero[k] != Some(plane);
                column[k].push(free.then_some(owner.len()));
                if free {
                    owner.push((axis, plane));
                }
            }
        }
        let n = owner.len() + 2;
        let mut matrix = vec![0.0; n * n];
        let mut right = vec![0.0; n];
        for (k, id) in planes.ids().iter().enumerate() {
            let drawn = drawing.points[id];
            for (screen, at) in [drawn.u, drawn.v].into_iter().enumerate() {
                let mut row: [(usize, f64); 4] = [(n - 2 + screen, 1.0); 4];
                let mut used = 1;
                for axis in CoordinateAxis::ALL {
                    let plane = planes.classes(axis)[k] as usize;
                    if let Some(c) = column[axis.index()][plane] {
                        row[used] = (c, drawing.projection.unit(axis)[screen]);
                        used += 1;
                    }
                }
                for &(i, a) in &row[..used] {
                    right[i] += a * at;
                    for &(j, b) in &row[..used] {
                        matrix[i * n + j] += a * b;
                    }
                }
            }
        }
        let Factors { solution, null } = Factors::of(matrix, right);
        let mut coordinates = counts.map(|c| vec![0.0; c]);
        for (c, &(axis, plane)) in owner.iter().enumerate() {
            coordinates[axis.index()][plane] = solution[c];
        }
        let motions: Vec<[Vec<f64>; 3]> = (null.iter())
            .map(|z| column.each_ref().map(|c| c.iter().map(|c| c.map_or(0.0, |c| z[c])).collect()))
            .collect();
        let mut open = OpenDepths { drawing, planes, coordinates, motions };
        let aligns = open.settle();
        let coordinates = open.coordinates;
        let depths = null.into_iter().zip(aligns).map(|(z, aligns)| {
            let moving: Vec<(CoordinateAxis, usize, f64)> = (owner.iter().zip(&z))
                .filter(|(_, m)| m.abs() > 1e-7)
                .map(|(&(axis, plane), &m)| (axis, plane, m))
                .collect();
            let mut points: Vec<PointId> =
                moving.iter().flat_map(|&(axis, plane, _)| planes.members(axis, plane)).collect();
            points.sort_unstable();
            points.dedup();
            FreeDepth { planes: moving, points, aligns }
        });
        Some(Estimate { coordinates, depths: depths.collect() })
    }

    /// The estimated position of a plane.
    pub fn plane(&self, axis: CoordinateAxis, plane: usize) -> f64 {
        self.coordinates[axis.index()].get(plane).copied().unwrap_or(0.0)
    }

    /// The estimated distance along an axis from a point to another; `None` of unknown points.
    pub(crate) fn gap(
        &self,
        planes: &Planes,
        axis: CoordinateAxis,
        [p, q]: [PointId; 2],
    ) -> Option<f64> {
        let at = |p| Some(self.plane(axis, planes.plane(axis, p)?));
        Some(at(q)? - at(p)?)
    }

    /// True if the picture determines the distance between two planes of an axis: no open depth
    /// changes it.
    pub fn determines(&self, axis: CoordinateAxis, a: usize, b: usize) -> bool {
        let motion = |depth: &FreeDepth, plane: usize| {
            let own = depth.planes.iter().find(|m| m.0 == axis && m.1 == plane);
            own.map_or(0.0, |m| m.2)
        };
        self.depths.iter().all(|d| (motion(d, a) - motion(d, b)).abs() <= 1e-7)
    }

    /// The estimated position of a point.
    pub fn point(&self, planes: &Planes, point: PointId) -> Vec3 {
        let at = |axis| planes.plane(axis, point).map_or(0.0, |p| self.plane(axis, p));
        Vec3::new(at(CoordinateAxis::X), at(CoordinateAxis::Y), at(CoordinateAxis::Z))
    }

    /// The greatest distance between estimated planes of an axis.
    pub fn extent(&self) -> f64 {
        let spread = |c: &Vec<f64>| {
            let low = c.iter().copied().fold(f64::INFINITY, f64::min);
            let high = c.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            (high - low).max(0.0)
        };
        self.coordinates.iter().map(spread).fold(0.0, f64::max)
    }
}

/// The least-norm solution of a positive semidefinite system and a basis of its null space.
struct Factors {
    solution: Vec<f64>,
    null: Vec<Vec<f64>>,
}

impl Factors {
    /// L D Lᵀ with diagonal pivoting. The matrix depends on line types and axis angles only, never on
    /// how exactly points were drawn, so the rank is that of the problem.
    fn of(mut a: Vec<f64>, mut b: Vec<f64>) -> Factors {
        const RANK: f64 = 1e-10;
        let n = b.len();
        let mut order: Vec<usize> = (0..n).collect();
        let largest = (0..n).map(|k| a[k * n + k]).fold(0.0, f64::max);
        let mut rank = 0;
        while rank < n {
            let k = rank;
            let pivot = (k..n).fold(k, |m, r| if a[r * n + r] > a[m * n + m] { r } else { m });
            if a[pivot * n + pivot] <= RANK * largest {
                break;
            }
            if pivot != k {
                for c in 0..n {
                    a.swap(k * n + c, pivot * n + c);
                }
                for r in 0..n {
                    a.swap(r * n + k, r * n + pivot);
                }
                b.swap(k, pivot);
                order.swap(k, pivot);
            }
            let d = a[k * n + k];
            let (upper, lower) = a.split_at_mut((k + 1) * n);
            let row = &upper[k * n..];
            for (r, below) in lower.chunks_exact_mut(n).enumerate() {
                let factor = row[k + 1 + r] / d;
                if factor != 0.0 {
                    for c in k + 1..n {
                        below[c] -= factor * row[c];
                    }
                    b[k + 1 + r] -= factor * b[k];
                }
            }
            rank += 1;
        }
        // Back substitution on the upper triangle; free unknowns are given.
        let back = |mut x: Vec<f64>, b: &dyn Fn(usize) -> f64| {
            for k in (0..rank).rev() {
                let mut sum = b(k);
                for c in k + 1..n {
                    sum -= a[k * n + c] * x[c];
                }
                x[k] = sum / a[k * n + k];
            }
            x
        };
        let particular = back(vec![0.0; n], &|k| b[k]);
        let mut null: Vec<Vec<f64>> = (rank..n)
            .map(|f| {
                let mut x = vec![0.0; n];
                x[f] = 1.0;
                back(x, &|_| 0.0)
            })
            .collect();
        let unsort = |x: Vec<f64>| {
            let mut y = vec![0.0; n];
            for (k, v) in order.iter().zip(x) {
                y[*k] = v;
            }
            y
        };
        let mut solution = unsort(particular);
        null = null.into_iter().map(unsort).collect();
        remove_components(&mut solution, &null);
        Factors { solution, null }
    }
}

/// Subtracts from `x` its projection onto the span of `basis`, by Gram-Schmidt.
fn remove_components(x: &mut [f64], basis: &[Vec<f64>]) {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(p, q)| p * q).sum::<f64>();
    let mut square: Vec<Vec<f64>> = Vec::new();
    for vector in basis {
        let mut v = vector.clone();
        for s in &square {
            let part = dot(&v, s);
            v.iter_mut().zip(s).for_each(|(a, b)| *a -= part * b);
        }
        let length = moldloft_num::Real::sqrt(dot(&v, &v));
        if length > 0.0 {
            v.iter_mut().for_each(|a| *a /= length);
            let part = dot(x, &v);
            x.iter_mut().zip(&v).for_each(|(a, b)| *a -= part * b);
            square.push(v);
        }
    }
}
