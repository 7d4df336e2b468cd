//! Edges of blocks that are a part of another's edge: pieces broken where others begin or end.

use super::draft::BlockDraft;
use moldloft_num::trace::{Edge, Edges, Face, Mark, Piece, Root};
use std::collections::HashMap;

/// Divisions nearer than this to a whole number are whole.
const WHOLE: f64 = 1e-9;

/// Ends of pieces on each root, in order of its parameter.
pub(crate) struct Marks {
    of: HashMap<Root, Vec<Mark<f64>>>,
}

impl Marks {
    pub fn new(drafts: &[BlockDraft]) -> Self {
        let mut of: HashMap<Root, Vec<Mark<f64>>> = HashMap::new();
        for edges in drafts.iter().flat_map(BlockDraft::edges) {
            let chains = edges.edges.iter().filter_map(|edge| match edge {
                Edge::Pieces(pieces) => Some(pieces),
                _ => None,
            });
            for piece in chains.flatten() {
                of.entry(piece.root).or_default().extend([piece.from, piece.to]);
            }
        }
        for marks in of.values_mut() {
            // At one position a mark with a point object takes precedence.
            marks.sort_by(|a, b| a.t.total_cmp(&b.t).then(b.point.cmp(&a.point)));
            marks.dedup_by(|next, kept| {
                next.t == kept.t && (next.point.is_none() || next.point == kept.point)
            });
        }
        Self { of }
    }

    /// A mark with the point object at its position, if it has none itself.
    fn named(&self, root: Root, mark: Mark<f64>) -> Mark<f64> {
        let there = self.of[&root].iter().find(|m| m.t == mark.t);
        mark.point.map_or(there.copied().unwrap_or(mark), |_| mark)
    }

    /// The parts of `pieces` between all marks: each with the fraction of the whole at its end, and
    /// whether it continues in the next one's piece.
    pub fn parts(&self, pieces: &[Piece<f64>]) -> Vec<EdgePart> {
        let mut parts = Vec::new();
        let mut begin = 0.0;
        for piece in pieces {
            let piece = Piece {
                from: self.named(piece.root, piece.from),
                to: self.named(piece.root, piece.to),
                ..*piece
            };
            let (t0, t1) = (piece.from.t, piece.to.t);
            let inside = self.of[&piece.root].iter().filter(|m| {
                let (low, high) = (t0.min(t1), t0.max(t1));
                low < m.t && m.t < high
            });
            let mut breaks: Vec<Mark<f64>> = inside.copied().collect();
            breaks.dedup_by(|a, b| a.t == b.t);
            if t0 > t1 {
                breaks.reverse();
            }
            let mut from = piece.from;
            for mark in breaks {
                let until = begin + (piece.until - begin) * (mark.t - t0) / (t1 - t0);
                let part = Piece { from, to: mark, until, ..piece };
                parts.push(EdgePart { piece: part, goes_on: true });
                from = mark;
            }
            parts.push(EdgePart { piece: Piece { from, ..piece }, goes_on: false });
            begin = piece.until;
        }
        parts
    }
}

/// A part of an edge between two marks of its root.
pub(crate) struct EdgePart {
    pub piece: Piece<f64>,
    /// True when the next part is of the same piece.
    pub goes_on: bool,
}

impl BlockDraft<'_> {
    /// The edges of all faces and layers.
    fn edges(&self) -> impl Iterator<Item = &Edges<f64>> {
        let faces = self.faces.faces.iter().filter_map(|face| match face {
            Face::On { edges, .. } => Some(&**edges),
            _ => None,
        });
        let layers = self.faces.layers.iter().flat_map(|l| &l.surfaces);
        faces.chain(layers.map(|(_, edges)| edges))
    }
}

/// The runs of an edge with `cells` cells whose ends fall on its vertices: first and last vertex,
/// and the piece. Parts whose ends do not are joined to the next one of the same piece.
pub(crate) fn runs(parts: &[EdgePart], cells: usize) -> Vec<(usize, usize, Piece<f64>)> {
    let place = |share: f64| {
        let at = share * cells as f64;
        ((at - at.round()).abs() <= WHOLE).then(|| at.round() as usize)
    };
    let mut runs = Vec::new();
    let mut begin = 0.0;
    let mut from: Option<(f64, Mark<f64>)> = None;
    for EdgePart { piece, goes_on } in parts {
        let (start, mark) = *from.get_or_insert((begin, piece.from));
        begin = piece.until;
        match (place(start), place(piece.until)) {
            (Some(first), Some(last)) if last > first => {
                runs.push((first, last, Piece { from: mark, ..*piece }));
                from = None;
            }
            // A start that is on no vertex cannot be mended by going on.
            (Some(_), None) if *goes_on => {}
            _ => from = None,
        }
    }
    runs
}
