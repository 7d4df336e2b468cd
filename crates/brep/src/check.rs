//! Shells: connected faces, their closure, and faults.

use crate::{Brep, BrepFace, Coedge, Shell, SurfaceShape};
use moldloft_num::Vec3;

/// Counts and flags of a shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShellFacts {
    /// Vertices, edges, faces, loops.
    pub counts: [usize; 4],
    /// Edges with one side.
    pub open: usize,
    /// Edges with more than two sides.
    pub crowded: usize,
}

impl ShellFacts {
    /// V - E + F - (loops - F): 2 for a sphere, 0 for a torus.
    pub fn euler(&self) -> isize {
        let [v, e, f, l] = self.counts.map(|n| n as isize);
        v - e + f - (l - f)
    }
}

/// Fault of a boundary representation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The sides of a loop do not follow one another; fields: face, loop.
    Broken(usize, usize),
    /// Two sides of an edge have the same direction; field: edge.
    Senses(usize),
}

impl Brep {
    /// Groups the faces into shells: those that share an edge with two sides of opposite senses.
    pub fn shells(&self) -> Vec<Shell> {
        let mut sides: Vec<Vec<(usize, bool)>> = vec![Vec::new(); self.edges.len()];
        for (f, face) in self.faces.iter().enumerate() {
            for side in face.loops.iter().flatten() {
                sides[side.edge].push((f, side.forward));
            }
        }
        let mut first: Vec<usize> = (0..self.faces.len()).collect();
        fn root(first: &mut [usize], mut k: usize) -> usize {
            while first[k] != k {
                first[k] = first[first[k]];
                k = first[k];
            }
            k
        }
        for users in &sides {
            if let [(a, forward), (b, other)] = users[..]
                && forward != other
            {
                let (a, b) = (root(&mut first, a), root(&mut first, b));
                first[a.max(b)] = a.min(b);
            }
        }
        let mut shells: Vec<(usize, Shell)> = Vec::new();
        for f in 0..self.faces.len() {
            let own = root(&mut first, f);
            match shells.iter_mut().find(|(k, _)| *k == own) {
                Some((_, shell)) => shell.faces.push(f),
                None => shells.push((own, Shell { faces: vec![f], closed: true, cavity: false })),
            }
        }
        let mut owner = vec![usize::MAX; self.faces.len()];
        for (k, (_, shell)) in shells.iter().enumerate() {
            shell.faces.iter().for_each(|&f| owner[f] = k);
        }
        for users in &sides {
            let paired = matches!(users[..], [(_, a), (_, b)] if a != b);
            if !paired {
                for (f, _) in users {
                    shells[owner[*f]].1.closed = false;
                }
            }
        }
        shells.into_iter().map(|(_, shell)| shell).collect()
    }

    /// The volume that a closed shell of plane faces with straight edges encloses, negative if its
    /// faces are oriented inward, as around a cavity; `None` for other shells.
    pub fn volume_of_polyhedron(&self, shell: &Shell) -> Option<f64> {
        if !shell.closed {
            return None;
        }
        let faces = || shell.faces.iter().map(|&f| &self.faces[f]);
        let sides = || faces().flat_map(|face| face.loops.iter().flatten());
        let plane = faces().all(|face| matches!(face.surface, SurfaceShape::Plane { .. }));
        if !plane || sides().any(|side| self.edges[side.edge].curve.points.len() != 2) {
            return None;
        }
        let origin = self.vertices[self.edges[sides().next()?.edge].ends[0]];
        let mut sum = 0.0;
        for cycle in faces().flat_map(|face| &face.loops) {
            let start = |side: &Coedge| {
                let ends = self.edges[side.edge].ends;
                self.vertices[ends[usize::from(!side.forward)]] - origin
            };
            let places: Vec<Vec3> = cycle.iter().map(start).collect();
            for k in 1..places.len().saturating_sub(1) {
                sum += places[0].dot(places[k].cross(places[k + 1]));
            }
        }
        Some(sum / 6.0)
    }

    /// Plane faces that are less than `width` across (area over half the border), by number, with a
    /// point of each. Fitted edges of such faces may cross each other.
    pub fn thin_faces(&self, width: f64) -> Vec<(usize, Vec3)> {
        let thin = |(f, face): (usize, &BrepFace)| {
            let SurfaceShape::Plane { normal, .. } = face.surface else { return None };
            let first = face.loops.first()?.first()?;
            let place = self.vertices[self.edges[first.edge].ends[0]];
            let (mut area, mut border) = (0.0, 0.0);
            for side in face.loops.iter().flatten() {
                let (twice, length) = self.swept(side.edge, place, normal);
                area += if side.forward { twice } else { -twice };
                border += length;
            }
            (0.5 * area.abs() <= 0.5 * border * width).then_some((f, place))
        };
        self.faces.iter().enumerate().filter_map(thin).collect()
    }

    /// Twice the area between a point and an edge, seen against the normal, and the edge's length.
    fn swept(&self, edge: usize, place: Vec3, normal: Vec3) -> (f64, f64) {
        const STEPS: usize = 16;
        let curve = &self.edges[edge].curve;
        let mut knots = curve.knots[0].clone();
        knots.dedup();
        let (mut sum, mut length) = (0.0, 0.0);
        for span in knots.windows(2) {
            let at = |k: usize| span[0] + (span[1] - span[0]) * k as f64 / STEPS as f64;
            let points: Vec<Vec3> = curve.grid(&[(0..=STEPS).map(at).collect()]);
            let by = |stride: usize| -> f64 {
                let ends =
                    (stride..=STEPS).step_by(stride).map(|k| [points[k - stride], points[k]]);
                ends.map(|[p, q]| (p - place).cross(q - place).dot(normal)).sum()
            };
            // Chords of half the length miss a quarter of the area.
            let (coarse, fine) = (by(2), by(1));
            sum += fine + (fine - coarse) / 3.0;
            length += points.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>();
        }
        (sum, length)
    }

    /// The counts of a shell.
    pub fn facts(&self, shell: &Shell) -> ShellFacts {
        let mut uses = vec![0usize; self.edges.len()];
        let mut used = vec![false; self.vertices.len()];
        let mut loops = 0;
        for &f in &shell.faces {
            loops += self.faces[f].loops.len();
            for side in self.faces[f].loops.iter().flatten() {
                uses[side.edge] += 1;
                self.edges[side.edge].ends.iter().for_each(|&v| used[v] = true);
            }
        }
        let edges = uses.iter().filter(|&&n| n > 0).count();
        ShellFacts {
            counts: [used.iter().filter(|&&u| u).count(), edges, shell.faces.len(), loops],
            open: uses.iter().filter(|&&n| n == 1).count(),
            crowded: uses.iter().filter(|&&n| n > 2).count(),
        }
    }

    /// Faults: loops with gaps, edges with sides of the same direction.
    pub fn faults(&self) -> Vec<Fault> {
        let mut faults = Vec::new();
        let mut sides: Vec<Vec<bool>> = vec![Vec::new(); self.edges.len()];
        for (f, face) in self.faces.iter().enumerate() {
            for (k, cycle) in face.loops.iter().enumerate() {
                let end = |i: usize, last: bool| {
                    let side = &cycle[i % cycle.len()];
                    self.edges[side.edge].ends[usize::from(side.forward == last)]
                };
                if (0..cycle.len()).any(|i| end(i, true) != end(i + 1, false)) {
                    faults.push(Fault::Broken(f, k));
                }
            }
            for side in face.loops.iter().flatten() {
                sides[side.edge].push(side.forward);
            }
        }
        for (e, users) in sides.iter().enumerate() {
            if users.len() == 2 && users[0] == users[1] {
                faults.push(Fault::Senses(e));
            }
        }
        faults
    }
}
