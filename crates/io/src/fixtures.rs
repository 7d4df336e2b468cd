//! Meshes that the tests of this crate share.

use moldloft_mesh::{Mesh, PatchInfo, Tag, TopologyBuilder};
use moldloft_num::Vec3;

/// Two structured patches that share an edge, one with a pole, and a lid triangle.
pub fn two_patches() -> Mesh {
    let mut b = TopologyBuilder::new();
    b.add_vertices(9).unwrap();
    b.add_block(PatchInfo::new("fore body"), 3, 2, vec![0, 1, 2, 3, 4, 5], false).unwrap();
    b.add_block(PatchInfo::new("aft"), 2, 3, vec![4, 7, 8, 5, 5, 5], false).unwrap();
    b.add_faces(PatchInfo::new("lid").tagged(Tag::Lid), [[0, 2, 6, 6]]).unwrap();
    let p = [
        [0.0, 0.0, 0.0],
        [0.1, 1.0, -0.5],
        [1.0, -0.0, 0.0],
        [1.0, 1.0 / 3.0, -0.75],
        [2.0, 0.0, 0.0],
        [2.5, 1.0, -1e-7],
        [0.5, 0.0, 0.25],
        [2.7, 0.2, 0.1],
        [2.9, 0.5, 0.3],
    ];
    Mesh::new(b.build().into(), p.map(Vec3::from).to_vec()).unwrap()
}
