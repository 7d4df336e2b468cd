//! Functions of texts: parts, search, replacement, conversion to numbers. Characters are counted
//! from 1.

use crate::value::TextArg;
use moldloft_num::Real;
use moldloft_registry::{Build, CallError, Context, FieldId, Kind, Scalar, Value};
use std::sync::Arc;

/// The longest text that replacing makes, in bytes.
const MAX_TEXT_BYTES: usize = 64 << 20;

/// The characters `first` to `last` of a text, both included; without `last` to its end.
#[derive(Kind)]
#[kind(
    class = Text,
    function,
    cheap,
    name = "cut",
    example = "assert cut(\"wing.dat\", 1, 4) == \"wing\" and cut(\"wing.dat\", 6) == \"dat\";"
)]
pub struct CutText<T: Scalar> {
    /// The text.
    text: TextArg<T>,
    /// The number of the first character, from 1.
    #[field(min = 1)]
    first: usize,
    /// The number of the last character.
    last: Option<usize>,
}

impl<T: Scalar> Build<T> for CutText<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let count = self.text.text.chars().count();
        let last = self.last.unwrap_or(count);
        let outside = |n: usize, field: FieldId| {
            CallError::new("outside", format!("the text has no character {n}"))
                .expected(format!("a whole number from 1 to {count}"))
                .found(n.to_string())
                .in_field(field)
        };
        // Nothing is cut from behind the last character, and from one before its own first.
        if self.first > count + 1 {
            return Err(outside(self.first, Self::FIRST));
        }
        if last > count {
            return Err(outside(last, Self::LAST));
        }
        let taken = (last + 1).saturating_sub(self.first);
        let text: String = self.text.text.chars().skip(self.first - 1).take(taken).collect();
        Ok(Value::text(&text))
    }
}

/// The number that a text spells, blanks around it left out.
#[derive(Kind)]
#[kind(
    class = Number,
    function,
    cheap,
    name = "number",
    example = "assert number(\" -2.5e3 \") == -2500;"
)]
pub struct NumberOf<T: Scalar> {
    /// The text.
    text: TextArg<T>,
}

impl<T: Scalar> Build<T> for NumberOf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        // FORTRAN writes exponents with d as well.
        let spelled = self.text.text.trim().replace(['d', 'D'], "e");
        let digits = |c: char| c.is_ascii_digit() || "+-.eE".contains(c);
        let number = spelled.parse::<f64>().ok().filter(|x| x.is_finite());
        match number.filter(|_| spelled.chars().all(digits)) {
            Some(x) => Ok(Value::Number(T::from(x))),
            None => Err(CallError::new("not-a-number", "the text is not a number")
                .expected("a finite number such as \"-2.5e3\"")
                .found(format!("\"{}\"", self.text.text))
                .in_field(Self::TEXT)),
        }
    }
}

/// The text with every occurrence of a part replaced.
#[derive(Kind)]
#[kind(
    class = Text,
    function,
    cheap,
    name = "replace",
    example = "assert replace(\"a-b-c\", \"-\", \"+\") == \"a+b+c\";"
)]
pub struct Replace<T: Scalar> {
    /// The text.
    text: TextArg<T>,
    /// Part to replace, at least one character.
    part: Arc<str>,
    /// Replacement.
    by: Arc<str>,
}

impl<T: Scalar> Build<T> for Replace<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        if self.part.is_empty() {
            return Err(nothing(Self::PART));
        }
        let count = self.text.text.matches(&*self.part).count();
        let bytes = self.text.text.len() + count * self.by.len();
        if bytes > MAX_TEXT_BYTES {
            return Err(CallError::new("too-many-elements", "the text is too long")
                .expected(format!("at most {MAX_TEXT_BYTES} bytes"))
                .found(bytes.to_string())
                .in_field(Self::BY));
        }
        Ok(Value::text(&self.text.text.replace(&*self.part, &self.by)))
    }
}

fn nothing(field: FieldId) -> CallError {
    CallError::new("empty", "an empty text is in every text")
        .expected("at least one character")
        .in_field(field)
}

/// The parts of a text between separators, as a list of texts; without a separator the words between blanks.
#[derive(Kind)]
#[kind(
    class = List,
    function,
    cheap,
    name = "split",
    example = "string words[] = split(\"a, b\", \",\"); assert len(words) == 2 and trim(words[2]) == \"b\";"
)]
pub struct SplitText<T: Scalar> {
    /// The text.
    text: TextArg<T>,
    /// Separator of the parts.
    separator: Option<Arc<str>>,
}

impl<T: Scalar> Build<T> for SplitText<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(match &self.separator {
            None => Value::list(self.text.text.split_whitespace().map(Value::text)),
            Some(separator) if separator.is_empty() => return Err(nothing(Self::SEPARATOR)),
            Some(separator) => Value::list(self.text.text.split(&**separator).map(Value::text)),
        })
    }
}

/// The text without the blanks at its ends.
#[derive(Kind)]
#[kind(
    class = Text,
    function,
    cheap,
    name = "trim",
    example = "assert trim(\"  wing \") == \"wing\";"
)]
pub struct TrimText<T: Scalar> {
    /// The text.
    text: TextArg<T>,
}

impl<T: Scalar> Build<T> for TrimText<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(Value::text(self.text.text.trim()))
    }
}

/// The text in lower-case letters.
#[derive(Kind)]
#[kind(
    class = Text,
    function,
    cheap,
    name = "lower",
    example = "assert lower(\"NACA 0012\") == \"naca 0012\";"
)]
pub struct Lower<T: Scalar> {
    /// The text.
    text: TextArg<T>,
}

impl<T: Scalar> Build<T> for Lower<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(Value::text(&self.text.text.to_lowercase()))
    }
}

/// The text in upper-case letters.
#[derive(Kind)]
#[kind(
    class = Text,
    function,
    cheap,
    name = "upper",
    example = "assert upper(\"naca\") == \"NACA\";"
)]
pub struct Upper<T: Scalar> {
    /// The text.
    text: TextArg<T>,
}

impl<T: Scalar> Build<T> for Upper<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(Value::text(&self.text.text.to_uppercase()))
    }
}

/// The position, from 1, of the first occurrence of a part in a text, or 0.
pub fn place_in<T: Real>(text: &str, part: &str) -> Value<T> {
    let place = text.find(part).map_or(0, |at| text[..at].chars().count() + 1);
    Value::Number(T::from(place as f64))
}

/// A list with values appended.
#[derive(Kind)]
#[kind(
    class = List,
    function,
    cheap,
    name = "append",
    example = "surface s[2,2], parts[] = {s}; parts = append(parts, s + {1, 0, 0}); assert len(parts) == 2;"
)]
pub struct Append<T: Scalar> {
    /// The list.
    items: Value<T>,
    /// Item to append.
    value: Value<T>,
}

impl<T: Scalar> Build<T> for Append<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Value::List(items) = &self.items else {
            let found = self.items.class().with_article();
            return Err(CallError::new("wrong-class", format!("expected a list, found {found}"))
                .expected("a list, declared as `surface parts[]` or in braces")
                .found(found)
                .help("rows of numbers and points are joined by `join`")
                .in_field(Self::ITEMS));
        };
        Ok(Value::list(items.iter().cloned().chain([self.value])))
    }
}
