//! Transfinite interpolation of a block from its six faces.
//!
//! Holds: the faces of the result are those given, to the bit.

use crate::surface_grid::SAME;
use crate::{GridError, SurfaceGrid};
use moldloft_budget::Budget;
use moldloft_num::{Real, Vec3};

/// The six faces of a block of ni by nj by nk points: i = 1 and ni (each [nj, nk]), j = 1 and nj
/// ([ni, nk]), k = 1 and nk ([ni, nj]).
pub type Faces<T> = [SurfaceGrid<T>; 6];

/// The layers k = 1 .. nk, each [ni, nj], of the block that has these faces, to the bit, and whose
/// inside is interpolated from them (Gordon and Hall 1973).
///
/// Parameters are the normalised arc lengths of the four edges of each direction, blended
/// bilinearly by their means in the other two; edges without length are left out of the blend, and
/// a direction of only such edges is uniform.
///
/// # Errors
/// [`GridError::FaceSizes`]; [`GridError::FacesApart`] where two faces do not share their edge.
pub fn transfinite_block<T: Real>(faces: &Faces<T>) -> Result<Vec<SurfaceGrid<T>>, GridError> {
    transfinite_block_until(faces, &Budget::default())
}

/// As [`transfinite_block`]; ends early when `budget` is spent.
///
/// # Errors
/// As [`transfinite_block`], and [`GridError::Spent`].
pub fn transfinite_block_until<T: Real>(
    faces: &Faces<T>,
    budget: &Budget,
) -> Result<Vec<SurfaceGrid<T>>, GridError> {
    let [ni, nj, nk] = [faces[4].m, faces[4].n, faces[0].n];
    let expected = [[nj, nk], [nj, nk], [ni, nk], [ni, nk], [ni, nj], [ni, nj]];
    for (k, (face, expected)) in faces.iter().zip(expected).enumerate() {
        face.check_count(2)?;
        face.check_finite()?;
        let actual = [face.m, face.n];
        if actual != expected {
            return Err(GridError::FaceSizes { face: k + 1, expected, actual });
        }
    }
    let block = TransfiniteBlock { faces, size: [ni, nj, nk] };
    block.check_edges()?;
    let parameters = [block.parameters(0), block.parameters(1), block.parameters(2)];
    let means = [0, 1, 2].map(|axis| mean(&parameters[axis], block.size[axis]));
    let layer = |k: usize| {
        budget.poll()?;
        Ok(SurfaceGrid::from_fn(ni, nj, |i, j| {
            if let Some(p) = block.on_face([i, j, k]) {
                return p;
            }
            let rough = [means[0][i], means[1][j], means[2][k]];
            let x: [T; 3] = std::array::from_fn(|axis| {
                blended(&parameters[axis], [i, j, k][axis], rough, axis)
            });
            block.inside([i, j, k], x)
        }))
    };
    (0..nk).map(layer).collect()
}

struct TransfiniteBlock<'a, T> {
    faces: &'a Faces<T>,
    size: [usize; 3],
}

/// For each axis the other two, in order.
const OTHERS: [[usize; 2]; 3] = [[1, 2], [0, 2], [0, 1]];

/// The parameters of the four edges along an axis: at the low and high ends of the first other axis
/// (slow) and the second (fast); `None` for an edge without length.
type Edges<T> = [Option<Vec<T>>; 4];

impl<T: Real> TransfiniteBlock<'_, T> {
    /// The point of a face's own array.
    fn at_face(&self, axis: usize, end: usize, at: [usize; 3]) -> Vec3<T> {
        let [a, b] = OTHERS[axis];
        self.faces[2 * axis + end].at(at[a], at[b])
    }

    /// The point, if it is on a face; on an edge the first face counts, since both agree.
    fn on_face(&self, at: [usize; 3]) -> Option<Vec3<T>> {
        let axis = (0..3).find(|&axis| at[axis] == 0 || at[axis] + 1 == self.size[axis])?;
        Some(self.at_face(axis, usize::from(at[axis] != 0), at))
    }

    /// The point of an edge or corner of the block, found on a face.
    fn point(&self, at: [usize; 3]) -> Vec3<T> {
        self.on_face(at).expect("edges lie on faces")
    }

    fn check_edges(&self) -> Result<(), GridError> {
        let origin = self.faces[0].at(0, 0).re();
        let all = self.faces.iter().flat_map(|f| f.points());
        let size = all.fold(0.0f64, |size, p| size.max(p.re().distance(origin)));
        for axis in 0..3 {
            let [a, b] = OTHERS[axis];
            for corner in 0..4 {
                let (end_a, end_b) = (corner / 2, corner % 2);
                let mut at = [0; 3];
                at[a] = end_a * (self.size[a] - 1);
                at[b] = end_b * (self.size[b] - 1);
                let mut worst = (0.0, [0; 2]);
                for k in 0..self.size[axis] {
                    at[axis] = k;
                    let gap =
                        self.at_face(a, end_a, at).re().distance(self.at_face(b, end_b, at).re());
                    if gap > worst.0 {
                        let [p, q] = OTHERS[a];
                        worst = (gap, [at[p] + 1, at[q] + 1]);
                    }
                }
                if worst.0 > SAME * size {
                    return Err(GridError::FacesApart {
                        faces: [2 * a + end_a + 1, 2 * b + end_b + 1],
                        at: worst.1,
                        gap: worst.0,
                    });
                }
            }
        }
        Ok(())
    }

    fn parameters(&self, axis: usize) -> Edges<T> {
        let [a, b] = OTHERS[axis];
        std::array::from_fn(|corner| {
            let mut at = [0; 3];
            at[a] = corner / 2 * (self.size[a] - 1);
            at[b] = corner % 2 * (self.size[b] - 1);
            let mut total = T::zero();
            let mut all = vec![total];
            let mut last = self.point(at);
            for k in 1..self.size[axis] {
                at[axis] = k;
                let here = self.point(at);
                if (here - last).norm_sq().re() > 0.0 {
                    total += here.distance(last);
                }
                all.push(total);
                last = here;
            }
            (total.re() > 0.0).then(|| {
                all.iter_mut().for_each(|s| *s = *s / total);
                all
            })
        })
    }

    /// The Boolean sum of the three linear blends: faces less edges plus corners.
    fn inside(&self, at: [usize; 3], x: [T; 3]) -> Vec3<T> {
        let weight = |axis: usize, end: usize| if end == 0 { -x[axis] + 1.0 } else { x[axis] };
        let end = |axis: usize, end: usize| end * (self.size[axis] - 1);
        let mut sum = Vec3::zero();
        for axis in 0..3 {
            for e in 0..2 {
                sum += self.at_face(axis, e, at) * weight(axis, e);
            }
        }
        for axis in 0..3 {
            let [a, b] = OTHERS[axis];
            for (e, f) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let mut place = at;
                (place[a], place[b]) = (end(a, e), end(b, f));
                sum -= self.point(place) * (weight(a, e) * weight(b, f));
            }
        }
        for corner in 0..8 {
            let e = [corner & 1, corner >> 1 & 1, corner >> 2];
            let place = std::array::from_fn(|axis| end(axis, e[axis]));
            let weight = weight(0, e[0]) * weight(1, e[1]) * weight(2, e[2]);
            sum += self.point(place) * weight;
        }
        sum
    }
}

/// The mean of the parameters of the edges that have any.
fn mean<T: Real>(edges: &Edges<T>, n: usize) -> Vec<T> {
    let known: Vec<&Vec<T>> = edges.iter().flatten().collect();
    if known.is_empty() {
        return (0..n).map(|k| T::from(k as f64 / (n - 1) as f64)).collect();
    }
    let share = 1.0 / known.len() as f64;
    (0..n).map(|k| known.iter().fold(T::zero(), |sum, e| sum + e[k]) * share).collect()
}

/// The parameter of point `k` of an axis, between its four edges.
fn blended<T: Real>(edges: &Edges<T>, k: usize, rough: [T; 3], axis: usize) -> T {
    let [a, b] = OTHERS[axis];
    let (mut sum, mut whole) = (T::zero(), T::zero());
    for (corner, edge) in edges.iter().enumerate() {
        let share = |axis: usize, end: usize| {
            if end == 0 { -rough[axis] + 1.0 } else { rough[axis] }
        };
        if let Some(edge) = edge {
            let weight = share(a, corner / 2) * share(b, corner % 2);
            sum += edge[k] * weight;
            whole += weight;
        }
    }
    if whole.re() > 0.0 { sum / whole } else { rough[axis] }
}
