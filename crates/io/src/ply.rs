//! PLY, binary: vertices in double precision and faces (Turk 1994, The PLY Polygon File Format).
//!
//! The patches stand in comments, each with its run of faces: properties of faces besides their
//! corners would say it too, but common readers (meshio 5.3, trimesh 5) refuse such files.

use crate::WriteError;
use crate::error::check_positions;
use crate::text::{put, word};
use moldloft_mesh::{Mesh, is_triangle};

/// The file. Quads stay quads where there are no triangles: common readers (trimesh 5, gmsh 4.15) refuse a binary
/// list of faces of different lengths.
///
/// # Errors
/// Positions that are not finite; more than 2^31 - 1 vertices.
pub fn write(mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
    check_positions(mesh, f64::MAX)?;
    let triangles = mesh.faces().iter().filter(|f| is_triangle(**f)).count();
    let split = (triangles > 0 && triangles < mesh.faces().len()).then(|| mesh.triangulated());
    let mesh = split.as_ref().unwrap_or(mesh);
    let mut used = vec![false; mesh.positions().len()];
    mesh.faces().iter().flatten().for_each(|&v| used[v as usize] = true);
    let mut number = vec![0i32; used.len()];
    let mut points = Vec::new();
    for (v, p) in mesh.positions().iter().enumerate().filter(|&(v, _)| used[v]) {
        let what = "vertices";
        let count = points.len();
        number[v] = i32::try_from(count).map_err(|_| WriteError::TooLarge { what, count })?;
        points.push(p.to_array());
    }
    let mut head = String::from("ply\nformat binary_little_endian 1.0\n");
    for patch in mesh.patches() {
        let (name, tag) = (word(&patch.info.name), word(patch.info.tag.word()));
        put!(head, "comment patch {name} {tag} faces {} {}\n", patch.faces.start, patch.faces.end);
    }
    put!(head, "element vertex {}\n", points.len());
    for axis in ["x", "y", "z"] {
        put!(head, "property double {axis}\n");
    }
    put!(head, "element face {}\nproperty list uchar int vertex_indices\n", mesh.faces().len());
    head.push_str("end_header\n");
    let mut out = head.into_bytes();
    for x in points.iter().flatten() {
        out.extend_from_slice(&(x + 0.0).to_le_bytes());
    }
    for &face in mesh.faces() {
        let n = if is_triangle(face) { 3 } else { 4 };
        out.push(n as u8);
        for v in &face[..n] {
            out.extend_from_slice(&number[*v as usize].to_le_bytes());
        }
    }
    Ok(out)
}
