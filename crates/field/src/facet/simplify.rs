//! Fewer triangles where the surface is flat: vertices are moved into neighbours, the cheapest first.
//!
//! Only whole vertices are removed, so the others stay on their surfaces. A vertex of a face may be
//! merged into any neighbour, one of an edge only along the edge, one of a corner never. On a
//! cylinder triangles become long along its axis, which saves most.

use super::refine::{Normals, normals};
use super::{Facets, crossing_faces, distance, vertex};
use crate::FieldError;
use crate::expr::tape::ExprTape;
use moldloft_mesh::{Mesh, TopologyBuilder};
use moldloft_num::Vec3;
use smallvec::SmallVec;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::Arc;

/// Minimum height of a triangle, relative to its longest side.
const THIN: f64 = 0.04;
/// The least cosine of the angle by which a triangle turns.
const TURN: f64 = 0.8;
/// Number of repetitions, with vertices beside intersecting triangles locked.
const TRIES: usize = 4;

/// A vertex that may be merged into another, and the error of this.
struct EdgeCollapse {
    error: f64,
    from: u32,
    into: u32,
    stamp: u32,
}

impl PartialEq for EdgeCollapse {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o) == Ordering::Equal
    }
}
impl Eq for EdgeCollapse {}
impl PartialOrd for EdgeCollapse {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for EdgeCollapse {
    /// The cheapest first; of equal ones that of the lowest vertex.
    fn cmp(&self, o: &Self) -> Ordering {
        let places = (o.from, o.into).cmp(&(self.from, self.into));
        o.error.total_cmp(&self.error).then(places)
    }
}

type Star = SmallVec<[u32; 8]>;

struct Simplifier<'a> {
    positions: &'a [Vec3],
    surfaces: &'a [SmallVec<[u32; 3]>],
    tapes: Vec<&'a Arc<ExprTape<f64>>>,
    triangles: Vec<[u32; 3]>,
    leaves: Vec<u32>,
    alive: Vec<bool>,
    stars: Vec<Star>,
    stamps: Vec<u32>,
    locked: &'a [bool],
    normals: &'a [Normals],
    solver: vertex::Solver,
    accuracy: f64,
}

impl Simplifier<'_> {
    fn corners(&self, t: [u32; 3]) -> [Vec3; 3] {
        t.map(|v| self.positions[v as usize])
    }

    /// The vertices beside `v`, ascending.
    fn ring(&self, v: u32) -> Star {
        let mut ring: Star = self.stars[v as usize]
            .iter()
            .flat_map(|&t| self.triangles[t as usize])
            .filter(|&w| w != v)
            .collect();
        ring.sort_unstable();
        ring.dedup();
        ring
    }

    /// The triangles removed when `v` is merged into `w`; `None` when it must not be.
    fn beside(&self, v: u32, w: u32) -> Option<SmallVec<[u32; 2]>> {
        let (own, other) = (&self.surfaces[v as usize], &self.surfaces[w as usize]);
        if self.locked[v as usize] || own.len() > 2 || !own.iter().all(|s| other.contains(s)) {
            return None;
        }
        let beside: SmallVec<[u32; 2]> = self.stars[v as usize]
            .iter()
            .copied()
            .filter(|&t| self.triangles[t as usize].contains(&w))
            .collect();
        if beside.len() != 2 {
            return None;
        }
        // Along an edge the two triangles are on its two sides.
        let patches = [0, 1].map(|k| self.leaves[beside[k] as usize]);
        (own.len() != 2 || patches[0] != patches[1]).then_some(beside)
    }

    /// True when just two vertices are beside both, or the surface would be torn or pinched.
    fn stays_whole(&self, v: u32, w: u32) -> bool {
        let (a, b) = (self.ring(v), self.ring(w));
        a.iter().filter(|x| b.contains(x)).count() == 2
    }

    fn normal(&self, v: u32, leaf: u32) -> Vec3 {
        let k = self.surfaces[v as usize].iter().position(|&s| s == leaf);
        k.map_or_else(Vec3::zero, |k| self.normals[v as usize][k])
    }

    /// The error of moving `v` into `w`, from the normals of the surface at the vertices: a chord e leaves
    /// the middle of an arc between normals n and m by |e . (m - n)| / 8. `None` when that must not be.
    fn error(&self, v: u32, w: u32) -> Option<f64> {
        let beside = self.beside(v, w)?;
        let mut worst = 0.0f64;
        for &t in self.stars[v as usize].iter().filter(|t| !beside.contains(t)) {
            let old = self.triangles[t as usize];
            let new = old.map(|x| if x == v { w } else { x });
            let [p, q, r] = self.corners(old);
            let [a, b, c] = self.corners(new);
            let (n, m) = ((q - p).cross(r - p), (b - a).cross(c - a));
            let sides = [(b - a).norm_sq(), (c - b).norm_sq(), (a - c).norm_sq()];
            let longest = sides.into_iter().fold(0.0, f64::max);
            let (size, turned) = (m.norm(), n.dot(m));
            if size < THIN * longest || turned < TURN * n.norm() * size {
                return None;
            }
            let leaf = self.leaves[t as usize];
            let [l, m, n] = new.map(|x| self.normal(x, leaf));
            if l == Vec3::zero() || m == Vec3::zero() || n == Vec3::zero() {
                return None;
            }
            let arcs = [(b - a).dot(m - l), (c - b).dot(n - m), (a - c).dot(l - n)];
            worst = arcs.into_iter().fold(worst, |w, x| w.max(x.abs() / 8.0));
            if worst > self.accuracy || worst.is_nan() {
                return None;
            }
        }
        Some(worst)
    }

    /// True when middles and sides of the triangles about `v`, moved into `w`, are near enough, by |f| / |f'|.
    fn proves(&mut self, v: u32, w: u32) -> bool {
        let star = self.stars[v as usize].clone();
        star.into_iter().all(|t| {
            let old = self.triangles[t as usize];
            if old.contains(&w) {
                return true;
            }
            let [a, b, c] = self.corners(old.map(|x| if x == v { w } else { x }));
            let tape = self.tapes[self.leaves[t as usize] as usize];
            let places = [(a + b + c) / 3.0, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
            // NaN is refused, too.
            places
                .into_iter()
                .all(|place| distance(&mut self.solver, tape, place).abs() <= self.accuracy)
        })
    }

    /// The collapse of a vertex with the least error.
    fn candidate(&self, v: u32) -> Option<EdgeCollapse> {
        if self.stars[v as usize].is_empty() {
            return None;
        }
        let mut best: Option<EdgeCollapse> = None;
        for w in self.ring(v) {
            if let Some(error) = self.error(v, w) {
                let one = EdgeCollapse { error, from: v, into: w, stamp: self.stamps[v as usize] };
                if best.as_ref().is_none_or(|b| one > *b) {
                    best = Some(one);
                }
            }
        }
        best
    }

    fn collapse(&mut self, v: u32, w: u32) {
        for t in std::mem::take(&mut self.stars[v as usize]) {
            let triangle = &mut self.triangles[t as usize];
            if triangle.contains(&w) {
                self.alive[t as usize] = false;
                for x in *triangle {
                    self.stars[x as usize].retain(|s| *s != t);
                }
            } else {
                triangle.iter_mut().filter(|x| **x == v).for_each(|x| *x = w);
                let star = &mut self.stars[w as usize];
                let place = star.partition_point(|s| *s < t);
                star.insert(place, t);
            }
        }
    }

    fn run(&mut self) {
        let mut heap = BinaryHeap::new();
        for v in 0..self.positions.len() as u32 {
            heap.extend(self.candidate(v));
        }
        while let Some(c) = heap.pop() {
            if self.stamps[c.from as usize] != c.stamp {
                continue;
            }
            // Changes around the target may forbid the collapse.
            if self.error(c.from, c.into) != Some(c.error) {
                self.stamps[c.from as usize] += 1;
                heap.extend(self.candidate(c.from));
                continue;
            }
            if !self.stays_whole(c.from, c.into) || !self.proves(c.from, c.into) {
                continue;
            }
            let ring = self.ring(c.from);
            self.stamps[c.from as usize] += 1;
            self.collapse(c.from, c.into);
            for x in ring {
                self.stamps[x as usize] += 1;
                heap.extend(self.candidate(x));
            }
        }
    }
}

impl Facets {
    /// The same surface with fewer triangles: their centres and sides stay within `accuracy` of it,
    /// by |f| / |f'|, where they already were. The mesh stays closed, manifold and oriented,
    /// without additional intersections.
    ///
    /// # Errors
    /// An accuracy that is not above zero.
    pub fn simplified(&self, accuracy: f64) -> Result<Self, FieldError> {
        let accuracy = crate::error::positive("accuracy", accuracy)?;
        let positions = self.mesh.positions();
        let mut locked = vec![false; positions.len()];
        let before = crossing_faces(&self.mesh, None).len();
        let normals = normals(positions, &self.surfaces, &self.leaves);
        for _ in 0..TRIES {
            let (simple, kept) = self.collapsed(accuracy, &locked, &normals)?;
            let crossings = crossing_faces(&simple.mesh, None);
            if crossings.len() <= before {
                return Ok(simple);
            }
            // Vertices merged into these corners, and their neighbours, are locked in the next
            // attempt.
            let mut near = vec![false; positions.len()];
            for face in crossings.into_iter().flatten() {
                simple.mesh.faces()[face]
                    .iter()
                    .for_each(|&v| near[kept[v as usize] as usize] = true);
            }
            let reach = 4.0 * self.step;
            let marks: Vec<Vec3> =
                positions.iter().zip(&near).filter(|(_, n)| **n).map(|(p, _)| *p).collect();
            for (p, lock) in positions.iter().zip(&mut locked) {
                *lock |= marks.iter().any(|m| m.distance(*p) <= reach);
            }
        }
        Ok(self.clone())
    }

    /// The facets after all collapses, and the old number of each vertex.
    fn collapsed(
        &self,
        accuracy: f64,
        locked: &[bool],
        normals: &[Normals],
    ) -> Result<(Self, Vec<u32>), FieldError> {
        let positions = self.mesh.positions();
        let mut triangles = Vec::new();
        let mut leaves = Vec::new();
        for (patch, &leaf) in self.mesh.patches().iter().zip(&self.patch_leaves) {
            for face in &self.mesh.faces()[patch.faces.clone()] {
                triangles.push([face[0], face[1], face[2]]);
                leaves.push(leaf as u32);
            }
        }
        let mut stars: Vec<Star> = vec![Star::new(); positions.len()];
        for (t, corners) in triangles.iter().enumerate() {
            corners.iter().for_each(|&v| stars[v as usize].push(t as u32));
        }
        let mut work = Simplifier {
            positions,
            surfaces: &self.surfaces,
            tapes: self.leaves.iter().map(|l| l.primitive.tape()).collect(),
            alive: vec![true; triangles.len()],
            triangles,
            leaves,
            stars,
            stamps: vec![0; positions.len()],
            locked,
            normals,
            solver: vertex::Solver::default(),
            accuracy,
        };
        work.run();

        let mut kept = Vec::new();
        let mut number = vec![u32::MAX; positions.len()];
        for v in (0..positions.len()).filter(|&v| !work.stars[v].is_empty()) {
            number[v] = kept.len() as u32;
            kept.push(v as u32);
        }
        let count = work.triangles.len() as f64;
        let broken = |_| FieldError::TooFine { boxes: count, limit: count };
        let mut builder = TopologyBuilder::new();
        builder.add_vertices(kept.len()).map_err(broken)?;
        let mut patch_leaves = Vec::new();
        for (patch, &leaf) in self.mesh.patches().iter().zip(&self.patch_leaves) {
            let faces: Vec<[u32; 4]> = patch
                .faces
                .clone()
                .filter(|&t| work.alive[t])
                .map(|t| {
                    let [a, b, c] = work.triangles[t].map(|v| number[v as usize]);
                    [a, b, c, c]
                })
                .collect();
            if !faces.is_empty() {
                builder.add_faces(patch.info.clone(), faces).map_err(broken)?;
                patch_leaves.push(leaf);
            }
        }
        let moved = kept.iter().map(|&v| positions[v as usize]).collect();
        let mesh = Mesh::new(builder.build().into(), moved).map_err(broken)?;
        let surfaces = kept.iter().map(|&v| self.surfaces[v as usize].clone()).collect();
        Ok((Self { mesh, surfaces, patch_leaves, ..self.clone() }, kept))
    }
}
