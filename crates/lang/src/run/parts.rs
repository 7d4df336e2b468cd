//! Parts of statements and expressions, for all static analyses of a program.

use crate::source::module::Module;
use moldloft_syntax::sdl::{
    ChainItem, ExprId, ExprKind, ListLength, NodeList, StmtId, StmtKind, Subscript,
};

/// The expressions of a statement, and the statements in it, each in the order of the text. The
/// target of an assignment is one of its expressions; the elements of a block and the body of a
/// loop are statements in it.
#[derive(Default)]
pub(super) struct StatementParts {
    pub values: Vec<ExprId>,
    pub inner: Vec<StmtId>,
}

pub(super) fn of_statement(m: &Module, stmt: StmtId) -> StatementParts {
    let (mut values, mut inner) = (Vec::new(), Vec::new());
    match m.program[stmt].kind {
        StmtKind::Block(list) => inner.extend(&m.program[list]),
        StmtKind::Declare { items, .. } => {
            for item in &m.program[items] {
                if let Some(ListLength::Of(length)) = item.list {
                    values.push(length);
                }
                values.extend(&m.program[item.dims]);
                values.extend(item.value);
            }
        }
        StmtKind::Param { value, range, .. } => {
            values.push(value);
            values.extend(range.into_iter().flat_map(|(low, high)| [low, high]));
        }
        StmtKind::Object { args, .. } => {
            values.extend(m.program[args].iter().map(|arg| arg.value));
        }
        StmtKind::Assign { target, value, .. } => values.extend([target, value]),
        StmtKind::Call(expr) => values.push(expr),
        StmtKind::If { condition, then, otherwise } => {
            values.push(condition);
            inner.push(then);
            inner.extend(otherwise);
        }
        StmtKind::While { condition, body } => {
            values.push(condition);
            inner.push(body);
        }
        StmtKind::ForRange { from, to, step, body, .. } => {
            values.extend([Some(from), Some(to), step].into_iter().flatten());
            inner.push(body);
        }
        StmtKind::For { start, condition, step, body } => {
            values.extend(condition);
            inner.extend([start, Some(body), step].into_iter().flatten());
        }
        StmtKind::Foreach { list, body, .. } => {
            values.push(list);
            inner.push(body);
        }
        StmtKind::Print(list) => values.extend(&m.program[list]),
        StmtKind::Assert { condition, message } => {
            values.push(condition);
            values.extend(message);
        }
        StmtKind::Return(value) => values.extend(value),
        StmtKind::Record { members, .. } => inner.extend(&m.program[members]),
        StmtKind::Load(_)
        | StmtKind::Routine(_)
        | StmtKind::Break
        | StmtKind::Continue
        | StmtKind::Error => {}
    }
    StatementParts { values, inner }
}

/// The direct subexpressions of an expression, in the order of the text, with the callee.
pub(super) fn of_expression(m: &Module, expr: ExprId) -> Vec<ExprId> {
    match m.program[expr].kind {
        ExprKind::Paren(inner) | ExprKind::Magnitude(inner) => vec![inner],
        ExprKind::List(items) => m.program[items].to_vec(),
        ExprKind::Unary { operand, .. } => vec![operand],
        ExprKind::Binary { left, right, .. } => vec![left, right],
        ExprKind::Chain(items) => operands(m, items),
        ExprKind::Index { base, subs } => {
            let mut all = vec![base];
            all.extend(of_subscripts(m, subs));
            all
        }
        ExprKind::Member { base, .. } => vec![base],
        ExprKind::Call { callee, args } => {
            let mut all = vec![callee];
            all.extend(m.program[args].iter().map(|arg| arg.value));
            all
        }
        ExprKind::Number(_) | ExprKind::Name(_) | ExprKind::Text(_) | ExprKind::Error => Vec::new(),
    }
}

fn operands(m: &Module, items: NodeList<ChainItem>) -> Vec<ExprId> {
    let operand = |item: &ChainItem| match item {
        ChainItem::Operand(operand) => Some(*operand),
        _ => None,
    };
    m.program[items].iter().filter_map(operand).collect()
}

pub(super) fn of_subscripts(m: &Module, subs: NodeList<Subscript>) -> Vec<ExprId> {
    let mut all = Vec::new();
    for sub in &m.program[subs] {
        match *sub {
            Subscript::Whole => {}
            Subscript::At(at) => all.push(at),
            Subscript::Range { from, to, step } => {
                all.extend([from, to, step].into_iter().flatten());
            }
        }
    }
    all
}
