//! Triangles that show a surface which another primitive cuts off: an edge or corner passes between
//! the corners of cells without a crossing.
//!
//! The centres of triangles and the midpoints of their sides are projected onto their surfaces. The
//! set is zero there, or another primitive decides: then the edge between both passes through the
//! triangle. If, by ranges, a primitive that no corner is on may decide, further points are
//! examined.

use super::assemble::Assembled;
use super::grid::Grid;
use super::refine::Tapes;
use super::types::SIDE;
use super::vertex::{Solver, Surfaces};
use crate::expr::interval::Interval;
use crate::expr::tape::{ExprTape, NO_LEAF, Room};
use crate::set::Leaf;
use moldloft_num::{Box3, Vec3};
use moldloft_parallel::prelude::*;
use rustc_hash::FxHashSet;
use smallvec::SmallVec;

/// Cuts smaller than this fraction of a cell are ignored.
pub(super) const NEAR: f64 = 0.01;
/// Two values are the same when they differ by no more than this part.
const SAME: f64 = 1e-9;
/// Distance from triangles within which their surfaces are searched, in cells.
const MARGIN: f64 = 0.05;
/// A projected point farther than this fraction of a side from its midpoint is not on the surface
/// between.
const AWAY: f64 = 0.5;

/// A sample: its expected surfaces, and its neighbourhood.
struct CutOffSample {
    triangle: u32,
    /// A corner or the side after it, the middle, or a point between: 0 to 2, 3 to 5, 6, 7 and more.
    part: u8,
}

struct CutOffSearch<'a> {
    made: &'a Assembled,
    leaves: &'a [Leaf],
    grid: &'a Grid,
}

/// Reusable memory.
#[derive(Default)]
struct CutOffRoom {
    points: Vec<Vec3>,
    samples: Vec<CutOffSample>,
    seen: FxHashSet<[u32; 2]>,
    values: Vec<f64>,
    own: Vec<f64>,
    room: Room,
    registers: Vec<f64>,
    solver: Solver,
    /// Triangles in whose cells a primitive may decide that no corner is on.
    hidden: FxHashSet<u32>,
    /// Triangles by the positions of their cells in the block.
    placed: Vec<(u16, u32)>,
    cells: Vec<ShownCell>,
    ranges: Vec<Interval>,
}

/// A cell with the surfaces of its triangles' corners.
struct ShownCell {
    /// Its index in the block, the bits of the axes interleaved.
    place: u16,
    around: Box3,
    shown: SmallVec<[u32; 4]>,
    triangles: usize,
}

/// The bits of a cell's index in its block, interleaved.
fn interleaved(local: [usize; 3]) -> u16 {
    let bits = SIDE.ilog2();
    let bit = |b: u32, k: usize| (local[k] >> b & 1) << (3 * b + k as u32);
    (0..bits).flat_map(|b| (0..3).map(move |k| bit(b, k))).sum::<usize>() as u16
}

/// Cells in which another primitive cuts off surfaces of triangles.
pub(super) fn cut_off(
    made: &Assembled,
    grid: &Grid,
    leaves: &[Leaf],
    tapes: &Tapes,
) -> Vec<[usize; 3]> {
    let search = CutOffSearch { made, leaves, grid };
    // The triangles of each block in which several primitives may decide; most have one.
    let mixed = tapes.those(|tape| several(tape) && !tape.has_users());
    let mut of_block: Vec<([u32; 3], u32)> = Vec::new();
    for (t, (_, corners)) in made.triangles.iter().enumerate() {
        let [a, b, c] = corners.map(|v| made.positions[v as usize]);
        let at = grid.block_of((a + b + c) / 3.0);
        if mixed.contains_key(&at) {
            of_block.push((at, t as u32));
        }
    }
    of_block.sort_unstable();
    let blocks: Vec<&[([u32; 3], u32)]> = of_block.chunk_by(|a, b| a.0 == b.0).collect();
    let found: Vec<Vec<[usize; 3]>> = blocks
        .par_iter()
        .map_init(CutOffRoom::default, |scratch, block| {
            search.block(mixed[&block[0].0], block, scratch)
        })
        .collect();
    let mut cells: Vec<[usize; 3]> = found.into_iter().flatten().collect();
    cells.sort_unstable();
    cells.dedup();
    cells
}

/// A triangle folds back when the cosine between it and its surface's normal is less than this.
const BACK: f64 = -0.5;

/// The cells in which triangles fold back: they are in several layers there, which together enclose nothing.
pub(super) fn folded(
    made: &Assembled,
    grid: &Grid,
    leaves: &[Leaf],
    tapes: &Tapes,
) -> Vec<[usize; 3]> {
    // Elsewhere triangles face their surface by construction.
    let mut doubtful = vec![false; made.positions.len()];
    made.doubtful.iter().for_each(|d| doubtful[d.0 as usize] = true);
    let mut solver = Solver::default();
    let mut cells = Vec::new();
    for (leaf, t) in made.triangles.iter().filter(|t| t.1.iter().any(|v| doubtful[*v as usize])) {
        let [a, b, c] = t.map(|v| made.positions[v as usize]);
        let (across, middle) = ((b - a).cross(c - a), (a + b + c) / 3.0);
        let slope = solver.gradient(leaves[*leaf as usize].primitive.tape(), middle).slope;
        if slope.dot(across) < BACK * slope.norm() * across.norm() {
            let cell = grid.cell_of(middle);
            // A surface with an edge of its own keeps it to itself.
            if !tapes.at(middle).creased_in(&grid.cell(cell)) {
                cells.push(cell);
            }
        }
    }
    cells.sort_unstable();
    cells.dedup();
    cells
}

/// True if several primitives may decide.
fn several(tape: &ExprTape<f64>) -> bool {
    let mut shown = tape.leaf.iter().filter(|l| **l != NO_LEAF);
    let first = shown.next();
    shown.any(|l| Some(l) != first)
}

impl CutOffSearch<'_> {
    fn block(
        &self,
        tape: &ExprTape<f64>,
        block: &[([u32; 3], u32)],
        scratch: &mut CutOffRoom,
    ) -> Vec<[usize; 3]> {
        let mut cells = Vec::new();
        self.find_hidden(tape, block, scratch);
        // In the order of the triangles, and so of their leaves.
        let mut rest = block;
        while let Some(&(_, first)) = rest.first() {
            let leaf = self.made.triangles[first as usize].0;
            let same = |x: &([u32; 3], u32)| self.made.triangles[x.1 as usize].0 == leaf;
            let count = rest.iter().position(|x| !same(x)).unwrap_or(rest.len());
            let (own, others) = rest.split_at(count);
            self.leaf(tape, leaf, own, scratch, &mut cells);
            rest = others;
        }
        cells
    }

    /// Finds the triangles in whose cells a primitive may decide that no corner is on.
    fn find_hidden(
        &self,
        tape: &ExprTape<f64>,
        block: &[([u32; 3], u32)],
        scratch: &mut CutOffRoom,
    ) {
        let CutOffRoom { hidden, placed, cells, ranges, .. } = scratch;
        hidden.clear();
        cells.clear();
        placed.clear();
        placed.extend(block.iter().map(|&(_, t)| {
            let middle = place(self.points(t), 6);
            let local = self.grid.cell_of(middle).map(|x| x % SIDE);
            (interleaved(local), t)
        }));
        placed.sort_unstable();
        for triangles in placed.chunk_by(|a, b| a.0 == b.0) {
            let mut cell = ShownCell {
                place: triangles[0].0,
                around: Box3::EMPTY,
                shown: SmallVec::new(),
                triangles: triangles.len(),
            };
            for &(_, t) in triangles {
                let corners = self.made.triangles[t as usize].1;
                for leaf in corners.iter().flat_map(|&v| &self.made.surfaces[v as usize]) {
                    if !cell.shown.contains(leaf) {
                        cell.shown.push(*leaf);
                    }
                }
                cell.around = cell.around.union(Box3::around(self.points(t)));
            }
            cells.push(cell);
        }
        self.open_cells(tape, cells, SIDE.ilog2(), placed, (ranges, hidden));
    }

    /// Halves cells of a block, in the order of their interleaved indices, as long as they may
    /// contain something not shown by all of them.
    fn open_cells(
        &self,
        tape: &ExprTape<f64>,
        cells: &[ShownCell],
        level: u32,
        placed: &[(u16, u32)],
        (ranges, hidden): (&mut Vec<Interval>, &mut FxHashSet<u32>),
    ) {
        let around = cells.iter().map(|c| c.around).fold(Box3::EMPTY, Box3::union);
        // Curved surfaces are beside their triangles.
        let margin = MARGIN * self.grid.step;
        let sides = [0, 1, 2]
            .map(|k| Interval { low: around.low[k] - margin, high: around.high[k] + margin });
        tape.range(&sides, ranges);
        if !tape.may_show_other(ranges, |leaf| cells.iter().all(|c| c.shown.contains(&leaf))) {
            return;
        }
        if level == 0 {
            let own = &placed[..cells[0].triangles];
            hidden.extend(own.iter().map(|p| p.1));
            return;
        }
        let mut placed = placed;
        for half in cells.chunk_by(|a, b| a.place >> (3 * level - 3) == b.place >> (3 * level - 3))
        {
            self.open_cells(tape, half, level - 1, placed, (&mut *ranges, &mut *hidden));
            placed = &placed[half.iter().map(|c| c.triangles).sum()..];
        }
    }

    fn leaf(
        &self,
        tape: &ExprTape<f64>,
        leaf: u32,
        triangles: &[([u32; 3], u32)],
        scratch: &mut CutOffRoom,
        cells: &mut Vec<[usize; 3]>,
    ) {
        let CutOffRoom {
            points, samples, seen, values, own, room, registers, solver, hidden, ..
        } = scratch;
        points.clear();
        samples.clear();
        seen.clear();
        for &(_, triangle) in triangles {
            let p = self.points(triangle);
            let corners = self.made.triangles[triangle as usize].1;
            let parts = if hidden.contains(&triangle) { 7 + BETWEEN.len() } else { 7 };
            for part in 0..parts as u8 {
                // Corners and sides are those of several triangles.
                let key = match part {
                    v @ 0..3 => [corners[v as usize]; 2],
                    k @ 3..6 => ordered(corners[k as usize - 3], corners[(k as usize - 2) % 3]),
                    _ => [0; 2],
                };
                if part >= 6 || seen.insert(key) {
                    points.push(place(p, part));
                    samples.push(CutOffSample { triangle, part });
                }
            }
        }
        values.resize(points.len(), 0.0);
        own.resize(points.len(), 0.0);
        tape.bulk(points, values, room);
        self.leaves[leaf as usize].primitive.tape().bulk(points, own, room);
        for (k, sample) in samples.iter().enumerate() {
            let (v, o) = (values[k].abs(), own[k].abs());
            if (v - o).abs() <= SAME * o {
                continue;
            }
            if let Some(at) = self.cuts(tape, leaf, sample, solver, registers) {
                cells.push(self.grid.cell_of(at));
            }
        }
    }

    fn points(&self, triangle: u32) -> [Vec3; 3] {
        self.made.triangles[triangle as usize].1.map(|v| self.made.positions[v as usize])
    }

    /// Surfaces of a side of a triangle.
    fn on(&self, leaf: u32, [a, b]: [u32; 2]) -> Surfaces {
        let surfaces = &self.made.surfaces;
        let other = |s: &u32| *s != leaf && surfaces[b as usize].contains(s);
        let mut on: Surfaces = surfaces[a as usize].iter().copied().filter(other).collect();
        on.truncate(1);
        on.push(leaf);
        on.sort_unstable();
        on
    }

    /// The sample moved onto its surfaces, if the set is not zero there nor nearby; the sample
    /// itself, if its surface is absent and another one contains all corners.
    fn cuts(
        &self,
        tape: &ExprTape<f64>,
        leaf: u32,
        sample: &CutOffSample,
        solver: &mut Solver,
        registers: &mut Vec<f64>,
    ) -> Option<Vec3> {
        let corners = self.made.triangles[sample.triangle as usize].1;
        let p = self.points(sample.triangle);
        let longest = (0..3).map(|k| p[k].distance(p[(k + 1) % 3])).fold(0.0, f64::max);
        let start = place(p, sample.part);
        let side = |k: usize| [corners[k], corners[(k + 1) % 3]];
        let on = match sample.part {
            v @ 0..3 => self.made.surfaces[corners[v as usize] as usize].clone(),
            k @ 3..6 => self.on(leaf, side(k as usize - 3)),
            _ => Surfaces::from_slice(&[leaf]),
        };
        let put = |solver: &mut Solver, on: &Surfaces, start: Vec3| {
            let away = AWAY * longest;
            let reach = Vec3::of(away, away, away);
            let around = Box3 { low: start - reach, high: start + reach };
            let placed = solver.place(self.leaves, on, start, &around, self.grid.goal);
            (placed.residual <= self.grid.goal).then_some(placed.point)
        };
        let Some(at) = put(solver, &on, start) else {
            // There is nothing of the surface, but of another that all corners are on.
            tape.eval::<f64>(&start, registers);
            let winner = tape.leaf[tape.winner(registers, |v: f64| v)];
            let all = |s: &u32| corners.iter().all(|&v| self.made.surfaces[v as usize].contains(s));
            return (winner != leaf && all(&winner)).then_some(start);
        };
        let value = tape.eval::<f64>(&at, registers);
        let winner = tape.leaf[tape.winner(registers, |v: f64| v)];
        if winner == NO_LEAF || on.contains(&winner) {
            return None;
        }
        let other = solver.gradient(self.leaves[winner as usize].primitive.tape(), at);
        let far = |slack: f64| value.abs() > slack * other.slope.norm();
        let mut slack = NEAR * self.grid.step;
        // Sides that represent an edge deviate from it by this much.
        if sample.part >= 6 && far(slack) {
            for k in 0..3 {
                let middle = (p[k] + p[(k + 1) % 3]) * 0.5;
                if let Some(q) = put(solver, &self.on(leaf, side(k)), middle) {
                    slack = slack.max(NEAR * self.grid.step + q.distance(middle));
                }
            }
        }
        far(slack).then_some(at)
    }
}

fn ordered(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Points of a triangle between its sides, by the weights of its corners in fifths.
const BETWEEN: [[u8; 3]; 3] = [[1, 1, 3], [1, 3, 1], [3, 1, 1]];

/// A corner of a triangle, the middle of a side, the middle of all, or a point between.
fn place(p: [Vec3; 3], part: u8) -> Vec3 {
    match part {
        k @ 0..3 => p[k as usize],
        k @ 3..6 => (p[k as usize - 3] + p[(k as usize - 2) % 3]) * 0.5,
        6 => (p[0] + p[1] + p[2]) / 3.0,
        _ => {
            let [a, b, c] = BETWEEN[part as usize - 7].map(|w| f64::from(w) / 5.0);
            p[0] * a + p[1] * b + p[2] * c
        }
    }
}
