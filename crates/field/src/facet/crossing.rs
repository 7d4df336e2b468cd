//! Triangles that cut each other.

use moldloft_mesh::Mesh;
use moldloft_num::{Box3, Vec3};
use moldloft_parallel::prelude::*;
use rustc_hash::FxHashMap;

/// Pairs of faces of a triangle mesh that cut each other, in order, by the signs of volumes; pairs
/// that touch to rounding only do not count. With `flagged`, only pairs of which one is flagged.
///
/// # Example
/// ```
/// use moldloft_field::{FacetOptions, Primitive, Resolution, Set, crossing_faces, facet};
/// use moldloft_num::{Box3, Vec3};
///
/// let ball = Set::new(&Primitive::sphere(Vec3::zero(), 1.0)?);
/// let over = Box3 { low: Vec3::of(-2.0, -2.0, -2.0), high: Vec3::of(2.0, 2.0, 2.0) };
/// let facets = facet(&ball, &over, &FacetOptions::new(Resolution::Depth(4)))?;
/// assert!(crossing_faces(&facets.mesh, None).is_empty());
/// # Ok::<(), moldloft_field::FieldError>(())
/// ```
pub fn crossing_faces(mesh: &Mesh, flagged: Option<&[bool]>) -> Vec<[usize; 2]> {
    let faces = mesh.faces();
    let corners = |f: usize| [faces[f][0], faces[f][1], faces[f][2]];
    crossings(mesh.positions(), faces.len(), corners, flagged)
}

/// As [`crossing_faces`] of `count` triangles with those corners.
pub(super) fn crossings(
    positions: &[Vec3],
    count: usize,
    names: impl Fn(usize) -> [u32; 3] + Sync,
    flagged: Option<&[bool]>,
) -> Vec<[usize; 2]> {
    let chosen = |f: usize| flagged.is_none_or(|flags| flags[f]);
    let corners = |f: usize| names(f).map(|v| positions[v as usize]);
    // Bins twice as large as most triangles are; the longest pass through 32 along a side.
    let (mut longest, mut sum, mut number) = (0.0f64, 0.0, 0.0);
    for f in (0..count).filter(|&f| chosen(f)) {
        let [a, b, c] = corners(f);
        let side = a.distance(b).max(b.distance(c)).max(c.distance(a));
        longest = longest.max(side);
        sum += side;
        number += 1.0;
    }
    if longest == 0.0 {
        return Vec::new();
    }
    let size = (2.0 * sum / number).min(longest).max(longest / 32.0);
    let bins = |b: Box3| {
        let end = |x: f64| (x / size).floor() as i64;
        let [x, y, z] = [0, 1, 2].map(|k| end(b.low[k])..=end(b.high[k]));
        x.flat_map(move |i| {
            let z = z.clone();
            y.clone().flat_map(move |j| z.clone().map(move |k| [i, j, k]))
        })
    };
    let mut map: FxHashMap<[i64; 3], Vec<usize>> = FxHashMap::default();
    // Which bins hold something, by a hash of few bits: most are known to be empty without a look.
    let mut filled = vec![false; 1 << 16];
    let place = |[i, j, k]: [i64; 3]| {
        let mix = (i.wrapping_mul(73_856_093))
            ^ (j.wrapping_mul(19_349_663))
            ^ (k.wrapping_mul(83_492_791));
        (mix & 0xFFFF) as usize
    };
    let mut all = Box3::EMPTY;
    for f in (0..count).filter(|&f| chosen(f)) {
        let own = Box3::around(corners(f));
        all = all.union(own);
        for bin in bins(own) {
            filled[place(bin)] = true;
            map.entry(bin).or_default().push(f);
        }
    }
    let with_one = |f: usize| {
        let own = Box3::around(corners(f));
        if (0..3).any(|k| own.low[k] > all.high[k] || own.high[k] < all.low[k]) {
            return Vec::new();
        }
        let inside = Box3 {
            low: Vec3::from([0, 1, 2].map(|k| own.low[k].max(all.low[k]))),
            high: Vec3::from([0, 1, 2].map(|k| own.high[k].min(all.high[k]))),
        };
        let mut near: Vec<usize> = bins(inside)
            .filter(|b| filled[place(*b)])
            .filter_map(|b| map.get(&b))
            .flatten()
            .copied()
            .filter(|&g| g != f && (g < f || !chosen(f)))
            .collect();
        near.sort_unstable();
        near.dedup();
        let meets = |g: &usize| {
            let other = Box3::around(corners(*g));
            (0..3).all(|k| own.low[k] <= other.high[k] && own.high[k] >= other.low[k])
        };
        let pairs = near.into_iter().filter(meets).map(|g| [f.min(g), f.max(g)]);
        pairs.filter(|pair| cut(pair.map(&names), pair.map(corners))).collect()
    };
    let mut pairs: Vec<[usize; 2]> = (0..count).into_par_iter().flat_map_iter(with_one).collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// How far from its limit a comparison of squares is sure.
const SURE: f64 = 1e-9;

/// Six times the volume of a tetrahedron, or zero when rounding may decide its sign.
fn volume(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> f64 {
    let (p, q, r) = (b - a, c - a, d - a);
    let v = p.dot(q.cross(r));
    // Squares decide most without roots.
    let (square, most) = (v * v, 1e-26 * (p.norm_sq() * q.norm_sq() * r.norm_sq()));
    if most > 1e-280 && square > most * (1.0 + SURE) {
        return v;
    }
    let sure = 1e-13 * p.norm() * q.norm() * r.norm();
    if v.abs() > sure { v } else { 0.0 }
}

/// True when a segment whose ends are on both sides of a triangle passes through its inside.
fn pierces([p, q]: [Vec3; 2], [a, b, c]: [Vec3; 3]) -> bool {
    let [x, y, z] = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    (x > 0.0 && y > 0.0 && z > 0.0) || (x < 0.0 && y < 0.0 && z < 0.0)
}

/// True when two triangles, of vertices with these numbers, cut each other.
pub(super) fn cut(names: [[u32; 3]; 2], points: [[Vec3; 3]; 2]) -> bool {
    // An edge can pierce the other triangle only if they share none of its ends.
    for (s, t) in [(0, 1), (1, 0)] {
        let apart = names[s].map(|v| !names[t].contains(&v));
        let [a, b, c] = points[t];
        let side = |k: usize| if apart[k] { volume(a, b, c, points[s][k]) } else { 0.0 };
        let sides = [side(0), side(1), side(2)];
        // All on one side of the other's plane: they cannot meet.
        if sides.iter().all(|v| *v > 0.0) || sides.iter().all(|v| *v < 0.0) {
            return false;
        }
        let through = (0..3).any(|k| {
            let l = (k + 1) % 3;
            sides[k] * sides[l] < 0.0 && pierces([points[s][k], points[s][l]], points[t])
        });
        if through {
            return true;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use moldloft_mesh::{PatchInfo, TopologyBuilder};

    fn two(offset: f64) -> Mesh {
        let mut b = TopologyBuilder::new();
        b.add_vertices(6).unwrap();
        b.add_faces(PatchInfo::new("two"), [[0, 1, 2, 2], [3, 4, 5, 5]]).unwrap();
        let v = Vec3::of;
        let positions = vec![
            v(0.0, 0.0, 0.0),
            v(1.0, 0.0, 0.0),
            v(0.0, 1.0, 0.0),
            v(0.2, 0.2, offset - 0.5),
            v(0.3, 0.2, offset + 0.5),
            v(0.2, 0.4, offset + 0.5),
        ];
        Mesh::new(b.build().into(), positions).unwrap()
    }

    #[test]
    fn finds_what_cuts_and_only_that() {
        assert_eq!(crossing_faces(&two(0.0), None), [[0, 1]]);
        assert_eq!(crossing_faces(&two(0.0), Some(&[false, true])), [[0, 1]]);
        assert!(crossing_faces(&two(0.0), Some(&[false, false])).is_empty());
        assert!(crossing_faces(&two(0.6), None).is_empty());
        // A corner that only touches.
        assert!(crossing_faces(&two(0.5), None).is_empty());
    }
}
