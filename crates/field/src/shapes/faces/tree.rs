//! A binary division of space by the planes of faces, and the set that it describes.

use super::polytope::{HessePlane, Polytope};

/// Surface of a piece of a body's boundary: the number of a plane or of a round side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SideSurface {
    /// A plane.
    Flat(usize),
    /// A round side: the only surface of the body in its cell.
    Round(usize),
}

/// A convex piece that contains a piece of the surface.
#[derive(Clone, Debug)]
pub(super) struct ConvexPiece {
    pub side: SideSurface,
    pub body: Polytope,
}

/// The division of a convex cell.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum BspTree {
    Air,
    Solid,
    /// The cell's surface is that round side.
    Round(usize),
    /// In front of a plane and behind it.
    Split {
        plane: usize,
        parts: Box<[BspTree; 2]>,
    },
}

/// Why no division was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tangled {
    /// Round sides that no plane of theirs parts.
    Rounds,
    /// It takes more cells than allowed.
    Cells,
}

/// Input of a division.
pub(super) struct Divider<'a> {
    /// The planes: those of flat sides first, then planes beside round ones that may part these.
    pub planes: &'a [HessePlane],
    /// Number of planes that belong to flat sides.
    pub flat: usize,
    /// True for a point off the surface that is inside.
    pub inside: &'a dyn Fn(moldloft_num::Vec3) -> bool,
    /// Distance below which a point is on a plane.
    pub epsilon: f64,
    /// Maximum number of cells.
    pub cells: usize,
}

impl Divider<'_> {
    /// Divides a cell by the pieces in it.
    pub fn divide(&mut self, cell: Polytope, pieces: Vec<ConvexPiece>) -> Result<BspTree, Tangled> {
        self.cells = self.cells.checked_sub(1).ok_or(Tangled::Cells)?;
        let Some(first) = pieces.first() else {
            return Ok(if (self.inside)(cell.middle()) { BspTree::Solid } else { BspTree::Air });
        };
        if let SideSurface::Round(n) = first.side
            && pieces.iter().all(|p| p.side == first.side)
        {
            return Ok(BspTree::Round(n));
        }
        let (plane, split) = self.choose(&pieces)?;
        let level = self.planes[plane];
        let [front, behind] = split;
        let part = |level: HessePlane, which: Vec<usize>, this: &mut Self| match cell
            .cut(&level, this.epsilon)
        {
            // A plane that only touches the cell: nothing is on its other side.
            None => Ok(None),
            Some(cell) => {
                let cut = |k: usize| {
                    let body = pieces[k].body.cut(&level, this.epsilon)?;
                    Some(ConvexPiece { side: pieces[k].side, body })
                };
                let inside: Vec<ConvexPiece> = which.into_iter().filter_map(cut).collect();
                this.divide(cell, inside).map(Some)
            }
        };
        let front = part(level, front, self)?;
        let behind = part(level.turned(), behind, self)?;
        Ok(match (front, behind) {
            (Some(front), Some(behind)) => {
                BspTree::Split { plane, parts: Box::new([front, behind]) }
            }
            // The plane bounds the cell, and its pieces are on the boundary: the sides differ.
            (Some(front), None) => BspTree::Split { plane, parts: Box::new([front, BspTree::Air]) },
            (None, Some(behind)) => {
                BspTree::Split { plane, parts: Box::new([BspTree::Air, behind]) }
            }
            (None, None) => BspTree::Air,
        })
    }

    /// The plane to divide by, and which pieces have a part in front of it and behind it.
    fn choose(&self, pieces: &[ConvexPiece]) -> Result<(usize, [Vec<usize>; 2]), Tangled> {
        let mut wanted: Vec<usize> = Vec::new();
        for piece in pieces {
            if let SideSurface::Flat(k) = piece.side
                && !wanted.contains(&k)
            {
                wanted.push(k);
            }
        }
        let rounds_only = wanted.is_empty();
        if rounds_only {
            wanted = (self.flat..self.planes.len()).collect();
        }
        let mut best: Option<(usize, usize, [Vec<usize>; 2])> = None;
        for plane in wanted {
            let level = self.planes[plane];
            let (mut front, mut behind, mut split) = (Vec::new(), Vec::new(), 0);
            for (k, piece) in pieces.iter().enumerate() {
                if piece.side == SideSurface::Flat(plane) {
                    continue;
                }
                let [low, high] = level.range(piece.body.points());
                let (ahead, back) = (high > self.epsilon, low < -self.epsilon);
                split += usize::from(ahead && back);
                if ahead {
                    front.push(k);
                }
                if back {
                    behind.push(k);
                }
            }
            let parts = front.len() < pieces.len() && behind.len() < pieces.len();
            if rounds_only && !parts {
                continue;
            }
            // One side free of pieces costs nothing at all; else few cut pieces, then even halves.
            let lone = front.is_empty() || behind.is_empty();
            let cost = if lone { 0 } else { 1 + 4 * split + front.len().abs_diff(behind.len()) };
            if best.as_ref().is_none_or(|b| cost < b.0) {
                best = Some((cost, plane, [front, behind]));
            }
            if cost == 0 {
                break;
            }
        }
        best.map(|(_, plane, parts)| (plane, parts)).ok_or(Tangled::Rounds)
    }
}

/// Tests whether the set of one division contains that of another within a cell; `false` also if
/// `steps` do not suffice.
pub(super) struct Containment<'a> {
    pub planes: &'a [HessePlane],
    pub epsilon: f64,
    pub steps: usize,
}

impl Containment<'_> {
    /// True if `inner` is contained in `outer`.
    pub fn holds(&mut self, inner: &BspTree, outer: &BspTree, cell: &Polytope) -> bool {
        if self.steps == 0 {
            return false;
        }
        self.steps -= 1;
        match (inner, outer) {
            (BspTree::Air, _) | (_, BspTree::Solid) => true,
            (BspTree::Round(a), BspTree::Round(b)) => a == b,
            (BspTree::Split { plane, parts }, _) => {
                self.both(*plane, cell, |this, side, part| this.holds(&parts[side], outer, part))
            }
            (_, BspTree::Split { plane, parts }) => {
                self.both(*plane, cell, |this, side, part| this.holds(inner, &parts[side], part))
            }
            (_, BspTree::Air) | (BspTree::Solid, BspTree::Round(_)) => false,
        }
    }

    fn both(
        &mut self,
        plane: usize,
        cell: &Polytope,
        each: impl Fn(&mut Self, usize, &Polytope) -> bool,
    ) -> bool {
        let level = self.planes[plane];
        let parts = [cell.cut(&level, self.epsilon), cell.cut(&level.turned(), self.epsilon)];
        parts.iter().enumerate().all(|(side, part)| match part {
            Some(part) => each(self, side, part),
            None => true,
        })
    }
}
