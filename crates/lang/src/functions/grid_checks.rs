//! Checks of blocks before writing: folded and left-handed cells, boundaries that contradict their
//! type, coincident faces that are not joined.

use crate::functions::block_files::{
    AbuttingFaces, Connected, are_across, connected, extruded, one_type_each, volumes,
};
use crate::functions::grid_formats::GridFormat;
use crate::functions::hanging::HangingJoint;
use crate::functions::joint_report::part_text;
use crate::functions::named_blocks::NamedBlock;
use moldloft_diag::Diagnostic;
use moldloft_grid::{GridFace, SurfaceGrid, VolumeGrid, folded_cells};
use moldloft_io::StructuredGrid;
use moldloft_io::cgns::FacePart;
use moldloft_io::hexahedra::is_plane;
use moldloft_num::{Box3, Vec3, nearest_on_triangle};

/// Distance, relative to their size, within which unnamed faces coincide: facets of one curved
/// surface with different numbers of points differ by less.
const ABUTTING: f64 = 5e-3;

/// Number of points of a face, along each of its axes, that are compared with others.
const SAMPLES: usize = 5;

/// Warnings about blocks, and their connections if the format joins them.
///
/// # Errors
/// Faults that no file can represent.
pub(super) fn checked(
    blocks: &[NamedBlock],
    format: &GridFormat,
) -> Result<(Vec<Diagnostic>, Option<Connected>), Diagnostic> {
    let mut found = Vec::new();
    if !format.joins && !format.keeps_order {
        return Ok((found, None));
    }
    for block in blocks {
        let [_, _, nk] = block.grid.size;
        match nk {
            1 => surface(block, &mut found),
            _ => volume(block, format, &mut found),
        }
    }
    if !format.joins || blocks.iter().any(|block| block.grid.size[..2].iter().any(|n| *n < 2)) {
        return Ok((found, None));
    }
    one_type_each(blocks)?;
    let flat = blocks.iter().all(|block| block.grid.size[2] == 1);
    if !flat && blocks.iter().any(|block| block.grid.size[2] == 1) {
        return Ok((found, None));
    }
    let layers = match flat {
        // CGNS has surfaces in space.
        true if !format.plane => return Ok((found, None)),
        true => extruded(blocks, "sides")?.0,
        false => blocks.to_vec(),
    };
    symmetry(&layers, &mut found);
    let mut connected = connected(&layers)?;
    overlaps(&layers, &connected)?;
    if let (false, Some(joint)) = (format.hangs, connected.hanging.first()) {
        return Err(hung(&layers, flat, joint));
    }
    // CGNS has boundaries there, which is said.
    let said: Vec<FacePart> = match format.keeps_order && !format.plane {
        true => connected.nameless.clone(),
        false => {
            connected.nameless.iter().filter(|part| !connected.is_hanging(part)).copied().collect()
        }
    };
    connected.abutting = nameless(&layers, flat, &said, &mut found);
    Ok((found, Some(connected)))
}

/// Folded cells of a plane grid; a curved one may be turned by its own shape.
fn surface(block: &NamedBlock, found: &mut Vec<Diagnostic>) {
    let [m, n, _] = block.grid.size;
    if m < 2 || n < 2 {
        return;
    }
    let points: Vec<Vec3> = block.grid.points().collect();
    let quad = |i: usize, j: usize| {
        let at = |i: usize, j: usize| i + m * j;
        [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
    };
    let faces: Vec<[usize; 4]> =
        (0..m - 1).flat_map(|i| (0..n - 1).map(move |j| quad(i, j))).collect();
    if !is_plane(&points, &faces) {
        return;
    }
    let grid = SurfaceGrid::from_fn(m, n, |i, j| block.grid.at([i, j, 0]));
    let folded = folded_cells(&grid);
    if let Some([i, j]) = folded.first() {
        let place = format!("[{},{}]", i + 1, j + 1);
        found.push(folded_cells_of(block, folded.len(), faces.len(), &place));
    }
}

fn folded_cells_of(block: &NamedBlock, count: usize, of: usize, first: &str) -> Diagnostic {
    let message = format!("{count} of {of} cells of `{}` are folded", block.name);
    Diagnostic::warning("folded-grid", message)
        .expected("cells that are not turned over")
        .found(format!("folded cells, the first {first}"))
        .help("smooth it: elliptic(s), elliptic_block(b)")
}

fn volume(block: &NamedBlock, format: &GridFormat, found: &mut Vec<Diagnostic>) {
    let size @ [ni, nj, nk] = block.grid.size;
    if size.iter().any(|n| *n < 2) {
        return;
    }
    let grid = &volumes(std::slice::from_ref(block))[0];
    let left_handed = grid.volume() < 0.0;
    let (count, first) = match left_handed {
        false => turned(grid),
        true => turned(&VolumeGrid::from_fn(size, |i, j, k| grid.at(ni - 1 - i, j, k))),
    };
    if let Some(cell) = first {
        let (cj, ck) = (nj - 1, nk - 1);
        let i = if left_handed { ni - 2 - cell / (cj * ck) } else { cell / (cj * ck) };
        let place = format!("[{},{},{}]", i + 1, cell / ck % cj + 1, cell % ck + 1);
        found.push(folded_cells_of(block, count, (ni - 1) * cj * ck, &place));
    }
    if left_handed && format.keeps_order {
        let message = format!("`{}` is left-handed: its cells have negative volume", block.name);
        found.push(
            Diagnostic::warning("left-handed", message)
                .expected("indices i, j, k that are right-handed")
                .help("reverse one of them: b[::-1, , ]"),
        );
    }
}

/// Refuses blocks on the same side of a common face: they overlap.
fn overlaps(blocks: &[NamedBlock], connected: &Connected) -> Result<(), Diagnostic> {
    let volumes: Vec<f64> = volumes(blocks).iter().map(VolumeGrid::volume).collect();
    for joint in &connected.joints {
        if !are_across(joint, &volumes) {
            let [a, b] = [joint.0, joint.1].map(|side| {
                format!("{} of `{}`", GridFace::ALL[side.1].word(), blocks[side.0].name)
            });
            return Err(Diagnostic::error(
                "cannot-write",
                format!("{a} and {b} are one face of cells on the same side"),
            )
            .expected("blocks that do not overlap")
            .help("write each block once"));
        }
    }
    Ok(())
}

/// The fault of a hanging interface in a format of whole faces.
fn hung(blocks: &[NamedBlock], flat: bool, joint: &HangingJoint) -> Diagnostic {
    let [a, b] = joint.sides.map(|part| part_text(blocks, flat, &part));
    let [own, theirs] = joint.cells.map(|[m, n]| format!("{m} x {n}"));
    let message = format!("{a} and {b} are one face, of {own} and {theirs} cells");
    Diagnostic::error("cannot-write", message)
        .expected("the same cells on both sides: the format joins whole faces of cells")
        .help(
            "give both blocks the same counts there, or name both faces, as boundaries that the solver joins",
        )
}

/// The number of cells that are turned over at a corner, and the first of them.
fn turned(grid: &VolumeGrid<f64>) -> (usize, Option<usize>) {
    let quality = grid.cell_quality();
    let bad = |(_, [jacobian, _]): &(usize, &[f64; 2])| *jacobian <= 0.0 || jacobian.is_nan();
    let count = quality.iter().enumerate().filter(bad).count();
    (count, quality.iter().enumerate().find(bad).map(|(k, _)| k))
}

/// The points of a part of a face, and its quadrilaterals.
fn part_of(grid: &StructuredGrid, face: usize, from: [usize; 3], to: [usize; 3]) -> FaceMesh {
    let axis = GridFace::ALL[face].axis;
    let [a, b] = [[1, 2], [0, 2], [0, 1]][axis];
    let ends = |k: usize| (from[k].min(to[k]), from[k].max(to[k]));
    let ((a0, a1), (b0, b1)) = (ends(a), ends(b));
    let mut points = Vec::new();
    for i in a0..=a1 {
        for j in b0..=b1 {
            let mut at = from;
            (at[a], at[b]) = (i, j);
            points.push(grid.at(at));
        }
    }
    let [m, n] = [a1 - a0 + 1, b1 - b0 + 1];
    let quads = (0..m.saturating_sub(1)).flat_map(|i| {
        (0..n.saturating_sub(1)).map(move |j| {
            let at = |i: usize, j: usize| i * n + j;
            [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
        })
    });
    let quads = quads.collect();
    FaceMesh { points, size: [m, n], quads }
}

struct FaceMesh {
    points: Vec<Vec3>,
    size: [usize; 2],
    quads: Vec<[usize; 4]>,
}

/// Faces of type symmetry that are not plane.
fn symmetry(blocks: &[NamedBlock], found: &mut Vec<Diagnostic>) {
    for block in blocks {
        for (face, name) in block.faces.iter().enumerate() {
            let Some((name, _)) = name.as_ref().filter(|(_, kind)| kind == "symmetry") else {
                continue;
            };
            let side = GridFace::ALL[face];
            let last = block.grid.size.map(|n| n - 1);
            let (mut from, mut to) = ([0; 3], last);
            let at = if side.last { last[side.axis] } else { 0 };
            (from[side.axis], to[side.axis]) = (at, at);
            let part = part_of(&block.grid, face, from, to);
            if !is_plane(&part.points, &part.quads) {
                let message = format!(
                    "the symmetry boundary `{name}`, {} of `{}`, is not plane",
                    side.word(),
                    block.name
                );
                found.push(
                    Diagnostic::warning("not-plane", message)
                        .expected("points in one plane, to 1e-6 of their extent")
                        .help("most solvers mirror in a plane; call a curved boundary a wall or a patch"),
                );
            }
        }
    }
}

/// Faces without a name: coincident ones, which are returned, and the existence of others.
fn nameless(
    blocks: &[NamedBlock],
    flat: bool,
    parts: &[FacePart],
    found: &mut Vec<Diagnostic>,
) -> Vec<AbuttingFaces> {
    let word = |part: &FacePart| match (flat, GridFace::ALL[part.1].word()) {
        (true, "in") => "im",
        (_, word) => word,
    };
    let called = |part: &FacePart| format!("{} of `{}`", word(part), blocks[part.0].name);
    let mut abutting = Vec::new();
    if parts.is_empty() {
        return abutting;
    }
    // The faces of each block, once, in their order.
    let mut seen: Vec<(usize, Vec<&str>)> = Vec::new();
    for part in parts {
        if seen.last().is_none_or(|(block, _)| *block != part.0) {
            seen.push((part.0, Vec::new()));
        }
        let faces = &mut seen.last_mut().expect("just seen").1;
        if !faces.contains(&word(part)) {
            faces.push(word(part));
        }
    }
    let meshes: Vec<FaceMesh> = parts
        .iter()
        .map(|(block, face, from, to)| part_of(&blocks[*block].grid, *face, *from, *to))
        .collect();
    for (a, mesh) in meshes.iter().enumerate() {
        for (b, other) in meshes.iter().enumerate() {
            if a == b || parts[a].0 == parts[b].0 || (a > b && lies_on(other, mesh).is_some()) {
                continue;
            }
            if let Some(gap) = lies_on(mesh, other) {
                let ([m, n], [p, q]) = (mesh.size, other.size);
                let sizes = [[m, n], [p, q]];
                abutting.push(AbuttingFaces { parts: [parts[a], parts[b]], sizes, gap });
                let (this, that) = (called(&parts[a]), called(&parts[b]));
                let message = format!("{this} lies on {that}, but they are not joined");
                found.push(
                    Diagnostic::warning("not-joined", message)
                        .expected("the same points on both, to 1e-10 of the size")
                        .found(format!("{m} x {n} and {p} x {q} points, up to {gap:.3e} apart"))
                        .help(
                            "give both the same counts, and take the points of one from the other",
                        ),
                );
            }
        }
    }
    if abutting.is_empty() {
        let all: Vec<String> = seen
            .iter()
            .map(|(block, faces)| format!("{} of `{}`", faces.join(", "), blocks[*block].name))
            .collect();
        let message = format!("boundaries without a name: {}", all.join("; "));
        found.push(
            Diagnostic::remark("nameless", message)
                .help("name them behind the block: \"i1 = inlet inflow, k1 = body wall\""),
        );
    }
    abutting
}

/// Distance of a face from another that contains it; `None` if none does.
fn lies_on(face: &FaceMesh, other: &FaceMesh) -> Option<f64> {
    let bounds = Box3::around(face.points.iter().copied());
    let size = (bounds.high - bounds.low).norm();
    let tolerance = ABUTTING * size;
    let theirs = Box3::around(other.points.iter().copied());
    let [m, n] = face.size;
    let step = |k: usize, n: usize| k * (n - 1) / (SAMPLES - 1);
    let mut greatest = 0.0f64;
    for i in 0..SAMPLES {
        for j in 0..SAMPLES {
            let p = face.points[step(i, m) * n + step(j, n)];
            let outside = |low: f64, x: f64, high: f64| x < low - tolerance || x > high + tolerance;
            let (q, low, high) = (p.to_array(), theirs.low.to_array(), theirs.high.to_array());
            if (0..3).any(|k| outside(low[k], q[k], high[k])) {
                return None;
            }
            let distance = distance_to(p, other);
            if distance > tolerance || distance.is_nan() {
                return None;
            }
            greatest = greatest.max(distance);
        }
    }
    Some(greatest)
}

fn distance_to(p: Vec3, face: &FaceMesh) -> f64 {
    let mut least = f64::INFINITY;
    for quad in &face.quads {
        let [a, b, c, d] = quad.map(|n| face.points[n]);
        for triangle in [[a, b, c], [a, c, d]] {
            least = least.min(p.distance(nearest_on_triangle(p, triangle)));
        }
    }
    least
}
