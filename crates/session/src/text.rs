//! Positions in UTF-16 units and change sets, as editors send them.

use serde_json::Value;

/// Byte offset of a UTF-16 offset; clamped to the end.
pub fn byte(text: &str, unit: usize) -> usize {
    if unit >= text.len() && text.is_ascii() {
        return text.len();
    }
    let mut seen = 0;
    for (at, c) in text.char_indices() {
        if seen >= unit {
            return at;
        }
        seen += c.len_utf16();
    }
    text.len()
}

/// UTF-16 offset of a byte offset.
pub fn unit(text: &str, byte: usize) -> usize {
    let mut byte = byte.min(text.len());
    while !text.is_char_boundary(byte) {
        byte -= 1;
    }
    text[..byte].chars().map(char::len_utf16).sum()
}

/// The text after a change set: a list of retained lengths and of `[removed, line, line ...]`.
///
/// # Errors
/// If the change set is malformed, or is for a text of another length.
pub fn changed(text: &str, changes: &Value) -> Result<String, String> {
    let steps = changes.as_array().ok_or("a change set is a list")?;
    let mut made = String::with_capacity(text.len() + 64);
    let mut rest = text;
    let mut take = |units: usize| -> Result<&str, String> {
        let at = byte(rest, units);
        let (taken, after) = rest.split_at(at);
        if taken.chars().map(char::len_utf16).sum::<usize>() != units {
            return Err("the change set is of another text".into());
        }
        rest = after;
        Ok(taken)
    };
    let number = |v: &Value| v.as_u64().map(|n| n as usize).ok_or("expected a length".to_string());
    for step in steps {
        match step {
            Value::Array(replace) => {
                let removed = replace.first().ok_or("an empty replacement")?;
                take(number(removed)?)?;
                for (k, line) in replace[1..].iter().enumerate() {
                    if k > 0 {
                        made.push('\n');
                    }
                    made.push_str(line.as_str().ok_or("expected a line of text")?);
                }
            }
            kept => made.push_str(take(number(kept)?)?),
        }
    }
    if !rest.is_empty() {
        return Err("the change set is of another text".into());
    }
    Ok(made)
}

/// The single replacement that turns `old` into `new`: start and end offset in `old`, and the
/// inserted text.
pub fn difference(old: &str, new: &str) -> Option<(usize, usize, String)> {
    if old == new {
        return None;
    }
    let start = old.bytes().zip(new.bytes()).take_while(|(a, b)| a == b).count();
    let start = (0..=start).rev().find(|&k| old.is_char_boundary(k) && new.is_char_boundary(k));
    let start = start.unwrap_or(0);
    let most = old.len().min(new.len()) - start;
    let same = |k: &usize| old.as_bytes()[old.len() - 1 - k] == new.as_bytes()[new.len() - 1 - k];
    let end = (0..most).take_while(same).count();
    let whole =
        |k: &usize| old.is_char_boundary(old.len() - k) && new.is_char_boundary(new.len() - k);
    let end = (0..=end).rev().find(whole).unwrap_or(0);
    let insert = new[start..new.len() - end].to_string();
    Some((unit(old, start), unit(old, old.len() - end), insert))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn places_count_utf16_units() {
        let text = "aé𝄞b";
        for (at, units) in [(0, 0), (1, 1), (3, 2), (7, 4), (8, 5)] {
            assert_eq!(unit(text, at), units);
            assert_eq!(byte(text, units), at);
        }
        assert_eq!(byte(text, 99), 8);
    }

    #[test]
    fn change_sets_apply_to_texts_of_their_length_only() {
        let text = "one 𝄞\ntwo";
        assert_eq!(changed(text, &json!([4, [2, "x", "y"], 4])).unwrap(), "one x\ny\ntwo");
        assert_eq!(changed(text, &json!([10])).unwrap(), text);
        for wrong in [json!([3]), json!([11]), json!([5, [1, ""], 4]), json!({}), json!([[]])] {
            assert!(changed(text, &wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_difference_is_the_least() {
        assert_eq!(difference("ab1.25c", "ab1.5c"), Some((4, 5, "".into())));
        assert_eq!(difference("x", "x"), None);
        assert_eq!(difference("é", "è"), Some((0, 1, "è".into())));
        assert_eq!(difference("aa", "aaa"), Some((2, 2, "a".into())));
    }
}
