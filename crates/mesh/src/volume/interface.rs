use super::HexBlock;
use std::collections::HashMap;

/// Two faces of blocks that are one, vertex by vertex.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Interface {
    /// The two faces: (block, face 0..6), the earlier first.
    pub sides: [(usize, usize); 2],
    /// For each axis u, v, w of the first block, the axis of the second that it runs along, and
    /// whether against it. The axis through the face goes on into the second block.
    pub axes: [(usize, bool); 3],
}

/// All interfaces of `blocks`, ordered by their first sides. A face takes part in one at most;
/// faces that are a line or a point in none.
pub fn find(blocks: &[HexBlock]) -> Vec<Interface> {
    let mut open: HashMap<Vec<u32>, Vec<(usize, usize)>> = HashMap::new();
    let mut found = Vec::new();
    for (b, block) in blocks.iter().enumerate() {
        for face in 0..6 {
            if block.face_panels(face).is_empty() {
                continue;
            }
            let waiting = open.entry(corners(block, face)).or_default();
            let meets = waiting.iter().enumerate().find_map(|(at, &(a, first))| {
                Some((at, (a, first), turned(&blocks[a], first, block, face)?))
            });
            match meets {
                Some((at, first, on_face)) => {
                    waiting.remove(at);
                    found.push(Interface {
                        sides: [first, (b, face)],
                        axes: axes(first.1, face, on_face),
                    });
                }
                None => waiting.push((b, face)),
            }
        }
    }
    found.sort_by_key(|i| i.sides);
    found
}

/// The corners of a face in ascending order, as a name that both sides have in common.
fn corners(block: &HexBlock, face: usize) -> Vec<u32> {
    let [m, n] = block.face_size(face);
    let places = [[0, 0], [m - 1, 0], [0, n - 1], [m - 1, n - 1]];
    let mut corners: Vec<u32> = places.iter().map(|&p| block.at(block.on_face(face, p))).collect();
    corners.sort_unstable();
    corners
}

/// How the parameters of one face run on another: swapped, then each reversed or not.
#[derive(Clone, Copy)]
struct Turn {
    swap: bool,
    flip: [bool; 2],
}

/// The turn that makes all vertices of two faces agree.
fn turned(a: &HexBlock, face_a: usize, b: &HexBlock, face_b: usize) -> Option<Turn> {
    let ([m, n], size) = (a.face_size(face_a), b.face_size(face_b));
    (0..8).find_map(|bits| {
        let turn = Turn { swap: bits & 1 == 1, flip: [bits & 2 == 2, bits & 4 == 4] };
        let swapped = if turn.swap { [n, m] } else { [m, n] };
        if swapped != size {
            return None;
        }
        let there = |i: usize, j: usize| {
            let p = if turn.swap { [j, i] } else { [i, j] };
            [0, 1].map(|k| if turn.flip[k] { size[k] - 1 - p[k] } else { p[k] })
        };
        let same = |i: usize, j: usize| {
            a.at(a.on_face(face_a, [i, j])) == b.at(b.on_face(face_b, there(i, j)))
        };
        let all = (0..m).all(|i| (0..n).all(|j| same(i, j)));
        all.then_some(turn)
    })
}

fn axes(face_a: usize, face_b: usize, turn: Turn) -> [(usize, bool); 3] {
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
            let interfaces = two.interfaces();
            assert_eq!(interfaces.len(), 1, "{turned}");
            let one = &interfaces[0];
            assert_eq!(one.sides[0], (0, 1));
            assert_eq!(two.boundary().len(), 10);
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
        let interfaces = super::find(&[ring]);
        assert_eq!(interfaces.len(), 1);
        assert_eq!(interfaces[0].sides, [(0, 0), (0, 1)]);
        assert_eq!(interfaces[0].axes, [(0, false), (1, false), (2, false)]);
    }
}
