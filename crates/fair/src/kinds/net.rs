//! `FairNet` and `NetCurve`: networks of curves that share points.

use super::figures::FairFigures;
use super::options::{constant, shared_options};
use super::shapes::{self, AnchoredSpline};
use super::{ArgumentFields, fault, measure};
use crate::curve::request::ACCURACY;
use crate::{
    Bound, EndContinuity, FairError, InterpolationSpace, Limit, NamedCurves, Network,
    NetworkCondition, NetworkCurve, ParameterSpacing, ShapeCondition, Space, are_exact,
    interpolate_with_corners, line_findings, parameters_across,
};
use moldloft_num::trace::Key;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{
    Build, CallError, Class, Context, CurveRef, FieldId, FromValue, Kind, Point, Value, many,
};
use moldloft_spline::SplineWithKnotDerivatives;
use std::sync::Arc;

/// The points of one curve of a network.
struct PointRow<T: Real>(Vec<Point<T>>);

impl<T: Real> FromValue<T> for PointRow<T> {
    const CLASS: Class = Class::Any;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        many(value).map(Self)
    }
}

shared_options! {
    {
        /// Curves with common points, faired together within a tolerance: stations, waterlines and
        /// buttocks of a hull.
        ///
        /// Each curve is a list of points; a point object in several lists is common to these
        /// curves (points with equal coordinates are not). All points move together, each at most
        /// by the tolerance, so that the sum of the measure over all curves is minimal; each curve
        /// then interpolates its moved points, so that intersections are preserved. A list that
        /// ends with its first point is a closed curve. The value is the list of the faired curves:
        /// `net[2]` is the second, `NetCurve` makes it an object. Options refer to curves by number,
        /// from 1.
        #[derive(Kind)]
        #[kind(
            forward,
            class = List,
            example = "AbsPoint A1(0, 0, 0); AbsPoint A2(1, 0.5, 0); AbsPoint A3(2, 0.83, 0); \
                       AbsPoint A4(3, 0.88, 0); AbsPoint A5(4, 1.02, 0); AbsPoint B2(1, 0.6, 1); \
                       AbsPoint C2(1, 0.72, 2); AbsPoint D2(1, 0.7, 3); AbsPoint E2(1, 0.66, 4); \
                       FairNet n({{A1, A2, A3, A4, A5}, {A2, B2, C2, D2, E2}}, 0.05); \
                       NetCurve waterline(n, 1); NetCurve station(n, 2);"
        )]
        pub struct FairNet<T: Real>
    }
    {
        /// Curves, each a list of at least degree + 2 points (closed: 2 degree + 2).
        #[field(min_items = 1)]
        curves: Vec<PointRow<T>>,
        /// Largest move of each point, in units of length; 0: unchanged.
        #[field(min = 0)]
        tolerance: T,
        /// Measure to minimise; see `FairCurve`.
        #[field(default = "second")]
        measure: Arc<str>,
        /// Intended breaks: these points do not move, nothing is smoothed across them, and the
        /// curves have corners there.
        #[field(default)]
        breaks: Option<Vec<Point<T>>>,
        /// Fixed ends of open curves: "corners" (ends of all curves through them), "ends" (all) or
        /// "none".
        #[field(default = "corners")]
        kept_ends: Arc<str>,
    }
    [along]
    {
        /// Polynomial degree.
        #[field(default = 3, min = 2, max = 9)]
        degree: usize,
        /// "optimum", or "faithful": curve after curve in the order of the list, by removal and
        /// re-insertion of knots, `steps` per point. The result of "faithful" depends on this order
        /// and may jump where two knots are equally bad.
        #[field(default = "optimum")]
        mode: Arc<str>,
        /// Passes of the mode "faithful".
        #[field(default = 1, min = 1, max = 100)]
        passes: usize,
        /// Parametrisation of the points of each curve; see `FairCurve`. A coordinate is used for
        /// the curves along which it is monotone, chord lengths for the others. The mode "faithful"
        /// uses "index".
        #[field(default = "chord")]
        spacing: Arc<str>,
    }
    [goal]
    [share]
    {
        /// Additional fixed points besides those of `kept_ends`.
        #[field(default)]
        fixed: Option<Vec<Point<T>>>,
        /// Tolerances of the points in `tolerances_at`, instead of `tolerance`.
        #[field(default)]
        tolerances: Option<Vec<T>>,
        /// The points with the tolerances of `tolerances`.
        #[field(default)]
        tolerances_at: Option<Vec<Point<T>>>,
        /// Steps per point of each curve and pass in the mode "faithful".
        #[field(default = 3, min = 1, max = 1000)]
        steps: usize,
        /// Quantity that the tolerance bounds: "points" (the move of each point) or "curve" (the
        /// distance of each curve from its initial one, by the smaller tolerance of the two
        /// neighbouring points).
        #[field(default = "points")]
        bound: Arc<str>,
        /// Exact shape conditions of curves, given by their numbers: "2: convex", "2:
        /// straight=3-9:1,0,0" (points from 1), "2..5 at 8..12: straight:1,0,0" (of each curve, its
        /// points on the others), "2..5 at 8..12: flat:0,1,0" (these in one plane), "3: arc=3-9"
        /// (on a circle, tangent to adjacent straight runs), "1: tangent=start:1,0,0". No
        /// derivatives.
        #[field(default)]
        shape: Option<Vec<Arc<str>>>,
        /// Numbers of curves, from 1, along which all curves that cross them break.
        #[field(default)]
        knuckles: Option<Vec<usize>>,
        /// Wrong points: they move to the curves through the others.
        #[field(default)]
        release: Option<Vec<Point<T>>>,
        /// "volume", and with it "centroid": preserved by splines through the sections, if points
        /// move along one direction. No derivatives.
        #[field(default)]
        keep: Option<Vec<Arc<str>>>,
    }
}

/// A network whose points are identified by object.
struct Joined<T: Real> {
    points: Vec<Point<T>>,
    /// For each curve, indices in `points` (the first point of a closed one not repeated), and
    /// whether it is closed.
    curves: Vec<(Vec<usize>, bool)>,
}

impl<T: Real> Joined<T> {
    fn of(rows: &[PointRow<T>]) -> Self {
        let mut points: Vec<Point<T>> = Vec::new();
        let mut known: Vec<(Key, usize)> = Vec::new();
        let mut place = |p: &Point<T>| {
            let found = p.key.and_then(|key| known.iter().find(|(k, _)| *k == key));
            if let Some(&(_, at)) = found {
                return at;
            }
            points.push(p.clone());
            known.extend(p.key.map(|key| (key, points.len() - 1)));
            points.len() - 1
        };
        let curve = |row: &PointRow<T>| {
            let mut own: Vec<usize> = row.0.iter().map(&mut place).collect();
            let closed = own.len() > 1 && own.first() == own.last();
            if closed {
                own.pop();
            }
            (own, closed)
        };
        let curves = rows.iter().map(curve).collect();
        Self { points, curves }
    }

    /// Indices of points in the network; `field` is the argument that lists them.
    fn places(
        &self,
        points: Option<&[Point<T>]>,
        what: &str,
        field: FieldId,
    ) -> Result<Vec<usize>, CallError> {
        let place = |(k, own): (usize, &Point<T>)| {
            let found = self.points.iter().position(|p| p.key.is_some() && p.key == own.key);
            found.ok_or_else(|| {
                CallError::new("not-a-parent", format!("{what} is not a point of the network"))
                    .expected("points in the lists of the curves")
                    .related(own.key, "is in none of them")
                    .in_item(k)
                    .in_field(field)
            })
        };
        points.unwrap_or_default().iter().enumerate().map(place).collect()
    }

    /// Curves by their numbers, from 1.
    fn numbers(&self, given: Option<&[usize]>, field: FieldId) -> Result<Vec<usize>, CallError> {
        let count = self.curves.len();
        let index = |(item, &k): (usize, &usize)| match k.checked_sub(1) {
            Some(at) if at < count => Ok(at),
            _ => Err(CallError::new("out-of-range", format!("there is no curve {k}"))
                .expected(format!("numbers of curves from 1 to {count}"))
                .found(k.to_string())
                .in_item(item)
                .in_field(field)),
        };
        given.unwrap_or_default().iter().enumerate().map(index).collect()
    }

    /// Indices of the fixed ends.
    fn kept(&self, which: &str) -> Result<Vec<usize>, CallError> {
        let mut ends = vec![0usize; self.points.len()];
        let mut uses = vec![0usize; self.points.len()];
        for (own, closed) in &self.curves {
            own.iter().for_each(|&i| uses[i] += 1);
            if let (false, [first, .., last]) = (closed, own.as_slice()) {
                ends[*first] += 1;
                ends[*last] += 1;
            }
        }
        let all = 0..self.points.len();
        Ok(match which {
            "none" => Vec::new(),
            "ends" => all.filter(|&i| ends[i] > 0).collect(),
            "corners" => all.filter(|&i| ends[i] > 0 && ends[i] == uses[i]).collect(),
            _ => {
                let known = ["corners", "ends", "none"];
                return Err(super::unknown(
                    "way to keep ends",
                    which,
                    &known,
                    FairNet::<f64>::KEPT_ENDS,
                ));
            }
        })
    }
}

impl<T: Real> FairNet<T> {
    /// The conditions of the network, each with its item and field in the arguments.
    fn conditions(&self, joined: &Joined<T>) -> Result<Vec<AskedCondition>, CallError> {
        let named = NamedCurves { curves: &joined.curves, names: &[] };
        let mut out = Vec::new();
        for (item, text) in self.shape.iter().flatten().enumerate() {
            let made = NetworkCondition::read(text, named).map_err(|why| {
                CallError::new("no-shape", why)
                    .found(text.to_string())
                    .in_item(item)
                    .in_field(Self::SHAPE)
            })?;
            out.extend(made.into_iter().map(|c| (c, item, Self::SHAPE)));
        }
        for (item, word) in self.keep.iter().flatten().enumerate() {
            let kept =
                NetworkCondition::kept(word, self.along.map(|d| d.re())).ok_or_else(|| {
                    super::unknown("quantity to keep", word, &["volume", "centroid"], Self::KEEP)
                        .in_item(item)
                })?;
            out.push((kept, item, Self::KEEP));
        }
        Ok(out)
    }
}

impl<T: Real> Build<T> for FairNet<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let joined = Joined::of(&self.curves);
        let marked = joined.places(self.breaks.as_deref(), "a break", Self::BREAKS)?;
        let fixed = joined.places(self.fixed.as_deref(), "a fixed point", Self::FIXED)?;
        let own_at = joined.places(
            self.tolerances_at.as_deref(),
            "a point with a tolerance of its own",
            Self::TOLERANCES_AT,
        )?;
        let own = self.tolerances.as_deref().unwrap_or_default();
        if own.len() != own_at.len() {
            return Err(CallError::new("wrong-count", "each of `tolerances_at` has a tolerance")
                .expected(format!("{} tolerances", own_at.len()))
                .found(own.len().to_string())
                .in_field(Self::TOLERANCES));
        }
        let mut tolerances = vec![self.tolerance; joined.points.len()];
        for (&i, &t) in own_at.iter().zip(own) {
            tolerances[i] = t;
        }
        let released = joined.places(self.release.as_deref(), "a released point", Self::RELEASE)?;
        for &i in &released {
            tolerances[i] = T::from(f64::INFINITY);
        }
        let degree = self.degree;
        let along = joined.numbers(self.knuckles.as_deref(), Self::KNUCKLES)?;
        let marks_of = |k: usize| -> Vec<usize> {
            let own = &joined.curves[k].0;
            let crossed =
                |i: &usize| along.iter().any(|&l| l != k && joined.curves[l].0.contains(i));
            (0..own.len()).filter(|&c| marked.contains(&own[c]) || crossed(&own[c])).collect()
        };
        let places = ArgumentFields {
            points: Self::CURVES,
            tolerance: Self::TOLERANCE,
            degree: Self::DEGREE,
            breaks: Self::BREAKS,
        };
        let spaced = super::plain_spacing(&self.spacing, Self::SPACING)?;
        let budget = if &*self.goal == "near" { super::NETWORK_BUDGET } else { super::BUDGET };
        constant("share", Self::SHARE, self.share.into_iter())?;
        let goal = super::goal_of(
            &self.goal,
            self.share.map(|s| s.re()),
            budget,
            [Self::GOAL, Self::SHARE],
        )?;
        let index =
            matches!(spaced, ParameterSpacing::Uniform) || super::faithful(&self.mode, Self::MODE)?;
        let motion =
            super::motion(self.along, self.motion.as_deref(), [Self::ALONG, Self::MOTION])?;
        let (mut strands, mut ats) = (Vec::new(), Vec::new());
        for (k, (own, closed)) in joined.curves.iter().enumerate() {
            let space = match (closed, own.len()) {
                (true, n) => Space::closed(degree, n),
                (false, n) if n < degree + 2 => {
                    Err(FairError::TooFew { expected: degree + 2, actual: n })
                }
                (false, n) => Space::floating(degree, n),
            };
            let space = space.map_err(|e| fault(e, &places).in_item(k).in_field(Self::CURVES))?;
            if let Some(twice) = (0..own.len()).find(|&i| own[..i].contains(&own[i])) {
                return Err(CallError::new("point-twice", "a curve passes twice through a point")
                    .expected("different points; only the first may come again, at the end")
                    .related(joined.points[own[twice]].key, "is listed twice")
                    .in_item(k)
                    .in_field(Self::CURVES));
            }
            let (marks, ends) = (marks_of(k), [EndContinuity::Points(0); 2]);
            let list: Vec<Vec3<T>> = own.iter().map(|&i| joined.points[i].xyz).collect();
            let radii: Vec<f64> = own.iter().map(|&i| tolerances[i].re()).collect();
            let limits = (motion, &radii[..]);
            let at = if index {
                None
            } else {
                let at = match parameters_across(&list, spaced, *closed, limits) {
                    Err(FairError::TurnsAlong { .. } | FairError::Coincident { .. })
                        if matches!(spaced, ParameterSpacing::Along(_)) =>
                    {
                        parameters_across(&list, ParameterSpacing::Chord, *closed, limits)
                    }
                    other => other,
                };
                Some(at.map_err(|e| fault(e, &places).in_item(k).in_field(Self::CURVES))?)
            };
            let plain = at.as_ref().map(|at| at.iter().map(|t| t.re()).collect());
            ats.push(at);
            strands.push(NetworkCurve {
                space,
                points: own.clone(),
                weights: None,
                marks,
                runs: Vec::new(),
                ends,
                at: plain,
            });
        }
        let measure = measure(&self.measure, Self::MEASURE)?;
        let passes = super::faithful(&self.mode, Self::MODE)?.then_some(self.passes);
        let known = matches!(goal, crate::Goal::Near(_) | crate::Goal::Fairest);
        if passes.is_some() && (!known || self.share.is_some()) {
            let (what, field) = if known { ("share", Self::SHARE) } else { ("goal", Self::GOAL) };
            return Err(CallError::new("other-mode", format!("`{what}` is for the optimum"))
                .expected("mode = \"optimum\"")
                .found("mode = \"faithful\"")
                .in_field(field));
        }
        let mut kept = joined.kept(&self.kept_ends)?;
        kept.extend(fixed.iter().filter(|i| !kept.contains(i)).copied().collect::<Vec<_>>());
        let mut still: Vec<bool> = tolerances.iter().map(|t| t.re() == 0.0).collect();
        kept.retain(|i| !released.contains(i));
        kept.iter().chain(&marked).for_each(|&i| still[i] = true);
        let wanted = self.conditions(&joined)?;
        let shaped = !wanted.is_empty();
        let bound = match &*self.bound {
            "points" => Bound::ControlPoints,
            "curve" => Bound::Bezier,
            other => return Err(super::unknown("bound", other, &["points", "curve"], Self::BOUND)),
        };
        if passes.is_some() && (shaped || bound != Bound::ControlPoints) {
            return Err(CallError::new("other-mode", "conditions and bounds are for the optimum")
                .expected("mode = \"optimum\"")
                .found("mode = \"faithful\"")
                .in_field(Self::MODE));
        }
        let xyz: Vec<Vec3<T>> = joined.points.iter().map(|p| p.xyz).collect();
        let mut fit = None;
        let solve = || -> Result<Vec<Vec3<T>>, FairError> {
            let limit = Limit::new(motion, tolerances.iter().map(|t| t.re()).collect())?;
            let plain = xyz.iter().map(|p| p.re()).collect();
            let mut network = Network::new(plain, strands, limit)?;
            network.kept = kept;
            network.bound = bound;
            if shaped {
                network = network.with_conditions(wanted.iter().map(|w| w.0.clone()).collect())?;
            }
            let near = matches!(goal, crate::Goal::Near(_));
            if index && near && !shaped && are_exact(&network.points, &joined.curves, &marked) {
                return Ok(xyz.clone());
            }
            if let Some(passes) = passes {
                return network.passes_with(passes, self.steps, &xyz, &tolerances);
            }
            let (points, own) =
                network.toward_with(measure, goal, ACCURACY, &xyz, &tolerances, &ats)?;
            fit = Some(own);
            Ok(points)
        };
        let moved = solve().map_err(|e| {
            let own = |k: usize| wanted.get(k).map_or((0, Self::SHAPE), |w| (w.1, w.2));
            let said = e.to_string();
            match e {
                FairError::Shapeless { shape, why } => {
                    let (item, field) = own(shape);
                    CallError::new("no-shape", why).in_item(item).in_field(field)
                }
                FairError::Shape { shapes, .. } => {
                    let (item, field) = own(shapes.first().copied().unwrap_or_default());
                    CallError::new("no-shape", said).in_item(item).in_field(field)
                }
                other => fault(other, &places),
            }
        })?;
        let figures = fit.map(|fit| {
            let plain: Vec<Vec3<f64>> = xyz.iter().map(|p| p.re()).collect();
            let found = line_findings(&plain, &joined.curves, &marked);
            let off: Vec<f64> =
                moved.iter().zip(&plain).map(|(p, q)| (p.re() - *q).norm()).collect();
            let free = |i: usize| if still[i] { 0.0 } else { tolerances[i].re() };
            let of = |own: &[usize], findings: usize| {
                let residuals: Vec<f64> = own.iter().map(|&i| off[i]).collect();
                let radii: Vec<f64> = own.iter().map(|&i| free(i)).collect();
                FairFigures::of_network(&fit, &residuals, &radii, findings)
            };
            let each = joined.curves.iter().enumerate();
            each.map(|(k, (own, _))| of(own, found.iter().filter(|f| f.0 == k).count()))
                .collect::<Vec<_>>()
        });
        let said = |curve: CurveRef<T>, k: usize| match &figures {
            Some(all) => curve.with_figures(&all[k].members()),
            None => curve,
        };
        let curve = |(k, (own, closed)): (usize, &(Vec<usize>, bool))| {
            let points: Vec<Vec3<T>> = own.iter().map(|&i| moved[i]).collect();
            // A moved end is not its point object any more.
            let end = |i: Option<&usize>| {
                i.filter(|&&i| !closed && still[i]).and_then(|&i| joined.points[i].key)
            };
            let ends = [end(own.first()), end(own.last())];
            let about = |e: FairError| fault(e, &places).in_item(k).in_field(Self::CURVES);
            if let Some(at) = &ats[k] {
                // The parameters of the given points are used, since the moved points are near
                // them.
                let sharp = (marks_of(k), runs_of(&wanted, k));
                let curve = through(degree, &points, at, &sharp, *closed).map_err(about)?;
                return Ok(Value::Curve(said(CurveRef::new(AnchoredSpline { curve, ends }, 0), k)));
            }
            let marks = marks_of(k);
            let sharp = interpolate_with_corners(
                degree,
                &points,
                ParameterSpacing::Uniform,
                *closed,
                &marks,
            )
            .map_err(about)?;
            let curve = shapes::curve(&sharp.fit.space, &sharp.points).map_err(|e| {
                CallError::new("no-spline", e.to_string()).in_item(k).in_field(Self::CURVES)
            })?;
            Ok(Value::Curve(said(CurveRef::new(AnchoredSpline { curve, ends }, 0), k)))
        };
        let curves: Result<Vec<_>, CallError> =
            joined.curves.iter().enumerate().map(curve).collect();
        Ok(Value::list(curves?))
    }
}

/// A condition with the item and the field that ask for it.
type AskedCondition = (NetworkCondition, usize, FieldId);

/// The straight runs of a curve.
fn runs_of(wanted: &[AskedCondition], k: usize) -> Vec<[usize; 2]> {
    let run = |asked: &AskedCondition| match &asked.0 {
        NetworkCondition::Curve { curve, shape: ShapeCondition::Straight { between, .. } }
            if *curve == k =>
        {
            Some(*between)
        }
        _ => None,
    };
    wanted.iter().filter_map(run).collect()
}

/// Interpolating spline; points and parameters may carry derivatives.
fn through<T: Real>(
    degree: usize,
    points: &[Vec3<T>],
    at: &[T],
    (breaks, runs): &(Vec<usize>, Vec<[usize; 2]>),
    closed: bool,
) -> Result<SplineWithKnotDerivatives<T>, FairError> {
    let real: Vec<f64> = at.iter().map(|t| t.re()).collect();
    let layout = if runs.is_empty() {
        InterpolationSpace::new(degree, &real, breaks, closed)?
    } else {
        InterpolationSpace::with_runs(&real, breaks, runs, closed)?
    };
    let (control, knots) = layout.through_moving(points, at)?;
    let (knots, control) = layout.space.open_form(&knots, &control);
    SplineWithKnotDerivatives::new(degree, Some(knots), control, None)
        .map_err(|_| FairError::Singular)
}

/// One curve of a faired network, as an object.
#[derive(Kind)]
#[kind(
    forward,
    class = Curve,
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0.52, 0); AbsPoint C(2, 0.83, 0); \
               AbsPoint D(3, 0.88, 0); AbsPoint E(4, 0.81, 0); \
               FairNet n({{A, B, C, D, E}}, 0.05); NetCurve c(n, 1);"
)]
pub struct NetCurve<T: Real> {
    /// A `FairNet`.
    net: Value<T>,
    /// Number of the curve in the network's list, from 1.
    #[field(min = 1)]
    index: usize,
}

impl<T: Real> Build<T> for NetCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Value::List(curves) = &self.net else {
            return Err(CallError::wrong_class(Class::List, self.net.class())
                .expected("a network of curves, such as a FairNet")
                .in_field(Self::NET));
        };
        match curves.get(self.index.wrapping_sub(1)) {
            Some(Value::Curve(curve)) => Ok(Value::Curve(curve.clone())),
            Some(other) => {
                Err(CallError::wrong_class(Class::Curve, other.class()).in_item(self.index - 1))
            }
            None => {
                Err(CallError::new("out-of-range", format!("there is no curve {}", self.index))
                    .expected(format!("a number from 1 to {}", curves.len()))
                    .found(self.index.to_string())
                    .in_field(Self::INDEX))
            }
        }
    }
}
