//! Faces and solids of wireframes: the faces of every case, T13 (boxes), T14, T20.

use crate::common::*;
use moldloft_num::{Real, Vec3};
use moldloft_sketch::faces::{Fitted, Polygon, fit};
use moldloft_testing::{Random, rounds};

fn turned(cycle: &[usize]) -> Vec<usize> {
    let mut cycle = cycle.to_vec();
    let lowest = (0..cycle.len()).min_by_key(|&k| cycle[k]).unwrap();
    cycle.rotate_left(lowest);
    cycle
}

/// V - E + F - R and closedness: every edge is traversed once in each direction.
fn euler(faces: &[Polygon]) -> i64 {
    let mut halves = std::collections::BTreeMap::new();
    let mut vertices = std::collections::BTreeSet::new();
    let mut rings = 0;
    for f in faces {
        rings += f.holes.len();
        for cycle in std::iter::once(&f.outer).chain(&f.holes) {
            for k in 0..cycle.len() {
                vertices.insert(cycle[k]);
                *halves.entry((cycle[k], cycle[(k + 1) % cycle.len()])).or_insert(0) += 1;
            }
        }
    }
    for ((a, b), n) in &halves {
        assert_eq!(halves.get(&(*b, *a)), Some(n), "edge {a}-{b}");
    }
    (vertices.len() + faces.len()) as i64 - (halves.len() / 2 + rings) as i64
}

fn only(fitted: &Fitted) -> &moldloft_sketch::faces::WireframeFit {
    assert!(fitted.open.is_empty(), "open {:?}", fitted.open);
    assert_eq!(fitted.fits.len(), 1, "solids of {} cells", fitted.cells);
    &fitted.fits[0]
}

#[test]
fn faces_of_every_case() {
    for case in cases() {
        let edges: Vec<[usize; 2]> = case
            .object
            .drawing
            .lines
            .values()
            .map(|l| [l.p.0 as usize - 1, l.q.0 as usize - 1])
            .collect();
        let fitted = fit(&case.xyz, &edges);
        let found = only(&fitted);
        let plain = |c: &[moldloft_sketch::PointId]| {
            turned(&c.iter().map(|p| p.0 as usize - 1).collect::<Vec<_>>())
        };
        let mut expected: Vec<Polygon> = (case.faces.iter())
            .map(|f| Polygon {
                outer: plain(&f.outer),
                holes: f.holes.iter().map(|h| plain(h)).collect(),
            })
            .collect();
        expected.sort();
        assert_eq!(found.faces, expected, "{}", case.id);
        assert!((found.volume - case.volume).abs() < 1e-9 * case.volume, "{}", case.id);
        assert!(found.branching.is_empty() && found.scribed.is_empty());
        let hole = if case.id.starts_with("T9") { 0 } else { 2 };
        assert_eq!(euler(&found.faces), hole, "{}", case.id);
        if case.id.starts_with("T5") {
            assert_eq!(found.internal, [vec![4, 5, 6, 7]]);
        }
    }
}

/// Corners of a box in the order of [`cuboid`], and its edges from vertex `at`.
fn block(low: [f64; 3], high: [f64; 3], vertices: &mut Vec<Vec3>, edges: &mut Vec<[usize; 2]>) {
    let at = vertices.len();
    for z in [low[2], high[2]] {
        for (x, y) in [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])] {
            vertices.push(Vec3::new(x, y, z));
        }
    }
    for k in 0..4 {
        let l = (k + 1) % 4;
        edges.extend([[at + k, at + l], [at + 4 + k, at + 4 + l], [at + k, at + 4 + k]]);
    }
}

fn boxes(list: &[([f64; 3], [f64; 3])]) -> Fitted {
    let (mut vertices, mut edges) = (Vec::new(), Vec::new());
    list.iter().for_each(|(l, h)| block(*l, *h, &mut vertices, &mut edges));
    fit(&vertices, &edges)
}

#[test]
fn two_boxes_side_by_side() {
    let fitted = boxes(&[([0.0; 3], [4.0, 3.0, 2.0]), ([4.0, 0.0, 0.0], [7.0, 3.0, 2.0])]);
    assert_eq!(fitted.candidates, 11);
    let found = only(&fitted);
    assert_eq!((found.faces.len(), found.internal.len(), found.scribed.len()), (10, 1, 4));
    assert!((found.volume - 42.0).abs() < 1e-12);
}

#[test]
fn two_boxes_with_a_common_edge_are_reported_as_non_manifold() {
    let fitted = boxes(&[([0.0; 3], [2.0; 3]), ([2.0, 2.0, 0.0], [4.0, 4.0, 2.0])]);
    let found = only(&fitted);
    assert!((found.volume - 16.0).abs() < 1e-12);
    assert_eq!(found.branching.len(), 1);
}

#[test]
fn a_cavity_is_void() {
    let fitted = boxes(&[([0.0; 3], [6.0; 3]), ([2.0; 3], [4.0; 3])]);
    let found = only(&fitted);
    assert_eq!((found.faces.len(), fitted.cells), (12, 2));
    assert!((found.volume - 208.0).abs() < 1e-10);
    assert_eq!(euler(&found.faces), 4);
    // A solid in the cavity, and one beside: three shells nested or not.
    let fitted = boxes(&[
        ([0.0; 3], [6.0; 3]),
        ([1.0; 3], [5.0; 3]),
        ([2.0; 3], [4.0; 3]),
        ([8.0; 3], [9.0; 3]),
    ]);
    assert!((only(&fitted).volume - (216.0 - 64.0 + 8.0 + 1.0)).abs() < 1e-10);
}

#[test]
fn nested_cubes_with_diagonals_have_three_solids() {
    let (mut vertices, mut edges) = (Vec::new(), Vec::new());
    block([0.0; 3], [6.0; 3], &mut vertices, &mut edges);
    block([2.0; 3], [4.0; 3], &mut vertices, &mut edges);
    edges.extend((0..8).map(|k| [k, 8 + k]));
    let fitted = fit(&vertices, &edges);
    assert_eq!((fitted.candidates, fitted.cells, fitted.fits.len()), (24, 7, 3));
    assert!(fitted.complete);
    for found in &fitted.fits {
        assert_eq!((found.faces.len(), euler(&found.faces)), (16, 0));
        assert!((found.volume - 416.0 / 3.0).abs() < 1e-9);
        assert!(found.branching.is_empty());
    }
}

#[test]
fn what_does_not_close_is_named() {
    let (mut vertices, mut edges) = (Vec::new(), Vec::new());
    block([0.0; 3], [1.0; 3], &mut vertices, &mut edges);
    vertices.push(Vec3::of(3.0, 0.0, 0.0));
    edges.push([1, 8]);
    let fitted = fit(&vertices, &edges);
    assert_eq!(fitted.dangling, [[1, 8]]);
    assert_eq!(only(&fitted).faces.len(), 6);
    // A box without one vertical edge does not close along its neighbours' edges.
    edges.truncate(12);
    edges.retain(|e| *e != [0, 4]);
    let fitted = fit(&vertices[..8], &edges);
    assert!(fitted.fits.is_empty() && fitted.open.contains(&[0, 1]), "{:?}", fitted.open);
    assert_eq!(fit(&[], &[]), Fitted { complete: true, ..Fitted::default() });
    // Two diagonals of a face that cross without a vertex.
    edges.push([0, 4]);
    edges.extend([[4, 6], [5, 7]]);
    let fitted = fit(&vertices[..8], &edges);
    assert_eq!(fitted.crossings, [Vec3::of(0.5, 0.5, 1.0)]);
}

/// The edges of a union of the unit cubes in `solid`, with collinear ones joined.
fn voxel_edges(size: [i64; 3], solid: &dyn Fn([i64; 3]) -> bool) -> (Vec<Vec3>, Vec<[usize; 2]>) {
    let mut unit: std::collections::BTreeSet<([i64; 3], usize)> = Default::default();
    for axis in 0..3 {
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        for x in 0..=size[0] {
            for y in 0..=size[1] {
                for z in 0..=size[2] {
                    let at = |da: i64, db: i64| {
                        let mut c = [x, y, z];
                        c[a] += da;
                        c[b] += db;
                        (0..3).all(|k| c[k] >= 0 && c[k] < size[k]) && solid(c)
                    };
                    let q = [at(-1, -1), at(0, -1), at(0, 0), at(-1, 0)];
                    let n = q.iter().filter(|s| **s).count();
                    let opposite = n == 2 && q[0] == q[2];
                    if n == 1 || n == 3 || opposite {
                        unit.insert(([x, y, z], axis));
                    }
                }
            }
        }
    }
    let mut number: std::collections::BTreeMap<[i64; 3], usize> = Default::default();
    let (mut vertices, mut edges) = (Vec::new(), Vec::new());
    let step = |mut p: [i64; 3], axis: usize, d: i64| {
        p[axis] += d;
        p
    };
    // A vertex is at a change of direction.
    let corner = |p: [i64; 3]| {
        let along =
            |axis: usize| (unit.contains(&(p, axis)), unit.contains(&(step(p, axis, -1), axis)));
        let used: Vec<(bool, bool)> = (0..3).map(along).filter(|u| u.0 || u.1).collect();
        !(used.len() == 1 && used[0] == (true, true))
    };
    let mut id = |p: [i64; 3], vertices: &mut Vec<Vec3>| {
        *number.entry(p).or_insert_with(|| {
            vertices.push(Vec3::new(p[0] as f64, p[1] as f64, p[2] as f64));
            vertices.len() - 1
        })
    };
    for &(p, axis) in &unit {
        if !corner(p) {
            continue;
        }
        let mut q = step(p, axis, 1);
        while !corner(q) {
            q = step(q, axis, 1);
        }
        let (a, b) = (id(p, &mut vertices), id(q, &mut vertices));
        edges.push([a, b]);
    }
    (vertices, edges)
}

/// T20: slabs with bosses, pockets and holes, rebuilt uniquely.
#[test]
fn random_slabs_are_rebuilt() {
    let mut random = Random::new(20);
    for round in 0..rounds(200, 2000) {
        let mut height = [[2i64; 7]; 7];
        for _ in 0..1 + random.below(4) {
            let h = [0, 1, 3, 4][random.below(4)];
            let (x, y) = (1 + random.below(4), 1 + random.below(4));
            let (w, d) = (1 + random.below(2), 1 + random.below(2));
            for row in &mut height[x..(x + w).min(6)] {
                row[y..(y + d).min(6)].fill(h);
            }
        }
        let solid = |[x, y, z]: [i64; 3]| z < height[x as usize][y as usize];
        check_voxels(round, [7, 7, 4], &solid, true);
    }
}

/// Checks a voxel solid; pieces that touch only along an edge admit other readings.
fn check_voxels(round: usize, size: [i64; 3], solid: &dyn Fn([i64; 3]) -> bool, manifold: bool) {
    let (vertices, edges) = voxel_edges(size, solid);
    let mut volume = 0;
    for x in 0..size[0] {
        for y in 0..size[1] {
            for z in 0..size[2] {
                volume += i64::from(solid([x, y, z]));
            }
        }
    }
    let fitted = fit(&vertices, &edges);
    assert!(!fitted.fits.is_empty(), "round {round}: none of {} cells", fitted.cells);
    let best = &fitted.fits[0];
    if manifold && best.branching.is_empty() {
        assert_eq!(fitted.fits.len(), 1, "round {round}");
    }
    let close = |v: f64| (v - volume as f64).abs() < 1e-9;
    let unique = fitted.fits.len() == 1;
    assert!(
        if unique { close(best.volume) } else { fitted.fits.iter().any(|f| close(f.volume)) },
        "round {round}: {} for {volume}",
        best.volume
    );
    euler(&best.faces);
}

/// T20: random connected polycubes of 3 x 3 x 3.
#[test]
fn random_polycubes_are_rebuilt() {
    let mut random = Random::new(21);
    for round in 0..rounds(300, 3000) {
        let mut filled = [[[false; 3]; 3]; 3];
        let mut at = [random.below(3) as i64, random.below(3) as i64, random.below(3) as i64];
        for _ in 0..4 + random.below(12) {
            filled[at[0] as usize][at[1] as usize][at[2] as usize] = true;
            let axis = random.below(3);
            at[axis] = (at[axis] + [1, -1][random.below(2)]).clamp(0, 2);
        }
        let solid = |[x, y, z]: [i64; 3]| filled[x as usize][y as usize][z as usize];
        check_voxels(round, [3, 3, 3], &solid, true);
    }
}

/// Convex hulls of random points, cut by random planes: oblique solids.
#[test]
fn random_oblique_solids_are_rebuilt() {
    let mut random = Random::new(22);
    for round in 0..rounds(200, 2000) {
        // Half-spaces n . x <= d around the origin; vertices are triple points inside all others.
        let count = 6 + random.below(8);
        let mut planes: Vec<(Vec3, f64)> = Vec::new();
        for axis in 0..3 {
            for sign in [1.0, -1.0] {
                let mut n = Vec3::zero();
                match axis {
                    0 => n.x = sign,
                    1 => n.y = sign,
                    _ => n.z = sign,
                }
                planes.push((n, 1.0 + random.unit()));
            }
        }
        for _ in 0..count {
            let n = Vec3::new(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5);
            let Some(n) = n.normalized() else { continue };
            planes.push((n, 0.6 + random.unit()));
        }
        let (vertices, edges, volume) = polytope(&planes);
        let fitted = fit(&vertices, &edges);
        let found = only(&fitted);
        assert!((found.volume - volume).abs() < 1e-9 * volume, "round {round}");
        assert_eq!(euler(&found.faces), 2, "round {round}");
    }
}

/// Vertices, edges and volume of an intersection of half-spaces in general position.
fn polytope(planes: &[(Vec3, f64)]) -> (Vec<Vec3>, Vec<[usize; 2]>, f64) {
    let mut corners: Vec<([usize; 3], Vec3)> = Vec::new();
    for a in 0..planes.len() {
        for b in a + 1..planes.len() {
            for c in b + 1..planes.len() {
                let [(n, d), (m, e), (l, f)] = [planes[a], planes[b], planes[c]];
                let det = n.dot(m.cross(l));
                if det.abs() < 1e-9 {
                    continue;
                }
                let p = (m.cross(l) * d + l.cross(n) * e + n.cross(m) * f) / det;
                let inside = |(k, (n, d)): (usize, &(Vec3, f64))| {
                    [a, b, c].contains(&k) || n.dot(p) < *d - 1e-9
                };
                if planes.iter().enumerate().all(inside) {
                    corners.push(([a, b, c], p));
                }
            }
        }
    }
    let mut edges = Vec::new();
    for i in 0..corners.len() {
        for j in i + 1..corners.len() {
            let common = corners[i].0.iter().filter(|k| corners[j].0.contains(k)).count();
            if common == 2 {
                edges.push([i, j]);
            }
        }
    }
    let mut volume = 0.0;
    for (k, (n, d)) in planes.iter().enumerate() {
        let mut own: Vec<Vec3> = corners.iter().filter(|c| c.0.contains(&k)).map(|c| c.1).collect();
        if own.len() < 3 {
            continue;
        }
        let u = n.perpendicular();
        let v = n.cross(u);
        let centre = own.iter().fold(Vec3::zero(), |s, p| s + *p) / own.len() as f64;
        let angle = |p: &Vec3| Real::atan2((*p - centre).dot(v), (*p - centre).dot(u));
        own.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        let area: f64 = (0..own.len())
            .map(|i| (own[i] - centre).cross(own[(i + 1) % own.len()] - centre).dot(*n) / 2.0)
            .sum();
        volume += area * d / 3.0;
    }
    (corners.into_iter().map(|c| c.1).collect(), edges, volume)
}

/// A plate with a grid of blind pockets: many cells, no brute force.
#[test]
fn a_plate_with_many_pockets() {
    let solid = |[x, y, z]: [i64; 3]| z < 1 || x % 2 == 0 || y % 2 == 0;
    let (vertices, edges) = voxel_edges([13, 13, 2], &solid);
    assert!(edges.len() >= 420, "{}", edges.len());
    let fitted = fit(&vertices, &edges);
    let found = only(&fitted);
    assert!((found.volume - (2.0 * 169.0 - 36.0)).abs() < 1e-8);
    assert!(fitted.cells > 18, "{}", fitted.cells);
}
