//! Data passed between the steps: options, crossings, vertices of cells and blocks. Data and
//! look-ups only, so that the steps depend on these types and not on each other.

use super::cell::{Case, NONE, case};
use super::vertex::{PlacedVertex, Surfaces};
use crate::expr::tape::ExprTape;
use crate::set::Leaf;
use moldloft_budget::Budget;
use moldloft_num::{Box3, Vec3};
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::sync::Arc;

/// Resolution of facets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// Cells of side (longest side of the box) / 2^depth.
    Depth(u32),
    /// As `Depth`, but no coarser than the thinnest side of the box at level 5, half of it at 6 and
    /// so on.
    Level(u32),
    /// Maximum distance of triangle centres from the surface: estimated by |f| / |f'| and reached
    /// by refinement, not proved.
    Accuracy(f64),
}

/// Options of facets.
#[derive(Clone, Debug)]
pub struct FacetOptions {
    /// Resolution.
    pub resolution: Resolution,
    /// Maximum number of cells that the surface passes through.
    pub limit: f64,
    /// Keeps vertices on edges and corners even if triangles then intersect: this does not affect
    /// integrals over the body, which cut-off edges would make less accurate.
    pub sharp: bool,
    /// Limits of memory and time.
    pub budget: Arc<Budget>,
}

impl FacetOptions {
    /// Options for a resolution, with at most 20 million cells.
    pub fn new(resolution: Resolution) -> Self {
        Self { resolution, limit: 2e7, sharp: false, budget: Arc::default() }
    }
}

/// Cells along a side.
pub(super) const SIDE: usize = 8;
/// A crossing of the surface and an edge of the grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct EdgeCrossing {
    /// Lattice position of the edge's start, within the block.
    pub(super) at: [u8; 3],
    pub(super) axis: u8,
    /// True if the edge points from solid to air.
    pub(super) outward: bool,
    /// The leaf that decides there.
    pub(super) leaf: u32,
    pub(super) point: Vec3,
}

/// The vertex of a piece of surface in a cell.
#[derive(Clone, Debug)]
pub(super) struct CellVertex {
    pub(super) placed: PlacedVertex,
    /// The cell, in the block.
    pub(super) cell: [u8; 3],
    /// True when the cell has several vertices, or its vertex is not in it: nothing is known of its triangles
    /// then.
    pub(super) doubtful: bool,
    /// True when it is not on all the surfaces that the crossings show.
    pub(super) blunt: bool,
    /// True when one of its surfaces has an edge of its own in the cell.
    pub(super) creased: bool,
    pub(super) surfaces: Surfaces,
}

/// A region that the corners of cells do not resolve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unresolved {
    /// A cell, or a part of one.
    pub place: Box3,
    /// Proved bound on the volume of solid hidden in air, or of air hidden in solid.
    pub volume: f64,
    /// True if a feature is certainly missed: a wall or gap thinner than the cell.
    pub missed: bool,
    /// A point of it, …
    pub(super) witness: Vec3,
    /// … and whether it is solid.
    pub(super) solid: bool,
}

#[derive(Clone, Debug)]
pub(super) struct FacetBlock {
    /// Position in blocks.
    pub(super) at: [u32; 3],
    /// Signs of every cell's corners.
    pub(super) signs: Box<[u8; SIDE * SIDE * SIDE]>,
    /// Its ambiguous faces whose middle is solid.
    pub(super) joins: Box<[u8; SIDE * SIDE * SIDE]>,
    /// First vertex of every cell.
    pub(super) first: Box<[u32; SIDE * SIDE * SIDE]>,
    pub(super) vertices: Vec<CellVertex>,
    /// The pieces of surface that have several vertices, in the order of cells.
    pub(super) splits: Vec<Several>,
    /// Crossings of the edges that start in the block, its far faces excepted.
    pub(super) crossings: Vec<EdgeCrossing>,
    /// Number of cells that the surface passes through.
    pub(super) active: usize,
    /// Regions not determined by the corners of cells.
    pub(super) unresolved: Vec<Unresolved>,
}

/// A piece of surface with several vertices.
#[derive(Clone, Debug)]
pub(super) struct Several {
    /// The cell, in the block, …
    pub(super) cell: [u8; 3],
    /// … and which of its pieces.
    pub(super) number: u8,
    /// Index of its second vertex.
    pub(super) more: u32,
    pub(super) split: Split,
}

/// The crossings of a piece of surface, with their edges.
pub(super) type Ring<'c> = SmallVec<[(usize, &'c EdgeCrossing); 12]>;

/// The vertices of a piece of surface and their connections.
#[derive(Clone, Debug)]
pub(super) struct Split {
    pub(super) vertices: SmallVec<[(PlacedVertex, Surfaces); 2]>,
    /// The vertex of each crossed edge.
    pub(super) group: [u8; 12],
    /// The tree of vertices: the one towards the first, which is its own.
    pub(super) parent: SmallVec<[u8; 2]>,
}

impl Split {
    /// The vertices from that of one edge to that of another.
    pub(super) fn path(&self, from: usize, to: usize) -> SmallVec<[u8; 4]> {
        let up = |k: usize| {
            let mut way: SmallVec<[u8; 4]> = SmallVec::from_slice(&[self.group[k]]);
            while let Some(&last) = way.last() {
                let parent = self.parent[last as usize];
                if parent == last {
                    break;
                }
                way.push(parent);
            }
            way
        };
        let (mut here, mut there) = (up(from), up(to));
        // Both paths end at the first vertex; the last common vertex is where they part.
        let mut meeting = 0;
        while let (Some(&a), Some(&b)) = (here.last(), there.last()) {
            if a != b {
                break;
            }
            meeting = a;
            here.pop();
            there.pop();
        }
        here.push(meeting);
        here.extend(there.into_iter().rev());
        here
    }
}

pub(super) fn cell_index(c: [usize; 3]) -> usize {
    (c[0] * SIDE + c[1]) * SIDE + c[2]
}

impl Several {
    /// The number of the vertex of a group; `plain` is that of the first.
    fn vertex(&self, plain: usize, group: u8) -> usize {
        if group == 0 { plain } else { self.more as usize + group as usize - 1 }
    }
}

impl FacetBlock {
    /// True when the surface cuts off the first corner of the ambiguous face on a cell's low side.
    pub(super) fn first_apart(&self, cell: [usize; 3], axis: usize) -> bool {
        let k = cell_index(cell);
        (self.signs[k] & 1 == 1) != (self.joins[k] >> (2 * axis) & 1 == 1)
    }

    pub(super) fn case(&self, cell: [usize; 3]) -> &'static Case {
        case(self.signs[cell_index(cell)], self.joins[cell_index(cell)])
    }

    /// The vertex in `cell` of the piece that crosses `edge`.
    pub(super) fn vertex(&self, cell: [usize; 3], edge: usize) -> Option<usize> {
        let number = self.case(cell).loop_of[edge];
        if number == NONE {
            return None;
        }
        let plain = self.plain(cell, edge);
        Some(match self.several(cell, number) {
            None => plain,
            Some(several) => several.vertex(plain, several.split.group[edge]),
        })
    }

    /// The first vertex in `cell` of the piece that crosses `edge`.
    pub(super) fn plain(&self, cell: [usize; 3], edge: usize) -> usize {
        self.first[cell_index(cell)] as usize + self.case(cell).loop_of[edge] as usize
    }

    /// The piece of surface that a vertex represents, by its number in the cell.
    pub(super) fn piece(&self, vertex: usize) -> u8 {
        let cell = self.vertices[vertex].cell;
        let number = vertex - self.first[cell_index(cell.map(|x| x as usize))] as usize;
        let later = || {
            let mut own = self.splits.iter().rev().filter(|s| s.cell == cell);
            own.find(|s| s.more as usize <= vertex).map_or(0, |s| s.number)
        };
        let loops = self.case(cell.map(|x| x as usize)).loops as usize;
        if number < loops { number as u8 } else { later() }
    }

    /// True when a piece of surface in `cell` has several vertices.
    pub(super) fn has_several(&self, cell: [usize; 3], number: u8) -> bool {
        self.several(cell, number).is_some()
    }

    /// A piece of surface in `cell`, if it has several vertices.
    fn several(&self, cell: [usize; 3], number: u8) -> Option<&Several> {
        if self.splits.is_empty() {
            return None;
        }
        let key = (cell.map(|x| x as u8), number);
        let k = self.splits.binary_search_by_key(&key, |s| (s.cell, s.number)).ok()?;
        Some(&self.splits[k])
    }

    /// The vertices from that of one crossed edge of `cell` to that of another of the same piece.
    pub(super) fn path(&self, cell: [usize; 3], from: usize, to: usize) -> SmallVec<[usize; 4]> {
        let (number, plain) = (self.case(cell).loop_of[from], self.plain(cell, from));
        match self.several(cell, number) {
            None => SmallVec::from_slice(&[plain]),
            Some(several) => {
                let path = several.split.path(from, to);
                path.into_iter().map(|k| several.vertex(plain, k)).collect()
            }
        }
    }
}

/// Blocks of an earlier division by position.
pub(super) struct Reuse<'a> {
    pub(super) blocks: FxHashMap<[u32; 3], &'a (Arc<ExprTape<f64>>, Arc<FacetBlock>)>,
}

impl Reuse<'_> {
    /// The old block, if the set was the same there.
    pub(super) fn get(&self, at: [u32; 3], tape: &ExprTape<f64>) -> Option<Arc<FacetBlock>> {
        let (old, block) = self.blocks.get(&at)?;
        (old.leaf == tape.leaf && old.same(tape)).then(|| block.clone())
    }
}

/// Triangles as they are given.
pub(crate) struct TriangleView<'a> {
    pub positions: &'a [Vec3],
    pub faces: &'a [[u32; 4]],
    /// Numbers of leaves, ascending ranges of faces.
    pub patches: Vec<(u32, std::ops::Range<usize>)>,
    pub leaves: &'a [Leaf],
    /// Leaves of each vertex.
    pub surfaces: &'a [SmallVec<[u32; 3]>],
}

/// Leaves of each of some points.
#[derive(Clone, Debug, Default)]
pub struct LeafIncidence {
    /// The leaves.
    pub leaves: Vec<Leaf>,
    /// For each point, indices of leaves.
    pub surfaces: Vec<SmallVec<[u32; 3]>>,
}
