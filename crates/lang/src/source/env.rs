use crate::functions::files::Files;
use crate::source::module::{Name, RoutineAt};
use crate::value::initialised::Known;
use crate::value::subarray::Place;
use indexmap::IndexMap;
use moldloft_diag::Span;
use moldloft_model::Graph;
use moldloft_num::trace::Key;
use moldloft_registry::{Context, Scalar, Value};
use moldloft_syntax::sdl::{StmtId, Type};
use std::collections::HashMap;
use std::sync::Arc;

/// What a name means.
#[derive(Clone, Debug)]
pub enum Binding<T: Scalar> {
    /// A variable of a type; `fixed` when its dimensions were declared.
    Variable { ty: Type, value: Value<T>, fixed: bool, known: Known },
    /// A part of a variable of a caller, passed by reference.
    Reference(Place),
    /// The arguments that a multiple argument takes.
    Multiple(Box<Multiple<T>>),
    /// A design parameter, by its number.
    Param(usize),
    /// An object.
    Object(Key),
    /// Something made in loops: in the turn `turn` it means `now`, afterwards all of them.
    Turn { now: Key, turn: u64, family: Arc<str> },
    /// A named call of a subroutine: the family of the objects in it.
    Instance(Arc<str>),
    /// Its declaration failed and was reported; what uses it stays silent.
    Poisoned,
}

impl<T: Scalar> Binding<T> {
    /// A variable whose dimensions follow what is assigned.
    pub fn variable(ty: Type, value: Value<T>) -> Self {
        Binding::Variable { ty, value, fixed: false, known: Known::default() }
    }
}

/// A multiple argument, read one after the other.
#[derive(Clone, Debug)]
pub struct Multiple<T: Scalar> {
    pub ty: Type,
    pub items: Vec<Passed<T>>,
    /// How many were read by `next`.
    pub read: usize,
}

/// An argument as it was passed.
#[derive(Clone, Debug)]
pub enum Passed<T: Scalar> {
    Value(Value<T>),
    Place(Place),
}

/// A binding and where it was made.
#[derive(Clone, Debug)]
pub struct Bound<T: Scalar> {
    pub span: Span,
    pub what: Binding<T>,
}

/// The variables of a routine's call, or of the file level of a load.
#[derive(Debug)]
pub struct Frame<T: Scalar> {
    pub locals: Vec<(Name, Bound<T>)>,
    /// True at file level, where names are global.
    pub global: bool,
    /// Goes before the names of objects: "fore." in the call `leg fore(...)`.
    pub prefix: Arc<str>,
    pub loops: Vec<Turn>,
    /// The call that the frame belongs to, and the module it stands in.
    pub called: Option<(Span, u32)>,
}

/// A turn of a loop under way.
#[derive(Clone, Debug)]
pub struct Turn {
    /// The loop variable's value as it stands in names; `None` in a `while`.
    pub label: Option<f64>,
    /// Unique among the turns of a run.
    pub id: u64,
}

impl<T: Scalar> Frame<T> {
    pub fn new(global: bool, prefix: Arc<str>) -> Self {
        Self { locals: Vec::new(), global, prefix, loops: Vec::new(), called: None }
    }
}

/// Gives the number of that name its derivatives.
pub type Seed<'a, T> = &'a (dyn Fn(&str, T) -> T + Sync);

/// A design parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// Its name.
    pub name: String,
    /// Its value in this run.
    pub value: f64,
    /// The value in the text.
    pub default: f64,
    /// Its range, when it has one.
    pub range: Option<(f64, f64)>,
    /// True when it takes whole numbers only.
    pub is_int: bool,
    /// Where it is declared.
    pub span: Span,
}

/// Where an object was declared.
#[derive(Clone, Copy, Debug)]
pub struct Origin {
    pub module: u32,
    pub stmt: StmtId,
    /// True when the statement may be executed more than once: in a loop or a subroutine.
    pub repeated: bool,
}

/// A graph and what the run that made it left behind.
pub struct Evaluation<T: Scalar> {
    pub graph: Graph<T>,
    pub env: Environment<T>,
}

impl<T: Scalar> Default for Evaluation<T> {
    fn default() -> Self {
        Self { graph: Graph::new(Context::default()), env: Environment::default() }
    }
}

/// How the search for a solution ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolveStatus {
    /// All conditions hold.
    Solved,
    /// The conditions do not determine the unknowns.
    Singular,
    /// No step makes the conditions smaller.
    Stuck,
    /// A solution would lie outside a range.
    OutOfRange,
    /// The steps did not suffice.
    TooManySteps,
    /// The model could not be built on the way.
    NoModel,
}

impl SolveStatus {
    /// A word for it.
    pub fn word(self) -> &'static str {
        match self {
            SolveStatus::Solved => "solved",
            SolveStatus::Singular => "singular",
            SolveStatus::Stuck => "stuck",
            SolveStatus::OutOfRange => "out-of-range",
            SolveStatus::TooManySteps => "too-many-steps",
            SolveStatus::NoModel => "no-model",
        }
    }
}

/// A solve set as a run found it.
#[derive(Clone, Debug)]
pub struct Solve<T> {
    pub name: Arc<str>,
    pub span: Span,
    /// Parameters, by their numbers.
    pub unknowns: Vec<usize>,
    /// What becomes zero.
    pub conditions: Vec<T>,
    /// The most steps.
    pub steps: usize,
}

/// All that a run leaves behind: what expressions may refer to afterwards.
#[derive(Debug)]
pub struct Environment<T: Scalar> {
    pub globals: Vec<Option<Bound<T>>>,
    pub routines: HashMap<Name, RoutineAt>,
    pub params: Vec<Param>,
    pub param_values: Vec<T>,
    /// Objects made in loops and subroutines, by the name without its last index.
    pub families: IndexMap<Arc<str>, Vec<Key>>,
    pub origins: Vec<Origin>,
    /// Variables and formulas of a model file.
    pub numbers: IndexMap<String, T>,
    pub solves: Vec<Solve<T>>,
    /// Steps and status of the solve sets, once they are solved.
    pub solved: IndexMap<String, (usize, SolveStatus)>,
    pub printed: Vec<String>,
    /// Files that were opened, and what was written.
    pub files: Files,
    /// Loaded sketches by the name that their parts begin with.
    pub sketches: Vec<String>,
    /// Numbers and objects of sketches by full name, as spelled and in small letters.
    pub sketch_members: HashMap<String, Value<T>>,
    /// True when the run ended early, so that objects may be missing.
    pub stopped: bool,
}

impl<T: Scalar> Default for Environment<T> {
    fn default() -> Self {
        Self {
            globals: Vec::new(),
            routines: HashMap::new(),
            params: Vec::new(),
            param_values: Vec::new(),
            families: IndexMap::new(),
            origins: Vec::new(),
            numbers: IndexMap::new(),
            solves: Vec::new(),
            solved: IndexMap::new(),
            printed: Vec::new(),
            files: Files::default(),
            sketches: Vec::new(),
            sketch_members: HashMap::new(),
            stopped: false,
        }
    }
}
