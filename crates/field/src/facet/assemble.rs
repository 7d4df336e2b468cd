//! From blocks to triangles: one quadrilateral round every crossed edge.
//!
//! The vertices of the four cells round an edge lie in their cells, so the segment between two of them
//! passes through the face that the cells share. The tetrahedra of the edge and each such segment are
//! therefore disjoint from those of every other edge, and triangles inside them cannot meet others
//! (Ju and Udeshi, Intersection-free contouring on an octree grid, 2006). A diagonal is used only if
//! its triangles lie inside; otherwise the polygon is a fan about the crossing.

use super::block::{Block, Crossing, SIDE};
use super::cell::{face_edges, start_corner};
use super::grid::Grid;
use super::vertex::{Placed, Solver, Surfaces};
use crate::set::Leaf;
use crate::tape::Tape;
use moldloft_num::Vec3;
use rayon::prelude::*;
use smallvec::SmallVec;
use std::collections::HashMap;
use std::sync::Arc;

/// A vertex before it has its number: that of a cell, or one on an edge or a face of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Name {
    Cell(u32),
    Edge(u64),
    Face(u64),
}

/// Triangles with the leaf whose surface they approximate.
pub(super) struct Assembled {
    pub(super) positions: Vec<Vec3>,
    pub(super) surfaces: Vec<Surfaces>,
    pub(super) triangles: Vec<(u32, [u32; 3])>,
    /// Vertices of whose triangles nothing is known by construction, ascending, each with its cell.
    pub(super) doubtful: Vec<(u32, [usize; 3])>,
}

/// A vertex outside cells, with a cell beside it.
type Extra = (Name, Vec3, Surfaces, [usize; 3]);

#[derive(Default)]
struct Part {
    triangles: Vec<(u32, [Name; 3])>,
    extra: Vec<Extra>,
}

struct Assembly<'a> {
    grid: &'a Grid,
    leaves: &'a [Leaf],
    blocks: &'a [(Arc<Tape<f64>>, Arc<Block>)],
    at: HashMap<[u32; 3], usize>,
    base: Vec<u32>,
}

/// The four cells round an edge, counter-clockwise seen against the axis: which lie below the edge
/// along the next axis and the one after it.
const ROUND: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];

pub(super) fn assemble(
    grid: &Grid,
    leaves: &[Leaf],
    blocks: &[(Arc<Tape<f64>>, Arc<Block>)],
) -> Assembled {
    let mut base = Vec::with_capacity(blocks.len());
    let mut count = 0u32;
    for (_, block) in blocks {
        base.push(count);
        count += block.vertices.len() as u32;
    }
    let at = blocks.iter().enumerate().map(|(k, (_, b))| (b.at, k)).collect();
    let assembly = Assembly { grid, leaves, blocks, at, base };
    let parts: Vec<Part> = (0..blocks.len())
        .into_par_iter()
        .map_init(Solver::default, |solver, k| {
            let mut part = Part::default();
            for crossing in &blocks[k].1.crossings {
                assembly.polygon(k, crossing, solver, &mut part);
            }
            part
        })
        .collect();

    let mut positions: Vec<Vec3> = Vec::with_capacity(count as usize);
    let mut surfaces = Vec::with_capacity(count as usize);
    for (_, block) in blocks {
        positions.extend(block.vertices.iter().map(|v| v.placed.point));
        surfaces.extend(block.vertices.iter().map(|v| v.surfaces.clone()));
    }
    let mut extra: Vec<&Extra> = parts.iter().flat_map(|p| &p.extra).collect();
    extra.sort_by_key(|e| e.0);
    extra.dedup_by_key(|e| e.0);
    positions.extend(extra.iter().map(|e| e.1));
    surfaces.extend(extra.iter().map(|e| e.2.clone()));
    let number = |name: Name| match name {
        Name::Cell(k) => k,
        _ => count + extra.partition_point(|e| e.0 < name) as u32,
    };
    let triangles = parts.iter().flat_map(|p| &p.triangles).map(|(l, t)| (*l, t.map(number)));
    let triangles = triangles.collect();
    let mut doubtful = Vec::new();
    for ((_, block), base) in blocks.iter().zip(&assembly.base) {
        for (k, vertex) in block.vertices.iter().enumerate().filter(|v| v.1.doubtful) {
            let cell = [0, 1, 2].map(|i| block.at[i] as usize * SIDE + vertex.cell[i] as usize);
            doubtful.push((base + k as u32, cell));
        }
    }
    let pinned = extra.iter().enumerate().filter(|(_, e)| matches!(e.0, Name::Face(_)));
    doubtful.extend(pinned.map(|(k, e)| (count + k as u32, e.3)));
    Assembled { positions, surfaces, triangles, doubtful }
}

impl Assembly<'_> {
    /// The block of a cell, most often `near`, and the cell's place in it.
    fn block_of(&self, near: usize, cell: [usize; 3]) -> Option<(usize, [usize; 3])> {
        let at = cell.map(|x| (x / SIDE) as u32);
        let block = if self.blocks[near].1.at == at { near } else { *self.at.get(&at)? };
        Some((block, cell.map(|x| x % SIDE)))
    }

    /// The crossing of the edge along `axis` from lattice position `at`.
    fn crossing(&self, near: usize, at: [usize; 3], axis: usize) -> Option<&Crossing> {
        let (block, local) = self.block_of(near, at)?;
        let key = (local.map(|x| x as u8), axis as u8);
        let list = &self.blocks[block].1.crossings;
        let k = list.partition_point(|c| (c.at, c.axis) < key);
        list.get(k).filter(|c| (c.at, c.axis) == key)
    }

    /// Adds the polygon round a crossed edge.
    fn polygon(&self, block: usize, crossing: &Crossing, solver: &mut Solver, part: &mut Part) {
        let a = crossing.axis as usize;
        let (b, c) = ((a + 1) % 3, (a + 2) % 3);
        let origin = self.blocks[block].1.at.map(|x| x as usize * SIDE);
        let at = [0, 1, 2].map(|k| origin[k] + crossing.at[k] as usize);
        let mut cells = [[0; 3]; 4];
        let mut corners = [Name::Cell(0); 4];
        let mut points = [Vec3::zero(); 4];
        let mut strayed = false;
        for (k, below) in ROUND.iter().enumerate() {
            let mut cell = at;
            cell[b] -= below[0];
            cell[c] -= below[1];
            let edge = 4 * a + below[0] + 2 * below[1];
            // The signs at the edge's ends are the same in all four cells, so each has a vertex.
            let found = self.block_of(block, cell).and_then(|(owner, local)| {
                let vertex = self.blocks[owner].1.vertex(local, edge)?;
                let placed = &self.blocks[owner].1.vertices[vertex].placed;
                strayed |= placed.strayed;
                Some((self.base[owner] + vertex as u32, placed.point))
            });
            let Some((vertex, point)) = found else {
                unreachable!("a cell beside a crossed edge is divided like the edge's own block")
            };
            (cells[k], corners[k], points[k]) = (cell, Name::Cell(vertex), point);
        }
        let mut rim: SmallVec<[Name; 8]> = SmallVec::new();
        for k in 0..4 {
            rim.push(corners[k]);
            rim.extend(self.pin(block, [cells[k], cells[(k + 1) % 4]], at, a, solver, part));
        }
        let turned = !crossing.outward;
        let mut push = |t: [Name; 3]| {
            let t = if turned { [t[0], t[2], t[1]] } else { t };
            part.triangles.push((crossing.leaf, t));
        };
        if rim.len() == 4 {
            let tape = self.leaves[crossing.leaf as usize].primitive.tape();
            let edge = [self.grid.corner(at), {
                let mut end = at;
                end[a] += 1;
                self.grid.corner(end)
            }];
            let bulge = |p: Vec3| solver.value(tape, p).abs();
            let first =
                if strayed { Some(flatter(&points)) } else { diagonal(&points, &edge, a, bulge) };
            if let Some(first) = first {
                let [p, q, r, s] = [0, 1, 2, 3].map(|k| corners[(first + k) % 4]);
                push([p, q, r]);
                push([p, r, s]);
                return;
            }
        }
        let hub = Name::Edge(key(at, a));
        for k in 0..rim.len() {
            push([hub, rim[k], rim[(k + 1) % rim.len()]]);
        }
        part.extra.push((hub, crossing.point, Surfaces::from_slice(&[crossing.leaf]), at));
    }

    /// Where two cells share a face that the same two pieces of surface cross twice, the pieces would
    /// share an edge of the mesh twice: a vertex on the face keeps the edges apart.
    fn pin(
        &self,
        near: usize,
        [cell, next]: [[usize; 3]; 2],
        at: [usize; 3],
        axis: usize,
        solver: &mut Solver,
        part: &mut Part,
    ) -> Option<Name> {
        let normal = (0..3).find(|&k| cell[k] != next[k])?;
        let (low, high) = if cell[normal] < next[normal] { (cell, next) } else { (next, cell) };
        let same_loop = |cell: [usize; 3], side: usize| {
            let (block, local) = self.block_of(near, cell)?;
            let case = self.blocks[block].1.case(local);
            if !case.ambiguous[2 * normal + side] {
                return None;
            }
            let edges = face_edges(normal, side);
            let loops = edges.map(|e| case.loop_of[e]);
            loops.iter().all(|l| *l == loops[0]).then_some(())
        };
        same_loop(low, 1)?;
        same_loop(high, 0)?;
        // The face is the low side of the high cell. Its edges as lattice positions, in order.
        let edges = face_edges(normal, 0).map(|e| {
            let start = start_corner(e);
            ([0, 1, 2].map(|k| high[k] + (start >> k & 1)), e / 4)
        });
        let (block, local) = self.block_of(near, high)?;
        let apart = self.blocks[block].1.first_apart(local, normal);
        let partner = |k: usize| if apart == (k % 2 == 1) { (k + 1) % 4 } else { (k + 3) % 4 };
        let mine = edges.iter().position(|&(p, a)| p == at && a == axis)?;
        let other = partner(mine);
        let (first, second) = (mine.min(other), mine.max(other));
        let ends = [first, second].map(|k| self.crossing(near, edges[k].0, edges[k].1));
        let [Some(p), Some(q)] = ends else { return None };
        let mut surfaces = Surfaces::from_slice(&[p.leaf, q.leaf]);
        surfaces.sort_unstable();
        surfaces.dedup();
        let mut face = self.grid.cell(high);
        let mut flat = face.high.to_array();
        flat[normal] = face.low[normal];
        face.high = flat.into();
        let middle = (p.point + q.point) * 0.5;
        let Placed { point, .. } =
            solver.place(self.leaves, &surfaces, middle, &face, self.grid.goal);
        // One number per face and pair: the pair that holds the face's first edge is the first.
        let pair = u64::from(first != 0);
        let name = Name::Face(2 * key(high, normal) + pair);
        part.extra.push((name, point, surfaces, high));
        Some(name)
    }
}

/// A number for the edge or face along `axis` at a lattice position below 2^19.
fn key(at: [usize; 3], axis: usize) -> u64 {
    let [x, y, z] = at.map(|x| x as u64);
    (((x << 19 | y) << 19) | z) * 3 + axis as u64
}

/// The corner from which a diagonal may run so that both triangles stay inside the tetrahedra of the
/// edge, `None` when neither may. When both may, that whose middle is nearer to the surface by `bulge`,
/// which halves the error on cylinders; on planes the shorter.
fn diagonal(
    points: &[Vec3; 4],
    edge: &[Vec3; 2],
    axis: usize,
    mut bulge: impl FnMut(Vec3) -> f64,
) -> Option<usize> {
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    let (low, high) = (edge[0][axis], edge[1][axis]);
    // Coordinates across and along the edge, from the edge.
    let u = points.map(|p| [p[b] - edge[0][b], p[c] - edge[0][c], p[axis]]);
    let cross = |p: [f64; 3], q: [f64; 3]| p[0] * q[1] - p[1] * q[0];
    let fits = |from: usize| {
        let (p, r) = (u[from], u[from + 2]);
        let turn = cross(p, r);
        if turn == 0.0 {
            return true;
        }
        // The edge pierces one triangle; the other has its tip at the corner on the far side. There the
        // diagonal must cross the triangle of the edge and that corner.
        let tip = if turn > 0.0 { u[from + 1] } else { u[(from + 3) % 4] };
        // p + s (r - p) = t tip across the edge.
        let d = [r[0] - p[0], r[1] - p[1], r[2] - p[2]];
        let det = cross(tip, d);
        if det == 0.0 {
            return false;
        }
        let (s, t) = (cross(p, tip) / det, cross(p, d) / det);
        let along = p[2] + s * d[2];
        (0.0..=1.0).contains(&t)
            && along >= low + t * (tip[2] - low)
            && along <= high - t * (high - tip[2])
    };
    let length = |k: usize| (points[k] - points[k + 2]).norm_sq();
    match (fits(0), fits(1)) {
        (true, true) => {
            let [p, q] = [0, 1].map(|k| bulge((points[k] + points[k + 2]) * 0.5));
            let flat = (p - q).abs() <= 1e-6 * (p + q) || p.max(q) < 1e-12;
            Some(usize::from(if flat { length(1) < length(0) } else { q < p }))
        }
        (true, false) => Some(0),
        (false, true) => Some(1),
        (false, false) => None,
    }
}

/// The corner from which a diagonal folds the quadrilateral less.
fn flatter(points: &[Vec3; 4]) -> usize {
    let fold = |k: usize| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| points[(k + i) % 4]);
        let (n, m) = ((b - a).cross(c - a), (c - a).cross(d - a));
        let size = n.norm() * m.norm();
        if size > 0.0 { n.dot(m) / size } else { 1.0 }
    };
    usize::from(fold(1) > fold(0))
}
