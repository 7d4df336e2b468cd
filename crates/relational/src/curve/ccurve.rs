//! Interpolating splines through points.

use super::bcurve;
use crate::arguments::EndRule;
use crate::curve::Ended;
use crate::curve::ended::polyline;
use crate::faults;
use moldloft_num::trace::Trace;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, FieldId, Kind, Point, Value};
use moldloft_spline::{End, Ends, InterpolatingSpline};

/// The twice differentiable piecewise cubic interpolating spline through points, with knots at the
/// cumulative chord lengths (Ahlberg, Nilson and Walsh 1967).
///
/// With the default ends two points give a line, three a parabola, four or more a spline without
/// knots at the second and the last but one point (not-a-knot). Neighbouring points must differ.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel degree points",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); \
               AbsPoint E(6, 0.5, 2); CCurve c({A, B, C, D, E}); \
               CCurve d({A, B, C, D}, ends = \"clamped\", start = {3, 1, 0}, end = {4, -2, 1});"
)]
pub struct CCurve<T: Real> {
    /// Points of the curve, at least 2; neighbouring points must differ.
    #[field(min_items = 2)]
    points: Vec<Point<T>>,
    /// 3: cubic spline. 1: polyline, without end conditions. 2: the same as 3, for at most three
    /// points.
    #[field(default = 3, min = 1, max = 3)]
    degree: usize,
    /// Conditions at both ends: "notaknot", "natural" (zero second derivative), "bessel" (slope of
    /// the parabola through the three nearest points), "quadratic" (the end piece is a parabola),
    /// "clamped" (slopes `start` and `end`) or "periodic" (closed; the last point equals the first,
    /// at least 4 points).
    #[field(default = "notaknot")]
    ends: EndRule,
    /// Slope dC/dt at the start, for clamped ends.
    start: Option<Vec3<T>>,
    /// Slope dC/dt at the end, for clamped ends.
    end: Option<Vec3<T>>,
}

impl<T: Real> CCurve<T> {
    /// The spline through points that are no objects.
    pub fn through(points: &[Vec3<T>], degree: usize) -> Self {
        let points = points.iter().map(|p| Point::free(*p)).collect();
        Self { points, degree, ends: EndRule::NotAKnot, start: None, end: None }
    }
}

impl<T: Real> Build<T> for CCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let names = bcurve::ends(&self.points, Self::POINTS)?;
        let ends = clamped_ends(self.ends, self.start, self.end, [Self::START, Self::END])?;
        let points: Vec<_> = self.points.iter().map(|p| p.xyz).collect();
        let curve = match self.degree {
            1 => InterpolatingSpline::polyline(&points),
            2 if points.len() > 3 => InterpolatingSpline::of_type(2, &points),
            _ => InterpolatingSpline::with_ends(&points, ends),
        }
        .map_err(|error| {
            faults::of_interpolation(error, "point", [Self::POINTS, Self::DEGREE, Self::ENDS])
        })?;
        let trace = match self.degree {
            1 => polyline(&self.points, curve.knots()[1..].to_vec()),
            _ => Trace::Own(names),
        };
        Ok(Value::Curve(CurveRef::new(Ended { curve, trace }, 0)))
    }
}

/// The conditions of a rule with these slopes, which are those of `fields`.
///
/// # Errors
/// A fault when clamped ends have no slopes, or others have.
pub fn clamped_ends<T: Real>(
    rule: EndRule,
    start: Option<Vec3<T>>,
    end: Option<Vec3<T>>,
    fields: [FieldId; 2],
) -> Result<Ends<T>, CallError> {
    match (rule.ends(), start, end) {
        (Some(ends), None, None) => Ok(ends),
        (None, Some(start), Some(end)) => Ok(Ends::Open(End::Clamped(start), End::Clamped(end))),
        (None, start, _) => Err(CallError::new(
            "missing-argument",
            "clamped ends need the slopes `start` and `end`",
        )
        .expected("start = {x, y, z}, end = {x, y, z}")
        .in_field(fields[usize::from(start.is_some())])),
        (Some(_), start, _) => {
            Err(CallError::new("unused-argument", "slopes are for clamped ends only")
                .help("add ends = \"clamped\", or leave the slopes out")
                .in_field(fields[usize::from(start.is_none())]))
        }
    }
}
