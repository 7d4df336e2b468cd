//! Distances of surfaces from their panels.

use crate::Mesh;
use moldloft_num::Vec3;

/// Length of the difference of two unit normals above which an edge is a crease.
const CREASE: f64 = 0.68;

/// For each patch, the approximate maximum distance of its surface from its panels: an edge of
/// length l between normals at an angle a is a l / 8 from its arc. Creases do not count.
pub fn sagittas(mesh: &Mesh) -> Vec<f64> {
    let positions = mesh.positions();
    let mut normals = vec![Vec3::zero(); positions.len()];
    let mut of_patch = |patch: &crate::Patch| {
        let faces = &mesh.faces()[patch.faces.clone()];
        faces.iter().flatten().for_each(|&v| normals[v as usize] = Vec3::zero());
        for &face in faces {
            let [a, b, c, d] = face.map(|v| positions[v as usize]);
            let normal = (c - a).cross(d - b);
            face.iter().for_each(|&v| normals[v as usize] += normal);
        }
        let mut most = 0.0_f64;
        for &face in faces {
            for (v, w) in face.into_iter().zip(face.into_iter().cycle().skip(1)) {
                let (v, w) = (v as usize, w as usize);
                let ends = [normals[v], normals[w]].map(Vec3::normalized);
                let [Some(m), Some(n)] = ends else { continue };
                let angle = (m - n).norm();
                if angle < CREASE {
                    most = most.max(angle * (positions[v] - positions[w]).norm() / 8.0);
                }
            }
        }
        most
    };
    mesh.patches().iter().map(&mut of_patch).collect()
}
