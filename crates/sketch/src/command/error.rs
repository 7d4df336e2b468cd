//! What went wrong with a command: the code of 1983, what and where, and the next step.

/// A refused command. It has changed nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CommandError {
    /// The number of the 1983 table (manual, appendix E), or one of ours from 310, 701-703; 0 for
    /// faults of the text.
    pub code: u16,
    /// What and where.
    pub text: String,
    /// What to do next.
    pub next: String,
}

impl CommandError {
    /// A fault with its next step.
    pub fn new(code: u16, text: impl Into<String>, next: impl Into<String>) -> CommandError {
        CommandError { code, text: text.into(), next: next.into() }
    }

    /// A fault of the text of a command.
    pub fn text(text: impl Into<String>, next: impl Into<String>) -> CommandError {
        CommandError::new(0, text, next)
    }
}
