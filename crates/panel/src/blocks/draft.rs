//! The solids that take part in a volume mesh, and the identities of their faces, edges and corners.

use moldloft_mesh::{BlockFace, HexBlock};
use moldloft_model::{Graph, Object};
use moldloft_num::trace::{Face, Faces, Key, Mark, Piece, Root};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Scalar, SolidRef, Value};

pub(crate) fn solid_of<T: Scalar>(object: &Object<T>) -> Option<&SolidRef<T>> {
    match object.value()? {
        Value::Solid(solid) => Some(solid),
        _ => None,
    }
}

/// The grid of a solid with given numbers of cells.
pub fn grid<T: Real>(solid: &SolidRef<T>, divisions: [usize; 3]) -> Vec<Vec3<T>> {
    let [us, vs, ws] =
        divisions.map(|n| (0..=n).map(|i| i as f64 / n as f64).collect::<Vec<f64>>());
    let mut points = vec![Vec3::zero(); us.len() * vs.len() * ws.len()];
    solid.grid(&us, &vs, &ws, &mut points);
    points
}

pub(crate) struct BlockDraft<'g> {
    pub object: &'g Object<f64>,
    pub solid: &'g SolidRef<f64>,
    pub faces: Faces<f64>,
}

impl BlockDraft<'_> {
    /// The names of the surfaces that the faces are, or of the solid and the face.
    pub fn face_names(&self, graph: &Graph<f64>) -> [BlockFace; 6] {
        std::array::from_fn(|f| {
            let surface = match &self.faces.faces[f] {
                Face::On { surface: Some(key), .. } => graph.get(*key),
                _ => None,
            };
            let side = format!("{}.{}{}", self.object.name, ["u", "v", "w"][f / 2], f % 2);
            BlockFace { name: surface.map_or(side, |s| s.name.to_string()) }
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum FaceId {
    Surface(Key),
    Solid(Key, u8),
}

/// The identity of a mark on a root.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum MarkId {
    Point(Key),
    At(u64),
}

pub(crate) fn mark_id(mark: &Mark<f64>) -> MarkId {
    mark.point.map_or(MarkId::At(mark.t.to_bits()), MarkId::Point)
}

/// A stretch of a root, from its lower to its higher end; and whether the piece has the opposite
/// direction.
pub(crate) type RootInterval = (Root, MarkId, MarkId);

pub(crate) fn interval(piece: &Piece<f64>) -> (RootInterval, bool) {
    let backwards = piece.from.t > piece.to.t;
    let (low, high) = if backwards { (piece.to, piece.from) } else { (piece.from, piece.to) };
    ((piece.root, mark_id(&low), mark_id(&high)), backwards)
}

/// The axes of the parameters of face 0..6.
pub(crate) fn face_axes(face: usize) -> [usize; 2] {
    let [a, b, _] = HexBlock::face_axes(face);
    [a, b]
}

/// The identity of a face that is a surface: that of the solid's face, if it is one.
pub(crate) fn face_id(surface: Option<Key>, face_of: Option<(Key, u8)>) -> Option<FaceId> {
    match face_of {
        Some((solid, face)) => Some(FaceId::Solid(solid, face)),
        None => surface.map(FaceId::Surface),
    }
}
