//! Bodies with some of their faces moved: hollowed to a wall, or drafted. Vertices follow as points that their
//! faces have in common, with derivatives.

use super::combine::combined;
use super::curve::SmoothPiece;
use super::edges::{FaceForm, TreatmentFault};
use super::feature::NoBody;
use super::operation::Operation;
use super::validity::valid;
use super::{SketchSolid, SolidEdge, SolidFace, Vertex};
use crate::CoordinateAxis;
use crate::feature::FaceChoice;
use moldloft_num::{Axis as Line, Real, Vec3};
use std::collections::{BTreeMap, BTreeSet};

const PLAIN: &str =
    "shell or draft it before it is united with others or rounded, or choose other faces";

/// A plane that a face is moved into: a point and the outward unit normal.
type FacePlane<T> = (Vec3<T>, Vec3<T>);

/// A body with its faces moved outwards by a distance, but for those of some names, made of the parts that the body is
/// made of.
pub(crate) type MovedParts<'a, T> =
    dyn Fn(T, &BTreeSet<String>) -> Result<SketchSolid<T>, NoBody> + 'a;

/// The body hollowed to a wall of a given thickness, without a wall at the faces of `open`. A
/// negative thickness gives an outer wall. If faces cannot be offset directly, those of its parts
/// are.
///
/// # Errors
/// A thickness that does not fit; faces that are neither planes nor plain cylinders, nor of parts that are moved.
pub(crate) fn shelled<T: Real>(
    body: &SketchSolid<T>,
    thickness: T,
    open: &[FaceChoice],
    parts: &MovedParts<'_, T>,
) -> Result<SketchSolid<T>, NoBody> {
    if thickness.re() == 0.0 || !thickness.is_finite() {
        let text = format!("a wall of {} is none", thickness.re());
        return Err(TreatmentFault::new(text, None, "give a thickness").into());
    }
    let mut left_out = BTreeSet::new();
    for choice in open {
        left_out.extend(body.chosen_faces(choice)?);
    }
    if left_out.len() == body.faces.len() {
        return Err(
            TreatmentFault::new("no face is left for a wall", None, "open fewer faces").into()
        );
    }
    let shift = |f: usize| if left_out.contains(&f) { T::zero() } else { -thickness };
    let other = match moved(body, &shift) {
        Ok(other) => other,
        Err(first) => {
            let of = |f: &usize| body.faces[*f].names.iter().map(|n| n.to_string());
            let still: BTreeSet<String> = left_out.iter().flat_map(of).collect();
            let others = |f: &usize| !left_out.contains(f) && of(f).any(|n| still.contains(&n));
            if left_out.iter().any(|f| body.faces[*f].names.is_empty())
                || (0..body.faces.len()).any(|f| others(&f))
            {
                return Err(first);
            }
            parts(-thickness, &still).map_err(|_| first)?
        }
    };
    let pair = if thickness.re() > 0.0 { [body, &other] } else { [&other, body] };
    combined(pair, Operation::Cut).map_err(NoBody::Combine)
}

/// The body with plane faces rotated by an angle in radians about their lines of intersection with
/// the plane at a coordinate, so that it becomes narrower along the axis; by default all faces
/// parallel to the axis.
///
/// # Errors
/// Faces that are not plane, or square to the axis; angles with which faces vanish.
pub(crate) fn drafted<T: Real>(
    body: &SketchSolid<T>,
    angle: T,
    axis: CoordinateAxis,
    at: T,
    faces: &[FaceChoice],
) -> Result<SketchSolid<T>, NoBody> {
    if angle.re().is_nan() || angle.re().abs() >= std::f64::consts::FRAC_PI_2 {
        let text = format!("a draft of {} degrees", angle.re().to_degrees());
        return Err(TreatmentFault::new(text, None, "give an angle between -90 and 90").into());
    }
    let k = axis.index();
    let mut unit = [T::zero(); 3];
    unit[k] = T::one();
    let unit = Vec3::from(unit);
    let mut chosen = BTreeSet::new();
    for choice in faces {
        chosen.extend(body.chosen_faces(choice)?);
    }
    if faces.is_empty() {
        let upright = |f: &usize| matches!(body.form(*f), FaceForm::Plane { normal, .. } if normal[k].re().abs() < 1e-9);
        chosen.extend((0..body.faces.len()).filter(upright));
    }
    if chosen.is_empty() {
        let text = format!("no face is parallel to {axis}");
        return Err(TreatmentFault::new(text, None, "choose FACES").into());
    }
    let mut planes: BTreeMap<usize, FacePlane<T>> = BTreeMap::new();
    for f in 0..body.faces.len() {
        let FaceForm::Plane { at: base, normal } = body.form(f) else {
            let place = body.faces[f].loops.iter().flatten().next();
            let place = place.map(|h| body.vertices[body.edges[h.0].ends[0]].at.re());
            return Err(TreatmentFault::new(
                "a round face is not drafted",
                place,
                "draft the body before its edges are rounded",
            )
            .into());
        };
        let plane = if chosen.contains(&f) {
            let up = (unit - normal * normal.dot(unit)).normalized().filter(|u| u[k].re() > 1e-9);
            let Some(up) = up else {
                let text = format!("a face square to {axis} is not drafted along it");
                return Err(TreatmentFault::new(
                    text,
                    Some(base.re()),
                    "choose faces along the axis",
                )
                .into());
            };
            let neutral = base + up * ((at - base[k]) / up[k]);
            (neutral, normal * angle.cos() + up * angle.sin())
        } else {
            (base, normal)
        };
        planes.insert(f, plane);
    }
    let around = faces_around(body);
    let mut at = Vec::new();
    for (v, vertex) in body.vertices.iter().enumerate() {
        at.push(common_point(&around[v], &planes, vertex.at, body)?);
    }
    whole(rebuilt(body, at)?)
}

/// A body that must be as it is: one that crosses itself is refused.
fn whole<T: Real>(body: SketchSolid<T>) -> Result<SketchSolid<T>, NoBody> {
    let faces = body.faces.len();
    let made = valid(body).map_err(NoBody::Flaw)?;
    if made.faces.len() != faces {
        let next = "make it smaller, or change the dimensions";
        return Err(
            TreatmentFault::new("faces pass each other when they are moved", None, next).into()
        );
    }
    Ok(made)
}

fn faces_around<T: Real>(body: &SketchSolid<T>) -> Vec<BTreeSet<usize>> {
    let mut around = vec![BTreeSet::new(); body.vertices.len()];
    for (f, face) in body.faces.iter().enumerate() {
        for h in face.loops.iter().flatten() {
            for v in body.edges[h.0].ends {
                around[v].insert(f);
            }
        }
    }
    around
}

/// The point that planes have in common.
fn common_point<T: Real>(
    faces: &BTreeSet<usize>,
    planes: &BTreeMap<usize, FacePlane<T>>,
    old: Vec3<T>,
    body: &SketchSolid<T>,
) -> Result<Vec3<T>, NoBody> {
    let all: Vec<FacePlane<T>> = faces.iter().map(|f| planes[f]).collect();
    let mut best: Option<(f64, [FacePlane<T>; 3])> = None;
    for i in 0..all.len() {
        for j in i + 1..all.len() {
            for k in j + 1..all.len() {
                let [a, b, c] = [all[i], all[j], all[k]];
                let det = a.1.re().dot(b.1.re().cross(c.1.re())).abs();
                if best.as_ref().is_none_or(|b| det > b.0) {
                    best = Some((det, [a, b, c]));
                }
            }
        }
    }
    let fault = |text: &str| {
        NoBody::from(TreatmentFault::new(
            text,
            Some(old.re()),
            "change the faces that meet there, or move fewer of them",
        ))
    };
    let Some((det, [a, b, c])) = best.filter(|b| b.0 > 1e-9) else {
        return Err(fault("a corner has not three faces across each other"));
    };
    let _ = det;
    let sum = b.1.cross(c.1) * a.1.dot(a.0 - old)
        + c.1.cross(a.1) * b.1.dot(b.0 - old)
        + a.1.cross(b.1) * c.1.dot(c.0 - old);
    let at = old + sum / a.1.dot(b.1.cross(c.1));
    let size = body.vertices.iter().map(|v| v.at.re().distance(old.re())).fold(0.0, f64::max);
    if all.iter().any(|p| p.1.dot(at - p.0).re().abs() > 1e-9 * size) {
        return Err(fault("more than three faces meet in a corner and part when they are moved"));
    }
    Ok(at)
}

/// The body with each face moved outwards by a distance.
pub(super) fn moved<T: Real>(
    body: &SketchSolid<T>,
    shift: &dyn Fn(usize) -> T,
) -> Result<SketchSolid<T>, NoBody> {
    let around = faces_around(body);
    let mut at = Vec::new();
    for (v, vertex) in body.vertices.iter().enumerate() {
        let p = vertex.at;
        let fault = |text: &str| {
            NoBody::from(TreatmentFault::new(
                text,
                Some(p.re()),
                "change the faces that meet there, or open other faces",
            ))
        };
        // Normals at the vertex, tangent faces once.
        let mut normals: Vec<(Vec3<T>, T)> = Vec::new();
        for &f in &around[v] {
            let normal = outward_normal(body, f, p)
                .ok_or_else(|| fault("a face has no normal in a corner"))?;
            let by = shift(f);
            let same = normals.iter().find(|(n, _)| n.re().distance(normal.re()) < 1e-7);
            match same {
                Some((_, other)) if (*other - by).re().abs() > 0.0 => {
                    return Err(fault("tangent faces are moved by different distances"));
                }
                Some(_) => {}
                None => normals.push((normal, by)),
            }
        }
        let way = match normals[..] {
            [(m, x), (n, y)] => {
                // Along the line that both have in common nothing moves.
                let third = m.cross(n);
                (n.cross(third) * x + third.cross(m) * y) / third.norm_sq()
            }
            [_, _, _, ..] => {
                let mut best: Option<(f64, [(Vec3<T>, T); 3])> = None;
                for i in 0..normals.len() {
                    for j in i + 1..normals.len() {
                        for k in j + 1..normals.len() {
                            let [a, b, c] = [normals[i], normals[j], normals[k]];
                            let det = a.0.re().dot(b.0.re().cross(c.0.re())).abs();
                            if best.as_ref().is_none_or(|b| det > b.0) {
                                best = Some((det, [a, b, c]));
                            }
                        }
                    }
                }
                let Some((_, [a, b, c])) = best.filter(|b| b.0 > 1e-9) else {
                    return Err(fault("a corner has not three faces across each other"));
                };
                let sum = b.0.cross(c.0) * a.1 + c.0.cross(a.0) * b.1 + a.0.cross(b.0) * c.1;
                let way = sum / a.0.dot(b.0.cross(c.0));
                let most = normals.iter().map(|n| n.1.re().abs()).fold(0.0, f64::max);
                if normals.iter().any(|(n, by)| (n.dot(way) - *by).re().abs() > 1e-9 * most) {
                    return Err(fault(
                        "more than three faces meet in a corner and part when they are moved",
                    ));
                }
                way
            }
            _ => return Err(fault("a corner has one face only")),
        };
        at.push(p + way);
    }
    whole(rebuilt(body, at)?)
}

/// The outward unit normal of a plane or cylinder at a point of it.
fn outward_normal<T: Real>(body: &SketchSolid<T>, face: usize, p: Vec3<T>) -> Option<Vec3<T>> {
    match body.form(face) {
        FaceForm::Plane { normal, .. } => Some(normal),
        FaceForm::Straight(axis) => {
            let radial = (p - axis.foot(p)).normalized()?;
            // The loop's orientation determines the outward side.
            let ring: Vec<Vec3<T>> =
                body.faces[face].loops[0].iter().flat_map(|&h| body.run(h)).collect();
            let sum = super::facet_source::newell(&ring);
            let middle =
                ring.iter().fold(Vec3::<f64>::zero(), |s, q| s + (q.re() - axis.foot(*q).re()));
            Some(if sum.re().dot(middle) > 0.0 { radial } else { -radial })
        }
        FaceForm::Other => None,
    }
}

/// The body with moved vertices: plane faces with straight sides and arcs, and cylinders between
/// two arcs.
fn rebuilt<T: Real>(body: &SketchSolid<T>, at: Vec<Vec3<T>>) -> Result<SketchSolid<T>, NoBody> {
    let sides = body.edge_sides();
    let mut edges = Vec::new();
    for (e, edge) in body.edges.iter().enumerate() {
        let [p, q] = edge.ends.map(|v| at[v]);
        let [from, to] = edge.ends.map(|v| body.vertices[v].at);
        let fault = |text: &str, next: &'static str| {
            NoBody::from(TreatmentFault::new(text, Some(from.lerp(to, T::from(0.5)).re()), next))
        };
        if body.is_straight(e) {
            if (q - p).re().dot((to - from).re()) <= 0.0 {
                return Err(fault(
                    "an edge vanishes when the faces are moved",
                    "make it smaller, or change the dimensions",
                ));
            }
            edges.push(SolidEdge { ends: edge.ends, ..SolidEdge::default() });
            continue;
        }
        let axis = sides[e].iter().find_map(|s| match body.form(s.face) {
            FaceForm::Straight(axis) => Some(axis),
            _ => None,
        });
        let Some(piece) = axis.and_then(|axis| arc(body, e, axis, [p, q])) else {
            return Err(fault("an edge is neither straight nor an arc about a cylinder", PLAIN));
        };
        edges.push(SolidEdge { ends: edge.ends, piece: Some(piece), ..SolidEdge::default() });
    }
    let mut faces = Vec::new();
    for (f, face) in body.faces.iter().enumerate() {
        let mut loops = face.loops.clone();
        let ruled = !matches!(body.form(f), FaceForm::Plane { .. });
        if ruled {
            let bent = |h: &(usize, bool)| edges[h.0].piece.is_some();
            let pattern: Vec<bool> = loops.iter().flatten().map(bent).collect();
            let patch = loops.len() == 1
                && matches!(body.form(f), FaceForm::Straight(_))
                && (pattern == [true, false, true, false] || pattern == [false, true, false, true]);
            if !patch {
                let place = body.vertices[body.edges[loops[0][0].0].ends[0]].at.re();
                return Err(TreatmentFault::new(
                    "a round face is not a cylinder between two arcs",
                    Some(place),
                    PLAIN,
                )
                .into());
            }
            if !pattern[0] {
                loops[0].rotate_left(1);
            }
        }
        faces.push(SolidFace { id: face.id, ruled, loops, trim: None, names: face.names.clone() });
    }
    let vertices = body.vertices.iter().zip(&at).map(|(v, &at)| Vertex { id: v.id, at }).collect();
    let kinks = body.kinks.clone();
    Ok(SketchSolid { vertices, edges, faces, kinks, ..SketchSolid::default() })
}

/// The arc about an axis that an edge becomes between new ends; `None` if it is not an arc, or has
/// the opposite orientation.
fn arc<T: Real>(
    body: &SketchSolid<T>,
    edge: usize,
    axis: Line<T>,
    [p, q]: [Vec3<T>; 2],
) -> Option<SmoothPiece<T>> {
    let old = body.run((edge, true));
    let arm = |x: Vec3<T>| (x - axis.foot(x)).re();
    let level = |x: Vec3<T>| axis.direction.re().dot((x - old[0]).re());
    let radius = arm(old[0]).norm();
    let round = old.iter().all(|x| {
        (arm(*x).norm() - radius).abs() <= 1e-9 * radius && level(*x).abs() <= 1e-9 * radius
    });
    let [a, b] = [p, q].map(|x| x - axis.foot(x));
    let alike = (a.re().norm() - b.re().norm()).abs() <= 1e-9 * radius;
    if !round
        || !alike
        || a.re().dot(arm(old[0])) <= 0.0
        || body.edges[edge].ends[0] == body.edges[edge].ends[1]
    {
        return None;
    }
    let turn = axis.direction.re().dot(arm(old[0]).cross(arm(old[1])));
    let direction = if turn > 0.0 { axis.direction } else { -axis.direction };
    let angle = direction.dot(a.cross(b)).atan2(a.dot(b));
    let angle = if angle.re() <= 0.0 { angle + 2.0 * std::f64::consts::PI } else { angle };
    Some(SmoothPiece::Conic { centre: axis.foot(p), a, b: direction.cross(a), sweep: angle })
}
