//! `FairCurve`: the faired spline of points.

use super::faired::{CurveContext, FairedSpline};
use super::options::{curve_options, shared_options};
use super::shapes::AnchoredSpline;
use crate::{Demand, FairError};
use moldloft_num::{Order, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, FieldId, Kind, Point, Value};
use std::sync::Arc;

shared_options! {
    {
        /// A fair B-spline curve within a tolerance of the one through its points.
        ///
        /// Of all splines with knots at the points that stay within the tolerance of each point, `goal` says
        /// which is taken; members say how it came out: `deviation` (the greatest distance of a point from it),
        /// `value` and `gap` (its measure, and how much less any other has at most), `active` (tolerances that
        /// are reached), `used` (squared residuals as a multiple of those of noise that fills the tolerance),
        /// `fairest_used` (the same of the fairest) and `findings` (points that do not fit their neighbours).
        /// Parameters and knots follow the points' spacing. Points that are as fair as the tolerance allows do
        /// not move. The result is continuous in the points. Points can be control points
        /// (`as = "control"`); these, curves that join others, the bounds "curve" and "points" and the modes of single steps
        /// move control points, and take the number of a point for its parameter, as the report of 1991 does, unless
        /// `spacing` names another. Their members are `deviation`
        /// (how far control points, or the points themselves, moved; of fits with `knots` or a `count` the greatest distance of a
        /// point), `value`, `gap`, of optima `active`, and of the others `steps`.
        /// Points on a line, conic, plane cubic or helix stay in any case, unless `goal` is "fairest". In mode "faithful" the
        /// worst knots are removed and re-inserted one after the other (Farin and Sapidis 1989), one step per
        /// point, and which knot comes first may change with the points.
        ///
        /// What Python has besides: `breaks` and `release` are numbers here, never "auto", so that a small move of a point makes no
        /// corner; `ends` are words; the log of single steps comes from the command (`moldloft fair model.sdl:name --log`);
        /// optima are solved to rounding, so that derivatives are known, and have no `accuracy`; a model's points are
        /// those that were read, so that there is no `original`.
        #[derive(Kind)]
        #[kind(
            class = Curve,
            example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0.52, 0); AbsPoint C(2, 0.83, 0); \
                       AbsPoint D(3, 0.88, 0); AbsPoint E(4, 0.81, 0); AbsPoint F(5, 0.49, 0); \
                       AbsPoint G(6, 0, 0); FairCurve c({A, B, C, D, E, F, G}, 0.05);"
        )]
        pub struct FairCurve<T: Real>
    }
    {
        /// Points, at least degree + 2 of them (closed: 2 degree + 2).
        #[field(min_items = 3)]
        points: Vec<Point<T>>,
        /// How far the curve may be from each of the points; 0 passes through all.
        #[field(min = 0)]
        tolerance: T,
        /// The measure to minimise: "second", "third", "jumps", "jump-lengths", "bending" or
        /// "variation". Without it "variation" of points that the curve is near ("bending" below degree 3), and "second"
        /// where control points move.
        #[field(default)]
        measure: Option<Arc<str>>,
        /// Meaning of the points: "fit" (the curve passes through them before it is faired), "control"
        /// (its control points) or "points" (they are faired and then interpolated: of optima the same as "fit" unless the
        /// spacing is "index").
        #[field(default = "fit")]
        r#as: Arc<str>,
        /// Numbers of points, from 1, that are intended breaks: they stay, and nothing is smoothed
        /// across them. A curve through its points has corners there; a closed one begins at the
        /// first of them.
        #[field(default)]
        breaks: Option<Vec<usize>>,
        /// What open ends keep of the curve through the points: "free" (within the tolerance), "position",
        /// "tangent", "curvature" or a number of control points. Without it "free" of points that the curve is near,
        /// "tangent" of fits whose control points move, and else "2".
        #[field(default)]
        ends: Option<Arc<str>>,
        /// "optimum", or steps of the report of 1991: "faithful" (knots removed and re-inserted, the longest
        /// achievable move first), "literal" (the largest jump first; may stall), "vertex" (one control point at a time
        /// to its own best place), "sweeps" (all points in order) or "levels" (waves of all lengths). The last two have no
        /// derivatives.
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
    }
    [knots]
    {
        /// How points get their parameters: "chord", "centripetal", a coordinate ("x", "y" or "z", for
        /// offsets at stations), "index", or "curvature" (lengths, longer where the curve turns). "auto" is
        /// "curvature" for the goals "near" and "budget" where nothing but these is asked for and ends keep no tangents,
        /// else "chord"; of single steps and joins "index".
        #[field(default = "auto")]
        spacing: Arc<str>,
    }
    [goal] [along] [share] [curve]
    {
        /// Points that the curve passes through at `through_at`. No derivatives.
        #[field(default)]
        through: Option<Vec<Point<T>>>,
        /// What it keeps of the curve before, to first order: "area" (swept about the origin in
        /// the plane of x and y), "volume" (of revolution about x) or "centroid" (of the control points). No derivatives.
        #[field(default)]
        keep: Option<Vec<Arc<str>>>,
    }
}

/// Ends within this share of the curve's extent are one place.
const TOGETHER: f64 = 1e-9;

/// The field of the joins.
const JOINS: FieldId = FairCurve::<f64>::JOINS;

/// The ways in which points of curves get parameters.
const SPACINGS: [&str; 8] = ["auto", "chord", "centripetal", "x", "y", "z", "index", "curvature"];

impl<T: Real> FairCurve<T> {
    /// What the curve keeps.
    fn kept(&self) -> Result<Vec<Demand>, CallError> {
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
        if &*self.mode != "optimum" {
            return Err(only("is an optimum", &format!("mode = \"{}\"", self.mode)));
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
fn unjoined(error: &FairError, joins: [Option<usize>; 2]) -> Option<CallError> {
    let present: Vec<usize> = joins.iter().flatten().copied().collect();
    let about = |k: Option<&usize>, id: &'static str, message: String| {
        let fault = CallError::new(id, message);
        k.map_or(fault.clone(), |&k| fault.in_item(k)).in_field(JOINS)
    };
    Some(match error {
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
        _ => return None,
    })
}

impl<T: Real> Build<T> for FairCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let neighbours = self.neighbours()?;
        let options = curve_options!(self, POINTS);
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
        let unmade = |error: &FairError| unjoined(error, joins);
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
