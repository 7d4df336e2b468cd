//! The arguments that several kinds share, each declared once.
//!
//! `shared_options!` makes the struct of a kind from its own fields and from groups, which stand in
//! brackets where their fields are to be: an argument has one name, one default and one text wherever it is.

use moldloft_num::{Real, Vec3};
use moldloft_registry::{CallError, FieldId};
use std::sync::Arc;

/// A kind whose fields are its own, between braces, and those of groups, between brackets.
macro_rules! shared_options {
    (@ {$($head:tt)*} {$($done:tt)*} {$($own:tt)*} $($rest:tt)*) => {
        $crate::kinds::options::shared_options!(@ {$($head)*} {$($done)* $($own)*} $($rest)*);
    };
    (@ {$($head:tt)*} {$($done:tt)*} [knots] $($rest:tt)*) => {
        $crate::kinds::options::shared_options!(@ {$($head)*} {$($done)*
            /// Positive weights of the control points (`as = "control"`, or of a fit with as many points), which make
            /// it rational and stay as they are. They count as constants: derivatives do not go through them.
            #[field(default)]
            weights: Option<Vec<T>>,
            /// Knots of the control points (`as = "control"`) or of a fit, whose number gives that of the control
            /// points: degree + 1 more, non-decreasing; of a closed curve as many, increasing. Constants too.
            #[field(default)]
            knots: Option<Vec<T>>,
        } $($rest)*);
    };
    (@ {$($head:tt)*} {$($done:tt)*} [goal] $($rest:tt)*) => {
        $crate::kinds::options::shared_options!(@ {$($head)*} {$($done)*
            /// Which of the results within the tolerance: "near" (no fairer than noise of the tolerance's size
            /// asks for, and unmoved where there is little to gain), "budget" (the same, moved in any case),
            /// "fairest", "nearest" (the nearest to the points that measures little more than the fairest),
            /// "energy" (the nearest that measures at most `share`) or, of curves, "closest" (the nearest of the
            /// `shape`).
            #[field(default = "near")]
            goal: Arc<str>,
        } $($rest)*);
    };
    (@ {$($head:tt)*} {$($done:tt)*} [share] $($rest:tt)*) => {
        $crate::kinds::options::shared_options!(@ {$($head)*} {$($done)*
            /// The share of the goals "near" (0.5 of free plane curves, 0.8 of others, 0.3 of networks that noise
            /// does not explain), "budget" (the same, networks 0.8) and "nearest" (0.1), or the measure of "energy".
            #[field(default)]
            share: Option<T>,
        } $($rest)*);
    };
    (@ {$($head:tt)*} {$($done:tt)*} [along] $($rest:tt)*) => {
        $crate::kinds::options::shared_options!(@ {$($head)*} {$($done)*
            /// The direction in which points may be left, such as {0, 1, 0} for offsets at fixed stations; any
            /// direction without it.
            #[field(default)]
            along: Option<Vec3<T>>,
            /// "across" (points stay in the plane across `along`) or "box" (each coordinate is limited by itself);
            /// without it points move along `along`, or in any direction.
            #[field(default)]
            motion: Option<Arc<str>>,
        } $($rest)*);
    };
    (@ {$($head:tt)*} {$($done:tt)*} [curve] $($rest:tt)*) => {
        $crate::kinds::options::shared_options!(@ {$($head)*} {$($done)*
            /// The shape that it has to have, points from 1: "convex=4-10", "concave=1-4", "one-way=1-9"
            /// (no inflection), "straight=1-9", "straight=1-9:0,1" (in a direction), "arc=9-15", "pieces=2" (of
            /// monotone curvature), "within=0,1:4.6" (the largest value along a direction), "side=0,-1" (the
            /// points are left only against it). A word alone is about the whole curve. No derivatives.
            #[field(default)]
            shape: Option<Vec<Arc<str>>>,
            /// Tolerances of the points one by one, instead of `tolerance`.
            #[field(default)]
            tolerances: Option<Vec<T>>,
            /// Numbers of points, from 1, through which it passes.
            #[field(default)]
            fixed: Option<Vec<usize>>,
            /// Numbers of points, from 1, that are wrong: they may be left.
            #[field(default)]
            release: Option<Vec<usize>>,
            /// Parameters, from 0 to 1, of `through`.
            #[field(default)]
            through_at: Option<Vec<T>>,
            /// Directions that it has at `tangents_at`. No derivatives.
            #[field(default)]
            tangents: Option<Vec<Vec3<T>>>,
            /// Parameters, from 0 to 1, of `tangents`.
            #[field(default)]
            tangents_at: Option<Vec<T>>,
            /// 1 to allow more inflections and monotone pieces of the curvature than the fairest within the tolerances has.
            /// With 0 derivatives are known where none had to be taken away.
            #[field(default = 0, min = 0, max = 1)]
            bends: usize,
            /// Parameters of the points one by one, instead of `spacing`: rising numbers (of a closed curve less than
            /// 1 apart).
            #[field(default)]
            at: Option<Vec<T>>,
            /// What the end keeps, if it is something else than the start (`ends`).
            #[field(default)]
            last_end: Option<Arc<str>>,
            /// What the tolerance bounds: "data", the distance of each point (the default of fits); "curve", that of
            /// the curve from the one before, everywhere (the default of control points); "points", the move of
            /// each control point. "curve" and "points" have derivatives where parameters do not follow the points
            /// (`spacing = "index"`).
            #[field(default)]
            bound: Option<Arc<str>>,
            /// Control points of a fit by least squares, fewer than points; no derivatives.
            #[field(default, min = 3)]
            count: Option<usize>,
            /// How far the first knot of a closed curve with `knots` is from itself, once round (1).
            #[field(default)]
            period: Option<T>,
            /// Steps of the modes "faithful", "literal" and "vertex" (one per point), sweeps (10) or cycles of
            /// levels (2).
            #[field(default, min = 0, max = 10_000_000)]
            steps: Option<usize>,
            /// Single steps end when a move is shorter than this share of the tolerance.
            #[field(default = 0, min = 0)]
            least_move: T,
            /// Single steps end when one lowers the measure by less than this share.
            #[field(default = 0, min = 0)]
            least_drop: T,
            /// Single steps end when the certified gap is below this share of the measure.
            #[field(default = 0, min = 0)]
            stop_gap: T,
            /// 1 to end single steps when as many as there are points bring no fewer monotone pieces of curvature.
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

/// The fields of a kind's arguments, for faults.
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

/// The arguments that curves and snakes have in common.
pub(crate) struct CurveOptions<T> {
    pub fields: CurveFields,
    pub tolerance: T,
    pub measure: Option<Arc<str>>,
    pub role: Arc<str>,
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
    /// Least move, least drop, and the gap at which single steps end.
    pub stops: [T; 3],
    pub stop_pieces: bool,
}

/// The options of a kind that was made by `shared_options!` with the groups of curves.
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

/// Refuses derivatives by an argument that stays as it is.
pub(crate) fn constant<T: Real>(
    what: &'static str,
    field: FieldId,
    mut numbers: impl Iterator<Item = T>,
) -> Result<(), CallError> {
    if numbers.all(|x| x.is_constant()) {
        return Ok(());
    }
    Err(CallError::new("no-derivative", format!("derivatives by `{what}` are not known"))
        .expected("a constant")
        .found(what)
        .in_field(field))
}
