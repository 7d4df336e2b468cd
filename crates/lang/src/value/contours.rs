//! Measures of contours: `stations.lengths`, `stations.areas`, `stations.lines`,
//! `stations.positions`.
//!
//! A section consists of the intersections of all its surfaces and bodies, with the images in the
//! model's planes of symmetry that are in the same section. Lines that meet are joined; closed ones
//! bound an area, a loop inside another is a hole.

use crate::model_file::header;
use crate::run::interpreter::Interpreter;
use moldloft_diag::{Diagnostic, Span};
use moldloft_model::{Graph, Object};
use moldloft_num::trace::Key;
use moldloft_num::{Real, Vec3};
use moldloft_panel::{Contour, ContourCutter, ContourPiece, body_integrals, contour_piece};
use moldloft_registry::{Array, Class, Contours, Role, Scalar, Value, Vectors};
use moldloft_syntax::number;
use std::sync::Arc;

/// The names of the members.
pub const MEMBERS: [&str; 4] = ["positions", "lengths", "areas", "lines"];

/// Distance of the ends of lines, relative to the section's size, within which they meet.
const MEET: f64 = 1e-9;

/// Tolerance of equal lines, relative to their length.
const SAME: f64 = 1e-9;

struct MeasuredSection<T> {
    length: T,
    area: T,
    /// The longest chord that closes a line for its area.
    chord: f64,
    lines: Vec<Vec<Vec3>>,
}

/// Lines that follow each other.
struct LineChain<T> {
    points: Vec<Vec3>,
    from: Vec3<T>,
    to: Vec3<T>,
    swept: Vec3<T>,
}

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// The member `word` of a contours object; `None` for other words.
    pub fn contours_member(
        &mut self,
        object: Key,
        contours: &Contours<T>,
        word: &str,
        span: Span,
    ) -> Option<Result<Value<T>, Diagnostic>> {
        MEMBERS.contains(&word).then(|| self.measured_contours(object, contours, word, span))
    }

    fn measured_contours(
        &mut self,
        object: Key,
        contours: &Contours<T>,
        word: &str,
        span: Span,
    ) -> Result<Value<T>, Diagnostic> {
        let name = self.run.graph().get(object).map_or_else(String::new, |o| o.name.to_string());
        let row = |items| Ok(Value::Numbers(Arc::new(Array::row(items))));
        if word == "positions" {
            return row(contours.values.clone());
        }
        if word == "areas"
            && contours.values.first().is_some_and(|&x| contours.family.normal(x).is_none())
        {
            return Err(Diagnostic::error(
                "not-planar",
                format!("the sections of `{name}` are not plane"),
            )
            .expected("sections by planes or half-planes")
            .help("`.lengths` and `.lines` of sections by cylinders are there"));
        }
        let shapes = self.cut_shapes(object, span)?;
        let planes: Vec<usize> = {
            let letters = header::text(self.run.graph(), "symmetry");
            (0..3).filter(|&k| letters.contains(['x', 'y', 'z'][k])).collect()
        };
        let graph = self.run.graph();
        let measured =
            contours.values.iter().map(|&x| section(graph, contours, x, &shapes, &planes));
        let sections: Vec<MeasuredSection<T>> = measured.collect::<Result<_, Diagnostic>>()?;
        if word == "lines" {
            let lines = sections.into_iter().flat_map(|s| s.lines).map(|line| {
                let points = line.into_iter().map(Vec3::lifted).collect();
                Value::Vectors(Arc::new(Vectors::row(points)))
            });
            return Ok(Value::list(lines));
        }
        if word == "lengths" {
            return row(sections.iter().map(|s| s.length).collect());
        }
        let open = sections.iter().filter(|s| s.chord > 0.0).count();
        if let Some((k, worst)) =
            sections.iter().enumerate().max_by(|a, b| a.1.chord.total_cmp(&b.1.chord))
            && open > 0
        {
            let message = format!(
                "{open} of {} sections of `{name}` are open; straight chords close them for their areas",
                sections.len()
            );
            self.report(Diagnostic::remark("open-contour", message).at(span).found(format!(
                "a chord of {} at {}",
                number::plain(worst.chord),
                number::plain(contours.values[k].re())
            )));
        }
        row(sections.iter().map(|s| s.area).collect())
    }

    /// The surfaces and bodies that contours cut: those of their list, or all that are shown. They are read, so that
    /// the number follows them.
    fn cut_shapes(&mut self, object: Key, span: Span) -> Result<Vec<(Key, Value<T>)>, Diagnostic> {
        let graph = self.run.graph();
        let keys = graph
            .get(object)
            .and_then(|o| listed_shapes(graph, o))
            .unwrap_or_else(|| graph.objects().filter(|o| o.head.shown()).map(|o| o.key).collect());
        let mut shapes = Vec::new();
        for key in keys {
            let class = self.run.graph().get(key).map(|o| o.row.class);
            let cut = class.is_some_and(|c| matches!(c, Class::Surface | Class::Mesh | Class::Any));
            if !cut {
                continue;
            }
            let value = self.read(Value::Object(key), span)?;
            if matches!(value, Value::Surface(_) | Value::Body(_)) {
                shapes.push((key, value));
            }
        }
        Ok(shapes)
    }
}

/// The surfaces and bodies that the list of a contours object names; `None` without a list.
pub fn listed_shapes<T: Scalar>(graph: &Graph<T>, object: &Object<T>) -> Option<Vec<Key>> {
    fn collect<T: Scalar>(graph: &Graph<T>, value: &Value<T>, keys: &mut Vec<Key>) {
        match value {
            Value::Object(key) => match graph.get(*key) {
                Some(list) if list.row.role == Role::List => {
                    list.args.iter().for_each(|items| collect(graph, items, keys));
                }
                _ => keys.push(*key),
            },
            Value::List(items) => items.iter().for_each(|item| collect(graph, item, keys)),
            Value::Surface(surface) => keys.extend(surface.key),
            _ => {}
        }
    }
    let list = object.args.get(object.row.field("surfaces")?)?;
    if matches!(list, Value::Unset) {
        return None;
    }
    let mut keys = Vec::new();
    collect(graph, list, &mut keys);
    Some(keys)
}

/// The section of the shapes at `x`.
fn section<T: Scalar>(
    graph: &Graph<T>,
    contours: &Contours<T>,
    x: T,
    shapes: &[(Key, Value<T>)],
    planes: &[usize],
) -> Result<MeasuredSection<T>, Diagnostic> {
    let family = &contours.family;
    let mut pieces: Vec<ContourPiece<T>> = Vec::new();
    let mut found =
        MeasuredSection { length: T::zero(), area: T::zero(), chord: 0.0, lines: Vec::new() };
    // Sums of bodies, whose triangles say which side is inside.
    let mut swept: Vec3<T> = Vec3::zero();
    for (key, shape) in shapes {
        let Some(object) = graph.get(*key) else { continue };
        let failed = || {
            let at = number::plain(x.re());
            Diagnostic::error("no-contour", format!("`{}` cannot be followed at {at}", object.name))
                .help("the section runs along the surface there: move it a little")
        };
        match shape {
            Value::Surface(surface) => {
                for line in ContourCutter::new(surface, &object.head).section(family, x) {
                    let piece = contour_piece(&line, surface, family, x, Vec3::zero());
                    let piece = piece.ok_or_else(failed)?;
                    // An edge that two surfaces share is on the section of both.
                    if !pieces.iter().any(|other| is_same(&piece, other)) {
                        pieces.push(piece);
                        found.lines.push(closed_points(line));
                    }
                }
            }
            Value::Body(body) => {
                let (length, area, lines) = body_integrals(body, family, x, Vec3::zero())
                    .ok_or_else(|| {
                        Diagnostic::error(
                            "not-planar",
                            format!(
                                "sections of the body `{}` by cylinders are not measured",
                                object.name
                            ),
                        )
                        .expected("sections by planes or half-planes, or surfaces")
                    })?;
                found.length += length;
                swept += area;
                found.lines.extend(lines.into_iter().map(closed_points));
            }
            _ => {}
        }
    }
    let size = pieces.iter().flat_map(|p| &p.points).fold(0.0f64, |m, p| m.max(p.norm()));
    let near = MEET * size;
    for &axis in planes.iter().filter(|&&axis| family.is_symmetric(axis)) {
        let aside = |p: &ContourPiece<T>| p.points.iter().any(|q| q[axis].abs() > near);
        let images: Vec<_> =
            pieces.iter().filter(|p| aside(p)).map(|p| mirrored(p, axis)).collect();
        pieces.extend(images);
        found.length *= T::from(2.0);
        // The image of a body's section has the same area.
        swept = swept * T::from(2.0);
    }
    found.length = pieces.iter().fold(found.length, |sum, piece| sum + piece.length);
    let Some(normal) = family.normal(x) else { return Ok(found) };
    let chains = chained(pieces, near);
    let plain = normal.re();
    let outlines: Vec<Vec<[f64; 2]>> = chains.iter().map(|c| flat(&c.points, plain)).collect();
    for (k, chain) in chains.iter().enumerate() {
        let gap = chain.to.re().distance(chain.from.re());
        if gap > near {
            found.chord = found.chord.max(gap);
        }
        let closed = chain.swept + chain.to.cross(chain.from) * T::from(0.5);
        let area = closed.dot(normal);
        let area = if area.re() < 0.0 { -area } else { area };
        let around = outlines.iter().enumerate().filter(|(other, outline)| {
            *other != k && outlines[k].first().is_some_and(|p| is_inside(*p, outline))
        });
        if around.count() % 2 == 0 { found.area += area } else { found.area -= area }
    }
    found.area += swept.dot(normal);
    Ok(found)
}

/// True for coincident lines, in either direction.
fn is_same<T: Real>(a: &ContourPiece<T>, b: &ContourPiece<T>) -> bool {
    let near = SAME * (a.length.re() + b.length.re());
    let meet = |p: Vec3<T>, q: Vec3<T>| p.re().distance(q.re()) <= near;
    let size = a.points.iter().fold(0.0f64, |size, p| size.max(p.norm()));
    let alike = |x: Vec3<T>, y: Vec3<T>| (x - y).re().norm() <= near * size;
    (a.length - b.length).re().abs() <= near
        && (meet(a.from, b.from) && meet(a.to, b.to) && alike(a.swept, b.swept)
            || meet(a.from, b.to) && meet(a.to, b.from) && alike(a.swept, -b.swept))
}

fn closed_points(line: Contour) -> Vec<Vec3> {
    let again = line.points.first().copied().filter(|_| line.closed);
    line.points.into_iter().chain(again).collect()
}

/// The image of a point in the plane of coordinate `axis` = 0.
fn image<T: Real>(p: Vec3<T>, axis: usize) -> Vec3<T> {
    let mut all = p.to_array();
    all[axis] = -all[axis];
    Vec3::from(all)
}

/// The image of a line in the plane of coordinate `axis` = 0.
fn mirrored<T: Real>(piece: &ContourPiece<T>, axis: usize) -> ContourPiece<T> {
    ContourPiece {
        points: piece.points.iter().map(|&p| image(p, axis)).collect(),
        from: image(piece.from, axis),
        to: image(piece.to, axis),
        length: piece.length,
        // r x dr is an axial vector.
        swept: -image(piece.swept, axis),
    }
}

/// Lines end to end, as far as they meet within `near`.
fn chained<T: Real>(pieces: Vec<ContourPiece<T>>, near: f64) -> Vec<LineChain<T>> {
    let mut left: Vec<Option<ContourPiece<T>>> = pieces.into_iter().map(Some).collect();
    let mut chains = Vec::new();
    for k in 0..left.len() {
        let Some(first) = left[k].take() else { continue };
        let ContourPiece { points, from, to, swept, .. } = first;
        let mut chain = LineChain { points, from, to, swept };
        // At its end, and when nothing follows there, turned about at its other.
        for _ in 0..2 {
            while chain.to.re().distance(chain.from.re()) > near || chain.points.len() < 3 {
                let end = chain.to.re();
                let meets = |p: &Option<ContourPiece<T>>| {
                    let p = p.as_ref()?;
                    let at = |q: Vec3<T>| q.re().distance(end) <= near;
                    if at(p.from) { Some(false) } else { at(p.to).then_some(true) }
                };
                let Some((at, backward)) =
                    left.iter().enumerate().find_map(|(k, p)| Some((k, meets(p)?)))
                else {
                    break;
                };
                let Some(mut next) = left[at].take() else { break };
                if backward {
                    next.points.reverse();
                    std::mem::swap(&mut next.from, &mut next.to);
                    next.swept = -next.swept;
                }
                chain.points.extend(next.points);
                chain.swept += next.swept;
                chain.to = next.to;
            }
            chain.points.reverse();
            std::mem::swap(&mut chain.from, &mut chain.to);
            chain.swept = -chain.swept;
        }
        chains.push(chain);
    }
    chains
}

/// The points in a plane of that normal.
fn flat(points: &[Vec3], normal: Vec3) -> Vec<[f64; 2]> {
    let least = (0..3).min_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let axis = Vec3::from(axis);
    let across = normal.cross(axis).normalized().unwrap_or(axis);
    let along = across.cross(normal);
    points.iter().map(|p| [p.dot(across), p.dot(along)]).collect()
}

/// True if a point is inside a polygon, by the crossings of a ray.
fn is_inside([x, y]: [f64; 2], polygon: &[[f64; 2]]) -> bool {
    let ends = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let crossed = ends.filter(|([ax, ay], [bx, by])| {
        (*ay > y) != (*by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax)
    });
    crossed.count() % 2 == 1
}
