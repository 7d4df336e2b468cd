//! Bodies between convex sections in parallel planes.
//!
//! Points of two sections with one outward normal are joined: parallel sides by planes, arcs by cones, a side or an arc
//! with a corner that has its normals by a triangle or a cone. The body between two sections is their convex hull.

use super::edges::TreatmentFault;
use super::outline_sides::{BorderSide, SectionOutlines};
use super::{SketchSolid, SolidEdge, SolidFace, Vertex};
use crate::PointId;
use moldloft_num::{Real, Vec3};
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Angle within which normals are one, and relative distance within which points are.
const SAME: f64 = 1e-9;

/// A convex outline divided at common normals: of each interval of normals its ends and its arc, if it is not a corner.
struct LoftOutline<T> {
    spans: Vec<LoftSpan<T>>,
    /// For each normal, the name of the side that has it.
    sides: Vec<Option<Arc<str>>>,
}

struct LoftSpan<T> {
    ends: [Vec3<T>; 2],
    /// The side with the arc.
    arc: Option<BorderSide<T>>,
}

/// A section as a loop of the body: the vertices at the ends of each span, and the edges of its spans and of the sides
/// before them.
struct LoftRing {
    ends: Vec<[usize; 2]>,
    arcs: Vec<Option<usize>>,
    sides: Vec<Option<usize>>,
}

/// The body between sections in this order.
pub(super) fn lofted<T: Real>(
    sections: &[SectionOutlines<T>],
) -> Result<SketchSolid<T>, TreatmentFault> {
    let plane = sections[0].plane;
    for (k, section) in sections.iter().enumerate() {
        let [sides] = &section.loops[..] else {
            let text = format!("section {} has {} outlines", k + 1, section.loops.len());
            let next = "LOFT one outline at a time, and CUT what is inside";
            return Err(TreatmentFault::new(text, None, next));
        };
        if section.plane.dot(plane) < 0.5 {
            return Err(TreatmentFault::new(
                format!("section {} is not parallel to the first", k + 1),
                Some(sides[0].ends[0].re()),
                "draw all sections in planes of one name",
            ));
        }
        convex(sides, plane, k)?;
    }
    let level = |k: usize| plane.dot(sections[k].loops[0][0].ends[0].re());
    let way = (level(sections.len() - 1) - level(0)).signum();
    let size = sections.iter().map(|s| s.size).fold(0.0, f64::max);
    for k in 1..sections.len() {
        if (level(k) - level(k - 1)) * way <= SAME * size {
            return Err(TreatmentFault::new(
                format!("section {} is not beyond section {k}", k + 1),
                Some(sections[k].loops[0][0].ends[0].re()),
                "give the sections in order; REFERENCE and MOVE place them",
            ));
        }
    }
    let normals = normals(sections, plane);
    let outlines: Vec<LoftOutline<T>> =
        sections.iter().map(|s| divided(&s.loops[0], &normals, plane, size)).collect();
    Ok(joined(&outlines, plane, size))
}

/// Refuses an outline with an inner corner or arc.
fn convex<T: Real>(sides: &[BorderSide<T>], plane: Vec3, k: usize) -> Result<(), TreatmentFault> {
    let n = sides.len();
    let hollow = (0..n).find(|&j| {
        let (a, b) = (&sides[j], &sides[(j + 1) % n]);
        let turn = plane.dot(a.normal(1, plane).re().cross(b.normal(0, plane).re()));
        turn < -SAME || a.arc.as_ref().is_some_and(|arc| !arc.left)
    });
    match hollow {
        None => Ok(()),
        Some(j) => Err(TreatmentFault::new(
            format!("section {} is not convex", k + 1),
            Some(sides[j].ends[1].re()),
            "LOFT convex parts, and unite or cut them",
        )),
    }
}

/// Angle of a normal in the plane, from 0 to a full turn.
fn angle_of(normal: Vec3, plane: Vec3) -> f64 {
    let first = plane.perpendicular();
    let angle = Real::atan2(normal.dot(plane.cross(first)), normal.dot(first));
    let angle = if angle < 0.0 { angle + TAU } else { angle };
    if angle > TAU - SAME { 0.0 } else { angle }
}

/// The normals of all sides and ends of arcs, by their angles.
fn normals<T: Real>(sections: &[SectionOutlines<T>], plane: Vec3) -> Vec<(f64, Vec3<T>)> {
    let mut all: Vec<(f64, Vec3<T>)> = Vec::new();
    for side in sections.iter().flat_map(|s| &s.loops[0]) {
        let ends = if side.arc.is_some() { 2 } else { 1 };
        for end in 0..ends {
            let normal = side.normal(end, plane);
            all.push((angle_of(normal.re(), plane), normal));
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.dedup_by(|a, b| a.0 - b.0 <= SAME);
    all
}

/// An outline divided at normals.
fn divided<T: Real>(
    sides: &[BorderSide<T>],
    normals: &[(f64, Vec3<T>)],
    plane: Vec3,
    size: f64,
) -> LoftOutline<T> {
    let n = normals.len();
    let first = plane.perpendicular();
    let mut spans = Vec::new();
    for i in 0..n {
        let from = normals[i].0;
        let to = if i + 1 < n { normals[i + 1].0 } else { normals[0].0 + TAU };
        let middle = 0.5 * (from + to);
        let toward = first * Real::cos(middle) + plane.cross(first) * Real::sin(middle);
        let arc = sides.iter().find(|side| {
            let Some(arc) = &side.arc else { return false };
            let start = angle_of(side.normal(0, plane).re(), plane);
            let into = (middle - start).rem_euclid(TAU);
            into < arc.sweep.re()
        });
        let ends = match arc.and_then(|side| side.arc.as_ref()) {
            Some(arc) => [i, (i + 1) % n].map(|k| arc.centre + normals[k].1 * arc.radius),
            None => {
                // The corner that is farthest in that direction.
                let reach = |s: &&BorderSide<T>| s.ends[0].re().dot(toward);
                let far = sides.iter().max_by(|a, b| reach(a).total_cmp(&reach(b)));
                [far.map(|s| s.ends[0]).unwrap_or_default(); 2]
            }
        };
        spans.push(LoftSpan { ends, arc: arc.cloned() });
    }
    let name = |i: usize| -> Option<Arc<str>> {
        let before = spans[(i + n - 1) % n].ends[1];
        let here = spans[i].ends[0];
        if before.re().distance(here.re()) <= SAME * size {
            return None;
        }
        let side = sides.iter().find(|s| {
            s.arc.is_none() && s.normal(0, plane).re().dot(normals[i].1.re()) > 1.0 - SAME
        });
        side.and_then(|s| s.name.clone())
    };
    let sides = (0..n).map(name).collect();
    LoftOutline { spans, sides }
}

/// The body of divided outlines.
fn joined<T: Real>(outlines: &[LoftOutline<T>], plane: Vec3, size: f64) -> SketchSolid<T> {
    let mut out = SketchSolid::<T>::default();
    let rings: Vec<LoftRing> =
        outlines.iter().map(|outline| ring(outline, plane, size, &mut out)).collect();
    let mut lines: HashMap<[usize; 2], usize> = HashMap::new();
    for k in 1..rings.len() {
        let (a, b) = (&rings[k - 1], &rings[k]);
        let n = a.ends.len();
        let mut line = |ends: [usize; 2]| {
            *lines.entry(ends).or_insert_with(|| {
                out.edges.push(SolidEdge { ends, ..SolidEdge::default() });
                out.edges.len() - 1
            })
        };
        let mut faces = Vec::new();
        for i in 0..n {
            // The side before a span, then the span itself.
            let before = (i + n - 1) % n;
            let side = [a.sides[i], b.sides[i]];
            let corners = [[a.ends[before][1], b.ends[before][1]], [a.ends[i][0], b.ends[i][0]]];
            let names = [k - 1, k].map(|j| outlines[j].sides[i].clone());
            faces.push((side, corners, false, names));
            let arc = [a.arcs[i], b.arcs[i]];
            let corners = [[a.ends[i][0], b.ends[i][0]], [a.ends[i][1], b.ends[i][1]]];
            let names = [k - 1, k].map(|j| {
                let arc = outlines[j].spans[i].arc.as_ref();
                arc.and_then(|s| s.name.clone())
            });
            faces.push((arc, corners, true, names));
        }
        let mut made = Vec::new();
        for (edges, [start, end], ruled, names) in faces {
            let cycle = match edges {
                [None, None] => continue,
                [Some(a), Some(b)] => {
                    vec![(a, true), (line(end), true), (b, false), (line(start), false)]
                }
                [Some(a), None] => vec![(a, true), (line(end), true), (line(start), false)],
                [None, Some(b)] => vec![(b, false), (line(start), false), (line(end), true)],
            };
            let names = names.into_iter().flatten().take(1).collect();
            made.push(SolidFace { id: None, ruled, loops: vec![cycle], trim: None, names });
        }
        out.faces.extend(made);
    }
    for (ring, name) in [(&rings[0], "START"), (&rings[rings.len() - 1], "END")] {
        let mut cycle: Vec<(usize, bool)> = (ring.sides.iter().zip(&ring.arcs))
            .flat_map(|(side, arc)| [*side, *arc])
            .flatten()
            .map(|e| (e, true))
            .collect();
        if name == "START" {
            cycle.reverse();
            cycle.iter_mut().for_each(|h| h.1 = false);
        }
        let (loops, names) = (vec![cycle], vec![name.into()]);
        out.faces.push(SolidFace { id: None, ruled: false, loops, trim: None, names });
    }
    if out.mass().volume.re() < 0.0 {
        out.turn_over();
    }
    out
}

/// Adds the vertices and edges of an outline.
fn ring<T: Real>(
    outline: &LoftOutline<T>,
    plane: Vec3,
    size: f64,
    out: &mut SketchSolid<T>,
) -> LoftRing {
    let n = outline.spans.len();
    let mut points: Vec<(usize, Vec3<T>)> = Vec::new();
    let mut vertex = |at: Vec3<T>, out: &mut SketchSolid<T>| {
        let known = points.iter().find(|p| p.1.re().distance(at.re()) <= SAME * size);
        if let Some((v, _)) = known {
            return *v;
        }
        out.vertices.push(Vertex { id: PointId(out.vertices.len() as u32 + 1), at });
        points.push((out.vertices.len() - 1, at));
        out.vertices.len() - 1
    };
    let ends: Vec<[usize; 2]> =
        outline.spans.iter().map(|span| span.ends.map(|at| vertex(at, out))).collect();
    let (mut arcs, mut sides) = (Vec::new(), Vec::new());
    for (i, span) in outline.spans.iter().enumerate() {
        let before = ends[(i + n - 1) % n][1];
        let side = (before != ends[i][0]).then(|| {
            let ends = [before, ends[i][0]];
            out.edges.push(SolidEdge { ends, ..SolidEdge::default() });
            out.edges.len() - 1
        });
        sides.push(side);
        let arc = span.arc.as_ref().map(|side| side.ending(span.ends, plane));
        let arc = arc.filter(|_| ends[i][0] != ends[i][1]);
        arcs.push(arc.and_then(|side| {
            let piece = side.arc_piece(side.arc.as_ref()?, plane);
            out.edges.push(SolidEdge { ends: ends[i], piece: Some(piece), ..SolidEdge::default() });
            Some(out.edges.len() - 1)
        }));
    }
    LoftRing { ends, arcs, sides }
}
