//! Tokens into a tree, by recursive descent with recovery at statements.

mod expr;
mod recover;
mod routine;
mod stmt;
pub(super) mod version;

use super::ast::*;
use super::interner::Symbol;
use super::lexer::{Lexed, lex};
use super::program::Program;
use super::token::{Comment, Kind, Token};
use moldloft_diag::{Diagnostic, FileId, Span};
use std::sync::Arc;

/// Maximum nesting of brackets, blocks and bodies.
pub const MAX_NESTING: u32 = 200;
/// Maximum height of a syntax tree, and so of the number of terms in `1+1+…`.
pub const MAX_HEIGHT: u16 = 1000;
/// Maximum number of listed faults; further ones are only counted.
pub const MAX_DIAGNOSTICS: usize = 100;

/// Parses a program. It never fails: errors are in the diagnostics, in the order of the text, and
/// are `Error` nodes of the tree.
pub fn parse(text: impl Into<Arc<str>>, file: FileId) -> (Program, Vec<Diagnostic>) {
    let mut parser = Parser::new(text.into(), file, false);
    // A text in a newer version cannot be judged: it has no statements.
    if let Some(newer) = version::refused(&parser.program.text, file) {
        let (program, _, _) = parser.finish();
        return (program, vec![newer]);
    }
    parser.program();
    let (program, diagnostics, _) = parser.finish();
    (program, diagnostics)
}

/// Parses a text as one expression, which is an `Error` node if the text is not one.
pub fn parse_expr(text: impl Into<Arc<str>>, file: FileId) -> (Program, ExprId, Vec<Diagnostic>) {
    let mut parser = Parser::new(text.into(), file, false);
    let expr = parser.expr().and_then(|expr| {
        if parser.kind() == Kind::End {
            Ok(expr)
        } else {
            Err(parser.unexpected("an operator or the end"))
        }
    });
    let expr = expr.unwrap_or_else(|Reported| {
        let span = Span::new(file, 0, parser.program.text.len() as u32);
        parser.push_expr(ExprKind::Error, span, 0)
    });
    let (program, diagnostics, _) = parser.finish();
    (program, expr, diagnostics)
}

/// The found item as named after "unexpected".
fn without_article(found: &str) -> &str {
    let articles = ["the ", "a ", "an "];
    articles.iter().find_map(|article| found.strip_prefix(article)).unwrap_or(found)
}

/// Parses a program with the role of each token.
pub(crate) fn parse_marked(
    text: Arc<str>,
    file: FileId,
) -> (Program, Vec<Diagnostic>, SourceLayout) {
    let mut parser = Parser::new(text, file, true);
    parser.program();
    parser.finish()
}

/// Role of a token, as far as its spacing depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TokenRole {
    Plain,
    /// A sign or `!` before an operand.
    Prefix,
    /// Blanks on both sides.
    Infix,
    /// No blanks on either side: `^`, the colon of a range, the second `|` of `||`.
    Tight,
    /// `(` or `[` that belongs to the preceding expression.
    Applied,
    /// Opens a list or a magnitude.
    Open,
    /// Closes a list or a magnitude.
    Close,
    BlockOpen,
    BlockClose,
    /// `;` inside the head of a `for`.
    HeadSemi,
    /// An empty statement, left out of canonical text.
    Redundant,
}

/// Data of the formatter besides the tree.
pub(crate) struct SourceLayout {
    pub tokens: Vec<Token>,
    pub comments: Vec<Comment>,
    pub roles: Vec<TokenRole>,
    /// Tokens that start a line, and how deep it is indented; in the order of the text.
    pub starts: Vec<(u32, u32)>,
    /// Bytes before which a `(` is to be written.
    pub open_at: Vec<u32>,
    /// Bytes after which a `)` is to be written.
    pub close_at: Vec<u32>,
}

/// The fault has been reported; the caller that can continue after it does so.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reported;

type Parse<T> = Result<T, Reported>;

struct Parser {
    tokens: Vec<Token>,
    at: usize,
    program: Program,
    heights: Vec<u16>,
    diagnostics: Vec<Diagnostic>,
    /// Faults beyond the limit.
    unlisted: usize,
    nesting: u32,
    too_deep_is_reported: bool,
    end_is_reported: bool,
    /// Open magnitudes of the innermost bracket.
    magnitudes: u32,
    loops: u32,
    in_routine: bool,
    layout: Option<SourceLayout>,
    // Scratch stacks for lists under construction.
    exprs: Vec<ExprId>,
    stmts: Vec<StmtId>,
    args: Vec<Arg>,
    subs: Vec<Subscript>,
    items: Vec<ChainItem>,
    declarators: Vec<Declarator>,
    waiting: Vec<ChainItem>,
    operands: Vec<ExprId>,
}

impl Parser {
    fn new(text: Arc<str>, file: FileId, marked: bool) -> Parser {
        let too_large = crate::decode::check_size(&text, file);
        let text = if too_large.is_some() { Arc::from("") } else { text };
        let Lexed { tokens, comments, interner, literals, texts, diagnostics } = lex(&text, file);
        let layout = marked.then(|| SourceLayout {
            tokens: tokens.clone(),
            comments,
            roles: vec![TokenRole::Plain; tokens.len()],
            starts: Vec::new(),
            open_at: Vec::new(),
            close_at: Vec::new(),
        });
        let expected = tokens.len() / 2;
        Parser {
            at: 0,
            program: Program {
                text,
                file,
                interner,
                literals,
                texts,
                exprs: Vec::with_capacity(expected),
                stmts: Vec::with_capacity(expected / 4),
                routines: Vec::new(),
                expr_lists: Vec::with_capacity(expected / 4),
                stmt_lists: Vec::new(),
                arg_lists: Vec::with_capacity(expected / 2),
                sub_lists: Vec::new(),
                chain_lists: Vec::new(),
                declarator_lists: Vec::new(),
                formal_lists: Vec::new(),
                body: NodeList::new(0, 0),
                edited: Vec::new(),
            },
            heights: Vec::with_capacity(expected),
            diagnostics: too_large.into_iter().chain(diagnostics).collect(),
            unlisted: 0,
            nesting: 0,
            too_deep_is_reported: false,
            end_is_reported: false,
            magnitudes: 0,
            loops: 0,
            in_routine: false,
            layout,
            tokens,
            exprs: Vec::new(),
            stmts: Vec::new(),
            args: Vec::new(),
            subs: Vec::new(),
            items: Vec::new(),
            declarators: Vec::new(),
            waiting: Vec::new(),
            operands: Vec::new(),
        }
    }

    fn program(&mut self) {
        self.program.body = self.statements(None, 0);
    }

    fn finish(mut self) -> (Program, Vec<Diagnostic>, SourceLayout) {
        let end = self.tokens.last().map_or(0, |token| token.end);
        self.diagnostics.sort_by_key(|diagnostic| diagnostic.span().start);
        if self.diagnostics.len() > MAX_DIAGNOSTICS {
            self.unlisted += self.diagnostics.len() - MAX_DIAGNOSTICS;
            self.diagnostics.truncate(MAX_DIAGNOSTICS);
        }
        if self.unlisted > 0 {
            let message = format!("{} more faults are not listed", self.unlisted);
            let at = Span::point(self.program.file, end);
            self.diagnostics.push(Diagnostic::error("too-many-errors", message).at(at));
        }
        let layout = self.layout.unwrap_or_else(|| SourceLayout {
            tokens: Vec::new(),
            comments: Vec::new(),
            roles: Vec::new(),
            starts: Vec::new(),
            open_at: Vec::new(),
            close_at: Vec::new(),
        });
        (self.program, self.diagnostics, layout)
    }

    // Tokens.

    fn token(&self) -> Token {
        self.tokens[self.at]
    }

    fn kind(&self) -> Kind {
        self.tokens[self.at].kind
    }

    fn peek(&self, ahead: usize) -> Token {
        self.tokens[(self.at + ahead).min(self.tokens.len() - 1)]
    }

    fn next(&mut self) -> Token {
        let token = self.tokens[self.at];
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        token
    }

    fn eat(&mut self, kind: Kind) -> bool {
        let found = self.kind() == kind;
        if found {
            self.next();
        }
        found
    }

    fn span(&self, token: Token) -> Span {
        Span::new(self.program.file, token.start, token.end)
    }

    /// The span from a byte to the end of the last token taken.
    fn span_from(&self, start: u32) -> Span {
        Span::new(self.program.file, start, self.last_end().max(start))
    }

    fn last_end(&self) -> u32 {
        if self.at == 0 { 0 } else { self.tokens[self.at - 1].end }
    }

    fn expect(&mut self, kind: Kind, expected: &str) -> Parse<Token> {
        if self.kind() == kind { Ok(self.next()) } else { Err(self.unexpected(expected)) }
    }

    /// Takes the bracket that closes `open`.
    fn expect_close(&mut self, kind: Kind, open: Token, expected: &str) -> Parse<Token> {
        if self.kind() == kind {
            return Ok(self.next());
        }
        let token = self.token();
        if token.kind == Kind::Bad {
            return Err(Reported);
        }
        let opener = self.program.slice(self.span(open)).to_owned();
        let closer = match kind {
            Kind::RParen => ")",
            Kind::RBracket => "]",
            Kind::RBrace => "}",
            _ => "|",
        };
        let found = self.describe(token);
        let ends = matches!(
            token.kind,
            Kind::End | Kind::Semi | Kind::RBrace | Kind::RParen | Kind::RBracket
        );
        let diagnostic = if ends || self.at_fresh_statement() {
            let message = format!("`{opener}` is not closed");
            let diagnostic =
                Diagnostic::error("unclosed-bracket", message).expected(format!("`{closer}`"));
            diagnostic.at(self.span(token)).found(found)
        } else {
            let message = format!("unexpected {}", without_article(&found));
            let diagnostic = Diagnostic::error("unexpected-token", message).expected(expected);
            diagnostic.at(self.span(token)).found(found)
        };
        self.report(diagnostic.note_at(self.span(open), "opened here"));
        Err(Reported)
    }

    fn ident(&mut self, expected: &str) -> Parse<Ident> {
        let token = self.expect(Kind::Ident, expected)?;
        Ok(Ident { symbol: token.symbol(), span: self.span(token) })
    }

    fn symbol_text(&self, symbol: Symbol) -> &str {
        self.program.name(symbol)
    }

    // Faults.

    fn report(&mut self, diagnostic: Diagnostic) {
        if self.diagnostics.len() < 2 * MAX_DIAGNOSTICS {
            self.diagnostics.push(diagnostic);
        } else {
            self.unlisted += 1;
        }
    }

    fn describe(&self, token: Token) -> String {
        let text = self.program.slice(self.span(token));
        match token.kind {
            Kind::End => "the end of the text".to_owned(),
            Kind::Text => "a quoted text".to_owned(),
            Kind::Number => format!("the number `{text}`"),
            Kind::Ident => format!("the name `{text}`"),
            kind if (kind as u8) <= Kind::Print as u8 => format!("the reserved word `{text}`"),
            _ => format!("`{text}`"),
        }
    }

    /// Reports the current token.
    fn unexpected(&mut self, expected: &str) -> Reported {
        let token = self.token();
        if token.kind == Kind::Bad || (token.kind == Kind::End && self.end_is_reported) {
            return Reported;
        }
        self.end_is_reported |= token.kind == Kind::End;
        let found = self.describe(token);
        let message = format!("unexpected {}", without_article(&found));
        let diagnostic = Diagnostic::error("unexpected-token", message).at(self.span(token));
        let habit = self.habit();
        self.report(diagnostic.expected(expected).found(found).maybe_help(habit));
        Reported
    }

    /// The equivalent of a spelling of C, Python or MATLAB, if the unexpected token is one.
    fn habit(&self) -> Option<&'static str> {
        let token = self.token();
        let before = self.at.checked_sub(1).map(|at| self.tokens[at]);
        let pair = |a: Kind, b: Kind| {
            let follows = |first: Token, second: Token| {
                first.kind == a && second.kind == b && first.end == second.start
            };
            before.is_some_and(|before| follows(before, token)) || follows(token, self.peek(1))
        };
        if pair(Kind::Slash, Kind::Slash) {
            return Some("comments begin with `#`; the whole quotient is `div(a, b)`");
        }
        if pair(Kind::Slash, Kind::Star) {
            return Some("comments begin with `#` and end with the line");
        }
        if pair(Kind::Star, Kind::Star) {
            return Some("a power is written `a^b`");
        }
        if pair(Kind::Plus, Kind::Plus) || pair(Kind::Minus, Kind::Minus) {
            return Some("count with `i += 1` and `i -= 1`");
        }
        if token.kind == Kind::TypeWord && before.is_some_and(|t| t.kind == Kind::LParen) {
            return Some("the variable of a loop has no type: `for (i = 1:n)`");
        }
        if before.is_some_and(|t| matches!(t.kind, Kind::If | Kind::While | Kind::For)) {
            return Some("conditions and loops have parentheses: `if (x > 0)`, `for (i = 1:n)`");
        }
        if before.is_some_and(|t| t.kind == Kind::Foreach) {
            return foreign_word("in");
        }
        if token.kind == Kind::LBracket {
            return Some("a row is written in braces: `farray a = {1, 2, 3, 4};`");
        }
        // The nearest such word before it on its line.
        let line = self.tokens[..=self.at.min(self.tokens.len() - 1)].iter().rev();
        line.scan(true, |goes_on, token| {
            std::mem::replace(goes_on, !token.new_line).then_some(*token)
        })
        .find_map(|token| foreign_word(self.program.slice(self.span(token))))
    }

    /// Goes one level deeper; [`Parser::leave`] must follow if it succeeds.
    fn enter(&mut self) -> Parse<()> {
        if self.nesting < MAX_NESTING {
            self.nesting += 1;
            return Ok(());
        }
        if !self.too_deep_is_reported {
            self.too_deep_is_reported = true;
            let diagnostic =
                Diagnostic::error("nesting-too-deep", "brackets or blocks are nested too deep")
                    .at(self.span(self.token()))
                    .expected(format!("at most {MAX_NESTING} levels"));
            self.report(diagnostic);
        }
        Err(Reported)
    }

    fn leave(&mut self) {
        self.nesting -= 1;
    }

    // Layout.

    fn mark(&mut self, at: usize, role: TokenRole) {
        if let Some(layout) = &mut self.layout {
            layout.roles[at] = role;
        }
    }

    fn next_as(&mut self, role: TokenRole) -> Token {
        self.mark(self.at, role);
        self.next()
    }

    fn start_line(&mut self, depth: u32) {
        if let Some(layout) = &mut self.layout {
            layout.starts.push((self.at as u32, depth));
        }
    }

    // Nodes.

    fn push_expr(&mut self, kind: ExprKind, span: Span, height: u16) -> ExprId {
        let id = ExprId(self.program.exprs.len() as u32);
        self.program.exprs.push(Expr { kind, span });
        self.heights.push(height);
        id
    }

    fn push_stmt(&mut self, kind: StmtKind, span: Span) -> StmtId {
        let id = StmtId(self.program.stmts.len() as u32);
        self.program.stmts.push(Stmt { kind, span });
        id
    }

    fn height(&self, expr: ExprId) -> u16 {
        self.heights[expr.0 as usize]
    }

    /// Adds an expression above others, unless the tree becomes too high.
    fn push_above(&mut self, kind: ExprKind, span: Span, below: u16) -> Parse<ExprId> {
        if below < MAX_HEIGHT {
            return Ok(self.push_expr(kind, span, below + 1));
        }
        let diagnostic = Diagnostic::error("nesting-too-deep", "this expression is too long")
            .at(span)
            .expected(format!("at most {MAX_HEIGHT} operators one after the other"))
            .help("compute parts of it in variables");
        self.report(diagnostic);
        Err(Reported)
    }
}

/// The equivalent of another language's word.
pub fn foreign_word(word: &str) -> Option<&'static str> {
    Some(match word {
        "def" | "fn" | "func" => {
            "a function is declared with its types: `function float f(float x) { return x; }`"
        }
        "elif" | "elseif" | "elsif" => "a further condition is `else if (condition)`",
        "end" | "endif" | "endfor" | "endwhile" | "endfunction" | "begin" => {
            "statements that belong together are in braces, `for (i = 1:n) { ... }`; the last element is `a[a.d1]`"
        }
        "do" | "repeat" | "until" => {
            "a loop is `while (condition) { ... }` or `for (i = 1:n) { ... }`"
        }
        "var" | "let" | "const" | "auto" | "double" | "real" | "bool" | "boolean" => {
            "a variable is declared with its type: `float x = 1;`"
        }
        "true" | "True" | "false" | "False" => {
            "a condition is a number: 1, or 0 if it does not hold"
        }
        "null" | "None" | "nil" => "a variable without a value is only declared: `farray a;`",
        "in" => "a loop through a list is `foreach (x in list)`",
        "switch" | "case" => "further conditions are `else if (x == 2)`",
        "zeros" | "ones" => "`farray a[n];` is a row of zeros, `farray a[n] = 1;` one of ones",
        "linspace" | "arange" => "`uniform(a, b, n)` is a row of n numbers from a to b",
        "pow" => "a power is written `a^b`",
        "printf" | "println" | "disp" => "values are shown by `print a, b;`",
        "import" | "include" | "from" | "#include" => "a file is loaded by `load \"file.sdl\"`",
        "struct" | "class" | "typedef" => "members belong together in `record name { float x; }`",
        _ => return None,
    })
}

/// Moves the end of a scratch stack into a table of lists.
fn close_list<T: Copy>(scratch: &mut Vec<T>, base: usize, table: &mut Vec<T>) -> NodeList<T> {
    let list = NodeList::new(table.len(), scratch.len() - base);
    table.extend_from_slice(&scratch[base..]);
    scratch.truncate(base);
    list
}
