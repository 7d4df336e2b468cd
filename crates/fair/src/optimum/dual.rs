//! A dual point with more digits than the displacements have.
//!
//! The certificate needs forces z of the measure's rows and m of the limits that balance,
//! P^T z + Q^T m + A^T nu + C^T h = rest, and pays for what is left with the reach of the unknowns. At the rows'
//! own errors z = e(x) the rest cannot be less than the last bits of x make of it, which at steps that are
//! short beside the curve is more than the measure. But z is free (weak duality):
//!
//! f(x) - f(y) <= |z - e|^2 / 2 + sum (r |m| - m . s) + h . (d - C x) + |rest| (|x| + reach)
//!
//! Newton's step dx against the rest goes into z and m alone, z + P dx and m + W Q dx, and not into x,
//! where it would be rounded away.

use crate::optimum::band::Band;
use crate::optimum::interior_point::{InteriorPointState, add_block, apply, spread};
use crate::optimum::second_order_cone::{V, axpy, dot};

/// Steps at most; each takes off what rounding left of the one before.
const STEPS: usize = 4;

/// Minimum slack of a limit, relative to its radius; a closer limit counts as reached.
const LEAST_SLACK: f64 = 1e-6;

impl<const D: usize> InteriorPointState<'_, D> {
    /// A bound on the optimality gap of a measure of squares, at most `gap`, which the certificate has;
    /// `enough` is one that need not be less.
    pub(crate) fn refined_gap(&self, band: &mut Band, gap: f64, enough: f64) -> f64 {
        let p = self.p;
        let groups = self.groups();
        let length = |v: V<D>| dot(v, v).sqrt();
        let inner: Vec<V<D>> = (0..self.limit_rows.len())
            .map(|k| {
                let mut s: V<D> = std::array::from_fn(|i| p.bounds.offset(k)[i]);
                axpy(&mut s, 1.0, apply(&self.limit_rows, k, &self.x));
                s
            })
            .collect();
        let mut forces: Vec<V<D>> = (0..self.limit_rows.len())
            .map(|k| {
                let mut force = [0.0; D];
                for g in 0..groups {
                    axpy(&mut force, -1.0, self.cones[k * groups + g].y.1);
                }
                force
            })
            .collect();
        // How hard each limit resists: along its normal by its slack, across by its bend.
        let stiffness: Vec<[V<D>; D]> = inner
            .iter()
            .zip(&forces)
            .zip(&p.bounds.radii)
            .map(|((&s, &force), &radius)| {
                let mut w = [[0.0; D]; D];
                if p.bounds.separate {
                    for (c, row) in w.iter_mut().enumerate() {
                        let slack = (radius - s[c].abs()).max(LEAST_SLACK * radius);
                        row[c] = force[c].abs() / slack;
                    }
                    return w;
                }
                let far = length(s);
                if far == 0.0 {
                    return w;
                }
                let slack = (radius - far).max(LEAST_SLACK * radius);
                let (along, across) = (length(force) / slack, length(force) / far);
                for (r, row) in w.iter_mut().enumerate() {
                    for (c, x) in row.iter_mut().enumerate() {
                        let unit = if r == c { across } else { 0.0 };
                        *x = unit + (along - across) * s[r] * s[c] / (far * far);
                    }
                }
                w
            })
            .collect();
        self.begin(band);
        for (k, w) in stiffness.iter().enumerate() {
            add_block(band, &self.limit_rows, k, w);
        }
        self.factor(band);
        let errors: Vec<V<D>> =
            (0..self.measure.len()).map(|k| self.error_at(k, &self.x)).collect();
        let mut z = errors.clone();
        let mut best = gap;
        for step in 0..=STEPS {
            let mut rest = vec![[0.0; D]; self.x.len()];
            for (k, z) in z.iter().enumerate() {
                spread(&self.measure, k, *z, &mut rest);
            }
            for (k, m) in forces.iter().enumerate() {
                spread(&self.limit_rows, k, *m, &mut rest);
            }
            let mut bound = self.add_linear(&mut rest);
            for (z, e) in z.iter().zip(&errors) {
                let off: V<D> = std::array::from_fn(|c| z[c] - e[c]);
                bound += 0.5 * dot(off, off);
            }
            for ((m, s), radius) in forces.iter().zip(&inner).zip(&p.bounds.radii) {
                let size =
                    if p.bounds.separate { m.iter().map(|c| c.abs()).sum() } else { length(*m) };
                bound += radius * size - dot(*m, *s);
            }
            self.project(&mut rest);
            for ((rest, x), reach) in rest.iter().zip(&self.x).zip(&self.reach) {
                let rest = length(*rest);
                bound += if rest == 0.0 { 0.0 } else { rest * (length(*x) + reach) };
            }
            if !bound.is_finite() {
                break;
            }
            best = best.min(bound.max(0.0));
            if step == STEPS || best <= enough {
                break;
            }
            let mut dx: Vec<V<D>> = rest.iter().map(|v| v.map(|c| -c)).collect();
            self.inverse(band, &mut dx);
            for (k, z) in z.iter_mut().enumerate() {
                axpy(z, 1.0, apply(&self.measure, k, &dx));
            }
            for ((k, m), w) in forces.iter_mut().enumerate().zip(&stiffness) {
                let moved = apply(&self.limit_rows, k, &dx);
                for (m, row) in m.iter_mut().zip(w) {
                    *m += dot(*row, moved);
                }
            }
        }
        best
    }
}
