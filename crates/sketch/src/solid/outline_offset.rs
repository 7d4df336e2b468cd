//! Offsets of outlines: a section with a margin around it, or without a margin along its border.
//!
//! Each side moves along its normal, lines to lines and arcs to arcs; round corners get arcs, mitred ones the straight
//! continuation of their sides. The moved sides are divided at their crossings, and the pieces that no point of the
//! margin covers are the new border (W. Tiller and E. G. Hanson, Offsets of two-dimensional profiles, IEEE Computer
//! Graphics and Applications 4, 1984). Crossings are found with numbers, the corners then with derivatives.

use super::edges::TreatmentFault;
use super::outline_pieces::{BorderPiece, Margin, border};
use super::outline_sides::{BorderSide, SideArc, outline_sides};
use super::{SketchSolid, SolidEdge, SolidFace, Vertex};
use crate::PointId;
use crate::feature::OffsetCorner;
use moldloft_num::{Real, Vec3};
use moldloft_syntax::number::plain;
use std::sync::Arc;

/// Cosine of the angle between two sides below which a mitre has no end.
const REVERSAL: f64 = -1.0 + 1e-9;

/// Sine of the angle between two sides below which they continue each other.
pub(super) const SMOOTH: f64 = 1e-9;

/// Sine of the angle below which neighbours that cross are cut at their crossing first.
const SLIGHT: f64 = 1e-2;

/// Relative width of the interval in which the largest inward distance is searched.
const DISTANCE_WIDTH: f64 = 1e-9;

/// A section with its border moved outwards by a distance, inwards if it is negative. `name` names the sides of the section.
pub(super) fn offset_outline<T: Real>(
    section: &SketchSolid<T>,
    by: T,
    corner: OffsetCorner,
    name: &dyn Fn(usize) -> Option<Arc<str>>,
) -> Result<SketchSolid<T>, TreatmentFault> {
    let outline = outline_sides(section, name)?;
    if by.re() == 0.0 || !by.re().is_finite() {
        return Err(TreatmentFault::new(
            format!("an offset of {}", plain(by.re())),
            None,
            "give a distance, negative for inwards",
        ));
    }
    let plane = outline.plane;
    let moved = moved_sides(&outline.loops, by, corner, plane)?;
    let loops = outline.loops.iter().map(|l| l.iter().map(BorderSide::re).collect()).collect();
    let margin = Margin { by: by.re(), mitred: corner == OffsetCorner::Mitred, loops, plane };
    let plain_moved: Vec<BorderSide<f64>> = moved.iter().map(BorderSide::re).collect();
    let found = border(&plain_moved, &margin, outline.size)?;
    if found.is_empty() {
        let largest = largest(&margin, corner, outline.size)?;
        return Err(TreatmentFault::new(
            format!("an inward offset of {} leaves nothing", plain(-by.re())),
            None,
            format!("the largest distance is below {}", plain(largest)),
        ));
    }
    let loops = found.iter().map(|cycle| exact_loop(cycle, &moved, plane, outline.size));
    finished(&loops.collect::<Result<Vec<_>, _>>()?, plane)
}

/// The distance at which an inward offset vanishes, rounded down.
fn largest(margin: &Margin, corner: OffsetCorner, size: f64) -> Result<f64, TreatmentFault> {
    let (mut low, mut high) = (0.0, -margin.by);
    while high - low > DISTANCE_WIDTH * high {
        let middle = 0.5 * (low + high);
        let tried = Margin { by: -middle, ..margin.clone() };
        let moved = moved_sides(&tried.loops, -middle, corner, tried.plane)?;
        match border(&moved, &tried, size) {
            Ok(found) if found.is_empty() => high = middle,
            _ => low = middle,
        }
    }
    // The interval contains it: the upper end in seven figures is it within its width.
    Ok(format!("{high:.6e}").parse().unwrap_or(high))
}

/// The sides of all loops moved by a distance, with what joins them at corners.
fn moved_sides<T: Real>(
    loops: &[Vec<BorderSide<T>>],
    by: T,
    corner: OffsetCorner,
    plane: Vec3,
) -> Result<Vec<BorderSide<T>>, TreatmentFault> {
    let mut all = Vec::new();
    for sides in loops {
        let n = sides.len();
        let mut own: Vec<Option<BorderSide<T>>> =
            sides.iter().map(|s| s.moved(by, plane)).collect();
        let mut joints: Vec<Vec<BorderSide<T>>> = vec![Vec::new(); n];
        for k in 0..n {
            let next = (k + 1) % n;
            let (a, b) = (&sides[k], &sides[next]);
            let (m, q) = (a.normal(1, plane), b.normal(0, plane));
            let turn = Vec3::lifted(plane).dot(m.cross(q));
            let separate = turn.re() * by.re() > 0.0 || m.re().dot(q.re()) < REVERSAL;
            let at = a.ends[1];
            if !separate && (SMOOTH..SLIGHT).contains(&turn.re().abs()) {
                // What is cut off there is too small to be found by its depth.
                let short = 2.0 * (turn.re() * by.re()).abs();
                let guess = at + (m + q) * (by / (m.dot(q) + 1.0));
                let long = [k, next].into_iter().all(|s| sides[s].re().length() > short);
                if long
                    && let [Some(a), Some(b)] = [k, next].map(|s| own[s].clone())
                    && let Some(tip) = common_point(&a, &b, guess, plane)
                {
                    own[k] = Some(a.ending([a.ends[0], tip], plane));
                    own[next] = Some(b.ending([tip, b.ends[1]], plane));
                }
            }
            if turn.re().abs() <= SMOOTH && m.re().dot(q.re()) > 0.0 || !separate {
                continue;
            }
            let name = joined_name(a, b);
            let [from, to] = [m, q].map(|normal| at + normal * by);
            match corner {
                OffsetCorner::Round => {
                    let sweep = turn.abs().atan2(m.dot(q));
                    let arc = SideArc { centre: at, radius: by.abs(), left: by.re() > 0.0, sweep };
                    joints[k].push(BorderSide { ends: [from, to], arc: Some(arc), name });
                }
                OffsetCorner::Mitred => {
                    if m.re().dot(q.re()) < REVERSAL {
                        return Err(TreatmentFault::new(
                            "the sides of a corner turn back, so a mitre has no end",
                            Some(at.re()),
                            "use ROUND, or round the corner with ARC",
                        ));
                    }
                    let tip = at + (m + q) * (by / (m.dot(q) + 1.0));
                    for (side, end, ends) in [(k, 1, [from, tip]), (next, 0, [tip, to])] {
                        match &mut own[side] {
                            Some(moved) if moved.arc.is_none() => moved.ends[end] = tip,
                            _ => joints[k].push(BorderSide { ends, arc: None, name: name.clone() }),
                        }
                    }
                }
            }
        }
        for (side, joint) in own.into_iter().zip(joints) {
            all.extend(side);
            all.extend(joint);
        }
    }
    Ok(all)
}

fn joined_name<T>(a: &BorderSide<T>, b: &BorderSide<T>) -> Option<Arc<str>> {
    Some(format!("{}+{}", a.name.as_deref()?, b.name.as_deref()?).into())
}

/// A loop of pieces as sides with derivatives.
fn exact_loop<T: Real>(
    cycle: &[BorderPiece],
    moved: &[BorderSide<T>],
    plane: Vec3,
    size: f64,
) -> Result<Vec<BorderSide<T>>, TreatmentFault> {
    let n = cycle.len();
    let mut corners = Vec::new();
    for k in 0..n {
        let (before, here) = (&cycle[(k + n - 1) % n], &cycle[k]);
        let (a, b) = (&moved[before.side], &moved[here.side]);
        let at = corner_of(a, b, here.from, plane, size).ok_or_else(|| {
            TreatmentFault::new(
                "the moved sides do not meet clearly",
                Some(here.from),
                "change the distance a little",
            )
        })?;
        corners.push(at);
    }
    let side = |(k, piece): (usize, &BorderPiece)| {
        moved[piece.side].ending([corners[k], corners[(k + 1) % n]], plane)
    };
    Ok(cycle.iter().enumerate().map(side).collect())
}

/// The point at which one moved side ends and another starts, near a place.
fn corner_of<T: Real>(
    a: &BorderSide<T>,
    b: &BorderSide<T>,
    place: Vec3,
    plane: Vec3,
    size: f64,
) -> Option<Vec3<T>> {
    let near = |p: Vec3<T>| p.re().distance(place) <= 1e-8 * size;
    if near(a.ends[1]) && near(b.ends[0]) {
        return Some(a.ends[1]);
    }
    // In the plane of the sides.
    let normal = Vec3::lifted(plane);
    let mut start = Vec3::lifted(place);
    start += normal * normal.dot(a.ends[1] - start);
    let found = common_point(a, b, start, plane);
    let found = found.filter(|p| p.re().distance(place) <= 1e-6 * size);
    // Of tangent sides, an end is nearer than their crossing can be found.
    found.or_else(|| [a.ends[1], b.ends[0]].into_iter().find(|e| near(*e)))
}

/// The common point of the lines or circles of two sides near another one.
fn common_point<T: Real>(
    a: &BorderSide<T>,
    b: &BorderSide<T>,
    start: Vec3<T>,
    plane: Vec3,
) -> Option<Vec3<T>> {
    let (normal, mut p) = (Vec3::lifted(plane), start);
    for _ in 0..8 {
        let ((r, m), (s, q)) = (a.residual(p, plane)?, b.residual(p, plane)?);
        let det = normal.dot(m.cross(q));
        if det.re().abs() < SMOOTH {
            return None;
        }
        p -= (q.cross(normal) * r + normal.cross(m) * s) / det;
    }
    p.is_finite().then_some(p)
}

/// Loops as a flat body: those around a region, each with its holes.
fn finished<T: Real>(
    loops: &[Vec<BorderSide<T>>],
    plane: Vec3,
) -> Result<SketchSolid<T>, TreatmentFault> {
    let mut out = SketchSolid::<T> { flat: true, ..SketchSolid::default() };
    let plain: Vec<Vec<BorderSide<f64>>> =
        loops.iter().map(|l| l.iter().map(BorderSide::re).collect()).collect();
    let areas: Vec<f64> = plain.iter().map(|l| BorderSide::area(l, plane)).collect();
    let mut face_of: Vec<Option<usize>> = vec![None; loops.len()];
    for k in 0..loops.len() {
        if areas[k] > 0.0 {
            face_of[k] = Some(out.faces.len());
            let loops = vec![put_loop(&mut out, &loops[k], plane)];
            out.faces.push(SolidFace { id: None, ruled: false, loops, trim: None, names: vec![] });
        }
    }
    for k in 0..loops.len() {
        if areas[k] > 0.0 {
            continue;
        }
        let at = plain[k][0].at(0.5, plane);
        let around = (0..loops.len())
            .filter(|&j| areas[j] > 0.0 && BorderSide::winding(&plain[j], at, plane) != 0);
        let outer = around.min_by(|&i, &j| areas[i].total_cmp(&areas[j]));
        let Some(face) = outer.and_then(|j| face_of[j]) else {
            return Err(TreatmentFault::new(
                "the moved border does not close",
                Some(at),
                "change the distance a little",
            ));
        };
        let hole = put_loop(&mut out, &loops[k], plane);
        out.faces[face].loops.push(hole);
    }
    Ok(out)
}

/// Adds the vertices and edges of a loop; arcs of more than a quarter turn become several.
fn put_loop<T: Real>(
    out: &mut SketchSolid<T>,
    sides: &[BorderSide<T>],
    plane: Vec3,
) -> Vec<(usize, bool)> {
    let mut points: Vec<(Vec3<T>, Option<SideArc<T>>, Option<Arc<str>>)> = Vec::new();
    for side in sides {
        let Some(arc) = &side.arc else {
            points.push((side.ends[0], None, side.name.clone()));
            continue;
        };
        let parts = (arc.sweep.re() / std::f64::consts::FRAC_PI_2 - 1e-9).ceil().max(1.0);
        let sweep = arc.sweep * (1.0 / parts);
        for part in 0..parts as usize {
            let piece = side.arc_piece(arc, plane).at(T::from(part as f64 / parts));
            let at = if part == 0 { side.ends[0] } else { piece };
            points.push((at, Some(SideArc { sweep, ..*arc }), side.name.clone()));
        }
    }
    let (first, n) = (out.vertices.len(), points.len());
    for (at, ..) in &points {
        out.vertices.push(Vertex { id: PointId(out.vertices.len() as u32 + 1), at: *at });
    }
    let mut cycle = Vec::new();
    for (k, (at, arc, name)) in points.into_iter().enumerate() {
        let ends = [first + k, first + (k + 1) % n];
        let side = BorderSide { ends: [at, out.vertices[ends[1]].at], arc, name };
        let piece = side.arc.as_ref().map(|arc| side.arc_piece(arc, plane));
        cycle.push((out.edges.len(), true));
        out.edges.push(SolidEdge { ends, piece, name: side.name, ..SolidEdge::default() });
    }
    cycle
}
