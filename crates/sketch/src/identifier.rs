//! Names of objects in expressions.

/// A name in the form of an identifier.
pub fn identifier(name: &str) -> String {
    let fine = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '_' };
    let text: String = name.chars().map(fine).collect();
    if text.starts_with(|c: char| c.is_ascii_alphabetic()) { text } else { format!("o{text}") }
}
