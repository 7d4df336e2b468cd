//! OFF, text: vertices and polygons (Rost 1989, Object File Format; Geomview manual, section OFF).

use crate::WriteError;
use crate::error::check_positions;
use crate::numbered::used_vertices;
use crate::text::{put, real};
use moldloft_mesh::{Mesh, is_triangle};

/// The file. Quads stay quads; patches have no names here, for readers differ on comments.
///
/// # Errors
/// Positions that are not finite.
pub fn write(mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
    check_positions(mesh, f64::MAX)?;
    let (points, number) = used_vertices(mesh);
    let mut out = format!("OFF\n{} {} 0\n", points.len(), mesh.faces().len());
    for p in &points {
        let [x, y, z] = p.to_array().map(real);
        put!(out, "{x} {y} {z}\n");
    }
    for patch in mesh.patches() {
        for &face in &mesh.faces()[patch.faces.clone()] {
            let [a, b, c, d] = face.map(|v| number[v as usize]);
            if is_triangle(face) {
                put!(out, "3 {a} {b} {c}\n");
            } else {
                put!(out, "4 {a} {b} {c} {d}\n");
            }
        }
    }
    Ok(out.into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quads_and_triangles_by_patch() {
        let mesh = crate::fixtures::two_patches();
        let text = String::from_utf8(write(&mesh).unwrap()).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let used = mesh.faces().iter().flatten().collect::<std::collections::BTreeSet<_>>().len();
        assert_eq!(lines[..2], ["OFF".to_string(), format!("{used} {} 0", mesh.faces().len())]);
        assert_eq!(lines.len(), 2 + used + mesh.faces().len());
        assert!(lines.last().unwrap().starts_with("3 "));
    }
}
