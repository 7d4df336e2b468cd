//! Curves faired by moving control points: parametrised by index, with a bound on the whole curve,
//! with given knots or number of control points, or step by step.

use super::figures::FairFigures;
use super::{GivenKnots, Intent, PointRole, indices, moves};
use crate::curve::condition::{end_jet, joined};
use crate::curve::request::ACCURACY;
use crate::{
    Bound, Certificate, Condition, Demand, EndContinuity, FairError, Goal, Job, KnotRemovalOptions,
    Limit, Measure, OptimumOptions, ParameterSpacing, RowNorm, Space, ball_gap, fit, fit_rational,
    interpolate, interpolate_with_corners, is_exact, knot_removal, least_squares, multilevel,
    optimum_with, parameters, parameters_with, replay_with, shape, sweeps,
};
use moldloft_num::{Real, Vec3};

/// Algorithm that moves the control points.
#[derive(Clone, Copy, Debug)]
pub(crate) enum CurveMethod {
    Optimum,
    /// Single steps; default: one per point.
    Steps(KnotRemovalOptions, Option<usize>),
    /// Number of sweeps over all points.
    Sweeps(usize),
    /// Number of multilevel cycles.
    Levels(usize),
}

pub(crate) struct DirectCurve<T> {
    pub intent: Intent<T>,
    pub role: PointRole,
    pub method: CurveMethod,
    /// Quantity that the tolerance bounds; `None`: the default of the role.
    pub bound: Option<Bound>,
    /// First and second derivative of the curve to continue at the start and the end, with respect
    /// to a parameter of the same direction.
    pub joins: [Option<[Vec3<T>; 2]>; 2],
    /// Given knots and weights; not changed.
    pub own: GivenKnots,
    /// Number of control points of a least-squares fit.
    pub count: Option<usize>,
    pub tolerances: Option<Vec<T>>,
    /// Numbers, from 1, of points that do not move.
    pub fixed: Vec<usize>,
    pub conditions: Vec<(f64, Demand<T>)>,
}

pub(crate) struct DirectResult<T> {
    pub space: Space,
    pub control: Vec<Vec3<T>>,
    pub figures: FairFigures,
}

struct SplineToFair<T> {
    space: Space,
    control: Vec<Vec3<T>>,
    marks: Vec<usize>,
    /// Parameters of the points on it.
    at: Option<Vec<f64>>,
    /// True for a least-squares fit, which need not interpolate the points.
    beside: bool,
}

/// Moved points, certificate, and the number of active tolerances (optimum) or of steps.
struct MovedControlPoints<T> {
    points: Vec<Vec3<T>>,
    certificate: Option<Certificate>,
    active: Option<usize>,
    steps: Option<usize>,
}

const MOVING_KNOTS: &str = "no derivatives are available for a bound on the curve or for steps if \
the parameters depend on the points: use spacing \"index\"";
const FITTED: &str = "no derivatives are available for least-squares fits and fits with given \
knots: state neither count nor knots";
const STEPS: &str =
    "no derivatives are available for sweeps, levels, and steps with weights: use the optimum";
const CONDITIONS: &str =
    "no derivatives are available for curves with conditions: remove the conditions";

/// Largest residual, relative to the extent, at which a fit counts as interpolation.
const THROUGH: f64 = 1e-9;

impl<T: Real> DirectCurve<T> {
    /// The faired spline of points.
    ///
    /// The deviation is the largest move of a control point or point; for fits with given knots or
    /// number of control points, the largest distance of a point from the curve.
    pub fn made(&self, points: &[Vec3<T>]) -> Result<DirectResult<T>, FairError> {
        let n = points.len();
        let plain: Vec<Vec3<f64>> = points.iter().map(|p| p.re()).collect();
        crate::error::check_finite(&plain)?;
        let marks = indices(&self.intent.breaks, n)?;
        let stays = self.stays(&plain, &marks);
        if self.role == PointRole::Points {
            let faired = if stays { None } else { Some(self.moved_points(points)?) };
            let after = faired.as_ref().map_or(points, |m| &m.points);
            let figures = FairFigures::of_moves(moves(after, points), None);
            let sharp = self.through(after, ParameterSpacing::Uniform, &marks)?;
            let figures = faired.map_or(figures, |m| m.figures(points));
            return Ok(DirectResult { space: sharp.space, control: sharp.control, figures });
        }
        let laid = match self.role {
            PointRole::Control => self.controlled(points, marks)?,
            _ => self.fitted(points, &plain, &marks)?,
        };
        let each = self.each(&laid, &plain)?;
        let off = |control: &[Vec3<T>]| {
            let real: Vec<Vec3<f64>> = control.iter().map(|p| p.re()).collect();
            let weights = self.own.weights.as_deref();
            let far = |(&t, p): (&f64, &Vec3<f64>)| {
                (shape::sample_at(&laid.space, &real, weights, t).point - *p).norm()
            };
            let at = laid.at.as_ref().filter(|_| laid.beside)?;
            Some(at.iter().zip(&plain).map(far).fold(0.0, f64::max))
        };
        if stays {
            let mut figures = FairFigures::of_moves([].into_iter(), None);
            figures.deviation = off(&laid.control).unwrap_or(0.0);
            return Ok(DirectResult { space: laid.space, control: laid.control, figures });
        }
        let moved = self.within(&laid, &each)?;
        let mut figures = moved.figures(&laid.control);
        if let Some(off) = off(&moved.points) {
            figures.deviation = off;
        }
        Ok(DirectResult { space: laid.space, control: moved.points, figures })
    }

    /// True if the points are exact (line, conic, …) and the goal is "near": they are then already
    /// fair.
    pub fn stays(&self, plain: &[Vec3<f64>], marks: &[usize]) -> bool {
        let free = self.own.weights.is_none()
            && self.conditions.is_empty()
            && self.joins.iter().all(Option::is_none);
        free && matches!(self.intent.goal, Goal::Near(_))
            && is_exact(plain, marks, self.intent.closed)
    }

    /// The points faired as control points of a uniform spline, for which interpolation and the
    /// measures commute.
    pub fn faired_points(&self, points: &[Vec3<T>]) -> Result<Vec<Vec3<T>>, FairError> {
        Ok(self.moved_points(points)?.points)
    }

    fn moved_points(&self, points: &[Vec3<T>]) -> Result<MovedControlPoints<T>, FairError> {
        let (n, degree) = (points.len(), self.intent.degree);
        let space = if self.intent.closed {
            Space::closed(degree, n)?
        } else if n < degree + 2 {
            return Err(FairError::TooFew { expected: degree + 2, actual: n });
        } else {
            Space::floating(degree, n)?
        };
        let marks = indices(&self.intent.breaks, n)?;
        let laid = SplineToFair { space, control: points.to_vec(), marks, at: None, beside: false };
        let each = self.each(&laid, &[])?;
        self.within(&laid, &each)
    }

    /// The given points as control points.
    fn controlled(
        &self,
        points: &[Vec3<T>],
        marks: Vec<usize>,
    ) -> Result<SplineToFair<T>, FairError> {
        let (degree, n) = (self.intent.degree, points.len());
        let space = if self.intent.closed {
            self.own.ring(degree, n)?
        } else {
            self.own.space(degree, n)?
        };
        Ok(SplineToFair { space, control: points.to_vec(), marks, at: None, beside: false })
    }

    /// Interpolating spline with corners at marks.
    fn through(
        &self,
        points: &[Vec3<T>],
        spacing: ParameterSpacing,
        marks: &[usize],
    ) -> Result<SplineToFair<T>, FairError> {
        let (degree, closed) = (self.intent.degree, self.intent.closed);
        let sharp = interpolate_with_corners(degree, points, spacing, closed, marks)?;
        Ok(SplineToFair {
            space: sharp.fit.space,
            control: sharp.points,
            marks: sharp.marks,
            at: Some(sharp.at),
            beside: false,
        })
    }

    /// Interpolating spline, or a least-squares fit.
    fn fitted(
        &self,
        points: &[Vec3<T>],
        plain: &[Vec3<f64>],
        marks: &[usize],
    ) -> Result<SplineToFair<T>, FairError> {
        let (degree, closed) = (self.intent.degree, self.intent.closed);
        let spacing = self.intent.spacing;
        let own = self.own.knots.is_some() || self.own.weights.is_some();
        let moving = || points.iter().flat_map(|p| p.to_array()).any(|x| !x.is_constant());
        let loose = || {
            let each = self.tolerances.iter().flatten().copied();
            each.chain([self.intent.tolerance]).any(|x| !x.is_constant())
        };
        if !own && self.count.is_none() {
            if spacing != ParameterSpacing::Uniform
                && moving()
                && !parameters_with(points, spacing, closed)?.iter().all(|t| t.is_constant())
            {
                return Err(FairError::NoDerivative(MOVING_KNOTS));
            }
            return self.through(points, spacing, marks);
        }
        if moving() || loose() {
            return Err(FairError::NoDerivative(FITTED));
        }
        let made = if own {
            let count = match &self.own.knots {
                Some(knots) if closed => knots.len(),
                Some(knots) => knots.len().saturating_sub(degree + 1),
                None => plain.len(),
            };
            if !(degree + 2..=plain.len()).contains(&count) {
                let (expected, actual) = (plain.len() + degree + 1, count + degree + 1);
                return Err(FairError::Count { what: "knots at most", expected, actual });
            }
            let space = match &self.own.knots {
                None => interpolate(degree, plain, spacing, closed)?.space,
                Some(_) if closed => self.own.ring(degree, count)?,
                Some(_) => self.own.space(degree, count)?,
            };
            let (a, b) = space.domain();
            let at = parameters(plain, spacing, closed)?;
            let at = at.into_iter().map(|t| a + (b - a) * t).collect();
            match &self.own.weights {
                Some(weights) => fit_rational(space, plain, at, weights)?,
                None => fit(space, plain, at, &vec![1.0; plain.len()])?,
            }
        } else {
            least_squares(degree, plain, self.count.unwrap_or(plain.len()), spacing, closed)?
        };
        let control = made.points.iter().map(|&p| Vec3::lifted(p)).collect();
        Ok(SplineToFair {
            space: made.space,
            control,
            marks: Vec::new(),
            at: Some(made.parameters),
            beside: true,
        })
    }

    /// Tolerance of each control point; for fits, the tolerance that remains at the points near it.
    fn each(&self, laid: &SplineToFair<T>, plain: &[Vec3<f64>]) -> Result<Vec<T>, FairError> {
        let n = laid.control.len();
        let mut own = match (&self.tolerances, &laid.at) {
            (None, _) => vec![self.intent.tolerance; n],
            (Some(each), Some(at)) => near(&laid.space, at, each),
            (Some(each), None) => each.clone(),
        };
        if let Some(at) = laid.at.as_ref().filter(|_| laid.beside) {
            // The residual of a fit is subtracted from the tolerance.
            let given = match &self.tolerances {
                Some(each) => each.iter().map(|t| t.re()).collect(),
                None => vec![self.intent.tolerance.re(); plain.len()],
            };
            let real: Vec<Vec3<f64>> = laid.control.iter().map(|p| p.re()).collect();
            let weights = self.own.weights.as_deref();
            let far = |(&t, p): (&f64, &Vec3<f64>)| {
                (shape::sample_at(&laid.space, &real, weights, t).point - *p).norm()
            };
            let off: Vec<f64> = at.iter().zip(plain).map(far).collect();
            let size = plain.iter().map(|p| (*p - plain[0]).norm()).fold(0.0, f64::max);
            let passes = off.iter().all(|&o| o <= THROUGH * size);
            let left: Vec<f64> =
                given.iter().zip(&off).map(|(t, o)| if passes { *t } else { t - o }).collect();
            let worst = (0..left.len()).min_by(|&a, &b| left[a].total_cmp(&left[b]));
            if let Some(index) = worst.filter(|&k| left[k] < 0.0) {
                return Err(FairError::OutOfReach { index, distance: off[index] });
            }
            own = near(&laid.space, at, &left).into_iter().map(T::from).collect();
        }
        for k in indices(&self.fixed, own.len())? {
            own[k] = T::zero();
        }
        Ok(own)
    }

    /// The fairest control points within the tolerances.
    fn within(
        &self,
        laid: &SplineToFair<T>,
        tolerances: &[T],
    ) -> Result<MovedControlPoints<T>, FairError> {
        let SplineToFair { space, control: points, .. } = laid;
        let mut job = self.job(laid, tolerances)?;
        let (mut conditions, mut targets, mut owners) = (Vec::new(), Vec::new(), Vec::new());
        let joined_ends = self.joins.iter().enumerate();
        let joined_ends = joined_ends.filter_map(|(at, other)| other.as_ref().map(|o| (at, o)));
        for (k, (at, other)) in joined_ends.enumerate() {
            job.ends[at] = EndContinuity::Position;
            let plain = other.map(|v| v.re());
            conditions.extend(Condition::join(space, &job.points, at == 1, plain)?);
            owners.resize(conditions.len(), self.conditions.len() + k);
            let aims = joined(end_jet(space, points, at == 1), *other)?;
            targets.extend(aims.iter().flat_map(|v| v.to_array()));
        }
        let still = points.iter().flat_map(|p| p.to_array()).all(|x| x.is_constant())
            && tolerances.iter().chain(&targets).all(|x| x.is_constant());
        if !self.conditions.is_empty() && !still {
            return Err(FairError::NoDerivative(CONDITIONS));
        }
        for (k, &(t, demand)) in self.conditions.iter().enumerate() {
            conditions.extend(demand.re().conditions(space, &job.points, t)?);
            owners.resize(conditions.len(), k);
        }
        match self.method {
            CurveMethod::Optimum => {
                let mut options = OptimumOptions::of(self.measure());
                options.bound = self.bound.unwrap_or(match self.role {
                    PointRole::Fit => Bound::Bezier,
                    _ => Bound::ControlPoints,
                });
                options.accuracy = ACCURACY;
                options.conditions = conditions;
                let made = optimum_with(&job, &options, points, tolerances, &targets);
                let (points, best) = made.map_err(|error| error.owned_by(&owners))?;
                let (certificate, active) = (Some(best.certificate), Some(best.active));
                Ok(MovedControlPoints { points, certificate, active, steps: None })
            }
            CurveMethod::Steps(options, steps) => {
                self.stepped(&job, (options, steps), points, tolerances, still)
            }
            CurveMethod::Sweeps(count) | CurveMethod::Levels(count) => {
                self.swept(&job, count, still)
            }
        }
    }

    fn measure(&self) -> Measure {
        self.intent.measure.unwrap_or(Measure::Second)
    }

    /// The control points with their limits and the conditions at the ends.
    fn job(&self, laid: &SplineToFair<T>, tolerances: &[T]) -> Result<Job, FairError> {
        // For `as = "points"` an end condition counts fixed points: 2 for "tangent".
        let end = |end: EndContinuity| match (self.role, end) {
            (PointRole::Points, EndContinuity::Points(k)) => EndContinuity::Points(k),
            (PointRole::Points, end) => EndContinuity::Points(end.kept()),
            (_, end) => end,
        };
        let default = EndContinuity::of_control(self.role == PointRole::Fit);
        let radii = tolerances.iter().map(|t| t.re()).collect();
        Ok(Job {
            space: laid.space.clone(),
            points: laid.control.iter().map(|p| p.re()).collect(),
            weights: self.own.weights.clone(),
            limit: Limit::new(self.intent.motion, radii)?,
            marks: laid.marks.clone(),
            ends: self.intent.ends.map(|e| end(e.unwrap_or(default))),
        })
    }

    /// Faired by single steps; `still` is true if nothing carries a derivative.
    fn stepped(
        &self,
        job: &Job,
        (mut options, steps): (KnotRemovalOptions, Option<usize>),
        points: &[Vec3<T>],
        tolerances: &[T],
        still: bool,
    ) -> Result<MovedControlPoints<T>, FairError> {
        let measure = self.measure();
        if measure.norm() != RowNorm::Square {
            return Err(FairError::Squares);
        }
        if job.weights.is_some() && !still {
            return Err(FairError::NoDerivative(STEPS));
        }
        options.measure = measure;
        options.stops.steps = steps.unwrap_or(points.len());
        options.log = true;
        let made = knot_removal(job, &options)?;
        let points = if still {
            made.points.iter().map(|&p| Vec3::lifted(p)).collect()
        } else {
            replay_with(job, &options, &made.log, points, tolerances)?
        };
        let certificate = Some(squares_gap(job, measure, &made.points)?);
        Ok(MovedControlPoints { points, certificate, active: None, steps: Some(made.steps) })
    }

    /// Faired by sweeps or multilevel cycles; `still` is true if nothing carries a derivative.
    fn swept(
        &self,
        job: &Job,
        count: usize,
        still: bool,
    ) -> Result<MovedControlPoints<T>, FairError> {
        let measure = self.measure();
        if measure.norm() != RowNorm::Square {
            return Err(FairError::Squares);
        }
        if !still {
            return Err(FairError::NoDerivative(STEPS));
        }
        let points = match self.method {
            CurveMethod::Sweeps(_) => sweeps(job, measure, count)?,
            _ => multilevel(job, measure, count, u32::BITS)?,
        };
        let certificate = Some(squares_gap(job, measure, &points)?);
        let points = points.into_iter().map(Vec3::lifted).collect();
        Ok(MovedControlPoints { points, certificate, active: None, steps: Some(count) })
    }
}

/// The optimality gap of control points for a measure that is a sum of squares.
fn squares_gap(
    job: &Job,
    measure: Measure,
    points: &[Vec3<f64>],
) -> Result<Certificate, FairError> {
    Ok(ball_gap(job, &job.measure_rows(measure)?, RowNorm::Square, points))
}

impl<T: Real> MovedControlPoints<T> {
    fn figures(&self, before: &[Vec3<T>]) -> FairFigures {
        let made = self.certificate.as_ref().map(|c| (c, self.active, self.steps));
        FairFigures::of_moves(moves(&self.points, before), made)
    }
}

/// Converts tolerances of data to control points: the minimum over the data in the support of each;
/// the overall minimum for a support without data.
fn near<T: Real>(space: &Space, at: &[f64], tolerances: &[T]) -> Vec<T> {
    let less = |a: T, b: T| if b.re() < a.re() { b } else { a };
    let all = tolerances.iter().copied().reduce(less).unwrap_or_else(T::zero);
    let mut out = vec![None; space.count()];
    for (&t, &own) in at.iter().zip(tolerances) {
        let (k, _) = space.locate(t);
        for c in space.columns(k) {
            out[c] = Some(out[c].map_or(own, |a| less(a, own)));
        }
    }
    out.into_iter().map(|x| x.unwrap_or(all)).collect()
}
