//! Unused parts of a program: variables of routines that are never read, routines that are never
//! called.

use crate::run::parts::{self, StatementParts};
use crate::source::module::{Module, Name};
use moldloft_diag::{Diagnostic, Span};
use moldloft_syntax::sdl::{ExprId, ExprKind, NodeList, Routine, StmtId, StmtKind, Symbol};
use std::collections::HashSet;

/// The names that statements read, and those that they declare for themselves.
#[derive(Default)]
struct Uses {
    read: HashSet<Symbol>,
    declared: Vec<(Symbol, Span)>,
}

impl Uses {
    fn list(&mut self, m: &Module, list: NodeList<StmtId>) {
        for &stmt in &m.program[list] {
            self.statement(m, stmt);
        }
    }

    fn statement(&mut self, m: &Module, stmt: StmtId) {
        let StatementParts { mut values, inner } = parts::of_statement(m, stmt);
        match m.program[stmt].kind {
            StmtKind::Declare { global: false, items, .. } => {
                let names = m.program[items].iter().map(|item| item.name);
                self.declared.extend(names.map(|name| (name.symbol, name.span)));
            }
            StmtKind::Object { kind, .. } => drop(self.read.insert(kind.symbol)),
            StmtKind::Assign { target, value, .. } => {
                values = vec![value];
                self.target(m, target, &mut values);
            }
            _ => {}
        }
        inner.into_iter().for_each(|stmt| self.statement(m, stmt));
        values.into_iter().for_each(|expr| self.expression(m, expr));
    }

    /// The target of an assignment is not read; its subscripts are.
    fn target(&mut self, m: &Module, target: ExprId, values: &mut Vec<ExprId>) {
        let mut at = target;
        loop {
            match m.program[at].kind {
                ExprKind::Name(_) => return,
                ExprKind::Paren(inner) | ExprKind::Member { base: inner, .. } => at = inner,
                ExprKind::Index { base, subs } => {
                    values.extend(parts::of_subscripts(m, subs));
                    at = base;
                }
                _ => return values.push(at),
            }
        }
    }

    fn expression(&mut self, m: &Module, expr: ExprId) {
        let mut stack = vec![expr];
        while let Some(id) = stack.pop() {
            if let ExprKind::Name(symbol) = m.program[id].kind {
                self.read.insert(symbol);
            }
            stack.extend(parts::of_expression(m, id));
        }
    }
}

/// Remarks about variables of a routine that nothing in it reads.
pub(super) fn unread(m: &Module, routine: &Routine) -> Vec<Diagnostic> {
    let mut uses = Uses::default();
    uses.list(m, routine.body);
    let mut reported = HashSet::new();
    let mut found = Vec::new();
    for &(symbol, span) in &uses.declared {
        if uses.read.contains(&symbol) || !reported.insert(symbol) {
            continue;
        }
        let word = m.program.name(symbol);
        found.push(
            Diagnostic::remark("unused", format!("nothing reads the variable `{word}`"))
                .at(span)
                .help("leave it out, or use it"),
        );
    }
    found
}

/// The names that a module reads or calls anywhere.
pub(super) fn mentioned(m: &Module) -> HashSet<Name> {
    let mut uses = Uses::default();
    uses.list(m, m.program.body());
    for routine in m.program.routines() {
        uses.list(m, routine.body);
        let defaults = m.program[routine.formals].iter().filter_map(|formal| formal.default);
        defaults.for_each(|expr| uses.expression(m, expr));
    }
    uses.read.iter().map(|symbol| m.names[symbol.0 as usize]).collect()
}

/// True if a file has statements other than definitions; other files are libraries.
pub(super) fn does_something(m: &Module) -> bool {
    m.program[m.program.body()].iter().any(|&stmt| {
        !matches!(
            m.program[stmt].kind,
            StmtKind::Declare { .. }
                | StmtKind::Param { .. }
                | StmtKind::Load(_)
                | StmtKind::Routine(_)
                | StmtKind::Record { .. }
                | StmtKind::Assert { .. }
                | StmtKind::Error
        )
    })
}
