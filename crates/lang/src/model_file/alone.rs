//! Independent model files: run without a program, and converted for a program that loads them.

use crate::World;
use crate::model_file::source::ModelFileSource;
use crate::model_file::to_program::{prevents_conversion, to_program};
use crate::run::interpreter::{Inputs, Settings};
use crate::run::program::RunContext;
use crate::source::NoFiles;
use crate::source::env::Evaluation;
use crate::source::module::Modules;
use indexmap::IndexMap;
use moldloft_budget::Budget;
use moldloft_diag::{Diagnostic, Sources};
use moldloft_registry::Registry;
use std::collections::HashSet;

/// The program equivalent to a model file.
///
/// # Errors
/// That the file is not sound, with its first fault.
pub fn converted(name: &str, text: &str, registry: &Registry) -> Result<String, Diagnostic> {
    let mut sources = Sources::new();
    let file = sources.add(name, text);
    let (source, mut found) = ModelFileSource::parse(text.to_string(), file);
    let mut evaluation = Evaluation::default();
    run_alone(&source, &NoFiles, &mut sources, registry, &mut evaluation, &mut found);
    match found.iter().find(|d| prevents_conversion(&evaluation, d)) {
        None => Ok(to_program(&source, registry, &evaluation)),
        Some(first) => Err(Diagnostic::error(
            "cannot-read",
            format!("`{name}` is not sound: {}", first.message),
        )
        .help("open the model file alone to see all its faults")),
    }
}

/// Makes the objects of an independent model file.
pub(super) fn run_alone(
    source: &ModelFileSource,
    world: &dyn World,
    sources: &mut Sources,
    registry: &Registry,
    evaluation: &mut Evaluation<f64>,
    found: &mut Vec<Diagnostic>,
) {
    let mut modules = Modules::default();
    let host =
        RunContext { modules: &mut modules, world, registry, sources, sketch: None, converted };
    let inputs = Inputs {
        overrides: &IndexMap::new(),
        seed: &|_, x| x,
        seeded_objects: &HashSet::new(),
        budget: &Budget::default(),
        settings: Settings::default(),
    };
    source.run(host, evaluation, inputs, found);
}
