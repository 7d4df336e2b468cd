//! The spline of a space nearest to data at given parameters, some of whose control points are given.

use crate::optimum::band::Band;
use crate::{FairError, Space, SparseRows};
use moldloft_num::Vec3;

/// An order of the control points with a narrow band: the natural one; for closed curves
/// alternately from both sides of the first.
#[derive(Clone, Debug)]
pub(crate) struct NarrowOrder {
    pub place: Vec<usize>,
    /// The largest distance of two in a row.
    pub span: usize,
}

impl NarrowOrder {
    pub fn of(space: &Space) -> Self {
        let (n, p) = (space.count(), space.degree());
        if !space.is_closed() {
            return Self { place: (0..n).collect(), span: p.min(n - 1) };
        }
        let folded = |c: usize| if 2 * c < n { 2 * c } else { 2 * (n - 1 - c) + 1 };
        Self { place: (0..n).map(folded).collect(), span: (2 * p).min(n - 1) }
    }
}

/// The normal equations of a space.
pub(crate) struct LeastSquares {
    pub order: NarrowOrder,
    fixed: Vec<(usize, Vec3<f64>)>,
}

impl LeastSquares {
    pub fn new(space: &Space, fixed: Vec<(usize, Vec3<f64>)>) -> Self {
        Self { order: NarrowOrder::of(space), fixed }
    }

    /// Control points that are not prescribed.
    pub fn free(&self) -> Vec<bool> {
        let mut free = vec![true; self.order.place.len()];
        self.fixed.iter().for_each(|f| free[f.0] = false);
        free
    }

    /// The control points; `None` if the data do not determine them.
    ///
    /// # Errors
    /// [`FairError::TooLarge`].
    pub fn solve(
        &self,
        rows: &SparseRows,
        wanted: &[Vec3<f64>],
        weights: &[f64],
    ) -> Result<Option<Vec<Vec3<f64>>>, FairError> {
        let place = &self.order.place;
        let n = place.len();
        let free = self.free();
        let mut band = Band::zero(n, self.order.span)?;
        let mut held = vec![0.0f64; n];
        for (k, &weight) in weights.iter().enumerate() {
            let (columns, factors) = rows.row(k);
            for (i, (&a, &x)) in columns.iter().zip(factors).enumerate() {
                held[a as usize] += weight * x * x;
                for (&b, &y) in columns[..=i].iter().zip(factors) {
                    if free[a as usize] && free[b as usize] {
                        let (a, b) = (place[a as usize], place[b as usize]);
                        band.add_block(a.max(b), a.min(b), weight * x * y, &[[1.0]]);
                    }
                }
            }
        }
        let most = held.iter().copied().fold(0.0, f64::max);
        if (0..n).any(|c| free[c] && held[c] <= 1e-12 * most) {
            return Ok(None);
        }
        for (c, _) in &self.fixed {
            band.add_block(place[*c], place[*c], most, &[[1.0]]);
        }
        band.factor();
        let mut control = vec![wanted[0]; n];
        for &(c, p) in &self.fixed {
            control[c] = p;
        }
        // Iterative refinement.
        for _ in 0..2 {
            let mut right = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
            for (k, &weight) in weights.iter().enumerate() {
                let off = (wanted[k] - rows.apply(k, &control)) * weight;
                let (columns, factors) = rows.row(k);
                for (&c, &f) in columns.iter().zip(factors).filter(|(c, _)| free[**c as usize]) {
                    for (axis, x) in right.iter_mut().zip(off.to_array()) {
                        axis[place[c as usize]] += f * x;
                    }
                }
            }
            right.iter_mut().for_each(|axis| band.solve(axis));
            for (c, p) in control.iter_mut().enumerate().filter(|(c, _)| free[*c]) {
                *p += Vec3::of(right[0][place[c]], right[1][place[c]], right[2][place[c]]);
            }
        }
        Ok(control.iter().all(|c| c.is_finite()).then_some(control))
    }
}
