//! `FairCurve`: the faired spline of points.

use super::demands::{Demand, Demands, one_each, shapes_of};
use super::shapes::{self, AnchoredSpline};
use super::{ArgumentFields, GivenKnots, Intent, end, faithful, fault, measure, role};
use crate::FairError;
use moldloft_num::{Order, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, FieldId, Kind, Point, Value};
use std::sync::Arc;

/// A fair B-spline curve within a tolerance of the one through its points.
///
/// Of all splines with knots at the points that stay within the tolerance of each point, `goal` says
/// which is taken; members say how it came out: `deviation` (the greatest distance of a point from it),
/// `value` and `gap` (its measure, and how much less any other has at most), `active` (tolerances that
/// are reached), `used` (squared residuals as a multiple of those of noise that fills the tolerance),
/// `fairest_used` (the same of the fairest) and `findings` (points that do not fit their neighbours).
/// Parameters and knots follow the points' spacing. Points that are as fair as the tolerance allows do
/// not move. The result is continuous in the points. Points can be control points
/// or be faired themselves instead (`as`); these, curves that join others and the mode "faithful"
/// take the number of a point for its parameter, as the report of 1991 does. Their members are `deviation`
/// (how far control points, or the points themselves, moved) and, of optima, `value`, `gap` and `active`.
/// Points on a line, conic, plane cubic or helix stay in any case, unless `goal` is "fairest". In mode "faithful" the
/// worst knots are removed and re-inserted one after the other (Farin and Sapidis 1989), one step per
/// point, and which knot comes first may change with the points.
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
    /// How far the curve may be from each of the points; 0 passes through all.
    #[field(min = 0)]
    tolerance: T,
    /// The measure to minimise: "second", "third", "jumps", "jump-lengths", "bending" or
    /// "variation".
    #[field(default = "second")]
    measure: Arc<str>,
    /// Meaning of the points: "fit" (the curve passes through them before it is faired), "control"
    /// (its control points) or "points" (they are faired and then interpolated).
    #[field(default = "fit")]
    r#as: Arc<str>,
    /// Numbers of points, from 1, that are intended breaks: they stay, and nothing is smoothed
    /// across them. A curve through its points has corners there; a closed one begins at the
    /// first of them.
    #[field(default)]
    breaks: Option<Vec<usize>>,
    /// What open ends keep of the curve through the points: "free" (within the tolerance), "position",
    /// "tangent" or "curvature".
    #[field(default = "position")]
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
    /// Curves that it runs on from, or into, with the same tangent direction and curvature: each
    /// begins or ends where this one does. They stay as they are; `ends` is for the other end.
    #[field(default)]
    joins: Option<Vec<CurveRef<T>>>,
    /// Positive weights of the control points (`as = "control"`), which make it rational and stay as
    /// they are. They count as constants: derivatives do not go through them.
    #[field(default)]
    weights: Option<Vec<T>>,
    /// Knots of the control points (`as = "control"`) of an open curve, degree + 1 more of them,
    /// non-decreasing; constants too.
    #[field(default)]
    knots: Option<Vec<T>>,
    /// How points get their parameters: "chord", "centripetal", a coordinate ("x", "y" or "z", for
    /// offsets at stations), "index", or "curvature" (lengths, longer where the curve turns). "auto" is
    /// "curvature" for the goals "near" and "budget" where nothing but these is asked for and ends keep no tangents,
    /// else "chord".
    #[field(default = "auto")]
    spacing: Arc<str>,
    /// Which of the curves within the tolerance: "near" (no fairer than noise of the tolerance's size
    /// asks for, and unmoved where there is little to gain), "budget" (the same, moved in any case),
    /// "fairest", "nearest" (the nearest to the points that measures little more than the fairest),
    /// "energy" (the nearest that measures at most `share`) or "closest" (the nearest of the `shape`).
    #[field(default = "near")]
    goal: Arc<str>,
    /// The direction in which the curve may leave its points, such as {0, 1, 0} for offsets at fixed
    /// stations; any direction without it.
    #[field(default)]
    along: Option<Vec3<T>>,
    /// The shape that the curve has to have, points from 1: "convex=4-10", "concave=1-4", "one-way=1-9"
    /// (no inflection), "straight=1-9", "straight=1-9:0,1" (in a direction), "arc=9-15", "pieces=2" (of
    /// monotone curvature), "within=0,1:4.6" (the largest value along a direction), "side=0,-1" (the
    /// points are left only against it). A word alone is about the whole curve. No derivatives.
    #[field(default)]
    shape: Option<Vec<Arc<str>>>,
    /// The share of the goals "budget" (0.8) and "nearest" (0.1), or the measure of "energy".
    #[field(default)]
    share: Option<T>,
    /// Tolerances of the points one by one, instead of `tolerance`.
    #[field(default)]
    tolerances: Option<Vec<T>>,
    /// Numbers of points, from 1, through which the curve passes.
    #[field(default)]
    fixed: Option<Vec<usize>>,
    /// Numbers of points, from 1, that are wrong: the curve may leave them.
    #[field(default)]
    release: Option<Vec<usize>>,
    /// Points that the curve passes through at `through_at`. No derivatives.
    #[field(default)]
    through: Option<Vec<Point<T>>>,
    /// Parameters, from 0 to 1, of `through`.
    #[field(default)]
    through_at: Option<Vec<T>>,
    /// Directions that the curve has at `tangents_at`. No derivatives.
    #[field(default)]
    tangents: Option<Vec<Vec3<T>>>,
    /// Parameters, from 0 to 1, of `tangents`.
    #[field(default)]
    tangents_at: Option<Vec<T>>,
    /// What it keeps of the curve through the points, to first order: "area" (swept about the origin in
    /// the plane of x and y) or "volume" (of revolution about x). No derivatives.
    #[field(default)]
    keep: Option<Vec<Arc<str>>>,
    /// 0 to have no more inflections than the curve of least bending within the tolerances; no
    /// derivatives then.
    #[field(default = 1, min = 0, max = 1)]
    bends: usize,
    /// Parameters of the points one by one, instead of `spacing`: rising numbers (of a closed curve less than
    /// 1 apart).
    #[field(default)]
    at: Option<Vec<T>>,
}

/// Ends within this share of the curve's extent are one place.
const TOGETHER: f64 = 1e-9;

/// The field of the joins.
const JOINS: FieldId = FairCurve::<f64>::JOINS;

/// The fields of the weights and the knots.
const WEIGHTS: FieldId = FairCurve::<f64>::WEIGHTS;
const KNOTS: FieldId = FairCurve::<f64>::KNOTS;

/// The fields of the spacing, the goal and the direction.
const SPACING: FieldId = FairCurve::<f64>::SPACING;
const GOAL: FieldId = FairCurve::<f64>::GOAL;
const ALONG: FieldId = FairCurve::<f64>::ALONG;

/// The fields of what only curves near their points have.
const SHAPE: FieldId = FairCurve::<f64>::SHAPE;
const SHARE: FieldId = FairCurve::<f64>::SHARE;
const TOLERANCES: FieldId = FairCurve::<f64>::TOLERANCES;
const THROUGH: FieldId = FairCurve::<f64>::THROUGH;
const TANGENTS: FieldId = FairCurve::<f64>::TANGENTS;
const KEEP: FieldId = FairCurve::<f64>::KEEP;

impl<T: Real> FairCurve<T> {
    /// What is asked of a curve near its points.
    fn demands(&self) -> Result<Demands<T>, CallError> {
        let n = self.points.len();
        let wrong = |id: &'static str, message: String, expected: String, found: String| {
            CallError::new(id, message).expected(expected).found(found)
        };
        let shape = shapes_of(self.shape.as_deref(), n, SHAPE)?;
        one_each("tolerances", self.tolerances.as_deref(), n, TOLERANCES)?;
        one_each("parameters", self.at.as_deref(), n, Self::AT)?;
        let rises = |w: &[T]| w[0].re() < w[1].re();
        if let Some(k) = self.at.as_deref().and_then(|at| at.windows(2).position(|w| !rises(w))) {
            return Err(CallError::new("out-of-range", "parameters rise from point to point")
                .in_item(k + 1)
                .in_field(Self::AT));
        }
        let mut conditions = Vec::new();
        let mut place = |what: &'static str,
                         values: Vec<Vec3<T>>,
                         at: &Option<Vec<T>>,
                         field: FieldId,
                         make: fn(Vec3<f64>) -> Demand|
         -> Result<(), CallError> {
            let at = at.as_deref().unwrap_or_default();
            if at.len() != values.len() {
                let (expected, found) =
                    (format!("{} parameters", values.len()), at.len().to_string());
                let message = format!("`{what}` has a parameter for each");
                return Err(wrong("wrong-count", message, expected, found).in_field(field));
            }
            for (k, (v, t)) in values.iter().zip(at).enumerate() {
                let constant = t.is_constant() && v.to_array().iter().all(|c| c.is_constant());
                if !constant {
                    let message = format!("derivatives through `{what}` are not known");
                    let expected = "constants".to_string();
                    return Err(wrong("no-derivative", message, expected, what.into())
                        .in_item(k)
                        .in_field(field));
                }
                if !(0.0..=1.0).contains(&t.re()) {
                    let (expected, found) = ("0 to 1".to_string(), t.re().to_string());
                    let message = "a parameter is out of range".to_string();
                    return Err(wrong("out-of-range", message, expected, found)
                        .in_item(k)
                        .in_field(field));
                }
                conditions.push((t.re(), make(v.re())));
            }
            Ok(())
        };
        let through = self.through.iter().flatten().map(|p| p.xyz).collect();
        place("through", through, &self.through_at, THROUGH, Demand::Through)?;
        let tangents: Vec<Vec3<T>> = self.tangents.iter().flatten().copied().collect();
        if let Some(k) = tangents.iter().position(|d| d.re().norm() == 0.0) {
            return Err(CallError::new("zero-direction", "the direction has no length")
                .in_item(k)
                .in_field(TANGENTS));
        }
        place("tangents", tangents, &self.tangents_at, TANGENTS, Demand::Tangent)?;
        for (k, word) in self.keep.iter().flatten().enumerate() {
            let what = match &**word {
                "area" => Demand::Area,
                "volume" => Demand::Volume,
                _ => {
                    let message = format!("`{word}` cannot be kept");
                    let expected = "\"area\" or \"volume\"".to_string();
                    return Err(wrong("unknown-name", message, expected, word.to_string())
                        .in_item(k)
                        .in_field(KEEP));
                }
            };
            conditions.push((0.0, what));
        }
        Ok(Demands {
            shape,
            conditions,
            tolerances: self.tolerances.clone(),
            fixed: self.fixed.clone().unwrap_or_default(),
            release: self.release.clone().unwrap_or_default(),
            bends: self.bends == 1,
            at: self.at.clone(),
        })
    }

    /// The first of what only curves near their points have that is given.
    fn near_only(&self) -> Option<(&'static str, FieldId)> {
        let given = [
            (self.shape.is_some(), "shape", SHAPE),
            (self.tolerances.is_some(), "tolerances", TOLERANCES),
            (self.fixed.is_some(), "fixed", Self::FIXED),
            (self.release.is_some(), "release", Self::RELEASE),
            (self.through.is_some(), "through", THROUGH),
            (self.tangents.is_some(), "tangents", TANGENTS),
            (self.keep.is_some(), "keep", KEEP),
            (self.bends == 0, "bends", Self::BENDS),
            (self.at.is_some(), "at", Self::AT),
            (&*self.spacing == "curvature", "spacing \"curvature\"", SPACING),
        ];
        given.into_iter().find(|g| g.0).map(|g| (g.1, g.2))
    }
}

impl<T: Real> FairCurve<T> {
    /// Weights and knots, where they have a meaning.
    fn own(&self) -> Result<GivenKnots, CallError> {
        let plain =
            |x: &Option<Vec<T>>| x.as_ref().map(|x| x.iter().map(|x| x.re()).collect::<Vec<f64>>());
        let own = GivenKnots { knots: plain(&self.knots), weights: plain(&self.weights) };
        let given =
            [(own.weights.is_some(), "weights", WEIGHTS), (own.knots.is_some(), "knots", KNOTS)];
        for (_, what, field) in given.into_iter().filter(|g| g.0) {
            let refused = |why: &str, expected: &str, found: &str| {
                CallError::new("not-control", format!("{what} {why}"))
                    .expected(expected)
                    .found(found)
                    .in_field(field)
            };
            if &*self.r#as != "control" {
                let found = format!("as = \"{}\"", self.r#as);
                return Err(refused("are those of control points", "as = \"control\"", &found));
            }
            if what == "weights" && &*self.mode == "faithful" {
                return Err(refused(
                    "need the optimum",
                    "mode = \"optimum\"",
                    "mode = \"faithful\"",
                ));
            }
            if what == "weights" && self.joins.as_ref().is_some_and(|j| !j.is_empty()) {
                return Err(refused("and joins do not go together", "one of them", "both"));
            }
            if what == "knots" && self.closed == 1 {
                return Err(refused("are for open curves", "closed = 0", "closed = 1"));
            }
        }
        Ok(own)
    }
}

impl<T: Real> FairCurve<T> {
    /// What the curve runs on from at its start and its end, and which of the joins that is.
    #[expect(clippy::type_complexity, reason = "two ends, each with a place and derivatives")]
    fn neighbours(&self) -> Result<[Option<(usize, [Vec3<T>; 2])>; 2], CallError> {
        let mut found = [None; 2];
        let joins = self.joins.as_deref().unwrap_or_default();
        let ([first, .., last], false) = (self.points.as_slice(), joins.is_empty()) else {
            return Ok(found);
        };
        let only = |what: &str, found: &str| {
            CallError::new("not-joined", format!("a curve that joins others {what}"))
                .expected("no `joins`, or another way")
                .found(found)
                .in_field(JOINS)
        };
        if self.closed == 1 {
            return Err(only("has ends", "a closed curve"));
        }
        if &*self.mode == "faithful" {
            return Err(only("is an optimum", "mode = \"faithful\""));
        }
        if &*self.r#as == "points" {
            return Err(only("has its points on it, or as control points", "as = \"points\""));
        }
        let own = [first, last].map(|p| p.xyz);
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
            // The neighbour's parameter runs into the start, or on from the end, or the other way.
            let sign = if a == b { -1.0 } else { 1.0 };
            found[a] = Some((k, [jets[b][1].map(|x| x * sign), jets[b][2]]));
        }
        Ok(found)
    }
}

/// Which of the joins a refusal is about.
fn unjoined(error: FairError, joins: [Option<usize>; 2], places: &ArgumentFields) -> CallError {
    let present: Vec<usize> = joins.iter().flatten().copied().collect();
    let about = |k: Option<&usize>, id: &'static str, message: String| {
        let fault = CallError::new(id, message);
        k.map_or(fault.clone(), |&k| fault.in_item(k)).in_field(JOINS)
    };
    match error {
        FairError::Contradiction { conditions, miss, .. } if !present.is_empty() => {
            let whose = conditions.first().and_then(|c| present.get(c / 6));
            let message = format!(
                "the curvature of a curve that it joins cannot be met within the tolerance (missed \
                 by {miss:.3e})"
            );
            about(whose, "contradiction", message)
                .expected("a larger tolerance, or points that run on from the neighbour")
        }
        FairError::TurnsBack => about(present.first(), "turns-back", error.to_string())
            .expected("a curve that runs on where its neighbour ends"),
        FairError::Singular if !present.is_empty() => about(
            present.first(),
            "stands-still",
            "a curve of `joins` has no direction at the common end".to_string(),
        ),
        other => fault(other, places),
    }
}

impl<T: Real> Build<T> for FairCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let neighbours = self.neighbours()?;
        let own = self.own()?;
        let motion = match &self.along {
            None => crate::Motion::Ball,
            Some(d) if d.re().norm() > 0.0 => crate::Motion::Along(d.re()),
            Some(_) => {
                return Err(CallError::new("zero-direction", "the direction has no length")
                    .expected("a direction such as {0, 1, 0}")
                    .in_field(ALONG));
            }
        };
        let plain: Vec<_> = self.points.iter().map(|p| p.xyz.re()).collect();
        let budget = crate::near_budget(&plain, motion);
        let goal = super::goal_of(&self.goal, self.share.map(|s| s.re()), budget, [GOAL, SHARE])?;
        let conditions = self.shape.is_some()
            || self.through.is_some()
            || self.tangents.is_some()
            || self.keep.is_some();
        let ends = matches!(&*self.ends, "free" | "position");
        let free = !conditions && ends && motion == crate::Motion::Ball;
        let to_the_truth = matches!(goal, crate::Goal::Near(_) | crate::Goal::Budget(_));
        let turning = match &*self.spacing {
            "auto" => free && to_the_truth,
            word => word == "curvature",
        };
        let word =
            if matches!(&*self.spacing, "auto" | "curvature") { "chord" } else { &self.spacing };
        let intent = Intent {
            tolerance: self.tolerance,
            degree: self.degree,
            closed: self.closed == 1,
            role: role(&self.r#as, Self::AS)?,
            measure: measure(&self.measure, Self::MEASURE)?,
            faithful: faithful(&self.mode, Self::MODE)?,
            end: end(&self.ends, Self::ENDS)?,
            breaks: self.breaks.clone().unwrap_or_default(),
            joins: neighbours.map(|n| n.map(|(_, derivatives)| derivatives)),
            own,
            spacing: super::spacing(word, SPACING)?,
            turning,
            goal,
            motion,
        };
        let demands = self.demands()?;
        let near_only = self.near_only();
        let places = ArgumentFields {
            points: Self::POINTS,
            tolerance: Self::TOLERANCE,
            degree: Self::DEGREE,
            breaks: Self::BREAKS,
        };
        let points: Vec<_> = self.points.iter().map(|p| p.xyz).collect();
        let joins = neighbours.map(|n| n.map(|(k, _)| k));
        let about = |e: FairError| match e {
            FairError::Weight { .. } | FairError::Count { what: "weights", .. } => {
                CallError::new("bad-weight", e.to_string()).in_field(WEIGHTS)
            }
            FairError::Unsorted { .. }
            | FairError::Knots(_)
            | FairError::Count { what: "knots", .. } => {
                CallError::new("bad-knots", e.to_string()).in_field(KNOTS)
            }
            FairError::TurnsAlong { index } => {
                CallError::new("runs-back", e.to_string()).in_item(index).in_field(SPACING)
            }
            FairError::Goal(why) => CallError::new("no-goal", why).in_field(GOAL),
            FairError::Energy { .. } => CallError::new("no-goal", e.to_string()).in_field(SHARE),
            FairError::Shape { shapes, miss } => {
                let message = format!(
                    "no curve with this shape was found within the tolerance (missed by {miss:.3e})"
                );
                let fault = CallError::new("no-shape", message);
                shapes.first().map_or(fault.clone(), |&k| fault.in_item(k)).in_field(SHAPE)
            }
            FairError::Shapeless { shape, why } => {
                CallError::new("no-shape", why).in_item(shape).in_field(SHAPE)
            }
            e => unjoined(e, joins, &places),
        };
        let index = matches!(intent.spacing, crate::ParameterSpacing::Uniform);
        let alone = intent.joins.iter().all(Option::is_none);
        if intent.role == super::PointRole::Fit && !intent.faithful && alone && !index {
            let (curve, figures) = intent.near(&points, &demands).map_err(about)?;
            let [first, .., last] = self.points.as_slice() else {
                return Err(
                    CallError::new("too-few-items", "a curve needs points").in_field(Self::POINTS)
                );
            };
            // A free end leaves its point, and a closed curve has no ends.
            let kept = !intent.closed && (intent.end.kept() > 0 || self.tolerance.re() == 0.0);
            let ends = [first, last].map(|p| if kept { p.key } else { None });
            let curve = CurveRef::new(AnchoredSpline { curve, ends }, 0);
            return Ok(Value::Curve(curve.with_figures(&figures.members())));
        }
        if let Some((what, field)) = near_only {
            let message = format!("`{what}` is for curves near their points");
            return Err(CallError::new("not-near", message)
                .expected("as = \"fit\", mode = \"optimum\", without joins and spacing \"index\"")
                .in_field(field));
        }
        let (space, control, figures) = intent.spline(&points).map_err(about)?;
        let made = match &intent.own.weights {
            Some(weights) => shapes::rational(&space, &control, weights),
            None => shapes::curve(&space, &control),
        };
        let curve =
            made.map_err(|e| CallError::new("no-spline", e.to_string()).in_field(Self::POINTS))?;
        let [first, .., last] = self.points.as_slice() else {
            return Err(
                CallError::new("too-few-items", "a curve needs points").in_field(Self::POINTS)
            );
        };
        // A free end leaves its point, and a closed curve has no ends.
        let kept = |at: usize| !intent.closed && (intent.end.kept() > 0 || joins[at].is_some());
        let end = |at: usize, p: &Point<T>| if kept(at) { p.key } else { None };
        let ends = [end(0, first), end(1, last)];
        let curve = CurveRef::new(AnchoredSpline { curve, ends }, 0);
        Ok(Value::Curve(curve.with_figures(&figures.members_of_moves())))
    }
}
