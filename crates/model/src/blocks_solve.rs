//! The divisions of volume blocks, solved through all of them.

use crate::blocks::{BlockRemark, Draft, FaceId, Joiner, Stretch, face_axes, face_id, stretch};
use crate::panel::UnionFind;
use moldloft_num::trace::{Edge, Edges, Face, Law, Turn};
use moldloft_registry::Fault;
use std::collections::HashMap;

/// Cells along an axis of which nobody says anything.
const USUAL: usize = 8;

/// Divisions of each block, and what was noticed.
pub(crate) struct Solved {
    pub divisions: Vec<[usize; 3]>,
    pub remarks: Vec<BlockRemark>,
}

/// Which axes of which blocks (number 3 b + axis) have one number of divisions.
pub(crate) struct Classes {
    equal: UnionFind,
    stretches: HashMap<Stretch, usize>,
    /// An axis, a share of it, and the stretch that runs along that share.
    shares: Vec<(usize, f64, Stretch)>,
}

impl Classes {
    pub fn of(joiner: &mut Joiner) -> Self {
        let drafts = joiner.drafts;
        let mut classes = Self {
            equal: UnionFind::new(3 * drafts.len()),
            stretches: HashMap::new(),
            shares: Vec::new(),
        };
        let mut faces: HashMap<FaceId, [usize; 2]> = HashMap::new();
        let mut lines: HashMap<(Vec<u32>, Law), usize> = HashMap::new();
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
                    classes.along_edges(edges, axes(f, *turn));
                }
            }
            let Some(layers) = &draft.faces.layers else { continue };
            for (_, edges) in &layers.surfaces {
                classes.along_edges(edges, axes(4, Turn::default()));
            }
            if matches!(layers.law, Law::Along(None, _)) {
                continue;
            }
            for corner in [[0, 0], [1, 0], [0, 1], [1, 1]] {
                let line = (joiner.roots(b, corner), layers.law);
                let known = *lines.entry(line).or_insert(3 * b + 2);
                classes.equal.join(known as u32, (3 * b + 2) as u32);
            }
        }
        classes
    }

    fn along_edges(&mut self, edges: &Edges<f64>, [u, v]: [usize; 2]) {
        for (edge, axis) in edges.edges.iter().zip([u, v, u, v]) {
            let Edge::Pieces(pieces) = edge else { continue };
            if let [whole] = pieces.as_slice() {
                let known = *self.stretches.entry(stretch(whole).0).or_insert(axis);
                self.equal.join(known as u32, axis as u32);
                continue;
            }
            let mut begin = 0.0;
            for piece in pieces {
                self.shares.push((axis, piece.until - begin, stretch(piece).0));
                begin = piece.until;
            }
        }
    }

    /// # Errors
    /// `divisions-contradict` when two numbers are given for one class.
    pub fn solved(mut self, drafts: &[Draft]) -> Result<Solved, Fault> {
        let count = 3 * drafts.len();
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
        // What the others of a chain say, until nothing is new.
        let shares: Vec<(usize, f64, usize)> = self
            .shares
            .iter()
            .filter_map(|(axis, share, stretch)| {
                let part = *self.stretches.get(stretch)?;
                Some((*axis, *share, part))
            })
            .collect();
        let mut remarks = Vec::new();
        for round in 0..=count {
            let mut changed = false;
            for &(whole, share, part) in &shares {
                let [w, p] = [whole, part].map(|a| self.equal.find(a as u32) as usize);
                let near =
                    |x: f64| ((x - x.round()).abs() < 1e-9 && x >= 0.5).then(|| x.round() as usize);
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
                    known[class].map_or(USUAL, |(n, _)| n)
                })
            })
            .collect();
        for &(whole, share, part) in &shares {
            let n = |a: usize| divisions[a / 3][a % 3];
            if (n(whole) as f64 * share - n(part) as f64).abs() > 1e-9 {
                let name = |a: usize| drafts[a / 3].object.name.to_string();
                remarks.push(BlockRemark::Divisions {
                    blocks: [name(whole), name(part)],
                    divisions: [n(whole), n(part)],
                    share,
                });
            }
        }
        Ok(Solved { divisions, remarks })
    }
}

fn contradiction(drafts: &[Draft], (n, a): (usize, usize), (m, b): (usize, usize)) -> Fault {
    let name = |at: usize| &drafts[at / 3].object.name;
    let axis = |at: usize| ["u", "v", "w"][at % 3];
    let message = format!(
        "`{}` has {n} cells along {} but `{}` has {m} along {}, and shared faces and edges make them one number",
        name(a),
        axis(a),
        name(b),
        axis(b)
    );
    Fault::new("divisions-contradict", message)
        .expected("one number of cells along edges that blocks share, directly or through others")
        .found(format!("{n} and {m}"))
        .related(Some(drafts[a / 3].object.key), format!("has {n} along {}", axis(a)))
        .related(Some(drafts[b / 3].object.key), format!("has {m} along {}", axis(b)))
        .help("write 0 for the divisions that neighbours decide")
}
