//! Intersections of a surface with a plane or another surface: marching along them.
//!
//! A point of the intersection has the unknowns (u, v) on the first surface and, on a second
//! surface, (p, r). A step goes along the tangent n1 x n2 and is corrected by Newton's method in
//! the plane across it. Branches end at the edges of the surfaces, or come back to their start.
//!
//! All branches are found from seeds: the pieces of both shapes are subdivided while their boxes
//! meet, until they bend by less than a twentieth of their size; Newton's method from the middle of
//! each pair that is left gives a seed, and every seed that no branch passes starts one. A branch
//! that crosses such a pair at an angle cannot be missed; a closed one smaller than the pieces, or a
//! mere touch, can.

use crate::implicit::solve;
use crate::newton::{OUTSIDE, Range, newton};
use crate::pieces::{Patch, meet, size_of};
use crate::tree::SurfaceTree;
use moldloft_num::{Box3, Field, Order, Plane, SurfJet, Surface, Vec3, slope_scale};

/// Unknowns of a point of an intersection: (u, v, p, r), the last two 0 for a plane.
pub type Unknowns = [f64; 4];

/// What the first surface is intersected with.
#[derive(Clone, Copy)]
pub enum Other<'a> {
    /// A plane.
    Plane(Plane<f64>),
    /// A surface.
    Surface(&'a dyn Surface<f64>),
    /// The zero set of an implicit function.
    Level(&'a dyn Field<f64>),
}

/// A surface and what it is intersected with.
#[derive(Clone, Copy)]
pub struct Crossing<'a> {
    /// The surface.
    pub first: &'a dyn Surface<f64>,
    /// The plane or the other surface.
    pub other: Other<'a>,
    /// The length that accuracies are shares of.
    pub size: f64,
}

/// A point of an intersection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// The unknowns.
    pub q: Unknowns,
    /// Their derivatives by the length along the branch.
    pub rate: Unknowns,
    /// Where it is.
    pub x: Vec3,
    /// The unit tangent of the branch.
    pub tangent: Vec3,
}

/// Why a branch ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// Unknown `k` reached `value`: an edge.
    Edge {
        /// Which unknown.
        unknown: usize,
        /// 0 or 1.
        value: f64,
    },
    /// It came back to its start.
    Closed,
    /// The surfaces touch there, so that it has no direction.
    Tangent,
    /// There were too many steps.
    Lost,
}

/// A connected part of an intersection.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// Points along it; of a closed one the last is the first again.
    pub stations: Vec<Station>,
    /// Why it ends, at its two ends.
    pub ends: [End; 2],
}

impl Branch {
    /// True when it comes back to its start.
    pub fn closed(&self) -> bool {
        self.ends[0] == End::Closed
    }
}

/// The most steps of a branch.
const MOST_STATIONS: usize = 20_000;

/// Cosine of the largest turn between neighbours: 0.2 rad.
const LARGEST_TURN: f64 = 0.98;

impl<'a> Crossing<'a> {
    /// A surface and a plane.
    pub fn with_plane(first: &'a dyn Surface<f64>, plane: Plane<f64>) -> Self {
        Self { first, other: Other::Plane(plane), size: size_by_samples(first) }
    }

    /// Two surfaces.
    pub fn with_surface(first: &'a dyn Surface<f64>, second: &'a dyn Surface<f64>) -> Self {
        let size = size_by_samples(first).min(size_by_samples(second));
        Self { first, other: Other::Surface(second), size }
    }

    /// A surface and the zero set of an implicit function.
    pub fn with_level(first: &'a dyn Surface<f64>, field: &'a dyn Field<f64>) -> Self {
        Self { first, other: Other::Level(field), size: size_by_samples(first) }
    }

    /// The number of unknowns.
    pub fn unknowns(&self) -> usize {
        match self.other {
            Other::Plane(_) | Other::Level(_) => 2,
            Other::Surface(_) => 4,
        }
    }

    /// The solution near `guess` with one more equation: `extra` gives its value, a length, and
    /// its derivatives by the unknowns, from the unknowns and the first surface's jet.
    fn solved(
        &self,
        guess: Unknowns,
        extra: impl Fn(Unknowns, &SurfJet<f64>) -> (f64, Unknowns),
    ) -> Option<Unknowns> {
        let wide = Range { low: -0.5, high: 1.5, step: 0.2 };
        match self.other {
            Other::Plane(plane) => {
                let walk = newton([guess[0], guess[1]], &[wide; 2], self.size, |[u, v]| {
                    let j = self.first.jet(u, v, Order::First);
                    let (e, de) = extra([u, v, 0.0, 0.0], &j);
                    let n = plane.normal;
                    ([plane.distance(j.p), e], [[n.dot(j.u), n.dot(j.v)], [de[0], de[1]]])
                });
                walk.found.then_some([walk.at[0], walk.at[1], 0.0, 0.0])
            }
            Other::Level(field) => {
                // As a length, by the gradient where the walk begins.
                let begin = self.first.jet(guess[0], guess[1], Order::Zero).p;
                let scale = slope_scale(field.value_and_gradient(begin).1);
                let walk = newton([guess[0], guess[1]], &[wide; 2], self.size, |[u, v]| {
                    let j = self.first.jet(u, v, Order::First);
                    let (e, de) = extra([u, v, 0.0, 0.0], &j);
                    let (f, g) = field.value_and_gradient(j.p);
                    let g = g * scale;
                    ([f * scale, e], [[g.dot(j.u), g.dot(j.v)], [de[0], de[1]]])
                });
                walk.found.then_some([walk.at[0], walk.at[1], 0.0, 0.0])
            }
            Other::Surface(second) => {
                let walk = newton(guess, &[wide; 4], self.size, |q| {
                    let j = self.first.jet(q[0], q[1], Order::First);
                    let k = second.jet(q[2], q[3], Order::First);
                    let (e, de) = extra(q, &j);
                    let r = (j.p - k.p).to_array();
                    let c = [j.u, j.v, -k.u, -k.v].map(Vec3::to_array);
                    let row = |a: usize| [c[0][a], c[1][a], c[2][a], c[3][a]];
                    ([r[0], r[1], r[2], e], [row(0), row(1), row(2), de])
                });
                walk.found.then_some(walk.at)
            }
        }
    }

    /// The point of the intersection in the plane through `x` across `d`, near `guess`.
    pub fn across(&self, guess: Unknowns, x: Vec3, d: Vec3) -> Option<Unknowns> {
        self.solved(guess, |_, j| (d.dot(j.p - x), [d.dot(j.u), d.dot(j.v), 0.0, 0.0]))
    }

    /// The point of the intersection at which unknown `k` has a value, near `guess`.
    pub fn at_line(&self, guess: Unknowns, k: usize, value: f64) -> Option<Unknowns> {
        let size = self.size;
        self.solved(guess, |q, _| {
            let mut d = [0.0; 4];
            d[k] = size;
            (size * (q[k] - value), d)
        })
    }

    fn normals(&self, q: Unknowns) -> (SurfJet<f64>, Option<SurfJet<f64>>, Vec3, Vec3) {
        let j = self.first.jet(q[0], q[1], Order::First);
        match self.other {
            Other::Plane(plane) => (j, None, j.normal(), plane.normal),
            Other::Level(field) => {
                let g = field.value_and_gradient(j.p).1;
                (j, None, j.normal(), g.normalized().unwrap_or_default())
            }
            Other::Surface(second) => {
                let k = second.jet(q[2], q[3], Order::First);
                (j, Some(k), j.normal(), k.normal())
            }
        }
    }

    /// The direction n1 x n2 at a point that need not lie on the intersection; its length is the
    /// sine of the angle between the shapes.
    pub fn direction(&self, q: Unknowns) -> Vec3 {
        let (_, _, a, b) = self.normals(q);
        a.cross(b)
    }

    /// The point with its tangent; `None` where the shapes are tangent.
    pub fn station(&self, q: Unknowns) -> Option<Station> {
        let (j, k, a, b) = self.normals(q);
        let d = a.cross(b);
        let sine = d.norm();
        if sine < 1e-7 {
            return None;
        }
        let tangent = d / sine;
        let along = |s: &SurfJet<f64>| {
            let m = [[s.u.norm_sq(), s.u.dot(s.v)], [s.u.dot(s.v), s.v.norm_sq()]];
            solve(&m, [tangent.dot(s.u), tangent.dot(s.v)])
        };
        let [u, v] = along(&j)?;
        let [p, r] = match k {
            Some(k) => along(&k)?,
            None => [0.0; 2],
        };
        Some(Station { q, rate: [u, v, p, r], x: j.p, tangent })
    }

    /// One way from a station until an edge, the start, or a place of contact.
    fn walk(&self, start: Station, sign: f64) -> (Vec<Station>, End) {
        let n = self.unknowns();
        let mut all = vec![start];
        let mut step = self.size / 48.0;
        while all.len() < MOST_STATIONS {
            let last = *all.last().expect("it begins with one");
            // Not more than a tenth of a surface at once.
            let fastest = last.rate[..n].iter().fold(0.0_f64, |a, r| a.max(r.abs()));
            step = step.min(0.1 / fastest);
            let tangent = last.tangent * sign;
            let guess: Unknowns = std::array::from_fn(|k| last.q[k] + sign * step * last.rate[k]);
            let next = self
                .across(guess, last.x + tangent * step, last.tangent)
                .and_then(|q| self.station(q))
                .filter(|s| {
                    s.tangent.dot(last.tangent) > LARGEST_TURN && s.x.distance(last.x) < 1.5 * step
                });
            let Some(next) = next else {
                step *= 0.5;
                if step < 1e-8 * self.size {
                    return (all, End::Tangent);
                }
                continue;
            };
            let out = |q: Unknowns| q[..n].iter().any(|x| *x < -1e-12 || *x > 1.0 + 1e-12);
            if out(next.q) {
                if let Some((station, end)) = self.edge_between(&last, &next) {
                    if station.x.distance(last.x) > 1e-12 * self.size {
                        all.push(station);
                    }
                    return (all, end);
                }
                step *= 0.5;
                if step < 1e-8 * self.size {
                    return (all, End::Lost);
                }
                continue;
            }
            if all.len() > 2 {
                let (before, after) = (
                    (last.x - start.x).dot(start.tangent) * sign,
                    (next.x - start.x).dot(start.tangent) * sign,
                );
                let near = start.x.distance(last.x) <= 1.01 * step;
                if before < 0.0 && after >= 0.0 && near && last.tangent.dot(start.tangent) > 0.5 {
                    let same = (0..n).all(|k| (last.q[k] - start.q[k]).abs() < 0.3);
                    if same {
                        all.push(start);
                        return (all, End::Closed);
                    }
                }
            }
            let turn = next.tangent.dot(last.tangent);
            all.push(next);
            if turn > 0.997 {
                step = (1.5 * step).min(self.size / 24.0);
            }
        }
        (all, End::Lost)
    }

    /// The first edge between two stations, the second of which is outside.
    fn edge_between(&self, a: &Station, b: &Station) -> Option<(Station, End)> {
        let n = self.unknowns();
        let mut best: Option<(f64, Station, End)> = None;
        for unknown in 0..n {
            for value in [0.0, 1.0] {
                let (p, q) = (a.q[unknown], b.q[unknown]);
                let beyond = if value == 0.0 { q < 0.0 } else { q > 1.0 };
                if !beyond {
                    continue;
                }
                let share = ((value - p) / (q - p)).clamp(0.0, 1.0);
                let guess = std::array::from_fn(|k| a.q[k] + share * (b.q[k] - a.q[k]));
                let Some(mut at) = self.at_line(guess, unknown, value) else { continue };
                at[unknown] = value;
                if at[..n].iter().any(|x| *x < -OUTSIDE || *x > 1.0 + OUTSIDE) {
                    continue;
                }
                let Some(station) = self.station(at) else { continue };
                if station.x.distance(a.x) > 2.0 * b.x.distance(a.x) {
                    continue;
                }
                if best.as_ref().is_none_or(|(s, ..)| share < *s) {
                    best = Some((share, station, End::Edge { unknown, value }));
                }
            }
        }
        best.map(|(_, station, end)| (station, end))
    }

    /// The whole branch through a point of the intersection, in the direction n1 x n2.
    pub fn branch(&self, seed: Unknowns) -> Option<Branch> {
        let start = self.station(seed)?;
        let (mut forward, end) = self.walk(start, 1.0);
        if end == End::Closed {
            return Some(Branch { stations: forward, ends: [End::Closed; 2] });
        }
        let (mut stations, begin) = self.walk(start, -1.0);
        stations.reverse();
        stations.extend(forward.drain(1..));
        Some(Branch { stations, ends: [begin, end] })
    }

    /// The point of the intersection near the place (u, v) of the first surface, in the plane
    /// through both normals there.
    pub fn near(&self, [u, v]: [f64; 2], second: Option<[f64; 2]>) -> Option<Unknowns> {
        let x = self.first.jet(u, v, Order::Zero).p;
        let [p, r] = match (self.other, second) {
            (Other::Plane(_) | Other::Level(_), _) => [0.0; 2],
            (_, Some(pr)) => pr,
            (Other::Surface(second), None) => crate::nearest_on_surface(second, x, None).at,
        };
        let guess = [u, v, p, r];
        let d = self.direction(guess).normalized()?;
        let q = self.across(guess, x, d)?;
        let n = self.unknowns();
        q[..n].iter().all(|x| *x >= -OUTSIDE && *x <= 1.0 + OUTSIDE).then_some(q)
    }

    /// True when the branch passes the point.
    pub fn passes(&self, branch: &Branch, q: Unknowns) -> bool {
        let x = self.first.jet(q[0], q[1], Order::Zero).p;
        branch.stations.windows(2).any(|pair| {
            let (a, b) = (&pair[0], &pair[1]);
            let chord = b.x - a.x;
            let length = chord.norm_sq();
            let share = (x - a.x).dot(chord) / length;
            if !(-0.05..=1.05).contains(&share) {
                return false;
            }
            let off = (x - a.x - chord * share).norm_sq();
            if off > 0.04 * length {
                return false;
            }
            // The branch's own point across from it.
            let guess = std::array::from_fn(|k| a.q[k] + share * (b.q[k] - a.q[k]));
            match self.across(guess, x, a.tangent) {
                Some(own) => {
                    let y = self.first.jet(own[0], own[1], Order::Zero).p;
                    y.distance(x) <= 1e-7 * self.size
                }
                None => off <= 1e-8 * length,
            }
        })
    }

    /// All branches, in the order of their seeds.
    pub fn branches(&self) -> Vec<Branch> {
        let first = SurfaceTree::new(self.first);
        match self.other {
            Other::Plane(_) | Other::Level(_) => self.branches_in(&first, None),
            Other::Surface(second) => self.branches_in(&first, Some(&SurfaceTree::new(second))),
        }
    }

    /// All branches of shapes that were cut up before.
    pub fn branches_in(&self, first: &SurfaceTree, second: Option<&SurfaceTree>) -> Vec<Branch> {
        let mut found: Vec<Branch> = Vec::new();
        let mut pairs = 0usize;
        let mut stack: Vec<(Patch, Option<Patch>)> = Vec::new();
        for patch in &first.patches {
            match (self.other, second) {
                (Other::Surface(_), Some(second)) => {
                    let near = second.meeting(&patch.bounds());
                    stack.extend(
                        near.into_iter().map(|k| (*patch, Some(second.patches[k as usize]))),
                    );
                }
                _ => stack.push((*patch, None)),
            }
            while let Some((a, b)) = stack.pop() {
                pairs += 1;
                if pairs > 200_000 || found.len() > 1_000 {
                    return found;
                }
                if !self.may_meet(&a, b.as_ref()) {
                    continue;
                }
                let (la, lb) = (a.lengths(), b.map_or([0.0; 2], |b| b.lengths()));
                let flat = |p: &Patch, l: [f64; 2]| p.bend() <= 0.05 * l[0].max(l[1]);
                let small = la[0].max(la[1]) < 1e-4 * self.size;
                let even = self.evenly_met(&a, la[0].max(la[1]));
                if flat(&a, la) && even && b.as_ref().is_none_or(|b| flat(b, lb)) || small {
                    if let Some(q) = self.seed(&a, b.as_ref())
                        && !found.iter().any(|branch| self.passes(branch, q))
                    {
                        found.extend(self.branch(q).filter(|b| b.stations.len() > 1));
                    }
                    continue;
                }
                let longest = la[0].max(la[1]).max(lb[0]).max(lb[1]);
                match b {
                    Some(b) if lb[0].max(lb[1]) == longest && !flat(&b, lb) || flat(&a, la) => {
                        let halves = b.halves(usize::from(lb[1] > lb[0]));
                        stack.extend(halves.map(|half| (a, Some(half))));
                    }
                    _ => {
                        let halves = a.halves(usize::from(la[1] > la[0]));
                        stack.extend(halves.map(|half| (half, b)));
                    }
                }
            }
        }
        found
    }

    /// True when a level has nearly one normal over a patch of that length, so that it crosses it once.
    fn evenly_met(&self, a: &Patch, length: f64) -> bool {
        let Other::Level(field) = self.other else { return true };
        let [u, v] = a.middle();
        let (_, g, h) = field.second_order(self.first.jet(u, v, Order::Zero).p);
        let bend = h.iter().map(|row| row.norm_sq()).sum::<f64>();
        bend * length * length <= 0.06 * g.norm_sq()
    }

    fn may_meet(&self, a: &Patch, b: Option<&Patch>) -> bool {
        match (self.other, b) {
            (Other::Level(field), _) => {
                let mut around = a.bounds();
                let slack = Vec3::of(a.slack, a.slack, a.slack);
                around.low -= slack;
                around.high += slack;
                field.bounds(&around).is_none_or(|[low, high]| low <= 0.0 && high >= 0.0)
            }
            (Other::Plane(plane), _) => {
                let mut low = f64::INFINITY;
                let mut high = f64::NEG_INFINITY;
                for p in &a.net {
                    let d = plane.distance(*p);
                    (low, high) = (low.min(d), high.max(d));
                }
                low <= a.slack && high >= -a.slack
            }
            (_, Some(b)) => meet(&a.bounds(), &b.bounds()),
            _ => false,
        }
    }

    /// A point of the intersection in or near the pair.
    fn seed(&self, a: &Patch, b: Option<&Patch>) -> Option<Unknowns> {
        let [u, v] = a.middle();
        let [p, r] = b.map_or([0.0; 2], Patch::middle);
        let guess = [u, v, p, r];
        let d = self.direction(guess).normalized()?;
        let x = self.first.jet(u, v, Order::Zero).p;
        let q = self.across(guess, x, d)?;
        let inside = |q: f64, [a, b]: [f64; 2]| {
            let reach = 0.5 * (b - a);
            q >= (a - reach).max(-OUTSIDE) && q <= (b + reach).min(1.0 + OUTSIDE)
        };
        let near = inside(q[0], a.uv[0])
            && inside(q[1], a.uv[1])
            && b.is_none_or(|b| inside(q[2], b.uv[0]) && inside(q[3], b.uv[1]));
        near.then_some(q)
    }
}

fn size_by_samples(surface: &dyn Surface<f64>) -> f64 {
    let ts = [0.0, 0.25, 0.5, 0.75, 1.0];
    let mut x = [Vec3::zero(); 25];
    surface.grid(&ts, &ts, &mut x, None);
    size_of(&Box3::around(x))
}
