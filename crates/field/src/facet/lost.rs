//! Content that facets to an accuracy must not miss: parts of the set without a triangle nearby,
//! and possible bridges between bodies.
//!
//! Unresolved regions are joined to clusters where they touch. A cluster is lost if no vertex is
//! within the accuracy, if the triangles about it belong to several bodies, or if a region of it is
//! larger than the accuracy; all are lost if their volume is significant. So are cells with cut-off
//! edges or corners: for a plate about as thick as a cell these are most of its cells, and its
//! triangles have holes.

use super::{Facets, Unresolved};
use moldloft_mesh::Mesh;
use moldloft_num::union_find::UnionFind;
use moldloft_num::{Box3, Vec3};
use rustc_hash::{FxHashMap, FxHashSet};

/// Maximum content of all such regions, relative to the body.
const HELD: f64 = 1e-3;

pub(super) fn side(b: &Box3) -> f64 {
    (0..3).map(|k| b.high[k] - b.low[k]).fold(0.0, f64::max)
}

/// The number of its body, by connection, of each vertex.
fn bodies(mesh: &Mesh) -> UnionFind {
    let mut bodies = UnionFind::new(mesh.positions().len());
    for face in mesh.faces() {
        bodies.join(face[0] as usize, face[1] as usize);
        bodies.join(face[0] as usize, face[2] as usize);
    }
    bodies
}

type Bin = [i64; 3];

fn bin(p: Vec3, size: f64) -> Bin {
    [0, 1, 2].map(|k| (p[k] / size).floor() as i64)
}

fn around([i, j, k]: Bin) -> impl Iterator<Item = Bin> {
    (0..27).map(move |n| [i + n % 3 - 1, j + n / 3 % 3 - 1, k + n / 9 - 1])
}

/// The clusters of touching regions, in the order of their first.
fn clusters(open: &[Unresolved], step: f64) -> Vec<Vec<usize>> {
    let mut groups = UnionFind::new(open.len());
    let mut bins: FxHashMap<Bin, usize> = FxHashMap::default();
    // The regions of a cell belong together; cells that touch are neighbours.
    for (k, u) in open.iter().enumerate() {
        let own = bin(u.place.centre(), step);
        for b in around(own) {
            if let Some(&other) = bins.get(&b) {
                groups.join(k, other);
            }
        }
        bins.entry(own).or_insert(k);
    }
    let mut of: FxHashMap<usize, Vec<usize>> = FxHashMap::default();
    for k in 0..open.len() {
        of.entry(groups.find(k)).or_default().push(k);
    }
    let mut all: Vec<Vec<usize>> = of.into_values().collect();
    all.sort_unstable();
    all
}

/// The most evident lost region, if there is one.
pub(super) fn lost(facets: &Facets, accuracy: f64) -> Option<Unresolved> {
    let open = &facets.unresolved;
    let largest =
        |of: &[usize]| of.iter().map(|&k| open[k]).max_by(|a, b| a.volume.total_cmp(&b.volume));
    let every: Vec<usize> = (0..open.len()).collect();
    let large: Vec<usize> =
        every.iter().copied().filter(|&k| side(&open[k].place) > accuracy).collect();
    if let Some(u) = largest(&large) {
        return Some(u);
    }
    let body = moldloft_mesh::measure(&facets.mesh).volume.abs();
    if open.iter().map(|u| u.volume).sum::<f64>() > HELD * body {
        return largest(&every);
    }
    let volume = |b: &Box3| (0..3).map(|k| b.high[k] - b.low[k]).product::<f64>();
    if facets.blunt.iter().map(volume).sum::<f64>() > HELD * body {
        let place = facets.blunt[facets.blunt.len() / 2];
        let (volume, witness) = (volume(&place), place.centre());
        return Some(Unresolved { place, volume, missed: true, witness, solid: true });
    }
    let reach = accuracy.max(2.0 * facets.step);
    let positions = facets.mesh.positions();
    let mut bodies = bodies(&facets.mesh);
    let mut near: FxHashMap<Bin, Vec<u32>> = FxHashMap::default();
    let wanted: FxHashSet<Bin> = open.iter().flat_map(|u| around(bin(u.witness, reach))).collect();
    for (v, p) in positions.iter().enumerate() {
        let b = bin(*p, reach);
        if wanted.contains(&b) {
            near.entry(b).or_default().push(v as u32);
        }
    }
    for cluster in clusters(open, facets.step) {
        let mut about = FxHashSet::default();
        for &k in &cluster {
            let at = open[k].witness;
            let found = around(bin(at, reach)).filter_map(|b| near.get(&b)).flatten();
            let mut seen = false;
            for &v in found {
                let far = positions[v as usize].distance(at);
                seen |= far <= reach;
                if far <= 2.0 * facets.step {
                    about.insert(bodies.find(v as usize));
                }
            }
            if !seen {
                return Some(open[k]);
            }
        }
        // Contacts are between bodies that are known to be several.
        if about.len() > 1 && facets.contacts.is_empty() {
            return largest(&cluster);
        }
    }
    None
}
