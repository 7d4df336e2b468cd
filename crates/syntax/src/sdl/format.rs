//! Canonical text.
//!
//! The formatter changes the blanks between tokens, never the tokens, with three exceptions that keep the meaning:
//! empty statements are dropped, numbers get a digit on both sides of their point, and parentheses are added where set
//! operators group otherwise than numbers would. Line breaks inside a statement stay where the author put them; longer
//! lines are broken behind commas, and before the signs and the logical operators of an expression.

use super::parser::version::refused;
use super::parser::{SourceLayout, TokenRole, parse_marked};
use super::token::{Comment, Kind, Token};
use moldloft_diag::{Diagnostic, FileId};
use std::sync::Arc;

const INDENT: usize = 4;

/// Lines are broken behind a comma or before an operator where they would be longer than this, in characters.
const MAX_LINE: usize = 120;

/// The canonical text of a program: one statement per line, blocks indented by four blanks, with
/// single blank lines and all comments kept. Formatting canonical text changes nothing.
///
/// ```
/// use moldloft_syntax::sdl::format;
/// assert_eq!(format("float a=2.*b;;a  =.5; # half").unwrap(), "float a = 2.0 * b;\na = 0.5;  # half\n");
/// assert!(format("float = 3;").is_err());
/// ```
///
/// # Errors
/// The diagnostics of a text with syntax errors, which is not formatted. They point into [`FileId`] 0.
pub fn format(text: &str) -> Result<String, Vec<Diagnostic>> {
    let text: Arc<str> = Arc::from(text);
    if let Some(newer) = refused(&text, FileId(0)) {
        return Err(vec![newer]);
    }
    let (_, diagnostics, layout) = parse_marked(text.clone(), FileId(0));
    if diagnostics.iter().any(Diagnostic::is_error) {
        return Err(diagnostics);
    }
    Ok(Writer::new(&text, &layout).write())
}

struct Writer<'a> {
    text: &'a str,
    layout: &'a SourceLayout,
    open_at: Vec<u32>,
    close_at: Vec<u32>,
    out: String,
    /// Indentation of the current statement.
    depth: u32,
    /// Open brackets of the current statement: the line number of each in `out`.
    brackets: Vec<u32>,
    line: u32,
    at_line_start: bool,
    /// The last token written and its role.
    last: Option<(Token, TokenRole)>,
    /// True if at most a trailing comment was written since the block (or the text) began.
    first_in_block: bool,
    next_comment: usize,
    next_start: usize,
    /// End in the source of the last written part.
    source_end: u32,
}

impl<'a> Writer<'a> {
    fn new(text: &'a str, layout: &'a SourceLayout) -> Self {
        let mut open_at = layout.open_at.clone();
        let mut close_at = layout.close_at.clone();
        // Taken from the end.
        open_at.sort_unstable_by(|a, b| b.cmp(a));
        close_at.sort_unstable_by(|a, b| b.cmp(a));
        Writer {
            text,
            layout,
            open_at,
            close_at,
            out: String::with_capacity(text.len() + text.len() / 8),
            depth: 0,
            brackets: Vec::new(),
            line: 0,
            at_line_start: true,
            last: None,
            first_in_block: true,
            next_comment: 0,
            next_start: 0,
            source_end: 0,
        }
    }

    fn write(mut self) -> String {
        for at in 0..self.layout.tokens.len() {
            self.comments(at);
            let token = self.layout.tokens[at];
            let role = self.layout.roles[at];
            if token.kind == Kind::End {
                break;
            }
            if role == TokenRole::Redundant {
                self.next_start += 1;
                continue;
            }
            self.break_line(at, token, role);
            self.token(token, role);
        }
        if !self.at_line_start {
            self.out.push('\n');
        }
        self.out
    }

    /// True if the source has an empty line between two of its bytes.
    fn empty_line_between(&self, from: u32, to: u32) -> bool {
        let between = &self.text.as_bytes()[from as usize..to as usize];
        between.iter().filter(|byte| **byte == b'\n').count() > 1
    }

    fn new_line(&mut self) {
        if !self.at_line_start {
            self.out.push('\n');
            self.line += 1;
            self.at_line_start = true;
        }
    }

    /// An empty line, if the source has one and something precedes it in this block.
    fn empty_line(&mut self, source_start: u32) {
        if !self.first_in_block && self.empty_line_between(self.source_end, source_start) {
            self.out.push('\n');
            self.line += 1;
        }
    }

    fn indent(&mut self, closing: usize) {
        let mut levels = self.depth as usize;
        let kept = self.brackets.len().saturating_sub(closing);
        // Brackets opened on one line indent once; a closing one has the indentation of its
        // opener's line.
        let mut lines = self.brackets[..kept].to_vec();
        lines.dedup();
        if closing > 0 && lines.last() == self.brackets.get(kept) {
            lines.pop();
        }
        levels += lines.len();
        // A statement that continues without brackets.
        if kept == 0 && closing == 0 && self.inside_statement() {
            levels += 1;
        }
        self.out.extend(std::iter::repeat_n(' ', levels * INDENT));
        self.at_line_start = false;
    }

    /// True if the last token leaves a statement unfinished.
    fn inside_statement(&self) -> bool {
        !self.brackets.is_empty()
            || self.last.is_some_and(|(token, role)| {
                !(token.kind == Kind::Semi
                    || matches!(role, TokenRole::BlockOpen | TokenRole::BlockClose))
            })
    }

    /// Writes the comments before the token `at`.
    fn comments(&mut self, at: usize) {
        while let Some(comment) = self.layout.comments.get(self.next_comment).copied() {
            if comment.before as usize > at {
                return;
            }
            self.next_comment += 1;
            self.comment(comment, at);
        }
    }

    fn comment(&mut self, comment: Comment, at: usize) {
        let gap = &self.text[self.source_end as usize..comment.start as usize];
        let trailing = !self.at_line_start && !gap.contains('\n');
        if trailing {
            self.out.push_str("  ");
        } else {
            self.new_line();
            let first_in_block = std::mem::take(&mut self.first_in_block);
            let starts = self.start_of(at);
            // Comments before a statement or a `}` have the indentation of the block's content.
            let fresh = starts.is_some() || self.layout.tokens[at].kind == Kind::End;
            if fresh && self.brackets.is_empty() {
                if !first_in_block {
                    self.empty_line(comment.start);
                }
                let closes = self.layout.roles[at] == TokenRole::BlockClose;
                let depth = starts.map_or(0, |depth| depth + u32::from(closes));
                self.out.extend(std::iter::repeat_n(' ', depth as usize * INDENT));
                self.at_line_start = false;
            } else {
                self.indent(0);
            }
        }
        self.out.push_str(&self.text[comment.start as usize..comment.end as usize]);
        self.out.push('\n');
        self.line += 1;
        self.at_line_start = true;
        self.source_end = comment.end;
    }

    /// The indentation of the token, if it starts a line.
    fn start_of(&self, at: usize) -> Option<u32> {
        let (token, depth) = *self.layout.starts.get(self.next_start)?;
        (token as usize == at).then_some(depth)
    }

    /// Breaks the line before a token where one is due, and indents.
    fn break_line(&mut self, at: usize, token: Token, role: TokenRole) {
        if let Some(depth) = self.start_of(at) {
            self.next_start += 1;
            let opened = matches!(self.last, Some((_, TokenRole::BlockOpen)));
            if role == TokenRole::BlockClose && opened && !self.at_line_start {
                // `{}`
                self.depth = depth;
                return;
            }
            self.brackets.clear();
            self.new_line();
            let after_head = self.last.is_some_and(|(last, _)| {
                matches!(last.kind, Kind::RParen | Kind::Then | Kind::Else)
            });
            if role != TokenRole::BlockClose && token.kind != Kind::Else && !after_head {
                self.empty_line(token.start);
            }
            self.depth = depth;
            self.out.extend(std::iter::repeat_n(' ', depth as usize * INDENT));
            self.at_line_start = false;
            return;
        }
        let keeps_line =
            matches!(role, TokenRole::BlockOpen) || matches!(token.kind, Kind::Else | Kind::Then);
        let closing = usize::from(closes(token, role));
        if self.at_line_start
            || (token.new_line && !keeps_line && may_break(token, role, self.last))
        {
            self.new_line();
            if matches!(role, TokenRole::BlockOpen) || token.kind == Kind::Else {
                self.out.extend(std::iter::repeat_n(' ', self.depth as usize * INDENT));
                self.at_line_start = false;
            } else {
                self.indent(closing);
            }
        } else if self.is_too_long(at, breaks_before(token, role)) {
            self.new_line();
            self.indent(closing);
        } else if blank_between(self.last, token, role) {
            self.out.push(' ');
        }
    }

    /// True after a comma in brackets if the line is too short for the text up to the next comma, and before an
    /// operator if it is too short for the text up to the next one.
    fn is_too_long(&self, at: usize, operator: bool) -> bool {
        let comma = self.last.is_some_and(|(last, _)| last.kind == Kind::Comma);
        if !(operator || comma && !self.brackets.is_empty()) {
            return false;
        }
        let line = self.out.rfind('\n').map_or(0, |k| k + 1);
        let mut width = self.out[line..].chars().count();
        let mut depth = 0i32;
        // Canonical widths, so that canonical text is measured alike.
        for k in at..self.layout.tokens.len() {
            let (token, role) = (self.layout.tokens[k], self.layout.roles[k]);
            if k > at && (token.new_line || (operator && depth <= 0 && breaks_before(token, role)))
            {
                break;
            }
            depth += i32::from(opens(token, role)) - i32::from(closes(token, role));
            let text = &self.text[token.start as usize..token.end as usize];
            width += match token.kind {
                Kind::Number => {
                    let mut canonical = String::new();
                    number(text, &mut canonical);
                    canonical.len()
                }
                _ => text.chars().count(),
            };
            let last = k.checked_sub(1).map(|k| (self.layout.tokens[k], self.layout.roles[k]));
            width += usize::from(blank_between(last, token, role));
            if token.kind == Kind::Semi || (depth <= 0 && token.kind == Kind::Comma) {
                break;
            }
        }
        width > MAX_LINE && !(operator && self.is_in_subscript(at))
    }

    /// True if the innermost bracket that is open before a token is that of a subscript.
    fn is_in_subscript(&self, at: usize) -> bool {
        let mut closed = 0;
        for k in (0..at).rev() {
            let (token, role) = (self.layout.tokens[k], self.layout.roles[k]);
            if closes(token, role) {
                closed += 1;
            } else if opens(token, role) {
                if closed == 0 {
                    return token.kind == Kind::LBracket;
                }
                closed -= 1;
            } else if token.kind == Kind::Semi {
                break;
            }
        }
        false
    }

    fn token(&mut self, token: Token, role: TokenRole) {
        while self.open_at.last() == Some(&token.start) {
            self.open_at.pop();
            self.out.push('(');
            self.brackets.push(self.line);
        }
        if closes(token, role) {
            self.brackets.pop();
        }
        let text = &self.text[token.start as usize..token.end as usize];
        if token.kind == Kind::Number {
            number(text, &mut self.out)
        } else {
            self.out.push_str(text)
        }
        if opens(token, role) {
            self.brackets.push(self.line);
        }
        while self.close_at.last() == Some(&token.end) {
            self.close_at.pop();
            self.out.push(')');
            self.brackets.pop();
        }
        self.last = Some((token, role));
        self.first_in_block = role == TokenRole::BlockOpen;
        self.source_end = token.end;
    }
}

fn opens(token: Token, role: TokenRole) -> bool {
    role != TokenRole::BlockOpen
        && (matches!(token.kind, Kind::LParen | Kind::LBracket | Kind::LBrace)
            || (token.kind == Kind::Pipe && role == TokenRole::Open))
}

fn closes(token: Token, role: TokenRole) -> bool {
    role != TokenRole::BlockClose
        && (matches!(token.kind, Kind::RParen | Kind::RBracket | Kind::RBrace)
            || (token.kind == Kind::Pipe && role == TokenRole::Close))
}

/// True for an operator before which a long line is broken.
fn breaks_before(token: Token, role: TokenRole) -> bool {
    role == TokenRole::Infix
        && matches!(token.kind, Kind::Plus | Kind::Minus | Kind::And | Kind::Or | Kind::AmpAmp)
}

/// True if a line break of the source before this token is kept.
fn may_break(token: Token, role: TokenRole, last: Option<(Token, TokenRole)>) -> bool {
    let after_prefix = matches!(last, Some((_, TokenRole::Prefix)));
    let glued = matches!(token.kind, Kind::Semi | Kind::Comma | Kind::Ellipsis | Kind::MemberDot)
        || matches!(role, TokenRole::Applied | TokenRole::Tight);
    let after_tight = matches!(last, Some((last, role)) if role == TokenRole::Tight || last.kind == Kind::MemberDot);
    !(after_prefix || glued || after_tight)
}

/// True if there is a blank between two tokens of a line.
fn blank_between(last: Option<(Token, TokenRole)>, token: Token, role: TokenRole) -> bool {
    let Some((last, last_role)) = last else { return false };
    if matches!(last_role, TokenRole::Prefix | TokenRole::Open | TokenRole::Applied)
        || last.kind == Kind::MemberDot
    {
        return false;
    }
    if matches!(last.kind, Kind::LParen | Kind::LBracket) {
        return false;
    }
    if matches!(role, TokenRole::Close | TokenRole::Applied)
        || matches!(token.kind, Kind::RParen | Kind::RBracket)
    {
        return false;
    }
    if matches!(token.kind, Kind::Semi | Kind::Comma | Kind::Ellipsis | Kind::MemberDot) {
        return false;
    }
    if role == TokenRole::BlockClose && last_role == TokenRole::BlockOpen {
        return false;
    }
    // The second half of `||` is tight to the first and has a blank after it.
    let logical = last.kind == Kind::Pipe && last_role == TokenRole::Tight;
    !(role == TokenRole::Tight || (last_role == TokenRole::Tight && !logical))
}

/// A number with a digit on both sides of its point and a small `e`.
fn number(text: &str, out: &mut String) {
    let (mantissa, exponent) = match text.find(['e', 'E']) {
        Some(at) => (&text[..at], Some(&text[at + 1..])),
        None => (text, None),
    };
    if mantissa.starts_with('.') {
        out.push('0');
    }
    out.push_str(mantissa);
    if mantissa.ends_with('.') {
        out.push('0');
    }
    if let Some(exponent) = exponent {
        out.push('e');
        out.push_str(exponent);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formatted(text: &str) -> String {
        let once = format(text).unwrap_or_else(|faults| panic!("{text}\n{faults:#?}"));
        let twice = format(&once).unwrap_or_else(|faults| panic!("{once}\n{faults:#?}"));
        assert_eq!(once, twice, "formatting is idempotent");
        let dump = |text: &str| super::super::parse(text, FileId(0)).0.dump();
        assert_eq!(dump(text), dump(&once), "{text}\n{once}");
        once
    }

    #[test]
    fn spaces() {
        let cases = [
            ("a=b+c*d^2;", "a = b + c * d^2;\n"),
            ("a=-b-+c;", "a = -b - +c;\n"),
            ("a = ||b|-|c||;", "a = ||b| - |c||;\n"),
            ("if((|v|>1)||(|w|<2))f();", "if ((|v| > 1) || (|w| < 2)) f();\n"),
            ("c[ :45 ] = s[1, ];", "c[:45] = s[1,];\n"),
            ("x=a[2:n-1:2,i];", "x = a[2:n - 1:2, i];\n"),
            ("a = n . x.*v.x;", "a = n . x .* v.x;\n"),
            ("BCurve M( {P1,P2} ,degree=2 ) ;", "BCurve M({P1, P2}, degree = 2);\n"),
            ("for(i=1:n)x[i]=0;", "for (i = 1:n) x[i] = 0;\n"),
            ("for(i=0;i<n;i+=1){}", "for (i = 0; i < n; i += 1) {}\n"),
            ("a = !b and not c;", "a = !b and not c;\n"),
            (
                "subroutine f(float x,returned curve c...){return;}",
                "subroutine f(float x, returned curve c...) {\n    return;\n}\n",
            ),
            ("t = a|b&c;", "t = a | b & c;\n"),
            ("param float b=5. in[3,7];", "param float b = 5.0 in [3, 7];\n"),
            ("load \"a.sdl\" load \"b.sdl\";", "load \"a.sdl\"\nload \"b.sdl\";\n"),
            ("a = {};{{}}", "a = {};\n{\n    {}\n}\n"),
            ("a = 1.E+3 - .5e-2;", "a = 1.0e+3 - 0.5e-2;\n"),
            ("while(x);", "while (x);\n"),
        ];
        for (text, expected) in cases {
            assert_eq!(formatted(text), expected);
        }
    }

    #[test]
    fn lines_and_comments() {
        let text = "\n\n# head\n\n\n# second\na = 1; b = 2;   # two\n\n\nif (a) { # why\n\n b = 3;\n # last\n\n}\nelse\n c = 4;\n";
        let expected = "# head\n\n# second\na = 1;\nb = 2;  # two\n\nif (a) {  # why\n    b = 3;\n    # last\n} else\n    c = 4;\n";
        assert_eq!(formatted(text), expected);
        let list = "BCurve M({P1,\n P2, # second\n\n# own\nP3\n}, degree=2);";
        let expected = "BCurve M({P1,\n    P2,  # second\n    # own\n    P3\n}, degree = 2);\n";
        assert_eq!(formatted(list), expected);
        assert_eq!(formatted("a = b +\nc\n+ d; e = 1;"), "a = b +\n    c\n    + d;\ne = 1;\n");
        assert_eq!(
            formatted("if (a) # c\n{ b = 1; } # d\nelse b = 2;"),
            "if (a)  # c\n{\n    b = 1;\n}  # d\nelse b = 2;\n"
        );
    }

    #[test]
    fn long_lines_are_broken_behind_commas() {
        let point = "{1.25, 2.5, 3.75}";
        let text = format!("BCurve keel({{{}}}, degree = 3);", [point; 12].join(", "));
        let once = formatted(&text);
        assert!(
            once.lines().count() > 1 && once.lines().all(|line| line.len() <= MAX_LINE),
            "{once}"
        );
        let short = format!("BCurve keel({{{}}});\n", [point; 4].join(", "));
        assert_eq!(formatted(&short), short);
    }

    #[test]
    fn long_expressions_are_broken_before_operators() {
        let term = "coefficient[i, j] * (first - second)^2";
        let text = format!("a = {};", [term; 9].join(" + "));
        let once = formatted(&text);
        assert!(once.lines().all(|line| line.len() <= MAX_LINE), "{once}");
        assert!(once.lines().skip(1).all(|line| line.starts_with("    + coefficient")), "{once}");
        let text = format!("if ({}) a = 1;", ["x[i] < -1 || y > f(x, y)"; 9].join(" and "));
        assert!(formatted(&text).lines().all(|line| line.len() <= MAX_LINE));
        let short = format!("a = {};\n", [term; 2].join(" + "));
        assert_eq!(formatted(&short), short);
    }

    #[test]
    fn parentheses_where_sets_group_differently() {
        assert_eq!(formatted("t = a & b ^ c | d;"), "t = (a & b)^c | d;\n");
        assert_eq!(formatted("t = a | b ^ c;"), "t = a | b^c;\n");
        assert_eq!(formatted("t = a - b ^ c;"), "t = a - b^c;\n");
        assert_eq!(formatted("t = -a ^ (b - c) & d;"), "t = (-a)^((b - c) & d);\n");
    }

    #[test]
    fn faults_are_not_formatted() {
        assert!(format("a = ;").is_err());
        assert_eq!(format("").unwrap(), "");
        assert_eq!(format("# only\n\n").unwrap(), "# only\n");
    }
}
