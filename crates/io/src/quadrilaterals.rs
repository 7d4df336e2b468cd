//! Plane meshes of quadrilaterals with named boundaries: SU2, Gmsh 4.1.

use moldloft_grid::HexMesh;
use moldloft_num::Vec3;
use std::collections::HashMap;
use std::fmt::Write;

/// A named part of the boundary of a plane mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BoundaryLine {
    /// Its name.
    pub name: String,
    /// Edges by their nodes, the mesh on their left.
    pub edges: Vec<[usize; 2]>,
}

/// A plane mesh of quadrilaterals, and of triangles at poles.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneMesh {
    /// Nodes: the two coordinates in the plane.
    pub points: Vec<[f64; 2]>,
    /// Cells by their nodes, counter-clockwise; three for a triangle.
    pub cells: Vec<Vec<usize>>,
    /// The boundary.
    pub lines: Vec<BoundaryLine>,
}

impl PlaneMesh {
    /// The plane mesh of a mesh with one layer of cells, which is extruded along `normal`: `axes`
    /// are the two coordinates in the plane, and the patches called `sides` are its upper and lower
    /// side.
    pub fn under(mesh: &HexMesh, axes: [usize; 2], normal: Vec3, sides: &str) -> Self {
        // Both nodes of a column are one node of the plane: its coordinates are the same.
        let mut numbers: HashMap<usize, usize> = HashMap::new();
        let mut points = Vec::new();
        let mut number = |low: usize, high: usize| -> usize {
            let known = numbers.get(&low).or_else(|| numbers.get(&high)).copied();
            let n = known.unwrap_or_else(|| {
                let at = mesh.points[low].to_array();
                points.push(axes.map(|axis| at[axis] + 0.0));
                points.len() - 1
            });
            numbers.insert(low, n);
            numbers.insert(high, n);
            n
        };
        let mut cells = Vec::with_capacity(mesh.cells.len());
        for cell in &mesh.cells {
            let mut quad: Vec<usize> = (0..4).map(|k| number(cell[k], cell[k + 4])).collect();
            let up = (0..4)
                .fold(Vec3::zero(), |sum, k| sum + mesh.points[cell[k + 4]] - mesh.points[cell[k]]);
            if up.dot(normal) < 0.0 {
                quad.reverse();
            }
            quad.dedup();
            if quad.len() > 1 && quad.first() == quad.last() {
                quad.pop();
            }
            cells.push(quad);
        }
        // Edges are traversed around their cell.
        let mut along: HashMap<[usize; 2], ()> = HashMap::new();
        for quad in &cells {
            for k in 0..quad.len() {
                along.insert([quad[k], quad[(k + 1) % quad.len()]], ());
            }
        }
        let mut lines = Vec::new();
        for patch in mesh.patches.iter().filter(|patch| patch.name != sides) {
            let mut edges = Vec::with_capacity(patch.faces.len());
            for face in &patch.faces {
                let mut ends: Vec<usize> = face.iter().map(|node| numbers[node]).collect();
                ends.sort_unstable();
                ends.dedup();
                if let [a, b] = ends[..] {
                    edges.push(if along.contains_key(&[a, b]) { [a, b] } else { [b, a] });
                }
            }
            lines.push(BoundaryLine { name: patch.name.clone(), edges });
        }
        Self { points, cells, lines }
    }
}

fn nodes(of: &[usize], first: usize) -> String {
    let all: Vec<String> = of.iter().map(|n| (n + first).to_string()).collect();
    all.join(" ")
}

/// A plane mesh of SU2 (SU2 documentation, Mesh File): cells by the numbers of VTK, and a marker for each boundary.
pub fn su2(mesh: &PlaneMesh) -> Vec<u8> {
    let mut out = format!("NDIME= 2\nNELEM= {}\n", mesh.cells.len());
    for (k, cell) in mesh.cells.iter().enumerate() {
        let kind = if cell.len() == 3 { 5 } else { 9 };
        let _ = writeln!(out, "{kind} {} {k}", nodes(cell, 0));
    }
    let _ = writeln!(out, "NPOIN= {}", mesh.points.len());
    for (k, [x, y]) in mesh.points.iter().enumerate() {
        let _ = writeln!(out, "{x:?} {y:?} {k}");
    }
    let _ = writeln!(out, "NMARK= {}", mesh.lines.len());
    for line in &mesh.lines {
        let _ = writeln!(out, "MARKER_TAG= {}\nMARKER_ELEMS= {}", line.name, line.edges.len());
        for edge in &line.edges {
            let _ = writeln!(out, "3 {}", nodes(edge, 0));
        }
    }
    out.into_bytes()
}

/// A plane mesh of Gmsh, format 4.1, text, in z = 0: a physical curve for each boundary, and the surface "fluid".
pub fn gmsh(mesh: &PlaneMesh) -> Vec<u8> {
    let count = mesh.lines.len();
    let mut out = String::from("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n");
    let _ = writeln!(out, "{}", count + 1);
    for (k, line) in mesh.lines.iter().enumerate() {
        let _ = writeln!(out, "1 {} \"{}\"", k + 1, line.name);
    }
    let _ = writeln!(out, "2 {} \"fluid\"\n$EndPhysicalNames\n$Entities", count + 1);
    let _ = writeln!(out, "0 {count} 1 0");
    let bounds = |of: &mut dyn Iterator<Item = usize>| {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for n in of {
            for axis in 0..2 {
                low[axis] = low[axis].min(mesh.points[n][axis]);
                high[axis] = high[axis].max(mesh.points[n][axis]);
            }
        }
        format!("{:?} {:?} 0.0 {:?} {:?} 0.0", low[0], low[1], high[0], high[1])
    };
    for (k, line) in mesh.lines.iter().enumerate() {
        let of = bounds(&mut line.edges.iter().flatten().copied());
        let _ = writeln!(out, "{0} {of} 1 {0} 0", k + 1);
    }
    let curves: Vec<usize> = (1..=count).collect();
    let of = bounds(&mut (0..mesh.points.len()));
    let _ = writeln!(out, "1 {of} 1 {} {count} {}", count + 1, nodes(&curves, 0));
    let total = mesh.points.len();
    let _ = writeln!(out, "$EndEntities\n$Nodes\n1 {total} 1 {total}\n2 1 0 {total}");
    (1..=total).for_each(|n| {
        let _ = writeln!(out, "{n}");
    });
    for [x, y] in &mesh.points {
        let _ = writeln!(out, "{x:?} {y:?} 0.0");
    }
    let mut all: Vec<(String, Vec<&[usize]>)> = Vec::new();
    for (k, line) in mesh.lines.iter().enumerate() {
        all.push((format!("1 {} 1", k + 1), line.edges.iter().map(|e| &e[..]).collect()));
    }
    for (kind, corners) in [(3, 4), (2, 3)] {
        let of = mesh.cells.iter().filter(|cell| cell.len() == corners).map(|cell| &cell[..]);
        all.push((format!("2 1 {kind}"), of.collect()));
    }
    all.retain(|(_, of)| !of.is_empty());
    let elements: usize = all.iter().map(|(_, of)| of.len()).sum();
    let _ = writeln!(out, "$EndNodes\n$Elements\n{} {elements} 1 {elements}", all.len());
    let mut number = 0;
    for (head, of) in &all {
        let _ = writeln!(out, "{head} {}", of.len());
        for element in of {
            number += 1;
            let _ = writeln!(out, "{number} {}", nodes(element, 1));
        }
    }
    out.push_str("$EndElements\n");
    out.into_bytes()
}
