//! Blocks for tests.

use super::{BlockFace, Blocks, HexBlock};
use moldloft_num::Vec3;

/// A block whose vertices are numbered in order from `first`.
pub fn brick(name: &str, size: [usize; 3], first: u32) -> HexBlock {
    let count: usize = size.iter().product();
    HexBlock {
        name: name.into(),
        size,
        vertices: (first..first + count as u32).collect(),
        faces: std::array::from_fn(|f| BlockFace { name: format!("{name}.{f}") }),
    }
}

/// The positions of a brick of unit cells at `x`.
pub fn positions([nu, nv, nw]: [usize; 3], x: f64) -> Vec<Vec3> {
    let at = |c: usize| {
        let (i, j, k) = (c / (nv * nw), c / nw % nv, c % nw);
        Vec3::of(x + i as f64, j as f64, k as f64)
    };
    (0..nu * nv * nw).map(at).collect()
}

/// Two bricks of 2 x 1 x 3 cells, one behind the other along u. The second has the same
/// orientation, or is turned: its u is along the first's -w, its v along u and its w along -v.
pub fn two_bricks(turned: bool) -> Blocks {
    let size = [3, 2, 4];
    let first = brick("fore", size, 0);
    let mut second = brick("aft", size, 24);
    let mut all = positions(size, 0.0);
    all.extend(positions(size, 2.0));
    for j in 0..8 {
        second.vertices[j] = first.vertices[16 + j];
    }
    if turned {
        let old = second.clone();
        second.size = [4, 3, 2];
        let place = |c: usize| {
            let [i, j, k] = [c / 6, c / 2 % 3, c % 2];
            old.at([j, 1 - k, 3 - i])
        };
        second.vertices = (0..24).map(place).collect();
    }
    Blocks::new(all, vec![first, second]).unwrap()
}
