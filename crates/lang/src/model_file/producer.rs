//! The objects of a model file, made in a run of the graph: arguments, numbers, and reasons of
//! missing objects.

use crate::model_file::names::is_real;
use crate::model_file::names::system_name;
use crate::model_file::source::{ModelFileSource, Outcome, RootCause, Sorted, Trouble, wrong};
use crate::run::interpreter::Inputs;
use crate::run::program::RunContext;
use crate::run::tables;
use crate::source::env::Environment;
use crate::source::fault_location;
use crate::value::number_path;
use moldloft_diag::{Diagnostic, Span};
use moldloft_model::{Declaration, Run};
use moldloft_num::Vec3;
use moldloft_registry::{
    CallError, Class, FieldSpec, Given, Registry, Role, Row, Scalar, Unit, Value, bind_arguments,
};
use moldloft_syntax::model_file::{EntryField as Written, FieldKind, Fields, ObjectEntry as Line};
use std::collections::HashMap;

/// Makes the objects of an [`moldloft_model::Extent::Whole`] application.
pub struct Producer<'a, 'g, T: Scalar> {
    /// The parsed file.
    pub source: &'a ModelFileSource,
    /// The rows of all kinds.
    pub registry: &'a Registry,
    /// The program that loads the file, with its host.
    pub host: RunContext<'a>,
    /// The environment after the run.
    pub env: &'a mut Environment<T>,
    /// The numbers of variables and formulas, by their index in the file.
    pub reals: HashMap<usize, T>,
    /// Values of parameters and literals for this run.
    pub inputs: Inputs<'a, T>,
    /// The run of the graph that receives the declarations.
    pub run: &'a mut Run<'g, T>,
    /// Results, by the index of the object in the file.
    pub outcomes: Vec<Option<Outcome>>,
    pub(super) roots: Vec<RootCause>,
    /// Number of searches for the nearest name, which are slow in large models.
    pub(super) suggestions: usize,
}

impl<T: Scalar> Producer<'_, '_, T> {
    pub(super) fn root(&mut self, diagnostics: Vec<Diagnostic>) -> Outcome {
        self.roots.push(RootCause { diagnostics, blocked: Vec::new(), first_use: None });
        Outcome::Missing(self.roots.len() - 1)
    }

    pub(super) fn report_cycle(&mut self, cycle: &[usize]) {
        let source = self.source;
        let name = |at: usize| source.model.slice(source.lines[at].name);
        let round = cycle.iter().chain(cycle.first()).map(|&at| name(at));
        // A long cycle is identified by its ends.
        let mut shown: Vec<&str> = round.collect();
        let left_out = shown.len().saturating_sub(1000);
        let text = if left_out > 0 {
            let tail = shown.split_off(shown.len() - 500);
            shown.truncate(500);
            format!("{} -> ({left_out} more) -> {}", shown.join(" -> "), tail.join(" -> "))
        } else {
            shown.join(" -> ")
        };
        let first = source.lines[cycle[0]].name;
        let message = format!("`{}` depends on itself", name(cycle[0]));
        let mut diagnostic = Diagnostic::error("cycle", message)
            .at(first)
            .expected("objects built on others that are not built on them")
            .found(text)
            .object(name(cycle[0]));
        for &at in cycle[1..].iter().take(5) {
            diagnostic = diagnostic.note_at(source.lines[at].name, "part of the cycle");
        }
        let missing = self.root(vec![diagnostic]);
        for &at in cycle {
            self.outcomes[at] = Some(missing);
        }
    }

    pub(super) fn object(&mut self, at: usize, sorted: &Sorted) {
        let source = self.source;
        let line = &source.lines[at];
        let name = source.model.slice(line.name);
        if !line.complete || source.names.get(name) != Some(&at) {
            // Reported when the text was read.
            self.outcomes[at] = Some(self.root(Vec::new()));
            return;
        }
        let Some(row) = &sorted.row else {
            let entity = source.model.slice(line.entity);
            if is_real(entity) {
                self.outcomes[at] = Some(match self.real(line, sorted) {
                    Ok(value) => {
                        self.reals.insert(at, value);
                        self.env.numbers.insert(name.to_string(), value);
                        Outcome::Real
                    }
                    Err(Trouble::Wrong(diagnostic)) => self.root(vec![diagnostic.object(name)]),
                    Err(Trouble::Blocked { root, span }) => {
                        let first = &mut self.roots[root];
                        first.blocked.push(name.to_string());
                        first.first_use.get_or_insert_with(|| (span, name.to_string()));
                        Outcome::Missing(root)
                    }
                });
                return;
            }
            let kinds = self.registry.rows().filter(|r| r.kind && r.columns.is_some());
            let diagnostic =
                Diagnostic::warning("unknown-entity", format!("unknown entity `{entity}`"))
                    .at(line.entity)
                    .suggest(entity, kinds.map(|r| &*r.name))
                    .note(format!("`{name}` is kept unchanged, but not built"))
                    .object(name);
            self.outcomes[at] = Some(self.root(vec![diagnostic]));
            return;
        };
        let mut errors = Vec::new();
        let head = source.head(sorted, line, &mut errors);
        let mut warnings = Vec::new();
        if let Some(relabel) = &sorted.relabel {
            let message = format!("`{name}` is built without its relabel");
            warnings.push(
                Diagnostic::warning("unsupported-relabel", message)
                    .at(relabel.span)
                    .expected("`*`, the parameter as it is")
                    .found(format!("`{}`", source.written(relabel)))
                    .object(name),
            );
        }
        let (args, blocked) = self.arguments(row, line, sorted, &mut errors);
        if let (true, Some((root, span))) = (errors.is_empty(), blocked) {
            let root = &mut self.roots[root];
            root.blocked.push(name.to_string());
            root.first_use.get_or_insert_with(|| (span, name.to_string()));
            let missing = blocked.map(|(root, _)| Outcome::Missing(root));
            self.outcomes[at] = missing;
            return;
        }
        let arranged = if errors.is_empty() {
            let given = Given { positional: args, named: Vec::new() };
            bind_arguments(row, given, |key| self.run.class_of(key))
                .map_err(|fault| errors.push(self.misfit(line, sorted, &fault)))
                .ok()
        } else {
            None
        };
        let Some((mut args, _)) = arranged else {
            let named = errors.into_iter().map(|d| d.object(name)).collect();
            self.outcomes[at] = Some(self.root(named));
            return;
        };
        if row.role == Role::Table {
            let from = self.host.sources.name(source.model.file()).unwrap_or_default().to_string();
            let world = self.host.world;
            if let Err((field, fault)) = tables::fill(&self.env.files, world, &from, row, &mut args)
            {
                let place = source.place(sorted, field, None).unwrap_or(line.name);
                self.outcomes[at] = Some(self.root(vec![fault.or_at(place).object(name)]));
                return;
            }
        }
        if !self.inputs.seeded_objects.is_empty() && self.inputs.seeded_objects.contains(name) {
            number_path::seed(row, &mut args, name, self.inputs.seed);
        }
        let declaration = Declaration { name, row, args, head, origin: at as u32 };
        let outcome = match self.run.declare(declaration) {
            Ok(key) => {
                if !warnings.is_empty() {
                    self.root(warnings);
                }
                Outcome::Built(key)
            }
            Err(fault) => {
                self.root(vec![fault_location::unplaced(&fault).at(line.name).object(name)])
            }
        };
        self.outcomes[at] = Some(outcome);
    }

    /// The arguments in the order of the row's fields, or the root that one of them waits for.
    fn arguments(
        &mut self,
        row: &Row,
        line: &Line,
        sorted: &Sorted,
        errors: &mut Vec<Diagnostic>,
    ) -> (Vec<Value<T>>, Option<(usize, Span)>) {
        let mut blocked = None;
        let mut args = vec![Value::Unset; row.fields.len()];
        for (at, written) in &sorted.slots {
            match self.value(&row.fields[*at], written) {
                Ok(value) => args[*at] = value,
                Err(Trouble::Wrong(diagnostic)) => errors.push(*diagnostic),
                Err(Trouble::Blocked { root, span }) => blocked = blocked.or(Some((root, span))),
            }
        }
        // Columns are positional: after a missing one the next would get its meaning.
        let columns = row.columns.unwrap_or("").split_ascii_whitespace();
        let own = |at: &usize| row.fields[*at].name == "relabel" && row.class.dimension() > Some(0);
        let mut fields = columns.filter_map(|column| row.field(column)).filter(|at| !own(at));
        if let Some(missing) = fields.nth(sorted.in_columns)
            && errors.is_empty()
        {
            let end = Span::point(line.span.file, line.span.end.saturating_sub(1));
            let message = format!("{} needs `{}`", row.name, row.fields[missing].name);
            errors.push(
                Diagnostic::error("missing-field", message)
                    .at(end)
                    .expected(format!("data in the order {}", row.columns.unwrap_or("")))
                    .found(format!("{} fields of data", sorted.in_columns)),
            );
        }
        for argument in &sorted.unknown {
            let arguments =
                row.fields.iter().map(|field| field.name).collect::<Vec<_>>().join(", ");
            errors.push(
                Diagnostic::error("unknown-argument", format!("{} has no such argument", row.name))
                    .at(argument.span)
                    .expected(format!("one of {arguments}, with one value"))
                    .found(format!("`{}`", self.source.written(argument))),
            );
        }
        if let Some(extra) = &sorted.extra {
            errors.push(
                Diagnostic::error("too-many-fields", format!("{} has too many fields", row.name))
                    .at(extra.span)
                    .expected(format!("data in the order {}", row.columns.unwrap_or("")))
                    .found(format!("`{}`", self.source.written(extra))),
            );
        }
        (args, blocked)
    }

    /// The number of a variable or formula.
    /// The value of a column.
    fn value(&mut self, field: &FieldSpec, written: &Written) -> Result<Value<T>, Trouble> {
        if !field.many {
            return self.single(field, written);
        }
        match written.kind {
            FieldKind::List(items) => self.list(field, items),
            FieldKind::Star if field.default.is_some() => Ok(Value::Unset),
            _ => Err(wrong(
                Diagnostic::error("not-a-list", format!("`{}` must be a list", field.name))
                    .at(written.span)
                    .expected(format!("a list {{ ... }} of {}s", field.class.name()))
                    .found(format!("`{}`", self.source.written(written))),
            )),
        }
    }

    fn list(&mut self, field: &FieldSpec, items: Fields) -> Result<Value<T>, Trouble> {
        let source = self.source;
        let mut values = Vec::with_capacity(items.len());
        let mut trouble = None;
        for item in &source.model[items] {
            match self.single(field, item) {
                Ok(value) => values.push(value),
                Err(other @ Trouble::Wrong(_)) => return Err(other),
                Err(blocked) => trouble = trouble.or(Some(blocked)),
            }
        }
        trouble.map_or_else(|| Ok(Value::list(values)), Err)
    }

    fn single(&mut self, field: &FieldSpec, written: &Written) -> Result<Value<T>, Trouble> {
        let text = self.source.written(written);
        let unexpected = |id, message: String| {
            Diagnostic::error(id, message)
                .at(written.span)
                .expected(field.class.with_article())
                .found(format!("`{text}`"))
        };
        match written.kind {
            FieldKind::Number(id) => {
                let x = self.source.model[id].value;
                Ok(Value::Number(T::from(if field.unit == Unit::Angle {
                    x.to_radians()
                } else {
                    x
                })))
            }
            FieldKind::Text => Ok(Value::text(text.trim_matches('"'))),
            FieldKind::Word => self.word(field, written, text),
            FieldKind::Star if text == "*" => match field.default {
                Some(_) => Ok(Value::Unset),
                None => {
                    let message = format!("`{}` has no default", field.name);
                    Err(wrong(unexpected("missing-argument", message)))
                }
            },
            FieldKind::Star => match system_name(text) {
                Some(plane) if field.class.accepts(Class::Text) => Ok(Value::text(&plane)),
                Some(_) => Err(wrong(unexpected(
                    "wrong-class",
                    format!(
                        "`{}`: expected {}, found a plane",
                        field.name,
                        field.class.with_article()
                    ),
                ))),
                None => Err(wrong(
                    unexpected("unknown-object", format!("there is no `{text}`"))
                        .help("the system knows *X=0, *Y=0 and *Z=0"),
                )),
            },
            FieldKind::Formula if field.class.accepts(Class::Number) => {
                let x = self.formula(written)?;
                Ok(Value::Number(if field.unit == Unit::Angle { radians(x) } else { x }))
            }
            FieldKind::Formula => Err(wrong(unexpected(
                "wrong-class",
                format!(
                    "`{}`: expected {}, found a number",
                    field.name,
                    field.class.with_article()
                ),
            ))),
            FieldKind::List(items) => Ok(match self.list(field, items)? {
                // A point or vector by its numbers.
                Value::List(items) if items.len() == 3 => match [&items[0], &items[1], &items[2]] {
                    [Value::Number(x), Value::Number(y), Value::Number(z)] => {
                        Value::Vector(Vec3::new(*x, *y, *z))
                    }
                    _ => Value::List(items),
                },
                other => other,
            }),
            FieldKind::Tuple(_)
            | FieldKind::Pair(..)
            | FieldKind::Slash
            | FieldKind::Argument { .. }
            | FieldKind::Attribute { .. } => Err(wrong(unexpected(
                "wrong-field",
                format!("`{}` must be {}", field.name, field.class.with_article()),
            ))),
        }
    }

    fn word(
        &mut self,
        field: &FieldSpec,
        written: &Written,
        text: &str,
    ) -> Result<Value<T>, Trouble> {
        if field.class == Class::Text {
            return Ok(Value::text(text));
        }
        let source = self.source;
        if let Some(&at) = source.names.get(text) {
            return match self.outcomes[at] {
                Some(Outcome::Built(key)) => Ok(Value::Object(key)),
                Some(Outcome::Real) if field.class.accepts(Class::Number) => {
                    let x = self.reals[&at];
                    Ok(Value::Number(if field.unit == Unit::Angle { radians(x) } else { x }))
                }
                Some(Outcome::Real) => Err(wrong(
                    Diagnostic::error(
                        "wrong-class",
                        format!(
                            "`{}`: expected {}, found a number",
                            field.name,
                            field.class.with_article()
                        ),
                    )
                    .at(written.span)
                    .expected(field.class.with_article())
                    .found("a number")
                    .note_at(source.lines[at].name, format!("`{text}` is defined here")),
                )),
                Some(Outcome::Missing(root)) => Err(Trouble::Blocked { root, span: written.span }),
                None => unreachable!("parents come before their children"),
            };
        }
        if matches!(field.class, Class::Number | Class::Integer) {
            let message = format!("`{}` must be a number", field.name);
            return Err(wrong(
                Diagnostic::error("not-a-number", message)
                    .at(written.span)
                    .expected("a finite number")
                    .found(format!("`{text}`")),
            ));
        }
        if field.class == Class::Any {
            return Ok(Value::text(text));
        }
        let mut diagnostic =
            Diagnostic::error("unknown-object", format!("unknown object `{text}`"))
                .at(written.span)
                .expected(field.class.with_article());
        if self.suggestions < 20 {
            self.suggestions += 1;
            let names = source.lines.iter().map(|line| source.model.slice(line.name));
            diagnostic = diagnostic.suggest(text, names);
        }
        Err(wrong(diagnostic))
    }

    /// The diagnostic of arguments that do not fit.
    fn misfit(&self, line: &Line, sorted: &Sorted, fault: &CallError) -> Diagnostic {
        let source = self.source;
        let at = fault.field().and_then(|field| source.place(sorted, field, fault.item()));
        let mut diagnostic =
            fault_location::unplaced(fault).at(at.unwrap_or(line.entity.to(line.name)));
        if fault.id == "wrong-class"
            && let (Some(at), Some(row)) = (fault.field(), &sorted.row)
            && let Some(field) = row.fields.get(at)
        {
            diagnostic.message = format!("`{}`: {}", field.name, diagnostic.message);
        }
        let parent = at.and_then(|span| source.names.get(source.model.slice(span)));
        match parent {
            Some(&parent) if fault.id == "wrong-class" => {
                let name = source.lines[parent].name;
                let text = format!("`{}` is defined here", source.model.slice(name));
                diagnostic.note_at(name, text)
            }
            _ => diagnostic,
        }
    }
}

impl RootCause {
    pub(super) fn into_diagnostics(self) -> Vec<Diagnostic> {
        let RootCause { mut diagnostics, blocked, first_use } = self;
        let Some((span, name)) = first_use else { return diagnostics };
        let Some(first) = diagnostics.first_mut() else { return diagnostics };
        let shown = blocked.iter().take(5).map(String::as_str).collect::<Vec<_>>().join(", ");
        let more = match blocked.len().saturating_sub(5) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        if first.is_error() {
            *first = first.clone().note(format!("not built for want of it: {shown}{more}"));
            return diagnostics;
        }
        // The cause is only a warning, but dependent objects are missing.
        let cause = first.clone();
        let wanted = cause.object.as_deref().unwrap_or_default();
        diagnostics.push(
            Diagnostic::error("blocked", format!("`{name}` is built on `{wanted}`, which is not"))
                .at(span)
                .note_at(cause.span(), cause.message.clone())
                .note(format!("not built for want of it: {shown}{more}"))
                .object(name),
        );
        diagnostics
    }
}

fn radians<T: Scalar>(degrees: T) -> T {
    degrees * (std::f64::consts::PI / 180.0)
}
