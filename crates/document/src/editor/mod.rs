//! Editor queries about a text: meaning, declaration and uses of a name, and completion.

mod completion;
mod mentions;
mod signature;
mod tokens;
mod workspace;

pub use completion::{Completion, CompletionKind};
pub use signature::{ArgumentHint, CallSignature};
pub use tokens::{NameRole, NameToken};
pub use workspace::{Workspace, WorkspacePlace};

use crate::document::Document;
use mentions::{Mention, mentions};
use moldloft_diag::{FileId, Span};
use moldloft_lang::run::inserted::INSERTED_FILES;
use moldloft_lang::source::module::{Module, RoutineAt};
use moldloft_lang::source::scope::Binding;
use moldloft_lang::value::variables::shape_text;
use moldloft_registry::{Class, Row, Value};
use moldloft_syntax::sdl::{Routine, Symbol};
use std::collections::HashSet;
use std::fmt::Write;

impl Document {
    fn main_module(&self) -> Option<&Module> {
        (!self.modules.is_empty()).then(|| &**self.modules.get(0))
    }

    fn mention_at(&self, offset: u32) -> Option<Mention> {
        let mut found = mentions(&self.main_module()?.program).names;
        found.retain(|mention| mention.span.touches(offset));
        // Of two adjacent names, the second begins at the offset.
        found.into_iter().max_by_key(|mention| mention.span.start)
    }

    /// The names of the main file only.
    fn own_names(&self) -> Option<(Workspace, FileId)> {
        let m = self.main_module()?;
        let mut alone = Workspace::default();
        alone.set_program("", &m.program, |_| None);
        Some((alone, m.program.file()))
    }

    /// The declaration of the name at an offset of the main file; for a library, in the library's
    /// file.
    pub fn definition(&self, offset: u32) -> Option<Span> {
        let (own, file) = self.own_names()?;
        if let Some((_, start, end)) = own.definition("", offset) {
            return Some(Span::new(file, start, end));
        }
        let mention = self.mention_at(offset)?;
        let m = self.main_module()?;
        let name = m.names[mention.symbol.0 as usize];
        if let Some(&RoutineAt { module, routine }) = self.plain.env.scope.routines.get(&name) {
            return Some(self.modules.get(module).program[routine].name.span);
        }
        let bound = self.plain.env.scope.globals.get(name.0 as usize)?.as_ref()?;
        bound.span.is_known().then_some(bound.span)
    }

    /// All positions in the main file at which the name at an offset has the same meaning.
    pub fn references(&self, offset: u32) -> Vec<Span> {
        let Some((own, file)) = self.own_names() else { return Vec::new() };
        let places = own.references("", offset).into_iter();
        places.map(|(_, start, end)| Span::new(file, start, end)).collect()
    }

    /// The positions to change when the name at an offset becomes `new`.
    ///
    /// # Errors
    /// If there is no name to rename, it is declared elsewhere, or `new` is not a name or is taken.
    pub fn renamed(&self, offset: u32, new: &str) -> Result<Vec<Span>, String> {
        let (own, file) = self.own_names().ok_or("no program")?;
        let places = own.renamed("", offset, new, |name| self.is_reserved(name))?;
        Ok(places.into_iter().map(|(_, start, end)| Span::new(file, start, end)).collect())
    }

    /// True for the name of a kind, a function or a statement.
    pub fn is_reserved(&self, name: &str) -> bool {
        self.registry().get(name).is_some() || INSERTED_FILES.iter().any(|row| row.name == name)
    }

    /// Description of the name at an offset, in Markdown, and the span of the name.
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
        None
    }

    /// The routines, objects, parameters and variables declared in the main file: name, kind, and
    /// span of the name.
    pub fn symbols(&self) -> Vec<(String, CompletionKind, Span)> {
        let Some(m) = self.main_module() else { return Vec::new() };
        let routine = |symbol: Symbol| m.program.routines().iter().any(|r| r.name.symbol == symbol);
        let mut seen = HashSet::new();
        let mut all = mentions(&m.program).names;
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

/// The head of a routine: `subroutine arc(returned curve c, float a0, float a1, float r)`.
fn signature(m: &Module, routine: &Routine) -> String {
    let start = routine.span.start as usize;
    let text = m.program.text().get(start..routine.span.end as usize).unwrap_or("");
    let head = text.split('{').next().unwrap_or("");
    head.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The comment lines directly above a position.
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

/// A value, abbreviated to a few numbers.
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
