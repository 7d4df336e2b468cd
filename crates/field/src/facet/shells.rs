//! Connected parts of facets: number of bodies, and their contacts.

use super::Facets;
use super::assemble::Assembled;
use moldloft_num::Vec3;
use moldloft_num::union_find::UnionFind;
use rustc_hash::FxHashMap;
use std::collections::HashMap;

/// Shells no thicker than this part of a cell enclose nothing.
const FLAT: f64 = 1e-9;

/// Removes shells that enclose nothing: a corner of the grid just within a sharp edge, whose
/// neighbours are all outside, has a shell of its own. Its vertices all move to the edge and the
/// faces beside it, where the other triangles are already.
pub(super) fn remove_flat(made: &mut Assembled, step: f64) {
    // Excluded elsewhere by construction.
    if made.doubtful.is_empty() {
        return;
    }
    let mut parts = UnionFind::new(made.positions.len());
    for (_, t) in &made.triangles {
        parts.join(t[0], t[1]);
        parts.join(t[0], t[2]);
    }
    // Volume and area of each shell, by its first vertex.
    let mut shells: FxHashMap<u32, (f64, f64)> = FxHashMap::default();
    for (_, t) in &made.triangles {
        let first = parts.find(t[0]);
        let [o, a, b, c] = [first, t[0], t[1], t[2]].map(|v| made.positions[v as usize]);
        let across = (b - a).cross(c - a);
        let shell = shells.entry(first).or_default();
        shell.0 += (a - o).dot(across) / 6.0;
        shell.1 += 0.5 * across.norm();
    }
    let flat = |of: &(f64, f64)| of.0.abs() <= FLAT * step * of.1;
    if shells.len() < 2 || shells.values().all(flat) || !shells.values().any(flat) {
        return;
    }
    made.triangles.retain(|(_, t)| !flat(&shells[&parts.find(t[0])]));
    made.compact();
}

/// A connected part of facets.
#[derive(Clone, Debug, PartialEq)]
pub struct FacetShell {
    /// The volume that it encloses; negative for a cavity.
    pub volume: f64,
    /// Its triangles, ascending.
    pub faces: Vec<u32>,
}

impl Facets {
    /// The connected parts of the surface, in the order of their first triangles. A body has one of positive
    /// volume and one of negative volume for each of its cavities.
    pub fn shells(&self) -> Vec<FacetShell> {
        let faces = self.mesh.faces();
        let mut parts = UnionFind::new(self.mesh.positions().len());
        for f in faces {
            for k in 1..3 {
                parts.join(f[0], f[k]);
            }
        }
        let mut number: HashMap<u32, usize> = HashMap::new();
        let mut shells: Vec<FacetShell> = Vec::new();
        for (t, f) in faces.iter().enumerate() {
            let at = parts.find(f[0]);
            let k = *number.entry(at).or_insert_with(|| {
                shells.push(FacetShell { volume: 0.0, faces: Vec::new() });
                shells.len() - 1
            });
            let [a, b, c] = [0, 1, 2].map(|i| self.mesh.positions()[f[i] as usize]);
            shells[k].volume += a.dot(b.cross(c)) / 6.0;
            shells[k].faces.push(t as u32);
        }
        shells
    }

    /// Number of connected solids; bodies that only touch count separately.
    pub fn bodies(&self) -> usize {
        self.shells().iter().filter(|s| s.volume > 0.0).count()
    }

    /// Contacts: positions where two shells have a vertex each, ascending by x, y, z. The vertices
    /// are separate, so that both shells are manifold.
    pub fn touching(&self) -> Vec<Vec3> {
        let shells = self.shells();
        if shells.len() < 2 {
            return self.contacts.clone();
        }
        let positions = self.mesh.positions();
        let mut shell = vec![0usize; positions.len()];
        for (k, one) in shells.iter().enumerate() {
            for &t in &one.faces {
                self.mesh.faces()[t as usize].iter().for_each(|&v| shell[v as usize] = k);
            }
        }
        // Bins are much wider than the tolerance, so that most points are far from their sides.
        let near = 1e-7 * self.step;
        let bin = |p: Vec3, reach: f64| {
            let side = 1e-2 * self.step;
            let end = |x: f64| (x / side).floor() as i64;
            [0, 1, 2].map(|k| [end(p[k] - reach), end(p[k] + reach)])
        };
        let mut bins: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
        for (v, p) in positions.iter().enumerate() {
            bins.entry(bin(*p, 0.0).map(|ends| ends[0])).or_default().push(v as u32);
        }
        let others = |v: usize| {
            let [x, y, z] = bin(positions[v], near).map(|[low, high]| low..=high);
            let bins = &bins;
            x.flat_map(move |i| {
                let z = z.clone();
                y.clone().flat_map(move |j| z.clone().map(move |k| [i, j, k]))
            })
            .filter_map(|key| bins.get(&key))
            .flatten()
            .map(|&w| w as usize)
        };
        // The first of the coincident vertices represents all.
        let meets = |v: usize| {
            let here = || others(v).filter(|&w| positions[v].distance(positions[w]) <= near);
            here().all(|w| v <= w) && here().any(|w| shell[v] != shell[w])
        };
        let mut found: Vec<Vec3> =
            (0..positions.len()).filter(|&v| meets(v)).map(|v| positions[v]).collect();
        let known = found.len();
        for p in &self.contacts {
            if found[..known].iter().all(|q| q.distance(*p) > near) {
                found.push(*p);
            }
        }
        found.sort_by(|a, b| {
            a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
        });
        found
    }
}
