//! Bodies as plane facets, for arrangements and meshes.

use super::combine::LoopsAndTags;
use super::surface::FaceSurface;
use super::{SketchSolid, SolidFace};
use crate::solid::arrangement::INNER;
use moldloft_num::{Real, Vec3};
use std::collections::HashMap;

/// The points of a body's facets, with those along each edge and the strips of each round face.
pub(super) struct Outline<T> {
    pub points: Vec<Vec3<T>>,
    chains: Vec<Vec<u32>>,
    strips: Vec<Vec<LoopsAndTags>>,
}

impl<T: Real> SketchSolid<T> {
    /// The facets of the body, with a chord for each 5° of round edges or, by the body's fineness, a part of it.
    pub(super) fn outline(&self) -> Outline<T> {
        if let Some(facets) = &self.facets {
            let mut side: HashMap<(u32, u32), u32> = HashMap::new();
            for (e, chain) in facets.chains.iter().enumerate() {
                for w in chain.windows(2) {
                    side.insert((w[0].min(w[1]), w[0].max(w[1])), e as u32);
                }
            }
            let tag = |a: u32, b: u32| *side.get(&(a.min(b), a.max(b))).unwrap_or(&INNER);
            let strip = |&[a, b, c]: &[u32; 3]| -> LoopsAndTags {
                (vec![vec![a, b, c]], vec![vec![tag(a, b), tag(b, c), tag(c, a)]])
            };
            let strips = (self.faces.iter().zip(&facets.faces))
                .map(|(f, t)| if f.trim.is_some() { t.iter().map(strip).collect() } else { vec![] })
                .collect();
            return Outline {
                points: facets.points.clone(),
                chains: facets.chains.clone(),
                strips,
            };
        }
        let chords = self.angular_chords();
        let mut points: Vec<Vec3<T>> = self.vertices.iter().map(|v| v.at).collect();
        let mut chains: Vec<Vec<u32>> = Vec::new();
        for (e, &n) in chords.iter().enumerate() {
            let piece = self.piece((e, true));
            let [a, b] = self.edges[e].ends.map(|v| v as u32);
            let mut chain = vec![a];
            for k in 1..n {
                chain.push(points.len() as u32);
                points.push(piece.at(T::from(k as f64 / n as f64)));
            }
            chain.push(b);
            chains.push(chain);
        }
        let mut strips = Vec::new();
        for (f, face) in self.faces.iter().enumerate() {
            let Some(surface) = self.surface(f) else {
                strips.push(vec![]);
                continue;
            };
            let run = |h: (usize, bool)| directed(&chains, h);
            let quads = patch(&surface, &face.loops[0], &run, &mut points);
            let mut side: HashMap<(u32, u32), u32> = HashMap::new();
            for &(e, _) in &face.loops[0] {
                for w in chains[e].windows(2) {
                    side.insert((w[0].min(w[1]), w[0].max(w[1])), e as u32);
                }
            }
            let tag = |a: u32, b: u32| *side.get(&(a.min(b), a.max(b))).unwrap_or(&INNER);
            let at = |v: u32| points[v as usize].re();
            let mut own: Vec<LoopsAndTags> = Vec::new();
            for [a, b, c, d] in quads {
                let ring = |cycle: Vec<u32>| -> LoopsAndTags {
                    let n = cycle.len();
                    let tags = (0..n).map(|k| tag(cycle[k], cycle[(k + 1) % n])).collect();
                    (vec![cycle], vec![tags])
                };
                let normal = (at(c) - at(a)).cross(at(d) - at(b));
                let bend = (at(b) - at(a)).dot(normal).abs();
                let flat = bend <= 1e-13 * normal.norm() * (at(c) - at(a)).norm();
                if c == d {
                    own.push(ring(vec![a, b, c]));
                } else if flat {
                    own.push(ring(vec![a, b, c, d]));
                } else {
                    own.push(ring(vec![a, b, c]));
                    own.push(ring(vec![a, c, d]));
                }
            }
            strips.push(own);
        }
        Outline { points, chains, strips }
    }
}

impl<T: Real> Outline<T> {
    /// The facets of a round face.
    pub fn strips(&self, _: &SketchSolid<T>, face: usize) -> Vec<LoopsAndTags> {
        self.strips[face].clone()
    }

    /// The points along an edge as it is run.
    pub fn way(&self, h: (usize, bool)) -> Vec<u32> {
        directed(&self.chains, h)
    }

    /// The loops of a plane face with the edge of each side.
    pub fn loops(&self, body: &SketchSolid<T>, face: usize) -> LoopsAndTags {
        let SolidFace { loops, .. } = &body.faces[face];
        let mut points = Vec::new();
        let mut tags = Vec::new();
        for cycle in loops {
            let (mut own, mut sides) = (Vec::new(), Vec::new());
            for &h in cycle {
                let mut way = directed(&self.chains, h);
                way.pop();
                sides.extend(std::iter::repeat_n(h.0 as u32, way.len()));
                own.extend(way);
            }
            points.push(own);
            tags.push(sides);
        }
        (points, tags)
    }
}

fn directed(chains: &[Vec<u32>], (e, forward): (usize, bool)) -> Vec<u32> {
    let mut way = chains[e].clone();
    if !forward {
        way.reverse();
    }
    way
}

/// The facets of a patch bounded by its parameter lines: quads between the first edge of its cycle and
/// the third, or triangles to the point that a cycle of three edges ends in.
pub(super) fn patch<T: Real>(
    surface: &FaceSurface<T>,
    cycle: &[(usize, bool)],
    run: &dyn Fn((usize, bool)) -> Vec<u32>,
    places: &mut Vec<Vec3<T>>,
) -> Vec<[u32; 4]> {
    let near = run(cycle[0]);
    let n = near.len();
    let (far, left, right) = match *cycle {
        [_, right, far, left] => {
            let (mut far, mut left) = (run(far), run(left));
            far.reverse();
            left.reverse();
            (Some(far), left, run(right))
        }
        [_, right, left] => {
            let mut left = run(left);
            left.reverse();
            (None, left, run(right))
        }
        _ => return vec![],
    };
    let m = left.len();
    if right.len() != m || far.as_ref().is_some_and(|f| f.len() != n) {
        return vec![];
    }
    // Which way the parameters run along the first edge and the sides.
    let grid = PatchOrientation::of(surface, places, &near, &left);
    let mut rows = vec![near.clone()];
    for j in 1..m - 1 {
        let mut row = vec![left[j]];
        for i in 1..n - 1 {
            let (s, t) = (i as f64 / (n - 1) as f64, j as f64 / (m - 1) as f64);
            let [u, v] = grid.at(s, t);
            row.push(places.len() as u32);
            places.push(surface.jet(T::from(u), T::from(v))[0]);
        }
        row.push(right[j]);
        rows.push(row);
    }
    rows.push(far.unwrap_or_else(|| vec![left[m - 1]; n]));
    let mut quads = Vec::new();
    for w in rows.windows(2) {
        for i in 0..n - 1 {
            let [a, b, c, d] = [w[0][i], w[0][i + 1], w[1][i + 1], w[1][i]];
            quads.push(if c == d { [a, b, c, c] } else { [a, b, c, d] });
        }
    }
    quads
}

/// How the first edge (s) and the sides (t) of a patch run in its parameters.
struct PatchOrientation {
    corner: [f64; 2],
    along: [f64; 2],
    across: [f64; 2],
}

impl PatchOrientation {
    fn of<T: Real>(
        surface: &FaceSurface<T>,
        places: &[Vec3<T>],
        near: &[u32],
        left: &[u32],
    ) -> PatchOrientation {
        let place = |v: u32| places[v as usize].re();
        let corner = |u: f64, v: f64| surface.jet(T::from(u), T::from(v))[0].re();
        // The corners of the square that the patch's own corners are nearest to.
        let (a, b, d) = (place(near[0]), place(near[near.len() - 1]), place(left[left.len() - 1]));
        let mut best = (
            f64::INFINITY,
            PatchOrientation { corner: [0.0; 2], along: [1.0, 0.0], across: [0.0, 1.0] },
        );
        for (u, v) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let (du, dv) = (1.0 - 2.0 * u, 1.0 - 2.0 * v);
            for (along, across) in [([du, 0.0], [0.0, dv]), ([0.0, dv], [du, 0.0])] {
                let off = corner(u, v).distance(a)
                    + corner(u + along[0], v + along[1]).distance(b)
                    + corner(u + across[0], v + across[1]).distance(d);
                if off < best.0 {
                    best = (off, PatchOrientation { corner: [u, v], along, across });
                }
            }
        }
        best.1
    }

    fn at(&self, s: f64, t: f64) -> [f64; 2] {
        [0, 1].map(|k| self.corner[k] + self.along[k] * s + self.across[k] * t)
    }
}
