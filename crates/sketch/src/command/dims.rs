//! Commands about dimensions, variables and settings.

use super::CommandError;
use super::args::Args;
use super::digits::rounded;
use super::draw::{require_line, require_lines, require_point, set_letters};
use super::question::Question;
use super::session::{CommandReply, SketchSession};
use super::subject::{ReplySubject, all_missing};
use super::words::{Command, CommandTokenKind, UNITS};
use crate::dimension::layout::{REFERENCE_NAME, agree};
use crate::{
    CoordinateAxis, Dimension, DimensionExpr, DimensionFault, DimensionRole, MeasuredQuantity,
    Naming, PointId, Reference, SketchObject, Variable, chain, chain_text,
};
use moldloft_syntax::number::plain;
use std::sync::Arc;

impl SketchSession {
    pub(super) fn dimension(&mut self, args: &mut Args) -> Result<(), CommandError> {
        const KINDS: [&str; 4] = ["LENGTH", "SLOPE", "ANGLE", "EQUAL"];
        let kind = |a: &Args| KINDS.into_iter().find(|k| a.at(k));
        let axis_next = args.peek().is_some_and(|t| CoordinateAxis::of(&t.text).is_some());
        let named = !args.at_number() && !axis_next && kind(args).is_none();
        let name = if named { Some(self.new_name(args)?) } else { None };
        let object = self.active()?.clone();
        let name = name.unwrap_or_else(|| object.fresh_name("D"));
        if let Some(kind) = kind(args) {
            return self.derived(args, name, kind);
        }
        let axis = args.axis();
        let (p, q) = (args.point()?, {
            args.take_short("TO");
            args.point()?
        });
        require_point(&object, p)?;
        require_point(&object, q)?;
        let axis = match axis.or_else(|| {
            let line = object.drawing.line_between(p, q)?;
            object.drawing.lines[&line].free?.single()
        }) {
            Some(axis) => axis,
            None => {
                return Err(CommandError::new(
                    105,
                    format!(
                        "points {p} and {q} are not on a principal line, so the axis is unknown"
                    ),
                    format!("DIMENSION X {p} {q}, or Y, or Z"),
                )
                .about(ReplySubject::of("unknown-axis").points([p, q])));
            }
        };
        if object.drawing.lines.is_empty() {
            return Err(CommandError::new(
                398,
                format!("there are no planes on axis {axis}: no line fixes any point there"),
                "draw lines first",
            )
            .about(ReplySubject::of("no-planes").axis(axis)));
        }
        let at_value = args.len() > 0
            && !args.at("REVERSED")
            && !args.at("FORWARD")
            && !args.tokens_at(0, "IN");
        if !at_value {
            args.end()?;
            return self.suggest(&object, name, axis, (p, q));
        }
        let value = args.value(object.units.as_deref())?;
        // The direction as typed: FORWARD confirms it, REVERSED inverts it.
        args.take("FORWARD");
        let turned = args.take("REVERSED");
        let range = args.range()?;
        args.end()?;
        let (p, q) = if turned { (q, p) } else { (p, q) };
        self.warn_of_picture(&object, &name, axis, (p, q), &value);
        self.add_along(name, axis, p, q, value, range)
    }

    /// Adds a dimension along an axis, or says why not (396).
    pub(super) fn add_along(
        &mut self,
        name: String,
        axis: CoordinateAxis,
        p: PointId,
        q: PointId,
        value: DimensionExpr,
        range: Option<[f64; 2]>,
    ) -> Result<(), CommandError> {
        let object = self.active()?.clone();
        let (view, layout) = self.laid_out(&object);
        let planes = &view.planes;
        let number = value.eval(&|n| self.known_number(&object, &layout, n));
        if planes.same(axis, p, q) {
            let zero = number.as_ref().is_ok_and(|x| *x == 0.0);
            if zero {
                self.out.push(CommandReply::note(format!(
                    "points {p} and {q} are in one {axis} plane already"
                )));
                return Ok(());
            }
            let path = crate::why(&object.drawing, axis, p, q).unwrap_or_default();
            let path: Vec<String> = path.iter().map(|r| r.text(&object.drawing)).collect();
            return Err(CommandError::new(
                396,
                format!("points {p} and {q} are in one {axis} plane, by {}", path.join(", ")),
                "dimension two different planes, or retype a line of the path",
            )
            .about(ReplySubject::of("one-plane").points([p, q]).axis(axis)));
        }
        let mut role = DimensionRole::Driving;
        if let Some((way, names)) = chain(&object, planes, axis, p, q) {
            let ends = (layout.coordinate(planes, axis, p), layout.coordinate(planes, axis, q));
            let measured = match ends {
                (Some(a), Some(b)) => Some(b - a),
                _ => along(&object, &layout.values, axis, &way, &names),
            };
            let asked = number.ok();
            match (measured, asked) {
                (Some(m), Some(a)) if agree(m, a) => {
                    role = DimensionRole::Reference;
                    let text = format!(
                        "396: determined already via {}; it agrees and is kept as a reference",
                        chain_text(&way)
                    );
                    self.out.push(CommandReply::note(text));
                }
                (Some(m), Some(a)) => {
                    let text = format!(
                        "planes {} apart already via {}; the requested {} differs by {}",
                        plain(m),
                        chain_text(&way),
                        plain(a),
                        plain((a - m).abs())
                    );
                    return Err(CommandError::new(
                        396,
                        text,
                        format!("change or delete one of {}", names.join(", ")),
                    )
                    .about(
                        ReplySubject::of("determined-already")
                            .points([p, q])
                            .axis(axis)
                            .names(&names)
                            .value(m),
                    ));
                }
                _ => {
                    let text = format!("the chain {} determines it already", chain_text(&way));
                    return Err(CommandError::new(
                        396,
                        text,
                        format!("give values to {}", names.join(", ")),
                    )
                    .about(
                        ReplySubject::of("determined-already")
                            .points([p, q])
                            .axis(axis)
                            .names(&names),
                    ));
                }
            }
        }
        let measure = MeasuredQuantity::Along { axis, p, q };
        let object = self.active_mut()?;
        object.add_dimension(Dimension { name, measure, value: Some(value), role, range });
        self.report_counts()
    }

    fn derived(&mut self, args: &mut Args, name: String, kind: &str) -> Result<(), CommandError> {
        args.skip();
        let first = args.line()?;
        let object = self.active()?.clone();
        require_line(&object, first)?;
        let second = matches!(kind, "ANGLE" | "EQUAL").then(|| args.line()).transpose()?;
        if let Some(second) = second {
            require_line(&object, second)?;
            if second == first {
                return Err(CommandError::new(
                    300,
                    format!("line {first} twice"),
                    "name two lines",
                )
                .about(ReplySubject::of("line-twice").lines([first])));
            }
        }
        let measure = match (kind, second) {
            ("LENGTH", _) => MeasuredQuantity::Length(first),
            ("SLOPE", _) => MeasuredQuantity::Slope(first),
            ("ANGLE", Some(second)) => MeasuredQuantity::Angle(first, second),
            (_, Some(second)) => MeasuredQuantity::Equal(first, second),
            _ => return Err(args.wants("a second line")),
        };
        if kind != "EQUAL" && args.len() == 0 {
            return self.measured(&object, name, measure);
        }
        let value = if kind == "EQUAL" && (args.len() == 0 || args.tokens_at(0, "IN")) {
            DimensionExpr::number(1.0)
        } else {
            args.value(object.units.as_deref())?
        };
        let range = args.range()?;
        args.end()?;
        let before = self.laid_out(&object).1.faults;
        let mut role = DimensionRole::Driving;
        let mut tried = object;
        let dimension = Dimension { name: name.clone(), measure, value: Some(value), role, range };
        tried.add_dimension(dimension.clone());
        for fault in self.laid_out(&tried).1.faults {
            match &fault {
                DimensionFault::Redundant { name: n, .. } if *n == name => {
                    role = DimensionRole::Reference;
                    self.out.push(CommandReply::note(
                        "396: determined already; it agrees and is kept as a reference",
                    ));
                }
                _ if before.contains(&fault) => {}
                _ => return Err(dimension_fault(&fault)),
            }
        }
        self.active_mut()?.add_dimension(Dimension { role, ..dimension });
        self.report_counts()
    }

    /// A derived dimension without a value: it shows the result of the others.
    fn measured(
        &mut self,
        object: &SketchObject,
        name: String,
        measure: MeasuredQuantity,
    ) -> Result<(), CommandError> {
        let (view, layout) = self.laid_out(object);
        let Some(x) = layout.measured(object, &view.planes, &measure) else {
            return Err(CommandError::new(
                404,
                format!("{name} cannot be measured yet: its points are not determined"),
                "give it a value, or the missing dimensions; CHECK lists them",
            )
            .about(ReplySubject::of("undetermined-points").names([&name])));
        };
        self.out.push(CommandReply::note(format!("{name} measures {}", plain(x))));
        let dimension =
            Dimension { name, measure, value: None, role: DimensionRole::Reference, range: None };
        self.active_mut()?.add_dimension(dimension);
        Ok(())
    }

    /// True if a command is the value for an open question: a number, an expression in quotes, or the name of a
    /// number alone.
    pub(super) fn is_value(&self, command: &Command) -> bool {
        let first = &command.tokens[0];
        let asked = matches!(self.question, Some(Question::Dimension { .. }));
        asked
            && match first.kind {
                CommandTokenKind::Number(..) | CommandTokenKind::Text => true,
                CommandTokenKind::Word => {
                    command.tokens.len() == 1
                        && super::verbs::row(&first.text.to_ascii_uppercase()).is_none()
                        && self.names_number(&first.text)
                }
            }
    }

    /// True if a word is a number of the active object, or of another one as `object.number`.
    fn names_number(&self, word: &str) -> bool {
        let own = self.active_object().is_some_and(|o| o.has_number(word));
        let other = || {
            let (of, number) = word.split_once('.')?;
            Some(self.state.called(&of.to_ascii_lowercase())?.has_number(number))
        };
        own || other() == Some(true)
    }

    /// Takes the value that answers a question.
    pub(super) fn answer_value(&mut self, command: &Command) -> Result<(), CommandError> {
        let units = self.active()?.units.clone();
        let args = &mut Args::new(&command.tokens, "the value, or YES or NO");
        let value = args.value(units.as_deref())?;
        let range = args.range()?;
        args.end()?;
        let Some(Question::Dimension { name, axis, p, q, .. }) = self.question.take() else {
            return Err(args.wants("a question"));
        };
        self.add_along(name, axis, p, q, value, range)
    }

    /// Asks whether the estimated value is right (a dimension without a value).
    fn suggest(
        &mut self,
        object: &SketchObject,
        name: String,
        axis: CoordinateAxis,
        (p, q): (PointId, PointId),
    ) -> Result<(), CommandError> {
        let (view, layout) = self.laid_out(object);
        let determined = MeasuredQuantity::Along { axis, p, q };
        if let Some(x) = layout.measured(object, &view.planes, &determined) {
            self.out.push(CommandReply::note(format!(
                "{axis} from {p} to {q} is determined already: {}",
                plain(x)
            )));
            return Ok(());
        }
        let (Some(e), Some(a), Some(b)) =
            (view.estimate(), view.planes.plane(axis, p), view.planes.plane(axis, q))
        else {
            return Err(CommandError::text("there is no estimate of this sketch", "give a value"));
        };
        let scale = crate::scale(object, &view.planes, &layout, e);
        let value = rounded((e.plane(axis, b) - e.plane(axis, a)) * scale);
        let mut text = format!("{name}: {axis} from {p} to {q} is about {}", plain(value));
        if !e.determines(axis, a, b) {
            text.push_str("; the picture leaves this depth open");
        }
        let mut reply = CommandReply::note(text);
        reply.next = Some("YES takes it; or give the value".to_owned());
        reply.about = ReplySubject::of("suggested-value")
            .points([p, q])
            .axis(axis)
            .names([&name])
            .value(value);
        self.out.push(reply);
        self.question = Some(Question::Dimension { name, axis, p, q, value });
        Ok(())
    }

    /// Warns if the picture shows the points of a dimension in the opposite order, unless the
    /// picture leaves the depth open.
    fn warn_of_picture(
        &mut self,
        object: &SketchObject,
        name: &str,
        axis: CoordinateAxis,
        (p, q): (PointId, PointId),
        value: &DimensionExpr,
    ) {
        /// Smaller gaps, as a part of the drawing, say nothing.
        const CLEAR: f64 = 0.02;
        let (view, layout) = self.laid_out(object);
        let Ok(asked) = value.eval(&|n| self.known_number(object, &layout, n)) else { return };
        let planes = &view.planes;
        let (Some(e), Some(a), Some(b)) =
            (view.estimate(), planes.plane(axis, p), planes.plane(axis, q))
        else {
            return;
        };
        let gap = e.plane(axis, b) - e.plane(axis, a);
        if e.determines(axis, a, b) && gap.abs() > CLEAR * e.extent() && gap * asked < 0.0 {
            let mut reply = CommandReply::warning(format!(
                "{name}: the picture shows {q} on the other side of {p} along {axis}; it is taken as typed"
            ));
            reply.next = Some(format!("REVERSE {name} if the picture is right"));
            self.out.push(reply);
        }
    }

    /// A name that is free for a dimension, variable or curve.
    pub(super) fn new_name(&mut self, args: &mut Args) -> Result<String, CommandError> {
        let name = args.name("a name")?;
        let object = self.active()?;
        let fine = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '.')
            && name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.len() <= 64
            && !name.ends_with('.');
        if !fine {
            return Err(CommandError::text(
                format!("`{name}` cannot be read in expressions"),
                "use a letter, then letters, digits, `_` and `.`",
            )
            .about(ReplySubject::of("name-not-free").names([&name])));
        }
        // Other functions are known by their brackets.
        if crate::FUNCTIONS[..10].contains(&name.to_ascii_lowercase().as_str())
            || name.eq_ignore_ascii_case("pi")
        {
            return Err(CommandError::text(
                format!("{name} means something in expressions"),
                "choose another name",
            )
            .about(ReplySubject::of("name-not-free").names([&name])));
        }
        if object.has_name(&name) {
            return Err(CommandError::text(
                format!("{name} exists already"),
                format!("SET {name} changes its value; or choose another name"),
            )
            .about(ReplySubject::of("name-not-free").names([&name])));
        }
        Ok(name)
    }

    /// `X 2/3 Y 1/1 Z 0/2`.
    pub(super) fn report_counts(&mut self) -> Result<(), CommandError> {
        let object = self.active_arc()?;
        let worked = self.worked(&object);
        let layout = &worked.layout;
        let part = |a: CoordinateAxis| {
            let c = layout.counts[a.index()];
            format!("{a} {}/{}", c.given, c.required)
        };
        let mut text = CoordinateAxis::ALL.map(part).join(" ");
        if layout.complete() && !object.drawing.points.is_empty() {
            text.push_str(": complete");
        }
        self.out.push(CommandReply::note(text));
        Ok(())
    }

    pub(super) fn set(&mut self, args: &mut Args) -> Result<(), CommandError> {
        if args.at("POINT") && args.number_at(1) {
            args.skip();
            let p = args.point()?;
            let axis = args.axis().ok_or_else(|| args.wants("an axis"))?;
            let object = self.active()?.clone();
            require_point(&object, p)?;
            let value = args.value(object.units.as_deref())?;
            args.end()?;
            let measure = MeasuredQuantity::Datum { axis, point: p };
            let old =
                object.dimensions.iter().find(|d| d.1.measure == measure).map(|d| d.0.clone());
            let name = match old {
                Some(key) => object.dimensions[&key].name.clone(),
                None => object.fresh_name("P"),
            };
            return self.put(Dimension {
                name,
                measure,
                value: Some(value),
                role: DimensionRole::Driving,
                range: None,
            });
        }
        let certainty = args.tokens_at(0, "CERTAINTY") && args.number_at(1);
        if certainty && !self.active()?.has_name("CERTAINTY") {
            args.skip();
            let certainty = args.number("a probability from 0 to 1")?;
            args.end()?;
            if !(0.0..=1.0).contains(&certainty) {
                let text = format!("a probability is from 0 to 1, not {}", plain(certainty));
                return Err(CommandError::text(text, "SET CERTAINTY 0.9"));
            }
            self.active_mut()?.draw().certainty = certainty;
            return Ok(());
        }
        if args.take_short("UP") {
            let axis = args.axis().ok_or_else(|| args.wants("an axis"))?;
            args.end()?;
            set_letters(self.active_mut()?.draw(), Some(axis), None);
            return Ok(());
        }
        if args.at("NAMES") && (args.tokens_at(1, "SEED") || args.tokens_at(1, "STANDARD")) {
            let naming = if args.tokens_at(1, "SEED") { Naming::Seed } else { Naming::Standard };
            args.skip();
            args.skip();
            args.end()?;
            set_letters(self.active_mut()?.draw(), None, Some(naming));
            return Ok(());
        }
        if args.take("UNITS") {
            let unit = args.name("MM, CM, M, IN or FT")?.to_ascii_uppercase();
            let convert = args.take("CONVERT");
            args.end()?;
            if !UNITS.iter().any(|u| u.0 == unit) {
                return Err(CommandError::text(
                    format!("there is no unit {unit}"),
                    "units are MM, CM, M, IN, FT",
                ));
            }
            let object = self.active()?;
            let followers = self.followers(&object.name);
            if convert && object.units.as_ref().is_some_and(|u| *u != unit) && !followers.is_empty()
            {
                return Err(CommandError::text(
                    format!("{} made of {}", followers.join(", "), object.name),
                    "convert it before others are made of it",
                )
                .about(ReplySubject::of("made-of-others").names(&followers)));
            }
            let size = |name: &str| UNITS.iter().find(|u| u.0 == name).map(|u| u.1);
            let old = object.units.clone().filter(|u| *u != unit);
            let own = !object.dimensions.is_empty() || !object.variables.is_empty();
            let given = own || object.feature.is_some();
            match old {
                // Lengths are not relabelled: they are converted on request, otherwise refused.
                Some(old) if given && !convert => {
                    return Err(CommandError::text(
                        format!("the numbers of {} are in {old}", object.name),
                        format!("SET UNITS {unit} CONVERT converts them"),
                    )
                    .about(ReplySubject::of("other-unit").names([&object.name])));
                }
                Some(old) if given => {
                    if object.feature.is_some() {
                        return Err(CommandError::text(
                            format!("{} is made of others", object.name),
                            "convert its parts before they are combined",
                        )
                        .about(ReplySubject::of("made-of-others").names([&object.name])));
                    }
                    let factor = size(&old).zip(size(&unit)).map_or(1.0, |(a, b)| a / b);
                    *self.active_mut()? = crate::merge::scaled(object, factor);
                }
                _ => {}
            }
            self.active_mut()?.units = Some(unit);
            return Ok(());
        }
        if args.at("EXACT") && (args.tokens_at(1, "ON") || args.tokens_at(1, "OFF")) {
            args.skip();
            let on = args.take_short("ON");
            args.take_short("OFF");
            args.end()?;
            return self.set_exact(on);
        }
        if args.take_short("SKETCH83") {
            let on = args.take_short("ON");
            if !on && !args.take_short("OFF") {
                return Err(args.wants("ON or OFF"));
            }
            args.end()?;
            self.state.sketch83 = on;
            return Ok(());
        }
        let name = args.name("the name of a dimension or variable, or a setting")?;
        self.active()?;
        // A number of another object, as expressions name it, or one that the active object follows.
        if let Some((of, number)) = self.followed_number(&name) {
            let active = self.state.active.replace(of);
            let done = self.set_number(&number, args);
            self.state.active = active;
            return done;
        }
        self.set_number(&name, args)
    }

    /// Sets whether points on the page of a section are taken as its coordinates.
    pub(super) fn set_exact(&mut self, on: bool) -> Result<(), CommandError> {
        let drawing = &self.active()?.drawing;
        let plain =
            drawing.section.is_some_and(|s| drawing.projection == crate::Projection::section(s));
        if on && !plain {
            return Err(CommandError::new(
                113,
                "only a cross section with its own axes is exact as it is drawn",
                "SKETCH name 2D starts one",
            ));
        }
        let drawing = self.active_mut()?.draw();
        drawing.exact = on;
        let by_slope = |l: &crate::DrawnLine| l.source == crate::LineTypeSource::Auto;
        let lines: Vec<_> =
            drawing.lines.iter().filter(|(_, l)| by_slope(l)).map(|(id, _)| *id).collect();
        lines.into_iter().for_each(|id| drawing.type_by_slope(id));
        Ok(())
    }

    /// Gives a dimension or variable of the active object another value.
    fn set_number(&mut self, name: &str, args: &mut Args) -> Result<(), CommandError> {
        let object = self.active()?.clone();
        let key = name.to_ascii_lowercase();
        let value = args.value(object.units.as_deref())?;
        let range = args.range()?;
        args.end()?;
        if let Some(old) = object.dimensions.get(&key) {
            let range = range.or(old.range);
            return self.put(Dimension {
                value: Some(value),
                range,
                role: DimensionRole::Driving,
                ..old.clone()
            });
        }
        if let Some(old) = object.variables.get(&key) {
            let new = Variable { value, range: range.or(old.range), ..old.clone() };
            return self.put_variable(new);
        }
        let names = object.dimensions.values().map(|d| d.name.as_str());
        let names = names.chain(object.variables.values().map(|v| v.name.as_str()));
        let next = match moldloft_diag::nearest(name, names) {
            Some(near) => format!("did you mean {near}?"),
            None => "LIST DIMENSIONS and LIST VARIABLES list them".to_owned(),
        };
        Err(CommandError::text(format!("unknown dimension or variable {name}"), next)
            .about(ReplySubject::of("unknown-name").names([&name.to_string()])))
    }

    /// Changes or adds a dimension, unless that makes a new fault.
    fn put(&mut self, dimension: Dimension) -> Result<(), CommandError> {
        in_range(&dimension.name, dimension.value.as_ref(), dimension.range)?;
        let old = self.active_arc()?;
        let before = self.worked(&old);
        let name = dimension.name.clone();
        let mut object = SketchObject::clone(&old);
        object.add_dimension(dimension);
        let mut object = Arc::new(object);
        let tried = self.worked(&object);
        for fault in &tried.layout.faults {
            match fault {
                DimensionFault::Redundant { name: n, .. } if *n == name => {
                    let object = Arc::make_mut(&mut object);
                    if let Some(d) = object.dimensions.get_mut(&name.to_ascii_lowercase()) {
                        d.role = DimensionRole::Reference;
                    }
                    self.out.push(CommandReply::note(format!(
                        "396: {name} is determined already; it agrees and is a reference"
                    )));
                }
                _ if before.layout.faults.contains(fault) => {}
                _ => return Err(dimension_fault(fault)),
            }
        }
        self.replace_active(object);
        self.report_counts()?;
        self.report_validity()
    }

    fn put_variable(&mut self, variable: Variable) -> Result<(), CommandError> {
        in_range(&variable.name, Some(&variable.value), variable.range)?;
        let old = self.active_arc()?;
        let before = self.worked(&old);
        let mut object = SketchObject::clone(&old);
        object.variables.insert(variable.name.to_ascii_lowercase(), variable);
        let object = Arc::new(object);
        let tried = self.worked(&object);
        let mut faults = tried.layout.faults.iter();
        if let Some(fault) = faults.find(|f| !before.layout.faults.contains(f)) {
            return Err(dimension_fault(fault));
        }
        self.replace_active(object);
        self.report_validity()
    }

    pub(super) fn variable(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let name = self.new_name(args)?;
        let units = self.active()?.units.clone();
        let value = args.value(units.as_deref())?;
        let range = args.range()?;
        args.end()?;
        self.put_variable(Variable { name, value, range })
    }

    pub(super) fn unset(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let name = args.name("the name of a dimension")?;
        args.end()?;
        let object = self.active_mut()?;
        match object.dimensions.get_mut(&name.to_ascii_lowercase()) {
            Some(d) => d.value = None,
            None => {
                return Err(CommandError::text(
                    format!("there is no dimension {name}"),
                    "LIST DIMENSIONS lists them",
                )
                .about(ReplySubject::of("unknown-name").names([&name])));
            }
        }
        self.report_counts()
    }

    pub(super) fn reference(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let placed = self.reference_at(args)?;
        let object = self.active()?.clone();
        let object = SketchObject { reference: Some(placed), ..object };
        let own = |fault: &DimensionFault| match fault {
            DimensionFault::NoValue { name, .. } | DimensionFault::NotFinite { name } => {
                name == REFERENCE_NAME
            }
            _ => false,
        };
        let mut faults = self.laid_out(&object).1.faults.into_iter();
        if let Some(fault) = faults.find(own) {
            return Err(dimension_fault(&fault));
        }
        self.replace_active(Arc::new(object));
        Ok(())
    }

    /// A point and its coordinates; in a section those of its plane are enough.
    pub(super) fn reference_at(&mut self, args: &mut Args) -> Result<Reference, CommandError> {
        let point = args.point()?;
        let object = self.active()?;
        require_point(object, point)?;
        let mut given = Vec::new();
        while args.len() > 0 && given.len() < 3 {
            given.push(args.value(object.units.as_deref())?);
        }
        args.end()?;
        let mut placed = object.reference().unwrap_or_else(|| Reference::number(point, [0.0; 3]));
        placed.point = point;
        match (object.drawing.section, given.len()) {
            (_, 3) => placed.at.iter_mut().zip(given).for_each(|(own, x)| *own = x),
            (Some(normal), 2) => {
                normal.others().into_iter().zip(given).for_each(|(a, x)| placed.at[a.index()] = x);
            }
            _ => return Err(args.wants("three coordinates")),
        }
        Ok(placed)
    }

    pub(super) fn reverse(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let name = args.name("the name of a dimension")?;
        args.end()?;
        let object = self.active_mut()?;
        let dimension = object.dimensions.get_mut(&name.to_ascii_lowercase());
        let Some(Dimension { measure: MeasuredQuantity::Along { p, q, .. }, .. }) = dimension
        else {
            return Err(CommandError::text(
                format!("there is no dimension {name} along an axis"),
                "LIST DIMENSIONS lists them",
            )
            .about(ReplySubject::of("unknown-name").names([&name])));
        };
        std::mem::swap(p, q);
        self.report_validity()
    }

    pub(super) fn convert(&mut self, args: &mut Args) -> Result<(), CommandError> {
        self.take_object(args)?;
        args.end()?;
        let object = self.active()?.clone();
        require_lines(&object)?;
        let (view, layout) = self.laid_out(&object);
        if let Some(fault) = self.first_type_fault(&object, &view.planes) {
            return Err(fault);
        }
        if let Some(fault) =
            layout.faults.iter().find(|f| !matches!(f, DimensionFault::Redundant { .. }))
        {
            return Err(dimension_fault(fault));
        }
        if !layout.complete() {
            let missing =
                CoordinateAxis::ALL.map(|a| format!("{a}: {}", layout.counts[a.index()].missing));
            let lines = self.loose_lines(&object, &view, &layout);
            let list: Vec<&str> = lines.iter().map(|l| l.0.as_str()).collect();
            let text =
                format!("dimensions are missing, {}; {}", missing.join(", "), list.join("; "));
            let next = "give them, or see ESTIMATE for suggested values".to_owned();
            return Err(CommandError::new(404, text, next).about(all_missing(lines)));
        }
        self.out.push(CommandReply::note(format!(
            "{}: {} points are exact",
            object.name,
            view.planes.ids().len()
        )));
        self.report_validity()
    }
}

/// The length of a chain of dimensions that is not connected to the reference.
fn along(
    object: &SketchObject,
    values: &std::collections::BTreeMap<String, f64>,
    axis: CoordinateAxis,
    way: &[PointId],
    names: &[String],
) -> Option<f64> {
    let planes = crate::Planes::of(&object.drawing);
    let mut at = planes.plane(axis, *way.first()?)?;
    let mut sum = 0.0;
    for name in names {
        let d = object.dimensions.get(&name.to_ascii_lowercase())?;
        let MeasuredQuantity::Along { p, q, .. } = d.measure else { return None };
        let (a, b) = (planes.plane(axis, p)?, planes.plane(axis, q)?);
        let value = values.get(&name.to_ascii_lowercase())?;
        (sum, at) = if at == a { (sum + value, b) } else { (sum - value, a) };
    }
    Some(sum)
}

/// Refuses a plain number outside its range.
fn in_range(
    name: &str,
    value: Option<&DimensionExpr>,
    range: Option<[f64; 2]>,
) -> Result<(), CommandError> {
    match (value.and_then(DimensionExpr::literal), range) {
        (Some(x), Some([low, high])) if !(low..=high).contains(&x) => {
            let (low, high) = (plain(low), plain(high));
            Err(CommandError::text(
                format!("{name} = {} is outside its range, {low} to {high}", plain(x)),
                format!("give a number in it, or another range: SET {name} {} IN lo hi", plain(x)),
            )
            .about(ReplySubject::of("out-of-range").names([&name.to_owned()]).value(x)))
        }
        _ => Ok(()),
    }
}

pub(super) fn dimension_fault(fault: &DimensionFault) -> CommandError {
    let (kind, names, value): (_, Vec<&String>, _) = match fault {
        DimensionFault::Redundant { name, path } => {
            ("redundant-dimension", std::iter::once(name).chain(path).collect(), None)
        }
        DimensionFault::Contradictory { name, asked, measured, path } => {
            let names = std::iter::once(name).chain(path).collect();
            ("contradictory-dimension", names, Some(asked - measured))
        }
        DimensionFault::NoValue { name, reads } => ("no-value", vec![name, reads], None),
        DimensionFault::Cycle { names } => ("circular-dimensions", names.iter().collect(), None),
        DimensionFault::NotFinite { name } => ("not-finite", vec![name], None),
        DimensionFault::OutOfRange { name, value, .. } => {
            ("out-of-range", vec![name], Some(*value))
        }
        DimensionFault::Unsolved { name, residual } => ("unsolved", vec![name], Some(*residual)),
    };
    let about = ReplySubject::of(kind).names(names).value(value);
    let error = match fault {
        DimensionFault::Redundant { name, path } => CommandError::new(
            396,
            format!("{name} is determined already by {}; it agrees", path.join(", ")),
            "delete it, or keep it as a reference",
        ),
        DimensionFault::Contradictory { name, asked, measured, path } => CommandError::new(
            396,
            format!(
                "{name} asks {}, but the others make it {}, which differs by {}, via {}",
                plain(*asked),
                plain(*measured),
                plain((asked - measured).abs()),
                if path.is_empty() { "known points".to_owned() } else { path.join(", ") }
            ),
            "change or delete one of them",
        ),
        DimensionFault::NoValue { name, reads } => CommandError::text(
            format!("{name} reads {reads}, which has no value"),
            format!("VARIABLE {reads} defines it"),
        ),
        DimensionFault::Cycle { names } => CommandError::text(
            format!("{} depend on each other in a circle", names.join(", ")),
            "give one of them a number",
        ),
        DimensionFault::NotFinite { name } => CommandError::new(
            300,
            format!("the value of {name} is not a finite number"),
            "look for a division by zero",
        ),
        DimensionFault::OutOfRange { name, value, range: [low, high] } => CommandError::text(
            format!(
                "{name} = {} is outside its range, {} to {}",
                plain(*value),
                plain(*low),
                plain(*high)
            ),
            format!("give a number in it, or another range: SET {name} {} IN lo hi", plain(*value)),
        ),
        DimensionFault::Unsolved { name, residual } => CommandError::new(
            411,
            format!(
                "{name} cannot be satisfied on the side that is drawn; the drawing misses it by {}",
                plain(rounded(*residual))
            ),
            "change it or the dimensions around it",
        ),
    };
    error.about(about)
}
