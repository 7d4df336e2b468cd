//! Commands that draw: objects, points, lines, types, alignments.

use super::CommandError;
use super::args::Args;
use super::session::{CommandReply, MAX_POINTS, SketchSession};
use super::subject::ReplySubject;
use super::words::{Command, CommandTokenKind};
use crate::{
    Align, CoordinateAxis, Drawing, DrawnLine, DrawnPoint, FaceId, Free, LineId, LineTypeSource,
    Naming, PointId, Projection, SketchObject, TypeProposal,
};

/// Points that are farther apart than this part of the drawing are welded with a warning.
const FAR_WELD: f64 = 0.05;

impl SketchSession {
    /// True if points and lines change nothing but the drawing, and no step is kept of them.
    pub(super) fn only_draws(&self, verb: &str) -> bool {
        let plain = || self.state.objects.values().all(|o| o.feature.is_none());
        matches!(verb, "POINT" | "LINE" | "POLYLINE")
            && !self.keeps_steps
            && self.transaction.is_none()
            && self.worked.is_empty()
            && self.state.outside.is_empty()
            && plain()
    }

    /// Runs a command that only draws: refused, it has changed nothing, so that no state before it is needed.
    pub(super) fn draw_only(&mut self, verb: &'static str, command: &Command) -> Vec<CommandReply> {
        let outer = std::mem::take(&mut self.out);
        let result = self.dispatch(verb, command);
        let mut replies = std::mem::replace(&mut self.out, outer);
        match result {
            Ok(()) => {
                self.history.push(command.text.clone());
                self.journal.push(command.text.clone());
            }
            Err(fault) => replies.push(fault.into()),
        }
        replies
    }

    pub(super) fn sketch(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let shape = |t: &str| ["2D", "3D"].iter().any(|d| t.eq_ignore_ascii_case(d));
        let named = args.peek().is_some_and(|t| {
            matches!(t.kind, CommandTokenKind::Word | CommandTokenKind::Text) && !shape(&t.text)
        });
        let name = if named { args.name("a name")? } else { "NONAME".to_owned() };
        if name.is_empty() || name.chars().count() > 32 {
            let text =
                format!("an object's name has 1 to 32 characters, not {}", name.chars().count());
            return Err(CommandError::text(text, "choose a shorter name"));
        }
        let section = if args.take_short("2D") {
            let plane = args.peek().map(|t| t.text.to_ascii_uppercase());
            let normal = match plane.as_deref() {
                Some("XY") => Some(CoordinateAxis::Z),
                Some("XZ") => Some(CoordinateAxis::Y),
                Some("YZ") => Some(CoordinateAxis::X),
                _ => None,
            };
            if normal.is_some() {
                args.skip();
            }
            Some(normal.unwrap_or(CoordinateAxis::Y))
        } else {
            args.take_short("3D");
            None
        };
        let (on, section) = match args.take_short("ON") {
            true => {
                let (on, axis) = self.section_on(args, section)?;
                (Some(on), Some(axis))
            }
            false => (None, section),
        };
        args.end()?;
        let key = name.to_lowercase();
        match self.state.objects.get(&key) {
            Some(old) if section.is_none() || old.drawing.section == section => {
                self.state.active = Some(key);
            }
            Some(old) if !old.drawing.points.is_empty() => {
                return Err(CommandError::new(
                    113,
                    format!(
                        "{} cannot change between a section and space: it has points",
                        old.name
                    ),
                    "sketch another object, or EXTRUDE this one",
                )
                .about(ReplySubject::of("section-or-space").names([&old.name])));
            }
            _ => self.insert(SketchObject::new(&name, section)),
        }
        if on.is_some() {
            self.active_mut()?.on = on;
        }
        Ok(())
    }

    pub(super) fn point(&mut self, args: &mut Args) -> Result<(), CommandError> {
        // POINT 7 1 2 has a label, POINT 1 2 does not.
        let at_word = args.second().is_some_and(|t| t.text.eq_ignore_ascii_case("AT"));
        let labelled = at_word || args.len() >= 3;
        let id = if labelled { Some(args.point()?) } else { None };
        args.take_short("AT");
        let (u, v) =
            (args.number("the screen coordinate u")?, args.number("the screen coordinate v")?);
        args.end()?;
        if u.abs().max(v.abs()) > 1e9 {
            return Err(CommandError::text(
                "the page ends at 1e9",
                "draw smaller; dimensions give the size",
            ));
        }
        let object = self.active_or_noname()?;
        if object.drawing.points.len() >= MAX_POINTS {
            return Err(CommandError::new(
                200,
                format!("an object has at most {MAX_POINTS} points"),
                "begin another object",
            ));
        }
        let id = id.unwrap_or_else(|| object.drawing.next_point());
        let new = object.draw().points.insert(id, DrawnPoint { u, v }).is_none();
        let moved: Vec<LineId> = (object.drawing.lines.iter())
            .filter(|(_, l)| (l.p == id || l.q == id) && l.source == LineTypeSource::Auto)
            .map(|(k, _)| *k)
            .collect();
        if !new {
            let drawing = object.draw();
            moved.into_iter().for_each(|l| drawing.type_by_slope(l));
        }
        if !labelled {
            self.out.push(CommandReply::note(format!("point {id}")));
        }
        Ok(())
    }

    /// The active object; without one an unnamed object is begun (manual: NONAME).
    fn active_or_noname(&mut self) -> Result<&mut SketchObject, CommandError> {
        if self.state.active.is_none() {
            self.insert(SketchObject::new("NONAME", None));
        }
        self.active_mut()
    }

    pub(super) fn line(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let from = |a: &Args| a.second().is_some_and(|t| t.text.eq_ignore_ascii_case("FROM"));
        let three = args.len() >= 3
            && args.second().is_some_and(|t| matches!(t.kind, CommandTokenKind::Number(..)));
        let labelled = from(args) || three && !args.tokens_at(2, "TYPE") && args.number_at(2);
        let id = if labelled { Some(args.line()?) } else { None };
        args.take("FROM");
        let p = args.point()?;
        args.take_short("TO");
        let q = args.point()?;
        let object = self.active()?;
        for end in [p, q] {
            require_point(object, end)?;
        }
        if p == q {
            return Err(CommandError::new(
                300,
                format!("a line from point {p} to itself has no length"),
                "give two points",
            )
            .about(ReplySubject::of("no-length").points([p])));
        }
        if let Some(other) = object.drawing.line_between(p, q).filter(|l| Some(*l) != id) {
            return Err(CommandError::text(
                format!("line {other} joins points {p} and {q} already"),
                format!("use line {other}"),
            )
            .about(ReplySubject::of("line-twice").lines([other]).points([p, q])));
        }
        let drawing = &object.drawing;
        let mut line =
            DrawnLine { p, q, free: None, source: LineTypeSource::Auto, confidence: 0.0 };
        let mut by_slope = true;
        if args.take("TYPE") {
            by_slope = false;
            line.free = line_type(drawing, args)?;
            (line.source, line.confidence) = (LineTypeSource::User, 1.0);
            for (word, source) in
                [("AUTO", LineTypeSource::Auto), ("INFERRED", LineTypeSource::Inferred)]
            {
                if args.take(word) {
                    line.source = source;
                    if args.at_number() {
                        line.confidence = args.number("the confidence")?.clamp(0.0, 1.0);
                    }
                }
            }
        }
        args.end()?;
        let object = self.active_mut()?;
        let id = id.unwrap_or_else(|| object.drawing.next_line());
        let drawing = object.draw();
        drawing.lines.insert(id, line);
        if by_slope {
            drawing.type_by_slope(id);
        }
        let text = drawing.line_text(id);
        if !labelled {
            self.out.push(CommandReply::note(format!("line {id}: {text}")));
        }
        Ok(())
    }

    pub(super) fn polyline(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let mut points = Vec::new();
        while args.at_number() {
            points.push(args.point()?);
        }
        let close = args.take("CLOSE");
        args.end()?;
        if points.len() < 2 {
            return Err(args.wants("two points or more"));
        }
        if close && points.len() > 2 {
            points.push(points[0]);
        }
        let object = self.active_mut()?;
        for &p in &points {
            require_point(object, p)?;
        }
        let drawing = object.draw();
        let mut made = Vec::new();
        for w in points.windows(2) {
            if w[0] != w[1] && drawing.line_between(w[0], w[1]).is_none() {
                let id = drawing.next_line();
                let line = DrawnLine {
                    p: w[0],
                    q: w[1],
                    free: None,
                    source: LineTypeSource::Auto,
                    confidence: 0.0,
                };
                drawing.lines.insert(id, line);
                drawing.type_by_slope(id);
                made.push(format!("{id}: {}", drawing.line_text(id)));
            }
        }
        self.out.push(CommandReply::note(format!("lines {}", made.join(", "))));
        Ok(())
    }

    pub(super) fn split(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let id = args.line()?;
        let part = args.number("a part of the length between 0 and 1")?;
        args.end()?;
        if !(part > 0.0 && part < 1.0) {
            return Err(CommandError::new(
                300,
                format!("{part} is not inside the line"),
                "give a part between 0 and 1",
            )
            .about(ReplySubject::of("outside-of-line").lines([id]).value(part)));
        }
        let object = self.active_mut()?;
        let line = require_line(object, id)?;
        let (a, b) = (object.drawing.points[&line.p], object.drawing.points[&line.q]);
        let drawing = object.draw();
        let (m, second) = (drawing.next_point(), drawing.next_line());
        let mix = |x: f64, y: f64| x + (y - x) * part;
        drawing.points.insert(m, DrawnPoint { u: mix(a.u, b.u), v: mix(a.v, b.v) });
        drawing.lines.insert(id, DrawnLine { q: m, ..line });
        drawing.lines.insert(second, DrawnLine { p: m, ..line });
        for face in object.faces.values_mut() {
            for cycle in std::iter::once(&mut face.outer).chain(&mut face.holes) {
                let n = cycle.len();
                let between = |k: &usize| {
                    let pair = (cycle[*k], cycle[(*k + 1) % n]);
                    pair == (line.p, line.q) || pair == (line.q, line.p)
                };
                if let Some(k) = (0..n).find(between) {
                    cycle.insert(k + 1, m);
                }
            }
        }
        self.out.push(CommandReply::note(format!("point {m}, line {second}")));
        Ok(())
    }

    /// `WELD p q`, or `WELD TOL t` for all points within a distance on the page.
    pub(super) fn weld(&mut self, args: &mut Args) -> Result<(), CommandError> {
        if args.take_short("TOL") {
            let reach = args.number("a distance on the page")?;
            args.end()?;
            let object = self.active_mut()?;
            let mut welded = Vec::new();
            while let Some((kept, gone, _)) = object.drawing.gaps(Some(reach)).first().copied() {
                object.draw().weld(kept, gone);
                welded.push(format!("{gone} to {kept}"));
            }
            let gone = object.drop_dangling();
            let text = if welded.is_empty() {
                "no two points are that close".to_owned()
            } else {
                format!("welded {}", welded.join(", "))
            };
            self.out.push(CommandReply::note(text));
            self.report_gone(gone);
            return Ok(());
        }
        let (p, q) = (args.point()?, args.point()?);
        args.end()?;
        let object = self.active_mut()?;
        require_point(object, p)?;
        require_point(object, q)?;
        if p == q {
            return Err(CommandError::new(
                300,
                format!("point {p} is itself already"),
                "give two points",
            )
            .about(ReplySubject::of("no-length").points([p])));
        }
        let apart = object.drawing.distance(p, q);
        let far = apart > FAR_WELD * object.drawing.extent();
        object.draw().weld(p.min(q), p.max(q));
        let gone = object.drop_dangling();
        if far {
            let text = format!(
                "points {p} and {q} were {} apart on the page",
                moldloft_syntax::number::plain(super::digits::rounded(apart))
            );
            let about = ReplySubject::of("far-weld").points([p, q]).value(apart);
            let next = Some("UNDO, if they are two points".to_owned());
            self.out.push(CommandReply { next, about, ..CommandReply::warning(text) });
        }
        self.report_gone(gone);
        Ok(())
    }

    pub(super) fn report_gone(&mut self, gone: Vec<String>) {
        if !gone.is_empty() {
            let text = format!("removed with their points or lines: {}", gone.join(", "));
            self.out.push(CommandReply::warning(text));
        }
    }

    pub(super) fn delete(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let kinds = ["POINT", "LINE", "FACE", "CURVE", "DIMENSION", "VARIABLE"];
        // A keyword counts only with something after it, so an object may be called POINT.
        let kind = kinds.into_iter().find(|k| args.at(k) && args.len() > 1);
        let Some(kind) = kind else {
            let name =
                args.name("the name of an object, or POINT, LINE, FACE, CURVE or DIMENSION")?;
            args.end()?;
            self.known(&name)?;
            let key = name.to_lowercase();
            self.state.objects.shift_remove(&key);
            // Objects that follow it keep it as a part, with its numbers.
            let before = self.state.clone();
            self.follow(&before);
            for (reader, names) in self.readers(&name) {
                let text = format!("{reader} reads {}, which has no value now", names.join(", "));
                let about = ReplySubject::of("no-value").names(names.iter());
                self.out.push(CommandReply { about, ..CommandReply::warning(text) });
            }
            if self.state.active.as_ref() == Some(&key) {
                self.state.active = None;
            }
            return Ok(());
        };
        args.skip();
        while args.len() > 0 {
            let object = self.active_mut()?;
            match kind {
                "POINT" => {
                    let p = args.point()?;
                    require_point(object, p)?;
                    object.draw().remove_point(p);
                }
                "LINE" => {
                    let id = args.line()?;
                    let line = require_line(object, id)?;
                    object.draw().lines.remove(&id);
                    let ends = [line.p, line.q];
                    object.faces.retain(|_, f| {
                        !f.loops().any(|c| {
                            let n = c.len();
                            (0..n).any(|k| ends.contains(&c[k]) && ends.contains(&c[(k + 1) % n]))
                        })
                    });
                }
                "FACE" => {
                    let id = FaceId(args.count("the number of a face")?);
                    if object.faces.remove(&id).is_none() {
                        return Err(CommandError::text(
                            format!("there is no face {id}"),
                            "LIST FACES lists them",
                        )
                        .about(ReplySubject::of("unknown-face").faces([id])));
                    }
                }
                _ => {
                    let name = args.name("a name")?;
                    if kind == "CURVE" && object.curves.is_empty() {
                        return Err(CommandError::new(
                            105,
                            format!("object {} has no curves", object.name),
                            "ARC, CIRCLE, QUADRATIC, CUBIC, ELLIPSE and BEZIER draw them",
                        )
                        .about(ReplySubject::of("no-curves").names([&object.name])));
                    }
                    let key = name.to_ascii_lowercase();
                    let found = match kind {
                        "CURVE" => object.curves.shift_remove(&key).is_some(),
                        "VARIABLE" => object.variables.shift_remove(&key).is_some(),
                        _ => object.dimensions.shift_remove(&key).is_some(),
                    };
                    if !found {
                        let word = kind.to_ascii_lowercase();
                        return Err(CommandError::text(
                            format!("there is no {word} {name}"),
                            format!("LIST {kind}S lists them"),
                        )
                        .about(ReplySubject::of("unknown-name").names([&name])));
                    }
                }
            }
        }
        let gone = self.active_mut()?.drop_dangling();
        self.report_gone(gone);
        Ok(())
    }

    pub(super) fn axes(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let object = self.active_mut()?;
        let mut projection = object.drawing.projection;
        if args.at_number() {
            let (a, b) = (args.number("an angle")?, args.number("an angle")?);
            let third = if args.at_number() { Some(args.number("an angle")?) } else { None };
            projection.angle_deg = match (third, object.drawing.section) {
                (Some(c), _) => [a, b, c],
                (None, Some(CoordinateAxis::X)) => [projection.angle_deg[0], a, b],
                (None, Some(CoordinateAxis::Y)) => [a, projection.angle_deg[1], b],
                (None, Some(CoordinateAxis::Z)) => [a, b, projection.angle_deg[2]],
                (None, None) => return Err(args.wants("the angle of Z")),
            };
        } else if args.take("AUTO") {
            projection = object.drawing.axes_of_lines().ok_or_else(|| {
                CommandError::text(
                    "the lines do not show three directions",
                    "give the angles: AXES 345 40 90",
                )
            })?;
        } else if !args.at("SCALE") {
            let name = args.name("angles, AUTO or the name of a projection")?;
            projection = Projection::preset(&name).ok_or_else(|| {
                CommandError::text(
                    format!("there is no projection {name}"),
                    format!("there are {}", Projection::PRESETS.join(", ")),
                )
            })?;
        }
        if args.take("SCALE") {
            for k in 0..3 {
                projection.scale[k] = args.number("three scales")?;
            }
        }
        args.end()?;
        if projection.scale.iter().any(|s| !(*s > 0.0 && *s < 1e6))
            || projection.angle_deg.iter().any(|a| a.abs() > 1e6)
        {
            return Err(CommandError::new(
                405,
                "a scale is not positive, or an angle is out of bounds",
                "give positive scales and degrees",
            ));
        }
        let shown: Vec<CoordinateAxis> = CoordinateAxis::ALL
            .into_iter()
            .filter(|a| object.drawing.section != Some(*a))
            .collect();
        let apart = |a: &CoordinateAxis, b: &CoordinateAxis| {
            let (p, q) = (projection.unit(*a), projection.unit(*b));
            (p[0] * q[1] - p[1] * q[0]).abs() > 1e-9
        };
        if !shown.iter().any(|a| shown.iter().any(|b| apart(a, b))) {
            return Err(CommandError::new(
                405,
                "all axes run in one direction, so the picture shows no plane",
                "give different angles, such as AXES 345 40 90",
            ));
        }
        let drawing = object.draw();
        drawing.projection = projection;
        let auto: Vec<LineId> = (drawing.lines.iter())
            .filter(|(_, l)| l.source == LineTypeSource::Auto)
            .map(|(id, _)| *id)
            .collect();
        auto.into_iter().for_each(|id| drawing.type_by_slope(id));
        let up = drawing.letters.up;
        let n = projection.sight(up);
        let [a, b, c] = projection.angle_deg;
        self.out.push(CommandReply::note(format!("axes at {a:.2}, {b:.2}, {c:.2} degrees")));
        let small = 1e-9 * n.norm();
        if n.to_array().iter().any(|x| x.abs() <= small) && self.active()?.drawing.section.is_none()
        {
            self.out.push(CommandReply::warning(
                "one family of planes is seen edge-on: depths are poorly determined",
            ));
        }
        Ok(())
    }

    pub(super) fn types(&mut self, args: &mut Args) -> Result<(), CommandError> {
        if args.take("AUTO") {
            args.end()?;
            let drawing = self.active_mut()?.draw();
            let (oblique, left) = drawing.type_certain();
            let list = |ids: &[LineId]| -> String {
                let all: Vec<String> = ids.iter().map(|l| drawing.line_text(*l)).collect();
                all.join(", ")
            };
            let lines = drawing.lines.len() - left.len();
            let mut out = vec![CommandReply::note(format!("{lines} lines typed"))];
            if !oblique.is_empty() {
                let text = format!("proposed as oblique, please check: {}", list(&oblique));
                out.push(CommandReply::warning(text));
            }
            out.extend(left.iter().map(|p| proposal_reply(drawing, p)));
            self.out.extend(out);
            return Ok(());
        }
        let mut lines = Vec::new();
        while args.at_number() {
            lines.push(args.line()?);
        }
        if lines.is_empty() {
            return Err(args.wants("the numbers of lines, or AUTO"));
        }
        args.take_short("AS");
        let object = self.active_mut()?;
        let free = line_type(&object.drawing, args)?;
        args.end()?;
        for id in lines {
            let line = require_line(object, id)?;
            let typed = DrawnLine { free, source: LineTypeSource::User, confidence: 1.0, ..line };
            object.draw().lines.insert(id, typed);
        }
        Ok(())
    }

    pub(super) fn align(&mut self, args: &mut Args, set: bool) -> Result<(), CommandError> {
        let axis = args.axis().ok_or_else(|| args.wants("an axis"))?;
        let first = args.point()?;
        let mut others = vec![args.point()?];
        while args.len() > 0 {
            others.push(args.point()?);
        }
        let object = self.active_mut()?;
        require_point(object, first)?;
        for q in others {
            require_point(object, q)?;
            let same = |a: &Align| a.axis == axis && [(first, q), (q, first)].contains(&(a.p, a.q));
            let aligns = &mut object.draw().aligns;
            let before = aligns.len();
            aligns.retain(|a| !same(a));
            if set && first != q {
                aligns.push(Align { axis, p: first, q });
            } else if !set && aligns.len() == before {
                return Err(CommandError::text(
                    format!("points {first} and {q} are not aligned on {axis}"),
                    "WHY lists the dimensions that determine them",
                )
                .about(ReplySubject::of("not-aligned").points([first, q]).axis(axis)));
            }
        }
        Ok(())
    }
}

/// A proposed type with its alternatives, as a warning.
fn proposal_reply(drawing: &Drawing, proposal: &TypeProposal) -> CommandReply {
    let letter = |free: Option<Free>| {
        free.map_or("inclined".to_owned(), |f| {
            drawing.letters.letter(f, drawing.section).to_string()
        })
    };
    let likeliest = letter(Some(proposal.free));
    let types = std::iter::once((likeliest.clone(), proposal.probability))
        .chain(proposal.alternatives.iter().map(|(free, p)| (letter(*free), *p)))
        .filter(|t| t.1 >= 0.005);
    let (names, texts): (Vec<String>, Vec<String>) =
        types.map(|(t, p)| (t.clone(), format!("{t} ({:.0} %)", 100.0 * p))).unzip();
    let line = proposal.line;
    let text = format!("line {line}, {}: {}", drawing.line_text(line), texts.join(", "));
    CommandReply {
        next: Some(format!("TYPE {line} AS {likeliest}")),
        about: ReplySubject::of("proposed-type")
            .lines([line])
            .names(&names)
            .value(proposal.probability),
        ..CommandReply::warning(text)
    }
}

/// A type, by letter or axes.
pub(super) fn line_type(drawing: &Drawing, args: &mut Args) -> Result<Option<Free>, CommandError> {
    let word = args.name("a type: X, Y, Z, H, P, F, O, XY, XZ or YZ")?;
    if word.eq_ignore_ascii_case("NONE") {
        return Ok(None);
    }
    let free = drawing.letters.free(&word, drawing.section).ok_or_else(|| {
        CommandError::new(
            406,
            format!("{word} is not a line type"),
            "types are X, Y, Z, H, P, F, O, XY, XZ, YZ",
        )
    })?;
    match drawing.section {
        Some(normal) if free.contains(normal) => Err(CommandError::new(
            406,
            format!("in this cross section no line runs along {normal}"),
            "use F for lines that are parallel to neither axis",
        )
        .about(ReplySubject::of("section-line").axis(normal))),
        _ => Ok(Some(free)),
    }
}

/// The object must have points.
pub(super) fn require_points(object: &SketchObject) -> Result<(), CommandError> {
    if !object.drawing.points.is_empty() {
        return Ok(());
    }
    let text = format!("object {} has no points yet", object.name);
    let error = CommandError::new(101, text, "draw some, or INPUT it");
    Err(error.about(ReplySubject::of("no-points").names([&object.name])))
}

/// The object must have points and lines.
pub(super) fn require_lines(object: &SketchObject) -> Result<(), CommandError> {
    require_points(object)?;
    if !object.drawing.lines.is_empty() {
        return Ok(());
    }
    let error = CommandError::new(102, format!("object {} has no lines", object.name), "draw some");
    Err(error.about(ReplySubject::of("no-lines").names([&object.name])))
}

/// The point must exist.
pub(super) fn require_point(object: &SketchObject, p: PointId) -> Result<(), CommandError> {
    if object.drawing.points.contains_key(&p) {
        return Ok(());
    }
    let (code, text) = if object.drawing.points.is_empty() {
        (101, format!("object {} has no points yet", object.name))
    } else {
        (0, format!("no point {p} in {}", object.name))
    };
    let error = CommandError::new(code, text, "draw it with POINT, or see LIST POINTS");
    Err(error.about(ReplySubject::of("unknown-point").points([p])))
}

/// The line must exist.
pub(super) fn require_line(object: &SketchObject, id: LineId) -> Result<DrawnLine, CommandError> {
    object.drawing.lines.get(&id).copied().ok_or_else(|| {
        let (code, text) = if object.drawing.lines.is_empty() {
            (102, format!("object {} has no lines", object.name))
        } else {
            (0, format!("no line {id} in {}", object.name))
        };
        CommandError::new(code, text, "draw it with LINE, or see LIST LINES")
            .about(ReplySubject::of("unknown-line").lines([id]))
    })
}

/// `SET UP`, `SET NAMES`: meaning of the letters.
pub(super) fn set_letters(
    drawing: &mut Drawing,
    up: Option<CoordinateAxis>,
    naming: Option<Naming>,
) {
    drawing.letters.up = up.unwrap_or(drawing.letters.up);
    drawing.letters.naming = naming.unwrap_or(drawing.letters.naming);
}
