//! Edges of a body for chamfers and fillets: the adjacent faces, the direction into each, and the
//! edges of a choice.

use super::SketchSolid;
use super::curve::SmoothPiece;
use super::surface::FaceSurface;
use crate::feature::{EdgeChoice, FaceChoice};
use crate::{LineId, SketchObject};
use moldloft_num::{Axis as Line, Real, Vec3};
use std::collections::BTreeMap;

/// Reason why a treatment of edges or faces fails.
#[derive(Clone, Debug, PartialEq)]
pub struct TreatmentFault {
    /// Fault.
    pub text: String,
    /// Position.
    pub at: Option<Vec3>,
    /// Remedy.
    pub next: String,
}

impl TreatmentFault {
    pub(crate) fn new(text: impl Into<String>, at: Option<Vec3>, next: impl Into<String>) -> Self {
        TreatmentFault { text: text.into(), at, next: next.into() }
    }
}

/// Class of a face for its edges.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FaceForm<T> {
    /// A plane: a point of it and its outward normal.
    Plane { at: Vec3<T>, normal: Vec3<T> },
    /// A cylinder or cone about an axis.
    Straight(Line<T>),
    /// Another surface.
    Other,
}

/// A side of a face: the loop, the index in it, and whether it has the edge's direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeSide {
    pub face: usize,
    pub cycle: usize,
    pub place: usize,
    pub forward: bool,
}

/// An edge that can be treated.
#[derive(Clone, Debug)]
pub(crate) struct EdgeFrame<T> {
    pub sides: [EdgeSide; 2],
    /// The vertices that the first face runs it from and to.
    pub ends: [usize; 2],
    pub start: Vec3<T>,
    pub finish: Vec3<T>,
    /// The unit direction at the start.
    pub along: Vec3<T>,
    /// Unit vectors at the start, across the edge, into each face.
    pub into: [Vec3<T>; 2],
    /// True for a convex edge.
    pub convex: bool,
    /// The axis of a round edge, along which the angles from the start are positive.
    pub axis: Option<Line<T>>,
}

impl<T: Real> SketchSolid<T> {
    pub(crate) fn edge_sides(&self) -> Vec<Vec<EdgeSide>> {
        let mut sides = vec![Vec::new(); self.edges.len()];
        for (face, f) in self.faces.iter().enumerate() {
            for (cycle, edges) in f.loops.iter().enumerate() {
                for (place, &(edge, forward)) in edges.iter().enumerate() {
                    sides[edge].push(EdgeSide { face, cycle, place, forward });
                }
            }
        }
        sides
    }

    /// Points along an edge as a face runs it.
    pub(crate) fn run(&self, (edge, forward): (usize, bool)) -> Vec<Vec3<T>> {
        let mut way = self.polyline(edge, 8);
        if !forward {
            way.reverse();
        }
        way
    }

    pub(crate) fn is_straight(&self, edge: usize) -> bool {
        let e = &self.edges[edge];
        let way: Vec<Vec3> = match (&e.trace, e.piece) {
            (None, None) => return true,
            (Some(trace), _) => trace.points.iter().map(|p| p.re()).collect(),
            (None, Some(_)) => self.polyline(edge, 8).iter().map(|p| p.re()).collect(),
        };
        let [first, last] = [way[0], way[way.len() - 1]];
        let length = first.distance(last);
        length > 0.0
            && way
                .iter()
                .all(|p| (*p - first).cross(last - first).norm() <= 1e-10 * length * length)
    }

    pub(crate) fn form(&self, face: usize) -> FaceForm<T> {
        match self.surface(face) {
            None => {
                let ring: Vec<Vec3<T>> = (self.faces[face].loops.iter().take(1).flatten())
                    .flat_map(|&h| {
                        let mut way = self.run(h);
                        way.pop();
                        way
                    })
                    .collect();
                let Some(normal) = super::facet_source::newell(&ring).normalized() else {
                    return FaceForm::Other;
                };
                FaceForm::Plane { at: ring[0], normal }
            }
            Some(FaceSurface::Turned { centre, axis, profile, .. }) => match profile {
                SmoothPiece::Cubic([p, q, r, e]) => {
                    let way = (e - p).re();
                    let off = |x: Vec3<T>| (x - p).re().cross(way).norm();
                    if off(q).max(off(r)) <= 1e-10 * way.norm_sq() {
                        FaceForm::Straight(Line { point: centre, direction: axis })
                    } else {
                        FaceForm::Other
                    }
                }
                SmoothPiece::Conic { .. } => FaceForm::Other,
            },
            Some(FaceSurface::Ruled { near, far }) => ruled_form(&near, &far),
            Some(FaceSurface::Plane { at, normal }) => FaceForm::Plane { at, normal },
        }
    }

    /// Description of a face, by names and class; and a point of it.
    pub(crate) fn face_text(&self, face: usize) -> (String, Vec3) {
        let names: Vec<&str> = self.faces[face].names.iter().map(|n| &**n).collect();
        let name = if names.is_empty() { "without a name".to_owned() } else { names.join(", ") };
        let what = match self.form(face) {
            FaceForm::Plane { .. } => "plane",
            FaceForm::Straight(_) => "cylinder or cone",
            FaceForm::Other => "round",
        };
        let first = self.faces[face].loops.iter().flatten().next();
        let at = first.map_or(Vec3::zero(), |&h| self.run(h)[0].re());
        (format!("face {name}: {what}"), at)
    }

    /// The unit normal of a face's surface at a point of it, whichever side it looks to.
    pub(crate) fn surface_normal(&self, face: usize, at: Vec3<T>) -> Option<Vec3<T>> {
        match (self.form(face), self.surface(face)) {
            (FaceForm::Plane { normal, .. }, _) => Some(normal),
            (_, Some(surface)) => {
                let [u, v] = surface.parameters(at.re());
                let [_, du, dv] = surface.jet(T::from(u), T::from(v));
                du.cross(dv).normalized()
            }
            _ => None,
        }
    }

    /// True if the faces beside an edge have a common tangent plane.
    pub(crate) fn is_smooth(&self, sides: &[EdgeSide]) -> bool {
        let [a, b] = sides else { return false };
        let way = self.run(self.faces[a.face].loops[a.cycle][a.place]);
        let middle = way[way.len() / 2].lerp(way[(way.len() - 1) / 2], T::from(0.5));
        let middle = if way.len() > 2 { way[way.len() / 2] } else { middle };
        let normals = [a, b].map(|s| self.surface_normal(s.face, middle));
        let [Some(m), Some(n)] = normals else { return false };
        m.re().cross(n.re()).norm() <= 1e-7
    }

    /// An edge with the data for its treatment.
    pub(crate) fn edge_frame(
        &self,
        edge: usize,
        sides: &[EdgeSide],
        first: Option<usize>,
    ) -> Result<EdgeFrame<T>, TreatmentFault> {
        let middle = {
            let way = self.run((edge, true));
            way[way.len() / 2].re()
        };
        let refuse = |text: &str| {
            let next = "choose edges between planes, and round ones between a plane and a cylinder or cone";
            Err(TreatmentFault::new(text, Some(middle), next))
        };
        let &[a, b] = sides else { return refuse("an edge has not two faces") };
        if a.face == b.face || a.forward == b.forward {
            return refuse("an edge has one face on both sides");
        }
        let plane = |s: &EdgeSide| matches!(self.form(s.face), FaceForm::Plane { .. });
        let swap = match first {
            Some(f) => f == b.face,
            None => !plane(&a),
        };
        let sides = if swap { [b, a] } else { [a, b] };
        if self.is_smooth(&sides) {
            return refuse("the faces beside an edge are tangent there");
        }
        let run = |s: &EdgeSide| self.run((edge, s.forward));
        let ends = |s: &EdgeSide| {
            let [p, q] = self.edges[edge].ends;
            if s.forward { [p, q] } else { [q, p] }
        };
        let forms = sides.map(|s| self.form(s.face));
        if let [FaceForm::Plane { normal: m, .. }, FaceForm::Plane { normal: n, .. }] = forms {
            if !self.is_straight(edge) {
                return refuse("an edge between planes is not straight");
            }
            let ends = ends(&sides[0]);
            let [start, finish] = ends.map(|v| self.vertices[v].at);
            let Some(along) = (finish - start).normalized() else {
                return refuse("an edge has no length");
            };
            let unit = |v: Vec3<T>| v.normalized().unwrap_or(v);
            let into = [unit(m.cross(along)), unit(n.cross(-along))];
            let convex = n.dot(into[0]).re() < 0.0;
            return Ok(EdgeFrame { sides, ends, start, finish, along, into, convex, axis: None });
        }
        // The side on the plane determines the orientation; the order is kept.
        let flat = usize::from(!plane(&sides[0]));
        let (FaceForm::Plane { normal, .. }, FaceForm::Straight(axis)) =
            (forms[flat], forms[1 - flat])
        else {
            return refuse(
                "an edge is neither between planes nor between a plane and a cylinder or cone",
            );
        };
        if normal.re().cross(axis.direction.re()).norm() > 1e-9 {
            return refuse(
                "an edge lies in a plane that is not square to the axis of the round face",
            );
        }
        let ends = ends(&sides[flat]);
        let way = run(&sides[flat]);
        let start = self.vertices[ends[0]].at;
        let finish = self.vertices[ends[1]].at;
        let arm = start - axis.foot(start);
        let Some(radial) = arm.normalized() else { return refuse("an edge has no radius") };
        let turn = axis.direction.cross(radial);
        let forward = turn.re().dot((way[1] - way[0]).re()) > 0.0;
        let direction = if forward { axis.direction } else { -axis.direction };
        let along = direction.cross(radial);
        let flat_into = normal.cross(along);
        let Some(flat_into) = flat_into.normalized() else {
            return refuse("an edge has no radius");
        };
        let Some(ruling) = self.ruling(sides[1 - flat].face, start) else {
            return refuse("an edge has no ruling beside it");
        };
        // Into the round face: to where the rest of it is.
        let others: Vec<Vec3> = (self.faces[sides[1 - flat].face].loops.iter().flatten())
            .flat_map(|&h| self.run(h))
            .map(|p| p.re())
            .collect();
        let mean = others.iter().fold(Vec3::<f64>::zero(), |s, p| s + *p) / others.len() as f64;
        let up = (mean - start.re()).dot(normal.re());
        let ruling = if ruling.re().dot(normal.re()) * up < 0.0 { -ruling } else { ruling };
        let convex = normal.dot(ruling).re() < 0.0;
        let into = if flat == 0 { [flat_into, ruling] } else { [ruling, flat_into] };
        let axis = Some(Line { point: axis.point, direction });
        Ok(EdgeFrame { sides, ends, start, finish, along, into, convex, axis })
    }

    /// The unit direction of the straight line of a cylinder or cone through a point of it.
    fn ruling(&self, face: usize, at: Vec3<T>) -> Option<Vec3<T>> {
        let surface = self.surface(face)?;
        let place = super::combine::located(&surface, at, Vec3::zero(), None)?;
        let [_, _, dv] = surface.jet(place[0], place[1]);
        dv.normalized()
    }

    pub(crate) fn chosen_faces(&self, choice: &FaceChoice) -> Result<Vec<usize>, TreatmentFault> {
        let found: Vec<usize> = match choice {
            FaceChoice::Named(name) => (0..self.faces.len())
                .filter(|&f| self.faces[f].names.iter().any(|n| n.eq_ignore_ascii_case(name)))
                .collect(),
            FaceChoice::Extreme { axis, top } => {
                let k = axis.index();
                let sign = if *top { 1.0 } else { -1.0 };
                let level = |f: usize| match self.form(f) {
                    FaceForm::Plane { at, normal } if sign * normal[k].re() > 1.0 - 1e-9 => {
                        Some(sign * at[k].re())
                    }
                    _ => None,
                };
                let levels: Vec<Option<f64>> = (0..self.faces.len()).map(level).collect();
                let most = levels.iter().flatten().fold(f64::NEG_INFINITY, |m, x| m.max(*x));
                let size = self.vertices.iter().map(|v| v.at.re().norm()).fold(0.0, f64::max);
                let near = |x: &Option<f64>| x.is_some_and(|x| x >= most - 1e-9 * size);
                (0..self.faces.len()).filter(|&f| near(&levels[f])).collect()
            }
        };
        if found.is_empty() {
            return Err(TreatmentFault::new(
                format!("there is no face {choice}"),
                None,
                "LIST FACES names them",
            ));
        }
        Ok(found)
    }

    /// The edges that choices mean, each with the face that a first distance is measured in, where the
    /// choice says.
    pub(crate) fn chosen_edges(
        &self,
        choices: &[EdgeChoice],
        object: &SketchObject,
    ) -> Result<BTreeMap<usize, Option<usize>>, TreatmentFault> {
        let sides = self.edge_sides();
        let mut chosen: BTreeMap<usize, Option<usize>> = BTreeMap::new();
        for choice in choices {
            let mut found: Vec<(usize, Option<usize>)> = Vec::new();
            let sharp = |e: usize| !self.is_smooth(&sides[e]);
            match choice {
                EdgeChoice::All => {
                    found.extend((0..self.edges.len()).filter(|&e| sharp(e)).map(|e| (e, None)));
                }
                EdgeChoice::Along(axis) => {
                    for e in 0..self.edges.len() {
                        let [p, q] = self.edges[e].ends.map(|v| self.vertices[v].at.re());
                        let along = (q - p).normalized().unwrap_or_default();
                        if self.is_straight(e) && along[axis.index()].abs() > 1.0 - 1e-9 && sharp(e)
                        {
                            found.push((e, None));
                        }
                    }
                }
                EdgeChoice::Of(face) => {
                    for f in self.chosen_faces(face)? {
                        let own = self.faces[f].loops.iter().flatten().map(|h| h.0);
                        found.extend(own.filter(|&e| sharp(e)).map(|e| (e, Some(f))));
                    }
                }
                EdgeChoice::Between(a, b) => {
                    let [a, b] = [self.chosen_faces(a)?, self.chosen_faces(b)?];
                    for (e, own) in sides.iter().enumerate() {
                        let [x, y] = own[..] else { continue };
                        for (x, y) in [(x, y), (y, x)] {
                            if a.contains(&x.face) && b.contains(&y.face) {
                                found.push((e, Some(x.face)));
                                break;
                            }
                        }
                    }
                }
                EdgeChoice::Line(line) => found.extend(self.edges_of_line(*line, object, &sides)),
            }
            if found.is_empty() {
                return Err(TreatmentFault::new(
                    format!("no edge is {choice}"),
                    None,
                    "LIST FACES names the faces; EDGES ALL, ALONG axis, OF face, BETWEEN face face, or LINE n",
                ));
            }
            for (e, first) in found {
                chosen.entry(e).or_insert(first);
            }
        }
        Ok(chosen)
    }

    /// The edges between the faces that a drawn line has beside it.
    fn edges_of_line(
        &self,
        line: LineId,
        object: &SketchObject,
        sides: &[Vec<EdgeSide>],
    ) -> Vec<(usize, Option<usize>)> {
        let Some(drawn) = object.drawing.lines.get(&line) else { return vec![] };
        let ends = [drawn.p, drawn.q];
        let beside: Vec<String> = (object.faces.iter())
            .filter(|(_, face)| {
                face.loops().any(|cycle| {
                    let n = cycle.len();
                    (0..n).any(|k| {
                        let side = [cycle[k], cycle[(k + 1) % n]];
                        side == ends || side == [ends[1], ends[0]]
                    })
                })
            })
            .map(|(id, _)| id.to_string())
            .collect();
        let [a, b] = &beside[..] else { return vec![] };
        let named = |f: usize, name: &String| self.faces[f].names.iter().any(|n| **n == **name);
        (sides.iter().enumerate())
            .filter(|(_, own)| {
                let [x, y] = own[..] else { return false };
                let is = |p: usize, q: usize| named(p, a) && named(q, b);
                is(x.face, y.face) || is(y.face, x.face)
            })
            .map(|(e, _)| (e, None))
            .collect()
    }
}

/// A cylinder or cone between two circles about one axis.
fn ruled_form<T: Real>(near: &SmoothPiece<T>, far: &SmoothPiece<T>) -> FaceForm<T> {
    let SmoothPiece::Conic { centre, a, b, .. } = *near else { return FaceForm::Other };
    let size = a.re().norm();
    let round = |a: Vec3<T>, b: Vec3<T>| {
        let (a, b) = (a.re(), b.re());
        (a.norm() - b.norm()).abs() <= 1e-10 * size && a.dot(b).abs() <= 1e-10 * size * size
    };
    let Some(direction) = a.cross(b).normalized() else { return FaceForm::Other };
    if !round(a, b) {
        return FaceForm::Other;
    }
    let (other, fits) = match *far {
        SmoothPiece::Conic { centre: c, a: p, b: q, .. } => {
            // The same circle but for its size.
            let alike =
                (p.re().cross(a.re()).norm() + q.re().cross(b.re()).norm()) <= 1e-10 * size * size;
            (c, alike && round(p, q))
        }
        SmoothPiece::Cubic([p, _, _, e]) => (p, p.re().distance(e.re()) <= 1e-12 * size),
    };
    let off = (other - centre).re();
    let across = off - direction.re() * off.dot(direction.re());
    if fits && across.norm() <= 1e-9 * (size + off.norm()) {
        FaceForm::Straight(Line { point: centre, direction })
    } else {
        FaceForm::Other
    }
}
