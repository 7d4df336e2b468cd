//! Structured grids as files hold them: sizes and component planes, the first index fastest.

use crate::Bits;
use crate::WriteError;
use moldloft_num::Vec3;

/// A structured block of `size` points, a surface when the third is 1.
#[derive(Clone, Debug, PartialEq)]
pub struct StructuredGrid {
    /// Points along i, j and k.
    pub size: [usize; 3],
    /// All x, all y, all z, i running fastest. A plane grid has z = 0.
    pub planes: [Vec<f64>; 3],
    /// A number for each point, if present: 0 for a point that does not count.
    pub iblank: Option<Vec<i32>>,
}

/// A grid with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedGrid {
    /// Its name.
    pub name: String,
    /// Its points.
    pub grid: StructuredGrid,
}

impl StructuredGrid {
    /// The surface of points (i, j) at `i * n + j`, the order of arrays in the language and NumPy.
    ///
    /// # Panics
    /// When there are not `m * n` points.
    pub fn surface(m: usize, n: usize, points: &[Vec3]) -> Self {
        assert_eq!(points.len(), m * n);
        let plane = |c: usize| (0..m * n).map(|k| points[k % m * n + k / m][c]).collect();
        Self { size: [m, n, 1], planes: [plane(0), plane(1), plane(2)], iblank: None }
    }

    /// The number of points.
    pub fn count(&self) -> usize {
        self.size.iter().product()
    }

    /// Point (i, j, k).
    pub fn at(&self, [i, j, k]: [usize; 3]) -> Vec3 {
        let at = (k * self.size[1] + j) * self.size[0] + i;
        Vec3::of(self.planes[0][at], self.planes[1][at], self.planes[2][at])
    }

    /// The lines along its first and second index, of a block those on its six faces.
    pub fn lines(&self) -> Vec<Vec<Vec3>> {
        let [ni, nj, nk] = self.size;
        let at = |i: usize, j: usize, k: usize| self.at([i, j, k]);
        let ends = |n: usize| if n > 1 { vec![0, n - 1] } else { vec![0] };
        let mut found = Vec::new();
        for k in if nk > 1 { ends(nk) } else { vec![0] } {
            found
                .extend((0..nj).filter(|_| ni > 1).map(|j| (0..ni).map(|i| at(i, j, k)).collect()));
            found
                .extend((0..ni).filter(|_| nj > 1).map(|i| (0..nj).map(|j| at(i, j, k)).collect()));
        }
        if nk > 1 {
            for j in ends(nj) {
                found.extend((0..ni).map(|i| (0..nk).map(|k| at(i, j, k)).collect()));
                found.extend((1..nk - 1).map(|k| (0..ni).map(|i| at(i, j, k)).collect()));
            }
            for i in ends(ni) {
                found.extend((1..nj - 1).map(|j| (0..nk).map(|k| at(i, j, k)).collect()));
                found.extend((1..nk - 1).map(|k| (0..nj).map(|j| at(i, j, k)).collect()));
            }
        }
        found
    }

    /// All points, i fastest, then j.
    pub fn points(&self) -> impl Iterator<Item = Vec3> + '_ {
        let [x, y, z] = &self.planes;
        x.iter().zip(y).zip(z).map(|((x, y), z)| Vec3::of(*x, *y, *z))
    }

    /// Layer k as points (i, j) at `i * n + j`.
    pub fn layer(&self, k: usize) -> Vec<Vec3> {
        let [m, n, _] = self.size;
        (0..m * n).map(|at| self.at([at / n, at % n, k])).collect()
    }

    /// Refuses coordinates beyond `limit`, NaN included.
    pub(crate) fn check<'a>(
        blocks: impl IntoIterator<Item = &'a Self>,
        limit: f64,
    ) -> Result<(), WriteError> {
        let mut blocks = blocks.into_iter().peekable();
        if blocks.peek().is_none() {
            return Err(WriteError::NoGrid { patches: vec![] });
        }
        for (number, block) in blocks.enumerate() {
            let bad = |plane: &Vec<f64>| plane.iter().position(|x| !(x.abs() <= limit));
            if let Some(vertex) = block.planes.iter().find_map(bad) {
                let vertex = u32::try_from(vertex).unwrap_or(u32::MAX);
                return Err(WriteError::NotFinite {
                    patch: format!("block {}", number + 1),
                    vertex,
                });
            }
        }
        Ok(())
    }

    /// Refuses edges of cells that single precision changes by more than [`LOST`] of their length: layers at walls first.
    pub(crate) fn check_single(blocks: &[Self], format: &'static str) -> Result<(), WriteError> {
        for (number, block) in blocks.iter().enumerate() {
            let [ni, nj, nk] = block.size;
            for (axis, stride) in [1, ni, ni * nj].into_iter().enumerate() {
                for at in 0..block.count() {
                    let place = [at % ni, at / ni % nj, at / (ni * nj)];
                    if place[axis] + 1 == [ni, nj, nk][axis] {
                        continue;
                    }
                    let edge = |rounded: bool| {
                        let side = |plane: &Vec<f64>| match rounded {
                            false => plane[at + stride] - plane[at],
                            true => {
                                f64::from(plane[at + stride] as f32) - f64::from(plane[at] as f32)
                            }
                        };
                        Vec3::from(block.planes.each_ref().map(side))
                    };
                    let (exact, rounded) = (edge(false), edge(true));
                    if (exact - rounded).norm() > LOST * exact.norm() {
                        let [i, j, k] = place.map(|x| x + 1);
                        let mut to = [i, j, k];
                        to[axis] += 1;
                        return Err(WriteError::Thin {
                            format,
                            place: [number + 1, i, j, k, to[0], to[1], to[2]],
                            length: [exact, rounded].map(|e| Bits::of(e.norm())),
                        });
                    }
                }
            }
        }
        Ok(())
    }
}

/// Maximum change of a cell's edge by single precision, relative to its length: first cells at
/// walls keep their height.
const LOST: f64 = 0.05;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{stl, vtk};
    use moldloft_mesh::Mesh;

    /// A half body of revolution with a nose, 60 by 20.
    fn body() -> StructuredGrid {
        let at = |k: usize| {
            let (x, a) = ((k / 20) as f64 / 59.0, (k % 20) as f64 * std::f64::consts::PI / 19.0);
            let r = 0.3 * libm::sqrt(x);
            // The axis is exact: the nose is one point.
            Vec3::of(3.0 * x, r * libm::cos(a), r * libm::sin(a))
        };
        let points: Vec<Vec3> = (0..1200).map(at).collect();
        StructuredGrid::surface(60, 20, &points)
    }

    #[test]
    fn a_body_as_stl_without_the_triangles_of_its_nose() {
        let bytes = stl::write_grids(&[body()], "body", false, &|| true).unwrap();
        assert_eq!(bytes.len(), 84 + 50 * 2223);
        let back = stl::read(&bytes).unwrap().mesh;
        assert_eq!(back.faces().len(), 2223);
        let flipped =
            stl::read(&stl::write_grids(&[body()], "body", true, &|| true).unwrap()).unwrap().mesh;
        let sum = |mesh: &Mesh| -> Vec3 {
            mesh.faces().iter().fold(Vec3::zero(), |sum, face| {
                let [a, b, c, _] = face.map(|v| mesh.positions()[v as usize]);
                sum + (b - a).cross(c - a)
            })
        };
        assert!((sum(&back) + sum(&flipped)).norm() < 1e-9 * sum(&back).norm());
        let mut deep = body();
        deep.size = [30, 20, 2];
        assert!(matches!(
            stl::write_grids(&[deep], "", false, &|| true),
            Err(WriteError::CannotHold { .. })
        ));
    }

    #[test]
    fn surfaces_keep_their_order() {
        let b = body();
        assert_eq!(b.at([59, 19, 0]), b.layer(0)[1199]);
        assert_eq!(b.planes[0][59], 3.0);
        let files = vtk::grid_files(std::slice::from_ref(&b), &["hull".into()], "body").unwrap();
        assert_eq!((files.len(), files[0].name.as_str()), (1, "body.vts"));
        let text = String::from_utf8_lossy(&files[0].bytes).into_owned();
        assert!(text.contains("WholeExtent=\"0 59 0 19 0 0\""));
        assert_eq!(
            vtk::grid_files(&[b.clone(), b], &["hull".into(), "keel".into()], "two").unwrap()[2]
                .name,
            "two-2-keel.vts"
        );
        assert!(matches!(vtk::grid_files(&[], &[], "none"), Err(WriteError::NoGrid { .. })));
    }
}
