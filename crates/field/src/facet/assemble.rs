//! Triangles from blocks: one quadrilateral around every crossed edge.
//!
//! The vertices of the four cells around an edge are in their cells, so the segment between two of
//! them passes through the common face of the cells. The tetrahedra of the edge and each such
//! segment are therefore disjoint from those of every other edge, and triangles inside them cannot
//! intersect others (Ju and Udeshi, Intersection-free contouring on an octree grid, 2006). A
//! diagonal is used only if its triangles are inside; otherwise the polygon is a fan about the
//! crossing.
//!
//! If a cell has several vertices for a piece of surface, the polygons of two neighbouring
//! crossings may use different ones: they then part on the face between the crossings, and the gap
//! there is filled.

use super::cell::{face_edges, start_corner};
use super::grid::Grid;
use super::types::{EdgeCrossing, FacetBlock, SIDE, Several};
use super::vertex::{PlacedVertex, Solver, Surfaces};
use crate::expr::tape::ExprTape;
use crate::set::Leaf;
use moldloft_num::Vec3;
use moldloft_parallel::prelude::*;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// A vertex before it has its number: that of a cell, or one on an edge or a face of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum VertexKey {
    Cell(u32),
    Edge(u64),
    Face(u64),
}

/// Marks a missing or removed vertex.
pub(super) const NO_VERTEX: u32 = u32::MAX;

/// Triangles with the leaf whose surface they approximate.
pub(super) struct Assembled {
    pub(super) positions: Vec<Vec3>,
    pub(super) surfaces: Vec<Surfaces>,
    pub(super) triangles: Vec<(u32, [u32; 3])>,
    /// Vertices of whose triangles nothing is known by construction, ascending, each with its cell.
    pub(super) doubtful: Vec<(u32, [usize; 3])>,
    /// Vertices that are not on all their surfaces, with their cells; no vertex ([`NO_VERTEX`]) where a surface has an edge of its own.
    pub(super) blunt: Vec<(u32, [usize; 3])>,
}

/// Meaning of the vertex numbers in assembled triangles.
pub(super) struct VertexNames {
    /// Number of vertices of cells; they come first.
    count: u32,
    others: Vec<VertexKey>,
}

impl VertexNames {
    pub(super) fn name(&self, v: u32) -> VertexKey {
        match v.checked_sub(self.count) {
            None => VertexKey::Cell(v),
            Some(k) => self.others[k as usize],
        }
    }

    /// The number, if there is that vertex.
    pub(super) fn number(&self, name: VertexKey) -> Option<u32> {
        match name {
            VertexKey::Cell(v) => Some(v),
            _ => Some(self.count + self.others.binary_search(&name).ok()? as u32),
        }
    }
}

/// Overrides of results of single blocks.
#[derive(Default)]
pub(super) struct Changes {
    /// Vertices about which polygons are fans, …
    pub(super) fanned: BTreeSet<u32>,
    /// … those that are elsewhere, …
    pub(super) moved: BTreeMap<u32, (PlacedVertex, Surfaces)>,
    /// … and the first ones of pieces of surface that have no others after all.
    pub(super) merged: BTreeSet<u32>,
}

pub(super) type Corner<'s> = (VertexKey, &'s PlacedVertex, &'s Surfaces);

/// A vertex outside cells, with a cell beside it.
type Extra = (VertexKey, Vec3, Surfaces, [usize; 3]);

#[derive(Default)]
struct AssemblyPart {
    triangles: Vec<(u32, [VertexKey; 3])>,
    extra: Vec<Extra>,
}

pub(super) struct Assembly<'a> {
    pub(super) grid: &'a Grid,
    pub(super) leaves: &'a [Leaf],
    pub(super) blocks: &'a [(Arc<ExprTape<f64>>, Arc<FacetBlock>)],
    at: FxHashMap<[u32; 3], usize>,
    base: Vec<u32>,
    /// Number of vertices of the blocks.
    pub(super) count: u32,
    pub(super) changes: Changes,
}

/// The four cells around an edge, counter-clockwise seen against the axis: 1 if the cell is below
/// the edge along the next axis, and along the one after it.
const ROUND: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];

impl<'a> Assembly<'a> {
    pub(super) fn new(
        grid: &'a Grid,
        leaves: &'a [Leaf],
        blocks: &'a [(Arc<ExprTape<f64>>, Arc<FacetBlock>)],
    ) -> Self {
        let mut base = Vec::with_capacity(blocks.len());
        let mut count = 0u32;
        for (_, block) in blocks {
            base.push(count);
            count += block.vertices.len() as u32;
        }
        let at = blocks.iter().enumerate().map(|(k, (_, b))| (b.at, k)).collect();
        Self { grid, leaves, blocks, at, base, count, changes: Changes::default() }
    }

    /// The block of a vertex and the vertex's index in it.
    pub(super) fn owner(&self, vertex: u32) -> (usize, usize) {
        let owner = self.base.partition_point(|b| *b <= vertex) - 1;
        (owner, (vertex - self.base[owner]) as usize)
    }

    /// The number of a block's vertex.
    pub(super) fn number(&self, owner: usize, vertex: usize) -> u32 {
        self.base[owner] + vertex as u32
    }

    /// Current state of a vertex: its point and surfaces, and whether it is outside its cell.
    pub(super) fn corner(&self, owner: usize, vertex: usize) -> Corner<'_> {
        let number = self.number(owner, vertex);
        if let Some((placed, surfaces)) = self.changes.moved.get(&number) {
            return (VertexKey::Cell(number), placed, surfaces);
        }
        let vertex = &self.blocks[owner].1.vertices[vertex];
        (VertexKey::Cell(number), &vertex.placed, &vertex.surfaces)
    }

    /// True when a piece of surface with several vertices has one only.
    fn merged(&self, owner: usize, cell: [usize; 3], edge: usize) -> bool {
        let plain = || self.number(owner, self.blocks[owner].1.plain(cell, edge));
        !self.changes.merged.is_empty() && self.changes.merged.contains(&plain())
    }

    /// The vertices from that of one crossed edge of a cell to that of another of the same piece.
    fn path(&self, owner: usize, cell: [usize; 3], from: usize, to: usize) -> SmallVec<[usize; 4]> {
        let block = &self.blocks[owner].1;
        if self.merged(owner, cell, from) {
            return SmallVec::from_slice(&[block.plain(cell, from)]);
        }
        block.path(cell, from, to)
    }

    pub(super) fn triangles(&self) -> (Assembled, VertexNames) {
        let Self { blocks, count, .. } = *self;
        let parts: Vec<AssemblyPart> = (0..blocks.len())
            .into_par_iter()
            .map_init(Solver::default, |solver, k| {
                let mut part = AssemblyPart::default();
                for crossing in &blocks[k].1.crossings {
                    self.polygon(k, crossing, solver, &mut part);
                }
                for several in &blocks[k].1.splits {
                    self.gaps(k, several, solver, &mut part);
                }
                part
            })
            .collect();

        let mut positions: Vec<Vec3> = Vec::with_capacity(count as usize);
        let mut surfaces = Vec::with_capacity(count as usize);
        let (mut doubtful, mut blunt) = (Vec::new(), Vec::new());
        for (owner, (_, block)) in blocks.iter().enumerate() {
            for (k, vertex) in block.vertices.iter().enumerate() {
                let cell = || self.cell(owner, vertex.cell);
                if vertex.doubtful {
                    doubtful.push((self.number(owner, k), cell()));
                }
                if vertex.blunt {
                    blunt.push((self.number(owner, k), cell()));
                }
                if vertex.creased {
                    blunt.push((NO_VERTEX, cell()));
                }
                positions.push(vertex.placed.point);
                surfaces.push(vertex.surfaces.clone());
            }
        }
        for (&vertex, (placed, on)) in &self.changes.moved {
            let (owner, k) = self.owner(vertex);
            let before = &blocks[owner].1.vertices[k];
            if on.len() < before.surfaces.len() || self.changes.merged.contains(&vertex) {
                blunt.push((vertex, self.cell(owner, before.cell)));
            }
            positions[vertex as usize] = placed.point;
            surfaces[vertex as usize] = on.clone();
        }
        let mut extra: Vec<&Extra> = parts.iter().flat_map(|p| &p.extra).collect();
        extra.sort_by_key(|e| e.0);
        extra.dedup_by_key(|e| e.0);
        positions.extend(extra.iter().map(|e| e.1));
        surfaces.extend(extra.iter().map(|e| e.2.clone()));
        let number = |name: VertexKey| match name {
            VertexKey::Cell(k) => k,
            _ => count + extra.partition_point(|e| e.0 < name) as u32,
        };
        let triangles = parts.iter().flat_map(|p| &p.triangles).map(|(l, t)| (*l, t.map(number)));
        let triangles = triangles.collect();
        let pinned = extra.iter().enumerate().filter(|(_, e)| matches!(e.0, VertexKey::Face(_)));
        doubtful.extend(pinned.map(|(k, e)| (count + k as u32, e.3)));
        let others = extra.iter().map(|e| e.0).collect();
        let made = Assembled { positions, surfaces, triangles, doubtful, blunt };
        (made, VertexNames { count, others })
    }

    /// The position in the grid of a block's cell.
    pub(super) fn cell(&self, owner: usize, cell: [u8; 3]) -> [usize; 3] {
        let at = self.blocks[owner].1.at;
        [0, 1, 2].map(|i| at[i] as usize * SIDE + cell[i] as usize)
    }

    /// The block of a cell, most often `near`, and the cell's indices in it.
    fn block_of(&self, near: usize, cell: [usize; 3]) -> Option<(usize, [usize; 3])> {
        let at = cell.map(|x| (x / SIDE) as u32);
        let block = if self.blocks[near].1.at == at { near } else { *self.at.get(&at)? };
        Some((block, cell.map(|x| x % SIDE)))
    }

    /// The crossing of the edge along `axis` from lattice position `at`.
    pub(super) fn crossing(
        &self,
        near: usize,
        at: [usize; 3],
        axis: usize,
    ) -> Option<&EdgeCrossing> {
        let (block, local) = self.block_of(near, at)?;
        let key = (local.map(|x| x as u8), axis as u8);
        let list = &self.blocks[block].1.crossings;
        let k = list.partition_point(|c| (c.at, c.axis) < key);
        list.get(k).filter(|c| (c.at, c.axis) == key)
    }

    /// Adds the polygon round a crossed edge.
    fn polygon(
        &self,
        block: usize,
        crossing: &EdgeCrossing,
        solver: &mut Solver,
        part: &mut AssemblyPart,
    ) {
        let a = crossing.axis as usize;
        let (b, c) = ((a + 1) % 3, (a + 2) % 3);
        let origin = self.blocks[block].1.at.map(|x| x as usize * SIDE);
        let at = [0, 1, 2].map(|k| origin[k] + crossing.at[k] as usize);
        let mut cells = [[0; 3]; 4];
        let mut corners = [VertexKey::Cell(0); 4];
        let mut points = [Vec3::zero(); 4];
        let (mut strayed, mut fan) = (false, false);
        for (k, below) in ROUND.iter().enumerate() {
            let mut cell = at;
            cell[b] -= below[0];
            cell[c] -= below[1];
            let edge = 4 * a + below[0] + 2 * below[1];
            // The signs at the edge's ends are the same in all four cells, so each has a vertex.
            let found = self.block_of(block, cell).and_then(|(owner, local)| {
                let vertex = match self.merged(owner, local, edge) {
                    true => self.blocks[owner].1.plain(local, edge),
                    false => self.blocks[owner].1.vertex(local, edge)?,
                };
                Some(self.corner(owner, vertex))
            });
            let Some((name, placed, _)) = found else {
                unreachable!("a cell beside a crossed edge is divided like the edge's own block")
            };
            strayed |= placed.strayed;
            fan |= matches!(name, VertexKey::Cell(v) if self.changes.fanned.contains(&v));
            (cells[k], corners[k], points[k]) = (cell, name, placed.point);
        }
        let mut rim: SmallVec<[VertexKey; 8]> = SmallVec::new();
        for k in 0..4 {
            rim.push(corners[k]);
            rim.extend(self.pin(block, [cells[k], cells[(k + 1) % 4]], at, a, solver, part));
        }
        let turned = !crossing.outward;
        let mut push = |t: [VertexKey; 3]| {
            let t = if turned { [t[0], t[2], t[1]] } else { t };
            part.triangles.push((crossing.leaf, t));
        };
        if rim.len() == 4 && !fan {
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
        let hub = VertexKey::Edge(key(at, a));
        for k in 0..rim.len() {
            push([hub, rim[k], rim[(k + 1) % rim.len()]]);
        }
        part.extra.push((hub, crossing.point, Surfaces::from_slice(&[crossing.leaf]), at));
    }

    /// Fills the gaps on the faces of a cell where the vertices of a piece of surface change.
    fn gaps(&self, block: usize, several: &Several, solver: &mut Solver, part: &mut AssemblyPart) {
        let local = several.cell.map(|x| x as usize);
        let own = &self.blocks[block].1;
        let cell = self.cell(block, several.cell);
        let case = own.case(local);
        for edge in (0..12).filter(|&e| case.loop_of[e] == several.number) {
            let (next, side) = (case.next[edge] as usize, case.side[edge] as usize);
            let here = self.path(block, local, edge, next);
            if here.len() < 2 {
                continue;
            }
            // The same edges as the cell beyond the face has them.
            let (axis, high) = (side / 2, side % 2);
            let mut beyond = cell;
            beyond[axis] = if high == 1 { cell[axis] + 1 } else { cell[axis].wrapping_sub(1) };
            let across = |e: usize| {
                let k = face_edges(axis, high).iter().position(|&x| x == e)?;
                Some(face_edges(axis, 1 - high)[k])
            };
            let found = self.block_of(block, beyond).zip(across(edge).zip(across(next)));
            let Some(((other, there), (from, to))) = found else {
                unreachable!("the face of two crossings has a cell on either side")
            };
            let there = self.path(other, there, from, to);
            // If both cells have several vertices, the lower one fills the gap.
            if there.len() > 1 && high == 0 {
                continue;
            }
            self.gap(
                block,
                [(cell, block, &here), (beyond, other, &there)],
                edge,
                next,
                solver,
                part,
            );
        }
    }

    /// Fills the gap between the polygons round two crossings on the face of two cells, given with the
    /// vertices from the first polygon's to the second's.
    fn gap(
        &self,
        near: usize,
        [(cell, block, here), (beyond, other, there)]: [([usize; 3], usize, &[usize]); 2],
        edge: usize,
        next: usize,
        solver: &mut Solver,
        part: &mut AssemblyPart,
    ) {
        let place = |e: usize| {
            let start = start_corner(e);
            ([0, 1, 2].map(|k| cell[k] + (start >> k & 1)), e / 4)
        };
        let (at, axis) = place(edge);
        let ends = [place(edge), place(next)].map(|(at, axis)| self.crossing(near, at, axis));
        let [Some(p), Some(q)] = ends else { unreachable!("edges of a piece are crossed") };
        // The polygon around the first crossing has this side, or its reverse.
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let turn = |cell: [usize; 3]| {
            ROUND.iter().position(|below| [at[b] - cell[b], at[c] - cell[c]] == *below)
        };
        let (Some(from), Some(to)) = (turn(cell), turn(beyond)) else {
            unreachable!("both cells are beside the edge")
        };
        let turned = ((from + 1) % 4 == to) != p.outward;
        let here: SmallVec<[_; 4]> = here.iter().map(|&k| self.corner(block, k)).collect();
        let there: SmallVec<[_; 4]> = there.iter().map(|&k| self.corner(other, k)).collect();
        let pin = self.pin(near, [cell, beyond], at, axis, solver, part);
        let mut push = |t: [Corner; 3]| {
            let on_all = |leaf: &u32| t.iter().all(|v| v.2.contains(leaf));
            let shared = [p.leaf, q.leaf].into_iter().chain(t[0].2.iter().copied());
            let leaf = shared.into_iter().find(on_all).unwrap_or(p.leaf);
            let t = if turned { [t[0].0, t[2].0, t[1].0] } else { t.map(|v| v.0) };
            part.triangles.push((leaf, t));
        };
        if let Some(pin) = pin {
            let both = Surfaces::from_slice(&[p.leaf, q.leaf]);
            let placed = PlacedVertex { point: p.point, residual: 0.0, strayed: false };
            let pin = (pin, &placed, &both);
            here.windows(2).for_each(|w| push([pin, w[0], w[1]]));
            there.windows(2).for_each(|w| push([pin, w[1], w[0]]));
            return;
        }
        let (mut i, mut j) = (0, 0);
        while i + 1 < here.len() || j + 1 < there.len() {
            let (next_here, next_there) = (here.get(i + 1).copied(), there.get(j + 1).copied());
            let far = |a: Option<Corner>, b: Corner| {
                a.map_or(f64::INFINITY, |a| a.1.point.distance(b.1.point))
            };
            if far(next_here, there[j]) <= far(next_there, here[i]) {
                push([there[j], here[i], here[i + 1]]);
                i += 1;
            } else {
                push([there[j], here[i], there[j + 1]]);
                j += 1;
            }
        }
    }

    /// If the same two pieces of surface cross a common face of two cells twice, the pieces would
    /// share an edge of the mesh twice: a vertex on the face separates the edges.
    fn pin(
        &self,
        near: usize,
        [cell, next]: [[usize; 3]; 2],
        at: [usize; 3],
        axis: usize,
        solver: &mut Solver,
        part: &mut AssemblyPart,
    ) -> Option<VertexKey> {
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
        let PlacedVertex { point, .. } =
            solver.place(self.leaves, &surfaces, middle, &face, self.grid.goal);
        // One number per face and pair: the pair that holds the face's first edge is the first.
        let pair = u64::from(first != 0);
        let name = VertexKey::Face(2 * key(high, normal) + pair);
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
