//! Runs a program: distributions of refined runs, whose points contain those of the coarse run.
//!
//! A law with a first step per index nests if the step is halved with the intervals. Laws with
//! exact cells do not: their coarse row is made, and its intervals are halved.

use crate::run::interpreter::Interpreter;
use moldloft_arrays::halved;
use moldloft_diag::{Diagnostic, Span};
use moldloft_registry::{CallError, Row, Scalar, Value};
use std::sync::Arc;

/// The indices of the steps among the arguments of a distribution, and whether these are cells
/// rather than slopes.
fn steps_of(name: &str) -> Option<(&'static [usize], bool)> {
    Some(match name {
        "d_tanh" | "d_sinh" => (&[2, 3], false),
        "d_tanhx" | "geometric2" => (&[2, 3], true),
        "geometric" => (&[2], true),
        _ => return None,
    })
}

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// Notes a `redist` of a refined row between whose points its own lie: it interpolates in one row in the coarse run, and
    /// in another one here.
    fn redistributed(&mut self, args: &[Value<T>], coarse: f64, span: Span) {
        let Some(Value::Numbers(given)) = args.first() else { return };
        let count = given.items.len() as f64;
        let Some(given) = self.refined.counts.get(&count.to_bits()) else { return };
        if (given - 1.0) % (coarse - 1.0) != 0.0 {
            let message = "the points of the coarse run are not among those of this redist, whose row has a refined number of points";
            self.report(
                Diagnostic::remark("not-nested", message)
                    .at(span)
                    .help("give it a row of a fixed number of points"),
            );
        }
    }

    /// The row of a distribution with cells in a refined run; `None` of any other call.
    pub(super) fn nested_row(
        &mut self,
        row: &Arc<Row>,
        args: &[Value<T>],
        span: Span,
    ) -> Option<Result<Value<T>, CallError>> {
        if self.refined.counts.is_empty() {
            return None;
        }
        let Some(Value::Number(n)) = args.last() else { return None };
        let coarse = *self.refined.counts.get(&n.re().to_bits())?;
        if row.name == "redist" {
            self.redistributed(args, coarse, span);
        }
        let (steps, cells) = steps_of(&row.name)?;
        let mut coarse_args = args.to_vec();
        *coarse_args.last_mut()? = Value::Number(T::from(coarse));
        for &k in steps {
            let Some(Value::Number(step)) = args.get(k) else { continue };
            match self.refined.steps.get(&step.re().to_bits()) {
                Some(coarse) => coarse_args[k] = Value::Number(*coarse),
                None if step.re() == 0.0 => {}
                None => {
                    let message = format!(
                        "the points of the coarse run are not among those of this {}",
                        row.name
                    );
                    self.report(
                        Diagnostic::remark("not-nested", message)
                            .at(span)
                            .help("give its steps as refined_step(ds)"),
                    );
                    return None;
                }
            }
        }
        if !cells {
            return None;
        }
        let halvings = self.inputs.settings.refine;
        Some(T::call(row, &coarse_args, &self.run.graph().context()).map(|value| {
            let Value::Numbers(array) = &value else { return value };
            let mut items = array.items.clone();
            for _ in 0..halvings {
                items = halved(&items);
            }
            Value::Numbers(Arc::new(moldloft_registry::Array::row(items)))
        }))
    }
}
