//! Positions: bytes of a text, and the protocol's lines and UTF-16 units, both from 0.

use lsp_types::{Position, Range};

/// Starts of the lines of a text.
#[derive(Debug)]
pub struct LineIndex<'t> {
    text: &'t str,
    starts: Vec<u32>,
}

impl<'t> LineIndex<'t> {
    /// The lines of a text.
    pub fn new(text: &'t str) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, b)| *b == b'\n');
        let starts = std::iter::once(0).chain(ends.map(|(at, _)| at as u32 + 1)).collect();
        Self { text, starts }
    }

    /// The byte of a position; past the end of a line is its end, past the last line the text's end.
    pub fn offset(&self, position: Position) -> u32 {
        let line = position.line as usize;
        let Some(&start) = self.starts.get(line) else { return self.text.len() as u32 };
        let end = self.starts.get(line + 1).map_or(self.text.len(), |&next| next as usize - 1);
        let rest = &self.text[start as usize..end];
        let rest = rest.strip_suffix('\r').unwrap_or(rest);
        let mut seen = 0;
        for (at, c) in rest.char_indices() {
            if seen >= position.character as usize {
                return start + at as u32;
            }
            seen += c.len_utf16();
        }
        start + rest.len() as u32
    }

    /// The position of a byte.
    pub fn position(&self, offset: u32) -> Position {
        let mut offset = (offset as usize).min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        let line = self.starts.partition_point(|&start| start as usize <= offset) - 1;
        let before = &self.text[self.starts[line] as usize..offset];
        let character: usize = before.chars().map(char::len_utf16).sum();
        Position { line: line as u32, character: character as u32 }
    }

    /// The range between two bytes.
    pub fn range(&self, start: u32, end: u32) -> Range {
        Range { start: self.position(start), end: self.position(end) }
    }
}

/// A text after changes of the protocol: each replaces a range, or everything.
pub fn apply(text: &mut String, changes: &[lsp_types::TextDocumentContentChangeEvent]) {
    for change in changes {
        match change.range {
            Some(range) => {
                let lines = LineIndex::new(text);
                let start = lines.offset(range.start) as usize;
                let end = (lines.offset(range.end) as usize).max(start);
                text.replace_range(start..end, &change.text);
            }
            None => text.clone_from(&change.text),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_go_both_ways() {
        let text = "aé𝄞b\r\nc";
        let lines = LineIndex::new(text);
        for (at, line, character) in
            [(0, 0, 0), (1, 0, 1), (3, 0, 2), (7, 0, 4), (10, 1, 0), (11, 1, 1)]
        {
            let place = Position { line, character };
            assert_eq!(lines.position(at), place, "{at}");
            assert_eq!(lines.offset(place), at, "{at}");
        }
        // Beyond the ends; inside of a letter.
        assert_eq!(lines.offset(Position { line: 0, character: 99 }), 8);
        assert_eq!(lines.offset(Position { line: 9, character: 0 }), 11);
        assert_eq!(lines.position(5), Position { line: 0, character: 2 });
        assert_eq!(LineIndex::new("").position(7), Position { line: 0, character: 0 });
    }
}
