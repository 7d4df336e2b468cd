//! Panels cut at the water.

use crate::{Mesh, MeshError, Tag, TopologyBuilder};
use moldloft_num::{Real, Vec3};
use std::collections::HashMap;

impl<T: Real> Mesh<T> {
    /// The part of the mesh below `z = level`, open along the cut, where cut panels share new
    /// vertices by identity. Panels in the level are omitted except those of lids. Patches keep
    /// their names; cut ones lose their grids, and those wholly above the level are empty.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`].
    pub fn immersed(&self, level: T) -> Result<Self, MeshError> {
        let c = level.re();
        let z = |v: u32| self.positions()[v as usize].z.re();
        let mut positions = self.positions().to_vec();
        // Looked up only, never walked, so its order does not show.
        let mut cuts: HashMap<[u32; 2], u32> = HashMap::new();
        let mut patches = Vec::new();
        for patch in self.patches() {
            let mut faces = Vec::new();
            let mut whole = true;
            let is_lid = patch.info.tag == Tag::Lid;
            for &face in &self.faces()[patch.faces.clone()] {
                let corners = if crate::is_triangle(face) { 3 } else { 4 };
                if face[..corners].iter().all(|&v| z(v) <= c) {
                    if is_lid || face[..corners].iter().any(|&v| z(v) < c) {
                        faces.push(face);
                    } else {
                        whole = false;
                    }
                    continue;
                }
                whole = false;
                if face[..corners].iter().all(|&v| z(v) >= c) {
                    continue;
                }
                let mut ring = Vec::with_capacity(6);
                for k in 0..corners {
                    let (p, q) = (face[k], face[(k + 1) % corners]);
                    if z(p) <= c {
                        ring.push(p);
                    }
                    if (z(p) < c && z(q) > c) || (z(p) > c && z(q) < c) {
                        let (low, high) = if z(p) < c { (p, q) } else { (q, p) };
                        ring.push(*cuts.entry([low, high]).or_insert_with(|| {
                            let [a, b] = [low, high].map(|v| positions[v as usize]);
                            positions.push(crossing(a, b, level));
                            (positions.len() - 1) as u32
                        }));
                    }
                }
                match *ring.as_slice() {
                    [a, b, c] => faces.push([a, b, c, c]),
                    [a, b, c, d] => faces.push([a, b, c, d]),
                    [a, b, c, d, e] => faces.extend([[a, b, c, d], [a, d, e, e]]),
                    [a, b, c, d, e, f] => faces.extend([[a, b, c, d], [a, d, e, f]]),
                    _ => {}
                }
            }
            patches.push((patch.info.clone(), faces, patch.block.clone().filter(|_| whole)));
        }
        let mut builder = TopologyBuilder::new();
        builder.add_vertices(positions.len())?;
        for (info, faces, block) in patches {
            builder.add_faces_of(info, faces.into_iter(), block)?;
        }
        Mesh::new(builder.build().into(), positions)
    }
}

/// Intersection of the line from `low` to `high` with the level.
fn crossing<T: Real>(low: Vec3<T>, high: Vec3<T>, level: T) -> Vec3<T> {
    let t = (level - low.z) / (high.z - low.z);
    Vec3 { z: level, ..low + (high - low) * t }
}

#[cfg(test)]
mod tests {
    use moldloft_num::Vec3;

    #[test]
    fn the_immersed_mesh_is_open_at_the_water_alone() {
        let ball = crate::report::fixtures::sphere(20, 1.0, Vec3::zero());
        let immersed = ball.immersed(0.13).unwrap();
        let report = immersed.report();
        assert_eq!((report.open_loops.len(), report.components, report.euler), (1, 1, 1));
        assert!(report.oriented && report.manifold && report.open_loops[0].bounds.low.z == 0.13);
        assert!(ball.immersed(-2.0).unwrap().faces().is_empty());
        assert_eq!(ball.immersed(2.0).unwrap(), ball);
    }
}
