//! From a program to a model file of the objects that it makes: computed numbers as numbers.

use crate::model_file::names::{is_layer, plain_name, spelled, system_name};
use crate::model_file::to_program::{RELABEL, VERBATIM, is_legacy, planes};
use crate::model_file::{header, panel_attributes};
use crate::source::env::Evaluation;
use crate::source::module::Module;
use moldloft_diag::Diagnostic;
use moldloft_model::Object;
use moldloft_registry::{Attributes, Class, FieldSpec, Role, Value};
use std::fmt::Write;

/// The version of model files made from programs that do not come from one.
const VERSION: &str = "1.44";

/// The model file of the objects that a program, the main module of a run, made.
///
/// # Errors
/// Which objects a model file cannot hold.
pub fn to_model_file(
    main: &Module,
    evaluation: &Evaluation<f64>,
) -> Result<String, Vec<Diagnostic>> {
    ToModelFile::new(main, evaluation).text()
}

/// True when a layer is among the attributes, outside the parentheses of the others.
fn tells_layer(attributes: &str) -> bool {
    let depth = |text: &str| text.matches('(').count() as i64 - text.matches(')').count() as i64;
    attributes.match_indices("A:Layer(").any(|(at, _)| depth(&attributes[..at]) == 0)
}

/// The planes of a header line.
fn letters(rest: &str) -> String {
    rest.chars().filter(|c| matches!(c, 'x' | 'y' | 'z')).collect()
}

/// From a program.
struct ToModelFile<'a> {
    module: &'a Module,
    evaluation: &'a Evaluation<f64>,
    legacy: bool,
    version: String,
    out: String,
    relabel: Option<String>,
    trailer: String,
    errors: Vec<Diagnostic>,
}

impl<'a> ToModelFile<'a> {
    fn new(module: &'a Module, evaluation: &'a Evaluation<f64>) -> Self {
        let version = header::text(&evaluation.graph, "version");
        let version = if version.is_empty() { VERSION.to_string() } else { version };
        Self {
            module,
            evaluation,
            legacy: is_legacy(&version),
            version,
            out: String::new(),
            relabel: None,
            trailer: String::new(),
            errors: Vec::new(),
        }
    }

    fn text(mut self) -> Result<String, Vec<Diagnostic>> {
        self.header();
        let program = &self.module.program;
        let statements = &program[program.body()];
        let ends = statements.iter().map(|id| program[*id].span);
        let mut from = 0;
        // The text between the statements: what stands before each, and after the last.
        let mut gaps: Vec<(usize, &str)> = Vec::with_capacity(statements.len() + 1);
        for span in ends {
            let start = (span.start as usize).max(from);
            gaps.push((span.end as usize, &program.text()[from..start]));
            from = start.max(span.end as usize);
        }
        let last = &program.text()[from..];
        let mut next = 0;
        let mut headers = 0;
        for object in self.evaluation.graph.objects() {
            let origin = self.evaluation.env.origins.get(object.origin as usize);
            if let Some(origin) = origin.filter(|o| o.module == 0) {
                let start = program[origin.stmt].span.start as usize;
                while let Some((_, gap)) = gaps.get(next)
                    && (next == 0 || gaps[next - 1].0 <= start)
                {
                    self.gap(gap);
                    next += 1;
                }
            }
            if object.row.role == Role::Header {
                headers += 1;
                if headers > 1 {
                    self.refuse(object, "a second header", "a model file has one header");
                }
                continue;
            }
            self.object(object);
        }
        for (_, gap) in &gaps[next..] {
            self.gap(gap);
        }
        self.gap(last);
        self.out += "EndModel;\n";
        let trailer = std::mem::take(&mut self.trailer);
        self.out += &trailer;
        if self.errors.is_empty() { Ok(self.out) } else { Err(self.errors) }
    }

    fn header(&mut self) {
        let graph = &self.evaluation.graph;
        let symmetry = header::text(graph, "symmetry");
        let units = header::text(graph, "units");
        let object = graph.objects().find(|o| o.row.role == Role::Header);
        let lines = object.and_then(|o| o.args.get(o.row.field("lines")?));
        let lines: Vec<String> = match lines {
            Some(Value::List(items)) => items.iter().filter_map(text_of).collect(),
            _ => Vec::new(),
        };
        let first = lines.iter().find(|line| line.starts_with("MultiSurf "));
        let has = |key: &str| lines.iter().any(|line| line.starts_with(key));
        let told = has("Symmetry:") || first.is_some_and(|line| line.contains('/'));
        let out = &mut self.out;
        match first {
            Some(line) => *out += line,
            None => {
                let _ = write!(out, "MultiSurf {}", self.version);
                if self.legacy && !symmetry.is_empty() && !told {
                    let _ = write!(out, " /{symmetry}");
                }
            }
        }
        out.push('\n');
        if !units.is_empty() && !has("Units:") {
            let _ = writeln!(out, "Units: {units}");
        }
        if !self.legacy && !symmetry.is_empty() && !told {
            let _ = writeln!(out, "Symmetry: {}", planes(&symmetry));
        }
        for line in lines.iter().filter(|line| !line.starts_with("MultiSurf ")) {
            // The arguments stand, should they have been changed.
            if line.starts_with("Units:") && !units.is_empty() {
                let _ = writeln!(out, "Units: {units}");
            } else if line.strip_prefix("Symmetry:").is_some_and(|rest| letters(rest) != symmetry)
                && first.is_none()
            {
                let _ = writeln!(out, "Symmetry: {}", planes(&symmetry));
            } else {
                let _ = writeln!(out, "{line}");
            }
        }
        if !self.legacy {
            *out += "BeginModel;\n";
        }
    }

    /// The comments and empty lines between two statements.
    fn gap(&mut self, gap: &str) {
        let lines: Vec<&str> = gap.split('\n').collect();
        // The first piece is the rest of a statement's own line, the last the blanks before one.
        let between = 1..lines.len().saturating_sub(1);
        for (k, line) in lines.iter().enumerate() {
            match line.find('#') {
                Some(at) => self.comment(line[at..].trim_end()),
                None if between.contains(&k) && !self.out.ends_with("\n\n") => self.out.push('\n'),
                None => {}
            }
        }
    }

    fn comment(&mut self, text: &str) {
        if let Some(name) = text.strip_prefix(RELABEL) {
            self.relabel = Some(name.trim().to_string());
        } else if let Some(line) = text.strip_prefix("#ms2-trailer") {
            self.trailer += line.strip_prefix(' ').unwrap_or(line);
            self.trailer.push('\n');
        } else if text == VERBATIM.trim_end() {
            self.out.push('\n');
        } else if let Some(line) = text.strip_prefix(VERBATIM) {
            self.out += line;
            self.out.push('\n');
        } else {
            let rest = &text[1..];
            let blank =
                rest.starts_with(|c: char| c.is_alphanumeric() || matches!(c, '_' | ':' | '#'));
            let _ = writeln!(self.out, "Rem{}{rest}", if blank { " " } else { "" });
        }
    }

    fn refuse(&mut self, object: &Object<f64>, found: &str, help: &str) {
        let message =
            format!("{} `{}` cannot be written to a model file", object.row.name, object.name);
        let diagnostic = Diagnostic::error("not-in-model-files", message)
            .found(found)
            .help(help)
            .object(&*object.name);
        let origin = self.evaluation.env.origins.get(object.origin as usize);
        self.errors.push(match origin.filter(|o| o.module == 0) {
            Some(origin) => diagnostic.at(self.module.program[origin.stmt].span),
            None => diagnostic,
        });
    }

    fn object(&mut self, object: &Object<f64>) {
        let row = &*object.row;
        let Some(columns) = row.columns else {
            self.refuse(object, "a kind that model files do not know", "keep the model in .sdl");
            return;
        };
        let mut line = format!("{} {}", row.name, plain_name(&object.name));
        line += &self.head(&object.head, row.class);
        let relabel = self.relabel.take();
        let mut columns: Vec<&str> = columns.split_ascii_whitespace().collect();
        let own = row.field("relabel").filter(|_| row.class.dimension() > Some(0));
        let set = own.filter(|at| !matches!(object.args[*at], Value::Unset));
        if columns.first() != Some(&"relabel") {
            if set.is_some() {
                columns.insert(0, "relabel");
            } else if let Some(relabel) = &relabel {
                line = format!("{line} {relabel}");
            }
        }
        for column in &columns {
            line.push(' ');
            let Some(at) = row.field(column).filter(|at| own != Some(*at) || set.is_some()) else {
                line += relabel.as_deref().unwrap_or("*");
                continue;
            };
            match self.value(&row.fields[at], &object.args[at]) {
                Ok(text) => line += &text,
                Err(found) => {
                    let help = format!(
                        "declare `{}` as an object of its own and give its name here",
                        row.fields[at].name
                    );
                    self.refuse(object, found, &help);
                    return;
                }
            }
        }
        for (field, arg) in row.fields.iter().zip(&object.args) {
            let usual = field.default.is_some_and(|d| d.value().same(arg));
            if !columns.contains(&field.name) && !usual {
                let found = format!("`{}`, which model files have no column for", field.name);
                self.refuse(object, &found, "leave it out, or keep the model in .sdl");
                return;
            }
        }
        self.out += &line;
        self.out += ";\n";
    }

    fn head(&self, head: &Attributes, class: Class) -> String {
        let mut out = format!(" {} {}", head.colour, head.visible);
        // 0 leaves a count to the neighbours.
        let ([mut nu, mut nv], [mu, mv]) = (head.divisions, head.subdivisions);
        if let Some(panels) = head.panels.as_ref().filter(|_| !head.divided) {
            // A size counts where no number is stated.
            nu = if panels.size[0].is_some() { 0 } else { nu };
            nv = if panels.size[1].is_some() { 0 } else { nv };
        }
        let _ = match class.dimension() {
            Some(1) if self.legacy && mu == Attributes::of(class).subdivisions[0] => {
                write!(out, " {nu}")
            }
            Some(1) => write!(out, " {nu}x{mu}"),
            Some(2) if self.legacy => write!(out, " {nu} {mu} {nv} {mv} {}", head.orientation),
            Some(2) => write!(out, " {nu}x{mu} {nv}x{mv} {}", head.orientation),
            _ => Ok(()),
        };
        let attributes = head.attributes.as_deref().unwrap_or("");
        let layer = format!("A:Layer({})", head.layer);
        if is_layer(&layer) && !tells_layer(attributes) {
            let _ = write!(out, " {layer}");
        }
        if let Some(panels) = &head.panels {
            out += &panel_attributes::written(panels);
        }
        if !attributes.is_empty() {
            let _ = write!(out, " {attributes}");
        }
        if !self.legacy {
            out += " /";
        }
        out
    }

    /// The argument as a column, or what it is when no column can hold that.
    fn value(&self, field: &FieldSpec, value: &Value<f64>) -> Result<String, &'static str> {
        let list = |items: Vec<String>| {
            let items: Vec<String> = items.into_iter().map(|item| item + " ").collect();
            format!("{{ {}}}", items.concat())
        };
        match value {
            Value::Unset => Ok("*".into()),
            Value::Number(x) => Ok(spelled(*x, field.unit)),
            Value::Text(text) => Ok(self.word(field, text)),
            Value::Object(key) => {
                let object = self.evaluation.graph.get(*key);
                Ok(object.map_or("*".into(), |o| plain_name(&o.name)))
            }
            Value::List(items) if field.many => {
                let items: Result<Vec<_>, _> = items.iter().map(|v| self.value(field, v)).collect();
                Ok(list(items?))
            }
            Value::Vector(v) if field.many && is_number(field.class) => {
                Ok(list(v.to_array().map(|x| spelled(x, field.unit)).into()))
            }
            Value::Numbers(a) if field.many && is_number(field.class) => {
                Ok(list(a.items.iter().map(|x| spelled(*x, field.unit)).collect()))
            }
            other => Err(match other.class() {
                Class::Any => "a value without a name",
                class => class.with_article(),
            }),
        }
    }

    fn word(&self, field: &FieldSpec, text: &str) -> String {
        let name = format!("*{}", text.trim_start_matches('*').replace(' ', "").to_uppercase());
        if field.class != Class::Text && system_name(&name).is_some() {
            return name;
        }
        let word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if text.starts_with(|c: char| c.is_ascii_alphabetic()) && text.chars().all(word) {
            text.to_string()
        } else {
            format!("\"{text}\"")
        }
    }
}

fn is_number(class: Class) -> bool {
    matches!(class, Class::Number | Class::Integer)
}

fn text_of(value: &Value<f64>) -> Option<String> {
    match value {
        Value::Text(text) => Some(text.to_string()),
        _ => None,
    }
}
