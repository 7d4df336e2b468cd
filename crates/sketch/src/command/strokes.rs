//! `STROKES SAMPLES`: the shapes of a stroke of a pen in the active object.

use super::CommandError;
use super::args::Args;
use super::files::drawn_since;
use super::session::{CommandReply, SketchSession};
use super::subject::ReplySubject;
use crate::format::page_curve::PageCurve;
use crate::format::page_shapes::{PageShapes, add_curve, draw, point_at, radius_name};
use crate::solid::curve::CurveKind;
use crate::{
    DimensionExpr, Drawing, PenSample, PointId, StrokeFit, StrokeKind, StrokePiece, fit_stroke,
};
use moldloft_syntax::number::plain;
use std::f64::consts::{FRAC_PI_2, PI};

type Place = [f64; 2];

/// Positions are rounded to this part of the power of ten below the size of a stroke: three digits, as suggested
/// dimensions have.
const DIGITS: f64 = 1e-2;

/// Largest turn at a corner that is rounded, in radians.
const MOST_TURN: f64 = 2.6;

/// Axes of an ellipse within this angle of those of the page, in radians, are parallel to them.
const LEVEL: f64 = 0.1;

/// Corners and handles of splines are rounded to this part of the step of positions, so that they stay smooth.
const FINER: f64 = 1e-2;

/// The parts of a stroke that a sketch has.
#[derive(Default)]
struct DrawnStroke {
    lines: Vec<[Place; 2]>,
    /// Ends of the lines of a corner, the corner between them, and the radius; the largest that fits if there is none.
    arcs: Vec<([Place; 3], Option<f64>)>,
    /// Three corners of the parallelogram around a circle or ellipse.
    rounds: Vec<([Place; 3], CurveKind)>,
    /// Parts of splines and ellipses: their corners and numbers.
    curves: Vec<([Place; 3], Vec<f64>)>,
    remarks: Vec<String>,
}

impl SketchSession {
    /// `STROKES SAMPLES u v u v …`.
    pub(super) fn pen_stroke(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let mut samples = Vec::new();
        while args.at_number() {
            let at =
                [args.number("the coordinate u of a sample")?, args.number("its coordinate v")?];
            samples.push(PenSample { at, ..PenSample::default() });
        }
        args.end()?;
        let size = samples.iter().fold(0.0, |s: f64, p| s.max(p.at[0].abs()).max(p.at[1].abs()));
        self.check_page(size, 0)?;
        let fit = fit_stroke(&samples).map_err(|fault| {
            CommandError::new(300, fault.to_string(), "draw a line or curve in one stroke")
                .about(ReplySubject::of("no-stroke"))
        })?;
        let before = self.active()?.clone();
        let drawn = DrawnStroke::of(&fit, &before.drawing)?;
        self.check_page(size, drawn.lines.len())?;
        let object = self.active_mut()?;
        let near = 1e-9 * size;
        let (points, lines) = draw(object.draw(), &drawn.lines, near);
        let find = |drawing: &Drawing, all: [Place; 3]| -> Option<Vec<PointId>> {
            all.iter().map(|p| point_at(drawing, *p, near)).collect()
        };
        let mut names = Vec::new();
        for (corner, radius) in &drawn.arcs {
            let Some(ids) = find(&object.drawing, *corner) else { continue };
            let most = largest(*corner);
            let radius = radius.map_or(most, |r| r.min(most));
            let radius = radius_name(object, radius);
            names.push(add_curve(object, CurveKind::Arc, ids, Some(radius), vec![]));
        }
        for (corner, kind) in &drawn.rounds {
            let Some(ids) = find(&object.drawing, *corner) else { continue };
            names.push(add_curve(object, *kind, ids, None, vec![]));
        }
        for (corner, shape) in drawn.curves {
            let Some(ids) = find(&object.drawing, corner) else { continue };
            let shape = shape.into_iter().map(DimensionExpr::number).collect();
            names.push(add_curve(object, CurveKind::Bezier, ids, None, shape));
        }
        let kinds: Vec<&str> = fit.pieces.iter().map(|p| p.kind.word()).collect();
        let mut text = format!("{}: {points} points and {lines} lines", kinds.join(", "));
        if !names.is_empty() {
            text.push_str(&format!(", curves {}", names.join(", ")));
        }
        let noise = plain(super::digits::rounded(fit.noise));
        self.out.push(CommandReply::note(format!("{text}; the pen is off by {noise}")));
        for remark in drawn.remarks {
            let about = ReplySubject::of("stroke-as-lines");
            self.out.push(CommandReply { about, ..CommandReply::warning(remark) });
        }
        self.recorded = Some(drawn_since(&before, self.active()?));
        Ok(())
    }
}

impl DrawnStroke {
    /// The parts of a stroke for a drawing, which has ends of its own.
    fn of(fit: &StrokeFit, drawing: &Drawing) -> Result<DrawnStroke, CommandError> {
        let mut out = DrawnStroke::default();
        let grid = RoundedPlaces::of(fit, drawing);
        let pieces = &fit.pieces;
        let n = pieces.len();
        if let [one] = &pieces[..]
            && let Some(centre) = one.centre.filter(|_| one.points.is_empty())
        {
            refuse_in_picture(drawing, one.kind)?;
            out.round(one, centre, &grid);
            return Ok(out);
        }
        // The joints; neighbours have the same one.
        let ends = |p: &StrokePiece| [p.points[0], p.points[p.points.len() - 1]];
        let mut joints: Vec<[Place; 2]> =
            pieces.iter().map(|p| ends(p).map(|at| grid.place(at))).collect();
        for k in 0..n {
            // A short piece does not collapse by the ends of the drawing.
            if joints[k][0] == joints[k][1] && pieces[k].kind == StrokeKind::Line {
                joints[k] = ends(&pieces[k]).map(|at| grid.rounded(at));
                let (before, after) = ((k + n - 1) % n, (k + 1) % n);
                if k > 0 || fit.closed {
                    joints[before][1] = joints[k][0];
                }
                if k + 1 < n || fit.closed {
                    joints[after][0] = joints[k][1];
                }
            }
        }
        let mut corners: Vec<Option<Place>> = vec![None; n];
        for k in 0..n {
            let inner = fit.closed && n > 2 || (k > 0 && k + 1 < n);
            let (before, after) = ((k + n - 1) % n, (k + 1) % n);
            let smooth = pieces[k].smooth && pieces[before].smooth;
            let straight = [before, after].iter().all(|&m| pieces[m].kind == StrokeKind::Line);
            if pieces[k].kind == StrokeKind::Arc && inner && smooth && straight && before != after {
                let lines = [ends(&pieces[before]), ends(&pieces[after])];
                corners[k] = corner_of(lines).map(|at| grid.rounded(at));
                if let Some(at) = corners[k] {
                    joints[before][1] = at;
                    joints[after][0] = at;
                }
            }
        }
        for (k, piece) in pieces.iter().enumerate() {
            let [start, end] = joints[k];
            match (piece.kind, corners[k]) {
                (StrokeKind::Line, _) => out.line(start, end),
                (StrokeKind::Arc, Some(corner)) => {
                    let (before, after) = ((k + n - 1) % n, (k + 1) % n);
                    let radius = piece.radius.map(|r| grid.rounded_length(r));
                    if drawing.section.is_some() {
                        let all = [joints[before][0], corner, joints[after][1]];
                        out.arcs.push((all, radius));
                    } else {
                        let [u, v] = corner.map(plain);
                        out.remarks.push(format!(
                            "the rounded corner at {u} {v} is drawn sharp: ARC CORNER rounds it, with a radius"
                        ));
                    }
                }
                (StrokeKind::Arc, None) => {
                    refuse_in_picture(drawing, piece.kind)?;
                    out.arc(piece, [start, end], &grid);
                }
                _ => {
                    refuse_in_picture(drawing, piece.kind)?;
                    out.curve(piece, [start, end], &grid);
                }
            }
        }
        Ok(out)
    }

    fn line(&mut self, p: Place, q: Place) {
        if p != q {
            self.lines.push([p, q]);
        }
    }

    /// Parts of at most a quarter circle, each in a corner of two lines.
    fn arc(&mut self, piece: &StrokePiece, [start, end]: [Place; 2], grid: &RoundedPlaces) {
        let (Some(centre), Some(radius)) = (piece.centre, piece.radius) else { return };
        let angle = |p: Place| libm::atan2(p[1] - centre[1], p[0] - centre[0]);
        let [a, m, b] = [piece.points[0], piece.points[1], piece.points[2]].map(angle);
        let ahead = |from: f64, to: f64| (to - from).rem_euclid(2.0 * PI);
        let sense = if ahead(a, m) <= ahead(a, b) { 1.0 } else { -1.0 };
        let sweep = if sense > 0.0 { ahead(a, b) } else { ahead(b, a) };
        let sweep = if sweep == 0.0 { 2.0 * PI } else { sweep };
        let parts = (sweep / FRAC_PI_2 - 1e-9).ceil().max(1.0);
        let step = sense * sweep / parts;
        let on = |r: f64, t: f64| {
            grid.rounded([centre[0] + r * libm::cos(t), centre[1] + r * libm::sin(t)])
        };
        let mut from = start;
        for k in 0..parts as usize {
            let t = a + step * k as f64;
            let to = if k + 1 == parts as usize { end } else { on(radius, t + step) };
            let corner = on(radius / libm::cos(0.5 * step), t + 0.5 * step);
            self.line(from, corner);
            self.line(corner, to);
            self.arcs.push(([from, corner, to], None));
            from = to;
        }
    }

    /// A whole circle or ellipse in the parallelogram around it.
    fn round(&mut self, piece: &StrokePiece, centre: Place, grid: &RoundedPlaces) {
        let (kind, [a, b], centre) = match (piece.radius, piece.half_axes) {
            (Some(r), _) => {
                let r = grid.rounded_length(r);
                (CurveKind::Circle, [[r, 0.0], [0.0, r]], grid.rounded(centre))
            }
            (None, Some([a, b])) => {
                let [m, n] = [a, b].map(|h| libm::hypot(h[0], h[1]));
                let level = |h: Place| h[0].abs().min(h[1].abs()) <= LEVEL * m;
                let [x, y] = [m, n].map(|h| grid.rounded_length(h));
                match (level(a), a[0].abs() > a[1].abs()) {
                    (true, true) => {
                        (CurveKind::Ellipse, [[x, 0.0], [0.0, y]], grid.rounded(centre))
                    }
                    (true, false) => {
                        (CurveKind::Ellipse, [[y, 0.0], [0.0, x]], grid.rounded(centre))
                    }
                    _ => {
                        (CurveKind::Ellipse, [a, b].map(|h| grid.rounded(h)), grid.rounded(centre))
                    }
                }
            }
            _ => return,
        };
        let at = |s: f64, t: f64| [0, 1].map(|k| centre[k] + s * a[k] + t * b[k]);
        let ring = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
        (0..4).for_each(|k| self.line(ring[k], ring[(k + 1) % 4]));
        self.rounds.push(([ring[1], ring[0], ring[3]], kind));
    }

    /// The parts of a spline or of an arc of an ellipse, each in a corner of two lines.
    fn curve(&mut self, piece: &StrokePiece, [start, end]: [Place; 2], grid: &RoundedPlaces) {
        let mut curves = curves_of(piece);
        if let Some(first) = curves.first_mut() {
            first.set_end(0, start);
        }
        if let Some(last) = curves.last_mut() {
            last.set_end(1, end);
        }
        let mut parts = Vec::new();
        curves.iter().for_each(|curve| curve.in_corners(&mut parts));
        let mut from = start;
        let count = parts.len();
        for (k, part) in parts.into_iter().enumerate() {
            let to = if k + 1 == count { end } else { grid.finer(part.ends()[1]) };
            match part.corner() {
                Some([_, corner, _]) => {
                    let corner = grid.finer(corner);
                    self.line(from, corner);
                    self.line(corner, to);
                    // A weight stays below 1.
                    let four = |x: f64| tidy((x * 1e4).round() * 1e-4);
                    let digits = |x: f64| if four(x) < 1.0 { four(x) } else { x };
                    let shape = part.shape().into_iter().map(digits).collect();
                    self.curves.push(([from, corner, to], shape));
                }
                None => self.line(from, to),
            }
            from = to;
        }
    }
}

/// A picture of a solid has straight lines: its curves are drawn into corners of known size.
fn refuse_in_picture(drawing: &Drawing, kind: StrokeKind) -> Result<(), CommandError> {
    if drawing.section.is_some() {
        return Ok(());
    }
    let text = format!(
        "the stroke has {} {}, which a picture of a solid cannot hold",
        article(kind),
        kind.word()
    );
    let next =
        "draw its corners, then ARC, CIRCLE or ELLIPSE; or draw it in a section: SKETCH name 2D";
    Err(CommandError::text(text, next).about(ReplySubject::of("curve-in-picture")))
}

fn article(kind: StrokeKind) -> &'static str {
    match kind {
        StrokeKind::Arc | StrokeKind::EllipseArc | StrokeKind::Ellipse => "an",
        _ => "a",
    }
}

/// Positions of a drawing: those of its points, and rounded ones.
struct RoundedPlaces<'a> {
    drawing: &'a Drawing,
    reach: f64,
    step: f64,
}

impl RoundedPlaces<'_> {
    fn of<'a>(fit: &StrokeFit, drawing: &'a Drawing) -> RoundedPlaces<'a> {
        let all = fit.pieces.iter().flat_map(|p| {
            let r = p.radius.or(p.half_axes.map(|h| libm::hypot(h[0][0], h[0][1]))).unwrap_or(0.0);
            let round = p.centre.filter(|_| p.points.is_empty());
            let round = round.map(|c| [[c[0] - r, c[1] - r], [c[0] + r, c[1] + r]]);
            p.points.iter().copied().chain(round.into_iter().flatten())
        });
        let (low, high) = all.fold(([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]), |(l, h), p| {
            ([0, 1].map(|k| l[k].min(p[k])), [0, 1].map(|k| h[k].max(p[k])))
        });
        let size = libm::hypot(high[0] - low[0], high[1] - low[1]);
        let step = DIGITS * libm::exp10(libm::log10(size).floor());
        RoundedPlaces {
            drawing,
            reach: fit.tolerance,
            step: if step.is_finite() { step } else { 0.0 },
        }
    }

    /// The nearest point of the drawing within reach, or the rounded position.
    fn place(&self, at: Place) -> Place {
        let off = |p: Place| libm::hypot(p[0] - at[0], p[1] - at[1]);
        let points = self.drawing.points.values().map(|p| [p.u, p.v]);
        let near = points.filter(|p| off(*p) <= self.reach);
        near.min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or_else(|| self.rounded(at))
    }

    fn rounded(&self, at: Place) -> Place {
        at.map(|x| self.rounded_length(x))
    }

    fn finer(&self, at: Place) -> Place {
        let step = FINER * self.step;
        at.map(|x| if step == 0.0 { x } else { tidy((x / step).round() * step) })
    }

    fn rounded_length(&self, x: f64) -> f64 {
        if self.step == 0.0 { x } else { tidy((x / self.step).round() * self.step) }
    }
}

/// Without the last digits of a product.
fn tidy(x: f64) -> f64 {
    format!("{x:.12e}").parse().unwrap_or(x)
}

/// The corner of two lines that an arc joins, between the end of the first and the start of the second.
fn corner_of([[a, b], [c, d]]: [[Place; 2]; 2]) -> Option<Place> {
    let way = |p: Place, q: Place| [q[0] - p[0], q[1] - p[1]];
    let (u, v) = (way(a, b), way(c, d));
    let cross = |p: Place, q: Place| p[0] * q[1] - p[1] * q[0];
    let turn = libm::atan2(cross(u, v), u[0] * v[0] + u[1] * v[1]).abs();
    let det = cross(u, v);
    let s = cross(way(a, c), v) / det;
    let t = cross(way(a, c), u) / det;
    let at = [a[0] + s * u[0], a[1] + s * u[1]];
    // The lines are lengthened to the corner.
    (turn < MOST_TURN && s > 0.9 && t < 0.1 && s.is_finite() && t.is_finite()).then_some(at)
}

/// The largest radius in a corner.
fn largest([a, m, b]: [Place; 3]) -> f64 {
    let (u, v) = ([a[0] - m[0], a[1] - m[1]], [b[0] - m[0], b[1] - m[1]]);
    let angle = libm::atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]).abs();
    let reach = libm::hypot(u[0], u[1]).min(libm::hypot(v[0], v[1]));
    reach * libm::tan(0.5 * angle)
}

/// The curves of a spline or of an arc of an ellipse.
fn curves_of(piece: &StrokePiece) -> Vec<PageCurve> {
    let p = &piece.points;
    let (Some(c), Some([a, b])) = (piece.centre, piece.half_axes) else {
        let cubic = |q: &[Place]| PageCurve::Cubic([q[0], q[1], q[2], q[3]]);
        return p.windows(4).step_by(3).map(cubic).collect();
    };
    let [m, n] = [a, b].map(|h| h[0] * h[0] + h[1] * h[1]);
    let angle = |p: Place| {
        let d = [p[0] - c[0], p[1] - c[1]];
        libm::atan2((d[0] * b[0] + d[1] * b[1]) / n, (d[0] * a[0] + d[1] * a[1]) / m)
    };
    let [from, middle, to] = [p[0], p[1], p[2]].map(angle);
    let ahead = |from: f64, to: f64| (to - from).rem_euclid(2.0 * PI);
    let sweep = match ahead(from, middle) <= ahead(from, to) {
        true => ahead(from, to),
        false => -ahead(to, from),
    };
    let mut shapes = PageShapes::default();
    shapes.elliptical(c, [a, b], from, sweep);
    shapes.curves
}
