//! The version of the language that a text states in its first line: `# moldloft 1`. Without that line it is 1.

use moldloft_diag::{Diagnostic, FileId, Span};

/// The newest version that is read.
pub const LANGUAGE: u32 = 1;

/// The version that a text states, and the length of its first line.
fn stated(text: &str) -> Option<(u32, usize)> {
    let line = text.lines().next()?;
    let words = line.trim_start_matches('\u{feff}').trim_start().strip_prefix('#')?.trim();
    let number = words.strip_prefix("moldloft")?;
    if !number.starts_with([' ', '\t']) {
        return None;
    }
    let digits = number.trim();
    let whole =
        !digits.is_empty() && digits.len() <= 9 && digits.bytes().all(|b| b.is_ascii_digit());
    whole.then(|| Some((digits.parse().ok()?, line.len())))?
}

/// The error of a text of a newer version.
pub fn refused(text: &str, file: FileId) -> Option<Diagnostic> {
    let (version, length) = stated(text).filter(|(version, _)| *version > LANGUAGE)?;
    let message = format!(
        "the text is written in version {version} of the language; moldloft {} reads version {LANGUAGE}",
        env!("CARGO_PKG_VERSION")
    );
    let span = Span::new(file, 0, length as u32);
    Some(Diagnostic::error("newer-language", message).at(span).help("install a newer moldloft"))
}

#[cfg(test)]
mod tests {
    use super::stated;

    #[test]
    fn only_a_comment_of_that_form_states_a_version() {
        assert_eq!(stated("# moldloft 2\nAbsPoint P(0, 0, 0);"), Some((2, 12)));
        assert_eq!(stated("\u{feff} #moldloft\t12 "), Some((12, 17)));
        for text in
            ["", "# moldloft", "# moldloft two", "# moldlofts 2", "# a\n# moldloft 2", "x = 1;"]
        {
            assert_eq!(stated(text), None, "{text:?}");
        }
    }
}
