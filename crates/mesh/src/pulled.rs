//! The derivatives of area and volume of a mesh by its vertices.

use crate::{Mesh, Panel};
use moldloft_num::{GAUSS_2_UNIT, Vec3};

/// The derivatives of `area * A + volume * V` by each vertex, with the area A and the volume V from
/// `crate::measure`.
///
/// V of a quad is ((a x b) . (c + d) + (c x d) . (a + b)) / 12, of a triangle (a x b) . c / 6. The area at a point of the
/// quadrature is |S_s x S_t|, whose derivatives are S_t x n by S_s and n x S_s by S_t, with the unit normal n; zero where it
/// vanishes, as [`crate::measure`] has it.
pub fn pulled_measures(mesh: &Mesh<f64>, area: f64, volume: f64) -> Vec<Vec3> {
    let mut out = vec![Vec3::zero(); mesh.positions().len()];
    for (at, face) in mesh.faces().iter().enumerate() {
        let by = match mesh.panel(at) {
            Panel::Triangle([a, b, c]) => {
                let mut by = [b.cross(c), c.cross(a), a.cross(b)].map(|v| v * (volume / 6.0));
                let normal = (b - a).cross(c - a).normalized().unwrap_or_default() * (area / 2.0);
                by[0] += (b - c).cross(normal);
                by[1] += (c - a).cross(normal);
                by[2] += (a - b).cross(normal);
                [by[0], by[1], by[2], Vec3::zero()]
            }
            Panel::Quad(corners) => {
                let mut by = volume_of_quad(corners).map(|v| v * (volume / 12.0));
                if area != 0.0 {
                    add_area_of_quad(corners, area, &mut by);
                }
                by
            }
        };
        // The last corner of a triangle repeats another; its part is zero.
        face.iter().zip(by).for_each(|(&v, by)| out[v as usize] += by);
    }
    out
}

/// Twelve times the derivatives of the volume of the cone of a quad by its corners.
fn volume_of_quad([a, b, c, d]: [Vec3; 4]) -> [Vec3; 4] {
    let (ab, cd) = (a.cross(b), c.cross(d));
    let (first, last) = (a + b, c + d);
    [b.cross(last) + cd, last.cross(a) + cd, ab + d.cross(first), ab + first.cross(c)]
}

fn add_area_of_quad([a, b, c, d]: [Vec3; 4], area: f64, by: &mut [Vec3; 4]) {
    for s in GAUSS_2_UNIT {
        let along_t = d.lerp(c, s) - a.lerp(b, s);
        for t in GAUSS_2_UNIT {
            let along_s = (b - a).lerp(c - d, t);
            let Some(normal) = along_s.cross(along_t).normalized() else { continue };
            let by_s = along_t.cross(normal) * (0.25 * area);
            let by_t = normal.cross(along_s) * (0.25 * area);
            by[0] -= by_s * (1.0 - t) + by_t * (1.0 - s);
            by[1] += by_s * (1.0 - t) - by_t * s;
            by[2] += by_s * t + by_t * s;
            by[3] += by_t * (1.0 - s) - by_s * t;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure;
    use crate::report::fixtures::{open_half_box, sphere};
    use moldloft_num::Dual;

    /// Forward differentiation of the measures themselves.
    fn exact(mesh: &Mesh<f64>, [area, volume]: [f64; 2], vertex: usize, axis: usize) -> f64 {
        let mut positions: Vec<Vec3<Dual<1>>> =
            mesh.positions().iter().map(|&p| Vec3::lifted(p)).collect();
        let mut p = positions[vertex].to_array();
        p[axis] = Dual::seeded(p[axis].re, 0);
        positions[vertex] = p.into();
        let m = measure(&Mesh::new(mesh.topology().clone(), positions).unwrap());
        area * m.area.eps[0] + volume * m.volume.eps[0]
    }

    #[test]
    fn quads_and_triangles_have_the_derivatives_of_forward_mode() {
        let meshes = [open_half_box(), sphere(5, 2.0, Vec3::of(1.0, -2.0, 3.0))];
        assert!(meshes[1].faces().iter().any(|f| crate::is_triangle(*f)));
        for mesh in &meshes {
            for weights in [[1.0, 0.0], [0.0, 1.0], [0.7, -1.3]] {
                let found = pulled_measures(mesh, weights[0], weights[1]);
                for (vertex, by) in found.iter().enumerate() {
                    for axis in 0..3 {
                        let exact = exact(mesh, weights, vertex, axis);
                        let off = (by[axis] - exact).abs();
                        assert!(off < 1e-13 * (1.0 + exact.abs()), "{vertex} {axis}: {off}");
                    }
                }
            }
        }
    }
}
