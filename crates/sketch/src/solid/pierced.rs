//! Bodies whose parts are known without an intersection of surfaces: holes with mouths inside of plane faces, and
//! copies that are apart.

use super::curve::SmoothPiece;
use super::drill::{DrillProfile, DrillRing, rotational};
use super::edges::FaceForm;
use super::place::Similarity;
use super::surface::FaceSurface;
use super::{SketchSolid, SolidEdge, SolidFace, Trim};
use crate::{CoordinateAxis, PointId};
use moldloft_num::{Axis, Box3, Real, Vec3};

/// Maximum number of chords of an edge.
const MOST_CHORDS: f64 = 512.0;

/// Distance below which a hole and an edge are intersected, as a fraction of the hole's radius.
const APART: f64 = 1e-3;

/// Fraction of the extent within which levels and directions are equal.
const SAME: f64 = 1e-12;

/// A face square to the axis in which a hole has a mouth.
struct Mouth<T> {
    face: usize,
    level: T,
    /// True if the face looks along the axis.
    up: bool,
}

/// The body with holes, if it has plane faces and ruled ones with edges of closed form only, and each hole meets the
/// inside of one or two plane faces square to it and nothing else, also not another hole.
pub(super) fn pierced<T: Real>(
    body: &SketchSolid<T>,
    drill: &DrillProfile<T>,
    images: &[Similarity<T>],
) -> Option<SketchSolid<T>> {
    let k = drill.axis.index();
    pierced_by(body, drill, images, &|rings| rotational(k, drill.centre, rings))
}

/// The body without a round bar, if that is a hole in it as those of [`pierced`].
pub(super) fn bored<T: Real>(
    body: &SketchSolid<T>,
    bar: &SketchSolid<T>,
) -> Option<SketchSolid<T>> {
    let (drill, bar) = as_drill(bar)?;
    let k = drill.axis.index();
    let between = |rings: &[DrillRing<T>]| {
        let levels = [&drill.rings[0], &drill.rings[1]].map(|r| r.level.re());
        let level = |x: T| {
            let [low, high] = levels.map(|level| (x.re() - level).abs());
            rings[usize::from(high < low)].level
        };
        let moved = |p: Vec3<T>| {
            let mut at = p.to_array();
            at[k] = level(at[k]);
            Vec3::from(at)
        };
        let mut out = bar.clone();
        for v in &mut out.vertices {
            v.at = moved(v.at);
        }
        for edge in &mut out.edges {
            if let Some(SmoothPiece::Conic { centre, .. }) = &mut edge.piece {
                *centre = moved(*centre);
            }
        }
        out
    };
    pierced_by(body, &drill, &[Similarity::identity()], &between)
}

/// A round bar along an axis as a drill, and the bar with its lower and its upper end face first.
fn as_drill<T: Real>(bar: &SketchSolid<T>) -> Option<(DrillProfile<T>, SketchSolid<T>)> {
    let mut bar = bar.clone();
    bar.faces.sort_by_key(|f| f.ruled);
    let size = bar.vertices.iter().map(|v| v.at.re().norm()).fold(0.0, f64::max);
    let zero = |x: T| (0..T::PARTS).all(|part| x.part(part).abs() <= SAME * size);
    let [one, other, walls @ ..] = &bar.faces[..] else { return None };
    let plain = bar.is_plain() && walls.iter().all(|f| f.ruled) && !one.ruled && !other.ruled;
    let straight = bar.edges.iter().find(|e| e.piece.is_none()).filter(|_| plain)?;
    let way = |e: &SolidEdge<T>| bar.vertices[e.ends[1]].at - bar.vertices[e.ends[0]].at;
    let along = |way: Vec3<T>, k: CoordinateAxis| k.others().iter().all(|j| zero(way[j.index()]));
    let axis = CoordinateAxis::ALL.into_iter().find(|k| along(way(straight), *k))?;
    let k = axis.index();
    let mut known: Option<(Vec3<T>, T)> = None;
    let end = |face: &SolidFace, known: &mut Option<(Vec3<T>, T)>| -> Option<T> {
        let [ring] = &face.loops[..] else { return None };
        let (mut level, mut turned) = (None, 0.0);
        for &(e, _) in ring {
            let Some(SmoothPiece::Conic { centre, a, b, sweep }) = bar.edges[e].piece else {
                return None;
            };
            let (own, radius) = *known.get_or_insert_with(|| (centre, a.norm()));
            let height = *level.get_or_insert(centre[k]);
            let round = zero(a.norm() - radius) && zero(b.norm() - radius);
            let square = zero(a.dot(b) / radius) && zero(a[k]) && zero(b[k]);
            if !round || !square || !along(centre - own, axis) || !zero(centre[k] - height) {
                return None;
            }
            turned += sweep.re().abs();
        }
        level.filter(|_| (turned - std::f64::consts::TAU).abs() <= SAME)
    };
    let mut levels = [end(one, &mut known)?, end(other, &mut known)?];
    let (centre, radius) = known?;
    let upright = bar.edges.iter().all(|e| e.piece.is_some() || along(way(e), axis));
    if levels[0].re() > levels[1].re() {
        levels.reverse();
        bar.faces.swap(0, 1);
    }
    let rings = levels.map(|level| DrillRing { radius, level, above: "" }).to_vec();
    upright.then_some((DrillProfile { axis, centre, rings }, bar))
}

/// As [`pierced`], with the walls of each hole, and two end faces before them, by their rings.
fn pierced_by<T: Real>(
    body: &SketchSolid<T>,
    drill: &DrillProfile<T>,
    images: &[Similarity<T>],
    made: &dyn Fn(&[DrillRing<T>]) -> SketchSolid<T>,
) -> Option<SketchSolid<T>> {
    if !body.is_plain() {
        return None;
    }
    let k = drill.axis.index();
    let radius = drill.rings.iter().map(|r| r.radius.re()).fold(0.0, f64::max);
    let clear = radius * (1.0 + APART);
    let size = body.vertices.iter().map(|v| v.at.re().norm()).fold(radius, f64::max);
    let edges = edge_chords(body, clear)?;
    let flat = edges.iter().map(|way| way.iter().map(|p| flattened(*p, k)).collect()).collect();
    let sides = Shadow { axis: k, edges, flat, size };
    let centres: Vec<Vec3> = images.iter().map(|i| i.point(drill.centre).re()).collect();
    let mut out = body.clone();
    out.curves.clear();
    for (j, image) in images.iter().enumerate() {
        let others = centres[..j].iter();
        let far = |c: &Vec3| sides.flat(*c).distance(sides.flat(centres[j])) > 2.0 * clear;
        if !stays_level(image, k) || !others.clone().all(far) {
            return None;
        }
        let mouths = sides.mouths(body, sides.flat(centres[j]), clear, drill)?;
        let (rings, ends) = between(&drill.rings, &mouths, SAME * size)?;
        let mut walls = made(&rings).placed(image);
        walls.turn_over();
        if j > 0 {
            walls.prefix_names(&format!("COPY{}.", j + 1));
        }
        out.join(walls, ends);
    }
    Some(out)
}

/// True if an image of a drill has the same levels along the axis, also in their derivatives.
fn stays_level<T: Real>(image: &Similarity<T>, k: usize) -> bool {
    let same = |x: T, y: f64| {
        (x.re() - y).abs() <= SAME && (1..T::PARTS).all(|part| x.part(part).abs() <= SAME)
    };
    let axis = image.columns[k];
    let across = (0..3).filter(|j| *j != k).all(|j| same(image.columns[j][k], 0.0));
    let along = (0..3).all(|j| same(axis[j], f64::from(u8::from(j == k))));
    along && across && same(image.shift[k], 0.0) && !image.mirrors()
}

/// The rings of a drill between its mouths, and the face of each end; its own end where it has no mouth.
fn between<T: Real>(
    rings: &[DrillRing<T>],
    mouths: &[Mouth<T>],
    near: f64,
) -> Option<(Vec<DrillRing<T>>, [Option<usize>; 2])> {
    let (low, high) = (rings.first()?, rings.last()?);
    let below = mouths.iter().find(|m| !m.up);
    let above = mouths.iter().find(|m| m.up);
    let (mut kept, mut ends) = (Vec::new(), [None; 2]);
    let outside = |level: T| {
        below.is_some_and(|m| level.re() < m.level.re() + near)
            || above.is_some_and(|m| level.re() > m.level.re() - near)
    };
    match below {
        Some(mouth) => {
            kept.push(at_mouth(rings, mouth, near)?);
            ends[0] = Some(mouth.face);
        }
        None if outside(low.level) => return None,
        None => {}
    }
    kept.extend(rings.iter().filter(|r| !outside(r.level)).cloned());
    match above {
        Some(mouth) => {
            kept.push(at_mouth(rings, mouth, near)?);
            ends[1] = Some(mouth.face);
        }
        None if outside(high.level) => return None,
        None => {}
    }
    let ordered = kept.windows(2).all(|p| p[0].level.re() <= p[1].level.re());
    (ordered && kept.len() > 1).then_some((kept, ends))
}

/// The ring of a drill in the plane of a mouth.
fn at_mouth<T: Real>(rings: &[DrillRing<T>], mouth: &Mouth<T>, near: f64) -> Option<DrillRing<T>> {
    let level = mouth.level;
    let off = |r: &DrillRing<T>| (r.level - level).re().abs();
    let close: Vec<usize> = (0..rings.len()).filter(|&i| off(&rings[i]) <= near).collect();
    if let [i] = close[..] {
        // A countersink begins in the face.
        let exact = (0..T::PARTS).all(|part| (rings[i].level - level).part(part).abs() <= near);
        return exact.then(|| DrillRing { level, ..rings[i].clone() });
    }
    let i = rings
        .windows(2)
        .position(|p| p[0].level.re() < level.re() && level.re() < p[1].level.re())?;
    let [a, b] = [&rings[i], &rings[i + 1]];
    let part = (level - a.level) / (b.level - a.level);
    let radius = a.radius + (b.radius - a.radius) * part;
    close.is_empty().then_some(DrillRing { radius, level, above: a.above })
}

/// The edges of a body as chords, and as they are seen along an axis.
struct Shadow {
    axis: usize,
    edges: Vec<Vec<Vec3>>,
    flat: Vec<Vec<Vec3>>,
    size: f64,
}

/// Chords of the edges, as near to them as a hole may be; `None` if these are too many.
fn edge_chords<T: Real>(body: &SketchSolid<T>, clear: f64) -> Option<Vec<Vec<Vec3>>> {
    let chords = |e: usize| {
        let second = match body.edges[e].piece {
            None => 0.0,
            Some(SmoothPiece::Conic { a, b, sweep, .. }) => {
                (a.re().norm() + b.re().norm()) * sweep.re() * sweep.re()
            }
            Some(SmoothPiece::Cubic([p, q, r, e])) => {
                let bend =
                    |x: Vec3<T>, y: Vec3<T>, z: Vec3<T>| (x - y * T::from(2.0) + z).re().norm();
                6.0 * bend(p, q, r).max(bend(q, r, e))
            }
        };
        let parts = (second / (8.0 * APART / 2.0 * clear)).sqrt().ceil();
        (parts <= MOST_CHORDS)
            .then(|| body.polyline(e, parts as usize).iter().map(|p| p.re()).collect())
    };
    (0..body.edges.len()).map(chords).collect()
}

fn flattened(p: Vec3, k: usize) -> Vec3 {
    let mut at = p.to_array();
    at[k] = 0.0;
    Vec3::from(at)
}

impl Shadow {
    fn flat(&self, p: Vec3) -> Vec3 {
        flattened(p, self.axis)
    }

    /// The faces with the mouths of a drill about a point; `None` if it meets anything else.
    fn mouths<T: Real>(
        &self,
        body: &SketchSolid<T>,
        centre: Vec3,
        clear: f64,
        drill: &DrillProfile<T>,
    ) -> Option<Vec<Mouth<T>>> {
        let [low, high] = drill.span();
        let near = SAME * self.size;
        let mut found: Vec<Mouth<T>> = Vec::new();
        for (f, face) in body.faces.iter().enumerate() {
            let around = || face.loops.iter().flatten();
            let points = || around().flat_map(|h| &self.edges[h.0]);
            let form = body.form(f);
            let upright = match form {
                FaceForm::Plane { at, normal } => {
                    let off = |p: &Vec3| normal.re().dot(*p - at.re()).abs() <= near;
                    normal[self.axis].re().abs() <= SAME && points().all(off)
                }
                FaceForm::Straight(line) => {
                    let across = flattened(line.direction.re(), self.axis).norm();
                    across <= SAME && self.is_cylinder(line.point.re(), &mut points())
                }
                FaceForm::Other => false,
            };
            let square = match form {
                FaceForm::Plane { at, normal } if !face.ruled => {
                    let corners = around().flat_map(|h| body.edges[h.0].ends);
                    let level = points().all(|p| (p[self.axis] - at[self.axis].re()).abs() <= near);
                    let own = self.square(at, normal, corners.map(|v| body.vertices[v].at));
                    own.filter(|_| level)
                }
                _ => None,
            };
            if !upright && square.is_none() {
                // Its box is that of its edges with their bulges.
                if !self.beside_box(points(), centre, clear) {
                    return None;
                }
                continue;
            }
            let bulge = APART * clear;
            let below = points().all(|p| p[self.axis] < low - bulge);
            if below || points().all(|p| p[self.axis] > high + bulge) {
                continue;
            }
            if around().any(|h| distance(&self.flat[h.0], centre) <= clear) {
                return None;
            }
            if let Some((level, up)) = square.filter(|_| self.inside(face, centre)) {
                found.push(Mouth { face: f, level, up });
            }
        }
        let ways = [true, false].map(|up| found.iter().filter(|m| m.up == up).count());
        let material = |m: &Mouth<T>| found.iter().all(|n| n.up || n.level.re() <= m.level.re());
        let one = ways.iter().all(|n| *n <= 1) && !found.is_empty();
        (one && found.iter().all(material)).then_some(found)
    }

    /// The level of a plane face that is square to the axis, also in its derivatives, and its side.
    fn square<T: Real>(
        &self,
        at: Vec3<T>,
        normal: Vec3<T>,
        mut corners: impl Iterator<Item = Vec3<T>>,
    ) -> Option<(T, bool)> {
        let zero = |x: T, most: f64| (0..T::PARTS).all(|part| x.part(part).abs() <= most);
        let k = self.axis;
        let across = (0..3).filter(|j| *j != k).all(|j| zero(normal[j], SAME));
        let level = corners.all(|p| zero(p[k] - at[k], SAME * self.size));
        (across && level).then(|| (at[k], normal[k].re() > 0.0))
    }

    /// True if points are at one distance from a line along the axis.
    fn is_cylinder(&self, centre: Vec3, points: &mut dyn Iterator<Item = &Vec3>) -> bool {
        let centre = self.flat(centre);
        let mut radii = points.map(|p| self.flat(*p).distance(centre));
        let Some(first) = radii.next() else { return false };
        radii.all(|r| (r - first).abs() <= SAME * self.size)
    }

    fn beside_box<'a>(
        &self,
        points: impl Iterator<Item = &'a Vec3>,
        centre: Vec3,
        clear: f64,
    ) -> bool {
        let bounds = Box3::around(points.copied());
        let mut off = [0.0; 3];
        for (j, off) in off.iter_mut().enumerate().filter(|(j, _)| *j != self.axis) {
            *off = (bounds.low[j] - centre[j]).max(centre[j] - bounds.high[j]).max(0.0);
        }
        Vec3::from(off).norm() > clear * (1.0 + APART)
    }

    /// True if a point is inside of a face square to the axis, away from its edges.
    fn inside(&self, face: &SolidFace, p: Vec3) -> bool {
        let [i, j] = [(self.axis + 1) % 3, (self.axis + 2) % 3];
        let sides = face.loops.iter().flatten().flat_map(|h| self.flat[h.0].windows(2));
        let crossed = sides.filter(|side| {
            let [a, b] = [side[0], side[1]];
            (a[j] > p[j]) != (b[j] > p[j])
                && a[i] + (p[j] - a[j]) / (b[j] - a[j]) * (b[i] - a[i]) > p[i]
        });
        crossed.count() % 2 == 1
    }
}

/// The distance of a point from a polyline.
fn distance(way: &[Vec3], p: Vec3) -> f64 {
    let one = |side: &[Vec3]| {
        let (along, off) = (side[1] - side[0], p - side[0]);
        let length = along.norm_sq();
        let part = if length > 0.0 { (along.dot(off) / length).clamp(0.0, 1.0) } else { 0.0 };
        off.distance(along * part)
    };
    way.windows(2).map(one).fold(f64::INFINITY, f64::min)
}

/// True for solids without intersections whose boxes are apart.
pub(super) fn lie_apart<T: Real>(bodies: &[SketchSolid<T>]) -> bool {
    if !bodies.iter().all(SketchSolid::is_whole) {
        return false;
    }
    let boxes: Vec<Box3> = bodies.iter().map(around).collect();
    let size = boxes.iter().map(|b| b.low.norm().max(b.high.norm())).fold(0.0, f64::max);
    let apart = |a: &Box3, b: &Box3| {
        let gap = |k: usize| (b.low[k] - a.high[k]).max(a.low[k] - b.high[k]);
        (0..3).any(|k| gap(k) > APART * size)
    };
    (1..boxes.len()).all(|j| boxes[..j].iter().all(|other| apart(&boxes[j], other)))
}

/// A box with all of a solid.
fn around<T: Real>(body: &SketchSolid<T>) -> Box3 {
    // Circles about the axis through the ends and the control points of a profile hold what it turns into.
    let turned = body.trims.iter().flat_map(|trim| match trim.surface {
        FaceSurface::Turned { centre, axis, profile, .. } => {
            let line = Axis { point: centre.re(), direction: axis.re() };
            let ring = |p: Vec3| {
                let foot = line.foot(p);
                let far = p.distance(foot);
                let d = line.direction;
                let wide = Vec3::from([0, 1, 2].map(|k| far * (1.0 - d[k] * d[k]).max(0.0).sqrt()));
                [foot - wide, foot + wide]
            };
            let corners = match profile {
                SmoothPiece::Conic { centre, a, b, .. } => {
                    let [c, a, b] = [centre, a, b].map(Vec3::re);
                    [c + a + b, c + a - b, c - a + b, c - a - b]
                }
                SmoothPiece::Cubic(points) => points.map(Vec3::re),
            };
            corners.into_iter().flat_map(ring).collect::<Vec<_>>()
        }
        _ => Vec::new(),
    });
    let corners = body.vertices.iter().map(|v| v.at.re());
    let curves = body.edges.iter().filter_map(|e| e.piece).flat_map(|piece| match piece {
        SmoothPiece::Conic { centre, a, b, .. } => {
            let [c, a, b] = [centre, a, b].map(Vec3::re);
            let wide = Vec3::from([0, 1, 2].map(|k| (a[k] * a[k] + b[k] * b[k]).sqrt()));
            vec![c - wide, c + wide]
        }
        SmoothPiece::Cubic(points) => points.map(Vec3::re).to_vec(),
    });
    Box3::around(corners.chain(curves).chain(turned))
}

/// Plain solids that are apart, as one.
pub(super) fn side_by_side<T: Real>(bodies: Vec<SketchSolid<T>>) -> SketchSolid<T> {
    let mut bodies = bodies.into_iter();
    let mut out = bodies.next().unwrap_or_default();
    out.curves.clear();
    for body in bodies {
        out.density = out.density.with(&body.density);
        out.kinks.extend(body.kinks.iter().cloned());
        out.join(body, [None; 2]);
    }
    out
}

impl<T: Real> SketchSolid<T> {
    /// True for a solid without trimmed faces, and without parts that come from an intersection of surfaces.
    pub(super) fn is_plain(&self) -> bool {
        self.trims.is_empty() && self.is_whole()
    }

    /// True for a solid without parts that come from an intersection of surfaces.
    fn is_whole(&self) -> bool {
        let drawn = self.edges.iter().all(|e| e.trace.is_none() && e.own_ends.is_none());
        drawn
            && !self.flat
            && self.facets.is_none()
            && self.planes.is_empty()
            && self.strays.is_empty()
            && self.rates.is_empty()
    }

    /// Adds the parts of a solid without intersections. Its first two faces are left out where `ends` has a face of this body: their
    /// loops become holes of that face.
    fn join(&mut self, other: SketchSolid<T>, ends: [Option<usize>; 2]) {
        let (vertices, edges) = (self.vertices.len(), self.edges.len());
        let (faces, trims) = (self.faces.len(), self.trims.len());
        let label = self.vertices.iter().map(|v| v.id.0).max().unwrap_or(0);
        for mut v in other.vertices {
            v.id = PointId(label + v.id.0);
            self.vertices.push(v);
        }
        for mut edge in other.edges {
            edge.ends = edge.ends.map(|v| v + vertices);
            self.edges.push(edge);
        }
        let moved = |t: Trim<T>| Trim { face: faces + t.face, ..t };
        self.trims.extend(other.trims.into_iter().map(moved));
        for (f, mut face) in other.faces.into_iter().enumerate() {
            face.trim = face.trim.map(|k| trims + k);
            face.loops.iter_mut().flatten().for_each(|h| h.0 += edges);
            match ends.get(f).copied().flatten() {
                Some(mouth) => self.faces[mouth].loops.append(&mut face.loops),
                None => self.faces.push(face),
            }
        }
    }
}
