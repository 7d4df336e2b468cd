//! `FairCurve`: a fair spline near points.

use super::faired::{CurveContext, FairedSpline};
use super::options::{CurveOptions, curve_options, shared_options};
use super::shapes::AnchoredSpline;
use crate::{Demand, FairError, Space};
use moldloft_num::{Order, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, FieldId, Kind, Point, Value};
use std::sync::Arc;

shared_options! {
    {
        /// A fair B-spline curve within a tolerance of its points.
        ///
        /// The curve minimises `measure` among all splines with knots at the points, within the
        /// tolerance of each point; `goal` selects how far the data are smoothed. Data that are as
        /// fair as the tolerance allows are interpolated unchanged. Parameters and knots follow the
        /// spacing of the points, and the result depends continuously on the points.
        ///
        /// Members: `deviation` (largest distance of a point from the curve), `value` (the
        /// measure), `gap` (upper bound on how much lower the measure of any admissible curve can
        /// be), `active` (number of tolerances reached), `used` (mean squared residual relative to
        /// noise that fills the tolerance), `fairest_used` (the same for the fairest curve) and
        /// `findings` (number of points that do not fit their neighbours).
        ///
        /// Control points are moved instead of data with `as = "control"`, `knots`, `weights`,
        /// `count`, a `bound` of "curve" or "points" and every `mode` except "optimum".
        /// Members are then `deviation` (largest move of a control point or point; with `knots`,
        /// `weights` or `count` the largest distance of a point), `value`, `gap`, and `active` for
        /// the optimum or `steps` for the other modes.
        ///
        /// Points on a line, conic, plane cubic or helix do not move, unless `goal` is "fairest".
        /// Mode "faithful" repeats the removal and re-insertion of the worst knot (Farin and
        /// Sapidis 1989), one step per point; its result may jump where two knots are equally bad.
        ///
        /// Differences from the Python function: `breaks` and `release` are numbers, never "auto";
        /// `ends` are words; the log of single steps is available from the command (`moldloft fair
        /// model.sdl:name --log`); there are no `accuracy` (optima are solved to rounding, so that
        /// derivatives exist), no `original` and no `draft`, which is for pictures while a tolerance
        /// slides.
        #[derive(Kind)]
        #[kind(
            forward,
            class = Curve,
            example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0.52, 0); AbsPoint C(2, 0.83, 0); \
                       AbsPoint D(3, 0.88, 0); AbsPoint E(4, 0.81, 0); AbsPoint F(5, 0.49, 0); \
                       AbsPoint G(6, 0, 0); FairCurve c({A, B, C, D, E, F, G}, 0.05);"
        )]
        pub struct FairCurve<T: Real>
    }
    {
        /// Points, at least degree + 2 (closed: 2 degree + 2).
        #[field(min_items = 3)]
        points: Vec<Point<T>>,
        /// Largest distance of each point from the curve, in units of length; 0: interpolation.
        #[field(min = 0)]
        tolerance: T,
        /// Measure to minimise: "second" or "third" (squared differences of control points),
        /// "jumps" or "jump-lengths" (squares or lengths of the jumps of the highest derivative),
        /// "bending" or "variation" (integral of the squared second or third derivative). Default:
        /// "variation" for data ("bending" below degree 3), "second" where control points move.
        #[field(default)]
        measure: Option<Arc<str>>,
        /// Role of the points: "fit" (data on the curve; default for the optimum), "control"
        /// (control points of a uniform spline, which does not end at its points; default for the
        /// other modes) or "points" (faired, then interpolated; for the optimum the same as "fit",
        /// except with `spacing = "index"`).
        #[field(default)]
        r#as: Option<Arc<str>>,
        /// Numbers, from 1, of points that are intended breaks: they do not move, nothing is
        /// smoothed across them, and the curve has corners at them. A closed curve starts at the
        /// first of them.
        #[field(default)]
        breaks: Option<Vec<usize>>,
        /// Condition at open ends, relative to the curve through the points: "free" (within the
        /// tolerance), "position", "tangent", "curvature" or a number of fixed control points.
        /// Default: "free" for data, "tangent" for fits whose control points move, otherwise "2".
        #[field(default)]
        ends: Option<Arc<str>>,
        /// "optimum", or stepwise: "faithful" (removal and re-insertion of knots, longest
        /// achievable move first), "literal" (largest jump first; may stall), "vertex" (each
        /// control point to its own minimum), "sweeps" (all points in order) or "levels"
        /// (multilevel cycles). "sweeps" and "levels" have no derivatives.
        #[field(default = "optimum")]
        mode: Arc<str>,
        /// Polynomial degree.
        #[field(default = 3, min = 2, max = 9)]
        degree: usize,
        /// 1 for a closed curve, whose first point is not repeated.
        #[field(default = 0, min = 0, max = 1)]
        closed: usize,
        /// Curves to continue with the same tangent direction and curvature; each begins or ends at
        /// the first or last point. They are not changed. `ends` applies to an end without a
        /// neighbour.
        #[field(default)]
        joins: Option<Vec<CurveRef<T>>>,
    }
    [knots]
    {
        /// Parametrisation of the points: "chord", "centripetal", a coordinate ("x", "y" or "z",
        /// for offsets at stations), "index", or "curvature" (chord lengths, extended where the
        /// curve turns). "auto" is "curvature" for the goals "near" and "budget" without further
        /// conditions, otherwise "chord"; with control points it is "index".
        #[field(default = "auto")]
        spacing: Arc<str>,
    }
    [goal] [along] [share] [curve]
    {
        /// Points on the curve at `through_at`. No derivatives.
        #[field(default)]
        through: Option<Vec<Point<T>>>,
        /// Quantities of the initial curve that are preserved to first order: "area" (swept about
        /// the origin in the plane of x and y), "volume" (of revolution about x) or "centroid" (of
        /// the control points). No derivatives.
        #[field(default)]
        keep: Option<Vec<Arc<str>>>,
    }
}

/// Ends closer than this fraction of the curve's extent coincide.
const TOGETHER: f64 = 1e-9;

const JOINS: FieldId = FairCurve::<f64>::JOINS;

const SPACINGS: [&str; 8] = ["auto", "chord", "centripetal", "x", "y", "z", "index", "curvature"];

impl<T: Real> FairCurve<T> {
    fn kept(&self) -> Result<Vec<Demand<T>>, CallError> {
        let one = |(k, word): (usize, &Arc<str>)| {
            Demand::kept(word).ok_or_else(|| {
                CallError::new("unknown-name", format!("`{word}` cannot be kept"))
                    .expected("\"area\", \"volume\" or \"centroid\"")
                    .found(word.to_string())
                    .in_item(k)
                    .in_field(Self::KEEP)
            })
        };
        self.keep.iter().flatten().enumerate().map(one).collect()
    }
}

impl<T: Real> FairCurve<T> {
    /// First and last point of the spline with these control points.
    fn ends_on(&self, space: &Space) -> [Vec3<T>; 2] {
        let (start, end) = space.domain();
        [start, end].map(|t| {
            let (k, t) = space.locate(t);
            let basis = space.basis(k, t);
            let entries = space.columns(k).zip(basis.rows[0].iter());
            entries.fold(Vec3::zero(), |s, (c, &b)| s + self.points[c].xyz.map(|x| x * b))
        })
    }

    /// For each end, the index of the curve to continue and its first and second derivative.
    #[expect(clippy::type_complexity, reason = "two ends, each with a place and derivatives")]
    fn neighbours(
        &self,
        options: &CurveOptions<T>,
    ) -> Result<[Option<(usize, [Vec3<T>; 2])>; 2], CallError> {
        let mut found = [None; 2];
        let joins = self.joins.as_deref().unwrap_or_default();
        let ([first, .., last], false) = (self.points.as_slice(), joins.is_empty()) else {
            return Ok(found);
        };
        let only = |what: &str, found: &str| {
            CallError::new("not-joined", format!("a curve that joins others {what}"))
                .expected("no `joins`, or other options")
                .found(found)
                .in_field(JOINS)
        };
        if self.closed == 1 {
            return Err(only("has ends", "a closed curve"));
        }
        if &*self.mode != "optimum" {
            return Err(only("is an optimum", &format!("mode = \"{}\"", self.mode)));
        }
        let own = match options.control_space(self.points.len())? {
            Some(space) => self.ends_on(&space),
            None => [first, last].map(|p| p.xyz),
        };
        let extent =
            self.points.iter().map(|p| (p.xyz.re() - own[0].re()).norm()).fold(0.0, f64::max);
        for (k, other) in joins.iter().enumerate() {
            let jets = [0.0, 1.0].map(|t| other.jet(T::from(t), Order::Second));
            let pairs = [(0, 1), (0, 0), (1, 0), (1, 1)];
            let away = |&(a, b): &(usize, usize)| (own[a].re() - jets[b][0].re()).norm();
            let near = pairs.into_iter().min_by(|a, b| away(a).total_cmp(&away(b)));
            let (a, b) = near.expect("there are four pairs");
            let far = away(&(a, b));
            if far.is_nan() || far > TOGETHER * extent {
                return Err(CallError::new(
                    "no-common-end",
                    "a curve of `joins` does not meet this one",
                )
                .expected("a curve that begins or ends at its first or last point")
                .found(format!("{far:.3e} between the nearest ends"))
                .related(other.key, "ends elsewhere")
                .in_item(k)
                .in_field(JOINS));
            }
            if found[a].is_some() {
                let end = ["start", "end"][a];
                return Err(CallError::new(
                    "joined-twice",
                    format!("two curves join at its {end}"),
                )
                .expected("one at each end")
                .related(other.key, "the second")
                .in_item(k)
                .in_field(JOINS));
            }
            // The derivative is reversed if the neighbour's parameter has the opposite direction.
            let sign = if a == b { -1.0 } else { 1.0 };
            found[a] = Some((k, [jets[b][1].map(|x| x * sign), jets[b][2]]));
        }
        Ok(found)
    }
}

/// Error about one of the joined curves, whose conditions come after `others`.
fn unjoined(error: &FairError, joins: [Option<usize>; 2], others: usize) -> Option<CallError> {
    let present: Vec<usize> = joins.iter().flatten().copied().collect();
    let about = |k: Option<&usize>, id: &'static str, message: String| {
        let fault = CallError::new(id, message);
        k.map_or(fault.clone(), |&k| fault.in_item(k)).in_field(JOINS)
    };
    Some(match error {
        FairError::Contradiction { conditions, miss, .. } if !present.is_empty() => {
            let whose = conditions.first().and_then(|c| present.get(c.checked_sub(others)?));
            let message = format!(
                "the curvature of a curve that it joins cannot be met within the tolerance (missed \
                 by {miss:.3e})"
            );
            about(whose, "contradiction", message)
                .expected("a larger tolerance, or points that continue the neighbour")
        }
        FairError::TurnsBack => about(present.first(), "turns-back", error.to_string())
            .expected("a curve that continues its neighbour"),
        FairError::Singular if !present.is_empty() => about(
            present.first(),
            "stands-still",
            "a curve of `joins` has no direction at the common end".to_string(),
        ),
        _ => return None,
    })
}

impl<T: Real> Build<T> for FairCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let options = curve_options!(self, POINTS);
        let neighbours = self.neighbours(&options)?;
        let points: Vec<_> = self.points.iter().map(|p| p.xyz).collect();
        let plain: Vec<_> = points.iter().map(|p| p.re()).collect();
        let joins = neighbours.map(|n| n.map(|(k, _)| k));
        let context = CurveContext {
            joins: neighbours.map(|n| n.map(|(_, derivatives)| derivatives)),
            through: self.through.iter().flatten().map(|p| p.xyz).collect(),
            keep: self.kept()?,
            keep_field: Self::KEEP,
            least_end: None,
            budget: crate::near_budget(&plain, options.motion()?),
            turns: true,
            spacings: &SPACINGS,
        };
        let tangents = self.tangents.iter().flatten().count();
        let others = context.through.len() + context.keep.len() + tangents;
        let unmade = |error: &FairError| unjoined(error, joins, others);
        let FairedSpline { curve, members, kept } = options.faired(&points, context, unmade)?;
        let [first, .., last] = self.points.as_slice() else {
            return Err(
                CallError::new("too-few-items", "a curve needs points").in_field(Self::POINTS)
            );
        };
        let end = |at: usize, p: &Point<T>| if kept[at] { p.key } else { None };
        let ends = [end(0, first), end(1, last)];
        let curve = CurveRef::new(AnchoredSpline { curve, ends }, 0);
        Ok(Value::Curve(curve.with_figures(&members)))
    }
}
