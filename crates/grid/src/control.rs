//! Control terms: how elliptic grids keep the spacing of their edges, or take one that is asked for.

use crate::lines::Control;
use crate::{Edge, SurfaceGrid, Wall};
use moldloft_num::{Real, Vec3};

/// -r' . r'' / |r'|^2 at each point of a row, by central differences; zero at its ends and where it
/// stays fixed.
fn along<T: Real>(points: &[Vec3<T>]) -> Vec<T> {
    let mut all = vec![T::zero(); points.len()];
    for (k, w) in points.windows(3).enumerate() {
        let (first, second) = ((w[2] - w[0]) * T::from(0.5), w[2] + w[0] - w[1] * T::from(2.0));
        let square = first.norm_sq();
        if square.re() > 0.0 {
            all[k + 1] = -(first.dot(second) / square);
        }
    }
    all
}

/// The terms of Thomas and Middlecoff (1980): along each edge those with which its own points are a
/// solution, in between linear from edge to edge by index. An edge that is a point takes those of the
/// opposite one.
pub fn middlecoff<T: Real>(grid: &SurfaceGrid<T>) -> Control<T> {
    let (m, n) = (grid.m, grid.n);
    let pair = |a: Edge, b: Edge| -> [Vec<T>; 2] {
        let (p, q) = (grid.edge(a), grid.edge(b));
        let still = |p: &[Vec3<T>]| p.iter().all(|x| x.re() == p[0].re());
        match (still(&p), still(&q)) {
            (true, false) => [along(&q), along(&q)],
            (false, true) => [along(&p), along(&p)],
            _ => [along(&p), along(&q)],
        }
    };
    // The rows of the grid run along j: "across" goes with i.
    let [low, high] = pair(Edge::FirstJ, Edge::LastJ);
    let [first, last] = pair(Edge::FirstI, Edge::LastI);
    let mix = |a: T, b: T, k: usize, n: usize| a + (b - a) * (k as f64 / (n - 1) as f64);
    Control {
        across: (0..m * n).map(|k| mix(low[k / n], high[k / n], k % n, n)).collect(),
        along: (0..m * n).map(|k| mix(first[k % n], last[k % n], k / n, m)).collect(),
    }
}

/// How far from its wall a term falls to 1/e, in cells.
const REACH: f64 = 6.0;

/// The terms may not grow beyond this: central differences lose their sense at 2.
const MOST: f64 = 1.5;

/// What of a newly found term is taken over in one step.
const SHARE: f64 = 0.05;

/// The terms of Steger and Sorenson (Sorenson 1980, NASA TM-81198) at the walls, found as the grid
/// develops.
pub struct WallTerms<T> {
    /// Of each wall, at each of its points: the terms across and along.
    terms: Vec<Vec<[T; 2]>>,
}

impl<T: Real> WallTerms<T> {
    pub fn new(grid: &SurfaceGrid<T>, walls: &[Wall<T>]) -> Self {
        let terms = walls.iter().map(|w| vec![[T::zero(); 2]; grid.edge(w.edge).len()]).collect();
        Self { terms }
    }

    /// One step towards the terms with which the grid meets the walls as asked.
    ///
    /// At a wall the derivative into the grid is given: of the asked length, at the asked angle to the
    /// wall in the surface. With it, one-sided second differences of the grid and the equations, the
    /// two terms follow as the components of what is left over along both derivatives.
    pub fn update(&mut self, grid: &SurfaceGrid<T>, walls: &[Wall<T>]) {
        for (wall, terms) in walls.iter().zip(&mut self.terms) {
            let view = View { grid, edge: wall.edge };
            let count = view.count();
            let depth = view.depth();
            if depth < 3 {
                continue;
            }
            let asked = |k: usize| -> Option<Vec3<T>> {
                let tangent = view.tangent(k);
                let inward = view.at(k, 1) - view.at(k, 0);
                let unit = tangent.normalized()?;
                let across = inward - unit * inward.dot(unit);
                let normal = across.normalized()?;
                let angle = wall.angle;
                let spacing = wall.spacing[k.min(wall.spacing.len() - 1)];
                Some((unit * angle.cos() + normal * angle.sin()) * spacing)
            };
            for k in 1..count - 1 {
                let Some(inward) = asked(k) else { continue };
                let (Some(before), Some(after)) = (asked(k - 1), asked(k + 1)) else { continue };
                let two = T::from(2.0);
                let tangent = view.tangent(k);
                let along = view.at(k + 1, 0) + view.at(k - 1, 0) - view.at(k, 0) * two;
                let deep =
                    (view.at(k, 1) * T::from(8.0) - view.at(k, 0) * T::from(7.0) - view.at(k, 2))
                        * T::from(0.5)
                        - inward * T::from(3.0);
                let mixed = if k == 1 || k + 2 == count {
                    Vec3::zero()
                } else {
                    (after - before) * T::from(0.5)
                };
                let (alpha, beta, gamma) =
                    (inward.norm_sq(), tangent.dot(inward), tangent.norm_sq());
                let left = -(along * alpha - mixed * (beta * 2.0) + deep * gamma);
                // left = alpha p tangent + gamma q inward, in the least squares sense.
                let whole = alpha * gamma - beta * beta;
                if whole.re() <= 1e-12 * (alpha * gamma).re() {
                    continue;
                }
                let (t, s) = (left.dot(tangent), left.dot(inward));
                let p = (t * alpha - s * beta) / whole / alpha;
                let q = (s * gamma - t * beta) / whole / gamma;
                for (term, new) in terms[k].iter_mut().zip([p, q]) {
                    let step = (new - *term) * SHARE;
                    let limit = T::from(MOST);
                    *term = (*term + step).min(limit).max(-limit);
                }
            }
            // The terms of the ends are their neighbours'.
            if count > 2 {
                (terms[0], terms[count - 1]) = (terms[1], terms[count - 2]);
            }
        }
    }

    /// The terms in the whole grid, fading away from the walls.
    pub fn control(
        &self,
        grid: &SurfaceGrid<T>,
        walls: &[Wall<T>],
        base: &Control<T>,
    ) -> Control<T> {
        let mut control = base.clone();
        let n = grid.n;
        for (wall, terms) in walls.iter().zip(&self.terms) {
            let view = View { grid, edge: wall.edge };
            let fade: Vec<f64> =
                (0..view.depth()).map(|d| libm::exp(-(d as f64) / REACH)).collect();
            for (k, [p, q]) in terms.iter().enumerate() {
                for (d, fade) in fade.iter().enumerate() {
                    let [i, j] = view.index(k, d);
                    // Depth counts backwards from the far edges: the sense of q turns.
                    let q = if view.far() { -*q } else { *q };
                    let (by_tangent, by_depth) = (*p * *fade, q * *fade);
                    let at = i * n + j;
                    // Rows run along j.
                    if view.along_i() {
                        control.across[at] += by_tangent;
                        control.along[at] += by_depth;
                    } else {
                        control.along[at] += by_tangent;
                        control.across[at] += by_depth;
                    }
                }
            }
        }
        control
    }
}

/// A grid seen from an edge: point k along it, d cells deep.
struct View<'a, T> {
    grid: &'a SurfaceGrid<T>,
    edge: Edge,
}

impl<T: Real> View<'_, T> {
    /// True when the edge runs along i.
    fn along_i(&self) -> bool {
        matches!(self.edge, Edge::FirstJ | Edge::LastJ)
    }

    fn far(&self) -> bool {
        matches!(self.edge, Edge::LastI | Edge::LastJ)
    }

    fn count(&self) -> usize {
        if self.along_i() { self.grid.m } else { self.grid.n }
    }

    fn depth(&self) -> usize {
        if self.along_i() { self.grid.n } else { self.grid.m }
    }

    fn index(&self, k: usize, d: usize) -> [usize; 2] {
        let d = if self.far() { self.depth() - 1 - d } else { d };
        if self.along_i() { [k, d] } else { [d, k] }
    }

    fn at(&self, k: usize, d: usize) -> Vec3<T> {
        let [i, j] = self.index(k, d);
        self.grid.at(i, j)
    }

    /// The derivative along the edge.
    fn tangent(&self, k: usize) -> Vec3<T> {
        let last = self.count() - 1;
        match k {
            0 => self.at(1, 0) - self.at(0, 0),
            k if k == last => self.at(last, 0) - self.at(last - 1, 0),
            k => (self.at(k + 1, 0) - self.at(k - 1, 0)) * T::from(0.5),
        }
    }
}
