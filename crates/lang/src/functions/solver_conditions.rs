//! Boundary conditions by the names and numbers of FUN3D, and files that need them: neutral maps and UGRID.

use crate::functions::block_files::Connected;
use crate::functions::named_blocks::{NamedBlock, face_points};
use moldloft_diag::Diagnostic;
use moldloft_grid::{GridFace, HexMesh};
use moldloft_io::cgns::FacePart;
use moldloft_io::neutral_map::{MapEntry, MapFace};
use moldloft_num::{Box3, Vec3};

/// Extent along an axis, relative to the size, below which a boundary is in a plane across it.
const ACROSS: f64 = 1e-6;

/// The number and the name of FUN3D's boundary condition (FUN3D manual, "Boundary conditions").
///
/// # Errors
/// Types without one; a symmetry boundary that is not in a plane of constant x, y or z.
fn condition(
    name: &str,
    kind: &str,
    points: impl IntoIterator<Item = Vec3>,
) -> Result<(u32, &'static str), Diagnostic> {
    let cannot = |message: String| Diagnostic::error("cannot-write", message);
    Ok(match kind {
        "wall" => (4000, "viscous_solid"),
        "farfield" => (5000, "farfield_riem"),
        "inflow" => (7011, "subsonic_inflow_pt"),
        "outflow" => (5051, "back_pressure"),
        "symmetry" => {
            let bounds = Box3::around(points);
            let extent = (bounds.high - bounds.low).to_array();
            let size = bounds.diagonal();
            let Some(axis) = (0..3).find(|axis| extent[*axis] <= ACROSS * size) else {
                return Err(cannot(format!(
                    "the symmetry boundary `{name}` is not in a plane of constant x, y or z"
                ))
                .expected("a plane across an axis: FUN3D has no other symmetry")
                .found(format!("extents {} x {} x {}", extent[0], extent[1], extent[2])));
            };
            [(6661, "symmetry_x"), (6662, "symmetry_y"), (6663, "symmetry_z")][axis]
        }
        _ => {
            return Err(cannot(format!(
                "the boundary `{name}` of type {kind} has no condition here"
            ))
            .expected("wall, symmetry, farfield, inflow or outflow"));
        }
    })
}

/// The conditions of the boundaries of a mesh, in their order.
///
/// # Errors
/// Faces without a name; types without a condition.
pub(super) fn conditions(mesh: &HexMesh) -> Result<Vec<(u32, String)>, Diagnostic> {
    let each = mesh.patches.iter().map(|patch| {
        if patch.name == "defaultFaces" {
            return Err(unnamed(&format!("{} faces", patch.faces.len())));
        }
        let points = patch.faces.iter().flatten().map(|n| mesh.points[*n]);
        condition(&patch.name, &patch.kind, points).map(|(number, _)| (number, patch.name.clone()))
    });
    each.collect()
}

fn unnamed(what: &str) -> Diagnostic {
    Diagnostic::error("cannot-write", format!("{what} of the boundary have no name"))
        .expected("a type for each boundary")
        .help("name them behind the block: \"i1 = inlet inflow, k1 = body wall\"")
}

/// The entries of a neutral map: joints, then boundaries by the names of FUN3D; a boundary of type patch is called by its
/// own name.
///
/// # Errors
/// Periodic, empty and wedge boundaries; faces without a name or without an area.
pub(super) fn map_entries(
    blocks: &[NamedBlock],
    connected: &Connected,
) -> Result<Vec<MapEntry>, Diagnostic> {
    for (block, of) in blocks.iter().enumerate() {
        let found = (0..6).find(|&face| is_pole(of, face));
        if let Some(face) = found {
            let message =
                format!("{} of `{}` is a pole", GridFace::ALL[face].word(), blocks[block].name);
            return Err(Diagnostic::error("cannot-write", message)
                .expected("faces with an area: a neutral map has no poles"));
        }
    }
    if let Some((block, face, ..)) = connected.nameless.first() {
        let face = GridFace::ALL[*face].word();
        return Err(unnamed(&format!("the faces {face} of `{}`", blocks[*block].name)));
    }
    let face = |(block, face, from, to): FacePart| MapFace { block, face, from, to };
    let mut entries = Vec::new();
    for (own, other, transform, movement) in &connected.joints {
        if movement.is_some() {
            return Err(Diagnostic::error(
                "cannot-write",
                "a neutral map has no periodic boundaries",
            )
            .expected("wall, symmetry, farfield, inflow, outflow or patch"));
        }
        let axes = transform.map(|axis| axis.unsigned_abs() as usize - 1);
        entries.push(MapEntry::Joined([face(*own), face(*other)], axes));
    }
    for (part, name, kind) in &connected.boundaries {
        let word = match &**kind {
            "patch" => name.clone(),
            kind => condition(name, kind, face_points(blocks, part).0)?.1.to_string(),
        };
        entries.push(MapEntry::Boundary(face(*part), word));
    }
    Ok(entries)
}

/// True of a face whose points are on a line or in one point, by the coincidence of opposite edges.
fn is_pole(block: &NamedBlock, face: usize) -> bool {
    let side = GridFace::ALL[face];
    let [a, b] = side.others();
    let size = block.grid.size;
    let at = |p: usize, q: usize| {
        let mut index = [0; 3];
        index[side.axis] = if side.last { size[side.axis] - 1 } else { 0 };
        (index[a], index[b]) = (p, q);
        block.grid.at(index)
    };
    let still = |along: usize, across: usize, swap: bool| {
        let point = |p: usize, q: usize| if swap { at(q, p) } else { at(p, q) };
        (0..across).all(|q| (1..along).all(|p| point(p, q) == point(0, q)))
    };
    still(size[a], size[b], false) || still(size[b], size[a], true)
}
