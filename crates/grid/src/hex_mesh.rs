//! Blocks joined to one mesh of hexahedra with named patches, and its quality by the rules of OpenFOAM's checkMesh.

use crate::surface_grid::SAME;
use crate::{GridFace, VolumeGrid};
use moldloft_budget::{Budget, Spent};
use moldloft_num::{Real, Vec3};
use std::collections::HashMap;

/// A named part of the boundary.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BoundaryPatch {
    /// Its name.
    pub name: String,
    /// Its type: "wall", "symmetry", "farfield", "inflow", "outflow" or "patch".
    pub kind: String,
    /// Faces by their nodes, seen counter-clockwise from outside.
    pub faces: Vec<[usize; 4]>,
}

/// A mesh of hexahedra, some of which may be collapsed at poles.
#[derive(Clone, Debug, PartialEq)]
pub struct HexMesh {
    /// Nodes.
    pub points: Vec<Vec3>,
    /// Cells by their nodes: four of the layer below, counter-clockwise from above, and those above them.
    pub cells: Vec<[usize; 8]>,
    /// The boundary. Faces without a name are in the patch "defaultFaces".
    pub patches: Vec<BoundaryPatch>,
}

/// Name and type of each face of a block on the boundary.
pub type FaceNames = [Option<(String, String)>; 6];

/// The corners of a hexahedron as indices (i, j, k).
const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

/// The six faces of a hexahedron, outward, in the order of [`GridFace::ALL`].
pub const HEX_FACES: [[usize; 4]; 6] =
    [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]];

impl HexMesh {
    /// The number of cells with coincident corners, as at poles.
    pub fn collapsed(&self) -> usize {
        let is_collapsed = |cell: &&[usize; 8]| (1..8).any(|k| cell[..k].contains(&cell[k]));
        self.cells.iter().filter(is_collapsed).count()
    }

    /// The mesh of blocks, with nodes merged within 1e-10 of the size; left-handed blocks are
    /// inverted. Faces of one cell only are boundary.
    pub fn of_blocks<T: Real>(blocks: &[VolumeGrid<T>], names: &[FaceNames]) -> Self {
        Self::joined(blocks, names, &|| Ok(())).expect("nothing ends it")
    }

    /// As [`Self::of_blocks`]; ends early when `budget` is spent.
    ///
    /// # Errors
    /// The exceeded limit.
    pub fn of_blocks_until<T: Real>(
        blocks: &[VolumeGrid<T>],
        names: &[FaceNames],
        budget: &Budget,
    ) -> Result<Self, Spent> {
        Self::joined(blocks, names, &|| budget.poll())
    }

    fn joined<T: Real>(
        blocks: &[VolumeGrid<T>],
        names: &[FaceNames],
        go_on: &dyn Fn() -> Result<(), Spent>,
    ) -> Result<Self, Spent> {
        let (points, numbers) = nodes_while(blocks, joined_within(blocks), go_on)?;
        let mut cells = Vec::new();
        let mut sides: Vec<(Vec<usize>, [usize; 4], Option<(String, String)>)> = Vec::new();
        for (b, block) in blocks.iter().enumerate() {
            let plain = block.re();
            let [ni, nj, nk] = plain.size;
            let ids = &numbers[b];
            let left_handed = plain.volume_while(go_on)? < 0.0;
            let last = [ni, nj, nk].map(|n| n.saturating_sub(1));
            for i in 0..last[0] {
                for j in 0..last[1] {
                    go_on()?;
                    for k in 0..last[2] {
                        let corner = |c: [usize; 3]| {
                            let [a, b, c] = c;
                            ids[((i + a) * nj + j + b) * nk + k + c]
                        };
                        let mut cell = CORNERS.map(corner);
                        if left_handed {
                            let [a, b, c, d, e, f, g, h] = cell;
                            cell = [e, f, g, h, a, b, c, d];
                        }
                        for (side, face) in GridFace::ALL.iter().enumerate() {
                            let at = [i, j, k][face.axis];
                            let outer = if face.last { at + 1 == last[face.axis] } else { at == 0 };
                            if !outer {
                                continue;
                            }
                            // Turned over, bottom and top are exchanged.
                            let side_now = match (left_handed, side) {
                                (true, 4) => 5,
                                (true, 5) => 4,
                                _ => side,
                            };
                            let quad = HEX_FACES[side_now].map(|c| cell[c]);
                            let mut key = quad.to_vec();
                            key.sort_unstable();
                            key.dedup();
                            // Faces of poles have no area.
                            if key.len() > 2 {
                                let name = names.get(b).and_then(|names| names[side].clone());
                                sides.push((key, quad, name));
                            }
                        }
                        cells.push(cell);
                    }
                }
            }
        }
        let mut seen: HashMap<&[usize], usize> = HashMap::new();
        sides.iter().for_each(|(key, ..)| *seen.entry(key).or_default() += 1);
        let mut patches: Vec<BoundaryPatch> = Vec::new();
        for (key, quad, name) in &sides {
            if seen[key.as_slice()] > 1 {
                continue;
            }
            let (name, kind) =
                name.clone().unwrap_or_else(|| ("defaultFaces".to_string(), "patch".to_string()));
            match patches.iter_mut().find(|patch| patch.name == name) {
                Some(patch) => patch.faces.push(*quad),
                None => patches.push(BoundaryPatch { name, kind, faces: vec![*quad] }),
            }
        }
        Ok(Self { points, cells, patches })
    }
}

/// Number of cells measured between two checks of the budget.
const CELLS_AT_ONCE: usize = 1 << 12;

impl VolumeGrid<f64> {
    /// The volume inside, by the divergence theorem over cells; negative of a left-handed grid.
    pub fn volume(&self) -> f64 {
        self.volume_while(&|| Ok(())).expect("nothing ends it")
    }

    pub(crate) fn volume_while(&self, go_on: &dyn Fn() -> Result<(), Spent>) -> Result<f64, Spent> {
        let [ci, cj, ck] = self.size.map(|n| n.saturating_sub(1));
        let mut sum = 0.0;
        for i in 0..ci {
            for j in 0..cj {
                go_on()?;
                for k in 0..ck {
                    let p = CORNERS.map(|[a, b, c]| self.at(i + a, j + b, k + c));
                    sum += hex_measure(&p).1;
                }
            }
        }
        Ok(sum)
    }
}

/// The nodes of blocks, one where points of faces coincide to 1e-10 of the size, and the node of each point of each
/// block, in the order of its planes.
pub fn shared_nodes<T: Real>(blocks: &[VolumeGrid<T>]) -> (Vec<Vec3>, Vec<Vec<usize>>) {
    shared_nodes_within(blocks, joined_within(blocks))
}

/// As [`shared_nodes`], with a distance below which points coincide.
pub fn shared_nodes_within<T: Real>(
    blocks: &[VolumeGrid<T>],
    tolerance: f64,
) -> (Vec<Vec3>, Vec<Vec<usize>>) {
    nodes_while(blocks, tolerance, &|| Ok(())).expect("nothing ends it")
}

/// The distance below which points of blocks coincide.
fn joined_within<T: Real>(blocks: &[VolumeGrid<T>]) -> f64 {
    SAME * blocks.iter().map(VolumeGrid::extent).fold(0.0, f64::max)
}

fn nodes_while<T: Real>(
    blocks: &[VolumeGrid<T>],
    tolerance: f64,
    go_on: &dyn Fn() -> Result<(), Spent>,
) -> Result<(Vec<Vec3>, Vec<Vec<usize>>), Spent> {
    let mut nodes = Nodes { tolerance, points: Vec::new(), buckets: HashMap::new() };
    let mut numbers = Vec::with_capacity(blocks.len());
    for block in blocks {
        let plain = block.re();
        let [ni, nj, nk] = plain.size;
        let on_face = |i: usize, j: usize, k: usize| {
            i == 0 || j == 0 || k == 0 || i + 1 == ni || j + 1 == nj || k + 1 == nk
        };
        let mut ids = Vec::with_capacity(ni * nj * nk);
        for i in 0..ni {
            for j in 0..nj {
                go_on()?;
                for k in 0..nk {
                    ids.push(nodes.id(plain.at(i, j, k), on_face(i, j, k)));
                }
            }
        }
        numbers.push(ids);
    }
    Ok((nodes.points, numbers))
}

/// Nodes found by position.
struct Nodes {
    tolerance: f64,
    points: Vec<Vec3>,
    buckets: HashMap<[i64; 3], Vec<usize>>,
}

impl Nodes {
    /// The node at a point; only `shared` ones, on faces, are searched for duplicates.
    fn id(&mut self, p: Vec3, shared: bool) -> usize {
        let new = self.points.len();
        if !shared || self.tolerance == 0.0 {
            self.points.push(p);
            return new;
        }
        // Buckets of many tolerances: a neighbour is in the same or, at the rim, in the next one.
        let width = 64.0 * self.tolerance;
        let cell = |p: Vec3| p.to_array().map(|x| (x / width).floor() as i64);
        let t = self.tolerance;
        for corner in 0..8 {
            let shift = |k: usize| if corner >> k & 1 == 0 { -t } else { t };
            let key = cell(p + Vec3::of(shift(0), shift(1), shift(2)));
            let found = self.buckets.get(&key).into_iter().flatten();
            if let Some(id) = found.copied().find(|id| self.points[*id].distance(p) <= t) {
                return id;
            }
        }
        self.points.push(p);
        self.buckets.entry(cell(p)).or_default().push(new);
        new
    }
}

/// Face centre and area vector of a polygon: triangles about the mean of the corners, weighted by their areas.
fn face_measure(p: &[Vec3]) -> (Vec3, Vec3) {
    let n = p.len();
    let middle = p.iter().fold(Vec3::zero(), |sum, p| sum + *p) / n as f64;
    let (mut area, mut sum, mut whole) = (Vec3::zero(), Vec3::zero(), 0.0);
    for k in 0..n {
        let (a, b) = (p[k], p[(k + 1) % n]);
        let triangle = (a - middle).cross(b - middle) * 0.5;
        let size = triangle.norm();
        area += triangle;
        sum += (a + b + middle) * (size / 3.0);
        whole += size;
    }
    (if whole > 0.0 { sum / whole } else { middle }, area)
}

/// Cell centre and volume: pyramids about the mean of the face centres.
fn hex_measure(p: &[Vec3; 8]) -> (Vec3, f64) {
    let faces = HEX_FACES.map(|face| face_measure(&face.map(|c| p[c])));
    let rough = faces.iter().fold(Vec3::zero(), |sum, (centre, _)| sum + *centre) / 6.0;
    let (mut sum, mut whole) = (Vec3::zero(), 0.0);
    for (centre, area) in faces {
        let volume = area.dot(centre - rough) / 3.0;
        sum += (centre * 0.75 + rough * 0.25) * volume;
        whole += volume;
    }
    (if whole.abs() > 0.0 { sum / whole } else { rough }, whole)
}

/// The figures of checkMesh, by its formulas, and those that it does not have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshCheck {
    /// Cells, faces between two of them, faces of the boundary.
    pub counts: [usize; 3],
    /// Angles between the line of two cell centres and the normal of their face, in degrees: the largest, and the one
    /// whose cosine is the mean of the cosines, which checkMesh calls the average.
    pub non_orthogonality: [f64; 2],
    /// Largest skewness: distance between the face centre and the line of the two cell centres,
    /// relative to the size of the face.
    pub skewness: f64,
    /// Largest aspect ratio, over Cartesian components: it depends on the axes.
    pub aspect: f64,
    /// Least weight of a face between its cells, 0.5 at best.
    pub weight: f64,
    /// Least ratio of the volumes of two neighbours.
    pub volume_ratio: f64,
    /// Least and greatest volume.
    pub volume: [f64; 2],
    /// Least volume of the pyramid of a face and a cell centre.
    pub pyramid: f64,
    /// Least flatness of a face, 1 at best.
    pub flatness: f64,
    /// Least scaled Jacobian at a corner, and its cell: checkMesh accepts cells that are turned over there.
    pub jacobian: (f64, usize),
}

impl HexMesh {
    /// The figures of the mesh.
    pub fn check(&self) -> MeshCheck {
        self.checked(&|| Ok(())).expect("nothing ends it")
    }

    /// As [`Self::check`]; ends early when `budget` is spent.
    ///
    /// # Errors
    /// The exceeded limit.
    pub fn check_until(&self, budget: &Budget) -> Result<MeshCheck, Spent> {
        self.checked(&|| budget.poll())
    }

    fn checked(&self, go_on: &dyn Fn() -> Result<(), Spent>) -> Result<MeshCheck, Spent> {
        let corners: Vec<[Vec3; 8]> =
            self.cells.iter().map(|cell| cell.map(|id| self.points[id])).collect();
        let mut cells: Vec<(Vec3, f64)> = Vec::with_capacity(corners.len());
        for some in corners.chunks(CELLS_AT_ONCE) {
            go_on()?;
            cells.extend(some.iter().map(hex_measure));
        }
        let mut owners: HashMap<Vec<usize>, (usize, [usize; 4])> = HashMap::new();
        let mut check = MeshCheck {
            counts: [self.cells.len(), 0, 0],
            non_orthogonality: [0.0, 0.0],
            skewness: 0.0,
            aspect: 0.0,
            weight: 0.5,
            volume_ratio: 1.0,
            volume: [f64::INFINITY, f64::NEG_INFINITY],
            pyramid: f64::INFINITY,
            flatness: 1.0,
            jacobian: (f64::INFINITY, 0),
        };
        for (c, cell) in self.cells.iter().enumerate() {
            if c % CELLS_AT_ONCE == 0 {
                go_on()?;
            }
            let (centre, volume) = cells[c];
            check.volume = [check.volume[0].min(volume), check.volume[1].max(volume)];
            let (mut spread, mut total) = ([0.0f64; 3], 0.0);
            for face in HEX_FACES {
                let quad = face.map(|k| cell[k]);
                let points = quad.map(|id| self.points[id]);
                let (middle, area) = face_measure(&points);
                let parts: f64 = {
                    let rough = points.iter().fold(Vec3::zero(), |sum, p| sum + *p) / 4.0;
                    let triangle =
                        |k: usize| (points[k] - rough).cross(points[(k + 1) % 4] - rough).norm();
                    (0..4).map(triangle).sum::<f64>() * 0.5
                };
                if parts > 0.0 {
                    check.flatness = check.flatness.min(area.norm() / parts);
                }
                check.pyramid = check.pyramid.min(area.dot(middle - centre) / 3.0);
                for (sum, x) in spread.iter_mut().zip(area.to_array()) {
                    *sum += x.abs();
                    total += x.abs();
                }
                let mut key = quad.to_vec();
                key.sort_unstable();
                key.dedup();
                if key.len() < 3 {
                    continue;
                }
                match owners.remove(&key) {
                    None => {
                        owners.insert(key, (c, quad));
                    }
                    Some((owner, quad)) => self.check_face(&mut check, &cells, [owner, c], quad),
                }
            }
            let [low, high] = [
                spread.iter().copied().fold(f64::INFINITY, f64::min),
                spread.iter().copied().fold(0.0, f64::max),
            ];
            let cubic = total / (6.0 * libm::pow(volume.abs(), 2.0 / 3.0));
            check.aspect = check.aspect.max((high / low).max(cubic));
            let p = &corners[c];
            let grid = [0, 1].map(|a| {
                [0, 1].map(|b| {
                    [0, 1].map(|k| {
                        let corner = CORNERS.iter().position(|x| *x == [a, b, k]).unwrap_or(0);
                        p[corner]
                    })
                })
            });
            let jacobian = crate::marching::hexahedron(grid)[0];
            if !(jacobian >= check.jacobian.0) {
                check.jacobian = (jacobian, c);
            }
        }
        check.counts[2] = owners.len();
        for (number, (owner, quad)) in owners.into_values().enumerate() {
            if number % CELLS_AT_ONCE == 0 {
                go_on()?;
            }
            let (middle, area) = face_measure(&quad.map(|id| self.points[id]));
            let unit = area / area.norm().max(f64::MIN_POSITIVE);
            let q = middle - cells[owner].0;
            let d = unit * unit.dot(q);
            self.take_skewness(&mut check, quad, [q, d, area], 0.4);
        }
        let inner = check.counts[1] as f64;
        if inner > 0.0 {
            let mean = (check.non_orthogonality[1] / inner).clamp(-1.0, 1.0);
            check.non_orthogonality[1] = libm::acos(mean).to_degrees();
        }
        Ok(check)
    }

    fn check_face(
        &self,
        check: &mut MeshCheck,
        cells: &[(Vec3, f64)],
        [owner, other]: [usize; 2],
        quad: [usize; 4],
    ) {
        let (middle, area) = face_measure(&quad.map(|id| self.points[id]));
        let ((p, own), (n, their)) = (cells[owner], cells[other]);
        let d = n - p;
        let cosine = (d.dot(area) / (d.norm() * area.norm())).clamp(-1.0, 1.0);
        let angle = libm::acos(cosine).to_degrees();
        check.counts[1] += 1;
        check.non_orthogonality[0] = check.non_orthogonality[0].max(angle);
        check.non_orthogonality[1] += cosine;
        let (a, b) = (area.dot(middle - p).abs(), area.dot(n - middle).abs());
        check.weight = check.weight.min(a.min(b) / (a + b));
        check.volume_ratio = check.volume_ratio.min(own.min(their) / own.max(their));
        self.take_skewness(check, quad, [middle - p, d, area], 0.2);
    }

    /// Skewness for the line `d` between two centres and the face centre, which is at `q` from the
    /// first.
    fn take_skewness(
        &self,
        check: &mut MeshCheck,
        quad: [usize; 4],
        [q, d, area]: [Vec3; 3],
        share: f64,
    ) {
        let through = area.dot(d);
        if through == 0.0 {
            return;
        }
        let (middle, _) = face_measure(&quad.map(|id| self.points[id]));
        let miss = q - d * (area.dot(q) / through);
        let length = miss.norm();
        if length == 0.0 {
            return;
        }
        let unit = miss / length;
        let reach = quad
            .iter()
            .map(|id| unit.dot(self.points[*id] - middle).abs())
            .fold(share * d.norm(), f64::max);
        check.skewness = check.skewness.max(length / reach);
    }
}
