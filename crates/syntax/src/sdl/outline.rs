//! Queries of an editor to a possibly unfinished text: the call around a position, and foldable
//! parts.
//!
//! Invariant: works on tokens alone, so that a text that cannot be parsed has an answer, too.

use super::lexer::lex;
use super::token::{Kind, Token};
use moldloft_diag::FileId;

/// A call or an object whose arguments are being typed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OpenCall {
    /// The function, subroutine or kind.
    pub callee: String,
    /// The byte of its first letter.
    pub start: u32,
    /// Number of arguments before the position.
    pub argument: usize,
    /// The name, when the argument is written as `name = value`.
    pub name: Option<String>,
}

/// Lines that can be folded into one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fold {
    /// A byte of the line that remains visible.
    pub start: u32,
    /// A byte of the last line.
    pub end: u32,
    /// True for comments.
    pub comment: bool,
}

struct OpenBracket {
    kind: Kind,
    callee: Option<(u32, u32)>,
    argument: usize,
    name: Option<(u32, u32)>,
}

/// The call around an offset: the innermost whose arguments are not closed before it.
///
/// ```
/// let call = moldloft_syntax::sdl::call_around("BCurve keel({A, B}, degree = ", 29).unwrap();
/// assert_eq!((call.callee.as_str(), call.argument, call.name.as_deref()), ("BCurve", 1, Some("degree")));
/// ```
pub fn call_around(text: &str, offset: u32) -> Option<OpenCall> {
    let lexed = lex(text, FileId(0));
    let mut open: Vec<OpenBracket> = Vec::new();
    let tokens: Vec<Token> = lexed.tokens.into_iter().filter(|t| t.kind != Kind::End).collect();
    for (k, token) in tokens.iter().enumerate() {
        if token.start >= offset {
            break;
        }
        step(&mut open, &tokens, k);
    }
    let call = open.iter().rev().find(|o| o.kind == Kind::LParen)?;
    let (start, end) = call.callee?;
    let slice = |(a, b): (u32, u32)| text[a as usize..b as usize].to_string();
    Some(OpenCall {
        callee: slice((start, end)),
        start,
        argument: call.argument,
        name: call.name.map(slice),
    })
}

/// Start of the quoted text around a position, after its quotation mark.
pub fn text_around(text: &str, offset: u32) -> Option<u32> {
    let lexed = lex(text, FileId(0));
    let text = lexed.tokens.iter().take_while(|t| t.start < offset).last()?;
    // A text that is not closed ends with its line; the offset at the end is still inside.
    let unclosed = || lexed.diagnostics.iter().any(|d| d.span().start == text.start);
    let inside = offset < text.end || (offset == text.end && unclosed());
    (text.kind == Kind::Text && inside).then_some(text.start + 1)
}

fn step(open: &mut Vec<OpenBracket>, tokens: &[Token], k: usize) {
    let token = tokens[k];
    let before = |n: usize| k.checked_sub(n).map(|at| tokens[at]);
    match token.kind {
        Kind::LParen => {
            // `kind name(` and `name(`, but no definition of a routine.
            let last = before(1).filter(|t| t.kind == Kind::Ident);
            let callee = last.and_then(|last| match before(2).map(|t| (t.kind, t)) {
                Some((Kind::Subroutine | Kind::Function | Kind::TypeWord, _)) => None,
                Some((Kind::Ident, kind)) if !last.new_line => Some((kind.start, kind.end)),
                _ => Some((last.start, last.end)),
            });
            open.push(opened(token, callee));
        }
        Kind::LBracket | Kind::LBrace => open.push(opened(token, None)),
        Kind::RParen | Kind::RBracket | Kind::RBrace => {
            let opening = match token.kind {
                Kind::RParen => Kind::LParen,
                Kind::RBracket => Kind::LBracket,
                _ => Kind::LBrace,
            };
            // A bracket that nothing opened closes nothing.
            if let Some(at) = open.iter().rposition(|o| o.kind == opening) {
                open.truncate(at);
            }
        }
        Kind::Semi => {
            // A statement is at its end, whatever it left open; the parts of `for (a; b; c)` are not calls.
            while open.last().is_some_and(|o| {
                o.kind != Kind::LBrace && (o.kind == Kind::LBracket || o.callee.is_some())
            }) {
                open.pop();
            }
        }
        Kind::Comma => {
            if let Some(call) = open.last_mut() {
                call.argument += 1;
                call.name = None;
            }
        }
        Kind::Assign => {
            let name = before(1).filter(|t| t.is_word());
            let begins = before(2).is_some_and(|t| matches!(t.kind, Kind::LParen | Kind::Comma));
            if let (Some(call), Some(name), true) = (open.last_mut(), name, begins) {
                call.name = Some((name.start, name.end));
            }
        }
        _ => {}
    }
}

fn opened(token: Token, callee: Option<(u32, u32)>) -> OpenBracket {
    OpenBracket { kind: token.kind, callee, argument: 0, name: None }
}

/// The foldable parts of a text: brackets over several lines, and comments of several lines.
pub fn folds(text: &str) -> Vec<Fold> {
    let lexed = lex(text, FileId(0));
    let mut folds = Vec::new();
    let mut open: Vec<Token> = Vec::new();
    let several = |a: u32, b: u32| text[a as usize..b as usize].contains('\n');
    for token in &lexed.tokens {
        match token.kind {
            Kind::LParen | Kind::LBracket | Kind::LBrace => open.push(*token),
            Kind::RParen | Kind::RBracket | Kind::RBrace => {
                let opening = match token.kind {
                    Kind::RParen => Kind::LParen,
                    Kind::RBracket => Kind::LBracket,
                    _ => Kind::LBrace,
                };
                let Some(at) = open.iter().rposition(|o| o.kind == opening) else { continue };
                let start = open[at].start;
                open.truncate(at);
                if several(start, token.start) {
                    folds.push(Fold { start, end: token.start, comment: false });
                }
            }
            _ => {}
        }
    }
    let mut run: Option<(u32, u32)> = None;
    for comment in &lexed.comments {
        let line = text[..comment.start as usize].rfind('\n').map_or(0, |at| at + 1);
        let alone = text[line..comment.start as usize].trim().is_empty();
        let follows = |end: u32| {
            let between = &text[end as usize..comment.start as usize];
            between.matches('\n').count() == 1 && between.trim().is_empty()
        };
        run = match run {
            Some((start, end)) if alone && follows(end) => Some((start, comment.end)),
            other => {
                folds.extend(comment_fold(other, several));
                alone.then_some((comment.start, comment.end))
            }
        };
    }
    folds.extend(comment_fold(run, several));
    folds.sort_by_key(|fold| (fold.start, fold.end));
    folds
}

fn comment_fold(run: Option<(u32, u32)>, several: impl Fn(u32, u32) -> bool) -> Option<Fold> {
    let (start, end) = run?;
    several(start, end).then_some(Fold { start, end, comment: true })
}
