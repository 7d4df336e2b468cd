//! Statements.

use super::super::ast::*;
use super::super::token::{ASSERT, IN, Kind, PARAM, RECORD};
use super::{Parse, Parser, Reported, TokenRole, close_list, foreign_word};
use moldloft_diag::{Diagnostic, Span};

impl Parser {
    /// Statements up to the `}` that closes `open`, or to the end of the text.
    pub(super) fn statements(&mut self, open: Option<Span>, depth: u32) -> NodeList<StmtId> {
        let base = self.stmts.len();
        loop {
            match self.kind() {
                Kind::End => break,
                Kind::RBrace if open.is_some() => break,
                Kind::RBrace => {
                    let place = self.span(self.token());
                    self.report(Diagnostic::error("unexpected-token", "unmatched `}`").at(place));
                    self.next();
                }
                Kind::Semi => {
                    self.start_line(depth);
                    self.next_as(TokenRole::Redundant);
                }
                _ => {
                    self.start_line(depth);
                    let stmt = self.recovered_statement(depth);
                    self.stmts.push(stmt);
                }
            }
        }
        if let Some(open) = open.filter(|_| self.kind() == Kind::End && !self.end_is_reported) {
            self.end_is_reported = true;
            let diagnostic = Diagnostic::error("unclosed-bracket", "this block is not closed");
            self.report(diagnostic.at(open).expected("`}`").found("the end of the text"));
        }
        close_list(&mut self.stmts, base, &mut self.program.stmt_lists)
    }

    /// One statement; an `Error` statement if it could not be understood. Takes at least one token.
    fn recovered_statement(&mut self, depth: u32) -> StmtId {
        let start = self.at;
        let scratch = (self.exprs.len(), self.args.len(), self.subs.len(), self.declarators.len());
        let magnitudes = std::mem::take(&mut self.magnitudes);
        let stmts = self.stmts.len();
        let result = match self.enter() {
            Ok(()) => {
                let result = self.statement(depth);
                self.leave();
                result
            }
            Err(Reported) => Err(Reported),
        };
        self.magnitudes = magnitudes;
        self.exprs.truncate(scratch.0);
        self.args.truncate(scratch.1);
        self.subs.truncate(scratch.2);
        self.declarators.truncate(scratch.3);
        self.stmts.truncate(stmts);
        self.or_recover(start, result).unwrap_or_else(|| {
            self.orphaned_block(start, depth);
            if self.at == start {
                self.next();
            }
            let span = self.span_from(self.tokens[start].start);
            self.push_stmt(StmtKind::Error, span)
        })
    }

    /// Parses the block of a routine or loop whose head was not understood, to find the faults in it, and only those.
    fn orphaned_block(&mut self, start: usize, depth: u32) {
        if self.kind() != Kind::LBrace || self.at == start || self.enter().is_err() {
            return;
        }
        let outer = (self.in_routine, self.loops);
        match self.tokens[start].kind {
            Kind::Subroutine | Kind::Function => self.in_routine = true,
            Kind::While | Kind::For | Kind::Foreach => self.loops += 1,
            _ => {}
        }
        // It cannot fail: faults inside are dealt with there.
        let _ = self.block(depth);
        (self.in_routine, self.loops) = outer;
        self.leave();
    }

    fn statement(&mut self, depth: u32) -> Parse<StmtId> {
        let token = self.token();
        let start = token.start;
        let kind = match token.kind {
            Kind::LBrace => StmtKind::Block(self.block(depth)?),
            Kind::Load => return self.load(),
            Kind::Subroutine | Kind::Function => return self.routine(depth),
            Kind::Global | Kind::TypeWord => return self.declaration(),
            Kind::If => self.if_statement(depth)?,
            Kind::While => {
                self.next();
                let condition = self.condition()?;
                StmtKind::While { condition, body: self.loop_body(depth)? }
            }
            Kind::For => self.for_statement(depth)?,
            Kind::Foreach => self.foreach_statement(depth)?,
            Kind::Print => {
                self.next();
                let base = self.exprs.len();
                loop {
                    let value = self.expr()?;
                    self.exprs.push(value);
                    if !self.eat(Kind::Comma) {
                        break;
                    }
                }
                let list = close_list(&mut self.exprs, base, &mut self.program.expr_lists);
                self.expect_semi("`,` or `;`")?;
                StmtKind::Print(list)
            }
            Kind::Break | Kind::Continue => {
                self.next();
                if self.loops == 0 {
                    let word = self.program.slice(self.span(token));
                    let message = format!("`{word}` outside a loop");
                    self.report(Diagnostic::error("stray-jump", message).at(self.span(token)));
                }
                self.expect_semi("`;`")?;
                if token.kind == Kind::Break { StmtKind::Break } else { StmtKind::Continue }
            }
            Kind::Return => {
                self.next();
                if !self.in_routine {
                    let message = "`return` outside a subroutine or function";
                    self.report(Diagnostic::error("stray-jump", message).at(self.span(token)));
                }
                let ends = self.token().new_line
                    || matches!(self.kind(), Kind::Semi | Kind::RBrace | Kind::End);
                let value = if ends { None } else { Some(self.expr()?) };
                self.expect_semi("an operator or `;`")?;
                StmtKind::Return(value)
            }
            Kind::Ident => return self.named_statement(depth),
            _ => return Err(self.unexpected("a statement")),
        };
        Ok(self.push_stmt(kind, self.span_from(start)))
    }

    fn named_statement(&mut self, depth: u32) -> Parse<StmtId> {
        let (first, second, third) = (self.token(), self.peek(1), self.peek(2));
        if first.is_ident(RECORD) && second.kind == Kind::Ident && third.kind == Kind::LBrace {
            return self.record(depth);
        }
        if first.is_ident(PARAM) && matches!(second.kind, Kind::Ident | Kind::TypeWord) {
            return self.param();
        }
        if first.is_ident(ASSERT) && starts_operand(second.kind) {
            return self.assertion();
        }
        if second.kind == Kind::Ident {
            return match third.kind {
                Kind::LParen => self.object(),
                Kind::Assign | Kind::Semi | Kind::Comma | Kind::LBracket => self.declaration(),
                _ => {
                    self.next();
                    Err(self.after_name(second.new_line))
                }
            };
        }
        let stmt = self.simple()?;
        self.expect_semi("an operator or `;`")?;
        let start = first.start;
        self.program.stmts[stmt.0 as usize].span = self.span_from(start);
        Ok(stmt)
    }

    /// Reports two names in a row that are no declaration; the second one is the current token.
    fn after_name(&mut self, new_line: bool) -> Reported {
        if new_line {
            return self.unexpected("`=`, `(` or `;` after the name before");
        }
        self.next();
        self.unexpected("`(` of an object, or `=`, `,`, `;` of a declaration")
    }

    /// `{ … }`.
    pub(super) fn block(&mut self, depth: u32) -> Parse<NodeList<StmtId>> {
        let open = self.next_as(TokenRole::BlockOpen);
        let list = self.statements(Some(self.span(open)), depth + 1);
        if self.kind() == Kind::RBrace {
            self.start_line(depth);
            self.next_as(TokenRole::BlockClose);
        }
        Ok(list)
    }

    /// The statement that a head governs.
    fn body(&mut self, depth: u32) -> Parse<StmtId> {
        let token = self.token();
        match token.kind {
            Kind::Semi => {
                self.next();
                return Ok(self.push_stmt(StmtKind::Block(NodeList::new(0, 0)), self.span(token)));
            }
            Kind::RBrace | Kind::End => return Err(self.unexpected("a statement")),
            _ => {}
        }
        let own_line = token.new_line && token.kind != Kind::LBrace;
        let depth = if own_line { depth + 1 } else { depth };
        if own_line {
            self.start_line(depth);
        }
        Ok(self.recovered_statement(depth))
    }

    fn loop_body(&mut self, depth: u32) -> Parse<StmtId> {
        self.loops += 1;
        let body = self.body(depth);
        self.loops -= 1;
        body
    }

    fn condition(&mut self) -> Parse<ExprId> {
        let open = self.expect(Kind::LParen, "`(`")?;
        let condition = self.expr()?;
        if self.kind() == Kind::Assign {
            let place = self.span(self.token());
            let diagnostic = Diagnostic::error(
                "unexpected-token",
                "`=` assigns; it is not allowed in a condition",
            )
            .at(place)
            .expected("`==` or another comparison")
            .found("`=`")
            .edit(place, "==", "compare with `==`");
            self.report(diagnostic);
            return Err(Reported);
        }
        self.expect_close(Kind::RParen, open, "`)` or an operator")?;
        Ok(condition)
    }

    fn if_statement(&mut self, depth: u32) -> Parse<StmtKind> {
        self.next();
        let condition = self.condition()?;
        self.eat(Kind::Then);
        let then = self.body(depth)?;
        let mut otherwise = None;
        if self.kind() == Kind::Else {
            if self.tokens[self.at - 1].kind != Kind::RBrace {
                self.start_line(depth);
            }
            self.next();
            otherwise = Some(if self.kind() == Kind::If {
                self.recovered_statement(depth)
            } else {
                self.body(depth)?
            });
        }
        Ok(StmtKind::If { condition, then, otherwise })
    }

    fn for_statement(&mut self, depth: u32) -> Parse<StmtKind> {
        self.next();
        let open = self.expect(Kind::LParen, "`(`")?;
        let mut start = None;
        if self.kind() == Kind::Ident && self.peek(1).kind == Kind::Assign {
            let variable = self.ident("a variable")?;
            self.next_as(TokenRole::Infix);
            let from = self.expr()?;
            if self.kind() == Kind::Colon {
                self.next_as(TokenRole::Tight);
                let to = self.expr()?;
                let mut step = None;
                if self.kind() == Kind::Colon {
                    self.next_as(TokenRole::Tight);
                    step = Some(self.expr()?);
                }
                self.expect_close(Kind::RParen, open, "`:` or `)`")?;
                let body = self.loop_body(depth)?;
                return Ok(StmtKind::ForRange { variable, from, to, step, body });
            }
            let target = self.push_expr(ExprKind::Name(variable.symbol), variable.span, 0);
            let kind = StmtKind::Assign { target, op: AssignOp::Set, value: from };
            start = Some(self.push_stmt(kind, self.span_from(variable.span.start)));
        } else if self.kind() != Kind::Semi {
            start = Some(self.simple()?);
        }
        self.mark(self.at, TokenRole::HeadSemi);
        self.expect(Kind::Semi, "`:` of a range or `;`")?;
        let condition = if self.kind() == Kind::Semi { None } else { Some(self.expr()?) };
        self.mark(self.at, TokenRole::HeadSemi);
        self.expect(Kind::Semi, "an operator or `;`")?;
        let step = if self.kind() == Kind::RParen { None } else { Some(self.simple()?) };
        self.expect_close(Kind::RParen, open, "an operator or `)`")?;
        Ok(StmtKind::For { start, condition, step, body: self.loop_body(depth)? })
    }

    fn foreach_statement(&mut self, depth: u32) -> Parse<StmtKind> {
        self.next();
        let open = self.expect(Kind::LParen, "`(`")?;
        let variable = self.ident("a variable")?;
        if !self.token().is_ident(IN) {
            return Err(self.unexpected("`in`"));
        }
        self.next();
        let list = self.expr()?;
        self.expect_close(Kind::RParen, open, "an operator or `)`")?;
        Ok(StmtKind::Foreach { variable, list, body: self.loop_body(depth)? })
    }

    fn load(&mut self) -> Parse<StmtId> {
        let word = self.next();
        let path = self.expect(Kind::Text, "the name of a file in quotes")?;
        self.eat(Kind::Semi);
        let span = self.span_from(word.start);
        if self.nesting > 1 || self.in_routine {
            let message = "`load` is allowed only at the top level of a file, not inside blocks";
            self.report(Diagnostic::error("misplaced-load", message).at(span));
        }
        Ok(self.push_stmt(StmtKind::Load(TextId(path.payload)), span))
    }

    fn declaration(&mut self) -> Parse<StmtId> {
        let start = self.token().start;
        let global = self.eat(Kind::Global);
        let ty = self.type_word("a type")?;
        let base = self.declarators.len();
        loop {
            let item = self.declarator()?;
            self.declarators.push(item);
            if !self.eat(Kind::Comma) {
                break;
            }
        }
        let items = close_list(&mut self.declarators, base, &mut self.program.declarator_lists);
        self.expect_semi("an operator, `,` or `;`")?;
        Ok(self.push_stmt(StmtKind::Declare { global, ty, items }, self.span_from(start)))
    }

    fn declarator(&mut self) -> Parse<Declarator> {
        let name = self.ident("the name of a variable")?;
        let (mut list, mut dims) = (None, NodeList::new(0, 0));
        if self.kind() == Kind::LBracket {
            dims = self.dimensions()?;
            if dims.is_empty() {
                list = Some(ListLength::Open);
            }
        }
        if self.kind() == Kind::LBracket {
            match self.program[dims] {
                [] => {}
                [length] => list = Some(ListLength::Of(length)),
                [_, second, ..] => {
                    let place = self.program[second].span;
                    let message = "a list has one length";
                    self.report(Diagnostic::error("too-many-dimensions", message).at(place));
                }
            }
            dims = self.dimensions()?;
        }
        let mut value = None;
        if self.kind() == Kind::Assign {
            self.next_as(TokenRole::Infix);
            value = Some(self.expr()?);
        }
        Ok(Declarator { name, list, dims, value })
    }

    /// `[m, n]`, or `[]`.
    fn dimensions(&mut self) -> Parse<NodeList<ExprId>> {
        let open = self.next_as(TokenRole::Applied);
        let base = self.exprs.len();
        if self.kind() != Kind::RBracket {
            loop {
                let dim = self.expr()?;
                self.exprs.push(dim);
                if !self.eat(Kind::Comma) {
                    break;
                }
            }
        }
        if self.exprs.len() - base > 3 {
            let place = self.program[self.exprs[base + 3]].span;
            let message = "an array has one to three dimensions";
            self.report(Diagnostic::error("too-many-dimensions", message).at(place));
        }
        let dims = close_list(&mut self.exprs, base, &mut self.program.expr_lists);
        self.expect_close(Kind::RBracket, open, "`,` or `]`")?;
        Ok(dims)
    }

    /// `record name { declarations }`.
    fn record(&mut self, depth: u32) -> Parse<StmtId> {
        let word = self.next();
        let name = self.ident("the name of the record")?;
        let members = self.block(depth)?;
        if self.nesting > 1 || self.in_routine {
            let message = "records are declared at the top level of a file, not inside blocks";
            self.report(Diagnostic::error("misplaced-record", message).at(self.span(word)));
        }
        let mut known: Vec<Ident> = Vec::new();
        for &stmt in &self.program[members].to_vec() {
            let Stmt { kind, span } = self.program[stmt];
            let StmtKind::Declare { global: false, items, .. } = kind else {
                if kind != StmtKind::Error {
                    let message = "a record holds declarations of its members";
                    self.report(
                        Diagnostic::error("misplaced-statement", message)
                            .at(span)
                            .expected("declarations such as `float span = 3;`"),
                    );
                }
                continue;
            };
            let declared = self.program[items].to_vec();
            for item in declared {
                if let Some(first) = known.iter().find(|own| own.symbol == item.name.symbol) {
                    let message = format!("two members `{}`", self.symbol_text(item.name.symbol));
                    let diagnostic = Diagnostic::error("duplicate-name", message)
                        .at(item.name.span)
                        .note_at(first.span, "the other one");
                    self.report(diagnostic);
                }
                known.push(item.name);
            }
        }
        Ok(self.push_stmt(StmtKind::Record { name, members }, self.span_from(word.start)))
    }

    fn param(&mut self) -> Parse<StmtId> {
        let start = self.next().start;
        let typed = self.kind() == Kind::TypeWord || self.peek(1).kind == Kind::Ident;
        let ty = if typed { Some(self.type_word("a type")?) } else { None };
        let name = self.ident("the name of the parameter")?;
        self.mark(self.at, TokenRole::Infix);
        self.expect(Kind::Assign, "`=` and the default value")?;
        let value = self.expr()?;
        let mut range = None;
        if self.token().is_ident(IN) {
            self.next();
            let open = self.expect(Kind::LBracket, "`[`")?;
            let low = self.expr()?;
            self.expect(Kind::Comma, "`,`")?;
            let high = self.expr()?;
            self.expect_close(Kind::RBracket, open, "an operator or `]`")?;
            range = Some((low, high));
        }
        let expected = if range.is_some() { "`;`" } else { "an operator, `in [low, high]` or `;`" };
        self.expect_semi(expected)?;
        Ok(self.push_stmt(StmtKind::Param { ty, name, value, range }, self.span_from(start)))
    }

    fn assertion(&mut self) -> Parse<StmtId> {
        let start = self.next().start;
        let condition = self.expr()?;
        let message = if self.eat(Kind::Comma) { Some(self.expr()?) } else { None };
        self.expect_semi("an operator, `,` or `;`")?;
        Ok(self.push_stmt(StmtKind::Assert { condition, message }, self.span_from(start)))
    }

    fn object(&mut self) -> Parse<StmtId> {
        let kind = self.ident("a kind")?;
        let name = self.ident("a name")?;
        let (args, _) = self.arguments()?;
        self.expect_semi("`;`")?;
        Ok(self.push_stmt(StmtKind::Object { kind, name, args }, self.span_from(kind.span.start)))
    }

    /// An assignment or a call, without its `;`.
    fn simple(&mut self) -> Parse<StmtId> {
        if self.kind() != Kind::Ident {
            return Err(self.unexpected("an assignment or a call"));
        }
        let start = self.token().start;
        let target = self.postfix()?;
        let op = match self.kind() {
            Kind::Assign => AssignOp::Set,
            Kind::PlusAssign => AssignOp::With(BinaryOp::Add),
            Kind::MinusAssign => AssignOp::With(BinaryOp::Sub),
            Kind::StarAssign => AssignOp::With(BinaryOp::Mul),
            Kind::SlashAssign => AssignOp::With(BinaryOp::Div),
            Kind::CaretAssign => AssignOp::With(BinaryOp::Caret),
            _ => return self.call_statement(target, start),
        };
        self.check_target(target);
        self.next_as(TokenRole::Infix);
        let value = self.expr()?;
        Ok(self.push_stmt(StmtKind::Assign { target, op, value }, self.span_from(start)))
    }

    fn call_statement(&mut self, expr: ExprId, start: u32) -> Parse<StmtId> {
        if matches!(self.program[expr].kind, ExprKind::Call { .. }) {
            return Ok(self.push_stmt(StmtKind::Call(expr), self.span_from(start)));
        }
        let ends =
            self.token().new_line || matches!(self.kind(), Kind::Semi | Kind::RBrace | Kind::End);
        if !ends {
            return Err(self.unexpected("`=`, `(` or `;`"));
        }
        let span = self.program[expr].span;
        let text: String = self.program.slice(span).chars().take(40).collect();
        let diagnostic =
            Diagnostic::error("not-a-statement", "this value is not used for anything").at(span);
        let usual =
            || format!("call it with `{text}()`, assign it, or show it with `print {text};`");
        let help = foreign_word(&text).map_or_else(usual, str::to_string);
        self.report(diagnostic.help(help));
        Ok(self.push_stmt(StmtKind::Error, self.span_from(start)))
    }

    fn check_target(&mut self, target: ExprId) {
        let mut part = target;
        loop {
            match self.program[part].kind {
                ExprKind::Index { base, .. } | ExprKind::Member { base, .. } => part = base,
                ExprKind::Name(_) => return,
                _ => break,
            }
        }
        let diagnostic = Diagnostic::error("not-assignable", "cannot assign to this")
            .at(self.program[target].span)
            .expected("a variable, or a part of one by `[…]` and `.x`")
            .found("the result of a call");
        self.report(diagnostic);
    }
}

/// True if an operand can start with such a token, so that `assert` before it is the statement.
fn starts_operand(kind: Kind) -> bool {
    matches!(
        kind,
        Kind::Ident
            | Kind::Number
            | Kind::Text
            | Kind::LParen
            | Kind::LBrace
            | Kind::Pipe
            | Kind::Plus
            | Kind::Minus
            | Kind::Bang
            | Kind::Not
    )
}
