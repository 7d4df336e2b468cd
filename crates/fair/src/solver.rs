//! An interior point method for measures of sparse rows under bounds on sparse rows.
//!
//! minimise   sum of psi(e_k + P_k x)        psi(e) = |e|^2 / 2 or |e|
//! subject to |Q_k x| <= r_k,  A x = b
//!
//! over the displacement x of the control points, D coordinates each. Both kinds of rows couple
//! few neighbours, so each Newton step factors one band matrix: O(n) time and memory for curves.
//!
//! Limits and lengths are second-order cones, (r, Q x) and (t, e), with Nesterov and Todd's
//! scaling and Mehrotra's two-step directions (Vandenberghe 2010, "The CVXOPT linear and quadratic
//! cone program solvers"); the lengths' own unknowns t are eliminated row by row.

use crate::band::Band;
use crate::cone::{Cone, Pair, farthest};
use crate::polish::Active;
use crate::{FairError, Norm, Rows};
use moldloft_num::Real;

/// One coordinate triple; only the first D are used.
pub(crate) type V = [f64; 3];

#[inline(always)]
pub(crate) fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn axpy(y: &mut V, a: f64, x: V) {
    for c in 0..3 {
        y[c] += a * x[c];
    }
}

/// A limit |Q_k x| <= radius, of all coordinates together or of each by itself.
pub(crate) struct Bounds {
    pub rows: Rows,
    /// Each row is a single point, each point has at most one row.
    pub direct: bool,
    pub radii: Vec<f64>,
    /// Each coordinate is limited by itself.
    pub separate: bool,
}

/// One linear condition: the sum of factor . x[point] equals `value`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Condition {
    pub entries: Vec<(usize, V)>,
    pub value: f64,
}

/// A problem in the coordinates of its own frame.
pub(crate) struct Problem {
    /// Coordinates in use, 1 to 3.
    pub dimension: usize,
    /// Rows of the measure over points.
    pub measure: Rows,
    pub norm: Norm,
    /// Rows times the original points.
    pub offsets: Vec<V>,
    pub bounds: Bounds,
    /// Points that do not move.
    pub frozen: Vec<bool>,
    pub conditions: Vec<Condition>,
    /// By how much each point can move at most, for the certificate.
    pub reach: Vec<f64>,
}

/// A solution with the certificate's parts.
pub(crate) struct Solution {
    /// Displacements, zero for frozen points.
    pub x: Vec<V>,
    /// psi's sum.
    pub value: f64,
    /// A bound on what is left to gain.
    pub gap: f64,
    pub iterations: usize,
    /// Largest miss of a condition, relative to its own scale, and which ones are missed.
    pub misses: Vec<f64>,
    /// The cones at the solution, for [`respond`].
    cones: Vec<Cone>,
    /// The limits that are reached, when the solution was polished.
    active: Option<Active>,
}

const MOST_ITERATIONS: usize = 80;

const IDENTITY: [V; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

pub(crate) struct State<'a> {
    pub p: &'a Problem,
    pub d: usize,
    /// Unknown number of each point, or NONE.
    place: Vec<u32>,
    pub unknowns: usize,
    pub x: Vec<V>,
    /// Cones of the limits, then those of the lengths.
    pub cones: Vec<Cone>,
    pub nu: Vec<f64>,
    /// Set once the solution is polished.
    pub active: Option<Active>,
}

const NONE: u32 = u32::MAX;

/// An order of the unknowns with a narrow band: as they stand, or by breadth-first search from a
/// point at the rim (Cuthill and McKee 1969), whichever is narrower.
fn order(p: &Problem) -> (Vec<u32>, usize, usize) {
    let n = p.frozen.len();
    let natural: Vec<u32> = {
        let mut next = 0;
        (0..n)
            .map(|i| {
                if p.frozen[i] {
                    NONE
                } else {
                    next += 1;
                    next - 1
                }
            })
            .collect()
    };
    let unknowns = natural.iter().filter(|&&i| i != NONE).count();
    let span = |place: &[u32]| {
        let of = |rows: &Rows| {
            (0..rows.len())
                .map(|k| {
                    let used = || {
                        let all = rows.row(k).0.iter().map(|&c| place[c as usize]);
                        all.filter(|&i| i != NONE)
                    };
                    match (used().max(), used().min()) {
                        (Some(a), Some(b)) => (a - b) as usize,
                        _ => 0,
                    }
                })
                .max()
                .unwrap_or(0)
        };
        of(&p.measure).max(of(&p.bounds.rows))
    };
    let wide = span(&natural);
    if wide <= 32 || unknowns < 3 {
        return (natural, unknowns, wide);
    }
    // Neighbours through shared rows.
    let lists = [p.measure.transposed(n), p.bounds.rows.transposed(n)];
    let neighbours = |i: usize| {
        let mut all: Vec<u32> = Vec::new();
        for (list, rows) in lists.iter().zip([&p.measure, &p.bounds.rows]) {
            for &k in list.row(i).0 {
                all.extend(rows.row(k as usize).0.iter().filter(|&&c| natural[c as usize] != NONE));
            }
        }
        all.sort_unstable();
        all.dedup();
        all
    };
    let search = |start: usize, place: &mut Vec<u32>, next: &mut u32| {
        let mut queue = std::collections::VecDeque::from([start as u32]);
        let mut last = start;
        place[start] = *next;
        *next += 1;
        while let Some(i) = queue.pop_front() {
            last = i as usize;
            for j in neighbours(i as usize) {
                if place[j as usize] == NONE {
                    place[j as usize] = *next;
                    *next += 1;
                    queue.push_back(j);
                }
            }
        }
        last
    };
    let mut place = vec![NONE; n];
    let mut next = 0;
    for i in 0..n {
        if natural[i] != NONE && place[i] == NONE {
            // From a point far from the first: the ends of what is connected.
            let mut trial = place.clone();
            let far = search(i, &mut trial, &mut next.clone());
            search(far, &mut place, &mut next);
        }
    }
    let narrow = span(&place);
    if narrow < wide { (place, unknowns, narrow) } else { (natural, unknowns, wide) }
}

/// What a Newton step changes.
struct Direction {
    x: Vec<V>,
    /// Slack and dual of each cone.
    u: Vec<Pair>,
    y: Vec<Pair>,
    nu: Vec<f64>,
}

impl State<'_> {
    #[inline(always)]
    pub(crate) fn apply(rows: &Rows, k: usize, x: &[V]) -> V {
        let (columns, factors) = rows.row(k);
        let mut sum = [0.0; 3];
        for (&c, &a) in columns.iter().zip(factors) {
            axpy(&mut sum, a, x[c as usize]);
        }
        sum
    }

    fn error(&self, k: usize) -> V {
        let mut e = self.p.offsets[k];
        axpy(&mut e, 1.0, Self::apply(&self.p.measure, k, &self.x));
        e
    }

    /// Coordinate groups of a limit.
    pub(crate) fn groups(&self) -> usize {
        if self.p.bounds.separate { self.d } else { 1 }
    }

    /// The number of cones of limits; cone c belongs to limit c / groups.
    pub(crate) fn limits(&self) -> usize {
        self.p.bounds.rows.len() * self.groups()
    }

    /// The part of a limit's row that cone `c` is about.
    pub(crate) fn part(&self, c: usize, s: V) -> V {
        if !self.p.bounds.separate {
            return s;
        }
        let mut only = [0.0; 3];
        only[c % self.d] = s[c % self.d];
        only
    }

    /// The rows of cone `c`.
    pub(crate) fn rows_of(&self, c: usize) -> (&Rows, usize) {
        match c.checked_sub(self.limits()) {
            None => (&self.p.bounds.rows, c / self.groups()),
            Some(k) => (&self.p.measure, k),
        }
    }

    /// Adds P^T y to `sum`, by points.
    pub(crate) fn spread(rows: &Rows, k: usize, y: V, sum: &mut [V]) {
        let (columns, factors) = rows.row(k);
        for (&c, &a) in columns.iter().zip(factors) {
            axpy(&mut sum[c as usize], a, y);
        }
    }

    /// Adds P^T W P to the matrix.
    pub(crate) fn add_block(&self, band: &mut Band, rows: &Rows, k: usize, w: &[V; 3]) {
        let (columns, factors) = rows.row(k);
        let d = self.d;
        for (i, (&ci, &ai)) in columns.iter().zip(factors).enumerate() {
            let pi = self.place[ci as usize];
            if pi == NONE {
                continue;
            }
            for (&cj, &aj) in columns[..=i].iter().zip(factors) {
                let pj = self.place[cj as usize];
                if pj == NONE {
                    continue;
                }
                let a = ai * aj;
                for r in 0..d {
                    let last = if pi == pj { r + 1 } else { d };
                    for c in 0..last {
                        band.add(pi as usize * d + r, pj as usize * d + c, a * w[r][c]);
                    }
                }
            }
        }
    }

    /// Calls `f` with each point that moves and where its first unknown is.
    pub(crate) fn each_place(&self, mut f: impl FnMut(usize, usize)) {
        for (i, &at) in self.place.iter().enumerate() {
            if at != NONE {
                f(i, at as usize * self.d);
            }
        }
    }

    /// Adds P'P of the measure.
    pub(crate) fn add_measure(&self, band: &mut Band) {
        for k in 0..self.p.measure.len() {
            self.add_block(band, &self.p.measure, k, &IDENTITY);
        }
    }

    fn assemble(&self, band: &mut Band) {
        band.clear();
        if self.p.norm == Norm::Square {
            self.add_measure(band);
        }
        let limits = self.limits();
        for (c, cone) in self.cones.iter().enumerate() {
            let mut w = cone.stiffness(c >= limits);
            if c < limits && self.p.bounds.separate {
                for r in 0..3 {
                    for q in 0..3 {
                        if r != c % self.d || q != c % self.d {
                            w[r][q] = 0.0;
                        }
                    }
                }
            }
            let (rows, k) = self.rows_of(c);
            self.add_block(band, rows, k, &w);
        }
    }

    pub(crate) fn flat(&self, by_point: &[V]) -> Vec<f64> {
        let mut flat = vec![0.0; self.unknowns * self.d];
        for (v, &at) in by_point.iter().zip(&self.place) {
            if at != NONE {
                let at = at as usize * self.d;
                flat[at..at + self.d].copy_from_slice(&v[..self.d]);
            }
        }
        flat
    }

    pub(crate) fn unflat(&self, flat: &[f64]) -> Vec<V> {
        self.place
            .iter()
            .map(|&at| {
                let mut v = [0.0; 3];
                if at != NONE {
                    let at = at as usize * self.d;
                    v[..self.d].copy_from_slice(&flat[at..at + self.d]);
                }
                v
            })
            .collect()
    }

    /// The Newton direction towards the centre `mu`, corrected for the second-order terms of
    /// `before` when given. The dual residual is removed whole.
    fn direction(
        &self,
        band: &Band,
        dense: &Schur,
        mu: f64,
        before: Option<&Direction>,
    ) -> Direction {
        let p = self.p;
        let limits = self.limits();
        let mut right = vec![[0.0; 3]; self.x.len()];
        if p.norm == Norm::Square {
            for k in 0..p.measure.len() {
                Self::spread(&p.measure, k, self.error(k).map(|c| -c), &mut right);
            }
        }
        let mut goals = Vec::with_capacity(self.cones.len());
        for (c, cone) in self.cones.iter().enumerate() {
            let goal = cone.goal(mu, before.map(|d| (&d.u[c], &d.y[c])));
            let fixed = cone.fixed(&goal, c >= limits);
            let (rows, k) = self.rows_of(c);
            let mut force = cone.y.1;
            axpy(&mut force, 1.0, fixed);
            Self::spread(rows, k, force, &mut right);
            goals.push(goal);
        }
        let mut flat = self.flat(&right);
        band.solve(&mut flat);
        // Conditions by their Schur complement: x = x0 - Y nu, A x = b - A x_now.
        let nu = dense.solve(p, &self.x, &mut flat);
        let x = self.unflat(&flat);
        let mut out = Direction {
            u: Vec::with_capacity(goals.len()),
            y: Vec::with_capacity(goals.len()),
            nu,
            x,
        };
        for (c, (cone, goal)) in self.cones.iter().zip(&goals).enumerate() {
            let (rows, k) = self.rows_of(c);
            let length = c >= limits;
            let de = Self::apply(rows, k, &out.x);
            let (du, dy) = cone.change(goal, if length { de } else { self.part(c, de) }, length);
            out.u.push(du);
            out.y.push(if length { dy } else { (dy.0, self.part(c, dy.1)) });
        }
        out
    }

    /// The longest step along `d` that keeps all cones, at most 2.
    fn longest(&self, d: &Direction) -> f64 {
        let mut step: f64 = 2.0;
        for (c, cone) in self.cones.iter().enumerate() {
            step = step.min(farthest(cone.u, d.u[c])).min(farthest(cone.y, d.y[c]));
        }
        step
    }

    /// The mean complementarity.
    fn complementarity(&self) -> f64 {
        let sum: f64 = self.cones.iter().map(|c| c.u.0 * c.y.0 + dot(c.u.1, c.y.1)).sum();
        sum / (self.cones.len() as f64).max(1.0)
    }

    fn step(&mut self, d: &Direction, by: f64) {
        for (x, dx) in self.x.iter_mut().zip(&d.x) {
            axpy(x, by, *dx);
        }
        let limits = self.limits();
        for c in 0..self.cones.len() {
            let (rows, k) = self.rows_of(c);
            // Slacks are recomputed from x, so they never drift from it.
            let inner = if c < limits {
                self.part(c, Self::apply(rows, k, &self.x))
            } else {
                self.error(k)
            };
            let cone = &mut self.cones[c];
            cone.u = (cone.u.0 + by * d.u[c].0, inner);
            cone.y.0 += by * d.y[c].0;
            axpy(&mut cone.y.1, by, d.y[c].1);
        }
        for (nu, new) in self.nu.iter_mut().zip(&d.nu) {
            *nu += by * (new - *nu);
        }
    }

    /// The measure and a rigorous bound on what is left to gain.
    ///
    /// With any z (|z| <= 1 for lengths, e for squares) and g = P^T z, every allowed y has
    /// f(y) >= f(x) - sum(|e| - z . e) + g (y - x). For any forces m and nu,
    /// g = -Q^T m - A^T nu + rest, so g (x - y) <= sum (r |m| - m . s) + |rest| (|x| + reach).
    fn certificate(&self) -> (f64, f64) {
        let p = self.p;
        let n = self.x.len();
        let limits = self.limits();
        let mut slope = vec![[0.0; 3]; n];
        let (mut value, mut gap) = (0.0, 0.0);
        for k in 0..p.measure.len() {
            let e = self.error(k);
            let z = match p.norm {
                Norm::Square => {
                    value += 0.5 * dot(e, e);
                    e
                }
                Norm::Length => {
                    let z = self.cones[limits + k].y.1.map(|c| -c);
                    let length = dot(e, e).sqrt();
                    value += length;
                    gap += length - dot(z, e);
                    z
                }
            };
            Self::spread(&p.measure, k, z, &mut slope);
        }
        for (condition, nu) in p.conditions.iter().zip(&self.nu) {
            for (i, factor) in &condition.entries {
                axpy(&mut slope[*i], *nu, *factor);
            }
        }
        let norm = |v: V| {
            if p.bounds.separate { v.iter().map(|c| c.abs()).sum() } else { dot(v, v).sqrt() }
        };
        for k in 0..p.bounds.rows.len() {
            let r = p.bounds.radii[k];
            if p.bounds.direct {
                // One limit per point: the force is eliminated, nothing is trusted.
                let i = p.bounds.rows.row(k).0[0] as usize;
                let g = std::mem::take(&mut slope[i]);
                gap += dot(g, self.x[i]) + r * norm(g);
            } else {
                let s = Self::apply(&p.bounds.rows, k, &self.x);
                let mut force = [0.0; 3];
                for g in 0..self.groups() {
                    axpy(&mut force, -1.0, self.cones[k * self.groups() + g].y.1);
                }
                gap += r * norm(force) - dot(force, s);
                Self::spread(&p.bounds.rows, k, force, &mut slope);
            }
        }
        for i in 0..n {
            if self.place[i] != NONE {
                let rest = dot(slope[i], slope[i]).sqrt();
                let farthest = dot(self.x[i], self.x[i]).sqrt() + p.reach[i];
                gap += if rest == 0.0 { 0.0 } else { rest * farthest };
            }
        }
        (value, gap.max(0.0))
    }
}

/// The dense system of the conditions' multipliers.
pub(crate) struct Schur {
    /// Solutions of the band matrix for each condition.
    columns: Vec<Vec<f64>>,
    /// Conditions over the unknowns.
    rows: Vec<Vec<f64>>,
    matrix: Vec<f64>,
}

impl Schur {
    pub(crate) fn new(state: &State, band: &Band) -> Self {
        let rows: Vec<Vec<f64>> = state
            .p
            .conditions
            .iter()
            .map(|c| {
                let mut by_point = vec![[0.0; 3]; state.x.len()];
                for (i, factor) in &c.entries {
                    axpy(&mut by_point[*i], 1.0, *factor);
                }
                state.flat(&by_point)
            })
            .collect();
        let columns: Vec<Vec<f64>> = rows
            .iter()
            .map(|row| {
                let mut y = row.clone();
                band.solve(&mut y);
                y
            })
            .collect();
        let m = rows.len();
        let mut matrix = vec![0.0; m * m];
        for i in 0..m {
            for j in 0..m {
                matrix[i * m + j] = rows[i].iter().zip(&columns[j]).map(|(a, b)| a * b).sum();
            }
        }
        // Conditions that repeat each other leave a singular matrix: a trace of weight decides.
        for i in 0..m {
            matrix[i * m + i] *= 1.0 + 1e-13;
        }
        Self { columns, rows, matrix }
    }

    /// Turns the unconstrained direction into one that meets the conditions; returns their
    /// multipliers.
    pub(crate) fn solve(&self, p: &Problem, now: &[V], x: &mut [f64]) -> Vec<f64> {
        let m = self.rows.len();
        if m == 0 {
            return Vec::new();
        }
        let mut nu: Vec<f64> = (0..m)
            .map(|k| {
                let here: f64 = self.rows[k].iter().zip(&*x).map(|(a, b)| a * b).sum();
                here - (p.conditions[k].value - met(&p.conditions[k], now))
            })
            .collect();
        let mut matrix = self.matrix.clone();
        if moldloft_num::solve_dense(&mut matrix, &mut nu).is_err() {
            return vec![0.0; m];
        }
        for (column, nu) in self.columns.iter().zip(&nu) {
            for (x, y) in x.iter_mut().zip(column) {
                *x -= nu * y;
            }
        }
        nu
    }
}

/// The left side of a condition.
fn met(condition: &Condition, x: &[V]) -> f64 {
    condition.entries.iter().map(|(i, factor)| dot(*factor, x[*i])).sum()
}

/// The share of the value at which the gap shows which limits are reached, and the next one when it
/// did not: there the solution is polished.
const SHOWS: f64 = 1e-4;

/// Solves a problem until the certified gap is at most `accuracy` times the value, or `floor`.
/// Limits are kept with a `margin` for the rounding of positions.
pub(crate) fn solve(
    p: &Problem,
    accuracy: f64,
    floor: f64,
    margin: f64,
) -> Result<Solution, FairError> {
    let n = p.frozen.len();
    let (place, unknowns, span) = order(p);
    let d = p.dimension;
    let mut state = State {
        p,
        d,
        place,
        unknowns,
        x: vec![[0.0; 3]; n],
        cones: Vec::new(),
        nu: vec![0.0; p.conditions.len()],
        active: None,
    };
    start(&mut state);
    let mut iterations = 0;
    if unknowns > 0 && d > 0 {
        let mut band = Band::zero(unknowns * d, d * (span + 1) - 1)?;
        let mut best: Option<(f64, Vec<V>, Vec<Cone>, Vec<f64>)> = None;
        let mut idle = 0;
        let mut shows = SHOWS;
        while iterations < MOST_ITERATIONS {
            iterations += 1;
            state.cones.iter_mut().for_each(Cone::scale);
            state.assemble(&mut band);
            band.factor();
            let dense = Schur::new(&state, &band);
            let mu = state.complementarity();
            let affine = state.direction(&band, &dense, 0.0, None);
            if state.cones.is_empty() {
                // Nothing is limited: one step solves a sum of squares.
                state.step(&affine, 1.0);
                break;
            }
            let reach = state.longest(&affine).min(1.0);
            let centring = (1.0 - reach).powi(3);
            let corrected = state.direction(&band, &dense, centring * mu, Some(&affine));
            let longest = state.longest(&corrected);
            state.step(&corrected, (longest * 0.99).min(1.0));
            let missed = misses(p, &state.x).into_iter().fold(0.0, f64::max);
            let (value, gap) = state.certificate();
            if !(value.is_finite() && gap.is_finite()) {
                break;
            }
            if missed <= 1e-9 && best.as_ref().is_none_or(|b| gap < b.0) {
                idle = 0;
                best = Some((gap, state.x.clone(), state.cones.clone(), state.nu.clone()));
            } else {
                idle += 1;
            }
            if missed <= 1e-9 && gap <= (accuracy * value).max(floor) || idle > 12 {
                break;
            }
            if p.norm == Norm::Square && missed <= 1e-9 && gap <= shows * value {
                let kept = (state.x.clone(), state.cones.clone(), state.nu.clone());
                if state.polish(&mut band, margin) {
                    let (value, after) = state.certificate();
                    // The margin is part of the gap: forces times what is not used of the limits.
                    let unused: f64 =
                        state.active.iter().flat_map(|a| &a.forces).map(|f| f * margin).sum();
                    let missed = misses(p, &state.x).into_iter().fold(0.0, f64::max);
                    if missed <= 1e-9 && after <= (accuracy * value).max(floor) + 4.0 * unused {
                        best = None;
                        break;
                    }
                    state.active = None;
                }
                (state.x, state.cones, state.nu) = kept;
                shows *= 1e-2;
            }
        }
        if let Some((_, x, cones, nu)) = best {
            (state.x, state.cones, state.nu) = (x, cones, nu);
        }
    }
    let (value, gap) = state.certificate();
    let misses = misses(p, &state.x);
    let State { x, cones, active, .. } = state;
    Ok(Solution { x, value, gap, iterations, misses, cones, active })
}

/// By how much each condition is missed, relative to what the limits let it vary.
fn misses(p: &Problem, x: &[V]) -> Vec<f64> {
    let of = |c: &Condition| {
        let most = |(i, f): &(usize, V)| dot(*f, *f).sqrt() * p.reach[*i].min(1e300);
        let scale: f64 = c.entries.iter().map(most).sum();
        let off = (met(c, x) - c.value).abs();
        if off == 0.0 { 0.0 } else { off / scale.max(f64::MIN_POSITIVE) }
    };
    p.conditions.iter().map(of).collect()
}

/// Centred starting duals of the size of the slopes.
fn start(state: &mut State) {
    let p = state.p;
    let mut slope = vec![[0.0; 3]; state.x.len()];
    let errors: Vec<V> = (0..p.measure.len()).map(|k| state.error(k)).collect();
    let mean = errors.iter().map(|e| dot(*e, *e).sqrt()).sum::<f64>() / errors.len().max(1) as f64;
    let mu = mean.max(1e-200);
    let mut lengths = Vec::new();
    for (k, &e) in errors.iter().enumerate() {
        let mut z = e;
        if p.norm == Norm::Length {
            let t = 0.5 * (mu + (mu * mu + 4.0 * dot(e, e)).sqrt());
            z = e.map(|c| c / t);
            lengths.push(Cone::new((t, e), (1.0, z.map(|c| -c))));
        }
        State::spread(&p.measure, k, z, &mut slope);
    }
    let free = state.place.iter().filter(|&&i| i != NONE).count().max(1) as f64;
    let moving = (0..slope.len()).filter(|&i| state.place[i] != NONE);
    let total: f64 = moving.map(|i| dot(slope[i], slope[i]).sqrt()).sum();
    let force = (total / free).max(1e-200);
    for k in 0..p.bounds.rows.len() {
        for _ in 0..state.groups() {
            state.cones.push(Cone::new((p.bounds.radii[k], [0.0; 3]), (force, [0.0; 3])));
        }
    }
    state.cones.extend(lengths);
}

/// How the displacements answer to small changes of the offsets (per measure row) and radii (per
/// limit): the implicit function theorem at the solution, where each cone resists with its
/// stiffness. The changes are numbers with a zero real part. Conditions must be none.
///
/// # Errors
/// [`FairError::TooLarge`].
pub(crate) fn respond<T: Real>(
    p: &Problem,
    solution: &Solution,
    offsets: &[[T; 3]],
    radii: &[T],
) -> Result<Vec<[T; 3]>, FairError> {
    let n = p.frozen.len();
    let zero = [T::zero(); 3];
    let (place, unknowns, span) = order(p);
    let d = p.dimension;
    if unknowns == 0 || d == 0 {
        return Ok(vec![zero; n]);
    }
    let state = State {
        p,
        d,
        place,
        unknowns,
        x: solution.x.clone(),
        cones: match &solution.active {
            Some(_) => solution.cones.clone(),
            None => solution.cones.iter().map(Cone::centred).collect(),
        },
        nu: Vec::new(),
        active: None,
    };
    let mut band = Band::zero(unknowns * d, d * (span + 1) - 1)?;
    if let Some(active) = &solution.active {
        let mut right = vec![zero; n];
        for (k, change) in offsets.iter().enumerate() {
            let (columns, factors) = p.measure.row(k);
            for (&c, &a) in columns.iter().zip(factors) {
                for r in 0..d {
                    right[c as usize][r] -= change[r] * a;
                }
            }
        }
        return state.answer(&mut band, active, &right, radii);
    }
    state.assemble(&mut band);
    band.factor();
    let limits = state.limits();
    let mut right = vec![zero; n];
    let mut spread = |rows: &Rows, k: usize, force: [T; 3]| {
        let (columns, factors) = rows.row(k);
        for (&c, &a) in columns.iter().zip(factors) {
            for r in 0..3 {
                right[c as usize][r] -= force[r] * a;
            }
        }
    };
    for (k, change) in offsets.iter().enumerate() {
        let force = match p.norm {
            Norm::Square => *change,
            Norm::Length => {
                let w = state.cones[limits + k].stiffness(true);
                let row = |r: usize| (0..3).fold(T::zero(), |s, c| s + change[c] * w[r][c]);
                [row(0), row(1), row(2)]
            }
        };
        spread(&p.measure, k, force);
    }
    for c in 0..limits {
        let (rows, k) = state.rows_of(c);
        let side = state.part(c, state.cones[c].side());
        spread(rows, k, side.map(|s| radii[k] * s));
    }
    let mut flat = vec![T::zero(); unknowns * d];
    for (v, &at) in right.iter().zip(&state.place) {
        if at != NONE {
            flat[at as usize * d..][..d].copy_from_slice(&v[..d]);
        }
    }
    band.solve_any(&mut flat);
    let pick = |&at: &u32| {
        let mut v = zero;
        if at != NONE {
            v[..d].copy_from_slice(&flat[at as usize * d..][..d]);
        }
        v
    };
    Ok(state.place.iter().map(pick).collect())
}
