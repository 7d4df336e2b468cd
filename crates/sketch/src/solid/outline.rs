//! Bodies as plane facets, for arrangements and meshes.
//!
//! A round edge has a chord for each 5°. If these do not determine the intersection of surfaces,
//! chords near the point are divided into three repeatedly; facets between them and the opposite
//! edges are finer only there.

use super::combine::LoopsAndTags;
use super::surface::FaceSurface;
use super::tangent_ruling::{ChordEnd, TangentRuling};
use super::{FacetPart, SketchSolid, SolidFace};
use crate::solid::arrangement::INNER;
use moldloft_num::{Real, Vec3};
use std::collections::{BTreeSet, HashMap};

/// The points of a body's facets, with those along each edge and the strips of each round face.
pub(super) struct Outline<T> {
    pub points: Vec<Vec3<T>>,
    chains: Vec<Vec<u32>>,
    strips: Vec<Vec<LoopsAndTags>>,
}

/// Density of facets: number of subdivisions of all chords, and of those near given points.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct FacetDensity {
    pub everywhere: u32,
    pub near: Vec<(Vec3, u32)>,
    /// Rulings of cylinders at which chords end.
    pub rulings: Vec<TangentRuling>,
}

impl FacetDensity {
    /// The density that two need.
    pub fn with(&self, other: &FacetDensity) -> FacetDensity {
        let mut all = self.clone();
        all.everywhere = all.everywhere.max(other.everywhere);
        all.near.extend(other.near.iter().filter(|p| !self.near.contains(p)));
        let new = other.rulings.iter().filter(|r| !self.rulings.contains(r));
        all.rulings.extend(new.cloned());
        all
    }

    /// Its image by a similarity.
    pub fn mapped(&self, map: &dyn Fn(Vec3) -> Vec3) -> FacetDensity {
        FacetDensity {
            everywhere: self.everywhere,
            near: self.near.iter().map(|(p, n)| (map(*p), *n)).collect(),
            rulings: self.rulings.iter().map(|r| r.mapped(map)).collect(),
        }
    }
}

/// Ends of an edge's chords, in equal parts of it.
struct EdgeDivision {
    parts: u64,
    /// In order.
    at: Vec<u64>,
    /// Their parameters on the edge, with those at rulings, if there are any.
    ruled: Option<Vec<f64>>,
}

impl EdgeDivision {
    fn even(chords: usize, times: u32) -> EdgeDivision {
        let each = 3u64.pow(times);
        let at = (0..=chords as u64).map(|k| k * each).collect();
        EdgeDivision { parts: chords as u64 * each, at, ruled: None }
    }

    /// The parameters, as the edge is run.
    fn shares(&self, forward: bool) -> Vec<f64> {
        let share = |k: u64| k as f64 / self.parts as f64;
        if let Some(ruled) = &self.ruled {
            return match forward {
                true => ruled.clone(),
                false => ruled.iter().rev().map(|s| 1.0 - s).collect(),
            };
        }
        match forward {
            true => self.at.iter().map(|k| share(*k)).collect(),
            false => self.at.iter().rev().map(|k| share(self.parts - *k)).collect(),
        }
    }
}

impl<T: Real> SketchSolid<T> {
    /// Ends of each edge's chords.
    fn divisions(&self) -> Vec<EdgeDivision> {
        let FacetDensity { everywhere, near, rulings } = &self.density;
        let most = near.iter().map(|p| p.1).max().unwrap_or(0);
        let chords = self.angular_chords(*everywhere);
        let mut all: Vec<EdgeDivision> =
            chords.iter().map(|&n| EdgeDivision::even(n, most)).collect();
        for time in 1..=most {
            let wanted: Vec<Vec3> = near.iter().filter(|p| p.1 >= time).map(|p| p.0).collect();
            // Chords of this length, in parts, are cut.
            let long = 3u64.pow(most + 1 - time);
            let mut cut: Vec<BTreeSet<u64>> = vec![BTreeSet::new(); all.len()];
            for f in 0..self.faces.len() {
                self.mark_face(f, &all, &wanted, &mut cut);
            }
            for (e, division) in all.iter().enumerate().filter(|d| self.edges[d.0].piece.is_some())
            {
                let piece = self.piece((e, true));
                let at = |k: u64| piece.at(T::from(k as f64 / division.parts as f64)).re();
                for w in division.at.windows(2) {
                    let [p, q] = [at(w[0]), at(w[1])];
                    if wanted.iter().any(|x| near_segment(*x, [p, q]) <= p.distance(q)) {
                        cut[e].insert(w[0]);
                    }
                }
            }
            self.share_cuts(&all, &mut cut);
            for (division, cut) in all.iter_mut().zip(&cut) {
                let chords = division.at.windows(2);
                let thirds = chords.filter(|w| cut.contains(&w[0]) && w[1] - w[0] == long);
                let new: Vec<u64> =
                    thirds.flat_map(|w| [w[0] + long / 3, w[0] + 2 * (long / 3)]).collect();
                if !new.is_empty() {
                    division.at.extend(new);
                    division.at.sort_unstable();
                }
            }
        }
        if !rulings.is_empty() {
            for (division, ends) in all.iter_mut().zip(self.ends_at(rulings)) {
                // Shorter chords first, so that all ends stay.
                let (fine, plain): (Vec<_>, Vec<_>) = ends.into_iter().partition(ChordEnd::divides);
                for end in fine.iter().chain(&plain) {
                    division.ruled = Some(end.among(&division.shares(true)));
                }
            }
        }
        all
    }

    /// The ends of chords of each edge at rulings; edges of round faces that are divided alike have the same.
    fn ends_at(&self, rulings: &[TangentRuling]) -> Vec<Vec<ChordEnd>> {
        let own = |e: usize| -> Vec<ChordEnd> {
            let piece = self.edges[e].piece.map(|_| self.piece((e, true)));
            piece.iter().flat_map(|p| rulings.iter().filter_map(|r| r.end_on(p))).collect()
        };
        let mut all: Vec<Vec<ChordEnd>> = (0..self.edges.len()).map(own).collect();
        let mut changed = true;
        while changed {
            changed = false;
            for (f, face) in self.faces.iter().enumerate() {
                if self.surface(f).is_none() {
                    continue;
                }
                for [a, b] in opposite(&face.loops[0]) {
                    // They have opposite directions.
                    let turned = a.1 == b.1;
                    for (a, b) in [(a.0, b.0), (b.0, a.0)] {
                        for end in all[a].clone() {
                            let end = if turned { end.turned() } else { end };
                            if !all[b].iter().any(|known| known.same(&end)) {
                                all[b].push(end);
                                changed = true;
                            }
                        }
                    }
                }
            }
        }
        for ends in &mut all {
            ends.sort_by(|a, b| a.order(b));
        }
        all
    }

    /// Marks the chords beside the facets of a round face that are near given points.
    fn mark_face(
        &self,
        f: usize,
        all: &[EdgeDivision],
        wanted: &[Vec3],
        cut: &mut [BTreeSet<u64>],
    ) {
        let Some(surface) = self.surface(f) else { return };
        let cycle = &self.faces[f].loops[0];
        let (far, left) = match cycle[..] {
            [_, _, far, left] => (Some(far), left),
            [_, _, left] => (None, left),
            _ => return,
        };
        let end = |h: (usize, bool), first: bool| {
            self.vertices[self.edges[h.0].ends[usize::from(h.1 != first)]].at.re()
        };
        let near = cycle[0];
        let corners = [end(near, true), end(near, false), end(left, true)];
        let grid = PatchOrientation::of(&surface, corners);
        let (along, across) = (all[near.0].shares(near.1), all[left.0].shares(!left.1));
        let at = |s: f64, t: f64| {
            let [u, v] = grid.at(s, t);
            surface.jet(T::from(u), T::from(v))[0].re()
        };
        let rows: Vec<Vec<Vec3>> =
            across.iter().map(|&t| along.iter().map(|&s| at(s, t)).collect()).collect();
        let mut mark = |h: (usize, bool), k: usize| {
            let ends = &all[h.0].at;
            // The chord that is the k-th as the edge is run.
            let k = if h.1 { k } else { ends.len() - 2 - k };
            cut[h.0].extend(ends.get(k));
        };
        for (j, w) in rows.windows(2).enumerate() {
            for i in 0..along.len() - 1 {
                let [a, b, c, d] = [w[0][i], w[0][i + 1], w[1][i + 1], w[1][i]];
                let middle = [(a + b) * 0.5, (c + d) * 0.5];
                let wide = a.distance(b).max(c.distance(d));
                if wanted.iter().all(|x| near_segment(*x, middle) > 1.5 * wide) {
                    continue;
                }
                // Facets that are curved in both directions are divided in both.
                if self.edges[near.0].piece.is_some() {
                    mark(near, i);
                    if let Some((e, forward)) = far {
                        mark((e, !forward), i);
                    }
                }
                let tall = a.distance(d).max(b.distance(c));
                let beside = [(a + d) * 0.5, (b + c) * 0.5];
                if self.edges[left.0].piece.is_some()
                    && wanted.iter().any(|x| near_segment(*x, beside) <= 1.5 * tall)
                {
                    mark((left.0, !left.1), j);
                    mark(cycle[1], j);
                }
            }
        }
    }

    /// Edges of round faces that are divided alike are cut alike.
    fn share_cuts(&self, all: &[EdgeDivision], cut: &mut [BTreeSet<u64>]) {
        // Ends of chords carried over to the other edge, which may have the opposite direction.
        let carried = |from: &BTreeSet<u64>, division: &EdgeDivision, turned: bool| -> Vec<u64> {
            let next = |k: &u64| division.at.get(division.at.partition_point(|x| x <= k)).copied();
            let of = |k: &u64| match turned {
                true => Some(division.parts - next(k)?),
                false => Some(*k),
            };
            from.iter().filter_map(of).collect()
        };
        let mut changed = true;
        while changed {
            changed = false;
            for (f, face) in self.faces.iter().enumerate() {
                if self.surface(f).is_none() {
                    continue;
                }
                for [a, b] in opposite(&face.loops[0]) {
                    // They have opposite directions.
                    let turned = a.1 == b.1;
                    for (a, b) in [(a.0, b.0), (b.0, a.0)] {
                        let new = carried(&cut[a], &all[a], turned);
                        let before = cut[b].len();
                        cut[b].extend(new);
                        changed |= cut[b].len() != before;
                    }
                }
            }
        }
    }

    /// The facets of the body for combinations, the points where they meet, and the normals of those of round faces.
    /// Facets of a combined body are parts of those that it was made of.
    pub(super) fn flat_outline(&self) -> (Outline<T>, Vec<Vec3>, Vec<Vec<Vec3>>) {
        let mut outline = self.outline();
        match &self.facets {
            Some(facets) if !facets.flat.is_empty() => {
                let side = sides_of(&facets.chains);
                let tag = |a: u32, b: u32| *side.get(&(a.min(b), a.max(b))).unwrap_or(&INNER);
                let tags = |c: &Vec<u32>| {
                    (0..c.len()).map(|k| tag(c[k], c[(k + 1) % c.len()])).collect::<Vec<u32>>()
                };
                let of = |part: &FacetPart| {
                    (part.loops.clone(), part.loops.iter().map(tags).collect::<Vec<_>>())
                };
                let all = facets.parts.iter();
                outline.strips = all.clone().map(|own| own.iter().map(of).collect()).collect();
                let normals = all.map(|own| own.iter().map(|part| part.normal).collect());
                (outline, facets.flat.clone(), normals.collect())
            }
            _ => {
                let points = outline.points.iter().map(|p| p.re()).collect();
                let newell = |ring: &Vec<u32>| {
                    let ring: Vec<Vec3> =
                        ring.iter().map(|v| outline.points[*v as usize].re()).collect();
                    super::facet_source::newell(&ring).normalized().unwrap_or_default()
                };
                let normals = outline.strips.iter();
                let normals = normals.map(|own| own.iter().map(|(l, _)| newell(&l[0])).collect());
                let normals = normals.collect();
                (outline, points, normals)
            }
        }
    }

    /// The facets of the body, with a chord for each 5° of round edges or, by the body's density, a part of it.
    pub(super) fn outline(&self) -> Outline<T> {
        if let Some(facets) = &self.facets {
            let side = sides_of(&facets.chains);
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
        let divisions = self.divisions();
        let mut points: Vec<Vec3<T>> = self.vertices.iter().map(|v| v.at).collect();
        let mut chains: Vec<Vec<u32>> = Vec::new();
        for (e, division) in divisions.iter().enumerate() {
            let [a, b] = self.edges[e].ends.map(|v| v as u32);
            let shares = division.shares(true);
            if shares.len() == 2 {
                chains.push(vec![a, b]);
                continue;
            }
            let piece = self.piece((e, true));
            let mut chain = vec![a];
            for &share in &shares[1..shares.len() - 1] {
                chain.push(points.len() as u32);
                points.push(piece.at(T::from(share)));
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
            let shares = |(e, forward): (usize, bool)| divisions[e].shares(forward);
            let quads = patch(&surface, &face.loops[0], &run, &shares, &mut points);
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
    pub fn strips(&self, face: usize) -> &[LoopsAndTags] {
        &self.strips[face]
    }

    /// The points along an edge as it is run.
    pub fn way(&self, h: (usize, bool)) -> Vec<u32> {
        directed(&self.chains, h)
    }

    /// The loops of a plane face with the edge of each side.
    pub fn loops(&self, body: &SketchSolid<T>, face: usize) -> LoopsAndTags {
        let SolidFace { loops, .. } = &body.faces[face];
        let mut points = Vec::with_capacity(loops.len());
        let mut tags = Vec::with_capacity(loops.len());
        for cycle in loops {
            let mut own = Vec::with_capacity(cycle.len());
            let mut sides = Vec::with_capacity(cycle.len());
            for &(e, forward) in cycle {
                let chain = &self.chains[e];
                if chain.is_empty() {
                    continue;
                }
                // Without the last point, where the next edge begins.
                if forward {
                    own.extend(&chain[..chain.len() - 1]);
                } else {
                    own.extend(chain[1..].iter().rev());
                }
                sides.extend(std::iter::repeat_n(e as u32, chain.len() - 1));
            }
            points.push(own);
            tags.push(sides);
        }
        (points, tags)
    }
}

/// The edges of a patch that are divided alike: opposite ones, or those that end in a point.
fn opposite(cycle: &[(usize, bool)]) -> Vec<[(usize, bool); 2]> {
    match *cycle {
        [a, b, c, d] => vec![[a, c], [b, d]],
        [_, b, c] => vec![[b, c]],
        _ => Vec::new(),
    }
}

/// The edge of each side.
fn sides_of(chains: &[Vec<u32>]) -> HashMap<(u32, u32), u32> {
    let mut side: HashMap<(u32, u32), u32> = HashMap::new();
    for (e, chain) in chains.iter().enumerate() {
        for w in chain.windows(2) {
            side.insert((w[0].min(w[1]), w[0].max(w[1])), e as u32);
        }
    }
    side
}

/// Distance of a point from a segment.
fn near_segment(x: Vec3, [p, q]: [Vec3; 2]) -> f64 {
    let d = q - p;
    let s = (d.dot(x - p) / d.norm_sq().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    (p + d * s).distance(x)
}

fn directed(chains: &[Vec<u32>], (e, forward): (usize, bool)) -> Vec<u32> {
    let mut way = chains[e].clone();
    if !forward {
        way.reverse();
    }
    way
}

/// The facets of a patch bounded by its parameter lines: quads between the first edge of its cycle and
/// the third, or triangles to the point that a cycle of three edges ends in. `run` gives the points along an edge,
/// `shares` their parameters.
pub(super) fn patch<T: Real>(
    surface: &FaceSurface<T>,
    cycle: &[(usize, bool)],
    run: &dyn Fn((usize, bool)) -> Vec<u32>,
    shares: &dyn Fn((usize, bool)) -> Vec<f64>,
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
    // Directions of the parameters along the first edge and the sides.
    let corner = |v: u32| places[v as usize].re();
    let corners = [corner(near[0]), corner(near[n - 1]), corner(left[m - 1])];
    let grid = PatchOrientation::of(surface, corners);
    let last = cycle[cycle.len() - 1];
    let (along, across) = (shares(cycle[0]), shares((last.0, !last.1)));
    let mut rows = vec![near.clone()];
    for j in 1..m - 1 {
        let mut row = vec![left[j]];
        for i in 1..n - 1 {
            let [u, v] = grid.at(along[i], across[j]);
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

/// Directions of the first edge (s) and the sides (t) of a patch in its parameters.
struct PatchOrientation {
    corner: [f64; 2],
    along: [f64; 2],
    across: [f64; 2],
}

impl PatchOrientation {
    /// By the corners where the first edge begins and ends, and where the sides end.
    fn of<T: Real>(surface: &FaceSurface<T>, [a, b, d]: [Vec3; 3]) -> PatchOrientation {
        let corner = |u: f64, v: f64| surface.jet(T::from(u), T::from(v))[0].re();
        // The corners of the square that the patch's own corners are nearest to.
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
