//! Diagnostics with resolved positions, for JSON and other outer forms.

use crate::{Diagnostic, Label, Sources, Span};

/// A labelled span with file name, lines and columns (from 1; columns in characters; the end is
/// exclusive).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelData {
    /// Shown name of the file.
    pub file: String,
    /// First line.
    pub line: u32,
    /// First column.
    pub column: u32,
    /// Last line.
    pub end_line: u32,
    /// One past the last column.
    pub end_column: u32,
    /// The label's text; may be empty.
    pub text: String,
}

/// A proposed change of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EditData {
    /// Replaced range; `place.text` is empty.
    pub place: LabelData,
    /// The new text.
    pub replacement: String,
    /// Description of the change.
    pub title: String,
}

/// A [`Diagnostic`] without reference to a [`Sources`] table. Places in unknown files are left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DiagnosticData {
    /// Stable kebab-case name of the kind of fault.
    pub id: String,
    /// `error`, `warning` or `note`.
    pub severity: &'static str,
    /// The message.
    pub message: String,
    /// The span at fault.
    pub primary: Option<LabelData>,
    /// Other spans that explain it.
    pub secondary: Vec<LabelData>,
    /// Expected input.
    pub expected: Option<String>,
    /// Found input.
    pub found: Option<String>,
    /// Background.
    pub notes: Vec<String>,
    /// Ways to fix it.
    pub help: Vec<String>,
    /// A change of the text that fixes it.
    pub edit: Option<EditData>,
    /// The object at fault.
    pub object: Option<String>,
    /// The text that [`render`](crate::render) prints.
    pub rendered: String,
}

impl Diagnostic {
    /// The same facts with all spans resolved.
    pub fn to_data(&self, sources: &Sources) -> DiagnosticData {
        let label = |label: &Label| place(label.span, &label.text, sources);
        DiagnosticData {
            id: self.id.to_string(),
            severity: self.severity.word(),
            message: self.message.clone(),
            primary: self.primary.as_ref().and_then(label),
            secondary: self.secondary.iter().filter_map(label).collect(),
            expected: self.expected.clone(),
            found: self.found.clone(),
            notes: self.notes.clone(),
            help: self.help.clone(),
            edit: self.edit.as_ref().and_then(|edit| {
                Some(EditData {
                    place: place(edit.span, "", sources)?,
                    replacement: edit.replacement.clone(),
                    title: edit.title.clone(),
                })
            }),
            object: self.object.clone(),
            rendered: crate::render(self, sources),
        }
    }
}

fn place(span: Span, text: &str, sources: &Sources) -> Option<LabelData> {
    let start = sources.locate(span.file, span.start)?;
    let end = sources.locate(span.file, span.end.max(span.start))?;
    Some(LabelData {
        file: sources.name(span.file)?.to_owned(),
        line: start.line,
        column: start.column,
        end_line: end.line,
        end_column: end.column,
        text: text.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolves_places() {
        let mut sources = Sources::new();
        let file = sources.add("a.sdl", "one\ntwo three\n");
        let d = Diagnostic::error("e", "m")
            .at(Span::new(file, 8, 13))
            .note_at(Span::new(file, 0, 7), "both")
            .edit(Span::new(file, 8, 13), "four", "count on")
            .object("P");
        let data = d.to_data(&sources);
        let primary = data.primary.unwrap();
        assert_eq!(
            (primary.line, primary.column, primary.end_line, primary.end_column),
            (2, 5, 2, 10)
        );
        let both = &data.secondary[0];
        assert_eq!((both.line, both.column, both.end_line, both.end_column), (1, 1, 2, 4));
        assert_eq!(data.edit.unwrap().replacement, "four");
        assert_eq!((data.severity, data.object.as_deref()), ("error", Some("P")));
        assert!(data.rendered.starts_with("error[e]: m\n --> a.sdl:2:5\n"));
    }
}
