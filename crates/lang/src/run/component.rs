//! Components: a file of objects, inserted under a name with parents of the caller's.
//!
//! `Component keel("keel.sdl", hull = myhull, span = 2);`
//!
//! The file runs as a program of its own, without the caller's names except the given ones, which
//! replace its own declarations of the same names. So a component can be opened separately, with
//! parents and parameters of its own, and inserted elsewhere on others. Objects that only its own
//! parents depend on are then not made. Its objects are `keel.tip`, its parameters `keel.span`.

use crate::run::interpreter::{Flow, Interpreter, silent};
use crate::source::module::{Module, Name};
use crate::source::scope::{Binding, Scope, ScopedBinding};
use crate::value::variables;
use crate::value::variables::Called as _;
use moldloft_diag::{Diagnostic, Span};
use moldloft_registry::{Scalar, Value};
use moldloft_syntax::sdl::{Arg, ExprId, ExprKind, Ident, NodeList, StmtKind};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

impl<T: Scalar> Interpreter<'_, '_, T> {
    pub fn component(
        &mut self,
        m: &Module,
        name: Ident,
        args: NodeList<Arg>,
        span: Span,
    ) -> Result<(), Diagnostic> {
        let given: Vec<Arg> = m.program[args].to_vec();
        let files: Vec<&Arg> = given.iter().filter(|a| a.name.is_none()).collect();
        let [file] = files[..] else {
            return Err(Diagnostic::error("missing-argument", "a component is made from one file")
                .at(span)
                .expected("Component name(\"file.sdl\", parent = object)")
                .found(format!("{} files", files.len())));
        };
        let at = m.program[file.value].span;
        let path = match self.operand(m, file.value)? {
            Value::Text(text) => text.to_string(),
            other => {
                return Err(Diagnostic::error("wrong-class", "a component is made from a file")
                    .at(at)
                    .expected("the name of a file")
                    .found(other.called()));
            }
        };
        let module = self.modules.load(self.current, &path, at, &mut self.loader)?;
        if self.components.contains(&module) || module == self.current {
            return Err(Diagnostic::error("cycle", format!("`{path}` is inserted into itself"))
                .at(at)
                .expected("components that are not made of themselves"));
        }
        let inner = self.modules.get(module).clone();
        let mut globals = Vec::new();
        let mut names = HashSet::new();
        for arg in given.iter() {
            let Some(ident) = arg.name else { continue };
            let word = m.program.name(ident.symbol);
            let own = declared(&inner);
            if !own.iter().any(|name| name == word) && !is_used(&inner, word) {
                return Err(Diagnostic::error(
                    "unknown-argument",
                    format!("`{path}` has nothing called `{word}`"),
                )
                .at(ident.span)
                .expected(listed(&own))
                .suggest(word, own.iter().map(String::as_str)));
            }
            let value = self.expr(m, arg.value)?;
            let what = match value {
                Value::Object(key) => Binding::Object(key),
                value => {
                    let value = self.read(value, m.program[arg.value].span)?;
                    Binding::variable(variables::type_of(&value), value)
                }
            };
            let name = m.names[ident.symbol.0 as usize];
            names.insert(name);
            globals.push((name, ScopedBinding { span: ident.span, what }));
        }
        let name_id = m.names[name.symbol.0 as usize];
        let (full, turn) = self.full_name(m, name)?;
        if turn.is_none() {
            self.check_free(name_id, name.span, false)?;
        }
        let full: Arc<str> = match full {
            Some(full) => full.into(),
            None => m.program.name(name.symbol).into(),
        };
        let family = match turn {
            Some((family, _)) => family,
            None => full.clone(),
        };
        self.env.scope.bind(name_id, name.span, Binding::Instance(family));
        replace_parents(&inner, &mut names);

        // The file is a program of its own for the time being.
        let mut scope = Scope::of_file(format!("{full}.").into(), self.modules.name_count());
        for (name, bound) in globals {
            scope.globals[name.0 as usize] = Some(bound);
        }
        scope.given = names;
        let outer = std::mem::replace(&mut self.env.scope, scope);
        self.components.push(module);
        let flow = self.module(module);
        self.components.pop();
        self.env.scope = outer;
        self.env.scope.make_room(self.modules.name_count());
        match flow {
            Flow::Stop => Err(silent()),
            _ => Ok(()),
        }
    }
}

/// The names that a file declares at its top.
fn declared(m: &Module) -> Vec<String> {
    let mut names = Vec::new();
    for &stmt in &m.program[m.program.body()] {
        match m.program[stmt].kind {
            StmtKind::Object { name, .. } | StmtKind::Param { name, .. } => {
                names.push(m.program.name(name.symbol).to_string());
            }
            StmtKind::Declare { items, .. } => {
                let items = m.program[items].iter();
                names.extend(items.map(|i| m.program.name(i.name.symbol).to_string()));
            }
            _ => {}
        }
    }
    names
}

/// True when an expression of the file has the name for a value: it may leave the declaration to its
/// user. Words such as those of arguments and kinds are no names of that sort.
fn is_used(m: &Module, word: &str) -> bool {
    m.program.symbol(word).is_some_and(|wanted| {
        (0..m.program.expr_count() as u32).any(
            |k| matches!(m.program[ExprId(k)].kind, ExprKind::Name(symbol) if symbol == wanted),
        )
    })
}

/// The possible arguments of a file with these declarations, as text.
fn listed(own: &[String]) -> String {
    /// More names than this are not read.
    const MOST: usize = 12;
    if own.is_empty() {
        return "no named argument: the file declares nothing".into();
    }
    let names: Vec<String> = own.iter().take(MOST).map(|name| format!("`{name}`")).collect();
    let more = if own.len() > MOST { " and others" } else { "" };
    format!("a name that the file declares: {}{more}", names.join(", "))
}

/// Adds the objects that nothing but replaced declarations is built on.
fn replace_parents(m: &Module, replaced: &mut HashSet<Name>) {
    let mut uses: HashMap<Name, usize> = HashMap::new();
    for k in 0..m.program.expr_count() as u32 {
        if let ExprKind::Name(symbol) = m.program[ExprId(k)].kind {
            *uses.entry(m.names[symbol.0 as usize]).or_default() += 1;
        }
    }
    let mut objects: Vec<(Name, Vec<Name>)> = Vec::new();
    for &stmt in &m.program[m.program.body()] {
        if let StmtKind::Object { name, args, .. } = m.program[stmt].kind {
            let mut used = Vec::new();
            for arg in &m.program[args] {
                crate::run::forward_reference::names_in(m, arg.value, &mut |symbol| {
                    used.push(m.names[symbol.0 as usize]);
                });
            }
            objects.push((m.names[name.symbol.0 as usize], used));
        }
    }
    // Children come after their parents: backwards, each is met after all that uses it.
    let mut gone: HashMap<Name, usize> = HashMap::new();
    for (name, used) in objects.iter().rev() {
        let orphan = uses.get(name).is_some_and(|all| gone.get(name) == Some(all));
        if orphan {
            replaced.insert(*name);
        }
        if replaced.contains(name) {
            used.iter().for_each(|n| *gone.entry(*n).or_default() += 1);
        }
    }
}
