//! Bytes into text.

use moldloft_diag::{Diagnostic, FileId, Span};
use std::borrow::Cow;

/// Maximum length of a text: spans are 32 bits wide, and a model of this size is a mistake.
pub const MAX_BYTES: usize = 64 << 20;

/// The bytes as text. In a file whose lines end with carriage returns only, these become line
/// feeds, so that positions do not change.
///
/// # Errors
/// `binary-file` for NUL bytes or invalid UTF-8, with the position of the first one; `file-too-large` beyond
/// [`MAX_BYTES`]. The file shown is `name`; the diagnostic has no span, because there is no text to point into.
pub fn decode<'a>(bytes: &'a [u8], name: &str) -> Result<Cow<'a, str>, Diagnostic> {
    if bytes.len() > MAX_BYTES {
        return Err(too_large(bytes.len()));
    }
    let binary = |at: usize, what: String| {
        let line = bytes[..at].iter().filter(|byte| **byte == b'\n').count() + 1;
        Diagnostic::error("binary-file", format!("`{name}` is not a text file"))
            .expected("text in UTF-8")
            .found(format!("{what} at byte {at} (line {line})"))
    };
    if let Some(at) = bytes.iter().position(|byte| *byte == 0) {
        return Err(binary(at, "a NUL byte".to_owned()));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let at = error.valid_up_to();
        binary(at, format!("the byte 0x{:02x}", bytes[at]))
            .help("if it is text in an older encoding, convert it to UTF-8 first")
    })?;
    if text.contains('\r') && !text.contains('\n') {
        return Ok(text.replace('\r', "\n").into());
    }
    Ok(text.into())
}

/// The diagnostic for a text that is too long.
pub(crate) fn too_large(bytes: usize) -> Diagnostic {
    Diagnostic::error("file-too-large", "this file is too large to be a model")
        .expected(format!("at most {} MiB", MAX_BYTES >> 20))
        .found(format!("{} MiB", bytes >> 20))
}

/// [`too_large`] for a text, `None` if it is not too long.
pub(crate) fn check_size(text: &str, file: FileId) -> Option<Diagnostic> {
    (text.len() > MAX_BYTES).then(|| too_large(text.len()).at(Span::point(file, 0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn binary_is_told_apart() {
        assert_eq!(decode(b"abc\xc3\xa9", "a").unwrap(), "abcé");
        assert_eq!(decode(b"# a\rb\r", "a").unwrap(), "# a\nb\n");
        assert_eq!(decode(b"a\r\nb\r", "a").unwrap(), "a\r\nb\r");
        let nul = decode(b"ab\nc\0", "a.bin").unwrap_err();
        assert_eq!(nul.id, "binary-file");
        assert_eq!(nul.found.as_deref(), Some("a NUL byte at byte 4 (line 2)"));
        let latin = decode(b"Rem 30\xb0", "old.ms2").unwrap_err();
        assert_eq!(latin.found.as_deref(), Some("the byte 0xb0 at byte 6 (line 1)"));
    }
}
