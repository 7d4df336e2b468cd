//! Data of a document as JSON: parameters, objects, diagnostics, details of one object.

use crate::drag::own_numbers;
use crate::replies::{
    ArgumentFact, BesideFact, CorrectionFact, FaultFact, KindFact, ObjectFact, ObjectState,
    ParamFact, RemarkFact, TextRange, ValueFact,
};
use crate::text::unit;
use moldloft_diag::{Diagnostic, Span};
use moldloft_document::{ArgumentInText, Document, ReadAs};
use moldloft_model::Object;
use moldloft_num::Vec3;
use moldloft_registry::{Class, DefaultValue, FieldSpec, Registry, Row, Unit, Value as Quantity};
use rustc_hash::FxHasher;
use serde::Serialize;
use serde_json::{Value, json};
use std::hash::{Hash, Hasher};

/// Maximum number of list items shown.
const MOST_SHOWN: usize = 8;

/// A header entry of facts.
pub fn json_of(facts: impl Serialize) -> Value {
    serde_json::to_value(facts).unwrap_or_default()
}

/// A span of the main text; `None` for other texts.
pub fn place(document: &Document, text: &str, span: Span) -> Option<TextRange> {
    let known = span.is_known() && document.sources().ids().next() == Some(span.file);
    known.then(|| [unit(text, span.start as usize), unit(text, span.end as usize)])
}

/// A span of another file: its name, and the place in UTF-16 units.
pub fn elsewhere(document: &Document, span: Span) -> Option<(String, TextRange)> {
    let sources = document.sources();
    if !span.is_known() || sources.ids().next() == Some(span.file) {
        return None;
    }
    let (name, text) = (sources.name(span.file)?, sources.text(span.file)?);
    // An editor has one character for each end of a line.
    let ends = |byte: usize| text.get(..byte).map_or(0, |before| before.matches("\r\n").count());
    let at = |byte: usize| unit(text, byte) - ends(byte);
    Some((name.to_string(), [at(span.start as usize), at(span.end as usize)]))
}

/// The number of a parameter in a file beside the text, and its present value; `None` if no such
/// file states it as a number.
pub fn beside(document: &Document, param: &str) -> Option<BesideFact> {
    let param = document.params().iter().find(|p| p.name == param)?;
    let (file, [from, to]) = elsewhere(document, param.span)?;
    let text = document.sources().text(param.span.file)?;
    let found = text.get(param.span.start as usize..param.span.end as usize)?;
    let stated = found.parse::<f64>().is_ok_and(|x| x == param.default);
    let insert = moldloft_syntax::number::plain(param.value);
    stated.then(|| BesideFact {
        name: param.name.clone(),
        file,
        from,
        to,
        found: found.into(),
        insert,
    })
}

/// The files that were read, in the order in which they were first.
pub fn files(read: &[ReadAs]) -> Value {
    let mut names: Vec<&str> = Vec::new();
    for (_, _, file) in read {
        if !names.contains(&file.name.as_str()) {
            names.push(&file.name);
        }
    }
    names.into()
}

/// The parameters.
pub fn params(document: &Document, text: &str) -> Vec<ParamFact> {
    let one = |p: &moldloft_document::Param| ParamFact {
        name: p.name.clone(),
        value: p.value,
        default: p.default,
        range: p.range.map(|(a, b)| [a, b]),
        whole: p.is_int,
        written: document.param_is_number(&p.name) || beside(document, &p.name).is_some(),
        place: place(document, text, p.span),
    };
    document.params().iter().map(one).collect()
}

/// A hash that changes with [`objects`], without the cost of building it.
pub fn objects_stamp(document: &Document) -> u64 {
    let graph = document.graph();
    let mut hasher = FxHasher::default();
    for o in graph.objects() {
        o.name.hash(&mut hasher);
        o.row.name.hash(&mut hasher);
        o.value().map_or(o.row.class, Quantity::class).name().hash(&mut hasher);
        (o.fault().is_some(), o.blocked_by().is_some(), o.head.shown()).hash(&mut hasher);
        o.parents.len().hash(&mut hasher);
        for key in &o.parents {
            key.hash(&mut hasher);
        }
    }
    hasher.finish()
}

/// The objects in the order of declaration.
pub fn objects(document: &Document) -> Vec<ObjectFact> {
    let graph = document.graph();
    let state = |o: &Object<f64>| match (o.fault(), o.blocked_by()) {
        (Some(_), _) => ObjectState::Failed,
        (_, Some(_)) => ObjectState::Blocked,
        _ => ObjectState::Ok,
    };
    let parents = |o: &Object<f64>| -> Vec<String> {
        o.parents.iter().filter_map(|k| Some(graph.get(*k)?.name.to_string())).collect()
    };
    let one = |o: &Object<f64>| ObjectFact {
        name: o.name.to_string(),
        kind: o.row.name.to_string(),
        class: o.value().map_or(o.row.class, Quantity::class).name(),
        state: state(o),
        shown: o.head.shown(),
        parents: parents(o),
    };
    graph.objects().map(one).collect()
}

/// Diagnostics with their positions in the main text.
pub fn diagnostics(document: &Document, text: &str, all: &[Diagnostic]) -> Vec<FaultFact> {
    let sources = document.sources();
    let one = |d: &Diagnostic| {
        let data = d.to_data(sources);
        let home = place(document, text, d.span());
        let edit = d.correction(sources).and_then(|e| {
            let place = place(document, text, e.span)?;
            Some(CorrectionFact { place, insert: e.replacement, title: e.title })
        });
        FaultFact {
            id: data.id,
            severity: data.severity,
            message: data.message,
            place: home,
            line: data.primary.as_ref().map(|l| l.line),
            file: data.primary.map(|l| l.file).filter(|_| home.is_none()),
            elsewhere: elsewhere(document, d.span()).map(|(_, place)| place),
            expected: data.expected,
            found: data.found,
            notes: data.notes,
            help: data.help,
            object: data.object,
            edit,
        }
    };
    all.iter().map(one).collect()
}

/// Remarks about a file: diagnostics without positions.
pub fn remarks(document: &Document, all: &[Diagnostic]) -> Vec<RemarkFact> {
    let one = |d: &Diagnostic| {
        let data = d.to_data(document.sources());
        let expected = data.expected.map(|e| format!("expected {e}"));
        let found = data.found.map(|f| format!("found {f}"));
        let help = expected.into_iter().chain(found).chain(data.notes).chain(data.help).collect();
        RemarkFact { severity: data.severity, message: data.message, help, object: data.object }
    };
    all.iter().map(one).collect()
}

/// A number as JSON; a string for values such as infinity.
pub fn number(x: f64) -> Value {
    if x.is_finite() { json!(x) } else { json!(x.to_string()) }
}

fn vector(v: Vec3) -> Value {
    v.to_array().map(number).to_vec().into()
}

/// A value, abbreviated to a few numbers.
pub fn quantity(value: &Quantity<f64>) -> Value {
    match value {
        Quantity::Number(x) => number(*x),
        Quantity::Vector(v) => vector(*v),
        Quantity::Point(p) => vector(p.xyz),
        Quantity::Text(text) => json!(&**text),
        Quantity::Numbers(a) => {
            let shown: Vec<Value> = a.items.iter().take(MOST_SHOWN).map(|&x| number(x)).collect();
            json!({"shape": a.shape.to_string(), "first": shown})
        }
        Quantity::Vectors(a) => {
            let shown: Vec<Value> = a.iter().take(MOST_SHOWN).map(vector).collect();
            json!({"shape": a.shape.to_string(), "first": shown})
        }
        Quantity::List(items) => items.iter().take(MOST_SHOWN).map(quantity).collect(),
        other => json!(other.class().name()),
    }
}

/// Values of expressions, with derivatives with respect to a parameter.
pub fn values(document: &mut Document, expressions: &[String], by: Option<&str>) -> Vec<ValueFact> {
    let said = |d: &[Diagnostic]| d.first().map_or("no value".to_string(), |d| d.message.clone());
    let mut one = |text: &String| {
        let mut fact = ValueFact { expression: text.clone(), ..ValueFact::default() };
        match document.eval(text) {
            Ok(value) => fact.value = Some(quantity(&value)),
            Err(diagnostics) => fact.error = Some(said(&diagnostics)),
        }
        if let Some(by) = by.filter(|_| fact.error.is_none()) {
            match document.derivatives(std::slice::from_ref(text), &[by.to_string()]) {
                Ok(columns) => fact.derivative = Some(quantity(&columns[0][0])),
                Err(diagnostics) => fact.no_derivative = Some(said(&diagnostics)),
            }
        }
        fact
    };
    expressions.iter().map(&mut one).collect()
}

/// The kinds of objects for a form: name, type and permitted values of each argument.
pub fn kinds(registry: &Registry) -> Vec<KindFact> {
    let field = |f: &FieldSpec| {
        let accepts = Class::ALL.iter().filter(|c| **c != Class::Any && f.class.accepts(**c));
        ArgumentFact {
            name: f.name,
            help: f.help,
            class: f.class.name(),
            accepts: accepts.map(|c| c.name()).collect(),
            many: f.many,
            least: f.min_items,
            required: f.default.is_none(),
            default: match f.default {
                Some(DefaultValue::Number(x)) => number(x),
                Some(DefaultValue::Text(text)) => json!(text),
                _ => Value::Null,
            },
            words: if f.class == Class::Text { quoted(f.help) } else { Vec::new() },
        }
    };
    let also = |row: &Row| {
        let words = row.doc.lines().find_map(|l| l.trim().strip_prefix("Also looked for as: "));
        words.map(str::to_string)
    };
    let kind = |row: &Row| KindFact {
        name: row.name.to_string(),
        class: row.class.name(),
        about: row.summary().to_string(),
        also: also(row),
        fields: row.fields.iter().map(field).collect(),
    };
    registry.rows().filter(|r| r.kind).map(|r| kind(r)).collect()
}

/// The words in double quotes in a help text: the permitted values of a text argument.
fn quoted(help: &'static str) -> Vec<&'static str> {
    help.split('"').skip(1).step_by(2).collect()
}

/// An argument in the text: its position and spelling, or the position where it can be inserted.
/// Null for model files and for objects that share their statement with others.
fn written(document: &Document, text: &str, object: &str, field: &str) -> Value {
    match document.argument_place(object, field) {
        Some(ArgumentInText::Written(span)) => {
            let spelled = text.get(span.start as usize..span.end as usize);
            json!({"place": place(document, text, span), "text": spelled})
        }
        Some(ArgumentInText::After(span)) => {
            let at = unit(text, span.end as usize);
            json!({"place": [at, at], "text": null})
        }
        None => Value::Null,
    }
}

/// All details of an object.
pub fn inspected(
    document: &mut Document,
    text: &str,
    name: &str,
    by: Option<&str>,
) -> Option<Value> {
    let declared = document.declaration(name).map(|span| place(document, text, span));
    let settable = own_numbers(document, name);
    let graph = document.graph();
    let object = graph.get(graph.find(name)?)?;
    let called = |key: &moldloft_num::trace::Key| Some(graph.get(*key)?.name.to_string());
    let mut fields = Vec::new();
    for (field, arg) in object.row.fields.iter().zip(&object.args) {
        let base = format!("{name}.{}", field.name);
        let mut numbers = Vec::new();
        for path in settable
            .iter()
            .filter(|p| **p == base || p.strip_prefix(&*base).is_some_and(|r| r.starts_with('.')))
        {
            if let Some((value, range)) = document.number_state(path) {
                let range = range.map(|(a, b)| [a, b]);
                numbers.push(json!({"path": path, "value": value, "range": range}));
            }
        }
        let mut objects = Vec::new();
        arg.for_each_object(&mut |key| objects.extend(called(&key)));
        fields.push(json!({
            "name": field.name,
            "help": field.help,
            "class": field.class.name(),
            "unit": if field.unit == Unit::Angle { "rad" } else { "" },
            "value": match arg {
                Quantity::Unset => Value::Null,
                _ if objects.is_empty() => quantity(arg),
                _ => Value::Null,
            },
            "objects": objects,
            "numbers": numbers,
            "words": if field.class == Class::Text { quoted(field.help) } else { Vec::new() },
            "switch": field.class == Class::Integer && (field.min, field.max) == (Some(0.0), Some(1.0)),
            "written": written(document, text, name, field.name),
        }));
    }
    let (members, is_point): (&[&str], bool) = match object.value() {
        Some(Quantity::Point(_)) => (&["t", "u", "v"], true),
        Some(Quantity::Curve(_)) => (&["length"], false),
        Some(Quantity::Surface(_)) => (&["area", "volume"], false),
        Some(Quantity::Body(_)) => (&["area", "volume", "centroid"], false),
        Some(Quantity::Number(_) | Quantity::Vector(_)) => (&[], true),
        _ => (&[], false),
    };
    let report = json!({
        "name": name,
        "kind": object.row.name,
        "class": object.value().map_or(object.row.class, Quantity::class).name(),
        "about": object.row.summary(),
        "failure": object.fault().map(|f| f.message.to_string()),
        "waits": object.blocked_by().as_ref().and_then(called),
        "shown": object.head.shown(),
        "fields": fields,
        "parents": object.parents.iter().filter_map(called).collect::<Vec<_>>(),
        "children": object.children.iter().filter_map(called).collect::<Vec<_>>(),
        "declared": declared,
    });
    let mut expressions: Vec<String> = members.iter().map(|m| format!("{name}.{m}")).collect();
    if is_point {
        expressions.insert(0, name.to_string());
    }
    let mut values = values(document, &expressions, by);
    values.retain(|fact| fact.error.is_none());
    let mut report = report;
    report["values"] = json_of(values);
    Some(report)
}
