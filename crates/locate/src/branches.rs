//! All branches of an intersection.
//!
//! `cells of both shapes -> pairs whose bounds meet -> seeds that no branch passes -> branches`
//!
//! Each shape is divided into nearly flat cells with bounds of their curvature (see `cells`), in
//! trees of boxes. For two surfaces a search descends the halvings from pieces to cells on both
//! sides (see `plates`). A pair of cells, or all below two larger parts, is excluded only if bounds
//! show that they are apart, or that they intersect in at most one line, which is a known branch.
//! In a pair whose normals cannot become parallel the shapes intersect in at most one line; other
//! pairs are halved until that is so, or to less than [`SMALLEST`] of the size. Each pair without a
//! known branch gives a start to Newton's method, whose result starts a branch.
//!
//! So, while [`Branches::complete`] is true, every branch is found that somewhere crosses at an
//! angle larger than the shapes turn within [`SMALLEST`] of the size and that is longer than that,
//! closed or from edge to edge. Missed may be: closed branches smaller than that; one of two
//! branches closer to each other than that all along. On shapes that are not cubic pieces the
//! bounds are measured and not proved (see [`crate::pieces`]). A contact without crossing is not a
//! branch, but a [`Touch`].

use crate::cells::{Cells, Flat, Fork, LEAF, Polynomials, forks};
use crate::implicit::solve;
use crate::march::{Branch, Crossing, Other, TANGENT, TracePoint, Unknowns};
use crate::newton::OUTSIDE;
use crate::pieces::{BezierPatch, meet};
use crate::slab_tree::{Pairs, Plates, Sight, Trails, Visitor};
use crate::tree::Boxes;
use moldloft_num::{Box3, Field, Order, Plane, Surface, Vec3, slope_scale};
use smallvec::SmallVec;

/// Minimum length of the branches that are found, relative to the size.
pub const SMALLEST: f64 = 0.02;

/// Maximum number of pairs in a search, which coincident shapes exceed.
const MOST_PAIRS: usize = 400_000;

/// Maximum number of branches.
const MOST_BRANCHES: usize = 2_000;

/// Sides of the grid of bins in which stretches of branches are looked up.
const BINS: usize = 48;

/// Maximum gap of a touch, relative to the size.
const TOUCH: f64 = 1e-9;

/// Planes of cells at a smaller angle than this have no reliable line in common.
const LEAST_SINE: f64 = 0.02;

/// Steps towards a touch.
const MOST_STEPS: usize = 12;

/// With more touches than this the shapes touch along a line, or are the same.
const MOST_TOUCHES: usize = 64;

/// A point where two shapes touch without crossing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The unknowns there.
    pub q: Unknowns,
    /// Position.
    pub x: Vec3,
}

/// All branches of an intersection.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Branches {
    /// The branches, in the order of finding, which depends only on the shapes.
    pub branches: Vec<Branch>,
    /// Contacts without a branch.
    pub touches: Vec<Touch>,
    /// False when the search reached its limit, as it does if shapes coincide or touch along a
    /// line.
    pub complete: bool,
    /// Minimum length of the branches found.
    pub smallest: f64,
}

/// A cell or a part of one.
#[derive(Clone, Copy, Debug)]
struct CellPart {
    flat: Flat,
    /// The parallelogram's unit normal, zero if undefined.
    normal: Vec3,
    /// Sine of the greatest angle between that and the normals of the surface here, or more.
    turn: f64,
    /// The longer side.
    longest: f64,
    /// Maximum rate of the part's own parameters, from -1 to 1, in space.
    fastest: [f64; 2],
    middle: [f64; 2],
    half: [f64; 2],
    /// Bounds of third derivatives.
    far: [f64; 4],
    piece: u32,
}

impl CellPart {
    fn of(cells: &Cells, k: usize) -> Self {
        let bent = &cells.bents[k];
        let slack = cells.pieces[bent.piece as usize].slack;
        let flat = cells.flats[k];
        Self::with(flat, bent.second, slack, bent.far, [bent.middle, bent.half], bent.piece)
    }

    fn with(
        flat: Flat,
        [ss, st, tt]: [Vec3; 3],
        slack: f64,
        far: [f64; 4],
        [middle, half]: [[f64; 2]; 2],
        piece: u32,
    ) -> Self {
        let (a, b) = (flat.a, flat.b);
        let (la, lb) = (a.norm(), b.norm());
        let n = a.cross(b);
        let area = n.norm();
        // Bound of the change of both tangents, and thus of their product: exact to first order.
        let rest = [
            0.5 * (far[0] + 2.0 * far[1] + far[2]) + 5.0 * slack,
            0.5 * (far[1] + 2.0 * far[2] + far[3]) + 5.0 * slack,
        ];
        let change = [ss.norm() + st.norm() + rest[0], st.norm() + tt.norm() + rest[1]];
        let first = (ss.cross(b) + a.cross(st)).norm() + (st.cross(b) + a.cross(tt)).norm();
        let turned = first + rest[0] * lb + rest[1] * la + change[0] * change[1];
        let (normal, turn) =
            if area > 0.0 { (n / area, turned / area) } else { (Vec3::zero(), f64::INFINITY) };
        let longest = 2.0 * la.max(lb);
        let [aa, _, bb] = flat.products;
        let by = flat.inverses[0].max(0.0);
        let fastest = [(bb * by).sqrt(), (aa * by).sqrt()];
        Self { flat, normal, turn, longest, fastest, middle, half, far, piece }
    }

    /// Both halves along the longer side.
    fn halves(&self, cells: &Cells) -> [Self; 2] {
        let axis = usize::from(self.flat.products[2] > self.flat.products[0]);
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
            let second = [ss * (h * h), st * (h * k), tt * (k * k)];
            let bend = 0.5 * (second[0].norm() + second[2].norm())
                + second[1].norm()
                + (far[0] + 3.0 * (far[1] + far[2]) + far[3]) / 6.0
                + piece.slack;
            let flat = Flat::of(c, a, b, bend);
            Self::with(flat, second, piece.slack, far, [middle, half], self.piece)
        })
    }

    /// The part's own parameters at `at` and their rates along `d`, a unit vector; `stretch` is
    /// limited to the part, extended by `reach` beyond its parallelogram.
    #[inline]
    fn clip(&self, at: Vec3, d: Vec3, reach: f64, stretch: &mut [f64; 2]) -> [f64; 4] {
        let Flat { a, b, products: [aa, ab, bb], inverses: [by, ..], .. } = self.flat;
        let away = at - self.flat.c;
        let (f, g) = (away.dot(a), away.dot(b));
        let (df, dg) = (d.dot(a), d.dot(b));
        let place = [(f * bb - g * ab) * by, (g * aa - f * ab) * by];
        let rate = [(df * bb - dg * ab) * by, (dg * aa - df * ab) * by];
        for k in 0..2 {
            // The lengths of the dual vectors are how fast a parameter changes at most.
            let limit = 1.0 + 2.0 * reach * self.fastest[k];
            if rate[k].abs() > 1e-9 * self.fastest[k] {
                let inverse = 1.0 / rate[k];
                let (middle, half) = (-place[k] * inverse, limit * inverse.abs());
                stretch[0] = stretch[0].max(middle - half);
                stretch[1] = stretch[1].min(middle + half);
            } else if place[k].abs() > limit {
                stretch[1] = f64::NEG_INFINITY;
            }
        }
        [place[0], place[1], rate[0], rate[1]]
    }

    /// The surface's parameters from and to.
    fn ranges(&self, cells: &Cells) -> [[f64; 2]; 2] {
        let piece = &cells.pieces[self.piece as usize];
        let low = piece.place(self.middle[0] - self.half[0], self.middle[1] - self.half[1]);
        let high = piece.place(self.middle[0] + self.half[0], self.middle[1] + self.half[1]);
        [[low[0], high[0]], [low[1], high[1]]]
    }

    /// The surface's parameters at the part's own ones, limited to the part.
    fn place(&self, cells: &Cells, [s, t]: [f64; 2]) -> [f64; 2] {
        let at = |k: usize, x: f64| self.middle[k] + self.half[k] * x.clamp(-1.0, 1.0);
        cells.pieces[self.piece as usize].place(at(0, s), at(1, t))
    }
}

#[derive(Clone, Copy)]
struct TreeNode<'a> {
    /// Number of a fork, or of a cell with [`LEAF`] added.
    number: u32,
    bounds: &'a Box3,
}

/// A surface divided for intersections.
#[derive(Clone, Debug)]
pub struct CutSurface {
    cells: Cells,
    /// One for each cell.
    parts: Vec<CellPart>,
    plates: Plates,
    /// The tree over the pieces.
    forks: Vec<Fork>,
    quick: Option<Polynomials>,
}

impl CutSurface {
    /// Divides a surface, for many intersections.
    pub fn new(surface: &dyn Surface<f64>) -> Self {
        Self::of(Cells::fine(surface))
    }

    /// Cuts a surface up for one intersection: into larger cells, which are made smaller where the
    /// intersection is.
    fn rough(surface: &dyn Surface<f64>) -> Self {
        Self::of(Cells::coarse(surface))
    }

    fn of(mut cells: Cells) -> Self {
        let parts: Vec<CellPart> =
            (0..cells.flats.len()).map(|k| CellPart::of(&cells, k)).collect();
        let plates = Plates::new(&mut cells);
        let bounds: Vec<Box3> = cells.tree.patches.iter().map(BezierPatch::bounds).collect();
        let boxes = Boxes::new(&bounds, 1);
        let forks = numbered(forks(&boxes), &boxes.order);
        let quick = cells.polynomials();
        Self { cells, parts, plates, forks, quick }
    }

    fn root(&self) -> TreeNode<'_> {
        TreeNode {
            number: if self.forks.is_empty() { LEAF } else { 0 },
            bounds: &self.cells.tree.bounds,
        }
    }

    /// The children of a fork, the second one first.
    #[inline]
    fn below(&self, fork: u32) -> [TreeNode<'_>; 2] {
        let fork = &self.forks[fork as usize];
        let child = |k: usize| TreeNode { number: fork.below[k], bounds: &fork.bounds[k] };
        [child(1), child(0)]
    }
}

/// The forks with the numbers of items instead of their indices in the order of leaves.
fn numbered(mut forks: Vec<Fork>, order: &[u32]) -> Vec<Fork> {
    for below in forks.iter_mut().flat_map(|fork| &mut fork.below) {
        if *below & LEAF != 0 {
            *below = order[(*below & !LEAF) as usize] | LEAF;
        }
    }
    forks
}

/// State of a search.
struct Finder<'a> {
    crossing: Crossing<'a>,
    first: &'a CutSurface,
    second: Option<&'a CutSurface>,
    /// Stretches of branches, and their numbers by their first unknowns.
    chords: Vec<Chord>,
    bins: Vec<SmallVec<[u32; 6]>>,
    trails: Trails,
    /// Parts to be tested in pairs.
    parts: Vec<(CellPart, CellPart)>,
    found: Branches,
    pairs: usize,
}

impl Crossing<'_> {
    /// All branches; the module documentation states which are guaranteed.
    pub fn branches(&self) -> Branches {
        let first = CutSurface::rough(self.first);
        match self.other {
            Other::Plane(_) | Other::Level(_) => self.branches_in(&first, None),
            Other::Surface(second) => self.branches_in(&first, Some(&CutSurface::rough(second))),
        }
    }

    /// All branches of surfaces divided before: the first of the crossing, and the second unless it
    /// is a plane.
    pub fn branches_in(&self, first: &CutSurface, second: Option<&CutSurface>) -> Branches {
        // Pieces that are the surface itself are faster to evaluate.
        fn chosen<'b>(
            cut: Option<&'b CutSurface>,
            own: &'b dyn Surface<f64>,
        ) -> &'b dyn Surface<f64> {
            match cut.and_then(|cut| cut.quick.as_ref()) {
                Some(quick) => quick,
                None => own,
            }
        }
        let other = match self.other {
            Other::Plane(plane) => Other::Plane(plane),
            Other::Level(field) => Other::Level(field),
            Other::Surface(own) => Other::Surface(chosen(second, own)),
        };
        let quick = [first.quick.as_ref(), second.and_then(|cut| cut.quick.as_ref())];
        let crossing = Crossing { first: chosen(Some(first), self.first), other, quick, ..*self };
        let mut finder = Finder {
            crossing,
            first,
            second,
            chords: Vec::new(),
            bins: vec![SmallVec::new(); BINS * BINS],
            trails: Trails::new(first.plates.bins),
            parts: Vec::new(),
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

fn root(cells: &Cells) -> (u32, &Box3) {
    (if cells.forks.is_empty() { LEAF } else { 0 }, &cells.tree.bounds)
}

/// Half the girth of a box, to compare sizes.
fn girth(b: &Box3) -> f64 {
    let side = b.high - b.low;
    side.x + side.y + side.z
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
        let crosses = |b: &Box3| {
            let half = (b.high - b.low) * 0.5;
            let reach = n.x.abs() * half.x + n.y.abs() * half.y + n.z.abs() * half.z;
            plane.distance(b.centre()).abs() <= reach
        };
        self.with_one(crosses, |part| {
            let flat = &part.flat;
            let reach = n.dot(flat.a).abs() + n.dot(flat.b).abs() + flat.bend;
            let meets = plane.distance(flat.c).abs() <= reach;
            meets.then(|| part.normal.cross(n).norm() > part.turn)
        });
    }

    fn with_level(&mut self, field: &dyn Field<f64>) {
        let crosses =
            |b: &Box3| field.bounds(b).is_none_or(|[low, high]| low <= 0.0 && high >= 0.0);
        self.with_one(crosses, |part| {
            let flat = &part.flat;
            let reach = |k: fn(&Vec3) -> f64| k(&flat.a).abs() + k(&flat.b).abs() + flat.bend;
            let half = Vec3::of(reach(|v| v.x), reach(|v| v.y), reach(|v| v.z));
            if !crosses(&Box3 { low: flat.c - half, high: flat.c + half }) {
                return None;
            }
            // Bound of the turn of the level's normal over the cell, from its second derivatives.
            let (_, g, h) = field.second_order(flat.c);
            let steep = g.norm();
            let bent = h.iter().map(|row| row.norm_sq()).sum::<f64>().sqrt();
            let all = part.turn + bent * half.norm() / steep;
            Some(part.normal.cross(g).norm() > all * steep)
        });
    }

    /// All cells whose boxes `crosses` lets pass. `judged` gives `None` for a part that the other
    /// shape certainly does not meet, otherwise whether they meet in one line at most.
    fn with_one(
        &mut self,
        crosses: impl Fn(&Box3) -> bool,
        judged: impl Fn(&CellPart) -> Option<bool>,
    ) {
        let first = self.first;
        let cells = &first.cells;
        let (top, bounds) = root(cells);
        let mut stack = Vec::new();
        if crosses(bounds) {
            stack.push(top);
        }
        let mut parts: Vec<CellPart> = Vec::new();
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
            let mut next = Some(first.parts[(at & !LEAF) as usize]);
            while let Some(part) = next {
                if let Some(simple) = judged(&part) {
                    if self.exhausted() {
                        return;
                    }
                    if simple || part.longest <= self.found.smallest {
                        self.start(&part, None, simple);
                    } else {
                        parts.extend(part.halves(cells));
                    }
                }
                next = parts.pop();
            }
        }
    }

    fn with_surface(&mut self) {
        let (first, Some(second)) = (self.first, self.second) else { return };
        let mut stack = vec![(first.root(), second.root())];
        stack.retain(|(a, b)| meet(a.bounds, b.bounds));
        let plates = Pairs::new(&first.plates, &second.plates);
        while let Some((a, b)) = stack.pop() {
            if a.number & b.number & LEAF != 0 {
                let pieces = [a.number & !LEAF, b.number & !LEAF];
                if !plates.descend(pieces, self) {
                    return;
                }
                continue;
            }
            let split = a.number & LEAF == 0
                && (b.number & LEAF != 0 || girth(a.bounds) >= girth(b.bounds));
            let (below, other) =
                if split { (first.below(a.number), b) } else { (second.below(b.number), a) };
            for child in below {
                if meet(child.bounds, other.bounds) {
                    stack.push(if split { (child, b) } else { (a, child) });
                }
            }
        }
    }

    /// Looks at a pair of parts that may meet; pairs of their halves are left in `parts`. False when
    /// there were too many.
    fn pair(&mut self, p: &CellPart, q: &CellPart, simple: bool) -> bool {
        if self.exhausted() {
            return false;
        }
        let turn = p.turn + q.turn;
        let simple = simple || p.normal.cross(q.normal).norm_sq() > turn * turn;
        if simple || p.longest.max(q.longest) <= self.found.smallest {
            self.start(p, Some(q), simple);
        } else if p.longest >= q.longest {
            self.parts.extend(p.halves(&self.first.cells).map(|half| (half, *q)));
        } else if let Some(second) = self.second {
            self.parts.extend(q.halves(&second.cells).map(|half| (*p, half)));
        }
        true
    }

    /// Starts a branch from a pair unless one passes there.
    fn start(&mut self, a: &CellPart, b: Option<&CellPart>, simple: bool) {
        let second = b.zip(self.second.map(|s| &s.cells));
        let mut x = b.map_or(a.flat.c, |b| (a.flat.c + b.flat.c) * 0.5);
        let mut places = [0.0; 4];
        match self.straight(a, b, x) {
            // The planes of the cells do not meet where both cells are.
            PlaneMeeting::Beside => return,
            PlaneMeeting::Line { at, reach, places: there } => {
                let [s, t, ..] = there;
                if self.covered(at, reach, a.place(&self.first.cells, [s, t])) {
                    return;
                }
                (x, places) = (at, there);
            }
            PlaneMeeting::Parallel => {}
        }
        let [s, t, k, l] = places;
        let [us, vs] = a.ranges(&self.first.cells);
        let [ps, rs] = second.map_or([[0.0; 2]; 2], |(b, cells)| b.ranges(cells));
        let ranges = [us, vs, ps, rs];
        let [u, v] = a.place(&self.first.cells, [s, t]);
        let [p, r] = second.map_or([0.0; 2], |(b, cells)| b.place(cells, [k, l]));
        let guess = [u, v, p, r];
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
            if (0..4).any(|i| (p[i] - q[i]).abs() > 0.5) {
                continue;
            }
            let chord = self.chords.len() as u32;
            self.chords.push(Chord::new(&pair[0], &pair[1], number, k));
            self.trails.note(&pair[0], &pair[1]);
            // Half a bin more on each side.
            let more = 0.5 / BINS as f64;
            let [us, vs] =
                [0, 1].map(|i| bins_between(p[i].min(q[i]) - more, p[i].max(q[i]) + more));
            for i in us.clone() {
                for j in vs.clone() {
                    self.bins[i * BINS + j].push(chord);
                }
            }
        }
        self.found.branches.push(branch);
    }

    /// Intersection of the planes of a pair's cells, near both.
    fn straight(&self, a: &CellPart, b: Option<&CellPart>, near: Vec3) -> PlaneMeeting {
        let m = a.normal;
        let (n, point, bend) = match (b, self.crossing.other) {
            (Some(b), _) => (b.normal, b.flat.c, a.flat.bend + b.flat.bend),
            (None, Other::Plane(plane)) => (plane.normal, plane.point, a.flat.bend),
            (None, Other::Level(field)) => {
                // Its tangent plane near the cell, and a bound of its deviation there.
                let (f, g, h) = field.second_order(a.flat.c);
                let Some(n) = g.normalized() else {
                    return PlaneMeeting::Parallel;
                };
                let half = a.flat.a.norm() + a.flat.b.norm();
                let bent = h.iter().map(|row| row.norm_sq()).sum::<f64>().sqrt() / g.norm();
                (n, a.flat.c - n * (f / g.norm()), a.flat.bend + bent * half * half)
            }
            _ => return PlaneMeeting::Parallel,
        };
        let d = m.cross(n);
        let det = d.norm_sq();
        if det < LEAST_SINE * LEAST_SINE {
            return PlaneMeeting::Parallel;
        }
        let by_sine = 1.0 / det.sqrt();
        let d = d * by_sine;
        // From `near` to the line: a combination of both normals.
        let (e, f, cosine) = (m.dot(a.flat.c - near), n.dot(point - near), m.dot(n));
        let by = by_sine * by_sine;
        let at = near + m * ((e - cosine * f) * by) + n * ((f - cosine * e) * by);
        let reach = bend * by_sine;
        // The interval of it over both cells, extended by their deviations.
        let mut stretch = [f64::NEG_INFINITY, f64::INFINITY];
        let first = a.clip(at, d, reach, &mut stretch);
        let second = b.map_or([0.0; 4], |b| b.clip(at, d, reach, &mut stretch));
        let [low, high] = stretch;
        if low > high {
            return PlaneMeeting::Beside;
        }
        let middle = if (low + high).is_finite() { 0.5 * (low + high) } else { 0.0 };
        let [s, t, ds, dt] = first;
        let [k, l, dk, dl] = second;
        let places = [s + ds * middle, t + dt * middle, k + dk * middle, l + dl * middle];
        PlaneMeeting::Line { at: at + d * middle, reach, places }
    }

    /// True if a stretch of a branch passes within `reach` of a point of the cell with these
    /// parameters.
    fn covered(&self, x: Vec3, reach: f64, uv: [f64; 2]) -> bool {
        self.passing(uv).any(|chord| {
            let far = 2.0 * reach + chord.bow;
            chord.off_sq(x) <= far * far
        })
    }

    /// The stretches of branches near a point of the first surface.
    fn passing(&self, [u, v]: [f64; 2]) -> impl Iterator<Item = &Chord> {
        let bin = bins_between(u, u).start * BINS + bins_between(v, v).start;
        self.bins[bin].iter().map(|&k| &self.chords[k as usize])
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
        let size = self.crossing.size;
        self.passing([q[0], q[1]]).any(|chord| {
            let stations = &self.found.branches[chord.branch as usize].stations;
            let (a, b) = (&stations[chord.number], &stations[chord.number + 1]);
            let near = 0.2 * a.x.distance(b.x) + 1e-6 * size;
            chord.off_sq(x) <= near * near
                && match self.crossing.between(a, b, x) {
                    Some(y) => y.distance(x) <= 1e-7 * size,
                    None => false,
                }
        })
    }

    /// Searches for a contact near a nearly parallel pair.
    fn touch(&mut self, guess: Unknowns, ranges: &[[f64; 2]; 4]) {
        let Some(touch) = self.crossing.contact(guess, ranges) else {
            return;
        };
        let size = self.crossing.size;
        let known = self.found.touches.iter().any(|t| t.x.distance(touch.x) < 1e-4 * size);
        if !known && !self.passed(touch.q) {
            self.found.touches.push(touch);
            self.found.complete &= self.found.touches.len() < MOST_TOUCHES;
        }
    }
}

impl Visitor for Finder<'_> {
    #[inline(always)]
    fn done(&mut self, p: &Sight, q: &Sight) -> bool {
        p.smooth(q) && p.meet_in_one_line(q) && self.trails.pass(p, q)
    }

    fn cells(&mut self, p: &Sight, q: &Sight) -> bool {
        let (first, Some(second)) = (self.first, self.second) else { return false };
        let simple = p.meet_in_one_line(q);
        let [p, q] = [&first.parts[p.cell()], &second.parts[q.cell()]];
        if !self.pair(p, q, simple) {
            return false;
        }
        while let Some((p, q)) = self.parts.pop() {
            if !apart(&p, &q) && !self.pair(&p, &q, false) {
                return false;
            }
        }
        true
    }
}

/// True when two parts certainly have no common point.
#[inline]
fn apart(p: &CellPart, q: &CellPart) -> bool {
    let (a, b) = (&p.flat, &q.flat);
    let d = b.c - a.c;
    let bend = a.bend + b.bend;
    let beyond =
        |n: Vec3, other: &Flat| n.dot(d).abs() - n.dot(other.a).abs() - n.dot(other.b).abs() > bend;
    if beyond(p.normal, b) || beyond(q.normal, a) {
        return true;
    }
    let reach =
        |k: fn(&Vec3) -> f64| k(&a.a).abs() + k(&a.b).abs() + k(&b.a).abs() + k(&b.b).abs() + bend;
    d.x.abs() > reach(|v| v.x) || d.y.abs() > reach(|v| v.y) || d.z.abs() > reach(|v| v.z)
}

/// The chord of two neighbouring stations.
struct Chord {
    from: Vec3,
    way: Vec3,
    /// One over its squared length.
    inverse: f64,
    /// Maximum distance of the branch from it: an eighth of its turn.
    bow: f64,
    branch: u32,
    /// Index of the first station.
    number: usize,
}

impl Chord {
    fn new(a: &TracePoint, b: &TracePoint, branch: u32, number: usize) -> Self {
        let way = b.x - a.x;
        let bow = 0.125 * way.norm() * a.tangent.distance(b.tangent);
        Self { from: a.x, way, inverse: 1.0 / way.norm_sq(), bow, branch, number }
    }

    /// Squared distance of a point.
    #[inline]
    fn off_sq(&self, x: Vec3) -> f64 {
        let away = x - self.from;
        let share = (away.dot(self.way) * self.inverse).clamp(0.0, 1.0);
        (away - self.way * share).norm_sq()
    }
}

/// Result for the planes of a pair of cells.
enum PlaneMeeting {
    /// They do not meet where both cells are.
    Beside,
    /// They meet in a line, in the middle of whose stretch over both cells is `at`; the shapes meet
    /// within `reach` of it. Places on the cells in their own parameters from -1 to 1.
    Line { at: Vec3, reach: f64, places: [f64; 4] },
    /// They are parallel, or nearly so.
    Parallel,
}

/// The bins of an interval of a parameter.
fn bins_between(a: f64, b: f64) -> std::ops::Range<usize> {
    let bin = |x: f64| ((x * BINS as f64) as usize).min(BINS - 1);
    bin(a.min(b))..bin(a.max(b)) + 1
}

impl Crossing<'_> {
    /// The point near `guess` where the shapes have one tangent plane and one is straight above the
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

    /// Equations of points with a common normal along which the shapes are opposite, as lengths,
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
