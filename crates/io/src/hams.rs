//! The mesh file of HAMS (`.pnl`): `HullMesh.pnl`, and `WaterplaneMesh.pnl` of the lids.
//!
//! Three lines of title; `panels nodes xsym ysym`; the vertices `i x y z` and the panels `i n v1 .. vn`
//! between lines of comment (Liu 2019, HAMS user manual; read by Capytaine's `_read_pnl`). The flag
//! xsym says that x = 0 is a symmetry plane, ysym that y = 0 is; HAMS refuses both at once. Corners are
//! counter-clockwise seen from the water; a triangle has three.

use crate::solver::{SolverPanels, corners};
use crate::text::put;
use crate::{PanelFileOptions, WriteError};
use moldloft_mesh::{Mesh, Tag, TopologyBuilder};

/// The file of the mesh's skin.
///
/// # Errors
/// [`WriteError::CannotHold`] for a mesh mirrored in both planes: write one of them out first
/// ([`Mesh::with_mirror_image`]). Positions that are not finite; a half that crosses its plane.
pub fn write(mesh: &Mesh, options: PanelFileOptions) -> Result<Vec<u8>, WriteError> {
    if options.mirror_x && options.mirror_y {
        return Err(WriteError::CannotHold { format: "HAMS", what: "symmetry in x = 0 and y = 0" });
    }
    Ok(file(&SolverPanels::of(mesh, options)?, "Hull", options))
}

/// The file of the lids, HAMS's `WaterplaneMesh.pnl`; `None` for a mesh without lids.
///
/// # Errors
/// As for [`write()`].
pub fn write_lids(mesh: &Mesh, options: PanelFileOptions) -> Result<Option<Vec<u8>>, WriteError> {
    let mut builder = TopologyBuilder::new();
    let lids = mesh.patches().iter().filter(|p| p.info.tag == Tag::Lid && !p.faces.is_empty());
    let mut found = false;
    let build = || {
        builder.add_vertices(mesh.positions().len())?;
        for patch in lids {
            found = true;
            let faces = mesh.faces()[patch.faces.clone()].iter().copied();
            builder.add_faces(patch.info.clone(), faces)?;
        }
        Mesh::new(builder.build().into(), mesh.positions().to_vec())
    };
    // The vertices and faces are those of a mesh that exists.
    let lids = build().expect("a part of a mesh is a mesh");
    if !found {
        return Ok(None);
    }
    Ok(Some(file(
        &SolverPanels::of(&lids, PanelFileOptions { lids: true, ..options })?,
        "Waterplane",
        options,
    )))
}

fn file(panels: &SolverPanels, what: &str, options: PanelFileOptions) -> Vec<u8> {
    let (x, y) = (u8::from(options.mirror_x), u8::from(options.mirror_y));
    let rule = "-".repeat(14);
    let mut out = format!(
        "    {rule}{what} Mesh File{rule}\n\n    # Number of Panels, Nodes, X-Symmetry and \
         Y-Symmetry\n    {} {} {x} {y}\n\n    #Start Definition of Node Coordinates\n",
        panels.faces.len(),
        panels.points.len()
    );
    panels.node_lines(&mut out);
    out.push_str("    #End Definition of Node Coordinates\n\n");
    out.push_str("    #Start Definition of Node Relations\n");
    for (k, &face) in (1..).zip(&panels.faces) {
        let (corners, n) = corners(face);
        put!(out, "{k} {n}");
        for v in &corners[..n] {
            put!(out, " {v}");
        }
        out.push('\n');
    }
    put!(out, "    #End Definition of Node Relations\n\n    {rule}End {what} Mesh File{rule}\n");
    out.into_bytes()
}
