//! Cells that may contain features that their corners do not show: a plate, a rod or a gap thinner
//! than the cell.
//!
//! If the corners of a cell agree and the range of the set contains zero, the state of the cell is
//! proved: by the values at its corners and second derivatives, otherwise by the planes of its
//! leaves and their remainders, in parts of the cell if necessary. Certain and possible misses are
//! listed with the volume that they may have.

use super::block::CORNERS;
use super::types::{SIDE, Unresolved};
use crate::expr::interval::Interval;
use crate::expr::second_order::HessianRange;
use crate::expr::tape::{ExprInstruction, ExprTape, NO_LEAF};
use crate::measure::taylor::{self, Combination, TaylorRoom};
use moldloft_num::{Box3, Vec3, nearest_on_triangle};
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A cell is halved this often to prove it.
const DEPTH: u32 = 4;
/// Maximum number of parts of cells examined per block.
const MOST: usize = 3000;
/// Jumps of one cell that are taken apart.
const MOST_JUMPS: usize = 3;
/// Minimum volume of a certain miss, in cells.
const SEEN: f64 = 1e-9;
/// Relative volume below which a cell is empty, by rounding.
const ROUNDING: f64 = 1e-12;

/// Whether the set has unions, and intersections, between its leaves.
fn joins(tape: &ExprTape<f64>) -> (bool, bool) {
    let (mut unions, mut common) = (false, false);
    for code in &tape.code {
        unions |= matches!(code, ExprInstruction::Union(..));
        common |= matches!(code, ExprInstruction::Common(..));
    }
    (unions, common)
}

/// Maximum deviation of a leaf from the interpolated values at the corners of a cell, from second
/// derivatives over the whole block: the error of multilinear interpolation in cells of the widths `cell`.
fn interpolation_error(
    tape: &ExprTape<f64>,
    sides: &[Interval; 3],
    cell: [f64; 3],
    forms: &mut Vec<HessianRange>,
) -> f64 {
    tape.eval::<HessianRange>(sides, forms);
    let mut most = 0.0f64;
    for (form, leaf) in forms.iter().zip(&tape.leaf) {
        if *leaf != NO_LEAF {
            let bend = |k: usize| match form.second[k].magnitude() {
                0.0 => 0.0,
                most => cell[k] * cell[k] * most,
            };
            let error = 0.125 * (bend(0) + bend(1) + bend(2));
            most = if error.is_finite() { most.max(error) } else { f64::INFINITY };
        }
    }
    most * (1.0 + 1e-9)
}

/// A block of cells with the values at their corners.
pub(super) struct Quiet<'a> {
    pub tape: &'a Arc<ExprTape<f64>>,
    pub values: &'a [f64],
    /// The position of a corner of the block.
    pub corner: &'a dyn Fn([usize; 3]) -> [f64; 3],
}

impl Quiet<'_> {
    /// The value at a corner nearest to zero, negative in the solid, where all corners of a cell agree.
    fn agreed(&self, cell: [usize; 3]) -> Option<f64> {
        let at = |c: usize| {
            let [i, j, k] = [cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2)];
            self.values[(i * CORNERS + j) * CORNERS + k]
        };
        let first = at(0);
        let mut least = first;
        for c in 1..8 {
            let value = at(c);
            if (value <= 0.0) != (first <= 0.0) {
                return None;
            }
            least = if value.abs() < least.abs() { value } else { least };
        }
        Some(least)
    }

    fn sides(&self, low: [usize; 3], size: usize) -> [Interval; 3] {
        let (a, b) = ((self.corner)(low), (self.corner)(low.map(|x| x + size)));
        [0, 1, 2].map(|k| Interval { low: a[k], high: b[k] })
    }

    /// The largest width of the block's cells along each axis.
    fn widest(&self) -> [f64; 3] {
        let side =
            |k: usize, n: usize| (self.corner)([0, 1, 2].map(|i| if i == k { n } else { 0 }))[k];
        let width = |k: usize| (0..SIDE).map(|n| side(k, n + 1) - side(k, n)).fold(0.0, f64::max);
        [width(0), width(1), width(2)]
    }

    /// The cells, or parts of them, that stay open.
    pub fn unresolved(&self, room: &mut TaylorRoom) -> Vec<Unresolved> {
        let (unions, common) = joins(self.tape);
        let whole = self.sides([0; 3], SIDE);
        let mut open = Vec::new();
        let mut work = UnresolvedSearch { room, left: MOST, open: &mut open };
        // A union that is air at all corners has only such operands; likewise an intersection that
        // is solid.
        let error = match unions && common {
            true => f64::INFINITY,
            false => interpolation_error(self.tape, &whole, self.widest(), &mut work.room.forms),
        };
        let sure = |least: f64| {
            let covered = if least > 0.0 { !common } else { !unions };
            covered && least.abs() > error
        };
        let mut stack = vec![([0usize; 3], SIDE, self.tape.clone())];
        while let Some((low, size, tape)) = stack.pop() {
            if size == 1 {
                let Some(least) = self.agreed(low) else { continue };
                if !sure(least) {
                    work.look(&tape, &self.sides(low, 1), least <= 0.0, 0);
                }
                continue;
            }
            let sides = self.sides(low, size);
            let range = tape.range(&sides, &mut work.room.ranges.ranges);
            if range.low > 0.0 || range.high < 0.0 {
                continue;
            }
            let tape = match size == SIDE {
                true => tape,
                false => tape.pruned(&work.room.ranges.ranges).map_or(tape, Arc::new),
            };
            for c in 0..8 {
                let half = size / 2;
                let low = [0, 1, 2].map(|k| low[k] + (c >> k & 1) * half);
                stack.push((low, half, tape.clone()));
            }
        }
        open
    }
}

struct UnresolvedSearch<'a> {
    room: &'a mut TaylorRoom,
    /// Number of parts that may still be examined.
    left: usize,
    open: &'a mut Vec<Unresolved>,
}

impl UnresolvedSearch<'_> {
    /// Looks at a cell whose corners are all solid or all air, and in its parts as far as need be.
    fn look(&mut self, tape: &Arc<ExprTape<f64>>, sides: &[Interval; 3], solid: bool, depth: u32) {
        let range = tape.range(sides, &mut self.room.ranges.ranges);
        if range.low > 0.0 || range.high < 0.0 {
            // Proved; a part that is wholly of the other kind is missed.
            if (range.high < 0.0) != solid {
                let middle = sides.map(|s| s.middle()).into();
                self.list(sides, volume(sides), true, (middle, !solid));
            }
            return;
        }
        let mut tape = tape.pruned(&self.room.ranges.ranges).map_or_else(|| tape.clone(), Arc::new);
        if tape.has_jumps() {
            // Jumps that are not faces are examined on both sides.
            for _ in 0..MOST_JUMPS {
                tape.range(sides, &mut self.room.ranges.ranges);
                let Some(parted) = tape.parted(&self.room.ranges.ranges) else { break };
                tape = Arc::new(parted);
            }
        }
        let full = volume(sides);
        let parts =
            Combination::of(&tape).map(|c| taylor::bounds(&tape, &c, sides, true, self.room));
        let (least, most) = parts.as_ref().map_or((0.0, full), |p| (p.least[0], p.most[0]));
        // Possible, and certain, volume of the other kind.
        let (may, sure) = if solid { (full - least, full - most) } else { (most, least) };
        if may <= ROUNDING * full {
            return;
        }
        // Centre of the certain, or possible, volume.
        let centre = Vec3::from(sides.map(|s| s.middle()));
        let witness = |certain: bool| {
            let Some(p) = &parts else { return centre };
            let (m, size) = match (solid, certain) {
                (false, true) => (&p.least, p.least[0]),
                (false, false) => (&p.most, p.most[0]),
                (true, true) => (&p.most, p.most[0] - full),
                (true, false) => (&p.least, p.least[0] - full),
            };
            centre + Vec3::of(m[1], m[2], m[3]) / size
        };
        if sure > SEEN * full {
            return self.list(sides, may, true, (witness(true), !solid));
        }
        if depth == DEPTH || self.left < 8 {
            return self.list(sides, may, false, (witness(false), !solid));
        }
        self.left -= 8;
        for c in 0..8 {
            let half = [0, 1, 2].map(|k| {
                let middle = sides[k].middle();
                match c >> k & 1 {
                    0 => Interval { low: sides[k].low, high: middle },
                    _ => Interval { low: middle, high: sides[k].high },
                }
            });
            self.look(&tape, &half, solid, depth + 1);
        }
    }

    fn list(
        &mut self,
        sides: &[Interval; 3],
        volume: f64,
        missed: bool,
        (witness, solid): (Vec3, bool),
    ) {
        let place = Box3 { low: sides.map(|s| s.low).into(), high: sides.map(|s| s.high).into() };
        self.open.push(Unresolved { place, volume, missed, witness, solid });
    }
}

fn volume(sides: &[Interval; 3]) -> f64 {
    sides.iter().map(|s| s.width()).product()
}

/// Maximum number of reported regions.
const MOST_PLACES: usize = 100;

/// Unresolved regions joined with their neighbours, by cubes large enough to make them few: each
/// with all the volume that it may hold. The largest come first.
pub(super) fn gathered(open: &[Unresolved], step: f64) -> Vec<Unresolved> {
    let mut all = open.to_vec();
    let mut size = 2.0 * step;
    while all.len() > MOST_PLACES {
        let mut by_cube: BTreeMap<[i64; 3], Unresolved> = BTreeMap::new();
        for u in all {
            let cube = u.place.centre().to_array().map(|x| (x / size).floor() as i64);
            let joined = match by_cube.remove(&cube) {
                None => u,
                Some(v) => {
                    let corners = [u.place.low, u.place.high, v.place.low, v.place.high];
                    let first = if u.missed && !v.missed { u } else { v };
                    let place = Box3::around(corners);
                    Unresolved { place, volume: u.volume + v.volume, ..first }
                }
            };
            by_cube.insert(cube, joined);
        }
        all = by_cube.into_values().collect();
        size *= 2.0;
    }
    all.sort_by(|a, b| b.volume.total_cmp(&a.volume));
    all
}

/// Features within this fraction of a cell of the surface, or on the side of it where they belong,
/// are not missed.
const NEAR: f64 = 0.15;

/// Unresolved positions that the triangles do not represent: an edge or a corner that enters a cell
/// without reaching its corners may be on the triangles beside it.
pub(super) fn not_shown(
    mut open: Vec<Unresolved>,
    positions: &[Vec3],
    triangles: &[(u32, [u32; 3])],
    step: f64,
) -> Vec<Unresolved> {
    if open.is_empty() || triangles.is_empty() {
        return open;
    }
    let bin = |p: Vec3| [0, 1, 2].map(|k| (p[k] / step).floor() as i64);
    let around = |p: Vec3| {
        let [i, j, k] = bin(p);
        (0..27).map(move |n| [i + n % 3 - 1, j + n / 3 % 3 - 1, k + n / 9 - 1])
    };
    let wanted: FxHashSet<[i64; 3]> = open.iter().flat_map(|u| around(u.witness)).collect();
    let mut bins: FxHashMap<[i64; 3], Vec<u32>> = FxHashMap::default();
    for (t, (_, corners)) in triangles.iter().enumerate() {
        let b = Box3::around(corners.map(|v| positions[v as usize]));
        let (low, high) = (bin(b.low), bin(b.high));
        for i in low[0]..=high[0] {
            for j in low[1]..=high[1] {
                for k in low[2]..=high[2] {
                    if wanted.contains(&[i, j, k]) {
                        bins.entry([i, j, k]).or_default().push(t as u32);
                    }
                }
            }
        }
    }
    open.retain(|u| {
        let mut best = (f64::INFINITY, 0.0);
        for t in around(u.witness).filter_map(|b| bins.get(&b)).flatten() {
            let [a, b, c] = triangles[*t as usize].1.map(|v| positions[v as usize]);
            let away = u.witness - nearest_on_triangle(u.witness, [a, b, c]);
            let far = away.norm();
            let side = (b - a).cross(c - a).dot(away);
            // Of triangles with the same nearest point the one with the most frontal view
            // determines the side.
            let size = (b - a).cross(c - a).norm() * far;
            let square = if size > 0.0 { side / size } else { 0.0 };
            let tied = far <= best.0 * (1.0 + 1e-9);
            if far < best.0 * (1.0 - 1e-9) || tied && square.abs() > f64::abs(best.1) {
                best = (far.min(best.0), square);
            }
        }
        let (far, square) = best;
        let as_it_is = if u.solid { square < 0.0 } else { square > 0.0 };
        far > NEAR * step && !(far.is_finite() && as_it_is)
    });
    open
}
