//! A body as a union of intersections of half-spaces, each as large as the body allows.
//!
//! A formula may contain faces that are not on its body's surface: parts face to face, a cutter's
//! own ends, a recessed boss. The terms of its disjunctive form are prime implicants over the
//! combinations of sides that exist in space (Quine 1952): a term without points is left out, and
//! so is every face of a term that is a part of the body without it. Offsets and cuts of edges are
//! applied term by term.

use crate::expr::interval::{Interval, octants, sides as sides_of};
use crate::expr::tape::ExprTape;
use crate::query::separation::is_void;
use crate::set::body::surfaces_of;
use crate::set::{Leaf, Membership};
use crate::{FieldError, Form, Set, ValueGradient};
use moldloft_num::{Box3, Real, Vec3};
use rustc_hash::FxHashMap;
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::sync::Arc;

/// A set may have this many terms.
const MOST_TERMS: usize = 512;
/// Number of points of the box around a body, and of the space about it, in which terms are first
/// searched.
const SAMPLES: [usize; 2] = [3072, 1024];
/// Maximum number of boxes in the following search for a term.
const MOST_BOXES: usize = 1500;
/// A point is in a term if it is deeper in it than this, relative to the box.
const DEEP: f64 = 1e-9;

/// Intersections of literals; a literal is the number of a surface and its solid side: 2 k for the
/// negative side of surface k, 2 k + 1 for the positive one.
type LiteralTerm = Vec<u32>;

pub(super) struct BodyTerms<T: Real> {
    /// For every literal the half-space, with the attributes of its leaf.
    literals: Vec<Option<Leaf<T>>>,
    pub(super) terms: Vec<LiteralTerm>,
    /// True if parts far outside the box around the body may be missing.
    pub(super) near_only: bool,
    /// A box around the body.
    pub(super) over: Box3,
}

impl<T: Real> BodyTerms<T> {
    /// Terms of the body or of its complement.
    pub(super) fn of(set: &Set<T>, outside: bool) -> Result<Self, FieldError> {
        let compiled = set.compiled();
        let all = set.traversal();
        let plain =
            |p: &crate::Primitive<T>| Leaf { primitive: p.re(), attributes: Default::default() };
        let leaves: Vec<Leaf> =
            all.iter().chain(compiled.leaves.iter().map(|l| &l.primitive)).map(plain).collect();
        if leaves.iter().any(|l| l.primitive.is_sheet()) {
            return Err(FieldError::NoDistance { kind: "sheet" });
        }
        let (surfaces, sides) = surfaces_of(&leaves);
        let code = |k: usize| 2 * sides[k].surface + u32::from(sides[k].flipped);
        let mut literals: Vec<Option<Leaf<T>>> = vec![None; 2 * surfaces.len()];
        for (k, leaf) in compiled.leaves.iter().enumerate() {
            let at = code(all.len() + k) as usize;
            literals[at].get_or_insert_with(|| leaf.clone());
        }
        for k in 0..literals.len() {
            if literals[k].is_none()
                && let Some(other) = &literals[k ^ 1]
            {
                literals[k] = Some(Leaf {
                    primitive: -&other.primitive,
                    attributes: other.attributes.clone(),
                });
            }
        }
        let codes: FxHashMap<usize, u32> =
            all.iter().enumerate().map(|(k, p)| (p.identity(), code(k))).collect();
        let space = TermSpace::of(&set.re(), &literals, outside)?;
        let failed: RefCell<Option<FieldError>> = RefCell::new(None);
        let leaf = |p: &crate::Primitive<T>| match codes.get(&p.identity()) {
            Some(code) => vec![vec![code ^ u32::from(outside)]],
            None => Vec::new(),
        };
        let (every, none) = (vec![Vec::new()], Vec::new());
        let [everything, nothing] = if outside { [none, every] } else { [every, none] };
        let join = |union: bool, a: Vec<LiteralTerm>, b: Vec<LiteralTerm>| {
            if failed.borrow().is_some() {
                return Vec::new();
            }
            let joined = match union != outside {
                true => absorbed(a.into_iter().chain(b).collect()),
                false => space.product(&a, &b),
            };
            if joined.len() > MOST_TERMS {
                *failed.borrow_mut() = Some(FieldError::ManyFaces { most: MOST_TERMS });
            }
            joined
        };
        let terms = set.folded(&leaf, everything, nothing, &join);
        if let Some(e) = failed.into_inner() {
            return Err(e);
        }
        let terms = space.primes(terms);
        Ok(Self { literals, terms, near_only: space.near_only.get(), over: space.over })
    }

    /// The half-space of a literal.
    pub(super) fn literal(&self, code: u32) -> &Leaf<T> {
        // Every surface is that of a leaf.
        self.literals[code as usize].as_ref().expect("a literal of a leaf or of its complement")
    }

    /// The union of the terms, each the intersection of its literals as mapped by `leaf`.
    pub(super) fn set(
        &self,
        leaf: &dyn Fn(&Leaf<T>) -> Result<Set<T>, FieldError>,
    ) -> Result<Set<T>, FieldError> {
        let mut out = Set::nothing();
        for term in &self.terms {
            let mut part = Set::everything();
            for &code in term {
                part = part & leaf(self.literal(code))?;
            }
            out = out | part;
        }
        Ok(out)
    }
}

/// Without terms that are part of others by their literals alone.
fn absorbed(mut terms: Vec<LiteralTerm>) -> Vec<LiteralTerm> {
    terms.sort_by(|a, b| a.len().cmp(&b.len()).then_with(|| a.cmp(b)));
    terms.dedup();
    let mut out: Vec<LiteralTerm> = Vec::with_capacity(terms.len());
    for term in terms {
        let within =
            |small: &LiteralTerm| small.iter().all(|code| term.binary_search(code).is_ok());
        if !out.iter().any(within) {
            out.push(term);
        }
    }
    out
}

type SampleBits = Vec<u64>;

fn bits(flags: impl Iterator<Item = bool>) -> SampleBits {
    let mut out = Vec::new();
    for (k, flag) in flags.enumerate() {
        if k % 64 == 0 {
            out.push(0);
        }
        if flag {
            out[k / 64] |= 1 << (k % 64);
        }
    }
    out
}

/// Region in which terms are searched.
struct TermSpace {
    over: Box3,
    wide: Box3,
    /// The body, or its complement.
    target: Set,
    literals: Vec<Set>,
    /// For every literal the sample points strictly inside.
    inside: Vec<SampleBits>,
    /// The sample points strictly outside of the target.
    missed: SampleBits,
    near_only: Cell<bool>,
}

/// A box around the characteristic points of primitives, for sets without end.
fn about(set: &Set) -> Box3 {
    let mut points = Vec::new();
    for leaf in set.leaves() {
        let (at, reach) = match leaf.primitive.form() {
            Form::Plane(p) => (p.point, 1.0),
            Form::Sphere { centre, radius } => (*centre, *radius),
            Form::Cylinder { axis, radius } => (axis.point, *radius),
            Form::Cone { axis, .. } => (axis.point, 1.0),
            Form::Torus { axis, major, minor } => (axis.point, major + minor),
            _ => continue,
        };
        let more = Vec3::of(reach, reach, reach);
        points.extend([at - more, at + more]);
    }
    if points.is_empty() {
        points.extend([Vec3::of(-1.0, -1.0, -1.0), Vec3::of(1.0, 1.0, 1.0)]);
    }
    widened(&Box3::around(points), 1.0)
}

/// A box extended on every side by that fraction of its diagonal.
fn widened(over: &Box3, share: f64) -> Box3 {
    let more = share * over.diagonal();
    let more = Vec3::of(more, more, more);
    Box3 { low: over.low - more, high: over.high + more }
}

/// Points spread over a box by multiples of irrational numbers.
fn spread(over: &Box3, count: usize) -> impl Iterator<Item = Vec3> + '_ {
    // Powers of the inverse of the real root of x^4 = x + 1.
    const STEPS: [f64; 3] =
        [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3];
    (0..count).map(move |k| {
        Vec3::from([0, 1, 2].map(|axis| {
            let share = (0.5 + STEPS[axis] * (k + 1) as f64).fract();
            over.low[axis] + share * (over.high[axis] - over.low[axis])
        }))
    })
}

impl TermSpace {
    fn of<T: Real>(
        set: &Set,
        literals: &[Option<Leaf<T>>],
        outside: bool,
    ) -> Result<Self, FieldError> {
        let over = match crate::query::bounds::around(set) {
            Ok(Some(over)) => over,
            Ok(None) | Err(FieldError::Unbounded { .. }) => about(set),
            Err(e) => return Err(e),
        };
        let wide = widened(&over, 2.0);
        let points: Vec<Vec3> =
            spread(&over, SAMPLES[0]).chain(spread(&wide, SAMPLES[1])).collect();
        let literals: Vec<Set> = literals
            .iter()
            .map(|l| l.as_ref().map_or_else(Set::nothing, |l| Set::of_leaf(&l.primitive.re())))
            .collect();
        let target = if outside { set.complement() } else { set.clone() };
        let mut values = vec![0.0; points.len()];
        let mut signs = |set: &Set, sign: f64| {
            set.values(&points, &mut values);
            bits(values.iter().map(|v| v * sign > 0.0))
        };
        let inside = literals.iter().map(|l| signs(l, -1.0)).collect();
        let missed = signs(&target, 1.0);
        Ok(Self { over, wide, target, literals, inside, missed, near_only: Cell::new(false) })
    }

    /// True when a sample point is in a term and, where that is given, in `also`.
    fn is_seen(&self, term: &[u32], also: Option<&SampleBits>) -> bool {
        let words = self.missed.len();
        (0..words).any(|w| {
            let start = also.map_or(u64::MAX, |bits| bits[w]);
            term.iter().fold(start, |all, &code| all & self.inside[code as usize][w]) != 0
        })
    }

    fn region(&self, term: &[u32]) -> Set {
        term.iter().fold(Set::everything(), |s, &code| s & self.literals[code as usize].clone())
    }

    /// True if a set has interior points.
    fn holds(&self, set: &Set) -> bool {
        if set.is_nothing() || is_void(set) {
            return false;
        }
        let found = holds_in(set, &self.over) || holds_in(set, &self.wide);
        if !found {
            self.near_only.set(true);
        }
        found
    }

    fn has_points(&self, term: &[u32]) -> bool {
        term.is_empty() || self.is_seen(term, None) || self.holds(&self.region(term))
    }

    /// The intersection of two unions of terms.
    fn product(&self, a: &[LiteralTerm], b: &[LiteralTerm]) -> Vec<LiteralTerm> {
        let mut out = Vec::new();
        for (x, y) in a.iter().flat_map(|x| b.iter().map(move |y| (x, y))) {
            let mut term: LiteralTerm = x.iter().chain(y).copied().collect();
            term.sort_unstable();
            term.dedup();
            let contradicts = term.windows(2).any(|w| w[0] ^ 1 == w[1]);
            if contradicts || !self.has_points(&term) {
                continue;
            }
            // Removes faces that do not cut the intersection of the others.
            let mut k = 0;
            while k < term.len() {
                let mut other = term.clone();
                other[k] ^= 1;
                if self.is_seen(&other, None) || self.holds(&self.region(&other)) {
                    k += 1;
                } else {
                    term.remove(k);
                }
            }
            out.push(term);
            if out.len() > 8 * MOST_TERMS {
                break;
            }
        }
        absorbed(out)
    }

    /// The terms without faces that they can do without as parts of the target.
    fn primes(&self, terms: Vec<LiteralTerm>) -> Vec<LiteralTerm> {
        let outside = self.target.complement();
        let mut out = Vec::with_capacity(terms.len());
        for mut term in terms {
            if !self.has_points(&term) {
                continue;
            }
            let mut k = 0;
            while k < term.len() {
                let mut rest = term.clone();
                rest.remove(k);
                let more = || self.holds(&(self.region(&rest) & outside.clone()));
                if self.is_seen(&rest, Some(&self.missed)) || more() {
                    k += 1;
                } else {
                    term = rest;
                }
            }
            out.push(term);
        }
        absorbed(out)
    }
}

/// True when a point of a set is found in a box, by halving it: the largest parts first.
fn holds_in(set: &Set, over: &Box3) -> bool {
    let body = set.as_body();
    let mut pending: VecDeque<([Interval; 3], Arc<ExprTape<f64>>)> = VecDeque::new();
    pending.push_back((sides_of(over), body.compiled.tape.clone()));
    let (mut room, mut values) = (Vec::new(), Vec::new());
    for _ in 0..MOST_BOXES {
        let Some((sides, tape)) = pending.pop_front() else { return false };
        let range = tape.range(&sides, &mut room);
        if range.low >= 0.0 {
            continue;
        }
        if range.high < 0.0 {
            return true;
        }
        let tape = tape.pruned(&room).map_or(tape, Arc::new);
        match body.one_state(&tape) {
            Some(Membership::Solid) => return true,
            Some(_) => continue,
            None => {}
        }
        if is_deep(&tape, &sides, over, &mut values) {
            return true;
        }
        pending.extend(octants(&sides).map(|half| (half, tape.clone())));
    }
    false
}

/// True when the centre of a box is in the set, and not only to rounding.
fn is_deep(
    tape: &ExprTape<f64>,
    sides: &[Interval; 3],
    over: &Box3,
    values: &mut Vec<ValueGradient<f64>>,
) -> bool {
    let centre = Vec3::from(sides.map(|s| s.middle()));
    let g = tape.eval::<ValueGradient<f64>>(&centre, values);
    g.value < -DEEP * over.diagonal() * g.slope.norm()
}
