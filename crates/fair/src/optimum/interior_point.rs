//! The interior point method of [`crate::optimum::problem`], for D coordinates.
//!
//! All lists are over unknowns: points that stay fixed are left out of the rows, for their
//! displacement is zero.

use crate::optimum::band::Band;
use crate::optimum::problem::{Active, CertifiedSolution, NONE, Problem, UnknownOrder};
use crate::optimum::schur::{LinearConstraint, Schur, met};
use crate::optimum::second_order_cone::{ConeScaling, Pair, V, axpy, dot};
use crate::optimum::squares_bound::{BoundStep, SquaresBound};
use crate::{FairError, RowNorm, SparseRows};
use moldloft_num::Real;

const MOST_ITERATIONS: usize = 80;

/// Relative gap at which the reached limits become visible, and the next one if they did not: the
/// solution is polished there.
const SHOWS: f64 = 1e-7;

/// Newton steps without a better certificate after which it will not get better.
const MOST_IDLE: usize = 6;

/// Step, relative to Newton's, that counts as no move.
const STUCK: f64 = 1e-9;

/// Maximum number of trials as long as the conditions are not met.
const MOST_TRIALS: usize = 12;

/// Ratio of the complementarity to the certified gap below which the remaining gap is rounding.
const ROUNDING: f64 = 1e-3;

/// Relative gap above which a better dual point is worth computing.
const REFINED: f64 = 1e-6;

/// Maximum number of unknowns for polishing a solution that rounding ended: with more, squares of
/// fourth differences have too few digits left.
const POLISHED: usize = 1000;

/// The largest matrix of which the measure's share is kept beside the sum.
const KEPT: usize = 1 << 24;

/// Distance inside a half-space that the solution aims at, relative to its scale, so that rounding and the
/// last step cannot leave it.
const INSIDE: f64 = 1e-9;

/// A half-space over unknowns, with its slack and its force.
struct Half<const D: usize> {
    entries: Vec<(usize, V<D>)>,
    room: f64,
    scale: f64,
    slack: f64,
    force: f64,
}

impl<const D: usize> Half<D> {
    fn at(&self, x: &[V<D>]) -> f64 {
        self.entries.iter().map(|(i, factor)| dot(*factor, x[*i])).sum()
    }

    /// Residual of the slack at a displacement.
    fn rest(&self, x: &[V<D>]) -> f64 {
        self.room - self.at(x) - self.slack
    }

    /// Stiffness of the measure against a move of it, by the diagonal of its matrix: that of the point
    /// that moves it most.
    fn own_stiffness(&self, h: &[f64]) -> f64 {
        let stiffness = |(i, f): &(usize, V<D>)| h[*i] / dot(*f, *f).max(f64::MIN_POSITIVE);
        let largest = self.entries.iter().map(|(_, f)| dot(*f, *f)).fold(0.0, f64::max);
        let near = self.entries.iter().filter(|(_, f)| dot(*f, *f) > 0.25 * largest);
        near.map(stiffness).fold(0.0, f64::max)
    }

    /// Violation, relative to its scale.
    fn outside(&self, x: &[V<D>]) -> f64 {
        let off = self.at(x) - self.room;
        if off <= 0.0 { 0.0 } else { off / self.scale.max(f64::MIN_POSITIVE) }
    }
}

pub(crate) struct InteriorPointState<'a, const D: usize> {
    pub p: &'a Problem,
    pub order: UnknownOrder,
    /// Projections of unknowns on the directions in which they move.
    held: Vec<(usize, [V<D>; D])>,
    pub measure: SparseRows,
    pub limit_rows: SparseRows,
    offsets: Vec<V<D>>,
    pub reach: Vec<f64>,
    pub conditions: Vec<LinearConstraint<D>>,
    halves: Vec<Half<D>>,
    squares: Option<SquaresBound<D>>,
    pub x: Vec<V<D>>,
    /// Start of the search.
    begin: Vec<V<D>>,
    /// Cones of the limits, then those of the lengths.
    pub cones: Vec<ConeScaling<D>>,
    pub nu: Vec<f64>,
    /// Set once the solution is polished.
    pub active: Option<Active>,
    /// The part of the matrix from the measure.
    base: Option<Band>,
    /// A bound on the gap by a better dual point than that of the displacements.
    refined: Option<f64>,
}

/// Factors over unknowns in rising order, one for each.
fn ordered<const D: usize>(entries: &[(usize, V<3>)], place: &[u32]) -> Vec<(usize, V<D>)> {
    let moving = entries.iter().filter(|(i, _)| place[*i] != NONE);
    let mut out: Vec<(usize, V<D>)> = moving.map(|(i, f)| (place[*i] as usize, cut(f))).collect();
    out.sort_by_key(|entry| entry.0);
    out.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            axpy(&mut kept.1, 1.0, next.1);
        }
        same
    });
    out
}

/// A Newton step.
struct NewtonDirection<const D: usize> {
    x: Vec<V<D>>,
    /// The complementarity of each cone that is aimed at.
    goals: Vec<Pair<D>>,
    /// Slack and dual of each cone.
    u: Vec<Pair<D>>,
    y: Vec<Pair<D>>,
    /// Slack and force of each half-space.
    halves: Vec<(f64, f64)>,
    squares: BoundStep,
    nu: Vec<f64>,
}

impl<const D: usize> NewtonDirection<D> {
    fn zero(unknowns: usize, cones: usize, halves: usize) -> Self {
        let none = vec![(0.0, [0.0; D]); cones];
        Self {
            x: vec![[0.0; D]; unknowns],
            goals: none.clone(),
            u: none.clone(),
            y: none,
            halves: vec![(0.0, 0.0); halves],
            squares: BoundStep::default(),
            nu: Vec::new(),
        }
    }

    /// A sum is finite when its terms are, unless they are far beyond any use.
    fn is_finite(&self) -> bool {
        let pair = |p: &Pair<D>| p.0 + p.1.iter().sum::<f64>();
        let cones: f64 = self.u.iter().chain(&self.y).map(pair).sum();
        let halves: f64 = self.halves.iter().map(|(s, z)| s + z).sum();
        let rest = self.squares.sum() + self.x.as_flattened().iter().sum::<f64>();
        (cones + halves + rest).is_finite()
    }
}

/// The first D coordinates.
#[inline(always)]
fn cut<T: Copy, const D: usize>(v: &[T; 3]) -> [T; D] {
    std::array::from_fn(|c| v[c])
}

#[inline(always)]
fn widened<const D: usize>(v: V<D>) -> V<3> {
    let mut out = [0.0; 3];
    out[..D].copy_from_slice(&v);
    out
}

/// Row `k` times the unknowns.
#[inline(always)]
pub(crate) fn apply<const D: usize>(rows: &SparseRows, k: usize, x: &[V<D>]) -> V<D> {
    let (columns, factors) = rows.row(k);
    let mut sum = [0.0; D];
    for (&c, &a) in columns.iter().zip(factors) {
        axpy(&mut sum, a, x[c as usize]);
    }
    sum
}

/// Adds the transpose of row `k` times `y` to `sum`.
#[inline(always)]
pub(crate) fn spread<const D: usize>(rows: &SparseRows, k: usize, y: V<D>, sum: &mut [V<D>]) {
    let (columns, factors) = rows.row(k);
    for (&c, &a) in columns.iter().zip(factors) {
        axpy(&mut sum[c as usize], a, y);
    }
}

/// Adds P^T W P to the matrix.
#[inline(always)]
pub(crate) fn add_block<const D: usize>(
    band: &mut Band,
    rows: &SparseRows,
    k: usize,
    w: &[V<D>; D],
) {
    let (columns, factors) = rows.row(k);
    for (i, (&ci, &ai)) in columns.iter().zip(factors).enumerate() {
        for (&cj, &aj) in columns[..=i].iter().zip(factors) {
            band.add_block(ci as usize, cj as usize, ai * aj, w);
        }
    }
}

pub(crate) fn identity<const D: usize>() -> [V<D>; D] {
    std::array::from_fn(|r| std::array::from_fn(|c| f64::from(u8::from(r == c))))
}

impl<'a, const D: usize> InteriorPointState<'a, D> {
    pub fn new(p: &'a Problem, order: UnknownOrder) -> Self {
        let place = &order.place;
        let mut reach = vec![0.0; order.unknowns];
        for (&at, &r) in place.iter().zip(&p.reach) {
            if at != NONE {
                reach[at as usize] = r;
            }
        }
        let condition = |c: &crate::optimum::problem::EqualityConstraint| LinearConstraint {
            entries: c
                .entries
                .iter()
                .filter(|(i, _)| place[*i] != NONE)
                .map(|(i, f)| (place[*i] as usize, cut(f)))
                .collect(),
            value: c.value,
        };
        let half = |h: &crate::optimum::problem::InequalityConstraint| Half {
            entries: ordered(&h.entries, place),
            room: h.room - INSIDE * h.scale,
            scale: h.scale,
            slack: 0.0,
            force: 0.0,
        };
        let mut begin = vec![[0.0; D]; order.unknowns];
        for (&at, v) in place.iter().zip(&p.begin) {
            if at != NONE {
                begin[at as usize] = cut(v);
            }
        }
        let unknown = |i: usize| Some(place[i]).filter(|&at| at != NONE).map(|at| at as usize);
        Self {
            p,
            held: p.held.over(unknown),
            halves: p.halves.iter().map(half).collect(),
            squares: p.squares.as_ref().map(|(rows, offsets, most)| {
                let offsets = offsets.iter().map(cut).collect();
                SquaresBound::new(rows.renumbered(place), offsets, *most, order.unknowns)
            }),
            measure: p.measure.renumbered(place),
            limit_rows: p.bounds.rows.renumbered(place),
            offsets: p.offsets.iter().map(cut).collect(),
            reach,
            conditions: p.conditions.iter().map(condition).collect(),
            x: begin.clone(),
            begin,
            cones: Vec::new(),
            nu: vec![0.0; p.conditions.len()],
            active: None,
            base: None,
            refined: None,
            order,
        }
    }

    pub fn unknowns(&self) -> usize {
        self.order.unknowns
    }

    /// The zero matrix of the unknowns; the measure's share is computed once where it is not huge.
    pub fn band(&mut self) -> Result<Band, FairError> {
        let mut band = Band::zero(self.unknowns() * D, D * (self.order.span + 1) - 1)?;
        if self.p.norm == RowNorm::Square && band.size() <= KEPT {
            self.add_measure(&mut band);
            self.base = Some(band.clone());
        }
        Ok(band)
    }

    /// Projects vectors of the unknowns on the directions in which these move.
    pub fn project<T: Real>(&self, x: &mut [[T; D]]) {
        for (at, rows) in &self.held {
            let v = x[*at];
            x[*at] = rows.map(|row| (0..D).fold(T::zero(), |sum, c| sum + v[c] * row[c]));
        }
    }

    /// Factors the matrix, restricted to the directions in which the unknowns move.
    pub fn factor(&self, band: &mut Band) {
        band.restrict(&self.held);
        band.factor();
    }

    fn add_measure(&self, band: &mut Band) {
        for k in 0..self.measure.len() {
            add_block(band, &self.measure, k, &identity::<D>());
        }
    }

    /// Makes the matrix P'P of a measure of squares, zero of one of lengths.
    pub fn begin(&self, band: &mut Band) {
        match &self.base {
            Some(base) => band.copy(base),
            None => {
                band.clear();
                if self.p.norm == RowNorm::Square {
                    self.add_measure(band);
                }
            }
        }
    }

    /// Row `k` of the measure at displacements `x`.
    #[inline(always)]
    pub fn error_at(&self, k: usize, x: &[V<D>]) -> V<D> {
        let mut e = self.offsets[k];
        axpy(&mut e, 1.0, apply(&self.measure, k, x));
        e
    }

    #[inline(always)]
    fn error(&self, k: usize) -> V<D> {
        self.error_at(k, &self.x)
    }

    /// Coordinate groups of a limit.
    pub fn groups(&self) -> usize {
        if self.p.bounds.separate { D } else { 1 }
    }

    /// The number of cones of limits; cone c belongs to limit c / groups.
    pub fn limits(&self) -> usize {
        self.limit_rows.len() * self.groups()
    }

    /// The part of a limit's row that cone `c` is about.
    #[inline(always)]
    pub fn part(&self, c: usize, s: V<D>) -> V<D> {
        if !self.p.bounds.separate {
            return s;
        }
        let mut only = [0.0; D];
        only[c % D] = s[c % D];
        only
    }

    /// The rows of cone `c`.
    #[inline(always)]
    pub fn rows_of(&self, c: usize) -> (&SparseRows, usize) {
        match c.checked_sub(self.limits()) {
            None => (&self.limit_rows, if self.p.bounds.separate { c / D } else { c }),
            Some(k) => (&self.measure, k),
        }
    }

    fn assemble(&self, band: &mut Band) {
        self.begin(band);
        let limits = self.limits();
        for (c, cone) in self.cones.iter().enumerate() {
            let mut w = cone.stiffness(c >= limits);
            if c < limits && self.p.bounds.separate {
                let own = w[c % D][c % D];
                w = [[0.0; D]; D];
                w[c % D][c % D] = own;
            }
            let (rows, k) = self.rows_of(c);
            add_block(band, rows, k, &w);
        }
        if let Some(squares) = &self.squares {
            squares.assemble(band);
        }
        for half in &self.halves {
            let stiffness = half.force / half.slack;
            for (at, (i, a)) in half.entries.iter().enumerate() {
                for (j, b) in &half.entries[..=at] {
                    let w: [V<D>; D] = std::array::from_fn(|r| b.map(|x| a[r] * x));
                    band.add_block(*i, *j, stiffness, &w);
                }
            }
        }
    }

    /// The Newton direction towards the centre `mu`, corrected for the second-order terms of
    /// `before` when given, else towards complementarity itself. The dual residual is removed whole.
    fn direction(
        &self,
        band: &Band,
        dense: &Schur,
        mu: f64,
        before: Option<&NewtonDirection<D>>,
        out: &mut NewtonDirection<D>,
    ) {
        let limits = self.limits();
        out.x.fill([0.0; D]);
        if self.p.norm == RowNorm::Square {
            for k in 0..self.measure.len() {
                spread(&self.measure, k, self.error(k).map(|c| -c), &mut out.x);
            }
        }
        for (c, cone) in self.cones.iter().enumerate() {
            let goal = cone.goal(before.map(|d| (mu, &d.u[c], &d.y[c])));
            out.goals[c] = goal;
            if before.is_none() && c < limits {
                // The dual and its whole change cancel.
                continue;
            }
            let mut force = cone.y.1;
            axpy(&mut force, 1.0, cone.fixed(&goal, c >= limits));
            let (rows, k) = self.rows_of(c);
            spread(rows, k, force, &mut out.x);
        }
        // s z + s dz + z ds = goal with ds = rest - w dx, so z + dz = push + (z / s) w dx.
        let goal = |k: usize, half: &Half<D>| match before {
            Some(d) => mu - half.slack * half.force - d.halves[k].0 * d.halves[k].1,
            None => -half.slack * half.force,
        };
        for (k, half) in self.halves.iter().enumerate() {
            let push = half.force + (goal(k, half) - half.force * half.rest(&self.x)) / half.slack;
            for (i, factor) in &half.entries {
                axpy(&mut out.x[*i], -push, *factor);
            }
        }
        let towards = before.map(|d| (mu, &d.squares));
        if let Some(squares) = &self.squares {
            let towards = before.map(|d| (mu, &d.squares, d.x.as_slice()));
            squares.push(towards, &mut out.x);
        }
        self.inverse(band, &mut out.x);
        // Conditions by their Schur complement: x = x0 - Y nu, A x = b - A x_now.
        out.nu = dense.solve(&self.conditions, &self.x, out.x.as_flattened_mut());
        for (c, cone) in self.cones.iter().enumerate() {
            let (rows, k) = self.rows_of(c);
            let length = c >= limits;
            let mut de = apply(rows, k, &out.x);
            if !length {
                de = self.part(c, de);
            }
            let (du, dy) = cone.change(&out.goals[c], de, length);
            out.u[c] = du;
            out.y[c] = if length { dy } else { (dy.0, self.part(c, dy.1)) };
        }
        for (k, half) in self.halves.iter().enumerate() {
            let ds = half.rest(&self.x) - half.at(&out.x);
            out.halves[k] = (ds, (goal(k, half) - half.force * ds) / half.slack);
        }
        if let Some(squares) = &self.squares {
            out.squares = squares.change(towards, &out.x);
        }
    }

    /// The system of the conditions' multipliers by the factored matrix.
    pub fn schur(&self, band: &Band) -> Schur {
        let inverse = |y: &mut [f64]| self.inverse(band, y.as_chunks_mut().0);
        Schur::new(&self.conditions, self.x.len(), &inverse, self.p.refined)
    }

    /// Solves with the factored matrix, in place.
    pub fn inverse(&self, band: &Band, x: &mut [V<D>]) {
        self.project(x);
        band.solve(x.as_flattened_mut());
        if let Some(squares) = &self.squares {
            squares.correct(x.as_flattened_mut());
        }
        self.project(x);
    }

    /// The longest step along `d` that keeps all cones, at most 2.
    fn longest(&self, d: &NewtonDirection<D>) -> f64 {
        let each = self.cones.iter().zip(&d.u).zip(&d.y);
        let step = each.fold(2.0, |step, ((cone, &du), &dy)| cone.longest(du, dy, step));
        let step = self.squares.as_ref().map_or(step, |s| s.longest(&d.squares, step));
        let least = |step: f64, (now, by): (f64, f64)| {
            if by < 0.0 { step.min(-now / by) } else { step }
        };
        self.halves
            .iter()
            .zip(&d.halves)
            .fold(step, |step, (half, d)| least(least(step, (half.slack, d.0)), (half.force, d.1)))
    }

    /// The sum of complementarities.
    fn complementarity(&self) -> f64 {
        let cones: f64 = self.cones.iter().map(|c| c.u.0 * c.y.0 + dot(c.u.1, c.y.1)).sum();
        let squares = self.squares.as_ref().map_or(0.0, SquaresBound::complementarity);
        cones + squares + self.halves.iter().map(|h| h.slack * h.force).sum::<f64>()
    }

    fn step(&mut self, d: &NewtonDirection<D>, by: f64) {
        for (x, dx) in self.x.iter_mut().zip(&d.x) {
            axpy(x, by, *dx);
        }
        let limits = self.limits();
        for c in 0..self.cones.len() {
            // Slacks are recomputed from x, so they never drift from it.
            let inner = if c < limits {
                let (rows, k) = self.rows_of(c);
                let mut s: V<D> = cut(&self.p.bounds.offset(k));
                axpy(&mut s, 1.0, apply(rows, k, &self.x));
                self.part(c, s)
            } else {
                self.error(c - limits)
            };
            let cone = &mut self.cones[c];
            cone.u = (cone.u.0 + by * d.u[c].0, inner);
            cone.y.0 += by * d.y[c].0;
            axpy(&mut cone.y.1, by, d.y[c].1);
        }
        for (nu, new) in self.nu.iter_mut().zip(&d.nu) {
            *nu += by * (new - *nu);
        }
        for (half, d) in self.halves.iter_mut().zip(&d.halves) {
            half.slack += by * d.0;
            half.force += by * d.1;
        }
        if let Some(squares) = &mut self.squares {
            squares.step(&d.squares, by, &self.x);
        }
    }

    /// The measure and a rigorous bound on the optimality gap.
    ///
    /// With any z (|z| <= 1 for lengths, e for squares) and g = P^T z, every allowed y has
    /// f(y) >= f(x) - sum(|e| - z . e) + g (y - x). For any forces m and nu,
    /// g = -Q^T m - A^T nu - C^T z + rest, z >= 0, so
    /// g (x - y) <= sum (r |m| - m . s) + z . (d - C x) + |rest| (|x| + reach).
    fn certificate(&self) -> (f64, f64) {
        let p = self.p;
        let limits = self.limits();
        let mut slope = vec![[0.0; D]; self.x.len()];
        let (mut value, mut gap) = (0.0, 0.0);
        for k in 0..self.measure.len() {
            let e = self.error(k);
            let z = match p.norm {
                RowNorm::Square => {
                    value += 0.5 * dot(e, e);
                    e
                }
                RowNorm::Length => {
                    let z = self.cones[limits + k].y.1.map(|c| -c);
                    let length = dot(e, e).sqrt();
                    value += length;
                    gap += length - dot(z, e);
                    z
                }
            };
            spread(&self.measure, k, z, &mut slope);
        }
        gap += self.add_linear(&mut slope);
        if let Some(squares) = &self.squares {
            gap += squares.certify(&self.x, &mut slope);
        }
        self.project(&mut slope);
        let norm = |v: V<D>| {
            if p.bounds.separate { v.iter().map(|c| c.abs()).sum() } else { dot(v, v).sqrt() }
        };
        for k in 0..self.limit_rows.len() {
            let r = p.bounds.radii[k];
            if p.bounds.direct && p.bounds.offsets.is_empty() {
                // One limit per point: the force is eliminated, nothing is trusted.
                // Points that do not vary are no unknowns.
                let Some(&i) = self.limit_rows.row(k).0.first() else { continue };
                let i = i as usize;
                let g = std::mem::replace(&mut slope[i], [0.0; D]);
                gap += dot(g, self.x[i]) + r * norm(g);
            } else {
                let mut s: V<D> = cut(&p.bounds.offset(k));
                axpy(&mut s, 1.0, apply(&self.limit_rows, k, &self.x));
                let mut force = [0.0; D];
                for g in 0..self.groups() {
                    axpy(&mut force, -1.0, self.cones[k * self.groups() + g].y.1);
                }
                gap += r * norm(force) - dot(force, s);
                spread(&self.limit_rows, k, force, &mut slope);
            }
        }
        self.project(&mut slope);
        for ((rest, x), reach) in slope.iter().zip(&self.x).zip(&self.reach) {
            let rest = dot(*rest, *rest).sqrt();
            gap += if rest == 0.0 { 0.0 } else { rest * (dot(*x, *x).sqrt() + reach) };
        }
        (value, gap.max(0.0))
    }

    /// Adds the forces of conditions and half-spaces to a slope; returns the part of the gap from
    /// the half-spaces.
    pub fn add_linear(&self, slope: &mut [V<D>]) -> f64 {
        let mut gap = 0.0;
        for (condition, nu) in self.conditions.iter().zip(&self.nu) {
            for (i, factor) in &condition.entries {
                axpy(&mut slope[*i], *nu, *factor);
            }
        }
        for half in &self.halves {
            gap += half.force * (half.room - half.at(&self.x)).max(0.0);
            for (i, factor) in &half.entries {
                axpy(&mut slope[*i], half.force, *factor);
            }
        }
        gap
    }

    /// By how much each condition is missed, relative to what the limits let it vary.
    fn misses(&self) -> Vec<f64> {
        let of = |c: &LinearConstraint<D>| {
            let most = |(i, f): &(usize, V<D>)| dot(*f, *f).sqrt() * self.reach[*i].min(1e300);
            let scale: f64 = c.entries.iter().map(most).sum();
            let off = (met(c, &self.x) - c.value).abs();
            if off == 0.0 { 0.0 } else { off / scale.max(f64::MIN_POSITIVE) }
        };
        self.conditions.iter().map(of).collect()
    }

    /// The largest miss of a condition; of a half-space what passes it in truth.
    fn missed(&self) -> f64 {
        let halves = self.halves.iter().map(|h| h.outside(&self.x) - 0.5 * INSIDE);
        self.misses().into_iter().chain(halves).fold(0.0, f64::max)
    }

    /// Centred starting duals of the size of the slopes.
    fn start(&mut self) {
        let mut slope = vec![[0.0; D]; self.x.len()];
        let errors: Vec<V<D>> = (0..self.measure.len()).map(|k| self.error(k)).collect();
        let mean =
            errors.iter().map(|e| dot(*e, *e).sqrt()).sum::<f64>() / errors.len().max(1) as f64;
        // Lengths change by about as much as points move: where all are zero, that is their size.
        let radii = || self.p.bounds.radii.iter().filter(|r| r.is_finite());
        let radius = radii().sum::<f64>() / radii().count().max(1) as f64;
        let mu = mean.max(0.1 * radius).max(1e-200);
        let mut lengths = Vec::new();
        for (k, &e) in errors.iter().enumerate() {
            let mut z = e;
            if self.p.norm == RowNorm::Length {
                let t = 0.5 * (mu + (mu * mu + 4.0 * dot(e, e)).sqrt());
                z = e.map(|c| c / t);
                lengths.push(ConeScaling::new((t, e), (1.0, z.map(|c| -c))));
            }
            spread(&self.measure, k, z, &mut slope);
        }
        let total: f64 = slope.iter().map(|s| dot(*s, *s).sqrt()).sum();
        let force = (total / slope.len().max(1) as f64).max(1e-200);
        if let Some(squares) = &mut self.squares {
            squares.start(force * radius.max(1e-200), &self.x);
        }
        for (k, &radius) in self.p.bounds.radii.iter().enumerate() {
            let mut offset: V<D> = cut(&self.p.bounds.offset(k));
            axpy(&mut offset, 1.0, apply(&self.limit_rows, k, &self.x));
            for c in 0..self.groups() {
                let inner = self.part(c, offset);
                self.cones.push(ConeScaling::new((radius, inner), (force, [0.0; D])));
            }
        }
        self.cones.extend(lengths);
        let size = |f: &[(usize, V<D>)]| f.iter().map(|(_, f)| dot(*f, *f).sqrt()).sum::<f64>();
        for half in &mut self.halves {
            // If it is outside, it begins with a positive slack, and enters step by step.
            half.slack = (half.room - half.at(&self.x)).abs().max(0.1 * half.scale).max(1e-200);
            half.force = force / size(&half.entries).max(f64::MIN_POSITIVE);
        }
    }

    /// True if the objective is a sum of squares without a bound on another.
    fn of_squares(&self) -> bool {
        self.p.norm == RowNorm::Square && self.squares.is_none()
    }

    /// True if the last digits can be polished: not under half-spaces.
    fn polished(&self) -> bool {
        self.of_squares() && self.halves.is_empty()
    }

    /// True if limits have forces of their own: those of control points are the slope.
    fn bounds_data(&self) -> bool {
        let bounds = &self.p.bounds;
        !(bounds.direct && bounds.offsets.is_empty())
    }

    /// True if a polished solution meets the accuracy.
    fn polished_to(&self, accuracy: f64, floor: f64, margin: f64) -> bool {
        let (value, gap) = self.certificate();
        // The margin is part of the gap: forces times what is not used of the limits.
        let unused: f64 = self.active.iter().flat_map(|a| &a.forces).map(|f| f * margin).sum();
        self.missed() <= 1e-9 && gap <= (accuracy * value).max(floor) + 4.0 * unused
    }

    /// Takes over a solution.
    fn begin_at(&mut self, before: &CertifiedSolution) {
        for (x, &at) in before.x.iter().zip(&self.order.place) {
            if at != NONE {
                self.x[at as usize] = cut(x);
            }
        }
        let narrow = |p: Pair<3>| (p.0, cut(&p.1));
        let cones = before.cones.iter().map(|&(u, y)| ConeScaling::new(narrow(u), narrow(y)));
        self.cones = cones.collect();
        self.nu.clone_from(&before.nu);
    }

    /// By points.
    fn solution(self, iterations: usize) -> CertifiedSolution {
        let (value, gap) = self.certificate();
        let gap = self.refined.map_or(gap, |refined| refined.min(gap));
        let misses = self.misses();
        let h = self.measure.gram_diagonal(self.unknowns());
        let pressed =
            self.halves.iter().map(|half| half.force / half.slack > half.own_stiffness(&h));
        let pressed = pressed.collect();
        let outside = self.halves.iter().map(|h| (h.outside(&self.x) - INSIDE).max(0.0)).collect();
        let point = |&at: &u32| match at {
            NONE => [0.0; 3],
            at => widened(self.x[at as usize]),
        };
        let wide = |p: Pair<D>| (p.0, widened(p.1));
        CertifiedSolution {
            x: self.order.place.iter().map(point).collect(),
            value,
            gap,
            iterations,
            misses,
            outside,
            pressed,
            cones: self.cones.iter().map(|c| (wide(c.u), wide(c.y))).collect(),
            nu: self.nu,
            active: self.active,
            weight: self.squares.as_ref().map_or(0.0, |s| 2.0 * s.force),
        }
    }

    /// See [`crate::optimum::problem::respond`].
    pub fn respond<T: Real>(
        mut self,
        solution: &CertifiedSolution,
        offsets: &[[T; 3]],
        radii: &[T],
        values: &[T],
        pushes: &[[T; 3]],
    ) -> Result<Vec<[T; 3]>, FairError> {
        let zero = [T::zero(); D];
        let count = self.order.place.len();
        if self.unknowns() == 0 {
            return Ok(vec![[T::zero(); 3]; count]);
        }
        self.begin_at(solution);
        if solution.active.is_none() {
            self.cones.iter_mut().for_each(|c| *c = c.centred());
        }
        let mut band = self.band()?;
        let mut right = vec![zero; self.unknowns()];
        for (push, &at) in pushes.iter().zip(&self.order.place) {
            if at != NONE {
                right[at as usize] = std::array::from_fn(|r| -push[r]);
            }
        }
        let mut push = |rows: &SparseRows, k: usize, force: [T; D]| {
            let (columns, factors) = rows.row(k);
            for (&c, &a) in columns.iter().zip(factors) {
                for r in 0..D {
                    right[c as usize][r] -= force[r] * a;
                }
            }
        };
        let limits = self.limits();
        for (k, change) in offsets.iter().enumerate() {
            let change: [T; D] = cut(change);
            let force = match self.p.norm {
                RowNorm::Square => change,
                RowNorm::Length => {
                    let w = self.cones[limits + k].stiffness(true);
                    let row = |r: usize| (0..D).fold(T::zero(), |s, c| s + change[c] * w[r][c]);
                    std::array::from_fn(row)
                }
            };
            push(&self.measure, k, force);
        }
        let flat = if let Some(active) = &solution.active {
            self.answer(&mut band, active, &right, radii, values)
        } else {
            for c in 0..limits {
                let (rows, k) = self.rows_of(c);
                let side = self.part(c, self.cones[c].side());
                push(rows, k, side.map(|s| radii[k] * s));
            }
            self.assemble(&mut band);
            self.factor(&mut band);
            self.project(&mut right);
            band.solve_any(right.as_flattened_mut());
            self.project(&mut right);
            if !self.conditions.is_empty() {
                self.schur(&band).answer(values, right.as_flattened_mut());
            }
            right
        };
        let pick = |&at: &u32| {
            let mut v = [T::zero(); 3];
            if at != NONE {
                v[..D].copy_from_slice(&flat[at as usize]);
            }
            v
        };
        Ok(self.order.place.iter().map(pick).collect())
    }
}

/// The iterate with the least gap among those that meet the requested accuracy.
struct BestIterate<const D: usize> {
    gap: f64,
    x: Vec<V<D>>,
    cones: Vec<ConeScaling<D>>,
    nu: Vec<f64>,
    /// Slack and force of each half-space.
    halves: Vec<(f64, f64)>,
}

impl<const D: usize> BestIterate<D> {
    fn of(state: &InteriorPointState<D>, gap: f64) -> Self {
        let halves = state.halves.iter().map(|h| (h.slack, h.force)).collect();
        let (x, cones, nu) = (state.x.clone(), state.cones.clone(), state.nu.clone());
        Self { gap, x, cones, nu, halves }
    }

    fn restore(self, state: &mut InteriorPointState<D>) {
        (state.x, state.cones, state.nu) = (self.x, self.cones, self.nu);
        for (half, (slack, force)) in state.halves.iter_mut().zip(self.halves) {
            (half.slack, half.force) = (slack, force);
        }
    }
}

/// See [`crate::optimum::problem::solve`].
pub(crate) fn solve<const D: usize>(
    mut state: InteriorPointState<D>,
    accuracy: f64,
    floor: f64,
    margin: f64,
    before: Option<&CertifiedSolution>,
) -> Result<CertifiedSolution, FairError> {
    let mut iterations = 0;
    let mut band = state.band()?;
    if let Some(before) = before.filter(|b| b.active.is_some())
        && state.polished()
        && state.unknowns() > 0
    {
        // Near a solution the limits that it reaches may be those of this problem, too.
        state.begin_at(before);
        if state.polish(&mut band, margin) && state.polished_to(accuracy, floor, margin) {
            return Ok(state.solution(1));
        }
        state.x.clone_from(&state.begin);
        state.nu.fill(0.0);
        (state.cones, state.active) = (Vec::new(), None);
    }
    state.start();
    if state.unknowns() == 0 {
        return Ok(state.solution(iterations));
    }
    let mut best: Option<BestIterate<D>> = None;
    let (cones, halves) = (state.cones.len(), state.halves.len());
    let mut affine = NewtonDirection::zero(state.unknowns(), cones, halves);
    let mut corrected = NewtonDirection::zero(state.unknowns(), cones, halves);
    let mut idle = 0;
    // The complementarity when it last rose or had been halved.
    let mut turned = f64::INFINITY;
    let mut shows = SHOWS;
    while iterations < MOST_ITERATIONS {
        iterations += 1;
        state.cones.iter_mut().for_each(ConeScaling::scale);
        state.assemble(&mut band);
        state.factor(&mut band);
        if let Some(mut squares) = state.squares.take() {
            squares.factored(|slope| {
                state.project(slope);
                band.solve(slope.as_flattened_mut());
                state.project(slope);
            });
            state.squares = Some(squares);
        }
        let dense = state.schur(&band);
        state.direction(&band, &dense, 0.0, None, &mut affine);
        if cones + halves == 0 && state.squares.is_none() {
            // Nothing is limited: one step solves a sum of squares.
            state.step(&affine, 1.0);
            break;
        }
        let bounds = cones + halves + usize::from(state.squares.is_some());
        let mu = state.complementarity() / bounds as f64;
        let reach = state.longest(&affine).min(1.0);
        let centring = (1.0 - reach).powi(3);
        state.direction(&band, &dense, centring * mu, Some(&affine), &mut corrected);
        let longest = state.longest(&corrected);
        if !corrected.is_finite() {
            // The matrix has no digits left: the earlier result is kept.
            break;
        }
        let by = (longest * 0.99).min(1.0);
        state.step(&corrected, by);
        if by < STUCK {
            // The rest is rounding.
            idle = MOST_ITERATIONS;
        }
        let missed = state.missed();
        let (value, gap) = state.certificate();
        if !(value.is_finite() && gap.is_finite()) {
            break;
        }
        let meets = missed <= 1e-9;
        // Half-spaces may be met by chance, long before the search is near: as long as it goes on, it is not idle.
        let mu = state.complementarity();
        let nears = halves > 0 && mu < 0.5 * turned;
        if nears || mu > turned {
            turned = mu;
        }
        if meets && best.as_ref().is_none_or(|b| gap < b.gap) {
            // A minimal improvement does not count.
            let hair = best.as_ref().is_some_and(|b| gap > 0.99 * b.gap);
            idle = if hair && !nears { idle + 1 } else { 0 };
            best = Some(BestIterate::of(&state, gap));
        } else {
            idle = if nears { 0 } else { idle + 1 };
        }
        let rounded = state.complementarity() <= ROUNDING * gap;
        // Half-spaces are entered step by step.
        let trials = if halves > 0 { MOST_ITERATIONS } else { MOST_TRIALS };
        let most = if best.is_some() { MOST_IDLE } else { trials };
        if meets && gap <= (accuracy * value).max(floor) || idle > most {
            break;
        }
        if state.polished() && meets && gap <= shows * value {
            let kept = (state.x.clone(), state.cones.clone(), state.nu.clone());
            if state.polish(&mut band, margin) {
                if state.polished_to(accuracy, floor, margin) {
                    best = None;
                    break;
                }
                state.active = None;
            }
            (state.x, state.cones, state.nu) = kept;
            shows *= 1e-2;
        }
        if meets && rounded {
            break;
        }
    }
    if let Some(best) = best {
        let gap = best.gap;
        best.restore(&mut state);
        if state.polished() && state.unknowns() <= POLISHED {
            // If rounding ends the search early, the reached limits may still be visible.
            let kept = (state.x.clone(), state.cones.clone(), state.nu.clone());
            let better = state.polish(&mut band, margin) && {
                let missed = state.missed();
                missed <= 1e-9 && state.certificate().1 <= gap
            };
            if !better {
                (state.x, state.cones, state.nu) = kept;
                state.active = None;
            }
        }
    }
    let (value, gap) = state.certificate();
    let enough = (accuracy.max(REFINED) * value).max(floor);
    if state.of_squares() && state.bounds_data() && gap > enough {
        state.refined = Some(state.refined_gap(&mut band, gap, enough));
    }
    Ok(state.solution(iterations))
}
