//! The skin of a mesh: the patches that bound a body.

use crate::Mesh;
use crate::half_edge::{edges, half_edges};
use moldloft_num::Real;

impl<T: Real> Mesh<T> {
    /// The faces of the patches that bound the body: all patches except lids, water and symmetry
    /// planes.
    pub fn skin_faces(&self) -> Vec<usize> {
        let skin = self.patches().iter().filter(|p| p.info.tag.is_skin());
        skin.flat_map(|p| p.faces.clone()).collect()
    }

    /// The open edges of these patches: the patch, and a pair of vertices.
    pub fn open_skin_edges(&self) -> Vec<(usize, [u32; 2])> {
        let sides = half_edges(self.topology());
        let skin = |face: usize| self.patches()[self.topology().patch_of(face)].info.tag.is_skin();
        let open = edges(&sides).filter(|e| e.len() == 1 && skin(e[0].face()));
        open.map(|e| (self.topology().patch_of(e[0].face()), [e[0].from, e[0].to])).collect()
    }
}
