//! Expressions.

use super::super::ast::*;
use super::super::grouping::{Grouping, Step};
use super::super::token::{self, Kind, Token};
use super::{Parse, Parser, Reported, TokenRole, close_list};
use moldloft_diag::{Diagnostic, Span};

impl Parser {
    pub(super) fn expr(&mut self) -> Parse<ExprId> {
        let mut left = self.and()?;
        loop {
            if self.kind() == Kind::Or {
                self.next_as(TokenRole::Infix);
            } else if self.at_double_pipe() {
                self.next_as(TokenRole::Infix);
                self.next_as(TokenRole::Tight);
            } else {
                return Ok(left);
            }
            let right = self.and()?;
            left = self.binary(BinaryOp::Or, left, right)?;
        }
    }

    /// True if `||` is an operator here: outside any magnitude of this bracket.
    fn at_double_pipe(&self) -> bool {
        let (first, second) = (self.token(), self.peek(1));
        self.magnitudes == 0
            && first.kind == Kind::Pipe
            && second.kind == Kind::Pipe
            && first.end == second.start
    }

    fn and(&mut self) -> Parse<ExprId> {
        let mut left = self.not()?;
        while matches!(self.kind(), Kind::And | Kind::AmpAmp) {
            self.next_as(TokenRole::Infix);
            let right = self.not()?;
            left = self.binary(BinaryOp::And, left, right)?;
        }
        Ok(left)
    }

    fn not(&mut self) -> Parse<ExprId> {
        let first = self.at;
        while matches!(self.kind(), Kind::Not | Kind::Bang) {
            let role = if self.kind() == Kind::Bang { TokenRole::Prefix } else { TokenRole::Plain };
            self.next_as(role);
        }
        let last = self.at;
        let mut operand = self.comparison()?;
        for at in (first..last).rev() {
            let start = self.tokens[at].start;
            operand = self.unary(UnaryOp::Not, start, operand)?;
        }
        Ok(operand)
    }

    fn comparison(&mut self) -> Parse<ExprId> {
        let mut left = self.chain()?;
        let mut count = 0;
        loop {
            let op = match self.kind() {
                Kind::Lt => BinaryOp::Lt,
                Kind::Gt => BinaryOp::Gt,
                Kind::Le => BinaryOp::Le,
                Kind::Ge => BinaryOp::Ge,
                Kind::EqEq => BinaryOp::Eq,
                Kind::NotEq => BinaryOp::Ne,
                _ => return Ok(left),
            };
            count += 1;
            let token = self.next_as(TokenRole::Infix);
            if count == 2 {
                let diagnostic =
                    Diagnostic::error("chained-comparison", "comparisons cannot be chained")
                        .at(self.span(token))
                        .help("write `a < b and b < c`");
                self.report(diagnostic);
            }
            let right = self.chain()?;
            left = self.binary(op, left, right)?;
        }
    }

    /// Sums, products, powers and set operators, read flat and then grouped.
    fn chain(&mut self) -> Parse<ExprId> {
        let base = self.items.len();
        let result = self.chain_items(base);
        self.items.truncate(base);
        result
    }

    fn chain_items(&mut self, base: usize) -> Parse<ExprId> {
        let mut has = Found::default();
        loop {
            self.chain_operand(&mut has)?;
            let op = match self.kind() {
                Kind::Plus => BinaryOp::Add,
                Kind::Minus => BinaryOp::Sub,
                Kind::Star => BinaryOp::Mul,
                Kind::Slash => BinaryOp::Div,
                Kind::Caret => BinaryOp::Caret,
                Kind::Amp => BinaryOp::Intersection,
                Kind::Pipe if self.magnitudes == 0 && !self.at_double_pipe() => BinaryOp::Union,
                _ => break,
            };
            match op {
                BinaryOp::Caret => has.caret = true,
                BinaryOp::Union | BinaryOp::Intersection => has.set = true,
                _ => has.other = true,
            }
            let token = self.next_as(if op == BinaryOp::Caret {
                TokenRole::Tight
            } else {
                TokenRole::Infix
            });
            self.items.push(ChainItem::Infix(op, self.span(token)));
        }
        if let [ChainItem::Operand(only)] = self.items[base..] {
            return Ok(only);
        }
        if has.set {
            let grouped = self.group(base, Grouping::Sets)?;
            self.clarify(grouped);
            return Ok(grouped);
        }
        if has.caret && has.other && !has.number {
            return self.ambiguous_chain(base);
        }
        self.group(base, Grouping::Numbers)
    }

    /// Signs and one operand of a chain.
    fn chain_operand(&mut self, has: &mut Found) -> Parse<()> {
        while matches!(self.kind(), Kind::Plus | Kind::Minus) {
            if let Some(number) = self.signed_number() {
                has.number = true;
                self.items.push(ChainItem::Operand(number));
                return Ok(());
            }
            let token = self.next_as(TokenRole::Prefix);
            let op = if token.kind == Kind::Minus { UnaryOp::Minus } else { UnaryOp::Plus };
            has.other = true;
            self.items.push(ChainItem::Prefix(op, self.span(token)));
        }
        let operand = self.dot()?;
        match self.program[operand].kind {
            ExprKind::Number(_) | ExprKind::Magnitude(_) | ExprKind::List(_) => has.number = true,
            _ => {}
        }
        self.items.push(ChainItem::Operand(operand));
        Ok(())
    }

    /// `-5` as one literal, where nothing that follows binds tighter than the sign.
    fn signed_number(&mut self) -> Option<ExprId> {
        let (sign, number, after) = (self.token(), self.peek(1), self.peek(2));
        let alone = !matches!(after.kind, Kind::Caret | Kind::Dot | Kind::Cross | Kind::MemberDot);
        if sign.kind != Kind::Minus || number.kind != Kind::Number || !alone {
            return None;
        }
        self.next_as(TokenRole::Prefix);
        self.next();
        let span = Span::new(self.program.file, sign.start, number.end);
        let literal = &mut self.program.literals[number.payload as usize];
        literal.value = -literal.value;
        literal.span = span;
        Some(self.push_expr(ExprKind::Number(LiteralId(number.payload)), span, 0))
    }

    /// Builds the tree of a chain.
    fn group(&mut self, base: usize, grouping: Grouping) -> Parse<ExprId> {
        let mut waiting = std::mem::take(&mut self.waiting);
        let items = std::mem::take(&mut self.items);
        let floor = self.operands.len();
        let mut result = Ok(());
        grouping.walk(&items[base..], &mut waiting, |step| {
            if result.is_ok() {
                result = self.apply(step);
            }
        });
        self.waiting = waiting;
        self.items = items;
        let top = self.operands.last().copied();
        self.operands.truncate(floor);
        result.and(top.ok_or(Reported))
    }

    fn apply(&mut self, step: Step) -> Parse<()> {
        let made = match step {
            Step::Push(operand) => operand,
            Step::Unary(op, span) => {
                let operand = self.operands.pop().ok_or(Reported)?;
                self.unary(op, span.start, operand)?
            }
            Step::Binary(op, _) => {
                let right = self.operands.pop().ok_or(Reported)?;
                let left = self.operands.pop().ok_or(Reported)?;
                self.binary(op, left, right)?
            }
        };
        self.operands.push(made);
        Ok(())
    }

    fn ambiguous_chain(&mut self, base: usize) -> Parse<ExprId> {
        let mut below = 0;
        let mut span = Span::UNKNOWN;
        for item in &self.items[base..] {
            match item {
                ChainItem::Operand(operand) => {
                    below = below.max(self.heights[operand.0 as usize]);
                    span = span.to(self.program[*operand].span);
                }
                ChainItem::Prefix(_, at) | ChainItem::Infix(_, at) => span = span.to(*at),
            }
        }
        let links = (self.items.len() - base).min(usize::from(u16::MAX / 2)) as u16;
        let list = close_list(&mut self.items, base, &mut self.program.chain_lists);
        self.push_above(ExprKind::Chain(list), span, below.saturating_add(links))
    }

    /// Marks parentheses for the canonical text where the grouping of sets differs from that of
    /// numbers: around operands of `^`.
    fn clarify(&mut self, root: ExprId) {
        if self.layout.is_none() {
            return;
        }
        let mut open = vec![root];
        while let Some(expr) = open.pop() {
            match self.program[expr].kind {
                ExprKind::Binary { op, left, right } if is_chain_op(op) => {
                    for (side, is_left) in [(left, true), (right, false)] {
                        let weaker = match self.program[side].kind {
                            ExprKind::Binary { op, .. } => {
                                is_chain_op(op) && (is_left || op != BinaryOp::Caret)
                            }
                            ExprKind::Unary { .. } => true,
                            _ => false,
                        };
                        if op == BinaryOp::Caret && weaker {
                            self.wrap(self.program[side].span);
                        }
                        open.push(side);
                    }
                }
                ExprKind::Unary { op: UnaryOp::Plus | UnaryOp::Minus, operand } => {
                    open.push(operand)
                }
                _ => {}
            }
        }
    }

    fn wrap(&mut self, span: Span) {
        if let Some(layout) = &mut self.layout {
            layout.open_at.push(span.start);
            layout.close_at.push(span.end);
        }
    }

    fn unary(&mut self, op: UnaryOp, start: u32, operand: ExprId) -> Parse<ExprId> {
        let span = Span { start, ..self.program[operand].span };
        self.push_above(ExprKind::Unary { op, operand }, span, self.height(operand))
    }

    fn binary(&mut self, op: BinaryOp, left: ExprId, right: ExprId) -> Parse<ExprId> {
        let span = self.program[left].span.to(self.program[right].span);
        let below = self.height(left).max(self.height(right));
        self.push_above(ExprKind::Binary { op, left, right }, span, below)
    }

    fn dot(&mut self) -> Parse<ExprId> {
        let mut left = self.cross()?;
        while self.kind() == Kind::Dot {
            self.next_as(TokenRole::Infix);
            let right = self.signed(Self::cross)?;
            left = self.binary(BinaryOp::Dot, left, right)?;
        }
        Ok(left)
    }

    fn cross(&mut self) -> Parse<ExprId> {
        let mut left = self.postfix()?;
        while self.kind() == Kind::Cross {
            self.next_as(TokenRole::Infix);
            let right = self.signed(Self::postfix)?;
            left = self.binary(BinaryOp::Cross, left, right)?;
        }
        Ok(left)
    }

    fn signed(&mut self, operand: fn(&mut Self) -> Parse<ExprId>) -> Parse<ExprId> {
        let first = self.at;
        while matches!(self.kind(), Kind::Plus | Kind::Minus) {
            self.next_as(TokenRole::Prefix);
        }
        let last = self.at;
        let number = self.tokens[last];
        if last > first && number.kind == Kind::Number {
            // `--3` would be two signs: a negative number is put in parentheses, so that the
            // literal keeps its value.
            self.program.literals[number.payload as usize].wrap_negative = true;
        }
        let mut expr = operand(self)?;
        for at in (first..last).rev() {
            let sign = self.tokens[at];
            let op = if sign.kind == Kind::Minus { UnaryOp::Minus } else { UnaryOp::Plus };
            expr = self.unary(op, sign.start, expr)?;
        }
        Ok(expr)
    }

    /// A primary with subscripts, members and calls.
    pub(super) fn postfix(&mut self) -> Parse<ExprId> {
        let start = self.token().start;
        let mut base = self.primary()?;
        loop {
            let applies =
                !matches!(self.program[base].kind, ExprKind::Number(_) | ExprKind::Text(_));
            base = match self.kind() {
                Kind::LBracket if applies => {
                    let (subs, below) = self.subscripts()?;
                    let below = below.max(self.height(base));
                    self.push_above(ExprKind::Index { base, subs }, self.span_from(start), below)?
                }
                Kind::LParen if applies => {
                    let (args, below) = self.arguments()?;
                    let below = below.max(self.height(base));
                    self.push_above(
                        ExprKind::Call { callee: base, args },
                        self.span_from(start),
                        below,
                    )?
                }
                Kind::MemberDot => {
                    self.next();
                    let name = self.ident("a name")?.symbol;
                    let or_dot = !token::is_component(name);
                    let kind = ExprKind::Member { base, name, or_dot };
                    self.push_above(kind, self.span_from(start), self.height(base))?
                }
                _ => return Ok(base),
            };
        }
    }

    fn primary(&mut self) -> Parse<ExprId> {
        let token = self.token();
        let span = self.span(token);
        let kind = match token.kind {
            Kind::Ident => ExprKind::Name(token.symbol()),
            Kind::Number => ExprKind::Number(LiteralId(token.payload)),
            Kind::Text => ExprKind::Text(TextId(token.payload)),
            Kind::LParen => return self.within_bracket(Self::parenthesised),
            Kind::LBrace => return self.within_bracket(Self::list),
            Kind::Pipe => {
                self.enter()?;
                self.magnitudes += 1;
                let result = self.magnitude();
                self.magnitudes -= 1;
                self.leave();
                return result;
            }
            _ => return Err(self.unexpected("an expression")),
        };
        self.next();
        // A sign binds looser than these.
        if token.kind == Kind::Number
            && matches!(self.kind(), Kind::Caret | Kind::Dot | Kind::Cross)
        {
            self.program.literals[token.payload as usize].wrap_negative = true;
        }
        Ok(self.push_expr(kind, span, 0))
    }

    /// Runs a parser of something in brackets, where no magnitude is open yet.
    fn within_bracket<T>(&mut self, parse: fn(&mut Self) -> Parse<T>) -> Parse<T> {
        self.enter()?;
        let magnitudes = std::mem::take(&mut self.magnitudes);
        let scratch = (self.exprs.len(), self.args.len(), self.subs.len());
        let result = parse(self);
        self.exprs.truncate(scratch.0);
        self.args.truncate(scratch.1);
        self.subs.truncate(scratch.2);
        self.magnitudes = magnitudes;
        self.leave();
        result
    }

    fn parenthesised(&mut self) -> Parse<ExprId> {
        let open = self.next_as(TokenRole::Open);
        let inner = self.expr()?;
        self.mark(self.at, TokenRole::Close);
        self.expect_close(Kind::RParen, open, "`)` or an operator")?;
        self.push_above(ExprKind::Paren(inner), self.span_from(open.start), self.height(inner))
    }

    fn magnitude(&mut self) -> Parse<ExprId> {
        let open = self.next_as(TokenRole::Open);
        let inner = self.expr()?;
        self.mark(self.at, TokenRole::Close);
        self.expect_close(Kind::Pipe, open, "`|` or an operator")?;
        self.push_above(ExprKind::Magnitude(inner), self.span_from(open.start), self.height(inner))
    }

    fn list(&mut self) -> Parse<ExprId> {
        let open = self.next_as(TokenRole::Open);
        let base = self.exprs.len();
        let mut below = 0;
        if self.kind() != Kind::RBrace {
            loop {
                let element = self.expr()?;
                below = below.max(self.height(element));
                self.exprs.push(element);
                if !self.eat(Kind::Comma) {
                    break;
                }
            }
        }
        self.mark(self.at, TokenRole::Close);
        self.expect_close(Kind::RBrace, open, "`,` or `}`")?;
        let list = close_list(&mut self.exprs, base, &mut self.program.expr_lists);
        self.push_above(ExprKind::List(list), self.span_from(open.start), below)
    }

    /// `(…)` of a call or an object, and the height of its highest value.
    pub(super) fn arguments(&mut self) -> Parse<(NodeList<Arg>, u16)> {
        self.within_bracket(Self::argument_list)
    }

    fn argument_list(&mut self) -> Parse<(NodeList<Arg>, u16)> {
        let open = self.next_as(TokenRole::Applied);
        let base = self.args.len();
        let mut below = 0;
        let mut first_named: Option<Ident> = None;
        if self.kind() != Kind::RParen {
            loop {
                let name = self.argument_name();
                let value = self.expr()?;
                match (name, first_named) {
                    (Some(name), None) => first_named = Some(name),
                    (None, Some(named)) => {
                        let message = "positional argument after named ones";
                        let diagnostic = Diagnostic::error("positional-after-named", message)
                            .at(self.program[value].span)
                            .note_at(named.span, "the first named argument");
                        self.report(diagnostic);
                    }
                    _ => {}
                }
                below = below.max(self.height(value));
                self.args.push(Arg { name, value });
                if !self.eat(Kind::Comma) {
                    break;
                }
            }
        }
        self.expect_close(Kind::RParen, open, "`,` or `)`")?;
        if first_named.is_some() {
            self.check_names(base);
        }
        Ok((close_list(&mut self.args, base, &mut self.program.arg_lists), below))
    }

    /// `name =` before an argument; every word may be such a name, reserved ones too.
    fn argument_name(&mut self) -> Option<Ident> {
        let token: Token = self.token();
        if !token.is_word() || self.peek(1).kind != Kind::Assign {
            return None;
        }
        self.next();
        self.next_as(TokenRole::Infix);
        Some(Ident { symbol: token.symbol(), span: self.span(token) })
    }

    fn check_names(&mut self, base: usize) {
        let mut names: Vec<Ident> = self.args[base..].iter().filter_map(|arg| arg.name).collect();
        names.sort_by_key(|name| (name.symbol, name.span.start));
        for pair in names.windows(2) {
            if pair[0].symbol == pair[1].symbol {
                let message =
                    format!("the argument `{}` is given twice", self.symbol_text(pair[0].symbol));
                let diagnostic = Diagnostic::error("duplicate-argument", message)
                    .at(pair[1].span)
                    .note_at(pair[0].span, "given here");
                self.report(diagnostic);
            }
        }
    }

    fn subscripts(&mut self) -> Parse<(NodeList<Subscript>, u16)> {
        self.within_bracket(Self::subscript_list)
    }

    fn subscript_list(&mut self) -> Parse<(NodeList<Subscript>, u16)> {
        let open = self.next_as(TokenRole::Applied);
        let base = self.subs.len();
        let mut below = 0;
        loop {
            let (sub, height) = self.subscript()?;
            below = below.max(height);
            self.subs.push(sub);
            if !self.eat(Kind::Comma) {
                break;
            }
        }
        self.expect_close(Kind::RBracket, open, "`,`, `:` or `]`")?;
        Ok((close_list(&mut self.subs, base, &mut self.program.sub_lists), below))
    }

    fn subscript(&mut self) -> Parse<(Subscript, u16)> {
        let mut below = 0;
        let from = self.subscript_part(&mut below)?;
        if self.kind() != Kind::Colon {
            return Ok((from.map_or(Subscript::Whole, Subscript::At), below));
        }
        self.next_as(TokenRole::Tight);
        let to = self.subscript_part(&mut below)?;
        let mut step = None;
        if self.kind() == Kind::Colon {
            self.next_as(TokenRole::Tight);
            let expr = self.expr()?;
            below = below.max(self.height(expr));
            step = Some(expr);
        }
        let whole = from.is_none() && to.is_none() && step.is_none();
        Ok((if whole { Subscript::Whole } else { Subscript::Range { from, to, step } }, below))
    }

    fn subscript_part(&mut self, below: &mut u16) -> Parse<Option<ExprId>> {
        if matches!(self.kind(), Kind::Comma | Kind::RBracket | Kind::Colon) {
            return Ok(None);
        }
        let expr = self.expr()?;
        *below = (*below).max(self.height(expr));
        Ok(Some(expr))
    }
}

/// Content of a chain, which determines its grouping.
#[derive(Default)]
struct Found {
    /// `|` or `&`: only sets have them.
    set: bool,
    /// `^`
    caret: bool,
    /// Any other operator, or a sign.
    other: bool,
    /// An operand that no set can be combined with.
    number: bool,
}

fn is_chain_op(op: BinaryOp) -> bool {
    matches!(
        op,
        BinaryOp::Add
            | BinaryOp::Sub
            | BinaryOp::Mul
            | BinaryOp::Div
            | BinaryOp::Caret
            | BinaryOp::Union
            | BinaryOp::Intersection
    )
}
