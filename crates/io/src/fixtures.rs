//! Meshes that the tests of this crate share.

use moldloft_mesh::{BlockFace, Blocks, HexBlock, Mesh, PatchInfo, Tag, TopologyBuilder};
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

/// Two blocks with a common face: a unit cube, and two more beyond it along u.
pub fn two_bricks() -> Blocks {
    let at = |i: usize, j: usize, k: usize| Vec3::of(i as f64, j as f64, k as f64);
    let all = (0..16).map(|c| at(c / 4, c / 2 % 2, c % 2)).collect();
    let block = |name: &str, nu: usize, first: u32| HexBlock {
        name: name.into(),
        size: [nu, 2, 2],
        vertices: (first..first + 4 * nu as u32).collect(),
        faces: std::array::from_fn(|f| BlockFace { name: format!("{name}.{f}") }),
    };
    Blocks::new(all, vec![block("fore", 2, 0), block("aft", 3, 4)]).unwrap()
}

/// Copies of a file with bytes changed, cut off and doubled, the same ones every time.
pub fn damaged(file: &[u8]) -> impl Iterator<Item = Vec<u8>> + '_ {
    // Knuth's linear congruential generator (MMIX).
    let mut state = 1u64;
    let mut draw = move |below: usize| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % below.max(1)
    };
    (0..4000).map(move |_| {
        let mut bytes = file.to_vec();
        for _ in 0..1 + draw(6) {
            let at = draw(bytes.len());
            match draw(4) {
                0 => bytes.truncate(at),
                1 if !bytes.is_empty() => bytes[at] = draw(256) as u8,
                2 if !bytes.is_empty() => bytes[at] = b"-0 9e\n/.#"[draw(9)],
                _ => bytes.extend_from_within(at..(at + draw(40)).min(bytes.len())),
            }
        }
        bytes
    })
}

#[test]
fn damaged_files_are_refused_or_read_but_never_panic() {
    let mesh = two_patches();
    let gdf = crate::gdf::write(&mesh, &Default::default(), true).unwrap();
    let stl = crate::stl::write(&mesh, "hull").unwrap();
    let obj = crate::obj::write(&mesh).unwrap();
    let text =
        b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
        endloop\nendfacet\nendsolid a\n";
    let mut refused = 0;
    for bytes in damaged(&gdf) {
        refused += usize::from(crate::gdf::read(&bytes).is_err());
    }
    for bytes in damaged(&stl).chain(damaged(text)) {
        refused += usize::from(crate::stl::read(&bytes).is_err());
    }
    for bytes in damaged(&obj) {
        refused += usize::from(crate::obj::read(&bytes).is_err());
    }
    assert!(refused > 4000, "{refused}");
}
