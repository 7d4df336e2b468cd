//! A parsed model file as a producer of objects: the fields of each by purpose, the order of
//! construction, and the run.

use crate::model_file::divisions::{Part, divisions, is_pair};
use crate::model_file::names::{degrees, is_layer, is_real, our_word, words};
use crate::model_file::panel_attributes;
use crate::model_file::producer::Producer;
use crate::run::interpreter::Inputs;
use crate::run::program::{NotLiteral, RunContext};
use crate::source::env::{Environment, Evaluation};
use crate::source::fault_location;
use crate::value::number_path::NumberPath;
use moldloft_diag::{Diagnostic, FileId, Span};
use moldloft_model::{Applied, Extent, Object};
use moldloft_num::trace::Key;
use moldloft_registry::{
    ATTRIBUTES, Attributes, CallError, Class, Registry, Row, Scalar, Unit, Value,
};
use moldloft_syntax::model_file::{
    self, EntryField as Written, FieldKind, ModelFile, NumberId, ObjectEntry as Line,
};
use std::collections::HashMap;
use std::sync::Arc;

/// More diagnostics of one run than this are counted, not listed.
const MOST_DIAGNOSTICS: usize = 100;

/// More cycles than this are not reported: their paths may be long.
const MOST_CYCLES: usize = 20;

/// A parsed model file and the positions of its objects.
pub struct ModelFileSource {
    pub(super) model: ModelFile,
    pub(super) lines: Vec<Line>,
    /// The first object of each name, by its index in `lines`.
    pub names: HashMap<Box<str>, usize>,
}

/// The number of the file behind an argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelNumber {
    id: NumberId,
    /// True when the file has degrees where the argument has radians.
    angle: bool,
}

/// The fields of an object, by purpose.
pub struct Sorted {
    /// The row of its entity; `None` for an entity that model files do not have.
    pub row: Option<Arc<Row>>,
    /// Colour, visibility and divisions.
    pub head: Vec<Written>,
    /// `A:Name(value)`.
    pub attributes: Vec<Written>,
    /// Content of the relabel column, unless it is `*`.
    pub relabel: Option<Written>,
    /// Arguments, each with the number of its field in the row.
    pub slots: Vec<(usize, Written)>,
    /// Number of arguments with columns.
    pub(super) in_columns: usize,
    /// Arguments by name that the row does not know, or that are not one field.
    pub(super) unknown: Vec<Written>,
    /// Parts of the head by name.
    pub(super) head_arguments: Vec<(&'static str, Written)>,
    /// The first field beyond the columns.
    pub(super) extra: Option<Written>,
}

/// Result of an object in a run.
#[derive(Clone, Copy)]
pub enum Outcome {
    /// An object of the graph.
    Built(Key),
    /// A `Variable` or `Formula`: a number without an object.
    Real,
    /// Not declared, because of this `RootCause`.
    Missing(usize),
}

/// Why objects are missing.
pub(super) struct RootCause {
    pub(super) diagnostics: Vec<Diagnostic>,
    /// The objects that could not be built for want of it.
    pub(super) blocked: Vec<String>,
    /// For a root that is not an error itself: its first use.
    pub(super) first_use: Option<(Span, String)>,
}

/// Reason why a field has no value.
pub enum Trouble {
    /// Faulty.
    Wrong(Box<Diagnostic>),
    /// It refers to an object that is missing because of this root cause.
    Blocked {
        /// The root cause, by number.
        root: usize,
        /// The span of the reference.
        span: Span,
    },
}

/// A field with an error of its own.
pub fn wrong(diagnostic: Diagnostic) -> Trouble {
    Trouble::Wrong(Box::new(diagnostic))
}

impl ModelFileSource {
    /// Parses a text. It never fails: errors are in the diagnostics.
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
    pub(crate) fn run<T: Scalar>(
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

    /// The objects in the order of the file; an object's origin is its index here.
    pub fn lines(&self) -> &[Line] {
        &self.lines
    }

    /// True for the name of an object.
    pub fn has(&self, name: &str) -> bool {
        self.names.contains_key(name)
    }

    /// Sorts the fields of an object by purpose.
    pub fn sorted(&self, registry: &Registry, line: &Line) -> Sorted {
        let entity = self.model.slice(line.entity);
        let row = registry.get(our_word(entity));
        let (arguments, fields): (Vec<Written>, Vec<Written>) = self.model[line.fields]
            .iter()
            .partition(|field| matches!(field.kind, FieldKind::Argument { .. }));
        let (attributes, fields): (Vec<Written>, Vec<Written>) =
            fields.iter().partition(|field| matches!(field.kind, FieldKind::Attribute { .. }));
        // A kind without columns has its arguments by name alone; else the word is another program's.
        let data = fields.iter().filter(|field| field.kind != FieldKind::Slash).count();
        let by_name = !arguments.is_empty() && data <= 2;
        let row = row.filter(|row| row.kind && (row.columns.is_some() || by_name)).cloned();
        let mut sorted = Sorted {
            row,
            head: Vec::new(),
            attributes,
            relabel: None,
            slots: Vec::new(),
            in_columns: 0,
            unknown: Vec::new(),
            head_arguments: Vec::new(),
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
        // The relabel of a curve or surface itself, not the argument of a relabel object.
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
        sorted.in_columns = data.len().min(columns.len());
        for argument in arguments {
            self.sort_argument(&mut sorted, argument);
        }
        sorted
    }

    /// A named argument takes precedence over that of the column.
    fn sort_argument(&self, sorted: &mut Sorted, argument: Written) {
        let (Some(row), FieldKind::Argument { name, value }) = (&sorted.row, argument.kind) else {
            return;
        };
        let name = self.model.slice(name);
        let part = ATTRIBUTES.iter().find(|part| part.name == name);
        match (row.field(name), part, &self.model[value]) {
            (Some(at), _, [value]) => {
                sorted.slots.retain(|(slot, _)| *slot != at);
                sorted.slots.push((at, *value));
            }
            (None, Some(part), [value]) => sorted.head_arguments.push((part.name, *value)),
            _ => sorted.unknown.push(argument),
        }
    }

    /// The text of a field.
    pub fn written(&self, field: &Written) -> &str {
        self.model.slice(field.span)
    }

    /// The objects, parents before children, otherwise in the order of the file; and the cycles,
    /// each as a closed path.
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
        // The path from the current object to its ancestors: each with its parents, and the number
        // of those visited.
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
                        // No object of the cycle is built without the one at the end of the path.
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
            // Parents of a variable or formula.
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

    /// References to this object in others, by object and position. Every word of an unknown entity
    /// may be a name.
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
                    FieldKind::List(items)
                    | FieldKind::Tuple(items)
                    | FieldKind::Argument { value: items, .. } => {
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

    /// Display attributes and divisions of an object; errors are pushed.
    pub(super) fn head(
        &self,
        sorted: &Sorted,
        line: &Line,
        errors: &mut Vec<Diagnostic>,
    ) -> Attributes {
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
            // Errors after one in colour or visibility may only be due to a missing column.
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
        for (name, written) in &sorted.head_arguments {
            if written.kind == FieldKind::Star && *name == "divisions" {
                head.divided = false;
                continue;
            }
            let numbers = match self.items(written) {
                Some(items) => items.to_vec(),
                None => vec![*written],
            };
            let numbers: Option<Vec<Value<f64>>> = numbers
                .iter()
                .map(|item| match item.kind {
                    FieldKind::Number(id) => Some(Value::Number(self.model[id].value)),
                    _ => None,
                })
                .collect();
            let value = Value::list(numbers.unwrap_or_default());
            if let Err(fault) = head.set(name, &value) {
                errors.push(fault_location::unplaced(&fault).at(written.span));
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
                // Attributes that the head represents are not kept as text.
                if k == 0 && is_layer(text) || panel_attributes::read(&mut head, name, value) {
                    continue;
                }
            }
            rest.push(text);
        }
        head.attributes = (!rest.is_empty()).then(|| rest.join(" ").into());
        head
    }

    /// Position of an object's fault.
    pub fn fault_span<T: Scalar>(&self, object: &Object<T>, fault: &CallError) -> Option<Span> {
        let line = self.lines.get(object.origin as usize)?;
        let whole = Some(line.entity.to(line.name));
        let Some(field) = fault.field() else { return whole };
        let sorted = self.sorted_as(&object.row, line);
        self.place(&sorted, field, fault.item()).or(whole)
    }

    /// Position of an object's declaration.
    pub fn declared_at<T: Scalar>(&self, object: &Object<T>) -> Option<Span> {
        self.lines.get(object.origin as usize).map(|line| line.name)
    }

    fn sorted_as(&self, row: &Arc<Row>, line: &Line) -> Sorted {
        self.sorted(&Registry::new([Row::clone(row)]), line)
    }

    /// Position of an argument, or of an item of it.
    pub(super) fn place(&self, sorted: &Sorted, field: usize, item: Option<usize>) -> Option<Span> {
        let (_, written) = sorted.slots.iter().find(|(at, _)| *at == field)?;
        let item = item.and_then(|k| self.items(written)?.get(k));
        Some(item.unwrap_or(written).span)
    }

    pub(super) fn items(&self, field: &Written) -> Option<&[Written]> {
        match field.kind {
            FieldKind::List(items) | FieldKind::Tuple(items) => Some(&self.model[items]),
            _ => None,
        }
    }

    /// The number of the file behind a number of an object.
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

    /// Sets a number of the file, in the argument's unit.
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
