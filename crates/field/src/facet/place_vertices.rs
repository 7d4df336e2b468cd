//! Placement of the vertices of a piece of surface in a cell: one on all its primitives or, if
//! these have no common point in the cell, several.

use super::cell::faces_of;
use super::split::split;
use super::types::{EdgeCrossing, Ring, Split};
use super::vertex::{PlacedVertex, Solver, Surfaces};
use crate::expr::form::Form;
use crate::expr::tape::{ExprTape, NO_LEAF};
use crate::set::Leaf;
use moldloft_num::{Box3, Vec3};
use smallvec::SmallVec;

/// An edge or corner within this fraction of a cell from its vertex counts as hit: such are
/// those of surfaces that touch along it.
const MIN_FEATURE: f64 = 0.01;
/// Distance of probes beside an edge, in cells, …
const ASIDE: f64 = 1e-4;
/// … where surfaces meet at an angle of more than this.
const TOUCH: f64 = 1e-2;

/// Context of the placement in one cell.
pub(super) struct VertexPlacer<'a> {
    pub(super) tape: &'a ExprTape<f64>,
    pub(super) leaves: &'a [Leaf],
    pub(super) cell: &'a Box3,
    pub(super) goal: f64,
    pub(super) solver: &'a mut Solver,
    pub(super) registers: &'a mut Vec<f64>,
}

pub(super) enum PieceVertices {
    /// One vertex, on these surfaces; `blunt` if it should be on more, `creased` if one of them has an edge of its own.
    One { placed: PlacedVertex, surfaces: Surfaces, blunt: bool, creased: bool },
    /// Several.
    Several(Split),
}

impl VertexPlacer<'_> {
    /// The vertices of the piece of surface with these crossings; `next` is the edge after each edge.
    pub(super) fn vertices(&mut self, edges: &Ring, next: &[u8; 12]) -> PieceVertices {
        let mut surfaces = Surfaces::new();
        let mut sum = Vec3::zero();
        let mut count = 0.0;
        for (_, crossing) in edges {
            sum += crossing.point;
            count += 1.0;
            if let Err(place) = surfaces.binary_search(&crossing.leaf) {
                surfaces.insert(place, crossing.leaf);
            }
        }
        let middle = sum / count;
        let mut placed = self.place(&surfaces, middle);
        if placed.residual > self.goal {
            placed = self.by_sides(&surfaces, edges, placed);
        }
        if placed.residual > self.goal {
            // The edge or corner indicated by the crossings is in a neighbour, or there are
            // several.
            let Self { leaves, cell, goal, .. } = *self;
            let stray = |work: &mut Self, surfaces: &Surfaces| {
                let found = work.solver.outside_cell(leaves, surfaces, middle, cell, goal);
                work.shown(found, surfaces)
            };
            let strayed = (surfaces.len() <= 3).then(|| stray(self, &surfaces));
            match strayed.filter(|s| s.residual <= goal) {
                Some(strayed) => placed = strayed,
                None => {
                    if let Some(several) = split(self, edges, next) {
                        return PieceVertices::Several(several);
                    }
                    let strayed = stray(self, &surfaces);
                    if strayed.residual > goal {
                        let wanted = std::mem::take(&mut surfaces);
                        let (placed, surfaces) = self.blunt(edges);
                        let blunt = self.away(placed.point, &wanted);
                        return PieceVertices::One { placed, surfaces, blunt, creased: false };
                    }
                    placed = strayed;
                }
            }
        }
        // The tip of a cone is a vertex.
        if let Some(apex) = self.apex(&surfaces) {
            placed = PlacedVertex { point: apex, residual: 0.0, strayed: false };
        }
        // A primitive without a crossing of its own may still cut the vertex off: an edge or corner
        // that only pokes into the cell.
        while surfaces.len() < 3 && placed.residual <= self.goal {
            let Some(leaf) = self.blocking_leaf(placed.point, &surfaces) else { break };
            let Err(place) = surfaces.binary_search(&leaf) else { break };
            let mut more = surfaces.clone();
            more.insert(place, leaf);
            let other = self.place(&more, placed.point);
            if other.residual > self.goal {
                break;
            }
            (placed, surfaces) = (PlacedVertex { strayed: placed.strayed, ..other }, more);
        }
        let creased = |s: &u32| self.leaves[*s as usize].primitive.tape().creased_in(self.cell);
        let creased = surfaces.iter().any(creased);
        PieceVertices::One { placed, surfaces, blunt: false, creased }
    }

    /// The apex of a cone that a piece of surface shows, if it is in the cell, on the others and on the set's surface.
    fn apex(&mut self, surfaces: &[u32]) -> Option<Vec3> {
        let cell = self.cell;
        for &leaf in surfaces {
            let Form::Cone { axis, .. } = self.leaves[leaf as usize].primitive.form() else {
                continue;
            };
            let p = axis.point;
            let within = (0..3).all(|k| cell.low[k] <= p[k] && p[k] <= cell.high[k]);
            let goal = self.goal;
            let on = |solver: &mut Solver, other: u32| {
                let g = solver.gradient(self.leaves[other as usize].primitive.tape(), p);
                g.value.abs() <= goal * g.slope.norm()
            };
            if within
                && surfaces.iter().all(|&o| o == leaf || on(&mut *self.solver, o))
                && self.blocking_leaf(p, surfaces).is_none()
            {
                return Some(p);
            }
        }
        None
    }

    /// True when a point is so far from one of the surfaces that this must be reported.
    fn away(&mut self, p: Vec3, surfaces: &[u32]) -> bool {
        let slack = MIN_FEATURE * shortest(self.cell);
        surfaces.iter().any(|&s| {
            let g = self.solver.gradient(self.leaves[s as usize].primitive.tape(), p);
            let near = g.value.abs() <= slack * g.slope.norm();
            !near
        })
    }

    /// A point of the cell on as many of a piece's surfaces as two or, failing that, one: that with the most
    /// crossings, which is at one of these at worst.
    pub(super) fn blunt(&mut self, edges: &Ring) -> (PlacedVertex, Surfaces) {
        let leaves = by_number(edges);
        for (k, &a) in leaves.iter().enumerate() {
            for &b in &leaves[k + 1..] {
                let pair = Surfaces::from_slice(&[a.min(b), a.max(b)]);
                let placed = self.place(&pair, mean(edges, &pair));
                if placed.residual <= self.goal && self.blocking_leaf(placed.point, &pair).is_none()
                {
                    return (placed, pair);
                }
            }
        }
        self.flat(edges, *self.cell)
    }

    /// A point of the cell on one of a piece's surfaces, near a point beside the cell.
    pub(super) fn near(&mut self, edges: &Ring, at: Vec3) -> (PlacedVertex, Surfaces) {
        let clamped = [0, 1, 2].map(|k| at[k].clamp(self.cell.low[k], self.cell.high[k]));
        let mut best: Option<(f64, PlacedVertex, u32)> = None;
        for leaf in by_number(edges) {
            let placed = self.place(&[leaf], clamped.into());
            let far = placed.point.distance(at);
            let real =
                placed.residual <= self.goal && self.blocking_leaf(placed.point, &[leaf]).is_none();
            if real && best.as_ref().is_none_or(|b| far < b.0) {
                best = Some((far, placed, leaf));
            }
        }
        match best {
            Some((_, placed, leaf)) => (placed, Surfaces::from_slice(&[leaf])),
            None => self.flat(edges, *self.cell),
        }
    }

    /// A point of a box on one of a piece's surfaces, that with the most crossings.
    pub(super) fn flat(&mut self, edges: &Ring, within: Box3) -> (PlacedVertex, Surfaces) {
        for leaf in by_number(edges) {
            let start = mean(edges, &[leaf]);
            let placed = self.solver.place(self.leaves, &[leaf], start, &within, self.goal);
            if placed.residual <= self.goal {
                return (placed, Surfaces::from_slice(&[leaf]));
            }
        }
        nearest(edges)
    }

    /// The primitive that decides at a point which is not on the set's surface, unless it is one of `known`.
    pub(super) fn blocking_leaf(&mut self, at: Vec3, known: &[u32]) -> Option<u32> {
        let value = self.tape.eval::<f64>(&at, self.registers);
        let leaf = self.tape.leaf[self.tape.winner(self.registers, |v: f64| v)];
        if leaf == NO_LEAF || known.contains(&leaf) {
            return None;
        }
        let gradient = self.solver.gradient(self.leaves[leaf as usize].primitive.tape(), at);
        (value.abs() > self.goal * gradient.slope.norm()).then_some(leaf)
    }

    /// The face of the cell that contains both edges, as a flat box.
    pub(super) fn shared_side(&self, e: usize, f: usize) -> Option<Box3> {
        let shared = faces_of(e) & faces_of(f);
        if shared == 0 {
            return None;
        }
        let face = shared.trailing_zeros() as usize;
        let (mut low, mut high) = (self.cell.low.to_array(), self.cell.high.to_array());
        let at = if face.is_multiple_of(2) { low[face / 2] } else { high[face / 2] };
        (low[face / 2], high[face / 2]) = (at, at);
        Some(Box3 { low: low.into(), high: high.into() })
    }

    /// Intersection of two surfaces on a face of the cell, between two crossings.
    pub(super) fn change(
        &mut self,
        p: &EdgeCrossing,
        q: &EdgeCrossing,
        side: &Box3,
    ) -> Option<PlacedVertex> {
        let both = [p.leaf.min(q.leaf), p.leaf.max(q.leaf)];
        let start = (p.point + q.point) * 0.5;
        let change = self.solver.place(self.leaves, &both, start, side, self.goal);
        let change = self.shown(change, &both);
        (change.residual <= self.goal).then_some(change)
    }

    /// A better position than `placed`, from the faces of the cell. Between two neighbouring
    /// crossings of different primitives the surface changes from one to the other on the face
    /// between them; the vertex is near such points.
    fn by_sides(
        &mut self,
        surfaces: &[u32],
        edges: &Ring,
        mut placed: PlacedVertex,
    ) -> PlacedVertex {
        let goal = self.goal;
        let mut sum = Vec3::zero();
        let mut count = 0.0;
        let mut changes: SmallVec<[PlacedVertex; 4]> = SmallVec::new();
        for (e, p) in edges {
            for (f, q) in edges.iter().filter(|(f, q)| f > e && q.leaf != p.leaf) {
                let Some(side) = self.shared_side(*e, *f) else { continue };
                if let Some(change) = self.change(p, q, &side) {
                    sum += change.point;
                    count += 1.0;
                    changes.push(change);
                }
            }
        }
        if count > 0.0 {
            let inner = self.place(surfaces, sum / count);
            if inner.residual < placed.residual {
                placed = inner;
            }
        }
        for change in changes {
            if placed.residual > goal && surfaces.len() == 2 {
                placed = change;
            }
        }
        for (_, crossing) in edges {
            if placed.residual <= goal {
                break;
            }
            let other = self.place(surfaces, crossing.point);
            if other.residual < placed.residual {
                placed = other;
            }
        }
        placed
    }

    pub(super) fn place(&mut self, surfaces: &[u32], start: Vec3) -> PlacedVertex {
        let found = self.solver.place(self.leaves, surfaces, start, self.cell, self.goal);
        self.shown(found, surfaces)
    }

    /// A point of two or three surfaces if it is on an edge or in a corner of the set; hidden
    /// points, such as the other half of a double cone, are rejected.
    fn shown(&mut self, found: PlacedVertex, surfaces: &[u32]) -> PlacedVertex {
        let asked = (2..=3).contains(&surfaces.len()) && !self.tape.has_users();
        if !asked || found.residual > self.goal {
            return found;
        }
        let p = found.point;
        let mut normals: SmallVec<[Vec3; 3]> = SmallVec::new();
        for &s in surfaces {
            let slope = self.solver.gradient(self.leaves[s as usize].primitive.tape(), p).slope;
            let size = slope.norm();
            if !(size > 0.0 && size.is_finite()) {
                return found;
            }
            normals.push(slope / size);
        }
        let reach = ASIDE * shortest(self.cell);
        for (k, &own) in surfaces.iter().enumerate() {
            let mut lines: SmallVec<[Vec3; 2]> = SmallVec::new();
            for (_, n) in normals.iter().enumerate().filter(|(j, _)| *j != k) {
                let line = normals[k].cross(*n);
                let size = line.norm();
                // Surfaces that touch say nothing of each other.
                if size < TOUCH {
                    return found;
                }
                // Across one edge; between two.
                lines.push(if surfaces.len() == 2 { line.cross(normals[k]) } else { line } / size);
            }
            let aside: SmallVec<[Vec3; 4]> = match lines[..] {
                [across] => SmallVec::from_slice(&[across, -across]),
                [u, v] => SmallVec::from_slice(&[u + v, u - v, v - u, -u - v]),
                _ => return found,
            };
            let hidden = aside.into_iter().all(|d| {
                let size = d.norm();
                if size < TOUCH {
                    return false;
                }
                self.tape.eval::<f64>(&(p + d * (reach / size)), self.registers);
                let leaf = self.tape.leaf[self.tape.winner(self.registers, |v: f64| v)];
                leaf != own && surfaces.contains(&leaf)
            });
            if hidden {
                return PlacedVertex { residual: f64::INFINITY, ..found };
            }
        }
        found
    }
}

fn shortest(cell: &Box3) -> f64 {
    (0..3).map(|k| cell.high[k] - cell.low[k]).fold(f64::INFINITY, f64::min)
}

/// The primitives that crossings show, those with the most crossings first.
fn by_number(edges: &Ring) -> Surfaces {
    let mut leaves: Surfaces = edges.iter().map(|e| e.1.leaf).collect();
    leaves.sort_unstable();
    leaves.dedup();
    let number = |leaf: u32| edges.iter().filter(|e| e.1.leaf == leaf).count();
    leaves.sort_by_key(|&leaf| std::cmp::Reverse(number(leaf)));
    leaves
}

/// The mean of the crossings that show some primitives.
fn mean(edges: &Ring, of: &[u32]) -> Vec3 {
    let (mut sum, mut count) = (Vec3::zero(), 0.0);
    for (_, crossing) in edges.iter().filter(|e| of.contains(&e.1.leaf)) {
        sum += crossing.point;
        count += 1.0;
    }
    sum / count
}

/// The crossing that is nearest to the middle of all.
pub(super) fn nearest(edges: &Ring) -> (PlacedVertex, Surfaces) {
    let leaves: Surfaces = edges.iter().map(|e| e.1.leaf).collect();
    let middle = mean(edges, &leaves);
    let far = |e: &&(usize, &EdgeCrossing)| e.1.point.distance(middle);
    let (point, leaf) = edges
        .iter()
        .min_by(|a, b| far(a).total_cmp(&far(b)))
        .map_or((middle, 0), |e| (e.1.point, e.1.leaf));
    (PlacedVertex { point, residual: 0.0, strayed: false }, Surfaces::from_slice(&[leaf]))
}
