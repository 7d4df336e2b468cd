//! Blocks as one mesh with named boundaries, and what CGNS is to know of them.

use moldloft_diag::Diagnostic;
use moldloft_grid::{FaceNames, GridFace, HexMesh, VolumeGrid, shared_nodes};
use moldloft_io::{StructuredGrid, WriteError};
use moldloft_mesh::{Blocks, HexBlock};

/// A block that is written, and the names of its faces.
pub(crate) struct NamedBlock {
    pub grid: StructuredGrid,
    pub name: String,
    pub faces: FaceNames,
}

/// What boundaries are.
const KINDS: [&str; 6] = ["wall", "symmetry", "farfield", "inflow", "outflow", "patch"];

/// A part of a face of a block: block, face in the order of [`GridFace::ALL`], first and last place (i, j, k) from 0.
pub type FacePart = (usize, usize, [usize; 3], [usize; 3]);

/// What a CGNS file holds besides points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CgnsBlocks {
    /// Names of the blocks.
    pub names: Vec<String>,
    /// Where blocks meet: both sides, and for each axis of the first that of the second, from 1, negative if against.
    pub joints: Vec<(FacePart, FacePart, [i32; 3])>,
    /// What is boundary: its place, name and type.
    pub boundaries: Vec<(FacePart, String, String)>,
}

/// The names of faces: "k1 = hull wall, i1 in = plane symmetry".
pub(crate) fn face_names(words: &str) -> Result<FaceNames, Diagnostic> {
    let mut faces = FaceNames::default();
    for entry in words.split([',', ';']).filter(|entry| !entry.trim().is_empty()) {
        let wrong = |message: String| {
            Diagnostic::error("unknown-word", message)
                .expected("faces = name type, such as \"k1 = hull wall, i1 in = plane symmetry\"")
                .found(format!("\"{}\"", entry.trim()))
        };
        let Some((of, meaning)) = entry.split_once('=') else {
            return Err(wrong("the name of a face stands behind `=`".into()));
        };
        let mut meaning = meaning.split_whitespace();
        let Some(name) = meaning.next() else {
            return Err(wrong("a face has no name".into()));
        };
        let sound = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
        if !name.chars().all(sound) {
            return Err(wrong(format!("\"{name}\" is not a boundary name")));
        }
        let kind = meaning.next().unwrap_or("patch");
        if !KINDS.contains(&kind) || meaning.next().is_some() {
            return Err(wrong(format!("there is no boundary \"{kind}\""))
                .expected(KINDS.join(", "))
                .suggest(kind, KINDS));
        }
        for word in of.split_whitespace() {
            let Some(face) = GridFace::ALL.iter().position(|face| face.word() == word) else {
                return Err(wrong(format!("there is no face \"{word}\""))
                    .expected("\"i1\", \"in\", \"j1\", \"jn\", \"k1\" or \"kn\""));
            };
            faces[face] = Some((name.to_string(), kind.to_string()));
        }
    }
    Ok(faces)
}

fn volumes(blocks: &[NamedBlock]) -> Vec<VolumeGrid<f64>> {
    blocks
        .iter()
        .map(|block| VolumeGrid::from_fn(block.grid.size, |i, j, k| block.grid.at([i, j, k])))
        .collect()
}

/// The blocks as one mesh; what coincides to 1e-10 of the size is joined.
pub(crate) fn one_mesh(blocks: &[NamedBlock]) -> HexMesh {
    let names: Vec<FaceNames> = blocks.iter().map(|block| block.faces.clone()).collect();
    HexMesh::of_blocks(&volumes(blocks), &names)
}

/// A file, or that its format has no such collapsed cells.
pub(crate) fn whole(
    made: Result<Vec<u8>, WriteError>,
    mesh: &HexMesh,
    format: &str,
) -> Result<Vec<u8>, Diagnostic> {
    made.map_err(|_| {
        Diagnostic::error("cannot-write", format!("{format} has no hexahedra collapsed like these"))
            .expected("hexahedra, wedges, pyramids and tetrahedra")
            .found(format!("{} cells at poles", mesh.collapsed()))
            .help("leave the pole out, or write Plot3D, CGNS or VTK")
    })
}

/// Joints and boundaries of the blocks, by the places where their points coincide.
pub(crate) fn joined(blocks: &[NamedBlock]) -> Result<CgnsBlocks, Diagnostic> {
    let (positions, numbers) = shared_nodes(&volumes(blocks));
    let hexahedra = blocks
        .iter()
        .zip(numbers)
        .map(|(block, numbers)| HexBlock {
            name: block.name.clone(),
            size: block.grid.size,
            vertices: numbers.into_iter().map(|n| n as u32).collect(),
            faces: Default::default(),
        })
        .collect();
    let all = Blocks::new(positions, hexahedra)
        .map_err(|error| Diagnostic::error("cannot-write", error.to_string()))?;
    let (joints, free) = all.interfaces();
    let joints = joints.iter().map(|joint| {
        let side = |k: usize| (joint.sides[k].0, joint.sides[k].1, joint.from[k], joint.to[k]);
        let transform = joint.axes.map(|(axis, against)| {
            let number = axis as i32 + 1;
            if against { -number } else { number }
        });
        (side(0), side(1), transform)
    });
    let boundaries = free.iter().map(|part| {
        let block = &blocks[part.block];
        let own = || {
            let word = GridFace::ALL[part.face].word();
            (format!("{}-{word}", block.name), "patch".to_string())
        };
        let (name, kind) = block.faces[part.face].clone().unwrap_or_else(own);
        ((part.block, part.face, part.from, part.to), name, kind)
    });
    Ok(CgnsBlocks {
        names: blocks.iter().map(|block| block.name.clone()).collect(),
        joints: joints.collect(),
        boundaries: boundaries.collect(),
    })
}
