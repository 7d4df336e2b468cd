//! Nemoh's mesh file (`.dat` or `.mar`).
//!
//! `2 sym`, sym = 1 when y = 0 is a symmetry plane and one side is listed; the vertices `i x y z` up to
//! a line of zeros; the panels, four numbers of vertices each, up to a line of zeros (Babarit and
//! Delhommeau 2015, Nemoh's documentation; read by Capytaine's `_read_mar`). Corners are
//! counter-clockwise seen from the water; a triangle repeats its last.

use crate::solver::{SolverPanels, corners};
use crate::text::put;
use crate::{PanelFileOptions, WriteError};
use moldloft_mesh::Mesh;

/// The file of the mesh's skin.
///
/// # Errors
/// [`WriteError::CannotHold`] for a mesh mirrored in x = 0, which the format has no flag for: mirror
/// it first ([`Mesh::with_mirror_image`]). Positions that are not finite; a half that crosses its
/// plane.
pub fn write(mesh: &Mesh, options: PanelFileOptions) -> Result<Vec<u8>, WriteError> {
    if options.mirror_x {
        return Err(WriteError::CannotHold { format: "Nemoh", what: "symmetry in x = 0" });
    }
    let panels = SolverPanels::of(mesh, options)?;
    let mut out = format!("2 {}\n", u8::from(options.mirror_y));
    panels.node_lines(&mut out);
    out.push_str("0 0. 0. 0.\n");
    for &face in &panels.faces {
        let ([a, b, c, d], _) = corners(face);
        put!(out, "{a} {b} {c} {d}\n");
    }
    out.push_str("0 0 0 0\n");
    Ok(out.into_bytes())
}
