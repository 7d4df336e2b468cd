//! The formats of grid files that programs write: one row each.

use crate::functions::block_files::{
    Connected, connected, extruded, merged, one_mesh, volumes, whole,
};
use crate::functions::named_blocks::NamedBlock;
use crate::functions::plots::plot;
use crate::functions::solver_conditions::{conditions, map_entries};
use crate::run::usage;
use moldloft_budget::Budget;
use moldloft_diag::Diagnostic;
use moldloft_grid::{HexMesh, VolumeGrid};
use moldloft_io::graded_blocks::{GradedPatch, graded_block_mesh};
use moldloft_io::hexahedra::PeriodicPartner;
use moldloft_io::neutral_map::neutral_map;
use moldloft_io::plot3d::{self, Laid, Variant};
use moldloft_io::quadrilaterals::{self, PlaneMesh};
use moldloft_io::ugrid::{UgridLayout, mapbc, ugrid};
use moldloft_io::{StructuredGrid, WriteError, cgns, hexahedra, openfoam, points, stl, vtk};
use moldloft_num::Vec3;

/// Content to write, with the words that select variants of the format.
pub(crate) struct GridFile<'a> {
    /// Its name, as the program states it.
    pub path: &'a str,
    pub words: &'a str,
    pub blocks: Vec<NamedBlock>,
    /// Connections of the blocks, for formats that join them.
    pub connected: Option<Connected>,
    pub budget: &'a Budget,
}

/// Files of a call: their names and contents.
pub(crate) type EncodedFiles = Vec<(String, Vec<u8>)>;

#[derive(Debug)]
pub(crate) struct GridFormat {
    /// True if blocks are written besides curves and surfaces.
    pub blocks: bool,
    /// True if blocks are joined at coincident points, and their boundaries have names.
    pub joins: bool,
    /// True if an farray of whole numbers after a surface is its blanking.
    pub blanking: bool,
    /// True if surfaces in one plane are a mesh, with their edges as boundaries.
    pub plane: bool,
    /// True if faces of unequal cells may meet.
    pub hangs: bool,
    /// True if cells keep the order of the points, right-handed or not.
    pub keeps_order: bool,
    /// True if it checks the budget itself; others are watched from outside.
    pub watches: bool,
    pub encode: fn(GridFile<'_>) -> Result<EncodedFiles, Diagnostic>,
}

/// Points alone, or pictures of them.
pub(crate) const PLAIN: GridFormat = GridFormat {
    blocks: false,
    joins: false,
    plane: false,
    blanking: false,
    hangs: false,
    keeps_order: false,
    watches: false,
    encode: csv,
};

/// One mesh of all blocks.
const JOINED_MESH: GridFormat = GridFormat { blocks: true, joins: true, plane: true, ..PLAIN };

/// `write_p3d`.
pub(crate) static PLOT3D: GridFormat =
    GridFormat { blocks: true, blanking: true, keeps_order: true, encode: plot3d_file, ..PLAIN };

/// `write_vts`.
pub(crate) static VTS: GridFormat =
    GridFormat { blocks: true, keeps_order: true, encode: vts, ..PLAIN };

/// `write_stl`.
pub(crate) static STL: GridFormat = GridFormat { watches: true, encode: stl_file, ..PLAIN };

/// `write_csv`.
pub(crate) static CSV: GridFormat = PLAIN;

/// `write_cgns`.
pub(crate) static CGNS: GridFormat = GridFormat {
    blocks: true,
    joins: true,
    hangs: true,
    keeps_order: true,
    encode: cgns_file,
    ..PLAIN
};

/// `write_su2`.
pub(crate) static SU2: GridFormat = GridFormat { encode: su2, ..JOINED_MESH };

/// `write_gmsh`.
pub(crate) static GMSH: GridFormat = GridFormat { encode: gmsh, ..JOINED_MESH };

/// `write_blockmesh`.
pub(crate) static BLOCK_MESH: GridFormat = GridFormat { encode: block_mesh, ..JOINED_MESH };

/// `write_polymesh`.
pub(crate) static POLY_MESH: GridFormat = GridFormat { encode: poly_mesh, ..JOINED_MESH };

/// `write_ugrid`.
pub(crate) static UGRID: GridFormat =
    GridFormat { plane: false, encode: ugrid_file, ..JOINED_MESH };

/// `write_nmf`.
pub(crate) static NEUTRAL_MAP: GridFormat =
    GridFormat { plane: false, keeps_order: true, encode: neutral_map_file, ..JOINED_MESH };

/// `interfaces`, which writes nothing.
pub(crate) static CONNECTIONS: GridFormat =
    GridFormat { hangs: true, keeps_order: true, ..JOINED_MESH };

/// `plot`.
pub(crate) static PICTURE: GridFormat =
    GridFormat { blocks: true, watches: true, encode: picture, ..PLAIN };

/// The words that choose a variant of Plot3D, the usual ones first.
const VARIANTS: &str = "stream, records, text; double, single; multi, single-block; 3d, 2d; whole, planes; little, \
                        big; iblank; mark8";

/// The variant that words choose.
fn variant(words: &str) -> Result<Variant, Diagnostic> {
    let mut v = Variant::default();
    for word in words.split(|c: char| c.is_whitespace() || c == ',').filter(|w| !w.is_empty()) {
        match word.to_ascii_lowercase().as_str() {
            "stream" | "binary" => v.laid = Laid::Stream,
            "records" | "fortran" | "unformatted" => v.laid = Laid::Unformatted,
            "text" | "ascii" | "formatted" => v.laid = Laid::Formatted,
            "double" => v.double = true,
            "single" => v.double = false,
            "multi" | "multi-block" => v.multi = true,
            "single-block" => v.multi = false,
            "3d" => v.three = true,
            "2d" => v.three = false,
            "whole" => v.planes = false,
            "planes" => v.planes = true,
            "little" => v.big_endian = false,
            "big" => v.big_endian = true,
            "iblank" => v.iblank = true,
            "mark4" => v.mark = 4,
            "mark8" => v.mark = 8,
            _ => {
                return Err(Diagnostic::error(
                    "unknown-word",
                    format!("Plot3D has no variant \"{word}\""),
                )
                .expected(VARIANTS)
                .found(format!("\"{word}\"")));
            }
        }
    }
    Ok(v)
}

fn cannot(error: impl std::fmt::Display) -> Diagnostic {
    let text = error.to_string();
    Diagnostic::error("cannot-write", text.trim_start_matches("error: ").to_string())
}

/// The stem of a file's name: "body" of "out/body.vts".
fn stem(name: &str) -> &str {
    let last = name.rsplit('/').next().unwrap_or(name);
    last.rsplit_once('.').map_or(last, |(stem, _)| stem)
}

fn one(path: &str, bytes: Vec<u8>) -> EncodedFiles {
    vec![(path.to_string(), bytes)]
}

/// True when the only word that there may be is given.
fn option(file: &GridFile<'_>, known: &str) -> Result<bool, Diagnostic> {
    match file.words.trim() {
        "" => Ok(false),
        word if word == known => Ok(true),
        word => {
            let expected = if known.is_empty() { "no words" } else { known };
            let message = format!("`{}` has no option \"{word}\"", file.path);
            Err(Diagnostic::error("unknown-word", message).expected(expected.to_string()))
        }
    }
}

fn grids(blocks: Vec<NamedBlock>) -> (Vec<StructuredGrid>, Vec<String>) {
    blocks.into_iter().map(|block| (block.grid, block.name)).unzip()
}

fn plot3d_file(file: GridFile<'_>) -> Result<EncodedFiles, Diagnostic> {
    let mut v = variant(file.words)?;
    let (mut blocks, _) = grids(file.blocks);
    v.iblank |= blocks.iter().any(|b| b.iblank.is_some());
    if v.iblank {
        for block in &mut blocks {
            let all = || vec![1; block.planes[0].len()];
            block.iblank = Some(block.iblank.take().unwrap_or_else(all));
        }
    }
    Ok(one(file.path, plot3d::write(&blocks, v).map_err(cannot)?))
}

fn vts(file: GridFile<'_>) -> Result<EncodedFiles, Diagnostic> {
    option(&file, "")?;
    let folder = file.path.rfind('/').map_or("", |k| &file.path[..=k]);
    let (blocks, names) = grids(file.blocks);
    let written = vtk::grid_files(&blocks, &names, stem(file.path)).map_err(cannot)?;
    let named = |part: vtk::NamedFile| (format!("{folder}{}", part.name), part.bytes);
    Ok(written.into_iter().map(named).collect())
}

fn picture(file: GridFile<'_>) -> Result<EncodedFiles, Diagnostic> {
    let (blocks, names) = grids(file.blocks);
    Ok(one(file.path, plot(file.path, file.words, &blocks, &names, file.budget)?))
}

fn stl_file(file: GridFile<'_>) -> Result<EncodedFiles, Diagnostic> {
    let flip = option(&file, "flip")?;
    let (blocks, _) = grids(file.blocks);
    let go_on = || !file.budget.is_spent();
    let bytes = stl::write_grids(&blocks, stem(file.path), flip, &go_on);
    let bytes = bytes.map_err(|e| match file.budget.poll() {
        Err(reason) if e == WriteError::Ended => usage::spent(reason),
        _ => cannot(e),
    })?;
    Ok(one(file.path, bytes))
}

fn csv(file: GridFile<'_>) -> Result<EncodedFiles, Diagnostic> {
    option(&file, "")?;
    let (blocks, _) = grids(file.blocks);
    let rows: Vec<Vec3> = blocks.iter().flat_map(StructuredGrid::points).collect();
    Ok(one(file.path, points::write_csv(&rows, 3).into_bytes()))
}

/// True of surfaces, false of blocks; a file has one or the other.
fn are_flat(blocks: &[NamedBlock]) -> Result<bool, Diagnostic> {
    let flat = blocks.iter().filter(|b| b.grid.size[2] == 1).count();
    if flat != 0 && flat != blocks.len() {
        return Err(Diagnostic::error("cannot-write", "surfaces among blocks")
            .expected("surfaces, or blocks, in one file"));
    }
    let least = if flat == 0 { 3 } else { 2 };
    let no_cells = |b: &&NamedBlock| b.grid.size[..least].iter().any(|n| *n < 2);
    if let Some(block) = blocks.iter().find(no_cells) {
        let message = format!("`{}` has no cells", block.name);
        return Err(Diagnostic::error("cannot-write", message)
            .expected("at least two points along each index"));
    }
    Ok(flat > 0)
}

fn cgns_file(file: GridFile<'_>) -> Result<EncodedFiles, Diagnostic> {
    option(&file, "")?;
    let flat = are_flat(&file.blocks)?;
    let refused = ["empty", "wedge"];
    let faces = file.blocks.iter().flat_map(|block| block.faces.iter().flatten());
    for (name, kind) in faces {
        if flat || refused.contains(&kind.as_str()) {
            let what = if flat { "of surfaces".to_string() } else { format!("\"{kind}\"") };
            let message = format!("CGNS has no boundary `{name}` {what}");
            return Err(Diagnostic::error("cannot-write", message).expected(
                "boundaries of blocks: wall, symmetry, farfield, inflow, outflow, periodic, patch",
            ));
        }
    }
    let (title, (grids, names)) = (stem(file.path), grids(file.blocks));
    let bytes = match file.connected {
        Some(Connected { joints, boundaries, .. }) => {
            cgns::write_volume(&grids, &names, joints, &boundaries, title)
        }
        None => cgns::write_surfaces(&grids, &names, title, cgns::USUAL_TOLERANCE),
    };
    Ok(one(file.path, bytes.map_err(cannot)?))
}

/// The name of the two sides that a plane grid has as a layer of cells.
const FRONT_AND_BACK: &str = "frontAndBack";

fn plane_mesh(blocks: &[NamedBlock]) -> Result<PlaneMesh, Diagnostic> {
    let (layers, plane) = extruded(blocks, FRONT_AND_BACK)?;
    Ok(PlaneMesh::under(&one_mesh(&layers), plane.axes, plane.normal, FRONT_AND_BACK))
}

fn su2(file: GridFile<'_>) -> Result<EncodedFiles, Diagnostic> {
    option(&file, "")?;
    if are_flat(&file.blocks)? {
        return Ok(one(file.path, quadrilaterals::su2(&plane_mesh(&file.blocks)?)));
    }
    let mesh = one_mesh(&file.blocks);
    Ok(one(file.path, whole(hexahedra::su2(&mesh), &mesh, "SU2")?))
}

fn gmsh(file: GridFile<'_>) -> Result<EncodedFiles, Diagnostic> {
    option(&file, "")?;
    if are_flat(&file.blocks)? {
        return Ok(one(file.path, quadrilaterals::gmsh(&plane_mesh(&file.blocks)?)));
    }
    let mesh = one_mesh(&file.blocks);
    Ok(one(file.path, whole(hexahedra::gmsh(&mesh), &mesh, "Gmsh")?))
}

/// The cosine of the angle between a wedge and the coordinate plane of its axis, above which they are one plane.
const NO_WEDGE: f64 = 1.0 - 1e-9;

/// Refuses wedges that OpenFOAM refuses: sides that are not plane, or not two that are mirror images about a coordinate
/// plane.
fn check_wedges(mesh: &HexMesh) -> Result<(), Diagnostic> {
    let wrong = |message: String, expected: &str| {
        Diagnostic::error("cannot-write", message)
            .expected(expected.to_string())
            .help("give the sides two names: \"k1 = front wedge, kn = back wedge\"")
    };
    let wedges = mesh.patches.iter().filter(|patch| patch.kind == "wedge");
    let mut normals: Vec<(&str, [f64; 3])> = Vec::new();
    for patch in wedges {
        if !hexahedra::is_plane(&mesh.points, &patch.faces) {
            return Err(wrong(
                format!("the wedge `{}` is not plane", patch.name),
                "a plane for each of the two sides of a wedge",
            ));
        }
        let area = patch.faces.iter().fold(Vec3::zero(), |sum, face| {
            let [a, b, c, d] = face.map(|n| mesh.points[n]);
            sum + (c - a).cross(d - b)
        });
        normals.push((&patch.name, (area / area.norm()).to_array()));
    }
    for (name, normal) in &normals {
        let mirrored = |axis: usize| {
            (0.5..NO_WEDGE).contains(&normal[axis].abs())
                && normals.iter().any(|(_, other)| {
                    (0..3).all(|k| {
                        let sign = if k == axis { -1.0 } else { 1.0 };
                        (other[k] - sign * normal[k]).abs() <= hexahedra::PLANE
                    })
                })
        };
        if !(0..3).any(mirrored) {
            let message = format!(
                "the wedge `{name}`, normal ({:.6}, {:.6}, {:.6}), has no mirror image about a coordinate plane",
                normal[0], normal[1], normal[2]
            );
            let expected = "two sides at equal small angles to a plane of constant x, y or z";
            return Err(wrong(message, expected));
        }
    }
    Ok(())
}

/// The mesh for OpenFOAM, which has a plane mesh as one layer of cells between two empty sides, and its periodic
/// boundaries.
fn foam_mesh(
    file: GridFile<'_>,
) -> Result<(Vec<NamedBlock>, HexMesh, Vec<PeriodicPartner>), Diagnostic> {
    let blocks = match are_flat(&file.blocks)? {
        true => extruded(&file.blocks, FRONT_AND_BACK)?.0,
        false => file.blocks,
    };
    let mesh = one_mesh(&blocks);
    check_wedges(&mesh)?;
    let partners = file.connected.map(|connected| connected.partners).unwrap_or_default();
    Ok((blocks, mesh, partners))
}

fn block_mesh(file: GridFile<'_>) -> Result<EncodedFiles, Diagnostic> {
    let graded = option(&file, GRADED)?;
    let path = file.path;
    let (blocks, mesh, partners) = foam_mesh(file)?;
    let bytes = match graded {
        true => graded_mesh(blocks, &mesh, &partners)?,
        false => openfoam::block_mesh(&mesh, &partners).map_err(cannot)?,
    };
    Ok(one(path, bytes))
}

/// The word for a blockMeshDict with blocks of many cells.
const GRADED: &str = "graded";

/// A dictionary with few blocks, whose edges have the points of the grid. Left-handed blocks are turned over.
fn graded_mesh(
    blocks: Vec<NamedBlock>,
    mesh: &HexMesh,
    partners: &[PeriodicPartner],
) -> Result<Vec<u8>, Diagnostic> {
    if let Some(own) = partners.first() {
        let message =
            format!("a graded blockMeshDict has no periodic boundary, as is `{}`", own.name);
        return Err(Diagnostic::error("cannot-write", message)
            .expected(
                "other boundaries: blockMesh orders the faces of blocks of many cells by itself",
            )
            .help("write the mesh itself: write_polymesh(\"constant/polyMesh\", ...)"));
    }
    let volumes: Vec<f64> = volumes(&blocks).iter().map(VolumeGrid::volume).collect();
    let turned = |(mut block, volume): (NamedBlock, f64)| {
        if volume < 0.0 {
            let ni = block.grid.size[0];
            for plane in &mut block.grid.planes {
                plane.chunks_mut(ni).for_each(<[f64]>::reverse);
            }
            block.faces.swap(0, 1);
        }
        block
    };
    let blocks: Vec<NamedBlock> = blocks.into_iter().zip(volumes).map(turned).collect();
    let entries = openfoam::boundary_entries(mesh, partners);
    let patches: Vec<GradedPatch> = connected(&blocks)?
        .boundaries
        .into_iter()
        .filter_map(|((block, face, from, to), name, _)| {
            let (_, entries) = entries.iter().find(|(own, _)| *own == name)?;
            let low = std::array::from_fn(|k: usize| from[k].min(to[k]));
            let high = std::array::from_fn(|k: usize| from[k].max(to[k]));
            Some(GradedPatch { block, face, from: low, to: high, name, entries: entries.clone() })
        })
        .collect();
    Ok(graded_block_mesh(&merged(&blocks)?, &patches, 0))
}

fn poly_mesh(file: GridFile<'_>) -> Result<EncodedFiles, Diagnostic> {
    option(&file, "")?;
    let folder = file.path.trim_end_matches('/');
    let (_, mesh, partners) = foam_mesh(file)?;
    let parts = openfoam::poly_mesh(&mesh, &partners).map_err(cannot)?;
    let named = |(name, bytes): openfoam::FoamFile| (format!("{folder}/{name}"), bytes);
    Ok(parts.into_iter().map(named).collect())
}

/// Refuses surfaces in a file of blocks.
fn blocks_only(file: &GridFile<'_>) -> Result<(), Diagnostic> {
    if !are_flat(&file.blocks)? {
        return Ok(());
    }
    let message = format!("`{}` is a surface", file.blocks[0].name);
    Err(Diagnostic::error("cannot-write", message).expected("blocks of cells"))
}

fn neutral_map_file(file: GridFile<'_>) -> Result<EncodedFiles, Diagnostic> {
    option(&file, "")?;
    blocks_only(&file)?;
    let sizes: Vec<[usize; 3]> = file.blocks.iter().map(|block| block.grid.size).collect();
    let Some(connected) = &file.connected else { return Ok(Vec::new()) };
    let entries = map_entries(&file.blocks, connected)?;
    Ok(one(file.path, neutral_map(&sizes, &entries)))
}

/// Names of UGRID files: their arrangement is part of the ending.
const UGRID_ENDINGS: [(&str, UgridLayout); 3] = [
    (".lb8.ugrid", UgridLayout::Stream { big_endian: false }),
    (".b8.ugrid", UgridLayout::Stream { big_endian: true }),
    (".ugrid", UgridLayout::Text),
];

fn ugrid_file(file: GridFile<'_>) -> Result<EncodedFiles, Diagnostic> {
    option(&file, "")?;
    blocks_only(&file)?;
    let ending = UGRID_ENDINGS.iter().find(|(ending, _)| file.path.ends_with(ending));
    let Some((ending, layout)) = ending else {
        let message = format!("`{}` is not the name of a UGRID file", file.path);
        return Err(Diagnostic::error("cannot-write", message)
            .expected("a name that ends in .b8.ugrid, .lb8.ugrid or .ugrid"));
    };
    let mesh = one_mesh(&file.blocks);
    let conditions = conditions(&mesh)?;
    let grid = whole(ugrid(&mesh, *layout), &mesh, "UGRID")?;
    let named = format!("{}.mapbc", file.path.trim_end_matches(ending));
    Ok(vec![(file.path.to_string(), grid), (named, mapbc(&conditions))])
}
