//! Names that are used before they are declared, and cycles among them.

use crate::run::parts;
use crate::source::module::Module;
use moldloft_diag::{Diagnostic, Span};
use moldloft_syntax::sdl::{ExprId, ExprKind, Ident, StmtId, StmtKind, Symbol};
use std::collections::{HashMap, HashSet};

/// A declaration that follows its use.
pub(crate) struct Later {
    name: Ident,
    /// The cycle of objects, if the later one depends on its user.
    cycle: Option<Vec<Symbol>>,
}

impl Later {
    pub fn explain(&self, m: &Module, diagnostic: Diagnostic) -> Diagnostic {
        if let Some(cycle) = &self.cycle {
            let names: Vec<&str> = cycle.iter().map(|&s| m.program.name(s)).collect();
            let text = names[0];
            return Diagnostic::error("cycle", format!("`{text}` depends on itself"))
                .at(diagnostic.span())
                .found(names.join(" -> "))
                .note_at(self.name.span, "declared here")
                .help("remove the circular dependency");
        }
        let text = m.program.name(self.name.symbol);
        diagnostic
            .note_at(self.name.span, "declared here, after its use")
            .help(format!("move the declaration of `{text}` before this line"))
    }
}

/// The object declaration of `symbol` that ends after `used`, if there is one in the file.
pub(crate) fn declared_later(m: &Module, symbol: Symbol, used: Span) -> Option<Later> {
    let mut objects = HashMap::new();
    let mut user = None;
    let mut stack: Vec<StmtId> = m.program[m.program.body()].to_vec();
    while let Some(id) = stack.pop() {
        match m.program[id].kind {
            StmtKind::Object { name, args, .. } => {
                let values: Vec<ExprId> = m.program[args].iter().map(|a| a.value).collect();
                let span = m.program[id].span;
                if span.start <= used.start && used.end <= span.end {
                    user = Some(name.symbol);
                }
                objects.entry(name.symbol).or_insert((name, values));
            }
            _ => stack.extend(parts::of_statement(m, id).inner),
        }
    }
    let &(name, _) = objects
        .get(&symbol)
        .filter(|(name, _)| name.span.end > used.start || user == Some(symbol))?;
    let cycle = user.and_then(|user| path(m, &objects, symbol, user)).map(|mut path| {
        path.push(symbol);
        path
    });
    Some(Later { name, cycle })
}

/// The names from `from` to `to` along "is built on", found without recursion.
fn path(
    m: &Module,
    objects: &HashMap<Symbol, (Ident, Vec<ExprId>)>,
    from: Symbol,
    to: Symbol,
) -> Option<Vec<Symbol>> {
    let mut came_from: HashMap<Symbol, Symbol> = HashMap::new();
    let mut seen = HashSet::from([from]);
    let mut stack = vec![from];
    while let Some(at) = stack.pop() {
        if at == to {
            let mut path = vec![to];
            let mut at = to;
            while at != from {
                at = came_from[&at];
                path.push(at);
            }
            path.reverse();
            return Some(path);
        }
        let Some((_, values)) = objects.get(&at) else { continue };
        for &value in values {
            names_in(m, value, &mut |name| {
                if seen.insert(name) {
                    came_from.insert(name, at);
                    stack.push(name);
                }
            });
        }
    }
    None
}

/// Calls `f` with the names in an expression, without recursion.
pub(crate) fn names_in(m: &Module, expr: ExprId, f: &mut impl FnMut(Symbol)) {
    let mut stack = vec![expr];
    while let Some(expr) = stack.pop() {
        match m.program[expr].kind {
            ExprKind::Name(symbol) => f(symbol),
            _ => stack.extend(parts::of_expression(m, expr)),
        }
    }
}
