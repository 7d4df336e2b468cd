//! Kinds and functions of fairing for the model graph; they are rebuilt when their points change.

mod curve;
mod demands;
mod direct;
mod faired;
mod figures;
mod functions;
mod moving_surface;
mod net;
mod options;
mod patches;
mod shapes;
mod snake;
mod surface;
mod surface_demands;
mod surface_method;

use crate::words::{self, WordError};
use crate::{
    Bound, EndContinuity, FairError, Goal, Measure, Motion, ParameterSpacing, PointSpacing, Space,
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

/// Arguments that turn points into a fair spline.
pub(crate) struct Intent<T> {
    pub tolerance: T,
    pub degree: usize,
    pub closed: bool,
    /// `None`: the default for data or for control points.
    pub measure: Option<Measure>,
    /// Conditions at the start and the end; `None`: the default for data or for control points.
    pub ends: [Option<EndContinuity>; 2],
    /// Indices of intended breaks, from 1.
    pub breaks: Vec<usize>,
    /// Parameters of the points; uniform for control points and knot removal.
    pub spacing: ParameterSpacing,
    pub goal: Goal,
    pub motion: Motion,
}

/// Error for an unknown word of an option, at its argument.
pub(crate) fn unread(error: WordError, field: FieldId) -> CallError {
    let said = if error.id == "unknown-name" {
        format!("unknown {} \"{}\"", error.noun, error.found)
    } else {
        format!("the {} \"{}\" is not determined", error.noun, error.found)
    };
    CallError::new(error.id, said)
        .expected(error.expected)
        .found(format!("\"{}\"", error.found))
        .in_field(field)
}

/// Parametrisation of points called `name`.
pub(crate) fn spacing(name: &str, field: FieldId) -> Result<PointSpacing, CallError> {
    words::spacing(name).map_err(|e| unread(e, field))
}

/// As [`spacing`], without "auto" and "curvature".
pub(crate) fn plain_spacing(name: &str, field: FieldId) -> Result<ParameterSpacing, CallError> {
    match spacing(name, field)? {
        PointSpacing::Given(spacing) => Ok(spacing),
        _ => {
            let all: Vec<_> = words::SPACINGS
                .into_iter()
                .filter(|w| !matches!(*w, "auto" | "curvature"))
                .collect();
            Err(unknown("spacing", name, &all, field))
        }
    }
}

/// Default of `share`; 1 is the mean squared residual of noise that fills the tolerances evenly.
pub const BUDGET: f64 = 0.8;

/// Default share for networks parametrised by index. Measured on 36 networks of six hulls that the
/// measure does not describe: with this value the results of all are nearer to the truth; with
/// [`BUDGET`] those of 5 in 30 are not.
pub const NETWORK_BUDGET: f64 = 0.3;

/// Goal called `name` with its parameter `share`. The fields are those of both.
pub(crate) fn goal_of(
    name: &str,
    share: Option<f64>,
    budget: f64,
    [field, of_share]: [FieldId; 2],
) -> Result<Goal, CallError> {
    words::goal(name, share, budget).map_err(|e| {
        let at = if e.id == "no-share" { of_share } else { field };
        unread(e, at)
    })
}

/// Knots and weights given by the user.
#[derive(Clone, Default)]
pub(crate) struct GivenKnots {
    pub knots: Option<Vec<f64>>,
    pub weights: Option<Vec<f64>>,
    /// Period of the knots of a closed curve; `None`: 1.
    pub period: Option<f64>,
}

impl GivenKnots {
    /// Open space of `count` control points on the given knots, by default uniform ones without
    /// multiple ends.
    pub fn space(&self, degree: usize, count: usize) -> Result<Space, FairError> {
        let Some(knots) = &self.knots else {
            return if count < degree + 2 {
                Err(FairError::TooFew { expected: degree + 2, actual: count })
            } else {
                Space::floating(degree, count)
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

    /// Closed space of `count` control points.
    pub fn ring(&self, degree: usize, count: usize) -> Result<Space, FairError> {
        let Some(knots) = &self.knots else {
            return Space::periodic(
                degree,
                (0..count).map(|k| k as f64 / count as f64).collect(),
                1.0,
            );
        };
        if knots.len() != count {
            let (expected, actual) = (count, knots.len());
            return Err(FairError::Count { what: "knots", expected, actual });
        }
        Space::periodic(degree, knots.clone(), self.period.unwrap_or(1.0))
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum PointRole {
    /// The spline is interpolated through the points, then faired.
    Fit,
    /// The points are the control points of the spline.
    Control,
    /// The points are faired, then interpolated.
    Points,
}

/// Fields of the arguments that errors refer to.
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

pub(crate) fn role(name: &str, field: FieldId) -> Result<PointRole, CallError> {
    Ok(match name {
        "fit" => PointRole::Fit,
        "control" => PointRole::Control,
        "points" => PointRole::Points,
        _ => return Err(unknown("role of points", name, &["fit", "control", "points"], field)),
    })
}

pub(crate) fn measure(name: &str, field: FieldId) -> Result<Measure, CallError> {
    words::measure(name).map_err(|e| unread(e, field))
}

pub(crate) fn faithful(name: &str, field: FieldId) -> Result<bool, CallError> {
    match name {
        "optimum" => Ok(false),
        "faithful" => Ok(true),
        _ => Err(unknown("mode", name, &["optimum", "faithful"], field)),
    }
}

/// What the tolerance of points bounds: their moves, or those of the curves.
pub(crate) fn bound_of_points(name: &str, field: FieldId) -> Result<Bound, CallError> {
    match name {
        "points" => Ok(Bound::ControlPoints),
        "curve" => Ok(Bound::Bezier),
        _ => Err(unknown("bound", name, &["points", "curve"], field)),
    }
}

pub(crate) fn end(name: &str, field: FieldId) -> Result<EndContinuity, CallError> {
    words::end(name).map_err(|e| unread(e, field))
}

/// Motion from `along` and the word of `motion`; the fields are those of both.
pub(crate) fn motion<T: Real>(
    along: Option<Vec3<T>>,
    word: Option<&str>,
    [field, of_word]: [FieldId; 2],
) -> Result<Motion, CallError> {
    if let Some(direction) = along {
        options::constant("along", field, direction.to_array().into_iter())?;
        if direction.re().norm() == 0.0 {
            return Err(CallError::new("zero-direction", "the direction has no length")
                .expected("a direction such as {0, 1, 0}")
                .in_field(field));
        }
    }
    words::motion(along.map(|d| d.re()), word).map_err(|e| unread(e, of_word))
}

/// Converts an error to one at its argument.
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
            let number = index.wrapping_add(1);
            CallError::new("out-of-range", format!("there is no point {number}"))
                .expected(format!("numbers of points from 1 to {count}"))
                .found(number.to_string())
                .in_field(places.breaks)
        }
        FairError::Degree { expected, actual } => CallError::new("out-of-range", text)
            .expected(format!("degree {expected} or more for this measure"))
            .found(actual.to_string())
            .in_field(places.degree),
        FairError::NoDerivative(_) => {
            CallError::new("no-derivative", text).expected("constants").in_field(places.points)
        }
        _ => CallError::new("not-faired", text).in_field(places.points),
    }
}

/// Converts point numbers, from 1, to indices.
pub(crate) fn indices(numbers: &[usize], count: usize) -> Result<Vec<usize>, FairError> {
    let from_zero = |&b: &usize| match b.checked_sub(1) {
        Some(index) if index < count => Ok(index),
        index => Err(FairError::Mark { index: index.unwrap_or(usize::MAX), count }),
    };
    numbers.iter().map(from_zero).collect()
}

/// Distances between the points before and after.
pub(crate) fn moves<T: Real, U: Real>(
    after: &[Vec3<T>],
    before: &[Vec3<U>],
) -> impl Iterator<Item = f64> {
    after.iter().zip(before).map(|(p, q)| (p.re() - q.re()).norm())
}
