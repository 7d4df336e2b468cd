//! Blocks of cells: solids of a model, and grids of points with given joints and boundaries.

use super::surfaces::{in_symmetry, joint, largest};
use super::write::{
    BlockJoint, CgnsBoundary, CgnsCondition, CgnsFamily, CgnsFile, CgnsZone, FacePart,
};
use crate::error::check_blocks;
use crate::plot3d::of_block;
use crate::{StructuredGrid, WriteError};
use moldloft_mesh::{Blocks, Boundary};
use std::borrow::Cow;

/// Types of boundaries, and those of SIDS; others are user-defined.
const CONDITIONS: [(&str, &str); 5] = [
    ("symmetry", "BCSymmetryPlane"),
    ("wall", "BCWall"),
    ("farfield", "BCFarfield"),
    ("inflow", "BCInflow"),
    ("outflow", "BCOutflow"),
];

/// Names of the six faces.
const FACES: [&str; 6] = ["u0", "u1", "v0", "v1", "w0", "w1"];

/// Parts of the blocks' faces without a neighbour, their names and types: `symmetry` in a plane of symmetry, `open` for
/// faces that are no surfaces, else `wall`.
pub fn block_boundaries(blocks: &Blocks, symmetry: &str) -> Vec<(FacePart, String, &'static str)> {
    let grids: Vec<StructuredGrid> =
        blocks.blocks().iter().map(|block| of_block(blocks.positions(), block)).collect();
    boundaries_of(blocks, &grids, symmetry)
}

fn boundaries_of(
    blocks: &Blocks,
    grids: &[StructuredGrid],
    symmetry: &str,
) -> Vec<(FacePart, String, &'static str)> {
    let size = largest(grids.iter());
    let (_, free) = blocks.interfaces();
    let named = |part: Boundary| {
        let block = &blocks.blocks()[part.block];
        let name = block.faces[part.face].name.clone();
        let own = format!("{}.{}", block.name, FACES[part.face]);
        let kind = match in_symmetry(&grids[part.block], [part.from, part.to], symmetry, size) {
            true => "symmetry",
            false if name == own => "open",
            false => "wall",
        };
        ((part.block, part.face, part.from, part.to), name, kind)
    };
    free.into_iter().map(named).collect()
}

/// A zone for each block; interfaces by identity of their vertices; a family for each boundary.
///
/// # Errors
/// No blocks; positions that are not finite.
pub fn write_blocks(
    blocks: &Blocks,
    title: &str,
    length: &str,
    symmetry: &str,
) -> Result<Vec<u8>, WriteError> {
    check_blocks(blocks, f64::MAX)?;
    let grids: Vec<StructuredGrid> =
        blocks.blocks().iter().map(|block| of_block(blocks.positions(), block)).collect();
    let boundaries = boundaries_of(blocks, &grids, symmetry);
    let (joints, _) = blocks.interfaces();
    let names = blocks.blocks().iter().map(|block| block.name.as_str());
    let zones = names.zip(grids.into_iter().map(Cow::Owned)).collect();
    let boundaries = boundaries.into_iter().map(|(part, name, kind)| (part, name.into(), kind));
    write(title, length, zones, joints.iter().map(joint).collect(), boundaries.collect())
}

/// A zone for each grid, with these joints and boundaries: part, name and type.
///
/// # Errors
/// No grids; points that are not finite.
pub fn write_volume(
    grids: &[StructuredGrid],
    names: &[String],
    joints: Vec<BlockJoint>,
    boundaries: &[(FacePart, String, String)],
    title: &str,
) -> Result<Vec<u8>, WriteError> {
    StructuredGrid::check(grids, f64::MAX)?;
    let zones = names.iter().map(String::as_str).zip(grids.iter().map(Cow::Borrowed));
    let boundaries = boundaries
        .iter()
        .map(|(part, name, kind)| (*part, Cow::Borrowed(name.as_str()), kind.as_str()));
    write(title, "", zones.collect(), joints, boundaries.collect())
}

fn write<'a>(
    title: &str,
    length: &str,
    zones: Vec<(&str, Cow<'a, StructuredGrid>)>,
    joints: Vec<BlockJoint>,
    boundaries: Vec<(FacePart, Cow<'a, str>, &str)>,
) -> Result<Vec<u8>, WriteError> {
    let zone = |(name, grid): (&str, Cow<'a, StructuredGrid>)| CgnsZone {
        name: name.to_string(),
        grid,
        family: None,
        boundaries: Vec::new(),
    };
    let mut zones: Vec<CgnsZone<'_>> = zones.into_iter().map(zone).collect();
    let mut families: Vec<CgnsFamily<'_>> = Vec::new();
    for (part, name, kind) in boundaries {
        let family = families.iter().position(|family| family.name == name).unwrap_or_else(|| {
            let known = CONDITIONS.iter().find(|(own, _)| *own == kind);
            let condition = known.map_or("UserDefined", |(_, condition)| *condition);
            families.push(CgnsFamily { name, condition, tag: None });
            families.len() - 1
        });
        let own = &mut zones[part.0].boundaries;
        own.push(CgnsBoundary {
            name: format!("{}_{}", FACES[part.1], own.len() + 1),
            part,
            condition: CgnsCondition::Family(family),
        });
    }
    CgnsFile { title, length, dimensions: 3, families, zones, joints }.write()
}
