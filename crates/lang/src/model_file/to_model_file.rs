//! Conversion of a program to a model file of its objects, with computed numbers as numbers.

use crate::World;
use crate::model_file::header;
use crate::model_file::names::{is_layer, plain_name, spelled, system_name};
use crate::model_file::panel_attributes;
use crate::model_file::relations::{NumberForm, Relations};
use crate::model_file::reread;
use crate::model_file::to_program::{ENTITY, ORDER, RELABEL, VERBATIM, is_legacy, planes};
use crate::source::env::Evaluation;
use crate::source::module::Module;
use moldloft_diag::Diagnostic;
use moldloft_model::Object;
use moldloft_registry::{Attributes, Class, FieldSpec, Registry, Role, Unit, Value};
use moldloft_syntax::model_file::ARGUMENT;
use moldloft_syntax::sdl::{StmtId, StmtKind};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::fmt::Write;

/// The version of model files made from programs that do not come from one.
const VERSION: &str = "1.44";

/// Prefix of the program's comments in a model file.
const OWN_REMARK: &str = "Rem Moldloft: ";

/// Maximum number of names in a comment; others are counted.
const LISTED: usize = 5;

/// The entities whose columns are known from MultiSurf's own files or from readers of them.
const KNOWN_COLUMNS: [&str; 26] = [
    "AbsBead",
    "AbsMagnet",
    "AbsPoint",
    "AbsRing",
    "Arc",
    "BCurve",
    "BLoftSurf",
    "BSubSnake",
    "CLoftSurf",
    "Conic",
    "CopyCurve",
    "CopySurf",
    "DevSurf",
    "FramePoint",
    "Line",
    "MirrCurve",
    "MirrPoint",
    "MirrSurf",
    "PolyCurve",
    "RelBead",
    "RevSurf",
    "RuledSurf",
    "SubCurve",
    "SubSnake",
    "XContours",
    "ZContours",
];

/// The text of a model file, and the parts of the program that it does not contain.
pub struct ModelFileText {
    /// The text.
    pub text: String,
    /// Numbers that lost their relation to parameters.
    pub remarks: Vec<Diagnostic>,
}

/// The model file of the objects declared by the main module of a run. The text is read back, and
/// its objects are compared with those of the program.
///
/// # Errors
/// Objects that a model file cannot represent.
pub fn to_model_file(
    main: &Module,
    evaluation: &Evaluation<f64>,
    registry: &Registry,
    world: &dyn World,
) -> Result<ModelFileText, Vec<Diagnostic>> {
    // Objects whose expressions say something else in the file.
    let mut fixed = HashSet::new();
    loop {
        let written = ToModelFile::new(main, evaluation, &fixed).text()?;
        let differing =
            reread::differences(&written.text, evaluation, registry, (world, &main.path));
        let before = fixed.len();
        fixed.extend(differing.iter().map(|(name, _)| name.clone()));
        if differing.is_empty() {
            return Ok(written);
        }
        if fixed.len() == before {
            let writer = ToModelFile::new(main, evaluation, &fixed);
            return Err(differing.iter().map(|(name, why)| writer.unlike(name, why)).collect());
        }
    }
}

/// True when a layer is among the attributes, outside the parentheses of the others.
fn tells_layer(attributes: &str) -> bool {
    let depth = |text: &str| text.matches('(').count() as i64 - text.matches(')').count() as i64;
    attributes.match_indices("A:Layer(").any(|(at, _)| depth(&attributes[..at]) == 0)
}

/// A line of the file with the text before it.
struct FileLine {
    before: String,
    name: String,
    text: String,
    /// A variable or formula, kept where it is used.
    real: bool,
}

/// Appends a text; of the empty lines around an omitted part one is kept.
fn append(text: &mut String, mut before: &str) {
    while text.ends_with("\n\n") && before.starts_with('\n') {
        before = &before[1..];
    }
    *text += before;
}

/// The planes of a header line.
fn letters(rest: &str) -> String {
    rest.chars().filter(|c| matches!(c, 'x' | 'y' | 'z')).collect()
}

/// Conversion of a program.
struct ToModelFile<'a> {
    module: &'a Module,
    evaluation: &'a Evaluation<f64>,
    relations: Relations<'a>,
    /// Objects whose relations cannot be kept.
    fixed: &'a HashSet<String>,
    legacy: bool,
    /// True if the program was converted from a model file.
    returning: bool,
    version: String,
    head: String,
    chunks: Vec<FileLine>,
    /// Text before the next object.
    before: String,
    relabel: Option<String>,
    entity: Option<String>,
    /// The names in the order of the file that it was.
    order: Vec<String>,
    trailer: String,
    /// Objects with numbers that do not follow the parameters in the file.
    computed: Vec<String>,
    /// Statements that are not objects of the file.
    left_out: Vec<String>,
    errors: Vec<Diagnostic>,
}

impl<'a> ToModelFile<'a> {
    fn new(
        module: &'a Module,
        evaluation: &'a Evaluation<f64>,
        fixed: &'a HashSet<String>,
    ) -> Self {
        let version = header::text(&evaluation.graph, "version");
        let returning = !version.is_empty();
        let version = if returning { version } else { VERSION.to_string() };
        Self {
            module,
            evaluation,
            relations: Relations::new(module, evaluation),
            fixed,
            legacy: is_legacy(&version),
            returning,
            version,
            head: String::new(),
            chunks: Vec::new(),
            before: String::new(),
            relabel: None,
            entity: None,
            order: Vec::new(),
            trailer: String::new(),
            computed: Vec::new(),
            left_out: Vec::new(),
            errors: Vec::new(),
        }
    }

    fn text(mut self) -> Result<ModelFileText, Vec<Diagnostic>> {
        self.header();
        let program = &self.module.program;
        let statements = &program[program.body()];
        let mut from = 0;
        // Each statement with the text before it.
        let mut gaps: Vec<(u32, u32, &str)> = Vec::with_capacity(statements.len());
        for span in statements.iter().map(|id| program[*id].span) {
            let start = (span.start as usize).max(from);
            gaps.push((span.start, span.end, &program.text()[from..start]));
            from = start.max(span.end as usize);
        }
        let last = &program.text()[from..];
        let mut next = 0;
        let mut headers = 0;
        for object in self.evaluation.graph.objects() {
            let origin = self.evaluation.env.origins.get(object.origin as usize);
            if let Some(origin) = origin.filter(|o| o.module == 0) {
                let start = program[origin.stmt].span.start;
                while let Some((own_start, _, gap)) = gaps.get(next)
                    && (next == 0 || gaps[next - 1].1 <= start)
                {
                    self.gap(gap);
                    self.reals(*own_start);
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
            if object.row.role == Role::SolveSet && !self.returning {
                // Its unknowns are at their solution; nobody solves it there.
                self.left_out.push(format!("SolveSet `{}`", object.name));
                continue;
            }
            self.object(object);
        }
        for (start, _, gap) in &gaps[next..] {
            self.gap(gap);
            self.reals(*start);
        }
        self.gap(last);
        if !self.errors.is_empty() {
            return Err(self.errors);
        }
        Ok(self.finished())
    }

    /// The chunks in the order of the file that they came from, if they came from one.
    fn finished(mut self) -> ModelFileText {
        let used: HashSet<String> = self.relations.used_reals();
        for chunk in self.chunks.iter_mut().filter(|chunk| chunk.real) {
            if !(self.returning || used.contains(&chunk.name)) {
                chunk.text.clear();
            }
        }
        if !self.order.is_empty() {
            let places: HashMap<&str, usize> =
                self.order.iter().enumerate().map(|(k, name)| (&**name, k)).collect();
            let mut place = 0;
            let mut keyed: Vec<(usize, FileLine)> = Vec::with_capacity(self.chunks.len());
            for chunk in std::mem::take(&mut self.chunks) {
                // New objects keep their position after their predecessor.
                place = places.get(&*chunk.name).copied().unwrap_or(place);
                keyed.push((place, chunk));
            }
            keyed.sort_by_key(|(place, _)| *place);
            self.chunks = keyed.into_iter().map(|(_, chunk)| chunk).collect();
        }
        let mut text = std::mem::take(&mut self.head);
        if !self.returning {
            text += &self.own_remarks();
        }
        for chunk in &self.chunks {
            append(&mut text, &chunk.before);
            text += &chunk.text;
        }
        append(&mut text, &self.before);
        while text.ends_with("\n\n") {
            text.pop();
        }
        text += "EndModel;\n";
        text += &self.trailer;
        let mut remarks = match self.computed.len() {
            0 => Vec::new(),
            _ if self.evaluation.env.params.is_empty() => Vec::new(),
            _ => vec![Diagnostic::warning("numbers-fixed", self.fixed_numbers()).help(
                "a model file keeps parameters, objects and variables that are assigned \
                    once in the main program, not values computed by a routine or a loop",
            )],
        };
        if let Some(message) = self.left_out_message() {
            let help = "solve conditions, and check what must hold, in the program";
            remarks.push(Diagnostic::warning("left-out", message).help(help));
        }
        ModelFileText { text, remarks }
    }

    /// Message about omitted parts.
    fn left_out_message(&self) -> Option<String> {
        let mut parts = self.left_out.clone();
        let program = &self.module.program;
        let checks = (0..program.stmt_count() as u32).map(StmtId);
        let asserts =
            checks.filter(|id| matches!(program[*id].kind, StmtKind::Assert { .. })).count();
        match asserts {
            0 => {}
            1 => parts.push("an assertion".to_string()),
            many => parts.push(format!("{many} assertions")),
        }
        let body = &program[program.body()];
        let chosen = |id: &&StmtId| matches!(program[**id].kind, StmtKind::If { .. });
        if !self.evaluation.env.params.is_empty() && body.iter().any(|id| chosen(&id)) {
            parts.push("conditions (the branch that is taken now is written)".to_string());
        }
        (!parts.is_empty()).then(|| format!("a model file cannot hold {}", parts.join(", ")))
    }

    fn fixed_numbers(&self) -> String {
        let names = &self.computed;
        let shown = names[..names.len().min(LISTED)].join(", ");
        let more = match names.len().saturating_sub(LISTED) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let objects = if names.len() == 1 { "1 object has" } else { "objects have" };
        let count = if names.len() == 1 { String::new() } else { format!("{} ", names.len()) };
        format!(
            "{count}{objects} computed numbers that no longer follow the parameters: {shown}{more}"
        )
    }

    /// Comments about objects that MultiSurf does not have.
    fn own_remarks(&self) -> String {
        let mut out = String::new();
        let graph = &self.evaluation.graph;
        let ours: BTreeSet<&str> = graph
            .objects()
            .filter(|o| !matches!(o.row.role, Role::Header | Role::SolveSet))
            .filter(|o| !KNOWN_COLUMNS.contains(&&*o.row.name))
            .map(|o| &*o.row.name)
            .collect();
        if !ours.is_empty() {
            let names = ours.into_iter().collect::<Vec<_>>().join(", ");
            let _ = writeln!(out, "{OWN_REMARK}the columns of these entities are its own: {names}");
        }
        if self.chunks.iter().any(|chunk| chunk.text.contains(ARGUMENT)) {
            let text = "arguments that have no column are attributes of its own, by their names";
            let _ = writeln!(out, "{OWN_REMARK}{text}");
        }
        if !self.computed.is_empty() && !self.evaluation.env.params.is_empty() {
            let _ = writeln!(out, "{OWN_REMARK}{}", self.fixed_numbers());
        }
        if let Some(message) = self.left_out_message() {
            let _ = writeln!(out, "{OWN_REMARK}{message}");
        }
        out
    }

    /// The variables and formulas of the statement that begins there.
    fn reals(&mut self, start: u32) {
        for (name, text) in self.relations.reals_at(start) {
            let before = std::mem::take(&mut self.before);
            self.chunks.push(FileLine { before, name, text, real: true });
        }
    }

    /// The diagnostic of an object that the text makes otherwise.
    fn unlike(&self, name: &str, why: &str) -> Diagnostic {
        Diagnostic::error(
            "not-in-model-files",
            format!("`{name}` cannot be written to a model file"),
        )
        .found(why)
        .object(name)
        .help("keep the model in .sdl")
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
        let stated = has("Symmetry:") || first.is_some_and(|line| line.contains('/'));
        let out = &mut self.head;
        match first {
            Some(line) => *out += line,
            None => {
                let _ = write!(out, "MultiSurf {}", self.version);
                if self.legacy && !symmetry.is_empty() && !stated {
                    let _ = write!(out, " /{symmetry}");
                }
            }
        }
        out.push('\n');
        if !units.is_empty() && !has("Units:") {
            let _ = writeln!(out, "Units: {units}");
        }
        if !self.legacy && !symmetry.is_empty() && !stated {
            let _ = writeln!(out, "Symmetry: {}", planes(&symmetry));
        }
        for line in lines.iter().filter(|line| !line.starts_with("MultiSurf ")) {
            // The header's arguments take precedence, since they may have been changed.
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
            self.head += "BeginModel;\n";
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
                None if between.contains(&k)
                    && self.before != "\n"
                    && !self.before.ends_with("\n\n") =>
                {
                    self.before.push('\n');
                }
                None => {}
            }
        }
    }

    fn comment(&mut self, text: &str) {
        if let Some(name) = text.strip_prefix(RELABEL) {
            self.relabel = Some(name.trim().to_string());
        } else if let Some(entity) = text.strip_prefix(ENTITY) {
            self.entity = Some(entity.trim().to_string());
        } else if let Some(names) = text.strip_prefix(ORDER) {
            self.order.extend(names.split_whitespace().map(str::to_string));
        } else if let Some(line) = text.strip_prefix("#ms2-trailer") {
            self.trailer += line.strip_prefix(' ').unwrap_or(line);
            self.trailer.push('\n');
        } else if text == VERBATIM.trim_end() {
            self.before.push('\n');
        } else if let Some(line) = text.strip_prefix(VERBATIM) {
            self.verbatim(line);
        } else {
            let rest = &text[1..];
            let blank =
                rest.starts_with(|c: char| c.is_alphanumeric() || matches!(c, '_' | ':' | '#'));
            let _ = writeln!(self.before, "Rem{}{rest}", if blank { " " } else { "" });
        }
    }

    /// A line of the file that the program is from: a comment, or part of an object of a kind that is not ours.
    fn verbatim(&mut self, line: &str) {
        self.before += line;
        self.before.push('\n');
        // An object ends with its line; its name is the second word of its first.
        let first =
            self.before.lines().rfind(|l| !l.starts_with([' ', '\t', '#']) && !l.is_empty());
        if !line.starts_with('#')
            && line.ends_with(';')
            && let Some(name) = first.and_then(|l| l.split_whitespace().nth(1)).map(str::to_string)
        {
            let text = std::mem::take(&mut self.before);
            self.chunks.push(FileLine { before: String::new(), name, text, real: false });
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
        let entity = self.entity.take().unwrap_or_else(|| row.name.to_string());
        let relabel = self.relabel.take();
        let mut columns: Vec<&str> = row.columns.unwrap_or("").split_ascii_whitespace().collect();
        let own = row.field("relabel").filter(|_| row.class.dimension() > Some(0));
        let set = own.filter(|at| !matches!(object.args[*at], Value::Unset));
        let mut given_relabel = None;
        if columns.first() != Some(&"relabel") {
            if set.is_some() {
                columns.insert(0, "relabel");
            } else {
                given_relabel = relabel.as_deref();
            }
        }
        let mut computed = false;
        let mut data = given_relabel.map_or(String::new(), |word| format!(" {word}"));
        for column in &columns {
            data.push(' ');
            let Some(at) = row.field(column).filter(|at| own != Some(*at) || set.is_some()) else {
                data += relabel.as_deref().unwrap_or("*");
                continue;
            };
            match self.argument(object, at, false, &mut computed) {
                Some(text) => data += &text,
                None => return,
            }
        }
        let mut named = String::new();
        for (at, field) in row.fields.iter().enumerate() {
            let usual = field.default.is_some_and(|d| d.value().same(&object.args[at]));
            // The points of a table stay in its file.
            let of_file = row.role == Role::Table
                && field.name == "points"
                && row.field("file").is_some_and(|file| is_text(&object.args[file]));
            if of_file {
                continue;
            }
            if !columns.contains(&field.name) && !usual {
                match self.argument(object, at, true, &mut computed) {
                    Some(text) => {
                        let _ = write!(named, " {ARGUMENT}({} {text})", field.name);
                    }
                    None => return,
                }
            }
        }
        if computed {
            self.computed.push(object.name.to_string());
        }
        let head = self.head(&object.head, row.class);
        let slash = if self.legacy { "" } else { " /" };
        let name = plain_name(&object.name);
        let text = format!("{entity} {name}{head}{named}{slash}{data};\n");
        let before = std::mem::take(&mut self.before);
        self.chunks.push(FileLine { before, name, text, real: false });
    }

    /// The text of an argument; `None` when it was refused.
    fn argument(
        &mut self,
        object: &Object<f64>,
        at: usize,
        named: bool,
        computed: &mut bool,
    ) -> Option<String> {
        let field = &object.row.fields[at];
        // If no column of another program determines the class, three numbers may be a point or a
        // vector.
        let vector = match &object.args[at] {
            Value::Vector(v) if named && !is_number(field.class) => Some(v.to_array()),
            _ => None,
        };
        if let Some(v) = vector {
            let items = (0..3).map(|k| self.number(object, at, Some(k), v[k], computed));
            return Some(format!("{{ {} }}", items.collect::<Vec<_>>().join(" ")));
        }
        match self.value(object, at, None, &object.args[at], computed) {
            Ok(text) => Some(text),
            Err(found) => {
                let help = format!(
                    "declare `{}` as an object of its own and give its name here",
                    field.name
                );
                self.refuse(object, found, &help);
                None
            }
        }
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
        // Panels that were left to the neighbours, and cells of solids, cannot be stated in the head.
        let [u, v, w] = head.blocks;
        match class.dimension() {
            Some(2) if !head.divided => {
                let _ = write!(out, " {ARGUMENT}(divisions *)");
            }
            Some(3) if head.divided => {
                let _ = write!(out, " {ARGUMENT}(divisions {{ {u} {v} {w} }})");
            }
            _ => {}
        }
        out
    }

    /// The argument as a column, or a description of its class if no column can represent it.
    fn value(
        &self,
        object: &Object<f64>,
        at: usize,
        item: Option<usize>,
        value: &Value<f64>,
        computed: &mut bool,
    ) -> Result<String, &'static str> {
        let field = &object.row.fields[at];
        let list = |items: Vec<String>| {
            let items: Vec<String> = items.into_iter().map(|item| item + " ").collect();
            format!("{{ {}}}", items.concat())
        };
        let numbers = |items: &[f64], computed: &mut bool| {
            let items = items.iter().enumerate();
            list(items.map(|(k, x)| self.number(object, at, Some(k), *x, computed)).collect())
        };
        match value {
            Value::Unset => Ok("*".into()),
            Value::Number(x) => Ok(self.number(object, at, item, *x, computed)),
            Value::Text(text) => Ok(self.word(field, text)),
            Value::Object(key) => {
                let object = self.evaluation.graph.get(*key);
                Ok(object.map_or("*".into(), |o| plain_name(&o.name)))
            }
            Value::List(items) if field.many => {
                let items = items.iter().enumerate();
                let items: Result<Vec<_>, _> =
                    items.map(|(k, v)| self.value(object, at, Some(k), v, computed)).collect();
                Ok(list(items?))
            }
            Value::Vector(v) if field.many && is_number(field.class) => {
                Ok(numbers(&v.to_array(), computed))
            }
            Value::Numbers(a) if field.many && is_number(field.class) => {
                Ok(numbers(&a.items, computed))
            }
            other => Err(match other.class() {
                Class::Any => "a value without a name",
                class => class.with_article(),
            }),
        }
    }

    /// A number as a relation where it is one, else as it is.
    fn number(
        &self,
        object: &Object<f64>,
        at: usize,
        item: Option<usize>,
        x: f64,
        computed: &mut bool,
    ) -> String {
        let unit: Unit = object.row.fields[at].unit;
        if self.fixed.contains(&*object.name) {
            *computed = true;
            return spelled(x, unit);
        }
        match self.relations.number(object, at, item, unit) {
            NumberForm::Relation(text) => text,
            NumberForm::Constant => spelled(x, unit),
            NumberForm::Computed => {
                *computed = true;
                spelled(x, unit)
            }
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

/// True for a text with letters.
fn is_text(value: &Value<f64>) -> bool {
    matches!(value, Value::Text(text) if !text.is_empty())
}

fn text_of(value: &Value<f64>) -> Option<String> {
    match value {
        Value::Text(text) => Some(text.to_string()),
        _ => None,
    }
}
