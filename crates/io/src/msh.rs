//! Gmsh's mesh format 2.2, text, a physical group for each patch (Geuzaine and Remacle, Gmsh reference manual,
//! section MSH file format version 2): the version that most solvers and converters read.

use crate::WriteError;
use crate::error::check_positions;
use crate::numbered::used_vertices;
use crate::text::{put, real, word};
use moldloft_mesh::{Mesh, is_triangle};

/// Gmsh's numbers of a triangle and of a quadrangle.
const TRIANGLE: usize = 2;
const QUADRANGLE: usize = 3;

/// The file; patches are physical and elementary groups of their order, from 1.
///
/// # Errors
/// Positions that are not finite.
pub fn write(mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
    check_positions(mesh, f64::MAX)?;
    let (points, number) = used_vertices(mesh);
    let mut out = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n");
    put!(out, "{}\n", mesh.patches().len());
    for (k, patch) in mesh.patches().iter().enumerate() {
        put!(out, "2 {} \"{}\"\n", k + 1, word(&patch.info.name).replace('"', "_"));
    }
    put!(out, "$EndPhysicalNames\n$Nodes\n{}\n", points.len());
    for (k, p) in points.iter().enumerate() {
        let [x, y, z] = p.to_array().map(real);
        put!(out, "{} {x} {y} {z}\n", k + 1);
    }
    put!(out, "$EndNodes\n$Elements\n{}\n", mesh.faces().len());
    let mut element = 0;
    for (k, patch) in mesh.patches().iter().enumerate() {
        let group = k + 1;
        for &face in &mesh.faces()[patch.faces.clone()] {
            element += 1;
            let [a, b, c, d] = face.map(|v| number[v as usize] + 1);
            if is_triangle(face) {
                put!(out, "{element} {TRIANGLE} 2 {group} {group} {a} {b} {c}\n");
            } else {
                put!(out, "{element} {QUADRANGLE} 2 {group} {group} {a} {b} {c} {d}\n");
            }
        }
    }
    out.push_str("$EndElements\n");
    Ok(out.into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::two_patches;

    #[test]
    fn groups_carry_the_names_of_patches() {
        let mesh = two_patches();
        let text = String::from_utf8(write(&mesh).unwrap()).unwrap();
        for (k, patch) in mesh.patches().iter().enumerate() {
            assert!(text.contains(&format!("2 {} \"{}\"\n", k + 1, word(&patch.info.name))));
            let elements = text.lines().filter(|l| l.contains(&format!(" 2 {0} {0} ", k + 1)));
            assert_eq!(elements.count(), patch.faces.len());
        }
        assert!(text.contains("$Nodes\n9\n"), "{text}");
    }
}
