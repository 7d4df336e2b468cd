//! Skins inside other skins: plates within a body, overlapping bodies.
//!
//! The skin is divided into pieces without common vertices. The winding number of a piece about a
//! point of another is a sum of solid angles (van Oosterom and Strackee 1983): 1 inside a closed
//! piece, 0 outside, one half on it.

use crate::Mesh;
use moldloft_num::union_find::UnionFind;
use moldloft_num::{Box3, Vec3};

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

/// Number of panels of a piece that are tested.
const PLACES: usize = 48;

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
}

/// The pieces of the skin that are inside others, wholly or partly; `mirrors` are the axes normal
/// to the model's planes of symmetry.
pub fn inner_skins(mesh: &Mesh<f64>, mirrors: &[u8]) -> Vec<InnerSkin> {
    let mut pieces = pieces(mesh);
    let size = mesh.bounds().diagonal();
    for &axis in mirrors {
        add_images(&mut pieces, usize::from(axis), 1e-9 * size);
    }
    let mut found: Vec<InnerSkin> = Vec::new();
    for (i, piece) in pieces.iter().enumerate().filter(|(_, p)| p.image_of.is_none()) {
        for (j, around) in pieces.iter().enumerate().filter(|&(j, _)| j != i) {
            let at = piece.places.iter().find(|&&p| around.contains(p));
            let Some(&at) = at else { continue };
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

/// The solid angle of a triangle seen from the origin.
fn solid_angle([a, b, c]: [Vec3; 3]) -> f64 {
    let [x, y, z] = [a, b, c].map(Vec3::norm);
    let across = a.dot(b.cross(c));
    let along = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
    2.0 * libm::atan2(across, along)
}

fn pieces(mesh: &Mesh<f64>) -> Vec<SkinPiece> {
    let skin = mesh.skin_faces();
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
            triangles: triangles.collect(),
            open,
            image_of: None,
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
            ..*piece
        };
        pieces.push(image);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PatchInfo, TopologyBuilder};

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
}
