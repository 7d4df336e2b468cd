//! Meshes of hexahedra with named boundaries: SU2, Gmsh 4.1.

use crate::WriteError;
use moldloft_grid::{HexMesh, PoleCell};
use moldloft_num::{Real, Vec3};
use std::fmt::Write;

/// The cells, classified at poles.
pub(crate) fn cells(mesh: &HexMesh, format: &'static str) -> Result<Vec<PoleCell>, WriteError> {
    let what = "hexahedra collapsed to other cells than wedges, pyramids and tetrahedra";
    mesh.pole_cells().ok_or(WriteError::CannotHold { format, what })
}

/// A face of the boundary without the corner that it has twice.
pub(crate) fn corners(face: &[usize; 4]) -> Vec<usize> {
    let mut around = face.to_vec();
    around.dedup();
    if around.first() == around.last() {
        around.pop();
    }
    around
}

/// Numbers in their shortest exact spelling, apart by blanks.
pub(crate) fn spaced(p: Vec3) -> String {
    let [x, y, z] = p.to_array().map(|x| x + 0.0);
    format!("{x:?} {y:?} {z:?}")
}

pub(crate) fn nodes(of: &[usize], first: usize) -> String {
    let all: Vec<String> = of.iter().map(|n| (n + first).to_string()).collect();
    all.join(" ")
}

/// A mesh of SU2 (SU2 documentation, Mesh File): cells by the numbers and the order of VTK, and a marker for each
/// boundary.
///
/// # Errors
/// Collapsed cells for which the format has no form.
pub fn su2(mesh: &HexMesh) -> Result<Vec<u8>, WriteError> {
    let mut out = format!("NDIME= 3\nNELEM= {}\n", mesh.cells.len());
    for (k, cell) in cells(mesh, "SU2")?.iter().enumerate() {
        let (kind, of): (_, &[usize]) = match cell {
            PoleCell::Hexahedron(of) => (12, of),
            PoleCell::Wedge(of) => (13, of),
            PoleCell::Pyramid(of) => (14, of),
            PoleCell::Tetrahedron(of) => (10, of),
        };
        let _ = writeln!(out, "{kind} {} {k}", nodes(of, 0));
    }
    let _ = writeln!(out, "NPOIN= {}", mesh.points.len());
    for (k, p) in mesh.points.iter().enumerate() {
        let _ = writeln!(out, "{} {k}", spaced(*p));
    }
    let _ = writeln!(out, "NMARK= {}", mesh.patches.len());
    for patch in &mesh.patches {
        let _ = writeln!(out, "MARKER_TAG= {}\nMARKER_ELEMS= {}", patch.name, patch.faces.len());
        for face in &patch.faces {
            let of = corners(face);
            let _ = writeln!(out, "{} {}", if of.len() == 3 { 5 } else { 9 }, nodes(&of, 0));
        }
    }
    Ok(out.into_bytes())
}

/// A mesh of Gmsh, format 4.1, text: a physical surface for each boundary, and the volume "fluid".
///
/// # Errors
/// Collapsed cells for which the format has no form.
pub fn gmsh(mesh: &HexMesh) -> Result<Vec<u8>, WriteError> {
    let cells = cells(mesh, "Gmsh")?;
    let patches = mesh.patches.len();
    let mut out = String::from("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n");
    let _ = writeln!(out, "{}", patches + 1);
    for (k, patch) in mesh.patches.iter().enumerate() {
        let _ = writeln!(out, "2 {} \"{}\"", k + 1, patch.name);
    }
    let _ = writeln!(out, "3 {} \"fluid\"\n$EndPhysicalNames\n$Entities", patches + 1);
    let _ = writeln!(out, "0 0 {patches} 1");
    let bounds = |of: &mut dyn Iterator<Item = usize>| {
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
        let of = bounds(&mut patch.faces.iter().flatten().copied());
        let _ = writeln!(out, "{0} {of} 1 {0} 0", k + 1);
    }
    let surfaces: Vec<usize> = (1..=patches).collect();
    let of = bounds(&mut (0..mesh.points.len()));
    let _ = writeln!(out, "1 {of} 1 {} {patches} {}", patches + 1, nodes(&surfaces, 0));
    let count = mesh.points.len();
    let _ = writeln!(out, "$EndEntities\n$Nodes\n1 {count} 1 {count}\n3 1 0 {count}");
    (1..=count).for_each(|n| {
        let _ = writeln!(out, "{n}");
    });
    for p in &mesh.points {
        let _ = writeln!(out, "{}", spaced(*p));
    }
    // The elements of each surface, then of the volume, those of one type together.
    let mut all: Vec<(String, Vec<Vec<usize>>)> = Vec::new();
    for (k, patch) in mesh.patches.iter().enumerate() {
        for (kind, count) in [(3, 4), (2, 3)] {
            let of = patch.faces.iter().map(corners).filter(|of| of.len() == count);
            all.push((format!("2 {} {kind}", k + 1), of.collect()));
        }
    }
    for kind in [5, 6, 7, 4] {
        let of = cells.iter().filter_map(|cell| match (kind, cell) {
            (5, PoleCell::Hexahedron(of)) => Some(of.to_vec()),
            // The triangle of a prism is counter-clockwise from the other one here.
            (6, &PoleCell::Wedge([a, b, c, d, e, f])) => Some(vec![a, c, b, d, f, e]),
            (7, PoleCell::Pyramid(of)) => Some(of.to_vec()),
            (4, PoleCell::Tetrahedron(of)) => Some(of.to_vec()),
            _ => None,
        });
        all.push((format!("3 1 {kind}"), of.collect()));
    }
    all.retain(|(_, of)| !of.is_empty());
    let total: usize = all.iter().map(|(_, of)| of.len()).sum();
    let _ = writeln!(out, "$EndNodes\n$Elements\n{} {total} 1 {total}", all.len());
    let mut number = 0;
    for (head, of) in &all {
        let _ = writeln!(out, "{head} {}", of.len());
        for element in of {
            number += 1;
            let _ = writeln!(out, "{number} {}", nodes(element, 1));
        }
    }
    out.push_str("$EndElements\n");
    Ok(out.into_bytes())
}

/// Maximum distance of points from a plane, relative to their extent, as in blockMesh.
pub const PLANE: f64 = 1e-6;

/// True for coplanar faces.
pub fn is_plane(points: &[Vec3], faces: &[[usize; 4]]) -> bool {
    let mut normal = Vec3::zero();
    let (mut centre, mut count, mut size) = (Vec3::zero(), 0.0, 0.0f64);
    for face in faces {
        let [a, b, c, d] = face.map(|n| points[n]);
        let mut area = (c - a).cross(d - b);
        // Faces of both sides of a plane count alike.
        if area.dot(normal) < 0.0 {
            area = -area;
        }
        normal += area;
        for p in [a, b, c, d] {
            centre += p;
            count += 1.0;
        }
    }
    let length = normal.norm();
    if !(length > 0.0) {
        return false;
    }
    let (normal, centre) = (normal / length, centre / count);
    let all = || faces.iter().flatten().map(|n| points[*n] - centre);
    all().for_each(|p| size = size.max(p.norm()));
    all().all(|p| p.dot(normal).abs() <= PLANE * size)
}

/// Position of the points of a periodic boundary relative to those of the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Periodicity {
    /// Moved by a vector.
    Translation(Vec3),
    /// Turned about the axis 0, 1 or 2 through the origin, by an angle in radians.
    Rotation(usize, f64),
}

impl Periodicity {
    /// The point of the other boundary that corresponds to one of this.
    pub fn moved(self, p: Vec3) -> Vec3 {
        match self {
            Periodicity::Translation(d) => p + d,
            Periodicity::Rotation(axis, angle) => {
                let (sine, cosine) = (Real::sin(angle), Real::cos(angle));
                let [a, b] = [[1, 2], [2, 0], [0, 1]][axis];
                let mut q = p.to_array();
                let (x, y) = (q[a], q[b]);
                (q[a], q[b]) = (cosine * x - sine * y, sine * x + cosine * y);
                q.into()
            }
        }
    }
}

/// The partner of a periodic boundary, and the position of its points relative to those of this
/// one.
#[derive(Clone, Debug, PartialEq)]
pub struct PeriodicPartner {
    /// The boundary.
    pub name: String,
    /// Its partner.
    pub partner: String,
    /// Map from the boundary to its partner.
    pub how: Periodicity,
}
