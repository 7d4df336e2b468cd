//! Removal of intersections: vertices whose triangles cut others are moved to harmless positions.
//!
//! First, vertices are joined differently ([`unfold`]). Then the polygons around them become fans
//! about the crossings of the grid, which are on the surface. Then vertices outside their cells, on
//! an edge that passes beside, return to the cell, onto one surface; pieces of surface with several
//! vertices get one; in cells with several pieces of surface, vertices move to their crossings. The
//! rest is reported as undecided.

use super::assemble::{Assembled, Assembly, NO_VERTEX};
use super::cell::start_corner;
use super::crossing::crossings;
use super::grid::Grid;
use super::place_vertices::{VertexPlacer, nearest};
use super::types::{FacetBlock, Ring};
use super::unfold::{unfold, unfold_again};
use super::vertex::{PlacedVertex, Solver, Surfaces};
use crate::expr::tape::ExprTape;
use crate::set::Leaf;
use moldloft_num::{Box3, Vec3};
use rustc_hash::FxHashSet;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Maximum number of rounds of moves.
const ROUNDS: usize = 16;
/// Number of methods to relocate a vertex: polygons about it become fans, then it moves nearer to
/// its crossings.
const WAYS: u8 = 5;

/// Intersecting pairs of triangles, one of which has a doubtful vertex.
pub(super) fn crossing(
    positions: &[Vec3],
    count: usize,
    corners: impl Fn(usize) -> [u32; 3] + Sync,
    doubtful: &[(u32, [usize; 3])],
) -> Vec<[usize; 2]> {
    if doubtful.is_empty() {
        return Vec::new();
    }
    let mut of_vertex = vec![false; positions.len()];
    doubtful.iter().for_each(|d| of_vertex[d.0 as usize] = true);
    let flagged: Vec<bool> =
        (0..count).map(|f| corners(f).into_iter().any(|v| of_vertex[v as usize])).collect();
    crossings(positions, count, corners, Some(&flagged))
}

/// As [`crossing`], of the triangles within three rings about some vertices of cells.
fn crossing_near(made: &Assembled, about: &FxHashSet<u32>) -> Vec<[usize; 2]> {
    let mut reached = vec![false; made.positions.len()];
    about.iter().for_each(|&v| reached[v as usize] = true);
    let mut near = vec![false; made.triangles.len()];
    for _ in 0..3 {
        for ((_, t), near) in made.triangles.iter().zip(&mut near) {
            *near |= t.iter().any(|&v| reached[v as usize]);
        }
        for ((_, t), _) in made.triangles.iter().zip(&near).filter(|n| *n.1) {
            t.iter().for_each(|&v| reached[v as usize] = true);
        }
    }
    let corners = |f: usize| made.triangles[f].1;
    let mut pairs = crossings(&made.positions, made.triangles.len(), corners, Some(&near));
    let doubtful = |v: u32| made.doubtful.binary_search_by_key(&v, |d| d.0).is_ok();
    pairs.retain(|pair| pair.iter().any(|&f| corners(f).into_iter().any(doubtful)));
    pairs
}

/// The triangles of all blocks, with as few that cut others as can be unless they are to be sharp.
pub(super) fn assembled(
    grid: &Grid,
    leaves: &[Leaf],
    blocks: &[(Arc<ExprTape<f64>>, Arc<FacetBlock>)],
    sharp: bool,
) -> Assembled {
    let mut assembly = Assembly::new(grid, leaves, blocks);
    let mut ways: BTreeMap<u32, u8> = BTreeMap::new();
    let (mut made, mut names) = assembly.triangles();
    // After the first round only triangles near moved vertices, and remaining pairs, are tested.
    let mut changed: Option<FxHashSet<u32>> = None;
    // Different joinings exist in the current triangles only, and are repeated in new ones.
    let mut unfoldings = Vec::new();
    for _ in 0..if sharp { 0 } else { ROUNDS } {
        let corners = |f: usize| made.triangles[f].1;
        let mut pairs = match &changed {
            None => crossing(&made.positions, made.triangles.len(), corners, &made.doubtful),
            Some(changed) => crossing_near(&made, changed),
        };
        if pairs.is_empty() {
            break;
        }
        let unfolding = unfold(&mut made, &names, grid, leaves, &pairs, &mut unfoldings);
        if let Some(touched) = unfolding {
            pairs = crossing_near(&made, &touched);
            if pairs.is_empty() {
                break;
            }
        }
        let corners = |f: usize| made.triangles[f].1;
        let cut = pairs.iter().flatten().flat_map(|&f| corners(f));
        let mut near: FxHashSet<u32> = cut.filter(|v| *v < assembly.count).collect();
        let doubtful =
            |v: &u32| *v < assembly.count && made.doubtful.binary_search_by_key(v, |d| d.0).is_ok();
        // From each pair the vertex that is farthest from its crossings: the others need not move.
        let mut chosen: Vec<u32> = Vec::new();
        for pair in pairs {
            let all = pair.into_iter().flat_map(corners).filter(doubtful);
            let all = all.filter(|v| ways.get(v).is_none_or(|w| *w < WAYS));
            let farthest = all
                .map(|v| (assembly.away(v, made.positions[v as usize]), v))
                .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
            chosen.extend(farthest.map(|f| f.1));
        }
        if chosen.is_empty() {
            break;
        }
        chosen.sort_unstable();
        chosen.dedup();
        let mut solver = Solver::default();
        let mut moved = FxHashSet::default();
        for vertex in chosen {
            moved.insert(vertex);
            let way = ways.entry(vertex).or_insert(0);
            *way += 1;
            if *way == 1 {
                assembly.changes.fanned.insert(vertex);
            } else if let Some(way) = assembly.way(vertex, *way, &mut solver) {
                if way.several {
                    assembly.changes.merged.insert(way.vertex);
                }
                moved.insert(way.vertex);
                assembly.changes.moved.insert(way.vertex, way.place);
            }
        }
        near.extend(&moved);
        (made, names) = assembly.triangles();
        near.extend(unfold_again(&mut made, &names, grid, leaves, &mut unfoldings, &moved));
        changed = Some(near);
    }
    if !assembly.changes.merged.is_empty() || !unfoldings.is_empty() {
        made.compact();
    }
    made
}

/// New position of a vertex.
struct VertexMove {
    vertex: u32,
    /// True when it was one of several of its piece of surface.
    several: bool,
    place: (PlacedVertex, Surfaces),
}

impl Assembly<'_> {
    /// The crossings of a vertex's piece of surface.
    fn ring(&self, vertex: u32) -> Option<Ring<'_>> {
        let (owner, k) = self.owner(vertex);
        let block = &self.blocks[owner].1;
        let cell = self.cell(owner, block.vertices[k].cell);
        let case = block.case(block.vertices[k].cell.map(|x| x as usize));
        let number = block.piece(k);
        let mut ring = Ring::new();
        for edge in (0..12).filter(|&e| case.loop_of[e] == number) {
            let start = start_corner(edge);
            let at = [0, 1, 2].map(|i| cell[i] + (start >> i & 1));
            ring.push((edge, self.crossing(owner, at, edge / 4)?));
        }
        Some(ring)
    }

    /// Distance of a vertex from the box around its crossings.
    fn away(&self, vertex: u32, at: Vec3) -> f64 {
        let Some(ring) = self.ring(vertex) else { return 0.0 };
        let around = Box3::around(ring.iter().map(|e| e.1.point));
        (0..3)
            .map(|k| (around.low[k] - at[k]).max(at[k] - around.high[k]).max(0.0).powi(2))
            .sum::<f64>()
            .sqrt()
    }

    /// New position of a vertex by method `way`: nearest point on a surface in its cell, elsewhere
    /// there, on a surface between its crossings, at a crossing. A piece of surface with several
    /// vertices keeps the first.
    fn way(&self, vertex: u32, way: u8, solver: &mut Solver) -> Option<VertexMove> {
        let (owner, k) = self.owner(vertex);
        let (tape, block) = &self.blocks[owner];
        let local = block.vertices[k].cell.map(|x| x as usize);
        let cell = self.cell(owner, block.vertices[k].cell);
        let (number, ring) = (block.piece(k), self.ring(vertex)?);
        let edge = ring.first()?.0;
        let sides = self.grid.cell(cell);
        let mut placement = VertexPlacer {
            tape,
            leaves: self.leaves,
            cell: &sides,
            goal: self.grid.goal,
            solver,
            registers: &mut Vec::new(),
        };
        let place = match way {
            2 => placement.near(&ring, self.corner(owner, k).1.point),
            3 => placement.flat(&ring, sides),
            4 => {
                let between = Box3::around(ring.iter().map(|e| e.1.point));
                placement.flat(&ring, between)
            }
            _ => nearest(&ring),
        };
        let vertex = self.number(owner, block.plain(local, edge));
        Some(VertexMove { vertex, several: block.has_several(local, number), place })
    }
}

impl Assembled {
    /// Leaves out the vertices that no triangle has.
    pub(super) fn compact(&mut self) {
        let mut number = vec![u32::MAX; self.positions.len()];
        self.triangles.iter().flat_map(|t| t.1).for_each(|v| number[v as usize] = 0);
        for (place, count) in number.iter_mut().filter(|n| **n == 0).zip(0..) {
            *place = count;
        }
        let kept = |v: usize| number[v] != u32::MAX;
        let mut k = 0;
        self.positions.retain(|_| {
            k += 1;
            kept(k - 1)
        });
        let mut k = 0;
        self.surfaces.retain(|_| {
            k += 1;
            kept(k - 1)
        });
        for (_, t) in &mut self.triangles {
            *t = t.map(|v| number[v as usize]);
        }
        // A vertex that represented a cut edge does so after the merge.
        for (v, _) in self.blunt.iter_mut().filter(|b| b.0 != NO_VERTEX) {
            *v = number[*v as usize];
        }
        self.doubtful.retain(|d| kept(d.0 as usize));
        self.doubtful.iter_mut().for_each(|d| d.0 = number[d.0 as usize]);
    }
}
