//! Faults of calls: description and argument.

use crate::Class;
use moldloft_budget::Spent;
use moldloft_num::trace::Key;

/// A field of a row: the constants that `#[derive(Kind)]` emits for a struct, `Self::RADIUS` for
/// its field `radius`. Faults name arguments by these alone, so they stay correct when a field
/// moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldId(u16);

impl FieldId {
    /// For the derive macro and for rows: nothing else knows a position.
    pub(crate) const fn at(position: usize) -> Self {
        FieldId(position as u16)
    }

    /// The position in the row.
    pub fn position(self) -> usize {
        self.0 as usize
    }
}

/// An argument of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Argument {
    /// The argument of a field.
    Field(FieldId),
    /// The named argument with this number, as written.
    Named(usize),
    /// The first superfluous argument.
    Extra,
}

/// The argument of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArgumentPlace {
    /// The argument.
    pub argument: Argument,
    /// The item of a list argument, from 0.
    pub item: Option<usize>,
}

impl From<Spent> for CallError {
    fn from(spent: Spent) -> Self {
        match spent {
            Spent::Cancelled => Self::new(spent.id(), "the run was cancelled"),
            _ => Self::new(spent.id(), spent.to_string()).help(spent.help()),
        }
    }
}

/// The reason why a call failed: the data of a diagnostic that has no position in the text yet.
#[derive(Clone, Debug, PartialEq)]
pub struct CallError(Box<CallErrorData>);

/// The parts of a [`CallError`].
#[derive(Clone, Debug, PartialEq)]
pub struct CallErrorData {
    /// Stable kebab-case id.
    pub id: &'static str,
    /// One self-contained line.
    pub message: String,
    /// Expected input.
    pub expected: Option<String>,
    /// Found input.
    pub found: Option<String>,
    /// The remedy.
    pub help: Vec<String>,
    /// The argument it is about.
    pub place: Option<ArgumentPlace>,
    /// The item of an argument that is not known yet.
    item: Option<usize>,
    /// Other objects involved, each with a description.
    pub related: Vec<(Key, String)>,
}

impl CallError {
    /// A fault with an id and a message.
    pub fn new(id: &'static str, message: impl Into<String>) -> Self {
        CallError(Box::new(CallErrorData {
            id,
            message: message.into(),
            expected: None,
            found: None,
            help: Vec::new(),
            place: None,
            item: None,
            related: Vec::new(),
        }))
    }

    /// A value of the wrong class.
    pub fn wrong_class(expected: Class, found: Class) -> Self {
        let fault = Self::new(
            "wrong-class",
            format!("expected {}, found {}", expected.with_article(), found.with_article()),
        )
        .expected(expected.with_article())
        .found(found.with_article());
        // Arrays of points and shapes with parameters are easily taken for each other.
        match (expected, found) {
            (Class::Curve | Class::Surface, Class::Vectors) => fault
                .help("put a spline through the points first: makecc(c) or makelc(c), makecs(s)"),
            (Class::Vectors, Class::Curve | Class::Snake) => {
                fault.help("take points of it first: distc(curve, uniform(0, 1, 50))")
            }
            (Class::Vectors, Class::Surface) => fault.help(
                "take points of it first: dists(surface, uniform(0, 1, 50), uniform(0, 1, 30))",
            ),
            _ => fault,
        }
    }

    /// Sets the expected input.
    pub fn expected(mut self, text: impl Into<String>) -> Self {
        self.0.expected = Some(text.into());
        self
    }

    /// Sets the found input.
    pub fn found(mut self, text: impl Into<String>) -> Self {
        self.0.found = Some(text.into());
        self
    }

    /// Adds a remedy.
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.0.help.push(text.into());
        self
    }

    /// Adds a note about another object, if it has a name: "`label`" is shown at its declaration.
    pub fn related(mut self, object: Option<Key>, label: impl Into<String>) -> Self {
        self.0.related.extend(object.map(|key| (key, label.into())));
        self
    }

    /// Sets the argument concerned, unless it is known already.
    pub fn in_field(self, field: FieldId) -> Self {
        self.in_argument(Argument::Field(field))
    }

    /// Says which argument it is about, unless that is known already.
    pub fn in_argument(mut self, argument: Argument) -> Self {
        let item = self.0.item.take();
        self.0.place.get_or_insert(ArgumentPlace { argument, item });
        self
    }

    /// Sets the item of a list argument concerned; the field is added by [`Self::in_field`].
    pub fn in_item(mut self, item: usize) -> Self {
        self.0.place = None;
        self.0.item = Some(item);
        self
    }

    /// Position of the field concerned.
    pub fn field(&self) -> Option<usize> {
        match self.0.place?.argument {
            Argument::Field(field) => Some(field.position()),
            _ => None,
        }
    }

    /// Item of the list argument concerned.
    pub fn item(&self) -> Option<usize> {
        self.0.place.map_or(self.0.item, |place| place.item)
    }
}

impl std::ops::Deref for CallError {
    type Target = CallErrorData;
    fn deref(&self) -> &CallErrorData {
        &self.0
    }
}
