//! Blocks of the language, lists of layers: smoothed and measured; grids round sections in one call.

use crate::grids::fault;
use crate::value::{Farray, GridArg, Points, surface};
use moldloft_grid::{
    EllipticVolume, FaceWall, GridError, GridFace, HexMesh, Hyperbolic, MarchBoundary, SurfaceGrid,
    VolumeGrid, elliptic_volume_until, hyperbolic_curve_until,
};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, CallError, Context, FieldId, FromValue, Kind, Scalar, Value};
use std::fmt::Write;
use std::sync::Arc;

/// The block whose layers a list holds.
pub fn volume<T: Scalar>(layers: &[Value<T>], field: FieldId) -> Result<VolumeGrid<T>, CallError> {
    let mut grids: Vec<SurfaceGrid<T>> = Vec::with_capacity(layers.len());
    for (k, layer) in layers.iter().enumerate() {
        let grid = GridArg::from_value(layer).map_err(|fault| fault.in_item(k).in_field(field))?;
        grids.push(grid.0);
    }
    let grid = VolumeGrid::from_layers(&grids).map_err(|error| fault(error, field))?;
    if grid.size.iter().any(|n| *n < 2) {
        let [ni, nj, nk] = grid.size;
        return Err(CallError::new(
            "too-few-items",
            format!("a block [{ni},{nj},{nk}] has no cells"),
        )
        .expected("at least 2 points along each index")
        .in_field(field));
    }
    Ok(grid)
}

/// The number of cells of a block that are turned over at a corner.
pub fn folded<T: Scalar>(grid: &VolumeGrid<T>) -> usize {
    let quality = grid.cell_quality();
    // A left-handed block has all its corners the other way.
    let hand = if grid.re().volume() < 0.0 { -1.0 } else { 1.0 };
    let turned = |[jacobian, _]: &&[f64; 2]| !(jacobian * hand > 0.0);
    if hand > 0.0 {
        return quality.iter().filter(turned).count();
    }
    let [ni, nj, nk] = grid.size;
    let mirrored = VolumeGrid::from_fn([ni, nj, nk], |i, j, k| grid.at(ni - 1 - i, j, k));
    mirrored.cell_quality().iter().filter(|[jacobian, _]| !(*jacobian > 0.0)).count()
}

/// The figures of a block, by the rules of OpenFOAM's checkMesh and beyond them.
pub fn report<T: Scalar>(grid: &VolumeGrid<T>) -> String {
    let [ni, nj, nk] = grid.size;
    let check = HexMesh::of_blocks(std::slice::from_ref(grid), &[]).check();
    let turned = folded(grid);
    let mut text = format!("block [{ni},{nj},{nk}], {turned} folded cells\n");
    let (_, nc, kc) = (ni - 1, nj - 1, nk - 1);
    let cell = check.jacobian.1;
    let place = [cell / (nc * kc) + 1, cell / kc % nc + 1, cell % kc + 1];
    let mut line = |name: &str, value: f64| {
        let _ = writeln!(text, "{name:<28}{value:>14.6}");
    };
    line("scaled Jacobian, least", check.jacobian.0);
    line("non-orthogonality, greatest", check.non_orthogonality[0]);
    line("non-orthogonality, mean", check.non_orthogonality[1]);
    line("skewness, greatest", check.skewness);
    line("aspect ratio, greatest", check.aspect);
    line("face weight, least", check.weight);
    line("volume ratio, least", check.volume_ratio);
    line("face flatness, least", check.flatness);
    let _ = write!(
        text,
        "volumes {:e} to {:e}, least Jacobian in cell {place:?}",
        check.volume[0], check.volume[1]
    );
    text
}

/// A block, given as the list of its layers, smoothed by the elliptic equations; its faces stay. The value is the
/// list of layers.
///
/// `method`: "laplace" evens lines out, "middlecoff" carries the spacing of the edges inward. `walls` names faces,
/// "i1", "in", "j1", "jn", "k1", "kn", blank-separated, off which lines leave at right angles with the first cell
/// `spacing` (by the iteration of Hilgenstock 1988). A remark says how far off the block is when `n` sweeps are not
/// enough; folded cells are refused.
#[derive(Kind)]
#[kind(
    class = List,
    function,
    name = "elliptic_block",
    example = "surface b[4,4]; for (i = 1:4) for (j = 1:4) b[i,j] = {i, j, 0}; \
               print report(elliptic_block(hyperbolic(b, list(0, 1, 2, 3))));"
)]
pub struct EllipticBlock<T: Scalar> {
    /// The layers.
    layers: Vec<Value<T>>,
    /// The most sweeps.
    #[field(default = 2000, min = 0, max = 1e6)]
    n: usize,
    /// Stops when no point moves by more than this share of the size.
    #[field(default = 1e-8, min = 0)]
    tol: T,
    /// "laplace" or "middlecoff".
    #[field(default = "middlecoff")]
    method: Arc<str>,
    /// Walls.
    #[field(default = "")]
    walls: Arc<str>,
    /// The first cell off the walls.
    #[field(min = 0)]
    spacing: Option<T>,
    /// Over-relaxation.
    #[field(default = 1, min = 0.01, max = 1.99)]
    omega: T,
}

impl<T: Scalar> Build<T> for EllipticBlock<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let grid = volume(&self.layers, Self::LAYERS)?;
        let keep_spacing = match &*self.method {
            "laplace" => false,
            "middlecoff" => true,
            word => {
                return Err(CallError::new(
                    "unknown-word",
                    format!("there is no method \"{word}\""),
                )
                .expected("\"laplace\" or \"middlecoff\"")
                .found(format!("\"{word}\""))
                .in_field(Self::METHOD));
            }
        };
        let mut walls = Vec::new();
        for word in self.walls.split([' ', ',']).filter(|word| !word.is_empty()) {
            let Some(face) = GridFace::ALL.into_iter().find(|face| face.word() == word) else {
                return Err(CallError::new("unknown-word", format!("there is no face \"{word}\""))
                    .expected("\"i1\", \"in\", \"j1\", \"jn\", \"k1\" or \"kn\"")
                    .found(format!("\"{word}\""))
                    .in_field(Self::WALLS));
            };
            let Some(spacing) = self.spacing.filter(|spacing| spacing.re() > 0.0) else {
                return Err(CallError::new("missing-argument", "walls need a spacing")
                    .expected("a positive length")
                    .in_field(Self::SPACING));
            };
            walls.push(FaceWall { face, spacing });
        }
        let options = EllipticVolume {
            keep_spacing,
            sweeps: self.n,
            tolerance: self.tol.re(),
            omega: self.omega.re(),
            walls,
        };
        crate::grids::extended(&grid.planes, Self::LAYERS)?;
        let done = elliptic_volume_until(&grid, &options, &context.budget)
            .map_err(|error| fault(error, Self::LAYERS))?;
        if !done.converged && self.n > 0 {
            let change = done.history.last().copied().unwrap_or(f64::INFINITY);
            let mut text = format!(
                "the block has not settled: sweep {} still moves points by {change:.2e} of its size",
                done.sweeps
            );
            for wall in &done.walls {
                let ([low, high], angle) = (wall.cells, wall.angle.to_degrees());
                let _ = write!(
                    text,
                    "; at {} cells are {low:.4} to {high:.4} of the spacing, angles {angle:.2} degrees off",
                    wall.face
                );
            }
            context.remark("not-converged", text, "allow more sweeps, or a wider tolerance");
        }
        let turned = folded(&done.grid);
        if turned > 0 {
            return Err(CallError::new("folded-grid", format!("{turned} cells are folded"))
                .expected("cells that are not turned over")
                .found(format!("{turned} folded cells"))
                .in_field(Self::LAYERS));
        }
        Ok(Value::list(done.grid.layers().into_iter().map(surface)))
    }
}

/// A section as a closed curve in z = const, clockwise from its tail, so that the left of it is outside; a blunt tail
/// is closed with `base` cells.
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

/// An O-grid round a section in x and y: the surface whose line g[k,] is layer k, its first and last columns the same
/// line from the tail.
///
/// The section is given once round, from the tail to the tail, either way; the gap of a blunt tail is closed with
/// `base` cells. At a sharp tail the least scaled Jacobian is the sine of half its angle: a C-grid has better cells
/// there.
#[derive(Kind)]
#[kind(
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
    /// Cells across a blunt tail.
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

/// A C-grid round a section in x and y: the surface whose line g[k,] is layer k, from the far end of the wake below
/// the section round its nose to the far end above it.
///
/// The section is given once round, from the tail to the tail, either way, the tail at its greatest x. The wake runs
/// along x for the length `wake` in `n` cells that grow from the cell at the tail; both its sides have the same
/// points, to the bit. A blunt tail is an error: close it, or make an O-grid.
#[derive(Kind)]
#[kind(
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
            let gap = section[count - 1].re().distance(section[count].re());
            return Err(CallError::new(
                "edges-apart",
                format!("the tail is blunt, {gap:.3e} thick"),
            )
            .expected("a section that ends in its first point")
            .help("close the tail, or make an O-grid: o_grid(section, heights)")
            .in_field(Self::SECTION));
        }
        let tail = section[0];
        let first = (section[1] - tail).norm();
        if !(self.wake.re() > 0.0) {
            return Err(CallError::new("out-of-range", "a wake has a length")
                .expected("a positive length")
                .found(self.wake.re().to_string())
                .in_field(Self::WAKE));
        }
        let steps =
            moldloft_spline::distribution::geometric(T::zero(), self.wake, first, self.n + 1)
                .map_err(|_| {
                    CallError::new(
                        "out-of-range",
                        "no wake grows from the cell at the tail to that length",
                    )
                    .expected("a longer wake, or more cells")
                    .in_field(Self::WAKE)
                })?;
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
