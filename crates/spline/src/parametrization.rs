//! Parametrizations of points to interpolate: by chord length, centripetal, uniform.

use crate::InterpolationError;
use moldloft_num::{Real, Vec3};

/// Parametrisation of an interpolating spline by its points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Parametrization {
    /// In proportion to the chords.
    #[default]
    Chord,
    /// In proportion to the square roots of the chords (Lee 1989): smoother if chords differ
    /// widely.
    Centripetal,
    /// Evenly, whatever the points.
    Index,
}

/// Points nearer to each other than this, relative to their size, coincide: they have no chord
/// direction.
const NEAR: f64 = 4.0 * f64::EPSILON;

impl Parametrization {
    /// The knots of these points, the first exactly 0 and the last exactly 1.
    ///
    /// # Errors
    /// [`InterpolationError`] for fewer than two points, points that are not finite, and, except by
    /// index, neighbours that coincide.
    pub fn knots<T: Real>(self, points: &[Vec3<T>]) -> Result<Vec<T>, InterpolationError> {
        let n = points.len();
        if n < 2 {
            return Err(InterpolationError::TooFew { expected: 2, actual: n });
        }
        if let Some(index) = points.iter().position(|p| !p.is_finite()) {
            return Err(InterpolationError::NotFinite { index });
        }
        if self == Self::Index {
            return Ok(even(n));
        }
        let mut steps = Vec::with_capacity(n - 1);
        for k in 1..n {
            let step = self.step(points[k - 1], points[k]);
            let coincide = InterpolationError::Coincident { first: k - 1, second: k };
            steps.push(step.ok_or(coincide)?);
        }
        Ok(cumulated(&steps))
    }

    /// The common knots of the lines of a grid, (i, j) at `i * n + j`, along i (`axis` 0) or j (1):
    /// the means of the knots of all lines that have a length. A line with coincident neighbours
    /// contributes a step of zero there.
    ///
    /// # Errors
    /// As [`Self::knots`]; coincident when no line has a step between two neighbours.
    pub fn averaged<T: Real>(
        self,
        m: usize,
        n: usize,
        points: &[Vec3<T>],
        axis: usize,
    ) -> Result<Vec<T>, InterpolationError> {
        let (count, lines, step, start) = if axis == 0 { (m, n, n, 1) } else { (n, m, 1, n) };
        if count < 2 {
            return Err(InterpolationError::TooFew { expected: 2, actual: count });
        }
        if let Some(index) = points.iter().position(|p| !p.is_finite()) {
            return Err(InterpolationError::NotFinite { index });
        }
        if self == Self::Index {
            return Ok(even(count));
        }
        let mut means = vec![T::zero(); count - 1];
        for line in 0..lines {
            let at = |k: usize| points[line * start + k * step];
            let steps: Vec<T> =
                (1..count).map(|k| self.step(at(k - 1), at(k)).unwrap_or_default()).collect();
            let total = steps.iter().fold(T::zero(), |sum, &s| sum + s);
            if total.re() == 0.0 {
                continue;
            }
            for (mean, step) in means.iter_mut().zip(steps) {
                *mean += step / total;
            }
        }
        match means.iter().position(|s| s.re() == 0.0) {
            Some(k) => Err(InterpolationError::Coincident { first: k, second: k + 1 }),
            None => Ok(cumulated(&means)),
        }
    }

    /// The step of the knots between two points; `None` when they coincide.
    fn step<T: Real>(self, a: Vec3<T>, b: Vec3<T>) -> Option<T> {
        let chord = b - a;
        let size = a.re().norm_sq().max(b.re().norm_sq());
        if chord.norm_sq().re() <= NEAR.powi(2) * size {
            return None;
        }
        let length = chord.norm();
        Some(if self == Self::Centripetal { length.sqrt() } else { length })
    }
}

fn even<T: Real>(n: usize) -> Vec<T> {
    let last = (n - 1) as f64;
    (0..n).map(|k| T::from(k as f64 / last)).collect()
}

fn cumulated<T: Real>(steps: &[T]) -> Vec<T> {
    let mut knots = Vec::with_capacity(steps.len() + 1);
    let mut total = T::zero();
    knots.push(total);
    for &step in steps {
        total += step;
        knots.push(total);
    }
    let shrink = T::one() / total;
    let last = steps.len();
    for knot in &mut knots[1..last] {
        *knot *= shrink;
    }
    knots[last] = T::one();
    knots
}
