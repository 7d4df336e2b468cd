//! The cubic grid over a box.

use super::types::SIDE;
use crate::FieldError;
use crate::expr::interval::Interval;
use moldloft_num::{Box3, Vec3};

/// Cubic cells over a box, with a margin so that the faces of the box are between grid points.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid {
    origin: Vec3,
    /// Side of a cell.
    pub(crate) step: f64,
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
        Ok(Self { origin, step, cells, goal })
    }

    #[inline(always)]
    pub(super) fn corner(&self, at: [usize; 3]) -> Vec3 {
        let x = |k: usize| self.origin[k] + self.step * at[k] as f64;
        Vec3::new(x(0), x(1), x(2))
    }

    /// The ranges of the coordinates between two corners.
    pub(super) fn sides(&self, low: [usize; 3], high: [usize; 3]) -> [Interval; 3] {
        let (a, b) = (self.corner(low), self.corner(high));
        [0, 1, 2].map(|k| Interval { low: a[k], high: b[k] })
    }

    /// Block that contains a point.
    pub(super) fn block_of(&self, p: Vec3) -> [u32; 3] {
        [0, 1, 2].map(|k| ((p[k] - self.origin[k]) / (self.step * SIDE as f64)).max(0.0) as u32)
    }

    /// Cell that contains a point.
    pub(super) fn cell_of(&self, p: Vec3) -> [usize; 3] {
        [0, 1, 2].map(|k| ((p[k] - self.origin[k]) / self.step).max(0.0) as usize)
    }

    pub(super) fn cell(&self, at: [usize; 3]) -> Box3 {
        Box3 { low: self.corner(at), high: self.corner(at.map(|x| x + 1)) }
    }
}
