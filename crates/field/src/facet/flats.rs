//! Plane faces in few triangles: without vertices inside them, and on straight edges between two.
//!
//! The triangles of a plane fill the outline that they had, so that the surface stays the same.

use super::assemble::Assembled;
use crate::expr::form::Form;
use crate::set::Leaf;
use moldloft_mesh::planar_triangles;
use moldloft_num::Vec3;
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeMap;

/// Relative difference of areas within which an outline is filled.
const SAME_AREA: f64 = 1e-9;
/// Distance of a vertex from the line between its neighbours, relative to that line, on a straight
/// edge.
const STRAIGHT: f64 = 1e-9;

type Corners = [u32; 3];

/// The triangles of a plane.
struct FlatFace {
    leaf: u32,
    triangles: Vec<Corners>,
    /// Closed walks along the edges that have a triangle of the face on one side only.
    loops: Vec<Vec<u32>>,
}

/// Replaces the triangles of all plane faces by the fewest that fill their outlines.
pub(super) fn merge(made: &mut Assembled, leaves: &[Leaf]) {
    let plane = |leaf: u32| matches!(leaves[leaf as usize].primitive.form(), Form::Plane(_));
    let mut own: BTreeMap<u32, Vec<Corners>> = BTreeMap::new();
    let mut round = Vec::new();
    for &(leaf, corners) in &made.triangles {
        if plane(leaf) {
            own.entry(leaf).or_default().push(corners);
        } else {
            round.push((leaf, corners));
        }
    }
    let face = |(leaf, triangles): (u32, Vec<Corners>)| {
        let loops = loops(&triangles);
        FlatFace { leaf, triangles, loops }
    };
    let faces: Vec<FlatFace> = own.into_iter().map(face).collect();
    let straight = straight(&faces, &round, &made.positions);
    let fewest: Option<Vec<Vec<Corners>>> =
        faces.iter().map(|f| f.filled(&made.positions, &straight)).collect();
    let none = FxHashSet::default();
    let each = || {
        let filled = |f: &FlatFace| f.filled(&made.positions, &none);
        faces.iter().map(|f| filled(f).unwrap_or_else(|| f.triangles.clone())).collect()
    };
    let new: Vec<Vec<Corners>> = fewest.unwrap_or_else(each);
    made.triangles = round;
    for (face, new) in faces.iter().zip(new) {
        made.triangles.extend(new.into_iter().map(|t| (face.leaf, t)));
    }
    made.compact();
}

fn sides(t: &Corners) -> [(u32, u32); 3] {
    [0, 1, 2].map(|k| (t[k], t[(k + 1) % 3]))
}

fn loops(triangles: &[Corners]) -> Vec<Vec<u32>> {
    let directed: FxHashSet<(u32, u32)> = triangles.iter().flat_map(sides).collect();
    let mut next: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
    let mut starts = Vec::new();
    for (a, b) in triangles.iter().flat_map(sides).filter(|(a, b)| !directed.contains(&(*b, *a))) {
        next.entry(a).or_default().push(b);
        starts.push(a);
    }
    let mut out = Vec::new();
    for start in starts {
        let (mut line, mut at) = (Vec::new(), start);
        while let Some(to) = next.get_mut(&at).and_then(Vec::pop) {
            line.push(at);
            at = to;
        }
        if !line.is_empty() {
            out.push(line);
        }
    }
    out
}

/// Vertices on straight edges between two plane faces, in the middle of them.
fn straight(faces: &[FlatFace], round: &[(u32, Corners)], positions: &[Vec3]) -> FxHashSet<u32> {
    let mut beside: FxHashMap<u32, Vec<[u32; 2]>> = FxHashMap::default();
    for line in faces.iter().flat_map(|f| &f.loops) {
        for (k, v) in line.iter().enumerate() {
            let ends = [line[(k + line.len() - 1) % line.len()], line[(k + 1) % line.len()]];
            beside.entry(*v).or_default().push(ends);
        }
    }
    for v in round.iter().flat_map(|t| t.1) {
        beside.remove(&v);
    }
    let between = |(v, pairs): (&u32, &Vec<[u32; 2]>)| {
        let [[a, b], [c, d]] = pairs[..] else { return None };
        let [p, q, r] = [a, *v, b].map(|k| positions[k as usize]);
        let along = r - p;
        let off = (q - p).cross(along).norm();
        let flat = off <= STRAIGHT * along.norm_sq() && (q - p).dot(r - q) > 0.0;
        ((a, b) == (d, c) && flat).then_some(*v)
    };
    beside.iter().filter_map(between).collect()
}

impl FlatFace {
    /// Triangles that fill the outline without the vertices `left_out`; `None` if they do not.
    fn filled(&self, positions: &[Vec3], left_out: &FxHashSet<u32>) -> Option<Vec<Corners>> {
        let at = |v: u32| positions[v as usize];
        let area = |t: &Corners| (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
        let sum = |all: &[Corners]| all.iter().fold(Vec3::zero(), |s, t| s + area(t));
        let old = sum(&self.triangles);
        let normal = old.normalized()?;
        let u = normal.perpendicular().normalized()?;
        let v = normal.cross(u);
        let mut number: FxHashMap<u32, usize> = FxHashMap::default();
        let mut corners = Vec::new();
        let mut outline = Vec::with_capacity(self.loops.len());
        for line in &self.loops {
            let line: Vec<u32> = line.iter().copied().filter(|v| !left_out.contains(v)).collect();
            if line.len() < 3 {
                return None;
            }
            outline.push(line);
        }
        let local: Vec<Vec<usize>> = outline
            .iter()
            .map(|line| {
                let each = line.iter().map(|&k| {
                    *number.entry(k).or_insert_with(|| {
                        corners.push(k);
                        corners.len() - 1
                    })
                });
                each.collect()
            })
            .collect();
        let places: Vec<[f64; 2]> = corners.iter().map(|&k| [at(k).dot(u), at(k).dot(v)]).collect();
        let new: Vec<Corners> = planar_triangles(&places, &local, &[])
            .into_iter()
            .map(|t| t.map(|k| corners[k]))
            .collect();
        let directed: FxHashSet<(u32, u32)> = new.iter().flat_map(sides).collect();
        let open = directed.iter().filter(|(a, b)| !directed.contains(&(*b, *a))).count();
        let mut wanted = 0;
        let outlined = outline.iter().all(|line| {
            wanted += line.len();
            (0..line.len()).all(|k| directed.contains(&(line[k], line[(k + 1) % line.len()])))
        });
        let whole = directed.len() == 3 * new.len() && outlined && open == wanted;
        let same = (sum(&new) - old).norm() <= SAME_AREA * old.norm();
        (whole && same).then_some(new)
    }
}
