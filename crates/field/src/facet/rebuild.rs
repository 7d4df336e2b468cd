//! Reconstruction of regions with cut edges: the edges of the body are followed through them, and
//! the faces between are filled with triangles.
//!
//! Cells represent an edge by crossings beside it. If two edges leave a corner at a small angle, or
//! faces meet at one, some cells show only one of two edges, at any size of cells. The triangles
//! around such cells are removed, as far as the adjacent ones are right. The surfaces along the rim
//! of the hole determine where edges enter; each is traced to its exit or to a corner with further
//! edges ([`super::trace`]). Rim and edges divide the hole into faces, each on one surface, which
//! are triangulated in a plane. The new triangles are accepted if they close the hole, face their
//! surfaces and intersect no others.

use super::assemble::{Assembled, NO_VERTEX};
use super::crossing::crossings;
use super::grid::Grid;
use super::refine::Tapes;
use super::trace::{Tracer, from_side};
use super::vertex::Surfaces;
use crate::set::Leaf;
use moldloft_budget::{Budget, Spent};
use moldloft_mesh::planar_triangles;
use moldloft_num::{Box3, Vec3};
use rustc_hash::{FxHashMap, FxHashSet};

/// Distance in cells below which cells are rebuilt together.
const NEAR: usize = 2;
/// Rings of cells removed around them, and distance of points of an edge there, in cells.
const TRIES: [(usize, f64); 5] = [(1, 0.4), (2, 0.4), (1, 0.1), (3, 0.2), (5, 0.1)];
/// More cells and regions are left as they are, and regions of more triangles: the cells are too coarse for the body.
const MOST_CELLS: usize = 600;
const MOST_REGIONS: usize = 100;
const MOST_TRIANGLES: usize = 6000;
/// Maximum number of times a region grows until its rim is right.
const GROWTHS: usize = 40;
/// Inner vertices are this part of a cell away from edges.
const INNER: f64 = 0.25;
/// The least cosine between a new triangle and its surface's normal at a corner.
const FACING: f64 = 0.05;
/// Triangles no higher than this part of their longest side have no area.
const FLAT: f64 = 1e-8;

type Corners = [u32; 3];

/// A directed side of a face, with the face on its left.
#[derive(Clone, Copy)]
struct FaceSide {
    from: u32,
    to: u32,
    leaf: u32,
}

struct Rebuilder<'a> {
    made: &'a mut Assembled,
    grid: &'a Grid,
    leaves: &'a [Leaf],
    tapes: &'a Tapes<'a>,
    /// The triangle on the left of each directed side.
    left: FxHashMap<(u32, u32), u32>,
    /// The triangles of each vertex.
    round: Vec<Vec<u32>>,
}

/// Rebuilds the regions about some cells; returns the cells in which that was done.
///
/// # Errors
/// [`Spent`].
pub(super) fn rebuild(
    made: &mut Assembled,
    grid: &Grid,
    leaves: &[Leaf],
    tapes: &Tapes,
    cells: &[[usize; 3]],
    budget: &Budget,
) -> Result<Vec<[usize; 3]>, Spent> {
    let mut done = Vec::new();
    let groups = if cells.len() > MOST_CELLS { Vec::new() } else { groups(cells) };
    if groups.is_empty() || groups.len() > MOST_REGIONS {
        return Ok(done);
    }
    let (left, round) = (FxHashMap::default(), Vec::new());
    let mut work = Rebuilder { made, grid, leaves, tapes, left, round };
    work.index();
    for group in groups {
        for (reach, step) in TRIES {
            budget.poll()?;
            if work.group(&group, reach, step).is_some() {
                done.extend(group);
                break;
            }
        }
    }
    if !done.is_empty() {
        work.made.compact();
    }
    done.sort_unstable();
    Ok(done)
}

/// Cells that are near each other.
fn groups(cells: &[[usize; 3]]) -> Vec<Vec<[usize; 3]>> {
    let near = |a: &[usize; 3], b: &[usize; 3]| (0..3).all(|k| a[k].abs_diff(b[k]) <= NEAR);
    let mut groups: Vec<Vec<[usize; 3]>> = Vec::new();
    for cell in cells {
        let mut own = vec![*cell];
        groups.retain_mut(|g| {
            let joined = g.iter().any(|c| near(c, cell));
            if joined {
                own.append(g);
            }
            !joined
        });
        groups.push(own);
    }
    groups
}

impl Rebuilder<'_> {
    fn index(&mut self) {
        self.round.resize(self.made.positions.len(), Vec::new());
        for t in 0..self.made.triangles.len() as u32 {
            self.file(t);
        }
    }

    fn file(&mut self, t: u32) {
        let c = self.made.triangles[t as usize].1;
        for k in 0..3 {
            self.left.insert((c[k], c[(k + 1) % 3]), t);
            self.round[c[k] as usize].push(t);
        }
    }

    /// Takes a triangle with those corners out of the index.
    fn unfile(&mut self, t: u32, c: Corners) {
        for k in 0..3 {
            let side = (c[k], c[(k + 1) % 3]);
            if self.left.get(&side) == Some(&t) {
                self.left.remove(&side);
            }
            self.round[c[k] as usize].retain(|x| *x != t);
        }
    }

    fn at(&self, v: u32) -> Vec3 {
        self.made.positions[v as usize]
    }

    /// Rebuilds the region about a group of cells.
    fn group(&mut self, group: &[[usize; 3]], reach: usize, step: f64) -> Option<()> {
        let mut region = self.about(group, reach);
        let mut tracer = Tracer::new(
            self.leaves,
            self.tapes,
            [self.grid.goal, self.grid.step, step * self.grid.step],
            Box3::EMPTY,
        );
        let rim = self.rim(&mut region, &mut tracer)?;
        let corners = |t: &u32| self.made.triangles[*t as usize].1;
        let all = region.iter().flat_map(corners).map(|v| self.at(v));
        let margin = Vec3::of(1.0, 1.0, 1.0) * self.grid.step;
        let b = Box3::around(all);
        tracer.within = Box3 { low: b.low - margin, high: b.high + margin };
        // Entries of edges.
        let enters: FxHashMap<u32, u32> = rim.iter().map(|s| (s.to, s.leaf)).collect();
        let mut number: Vec<u32> = Vec::new();
        for side in rim.iter().filter(|s| enters[&s.from] != s.leaf) {
            tracer.end(self.at(side.from), enters[&side.from], side.leaf)?;
            number.push(side.from);
        }
        if !tracer.follow() {
            return None;
        }
        // Edges that do not reach the rim.
        let mut inner: Vec<u32> = region.iter().flat_map(corners).collect();
        inner.sort_unstable();
        inner.dedup();
        inner.retain(|v| !enters.contains_key(v));
        for &v in &inner {
            let on = &self.made.surfaces[v as usize];
            if let [a, b] = on[..]
                && tracer.on(self.at(v), &[a, b])
            {
                tracer.amid(self.at(v), [a, b]);
                if !tracer.follow() {
                    return None;
                }
            }
        }
        let (vertices, triangles) = (self.made.positions.len(), self.made.triangles.len());
        let old: Vec<(u32, Corners)> =
            region.iter().map(|t| self.made.triangles[*t as usize]).collect();
        let made = self.fill(rim, &mut tracer, number, &inner);
        let taken = made.is_some_and(|new| self.take(&region, &old, new, vertices, &mut tracer));
        if !taken {
            self.made.positions.truncate(vertices);
            self.made.surfaces.truncate(vertices);
            self.made.triangles.truncate(triangles);
            for (t, old) in region.iter().zip(old) {
                self.made.triangles[*t as usize] = old;
            }
            return None;
        }
        Some(())
    }

    /// The triangles about a group of cells.
    fn about(&self, group: &[[usize; 3]], reach: usize) -> Vec<u32> {
        let cell = |p: Vec3| self.grid.cell_of(p);
        let near =
            |c: [usize; 3]| group.iter().any(|g| (0..3).all(|k| g[k].abs_diff(c[k]) <= reach));
        let (mut low, mut high) = ([usize::MAX; 3], [0; 3]);
        for g in group {
            for k in 0..3 {
                low[k] = low[k].min(g[k].saturating_sub(reach));
                high[k] = high[k].max(g[k] + reach);
            }
        }
        let bounds = self.grid.between(low, high);
        let within = |p: Vec3| {
            (0..3).all(|k| bounds.low[k] <= p[k] && p[k] <= bounds.high[k]) && near(cell(p))
        };
        let of_vertex: Vec<bool> = self.made.positions.iter().map(|p| within(*p)).collect();
        let bad: FxHashSet<u32> = self
            .made
            .blunt
            .iter()
            .filter(|b| b.0 != NO_VERTEX && group.contains(&b.1))
            .map(|b| b.0)
            .collect();
        (0..self.made.triangles.len() as u32)
            .filter(|&t| {
                let c = self.made.triangles[t as usize].1;
                let middle = (self.at(c[0]) + self.at(c[1]) + self.at(c[2])) / 3.0;
                c.iter().any(|v| of_vertex[*v as usize] || bad.contains(v)) || within(middle)
            })
            .collect()
    }

    /// The sides around a region, which grows until the surfaces along them are consistent.
    fn rim(&self, region: &mut Vec<u32>, tracer: &mut Tracer) -> Option<Vec<FaceSide>> {
        let mut inside: FxHashSet<u32> = region.iter().copied().collect();
        for _ in 0..GROWTHS {
            if inside.len() > MOST_TRIANGLES {
                return None;
            }
            let mut rim: Vec<FaceSide> = Vec::new();
            let mut more: FxHashSet<u32> = FxHashSet::default();
            region.clear();
            region.extend(&inside);
            region.sort_unstable();
            for &t in region.iter() {
                let (leaf, c) = self.made.triangles[t as usize];
                for k in 0..3 {
                    let (from, to) = (c[k], c[(k + 1) % 3]);
                    let beyond = *self.left.get(&(to, from))?;
                    if inside.contains(&beyond) {
                        continue;
                    }
                    rim.push(FaceSide { from, to, leaf });
                    if self.made.triangles[beyond as usize].0 != leaf {
                        more.insert(beyond);
                    }
                }
            }
            let mut entering: FxHashMap<u32, u32> = FxHashMap::default();
            let mut doubled: FxHashSet<u32> = FxHashSet::default();
            for side in &rim {
                if entering.insert(side.to, side.leaf).is_some() {
                    doubled.insert(side.to);
                }
            }
            for side in &rim {
                let v = side.from;
                let before = *entering.get(&v)?;
                let mut shown = Surfaces::from_slice(&[before.min(side.leaf)]);
                if before != side.leaf {
                    shown.push(before.max(side.leaf));
                }
                let on = &self.made.surfaces[v as usize];
                let right = *on == shown && tracer.on(self.at(v), &shown) && !doubled.contains(&v);
                if !right {
                    more.extend(&self.round[v as usize]);
                }
            }
            more.retain(|t| !inside.contains(t));
            if more.is_empty() {
                return (!rim.is_empty()).then_some(rim);
            }
            inside.extend(more);
        }
        None
    }

    /// New triangles between the rim and the edges.
    fn fill(
        &mut self,
        rim: Vec<FaceSide>,
        tracer: &mut Tracer,
        mut number: Vec<u32>,
        inner: &[u32],
    ) -> Option<Vec<(u32, Corners)>> {
        let add = |made: &mut Assembled, point: Vec3, on: &[u32]| {
            let mut on = Surfaces::from_slice(on);
            on.sort_unstable();
            made.positions.push(point);
            made.surfaces.push(on);
            made.positions.len() as u32 - 1
        };
        for node in &tracer.nodes[number.len()..] {
            number.push(add(self.made, node.point, &node.surfaces));
        }
        let mut sides = rim;
        for edge in &tracer.edges {
            let mut last = number[edge.ends[0]];
            let mut to = |next: u32| {
                sides.push(FaceSide { from: last, to: next, leaf: edge.sides[0] });
                sides.push(FaceSide { from: next, to: last, leaf: edge.sides[1] });
                last = next;
            };
            for &point in &edge.points {
                to(add(self.made, point, &edge.sides));
            }
            to(number[edge.ends[1]]);
        }
        let loops = self.loops(&sides, tracer)?;
        let mut leaves: Vec<u32> = loops.iter().map(|l| l.0).collect();
        leaves.sort_unstable();
        leaves.dedup();
        let mut made = Vec::new();
        for leaf in leaves {
            let own: Vec<&Vec<u32>> = loops.iter().filter(|l| l.0 == leaf).map(|l| &l.1).collect();
            self.face(leaf, &own, inner, tracer, &mut made)?;
        }
        Some(made)
    }

    /// Closed loops of sides, each about faces of one surface.
    fn loops(&self, sides: &[FaceSide], tracer: &mut Tracer) -> Option<Vec<(u32, Vec<u32>)>> {
        let mut out: FxHashMap<(u32, u32), Vec<usize>> = FxHashMap::default();
        for (k, s) in sides.iter().enumerate() {
            out.entry((s.leaf, s.from)).or_default().push(k);
        }
        let mut used = vec![false; sides.len()];
        let mut loops = Vec::new();
        for start in 0..sides.len() {
            if used[start] {
                continue;
            }
            let leaf = sides[start].leaf;
            let mut ring = Vec::new();
            let mut at = start;
            loop {
                if std::mem::replace(&mut used[at], true) {
                    return None;
                }
                let FaceSide { from, to, .. } = sides[at];
                ring.push(from);
                let next = out.get(&(leaf, to))?;
                at = match next[..] {
                    [one] => one,
                    _ => {
                        // The first one clockwise from the reverse direction.
                        let p = self.at(to);
                        let n = tracer.normal(leaf, p)?;
                        let back = self.at(from) - p;
                        let turn = |k: &usize| {
                            let d = self.at(sides[*k].to) - p;
                            let a = libm::atan2(-back.cross(d).dot(n), back.dot(d));
                            if a <= 0.0 { a + std::f64::consts::TAU } else { a }
                        };
                        *next.iter().min_by(|a, b| turn(a).total_cmp(&turn(b)))?
                    }
                };
                if at == start {
                    break;
                }
            }
            if ring.len() < 3 {
                return None;
            }
            loops.push((leaf, ring));
        }
        Some(loops)
    }

    /// Triangles of the faces of one surface.
    fn face(
        &self,
        leaf: u32,
        loops: &[&Vec<u32>],
        inner: &[u32],
        tracer: &mut Tracer,
        made: &mut Vec<(u32, Corners)>,
    ) -> Option<()> {
        // Each face has one loop that turns to the left in its own plane; the others are holes.
        let mut mean = Vec::new();
        for ring in loops {
            let mut sum = Vec3::zero();
            for &v in ring.iter() {
                sum += tracer.normal(leaf, self.at(v))?;
            }
            mean.push(sum / sum.norm());
        }
        let area = |ring: &[u32], n: Vec3| {
            let p = self.at(ring[0]);
            let parts = (0..ring.len()).map(|k| {
                (self.at(ring[k]) - p).cross(self.at(ring[(k + 1) % ring.len()]) - p).dot(n)
            });
            parts.sum::<f64>()
        };
        let outer: Vec<usize> =
            (0..loops.len()).filter(|&k| area(loops[k], mean[k]) > 0.0).collect();
        if outer.is_empty() {
            return None;
        }
        let mut holes_left: Vec<usize> = (0..loops.len()).filter(|k| !outer.contains(k)).collect();
        // Small faces take their holes first.
        let mut order = outer;
        order.sort_by(|&a, &b| area(loops[a], mean[a]).total_cmp(&area(loops[b], mean[b])));
        for k in order {
            let n = mean[k];
            let u = n.perpendicular();
            let w = n.cross(u);
            let origin = self.at(loops[k][0]);
            let flat = |v: u32| {
                let d = self.at(v) - origin;
                [d.dot(u), d.dot(w)]
            };
            let mut vertices: Vec<u32> = loops[k].clone();
            let mut rings: Vec<Vec<usize>> = vec![(0..vertices.len()).collect()];
            let ring: Vec<[f64; 2]> = loops[k].iter().map(|&v| flat(v)).collect();
            holes_left.retain(|&h| {
                let mine = contains(&ring, flat(loops[h][0]));
                if mine {
                    rings.push((vertices.len()..vertices.len() + loops[h].len()).collect());
                    vertices.extend(loops[h].iter());
                }
                !mine
            });
            let count = vertices.len();
            let far = INNER * self.grid.step;
            let borders: Vec<(Vec3, Vec3)> = rings
                .iter()
                .flat_map(|r| (0..r.len()).map(|i| (r[i], r[(i + 1) % r.len()])))
                .map(|(i, j)| (self.at(vertices[i]), self.at(vertices[j])))
                .collect();
            for &v in inner.iter().filter(|&&v| self.made.surfaces[v as usize][..] == [leaf]) {
                let p = self.at(v);
                let shown = tracer.normal(leaf, p).is_some_and(|m| m.dot(n) > 0.3)
                    && contains(&ring, flat(v))
                    && tracer.on(p, &[leaf])
                    && borders.iter().all(|b| from_side(p, b.0, b.1) > far);
                if shown && tracer.value(p).abs() <= 1e-9 * self.grid.step {
                    vertices.push(v);
                }
            }
            let points: Vec<[f64; 2]> = vertices.iter().map(|&v| flat(v)).collect();
            let within: Vec<usize> = (count..vertices.len()).collect();
            let found = planar_triangles(&points, &rings, &within);
            self.covers(&found, &rings, &points)?;
            for t in found {
                made.push((leaf, t.map(|k| vertices[k])));
            }
        }
        holes_left.is_empty().then_some(())
    }

    /// True if the triangles contain all sides of the rings, each once, and meet along all others.
    fn covers(
        &self,
        found: &[[usize; 3]],
        rings: &[Vec<usize>],
        points: &[[f64; 2]],
    ) -> Option<()> {
        let mut sides: FxHashSet<(usize, usize)> = FxHashSet::default();
        for t in found {
            let [a, b, c] = t.map(|k| points[k]);
            if (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) <= 0.0 {
                return None;
            }
            for k in 0..3 {
                if !sides.insert((t[k], t[(k + 1) % 3])) {
                    return None;
                }
            }
        }
        let rim: FxHashSet<(usize, usize)> =
            rings.iter().flat_map(|r| (0..r.len()).map(|i| (r[i], r[(i + 1) % r.len()]))).collect();
        let all = rim.iter().all(|s| sides.contains(s));
        let closed = sides.iter().all(|&(a, b)| rim.contains(&(a, b)) != sides.contains(&(b, a)));
        (all && closed).then_some(())
    }

    /// Replaces a region by new triangles if they fit.
    fn take(
        &mut self,
        region: &[u32],
        old: &[(u32, Corners)],
        new: Vec<(u32, Corners)>,
        vertices: usize,
        tracer: &mut Tracer,
    ) -> bool {
        for (leaf, t) in &new {
            let [a, b, c] = t.map(|v| self.at(v));
            let across = (b - a).cross(c - a);
            let longest = (b - a).norm_sq().max((c - b).norm_sq()).max((a - c).norm_sq());
            if across.norm() <= FLAT * longest {
                return false;
            }
            for p in [a, b, c] {
                let facing = tracer.normal(*leaf, p).map(|n| n.dot(across) / across.norm());
                if facing.is_none_or(|f| f < FACING) {
                    return false;
                }
            }
        }
        // No side of the others may be theirs, too.
        let inside: FxHashSet<u32> = region.iter().copied().collect();
        let mut own: FxHashSet<(u32, u32)> = FxHashSet::default();
        for (_, t) in &new {
            for k in 0..3 {
                let side = (t[k], t[(k + 1) % 3]);
                let taken = self.left.get(&side).is_some_and(|t| !inside.contains(t));
                if taken || !own.insert(side) {
                    return false;
                }
            }
        }
        let mut slots = region.iter().map(|t| *t as usize);
        let mut places = Vec::new();
        for t in &new {
            match slots.next() {
                Some(slot) => {
                    self.made.triangles[slot] = *t;
                    places.push(slot);
                }
                None => {
                    places.push(self.made.triangles.len());
                    self.made.triangles.push(*t);
                }
            }
        }
        let rest: FxHashSet<usize> = slots.collect();
        let mut flagged = vec![false; self.made.triangles.len()];
        places.iter().for_each(|p| flagged[*p] = true);
        let triangles = &self.made.triangles;
        let corners = |f: usize| triangles[f].1;
        let cut = crossings(&self.made.positions, triangles.len(), corners, Some(&flagged));
        if cut.iter().any(|pair| pair.iter().all(|f| !rest.contains(f))) {
            return false;
        }
        for (t, (_, corners)) in region.iter().zip(old) {
            self.unfile(*t, *corners);
        }
        self.round.resize(self.made.positions.len(), Vec::new());
        places.into_iter().for_each(|p| self.file(p as u32));
        // The last triangles take the numbers that are free.
        let mut rest: Vec<usize> = rest.into_iter().collect();
        rest.sort_unstable();
        for free in rest.into_iter().rev() {
            let last = self.made.triangles.len() - 1;
            if free != last {
                self.unfile(last as u32, self.made.triangles[last].1);
            }
            self.made.triangles.swap_remove(free);
            if free != last {
                self.file(free as u32);
            }
        }
        let known: FxHashSet<u32> = self.made.doubtful.iter().map(|d| d.0).collect();
        let touched =
            new.iter().flat_map(|t| t.1).chain(vertices as u32..self.made.positions.len() as u32);
        let mut more: Vec<u32> = touched.filter(|v| !known.contains(v)).collect();
        more.sort_unstable();
        more.dedup();
        for v in more {
            let cell = self.grid.cell_of(self.at(v));
            self.made.doubtful.push((v, cell));
        }
        self.made.doubtful.sort_unstable();
        true
    }
}

/// True if a point is inside a ring.
fn contains(ring: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let mut inside = false;
    for k in 0..ring.len() {
        let (a, b) = (ring[k], ring[(k + 1) % ring.len()]);
        if (a[1] > y) != (b[1] > y) && x < a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]) {
            inside = !inside;
        }
    }
    inside
}
