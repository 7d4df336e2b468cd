//! The cells of a mesh of hexahedra as what they are at poles: wedges, pyramids and tetrahedra.

use crate::{HEX_FACES, HexMesh};

/// A cell by its nodes, in the order of VTK's cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoleCell {
    /// Four nodes of a face, counter-clockwise from the opposite face, and those of that.
    Hexahedron([usize; 8]),
    /// A triangle, counter-clockwise from outside, and the nodes opposite.
    Wedge([usize; 6]),
    /// A quadrilateral, counter-clockwise from the apex, and the apex.
    Pyramid([usize; 5]),
    /// A triangle, counter-clockwise from the apex, and the apex.
    Tetrahedron([usize; 4]),
}

impl PoleCell {
    /// The cell that is left of a hexahedron of which nodes coincide; `None` when that is none of these, as with one
    /// edge that has no length.
    ///
    /// # Example
    /// ```
    /// use moldloft_grid::PoleCell;
    ///
    /// // The edges 0-3 and 4-7 have no length.
    /// let wedge = PoleCell::of([0, 1, 2, 0, 4, 5, 6, 4]);
    /// assert_eq!(wedge, Some(PoleCell::Wedge([0, 2, 1, 4, 6, 5])));
    /// assert_eq!(PoleCell::of([0, 1, 2, 0, 4, 5, 6, 7]), None);
    /// ```
    pub fn of(cell: [usize; 8]) -> Option<Self> {
        let mut nodes = cell.to_vec();
        nodes.sort_unstable();
        nodes.dedup();
        if nodes.len() == 8 {
            return Some(Self::Hexahedron(cell));
        }
        // The faces that have an area, outward.
        let faces: Vec<Vec<usize>> = HEX_FACES
            .iter()
            .map(|face| {
                let mut around: Vec<usize> = face.iter().map(|&c| cell[c]).collect();
                around.dedup();
                if around.len() > 1 && around.first() == around.last() {
                    around.pop();
                }
                around
            })
            .filter(|around| around.len() > 2)
            .collect();
        let simple =
            |around: &Vec<usize>| (1..around.len()).all(|k| !around[..k].contains(&around[k]));
        if !faces.iter().all(simple) {
            return None;
        }
        let of = |count: usize| faces.iter().filter(move |around| around.len() == count);
        let apex = |face: &[usize]| nodes.iter().copied().find(|node| !face.contains(node));
        match (nodes.len(), of(3).count(), of(4).count()) {
            (6, 2, 3) => {
                let first = of(3).next()?;
                // The neighbour along a quadrilateral's edge that leaves the triangle.
                let opposite = |node: usize| {
                    of(4).find_map(|around| {
                        let k = around.iter().position(|n| *n == node)?;
                        let beside = [around[(k + 1) % 4], around[(k + 3) % 4]];
                        beside.into_iter().find(|n| !first.contains(n))
                    })
                };
                let [a, b, c] = [first[0], first[1], first[2]];
                Some(Self::Wedge([a, b, c, opposite(a)?, opposite(b)?, opposite(c)?]))
            }
            (5, 4, 1) => {
                let base = of(4).next()?;
                Some(Self::Pyramid([base[3], base[2], base[1], base[0], apex(base)?]))
            }
            (4, 4, 0) => {
                let base = of(3).next()?;
                Some(Self::Tetrahedron([base[2], base[1], base[0], apex(base)?]))
            }
            _ => None,
        }
    }
}

impl HexMesh {
    /// All cells as what they are; `None` when one is none of the four.
    pub fn pole_cells(&self) -> Option<Vec<PoleCell>> {
        self.cells.iter().map(|cell| PoleCell::of(*cell)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use moldloft_num::Vec3;

    /// Six times the volume of a tetrahedron.
    fn six([a, b, c, d]: [Vec3; 4]) -> f64 {
        (b - a).cross(c - a).dot(d - a)
    }

    /// The volume by tetrahedra to the centre, faces outward and cut into triangles at their centres.
    fn volume(points: &[Vec3], faces: &[Vec<usize>]) -> f64 {
        let mut sum = 0.0;
        for face in faces {
            let middle = face.iter().fold(Vec3::zero(), |s, &n| s + points[n]) / face.len() as f64;
            for k in 0..face.len() {
                let (a, b) = (points[face[k]], points[face[(k + 1) % face.len()]]);
                sum += six([Vec3::zero(), a, b, middle]) / 6.0;
            }
        }
        sum
    }

    /// The faces of a cell, outward, by VTK's rules.
    fn faces(cell: PoleCell) -> Vec<Vec<usize>> {
        match cell {
            PoleCell::Hexahedron(n) => {
                HEX_FACES.iter().map(|face| face.iter().map(|&c| n[c]).collect()).collect()
            }
            PoleCell::Wedge([a, b, c, d, e, f]) => {
                vec![
                    vec![a, b, c],
                    vec![d, f, e],
                    vec![a, d, e, b],
                    vec![b, e, f, c],
                    vec![c, f, d, a],
                ]
            }
            PoleCell::Pyramid([a, b, c, d, e]) => {
                vec![vec![d, c, b, a], vec![a, b, e], vec![b, c, e], vec![c, d, e], vec![d, a, e]]
            }
            PoleCell::Tetrahedron([a, b, c, d]) => {
                vec![vec![c, b, a], vec![a, b, d], vec![b, c, d], vec![c, a, d]]
            }
        }
    }

    /// Each edge, each face, and faces with edges of a cube drawn together: what is left has the volume of the
    /// collapsed hexahedron, with its faces outward.
    #[test]
    fn what_is_left_of_a_cube_has_its_volume() {
        let cube: Vec<Vec3> = [
            [0.0, 0.0, 0.0],
            [1.0, 0.1, 0.0],
            [1.2, 1.0, 0.0],
            [0.0, 1.0, 0.1],
            [0.0, 0.1, 1.0],
            [1.0, 0.0, 1.1],
            [1.1, 1.0, 1.0],
            [0.1, 1.0, 1.0],
        ]
        .map(Vec3::from)
        .to_vec();
        let mut kinds = [0; 4];
        for face in HEX_FACES {
            for turn in 0..4 {
                let at = |k: usize| face[(turn + k) % 4];
                let other = HEX_FACES.iter().find(|f| f.iter().all(|c| !face.contains(c))).unwrap();
                let drawn: [Vec<[usize; 2]>; 4] = [
                    vec![],
                    // Two opposite edges of the face: a wedge.
                    vec![[at(0), at(1)], [at(3), at(2)]],
                    // The whole face: a pyramid.
                    vec![[at(0), at(1)], [at(0), at(2)], [at(0), at(3)]],
                    // And an edge of the opposite one: a tetrahedron.
                    vec![
                        [at(0), at(1)],
                        [at(0), at(2)],
                        [at(0), at(3)],
                        [other[turn], other[(turn + 1) % 4]],
                    ],
                ];
                for (kind, pairs) in drawn.iter().enumerate() {
                    let mut cell = [0, 1, 2, 3, 4, 5, 6, 7];
                    for [to, from] in pairs {
                        cell[*from] = cell[*to];
                    }
                    let found = PoleCell::of(cell).unwrap();
                    kinds[kind] += 1;
                    let is = match found {
                        PoleCell::Hexahedron(_) => 0,
                        PoleCell::Wedge(_) => 1,
                        PoleCell::Pyramid(_) => 2,
                        PoleCell::Tetrahedron(_) => 3,
                    };
                    assert_eq!(is, kind, "{cell:?}");
                    let whole: Vec<Vec<usize>> = HEX_FACES
                        .iter()
                        .map(|face| {
                            let mut around: Vec<usize> = face.iter().map(|&c| cell[c]).collect();
                            around.dedup();
                            if around.first() == around.last() {
                                around.pop();
                            }
                            around
                        })
                        .filter(|around| around.len() > 2)
                        .collect();
                    let (a, b) = (volume(&cube, &faces(found)), volume(&cube, &whole));
                    assert!(a > 0.1 && (a - b).abs() < 1e-12, "{found:?} {a} {b}");
                }
            }
        }
        assert_eq!(kinds, [24; 4]);
        assert_eq!(PoleCell::of([0, 0, 2, 3, 4, 5, 6, 7]), None);
    }
}
