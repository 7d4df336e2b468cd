//! Signatures of calls, shown while arguments are typed, and names of positional arguments, shown
//! beside them.

use super::mentions::mentions;
use super::{row_signature, signature};
use crate::document::Document;
use moldloft_lang::run::inserted::INSERTED_FILES;
use moldloft_lang::source::module::RoutineAt;
use moldloft_syntax::sdl::{self, ExprKind};

/// Signature of a call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CallSignature {
    /// The complete signature.
    pub label: String,
    /// Its documentation.
    pub doc: String,
    /// The arguments: byte range of each in `label`, and its help.
    pub arguments: Vec<(u32, u32, String)>,
    /// Index of the argument at the cursor.
    pub active: Option<usize>,
}

/// The name of a positional argument.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArgumentHint {
    /// Byte offset before which the name is shown.
    pub offset: u32,
    /// The argument's name.
    pub name: String,
}

impl Document {
    /// Signature of the call around an offset of `text`, which may be newer than the last run.
    pub fn call_signature(&self, text: &str, offset: u32) -> Option<CallSignature> {
        let call = sdl::call_around(text, offset)?;
        let (label, doc, arguments) = self.described(&call.callee)?;
        let given = |name: &String| arguments.iter().position(|(n, _)| n == name);
        let active = match &call.name {
            Some(name) => given(name),
            None if call.argument < arguments.len() => Some(call.argument),
            // The last argument of a function with any number of arguments.
            None => label.contains("...").then(|| arguments.len().saturating_sub(1)),
        };
        // Arguments are in order in the signature; each is searched for after the previous one.
        let mut from = label.find('(')? + 1;
        let mut places = Vec::with_capacity(arguments.len());
        for (name, help) in arguments {
            let at = word_at(&label, &name, from)?;
            from = at + name.len();
            places.push((at as u32, from as u32, help));
        }
        Some(CallSignature { label, doc, arguments: places, active })
    }

    /// Signature and documentation of a callable, and its arguments with their help.
    fn described(&self, callee: &str) -> Option<(String, String, Vec<(String, String)>)> {
        if let Some(row) = self.registry().get(callee) {
            let arguments = row.fields.iter().map(|f| (f.name.into(), f.help.into())).collect();
            return Some((row_signature(row), row.summary().into(), arguments));
        }
        if let Some(row) = INSERTED_FILES.iter().find(|row| row.name == callee) {
            let arguments = row.arguments.iter().map(|(n, help)| ((*n).into(), (*help).into()));
            let doc = row.doc.lines().next().unwrap_or("").into();
            return Some((row.signature.into(), doc, arguments.collect()));
        }
        let module = self.main_module()?;
        let symbol = module.program.symbol(callee);
        let known = symbol.and_then(|symbol| {
            self.plain.env.scope.routines.get(module.names.get(symbol.0 as usize)?)
        });
        let &RoutineAt { module, routine } = known?;
        let m = self.modules.get(module);
        let routine = m.program[routine];
        let formals = m.program[routine.formals].iter();
        let arguments = formals.map(|f| (m.program.name(f.name.symbol).into(), String::new()));
        let doc = super::comment_above(m.program.text(), routine.span.start as usize);
        Some((signature(m, &routine), doc, arguments.collect()))
    }

    /// Names of positional arguments between two byte offsets, where the value does not explain
    /// itself.
    pub fn argument_hints(&self, from: u32, to: u32) -> Vec<ArgumentHint> {
        let Some(module) = self.main_module() else { return Vec::new() };
        let program = &module.program;
        let mut hints = Vec::new();
        for call in mentions(program).calls {
            let args = &program[call.args];
            let inside = |a: &sdl::Arg| {
                let span = program[a.value].span;
                from <= span.start && span.start <= to
            };
            if args.len() < 2 || !args.iter().any(inside) {
                continue;
            }
            let Some((_, _, fields)) = self.described(program.name(call.callee)) else { continue };
            for (arg, (name, _)) in args.iter().zip(&fields) {
                let value = program.bare(arg.value);
                let plain = matches!(
                    program[value].kind,
                    ExprKind::Number(_) | ExprKind::Text(_) | ExprKind::Unary { .. }
                );
                // One-letter names such as x, y, z, t, u, v add nothing to the position.
                if arg.name.is_none() && plain && name.len() > 1 && inside(arg) {
                    let offset = program[arg.value].span.start;
                    hints.push(ArgumentHint { offset, name: name.clone() });
                }
            }
        }
        hints.sort_by_key(|hint| hint.offset);
        hints
    }
}

/// Byte offset of the first occurrence of `word` as a whole word at or after `from`.
fn word_at(text: &str, word: &str, from: usize) -> Option<usize> {
    let part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut at = from;
    while let Some(found) = text.get(at..)?.find(word) {
        let (start, end) = (at + found, at + found + word.len());
        if !text[..start].ends_with(part) && !text[end..].starts_with(part) {
            return Some(start);
        }
        at = end;
    }
    None
}
