//! Position of a call's fault in the text, by its argument.

use crate::source::module::Module;
use moldloft_diag::{Diagnostic, Span};
use moldloft_registry::{Argument, CallError, Row};
use moldloft_syntax::sdl::{Arg, ExprId, ExprKind, NodeList};

/// The fault as a diagnostic without a position.
pub fn unplaced(fault: &CallError) -> Diagnostic {
    let mut diagnostic = Diagnostic::error(fault.id, fault.message.clone());
    if let Some(expected) = &fault.expected {
        diagnostic = diagnostic.expected(expected.clone());
    }
    if let Some(found) = &fault.found {
        diagnostic = diagnostic.found(found.clone());
    }
    for help in &fault.help {
        diagnostic = diagnostic.help(help.clone());
    }
    diagnostic
}

/// The fault of a call at the argument concerned, or at `whole` if that is unknown.
pub fn diagnostic(
    m: &Module,
    args: NodeList<Arg>,
    row: &Row,
    positional: usize,
    fault: &CallError,
    whole: Span,
) -> Diagnostic {
    unplaced(fault).at(span(m, args, row, positional, fault).unwrap_or(whole))
}

fn span(
    m: &Module,
    args: NodeList<Arg>,
    row: &Row,
    positional: usize,
    fault: &CallError,
) -> Option<Span> {
    let place = fault.place?;
    let args = &m.program[args];
    let expr = match place.argument {
        Argument::Extra => args.get(row.fields.len())?.value,
        Argument::Named(k) => {
            let arg = args.iter().filter(|a| a.name.is_some()).nth(k)?;
            if fault.id == "unknown-argument" {
                return arg.name.map(|n| n.span);
            }
            arg.value
        }
        Argument::Field(field) => {
            let field = field.position();
            // An item of a list given as separate arguments is an argument of its own.
            let spread = row.fields.get(field)?.variadic && positional > field + 1;
            let at = field + place.item.filter(|_| spread).unwrap_or(0);
            if let Some(arg) = args.iter().filter(|a| a.name.is_none()).nth(at).filter(|_| spread) {
                arg.value
            } else {
                argument(m, args, row, positional, field)?
            }
        }
    };
    let item = place.item.and_then(|k| item(m, expr, k));
    Some(m.program[item.unwrap_or(expr)].span)
}

/// The expression given for a field.
pub fn argument(
    m: &Module,
    args: &[Arg],
    row: &Row,
    positional: usize,
    field: usize,
) -> Option<ExprId> {
    let unnamed = args.iter().filter(|a| a.name.is_none());
    if field < positional
        && let Some(arg) = unnamed.clone().nth(field)
    {
        return Some(arg.value);
    }
    let name = row.fields.get(field)?.name;
    let named = |a: &&Arg| a.name.is_some_and(|n| m.program.name(n.symbol) == name);
    args.iter().find(named).map(|a| a.value)
}

/// The expression of item `k` of a list literal.
pub fn item(m: &Module, expr: ExprId, k: usize) -> Option<ExprId> {
    match m.program[m.program.bare(expr)].kind {
        ExprKind::List(items) => m.program[items].get(k).copied(),
        _ => None,
    }
}
