//! Classification of collapsed hexahedra at poles: wedges, pyramids and tetrahedra.

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
    /// The cell that a hexahedron with coincident nodes collapses to; `None` for other shapes, as
    /// with one edge without length.
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
    /// All cells, classified; `None` if one is of another shape.
    pub fn pole_cells(&self) -> Option<Vec<PoleCell>> {
        self.cells.iter().map(|cell| PoleCell::of(*cell)).collect()
    }
}
