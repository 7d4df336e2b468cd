//! blockMeshDict of OpenFOAM from blocks with many cells each (OpenFOAM user guide, "blockMesh").
//!
//! blockMesh joins whole faces of blocks and identifies an edge by its two vertices. So blocks are cut where a part of a
//! face meets another block, where two edges would run between the same vertices, where a ring closes on itself, and where
//! the corners alone are no block.
//! Edges are `polyLine` through the vertices of the grid, graded cell by cell, so that blockMesh's points on them are the
//! grid's; inside faces and blocks it interpolates between the edges. More cuts bring that closer to the grid.

use crate::hexahedra::{nodes, spaced};
use crate::openfoam::header;
use moldloft_grid::HEX_FACES;
use moldloft_mesh::{Blocks, HexBlock, Interface};
use moldloft_num::Vec3;
use std::collections::{BTreeSet, HashMap};
use std::fmt::Write;

/// A part of a block that becomes one block of blockMesh: block, first and last vertex (i, j, k).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GradedPart {
    /// The block.
    pub block: usize,
    /// Its first vertex.
    pub begin: [usize; 3],
    /// Its last vertex.
    pub end: [usize; 3],
}

/// A part of a face on the boundary.
#[derive(Clone, Debug)]
pub struct GradedPatch {
    /// The block.
    pub block: usize,
    /// The face, as of [`HexBlock`].
    pub face: usize,
    /// First vertex (i, j, k).
    pub from: [usize; 3],
    /// Last vertex.
    pub to: [usize; 3],
    /// Name of the patch.
    pub name: String,
    /// Its entries of a dictionary, a line each, such as "    type wall;\n".
    pub entries: String,
}

/// The corners of a hexahedron as indices.
const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

/// The four edges along each axis, in blockMesh's order.
const EDGES: [[[usize; 2]; 4]; 3] = [
    [[0, 1], [3, 2], [7, 6], [4, 5]],
    [[0, 3], [1, 2], [5, 6], [4, 7]],
    [[0, 4], [1, 5], [2, 6], [3, 7]],
];

/// Differences of cells, relative to an edge, below which it is uniform.
const EVEN: f64 = 1e-13;

type Cuts = Vec<[BTreeSet<usize>; 3]>;

impl GradedPart {
    fn corner(&self, k: usize) -> [usize; 3] {
        std::array::from_fn(
            |axis| if CORNERS[k][axis] == 1 { self.end[axis] } else { self.begin[axis] },
        )
    }

    /// The vertices of an edge.
    fn line(&self, block: &HexBlock, axis: usize, edge: usize) -> Vec<u32> {
        let at = self.corner(EDGES[axis][edge][0]);
        let along = |index: usize| {
            let mut at = at;
            at[axis] = index;
            block.at(at)
        };
        (self.begin[axis]..=self.end[axis]).map(along).collect()
    }
}

/// The blocks divided into parts that blockMesh can join, and after each `every` cells, 0: only where it must be.
pub fn graded_parts(blocks: &Blocks, every: usize) -> Vec<GradedPart> {
    let (joints, free) = blocks.interfaces();
    let mut cuts: Cuts = blocks
        .blocks()
        .iter()
        .map(|block| {
            block.divisions().map(|n| {
                let inner = (0..n).step_by(if every == 0 { n.max(1) } else { every });
                inner.chain([n]).collect()
            })
        })
        .collect();
    for joint in &joints {
        for (k, (block, _)) in joint.sides.iter().enumerate() {
            for axis in 0..3 {
                cuts[*block][axis].extend([joint.from[k][axis], joint.to[k][axis]]);
            }
        }
    }
    for part in &free {
        for axis in 0..3 {
            cuts[part.block][axis].extend([part.from[axis], part.to[axis]]);
        }
    }
    loop {
        spread(&mut cuts, &joints);
        let parts = parts(&cuts);
        if !separated(blocks, &parts, &mut cuts) && !untwisted(blocks, &parts, &mut cuts) {
            return parts;
        }
    }
}

/// Carries cuts over to joined blocks until there are no new ones.
fn spread(cuts: &mut Cuts, joints: &[Interface]) {
    let mut changed = true;
    while changed {
        changed = false;
        for joint in joints {
            let [(own, _), (other, _)] = joint.sides;
            for (axis, (there, against)) in joint.axes.into_iter().enumerate() {
                let (start, end) = (joint.from[0][axis], joint.to[0][axis]);
                for step in 0..end.abs_diff(start) + 1 {
                    if start == end {
                        break;
                    }
                    let a = if end > start { start + step } else { start - step };
                    let first = joint.from[1][there];
                    let b = if against == (end > start) { first - step } else { first + step };
                    if cuts[own][axis].contains(&a) != cuts[other][there].contains(&b) {
                        cuts[own][axis].insert(a);
                        cuts[other][there].insert(b);
                        changed = true;
                    }
                }
            }
        }
    }
}

fn parts(cuts: &Cuts) -> Vec<GradedPart> {
    let mut all = Vec::new();
    for (block, axes) in cuts.iter().enumerate() {
        let [us, vs, ws] = axes.each_ref().map(|axis| {
            let at: Vec<usize> = axis.iter().copied().collect();
            at.windows(2).map(|pair| [pair[0], pair[1]]).collect::<Vec<_>>()
        });
        for [i0, i1] in us {
            for [j0, j1] in &vs {
                for [k0, k1] in &ws {
                    all.push(GradedPart { block, begin: [i0, *j0, *k0], end: [i1, *j1, *k1] });
                }
            }
        }
    }
    all
}

/// Cuts edges between the vertices of another edge; true if any was.
fn separated(blocks: &Blocks, parts: &[GradedPart], cuts: &mut Cuts) -> bool {
    let mut known: HashMap<[u32; 2], Vec<u32>> = HashMap::new();
    let mut new = false;
    for part in parts {
        let block = &blocks.blocks()[part.block];
        for axis in 0..3 {
            for edge in 0..4 {
                let mut line = part.line(block, axis, edge);
                if line.len() == 2 || line.iter().all(|v| *v == line[0]) {
                    continue;
                }
                if line[0] > line[line.len() - 1] {
                    line.reverse();
                }
                let ends = [line[0], line[line.len() - 1]];
                let other = known.entry(ends).or_insert_with(|| line.clone());
                if ends[0] == ends[1] || *other != line {
                    new |= cuts[part.block][axis].insert((part.begin[axis] + part.end[axis]) / 2);
                }
            }
        }
    }
    new
}

/// Cuts parts whose corners alone are no block to blockMesh, such as one that wraps round a section, across the axis
/// along which edges bend most; true if any was.
fn untwisted(blocks: &Blocks, parts: &[GradedPart], cuts: &mut Cuts) -> bool {
    let mut new = false;
    for part in parts {
        let block = &blocks.blocks()[part.block];
        let at = |v: u32| blocks.positions()[v as usize];
        let corners: [Vec3; 8] = std::array::from_fn(|k| at(block.at(part.corner(k))));
        if is_outward(&corners) {
            continue;
        }
        // The chord of the edges along an axis, relative to their length.
        let straight = |axis: usize| {
            let edges = (0..4).map(|edge| {
                let line = part.line(block, axis, edge);
                let length: f64 = line.windows(2).map(|w| at(w[0]).distance(at(w[1]))).sum();
                let chord = at(line[0]).distance(at(line[line.len() - 1]));
                if length > 0.0 { chord / length } else { 1.0 }
            });
            edges.fold(1.0, f64::min)
        };
        let axes = (0..3).filter(|axis| part.end[*axis] - part.begin[*axis] > 1);
        if let Some(axis) = axes.min_by(|a, b| straight(*a).total_cmp(&straight(*b))) {
            new |= cuts[part.block][axis].insert((part.begin[axis] + part.end[axis]) / 2);
        }
    }
    new
}

/// True if all faces of a hexahedron point outward from its centre, as blockMesh tests; collapsed ones do not count.
fn is_outward(corners: &[Vec3; 8]) -> bool {
    let mean = |of: &[Vec3]| of.iter().fold(Vec3::zero(), |sum, p| sum + *p) / of.len() as f64;
    let middle = mean(corners);
    // Centre and area vector, by triangles about the mean of the corners.
    let faces = HEX_FACES.map(|face| {
        let of = face.map(|k| corners[k]);
        let rough = mean(&of);
        let (mut area, mut sum, mut whole) = (Vec3::zero(), Vec3::zero(), 0.0);
        for k in 0..4 {
            let (p, q) = (of[k], of[(k + 1) % 4]);
            let triangle = (p - rough).cross(q - rough) * 0.5;
            area += triangle;
            sum += (p + q + rough) * (triangle.norm() / 3.0);
            whole += triangle.norm();
        }
        (if whole > 0.0 { sum / whole } else { rough }, area)
    });
    // The centre by the pyramids of the faces.
    let (mut centre, mut volume) = (Vec3::zero(), 0.0);
    for (face, area) in faces {
        let pyramid = (area.dot(face - middle) / 3.0).abs();
        centre += (face * 0.75 + middle * 0.25) * pyramid;
        volume += pyramid;
    }
    let centre = if volume > 0.0 { centre / volume } else { middle };
    faces.iter().all(|(face, area)| area.norm() <= f64::EPSILON || area.dot(*face - centre) > 0.0)
}

/// Gradings of an edge: one number if uniform, else the fraction of the length of each cell.
fn graded(lengths: &[f64]) -> String {
    let total: f64 = lengths.iter().sum();
    let least = lengths.iter().copied().fold(f64::INFINITY, f64::min);
    let most = lengths.iter().copied().fold(0.0, f64::max);
    if total == 0.0 || most - least <= EVEN * total {
        return "1".to_string();
    }
    let each: Vec<String> = lengths.iter().map(|x| format!("({:?} 1 1)", x / total)).collect();
    format!("({})", each.join(" "))
}

/// A word of OpenFOAM: no blanks, quotes, slashes, brackets or semicolons.
fn word(name: &str) -> String {
    let sound = |c: char| if c.is_alphanumeric() || "._-+".contains(c) { c } else { '_' };
    let word: String = name.chars().map(sound).collect();
    if word.is_empty() { "unnamed".to_string() } else { word }
}

/// The dictionary of right-handed blocks; parts of faces in no patch are of the default one.
pub fn graded_block_mesh(blocks: &Blocks, patches: &[GradedPatch], every: usize) -> Vec<u8> {
    let parts = graded_parts(blocks, every);
    let positions = blocks.positions();
    let mut numbers: HashMap<u32, usize> = HashMap::new();
    let mut vertices: Vec<u32> = Vec::new();
    let (mut hexes, mut lines) = (String::new(), String::new());
    let mut edges: BTreeSet<[usize; 2]> = BTreeSet::new();
    let mut corners: Vec<[usize; 8]> = Vec::with_capacity(parts.len());
    for part in &parts {
        let block = &blocks.blocks()[part.block];
        let own: [usize; 8] = std::array::from_fn(|k| {
            let vertex = block.at(part.corner(k));
            *numbers.entry(vertex).or_insert_with(|| {
                vertices.push(vertex);
                vertices.len() - 1
            })
        });
        let mut gradings: Vec<String> = Vec::with_capacity(12);
        for axis in 0..3 {
            for edge in 0..4 {
                let line = part.line(block, axis, edge);
                let at = |v: u32| positions[v as usize];
                let lengths: Vec<f64> =
                    line.windows(2).map(|w| at(w[0]).distance(at(w[1]))).collect();
                gradings.push(graded(&lengths));
                let [a, b] = EDGES[axis][edge].map(|k| own[k]);
                if a != b && line.len() > 2 && !edges.contains(&[b, a]) && edges.insert([a, b]) {
                    let inner: Vec<String> = line[1..line.len() - 1]
                        .iter()
                        .map(|v| format!("({})", spaced(at(*v))))
                        .collect();
                    let _ = writeln!(lines, "    polyLine {a} {b} ({})", inner.join(" "));
                }
            }
        }
        let cells: [usize; 3] = std::array::from_fn(|k| part.end[k] - part.begin[k]);
        let _ = writeln!(
            hexes,
            "    hex ({}) {} ({}) edgeGrading ({})",
            nodes(&own, 0),
            word(&block.name),
            nodes(&cells, 0),
            gradings.join(" ")
        );
        corners.push(own);
    }
    let mut out = header("dictionary", "blockMeshDict");
    out.push_str("scale 1;\ndefaultPatch { name defaultFaces; type patch; }\nvertices\n(\n");
    for vertex in &vertices {
        let _ = writeln!(out, "    ({})", spaced(positions[*vertex as usize]));
    }
    let _ = write!(out, ");\nblocks\n(\n{hexes});\nedges\n(\n{lines});\nboundary\n(\n");
    for (name, entries, faces) in boundary(&parts, &corners, patches) {
        let _ = write!(out, "    {name}\n    {{\n{entries}    faces\n    (\n");
        for face in faces {
            let _ = writeln!(out, "        ({})", nodes(&face, 0));
        }
        out.push_str("    );\n    }\n");
    }
    out.push_str(");\nmergePatchPairs ();\n");
    out.into_bytes()
}

/// Name, entries and faces of each patch.
fn boundary(
    parts: &[GradedPart],
    corners: &[[usize; 8]],
    patches: &[GradedPatch],
) -> Vec<(String, String, Vec<[usize; 4]>)> {
    let mut all: Vec<(String, String, Vec<[usize; 4]>)> = Vec::new();
    for patch in patches {
        let (axis, high) = (patch.face / 2, patch.face % 2 == 1);
        for (part, own) in parts.iter().zip(corners).filter(|(part, _)| part.block == patch.block) {
            let at = if high { part.end[axis] } else { part.begin[axis] };
            let inside = |k: usize| {
                k == axis || patch.from[k] <= part.begin[k] && part.end[k] <= patch.to[k]
            };
            let face = HEX_FACES[patch.face].map(|k| own[k]);
            let distinct: BTreeSet<usize> = face.into_iter().collect();
            if at != patch.from[axis] || !(0..3).all(inside) || distinct.len() < 3 {
                continue;
            }
            let name = word(&patch.name);
            match all.iter_mut().find(|(own, entries, _)| *own == name && *entries == patch.entries)
            {
                Some((_, _, faces)) => faces.push(face),
                None => all.push((name, patch.entries.clone(), vec![face])),
            }
        }
    }
    all
}
