//! The tree as text without spans, for comparison and for reading.

use super::ast::*;
use super::interner::Symbol;
use super::program::Program;
use std::fmt::Write;

impl Program {
    /// The tree as nested lists, one top-level statement per line, without positions and redundant
    /// parentheses: two programs have the same meaning if and only if their dumps are equal
    /// (numbers are compared bit for bit).
    pub fn dump(&self) -> String {
        let mut out = String::new();
        for stmt in &self[self.body] {
            self.dump_stmt(*stmt, &mut out);
            out.push('\n');
        }
        out
    }

    /// One expression in the form of [`Program::dump`].
    pub fn dump_of(&self, expr: ExprId) -> String {
        let mut out = String::new();
        self.dump_expr(expr, &mut out);
        out
    }

    fn word(&self, symbol: Symbol, out: &mut String) {
        out.push(' ');
        out.push_str(self.name(symbol));
    }

    fn dump_type(&self, ty: Type, out: &mut String) {
        match ty {
            Type::Other(symbol) => {
                let _ = write!(out, " {}", self.name(symbol));
            }
            Type::List(item) => {
                self.dump_type(item.ty(), out);
                out.push_str("[]");
            }
            known => {
                let _ = write!(out, " {known:?}");
            }
        }
    }

    fn dump_stmts(&self, list: NodeList<StmtId>, out: &mut String) {
        for stmt in &self[list] {
            out.push(' ');
            self.dump_stmt(*stmt, out);
        }
    }

    fn dump_exprs(&self, exprs: impl IntoIterator<Item = ExprId>, out: &mut String) {
        for expr in exprs {
            out.push(' ');
            self.dump_expr(expr, out);
        }
    }

    fn dump_args(&self, args: NodeList<Arg>, out: &mut String) {
        for arg in &self[args] {
            out.push(' ');
            if let Some(name) = arg.name {
                let _ = write!(out, "{}=", self.name(name.symbol));
            }
            self.dump_expr(arg.value, out);
        }
    }

    fn dump_stmt(&self, stmt: StmtId, out: &mut String) {
        out.push('(');
        match self[stmt].kind {
            StmtKind::Block(list) => {
                out.push_str("block");
                self.dump_stmts(list, out);
            }
            StmtKind::Load(path) => {
                let _ = write!(out, "load {:?}", &self[path]);
            }
            StmtKind::Routine(id) => self.dump_routine(id, out),
            StmtKind::Declare { global, ty, items } => {
                out.push_str(if global { "global" } else { "declare" });
                self.dump_type(ty.0, out);
                for item in &self[items] {
                    out.push_str(" (");
                    out.push_str(self.name(item.name.symbol));
                    match item.list {
                        None => {}
                        Some(ListLength::Open) => out.push_str(" []"),
                        Some(ListLength::Of(length)) => {
                            out.push_str(" [");
                            self.dump_exprs([length], out);
                            out.push_str(" ]");
                        }
                    }
                    out.push_str(" [");
                    self.dump_exprs(self[item.dims].iter().copied(), out);
                    out.push_str(" ]");
                    self.dump_exprs(item.value, out);
                    out.push(')');
                }
            }
            StmtKind::Record { name, members } => {
                out.push_str("record");
                self.word(name.symbol, out);
                self.dump_stmts(members, out);
            }
            StmtKind::Param { ty, name, value, range } => {
                out.push_str("param");
                if let Some((ty, _)) = ty {
                    self.dump_type(ty, out);
                }
                self.word(name.symbol, out);
                self.dump_exprs([value], out);
                if let Some((low, high)) = range {
                    out.push_str(" in");
                    self.dump_exprs([low, high], out);
                }
            }
            StmtKind::Object { kind, name, args } => {
                out.push_str("object");
                self.word(kind.symbol, out);
                self.word(name.symbol, out);
                self.dump_args(args, out);
            }
            StmtKind::Assign { target, op, value } => {
                out.push_str(match op {
                    AssignOp::Set => "",
                    AssignOp::With(op) => op.spelling(),
                });
                out.push('=');
                self.dump_exprs([target, value], out);
            }
            StmtKind::Call(call) => {
                out.push_str("do");
                self.dump_exprs([call], out);
            }
            StmtKind::If { condition, then, otherwise } => {
                out.push_str("if");
                self.dump_exprs([condition], out);
                for branch in std::iter::once(then).chain(otherwise) {
                    out.push(' ');
                    self.dump_stmt(branch, out);
                }
            }
            StmtKind::While { condition, body } => {
                out.push_str("while");
                self.dump_exprs([condition], out);
                out.push(' ');
                self.dump_stmt(body, out);
            }
            StmtKind::ForRange { variable, from, to, step, body } => {
                out.push_str("for-range");
                self.word(variable.symbol, out);
                self.dump_exprs([from, to].into_iter().chain(step), out);
                out.push(' ');
                self.dump_stmt(body, out);
            }
            StmtKind::For { start, condition, step, body } => {
                out.push_str("for ");
                match start {
                    Some(start) => self.dump_stmt(start, out),
                    None => out.push('-'),
                }
                match condition {
                    Some(condition) => self.dump_exprs([condition], out),
                    None => out.push_str(" -"),
                }
                out.push(' ');
                match step {
                    Some(step) => self.dump_stmt(step, out),
                    None => out.push('-'),
                }
                out.push(' ');
                self.dump_stmt(body, out);
            }
            StmtKind::Foreach { variable, list, body } => {
                out.push_str("foreach");
                self.word(variable.symbol, out);
                self.dump_exprs([list], out);
                out.push(' ');
                self.dump_stmt(body, out);
            }
            StmtKind::Print(list) => {
                out.push_str("print");
                self.dump_exprs(self[list].iter().copied(), out);
            }
            StmtKind::Assert { condition, message } => {
                out.push_str("assert");
                self.dump_exprs([condition].into_iter().chain(message), out);
            }
            StmtKind::Break => out.push_str("break"),
            StmtKind::Continue => out.push_str("continue"),
            StmtKind::Return(value) => {
                out.push_str("return");
                self.dump_exprs(value, out);
            }
            StmtKind::Error => out.push_str("error"),
        }
        out.push(')');
    }

    fn dump_routine(&self, id: RoutineId, out: &mut String) {
        let routine = &self[id];
        out.push_str(if routine.result.is_some() { "function" } else { "subroutine" });
        if let Some((ty, _)) = routine.result {
            self.dump_type(ty, out);
        }
        self.word(routine.name.symbol, out);
        out.push_str(" (");
        for formal in &self[routine.formals] {
            out.push_str(if formal.returned { " (returned" } else { " (" });
            self.dump_type(formal.ty.0, out);
            self.word(formal.name.symbol, out);
            self.dump_exprs(formal.default, out);
            out.push_str(if formal.multiple { "...)" } else { ")" });
        }
        out.push(')');
        self.dump_stmts(routine.body, out);
    }

    fn dump_expr(&self, expr: ExprId, out: &mut String) {
        let expr = &self[self.bare(expr)];
        match expr.kind {
            ExprKind::Number(id) => {
                let literal = self[id];
                let kind = if literal.is_int { "i" } else { "" };
                let _ = write!(out, "{:?}{kind}", literal.value);
                return;
            }
            ExprKind::Unary { op: UnaryOp::Minus, operand } => {
                // The same as a literal with a sign.
                if let Some(id) = self.as_literal(operand) {
                    let kind = if self[id].is_int { "i" } else { "" };
                    let _ = write!(out, "{:?}{kind}", -self[id].value);
                    return;
                }
            }
            ExprKind::Text(id) => {
                let _ = write!(out, "{:?}", &self[id]);
                return;
            }
            ExprKind::Name(symbol) => {
                out.push_str(self.name(symbol));
                return;
            }
            _ => {}
        }
        out.push('(');
        match expr.kind {
            ExprKind::List(list) => {
                out.push_str("list");
                self.dump_exprs(self[list].iter().copied(), out);
            }
            ExprKind::Magnitude(inner) => {
                out.push_str("||");
                self.dump_exprs([inner], out);
            }
            ExprKind::Unary { op, operand } => {
                out.push_str(op.spelling());
                self.dump_exprs([operand], out);
            }
            ExprKind::Binary { op, left, right } => {
                out.push_str(op.spelling());
                self.dump_exprs([left, right], out);
            }
            ExprKind::Chain(items) => {
                out.push_str("chain");
                for item in &self[items] {
                    out.push(' ');
                    match item {
                        ChainItem::Operand(operand) => self.dump_expr(*operand, out),
                        ChainItem::Prefix(op, _) => out.push_str(op.spelling()),
                        ChainItem::Infix(op, _) => out.push_str(op.spelling()),
                    }
                }
            }
            ExprKind::Index { base, subs } => {
                out.push_str("at");
                self.dump_exprs([base], out);
                for sub in &self[subs] {
                    match *sub {
                        Subscript::Whole => out.push_str(" :"),
                        Subscript::At(index) => self.dump_exprs([index], out),
                        Subscript::Range { from, to, step } => {
                            out.push_str(" (range");
                            for part in [from, to, step] {
                                match part {
                                    Some(part) => self.dump_exprs([part], out),
                                    None => out.push_str(" -"),
                                }
                            }
                            out.push(')');
                        }
                    }
                }
            }
            ExprKind::Member { base, name, or_dot } => {
                out.push_str(if or_dot { "member-or-dot" } else { "member" });
                self.dump_exprs([base], out);
                self.word(name, out);
            }
            ExprKind::Call { callee, args } => {
                out.push_str("call");
                self.dump_exprs([callee], out);
                self.dump_args(args, out);
            }
            _ => out.push_str("error"),
        }
        out.push(')');
    }
}
