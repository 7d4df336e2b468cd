//! Between the two forms of a model: programs and model files.
//!
//! A model file becomes a program with one statement an object, in the order of the file (parents
//! first); the way back gives the same objects and numbers. What the language has no words for
//! travels in comments that begin with `#ms2 `. A program becomes a model file of the objects that
//! it makes: computed numbers as numbers.

use crate::document::{Document, Source};
use crate::header;
use crate::model_file::{ModelFileSource, Sorted};
use crate::model_file_names::{
    bare, identifier, is_layer, is_real, plain_name, spelled, system_name,
};
use crate::panel_attributes;
use moldloft_diag::Diagnostic;
use moldloft_model::Object;
use moldloft_registry::{Class, Field, Head, Panels, Spacing, Unit, Value};
use moldloft_syntax::model_file::{Field as Written, FieldKind, ItemKind, Object as Line};
use moldloft_syntax::{number, sdl};
use std::fmt::Write;

/// A line of a model file that is no object of ours stands in a program as a comment.
const VERBATIM: &str = "#ms2 ";

/// The relabel of the object that follows.
const RELABEL: &str = "#ms2-relabel ";

/// How many radians a degree has, as the language spells it.
const RADIANS: &str = "0.017453292519943295";

/// The version of model files made from programs that do not come from one.
const VERSION: &str = "1.44";

/// The forms that a model can be written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A program.
    Sdl,
    /// A MultiSurf model file; the version is that of the header, 1.44 without one.
    ModelFile,
}

impl Document {
    /// The model in the other form, or in canonical text of its own.
    ///
    /// # Errors
    /// What is wrong with the model, or which objects the other form cannot hold.
    ///
    /// # Example
    /// ```
    /// use moldloft_lang::{Document, Format, NoFiles, registry};
    /// let text = "MultiSurf 0.35 /y\nAbsPoint P-1 14 1 0 0 3.6;\nEndModel\n";
    /// let model = Document::from_text(registry(), Box::new(NoFiles), "p.ms2", text);
    /// let program = model.convert(Format::Sdl).unwrap();
    /// assert!(program.ends_with("AbsPoint P_x2d_1(0, 0, 3.6);\n"));
    /// ```
    pub fn convert(&self, to: Format) -> Result<String, Vec<Diagnostic>> {
        let objects = self.graph();
        let stands_in_the_way = |d: &&Diagnostic| {
            let built = d.object.as_deref().is_some_and(|name| objects.find(name).is_some());
            d.is_error() && !built && d.id != "blocked"
        };
        let all = self.text_diagnostics.iter().chain(&self.run_diagnostics);
        let errors: Vec<Diagnostic> = all.filter(stands_in_the_way).cloned().collect();
        if !errors.is_empty() {
            return Err(errors);
        }
        match (&self.source, to) {
            (Source::ModelFile(source), Format::Sdl) => {
                Ok(ToProgram { document: self, source }.text())
            }
            (Source::ModelFile(source), Format::ModelFile) => {
                let model = source.model();
                Ok(model.to_canonical(|line| objects.find(model.slice(line.name)).is_none()))
            }
            (Source::Program, Format::Sdl) => sdl::format(&self.text()),
            (Source::Sketch(sketch), Format::Sdl) => {
                let base = sketch.path.rsplit(['/', '\\']).next().unwrap_or(&sketch.path);
                Ok(format!("load {};\n", quoted(base)))
            }
            (Source::Program | Source::Sketch(_), Format::ModelFile) => {
                ToModelFile::new(self).text()
            }
            (Source::None, _) => Ok(String::new()),
        }
    }
}

/// The named arguments in which a head differs from what its class has by itself.
fn head_arguments(head: &Head, class: Class) -> Vec<String> {
    let usual = Head::of(class);
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

/// What is said of panels besides their number.
fn panel_arguments(panels: &Panels) -> Vec<String> {
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
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

/// The planes as the header spells them: `x y`.
fn planes(symmetry: &str) -> String {
    symmetry.chars().map(String::from).collect::<Vec<_>>().join(" ")
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

fn is_legacy(version: &str) -> bool {
    version.parse::<f64>().is_ok_and(|v| v < 1.0)
}

/// From a model file.
struct ToProgram<'a> {
    document: &'a Document,
    source: &'a ModelFileSource,
}

impl ToProgram<'_> {
    fn text(&self) -> String {
        let model = self.source.model();
        let mut out = self.header();
        // What stands before each object, and after the last: each piece with its place.
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
                // Reported as an error, which stands in the way of converting.
                ItemKind::Unknown => {}
            }
        }
        let registry = self.document.registry();
        let lines = self.source.lines();
        let sorted: Vec<Sorted> = lines.iter().map(|l| self.source.sorted(registry, l)).collect();
        for at in self.source.order(&sorted).0 {
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
            // Where the way back would put them, the arguments tell enough.
            let told = match key {
                _ if told_others || line.key.start > first_other => false,
                "Units" => rest == units && !rest.is_empty(),
                "Symmetry" => !legacy && !symmetry.is_empty() && rest == planes(&symmetry),
                _ => false,
            };
            if !told {
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
        format!("{} {name}({});\n", header::KIND, named.join(", "))
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
        let graph = self.document.graph();
        let object = graph.get(graph.find(name)?).filter(|o| o.origin == at as u32)?;
        let row = sorted.row.as_ref()?;
        let mut out = String::new();
        if let Some(relabel) = &sorted.relabel {
            let _ = writeln!(out, "{RELABEL}{}", model.slice(relabel.span));
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
        let env = &self.document.plain.env;
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

    fn value(&self, field: &Field, written: &Written) -> String {
        let model = self.source.model();
        let text = model.slice(written.span);
        let angle = field.unit == Unit::Angle;
        let real = self.document.plain.env.numbers.contains_key(text);
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

/// From a program.
struct ToModelFile<'a> {
    document: &'a Document,
    legacy: bool,
    version: String,
    out: String,
    relabel: Option<String>,
    trailer: String,
    errors: Vec<Diagnostic>,
}

impl<'a> ToModelFile<'a> {
    fn new(document: &'a Document) -> Self {
        let version = header::text(document.graph(), "version");
        let version = if version.is_empty() { VERSION.to_string() } else { version };
        Self {
            document,
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
        let module = self.document.modules.get(0);
        let program = &module.program;
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
        for object in self.document.graph().objects() {
            let origin = self.document.plain.env.origins.get(object.origin as usize);
            if let Some(origin) = origin.filter(|o| o.module == 0) {
                let start = program[origin.stmt].span.start as usize;
                while let Some((_, gap)) = gaps.get(next)
                    && (next == 0 || gaps[next - 1].0 <= start)
                {
                    self.gap(gap);
                    next += 1;
                }
            }
            if object.row.name == header::KIND {
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
        let graph = self.document.graph();
        let symmetry = header::text(graph, "symmetry");
        let units = header::text(graph, "units");
        let object = graph.objects().find(|o| o.row.name == header::KIND);
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
        let message = format!("{} `{}` cannot stand in a model file", object.row.name, object.name);
        let diagnostic = Diagnostic::error("not-in-model-files", message)
            .found(found)
            .help(help)
            .object(&*object.name);
        let document = self.document;
        let origin = document.plain.env.origins.get(object.origin as usize);
        self.errors.push(match origin.filter(|o| o.module == 0) {
            Some(origin) => diagnostic.at(document.modules.get(0).program[origin.stmt].span),
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

    fn head(&self, head: &Head, class: Class) -> String {
        let mut out = format!(" {} {}", head.colour, head.visible);
        // 0 leaves a count to the neighbours.
        let ([mut nu, mut nv], [mu, mv]) = (head.divisions, head.subdivisions);
        if let Some(panels) = head.panels.as_ref().filter(|_| !head.divided) {
            // A size counts where no number is stated.
            nu = if panels.size[0].is_some() { 0 } else { nu };
            nv = if panels.size[1].is_some() { 0 } else { nv };
        }
        let _ = match class.dimension() {
            Some(1) if self.legacy && mu == Head::of(class).subdivisions[0] => {
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
    fn value(&self, field: &Field, value: &Value<f64>) -> Result<String, &'static str> {
        let list = |items: Vec<String>| {
            let items: Vec<String> = items.into_iter().map(|item| item + " ").collect();
            format!("{{ {}}}", items.concat())
        };
        match value {
            Value::Unset => Ok("*".into()),
            Value::Number(x) => Ok(spelled(*x, field.unit)),
            Value::Text(text) => Ok(self.word(field, text)),
            Value::Object(key) => {
                let object = self.document.graph().get(*key);
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
                class => class.a(),
            }),
        }
    }

    fn word(&self, field: &Field, text: &str) -> String {
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
