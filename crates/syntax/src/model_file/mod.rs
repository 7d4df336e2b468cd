//! MultiSurf model files, versions 0.35 and 1.x, as a lossless structure.
//!
//! A file is a header, then objects: an entity word, a name and fields separated by blanks, up to a
//! `;`. The meaning of the fields depends on the entity and is decided elsewhere; here they are
//! numbers, words, lists and so on, each with its position. An unknown object can therefore be
//! written back unchanged.
//!
//! ```
//! use moldloft_diag::FileId;
//! use moldloft_syntax::model_file::{self, FieldKind};
//!
//! let text = "MultiSurf 0.35 /y\nAbsPoint P11 14 1 0.000 0.000 3.600;\nEndModel\n";
//! let (mut model, diagnostics) = model_file::parse(text, FileId(0));
//! assert!(diagnostics.is_empty() && model.symmetry() == "y");
//! let point = model.objects().next().unwrap();
//! assert_eq!((model.slice(point.entity), model.slice(point.name)), ("AbsPoint", "P11"));
//! assert_eq!(model.to_canonical(|_| false), "MultiSurf 0.35 /y\nAbsPoint P11 14 1 0 0 3.6;\nEndModel;\n");
//!
//! // A number can be changed in place.
//! let FieldKind::Number(z) = model[point.fields][4].kind else { panic!() };
//! model.set_number(z, 3.7).unwrap();
//! assert_eq!(model.text_with_edits(), text.replace("3.600", "3.7"));
//! ```

mod parse;
mod write;

pub use parse::parse;

use crate::number;
use moldloft_diag::{Diagnostic, FileId, Span};
use std::ops::Index;
use std::sync::Arc;

/// The attribute that holds an argument without a column: `A:Moldloft(breaks { 0.25 0.7 })`.
pub const ARGUMENT: &str = "A:Moldloft";

/// A number of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NumberId(pub u32);

/// A number and its position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number {
    /// The value, finite.
    pub value: f64,
    /// True if it is spelled with digits (and a sign) only.
    pub is_int: bool,
    /// Position in the parsed text.
    pub span: Span,
    /// True if the value was set after parsing.
    pub edited: bool,
}

/// Consecutive fields; `model[fields]` is the slice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fields {
    start: u32,
    count: u32,
}

impl Fields {
    /// Number of fields.
    pub fn len(self) -> usize {
        self.count as usize
    }

    /// True without fields.
    pub fn is_empty(self) -> bool {
        self.count == 0
    }
}

/// One field of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EntryField {
    /// Kind.
    pub kind: FieldKind,
    /// Position.
    pub span: Span,
}

/// The kinds of fields. Kinds without data are read with [`ModelFile::slice`] of the field's span.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldKind {
    /// A number.
    Number(NumberId),
    /// `8x4`: divisions and subdivisions.
    Pair(NumberId, NumberId),
    /// A name or another word.
    Word,
    /// `*` (the default), or a name given by the system, such as `*X=0`.
    Star,
    /// `"…"`; the span includes the quotes.
    Text,
    /// `=variable`, or an expression in `[…]`.
    Formula,
    /// `{ … }`
    List(Fields),
    /// `( … )`
    Tuple(Fields),
    /// `A:Name(value)`.
    Attribute {
        /// Position of the name.
        name: Span,
        /// Position of the value, without the parentheses.
        value: Span,
    },
    /// `A:Moldloft(name field)`: an argument without a column, by its name.
    Argument {
        /// Position of the name.
        name: Span,
        /// Its fields: one if it is valid.
        value: Fields,
    },
    /// `/`, which ends the head of an object in 1.x.
    Slash,
}

/// An object, or a `Variable` or `Formula`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectEntry {
    /// The entity word.
    pub entity: Span,
    /// The name.
    pub name: Span,
    /// Fields after the name.
    pub fields: Fields,
    /// The span from the entity word to the `;`.
    pub span: Span,
    /// True if it ends correctly, with all its lists closed; the errors of an incomplete one were
    /// reported.
    pub complete: bool,
}

/// Items of the body of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ItemKind {
    /// `Rem …` or `# …`, without the line end.
    Comment,
    /// An object.
    Object(ObjectEntry),
    /// Text that is not valid; reported.
    Unknown,
}

/// An item in the body of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Item {
    /// Kind.
    pub kind: ItemKind,
    /// Position.
    pub span: Span,
    /// True if an empty line precedes it.
    pub after_gap: bool,
}

/// `Key: rest` in the header of a 1.x file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeaderLine {
    /// The key without its colon.
    pub key: Span,
    /// The rest, without blanks around it.
    pub rest: Span,
}

/// A parsed model file.
#[derive(Clone, Debug)]
pub struct ModelFile {
    text: Arc<str>,
    file: FileId,
    /// The version word of the first line.
    pub version: Option<Span>,
    /// Text after the version on the first line, such as `/y`.
    pub first_line_rest: Option<Span>,
    /// The header lines.
    pub header: Vec<HeaderLine>,
    /// Comments before the first object or `BeginModel`.
    pub header_comments: Vec<Span>,
    /// The word `BeginModel`.
    pub begin: Option<Span>,
    /// Objects and comments in the order of the file.
    pub items: Vec<Item>,
    /// The word `EndModel`.
    pub end: Option<Span>,
    /// Text after `EndModel`.
    pub trailer: Option<Span>,
    fields: Vec<EntryField>,
    numbers: Vec<Number>,
    edited: Vec<NumberId>,
}

impl ModelFile {
    /// The text that was parsed.
    pub fn text(&self) -> &Arc<str> {
        &self.text
    }

    /// The file of the spans.
    pub fn file(&self) -> FileId {
        self.file
    }

    /// The text of a span.
    pub fn slice(&self, span: Span) -> &str {
        self.text.get(span.range()).unwrap_or("")
    }

    /// The objects in the order of the file.
    pub fn objects(&self) -> impl Iterator<Item = ObjectEntry> + '_ {
        self.items.iter().filter_map(|item| match item.kind {
            ItemKind::Object(object) => Some(object),
            _ => None,
        })
    }

    /// All numbers in the order of the text.
    pub fn numbers(&self) -> &[Number] {
        &self.numbers
    }

    /// The rest of the header line with this key.
    pub fn header_value(&self, key: &str) -> Option<&str> {
        let line = self.header.iter().find(|line| self.slice(line.key) == key)?;
        Some(self.slice(line.rest))
    }

    /// The mirror planes as letters, for instance `y`, from the first line (`/y`) or the line
    /// `Symmetry:`.
    pub fn symmetry(&self) -> String {
        let first = self.first_line_rest.map_or("", |span| self.slice(span));
        let legacy = first.strip_prefix('/').unwrap_or("");
        let planes = self.header_value("Symmetry").unwrap_or("");
        legacy.chars().chain(planes.chars()).filter(|c| matches!(c, 'x' | 'y' | 'z')).collect()
    }

    /// The attributes of an object: name and value.
    pub fn attributes(&self, object: &ObjectEntry) -> impl Iterator<Item = (&str, &str)> + '_ {
        self[object.fields].iter().filter_map(|field| match field.kind {
            FieldKind::Attribute { name, value } => Some((self.slice(name), self.slice(value))),
            _ => None,
        })
    }

    /// Changes a number, without parsing again.
    ///
    /// # Errors
    /// `not-finite` for infinities and NaN; `unknown-literal` for an id of another file.
    pub fn set_number(&mut self, id: NumberId, value: f64) -> Result<(), Diagnostic> {
        let Some(entry) = self.numbers.get_mut(id.0 as usize) else {
            let message = "this number does not belong to the model file";
            return Err(Diagnostic::error("unknown-literal", message));
        };
        if !value.is_finite() {
            let diagnostic = Diagnostic::error("not-finite", "a number in a model must be finite");
            return Err(diagnostic
                .at(entry.span)
                .expected("a finite number")
                .found(value.to_string()));
        }
        entry.value = if value == 0.0 { 0.0 } else { value };
        entry.is_int &= number::is_whole(value);
        if !entry.edited {
            entry.edited = true;
            self.edited.push(id);
        }
        Ok(())
    }

    /// True if a number was changed since the text was parsed.
    pub fn is_edited(&self) -> bool {
        !self.edited.is_empty()
    }

    /// Replacements in [`ModelFile::text`] for the changed numbers, in the order of the text.
    pub fn edits(&self) -> Vec<(Span, String)> {
        let mut ids = self.edited.clone();
        ids.sort_unstable();
        ids.into_iter().map(|id| self[id]).map(|n| (n.span, number::plain(n.value))).collect()
    }

    /// The text with the changed numbers, otherwise identical.
    pub fn text_with_edits(&self) -> String {
        crate::splice(&self.text, &self.edits())
    }
}

impl Index<NumberId> for ModelFile {
    type Output = Number;
    fn index(&self, id: NumberId) -> &Number {
        &self.numbers[id.0 as usize]
    }
}

impl Index<Fields> for ModelFile {
    type Output = [EntryField];
    fn index(&self, fields: Fields) -> &[EntryField] {
        &self.fields[fields.start as usize..(fields.start + fields.count) as usize]
    }
}
