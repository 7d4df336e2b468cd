//! The arguments of a command, taken one after another.

use super::CommandError;
use super::words::{CommandToken, CommandTokenKind, UNITS, feet_and_inches};
use crate::{CoordinateAxis, DimensionExpr, LineId, PointId};

/// Labels up to this are accepted.
pub const MAX_LABEL: u32 = 1_000_000;

/// A cursor over tokens.
pub struct Args<'a> {
    tokens: &'a [CommandToken],
    usage: &'a str,
}

impl<'a> Args<'a> {
    /// The tokens after the verb, and how the verb is used.
    pub fn new(tokens: &'a [CommandToken], usage: &'a str) -> Args<'a> {
        Args { tokens, usage }
    }

    /// The next token.
    pub fn peek(&self) -> Option<&'a CommandToken> {
        self.tokens.first()
    }

    /// The token after the next.
    pub fn second(&self) -> Option<&'a CommandToken> {
        self.tokens.get(1)
    }

    /// Number of remaining tokens.
    pub fn len(&self) -> usize {
        self.tokens.len()
    }

    /// Passes the next token.
    pub fn skip(&mut self) {
        self.tokens = self.tokens.get(1..).unwrap_or_default();
    }

    /// A fault that shows how the verb is used.
    pub fn wants(&self, what: &str) -> CommandError {
        let found = self.peek().map_or("the end".to_owned(), |t| format!("`{}`", t.text));
        CommandError::text(
            format!("expected {what}, found {found}"),
            format!("use: {}", self.usage),
        )
    }

    /// True if the next token is this keyword: in full, or at least three letters of it.
    pub fn at(&self, keyword: &str) -> bool {
        self.peek().is_some_and(|t| {
            let word = t.text.to_ascii_uppercase();
            t.kind == CommandTokenKind::Word
                && (word == keyword || (word.len() >= 3 && keyword.starts_with(&word)))
        })
    }

    /// Passes the keyword if it is next.
    pub fn take(&mut self, keyword: &str) -> bool {
        let found = self.at(keyword);
        if found {
            self.skip();
        }
        found
    }

    /// Passes a short keyword such as TO or AS, in full.
    pub fn take_short(&mut self, keyword: &str) -> bool {
        let found = self.peek().is_some_and(|t| {
            t.kind == CommandTokenKind::Word && t.text.eq_ignore_ascii_case(keyword)
        });
        if found {
            self.skip();
        }
        found
    }

    /// True if the token after `k` others is this keyword.
    pub fn tokens_at(&self, k: usize, keyword: &str) -> bool {
        self.tokens.get(k).is_some_and(|t| t.text.eq_ignore_ascii_case(keyword))
    }

    /// True if the token after `k` others is a number.
    pub fn number_at(&self, k: usize) -> bool {
        matches!(self.tokens.get(k).map(|t| &t.kind), Some(CommandTokenKind::Number(..)))
    }

    /// The plain number after `k` others.
    pub fn number_of(&self, k: usize) -> Option<f64> {
        match self.tokens.get(k).map(|t| &t.kind) {
            Some(CommandTokenKind::Number(x, None)) => Some(*x),
            _ => None,
        }
    }

    /// A name in letters or quotes.
    pub fn name(&mut self, what: &str) -> Result<String, CommandError> {
        match self.peek() {
            Some(t) if t.kind == CommandTokenKind::Word || t.kind == CommandTokenKind::Text => {
                self.skip();
                Ok(t.text.clone())
            }
            _ => Err(self.wants(what)),
        }
    }

    /// A plain number.
    pub fn number(&mut self, what: &str) -> Result<f64, CommandError> {
        match self.peek().map(|t| &t.kind) {
            Some(CommandTokenKind::Number(x, unit))
                if unit.as_deref().is_none_or(|u| u == "DEG") =>
            {
                self.skip();
                Ok(*x)
            }
            _ => Err(self.wants(what)),
        }
    }

    /// True if a number is next.
    pub fn at_number(&self) -> bool {
        matches!(self.peek().map(|t| &t.kind), Some(CommandTokenKind::Number(..)))
    }

    fn label(&mut self, what: &str) -> Result<u32, CommandError> {
        let fault = self.wants(what);
        let x = self.number(what)?;
        if x.fract() == 0.0 && x >= 1.0 && x <= f64::from(MAX_LABEL) {
            Ok(x as u32)
        } else {
            Err(fault)
        }
    }

    /// The label of a point.
    pub fn point(&mut self) -> Result<PointId, CommandError> {
        self.label("the number of a point").map(PointId)
    }

    /// The label of a line.
    pub fn line(&mut self) -> Result<LineId, CommandError> {
        self.label("the number of a line").map(LineId)
    }

    /// A whole number from 1.
    pub fn count(&mut self, what: &str) -> Result<u32, CommandError> {
        self.label(what)
    }

    /// An axis, if one is next.
    pub fn axis(&mut self) -> Option<CoordinateAxis> {
        let token = self.peek().filter(|t| t.kind == CommandTokenKind::Word)?;
        let axis = CoordinateAxis::of(&token.text)?;
        self.skip();
        Some(axis)
    }

    /// A value: a number with an optional unit, a name, or an expression in quotes. Lengths with a
    /// unit are converted to `unit`, the unit of the object.
    pub fn value(&mut self, unit: Option<&str>) -> Result<DimensionExpr, CommandError> {
        let Some(token) = self.peek() else { return Err(self.wants("a value")) };
        let size = |name: &str| UNITS.iter().find(|u| u.0 == name).map(|u| u.1);
        let convert = |x: f64, from: &str| -> Result<f64, CommandError> {
            match (size(from), unit.and_then(size)) {
                _ if from == "DEG" => Ok(x),
                (Some(_), Some(_)) if unit == Some(from) => Ok(x),
                (Some(a), Some(b)) => Ok(x * a / b),
                _ => Err(CommandError::text(
                    format!("{} has a unit, but the object has none", token.text),
                    "SET UNITS first (MM, CM, M, IN or FT)",
                )),
            }
        };
        let expr = match &token.kind {
            CommandTokenKind::Number(x, None) => DimensionExpr::number(*x),
            CommandTokenKind::Number(x, Some(u)) => DimensionExpr::number(convert(*x, u)?),
            CommandTokenKind::Text | CommandTokenKind::Word => match feet_and_inches(&token.text) {
                Some(feet) => DimensionExpr::number(convert(feet, "FT")?),
                None => DimensionExpr::parse(&token.text).map_err(|why| {
                    CommandError::text(
                        format!("in `{}`: {why}", token.text),
                        "write a number or an expression like \"2*W1+0.5\"",
                    )
                })?,
            },
        };
        self.skip();
        Ok(expr)
    }

    /// `IN lo hi`, if it is next.
    pub fn range(&mut self) -> Result<Option<[f64; 2]>, CommandError> {
        let is_in = self
            .peek()
            .is_some_and(|t| t.kind == CommandTokenKind::Word && t.text.eq_ignore_ascii_case("IN"));
        if !is_in {
            return Ok(None);
        }
        self.skip();
        let (low, high) = (self.number("the lower end")?, self.number("the upper end")?);
        if low < high {
            Ok(Some([low, high]))
        } else {
            Err(CommandError::text(
                format!("the range {low} to {high} is empty"),
                "give the lower end first",
            ))
        }
    }

    /// Nothing may be left.
    pub fn end(&self) -> Result<(), CommandError> {
        if self.tokens.is_empty() { Ok(()) } else { Err(self.wants("the end of the command")) }
    }
}
