//! Eight by eight by eight cells: signs at the corners, crossings of the edges, vertices.

use super::cell::{case, face_edges, start_corner};
use super::grid::Grid;
use super::place_vertices::{PieceVertices, VertexPlacer};
use super::types::{CellVertex, EdgeCrossing, FacetBlock, Ring, SIDE, Several, cell_index};
use super::unresolved::Quiet;
use super::vertex::{PlacedVertex, Solver, Surfaces};
use crate::expr::tape::{ExprTape, Room};
use crate::measure::taylor::TaylorRoom;
use crate::set::Leaf;
use moldloft_num::{Box3, Vec3};
use smallvec::SmallVec;
use std::sync::Arc;

pub(super) const CORNERS: usize = SIDE + 1;

fn corner_index(c: [usize; 3]) -> usize {
    (c[0] * CORNERS + c[1]) * CORNERS + c[2]
}

/// Reusable memory.
#[derive(Default)]
pub(super) struct Scratch {
    points: Vec<Vec3>,
    values: Vec<f64>,
    room: Room,
    registers: Vec<f64>,
    solver: Solver,
    taylor: TaylorRoom,
}

/// Computes the block; the point where the set has no value is the error.
pub(super) fn compute(
    grid: &Grid,
    at: [u32; 3],
    tape: &Arc<ExprTape<f64>>,
    leaves: &[Leaf],
    scratch: &mut Scratch,
) -> Result<FacetBlock, Vec3> {
    let base = at.map(|b| b as usize * SIDE);
    let corner = |c: [usize; 3]| grid.corner([0, 1, 2].map(|k| base[k] + c[k]));
    let Scratch { points, values, room, registers, solver, taylor } = scratch;
    points.clear();
    for i in 0..CORNERS {
        for j in 0..CORNERS {
            points.extend((0..CORNERS).map(|k| corner([i, j, k])));
        }
    }
    values.resize(points.len(), 0.0);
    tape.bulk(points, values, room);
    if let Some(k) = values.iter().position(|v| v.is_nan()) {
        return Err(points[k]);
    }

    let mut crossing_at = vec![u32::MAX; 3 * CORNERS * CORNERS * CORNERS];
    let (mut edges, mut places) = (Vec::new(), Vec::new());
    for i in 0..CORNERS {
        for j in 0..CORNERS {
            for k in 0..CORNERS {
                let c = [i, j, k];
                let here = corner_index(c);
                for axis in 0..3 {
                    if c[axis] == SIDE {
                        continue;
                    }
                    let there = here + [CORNERS * CORNERS, CORNERS, 1][axis];
                    let (f0, f1) = (values[here], values[there]);
                    if (f0 <= 0.0) == (f1 <= 0.0) {
                        continue;
                    }
                    crossing_at[3 * here + axis] = edges.len() as u32;
                    edges.push(EdgeBracket::new([points[here], points[there]], [f0, f1]));
                    places.push((c.map(|x| x as u8), axis as u8, f0 <= 0.0));
                }
            }
        }
    }
    let found = cross(tape, &mut edges, room);
    let deciding = tape.winners(&found, registers);
    let mut crossings: Vec<EdgeCrossing> = places
        .into_iter()
        .zip(found.into_iter().zip(deciding))
        .map(|((at, axis, outward), (point, leaf))| EdgeCrossing { at, axis, outward, leaf, point })
        .collect();

    let mut block = FacetBlock {
        at,
        signs: Box::new([0; SIDE * SIDE * SIDE]),
        joins: Box::new([0; SIDE * SIDE * SIDE]),
        first: Box::new([0; SIDE * SIDE * SIDE]),
        vertices: Vec::new(),
        splits: Vec::new(),
        crossings: Vec::new(),
        active: 0,
        unresolved: Vec::new(),
    };
    // Primitives from outside know too little of themselves.
    if !tape.has_users() {
        let corner = |c: [usize; 3]| corner(c).to_array();
        let quiet = Quiet { tape, values: &*values, corner: &corner };
        block.unresolved = quiet.unresolved(taylor);
    }
    if crossings.is_empty() {
        return Ok(block);
    }
    for i in 0..SIDE {
        for j in 0..SIDE {
            for k in 0..SIDE {
                let cell = [i, j, k];
                let mut signs = 0usize;
                for c in 0..8 {
                    let at = corner_index([i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)]);
                    signs |= usize::from(values[at] <= 0.0) << c;
                }
                let index = cell_index(cell);
                block.signs[index] = signs as u8;
                if signs == 0 || signs == 255 {
                    continue;
                }
                block.active += 1;
                block.first[index] = block.vertices.len() as u32;
                let sides = Box3 { low: corner(cell), high: corner([i + 1, j + 1, k + 1]) };
                for face in (0..6).filter(|&f| case(signs as u8, 0).ambiguous[f]) {
                    // The same middle, bit for bit, from both cells of the face.
                    let (axis, mut at) = (face / 2, cell);
                    at[axis] += face % 2;
                    let across = [0, 1, 2].map(|k| at[k] + usize::from(k != axis));
                    let middle = (corner(at) + corner(across)) * 0.5;
                    let solid = tape.eval::<f64>(&middle, registers) <= 0.0;
                    let on = |e: usize| {
                        let start = start_corner(e);
                        let c = [i + (start & 1), j + (start >> 1 & 1), k + (start >> 2)];
                        &crossings[crossing_at[3 * corner_index(c) + e / 4] as usize]
                    };
                    let mut touch = || {
                        let ring = face_edges(axis, face % 2).map(on);
                        let first = signs >> ((face % 2) << axis) & 1 == 1;
                        touching(ring, first, face, &sides, leaves, grid.goal, solver)
                    };
                    // Bodies that only touch there stay apart.
                    block.joins[index] |= u8::from(solid && !touch()) << face;
                }
                let case = block.case(cell);
                let pieces = case.loops > 1;
                let small = cell.map(|x| x as u8);
                let mut more: SmallVec<[CellVertex; 4]> = SmallVec::new();
                for number in 0..case.loops {
                    let edges: Ring = (0..12)
                        .filter(|&e| case.loop_of[e] == number)
                        .map(|e| {
                            let start = start_corner(e);
                            let c = [i + (start & 1), j + (start >> 1 & 1), k + (start >> 2)];
                            let at = crossing_at[3 * corner_index(c) + e / 4];
                            (e, &crossings[at as usize])
                        })
                        .collect();
                    let mut placement = VertexPlacer {
                        tape,
                        leaves,
                        cell: &sides,
                        goal: grid.goal,
                        solver,
                        registers,
                    };
                    match placement.vertices(&edges, &case.next) {
                        PieceVertices::One { placed, surfaces, blunt, creased } => {
                            let (cell, doubtful) = (small, pieces || placed.strayed);
                            let vertex =
                                CellVertex { placed, cell, doubtful, blunt, creased, surfaces };
                            block.vertices.push(vertex);
                        }
                        PieceVertices::Several(mut split) => {
                            let vertex =
                                |(placed, surfaces): (PlacedVertex, Surfaces)| CellVertex {
                                    placed,
                                    cell: small,
                                    doubtful: true,
                                    blunt: false,
                                    creased: false,
                                    surfaces,
                                };
                            let mut own = std::mem::take(&mut split.vertices).into_iter();
                            block.vertices.extend(own.next().map(vertex));
                            // The first vertices of all pieces come before the others.
                            let place = block.first[index] + u32::from(case.loops);
                            let several = place + more.len() as u32;
                            more.extend(own.map(vertex));
                            let (cell, more) = (small, several);
                            block.splits.push(Several { cell, number, more, split });
                        }
                    }
                }
                block.vertices.extend(more);
            }
        }
    }
    crossings.retain(|c| c.at.iter().all(|&x| (x as usize) < SIDE));
    block.crossings = crossings;
    Ok(block)
}

/// True when the two pieces of air on an ambiguous face whose solid corners would be joined come together at
/// one point: then the solids only touch. `ring` are the crossings round the face, `first` says that
/// its first corner is solid.
fn touching(
    ring: [&EdgeCrossing; 4],
    first: bool,
    face: usize,
    cell: &Box3,
    leaves: &[Leaf],
    goal: f64,
    solver: &mut Solver,
) -> bool {
    // The pairs round the two air corners; edge k joins corners k and k + 1.
    let pairs = if first { [[0, 1], [2, 3]] } else { [[3, 0], [1, 2]] };
    let (mut low, mut high) = (cell.low.to_array(), cell.high.to_array());
    let at = if face.is_multiple_of(2) { low[face / 2] } else { high[face / 2] };
    (low[face / 2], high[face / 2]) = (at, at);
    let side = Box3 { low: low.into(), high: high.into() };
    let mut corner = |[a, b]: [usize; 2]| {
        let (p, q) = (ring[a], ring[b]);
        if p.leaf == q.leaf {
            return None;
        }
        let both = [p.leaf.min(q.leaf), p.leaf.max(q.leaf)];
        let placed = solver.place(leaves, &both, (p.point + q.point) * 0.5, &side, goal);
        (placed.residual <= goal).then_some(placed.point)
    };
    match pairs.map(&mut corner) {
        [Some(p), Some(q)] => p.distance(q) <= 100.0 * goal,
        _ => false,
    }
}

/// Value at a crossing, relative to those at the edge's ends: small enough for the point to be on
/// both surfaces where two touch.
const NEAR: f64 = 1e-13;

/// An edge on which the set changes sign, and the part of it where that is.
struct EdgeBracket {
    ends: [Vec3; 2],
    /// The part, as fractions of the edge, and the values at its ends; that of a retained end is
    /// halved.
    part: [f64; 2],
    values: [f64; 2],
    /// The end kept in the last step: 0 or 1, -1 for neither.
    stayed: i8,
    /// A value as small as this is zero.
    small: f64,
    /// The tested fraction.
    at: f64,
}

impl EdgeBracket {
    fn new(ends: [Vec3; 2], values: [f64; 2]) -> Self {
        let small = NEAR * values[0].abs().max(values[1].abs());
        Self { ends, part: [0.0, 1.0], values, stayed: -1, small, at: 0.0 }
    }

    /// The point to look at in a step: of the Illinois rule, with every third step a bisection.
    fn next(&mut self, step: usize) -> Vec3 {
        let ([a, b], [fa, fb]) = (self.part, self.values);
        self.at = (a * fb - b * fa) / (fb - fa);
        if step % 3 == 2 || !(self.at > a && self.at < b) {
            self.at = 0.5 * (a + b);
        }
        self.point()
    }

    fn point(&self) -> Vec3 {
        self.ends[0] + (self.ends[1] - self.ends[0]) * self.at
    }

    /// Takes the value there; true when the search is over.
    fn take(&mut self, value: f64) -> bool {
        if value.abs() <= self.small || self.part[1] - self.part[0] < 1e-14 {
            return true;
        }
        let end = usize::from((value <= 0.0) != (self.values[0] <= 0.0));
        let other = 1 - end;
        if self.stayed == other as i8 {
            self.values[other] *= 0.5;
        }
        self.stayed = other as i8;
        self.part[end] = self.at;
        self.values[end] = value;
        false
    }
}

/// Sign changes of the set on each edge. All edges are searched together, because evaluation is
/// cheaper in batches.
fn cross(tape: &ExprTape<f64>, edges: &mut [EdgeBracket], room: &mut Room) -> Vec<Vec3> {
    let mut open: Vec<u32> = (0..edges.len() as u32).collect();
    let (mut points, mut values) = (Vec::new(), Vec::new());
    for step in 0..80 {
        if open.is_empty() {
            break;
        }
        points.clear();
        points.extend(open.iter().map(|&k| edges[k as usize].next(step)));
        values.resize(points.len(), 0.0);
        tape.bulk(&points, &mut values, room);
        let mut value = values.iter();
        open.retain(|&k| value.next().is_some_and(|v| !edges[k as usize].take(*v)));
    }
    for k in open {
        let edge = &mut edges[k as usize];
        edge.at = 0.5 * (edge.part[0] + edge.part[1]);
    }
    edges.iter().map(EdgeBracket::point).collect()
}
