//! Vertices numbered in the order of their use: those of no face may hold anything, so they are left out.

use moldloft_mesh::Mesh;
use moldloft_num::Vec3;

/// The vertices that faces use, and of each vertex of the mesh its number among them.
pub(crate) fn used_vertices(mesh: &Mesh) -> (Vec<Vec3>, Vec<usize>) {
    let mut used = vec![false; mesh.positions().len()];
    mesh.faces().iter().flatten().for_each(|&v| used[v as usize] = true);
    let mut number = vec![0; used.len()];
    let mut points = Vec::new();
    for (v, &p) in mesh.positions().iter().enumerate().filter(|&(v, _)| used[v]) {
        number[v] = points.len();
        points.push(p);
    }
    (points, number)
}
