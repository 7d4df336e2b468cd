//! Bodies of sections moved through a series of positions: straight from one to the next, or turned about an axis.

use super::curve::SmoothPiece;
use super::surface::FaceSurface;
use super::{SketchSolid, SolidEdge, SolidFace, Trim, Vertex};
use crate::PointId;
use moldloft_num::{Axis as Line, Real, Vec3};
use std::sync::Arc;

/// An affine map of the section.
#[derive(Clone, Copy, Debug)]
pub(super) struct RingMap<T> {
    /// Images of the unit vectors.
    pub columns: [Vec3<T>; 3],
    /// Image of the origin.
    pub shift: Vec3<T>,
}

impl<T: Real> RingMap<T> {
    pub fn identity() -> RingMap<T> {
        let unit = |k: usize| Vec3::from([0, 1, 2].map(|j| T::from(f64::from(u8::from(j == k)))));
        RingMap { columns: [unit(0), unit(1), unit(2)], shift: Vec3::zero() }
    }

    pub fn vector(&self, v: Vec3<T>) -> Vec3<T> {
        self.columns[0] * v.x + self.columns[1] * v.y + self.columns[2] * v.z
    }

    pub fn point(&self, p: Vec3<T>) -> Vec3<T> {
        self.shift + self.vector(p)
    }

    /// This map, then another one given by its images of points.
    pub fn then(&self, map: &dyn Fn(Vec3<T>) -> Vec3<T>) -> RingMap<T> {
        let shift = map(self.shift);
        RingMap { columns: self.columns.map(|c| map(self.shift + c) - shift), shift }
    }
}

/// Motion of the section from one position to the next.
#[derive(Clone, Copy, Debug)]
pub(super) enum SweptSpan<T> {
    /// Along straight lines of one direction.
    Straight,
    /// About an axis by an angle in radians, at most a quarter turn.
    Turn(Line<T>, T),
}

/// A flat body moved by a vector; `None` if that is in its plane.
pub(super) fn extruded<T: Real>(
    section: &SketchSolid<T>,
    by: Vec3<T>,
    name: &dyn Fn(usize) -> Option<Arc<str>>,
) -> Option<SketchSolid<T>> {
    let first = RingMap::identity();
    let last = first.then(&|p| p + by);
    (by.re().norm() > 0.0).then(|| swept(section, &[first, last], &[SweptSpan::Straight], name))
}

/// The body of a section at several positions. As many motions as positions close it; otherwise it has the section at
/// both ends. `name` names the faces that edges of the section become.
pub(super) fn swept<T: Real>(
    section: &SketchSolid<T>,
    rings: &[RingMap<T>],
    spans: &[SweptSpan<T>],
    name: &dyn Fn(usize) -> Option<Arc<str>>,
) -> SketchSolid<T> {
    let (points, sides) = (section.vertices.len(), section.edges.len());
    let mut out = SketchSolid::<T>::default();
    for ring in rings {
        for v in &section.vertices {
            let id = PointId(out.vertices.len() as u32 + 1);
            out.vertices.push(Vertex { id, at: ring.point(v.at) });
        }
    }
    // First the copies of the section's edges, ring by ring, then the ways of its vertices, span by span.
    for (r, ring) in rings.iter().enumerate() {
        for edge in &section.edges {
            let ends = edge.ends.map(|v| r * points + v);
            let piece = edge.piece.map(|piece| piece.mapped(&|p| ring.point(p)));
            out.edges.push(SolidEdge { ends, piece, ..SolidEdge::default() });
        }
    }
    let ways = out.edges.len();
    for (k, span) in spans.iter().enumerate() {
        let next = (k + 1) % rings.len();
        for v in 0..points {
            let ends = [k * points + v, next * points + v];
            let piece = match span {
                SweptSpan::Straight => None,
                SweptSpan::Turn(axis, angle) => Some(arc(axis, *angle, out.vertices[ends[0]].at)),
            };
            out.edges.push(SolidEdge { ends, piece, ..SolidEdge::default() });
        }
    }
    let mut uses = vec![0; sides];
    let halves = || section.faces.iter().flat_map(|f| f.loops.iter().flatten()).copied();
    halves().for_each(|h| uses[h.0] += 1);
    // Sides that have the section on one side only.
    for (e, forward) in halves().filter(|h| uses[h.0] == 1) {
        let [a, b] = section.edges[e].ends;
        let (p, q) = if forward { (a, b) } else { (b, a) };
        for (k, span) in spans.iter().enumerate() {
            let next = (k + 1) % rings.len();
            let here = (k * sides + e, forward);
            let there = (next * sides + e, !forward);
            let way = |v: usize| ways + k * points + v;
            let straight = section.edges[e].piece.is_none();
            let (cycle, ruled, trim) = match span {
                SweptSpan::Straight => {
                    (vec![here, (way(q), true), there, (way(p), false)], !straight, None)
                }
                SweptSpan::Turn(axis, angle) => {
                    let cycle = vec![(way(q), true), there, (way(p), false), here];
                    let profile = out.piece(here);
                    if straight {
                        let along = profile.at(T::one()) - profile.at(T::zero());
                        let across =
                            along.re().dot(axis.direction.re()).abs() <= 1e-12 * along.re().norm();
                        (cycle, !across, None)
                    } else {
                        let (centre, sweep) = (axis.point, *angle);
                        let axis = axis.direction;
                        let surface = FaceSurface::Turned { centre, axis, profile, sweep };
                        out.trims.push(Trim { surface, face: out.faces.len() });
                        (cycle, false, Some(out.trims.len() - 1))
                    }
                }
            };
            let (loops, names) = (vec![cycle], name(e).into_iter().collect());
            out.faces.push(SolidFace { id: None, ruled, loops, trim, names });
        }
    }
    if spans.len() < rings.len() {
        let last = (rings.len() - 1) * sides;
        for face in &section.faces {
            let back = |c: &Vec<(usize, bool)>| c.iter().rev().map(|h| (h.0, !h.1)).collect();
            let ahead = |c: &Vec<(usize, bool)>| c.iter().map(|h| (last + h.0, h.1)).collect();
            let start: Vec<Vec<_>> = face.loops.iter().map(back).collect();
            let end: Vec<Vec<_>> = face.loops.iter().map(ahead).collect();
            for (loops, name) in [(start, "START"), (end, "END")] {
                let names = vec![name.into()];
                out.faces.push(SolidFace { id: None, ruled: false, loops, trim: None, names });
            }
        }
    }
    if out.mass().volume.re() < 0.0 {
        out.turn_over();
    }
    out
}

/// The way of a point that is turned about an axis.
fn arc<T: Real>(axis: &Line<T>, angle: T, from: Vec3<T>) -> SmoothPiece<T> {
    let centre = axis.foot(from);
    let a = from - centre;
    let (b, sweep) = match angle.re() < 0.0 {
        true => (-axis.direction.cross(a), -angle),
        false => (axis.direction.cross(a), angle),
    };
    SmoothPiece::Conic { centre, a, b, sweep }
}
