//! Completion at a position: names, members, the words of text arguments.

use super::mentions::mentions;
use super::{row_signature, signature};
use crate::document::Document;
use moldloft_lang::run::inserted::INSERTED_FILES;
use moldloft_lang::source::module::RoutineAt;
use moldloft_lang::source::scope::Binding;
use moldloft_lang::value::variables::shape_text;
use moldloft_registry::{Class, FieldSpec, Implementation};
use moldloft_syntax::sdl::{self, OpenCall, RoutineId};
use std::sync::Arc;

/// A completion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Completion {
    /// The word.
    pub word: String,
    /// Its kind.
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
    /// A member of the expression before the dot.
    Member,
    /// The name of an argument of the enclosing call.
    Argument,
    /// A permitted value of a text argument.
    Word,
}

impl Document {
    /// Completions at the end of a line that follows the text, as at a prompt.
    pub fn completions_of(&mut self, line: &str) -> Vec<Completion> {
        self.completions_after(line, u32::MAX)
    }

    /// Completions at an offset of the main file: members after a dot, otherwise all names in
    /// scope.
    pub fn completions(&mut self, offset: u32) -> Vec<Completion> {
        let Some(m) = self.main_module() else { return Vec::new() };
        let text = m.program.text().clone();
        self.completions_after(text.get(..offset as usize).unwrap_or(""), offset)
    }

    fn completions_after(&mut self, before: &str, offset: u32) -> Vec<Completion> {
        let call = sdl::call_around(before, before.len() as u32);
        if let Some(start) = sdl::text_around(before, before.len() as u32) {
            return self.quoted_words(call.as_ref(), &before[start as usize..]);
        }
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
                Err(_) => ["x", "y", "z", "d1", "d2"].map(Arc::from).to_vec(),
            };
            let kind = CompletionKind::Member;
            return names
                .into_iter()
                .filter(|name| name.starts_with(prefix))
                .map(|name| Completion { word: name.to_string(), kind, detail: String::new() })
                .collect();
        }
        let mut found: Vec<Completion> = Vec::new();
        let mut add = |word: &str, kind: CompletionKind, detail: String| {
            if word.starts_with(prefix) && !found.iter().any(|c| c.word == word) {
                found.push(Completion { word: word.into(), kind, detail });
            }
        };
        let row = call.filter(|call| call.name.is_none());
        let row = row.and_then(|call| self.registry().get(&call.callee));
        for field in row.into_iter().flat_map(|row| row.fields.iter()) {
            add(field.name, CompletionKind::Argument, field.help.into());
        }
        let inside = m.program.routines().iter().position(|r| r.span.touches(offset));
        let inside = inside.map(|k| RoutineId(k as u32));
        for mention in mentions(&m.program).names {
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
        for keyword in moldloft_syntax::sdl::keywords() {
            add(keyword, CompletionKind::Keyword, String::new());
        }
        found
    }

    /// True inside a string that names a file: of `load`, of a component, or of a function that
    /// reads or writes files.
    pub fn names_file(&self, text: &str, offset: u32) -> bool {
        let Some(before) = text.get(..offset as usize) else { return false };
        if sdl::text_around(before, offset).is_none() {
            return false;
        }
        let Some(call) = sdl::call_around(before, offset) else { return true };
        if INSERTED_FILES.iter().any(|row| row.name == call.callee) {
            return call.argument == 0;
        }
        self.field(&call).is_some_and(|field| field.help.to_lowercase().contains("file"))
    }

    /// The permitted words that the documentation of a text argument lists.
    fn quoted_words(&self, call: Option<&OpenCall>, prefix: &str) -> Vec<Completion> {
        let help = call.and_then(|call| self.field(call)).map_or("", |f| f.help);
        let mut found: Vec<Completion> = Vec::new();
        // Of a text split at quotation marks, every second part is quoted.
        for word in help.split('"').skip(1).step_by(2) {
            let new = !word.is_empty() && !found.iter().any(|c| c.word == word);
            if new && word.starts_with(prefix) {
                let kind = CompletionKind::Word;
                found.push(Completion { word: word.into(), kind, detail: help.to_string() });
            }
        }
        found
    }

    /// The argument that is being written.
    fn field(&self, call: &OpenCall) -> Option<FieldSpec> {
        let row = self.registry().get(&call.callee)?;
        let field = match &call.name {
            Some(name) => row.fields.iter().find(|f| f.name == name),
            None => row.fields.get(call.argument).or(row.fields.last().filter(|f| f.variadic)),
        };
        // Functions of the run take texts before and behind repeated arguments.
        let text = |of: &&FieldSpec| of.class == Class::Text;
        let displaced = call.argument > 0 && matches!(row.body, Implementation::Foreign(_));
        match field.filter(text) {
            None if displaced => row.fields.iter().rfind(text).copied(),
            _ => field.copied(),
        }
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
