//! Fairing in the graph: the kinds that store an intent and run again when their points change.

mod curve;
mod demands;
mod figures;
mod functions;
mod moving_surface;
mod net;
mod patches;
mod shapes;
mod snake;
mod surface;
mod surface_demands;
mod surface_method;

use crate::curve::condition::{end_jet, joined};
use crate::kinds::figures::FairFigures;
use crate::{
    Bound, Condition, EndContinuity, FairError, Goal, Job, KnotRemovalOptions, Limit, Measure,
    Motion, Optimum, OptimumOptions, ParameterSpacing, Space, interpolate_with_corners, is_exact,
    knot_removal, optimum_with, replay_with,
};
use moldloft_num::{Real, Vec3};
use moldloft_registry::export::StaticRow;
use moldloft_registry::{CallError, FieldId, Row};
use moldloft_spline::KnotVector;

/// All kinds and functions of this crate, in the order of the reference.
///
/// # Example
/// ```
/// let rows = moldloft_fair::rows();
/// assert!(rows.iter().any(|row| row.name == "FairCurve"));
/// ```
pub fn rows() -> Vec<Row> {
    vec![
        curve::FairCurve::<f64>::row(),
        snake::FairSnake::<f64>::row(),
        surface::FairSurf::<f64>::row(),
        net::FairNet::<f64>::row(),
        net::NetCurve::<f64>::row(),
        patches::FairPatches::<f64>::row(),
        patches::NetSurf::<f64>::row(),
        functions::Fair::<f64>::row(),
        functions::Jumps::<f64>::row(),
        functions::Curvature::<f64>::row(),
    ]
}

/// The certified gap of the kinds: as small as rounding allows, so that which limits are reached is
/// decided and derivatives are those of the optimum itself.
pub(crate) const ACCURACY: f64 = 1e-13;

/// How points become a fair spline: what the arguments of the kinds say.
pub(crate) struct Intent<T> {
    pub tolerance: T,
    pub degree: usize,
    pub closed: bool,
    pub role: PointRole,
    pub measure: Measure,
    pub faithful: bool,
    pub end: EndContinuity,
    /// Intended breaks, from 1.
    pub breaks: Vec<usize>,
    /// First and second derivative of what the curve runs on from, at its start and end, by a
    /// parameter that runs as its own.
    pub joins: [Option<[Vec3<T>; 2]>; 2],
    /// Knots of the control points, and their weights, which stay.
    pub own: GivenKnots,
    /// How points get their parameters; the index for control points and knot removal.
    pub spacing: ParameterSpacing,
    /// Whether parameters run faster where the curve turns.
    pub turning: bool,
    /// Which of the curves within the tolerances is wanted.
    pub goal: Goal,
    /// The directions in which points may move.
    pub motion: Motion,
}

/// The way in which points get their parameters that is called `name`.
pub(crate) fn spacing(name: &str, field: FieldId) -> Result<ParameterSpacing, CallError> {
    let axis = |x, y, z| ParameterSpacing::Along(Vec3::of(x, y, z));
    Ok(match name {
        "chord" => ParameterSpacing::Chord,
        "centripetal" => ParameterSpacing::Centripetal,
        "index" => ParameterSpacing::Uniform,
        "x" => axis(1.0, 0.0, 0.0),
        "y" => axis(0.0, 1.0, 0.0),
        "z" => axis(0.0, 0.0, 1.0),
        _ => {
            let all = ["chord", "centripetal", "x", "y", "z", "index"];
            return Err(unknown("spacing", name, &all, field));
        }
    })
}

/// The budget of the goals: 1 is what noise takes that fills the tolerances evenly.
pub(crate) const BUDGET: f64 = 0.8;

/// The same of networks whose hull the measure does not have: of 36 networks of six hulls all come
/// nearer to the truth with it, and 5 of 30 do not with that of curves.
pub const NETWORK_BUDGET: f64 = 0.3;

/// The goal called `name` with its share; the fields of both.
pub(crate) fn goal_of(
    name: &str,
    share: Option<f64>,
    budget: f64,
    [field, of_share]: [FieldId; 2],
) -> Result<Goal, CallError> {
    let needed = || {
        CallError::new("no-share", "the goal \"energy\" has a largest measure")
            .expected("share = the measure")
            .in_field(of_share)
    };
    Ok(match name {
        "near" => Goal::Near(share.unwrap_or(budget)),
        "budget" => Goal::Budget(share.unwrap_or(budget)),
        "fairest" => Goal::Fairest,
        "nearest" => Goal::Nearest(share.unwrap_or(0.1)),
        "energy" => Goal::Energy(share.ok_or_else(needed)?),
        "closest" => Goal::Closest,
        _ => {
            let all = ["near", "budget", "fairest", "nearest", "energy", "closest"];
            return Err(unknown("goal", name, &all, field));
        }
    })
}

/// Knots and weights of the user's.
#[derive(Clone, Default)]
pub(crate) struct GivenKnots {
    pub knots: Option<Vec<f64>>,
    pub weights: Option<Vec<f64>>,
}

impl GivenKnots {
    /// The space of `count` control points on its knots, or on uniform ones.
    pub fn space(&self, degree: usize, count: usize) -> Result<Space, FairError> {
        let Some(knots) = &self.knots else {
            return if count < degree + 2 {
                Err(FairError::TooFew { expected: degree + 2, actual: count })
            } else {
                Space::clamped(degree, count)
            };
        };
        let (expected, actual) = (count + degree + 1, knots.len());
        if expected != actual {
            return Err(FairError::Count { what: "knots", expected, actual });
        }
        if let Some(index) =
            knots.windows(2).position(|w| w[0] > w[1] || w[0].is_nan() || w[1].is_nan())
        {
            return Err(FairError::Unsorted { index: index + 1 });
        }
        Space::open(KnotVector::new(degree, knots.clone())?)
    }
}

/// What the given points are.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum PointRole {
    /// Points that the spline passes through before it is faired.
    Fit,
    /// Control points.
    Control,
    /// Points that are faired themselves, and then interpolated.
    Points,
}

/// The places of the arguments that can be at fault.
#[derive(Clone, Copy)]
pub(crate) struct ArgumentFields {
    pub points: FieldId,
    pub tolerance: FieldId,
    pub degree: FieldId,
    pub breaks: FieldId,
}

fn unknown(noun: &str, found: &str, all: &[&str], field: FieldId) -> CallError {
    let all: Vec<_> = all.iter().map(|n| format!("\"{n}\"")).collect();
    CallError::new("unknown-name", format!("unknown {noun} \"{found}\""))
        .expected(all.join(", "))
        .found(format!("\"{found}\""))
        .in_field(field)
}

/// The role called `name`, an argument in `field`.
pub(crate) fn role(name: &str, field: FieldId) -> Result<PointRole, CallError> {
    Ok(match name {
        "fit" => PointRole::Fit,
        "control" => PointRole::Control,
        "points" => PointRole::Points,
        _ => return Err(unknown("role of points", name, &["fit", "control", "points"], field)),
    })
}

/// The measure called `name`.
pub(crate) fn measure(name: &str, field: FieldId) -> Result<Measure, CallError> {
    let all = Measure::ALL.map(Measure::name);
    Measure::named(name).ok_or_else(|| unknown("measure", name, &all, field))
}

/// True for the mode "faithful", false for "optimum".
pub(crate) fn faithful(name: &str, field: FieldId) -> Result<bool, CallError> {
    match name {
        "optimum" => Ok(false),
        "faithful" => Ok(true),
        _ => Err(unknown("mode", name, &["optimum", "faithful"], field)),
    }
}

/// The end condition called `name`.
pub(crate) fn end(name: &str, field: FieldId) -> Result<EndContinuity, CallError> {
    let all = ["free", "position", "tangent", "curvature"];
    EndContinuity::named(name).ok_or_else(|| unknown("end condition", name, &all, field))
}

/// A refusal as a fault at its argument.
pub(crate) fn fault(error: FairError, places: &ArgumentFields) -> CallError {
    let text = error.to_string();
    match error {
        FairError::TooFew { expected, actual } => CallError::new("too-few-items", text)
            .expected(format!("at least {expected} points"))
            .found(actual.to_string())
            .in_field(places.points),
        FairError::Range { .. } => CallError::new("out-of-range", text).in_field(places.points),
        FairError::NotFinite { index } => {
            CallError::new("not-finite", text).in_item(index).in_field(places.points)
        }
        FairError::Coincident { first } => {
            CallError::new("coincident-points", text).in_item(first + 1).in_field(places.points)
        }
        FairError::Tolerance { value } => CallError::new("out-of-range", text)
            .expected("a tolerance of at least 0")
            .found(value.to_string())
            .in_field(places.tolerance),
        FairError::Mark { index, count } => {
            CallError::new("out-of-range", format!("there is no point {}", index + 1))
                .expected(format!("numbers of points from 1 to {count}"))
                .found((index + 1).to_string())
                .in_field(places.breaks)
        }
        FairError::Degree { expected, actual } => CallError::new("out-of-range", text)
            .expected(format!("degree {expected} or more for this measure"))
            .found(actual.to_string())
            .in_field(places.degree),
        _ => CallError::new("not-faired", text).in_field(places.points),
    }
}

/// Numbers of points, from 1, as indices.
pub(crate) fn indices(numbers: &[usize], count: usize) -> Result<Vec<usize>, FairError> {
    let from_zero = |&b: &usize| match b.checked_sub(1) {
        Some(index) if index < count => Ok(index),
        index => Err(FairError::Mark { index: index.unwrap_or(usize::MAX - 1), count }),
    };
    numbers.iter().map(from_zero).collect()
}

/// Points that moved, and the optimum that they are.
type Moved<T> = (Vec<Vec3<T>>, Option<Optimum>);

/// How far points moved.
pub(crate) fn moves<T: Real, U: Real>(
    after: &[Vec3<T>],
    before: &[Vec3<U>],
) -> impl Iterator<Item = f64> {
    after.iter().zip(before).map(|(p, q)| (p.re() - q.re()).norm())
}

impl<T: Real> Intent<T> {
    /// The faired spline of points.
    ///
    /// Its figures are those of what moves: control points, or the points themselves.
    pub fn spline(
        &self,
        points: &[Vec3<T>],
    ) -> Result<(Space, Vec<Vec3<T>>, FairFigures), FairError> {
        let n = points.len();
        let marks = indices(&self.breaks, n)?;
        let fitted = |points: &[Vec3<T>]| {
            interpolate_with_corners(
                self.degree,
                points,
                ParameterSpacing::Uniform,
                self.closed,
                &marks,
            )
        };
        let stays = self.stays(points, &marks);
        match self.role {
            PointRole::Control => {
                let space = if self.closed {
                    let knots = (0..n).map(|k| k as f64 / n as f64).collect();
                    Space::periodic(self.degree, knots, 1.0)?
                } else {
                    self.own.space(self.degree, n)?
                };
                if stays {
                    return Ok((
                        space,
                        points.to_vec(),
                        FairFigures::of_moves([].into_iter(), None),
                    ));
                }
                let (faired, best) = self.within(&space, points, Bound::Bezier, marks)?;
                let figures = FairFigures::of_moves(moves(&faired, points), best.as_ref());
                Ok((space, faired, figures))
            }
            PointRole::Fit => {
                let sharp = fitted(points)?;
                let space = sharp.fit.space;
                if stays {
                    return Ok((space, sharp.points, FairFigures::of_moves([].into_iter(), None)));
                }
                let (faired, best) =
                    self.within(&space, &sharp.points, Bound::Bezier, sharp.marks)?;
                let figures = FairFigures::of_moves(moves(&faired, &sharp.points), best.as_ref());
                Ok((space, faired, figures))
            }
            PointRole::Points => {
                if stays {
                    let sharp = fitted(points)?;
                    let figures = FairFigures::of_moves([].into_iter(), None);
                    return Ok((sharp.fit.space, sharp.points, figures));
                }
                let (faired, best) = self.faired_points(points)?;
                let figures = FairFigures::of_moves(moves(&faired, points), best.as_ref());
                let sharp = fitted(&faired)?;
                Ok((sharp.fit.space, sharp.points, figures))
            }
        }
    }

    /// Whether points stay: exact ones are as fair as can be, and what is near them is they themselves.
    pub fn stays(&self, points: &[Vec3<T>], marks: &[usize]) -> bool {
        let plain: Vec<Vec3<f64>> = points.iter().map(|p| p.re()).collect();
        let free = self.own.weights.is_none() && self.joins.iter().all(Option::is_none);
        free && matches!(self.goal, Goal::Near(_)) && is_exact(&plain, marks, self.closed)
    }

    /// Points, faired with a bound on each of them: as the control points of a uniform spline, for
    /// which interpolation and the measures commute.
    pub fn faired_points(&self, points: &[Vec3<T>]) -> Result<Moved<T>, FairError> {
        let (n, degree) = (points.len(), self.degree);
        let space = if self.closed {
            Space::closed(degree, n)?
        } else if n < degree + 2 {
            return Err(FairError::TooFew { expected: degree + 2, actual: n });
        } else {
            Space::floating(degree, n)?
        };
        // What an end keeps is counted in points: with tangents, two of them.
        let end = match self.end {
            EndContinuity::Points(k) => k,
            end => end.kept(),
        };
        let (breaks, own) = (self.breaks.clone(), self.own.clone());
        let held = Self { end: EndContinuity::Points(end), breaks, own, ..*self };
        held.within(&space, points, Bound::ControlPoints, indices(&self.breaks, n)?)
    }

    fn within(
        &self,
        space: &Space,
        points: &[Vec3<T>],
        bound: Bound,
        marks: Vec<usize>,
    ) -> Result<Moved<T>, FairError> {
        let n = points.len();
        let mut job = Job {
            space: space.clone(),
            points: points.iter().map(|p| p.re()).collect(),
            weights: self.own.weights.clone(),
            limit: Limit::new(self.motion, vec![self.tolerance.re(); n])?,
            marks,
            ends: [self.end; 2],
        };
        let (mut conditions, mut targets) = (Vec::new(), Vec::new());
        for (at, other) in self.joins.iter().enumerate() {
            let Some(other) = other else { continue };
            job.ends[at] = EndContinuity::Position;
            let plain = other.map(|v| v.re());
            conditions.extend(Condition::join(space, &job.points, at == 1, plain)?);
            let aims = joined(end_jet(space, points, at == 1), *other)?;
            targets.extend(aims.iter().flat_map(|v| v.to_array()));
        }
        let tolerances = vec![self.tolerance; n];
        if self.faithful {
            let mut options = KnotRemovalOptions::faithful(n);
            options.log = true;
            let steps = knot_removal(&job, &options)?;
            Ok((replay_with(&job, &options, &steps.log, points, &tolerances)?, None))
        } else {
            let mut options = OptimumOptions::of(self.measure);
            options.bound = bound;
            options.accuracy = ACCURACY;
            options.conditions = conditions;
            let best = optimum_with(&job, &options, points, &tolerances, &targets)?;
            Ok((best.0, Some(best.1)))
        }
    }
}
