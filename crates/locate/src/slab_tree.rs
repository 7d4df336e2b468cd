//! Pairs of large parts of two surfaces that need no closer look.
//!
//! The halvings from the pieces of a surface to its cells form a tree of plates: each is a
//! parallelogram with bounds of the surface's distance from it and of the turn of its normals. A
//! search descends the trees of both surfaces together. A pair of plates is finished if they are
//! apart, or if they intersect in at most one line that is a known branch.

use crate::cells::{Cells, Flat, MOST_HALVINGS, derivative, patch_powers};
use crate::march::{TracePoint, Unknowns};
use moldloft_num::{Box3, Vec3};

/// Margin, relative to a plate's half sides, within which a branch counts for the plate: a line
/// along the border of two plates counts for both.
const NEIGHBOUR_MARGIN: f64 = 0.15;

/// Factor of the plates on which turns are bounded, so that there is at most one line beside them
/// too.
const GROWTH_MARGIN: f64 = 1.2;

/// Overlap, relative to the size, below which boxes only touch.
const TOUCH_TOLERANCE: f64 = 1e-12;

/// A multiple of the rounding of single precision, relative to the input numbers.
const ROUNDING: f64 = 1.0 / (1u32 << 20) as f64;

/// Room for pairs that wait: pieces are halved a few times each.
const STACK: usize = 2 * MOST_HALVINGS as usize + 2;

/// A part of a surface, between piece and cell: the parallelogram c + a s + b t with |s| and |t| at
/// most 1, and a bound of the surface's distance from it.
///
/// A search touches many plates briefly, so that memory access dominates: this is one cache line,
/// in single precision with the bounds widened by its rounding. Other data of a plate are in a
/// [`SlabBox`] and a [`NormalVariation`].
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Slab {
    /// By axis: c from the middle of the surface's box, a, b, and the unit normal.
    rows: [[f32; 4]; 3],
    /// Component of c along the normal.
    height: f32,
    bend: f32,
    /// The longer side.
    longest: f32,
    /// A bound of the change of the normals in addition to [`NormalVariation`].
    rest: f32,
}

impl Slab {
    #[inline(always)]
    fn normal(&self) -> [f32; 3] {
        let [x, y, z] = &self.rows;
        [x[3], y[3], z[3]]
    }

    /// True when the plane of one certainly does not come near the other, which is measured from a
    /// point that is farther by `shift`; `margin` is for the rounding of that.
    #[inline(always)]
    fn aside(&self, o: &Slab, shift: [f32; 3], margin: f32) -> bool {
        let bend = self.bend + o.bend + margin;
        self.beyond(o, shift, 1.0, bend) | o.beyond(self, shift, -1.0, bend)
    }

    /// True when the other is on one side of this one's plane.
    #[inline(always)]
    fn beyond(&self, o: &Slab, [a, b, c]: [f32; 3], by: f32, bend: f32) -> bool {
        let [l, m, n] = self.normal();
        let [x, y, z] = &o.rows;
        // Loops and no closures: where registers are wide, those that are not inlined lose them.
        let mut along = [0.0; 4];
        for k in 0..4 {
            along[k] = l * x[k] + m * y[k] + n * z[k];
        }
        let distance = along[0] - self.height + by * (l * a + m * b + n * c);
        distance.abs() > along[1].abs() + along[2].abs() + bend
    }
}

/// Position of a plate.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct SlabBox {
    /// The lower ends of its box by axis, and the negated upper ones. A side that the surface
    /// crosses into the next plate is moved inward slightly: plates that only touch there need not
    /// be tested, since an intersection continues to overlapping plates, or has such on one of its
    /// sides.
    ends: [f64; 6],
    /// The first of its halves, which follow each other; 0 for a cell.
    below: u32,
    /// The cell that it is, if it is one.
    cell: u32,
    /// True if the surface continues beyond it in the same direction.
    smooth: bool,
}

impl SlabBox {
    /// Upper bounds of the ends of a box that intersects this one.
    #[inline(always)]
    fn facing(&self) -> [f64; 6] {
        let [a, b, c, d, e, f] = self.ends;
        [-d, -e, -f, -a, -b, -c]
    }

    /// True when the box certainly has no point in the one that is facing.
    #[inline(always)]
    fn apart(&self, facing: &[f64; 6]) -> bool {
        let mut beyond = false;
        for k in 0..6 {
            beyond |= self.ends[k] > facing[k];
        }
        beyond
    }
}

/// Variation of a plate's normals: the change across the central one, relative to the minimum along
/// it.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct NormalVariation {
    /// By axis the coefficients of s, t, s^2, s t.
    rows: [[f32; 4]; 3],
    /// Coefficient of t^2, and a bound of the rounding.
    last: [f32; 4],
}

impl NormalVariation {
    /// Bound of their change along a unit vector.
    #[inline(always)]
    fn along(&self, [l, m, n]: [f32; 3]) -> f32 {
        let ([x, y, z], [a, b, c, margin]) = (&self.rows, self.last);
        let mut each = [0.0; 4];
        for k in 0..4 {
            each[k] = (l * x[k] + m * y[k] + n * z[k]).abs();
        }
        let last = (l * a + m * b + n * c).abs() + margin;
        (each[0] + each[2]) + (each[1] + each[3]) + last
    }
}

/// A plate of the surface that it is on.
#[derive(Clone, Copy)]
pub(crate) struct Sight<'a> {
    all: &'a Plates,
    number: usize,
}

impl<'a> Sight<'a> {
    #[inline(always)]
    fn plate(&self) -> &'a Slab {
        &self.all.plates[self.number]
    }

    #[inline(always)]
    fn place(&self) -> &'a SlabBox {
        &self.all.places[self.number]
    }

    /// The cell that it is, if it is one.
    #[inline]
    pub fn cell(&self) -> usize {
        self.place().cell as usize
    }

    /// True when the surfaces continue beyond both in the same direction.
    #[inline(always)]
    pub fn smooth(&self, o: &Sight) -> bool {
        self.place().smooth && o.place().smooth
    }

    /// True when both certainly have no common point, as their boxes tell or their planes.
    #[inline(always)]
    fn apart(&self, o: &Sight, shift: [f32; 3], margin: f32) -> bool {
        let boxes = self.place().apart(&o.place().facing());
        boxes || self.plate().aside(o.plate(), shift, margin)
    }

    /// True when both surfaces certainly meet in one line at most here and beside.
    ///
    /// Seen along n1 x n2, the direction of the line, the normals of each turn by an angle of at
    /// most their change across n over the minimum along n. While the sum of these angles is less
    /// than the angle between n1 and n2, the distance of one surface from the other increases
    /// monotonically across the line.
    #[inline(always)]
    pub fn meet_in_one_line(&self, o: &Sight) -> bool {
        let (p, q) = (self.plate(), o.plate());
        let ([a, b, c], [l, m, n]) = (p.normal(), q.normal());
        let (x, y, z) = (b * n - c * m, c * l - a * n, a * m - b * l);
        let sine_sq = x * x + y * y + z * z;
        let rest = p.rest + q.rest;
        if rest * rest >= sine_sq {
            return false;
        }
        // Both normals' components across the line are over its sine: a + r sin < sin^2.
        let (t, u) = (&self.all.turns[self.number], &o.all.turns[o.number]);
        let left = sine_sq - t.along([l, m, n]) - u.along([a, b, c]);
        left > 0.0 && left * left > rest * rest * sine_sq
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Plates {
    /// The pieces' first, in their order.
    plates: Vec<Slab>,
    places: Vec<SlabBox>,
    turns: Vec<NormalVariation>,
    /// Their parameters.
    ranges: Vec<[[f64; 2]; 2]>,
    /// Origin of the plates' coordinates, and their maximum distance from it.
    origin: Vec3,
    radius: f64,
    /// Number of bins per side of the parameter square.
    pub bins: usize,
}

impl Plates {
    /// The plates of the halvings that are kept in `cells`, which are given up.
    pub fn new(cells: &mut Cells) -> Self {
        let twigs = std::mem::take(&mut cells.twigs);
        let pieces = cells.pieces.len();
        let hair = TOUCH_TOLERANCE * cells.tree.size;
        let bounds = cells.tree.bounds;
        let (origin, radius) = (bounds.centre(), bounds.low.distance(bounds.high));
        let mut made = Self {
            plates: Vec::with_capacity(twigs.len()),
            places: Vec::with_capacity(twigs.len()),
            turns: Vec::with_capacity(twigs.len()),
            ranges: twigs.iter().map(|twig| twig.patch.uv).collect(),
            origin,
            radius,
            bins: ((pieces as f64).sqrt().ceil() as usize).clamp(4, 64),
        };
        for twig in &twigs {
            let patch = &twig.patch;
            let x = patch_powers(patch);
            let flat = Flat::new(patch, &x);
            // On a plate that is larger by a factor.
            let powers = [1.0, GROWTH_MARGIN, GROWTH_MARGIN.powi(2), GROWTH_MARGIN.powi(3)];
            let wide: [Vec3; 16] = std::array::from_fn(|k| x[k] * (powers[k / 4] * powers[k % 4]));
            let (by_s, by_t) = (derivative(&wide, 0), derivative(&wide, 1));
            // The coefficients of X_s x X_t, by degree.
            let degree = |f: &[Vec3; 16]| {
                let mut sums = [0.0; 7];
                (0..16).for_each(|k| sums[k / 4 + k % 4] += f[k].norm());
                sums
            };
            let product = |terms: &[[usize; 2]]| {
                terms.iter().fold(Vec3::zero(), |sum, &[k, l]| sum + by_s[k].cross(by_t[l]))
            };
            let n = product(&[[0, 0]]);
            let area = n.norm();
            let normal = if area > 0.0 { n / area } else { Vec3::zero() };
            let by = if area > 0.0 { 1.0 / area } else { f64::INFINITY };
            let turns = [
                product(&[[4, 0], [0, 4]]),
                product(&[[1, 0], [0, 1]]),
                product(&[[8, 0], [4, 4], [0, 8]]),
                product(&[[5, 0], [4, 1], [1, 4], [0, 5]]),
                product(&[[2, 0], [1, 1], [0, 2]]),
            ];
            let turns = turns.map(|m| m * by);
            let (k, l) = (degree(&by_s), degree(&by_t));
            let low: f64 = (0..3).map(|d| (0..=d).map(|i| k[i] * l[d - i]).sum::<f64>()).sum();
            let all = |sums: &[f64; 7]| sums.iter().sum::<f64>() + 5.0 * patch.slack;
            let rest = (all(&k) * all(&l) - low).max(0.0) * by;
            let along = turns.map(|m| m.dot(normal));
            let left = 1.0 - along.iter().map(|x| x.abs()).sum::<f64>() - rest;
            let sure = left > 0.1;
            let share = if sure { 1.0 / left } else { 0.0 };
            let smooth = patch.open == [[false; 2]; 2];
            let Box3 { mut low, mut high } = patch.bounds();
            let change = turns.iter().map(|m| m.norm()).sum::<f64>() + rest;
            for axis in 0..3 {
                // Nowhere along the axis.
                let steady = (1.0 - normal[axis] * normal[axis]).max(0.0).sqrt() > 1.5 * change;
                if smooth && steady && high[axis] - low[axis] > 4.0 * hair {
                    let mut by = [0.0; 3];
                    by[axis] = hair;
                    (low, high) = (low + by.into(), high - by.into());
                }
            }
            // Up to the next number in single precision, and above its rounding.
            let up = |x: f64| (x * (1.0 + ROUNDING)) as f32;
            // Squares range from 0 to 1 only: with half of their contribution, the bound is half as
            // wide to either side.
            let squares = [x[8], x[2], x[10]];
            let c = squares.iter().fold(flat.c, |c, x| c + *x * 0.5) - origin;
            let bend = flat.bend - 0.5 * squares.iter().map(|x| x.norm()).sum::<f64>();
            made.plates.push(Slab {
                rows: [0, 1, 2].map(|k| [c[k], flat.a[k], flat.b[k], normal[k]].map(|x| x as f32)),
                height: normal.dot(c) as f32,
                bend: up(bend + ROUNDING * radius),
                longest: (2.0 * flat.a.norm().max(flat.b.norm())) as f32,
                rest: if sure { up(rest * share + ROUNDING) } else { f32::INFINITY },
            });
            made.places.push(SlabBox {
                ends: [low.x, low.y, low.z, -high.x, -high.y, -high.z],
                below: twig.below,
                cell: twig.cell,
                smooth,
            });
            let turns = [0, 1, 2, 3, 4].map(|k| (turns[k] - normal * along[k]) * share);
            let [ms, mt, mss, mst, mtt] = turns;
            let margin = up(ROUNDING * turns.iter().map(|m| m.norm()).sum::<f64>());
            made.turns.push(NormalVariation {
                rows: [0, 1, 2].map(|axis| [ms, mt, mss, mst].map(|m| m[axis] as f32)),
                last: [mtt.x as f32, mtt.y as f32, mtt.z as f32, margin],
            });
        }
        made
    }

    #[inline(always)]
    fn sight(&self, number: u32) -> Sight<'_> {
        Sight { all: self, number: number as usize }
    }
}

/// A short stretch of a branch, straight in the parameters of both surfaces, nearly.
#[derive(Clone, Copy, Debug)]
struct Leg {
    from: Unknowns,
    /// One over the displacement to its end.
    inverse: Unknowns,
}

/// The branches that were found, for the question which pairs of plates they pass.
#[derive(Debug)]
pub(crate) struct Trails {
    bins: usize,
    legs: Vec<Leg>,
    /// For each bin the last of its entries, plus one; 0 for an empty bin.
    last: Vec<u32>,
    /// A leg, and the entry of the same bin before it, plus one.
    entries: Vec<[u32; 2]>,
}

impl Trails {
    pub fn new(bins: usize) -> Self {
        let most = 4096;
        Self {
            bins,
            legs: Vec::with_capacity(most),
            last: vec![0; bins * bins],
            entries: Vec::with_capacity(2 * most),
        }
    }

    fn bin(&self, x: f64) -> usize {
        ((x * self.bins as f64) as usize).min(self.bins - 1)
    }

    /// Notes a stretch between two neighbouring stations.
    pub fn note(&mut self, a: &TracePoint, b: &TracePoint) {
        // The cubic's middle, in the direction in which the stations come.
        let chord = b.x - a.x;
        let run = if chord.dot(a.tangent) < 0.0 { -chord.norm() } else { chord.norm() };
        let middle: Unknowns = std::array::from_fn(|k| {
            0.5 * (a.q[k] + b.q[k]) + 0.125 * run * (a.rate[k] - b.rate[k])
        });
        for (p, q) in [(a.q, middle), (middle, b.q)] {
            let number = self.legs.len() as u32;
            self.legs.push(Leg { from: p, inverse: std::array::from_fn(|k| 1.0 / (q[k] - p[k])) });
            let [us, vs] = [0, 1].map(|k| self.bin(p[k].min(q[k]))..=self.bin(p[k].max(q[k])));
            for i in us {
                for j in vs.clone() {
                    let last = &mut self.last[i * self.bins + j];
                    self.entries.push([number, *last]);
                    *last = self.entries.len() as u32;
                }
            }
        }
    }

    /// True if a branch passes both plates at the same point, or beside them.
    pub fn pass(&self, p: &Sight, q: &Sight) -> bool {
        let [p, q] = [p, q].map(|at| at.all.ranges[at.number]);
        let wider = |[a, b]: [f64; 2]| {
            let more = 0.5 * NEIGHBOUR_MARGIN * (b - a);
            [a - more, b + more]
        };
        let ranges = [p[0], p[1], q[0], q[1]].map(wider);
        // An adjacent bin that the plate only touches need not be tested.
        let [us, vs] = p.map(|[a, b]| {
            let less = 1e-9 * (b - a);
            self.bin(a + less)..self.bin(b - less) + 1
        });
        for i in us {
            for j in vs.clone() {
                let mut entry = self.last[i * self.bins + j];
                while entry > 0 {
                    let [leg, before] = self.entries[entry as usize - 1];
                    if self.legs[leg as usize].passes(&ranges) {
                        return true;
                    }
                    entry = before;
                }
            }
        }
        false
    }
}

impl Leg {
    /// True when it is within all four ranges somewhere.
    #[inline]
    fn passes(&self, ranges: &[[f64; 2]; 4]) -> bool {
        let (mut low, mut high): (f64, f64) = (0.0, 1.0);
        for k in 0..4 {
            let [a, b] = ranges[k].map(|x| (x - self.from[k]) * self.inverse[k]);
            low = low.max(a.min(b));
            high = high.min(a.max(b));
        }
        low <= high
    }
}

/// Treatment of pairs of plates in a descent.
pub(crate) trait Visitor {
    /// True when a pair needs no closer look although both may meet.
    fn done(&mut self, p: &Sight, q: &Sight) -> bool;
    /// Looks at a pair of cells; false when there were too many.
    fn cells(&mut self, p: &Sight, q: &Sight) -> bool;
}

/// Two surfaces whose pairs of plates are visited.
#[derive(Clone, Copy)]
pub(crate) struct Pairs<'a> {
    both: [&'a Plates; 2],
    /// Displacement from the origin of the first one's coordinates to that of the second's.
    shift: [f32; 3],
    margin: f32,
}

impl<'a> Pairs<'a> {
    pub fn new(first: &'a Plates, second: &'a Plates) -> Self {
        let shift = second.origin - first.origin;
        let margin = ROUNDING * (shift.norm() + first.radius + second.radius);
        let shift = shift.to_array().map(|x| x as f32);
        Self { both: [first, second], shift, margin: margin as f32 }
    }

    /// Goes down the plates below two pieces; false when the visitor ended it.
    pub fn descend(&self, pieces: [u32; 2], visitor: &mut impl Visitor) -> bool {
        pulp::Arch::new().dispatch(Descent { pairs: *self, pieces, visitor })
    }
}

struct Descent<'a, V> {
    pairs: Pairs<'a>,
    pieces: [u32; 2],
    visitor: &'a mut V,
}

impl<V: Visitor> pulp::NullaryFnOnce for Descent<'_, V> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let Descent { pairs: Pairs { both, shift, margin }, pieces: [i, j], visitor } = self;
        let [first, second] = both;
        let back = [-shift[0], -shift[1], -shift[2]];
        // Below a piece each halving leaves one pair more.
        let mut stack = [[0u32; 2]; STACK];
        stack[0] = [i, j];
        let (p, q) = (first.sight(i), second.sight(j));
        let mut count = usize::from(!p.apart(&q, shift, margin));
        while count > 0 {
            count -= 1;
            let [i, j] = stack[count];
            let (p, q) = (first.sight(i), second.sight(j));
            if visitor.done(&p, &q) {
                continue;
            }
            let (at, other) = (p.place(), q.place());
            if at.below | other.below == 0 {
                if !visitor.cells(&p, &q) {
                    return false;
                }
                continue;
            }
            // The longer one is halved. Whether a half is kept is unpredictable, so both are
            // written without a branch, and the count decides.
            let longer = p.plate().longest >= q.plate().longest;
            if at.below > 0 && (other.below == 0) | longer {
                let halves = [first.sight(at.below + 1), first.sight(at.below)];
                let facing = other.facing();
                let apart = [halves[0].place().apart(&facing), halves[1].place().apart(&facing)];
                for k in [0, 1] {
                    if !apart[k] {
                        stack[count] = [halves[k].number as u32, j];
                        let aside = halves[k].plate().aside(q.plate(), shift, margin);
                        count += usize::from(!aside);
                    }
                }
            } else {
                let halves = [second.sight(other.below + 1), second.sight(other.below)];
                let facing = at.facing();
                let apart = [halves[0].place().apart(&facing), halves[1].place().apart(&facing)];
                for k in [0, 1] {
                    if !apart[k] {
                        stack[count] = [i, halves[k].number as u32];
                        let aside = halves[k].plate().aside(p.plate(), back, margin);
                        count += usize::from(!aside);
                    }
                }
            }
        }
        true
    }
}
