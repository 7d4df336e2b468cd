use super::shapes::{self, Ended};
use super::{Intent, Places, end, faithful, fault, measure, role};
use moldloft_num::Real;
use moldloft_registry::{Build, Context, CurveRef, Fault, Kind, Point, Value};
use std::sync::Arc;

/// A fair B-spline curve within a tolerance of the one through its points.
///
/// The points are interpolated at uniform parameters (or are control points, or are faired
/// themselves: see `as`). Of all splines on the same knots that stay within the tolerance of that
/// curve everywhere, the one with the least of the measure is taken. The result is continuous in
/// the points, except in mode "faithful": there the worst knots are removed and re-inserted one
/// after the other (Farin and Sapidis 1989), one step per point, and which knot comes first may
/// change with the points.
#[derive(Kind)]
#[kind(
    class = Curve,
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0.52, 0); AbsPoint C(2, 0.83, 0); \
               AbsPoint D(3, 0.88, 0); AbsPoint E(4, 0.81, 0); AbsPoint F(5, 0.49, 0); \
               AbsPoint G(6, 0, 0); FairCurve c({A, B, C, D, E, F, G}, 0.05);"
)]
pub struct FairCurve<T: Real> {
    /// Points, at least degree + 2 of them (closed: 2 degree + 2).
    #[field(min_items = 3)]
    points: Vec<Point<T>>,
    /// How far the curve may be from the one through the points; 0 leaves it alone.
    #[field(min = 0)]
    tolerance: T,
    /// What there is to be little of: "second", "third", "jumps", "jump-lengths", "bending" or
    /// "variation".
    #[field(default = "second")]
    measure: Arc<str>,
    /// What the points are: "fit" (the curve passes through them before it is faired), "control"
    /// (its control points) or "points" (they are faired and then interpolated).
    #[field(default = "fit")]
    r#as: Arc<str>,
    /// Numbers of points, from 1, that are intended breaks: they stay, and nothing is smoothed
    /// across them. A curve through its points has corners there; a closed one begins at the
    /// first of them.
    #[field(default)]
    breaks: Option<Vec<usize>>,
    /// What open ends keep: "free", "position", "tangent" or "curvature".
    #[field(default = "tangent")]
    ends: Arc<str>,
    /// "optimum" or "faithful".
    #[field(default = "optimum")]
    mode: Arc<str>,
    /// Polynomial degree.
    #[field(default = 3, min = 2, max = 9)]
    degree: usize,
    /// 1 for a closed curve, whose first point is not repeated.
    #[field(default = 0, min = 0, max = 1)]
    closed: usize,
}

impl<T: Real> Build<T> for FairCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        let intent = Intent {
            tolerance: self.tolerance,
            degree: self.degree,
            closed: self.closed == 1,
            role: role(&self.r#as, 3)?,
            measure: measure(&self.measure, 2)?,
            faithful: faithful(&self.mode, 6)?,
            end: end(&self.ends, 5)?,
            breaks: self.breaks.unwrap_or_default(),
        };
        let places = Places { points: 0, tolerance: 1, degree: 7, breaks: 4 };
        let points: Vec<_> = self.points.iter().map(|p| p.xyz).collect();
        let (space, control) = intent.spline(&points).map_err(|e| fault(e, &places))?;
        let curve = shapes::curve(&space, &control)
            .map_err(|e| Fault::new("no-spline", e.to_string()).in_field(0))?;
        let [first, .., last] = self.points.as_slice() else {
            return Err(Fault::new("too-few-items", "a curve needs points").in_field(0));
        };
        // A free end leaves its point, and a closed curve has no ends.
        let kept = !intent.closed && intent.end.kept() > 0;
        let ends = if kept { [first.key, last.key] } else { [None, None] };
        Ok(Value::Curve(CurveRef::new(Ended { curve, ends }, 0)))
    }
}
