//! What went wrong with a command: the code of 1983, what and where, and the next step.

use super::subject::ReplySubject;

/// A refused command. It has changed nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandError {
    /// The number of the 1983 table (manual, appendix E), or one of ours from 310, 701-703; 0 for
    /// faults of the text.
    pub code: u16,
    /// What and where.
    pub text: String,
    /// What to do next.
    pub next: String,
    /// What it is about, as data.
    pub about: Box<ReplySubject>,
}

impl CommandError {
    /// A fault with its next step.
    pub fn new(code: u16, text: impl Into<String>, next: impl Into<String>) -> CommandError {
        CommandError { code, text: text.into(), next: next.into(), about: Box::default() }
    }

    /// The same with what it is about.
    #[must_use]
    pub fn about(self, about: ReplySubject) -> CommandError {
        CommandError { about: Box::new(about), ..self }
    }

    /// A fault of the text of a command.
    pub fn text(text: impl Into<String>, next: impl Into<String>) -> CommandError {
        CommandError::new(0, text, next)
    }
}
