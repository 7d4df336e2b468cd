//! The outer skin of bodies that overlap.
//!
//! Bodies are united one by one. Edges of one skin pierce triangles of the other; each such point is one vertex of both
//! skins, known by its edge and triangle, so that the united skin is closed by construction. Triangles are divided along
//! the crossing line, and parts inside the other body, about which it winds once, are left out.
//!
//! Each body first grows, so that bodies in contact are one, and is moved by a vector of its own, both by far less than any
//! accuracy: no edge then meets an edge or a vertex, as in the simulation of simplicity (Edelsbrunner and Muecke 1990). Signs
//! of volumes are exact (Shewchuk 1997). Crossing points return to the planes of their faces as given, to rounding; where they
//! cannot, other vectors are tried.

use crate::Mesh;
use crate::inside::{pierced, solid_angle};
use crate::planar::planar_triangles_along;
use moldloft_num::union_find::UnionFind;
use moldloft_num::{Box3, BoxTree, Vec3};
use robust::{Coord3D, orient3d};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::f64::consts::PI;
use std::fmt;

/// Lengths of the vectors by which bodies are moved, relative to the diagonal of the mesh: the first for edges that pass each
/// other nearby, the second for faces in one plane, tried in turns.
const SHIFTS: [f64; 2] = [1e-10, 1e-8];

/// Distance by which bodies grow, relative to that by which they are moved: bodies in contact overlap.
const GROWTH: f64 = 20.0;

/// Sets of vectors tried.
const MAX_ATTEMPTS: usize = 16;

/// Distance of a crossing point from that of bodies in their places, relative to the diagonal of the mesh, up to which the
/// latter is taken.
const NEAR: f64 = 1e-5;

/// Height of triangles that may be within the distance by which bodies are moved, relative to that: the winding number about
/// them says nothing.
const THIN: f64 = 1e3;

/// Distance within which no two faces of the united skin may face each other, relative to that by which bodies are moved.
const CLOSE: f64 = 500.0;

/// Distance of a vertex from the planes of its faces, relative to the diagonal of the mesh, up to which it is on them; of faces
/// from their planes on average, up to which they have their volume.
const ON_PLANE: f64 = 1e-14;

/// Sine of the angle between two planes up to which they are one.
const FLAT: f64 = 1e-6;

/// Edges at crossing points that are shorter than this, relative to the distance by which bodies are moved, are one vertex:
/// less than the growth before other bodies are added, more in the end.
const SHORT_EDGE: [f64; 2] = [10.0, 100.0];

/// The united skin.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitedSkin {
    /// Its vertices.
    pub positions: Vec<Vec3>,
    /// Corners of its faces, counter-clockwise from outside; a triangle repeats its last.
    pub faces: Vec<[u32; 4]>,
}

/// Reason why bodies have no union.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotUnited {
    /// A skin is open at an edge with this end.
    Open(Vec3),
    /// A skin faces inward, in no other body, or runs through itself.
    Inward(Vec3),
    /// Skins nearly touch here.
    Touching(Vec3),
}

impl fmt::Display for NotUnited {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, at, help) = match self {
            Self::Open(at) => ("the skin is open", at, "close each body, or hide inner plates"),
            Self::Inward(at) => {
                ("the skin faces inward", at, "`orientation` of its surfaces turns them round")
            }
            Self::Touching(at) => ("bodies nearly touch", at, "move one of them a little"),
        };
        write!(
            f,
            "the bodies have no union: {what} at ({}, {}, {})\nhelp: {help}",
            at.x, at.y, at.z
        )
    }
}

/// A triangle, the corners of the triangle of the mesh that it is a part of, and the face of the latter.
#[derive(Clone, Copy)]
struct FaceTriangle {
    corners: [u32; 3],
    whole: [u32; 3],
    face: usize,
}

type Edge = (u32, u32);

fn edge(a: u32, b: u32) -> Edge {
    (a.min(b), a.max(b))
}

fn edges([a, b, c]: [u32; 3]) -> [Edge; 3] {
    [edge(a, b), edge(b, c), edge(c, a)]
}

/// Vertices, each where the mesh has it and where its body was moved to.
struct Vertices {
    given: Vec<Vec3>,
    moved: Vec<Vec3>,
    /// Those of crossing points by their coordinates: two in one place are one.
    pierced: HashMap<[u64; 3], u32>,
    /// Length of the vectors by which bodies are moved.
    shift: f64,
    /// Distance from a plane up to which a vertex is on it.
    off: f64,
    /// Distance of a crossing point from that of bodies in their places up to which the latter is taken.
    near: f64,
}

impl Vertices {
    fn corners(&self, part: &FaceTriangle) -> [Vec3; 3] {
        part.corners.map(|v| self.moved[v as usize])
    }

    fn bounds(&self, part: &FaceTriangle) -> Box3 {
        Box3::around(self.corners(part))
    }

    /// True if `d` is on the back of a triangle; exact.
    fn behind(&self, [a, b, c]: [u32; 3], d: u32) -> bool {
        let [a, b, c, d] = [a, b, c, d].map(|v| {
            let p = self.moved[v as usize];
            Coord3D { x: p.x, y: p.y, z: p.z }
        });
        orient3d(a, b, c, d) > 0.0
    }

    /// The point at which an edge pierces a triangle, as a new vertex.
    fn pierced(&mut self, (a, b): Edge, triangle: [u32; 3]) -> Option<u32> {
        if self.behind(triangle, a) == self.behind(triangle, b) {
            return None;
        }
        let [p, q, r] = triangle;
        let side = self.behind([a, b, p], q);
        if side != self.behind([a, b, q], r) || side != self.behind([a, b, r], p) {
            return None;
        }
        let crossing = |points: &[Vec3]| {
            let [from, to, p, q, r] =
                [a, b, triangle[0], triangle[1], triangle[2]].map(|v| points[v as usize]);
            let normal = (q - p).cross(r - p);
            let heights = [normal.dot(from - p), normal.dot(to - p)];
            let level = heights[0].abs().max(heights[1].abs()) <= self.off * normal.norm();
            (from, to, (!level).then(|| heights[0] / (heights[0] - heights[1])))
        };
        let (from, to, t) = crossing(&self.moved);
        let t = t.unwrap_or(0.5);
        let t = if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.5 };
        // As given, edges in a plane or beside their triangle have no point, or one far off.
        let (start, end, exact) = crossing(&self.given);
        let near = |exact: &f64| (exact - t).abs() * start.distance(end) <= self.near;
        let exact = exact.filter(near).map_or(t, |exact| exact.clamp(0.0, 1.0));
        let place = from + (to - from) * t;
        Some(*self.pierced.entry(place.to_array().map(f64::to_bits)).or_insert_with(|| {
            self.given.push(start + (end - start) * exact);
            self.moved.push(place);
            self.given.len() as u32 - 1
        }))
    }

    /// The unit normals of the planes of triangles as given, and a point of each.
    fn planes(&self, triangles: &[[u32; 3]]) -> Vec<(Vec3, Vec3)> {
        let plane = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|v| self.given[v as usize]);
            Some(((b - a).cross(c - a).normalized()?, a))
        };
        triangles.iter().filter_map(plane).collect()
    }

    /// The largest distance of a point from the planes of triangles.
    fn distance_from(&self, p: Vec3, triangles: &[[u32; 3]]) -> f64 {
        let planes = self.planes(triangles);
        planes.iter().map(|(n, at)| n.dot(p - *at).abs()).fold(0.0, f64::max)
    }

    /// The point nearest to `p` on the planes of triangles, if they have one, and its largest distance from them.
    fn on_planes(&self, p: Vec3, triangles: &[[u32; 3]]) -> (Vec3, f64) {
        let planes = self.planes(triangles);
        let mut at = p;
        for _ in 0..2 {
            let mut held: Vec<Vec3> = Vec::new();
            while held.len() < 3 {
                let free = |n: Vec3| held.iter().fold(n, |n, q| n - *q * n.dot(*q));
                let steepest = planes
                    .iter()
                    .map(|(n, on)| (free(*n), n.dot(*on - at)))
                    .max_by(|a, b| a.0.norm_sq().total_cmp(&b.0.norm_sq()));
                let Some((free, rise)) = steepest.filter(|(n, _)| n.norm() > FLAT) else { break };
                let length = free.norm();
                at += free * (rise / (length * length));
                held.push(free / length);
            }
        }
        if at.distance(p) > self.near {
            at = p;
        }
        (at, self.distance_from(at, triangles))
    }

    /// How often a skin winds about a point.
    fn winding(&self, skin: &[FaceTriangle], p: Vec3) -> f64 {
        let angle = |part: &FaceTriangle| solid_angle(self.corners(part).map(|q| q - p));
        skin.iter().map(angle).sum::<f64>() / (4.0 * PI)
    }

    fn six_volumes(&self, skin: &[FaceTriangle]) -> f64 {
        let volume = |part: &FaceTriangle| {
            let [a, b, c] = self.corners(part);
            a.dot(b.cross(c))
        };
        skin.iter().map(volume).sum()
    }
}

/// The outer skin of the bodies of a mesh without symmetry: their union. Faces away from the crossing lines stay as they
/// are. Where panels are chords of curved surfaces, so are those of the union.
///
/// # Errors
/// [`NotUnited`].
pub fn united(mesh: &Mesh<f64>) -> Result<UnitedSkin, NotUnited> {
    if let Some((_, [a, _])) = mesh.open_skin_edges().first() {
        return Err(NotUnited::Open(mesh.positions()[*a as usize]));
    }
    let mut made = united_by(mesh, 0);
    for attempt in 1..MAX_ATTEMPTS {
        if !matches!(made, Err(NotUnited::Touching(_))) {
            break;
        }
        made = united_by(mesh, attempt);
    }
    made
}

/// The union by one set of vectors.
fn united_by(mesh: &Mesh<f64>, attempt: usize) -> Result<UnitedSkin, NotUnited> {
    let size = mesh.bounds().diagonal();
    let given = mesh.positions().to_vec();
    let mut vertices = Vertices {
        moved: given.clone(),
        given,
        pierced: HashMap::new(),
        shift: SHIFTS[attempt % 2] * size,
        off: ON_PLANE * size,
        near: NEAR * size,
    };
    let mut bodies = bodies(mesh, &mut vertices, attempt)?.into_iter();
    let mut skin = bodies.next().unwrap_or_default();
    let original = mesh.positions().len();
    for body in bodies {
        skin = joined(&mut vertices, skin, body)?;
        // Slivers between faces in one plane are gone before the next body meets them.
        skin = welded(&mut vertices, skin, original, SHORT_EDGE[0])?;
    }
    let skin = welded(&mut vertices, skin, original, SHORT_EDGE[1])?;
    if let Some(at) = crack(&vertices, &skin) {
        return Err(NotUnited::Touching(at));
    }
    if let Some(at) = fold(&vertices, &skin) {
        return Err(NotUnited::Touching(at));
    }
    match displaced(&vertices, &skin) {
        Some(at) => Err(NotUnited::Touching(at)),
        None => Ok(faces(mesh, &vertices, &skin)),
    }
}

/// The bodies of the skin, each with its cavities, moved by their own vectors.
fn bodies(
    mesh: &Mesh<f64>,
    vertices: &mut Vertices,
    attempt: usize,
) -> Result<Vec<Vec<FaceTriangle>>, NotUnited> {
    let skin = mesh.skin_faces();
    let mut one = UnionFind::new(mesh.positions().len());
    for &face in &skin {
        let [a, rest @ ..] = mesh.faces()[face];
        rest.iter().for_each(|&v| one.join(a, v));
    }
    let mut numbers: HashMap<u32, usize> = HashMap::new();
    let mut pieces: Vec<Vec<FaceTriangle>> = Vec::new();
    for &face in &skin {
        let [a, b, c, d] = mesh.faces()[face];
        let k = *numbers.entry(one.find(a)).or_insert_with(|| {
            pieces.push(Vec::new());
            pieces.len() - 1
        });
        let halves = [[a, b, c], [a, c, d]].into_iter();
        let whole = halves.filter(|[a, b, c]| a != b && b != c && c != a);
        pieces[k].extend(whole.map(|corners| FaceTriangle { corners, whole: corners, face }));
    }
    let volumes: Vec<f64> = pieces.iter().map(|piece| vertices.six_volumes(piece)).collect();
    let mut members: Vec<(usize, Vec<FaceTriangle>)> = Vec::new();
    let (solid, hollow): (Vec<usize>, Vec<usize>) =
        (0..pieces.len()).partition(|&k| volumes[k] > 0.0);
    members.extend(solid.into_iter().map(|k| (k, pieces[k].clone())));
    for k in hollow {
        let p = vertices.given[pieces[k][0].corners[0] as usize];
        let around = |&m: &usize| vertices.winding(&pieces[members[m].0], p) > 0.5;
        let owner = (0..members.len())
            .filter(around)
            .min_by(|&a, &b| volumes[members[a].0].total_cmp(&volumes[members[b].0]));
        let Some(owner) = owner else { return Err(NotUnited::Inward(p)) };
        let cavity = pieces[k].clone();
        members[owner].1.extend(cavity);
    }
    let count = members.len().max(1);
    members.rotate_left(attempt % count);
    for (k, (_, body)) in members.iter().enumerate() {
        // Fractions of the generalised golden ratio: no two bodies are moved alike.
        let shift = vertices.shift;
        let part = |by: f64| shift * (((k + 1 + attempt * count) as f64) * by).fract();
        let by = Vec3::of(part(0.819_172_5), part(0.671_043_6), part(0.549_700_5));
        for (v, outward) in outward(vertices, body) {
            vertices.moved[v as usize] += by + outward * (GROWTH * shift);
        }
    }
    Ok(members.into_iter().map(|(_, body)| body).collect())
}

/// For each vertex of a body the vector that moves all planes at it outward by one, or nearly so.
fn outward(vertices: &Vertices, body: &[FaceTriangle]) -> Vec<(u32, Vec3)> {
    let mut around: BTreeMap<u32, Vec<Vec3>> = BTreeMap::new();
    for part in body {
        let [a, b, c] = vertices.corners(part);
        let Some(normal) = (b - a).cross(c - a).normalized() else { continue };
        part.corners.iter().for_each(|&v| around.entry(v).or_default().push(normal));
    }
    let vector = |normals: &[Vec3]| {
        let mean = normals.iter().fold(Vec3::zero(), |sum, n| sum + *n).normalized()?;
        let least = normals.iter().map(|n| n.dot(mean)).fold(1.0, f64::min);
        Some(mean / least.max(0.2))
    };
    around.into_iter().filter_map(|(v, normals)| Some((v, vector(&normals)?))).collect()
}

/// Points on the edges of the triangles of a skin, and the stretches of the crossing line in each triangle.
#[derive(Default)]
struct Cuts {
    on_edges: HashMap<Edge, Vec<u32>>,
    lines: HashMap<usize, Vec<[u32; 2]>>,
}

impl Cuts {
    fn add(&mut self, edges: [Edge; 3], hits: &[Option<u32>; 3]) {
        for (edge, hit) in edges.iter().zip(hits) {
            if let Some(hit) = hit {
                let known = self.on_edges.entry(*edge).or_default();
                if !known.contains(hit) {
                    known.push(*hit);
                }
            }
        }
    }
}

/// The skin of the union of two bodies.
fn joined(
    vertices: &mut Vertices,
    first: Vec<FaceTriangle>,
    second: Vec<FaceTriangle>,
) -> Result<Vec<FaceTriangle>, NotUnited> {
    let tree = BoxTree::new(second.iter().map(|part| vertices.bounds(part)).collect());
    let mut known: HashMap<(Edge, bool, usize), Option<u32>> = HashMap::new();
    let mut cuts = [Cuts::default(), Cuts::default()];
    let mut near = Vec::new();
    for (i, own) in first.iter().enumerate() {
        near.clear();
        tree.meeting(vertices.bounds(own), &mut near);
        for &j in &near {
            let other = &second[j];
            let mut hit = |edge: Edge, of_first: bool, pierced: usize, corners: [u32; 3]| {
                *known
                    .entry((edge, of_first, pierced))
                    .or_insert_with(|| vertices.pierced(edge, corners))
            };
            let own_hits = edges(own.corners).map(|e| hit(e, true, j, other.corners));
            let other_hits = edges(other.corners).map(|e| hit(e, false, i, own.corners));
            let ends: Vec<u32> = own_hits.iter().chain(&other_hits).copied().flatten().collect();
            match ends[..] {
                [] => {}
                [a, b] if a == b => {
                    cuts[0].add(edges(own.corners), &own_hits);
                    cuts[1].add(edges(other.corners), &other_hits);
                }
                [a, b] => {
                    cuts[0].add(edges(own.corners), &own_hits);
                    cuts[1].add(edges(other.corners), &other_hits);
                    // The line has what is outside on its left where it begins at an edge that goes in.
                    let goes_in =
                        |hits: [Option<u32>; 3], of: &FaceTriangle, through: &FaceTriangle| {
                            let n = hits.iter().position(Option::is_some)?;
                            let into = vertices.behind(through.corners, of.corners[(n + 1) % 3]);
                            Some((hits[n] == Some(a)) == into)
                        };
                    let first_to_last = goes_in(own_hits, own, other)
                        .or_else(|| Some(!goes_in(other_hits, other, own)?))
                        .unwrap_or(true);
                    let [a, b] = if first_to_last { [a, b] } else { [b, a] };
                    cuts[0].lines.entry(i).or_default().push([a, b]);
                    cuts[1].lines.entry(j).or_default().push([b, a]);
                }
                [p, ..] => return Err(NotUnited::Touching(vertices.given[p as usize])),
            }
        }
    }
    let mut kept = Vec::new();
    for (own, cuts, other) in [(&first, &cuts[0], &second), (&second, &cuts[1], &first)] {
        let parts = divided(vertices, own, cuts)?;
        kept.extend(outside(vertices, parts, cuts, other)?);
    }
    Ok(kept)
}

/// The triangles of a skin, those with cuts divided along these.
fn divided(
    vertices: &Vertices,
    skin: &[FaceTriangle],
    cuts: &Cuts,
) -> Result<Vec<FaceTriangle>, NotUnited> {
    let mut parts = Vec::with_capacity(skin.len());
    for (k, part) in skin.iter().enumerate() {
        let lines = cuts.lines.get(&k).map_or(&[][..], Vec::as_slice);
        let on_edge = |e: &Edge| cuts.on_edges.get(e).map_or(&[][..], Vec::as_slice);
        if lines.is_empty() && edges(part.corners).iter().all(|e| on_edge(e).is_empty()) {
            parts.push(*part);
            continue;
        }
        let mut rim: Vec<u32> = Vec::new();
        for (n, e) in edges(part.corners).iter().enumerate() {
            let from = part.corners[n];
            // Both triangles at the edge have its points in the same order.
            let far = |v: u32| vertices.moved[v as usize].distance(vertices.moved[e.0 as usize]);
            let mut hits = on_edge(e).to_vec();
            hits.sort_by(|&a, &b| far(a).total_cmp(&far(b)).then(a.cmp(&b)));
            if from != e.0 {
                hits.reverse();
            }
            rim.push(from);
            rim.extend(hits);
        }
        let corners = vertices.corners(part);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let across = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs()));
        let across = across.unwrap_or(2);
        let [x, y] = [[1, 2], [2, 0], [0, 1]][across];
        let (x, y) = if normal[across] < 0.0 { (y, x) } else { (x, y) };
        let mut numbers: Vec<u32> = rim.clone();
        numbers.extend(lines.iter().flatten());
        numbers.sort_unstable();
        numbers.dedup();
        let number = |v: u32| numbers.partition_point(|&w| w < v);
        let flat = |&v: &u32| {
            let p = vertices.moved[v as usize] - corners[0];
            [p[x], p[y]]
        };
        let points: Vec<[f64; 2]> = numbers.iter().map(flat).collect();
        let outline = [rim.iter().map(|&v| number(v)).collect()];
        let stretches: Vec<[usize; 2]> = lines.iter().map(|line| line.map(number)).collect();
        let made = planar_triangles_along(&points, &outline, &stretches, &[]);
        if made.is_empty() {
            return Err(NotUnited::Touching(vertices.given[rim[0] as usize]));
        }
        let smaller = |t: [usize; 3]| FaceTriangle { corners: t.map(|k| numbers[k]), ..*part };
        parts.extend(made.into_iter().map(smaller));
    }
    Ok(parts)
}

/// The parts of a skin outside another body: what the crossing line bounds is in or out as a whole.
fn outside(
    vertices: &Vertices,
    parts: Vec<FaceTriangle>,
    cuts: &Cuts,
    other: &[FaceTriangle],
) -> Result<Vec<FaceTriangle>, NotUnited> {
    let lines: HashSet<[u32; 2]> = cuts.lines.values().flatten().copied().collect();
    let mut beside: HashMap<Edge, usize> = HashMap::new();
    let mut one = UnionFind::new(parts.len());
    let mut sides: Vec<(usize, bool)> = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        let [a, b, c] = part.corners;
        for [a, b] in [[a, b], [b, c], [c, a]] {
            if lines.contains(&[a, b]) {
                sides.push((k, true));
            } else if lines.contains(&[b, a]) {
                sides.push((k, false));
            } else if let Some(first) = beside.insert(edge(a, b), k) {
                one.join(first as u32, k as u32);
            }
        }
    }
    let roots: Vec<usize> = (0..parts.len()).map(|k| one.find(k as u32) as usize).collect();
    let area = |k: usize| {
        let [a, b, c] = vertices.corners(&parts[k]);
        (b - a).cross(c - a).norm_sq()
    };
    let mut largest: HashMap<usize, usize> = HashMap::new();
    for (k, root) in roots.iter().enumerate() {
        let best = largest.entry(*root).or_insert(k);
        if area(k) > area(*best) {
            *best = k;
        }
    }
    let by_line: HashMap<usize, bool> =
        sides.into_iter().map(|(k, outside)| (roots[k], outside)).collect();
    let mut kept: HashMap<usize, bool> = HashMap::new();
    for (root, k) in largest {
        let corners @ [a, b, c] = vertices.corners(&parts[k]);
        let by_winding = || vertices.winding(other, (a + b + c) / 3.0).abs() < 0.5;
        let outside = match by_line.get(&root) {
            Some(outside) if is_thin(corners, THIN * vertices.shift) => *outside,
            Some(outside) if *outside != by_winding() => return Err(NotUnited::Touching(a)),
            Some(outside) => *outside,
            None => by_winding(),
        };
        kept.insert(root, outside);
    }
    let both = parts.into_iter().zip(roots);
    Ok(both.filter(|(_, root)| kept[root]).map(|(part, _)| part).collect())
}

/// True for a triangle less than `width` high.
fn is_thin([a, b, c]: [Vec3; 3], width: f64) -> bool {
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    (b - a).cross(c - a).norm() <= width * longest
}

/// The skin with crossing points on the planes of their faces, and edges at them that are shorter than `shifts` times the
/// shift of bodies contracted where these planes have one point and the skin stays closed.
fn welded(
    vertices: &mut Vertices,
    skin: Vec<FaceTriangle>,
    original: usize,
    shifts: f64,
) -> Result<Vec<FaceTriangle>, NotUnited> {
    if let Some(at) = open_at(&skin) {
        return Err(NotUnited::Touching(vertices.given[at as usize]));
    }
    let mut planes: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
    for part in &skin {
        for v in part.corners {
            let around = planes.entry(v).or_default();
            if !around.contains(&part.whole) {
                around.push(part.whole);
            }
        }
    }
    for (&v, around) in planes.range(original as u32..) {
        let (place, _) = vertices.on_planes(vertices.given[v as usize], around);
        vertices.given[v as usize] = place;
    }
    let mut one: HashMap<u32, u32> = HashMap::new();
    let find = |one: &HashMap<u32, u32>, mut v: u32| {
        while let Some(&next) = one.get(&v) {
            v = next;
        }
        v
    };
    for (a, b) in skin.iter().flat_map(|part| edges(part.corners)) {
        let length = vertices.given[a as usize].distance(vertices.given[b as usize]);
        if (b as usize) < original || length >= shifts * vertices.shift {
            continue;
        }
        let (a, b) = (find(&one, a), find(&one, b));
        let (kept, gone) = (a.min(b), a.max(b));
        if kept == gone {
            continue;
        }
        let both: Vec<[u32; 3]> = planes[&kept].iter().chain(&planes[&gone]).copied().collect();
        let start = vertices.given[kept as usize];
        let (place, off) = if (kept as usize) < original {
            (start, vertices.distance_from(start, &both))
        } else {
            vertices.on_planes(start, &both)
        };
        if off <= vertices.off {
            vertices.given[kept as usize] = place;
            planes.insert(kept, both);
            one.insert(gone, kept);
        }
    }
    let mut used: HashMap<[u32; 3], usize> = HashMap::new();
    let mut parts: Vec<Option<FaceTriangle>> = Vec::new();
    for part in &skin {
        let corners = part.corners.map(|v| find(&one, v));
        let [a, b, c] = corners;
        if a == b || b == c || c == a {
            continue;
        }
        // Two triangles on each other, face to face, bound nothing.
        let mut ring = corners;
        let least = (0..3).min_by_key(|&k| corners[k]).unwrap_or(0);
        ring.rotate_left(least);
        if let Some(k) = used.remove(&[ring[0], ring[2], ring[1]]) {
            parts[k] = None;
            continue;
        }
        used.insert(ring, parts.len());
        parts.push(Some(FaceTriangle { corners, ..*part }));
    }
    let made: Vec<FaceTriangle> = parts.into_iter().flatten().collect();
    Ok(if open_at(&made).is_none() { made } else { skin })
}

/// A vertex at which a skin is open or more than two triangles meet at an edge.
fn open_at(skin: &[FaceTriangle]) -> Option<u32> {
    let mut directed: HashSet<(u32, u32)> = HashSet::new();
    for part in skin {
        let [a, b, c] = part.corners;
        for edge in [(a, b), (b, c), (c, a)] {
            if !directed.insert(edge) {
                return Some(edge.0);
            }
        }
    }
    directed.iter().filter(|(a, b)| !directed.contains(&(*b, *a))).map(|e| e.0).min()
}

/// A point of a skin with another face of it closely in front: the wall between two bodies that nearly touch.
fn crack(vertices: &Vertices, skin: &[FaceTriangle]) -> Option<Vec3> {
    let corners = |part: &FaceTriangle| part.corners.map(|v| vertices.given[v as usize]);
    let tree = BoxTree::new(skin.iter().map(|part| Box3::around(corners(part))).collect());
    let mut met = Vec::new();
    skin.iter().find_map(|part| {
        let triangle @ [a, b, c] = corners(part);
        if is_thin(triangle, THIN * vertices.shift) {
            return None;
        }
        let normal = (b - a).cross(c - a).normalized()?;
        let middle = (a + b + c) / 3.0;
        let ahead = middle + normal * (CLOSE * vertices.shift);
        let behind = middle - normal * vertices.shift;
        met.clear();
        tree.meeting(Box3::around([behind, ahead]), &mut met);
        let other = |&k: &usize| {
            skin[k].corners != part.corners && pierced(behind, ahead, corners(&skin[k])).is_some()
        };
        met.iter().any(other).then_some(middle)
    })
}

/// The corner farthest from the plane of its face, where the faces are so far from their planes that the volume is another.
fn displaced(vertices: &Vertices, skin: &[FaceTriangle]) -> Option<Vec3> {
    let mut farthest = (0.0, Vec3::zero());
    let (mut moved, mut area) = (0.0, 0.0);
    for part in skin {
        let corners = part.corners.map(|v| vertices.given[v as usize]);
        let [a, b, c] = corners;
        let size = (b - a).cross(c - a).norm();
        area += size;
        let far = corners.map(|p| vertices.distance_from(p, &[part.whole]));
        moved += size * far.into_iter().fold(0.0, f64::max);
        for (far, at) in far.into_iter().zip(corners) {
            if far > farthest.0 {
                farthest = (far, at);
            }
        }
    }
    (moved > vertices.off * area).then_some(farthest.1)
}

/// A point at which a skin turns back on itself: a strip that bounds nothing.
fn fold(vertices: &Vertices, skin: &[FaceTriangle]) -> Option<Vec3> {
    let mut normals: HashMap<(u32, u32), Vec3> = HashMap::new();
    for part in skin {
        let [a, b, c] = part.corners;
        let corners @ [p, q, r] = part.corners.map(|v| vertices.given[v as usize]);
        // The normal of a triangle without height is that of its rounding.
        let normal = (q - p).cross(r - p).normalized();
        let Some(normal) = normal.filter(|_| !is_thin(corners, 100.0 * vertices.off)) else {
            continue;
        };
        for (from, to) in [(a, b), (b, c), (c, a)] {
            normals.insert((from, to), normal);
        }
    }
    let back = |((a, b), n): (&(u32, u32), &Vec3)| {
        let beside = normals.get(&(*b, *a))?;
        (n.dot(*beside) < FLAT - 1.0).then_some(*a)
    };
    let at = normals.iter().filter_map(back).min()?;
    Some(vertices.given[at as usize])
}

/// The faces of the skin, whole quads as such, with the vertices that they use.
fn faces(mesh: &Mesh<f64>, vertices: &Vertices, skin: &[FaceTriangle]) -> UnitedSkin {
    let mut numbers: HashMap<u32, u32> = HashMap::new();
    let mut out = UnitedSkin { positions: Vec::new(), faces: Vec::new() };
    let mut k = 0;
    while k < skin.len() {
        let FaceTriangle { corners: [a, b, c], face, .. } = skin[k];
        let whole = mesh.faces()[face];
        let next = skin.get(k + 1).map(|part| part.corners);
        let quad = [a, b, c] == [whole[0], whole[1], whole[2]]
            && next == Some([whole[0], whole[2], whole[3]]);
        k += 1 + usize::from(quad);
        let corners = if quad { whole } else { [a, b, c, c] };
        out.faces.push(corners.map(|v| {
            *numbers.entry(v).or_insert_with(|| {
                out.positions.push(vertices.given[v as usize]);
                out.positions.len() as u32 - 1
            })
        }));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PatchInfo, TopologyBuilder, inner_skins, measure};
    use moldloft_testing::{Random, rounds};

    type Brick = ([f64; 3], [f64; 3]);

    /// Boxes of `n` x `n` panels a side, each a body of its own; one with low and high exchanged along x is a cavity.
    fn bricks(boxes: &[Brick], n: usize) -> Mesh<f64> {
        let (mut builder, mut positions) = (TopologyBuilder::new(), Vec::new());
        for (low, high) in boxes {
            let mut numbers: HashMap<[usize; 3], u32> = HashMap::new();
            let mut sides = Vec::new();
            for axis in 0..3 {
                for end in [0, n] {
                    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                        let corner = |i: usize, j: usize| {
                            let mut at = [end; 3];
                            at[(axis + 1) % 3] = i;
                            at[(axis + 2) % 3] = j;
                            at
                        };
                        let mut ring = [
                            corner(i, j),
                            corner(i + 1, j),
                            corner(i + 1, j + 1),
                            corner(i, j + 1),
                        ];
                        if end == 0 {
                            ring.reverse();
                        }
                        sides.push(ring.map(|at| {
                            *numbers.entry(at).or_insert_with(|| {
                                let x = |k: usize| {
                                    low[k] + (high[k] - low[k]) * at[k] as f64 / n as f64
                                };
                                positions.push(Vec3::of(x(0), x(1), x(2)));
                                positions.len() as u32 - 1
                            })
                        }));
                    }
                }
            }
            builder.add_vertices(numbers.len()).unwrap();
            builder.add_faces_of(PatchInfo::default(), sides.into_iter(), None).unwrap();
        }
        Mesh::new(builder.build().into(), positions).unwrap()
    }

    fn mesh_of(skin: &UnitedSkin) -> Mesh<f64> {
        let mut builder = TopologyBuilder::new();
        builder.add_vertices(skin.positions.len()).unwrap();
        builder.add_faces_of(PatchInfo::default(), skin.faces.iter().copied(), None).unwrap();
        Mesh::new(builder.build().into(), skin.positions.clone()).unwrap()
    }

    /// Volume and area of a union of boxes, by the cells between all their planes.
    fn by_cells(boxes: &[Brick]) -> [f64; 2] {
        let planes: [Vec<f64>; 3] = std::array::from_fn(|k| {
            let mut all: Vec<f64> =
                boxes.iter().flat_map(|(low, high)| [low[k], high[k]]).collect();
            all.sort_by(f64::total_cmp);
            all.dedup();
            all
        });
        let cells = planes.each_ref().map(|p| p.len() - 1);
        let solid = |at: [isize; 3]| {
            (0..3).all(|k| (0..cells[k] as isize).contains(&at[k]))
                && boxes.iter().any(|(low, high)| {
                    (0..3).all(|k| {
                        let i = at[k] as usize;
                        let middle = 0.5 * (planes[k][i] + planes[k][i + 1]);
                        low[k] < middle && middle < high[k]
                    })
                })
        };
        let mut sums = [0.0; 2];
        for i in 0..cells[0] {
            for j in 0..cells[1] {
                for l in 0..cells[2] {
                    let at = [i as isize, j as isize, l as isize];
                    if !solid(at) {
                        continue;
                    }
                    let size = [0, 1, 2]
                        .map(|k| planes[k][at[k] as usize + 1] - planes[k][at[k] as usize]);
                    sums[0] += size.iter().product::<f64>();
                    for (k, by) in (0..3).flat_map(|k| [(k, -1), (k, 1)]) {
                        let mut beside = at;
                        beside[k] += by;
                        if !solid(beside) {
                            sums[1] += size[(k + 1) % 3] * size[(k + 2) % 3];
                        }
                    }
                }
            }
        }
        sums
    }

    fn check(boxes: &[Brick], n: usize, note: &str) {
        let note = format!("{note}: {boxes:?}");
        let skin = united(&bricks(boxes, n)).unwrap_or_else(|e| panic!("{note}: {e:?}"));
        let mesh = mesh_of(&skin);
        let [volume, area] = by_cells(boxes);
        let found = measure(&mesh);
        let near = 1e-12 * (area + volume);
        assert!((found.volume - volume).abs() < near, "{note}: {} {volume}", found.volume);
        assert!((found.area - area).abs() < near, "{note}: {} {area}", found.area);
        assert!(mesh.open_skin_edges().is_empty(), "{note}");
        assert_eq!(inner_skins(&mesh, &[]), [], "{note}");
    }

    #[test]
    fn unions_of_boxes_have_their_volumes() {
        let mut random = Random::new(5);
        for round in 0..rounds(60, 3000) {
            let count = 2 + round % 4;
            // Whole numbers: faces in one plane, edges that cross, corners on faces.
            let whole = round % 3 == 0;
            let brick = |random: &mut Random| {
                let mut low = [0.0; 3];
                let mut high = [0.0; 3];
                for k in 0..3 {
                    let (a, b) = (random.between(0.0, 2.0), random.between(0.4, 2.0));
                    (low[k], high[k]) =
                        if whole { (a.floor(), a.floor() + b.ceil()) } else { (a, a + b) };
                }
                (low, high)
            };
            let boxes: Vec<Brick> = (0..count).map(|_| brick(&mut random)).collect();
            check(&boxes, 1 + round % 3, &format!("round {round}"));
        }
    }

    #[test]
    fn faces_away_from_the_crossing_stay() {
        let apart = [([0.0; 3], [1.0; 3]), ([2.0, 0.0, 0.0], [3.0, 1.0, 1.0])];
        let mesh = bricks(&apart, 2);
        assert_eq!(united(&mesh).unwrap().faces, mesh.faces());
        // Half of the twelve sides are far from a small box in a corner.
        let corner = [([0.0; 3], [1.0; 3]), ([0.9; 3], [1.1; 3])];
        let skin = united(&bricks(&corner, 1)).unwrap();
        assert_eq!(skin.faces.iter().filter(|f| f[2] != f[3]).count(), 6);
    }

    #[test]
    fn cavities_stay_and_others_are_refused() {
        let hollow = [
            ([0.0; 3], [4.0; 3]),
            ([3.0, 1.0, 1.0], [1.0, 3.0, 3.0]),
            ([3.5, 1.0, 1.0], [6.0, 2.0, 2.0]),
        ];
        let volume = measure(&mesh_of(&united(&bricks(&hollow, 2)).unwrap())).volume;
        assert!((volume - (64.0 - 8.0 + 2.0)).abs() < 1e-7, "{volume}");
        let inward = [([0.0; 3], [1.0; 3]), ([8.0, 0.0, 0.0], [6.0, 1.0, 1.0])];
        assert!(matches!(united(&bricks(&inward, 1)), Err(NotUnited::Inward(_))));
        let mesh = bricks(&[([0.0; 3], [1.0; 3])], 1);
        let mut builder = TopologyBuilder::new();
        builder.add_vertices(8).unwrap();
        builder
            .add_faces_of(PatchInfo::default(), mesh.faces()[..5].iter().copied(), None)
            .unwrap();
        let open = Mesh::new(builder.build().into(), mesh.positions().to_vec()).unwrap();
        assert!(matches!(united(&open), Err(NotUnited::Open(_))));
    }
}
