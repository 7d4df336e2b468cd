//! All branches of an intersection.
//!
//! `cells of both shapes -> pairs whose bounds meet -> seeds that no branch passes -> branches`
//!
//! Each shape is cut into nearly flat cells with bounds of how they bend (see `cells`), in trees of
//! boxes. A pair of cells is left out only when their bounds are apart. In a pair whose normals
//! cannot become parallel the shapes meet in one line at most; other pairs are halved until they
//! are so, or smaller than [`SMALLEST`] of the size. Each pair that no branch found so far passes
//! through gives a start to Newton's method, and what it finds starts a branch.
//!
//! So, while [`Branches::complete`] is true, every branch is found that somewhere crosses at an
//! angle larger than the shapes turn within [`SMALLEST`] of the size and that is longer than that,
//! closed or from edge to edge. Missed may be: closed branches smaller than that; one of two
//! branches that run nearer to each other than that all along. On shapes that are no cubic pieces
//! the bounds are measured and not proved (see [`crate::pieces`]). Where the shapes touch without
//! crossing there is no branch, but a [`Touch`].

use crate::cells::{Cells, Flat, LEAF, Polynomials};
use crate::implicit::solve;
use crate::march::{Branch, Crossing, Other, Station, TANGENT, Unknowns};
use crate::newton::OUTSIDE;
use crate::pieces::meet;
use moldloft_num::{Box3, Field, Order, Plane, Surface, Vec3, slope_scale};
use smallvec::SmallVec;

/// Branches at least this long, as a share of the size, are found.
pub const SMALLEST: f64 = 0.02;

/// Pairs that a search looks at before it gives up, as it does where shapes coincide.
const MOST_PAIRS: usize = 400_000;

/// More branches than this are not looked for.
const MOST_BRANCHES: usize = 2_000;

/// Sides of the grid of bins in which stretches of branches are looked up.
const BINS: usize = 48;

/// A touch is a gap of less than this share of the size.
const TOUCH: f64 = 1e-9;

/// Steps towards a touch.
const MOST_STEPS: usize = 12;

/// With more touches than this the shapes touch along a line, or are the same.
const MOST_TOUCHES: usize = 64;

/// A place where two shapes touch without crossing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The unknowns there.
    pub q: Unknowns,
    /// Where it is.
    pub x: Vec3,
}

/// All branches of an intersection.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Branches {
    /// The branches, in the order in which they were found, which depends on the shapes only.
    pub branches: Vec<Branch>,
    /// Places of contact without a branch.
    pub touches: Vec<Touch>,
    /// False when the search ran into its limit, as it does where shapes coincide or touch along a
    /// line.
    pub complete: bool,
    /// The length from which on branches are found.
    pub smallest: f64,
}

/// A cell or a part of one.
#[derive(Clone, Copy)]
struct Part {
    flat: Flat,
    piece: u32,
    middle: [f64; 2],
    half: [f64; 2],
    /// Bounds of third derivatives.
    far: [f64; 4],
}

impl Part {
    fn of(cells: &Cells, k: usize) -> Self {
        let bent = &cells.bents[k];
        Self {
            flat: cells.flats[k],
            piece: bent.piece,
            middle: bent.middle,
            half: bent.half,
            far: bent.far,
        }
    }

    /// Lengths of the sides, roughly.
    fn lengths(&self) -> [f64; 2] {
        [2.0 * self.flat.a.norm(), 2.0 * self.flat.b.norm()]
    }

    /// Both halves along the longer side.
    fn halves(&self, cells: &Cells) -> [Self; 2] {
        let [la, lb] = self.lengths();
        let axis = usize::from(lb > la);
        let mut half = self.half;
        half[axis] *= 0.5;
        let powers = if axis == 0 { [8.0, 4.0, 2.0, 1.0] } else { [1.0, 2.0, 4.0, 8.0] };
        let far: [f64; 4] = std::array::from_fn(|k| self.far[k] / powers[k]);
        let piece = &cells.pieces[self.piece as usize];
        [-1.0, 1.0].map(|side| {
            let mut middle = self.middle;
            middle[axis] += side * half[axis];
            let [c, s, t, ss, st, tt] = piece.jet(middle[0], middle[1]);
            let [h, k] = half;
            let (a, b) = (s * h, t * k);
            let bend = 0.5 * (ss.norm() * h * h + tt.norm() * k * k)
                + st.norm() * h * k
                + (far[0] + 3.0 * (far[1] + far[2]) + far[3]) / 6.0
                + piece.slack;
            let products = [a.norm_sq(), a.dot(b), b.norm_sq()];
            Self { flat: Flat { c, a, b, products, bend }, middle, half, far, ..*self }
        })
    }

    /// The surface's parameters at the middle, and from and to.
    fn place(&self, cells: &Cells) -> ([f64; 2], [[f64; 2]; 2]) {
        let piece = &cells.pieces[self.piece as usize];
        let low = piece.place(self.middle[0] - self.half[0], self.middle[1] - self.half[1]);
        let high = piece.place(self.middle[0] + self.half[0], self.middle[1] + self.half[1]);
        (piece.place(self.middle[0], self.middle[1]), [[low[0], high[0]], [low[1], high[1]]])
    }
}

/// A flat's unit normal, and a bound of how far the normal of its cell turns away from it: tangents
/// change by twice the bend at most.
fn normal(flat: &Flat) -> (Vec3, f64) {
    let n = flat.a.cross(flat.b);
    let area = n.norm();
    if area == 0.0 {
        return (Vec3::zero(), f64::INFINITY);
    }
    (n / area, 2.0 * flat.bend * (flat.a.norm() + flat.b.norm()) / area)
}

/// True when two cells certainly have no common point.
fn apart(a: &Flat, b: &Flat) -> bool {
    let d = b.c - a.c;
    let bend = a.bend + b.bend;
    let reach =
        |k: fn(&Vec3) -> f64| k(&a.a).abs() + k(&a.b).abs() + k(&b.a).abs() + k(&b.b).abs() + bend;
    if d.x.abs() > reach(|v| v.x) || d.y.abs() > reach(|v| v.y) || d.z.abs() > reach(|v| v.z) {
        return true;
    }
    let beyond = |p: &Flat, q: &Flat| {
        let n = p.a.cross(p.b);
        n.dot(d).abs() - n.dot(q.a).abs() - n.dot(q.b).abs() > bend * n.norm()
    };
    beyond(a, b) || beyond(b, a)
}

/// A surface cut up for intersections.
#[derive(Clone, Debug)]
pub struct CutSurface(Cells);

impl CutSurface {
    /// Cuts a surface up.
    pub fn new(surface: &dyn Surface<f64>) -> Self {
        Self(Cells::coarse(surface))
    }
}

/// A search under way.
struct Finder<'a> {
    crossing: Crossing<'a>,
    first: &'a Cells,
    second: Option<&'a Cells>,
    /// Stretches of branches by the place of their first unknowns.
    bins: Vec<SmallVec<[(u32, u32); 4]>>,
    found: Branches,
    pairs: usize,
}

impl Crossing<'_> {
    /// All branches; see the module for what is claimed.
    pub fn branches(&self) -> Branches {
        let first = CutSurface::new(self.first);
        match self.other {
            Other::Plane(_) | Other::Level(_) => self.branches_in(&first, None),
            Other::Surface(second) => self.branches_in(&first, Some(&CutSurface::new(second))),
        }
    }

    /// All branches of surfaces that were cut up before: the crossing's first, and its second unless
    /// that is a plane.
    pub fn branches_in(&self, first: &CutSurface, second: Option<&CutSurface>) -> Branches {
        let (first, second) = (&first.0, second.map(|s| &s.0));
        // Where the pieces are the surface itself they are the quicker to evaluate.
        let quick = [first.polynomials(), second.and_then(Cells::polynomials)];
        fn chosen<'b>(
            quick: &'b Option<Polynomials<'b>>,
            own: &'b dyn Surface<f64>,
        ) -> &'b dyn Surface<f64> {
            match quick {
                Some(quick) => quick,
                None => own,
            }
        }
        let other = match self.other {
            Other::Plane(plane) => Other::Plane(plane),
            Other::Level(field) => Other::Level(field),
            Other::Surface(own) => Other::Surface(chosen(&quick[1], own)),
        };
        let crossing = Crossing { first: chosen(&quick[0], self.first), other, ..*self };
        let mut finder = Finder {
            crossing,
            first,
            second,
            bins: vec![SmallVec::new(); BINS * BINS],
            found: Branches {
                complete: true,
                smallest: SMALLEST * self.size,
                ..Branches::default()
            },
            pairs: 0,
        };
        match other {
            Other::Plane(plane) => finder.with_plane(&plane),
            Other::Level(field) => finder.with_level(field),
            Other::Surface(_) => finder.with_surface(),
        }
        finder.found
    }
}

/// The root of a tree and its box.
fn root(cells: &Cells) -> (u32, Box3) {
    (if cells.forks.is_empty() { LEAF } else { 0 }, cells.tree.bounds)
}

impl Finder<'_> {
    /// Counts a pair; true when there were too many.
    fn exhausted(&mut self) -> bool {
        self.pairs += 1;
        if self.pairs > MOST_PAIRS || self.found.branches.len() > MOST_BRANCHES {
            self.found.complete = false;
        }
        !self.found.complete
    }

    fn with_plane(&mut self, plane: &Plane<f64>) {
        let n = plane.normal;
        let cells = self.first;
        let crosses = |b: &Box3| {
            let half = (b.high - b.low) * 0.5;
            let reach = n.x.abs() * half.x + n.y.abs() * half.y + n.z.abs() * half.z;
            plane.distance(b.centre()).abs() <= reach
        };
        let (top, bounds) = root(cells);
        let mut stack = Vec::new();
        if crosses(&bounds) {
            stack.push(top);
        }
        let mut parts = Vec::new();
        while let Some(at) = stack.pop() {
            if at & LEAF == 0 {
                let fork = &cells.forks[at as usize];
                for k in [1, 0] {
                    if crosses(&fork.bounds[k]) {
                        stack.push(fork.below[k]);
                    }
                }
                continue;
            }
            parts.push(Part::of(cells, (at & !LEAF) as usize));
            while let Some(part) = parts.pop() {
                let flat = &part.flat;
                let reach = n.dot(flat.a).abs() + n.dot(flat.b).abs() + flat.bend;
                if plane.distance(flat.c).abs() > reach {
                    continue;
                }
                if self.exhausted() {
                    return;
                }
                let (m, turn) = normal(flat);
                let [la, lb] = part.lengths();
                let simple = m.cross(n).norm() > turn;
                if simple || la.max(lb) <= self.found.smallest {
                    self.start(&part, None, simple);
                } else {
                    parts.extend(part.halves(cells));
                }
            }
        }
    }

    fn with_level(&mut self, field: &dyn Field<f64>) {
        let cells = self.first;
        let crosses =
            |b: &Box3| field.bounds(b).is_none_or(|[low, high]| low <= 0.0 && high >= 0.0);
        let (top, bounds) = root(cells);
        let mut stack = Vec::new();
        if crosses(&bounds) {
            stack.push(top);
        }
        let mut parts = Vec::new();
        while let Some(at) = stack.pop() {
            if at & LEAF == 0 {
                let fork = &cells.forks[at as usize];
                for k in [1, 0] {
                    if crosses(&fork.bounds[k]) {
                        stack.push(fork.below[k]);
                    }
                }
                continue;
            }
            parts.push(Part::of(cells, (at & !LEAF) as usize));
            while let Some(part) = parts.pop() {
                let flat = &part.flat;
                let reach = |k: fn(&Vec3) -> f64| k(&flat.a).abs() + k(&flat.b).abs() + flat.bend;
                let half = Vec3::of(reach(|v| v.x), reach(|v| v.y), reach(|v| v.z));
                if !crosses(&Box3 { low: flat.c - half, high: flat.c + half }) {
                    continue;
                }
                if self.exhausted() {
                    return;
                }
                // How far the level's normal turns over the cell, by its second derivatives.
                let (_, g, h) = field.second_order(flat.c);
                let steep = g.norm();
                let bent = h.iter().map(|row| row.norm_sq()).sum::<f64>().sqrt();
                let (m, turn) = normal(flat);
                let all = turn + bent * half.norm() / steep;
                let simple = m.cross(g).norm() > all * steep;
                let [la, lb] = part.lengths();
                if simple || la.max(lb) <= self.found.smallest {
                    self.start(&part, None, simple);
                } else {
                    parts.extend(part.halves(cells));
                }
            }
        }
    }

    fn with_surface(&mut self) {
        let (first, Some(second)) = (self.first, self.second) else { return };
        let mut stack = vec![(root(first), root(second))];
        let mut parts: Vec<(Part, Part)> = Vec::new();
        while let Some(((a, box_a), (b, box_b))) = stack.pop() {
            if !meet(&box_a, &box_b) {
                continue;
            }
            if a & b & LEAF == 0 {
                let below = |cells: &Cells, at: u32| {
                    let fork = &cells.forks[at as usize];
                    [1, 0].map(|k| (fork.below[k], fork.bounds[k]))
                };
                let larger = b & LEAF != 0 || box_a.diagonal() >= box_b.diagonal();
                if a & LEAF == 0 && larger {
                    stack.extend(below(first, a).map(|c| (c, (b, box_b))));
                } else {
                    stack.extend(below(second, b).map(|c| ((a, box_a), c)));
                }
                continue;
            }
            let (a, b) = ((a & !LEAF) as usize, (b & !LEAF) as usize);
            if apart(&first.flats[a], &second.flats[b]) {
                continue;
            }
            parts.push((Part::of(first, a), Part::of(second, b)));
            while let Some((p, q)) = parts.pop() {
                if apart(&p.flat, &q.flat) {
                    continue;
                }
                if self.exhausted() {
                    return;
                }
                let ((m, turn_m), (n, turn_n)) = (normal(&p.flat), normal(&q.flat));
                let simple = m.cross(n).norm() > turn_m + turn_n;
                let longest = |p: &Part| p.lengths()[0].max(p.lengths()[1]);
                let (lp, lq) = (longest(&p), longest(&q));
                if simple || lp.max(lq) <= self.found.smallest {
                    self.start(&p, Some(&q), simple);
                } else if lp >= lq {
                    parts.extend(p.halves(first).map(|half| (half, q)));
                } else {
                    parts.extend(q.halves(second).map(|half| (p, half)));
                }
            }
        }
    }

    /// Starts a branch from a pair unless one passes there.
    fn start(&mut self, a: &Part, b: Option<&Part>, simple: bool) {
        let ((uv, [us, vs]), second) = (a.place(self.first), b.zip(self.second));
        let (pr, [ps, rs]) = second.map_or(([0.0; 2], [[0.0; 2]; 2]), |(b, cells)| b.place(cells));
        let ranges = [us, vs, ps, rs];
        let mut guess = [uv[0], uv[1], pr[0], pr[1]];
        let mut x = b.map_or(a.flat.c, |b| (a.flat.c + b.flat.c) * 0.5);
        match self.straight(a, b, x) {
            // The planes of the cells do not meet where both cells are.
            Straight::Beside => return,
            Straight::Line { at, reach, places } => {
                if self.covered(at, reach, &ranges) {
                    return;
                }
                x = at;
                for k in 0..self.crossing.unknowns() {
                    let [low, high] = ranges[k];
                    guess[k] = (guess[k] + 0.5 * (high - low) * places[k]).clamp(low, high);
                }
            }
            Straight::Parallel => {}
        }
        let Some(q) = self.seed(guess, x, &ranges, simple) else {
            if !simple {
                self.touch(guess, &ranges);
            }
            return;
        };
        if self.passed(q) {
            return;
        }
        if self.crossing.direction(q).norm() < TANGENT {
            return self.touch(q, &ranges);
        }
        let Some(branch) = self.crossing.branch(q).filter(|b| b.stations.len() > 1) else {
            return;
        };
        let number = self.found.branches.len() as u32;
        for (k, pair) in branch.stations.windows(2).enumerate() {
            let (p, q) = (&pair[0].q, &pair[1].q);
            if (0..2).any(|i| (p[i] - q[i]).abs() > 0.5) {
                continue;
            }
            let [us, vs] = [0, 1].map(|i| bins_between(p[i], q[i]));
            for i in us.clone() {
                for j in vs.clone() {
                    self.bins[i * BINS + j].push((number, k as u32));
                }
            }
        }
        self.found.branches.push(branch);
    }

    /// Where the planes of a pair's cells meet, near both.
    fn straight(&self, a: &Part, b: Option<&Part>, near: Vec3) -> Straight {
        let (m, _) = normal(&a.flat);
        let (n, point, bend) = match (b, self.crossing.other) {
            (Some(b), _) => (normal(&b.flat).0, b.flat.c, a.flat.bend + b.flat.bend),
            (None, Other::Plane(plane)) => (plane.normal, plane.point, a.flat.bend),
            (None, Other::Level(field)) => {
                // Its tangent plane near the cell, and how far it may bend away from it there.
                let (f, g, h) = field.second_order(a.flat.c);
                let Some(n) = g.normalized() else { return Straight::Parallel };
                let half = 0.5 * (a.lengths()[0] + a.lengths()[1]);
                let bent = h.iter().map(|row| row.norm_sq()).sum::<f64>().sqrt() / g.norm();
                (n, a.flat.c - n * (f / g.norm()), a.flat.bend + bent * half * half)
            }
            _ => return Straight::Parallel,
        };
        let d = m.cross(n);
        let sine = d.norm();
        if sine < 0.02 {
            return Straight::Parallel;
        }
        let d = d / sine;
        // From `near` to the line: a combination of both normals.
        let (e, f, cosine) = (m.dot(a.flat.c - near), n.dot(point - near), m.dot(n));
        let det = sine * sine;
        let at = near + m * ((e - cosine * f) / det) + n * ((f - cosine * e) / det);
        let reach = bend / sine;
        // The stretch of it over both cells, with what they bend as a margin.
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut clip = |part: &Part| -> [[f64; 2]; 2] {
            let flat = &part.flat;
            let [aa, ab, bb] = flat.products;
            let det = aa * bb - ab * ab;
            let dual = [(flat.a * bb - flat.b * ab) / det, (flat.b * aa - flat.a * ab) / det];
            dual.map(|w| {
                let (place, rate) = (w.dot(at - flat.c), w.dot(d));
                let limit = 1.0 + 2.0 * reach * w.norm();
                let (p, q) = ((-limit - place) / rate, (limit - place) / rate);
                if rate.abs() > 1e-9 * w.norm() {
                    low = low.max(p.min(q));
                    high = high.min(p.max(q));
                } else if place.abs() > limit {
                    high = f64::NEG_INFINITY;
                }
                [place, rate]
            })
        };
        let first = clip(a);
        let second = b.map_or([[0.0; 2]; 2], &mut clip);
        if low > high {
            return Straight::Beside;
        }
        let middle = if (low + high).is_finite() { 0.5 * (low + high) } else { 0.0 };
        let place = |[p, r]: [f64; 2]| p + r * middle;
        let [s, t] = first.map(place);
        let [k, l] = second.map(place);
        Straight::Line { at: at + d * middle, reach, places: [s, t, k, l] }
    }

    /// True when a stretch of a branch passes within `reach` of a place of the cell with these
    /// parameters.
    fn covered(&self, x: Vec3, reach: f64, ranges: &[[f64; 2]; 4]) -> bool {
        let [us, vs] = [0, 1].map(|i| bins_between(ranges[i][0], ranges[i][1]));
        us.flat_map(|i| vs.clone().map(move |j| i * BINS + j)).any(|bin| {
            self.bins[bin].iter().any(|&(branch, k)| {
                let stations = &self.found.branches[branch as usize].stations;
                let (off, bow) = off_chord(&stations[k as usize], &stations[k as usize + 1], x);
                off <= 2.0 * reach + bow
            })
        })
    }

    /// A point of the intersection in or near the pair.
    fn seed(
        &self,
        guess: Unknowns,
        x: Vec3,
        ranges: &[[f64; 2]; 4],
        simple: bool,
    ) -> Option<Unknowns> {
        let crossing = &self.crossing;
        let d = crossing.direction(guess).normalized()?;
        let q = match crossing.settled(guess, x, d) {
            Some(station) => station.q,
            None if simple => crossing.across(guess, x, d)?,
            None => return None,
        };
        let n = crossing.unknowns();
        (0..n)
            .all(|k| {
                let [low, high] = ranges[k];
                let reach = 0.5 * (high - low);
                q[k] >= (low - reach).max(-OUTSIDE) && q[k] <= (high + reach).min(1.0 + OUTSIDE)
            })
            .then_some(q)
    }

    /// True when a branch that was found passes the point.
    fn passed(&self, q: Unknowns) -> bool {
        let x = self.crossing.first.jet(q[0], q[1], Order::Zero).p;
        let near = |i: usize| bins_between(q[i] - 0.5 / BINS as f64, q[i] + 0.5 / BINS as f64);
        let vs = near(1);
        near(0).flat_map(|i| vs.clone().map(move |j| i * BINS + j)).any(|bin| {
            self.bins[bin].iter().any(|&(branch, k)| {
                let stations = &self.found.branches[branch as usize].stations;
                let (a, b) = (&stations[k as usize], &stations[k as usize + 1]);
                let (off, _) = off_chord(a, b, x);
                off <= 0.2 * a.x.distance(b.x) + 1e-6 * self.crossing.size
                    && match self.crossing.between(a, b, x) {
                        Some(y) => y.distance(x) <= 1e-7 * self.crossing.size,
                        None => false,
                    }
            })
        })
    }

    /// Looks for a place of contact near a pair that is nearly parallel.
    fn touch(&mut self, guess: Unknowns, ranges: &[[f64; 2]; 4]) {
        let Some(touch) = self.crossing.contact(guess, ranges) else { return };
        let size = self.crossing.size;
        let known = self.found.touches.iter().any(|t| t.x.distance(touch.x) < 1e-4 * size);
        if !known && !self.passed(touch.q) {
            self.found.touches.push(touch);
            self.found.complete &= self.found.touches.len() < MOST_TOUCHES;
        }
    }
}

/// How far a place is from the chord of two stations, and how far the branch bows away from it: an
/// eighth of its turn.
fn off_chord(a: &Station, b: &Station, x: Vec3) -> (f64, f64) {
    let chord = b.x - a.x;
    let share = ((x - a.x).dot(chord) / chord.norm_sq()).clamp(0.0, 1.0);
    let bow = 0.125 * chord.norm() * (a.tangent - b.tangent).norm();
    (x.distance(a.x + chord * share), bow)
}

/// What the planes of a pair of cells say.
enum Straight {
    /// They do not meet where both cells are.
    Beside,
    /// They meet in a line, in the middle of whose stretch over both cells is `at`; the shapes meet
    /// within `reach` of it. Places on the cells in their own parameters from -1 to 1.
    Line { at: Vec3, reach: f64, places: [f64; 4] },
    /// They are parallel, or nearly so.
    Parallel,
}

/// The bins that a stretch of a parameter lies in.
fn bins_between(a: f64, b: f64) -> std::ops::Range<usize> {
    let bin = |x: f64| ((x * BINS as f64) as usize).min(BINS - 1);
    bin(a.min(b))..bin(a.max(b)) + 1
}

impl Crossing<'_> {
    /// The place near `guess` where the shapes have one tangent plane and one is straight above the
    /// other, if they touch there.
    fn contact(&self, guess: Unknowns, ranges: &[[f64; 2]; 4]) -> Option<Touch> {
        let n = self.unknowns();
        let size = self.size;
        let mut q = guess;
        for _ in 0..MOST_STEPS {
            let (residual, matrix) = self.parallel(q);
            let off = residual.iter().fold(0.0_f64, |a, r| a.max(r.abs()));
            if off <= 1e-13 * size {
                let x = self.first.jet(q[0], q[1], Order::Zero).p;
                let gap = match self.other {
                    Other::Plane(plane) => plane.distance(x).abs(),
                    Other::Level(field) => {
                        let (f, g) = field.value_and_gradient(x);
                        (f * slope_scale(g)).abs()
                    }
                    Other::Surface(second) => second.jet(q[2], q[3], Order::Zero).p.distance(x),
                };
                return (gap <= TOUCH * size).then_some(Touch { q, x });
            }
            let step = if n == 2 {
                let [a, b, ..] = matrix;
                let [u, v] = solve(&[[a[0], a[1]], [b[0], b[1]]], [residual[0], residual[1]])?;
                [u, v, 0.0, 0.0]
            } else {
                solve(&matrix, residual)?
            };
            q = std::array::from_fn(|k| q[k] - step[k]);
            let near = (0..n).all(|k| {
                let [low, high] = ranges[k];
                let reach = 2.0 * (high - low);
                q[k] >= (low - reach).max(-OUTSIDE) && q[k] <= (high + reach).min(1.0 + OUTSIDE)
            });
            if !near {
                return None;
            }
        }
        None
    }

    /// What is zero where both shapes have one normal and are above each other along it, as lengths,
    /// with derivatives: S1_u . r, S1_v . r, n1 . S2_p, n1 . S2_r with r = S1 - S2, or n . S_u and
    /// n . S_v for a plane.
    fn parallel(&self, q: Unknowns) -> ([f64; 4], [[f64; 4]; 4]) {
        let j = self.first.jet(q[0], q[1], Order::Second);
        match self.other {
            Other::Plane(plane) => {
                let n = plane.normal;
                let cross = n.dot(j.uv);
                let rows = [[n.dot(j.uu), cross, 0.0, 0.0], [cross, n.dot(j.vv), 0.0, 0.0]];
                ([n.dot(j.u), n.dot(j.v), 0.0, 0.0], [rows[0], rows[1], [0.0; 4], [0.0; 4]])
            }
            // The derivatives of f(S(u, v)).
            Other::Level(field) => {
                let (_, g, h) = field.second_order(j.p);
                let scale = slope_scale(g);
                let bend =
                    |a: Vec3, b: Vec3| Vec3::new(h[0].dot(a), h[1].dot(a), h[2].dot(a)).dot(b);
                let uu = (g.dot(j.uu) + bend(j.u, j.u)) * scale;
                let uv = (g.dot(j.uv) + bend(j.u, j.v)) * scale;
                let vv = (g.dot(j.vv) + bend(j.v, j.v)) * scale;
                let residual = [g.dot(j.u) * scale, g.dot(j.v) * scale, 0.0, 0.0];
                (residual, [[uu, uv, 0.0, 0.0], [uv, vv, 0.0, 0.0], [0.0; 4], [0.0; 4]])
            }
            Other::Surface(second) => {
                let k = second.jet(q[2], q[3], Order::Second);
                let r = j.p - k.p;
                let n = j.u.cross(j.v);
                let nu = j.uu.cross(j.v) + j.u.cross(j.uv);
                let nv = j.uv.cross(j.v) + j.u.cross(j.vv);
                // In lengths: products of derivatives over the size.
                let (s, t) = (1.0 / self.size, 1.0 / (self.size * self.size));
                let cross = j.u.dot(j.v) + j.uv.dot(r);
                let residual = [j.u.dot(r) * s, j.v.dot(r) * s, n.dot(k.u) * t, n.dot(k.v) * t];
                let by_u = [j.u.norm_sq() + j.uu.dot(r), cross, -j.u.dot(k.u), -j.u.dot(k.v)];
                let by_v = [cross, j.v.norm_sq() + j.vv.dot(r), -j.v.dot(k.u), -j.v.dot(k.v)];
                let by_p = [nu.dot(k.u), nv.dot(k.u), n.dot(k.uu), n.dot(k.uv)];
                let by_r = [nu.dot(k.v), nv.dot(k.v), n.dot(k.uv), n.dot(k.vv)];
                let rows = [
                    by_u.map(|x| x * s),
                    by_v.map(|x| x * s),
                    by_p.map(|x| x * t),
                    by_r.map(|x| x * t),
                ];
                (residual, rows)
            }
        }
    }
}
