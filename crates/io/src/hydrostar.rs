//! HydroStar's mesh file (`.hst`).
//!
//! Keywords with their data: `PROJECT`, `SYMMETRY` (0 none, 1 in y = 0, 2 in x = 0 as well),
//! `COORDINATES` with `i x y z`, `PANEL TYPE 1` with `i n1 n2 n3 n4` (Bureau Veritas, HydroStar for
//! Experts user manual; read by Capytaine's `_read_hst`). Corners are counter-clockwise seen from
//! the water; a triangle has three.

use crate::solver::{SolverPanels, corners, title};
use crate::text::put;
use crate::{PanelFileOptions, WriteError};
use moldloft_mesh::Mesh;

/// The file of the mesh's skin.
///
/// # Errors
/// [`WriteError::CannotHold`] for a mesh mirrored in x = 0 alone, which the format has no flag for.
/// Positions that are not finite; a half that crosses its plane.
pub fn write(mesh: &Mesh, name: &str, options: PanelFileOptions) -> Result<Vec<u8>, WriteError> {
    let symmetry = match (options.mirror_x, options.mirror_y) {
        (false, false) => 0,
        (false, true) => 1,
        (true, true) => 2,
        (true, false) => {
            let what = "symmetry in x = 0 without symmetry in y = 0";
            return Err(WriteError::CannotHold { format: "HydroStar", what });
        }
    };
    let panels = SolverPanels::of(mesh, options)?;
    let mut out = format!("PROJECT: {}\n\nSYMMETRY {symmetry}\n\nCOORDINATES\n", title(name));
    panels.node_lines(&mut out);
    out.push_str("ENDCOORDINATES\n\nPANEL TYPE 1\n");
    for (k, &face) in (1..).zip(&panels.faces) {
        let (corners, n) = corners(face);
        put!(out, "{k}");
        for v in &corners[..n] {
            put!(out, " {v}");
        }
        out.push('\n');
    }
    out.push_str("ENDPANEL\n\nENDFILE\n");
    Ok(out.into_bytes())
}
