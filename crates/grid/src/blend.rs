//! Transfinite interpolation of a surface grid from its four edges.
//!
//! Holds: the edges of the result are those given, to the bit.

use crate::{GridError, GridSide, SurfaceGrid};
use moldloft_budget::Budget;
use moldloft_num::{Real, Vec3};
use moldloft_parallel::prelude::*;

/// Parametrisation of inner points from that of the edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Blend {
    /// By arc length: where the line between the normalised lengths s1 and s2 of the edges j = 1
    /// and j = n meets the line between t1 and t2 of the edges i = 1 and i = m (Soni 1985).
    #[default]
    Arc,
    /// By index, evenly.
    Linear,
    /// By arc length, with cubic blending: across each edge the grid has the tangents of the two
    /// edges that meet it, so blocks that continue each other's edges smoothly join smoothly (Coons
    /// 1967).
    Hermite,
    /// By arc length without the intersection: s1 and s2 in the ratio of the mean of t1 and t2, and
    /// vice versa.
    Soni2,
}

/// Normalised arc lengths of the points of an edge; `None` for an edge without length.
fn lengths<T: Real>(points: &[Vec3<T>], size: f64) -> Option<Vec<T>> {
    let mut total = T::zero();
    let mut all = vec![total];
    for w in points.windows(2) {
        let step = w[1] - w[0];
        // The root of an exact zero has no derivative.
        if step.norm_sq().re() > 0.0 {
            total += step.norm();
        }
        all.push(total);
    }
    if total.re() <= crate::surface_grid::SAME * size {
        return None;
    }
    let shrink = T::one() / total;
    all.iter_mut().for_each(|s| *s *= shrink);
    // Exactly one at the end, so that edges of one law have equal parameters.
    let last = all.len() - 1;
    all[last] = T::one();
    Some(all)
}

fn evenly<T: Real>(n: usize) -> Vec<T> {
    let last = (n - 1) as f64;
    (0..n).map(|k| T::from(k as f64 / last)).collect()
}

/// The parameters of two opposite edges: a pole has those of the other, two poles are even.
fn pair<T: Real>(a: &[Vec3<T>], b: &[Vec3<T>], size: f64, blend: Blend) -> [Vec<T>; 2] {
    if blend == Blend::Linear {
        return [evenly(a.len()), evenly(b.len())];
    }
    match (lengths(a, size), lengths(b, size)) {
        (Some(a), Some(b)) => [a, b],
        (Some(a), None) => [a.clone(), a],
        (None, Some(b)) => [b.clone(), b],
        (None, None) => [evenly(a.len()), evenly(b.len())],
    }
}

/// Number of points from which several threads divide the work.
const PARALLEL: usize = 1 << 15;

/// The grid with the edges of this one, to the bit, and its inside interpolated from them.
///
/// r = (1 - x) r(1, j) + x r(m, j) + (1 - y) r(i, 1) + y r(i, n) - the bilinear part of the corners
/// (Gordon and Hall 1973), with (x, y) by `blend`. An edge without length (a pole) takes the
/// distribution of the opposite one. Exact for surfaces that are linear in one of the blended
/// directions. Folds where the edges make it fold: see [`crate::folded_cells`].
///
/// # Errors
/// As [`SurfaceGrid::check_edges`].
///
/// # Example
/// ```
/// use moldloft_grid::{Blend, SurfaceGrid, transfinite};
/// use moldloft_num::Vec3;
/// let square = SurfaceGrid::from_fn(4, 3, |i, j| {
///     let inside = (1..3).contains(&i) && j == 1;
///     if inside { Vec3::<f64>::zero() } else { Vec3::of(i as f64 / 3.0, j as f64 / 2.0, 0.0) }
/// });
/// let grid = transfinite(&square, Blend::Arc).unwrap();
/// assert!((grid.at(1, 1) - Vec3::of(1.0 / 3.0, 0.5, 0.0)).norm() < 1e-15);
/// ```
pub fn transfinite<T: Real>(
    grid: &SurfaceGrid<T>,
    blend: Blend,
) -> Result<SurfaceGrid<T>, GridError> {
    transfinite_until(grid, blend, &Budget::default())
}

/// As [`transfinite`]; ends early when `budget` is spent.
///
/// # Errors
/// As [`transfinite`], and [`GridError::Spent`].
pub fn transfinite_until<T: Real>(
    grid: &SurfaceGrid<T>,
    blend: Blend,
    budget: &Budget,
) -> Result<SurfaceGrid<T>, GridError> {
    grid.check_edges()?;
    let (m, n) = (grid.m, grid.n);
    let [first_i, last_i, first_j, last_j] = GridSide::ALL.map(|edge| grid.edge(edge));
    let size = [&first_i, &last_i, &first_j, &last_j]
        .into_iter()
        .flatten()
        .fold(0.0f64, |size, p| size.max(p.re().distance(first_i[0].re())));
    let [s1, s2] = pair(&first_j, &last_j, size, blend);
    let [t1, t2] = pair(&first_i, &last_i, size, blend);
    let rise: Vec<T> = t1.iter().zip(&t2).map(|(a, b)| *b - *a).collect();
    let mut planes = [(); 3].map(|()| vec![T::zero(); m * n]);
    let [px, py, pz] = &mut planes;
    let frame = EdgeRows {
        first: split(&first_i),
        last: split(&last_i),
        low: split(&first_j),
        high: split(&last_j),
        s: [s1, s2],
        t: t1,
        rise,
        blend,
    };
    // The chunks are the same whatever the threads, and so are the numbers: each row depends on the
    // edges only.
    let rows = (PARALLEL / n).max(1);
    let chunks = px
        .par_chunks_mut(rows * n)
        .zip(py.par_chunks_mut(rows * n))
        .zip(pz.par_chunks_mut(rows * n))
        .enumerate();
    let fill = |(c, ((x, y), z)): (usize, ((&mut [T], &mut [T]), &mut [T]))| {
        if budget.is_spent() {
            return;
        }
        pulp::Arch::new().dispatch(Fill { frame: &frame, first: c * rows, planes: [x, y, z] });
    };
    if m * n < PARALLEL {
        let all = px.chunks_mut(rows * n).zip(py.chunks_mut(rows * n)).zip(pz.chunks_mut(rows * n));
        all.enumerate().for_each(fill);
    } else {
        chunks.for_each(fill);
    }
    budget.poll()?;
    Ok(SurfaceGrid { m, n, planes })
}

/// Rows of the grid from `first` on. A struct instead of closures, since code in closures that are
/// not inlined does not use the wide registers.
struct Fill<'a, T> {
    frame: &'a EdgeRows<T>,
    first: usize,
    planes: [&'a mut [T]; 3],
}

impl<T: Real> pulp::NullaryFnOnce for Fill<'_, T> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self { frame, first, planes: [x, y, z] } = self;
        let (m, n) = (frame.low[0].len(), frame.t.len());
        let mut parameters = [vec![T::zero(); n], vec![T::zero(); n]];
        let rows = x.chunks_mut(n).zip(y.chunks_mut(n)).zip(z.chunks_mut(n));
        for (r, ((x, y), z)) in rows.enumerate() {
            let i = first + r;
            if i > 0 && i + 1 < m {
                frame.parameters(i, &mut parameters);
            }
            frame.row(i, &parameters, [x, y, z]);
        }
    }
}

/// The edges of a grid as component rows, and their parameters.
struct EdgeRows<T> {
    /// s[1,] and s[m,]: along j.
    first: [Vec<T>; 3],
    last: [Vec<T>; 3],
    /// s[,1] and s[,n]: along i.
    low: [Vec<T>; 3],
    high: [Vec<T>; 3],
    s: [Vec<T>; 2],
    t: Vec<T>,
    rise: Vec<T>,
    blend: Blend,
}

fn split<T: Real>(points: &[Vec3<T>]) -> [Vec<T>; 3] {
    [0, 1, 2].map(|c| points.iter().map(|p| p[c]).collect())
}

impl<T: Real> EdgeRows<T> {
    /// The parameters along i and along j of the points of row i.
    #[inline(always)]
    fn parameters(&self, i: usize, [along, across]: &mut [Vec<T>; 2]) {
        let (s, run) = (self.s[0][i], self.s[1][i] - self.s[0][i]);
        let n = self.t.len();
        let (t, rise) = (&self.t[..n], &self.rise[..n]);
        let (along, across) = (&mut along[..n], &mut across[..n]);
        if self.blend == Blend::Soni2 {
            let mean = s + run * 0.5;
            for j in 0..n {
                along[j] = s + run * (t[j] + rise[j] * 0.5);
                across[j] = t[j] + rise[j] * mean;
            }
            return;
        }
        for j in 0..n {
            // 1 - run * rise is positive: both are differences of numbers in [0, 1], and it is 0 only
            // in the corners of edges with everything at opposite ends.
            let whole = T::one() / (-(run * rise[j]) + 1.0);
            along[j] = (s + t[j] * run) * whole;
            across[j] = (t[j] + s * rise[j]) * whole;
        }
        if self.blend == Blend::Hermite {
            let smooth = |x: T| x * x * (-(x * 2.0) + 3.0);
            for j in 0..n {
                along[j] = smooth(along[j]);
                across[j] = smooth(across[j]);
            }
        }
    }

    #[inline(always)]
    fn row(&self, i: usize, [along, across]: &[Vec<T>; 2], out: [&mut [T]; 3]) {
        let (m, n) = (self.low[0].len(), self.t.len());
        for (c, out) in out.into_iter().enumerate() {
            let (first, last) = (&self.first[c][..n], &self.last[c][..n]);
            if i == 0 || i + 1 == m {
                out.copy_from_slice(if i == 0 { first } else { last });
                continue;
            }
            let (low, high) = (self.low[c][i], self.high[c][i]);
            let ([a, b], [d, e]) = ([first[0], first[n - 1]], [last[0], last[n - 1]]);
            let (up, up_first, up_last) = (high - low, b - a, e - d);
            let (x, y, out) = (&along[..n], &across[..n], &mut out[..n]);
            for j in 0..n {
                let one = first[j] - (a + up_first * y[j]);
                let other = last[j] - (d + up_last * y[j]);
                out[j] = (low + up * y[j]) + (one + (other - one) * x[j]);
            }
            (out[0], out[n - 1]) = (low, high);
        }
    }
}
