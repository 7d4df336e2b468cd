//! The last digits of an optimum: once an interior point shows which limits are reached, they are
//! equations, and Newton's method on them ends at rounding.
//!
//! minimise sum |e_k + P_k x|^2 / 2 subject to |Q_c x| = r_c for the limits c that are reached
//!
//! The saddle point is found by the method of multipliers (Hestenes 1969): with a stiffness rho
//! along each limit's normal the matrix stays a positive definite band, and forces converge by a
//! factor H / rho a step. What comes out is checked like any other result: forces push inwards,
//! no other limit is passed, and the certificate has the last word.

use crate::SparseRows;
use crate::optimum::band::Band;
use crate::optimum::interior_point::{InteriorPointState, add_block, apply, spread};
use crate::optimum::problem::Active;
use crate::optimum::second_order_cone::{V, axpy, dot};
use moldloft_num::Real;

/// Stiffness along a reached limit, as a multiple of the measure's own.
const STIFF: f64 = 1e5;

const MOST_ROUNDS: usize = 14;

/// Stiffness of the measure against a move of a limit's row: that of the point that moves it most.
fn own_stiffness(rows: &SparseRows, k: usize, h: &[f64]) -> f64 {
    let (columns, factors) = rows.row(k);
    let of = |(&c, &a): (&u32, &f64)| if a == 0.0 { 0.0 } else { h[c as usize] / (a * a) };
    let largest = factors.iter().fold(0.0f64, |m, a| m.max(a.abs()));
    let near = columns.iter().zip(factors).filter(|(_, a)| a.abs() > 0.5 * largest);
    near.map(of).fold(0.0, f64::max)
}

impl<const D: usize> InteriorPointState<'_, D> {
    /// The row of cone `c` and its length.
    fn limit(&self, c: usize, x: &[V<D>]) -> (V<D>, f64) {
        let (rows, k) = self.rows_of(c);
        let mut s: V<D> = std::array::from_fn(|i| self.p.bounds.offset(k)[i]);
        axpy(&mut s, 1.0, apply(rows, k, x));
        let s = self.part(c, s);
        (s, dot(s, s).sqrt())
    }

    /// The unit normal of limit `c` at its place `s`.
    fn normal(s: V<D>, length: f64) -> V<D> {
        let other = || std::array::from_fn(|c| f64::from(u8::from(c == 0)));
        if length > 0.0 { s.map(|v| v / length) } else { other() }
    }

    /// The matrix of the reached limits: H, the limits' bend (force / r across the normal), and
    /// `rho` along the normal.
    fn assemble_active(&self, band: &mut Band, active: &Active, x: &[V<D>], rho: &[f64]) {
        self.begin(band);
        for (at, &c) in active.cones.iter().enumerate() {
            let (s, length) = self.limit(c as usize, x);
            let n = Self::normal(s, length);
            let bend = if self.p.bounds.separate || length == 0.0 {
                0.0
            } else {
                active.forces[at].max(0.0) / length
            };
            let mut w = [[0.0; D]; D];
            for r in 0..D {
                for q in 0..D {
                    let unit = if r == q { bend } else { 0.0 };
                    w[r][q] = unit + (rho[c as usize] - bend) * n[r] * n[q];
                }
            }
            let (rows, k) = self.rows_of(c as usize);
            add_block(band, rows, k, &w);
        }
        self.factor(band);
    }

    /// Tries to end the solution at rounding; true when it did. Limits are aimed at `margin` less
    /// than their radius, so that rounding of the points cannot pass them.
    pub(crate) fn polish(&mut self, band: &mut Band, margin: f64) -> bool {
        let p = self.p;
        let limits = self.limits();
        let h = self.measure.gram_diagonal(self.unknowns());
        let own: Vec<f64> = (0..limits)
            .map(|c| own_stiffness(&self.limit_rows, c / self.groups(), &h).max(f64::MIN_POSITIVE))
            .collect();
        let rho: Vec<f64> = own.iter().map(|o| o * STIFF).collect();
        let radius = |c: usize| p.bounds.radii[c / self.groups()] - margin;
        let least = (0..limits).map(radius).fold(f64::INFINITY, f64::min);
        if least.is_nan() || least <= 0.0 {
            return false;
        }
        let mut reached: Vec<Option<f64>> = (0..limits)
            .map(|c| {
                let (_, length) = self.limit(c, &self.x);
                let force = self.cones[c].y.0;
                let slack = (p.bounds.radii[c / self.groups()] - length).max(1e-300);
                // The interior point resists with force / slack: more than the measure does?
                (force / slack > own[c]).then_some(force)
            })
            .collect();
        let (mut x, mut nu) = (self.x.clone(), self.nu.clone());
        let mut settled = 0;
        for _ in 0..MOST_ROUNDS {
            let mut active = Active::default();
            for (c, force) in reached.iter().enumerate() {
                if let Some(force) = force {
                    active.cones.push(c as u32);
                    active.forces.push(*force);
                }
            }
            self.assemble_active(band, &active, &x, &rho);
            let mut dx = vec![[0.0; D]; x.len()];
            for k in 0..self.measure.len() {
                let e = self.error_at(k, &x);
                spread(&self.measure, k, e.map(|v| -v), &mut dx);
            }
            let mut normals = Vec::with_capacity(active.cones.len());
            for (at, &c) in active.cones.iter().enumerate() {
                let c = c as usize;
                let (s, length) = self.limit(c, &x);
                let n = Self::normal(s, length);
                let off = length - radius(c);
                let push = active.forces[at] + rho[c] * off;
                let (rows, k) = self.rows_of(c);
                spread(rows, k, n.map(|v| -push * v), &mut dx);
                normals.push((n, off));
            }
            // The force of the multipliers so far, so that each round refines them.
            for (condition, nu) in self.conditions.iter().zip(&nu) {
                for (i, factor) in &condition.entries {
                    axpy(&mut dx[*i], -nu, *factor);
                }
            }
            self.inverse(band, &mut dx);
            if !self.conditions.is_empty() {
                let more = self.schur(band).solve(&self.conditions, &x, dx.as_flattened_mut());
                nu.iter_mut().zip(more).for_each(|(nu, more)| *nu += more);
            }
            for (at, &c) in active.cones.iter().enumerate() {
                let c = c as usize;
                let (rows, k) = self.rows_of(c);
                let (n, off) = normals[at];
                let moved = dot(n, self.part(c, apply(rows, k, &dx)));
                reached[c] = Some(active.forces[at] + rho[c] * (off + moved));
            }
            let mut size = 0.0f64;
            for (x, d) in x.iter_mut().zip(&dx) {
                axpy(x, 1.0, *d);
                size = size.max(dot(*d, *d));
            }
            let size = size.sqrt();
            if !size.is_finite() {
                return false;
            }
            // Limits that pull are let go, those that are passed hold, once the step is settled.
            if size > 1e-3 * least {
                settled = 0;
                continue;
            }
            let mut changed = false;
            for c in 0..limits {
                let (_, length) = self.limit(c, &x);
                match reached[c] {
                    Some(force) if force < 0.0 => (reached[c], changed) = (None, true),
                    None if length > radius(c) + margin => {
                        (reached[c], changed) = (Some(0.0), true);
                    }
                    _ => {}
                }
            }
            if changed {
                settled = 0;
                continue;
            }
            settled += usize::from(size <= 1e-12 * least);
            if settled > 0 {
                return self.take(x, nu, &reached);
            }
        }
        false
    }

    /// Takes over a polished solution.
    fn take(&mut self, x: Vec<V<D>>, nu: Vec<f64>, reached: &[Option<f64>]) -> bool {
        let within = (0..self.limits()).all(|c| {
            let radius = self.p.bounds.radii[c / self.groups()];
            self.limit(c, &x).1 <= radius
        });
        if !within {
            return false;
        }
        self.x = x;
        self.nu = nu;
        for c in 0..self.limits() {
            let (s, length) = self.limit(c, &self.x);
            let force = reached[c].unwrap_or(0.0);
            let n = Self::normal(s, length);
            self.cones[c].y = (force, n.map(|v| -force * v));
            self.cones[c].u = (self.p.bounds.radii[c / self.groups()], s);
        }
        self.active = Some(Active {
            cones: (0..reached.len()).filter(|&c| reached[c].is_some()).map(|c| c as u32).collect(),
            forces: reached.iter().flatten().copied().collect(),
        });
        true
    }

    /// How the displacements answer to small changes of the measure's offsets (as forces on points,
    /// `right`), of the radii and of the conditions' `values`: the saddle point's linear equations, refined to rounding. Changes
    /// have zero real parts.
    pub(crate) fn answer<T: Real>(
        &self,
        band: &mut Band,
        active: &Active,
        right: &[[T; D]],
        radii: &[T],
        values: &[T],
    ) -> Vec<[T; D]> {
        let p = self.p;
        let h = self.measure.gram_diagonal(self.unknowns());
        let mut rho = vec![0.0; self.limits()];
        for &c in &active.cones {
            rho[c as usize] =
                STIFF * own_stiffness(&self.limit_rows, c as usize / self.groups(), &h);
        }
        self.assemble_active(band, active, &self.x, &rho);
        let dense = self.schur(band);
        let zero = [T::zero(); D];
        let apply = |rows: &SparseRows, k: usize, x: &[[T; D]]| {
            let (columns, factors) = rows.row(k);
            let mut sum = zero;
            for (&c, &a) in columns.iter().zip(factors) {
                for r in 0..D {
                    sum[r] += x[c as usize][r] * a;
                }
            }
            sum
        };
        let spread = |rows: &SparseRows, k: usize, y: [T; D], sum: &mut [[T; D]]| {
            let (columns, factors) = rows.row(k);
            for (&c, &a) in columns.iter().zip(factors) {
                for r in 0..D {
                    sum[c as usize][r] += y[r] * a;
                }
            }
        };
        let limits: Vec<(usize, V<D>, f64)> = active
            .cones
            .iter()
            .zip(&active.forces)
            .map(|(&c, &force)| {
                let (s, length) = self.limit(c as usize, &self.x);
                let bend = if p.bounds.separate || length == 0.0 { 0.0 } else { force / length };
                (c as usize, Self::normal(s, length), bend)
            })
            .collect();
        let along = |n: &V<D>, s: &[T; D]| (0..D).fold(T::zero(), |t, r| t + s[r] * n[r]);
        let mut x = vec![zero; self.unknowns()];
        let mut forces = vec![T::zero(); limits.len()];
        let mut nu = vec![T::zero(); self.conditions.len()];
        for _ in 0..5 {
            // The residual.
            let mut rest: Vec<[T; D]> = right.to_vec();
            for k in 0..self.measure.len() {
                let e = apply(&self.measure, k, &x);
                spread(&self.measure, k, e.map(|v| -v), &mut rest);
            }
            let mut short = Vec::with_capacity(limits.len());
            for ((c, n, bend), force) in limits.iter().zip(&forces) {
                let (rows, k) = self.rows_of(*c);
                let mut s = apply(rows, k, &x);
                if p.bounds.separate {
                    for (r, v) in s.iter_mut().enumerate() {
                        if r != c % D {
                            *v = T::zero();
                        }
                    }
                }
                let own = along(n, &s);
                let left = radii[k] - own;
                let mut push = zero;
                for r in 0..D {
                    let across = (s[r] - own * n[r]) * *bend;
                    push[r] = -across - *force * n[r] + left * (rho[*c] * n[r]);
                }
                spread(rows, k, push, &mut rest);
                short.push(left);
            }
            let mut left = values.to_vec();
            for ((condition, nu), left) in self.conditions.iter().zip(&nu).zip(&mut left) {
                for (i, factor) in &condition.entries {
                    for r in 0..D {
                        rest[*i][r] -= *nu * factor[r];
                        *left -= x[*i][r] * factor[r];
                    }
                }
            }
            self.project(&mut rest);
            band.solve_any(rest.as_flattened_mut());
            self.project(&mut rest);
            let more = dense.answer(&left, rest.as_flattened_mut());
            nu.iter_mut().zip(more).for_each(|(nu, more)| *nu += more);
            let step = rest;
            for (((c, n, _), force), left) in limits.iter().zip(&mut forces).zip(short) {
                let (rows, k) = self.rows_of(*c);
                let moved = along(n, &apply(rows, k, &step));
                *force += (moved - left) * rho[*c];
            }
            for (x, s) in x.iter_mut().zip(&step) {
                for r in 0..D {
                    x[r] += s[r];
                }
            }
        }
        x
    }
}
