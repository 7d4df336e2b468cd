//! Wires: the edges between two sheets as polylines along their common curve, in one direction.
//!
//! Cells place their vertices independently: those of two neighbours may be in reversed order along
//! an edge, and a vertex of a cell with more surfaces than it can separate is on none of them. That
//! does not matter for faces; a line through such vertices would go back and forth, and be too
//! long.

use crate::Primitive;
use crate::facet::Facets;
use crate::facet::sheets::number;
use crate::facet::types::LeafIncidence;
use crate::facet::vertex::{Solver, Surfaces};
use moldloft_num::{Box3, Vec3};
use std::collections::HashMap;

/// A curve in which two sheets meet.
#[derive(Clone, Debug)]
pub struct FacetWire {
    /// Its vertices in order; the first is not repeated when it is closed.
    pub points: Vec<Vec3>,
    /// True when it ends where it began.
    pub closed: bool,
    /// Indices of its two leaves.
    pub leaves: [usize; 2],
    /// Leaves of its vertices.
    pub on: LeafIncidence,
}

impl FacetWire {
    /// The length of its chords.
    pub fn length(&self) -> f64 {
        let steps = self.points.windows(2).map(|p| p[0].distance(p[1])).sum::<f64>();
        match (self.closed, self.points.first(), self.points.last()) {
            (true, Some(a), Some(b)) => steps + b.distance(*a),
            _ => steps,
        }
    }
}

/// Maximum distance of a vertex, in cells.
const REACH: f64 = 2.0;

/// The wires between the faces of two primitives, which are `leaves` of the set, in the order of their lowest vertex.
pub(super) fn wires_of(
    facets: &Facets,
    pair: [&Primitive; 2],
    leaves: [usize; 2],
) -> Vec<FacetWire> {
    let [Some(a), Some(b)] = pair.map(|f| number(facets, f)) else { return Vec::new() };
    let own: Surfaces = [a.min(b), a.max(b)].into_iter().collect();
    let mut solver = Solver::default();
    let mut found = Vec::new();
    for (chain, closed) in chains(facets, [a, b]) {
        let mut places: Vec<WirePoint> = Vec::with_capacity(chain.len());
        for (k, &v) in chain.iter().enumerate() {
            let at = facets.mesh.positions()[v as usize];
            let surfaces = &facets.surfaces[v as usize];
            if own.iter().all(|s| surfaces.contains(s)) {
                places.push(WirePoint { at, surfaces: surfaces.clone() });
            } else if let Some(at) = on_curve(&mut solver, facets, &own, at) {
                places.push(WirePoint { at, surfaces: own.clone() });
            } else if !closed && (k == 0 || k + 1 == chain.len()) {
                places.push(WirePoint { at, surfaces: surfaces.clone() });
            }
        }
        let tangent = |p: Vec3| {
            let [f, g] = [a, b].map(|k| facets.leaves[k as usize].primitive.gradient(p).slope);
            f.normalized().unwrap_or_default().cross(g.normalized().unwrap_or_default())
        };
        let places = forward(places, closed, 1e-9 * facets.step, &tangent);
        // A sliver with all corners on the curve has a border of its own, in both directions.
        if places.len() < if closed { 3 } else { 2 } {
            continue;
        }
        let (points, surfaces) = places.into_iter().map(|p| (p.at, p.surfaces)).unzip();
        let on = LeafIncidence { leaves: facets.leaves.clone(), surfaces };
        found.push(FacetWire { points, closed, leaves, on });
    }
    found
}

/// A vertex of a wire, with its leaves.
struct WirePoint {
    at: Vec3,
    surfaces: Surfaces,
}

/// The point of both surfaces that is near a vertex of neither.
fn on_curve(solver: &mut Solver, facets: &Facets, own: &[u32], at: Vec3) -> Option<Vec3> {
    let away = REACH * facets.step;
    let reach = Vec3::of(away, away, away);
    let around = Box3 { low: at - reach, high: at + reach };
    let goal = 1e-12 * (away + at.norm());
    let placed = solver.place(&facets.leaves, own, at, &around, goal);
    (placed.residual <= goal).then_some(placed.point)
}

/// The points in increasing order along the curve; points behind an earlier one are removed, except
/// ends and corners.
fn forward(
    places: Vec<WirePoint>,
    closed: bool,
    near: f64,
    tangent: &dyn Fn(Vec3) -> Vec3,
) -> Vec<WirePoint> {
    let along = |p: &WirePoint, q: &WirePoint| {
        let (p, q) = (p.at, q.at);
        (q - p).dot(tangent(p) + tangent(q))
    };
    let sum: f64 = places.windows(2).map(|pair| along(&pair[0], &pair[1])).sum();
    // At a contact of surfaces the direction is undefined.
    let behind = |p: &WirePoint, q: &WirePoint| {
        p.at.distance(q.at) <= near || along(p, q) * sum.signum() < 0.0
    };
    let count = places.len();
    let mut kept: Vec<WirePoint> = Vec::with_capacity(count);
    for (k, place) in places.into_iter().enumerate() {
        let fixed = place.surfaces.len() > 2 || (!closed && k + 1 == count);
        while kept.last().is_some_and(|last| behind(last, &place)) {
            let last_fixed = kept.len() == 1 || kept[kept.len() - 1].surfaces.len() > 2;
            if !fixed || last_fixed {
                break;
            }
            kept.pop();
        }
        let stays = kept.last().is_none_or(|last| !behind(last, &place));
        if stays || (fixed && kept.last().is_some_and(|last| last.at.distance(place.at) > near)) {
            kept.push(place);
        }
    }
    while closed && kept.len() > 2 && behind(&kept[kept.len() - 1], &kept[0]) {
        kept.pop();
    }
    kept
}

/// The edges between the faces of two primitives, chained, in the order of their lowest vertex.
fn chains(facets: &Facets, [a, b]: [u32; 2]) -> Vec<(Vec<u32>, bool)> {
    let mut sides: HashMap<(u32, u32), u32> = HashMap::new();
    let mut next: HashMap<u32, Vec<u32>> = HashMap::new();
    for (patch, &leaf) in facets.mesh.patches().iter().zip(&facets.patch_leaves) {
        let leaf = leaf as u32;
        if leaf != a && leaf != b {
            continue;
        }
        for face in &facets.mesh.faces()[patch.faces.clone()] {
            for k in 0..3 {
                let (p, q) = (face[k], face[(k + 1) % 3]);
                match sides.get(&(q, p)) {
                    Some(&other) if other != leaf => {
                        next.entry(p).or_default().push(q);
                        next.entry(q).or_default().push(p);
                    }
                    _ => {
                        sides.insert((p, q), leaf);
                    }
                }
            }
        }
    }
    let mut vertices: Vec<u32> = next.keys().copied().collect();
    // Open chains first, from their ends.
    vertices.sort_unstable_by_key(|v| (next[v].len() != 1, *v));
    let mut used: HashMap<(u32, u32), ()> = HashMap::new();
    let mut out = Vec::new();
    for start in vertices {
        loop {
            let mut chain = vec![start];
            let mut at = start;
            while let Some(&to) = next[&at].iter().find(|&&to| !used.contains_key(&(at, to))) {
                used.insert((at, to), ());
                used.insert((to, at), ());
                if to == start {
                    break;
                }
                chain.push(to);
                at = to;
            }
            if chain.len() < 2 {
                break;
            }
            let last = chain[chain.len() - 1];
            let closed = chain.len() > 2 && next[&last].contains(&start);
            out.push((chain, closed));
        }
    }
    out
}
