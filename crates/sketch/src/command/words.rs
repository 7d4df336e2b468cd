//! The command preprocessor (routine LSUCMD): a line into commands of words, numbers and texts.

use super::{CommandError, verbs};
use std::ops::Range;

/// Kind of a token.
#[derive(Clone, Debug, PartialEq)]
pub enum CommandTokenKind {
    /// A word: a letter, then letters, digits, `_`, `.`.
    Word,
    /// A number with an optional unit in capitals.
    Number(f64, Option<String>),
    /// A text in quotes.
    Text,
}

/// A word, number or text of a command.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandToken {
    /// Kind.
    pub kind: CommandTokenKind,
    /// As written, without quotes.
    pub text: String,
}

/// The units that may follow a number, in tenths of a millimetre, so that their ratios are exact.
pub const UNITS: [(&str, f64); 5] =
    [("MM", 10.0), ("CM", 100.0), ("M", 10_000.0), ("IN", 254.0), ("FT", 3048.0)];

/// One command with its text.
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// Its tokens; never empty.
    pub tokens: Vec<CommandToken>,
    /// Position of each token in the line, in bytes, with its quotation marks.
    pub spans: Vec<Range<usize>>,
    /// As written.
    pub text: String,
}

/// A line divided into commands.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parsed {
    /// The commands, or the reason why one is invalid.
    pub commands: Vec<Result<Command, CommandError>>,
}

/// A command of a text, with positions in the text.
#[derive(Clone, Debug, PartialEq)]
pub struct TextCommand {
    /// Its verb in full; none for an answer and for a word that is no verb.
    pub verb: Option<&'static str>,
    /// Its tokens with their positions in bytes, quotation marks included.
    pub tokens: Vec<(CommandToken, Range<usize>)>,
    /// True if it is the last one of its line.
    pub last: bool,
}

/// The commands of a text in order, without invalid ones.
pub fn text_commands(text: &str) -> Vec<TextCommand> {
    let mut found = Vec::new();
    let mut joined = String::new();
    // Origin of the parts of a joined line: position in the line and in the text.
    let mut parts = Vec::new();
    let mut start = 0;
    for piece in text.split_inclusive('\n') {
        let line = piece.strip_suffix('\n').unwrap_or(piece);
        let line = line.strip_suffix('\r').unwrap_or(line);
        parts.push((joined.len(), start));
        start += piece.len();
        if let Some(part) = continued(line) {
            joined.push_str(part);
            joined.push(' ');
            continue;
        }
        joined.push_str(line);
        let place = |at: usize| {
            let (before, from) =
                parts.iter().rev().find(|p| p.0 <= at).copied().unwrap_or_default();
            at - before + from
        };
        let commands = parse(&joined, None).commands;
        let count = commands.len();
        for (k, command) in commands.into_iter().enumerate() {
            let Ok(command) = command else { continue };
            let span = |s: &Range<usize>| place(s.start)..place(s.end - 1) + 1;
            let spans: Vec<Range<usize>> = command.spans.iter().map(span).collect();
            found.push(TextCommand {
                verb: verbs::find(&command.tokens[0].text).ok().map(|(verb, _)| verb),
                tokens: command.tokens.into_iter().zip(spans).collect(),
                last: k + 1 == count,
            });
        }
        joined.clear();
        parts.clear();
    }
    found
}

/// If the command continues in the next line (the last character before any comment is `&`), the
/// text without it.
pub fn continued(line: &str) -> Option<&str> {
    let mut quote = None;
    let mut end = line.len();
    for (k, c) in line.char_indices() {
        match (quote, c) {
            (None, '!' | '#') => {
                end = k;
                break;
            }
            (None, '"' | '\'') => quote = Some(c),
            (Some(q), c) if q == c => quote = None,
            _ => {}
        }
    }
    line[..end].trim_end().strip_suffix('&').filter(|_| quote.is_none())
}

/// Divides a line. Delimiters are blank, comma and equals sign; `;` separates commands; `!` and `#`
/// start a comment; quotation marks protect. `longest` cuts words (1983: 32 characters).
pub fn parse(line: &str, longest: Option<usize>) -> Parsed {
    let mut parsed = Parsed::default();
    let (mut tokens, mut spans) = (Vec::new(), Vec::new());
    let mut fault = None;
    let mut start = 0;
    let chars: Vec<(usize, char)> = line.char_indices().collect();
    let mut k = 0;
    let mut finish = |tokens: &mut Vec<CommandToken>,
                      spans: &mut Vec<Range<usize>>,
                      fault: &mut Option<CommandError>,
                      text: &str| {
        let (tokens, spans) = (std::mem::take(tokens), std::mem::take(spans));
        match fault.take() {
            Some(f) => parsed.commands.push(Err(f)),
            None if !tokens.is_empty() => {
                let text = text.trim().to_owned();
                parsed.commands.push(Ok(Command { tokens, spans, text }));
            }
            None => {}
        }
    };
    while k < chars.len() {
        let (at, c) = chars[k];
        match c {
            '!' | '#' => {
                finish(&mut tokens, &mut spans, &mut fault, &line[start..at]);
                return parsed;
            }
            ';' => {
                finish(&mut tokens, &mut spans, &mut fault, &line[start..at]);
                start = at + 1;
                k += 1;
            }
            '"' | '\'' => {
                let close = (k + 1..chars.len()).find(|&j| chars[j].1 == c);
                match close {
                    Some(j) => {
                        let text = line[at + 1..chars[j].0].to_owned();
                        tokens.push(CommandToken { kind: CommandTokenKind::Text, text });
                        spans.push(at..chars[j].0 + 1);
                        k = j + 1;
                    }
                    None => {
                        let text = format!("a quotation mark has no partner: {}", &line[at..]);
                        fault = Some(CommandError::text(text, "add the closing quotation mark"));
                        k = chars.len();
                    }
                }
            }
            ',' | '=' => k += 1,
            c if c.is_whitespace() || c.is_control() => k += 1,
            _ => {
                let ends = |c: char| ",=;!#\"'".contains(c) || c.is_whitespace() || c.is_control();
                let stop = (k..chars.len()).find(|&j| ends(chars[j].1)).unwrap_or(chars.len());
                let end = chars.get(stop).map_or(line.len(), |x| x.0);
                match token(&line[at..end], longest) {
                    Ok(token) => {
                        tokens.push(token);
                        spans.push(at..end);
                    }
                    Err(f) => fault = fault.or(Some(f)),
                }
                k = stop;
            }
        }
    }
    finish(&mut tokens, &mut spans, &mut fault, &line[start..]);
    parsed
}

fn token(text: &str, longest: Option<usize>) -> Result<CommandToken, CommandError> {
    let first = text.chars().next().unwrap_or(' ');
    if ["2D", "3D"].iter().any(|d| text.eq_ignore_ascii_case(d)) || text.eq_ignore_ascii_case("3MF")
    {
        return Ok(CommandToken { kind: CommandTokenKind::Word, text: text.to_owned() });
    }
    if first.is_ascii_digit() || "+-.".contains(first) {
        let (value, unit) = number(text)?;
        return Ok(CommandToken {
            kind: CommandTokenKind::Number(value, unit),
            text: text.to_owned(),
        });
    }
    if !first.is_alphabetic() && first != '_' {
        let next = "put names in letters, digits, `_` and `.`, anything else in quotation marks";
        return Err(CommandError::text(format!("`{text}` starts with `{first}`"), next));
    }
    let odd = text.chars().find(|c| !(c.is_alphanumeric() || *c == '_' || *c == '.'));
    if let Some(c) = odd {
        let what = if c == '-' { "a misplaced hyphen".to_owned() } else { format!("`{c}`") };
        let next = "leave blanks between words, or put the text in quotation marks";
        return Err(CommandError::text(format!("{what} in {text}"), next));
    }
    let text = text.chars().take(longest.unwrap_or(usize::MAX)).collect();
    Ok(CommandToken { kind: CommandTokenKind::Word, text })
}

/// A number with an optional unit; the errors are those of LSUCMD.
pub fn number(text: &str) -> Result<(f64, Option<String>), CommandError> {
    let bytes = text.as_bytes();
    let sign = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let mut end = sign;
    let mut points = 0;
    while bytes.get(end).is_some_and(|b| b.is_ascii_digit() || *b == b'.') {
        points += usize::from(bytes[end] == b'.');
        end += 1;
    }
    if points > 1 {
        let many = if points == 2 { "two".to_owned() } else { points.to_string() };
        return Err(CommandError::text(format!("{many} decimal points in {text}"), "leave one"));
    }
    let mantissa = end;
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let mut at = end + 1;
        at += usize::from(matches!(bytes.get(at), Some(b'+' | b'-')));
        let digits = at;
        while bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        if at > digits {
            end = at;
        }
    }
    let rest = &text[end..];
    let value = text[..end].parse::<f64>();
    if rest.is_empty()
        && let Ok(value) = value
        && value.is_finite()
    {
        return Ok((value, None));
    }
    let unit = rest.to_ascii_uppercase();
    if let Ok(value) = value
        && value.is_finite()
        && (unit == "DEG" || UNITS.iter().any(|u| u.0 == unit))
    {
        return Ok((value, Some(unit)));
    }
    let next = "write numbers like 12, -3.5, 1e-3 or 6.5ft";
    if rest.contains('-') || text[sign..].starts_with(['+', '-']) || mantissa == sign {
        return Err(CommandError::text(format!("a misplaced hyphen in {text}"), next));
    }
    match rest.chars().next() {
        Some(c) if c.is_alphabetic() => {
            Err(CommandError::text(format!("the letter {c} inside the number {text}"), next))
        }
        Some(c) => Err(CommandError::text(format!("`{c}` inside the number {text}"), next)),
        None => Err(CommandError::text(format!("the number {text} is too large"), next)),
    }
}

/// Feet and inches as engineers write them: `3'-6`, `3'6.5"`, `3'`. In feet.
pub fn feet_and_inches(text: &str) -> Option<f64> {
    let (feet, inches) = text.trim().split_once('\'')?;
    let feet: f64 = feet.trim().parse().ok()?;
    let inches = inches.trim().trim_start_matches('-').trim_end_matches('"').trim();
    let inches: f64 = if inches.is_empty() { 0.0 } else { inches.parse().ok()? };
    let sign = if feet.is_sign_negative() { -1.0 } else { 1.0 };
    (feet.is_finite() && (0.0..12.0).contains(&inches)).then_some(feet + sign * inches / 12.0)
}
