//! Conversion of a model file to a program: one statement per object, in the order of the file
//! (parents first). Content without an equivalent in the language is kept in comments that begin
//! with `#ms2 `.

use crate::model_file::names::{bare, identifier, is_real, system_name};
use crate::model_file::relations::RADIANS;
use crate::model_file::source::{ModelFileSource, Sorted};
use crate::source::env::Evaluation;
use moldloft_diag::Diagnostic;
use moldloft_registry::{Attributes, Class, FieldSpec, PanelAttributes, Registry, Spacing, Unit};
use moldloft_syntax::model_file::{
    EntryField as Written, FieldKind, ItemKind, ObjectEntry as Line,
};
use moldloft_syntax::number;
use std::fmt::Write;

/// Prefix of a comment with a line of a model file that is not one of our objects.
pub(crate) const VERBATIM: &str = "#ms2 ";

/// The relabel of the object that follows.
pub(crate) const RELABEL: &str = "#ms2-relabel ";

/// The entity word of the object that follows, where it is another than that of our kind.
pub(crate) const ENTITY: &str = "#ms2-entity ";

/// Prefix of a comment with the names of the file's objects in their order, if parents follow their
/// children.
pub(crate) const ORDER: &str = "#ms2-order ";

/// The most names in a line of the order.
const NAMES_IN_LINE: usize = 12;

/// The program that declares the objects of a model file, as a run of it built them.
pub fn to_program(
    source: &ModelFileSource,
    registry: &Registry,
    evaluation: &Evaluation<f64>,
) -> String {
    ToProgram { source, registry, evaluation }.text()
}

/// True for a diagnostic that prevents conversion to the other form: an error that does not belong
/// to an existing object.
pub fn prevents_conversion(evaluation: &Evaluation<f64>, diagnostic: &Diagnostic) -> bool {
    let there = |name| evaluation.graph.find(name).is_some();
    let built = diagnostic.object.as_deref().is_some_and(there);
    diagnostic.is_error() && !built && diagnostic.id != "blocked"
}

/// Named arguments for the differences of a head from the default of its class.
fn head_arguments(head: &Attributes, class: Class) -> Vec<String> {
    let usual = Attributes::of(class);
    let mut named = Vec::new();
    let pair = |[n, m]: [u32; 2]| match class.dimension() {
        Some(2) => format!("{{{n}, {m}}}"),
        _ => n.to_string(),
    };
    if head.colour != usual.colour {
        named.push(format!("colour = {}", head.colour));
    }
    if head.visible != usual.visible {
        named.push(format!("visible = {}", head.visible));
    }
    if head.layer != usual.layer {
        named.push(format!("layer = {}", head.layer));
    }
    // Said even when usual: an image without divisions takes its original's.
    if head.divided || head.divisions != usual.divisions {
        let [u, v, w] = head.blocks;
        named.push(match class.dimension() {
            Some(3) => format!("divisions = {{{u}, {v}, {w}}}"),
            _ => format!("divisions = {}", pair(head.divisions)),
        });
    }
    if head.subdivisions != usual.subdivisions {
        named.push(format!("subdivisions = {}", pair(head.subdivisions)));
    }
    if let Some(panels) = &head.panels {
        named.extend(panel_arguments(panels));
    }
    if head.orientation != usual.orientation {
        named.push(format!("orientation = {}", head.orientation));
    }
    if let Some(attributes) = &head.attributes {
        named.push(format!("attributes = {}", quoted(attributes)));
    }
    named
}

/// Named arguments of panels besides their number.
fn panel_arguments(panels: &PanelAttributes) -> Vec<String> {
    let mut named = Vec::new();
    let pair = |name: &str, [a, b]: [String; 2]| {
        if a == b { format!("{name} = {a}") } else { format!("{name} = {{{a}, {b}}}") }
    };
    if panels.size.iter().any(Option::is_some) {
        named.push(pair("size", panels.size.map(|s| s.unwrap_or(0.0).to_string())));
    }
    if panels.spacing.iter().any(Option::is_some) {
        let spelled = |s: Option<Spacing>| s.map_or("\"auto\"".into(), |s| s.spelled());
        named.push(pair("spacing", panels.spacing.map(spelled)));
    }
    match &panels.tags[..] {
        [] => {}
        [tag] => named.push(format!("tags = {}", quoted(tag))),
        tags => {
            let list = tags.iter().map(|tag| quoted(tag)).collect::<Vec<_>>().join(", ");
            named.push(format!("tags = {{{list}}}"));
        }
    }
    named
}

/// A text of the language.
pub fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

/// The planes as the header spells them: `x y`.
pub(crate) fn planes(symmetry: &str) -> String {
    symmetry.chars().map(String::from).collect::<Vec<_>>().join(" ")
}

pub(crate) fn is_legacy(version: &str) -> bool {
    version.parse::<f64>().is_ok_and(|v| v < 1.0)
}

/// Conversion of a model file.
struct ToProgram<'a> {
    source: &'a ModelFileSource,
    registry: &'a Registry,
    evaluation: &'a Evaluation<f64>,
}

impl ToProgram<'_> {
    fn text(&self) -> String {
        let model = self.source.model();
        let mut out = self.header();
        // Text before each object, and after the last: pieces with their positions.
        let mut before: Vec<Vec<(u32, String)>> = Vec::with_capacity(self.source.lines().len());
        let mut pending = Vec::new();
        for item in &model.items {
            if item.after_gap {
                pending.push((0, "\n".to_string()));
            }
            match item.kind {
                ItemKind::Comment => {
                    pending.push((item.span.start, comment(model.slice(item.span))));
                }
                ItemKind::Object(_) => before.push(std::mem::take(&mut pending)),
                // Reported as an error, which prevents conversion.
                ItemKind::Unknown => {}
            }
        }
        let lines = self.source.lines();
        let sorted: Vec<Sorted> =
            lines.iter().map(|l| self.source.sorted(self.registry, l)).collect();
        let order = self.source.order(&sorted).0;
        if !order.is_sorted() {
            let names: Vec<&str> = lines.iter().map(|line| model.slice(line.name)).collect();
            for names in names.chunks(NAMES_IN_LINE) {
                let _ = writeln!(out, "{ORDER}{}", names.join(" "));
            }
        }
        for at in order {
            let object = self.object(&lines[at], at, &sorted[at]);
            // A comment inside an object comes before it, unless the object has it in its text.
            let inside = |start: u32| object.is_none() && start > lines[at].span.start;
            out.extend(before[at].iter().filter(|(start, _)| !inside(*start)).map(|(_, t)| &**t));
            out += &object.unwrap_or_else(|| self.verbatim(&lines[at]));
        }
        out.extend(pending.iter().map(|(_, text)| &**text));
        if let Some(trailer) = model.trailer {
            for line in model.slice(trailer).lines() {
                let _ = writeln!(out, "#ms2-trailer {line}");
            }
        }
        out
    }

    fn header(&self) -> String {
        let model = self.source.model();
        let version = model.version.map_or("", |span| model.slice(span));
        let symmetry = model.symmetry();
        let units = model.header_value("Units").unwrap_or("");
        let legacy = is_legacy(version);
        let mut lines: Vec<(u32, String)> = Vec::new();
        let first = model.first_line_rest.map_or("", |span| model.slice(span));
        let usual_first =
            if legacy && !symmetry.is_empty() { format!("/{symmetry}") } else { String::new() };
        if first != usual_first {
            lines.push((0, format!("MultiSurf {version} {first}").trim_end().to_string()));
        }
        let comments = model.header_comments.iter();
        lines.extend(comments.map(|span| (span.start, model.slice(*span).to_string())));
        lines.sort();
        let first_other = lines.iter().map(|(at, _)| *at).find(|at| *at > 0).unwrap_or(u32::MAX);
        let mut told_others = false;
        for line in &model.header {
            let (key, rest) = (model.slice(line.key), model.slice(line.rest));
            // If the conversion back would give the same position, the arguments suffice.
            let reported = match key {
                _ if told_others || line.key.start > first_other => false,
                "Units" => rest == units && !rest.is_empty(),
                "Symmetry" => !legacy && !symmetry.is_empty() && rest == planes(&symmetry),
                _ => false,
            };
            if !reported {
                told_others = true;
                lines.push((line.key.start, format!("{key}: {rest}").trim_end().to_string()));
            }
        }
        lines.sort();
        let mut named = Vec::new();
        for (key, value) in [("symmetry", &*symmetry), ("units", units), ("version", version)] {
            if !value.is_empty() {
                named.push(format!("{key} = {}", quoted(value)));
            }
        }
        if !lines.is_empty() {
            let texts: Vec<String> = lines.iter().map(|(_, line)| quoted(line)).collect();
            named.push(format!("lines = {{{}}}", texts.join(", ")));
        }
        let mut name = String::from("info");
        while self.source.has(&name) {
            name.push('_');
        }
        format!("Model {name}({});\n", named.join(", "))
    }

    /// The text of an object, in lines that are comments.
    fn verbatim(&self, line: &Line) -> String {
        let text = self.source.model().slice_with_edits(line.span);
        text.lines().map(|line| format!("{VERBATIM}{}\n", line.trim_end())).collect()
    }

    /// The statement of an object that was built.
    fn object(&self, line: &Line, at: usize, sorted: &Sorted) -> Option<String> {
        let model = self.source.model();
        let name = model.slice(line.name);
        if is_real(model.slice(line.entity)) {
            return self.real(name, sorted);
        }
        let graph = &self.evaluation.graph;
        let object = graph.get(graph.find(name)?).filter(|o| o.origin == at as u32)?;
        let row = sorted.row.as_ref()?;
        let mut out = String::new();
        if let Some(relabel) = &sorted.relabel {
            let _ = writeln!(out, "{RELABEL}{}", model.slice(relabel.span));
        }
        let entity = model.slice(line.entity);
        if entity != &*row.name {
            let _ = writeln!(out, "{ENTITY}{entity}");
        }
        let mut args = Vec::new();
        let mut positional = true;
        for (k, field) in row.fields.iter().enumerate() {
            let slot = sorted.slots.iter().find(|(slot, _)| *slot == k);
            let slot = slot.filter(|(_, w)| model.slice(w.span) != "*");
            positional &= slot.is_some() && field.default.is_none();
            let Some((_, written)) = slot else { continue };
            let value = self.value(field, written);
            args.push(if positional { value } else { format!("{} = {value}", field.name) });
        }
        args.extend(head_arguments(&object.head, row.class));
        let _ = writeln!(out, "{} {}({});", row.name, identifier(name), args.join(", "));
        Some(out)
    }

    /// A variable as a parameter, a formula as a variable of the language.
    fn real(&self, name: &str, sorted: &Sorted) -> Option<String> {
        let model = self.source.model();
        let env = &self.evaluation.env;
        env.numbers.get(name)?;
        if let Some(param) = env.params.iter().find(|p| p.name == name) {
            let value = number::plain(param.default);
            let name = identifier(name);
            return Some(match param.range {
                Some((low, high)) => {
                    let (low, high) = (number::plain(low), number::plain(high));
                    format!("param float {name} = {value} in [{low}, {high}];\n")
                }
                None => format!("param float {name} = {value};\n"),
            });
        }
        let formula = sorted.head.iter().find(|f| f.kind == FieldKind::Formula)?;
        let text = bare(model.slice(formula.span));
        Some(format!("float {} = {text};\n", identifier(name)))
    }

    fn value(&self, field: &FieldSpec, written: &Written) -> String {
        let model = self.source.model();
        let text = model.slice(written.span);
        let angle = field.unit == Unit::Angle;
        let real = self.evaluation.env.numbers.contains_key(text);
        match written.kind {
            FieldKind::Formula if angle => format!("({})*{RADIANS}", bare(text)),
            FieldKind::Formula => bare(text).to_string(),
            FieldKind::Word if angle && real => format!("{}*{RADIANS}", identifier(text)),
            FieldKind::Number(id) if field.unit == Unit::Angle => {
                number::plain(model[id].value.to_radians())
            }
            FieldKind::Number(id) => number::plain(model[id].value),
            FieldKind::Word if field.class != Class::Text && self.source.has(text) => {
                identifier(text)
            }
            FieldKind::Star => quoted(&system_name(text).unwrap_or_default()),
            FieldKind::Text => quoted(text.trim_matches('"')),
            FieldKind::List(items) => {
                let items: Vec<String> =
                    model[items].iter().map(|item| self.value(field, item)).collect();
                format!("{{{}}}", items.join(", "))
            }
            _ => quoted(text),
        }
    }
}

/// A comment of a model file as one of the language, with its line end.
fn comment(text: &str) -> String {
    match text.strip_prefix("Rem") {
        Some(rest) => format!("#{rest}\n"),
        None => format!("{VERBATIM}{text}\n"),
    }
}
