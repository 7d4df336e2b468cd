//! Triangles that cut each other.

use moldloft_mesh::Mesh;
use moldloft_num::{Box3, Vec3};
use std::collections::HashMap;

/// Pairs of faces of a triangle mesh that cut each other, in order, by the signs of volumes; pairs
/// that touch to rounding only do not count. With `flagged`, only pairs of which one is flagged.
///
/// # Example
/// ```
/// use moldloft_field::{Options, Primitive, Resolution, Set, crossing_faces, facet};
/// use moldloft_num::{Box3, Vec3};
///
/// let ball = Set::new(&Primitive::sphere(Vec3::zero(), 1.0)?);
/// let over = Box3 { low: Vec3::of(-2.0, -2.0, -2.0), high: Vec3::of(2.0, 2.0, 2.0) };
/// let facets = facet(&ball, &over, &Options::new(Resolution::Depth(4)))?;
/// assert!(crossing_faces(&facets.mesh, None).is_empty());
/// # Ok::<(), moldloft_field::FieldError>(())
/// ```
pub fn crossing_faces(mesh: &Mesh, flagged: Option<&[bool]>) -> Vec<[usize; 2]> {
    let faces = mesh.faces();
    let chosen = |f: usize| flagged.is_none_or(|flags| flags[f]);
    let corners = |f: usize| [0, 1, 2].map(|k| mesh.positions()[faces[f][k] as usize]);
    // Bins about as large as a triangle.
    let mut size = 0.0f64;
    for f in (0..faces.len()).filter(|&f| chosen(f)) {
        let [a, b, c] = corners(f);
        size = size.max(a.distance(b)).max(b.distance(c)).max(c.distance(a));
    }
    if size == 0.0 {
        return Vec::new();
    }
    let bins = |f: usize| {
        let points = corners(f);
        let end = |pick: fn(f64, f64) -> f64, k: usize| {
            (pick(pick(points[0][k], points[1][k]), points[2][k]) / size).floor() as i64
        };
        let [x, y, z] = [0, 1, 2].map(|k| end(f64::min, k)..=end(f64::max, k));
        x.flat_map(move |i| {
            let z = z.clone();
            y.clone().flat_map(move |j| z.clone().map(move |k| [i, j, k]))
        })
    };
    let mut map: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let mut all = Box3::EMPTY;
    for f in (0..faces.len()).filter(|&f| chosen(f)) {
        all = all.union(Box3::around(corners(f)));
        for bin in bins(f) {
            map.entry(bin).or_default().push(f);
        }
    }
    let mut pairs = Vec::new();
    for f in 0..faces.len() {
        let own = Box3::around(corners(f));
        if (0..3).any(|k| own.low[k] > all.high[k] || own.high[k] < all.low[k]) {
            continue;
        }
        let mut near: Vec<usize> = bins(f).filter_map(|b| map.get(&b)).flatten().copied().collect();
        near.sort_unstable();
        near.dedup();
        for g in near {
            if g == f || (g > f && chosen(f)) {
                continue;
            }
            let pair = [f.min(g), f.max(g)];
            if cut(mesh, pair) {
                pairs.push(pair);
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// Six times the volume of a tetrahedron, or zero when rounding may decide its sign.
fn volume(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> f64 {
    let (p, q, r) = (b - a, c - a, d - a);
    let v = p.dot(q.cross(r));
    let sure = 1e-13 * p.norm() * q.norm() * r.norm();
    if v.abs() > sure { v } else { 0.0 }
}

/// True when the segment passes through the inside of the triangle.
fn pierces([p, q]: [Vec3; 2], [a, b, c]: [Vec3; 3]) -> bool {
    if volume(a, b, c, p) * volume(a, b, c, q) >= 0.0 {
        return false;
    }
    let [x, y, z] = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    (x > 0.0 && y > 0.0 && z > 0.0) || (x < 0.0 && y < 0.0 && z < 0.0)
}

fn cut(mesh: &Mesh, pair: [usize; 2]) -> bool {
    let names = pair.map(|f| {
        let [a, b, c, _] = mesh.faces()[f];
        [a, b, c]
    });
    let points = names.map(|n| n.map(|v| mesh.positions()[v as usize]));
    // An edge can pierce the other triangle only if they share none of its ends.
    [(0, 1), (1, 0)].into_iter().any(|(s, t)| {
        (0..3).any(|k| {
            let l = (k + 1) % 3;
            let apart = |k: usize| !names[t].contains(&names[s][k]);
            apart(k) && apart(l) && pierces([points[s][k], points[s][l]], points[t])
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
