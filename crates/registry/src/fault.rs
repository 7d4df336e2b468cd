use crate::Class;
use moldloft_num::trace::Key;

/// Which argument a fault is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The field's position in the row.
    pub field: usize,
    /// The item of a list argument, from 0.
    pub item: Option<usize>,
}

/// Why a call failed: the data of a diagnostic, before it knows its place in the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault(Box<FaultData>);

/// The parts of a [`Fault`].
#[derive(Clone, Debug, PartialEq)]
pub struct FaultData {
    /// Stable kebab-case id.
    pub id: &'static str,
    /// One line that stands alone.
    pub message: String,
    /// What was expected.
    pub expected: Option<String>,
    /// What was found.
    pub found: Option<String>,
    /// How to mend it.
    pub help: Vec<String>,
    /// The argument it is about.
    pub place: Option<Place>,
    /// Other objects it is about, each with what is to be said of it.
    pub related: Vec<(Key, String)>,
}

impl Fault {
    /// A fault with an id and a message.
    pub fn new(id: &'static str, message: impl Into<String>) -> Self {
        Fault(Box::new(FaultData {
            id,
            message: message.into(),
            expected: None,
            found: None,
            help: Vec::new(),
            place: None,
            related: Vec::new(),
        }))
    }

    /// A value of the wrong class.
    pub fn wrong_class(expected: Class, found: Class) -> Self {
        let fault =
            Self::new("wrong-class", format!("expected {}, found {}", expected.a(), found.a()))
                .expected(expected.a())
                .found(found.a());
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

    /// Says what was expected.
    pub fn expected(mut self, text: impl Into<String>) -> Self {
        self.0.expected = Some(text.into());
        self
    }

    /// Says what was found.
    pub fn found(mut self, text: impl Into<String>) -> Self {
        self.0.found = Some(text.into());
        self
    }

    /// Adds a way to mend it.
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.0.help.push(text.into());
        self
    }

    /// Points to another object, if it has a name: "`label`" stands beside its declaration.
    pub fn related(mut self, object: Option<Key>, label: impl Into<String>) -> Self {
        self.0.related.extend(object.map(|key| (key, label.into())));
        self
    }

    /// Says which argument it is about, unless that is known already.
    pub fn in_field(mut self, field: usize) -> Self {
        match &mut self.0.place {
            Some(place) if place.field == usize::MAX => place.field = field,
            Some(_) => {}
            none => *none = Some(Place { field, item: None }),
        }
        self
    }

    /// Says which item of a list argument it is about; the field is added by [`Self::in_field`].
    pub fn in_item(mut self, item: usize) -> Self {
        self.0.place = Some(Place { field: usize::MAX, item: Some(item) });
        self
    }
}

impl std::ops::Deref for Fault {
    type Target = FaultData;
    fn deref(&self) -> &FaultData {
        &self.0
    }
}
