//! SU2's mesh format, text: the panels as elements, and a marker for each patch (SU2 documentation, Mesh File).

use crate::WriteError;
use crate::error::check_positions;
use crate::numbered::used_vertices;
use crate::text::{put, real, word};
use moldloft_mesh::{Mesh, is_triangle};

/// VTK's numbers of a triangle and of a quadrilateral.
const TRIANGLE: usize = 5;
const QUADRILATERAL: usize = 9;

/// The file.
///
/// # Errors
/// Positions that are not finite.
pub fn write(mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
    check_positions(mesh, f64::MAX)?;
    let (points, number) = used_vertices(mesh);
    let mut out = format!("NDIME= 3\nNELEM= {}\n", mesh.faces().len());
    let line = |face: [u32; 4]| {
        let [a, b, c, d] = face.map(|v| number[v as usize]);
        if is_triangle(face) {
            format!("{TRIANGLE} {a} {b} {c}")
        } else {
            format!("{QUADRILATERAL} {a} {b} {c} {d}")
        }
    };
    for (k, &face) in mesh.faces().iter().enumerate() {
        put!(out, "{} {k}\n", line(face));
    }
    put!(out, "NPOIN= {}\n", points.len());
    for (k, p) in points.iter().enumerate() {
        let [x, y, z] = p.to_array().map(real);
        put!(out, "{x} {y} {z} {k}\n");
    }
    put!(out, "NMARK= {}\n", mesh.patches().len());
    for patch in mesh.patches() {
        let faces = &mesh.faces()[patch.faces.clone()];
        put!(out, "MARKER_TAG= {}\nMARKER_ELEMS= {}\n", word(&patch.info.name), faces.len());
        for &face in faces {
            put!(out, "{}\n", line(face));
        }
    }
    Ok(out.into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::two_patches;

    #[test]
    fn counts_and_markers() {
        let mesh = two_patches();
        let text = String::from_utf8(write(&mesh).unwrap()).unwrap();
        assert!(text.starts_with(&format!("NDIME= 3\nNELEM= {}\n", mesh.faces().len())));
        assert!(text.contains("NPOIN= 9\n") && text.contains("NMARK= 3\n"), "{text}");
        assert!(text.contains(&format!("MARKER_TAG= {}\n", word(&mesh.patches()[0].info.name))));
    }
}
