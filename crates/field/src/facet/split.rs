//! Several vertices for a piece of surface in a cell through which several edges or corners pass.
//!
//! The crossings around the piece show its primitives in turn. A cut from one run of crossings of a
//! primitive to another run of the same primitive divides the ring in two, each with a vertex on
//! all the primitives of its part; both have the primitives of the cut, so that the edge between
//! the two vertices is on the cut primitive. With runs A B A C there are two edges: with a cut
//! through both runs of A, their vertices are on A and B and on A and C. With A B C D there are two
//! corners; the cut through A and C, or B and D, has them. Parts are divided again while they have
//! no common point.

use super::place_vertices::VertexPlacer;
use super::types::{EdgeCrossing, Ring, Split};
use super::vertex::{PlacedVertex, Surfaces};
use moldloft_num::Vec3;
use smallvec::SmallVec;

/// More runs than this are left alone, as are cells that take more searches.
const MOST_RUNS: usize = 8;
const MOST_SEARCHES: usize = 60;

/// Neighbouring crossings of one primitive; empty for a primitive that shows between two edges
/// only.
struct CrossingRun {
    leaf: u32,
    /// Indices in the ring.
    places: std::ops::Range<usize>,
    /// Its change into the next.
    change: Option<Vec3>,
}

struct RingPart {
    vertices: SmallVec<[(PlacedVertex, Surfaces); 2]>,
    parent: SmallVec<[u8; 2]>,
    /// For each of its runs, its vertices in the order of the ring.
    of_run: SmallVec<[(usize, SmallVec<[u8; 3]>); 4]>,
}

struct Splitting<'s, 'a, 'c> {
    placement: &'s mut VertexPlacer<'a>,
    ring: Ring<'c>,
    runs: Vec<CrossingRun>,
    searches: usize,
}

/// The vertices of the piece of surface with these crossings, if there are several that will do.
pub(super) fn split(placement: &mut VertexPlacer, edges: &Ring, next: &[u8; 12]) -> Option<Split> {
    let mut ring: Ring = SmallVec::new();
    let mut at = edges.first()?.0;
    for _ in 0..edges.len() {
        ring.push(*edges.iter().find(|e| e.0 == at)?);
        at = next[at] as usize;
    }
    // Begin with a run.
    let n = ring.len();
    let leaf = |k: usize| ring[k % n].1.leaf;
    let start = (0..n).find(|&k| leaf(k) != leaf(k + n - 1))?;
    ring.rotate_left(start);
    let runs = runs_of(placement, &ring);
    if !(4..=MOST_RUNS).contains(&runs.len()) {
        return None;
    }
    let whole: SmallVec<[usize; 8]> = (0..runs.len()).collect();
    let mut splitting = Splitting { placement, ring, runs, searches: 0 };
    let part = splitting.cut(&whole, true)?;
    splitting.finish(part)
}

/// The runs of a ring, with those that show on the cell's sides only.
fn runs_of(placement: &mut VertexPlacer, ring: &Ring) -> Vec<CrossingRun> {
    let n = ring.len();
    let mut runs: Vec<CrossingRun> = Vec::new();
    let mut start = 0;
    for k in 0..n {
        let (p, q) = (ring[k], ring[(k + 1) % n]);
        if p.1.leaf == q.1.leaf {
            continue;
        }
        let mut run = CrossingRun { leaf: p.1.leaf, places: start..k + 1, change: None };
        start = k + 1;
        let Some(side) = placement.shared_side(p.0, q.0) else {
            runs.push(run);
            continue;
        };
        let pair = [p.1.leaf, q.1.leaf];
        let found = placement.change(p.1, q.1, &side).map(|c| c.point);
        let at = found.unwrap_or((p.1.point + q.1.point) * 0.5);
        match placement.blocking_leaf(at, &pair) {
            None => {
                run.change = found;
                runs.push(run);
            }
            Some(leaf) => {
                let hidden = |p: &EdgeCrossing| EdgeCrossing { leaf, ..*p };
                let first = placement.change(p.1, &hidden(q.1), &side);
                let second = placement.change(&hidden(p.1), q.1, &side);
                run.change = first.map(|c| c.point);
                runs.push(run);
                let change = second.map(|c| c.point);
                runs.push(CrossingRun { leaf, places: k + 1..k + 1, change });
            }
        }
    }
    runs
}

impl Splitting<'_, '_, '_> {
    /// A vertex on all the primitives of these runs, and on the surface of the set.
    fn vertex(&mut self, list: &[usize]) -> Option<(PlacedVertex, Surfaces)> {
        let mut surfaces = Surfaces::new();
        for &k in list {
            let leaf = self.runs[k].leaf;
            if let Err(place) = surfaces.binary_search(&leaf) {
                surfaces.insert(place, leaf);
            }
        }
        if surfaces.len() > 3 {
            return None;
        }
        let mut starts: SmallVec<[Vec3; 8]> = SmallVec::new();
        starts.extend(list[..list.len() - 1].iter().filter_map(|&k| self.runs[k].change));
        let inner = &list[1..list.len() - 1];
        let shown = inner.iter().flat_map(|&k| self.runs[k].places.clone());
        starts.extend(shown.map(|k| self.ring[k].1.point));
        if starts.is_empty() {
            return None;
        }
        let count = starts.len() as f64;
        let mut mean = Vec3::zero();
        starts.iter().for_each(|p| mean += *p);
        starts.insert(0, mean / count);
        for start in starts {
            self.searches += 1;
            if self.searches > MOST_SEARCHES {
                return None;
            }
            let placed = self.placement.place(&surfaces, start);
            if placed.residual <= self.placement.goal && self.on_surface(placed.point, &surfaces) {
                return Some((placed, surfaces));
            }
        }
        None
    }

    /// True when no other primitive cuts the point off, to a few roundings.
    fn on_surface(&mut self, at: Vec3, surfaces: &[u32]) -> bool {
        self.placement.blocking_leaf(at, surfaces).is_none()
    }

    /// The vertices of these runs: one or, if `several`, more.
    fn solve(&mut self, list: &[usize], several: bool) -> Option<RingPart> {
        if let Some(vertex) = self.vertex(list) {
            let of_run = list.iter().map(|&k| (k, SmallVec::from_slice(&[0]))).collect();
            let (mut vertices, mut parent) = (SmallVec::new(), SmallVec::new());
            vertices.push(vertex);
            parent.push(0);
            return Some(RingPart { vertices, parent, of_run });
        }
        if several && list.len() > 3 { self.cut(list, true) } else { None }
    }

    /// The vertices of two parts of these runs, cut where both have some: of one each if that is possible.
    fn cut(&mut self, list: &[usize], several: bool) -> Option<RingPart> {
        let n = list.len();
        let pairs = (0..n).flat_map(|i| (i + 2..n).map(move |j| (i, j)));
        let mut pairs: SmallVec<[(usize, usize); 20]> =
            pairs.filter(|&(i, j)| (i, j) != (0, n - 1)).collect();
        // Cuts that stay on one primitive first.
        pairs.sort_by_key(|&(i, j)| self.runs[list[i]].leaf != self.runs[list[j]].leaf);
        for again in [false, true] {
            if again && !(several && n > 4) {
                break;
            }
            for &(i, j) in &pairs {
                let left: SmallVec<[usize; 8]> = SmallVec::from_slice(&list[i..=j]);
                let right: SmallVec<[usize; 8]> =
                    list[j..].iter().chain(&list[..=i]).copied().collect();
                let Some(a) = self.solve(&left, again) else { continue };
                let Some(b) = self.solve(&right, again) else { continue };
                return Some(joined(a, b, [list[i], list[j]]));
            }
        }
        None
    }

    /// Gives each crossing the vertex that is nearest to it, in the order of the ring.
    fn finish(self, part: RingPart) -> Option<Split> {
        let mut group = [0u8; 12];
        let mut used = vec![false; part.vertices.len()];
        for (run, vertices) in &part.of_run {
            let places = self.runs[*run].places.clone();
            let mut least = 0;
            for place in places {
                let (edge, crossing) = self.ring[place];
                let far =
                    |v: usize| part.vertices[vertices[v] as usize].0.point.distance(crossing.point);
                // Never back to an earlier one.
                let nearest = (least..vertices.len()).min_by(|&a, &b| far(a).total_cmp(&far(b)))?;
                least = nearest;
                group[edge] = vertices[nearest];
                used[vertices[nearest] as usize] = true;
            }
        }
        // A vertex at the end of the tree without a crossing would be unconnected.
        let inner = |v: usize| {
            let branches =
                (0..part.parent.len()).filter(|&k| k != v && part.parent[k] as usize == v).count();
            branches + usize::from(part.parent[v] as usize != v) > 1
        };
        (0..used.len()).all(|v| used[v] || inner(v)).then_some(Split {
            vertices: part.vertices,
            group,
            parent: part.parent,
        })
    }
}

/// Two parts of a ring merged along the cut from one run to another.
fn joined(mut a: RingPart, mut b: RingPart, [i, j]: [usize; 2]) -> RingPart {
    let shift = a.vertices.len() as u8;
    for (_, vertices) in &mut b.of_run {
        vertices.iter_mut().for_each(|v| *v += shift);
    }
    let mut take = |run: usize| {
        let k = b.of_run.iter().position(|r| r.0 == run);
        k.map(|k| b.of_run.remove(k).1).unwrap_or_default()
    };
    // The first part has the end of run i and the start of run j.
    let (mut first, last) = (take(i), take(j));
    let touching = first.last().copied().unwrap_or(shift);
    for (run, vertices) in &mut a.of_run {
        if *run == i {
            first.extend(vertices.iter().copied());
            std::mem::swap(vertices, &mut first);
        } else if *run == j {
            vertices.extend(last.iter().copied());
        }
    }
    // The tree of b is connected to the vertex of a beside it by b's vertex there.
    let beside = a.of_run.iter().find(|r| r.0 == i).and_then(|r| {
        let k = r.1.iter().position(|v| *v == touching)?;
        r.1.get(k + 1).copied()
    });
    let mut parent: SmallVec<[u8; 2]> = b.parent.iter().map(|p| p + shift).collect();
    let mut at = touching - shift;
    let mut above = beside.unwrap_or(0);
    loop {
        let up = parent[at as usize] - shift;
        parent[at as usize] = above;
        if up == at {
            break;
        }
        (above, at) = (at + shift, up);
    }
    a.vertices.extend(b.vertices);
    a.parent.extend(parent);
    a.of_run.extend(b.of_run);
    a
}
