//! Chamfers and fillets of chosen edges: the part beside each edge is taken away from the body, or added to it
//! where the faces look at each other.
//!
//! A fillet is the surface that a rolling ball touches (cylinder, torus, sphere at corners of three); a chamfer
//! is the plane or cone through two lines in the faces, and chamfers at a corner go on until they meet. Every
//! number carries derivatives.

use super::SketchSolid;
use super::blend_order::{BlendSize, ChosenEdges, ordered};
use super::blend_tool::{BallCorner, BlendSection, SectionPlacing, joined, swept};
use super::combine::combined_with;
use super::curve::SmoothPiece;
use super::edges::{EdgeFrame, EdgeSide, FaceForm, TreatmentFault};
use super::feature::NoBody;
use super::operation::Operation;
use super::surface::{Carrier, meet};
use crate::SketchObject;
use crate::feature::EdgeChoice;
use moldloft_num::{Axis as Line, Real, Vec3};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

const SMALLER: &str = "make it smaller, or choose other edges";

/// An edge to be blended, with its distances.
struct BlendEdge<T> {
    frame: EdgeFrame<T>,
    reach: [T; 2],
    section: BlendSection<T>,
}

struct Blending<'a, T> {
    body: &'a SketchSolid<T>,
    sides: Vec<Vec<EdgeSide>>,
    edges: BTreeMap<usize, BlendEdge<T>>,
    /// By vertex: the faces around it.
    around: BTreeMap<usize, BTreeSet<usize>>,
    fillet: Option<T>,
    size: f64,
}

/// The body with its chosen edges chamfered or filleted.
///
/// # Errors
/// Edges that cannot be blended: too large a size, other surfaces, corners of more than three
/// faces; with the position.
pub(crate) fn blended<T: Real>(
    body: &SketchSolid<T>,
    object: &SketchObject,
    size: BlendSize<T>,
    choices: &[EdgeChoice],
) -> Result<SketchSolid<T>, NoBody> {
    let lengths = match size {
        BlendSize::Chamfer(d) => d,
        BlendSize::Fillet(r) => [r, r],
    };
    if lengths.iter().any(|d| !(d.re() > 0.0 && d.is_finite())) {
        let text = format!("the size {} is not positive", lengths[0].re().min(lengths[1].re()));
        return Err(TreatmentFault::new(text, None, "give a length above 0").into());
    }
    let mut chosen = body.chosen_edges(choices, object)?;
    let sides = body.edge_sides();
    follow_tangents(body, &sides, &mut chosen);
    let (first, later) = ordered(body, &sides, &chosen, size)?;
    let mut out = blended_at_once(body, &first, sides, size)?;
    for step in &later {
        let mut next = step.found_in(&out)?;
        let sides = out.edge_sides();
        follow_tangents(&out, &sides, &mut next);
        out = blended_at_once(&out, &next, sides, size)?;
    }
    Ok(out)
}

/// The body with edges blended that meet in no corner of both kinds.
fn blended_at_once<T: Real>(
    body: &SketchSolid<T>,
    chosen: &ChosenEdges,
    sides: Vec<Vec<EdgeSide>>,
    size: BlendSize<T>,
) -> Result<SketchSolid<T>, NoBody> {
    let uneven = matches!(size, BlendSize::Chamfer([a, b]) if (a - b).re() != 0.0);
    let mut around: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for (e, own) in sides.iter().enumerate() {
        for v in body.edges[e].ends {
            around.entry(v).or_default().extend(own.iter().map(|s| s.face));
        }
    }
    let extent = body.vertices.iter().map(|v| v.at.re().distance(body.vertices[0].at.re()));
    let mut work = Blending {
        body,
        edges: BTreeMap::new(),
        around,
        fillet: match size {
            BlendSize::Fillet(r) => Some(r),
            BlendSize::Chamfer(_) => None,
        },
        size: extent.fold(0.0, f64::max),
        sides,
    };
    for (&e, &first) in chosen {
        let frame = body.edge_frame(e, &work.sides[e], first)?;
        if uneven && first.is_none() {
            let next =
                "choose edges OF a face, or BETWEEN two: the first distance is in the first face";
            let at = Some(frame.start.re());
            return Err(TreatmentFault::new("two distances need a first face", at, next).into());
        }
        let edge = work.sized(frame, size)?;
        work.edges.insert(e, edge);
    }
    let mut tools: Vec<(bool, SketchSolid<T>)> = Vec::new();
    let mut strips = Vec::new();
    for edge in work.edges.values().filter(|e| e.frame.axis.is_none()) {
        let stations = [work.station(edge, 0)?, work.station(edge, 1)?];
        work.extent(edge, &stations, &mut strips)?;
        let stations = stations.map(|s| (s, true));
        tools.push((edge.frame.convex, swept(&edge.section, &stations, false)));
    }
    work.rings(&mut tools, &mut strips)?;
    apart(&strips)?;
    work.balls(&mut tools)?;
    let mut out = body.clone();
    for (convex, operation) in [(true, Operation::Cut), (false, Operation::Union)] {
        let own: Vec<SketchSolid<T>> =
            tools.iter().filter(|t| t.0 == convex).map(|t| t.1.clone()).collect();
        if !own.is_empty() {
            out = combined_with(&out, &own, operation).map_err(NoBody::Combine)?;
        }
    }
    Ok(out)
}

/// Adds the edges that continue chosen ones without a corner.
fn follow_tangents<T: Real>(
    body: &SketchSolid<T>,
    sides: &[Vec<EdgeSide>],
    chosen: &mut ChosenEdges,
) {
    let mut queue: Vec<usize> = chosen.keys().copied().collect();
    while let Some(e) = queue.pop() {
        for side in &sides[e] {
            for next in [true, false] {
                let (other, tangent) = neighbour(body, side, next);
                if tangent && !chosen.contains_key(&other) && !body.is_smooth(&sides[other]) {
                    let first = chosen[&e].map(|f| {
                        let shared = sides[other].iter().find(|s| s.face == f);
                        let across = sides[other].iter().find(|s| s.face != side.face);
                        shared.or(across).map_or(f, |s| s.face)
                    });
                    chosen.insert(other, first);
                    queue.push(other);
                }
            }
        }
    }
}

/// The edge after a side in its loop, or before it, and whether it continues in the same direction.
fn neighbour<T: Real>(body: &SketchSolid<T>, side: &EdgeSide, next: bool) -> (usize, bool) {
    let cycle = &body.faces[side.face].loops[side.cycle];
    let n = cycle.len();
    let own = body.run(cycle[side.place]);
    let at = if next { (side.place + 1) % n } else { (side.place + n - 1) % n };
    let other = body.run(cycle[at]);
    let heading = |a: Vec3<T>, b: Vec3<T>| (b - a).re().normalized().unwrap_or_default();
    let tangent = |h: (usize, bool), way: &[Vec3<T>], end: bool| {
        // The direction of a closed form at its end, of others that of the last chord.
        let edge = &body.edges[h.0];
        match (&edge.trace, edge.piece) {
            (None, Some(_)) => {
                let piece = body.piece(h);
                piece
                    .velocity(T::from(if end { 1.0 } else { 0.0 }))
                    .re()
                    .normalized()
                    .unwrap_or_default()
            }
            _ => {
                let m = way.len();
                if end { heading(way[m - 2], way[m - 1]) } else { heading(way[0], way[1]) }
            }
        }
    };
    let (here, there) = (tangent(cycle[side.place], &own, next), tangent(cycle[at], &other, !next));
    let traced = [cycle[side.place].0, cycle[at].0].iter().any(|e| body.edges[*e].trace.is_some());
    // A chord of 5 degrees leaves its curve by half of them.
    let limit = if traced { 0.06 } else { 1e-7 };
    (cycle[at].0, at != side.place && here.cross(there).norm() <= limit && here.dot(there) > 0.0)
}

impl<T: Real> Blending<'_, T> {
    fn sized(&self, frame: EdgeFrame<T>, size: BlendSize<T>) -> Result<BlendEdge<T>, NoBody> {
        let [m, n] = frame.into;
        let angle = m.cross(n).norm().atan2(m.dot(n));
        let half = angle * 0.5;
        let names = frame.sides.map(|s| self.body.faces[s.face].names.clone());
        let between: Vec<Arc<str>> = joined(&[&names[0], &names[1]]).into_iter().collect();
        let [first, second] = names;
        let names = [first, between, second];
        let start = frame.start;
        let (reach, round) = match size {
            BlendSize::Chamfer(d) => (d, None),
            BlendSize::Fillet(r) => {
                let reach = r / half.tan();
                let bisector = (m + n).normalized().ok_or_else(|| {
                    let at = Some(start.re());
                    TreatmentFault::new("faces are tangent at an edge", at, SMALLER)
                })?;
                let centre = start + bisector * (r / half.sin());
                let [p, q] = [m, n].map(|d| start + d * reach - centre);
                let side = (q - p * (p.dot(q) / p.norm_sq())).normalized().unwrap_or(n);
                let sweep = -angle + std::f64::consts::PI;
                ([reach, reach], Some(SmoothPiece::Conic { centre, a: p, b: side * r, sweep }))
            }
        };
        let corners = [start, start + m * reach[0], start + n * reach[1]];
        let section = BlendSection { corners, round, names };
        Ok(BlendEdge { frame, reach, section })
    }

    /// The edges at an end of an edge, in each of its faces, and the other faces there.
    fn at_end(&self, edge: &BlendEdge<T>, end: usize) -> ([(usize, bool); 2], Vec<usize>) {
        let next = [0, 1].map(|k| {
            let side = &edge.frame.sides[k];
            // The second face has the edge in the opposite direction.
            neighbour(self.body, side, (end == 1) == (k == 0))
        });
        let v = edge.frame.ends[end];
        let own = edge.frame.sides.map(|s| s.face);
        let others = self.around[&v].iter().copied().filter(|f| !own.contains(f)).collect();
        (next, others)
    }

    /// The length from the edge in a face.
    fn reach_in(&self, edge: &BlendEdge<T>, face: usize) -> Option<(T, Vec3<T>)> {
        let k = edge.frame.sides.iter().position(|s| s.face == face)?;
        Some((edge.reach[k], edge.frame.into[k]))
    }

    /// End of the blend of a straight edge.
    fn station(&self, edge: &BlendEdge<T>, end: usize) -> Result<SectionPlacing<T>, NoBody> {
        let frame = &edge.frame;
        let at = if end == 0 { frame.start } else { frame.finish };
        let along = frame.along;
        let out = if end == 0 { -along } else { along };
        let square = SectionPlacing::Plane { along, at, normal: along };
        let (next, others) = self.at_end(edge, end);
        if next.iter().any(|n| n.1) {
            return Ok(square);
        }
        let refuse = |text: &str| -> Result<SectionPlacing<T>, NoBody> {
            Err(TreatmentFault::new(
                text,
                Some(at.re()),
                "choose the other edges of the corner as well, or none of them",
            )
            .into())
        };
        let chosen = next.map(|n| self.edges.get(&n.0));
        let mixed = chosen.iter().flatten().any(|o| o.frame.convex != frame.convex);
        if mixed {
            return refuse("edges that stand out and edges that stand in meet");
        }
        let outward = if frame.convex { 1.0 } else { -1.0 };
        if let &[h] = &others[..]
            && let FaceForm::Plane { at: base, normal } = self.body.form(h)
        {
            let open = outward * normal.dot(out).re();
            if open.abs() < 1e-6 {
                return refuse("an edge ends in a face that runs along it");
            }
            if let (Some(r), true, [Some(_), Some(_)]) = (self.fillet, open > 0.0, chosen) {
                let centre = self.ball(edge.frame.ends[end], r)?.centre;
                return Ok(SectionPlacing::Plane { along, at: centre, normal: along });
            }
            let shared = match chosen {
                [Some(o), None] => Some((o, 0)),
                [None, Some(o)] => Some((o, 1)),
                [Some(_), Some(_)] if open < 0.0 => {
                    return refuse("three edges of a corner that stands in");
                }
                _ => None,
            };
            let to_face = SectionPlacing::Plane { along, at: base, normal };
            let Some((other, k)) = shared else { return Ok(to_face) };
            // At a convex corner, blends of different sizes intersect.
            let mitre = self.mitre(edge, other, k, at, next[1 - k].0);
            return if open > 0.0 { Ok(mitre.unwrap_or(to_face)) } else { mitre };
        }
        // Beyond the end there is nothing: as far as the other faces may reach.
        let mut length = 0.0f64;
        for &h in &others {
            let normal = self.body.surface_normal(h, at);
            let Some(normal) = normal else {
                return refuse("an edge ends in a face without a normal");
            };
            let steep = match self.body.form(h) {
                FaceForm::Plane { .. } => outward * normal.dot(out).re(),
                _ => normal.dot(out).re().abs(),
            };
            let round = !matches!(self.body.form(h), FaceForm::Plane { .. });
            if steep < 1e-3 || (round && (!frame.convex || others.len() > 1)) {
                return refuse("more than three faces meet, or a round one, where an edge ends");
            }
            for corner in edge.section.corners {
                let p = (SectionPlacing::Plane { along, at, normal: along }).point(corner);
                length = length.max(self.to_face(h, p, out).unwrap_or(f64::INFINITY));
            }
        }
        if others.is_empty() || !length.is_finite() {
            return refuse("the end of an edge is not found in the faces there");
        }
        let margin = 0.05 * edge.reach[0].re().max(edge.reach[1].re());
        Ok(SectionPlacing::Plane { along, at: at + out * T::from(length + margin), normal: along })
    }

    /// Distance from a point along a direction to a face, beyond the point.
    fn to_face(&self, face: usize, from: Vec3<T>, out: Vec3<T>) -> Option<f64> {
        let (p, d) = (from.re(), out.re());
        match self.body.form(face) {
            FaceForm::Plane { at, normal } => {
                Some(normal.re().dot(at.re() - p) / normal.re().dot(d)).filter(|x| x.is_finite())
            }
            _ => {
                let surface = self.body.surface(face)?;
                let far = 2.0 * self.size;
                let line =
                    SmoothPiece::straight(from - out * T::from(far), from + out * T::from(far));
                let start = surface.parameters(p);
                let on = [Carrier::Curve(&line), Carrier::Surface(&surface)];
                let met = meet(&on, p, &[[0.5, 0.0], start], self.size)?;
                Some((met.at.re() - p).dot(d))
            }
        }
    }

    /// Two blends that meet in a concave corner end in the plane between them.
    fn mitre(
        &self,
        edge: &BlendEdge<T>,
        other: &BlendEdge<T>,
        k: usize,
        at: Vec3<T>,
        third: usize,
    ) -> Result<SectionPlacing<T>, NoBody> {
        let fault = |text: &str| {
            NoBody::from(TreatmentFault::new(
                text,
                Some(at.re()),
                "choose equal sizes, or edges that meet at equal angles",
            ))
        };
        let face = edge.frame.sides[k].face;
        let along = edge.frame.along;
        let own = (edge.reach[k], edge.frame.into[k]);
        let Some(its) = self.reach_in(other, face) else {
            return Err(fault("two edges of a corner have no face in common"));
        };
        let meet = (its.0 - own.0 * own.1.dot(its.1)) / along.dot(its.1);
        let inner = own.1 * own.0 + along * meet;
        let [p, q] = self.body.edges[third].ends.map(|v| self.body.vertices[v].at);
        let normal = (q - p).cross(inner).normalized();
        let Some(normal) = normal.filter(|_| self.body.is_straight(third)) else {
            return Err(fault("two blends meet in no plane"));
        };
        let station = SectionPlacing::Plane { along, at, normal };
        let its_station = SectionPlacing::Plane { along: other.frame.along, at, normal };
        // Both sections must meet in one curve there.
        let samples = |e: &BlendEdge<T>, s: &SectionPlacing<T>, turned: bool| -> Vec<Vec3> {
            let [v, a, b] = e.section.corners;
            let piece = e.section.round.unwrap_or_else(|| SmoothPiece::straight(a, b));
            let at = |x: f64| s.point(piece.at(T::from(if turned { 1.0 - x } else { x }))).re();
            let mut all = vec![s.point(v).re()];
            all.extend([0.0, 0.25, 0.5, 0.75, 1.0].map(at));
            all
        };
        let turned = other.frame.sides[k].face != face;
        let (a, b) = (samples(edge, &station, false), samples(other, &its_station, turned));
        if a.iter().zip(&b).any(|(p, q)| p.distance(*q) > 1e-9 * self.size) {
            return Err(fault("two blends of a corner that stands in do not meet in one curve"));
        }
        Ok(station)
    }

    /// The ball at a corner of three chosen edges.
    fn ball(&self, v: usize, r: T) -> Result<BallCorner<T>, NoBody> {
        let corner = self.body.vertices[v].at;
        let fault = || {
            NoBody::from(TreatmentFault::new(
                "three fillets meet where no ball touches all faces",
                Some(corner.re()),
                SMALLER,
            ))
        };
        let faces: Vec<usize> = self.around[&v].iter().copied().collect();
        let &[a, b, c] = &faces[..] else { return Err(fault()) };
        let faces = [a, b, c];
        let mut normals = [Vec3::zero(); 3];
        for (k, f) in faces.iter().enumerate() {
            let FaceForm::Plane { normal, .. } = self.body.form(*f) else { return Err(fault()) };
            normals[k] = normal;
        }
        let at_corner = |e: &&BlendEdge<T>| e.frame.ends.contains(&v);
        let own: Vec<&BlendEdge<T>> = self.edges.values().filter(at_corner).collect();
        let convex = own.first().is_some_and(|e| e.frame.convex);
        if own.iter().any(|e| e.frame.axis.is_some()) {
            return Err(fault());
        }
        // n . (C - corner) = -r inside of the faces, r outside.
        let [x, y, z] = normals;
        let det = x.dot(y.cross(z));
        if det.re().abs() < 1e-9 {
            return Err(fault());
        }
        let depth = if convex { -r } else { r };
        let way = (y.cross(z) + z.cross(x) + x.cross(y)) * (depth / det);
        let centre = corner + way;
        let feet = normals.map(|n| centre - n * depth);
        let on_edges = [0, 1, 2].map(|k| {
            let d = normals[(k + 1) % 3].cross(normals[(k + 2) % 3]);
            corner + d * (d.dot(way) / d.norm_sq())
        });
        let names = faces.map(|f| self.body.faces[f].names.clone());
        Ok(BallCorner { corner, centre, feet, on_edges, names })
    }

    fn balls(&self, tools: &mut Vec<(bool, SketchSolid<T>)>) -> Result<(), NoBody> {
        let Some(r) = self.fillet else { return Ok(()) };
        let mut done = BTreeSet::new();
        for edge in self.edges.values().filter(|e| e.frame.axis.is_none()) {
            for end in 0..2 {
                let (next, others) = self.at_end(edge, end);
                let three = next.iter().all(|n| !n.1 && self.edges.contains_key(&n.0));
                if !three || others.len() != 1 || !done.insert(edge.frame.ends[end]) {
                    continue;
                }
                let ball = self.ball(edge.frame.ends[end], r)?;
                let solid = ball.solid().ok_or_else(|| {
                    TreatmentFault::new("no ball fits a corner", Some(ball.corner.re()), SMALLER)
                })?;
                tools.push((edge.frame.convex, solid));
            }
        }
        Ok(())
    }

    /// Refuses a blend that leaves its faces.
    fn extent(
        &self,
        edge: &BlendEdge<T>,
        stations: &[SectionPlacing<T>; 2],
        strips: &mut Vec<BlendStrip>,
    ) -> Result<(), NoBody> {
        for k in 0..2 {
            let face = edge.frame.sides[k].face;
            let corner = edge.section.corners[1 + k];
            let [a, b] = stations.each_ref().map(|s| s.point(corner).re());
            let inside = |p: Vec3| self.within(face, p);
            for part in [0.0, 0.25, 0.5, 0.75, 1.0] {
                // A blend that ends in the air may pass the end of its face.
                let beyond = part == 0.0 || part == 1.0;
                let p = a.lerp(b, part);
                let past = {
                    let [s, e] = [edge.frame.start, edge.frame.finish].map(Vec3::re);
                    let x = (p - s).dot(edge.frame.along.re());
                    x < 0.0 || x > s.distance(e)
                };
                let ends = beyond && past;
                if !(ends || inside(p)) {
                    let width = edge.reach[k].re();
                    let text = format!(
                        "a blend that reaches {width} from its edge leaves the face beside it"
                    );
                    return Err(TreatmentFault::new(text, Some(p), SMALLER).into());
                }
            }
            let [s, e] = stations.each_ref().map(|s| s.point(edge.section.corners[0]).re());
            strips.push(BlendStrip {
                face,
                kind: BlendStripKind::Quad([s, e, b, a]),
                middle: a.lerp(b, 0.5),
            });
        }
        Ok(())
    }

    /// True if a point in the plane of a face is inside its outer loop, or near it.
    fn within(&self, face: usize, p: Vec3) -> bool {
        let FaceForm::Plane { normal, .. } = self.body.form(face) else { return true };
        let axis = (0..3).max_by(|&a, &b| normal[a].re().abs().total_cmp(&normal[b].re().abs()));
        let (i, j) = match axis {
            Some(0) => (1, 2),
            Some(1) => (2, 0),
            _ => (0, 1),
        };
        let near = 1e-9 * self.size;
        let mut odd = false;
        for &h in &self.body.faces[face].loops[0] {
            let way = self.body.polyline(h.0, 72);
            for w in way.windows(2) {
                let [a, b] = [w[0].re(), w[1].re()];
                let d = b - a;
                let s = ((p - a).dot(d) / d.norm_sq()).clamp(0.0, 1.0);
                let chord = if way.len() > 2 { 2e-3 * d.norm() } else { 0.0 };
                if (a + d * s).distance(p) <= near.max(chord) {
                    return true;
                }
                if (a[j] > p[j]) != (b[j] > p[j]) {
                    let x = a[i] + (p[j] - a[j]) / (b[j] - a[j]) * d[i];
                    odd ^= x > p[i];
                }
            }
        }
        odd
    }

    /// The blends of round edges: rings, or parts of them.
    fn rings(
        &self,
        tools: &mut Vec<(bool, SketchSolid<T>)>,
        strips: &mut Vec<BlendStrip>,
    ) -> Result<(), NoBody> {
        let round: BTreeMap<usize, &BlendEdge<T>> = (self.edges.iter())
            .filter(|(_, e)| e.frame.axis.is_some())
            .map(|(k, e)| (*k, e))
            .collect();
        let outline = self.body.outline();
        let flat = |e: &BlendEdge<T>| {
            usize::from(!matches!(self.body.form(e.frame.sides[0].face), FaceForm::Plane { .. }))
        };
        let same = |a: &BlendEdge<T>, b: &BlendEdge<T>| {
            let [p, q] = [a, b].map(|e| {
                e.frame.axis.unwrap_or(Line { point: Vec3::zero(), direction: Vec3::zero() })
            });
            a.frame.sides[flat(a)].face == b.frame.sides[flat(b)].face
                && p.direction.re().cross(q.direction.re()).norm() < 1e-9
                && p.foot(q.point).re().distance(q.point.re()) <= 1e-9 * self.size
                && a.frame.convex == b.frame.convex
                && flat(a) == flat(b)
        };
        let mut left: BTreeSet<usize> = round.keys().copied().collect();
        while let Some(first) = left.iter().next().copied() {
            // Back to the start of the run, then along it.
            let before = |e: usize, left: &BTreeSet<usize>| {
                let start = round[&e].frame.ends[0];
                left.iter().copied().find(|o| {
                    *o != e && round[o].frame.ends[1] == start && same(round[o], round[&e])
                })
            };
            let mut head = first;
            while let Some(b) = before(head, &left) {
                if b == first {
                    break;
                }
                head = b;
            }
            let mut run = vec![head];
            left.remove(&head);
            loop {
                let last = round[&run[run.len() - 1]];
                let next = left
                    .iter()
                    .copied()
                    .find(|o| round[o].frame.ends[0] == last.frame.ends[1] && same(round[o], last));
                let Some(next) = next else { break };
                left.remove(&next);
                run.push(next);
            }
            let closed = round[&run[run.len() - 1]].frame.ends[1] == round[&run[0]].frame.ends[0];
            let edge = round[&run[0]];
            let Some(axis) = edge.frame.axis else { continue };
            let mut stations: Vec<(SectionPlacing<T>, bool)> = Vec::new();
            let mut angle = T::zero();
            let mut since = 0.0;
            for &e in &run {
                let side = &round[&e].frame.sides[flat(round[&e])];
                let chain = outline.way((e, side.forward));
                let count = chain.len();
                for (k, w) in chain.windows(2).enumerate() {
                    let [p, q] = [w[0], w[1]].map(|v| outline.points[v as usize]);
                    let vertex = k == 0 || since > std::f64::consts::FRAC_PI_2 - 0.1;
                    if vertex {
                        since = 0.0;
                    }
                    stations.push((SectionPlacing::Turned { axis, angle }, vertex));
                    let [a, b] = [p, q].map(|x| x - axis.foot(x));
                    let step = axis.direction.dot(a.cross(b)).atan2(a.dot(b));
                    angle += step;
                    since += step.re();
                    if k + 2 == count && !closed && e == run[run.len() - 1] {
                        stations.push((SectionPlacing::Turned { axis, angle }, true));
                    }
                }
            }
            if !closed {
                self.ends_of_arc(round[&run[0]], 0)?;
                self.ends_of_arc(round[&run[run.len() - 1]], 1)?;
            }
            self.extent_round(edge, &axis, flat(edge), angle.re(), strips)?;
            tools.push((edge.frame.convex, swept(&edge.section, &stations, closed)));
        }
        Ok(())
    }

    /// Refuses an arc that ends where its blend would not.
    fn ends_of_arc(&self, edge: &BlendEdge<T>, end: usize) -> Result<(), NoBody> {
        let flat = usize::from(!matches!(
            self.body.form(edge.frame.sides[0].face),
            FaceForm::Plane { .. }
        ));
        let side = &edge.frame.sides[flat];
        let (other, tangent) = neighbour(self.body, side, end == 1);
        if tangent && self.edges.contains_key(&other) {
            return Ok(());
        }
        let at = if end == 0 { edge.frame.start } else { edge.frame.finish };
        let (_, others) = self.at_end(edge, end);
        if let (Some(axis), &[h]) = (edge.frame.axis, &others[..])
            && let FaceForm::Plane { at: base, normal } = self.body.form(h)
        {
            let off = normal.dot(axis.point - base).re().abs() / self.size;
            if off < 1e-9 && normal.dot(axis.direction).re().abs() < 1e-9 {
                return Ok(());
            }
        }
        let next = "choose arcs that continue in other edges without a corner, or end in a plane through their axis";
        Err(TreatmentFault::new("an arc ends in a corner", Some(at.re()), next).into())
    }

    fn extent_round(
        &self,
        edge: &BlendEdge<T>,
        axis: &Line<T>,
        flat: usize,
        angle: f64,
        strips: &mut Vec<BlendStrip>,
    ) -> Result<(), NoBody> {
        let corners = edge.section.corners;
        let start = edge.frame.start;
        let radius = |p: Vec3<T>| (p - axis.foot(p)).re();
        let turned = |p: Vec3<T>, a: f64| axis.rotated(p, T::from(a)).re();
        let fault = |k: usize, p: Vec3| {
            let width = edge.reach[k].re();
            let text =
                format!("a blend that reaches {width} from its edge leaves the face beside it");
            NoBody::from(TreatmentFault::new(text, Some(p), SMALLER))
        };
        let own = radius(start);
        for (k, corner) in [(0, corners[1]), (1, corners[2])] {
            if radius(corner).dot(own) <= 1e-9 * own.norm_sq() {
                return Err(fault(k, corner.re()));
            }
            let face = edge.frame.sides[k].face;
            if k == flat {
                for part in 0..12 {
                    let p = turned(corner, angle * (f64::from(part) + 0.5) / 12.0);
                    if !self.within(face, p) {
                        return Err(fault(k, p));
                    }
                }
                let radii = [own.norm(), radius(corner).norm()];
                let kind = BlendStripKind::Ring([axis.point.re(), axis.direction.re()], radii);
                strips.push(BlendStrip { face, kind, middle: turned(corner, 0.5 * angle) });
            } else {
                let level = |p: Vec3| axis.direction.re().dot(p - start.re());
                let reach = level(corner.re());
                let all: Vec<f64> = (self.body.faces[face].loops.iter().flatten())
                    .flat_map(|&h| self.body.run(h))
                    .map(|p| level(p.re()) * reach.signum())
                    .collect();
                let most = all.iter().fold(0.0f64, |m, x| m.max(*x));
                if reach.abs() > most * (1.0 + 1e-9) {
                    return Err(fault(k, corner.re()));
                }
                let kind = BlendStripKind::Band([start.re(), axis.direction.re()], reach);
                strips.push(BlendStrip { face, kind, middle: turned(corner, 0.5 * angle) });
            }
        }
        Ok(())
    }
}

/// The part of a face that a blend takes.
struct BlendStrip {
    face: usize,
    kind: BlendStripKind,
    /// The middle of its far side.
    middle: Vec3,
}

enum BlendStripKind {
    Quad([Vec3; 4]),
    /// About an axis, between two radii.
    Ring([Vec3; 2], [f64; 2]),
    /// A half-line.
    Band([Vec3; 2], f64),
}

impl BlendStrip {
    fn has(&self, p: Vec3) -> bool {
        match self.kind {
            BlendStripKind::Quad(ring) => {
                let normal = super::facet_source::newell(&ring);
                let size = normal.norm();
                (0..4).all(|k| {
                    let (a, b) = (ring[k], ring[(k + 1) % 4]);
                    (b - a).cross(p - a).dot(normal) > 1e-9 * size * size
                })
            }
            BlendStripKind::Ring([at, direction], radii) => {
                let d = p - at;
                let r = (d - direction * d.dot(direction)).norm();
                let (low, high) = (radii[0].min(radii[1]), radii[0].max(radii[1]));
                r > low * (1.0 + 1e-9) && r < high * (1.0 - 1e-9)
            }
            BlendStripKind::Band([at, direction], reach) => {
                let x = (p - at).dot(direction) / reach;
                x > 1e-9 && x < 1.0 - 1e-9
            }
        }
    }
}

/// Refuses blends that take the same part of a face from two sides.
fn apart(strips: &[BlendStrip]) -> Result<(), NoBody> {
    for (k, a) in strips.iter().enumerate() {
        for b in &strips[..k] {
            if a.face == b.face && (a.has(b.middle) || b.has(a.middle)) {
                let text = "two blends meet within a face";
                return Err(TreatmentFault::new(text, Some(a.middle), SMALLER).into());
            }
        }
    }
    Ok(())
}

impl From<TreatmentFault> for NoBody {
    fn from(fault: TreatmentFault) -> NoBody {
        NoBody::Treatment(fault)
    }
}
