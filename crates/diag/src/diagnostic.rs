//! The diagnostic and its builder.

use crate::{Sources, Span};
use std::borrow::Cow;
use std::fmt;
use std::ops::{Deref, DerefMut};

/// Severity of a diagnostic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// For information: the model is correct.
    Note,
    /// Probably a mistake; the result is valid.
    Warning,
    /// Something could not be done.
    Error,
}

impl Severity {
    /// The word printed for it: `error`, `warning` or `note`.
    pub fn word(self) -> &'static str {
        match self {
            Severity::Note => "note",
            Severity::Warning => "warning",
            Severity::Error => "error",
        }
    }
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

/// A span with a few words about it; the words may be empty.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Label {
    /// Position.
    pub span: Span,
    /// Text of the label.
    pub text: String,
}

/// A change of the source text that would remove the fault.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Edit {
    /// Replaced range; empty for an insertion.
    pub span: Span,
    /// The new text.
    pub replacement: String,
    /// Description of the change, for a menu.
    pub title: String,
}

/// The fields of a [`Diagnostic`].
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct DiagnosticFields {
    /// Stable name of the kind of fault, in kebab-case.
    pub id: Cow<'static, str>,
    /// Severity.
    pub severity: Severity,
    /// A self-contained line: lower case, no full stop.
    pub message: String,
    /// The span at fault.
    pub primary: Option<Label>,
    /// Other spans that explain it.
    pub secondary: Vec<Label>,
    /// Expected input.
    pub expected: Option<String>,
    /// Found input.
    pub found: Option<String>,
    /// Background: the path of parents, residuals, the last guess.
    pub notes: Vec<String>,
    /// The remedy.
    pub help: Vec<String>,
    /// A change of the text that fixes it.
    pub edit: Option<Edit>,
    /// The named object at fault.
    pub object: Option<String>,
}

/// One error, warning or note, as data.
///
/// The fields ([`DiagnosticFields`]) are reached through `Deref`; they live on the heap so that `Result<T, Diagnostic>` stays
/// small.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Diagnostic(Box<DiagnosticFields>);

impl Diagnostic {
    /// A diagnostic of any severity.
    pub fn new(
        severity: Severity,
        id: impl Into<Cow<'static, str>>,
        message: impl Into<String>,
    ) -> Self {
        Diagnostic(Box::new(DiagnosticFields {
            id: id.into(),
            severity,
            message: message.into(),
            primary: None,
            secondary: Vec::new(),
            expected: None,
            found: None,
            notes: Vec::new(),
            help: Vec::new(),
            edit: None,
            object: None,
        }))
    }

    /// An error.
    pub fn error(id: impl Into<Cow<'static, str>>, message: impl Into<String>) -> Self {
        Self::new(Severity::Error, id, message)
    }

    /// A warning.
    pub fn warning(id: impl Into<Cow<'static, str>>, message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, id, message)
    }

    /// A note.
    pub fn remark(id: impl Into<Cow<'static, str>>, message: impl Into<String>) -> Self {
        Self::new(Severity::Note, id, message)
    }

    /// Sets the span at fault. An unknown span is not recorded.
    #[must_use]
    pub fn at(mut self, span: Span) -> Self {
        if span.is_known() {
            let text = self.0.primary.take().map(|label| label.text).unwrap_or_default();
            self.0.primary = Some(Label { span, text });
        }
        self
    }

    /// Sets the position of the fault if there is none yet, for callers that know only an
    /// approximate position.
    #[must_use]
    pub fn or_at(self, span: Span) -> Self {
        if self.0.primary.is_some() { self } else { self.at(span) }
    }

    /// Sets the words printed under the position of the fault (default: `expected …, found …`).
    #[must_use]
    pub fn label(mut self, text: impl Into<String>) -> Self {
        if let Some(primary) = &mut self.0.primary {
            primary.text = text.into();
        }
        self
    }

    /// Sets the span at fault and the words printed under it.
    #[must_use]
    pub fn labelled(self, span: Span, text: impl Into<String>) -> Self {
        self.at(span).label(text)
    }

    /// Adds a span that explains the fault. An unknown span is not recorded.
    #[must_use]
    pub fn note_at(mut self, span: Span, text: impl Into<String>) -> Self {
        if span.is_known() {
            self.0.secondary.push(Label { span, text: text.into() });
        }
        self
    }

    /// Sets the expected input.
    #[must_use]
    pub fn expected(mut self, text: impl Into<String>) -> Self {
        self.0.expected = Some(text.into());
        self
    }

    /// Sets the found input.
    #[must_use]
    pub fn found(mut self, text: impl Into<String>) -> Self {
        self.0.found = Some(text.into());
        self
    }

    /// Adds background.
    #[must_use]
    pub fn note(mut self, text: impl Into<String>) -> Self {
        self.0.notes.push(text.into());
        self
    }

    /// Adds a remedy.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.0.help.push(text.into());
        self
    }

    /// Adds a help text, if there is one.
    #[must_use]
    pub fn maybe_help(self, text: Option<impl Into<String>>) -> Self {
        match text {
            Some(text) => self.help(text),
            None => self,
        }
    }

    /// Suggests the nearest of `candidates`, if one is similar enough to `name`.
    #[must_use]
    pub fn suggest<'a>(self, name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Self {
        self.maybe_help(crate::nearest(name, candidates).map(crate::did_you_mean))
    }

    /// Sets the change of the text that fixes it.
    #[must_use]
    pub fn edit(
        mut self,
        span: Span,
        replacement: impl Into<String>,
        title: impl Into<String>,
    ) -> Self {
        self.0.edit = Some(Edit { span, replacement: replacement.into(), title: title.into() });
        self
    }

    /// The change of the text that fixes the fault: the proposed one, or the name proposed by a
    /// help text.
    pub fn correction(&self, sources: &Sources) -> Option<Edit> {
        if self.edit.is_some() {
            return self.edit.clone();
        }
        let Span { file, start, end } = self.span();
        let there = sources.text(file)?.get(start as usize..end as usize)?;
        // A name may be written as a text.
        let word = there.trim_matches('"');
        let near = self.help.iter().find_map(|help| crate::nearest::proposed(help))?;
        crate::nearest(word, [near])?;
        let quotes = (there.len() - word.len()) as u32 / 2;
        Some(Edit {
            span: Span::new(file, start + quotes, end - quotes),
            replacement: near.to_string(),
            title: format!("change `{word}` to `{near}`"),
        })
    }

    /// Sets the object at fault.
    #[must_use]
    pub fn object(mut self, name: impl Into<String>) -> Self {
        self.0.object = Some(name.into());
        self
    }

    /// True for an error, false for a warning or a note.
    pub fn is_error(&self) -> bool {
        self.0.severity == Severity::Error
    }

    /// The span at fault, or the unknown span.
    pub fn span(&self) -> Span {
        self.0.primary.as_ref().map_or(Span::UNKNOWN, |label| label.span)
    }
}

impl Deref for Diagnostic {
    type Target = DiagnosticFields;
    fn deref(&self) -> &DiagnosticFields {
        &self.0
    }
}

impl DerefMut for Diagnostic {
    fn deref_mut(&mut self) -> &mut DiagnosticFields {
        &mut self.0
    }
}

impl fmt::Display for Diagnostic {
    /// The line without its position: `error[id]: message`, followed by expected and found.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}[{}]: {}", self.severity, self.id, self.message)?;
        if let Some(text) = self.expectation() {
            write!(f, " ({text})")?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostic {}

impl DiagnosticFields {
    /// `expected X, found Y`, or the part of it that is known.
    pub fn expectation(&self) -> Option<String> {
        match (&self.expected, &self.found) {
            (Some(expected), Some(found)) => Some(format!("expected {expected}, found {found}")),
            (Some(expected), None) => Some(format!("expected {expected}")),
            (None, Some(found)) => Some(format!("found {found}")),
            (None, None) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FileId;

    #[test]
    fn builds_and_displays() {
        let span = Span::new(FileId(0), 1, 2);
        let d = Diagnostic::error("bad-thing", "a thing is bad")
            .at(span)
            .label("here")
            .expected("a")
            .found("b");
        assert_eq!(d.to_string(), "error[bad-thing]: a thing is bad (expected a, found b)");
        assert_eq!(d.span(), span);
        assert!(d.is_error());
        assert!(std::mem::size_of::<Result<f64, Diagnostic>>() <= 16);
    }

    #[test]
    fn unknown_places_are_left_out() {
        let d = Diagnostic::warning("w", "m").at(Span::UNKNOWN).note_at(Span::UNKNOWN, "x");
        assert!(d.primary.is_none() && d.secondary.is_empty());
        assert_eq!(d.or_at(Span::new(FileId(1), 0, 1)).span().file, FileId(1));
    }

    #[test]
    fn suggests_the_nearest_name() {
        let d = Diagnostic::error("unknown-name", "no `hul`").suggest("hul", ["keel", "hull"]);
        assert_eq!(d.help, ["did you mean `hull`?"]);
    }
}
