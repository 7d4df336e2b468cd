//! Commands that look: CHECK, WHY, ESTIMATE, LIST, MEASURE, DISPLAY and their relatives.

use super::args::Args;
use super::digits::{place_text, rounded};
use super::dims::dimension_fault;
use super::draw::require_point;
use super::no_body::no_body;
use super::session::{CommandReply, DrawingCache, SketchSession};
use super::subject::{ReplySubject, Suggestion};
use super::{CommandError, words::CommandTokenKind};
use crate::dimension::solver::PageScale;
use crate::solid::feature::NoBody;
use crate::solid::validity::SolidDefect;
use crate::{
    Align, CoordinateAxis, DOUBTFUL, Dimension, DimensionLayout, DimensionRole, MeasuredQuantity,
    Planes, Projection, SketchObject, TypeFault, chain, chain_text,
};
use moldloft_diag::Severity;
use moldloft_syntax::number::plain;
use std::sync::Arc;

/// Largest gap of planes that may be one, in standard deviations of a drawn coordinate.
const NEAR_PLANES: f64 = 4.0;

/// Maximum number of such pairs that are named, the closest first.
const MOST_PROPOSALS: usize = 20;

impl SketchSession {
    /// The first fault of types that stops a conversion: 300, 400, 401, 402.
    pub(super) fn first_type_fault(
        &self,
        object: &SketchObject,
        planes: &Planes,
    ) -> Option<CommandError> {
        let drawing = &object.drawing;
        let faults = planes.faults(drawing);
        let untyped: Vec<String> = (faults.iter())
            .filter_map(|f| match f {
                TypeFault::Untyped { line } => {
                    Some(format!("{line} ({})", drawing.line_text(*line)))
                }
                _ => None,
            })
            .collect();
        if !untyped.is_empty() {
            return Some(
                CommandError::new(
                    402,
                    format!("set line types first: lines {} are untyped", untyped.join(", ")),
                    "TYPE line AS type, or TYPE AUTO",
                )
                .about(ReplySubject::of("untyped-line").lines(
                    faults.iter().filter_map(|f| match f {
                        TypeFault::Untyped { line } => Some(*line),
                        _ => None,
                    }),
                )),
            );
        }
        faults
            .iter()
            .find(|f| !matches!(f, TypeFault::Degraded { .. }))
            .map(|f| self.type_fault(object, f))
    }

    fn type_fault(&self, object: &SketchObject, fault: &TypeFault) -> CommandError {
        let drawing = &object.drawing;
        let lines_of = |path: &[crate::Reason]| -> Vec<crate::LineId> {
            let line = |r: &crate::Reason| match r {
                crate::Reason::Line(id) => Some(*id),
                _ => None,
            };
            path.iter().filter_map(line).collect()
        };
        let text = |path: &[crate::Reason]| {
            path.iter().map(|r| r.text(drawing)).collect::<Vec<_>>().join(", ")
        };
        match fault {
            TypeFault::Contradiction { line, axis, path } => {
                // The line that was drawn worst for its type is the likeliest to be wrong.
                let lines = lines_of(path).into_iter();
                let misfit = |id: &crate::LineId| {
                    let own = drawing.lines.get(id);
                    let own = own.and_then(|l| Some((l, l.free?.single()?)));
                    own.map_or(0.0, |(l, axis)| drawing.projection.lean(drawing.stroke(l), axis))
                };
                let suspect = lines.max_by(|a, b| misfit(a).total_cmp(&misfit(b)));
                let next = match suspect {
                    Some(id) => {
                        format!("retype the wrong one, perhaps line {id}: TYPE {id} AS {axis}")
                    }
                    None => "retype the line or remove an alignment".to_owned(),
                };
                CommandError::new(
                    400,
                    format!(
                        "line types contradict: {} cannot run along {axis}, because {} put both ends in the same {axis} plane",
                        drawing.line_text(*line),
                        text(path)
                    ),
                    next,
                )
                .about(
                    // The suspect first, then the line that cannot be, then the others of the path.
                    ReplySubject::of("type-contradiction")
                        .axis(*axis)
                        .lines(suspect)
                        .lines([*line])
                        .lines(lines_of(path)),
                )
            }
            TypeFault::Degraded { line, really, path, .. } => CommandError::new(
                400,
                format!(
                    "{} is really {}, because of {}",
                    drawing.line_text(*line),
                    drawing.letters.letter(*really, drawing.section),
                    text(path)
                ),
                format!("TYPE {line} AS {}, or retype a line of the path", really.spelling()),
            )
            .about(ReplySubject::of("type-degraded").lines([*line]).lines(lines_of(path))),
            TypeFault::Coincident { p, q } => CommandError::new(
                300,
                format!("points {p} and {q} are in the same three planes, so they coincide"),
                format!("WELD {p} {q}, or retype a line between them"),
            )
            .about(ReplySubject::of("coincident-points").points([*p, *q])),
            TypeFault::Loose { point } => CommandError::new(
                401,
                format!("point {point} belongs to no line"),
                format!("draw a line to it, or DELETE POINT {point}"),
            )
            .about(ReplySubject::of("loose-point").points([*point])),
            TypeFault::Untyped { line } => CommandError::new(
                402,
                format!("line {line} is untyped"),
                format!("TYPE {line} AS type"),
            )
            .about(ReplySubject::of("untyped-line").lines([*line])),
        }
    }

    /// Reports the parts without connection to the reference, with suggestions.
    pub(super) fn loose_lines(
        &self,
        object: &SketchObject,
        view: &DrawingCache,
        layout: &DimensionLayout<f64>,
    ) -> Vec<(String, ReplySubject)> {
        (layout.loose.iter().zip(suggestions(object, view, layout)))
            .map(|(loose, suggested)| {
                let axis = loose.axis;
                let points: Vec<String> = loose.points.iter().map(ToString::to_string).collect();
                let mut text = format!(
                    "{axis}: {} of {}; the plane of points {} is free",
                    layout.counts[axis.index()].given,
                    layout.counts[axis.index()].required,
                    points.join(",")
                );
                if let Some(s) = suggested {
                    text.push_str(&format!(
                        "; from the sketch DIMENSION {axis} {} {} = {}",
                        s.p,
                        s.q,
                        plain(s.value)
                    ));
                    if s.open {
                        text.push_str(" (the picture leaves this depth open)");
                    }
                }
                let about = ReplySubject::of("missing-dimension").axis(axis);
                let about = about.points(loose.points.iter().copied());
                (text, ReplySubject { suggestion: suggested, ..about })
            })
            .collect()
    }

    pub(super) fn check(&mut self, args: &mut Args) -> Result<(), CommandError> {
        self.take_object(args)?;
        args.end()?;
        let object = self.active()?.clone();
        let (view, layout) = self.laid_out(&object);
        for fault in view.planes.faults(&object.drawing) {
            let fault = self.type_fault(&object, &fault);
            let mut reply = CommandReply::warning(fault.text);
            (reply.code, reply.next) = (Some(fault.code), Some(fault.next));
            reply.about = *fault.about;
            self.out.push(reply);
        }
        let confidences = object.drawing.confidences();
        for (id, line) in &object.drawing.lines {
            let confidence = confidences[id];
            if line.free.is_some() && confidence < DOUBTFUL {
                let text = format!(
                    "line {id}, {}: the type is doubtful ({:.0} %)",
                    object.drawing.line_text(*id),
                    100.0 * confidence
                );
                let about = ReplySubject::of("doubtful-type").lines([*id]).value(confidence);
                self.out.push(CommandReply { about, ..CommandReply::warning(text) });
            }
        }
        let guessed = object.drawing.lines.iter().filter(|(_, l)| l.proposed());
        let guessed: Vec<crate::LineId> = guessed.map(|(id, _)| *id).collect();
        if !guessed.is_empty() {
            let list: Vec<String> = (guessed.iter())
                .map(|id| format!("{id} ({})", object.drawing.line_text(*id)))
                .collect();
            let text = format!(
                "inclined, and taken as oblique because their ends share no plane: lines {}",
                list.join(", ")
            );
            let mut reply = CommandReply::warning(text);
            reply.next = Some("TYPE line AS H, P or F where one coordinate stays".to_owned());
            reply.about = ReplySubject::of("taken-as-oblique").lines(guessed);
            self.out.push(reply);
        }
        for (kept, gone, distance) in object.drawing.gaps(None) {
            let text = format!("{gone} is {} from {kept} on the page", plain(rounded(distance)));
            let mut reply = CommandReply::warning(text);
            reply.next = Some(format!("WELD {kept} {gone} if they are one point"));
            reply.about = ReplySubject::of("gap").points([kept, gone]).value(distance);
            self.out.push(reply);
        }
        for fault in &layout.faults {
            let fault = dimension_fault(fault);
            let about = *fault.about;
            self.out.push(CommandReply { about, ..CommandReply::warning(fault.text) });
        }
        for Align { axis, p, q } in likely_aligns(&object, &view, &layout) {
            let text =
                format!("{axis}: points {p} and {q} are in one plane, as far as the picture tells");
            let mut reply = CommandReply::warning(text);
            reply.next = Some(format!("ALIGN {axis} {p} {q}"));
            reply.about = ReplySubject::of("likely-one-plane").points([p, q]).axis(axis);
            self.out.push(reply);
        }
        self.out.extend(near_planes(&object, &view, &layout));
        for (text, about) in self.loose_lines(&object, &view, &layout) {
            self.out.push(CommandReply { about, ..CommandReply::warning(text) });
        }
        self.report_validity()?;
        self.report_counts()
    }

    /// The end of an object: faces that were added one by one are all there now.
    pub(super) fn report_open(&mut self) -> Result<(), CommandError> {
        let object = self.active_arc()?;
        let worked = self.worked(&object);
        if let Err(why @ NoBody::Flaw(SolidDefect::Open(_))) = worked.body()
            && worked.layout.complete()
        {
            self.out.push(CommandReply::warning_of(no_body(&object, why)));
        }
        Ok(())
    }

    /// Effects of a change of values on an otherwise finished object: planes that passed each
    /// other, faces that are not flat, curves that do not fit.
    pub(super) fn report_validity(&mut self) -> Result<(), CommandError> {
        self.report_validity_of(false)
    }

    /// [`Self::report_validity`]; a body that is open while faces are `added` one by one is a note, not a warning.
    pub(super) fn report_validity_of(&mut self, added: bool) -> Result<(), CommandError> {
        let object = self.active_arc()?;
        let worked = self.worked(&object);
        let (view, layout) = (&worked.view, &worked.layout);
        let planes = &view.planes;
        if let Some(e) = view.estimate() {
            let clear = 0.02 * e.extent();
            for (id, line) in &object.drawing.lines {
                let Some(axis) = line.free.and_then(crate::Free::single) else { continue };
                let ends = [line.p, line.q]
                    .map(|p| (layout.coordinate(planes, axis, p), planes.plane(axis, p)));
                if let [(Some(a), Some(i)), (Some(b), Some(j))] = ends {
                    let drawn = e.plane(axis, j) - e.plane(axis, i);
                    if drawn.abs() > clear && (b - a) * drawn.signum() <= 0.0 {
                        let text = format!(
                            "line {id}, {}: its planes passed each other",
                            object.drawing.line_text(*id)
                        );
                        let about = ReplySubject::of("planes-passed").lines([*id]).axis(axis);
                        let about = about.value(b - a);
                        self.out.push(CommandReply { about, ..CommandReply::warning(text) });
                    }
                }
            }
        }
        // The body of a feature is made once after several changes.
        if object.feature.is_some() && self.running > 0 && self.state.outside.is_empty() {
            self.unchecked.insert(object.name.to_lowercase(), true);
            return Ok(());
        }
        self.report_body(&object, added);
        Ok(())
    }

    /// Reports why a finished object has no body, faces that are not plane and curves that are not built in.
    fn report_body(&mut self, object: &Arc<SketchObject>, added: bool) {
        let worked = self.worked(object);
        let (planes, layout) = (&worked.view.planes, &worked.layout);
        let finished = object.feature.is_some() || (layout.complete() && !object.faces.is_empty());
        if let Err(why) = worked.body()
            && finished
        {
            let mut reply = CommandReply::warning_of(no_body(object, why));
            if added && matches!(why, NoBody::Flaw(SolidDefect::Open(_))) {
                reply.severity = Severity::Note;
            }
            self.out.push(reply);
        }
        if let Some(solid) = worked.solid() {
            for (id, face) in &object.faces {
                let at: Vec<_> =
                    face.loops().flatten().filter_map(|p| layout.point(planes, *p)).collect();
                let off = crate::solid::faces::flatness(&at);
                let size = at.iter().map(|p| p.distance(at[0])).fold(0.0, f64::max);
                if off > 1e-6 * size {
                    let mut reply = CommandReply::warning(format!(
                        "face {id} is no longer plane (off by {}); it is measured and written as triangles",
                        plain(rounded(off))
                    ));
                    reply.code = Some(703);
                    reply.about = ReplySubject::of("warped-face").faces([*id]).value(off);
                    reply.next =
                        Some("UNDO, or draw a line across it and GENERATE FACES".to_owned());
                    self.out.push(reply);
                }
            }
            for unbuilt in &solid.unbuilt {
                self.out.push(super::curves::unbuilt_reply(unbuilt));
            }
        }
    }

    /// Makes the bodies of the features that changed, and warns of those that have none.
    pub(super) fn check_bodies(&mut self) -> Vec<CommandReply> {
        let outer = std::mem::take(&mut self.out);
        for (key, own) in std::mem::take(&mut self.unchecked) {
            let Some(object) = self.state.objects.get(&key).map(Arc::clone) else { continue };
            if own {
                self.report_body(&object, false);
            } else if let Err(why) = self.worked(&object).body() {
                self.out.push(CommandReply::warning_of(no_body(&object, why)));
            }
        }
        std::mem::replace(&mut self.out, outer)
    }

    pub(super) fn why(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let object = self.active()?.clone();
        let (view, layout) = self.laid_out(&object);
        let planes = &view.planes;
        if let Some(axis) = args
            .peek()
            .filter(|t| t.kind == CommandTokenKind::Word && args.number_at(1))
            .and_then(|t| CoordinateAxis::of(&t.text))
        {
            args.skip();
            let (p, q) = (args.point()?, args.point()?);
            args.end()?;
            require_point(&object, p)?;
            require_point(&object, q)?;
            let mut about;
            let text = match crate::why(&object.drawing, axis, p, q) {
                Some(path) => {
                    about = ReplySubject::of("shared-plane").points([p, q]).value(0.0);
                    about.lines.extend(path.iter().filter_map(|r| match r {
                        crate::Reason::Line(id) => Some(*id),
                        _ => None,
                    }));
                    let path: Vec<String> = path.iter().map(|r| r.text(&object.drawing)).collect();
                    format!("points {p} and {q} share an {axis} plane by {}", path.join(", "))
                }
                None => match chain(&object, planes, axis, p, q) {
                    Some((way, names)) => {
                        let at = [p, q].map(|p| layout.coordinate(planes, axis, p));
                        about = ReplySubject::of("chain").points(way.iter().copied()).names(&names);
                        about = about.value(at[0].zip(at[1]).map(|(a, b)| b - a));
                        format!(
                            "{axis} from {p} to {q} follows from {} via {}",
                            names.join(", "),
                            chain_text(&way)
                        )
                    }
                    None => {
                        about = ReplySubject::of("undetermined").points([p, q]);
                        format!("{axis} from {p} to {q} is not determined")
                    }
                },
            };
            let about = about.axis(axis);
            self.out.push(CommandReply { about, ..CommandReply::note(text) });
            return Ok(());
        }
        if args.at_number() {
            let p = args.point()?;
            args.end()?;
            require_point(&object, p)?;
            let reference = object.reference().map_or(p, |r| r.point);
            for axis in CoordinateAxis::ALL {
                let found = layout.coordinate(planes, axis, p);
                let mut about = ReplySubject::of(if found.is_some() { "chain" } else { "free" });
                let text = match (found, chain(&object, planes, axis, reference, p)) {
                    (Some(x), Some((way, names))) => {
                        about = about.points(way.iter().copied()).names(&names);
                        format!("{axis} = {} via {}", plain(x), chain_text(&way))
                    }
                    (Some(x), None) => {
                        about = about.points([p]);
                        format!("{axis} = {}", plain(x))
                    }
                    (None, _) => {
                        about = about.points([p]);
                        format!("{axis} is free")
                    }
                };
                let about = about.axis(axis).value(found);
                self.out.push(CommandReply { about, ..CommandReply::note(text) });
            }
            return Ok(());
        }
        let name = args.name("a dimension, a point, or an axis with two points")?;
        args.end()?;
        let Some(d) = object.dimensions.get(&name.to_ascii_lowercase()) else {
            return Err(CommandError::text(
                format!("there is no dimension {name}"),
                "LIST DIMENSIONS lists them",
            )
            .about(ReplySubject::of("unknown-name").names([&name])));
        };
        let text = match (d.role, &d.measure) {
            (DimensionRole::Reference, MeasuredQuantity::Along { axis, p, q }) => {
                match chain(&object, planes, *axis, *p, *q) {
                    Some((way, names)) => format!(
                        "{name} only measures: {} determine it via {}",
                        names.join(", "),
                        chain_text(&way)
                    ),
                    None => format!("{name} only measures, and nothing determines it now"),
                }
            }
            (DimensionRole::Reference, _) => format!("{name} only measures"),
            (DimensionRole::Driving, MeasuredQuantity::Along { axis, q, .. }) => {
                let mut without = object.clone();
                without.dimensions.shift_remove(&name.to_ascii_lowercase());
                let layout = self.laid_out(&without).1;
                let moved: Vec<String> = (layout.loose.iter())
                    .filter(|l| l.axis == *axis)
                    .flat_map(|l| l.points.iter().map(ToString::to_string))
                    .collect();
                if moved.is_empty() {
                    format!("{name} places point {q}")
                } else {
                    format!("{name} places points {}", moved.join(","))
                }
            }
            _ => format!("{name} drives the shape"),
        };
        self.out.push(CommandReply::note(text));
        Ok(())
    }

    pub(super) fn estimate(&mut self, args: &mut Args) -> Result<(), CommandError> {
        args.end()?;
        let object = self.active()?.clone();
        let (view, layout) = self.laid_out(&object);
        let Some(e) = view.estimate() else {
            return Err(CommandError::new(
                101,
                "nothing to estimate, or too many points",
                "draw points and lines",
            ));
        };
        let n = e.depths.len();
        self.out.push(CommandReply::note(format!(
            "the picture leaves {n} depth{} open",
            if n == 1 { "" } else { "s" }
        )));
        for depth in &e.depths {
            let points: Vec<String> = depth.points.iter().map(ToString::to_string).collect();
            self.out.push(CommandReply::note(format!(
                "points {} can slide along the line of sight",
                points.join(",")
            )));
        }
        for (text, about) in self.loose_lines(&object, &view, &layout) {
            self.out.push(CommandReply { about, ..CommandReply::note(text) });
        }
        Ok(())
    }

    pub(super) fn extensions(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let only = args.axis();
        args.end()?;
        let object = self.active()?.clone();
        let (view, layout) = self.laid_out(&object);
        for axis in CoordinateAxis::ALL.into_iter().filter(|a| only.is_none_or(|o| o == *a)) {
            let mut rows: Vec<(Option<f64>, CommandReply)> = (0..view.planes.counts()
                [axis.index()])
                .map(|k| {
                    let points: Vec<String> =
                        view.planes.members(axis, k).iter().map(ToString::to_string).collect();
                    let at = layout.coordinates[axis.index()][k];
                    let value = at.map_or("free".to_owned(), plain);
                    let text = format!("{axis} plane of {}: {value}", points.join(","));
                    let about = ReplySubject::of("plane").axis(axis).value(at);
                    let about = about.points(view.planes.members(axis, k).iter().copied());
                    (at, CommandReply { about, ..CommandReply::note(text) })
                })
                .collect();
            rows.sort_by(|a, b| {
                a.0.unwrap_or(f64::INFINITY).total_cmp(&b.0.unwrap_or(f64::INFINITY))
            });
            self.out.extend(rows.into_iter().map(|r| r.1));
        }
        Ok(())
    }

    pub(super) fn list(&mut self, args: &mut Args) -> Result<(), CommandError> {
        const WHAT: [&str; 8] =
            ["POINTS", "LINES", "FACES", "CURVES", "DIMENSIONS", "PLANES", "OBJECTS", "VARIABLES"];
        let what = WHAT.into_iter().find(|w| args.at(w));
        if what.is_some() {
            args.skip();
        }
        if what == Some("OBJECTS") || (what.is_none() && args.len() == 0) {
            args.end()?;
            let rows: Vec<CommandReply> = (self.state.objects.iter())
                .map(|(key, o)| {
                    let mark =
                        if self.state.active.as_ref() == Some(key) { " (active)" } else { "" };
                    let (p, l, f) = (o.drawing.points.len(), o.drawing.lines.len(), o.faces.len());
                    CommandReply::note(format!(
                        "{}{mark}: {p} points, {l} lines, {f} faces",
                        o.name
                    ))
                })
                .collect();
            self.out.extend(rows);
            return Ok(());
        }
        if let Some(token) = args.peek() {
            self.known(&token.text)?;
        }
        self.take_object(args)?;
        args.end()?;
        let object = self.active()?.clone();
        let (view, layout) = self.laid_out(&object);
        let all = what.is_none();
        let on = |w: &str| all || what == Some(w);
        let mut rows = Vec::new();
        if on("POINTS") {
            for p in object.drawing.points.keys() {
                let at = CoordinateAxis::ALL
                    .map(|a| layout.coordinate(&view.planes, a, *p).map_or("?".to_owned(), plain));
                let drawn = object.drawing.points[p];
                rows.push(format!(
                    "point {p}: {} (page {} {})",
                    at.join(" "),
                    plain(drawn.u),
                    plain(drawn.v)
                ));
            }
        }
        if on("LINES") {
            rows.extend(
                object
                    .drawing
                    .lines
                    .keys()
                    .map(|l| format!("line {l}: {}", object.drawing.line_text(*l))),
            );
        }
        if on("FACES") {
            for (id, f) in &object.faces {
                let cycles: Vec<String> = f
                    .loops()
                    .map(|c| c.iter().map(ToString::to_string).collect::<Vec<_>>().join(" "))
                    .collect();
                rows.push(format!("face {id}: {}", cycles.join(" HOLE ")));
            }
            if object.feature.is_some()
                && let Ok(solid) = self.worked(&std::sync::Arc::new(object.clone())).body()
            {
                rows.extend((0..solid.faces.len()).map(|f| {
                    let (text, at) = solid.face_text(f);
                    let place = place_text(at);
                    format!("{text} from {place}")
                }));
            }
        }
        if on("CURVES") {
            for c in object.curves.values() {
                let points: Vec<String> = c.points.iter().map(ToString::to_string).collect();
                rows.push(format!("{} {}: points {}", c.kind.word(), c.name, points.join(" ")));
            }
        }
        if on("DIMENSIONS") {
            for (key, d) in &object.dimensions {
                let value = d.value.as_ref().map_or("unset".to_owned(), |v| v.text().to_owned());
                let number = match d.role {
                    DimensionRole::Driving => layout.values.get(key).copied(),
                    DimensionRole::Reference => layout.measured(&object, &view.planes, &d.measure),
                };
                let number = number.map_or(String::new(), |x| format!(" = {}", plain(x)));
                let text = super::files::measure_text(&d.measure);
                rows.push(match d.role {
                    DimensionRole::Driving => format!("{} {text}: {value}{number}", d.name),
                    DimensionRole::Reference => format!("({} {text}{number})", d.name),
                });
            }
        }
        if on("VARIABLES") {
            for (key, v) in &object.variables {
                let number = layout.values.get(key).map_or("?".to_owned(), |x| plain(*x));
                rows.push(format!("{}: {} = {number}", v.name, v.value));
            }
        }
        if rows.is_empty() && what != Some("PLANES") {
            let what = what.unwrap_or("PARTS").to_lowercase();
            rows.push(format!("{} has no {what}", object.name));
        }
        self.out.extend(rows.into_iter().map(CommandReply::note));
        if what == Some("PLANES") {
            return self.extensions(&mut Args::new(&[], ""));
        }
        Ok(())
    }

    pub(super) fn measure(&mut self, args: &mut Args) -> Result<(), CommandError> {
        const WHAT: [&str; 4] = ["VOLUME", "AREA", "CENTROID", "INERTIA"];
        let word = |a: &Args| WHAT.into_iter().find(|w| a.at(w));
        if word(args).is_none() {
            if let Some(token) = args.peek() {
                self.known(&token.text)?;
            }
            self.take_object(args)?;
        }
        let what = word(args);
        if what.is_some() {
            args.skip();
        }
        args.end()?;
        let object = self.active_arc()?;
        let worked = self.worked(&object);
        let solid = worked.body().map_err(|why| no_body(&object, why))?;
        let mass = solid.mass();
        let c = mass.centroid.to_array().map(plain).join(" ");
        let rows = [
            ("VOLUME", format!("volume {}", plain(mass.volume))),
            ("AREA", format!("area {}", plain(mass.area))),
            ("CENTROID", format!("centroid {c}")),
            (
                "INERTIA",
                format!(
                    "inertia about the centroid, xx yy zz yz zx xy: {}",
                    mass.inertia.map(plain).join(" ")
                ),
            ),
        ];
        let rows = rows.into_iter().filter(|r| what.is_none_or(|w| w == r.0));
        self.out.extend(rows.map(|r| CommandReply::note(r.1)));
        Ok(())
    }

    pub(super) fn display(&mut self, args: &mut Args, shown: bool) -> Result<(), CommandError> {
        let name =
            if args.len() == 0 || args.at("ALL") { None } else { Some(args.name("a name")?) };
        args.take("ALL");
        args.end()?;
        if let Some(name) = &name {
            self.known(name)?;
        }
        for (key, object) in &mut self.state.objects {
            if name.as_ref().is_none_or(|n| n.to_lowercase() == *key) && object.display != shown {
                std::sync::Arc::make_mut(object).display = shown;
            }
        }
        Ok(())
    }

    pub(super) fn keep(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let mut names = vec![args.name("the name of an object")?];
        while args.len() > 0 && !args.at("OFF") {
            names.push(args.name("the name of an object, or OFF")?);
        }
        let keep = !args.take("OFF");
        args.end()?;
        for name in &names {
            self.known(name)?;
        }
        for name in names {
            let object = self.state.objects.get_mut(&name.to_lowercase());
            object.into_iter().for_each(|o| std::sync::Arc::make_mut(o).keep = keep);
        }
        Ok(())
    }

    pub(super) fn show(&mut self, args: &mut Args) -> Result<(), CommandError> {
        if args.at("FACE") && args.number_at(1) {
            args.skip();
            let id = crate::FaceId(args.count("a face")?);
            args.end()?;
            let object = self.active()?;
            let Some(face) = object.faces.get(&id) else {
                return Err(CommandError::text(
                    format!("there is no face {id}"),
                    "LIST FACES lists them",
                )
                .about(ReplySubject::of("unknown-face").faces([id])));
            };
            let text: Vec<String> = face.outer.iter().map(ToString::to_string).collect();
            let text = format!("face {id} runs {}", text.join(" "));
            self.out.push(CommandReply::note(text));
            self.state.picture.face = Some(id);
            return Ok(());
        }
        if args.at("FACE") && args.tokens_at(1, "OFF") {
            args.skip();
            args.skip();
            args.end()?;
            self.state.picture.face = None;
            return Ok(());
        }
        let what = ["LABELS", "PLANES", "DIMENSIONS", "TYPES"].into_iter().find(|w| args.at(w));
        let Some(what) = what else {
            return Err(args.wants("LABELS, PLANES, DIMENSIONS, TYPES or FACE"));
        };
        args.skip();
        let off = args.take_short("OFF");
        args.take_short("ON");
        args.end()?;
        let picture = &mut self.state.picture;
        match what {
            "LABELS" => picture.labels = !off,
            "PLANES" => picture.planes = !off,
            "DIMENSIONS" => picture.dimensions = !off,
            _ => picture.types = !off,
        }
        Ok(())
    }

    /// The window on the page; by default that of all points.
    pub(super) fn window(&self) -> [f64; 4] {
        self.state.picture.window.unwrap_or_else(|| self.page())
    }

    /// The part of the page that is drawn on.
    pub(super) fn page(&self) -> [f64; 4] {
        let mut w = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        for p in self.state.objects.values().flat_map(|o| o.drawing.points.values()) {
            w = [w[0].min(p.u), w[1].min(p.v), w[2].max(p.u), w[3].max(p.v)];
        }
        if w[0] > w[2] {
            return [0.0, 0.0, 1.0, 1.0];
        }
        // A flat page is given some height or width.
        let size = (w[2] - w[0]).max(w[3] - w[1]);
        let size = if size > 0.0 { size } else { 1.0 };
        let pad = |low: f64, high: f64| if high > low { 0.0 } else { 0.5 * size };
        let (du, dv) = (pad(w[0], w[2]), pad(w[1], w[3]));
        [w[0] - du, w[1] - dv, w[2] + du, w[3] + dv]
    }

    pub(super) fn zoom(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let [l, b, r, t] = self.window();
        let window = if args.len() == 0 || args.take("FIT") {
            None
        } else if args.take("WINDOW") {
            let mut w = [0.0; 4];
            for x in &mut w {
                *x = args.number("a screen coordinate")?;
            }
            Some([w[0].min(w[2]), w[1].min(w[3]), w[0].max(w[2]), w[1].max(w[3])])
        } else {
            let factor = args.number("a factor")?;
            if !(factor > 0.0 && factor < 1e6) {
                return Err(CommandError::text(
                    "the factor must be positive",
                    "ZOOM 2 shows half the page",
                ));
            }
            let (cu, cv) = ((l + r) / 2.0, (b + t) / 2.0);
            let (hu, hv) = ((r - l) / 2.0 / factor, (t - b) / 2.0 / factor);
            Some([cu - hu, cv - hv, cu + hu, cv + hv])
        };
        args.end()?;
        if window.is_some_and(|w| !(w[2] - w[0] > 0.0 && w[3] - w[1] > 0.0)) {
            return Err(CommandError::text("the window is empty", "give two opposite corners"));
        }
        self.state.picture.window = window;
        Ok(())
    }

    pub(super) fn pan(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let (du, dv) = (args.number("a shift to the right")?, args.number("a shift up")?);
        args.end()?;
        let [l, b, r, t] = self.window();
        self.state.picture.window = Some([l + du, b + dv, r + du, t + dv]);
        Ok(())
    }

    pub(super) fn view_from(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let name = args.name("a projection, TOP, FRONT, SIDE or SKETCH")?.to_ascii_uppercase();
        args.end()?;
        if !["TOP", "FRONT", "SIDE", "SKETCH"].contains(&name.as_str())
            && Projection::preset(&name).is_none()
        {
            return Err(CommandError::text(
                format!("there is no view {name}"),
                format!("views are TOP, FRONT, SIDE, SKETCH, {}", Projection::PRESETS.join(", ")),
            ));
        }
        self.state.picture.view = name;
        Ok(())
    }
}

/// Pairs of planes that are drawn nearly as one, with nothing that relates them.
fn near_planes(
    object: &SketchObject,
    view: &DrawingCache,
    layout: &DimensionLayout<f64>,
) -> Vec<CommandReply> {
    let Some(estimate) = view.estimate().filter(|_| !object.drawing.exact) else {
        return Vec::new();
    };
    let near = NEAR_PLANES * object.drawing.noise_of_hand();
    let aligns = likely_aligns(object, view, layout);
    let mut found = Vec::new();
    for axis in CoordinateAxis::ALL {
        let known = |plane: usize| layout.coordinates[axis.index()][plane].is_some();
        let of = |p| view.planes.plane(axis, p);
        let mut order: Vec<usize> = (0..view.planes.counts()[axis.index()]).collect();
        order.sort_by(|&a, &b| estimate.plane(axis, a).total_cmp(&estimate.plane(axis, b)));
        for pair in order.windows(2) {
            let gap = estimate.plane(axis, pair[1]) - estimate.plane(axis, pair[0]);
            let ends = [0, 1].map(|k| view.planes.members(axis, pair[k]).first().copied());
            let [Some(p), Some(q)] = ends else { continue };
            let proposed = aligns.iter().any(|a| {
                let planes = [of(a.p), of(a.q)];
                a.axis == axis && pair.iter().all(|k| planes.contains(&Some(*k)))
            });
            if gap > near || proposed || pair.iter().all(|k| known(*k)) {
                continue;
            }
            let mut reply = CommandReply::warning(format!(
                "{axis}: points {p} and {q} are drawn nearly in one plane; with DIMENSION {axis} \
                 {p} {q} = value they are in two"
            ));
            reply.next = Some(format!("ALIGN {axis} {p} {q}"));
            reply.about = ReplySubject::of("nearly-one-plane").points([p, q]).axis(axis);
            found.push((gap, reply));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let left = found.len().saturating_sub(MOST_PROPOSALS);
    found.truncate(MOST_PROPOSALS);
    let more = (left > 0).then(|| {
        let text = format!("{left} more pairs of planes are drawn nearly as one");
        let about = ReplySubject::of("nearly-one-plane");
        CommandReply { about, ..CommandReply::warning(text) }
    });
    found.into_iter().map(|(_, reply)| reply).chain(more).collect()
}

/// Planes of parts of open depth that coincide with planes of the rest, as far as the picture tells,
/// unless dimensions determine the depth.
pub(super) fn likely_aligns(
    object: &SketchObject,
    view: &DrawingCache,
    layout: &DimensionLayout<f64>,
) -> Vec<Align> {
    let known = |align: &Align| {
        CoordinateAxis::ALL.into_iter().any(|axis| {
            let along = MeasuredQuantity::Along { axis, p: align.p, q: align.q };
            layout.measured(object, &view.planes, &along).is_some()
        })
    };
    let depths = view.estimate().map_or(&[][..], |e| &e.depths);
    let open = depths.iter().filter(|depth| !depth.aligns.iter().any(known));
    open.flat_map(|depth| &depth.aligns).copied().collect()
}

/// For each part that is not connected to the reference, the dimension to the nearest known plane.
pub(super) fn suggestions<'a>(
    object: &'a SketchObject,
    view: &'a DrawingCache,
    layout: &'a DimensionLayout<f64>,
) -> impl Iterator<Item = Option<Suggestion>> + 'a {
    let planes = &view.planes;
    let estimate = if object.drawing.exact { None } else { view.estimate() };
    let scale = estimate.map(|e| crate::scale(object, planes, layout, e));
    let known = known_planes(layout);
    let one = move |loose: &crate::Loose| {
        if object.drawing.exact {
            return as_drawn(object, planes, layout, loose);
        }
        as_estimated(planes, estimate?, scale?, &known, loose)
    };
    layout.loose.iter().map(one)
}

/// By axis, the planes with a coordinate.
fn known_planes(layout: &DimensionLayout<f64>) -> [Vec<bool>; 3] {
    layout.coordinates.each_ref().map(|c| c.iter().map(Option::is_some).collect())
}

/// The dimension of a picture that connects planes to the nearest known one.
fn as_estimated(
    planes: &crate::Planes,
    estimate: &crate::Estimate,
    scale: f64,
    known: &[Vec<bool>; 3],
    loose: &crate::Loose,
) -> Option<Suggestion> {
    let (axis, own) = (loose.axis, loose.planes[0]);
    let at = estimate.plane(axis, own);
    let gap = |k: usize| (at - estimate.plane(axis, k)) * scale;
    let known =
        (known[axis.index()].iter().enumerate()).filter_map(|(k, known)| known.then_some(k));
    let (k, gap) = known.map(|k| (k, gap(k))).min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    let (p, q) = (*planes.members(axis, k).first()?, *planes.members(axis, own).first()?);
    let (p, q) = if gap < 0.0 { (q, p) } else { (p, q) };
    let open = !estimate.determines(axis, k, own);
    Some(Suggestion { axis, p, q, value: rounded(gap.abs()), open })
}

/// The suggestions of a picture as they are if each is accepted before the next is asked for. With
/// lengths, slopes or angles, which may determine further planes, only the first.
pub(super) fn suggested_in_turn(
    object: &SketchObject,
    view: &DrawingCache,
    layout: &DimensionLayout<f64>,
) -> Vec<Suggestion> {
    let planes = &view.planes;
    let Some(estimate) = view.estimate() else { return vec![] };
    let along = |d: &Dimension| {
        matches!(d.measure, MeasuredQuantity::Along { .. } | MeasuredQuantity::Datum { .. })
    };
    let placed = object.reference().is_some_and(|r| r.at.iter().all(|at| at.literal().is_some()));
    let simple = placed
        && (object.dimensions.iter())
            .filter(|(_, d)| d.role == DimensionRole::Driving && d.value.is_some())
            .all(|(key, d)| along(d) && layout.values.contains_key(key));
    let mut scale = PageScale::of(object, planes, layout, estimate);
    let mut known = known_planes(layout);
    let mut left: Vec<&crate::Loose> = layout.loose.iter().collect();
    let mut out = Vec::new();
    loop {
        let now = scale.value();
        let one = |loose: &&crate::Loose| as_estimated(planes, estimate, now, &known, loose);
        let found = left.iter().enumerate().find_map(|(k, loose)| Some((k, one(loose)?)));
        let Some((k, found)) = found else { return out };
        let loose = left.remove(k);
        for &plane in &loose.planes {
            known[loose.axis.index()][plane] = true;
        }
        let gap = estimate.gap(planes, found.axis, [found.p, found.q]);
        gap.into_iter().for_each(|gap| scale.add(found.value, gap));
        out.push(found);
        if !simple {
            return out;
        }
    }
}

/// The dimension of an exact drawing that connects planes to those that are known.
fn as_drawn(
    object: &SketchObject,
    planes: &crate::Planes,
    layout: &DimensionLayout<f64>,
    loose: &crate::Loose,
) -> Option<Suggestion> {
    let (axis, own) = (loose.axis, *loose.planes.first()?);
    let known = layout.coordinates[axis.index()].iter().position(Option::is_some)?;
    let (p, q) = (*planes.members(axis, known).first()?, *planes.members(axis, own).first()?);
    let at = |p| object.drawing.drawn_coordinate(axis, p);
    let gap = at(q)? - at(p)?;
    let (p, q) = if gap < 0.0 { (q, p) } else { (p, q) };
    Some(Suggestion { axis, p, q, value: gap.abs(), open: false })
}
