//! Blocks as one mesh with named boundaries: joints and periodic boundaries.

use crate::functions::hanging::{HangingJoint, hanging};
use crate::functions::named_blocks::{NamedBlock, face_points};
use moldloft_diag::Diagnostic;
use moldloft_grid::{FaceNames, GridFace, HexMesh, VolumeGrid, shared_nodes};
use moldloft_io::cgns::{BlockJoint, FacePart};
use moldloft_io::hexahedra::{PeriodicPartner, Periodicity};
use moldloft_io::{StructuredGrid, WriteError};
use moldloft_mesh::{Blocks, HexBlock};
use moldloft_num::{Real, Vec3};
use std::collections::HashMap;

pub(crate) const BOUNDARY_KINDS: [&str; 9] =
    ["wall", "symmetry", "farfield", "inflow", "outflow", "periodic", "empty", "wedge", "patch"];

/// A face that lies on another one, with points that are not the same.
pub(crate) struct AbuttingFaces {
    pub parts: [FacePart; 2],
    /// Points along the axes of both.
    pub sizes: [[usize; 2]; 2],
    /// The greatest distance of the points of the first from the second.
    pub gap: f64,
}

pub(crate) struct Connected {
    pub joints: Vec<BlockJoint>,
    /// Boundaries: position, name and type.
    pub boundaries: Vec<(FacePart, String, String)>,
    pub partners: Vec<PeriodicPartner>,
    /// Parts of faces without a neighbour or a name.
    pub nameless: Vec<FacePart>,
    /// Parts that are one face with others, of finer or coarser cells.
    pub hanging: Vec<HangingJoint>,
    /// Parts that lie on others but are not joined.
    pub abutting: Vec<AbuttingFaces>,
}

impl Connected {
    /// True of a part all of which is in hanging interfaces.
    pub fn is_hanging(&self, part: &FacePart) -> bool {
        let covered = self.hanging.iter().map(|joint| match joint.parts.map(|own| own == *part) {
            [true, _] => joint.cells[0].iter().product(),
            [_, true] => joint.cells[1].iter().product(),
            _ => 0,
        });
        let cells = (0..3).map(|k| part.2[k].abs_diff(part.3[k]).max(1)).product::<usize>();
        covered.sum::<usize>() == cells
    }
}

/// The names of faces: "k1 = hull wall, i1 in = plane symmetry"; a surface has no faces k.
pub(crate) fn face_names(words: &str, flat: bool) -> Result<FaceNames, Diagnostic> {
    let mut faces = FaceNames::default();
    for entry in words.split([',', ';']).filter(|entry| !entry.trim().is_empty()) {
        let wrong = |message: String| {
            Diagnostic::error("unknown-word", message)
                .expected("faces = name type, such as \"k1 = hull wall, i1 in = plane symmetry\"")
                .found(format!("\"{}\"", entry.trim()))
        };
        let Some((of, meaning)) = entry.split_once('=') else {
            return Err(wrong("the name of a face follows `=`".into()));
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
        if !BOUNDARY_KINDS.contains(&kind) || meaning.next().is_some() {
            return Err(wrong(format!("there is no boundary \"{kind}\""))
                .expected(BOUNDARY_KINDS.join(", "))
                .suggest(kind, BOUNDARY_KINDS));
        }
        for word in of.split_whitespace() {
            // A surface [m,n] ends at im, a block [ni,nj,nk] at in.
            let spelled = |face: &GridFace| match (flat, face.word()) {
                (true, "in") => word == "im",
                (true, "k1" | "kn") => false,
                (_, own) => own == word,
            };
            let Some(face) = GridFace::ALL.iter().position(spelled) else {
                let expected = match flat {
                    true => "\"i1\", \"im\", \"j1\" or \"jn\" of a surface",
                    false => "\"i1\", \"in\", \"j1\", \"jn\", \"k1\" or \"kn\" of a block",
                };
                return Err(wrong(format!("there is no face \"{word}\"")).expected(expected));
            };
            faces[face] = Some((name.to_string(), kind.to_string()));
        }
    }
    Ok(faces)
}

pub(crate) fn volumes(blocks: &[NamedBlock]) -> Vec<VolumeGrid<f64>> {
    blocks
        .iter()
        .map(|block| VolumeGrid::from_fn(block.grid.size, |i, j, k| block.grid.at([i, j, k])))
        .collect()
}

/// The blocks as one mesh; points within 1e-10 of the size are merged.
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

/// The plane of plane grids: the two coordinates in it, and its normal, about which they are right-handed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlaneAxes {
    pub axes: [usize; 2],
    pub normal: Vec3,
}

/// Difference of coordinates, relative to the size, below which they are constant.
const FLAT: f64 = 1e-9;

/// Surfaces in a plane of constant z, y or x as blocks of one layer of cells, whose sides are called `sides`.
///
/// # Errors
/// Other surfaces.
pub(crate) fn extruded(
    blocks: &[NamedBlock],
    sides: &str,
) -> Result<(Vec<NamedBlock>, PlaneAxes), Diagnostic> {
    let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for block in blocks {
        for (bound, plane) in bounds.iter_mut().zip(&block.grid.planes) {
            for x in plane {
                *bound = [bound[0].min(*x), bound[1].max(*x)];
            }
        }
    }
    let extents = bounds.map(|[low, high]| high - low);
    let size = extents.into_iter().fold(0.0, f64::max);
    let Some(axis) = [2, 1, 0].into_iter().find(|axis| extents[*axis] <= FLAT * size) else {
        let names: Vec<&str> = blocks.iter().map(|block| block.name.as_str()).collect();
        let message = format!("`{}` is neither plane nor a block of cells", names.join(", "));
        return Err(Diagnostic::error("cannot-write", message)
            .expected("surfaces in one plane of constant x, y or z, or blocks")
            .found(format!("extents {} x {} x {}", extents[0], extents[1], extents[2])));
    };
    // About y it is z that turns to x.
    let (axes, sign) = [([1, 2], 1.0), ([0, 2], -1.0), ([0, 1], 1.0)][axis];
    let mut normal = [0.0; 3];
    normal[axis] = sign;
    let cells: usize =
        blocks.iter().map(|block| (block.grid.size[0] - 1) * (block.grid.size[1] - 1)).sum();
    let thickness = size / (cells as f64).sqrt().max(1.0);
    let layers = blocks.iter().map(|block| {
        let [m, n, _] = block.grid.size;
        let mut planes = block.grid.planes.clone();
        for (k, plane) in planes.iter_mut().enumerate() {
            let above = if k == axis { sign * thickness } else { 0.0 };
            let upper: Vec<f64> = plane.iter().map(|x| x + above).collect();
            plane.extend(upper);
        }
        let grid = StructuredGrid { size: [m, n, 2], planes, iblank: None };
        let mut faces = block.faces.clone();
        let side = || Some((sides.to_string(), "empty".to_string()));
        (faces[4], faces[5]) = (side(), side());
        NamedBlock { grid, name: block.name.clone(), faces }
    });
    Ok((layers.collect(), PlaneAxes { axes, normal: normal.into() }))
}

/// The blocks with common vertices where points of faces coincide.
pub(crate) fn merged(blocks: &[NamedBlock]) -> Result<Blocks, Diagnostic> {
    let (positions, numbers) = shared_nodes(&volumes(blocks));
    joined(blocks, positions, numbers)
}

fn joined(
    blocks: &[NamedBlock],
    positions: Vec<Vec3>,
    numbers: Vec<Vec<usize>>,
) -> Result<Blocks, Diagnostic> {
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
    Blocks::new(positions, hexahedra)
        .map_err(|error| Diagnostic::error("cannot-write", error.to_string()))
}

/// Joints and boundaries of the blocks, by coincident points, and the periodic ones.
pub(crate) fn connected(blocks: &[NamedBlock]) -> Result<Connected, Diagnostic> {
    let (positions, numbers) = shared_nodes(&volumes(blocks));
    if let Some([a, b]) = thrice(blocks, &numbers) {
        let [a, b] = [a, b].map(|block| &blocks[block].name);
        let message = format!("a face of `{a}` and `{b}` belongs to more than two cells");
        return Err(Diagnostic::error("cannot-write", message)
            .expected("blocks that do not overlap")
            .help("write each block once"));
    }
    let all = joined(blocks, positions, numbers)?;
    let (joints, free) = all.interfaces();
    let joints = joints.iter().map(|joint| {
        let side = |k: usize| (joint.sides[k].0, joint.sides[k].1, joint.from[k], joint.to[k]);
        (side(0), side(1), joint.transform(), None)
    });
    let mut joints: Vec<BlockJoint> = joints.collect();
    let (mut boundaries, mut nameless, mut periodic) = (Vec::new(), Vec::new(), Vec::new());
    for part in &free {
        let place: FacePart = (part.block, part.face, part.from, part.to);
        let block = &blocks[part.block];
        match &block.faces[part.face] {
            Some((name, kind)) if kind == "periodic" => periodic.push((place, name.clone())),
            Some((name, kind)) => boundaries.push((place, name.clone(), kind.clone())),
            None => {
                nameless.push(place);
                let name = format!("{}-{}", block.name, GridFace::ALL[part.face].word());
                boundaries.push((place, name, "patch".to_string()));
            }
        }
    }
    let (of_pairs, partners) = paired(blocks, periodic)?;
    joints.extend(of_pairs);
    let size = volumes(blocks).iter().map(VolumeGrid::extent).fold(0.0, f64::max);
    let hanging = hanging(blocks, &nameless, SAME * size);
    Ok(Connected { joints, boundaries, partners, nameless, hanging, abutting: Vec::new() })
}

/// Refuses a boundary of two types.
pub(super) fn one_type_each(blocks: &[NamedBlock]) -> Result<(), Diagnostic> {
    let mut known: HashMap<&str, &str> = HashMap::new();
    for (name, kind) in blocks.iter().flat_map(|block| block.faces.iter().flatten()) {
        let first = *known.entry(name).or_insert(kind);
        if first != kind {
            let message = format!("the boundary `{name}` has two types");
            return Err(Diagnostic::error("cannot-write", message)
                .expected("one type for all faces of a name")
                .found(format!("{first} and {kind}"))
                .help("without a type a face is a patch: state it behind each name"));
        }
    }
    Ok(())
}

/// The first and the third block with a face in common, by the nodes of their points.
fn thrice(blocks: &[NamedBlock], numbers: &[Vec<usize>]) -> Option<[usize; 2]> {
    let mut known: HashMap<[usize; 4], Vec<usize>> = HashMap::new();
    for (number, block) in blocks.iter().enumerate() {
        let size @ [_, nj, nk] = block.grid.size;
        for side in GridFace::ALL {
            let [a, b] = side.others();
            let node = |p: usize, q: usize| {
                let mut at = [0; 3];
                at[side.axis] = if side.last { size[side.axis] - 1 } else { 0 };
                (at[a], at[b]) = (p, q);
                numbers[number][(at[0] * nj + at[1]) * nk + at[2]]
            };
            for p in 1..size[a] {
                for q in 1..size[b] {
                    let mut key = [node(p, q), node(p - 1, q), node(p, q - 1), node(p - 1, q - 1)];
                    key.sort_unstable();
                    // Faces of poles have no area.
                    if key.windows(2).filter(|pair| pair[0] == pair[1]).count() > 1 {
                        continue;
                    }
                    let of = known.entry(key).or_default();
                    of.push(number);
                    if let [first, _, third] = of[..] {
                        return Some([first, third]);
                    }
                }
            }
        }
    }
    None
}

/// Tolerance of the points of two faces that are one, relative to the size.
const SAME: f64 = 1e-10;

/// Tolerance of the points of two periodic faces, relative to the size.
const SAME_PERIODIC: f64 = 1e-8;

fn mean(points: &[Vec3]) -> Vec3 {
    points.iter().fold(Vec3::zero(), |sum, p| sum + *p) / points.len() as f64
}

/// The movements that may lead from one face to another: by their means.
fn candidates(a: &[Vec3], b: &[Vec3]) -> Vec<Periodicity> {
    let (from, to) = (mean(a), mean(b));
    let mut all = vec![Periodicity::Translation(to - from)];
    for axis in 0..3 {
        let [u, v] = [[1, 2], [2, 0], [0, 1]][axis];
        let angle = |p: Vec3| Real::atan2(p.to_array()[v], p.to_array()[u]);
        let radius = |p: Vec3| p.to_array()[u].abs().max(p.to_array()[v].abs());
        if radius(from) > 0.0 && radius(to) > 0.0 {
            let mut turn = angle(to) - angle(from);
            let whole = 2.0 * std::f64::consts::PI;
            if turn > std::f64::consts::PI {
                turn -= whole;
            } else if turn <= -std::f64::consts::PI {
                turn += whole;
            }
            all.push(Periodicity::Rotation(axis, turn));
        }
    }
    all
}

/// Relation of a face's indices to those of another with the same points, moved: exchanged, and
/// reversed.
fn laid(
    a: &(Vec<Vec3>, [usize; 2], [usize; 2]),
    b: &(Vec<Vec3>, [usize; 2], [usize; 2]),
    how: &Periodicity,
    tolerance: f64,
) -> Option<(bool, [bool; 2])> {
    let [m, n] = a.2;
    for swapped in [false, true] {
        let [p, q] = if swapped { [n, m] } else { [m, n] };
        if b.2 != [p, q] {
            continue;
        }
        for against in [[false, false], [true, false], [false, true], [true, true]] {
            let other = |i: usize, j: usize| {
                let i = if against[0] { m - 1 - i } else { i };
                let j = if against[1] { n - 1 - j } else { j };
                if swapped { b.0[j * q + i] } else { b.0[i * q + j] }
            };
            let near = |k: usize| how.moved(a.0[k]).distance(other(k / n, k % n)) <= tolerance;
            if (0..m * n).all(near) {
                return Some((swapped, against));
            }
        }
    }
    None
}

/// The periodic faces of one name.
struct PeriodicBoundary {
    name: String,
    parts: Vec<FacePart>,
    /// The points of each, its two axes, and the numbers of points along them.
    points: Vec<(Vec<Vec3>, [usize; 2], [usize; 2])>,
}

/// A movement that maps all faces of one boundary to those of another, and their joints.
struct PeriodicMap {
    /// The two boundaries.
    sides: [usize; 2],
    how: Periodicity,
    joints: Vec<BlockJoint>,
}

/// True if the cells of two blocks are on opposite sides of the face at which they are joined, by
/// the volumes of all blocks, negative of left-handed ones.
pub(super) fn are_across((own, other, transform, _): &BlockJoint, volumes: &[f64]) -> bool {
    let order = transform.map(|axis| axis.unsigned_abs() as usize - 1);
    let odd = [[0, 2, 1], [1, 0, 2], [2, 1, 0]].contains(&order);
    let against = transform.iter().filter(|axis| **axis < 0).count();
    let turned = odd != (against % 2 == 1);
    turned == (volumes[own.0] * volumes[other.0] < 0.0)
}

/// The movements that map each face of one boundary to one of another, with the cells behind it on
/// the other side.
fn maps_between(
    (own, theirs): (&PeriodicBoundary, &PeriodicBoundary),
    volumes: &[f64],
    tolerance: f64,
) -> Vec<(Periodicity, Vec<BlockJoint>)> {
    if own.parts.len() != theirs.parts.len() {
        return Vec::new();
    }
    let joined = |how: Periodicity| {
        let mut free: Vec<usize> = (0..theirs.parts.len()).collect();
        let mut joints = Vec::with_capacity(own.parts.len());
        for (part, face) in own.parts.iter().zip(&own.points) {
            let found = free.iter().enumerate().find_map(|(place, &b)| {
                let other = &theirs.points[b];
                let laid = laid(face, other, &how, tolerance)?;
                Some((place, periodic_joint(*part, theirs.parts[b], (face.1, other.1), laid, how)))
            });
            let (place, joint) = found.filter(|(_, joint)| are_across(joint, volumes))?;
            free.remove(place);
            joints.push(joint);
        }
        Some((how, joints))
    };
    let first = &own.points[0].0;
    let each = theirs.points.iter().flat_map(|other| candidates(first, &other.0));
    each.filter_map(joined).collect()
}

/// The periodic boundaries, by their names.
fn periodic_boundaries(
    blocks: &[NamedBlock],
    periodic: Vec<(FacePart, String)>,
) -> Vec<PeriodicBoundary> {
    let mut all: Vec<PeriodicBoundary> = Vec::new();
    for (part, name) in periodic {
        let points = face_points(blocks, &part);
        match all.iter_mut().find(|own| own.name == name) {
            Some(own) => {
                own.parts.push(part);
                own.points.push(points);
            }
            None => {
                all.push(PeriodicBoundary { name, parts: vec![part], points: vec![points] });
            }
        }
    }
    all
}

/// The joints of periodic faces, and the partners of their names. Names with one possible partner
/// are paired before others, so that the pairs are the only ones in which each name has a partner.
///
/// # Errors
/// A name without a partner; names that can be paired in several ways.
fn paired(
    blocks: &[NamedBlock],
    periodic: Vec<(FacePart, String)>,
) -> Result<(Vec<BlockJoint>, Vec<PeriodicPartner>), Diagnostic> {
    let grids = volumes(blocks);
    let tolerance = SAME_PERIODIC * grids.iter().map(VolumeGrid::extent).fold(0.0, f64::max);
    let volumes: Vec<f64> = grids.iter().map(VolumeGrid::volume).collect();
    let boundaries = periodic_boundaries(blocks, periodic);
    let mut maps: Vec<PeriodicMap> = Vec::new();
    for (a, own) in boundaries.iter().enumerate() {
        for (b, theirs) in boundaries.iter().enumerate().skip(a + 1) {
            let between = maps_between((own, theirs), &volumes, tolerance);
            maps.extend(between.into_iter().map(|(how, joints)| PeriodicMap {
                sides: [a, b],
                how,
                joints,
            }));
        }
    }
    let (mut joints, mut partners) = (Vec::new(), Vec::new());
    let mut free: Vec<usize> = (0..boundaries.len()).collect();
    while !free.is_empty() {
        let of = |own: usize| maps.iter().filter(move |map| map.sides.contains(&own));
        if let Some(&alone) = free.iter().find(|&&own| of(own).count() == 0) {
            return Err(without_partner(&boundaries[alone].name));
        }
        let Some(&sure) = free.iter().find(|&&own| of(own).count() == 1) else {
            let own = free[0];
            let others = of(own).flat_map(|map| map.sides).filter(|side| *side != own);
            let others = others.map(|side| format!("`{}`", boundaries[side].name));
            return Err(with_several(&boundaries[own].name, others.collect()));
        };
        let place = maps.iter().position(|map| map.sides.contains(&sure)).expect("one map");
        let PeriodicMap { sides, how, joints: own } = maps.swap_remove(place);
        let [name, other] = sides.map(|side| boundaries[side].name.clone());
        let inverse = match how {
            Periodicity::Translation(d) => Periodicity::Translation(-d),
            Periodicity::Rotation(axis, angle) => Periodicity::Rotation(axis, -angle),
        };
        partners.push(PeriodicPartner { name: name.clone(), partner: other.clone(), how });
        partners.push(PeriodicPartner { name: other, partner: name, how: inverse });
        joints.extend(own);
        maps.retain(|map| !map.sides.iter().any(|side| sides.contains(side)));
        free.retain(|side| !sides.contains(side));
    }
    Ok((joints, partners))
}

fn without_partner(name: &str) -> Diagnostic {
    Diagnostic::error("cannot-write", format!("the periodic boundary `{name}` has no partner"))
        .expected(
            "another periodic boundary with the same points, all moved or turned about an axis \
             alike, and its cells on the other side",
        )
        .help("name both: \"k1 = low periodic, kn = high periodic\"")
}

fn with_several(name: &str, others: Vec<String>) -> Diagnostic {
    let message = format!("the partner of the periodic boundary `{name}` is ambiguous");
    Diagnostic::error("cannot-write", message)
        .expected("one periodic boundary with the same points, moved or turned about an axis")
        .found(others.join(", "))
        .help("give one name to all faces of a side: \"i1 = low periodic\" behind each block")
}

/// The joint of CGNS that a pair of periodic faces is.
fn periodic_joint(
    part: FacePart,
    other: FacePart,
    ([a, b], [p, q]): ([usize; 2], [usize; 2]),
    (swapped, against): (bool, [bool; 2]),
    how: Periodicity,
) -> BlockJoint {
    let [face, their] = [part.1, other.1].map(|face| GridFace::ALL[face]);
    // Out of one block and into the other: against each other when both are first faces, or both last.
    let mut transform = [0i32; 3];
    let signed = |axis: usize, against: bool| {
        let number = axis as i32 + 1;
        if against { -number } else { number }
    };
    transform[face.axis] = signed(their.axis, face.last == their.last);
    let [to_a, to_b] = if swapped { [q, p] } else { [p, q] };
    transform[a] = signed(to_a, against[0]);
    transform[b] = signed(to_b, against[1]);
    let (mut from, mut to) = (other.2, other.3);
    for (axis, against) in [(to_a, against[0]), (to_b, against[1])] {
        let (low, high) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
        (from[axis], to[axis]) = if against { (high, low) } else { (low, high) };
    }
    let sorted = |part: FacePart| {
        let low: [usize; 3] = std::array::from_fn(|k| part.2[k].min(part.3[k]));
        let high: [usize; 3] = std::array::from_fn(|k| part.2[k].max(part.3[k]));
        (part.0, part.1, low, high)
    };
    let movement = match how {
        Periodicity::Translation(d) => ([0.0; 3], [0.0; 3], d.to_array()),
        Periodicity::Rotation(axis, angle) => {
            let mut angles = [0.0; 3];
            angles[axis] = angle;
            ([0.0; 3], angles, [0.0; 3])
        }
    };
    (sorted(part), (other.0, other.1, from, to), transform, Some(movement))
}
