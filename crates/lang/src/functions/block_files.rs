//! Blocks as unstructured meshes with named boundaries (SU2, Gmsh, blockMesh), and what CGNS is to know of them.

use moldloft_diag::Diagnostic;
use moldloft_grid::{FaceNames, GridFace, HexMesh, VolumeGrid, shared_nodes};
use moldloft_io::StructuredGrid;
use moldloft_mesh::{Blocks, HexBlock};
use moldloft_num::Vec3;
use std::fmt::Write;

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
pub(crate) fn hexahedra(blocks: &[NamedBlock]) -> HexMesh {
    let names: Vec<FaceNames> = blocks.iter().map(|block| block.faces.clone()).collect();
    HexMesh::of_blocks(&volumes(blocks), &names)
}

fn collapsed(mesh: &HexMesh, format: &str) -> Result<(), Diagnostic> {
    let is_collapsed = |cell: &&[usize; 8]| (1..8).any(|k| cell[..k].contains(&cell[k]));
    let count = mesh.cells.iter().filter(is_collapsed).count();
    if count == 0 {
        return Ok(());
    }
    Err(Diagnostic::error("cannot-write", format!("{format} has no collapsed hexahedra"))
        .expected("cells with eight different corners")
        .found(format!("{count} cells at poles"))
        .help("leave the pole out, or write Plot3D, CGNS or VTK"))
}

/// Numbers in their shortest exact spelling, apart by blanks.
fn spaced(p: Vec3) -> String {
    let [x, y, z] = p.to_array().map(|x| x + 0.0);
    format!("{x:?} {y:?} {z:?}")
}

fn nodes(of: &[usize], first: usize) -> String {
    let all: Vec<String> = of.iter().map(|n| (n + first).to_string()).collect();
    all.join(" ")
}

/// A mesh of SU2 (SU2 documentation, Mesh File): hexahedra, and a marker for each boundary.
pub(crate) fn su2(mesh: &HexMesh) -> Result<Vec<u8>, Diagnostic> {
    collapsed(mesh, "SU2")?;
    let mut out = format!("NDIME= 3\nNELEM= {}\n", mesh.cells.len());
    for (k, cell) in mesh.cells.iter().enumerate() {
        let _ = writeln!(out, "12 {} {k}", nodes(cell, 0));
    }
    let _ = writeln!(out, "NPOIN= {}", mesh.points.len());
    for (k, p) in mesh.points.iter().enumerate() {
        let _ = writeln!(out, "{} {k}", spaced(*p));
    }
    let _ = writeln!(out, "NMARK= {}", mesh.patches.len());
    for patch in &mesh.patches {
        let _ = writeln!(out, "MARKER_TAG= {}\nMARKER_ELEMS= {}", patch.name, patch.faces.len());
        for face in &patch.faces {
            let _ = writeln!(out, "9 {}", nodes(face, 0));
        }
    }
    Ok(out.into_bytes())
}

/// A mesh of Gmsh, format 4.1, text: a physical surface for each boundary, and the volume "fluid".
pub(crate) fn gmsh(mesh: &HexMesh) -> Result<Vec<u8>, Diagnostic> {
    collapsed(mesh, "Gmsh")?;
    let patches = mesh.patches.len();
    let mut out = String::from("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n");
    let _ = writeln!(out, "{}", patches + 1);
    for (k, patch) in mesh.patches.iter().enumerate() {
        let _ = writeln!(out, "2 {} \"{}\"", k + 1, patch.name);
    }
    let _ = writeln!(out, "3 {} \"fluid\"\n$EndPhysicalNames\n$Entities", patches + 1);
    let _ = writeln!(out, "0 0 {patches} 1");
    let corners = |of: &mut dyn Iterator<Item = usize>| {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for n in of {
            for (axis, x) in mesh.points[n].to_array().into_iter().enumerate() {
                low[axis] = low[axis].min(x);
                high[axis] = high[axis].max(x);
            }
        }
        format!("{} {}", spaced(low.into()), spaced(high.into()))
    };
    for (k, patch) in mesh.patches.iter().enumerate() {
        let of = corners(&mut patch.faces.iter().flatten().copied());
        let _ = writeln!(out, "{0} {of} 1 {0} 0", k + 1);
    }
    let all: Vec<usize> = (1..=patches).collect();
    let of = corners(&mut (0..mesh.points.len()));
    let _ = writeln!(out, "1 {of} 1 {} {patches} {}", patches + 1, nodes(&all, 0));
    let count = mesh.points.len();
    let _ = writeln!(out, "$EndEntities\n$Nodes\n1 {count} 1 {count}\n3 1 0 {count}");
    (1..=count).for_each(|n| {
        let _ = writeln!(out, "{n}");
    });
    for p in &mesh.points {
        let _ = writeln!(out, "{}", spaced(*p));
    }
    let faces: usize = mesh.patches.iter().map(|patch| patch.faces.len()).sum();
    let total = faces + mesh.cells.len();
    let _ = writeln!(out, "$EndNodes\n$Elements\n{} {total} 1 {total}", patches + 1);
    let mut number = 0;
    for (k, patch) in mesh.patches.iter().enumerate() {
        let _ = writeln!(out, "2 {} 3 {}", k + 1, patch.faces.len());
        for face in &patch.faces {
            number += 1;
            let _ = writeln!(out, "{number} {}", nodes(face, 1));
        }
    }
    let _ = writeln!(out, "3 1 5 {}", mesh.cells.len());
    for cell in &mesh.cells {
        number += 1;
        let _ = writeln!(out, "{number} {}", nodes(cell, 1));
    }
    out.push_str("$EndElements\n");
    Ok(out.into_bytes())
}

/// A blockMeshDict of OpenFOAM: a block for each cell, so that its points are those of the grid.
pub(crate) fn block_mesh(mesh: &HexMesh) -> Vec<u8> {
    let mut out = String::from(
        "FoamFile\n{\n    version 2.0;\n    format ascii;\n    class dictionary;\n    object blockMeshDict;\n}\n\
         convertToMeters 1;\nvertices\n(\n",
    );
    for p in &mesh.points {
        let _ = writeln!(out, "({})", spaced(*p));
    }
    out.push_str(");\nblocks\n(\n");
    for cell in &mesh.cells {
        let _ = writeln!(out, "hex ({}) (1 1 1) simpleGrading (1 1 1)", nodes(cell, 0));
    }
    out.push_str(");\nedges ();\nboundary\n(\n");
    for patch in &mesh.patches {
        // The faces that have no name are found by blockMesh itself.
        if patch.name == "defaultFaces" {
            continue;
        }
        let kind = match &*patch.kind {
            "wall" => "wall",
            "symmetry" => "symmetryPlane",
            _ => "patch",
        };
        let _ = writeln!(out, "{}\n{{\n    type {kind};\n    faces\n    (", patch.name);
        for face in &patch.faces {
            let _ = writeln!(out, "    ({})", nodes(face, 0));
        }
        out.push_str("    );\n}\n");
    }
    out.push_str(");\nmergePatchPairs ();\n");
    out.into_bytes()
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
