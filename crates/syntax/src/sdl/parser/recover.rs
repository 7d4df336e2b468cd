//! Continuation after an error.

use super::super::token::Kind;
use super::{Parse, Parser, Reported};
use moldloft_diag::{Diagnostic, Span};

impl Parser {
    /// Skips the rest of a statement that began at the token `start`: to after its `;`, before a `}` that closes the
    /// block around it, or before a line that starts like a statement.
    pub(super) fn recover(&mut self, start: usize) {
        let mut open: Vec<Kind> = Vec::new();
        let failed_at = self.at;
        self.at = start;
        loop {
            let kind = self.kind();
            let reached = self.at >= failed_at;
            match kind {
                Kind::End => return,
                Kind::LParen | Kind::LBracket => open.push(kind),
                Kind::LBrace => {
                    // The block of a statement whose head is broken.
                    if reached && open.is_empty() && self.at > start {
                        return;
                    }
                    open.push(kind);
                }
                Kind::RParen => pop_through(&mut open, Kind::LParen),
                Kind::RBracket => pop_through(&mut open, Kind::LBracket),
                Kind::RBrace => {
                    if !open.contains(&Kind::LBrace) {
                        if reached {
                            return;
                        }
                    } else {
                        pop_through(&mut open, Kind::LBrace);
                        let after = self.peek(1);
                        let ends = after.new_line || matches!(after.kind, Kind::RBrace | Kind::End);
                        if reached && open.is_empty() && ends {
                            self.next();
                            return;
                        }
                    }
                }
                Kind::Semi if reached && !self.in_for_head(&open, start) => {
                    self.next();
                    return;
                }
                _ if reached && self.at > start && self.at_fresh_statement() => return,
                _ => {}
            }
            self.next();
        }
    }

    /// True if the only open bracket is the head of the `for` that starts at `start`.
    fn in_for_head(&self, open: &[Kind], start: usize) -> bool {
        self.tokens[start].kind == Kind::For && open == [Kind::LParen]
    }

    /// True if a new line starts here that looks like a statement.
    pub(super) fn at_fresh_statement(&self) -> bool {
        let token = self.token();
        if !token.new_line {
            return false;
        }
        match token.kind {
            Kind::Ident => {
                let next = self.peek(1);
                next.kind == Kind::Ident && !next.new_line
            }
            Kind::TypeWord => self.peek(1).kind == Kind::Ident,
            Kind::Load
            | Kind::If
            | Kind::While
            | Kind::For
            | Kind::Foreach
            | Kind::Break
            | Kind::Continue
            | Kind::Return
            | Kind::Subroutine
            | Kind::Function
            | Kind::Global
            | Kind::Print => true,
            _ => false,
        }
    }

    /// Reads the `;` at a statement's end. If it is missing at the end of a line, that is reported
    /// and the statement is valid.
    pub(super) fn expect_semi(&mut self, expected: &str) -> Parse<()> {
        let token = self.token();
        if token.kind == Kind::Semi {
            self.next();
            return Ok(());
        }
        if !(token.new_line || matches!(token.kind, Kind::RBrace | Kind::End)) {
            return Err(self.unexpected(expected));
        }
        // A line that begins with an operator is an error in the expression, not a missing `;`.
        let starts_something =
            token.is_word() || matches!(token.kind, Kind::RBrace | Kind::LBrace | Kind::End);
        if !starts_something {
            return Err(self.unexpected(expected));
        }
        let place = Span::point(self.program.file, self.last_end());
        let diagnostic =
            Diagnostic::error("missing-semicolon", "`;` is missing after this statement")
                .at(place)
                .expected("`;`")
                .edit(place, ";", "insert `;`");
        self.end_is_reported |= token.kind == Kind::End;
        self.report(diagnostic);
        Ok(())
    }

    pub(super) fn or_recover<T>(&mut self, start: usize, result: Parse<T>) -> Option<T> {
        match result {
            Ok(value) => Some(value),
            Err(Reported) => {
                self.recover(start);
                None
            }
        }
    }
}

fn pop_through(open: &mut Vec<Kind>, opener: Kind) {
    if let Some(at) = open.iter().rposition(|kind| *kind == opener) {
        open.truncate(at);
    }
}
