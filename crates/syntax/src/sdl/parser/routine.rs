//! Subroutines and functions.

use super::super::ast::*;
use super::super::token::{BLOCK, FIELD, Kind, SET, Token};
use super::{Parse, Parser};
use moldloft_diag::{Diagnostic, Span};

impl Parser {
    pub(super) fn routine(&mut self, depth: u32) -> Parse<StmtId> {
        let word = self.next();
        let outer = (self.in_routine, self.loops);
        let nested = self.nesting > 1;
        if nested {
            let message = "subroutines and functions are declared at the top level of a file, not inside blocks";
            self.report(Diagnostic::error("misplaced-routine", message).at(self.span(word)));
        }
        let result = if word.kind == Kind::Function {
            let ty = self.type_word("a result type")?;
            Some(self.list_type(ty)?)
        } else {
            None
        };
        let name = self.ident("the name of the routine")?;
        self.mark(self.at, super::TokenRole::Applied);
        let open = self.expect(Kind::LParen, "`(`")?;
        let formals = self.formals()?;
        self.expect_close(Kind::RParen, open, "`,` or `)`")?;
        if self.kind() != Kind::LBrace {
            return Err(self.unexpected("`{`"));
        }
        self.in_routine = true;
        self.loops = 0;
        let body = self.block(depth);
        (self.in_routine, self.loops) = outer;
        let span = self.span_from(word.start);
        let id = RoutineId(self.program.routines.len() as u32);
        let body = body?;
        self.hidden_arguments(formals, body);
        self.program.routines.push(Routine { result, name, formals, body, span });
        Ok(self.push_stmt(StmtKind::Routine(id), span))
    }

    fn formals(&mut self) -> Parse<NodeList<Formal>> {
        let mut formals: Vec<Formal> = Vec::new();
        if self.kind() != Kind::RParen {
            loop {
                let returned = self.eat(Kind::Returned);
                let ty = self.formal_type()?;
                let name = self.ident("the name of the argument")?;
                self.mark(self.at, super::TokenRole::Applied);
                let ty = self.list_type(ty)?;
                self.mark(self.at, super::TokenRole::Plain);
                let multiple = self.eat(Kind::Ellipsis);
                let default = self.default_value(returned || multiple)?;
                if let Some(before) = formals.last().filter(|formal| formal.multiple) {
                    let message = "only the last argument can be multiple";
                    let place = before.name.span;
                    self.report(Diagnostic::error("misplaced-multiple", message).at(place));
                }
                if let Some(same) = formals.iter().find(|formal| formal.name.symbol == name.symbol)
                {
                    let message =
                        format!("there are two arguments `{}`", self.symbol_text(name.symbol));
                    let diagnostic = Diagnostic::error("duplicate-argument", message)
                        .at(name.span)
                        .note_at(same.name.span, "the other one");
                    self.report(diagnostic);
                }
                let given = formals.last().filter(|formal| formal.default.is_some());
                if let (Some(before), None, false) = (given, default, multiple) {
                    let message = "arguments with a value of their own come last";
                    let place = before.name.span;
                    self.report(Diagnostic::error("misplaced-default", message).at(place));
                }
                formals.push(Formal { returned, ty, name, multiple, default });
                if formals.len() > usize::from(u8::MAX) {
                    return Err(self.unexpected("at most 255 arguments"));
                }
                if !self.eat(Kind::Comma) {
                    break;
                }
            }
        }
        let list = NodeList::new(self.program.formal_lists.len(), formals.len());
        self.program.formal_lists.extend_from_slice(&formals);
        Ok(list)
    }

    /// `= value` of an argument that a call may leave out.
    fn default_value(&mut self, refused: bool) -> Parse<Option<ExprId>> {
        if self.kind() != Kind::Assign {
            return Ok(None);
        }
        let place = self.span(self.token());
        self.next_as(super::TokenRole::Infix);
        let value = self.expr()?;
        if refused {
            let message = "only an argument that is passed by value has a value of its own";
            self.report(Diagnostic::error("misplaced-default", message).at(place));
        }
        Ok(Some(value))
    }

    /// The type, or that of its lists when `[]` follows.
    fn list_type(&mut self, (ty, span): (Type, Span)) -> Parse<(Type, Span)> {
        if self.kind() != Kind::LBracket {
            return Ok((ty, span));
        }
        let open = self.next_as(super::TokenRole::Applied);
        self.expect_close(Kind::RBracket, open, "`]`: an argument takes lists of any length")?;
        match ty.list() {
            Some(list) => Ok((list, span)),
            None => {
                let message = "there are no lists of this type";
                self.report(
                    Diagnostic::error("wrong-type", message)
                        .at(span)
                        .help("a row of numbers is an `farray`, a row of vectors a `curve`"),
                );
                Ok((ty, span))
            }
        }
    }

    /// Reports the variables of a routine that have the name of one of its arguments.
    fn hidden_arguments(&mut self, formals: NodeList<Formal>, body: NodeList<StmtId>) {
        let formals = self.program[formals].to_vec();
        let mut stack = self.program[body].to_vec();
        let mut hidden: Vec<(Ident, Ident)> = Vec::new();
        while let Some(stmt) = stack.pop() {
            match self.program[stmt].kind {
                StmtKind::Block(list) => stack.extend(self.program[list].iter().rev()),
                StmtKind::If { then, otherwise, .. } => {
                    stack.push(then);
                    stack.extend(otherwise);
                }
                StmtKind::While { body, .. }
                | StmtKind::ForRange { body, .. }
                | StmtKind::For { body, .. }
                | StmtKind::Foreach { body, .. } => stack.push(body),
                StmtKind::Declare { global: false, items, .. } => {
                    for item in &self.program[items] {
                        let formal = formals.iter().find(|f| f.name.symbol == item.name.symbol);
                        hidden.extend(formal.map(|formal| (item.name, formal.name)));
                    }
                }
                _ => {}
            }
        }
        for (local, argument) in hidden {
            let word = self.symbol_text(local.symbol);
            self.report(
                Diagnostic::error("duplicate-name", format!("`{word}` is an argument already"))
                    .labelled(local.span, "declared again here")
                    .note_at(argument.span, "the argument")
                    .help("assign to the argument, or give the variable another name"),
            );
        }
    }

    /// The type of an argument; `function` and `subroutine` are types here, too.
    fn formal_type(&mut self) -> Parse<(Type, Span)> {
        let token = self.token();
        if !matches!(token.kind, Kind::Function | Kind::Subroutine) {
            return self.type_word("a type");
        }
        self.next();
        Ok((Type::Routine, self.span(token)))
    }

    /// A type: a reserved one, or any name, which the interpreter judges.
    pub(super) fn type_word(&mut self, expected: &str) -> Parse<(Type, Span)> {
        let token = self.token();
        if !matches!(token.kind, Kind::TypeWord | Kind::Ident) {
            return Err(self.unexpected(expected));
        }
        self.next();
        Ok((type_of(token), self.span(token)))
    }
}

/// The type that a word names.
fn type_of(token: Token) -> Type {
    match (token.kind, token.symbol()) {
        (Kind::TypeWord, symbol) => Type::CLASSIC[symbol.0 as usize],
        (_, FIELD) => Type::Field,
        (_, SET) => Type::Set,
        (_, BLOCK) => Type::Block,
        (_, symbol) => Type::Other(symbol),
    }
}
