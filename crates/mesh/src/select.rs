//! Meshes of some of the patches of another.

use crate::{Block, Mesh, MeshError, PatchInfo, TopologyBuilder};
use moldloft_num::Real;

impl<T: Real> Mesh<T> {
    /// The patches selected by `keep`, with the vertices that they use; shared vertices remain
    /// shared. Patches and vertices keep their order.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`], never for a part of a mesh that could be made.
    pub fn selected(&self, keep: impl Fn(&PatchInfo) -> bool) -> Result<Self, MeshError> {
        let kept: Vec<_> = self.patches().iter().filter(|p| keep(&p.info)).collect();
        const UNUSED: u32 = u32::MAX;
        let mut number = vec![UNUSED; self.positions().len()];
        for patch in &kept {
            for &v in self.faces()[patch.faces.clone()].iter().flatten() {
                number[v as usize] = 0;
            }
            for &v in patch.block.iter().flat_map(|b| &b.vertices) {
                number[v as usize] = 0;
            }
        }
        let mut positions = Vec::new();
        for (slot, &p) in number.iter_mut().zip(self.positions()).filter(|(n, _)| **n != UNUSED) {
            *slot = positions.len() as u32;
            positions.push(p);
        }
        let vertex = |v: u32| number[v as usize];
        let mut builder = TopologyBuilder::new();
        builder.add_vertices(positions.len())?;
        for patch in kept {
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
    use crate::report::fixtures::{open_half_box, sphere};
    use moldloft_num::Vec3;

    #[test]
    fn a_part_keeps_what_it_shares() {
        let whole = open_half_box();
        let part = whole.selected(|p| p.name != "top").unwrap();
        assert_eq!((part.faces().len(), part.positions().len()), (4, 8));
        assert_eq!(part.report().components, 1);
        assert_eq!(whole.selected(|p| p.name == "side").unwrap().positions().len(), 4);
        assert!(whole.selected(|_| false).unwrap().positions().is_empty());
        let ball = sphere(4, 1.0, Vec3::<f64>::zero());
        assert_eq!(ball.selected(|_| true).unwrap(), ball);
    }
}
