//! Roles of the names of a text, for syntax colouring.

use super::mentions::mentions;
use crate::document::Document;
use moldloft_lang::run::inserted::INSERTED_FILES;
use moldloft_lang::source::scope::Binding;
use moldloft_syntax::sdl::Symbol;
use std::collections::HashMap;

/// Role of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NameRole {
    /// A kind of object.
    Kind,
    /// An object of the model.
    Object,
    /// A design parameter.
    Parameter,
    /// A variable.
    Variable,
    /// A formal argument or a variable of a routine.
    Local,
    /// A routine of the program.
    Routine,
    /// A function of the language.
    Function,
    /// A member, or the name of an argument.
    Member,
}

/// A name of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NameToken {
    /// Offset of the first byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
    /// Its role.
    pub role: NameRole,
    /// True where the name is declared.
    pub declares: bool,
}

impl Document {
    /// The names of the main file that have a role, in order.
    pub fn name_tokens(&self) -> Vec<NameToken> {
        let Some(m) = self.main_module() else { return Vec::new() };
        let found = mentions(&m.program);
        let mut tokens = Vec::with_capacity(found.names.len());
        let mut known: HashMap<Symbol, Option<NameRole>> = HashMap::new();
        for mention in &found.names {
            let role = match mention.local_to {
                Some(_) => Some(NameRole::Local),
                None => {
                    *known.entry(mention.symbol).or_insert_with(|| self.role_of(mention.symbol))
                }
            };
            if let Some(role) = role {
                let (start, end) = (mention.span.start, mention.span.end);
                tokens.push(NameToken { start, end, role, declares: mention.declares });
            }
        }
        let members = found.members.iter().map(|member| member.span);
        let labels = found.calls.iter().flat_map(|call| &m.program[call.args]);
        let labels = labels.filter_map(|arg| Some(arg.name?.span));
        tokens.extend(members.chain(labels).map(|span| NameToken {
            start: span.start,
            end: span.end,
            role: NameRole::Member,
            declares: false,
        }));
        tokens.sort_by_key(|token| (token.start, token.end));
        tokens.dedup_by_key(|token| token.start);
        tokens
    }

    fn role_of(&self, symbol: Symbol) -> Option<NameRole> {
        let m = self.main_module()?;
        let name = *m.names.get(symbol.0 as usize)?;
        let bound = self.plain.env.scope.globals.get(name.0 as usize).and_then(Option::as_ref);
        if let Some(bound) = bound {
            return match bound.what {
                Binding::Object(_) | Binding::Turn { .. } | Binding::Instance(_) => {
                    Some(NameRole::Object)
                }
                Binding::Param(_) => Some(NameRole::Parameter),
                Binding::Routine(_) | Binding::Function(_) => Some(NameRole::Routine),
                Binding::Poisoned => None,
                _ => Some(NameRole::Variable),
            };
        }
        if self.plain.env.scope.routines.contains_key(&name) {
            return Some(NameRole::Routine);
        }
        let word = m.program.name(symbol);
        if let Some(row) = self.registry().get(word) {
            return Some(if row.kind { NameRole::Kind } else { NameRole::Function });
        }
        if INSERTED_FILES.iter().any(|row| row.name == word) {
            return Some(NameRole::Kind);
        }
        None
    }
}
