//! The points of objects that are made of a file: `TabPoint`, `TabCurve`, `TabSurf`.

use crate::World;
use crate::functions::files::RunFiles;
use moldloft_diag::Diagnostic;
use moldloft_io::{plot3d, points};
use moldloft_num::Vec3;
use moldloft_registry::{ArrayShape, Row, Scalar, Value, Vectors};
use std::sync::Arc;

/// Reads the file of the argument `file` into `points`, and its number of rows into `rows` if
/// stated; nothing without a file, or with given points.
///
/// # Errors
/// A file that cannot be read, with the field that names it; a file and points at once.
pub(crate) fn fill<T: Scalar>(
    files: &RunFiles,
    world: &dyn World,
    from: &str,
    row: &Row,
    args: &mut [Value<T>],
) -> Result<(), (usize, Diagnostic)> {
    let (Some(at), Some(into)) = (row.field("file"), row.field("points")) else { return Ok(()) };
    let path = match &args[at] {
        Value::Text(path) if !path.is_empty() => path.clone(),
        _ => return Ok(()),
    };
    let fault = |diagnostic: Diagnostic| (at, diagnostic);
    if !matches!(args[into], Value::Unset) {
        let message = "a table has a file or points, not both";
        return Err(fault(
            Diagnostic::error("unused-argument", message).help("leave one of them out"),
        ));
    }
    let bytes = files.bytes(world, from, &path).map_err(fault)?;
    let unreadable = |e: &dyn std::fmt::Display| {
        fault(Diagnostic::error("cannot-read", format!("cannot read `{path}`: {e}")))
    };
    let suffix = path.rsplit('.').next().unwrap_or("").to_ascii_lowercase();
    let rows: Vec<Vec3> = if matches!(&*suffix, "x" | "xyz" | "p3d" | "p3dfmt" | "grd") {
        let (blocks, _) = plot3d::read(&bytes).map_err(|e| unreadable(&e))?;
        let flat = blocks.first().filter(|b| blocks.len() == 1 && b.size[2] == 1);
        let Some(block) = flat else {
            let message = format!("`{path}` is not one grid of points");
            return Err(fault(
                Diagnostic::error("cannot-read", message)
                    .expected("one block of one layer")
                    .found(format!("{} blocks", blocks.len())),
            ));
        };
        state_rows(row, args, block.size[1]);
        // Plot3D runs along its first index fastest, as the rows of a table do.
        let [ni, nj, _] = block.size;
        let layer: Vec<Vec3> = block.layer(0).into_iter().collect();
        (0..nj).flat_map(|j| (0..ni).map(move |i| (i, j))).map(|(i, j)| layer[i * nj + j]).collect()
    } else {
        let table = points::read(&bytes).map_err(|e| unreadable(&e))?;
        // Empty lines part the rows.
        let alike = table.blocks.windows(2).all(|pair| pair[0].len() == pair[1].len());
        if table.blocks.len() > 1 && alike {
            state_rows(row, args, table.blocks.len());
        }
        table.rows
    };
    if let Some(bad) = rows.iter().position(|p| !p.is_finite()) {
        return Err(unreadable(&format!("point {} is not finite", bad + 1)));
    }
    let lifted: Vec<Vec3<T>> = rows.into_iter().map(Vec3::lifted).collect();
    args[into] = Value::Vectors(Arc::new(Vectors::new(ArrayShape::Row(lifted.len()), lifted)));
    Ok(())
}

/// Gives the number of rows that the file shows, unless it is stated.
fn state_rows<T: Scalar>(row: &Row, args: &mut [Value<T>], count: usize) {
    let Some(at) = row.field("rows") else { return };
    if matches!(&args[at], Value::Number(x) if x.re() != 0.0) {
        return;
    }
    args[at] = Value::Number(T::from(count as f64));
}
