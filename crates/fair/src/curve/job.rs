//! A curve to be faired: spline, original control points and conditions.

use crate::error::check_finite;
use crate::{FairError, Limit, Measure, Space, SparseRows};
use moldloft_num::Vec3;

/// Condition at an open end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndContinuity {
    /// Nothing.
    Free,
    /// Its position.
    Position,
    /// Position and tangent (the first derivative).
    Tangent,
    /// Position, first and second derivative.
    Curvature,
    /// A number of fixed control points.
    Points(usize),
}

impl EndContinuity {
    /// The end condition called `name` in the language.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "free" => EndContinuity::Free,
            "position" => EndContinuity::Position,
            "tangent" => EndContinuity::Tangent,
            "curvature" => EndContinuity::Curvature,
            _ => return None,
        })
    }

    /// Default condition at the ends when control points move: "tangent" for a fit, otherwise two
    /// control points.
    pub(crate) fn of_control(fitted: bool) -> Self {
        if fitted { Self::Tangent } else { Self::Points(2) }
    }

    /// Number of derivatives kept, including the position.
    pub(crate) fn kept(self) -> usize {
        match self {
            EndContinuity::Free | EndContinuity::Points(_) => 0,
            EndContinuity::Position => 1,
            EndContinuity::Tangent => 2,
            EndContinuity::Curvature => 3,
        }
    }

    /// Number of control points fixed for the condition. The first k points of a clamped spline fix
    /// k - 1 derivatives; on other knots `degree` points fix all derivatives at the end.
    pub(crate) fn points(self, clamped: bool, degree: usize) -> usize {
        match self {
            EndContinuity::Free => 0,
            EndContinuity::Points(k) => k,
            kept if clamped => kept.kept(),
            _ => degree,
        }
    }
}

/// A curve to be faired: spline, original control points and conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// Space of the spline.
    pub space: Space,
    /// The original control points.
    pub points: Vec<Vec3<f64>>,
    /// Weights of a rational curve; they are fixed.
    pub weights: Option<Vec<f64>>,
    /// Limits on the moves.
    pub limit: Limit,
    /// Control points that are intended breaks: they do not move, and nothing is smoothed across
    /// them.
    pub marks: Vec<usize>,
    /// Conditions at open ends.
    pub ends: [EndContinuity; 2],
}

impl Job {
    /// A curve with a ball of radius `tolerance` round each control point. Open ends keep two
    /// control points each, which preserves position and tangent for clamped knots.
    ///
    /// # Errors
    /// [`FairError`] when the points are too few or not finite or the tolerance is not a distance.
    pub fn new(space: Space, points: Vec<Vec3<f64>>, tolerance: f64) -> Result<Self, FairError> {
        let limit = Limit::ball(points.len(), tolerance)?;
        let ends = [EndContinuity::Points(2), EndContinuity::Points(2)];
        let job = Self { space, points, weights: None, limit, marks: Vec::new(), ends };
        job.check()?;
        Ok(job)
    }

    /// Data used directly as the control points of a uniform spline.
    ///
    /// # Errors
    /// As [`Job::new`].
    ///
    /// # Example
    /// ```
    /// use moldloft_fair::{FairError, Job};
    /// use moldloft_num::Vec3;
    /// let points: Vec<_> = (0..9).map(|i| Vec3::of(i as f64, 0.0, 0.0)).collect();
    /// assert!(Job::of_points(3, points.clone(), false, 0.01).is_ok());
    /// let refused = Job::of_points(3, points[..4].to_vec(), false, 0.01);
    /// assert_eq!(refused, Err(FairError::TooFew { expected: 5, actual: 4 }));
    /// ```
    pub fn of_points(
        degree: usize,
        points: Vec<Vec3<f64>>,
        closed: bool,
        tolerance: f64,
    ) -> Result<Self, FairError> {
        let space = if closed {
            Space::closed(degree, points.len())?
        } else {
            // The space would count knots; the error counts points.
            if points.len() < degree + 2 {
                return Err(FairError::TooFew { expected: degree + 2, actual: points.len() });
            }
            Space::floating(degree, points.len())?
        };
        Self::new(space, points, tolerance)
    }

    /// Checks the counts and values of the job.
    ///
    /// # Errors
    /// [`FairError`] with the first thing that is wrong.
    pub fn check(&self) -> Result<(), FairError> {
        let n = self.space.count();
        check_finite(&self.points)?;
        let counts = [
            ("control points", self.points.len()),
            ("tolerances", self.limit.radii.len()),
            ("weights", self.weights.as_ref().map_or(n, Vec::len)),
        ];
        for (what, actual) in counts {
            if actual != n {
                return Err(FairError::Count { what, expected: n, actual });
            }
        }
        for (index, &weight) in self.weights.iter().flatten().enumerate() {
            if !(weight.is_finite() && weight > 0.0) {
                return Err(FairError::Weight { index, weight });
            }
        }
        if let Some(&index) = self.marks.iter().find(|&&m| m >= n) {
            return Err(FairError::Mark { index, count: n });
        }
        if let Some(&value) = self.limit.radii.iter().find(|r| r.is_nan() || **r < 0.0) {
            return Err(FairError::Tolerance { value });
        }
        if self.space.is_closed() && self.limit.radii.iter().any(|r| r.is_infinite()) {
            return Err(FairError::ClosedWithoutTolerance);
        }
        Ok(())
    }

    /// Control points that cannot move.
    pub fn frozen(&self) -> Vec<bool> {
        let n = self.points.len();
        let mut frozen: Vec<bool> = self.limit.radii.iter().map(|&r| r == 0.0).collect();
        for &m in &self.marks {
            frozen[m] = true;
        }
        if !self.space.is_closed() {
            let (p, clamped) = (self.space.degree(), self.space.is_clamped());
            let [first, last] = self.ends.map(|e| e.points(clamped, p).min(n));
            frozen[..first].fill(true);
            frozen[n - last..].fill(true);
        }
        frozen
    }

    /// True when a row's stencil has a mark strictly inside it.
    pub(crate) fn crosses_mark(&self, (columns, _): (&[u32], &[f64])) -> bool {
        !self.marks.is_empty()
            && columns.len() > 2
            && columns[1..columns.len() - 1].iter().any(|&c| self.marks.contains(&(c as usize)))
    }

    /// SparseRows over homogeneous control points as rows over the control points.
    pub fn own_rows(&self, rows: &SparseRows) -> SparseRows {
        match &self.weights {
            None => rows.clone(),
            Some(w) => rows.clone().with_columns_scaled(w),
        }
    }

    /// The rows of a measure that do not cross a mark, over the control points; for a rational
    /// curve relative to the mean of the control points.
    ///
    /// # Errors
    /// [`FairError::Degree`].
    pub fn measure_rows(&self, measure: Measure) -> Result<SparseRows, FairError> {
        let rows = measure.rows(&self.space)?;
        let rows = if self.marks.is_empty() {
            rows
        } else {
            rows.filtered(|c, a| !self.crosses_mark((c, a)))
        };
        Ok(match &self.weights {
            None => rows,
            Some(w) => rows.with_columns_scaled(w),
        })
    }

    /// The point that measures of homogeneous coordinates refer to: the mean control point of a
    /// rational curve (so that results move with the curve), nothing for others.
    pub(crate) fn origin(&self) -> Vec3<f64> {
        match self.weights {
            None => Vec3::zero(),
            Some(_) => {
                let sum = self.points.iter().fold(Vec3::zero(), |s, &p| s + p);
                sum * (1.0 / self.points.len() as f64)
            }
        }
    }

    /// `points` as the measure takes them: relative to their mean for a rational curve.
    pub fn relative(&self, points: &[Vec3<f64>]) -> Vec<Vec3<f64>> {
        let origin = self.origin();
        points.iter().map(|&p| p - origin).collect()
    }

    /// The value of a measure at `points`.
    ///
    /// # Errors
    /// [`FairError::Degree`].
    pub fn value(&self, measure: Measure, points: &[Vec3<f64>]) -> Result<f64, FairError> {
        let rows = self.measure_rows(measure)?;
        Ok(crate::measure::value(&rows, measure.norm(), &self.relative(points)))
    }
}
