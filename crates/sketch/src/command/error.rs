//! Errors of commands: the code of 1983, fault and position, and the next step.

use super::subject::ReplySubject;

/// A refused command. It has changed nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandError {
    /// The number in the 1983 table (manual, appendix E), or a later one from 310, 701 to 703; 0
    /// for faults of the text.
    pub code: u16,
    /// Fault and position.
    pub text: String,
    /// Next step.
    pub next: String,
    /// Subject, as data.
    pub about: Box<ReplySubject>,
}

impl CommandError {
    /// A fault with a remedy.
    pub fn new(code: u16, text: impl Into<String>, next: impl Into<String>) -> CommandError {
        let about = Box::new(ReplySubject::of(kind(code)));
        CommandError { code, text: text.into(), next: next.into(), about }
    }

    /// The error with a subject.
    #[must_use]
    pub fn about(self, about: ReplySubject) -> CommandError {
        CommandError { about: Box::new(about), ..self }
    }

    /// A fault in the text of a command.
    pub fn text(text: impl Into<String>, next: impl Into<String>) -> CommandError {
        CommandError::new(0, text, next)
    }
}

/// Kind of an error without a narrower one, by its code.
fn kind(code: u16) -> &'static str {
    match code {
        101 => "no-points",
        102 => "no-lines",
        105 => "unknown-axis",
        110 => "unknown-object",
        112 => "no-active-object",
        113 => "no-cross-section",
        114 => "cross-section",
        191 | 192 => "usage",
        200 => "too-large",
        300 => "no-length",
        310 => "size",
        396 => "determined-already",
        398 => "no-planes",
        399 | 600 => "file",
        400 => "type-contradiction",
        401 => "loose-point",
        402 => "untyped-line",
        404 => "missing-dimension",
        405 => "axes",
        406 => "line-type",
        411 => "unsolved",
        700 => "face-turned",
        701 | 703 => "no-body",
        702 => "choice",
        _ => "command",
    }
}
