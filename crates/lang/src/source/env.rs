//! Results of a run: the names, parameters, solve sets and printed lines for later expressions.

use crate::functions::files::RunFiles;
use crate::source::scope::Scope;
use indexmap::IndexMap;
use moldloft_diag::Span;
use moldloft_model::Graph;
use moldloft_num::trace::Key;
use moldloft_registry::{Context, Scalar, Value};
use moldloft_syntax::sdl::StmtId;
use std::collections::HashMap;
use std::sync::Arc;

/// Gives the derivatives of the number of that name.
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
    /// Its range, if it has one.
    pub range: Option<(f64, f64)>,
    /// True if its value must be an integer.
    pub is_int: bool,
    /// Position of the declaration.
    pub span: Span,
}

/// Position of an object's declaration.
#[derive(Clone, Copy, Debug)]
pub struct DeclarationOrigin {
    /// The module, by its number.
    pub module: u32,
    /// The statement of the module.
    pub stmt: StmtId,
    /// True when the statement may be executed more than once: in a loop or a subroutine.
    pub repeated: bool,
}

/// A graph and the environment after its run.
pub struct Evaluation<T: Scalar> {
    /// The objects.
    pub graph: Graph<T>,
    /// The names, parameters and results of the run.
    pub env: Environment<T>,
}

impl<T: Scalar> Default for Evaluation<T> {
    fn default() -> Self {
        Self { graph: Graph::new(Context::default()), env: Environment::default() }
    }
}

/// Result of the search for a solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolveStatus {
    /// All conditions hold.
    Solved,
    /// The conditions do not determine the unknowns.
    Singular,
    /// No step reduces the conditions.
    Stuck,
    /// The solution would be outside a range.
    OutOfRange,
    /// The maximum number of steps was reached.
    TooManySteps,
    /// The model could not be built for a trial value.
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

/// An unknown of a solve set: a parameter, or a literal in the declaration of an object.
#[derive(Clone, Debug)]
pub struct SolveUnknown<T> {
    /// Its name: `beam`, or `P21.y`.
    pub name: String,
    /// Its value in this run.
    pub value: T,
    /// The range of the parameter or argument, if it has one.
    pub range: Option<(f64, f64)>,
    /// The object of the number; `None` for a parameter.
    pub object: Option<String>,
}

/// A solve set of a run.
#[derive(Clone, Debug)]
pub struct Solve<T> {
    /// The name of the set.
    pub name: Arc<str>,
    /// The span of its declaration.
    pub span: Span,
    /// Unknowns.
    pub unknowns: Vec<SolveUnknown<T>>,
    /// Conditions, zero at the solution.
    pub conditions: Vec<T>,
    /// Maximum number of steps.
    pub steps: usize,
}

/// Results of a run that later expressions use.
#[derive(Debug)]
pub struct Environment<T: Scalar> {
    /// Bindings at the end of the run.
    pub scope: Scope<T>,
    /// The design parameters, in the order of their declaration.
    pub params: Vec<Param>,
    /// Their values, in the same order.
    pub param_values: Vec<T>,
    /// Objects made in loops and subroutines, by the name without its last index.
    pub families: IndexMap<Arc<str>, Vec<Key>>,
    /// The origin of the declaration of each object, by its key.
    pub origins: Vec<DeclarationOrigin>,
    /// Variables and formulas of a model file.
    pub numbers: IndexMap<String, T>,
    /// The solve sets, in the order of the text.
    pub solves: Vec<Solve<T>>,
    /// Steps and status of the solve sets after solving.
    pub solved: IndexMap<String, (usize, SolveStatus)>,
    /// The lines printed.
    pub printed: Vec<String>,
    /// Files opened and written.
    pub files: RunFiles,
    /// Loaded sketches, by the prefix of their parts.
    pub sketches: Vec<String>,
    /// The files of sketches with their stated units of length, and where they are loaded.
    pub sketch_units: Vec<(String, String, moldloft_diag::Span)>,
    /// Finished bodies of sketches, by the name of their mesh, in runs of plain numbers.
    pub sketch_bodies:
        std::collections::BTreeMap<String, std::sync::Arc<moldloft_sketch::SketchSolid<f64>>>,
    /// Numbers and objects of sketches by full name, as spelled and in small letters.
    pub sketch_members: HashMap<String, Value<T>>,
    /// True when the run ended early, so that objects may be missing.
    pub stopped: bool,
    /// Number of steps counted.
    pub steps: u64,
}

impl<T: Scalar> Default for Environment<T> {
    fn default() -> Self {
        Self {
            scope: Scope::default(),
            params: Vec::new(),
            param_values: Vec::new(),
            families: IndexMap::new(),
            origins: Vec::new(),
            numbers: IndexMap::new(),
            solves: Vec::new(),
            solved: IndexMap::new(),
            printed: Vec::new(),
            files: RunFiles::default(),
            sketches: Vec::new(),
            sketch_units: Vec::new(),
            sketch_bodies: std::collections::BTreeMap::new(),
            sketch_members: HashMap::new(),
            stopped: false,
            steps: 0,
        }
    }
}
