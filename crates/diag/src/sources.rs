//! The table of source texts, and positions of bytes in them.

use crate::{FileId, Span};
use std::sync::{Arc, OnceLock};

/// A line and a column, both counted from 1; columns count characters (a tab is one).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Location {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

#[derive(Clone, Debug)]
struct Source {
    name: String,
    text: Arc<str>,
    /// Byte offset of each line's first byte, computed on first use.
    line_starts: OnceLock<Vec<u32>>,
}

impl Source {
    fn line_starts(&self) -> &[u32] {
        self.line_starts.get_or_init(|| {
            let newlines = self.text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
            std::iter::once(0).chain(newlines.map(|(at, _)| at as u32 + 1)).collect()
        })
    }
}

/// The texts that diagnostics point into. Lines end with LF or CR LF.
///
/// Cloning shares the texts.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    files: Vec<Source>,
}

impl Sources {
    /// An empty table.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a text under the name that is shown for it.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<Arc<str>>) -> FileId {
        let id = FileId(self.files.len() as u32);
        self.files.push(Source {
            name: name.into(),
            text: text.into(),
            line_starts: OnceLock::new(),
        });
        id
    }

    /// Replaces the text of a file after an edit. Does nothing for an unknown file.
    pub fn replace(&mut self, file: FileId, text: impl Into<Arc<str>>) {
        if let Some(source) = self.files.get_mut(file.0 as usize) {
            source.text = text.into();
            source.line_starts = OnceLock::new();
        }
    }

    /// Number of texts.
    pub fn len(&self) -> usize {
        self.files.len()
    }

    /// True without texts.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// The files in the order in which they were added.
    pub fn ids(&self) -> impl Iterator<Item = FileId> + use<> {
        (0..self.files.len() as u32).map(FileId)
    }

    /// The shown name of a file.
    pub fn name(&self, file: FileId) -> Option<&str> {
        self.files.get(file.0 as usize).map(|source| source.name.as_str())
    }

    /// The text of a file.
    pub fn text(&self, file: FileId) -> Option<&Arc<str>> {
        self.files.get(file.0 as usize).map(|source| &source.text)
    }

    /// The file of this name, the latest if there are several.
    pub fn find(&self, name: &str) -> Option<FileId> {
        self.files.iter().rposition(|source| source.name == name).map(|at| FileId(at as u32))
    }

    /// The text of a span; empty if the span is outside.
    pub fn slice(&self, span: Span) -> &str {
        self.text(span.file).and_then(|text| text.get(span.range())).unwrap_or("")
    }

    /// Line and column of a byte. Offsets past the end count as the end; `None` for an unknown file.
    pub fn locate(&self, file: FileId, offset: u32) -> Option<Location> {
        let source = self.files.get(file.0 as usize)?;
        let offset = floor_char_boundary(&source.text, offset as usize);
        let starts = source.line_starts();
        let line = starts.partition_point(|start| *start as usize <= offset).max(1);
        let start = starts[line - 1] as usize;
        let column = source.text[start..offset].chars().count() as u32 + 1;
        Some(Location { line: line as u32, column })
    }

    /// The byte offset of a location; past the end of a line it is the line's end.
    pub fn offset(&self, file: FileId, at: Location) -> Option<u32> {
        let start =
            *self.files.get(file.0 as usize)?.line_starts().get(at.line.checked_sub(1)? as usize)?;
        let line = self.line(file, at.line)?;
        let within = line
            .char_indices()
            .nth(at.column.saturating_sub(1) as usize)
            .map_or(line.len(), |(byte, _)| byte);
        Some(start + within as u32)
    }

    /// The text of a line (from 1) without its end.
    pub fn line(&self, file: FileId, line: u32) -> Option<&str> {
        let source = self.files.get(file.0 as usize)?;
        let starts = source.line_starts();
        let index = line.checked_sub(1)? as usize;
        let start = *starts.get(index)? as usize;
        let end = starts.get(index + 1).map_or(source.text.len(), |next| *next as usize);
        let text = &source.text[start..end];
        let text = text.strip_suffix('\n').unwrap_or(text);
        Some(text.strip_suffix('\r').unwrap_or(text))
    }
}

/// The largest character boundary of `text` that is not after `at`.
fn floor_char_boundary(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns() {
        let mut sources = Sources::new();
        let file = sources.add("a.sdl", "ab\r\n\tçd\nend");
        let at = |offset| sources.locate(file, offset).map(|l| (l.line, l.column)).unwrap();
        assert_eq!(at(0), (1, 1));
        assert_eq!(at(4), (2, 1));
        assert_eq!(at(5), (2, 2));
        assert_eq!(at(6), (2, 2), "inside a character counts as its start");
        assert_eq!(at(7), (2, 3));
        assert_eq!(at(9), (3, 1));
        assert_eq!(at(999), (3, 4));
        assert_eq!(sources.line(file, 1), Some("ab"));
        assert_eq!(sources.line(file, 2), Some("\tçd"));
        assert_eq!(sources.line(file, 3), Some("end"));
        assert_eq!(sources.line(file, 4), None);
        assert_eq!(sources.offset(file, Location { line: 2, column: 3 }), Some(7));
        assert_eq!(sources.offset(file, Location { line: 2, column: 99 }), Some(8));
    }

    #[test]
    fn replaced_text_has_new_lines() {
        let mut sources = Sources::new();
        let file = sources.add("a", "x\ny");
        assert_eq!(sources.locate(file, 2), Some(Location { line: 2, column: 1 }));
        sources.replace(file, "xxy");
        assert_eq!(sources.locate(file, 2), Some(Location { line: 1, column: 3 }));
        assert_eq!(sources.find("a"), Some(file));
        assert_eq!(sources.locate(FileId::UNKNOWN, 0), None);
    }
}
