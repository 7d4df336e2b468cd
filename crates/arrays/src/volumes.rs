//! Blocks of the language: smoothed and measured.

use crate::grids::fault;
use crate::value::{BlockArg, block};
use moldloft_budget::{Budget, Spent};
use moldloft_grid::{
    BlockMetric, EllipticVolume, FaceWall, GridFace, HexMesh, VolumeGrid, block_quality_until,
    elliptic_volume_until,
};
use moldloft_registry::{ArrayShape, Build, CallError, Context, FieldId, Kind, Scalar, Value};
use std::fmt::Write;
use std::sync::Arc;

/// The number of cells of a block with an inverted corner.
///
/// # Errors
/// Label in the budget.
pub fn folded<T: Scalar>(grid: &VolumeGrid<T>, budget: &Budget) -> Result<usize, Spent> {
    let quality = grid.cell_quality_until(budget)?;
    // A left-handed block has all its corners reversed.
    let hand = if grid.re().volume() < 0.0 { -1.0 } else { 1.0 };
    let turned = |[jacobian, _]: &&[f64; 2]| !(jacobian * hand > 0.0);
    if hand > 0.0 {
        return Ok(quality.iter().filter(turned).count());
    }
    let [ni, nj, nk] = grid.size;
    let mirrored = VolumeGrid::from_fn([ni, nj, nk], |i, j, k| grid.at(ni - 1 - i, j, k));
    let quality = mirrored.cell_quality_until(budget)?;
    Ok(quality.iter().filter(|[jacobian, _]| !(*jacobian > 0.0)).count())
}

/// A metric of the cells of a block, layer by layer.
pub fn quality<T: Scalar>(
    grid: &VolumeGrid<T>,
    word: &str,
    field: FieldId,
    budget: &Budget,
) -> Result<Value<T>, CallError> {
    let Some(metric) = BlockMetric::ALL.into_iter().find(|metric| metric.word() == word) else {
        let words: Vec<String> =
            BlockMetric::ALL.iter().map(|m| format!("\"{}\"", m.word())).collect();
        let message = format!("blocks have no metric \"{word}\"");
        return Err(CallError::new("unknown-word", message)
            .expected(words.join(", "))
            .found(format!("\"{word}\""))
            .in_field(field));
    };
    let values = block_quality_until(grid, metric, budget).map_err(|s| fault(s.into(), field))?;
    let [ci, cj, ck] = grid.size.map(|n| n - 1);
    let layer = |k: usize| {
        let values = (0..ci * cj).map(|cell| values[cell * ck + k]).collect();
        crate::value::numbers(ArrayShape::Grid(ci, cj), values)
    };
    Ok(Value::block((0..ck).map(layer)).expect("layers of one shape"))
}

/// The figures of a block, by the rules of OpenFOAM's checkMesh and beyond them.
///
/// # Errors
/// Label in the budget.
pub fn report<T: Scalar>(grid: &VolumeGrid<T>, budget: &Budget) -> Result<String, Spent> {
    let [ni, nj, nk] = grid.size;
    let mesh = HexMesh::of_blocks_until(std::slice::from_ref(grid), &[], budget)?;
    let check = mesh.check_until(budget)?;
    let turned = folded(grid, budget)?;
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
    Ok(text)
}

/// A block smoothed by the elliptic equations; its faces are fixed.
///
/// `method`: "laplace" equalises spacings, "middlecoff" propagates the spacing of the edges inward.
/// `walls` names faces, "i1", "in", "j1", "jn", "k1", "kn", separated by blanks, at which grid
/// lines are perpendicular with the first cell height `spacing` (by the iteration of Hilgenstock
/// 1988). Without convergence in `n` sweeps a note gives the residual; folded cells are an
/// error.
#[derive(Kind)]
#[kind(
    forward,
    class = Block,
    function,
    name = "elliptic_block",
    example = "surface b[4,4]; for (i = 1:4) for (j = 1:4) b[i,j] = {i, j, 0}; \
               print report(elliptic_block(hyperbolic(b, list(0, 1, 2, 3))));"
)]
pub struct EllipticBlock<T: Scalar> {
    /// The block.
    b: BlockArg<T>,
    /// Maximum number of sweeps.
    #[field(default = 2000, min = 0, max = 1e6)]
    n: usize,
    /// Convergence: maximum displacement of a point in a sweep, relative to the size.
    #[field(default = 1e-8, min = 0)]
    tol: T,
    /// "laplace" or "middlecoff".
    #[field(default = "middlecoff")]
    method: Arc<str>,
    /// Walls: "i1", "in", "j1", "jn", "k1", "kn".
    #[field(default = "")]
    walls: Arc<str>,
    /// First cell height at the walls.
    #[field(min = 0)]
    spacing: Option<T>,
    /// Over-relaxation.
    #[field(default = 1, min = 0.01, max = 1.99)]
    omega: T,
}

impl<T: Scalar> Build<T> for EllipticBlock<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let BlockArg(grid) = self.b;
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
        crate::grids::extended(&grid.planes, Self::B)?;
        let done = elliptic_volume_until(&grid, &options, &context.budget)
            .map_err(|error| fault(error, Self::B))?;
        if !done.converged && self.n > 0 {
            let change = done.history.last().copied().unwrap_or(f64::INFINITY);
            let mut text = format!(
                "the block has not converged: sweep {} still moves points by {change:.2e} of its \
                size",
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
        let turned =
            folded(&done.grid, &context.budget).map_err(|spent| fault(spent.into(), Self::B))?;
        if turned > 0 {
            return Err(CallError::new("folded-grid", format!("{turned} cells are folded"))
                .expected("cells that are not turned over")
                .found(format!("{turned} folded cells"))
                .in_field(Self::B));
        }
        Ok(block(done.grid.layers()))
    }
}
