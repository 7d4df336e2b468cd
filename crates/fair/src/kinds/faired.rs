//! Conversion of the options of curves and snakes to a faired spline.

use super::demands::{Demands, one_each, shapes_of};
use super::direct::{CurveMethod, DirectCurve};
use super::options::{CurveOptions, constant};
use super::{
    ArgumentFields, GivenKnots, Intent, PointRole, end, fault, goal_of, role, shapes, spacing,
    unknown,
};
use crate::{
    Bound, Demand, EndContinuity, FairError, Goal, KnotRemovalOptions, Motion, ParameterSpacing,
    PointSpacing, RemovalStep, Rule, Space, Stops,
};
use moldloft_num::{Curve, CurveJet, Order, Real, Vec3};
use moldloft_registry::{CallError, FieldId};
use moldloft_spline::{BSplineCurve, SplineWithKnotDerivatives};
use std::sync::Arc;

/// Options of curves that differ for snakes.
pub(crate) struct CurveContext<T> {
    /// First and second derivative of the curve to continue at the start and the end.
    pub joins: [Option<[Vec3<T>; 2]>; 2],
    /// Points on the curve, and quantities to preserve.
    pub through: Vec<Vec3<T>>,
    pub keep: Vec<Demand<T>>,
    /// Field of the preserved quantities.
    pub keep_field: FieldId,
    /// Minimum condition at the ends.
    pub least_end: Option<EndContinuity>,
    /// Default of `share`.
    pub budget: f64,
    /// True if "auto" may select "curvature".
    pub turns: bool,
    /// Allowed values of `spacing`.
    pub spacings: &'static [&'static str],
}

pub(crate) struct FairedSpline<T: Real> {
    pub curve: FairedCurve<T>,
    pub members: Vec<(&'static str, f64)>,
    /// For each end, true if an open curve ends at its point.
    pub kept: [bool; 2],
}

/// A spline whose knots depend on the points, or are constant.
pub(crate) enum FairedCurve<T: Real> {
    Moving(SplineWithKnotDerivatives<T>),
    Still(BSplineCurve<T>),
}

impl<T: Real> Curve<T> for FairedCurve<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        match self {
            Self::Moving(curve) => curve.jet(t, order),
            Self::Still(curve) => curve.jet(t, order),
        }
    }
    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        match self {
            Self::Moving(curve) => curve.grid(ts, out),
            Self::Still(curve) => curve.grid(ts, out),
        }
    }
    fn breaks(&self) -> Vec<f64> {
        match self {
            Self::Moving(curve) => curve.breaks(),
            Self::Still(curve) => curve.breaks(),
        }
    }

    moldloft_num::curve_facts!(broken, open, not_rational);
}

const MODES: [&str; 6] = ["optimum", "faithful", "literal", "vertex", "sweeps", "levels"];

/// Default numbers of sweeps and of multilevel cycles.
const SWEEPS: usize = 10;
const CYCLES: usize = 2;

/// Options of a curve that is faired by moving control points.
struct DirectOptions<T> {
    role: PointRole,
    method: CurveMethod,
    /// As [`CurveOptions::bound`].
    bound: Option<Option<Bound>>,
    intent: Intent<T>,
    own: GivenKnots,
}

fn refused(what: &str, field: FieldId, expected: &'static str) -> CallError {
    let text = format!("`{what}` cannot be combined with the other options");
    CallError::new("other-mode", text).expected(expected).in_field(field)
}

impl<T: Real> CurveOptions<T> {
    /// The faired spline of points.
    pub fn faired(
        &self,
        points: &[Vec3<T>],
        context: CurveContext<T>,
        unmade: impl Fn(&FairError) -> Option<CallError>,
    ) -> Result<FairedSpline<T>, CallError> {
        let unmade = |e: FairError| unmade(&e).unwrap_or_else(|| self.unmade(e));
        let demands = self.demands(points.len(), &context)?;
        let method = self.method()?;
        let role = self.role()?;
        let bound = self.bound()?;
        let (mut intent, spacing) = self.intent(&context)?;
        let index = spacing == PointSpacing::Given(ParameterSpacing::Uniform);
        let own = self.own()?;
        let given = own.knots.is_some() || own.weights.is_some() || self.count.is_some();
        // With `as = "points"` the interpolating curve is faired.
        let near = matches!(method, CurveMethod::Optimum)
            && !given
            && match role {
                PointRole::Fit => matches!(bound, None | Some(None)),
                PointRole::Points => bound.is_none() && !index,
                PointRole::Control => false,
            };
        if !near {
            let options = DirectOptions { role, method, bound, intent, own };
            return self.direct(points, context, demands, options, unmade);
        }
        if let Some((what, field)) = self.stepwise_only() {
            return Err(self.elsewhere(what, field, "mode = \"faithful\""));
        }
        let mut demands = demands;
        for (end, other) in context.joins.iter().enumerate() {
            let Some(other) = other else { continue };
            intent.ends[end] = Some(EndContinuity::Position);
            demands.conditions.push((end as f64, Demand::Join(*other)));
        }
        let (curve, figures) = intent.near(points, demands, spacing).map_err(unmade)?;
        // A free end leaves its point, and a closed curve has no ends.
        let still = self.tolerance.re() == 0.0;
        let keeps = |e: Option<EndContinuity>| e.is_some_and(|e| e.kept() > 0);
        let kept = intent.ends.map(|e| !intent.closed && (keeps(e) || still));
        let members = figures.members().to_vec();
        Ok(FairedSpline { curve: FairedCurve::Moving(curve), members, kept })
    }

    /// The role of the points: by default data of the optimum, control points of the other modes.
    pub fn role(&self) -> Result<PointRole, CallError> {
        match self.role.as_deref() {
            Some(word) => role(word, self.fields.role),
            None if &*self.mode == "optimum" => Ok(PointRole::Fit),
            None => Ok(PointRole::Control),
        }
    }

    /// The space of an open spline whose control points are the points; none for data.
    pub fn control_space(&self, count: usize) -> Result<Option<Space>, CallError> {
        let moved = &*self.spacing == "index" || self.bound.is_some();
        Ok(match self.role()? {
            PointRole::Control => self.own()?.space(self.degree, count).ok(),
            PointRole::Points if moved => Space::floating(self.degree, count).ok(),
            _ => None,
        })
    }

    /// A curve faired by moving control points.
    fn direct(
        &self,
        points: &[Vec3<T>],
        context: CurveContext<T>,
        demands: Demands<T>,
        mut options: DirectOptions<T>,
        unmade: impl Fn(FairError) -> CallError,
    ) -> Result<FairedSpline<T>, CallError> {
        let fields = &self.fields;
        self.check_near(&options)?;
        self.check_mode(&context, &demands, &options)?;
        self.check_knots(&options)?;
        let DirectOptions { role, ref mut intent, .. } = options;
        intent.spacing = match &*self.spacing {
            "chord" | "centripetal" | "index" => intent.spacing,
            "auto" if role == PointRole::Fit => ParameterSpacing::Chord,
            "auto" => ParameterSpacing::Uniform,
            _ => {
                let expected = "\"chord\", \"centripetal\" or \"index\"";
                return Err(refused("spacing", fields.spacing, expected));
            }
        };
        let fitted = role == PointRole::Fit;
        intent.ends = intent.ends.map(|e| e.or(Some(EndContinuity::of_control(fitted))));
        let DirectOptions { method, bound, intent, own, .. } = options;
        let kept = intent.ends;
        let joined = context.joins.each_ref().map(Option::is_some);
        let closed = intent.closed;
        let curve = DirectCurve {
            intent,
            role,
            method,
            bound: bound.flatten(),
            joins: context.joins,
            own,
            count: self.count,
            tolerances: self.tolerances.clone(),
            fixed: self.fixed.clone(),
            conditions: demands.conditions,
        };
        let made = curve.made(points).map_err(unmade)?;
        let spline = match &curve.own.weights {
            Some(weights) => shapes::rational(&made.space, &made.control, weights),
            None => shapes::curve(&made.space, &made.control),
        };
        let spline = spline
            .map_err(|e| CallError::new("no-spline", e.to_string()).in_field(fields.points))?;
        // Least-squares fits interpolate their ends too; control points without multiple end knots are
        // no ends.
        let keeps = |e: Option<EndContinuity>| e.is_some_and(|e| e.kept() > 0);
        let clamped = made.space.is_clamped();
        let end = |at: usize| !closed && clamped && (keeps(kept[at]) || joined[at]);
        let members = made.figures.members_of_moves();
        Ok(FairedSpline { curve: FairedCurve::Still(spline), members, kept: [end(0), end(1)] })
    }

    /// Refuses options of curves near their points.
    fn check_near(&self, options: &DirectOptions<T>) -> Result<(), CallError> {
        let fields = &self.fields;
        if options.bound == Some(None) {
            let text = "the bound \"data\" is for optima near their points";
            return Err(CallError::new("not-near", text)
                .expected("as = \"fit\", mode = \"optimum\", without knots, weights and count")
                .found("bound = \"data\"")
                .in_field(fields.bound));
        }
        if let Some((what, field)) = self.near_only(options.role) {
            return Err(self.not_near(what, field));
        }
        if !matches!(options.intent.goal, Goal::Near(_) | Goal::Fairest) || self.share.is_some() {
            let (what, field) =
                if self.share.is_some() { ("share", fields.share) } else { ("goal", fields.goal) };
            return Err(self.not_near(what, field));
        }
        Ok(())
    }

    /// Refuses options of another mode, and weights beside conditions.
    fn check_mode(
        &self,
        context: &CurveContext<T>,
        demands: &Demands<T>,
        options: &DirectOptions<T>,
    ) -> Result<(), CallError> {
        let fields = &self.fields;
        let optimum = matches!(options.method, CurveMethod::Optimum);
        let stepwise = matches!(options.method, CurveMethod::Steps(..));
        if !optimum && options.bound.is_some() {
            return Err(refused("bound", fields.bound, "mode = \"optimum\""));
        }
        if !optimum && !demands.conditions.is_empty() {
            let field = if context.keep.is_empty() { fields.through } else { context.keep_field };
            let field = if self.tangents.is_some() { fields.tangents } else { field };
            return Err(refused("through, tangents and keep", field, "mode = \"optimum\""));
        }
        if let Some((what, field)) = self.stepwise_only().filter(|_| !stepwise && optimum) {
            return Err(self.elsewhere(what, field, "mode = \"faithful\""));
        }
        if let Some((what, field)) =
            self.stepwise_only().filter(|(what, _)| !stepwise && *what != "steps")
        {
            return Err(self.elsewhere(what, field, "mode = \"faithful\""));
        }
        let conditioned =
            context.joins.iter().any(Option::is_some) || !demands.conditions.is_empty();
        if options.own.weights.is_some() && conditioned {
            let text = "weights do not go together with joins, through, tangents and keep";
            return Err(CallError::new("not-control", text)
                .expected("one of them")
                .found("both")
                .in_field(fields.weights));
        }
        Ok(())
    }

    /// Refuses knots, weights, breaks and spacings that the role of the points excludes.
    fn check_knots(&self, options: &DirectOptions<T>) -> Result<(), CallError> {
        let fields = &self.fields;
        let DirectOptions { role, own, .. } = options;
        let fitted = own.knots.is_some() || own.weights.is_some() || self.count.is_some();
        if *role == PointRole::Fit && fitted && !self.breaks.is_empty() {
            return Err(refused("breaks", fields.breaks, "a fit of all points without knots"));
        }
        if *role != PointRole::Fit && self.count.is_some() {
            return Err(refused("count", fields.count, "as = \"fit\""));
        }
        if *role == PointRole::Points && (own.knots.is_some() || own.weights.is_some()) {
            return Err(CallError::new(
                "not-control",
                "knots and weights are of control points and fits",
            )
            .expected("as = \"control\" or \"fit\"")
            .found("as = \"points\"")
            .in_field(if own.knots.is_some() { fields.knots } else { fields.weights }));
        }
        if *role != PointRole::Fit && !matches!(&*self.spacing, "auto" | "index") {
            return Err(refused(
                "spacing",
                fields.spacing,
                "as = \"fit\": the index is the parameter here",
            ));
        }
        Ok(())
    }

    /// Goal, motion, end conditions and parametrisation.
    fn intent(&self, context: &CurveContext<T>) -> Result<(Intent<T>, PointSpacing), CallError> {
        let fields = &self.fields;
        let motion = self.motion()?;
        constant("share", fields.share, self.share.into_iter())?;
        let share = self.share.map(|s| s.re());
        let goal = goal_of(&self.goal, share, context.budget, [fields.goal, fields.share])?;
        let kept = |word: &Option<Arc<str>>, field| -> Result<Option<EndContinuity>, CallError> {
            word.as_deref().map(|word| end(word, field)).transpose()
        };
        let first = kept(&self.ends, fields.ends)?;
        let last = kept(&self.last_end, fields.last_end)?.or(first);
        let ends = [first, last].map(|e| match e {
            Some(e) if e.kept() > 0 => Some(e),
            e => context.least_end.or(e),
        });
        if !context.spacings.contains(&&*self.spacing) {
            return Err(unknown("spacing", &self.spacing, context.spacings, fields.spacing));
        }
        let spacing = match spacing(&self.spacing, fields.spacing)? {
            PointSpacing::Auto if !context.turns => PointSpacing::Given(ParameterSpacing::Chord),
            other => other,
        };
        let measure = self.measure.as_deref();
        let intent = Intent {
            tolerance: self.tolerance,
            degree: self.degree,
            closed: self.closed,
            measure: measure.map(|word| super::measure(word, fields.measure)).transpose()?,
            ends,
            breaks: self.breaks.clone(),
            spacing: match spacing {
                PointSpacing::Given(spacing) => spacing,
                _ => ParameterSpacing::Chord,
            },
            goal,
            motion,
        };
        Ok((intent, spacing))
    }

    pub fn motion(&self) -> Result<Motion, CallError> {
        let fields = [self.fields.along, self.fields.motion];
        super::motion(self.along, self.motion.as_deref(), fields)
    }

    /// `None`: not given; `Some(None)`: "data"; otherwise a bound of control points.
    #[expect(clippy::option_option, reason = "not given, the data, or a bound of control points")]
    fn bound(&self) -> Result<Option<Option<Bound>>, CallError> {
        Ok(match self.bound.as_deref() {
            None => None,
            Some("data") => Some(None),
            Some("points") => Some(Some(Bound::ControlPoints)),
            Some("curve") => Some(Some(Bound::Bezier)),
            Some(word) => {
                return Err(unknown(
                    "bound",
                    word,
                    &["data", "points", "curve"],
                    self.fields.bound,
                ));
            }
        })
    }

    fn method(&self) -> Result<CurveMethod, CallError> {
        let fields = &self.fields;
        constant("least_move, least_drop, stop_gap", fields.stops, self.stops.into_iter())?;
        let [least_move, least_drop, gap] = self.stops.map(|x| x.re());
        let steps = |rule, step| {
            let mut options = KnotRemovalOptions::faithful(0);
            (options.rule, options.step) = (rule, step);
            let pieces = self.stop_pieces;
            options.stops = Stops { steps: 0, least_move, least_drop, gap, pieces };
            CurveMethod::Steps(options, self.steps)
        };
        Ok(match &*self.mode {
            "optimum" => CurveMethod::Optimum,
            "faithful" => steps(Rule::Achievable, RemovalStep::Knot),
            "literal" => steps(Rule::Literal, RemovalStep::Knot),
            "vertex" => steps(Rule::Achievable, RemovalStep::Vertex),
            "sweeps" => CurveMethod::Sweeps(self.steps.unwrap_or(SWEEPS)),
            "levels" => CurveMethod::Levels(self.steps.unwrap_or(CYCLES)),
            word => return Err(unknown("mode", word, &MODES, fields.mode)),
        })
    }

    fn own(&self) -> Result<GivenKnots, CallError> {
        let fields = &self.fields;
        let list = |what, x: &Option<Vec<T>>, field| -> Result<Option<Vec<f64>>, CallError> {
            constant(what, field, x.iter().flatten().copied())?;
            Ok(x.as_ref().map(|x| x.iter().map(|x| x.re()).collect()))
        };
        constant("period", fields.period, self.period.into_iter())?;
        if self.period.is_some() && !(self.closed && self.knots.is_some()) {
            return Err(CallError::new(
                "other-mode",
                "`period` is that of knots of a closed curve",
            )
            .expected("closed = 1, knots = {...}")
            .in_field(fields.period));
        }
        Ok(GivenKnots {
            knots: list("knots", &self.knots, fields.knots)?,
            weights: list("weights", &self.weights, fields.weights)?,
            period: self.period.map(|p| p.re()),
        })
    }

    /// Conditions on a curve near its points.
    fn demands(&self, n: usize, context: &CurveContext<T>) -> Result<Demands<T>, CallError> {
        let fields = &self.fields;
        let shape = shapes_of(self.shape.as_deref(), n, fields.shape)?;
        one_each("tolerances", self.tolerances.as_deref(), n, fields.tolerances)?;
        one_each("parameters", self.at.as_deref(), n, fields.at)?;
        if let Some(k) =
            self.tolerances.iter().flatten().position(|t| t.re() < 0.0 || t.re().is_nan())
        {
            return Err(CallError::new("out-of-range", "a tolerance is negative")
                .expected("0 or more")
                .in_item(k)
                .in_field(fields.tolerances));
        }
        let rises = |w: &[T]| w[0].re() < w[1].re();
        if let Some(k) = self.at.as_deref().and_then(|at| at.windows(2).position(|w| !rises(w))) {
            return Err(CallError::new("out-of-range", "parameters rise from point to point")
                .in_item(k + 1)
                .in_field(fields.at));
        }
        let mut conditions = Vec::new();
        let tangents: Vec<Vec3<T>> = self.tangents.iter().flatten().copied().collect();
        if let Some(k) = tangents.iter().position(|d| d.re().norm() == 0.0) {
            return Err(CallError::new("zero-direction", "the direction has no length")
                .in_item(k)
                .in_field(fields.tangents));
        }
        let placed = [
            ("through", &context.through, &self.through_at, fields.through, false),
            ("tangents", &tangents, &self.tangents_at, fields.tangents, true),
        ];
        for (what, values, at, field, direction) in placed {
            let at = at.as_deref().unwrap_or_default();
            if at.len() != values.len() {
                let message = format!("`{what}` has a parameter for each");
                return Err(CallError::new("wrong-count", message)
                    .expected(format!("{} parameters", values.len()))
                    .found(at.len().to_string())
                    .in_field(field));
            }
            for (k, (v, t)) in values.iter().zip(at).enumerate() {
                constant(what, field, v.to_array().into_iter().chain([*t]))
                    .map_err(|fault| fault.in_item(k))?;
                if !(0.0..=1.0).contains(&t.re()) {
                    return Err(CallError::new("out-of-range", "a parameter is out of range")
                        .expected("0 to 1")
                        .found(t.re().to_string())
                        .in_item(k)
                        .in_field(field));
                }
                let v = *v;
                conditions.push((
                    t.re(),
                    if direction { Demand::Tangent(v) } else { Demand::Through(v) },
                ));
            }
        }
        conditions.extend(context.keep.iter().map(|&what| (0.0, what)));
        Ok(Demands {
            shape,
            conditions,
            tolerances: self.tolerances.clone(),
            fixed: self.fixed.clone(),
            release: self.release.clone().unwrap_or_default(),
            bends: self.bends,
            at: self.at.clone(),
        })
    }

    /// The first given option that only curves near their points accept.
    fn near_only(&self, role: PointRole) -> Option<(&'static str, FieldId)> {
        let fields = &self.fields;
        let given = [
            (self.shape.is_some(), "shape", fields.shape),
            // `fixed` numbers control points in other roles.
            (role == PointRole::Fit && !self.fixed.is_empty(), "fixed", fields.fixed),
            (self.release.is_some(), "release", fields.release),
            (self.bends, "bends", fields.bends),
            (self.at.is_some(), "at", fields.at),
            (&*self.spacing == "curvature", "spacing \"curvature\"", fields.spacing),
        ];
        given.into_iter().find(|g| g.0).map(|g| (g.1, g.2))
    }

    /// The first given option of single steps.
    fn stepwise_only(&self) -> Option<(&'static str, FieldId)> {
        let fields = &self.fields;
        let stops = self.stops.iter().any(|x| x.re() != 0.0) || self.stop_pieces;
        let given = [
            (stops, "least_move, least_drop, stop_gap or stop_pieces", fields.stops),
            (self.steps.is_some(), "steps", fields.steps),
        ];
        given.into_iter().find(|g| g.0).map(|g| (g.1, g.2))
    }

    fn not_near(&self, what: &str, field: FieldId) -> CallError {
        CallError::new("not-near", format!("`{what}` is for curves near their points"))
            .expected(
                "as = \"fit\", mode = \"optimum\", without knots, weights, count and another bound",
            )
            .in_field(field)
    }

    fn elsewhere(&self, what: &str, field: FieldId, expected: &'static str) -> CallError {
        CallError::new("other-mode", format!("`{what}` is for another mode"))
            .expected(expected)
            .found(format!("mode = \"{}\"", self.mode))
            .in_field(field)
    }

    /// Converts an error to one at its argument.
    fn unmade(&self, error: FairError) -> CallError {
        let fields = &self.fields;
        let places = ArgumentFields {
            points: fields.points,
            tolerance: fields.tolerance,
            degree: fields.degree,
            breaks: fields.breaks,
        };
        let text = error.to_string();
        match error {
            FairError::Weight { .. } | FairError::Count { what: "weights", .. } => {
                CallError::new("bad-weight", text).in_field(fields.weights)
            }
            FairError::Unsorted { .. }
            | FairError::Knots(_)
            | FairError::Count { what: "knots" | "knots at most", .. } => {
                CallError::new("bad-knots", text).in_field(fields.knots)
            }
            FairError::TurnsAlong { index } => {
                CallError::new("runs-back", text).in_item(index).in_field(fields.spacing)
            }
            FairError::OutOfReach { index, .. } => {
                CallError::new("not-faired", text).in_item(index).in_field(fields.points)
            }
            FairError::Goal(_) => CallError::new("no-goal", text).in_field(fields.goal),
            FairError::Energy { .. } => CallError::new("no-goal", text).in_field(fields.share),
            FairError::Squares => CallError::new("other-mode", text)
                .expected("mode = \"optimum\"")
                .in_field(fields.measure),
            FairError::Shape { shapes, miss } => {
                let message = format!(
                    "no curve with this shape was found within the tolerance (missed by {miss:.3e})"
                );
                let fault = CallError::new("no-shape", message);
                shapes.first().map_or(fault.clone(), |&k| fault.in_item(k)).in_field(fields.shape)
            }
            FairError::Shapeless { shape, why } => {
                CallError::new("no-shape", why).in_item(shape).in_field(fields.shape)
            }
            other => fault(other, &places),
        }
    }
}
