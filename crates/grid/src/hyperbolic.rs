//! Volume grids marched off a surface, plane grids marched off a curve.

use crate::{GridError, SurfaceGrid, folded_cells};
use moldloft_num::{Real, Vec3};

/// What happens at an edge of the surface that a grid is marched from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// The edge goes where the equations, one-sided there, take it.
    #[default]
    Free,
    /// The edge stays in the plane x = const (0), y = const (1) or z = const (2) that it lies in: a
    /// plane of symmetry, which the grid lines cross at right angles.
    Symmetry(usize),
    /// The edge is a point (a nose, a tail), and all its points move as one.
    Pole,
    /// The edge and the opposite one are the same line: the surface closes.
    Periodic,
}

/// How a grid is marched.
#[derive(Clone, Debug, PartialEq)]
pub struct Hyperbolic<T> {
    /// The distances of the layers from the surface, the first 0. They are kept on plane surfaces; cells
    /// keep their volumes, so layers lie closer where the surface is convex and wider where it is
    /// concave.
    pub heights: Vec<T>,
    /// At the edges s[1,], s[m,], s[,1], s[,n].
    pub sides: [Side; 4],
    /// Smoothing: 0 for none, 1 for as much as keeps most concave surfaces from folding.
    pub smoothing: f64,
}

/// The layers of a grid marched off a surface, along its normals s_i x s_j: the surface first.
///
/// Each layer solves the equations of Steger and Chaussee (1980; for surfaces Chan and Steger 1992),
/// r_i . r_k = 0, r_j . r_k = 0, r_k . (r_i x r_j) = V, linearised about the layer below, with V its
/// cells' areas times the step: lines leave at right angles, and where the surface is concave, cells
/// that would shrink to nothing push their neighbours aside. They are solved implicitly, in factors
/// along j and along i, with second differences added that smooth; heights in wider steps than a
/// layer's cells are long are taken in several.
///
/// # Errors
/// Heights that do not ascend from 0; surfaces without a normal; [`GridError::Folded`] with the layer;
/// [`GridError::Diverged`].
pub fn hyperbolic<T: Real>(
    surface: &SurfaceGrid<T>,
    options: &Hyperbolic<T>,
) -> Result<Vec<SurfaceGrid<T>>, GridError> {
    surface.check_count(3)?;
    surface.check_finite()?;
    let heights = &options.heights;
    for (k, height) in heights.iter().enumerate() {
        let before = if k == 0 { -f64::MIN_POSITIVE } else { heights[k - 1].re() };
        if !(height.re() > before) || (k == 0 && height.re() != 0.0) {
            return Err(GridError::Heights { at: k + 1, value: height.re() });
        }
    }
    let mut layers = vec![surface.clone()];
    let mut now = surface.clone();
    for k in 1..heights.len() {
        let step = heights[k] - heights[k - 1];
        // A step of more than the mean cell would leave the linearisation behind.
        let cell = mean_cell(&now);
        let parts = (step.re() / cell).ceil().clamp(1.0, 64.0) as usize;
        for _ in 0..parts {
            let march = March { grid: &now, options };
            now = march.stepped(step * (1.0 / parts as f64))?;
        }
        if now.points().any(|p| !p.is_finite()) {
            return Err(GridError::Diverged { step: k });
        }
        let folded = folded_cells(&now);
        if let Some(&[i, j]) = folded.first() {
            let at = [i + 1, j + 1];
            return Err(GridError::Folded { count: folded.len(), at, layer: Some(k + 1) });
        }
        layers.push(now.clone());
    }
    Ok(layers)
}

/// The plane grid marched off a curve, to the left of its direction as seen against the plane's
/// normal: line s[k,] of the value is the layer k.
///
/// # Errors
/// As [`hyperbolic`].
pub fn hyperbolic_curve<T: Real>(
    curve: &[Vec3<T>],
    normal: Vec3<T>,
    heights: &[T],
    ends: [Side; 2],
    smoothing: f64,
) -> Result<SurfaceGrid<T>, GridError> {
    let unit = normal.normalized().ok_or(GridError::NoNormal { at: [1, 1] })?;
    let n = curve.len();
    if n < 3 {
        return Err(GridError::TooFew { expected: 3, actual: [n, 1] });
    }
    // Three parallel copies of the curve, a cell apart, between planes that they stay in.
    let length = (1..n).fold(0.0, |sum, k| sum + curve[k].re().distance(curve[k - 1].re()));
    let cell = length / (n - 1) as f64;
    // r_i x r_j is normal x tangent: to the left.
    let grid =
        SurfaceGrid::from_fn(3, n, |i, j| curve[j] + unit * T::from(cell * (i as f64 - 1.0)));
    let options = Hyperbolic {
        heights: heights.to_vec(),
        sides: [Side::Free, Side::Free, ends[0], ends[1]],
        smoothing,
    };
    let layers = hyperbolic(&grid, &options)?;
    Ok(SurfaceGrid::of_points(
        layers.len(),
        n,
        layers.iter().flat_map(|l| (0..n).map(|j| l.at(1, j))),
    ))
}

fn mean_cell<T: Real>(grid: &SurfaceGrid<T>) -> f64 {
    let (m, n) = (grid.m, grid.n);
    let mut area = 0.0;
    for i in 0..m - 1 {
        for j in 0..n - 1 {
            let (a, c) = (grid.at(i, j).re(), grid.at(i + 1, j + 1).re());
            let (b, d) = (grid.at(i + 1, j).re(), grid.at(i, j + 1).re());
            area += 0.5 * (c - a).cross(d - b).norm();
        }
    }
    (area / ((m - 1) * (n - 1)) as f64).sqrt().max(f64::MIN_POSITIVE)
}

/// Points by which a closed line runs on over its seam at either end.
const SEAM: usize = 24;

type Matrix<T> = [[T; 3]; 3];

fn times<T: Real>(a: &Matrix<T>, b: &Matrix<T>) -> Matrix<T> {
    std::array::from_fn(|r| {
        std::array::from_fn(|c| a[r][0] * b[0][c] + a[r][1] * b[1][c] + a[r][2] * b[2][c])
    })
}

fn apply<T: Real>(a: &Matrix<T>, v: Vec3<T>) -> Vec3<T> {
    let row = |r: usize| a[r][0] * v.x + a[r][1] * v.y + a[r][2] * v.z;
    Vec3::new(row(0), row(1), row(2))
}

fn inverse<T: Real>(a: &Matrix<T>) -> Option<Matrix<T>> {
    let [x, y, z] = [0, 1, 2].map(|c| Vec3::new(a[0][c], a[1][c], a[2][c]));
    let (p, q, r) = (y.cross(z), z.cross(x), x.cross(y));
    let det = x.dot(p);
    let scale = x.re().norm() * y.re().norm() * z.re().norm();
    if !(det.re().abs() > 1e-14 * scale) {
        return None;
    }
    Some([p, q, r].map(|row| (row / det).to_array()))
}

struct March<'a, T> {
    grid: &'a SurfaceGrid<T>,
    options: &'a Hyperbolic<T>,
}

impl<T: Real> March<'_, T> {
    fn side(&self, axis: usize, end: usize) -> Side {
        self.options.sides[2 * axis + end]
    }

    fn extent(&self, axis: usize) -> usize {
        if axis == 0 { self.grid.m } else { self.grid.n }
    }

    /// The derivative by an index: central, mirrored at planes of symmetry, one-sided at free ends.
    fn derivative(&self, axis: usize, at: [usize; 2]) -> Vec3<T> {
        let last = self.extent(axis) - 1;
        let point = |k: usize| {
            let mut at = at;
            at[axis] = k;
            self.grid.at(at[0], at[1])
        };
        let (k, half) = (at[axis], T::from(0.5));
        let end = match k {
            0 => Some(0),
            k if k == last => Some(1),
            _ => None,
        };
        match end {
            None => (point(k + 1) - point(k - 1)) * half,
            Some(end) => match self.side(axis, end) {
                Side::Periodic => (point(1) - point(last - 1)) * half,
                Side::Symmetry(plane) => {
                    let beside = point(if end == 0 { 1 } else { last - 1 });
                    let d = beside - point(k);
                    // The image beyond the plane differs in that coordinate only.
                    let across =
                        Vec3::from(std::array::from_fn(
                            |c| if c == plane { d[c] } else { T::zero() },
                        ));
                    if end == 0 { across } else { -across }
                }
                _ if end == 0 => point(1) - point(0),
                _ => point(last) - point(last - 1),
            },
        }
    }

    /// The surface moved by one step.
    fn stepped(&self, step: T) -> Result<SurfaceGrid<T>, GridError> {
        let (m, n) = (self.grid.m, self.grid.n);
        let mut moved: Vec<Vec3<T>> = Vec::with_capacity(m * n);
        let mut systems: Vec<Option<[Matrix<T>; 2]>> = Vec::with_capacity(m * n);
        let mut reach = Vec::with_capacity(m * n);
        for k in 0..m * n {
            let at = [k / n, k % n];
            let (u, v) = (self.derivative(0, at), self.derivative(1, at));
            let normal = u.cross(v);
            let area = normal.norm_sq();
            // A point of a pole gets its motion from the line beside it.
            let singular =
                !(area.re() > 1e-20 * (u.norm_sq() * v.norm_sq()).re()) || area.re() == 0.0;
            if singular {
                let pole = (0..2).any(|axis| {
                    let last = self.extent(axis) - 1;
                    at[axis] == 0 && self.side(axis, 0) == Side::Pole
                        || at[axis] == last && self.side(axis, 1) == Side::Pole
                });
                if !pole {
                    return Err(GridError::NoNormal { at: [at[0] + 1, at[1] + 1] });
                }
                moved.push(Vec3::zero());
                systems.push(None);
                reach.push([T::zero(); 2]);
                continue;
            }
            let unit = normal / area.sqrt();
            let away = unit * step;
            // Rows: r_i . dr = 0, r_j . dr = 0, (r_i x r_j) . dr = V; A and B multiply the derivatives
            // of dr by i and by j (Chan and Steger 1992).
            let c: Matrix<T> = [u.to_array(), v.to_array(), normal.to_array()];
            let zero = [T::zero(); 3];
            let a: Matrix<T> = [away.to_array(), zero, v.cross(away).to_array()];
            let b: Matrix<T> = [zero, away.to_array(), away.cross(u).to_array()];
            let Some(solve) = inverse(&c) else {
                return Err(GridError::NoNormal { at: [at[0] + 1, at[1] + 1] });
            };
            moved.push(away);
            reach.push([step / u.norm(), step / v.norm()]);
            systems.push(Some([times(&solve, &a), times(&solve, &b)]));
        }
        self.lead_poles(step, &mut moved);
        // (I + C^-1 A d_i) (I + C^-1 B d_j) dr = C^-1 (0, 0, V) = the step along the normal. Smoothing is
        // a second difference on the left, in proportion to the step over the cell.
        for axis in [1, 0] {
            let other = 1 - axis;
            for line in 0..self.extent(other) {
                self.solve_line(axis, line, &systems, &reach, &mut moved);
            }
        }
        let mut new = self.grid.clone();
        for k in 0..m * n {
            let (i, j) = (k / n, k % n);
            new.set(i, j, self.grid.at(i, j) + moved[k]);
        }
        self.mend_edges(&mut new);
        Ok(new)
    }

    /// Gives poles the motion that the line beside them shares: what smooths the lines to a pole pulls at what
    /// moves there, too.
    fn lead_poles(&self, step: T, moved: &mut [Vec3<T>]) {
        let n = self.grid.n;
        for axis in 0..2 {
            let (last, count) = (self.extent(axis) - 1, self.extent(1 - axis));
            let index = |k: usize, l: usize| if axis == 0 { k * n + l } else { l * n + k };
            for (end, k, beside) in [(0, 0, 1), (1, last, last - 1)] {
                if self.side(axis, end) != Side::Pole {
                    continue;
                }
                let mut mean = Vec3::zero();
                (0..count).for_each(|l| mean += moved[index(beside, l)]);
                let motion =
                    self.along_pole(axis, mean).map_or_else(Vec3::zero, |unit| unit * step);
                (0..count).for_each(|l| moved[index(k, l)] = motion);
            }
        }
    }

    /// The direction of a pole's motion: a half body has motions to one side only, and what lies in its planes of
    /// symmetry is kept.
    fn along_pole(&self, axis: usize, mean: Vec3<T>) -> Option<Vec3<T>> {
        let mut direction = mean;
        for end in 0..2 {
            if let Side::Symmetry(plane) = self.side(1 - axis, end) {
                let mut p = direction.to_array();
                p[plane] = T::zero();
                direction = p.into();
            }
        }
        direction.normalized()
    }

    /// One block-tridiagonal system along an axis, by elimination.
    fn solve_line(
        &self,
        axis: usize,
        line: usize,
        systems: &[Option<[Matrix<T>; 2]>],
        reach: &[[T; 2]],
        moved: &mut [Vec3<T>],
    ) {
        let (n, count) = (self.grid.n, self.extent(axis));
        // A closed line runs on over its seam by enough points for their ends not to matter.
        let closed = self.side(axis, 0) == Side::Periodic;
        let (around, extra) = (count - 1, if closed { SEAM } else { 0 });
        let total = if closed { around + 2 * extra } else { count };
        let point = |k: usize| if closed { (k + SEAM * around - extra) % around } else { k };
        let index = |k: usize| {
            let k = point(k);
            if axis == 0 { k * n + line } else { line * n + k }
        };
        let identity = |x: T| -> Matrix<T> {
            std::array::from_fn(|r| std::array::from_fn(|c| if r == c { x } else { T::zero() }))
        };
        let mut upper: Vec<Matrix<T>> = Vec::with_capacity(total);
        let mut right: Vec<Vec3<T>> = Vec::with_capacity(total);
        for k in 0..total {
            let at = index(k);
            let smooth = (reach[at][axis] * 2.0 + 0.5) * self.options.smoothing;
            let end = k == 0 || k + 1 == total;
            let mut low = identity(T::zero());
            let mut middle = identity(T::one());
            let mut high = identity(T::zero());
            // At an end there is no term along the line; its length is mended afterwards.
            if let Some(system) = systems[at].as_ref().filter(|_| !end) {
                let d = &system[axis];
                for r in 0..3 {
                    for c in 0..3 {
                        low[r][c] = -(d[r][c] * 0.5);
                        high[r][c] = d[r][c] * 0.5;
                    }
                    low[r][r] -= smooth;
                    high[r][r] -= smooth;
                    middle[r][r] += smooth * 2.0;
                }
            }
            if k > 0 {
                let factor = &upper[k - 1];
                let product = times(&low, factor);
                for r in 0..3 {
                    for c in 0..3 {
                        middle[r][c] -= product[r][c];
                    }
                }
            }
            let mut b = moved[at];
            if k > 0 {
                b -= apply(&low, right[k - 1]);
            }
            let solve = inverse(&middle).unwrap_or_else(|| identity(T::one()));
            right.push(apply(&solve, b));
            upper.push(times(&solve, &high));
        }
        let mut x = right[total - 1];
        let own = extra..extra + if closed { around } else { count };
        if own.contains(&(total - 1)) {
            moved[index(total - 1)] = x;
        }
        for k in (0..total - 1).rev() {
            x = right[k] - apply(&upper[k], x);
            if own.contains(&k) {
                moved[index(k)] = x;
            }
        }
        if closed {
            let seam = if axis == 0 { around * n + line } else { line * n + around };
            moved[seam] = moved[index(extra)];
        }
    }

    /// Edges as their sides ask.
    fn mend_edges(&self, new: &mut SurfaceGrid<T>) {
        let (m, n) = (new.m, new.n);
        for axis in 0..2 {
            let (last, count) = (self.extent(axis) - 1, if axis == 0 { n } else { m });
            let place = |k: usize, l: usize| if axis == 0 { [k, l] } else { [l, k] };
            for end in 0..2 {
                let k = if end == 0 { 0 } else { last };
                let beside = if end == 0 { 1 } else { last - 1 };
                // The ends' equations have no terms along the line: their steps get the length of those
                // beside them.
                if matches!(self.side(axis, end), Side::Free | Side::Symmetry(_)) {
                    for l in 0..count {
                        let ([i, j], [a, b]) = (place(k, l), place(beside, l));
                        let step = new.at(i, j) - self.grid.at(i, j);
                        let near = new.at(a, b) - self.grid.at(a, b);
                        if step.norm_sq().re() > 0.0 && near.norm_sq().re() > 0.0 {
                            let step = step * (near.norm() / step.norm());
                            new.set(i, j, self.grid.at(i, j) + step);
                        }
                    }
                }
                match self.side(axis, end) {
                    Side::Free => {}
                    Side::Symmetry(plane) => {
                        for l in 0..count {
                            let [i, j] = place(k, l);
                            let mut p = new.at(i, j).to_array();
                            p[plane] = self.grid.at(i, j)[plane];
                            new.set(i, j, p.into());
                        }
                    }
                    Side::Pole => {
                        let mut sum = Vec3::zero();
                        for l in 0..count {
                            let [i, j] = place(beside, l);
                            sum += new.at(i, j) - self.grid.at(i, j);
                        }
                        // The component of the neighbours' motion that they share.
                        let [i, j] = place(k, 0);
                        let mean = sum / T::from(count as f64);
                        let step = self.pole_step(axis, beside, new, mean);
                        let p = self.grid.at(i, j) + step;
                        for l in 0..count {
                            let [i, j] = place(k, l);
                            new.set(i, j, p);
                        }
                    }
                    Side::Periodic => {
                        if end == 1 {
                            for l in 0..count {
                                let ([i, j], [a, b]) = (place(0, l), place(last, l));
                                let middle = (new.at(i, j) + new.at(a, b)) * T::from(0.5);
                                new.set(i, j, middle);
                                new.set(a, b, middle);
                            }
                        }
                    }
                }
            }
        }
    }

    /// The motion of a pole: along the mean motion of the line beside it, as long as that line's own.
    fn pole_step(
        &self,
        axis: usize,
        beside: usize,
        new: &SurfaceGrid<T>,
        mean: Vec3<T>,
    ) -> Vec3<T> {
        let count = if axis == 0 { new.n } else { new.m };
        let mut length = T::zero();
        for l in 0..count {
            let [i, j] = if axis == 0 { [beside, l] } else { [l, beside] };
            length += (new.at(i, j) - self.grid.at(i, j)).norm();
        }
        match self.along_pole(axis, mean) {
            Some(unit) => unit * (length * (1.0 / count as f64)),
            None => Vec3::zero(),
        }
    }
}
