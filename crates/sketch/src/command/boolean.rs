//! UNION, CUT, COMMON.

use super::CommandError;
use super::args::Args;
use super::session::{Reply, Session};
use crate::solid::faces::{self, Operation, Walls};
use crate::solid::merge::{self, Placed};
use crate::{
    Align, Axis, Dimension, Expr, Face, FaceId, Free, Line, Measure, Object, Planes, Point,
    PointId, Role, Source,
};
use moldloft_num::Vec3;
use moldloft_syntax::number::plain;
use std::collections::{BTreeMap, BTreeSet};

impl Session {
    /// Combines two bodies. The result keeps the dimensions of both; where they meet, new points take
    /// the planes that they lie in, so it stays parametric.
    pub(super) fn combine(&mut self, args: &mut Args, verb: &str) -> Result<(), CommandError> {
        let operation = match verb {
            "UNION" => Operation::Union,
            "CUT" => Operation::Cut,
            _ => Operation::Common,
        };
        let names =
            [args.name("the name of an object")?, args.name("the name of a second object")?];
        let target = if args.take_short("INTO") { args.name("a name")? } else { names[0].clone() };
        args.end()?;
        if target.is_empty() || target.chars().count() > 32 {
            return Err(args.wants("a name of 1 to 32 characters"));
        }
        let mut parts = Vec::new();
        for name in &names {
            let object = self.known(name)?.clone();
            if object.drawing.section.is_some() {
                return Err(CommandError::new(
                    114,
                    format!("{} is a cross section; only solids are combined", object.name),
                    "EXTRUDE it first",
                ));
            }
            let at = self.placed(&object)?;
            let Some(solid) = self.solid_of(&straight(&object)) else {
                return Err(CommandError::new(
                    701,
                    format!("{} has no faces yet", object.name),
                    format!("GENERATE FACES {}", object.name),
                ));
            };
            let mesh = crate::format::export::Facets::of(&solid.mesh(1.0));
            let corners = |t: &[u32; 3]| t.map(|v| mesh.vertices[v as usize]);
            let walls = Walls { triangles: mesh.triangles.iter().map(corners).collect() };
            parts.push((object, at, walls));
        }
        if parts[0].0.name.eq_ignore_ascii_case(&parts[1].0.name) {
            return Err(CommandError::text(
                format!("{verb} needs two different objects, not {} twice", parts[0].0.name),
                "COPY makes another",
            ));
        }
        let mut walls = Vec::new();
        let mut placed = Vec::new();
        for (object, at, own) in &parts {
            walls.push(own);
            placed.push(Placed { object, at: at.clone() });
        }
        let size = parts.iter().flat_map(|p| p.1.values()).map(|p| p.norm()).fold(0.0, f64::max);
        let tolerance = 1e-6 * size;
        let (mut made, _) = merge::merge(&target, &placed, tolerance, false, &lay);
        let curves: Vec<String> = made.curves.values().map(|c| c.name.clone()).collect();
        let planes = Planes::of(&made.drawing);
        let Some(mut at) = lay(&made)
            .positions(&planes)
            .map(|p| planes.ids().iter().copied().zip(p).collect::<BTreeMap<PointId, Vec3>>())
        else {
            return Err(CommandError::new(
                404,
                "together they are not fully dimensioned",
                "give both all dimensions first",
            ));
        };
        let ids: Vec<PointId> = at.keys().copied().collect();
        let positions: Vec<Vec3> = at.values().copied().collect();
        let index = |p: PointId| ids.binary_search(&p).unwrap_or(0);
        let edges: Vec<[usize; 2]> =
            made.drawing.lines.values().map(|l| [index(l.p), index(l.q)]).collect();
        let Some((vertices, fit)) =
            faces::combine(&positions, &edges, [walls[0], walls[1]], operation)
        else {
            return Err(CommandError::new(
                200,
                "there are too many pieces",
                "combine smaller objects",
            ));
        };
        if fit.faces.is_empty() {
            return Err(CommandError::new(
                701,
                format!("{verb} of {} and {} is empty", parts[0].0.name, parts[1].0.name),
                "MOVE one of them, or CHECK the dimensions",
            ));
        }
        let faces = rebuild(&mut made, &mut at, &ids, &vertices, &fit.faces, tolerance);
        let unused: Vec<[PointId; 2]> = {
            let mut used: BTreeSet<(PointId, PointId)> = BTreeSet::new();
            for cycle in faces.iter().flat_map(Face::loops) {
                for k in 0..cycle.len() {
                    let (p, q) = (cycle[k], cycle[(k + 1) % cycle.len()]);
                    used.insert((p.min(q), p.max(q)));
                }
            }
            let lines = made.drawing.lines.values();
            let unused = lines.filter(|l| !used.contains(&(l.p.min(l.q), l.p.max(l.q))));
            unused.map(|l| [l.p, l.q]).collect()
        };
        let mut result = merge::clean(&made, &unused, &at);
        let mut report = merge::Merged::default();
        merge::settle(&mut result, &mut report, &lay);
        let points = |f: &Face| f.loops().flatten().all(|p| result.drawing.points.contains_key(p));
        if !faces.iter().all(points) {
            return Err(CommandError::new(701, "the faces do not close", "MERGE them instead"));
        }
        result.faces = (1..).map(FaceId).zip(faces).collect();
        let lost: Vec<String> = curves.into_iter().filter(|c| !result.has_name(c)).collect();
        let text = format!(
            "{target}: {} points, {} lines, {} faces, volume {}",
            result.drawing.points.len(),
            result.drawing.lines.len(),
            result.faces.len(),
            plain(fit.volume)
        );
        self.out.push(Reply::note(text));
        if !lost.is_empty() {
            let text = format!("curves whose corners are gone: {}", lost.join(", "));
            self.out.push(Reply::warning(text));
        }
        self.insert(result);
        self.report_validity()
    }
}

fn straight(object: &Object) -> Object {
    Object { curves: indexmap::IndexMap::new(), ..object.clone() }
}

fn lay(object: &Object) -> crate::Layout<f64> {
    let planes = Planes::of(&object.drawing);
    crate::solve(object, &planes, &BTreeMap::new(), &|| {
        crate::Estimate::of(&object.drawing, &planes, object.reference()?.point)
    })
}

/// Adds the points and lines that the faces need; returns the faces in labels.
fn rebuild(
    made: &mut Object,
    at: &mut BTreeMap<PointId, Vec3>,
    ids: &[PointId],
    vertices: &[Vec3],
    polygons: &[faces::Polygon],
    tolerance: f64,
) -> Vec<Face> {
    let mut label: BTreeMap<usize, PointId> = ids.iter().copied().enumerate().collect();
    let cycles = || polygons.iter().flat_map(|p| std::iter::once(&p.outer).chain(&p.holes));
    let new: BTreeSet<usize> = cycles().flatten().copied().filter(|v| *v >= ids.len()).collect();
    for v in new {
        let p = vertices[v];
        let id = made.drawing.next_point();
        let [u, w] = made.drawing.projection.project(p);
        let drawing = made.draw();
        drawing.points.insert(id, Point { u, v: w });
        let planes = Planes::of(&made.drawing);
        for axis in Axis::ALL {
            let k = axis.index();
            // Points that went into planes of old ones count too, so nothing is given twice.
            let same = at.iter().find(|(q, x)| {
                (x[k] - p[k]).abs() <= tolerance && planes.plane(axis, **q).is_some()
            });
            match same {
                Some((&q, _)) => made.draw().aligns.push(Align { axis, p: q, q: id }),
                None => {
                    let name = made.fresh_name("P");
                    made.add_dimension(Dimension {
                        name,
                        measure: Measure::Datum { axis, point: id },
                        value: Some(Expr::number(p[k])),
                        role: Role::Driving,
                        range: None,
                    });
                }
            }
        }
        at.insert(id, p);
        label.insert(v, id);
    }
    let planes = Planes::of(&made.drawing);
    for cycle in cycles() {
        for k in 0..cycle.len() {
            let (p, q) = (label[&cycle[k]], label[&cycle[(k + 1) % cycle.len()]]);
            if made.drawing.line_between(p, q).is_some() {
                continue;
            }
            let free = Free::those(|a| !planes.same(a, p, q));
            let line = Line { p, q, free, source: Source::User, confidence: 1.0 };
            let id = made.drawing.next_line();
            made.draw().lines.insert(id, line);
        }
    }
    let cycle = |c: &Vec<usize>| c.iter().map(|v| label[v]).collect::<Vec<_>>();
    let face = |f: &faces::Polygon| Face {
        outer: cycle(&f.outer),
        holes: f.holes.iter().map(cycle).collect(),
    };
    polygons.iter().map(face).collect()
}
