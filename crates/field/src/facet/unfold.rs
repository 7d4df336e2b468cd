//! Triangles that cut each other, joined otherwise: their vertices are where they should be, most often.
//!
//! A vertex on an edge that passes beside its cell is between those of other cells, and the
//! polygons around it fold. Flipped diagonals and vertices merged along an edge of the body unfold
//! them: the edge does not move. Remaining folds are left to the steps that move vertices.

use super::assemble::{Assembled, VertexKey, VertexNames};
use super::crossing::{TrianglePlane, bin_of, bins, common_low, cut, cut_in_planes, meet};
use super::grid::Grid;
use super::vertex::Solver;
use crate::set::Leaf;
use moldloft_num::{Box3, Vec3};
use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::SmallVec;

/// A triangle faces its surface when the cosine between them is at least this.
const FACING: f64 = 0.2;
/// The least height of a new triangle as a part of its longest side, unless those before it were thinner.
const THIN: f64 = 1e-3;
/// Maximum number of changes for a pair.
const STEPS: usize = 6;
/// Maximum number of passes over all pairs.
const ROUNDS: usize = 4;
/// Number of rings around intersections that are tested.
pub(super) const RINGS: usize = 3;
/// Number of rings around repeated changes that are tested.
const KNOWN_RINGS: usize = 1;

pub(super) type Corners = [u32; 3];

/// A change of some triangles.
pub(super) struct Change {
    /// New corners, with the surface, of triangles, …
    pub(super) made: SmallVec<[(usize, u32, Corners); 8]>,
    /// … and the removed ones.
    pub(super) gone: SmallVec<[usize; 2]>,
}

impl Change {
    fn own(&self) -> impl Iterator<Item = usize> + '_ {
        self.made.iter().map(|m| m.0).chain(self.gone.iter().copied())
    }
}

/// A triangle with the box about it.
struct PlacedTriangle {
    corners: Corners,
    points: [Vec3; 3],
    plane: TrianglePlane,
    around: Box3,
}

impl PlacedTriangle {
    fn cuts(&self, other: &PlacedTriangle) -> bool {
        meet(&self.around, &other.around)
            && cut_in_planes(
                [self.corners, other.corners],
                [self.points, other.points],
                [self.plane, other.plane],
            )
    }
}

pub(super) struct FoldedRegion<'a> {
    pub(super) made: &'a mut Assembled,
    pub(super) leaves: &'a [Leaf],
    pub(super) solver: Solver,
    normals: FxHashMap<(u32, u32), Vec3>,
    /// Triangles of each vertex near the intersections.
    pub(super) round: FxHashMap<u32, Vec<usize>>,
    /// Triangles by position; `None` for repeated changes.
    bins: FxHashMap<[i64; 3], Vec<(usize, Box3)>>,
    size: f64,
    /// Intersections of some triangles, as far as computed.
    cuts: FxHashMap<usize, Vec<usize>>,
    gone: FxHashSet<usize>,
    /// Vertices of changed triangles, with the number of the last change.
    touched: FxHashMap<u32, usize>,
    changes: usize,
}

/// Kinds of changes around an edge.
#[derive(Clone, Copy, Debug)]
enum Joining {
    /// By the other diagonal.
    Turned,
    /// With the first end drawn onto the second.
    Drawn,
}

/// A change that can be repeated when the triangles are assembled again.
pub(super) struct Unfolding {
    how: Joining,
    edge: [VertexKey; 2],
    /// The triangles that it changed.
    of: SmallVec<[[VertexKey; 3]; 8]>,
}

/// Joins the vertices of these pairs of triangles differently if that reduces the intersections.
/// Returns the vertices of the pairs and of all changed triangles, or `None` without a change.
/// Changes are appended to `done`.
pub(super) fn unfold(
    made: &mut Assembled,
    names: &VertexNames,
    grid: &Grid,
    leaves: &[Leaf],
    pairs: &[[usize; 2]],
    done: &mut Vec<Unfolding>,
) -> Option<FxHashSet<u32>> {
    let of_pairs: Vec<u32> = pairs.iter().flatten().flat_map(|&t| made.triangles[t].1).collect();
    let mut folds = FoldedRegion::about(made, leaves, &of_pairs, RINGS);
    // A pair is skipped if nothing beside it changed since its last test.
    let mut looked: Vec<Option<usize>> = vec![None; pairs.len()];
    for _ in 0..ROUNDS {
        let before = folds.changes;
        for (pair, looked) in pairs.iter().zip(&mut looked) {
            if looked.is_none_or(|then| folds.changed_near(*pair, then)) {
                folds.cure(*pair, names, done);
                *looked = Some(folds.changes);
            }
        }
        if folds.changes == before {
            break;
        }
    }
    let mut touched = folds.done(grid)?;
    touched.extend(of_pairs);
    Some(touched)
}

/// Repeats earlier changes after a new assembly, if none of their vertices moved, and keeps only
/// those. Returns the vertices of the others.
pub(super) fn unfold_again(
    made: &mut Assembled,
    names: &VertexNames,
    grid: &Grid,
    leaves: &[Leaf],
    done: &mut Vec<Unfolding>,
    moved: &FxHashSet<u32>,
) -> FxHashSet<u32> {
    let number = |name: &VertexKey| names.number(*name).filter(|v| !moved.contains(v));
    let seeds: Vec<u32> =
        done.iter().flat_map(|u| u.of.iter().flatten()).filter_map(number).collect();
    let mut folds = FoldedRegion::about(made, leaves, &seeds, KNOWN_RINGS);
    let mut left = FxHashSet::default();
    done.retain(|u| {
        let all = u.of.iter().flatten().all(|name| number(name).is_some());
        let edge = u.edge.each_ref().map(number);
        let change = match edge {
            [Some(a), Some(b)] if all => folds.change(u.how, a, b),
            _ => None,
        };
        match change.filter(|c| folds.triangles_of(c, names) == u.of) {
            Some(change) => {
                folds.apply(&change);
                true
            }
            None => {
                left.extend(u.of.iter().flatten().filter_map(|name| names.number(*name)));
                false
            }
        }
    });
    folds.done(grid);
    left
}

impl<'a> FoldedRegion<'a> {
    /// The region within some rings around some vertices.
    pub(super) fn about(
        made: &'a mut Assembled,
        leaves: &'a [Leaf],
        seeds: &[u32],
        rings: usize,
    ) -> Self {
        let mut marked = vec![false; made.positions.len()];
        seeds.iter().for_each(|&v| marked[v as usize] = true);
        let mut near = Vec::new();
        for ring in 0..rings {
            let one = |v: &u32| marked[*v as usize];
            near = (0..made.triangles.len())
                .filter(|&t| made.triangles[t].1.iter().any(one))
                .collect();
            if ring + 1 < rings {
                for &t in &near {
                    made.triangles[t].1.iter().for_each(|&v| marked[v as usize] = true);
                }
            }
        }
        let mut round: FxHashMap<u32, Vec<usize>> = FxHashMap::default();
        let (mut sum, mut count) = (0.0, 0.0);
        for &t in &near {
            let corners = made.triangles[t].1;
            for v in corners.into_iter().filter(|&v| marked[v as usize]) {
                round.entry(v).or_default().push(t);
            }
            let [p, q, _] = corners.map(|v| made.positions[v as usize]);
            (sum, count) = (sum + p.distance(q), count + 1.0);
        }
        let mut folds = Self {
            made,
            leaves,
            solver: Solver::default(),
            normals: FxHashMap::default(),
            round,
            bins: FxHashMap::default(),
            size: (2.0 * sum / f64::max(count, 1.0)).max(f64::MIN_POSITIVE),
            cuts: FxHashMap::default(),
            gone: FxHashSet::default(),
            touched: FxHashMap::default(),
            changes: 0,
        };
        if rings > KNOWN_RINGS {
            near.iter().for_each(|&t| folds.file(t));
        }
        folds
    }

    /// Removes the deleted triangles, and returns the vertices with outdated data, if anything
    /// changed; new triangles have none by construction.
    pub(super) fn done(self, grid: &Grid) -> Option<FxHashSet<u32>> {
        let Self { made, gone, touched, .. } = self;
        if touched.is_empty() {
            return None;
        }
        if !gone.is_empty() {
            let mut k = 0;
            made.triangles.retain(|_| {
                k += 1;
                !gone.contains(&(k - 1))
            });
        }
        let known: FxHashSet<u32> = made.doubtful.iter().map(|d| d.0).collect();
        let cell = |v: u32| (v, grid.cell_of(made.positions[v as usize]));
        let new = touched.keys().filter(|v| !known.contains(v)).map(|&v| cell(v));
        let new: Vec<_> = new.collect();
        made.doubtful.extend(new);
        made.doubtful.sort_unstable();
        Some(touched.into_keys().collect())
    }

    pub(super) fn at(&self, v: u32) -> Vec3 {
        self.made.positions[v as usize]
    }

    pub(super) fn points(&self, t: Corners) -> [Vec3; 3] {
        t.map(|v| self.at(v))
    }

    fn file(&mut self, t: usize) {
        let b = Box3::around(self.points(self.made.triangles[t].1));
        for bin in bins(&b, self.size) {
            self.bins.entry(bin).or_default().push((t, b));
        }
    }

    /// Removes a changed or deleted triangle from the bins.
    fn unfile(&mut self, t: usize) {
        let b = Box3::around(self.points(self.made.triangles[t].1));
        for bin in bins(&b, self.size) {
            if let Some(all) = self.bins.get_mut(&bin) {
                all.retain(|x| x.0 != t);
            }
        }
    }

    pub(super) fn on(&self, v: u32, leaf: u32) -> bool {
        self.made.surfaces[v as usize].contains(&leaf)
    }

    pub(super) fn normal(&mut self, v: u32, leaf: u32) -> Vec3 {
        let p = self.at(v);
        let (leaves, solver) = (self.leaves, &mut self.solver);
        *self.normals.entry((v, leaf)).or_insert_with(|| {
            let slope = solver.gradient(leaves[leaf as usize].primitive.tape(), p).slope;
            let size = slope.norm();
            if size > 0.0 && size.is_finite() { slope / size } else { Vec3::zero() }
        })
    }

    /// The cosine between a triangle and the mean of the surface's normals at its corners.
    pub(super) fn facing(&mut self, leaf: u32, t: Corners) -> f64 {
        let [a, b, c] = self.points(t);
        let n = (b - a).cross(c - a);
        let mut mean = Vec3::zero();
        for v in t {
            mean += self.normal(v, leaf);
        }
        let size = n.norm() * mean.norm();
        if size == 0.0 { -1.0 } else { n.dot(mean) / size }
    }

    /// Number of faults (intersections with all other triangles, and folds) of some triangles;
    /// counted up to `most`.
    fn wrong(
        &mut self,
        all: &[(u32, Corners)],
        others: &[(usize, PlacedTriangle)],
        most: isize,
    ) -> isize {
        let folded = all.iter().filter(|x| self.facing(x.0, x.1) < FACING);
        let mut count = folded.count() as isize;
        let placed: SmallVec<[PlacedTriangle; 8]> = all.iter().map(|x| self.placed(x.1)).collect();
        for (k, own) in placed.iter().enumerate() {
            for other in placed[k + 1..].iter().chain(others.iter().map(|o| &o.1)) {
                if count >= most {
                    return count;
                }
                count += isize::from(own.cuts(other));
            }
        }
        count
    }

    fn placed(&self, corners: Corners) -> PlacedTriangle {
        let points = self.points(corners);
        PlacedTriangle {
            corners,
            points,
            plane: TrianglePlane::of(points),
            around: Box3::around(points),
        }
    }

    /// The triangles near a box but some.
    fn near(&self, reach: &Box3, but: impl Fn(usize) -> bool) -> Vec<(usize, PlacedTriangle)> {
        let mut found = Vec::new();
        for bin in bins(reach, self.size) {
            for (t, around) in self.bins.get(&bin).into_iter().flatten() {
                // Pairs of several bins are counted in the first.
                let first = || bin_of(common_low(reach, around), self.size) == bin;
                if meet(reach, around) && first() && !but(*t) {
                    found.push((*t, self.placed(self.made.triangles[*t].1)));
                }
            }
        }
        found
    }

    /// The triangles that a triangle cuts.
    fn cuts(&mut self, t: usize) -> &[usize] {
        if !self.cuts.contains_key(&t) {
            let own = self.placed(self.made.triangles[t].1);
            let near = self.near(&own.around, |o| o == t);
            let found = near.into_iter().filter(|(_, other)| own.cuts(other)).map(|n| n.0);
            let found: Vec<usize> = found.collect();
            self.cuts.insert(t, found);
        }
        &self.cuts[&t]
    }

    /// Number of faults of some of the triangles: intersections, with each other counted once, and
    /// folds.
    fn wrong_now(&mut self, own: &[usize]) -> isize {
        let mut count = 0;
        for (k, &t) in own.iter().enumerate() {
            count += self.cuts(t).iter().filter(|o| !own[..k].contains(o)).count() as isize;
            let (leaf, corners) = self.made.triangles[t];
            count += isize::from(self.facing(leaf, corners) < FACING);
        }
        count
    }

    /// Reduction of the number of faults by a change, if more than `least`.
    pub(super) fn gain(&mut self, change: &Change, least: isize) -> Option<isize> {
        let before = self.wrong_before(change);
        self.gain_from(before, change, least)
    }

    /// Number of faults of the triangles that a change modifies.
    fn wrong_before(&mut self, change: &Change) -> isize {
        let count = self.made.triangles.len();
        let own: SmallVec<[usize; 8]> = change.own().filter(|t| *t < count).collect();
        self.wrong_now(&own)
    }

    /// As [`FoldedRegion::gain`], with the number of faults before.
    fn gain_from(&mut self, before: isize, change: &Change, least: isize) -> Option<isize> {
        if before <= least {
            return None;
        }
        let new: SmallVec<[(u32, Corners); 8]> = change.made.iter().map(|m| (m.1, m.2)).collect();
        let of = |t: &(u32, Corners)| Box3::around(self.points(t.1));
        let reach = new.iter().map(of).fold(Box3::EMPTY, Box3::union);
        let others = self.near(&reach, |t| change.own().any(|o| o == t));
        let gain = before - self.wrong(&new, &others, before - least);
        (gain > least).then_some(gain)
    }

    /// Removes the data of a discarded vertex.
    pub(super) fn forget(&mut self, v: u32) {
        self.normals.retain(|k, _| k.0 != v);
    }

    /// The triangle with the directed edge from `a` to `b`, and its third corner.
    pub(super) fn beside(&self, a: u32, b: u32) -> Option<(usize, u32)> {
        let mut found = None;
        for &t in self.round.get(&a)? {
            let c = self.made.triangles[t].1;
            let k = c.iter().position(|&v| v == a)?;
            if c[(k + 1) % 3] == b {
                if found.is_some() {
                    return None;
                }
                found = Some((t, c[(k + 2) % 3]));
            }
        }
        found
    }

    fn joined(&self, a: u32, b: u32) -> bool {
        let of = |t: &usize| self.made.triangles[*t].1.contains(&b);
        self.round.get(&a).is_none_or(|all| all.iter().any(of))
    }

    pub(super) fn height(&self, t: Corners) -> f64 {
        let p = self.points(t);
        let longest = (0..3).map(|k| (p[(k + 1) % 3] - p[k]).norm_sq()).fold(0.0, f64::max);
        if longest == 0.0 { 0.0 } else { (p[1] - p[0]).cross(p[2] - p[0]).norm() / longest }
    }

    /// The other diagonal of the two triangles beside an edge.
    fn turned(&mut self, a: u32, b: u32) -> Option<Change> {
        let ((s, c), (t, d)) = (self.beside(a, b)?, self.beside(b, a)?);
        if c == d || self.joined(c, d) {
            return None;
        }
        let pair = [s, t].map(|x| self.made.triangles[x].0);
        let new = [[a, d, c], [d, b, c]];
        let least = self.height([a, b, c]).min(self.height([b, a, d])).min(THIN);
        let mut made = SmallVec::new();
        for (slot, corners) in [s, t].into_iter().zip(new) {
            if self.height(corners) < least {
                return None;
            }
            let mut best: Option<(f64, u32)> = None;
            for leaf in pair {
                if corners.iter().all(|&v| self.on(v, leaf)) || pair[0] == pair[1] {
                    let facing = self.facing(leaf, corners);
                    if best.is_none_or(|b| facing > b.0) {
                        best = Some((facing, leaf));
                    }
                }
            }
            made.push((slot, best?.1, corners));
        }
        Some(Change { made, gone: SmallVec::new() })
    }

    /// Merge of a vertex into another that is on all of its surfaces.
    fn drawn(&mut self, from: u32, to: u32) -> Option<Change> {
        let all = |v: &u32| self.on(to, *v);
        if !self.made.surfaces[from as usize].iter().all(all) {
            return None;
        }
        let (own, others) = (self.round.get(&from)?, self.round.get(&to)?);
        let ring = |all: &Vec<usize>| -> FxHashSet<u32> {
            all.iter().flat_map(|&t| self.made.triangles[t].1).collect()
        };
        let (a, b) = (ring(own), ring(others));
        let common = a.intersection(&b).filter(|v| ![from, to].contains(v)).count();
        let gone: SmallVec<[usize; 2]> =
            own.iter().copied().filter(|t| others.contains(t)).collect();
        if common != 2 || gone.len() != 2 || a.iter().any(|v| !self.round.contains_key(v)) {
            return None;
        }
        let mut made = SmallVec::new();
        for &t in own.iter().filter(|t| !gone.contains(t)) {
            let (leaf, old) = self.made.triangles[t];
            let new = old.map(|v| if v == from { to } else { v });
            if !self.on(to, leaf) || self.height(new) < THIN.min(self.height(old)) {
                return None;
            }
            made.push((t, leaf, new));
        }
        Some(Change { made, gone })
    }

    /// The change around an edge, if possible.
    fn change(&mut self, how: Joining, a: u32, b: u32) -> Option<Change> {
        match how {
            Joining::Turned => self.turned(a, b),
            Joining::Drawn => self.drawn(a, b),
        }
    }

    /// The triangles that a change changes, as they are before it.
    fn triangles_of(&self, change: &Change, names: &VertexNames) -> SmallVec<[[VertexKey; 3]; 8]> {
        let own = change.own().map(|t| self.made.triangles[t].1.map(|v| names.name(v)));
        let mut own: SmallVec<[[VertexKey; 3]; 8]> = own.collect();
        own.iter_mut().for_each(|t| {
            let first = (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
            t.rotate_left(first);
        });
        own.sort_unstable();
        own
    }

    /// True when a triangle beside the vertices of a pair, or one of its own, was changed after that many changes.
    fn changed_near(&self, pair: [usize; 2], then: usize) -> bool {
        let near = pair.into_iter().flat_map(|t| self.made.triangles[t].1);
        let beside = near.flat_map(|v| self.round.get(&v)).flatten();
        let mut vertices = beside.flat_map(|&t| self.made.triangles[t].1);
        vertices.any(|v| self.touched.get(&v).is_some_and(|&last| last > then))
    }

    pub(super) fn apply(&mut self, change: &Change) {
        self.changes += 1;
        for t in change.own() {
            let Some(&(_, old)) = self.made.triangles.get(t) else { continue };
            if self.gone.contains(&t) {
                continue;
            }
            if !self.bins.is_empty() {
                self.forget_cuts(old);
                self.unfile(t);
            }
            self.touched.extend(old.map(|v| (v, self.changes)));
            for v in old {
                if let Some(all) = self.round.get_mut(&v) {
                    all.retain(|x| *x != t);
                }
            }
        }
        self.gone.extend(change.gone.iter().copied());
        for &(t, leaf, corners) in &change.made {
            match self.made.triangles.get_mut(t) {
                Some(slot) => *slot = (leaf, corners),
                // They come in the order of their numbers.
                None => self.made.triangles.push((leaf, corners)),
            }
            self.touched.extend(corners.map(|v| (v, self.changes)));
            for v in corners {
                if let Some(all) = self.round.get_mut(&v) {
                    all.push(t);
                }
            }
            if !self.bins.is_empty() {
                self.file(t);
                self.forget_cuts(corners);
            }
        }
    }

    /// Intersections of triangles near a modified one are outdated.
    fn forget_cuts(&mut self, corners: Corners) {
        let reach = Box3::around(self.points(corners));
        for bin in bins(&reach, self.size) {
            for (t, around) in self.bins.get(&bin).into_iter().flatten() {
                if meet(&reach, around) {
                    self.cuts.remove(t);
                }
            }
        }
    }

    /// Changes the neighbourhood of a pair of triangles while that reduces faults and the pair
    /// intersects.
    fn cure(&mut self, pair: [usize; 2], names: &VertexNames, done: &mut Vec<Unfolding>) {
        for _ in 0..STEPS {
            if pair.iter().any(|t| self.gone.contains(t)) {
                return;
            }
            let both = pair.map(|t| self.made.triangles[t].1);
            if !cut(both, both.map(|t| self.points(t))) {
                return;
            }
            let mut edges: Vec<(u32, u32)> = Vec::new();
            for t in both {
                for k in 0..3 {
                    let (a, b) = (t[k], t[(k + 1) % 3]);
                    edges.push((a.min(b), a.max(b)));
                    // Sides of the triangle beyond.
                    if let Some((_, c)) = self.beside(b, a) {
                        edges.extend([(a.min(c), a.max(c)), (b.min(c), b.max(c))]);
                    }
                }
            }
            edges.sort_unstable();
            edges.dedup();
            let mut all: Vec<(isize, Change, Joining, [u32; 2])> = Vec::new();
            for (a, b) in edges {
                let ways =
                    [(Joining::Turned, a, b), (Joining::Drawn, a, b), (Joining::Drawn, b, a)];
                for (how, a, b) in ways {
                    let Some(change) = self.change(how, a, b) else { continue };
                    all.push((self.wrong_before(&change), change, how, [a, b]));
                }
            }
            // The pairs with most faults first: once the gain cannot be exceeded the others are
            // skipped.
            all.sort_by_key(|x| std::cmp::Reverse(x.0));
            let mut best: Option<(isize, usize)> = None;
            for (k, (before, change, ..)) in all.iter().enumerate() {
                let least = best.map_or(0, |b| b.0);
                let gain = self.gain_from(*before, change, least);
                best = gain.map(|gain| (gain, k)).or(best);
            }
            let Some((_, best)) = best else { return };
            let (_, change, how, edge) = all.swap_remove(best);
            let of = self.triangles_of(&change, names);
            done.push(Unfolding { how, edge: edge.map(|v| names.name(v)), of });
            self.apply(&change);
        }
    }
}
