//! `FairNet` and `NetCurve`: networks of curves that share points.

use super::figures::FairFigures;
use super::options::{constant, shared_options};
use super::shapes::{self, AnchoredSpline};
use super::{ArgumentFields, fault, measure};
use crate::curve::request::ACCURACY;
use crate::{
    Bound, EndContinuity, FairError, Goal, InterpolationSpace, Limit, Measure, Motion, NamedCurves,
    Network, NetworkCondition, NetworkCurve, NetworkFit, ParameterSpacing, ShapeCondition, Space,
    are_exact, interpolate_with_corners, line_findings, parameters_across,
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

    /// Breaks of curve `k` among its own points: those of the network, and crossings with the curves
    /// `along`.
    fn marks(&self, k: usize, marked: &[usize], along: &[usize]) -> Vec<usize> {
        let own = &self.curves[k].0;
        let crossed = |i: &usize| along.iter().any(|&l| l != k && self.curves[l].0.contains(i));
        (0..own.len()).filter(|&c| marked.contains(&own[c]) || crossed(&own[c])).collect()
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
        let task = self.task()?;
        let numbers = 0..task.joined.curves.len();
        let strands: Result<Vec<_>, CallError> = numbers.clone().map(|k| task.strand(k)).collect();
        let (strands, ats): (Vec<_>, Vec<_>) = strands?.into_iter().unzip();
        let (moved, fit) = task.moved(strands, &ats).map_err(|e| task.unmade(e))?;
        let figures = fit.map(|fit| task.figures(&fit, &moved));
        let curve = |k: usize| {
            let curve = task.curve(k, ats[k].as_deref(), &moved)?;
            Ok(Value::Curve(match &figures {
                Some(all) => curve.with_figures(&all[k].members()),
                None => curve,
            }))
        };
        let curves: Result<Vec<_>, CallError> = numbers.map(curve).collect();
        Ok(Value::list(curves?))
    }
}

/// Checked arguments of a network.
struct NetTask<'a, T: Real> {
    given: &'a FairNet<T>,
    joined: Joined<T>,
    /// Positions of the points.
    xyz: Vec<Vec3<T>>,
    tolerances: Vec<T>,
    /// Points that are breaks, and for each curve its breaks among its own points.
    marked: Vec<usize>,
    marks: Vec<Vec<usize>>,
    /// Fixed points, and true for each point that does not move.
    kept: Vec<usize>,
    still: Vec<bool>,
    conditions: Vec<AskedCondition>,
    /// `None`: by index.
    spacing: Option<ParameterSpacing>,
    measure: Measure,
    goal: Goal,
    motion: Motion,
    bound: Bound,
    /// Passes of the mode "faithful".
    passes: Option<usize>,
}

impl<T: Real> FairNet<T> {
    const PLACES: ArgumentFields = ArgumentFields {
        points: Self::CURVES,
        tolerance: Self::TOLERANCE,
        degree: Self::DEGREE,
        breaks: Self::BREAKS,
    };

    /// Checks the arguments.
    fn task(&self) -> Result<NetTask<'_, T>, CallError> {
        let joined = Joined::of(&self.curves);
        let marked = joined.places(self.breaks.as_deref(), "a break", Self::BREAKS)?;
        let fixed = joined.places(self.fixed.as_deref(), "a fixed point", Self::FIXED)?;
        let released = joined.places(self.release.as_deref(), "a released point", Self::RELEASE)?;
        let tolerances = self.tolerances_of(&joined, &released)?;
        let along = joined.numbers(self.knuckles.as_deref(), Self::KNUCKLES)?;
        let marks = (0..joined.curves.len()).map(|k| joined.marks(k, &marked, &along)).collect();
        let spacing = super::plain_spacing(&self.spacing, Self::SPACING)?;
        let goal = self.goal()?;
        let passes = super::faithful(&self.mode, Self::MODE)?.then_some(self.passes);
        let index = matches!(spacing, ParameterSpacing::Uniform) || passes.is_some();
        let motion =
            super::motion(self.along, self.motion.as_deref(), [Self::ALONG, Self::MOTION])?;
        let measure = measure(&self.measure, Self::MEASURE)?;
        let mut kept = joined.kept(&self.kept_ends)?;
        kept.extend(fixed.iter().filter(|i| !kept.contains(i)).copied().collect::<Vec<_>>());
        kept.retain(|i| !released.contains(i));
        let mut still: Vec<bool> = tolerances.iter().map(|t| t.re() == 0.0).collect();
        kept.iter().chain(&marked).for_each(|&i| still[i] = true);
        let conditions = self.conditions(&joined)?;
        let bound = super::bound_of_points(&self.bound, Self::BOUND)?;
        let known = matches!(goal, Goal::Near(_) | Goal::Fairest);
        let optimum_only = [
            (!known, "`goal` is for the optimum", Self::GOAL),
            (self.share.is_some(), "`share` is for the optimum", Self::SHARE),
            (
                !conditions.is_empty() || bound != Bound::ControlPoints,
                "conditions and bounds are for the optimum",
                Self::MODE,
            ),
        ];
        if let Some((_, message, field)) =
            optimum_only.into_iter().find(|o| passes.is_some() && o.0)
        {
            return Err(CallError::new("other-mode", message)
                .expected("mode = \"optimum\"")
                .found("mode = \"faithful\"")
                .in_field(field));
        }
        Ok(NetTask {
            given: self,
            xyz: joined.points.iter().map(|p| p.xyz).collect(),
            joined,
            tolerances,
            marked,
            marks,
            kept,
            still,
            conditions,
            spacing: (!index).then_some(spacing),
            measure,
            goal,
            motion,
            bound,
            passes,
        })
    }

    /// The tolerance of each point; that of released points is infinite.
    fn tolerances_of(&self, joined: &Joined<T>, released: &[usize]) -> Result<Vec<T>, CallError> {
        let what = "a point with a tolerance of its own";
        let places = joined.places(self.tolerances_at.as_deref(), what, Self::TOLERANCES_AT)?;
        let own = self.tolerances.as_deref().unwrap_or_default();
        if own.len() != places.len() {
            return Err(CallError::new("wrong-count", "each of `tolerances_at` has a tolerance")
                .expected(format!("{} tolerances", places.len()))
                .found(own.len().to_string())
                .in_field(Self::TOLERANCES));
        }
        let mut tolerances = vec![self.tolerance; joined.points.len()];
        let endless = released.iter().map(|&i| (i, T::from(f64::INFINITY)));
        for (i, t) in places.into_iter().zip(own.iter().copied()).chain(endless) {
            tolerances[i] = t;
        }
        Ok(tolerances)
    }

    fn goal(&self) -> Result<Goal, CallError> {
        let budget = if &*self.goal == "near" { super::NETWORK_BUDGET } else { super::BUDGET };
        constant("share", Self::SHARE, self.share.into_iter())?;
        let share = self.share.map(|s| s.re());
        super::goal_of(&self.goal, share, budget, [Self::GOAL, Self::SHARE])
    }
}

impl<T: Real> NetTask<'_, T> {
    /// Curve `k` of the network, and the parameters of its points unless by index.
    fn strand(&self, k: usize) -> Result<(NetworkCurve, Option<Vec<T>>), CallError> {
        let ((own, closed), degree) = (&self.joined.curves[k], self.given.degree);
        let about = |e: FairError| self.at_curve(e, k);
        let space = match (closed, own.len()) {
            (true, n) => Space::closed(degree, n),
            (false, n) if n < degree + 2 => {
                Err(FairError::TooFew { expected: degree + 2, actual: n })
            }
            (false, n) => Space::floating(degree, n),
        };
        let space = space.map_err(about)?;
        if let Some(twice) = (0..own.len()).find(|&i| own[..i].contains(&own[i])) {
            return Err(CallError::new("point-twice", "a curve passes twice through a point")
                .expected("different points; only the first may come again, at the end")
                .related(self.joined.points[own[twice]].key, "is listed twice")
                .in_item(k)
                .in_field(FairNet::<T>::CURVES));
        }
        let at = self.spacing.map(|spacing| self.parameters(k, spacing)).transpose();
        let at = at.map_err(about)?;
        let curve = NetworkCurve {
            space,
            points: own.clone(),
            weights: None,
            marks: self.marks[k].clone(),
            runs: Vec::new(),
            ends: [EndContinuity::Points(0); 2],
            at: at.as_ref().map(|at| at.iter().map(|t| t.re()).collect()),
        };
        Ok((curve, at))
    }

    /// Parameters of the points of curve `k`: chord lengths where a coordinate is not monotone.
    fn parameters(&self, k: usize, spacing: ParameterSpacing) -> Result<Vec<T>, FairError> {
        let (own, closed) = &self.joined.curves[k];
        let list: Vec<Vec3<T>> = own.iter().map(|&i| self.xyz[i]).collect();
        let radii: Vec<f64> = own.iter().map(|&i| self.tolerances[i].re()).collect();
        let limits = (self.motion, &radii[..]);
        match parameters_across(&list, spacing, *closed, limits) {
            Err(FairError::TurnsAlong { .. } | FairError::Coincident { .. })
                if matches!(spacing, ParameterSpacing::Along(_)) =>
            {
                parameters_across(&list, ParameterSpacing::Chord, *closed, limits)
            }
            other => other,
        }
    }

    /// The moved points, and the fit of an optimum.
    fn moved(
        &self,
        strands: Vec<NetworkCurve>,
        ats: &[Option<Vec<T>>],
    ) -> Result<(Vec<Vec3<T>>, Option<NetworkFit>), FairError> {
        let (xyz, tolerances) = (&self.xyz, &self.tolerances);
        let limit = Limit::new(self.motion, tolerances.iter().map(|t| t.re()).collect())?;
        let plain = xyz.iter().map(|p| p.re()).collect();
        let mut network = Network::new(plain, strands, limit)?;
        network.kept.clone_from(&self.kept);
        network.bound = self.bound;
        let shaped = !self.conditions.is_empty();
        if shaped {
            let conditions = self.conditions.iter().map(|c| c.0.clone()).collect();
            network = network.with_conditions(conditions)?;
        }
        let stays = self.spacing.is_none() && matches!(self.goal, Goal::Near(_)) && !shaped;
        if stays && are_exact(&network.points, &self.joined.curves, &self.marked) {
            return Ok((xyz.clone(), None));
        }
        if let Some(passes) = self.passes {
            return Ok((network.passes_with(passes, self.given.steps, xyz, tolerances)?, None));
        }
        let (points, fit) =
            network.toward_with(self.measure, self.goal, ACCURACY, xyz, tolerances, ats)?;
        Ok((points, Some(fit)))
    }

    /// Figures of each curve.
    fn figures(&self, fit: &NetworkFit, moved: &[Vec3<T>]) -> Vec<FairFigures> {
        let plain: Vec<Vec3<f64>> = self.xyz.iter().map(|p| p.re()).collect();
        let found = line_findings(&plain, &self.joined.curves, &self.marked);
        let off: Vec<f64> = super::moves(moved, &plain).collect();
        let free = |i: usize| if self.still[i] { 0.0 } else { self.tolerances[i].re() };
        let of = |(k, (own, _)): (usize, &(Vec<usize>, bool))| {
            let residuals: Vec<f64> = own.iter().map(|&i| off[i]).collect();
            let radii: Vec<f64> = own.iter().map(|&i| free(i)).collect();
            let findings = found.iter().filter(|f| f.0 == k).count();
            FairFigures::of_network(fit, &residuals, &radii, findings)
        };
        self.joined.curves.iter().enumerate().map(of).collect()
    }

    /// Curve `k` through its moved points; `at` are the parameters of the given points, which the
    /// moved points are near, unless by index.
    fn curve(
        &self,
        k: usize,
        at: Option<&[T]>,
        moved: &[Vec3<T>],
    ) -> Result<CurveRef<T>, CallError> {
        let ((own, closed), degree) = (&self.joined.curves[k], self.given.degree);
        let points: Vec<Vec3<T>> = own.iter().map(|&i| moved[i]).collect();
        // A moved end is not its point object any more.
        let end = |i: Option<&usize>| {
            i.filter(|&&i| !closed && self.still[i]).and_then(|&i| self.joined.points[i].key)
        };
        let ends = [end(own.first()), end(own.last())];
        let about = |e: FairError| self.at_curve(e, k);
        let marks = &self.marks[k];
        if let Some(at) = at {
            let runs = runs_of(&self.conditions, k);
            let curve = through(degree, &points, at, (marks, &runs), *closed).map_err(about)?;
            return Ok(CurveRef::new(AnchoredSpline { curve, ends }, 0));
        }
        let uniform = ParameterSpacing::Uniform;
        let sharp =
            interpolate_with_corners(degree, &points, uniform, *closed, marks).map_err(about)?;
        let curve = shapes::curve(&sharp.fit.space, &sharp.points).map_err(|e| {
            CallError::new("no-spline", e.to_string()).in_item(k).in_field(FairNet::<T>::CURVES)
        })?;
        Ok(CurveRef::new(AnchoredSpline { curve, ends }, 0))
    }

    /// Converts an error of curve `k` to one at its argument.
    fn at_curve(&self, error: FairError, k: usize) -> CallError {
        fault(error, &FairNet::<T>::PLACES).in_item(k).in_field(FairNet::<T>::CURVES)
    }

    /// Converts an error of the whole network to one at its argument.
    fn unmade(&self, error: FairError) -> CallError {
        let at = |k: usize, said: String| {
            let (item, field) =
                self.conditions.get(k).map_or((0, FairNet::<T>::SHAPE), |c| (c.1, c.2));
            CallError::new("no-shape", said).in_item(item).in_field(field)
        };
        match error {
            FairError::Shapeless { shape, why } => at(shape, why.to_string()),
            FairError::Shape { ref shapes, .. } => {
                at(shapes.first().copied().unwrap_or_default(), error.to_string())
            }
            other => fault(other, &FairNet::<T>::PLACES),
        }
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
    (breaks, runs): (&[usize], &[[usize; 2]]),
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
