//! The grids that arrays of points are.

use crate::value::variables;
use moldloft_diag::Diagnostic;
use moldloft_io::StructuredGrid;
use moldloft_num::Real;
use moldloft_registry::{ArrayShape, Value, Vectors};

fn grid<T: Real>(a: &Vectors<T>) -> StructuredGrid {
    let [m, n] = match a.shape {
        ArrayShape::Row(n) => [n, 1],
        ArrayShape::Grid(m, n) => [m, n],
    };
    let plane = |c: usize| (0..m * n).map(|k| a.planes[c][k % m * n + k / m].re() + 0.0).collect();
    StructuredGrid { size: [m, n, 1], planes: [plane(0), plane(1), plane(2)], iblank: None }
}

/// The grid of a block's layers.
fn volume<T: Real>(layers: &[Value<T>], written: &str) -> Result<StructuredGrid, Diagnostic> {
    let mut block: Option<StructuredGrid> = None;
    for (k, layer) in layers.iter().enumerate() {
        let Value::Vectors(a) = layer else {
            let message = format!("`{written}` is a block of numbers");
            return Err(Diagnostic::error("wrong-type", message).expected("a block of points"));
        };
        let next = finite(grid(a), a.shape, &format!("layer {} of {written}", k + 1))?;
        match &mut block {
            None => block = Some(next),
            Some(block) => {
                for (all, plane) in block.planes.iter_mut().zip(next.planes) {
                    all.extend(plane);
                }
                block.size[2] += 1;
            }
        }
    }
    block.ok_or_else(|| {
        let message = format!("`{written}` is a block without layers");
        Diagnostic::error("wrong-type", message).expected("a block of points")
    })
}

/// The block, if all of its points are finite: files with others are of no use to their readers.
fn finite(
    block: StructuredGrid,
    shape: ArrayShape,
    written: &str,
) -> Result<StructuredGrid, Diagnostic> {
    let bad = |k: &usize| block.planes.iter().any(|plane| !plane[*k].is_finite());
    let Some(k) = (0..block.count()).find(bad) else { return Ok(block) };
    let [ni, ..] = block.size;
    let place = match shape {
        ArrayShape::Row(_) => format!("[{}]", k + 1),
        ArrayShape::Grid(..) => format!("[{},{}]", k % ni + 1, k / ni + 1),
    };
    let [x, y, z] = [0, 1, 2].map(|c| block.planes[c][k]);
    Err(Diagnostic::error("not-finite", format!("point {place} of `{written}` is not finite"))
        .expected("finite coordinates")
        .found(format!("{{{x}, {y}, {z}}}"))
        .help("look for a division by zero in its computation"))
}

/// The grid that an array of points is.
pub(super) fn grid_of<T: Real>(
    value: &Value<T>,
    written: &str,
) -> Result<StructuredGrid, Diagnostic> {
    match value {
        Value::Vectors(a) => finite(grid(a), a.shape, written),
        Value::Block(layers) => volume(layers, written),
        other => {
            let message = format!("`{written}` is not an array of points");
            Err(Diagnostic::error("wrong-type", message)
                .expected("a curve, a surface, a block, or a list of them")
                .found(variables::a(other)))
        }
    }
}
