//! UGRID files of AFLR3, and boundaries of FUN3D in a .mapbc (SimCenter, "UG_IO: 3D input/output
//! grid files"; FUN3D manual, "Boundary conditions").

use crate::WriteError;
use crate::hexahedra::{cells, corners, nodes, spaced};
use moldloft_grid::{HexMesh, PoleCell};
use std::fmt::Write;

/// Arrangement of a UGRID file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UgridLayout {
    /// Text.
    Text,
    /// Binary, reals of 8 bytes, little-endian or big-endian.
    Stream {
        /// True for big-endian.
        big_endian: bool,
    },
}

/// The elements of each kind, by nodes from 0, in the order of a file.
struct UgridElements {
    /// Triangles and quadrilaterals of the boundary.
    faces: [Vec<Vec<usize>>; 2],
    /// The boundary of each of them, from 1.
    tags: Vec<usize>,
    /// Tetrahedra, pyramids, wedges, hexahedra.
    cells: [Vec<Vec<usize>>; 4],
}

fn elements(mesh: &HexMesh) -> Result<UgridElements, WriteError> {
    let mut all =
        UgridElements { faces: Default::default(), tags: Vec::new(), cells: Default::default() };
    let mut tags: [Vec<usize>; 2] = Default::default();
    for (k, patch) in mesh.patches.iter().enumerate() {
        for face in &patch.faces {
            let of = corners(face);
            let kind = of.len() - 3;
            tags[kind].push(k + 1);
            all.faces[kind].push(of);
        }
    }
    all.tags = tags.concat();
    for cell in cells(mesh, "UGRID")? {
        match cell {
            PoleCell::Tetrahedron(of) => all.cells[0].push(of.to_vec()),
            // The quadrilateral is 1-4-5-2, the apex is 3.
            PoleCell::Pyramid([a, b, c, d, apex]) => all.cells[1].push(vec![a, d, apex, b, c]),
            // The triangle is counter-clockwise from the other one.
            PoleCell::Wedge([a, b, c, d, e, f]) => all.cells[2].push(vec![a, c, b, d, f, e]),
            PoleCell::Hexahedron(of) => all.cells[3].push(of.to_vec()),
        }
    }
    Ok(all)
}

/// A UGRID file: boundary faces outward, tagged by the number of their boundary.
///
/// # Errors
/// Collapsed cells for which the format has no form; more items than 32-bit numbers count.
pub fn ugrid(mesh: &HexMesh, layout: UgridLayout) -> Result<Vec<u8>, WriteError> {
    let of = elements(mesh)?;
    let lists: Vec<&Vec<Vec<usize>>> = of.faces.iter().chain(&of.cells).collect();
    let counts: Vec<usize> =
        std::iter::once(mesh.points.len()).chain(lists.iter().map(|list| list.len())).collect();
    if let Some(&count) = counts.iter().find(|count| i32::try_from(**count).is_err()) {
        return Err(WriteError::TooLarge { what: "nodes or elements", count });
    }
    let UgridLayout::Stream { big_endian } = layout else {
        let mut out = format!("{}\n", nodes(&counts, 0));
        for p in &mesh.points {
            let _ = writeln!(out, "{}", spaced(*p));
        }
        let put = |out: &mut String, list: &[Vec<usize>]| {
            for element in list {
                let _ = writeln!(out, "{}", nodes(element, 1));
            }
        };
        of.faces.iter().for_each(|list| put(&mut out, list));
        for tag in &of.tags {
            let _ = writeln!(out, "{tag}");
        }
        of.cells.iter().for_each(|list| put(&mut out, list));
        return Ok(out.into_bytes());
    };
    let mut out = Vec::new();
    let whole =
        |n: usize| if big_endian { (n as i32).to_be_bytes() } else { (n as i32).to_le_bytes() };
    counts.iter().for_each(|n| out.extend(whole(*n)));
    for x in mesh.points.iter().flat_map(|p| p.to_array()) {
        out.extend(if big_endian { x.to_be_bytes() } else { x.to_le_bytes() });
    }
    let numbers = |list: &[Vec<usize>]| -> Vec<u8> {
        list.iter().flatten().flat_map(|n| whole(n + 1)).collect()
    };
    of.faces.iter().for_each(|list| out.extend(numbers(list)));
    of.tags.iter().for_each(|tag| out.extend(whole(*tag)));
    of.cells.iter().for_each(|list| out.extend(numbers(list)));
    Ok(out)
}

/// A .mapbc of FUN3D: the number, the condition and the name of each boundary.
pub fn mapbc(conditions: &[(u32, String)]) -> Vec<u8> {
    let mut out = format!("{}\n", conditions.len());
    for (k, (condition, name)) in conditions.iter().enumerate() {
        let _ = writeln!(out, "{} {condition} {name}", k + 1);
    }
    out.into_bytes()
}
