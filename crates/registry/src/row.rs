//! Rows: name, fields, help and evaluation of whatever can be called; and the registry, which finds them by name.

use crate::{CallError, Class, FieldId, FromValue, Kept, Value};
use indexmap::IndexMap;
use moldloft_budget::Budget;
use moldloft_num::{Dual4, Real, Rev};
use std::borrow::Cow;
use std::sync::{Arc, Mutex, PoisonError};

/// Default tolerance of a model, in its unit.
const DEFAULT_TOLERANCE: f64 = 1e-6;

/// The closed list of scalars for evaluating models.
pub trait Scalar: Real + FromValue<Self> {
    /// The body of `row` for this scalar, called.
    ///
    /// # Errors
    /// Errors of the implementation.
    fn call(row: &Row, args: &[Value<Self>], context: &Context) -> Result<Value<Self>, CallError>;
}

impl Scalar for f64 {
    fn call(row: &Row, args: &[Value<f64>], context: &Context) -> Result<Value<f64>, CallError> {
        match &row.body {
            Implementation::Native { plain, .. } => plain(args, context),
            Implementation::Foreign(f) => f.call_plain(args, context),
        }
    }
}

impl Scalar for Dual4 {
    fn call(
        row: &Row,
        args: &[Value<Dual4>],
        context: &Context,
    ) -> Result<Value<Dual4>, CallError> {
        match &row.body {
            Implementation::Native { dual, .. } => dual(args, context),
            Implementation::Foreign(f) => f.call_dual(args, context),
        }
    }
}

/// Context of a call besides its arguments.
#[derive(Clone, Debug)]
pub struct Context {
    /// The model's tolerance: the distance below which two points count as one.
    pub tolerance: f64,
    /// Nesting depth of the shapes in the arguments.
    pub nesting: u32,
    /// Number of halvings by which the cells of bodies of sets are larger than stated: a preview
    /// while a number moves. Rows that read it are [`Row::previewed`].
    pub coarser: u32,
    /// Limits of calls; long ones can be cancelled through it.
    pub budget: Arc<Budget>,
    /// Data kept between calls.
    pub kept: Kept,
    /// Notes of calls.
    pub remarks: Arc<Mutex<Vec<CallRemark>>>,
}

/// A note about a call in addition to its value: an iteration has not converged, a march ended
/// early.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CallRemark {
    /// A stable id.
    pub id: &'static str,
    /// One self-contained line.
    pub message: String,
    /// Remedy.
    pub help: &'static str,
}

impl Context {
    /// Adds a note.
    pub fn remark(&self, id: &'static str, message: String, help: &'static str) {
        let mut remarks = self.remarks.lock().unwrap_or_else(PoisonError::into_inner);
        remarks.push(CallRemark { id, message, help });
    }

    /// Removes and returns the notes so far.
    pub fn take_remarks(&self) -> Vec<CallRemark> {
        let mut remarks = self.remarks.lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::take(&mut *remarks)
    }
}

impl Default for Context {
    fn default() -> Self {
        Self {
            tolerance: DEFAULT_TOLERANCE,
            nesting: 0,
            coarser: 0,
            budget: Arc::default(),
            kept: Kept::default(),
            remarks: Arc::default(),
        }
    }
}

/// Makes the value of a call from its arguments, which were read into `Self`.
pub trait Build<T: Real> {
    /// The value.
    ///
    /// # Errors
    /// A [`CallError`] when the arguments make no such thing.
    fn build(self, context: &Context) -> Result<Value<T>, CallError>;
}

/// The unit of a number, if language and model files differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A plain number or a length in the model's unit.
    None,
    /// An angle: radians in the language and in Python, degrees in model files.
    Angle,
}

/// Default of an argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DefaultValue {
    /// Optional: the kind accepts its absence.
    Unset,
    /// A number.
    Number(f64),
    /// A text.
    Text(&'static str),
}

impl DefaultValue {
    /// The default as a value.
    pub fn value<T: Real>(self) -> Value<T> {
        match self {
            DefaultValue::Unset => Value::Unset,
            DefaultValue::Number(x) => Value::Number(x.into()),
            DefaultValue::Text(text) => Value::text(text),
        }
    }
}

/// One argument of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldSpec {
    /// Its name, as in a named argument.
    pub name: &'static str,
    /// A line of help.
    pub help: &'static str,
    /// The class it must have (each item, when `many`).
    pub class: Class,
    /// True for a list.
    pub many: bool,
    /// Default; `None` for a required argument.
    pub default: Option<DefaultValue>,
    /// Its unit.
    pub unit: Unit,
    /// Least value of a number.
    pub min: Option<f64>,
    /// Greatest value of a number.
    pub max: Option<f64>,
    /// Least length of a list.
    pub min_items: usize,
    /// For the last field of a function, a list: its items may be given as separate arguments.
    pub variadic: bool,
}

impl FieldSpec {
    /// A required argument: one value of `class`, without unit and bounds.
    pub const fn new(name: &'static str, class: Class, help: &'static str) -> Self {
        Self {
            name,
            help,
            class,
            many: false,
            default: None,
            unit: Unit::None,
            min: None,
            max: None,
            min_items: 0,
            variadic: false,
        }
    }

    /// The same argument, which may be left out.
    #[must_use]
    pub const fn optional(self) -> Self {
        Self { default: Some(DefaultValue::Unset), ..self }
    }
}

/// A function made at run time, such as a user's Python function.
pub trait Foreign: Send + Sync {
    /// The value for plain numbers.
    ///
    /// # Errors
    /// Errors of the function.
    fn call_plain(&self, args: &[Value<f64>], context: &Context) -> Result<Value<f64>, CallError>;
    /// The value for numbers with derivatives.
    ///
    /// # Errors
    /// Errors of the function.
    fn call_dual(
        &self,
        args: &[Value<Dual4>],
        context: &Context,
    ) -> Result<Value<Dual4>, CallError>;
}

type Call<T> = fn(&[Value<T>], &Context) -> Result<Value<T>, CallError>;

/// Implementation of a row.
#[derive(Clone)]
pub enum Implementation {
    /// Rust code, for each scalar.
    Native {
        /// For `f64`.
        plain: Call<f64>,
        /// For dual numbers.
        dual: Call<Dual4>,
        /// For numbers of a tape; `None` if only forward differentiation is available.
        rev: Option<Call<Rev>>,
    },
    /// A function from outside.
    Foreign(Arc<dyn Foreign>),
}

/// Role of a kind for the interpreter, in addition to its value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Role {
    /// Nothing else.
    #[default]
    Plain,
    /// Header of a model: units, symmetry, title.
    Header,
    /// Made of the points of a file named by its argument `file`, which the program reads into
    /// `points`.
    Table,
    /// A list of objects under a name; its value is the list of its items.
    List,
    /// Unknowns and conditions to be solved before dependent objects are evaluated.
    SolveSet,
    /// A mass and its centre.
    Weight,
    /// The sum of several.
    WeightSum,
}

/// A callable of the registry.
#[derive(Clone)]
pub struct Row {
    /// Its name: kinds begin with a capital letter, functions do not.
    pub name: Cow<'static, str>,
    /// Its documentation; the first line is a summary.
    pub doc: Cow<'static, str>,
    /// The class of its value.
    pub class: Class,
    /// Its arguments, in positional order.
    pub fields: Cow<'static, [FieldSpec]>,
    /// True for a kind of entity: it is declared under a name.
    pub kind: bool,
    /// The names of the fields in the order of a model file's columns, separated by blanks;
    /// `relabel` may be a column whose only value is `*`. `None` if model files have no such
    /// entity.
    pub columns: Option<&'static str>,
    /// A self-contained example in the language.
    pub example: Cow<'static, str>,
    /// For a kind that sweeps: the field of the moving bead and the field of the point or curve
    /// that follows it, which the model passes as a [`crate::LocusRef`].
    pub sweep: Option<[FieldId; 2]>,
    /// True for a function as fast as a look-up of its cached value: it is always called.
    pub cheap: bool,
    /// True if its value depends on [`Context::coarser`].
    pub previewed: bool,
    /// Role besides its value.
    pub role: Role,
    /// Implementation.
    pub body: Implementation,
}

impl Row {
    /// A function of any value, without arguments or documentation.
    pub fn new(name: impl Into<Cow<'static, str>>, body: Implementation) -> Self {
        Self {
            name: name.into(),
            doc: Cow::Borrowed(""),
            class: Class::Any,
            fields: Cow::Borrowed(&[]),
            kind: false,
            columns: None,
            example: Cow::Borrowed(""),
            sweep: None,
            cheap: false,
            previewed: false,
            role: Role::Plain,
            body,
        }
    }

    /// Sets the documentation.
    pub fn doc(self, doc: impl Into<Cow<'static, str>>) -> Self {
        Self { doc: doc.into(), ..self }
    }

    /// Sets the arguments.
    pub fn fields(self, fields: Vec<FieldSpec>) -> Self {
        Self { fields: fields.into(), ..self }
    }

    /// Sets the example.
    pub fn example(self, example: impl Into<Cow<'static, str>>) -> Self {
        Self { example: example.into(), ..self }
    }

    /// Marks the kind as cheap: its values are not cached.
    pub fn cheap(self) -> Self {
        Self { cheap: true, ..self }
    }

    /// The first line of the documentation.
    pub fn summary(&self) -> &str {
        self.doc.lines().next().unwrap_or("")
    }

    /// The field at a position.
    ///
    /// # Panics
    /// If the position is not less than the number of fields.
    pub fn id(&self, position: usize) -> FieldId {
        assert!(position < self.fields.len(), "{} has no field {position}", self.name);
        FieldId::at(position)
    }

    /// Position of the field called `name`.
    pub fn field(&self, name: &str) -> Option<usize> {
        self.fields.iter().position(|f| f.name == name)
    }
}

impl std::fmt::Debug for Row {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "Row({})", self.name)
    }
}

/// Row of a kind, as generated by the derive macro.
#[doc(hidden)]
pub trait StaticRow {
    fn row() -> Row;
}

/// All rows, in the order of the reference.
#[derive(Clone, Debug, Default)]
pub struct Registry {
    rows: IndexMap<String, Arc<Row>>,
}

impl Registry {
    /// A registry of these rows.
    ///
    /// # Panics
    /// When two rows have the same name.
    pub fn new(rows: impl IntoIterator<Item = Row>) -> Self {
        let mut registry = Self::default();
        for row in rows {
            let name = row.name.to_string();
            let old = registry.rows.insert(name, Arc::new(row));
            assert!(old.is_none(), "two rows are called {}", old.unwrap().name);
        }
        registry
    }

    /// Adds a row made at run time, replacing one of the same name.
    pub fn add(&mut self, row: Row) {
        self.rows.insert(row.name.to_string(), Arc::new(row));
    }

    /// The row called `name`.
    pub fn get(&self, name: &str) -> Option<&Arc<Row>> {
        self.rows.get(name)
    }

    /// All rows in order.
    pub fn rows(&self) -> impl Iterator<Item = &Arc<Row>> {
        self.rows.values()
    }

    /// All names in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.rows.keys().map(String::as_str)
    }
}
