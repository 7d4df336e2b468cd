//! Structured grids: interpolated from edges and faces, smoothed, measured.

use crate::value::{BlockArg, GridArg, Points, surface};
use moldloft_budget::Budget;
use moldloft_grid::{
    Blend, Elliptic, Faces, FailureCause, GridError, GridSide, JoinFault, Method, PeriodicEdges,
    QualityMetric, Smoothed, SurfaceGrid, Wall, elliptic_until, folded_cells_until, framed,
    quality_until, transfinite_block_until, transfinite_until,
};
use moldloft_num::{Order, Real, Surface, Vec3};
use moldloft_registry::{
    ArrayShape, Build, CallError, Context, FieldId, FromValue, Kind, Scalar, SurfaceRef, Value,
};
use moldloft_spline::{End, Ends, GridSpline};
use std::sync::Arc;

/// Distance relative to the size beyond which boundary points are not on the surface.
const OFF_WALL: f64 = 1e-6;

/// Distance from a line, relative to their size, within which points have no plane of their own.
const NO_WIDTH: f64 = 1e-12;

/// The fault of a grid, about field 0.
pub fn fault(error: GridError, field: FieldId) -> CallError {
    let message = error.to_string();
    let with = |id: &'static str| CallError::new(id, message.clone());
    match error {
        GridError::TooFew { expected, actual: [m, n] } => with("too-few-items")
            .expected(format!("at least {expected} points each way"))
            .found(format!("[{m},{n}]")),
        GridError::NotFinite { .. } | GridError::PointNotFinite { .. } => with("not-finite").expected("finite points"),
        GridError::EdgesApart { corner, gap } => {
            let [i, j] = corner.at;
            with("edges-apart")
                .expected(format!("{} and {} with one point in common", corner.edge, corner.other))
                .found(format!("a gap of {gap} at corner [{i},{j}]"))
                .help("set all four edges; where two meet, both must end in the same point")
        }
        GridError::FacesApart { faces: [a, b], gap, .. } => with("faces-apart")
            .expected(format!("faces {a} and {b} with one edge in common"))
            .found(format!("a gap of {gap}"))
            .help("the faces are i = 1, i = ni, j = 1, j = nj, k = 1, k = nk"),
        GridError::FaceSizes { face, expected: [a, b], actual: [m, n] } => with("shapes-differ")
            .expected(format!("[{a},{b}]"))
            .found(format!("[{m},{n}]"))
            .in_item(face - 1),
        GridError::Folded { count, .. } => with("folded-grid")
            .expected("unfolded cells")
            .found(format!("{count} folded cells")),
        GridError::March(failure) => match failure.cause {
            FailureCause::CornerTooTight { fits, .. } => with("tight-corner")
                .expected(format!("a first cell of at most {fits:.3e}"))
                .help("make the first cell smaller, or the points beside the corner wider"),
            FailureCause::LayersMeet { .. } => with("folded-grid")
                .expected("layers that do not cross the grid above another part of the wall")
                .help("reduce the last height, or take the layers below with stop = \"keep\""),
            _ => with("folded-grid").expected("unfolded cells").help(
                "reduce the distance, increase the smoothing, even out the spacing of the wall there, or take the layers below with \
                 stop = \"keep\"; layers are on the side of s_i x s_j; s[, ::-1] selects the other side",
            ),
        },
        GridError::Diverged { .. } => with("diverged")
            .expected("a converging iteration")
            .help("reduce omega, or relax the spacing and angle at the walls"),
        GridError::Spent(spent) => return spent.into(),
        GridError::Heights { value, .. } => {
            with("not-monotone").expected("heights that increase from 0").found(value.to_string())
        }
        GridError::NotPeriodic { gap, .. } => with("edges-apart")
            .expected("two edges whose points differ by the same vector")
            .found(format!("a deviation of {gap}"))
            .help("set the second edge as the first one plus a vector: s[im, ] = s[1, ] + pitch"),
        GridError::NoNormal { .. } => {
            with("no-direction").expected("a surface with a normal at every point")
        }
        GridError::Join(fault) => match *fault {
            JoinFault::Surface { surface, cause } => {
                return self::fault(*cause, field).in_item(surface - 1);
            }
            JoinFault::NotOpen { .. } | JoinFault::Open { .. } => {
                with("unused-argument").expected("conditions of open edges")
            }
            JoinFault::NotPlane { .. } => with("not-plane")
                .expected("open edges in the plane of symmetry")
                .help("state the condition of the edge, as sides = \"symmetry y, 2 jn free\""),
            JoinFault::Hanging { .. } => with("edges-apart")
                .expected("edges whose points are those of the other edge")
                .help("give both edges the same points, or split the longer one where the other ends"),
            JoinFault::TwoCells { .. } => with("no-direction")
                .expected("at least three cells round a point inside the surfaces"),
            _ => with("no-front").expected("surfaces that are one front, each edge common to at most two"),
        },
    }
    .in_field(field)
}

pub(crate) fn unknown(word: &str, what: &str, expected: String, field: FieldId) -> CallError {
    CallError::new("unknown-word", format!("unknown {what} \"{word}\""))
        .expected(expected)
        .found(format!("\"{word}\""))
        .in_field(field)
}

/// Transfinite interpolation: the surface with exactly the four edges of `s`, and interior points
/// interpolated from these.
///
/// `s` is a surface with its edges set (inner points are ignored); or a list of four curves, s[1,],
/// s[m,], s[,1], s[,n], which must meet at the corners; or a list of six surfaces, the faces i = 1,
/// i = ni, j = 1, j = nj, k = 1, k = nk of a block, for which the value is that block. `kind` is
/// "arc" (arc-length blending: Soni 1985), "linear" (by index), "hermite" (arc length with cubic
/// blending: blocks join smoothly) or "soni2" (averaged arc lengths instead of their intersection).
/// An edge of zero length, a pole, takes the spacing of the opposite one.
#[derive(Kind)]
#[kind(
    forward,
    class = Any,
    function,
    cheap,
    name = "tfi",
    example = "surface s[5,4]; s[,1] = spread_i(uniform(0, 1, 5), 1)[,1] * {1, 0, 0}; \
               s[,4] = s[,1] + {0, 1, 0}; s[1,] = uniform(0, 1, 4) * {0, 1, 0}; \
               s[5,] = s[1,] + {1, 0, 0}; surface g = tfi(s, \"arc\");"
)]
pub struct Tfi<T: Scalar> {
    /// The surface, four curves or six surfaces.
    s: Value<T>,
    /// "arc", "linear", "hermite" or "soni2".
    #[field(default = "arc")]
    kind: Arc<str>,
}

impl<T: Scalar> Build<T> for Tfi<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let blend = match &*self.kind {
            "arc" => Blend::Arc,
            "linear" => Blend::Linear,
            "hermite" => Blend::Hermite,
            "soni2" => Blend::Soni2,
            word => {
                let expected = "\"arc\", \"linear\", \"hermite\" or \"soni2\"".to_string();
                return Err(unknown(word, "kind of interpolation", expected, Self::KIND));
            }
        };
        let Value::List(items) = &self.s else {
            let GridArg(grid) =
                GridArg::from_value(&self.s).map_err(|fault| fault.in_field(Self::S))?;
            let grid = transfinite_until(&grid, blend, &context.budget);
            return remarked(grid.map_err(|error| fault(error, Self::S))?, context, Self::S);
        };
        let place = |k: usize| move |fault: CallError| fault.in_item(k).in_field(Self::S);
        match items.len() {
            4 => {
                let mut edges: [Vec<Vec3<T>>; 4] = Default::default();
                for (k, item) in items.iter().enumerate() {
                    edges[k] = Points::from_value(item).map_err(place(k))?.0;
                }
                for (a, b) in [(0, 1), (2, 3)] {
                    if edges[a].len() != edges[b].len() {
                        let (m, n) = (edges[a].len(), edges[b].len());
                        let message = format!("opposite edges have {m} and {n} points");
                        return Err(CallError::new("shapes-differ", message)
                            .expected(format!("{m} points"))
                            .found(format!("{n} points"))
                            .in_item(b)
                            .in_field(Self::S));
                    }
                }
                let grid = framed(&edges).map_err(|error| fault(error, Self::S))?;
                let grid = transfinite_until(&grid, blend, &context.budget);
                remarked(grid.map_err(|error| fault(error, Self::S))?, context, Self::S)
            }
            6 => {
                let mut faces: Vec<SurfaceGrid<T>> = Vec::with_capacity(6);
                for (k, item) in items.iter().enumerate() {
                    faces.push(GridArg::from_value(item).map_err(place(k))?.0);
                }
                let faces: Faces<T> = faces.try_into().map_err(|_| fault_of_count(6, Self::S))?;
                let layers = transfinite_block_until(&faces, &context.budget)
                    .map_err(|error| fault(error, Self::S))?;
                Ok(crate::value::block(layers))
            }
            n => Err(fault_of_count(n, Self::S)),
        }
    }
}

/// A grid as a value, with a note if it has folded cells.
fn remarked<T: Scalar>(
    grid: SurfaceGrid<T>,
    context: &Context,
    field: FieldId,
) -> Result<Value<T>, CallError> {
    let folded =
        folded_cells_until(&grid, &context.budget).map_err(|spent| fault(spent.into(), field))?;
    if let Some([i, j]) = folded.first() {
        let cells = grid.m.saturating_sub(1) * grid.n.saturating_sub(1);
        context.remark(
            "folded-grid",
            format!(
                "{} of {cells} cells are folded, the first [{},{}]",
                folded.len(),
                i + 1,
                j + 1
            ),
            "smooth the grid: elliptic(s); or move its edges",
        );
    }
    Ok(surface(grid))
}

fn fault_of_count(n: usize, field: FieldId) -> CallError {
    CallError::new("wrong-shape", format!("{n} edges or faces do not bound a grid"))
        .expected("a surface, a list of four curves or a list of six surfaces")
        .found(format!("a list of {n}"))
        .in_field(field)
}

/// The edges by the names of the language.
pub(crate) const EDGES: [(&str, GridSide); 4] = [
    ("i1", GridSide::FirstI),
    ("im", GridSide::LastI),
    ("j1", GridSide::FirstJ),
    ("jn", GridSide::LastJ),
];

/// A grid smoothed by the elliptic equations a (r_xx + p r_x) - 2 b r_xy + c (r_yy + q r_y) = 0;
/// its edges are fixed, except periodic ones.
///
/// `method`: "laplace" (p = q = 0: Winslow 1966), "middlecoff" (propagates the spacing of the edges
/// inward: Thomas and Middlecoff 1980), "sorenson" (spacing and angle at walls: Steger and Sorenson
/// 1979, by the iteration of Hilgenstock 1988). A plane grid is smoothed in its plane; a curved one
/// on the surface `on`, by default on the spline surface through its own points. The iteration ends
/// after `n` sweeps, or when no point moves by more than `tol` of the size and the walls have the
/// requested spacing and angle; without convergence a note gives the residual. For "sorenson"
/// `walls` names edges, "i1", "im", "j1", "jn", separated by blanks, `spacing` is the first cell
/// height there, `angle` the angle of the grid lines to the wall. `periodic` names two opposite edges
/// of a plane grid that are one line, the second moved by a constant vector (the cut of an O-grid, the
/// sides of a cascade): their points move like those inside, except the ends. A result with folded
/// cells is an error, unless `folded` is "allow".
#[derive(Kind)]
#[kind(
    forward,
    class = Vectors,
    function,
    name = "elliptic",
    example = "surface s[5,4]; for (j = 1:4) s[,j] = uniform(0, 1, 5) * {1, 0, 0} + {0, 1, 0} * j; \
               s[3,2] += {0.1, 0.2, 0}; surface g = elliptic(s, 200, 1e-12); \
               assert |g[3,2] - {0.5, 2, 0}| < 1e-9;"
)]
pub struct EllipticGrid<T: Scalar> {
    /// The grid.
    s: GridArg<T>,
    /// Maximum number of sweeps.
    #[field(default = 5000, min = 0, max = 1e6)]
    n: usize,
    /// Convergence: maximum displacement of a point in a sweep, relative to the size; 1: exactly `n` sweeps.
    #[field(default = 1e-8, min = 0)]
    tol: T,
    /// "laplace", "middlecoff" or "sorenson".
    #[field(default = "laplace")]
    method: Arc<str>,
    /// The surface that the points stay on.
    on: Option<SurfaceRef<T>>,
    /// Walls, for the method sorenson: "i1", "im", "j1", "jn".
    walls: Option<Arc<str>>,
    /// First cell height at the walls.
    #[field(min = 0)]
    spacing: Option<T>,
    /// Angle to the walls; default: a right angle.
    #[field(angle, default = std::f64::consts::FRAC_PI_2)]
    angle: T,
    /// Over-relaxation.
    #[field(default = 1.3, min = 0.01, max = 1.99)]
    omega: T,
    /// Periodic edges: "i1 im" or "j1 jn".
    #[field(default = "")]
    periodic: Arc<str>,
    /// "refuse" or "allow" folded cells in the result.
    #[field(default = "refuse")]
    folded: Arc<str>,
}

impl<T: Scalar> Build<T> for EllipticGrid<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let method = match &*self.method {
            "laplace" => Method::Laplace,
            "middlecoff" => Method::Middlecoff,
            "sorenson" => Method::Sorenson,
            word => {
                let expected = "\"laplace\", \"middlecoff\" or \"sorenson\"".to_string();
                return Err(unknown(word, "method", expected, Self::METHOD));
            }
        };
        let allowed = match &*self.folded {
            "refuse" => false,
            "allow" => true,
            word => {
                let expected = "\"refuse\" or \"allow\"".to_string();
                return Err(unknown(word, "treatment of folded cells", expected, Self::FOLDED));
            }
        };
        let walls = match (method, &self.walls, self.spacing) {
            (Method::Sorenson, Some(words), Some(spacing)) => {
                walls::<T>(words, spacing, self.angle)?
            }
            (Method::Sorenson, ..) => {
                let field = if self.walls.is_none() { Self::WALLS } else { Self::SPACING };
                return Err(CallError::new(
                    "missing-argument",
                    "\"sorenson\" needs walls and a spacing",
                )
                .expected("walls = \"j1\", spacing = 0.01")
                .in_field(field));
            }
            (_, None, None) => Vec::new(),
            _ => {
                return Err(CallError::new(
                    "unused-argument",
                    "walls are for the method \"sorenson\"",
                )
                .expected("\"sorenson\"")
                .found(format!("\"{}\"", self.method))
                .in_field(Self::METHOD));
            }
        };
        let periodic = periodic_edges(&self.periodic, &walls, Self::PERIODIC)?;
        let grid = self.s.0;
        grid.re().check_edges().map_err(|error| fault(error, Self::S))?;
        extended(&grid.planes, Self::S)?;
        let own;
        let on: Option<(&dyn Surface<T>, [Vec<T>; 2])> = match &self.on {
            Some(surface) => Some((&**surface, on_surface(&grid, surface)?)),
            None if plane(&grid) => None,
            None => {
                own = through(&grid, Self::S, &context.budget)?;
                let (m, n) = (grid.m, grid.n);
                let even = |k: usize, n: usize| T::from(k as f64 / (n - 1) as f64);
                let u = (0..m * n).map(|k| even(k / n, m)).collect();
                let v = (0..m * n).map(|k| even(k % n, n)).collect();
                Some((&own, [u, v]))
            }
        };
        if periodic.is_some() && on.is_some() {
            return Err(CallError::new(
                "wrong-shape",
                "periodic edges of a grid that is not plane",
            )
            .expected("a plane grid, without `on`")
            .in_field(Self::PERIODIC));
        }
        let counted = self.tol.re() >= 1.0;
        let options = Elliptic {
            method,
            periodic,
            sweeps: self.n,
            tolerance: if counted { 0.0 } else { self.tol.re() },
            omega: self.omega.re(),
            walls,
            on,
        };
        let done = elliptic_until(&grid, &options, &context.budget)
            .map_err(|error| fault(error, Self::S))?;
        if !done.converged && !counted && self.n > 0 {
            context.remark(
                "not-converged",
                unsettled(&done),
                "allow more sweeps, or a wider tolerance",
            );
        }
        let smoothed = done.grid;
        let folded = match allowed {
            true => Vec::new(),
            false => folded_cells_until(&smoothed, &context.budget)
                .map_err(|spent| fault(spent.into(), Self::S))?,
        };
        if let Some(&[i, j]) = folded.first() {
            let error = GridError::Folded { count: folded.len(), at: [i + 1, j + 1], layer: None };
            return Err(fault(error, Self::S).help(
                "allow more sweeps, or look at it with folded = \"allow\" and quality(s, \"sj\")",
            ));
        }
        Ok(surface(smoothed))
    }
}

/// Error for points that all coincide, such as an array without any element set: there is nothing
/// to smooth.
pub(crate) fn extended<T: Real>(planes: &[Vec<T>; 3], field: FieldId) -> Result<(), CallError> {
    let still = |plane: &Vec<T>| plane.iter().all(|x| x.re() == plane[0].re());
    if !planes.iter().all(still) {
        return Ok(());
    }
    Err(CallError::new("coincident-points", "all points of the grid coincide")
        .expected("a grid with an extent")
        .help("set its edges and fill it first, as `transfinite` does")
        .in_field(field))
}

/// Remark on a smoothing that has not converged.
pub(crate) fn unsettled<T: Real>(done: &Smoothed<T>) -> String {
    use std::fmt::Write;
    let Smoothed { sweeps, change, walls, .. } = done;
    let mut text = format!(
        "the grid has not converged: sweep {sweeps} still moves points by {change:.2e} of its size"
    );
    for wall in walls {
        let [low, high] = wall.cells;
        let edge = EDGES.iter().find(|(_, edge)| *edge == wall.edge).map_or("", |(name, _)| name);
        let angle = wall.angle.to_degrees();
        let _ = write!(
            text,
            "; at {edge} cells are {low:.4} to {high:.4} of the spacing, angles {angle:.2} degrees off"
        );
    }
    text
}

fn walls<T: Scalar>(words: &str, spacing: T, angle: T) -> Result<Vec<Wall<T>>, CallError> {
    let mut walls = Vec::new();
    for word in words.split([' ', ',']).filter(|word| !word.is_empty()) {
        let Some((_, edge)) = EDGES.iter().find(|(name, _)| *name == word) else {
            let expected = "\"i1\", \"im\", \"j1\" or \"jn\"".to_string();
            return Err(unknown(word, "edge", expected, EllipticGrid::<T>::WALLS));
        };
        walls.push(Wall { edge: *edge, spacing: vec![spacing], angle });
    }
    if spacing.re() <= 0.0 {
        return Err(CallError::new("out-of-range", "the spacing off a wall is a positive length")
            .expected("a positive number")
            .found(spacing.re().to_string())
            .in_field(EllipticGrid::<T>::SPACING));
    }
    Ok(walls)
}

/// The two edges that words name, which must have no wall.
fn periodic_edges<T>(
    words: &str,
    walls: &[Wall<T>],
    field: FieldId,
) -> Result<Option<PeriodicEdges>, CallError> {
    let mut named: Vec<&str> = words.split([' ', ',']).filter(|word| !word.is_empty()).collect();
    named.sort_unstable();
    let (edges, sides) = match named[..] {
        [] => return Ok(None),
        ["i1", "im"] => (PeriodicEdges::I, [GridSide::FirstI, GridSide::LastI]),
        ["j1", "jn"] => (PeriodicEdges::J, [GridSide::FirstJ, GridSide::LastJ]),
        _ => {
            let expected = "\"i1 im\" or \"j1 jn\"".to_string();
            return Err(unknown(words, "pair of edges", expected, field));
        }
    };
    if let Some(wall) = walls.iter().find(|wall| sides.contains(&wall.edge)) {
        let name = EDGES.iter().find(|(_, edge)| *edge == wall.edge).map_or("", |(name, _)| name);
        return Err(CallError::new(
            "unused-argument",
            format!("the edge {name} is a wall and periodic"),
        )
        .expected("walls on the other two edges")
        .in_field(field));
    }
    Ok(Some(edges))
}

/// True if all points are coplanar, to rounding.
fn plane<T: Real>(grid: &SurfaceGrid<T>) -> bool {
    let plain = grid.re();
    let points: Vec<Vec3> = plain.points().collect();
    let first = points[0];
    let far = |f: &dyn Fn(&Vec3) -> f64| {
        points.iter().fold(
            (0.0, first),
            |best: (f64, Vec3), p| if f(p) > best.0 { (f(p), *p) } else { best },
        )
    };
    let (size, second) = far(&|p| p.distance(first));
    if size == 0.0 {
        return true;
    }
    let along = (second - first) / size;
    let (width, third) = far(&|p| (*p - first).cross(along).norm());
    if width <= NO_WIDTH * size {
        return true;
    }
    let normal = (third - first).cross(along);
    let normal = normal / normal.norm();
    points.iter().all(|p| (*p - first).dot(normal).abs() <= NO_WIDTH * size)
}

/// The spline surface through the points, even in the indices.
fn through<T: Real>(
    grid: &SurfaceGrid<T>,
    field: FieldId,
    budget: &Budget,
) -> Result<GridSpline<T>, CallError> {
    let knots = |n: usize| (0..n).map(|k| T::from(k as f64 / (n - 1) as f64)).collect();
    let ends = Ends::Open(End::NotAKnot, End::NotAKnot);
    let points = grid.points().collect();
    let go_on = || !budget.is_spent();
    GridSpline::bicubic_while(knots(grid.m), knots(grid.n), points, [ends, ends], &go_on)
        .map_err(|error| crate::spline::fault(error, "point", [field, field]))?
        .ok_or_else(|| match budget.poll() {
            Err(spent) => fault(spent.into(), field),
            Ok(()) => unreachable!("a spent budget stays spent until the run has ended"),
        })
}

/// The parameters of the points of a surface nearest to those of a grid, which must be on it.
fn on_surface<T: Scalar>(
    grid: &SurfaceGrid<T>,
    on: &SurfaceRef<T>,
) -> Result<[Vec<T>; 2], CallError> {
    let points: Vec<Vec3<T>> = grid.points().collect();
    let (uv, off) = crate::locate::nearest_parameters(on, &points);
    let size = grid.size();
    let worst = (0..points.len()).fold(0, |w, k| if off[k] > off[w] { k } else { w });
    if off[worst] > OFF_WALL * size {
        let (i, j) = (worst / grid.n + 1, worst % grid.n + 1);
        let message = format!("point [{i},{j}] of the grid is {} off the surface", off[worst]);
        return Err(CallError::new("off-surface", message)
            .expected("a grid with all points on the surface")
            .found(format!("a distance of {}", off[worst]))
            .help("project(s, surface) moves them onto it")
            .in_field(EllipticGrid::<T>::ON));
    }
    Ok([uv.iter().map(|p| p[0]).collect(), uv.iter().map(|p| p[1]).collect()])
}

fn metric(word: &str, field: FieldId) -> Result<QualityMetric, CallError> {
    let known = QualityMetric::ALL.iter().find(|metric| metric.word() == word);
    known.copied().ok_or_else(|| {
        let words: Vec<String> =
            QualityMetric::ALL.iter().map(|m| format!("\"{}\"", m.word())).collect();
        unknown(word, "metric", words.join(", "), field)
    })
}

/// The quality of the cells of a grid [m,n]: numbers [m-1,n-1]; of a block [l,m,n]: numbers [l-1,m-1,n-1].
///
/// "sj": scaled Jacobian, the least sine of a corner angle, 1 at best, negative at an inverted
/// corner; "skew": equiangle skewness, 0 at best; "aspect" and "edge_ratio": 1 at best; "growth_i",
/// "growth_j": ratio of neighbouring cells' lengths, 1 at best; "warp": distance of the corners
/// from a plane relative to the size; "turn": the greatest angle between consecutive segments of a
/// grid line; "area". Cells at poles count as triangles.
///
/// Blocks: "sj", the least triple product of the unit edges at a corner, negative if opposite to
/// the block's own orientation; "skew" of all angles of faces; "aspect" of the lines between the
/// middles of opposite faces; "edge_ratio", "growth_i", "growth_j", "growth_k", "volume". Corners
/// at edges of zero length are ignored.
#[derive(Kind)]
#[kind(
    forward,
    class = Any,
    function,
    name = "quality",
    example = "surface s = spread_i(list(0, 1, 2), 4) * {1, 0, 0} + spread_j(list(0, 1, 2, 3), 3) * {0, 1, 0}; \
               assert min(quality(s, \"sj\")) == 1;"
)]
pub struct QualityOf<T: Scalar> {
    /// The grid, or the block.
    s: Value<T>,
    /// "sj", "skew", "aspect", "edge_ratio", "growth_i", "growth_j", "growth_k", "warp", "turn", "area" or "volume".
    #[field(default = "sj")]
    metric: Arc<str>,
}

impl<T: Scalar> Build<T> for QualityOf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        if let Value::Block(_) | Value::List(_) = &self.s {
            let BlockArg(block) =
                BlockArg::from_value(&self.s).map_err(|fault| fault.in_field(Self::S))?;
            let budget = &context.budget;
            return crate::volumes::quality(&block, &self.metric, Self::METRIC, budget);
        }
        let metric = metric(&self.metric, Self::METRIC)?;
        let GridArg(grid) =
            GridArg::from_value(&self.s).map_err(|fault| fault.in_field(Self::S))?;
        if grid.m.min(grid.n) < 2 {
            return Err(fault(
                GridError::TooFew { expected: 2, actual: [grid.m, grid.n] },
                Self::S,
            ));
        }
        let values = quality_until(&grid, metric, &context.budget)
            .map_err(|spent| fault(spent.into(), Self::S))?;
        Ok(crate::value::numbers(ArrayShape::Grid(grid.m - 1, grid.n - 1), values))
    }
}

/// The number of folded cells of a grid or a block.
#[derive(Kind)]
#[kind(
    forward,
    class = Number,
    function,
    name = "folds",
    example = "surface s = spread_i(list(0, 1, 2), 4) * {1, 0, 0} + spread_j(list(0, 1, 2, 3), 3) * {0, 1, 0}; \
               assert folds(s) == 0;"
)]
pub struct Folds<T: Scalar> {
    /// The grid, or the block.
    s: Value<T>,
}

impl<T: Scalar> Build<T> for Folds<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        if let Value::Block(_) | Value::List(_) = &self.s {
            let BlockArg(block) =
                BlockArg::from_value(&self.s).map_err(|fault| fault.in_field(Self::S))?;
            let count = crate::volumes::folded(&block, &context.budget)
                .map_err(|spent| fault(spent.into(), Self::S))?;
            return Ok(Value::Number(T::from(count as f64)));
        }
        let GridArg(grid) =
            GridArg::from_value(&self.s).map_err(|fault| fault.in_field(Self::S))?;
        let folded = folded_cells_until(&grid, &context.budget)
            .map_err(|spent| fault(spent.into(), Self::S))?;
        Ok(Value::Number(T::from(folded.len() as f64)))
    }
}

/// A table of the quality of a grid, to be printed: for each metric the least, mean and greatest
/// value and the worst cell; for a block the figures of OpenFOAM's checkMesh and the least scaled
/// Jacobian.
#[derive(Kind)]
#[kind(
    forward,
    class = Text,
    function,
    name = "report",
    example = "surface s = spread_i(list(0, 1, 2), 4) * {1, 0, 0} + spread_j(list(0, 1, 2, 3), 3) * {0, 1, 0}; \
               print report(s);"
)]
pub struct Report<T: Scalar> {
    /// The grid, or the block.
    s: Value<T>,
}

impl<T: Scalar> Build<T> for Report<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        use std::fmt::Write;
        if let Value::Block(_) | Value::List(_) = &self.s {
            let BlockArg(block) =
                BlockArg::from_value(&self.s).map_err(|fault| fault.in_field(Self::S))?;
            let text = crate::volumes::report(&block, &context.budget)
                .map_err(|spent| fault(spent.into(), Self::S))?;
            return Ok(Value::text(&text));
        }
        let GridArg(grid) =
            GridArg::from_value(&self.s).map_err(|fault| fault.in_field(Self::S))?;
        let grid = grid.re();
        if grid.m.min(grid.n) < 2 {
            return Err(fault(
                GridError::TooFew { expected: 2, actual: [grid.m, grid.n] },
                Self::S,
            ));
        }
        let n = grid.n - 1;
        let folded = folded_cells_until(&grid, &context.budget)
            .map_err(|spent| fault(spent.into(), Self::S))?
            .len();
        let mut text = format!("grid [{},{}], {folded} folded cells\n", grid.m, grid.n);
        let _ =
            writeln!(text, "{:<11}{:>13}{:>13}{:>13}  worst cell", "metric", "min", "mean", "max");
        for metric in QualityMetric::ALL {
            let values = quality_until(&grid, metric, &context.budget)
                .map_err(|spent| fault(spent.into(), Self::S))?;
            let low_is_worse =
                matches!(metric, QualityMetric::ScaledJacobian | QualityMetric::Area);
            let worse = |x: f64, y: f64| if low_is_worse { x < y } else { x > y };
            let worst =
                (0..values.len()).fold(0, |w, k| if worse(values[k], values[w]) { k } else { w });
            let min = values.iter().copied().fold(f64::INFINITY, f64::min);
            let max = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let place = format!("[{},{}]", worst / n + 1, worst % n + 1);
            let _ =
                writeln!(text, "{:<11}{min:>13.6}{mean:>13.6}{max:>13.6}  {place}", metric.word());
        }
        Ok(Value::text(text.trim_end()))
    }
}

/// Jets of the spline through a grid's own points, at its points.
pub fn jets<T: Real>(
    grid: &SurfaceGrid<T>,
    field: FieldId,
    budget: &Budget,
) -> Result<Vec<moldloft_num::SurfJet<T>>, CallError> {
    if grid.m.min(grid.n) < 3 {
        return Err(fault(GridError::TooFew { expected: 3, actual: [grid.m, grid.n] }, field));
    }
    let spline = through(grid, field, budget)?;
    let even = |k: usize, n: usize| T::from(k as f64 / (n - 1) as f64);
    let (m, n) = (grid.m, grid.n);
    let mut all = Vec::with_capacity(m * n);
    for i in 0..m {
        budget.poll().map_err(|spent| fault(spent.into(), field))?;
        all.extend((0..n).map(|j| spline.jet(even(i, m), even(j, n), Order::Second)));
    }
    Ok(all)
}
