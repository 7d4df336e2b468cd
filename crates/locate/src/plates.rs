//! Pairs of large parts of two surfaces that need no closer look.
//!
//! The halvings that lead from the pieces of a surface to its cells make a tree of plates: each is a
//! parallelogram with bounds of how far the surface bends away from it and of how its normals turn.
//! A search goes down the trees of both surfaces at once. A pair of plates is done when they are
//! apart, or when they meet in one line at most and a branch that was found before is that line.

use crate::cells::{Cells, Flat, derivative, patch_powers};
use crate::march::{Station, Unknowns};
use moldloft_num::{Box3, Vec3};

/// A branch that passes this share of a plate's half sides beside it passes it: where a line runs
/// along the border of two plates each of them has it.
const BESIDE: f64 = 0.15;

/// Turns are bounded on plates this much larger, so that there is one line at most beside them, too.
const WIDER: f64 = 1.2;

/// Boxes that overlap by less than this share of the size only touch.
const HAIR: f64 = 1e-12;

/// A part of a surface, from a piece down to a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plate {
    /// The parallelogram c + a s + b t, |s| and |t| <= 1, its unit normal, and how far the surface may
    /// be from it.
    c: Vec3,
    a: Vec3,
    b: Vec3,
    normal: Vec3,
    bend: f64,
    /// The box around it. Where the surface goes over a side of it into the next plate the side is
    /// moved in by a hair: plates that do nothing but touch there need not be looked at, for a line in
    /// which both surfaces meet goes on to plates that overlap, or has such on one of its sides.
    low: Vec3,
    high: Vec3,
    /// The longer side.
    longest: f64,
    /// How the normals change across the middle one, as shares of what is left of them along it: the
    /// coefficients of s, t, s^2, s t, t^2, and a bound of what these leave out.
    turns: [Vec3; 5],
    rest: f64,
    /// Its parameters, and where the surface goes on beyond them in the same direction.
    uv: [[f64; 2]; 2],
    pub smooth: bool,
    /// The first of its halves, which follow each other; 0 for a cell.
    below: u32,
    /// The cell that it is, if it is one.
    pub cell: u32,
}

impl Plate {
    /// The halves of a plate that is no cell.
    #[inline]
    fn halves(&self) -> Option<[u32; 2]> {
        (self.below > 0).then_some([self.below, self.below + 1])
    }

    /// True when both certainly have no common point.
    #[inline]
    pub fn apart(&self, o: &Plate) -> bool {
        let (p, q) = (self, o);
        if p.low.x > q.high.x
            || q.low.x > p.high.x
            || p.low.y > q.high.y
            || q.low.y > p.high.y
            || p.low.z > q.high.z
            || q.low.z > p.high.z
        {
            return true;
        }
        let d = q.c - p.c;
        let bend = p.bend + q.bend;
        let beyond = |n: Vec3, other: &Plate| {
            n.dot(d).abs() > n.dot(other.a).abs() + n.dot(other.b).abs() + bend
        };
        beyond(p.normal, q) || beyond(q.normal, p)
    }

    /// True when both surfaces certainly meet in one line at most here and beside.
    ///
    /// Seen along n1 x n2, the direction of the line, the normals of each turn by an angle of at most
    /// their change across n over what is left along n. While these angles together are less than the
    /// angle between n1 and n2, the distance of one surface from the other grows all the way across
    /// the line.
    #[inline]
    pub fn meet_in_one_line(&self, o: &Plate) -> bool {
        let sine_sq = self.normal.cross(o.normal).norm_sq();
        let across = |p: &Plate, n: Vec3| p.turns.iter().map(|m| m.dot(n).abs()).sum::<f64>();
        let rest = self.rest + o.rest;
        if rest * rest >= sine_sq {
            return false;
        }
        // Both normals' components across the line are over its sine: a + r sin < sin^2.
        let left = sine_sq - across(self, o.normal) - across(o, self.normal);
        left > 0.0 && left * left > rest * rest * sine_sq
    }
}

/// The plates of a surface.
#[derive(Clone, Debug)]
pub(crate) struct Plates {
    /// The pieces' first, in their order.
    pub all: Vec<Plate>,
    /// How many bins a side of the parameter square is divided into.
    pub bins: usize,
}

impl Plates {
    /// The plates of the halvings that are kept in `cells`, which are given up.
    pub fn new(cells: &mut Cells) -> Self {
        let twigs = std::mem::take(&mut cells.twigs);
        let pieces = cells.pieces.len();
        let hair = HAIR * cells.tree.size;
        let all = twigs.iter().map(|twig| {
            let patch = &twig.patch;
            let x = patch_powers(patch);
            let flat = Flat::new(patch, &x);
            // On a plate that is larger by a factor.
            let powers = [1.0, WIDER, WIDER.powi(2), WIDER.powi(3)];
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
            Plate {
                low,
                high,
                c: flat.c,
                a: flat.a,
                b: flat.b,
                normal,
                bend: flat.bend,
                longest: 2.0 * flat.a.norm().max(flat.b.norm()),
                turns: [0, 1, 2, 3, 4].map(|k| (turns[k] - normal * along[k]) * share),
                rest: if sure { rest * share } else { f64::INFINITY },
                uv: patch.uv,
                smooth,
                below: twig.below,
                cell: twig.cell,
            }
        });
        Self { all: all.collect(), bins: ((pieces as f64).sqrt().ceil() as usize).clamp(4, 64) }
    }
}

/// A short stretch of a branch, straight in the parameters of both surfaces, nearly.
#[derive(Clone, Copy, Debug)]
struct Leg {
    from: Unknowns,
    /// One over the way to its end.
    inverse: Unknowns,
}

/// The branches that were found, for the question which pairs of plates they pass.
#[derive(Debug)]
pub(crate) struct Trails {
    bins: usize,
    legs: Vec<Leg>,
    /// For each bin the last of its entries, plus one; 0 for none.
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
    pub fn note(&mut self, a: &Station, b: &Station) {
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

    /// True when a branch passes both plates at one place, or beside them.
    pub fn pass(&self, p: &Plate, q: &Plate) -> bool {
        let wider = |[a, b]: [f64; 2]| {
            let more = 0.5 * BESIDE * (b - a);
            [a - more, b + more]
        };
        let ranges = [p.uv[0], p.uv[1], q.uv[0], q.uv[1]].map(wider);
        // A bin beside another that the plate only touches need not be looked at.
        let [us, vs] = p.uv.map(|[a, b]| {
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

/// What a descent does with pairs of plates.
pub(crate) trait Visitor {
    /// True when a pair needs no closer look although both may meet.
    fn done(&mut self, p: &Plate, q: &Plate) -> bool;
    /// Looks at a pair of cells; false when there were too many.
    fn cells(&mut self, p: &Plate, q: &Plate) -> bool;
}

/// Goes down the plates below the pairs on the stack; false when the visitor ended it.
pub(crate) fn descend(
    [first, second]: [&Plates; 2],
    stack: &mut Vec<[u32; 2]>,
    visitor: &mut impl Visitor,
) -> bool {
    while let Some([i, j]) = stack.pop() {
        let (p, q) = (&first.all[i as usize], &second.all[j as usize]);
        if visitor.done(p, q) {
            continue;
        }
        match (p.halves(), q.halves()) {
            (None, None) => {
                if !visitor.cells(p, q) {
                    return false;
                }
            }
            (Some([a, b]), other) if other.is_none() || p.longest >= q.longest => {
                for k in [b, a] {
                    if !first.all[k as usize].apart(q) {
                        stack.push([k, j]);
                    }
                }
            }
            (_, Some([a, b])) => {
                for k in [b, a] {
                    if !p.apart(&second.all[k as usize]) {
                        stack.push([i, k]);
                    }
                }
            }
            (Some(_), None) => {}
        }
    }
    true
}
