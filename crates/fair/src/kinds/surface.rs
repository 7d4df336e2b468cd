//! `FairSurf`: a fair surface near a grid of points.

use super::figures::FairFigures;
use super::moving_surface::MovingSurface;
use super::options::{constant, shared_options};
use super::surface_demands::{NumberGrid, PlacedValues, SurfaceDemands, places as points_of};
use super::surface_method::{MethodOptions, SurfaceMethod};
use super::{ArgumentFields, GivenKnots, PointRole, fault, indices, measure, role};
use crate::curve::request::ACCURACY;
use crate::{
    EndContinuity, FairError, Goal, GridData, GridFit, InterpolationSpace, Limit, Measure, Motion,
    MovingGrid, Network, Optimum, ParameterSpacing, Space, are_exact, fair_grid, fair_grid_with,
    grid_parameters, interpolate_with_corners, line_findings,
};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{
    ArrayShape, Build, CallError, Class, Context, FieldId, FromValue, Kind, Point, SurfaceRef,
    Value, Vectors,
};
use moldloft_spline::BSplineSurface;
use std::sync::Arc;

pub(super) struct PointGrid<T: Real>(pub Arc<Vectors<T>>);

impl<T: Real> FromValue<T> for PointGrid<T> {
    const CLASS: Class = Class::Vectors;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Vectors(array) => Ok(Self(array.clone())),
            other => Err(CallError::wrong_class(Class::Vectors, other.class())),
        }
    }
}

shared_options! {
    {
        /// A fair B-spline surface within a tolerance of a grid of points.
        ///
        /// All rows and columns of the control net are faired together: the sum of the measure over
        /// both directions is minimal within the tolerance. The four corners keep position,
        /// tangents and twist. Mode "faithful" fairs curve after curve, those of constant v first,
        /// then those of constant u, in `passes` passes of three steps per point; its result
        /// depends on this order and may jump where two knots are equally bad.
        #[derive(Kind)]
        #[kind(
            forward,
            class = Surface,
            example = "Line a({0, 0, 0}, {4, 0, 0}); farray t = uniform(0, 1, 5); surface g[5, 5]; \
                       vector up = {0, 1, 0.3}; g[1,] = distc(a, t); g[2,] = g[1,] + up; \
                       g[3,] = g[2,] + {0, 1, 0.1}; g[4,] = g[2,] + {0, 2, 0}; g[5,] = g[1,] + {0, 4, 0}; \
                       FairSurf s(g, 0.02);"
        )]
        pub struct FairSurf<T: Real>
    }
    {
        /// Grid of points, at least degree + 2 in each direction.
        points: PointGrid<T>,
        /// Largest distance of each point from the surface (`as = "control"`: of the surface from
        /// the initial one), in units of length; 0: unchanged.
        #[field(min = 0)]
        tolerance: T,
        /// Measure to minimise; see `FairCurve`.
        #[field(default = "second")]
        measure: Arc<str>,
        /// Role of the points: "fit" (interpolated, then faired) or "control" (control points of a
        /// uniform surface, which does not end at its points).
        #[field(default = "fit")]
        r#as: Arc<str>,
        /// Polynomial degree along u, and along v without `degree_v`.
        #[field(default = 3, min = 2, max = 9)]
        degree: usize,
        /// Rows (numbers of points along u, from 1) that are knuckle lines: their points do not
        /// move, nothing is smoothed across them, and the surface has a sharp edge there.
        #[field(default)]
        breaks_u: Option<Vec<usize>>,
        /// Columns that are knuckle lines; see `breaks_u`.
        #[field(default)]
        breaks_v: Option<Vec<usize>>,
        /// "optimum", "faithful", or "sweeps": all points in order, each to its own minimum, for
        /// nets too large for the optimum. Sweeps have no derivatives.
        #[field(default = "optimum")]
        mode: Arc<str>,
        /// Passes of the mode "faithful".
        #[field(default = 1, min = 1, max = 100)]
        passes: usize,
        /// Condition at the rims: "corners" (only these are kept), "position", "tangent" or
        /// "curvature", or a list of four for v = 0, u = 1, v = 1 and u = 0.
        #[field(default = "corners")]
        rims: Rims,
        /// Positive weights of the control points (`as = "control"`), constant, a grid of the same
        /// shape as the points: the surface is rational. No derivatives with respect to them.
        #[field(default)]
        weights: Option<NumberGrid<T>>,
        /// Knots along u of the control points (`as = "control"`), constant, non-decreasing: number
        /// of control points + degree + 1.
        #[field(default)]
        knots_u: Option<Vec<T>>,
        /// Knots along v; see `knots_u`.
        #[field(default)]
        knots_v: Option<Vec<T>>,
        /// Parametrisation, as for `FairCurve`: the mean over all lines of the grid in each
        /// direction. The mode "faithful" and control points use "index".
        #[field(default = "chord")]
        spacing: Arc<str>,
    }
    [goal]
    [along]
    {
        /// Polynomial degree along v. Default: `degree`.
        #[field(default, min = 2, max = 9)]
        degree_v: Option<usize>,
        /// 1: closed along u; the first row of points is not repeated.
        #[field(default = 0, min = 0, max = 1)]
        closed_u: usize,
        /// 1: closed along v; the first column of points is not repeated.
        #[field(default = 0, min = 0, max = 1)]
        closed_v: usize,
    }
    [share]
    {
        /// Tolerances of the individual points, a grid of the same shape, instead of `tolerance`.
        #[field(default)]
        tolerances: Option<NumberGrid<T>>,
        /// Numbers, from 1, of points on the surface: (i - 1) n + j in a grid [m, n].
        #[field(default)]
        fixed: Option<Vec<usize>>,
        /// Points on the surface at `through_u`, `through_v`. No derivatives.
        #[field(default)]
        through: Option<Vec<Point<T>>>,
        /// Parameters of `through` along u, from 0 to 1.
        #[field(default)]
        through_u: Option<Vec<T>>,
        /// Parameters of `through` along v, from 0 to 1.
        #[field(default)]
        through_v: Option<Vec<T>>,
        /// Normal directions of the surface at `normals_u`, `normals_v`. No derivatives.
        #[field(default)]
        normals: Option<Vec<Vec3<T>>>,
        /// Parameters of `normals` along u, from 0 to 1.
        #[field(default)]
        normals_u: Option<Vec<T>>,
        /// Parameters of `normals` along v, from 0 to 1.
        #[field(default)]
        normals_v: Option<Vec<T>>,
        /// Quantities of the surface through the points that are preserved to first order: "volume"
        /// (the displacement of a hull) or "area". No derivatives.
        #[field(default)]
        keep: Option<Vec<Arc<str>>>,
        /// Quantity that the tolerance bounds in the optimum: "data" (distance of each point from
        /// the surface; default for fits), "points" (move of each control point) or "curve"
        /// (distance of the surface from the initial one, which allows larger moves of control
        /// points).
        #[field(default)]
        bound: Option<Arc<str>>,
        /// Steps per point of each curve in the mode "faithful" (default 3), or number of sweeps
        /// (default 50).
        #[field(default, min = 1, max = 100_000)]
        steps: Option<usize>,
        /// Order of the curves in a pass of the mode "faithful": "vu" (those of constant v first;
        /// default) or "uv".
        #[field(default)]
        order: Option<Arc<str>>,
    }
}

/// Fields of options of surfaces near their points.
const TOLERANCES: FieldId = FairSurf::<f64>::TOLERANCES;
const THROUGH: FieldId = FairSurf::<f64>::THROUGH;
const NORMALS: FieldId = FairSurf::<f64>::NORMALS;
const KEEP: FieldId = FairSurf::<f64>::KEEP;
const GOAL: FieldId = FairSurf::<f64>::GOAL;
const SHARE: FieldId = FairSurf::<f64>::SHARE;

const WEIGHTS: FieldId = FairSurf::<f64>::WEIGHTS;
const KNOTS: [FieldId; 2] = [FairSurf::<f64>::KNOTS_U, FairSurf::<f64>::KNOTS_V];

impl<T: Real> FairSurf<T> {
    /// Weights and knots; refused unless `as = "control"`.
    fn own(&self, shape: ArrayShape) -> Result<[GivenKnots; 2], CallError> {
        let plain =
            |x: &Option<Vec<T>>| x.as_ref().map(|x| x.iter().map(|x| x.re()).collect::<Vec<f64>>());
        let own = [&self.knots_u, &self.knots_v]
            .map(|k| GivenKnots { knots: plain(k), ..GivenKnots::default() });
        constant("weights", WEIGHTS, self.weights.iter().flat_map(|w| w.items.iter().copied()))?;
        constant("knots_u", KNOTS[0], self.knots_u.iter().flatten().copied())?;
        constant("knots_v", KNOTS[1], self.knots_v.iter().flatten().copied())?;
        let fields = [
            (self.weights.is_some(), "weights", WEIGHTS),
            (own[0].knots.is_some(), "knots", KNOTS[0]),
            (own[1].knots.is_some(), "knots", KNOTS[1]),
        ];
        for (_, what, field) in fields.into_iter().filter(|g| g.0) {
            if &*self.r#as != "control" {
                let text = format!("{what} are those of control points");
                return Err(CallError::new("not-control", text)
                    .expected("as = \"control\"")
                    .found(format!("as = \"{}\"", self.r#as))
                    .in_field(field));
            }
        }
        if let Some(weights) = &self.weights {
            let refused = |text: &str, expected: String, found: String| {
                Err(CallError::new("bad-weight", text)
                    .expected(expected)
                    .found(found)
                    .in_field(WEIGHTS))
            };
            if weights.shape != shape {
                let found = weights.shape.to_string();
                return refused("weights are a grid like the points", shape.to_string(), found);
            }
            if &*self.mode == "faithful" {
                let (expected, found) = ("mode = \"optimum\"", "mode = \"faithful\"");
                return refused("weights need the optimum", expected.into(), found.into());
            }
        }
        Ok(own)
    }
}

impl<T: Real> FairSurf<T> {
    fn tolerances_of(&self, shape: ArrayShape, count: usize) -> Result<Vec<T>, CallError> {
        let mut all = vec![self.tolerance; count];
        if let Some(own) = &self.tolerances {
            if own.shape != shape {
                return Err(CallError::new("wrong-count", "tolerances are a grid like the points")
                    .expected(shape.to_string())
                    .found(own.shape.to_string())
                    .in_field(TOLERANCES));
            }
            all.clone_from(&own.items);
        }
        for k in self.fixed.iter().flatten() {
            match k.checked_sub(1).and_then(|k| all.get_mut(k)) {
                Some(own) => *own = T::zero(),
                None => {
                    return Err(CallError::new("out-of-range", format!("there is no point {k}"))
                        .expected(format!("numbers of points from 1 to {count}, row by row"))
                        .found(k.to_string())
                        .in_field(Self::FIXED));
                }
            }
        }
        Ok(all)
    }

    fn demands(&self) -> Result<SurfaceDemands, CallError> {
        let through = PlacedValues {
            what: "through",
            values: points_of(&self.through),
            at: [&self.through_u, &self.through_v],
            field: THROUGH,
        };
        let normals = PlacedValues {
            what: "normals",
            values: self.normals.clone().unwrap_or_default(),
            at: [&self.normals_u, &self.normals_v],
            field: NORMALS,
        };
        let keep = self.keep.as_deref().unwrap_or_default();
        SurfaceDemands::of(through, normals, (keep, KEEP))
    }

    /// `data` is true if the points are data whose parameters depend on them.
    fn method(&self, data: bool) -> Result<SurfaceMethod, CallError> {
        MethodOptions {
            mode: (&self.mode, Self::MODE),
            bound: (&self.bound, Self::BOUND),
            order: (&self.order, Self::ORDER),
            steps: (self.steps, Self::STEPS),
            passes: (self.passes, Self::PASSES),
            data,
        }
        .method()
    }

    /// The first given option that only surfaces near their points accept.
    fn near_only(&self) -> Option<(&'static str, FieldId)> {
        let given = [
            (self.tolerances.is_some(), "tolerances", TOLERANCES),
            (self.fixed.is_some(), "fixed", Self::FIXED),
            (self.through.is_some(), "through", THROUGH),
            (self.normals.is_some(), "normals", NORMALS),
            (self.keep.is_some(), "keep", KEEP),
            (self.closed_u == 1, "closed_u", Self::CLOSED_U),
            (self.closed_v == 1, "closed_v", Self::CLOSED_V),
            (!["near", "fairest"].contains(&&*self.goal), "goal", GOAL),
            (self.share.is_some(), "share", SHARE),
            (!["chord", "index"].contains(&&*self.spacing), "spacing", Self::SPACING),
        ];
        given.into_iter().find(|g| g.0).map(|g| (g.1, g.2))
    }
}

/// Conditions at the rims, in the order v = 0, u = 1, v = 1, u = 0.
pub(super) struct Rims([EndContinuity; 4]);

impl Rims {
    /// Conditions at the start and the end of each direction.
    pub fn sides(&self) -> [[EndContinuity; 2]; 2] {
        let Self([south, east, north, west]) = *self;
        [[west, east], [south, north]]
    }
}

impl<T: Real> FromValue<T> for Rims {
    const CLASS: Class = Class::Any;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        let known = ["corners", "position", "tangent", "curvature"];
        let one = |word: &str| match word {
            "corners" => Ok(EndContinuity::Free),
            "free" => Err(super::unknown("way to keep a rim", word, &known, FairSurf::<f64>::RIMS)),
            _ => EndContinuity::named(word).ok_or_else(|| {
                super::unknown("way to keep a rim", word, &known, FairSurf::<f64>::RIMS)
            }),
        };
        let text = |value: &Value<T>| <Arc<str> as FromValue<T>>::from_value(value);
        match value {
            Value::List(items) if items.len() == 4 => {
                let mut ends = [EndContinuity::Free; 4];
                for (end, item) in ends.iter_mut().zip(items.iter()) {
                    *end = one(&text(item)?)?;
                }
                Ok(Self(ends))
            }
            Value::List(items) => Err(CallError::new("wrong-count", "a surface has four rims")
                .expected("a word, or four of them for v = 0, u = 1, v = 1 and u = 0")
                .found(format!("{} items", items.len()))),
            other => Ok(Self([one(&text(other)?)?; 4])),
        }
    }
}

/// Control points of the splines through the lines of a grid along its first index: the space, the
/// points, and the rows that are breaks.
type Along<T> = (Space, Vec<Vec3<T>>, Vec<usize>);

/// Interpolates all lines of a grid `[m, n]` along its first index.
fn fitted<T: Real>(
    degree: usize,
    grid: &[Vec3<T>],
    m: usize,
    breaks: &[usize],
) -> Result<Along<T>, FairError> {
    let n = grid.len() / m;
    let mut out = Vec::new();
    let mut common = None;
    for j in 0..n {
        let line: Vec<Vec3<T>> = (0..m).map(|i| grid[i * n + j]).collect();
        let sharp =
            interpolate_with_corners(degree, &line, ParameterSpacing::Uniform, false, breaks)?;
        out.resize(sharp.points.len() * n, Vec3::zero());
        for (i, p) in sharp.points.into_iter().enumerate() {
            out[i * n + j] = p;
        }
        common = Some((sharp.fit.space, sharp.marks));
    }
    let (space, marks) = common.ok_or(FairError::TooFew { expected: 1, actual: 0 })?;
    Ok((space, out, marks))
}

/// Indices of the lines of a grid in both directions, and whether they are closed.
pub(super) fn lines([m, n]: [usize; 2], closed: [bool; 2]) -> Vec<(Vec<usize>, bool)> {
    let rows = (0..m).map(|i| ((i * n..(i + 1) * n).collect(), closed[1]));
    let columns = (0..n).map(|j| ((0..m).map(|i| i * n + j).collect(), closed[0]));
    rows.chain(columns).collect()
}

/// The transposed grid.
pub(super) fn turned<T: Real>(grid: &[Vec3<T>], m: usize) -> Vec<Vec3<T>> {
    let n = grid.len() / m;
    (0..n).flat_map(|j| (0..m).map(move |i| grid[i * n + j])).collect()
}

/// Number of rows and columns of a grid.
pub(super) fn counts<T: Real>(grid: &Vectors<T>, field: FieldId) -> Result<[usize; 2], CallError> {
    match grid.shape {
        ArrayShape::Grid(m, n) => Ok([m, n]),
        row @ ArrayShape::Row(_) => {
            Err(CallError::new("wrong-shape", "a surface needs a grid of points")
                .expected("a grid [m, n] of vectors")
                .found(format!("a row {row}"))
                .in_field(field))
        }
    }
}

/// True if the points of a surface are interpolated, false if they are control points.
pub(super) fn is_fit(word: &str, field: FieldId) -> Result<bool, CallError> {
    match role(word, field)? {
        PointRole::Fit => Ok(true),
        PointRole::Control => Ok(false),
        PointRole::Points => {
            Err(CallError::new("unknown-name", "surfaces have no role \"points\"")
                .expected("\"fit\" or \"control\"")
                .found("\"points\"")
                .in_field(field))
        }
    }
}

/// Refuses grids with too few rows or columns for the degrees.
pub(super) fn enough(counts: [usize; 2], degrees: [usize; 2]) -> Result<(), FairError> {
    match counts.into_iter().zip(degrees).find(|&(count, degree)| count < degree + 2) {
        Some((actual, degree)) => Err(FairError::TooFew { expected: degree + 2, actual }),
        None => Ok(()),
    }
}

/// Spaces, control net, and the rows and columns that are breaks.
pub(super) type FittedNet<T> = ([Space; 2], Vec<Vec3<T>>, [Vec<usize>; 2]);

/// Interpolates a grid of `m` rows.
pub(super) fn fitted_net<T: Real>(
    degrees: [usize; 2],
    grid: &[Vec3<T>],
    m: usize,
    breaks: &[Vec<usize>; 2],
) -> Result<FittedNet<T>, FairError> {
    let (u, net, rows) = fitted(degrees[0], grid, m, &breaks[0])?;
    let n = grid.len() / m;
    let (v, net, columns) = fitted(degrees[1], &turned(&net, u.count()), n, &breaks[1])?;
    let net = turned(&net, v.count());
    Ok(([u, v], net, [rows, columns]))
}

impl<T: Real> Build<T> for FairSurf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let task = self.task()?;
        let mut owners = Vec::new();
        if task.method == SurfaceMethod::NearPoints {
            let (surface, figures) = task
                .near_points(&mut owners)
                .and_then(|(made, figures)| {
                    let surface = MovingSurface::referred(task.degrees, made.knots, made.points)?;
                    Ok((surface, figures))
                })
                .map_err(|e| task.unmade(e, &owners))?;
            return Ok(Value::Surface(surface.with_figures(&figures.members())));
        }
        let (spaces, points, figures) = task.fair_net().map_err(|e| task.unmade(e, &owners))?;
        let weights = task.weights.map(|w| w.into_iter().map(T::from).collect());
        net_surface(&spaces, points, weights, figures, Self::POINTS)
    }
}

/// The surface of a faired control net; `field` is the argument with the points.
pub(super) fn net_surface<T: Real>(
    spaces: &[Space; 2],
    points: Vec<Vec3<T>>,
    weights: Option<Vec<T>>,
    figures: FairFigures,
    field: FieldId,
) -> Result<Value<T>, CallError> {
    let [u, v] = spaces.each_ref().map(|s| s.knot_vector().0);
    let surface = BSplineSurface::new(u, v, points, weights)
        .map_err(|e| CallError::new("no-spline", e.to_string()).in_field(field))?;
    let surface = SurfaceRef::new(surface, 0);
    Ok(Value::Surface(surface.with_figures(&figures.members_of_moves())))
}

/// Checked arguments of a surface.
struct SurfaceTask<'a, T: Real> {
    given: &'a FairSurf<T>,
    points: Vec<Vec3<T>>,
    counts: [usize; 2],
    degrees: [usize; 2],
    closed: [bool; 2],
    /// True if the points are interpolated, false if they are control points.
    fitted: bool,
    /// Indices of the breaks along u and v.
    marks: [Vec<usize>; 2],
    own: [GivenKnots; 2],
    measure: Measure,
    goal: Goal,
    motion: Motion,
    spacing: ParameterSpacing,
    tolerances: Vec<T>,
    weights: Option<Vec<f64>>,
    demands: SurfaceDemands,
    method: SurfaceMethod,
}

impl<T: Real> FairSurf<T> {
    const PLACES: ArgumentFields = ArgumentFields {
        points: Self::POINTS,
        tolerance: Self::TOLERANCE,
        degree: Self::DEGREE,
        breaks: Self::BREAKS_U,
    };

    /// Checks the arguments.
    fn task(&self) -> Result<SurfaceTask<'_, T>, CallError> {
        let PointGrid(grid) = &self.points;
        let counts = counts(grid, Self::POINTS)?;
        let measure = measure(&self.measure, Self::MEASURE)?;
        let fitted = is_fit(&self.r#as, Self::AS)?;
        let marks = |given: &Option<Vec<usize>>, count, breaks| {
            indices(given.as_deref().unwrap_or_default(), count)
                .map_err(|e| fault(e, &ArgumentFields { breaks, ..Self::PLACES }))
        };
        let marks = [
            marks(&self.breaks_u, counts[0], Self::BREAKS_U)?,
            marks(&self.breaks_v, counts[1], Self::BREAKS_V)?,
        ];
        let own = self.own(grid.shape)?;
        let motion =
            super::motion(self.along, self.motion.as_deref(), [Self::ALONG, Self::MOTION])?;
        let spacing = super::plain_spacing(&self.spacing, Self::SPACING)?;
        constant("share", SHARE, self.share.into_iter())?;
        let share = self.share.map(|s| s.re());
        let goal = super::goal_of(&self.goal, share, super::BUDGET, [GOAL, SHARE])?;
        let tolerances = self.tolerances_of(grid.shape, counts[0] * counts[1])?;
        let demands = self.demands()?;
        let method = self.method(fitted && !matches!(spacing, ParameterSpacing::Uniform))?;
        if method != SurfaceMethod::NearPoints
            && let Some((what, field)) = self.near_only()
        {
            let message = format!("`{what}` is for surfaces near their points");
            return Err(CallError::new("not-near", message)
                .expected(
                    "as = \"fit\", mode = \"optimum\", bound \"data\", without spacing \"index\"",
                )
                .in_field(field));
        }
        Ok(SurfaceTask {
            given: self,
            points: grid.points(),
            counts,
            degrees: [self.degree, self.degree_v.unwrap_or(self.degree)],
            closed: [self.closed_u == 1, self.closed_v == 1],
            fitted,
            marks,
            own,
            measure,
            goal,
            motion,
            spacing,
            tolerances,
            weights: self.weights.as_ref().map(|w| w.items.iter().map(|x| x.re()).collect()),
            demands,
            method,
        })
    }
}

impl<T: Real> SurfaceTask<'_, T> {
    /// The points without derivatives, the lines of the grid, and the points on breaks.
    fn lines(&self) -> (Vec<Vec3<f64>>, Vec<(Vec<usize>, bool)>, Vec<usize>) {
        let n = self.counts[1];
        let on_break =
            |k: &usize| self.marks[0].contains(&(k / n)) || self.marks[1].contains(&(k % n));
        let plain = self.points.iter().map(|p| p.re()).collect();
        let breaks = (0..self.points.len()).filter(on_break).collect();
        (plain, lines(self.counts, self.closed), breaks)
    }

    /// The control net before fairing, and its rows and columns that are breaks.
    fn net(&self) -> Result<FittedNet<T>, FairError> {
        enough(self.counts, self.degrees)?;
        if self.fitted {
            return fitted_net(self.degrees, &self.points, self.counts[0], &self.marks);
        }
        let space = |d: usize| self.own[d].space(self.degrees[d], self.counts[d]);
        Ok(([space(0)?, space(1)?], self.points.clone(), self.marks.clone()))
    }

    /// The faired control net.
    fn fair_net(&self) -> Result<([Space; 2], Vec<Vec3<T>>, FairFigures), FairError> {
        let (spaces, net, marks) = self.net()?;
        let (plain, lines, breaks) = self.lines();
        let still = self.weights.is_none() && matches!(self.goal, Goal::Near(_));
        if still && are_exact(&plain, &lines, &breaks) {
            return Ok((spaces, net, FairFigures::of_moves([].into_iter(), None)));
        }
        let tolerance = self.given.tolerance;
        let limit = Limit::new(self.motion, vec![tolerance.re(); net.len()])?;
        let plain = net.iter().map(|p| p.re()).collect();
        let mut network = Network::net(spaces.clone(), plain, self.weights.clone(), limit)?
            .with_breaks(&marks[0], &marks[1])?
            .with_rims(self.given.rims.sides())?;
        let tolerances = vec![tolerance; net.len()];
        let (points, best) = match self.method {
            SurfaceMethod::Passes { passes, steps, along_v_first } => {
                if along_v_first {
                    network.strands.rotate_left(spaces[1].count());
                }
                (network.passes_with(passes, steps, &net, &tolerances)?, None)
            }
            SurfaceMethod::Sweeps(count) => {
                let mut numbers = net.iter().flat_map(|p| p.to_array()).chain([tolerance]);
                if !numbers.all(|x| x.is_constant()) {
                    return Err(FairError::NoDerivative(
                        "no derivatives are available for sweeps: use the optimum",
                    ));
                }
                let (points, certificate) = network.sweeps(self.measure, count)?;
                let best = Optimum { points, certificate, iterations: count, active: 0 };
                (best.points.iter().map(|&p| Vec3::lifted(p)).collect(), Some(best))
            }
            SurfaceMethod::Joint(bound) => {
                let (points, best) =
                    network.optimum_with(self.measure, bound, ACCURACY, &net, &tolerances)?;
                (points, Some(best))
            }
            SurfaceMethod::NearPoints => unreachable!("made from its points"),
        };
        let figures = FairFigures::of_net(super::moves(&points, &net), best.as_ref());
        Ok((spaces, points, figures))
    }

    /// The fair surface near the points. `owners` receives the argument of each condition.
    fn near_points(
        &self,
        owners: &mut Vec<usize>,
    ) -> Result<(MovingGrid<T>, FairFigures), FairError> {
        let (degrees, closed) = (self.degrees, self.closed);
        for d in [0, 1] {
            let expected = degrees[d] + 2 + if closed[d] { degrees[d] } else { 0 };
            let actual = self.counts[d];
            if actual < expected {
                return Err(FairError::TooFew { expected, actual });
            }
        }
        let limit = Limit::new(self.motion, self.tolerances.iter().map(|t| t.re()).collect())?;
        let allowed = (self.motion, limit.radii.as_slice());
        let at = grid_parameters(&self.points, self.counts, [self.spacing; 2], closed, allowed)?;
        let layout = |d: usize| {
            let real: Vec<f64> = at[d].iter().map(|t| t.re()).collect();
            InterpolationSpace::new(degrees[d], &real, &self.marks[d], closed[d])
        };
        let layouts = [layout(0)?, layout(1)?];
        let (points, lines, breaks) = self.lines();
        let data = GridData { limit, layouts, rims: self.given.rims.sides(), points };
        let at = [at[0].as_slice(), at[1].as_slice()];
        let (made, fit) = if self.demands.is_empty() {
            let (points, tolerances) = (&self.points, &self.tolerances);
            fair_grid_with(&data, self.measure, self.goal, ACCURACY, points, tolerances, at)?
        } else {
            self.conditioned(&data, at, owners)?
        };
        let findings = line_findings(&data.points, &lines, &breaks);
        let figures = FairFigures::of_surface(&fit, &data.limit.radii, findings.len());
        Ok((opened(&data.layouts, &made), figures))
    }

    /// The fair surface near the points that meets the conditions.
    fn conditioned(
        &self,
        data: &GridData,
        at: [&[T]; 2],
        owners: &mut Vec<usize>,
    ) -> Result<(MovingGrid<T>, GridFit), FairError> {
        let mut numbers = self
            .points
            .iter()
            .flat_map(|p| p.to_array())
            .chain(at.iter().flat_map(|a| a.iter().copied()))
            .chain(self.tolerances.iter().copied());
        if !numbers.all(|x| x.is_constant()) {
            return Err(FairError::NoDerivative(
                "no derivatives are available for surfaces with conditions: remove the conditions",
            ));
        }
        let (conditions, whose) = self.demands.conditions(data)?;
        *owners = whose;
        let fit = fair_grid(data, self.measure, self.goal, &conditions, 1e-9)?;
        let knots = |d: usize| data.layouts[d].space.knots().iter().map(|&k| T::from(k)).collect();
        let points = fit.points.iter().map(|&p| Vec3::lifted(p)).collect();
        Ok((MovingGrid { points, knots: [knots(0), knots(1)] }, fit))
    }

    /// Converts an error to one at its argument.
    fn unmade(&self, error: FairError, owners: &[usize]) -> CallError {
        match error {
            FairError::Weight { .. } => {
                CallError::new("bad-weight", error.to_string()).in_field(WEIGHTS)
            }
            FairError::Unsorted { .. }
            | FairError::Knots(_)
            | FairError::Count { what: "knots", .. } => {
                let along = usize::from(self.own[0].space(self.degrees[0], self.counts[0]).is_ok());
                CallError::new("bad-knots", error.to_string()).in_field(KNOTS[along])
            }
            FairError::Degree { expected, actual } if actual != self.degrees[0] => {
                CallError::new("out-of-range", error.to_string())
                    .expected(format!("degree {expected} or more for this measure"))
                    .found(actual.to_string())
                    .in_field(FairSurf::<T>::DEGREE_V)
            }
            FairError::Goal(why) => CallError::new("no-goal", why).in_field(GOAL),
            FairError::Energy { .. } => {
                CallError::new("no-goal", error.to_string()).in_field(SHARE)
            }
            FairError::Contradiction { conditions, miss, .. } if !self.demands.is_empty() => {
                self.demands.refused(&conditions, owners, miss)
            }
            other => fault(other, &FairSurf::<T>::PLACES),
        }
    }
}

/// A surface in the form whose closed directions are open ones that repeat their first points.
fn opened<T: Real>(layouts: &[InterpolationSpace; 2], made: &MovingGrid<T>) -> MovingGrid<T> {
    let along = |d: usize, net: &[Vec3<T>]| {
        let space = &layouts[d].space;
        let count = space.count();
        let across = net.len() / count;
        let (mut out, mut open) = (Vec::new(), Vec::new());
        for k in 0..across {
            let line: Vec<Vec3<T>> = (0..count).map(|i| net[i * across + k]).collect();
            let (knots, line) = space.open_form(&made.knots[d], &line);
            out.resize(line.len() * across, Vec3::zero());
            for (i, p) in line.into_iter().enumerate() {
                out[i * across + k] = p;
            }
            open = knots;
        }
        (open, out)
    };
    let (u, net) = along(0, &made.points);
    let (v, net) = along(1, &turned(&net, net.len() / layouts[1].space.count()));
    let points = turned(&net, v.len() - layouts[1].space.degree() - 1);
    MovingGrid { points, knots: [u, v] }
}
