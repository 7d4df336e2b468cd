//! Knuckles of a surface, as lines of its parameter square.
//!
//! At a knuckle the surface is continuous and its tangents across are not: the joint of a poly-curve, a knot
//! of degree 1, a crease. One along u = const or v = const is a row of the patch. A part of a surface is crossed
//! by the knuckles of the whole at any angle: such a line from edge to edge is a row of the patch, too
//! ([`crate::conformal`]), so that no panel spans it.

use moldloft_num::period::breaks_between;
use moldloft_num::{InnerPlane, Order, Real, Surface, Vec3, find_root};
use std::collections::{BTreeMap, HashSet};

/// Tangents that differ in direction by more than this, in radians, make a knuckle.
const TURN: f64 = 1e-5;

/// Distance before and after a break at which tangents are evaluated; a break is known to rounding
/// only, since it may have been divided among pieces.
pub(crate) const ASIDE: f64 = 1e-9;

/// Breaks nearer than this are one: those of opposite sides, each found by a search of its own.
const SAME_KNUCKLE: f64 = 4.0 * ASIDE;

/// Distance, in parameters, within which lines, or a line and a corner, are one.
const SAME_LINE: f64 = 1e-6;

/// Number of points along a break at which it is tested.
const TRIALS: usize = 5;

/// Number of steps in each direction in which a part is examined.
const STEPS: usize = 24;

/// A knuckle of the whole from one edge of a part to another.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct KnuckleLine {
    /// It is where coordinate `axis` of this inner plane is `at`.
    plane: usize,
    axis: usize,
    at: f64,
    /// The edges 0..4 on which it begins and ends, with their parameters there.
    pub ends: [(u8, f64); 2],
    /// Points (u, v) of it, from end to end.
    path: Vec<[f64; 2]>,
}

/// The knuckles of a surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Knuckles {
    /// The knuckles along u = const and v = const, ascending, between 0 and 1.
    pub straight: [Vec<f64>; 2],
    /// Knuckles of the whole surface that cross it from edge to edge. Of two between the same
    /// opposite edges, the first is below the second on both.
    pub across: Vec<KnuckleLine>,
    /// A point of one of the whole that is none of these: a loop, one through a corner, one that meets another.
    pub loose: Option<[f64; 2]>,
}

impl Knuckles {
    /// The knuckles of a surface.
    pub fn of(surface: &dyn Surface<f64>) -> Self {
        let mut all = Self { straight: straight(surface), ..Self::default() };
        for (index, plane) in surface.inner_planes().iter().enumerate() {
            all.add_plane(surface, index, plane);
        }
        all.drop_bends(surface);
        all.sort();
        all
    }

    /// For each row of knuckles from an edge to the opposite one its parameters on both: the edges v = 0 and v = 1
    /// (`direction` 0), or u = 0 and u = 1.
    pub fn rows(&self, direction: usize) -> Vec<[f64; 2]> {
        let mut rows: Vec<[f64; 2]> = self.straight[direction].iter().map(|&b| [b, b]).collect();
        rows.extend(self.across.iter().filter_map(|line| line.row(direction)));
        rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
        rows
    }

    /// Its parameters on edge `k`, in any order.
    pub fn on_edge(&self, k: usize) -> impl Iterator<Item = f64> {
        let ends = self.across.iter().flat_map(|line| line.ends);
        let across = ends.filter(move |(edge, _)| usize::from(*edge) == k).map(|(_, t)| t);
        self.straight[k % 2].iter().copied().chain(across)
    }

    /// True if one of the whole that crosses the patch ends there on edge `k`.
    pub fn is_across(&self, k: usize, at: f64) -> bool {
        let mut ends = self.across.iter().flat_map(|line| line.ends);
        ends.any(|(edge, t)| usize::from(edge) == k && (t - at).abs() < SAME_LINE)
    }

    fn add_plane(&mut self, surface: &dyn Surface<f64>, index: usize, plane: &InnerPlane<'_>) {
        if plane.kinks.iter().all(Vec::is_empty) && plane.closed == [false; 2] {
            return;
        }
        let grid = SampleGrid::new(plane);
        for axis in 0..2 {
            let (low, high) = grid.range(axis);
            for at in breaks_between(&plane.kinks[axis], plane.closed[axis], low, high) {
                let (chains, lost) = grid.chains(plane, axis, at);
                for path in chains {
                    self.add_chain(surface, [index, axis], at, path);
                }
                let lost = lost.filter(|w| self.turns_at(surface, *w));
                self.loose = self.loose.or(lost);
            }
        }
    }

    /// Adds a line of the whole, where it is a knuckle and none that is known. It takes the place of a row or column that
    /// is straight only by chance: the ends of a line of the whole move apart.
    fn add_chain(
        &mut self,
        surface: &dyn Surface<f64>,
        [plane, axis]: [usize; 2],
        at: f64,
        path: Vec<[f64; 2]>,
    ) {
        if !turns_along(surface, &path) {
            return;
        }
        let is = |k: usize, b: f64| path.iter().all(|w| (w[k] - b).abs() < SAME_LINE);
        let known = (0..2).any(|k| self.straight[k].iter().any(|&b| is(k, b)));
        let ends = [path[0], path[path.len() - 1]].map(edge_at);
        let [Some(first), Some(last)] = ends else {
            self.loose = self.loose.or(Some(path[path.len() / 2]).filter(|_| !known));
            return;
        };
        for k in 0..2 {
            self.straight[k].retain(|&b| !is(k, b));
        }
        let line = KnuckleLine { plane, axis, at, ends: [first, last], path };
        if self.across.iter().any(|other| other.is_same(&line)) {
            return;
        }
        if first.0 == last.0 || !line.is_graph() {
            self.loose = self.loose.or(Some(line.middle()));
            return;
        }
        self.across.push(line);
    }

    /// True when the tangents jump at a point, along u or v.
    fn turns_at(&self, surface: &dyn Surface<f64>, w: [f64; 2]) -> bool {
        let own = |k: usize| self.straight[k].iter().any(|b| (w[k] - b).abs() < SAME_LINE);
        (0..2).any(|k| {
            let mut d = [0.0; 2];
            d[k] = 1.0;
            let inside = w[k] > ASIDE && w[k] < 1.0 - ASIDE;
            inside && !own(k) && turn_across(surface, w, d)
        })
    }

    /// Drops parameter lines that bend where a line of the whole ends, as those of a side that bends there: the surface
    /// itself is smooth.
    fn drop_bends(&mut self, surface: &dyn Surface<f64>) {
        let ends: Vec<(u8, f64)> = self.across.iter().flat_map(|line| line.ends).collect();
        for k in 0..2 {
            let meets = |b: f64| {
                let mut on = ends.iter().filter(|(edge, _)| usize::from(edge % 2) == k);
                on.any(|(_, t)| (t - b).abs() < SAME_LINE)
            };
            let creased = |b: f64| {
                trials().into_iter().any(|t| {
                    let normal = |at: f64| {
                        let [u, v] = if k == 0 { [at, t] } else { [t, at] };
                        surface.jet(u, v, Order::First).normal()
                    };
                    differ((normal(b - ASIDE), normal(b + ASIDE)))
                })
            };
            self.straight[k].retain(|&b| !meets(b) || creased(b));
        }
    }

    /// Leaves the lines that can be rows together: of both directions those of one, and none that cross.
    fn sort(&mut self) {
        let rows = |lines: &[KnuckleLine], d: usize| {
            lines.iter().filter(|line| line.row(d).is_some()).count()
        };
        let both = rows(&self.across, 0) > 0 && rows(&self.across, 1) > 0;
        let turned = self.across.iter().any(|line| line.turns());
        let crossed = (0..2).any(|direction| {
            let rows = self.rows(direction);
            rows.windows(2).any(|w| w[1][1] <= w[0][1] || w[1][0] - w[0][0] < SAME_LINE)
        });
        let straight = self.straight.iter().any(|s| !s.is_empty());
        if both || crossed || (turned && straight) {
            let line = self.across.pop();
            self.loose = self.loose.or(line.map(|line| line.middle()));
            self.across.clear();
        }
    }
}

impl KnuckleLine {
    /// The parameters on both edges of a line from an edge to the opposite one.
    pub fn row(&self, direction: usize) -> Option<[f64; 2]> {
        let sides = if direction == 0 { [0, 2] } else { [3, 1] };
        let [(a, s), (b, t)] = self.ends;
        match [a, b] {
            ends if ends == sides => Some([s, t]),
            [b, a] if [a, b] == sides => Some([t, s]),
            _ => None,
        }
    }

    /// True for a line from an edge to one beside it.
    pub fn turns(&self) -> bool {
        self.ends[0].0 % 2 != self.ends[1].0 % 2
    }

    /// A point of it.
    pub fn middle(&self) -> [f64; 2] {
        self.path[self.path.len() / 2]
    }

    fn is_same(&self, other: &KnuckleLine) -> bool {
        let near = |a: (u8, f64), b: (u8, f64)| a.0 == b.0 && (a.1 - b.1).abs() < SAME_LINE;
        let [a, b] = self.ends;
        let [c, d] = other.ends;
        near(a, c) && near(b, d) || near(a, d) && near(b, c)
    }

    /// The direction in which points are moved onto the line.
    pub fn across<T: Real>(&self, from: [T; 2], to: [T; 2]) -> [T; 2] {
        match (self.row(0), self.row(1)) {
            (Some(_), _) => [T::one(), T::zero()],
            (_, Some(_)) => [T::zero(), T::one()],
            _ => [-(to[1] - from[1]), to[0] - from[0]],
        }
    }

    /// True if each line in that direction meets it once.
    fn is_graph(&self) -> bool {
        let d = self.across(self.path[0], self.path[self.path.len() - 1]);
        let run = |w: &[f64; 2]| w[0] * d[1] - w[1] * d[0];
        let steps = self.path.windows(2).map(|w| run(&w[1]) - run(&w[0]));
        let steps: Vec<f64> = steps.filter(|x| x.abs() > 1e-12).collect();
        steps.iter().all(|x| x.signum() == steps[0].signum())
    }

    /// The distance from a point, in multiples of `d`, at which the line through it in that direction meets this one.
    pub fn distance(&self, planes: &[InnerPlane<'_>], from: [f64; 2], d: [f64; 2]) -> Option<f64> {
        let run = |w: [f64; 2]| (w[0] - from[0]) * d[1] - (w[1] - from[1]) * d[0];
        let step = |w: [f64; 2]| {
            ((w[0] - from[0]) * d[0] + (w[1] - from[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1])
        };
        let guess = self.path.windows(2).find_map(|pair| {
            let (a, b) = (run(pair[0]), run(pair[1]));
            let share = if a == b { 0.0 } else { a / (a - b) };
            let (s, t) = (step(pair[0]), step(pair[1]));
            ((a <= 0.0) != (b <= 0.0) || a == 0.0 || b == 0.0).then_some(s + (t - s) * share)
        })?;
        let plane = planes.get(self.plane)?;
        let beyond = |s: f64| {
            let w = [0, 1].map(|k| (from[k] + s * d[k]).clamp(0.0, 1.0));
            (plane.place)(w)[self.axis] - self.at
        };
        let mut reach = 1e-6;
        while reach < 0.5 {
            if let Ok(s) = find_root(beyond, guess - reach, guess + reach) {
                return Some(s);
            }
            reach *= 4.0;
        }
        None
    }
}

/// The derivatives of the distance at which a knuckle is, from a point on it that may move, in the direction `d`; with a
/// real part of 0.
///
/// Both sides meet at the knuckle whatever becomes of it, as at [a corner](moldloft_num::period::corner_rate).
pub(crate) fn rate_across<T: Real>(surface: &dyn Surface<T>, w: [T; 2], d: [T; 2]) -> T {
    if T::PARTS == 1 {
        return T::zero();
    }
    let side = |h: f64| {
        let [u, v] = [0, 1].map(|k| w[k] + d[k] * h);
        let jet = surface.jet(u, v, Order::First);
        let slope = jet.u * d[0] + jet.v * d[1];
        (jet.p - slope * T::from(h), slope.re())
    };
    let ((low, before), (high, after)) = (side(-ASIDE), side(ASIDE));
    let turn = before - after;
    let square = turn.norm_sq();
    if square <= 1e-16 * before.norm_sq().max(after.norm_sq()) {
        return T::zero();
    }
    let gap = high - low;
    let along = (gap.x * turn.x + gap.y * turn.y + gap.z * turn.z) / square;
    along - along.re()
}

/// The knuckles along u and along v, ascending, between 0 and 1.
fn straight(surface: &dyn Surface<f64>) -> [Vec<f64>; 2] {
    let [mut us, mut vs] = surface.kinks();
    let along = |u| surface.line(u, &trials(), Order::First).into_iter().map(|jet| jet.u).collect();
    us.retain(|&at| turns(at, along));
    let across = |v| trials().iter().map(|&u| surface.jet(u, v, Order::First).v).collect();
    vs.retain(|&at| turns(at, across));
    [us, vs].map(|mut all| {
        all.dedup_by(|next, kept| *next - *kept <= SAME_KNUCKLE);
        all
    })
}

/// The positions along a break.
fn trials() -> [f64; TRIALS] {
    std::array::from_fn(|i| (i as f64 + 0.37) / TRIALS as f64)
}

/// True when the tangents before and after a break differ in direction somewhere along it.
fn turns(at: f64, tangents: impl Fn(f64) -> Vec<Vec3>) -> bool {
    let inside = ASIDE < at && at < 1.0 - ASIDE;
    inside && tangents(at - ASIDE).into_iter().zip(tangents(at + ASIDE)).any(differ)
}

fn differ((a, b): (Vec3, Vec3)) -> bool {
    let size = a.norm() * b.norm();
    size > 0.0 && (a.cross(b).norm() > TURN * size || a.dot(b) < 0.0)
}

/// True when the tangents on both sides of a point differ, in the direction `d`.
fn turn_across(surface: &dyn Surface<f64>, w: [f64; 2], d: [f64; 2]) -> bool {
    let tangent = |h: f64| {
        let jet = surface.jet(w[0] + d[0] * h, w[1] + d[1] * h, Order::First);
        jet.u * d[0] + jet.v * d[1]
    };
    differ((tangent(-ASIDE), tangent(ASIDE)))
}

/// True when the surface has a sharp edge at a point: the normals about it differ.
pub(crate) fn is_creased(surface: &dyn Surface<f64>, w: [f64; 2]) -> bool {
    let normals = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
        .map(|[du, dv]| surface.jet(w[0] + du * ASIDE, w[1] + dv * ASIDE, Order::First).normal());
    (0..4).any(|k| differ((normals[k], normals[(k + 1) % 4])))
}

/// True when the tangents across a line jump somewhere on it.
fn turns_along(surface: &dyn Surface<f64>, path: &[[f64; 2]]) -> bool {
    let last = path.len() - 1;
    (1..=TRIALS).any(|i| {
        let k = (i * last / (TRIALS + 1)).clamp(1, last.max(2) - 1).min(last);
        let (a, b) = (path[k.saturating_sub(1)], path[(k + 1).min(last)]);
        let d = [-(b[1] - a[1]), b[0] - a[0]];
        let size = (d[0] * d[0] + d[1] * d[1]).sqrt();
        size > 0.0 && turn_across(surface, path[k], d.map(|x| x / size))
    })
}

/// The edge on which a point is, and its parameter there; `None` inside and at corners.
fn edge_at([u, v]: [f64; 2]) -> Option<(u8, f64)> {
    let sides = [(v, 0.0, u), (u, 1.0, v), (v, 1.0, u), (u, 0.0, v)];
    let k = sides.iter().position(|(across, end, _)| across == end)?;
    let along = sides[k].2;
    (along > SAME_LINE && along < 1.0 - SAME_LINE).then_some((k as u8, along))
}

/// An edge of a grid of samples: from node (i, j) along u or v.
type SampleEdge = (usize, usize, bool);

/// Places of an inner plane at a grid of points of the part.
struct SampleGrid {
    places: Vec<[f64; 2]>,
}

/// The positions of samples, 0 and 1 included; the others are at no usual fraction.
fn position(k: usize) -> f64 {
    match k {
        0 => 0.0,
        STEPS => 1.0,
        k => (k as f64 - 0.019_3) / STEPS as f64,
    }
}

impl SampleGrid {
    fn new(plane: &InnerPlane<'_>) -> Self {
        let nodes = (0..=STEPS).flat_map(|i| (0..=STEPS).map(move |j| [i, j]));
        Self { places: nodes.map(|node| (plane.place)(node.map(position))).collect() }
    }

    fn range(&self, axis: usize) -> (f64, f64) {
        let all = self.places.iter().map(|w| w[axis]);
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
    }

    /// True for nodes below a line. One on the border that is on the line belongs to the side of its neighbour inside, so
    /// that a line along the border does not cross it.
    fn below(&self, axis: usize, at: f64) -> Vec<bool> {
        let value = |i: usize, j: usize| self.places[i * (STEPS + 1) + j][axis] - at;
        let inside = |k: usize| k.clamp(1, STEPS - 1);
        let nodes = (0..=STEPS).flat_map(|i| (0..=STEPS).map(move |j| (i, j)));
        let of = |(i, j)| {
            let here = value(i, j);
            if here.abs() > ASIDE { here < 0.0 } else { value(inside(i), inside(j)) < 0.0 }
        };
        nodes.map(of).collect()
    }

    /// The lines on which a coordinate of the plane has a value, each from border to border, and a point of one that is
    /// not.
    fn chains(
        &self,
        plane: &InnerPlane<'_>,
        axis: usize,
        at: f64,
    ) -> (Vec<Vec<[f64; 2]>>, Option<[f64; 2]>) {
        let below = self.below(axis, at);
        let side = |i: usize, j: usize| below[i * (STEPS + 1) + j];
        let mut crossings: BTreeMap<SampleEdge, [f64; 2]> = BTreeMap::new();
        for (i, j) in (0..=STEPS).flat_map(|i| (0..=STEPS).map(move |j| (i, j))) {
            for (along_u, next) in [(true, [i + 1, j]), (false, [i, j + 1])] {
                if next[0] > STEPS || next[1] > STEPS || side(i, j) == side(next[0], next[1]) {
                    continue;
                }
                let [a, b] = [[i, j], next].map(|n| n.map(position));
                let place = |t: f64| if along_u { [t, a[1]] } else { [a[0], t] };
                let k = usize::from(!along_u);
                let beyond = |t: f64| (plane.place)(place(t))[axis] - at;
                // Without a change of sign one end is on the line.
                let t = find_root(beyond, a[k], b[k]).unwrap_or_else(|_| {
                    if beyond(a[k]).abs() < beyond(b[k]).abs() { a[k] } else { b[k] }
                });
                crossings.insert((i, j, along_u), place(t));
            }
        }
        linked(&crossings)
    }
}

/// Crossings of grid edges as chains from border to border, and a point of what is none.
fn linked(crossings: &BTreeMap<SampleEdge, [f64; 2]>) -> (Vec<Vec<[f64; 2]>>, Option<[f64; 2]>) {
    // The cells beside an edge, by their lowest node.
    let cells = |&(i, j, along_u): &SampleEdge| {
        let before = if along_u { (i, j.wrapping_sub(1)) } else { (i.wrapping_sub(1), j) };
        [before, (i, j)].into_iter().filter(|&(i, j)| i < STEPS && j < STEPS)
    };
    let of_cell = |(i, j): (usize, usize)| {
        let edges = [(i, j, true), (i, j + 1, true), (i, j, false), (i + 1, j, false)];
        edges.into_iter().filter(move |e| crossings.contains_key(e))
    };
    let (mut chains, mut lost) = (Vec::new(), None);
    let mut seen: HashSet<SampleEdge> = HashSet::new();
    for first in crossings.keys().filter(|e| cells(e).count() == 1) {
        if !seen.insert(*first) {
            continue;
        }
        let mut chain = vec![crossings[first]];
        let mut cell = cells(first).next();
        while let Some(here) = cell {
            // Two lines in a cell are too near to be distinguished.
            if of_cell(here).count() != 2 {
                lost = lost.or(chain.last().copied());
                break;
            }
            let Some(next) = of_cell(here).find(|e| !seen.contains(e)) else { break };
            seen.insert(next);
            chain.push(crossings[&next]);
            cell = cells(&next).find(|c| *c != here);
        }
        chain.dedup();
        if cell.is_none() && chain.len() > 1 {
            chains.push(chain);
        }
    }
    let left = crossings.iter().find(|(e, _)| !seen.contains(*e)).map(|(_, w)| *w);
    (chains, lost.or(left))
}
