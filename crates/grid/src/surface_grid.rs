//! Surface grids: points by two indices, their edges and where these must meet.

use crate::{Corner, GridError};
use moldloft_num::{Real, Vec3};
use std::fmt;

/// A surface grid of m by n points as three component planes, point (i, j) at `i * n + j`.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceGrid<T> {
    /// Points along the first index, i.
    pub m: usize,
    /// Points along the second index, j.
    pub n: usize,
    /// All x, all y, all z.
    pub planes: [Vec<T>; 3],
}

/// An edge of a grid, by the index that is constant along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GridSide {
    /// `s[1,]`
    FirstI,
    /// `s[m,]`
    LastI,
    /// `s[,1]`
    FirstJ,
    /// `s[,n]`
    LastJ,
}

impl GridSide {
    /// All four.
    pub const ALL: [GridSide; 4] =
        [GridSide::FirstI, GridSide::LastI, GridSide::FirstJ, GridSide::LastJ];
}

impl GridSide {
    /// The same edge once the indices are exchanged.
    pub(crate) fn crossed(self) -> Self {
        match self {
            GridSide::FirstI => GridSide::FirstJ,
            GridSide::LastI => GridSide::LastJ,
            GridSide::FirstJ => GridSide::FirstI,
            GridSide::LastJ => GridSide::LastI,
        }
    }
}

impl fmt::Display for GridSide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            GridSide::FirstI => "s[1,]",
            GridSide::LastI => "s[m,]",
            GridSide::FirstJ => "s[,1]",
            GridSide::LastJ => "s[,n]",
        })
    }
}

/// Two points nearer to each other than this, relative to the size, count as one: the rounding of
/// coordinates, no more.
pub(crate) const SAME: f64 = 1e-10;

/// Ratio of the first step of an edge to the next above which it is a gap.
const LEAP: f64 = 25.0;

impl<T: Real> SurfaceGrid<T> {
    /// The grid of these planes.
    ///
    /// # Panics
    /// When a plane does not have m n numbers.
    pub fn new(m: usize, n: usize, planes: [Vec<T>; 3]) -> Self {
        assert!(planes.iter().all(|p| p.len() == m * n));
        Self { m, n, planes }
    }

    /// The grid of points in the order of memory.
    pub fn of_points(m: usize, n: usize, points: impl IntoIterator<Item = Vec3<T>>) -> Self {
        let mut planes = [(); 3].map(|()| Vec::with_capacity(m * n));
        for p in points {
            planes[0].push(p.x);
            planes[1].push(p.y);
            planes[2].push(p.z);
        }
        Self::new(m, n, planes)
    }

    /// The grid of the points `f(i, j)`, indices from 0.
    pub fn from_fn(m: usize, n: usize, f: impl Fn(usize, usize) -> Vec3<T>) -> Self {
        Self::of_points(m, n, (0..m * n).map(|k| f(k / n, k % n)))
    }

    /// Point (i, j), from 0.
    #[inline(always)]
    pub fn at(&self, i: usize, j: usize) -> Vec3<T> {
        let k = i * self.n + j;
        Vec3::new(self.planes[0][k], self.planes[1][k], self.planes[2][k])
    }

    /// Replaces point (i, j).
    #[inline(always)]
    pub fn set(&mut self, i: usize, j: usize, p: Vec3<T>) {
        let k = i * self.n + j;
        self.planes[0][k] = p.x;
        self.planes[1][k] = p.y;
        self.planes[2][k] = p.z;
    }

    /// All points in the order of memory.
    pub fn points(&self) -> impl Iterator<Item = Vec3<T>> + '_ {
        (0..self.m * self.n)
            .map(|k| Vec3::new(self.planes[0][k], self.planes[1][k], self.planes[2][k]))
    }

    /// The grid with its indices exchanged.
    pub fn transposed(&self) -> Self {
        Self::from_fn(self.n, self.m, |i, j| self.at(j, i))
    }

    /// The points of an edge, in ascending index.
    pub fn edge(&self, edge: GridSide) -> Vec<Vec3<T>> {
        match edge {
            GridSide::FirstI => (0..self.n).map(|j| self.at(0, j)).collect(),
            GridSide::LastI => (0..self.n).map(|j| self.at(self.m - 1, j)).collect(),
            GridSide::FirstJ => (0..self.m).map(|i| self.at(i, 0)).collect(),
            GridSide::LastJ => (0..self.m).map(|i| self.at(i, self.n - 1)).collect(),
        }
    }

    /// The indices, from 1, of point `k` of an edge.
    fn place(&self, edge: GridSide, k: usize) -> [usize; 2] {
        match edge {
            GridSide::FirstI => [1, k + 1],
            GridSide::LastI => [self.m, k + 1],
            GridSide::FirstJ => [k + 1, 1],
            GridSide::LastJ => [k + 1, self.n],
        }
    }

    /// The greatest extent of the points in x, y or z.
    pub fn size(&self) -> f64 {
        let extent = |plane: &Vec<T>| {
            let start = (f64::INFINITY, f64::NEG_INFINITY);
            let (low, high) =
                plane.iter().fold(start, |(low, high), x| (low.min(x.re()), high.max(x.re())));
            high - low
        };
        self.planes.iter().map(extent).fold(0.0, f64::max)
    }

    /// The real parts.
    pub fn re(&self) -> SurfaceGrid<f64> {
        let plane = |k: usize| self.planes[k].iter().map(|x| x.re()).collect();
        SurfaceGrid { m: self.m, n: self.n, planes: [plane(0), plane(1), plane(2)] }
    }

    /// Refuses grids of fewer than `least` points in either direction.
    pub(crate) fn check_count(&self, least: usize) -> Result<(), GridError> {
        if self.m.min(self.n) >= least {
            return Ok(());
        }
        Err(GridError::TooFew { expected: least, actual: [self.m, self.n] })
    }

    /// Refuses points that are not finite.
    pub(crate) fn check_finite(&self) -> Result<(), GridError> {
        for plane in &self.planes {
            if let Some(k) = plane.iter().position(|x| !x.is_finite()) {
                return Err(GridError::NotFinite { at: [k / self.n + 1, k % self.n + 1] });
            }
        }
        Ok(())
    }

    /// Refuses edges that are not finite, or that leap at a corner: an array holds one point there,
    /// so an edge that was set inconsistently has a jump at the common corner.
    ///
    /// The first step of an edge is a leap when it is more than 25 times each of the next two; an
    /// edge that is a point but for its end is one, too.
    ///
    /// # Errors
    /// [`GridError::TooFew`], [`GridError::NotFinite`], [`GridError::EdgesApart`].
    pub fn check_edges(&self) -> Result<(), GridError> {
        self.check_count(2)?;
        let mut size = 0.0f64;
        for edge in GridSide::ALL {
            let points = self.edge(edge);
            if let Some(k) = points.iter().position(|p| !p.is_finite()) {
                return Err(GridError::NotFinite { at: self.place(edge, k) });
            }
            let first = points[0].re();
            size = points.iter().fold(size, |size, p| size.max(p.re().distance(first)));
        }
        for edge in GridSide::ALL {
            let points: Vec<Vec3> = self.edge(edge).iter().map(|p| p.re()).collect();
            let n = points.len();
            if n < 4 {
                continue;
            }
            for back in [false, true] {
                let p = |k: usize| points[if back { n - 1 - k } else { k }];
                let step = |k: usize| p(k).distance(p(k + 1));
                let next = step(1).max(if n > 4 { step(2) } else { 0.0 });
                if step(0) > LEAP * next && step(0) > SAME.sqrt() * size {
                    let other = match (edge, back) {
                        (GridSide::FirstI | GridSide::LastI, false) => GridSide::FirstJ,
                        (GridSide::FirstI | GridSide::LastI, true) => GridSide::LastJ,
                        (_, false) => GridSide::FirstI,
                        (_, true) => GridSide::LastI,
                    };
                    let at = self.place(edge, if back { n - 1 } else { 0 });
                    return Err(GridError::EdgesApart {
                        corner: Corner { edge, other, at },
                        gap: step(0),
                    });
                }
            }
        }
        Ok(())
    }
}

/// The grid of four edges, its inside unset: `edges` are `s[1,]`, `s[m,]`, `s[,1]` and `s[,n]`, each in
/// ascending index.
///
/// # Errors
/// [`GridError::TooFew`]; [`GridError::FaceSizes`] never; [`GridError::EdgesApart`] with the corner
/// at which the ends of two edges differ, and their distance.
pub fn framed<T: Real>(edges: &[Vec<Vec3<T>>; 4]) -> Result<SurfaceGrid<T>, GridError> {
    let [first_i, last_i, first_j, last_j] = edges;
    let (m, n) = (first_j.len(), first_i.len());
    let short = [m, n, last_i.len(), last_j.len()].into_iter().min().unwrap_or(0);
    if short < 2 || last_i.len() != n || last_j.len() != m {
        return Err(GridError::TooFew { expected: 2, actual: [m, n] });
    }
    let mut size = 0.0f64;
    for p in edges.iter().flatten() {
        size = size.max(p.re().distance(first_i[0].re()));
    }
    for (edge, k, other, l, at) in [
        (GridSide::FirstI, 0, GridSide::FirstJ, 0, [1, 1]),
        (GridSide::FirstI, n - 1, GridSide::LastJ, 0, [1, n]),
        (GridSide::LastI, 0, GridSide::FirstJ, m - 1, [m, 1]),
        (GridSide::LastI, n - 1, GridSide::LastJ, m - 1, [m, n]),
    ] {
        let end = |edge: GridSide, k: usize| edges[edge as usize][k].re();
        let gap = end(edge, k).distance(end(other, l));
        // Written so that NaN is refused.
        if !(gap <= SAME * size) {
            return Err(GridError::EdgesApart { corner: Corner { edge, other, at }, gap });
        }
    }
    let mut grid = SurfaceGrid::from_fn(m, n, |_, _| Vec3::zero());
    for (i, (a, b)) in first_j.iter().zip(last_j).enumerate() {
        grid.set(i, 0, *a);
        grid.set(i, n - 1, *b);
    }
    for (j, (a, b)) in first_i.iter().zip(last_i).enumerate() {
        grid.set(0, j, *a);
        grid.set(m - 1, j, *b);
    }
    Ok(grid)
}
