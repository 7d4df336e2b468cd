//! Triangles that cut each other.

use moldloft_mesh::Mesh;
use moldloft_num::{Box3, Vec3};
use moldloft_parallel::prelude::*;
use smallvec::SmallVec;

/// Intersecting pairs of faces of a triangle mesh, in order, by the signs of volumes; pairs that
/// touch within rounding do not count. With `flagged`, only pairs that contain a flagged face.
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
    let size = (SIDES_IN_BIN * sum / number).min(longest).max(longest / 32.0);
    let bins = |b: Box3| bins(&b, size).map(hash);
    // Bins with a chosen triangle, by some bits of their hashes: rejects most others without a
    // look-up.
    let mut filled = vec![false; (8 * number as usize).next_power_of_two().clamp(1 << 12, 1 << 26)];
    let mask = filled.len() as u64 - 1;
    let mut all = Box3::EMPTY;
    for f in (0..count).filter(|&f| chosen(f)) {
        let own = Box3::around(corners(f));
        all = all.union(own);
        bins(own).for_each(|h| filled[(h & mask) as usize] = true);
    }
    let in_bins = |f: usize| {
        let own = Box3::around(corners(f));
        let inside = Box3 {
            low: common_low(&own, &all),
            high: Vec3::from([0, 1, 2].map(|k| own.high[k].min(all.high[k]))),
        };
        let found = meet(&own, &all).then(|| bins(inside));
        found
            .into_iter()
            .flatten()
            .filter(|h| filled[(h & mask) as usize])
            .map(move |h| (h, f as u32))
    };
    let entries: Vec<(u64, u32)> = (0..count).into_par_iter().flat_map_iter(in_bins).collect();
    let table = Buckets::of(&entries);
    let in_bucket = |k: usize| {
        let of = |&(h, f): &(u64, u32)| (h, f as usize, Box3::around(corners(f as usize)));
        let here: SmallVec<[(u64, usize, Box3); 16]> = table.bucket(k).iter().map(of).collect();
        let mut pairs: SmallVec<[[usize; 2]; 4]> = SmallVec::new();
        for (n, (h, f, own)) in here.iter().enumerate() {
            for (i, g, other) in &here[n + 1..] {
                // A pair in several bins is tested in the first.
                if h == i
                    && meet(own, other)
                    && (chosen(*f) || chosen(*g))
                    && hash(bin_of(common_low(own, other), size)) == *h
                    && f != g
                {
                    let pair = [*f.min(g), *f.max(g)];
                    if cut(pair.map(&names), pair.map(corners)) {
                        pairs.push(pair);
                    }
                }
            }
        }
        pairs
    };
    let mut pairs: Vec<[usize; 2]> =
        (0..table.count()).into_par_iter().flat_map_iter(in_bucket).collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// The bin of a point, of bins that wide.
pub(super) fn bin_of(p: Vec3, size: f64) -> [i64; 3] {
    p.to_array().map(|x| (x / size).floor() as i64)
}

/// The bins that a box passes through.
pub(super) fn bins(b: &Box3, size: f64) -> impl Iterator<Item = [i64; 3]> + use<> {
    let (low, high) = (bin_of(b.low, size), bin_of(b.high, size));
    let [x, y, z] = [0, 1, 2].map(|k| low[k]..=high[k]);
    x.flat_map(move |i| {
        let z = z.clone();
        y.clone().flat_map(move |j| z.clone().map(move |k| [i, j, k]))
    })
}

/// True when two boxes meet.
pub(super) fn meet(a: &Box3, b: &Box3) -> bool {
    (0..3).all(|k| a.low[k] <= b.high[k] && a.high[k] >= b.low[k])
}

/// Low corner of the intersection of two boxes.
pub(super) fn common_low(a: &Box3, b: &Box3) -> Vec3 {
    Vec3::from([0, 1, 2].map(|k| a.low[k].max(b.low[k])))
}

/// Width of bins, relative to the sides of triangles.
const SIDES_IN_BIN: f64 = 1.5;

/// A number for a bin; two bins may have the same, which costs a look and does no harm.
fn hash(bin: [i64; 3]) -> u64 {
    let mix = |h: u64, x: i64| (h.rotate_left(23) ^ x as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let h = bin.into_iter().fold(0, mix);
    h ^ (h >> 32)
}

/// Numbered things by the low bits of their hashes, those of a bucket side by side.
struct Buckets {
    starts: Vec<u32>,
    all: Vec<(u64, u32)>,
}

impl Buckets {
    fn of(entries: &[(u64, u32)]) -> Self {
        let count = (entries.len() / 8).next_power_of_two();
        let bucket = |h: u64| (h as usize) & (count - 1);
        let mut starts = vec![0u32; count + 1];
        entries.iter().for_each(|e| starts[bucket(e.0) + 1] += 1);
        for k in 0..count {
            starts[k + 1] += starts[k];
        }
        let mut next = starts.clone();
        let mut all = vec![(0, 0); entries.len()];
        for &e in entries {
            let place = &mut next[bucket(e.0)];
            all[*place as usize] = e;
            *place += 1;
        }
        Self { starts, all }
    }

    fn count(&self) -> usize {
        self.starts.len() - 1
    }

    fn bucket(&self, k: usize) -> &[(u64, u32)] {
        &self.all[self.starts[k] as usize..self.starts[k + 1] as usize]
    }
}

/// Relative difference above which a comparison of squares is certain.
const SURE: f64 = 1e-9;

/// Six times the volume of a tetrahedron, or zero when rounding may decide its sign.
fn volume(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> f64 {
    TrianglePlane::of([a, b, c]).side(d)
}

#[derive(Clone, Copy)]
pub(super) struct TrianglePlane {
    at: Vec3,
    /// The product of two sides, …
    normal: Vec3,
    /// … and the square of their lengths' product.
    square: f64,
}

impl TrianglePlane {
    pub(super) fn of([a, b, c]: [Vec3; 3]) -> Self {
        let (p, q) = (b - a, c - a);
        Self { at: a, normal: p.cross(q), square: p.norm_sq() * q.norm_sq() }
    }

    /// Six times the volume between triangle and point, whose sign says on which side it is; zero when rounding may decide.
    fn side(&self, p: Vec3) -> f64 {
        let r = p - self.at;
        let (v, other) = (self.normal.dot(r), r.norm_sq());
        // Squares decide most without roots.
        let most = 1e-26 * (self.square * other);
        if most > 1e-280 && v * v > most * (1.0 + SURE) {
            return v;
        }
        let sure = 1e-13 * self.square.sqrt() * other.sqrt();
        if v.abs() > sure { v } else { 0.0 }
    }
}

/// True when a segment whose ends are on both sides of a triangle passes through its inside.
fn pierces([p, q]: [Vec3; 2], [a, b, c]: [Vec3; 3]) -> bool {
    let [x, y, z] = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    (x > 0.0 && y > 0.0 && z > 0.0) || (x < 0.0 && y < 0.0 && z < 0.0)
}

/// True when two triangles, of vertices with these numbers, cut each other.
pub(super) fn cut(names: [[u32; 3]; 2], points: [[Vec3; 3]; 2]) -> bool {
    cut_in_planes(names, points, points.map(TrianglePlane::of))
}

/// As [`cut`], of triangles whose planes are known.
pub(super) fn cut_in_planes(
    names: [[u32; 3]; 2],
    points: [[Vec3; 3]; 2],
    planes: [TrianglePlane; 2],
) -> bool {
    // An edge can pierce the other triangle only without a common vertex.
    let mut sides = [[0.0; 3]; 2];
    for (s, t) in [(0, 1), (1, 0)] {
        for k in 0..3 {
            if !names[t].contains(&names[s][k]) {
                sides[s][k] = planes[t].side(points[s][k]);
            }
        }
        // All on one side of the other's plane: they cannot meet.
        if sides[s].iter().all(|v| *v > 0.0) || sides[s].iter().all(|v| *v < 0.0) {
            return false;
        }
    }
    [(0, 1), (1, 0)].into_iter().any(|(s, t)| {
        (0..3).any(|k| {
            let l = (k + 1) % 3;
            sides[s][k] * sides[s][l] < 0.0 && pierces([points[s][k], points[s][l]], points[t])
        })
    })
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
