//! Knot vectors: checked once, non-decreasing, `n + degree + 1` knots for `n` control points.

use std::fmt;

/// Maximum polynomial degree of a spline.
pub const MAX_DEGREE: usize = 25;

/// Reason why a list of numbers is not a knot vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KnotError {
    /// The degree is not in 1..=[`MAX_DEGREE`].
    Degree {
        /// The given degree.
        degree: usize,
    },
    /// A clamped spline needs at least `2 (degree + 1)` knots.
    TooFew {
        /// The minimum number of knots for this degree.
        expected: usize,
        /// The number given.
        actual: usize,
    },
    /// A knot is NaN or infinite.
    NotFinite {
        /// Its index.
        index: usize,
    },
    /// A knot is smaller than the one before it.
    Unsorted {
        /// Index of the smaller knot.
        index: usize,
        /// The knot before it.
        before: f64,
        /// The knot itself.
        knot: f64,
    },
    /// A knot is repeated more than `degree + 1` times.
    Multiplicity {
        /// The knot.
        knot: f64,
        /// Actual multiplicity.
        actual: usize,
        /// Maximum multiplicity.
        allowed: usize,
    },
    /// The parameter range from knot `degree` to the `degree`-th knot from the end is empty.
    EmptyDomain {
        /// The only parameter.
        at: f64,
    },
}

impl fmt::Display for KnotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Degree { degree } => {
                write!(f, "expected a degree from 1 to {MAX_DEGREE}, found {degree}")
            }
            Self::TooFew { expected, actual } => {
                write!(f, "expected at least {expected} knots, found {actual}")
            }
            Self::NotFinite { index } => write!(f, "knot {} is not a finite number", index + 1),
            Self::Unsorted { index, before, knot } => {
                write!(f, "knot {} is {knot}, smaller than the knot {before} before it", index + 1)
            }
            Self::Multiplicity { knot, actual, allowed } => {
                write!(f, "knot {knot} has multiplicity {actual}, at most {allowed} is allowed")
            }
            Self::EmptyDomain { at } => {
                write!(f, "the knots span no parameter range, only the value {at}")
            }
        }
    }
}

impl std::error::Error for KnotError {}

/// A checked, non-decreasing list of knots with its degree: `n + degree + 1` knots for `n` control
/// points, end knots included.
///
/// # Example
/// ```
/// use moldloft_spline::{KnotError, KnotVector};
/// let knots = KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0]).unwrap();
/// assert_eq!((knots.points(), knots.domain()), (4, (0.0, 1.0)));
/// assert_eq!(knots, KnotVector::clamped_uniform(2, 4).unwrap());
/// let refused = KnotVector::new(1, vec![0.0, 0.0, 2.0, 1.0]);
/// assert_eq!(refused, Err(KnotError::Unsorted { index: 3, before: 2.0, knot: 1.0 }));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct KnotVector {
    degree: usize,
    knots: Vec<f64>,
}

impl KnotVector {
    /// The knot vector of these numbers, unchanged.
    ///
    /// # Errors
    /// [`KnotError`] when they are too few, not finite, not sorted, too often repeated, or span
    /// nothing.
    pub fn new(degree: usize, knots: Vec<f64>) -> Result<Self, KnotError> {
        if !(1..=MAX_DEGREE).contains(&degree) {
            return Err(KnotError::Degree { degree });
        }
        let expected = 2 * (degree + 1);
        if knots.len() < expected {
            return Err(KnotError::TooFew { expected, actual: knots.len() });
        }
        if let Some(index) = knots.iter().position(|k| !k.is_finite()) {
            return Err(KnotError::NotFinite { index });
        }
        if let Some(k) = knots.windows(2).position(|w| w[1] < w[0]) {
            return Err(KnotError::Unsorted { index: k + 1, before: knots[k], knot: knots[k + 1] });
        }
        for run in knots.chunk_by(|a, b| a == b) {
            if run.len() > degree + 1 {
                let (knot, actual) = (run[0], run.len());
                return Err(KnotError::Multiplicity { knot, actual, allowed: degree + 1 });
            }
        }
        let (start, end) = (knots[degree], knots[knots.len() - degree - 1]);
        if start == end {
            return Err(KnotError::EmptyDomain { at: start });
        }
        Ok(Self { degree, knots })
    }

    /// The clamped uniform knots of `points` control points on [0, 1]: interior knots
    /// `i / (points - degree)`.
    ///
    /// # Errors
    /// [`KnotError::TooFew`] when `points <= degree`, [`KnotError::Degree`].
    pub fn clamped_uniform(degree: usize, points: usize) -> Result<Self, KnotError> {
        if !(1..=MAX_DEGREE).contains(&degree) {
            return Err(KnotError::Degree { degree });
        }
        if points <= degree {
            let (expected, actual) = (2 * (degree + 1), points + degree + 1);
            return Err(KnotError::TooFew { expected, actual });
        }
        let spans = points - degree;
        let mut knots = vec![0.0; degree];
        knots.extend((0..=spans).map(|i| i as f64 / spans as f64));
        knots.extend(std::iter::repeat_n(1.0, degree));
        Ok(Self { degree, knots })
    }

    /// The polynomial degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The number of control points.
    pub fn points(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// All knots.
    pub fn as_slice(&self) -> &[f64] {
        &self.knots
    }

    /// First and last parameter.
    pub fn domain(&self) -> (f64, f64) {
        (self.knots[self.degree], self.knots[self.points()])
    }

    /// The same knots, moved and scaled to the domain [0, 1], with exact ends.
    pub fn normalized(&self) -> Self {
        let (start, end) = self.domain();
        if (start, end) == (0.0, 1.0) {
            return self.clone();
        }
        let scale = |k: f64| if k == end { 1.0 } else { (k - start) / (end - start) };
        Self { degree: self.degree, knots: self.knots.iter().copied().map(scale).collect() }
    }

    /// The knots of the reversed curve on the same domain.
    pub fn reversed(&self) -> Self {
        let (start, end) = self.domain();
        let flip = |k: f64| {
            if k == start {
                end
            } else if k == end {
                start
            } else {
                start + end - k
            }
        };
        let knots = self.knots.iter().rev().copied().map(flip).collect();
        Self { degree: self.degree, knots }
    }

    /// The span `k` with `knots[k] <= t < knots[k + 1]`: the first or last non-empty one for `t`
    /// outside the domain or at its end (Piegl and Tiller 1997, A2.1).
    #[inline]
    pub fn find_span(&self, t: f64) -> usize {
        let (p, n) = (self.degree, self.points());
        // The domain is not empty, so a knot below its end exists in p..n.
        let t = if t < self.knots[n] { t.max(self.knots[p]) } else { self.knots[n].next_down() };
        let t = t.max(self.knots[p]);
        p + self.knots[p + 1..n].partition_point(|&k| k <= t)
    }

    /// The non-empty spans of the domain, ascending.
    pub fn spans(&self) -> impl Iterator<Item = usize> + '_ {
        (self.degree..self.points()).filter(|&k| self.knots[k] < self.knots[k + 1])
    }

    /// Multiplicity of `knot` in the list.
    pub fn multiplicity(&self, knot: f64) -> usize {
        self.knots.iter().filter(|&&k| k == knot).count()
    }

    /// The distinct knots inside the domain at which a derivative up to the second may jump.
    pub fn breaks(&self) -> Vec<f64> {
        let (start, end) = self.domain();
        let runs = self.knots.chunk_by(|a, b| a == b);
        let inside = runs.filter(|run| start < run[0] && run[0] < end);
        inside.filter(|run| self.degree < run.len() + 2).map(|run| run[0]).collect()
    }

    /// The distinct knots inside the domain.
    pub fn joints(&self) -> Vec<f64> {
        let (start, end) = self.domain();
        let mut all: Vec<f64> =
            self.knots.iter().copied().filter(|&k| start < k && k < end).collect();
        all.dedup();
        all
    }

    /// The same knots with `knot` inserted `times` more.
    ///
    /// # Errors
    /// [`KnotError`] as for [`KnotVector::new`].
    pub fn with_knot(&self, knot: f64, times: usize) -> Result<Self, KnotError> {
        let at = self.knots.partition_point(|&k| k <= knot);
        let mut knots = self.knots.clone();
        knots.splice(at..at, std::iter::repeat_n(knot, times));
        Self::new(self.degree, knots)
    }

    /// The knots of the same splines in the next higher degree: the multiplicity of each distinct
    /// knot is increased by one.
    ///
    /// # Errors
    /// [`KnotError::Degree`] above [`MAX_DEGREE`].
    pub fn elevated(&self) -> Result<Self, KnotError> {
        let runs = self.knots.chunk_by(|a, b| a == b);
        let knots = runs.flat_map(|run| std::iter::repeat_n(run[0], run.len() + 1)).collect();
        Self::new(self.degree + 1, knots)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_what_is_no_knot_vector() {
        let new = KnotVector::new;
        assert_eq!(new(0, vec![0.0, 1.0]), Err(KnotError::Degree { degree: 0 }));
        assert_eq!(new(26, vec![0.0; 60]), Err(KnotError::Degree { degree: 26 }));
        let few = Err(KnotError::TooFew { expected: 6, actual: 5 });
        assert_eq!(new(2, vec![0.0, 0.0, 0.5, 1.0, 1.0]), few);
        assert_eq!(KnotVector::clamped_uniform(2, 2), few);
        let nan = new(1, vec![0.0, 0.0, f64::NAN, 1.0, 1.0]);
        assert_eq!(nan, Err(KnotError::NotFinite { index: 2 }));
        let many = new(1, vec![0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0]);
        assert_eq!(many, Err(KnotError::Multiplicity { knot: 0.5, actual: 3, allowed: 2 }));
        let empty = new(1, vec![0.0, 0.5, 0.5, 1.0]);
        assert_eq!(empty, Err(KnotError::EmptyDomain { at: 0.5 }));
        assert!(empty.unwrap_err().to_string().contains("0.5"));
    }

    #[test]
    fn spans_are_not_empty_and_hold_their_parameter() {
        let knots = vec![0.0, 0.0, 0.0, 0.25, 0.25, 0.5, 1.0, 1.0, 1.0];
        let knots = KnotVector::new(2, knots).unwrap();
        let found = [-1.0, 0.0, 0.2, 0.25, 0.4, 0.5, 0.75, 1.0, 7.0].map(|t| knots.find_span(t));
        assert_eq!(found, [2, 2, 2, 4, 4, 5, 5, 5, 5]);
        assert_eq!(knots.spans().collect::<Vec<_>>(), [2, 4, 5]);
        assert_eq!(knots.breaks(), [0.25, 0.5]);
        assert_eq!(KnotVector::clamped_uniform(3, 6).unwrap().joints().len(), 2);
        assert_eq!(KnotVector::clamped_uniform(4, 7).unwrap().breaks(), []);
    }

    #[test]
    fn an_unclamped_end_keeps_its_span() {
        let knots = KnotVector::new(2, vec![-2.0, -1.0, 0.0, 1.0, 1.0, 1.0]).unwrap();
        assert_eq!(knots.domain(), (0.0, 1.0));
        assert_eq!(knots.find_span(1.0), 2);
        assert_eq!(knots.reversed().reversed(), knots);
        let wide = KnotVector::new(1, vec![2.0, 2.0, 3.0, 6.0, 6.0]).unwrap();
        assert_eq!(wide.normalized().as_slice(), [0.0, 0.0, 0.25, 1.0, 1.0]);
    }
}
