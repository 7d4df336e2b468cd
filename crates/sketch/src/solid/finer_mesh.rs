//! The mesh of a combined body within a tolerance: sides of facets that miss their edge or surface are halved.
//!
//! The facets that a combination was found with miss round faces by up to a thousandth of a radius. A side on an edge
//! is halved at the edge's own point, one within a round face at the surface's, in both facets beside it, so the mesh
//! stays closed. Plane faces are divided into triangles again between their finer borders.

use super::combine::triangles_of;
use super::edges::FaceForm;
use super::facet_source::newell;
use super::facet_source::{along, settled};
use super::surface::{Carrier, FaceSurface, meet};
use super::{CombinedMesh, SketchSolid};
use moldloft_num::{Real, Vec3};
use std::collections::{HashMap, HashSet};

/// Maximum number of halvings: each divides the error of a side by four, in total by 10^9.
const MOST_ROUNDS: usize = 16;

/// Maximum distance of sides from their surface, relative to its size, for a search of the nearest
/// point.
const NEAR: f64 = 0.1;

/// In the middle of a facet its surface may be farther off than at the middles of its sides, by a third.
const SIDE: f64 = 0.7;

/// A side of facets: its ends, the lower number first.
type MeshSide = (u32, u32);

fn side(a: u32, b: u32) -> MeshSide {
    (a.min(b), a.max(b))
}

impl<T: Real> SketchSolid<T> {
    /// The facets of a combined body with sides halved until they miss edges and surfaces by no more than `tolerance`.
    pub(super) fn finer(&self, facets: &CombinedMesh<T>, tolerance: f64) -> CombinedMesh<T> {
        let mut mesh = facets.clone();
        let surfaces: Vec<FaceSurface<T>> = (0..self.faces.len())
            .map(|f| self.surface(f).unwrap_or_else(|| self.plane_of(f)))
            .collect();
        let beside = self.edge_sides();
        let mut right: HashSet<MeshSide> = HashSet::new();
        for _ in 0..MOST_ROUNDS {
            let mut middles: HashMap<MeshSide, u32> = HashMap::new();
            let mut on_edge: HashSet<MeshSide> = HashSet::new();
            for e in 0..mesh.chains.len() {
                for w in mesh.chains[e].clone().windows(2) {
                    let key = side(w[0], w[1]);
                    on_edge.insert(key);
                    if self.is_line(e) || right.contains(&key) || middles.contains_key(&key) {
                        continue;
                    }
                    let ends = [w[0], w[1]].map(|v| mesh.points[v as usize]);
                    let faces: Vec<usize> = beside[e].iter().map(|s| s.face).collect();
                    let exact = self.edge_point(e, ends, &faces, &surfaces);
                    halve(exact, ends, key, tolerance, &mut mesh.points, &mut middles, &mut right);
                }
            }
            for (f, triangles) in mesh.faces.iter().enumerate() {
                if matches!(surfaces[f], FaceSurface::Plane { .. }) {
                    continue;
                }
                for t in triangles {
                    for key in [side(t[0], t[1]), side(t[1], t[2]), side(t[2], t[0])] {
                        if on_edge.contains(&key)
                            || right.contains(&key)
                            || middles.contains_key(&key)
                        {
                            continue;
                        }
                        let ends = [key.0, key.1].map(|v| mesh.points[v as usize]);
                        let middle = ends[0].lerp(ends[1], T::from(0.5));
                        let from = surfaces[f].parameters(middle.re());
                        let foot = settled(&surfaces[f], middle.re(), from, NEAR);
                        let exact = foot.map(|[u, v]| surfaces[f].jet(T::from(u), T::from(v))[0]);
                        halve(
                            exact,
                            ends,
                            key,
                            tolerance,
                            &mut mesh.points,
                            &mut middles,
                            &mut right,
                        );
                    }
                }
            }
            if middles.is_empty() {
                break;
            }
            for chain in &mut mesh.chains {
                let last = chain.last().copied();
                let halved = chain.windows(2).flat_map(|w| {
                    std::iter::once(w[0]).chain(middles.get(&side(w[0], w[1])).copied())
                });
                *chain = halved.chain(last).collect();
            }
            for triangles in &mut mesh.faces {
                *triangles = triangles.iter().flat_map(|t| divided(*t, &middles)).collect();
            }
        }
        for f in 0..self.faces.len() {
            if let FaceSurface::Plane { normal, .. } = surfaces[f]
                && let Some(triangles) = self.plane_triangles(f, normal.re(), &mesh)
            {
                mesh.faces[f] = triangles;
            }
        }
        mesh
    }

    fn plane_of(&self, face: usize) -> FaceSurface<T> {
        match self.form(face) {
            FaceForm::Plane { at, normal } => FaceSurface::Plane { at, normal },
            _ => FaceSurface::Plane { at: Vec3::zero(), normal: Vec3::zero() },
        }
    }

    fn is_line(&self, edge: usize) -> bool {
        self.edges[edge].piece.is_none() && self.edges[edge].trace.is_none()
    }

    /// The point of an edge between two of its points.
    fn edge_point(
        &self,
        edge: usize,
        [p, q]: [Vec3<T>; 2],
        faces: &[usize],
        surfaces: &[FaceSurface<T>],
    ) -> Option<Vec3<T>> {
        let middle = p.lerp(q, T::from(0.5));
        let own = &self.edges[edge];
        let piece = match &own.trace {
            Some(trace) => trace.carrier,
            None => own.piece.map(|_| self.piece((edge, true))),
        };
        if let Some(piece) = piece {
            return Some(piece.at(T::from(along(&piece, middle.re()))));
        }
        let normal = (q - p).normalized()?;
        let across = FaceSurface::Plane { at: middle, normal };
        let mut on: Vec<Carrier<'_, T>> =
            faces.iter().map(|f| Carrier::Surface(&surfaces[*f])).collect();
        on.push(Carrier::Surface(&across));
        let start: Vec<[f64; 2]> = (on.iter())
            .map(|o| match o {
                Carrier::Surface(FaceSurface::Plane { .. }) | Carrier::Curve(_) => [0.0; 2],
                Carrier::Surface(s) => s.parameters(middle.re()),
            })
            .collect();
        let reach = 0.5 * p.re().distance(q.re());
        let met = meet(&on, middle.re(), &start, middle.re().norm() + reach);
        let near = |x: &Vec3<T>| x.re().distance(middle.re()) <= reach;
        // At tangent surfaces: the nearest of the known points along the edge.
        let known = || {
            let nodes = own.trace.iter().flat_map(|t| &t.nodes).map(|n| n.0);
            nodes.min_by(|a, b| {
                a.re().distance(middle.re()).total_cmp(&b.re().distance(middle.re()))
            })
        };
        met.map(|m| m.at).filter(near).or_else(known).filter(near)
    }

    /// Triangles of a plane face between its borders; `None` where they are not the whole of it.
    fn plane_triangles(
        &self,
        face: usize,
        normal: Vec3,
        mesh: &CombinedMesh<T>,
    ) -> Option<Vec<[u32; 3]>> {
        let at = |v: u32| mesh.points[v as usize].re();
        let loops: Vec<Vec<u32>> = (self.faces[face].loops.iter())
            .map(|cycle| {
                let run = |&(e, forward): &(usize, bool)| {
                    let mut way = mesh.chains[e].clone();
                    if !forward {
                        way.reverse();
                    }
                    way.pop();
                    way
                };
                cycle.iter().flat_map(run).collect()
            })
            .collect();
        let area =
            |ring: &[u32]| newell(&ring.iter().map(|&v| at(v)).collect::<Vec<_>>()).dot(normal);
        let wanted: f64 = loops.iter().map(|c| area(c)).sum();
        let triangles = triangles_of(&loops, &at, normal);
        let areas: Vec<f64> = triangles.iter().map(|t| area(t)).collect();
        let whole = (areas.iter().sum::<f64>() - wanted).abs() <= 1e-9 * wanted.abs();
        (whole && areas.iter().all(|a| *a >= -1e-12 * wanted.abs())).then_some(triangles)
    }
}

/// Halves a side that misses its exact point.
fn halve<T: Real>(
    exact: Option<Vec3<T>>,
    [p, q]: [Vec3<T>; 2],
    key: MeshSide,
    tolerance: f64,
    points: &mut Vec<Vec3<T>>,
    middles: &mut HashMap<MeshSide, u32>,
    right: &mut HashSet<MeshSide>,
) {
    let middle = p.lerp(q, T::from(0.5)).re();
    match exact {
        Some(exact) if exact.re().distance(middle) > SIDE * tolerance => {
            middles.insert(key, points.len() as u32);
            points.push(exact);
        }
        _ => {
            right.insert(key);
        }
    }
}

fn divided(t: [u32; 3], middles: &HashMap<MeshSide, u32>) -> Vec<[u32; 3]> {
    let middle = |k: usize| middles.get(&side(t[k], t[(k + 1) % 3])).copied();
    let found = [middle(0), middle(1), middle(2)];
    // Turned so that the first side is halved, and the last one only if all are.
    let first = match found {
        [None, None, None] => return vec![t],
        [Some(_), _, None] | [Some(_), Some(_), Some(_)] => 0,
        [_, Some(_), _] => 1,
        [_, None, Some(_)] => 2,
    };
    let [a, b, c] = [0, 1, 2].map(|k| t[(first + k) % 3]);
    match [0, 1, 2].map(|k| found[(first + k) % 3]) {
        [Some(m), Some(n), Some(o)] => vec![[a, m, o], [m, b, n], [o, n, c], [m, n, o]],
        [Some(m), Some(n), None] => vec![[m, b, n], [a, m, n], [a, n, c]],
        [Some(m), ..] => vec![[a, m, c], [m, b, c]],
        _ => vec![t],
    }
}
