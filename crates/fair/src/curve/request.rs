//! From what is asked of a curve near its points to the curve: the same way for models, Python and
//! the command.

use crate::curve::data::{
    Data, DataFit, DataOptions, MovingFit, fair_data, fair_data_with, merged,
};
use crate::curve::demand::Demand;
use crate::curve::fit::{ParameterSpacing, parameters_across};
use crate::curve::job::EndContinuity;
use crate::curve::near::{TurnedFrom, fair_turned};
use crate::curve::thinning::thinned;
use crate::curve::turning::{curvature_parameters, drafted_parameters, near_budget};
use crate::interrogate::report::{FairingReport, report_of};
use crate::optimum::goal::Goal;
use crate::{FairError, InterpolationSpace, Limit, Measure, Motion, ShapeCondition};
use moldloft_num::{Real, Vec3};
use moldloft_spline::SplineWithKnotDerivatives;

/// How points get their parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointSpacing {
    /// By the turns of the curve for the goals `near` and `budget` where nothing else is asked for,
    /// and on few knots where the points are many; else by distance.
    Auto,
    /// Lengths, longer where the curve turns.
    Curvature,
    /// As said.
    Given(ParameterSpacing),
}

/// What is asked of a curve near its points. Points are counted from 0.
#[derive(Clone, Debug)]
pub struct CurveRequest<T> {
    /// How far the curve may be from each point.
    pub tolerances: Vec<T>,
    /// Points that it passes through.
    pub fixed: Vec<usize>,
    /// Wrong points, which it may leave as far as they are apart.
    pub release: Vec<usize>,
    /// Intended breaks.
    pub breaks: Vec<usize>,
    /// Polynomial degree.
    pub degree: usize,
    /// Whether the last point is followed by the first.
    pub closed: bool,
    /// The measure to minimise; [`CurveRequest::data_measure`] without one.
    pub measure: Option<Measure>,
    /// Which of the curves.
    pub goal: Goal,
    /// How the points get their parameters, and these themselves where they are given.
    pub spacing: PointSpacing,
    /// Rising parameters of the points, of a closed curve less than 1 apart.
    pub at: Option<Vec<T>>,
    /// What open ends keep of the curve through the points.
    pub ends: [EndContinuity; 2],
    /// In which directions it leaves them.
    pub motion: Motion,
    /// What shape it has.
    pub shape: Vec<ShapeCondition>,
    /// Conditions at parameters in [0, 1].
    pub conditions: Vec<(f64, Demand)>,
    /// Whether it may have more inflections and pieces than the fairest.
    pub bends: bool,
    /// The certified gap, as a share of the measure; rounding allows no less than the one without.
    pub accuracy: Option<f64>,
    /// Whether a draft is enough, as while a tolerance slides: within the tolerances and under the goal's
    /// budget, but with bends as they come, and without derivatives.
    pub draft: bool,
}

/// A curve near its points.
#[derive(Clone, Debug)]
pub struct NearCurve<T> {
    /// The data: neighbours in one place are one of them.
    pub data: Data,
    /// Which datum each point became.
    pub of: Vec<usize>,
    /// Control points and knots of the curve.
    pub made: MovingFit<T>,
    /// What is known of it.
    pub fit: DataFit,
    /// The measure that was taken.
    pub measure: Measure,
}

/// The certified gap without another: as small as rounding allows, so that which limits are reached
/// is decided and derivatives are those of the optimum itself.
pub(crate) const ACCURACY: f64 = 1e-13;

impl<T: Real> NearCurve<T> {
    /// All about it, as data.
    ///
    /// # Errors
    /// [`FairError::Degree`].
    pub fn report(&self) -> Result<FairingReport, FairError> {
        report_of(&self.data, self.measure, &self.fit)
    }

    /// The spline; none where it has no open form.
    pub fn curve(&self) -> Option<SplineWithKnotDerivatives<T>> {
        let space = &self.data.layout.space;
        let (knots, control) = space.open_form(&self.made.knots, &self.made.points);
        SplineWithKnotDerivatives::new(space.degree(), Some(knots), control, None).ok()
    }
}

const MERGED: &str =
    "derivatives of curves through points of which some are in one place are not known";

const GATED: &str = "derivatives of a curve that is fairer than its goal so that it bends no more often than the \
                     fairest, or that has conditions against bends, are not known: allow them (bends = 1)";

impl<T: Real> CurveRequest<T> {
    /// The defaults: a cubic near `points` within one tolerance, whose ends are free.
    ///
    /// # Example
    /// ```
    /// use moldloft_fair::{CurveRequest, shape};
    /// use moldloft_num::Vec3;
    /// // A straight line with noise stays straight.
    /// let noise = |k: i32| 1e-3 * f64::from(k * k * 7919 % 1009) / 1009.0;
    /// let points: Vec<_> = (0..41).map(|k| Vec3::of(f64::from(k) / 4.0, noise(k), 0.0)).collect();
    /// let curve = CurveRequest::of(&points, 1e-3).curve(&points).unwrap();
    /// let space = &curve.data.layout.space;
    /// assert_eq!(shape::inflections(&shape::samples(space, &curve.fit.points, None, 16)), 0);
    /// ```
    pub fn of(points: &[Vec3<T>], tolerance: T) -> Self {
        let plain: Vec<Vec3<f64>> = points.iter().map(|p| p.re()).collect();
        let motion = Motion::Ball;
        Self {
            tolerances: vec![tolerance; points.len()],
            fixed: Vec::new(),
            release: Vec::new(),
            breaks: Vec::new(),
            degree: 3,
            closed: false,
            measure: None,
            goal: Goal::Near(near_budget(&plain, motion)),
            spacing: PointSpacing::Auto,
            at: None,
            ends: [EndContinuity::Free; 2],
            motion,
            shape: Vec::new(),
            conditions: Vec::new(),
            bends: false,
            accuracy: None,
            draft: false,
        }
    }

    /// The measure of data without one: the third derivative, or of a lower degree the second.
    pub fn data_measure(degree: usize) -> Measure {
        if degree >= 3 { Measure::Variation } else { Measure::Bending }
    }

    /// Whether nothing but a goal and tolerances are asked for.
    fn plain(&self) -> bool {
        self.shape.is_empty() && self.conditions.is_empty() && self.motion == Motion::Ball
    }

    /// Whether parameters follow the turns.
    fn turns(&self) -> bool {
        let free = self.closed || self.ends.iter().all(|e| e.kept() < 2);
        match self.spacing {
            _ if self.at.is_some() => false,
            PointSpacing::Curvature => true,
            PointSpacing::Given(_) => false,
            PointSpacing::Auto => {
                self.plain() && free && matches!(self.goal, Goal::Near(_) | Goal::Budget(_))
            }
        }
    }

    /// Whether many points may be on few knots.
    fn thins(&self, measure: Measure) -> bool {
        let along = matches!(self.motion, Motion::Along(_));
        let measured = !matches!(measure, Measure::Jumps | Measure::JumpLengths);
        self.shape.is_empty()
            && self.conditions.is_empty()
            && self.breaks.is_empty()
            && self.at.is_none()
            && self.spacing == PointSpacing::Auto
            && (self.motion == Motion::Ball || along)
            && measured
            && matches!(self.goal, Goal::Near(_) | Goal::Fairest)
    }

    /// The curve near `points`.
    ///
    /// # Errors
    /// [`FairError`]: of too few points, of points and tolerances that are none, of conditions and
    /// shapes that cannot hold (numbered as they are given), of derivatives that are not known.
    pub fn curve(&self, points: &[Vec3<T>]) -> Result<NearCurve<T>, FairError> {
        let n = points.len();
        let plain: Vec<Vec3<f64>> = points.iter().map(|p| p.re()).collect();
        crate::error::check_finite(&plain)?;
        let least = if self.closed { 2 * self.degree + 2 } else { self.degree + 2 };
        if n < least {
            return Err(FairError::TooFew { expected: least, actual: n });
        }
        let tolerances = self.allowed(&plain)?;
        let at = self.at.iter().flatten().copied();
        let mut moving = points.iter().flat_map(|p| p.to_array()).chain(at);
        let still = moving.all(|x| x.is_constant()) && tolerances.iter().all(|t| t.is_constant());
        let radii: Vec<f64> = tolerances.iter().map(|t| t.re()).collect();
        let one = merged(&plain, &radii, self.closed)?;
        if one.points.len() == n {
            return self.near(points, &tolerances, one.of, still);
        }
        if !still {
            return Err(FairError::NoDerivative(MERGED));
        }
        let lifted: Vec<Vec3<T>> = one.points.iter().map(|&p| Vec3::lifted(p)).collect();
        let radii: Vec<T> = one.radii.iter().map(|&r| T::from(r)).collect();
        let mut joined = self.clone();
        joined.breaks = self.breaks.iter().map(|&k| one.of[k]).collect();
        joined.shape = self.shape.iter().map(|s| s.renumbered(|k| one.of[k])).collect();
        joined.at = self.at.as_ref().map(|at| {
            let first = |k: usize| one.of.iter().position(|&o| o == k).unwrap_or(0);
            (0..lifted.len()).map(|k| at[first(k)]).collect()
        });
        joined.near(&lifted, &radii, one.of, true)
    }

    /// The tolerance of each point.
    fn allowed(&self, plain: &[Vec3<f64>]) -> Result<Vec<T>, FairError> {
        let count = plain.len();
        if self.tolerances.len() != count {
            let (what, actual) = ("tolerances", self.tolerances.len());
            return Err(FairError::Count { what, expected: count, actual });
        }
        let numbered = [&self.fixed, &self.release, &self.breaks];
        if let Some(&index) = numbered.into_iter().flatten().find(|&&k| k >= count) {
            return Err(FairError::Mark { index, count });
        }
        let mut out = self.tolerances.clone();
        for &k in &self.fixed {
            out[k] = T::zero();
        }
        // As far as the extent of the points is no limit.
        let size = plain.iter().map(|p| (*p - plain[0]).norm()).fold(0.0, f64::max);
        for &k in &self.release {
            out[k] += T::from(size);
        }
        Ok(out)
    }

    fn near(
        &self,
        points: &[Vec3<T>],
        tolerances: &[T],
        of: Vec<usize>,
        still: bool,
    ) -> Result<NearCurve<T>, FairError> {
        let plain: Vec<Vec3<f64>> = points.iter().map(|p| p.re()).collect();
        let radii: Vec<f64> = tolerances.iter().map(|t| t.re()).collect();
        if self.closed && radii.iter().any(|r| r.is_infinite()) {
            return Err(FairError::ClosedWithoutTolerance);
        }
        let measure = self.measure.unwrap_or(Self::data_measure(self.degree));
        let limit = Limit::new(self.motion, radii)?;
        let turning = self.turns();
        let thin = if self.thins(measure) {
            thinned(&plain, &limit, self.ends, self.degree, self.closed, turning)?
        } else {
            None
        };
        let turning = turning && thin.is_none();
        let mut at = match (&self.at, self.spacing) {
            (Some(at), _) => at.clone(),
            (None, spacing) => {
                let spacing = match spacing {
                    PointSpacing::Given(spacing) => spacing,
                    PointSpacing::Auto | PointSpacing::Curvature => ParameterSpacing::Chord,
                };
                parameters_across(points, spacing, self.closed, (limit.motion, &limit.radii))?
            }
        };
        let laid = |at: &[T]| {
            let real: Vec<f64> = at.iter().map(|t| t.re()).collect();
            InterpolationSpace::new(self.degree, &real, &self.breaks, self.closed)
        };
        let layout = match thin {
            Some(thin) => thin,
            None => laid(&at)?,
        };
        let mut data = Data { layout, limit, ends: self.ends, points: plain };
        let alone = self.shape.is_empty() && self.conditions.is_empty();
        let lengths = (turning && alone).then(|| data.clone());
        let reals = |at: &[T]| at.iter().map(|t| t.re()).collect::<Vec<f64>>();
        let by_length = reals(&at);
        if turning {
            at = if self.draft && still {
                drafted_parameters(&data, &by_length)?.into_iter().map(T::from).collect()
            } else {
                curvature_parameters(&data, points, tolerances, &at)?
            };
            data.layout = laid(&at)?;
        }
        let (data, shape) = data.shaped(&self.shape)?;
        let mut options = DataOptions::of(measure, self.goal);
        // Exact derivatives need to know which limits are reached; signs are not that exact.
        let least = if shape.is_empty() { ACCURACY } else { options.accuracy };
        options.accuracy = self.accuracy.unwrap_or(least);
        (options.shape, options.bends) = (shape, self.bends);
        options.bends |= measure == Measure::JumpLengths;
        let mut owners = Vec::new();
        if !self.conditions.is_empty() {
            let control = data.layout.through(&data.layout.data(&data.points))?;
            for (k, &(t, demand)) in self.conditions.iter().enumerate() {
                let all = demand.conditions(&data.layout.space, &control, t)?;
                owners.extend(std::iter::repeat_n(k, all.len()));
                options.conditions.extend(all);
            }
        }
        let own = |error: FairError| match error {
            FairError::Contradiction { conditions, ends, miss } => {
                let mut conditions: Vec<usize> =
                    conditions.into_iter().filter_map(|c| owners.get(c).copied()).collect();
                conditions.dedup();
                FairError::Contradiction { conditions, ends, miss }
            }
            other => other,
        };
        if self.draft && still {
            let fit = data.drafted(&options).map_err(own)?;
            let made = MovingFit::still(&data.layout, &fit);
            return Ok(NearCurve { data, of, made, fit, measure });
        }
        if !options.bends {
            let own_at = reals(&at);
            let turned = lengths.as_ref();
            let turned = turned.map(|lengths| TurnedFrom { lengths, own: &own_at, at: &by_length });
            let (layout, fit) = fair_turned(&data, &options, turned).map_err(own)?;
            if still {
                let data = Data { layout: layout.unwrap_or_else(|| data.layout.clone()), ..data };
                let made = MovingFit::still(&data.layout, &fit);
                return Ok(NearCurve { data, of, made, fit, measure });
            }
            // What nothing held back moves as the goal's own curve does.
            let free = DataOptions { bends: true, ..options.clone() };
            let plain = fair_data(&data, &free).map_err(own)?;
            if layout.is_some() || plain.points != fit.points {
                return Err(FairError::NoDerivative(GATED));
            }
            options.bends = true;
        }
        let (made, fit) = fair_data_with(&data, &options, points, tolerances, &at).map_err(own)?;
        Ok(NearCurve { data, of, made, fit, measure })
    }
}
