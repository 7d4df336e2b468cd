//! Drills: bodies of revolution by the rings of their profiles.

use super::curve::SmoothPiece;
use super::{SketchSolid, SolidEdge, SolidFace, Vertex};
use crate::{CoordinateAxis, PointId};
use moldloft_num::{Real, Vec3};
use std::sync::Arc;

/// A ring of the drill's profile: radius, coordinate along the axis, and the name of the face above it.
#[derive(Clone)]
pub(super) struct DrillRing<T> {
    pub radius: T,
    pub level: T,
    pub above: &'static str,
}

/// A drill in its first position, by its rings from the lowest to the highest.
pub(super) struct DrillProfile<T> {
    pub axis: CoordinateAxis,
    pub centre: Vec3<T>,
    pub rings: Vec<DrillRing<T>>,
}

impl<T: Real> DrillProfile<T> {
    /// The levels of its ends.
    pub fn span(&self) -> [f64; 2] {
        let levels = || self.rings.iter().map(|r| r.level.re());
        [levels().fold(f64::INFINITY, f64::min), levels().fold(f64::NEG_INFINITY, f64::max)]
    }
}

/// The body of revolution of rings from the lowest to the highest, about the axis `k` through a point: plane caps,
/// quarters of cylinders and cones, and plane rings.
pub(super) fn rotational<T: Real>(
    k: usize,
    centre: Vec3<T>,
    rings: &[DrillRing<T>],
) -> SketchSolid<T> {
    const QUARTERS: [[f64; 2]; 4] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
    let mut out = SketchSolid::<T>::default();
    let middle = |ring: &DrillRing<T>| {
        let mut at = centre.to_array();
        at[k] = ring.level;
        Vec3::from(at)
    };
    let arm = |ring: &DrillRing<T>, quarter: usize| {
        let mut at = [T::zero(); 3];
        let [c, s] = QUARTERS[quarter % 4];
        (at[(k + 1) % 3], at[(k + 2) % 3]) = (ring.radius * c, ring.radius * s);
        Vec3::from(at)
    };
    let sweep = T::from(std::f64::consts::FRAC_PI_2);
    for (i, ring) in rings.iter().enumerate() {
        for q in 0..4 {
            let id = PointId((4 * i + q) as u32 + 1);
            out.vertices.push(Vertex { id, at: middle(ring) + arm(ring, q) });
            let piece = SmoothPiece::Conic {
                centre: middle(ring),
                a: arm(ring, q),
                b: arm(ring, q + 1),
                sweep,
            };
            let ends = [4 * i + q, 4 * i + (q + 1) % 4];
            out.edges.push(SolidEdge { ends, piece: Some(piece), ..SolidEdge::default() });
        }
    }
    let forward = |i: usize| (0..4).map(|q| (4 * i + q, true)).collect::<Vec<_>>();
    let backward = |i: usize| (0..4).rev().map(|q| (4 * i + q, false)).collect::<Vec<_>>();
    let mut face = |loops, ruled, name: &str| {
        let names = vec![Arc::from(name)];
        out.faces.push(SolidFace { id: None, ruled, loops, trim: None, names });
    };
    face(vec![backward(0)], false, "BOTTOM");
    face(vec![forward(rings.len() - 1)], false, "BOTTOM");
    for (i, pair) in rings.windows(2).enumerate() {
        if pair[0].level.re() == pair[1].level.re() {
            let widens = pair[1].radius.re() > pair[0].radius.re();
            let loops = match widens {
                true => vec![backward(i + 1), forward(i)],
                false => vec![forward(i), backward(i + 1)],
            };
            face(loops, false, pair[0].above);
            continue;
        }
        let first = out.edges.len();
        for q in 0..4 {
            out.edges.push(SolidEdge { ends: [4 * i + q, 4 * i + 4 + q], ..SolidEdge::default() });
        }
        for q in 0..4 {
            let next = (q + 1) % 4;
            let cycle = vec![
                (4 * i + q, true),
                (first + next, true),
                (4 * i + 4 + q, false),
                (first + q, false),
            ];
            face(vec![cycle], true, pair[0].above);
        }
    }
    out
}
