//! Sections with their sides moved, for bodies of revolution whose faces are moved.

use super::curve::SmoothPiece;
use super::edges::TreatmentFault;
use super::feature::NoBody;
use super::validity::valid;
use super::{SketchSolid, SolidEdge, Vertex};
use moldloft_num::{Axis as Line, Real, Vec3};
use std::collections::BTreeMap;

const NEXT: &str = "make it smaller, or shell the body before it is cut";

/// What a point of a moved side fulfils: a distance from a line along the normal, or from a centre.
enum MovedSide<T> {
    Straight { at: Vec3<T>, normal: Vec3<T> },
    Round { centre: Vec3<T>, radius: T },
}

impl<T: Real> MovedSide<T> {
    /// How far a point is off, and the direction in which that grows.
    fn off(&self, p: Vec3<T>) -> Option<(T, Vec3<T>)> {
        match self {
            MovedSide::Straight { at, normal } => Some((normal.dot(p - *at), *normal)),
            MovedSide::Round { centre, radius } => {
                let arm = p - *centre;
                Some((arm.norm() - *radius, arm.normalized()?))
            }
        }
    }
}

/// A section, in a plane with the line through two points, with its sides moved outwards by `shift`; sides on the line
/// are not moved.
///
/// # Errors
/// Sides that are neither straight nor arcs of circles; sides that vanish or part.
pub(super) fn moved_section<T: Real>(
    section: &SketchSolid<T>,
    line: [Vec3<T>; 2],
    shift: &dyn Fn(usize) -> T,
) -> Result<SketchSolid<T>, NoBody> {
    let fault = |text: &str, at: Option<Vec3>| NoBody::from(TreatmentFault::new(text, at, NEXT));
    let axis = Line::through(line[0], line[1]).ok_or(NoBody::Axis)?;
    let size = section.vertices.iter().map(|v| axis.foot(v.at).re().distance(v.at.re()));
    let size = size.fold(0.0, f64::max);
    let [face] = &section.faces[..] else {
        return Err(fault("a section of several faces is not moved", None));
    };
    let way: Vec<Vec3<T>> = face.loops[0].iter().flat_map(|&h| section.run(h)).collect();
    let plane = super::combine::newell(&way).normalized();
    let plane = plane.ok_or_else(|| fault("a section has no area", None))?;
    let mut sides: BTreeMap<usize, MovedSide<T>> = BTreeMap::new();
    let mut at_vertex: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for &h in face.loops.iter().flatten() {
        let (e, forward) = h;
        let ends = section.edges[e].ends;
        let [p, q] = ends.map(|v| section.vertices[v].at);
        if ends[0] == ends[1] || sides.contains_key(&e) {
            return Err(fault(
                "a side of a section is a loop, or has it on both sides",
                Some(p.re()),
            ));
        }
        let on_axis = |x: Vec3<T>| axis.foot(x).re().distance(x.re()) <= 1e-9 * size;
        let straight = section.is_straight(e);
        let by = if straight && on_axis(p) && on_axis(q) { T::zero() } else { shift(e) };
        let along = if forward { q - p } else { p - q };
        let side = match section.piece((e, forward)) {
            _ if straight => {
                let normal = along.cross(plane).normalized();
                let normal = normal
                    .ok_or_else(|| fault("a side of a section has no length", Some(p.re())))?;
                MovedSide::Straight { at: p + normal * by, normal }
            }
            SmoothPiece::Conic { centre, a, b, sweep } => {
                let radius = a.norm();
                let round = (b.norm() - radius).re().abs() <= 1e-9 * radius.re()
                    && a.dot(b).re().abs() <= 1e-9 * radius.re() * radius.re();
                // The section is to the left: outside is away from the centre of a left turn.
                let turn = a.cross(b).dot(plane).re() * sweep.re();
                let moved = if turn > 0.0 { radius + by } else { radius - by };
                if !round || moved.re() <= 0.0 {
                    return Err(fault("a round side of a section cannot be moved", Some(p.re())));
                }
                MovedSide::Round { centre, radius: moved }
            }
            SmoothPiece::Cubic(_) => {
                return Err(fault(
                    "a side of a section is neither straight nor an arc",
                    Some(p.re()),
                ));
            }
        };
        sides.insert(e, side);
        ends.iter().for_each(|v| at_vertex.entry(*v).or_default().push(e));
    }
    let mut places: BTreeMap<usize, Vec3<T>> = BTreeMap::new();
    for (&v, own) in &at_vertex {
        let old = section.vertices[v].at;
        let &[e, f] = &own[..] else {
            return Err(fault("sides of a section meet in one point twice", Some(old.re())));
        };
        let place = common([&sides[&e], &sides[&f]], old, plane, size);
        let place = place
            .ok_or_else(|| fault("sides of a section part when they are moved", Some(old.re())))?;
        places.insert(v, place);
    }
    let mut edges = Vec::new();
    for (e, edge) in section.edges.iter().enumerate() {
        let Some(side) = sides.get(&e) else {
            edges.push(edge.clone());
            continue;
        };
        let [p, q] = edge.ends.map(|v| places[&v]);
        let old = edge.ends.map(|v| section.vertices[v].at);
        let vanishes = || fault("a side of a section vanishes when it is moved", Some(old[0].re()));
        let piece = match *side {
            MovedSide::Straight { .. } => {
                if (q - p).re().dot((old[1] - old[0]).re()) <= 0.0 {
                    return Err(vanishes());
                }
                None
            }
            MovedSide::Round { centre, .. } => {
                let SmoothPiece::Conic { a, b, sweep, .. } = section.piece((e, true)) else {
                    return Err(vanishes());
                };
                let turn = a.cross(b) * sweep;
                let direction = turn.normalized().ok_or_else(vanishes)?;
                let (from, to) = (p - centre, q - centre);
                let angle = direction.dot(from.cross(to)).atan2(from.dot(to));
                let full = 2.0 * std::f64::consts::PI;
                let angle = if angle.re() <= 0.0 { angle + full } else { angle };
                // A side that has turned inside out goes nearly the whole way round.
                if (angle.re() - sweep.re().abs()).abs() > std::f64::consts::PI {
                    return Err(vanishes());
                }
                Some(SmoothPiece::Conic { centre, a: from, b: direction.cross(from), sweep: angle })
            }
        };
        edges.push(SolidEdge { ends: edge.ends, piece, curve: edge.curve, trace: None });
    }
    let vertex = |(k, v): (usize, &Vertex<T>)| Vertex {
        id: v.id,
        at: places.get(&k).copied().unwrap_or(v.at),
    };
    let vertices = section.vertices.iter().enumerate().map(vertex).collect();
    valid(SketchSolid { vertices, edges, ..section.clone() }).map_err(NoBody::Flaw)
}

/// The point of two moved sides near an old one, in the plane of the section.
fn common<T: Real>(
    [a, b]: [&MovedSide<T>; 2],
    old: Vec3<T>,
    plane: Vec3<T>,
    size: f64,
) -> Option<Vec3<T>> {
    let mut p = old;
    for _ in 0..40 {
        let ((r, m), (s, n)) = (a.off(p)?, b.off(p)?);
        let det = plane.dot(m.cross(n));
        if det.re().abs() < 1e-7 {
            // Tangent sides move together, or part.
            let moved = p - m * r;
            let rest = b.off(moved)?.0;
            return (rest.re().abs() <= 1e-9 * size).then_some(moved);
        }
        let step = (n.cross(plane) * r + plane.cross(m) * s) / det;
        p -= step;
        if !p.is_finite() || p.re().distance(old.re()) > 10.0 * size {
            return None;
        }
    }
    let (r, s) = (a.off(p)?.0, b.off(p)?.0);
    (r.re().abs().max(s.re().abs()) <= 1e-9 * size).then_some(p)
}
