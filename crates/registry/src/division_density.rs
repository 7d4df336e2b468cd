//! Density of a curve's divisions by panels, so that any number of divisions has the same spacing.

/// Divisions per parameter along a curve, as a table of its integral over [0, 1].
///
/// # Example
/// ```
/// let mut density = moldloft_registry::DivisionDensity::default();
/// density.extend(0.5, &[1.0, 2.0]);
/// density.extend(1.0, &[0.4]);
/// assert_eq!(density.count(), 4);
/// assert_eq!(density.shares(0.0, 1.0, 2), [0.5]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DivisionDensity {
    /// Parameters, ascending from 0.
    at: Vec<f64>,
    /// The integral up to each.
    sum: Vec<f64>,
    /// Indices of the ends of the stretches between breaks, from 0 on.
    ends: Vec<usize>,
}

impl Default for DivisionDensity {
    fn default() -> Self {
        Self { at: vec![0.0], sum: vec![0.0], ends: vec![0] }
    }
}

/// A stretch is divided once more when its integral exceeds a whole number by more than this.
const SLACK: f64 = 1e-6;

impl DivisionDensity {
    /// Extends the table to the next break: the integrals over equal parts of the stretch.
    pub fn extend(&mut self, to: f64, parts: &[f64]) {
        let from = self.at[self.at.len() - 1];
        for (i, part) in parts.iter().enumerate() {
            let share = (i + 1) as f64 / parts.len() as f64;
            self.at.push(if i + 1 == parts.len() { to } else { from + (to - from) * share });
            self.sum.push(self.sum[self.sum.len() - 1] + part.max(0.0));
        }
        self.ends.push(self.at.len() - 1);
    }

    /// Total number of divisions: that of each stretch, rounded up.
    pub fn count(&self) -> u32 {
        let parts = self.ends.windows(2).map(|w| self.sum[w[1]] - self.sum[w[0]]);
        parts.map(|x| (x - SLACK).ceil().clamp(1.0, 1e6) as u32).sum::<u32>().max(1)
    }

    /// The ends of `count` divisions of the curve from one parameter to another, as fractions of
    /// that range, ascending, without 0 and 1. The divisions have equal integrals; breaks are among
    /// the ends if there are enough divisions.
    pub fn shares(&self, from: f64, to: f64, count: u32) -> Vec<f64> {
        let mut stops = vec![from];
        let inner = self.ends.iter().map(|&k| self.at[k]);
        let near = SLACK * (to - from);
        stops.extend(inner.filter(|t| *t > from + near && *t < to - near));
        stops.push(to);
        if stops.len() - 1 > count as usize {
            stops = vec![from, to];
        }
        let sums: Vec<f64> = stops.iter().map(|&t| between(&self.at, &self.sum, t)).collect();
        let weights: Vec<f64> = sums.windows(2).map(|w| w[1] - w[0]).collect();
        let mut counts = vec![1u32; weights.len()];
        for _ in weights.len()..count as usize {
            // The stretch whose divisions are the largest.
            let size = |k: usize| weights[k] / f64::from(counts[k]);
            let most =
                (0..counts.len()).max_by(|&i, &j| size(i).total_cmp(&size(j)).then(j.cmp(&i)));
            counts[most.unwrap_or(0)] += 1;
        }
        let mut shares = Vec::with_capacity(count as usize);
        for (k, w) in stops.windows(2).enumerate() {
            for i in 1..=counts[k] {
                let share = f64::from(i) / f64::from(counts[k]);
                let t = if i == counts[k] {
                    w[1]
                } else if weights[k] > 0.0 {
                    between(&self.sum, &self.at, sums[k] + weights[k] * share).clamp(w[0], w[1])
                } else {
                    w[0] + (w[1] - w[0]) * share
                };
                shares.push((t - from) / (to - from));
            }
        }
        shares.pop();
        shares
    }
}

/// Linear between the entries of a table.
fn between(from: &[f64], to: &[f64], x: f64) -> f64 {
    if from.len() < 2 {
        return x;
    }
    let k = from.partition_point(|a| *a <= x).clamp(1, from.len() - 1);
    let step = from[k] - from[k - 1];
    let share = if step > 0.0 { (x - from[k - 1]) / step } else { 0.0 };
    to[k - 1] + (to[k] - to[k - 1]) * share
}
