//! Interfaces of structured blocks: rectangles of common cell faces; and faces without a neighbour.

use super::HexBlock;
use std::collections::{HashMap, HashSet};

/// A rectangle of a block's face that coincides, vertex by vertex, with a rectangle of another
/// block's face or of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Interface {
    /// The two faces: (block, face 0..6), the earlier first.
    pub sides: [(usize, usize); 2],
    /// Start in each block, (i, j, k).
    pub from: [[usize; 3]; 2],
    /// End in each block; in the first no index is less than in `from`.
    pub to: [[usize; 3]; 2],
    /// For each axis u, v, w of the first block, the corresponding axis of the second, and true if
    /// reversed. The axis normal to the face continues into the second block.
    pub axes: [(usize, bool); 3],
}

impl Interface {
    /// For each axis of the first block, the axis of the second, from 1, negative if reversed; as in CGNS.
    pub fn transform(&self) -> [i32; 3] {
        self.axes.map(|(axis, against)| {
            let number = axis as i32 + 1;
            if against { -number } else { number }
        })
    }
}

/// A rectangle of a face without a neighbour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Boundary {
    /// The block.
    pub block: usize,
    /// Its face 0..6.
    pub face: usize,
    /// Start, (i, j, k).
    pub from: [usize; 3],
    /// End; no index is less than in `from`.
    pub to: [usize; 3],
}

/// Relation of the parameters of two faces: swapped, then each reversed or not.
#[derive(Clone, Copy, PartialEq, Eq)]
struct FaceOrientation {
    swap: bool,
    flip: [bool; 2],
}

impl FaceOrientation {
    const ALL: [FaceOrientation; 8] = {
        let mut all = [FaceOrientation { swap: false, flip: [false; 2] }; 8];
        let mut bits = 0;
        while bits < 8 {
            all[bits] =
                FaceOrientation { swap: bits & 1 == 1, flip: [bits & 2 == 2, bits & 4 == 4] };
            bits += 1;
        }
        all
    };

    /// The step on the second face for the step (a, b) on the first.
    fn step(self, a: isize, b: isize) -> [isize; 2] {
        let [a, b] = if self.swap { [b, a] } else { [a, b] };
        [if self.flip[0] { -a } else { a }, if self.flip[1] { -b } else { b }]
    }
}

/// A panel of a face: block, face, and indices.
type Place = (usize, usize, [usize; 2]);

/// A rectangle of panels of one face, and those of another that they are.
struct Rectangle {
    size: [usize; 2],
    panels: Vec<(Place, Place)>,
}

/// The faces of all blocks, panel by panel.
struct BlockFaces<'a> {
    blocks: &'a [HexBlock],
    /// Number of faces of each block that may join.
    faces: usize,
    /// Panels with three or four corners by their corners, in ascending order.
    by_corners: HashMap<[u32; 4], Vec<Place>>,
    taken: HashSet<Place>,
}

impl<'a> BlockFaces<'a> {
    fn new(blocks: &'a [HexBlock], faces: usize) -> Self {
        let mut faces = Self { blocks, faces, by_corners: HashMap::new(), taken: HashSet::new() };
        for place in faces.places() {
            if let Some(corners) = faces.corners(place) {
                faces.by_corners.entry(corners).or_default().push(place);
            }
        }
        faces
    }

    /// The panels of all faces that are not a line or a point, face by face.
    fn places(&self) -> Vec<Place> {
        let mut places = Vec::new();
        for (b, block) in self.blocks.iter().enumerate() {
            for face in 0..self.faces {
                if block.face_panels(face).is_empty() {
                    continue;
                }
                let [m, n] = block.face_size(face);
                let all = (0..m - 1).flat_map(|a| (0..n - 1).map(move |c| [a, c]));
                places.extend(all.map(|at| (b, face, at)));
            }
        }
        places
    }

    fn vertex(&self, block: usize, face: usize, at: [usize; 2]) -> u32 {
        let block = &self.blocks[block];
        block.at(block.on_face(face, at))
    }

    /// The corners in ascending order; `None` for a panel without area.
    fn corners(&self, (block, face, [a, b]): Place) -> Option<[u32; 4]> {
        let mut corners =
            [[a, b], [a + 1, b], [a, b + 1], [a + 1, b + 1]].map(|at| self.vertex(block, face, at));
        corners.sort_unstable();
        let equal = corners.windows(2).filter(|w| w[0] == w[1]).count();
        (equal < 2).then_some(corners)
    }

    /// The one other panel with the same corners.
    fn other(&self, place: Place) -> Option<Place> {
        match self.by_corners.get(&self.corners(place)?)?.as_slice() {
            &[a, b] => Some(if a == place { b } else { a }),
            _ => None,
        }
    }

    /// The panel on the second face that is `step` panels from `start` and has, in this
    /// orientation, the vertices of `own`.
    fn partner(
        &self,
        own: Place,
        start: Place,
        turn: FaceOrientation,
        step: [usize; 2],
    ) -> Option<Place> {
        let (block, face, _) = start;
        let size = self.blocks[block].face_size(face);
        let by = turn.step(step[0] as isize, step[1] as isize);
        let mut at = [0; 2];
        for k in 0..2 {
            at[k] = start.2[k].checked_add_signed(by[k])?;
            if at[k] + 1 >= size[k] {
                return None;
            }
        }
        let same = [[0, 0], [1, 0], [0, 1], [1, 1]].into_iter().all(|[x, y]| {
            let [c, d] = if turn.swap { [y, x] } else { [x, y] };
            let c = if turn.flip[0] { 1 - c } else { c };
            let d = if turn.flip[1] { 1 - d } else { d };
            self.vertex(own.0, own.1, [own.2[0] + x, own.2[1] + y])
                == self.vertex(block, face, [at[0] + c, at[1] + d])
        });
        same.then_some((block, face, at))
    }

    /// The largest rectangle from `own` on, first along its face's first parameter.
    fn grown(&self, own: Place, start: Place, turn: FaceOrientation) -> Rectangle {
        let [m, n] = self.blocks[own.0].face_size(own.1);
        let mut used: HashSet<Place> = HashSet::new();
        let pair = |a: usize, b: usize, used: &mut HashSet<Place>| {
            let here = (own.0, own.1, [own.2[0] + a, own.2[1] + b]);
            let there = self.partner(here, start, turn, [a, b])?;
            let free = |p: &Place| !self.taken.contains(p) && !used.contains(p);
            (here != there && free(&here) && free(&there)).then(|| {
                used.extend([here, there]);
                (here, there)
            })
        };
        let mut panels = Vec::new();
        while own.2[0] + panels.len() + 1 < m {
            match pair(panels.len(), 0, &mut used) {
                Some(both) => panels.push(both),
                None => break,
            }
        }
        let along = panels.len();
        let mut across = usize::from(along > 0);
        while along > 0 && own.2[1] + across + 1 < n {
            let row: Vec<_> = (0..along).map_while(|a| pair(a, across, &mut used)).collect();
            if row.len() < along {
                break;
            }
            panels.extend(row);
            across += 1;
        }
        Rectangle { size: [along, across], panels }
    }
}

/// All interfaces of the first `faces` faces of `blocks` (4 for the edges of surfaces that are blocks of one layer,
/// 6 for all), ordered by their first sides; and the boundary.
///
/// Panels are matched by the identity of their vertices. More than two with the same vertices are
/// not an interface.
pub fn interfaces_of(blocks: &[HexBlock], faces: usize) -> (Vec<Interface>, Vec<Boundary>) {
    let mut faces = BlockFaces::new(blocks, faces);
    let mut found = Vec::new();
    for own in faces.places() {
        if faces.taken.contains(&own) {
            continue;
        }
        let Some(start) = faces.other(own) else { continue };
        let grown =
            FaceOrientation::ALL.into_iter().map(|turn| (turn, faces.grown(own, start, turn)));
        let best =
            grown.fold(None, |best: Option<(FaceOrientation, Rectangle)>, next| match best {
                Some(best) if best.1.panels.len() >= next.1.panels.len() => Some(best),
                _ => Some(next),
            });
        let Some((turn, Rectangle { size, panels })) = best else { continue };
        if panels.is_empty() {
            continue;
        }
        faces.taken.extend(panels.iter().flat_map(|&(a, b)| [a, b]));
        found.push(interface(blocks, own, start, turn, size));
    }
    found.sort_by_key(|i: &Interface| i.sides);
    let free = boundaries(&mut faces);
    (found, free)
}

fn interface(
    blocks: &[HexBlock],
    own: Place,
    start: Place,
    turn: FaceOrientation,
    size: [usize; 2],
) -> Interface {
    let first = &blocks[own.0];
    let [a, b] = own.2;
    let from = first.on_face(own.1, own.2);
    let to = first.on_face(own.1, [a + size[0], b + size[1]]);
    // The corner of the partner's panel where the first panel begins, and the opposite one.
    let second = &blocks[start.0];
    let [c, d] = [0, 1].map(|k| start.2[k] + usize::from(turn.flip[k]));
    let by = turn.step(size[0] as isize, size[1] as isize);
    let end = [c.saturating_add_signed(by[0]), d.saturating_add_signed(by[1])];
    Interface {
        sides: [(own.0, own.1), (start.0, start.1)],
        from: [from, second.on_face(start.1, [c, d])],
        to: [to, second.on_face(start.1, end)],
        axes: axes(own.1, start.1, turn),
    }
}

/// Rectangles of the panels that no interface has.
fn boundaries(faces: &mut BlockFaces) -> Vec<Boundary> {
    let mut found = Vec::new();
    for own @ (block, face, [a, b]) in faces.places() {
        if faces.taken.contains(&own) {
            continue;
        }
        let [m, n] = faces.blocks[block].face_size(face);
        let free =
            |taken: &HashSet<Place>, c: usize, d: usize| !taken.contains(&(block, face, [c, d]));
        let along = (a..m - 1).take_while(|&c| free(&faces.taken, c, b)).count();
        let across =
            (b..n - 1).take_while(|&d| (a..a + along).all(|c| free(&faces.taken, c, d))).count();
        for c in a..a + along {
            faces.taken.extend((b..b + across).map(|d| (block, face, [c, d])));
        }
        let [from, to] =
            [[a, b], [a + along, b + across]].map(|at| faces.blocks[block].on_face(face, at));
        found.push(Boundary { block, face, from, to });
    }
    found
}

fn axes(face_a: usize, face_b: usize, turn: FaceOrientation) -> [(usize, bool); 3] {
    let ([p, q, own], [r, s, other]) = (HexBlock::face_axes(face_a), HexBlock::face_axes(face_b));
    let mut axes = [(0, false); 3];
    let on = |k: usize| ([r, s][k], turn.flip[k]);
    axes[p] = on(usize::from(turn.swap));
    axes[q] = on(usize::from(!turn.swap));
    // Out of the first at its high side means into the second at its low side.
    axes[own] = (other, face_a % 2 == face_b % 2);
    axes
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{brick, two_bricks};

    #[test]
    fn two_bricks_meet_in_one_face() {
        for turned in [false, true] {
            let two = two_bricks(turned);
            let (interfaces, free) = two.interfaces();
            assert_eq!(interfaces.len(), 1, "{turned}");
            let one = &interfaces[0];
            assert_eq!(one.sides[0], (0, 1));
            assert_eq!((one.from[0], one.to[0]), ([2, 0, 0], [2, 1, 3]));
            for (p, q) in [(one.from[0], one.from[1]), (one.to[0], one.to[1])] {
                assert_eq!(two.blocks()[0].at(p), two.blocks()[1].at(q));
            }
            assert_eq!(free.len(), 10);
            // Stepping off the face along u of the first is stepping into the second.
            let (axis, against) = one.axes[0];
            let (b, face) = one.sides[1];
            assert_eq!(face, 2 * axis + usize::from(against));
            // Along v and w the vertices are those of the other block.
            let (first, second) = (&two.blocks()[0], &two.blocks()[b]);
            let ends = |axis: usize, against: bool, at: usize| {
                if against { second.size[axis] - 1 - at } else { at }
            };
            for (j, k) in [(0, 0), (1, 0), (0, 2), (1, 3)] {
                let mut place = [0; 3];
                place[axis] = ends(axis, against, 0);
                for (own, at) in [(1, j), (2, k)] {
                    let (axis, against) = one.axes[own];
                    place[axis] = ends(axis, against, at);
                }
                assert_eq!(first.at([2, j, k]), second.at(place));
            }
        }
    }

    #[test]
    fn a_ring_meets_itself() {
        let mut ring = brick("ring", [5, 2, 2], 0);
        for j in 0..4 {
            ring.vertices[16 + j] = ring.vertices[j];
        }
        let (interfaces, free) = super::interfaces_of(&[ring], 6);
        assert_eq!((interfaces.len(), free.len()), (1, 4));
        assert_eq!(interfaces[0].sides, [(0, 0), (0, 1)]);
        assert_eq!(interfaces[0].axes, [(0, false), (1, false), (2, false)]);
    }

    /// A brick of 4 x 1 x 1 cells with two short ones on it, one of them turned end for end.
    #[test]
    fn a_face_meets_two() {
        let long = brick("long", [5, 2, 2], 0);
        let mut left = brick("left", [3, 2, 2], 100);
        let mut right = brick("right", [3, 2, 2], 200);
        for (i, j) in (0..3).flat_map(|i| (0..2).map(move |j| (i, j))) {
            let top = |i| long.at([i, j, 1]);
            left.vertices[(i * 2 + j) * 2] = top(i);
            right.vertices[((2 - i) * 2 + j) * 2] = top(i + 2);
        }
        let (found, free) = super::interfaces_of(&[long, left, right], 6);
        let ends: Vec<_> = found.iter().map(|i| (i.sides, i.from, i.to)).collect();
        assert_eq!(
            ends,
            [
                ([(0, 5), (1, 4)], [[0, 0, 1], [0, 0, 0]], [[2, 1, 1], [2, 1, 0]]),
                ([(0, 5), (2, 4)], [[2, 0, 1], [2, 0, 0]], [[4, 1, 1], [0, 1, 0]]),
            ]
        );
        assert_eq!(found[1].axes[0], (0, true));
        assert_eq!(free.len(), 15);
    }

    #[test]
    fn where_three_meet_there_is_no_interface() {
        let one = brick("one", [2, 2, 2], 0);
        let mut bricks = vec![one.clone(), one.clone(), one];
        for (k, brick) in bricks.iter_mut().enumerate() {
            brick.vertices[4..].iter_mut().for_each(|v| *v += 100 * k as u32);
        }
        let (found, free) = super::interfaces_of(&bricks, 6);
        assert_eq!((found.len(), free.len()), (0, 18));
    }
}
