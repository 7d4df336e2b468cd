//! A curve near its points from a request: the same for models, Python and the command.

use crate::curve::data::{Data, DataFit, DataOptions, fair_data, merged};
use crate::curve::data_moved::{DataNumbers, MovingFit, fair_data_under};
use crate::curve::demand::Demand;
use crate::curve::exact::is_exact;
use crate::curve::fit::{ParameterSpacing, parameters_across, released};
use crate::curve::job::EndContinuity;
use crate::curve::near::{TurnedFrom, fair_turned};
use crate::curve::noisy_order::in_noisy_order;
use crate::curve::thinning::{MANY_DATA, thinned};
use crate::curve::turning::{curvature_parameters, drafted_parameters, near_budget};
use crate::interrogate::report::{FairingReport, report_of};
use crate::optimum::goal::Goal;
use crate::{
    FairError, InterpolationSpace, Limit, Measure, Motion, ShapeCondition, ShapeConstraints,
};
use moldloft_num::{Real, Vec3};
use moldloft_spline::SplineWithKnotDerivatives;

/// Parametrisation of the points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointSpacing {
    /// By curvature for the goals `near` and `budget` without further conditions, and with few
    /// knots for many points; otherwise by chord length.
    Auto,
    /// Chord lengths, extended where the curve turns.
    Curvature,
    /// A given parametrisation.
    Given(ParameterSpacing),
}

/// Points and conditions of a curve near them. Points are counted from 0.
#[derive(Clone, Debug)]
pub struct CurveRequest<T> {
    /// Maximum distance of each point from the curve.
    pub tolerances: Vec<T>,
    /// Points that the curve passes through.
    pub fixed: Vec<usize>,
    /// Wrong points: the curve may leave them by any distance.
    pub release: Vec<usize>,
    /// Intended breaks.
    pub breaks: Vec<usize>,
    /// Polynomial degree.
    pub degree: usize,
    /// True if the curve is closed: the first point follows the last.
    pub closed: bool,
    /// The measure to minimise; [`CurveRequest::data_measure`] without one.
    pub measure: Option<Measure>,
    /// Selection among the curves within the tolerances.
    pub goal: Goal,
    /// Parametrisation, or given parameters.
    pub spacing: PointSpacing,
    /// Increasing parameters of the points; within a range of less than 1 for a closed curve.
    pub at: Option<Vec<T>>,
    /// Conditions at open ends, relative to the curve through the points.
    pub ends: [EndContinuity; 2],
    /// Directions in which the curve may leave its points.
    pub motion: Motion,
    /// Shape conditions.
    pub shape: Vec<ShapeCondition>,
    /// Conditions at parameters in [0, 1].
    pub conditions: Vec<(f64, Demand<T>)>,
    /// True to allow more inflections and monotone pieces than the fairest curve has.
    pub bends: bool,
    /// Certified gap, relative to the measure; `None`: rounding, the smallest possible.
    pub accuracy: Option<f64>,
    /// True for a draft, as while a tolerance slides: within the tolerances and the goal's budget,
    /// but with inflections not limited and without derivatives.
    pub draft: bool,
}

/// A curve near its points.
#[derive(Clone, Debug)]
pub struct NearCurve<T> {
    /// The data; coincident neighbours are merged.
    pub data: Data,
    /// Index of the merged datum for each point.
    pub of: Vec<usize>,
    /// Control points and knots.
    pub made: MovingFit<T>,
    /// The fit with its figures.
    pub fit: DataFit,
    /// The measure used.
    pub measure: Measure,
}

/// The certified gap without another: as small as rounding allows, so that which limits are reached
/// is decided and derivatives are those of the optimum itself.
pub(crate) const ACCURACY: f64 = 1e-13;

impl<T: Real> NearCurve<T> {
    /// All figures, as data.
    ///
    /// # Errors
    /// [`FairError::Degree`].
    pub fn report(&self) -> Result<FairingReport, FairError> {
        report_of(&self.data, self.measure, &self.fit)
    }

    /// The spline; `None` without an open form.
    pub fn curve(&self) -> Option<SplineWithKnotDerivatives<T>> {
        let space = &self.data.layout.space;
        let (knots, control) = space.open_form(&self.made.knots, &self.made.points);
        SplineWithKnotDerivatives::new(space.degree(), Some(knots), control, None).ok()
    }
}

/// Parts of the intervals between data, until a shape holds.
const INTERVAL_PARTS: [usize; 3] = [1, 2, 4];

const MERGED: &str = "no derivatives are available for curves through coincident points";

const NOISY: &str =
    "no derivatives are available for a curve along which noise reverses the order of points";

const GATED: &str = "no derivatives are available for a curve from which inflections were \
removed, or with conditions against inflections: allow them (bends = 1)";

impl<T: Real> CurveRequest<T> {
    /// The defaults: a cubic near `points` within one tolerance, with free ends.
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

    /// The default measure for data: the third derivative, or the second below degree 3.
    pub fn data_measure(degree: usize) -> Measure {
        if degree >= 3 { Measure::Variation } else { Measure::Bending }
    }

    /// True without conditions besides goal and tolerances.
    fn plain(&self) -> bool {
        self.shape.is_empty() && self.conditions.is_empty() && self.motion == Motion::Ball
    }

    /// True if parameters follow the curvature.
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

    /// True if many points may have few knots.
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
    /// [`FairError`] for too few points, values that are not finite, contradicting conditions and
    /// shapes (numbered as given), and derivatives that are not available.
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
        let still = moving.all(|x| x.is_constant())
            && tolerances.iter().all(|t| t.is_constant())
            && self.conditions.iter().all(|(_, demand)| demand.is_constant());
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
        let automatic = !self.closed
            && self.at.is_none()
            && self.spacing == PointSpacing::Auto
            && self.motion == Motion::Ball
            && points.len() < MANY_DATA
            && !released(&plain, &limit.radii).contains(&true);
        let noisy = automatic.then(|| in_noisy_order(&plain, &limit.radii)).flatten();
        let noisy = noisy.filter(|_| !is_exact(&plain, &self.breaks, false));
        if noisy.is_some() && !still {
            return Err(FairError::NoDerivative(NOISY));
        }
        let moved = noisy.as_ref().map_or(0.0, |noisy| noisy.moved);
        let mut at = match (&self.at, self.spacing, noisy) {
            (Some(at), ..) => at.clone(),
            (_, _, Some(noisy)) => {
                let total = noisy.at[points.len() - 1];
                noisy.at.into_iter().map(|t| T::from(t / total)).collect()
            }
            (None, spacing, None) => {
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
        // What parameters in order cannot absorb of the noise along the curve counts as squares.
        let goal = match self.goal {
            Goal::Near(b) => Goal::Near(b + 3.0 * moved / points.len() as f64),
            goal => goal,
        };
        let numbers = DataNumbers { points, tolerances, at: &at, demands: &self.conditions };
        let lengths = lengths.as_ref().map(|data| (data, &by_length[..]));
        let own_at = reals(&at);
        // A shape that no spline with knots at the data has may need some between them.
        let parts =
            if still && self.refines() { &INTERVAL_PARTS[..] } else { &INTERVAL_PARTS[..1] };
        let mut refused = None;
        for &parts in parts {
            let mut own = data.clone();
            if parts > 1 {
                own.layout = data.layout.refined(&own_at, &self.breaks, self.closed, parts)?;
            }
            let (own, shape) = own.shaped(&self.shape)?;
            let plane = shape.plane;
            match self.shaped(own, shape, (measure, goal, still), numbers, lengths) {
                Ok((data, made, fit)) => return Ok(NearCurve { data, of, made, fit, measure }),
                Err(error @ (FairError::Shape { .. } | FairError::Shapeless { .. })) => {
                    if let Some(certain) = data.refuted(plane, &self.shape) {
                        return Err(certain);
                    }
                    refused = Some(error);
                }
                Err(other) => return Err(other),
            }
        }
        Err(refused.unwrap_or(FairError::Singular))
    }

    /// True if all shapes are conditions that knots between the data can help to meet.
    fn refines(&self) -> bool {
        let runs = |s: &ShapeCondition| {
            matches!(s, ShapeCondition::Straight { .. } | ShapeCondition::Arc { .. })
        };
        !self.shape.is_empty() && !self.shape.iter().any(runs)
    }

    /// The curve of a shape on the layout of the data; `lengths` are the data by length with their parameters, if
    /// those of the data follow the turns.
    fn shaped(
        &self,
        data: Data,
        shape: ShapeConstraints,
        (measure, goal, still): (Measure, Goal, bool),
        numbers: DataNumbers<'_, T>,
        lengths: Option<(&Data, &[f64])>,
    ) -> Result<(Data, MovingFit<T>, DataFit), FairError> {
        let mut options = DataOptions::of(measure, goal);
        // Exact derivatives need to know which limits are reached; signs are not that exact.
        let least = if shape.is_empty() { ACCURACY } else { options.accuracy };
        options.accuracy = self.accuracy.unwrap_or(least);
        (options.shape, options.bends) = (shape, self.bends);
        options.bends |= measure == Measure::JumpLengths;
        let mut owners = Vec::new();
        if !self.conditions.is_empty() {
            let control = data.layout.through(&data.layout.data(&data.points))?;
            for (k, &(t, demand)) in self.conditions.iter().enumerate() {
                let all = demand.re().conditions(&data.layout.space, &control, t)?;
                owners.extend(std::iter::repeat_n(k, all.len()));
                options.conditions.extend(all);
            }
        }
        let own = |error: FairError| error.owned_by(&owners);
        if self.draft && still {
            let fit = data.drafted(&options).map_err(own)?;
            let made = MovingFit::still(&data.layout, &fit);
            return Ok((data, made, fit));
        }
        if !options.bends {
            let own_at: Vec<f64> = numbers.at.iter().map(|t| t.re()).collect();
            let turned = lengths.map(|(lengths, at)| TurnedFrom { lengths, own: &own_at, at });
            let (layout, fit) = fair_turned(&data, &options, turned).map_err(own)?;
            if still {
                let data = Data { layout: layout.unwrap_or_else(|| data.layout.clone()), ..data };
                let made = MovingFit::still(&data.layout, &fit);
                return Ok((data, made, fit));
            }
            // If no turn had to be removed, the result is the goal's own curve, which has
            // derivatives.
            let free = DataOptions { bends: true, ..options.clone() };
            let plain = fair_data(&data, &free).map_err(own)?;
            if layout.is_some() || plain.points != fit.points {
                return Err(FairError::NoDerivative(GATED));
            }
            options.bends = true;
        }
        let (made, fit) = fair_data_under(&data, &options, numbers).map_err(own)?;
        Ok((data, made, fit))
    }
}
