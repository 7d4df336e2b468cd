//! The names of a text: the positions of each, its declaration, and the routine it is local to.
//! Invariant: uses syntax only, so mentions do not depend on a run.

use moldloft_diag::Span;
use moldloft_syntax::sdl::{
    Arg, ChainItem, Declarator, ExprId, ExprKind, Ident, ItemType, ListLength, NodeList, Program,
    RoutineId, StmtId, StmtKind, Subscript, Symbol, TextId, Type,
};
use std::collections::HashSet;

/// A name in the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Mention {
    pub symbol: Symbol,
    pub span: Span,
    pub declares: bool,
    /// The routine that the name is local to.
    pub local_to: Option<RoutineId>,
}

/// A member: `base.name`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MemberMention {
    /// The expression before the dot, if it is a plain name.
    pub base: Option<Symbol>,
    pub name: Symbol,
    pub span: Span,
}

/// A call or an object: the callee and the arguments.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CallMention {
    pub callee: Symbol,
    /// The object's name.
    pub object: Option<Symbol>,
    pub args: NodeList<Arg>,
}

/// All mentions of a text, in order.
#[derive(Debug, Default)]
pub(crate) struct Mentions {
    pub names: Vec<Mention>,
    pub members: Vec<MemberMention>,
    pub calls: Vec<CallMention>,
    /// The files that it loads, with the `load` statements.
    pub loads: Vec<(TextId, Span)>,
}

/// Collects the names of a file.
struct Walk<'m> {
    m: &'m Program,
    found: Mentions,
    locals: HashSet<Symbol>,
    routine: Option<RoutineId>,
}

impl Walk<'_> {
    fn name(&mut self, symbol: Symbol, span: Span, declares: bool) {
        let local = self.locals.contains(&symbol);
        let local_to = self.routine.filter(|_| local);
        self.found.names.push(Mention { symbol, span, declares, local_to });
    }

    fn ident(&mut self, ident: Ident, declares: bool) {
        self.name(ident.symbol, ident.span, declares);
    }

    fn args(&mut self, args: NodeList<Arg>) {
        self.m[args].iter().for_each(|arg| self.expr(arg.value));
    }

    fn exprs(&mut self, list: NodeList<ExprId>) {
        self.m[list].iter().for_each(|&e| self.expr(e));
    }

    fn expr(&mut self, id: ExprId) {
        let m = self.m;
        match m[id].kind {
            ExprKind::Name(symbol) => self.name(symbol, m[id].span, false),
            ExprKind::Number(_) | ExprKind::Text(_) | ExprKind::Error => {}
            ExprKind::Paren(e) | ExprKind::Magnitude(e) | ExprKind::Unary { operand: e, .. } => {
                self.expr(e);
            }
            ExprKind::List(list) => self.exprs(list),
            ExprKind::Binary { left, right, .. } => {
                self.expr(left);
                self.expr(right);
            }
            ExprKind::Chain(items) => {
                for item in &m[items] {
                    if let ChainItem::Operand(e) = item {
                        self.expr(*e);
                    }
                }
            }
            ExprKind::Index { base, subs } => {
                self.expr(base);
                for sub in &m[subs] {
                    match *sub {
                        Subscript::Whole => {}
                        Subscript::At(e) => self.expr(e),
                        Subscript::Range { from, to, step } => {
                            [from, to, step].into_iter().flatten().for_each(|e| self.expr(e));
                        }
                    }
                }
            }
            ExprKind::Member { base, name, .. } => {
                self.expr(base);
                let span = m.member_span(id);
                self.found.members.push(MemberMention { base: m.as_name(base), name, span });
            }
            ExprKind::Call { callee, args } => {
                self.expr(callee);
                if let Some(callee) = m.as_name(callee) {
                    self.found.calls.push(CallMention { callee, object: None, args });
                }
                self.args(args);
            }
        }
    }

    fn stmts(&mut self, list: NodeList<StmtId>) {
        self.m[list].iter().for_each(|&s| self.stmt(s));
    }

    fn stmt(&mut self, id: StmtId) {
        let m = self.m;
        match m[id].kind {
            StmtKind::Block(list) => self.stmts(list),
            StmtKind::Load(file) => self.found.loads.push((file, m[id].span)),
            StmtKind::Break | StmtKind::Continue | StmtKind::Error => {}
            StmtKind::Routine(at) => self.routine(at),
            StmtKind::Record { name, members } => {
                self.ident(name, true);
                // Its members are not names of the file.
                for &stmt in &m[members] {
                    let StmtKind::Declare { items, .. } = m[stmt].kind else { continue };
                    m[items].iter().for_each(|item| self.declarator(item));
                }
            }
            StmtKind::Declare { ty, items, .. } => {
                self.type_word(ty);
                for item in &m[items] {
                    self.declarator(item);
                    self.ident(item.name, true);
                }
            }
            StmtKind::Param { name, value, range, .. } => {
                self.expr(value);
                for e in range.into_iter().flat_map(|(a, b)| [a, b]) {
                    self.expr(e);
                }
                self.ident(name, true);
            }
            StmtKind::Object { kind, name, args } => {
                self.ident(kind, false);
                let object = Some(name.symbol);
                self.found.calls.push(CallMention { callee: kind.symbol, object, args });
                self.args(args);
                self.ident(name, true);
            }
            StmtKind::Assign { target, value, .. } => {
                self.expr(target);
                self.expr(value);
            }
            StmtKind::Call(e) => self.expr(e),
            StmtKind::If { condition, then, otherwise } => {
                self.expr(condition);
                self.stmt(then);
                otherwise.into_iter().for_each(|s| self.stmt(s));
            }
            StmtKind::While { condition, body } => {
                self.expr(condition);
                self.stmt(body);
            }
            StmtKind::ForRange { variable, from, to, step, body } => {
                [Some(from), Some(to), step].into_iter().flatten().for_each(|e| self.expr(e));
                self.ident(variable, true);
                self.stmt(body);
            }
            StmtKind::For { start, condition, step, body } => {
                start.into_iter().for_each(|s| self.stmt(s));
                condition.into_iter().for_each(|e| self.expr(e));
                step.into_iter().for_each(|s| self.stmt(s));
                self.stmt(body);
            }
            StmtKind::Foreach { variable, list, body } => {
                self.expr(list);
                self.ident(variable, true);
                self.stmt(body);
            }
            StmtKind::Print(list) => self.exprs(list),
            StmtKind::Assert { condition, message } => {
                self.expr(condition);
                message.into_iter().for_each(|e| self.expr(e));
            }
            StmtKind::Return(value) => value.into_iter().for_each(|e| self.expr(e)),
        }
    }

    /// The expressions of a declared variable.
    fn declarator(&mut self, item: &Declarator) {
        if let Some(ListLength::Of(length)) = item.list {
            self.expr(length);
        }
        self.exprs(item.dims);
        item.value.into_iter().for_each(|e| self.expr(e));
    }

    /// The name of a record used as a type.
    fn type_word(&mut self, (ty, span): (Type, Span)) {
        if let Type::Other(symbol) | Type::List(ItemType::Other(symbol)) = ty {
            self.name(symbol, span, false);
        }
    }

    fn routine(&mut self, at: RoutineId) {
        let routine = self.m[at];
        routine.result.into_iter().for_each(|ty| self.type_word(ty));
        self.ident(routine.name, true);
        let mut inner = Locals { m: self.m, found: HashSet::new() };
        for formal in &self.m[routine.formals] {
            inner.found.insert(formal.name.symbol);
        }
        inner.stmts(routine.body);
        let outer = (std::mem::replace(&mut self.locals, inner.found), self.routine);
        self.routine = Some(at);
        for formal in &self.m[routine.formals] {
            self.type_word(formal.ty);
            self.ident(formal.name, true);
            formal.default.into_iter().for_each(|e| self.expr(e));
        }
        self.stmts(routine.body);
        (self.locals, self.routine) = outer;
    }
}

/// The local names that the statements of a routine declare.
struct Locals<'m> {
    m: &'m Program,
    found: HashSet<Symbol>,
}

impl Locals<'_> {
    fn stmts(&mut self, list: NodeList<StmtId>) {
        self.m[list].iter().for_each(|&s| self.stmt(s));
    }

    fn stmt(&mut self, id: StmtId) {
        match self.m[id].kind {
            StmtKind::Block(list) => self.stmts(list),
            StmtKind::Declare { global: false, items, .. } => {
                let names = self.m[items].iter().map(|item| item.name.symbol);
                self.found.extend(names);
            }
            StmtKind::Object { name, .. } => drop(self.found.insert(name.symbol)),
            StmtKind::If { then, otherwise, .. } => {
                self.stmt(then);
                otherwise.into_iter().for_each(|s| self.stmt(s));
            }
            StmtKind::While { body, .. } => self.stmt(body),
            StmtKind::ForRange { variable, body, .. }
            | StmtKind::Foreach { variable, body, .. } => {
                self.found.insert(variable.symbol);
                self.stmt(body);
            }
            StmtKind::For { start, body, .. } => {
                start.into_iter().for_each(|s| self.stmt(s));
                self.stmt(body);
            }
            _ => {}
        }
    }
}

/// All mentions of a program.
pub(crate) fn mentions(m: &Program) -> Mentions {
    let mut walk = Walk { m, found: Mentions::default(), locals: HashSet::new(), routine: None };
    walk.stmts(m.body());
    walk.found
}
