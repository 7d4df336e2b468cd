//! Structured blocks of hexahedra that share vertices by number.

use super::{Boundary, Hexahedron, Interface};
use crate::MeshError;
use moldloft_num::{Real, Vec3};

/// A face of a block with the name of a boundary.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BlockFace {
    /// The name of its boundary; several faces may have one name.
    pub name: String,
}

/// One structured block: `size[0] x size[1] x size[2]` vertices along u, v and w.
///
/// Right-handed when X_u . (X_v x X_w) is positive. Its six faces are numbered 0: u = 0, 1: u = 1,
/// 2: v = 0, 3: v = 1, 4: w = 0, 5: w = 1; the parameters of a face are the other two, in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HexBlock {
    /// Its name.
    pub name: String,
    /// Vertices along u, v and w, two or more each.
    pub size: [usize; 3],
    /// Vertex of (i, j, k) at `[(i * size[1] + j) * size[2] + k]`. Vertices are repeated at
    /// collapsed edges and faces.
    pub vertices: Vec<u32>,
    /// The six faces.
    pub faces: [BlockFace; 6],
}

impl HexBlock {
    /// The vertex at (i, j, k).
    #[inline]
    pub fn at(&self, [i, j, k]: [usize; 3]) -> u32 {
        self.vertices[(i * self.size[1] + j) * self.size[2] + k]
    }

    /// Cells along u, v and w.
    pub fn divisions(&self) -> [usize; 3] {
        self.size.map(|n| n - 1)
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.divisions().iter().product()
    }

    /// The corners of cell (i, j, k): u, v, w of corner c are its bits 0, 1 and 2.
    #[inline]
    pub fn cell(&self, [i, j, k]: [usize; 3]) -> [u32; 8] {
        std::array::from_fn(|c| self.at([i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)]))
    }

    /// All cells (i, j, k), k fastest.
    pub fn cells(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [nu, nv, nw] = self.divisions();
        (0..nu).flat_map(move |i| (0..nv).flat_map(move |j| (0..nw).map(move |k| [i, j, k])))
    }

    /// The axes (0: u, 1: v, 2: w) of the parameters of face 0..6, and the axis normal to it last.
    pub fn face_axes(face: usize) -> [usize; 3] {
        match face / 2 {
            0 => [1, 2, 0],
            1 => [0, 2, 1],
            _ => [0, 1, 2],
        }
    }

    /// The indices (i, j, k) of the point (a, b) of face 0..6.
    pub fn on_face(&self, face: usize, [a, b]: [usize; 2]) -> [usize; 3] {
        let [p, q, own] = Self::face_axes(face);
        let mut place = [0; 3];
        place[p] = a;
        place[q] = b;
        place[own] = if face % 2 == 1 { self.size[own] - 1 } else { 0 };
        place
    }

    /// Vertices along the two parameters of face 0..6.
    pub fn face_size(&self, face: usize) -> [usize; 2] {
        let [p, q, _] = Self::face_axes(face);
        [self.size[p], self.size[q]]
    }

    /// The panels of face 0..6, counter-clockwise seen from outside a right-handed block. A panel
    /// with two equal corners is a triangle that repeats its last. Panels without area, on a face
    /// that is a line or a point, are omitted.
    pub fn face_panels(&self, face: usize) -> Vec<[u32; 4]> {
        let [m, n] = self.face_size(face);
        // u x v = w, v x w = u, but u x w = -v.
        let outward = (face % 2 == 1) != (face / 2 == 1);
        let vertex = |a, b| self.at(self.on_face(face, [a, b]));
        let mut panels = Vec::with_capacity((m - 1) * (n - 1));
        for (a, b) in (0..m - 1).flat_map(|a| (0..n - 1).map(move |b| (a, b))) {
            let mut corners =
                vec![vertex(a, b), vertex(a + 1, b), vertex(a + 1, b + 1), vertex(a, b + 1)];
            if !outward {
                corners.reverse();
            }
            corners.dedup();
            if corners.len() > 1 && corners.first() == corners.last() {
                corners.pop();
            }
            match corners[..] {
                [a, b, c, d] if a != c && b != d => panels.push([a, b, c, d]),
                [a, b, c] => panels.push([a, b, c, c]),
                _ => {}
            }
        }
        panels
    }
}

/// Structured blocks that share vertices by identity: a common vertex of two blocks has one number;
/// equal positions alone do not share.
#[derive(Clone, Debug, PartialEq)]
pub struct Blocks<T = f64> {
    positions: Vec<Vec3<T>>,
    blocks: Vec<HexBlock>,
}

impl<T: Real> Blocks<T> {
    /// Blocks over vertices at `positions`.
    ///
    /// # Errors
    /// [`MeshError::BlockShape`] and [`MeshError::UnknownVertex`].
    pub fn new(positions: Vec<Vec3<T>>, blocks: Vec<HexBlock>) -> Result<Self, MeshError> {
        for block in &blocks {
            let [nu, nv, nw] = block.size;
            let expected = nu.checked_mul(nv).and_then(|n| n.checked_mul(nw));
            if block.size.iter().any(|&n| n < 2) || expected != Some(block.vertices.len()) {
                return Err(MeshError::HexShape {
                    block: block.name.clone(),
                    shape: block.size,
                    actual: block.vertices.len(),
                });
            }
            if let Some(&vertex) = block.vertices.iter().find(|&&v| v as usize >= positions.len()) {
                let count = positions.len();
                return Err(MeshError::UnknownVertex { patch: block.name.clone(), vertex, count });
            }
        }
        Ok(Self { positions, blocks })
    }

    /// Positions of the vertices.
    pub fn positions(&self) -> &[Vec3<T>] {
        &self.positions
    }

    /// The blocks.
    pub fn blocks(&self) -> &[HexBlock] {
        &self.blocks
    }

    /// Number of cells in all blocks.
    pub fn cell_count(&self) -> usize {
        self.blocks.iter().map(HexBlock::cell_count).sum()
    }

    /// Cell `cell` of block `block` in space.
    #[inline]
    pub fn cell(&self, block: usize, cell: [usize; 3]) -> Hexahedron<T> {
        Hexahedron(self.blocks[block].cell(cell).map(|v| self.positions[v as usize]))
    }

    /// The volume of a block: the sum over its cells, negative for left-handed ones.
    pub fn block_volume(&self, block: usize) -> T {
        let mut sum = T::zero();
        for cell in self.blocks[block].cells() {
            sum += self.cell(block, cell).volume();
        }
        sum
    }

    /// The volume of all blocks.
    pub fn volume(&self) -> T {
        let mut sum = T::zero();
        for block in 0..self.blocks.len() {
            sum += self.block_volume(block);
        }
        sum
    }

    /// Interfaces of blocks, by the identity of their vertices, ordered by their first sides; and
    /// the parts of faces on the boundary.
    pub fn interfaces(&self) -> (Vec<Interface>, Vec<Boundary>) {
        super::interface::interfaces_of(&self.blocks, 6)
    }

    /// The blocks of real parts.
    pub fn re(&self) -> Blocks<f64> {
        Blocks {
            positions: self.positions.iter().map(|p| p.re()).collect(),
            blocks: self.blocks.clone(),
        }
    }
}
