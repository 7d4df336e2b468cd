//! The gate: only a closed body that is outward and does not cross itself has a volume.
//!
//! Closedness and direction are counted; intersections are searched between sides and facets whose
//! boxes overlap. The arrangement decides doubtful cases (a vertex on a face) and reconstructs
//! intersecting bodies: it keeps the volume of winding number one or more, so that a hole that a
//! dimension moves half out of the body becomes a notch, and a hole outside it disappears.

use super::combine::{CombineError, resolved, unclear};
use super::facet_source::newell;
use super::outline::Outline;
use super::{FacetPart, SketchSolid, SolidFace};
use crate::FaceId;
use crate::PointId;
use moldloft_num::union_find::UnionFind;
use moldloft_num::{Real, Vec3};
use std::collections::BTreeMap;

/// Reason why a body has no volume.
#[derive(Clone, Debug, PartialEq)]
pub enum SolidDefect {
    /// Its faces do not close: edges without exactly one face on each side, by their ends.
    Open(Vec<[PointId; 2]>),
    /// The cycle of a face crosses itself at this position: lines have passed each other.
    Crossed {
        /// The face.
        face: Option<FaceId>,
        /// The vertices of the two sides that cross.
        sides: [[PointId; 2]; 2],
        /// The crossing.
        at: Vec3,
    },
    /// A hole in a face of a section is outside the face's border.
    Outside {
        /// The face.
        face: Option<FaceId>,
        /// A vertex of the hole.
        hole: PointId,
    },
    /// It intersects itself and could not be reconstructed.
    Unresolved(CombineError),
    /// A coordinate is not finite, or so large that volumes or their derivatives overflow.
    NotFinite,
}

/// The largest coordinate of a body.
const MAX_COORDINATE: f64 = 1e60;

/// The body itself if it is valid, otherwise its reconstruction if it intersects itself.
///
/// # Errors
/// [`SolidDefect`], with the position.
pub fn valid<T: Real>(body: SketchSolid<T>) -> Result<SketchSolid<T>, SolidDefect> {
    checked(body, true)
}

/// As [`valid`], for a body that does not cross itself.
///
/// # Errors
/// [`SolidDefect`], with the position.
pub(super) fn valid_turned<T: Real>(body: SketchSolid<T>) -> Result<SketchSolid<T>, SolidDefect> {
    checked(body, false)
}

fn checked<T: Real>(
    mut body: SketchSolid<T>,
    crossing: bool,
) -> Result<SketchSolid<T>, SolidDefect> {
    let clear = |body| if crossing { clear(body) } else { Ok(body) };
    // Derivatives may be undefined for a valid body.
    let within = |v: &Vec3| v.to_array().iter().all(|x| x.abs() <= MAX_COORDINATE);
    if body.vertices.iter().any(|v| !within(&v.at.re())) {
        return Err(SolidDefect::NotFinite);
    }
    let outline = body.outline();
    if body.flat {
        let flaw = crossed_cycle(&body, &outline, true);
        return match flaw.or_else(|| strayed_hole(&body, &outline)) {
            Some(flaw) => Err(flaw),
            None => clear(body),
        };
    }
    let open = open_edges(&body);
    if !open.is_empty() {
        return Err(SolidDefect::Open(open));
    }
    let suspect = crossing && suspect(&body, &outline);
    if !suspect && shells(&body, &outline) == Shells::Outward {
        return clear(body);
    }
    if let Some(flaw) = crossed_cycle(&body, &outline, false) {
        return Err(flaw);
    }
    if !suspect && shells(&body, &outline) == Shells::Inward {
        body.turn_over();
        return clear(body);
    }
    match resolved(&body) {
        Ok((_, false)) => Ok(body),
        Ok((new, true)) => Ok(new.named_after(&body)),
        Err(e) => Err(SolidDefect::Unresolved(e)),
    }
}

/// A body that does not cross itself, if its facets tell that.
fn clear<T: Real>(body: SketchSolid<T>) -> Result<SketchSolid<T>, SolidDefect> {
    let places = unclear(&body);
    if places.is_empty() {
        return Ok(body);
    }
    Err(SolidDefect::Unresolved(CombineError::Coarse(places)))
}

impl<T: Real> SketchSolid<T> {
    /// All faces seen from their other sides.
    pub(super) fn turn_over(&mut self) {
        for face in &mut self.faces {
            for cycle in &mut face.loops {
                cycle.reverse();
                cycle.iter_mut().for_each(|h| h.1 = !h.1);
                if face.ruled || face.trim.is_some() {
                    // A patch starts with the edge it started with.
                    cycle.rotate_right(1);
                }
            }
        }
        if let Some(facets) = &mut self.facets {
            facets.faces.iter_mut().flatten().for_each(|t| t.swap(1, 2));
            facets.parts.iter_mut().flatten().for_each(FacetPart::turn_over);
        }
    }

    /// Labels of the old body for vertices at its positions, new numbers for the others; and its
    /// curves, with their messages.
    fn named_after(mut self, old: &SketchSolid<T>) -> SketchSolid<T> {
        self.curves.clone_from(&old.curves);
        self.unbuilt.clone_from(&old.unbuilt);
        let size = old.vertices.iter().map(|v| v.at.re().norm()).fold(0.0, f64::max);
        let mut next = old.vertices.iter().map(|v| v.id.0).max().unwrap_or(0);
        let mut taken: Vec<PointId> = Vec::new();
        for v in &mut self.vertices {
            let same = old
                .vertices
                .iter()
                .find(|o| o.at.re().distance(v.at.re()) <= 1e-9 * size && !taken.contains(&o.id));
            v.id = match same {
                Some(o) => o.id,
                None => {
                    next = next.saturating_add(1);
                    PointId(next)
                }
            };
            taken.push(v.id);
        }
        self
    }
}

fn open_edges<T>(body: &SketchSolid<T>) -> Vec<[PointId; 2]> {
    let mut count = vec![[0u32; 2]; body.edges.len()];
    for &(e, forward) in body.faces.iter().flat_map(|f| f.loops.iter().flatten()) {
        count[e][usize::from(forward)] += 1;
    }
    let open = count.iter().enumerate().filter(|(_, c)| c[0] != c[1]);
    open.map(|(e, _)| body.edges[e].ends.map(|v| body.vertices[v].id)).collect()
}

struct CrossingFacet {
    normal: Vec3,
    at: Vec3,
    loops: Vec<Vec<u32>>,
    low: Vec3,
    high: Vec3,
    /// Its corners in order of their numbers, with cycle and index in it, once there are many.
    corners: Vec<(u32, usize, usize)>,
}

/// A facet of more corners has them in order.
const MANY: usize = 16;

impl CrossingFacet {
    fn has(&self, v: u32) -> bool {
        if self.corners.is_empty() {
            self.loops.iter().any(|c| c.contains(&v))
        } else {
            !self.corners_at(v).is_empty()
        }
    }

    fn corners_at(&self, v: u32) -> &[(u32, usize, usize)] {
        let first = self.corners.partition_point(|c| c.0 < v);
        let count = self.corners[first..].partition_point(|c| c.0 == v);
        &self.corners[first..first + count]
    }
}

/// True if any side may intersect a facet, or an edge has zero length.
fn suspect<T: Real>(body: &SketchSolid<T>, outline: &Outline<T>) -> bool {
    let points: Vec<Vec3> = outline.points.iter().map(|p| p.re()).collect();
    let [low, high] = bounds(points.iter().copied());
    let size = (high - low).norm();
    let tolerance = 1e-9 * size;
    let at = |v: u32| points[v as usize];
    let mut walls: Vec<CrossingFacet> = Vec::new();
    let mut sides: Vec<(u32, u32)> = Vec::new();
    let mut put = |loops: Vec<Vec<u32>>| -> bool {
        let ring: Vec<Vec3> = loops[0].iter().map(|&v| at(v)).collect();
        let Some(normal) = newell(&ring).normalized() else { return false };
        for c in &loops {
            sides.extend((0..c.len()).map(|k| {
                let (a, b) = (c[k], c[(k + 1) % c.len()]);
                (a.min(b), a.max(b))
            }));
        }
        let [low, high] = bounds(loops.iter().flatten().map(|&v| at(v)));
        let mut corners = Vec::new();
        if loops.iter().map(Vec::len).sum::<usize>() > MANY {
            for (k, cycle) in loops.iter().enumerate() {
                corners.extend(cycle.iter().enumerate().map(|(i, &v)| (v, k, i)));
            }
            corners.sort_unstable();
        }
        walls.push(CrossingFacet { normal, at: ring[0], loops, low, high, corners });
        true
    };
    for (f, face) in body.faces.iter().enumerate() {
        if face.ruled || face.trim.is_some() {
            for (loops, _) in outline.strips(f) {
                if !put(loops.clone()) {
                    return true;
                }
            }
        } else if !put(outline.loops(body, f).0) {
            return true;
        }
    }
    sides.sort_unstable();
    sides.dedup();
    if sides.iter().any(|&(a, b)| at(a).distance(at(b)) <= tolerance) {
        return true;
    }
    if walls.iter().any(|w| strayed(w, &at).is_some()) {
        return true;
    }
    // Walls first, then sides, swept together.
    let mut boxes: Vec<[Vec3; 2]> = walls.iter().map(|w| [w.low, w.high]).collect();
    boxes.extend(sides.iter().map(|&(a, b)| bounds([at(a), at(b)].into_iter())));
    let mut found = false;
    super::arrangement::overlapping(&boxes, tolerance, walls.len(), |w, s| {
        if found {
            return;
        }
        let (wall, (a, b)) = (&walls[w], sides[s - walls.len()]);
        let (p, q) = (at(a), at(b));
        let (hp, hq) = ((p - wall.at).dot(wall.normal), (q - wall.at).dot(wall.normal));
        let near = [hp, hq].map(|h| h.abs() <= tolerance);
        if !near[0] && !near[1] && (hp > 0.0) == (hq > 0.0) {
            return;
        }
        let hit = match near {
            [true, true] => !own_side(wall, a, b) && overlaps(wall, &at, [p, q], tolerance),
            [true, false] => !wall.has(a) && covers(wall, &at, p, tolerance),
            [false, true] => !wall.has(b) && covers(wall, &at, q, tolerance),
            _ => covers(wall, &at, p + (q - p) * (hp / (hp - hq)), tolerance),
        };
        found |= hit;
    });
    found
}

/// A hole that is not inside of the border of its face, or inside of another hole: no side need cross
/// another where a hole has left the face at once.
fn strayed(wall: &CrossingFacet, at: &dyn Fn(u32) -> Vec3) -> Option<usize> {
    if wall.loops.len() < 2 {
        return None;
    }
    let boxes: Vec<[Vec3; 2]> =
        wall.loops.iter().map(|c| bounds(c.iter().map(|&v| at(v)))).collect();
    let margin = 1e-9 * (boxes[0][1] - boxes[0][0]).norm();
    (1..wall.loops.len()).find(|&k| {
        let p = at(wall.loops[k][0]);
        let inside = |j: usize| {
            let [low, high] = boxes[j];
            let near = (0..3).all(|i| low[i] - margin <= p[i] && p[i] <= high[i] + margin);
            near && winding(&wall.loops[j], wall.normal, at, p) != 0
        };
        !inside(0) || (1..wall.loops.len()).any(|j| j != k && inside(j))
    })
}

/// The first hole of a section that is not where a hole can be.
fn strayed_hole<T: Real>(body: &SketchSolid<T>, outline: &Outline<T>) -> Option<SolidDefect> {
    let at = |v: u32| outline.points[v as usize].re();
    (0..body.faces.len()).find_map(|f| {
        let loops = outline.loops(body, f).0;
        let ring: Vec<Vec3> = loops[0].iter().map(|&v| at(v)).collect();
        let normal = newell(&ring).normalized()?;
        let [low, high] = bounds(loops.iter().flatten().map(|&v| at(v)));
        let wall = CrossingFacet { normal, at: ring[0], loops, low, high, corners: Vec::new() };
        let hole = wall.loops.get(strayed(&wall, &at)?)?[0] as usize;
        let hole = body.vertices.get(hole).map_or(PointId(0), |v| v.id);
        Some(SolidDefect::Outside { face: body.faces[f].id, hole })
    })
}

fn own_side(wall: &CrossingFacet, a: u32, b: u32) -> bool {
    if !wall.corners.is_empty() {
        return wall.corners_at(a).iter().any(|&(_, k, i)| {
            let (cycle, n) = (&wall.loops[k], wall.loops[k].len());
            cycle[(i + 1) % n] == b || cycle[(i + n - 1) % n] == b
        });
    }
    wall.loops.iter().any(|c| {
        (0..c.len()).any(|k| {
            let pair = (c[k], c[(k + 1) % c.len()]);
            pair == (a, b) || pair == (b, a)
        })
    })
}

/// Coordinates in the plane of a wall: the two that its normal is farthest from.
fn flat(normal: Vec3, p: Vec3) -> [f64; 2] {
    let n = normal.to_array().map(f64::abs);
    if n[0] >= n[1] && n[0] >= n[2] {
        [p.y, p.z]
    } else if n[1] >= n[2] {
        [p.z, p.x]
    } else {
        [p.x, p.y]
    }
}

/// True if a point of the plane is in a wall or on its border.
fn covers(wall: &CrossingFacet, at: &dyn Fn(u32) -> Vec3, p: Vec3, tolerance: f64) -> bool {
    for c in &wall.loops {
        for k in 0..c.len() {
            let (s, t) = (at(c[k]), at(c[(k + 1) % c.len()]));
            let d = t - s;
            let part = ((p - s).dot(d) / d.norm_sq()).clamp(0.0, 1.0);
            if (s + d * part).distance(p) <= tolerance {
                return true;
            }
        }
    }
    wall.loops.iter().map(|c| winding(c, wall.normal, at, p)).sum::<i32>() != 0
}

/// Winding number of a cycle about a point, in a plane of that normal.
fn winding(cycle: &[u32], normal: Vec3, at: &dyn Fn(u32) -> Vec3, p: Vec3) -> i32 {
    let [x, y] = flat(normal, p);
    let mut turns = 0;
    for k in 0..cycle.len() {
        let (s, t) = (at(cycle[k]), at(cycle[(k + 1) % cycle.len()]));
        let ([ax, ay], [bx, by]) = (flat(normal, s), flat(normal, t));
        if (ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax) {
            turns += if by > ay { 1 } else { -1 };
        }
    }
    turns
}

/// True if a side in the plane of a wall passes through its inside.
fn overlaps(
    wall: &CrossingFacet,
    at: &dyn Fn(u32) -> Vec3,
    [p, q]: [Vec3; 2],
    tolerance: f64,
) -> bool {
    let d = q - p;
    let length = d.norm();
    let u = d / length;
    let w = wall.normal.cross(u);
    let mut stops = vec![0.0, length];
    for c in &wall.loops {
        for k in 0..c.len() {
            let (s, t) = (at(c[k]) - p, at(c[(k + 1) % c.len()]) - p);
            let (a, b) = (s.dot(w), t.dot(w));
            if a.abs() <= tolerance {
                stops.push(s.dot(u));
            }
            if (a > 0.0) != (b > 0.0) {
                let x = s + (t - s) * (a / (a - b));
                stops.push(x.dot(u));
            }
        }
    }
    stops.sort_by(f64::total_cmp);
    stops.windows(2).any(|s| {
        let middle = 0.5 * (s[0] + s[1]);
        let inner = s[1] - s[0] > 2.0 * tolerance && middle > 0.0 && middle < length;
        inner && covers(wall, at, p + u * middle, 0.0) && {
            // Along its border is no overlap.
            let x = p + u * middle;
            !wall.loops.iter().any(|c| {
                (0..c.len()).any(|k| {
                    let (s, t) = (at(c[k]), at(c[(k + 1) % c.len()]));
                    let d = t - s;
                    let part = ((x - s).dot(d) / d.norm_sq()).clamp(0.0, 1.0);
                    (s + d * part).distance(x) <= tolerance
                })
            })
        }
    })
}

fn bounds(points: impl Iterator<Item = Vec3>) -> [Vec3; 2] {
    let mut low: Vec3 = Vec3::of(f64::INFINITY, f64::INFINITY, f64::INFINITY);
    let mut high = -low;
    for p in points {
        low = Vec3::new(low.x.min(p.x), low.y.min(p.y), low.z.min(p.z));
        high = Vec3::new(high.x.max(p.x), high.y.max(p.y), high.z.max(p.z));
    }
    [low, high]
}

/// Orientation of the shells of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shells {
    /// Outer ones outward, those of cavities inward.
    Outward,
    Inward,
    /// Some outward, some inward.
    Mixed,
}

/// The orientation of the shells, connected by edges.
fn shells<T: Real>(body: &SketchSolid<T>, outline: &Outline<T>) -> Shells {
    let mut parts = UnionFind::new(body.faces.len());
    let mut first: Vec<Option<usize>> = vec![None; body.edges.len()];
    for (f, face) in body.faces.iter().enumerate() {
        for &(e, _) in face.loops.iter().flatten() {
            parts.join(*first[e].get_or_insert(f), f);
        }
    }
    let at = |v: u32| outline.points[v as usize].re();
    let centre = outline.points.first().map_or(Vec3::zero(), |p| p.re());
    // The triangles of each shell: signed fans serve for volumes and solid angles.
    let mut fans: BTreeMap<usize, Vec<[Vec3; 3]>> = BTreeMap::new();
    for (f, face) in body.faces.iter().enumerate() {
        let fan = fans.entry(parts.find(f)).or_default();
        let mut add = |c: &Vec<u32>, apex: Vec3| {
            fan.extend((0..c.len()).map(|k| [apex, at(c[k]), at(c[(k + 1) % c.len()])]));
        };
        if face.ruled || face.trim.is_some() {
            outline.strips(f).iter().for_each(|(l, _)| add(&l[0], at(l[0][0])));
        } else {
            let loops = outline.loops(body, f).0;
            loops.iter().for_each(|c| add(c, at(loops[0][0])));
        }
    }
    let volume = |fan: &Vec<[Vec3; 3]>| -> f64 {
        fan.iter().map(|[a, b, c]| (*a - centre).dot((*b - centre).cross(*c - centre))).sum()
    };
    if fans.len() == 1 {
        let all = fans.values().map(volume).sum::<f64>();
        return if all > 0.0 { Shells::Outward } else { Shells::Inward };
    }
    let mut right = 0;
    for (k, fan) in &fans {
        let p = fan[0][1];
        let others = fans.iter().filter(|(other, _)| *other != k).flat_map(|(_, f)| f);
        let turns = others.map(|t| solid_angle(t, p)).sum::<f64>() / (4.0 * std::f64::consts::PI);
        let inside = turns.abs().round() as i64 % 2 == 1;
        right += usize::from((volume(fan) > 0.0) != inside);
    }
    match right {
        n if n == fans.len() => Shells::Outward,
        0 => Shells::Inward,
        _ => Shells::Mixed,
    }
}

/// The solid angle of a triangle seen from `p` (van Oosterom and Strackee, 1983).
fn solid_angle(corners: &[Vec3; 3], p: Vec3) -> f64 {
    let [a, b, c] = corners.map(|x| x - p);
    let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
    let top = a.dot(b.cross(c));
    let bottom = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    if top == 0.0 { 0.0 } else { 2.0 * Real::atan2(top, bottom) }
}

/// A cycle of a plane face that crosses itself; in a section also two cycles that cross.
fn crossed_cycle<T: Real>(
    body: &SketchSolid<T>,
    outline: &Outline<T>,
    between: bool,
) -> Option<SolidDefect> {
    let at = |v: u32| outline.points[v as usize].re();
    let [low, high] = bounds(outline.points.iter().map(|p| p.re()));
    let tolerance = 1e-9 * (high - low).norm();
    let round = |f: &SolidFace| f.ruled || f.trim.is_some();
    for (f, face) in body.faces.iter().enumerate().filter(|(_, f)| !round(f)) {
        let (loops, tags) = outline.loops(body, f);
        let mut sides: Vec<(usize, u32, [u32; 2])> = Vec::new();
        for (k, (cycle, tags)) in loops.iter().zip(&tags).enumerate() {
            let n = cycle.len();
            sides.extend((0..n).map(|i| (k, tags[i], [cycle[i], cycle[(i + 1) % n]])));
        }
        let boxes: Vec<[Vec3; 2]> = sides.iter().map(|s| bounds(s.2.map(at).into_iter())).collect();
        let mut found = None;
        super::arrangement::overlapping(&boxes, 0.0, usize::MAX, |i, j| {
            let (s, t) = (&sides[i], &sides[j]);
            if found.is_some() || (s.0 != t.0 && !between) || s.2.iter().any(|v| t.2.contains(v)) {
                return;
            }
            let ([p, q], [r, e]) = (s.2.map(at), t.2.map(at));
            let (d, w) = (q - p, e - r);
            let normal = d.cross(w);
            let det = normal.norm_sq();
            if det <= 1e-18 * d.norm_sq() * w.norm_sq() {
                return;
            }
            let a = (r - p).cross(w).dot(normal) / det;
            let b = (r - p).cross(d).dot(normal) / det;
            let (ma, mb) = (tolerance / d.norm(), tolerance / w.norm());
            if a > ma && a < 1.0 - ma && b > mb && b < 1.0 - mb {
                let name = |tag: u32| body.edges[tag as usize].ends.map(|v| body.vertices[v].id);
                found = Some((p + d * a, [name(s.1), name(t.1)]));
            }
        });
        if let Some((at, sides)) = found {
            return Some(SolidDefect::Crossed { face: face.id, sides, at });
        }
    }
    None
}
