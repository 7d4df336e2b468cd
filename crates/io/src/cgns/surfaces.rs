//! Surfaces: patches of a mesh, and grids of points that join where points of their edges coincide.

use super::write::{BlockJoint, CgnsBoundary, CgnsCondition, CgnsFamily, CgnsFile, CgnsZone};
use crate::error::check_positions;
use crate::plot3d::{of_patch, structured_patches};
use crate::{StructuredGrid, WriteError};
use moldloft_grid::{VolumeGrid, shared_nodes_within};
use moldloft_mesh::{Boundary, HexBlock, Interface, Mesh, interfaces_of};
use moldloft_num::Vec3;
use std::borrow::Cow;

/// A surface with its vertices: those of joined edges are the same.
struct JoinedSurface<'a> {
    name: &'a str,
    tag: &'a str,
    grid: Cow<'a, StructuredGrid>,
    /// Vertex (i, j) at `[i * nj + j]`.
    vertices: Vec<u32>,
}

/// Distance, relative to the size of the whole, within which points of edges usually coincide.
pub const USUAL_TOLERANCE: f64 = 1e-9;

/// The first four faces of a block, whose layer is a surface: its edges.
const EDGES: [&str; 4] = ["u0", "u1", "v0", "v1"];

/// The structured patches of a mesh. Edges join by identity of their vertices; free edges, or parts of them, are
/// boundaries: symmetry planes if they are in one of those named by `symmetry`, else without a type. Each zone is in
/// the family of its patch.
///
/// # Errors
/// [`WriteError::NoGrid`] when some patch has no grid, or there are no patches; positions that are not finite.
pub fn write_mesh(
    mesh: &Mesh,
    title: &str,
    length: &str,
    symmetry: &str,
) -> Result<Vec<u8>, WriteError> {
    check_positions(mesh, f64::MAX)?;
    let patches = structured_patches(mesh)?;
    let tags = mesh.patches().iter().map(|patch| patch.info.tag.word());
    let surface = |((name, block), tag)| JoinedSurface {
        name,
        tag,
        grid: Cow::Owned(of_patch(mesh.positions(), block)),
        vertices: block.vertices.clone(),
    };
    write(title, length, symmetry, patches.into_iter().zip(tags).map(surface).collect())
}

/// Surfaces of points. Edges join where their points coincide, within `tolerance` times the size of the whole; edges of
/// zero length do not.
///
/// # Errors
/// No grids; points that are not finite; blocks, and grids without cells.
pub fn write_surfaces(
    grids: &[StructuredGrid],
    names: &[String],
    title: &str,
    tolerance: f64,
) -> Result<Vec<u8>, WriteError> {
    StructuredGrid::check(grids, f64::MAX)?;
    for (name, grid) in names.iter().zip(grids) {
        if grid.size[2] != 1 || grid.size[0] < 2 || grid.size[1] < 2 {
            let (name, size) = (name.clone(), grid.size);
            return Err(WriteError::NoSurface { format: "CGNS", name, size });
        }
    }
    let rows: Vec<VolumeGrid<f64>> = grids.iter().map(rim_points).collect();
    let (_, nodes) = shared_nodes_within(&rows, tolerance * extent(grids));
    let surfaces = grids.iter().zip(names).zip(nodes).map(|((grid, name), nodes)| {
        // Only edges join: the vertices inside are never compared.
        let mut vertices = vec![0; grid.count()];
        rim(grid).zip(nodes).for_each(|(at, node)| vertices[at] = node as u32);
        JoinedSurface { name, tag: "surface", grid: Cow::Borrowed(grid), vertices }
    });
    write(title, "", "", surfaces.collect())
}

/// The points of a surface's edges, at `i * nj + j` among all.
fn rim(grid: &StructuredGrid) -> impl Iterator<Item = usize> + use<> {
    let [ni, nj, _] = grid.size;
    let on_edge = move |at: &usize| {
        let (i, j) = (at / nj, at % nj);
        i == 0 || j == 0 || i + 1 == ni || j + 1 == nj
    };
    (0..ni * nj).filter(on_edge)
}

fn rim_points(grid: &StructuredGrid) -> VolumeGrid<f64> {
    let nj = grid.size[1];
    let points: Vec<Vec3> = rim(grid).map(|at| grid.at([at / nj, at % nj, 0])).collect();
    VolumeGrid::from_fn([1, points.len(), 1], |_, k, _| points[k])
}

/// The largest extent of all points along an axis.
fn extent(grids: &[StructuredGrid]) -> f64 {
    let along = |axis: usize| {
        let all = grids.iter().flat_map(|grid| &grid.planes[axis]);
        let start = (f64::INFINITY, f64::NEG_INFINITY);
        let (low, high) = all.fold(start, |(low, high), x| (low.min(*x), high.max(*x)));
        high - low
    };
    (0..3).map(along).fold(0.0, f64::max)
}

fn write(
    title: &str,
    length: &str,
    symmetry: &str,
    surfaces: Vec<JoinedSurface<'_>>,
) -> Result<Vec<u8>, WriteError> {
    let blocks = layers(&surfaces)?;
    let (joints, free) = interfaces_of(&blocks, EDGES.len());
    let size = largest(surfaces.iter().map(|surface| &*surface.grid));
    let mut families: Vec<CgnsFamily<'_>> = Vec::new();
    let mut zones: Vec<CgnsZone<'_>> = Vec::new();
    for surface in surfaces {
        let known = families.iter().position(|family| family.name == surface.name);
        let family = known.unwrap_or_else(|| {
            families.push(CgnsFamily {
                name: Cow::Borrowed(surface.name),
                condition: if surface.tag == "symmetry" { "BCSymmetryPlane" } else { "BCWall" },
                tag: Some(surface.tag),
            });
            families.len() - 1
        });
        zones.push(CgnsZone {
            // A zone and its family differ in name: both are children of the base.
            name: format!("Z_{}", surface.name),
            grid: surface.grid,
            family: Some(family),
            boundaries: Vec::new(),
        });
    }
    for part in &free {
        let same = |other: &&Boundary| (other.block, other.face) == (part.block, part.face);
        let (edge, several) = (EDGES[part.face], free.iter().filter(same).count() > 1);
        let zone = &mut zones[part.block];
        let flat = in_symmetry(&zone.grid, [part.from, part.to], symmetry, size);
        let before = zone.boundaries.iter().filter(|own| own.part.1 == part.face).count();
        zone.boundaries.push(CgnsBoundary {
            name: if several { format!("{edge}_{}", before + 1) } else { edge.to_string() },
            part: (part.block, part.face, part.from, part.to),
            condition: CgnsCondition::Type(if flat { "BCSymmetryPlane" } else { "UserDefined" }),
        });
    }
    let joints = joints.iter().map(joint).collect();
    CgnsFile { title, length, dimensions: 2, families, zones, joints }.write()
}

/// The surfaces as blocks of one layer, whose sides join as the edges do.
fn layers(surfaces: &[JoinedSurface<'_>]) -> Result<Vec<HexBlock>, WriteError> {
    let count = surfaces.iter().flat_map(|surface| &surface.vertices).max().map_or(0, |v| v + 1);
    if count > u32::MAX / 2 {
        return Err(WriteError::TooLarge { what: "vertices", count: count as usize });
    }
    let layer = |surface: &JoinedSurface<'_>| HexBlock {
        name: surface.name.to_string(),
        size: [surface.grid.size[0], surface.grid.size[1], 2],
        vertices: surface.vertices.iter().flat_map(|v| [*v, v + count]).collect(),
        faces: Default::default(),
    };
    Ok(surfaces.iter().map(layer).collect())
}

/// An interface as CGNS states it.
pub(super) fn joint(found: &Interface) -> BlockJoint {
    let side = |k: usize| (found.sides[k].0, found.sides[k].1, found.from[k], found.to[k]);
    (side(0), side(1), found.transform(), None)
}

/// The largest coordinate of all points, at least 1.
pub(super) fn largest<'a>(grids: impl Iterator<Item = &'a StructuredGrid>) -> f64 {
    grids.flat_map(|grid| grid.planes.iter().flatten()).fold(1.0, |most, x| most.max(x.abs()))
}

/// Distance from a plane of symmetry, relative to the largest coordinate, within which a boundary is in it.
const IN_PLANE: f64 = 1e-9;

/// True if a range of points is in one of the planes of symmetry.
pub(super) fn in_symmetry(
    grid: &StructuredGrid,
    [from, to]: [[usize; 3]; 2],
    symmetry: &str,
    size: f64,
) -> bool {
    ["x", "y", "z"].iter().zip(&grid.planes).any(|(letter, plane)| {
        let near = |[i, j, k]: [usize; 3]| {
            plane[(k * grid.size[1] + j) * grid.size[0] + i].abs() <= IN_PLANE * size
        };
        let last = |axis: usize| to[axis].min(grid.size[axis] - 1);
        symmetry.contains(letter)
            && (from[2]..=last(2))
                .all(|k| (from[1]..=last(1)).all(|j| (from[0]..=last(0)).all(|i| near([i, j, k]))))
    })
}
