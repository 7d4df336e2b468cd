//! What an editor asks of a text: what a name means, where it is declared and used, what could stand
//! at a place.

use crate::document::Document;
use moldloft_diag::{FileId, Span};
use moldloft_lang::BUILTINS;
use moldloft_lang::run::inserted::INSERTED_FILES;
use moldloft_lang::source::module::{Module, RoutineAt};
use moldloft_lang::source::scope::Binding;
use moldloft_lang::value::variables::shape_text;
use moldloft_registry::{Class, Row, Value};
use moldloft_syntax::sdl::{
    self, Arg, ChainItem, ExprId, ExprKind, Ident, NodeList, Routine, RoutineId, StmtId, StmtKind,
    Subscript, Symbol,
};
use std::collections::HashSet;
use std::fmt::Write;

/// A name in the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Mention {
    symbol: Symbol,
    span: Span,
    declares: bool,
    /// The routine that the name is local to.
    local_to: Option<RoutineId>,
}

/// What may stand at a place of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Completion {
    /// The word.
    pub word: String,
    /// What kind of thing it is.
    pub kind: CompletionKind,
    /// Its signature, type or shape.
    pub detail: String,
}

/// Kinds of [`Completion`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompletionKind {
    /// A variable or parameter.
    Variable,
    /// An object of the model.
    Object,
    /// A function or subroutine.
    Function,
    /// A kind of object.
    Kind,
    /// A reserved word.
    Keyword,
    /// A member of what stands before the dot.
    Member,
}

/// Collects the names of a file.
struct Walk<'m> {
    m: &'m Module,
    found: Vec<Mention>,
    locals: HashSet<Symbol>,
    routine: Option<RoutineId>,
}

impl Walk<'_> {
    fn name(&mut self, symbol: Symbol, span: Span, declares: bool) {
        let local = self.locals.contains(&symbol);
        let local_to = self.routine.filter(|_| local);
        self.found.push(Mention { symbol, span, declares, local_to });
    }

    fn ident(&mut self, ident: Ident, declares: bool) {
        self.name(ident.symbol, ident.span, declares);
    }

    fn args(&mut self, args: NodeList<Arg>) {
        self.m.program[args].iter().for_each(|arg| self.expr(arg.value));
    }

    fn exprs(&mut self, list: NodeList<ExprId>) {
        self.m.program[list].iter().for_each(|&e| self.expr(e));
    }

    fn expr(&mut self, id: ExprId) {
        let m = self.m;
        match m.program[id].kind {
            ExprKind::Name(symbol) => self.name(symbol, m.program[id].span, false),
            ExprKind::Number(_) | ExprKind::Text(_) | ExprKind::Error => {}
            ExprKind::Paren(e) | ExprKind::Magnitude(e) | ExprKind::Unary { operand: e, .. } => {
                self.expr(e);
            }
            ExprKind::List(list) => self.exprs(list),
            ExprKind::Binary { left, right, .. } => {
                self.expr(left);
                self.expr(right);
            }
            ExprKind::Chain(items) => {
                for item in &m.program[items] {
                    if let ChainItem::Operand(e) = item {
                        self.expr(*e);
                    }
                }
            }
            ExprKind::Index { base, subs } => {
                self.expr(base);
                for sub in &m.program[subs] {
                    match *sub {
                        Subscript::Whole => {}
                        Subscript::At(e) => self.expr(e),
                        Subscript::Range { from, to, step } => {
                            [from, to, step].into_iter().flatten().for_each(|e| self.expr(e));
                        }
                    }
                }
            }
            ExprKind::Member { base, .. } => self.expr(base),
            ExprKind::Call { callee, args } => {
                self.expr(callee);
                self.args(args);
            }
        }
    }

    fn stmts(&mut self, list: NodeList<StmtId>) {
        self.m.program[list].iter().for_each(|&s| self.stmt(s));
    }

    fn stmt(&mut self, id: StmtId) {
        let m = self.m;
        match m.program[id].kind {
            StmtKind::Block(list) => self.stmts(list),
            StmtKind::Load(_) | StmtKind::Break | StmtKind::Continue | StmtKind::Error => {}
            StmtKind::Routine(at) => self.routine(at),
            StmtKind::Declare { items, .. } => {
                for item in &m.program[items] {
                    self.exprs(item.dims);
                    item.value.into_iter().for_each(|e| self.expr(e));
                    self.ident(item.name, true);
                }
            }
            StmtKind::Param { name, value, range, .. } => {
                self.expr(value);
                for e in range.into_iter().flat_map(|(a, b)| [a, b]) {
                    self.expr(e);
                }
                self.ident(name, true);
            }
            StmtKind::Object { kind, name, args } => {
                self.ident(kind, false);
                self.args(args);
                self.ident(name, true);
            }
            StmtKind::Assign { target, value, .. } => {
                self.expr(target);
                self.expr(value);
            }
            StmtKind::Call(e) => self.expr(e),
            StmtKind::If { condition, then, otherwise } => {
                self.expr(condition);
                self.stmt(then);
                otherwise.into_iter().for_each(|s| self.stmt(s));
            }
            StmtKind::While { condition, body } => {
                self.expr(condition);
                self.stmt(body);
            }
            StmtKind::ForRange { variable, from, to, step, body } => {
                [Some(from), Some(to), step].into_iter().flatten().for_each(|e| self.expr(e));
                self.ident(variable, true);
                self.stmt(body);
            }
            StmtKind::For { start, condition, step, body } => {
                start.into_iter().for_each(|s| self.stmt(s));
                condition.into_iter().for_each(|e| self.expr(e));
                step.into_iter().for_each(|s| self.stmt(s));
                self.stmt(body);
            }
            StmtKind::Foreach { variable, list, body } => {
                self.expr(list);
                self.ident(variable, true);
                self.stmt(body);
            }
            StmtKind::Print(list) => self.exprs(list),
            StmtKind::Assert { condition, message } => {
                self.expr(condition);
                message.into_iter().for_each(|e| self.expr(e));
            }
            StmtKind::Return(value) => value.into_iter().for_each(|e| self.expr(e)),
        }
    }

    fn routine(&mut self, at: RoutineId) {
        let routine = self.m.program[at];
        self.ident(routine.name, true);
        let mut inner = Locals { m: self.m, found: HashSet::new() };
        for formal in &self.m.program[routine.formals] {
            inner.found.insert(formal.name.symbol);
        }
        inner.stmts(routine.body);
        let outer = (std::mem::replace(&mut self.locals, inner.found), self.routine);
        self.routine = Some(at);
        for formal in &self.m.program[routine.formals] {
            self.ident(formal.name, true);
        }
        self.stmts(routine.body);
        (self.locals, self.routine) = outer;
    }
}

/// The names that the statements of a routine declare for themselves.
struct Locals<'m> {
    m: &'m Module,
    found: HashSet<Symbol>,
}

impl Locals<'_> {
    fn stmts(&mut self, list: NodeList<StmtId>) {
        self.m.program[list].iter().for_each(|&s| self.stmt(s));
    }

    fn stmt(&mut self, id: StmtId) {
        match self.m.program[id].kind {
            StmtKind::Block(list) => self.stmts(list),
            StmtKind::Declare { global: false, items, .. } => {
                let names = self.m.program[items].iter().map(|item| item.name.symbol);
                self.found.extend(names);
            }
            StmtKind::Object { name, .. } => drop(self.found.insert(name.symbol)),
            StmtKind::If { then, otherwise, .. } => {
                self.stmt(then);
                otherwise.into_iter().for_each(|s| self.stmt(s));
            }
            StmtKind::While { body, .. } => self.stmt(body),
            StmtKind::ForRange { variable, body, .. }
            | StmtKind::Foreach { variable, body, .. } => {
                self.found.insert(variable.symbol);
                self.stmt(body);
            }
            StmtKind::For { start, body, .. } => {
                start.into_iter().for_each(|s| self.stmt(s));
                self.stmt(body);
            }
            _ => {}
        }
    }
}

fn mentions(m: &Module) -> Vec<Mention> {
    let mut walk = Walk { m, found: Vec::new(), locals: HashSet::new(), routine: None };
    walk.stmts(m.program.body());
    walk.found
}

impl Document {
    fn main_module(&self) -> Option<&Module> {
        (!self.modules.is_empty()).then(|| &**self.modules.get(0))
    }

    fn mention_at(&self, offset: u32) -> Option<Mention> {
        let mut found = mentions(self.main_module()?);
        found.retain(|mention| mention.span.touches(offset));
        // The later of two that touch begins at the place.
        found.into_iter().max_by_key(|mention| mention.span.start)
    }

    /// Where the name at a place of the main file is declared; in a library, a place in its file.
    pub fn definition(&self, offset: u32) -> Option<Span> {
        let mention = self.mention_at(offset)?;
        let m = self.main_module()?;
        let own = mentions(m);
        let same = |o: &&Mention| o.symbol == mention.symbol && o.local_to == mention.local_to;
        if let Some(first) = own.iter().filter(same).find(|o| o.declares) {
            return Some(first.span);
        }
        let name = m.names[mention.symbol.0 as usize];
        if let Some(&RoutineAt { module, routine }) = self.plain.env.scope.routines.get(&name) {
            return Some(self.modules.get(module).program[routine].name.span);
        }
        let bound = self.plain.env.scope.globals.get(name.0 as usize)?.as_ref()?;
        bound.span.is_known().then_some(bound.span)
    }

    /// All places of the main file where the name at a place stands for the same thing.
    pub fn references(&self, offset: u32) -> Vec<Span> {
        let Some(mention) = self.mention_at(offset) else { return Vec::new() };
        let Some(m) = self.main_module() else { return Vec::new() };
        let mut all = mentions(m);
        all.retain(|o| o.symbol == mention.symbol && o.local_to == mention.local_to);
        let mut spans: Vec<Span> = all.into_iter().map(|o| o.span).collect();
        spans.sort_by_key(|span| span.start);
        spans.dedup();
        spans
    }

    /// The places to change when the name at a place becomes `new`.
    ///
    /// # Errors
    /// Why it cannot: nothing to rename there, declared elsewhere, no name, or taken.
    pub fn renamed(&self, offset: u32, new: &str) -> Result<Vec<Span>, String> {
        let mention = self.mention_at(offset).ok_or("no name at this position")?;
        let m = self.main_module().ok_or("no program")?;
        let word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let head = new.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        let free = || sdl::parse(format!("float {new};"), FileId(0)).1.is_empty();
        if !head || !new.chars().all(word) || !free() {
            return Err(format!(
                "`{new}` is not a valid name: a letter, then letters, digits and _"
            ));
        }
        let all = mentions(m);
        let same = |o: &&Mention| o.symbol == mention.symbol && o.local_to == mention.local_to;
        if !all.iter().filter(same).any(|o| o.declares) {
            let old = m.program.name(mention.symbol);
            return Err(format!("`{old}` is not declared in this file"));
        }
        let taken = m.program.symbol(new).is_some_and(|symbol| {
            all.iter().any(|o| {
                let meets = o.local_to.is_none()
                    || mention.local_to.is_none()
                    || o.local_to == mention.local_to;
                o.symbol == symbol && meets
            })
        });
        let reserved = self.registry().get(new).is_some()
            || BUILTINS.iter().any(|b| b.name == new)
            || INSERTED_FILES.iter().any(|row| row.name == new);
        if taken || reserved {
            return Err(format!("`{new}` is already in use"));
        }
        Ok(self.references(offset))
    }

    /// What the name at a place is: a text in Markdown, and the name's place.
    pub fn hover(&mut self, offset: u32) -> Option<(String, Span)> {
        let mention = self.mention_at(offset)?;
        let m = self.main_module()?;
        let word = m.program.name(mention.symbol).to_string();
        let name = m.names[mention.symbol.0 as usize];
        if mention.local_to.is_some() {
            let first = self.definition(offset)?;
            let line = self.sources.locate(first.file, first.start)?.line;
            let text = self.sources.line(first.file, line)?.trim().to_string();
            return Some((format!("```sdl\n{text}\n```\nlocal to its routine"), mention.span));
        }
        let bound = self.plain.env.scope.globals.get(name.0 as usize).and_then(Option::as_ref);
        if let Some(bound) = bound {
            let text = match &bound.what {
                Binding::Variable { value: Value::Unset, .. } => {
                    format!("```sdl\n{word}\n```\nhas no value yet")
                }
                Binding::Variable { value, .. } => {
                    format!("```sdl\n{} {word}\n```\n{}", shape_text(value), shown(value))
                }
                Binding::Param(number) => {
                    let param = self.plain.env.params.get(*number)?;
                    let range =
                        param.range.map_or(String::new(), |(a, b)| format!(" in [{a}, {b}]"));
                    format!("```sdl\nparam {word} = {}{range}\n```", param.value)
                }
                Binding::Object(key) => {
                    let object = self.graph().get(*key)?;
                    let mut text = format!("```sdl\n{} {word}\n```\n", object.row.name);
                    match object.value() {
                        Some(value) => text.push_str(&shown(value)),
                        None => text.push_str("has no value: see the errors"),
                    }
                    let _ = write!(text, "\n\n{}", object.row.summary());
                    text
                }
                Binding::Turn { family, .. } | Binding::Instance(family) => {
                    format!("the objects of `{family}`")
                }
                _ => return None,
            };
            return Some((text, mention.span));
        }
        if let Some(&RoutineAt { module, routine }) = self.plain.env.scope.routines.get(&name) {
            let m = self.modules.get(module);
            let routine = m.program[routine];
            let mut text = format!("```sdl\n{}\n```", signature(m, &routine));
            let comment = comment_above(m.program.text(), routine.span.start as usize);
            if !comment.is_empty() {
                let _ = write!(text, "\n{comment}");
            }
            return Some((text, mention.span));
        }
        if let Some(row) = self.registry().get(&word) {
            let text = format!("```sdl\n{}\n```\n{}", row_signature(row), row.doc);
            return Some((text, mention.span));
        }
        if let Some(row) = INSERTED_FILES.iter().find(|row| row.name == word) {
            let text = format!("```sdl\n{}\n```\n{}", row.signature, row.doc);
            return Some((text, mention.span));
        }
        let builtin = BUILTINS.iter().find(|b| b.name == word)?;
        let text = format!("```sdl\n{}\n```\n{}", builtin.signature, builtin.doc);
        Some((text, mention.span))
    }

    /// What may stand at the end of a line that follows the text, as at a prompt.
    pub fn completions_of(&mut self, line: &str) -> Vec<Completion> {
        self.completions_after(line, u32::MAX)
    }

    /// What may stand at a place of the main file: members after a dot, else all names that mean
    /// something there.
    pub fn completions(&mut self, offset: u32) -> Vec<Completion> {
        let Some(m) = self.main_module() else { return Vec::new() };
        let text = m.program.text().clone();
        self.completions_after(text.get(..offset as usize).unwrap_or(""), offset)
    }

    fn completions_after(&mut self, before: &str, offset: u32) -> Vec<Completion> {
        let Some(m) = self.main_module() else { return Vec::new() };
        let word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let stem = before.trim_end_matches(word);
        let prefix = &before[stem.len()..];
        if let Some(base) = stem.strip_suffix('.') {
            let start = base.len() - operand_length(base);
            let operand = base[start..].to_string();
            if operand.is_empty() {
                return Vec::new();
            }
            let names = match self.eval(&operand) {
                Ok(value) => moldloft_lang::value::member::names(&value),
                Err(_) => vec!["x", "y", "z", "d1", "d2"],
            };
            let kind = CompletionKind::Member;
            return names
                .into_iter()
                .filter(|name| name.starts_with(prefix))
                .map(|name| Completion { word: name.into(), kind, detail: String::new() })
                .collect();
        }
        let mut found: Vec<Completion> = Vec::new();
        let mut add = |word: &str, kind: CompletionKind, detail: String| {
            if word.starts_with(prefix) && !found.iter().any(|c| c.word == word) {
                found.push(Completion { word: word.into(), kind, detail });
            }
        };
        let inside = m.program.routines().iter().position(|r| r.span.touches(offset));
        let inside = inside.map(|k| RoutineId(k as u32));
        for mention in mentions(m) {
            let here = mention.local_to.is_none() || mention.local_to == inside;
            if mention.declares && here && !mention.span.touches(offset) {
                let name = m.names[mention.symbol.0 as usize];
                let routine = self.plain.env.scope.routines.contains_key(&name);
                let bound =
                    self.plain.env.scope.globals.get(name.0 as usize).and_then(Option::as_ref);
                let (kind, detail) = match bound.map(|b| &b.what) {
                    Some(Binding::Variable { value, .. }) => {
                        (CompletionKind::Variable, shape_text(value))
                    }
                    Some(Binding::Object(_)) => (CompletionKind::Object, String::new()),
                    _ if routine => continue,
                    _ => (CompletionKind::Variable, String::new()),
                };
                add(m.program.name(mention.symbol), kind, detail);
            }
        }
        let mut routines: Vec<_> = self.plain.env.scope.routines.iter().collect();
        routines.sort_by_key(|(name, _)| name.0);
        for (&name, &RoutineAt { module, routine }) in routines {
            let of = self.modules.get(module);
            let detail = signature(of, &of.program[routine]);
            add(self.modules.text(name), CompletionKind::Function, detail);
        }
        for (k, bound) in self.plain.env.scope.globals.iter().enumerate() {
            if let Some(bound) = bound
                && let Binding::Variable { value, .. } = &bound.what
            {
                let name = self.modules.text(moldloft_lang::source::module::Name(k as u32));
                add(name, CompletionKind::Variable, shape_text(value));
            }
        }
        for row in self.registry().rows() {
            let kind = if row.kind { CompletionKind::Kind } else { CompletionKind::Function };
            add(&row.name, kind, row_signature(row));
        }
        for row in &INSERTED_FILES {
            add(row.name, CompletionKind::Kind, row.signature.into());
        }
        for builtin in &BUILTINS {
            add(builtin.name, CompletionKind::Function, builtin.signature.into());
        }
        for keyword in moldloft_syntax::sdl::keywords() {
            add(keyword, CompletionKind::Keyword, String::new());
        }
        found
    }

    /// The routines, objects, parameters and variables that the main file declares: name, what it
    /// is, and the name's place.
    pub fn symbols(&self) -> Vec<(String, CompletionKind, Span)> {
        let Some(m) = self.main_module() else { return Vec::new() };
        let routine = |symbol: Symbol| m.program.routines().iter().any(|r| r.name.symbol == symbol);
        let mut seen = HashSet::new();
        let mut all = mentions(m);
        all.retain(|o| o.declares && o.local_to.is_none() && seen.insert(o.symbol));
        all.into_iter()
            .map(|o| {
                let name = m.names[o.symbol.0 as usize];
                let bound =
                    self.plain.env.scope.globals.get(name.0 as usize).and_then(Option::as_ref);
                let kind = match bound.map(|b| &b.what) {
                    _ if routine(o.symbol) => CompletionKind::Function,
                    Some(Binding::Object(_) | Binding::Turn { .. }) => CompletionKind::Object,
                    _ => CompletionKind::Variable,
                };
                (m.program.name(o.symbol).to_string(), kind, o.span)
            })
            .collect()
    }
}

/// The length of the operand that a text ends with: names, members, brackets and calls.
fn operand_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let mut at = bytes.len();
    while at > 0 {
        let c = bytes[at - 1];
        if c.is_ascii_alphanumeric() || c == b'_' || c == b'.' {
            at -= 1;
        } else if c == b']' || c == b')' {
            let mut depth = 0usize;
            while at > 0 {
                at -= 1;
                match bytes[at] {
                    b']' | b')' => depth += 1,
                    b'[' | b'(' => depth -= 1,
                    _ => {}
                }
                if depth == 0 {
                    break;
                }
            }
        } else {
            break;
        }
    }
    bytes.len() - at
}

/// The head of a routine: `subroutine arc(returned curve c, float a0, float a1, float r)`.
fn signature(m: &Module, routine: &Routine) -> String {
    let start = routine.span.start as usize;
    let text = m.program.text().get(start..routine.span.end as usize).unwrap_or("");
    let head = text.split('{').next().unwrap_or("");
    head.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The comment lines that end right above a place.
fn comment_above(text: &str, start: usize) -> String {
    let mut lines: Vec<&str> = Vec::new();
    for line in text[..start].lines().rev() {
        match line.trim().strip_prefix('#') {
            Some(rest) => lines.push(rest.strip_prefix(' ').unwrap_or(rest)),
            None if line.trim().is_empty() && lines.is_empty() => {}
            None => break,
        }
    }
    lines.reverse();
    lines.join("\n")
}

fn row_signature(row: &Row) -> String {
    let fields = row.fields.iter().map(|f| {
        let optional = f.default.is_some();
        let class = f.class.name();
        let many = if f.many { "s" } else { "" };
        let end = if optional { "?" } else { "" };
        format!("{}{end}: {class}{many}", f.name)
    });
    let fields = fields.collect::<Vec<_>>().join(", ");
    let result = if row.class == Class::Any { "" } else { row.class.name() };
    let arrow = if result.is_empty() { "" } else { " -> " };
    format!("{}({fields}){arrow}{result}", row.name)
}

/// A value in at most a few numbers.
fn shown(value: &Value<f64>) -> String {
    const MOST: usize = 6;
    let number =
        |x: f64| format!("{:.6}", x + 0.0).trim_end_matches('0').trim_end_matches('.').to_string();
    let point =
        |p: moldloft_num::Vec3| format!("{{{}, {}, {}}}", number(p.x), number(p.y), number(p.z));
    let row = |all: Vec<String>, count: usize| {
        let dots = if count > MOST { ", ..." } else { "" };
        format!("{{{}{dots}}}", all.join(", "))
    };
    match value {
        Value::Number(x) => number(*x),
        Value::Vector(v) => point(*v),
        Value::Point(p) => point(p.xyz),
        Value::Numbers(a) => {
            row(a.items.iter().take(MOST).map(|&x| number(x)).collect(), a.items.len())
        }
        Value::Vectors(a) => {
            let bounds = |c: usize| {
                let low = a.planes[c].iter().copied().fold(f64::INFINITY, f64::min);
                let high = a.planes[c].iter().copied().fold(f64::NEG_INFINITY, f64::max);
                format!("{} from {} to {}", ["x", "y", "z"][c], number(low), number(high))
            };
            let first =
                row(a.iter().take(2).map(point).collect(), if a.len() > 2 { 99 } else { 0 });
            format!("{first}\n\n{}, {}, {}", bounds(0), bounds(1), bounds(2))
        }
        Value::Text(text) => format!("\"{text}\""),
        other => other.class().with_article().to_string(),
    }
}
