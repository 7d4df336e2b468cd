//! Knots between the data, for shapes that no spline with knots at the data has.

use crate::curve::condition::AXES;
use crate::curve::fit::values;
use crate::{FairError, InterpolationSpace, SparseRows};
use moldloft_num::Vec3;
use std::collections::BTreeMap;

/// Factor of a datum below which a site does not depend on it.
const NEGLIGIBLE: f64 = 1e-15;

impl InterpolationSpace {
    /// The layout of the same data, at the parameters `at`, with each interval between neighbours divided into
    /// `parts` by further sites and their knots. These sites have no data: the curve is free there, and the one
    /// through the data is as before. Pieces with fewer data than control points stay as they are.
    ///
    /// # Errors
    /// As [`InterpolationSpace::new`].
    pub(crate) fn refined(
        &self,
        at: &[f64],
        breaks: &[usize],
        closed: bool,
        parts: usize,
    ) -> Result<Self, FairError> {
        let n = at.len();
        let degree = self.space.degree();
        let long = long_gaps(n, breaks, closed, degree);
        let (mut fine, mut data) = (Vec::new(), Vec::new());
        for k in 0..n {
            data.push(fine.len());
            fine.push(at[k]);
            if long.get(k) == Some(&true) {
                let next = if k + 1 < n { at[k + 1] } else { at[0] + 1.0 };
                let share = |j: usize| at[k] + (next - at[k]) * (j as f64 / parts as f64);
                fine.extend((1..parts).map(share));
            }
        }
        let marks: Vec<usize> = breaks.iter().map(|&k| data[k]).collect();
        let mut out = Self::new(degree, &fine, &marks, closed)?;
        let sources = self.through_sources(at, &fine, &data)?;
        let mut rows = SparseRows::new();
        for k in 0..out.sources.len() {
            let (columns, factors) = out.sources.row(k);
            let mut sum = BTreeMap::new();
            for (&c, f) in columns.iter().zip(factors) {
                for &(datum, x) in &sources[c as usize] {
                    *sum.entry(datum).or_insert(0.0) += f * x;
                }
            }
            rows.push(sum);
        }
        let datum = |f: usize| data.binary_search(&f).ok();
        out.free = out.owner.iter().map(|o| o.is_some_and(|f| datum(f).is_none())).collect();
        out.owner = out.owner.iter().map(|o| o.and_then(datum)).collect();
        out.sources = rows;
        out.at.clone_from(&self.at);
        Ok(out)
    }

    /// The curve through the data at parameters `fine`, as combinations of the data; `data` are the places of these.
    fn through_sources(
        &self,
        at: &[f64],
        fine: &[f64],
        data: &[usize],
    ) -> Result<Vec<Vec<(usize, f64)>>, FairError> {
        let n = data.len();
        let own = |t: f64| match self.first {
            Some(first) => (t - at[first]).rem_euclid(1.0),
            None => t,
        };
        let between: Vec<usize> =
            (0..fine.len()).filter(|k| data.binary_search(k).is_err()).collect();
        let places: Vec<f64> = between.iter().map(|&k| own(fine[k])).collect();
        let rows = values(&self.space, &places);
        let mut out = vec![Vec::new(); fine.len()];
        for (k, &place) in data.iter().enumerate() {
            out[place].push((k, 1.0));
        }
        for first in (0..n).step_by(AXES.len()) {
            let own = || AXES.into_iter().zip(first..n);
            let mut unit = vec![Vec3::zero(); n];
            own().for_each(|(axis, k)| unit[k] = axis);
            let control = self.through(&self.data(&unit))?;
            for (row, &place) in between.iter().enumerate() {
                let value = rows.apply(row, &control);
                for (axis, k) in own() {
                    let factor = axis.dot(value);
                    if factor.abs() > NEGLIGIBLE {
                        out[place].push((k, factor));
                    }
                }
            }
        }
        Ok(out)
    }
}

/// For each interval between neighbours, true if its piece between breaks has more data than a polynomial of the
/// degree is determined by.
fn long_gaps(n: usize, breaks: &[usize], closed: bool, degree: usize) -> Vec<bool> {
    let gaps = if closed { n } else { n - 1 };
    let mut bounds: Vec<usize> = breaks.to_vec();
    bounds.sort_unstable();
    bounds.dedup();
    let mut long = vec![true; gaps];
    if !closed {
        bounds.insert(0, 0);
        bounds.push(n - 1);
        bounds.dedup();
    } else if let Some(&first) = bounds.first() {
        bounds.push(first + n);
    }
    for w in bounds.windows(2).filter(|w| w[1] - w[0] <= degree) {
        (w[0]..w[1]).for_each(|k| long[k % n] = false);
    }
    long
}
