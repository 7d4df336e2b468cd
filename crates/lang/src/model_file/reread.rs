//! A written model file, read again: whether it makes the objects of the program.

use crate::World;
use crate::model_file::alone::run_alone;
use crate::model_file::names::plain_name;
use crate::model_file::source::ModelFileSource;
use crate::source::env::Evaluation;
use moldloft_diag::{Diagnostic, Sources};
use moldloft_model::{Graph, Object};
use moldloft_registry::{Registry, Role, Unit, Value};

/// Tolerance of an angle written in degrees, relative.
const ANGLE_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The objects that the text makes otherwise or not at all, each with how; files are read as from `path`.
pub(super) fn differences(
    text: &str,
    evaluation: &Evaluation<f64>,
    registry: &Registry,
    (world, path): (&dyn World, &str),
) -> Vec<(String, String)> {
    let mut sources = Sources::new();
    let file = sources.add(path, text);
    let (source, mut found) = ModelFileSource::parse(text.to_string(), file);
    let mut again = Evaluation::default();
    run_alone(&source, world, &mut sources, registry, &mut again, &mut found);
    let graph = &evaluation.graph;
    let mut differing = Vec::new();
    let written = |o: &&Object<f64>| !matches!(o.row.role, Role::Header | Role::SolveSet);
    for object in graph.objects().filter(written) {
        let name = plain_name(&object.name);
        let made = again.graph.find(&name).and_then(|key| again.graph.get(key));
        let why = match made {
            Some(made) => unlike(graph, object, &again.graph, made),
            None => Some(cause(&found, &name)),
        };
        differing.extend(why.map(|why| (object.name.to_string(), why)));
    }
    differing
}

/// Why an object was not made.
fn cause(found: &[Diagnostic], name: &str) -> String {
    let own = found.iter().find(|d| d.object.as_deref() == Some(name));
    let first = own.or_else(|| found.iter().find(|d| d.is_error()));
    first.map_or("it does not read back".to_string(), |d| d.message.clone())
}

fn unlike(
    graph: &Graph<f64>,
    object: &Object<f64>,
    again: &Graph<f64>,
    made: &Object<f64>,
) -> Option<String> {
    if object.row.name != made.row.name {
        return Some(format!("it reads back as {}", made.row.name));
    }
    for (k, field) in object.row.fields.iter().enumerate() {
        let angle = field.unit == Unit::Angle;
        if !same((graph, &object.args[k]), (again, &made.args[k]), angle) {
            return Some(format!("`{}` reads back otherwise", field.name));
        }
    }
    let (a, b) = (&object.head, &made.head);
    let surface = object.row.class.dimension() == Some(2);
    let divided = a.divisions == b.divisions || a.panels.is_some();
    let alike = a.orientation == b.orientation
        && a.visible == b.visible
        && a.panels == b.panels
        && (!surface || (a.divided == b.divided && divided));
    (!alike).then(|| "its divisions or attributes read back otherwise".to_string())
}

fn same(
    (graph, a): (&Graph<f64>, &Value<f64>),
    (again, b): (&Graph<f64>, &Value<f64>),
    angle: bool,
) -> bool {
    if let (Some(a), Some(b)) = (numbers(a), numbers(b)) {
        let close = |x: f64, y: f64| {
            x.to_bits() == y.to_bits()
                || (x == 0.0 && y == 0.0)
                || (angle && (x - y).abs() <= ANGLE_ROUNDING * x.abs())
        };
        return a.len() == b.len() && a.iter().zip(&b).all(|(x, y)| close(*x, *y));
    }
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => match (graph.get(*a), again.get(*b)) {
            (Some(a), Some(b)) => plain_name(&a.name) == *b.name,
            _ => false,
        },
        (Value::List(x), Value::List(y)) => {
            x.len() == y.len()
                && x.iter().zip(y.iter()).all(|(x, y)| same((graph, x), (again, y), angle))
        }
        (Value::Text(a), Value::Text(b)) => a == b,
        (Value::Unset, Value::Unset) => true,
        _ => false,
    }
}

/// The numbers of a value that consists of numbers alone.
fn numbers(value: &Value<f64>) -> Option<Vec<f64>> {
    match value {
        Value::Number(x) => Some(vec![*x]),
        Value::Vector(v) => Some(v.to_array().to_vec()),
        Value::Numbers(a) => Some(a.items.to_vec()),
        Value::Vectors(a) => Some(a.planes.iter().flatten().copied().collect()),
        Value::List(items) if !items.is_empty() => {
            let number = |v: &Value<f64>| match v {
                Value::Number(x) => Some(*x),
                _ => None,
            };
            items.iter().map(number).collect()
        }
        _ => None,
    }
}
