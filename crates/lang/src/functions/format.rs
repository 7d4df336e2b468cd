//! `format("%12.6f", x)`: numbers as text, by the directives of C.

use moldloft_diag::Diagnostic;
use std::fmt::Write as _;
use std::sync::Arc;

/// Argument of a format.
#[derive(Clone, Debug, PartialEq)]
pub enum FormatArgument {
    /// A number.
    Number(f64),
    /// A text.
    Text(Arc<str>),
}

/// The widest field and the most digits.
const WIDEST: usize = 1_000;

/// The text of `items` by the format, which is repeated for the remaining items.
///
/// # Errors
/// For directives that do not exist, or items that do not fit them.
pub fn format(pattern: &str, items: &[FormatArgument]) -> Result<String, Diagnostic> {
    FormatPattern::of(pattern)?.spelled(items)
}

/// A format that was read.
#[derive(Debug)]
pub struct FormatPattern(Vec<FormatPiece>);

impl FormatPattern {
    /// Reads a format.
    ///
    /// # Errors
    /// For directives that do not exist.
    pub fn of(pattern: &str) -> Result<Self, Diagnostic> {
        parse(pattern).map(Self)
    }

    /// The text of `items`; the format is repeated for the remaining items.
    ///
    /// # Errors
    /// For items that do not fit the directives.
    pub fn spelled(&self, items: &[FormatArgument]) -> Result<String, Diagnostic> {
        let mut out = String::new();
        let mut items = items.iter().peekable();
        let takes = self.0.iter().any(|p| matches!(p, FormatPiece::Directive(_)));
        loop {
            for piece in &self.0 {
                match piece {
                    FormatPiece::Text(text) => out.push_str(text),
                    FormatPiece::Directive(d) => match items.next() {
                        Some(item) => d.spell(item, &mut out)?,
                        // The format ends where its values are used up.
                        None if !out.is_empty() => return Ok(out),
                        None => {
                            return Err(Diagnostic::error(
                                "missing-argument",
                                "the format needs a value that is not given",
                            )
                            .expected(format!("a value for %{}", d.letter)));
                        }
                    },
                }
            }
            if items.peek().is_none() {
                return Ok(out);
            }
            if !takes {
                return Err(Diagnostic::error("too-many-arguments", "the format takes no values")
                    .expected("a directive such as %g for each value"));
            }
        }
    }
}

#[derive(Debug)]
enum FormatPiece {
    Text(String),
    Directive(Directive),
}

#[derive(Clone, Copy, Debug)]
struct Directive {
    left: bool,
    plus: bool,
    blank: bool,
    zero: bool,
    width: usize,
    precision: Option<usize>,
    letter: char,
}

fn parse(pattern: &str) -> Result<Vec<FormatPiece>, Diagnostic> {
    let mut pieces = Vec::new();
    let mut text = String::new();
    let mut chars = pattern.chars().peekable();
    while let Some(c) = chars.next() {
        if c != '%' {
            text.push(c);
            continue;
        }
        let mut d = Directive {
            left: false,
            plus: false,
            blank: false,
            zero: false,
            width: 0,
            precision: None,
            letter: '%',
        };
        while let Some(flag) = chars.next_if(|c| "-+ 0#".contains(*c)) {
            match flag {
                '-' => d.left = true,
                '+' => d.plus = true,
                ' ' => d.blank = true,
                '0' => d.zero = true,
                _ => {}
            }
        }
        let number = |chars: &mut std::iter::Peekable<std::str::Chars<'_>>| {
            let mut n = 0usize;
            while let Some(digit) = chars.next_if(char::is_ascii_digit) {
                n = (n * 10 + digit as usize - '0' as usize).min(WIDEST + 1);
            }
            n
        };
        d.width = number(&mut chars);
        if chars.next_if_eq(&'.').is_some() {
            d.precision = Some(number(&mut chars));
        }
        if d.width > WIDEST || d.precision.is_some_and(|p| p > WIDEST) {
            return Err(Diagnostic::error("wrong-format", "a field is too wide")
                .expected(format!("at most {WIDEST} characters")));
        }
        match chars.next() {
            Some('%') => text.push('%'),
            Some(letter @ ('d' | 'i' | 'f' | 'e' | 'g' | 's' | 'E' | 'G')) => {
                d.letter = letter;
                pieces.push(FormatPiece::Text(std::mem::take(&mut text)));
                pieces.push(FormatPiece::Directive(d));
            }
            other => {
                let found = other.map_or("the end of the format".into(), |c| format!("%{c}"));
                return Err(Diagnostic::error("wrong-format", format!("the format has {found}"))
                    .expected("%d, %f, %e, %g, %s or %%")
                    .found(found));
            }
        }
    }
    pieces.push(FormatPiece::Text(text));
    Ok(pieces)
}

impl Directive {
    fn is_plain(self) -> bool {
        !(self.left || self.plus || self.blank || self.zero) && self.width == 0
    }

    fn spell(self, item: &FormatArgument, out: &mut String) -> Result<(), Diagnostic> {
        // The commonest directives at once.
        match (self.letter, item) {
            ('s', FormatArgument::Text(text)) if self.is_plain() && self.precision.is_none() => {
                out.push_str(text);
                return Ok(());
            }
            ('d' | 'i', FormatArgument::Number(x))
                if self.is_plain() && x.fract() == 0.0 && x.abs() <= 9e15 =>
            {
                let _ = write!(out, "{}", *x as i64);
                return Ok(());
            }
            _ => {}
        }
        out.push_str(&self.spelled(item)?);
        Ok(())
    }

    fn spelled(self, item: &FormatArgument) -> Result<String, Diagnostic> {
        let wrong = |expected: &str, found: String| {
            Diagnostic::error("wrong-format", format!("%{} takes {expected}", self.letter))
                .expected(expected.to_string())
                .found(found)
        };
        let digits = self.precision.unwrap_or(6);
        let body = match (self.letter, item) {
            ('s', FormatArgument::Text(text)) => match self.precision {
                Some(p) => text.chars().take(p).collect(),
                None => text.to_string(),
            },
            ('s', FormatArgument::Number(x)) => moldloft_syntax::number::plain(*x),
            (_, FormatArgument::Text(text)) => {
                return Err(wrong("a number", format!("the text \"{text}\"")));
            }
            ('d' | 'i', FormatArgument::Number(x)) => {
                if x.fract() != 0.0 || x.abs() > 9e15 {
                    return Err(wrong("a whole number", x.to_string()));
                }
                format!("{x:.0}")
            }
            ('f', FormatArgument::Number(x)) => format!("{x:.digits$}"),
            ('e' | 'E', FormatArgument::Number(x)) => exponential(*x, digits),
            (_, FormatArgument::Number(x)) => general(*x, digits),
        };
        let body = match (self.letter, item) {
            ('s', _) => body,
            (letter, FormatArgument::Number(x)) => {
                // A zero that rounding made negative is a zero.
                let zero = !body.bytes().any(|b| (b'1'..=b'9').contains(&b)) && x.is_finite();
                let body = if zero { body.trim_start_matches('-').to_string() } else { body };
                let sign = match (body.starts_with('-'), self.plus, self.blank) {
                    (true, ..) => "",
                    (_, true, _) => "+",
                    (_, _, true) => " ",
                    _ => "",
                };
                let body = format!("{sign}{body}");
                if letter.is_ascii_uppercase() { body.to_uppercase() } else { body }
            }
            _ => body,
        };
        let missing = self.width.saturating_sub(body.chars().count());
        let fill = " ".repeat(missing);
        Ok(if self.left {
            body + &fill
        } else if self.zero && self.letter != 's' {
            let (sign, rest) = match body.strip_prefix(['-', '+', ' ']) {
                Some(rest) => (&body[..1], rest),
                None => ("", &body[..]),
            };
            format!("{sign}{}{rest}", "0".repeat(missing))
        } else {
            fill + &body
        })
    }
}

/// As C writes it: at least two digits of the exponent.
fn exponential(x: f64, digits: usize) -> String {
    let text = format!("{x:.digits$e}");
    match text.split_once('e') {
        Some((mantissa, exponent)) => {
            let (sign, number) = match exponent.strip_prefix('-') {
                Some(number) => ('-', number),
                None => ('+', exponent),
            };
            format!("{mantissa}e{sign}{number:0>2}")
        }
        None => text,
    }
}

/// `%g`: the shorter form, trailing zeros left out.
fn general(x: f64, digits: usize) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{}", x + 0.0);
    }
    let digits = digits.max(1);
    let rounded = format!("{:.*e}", digits - 1, x);
    let exponent: i32 = rounded.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    let text = if exponent < -4 || exponent >= digits as i32 {
        exponential(x, digits - 1)
    } else {
        format!("{x:.*}", (digits as i32 - 1 - exponent).max(0) as usize)
    };
    let (mantissa, rest) = match text.split_once('e') {
        Some((mantissa, rest)) => (mantissa.to_string(), format!("e{rest}")),
        None => (text, String::new()),
    };
    let mantissa = match mantissa.contains('.') {
        true => mantissa.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => mantissa,
    };
    mantissa + &rest
}
