//! A mesh: a topology with the positions of its vertices, of any scalar.

use crate::{Block, MeshError, Panel, Patch, PatchInfo, Topology, TopologyBuilder};
use moldloft_num::{Box3, Real, Vec3};
use std::sync::Arc;

/// A topology with the positions of its vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh<T = f64> {
    topology: Arc<Topology>,
    positions: Vec<Vec3<T>>,
}

impl<T: Real> Mesh<T> {
    /// A topology with one position per vertex.
    ///
    /// # Errors
    /// [`MeshError::PositionCount`] when the numbers differ.
    pub fn new(topology: Arc<Topology>, positions: Vec<Vec3<T>>) -> Result<Self, MeshError> {
        let (expected, actual) = (topology.vertex_count(), positions.len());
        if expected != actual {
            return Err(MeshError::PositionCount { expected, actual });
        }
        Ok(Self { topology, positions })
    }

    /// The connectivity, shared with other meshes of the same panels.
    pub fn topology(&self) -> &Arc<Topology> {
        &self.topology
    }

    /// Positions of the vertices.
    pub fn positions(&self) -> &[Vec3<T>] {
        &self.positions
    }

    /// Corners of each face; a triangle repeats its last index.
    pub fn faces(&self) -> &[[u32; 4]] {
        self.topology.faces()
    }

    /// The patches.
    pub fn patches(&self) -> &[Patch] {
        self.topology.patches()
    }

    /// The corners of a face in space.
    pub fn panel(&self, face: usize) -> Panel<T> {
        Panel::of(self.faces()[face], &self.positions)
    }

    /// The mesh of real parts.
    pub fn re(&self) -> Mesh<f64> {
        Mesh {
            topology: self.topology.clone(),
            positions: self.positions.iter().map(|p| p.re()).collect(),
        }
    }

    /// The smallest box around the vertices that faces use.
    pub fn bounds(&self) -> Box3 {
        let corners = self.faces().iter().flatten();
        Box3::around(corners.map(|&v| self.positions[v as usize].re()))
    }

    /// The mesh with every quad split along its shorter diagonal.
    pub fn triangulated(&self) -> Self {
        let real: Vec<Vec3> = self.positions.iter().map(|p| p.re()).collect();
        Self {
            topology: Arc::new(self.topology.triangulated(&real)),
            positions: self.positions.clone(),
        }
    }

    /// The mesh together with its mirror image in the plane through zero of `axis` (0 for x = 0, 1
    /// for y = 0, 2 for z = 0). Vertices exactly on the plane are shared, so that a half bounded by
    /// it gives a closed mesh. The patches of the image have names with `suffix` and reversed
    /// panels, so that they face outward too. Patches in the symmetry plane are not repeated.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`].
    pub fn with_mirror_image(&self, axis: usize, suffix: &str) -> Result<Self, MeshError> {
        let mut positions = self.positions.clone();
        let image: Vec<u32> = self
            .positions
            .iter()
            .enumerate()
            .map(|(k, p)| {
                if p[axis].re() == 0.0 {
                    return k as u32;
                }
                let mut q = p.to_array();
                q[axis] = -q[axis];
                positions.push(q.into());
                (positions.len() - 1) as u32
            })
            .collect();
        let mut builder = TopologyBuilder::new();
        builder.add_vertices(positions.len())?;
        let patches = self.patches();
        let whole = patches.iter().map(|p| (p, None));
        let mirrored = patches
            .iter()
            .filter(|p| p.info.tag != crate::Tag::Symmetry)
            .map(|p| (p, Some(&image)));
        for (patch, image) in whole.chain(mirrored) {
            let vertex = |v: u32| image.map_or(v, |image| image[v as usize]);
            let name = if image.is_some() {
                patch.info.name.clone() + suffix
            } else {
                patch.info.name.clone()
            };
            let info = PatchInfo { name, ..patch.info.clone() };
            let faces = self.faces()[patch.faces.clone()].iter().map(|&f| {
                let [a, b, c, d] = f.map(vertex);
                match (image.is_some(), c == d) {
                    (false, _) => [a, b, c, d],
                    (true, true) => [a, c, b, b],
                    (true, false) => [a, d, c, b],
                }
            });
            let block = patch.block.as_ref().map(|b| Block {
                vertices: b.vertices.iter().map(|&v| vertex(v)).collect(),
                reversed: b.reversed != image.is_some(),
                ..*b
            });
            builder.add_faces_of(info, faces, block)?;
        }
        Mesh::new(builder.build().into(), positions)
    }
}

impl Mesh<f64> {
    /// The mesh with vertices of bit-equal positions merged (-0 counts as 0): for formats that
    /// repeat the corners of every panel. Deterministic, O(n log n). Blocks keep their shape.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`].
    pub fn welded(&self) -> Result<Self, MeshError> {
        let key = |k: &u32| self.positions[*k as usize].to_array().map(|x| (x + 0.0).to_bits());
        let mut order: Vec<u32> = (0..self.positions.len() as u32).collect();
        order.sort_by_key(|k| (key(k), *k));
        let mut first: Vec<u32> = (0..self.positions.len() as u32).collect();
        for pair in 1..order.len() {
            let (before, here) = (order[pair - 1], order[pair]);
            if key(&before) == key(&here) {
                first[here as usize] = first[before as usize];
            }
        }
        // Number the survivors in the order of their first appearance.
        let mut number = vec![u32::MAX; first.len()];
        let mut positions = Vec::new();
        for k in 0..first.len() {
            if first[k] == k as u32 {
                number[k] = positions.len() as u32;
                positions.push(self.positions[k]);
            }
        }
        let vertex = |v: u32| number[first[v as usize] as usize];
        let mut builder = TopologyBuilder::new();
        builder.add_vertices(positions.len())?;
        for patch in self.patches() {
            let faces = self.faces()[patch.faces.clone()].iter().map(|f| f.map(vertex));
            let block = patch
                .block
                .as_ref()
                .map(|b| Block { vertices: b.vertices.iter().map(|&v| vertex(v)).collect(), ..*b });
            builder.add_faces_of(patch.info.clone(), faces, block)?;
        }
        Mesh::new(builder.build().into(), positions)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure;

    #[test]
    fn positions_must_fit() {
        let mut b = TopologyBuilder::new();
        b.add_vertices(2).unwrap();
        let wrong = Mesh::<f64>::new(b.build().into(), vec![Vec3::zero()]);
        assert_eq!(wrong, Err(MeshError::PositionCount { expected: 2, actual: 1 }));
    }

    #[test]
    fn a_half_box_and_its_image_close() {
        let half = crate::report::fixtures::open_half_box();
        assert!(!half.report().closed);
        let whole = half.with_mirror_image(1, ".mirror").unwrap();
        let report = whole.report();
        assert!(report.closed && report.oriented && report.outward == Some(true));
        assert!((measure(&whole).volume - 2.0 * 2.0 * 3.0).abs() < 1e-14);
        assert_eq!(whole.patches()[5].info.name, "bottom.mirror");
    }

    #[test]
    fn welding_joins_loose_panels() {
        let whole = crate::report::fixtures::open_half_box().with_mirror_image(1, "'").unwrap();
        let loose: Vec<Vec3> =
            whole.faces().iter().flatten().map(|&v| whole.positions()[v as usize]).collect();
        let mut b = TopologyBuilder::new();
        b.add_vertices(loose.len()).unwrap();
        let faces = (0..loose.len() as u32 / 4).map(|k| [4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3]);
        b.add_faces(PatchInfo::new("loose"), faces).unwrap();
        let loose = Mesh::new(b.build().into(), loose).unwrap();
        assert_eq!(loose.report().components, 10);
        let welded = loose.welded().unwrap();
        assert!(welded.report().closed && welded.positions().len() == 12);
    }
}
