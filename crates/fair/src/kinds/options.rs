//! Arguments that several kinds share, each declared once.
//!
//! `shared_options!` makes the struct of a kind from its own fields and from groups, named in
//! brackets: an argument has one name, one default and one text in all kinds.

use moldloft_num::{Real, Vec3};
use moldloft_registry::{CallError, FieldId};
use std::sync::Arc;

/// A kind with its own fields in braces and groups of shared fields in brackets.
macro_rules! shared_options {
    (@ {$($head:tt)*} {$($done:tt)*} {$($own:tt)*} $($rest:tt)*) => {
        $crate::kinds::options::shared_options!(@ {$($head)*} {$($done)* $($own)*} $($rest)*);
    };
    (@ {$($head:tt)*} {$($done:tt)*} [knots] $($rest:tt)*) => {
        $crate::kinds::options::shared_options!(@ {$($head)*} {$($done)*
            /// Positive weights of the control points, constant (`as = "control"`, or a fit with as
            /// many control points as points): the curve is rational. No derivatives with respect
            /// to them.
            #[field(default)]
            weights: Option<Vec<T>>,
            /// Knots of the control points (`as = "control"`) or of a fit, constant. Open: number
            /// of control points + degree + 1, non-decreasing; closed: number of control points,
            /// increasing. In a fit they determine the number of control points.
            #[field(default)]
            knots: Option<Vec<T>>,
        } $($rest)*);
    };
    (@ {$($head:tt)*} {$($done:tt)*} [goal] $($rest:tt)*) => {
        $crate::kinds::options::shared_options!(@ {$($head)*} {$($done)*
            /// Selects the result within the tolerance: "near" (residuals up to the level of noise
            /// that fills the tolerance; data with little to gain do not move), "budget" (the same,
            /// without the exception), "fairest" (minimum of the measure), "nearest" (nearest to
            /// the points with a measure at most `share` above the minimum), "energy" (nearest with
            /// a measure of at most `share`) or, for curves, "closest" (nearest with the given
            /// `shape`).
            #[field(default = "near")]
            goal: Arc<str>,
        } $($rest)*);
    };
    (@ {$($head:tt)*} {$($done:tt)*} [share] $($rest:tt)*) => {
        $crate::kinds::options::shared_options!(@ {$($head)*} {$($done)*
            /// Parameter of the goal. "near" and "budget": mean squared residual relative to noise
            /// that fills the tolerance; default 0.5 for plane curves with free motion, otherwise
            /// 0.8; 0.3 for networks that noise does not explain ("budget": 0.8). "nearest":
            /// relative excess of the measure, default 0.1. "energy": the largest measure,
            /// required.
            #[field(default)]
            share: Option<T>,
        } $($rest)*);
    };
    (@ {$($head:tt)*} {$($done:tt)*} [along] $($rest:tt)*) => {
        $crate::kinds::options::shared_options!(@ {$($head)*} {$($done)*
            /// Direction in which points may move, such as {0, 1, 0} for offsets at fixed stations.
            /// Default: any direction.
            #[field(default)]
            along: Option<Vec3<T>>,
            /// "across" (points move in the plane perpendicular to `along`) or "box" (each
            /// coordinate is bounded separately). Default: along `along`, or in any direction
            /// without it.
            #[field(default)]
            motion: Option<Arc<str>>,
        } $($rest)*);
    };
    (@ {$($head:tt)*} {$($done:tt)*} [curve] $($rest:tt)*) => {
        $crate::kinds::options::shared_options!(@ {$($head)*} {$($done)*
            /// Shape conditions, with numbers of points from 1: "convex=4-10", "concave=1-4",
            /// "one-way=1-9" (no inflection), "straight=1-9", "straight=1-9:0,1" (in a direction),
            /// "arc=9-15", "pieces=2" (number of pieces with monotone curvature), "within=0,1:4.6"
            /// (largest coordinate along a direction), "side=0,-1" (points may be left only against
            /// this direction). A word without numbers applies to the whole curve. No derivatives.
            #[field(default)]
            shape: Option<Vec<Arc<str>>>,
            /// Tolerances of the individual points, instead of `tolerance`.
            #[field(default)]
            tolerances: Option<Vec<T>>,
            /// Numbers, from 1, of points that do not move.
            #[field(default)]
            fixed: Option<Vec<usize>>,
            /// Numbers, from 1, of faulty points: the curve may leave them.
            #[field(default)]
            release: Option<Vec<usize>>,
            /// Parameters of `through`, from 0 to 1.
            #[field(default)]
            through_at: Option<Vec<T>>,
            /// Tangent directions at `tangents_at`. No derivatives.
            #[field(default)]
            tangents: Option<Vec<Vec3<T>>>,
            /// Parameters of `tangents`, from 0 to 1.
            #[field(default)]
            tangents_at: Option<Vec<T>>,
            /// 1 allows more inflections and monotone pieces of curvature than the fairest curve
            /// within the tolerances has; 0 removes them. With 0, derivatives exist where there is
            /// nothing to remove.
            #[field(default = 0, min = 0, max = 1)]
            bends: usize,
            /// Parameters of the individual points, increasing, instead of `spacing` (closed:
            /// within a range of less than 1).
            #[field(default)]
            at: Option<Vec<T>>,
            /// Condition at the end, if different from the start (`ends`).
            #[field(default)]
            last_end: Option<Arc<str>>,
            /// Quantity that the tolerance bounds: "data" (distance of each point from the curve;
            /// default for optima of data), "curve" (distance of the curve from the initial one,
            /// everywhere; default for other fits) or "points" (move of each control point; default
            /// for control points). "curve" and "points" have derivatives if the parameters are
            /// constant (`spacing = "index"`).
            #[field(default)]
            bound: Option<Arc<str>>,
            /// Number of control points of a least-squares fit, less than the number of points. No
            /// derivatives.
            #[field(default, min = 3)]
            count: Option<usize>,
            /// Period of the `knots` of a closed curve. Default: 1.
            #[field(default)]
            period: Option<T>,
            /// Number of steps in the modes "faithful", "literal" and "vertex" (default: one per
            /// point), of sweeps (10) or of multilevel cycles (2).
            #[field(default, min = 0, max = 10_000_000)]
            steps: Option<usize>,
            /// Single steps stop when the next move is shorter than this fraction of the tolerance;
            /// 0: never.
            #[field(default = 0, min = 0)]
            least_move: T,
            /// Single steps stop when a step reduces the measure by less than this fraction; 0:
            /// never.
            #[field(default = 0, min = 0)]
            least_drop: T,
            /// Single steps stop when the certified gap is below this fraction of the measure; 0:
            /// never.
            #[field(default = 0, min = 0)]
            stop_gap: T,
            /// 1: single steps stop when the number of pieces with monotone curvature has not
            /// decreased for n steps, with n the number of points.
            #[field(default = 0, min = 0, max = 1)]
            stop_pieces: usize,
        } $($rest)*);
    };
    (@ {$($head:tt)*} {$($done:tt)*}) => {
        $($head)* { $($done)* }
    };
    ({$($head:tt)*} $($rest:tt)*) => {
        $crate::kinds::options::shared_options!(@ {$($head)*} {} $($rest)*);
    };
}
pub(crate) use shared_options;

/// Fields of the arguments, for errors.
#[derive(Clone, Copy)]
pub(crate) struct CurveFields {
    pub points: FieldId,
    pub tolerance: FieldId,
    pub measure: FieldId,
    pub role: FieldId,
    pub breaks: FieldId,
    pub ends: FieldId,
    pub mode: FieldId,
    pub degree: FieldId,
    pub spacing: FieldId,
    pub weights: FieldId,
    pub knots: FieldId,
    pub goal: FieldId,
    pub share: FieldId,
    pub along: FieldId,
    pub shape: FieldId,
    pub tolerances: FieldId,
    pub fixed: FieldId,
    pub release: FieldId,
    pub through: FieldId,
    pub tangents: FieldId,
    pub bends: FieldId,
    pub at: FieldId,
    pub motion: FieldId,
    pub last_end: FieldId,
    pub bound: FieldId,
    pub count: FieldId,
    pub period: FieldId,
    pub steps: FieldId,
    pub stops: FieldId,
}

/// Arguments of both curves and snakes.
pub(crate) struct CurveOptions<T> {
    pub fields: CurveFields,
    pub tolerance: T,
    pub measure: Option<Arc<str>>,
    pub role: Option<Arc<str>>,
    pub breaks: Vec<usize>,
    pub ends: Option<Arc<str>>,
    pub last_end: Option<Arc<str>>,
    pub mode: Arc<str>,
    pub degree: usize,
    pub closed: bool,
    pub spacing: Arc<str>,
    pub weights: Option<Vec<T>>,
    pub knots: Option<Vec<T>>,
    pub period: Option<T>,
    pub goal: Arc<str>,
    pub share: Option<T>,
    pub along: Option<Vec3<T>>,
    pub motion: Option<Arc<str>>,
    pub shape: Option<Vec<Arc<str>>>,
    pub tolerances: Option<Vec<T>>,
    pub fixed: Vec<usize>,
    pub release: Option<Vec<usize>>,
    pub through_at: Option<Vec<T>>,
    pub tangents: Option<Vec<Vec3<T>>>,
    pub tangents_at: Option<Vec<T>>,
    pub bends: bool,
    pub at: Option<Vec<T>>,
    pub bound: Option<Arc<str>>,
    pub count: Option<usize>,
    pub steps: Option<usize>,
    /// `least_move`, `least_drop` and `stop_gap`.
    pub stops: [T; 3],
    pub stop_pieces: bool,
}

/// Options of a kind made by `shared_options!` with the groups of curves.
macro_rules! curve_options {
    ($this:expr, $points:ident) => {
        $crate::kinds::options::CurveOptions {
            fields: $crate::kinds::options::CurveFields {
                points: Self::$points,
                tolerance: Self::TOLERANCE,
                measure: Self::MEASURE,
                role: Self::AS,
                breaks: Self::BREAKS,
                ends: Self::ENDS,
                mode: Self::MODE,
                degree: Self::DEGREE,
                spacing: Self::SPACING,
                weights: Self::WEIGHTS,
                knots: Self::KNOTS,
                goal: Self::GOAL,
                share: Self::SHARE,
                along: Self::ALONG,
                shape: Self::SHAPE,
                tolerances: Self::TOLERANCES,
                fixed: Self::FIXED,
                release: Self::RELEASE,
                through: Self::THROUGH,
                tangents: Self::TANGENTS,
                bends: Self::BENDS,
                at: Self::AT,
                motion: Self::MOTION,
                last_end: Self::LAST_END,
                bound: Self::BOUND,
                count: Self::COUNT,
                period: Self::PERIOD,
                steps: Self::STEPS,
                stops: Self::LEAST_MOVE,
            },
            tolerance: $this.tolerance,
            measure: $this.measure.clone(),
            role: $this.r#as.clone(),
            breaks: $this.breaks.clone().unwrap_or_default(),
            ends: $this.ends.clone(),
            last_end: $this.last_end.clone(),
            mode: $this.mode.clone(),
            degree: $this.degree,
            closed: $this.closed == 1,
            spacing: $this.spacing.clone(),
            weights: $this.weights.clone(),
            knots: $this.knots.clone(),
            period: $this.period,
            goal: $this.goal.clone(),
            share: $this.share,
            along: $this.along,
            motion: $this.motion.clone(),
            shape: $this.shape.clone(),
            tolerances: $this.tolerances.clone(),
            fixed: $this.fixed.clone().unwrap_or_default(),
            release: $this.release.clone(),
            through_at: $this.through_at.clone(),
            tangents: $this.tangents.clone(),
            tangents_at: $this.tangents_at.clone(),
            bends: $this.bends == 1,
            at: $this.at.clone(),
            bound: $this.bound.clone(),
            count: $this.count,
            steps: $this.steps,
            stops: [$this.least_move, $this.least_drop, $this.stop_gap],
            stop_pieces: $this.stop_pieces == 1,
        }
    };
}
pub(crate) use curve_options;

/// Refuses derivatives with respect to a constant argument.
pub(crate) fn constant<T: Real>(
    what: &'static str,
    field: FieldId,
    mut numbers: impl Iterator<Item = T>,
) -> Result<(), CallError> {
    if numbers.all(|x| x.is_constant()) {
        return Ok(());
    }
    Err(CallError::new(
        "no-derivative",
        format!("no derivatives with respect to `{what}` are available"),
    )
    .expected("a constant")
    .found(what)
    .in_field(field))
}
