//! The grid over a box: cubic cells, joined along an axis where the set is a prism.
//!
//! Between two planes across an axis, and wherever else the reduced formula of the whole
//! cross-section does not contain the axis's coordinate, the set is a prism. One layer of cells
//! shows it, however long it is and however thin: the vertices are on the outline, and the
//! triangles are as long as the prism.

use super::types::SIDE;
use crate::FieldError;
use crate::expr::interval::Interval;
use crate::expr::tape::{ExprInstruction, ExprTape, NO_LEAF};
use moldloft_num::{Box3, Vec3};

/// Cells over a box, with a margin so that the faces of the box are between grid points.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid {
    /// Coordinates of the planes between the cells along each axis, ascending.
    lines: [Vec<f64>; 3],
    /// Side of a cell that is not joined with others.
    pub(crate) step: f64,
    /// True if some cells are longer.
    pub(super) joined: bool,
    /// Axes along which all cells have the same length.
    uniform: [bool; 3],
    /// Cells along each axis, whole blocks.
    pub(super) cells: [usize; 3],
    /// Distance from a surface that counts as on it.
    pub(super) goal: f64,
}

/// By which part of a cell the grid starts before the box, per axis: numbers without small
/// multiples, so that the faces of ordinary models fall between the corners of the grid. The first is the usual
/// one; the others are for bodies with edges that pass badly between its corners.
const MARGINS: [[f64; 3]; PLACES] = [
    [0.381_966, 0.445_042, 0.414_214],
    [0.618_034, 0.198_062, 0.732_051],
    [0.141_593, 0.718_282, 0.554_958],
    [0.867_257, 0.577_216, 0.259_921],
];
/// Maximum number of positions of a grid.
pub(super) const PLACES: usize = 4;

/// Maximum number of cells along an axis, as the keys of edges can represent.
const MOST: f64 = (1 << 19) as f64;

/// Minimum distance of corners of cells, in roundings of their coordinates.
const APART: f64 = 64.0;

impl Grid {
    /// Cells of side `step` over `over`.
    pub(crate) fn new(over: &Box3, step: f64) -> Result<Self, FieldError> {
        Self::at(over, step, 0)
    }

    /// Cells of side `step` over `over`, at one of a few offsets.
    pub(super) fn at(over: &Box3, step: f64, place: usize) -> Result<Self, FieldError> {
        let margin = MARGINS[place];
        let mut cells = [0; 3];
        for k in 0..3 {
            let count = (over.high[k] - over.low[k]) / step + margin[k] + 0.25;
            if count >= MOST {
                return Err(FieldError::TooFine { boxes: count * count, limit: MOST * MOST });
            }
            cells[k] = (count.ceil() as usize).div_ceil(SIDE) * SIDE;
        }
        let origin = over.low - Vec3::from(margin) * step;
        // Vertices are on their surfaces to 1e-13 of the box (1e-12 is promised), far from the origin to
        // the rounding of their coordinates.
        let far = over.low.norm().max(over.high.norm());
        if step < APART * f64::EPSILON * far {
            return Err(FieldError::FarAway { far, step });
        }
        let goal = 1e-13 * over.diagonal() + 8.0 * f64::EPSILON * far;
        let line = |k: usize| (0..=cells[k]).map(|n| origin[k] + step * n as f64).collect();
        Ok(Self {
            lines: [line(0), line(1), line(2)],
            step,
            joined: false,
            uniform: [true; 3],
            cells,
            goal,
        })
    }

    /// The grid with one layer of cells for each prism of a set within the box `over`; the leaves
    /// of the set itself precede those of the box.
    pub(super) fn fitted(mut self, tape: &ExprTape<f64>, own_leaves: usize, over: &Box3) -> Self {
        let depends = dependence(tape);
        let mut room = Vec::new();
        let fitted = [0, 1, 2].map(|axis| {
            let apart = |(k, leaf): (usize, &u32)| {
                (*leaf as usize) < own_leaves && depends[k] >> axis & 1 == 0
            };
            let any = tape.leaf.iter().enumerate().any(apart);
            any.then(|| GridLayers { grid: &self, axis, tape, room: &mut room }.lines(over))
                .flatten()
        });
        for (k, lines) in fitted.into_iter().enumerate() {
            let Some(mut lines) = lines else { continue };
            let count = (lines.len() - 1).div_ceil(SIDE) * SIDE;
            while lines.len() <= count {
                lines.push(lines[lines.len() - 1] + self.step);
            }
            (self.lines[k], self.cells[k]) = (lines, count);
            (self.joined, self.uniform[k]) = (true, false);
        }
        self
    }

    #[inline(always)]
    pub(super) fn corner(&self, at: [usize; 3]) -> Vec3 {
        Vec3::new(self.lines[0][at[0]], self.lines[1][at[1]], self.lines[2][at[2]])
    }

    /// The ranges of the coordinates between two corners.
    pub(super) fn sides(&self, low: [usize; 3], high: [usize; 3]) -> [Interval; 3] {
        let (a, b) = (self.corner(low), self.corner(high));
        [0, 1, 2].map(|k| Interval { low: a[k], high: b[k] })
    }

    /// Block that contains a point.
    pub(super) fn block_of(&self, p: Vec3) -> [u32; 3] {
        self.cell_of(p).map(|c| (c / SIDE) as u32)
    }

    /// Cell that contains a point.
    pub(super) fn cell_of(&self, p: Vec3) -> [usize; 3] {
        [0, 1, 2].map(|k| {
            let lines = &self.lines[k];
            let at = match self.uniform[k] {
                true => ((p[k] - lines[0]) / self.step).max(0.0) as usize,
                false => lines.partition_point(|x| *x <= p[k]).saturating_sub(1),
            };
            at.min(self.cells[k] - 1)
        })
    }

    /// The box of the cells from one to another, as far as these are in the grid.
    pub(super) fn between(&self, low: [usize; 3], high: [usize; 3]) -> Box3 {
        let line = |k: usize, at: usize| self.lines[k][at.min(self.cells[k])];
        Box3 {
            low: Vec3::from([0, 1, 2].map(|k| line(k, low[k]))),
            high: Vec3::from([0, 1, 2].map(|k| line(k, high[k] + 1))),
        }
    }

    pub(super) fn cell(&self, at: [usize; 3]) -> Box3 {
        Box3 { low: self.corner(at), high: self.corner(at.map(|x| x + 1)) }
    }
}

/// For every instruction the coordinates that its value depends on, as bits.
fn dependence(tape: &ExprTape<f64>) -> Vec<u8> {
    let mut out: Vec<u8> = Vec::with_capacity(tape.code.len());
    for code in &tape.code {
        let own = match code {
            ExprInstruction::Plane(n, _) => (0..3).map(|k| u8::from(n[k] != 0.0) << k).sum(),
            ExprInstruction::User(_) => 7,
            _ => 0,
        };
        let of = |k: u32| out[k as usize];
        out.push(code.operands().into_iter().flatten().map(of).fold(own, |a, b| a | b));
    }
    out
}

/// Planes across an axis nearer to each other than this number of goals are one.
const ONE_LEVEL: f64 = 1e5;
/// Fraction of a gap between two planes that is not examined at either of its ends.
const BESIDE: f64 = 1e-6;

/// A set between two planes across an axis.
enum SlabContent {
    Air,
    /// A prism along the axis.
    Prism,
    Other,
}

/// The layers of cells along an axis.
struct GridLayers<'a> {
    grid: &'a Grid,
    axis: usize,
    tape: &'a ExprTape<f64>,
    room: &'a mut Vec<Interval>,
}

impl GridLayers<'_> {
    /// The planes between layers; `None` where cells of equal size do as well.
    fn lines(mut self, over: &Box3) -> Option<Vec<f64>> {
        let uniform = &self.grid.lines[self.axis];
        let levels = self.levels(over);
        let (first, last) = (*levels.first()?, *levels.last()?);
        let before = uniform.iter().rev().find(|x| **x < first)?;
        let mut out = vec![*before];
        let mut changed = false;
        for pair in levels.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let inner = &uniform[uniform.partition_point(|x| *x <= a)..];
            let inner = &inner[..inner.partition_point(|x| *x < b)];
            let slack = BESIDE * (b - a);
            let outside = a == first || b == last;
            let mut kept = vec![true; inner.len()];
            match self.between(a + slack, b - slack) {
                // Cells of the usual size show the gap.
                SlabContent::Prism | SlabContent::Air if matches!(inner.len(), 1 | 2) => {}
                SlabContent::Air if outside => {}
                SlabContent::Prism | SlabContent::Air => {
                    // A plane has one layer, up to the middle of the gap beside it.
                    out.push(0.5 * (a + b));
                    changed = true;
                    continue;
                }
                SlabContent::Other => {
                    self.join(inner, [0, inner.len().saturating_sub(1)], &mut kept)
                }
            }
            changed |= kept.contains(&false);
            out.extend(inner.iter().zip(&kept).filter(|(_, keep)| **keep).map(|(x, _)| *x));
        }
        out.push(*uniform.iter().find(|x| **x > last)?);
        changed.then_some(out)
    }

    /// Positions of the planes across the axis, those of the box included, ascending.
    fn levels(&self, over: &Box3) -> Vec<f64> {
        let axis = self.axis;
        let (low, high) = (over.low[axis], over.high[axis]);
        let mut all = vec![low, high];
        for (code, leaf) in self.tape.code.iter().zip(&self.tape.leaf) {
            if let ExprInstruction::Plane(n, d) = code
                && *leaf != NO_LEAF
                && (0..3).all(|k| (k == axis) == (n[k] != 0.0))
            {
                let level = -d / n[axis];
                if low < level && level < high {
                    all.push(level);
                }
            }
        }
        all.sort_by(f64::total_cmp);
        all.dedup_by(|a, b| *a - *b <= ONE_LEVEL * self.grid.goal);
        all
    }

    /// The set between two positions.
    fn between(&mut self, low: f64, high: f64) -> SlabContent {
        let mut sides = [0, 1, 2].map(|k| {
            let lines = &self.grid.lines[k];
            Interval { low: lines[0], high: lines[lines.len() - 1] }
        });
        sides[self.axis] = Interval { low, high };
        let range = self.tape.range(&sides, self.room);
        if range.low > 0.0 {
            return SlabContent::Air;
        }
        let free = |tape: ExprTape<f64>| {
            dependence(&tape).last().is_some_and(|all| all >> self.axis & 1 == 0)
        };
        match self.tape.pruned(self.room).is_some_and(free) {
            true => SlabContent::Prism,
            false => SlabContent::Other,
        }
    }

    /// Removes lines between a first and a last one where the set is a prism.
    fn join(&mut self, lines: &[f64], [first, last]: [usize; 2], kept: &mut [bool]) {
        if last < first + 2 {
            return;
        }
        match self.between(lines[first], lines[last]) {
            SlabContent::Air => return,
            SlabContent::Prism => return kept[first + 1..last].fill(false),
            SlabContent::Other => {}
        }
        let middle = (first + last) / 2;
        self.join(lines, [first, middle], kept);
        self.join(lines, [middle, last], kept);
    }
}
