//! Places: bytes of a text, and the protocol's lines and UTF-16 units, both from 0.

use moldloft::diag::Span;
use serde_json::{Value, json};

/// The byte of a position; past the end of a line is its end, past the last line the text's end.
pub fn offset(text: &str, position: &Value) -> u32 {
    let line = position["line"].as_u64().unwrap_or(0) as usize;
    let units = position["character"].as_u64().unwrap_or(0) as usize;
    let mut start = 0;
    for _ in 0..line {
        match text[start..].find('\n') {
            Some(end) => start += end + 1,
            None => return text.len() as u32,
        }
    }
    let rest = &text[start..];
    let rest = &rest[..rest.find('\n').unwrap_or(rest.len())];
    let rest = rest.strip_suffix('\r').unwrap_or(rest);
    let mut seen = 0;
    for (at, c) in rest.char_indices() {
        if seen >= units {
            return (start + at) as u32;
        }
        seen += c.len_utf16();
    }
    (start + rest.len()) as u32
}

/// The position of a byte.
pub fn position(text: &str, offset: u32) -> Value {
    let mut offset = (offset as usize).min(text.len());
    while !text.is_char_boundary(offset) {
        offset -= 1;
    }
    let before = &text[..offset];
    let line = before.matches('\n').count();
    let start = before.rfind('\n').map_or(0, |k| k + 1);
    let character: usize = before[start..].chars().map(char::len_utf16).sum();
    json!({"line": line, "character": character})
}

/// The range of a span.
pub fn range(text: &str, span: Span) -> Value {
    json!({"start": position(text, span.start), "end": position(text, span.end)})
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_go_both_ways() {
        let text = "aé𝄞b\r\nc";
        for (at, line, character) in
            [(0, 0, 0), (1, 0, 1), (3, 0, 2), (7, 0, 4), (10, 1, 0), (11, 1, 1)]
        {
            let place = json!({"line": line, "character": character});
            assert_eq!(position(text, at), place, "{at}");
            assert_eq!(offset(text, &place), at, "{at}");
        }
        assert_eq!(offset(text, &json!({"line": 0, "character": 99})), 8);
        assert_eq!(offset(text, &json!({"line": 9, "character": 0})), 11);
    }
}
