//! Sections of letters: the outlines of a text at a place.

use super::curve::SmoothPiece;
use super::{SketchSolid, SolidEdge, SolidFace, Vertex};
use crate::PointId;
use crate::feature::SectionText;
use moldloft_font::Bezier;
use moldloft_num::{Real, Vec3};

impl SectionText {
    /// The regions of the letters with capitals of a height, from an origin in the plane, turned by an angle in radians.
    pub(super) fn section<T: Real>(&self, size: T, at: [T; 2], angle: T) -> SketchSolid<T> {
        let [a, b] = self.axis.others().map(|axis| axis.index());
        let (cos, sin) = (angle.cos(), angle.sin());
        let way = if self.mirrored { -1.0 } else { 1.0 };
        let place = |[x, y]: [f64; 2]| {
            let mut xyz = [T::zero(); 3];
            xyz[a] = at[0] + size * (cos * x - sin * y) * way;
            xyz[b] = at[1] + size * (sin * x + cos * y);
            Vec3::from(xyz)
        };
        let mut out = SketchSolid::<T> { flat: true, ..SketchSolid::default() };
        let mut face_of = vec![0; self.loops.len()];
        for (k, cycle) in self.loops.iter().enumerate() {
            let (first, n) = (out.vertices.len(), cycle.pieces.len());
            let mut border = Vec::with_capacity(n);
            for (j, piece) in cycle.pieces.iter().enumerate() {
                let id = PointId(out.vertices.len() as u32 + 1);
                out.vertices.push(Vertex { id, at: place(piece.ends()[0]) });
                border.push((out.edges.len(), true));
                out.edges.push(SolidEdge {
                    ends: [first + j, first + (j + 1) % n],
                    piece: curve(piece, &place),
                    name: Some(format!("T{}", cycle.characters[j] + 1).into()),
                    ..SolidEdge::default()
                });
            }
            // Holes follow the loops around them.
            let face = match cycle.around {
                Some(outer) => face_of[outer],
                None => {
                    let (loops, names) = (Vec::new(), Vec::new());
                    out.faces.push(SolidFace { id: None, ruled: false, loops, trim: None, names });
                    out.faces.len() - 1
                }
            };
            face_of[k] = face;
            out.faces[face].loops.push(border);
        }
        out
    }
}

/// A curve as a cubic; `None` for a line.
fn curve<T: Real>(piece: &Bezier, place: &dyn Fn([f64; 2]) -> Vec3<T>) -> Option<SmoothPiece<T>> {
    match piece {
        Bezier::Line(_) => None,
        Bezier::Quadratic(points) => {
            let [p, q, r] = points.map(place);
            let third = T::from(2.0 / 3.0);
            Some(SmoothPiece::Cubic([p, p.lerp(q, third), r.lerp(q, third), r]))
        }
        Bezier::Cubic(points) => Some(SmoothPiece::Cubic(points.map(place))),
    }
}
