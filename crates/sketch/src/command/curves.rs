//! Commands that draw curves.

use super::CommandError;
use super::args::Args;
use super::draw::{require_line, require_point};
use super::session::{CommandReply, SketchSession};
use super::subject::ReplySubject;
use crate::solid::curve::{CurveFault, CurveKind, SketchCurve, trace};
use crate::solid::{UnbuiltCurve, UnbuiltReason};
use crate::{PointId, SketchObject};
use moldloft_syntax::number::plain;

impl SketchSession {
    pub(super) fn corner_curve(&mut self, args: &mut Args, verb: &str) -> Result<(), CommandError> {
        let start = |a: &Args| a.at("LINES") || a.at("CORNER");
        let option = |a: &Args| verb == "ELLIPSE" && (a.tokens_at(0, "ARC") || a.at("FULL"));
        let name = if start(args) || option(args) { None } else { Some(self.new_name(args)?) };
        let object = self.active()?.clone();
        let mut kind = match verb {
            "ARC" => CurveKind::Arc,
            "CIRCLE" => CurveKind::Circle,
            "BEZIER" => CurveKind::Bezier,
            _ => CurveKind::Ellipse,
        };
        let mut full = false;
        if verb == "ELLIPSE" {
            if args.take_short("ARC") {
                kind = CurveKind::EllipticalArc;
            }
            full = args.take("FULL");
        }
        let points = if args.take("LINES") {
            let (a, b) = (args.line()?, args.line()?);
            let (a, b) = (require_line(&object, a)?, require_line(&object, b)?);
            let common = [a.p, a.q].into_iter().find(|p| [b.p, b.q].contains(p));
            let Some(m) =
                common.filter(|_| (a.p.min(a.q), a.p.max(a.q)) != (b.p.min(b.q), b.p.max(b.q)))
            else {
                return Err(CommandError::new(
                    300,
                    "the two lines have no common end",
                    "name two lines that meet",
                )
                .about(ReplySubject::of("lines-apart").points([a.p, a.q, b.p, b.q])));
            };
            vec![if a.p == m { a.q } else { a.p }, m, if b.p == m { b.q } else { b.p }]
        } else if args.take("CORNER") {
            let m = args.point()?;
            require_point(&object, m)?;
            if args.at_number() {
                let (a, b) = (args.point()?, args.point()?);
                vec![a, m, b]
            } else {
                let ends: Vec<PointId> = (object.drawing.lines.values())
                    .filter_map(|l| {
                        if l.p == m {
                            Some(l.q)
                        } else if l.q == m {
                            Some(l.p)
                        } else {
                            None
                        }
                    })
                    .collect();
                let [a, b] = ends[..] else {
                    let text = format!("{} lines meet at point {m}", ends.len());
                    return Err(CommandError::text(
                        text,
                        format!("give the end points: CORNER {m} a b"),
                    )
                    .about(
                        ReplySubject::of("corner-of-many-lines")
                            .points([m])
                            .points(ends.iter().copied()),
                    ));
                };
                vec![a, m, b]
            }
        } else {
            return Err(args.wants("LINES or CORNER"));
        };
        for (k, &p) in points.iter().enumerate() {
            require_point(&object, p)?;
            if points[..k].contains(&p) {
                return Err(CommandError::new(
                    300,
                    format!("point {p} twice in a corner"),
                    "name three points",
                )
                .about(ReplySubject::of("point-twice").points([p])));
            }
        }
        let unit = object.units.as_deref();
        let (mut radius, mut semi, mut shape) = (None, None, Vec::new());
        if kind == CurveKind::Bezier {
            if args.take("WEIGHT") {
                shape = vec![args.value(None)?];
            } else if args.take("HANDLES") {
                shape = vec![args.value(None)?, args.value(None)?];
            }
        } else if kind == CurveKind::Arc || kind == CurveKind::Circle {
            if args.take("RADIUS") {
                radius = Some(args.value(unit)?);
            }
        } else if args.take("SEMI") {
            semi = Some([args.value(unit)?, args.value(unit)?]);
        }
        let mut curve = SketchCurve {
            name: name.unwrap_or_else(|| object.fresh_name("C")),
            kind,
            points,
            radius,
            semi,
            shape,
            steps: None,
            replaces: true,
            centripetal: false,
        };
        self.options(args, &mut curve)?;
        if full {
            // FULL takes the lengths of the lines themselves: a curve around, not inside.
            let (view, layout) = self.laid_out(&object);
            let at = |p: PointId| layout.point(&view.planes, p);
            let (a, m, b) = (at(curve.points[0]), at(curve.points[1]), at(curve.points[2]));
            if let (Some(a), Some(m), Some(b)) = (a, m, b) {
                let length = |x: f64| crate::DimensionExpr::number(x);
                curve.semi = Some([length(a.distance(m)), length(b.distance(m))]);
            }
            curve.replaces = false;
        }
        self.add_curve(curve)
    }

    pub(super) fn chain_curve(
        &mut self,
        args: &mut Args,
        least: usize,
    ) -> Result<(), CommandError> {
        let start = |a: &Args| a.at("LINES") || a.at("POINTS");
        let name = if start(args) { None } else { Some(self.new_name(args)?) };
        let object = self.active()?.clone();
        let mut points: Vec<PointId> = Vec::new();
        let mut replaces = false;
        if args.take("LINES") {
            replaces = true;
            let mut lines = Vec::new();
            while args.at_number() {
                let id = args.line()?;
                lines.push(require_line(&object, id)?);
            }
            let wanted = least - 1;
            if lines.len() < wanted || (least == 3 && lines.len() != 2) {
                return Err(args.wants(&format!("{wanted} lines in a row")));
            }
            let (a, b) = (lines[0], lines[1]);
            let first = if [b.p, b.q].contains(&a.q) { a.p } else { a.q };
            points.push(first);
            for line in lines {
                let at = points.last().copied().unwrap_or(first);
                let next = if at == line.p { line.q } else { line.p };
                let back = points.len() > 1 && points[points.len() - 2] == next;
                if back || (at != line.p && at != line.q) {
                    return Err(CommandError::new(
                        300,
                        format!("line {}-{} does not continue from point {at}", line.p, line.q),
                        "name lines in a row",
                    )
                    .about(ReplySubject::of("lines-apart").points([at, line.p, line.q])));
                }
                points.push(next);
            }
        } else if args.take("POINTS") {
            while args.at_number() {
                let p = args.point()?;
                require_point(&object, p)?;
                points.push(p);
            }
        } else {
            return Err(args.wants("LINES or POINTS"));
        }
        let kind = if least == 3 { CurveKind::Quadratic } else { CurveKind::Cubic };
        if points.len() < least || (least == 3 && points.len() != 3) {
            return Err(args.wants(&format!("{least} points")));
        }
        let name = name.unwrap_or_else(|| object.fresh_name("C"));
        let mut curve = SketchCurve {
            name,
            kind,
            points,
            radius: None,
            semi: None,
            shape: Vec::new(),
            steps: None,
            replaces,
            centripetal: false,
        };
        self.options(args, &mut curve)?;
        self.add_curve(curve)
    }

    fn options(&mut self, args: &mut Args, curve: &mut SketchCurve) -> Result<(), CommandError> {
        loop {
            if args.take("STEPS") {
                let n = args.count("a number of chords")?;
                if n > 720 {
                    return Err(CommandError::text("a curve has at most 720 chords", "give fewer"));
                }
                curve.steps = Some(n);
            } else if args.take("KEEP") {
                curve.replaces = false;
            } else if args.take("REPLACE") {
                curve.replaces = true;
            } else if args.take("CENTRIPETAL") {
                curve.centripetal = true;
            } else {
                return args.end();
            }
        }
    }

    fn add_curve(&mut self, curve: SketchCurve) -> Result<(), CommandError> {
        let mut object: SketchObject = self.active()?.clone();
        let name = curve.name.clone();
        object.curves.insert(name.to_ascii_lowercase(), curve.clone());
        let (view, layout) = self.laid_out(&object);
        let at = |p: PointId| layout.point(&view.planes, p);
        match trace(&curve, &at, &layout.values) {
            Ok(traced) => {
                let length: f64 = traced.pieces.iter().map(|p| p.length()).sum();
                let mut text =
                    format!("{} {}: length {}", curve.kind.word(), curve.name, plain(length));
                if let Some(c) = traced.centre {
                    text.push_str(&format!(", centre {}", c.to_array().map(plain).join(" ")));
                }
                self.out.push(CommandReply::note(text));
            }
            // Without dimensions it is drawn later.
            Err(CurveFault::Undetermined) => {}
            Err(fault) => return Err(curve_fault(&curve.name, &fault)),
        }
        if let Some(solid) = self.solid_of(&object)
            && let Some(unbuilt) = solid.unbuilt.iter().find(|t| t.curve == name)
        {
            self.out.push(unbuilt_reply(unbuilt));
        }
        *self.active_mut()? = object;
        Ok(())
    }
}

fn curve_fault(name: &str, fault: &CurveFault) -> CommandError {
    match fault {
        CurveFault::NoValue { reads } => CommandError::text(
            format!("{name} reads {reads}, which has no value"),
            format!("VARIABLE {reads} defines it"),
        )
        .about(ReplySubject::of("no-value").names([&name.to_owned(), reads])),
        CurveFault::NotPositive { value } => CommandError::new(
            310,
            format!("{name} has the size {}", plain(*value)),
            "give a positive size",
        )
        .about(ReplySubject::of("size-not-positive").names([&name.to_owned()]).value(*value)),
        CurveFault::Degenerate => CommandError::new(
            300,
            format!("the lines of {name} are parallel, or two of its points coincide"),
            "choose lines that meet at an angle",
        )
        .about(ReplySubject::of("degenerate-curve").names([&name.to_owned()])),
        CurveFault::TooLarge { largest } => CommandError::new(
            310,
            format!("{name} is too large: its tangent point is beyond the end of a line"),
            format!("at most {} fits", plain(super::digits::rounded(*largest))),
        )
        .about(ReplySubject::of("curve-too-large").names([&name.to_owned()]).value(*largest)),
        CurveFault::NoEllipse { value } => CommandError::new(
            310,
            format!("{name} has the weight {}, of no ellipse", plain(*value)),
            "give a weight below 1; without one it is a parabola",
        )
        .about(ReplySubject::of("size-too-large").names([&name.to_owned()]).value(*value)),
        CurveFault::Undetermined => CommandError::new(
            404,
            format!("the points of {name} are not determined yet"),
            "CONVERT says what is missing",
        )
        .about(ReplySubject::of("undetermined-points").names([&name.to_owned()])),
    }
}

/// A curve that is not built in, as a warning.
pub(super) fn unbuilt_reply(unbuilt: &UnbuiltCurve) -> CommandReply {
    let name = &unbuilt.curve;
    let fault = match &unbuilt.why {
        UnbuiltReason::Curve(fault) => curve_fault(name, fault),
        UnbuiltReason::Crowded(p) => CommandError::new(
            0,
            format!("{name} stays a curve: too many lines of faces meet at point {p}"),
            "KEEP says so",
        ).about(ReplySubject::of("curve-not-built").names([name]).points([*p])),
        UnbuiltReason::Taken(p) => CommandError::new(
            0,
            format!("{name} stays a curve: another one has taken the corner at point {p}"),
            "remove one of them",
        ).about(ReplySubject::of("curve-not-built").names([name]).points([*p])),
        UnbuiltReason::Face(f) => CommandError::new(
            0,
            format!("face {f} is not plane with {name} and has not four edges"),
            "bend the opposite edge, or divide the face",
        ).about(ReplySubject::of("curve-not-built").names([name]).faces([*f])),
        UnbuiltReason::NoEdge => CommandError::new(
            0,
            format!(
                "{name} stays a curve: its lines are no edges of faces, or it is not inscribed in them"
            ),
            "KEEP says so",
        ).about(ReplySubject::of("curve-not-built").names([name])),
        UnbuiltReason::Overlap(p, q) => CommandError::new(
            310,
            format!("{name} and its neighbour do not fit on the line from {p} to {q} together"),
            "make one of them smaller",
        ).about(ReplySubject::of("curve-not-built").names([name]).points([*p, *q])),
    };
    let mut reply = CommandReply::warning(fault.text);
    reply.code = (fault.code > 0).then_some(fault.code);
    reply.next = Some(fault.next);
    reply.about = *fault.about;
    reply
}
