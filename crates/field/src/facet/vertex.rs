//! Placement of the vertex of a piece of surface: on all the primitives of the piece, and in the
//! cell.

use crate::expr::algebra::ValueGradient;
use crate::expr::tape::ExprTape;
use crate::set::Leaf;
use moldloft_num::{Box3, Vec3};
use smallvec::SmallVec;
use std::sync::Arc;

/// Numbers of the leaves of a vertex, ascending.
pub(crate) type Surfaces = SmallVec<[u32; 3]>;

/// Reusable memory.
#[derive(Default)]
pub(crate) struct Solver {
    values: Vec<ValueGradient<f64>>,
    plain: Vec<f64>,
}

/// The outcome of a search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedVertex {
    pub(crate) point: Vec3,
    /// Largest distance |f| / |f'| from its surfaces.
    pub(crate) residual: f64,
    /// True if it is outside its cell.
    pub(crate) strayed: bool,
}

/// Maximum number of steps of a search. At a contact, a double root, every step halves the
/// distance, so that 30 of them gain 1e-9 of it and 1e-18 in the function.
const STEPS: usize = 30;

impl Solver {
    /// The value and gradient of a leaf.
    pub(crate) fn gradient(&mut self, tape: &ExprTape<f64>, p: Vec3) -> ValueGradient<f64> {
        tape.eval::<ValueGradient<f64>>(&p, &mut self.values)
    }

    /// The value of a leaf.
    pub(crate) fn value(&mut self, tape: &ExprTape<f64>, p: Vec3) -> f64 {
        tape.eval::<f64>(&p, &mut self.plain)
    }

    /// A point of `cell` on all `surfaces`, searched from `start` by steps of least norm
    /// (Gauss-Newton). `goal` is the distance from the surfaces that is good enough.
    pub(crate) fn place(
        &mut self,
        leaves: &[Leaf],
        surfaces: &[u32],
        start: Vec3,
        cell: &Box3,
        goal: f64,
    ) -> PlacedVertex {
        let tapes: SmallVec<[&Arc<ExprTape<f64>>; 3]> =
            surfaces.iter().map(|&s| leaves[s as usize].primitive.tape()).collect();
        let first = self.search(&tapes, start, cell, goal, false);
        if first.residual <= goal {
            return first;
        }
        // At the cell's boundary the free step may be along it without progress: then the search
        // continues within it.
        let second = self.search(&tapes, start, cell, goal, true);
        if second.residual < first.residual { second } else { first }
    }

    /// As [`Solver::place`], up to two cells away: the thin end of a wedge may pass between the grid's
    /// corners for that long.
    pub(crate) fn outside_cell(
        &mut self,
        leaves: &[Leaf],
        surfaces: &[u32],
        start: Vec3,
        cell: &Box3,
        goal: f64,
    ) -> PlacedVertex {
        let size = (cell.high - cell.low) * 2.0;
        let wide = Box3 { low: cell.low - size, high: cell.high + size };
        PlacedVertex { strayed: true, ..self.place(leaves, surfaces, start, &wide, goal) }
    }

    fn search(
        &mut self,
        tapes: &[&Arc<ExprTape<f64>>],
        start: Vec3,
        cell: &Box3,
        goal: f64,
        stay: bool,
    ) -> PlacedVertex {
        let mut p = start;
        let mut best = PlacedVertex { point: p, residual: f64::INFINITY, strayed: false };
        let mut free = [0, 1, 2].map(|k| cell.low[k] < cell.high[k]);
        for _ in 0..STEPS {
            let mut rows: SmallVec<[(Vec3, f64); 3]> = SmallVec::new();
            let mut residual = 0.0f64;
            for tape in tapes {
                let g = self.gradient(tape, p);
                let slope = g.slope.norm();
                let distance = if g.value == 0.0 { 0.0 } else { g.value / slope };
                if !distance.is_finite() {
                    return best;
                }
                residual = residual.max(distance.abs());
                let mut normal = if slope > 0.0 { g.slope / slope } else { Vec3::zero() };
                let frozen = |axis: usize, x: f64| if free[axis] { x } else { 0.0 };
                normal = Vec3::new(frozen(0, normal.x), frozen(1, normal.y), frozen(2, normal.z));
                rows.push((normal, distance));
            }
            if residual < best.residual {
                best = PlacedVertex { point: p, residual, strayed: false };
            }
            // A step beyond the goal costs one evaluation and squares the error.
            if residual <= 0.01 * goal {
                break;
            }
            let step = least_norm(&rows);
            let target = p + step;
            let mut next = target.to_array();
            for k in 0..3 {
                next[k] = next[k].clamp(cell.low[k], cell.high[k]);
                if stay && next[k] != target[k] {
                    free[k] = false;
                }
            }
            let next = Vec3::from(next);
            if next == p {
                break;
            }
            p = next;
        }
        best
    }
}

/// The shortest step s with n . s = -d for all rows (n, d), in the sense of least squares.
fn least_norm(rows: &[(Vec3, f64)]) -> Vec3 {
    if let [(n, d)] = rows {
        let size = n.norm_sq();
        return if size > 0.0 { *n * (-d / size) } else { Vec3::zero() };
    }
    if let [(n, d), (m, e)] = rows {
        // In the plane of both normals, by Cramer's rule.
        let (nn, mm, nm) = (n.norm_sq(), m.norm_sq(), n.dot(*m));
        let det = n.cross(*m).norm_sq();
        if det > 1e-14 {
            let a = (e * nm - d * mm) / det;
            let b = (d * nm - e * nn) / det;
            return *n * a + *m * b;
        }
    }
    if let [(n, d), (m, e), (o, f)] = rows {
        let (p, q, r) = (m.cross(*o), o.cross(*n), n.cross(*m));
        let det = n.dot(p);
        if det.abs() > 1e-3 {
            return (p * *d + q * *e + r * *f) / -det;
        }
    }
    // Normal equations of least squares by the eigenvectors of sum n n'.
    let mut a = [[0.0; 3]; 3];
    let mut b = Vec3::zero();
    for (n, d) in rows {
        for i in 0..3 {
            for j in 0..3 {
                a[i][j] += n[i] * n[j];
            }
        }
        b -= *n * *d;
    }
    let (values, vectors) = eigen(a);
    let top = values.into_iter().fold(0.0, f64::max);
    let mut step = Vec3::zero();
    for k in 0..3 {
        // Directions not determined by any surface are skipped. At a contact the difference of the
        // normals is proportional to the distance, which is halved by each step, and the value here
        // to its square.
        if values[k] > 1e-13 * top {
            step += vectors[k] * (vectors[k].dot(b) / values[k]);
        }
    }
    step
}

/// Eigenvalues and unit eigenvectors of a symmetric matrix by Jacobi's rotations (Golub and Van Loan,
/// algorithm 8.5.2).
pub(crate) fn eigen(mut a: [[f64; 3]; 3]) -> ([f64; 3], [Vec3; 3]) {
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..12 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for k in 0..3 {
                let (x, y) = (a[k][p], a[k][q]);
                (a[k][p], a[k][q]) = (c * x - s * y, s * x + c * y);
            }
            for k in 0..3 {
                let (x, y) = (a[p][k], a[q][k]);
                (a[p][k], a[q][k]) = (c * x - s * y, s * x + c * y);
            }
            for row in &mut v {
                let (x, y) = (row[p], row[q]);
                (row[p], row[q]) = (c * x - s * y, s * x + c * y);
            }
        }
    }
    let vector = |k: usize| Vec3::new(v[0][k], v[1][k], v[2][k]);
    ([a[0][0], a[1][1], a[2][2]], [vector(0), vector(1), vector(2)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_meet_all_rows_and_are_shortest() {
        let rows = [
            (Vec3::of(0.6, 0.8, 0.0), 0.3),
            (Vec3::of(0.0, 0.6, 0.8), -0.2),
            (Vec3::of(1.0, 0.0, 0.0), 0.1),
        ];
        for k in 1..=3 {
            let step = least_norm(&rows[..k]);
            for (n, d) in &rows[..k] {
                assert!((n.dot(step) + d).abs() < 1e-14);
            }
        }
        let step = least_norm(&rows[..2]);
        let across = rows[0].0.cross(rows[1].0);
        assert!(step.dot(across).abs() < 1e-15);
        // Four rows that agree, and two that are the same.
        let point = Vec3::<f64>::of(0.1, 0.2, -0.3);
        let agreeing = [0.2f64, 1.0, 2.0, 3.0].map(|t| {
            let n = Vec3::of(t.sin(), t.cos() * 0.6, t.cos() * 0.8 + 0.1);
            let n = n / n.norm();
            (n, -n.dot(point))
        });
        assert!(least_norm(&agreeing).distance(point) < 1e-9);
        let twice = least_norm(&[rows[0], rows[0]]);
        assert!(twice.distance(rows[0].0 * -0.3) < 1e-12);
    }
}
