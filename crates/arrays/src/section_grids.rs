//! Grids round a section in one call: O, C and H.

use crate::grids::fault;
use crate::value::{Farray, Points, distinct_neighbours, surface};
use moldloft_grid::{
    Blend, Elliptic, GridError, GridSide, Hyperbolic, MarchBoundary, Method, SurfaceGrid, Wall,
    elliptic_until, folded_cells, hyperbolic_curve_until, transfinite,
};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, CallError, Context, FieldId, Kind, Scalar, Value};

/// A section as a closed curve in z = const, clockwise from its tail, with the outside on its left;
/// a blunt tail is closed with `base` cells.
fn closed_section<T: Real>(
    mut points: Vec<Vec3<T>>,
    base: usize,
    field: FieldId,
) -> Result<Vec<Vec3<T>>, CallError> {
    if points.len() < 5 {
        return Err(CallError::new("too-few-items", "a section has at least 5 points")
            .expected("at least 5 points")
            .found(points.len().to_string())
            .in_field(field));
    }
    distinct_neighbours(&points, field)?;
    let origin = points[0].re();
    let size = points.iter().map(|p| p.re().distance(origin)).fold(0.0, f64::max);
    if points.iter().any(|p| (p.re().z - origin.z).abs() > 1e-9 * size) {
        return Err(CallError::new(
            "wrong-shape",
            "the section does not lie in a plane of constant z",
        )
        .expected("a section in x and y")
        .in_field(field));
    }
    let n = points.len();
    let area: f64 = (0..n)
        .map(|k| {
            let (a, b) = (points[k].re() - origin, points[(k + 1) % n].re() - origin);
            a.x * b.y - a.y * b.x
        })
        .sum();
    if area > 0.0 {
        points.reverse();
    }
    let (first, last) = (points[0], points[n - 1]);
    let gap = first.re().distance(last.re());
    if gap <= 1e-10 * size {
        points[n - 1] = first;
    } else {
        for k in 1..=base {
            points.push(last.lerp(first, T::from(k as f64 / base as f64)));
        }
        *points.last_mut().expect("it has points") = first;
    }
    Ok(points)
}

fn up<T: Real>() -> Vec3<T> {
    Vec3::of(0.0, 0.0, 1.0)
}

struct PlanarSupport;

impl<T: Real> moldloft_grid::Support<T> for PlanarSupport {
    fn project(&self, points: &[Vec3<T>]) -> Vec<(Vec3<T>, Vec3<T>)> {
        points.iter().map(|p| (*p, up())).collect()
    }
}

fn marched<T: Scalar>(
    curve: &[Vec3<T>],
    heights: Farray<T>,
    ends: MarchBoundary,
    [s, field]: [FieldId; 2],
    context: &Context,
) -> Result<Value<T>, CallError> {
    let heights = heights.row().map_err(|fault| fault.in_field(field))?;
    let options = Hyperbolic::new(heights).with_sides([ends; 4]);
    let marched = hyperbolic_curve_until(curve, &PlanarSupport, &options, &context.budget)
        .map_err(|error| match error {
            GridError::Heights { .. } => fault(error, field),
            error => fault(error, s),
        })?;
    let mut grids = marched.layers.into_iter().map(surface);
    Ok(grids.next().expect("one grid off a curve"))
}

/// An O-grid round a section in x and y: the surface whose line g[k,] is layer k; its first and
/// last columns coincide on a line from the trailing edge.
///
/// The section is a closed curve from tail to tail, in either direction; the gap of a blunt tail is
/// closed with `base` cells. At a sharp tail the least scaled Jacobian is the sine of half its
/// angle: a C-grid has better cells there.
#[derive(Kind)]
#[kind(
    forward,
    class = Vectors,
    function,
    name = "o_grid",
    example = "curve c = points({1, 0, 0}, {0.5, 0.1, 0}, {0, 0, 0}, {0.5, -0.1, 0}, {1, 0, 0}); \
               surface g = o_grid(c, list(0, 0.01, 0.03, 0.07)); assert g.d1 == 4 and folds(g) == 0;"
)]
pub struct OGrid<T: Scalar> {
    /// The section.
    section: Points<T>,
    /// The distances of the layers, the first 0.
    heights: Farray<T>,
    /// Cells across a blunt trailing edge.
    #[field(default = 4, min = 1, max = 1e4)]
    base: usize,
}

impl<T: Scalar> Build<T> for OGrid<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let curve = closed_section(self.section.0, self.base, Self::SECTION)?;
        marched(
            &curve,
            self.heights,
            MarchBoundary::Periodic,
            [Self::SECTION, Self::HEIGHTS],
            context,
        )
    }
}

/// A C-grid round a section in x and y: the surface whose line g[k,] is layer k, from the far end
/// of the wake below the section round the leading edge to the far end above it.
///
/// The section is a closed curve from tail to tail, in either direction, with the tail at its
/// greatest x. The wake is parallel to x over the length `wake`, with `n` cells that grow from the
/// cell at the tail; both its sides have identical points. A blunt tail is an error: `c_blocks` of
/// topologies.sdl makes its C-grid with the block behind the base.
#[derive(Kind)]
#[kind(
    forward,
    class = Vectors,
    function,
    name = "c_grid",
    example = "curve c = points({1, 0, 0}, {0.5, 0.1, 0}, {0, 0, 0}, {0.5, -0.1, 0}, {1, 0, 0}); \
               surface g = c_grid(c, list(0, 0.01, 0.03, 0.07), 2, 6); assert g.d2 == 5 + 12;"
)]
pub struct CGrid<T: Scalar> {
    /// The section.
    section: Points<T>,
    /// The distances of the layers, the first 0.
    heights: Farray<T>,
    /// The length of the wake.
    #[field(min = 0)]
    wake: T,
    /// The cells along it.
    #[field(min = 1, max = 1e6)]
    n: usize,
}

impl<T: Scalar> Build<T> for CGrid<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let count = self.section.0.len();
        let section = closed_section(self.section.0, 1, Self::SECTION)?;
        if section.len() != count {
            return Err(blunt(&section, count, Self::SECTION));
        }
        let tail = section[0];
        let first = (section[1] - tail).norm();
        let steps = wake_steps(self.wake, first, self.n, Self::WAKE)?;
        let wake = steps[1..].iter().map(|s| tail + Vec3::new(*s, T::zero(), T::zero()));
        let wake: Vec<Vec3<T>> = wake.collect();
        let curve: Vec<Vec3<T>> = wake.iter().rev().chain(&section).chain(&wake).copied().collect();
        marched(
            &curve,
            self.heights,
            MarchBoundary::Symmetry(0),
            [Self::SECTION, Self::HEIGHTS],
            context,
        )
    }
}

/// An H-grid round a section in x and y: the list of two surfaces, below and above it. Their lines
/// g[,1] contain the stagnation line, one side of the section and the wake; their lines g[,n] are
/// straight, at the last height below and above the section.
///
/// The section is a closed curve from tail to tail, in either direction, with the nose at its least
/// x and a sharp tail at its greatest. The lines ahead and behind are parallel to x over `ahead`
/// and `behind`, with `n` cells each that grow from the section's own at nose and tail. Both
/// surfaces have identical points there; both are right-handed, so the lower one is directed
/// upstream. Inner points are smoothed (`elliptic`, "sorenson"): the first cell off g[,1] has the
/// first height, at right angles; without convergence in `sweeps` a note gives the residual.
/// With `sweeps` 0 the grid is that of `tfi`.
#[derive(Kind)]
#[kind(
    forward,
    class = List,
    function,
    name = "h_grid",
    example = "load \"naca.sdl\"; curve c[41]; naca4s(c, 0, 0, 12); \
               surface upper = h_grid(c, geometric(0, 2, 0.02, 21), 2, 2, 12, 3000)[2]; assert folds(upper) == 0;"
)]
pub struct HGrid<T: Scalar> {
    /// The section.
    section: Points<T>,
    /// The distances of the lines from the section, the first 0.
    heights: Farray<T>,
    /// The length ahead of the leading edge.
    #[field(min = 0)]
    ahead: T,
    /// The length behind the trailing edge.
    #[field(min = 0)]
    behind: T,
    /// Number of cells along each of these lengths.
    #[field(min = 1, max = 1e6)]
    n: usize,
    /// Maximum number of smoothing sweeps.
    #[field(default = 3000, min = 0, max = 1e6)]
    sweeps: usize,
}

impl<T: Scalar> Build<T> for HGrid<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let count = self.section.0.len();
        let section = closed_section(self.section.0, 1, Self::SECTION)?;
        if section.len() != count {
            return Err(blunt(&section, count, Self::SECTION));
        }
        let heights = self.heights.row().map_err(|fault| fault.in_field(Self::HEIGHTS))?;
        let ascends = heights.first().is_some_and(|h| h.re() == 0.0)
            && heights.windows(2).all(|pair| pair[1].re() > pair[0].re());
        if heights.len() < 3 || !ascends {
            return Err(CallError::new("out-of-range", "heights ascend from 0")
                .expected("at least 3 heights, the first 0, each greater than the one before")
                .in_field(Self::HEIGHTS));
        }
        let x = |k: usize| section[k].re().x;
        let nose = (0..count).fold(0, |least, k| if x(k) < x(least) { k } else { least });
        if nose < 2 || nose + 3 > count || (0..count).any(|k| x(k) > x(0)) {
            return Err(CallError::new(
                "out-of-range",
                "the section has no leading edge ahead of its trailing edge",
            )
            .expected(
                "a section from its trailing edge, at the greatest x, round its leading \
            edge, at the least",
            )
            .in_field(Self::SECTION));
        }
        // Clockwise from the tail: below to the nose, then above.
        let side_lower: Vec<Vec3<T>> = section[..=nose].to_vec();
        let side_upper: Vec<Vec3<T>> = section[nose..].to_vec();
        let line = |length: T, cells: [T; 2], field: FieldId| {
            let first = (cells[0] + cells[1]) * 0.5;
            wake_steps(length, first, self.n, field)
        };
        let ahead = line(
            self.ahead,
            [
                (section[nose + 1] - section[nose]).norm(),
                (section[nose - 1] - section[nose]).norm(),
            ],
            Self::AHEAD,
        )?;
        let last = (section[count - 2] - section[0]).norm();
        let behind = line(self.behind, [(section[1] - section[0]).norm(), last], Self::BEHIND)?;
        let along = |from: Vec3<T>, steps: &[T], way: f64| -> Vec<Vec3<T>> {
            steps[1..].iter().map(|s| from + Vec3::new(*s * way, T::zero(), T::zero())).collect()
        };
        let inlet = along(section[nose], &ahead, -1.0);
        let outlet = along(section[0], &behind, 1.0);
        let upper: Vec<Vec3<T>> =
            inlet.iter().rev().chain(&side_upper).chain(&outlet).copied().collect();
        let lower: Vec<Vec3<T>> =
            outlet.iter().rev().chain(&side_lower).chain(&inlet).copied().collect();
        let mut both = Vec::new();
        for (bottom, up) in [(lower, -1.0), (upper, 1.0)] {
            both.push(surface(self_smoothed(&bottom, &heights, up, self.sweeps, context)?));
        }
        Ok(Value::list(both))
    }
}

/// The grid between a line of points and the straight line at the last height, smoothed.
fn self_smoothed<T: Scalar>(
    bottom: &[Vec3<T>],
    heights: &[T],
    up: f64,
    sweeps: usize,
    context: &Context,
) -> Result<SurfaceGrid<T>, CallError> {
    let (m, n) = (bottom.len(), heights.len());
    let most = bottom.iter().map(|p| p.y * up).fold(bottom[0].y * up, Real::max);
    let top = most + heights[n - 1];
    // The line opposite has its points by the length of this one.
    let mut length = vec![T::zero()];
    for pair in bottom.windows(2) {
        length.push(length[length.len() - 1] + (pair[1] - pair[0]).norm());
    }
    let (from, to) = (bottom[0], bottom[m - 1]);
    let opposite = |i: usize| {
        let x = from.x + (to.x - from.x) * (length[i] / length[m - 1]);
        Vec3::new(x, top * up, from.z)
    };
    let side = |end: Vec3<T>, j: usize| {
        let share = heights[j] / heights[n - 1];
        // The first cell is kept, the rest stretched to reach the line opposite.
        let whole = top - end.y * up;
        let stretched = heights[j] + (whole - heights[n - 1]) * share * share;
        Vec3::new(end.x, end.y + stretched * up, end.z)
    };
    let framed = SurfaceGrid::from_fn(m, n, |i, j| match (i, j) {
        (_, 0) => bottom[i],
        (i, j) if j + 1 == n => opposite(i),
        (0, j) => side(from, j),
        (i, j) if i + 1 == m => side(to, j),
        _ => Vec3::zero(),
    });
    let of = |error: GridError| fault(error, HGrid::<T>::SECTION);
    let grid = transfinite(&framed, Blend::Arc).map_err(of)?;
    if sweeps == 0 {
        return Ok(grid);
    }
    let wall = Wall {
        edge: GridSide::FirstJ,
        spacing: vec![heights[1]],
        angle: T::from(std::f64::consts::FRAC_PI_2),
    };
    let options = Elliptic {
        method: Method::Sorenson,
        sweeps,
        tolerance: 1e-8,
        omega: 1.0,
        walls: vec![wall],
        periodic: None,
        on: None,
    };
    let done = elliptic_until(&grid, &options, &context.budget).map_err(of)?;
    if !done.converged {
        context.remark(
            "not-converged",
            crate::grids::unsettled(&done),
            "allow more sweeps, or a first height nearer to the spacing of the section",
        );
    }
    let folded = folded_cells(&done.grid);
    if let Some(&[i, j]) = folded.first() {
        let error = GridError::Folded { count: folded.len(), at: [i + 1, j + 1], layer: None };
        return Err(of(error).help("allow more sweeps, or look at the grid with sweeps = 0"));
    }
    Ok(done.grid)
}

/// Error for an open tail of a section.
fn blunt<T: Real>(section: &[Vec3<T>], count: usize, field: FieldId) -> CallError {
    let gap = section[count - 1].re().distance(section[count].re());
    CallError::new("edges-apart", format!("the trailing edge is blunt, {gap:.3e} thick"))
        .expected("a section that ends in its first point")
        .help(
            "close the trailing edge, or make an O-grid, o_grid(section, heights), or a C-grid with a block behind the base, \
             c_blocks of topologies.sdl",
        )
        .in_field(field)
}

/// Distances from 0 to `length` in `n` cells that grow from `first`.
fn wake_steps<T: Real>(length: T, first: T, n: usize, field: FieldId) -> Result<Vec<T>, CallError> {
    if !(length.re() > 0.0) {
        return Err(CallError::new("out-of-range", "the line has no length")
            .expected("a positive length")
            .found(length.re().to_string())
            .in_field(field));
    }
    moldloft_spline::distribution::geometric(T::zero(), length, first, n + 1).map_err(|_| {
        CallError::new("out-of-range", "no line grows from the section's cell to that length")
            .expected("a longer line, or more cells")
            .in_field(field)
    })
}
