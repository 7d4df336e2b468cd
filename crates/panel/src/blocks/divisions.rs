//! The divisions of volume blocks, solved through all of them.

use super::draft::{BlockDraft, FaceId, RootInterval, face_axes, face_id, interval};
use super::joiner::BlockJoiner;
use super::marks::{EdgePart, Marks};
use super::notes::BlockNote;
use moldloft_num::trace::{Edge, Edges, Face, LayerLaw, Piece, Turn};
use moldloft_num::union_find::UnionFind;
use moldloft_registry::CallError;
use std::collections::HashMap;

/// Divisions nearer than this to a whole number are whole.
const WHOLE: f64 = 1e-9;

/// Default number of cells along an axis.
const DEFAULT_DIVISIONS: usize = 8;

/// Divisions of each block, and the notes about them.
pub(crate) struct BlockDivisions {
    pub divisions: Vec<[usize; 3]>,
    pub remarks: Vec<BlockNote>,
}

/// Axes of blocks (number 3 b + axis), and stretches of roots (numbers above those), with equal
/// numbers of divisions.
pub(crate) struct DivisionClasses {
    equal: UnionFind,
    intervals: HashMap<RootInterval, usize>,
    /// An axis, a fraction of it, and the number of the stretch along that fraction.
    shares: Vec<(usize, f64, usize)>,
}

impl DivisionClasses {
    pub fn of(joiner: &mut BlockJoiner) -> Self {
        let drafts = joiner.drafts;
        let mut classes = Self {
            equal: UnionFind::new(3 * drafts.len()),
            intervals: HashMap::new(),
            shares: Vec::new(),
        };
        let mut faces: HashMap<FaceId, [usize; 2]> = HashMap::new();
        let mut lines: HashMap<(Vec<u32>, LayerLaw), usize> = HashMap::new();
        for (b, draft) in drafts.iter().enumerate() {
            let axes = |f: usize, turn: Turn| {
                let [p, q] = face_axes(f).map(|axis| 3 * b + axis);
                if turn.swaps() { [q, p] } else { [p, q] }
            };
            for (f, face) in draft.faces.faces.iter().enumerate() {
                let mut one = |id: FaceId, axes: [usize; 2]| {
                    let known = *faces.entry(id).or_insert(axes);
                    (0..2).for_each(|k| classes.equal.join(known[k] as u32, axes[k] as u32));
                };
                one(FaceId::Solid(draft.object.key, f as u8), axes(f, Turn::default()));
                if let Face::On { surface, face_of, turn, edges } = face {
                    if let Some(id) = face_id(*surface, *face_of) {
                        one(id, axes(f, *turn));
                    }
                    classes.along_edges(&joiner.marks, edges, axes(f, *turn));
                }
            }
            let Some(layers) = &draft.faces.layers else { continue };
            for (_, edges) in &layers.surfaces {
                classes.along_edges(&joiner.marks, edges, axes(4, Turn::default()));
            }
            if matches!(layers.law, LayerLaw::Along(None, _)) {
                continue;
            }
            for corner in [[0, 0], [1, 0], [0, 1], [1, 1]] {
                let mut roots = joiner.roots(b, corner);
                if !matches!(layers.law, LayerLaw::Along(..)) && roots.last() < roots.first() {
                    roots.reverse();
                }
                let line = (roots, layers.law);
                let known = *lines.entry(line).or_insert(3 * b + 2);
                classes.equal.join(known as u32, (3 * b + 2) as u32);
            }
        }
        classes
    }

    fn along_edges(&mut self, marks: &Marks, edges: &Edges<f64>, [u, v]: [usize; 2]) {
        for (edge, axis) in edges.edges.iter().zip([u, v, u, v]) {
            let Edge::Pieces(pieces) = edge else { continue };
            let parts = marks.parts(pieces);
            if let ([_], [first, .., last]) = (pieces.as_slice(), parts.as_slice()) {
                let whole = Piece { from: first.piece.from, ..last.piece };
                let number = self.number(interval(&whole).0);
                self.equal.join(number as u32, axis as u32);
            }
            if let [EdgePart { piece, .. }] = parts.as_slice() {
                let number = self.number(interval(piece).0);
                self.equal.join(number as u32, axis as u32);
                continue;
            }
            let mut begin = 0.0;
            for EdgePart { piece, .. } in parts {
                let number = self.number(interval(&piece).0);
                self.shares.push((axis, piece.until - begin, number));
                begin = piece.until;
            }
        }
    }

    fn number(&mut self, interval: RootInterval) -> usize {
        *self.intervals.entry(interval).or_insert_with(|| self.equal.push() as usize)
    }

    /// # Errors
    /// `divisions-contradict` when two numbers are given for one class.
    pub fn solved(mut self, drafts: &[BlockDraft]) -> Result<BlockDivisions, CallError> {
        let count = 3 * drafts.len() + self.intervals.len();
        let mut known: Vec<Option<(usize, usize)>> = vec![None; count];
        for (b, draft) in drafts.iter().enumerate() {
            for axis in 0..3 {
                let given = draft.object.head.blocks[axis] as usize;
                if given == 0 {
                    continue;
                }
                let class = self.equal.find((3 * b + axis) as u32) as usize;
                match known[class] {
                    Some((n, by)) if n != given => {
                        return Err(contradiction(drafts, (n, by), (given, 3 * b + axis)));
                    }
                    Some(_) => {}
                    None => known[class] = Some((given, 3 * b + axis)),
                }
            }
        }
        // Propagate along chains until nothing changes.
        let mut remarks = Vec::new();
        for round in 0..=count {
            let mut changed = false;
            for &(whole, share, part) in &self.shares {
                let [w, p] = [whole, part].map(|a| self.equal.find(a as u32) as usize);
                let near = |x: f64| {
                    ((x - x.round()).abs() < WHOLE && x >= 0.5).then(|| x.round() as usize)
                };
                match (known[w], known[p]) {
                    (Some((n, by)), None) => {
                        if let Some(m) = near(n as f64 * share) {
                            known[p] = Some((m, by));
                            changed = true;
                        }
                    }
                    (None, Some((m, by))) => {
                        if let Some(n) = near(m as f64 / share) {
                            known[w] = Some((n, by));
                            changed = true;
                        }
                    }
                    _ => {}
                }
            }
            if !changed {
                break;
            }
            debug_assert!(round < count, "each round settles a class");
        }
        let divisions: Vec<[usize; 3]> = (0..drafts.len())
            .map(|b| {
                std::array::from_fn(|axis| {
                    let class = self.equal.find((3 * b + axis) as u32) as usize;
                    known[class].map_or(DEFAULT_DIVISIONS, |(n, _)| n)
                })
            })
            .collect();
        // All axes along a stretch must have as many cells there as the first.
        let mut first: HashMap<usize, (usize, f64)> = HashMap::new();
        for (axis, n) in divisions.iter().flatten().enumerate() {
            first.entry(self.equal.find(axis as u32) as usize).or_insert((axis, *n as f64));
        }
        for &(whole, share, part) in &self.shares {
            let n = divisions[whole / 3][whole % 3];
            let along = n as f64 * share;
            let part = self.equal.find(part as u32) as usize;
            let &mut (other, m) = first.entry(part).or_insert((whole, along));
            if (along - m).abs() > WHOLE {
                let name = |a: usize| drafts[a / 3].object.name.to_string();
                let blocks = [name(whole), name(other)];
                remarks.push(BlockNote::Divisions { blocks, divisions: n, along: m, share });
            }
        }
        Ok(BlockDivisions { divisions, remarks })
    }
}

fn contradiction(
    drafts: &[BlockDraft],
    (n, a): (usize, usize),
    (m, b): (usize, usize),
) -> CallError {
    let name = |at: usize| &drafts[at / 3].object.name;
    let axis = |at: usize| ["u", "v", "w"][at % 3];
    let message = format!(
        "`{}` has {n} cells along {} but `{}` has {m} along {}, and shared faces and edges require equal counts",
        name(a),
        axis(a),
        name(b),
        axis(b)
    );
    CallError::new("divisions-contradict", message)
        .expected("one number of cells along edges that blocks share, directly or through others")
        .found(format!("{n} and {m}"))
        .related(Some(drafts[a / 3].object.key), format!("has {n} along {}", axis(a)))
        .related(Some(drafts[b / 3].object.key), format!("has {m} along {}", axis(b)))
        .help("write 0 for the divisions that neighbours decide")
}
