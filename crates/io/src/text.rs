//! Numbers and names in text formats.

use crate::{FilePosition, ReadError};
use std::fmt::Write;

/// The shortest decimal that reads back as the same double; -0 is written as 0.
pub(crate) fn real(x: f64) -> String {
    let x = x + 0.0;
    let size = x.abs();
    if size != 0.0 && !(1e-5..1e16).contains(&size) { format!("{x:e}") } else { format!("{x}") }
}

/// The shortest decimal that reads back as the same double, with a point or an exponent of two
/// digits and a sign, as C and Python write it; -0 as 0.
pub(crate) fn pointed(x: f64) -> String {
    let text = format!("{:?}", x + 0.0);
    match text.split_once('e') {
        None => text,
        Some((digits, exponent)) => {
            let (sign, size) = match exponent.strip_prefix('-') {
                Some(size) => ('-', size),
                None => ('+', exponent),
            };
            format!("{}e{sign}{size:0>2}", digits.strip_suffix(".0").unwrap_or(digits))
        }
    }
}

/// A name without blanks and control characters, never empty.
pub(crate) fn word(name: &str) -> String {
    let word: String =
        name.chars().map(|c| if c.is_whitespace() || c.is_control() { '_' } else { c }).collect();
    if word.is_empty() { "unnamed".into() } else { word }
}

/// Text with the characters that XML reserves replaced, and those it forbids left out.
pub(crate) fn xml(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out
}

/// Text as a JSON string, quotes included (RFC 8259, section 7).
pub(crate) fn json(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => append(&mut out, format_args!("\\u{:04x}", c as u32)),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// Appends formatted text; writing to a `String` cannot fail.
macro_rules! put {
    ($out:expr, $($arg:tt)*) => { $crate::text::append(&mut $out, format_args!($($arg)*)) };
}
pub(crate) use put;

pub(crate) fn append(out: &mut String, text: std::fmt::Arguments<'_>) {
    // `String`'s writer returns no error.
    let _ = out.write_fmt(text);
}

/// One line of a number file, split at blanks and commas.
pub(crate) struct TextLine<'a> {
    pub format: &'static str,
    pub number: usize,
    pub text: &'a str,
}

impl<'a> TextLine<'a> {
    pub fn words(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        self.text.split(|c: char| c.is_whitespace() || c == ',').filter(|w| !w.is_empty())
    }

    pub fn error(&self, expected: impl Into<String>, found: impl Into<String>) -> ReadError {
        let (expected, found) = (expected.into(), found.into());
        ReadError { format: self.format, place: FilePosition::Line(self.number), expected, found }
    }

    /// A finite real; Fortran's `D` exponents are understood.
    pub fn real(&self, word: Option<&str>, what: &str) -> Result<f64, ReadError> {
        let Some(word) = word else { return Err(self.error(what, "the end of the line")) };
        let value = word.parse().or_else(|_| word.replace(['d', 'D'], "e").parse());
        match value {
            Ok(x) if f64::is_finite(x) => Ok(x),
            _ => Err(self.error(what, quoted(word))),
        }
    }

    pub fn integer(&self, word: Option<&str>, what: &str) -> Result<i64, ReadError> {
        let Some(word) = word else { return Err(self.error(what, "the end of the line")) };
        word.parse().map_err(|_| self.error(what, quoted(word)))
    }
}

/// A word of the input between quotes, shortened, with pictures for control characters.
pub(crate) fn quoted(word: &str) -> String {
    let picture = |c: char| match c as u32 {
        code @ 0..0x20 => char::from_u32(0x2400 + code).unwrap_or('\u{fffd}'),
        0x7f..0xa0 => '\u{fffd}',
        _ => c,
    };
    let mut short: String = word.chars().take(24).map(picture).collect();
    if word.chars().nth(24).is_some() {
        short.push('…');
    }
    format!("`{short}`")
}

/// The lines of a text that ends them by LF, CR LF or CR.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = &str> {
    let text = text.trim_start_matches('\u{feff}');
    text.split('\n').flat_map(|line| line.strip_suffix('\r').unwrap_or(line).split('\r'))
}

/// The bytes as text: UTF-8, else Latin-1, which old files are in and where every byte is a letter.
pub(crate) fn text_of(bytes: &[u8]) -> std::borrow::Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(_) => bytes.iter().map(|&b| char::from(b)).collect::<String>().into(),
    }
}

/// [`text_of`] a file of lines; UTF-16, which would be read as garbage, is refused.
pub(crate) fn lines_text<'a>(
    bytes: &'a [u8],
    format: &'static str,
) -> Result<std::borrow::Cow<'a, str>, ReadError> {
    if bytes.starts_with(b"\xfe\xff") || bytes.starts_with(b"\xff\xfe") {
        let (expected, found) = ("text in UTF-8 or Latin-1".into(), "UTF-16".into());
        return Err(ReadError { format, place: FilePosition::Byte(0), expected, found });
    }
    Ok(text_of(bytes))
}

pub(crate) fn utf8<'a>(bytes: &'a [u8], format: &'static str) -> Result<&'a str, ReadError> {
    std::str::from_utf8(bytes).map_err(|e| ReadError {
        format,
        place: FilePosition::Byte(e.valid_up_to()),
        expected: "text".into(),
        found: "bytes that are not UTF-8".into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back() {
        for x in [0.1, 1.0 / 3.0, 1e-300, -2.5e17, 1e16, 123456.789, f64::MIN_POSITIVE, 0.0] {
            assert_eq!(real(x).parse::<f64>().unwrap().to_bits(), x.to_bits());
            assert!(real(x).len() < 25);
        }
        assert_eq!(real(-0.0), "0");
    }

    #[test]
    fn names_are_made_safe() {
        assert_eq!((word("fore body").as_str(), word("").as_str()), ("fore_body", "unnamed"));
        assert_eq!(xml("a<\"b\">&\u{1}"), "a&lt;&quot;b&quot;&gt;&amp;");
    }
}
