//! Triangles without area: three vertices on a straight edge, or two coincident ones.
//!
//! The polygon around an edge of the grid may have three of its vertices on one edge of the body.
//! The triangle between these has no area, and its longest side is flipped with the triangle
//! beyond; coincident vertices are merged. Neither changes the surface by more than rounding.

use super::assemble::Assembled;
use moldloft_mesh::Mesh;
use moldloft_num::Vec3;
use rustc_hash::{FxHashMap, FxHashSet};

/// A triangle is a sliver when its height is this part of its longest side: to rounding it is a line. Others have 1e-4
/// and more.
const FLAT: f64 = 1e-9;
/// Distance of two vertices, relative to the triangle's longest side, within which they coincide.
const ONE: f64 = 1e-8;
/// Maximum number of rounds; an edge flip rarely makes other triangles flat.
const ROUNDS: usize = 6;

type Corners = [u32; 3];

/// The height of a triangle as a part of its longest side.
fn height(p: [Vec3; 3]) -> f64 {
    let longest = (0..3).map(|k| (p[(k + 1) % 3] - p[k]).norm_sq()).fold(0.0, f64::max);
    if longest == 0.0 { 0.0 } else { (p[1] - p[0]).cross(p[2] - p[0]).norm() / longest }
}

struct Surroundings<'a> {
    made: &'a mut Assembled,
    /// The triangle on the left of each directed edge near slivers.
    left: FxHashMap<(u32, u32), usize>,
    /// The triangles of each corner of a sliver.
    round: FxHashMap<u32, Vec<usize>>,
    /// Changed in this round: its neighbourhood is outdated.
    stale: FxHashSet<u32>,
    gone: FxHashSet<usize>,
}

impl Surroundings<'_> {
    fn points(&self, t: Corners) -> [Vec3; 3] {
        t.map(|v| self.made.positions[v as usize])
    }

    fn joined(&self, a: u32, b: u32) -> bool {
        self.left.contains_key(&(a, b)) || self.left.contains_key(&(b, a))
    }

    /// Turns the longest side of a sliver, from `a` to `c`, towards the tip of the triangle beyond.
    fn turn(&mut self, sliver: usize, [a, b, c]: Corners) -> bool {
        let Some(&beyond) = self.left.get(&(a, c)) else { return false };
        let (leaf, other) = self.made.triangles[beyond];
        let Some(d) = other.into_iter().find(|&v| v != a && v != c) else { return false };
        if self.stale.contains(&d) || self.joined(b, d) {
            return false;
        }
        // The sliver's corner is on the side between them, so that it is on the surface beyond, too.
        let on = &self.made.surfaces[b as usize];
        if self.made.triangles[sliver].0 != leaf && !on.contains(&leaf) {
            return false;
        }
        let new = [[a, b, d], [b, c, d]];
        let old = self.points([a, c, d]);
        let normal = (old[1] - old[0]).cross(old[2] - old[0]);
        let faces = |t: Corners| {
            let p = self.points(t);
            (p[1] - p[0]).cross(p[2] - p[0]).dot(normal) > 0.0 && height(p) > FLAT
        };
        if !new.into_iter().all(faces) {
            return false;
        }
        self.made.triangles[sliver] = (leaf, new[0]);
        self.made.triangles[beyond] = (leaf, new[1]);
        self.stale.extend([a, b, c, d]);
        true
    }

    /// Merges a corner of a sliver into another of its corners and removes the triangles between,
    /// if all other triangles keep their sides. `same`: both are one point; otherwise `from` is on
    /// a straight edge that continues.
    fn merge(&mut self, from: u32, to: u32, same: bool) -> bool {
        let (Some(own), Some(others)) = (self.round.get(&from), self.round.get(&to)) else {
            return false;
        };
        let ring = |all: &Vec<usize>| -> FxHashSet<u32> {
            all.iter().flat_map(|&t| self.made.triangles[t].1).collect()
        };
        let (a, b) = (ring(own), ring(others));
        let common = a.intersection(&b).filter(|v| ![from, to].contains(v)).count();
        let between: Vec<usize> = own.iter().copied().filter(|t| others.contains(t)).collect();
        if common != 2 || between.len() != 2 || a.iter().chain(&b).any(|v| self.stale.contains(v)) {
            return false;
        }
        let lost = &self.made.surfaces[from as usize];
        if !same && !lost.iter().all(|s| self.made.surfaces[to as usize].contains(s)) {
            return false;
        }
        let moved: Vec<usize> = own.iter().copied().filter(|t| !between.contains(t)).collect();
        for &t in &moved {
            let old = self.made.triangles[t].1;
            let (p, q) =
                (self.points(old), self.points(old.map(|v| if v == from { to } else { v })));
            let [m, n] = [p, q].map(|p| (p[1] - p[0]).cross(p[2] - p[0]));
            let flat = height(p) <= FLAT;
            if height(q) <= FLAT || !flat && m.dot(n) < 0.9 * m.norm() * n.norm() {
                return false;
            }
        }
        for &t in &moved {
            let corners = &mut self.made.triangles[t].1;
            *corners = corners.map(|v| if v == from { to } else { v });
        }
        if same {
            let lost = self.made.surfaces[from as usize].clone();
            let kept = &mut self.made.surfaces[to as usize];
            kept.extend(lost);
            kept.sort_unstable();
            kept.dedup();
        }
        self.gone.extend(between);
        self.stale.extend(a.into_iter().chain(b));
        true
    }
}

impl Surroundings<'_> {
    /// A vertex of three triangles, two of which coincide between it and two vertices at one point,
    /// is merged into one of these, so that they can be merged too.
    fn flap(&mut self, from: u32, to: u32) -> bool {
        let Some(own) = self.round.get(&from).filter(|all| all.len() == 3) else { return false };
        let gone: Vec<usize> =
            own.iter().copied().filter(|&t| self.made.triangles[t].1.contains(&to)).collect();
        let Some(&left) = own.iter().find(|t| !gone.contains(t)) else { return false };
        let stale = |v: &u32| self.stale.contains(v);
        let on = &self.made.surfaces[to as usize];
        if gone.len() != 2
            || own.iter().any(|&t| self.made.triangles[t].1.iter().any(stale))
            || !self.made.surfaces[from as usize].iter().all(|s| on.contains(s))
        {
            return false;
        }
        for &t in own {
            self.stale.extend(self.made.triangles[t].1);
        }
        let corners = &mut self.made.triangles[left].1;
        *corners = corners.map(|v| if v == from { to } else { v });
        self.gone.extend(gone);
        true
    }
}

/// Number of triangles of a mesh without area.
pub(super) fn count(mesh: &Mesh) -> usize {
    let at =
        |f: &&[u32; 4]| height([f[0], f[1], f[2]].map(|v| mesh.positions()[v as usize])) <= FLAT;
    mesh.faces().iter().filter(at).count()
}

/// Leaves no triangle without area where its surroundings allow it.
pub(super) fn remove(made: &mut Assembled) {
    for _ in 0..ROUNDS {
        let at = |t: &Corners| height(t.map(|v| made.positions[v as usize])) <= FLAT;
        let flat = made.triangles.iter().enumerate().filter(|(_, (_, t))| at(t));
        let slivers: Vec<usize> = flat.map(|(k, _)| k).collect();
        if slivers.is_empty() {
            return;
        }
        let mut marked = vec![false; made.positions.len()];
        let corners = |k: &usize| made.triangles[*k].1;
        slivers.iter().flat_map(corners).for_each(|v| marked[v as usize] = true);
        // The triangles beyond have tips whose own surroundings count as well.
        let mut near = Surroundings {
            left: FxHashMap::default(),
            round: FxHashMap::default(),
            stale: FxHashSet::default(),
            gone: FxHashSet::default(),
            made,
        };
        for (k, (_, t)) in near.made.triangles.iter().enumerate() {
            if t.iter().any(|&v| marked[v as usize]) {
                for i in 0..3 {
                    near.left.insert((t[i], t[(i + 1) % 3]), k);
                    if marked[t[i] as usize] {
                        near.round.entry(t[i]).or_default().push(k);
                    }
                }
            }
        }
        let mut changed = false;
        for &sliver in &slivers {
            let t = near.made.triangles[sliver].1;
            if near.gone.contains(&sliver) || t.iter().any(|v| near.stale.contains(v)) {
                changed = true;
                continue;
            }
            let p = near.points(t);
            let sides = [0, 1, 2].map(|k| p[k].distance(p[(k + 1) % 3]));
            let longest = (0..3).fold(0, |a, k| if sides[k] > sides[a] { k } else { a });
            let shortest = (0..3).fold(0, |a, k| if sides[k] < sides[a] { k } else { a });
            // From the end of the longest side via the corner between to its start.
            let row = [t[(longest + 1) % 3], t[(longest + 2) % 3], t[longest]];
            let done = if sides[shortest] <= ONE * sides[longest] {
                let (a, b) = (t[shortest], t[(shortest + 1) % 3]);
                let on = |v: u32| near.made.surfaces[v as usize].len();
                let (from, to) = if on(a) > on(b) { (b, a) } else { (a, b) };
                near.merge(from, to, true)
                    || near.merge(to, from, true)
                    || near.flap(t[(shortest + 2) % 3], from)
                    || near.flap(t[(shortest + 2) % 3], to)
            } else {
                near.turn(sliver, row)
                    || near.merge(row[1], row[0], false)
                    || near.merge(row[1], row[2], false)
            };
            changed |= done;
        }
        if !changed {
            return;
        }
        let gone = near.gone;
        if !gone.is_empty() {
            let mut k = 0;
            made.triangles.retain(|_| {
                k += 1;
                !gone.contains(&(k - 1))
            });
            made.compact();
        }
    }
}
