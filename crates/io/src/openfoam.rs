//! Meshes of OpenFOAM: polyMesh and blockMeshDict (OpenFOAM user guide, "Mesh description", "blockMesh").

use crate::WriteError;
use crate::hexahedra::{PeriodicPartner, Periodicity, corners, is_plane, nodes, spaced};
use moldloft_grid::{BoundaryPatch, HEX_FACES, HexMesh};
use moldloft_num::Vec3;
use std::collections::HashMap;
use std::fmt::Write;

/// Distance, relative to the extent of the mesh, within which points of two periodic boundaries
/// correspond.
const SAME_PERIODIC: f64 = 1e-8;

pub(crate) fn header(class: &str, object: &str) -> String {
    format!(
        "FoamFile\n{{\n    version 2.0;\n    format ascii;\n    class {class};\n    object {object};\n}}\n"
    )
}

/// The entries that give the type of a boundary, each in a line of its own.
fn type_entries(mesh: &HexMesh, patch: &BoundaryPatch, periodic: &[PeriodicPartner]) -> String {
    let partner = periodic.iter().find(|own| own.name == patch.name);
    let kind = match &*patch.kind {
        "wall" => "wall",
        "symmetry" if is_plane(&mesh.points, &patch.faces) => "symmetryPlane",
        "symmetry" => "symmetry",
        "empty" => "empty",
        "wedge" => "wedge",
        "periodic" if partner.is_some() => "cyclic",
        _ => "patch",
    };
    let mut out = format!("    type {kind};\n");
    if let Some(own) = partner {
        let _ = writeln!(out, "    neighbourPatch {};", own.partner);
        let _ = match own.how {
            Periodicity::Translation(d) => {
                writeln!(out, "    transform translational;\n    separationVector ({});", spaced(d))
            }
            Periodicity::Rotation(axis, _) => {
                let unit = ["1 0 0", "0 1 0", "0 0 1"][axis];
                writeln!(
                    out,
                    "    transform rotational;\n    rotationAxis ({unit});\n    rotationCentre (0 0 0);"
                )
            }
        };
    }
    out
}

/// Name and entries of each boundary with a name.
pub fn boundary_entries(mesh: &HexMesh, periodic: &[PeriodicPartner]) -> Vec<(String, String)> {
    let named = mesh.patches.iter().filter(|patch| patch.name != "defaultFaces");
    named.map(|patch| (patch.name.clone(), type_entries(mesh, patch, periodic))).collect()
}

/// A blockMeshDict of OpenFOAM: a block for each cell, so that the points are those of the grid. The faces of periodic
/// boundaries have the order of their partners.
///
/// # Errors
/// As [`poly_mesh`], with periodic boundaries.
pub fn block_mesh(mesh: &HexMesh, periodic: &[PeriodicPartner]) -> Result<Vec<u8>, WriteError> {
    let ordered = if periodic.is_empty() { None } else { Some(ordered(mesh, periodic)?) };
    let mut out = header("dictionary", "blockMeshDict");
    out.push_str("scale 1;\ndefaultPatch { name defaultFaces; type patch; }\nvertices\n(\n");
    for p in &mesh.points {
        let _ = writeln!(out, "({})", spaced(*p));
    }
    out.push_str(");\nblocks\n(\n");
    for cell in &mesh.cells {
        let _ = writeln!(out, "hex ({}) (1 1 1) simpleGrading (1 1 1)", nodes(cell, 0));
    }
    out.push_str(");\nedges ();\nboundary\n(\n");
    for (number, patch) in mesh.patches.iter().enumerate() {
        // The faces that have no name are found by blockMesh itself.
        if patch.name == "defaultFaces" {
            continue;
        }
        let _ = write!(out, "{}\n{{\n{}", patch.name, type_entries(mesh, patch, periodic));
        out.push_str("    faces\n    (\n");
        let faces: Vec<String> = match &ordered {
            Some((faces, ranges)) => {
                let [first, count] = ranges[number];
                faces[first..first + count].iter().map(|face| nodes(&face.nodes, 0)).collect()
            }
            None => patch.faces.iter().map(|face| nodes(face, 0)).collect(),
        };
        for face in faces {
            let _ = writeln!(out, "    ({face})");
        }
        out.push_str("    );\n}\n");
    }
    out.push_str(");\nmergePatchPairs ();\n");
    Ok(out.into_bytes())
}

/// A file of a polyMesh, with its name in the folder.
pub type FoamFile = (&'static str, Vec<u8>);

/// A polygon between two cells, or between a cell and the outside.
#[derive(Clone)]
struct PolyFace {
    /// Its nodes, counter-clockwise as seen from outside the owner.
    nodes: Vec<usize>,
    owner: usize,
    neighbour: Option<usize>,
}

fn refused(what: &'static str) -> WriteError {
    WriteError::CannotHold { format: "OpenFOAM", what }
}

fn sorted(nodes: &[usize]) -> Vec<usize> {
    let mut key = nodes.to_vec();
    key.sort_unstable();
    key
}

/// All faces, in the order in which cells meet them, and their numbers by their nodes.
fn poly_faces(mesh: &HexMesh) -> Result<(Vec<PolyFace>, HashMap<Vec<usize>, usize>), WriteError> {
    let mut faces: Vec<PolyFace> = Vec::with_capacity(3 * mesh.cells.len());
    let mut numbers: HashMap<Vec<usize>, usize> = HashMap::with_capacity(3 * mesh.cells.len());
    for (c, cell) in mesh.cells.iter().enumerate() {
        for face in HEX_FACES {
            let around = corners(&face.map(|k| cell[k]));
            if around.len() < 3 {
                continue;
            }
            let key = sorted(&around);
            if key.windows(2).any(|pair| pair[0] == pair[1]) {
                return Err(refused("faces that touch themselves"));
            }
            match numbers.get(&key) {
                None => {
                    numbers.insert(key, faces.len());
                    faces.push(PolyFace { nodes: around, owner: c, neighbour: None });
                }
                Some(&number) => {
                    let known = &mut faces[number];
                    if known.owner == c || known.neighbour.is_some() {
                        return Err(refused("cells that overlap or are collapsed to a face"));
                    }
                    known.neighbour = Some(c);
                }
            }
        }
    }
    Ok((faces, numbers))
}

/// The order of a polyMesh: inner faces by owner and neighbour, then those of each boundary; and the first of each
/// boundary with their number.
fn ordered(
    mesh: &HexMesh,
    periodic: &[PeriodicPartner],
) -> Result<(Vec<PolyFace>, Vec<[usize; 2]>), WriteError> {
    let (faces, numbers) = poly_faces(mesh)?;
    let mut inner: Vec<&PolyFace> = faces.iter().filter(|face| face.neighbour.is_some()).collect();
    inner.sort_by_key(|face| (face.owner, face.neighbour));
    let mut all: Vec<PolyFace> = inner.into_iter().cloned().collect();
    let mut ranges: Vec<[usize; 2]> = Vec::new();
    for (k, patch) in mesh.patches.iter().enumerate() {
        let mut own = Vec::with_capacity(patch.faces.len());
        for face in &patch.faces {
            let number = numbers.get(&sorted(&corners(face)));
            let number = number.ok_or(refused("boundary faces of no cell"))?;
            own.push(faces[*number].clone());
        }
        own.sort_by_key(|face| face.owner);
        // The faces of a periodic boundary follow those of its partner.
        let with = periodic.iter().find(|with| with.name == patch.name);
        let earlier = with.and_then(|with| {
            let place = mesh.patches[..k].iter().position(|patch| patch.name == with.partner);
            place.map(|place| (place, inverse(with.how)))
        });
        if let Some((place, how)) = earlier {
            let [first, count] = ranges[place];
            own = matched(mesh, &all[first..first + count], &own, how)?;
        }
        ranges.push([all.len(), own.len()]);
        all.extend(own);
    }
    if all.len() != faces.len() {
        return Err(refused("faces of one cell that are in no boundary"));
    }
    Ok((all, ranges))
}

fn inverse(how: Periodicity) -> Periodicity {
    match how {
        Periodicity::Translation(d) => Periodicity::Translation(-d),
        Periodicity::Rotation(axis, angle) => Periodicity::Rotation(axis, -angle),
    }
}

/// Faces in the order of those of a periodic partner, each with its first node opposite the partner's first.
fn matched(
    mesh: &HexMesh,
    partner: &[PolyFace],
    own: &[PolyFace],
    how: Periodicity,
) -> Result<Vec<PolyFace>, WriteError> {
    let fault = || refused("periodic boundaries with different faces");
    let (mut low, mut high) = (mesh.points[0], mesh.points[0]);
    for p in &mesh.points {
        low = Vec3::of(low.x.min(p.x), low.y.min(p.y), low.z.min(p.z));
        high = Vec3::of(high.x.max(p.x), high.y.max(p.y), high.z.max(p.z));
    }
    let tolerance = SAME_PERIODIC * low.distance(high);
    let width = 64.0 * tolerance;
    let bucket = |p: Vec3| p.to_array().map(|x| (x / width).floor() as i64);
    let mut buckets: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let mut own_nodes: Vec<usize> = own.iter().flat_map(|face| face.nodes.clone()).collect();
    own_nodes.sort_unstable();
    own_nodes.dedup();
    for node in own_nodes {
        buckets.entry(bucket(mesh.points[node])).or_default().push(node);
    }
    let opposite = |node: usize| {
        let p = how.moved(mesh.points[node]);
        let corner = |k: usize| {
            let shift = |axis: usize| if k >> axis & 1 == 0 { -tolerance } else { tolerance };
            buckets.get(&bucket(p + Vec3::of(shift(0), shift(1), shift(2))))
        };
        let near = (0..8).filter_map(corner).flatten().copied();
        let distance = |n: usize| mesh.points[n].distance(p);
        near.filter(|&n| distance(n) <= tolerance)
            .min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
    };
    let by_nodes: HashMap<Vec<usize>, &PolyFace> =
        own.iter().map(|face| (sorted(&face.nodes), face)).collect();
    let each = partner.iter().map(|face| {
        let mut nodes = face
            .nodes
            .iter()
            .map(|&n| opposite(n))
            .collect::<Option<Vec<usize>>>()
            .ok_or_else(fault)?;
        let known = by_nodes.get(&sorted(&nodes)).ok_or_else(fault)?;
        // Seen from outside, the partner's nodes run the other way round.
        nodes[1..].reverse();
        Ok(PolyFace { nodes, owner: known.owner, neighbour: None })
    });
    let matched = each.collect::<Result<Vec<PolyFace>, WriteError>>()?;
    if matched.len() == own.len() { Ok(matched) } else { Err(fault()) }
}

/// The files points, faces, owner, neighbour and boundary of a polyMesh: inner faces in upper
/// triangular order, each from the owner to the neighbour, then those of each boundary; cells at
/// poles are written as polyhedra.
///
/// # Errors
/// Cells that touch themselves or overlap; periodic boundaries without a partner.
pub fn poly_mesh(
    mesh: &HexMesh,
    periodic: &[PeriodicPartner],
) -> Result<Vec<FoamFile>, WriteError> {
    let (faces, ranges) = ordered(mesh, periodic)?;
    let inner = faces.iter().filter(|face| face.neighbour.is_some()).count();
    let note = format!(
        "nPoints:{} nCells:{} nFaces:{} nInternalFaces:{inner}",
        mesh.points.len(),
        mesh.cells.len(),
        faces.len()
    );
    let list = |class: &str, object: &str, lines: &mut dyn Iterator<Item = String>| {
        let mut out = header(class, object);
        if object == "owner" || object == "neighbour" {
            out = out.replace("    object", &format!("    note \"{note}\";\n    object"));
        }
        let lines: Vec<String> = lines.collect();
        let _ = write!(out, "{}\n(\n", lines.len());
        for line in lines {
            out.push_str(&line);
            out.push('\n');
        }
        out.push_str(")\n");
        out.into_bytes()
    };
    let points =
        list("vectorField", "points", &mut mesh.points.iter().map(|p| format!("({})", spaced(*p))));
    let polygons =
        faces.iter().map(|face| format!("{}({})", face.nodes.len(), nodes(&face.nodes, 0)));
    let polygons = list("faceList", "faces", &mut polygons.into_iter());
    let owners = list("labelList", "owner", &mut faces.iter().map(|face| face.owner.to_string()));
    let neighbours = faces.iter().filter_map(|face| face.neighbour.map(|cell| cell.to_string()));
    let neighbours = list("labelList", "neighbour", &mut neighbours.into_iter());
    let mut boundary = header("polyBoundaryMesh", "boundary");
    let _ = write!(boundary, "{}\n(\n", mesh.patches.len());
    for (patch, [first, count]) in mesh.patches.iter().zip(&ranges) {
        let _ = write!(
            boundary,
            "{}\n{{\n{}    nFaces {count};\n    startFace {first};\n}}\n",
            patch.name,
            type_entries(mesh, patch, periodic)
        );
    }
    boundary.push_str(")\n");
    Ok(vec![
        ("points", points),
        ("faces", polygons),
        ("owner", owners),
        ("neighbour", neighbours),
        ("boundary", boundary.into_bytes()),
    ])
}
