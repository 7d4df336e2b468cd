//! Text into tokens.

use super::ast::Literal;
use super::interner::Interner;
use super::token::{self, Comment, Kind, RESERVED, Token};
use moldloft_diag::{Diagnostic, FileId, Span};

/// Result of lexing a text; the last token is `End`.
pub(crate) struct Lexed {
    pub tokens: Vec<Token>,
    pub comments: Vec<Comment>,
    pub interner: Interner,
    pub literals: Vec<Literal>,
    pub texts: Vec<Box<str>>,
    pub diagnostics: Vec<Diagnostic>,
}

pub(crate) fn lex(text: &str, file: FileId) -> Lexed {
    let mut lexer = Lexer {
        text,
        bytes: text.as_bytes(),
        file,
        at: 0,
        new_line: false,
        out: Lexed {
            tokens: Vec::with_capacity(text.len() / 4 + 1),
            comments: Vec::new(),
            interner: token::interner(),
            literals: Vec::with_capacity(text.len() / 12),
            texts: Vec::new(),
            diagnostics: Vec::new(),
        },
    };
    // A byte order mark is a blank.
    if text.starts_with('\u{feff}') {
        lexer.at = '\u{feff}'.len_utf8();
    }
    lexer.run();
    lexer.out
}

struct Lexer<'a> {
    text: &'a str,
    bytes: &'a [u8],
    file: FileId,
    at: usize,
    new_line: bool,
    out: Lexed,
}

fn starts_word(byte: u8) -> bool {
    byte.is_ascii_alphabetic() || byte == b'_'
}

fn in_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

impl Lexer<'_> {
    fn peek(&self, ahead: usize) -> u8 {
        self.bytes.get(self.at + ahead).copied().unwrap_or(0)
    }

    fn run(&mut self) {
        while self.at < self.bytes.len() {
            match self.bytes[self.at] {
                b'\n' => {
                    self.new_line = true;
                    self.at += 1;
                }
                // Old programs divide their pages by form feeds.
                b' ' | b'\t' | b'\r' | b'\x0c' => self.at += 1,
                b'#' => self.comment(),
                byte if starts_word(byte) => self.word(),
                b'0'..=b'9' => self.number(),
                b'"' => self.string(),
                b'.' => self.dot(),
                byte => self.operator(byte),
            }
        }
        self.push(Kind::End, self.at, 0);
    }

    fn push(&mut self, kind: Kind, start: usize, payload: u32) {
        let token = Token {
            kind,
            new_line: self.new_line,
            start: start as u32,
            end: self.at as u32,
            payload,
        };
        self.out.tokens.push(token);
        self.new_line = false;
    }

    fn span(&self, start: usize) -> Span {
        Span::new(self.file, start as u32, self.at as u32)
    }

    fn comment(&mut self) {
        let start = self.at;
        let rest = &self.bytes[start..];
        let length = rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len());
        self.at += length;
        let kept = self.text[start..self.at].trim_end().len();
        let before = self.out.tokens.len() as u32;
        self.out.comments.push(Comment { start: start as u32, end: (start + kept) as u32, before });
    }

    fn word(&mut self) {
        let start = self.at;
        while in_word(self.peek(0)) {
            self.at += 1;
        }
        let symbol = self.out.interner.intern(&self.text[start..self.at]);
        let member = self.out.tokens.last().is_some_and(|token| token.kind == Kind::MemberDot);
        let kind = match RESERVED.get(symbol.0 as usize) {
            Some((_, kind)) if !member => *kind,
            _ => Kind::Ident,
        };
        self.push(kind, start, symbol.0);
    }

    fn digits(&mut self) {
        while self.peek(0).is_ascii_digit() {
            self.at += 1;
        }
    }

    fn number(&mut self) {
        let start = self.at;
        let mut is_int = true;
        self.digits();
        // `1...` is left to the ellipsis; `2.*v` is a number times v.
        if self.peek(0) == b'.' && !(self.peek(1) == b'.' && self.peek(2) == b'.') {
            is_int = false;
            self.at += 1;
            self.digits();
        }
        if matches!(self.peek(0), b'e' | b'E') {
            let sign = usize::from(matches!(self.peek(1), b'+' | b'-'));
            if self.peek(1 + sign).is_ascii_digit() {
                is_int = false;
                self.at += 1 + sign;
                self.digits();
            }
        }
        let digits = &self.text[start..self.at];
        let mut value: f64 = digits.parse().unwrap_or(f64::INFINITY);
        let span = self.span(start);
        let second_point = self.peek(0) == b'.' && self.peek(1).is_ascii_digit();
        if in_word(self.peek(0)) || second_point {
            let from = self.at;
            while in_word(self.peek(0)) || (self.peek(0) == b'.' && in_word(self.peek(1))) {
                self.at += 1;
            }
            let message =
                format!("`{}` is neither a number nor a name", &self.text[start..self.at]);
            let help =
                format!("a blank or an operator is missing before `{}`", &self.text[from..self.at]);
            self.out
                .diagnostics
                .push(Diagnostic::error("bad-number", message).at(self.span(start)).help(help));
        } else if value.is_infinite() {
            let message = "this number is too large for a double";
            let diagnostic =
                Diagnostic::error("bad-number", message).at(span).expected("at most 1.797e308");
            self.out.diagnostics.push(diagnostic);
            value = f64::MAX;
        }
        let id = self.out.literals.len() as u32;
        self.out.literals.push(Literal {
            value,
            is_int,
            span,
            edited: false,
            wrap_negative: false,
        });
        self.push(Kind::Number, start, id);
    }

    fn string(&mut self) {
        let start = self.at;
        let mut content = String::new();
        self.at += 1;
        let mut from = self.at;
        let closed = loop {
            match self.bytes.get(self.at) {
                None | Some(b'\n') => break false,
                Some(b'"') => break true,
                Some(b'\\') => {
                    content.push_str(&self.text[from..self.at]);
                    self.at += 1;
                    let Some(escaped) = self.text[self.at..].chars().next().filter(|c| *c != '\n')
                    else {
                        from = self.at;
                        break false;
                    };
                    self.at += escaped.len_utf8();
                    from = self.at;
                    content.push(match escaped {
                        'n' => '\n',
                        't' => '\t',
                        'r' => '\r',
                        other => other,
                    });
                }
                Some(_) => self.at += 1,
            }
        };
        content.push_str(&self.text[from..self.at]);
        if closed {
            self.at += 1;
        } else {
            let diagnostic =
                Diagnostic::error("unclosed-string", "this text is not closed on its line")
                    .at(self.span(start))
                    .expected("`\"`")
                    .found("the end of the line")
                    .help("write a line end inside a text as `\\n`");
            self.out.diagnostics.push(diagnostic);
        }
        let id = self.out.texts.len() as u32;
        self.out.texts.push(content.into_boxed_str());
        self.push(Kind::Text, start, id);
    }

    fn dot(&mut self) {
        let start = self.at;
        let last = self.out.tokens.last().copied();
        let last_kind = last.map_or(Kind::Semi, |token| token.kind);
        if self.peek(1) == b'.' && self.peek(2) == b'.' {
            self.at += 3;
            return self.push(Kind::Ellipsis, start, 0);
        }
        if self.peek(1) == b'*' {
            self.at += 2;
            return self.push(Kind::Cross, start, 0);
        }
        // After `|` it may start an operand; a dot product with a number is never legal, so nothing is lost.
        let after_operand = matches!(
            last_kind,
            Kind::Ident | Kind::Number | Kind::Text | Kind::RBracket | Kind::RParen | Kind::RBrace
        );
        if self.peek(1).is_ascii_digit() && !after_operand {
            return self.number();
        }
        let glued = last.is_some_and(|token| token.end as usize == start)
            && (after_operand || last_kind == Kind::Pipe)
            && !matches!(last_kind, Kind::Number | Kind::Text);
        self.at += 1;
        let kind = if glued && starts_word(self.peek(0)) { Kind::MemberDot } else { Kind::Dot };
        self.push(kind, start, 0);
    }

    fn operator(&mut self, byte: u8) {
        let start = self.at;
        let followed = self.peek(1) == b'=';
        let (kind, length) = match byte {
            b'(' => (Kind::LParen, 1),
            b')' => (Kind::RParen, 1),
            b'[' => (Kind::LBracket, 1),
            b']' => (Kind::RBracket, 1),
            b'{' => (Kind::LBrace, 1),
            b'}' => (Kind::RBrace, 1),
            b',' => (Kind::Comma, 1),
            b';' => (Kind::Semi, 1),
            b':' => (Kind::Colon, 1),
            b'|' => (Kind::Pipe, 1),
            b'+' if followed => (Kind::PlusAssign, 2),
            b'-' if followed => (Kind::MinusAssign, 2),
            b'*' if followed => (Kind::StarAssign, 2),
            b'/' if followed => (Kind::SlashAssign, 2),
            b'^' if followed => (Kind::CaretAssign, 2),
            b'=' if followed => (Kind::EqEq, 2),
            b'!' if followed => (Kind::NotEq, 2),
            b'<' if followed => (Kind::Le, 2),
            b'>' if followed => (Kind::Ge, 2),
            b'&' if self.peek(1) == b'&' => (Kind::AmpAmp, 2),
            b'&' => (Kind::Amp, 1),
            b'+' => (Kind::Plus, 1),
            b'-' => (Kind::Minus, 1),
            b'*' => (Kind::Star, 1),
            b'/' => (Kind::Slash, 1),
            b'^' => (Kind::Caret, 1),
            b'=' => (Kind::Assign, 1),
            b'!' => (Kind::Bang, 1),
            b'<' => (Kind::Lt, 1),
            b'>' => (Kind::Gt, 1),
            _ => return self.bad(),
        };
        self.at += length;
        self.push(kind, start, 0);
    }

    /// Takes a run of characters that mean nothing, reported once.
    fn bad(&mut self) {
        let start = self.at;
        for c in self.text[start..].chars() {
            let known = c.is_ascii_graphic() || c.is_ascii_whitespace();
            // The first is taken whatever it is: who came here knows no meaning of it.
            if self.at > start && known && !is_foreign(c) {
                break;
            }
            self.at += c.len_utf8();
        }
        let run = &self.text[start..self.at];
        let spelled = |c: char| match c {
            '\'' => c.to_string(),
            _ => c.escape_debug().to_string(),
        };
        let shown: String = run.chars().take(12).map(spelled).collect();
        let first = run.chars().next().unwrap_or(' ');
        let help = match first {
            '“' | '”' | '„' => Some("a string is enclosed in straight quotes `\"`"),
            '−' | '–' | '—' => Some("the minus sign is the hyphen `-`"),
            '×' | '·' => Some("multiply with `*`"),
            '\'' => Some("a string is enclosed in double quotes `\"`"),
            '%' => Some("the rest of a division is `mod(a, b)`"),
            '?' => Some("a choice between two values is `where(condition, a, b)`, or `if`"),
            c if c.is_alphabetic() => Some("names are made of the letters A to Z, digits and `_`"),
            _ => None,
        };
        let message = format!("`{shown}` is not a valid character");
        self.out.diagnostics.push(
            Diagnostic::error("bad-character", message).at(self.span(start)).maybe_help(help),
        );
        self.push(Kind::Bad, start, 0);
    }
}

/// Printable ASCII characters that the language does not use.
fn is_foreign(c: char) -> bool {
    matches!(c, '$' | '%' | '\'' | '?' | '@' | '\\' | '`' | '~')
}

#[cfg(test)]
mod tests {
    use super::*;
    use Kind::*;

    fn kinds(text: &str) -> Vec<Kind> {
        lex(text, FileId(0)).tokens.iter().map(|token| token.kind).collect()
    }

    #[test]
    fn dots() {
        assert_eq!(kinds("a.x"), [Ident, MemberDot, Ident, End]);
        assert_eq!(kinds("a . x"), [Ident, Dot, Ident, End]);
        assert_eq!(kinds("a .x"), [Ident, Dot, Ident, End]);
        assert_eq!(kinds("a. x"), [Ident, Dot, Ident, End]);
        assert_eq!(kinds("a.*b"), [Ident, Cross, Ident, End]);
        assert_eq!(kinds("2.*v"), [Number, Star, Ident, End]);
        assert_eq!(
            kinds("(.75,1.,1.e3,.5E-2)"),
            [LParen, Number, Comma, Number, Comma, Number, Comma, Number, RParen, End]
        );
        assert_eq!(kinds("c...)"), [Ident, Ellipsis, RParen, End]);
        assert_eq!(kinds("|v|.x"), [Pipe, Ident, Pipe, MemberDot, Ident, End]);
        assert_eq!(kinds("|.5|"), [Pipe, Number, Pipe, End]);
        assert_eq!(kinds("p.curve.d1"), [Ident, MemberDot, Ident, MemberDot, Ident, End]);
    }

    #[test]
    fn numbers_and_texts() {
        let lexed = lex("1 1. 1e3 0x 1e999 \"a\\\"b\\n\" \"open\n", FileId(0));
        let ids: Vec<&str> = lexed.diagnostics.iter().map(|d| d.id.as_ref()).collect();
        assert_eq!(ids, ["bad-number", "bad-number", "unclosed-string"]);
        assert!(lexed.literals[0].is_int && !lexed.literals[1].is_int && !lexed.literals[2].is_int);
        assert_eq!(lexed.literals[2].value, 1000.0);
        assert_eq!(&*lexed.texts[0], "a\"b\n");
        assert_eq!(&*lexed.texts[1], "open");
    }

    #[test]
    fn a_run_of_bad_characters_is_one_error() {
        let lexed = lex("a = $$é “ b;", FileId(0));
        assert_eq!(lexed.diagnostics.len(), 2);
    }
}
