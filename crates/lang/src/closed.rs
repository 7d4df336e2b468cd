//! Entries for each scalar: the interpreter is compiled in this crate, once for each, and not again where it is called.

use crate::model_file::ModelFileSource;
use crate::run::interpreter::Inputs;
use crate::run::program::RunContext;
use crate::source::env::Evaluation;
use moldloft_diag::Diagnostic;
use moldloft_model::Applied;
use moldloft_num::{Dual4, Rev};
use moldloft_registry::{Scalar, Value};

/// A scalar with which models run.
pub trait RunScalar: Scalar {
    /// Runs module 0 of a program and the modules that it loads.
    fn run_program(
        program: RunContext<'_>,
        evaluation: &mut Evaluation<Self>,
        inputs: Inputs<'_, Self>,
        found: &mut Vec<Diagnostic>,
    ) -> Applied;

    /// Declares the objects of a model file.
    fn run_model_file(
        source: &ModelFileSource,
        host: RunContext<'_>,
        evaluation: &mut Evaluation<Self>,
        inputs: Inputs<'_, Self>,
        found: &mut Vec<Diagnostic>,
    ) -> Applied;

    /// The value of an expression in the names of the last run, with its warnings.
    ///
    /// # Errors
    /// Errors of the text and of its evaluation.
    fn eval(
        program: RunContext<'_>,
        evaluation: &mut Evaluation<Self>,
        inputs: Inputs<'_, Self>,
        text: &str,
    ) -> Result<(Value<Self>, Vec<Diagnostic>), Vec<Diagnostic>>;
}

macro_rules! run_scalars {
    ($($scalar:ty),*) => {$(
        impl RunScalar for $scalar {
            fn run_program(
                program: RunContext<'_>,
                evaluation: &mut Evaluation<Self>,
                inputs: Inputs<'_, Self>,
                found: &mut Vec<Diagnostic>,
            ) -> Applied {
                program.run(evaluation, inputs, found)
            }

            fn run_model_file(
                source: &ModelFileSource,
                host: RunContext<'_>,
                evaluation: &mut Evaluation<Self>,
                inputs: Inputs<'_, Self>,
                found: &mut Vec<Diagnostic>,
            ) -> Applied {
                source.run(host, evaluation, inputs, found)
            }

            fn eval(
                program: RunContext<'_>,
                evaluation: &mut Evaluation<Self>,
                inputs: Inputs<'_, Self>,
                text: &str,
            ) -> Result<(Value<Self>, Vec<Diagnostic>), Vec<Diagnostic>> {
                program.eval(evaluation, inputs, text)
            }
        }
    )*};
}

run_scalars!(f64, Dual4, Rev);
