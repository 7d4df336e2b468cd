//! Shapes of another program's drawing: strokes, and arcs and circles as the curves that a sketch draws into the
//! corners of lines.

use crate::format::page_curve::PageCurve;
use crate::format::page_meets::{OwnedCurve, separated};
use crate::solid::curve::{CurveKind, SketchCurve};
use crate::{
    DimensionExpr, Drawing, DrawnLine, DrawnPoint, LineTypeSource, PointId, SketchObject, Variable,
};
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, TAU};

/// A straight stroke on the page.
pub type Stroke = [[f64; 2]; 2];

/// Lines with smaller angles between them, in radians, continue straight.
const STRAIGHT: f64 = 1e-6;

/// The weight of the corner of a quarter of a circle or ellipse.
const QUARTER: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Shapes on the page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PageShapes {
    /// Straight lines.
    pub strokes: Vec<Stroke>,
    /// Arcs of at most a quarter circle: start, intersection of the end tangents, end, radius.
    pub arcs: Vec<([[f64; 2]; 3], f64)>,
    /// Circles and ellipses: the centre and two conjugate half-diameters.
    pub rounds: Vec<[[f64; 2]; 3]>,
    /// Other curves: parts of ellipses, and cubics.
    pub curves: Vec<PageCurve>,
    /// The stated unit of length of the drawing.
    pub unit: Option<&'static str>,
    /// Numbers of omitted entities, by kind.
    pub left_out: BTreeMap<String, usize>,
}

impl PageShapes {
    /// Counts an omitted shape.
    pub fn leave_out(&mut self, kind: &str) {
        *self.left_out.entry(kind.to_owned()).or_default() += 1;
    }

    /// Adds the arc about a centre from an angle on, counter-clockwise for a positive sweep.
    pub fn arc(&mut self, [x, y]: [f64; 2], radius: f64, start: f64, sweep: f64) {
        let parts = (sweep.abs() / FRAC_PI_2 - 1e-9).ceil().max(1.0);
        let step = sweep / parts;
        let at = |r: f64, a: f64| [x + r * libm::cos(a), y + r * libm::sin(a)];
        for k in 0..parts as usize {
            let a = start + step * k as f64;
            let corner = at(radius / libm::cos(0.5 * step), a + 0.5 * step);
            self.arcs.push(([at(radius, a), corner, at(radius, a + step)], radius));
        }
    }

    /// Adds the part of an ellipse with two conjugate half-diameters from an angle of its parameter on.
    pub fn elliptical(&mut self, centre: [f64; 2], [a, b]: [[f64; 2]; 2], start: f64, sweep: f64) {
        let parts = (sweep.abs() / FRAC_PI_2 - 1e-9).ceil().max(1.0);
        let step = sweep / parts;
        let at = |r: f64, t: f64| {
            let (x, y) = (r * libm::cos(t), r * libm::sin(t));
            [0, 1].map(|k| centre[k] + x * a[k] + y * b[k])
        };
        let weight = libm::cos(0.5 * step);
        for k in 0..parts as usize {
            let t = start + step * k as f64;
            let corner = [at(1.0, t), at(1.0 / weight, t + 0.5 * step), at(1.0, t + step)];
            self.curves.push(PageCurve::Conic(corner, weight));
        }
    }

    /// Adds a segment that bulges to the right by a quarter of the tangent of its angle, as in DXF.
    pub fn bulged(&mut self, p: [f64; 2], q: [f64; 2], bulge: f64) {
        if bulge.abs() < 1e-12 {
            self.strokes.push([p, q]);
            return;
        }
        let sweep = 4.0 * libm::atan(bulge);
        let chord = [q[0] - p[0], q[1] - p[1]];
        let length = libm::hypot(chord[0], chord[1]);
        let radius = 0.5 * length / libm::sin(0.5 * sweep).abs();
        // From the middle of the chord to the centre, to its left for a sweep of less than half a
        // turn.
        let offset = 0.5 / libm::tan(0.5 * sweep);
        let centre =
            [0.5 * (p[0] + q[0]) - offset * chord[1], 0.5 * (p[1] + q[1]) + offset * chord[0]];
        let start = libm::atan2(p[1] - centre[1], p[0] - centre[0]);
        self.arc(centre, radius, start, sweep);
    }

    /// Divides straight lines where they cross, and where an end of one is on another one within `tolerance`.
    pub fn split(&mut self, tolerance: f64) {
        let mut cuts: Vec<Vec<(f64, [f64; 2])>> = vec![Vec::new(); self.strokes.len()];
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let way = |p: [f64; 2], q: [f64; 2]| [q[0] - p[0], q[1] - p[1]];
        for i in 0..self.strokes.len() {
            for j in 0..i {
                let ([a, b], [c, d]) = (self.strokes[i], self.strokes[j]);
                let apart = (0..2).any(|k| {
                    a[k].max(b[k]) < c[k].min(d[k]) - tolerance
                        || c[k].max(d[k]) < a[k].min(b[k]) - tolerance
                });
                if apart {
                    continue;
                }
                let mut touched = false;
                for (one, [p, q], ends) in [(i, [a, b], [c, d]), (j, [c, d], [a, b])] {
                    let (line, length) = (way(p, q), libm::hypot(q[0] - p[0], q[1] - p[1]));
                    for end in ends {
                        let to = way(p, end);
                        let s = (line[0] * to[0] + line[1] * to[1]) / length;
                        let on = cross(line, to).abs() <= tolerance * length;
                        touched |= on && (-tolerance..=length + tolerance).contains(&s);
                        if on && s > tolerance && s < length - tolerance {
                            cuts[one].push((s / length, end));
                        }
                    }
                }
                let (u, v) = (way(a, b), way(c, d));
                let det = cross(u, v);
                if touched || det == 0.0 {
                    continue;
                }
                let (s, t) = (cross(way(a, c), v) / det, cross(way(a, c), u) / det);
                if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
                    let at = [a[0] + s * u[0], a[1] + s * u[1]];
                    cuts[i].push((s, at));
                    cuts[j].push((t, at));
                }
            }
        }
        let pieces = |([p, q], mut own): (Stroke, Vec<(f64, [f64; 2])>)| {
            own.sort_by(|a, b| a.0.total_cmp(&b.0));
            let way: Vec<[f64; 2]> =
                std::iter::once(p).chain(own.into_iter().map(|c| c.1)).chain([q]).collect();
            way.windows(2).map(|w| [w[0], w[1]]).collect::<Vec<Stroke>>()
        };
        let strokes = std::mem::take(&mut self.strokes);
        self.strokes = strokes.into_iter().zip(cuts).flat_map(pieces).collect();
    }

    /// Divides curves and lines where they meet, and curves until no other shape reaches between them and their corners.
    /// Returns the places where this fails: curves that touch there.
    pub fn separate(&mut self, tolerance: f64) -> Vec<[f64; 2]> {
        if self.arcs.is_empty() && self.rounds.is_empty() && self.curves.is_empty() {
            return Vec::new();
        }
        let (arcs, rounds) = (std::mem::take(&mut self.arcs), std::mem::take(&mut self.rounds));
        let strokes = std::mem::take(&mut self.strokes).into_iter().map(PageCurve::Line);
        let mut all: Vec<OwnedCurve> = Vec::new();
        let mut add =
            |curve: PageCurve, owner: usize| all.push(OwnedCurve { curve, owner, halved: 0 });
        for (k, (corner, radius)) in arcs.iter().enumerate() {
            let half = libm::hypot(corner[1][0] - corner[0][0], corner[1][1] - corner[0][1]);
            add(PageCurve::Conic(*corner, radius / libm::hypot(*radius, half)), k);
        }
        for (k, [c, a, b]) in rounds.iter().enumerate() {
            let at = |s: f64, t: f64| [c[0] + s * a[0] + t * b[0], c[1] + s * a[1] + t * b[1]];
            for [(s, t), (u, v)] in [[(1.0, 0.0), (0.0, 1.0)], [(0.0, 1.0), (-1.0, 0.0)]] {
                for sign in [1.0, -1.0] {
                    let ends = [at(sign * s, sign * t), at(sign * u, sign * v)];
                    let corner = at(sign * (s + u), sign * (t + v));
                    add(PageCurve::Conic([ends[0], corner, ends[1]], QUARTER), arcs.len() + k);
                }
            }
        }
        let others = std::mem::take(&mut self.curves).into_iter().chain(strokes);
        others.for_each(|curve| add(curve, usize::MAX));
        let touching = separated(&mut all, tolerance);
        // Quarters of whole circles and ellipses that are left.
        let mut quarters = vec![0; rounds.len()];
        let quarter = |part: &OwnedCurve| {
            let whole = matches!(part.curve, PageCurve::Conic(_, w) if (w - QUARTER).abs() < 1e-12);
            part.owner.checked_sub(arcs.len()).filter(|k| *k < rounds.len() && whole)
        };
        all.iter().filter_map(quarter).for_each(|k| quarters[k] += 1);
        for part in all {
            if let Some(k) = quarter(&part).filter(|k| [0, 4].contains(&quarters[*k])) {
                if std::mem::take(&mut quarters[k]) == 4 {
                    self.rounds.push(rounds[k]);
                }
                continue;
            }
            match (part.curve, arcs.get(part.owner)) {
                (PageCurve::Line(stroke), _) => self.strokes.push(stroke),
                (PageCurve::Conic(corner, _), Some(arc)) if arc.0 == corner => self.arcs.push(*arc),
                (curve, _) => self.curves.push(curve),
            }
        }
        touching
    }

    /// Largest coordinate of the shapes.
    pub fn size(&self) -> f64 {
        let curves = self.curves.iter().flat_map(PageCurve::points).copied();
        let arcs = self.arcs.iter().flat_map(|a| a.0).chain(curves);
        let rounds = self.rounds.iter().flat_map(|[c, a, b]| {
            [1.0, -1.0].map(|s| {
                [c[0] + s * (a[0].abs() + b[0].abs()), c[1] + s * (a[1].abs() + b[1].abs())]
            })
        });
        let all = self.strokes.iter().flatten().copied().chain(arcs).chain(rounds);
        all.fold(0.0, |s: f64, [u, v]| s.max(u.abs()).max(v.abs()))
    }

    /// Maximum number of lines drawn.
    pub fn line_count(&self) -> usize {
        let curves = self.arcs.len() + self.curves.len();
        self.strokes.len() + 2 * curves + 4 * self.rounds.len()
    }

    /// Draws the shapes into an object, with ends within `tolerance` merged: an arc that continues
    /// two lines becomes a rounding of their corner. Returns the numbers of new points and lines,
    /// and the names of new curves.
    pub fn draw(&self, object: &mut SketchObject, tolerance: f64) -> (usize, usize, Vec<String>) {
        let near =
            |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).abs().max((p[1] - q[1]).abs()) <= tolerance;
        let mut strokes = self.strokes.clone();
        let mut curves = Vec::new();
        self.curves.iter().for_each(|c| c.in_corners(&mut curves));
        let ends: Vec<[f64; 2]> = (self.strokes.iter().copied())
            .chain(self.arcs.iter().map(|([p, _, q], _)| [*p, *q]))
            .chain(curves.iter().map(PageCurve::ends))
            .flatten()
            .collect();
        for ([start, corner, end], _) in &self.arcs {
            for at in [start, end] {
                let straight = |s: &Stroke, k: usize| {
                    let (a, b) = (
                        [at[0] - s[1 - k][0], at[1] - s[1 - k][1]],
                        [corner[0] - at[0], corner[1] - at[1]],
                    );
                    let cross = a[0] * b[1] - a[1] * b[0];
                    let size = libm::hypot(a[0], a[1]) * libm::hypot(b[0], b[1]);
                    near(s[k], *at)
                        && a[0] * b[0] + a[1] * b[1] > 0.0
                        && cross.abs() <= STRAIGHT * size
                };
                let meeting = ends.iter().filter(|p| near(**p, *at)).count();
                let found = (0..strokes.len()).flat_map(|s| [(s, 0), (s, 1)]);
                let found = found.into_iter().find(|&(s, k)| straight(&strokes[s], k));
                match found.filter(|_| meeting == 2) {
                    Some((s, k)) => strokes[s][k] = *corner,
                    None => strokes.push([*at, *corner]),
                }
            }
        }
        for [c, a, b] in &self.rounds {
            let at = |s: f64, t: f64| [c[0] + s * a[0] + t * b[0], c[1] + s * a[1] + t * b[1]];
            let ring = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
            strokes.extend((0..4).map(|k| [ring[k], ring[(k + 1) % 4]]));
        }
        for curve in &curves {
            match curve.corner() {
                Some([p, m, q]) => strokes.extend([[p, m], [m, q]]),
                None => strokes.push(curve.ends()),
            }
        }
        let (points, lines) = draw(object.draw(), &strokes, tolerance);
        let mut names = Vec::new();
        for ([start, corner, end], radius) in &self.arcs {
            let drawing = object.drawing.clone();
            let Some(m) = point_at(&drawing, *corner, tolerance) else { continue };
            let ends = [start, end].map(|p| neighbour(&drawing, m, *corner, *p));
            let [Some(a), Some(b)] = ends else { continue };
            let radius = radius_name(object, *radius);
            names.push(add_curve(object, CurveKind::Arc, vec![a, m, b], Some(radius), vec![]));
        }
        for curve in &curves {
            let Some(corner) = curve.corner() else { continue };
            let drawing = object.drawing.clone();
            let find = corner.map(|p| point_at(&drawing, p, tolerance));
            let [Some(p), Some(m), Some(q)] = find else { continue };
            let shape = curve.shape().into_iter().map(DimensionExpr::number).collect();
            names.push(add_curve(object, CurveKind::Bezier, vec![p, m, q], None, shape));
        }
        for [c, a, b] in &self.rounds {
            let at = |s: f64, t: f64| [c[0] + s * a[0] + t * b[0], c[1] + s * a[1] + t * b[1]];
            let drawing = object.drawing.clone();
            let find = |p| point_at(&drawing, p, tolerance);
            let corners = [find(at(1.0, -1.0)), find(at(-1.0, -1.0)), find(at(-1.0, 1.0))];
            let [Some(p), Some(m), Some(q)] = corners else { continue };
            let kind = if is_circle(*a, *b) { CurveKind::Circle } else { CurveKind::Ellipse };
            names.push(add_curve(object, kind, vec![p, m, q], None, vec![]));
        }
        (points, lines, names)
    }
}

/// True if two conjugate half-diameters are those of a circle.
fn is_circle(a: [f64; 2], b: [f64; 2]) -> bool {
    let (x, y) = (libm::hypot(a[0], a[1]), libm::hypot(b[0], b[1]));
    (a[0] * b[0] + a[1] * b[1]).abs() <= 1e-9 * x * y && (x - y).abs() <= 1e-9 * x
}

/// The point drawn at a position.
pub(crate) fn point_at(drawing: &Drawing, at: [f64; 2], tolerance: f64) -> Option<PointId> {
    let near = |p: &crate::DrawnPoint| (p.u - at[0]).abs().max((p.v - at[1]).abs()) <= tolerance;
    drawing.points.iter().find(|(_, p)| near(p)).map(|(id, _)| *id)
}

/// The other end of the line from a corner towards a position.
fn neighbour(drawing: &Drawing, m: PointId, corner: [f64; 2], to: [f64; 2]) -> Option<PointId> {
    let way = [to[0] - corner[0], to[1] - corner[1]];
    let other =
        |l: &crate::DrawnLine| (l.p == m).then_some(l.q).or_else(|| (l.q == m).then_some(l.p));
    drawing.lines.values().filter_map(other).find(|id| {
        let p = drawing.points[id];
        let d = [p.u - corner[0], p.v - corner[1]];
        let size = libm::hypot(d[0], d[1]) * libm::hypot(way[0], way[1]);
        let (cross, dot) = (d[0] * way[1] - d[1] * way[0], d[0] * way[0] + d[1] * way[1]);
        cross.abs() <= 10.0 * STRAIGHT * size && dot > 0.0
    })
}

/// The name of a variable for a radius: one for all arcs of it.
pub(crate) fn radius_name(object: &mut SketchObject, radius: f64) -> DimensionExpr {
    let same = |v: &&Variable| {
        v.name.starts_with('R')
            && v.value.literal().is_some_and(|x| (x - radius).abs() <= 1e-9 * radius)
    };
    let name = match object.variables.values().find(same) {
        Some(v) => v.name.clone(),
        None => {
            let name = object.fresh_name("R");
            let value = DimensionExpr::number(radius);
            let variable = Variable { name: name.clone(), value, range: None };
            object.variables.insert(name.to_ascii_lowercase(), variable);
            name
        }
    };
    DimensionExpr::parse(&name).unwrap_or_else(|_| DimensionExpr::number(radius))
}

pub(crate) fn add_curve(
    object: &mut SketchObject,
    kind: CurveKind,
    points: Vec<PointId>,
    radius: Option<DimensionExpr>,
    shape: Vec<DimensionExpr>,
) -> String {
    let name = object.fresh_name("C");
    let curve = SketchCurve {
        name: name.clone(),
        kind,
        points,
        radius,
        semi: None,
        shape,
        steps: None,
        replaces: true,
        centripetal: false,
    };
    object.curves.insert(name.to_ascii_lowercase(), curve);
    name
}

pub(crate) const TURN: f64 = TAU;

/// Adds strokes to a drawing, ends within `tolerance` being one point; the numbers of new points and
/// lines.
pub fn draw(drawing: &mut Drawing, strokes: &[Stroke], tolerance: f64) -> (usize, usize) {
    let cell = |x: f64| (x / (2.0 * tolerance.max(f64::MIN_POSITIVE))).round() as i64;
    let mut known: std::collections::BTreeMap<[i64; 2], Vec<PointId>> = Default::default();
    for (&id, p) in &drawing.points {
        known.entry([cell(p.u), cell(p.v)]).or_default().push(id);
    }
    let (mut points, mut lines) = (0, 0);
    let mut next_point = drawing.next_point().0;
    let mut next_line = drawing.next_line().0;
    let mut joined: std::collections::BTreeSet<(PointId, PointId)> =
        drawing.lines.values().map(|l| (l.p.min(l.q), l.p.max(l.q))).collect();
    for stroke in strokes {
        let [p, q] = stroke.map(|[u, v]| {
            let [i, j] = [cell(u), cell(v)];
            let around = (-1..=1).flat_map(|a| (-1..=1).map(move |b| [i + a, j + b]));
            let near = around.filter_map(|c| known.get(&c)).flatten().copied().find(|id| {
                let p = drawing.points[id];
                (p.u - u).abs().max((p.v - v).abs()) <= tolerance
            });
            near.unwrap_or_else(|| {
                let id = PointId(next_point);
                next_point += 1;
                points += 1;
                drawing.points.insert(id, DrawnPoint { u, v });
                known.entry([i, j]).or_default().push(id);
                id
            })
        });
        if p != q && joined.insert((p.min(q), p.max(q))) {
            let id = crate::LineId(next_line);
            next_line += 1;
            lines += 1;
            let line =
                DrawnLine { p, q, free: None, source: LineTypeSource::Auto, confidence: 0.0 };
            drawing.lines.insert(id, line);
            drawing.type_by_slope(id);
        }
    }
    (points, lines)
}
