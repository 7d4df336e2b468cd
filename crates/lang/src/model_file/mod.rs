//! A model file as a producer of objects.
//!
//! Every object is a call of the row that its entity word names; the row's `columns` say which field of the line is
//! which argument. Parents may stand below their children in the file: objects are declared so that they do not.

mod divisions;
mod formula;
pub mod header;
pub(crate) mod names;
mod panel_attributes;
pub mod text;
mod to_model_file;
mod to_program;
pub mod units;

pub use to_model_file::to_model_file;
pub use to_program::{prevents_conversion, quoted, to_program};

use crate::run::interpreter::{Inputs, Settings};
use crate::run::program::{NotLiteral, RunContext};
use crate::source::NoFiles;
use crate::source::env::{Environment, Evaluation};
use crate::source::fault_location;
use crate::source::module::Modules;
use crate::value::number_path::{self, NumberPath};
use divisions::{Part, divisions, is_pair};
use indexmap::IndexMap;
use moldloft_budget::Budget;
use moldloft_diag::{Diagnostic, FileId, Sources, Span};
use moldloft_model::{Applied, Declaration, Extent, Object, Run};
use moldloft_num::trace::Key;
use moldloft_registry::{
    Attributes, CallError, Class, FieldSpec, Given, Registry, Row, Scalar, Unit, Value,
    bind_arguments,
};
use moldloft_syntax::model_file::{
    self, EntryField as Written, FieldKind, Fields, ModelFile, NumberId, ObjectEntry as Line,
};
use names::{degrees, is_layer, is_real, our_word, system_name, words};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// More diagnostics of one run than this are counted, not listed.
const MOST_DIAGNOSTICS: usize = 100;

/// More cycles than this are not reported: their paths may be long.
const MOST_CYCLES: usize = 20;

/// A parsed model file and the places of its objects.
pub struct ModelFileSource {
    model: ModelFile,
    lines: Vec<Line>,
    /// The first object of each name, by its place in `lines`.
    pub names: HashMap<Box<str>, usize>,
}

/// A number of the file that an argument is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelNumber {
    id: NumberId,
    /// True when the file has degrees where the argument has radians.
    angle: bool,
}

/// The fields of an object, sorted by what they are for.
pub struct Sorted {
    /// The row of its entity; `None` when there is none that model files know.
    pub row: Option<Arc<Row>>,
    /// Colour, visibility and divisions.
    pub head: Vec<Written>,
    /// `A:Name(value)`.
    pub attributes: Vec<Written>,
    /// What stands in the column for a relabel, unless that is `*`.
    pub relabel: Option<Written>,
    /// Arguments, each with the number of its field in the row.
    pub slots: Vec<(usize, Written)>,
    /// The first field beyond the columns.
    extra: Option<Written>,
}

/// What became of an object in a run.
#[derive(Clone, Copy)]
pub enum Outcome {
    /// An object of the graph.
    Built(Key),
    /// A `Variable` or `Formula`: a number without an object.
    Real,
    /// Not declared, because of this [`RootCause`].
    Missing(usize),
}

/// Why objects are missing.
struct RootCause {
    diagnostics: Vec<Diagnostic>,
    /// The objects that could not be built for want of it.
    blocked: Vec<String>,
    /// For a root that is not an error by itself: where it was asked for first.
    first_use: Option<(Span, String)>,
}

/// Why a field has no value.
pub enum Trouble {
    /// What is wrong with it.
    Wrong(Box<Diagnostic>),
    /// It refers to an object that is missing because of this root.
    Blocked {
        /// The root, by its number.
        root: usize,
        /// The place of the reference.
        span: Span,
    },
}

/// A field with an error of its own.
pub fn wrong(diagnostic: Diagnostic) -> Trouble {
    Trouble::Wrong(Box::new(diagnostic))
}

impl ModelFileSource {
    /// Reads a text. It never fails: what is wrong is in the diagnostics.
    pub fn parse(text: String, file: FileId) -> (Self, Vec<Diagnostic>) {
        let (model, mut diagnostics) = model_file::parse(text, file);
        let lines: Vec<Line> = model.objects().collect();
        let mut names: HashMap<Box<str>, usize> = HashMap::with_capacity(lines.len());
        for (at, line) in lines.iter().enumerate().filter(|(_, line)| !line.name.is_empty()) {
            let name = model.slice(line.name);
            if let Some(&first) = names.get(name) {
                if diagnostics.len() < MOST_DIAGNOSTICS {
                    diagnostics.push(
                        Diagnostic::error("duplicate-name", format!("`{name}` is declared twice"))
                            .labelled(line.name, "declared again here")
                            .note_at(lines[first].name, "first declared here")
                            .help("give one of them another name")
                            .object(name),
                    );
                }
            } else {
                names.insert(name.into(), at);
            }
        }
        (Self { model, lines, names }, diagnostics)
    }

    /// Declares the objects in a graph.
    pub fn run<T: Scalar>(
        &self,
        host: RunContext<'_>,
        evaluation: &mut Evaluation<T>,
        inputs: Inputs<'_, T>,
        found: &mut Vec<Diagnostic>,
    ) -> Applied {
        evaluation.env = Environment::default();
        let Evaluation { graph, env } = evaluation;
        let registry = host.registry;
        let sorted: Vec<Sorted> =
            self.lines.iter().map(|line| self.sorted(registry, line)).collect();
        let (order, cycles) = self.order(&sorted);
        let (mut roots, applied) = graph.apply(Extent::Whole, |run| {
            let mut producer = Producer {
                source: self,
                registry,
                host,
                env: &mut *env,
                reals: HashMap::new(),
                inputs,
                run,
                outcomes: vec![None; self.lines.len()],
                roots: Vec::new(),
                suggestions: 0,
            };
            for (k, cycle) in cycles.iter().enumerate() {
                if k < MOST_CYCLES {
                    producer.report_cycle(cycle);
                } else {
                    producer.outcomes[cycle[0]] = Some(producer.root(Vec::new()));
                }
            }
            for (k, &at) in order.iter().enumerate() {
                if k % 1024 == 0
                    && let Err(spent) = producer.inputs.budget.poll()
                {
                    producer.env.stopped = true;
                    producer.root(vec![crate::run::usage::spent(spent)]);
                    break;
                }
                if producer.outcomes[at].is_none() {
                    producer.object(at, &sorted[at]);
                }
            }
            producer.roots
        });
        let mut diagnostics: Vec<Diagnostic> =
            roots.drain(..).flat_map(RootCause::into_diagnostics).collect();
        diagnostics.sort_by_key(|d| d.span().start);
        let beyond = diagnostics.len().saturating_sub(MOST_DIAGNOSTICS);
        if beyond > 0 {
            let severe = diagnostics[MOST_DIAGNOSTICS..].iter().any(Diagnostic::is_error);
            diagnostics.truncate(MOST_DIAGNOSTICS);
            let message = format!("{beyond} more faults are not listed");
            diagnostics.push(if severe {
                Diagnostic::error("too-many-errors", message)
            } else {
                Diagnostic::warning("too-many-errors", message)
            });
        }
        found.extend(diagnostics);
        applied
    }

    /// The parsed text.
    pub fn model(&self) -> &ModelFile {
        &self.model
    }

    /// The objects in the order of the file; an object's origin is its place here.
    pub fn lines(&self) -> &[Line] {
        &self.lines
    }

    /// True for the name of an object.
    pub fn has(&self, name: &str) -> bool {
        self.names.contains_key(name)
    }

    /// Sorts the fields of an object by what they are for.
    pub fn sorted(&self, registry: &Registry, line: &Line) -> Sorted {
        let entity = self.model.slice(line.entity);
        let row = registry.get(our_word(entity));
        let row = row.filter(|row| row.kind && row.columns.is_some()).cloned();
        let (attributes, fields): (Vec<Written>, Vec<Written>) = self.model[line.fields]
            .iter()
            .partition(|field| matches!(field.kind, FieldKind::Attribute { .. }));
        let mut sorted = Sorted {
            row,
            head: Vec::new(),
            attributes,
            relabel: None,
            slots: Vec::new(),
            extra: None,
        };
        let Some(row) = &sorted.row else {
            if is_real(entity) {
                sorted.head = fields;
            }
            return sorted;
        };
        let slash = fields.iter().position(|field| field.kind == FieldKind::Slash);
        let (head, data) = match slash {
            Some(at) => (&fields[..at], &fields[at + 1..]),
            None => {
                let divisions = match row.class.dimension() {
                    Some(1) => 1,
                    Some(2) if matches!(fields.get(2), Some(f) if is_pair(f)) => 3,
                    Some(2) => 5,
                    _ => 0,
                };
                fields.split_at(fields.len().min(2 + divisions))
            }
        };
        sorted.head = head.to_vec();

        let columns = row.columns.unwrap_or("");
        let mut columns: Vec<&str> = columns.split_ascii_whitespace().collect();
        // A curve's or a surface's own, not what a relabel is made from.
        let slot = row.field("relabel").filter(|_| row.class.dimension() > Some(0));
        let own_column = columns.first() == Some(&"relabel") && row.class.dimension() > Some(0);
        let first = data.first();
        let star = first.is_some_and(|f| f.kind == FieldKind::Star && self.written(f) == "*");
        let word = matches!(first, Some(f) if f.kind == FieldKind::Word);
        let has_relabel = if own_column {
            let count = columns.len();
            columns.remove(0);
            star || (data.len() >= count && word)
        } else {
            // Versions differ in which kinds have the column.
            let column = star || (word && slot.is_some());
            column && data.len() > columns.len() && row.class.dimension() > Some(0)
        };
        let data = if has_relabel { &data[1..] } else { data };
        let relabel = first.copied().filter(|_| has_relabel && !star);
        let known = |f: &Written| self.names.contains_key(self.written(f));
        match (slot, relabel) {
            (Some(at), Some(written)) if known(&written) => sorted.slots.push((at, written)),
            _ => sorted.relabel = relabel,
        }
        let fields = columns.iter().filter_map(|column| row.field(column));
        sorted.slots.extend(fields.zip(data.iter().copied()));
        sorted.extra = data.get(columns.len()).copied();
        sorted
    }

    /// The text of a field.
    pub fn written(&self, field: &Written) -> &str {
        self.model.slice(field.span)
    }

    /// The objects, parents before children, otherwise in the order of the file; and the cycles,
    /// each as the path round it.
    pub fn order(&self, sorted: &[Sorted]) -> (Vec<usize>, Vec<Vec<usize>>) {
        #[derive(Clone, Copy, PartialEq)]
        enum Mark {
            New,
            Open,
            Done,
        }
        let mut marks = vec![Mark::New; sorted.len()];
        let mut order = Vec::with_capacity(sorted.len());
        let mut cycles = Vec::new();
        // The path from the object under way to what it is built on: each with its parents, and
        // how many of them were visited.
        let mut path: Vec<(usize, Vec<usize>, usize)> = Vec::new();
        for start in 0..sorted.len() {
            if marks[start] != Mark::New {
                continue;
            }
            marks[start] = Mark::Open;
            path.push((start, self.parents(&sorted[start]), 0));
            while let Some((at, parents, visited)) = path.last_mut() {
                let Some(&parent) = parents.get(*visited) else {
                    marks[*at] = Mark::Done;
                    order.push(*at);
                    path.pop();
                    continue;
                };
                *visited += 1;
                match marks[parent] {
                    Mark::Done => {}
                    Mark::New => {
                        marks[parent] = Mark::Open;
                        path.push((parent, self.parents(&sorted[parent]), 0));
                    }
                    Mark::Open => {
                        // Without the object at the end of the path none of the others is built.
                        let known = cycles.len() < MOST_CYCLES;
                        let from = path.iter().position(|(at, ..)| known && *at == parent);
                        let round = path[from.unwrap_or(path.len() - 1)..].iter();
                        cycles.push(round.map(|(at, ..)| *at).collect());
                    }
                }
            }
        }
        (order, cycles)
    }

    /// The objects that the arguments name.
    fn parents(&self, sorted: &Sorted) -> Vec<usize> {
        let mut parents = Vec::new();
        let Some(row) = &sorted.row else {
            // Of a variable or formula.
            sorted.head.iter().for_each(|field| self.names_in(field, &mut parents));
            return parents;
        };
        for (at, field) in &sorted.slots {
            if row.fields[*at].class != Class::Text {
                self.names_in(field, &mut parents);
            }
        }
        parents
    }

    fn names_in(&self, field: &Written, found: &mut Vec<usize>) {
        match field.kind {
            FieldKind::Word => found.extend(self.names.get(self.written(field))),
            FieldKind::Formula => {
                found.extend(words(self.written(field)).filter_map(|(_, w)| self.names.get(w)));
            }
            FieldKind::List(items) | FieldKind::Tuple(items) => {
                self.model[items].iter().for_each(|item| self.names_in(item, found));
            }
            _ => {}
        }
    }

    /// Where other objects mention this one, by object and place. Of an entity that nobody knows,
    /// every word may be a name.
    pub fn mentions(&self, registry: &Registry, name: &str) -> Vec<(usize, Span)> {
        let mut found = Vec::new();
        for (at, line) in self.lines.iter().enumerate() {
            let sorted = self.sorted(registry, line);
            let texts: Vec<Span> = match &sorted.row {
                Some(row) => {
                    let text = |(k, _): &&(usize, Written)| row.fields[*k].class == Class::Text;
                    sorted.slots.iter().filter(text).map(|(_, w)| w.span).collect()
                }
                None => Vec::new(),
            };
            let mut stack: Vec<Written> = self.model[line.fields].to_vec();
            while let Some(field) = stack.pop() {
                match field.kind {
                    FieldKind::Word
                        if self.written(&field) == name && !texts.contains(&field.span) =>
                    {
                        found.push((at, field.span));
                    }
                    FieldKind::Formula => {
                        let places = words(self.written(&field)).filter(|(_, w)| *w == name);
                        found.extend(places.map(|(begin, w)| {
                            let start = field.span.start + begin as u32;
                            (at, Span { start, end: start + w.len() as u32, ..field.span })
                        }));
                    }
                    FieldKind::List(items) | FieldKind::Tuple(items) => {
                        stack.extend(&self.model[items]);
                    }
                    _ => {}
                }
            }
        }
        found
    }

    /// The object of that name.
    pub fn line(&self, name: &str) -> Option<&Line> {
        self.names.get(name).map(|&at| &self.lines[at])
    }

    /// How an object is drawn and divided; what is wrong with that is pushed.
    fn head(&self, sorted: &Sorted, line: &Line, errors: &mut Vec<Diagnostic>) -> Attributes {
        let class = sorted.row.as_ref().map_or(Class::Any, |row| row.class);
        let mut head = Attributes::of(class);
        let end = Span::point(line.span.file, line.span.end.saturating_sub(1));
        let mut parts: Vec<Part> = Vec::with_capacity(5);
        for (k, name) in ["colour", "visible"].into_iter().enumerate() {
            match sorted.head.get(k).map(|field| (field, field.kind)) {
                Some((field, FieldKind::Number(id))) => parts.push((name, vec![id], field.span)),
                Some((field, _)) => errors.push(
                    Diagnostic::error("wrong-field", format!("`{name}` must be a whole number"))
                        .at(field.span)
                        .expected("a whole number")
                        .found(format!("`{}`", self.written(field))),
                ),
                None => errors.push(
                    Diagnostic::error("missing-field", format!("`{name}` is missing"))
                        .at(end)
                        .expected("a name, then colour, visibility, divisions and data"),
                ),
            }
        }
        let fields = sorted.head.get(2..).unwrap_or(&[]);
        match divisions(class, fields) {
            Ok(divided) => parts.extend(divided),
            // What comes after a fault in colour or visibility may only be out of step.
            Err(_) if !errors.is_empty() => {}
            Err(expected) => {
                let ends = fields.first().zip(fields.last());
                let place = ends.map_or(end, |(first, last)| first.span.to(last.span));
                let message = format!("invalid divisions of {}", class.with_article());
                let found = format!("`{}`", self.model.slice(place));
                let diagnostic = Diagnostic::error("wrong-field", message).at(place);
                errors.push(diagnostic.expected(expected).found(found));
            }
        }
        for (name, ids, span) in parts {
            let number = |id: &NumberId| Value::<f64>::Number(self.model[*id].value);
            let value = match &ids[..] {
                [id] => number(id),
                ids => Value::list(ids.iter().map(number)),
            };
            if let Err(fault) = head.set(name, &value) {
                errors.push(fault_location::unplaced(&fault).at(span));
            }
        }
        let mut rest: Vec<&str> = Vec::new();
        for (k, attribute) in sorted.attributes.iter().enumerate() {
            let text = self.written(attribute);
            if let FieldKind::Attribute { name, value } = attribute.kind {
                let (name, value) = (self.model.slice(name), self.model.slice(value));
                if let ("Layer", Ok(layer)) = (name, value.trim().parse::<u8>()) {
                    head.layer = layer.into();
                }
                // What the head has by itself need not be kept as text.
                if k == 0 && is_layer(text) || panel_attributes::read(&mut head, name, value) {
                    continue;
                }
            }
            rest.push(text);
        }
        head.attributes = (!rest.is_empty()).then(|| rest.join(" ").into());
        head
    }

    /// Where the fault of an object lies.
    pub fn fault_span<T: Scalar>(&self, object: &Object<T>, fault: &CallError) -> Option<Span> {
        let line = self.lines.get(object.origin as usize)?;
        let whole = Some(line.entity.to(line.name));
        let Some(field) = fault.field() else { return whole };
        let sorted = self.sorted_as(&object.row, line);
        self.place(&sorted, field, fault.item()).or(whole)
    }

    /// Where an object is declared.
    pub fn declared_at<T: Scalar>(&self, object: &Object<T>) -> Option<Span> {
        self.lines.get(object.origin as usize).map(|line| line.name)
    }

    fn sorted_as(&self, row: &Arc<Row>, line: &Line) -> Sorted {
        self.sorted(&Registry::new([Row::clone(row)]), line)
    }

    /// Where an argument stands, or an item of it.
    fn place(&self, sorted: &Sorted, field: usize, item: Option<usize>) -> Option<Span> {
        let (_, written) = sorted.slots.iter().find(|(at, _)| *at == field)?;
        let item = item.and_then(|k| self.items(written)?.get(k));
        Some(item.unwrap_or(written).span)
    }

    fn items(&self, field: &Written) -> Option<&[Written]> {
        match field.kind {
            FieldKind::List(items) | FieldKind::Tuple(items) => Some(&self.model[items]),
            _ => None,
        }
    }

    /// The number of the file that a number of an object is.
    pub fn literal(
        &self,
        object: &Object<f64>,
        path: &NumberPath,
    ) -> Result<ModelNumber, NotLiteral> {
        let line = self.lines.get(object.origin as usize).ok_or(NotLiteral::Default)?;
        let sorted = self.sorted_as(&object.row, line);
        let slot = sorted.slots.iter().find(|(at, _)| *at == path.field);
        let (at, mut field) = *slot.ok_or(NotLiteral::Default)?;
        for k in [path.item, path.component].into_iter().flatten() {
            let item = self.items(&field).and_then(|items| items.get(k));
            field = *item.ok_or(NotLiteral::Default)?;
        }
        match field.kind {
            FieldKind::Number(id) => {
                Ok(ModelNumber { id, angle: object.row.fields[at].unit == Unit::Angle })
            }
            FieldKind::Formula => {
                let names = words(self.written(&field)).map(|(_, w)| w.to_string()).collect();
                Err(NotLiteral::Expression { span: field.span, names })
            }
            _ => Err(NotLiteral::Default),
        }
    }

    /// Gives a number of the file another value, in the argument's unit.
    pub fn set(&mut self, number: ModelNumber, value: f64) -> Result<(), Diagnostic> {
        self.model.set_number(number.id, if number.angle { degrees(value) } else { value })
    }

    /// The text, with the changed numbers written into it.
    pub fn text(&self) -> String {
        self.model.text_with_edits()
    }

    /// The planes in which the model is mirrored, as "y" or "xy".
    pub fn symmetry(&self) -> String {
        self.model.symmetry()
    }

    /// The header's line of units, empty without one.
    pub fn units(&self) -> String {
        self.model.header_value("Units").unwrap_or("").trim().to_string()
    }
}

/// Makes the objects of an [`Extent::Whole`] application.
pub struct Producer<'a, 'g, T: Scalar> {
    /// The parsed file.
    pub source: &'a ModelFileSource,
    /// The rows of all kinds.
    pub registry: &'a Registry,
    /// The program that loads the file, with its host.
    pub host: RunContext<'a>,
    /// The environment that the run leaves behind.
    pub env: &'a mut Environment<T>,
    /// The numbers of variables and formulas, by their place in the file.
    pub reals: HashMap<usize, T>,
    /// Values of parameters and literals for this run.
    pub inputs: Inputs<'a, T>,
    /// The run of the graph that declarations go to.
    pub run: &'a mut Run<'g, T>,
    /// By the place of the object in the file.
    pub outcomes: Vec<Option<Outcome>>,
    roots: Vec<RootCause>,
    /// How often a nearest name was looked for, which takes long in large models.
    suggestions: usize,
}

impl<T: Scalar> Producer<'_, '_, T> {
    fn root(&mut self, diagnostics: Vec<Diagnostic>) -> Outcome {
        self.roots.push(RootCause { diagnostics, blocked: Vec::new(), first_use: None });
        Outcome::Missing(self.roots.len() - 1)
    }

    fn report_cycle(&mut self, cycle: &[usize]) {
        let source = self.source;
        let name = |at: usize| source.model.slice(source.lines[at].name);
        let round = cycle.iter().chain(cycle.first()).map(|&at| name(at));
        // A long way round is identified by its ends.
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
            diagnostic = diagnostic.note_at(source.lines[at].name, "on the way round");
        }
        let missing = self.root(vec![diagnostic]);
        for &at in cycle {
            self.outcomes[at] = Some(missing);
        }
    }

    fn object(&mut self, at: usize, sorted: &Sorted) {
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
        // Columns have their places: one left out would give the next its meaning.
        let columns = row.columns.unwrap_or("").split_ascii_whitespace();
        let own = |at: &usize| row.fields[*at].name == "relabel" && row.class.dimension() > Some(0);
        let mut fields = columns.filter_map(|column| row.field(column)).filter(|at| !own(at));
        let given = sorted.slots.iter().filter(|(at, _)| !own(at)).count();
        if let Some(missing) = fields.nth(given)
            && errors.is_empty()
        {
            let end = Span::point(line.span.file, line.span.end.saturating_sub(1));
            let message = format!("{} needs `{}`", row.name, row.fields[missing].name);
            errors.push(
                Diagnostic::error("missing-field", message)
                    .at(end)
                    .expected(format!("data in the order {}", row.columns.unwrap_or("")))
                    .found(format!("{given} fields of data")),
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
            FieldKind::List(items) => self.list(field, items),
            FieldKind::Tuple(_)
            | FieldKind::Pair(..)
            | FieldKind::Slash
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
    fn into_diagnostics(self) -> Vec<Diagnostic> {
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
        // The cause is only a warning, but what is built on it is missing.
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

/// The program that a model file stands for where a program loads it.
///
/// # Errors
/// That the file is not sound, with its first fault.
pub fn converted(name: &str, text: &str, registry: &Registry) -> Result<String, Diagnostic> {
    let mut sources = Sources::new();
    let file = sources.add(name, text);
    let (source, mut found) = ModelFileSource::parse(text.to_string(), file);
    let (mut modules, mut evaluation) = (Modules::default(), Evaluation::default());
    let host = RunContext {
        modules: &mut modules,
        world: &NoFiles,
        registry,
        sources: &mut sources,
        sketch: None,
        converted,
    };
    let inputs = Inputs {
        overrides: &IndexMap::new(),
        seed: &|_, x| x,
        seeded_objects: &HashSet::new(),
        budget: &Budget::default(),
        settings: Settings::default(),
    };
    source.run(host, &mut evaluation, inputs, &mut found);
    match found.iter().find(|d| prevents_conversion(&evaluation, d)) {
        None => Ok(to_program(&source, registry, &evaluation)),
        Some(first) => Err(Diagnostic::error(
            "cannot-read",
            format!("`{name}` is not sound: {}", first.message),
        )
        .help("open the model file by itself to see all that is wrong with it")),
    }
}
