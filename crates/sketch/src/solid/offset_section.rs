//! Sections with their sides moved, for bodies of revolution whose faces are moved.

use super::curve::SmoothPiece;
use super::validity::valid;
use super::{SketchSolid, SolidEdge, Vertex};
use moldloft_num::{Axis as Line, Real, Vec3};
use std::collections::BTreeMap;

/// Equation of a moved side: a distance from a line along the normal, or from a centre.
enum MovedSide<T> {
    Straight { at: Vec3<T>, normal: Vec3<T> },
    Round { centre: Vec3<T>, radius: T },
}

impl<T: Real> MovedSide<T> {
    /// Residual of a point, and its gradient direction.
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
/// are not moved. `None` where sides are neither straight nor arcs of circles, vanish or part.
pub(super) fn moved_section<T: Real>(
    section: &SketchSolid<T>,
    line: [Vec3<T>; 2],
    shift: &dyn Fn(usize) -> T,
) -> Option<SketchSolid<T>> {
    let axis = Line::through(line[0], line[1])?;
    let size = section.vertices.iter().map(|v| axis.foot(v.at).re().distance(v.at.re()));
    let size = size.fold(0.0, f64::max);
    let [face] = &section.faces[..] else {
        return None;
    };
    let way: Vec<Vec3<T>> = face.loops[0].iter().flat_map(|&h| section.run(h)).collect();
    let plane = super::facet_source::newell(&way).normalized()?;
    let mut sides: BTreeMap<usize, MovedSide<T>> = BTreeMap::new();
    let mut at_vertex: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for &h in face.loops.iter().flatten() {
        let (e, forward) = h;
        let ends = section.edges[e].ends;
        let [p, q] = ends.map(|v| section.vertices[v].at);
        if ends[0] == ends[1] || sides.contains_key(&e) {
            return None;
        }
        let on_axis = |x: Vec3<T>| axis.foot(x).re().distance(x.re()) <= 1e-9 * size;
        let straight = section.is_straight(e);
        let by = if straight && on_axis(p) && on_axis(q) { T::zero() } else { shift(e) };
        let along = if forward { q - p } else { p - q };
        let side = match section.piece((e, forward)) {
            _ if straight => {
                let normal = along.cross(plane).normalized()?;
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
                    return None;
                }
                MovedSide::Round { centre, radius: moved }
            }
            SmoothPiece::Cubic(_) => {
                return None;
            }
        };
        sides.insert(e, side);
        ends.iter().for_each(|v| at_vertex.entry(*v).or_default().push(e));
    }
    let mut places: BTreeMap<usize, Vec3<T>> = BTreeMap::new();
    for (&v, own) in &at_vertex {
        let old = section.vertices[v].at;
        let &[e, f] = &own[..] else {
            return None;
        };
        places.insert(v, common([&sides[&e], &sides[&f]], old, plane, size)?);
    }
    let mut edges = Vec::new();
    for (e, edge) in section.edges.iter().enumerate() {
        let Some(side) = sides.get(&e) else {
            edges.push(edge.clone());
            continue;
        };
        let [p, q] = edge.ends.map(|v| places[&v]);
        let old = edge.ends.map(|v| section.vertices[v].at);
        let piece = match *side {
            MovedSide::Straight { .. } => {
                if (q - p).re().dot((old[1] - old[0]).re()) <= 0.0 {
                    return None;
                }
                None
            }
            MovedSide::Round { centre, .. } => {
                let SmoothPiece::Conic { a, b, sweep, .. } = section.piece((e, true)) else {
                    return None;
                };
                let turn = a.cross(b) * sweep;
                let direction = turn.normalized()?;
                let (from, to) = (p - centre, q - centre);
                let angle = direction.dot(from.cross(to)).atan2(from.dot(to));
                let full = 2.0 * std::f64::consts::PI;
                let angle = if angle.re() <= 0.0 { angle + full } else { angle };
                // An inverted side has an angle of nearly a full turn.
                if (angle.re() - sweep.re().abs()).abs() > std::f64::consts::PI {
                    return None;
                }
                Some(SmoothPiece::Conic { centre, a: from, b: direction.cross(from), sweep: angle })
            }
        };
        edges.push(SolidEdge { ends: edge.ends, piece, curve: edge.curve, ..SolidEdge::default() });
    }
    let vertex = |(k, v): (usize, &Vertex<T>)| Vertex {
        id: v.id,
        at: places.get(&k).copied().unwrap_or(v.at),
    };
    let vertices = section.vertices.iter().enumerate().map(vertex).collect();
    valid(SketchSolid { vertices, edges, ..section.clone() }).ok()
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
