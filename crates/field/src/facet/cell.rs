//! Tables of the crossings of a cell's edges that belong together.
//!
//! Corner k of a cell is at (k & 1, k >> 1 & 1, k >> 2). Edge 4 a + i + 2 j is along axis a, from
//! the corner with the coordinates i and j along the next two axes.

use std::sync::OnceLock;

/// No loop: the edge is not crossed.
pub(super) const NONE: u8 = u8::MAX;

/// Case of the signs at a cell's corners.
#[derive(Clone, Copy)]
pub(super) struct Case {
    /// Number of pieces of surface in the cell: closed loops of crossings on its boundary.
    pub(super) loops: u8,
    /// The loop of each crossed edge, or [`NONE`].
    pub(super) loop_of: [u8; 12],
    /// For each face 2 a + side: true when solid and air corners alternate round it.
    pub(super) ambiguous: [bool; 6],
    /// The crossed edge that follows each crossed edge round its loop, or [`NONE`] …
    pub(super) next: [u8; 12],
    /// … and the face 2 a + side that contains both.
    pub(super) side: [u8; 12],
}

pub(super) fn start_corner(edge: usize) -> usize {
    let a = edge / 4;
    ((edge & 1) << ((a + 1) % 3)) | ((edge >> 1 & 1) << ((a + 2) % 3))
}

/// The edges of face `axis`, `side`, in order round it: edge k joins corners k and k + 1.
pub(super) fn face_edges(axis: usize, side: usize) -> [usize; 4] {
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    let edge = |along: usize, across: usize, at: usize| {
        // The two axes across the edge, in cyclic order, are the face's and the other one.
        let (i, j) = if (along + 1) % 3 == axis { (side, at) } else { (at, side) };
        debug_assert!(across != along);
        4 * along + i + 2 * j
    };
    [edge(b, c, 0), edge(c, b, 1), edge(b, c, 1), edge(c, b, 0)]
}

/// Bit k is set if `edge` is on face k = 2 axis + side.
pub(super) fn faces_of(edge: usize) -> u8 {
    let a = edge / 4;
    let (b, c) = ((a + 1) % 3, (a + 2) % 3);
    1 << (2 * b + (edge & 1)) | 1 << (2 * c + (edge >> 1 & 1))
}

fn make(signs: usize, joins: usize) -> Case {
    let inside = |corner: usize| signs >> corner & 1 == 1;
    let crossed = |e: usize| inside(start_corner(e)) != inside(start_corner(e) | 1 << (e / 4));
    // Each crossed edge has a partner on each of its two faces.
    let mut joined: [Vec<(usize, usize)>; 12] = Default::default();
    let mut ambiguous = [false; 6];
    for axis in 0..3 {
        for side in 0..2 {
            let edges = face_edges(axis, side);
            let cut: Vec<usize> = (0..4).filter(|&k| crossed(edges[k])).collect();
            let mut join = |k: usize, l: usize| {
                joined[edges[k]].push((edges[l], 2 * axis + side));
                joined[edges[l]].push((edges[k], 2 * axis + side));
            };
            match cut[..] {
                [k, l] => join(k, l),
                [_, _, _, _] => {
                    ambiguous[2 * axis + side] = true;
                    // Corner k of the face is between edges k - 1 and k; corner 0 is the one at (0,
                    // 0). The solid corners are separate, unless the middle of the face is solid.
                    let corner = side << axis;
                    let joined = joins >> (2 * axis + side) & 1 == 1;
                    if inside(corner) != joined {
                        join(3, 0);
                        join(1, 2);
                    } else {
                        join(0, 1);
                        join(2, 3);
                    }
                }
                _ => {}
            }
        }
    }
    let mut out =
        Case { loops: 0, loop_of: [NONE; 12], ambiguous, next: [NONE; 12], side: [NONE; 12] };
    for start in 0..12 {
        if !crossed(start) || out.loop_of[start] != NONE {
            continue;
        }
        let (mut at, mut from) = (start, usize::MAX);
        while out.loop_of[at] == NONE {
            out.loop_of[at] = out.loops;
            let Some(&(to, face)) = joined[at].iter().find(|j| j.1 != from) else {
                unreachable!("a crossed edge has a partner on each of its faces")
            };
            (out.next[at], out.side[at]) = (to as u8, face as u8);
            (at, from) = (to, face);
        }
        out.loops += 1;
    }
    out
}

/// The case of a cell with these solid corners, by bits, in which the solid corners of the ambiguous
/// faces of `joins`, by bits, are joined: both cells of a face must say the same.
pub(super) fn case(signs: u8, joins: u8) -> &'static Case {
    static CASES: [OnceLock<Case>; 256 * 64] = [const { OnceLock::new() }; 256 * 64];
    let (signs, joins) = (signs as usize, joins as usize & 63);
    CASES[signs * 64 + joins].get_or_init(|| make(signs, joins))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_and_faces_fit() {
        for axis in 0..3 {
            for side in 0..2 {
                let edges = face_edges(axis, side);
                for e in 0..12 {
                    let in_face = faces_of(e) >> (2 * axis + side) & 1 == 1;
                    assert_eq!(in_face, edges.contains(&e));
                }
                for k in 0..4 {
                    let ends = |e: usize| [start_corner(e), start_corner(e) | 1 << (e / 4)];
                    let (e, f) = (ends(edges[k]), ends(edges[(k + 1) % 4]));
                    let shared = e.iter().filter(|c| f.contains(c)).count();
                    assert_eq!(shared, 1, "edges {k} and {} of a face share a corner", (k + 1) % 4);
                    for corner in e {
                        assert_eq!(corner >> axis & 1, side);
                    }
                }
            }
        }
    }

    #[test]
    fn every_crossed_edge_is_in_one_loop_of_at_least_three() {
        for k in 0..256 * 64 {
            let signs = k / 64;
            let case = case(signs as u8, (k % 64) as u8);
            for number in 0..case.loops {
                let edges = case.loop_of.iter().filter(|&&l| l == number).count();
                assert!((3..=12).contains(&edges), "{signs}");
            }
            let crossed = (0..12).filter(|&e| {
                let a = start_corner(e);
                (signs >> a ^ signs >> (a | 1 << (e / 4))) & 1 == 1
            });
            for e in crossed {
                assert!(case.loop_of[e] != NONE);
                // Round the loop and back, each time over a face of both edges.
                let (mut at, mut steps) = (e, 0);
                loop {
                    let (next, side) = (case.next[at] as usize, case.side[at]);
                    assert!(faces_of(at) & faces_of(next) & 1 << side != 0);
                    (at, steps) = (next, steps + 1);
                    if at == e {
                        break;
                    }
                }
                assert_eq!(steps, case.loop_of.iter().filter(|l| **l == case.loop_of[e]).count());
            }
        }
        // Two solid corners at the ends of a diagonal stay apart.
        assert_eq!(case(0b1000_0001, 0).loops, 2);
        assert_eq!(case(0b0000_1001, 0).loops, 2);
        // Joined across the face between them they are one.
        assert_eq!(case(0b0000_1001, 0b01_0000).loops, 1);
        assert_eq!(case(0b1111_0110, 0).loops, 1);
    }
}
