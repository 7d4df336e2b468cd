//! Skins inside other skins: plates within a body, overlapping bodies.
//!
//! The skin is divided into pieces without common vertices. A piece reaches into another one if one
//! of its places, or a part of an edge between two of the other's panels that it pierces, is inside.
//! The winding number of a piece about a point is a sum of solid angles (van Oosterom and Strackee
//! 1983): 1 inside a closed piece, 0 outside, one half on it. Panels are chords: points nearer to
//! the other piece than the larger sagitta do not count.

use crate::{Mesh, sagittas};
use moldloft_num::union_find::UnionFind;
use moldloft_num::{Box3, BoxTree, Vec3, nearest_on_triangle};
use std::cell::OnceCell;

/// A piece of the skin with points inside another piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InnerSkin {
    /// A patch of it.
    pub patch: usize,
    /// A patch of the piece around it; of the same piece if that overlaps its mirror image.
    pub around: usize,
    /// True for a piece with open edges: a plate.
    pub open: bool,
    /// True for a closed piece wholly inside another one with the opposite orientation: its volume
    /// is subtracted.
    pub cavity: bool,
    /// A point of the piece inside the piece around it.
    pub at: Vec3,
}

/// Number of panels of a piece whose corners and middles are tested.
const PLACES: usize = 48;

/// Number of parts of pierced edges that are tested.
const PIERCED_PARTS: usize = 64;

/// Depth to which chords of equal surfaces reach into each other, relative to the larger sagitta,
/// which is estimated to a few per cent.
const SAGITTA_MARGIN: f64 = 1.1;

/// Distance of points that coincide, relative to the size of the model.
const COINCIDENT: f64 = 1e-9;

/// A point about which a piece winds more than this is inside it: no point on a skin is, except in
/// a sharp hollow.
const INSIDE: f64 = 0.9;

/// A piece of the skin, with its mirror images where these touch it.
struct SkinPiece {
    patch: usize,
    triangles: Vec<[Vec3; 3]>,
    /// Middles and corners of its own panels, evenly chosen.
    places: Vec<Vec3>,
    bounds: Box3,
    open: bool,
    image_of: Option<usize>,
    /// Maximum distance of the surface from the panels.
    sagitta: f64,
    /// Over the triangles.
    tree: OnceCell<BoxTree>,
}

/// The pieces of the skin that are inside others, wholly or partly; `mirrors` are the axes normal
/// to the model's planes of symmetry.
pub fn inner_skins(mesh: &Mesh<f64>, mirrors: &[u8]) -> Vec<InnerSkin> {
    let mut pieces = pieces(mesh);
    let size = mesh.bounds().diagonal();
    for &axis in mirrors {
        add_images(&mut pieces, usize::from(axis), COINCIDENT * size);
    }
    let mut found: Vec<InnerSkin> = Vec::new();
    for (i, piece) in pieces.iter().enumerate().filter(|(_, p)| p.image_of.is_none()) {
        for (j, around) in pieces.iter().enumerate().filter(|&(j, _)| j != i) {
            let near = COINCIDENT * size + SAGITTA_MARGIN * piece.sagitta.max(around.sagitta);
            let Some(at) = piece.reach_into(around, near) else { continue };
            let cavity = piece.is_cavity_of(around);
            let (patch, around) = (piece.patch, pieces[around.image_of.unwrap_or(j)].patch);
            let pair = |f: &InnerSkin| {
                (f.patch, f.around) == (patch, around) || (f.around, f.patch) == (patch, around)
            };
            if !found.iter().any(pair) {
                found.push(InnerSkin { patch, around, open: piece.open, cavity, at });
            }
        }
    }
    found
}

fn within(b: &Box3, p: Vec3) -> bool {
    (0..3).all(|k| b.low[k] < p[k] && p[k] < b.high[k])
}

impl SkinPiece {
    /// A point of this piece inside the other one, farther than `near` from it.
    fn reach_into(&self, around: &Self, near: f64) -> Option<Vec3> {
        if !self.bounds.meets(around.bounds) {
            return None;
        }
        let inside = |p: &Vec3| around.is_farther(*p, near) && around.contains(*p);
        self.places.iter().copied().find(inside).or_else(|| {
            let parts = self.pierced_parts(around, near);
            let step = parts.len().div_ceil(PIERCED_PARTS).max(1);
            parts.into_iter().step_by(step).find(inside)
        })
    }

    /// Middles of the parts into which the other piece divides edges of this one.
    fn pierced_parts(&self, other: &Self, near: f64) -> Vec<Vec3> {
        let mut found = Vec::new();
        let (mut met, mut cuts) = (Vec::new(), Vec::new());
        for &[a, b, c] in &self.triangles {
            for [p, q] in [[a, b], [b, c], [c, a]] {
                let bounds = Box3::around([p, q]);
                if !bounds.meets(other.bounds) {
                    continue;
                }
                met.clear();
                other.tree().meeting(bounds, &mut met);
                cuts.clear();
                cuts.extend(met.iter().filter_map(|&t| pierced(p, q, other.triangles[t])));
                if cuts.is_empty() {
                    continue;
                }
                cuts.extend([0.0, 1.0]);
                cuts.sort_by(f64::total_cmp);
                let middles = cuts.windows(2).map(|w| p + (q - p) * (0.5 * (w[0] + w[1])));
                found.extend(middles.filter(|&m| other.is_farther(m, near)));
            }
        }
        found
    }

    fn tree(&self) -> &BoxTree {
        let bounds = |t: &[Vec3; 3]| Box3::around(*t);
        self.tree.get_or_init(|| BoxTree::new(self.triangles.iter().map(bounds).collect()))
    }

    /// True for a point within the bounds and farther than `near` from the panels.
    fn is_farther(&self, p: Vec3, near: f64) -> bool {
        if !within(&self.bounds, p) {
            return false;
        }
        let mut met = Vec::new();
        self.tree().meeting(Box3::around([p]).grown(near), &mut met);
        met.into_iter().all(|t| p.distance(nearest_on_triangle(p, self.triangles[t])) > near)
    }

    fn contains(&self, p: Vec3) -> bool {
        let angle =
            || self.triangles.iter().map(|t| solid_angle(t.map(|q| q - p))).sum::<f64>().abs();
        within(&self.bounds, p) && angle() > INSIDE * 4.0 * std::f64::consts::PI
    }

    /// Six times the enclosed volume, negative for normals that face inward.
    fn six_volumes(&self) -> f64 {
        self.triangles.iter().map(|[a, b, c]| a.dot(b.cross(*c))).sum()
    }

    fn is_cavity_of(&self, around: &Self) -> bool {
        !(self.open || around.open)
            && self.six_volumes() * around.six_volumes() < 0.0
            && self.places.iter().all(|&p| around.contains(p))
    }
}

/// Where a line from `p` to `q` pierces a triangle: its part of the length, between 0 and 1.
pub(crate) fn pierced(p: Vec3, q: Vec3, [a, b, c]: [Vec3; 3]) -> Option<f64> {
    let (line, normal) = (q - p, (b - a).cross(c - a));
    let (from, to) = (normal.dot(p - a), normal.dot(q - a));
    if (from < 0.0) == (to < 0.0) {
        return None;
    }
    let side = |u: Vec3, v: Vec3| line.dot((u - p).cross(v - p));
    let sides = [side(a, b), side(b, c), side(c, a)];
    let within = sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0);
    within.then(|| from / (from - to))
}

/// The solid angle of a triangle seen from the origin.
pub(crate) fn solid_angle([a, b, c]: [Vec3; 3]) -> f64 {
    let [x, y, z] = [a, b, c].map(Vec3::norm);
    let across = a.dot(b.cross(c));
    let along = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
    2.0 * libm::atan2(across, along)
}

fn pieces(mesh: &Mesh<f64>) -> Vec<SkinPiece> {
    let skin = mesh.skin_faces();
    let sagitta_of_patch = sagittas(mesh);
    let mut joined = UnionFind::new(mesh.positions().len());
    for &face in &skin {
        let [a, rest @ ..] = mesh.faces()[face];
        rest.iter().for_each(|&v| joined.join(a, v));
    }
    let mut roots: Vec<u32> = Vec::new();
    let mut faces: Vec<Vec<usize>> = Vec::new();
    for &face in &skin {
        let root = joined.find(mesh.faces()[face][0]);
        let k = roots.iter().position(|r| *r == root).unwrap_or_else(|| {
            roots.push(root);
            faces.push(Vec::new());
            roots.len() - 1
        });
        faces[k].push(face);
    }
    let mut open = vec![false; roots.len()];
    for (_, [a, _]) in mesh.open_skin_edges() {
        if let Some(k) = roots.iter().position(|r| *r == joined.find(a)) {
            open[k] = true;
        }
    }
    let piece = |(faces, open): (Vec<usize>, bool)| {
        let corners = |f: &usize| mesh.faces()[*f].map(|v| mesh.positions()[v as usize]);
        let triangles = faces.iter().map(corners).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let step = faces.len().div_ceil(PLACES).max(1);
        let places = |f: &usize| {
            let [a, b, c, d] = corners(f);
            [(a + b + c + d) * 0.25, a, b, c, d]
        };
        SkinPiece {
            patch: mesh.topology().patch_of(faces[0]),
            bounds: Box3::around(faces.iter().flat_map(corners)),
            places: faces.iter().step_by(step).flat_map(places).collect(),
            sagitta: faces
                .iter()
                .map(|&f| sagitta_of_patch[mesh.topology().patch_of(f)])
                .fold(0.0, f64::max),
            triangles: triangles.collect(),
            open,
            image_of: None,
            tree: OnceCell::new(),
        }
    };
    faces.into_iter().zip(open).map(piece).collect()
}

/// Adds the images in the plane through zero of an axis: to the pieces that touch it, beside the others.
fn add_images(pieces: &mut Vec<SkinPiece>, axis: usize, near: f64) {
    let mirrored = |p: Vec3| {
        let mut q = p.to_array();
        q[axis] = -q[axis];
        Vec3::from(q)
    };
    for k in 0..pieces.len() {
        let piece = &mut pieces[k];
        let images: Vec<_> =
            piece.triangles.iter().map(|&[a, b, c]| [a, c, b].map(mirrored)).collect();
        let bounds = Box3::around(images.iter().flatten().copied());
        if piece.bounds.low[axis] <= near && piece.bounds.high[axis] >= -near {
            piece.triangles.extend(images);
            piece.bounds = piece.bounds.union(bounds);
            continue;
        }
        let image = SkinPiece {
            triangles: images,
            bounds,
            places: Vec::new(),
            image_of: Some(piece.image_of.unwrap_or(k)),
            tree: OnceCell::new(),
            ..*piece
        };
        pieces.push(image);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PatchInfo, TopologyBuilder};
    use moldloft_testing::{Random, rounds};

    /// The six faces of a box as patches of one body, or its bottom alone.
    fn add_box(
        builder: &mut TopologyBuilder,
        positions: &mut Vec<Vec3>,
        low: [f64; 3],
        high: [f64; 3],
        faces: usize,
    ) {
        let first = positions.len() as u32;
        for k in 0..8 {
            let at = |a: usize| if k >> a & 1 == 0 { low[a] } else { high[a] };
            positions.push(Vec3::of(at(0), at(1), at(2)));
        }
        builder.add_vertices(8).unwrap();
        let quads =
            [[0, 2, 1, 3], [4, 5, 6, 7], [0, 1, 4, 5], [2, 6, 3, 7], [0, 4, 2, 6], [1, 3, 5, 7]];
        for corners in &quads[..faces] {
            let vertices = corners.map(|v| v + first).to_vec();
            builder.add_block(PatchInfo::default(), 2, 2, vertices, false).unwrap();
        }
    }

    fn found(boxes: &[([f64; 3], [f64; 3], usize)], mirrors: &[u8]) -> Vec<InnerSkin> {
        let (mut builder, mut positions) = (TopologyBuilder::new(), Vec::new());
        for &(low, high, faces) in boxes {
            add_box(&mut builder, &mut positions, low, high, faces);
        }
        inner_skins(&Mesh::new(builder.build().into(), positions).unwrap(), mirrors)
    }

    #[test]
    fn plates_and_overlaps_are_found_and_neighbours_are_not() {
        let cube = ([0.0; 3], [4.0, 2.0, 2.0], 6);
        assert_eq!(found(&[cube], &[]), []);
        let deck = ([0.0, 0.0, 1.0], [4.0, 2.0, 1.5], 1);
        let plate = found(&[cube, deck], &[]);
        assert!(plate.len() == 1 && plate[0].open && (plate[0].patch, plate[0].around) == (6, 0));
        // A wall in common is no overlap, nor is a plate on the skin.
        let beside = ([4.0, 0.0, 0.0], [6.0, 2.0, 2.0], 6);
        assert_eq!(found(&[cube, beside], &[]), []);
        assert_eq!(found(&[cube, ([1.0, 0.5, 0.0], [2.0, 1.0, 1.0], 1)], &[]), []);
        let across = ([3.0, 1.0, 1.0], [6.0, 3.0, 3.0], 6);
        assert_eq!(found(&[cube, across], &[]).len(), 1);
        let within = ([1.0, 0.5, 0.5], [2.0, 1.0, 1.0], 6);
        let inner = found(&[cube, within], &[]);
        assert!(inner.len() == 1 && !inner[0].open && !inner[0].cavity);
        // Its corners exchanged along x, it faces the other way.
        let turned = ([2.0, 0.5, 0.5], [1.0, 1.0, 1.0], 6);
        assert!(found(&[cube, turned], &[])[0].cavity);
        let through = ([5.0, 0.5, 0.5], [1.0, 1.0, 1.0], 6);
        assert!(!found(&[cube, through], &[])[0].cavity);
        // Images: a body that reaches to the plane is one with its own, and one across it overlaps.
        assert_eq!(found(&[cube], &[1]), []);
        let off = ([0.0, 1.0, 0.0], [4.0, 2.0, 2.0], 6);
        assert_eq!(found(&[off], &[1]), []);
        let over = ([0.0, 1.0, 0.0], [4.0, 2.0, 2.0], 6);
        let near = ([1.0, -1.5, 0.5], [2.0, -0.5, 1.0], 6);
        assert_eq!(found(&[over, near], &[1]).len(), 1);
    }

    /// A box turned at random, as its centre and half axes.
    fn turned_box(random: &mut Random) -> (Vec3, [Vec3; 3]) {
        let x = random.point().normalized().unwrap();
        let y = x.cross(random.point()).normalized().unwrap();
        let size = [0; 3].map(|_| random.between(0.1, 1.0));
        let centre = random.point() * 0.8;
        (centre, [x * size[0], y * size[1], x.cross(y) * size[2]])
    }

    /// The largest gap between two boxes along an axis that may part them; negative when they
    /// overlap (Gottschalk, Lin and Manocha 1996).
    fn gap((a, us): &(Vec3, [Vec3; 3]), (b, vs): &(Vec3, [Vec3; 3])) -> f64 {
        let crossed = us.iter().flat_map(|u| vs.iter().map(move |v| u.cross(*v)));
        let axes = us.iter().chain(vs).copied().chain(crossed);
        axes.filter_map(Vec3::normalized).fold(f64::NEG_INFINITY, |most, n| {
            let reach: f64 = us.iter().chain(vs).map(|u| u.dot(n).abs()).sum();
            most.max((*b - *a).dot(n).abs() - reach)
        })
    }

    #[test]
    fn random_boxes_overlap_unless_a_plane_parts_them() {
        let mut random = Random::new(7);
        let mut counts = [0; 2];
        for _ in 0..rounds(400, 40_000) {
            let boxes = [turned_box(&mut random), turned_box(&mut random)];
            let gap = gap(&boxes[0], &boxes[1]);
            if gap.abs() < 1e-6 {
                continue;
            }
            let (mut builder, mut positions) = (TopologyBuilder::new(), Vec::new());
            for (centre, axes) in &boxes {
                let first = positions.len();
                add_box(&mut builder, &mut positions, [-1.0; 3], [1.0; 3], 6);
                for p in &mut positions[first..] {
                    *p = *centre + axes[0] * p.x + axes[1] * p.y + axes[2] * p.z;
                }
            }
            let mesh = Mesh::new(builder.build().into(), positions).unwrap();
            let found = inner_skins(&mesh, &[]);
            assert_eq!(found.len(), usize::from(gap < 0.0), "{boxes:?} {gap}");
            counts[found.len()] += 1;
        }
        assert!(counts[0] > 50 && counts[1] > 50, "{counts:?}");
    }

    #[test]
    fn crossing_bars_overlap_and_a_sleeve_round_a_shaft_does_not() {
        let bar = ([-4.0, -0.5, -0.5], [4.0, 0.5, 0.5], 6);
        assert_eq!(found(&[bar, ([-0.5, -4.0, -0.4], [0.5, 4.0, 0.6], 6)], &[]).len(), 1);
        // A fin whose corners are all outside.
        assert_eq!(found(&[bar, ([0.1, -9.0, -9.0], [0.12, 9.0, 9.0], 6)], &[]).len(), 1);
        // Chords of the sleeve's bore reach into the shaft, by less than the sagittas.
        for (sides, turned) in [(16, 24), (24, 16), (40, 41), (32, 32)] {
            let (mut builder, mut positions) = (TopologyBuilder::new(), Vec::new());
            for (n, radii) in [(sides, [1.0, 0.0]), (turned, [2.0, 1.0])] {
                let first = positions.len() as u32;
                // Outer wall up, lid, bore down, bottom.
                let rim = [(radii[0], 0.0), (radii[0], 3.0), (radii[1], 3.0), (radii[1], 0.0)];
                for k in 0..n {
                    let angle = std::f64::consts::TAU * k as f64 / n as f64 + 0.1;
                    positions.extend(
                        rim.map(|(r, z)| Vec3::of(r * libm::cos(angle), r * libm::sin(angle), z)),
                    );
                }
                builder.add_vertices(4 * n).unwrap();
                for side in 0..4 {
                    let faces = (0..n as u32).map(|k| {
                        let next = (k + 1) % n as u32;
                        let at = |k: u32, side: u32| first + 4 * k + side % 4;
                        [at(k, side), at(next, side), at(next, side + 1), at(k, side + 1)]
                    });
                    builder.add_faces(PatchInfo::default(), faces).unwrap();
                }
            }
            let mesh = Mesh::new(builder.build().into(), positions).unwrap();
            assert_eq!(inner_skins(&mesh, &[]), [], "{sides} {turned}");
        }
    }
}
