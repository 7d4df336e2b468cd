//! What a program has and does not use: variables of routines that are never read, routines that nothing calls.

use crate::source::module::{Module, Name};
use moldloft_diag::{Diagnostic, Span};
use moldloft_syntax::sdl::{
    ChainItem, ExprId, ExprKind, NodeList, Routine, StmtId, StmtKind, Subscript, Symbol,
};
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
        let mut values: Vec<ExprId> = Vec::new();
        match m.program[stmt].kind {
            StmtKind::Block(list) => self.list(m, list),
            StmtKind::Declare { global, items, .. } => {
                for item in &m.program[items] {
                    if !global {
                        self.declared.push((item.name.symbol, item.name.span));
                    }
                    values.extend(&m.program[item.dims]);
                    values.extend(item.value);
                }
            }
            StmtKind::Param { value, range, .. } => {
                values.push(value);
                values.extend(range.into_iter().flat_map(|(low, high)| [low, high]));
            }
            StmtKind::Object { kind, args, .. } => {
                self.read.insert(kind.symbol);
                values.extend(m.program[args].iter().map(|arg| arg.value));
            }
            StmtKind::Assign { target, value, .. } => {
                self.target(m, target, &mut values);
                values.push(value);
            }
            StmtKind::Call(expr) => values.push(expr),
            StmtKind::If { condition, then, otherwise } => {
                values.push(condition);
                self.statement(m, then);
                if let Some(otherwise) = otherwise {
                    self.statement(m, otherwise);
                }
            }
            StmtKind::While { condition, body } => {
                values.push(condition);
                self.statement(m, body);
            }
            StmtKind::ForRange { from, to, step, body, .. } => {
                values.extend([Some(from), Some(to), step].into_iter().flatten());
                self.statement(m, body);
            }
            StmtKind::For { start, condition, step, body } => {
                values.extend(condition);
                for stmt in [start, step, Some(body)].into_iter().flatten() {
                    self.statement(m, stmt);
                }
            }
            StmtKind::Foreach { list, body, .. } => {
                // Its elements may be assigned through the variable.
                values.push(list);
                self.statement(m, body);
            }
            StmtKind::Print(list) => values.extend(&m.program[list]),
            StmtKind::Assert { condition, message } => {
                values.push(condition);
                values.extend(message);
            }
            StmtKind::Return(value) => values.extend(value),
            StmtKind::Load(_)
            | StmtKind::Routine(_)
            | StmtKind::Break
            | StmtKind::Continue
            | StmtKind::Error => {}
        }
        values.into_iter().for_each(|expr| self.expression(m, expr));
    }

    /// What is assigned to is not read; its subscripts are.
    fn target(&mut self, m: &Module, target: ExprId, values: &mut Vec<ExprId>) {
        let mut at = target;
        loop {
            match m.program[at].kind {
                ExprKind::Name(_) => return,
                ExprKind::Paren(inner) | ExprKind::Member { base: inner, .. } => at = inner,
                ExprKind::Index { base, subs } => {
                    for sub in &m.program[subs] {
                        match *sub {
                            Subscript::Whole => {}
                            Subscript::At(at) => values.push(at),
                            Subscript::Range { from, to, step } => {
                                values.extend([from, to, step].into_iter().flatten());
                            }
                        }
                    }
                    at = base;
                }
                _ => return values.push(at),
            }
        }
    }

    fn expression(&mut self, m: &Module, expr: ExprId) {
        let mut stack = vec![expr];
        while let Some(id) = stack.pop() {
            match m.program[id].kind {
                ExprKind::Name(symbol) => drop(self.read.insert(symbol)),
                ExprKind::Paren(inner) | ExprKind::Magnitude(inner) => stack.push(inner),
                ExprKind::List(items) => stack.extend(&m.program[items]),
                ExprKind::Unary { operand, .. } => stack.push(operand),
                ExprKind::Binary { left, right, .. } => stack.extend([left, right]),
                ExprKind::Chain(items) => {
                    stack.extend(m.program[items].iter().filter_map(|item| match item {
                        ChainItem::Operand(operand) => Some(*operand),
                        _ => None,
                    }));
                }
                ExprKind::Index { base, subs } => {
                    stack.push(base);
                    for sub in &m.program[subs] {
                        match *sub {
                            Subscript::Whole => {}
                            Subscript::At(at) => stack.push(at),
                            Subscript::Range { from, to, step } => {
                                stack.extend([from, to, step].into_iter().flatten());
                            }
                        }
                    }
                }
                ExprKind::Member { base, .. } => stack.push(base),
                ExprKind::Call { callee, args } => {
                    stack.push(callee);
                    stack.extend(m.program[args].iter().map(|arg| arg.value));
                }
                ExprKind::Number(_) | ExprKind::Text(_) | ExprKind::Error => {}
            }
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
    }
    uses.read.iter().map(|symbol| m.names[symbol.0 as usize]).collect()
}

/// True when a file does something by itself; files that only define are there to be loaded.
pub(super) fn does_something(m: &Module) -> bool {
    m.program[m.program.body()].iter().any(|&stmt| {
        !matches!(
            m.program[stmt].kind,
            StmtKind::Declare { .. }
                | StmtKind::Param { .. }
                | StmtKind::Load(_)
                | StmtKind::Routine(_)
                | StmtKind::Assert { .. }
                | StmtKind::Error
        )
    })
}
