//! Volume grids: points by three indices, their faces, layers and cells.

use crate::marching::hexahedron;
use crate::{GridError, SurfaceGrid};
use moldloft_budget::{Budget, Spent};
use moldloft_num::{Real, Vec3};
use std::fmt;

/// A volume grid of ni by nj by nk points as three component planes, point (i, j, k) at `(i * nj + j) * nk + k`.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeGrid<T> {
    /// Points along i, j, k.
    pub size: [usize; 3],
    /// All x, all y, all z.
    pub planes: [Vec<T>; 3],
}

/// A face of a volume grid, by the index that is constant on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct GridFace {
    /// 0 for i, 1 for j, 2 for k.
    pub axis: usize,
    /// True for the last value of the index.
    pub last: bool,
}

impl GridFace {
    /// i = 1, i = ni, j = 1, j = nj, k = 1, k = nk.
    pub const ALL: [GridFace; 6] = [
        GridFace { axis: 0, last: false },
        GridFace { axis: 0, last: true },
        GridFace { axis: 1, last: false },
        GridFace { axis: 1, last: true },
        GridFace { axis: 2, last: false },
        GridFace { axis: 2, last: true },
    ];

    /// The word of the language: "i1", "in", "j1", "jn", "k1", "kn".
    pub fn word(self) -> &'static str {
        ["i1", "in", "j1", "jn", "k1", "kn"][2 * self.axis + usize::from(self.last)]
    }

    /// The other two axes, in order.
    pub fn others(self) -> [usize; 2] {
        [[1, 2], [0, 2], [0, 1]][self.axis]
    }
}

impl fmt::Display for GridFace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

impl<T: Real> VolumeGrid<T> {
    /// The grid of the points `f(i, j, k)`, indices from 0.
    pub fn from_fn(size: [usize; 3], f: impl Fn(usize, usize, usize) -> Vec3<T>) -> Self {
        let [ni, nj, nk] = size;
        let mut planes = [(); 3].map(|()| Vec::with_capacity(ni * nj * nk));
        for i in 0..ni {
            for j in 0..nj {
                for k in 0..nk {
                    let p = f(i, j, k);
                    planes[0].push(p.x);
                    planes[1].push(p.y);
                    planes[2].push(p.z);
                }
            }
        }
        Self { size, planes }
    }

    /// The grid whose layers k = 1 .. nk these are.
    ///
    /// # Errors
    /// [`GridError::TooFew`] without a layer; [`GridError::FaceSizes`] where layers differ in size.
    pub fn from_layers(layers: &[SurfaceGrid<T>]) -> Result<Self, GridError> {
        let Some(first) = layers.first() else {
            return Err(GridError::TooFew { expected: 1, actual: [0, 0] });
        };
        let expected = [first.m, first.n];
        for (k, layer) in layers.iter().enumerate() {
            let actual = [layer.m, layer.n];
            if actual != expected {
                return Err(GridError::FaceSizes { face: k + 1, expected, actual });
            }
        }
        let size = [first.m, first.n, layers.len()];
        Ok(Self::from_fn(size, |i, j, k| layers[k].at(i, j)))
    }

    /// The layers k = 1 .. nk.
    pub fn layers(&self) -> Vec<SurfaceGrid<T>> {
        let [ni, nj, nk] = self.size;
        (0..nk).map(|k| SurfaceGrid::from_fn(ni, nj, |i, j| self.at(i, j, k))).collect()
    }

    #[inline(always)]
    fn place(&self, i: usize, j: usize, k: usize) -> usize {
        (i * self.size[1] + j) * self.size[2] + k
    }

    /// Point (i, j, k), from 0.
    #[inline(always)]
    pub fn at(&self, i: usize, j: usize, k: usize) -> Vec3<T> {
        let at = self.place(i, j, k);
        Vec3::new(self.planes[0][at], self.planes[1][at], self.planes[2][at])
    }

    /// Replaces point (i, j, k).
    #[inline(always)]
    pub fn set(&mut self, i: usize, j: usize, k: usize, p: Vec3<T>) {
        let at = self.place(i, j, k);
        (self.planes[0][at], self.planes[1][at], self.planes[2][at]) = (p.x, p.y, p.z);
    }

    /// All points in the order of memory.
    pub fn points(&self) -> impl Iterator<Item = Vec3<T>> + '_ {
        (0..self.planes[0].len())
            .map(|k| Vec3::new(self.planes[0][k], self.planes[1][k], self.planes[2][k]))
    }

    /// A face, by the other two indices in ascending order.
    pub fn face(&self, face: GridFace) -> SurfaceGrid<T> {
        let [a, b] = face.others();
        let fixed = if face.last { self.size[face.axis] - 1 } else { 0 };
        SurfaceGrid::from_fn(self.size[a], self.size[b], |p, q| {
            let mut at = [fixed; 3];
            (at[a], at[b]) = (p, q);
            self.at(at[0], at[1], at[2])
        })
    }

    /// The greatest extent of the points in x, y or z.
    pub fn extent(&self) -> f64 {
        let extent = |plane: &Vec<T>| {
            let start = (f64::INFINITY, f64::NEG_INFINITY);
            let (low, high) =
                plane.iter().fold(start, |(low, high), x| (low.min(x.re()), high.max(x.re())));
            high - low
        };
        self.planes.iter().map(extent).fold(0.0, f64::max)
    }

    /// The real parts.
    pub fn re(&self) -> VolumeGrid<f64> {
        let plane = |k: usize| self.planes[k].iter().map(|x| x.re()).collect();
        VolumeGrid { size: self.size, planes: [plane(0), plane(1), plane(2)] }
    }

    /// Refuses points that are not finite.
    pub(crate) fn check_finite(&self) -> Result<(), GridError> {
        for plane in &self.planes {
            if let Some(at) = plane.iter().position(|x| !x.is_finite()) {
                let [_, nj, nk] = self.size;
                let at = [at / (nj * nk) + 1, at / nk % nj + 1, at % nk + 1];
                return Err(GridError::PointNotFinite { at });
            }
        }
        Ok(())
    }

    /// Scaled Jacobian and equiangular skewness of each cell, cell (i, j, k) at
    /// `(i * (nj - 1) + j) * (nk - 1) + k`: the least triple product of the unit edges at a corner, and the deviation
    /// of the worst angle of a face from 90°, relative to 90°. Corners at edges without length do
    /// not count.
    pub fn cell_quality(&self) -> Vec<[f64; 2]> {
        self.cells_measured(&|| Ok(())).expect("nothing ends it")
    }

    /// As [`Self::cell_quality`]; ends early when `budget` is spent.
    ///
    /// # Errors
    /// The exceeded limit.
    pub fn cell_quality_until(&self, budget: &Budget) -> Result<Vec<[f64; 2]>, Spent> {
        self.cells_measured(&|| budget.poll())
    }

    fn cells_measured(
        &self,
        go_on: &dyn Fn() -> Result<(), Spent>,
    ) -> Result<Vec<[f64; 2]>, Spent> {
        let plain = self.re();
        let [ci, cj, ck] = self.size.map(|n| n.saturating_sub(1));
        let mut all = Vec::with_capacity(ci * cj * ck);
        for i in 0..ci {
            for j in 0..cj {
                go_on()?;
                for k in 0..ck {
                    let corner = |a: usize| {
                        [[(0, 0), (0, 1)], [(1, 0), (1, 1)]]
                            .map(|pair| pair.map(|(b, c)| plain.at(i + a, j + b, k + c)))
                    };
                    all.push(hexahedron([corner(0), corner(1)]));
                }
            }
        }
        Ok(all)
    }
}
