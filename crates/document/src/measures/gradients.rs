//! Products with Jacobians: gradients of weighted sums by many inputs (vector-Jacobian products), and changes of outputs in
//! one direction (Jacobian-vector products).
//!
//! A gradient is found in reverse mode, at the cost of a few evaluations for any number of inputs; in forward mode where
//! inputs are few, and for what has no reverse mode. Both give the same numbers.

use crate::document::Document;
use crate::measures::expressions::{Wholes, is_numbers, not_numbers};
use crate::measures::pulled::Pulled;
use crate::set::LiteralPlace;
use moldloft_diag::Diagnostic;
use moldloft_lang::source::env::Evaluation;
use moldloft_num::{Dual4, Real, Vec3};
use moldloft_registry::{Class, Scalar, Value};

/// Number of inputs up to which forward mode takes less time.
const FEW_INPUTS: usize = 8;

/// The same number for hydrostatic figures, whose reverse sweep records the skin cell by cell.
const FEW_INPUTS_AFLOAT: usize = 16;

/// An output with the weights of its numbers in each of some sums.
#[derive(Clone, Debug, PartialEq)]
pub struct WeightedOutput {
    /// `mesh` or `blocks` for the vertices, or an expression.
    pub name: String,
    /// For each sum the weights of all numbers of the output, in their order in memory.
    pub weights: Vec<Vec<f64>>,
}

/// Method of computing a gradient.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GradientMode {
    /// As takes less time.
    #[default]
    Automatic,
    /// Four inputs at a time.
    Forward,
    /// All inputs at once where all has a reverse mode.
    Reverse,
}

/// The gradients of some sums.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradients {
    /// For each sum, its derivatives with respect to the inputs.
    pub rows: Vec<Vec<f64>>,
    /// The outputs that required forward mode.
    pub forward: Vec<String>,
}

impl Document {
    /// The derivatives of weighted sums of outputs by parameters or literals of objects: `[sum][by]`.
    ///
    /// # Errors
    /// What is wrong with an output, its weights or a name.
    pub fn vjp(
        &mut self,
        outputs: &[WeightedOutput],
        by: &[String],
        mode: GradientMode,
    ) -> Result<Gradients, Vec<Diagnostic>> {
        self.complete()?;
        let sums = outputs.first().map_or(0, |output| output.weights.len());
        let mut rows = vec![vec![0.0; by.len()]; sums];
        let floats = |output: &&WeightedOutput| {
            self.whole_name(&output.name).is_some_and(|(group, _)| group == "hydrostatics")
        };
        let forward = |output: &&WeightedOutput| match mode {
            GradientMode::Automatic => {
                by.len() <= if floats(output) { FEW_INPUTS_AFLOAT } else { FEW_INPUTS }
            }
            GradientMode::Forward => true,
            GradientMode::Reverse => false,
        };
        let (mut ahead, back): (Vec<_>, Vec<_>) = outputs.iter().partition(forward);
        let (floating, mut back): (Vec<_>, Vec<_>) = back.into_iter().partition(floats);
        // What of the skin is measured on panels is found with them.
        let on_panels;
        if !floating.is_empty() {
            match self.pulled_floating(&floating, by)? {
                Some((pulled, vertices)) => {
                    add_rows(&mut rows, &pulled);
                    on_panels = vertices;
                    back.extend(&on_panels);
                }
                None => ahead.extend(floating),
            }
        }
        while !back.is_empty() {
            match self.pulled(&back, by)? {
                Pulled::Gradients(pulled) => {
                    add_rows(&mut rows, &pulled);
                    break;
                }
                Pulled::Refused(names) => {
                    let refused = |output: &&WeightedOutput| names.contains(&output.name);
                    let (refused, rest): (Vec<_>, Vec<_>) = back.into_iter().partition(refused);
                    ahead.extend(refused);
                    back = rest;
                }
            }
        }
        if !ahead.is_empty() || by.is_empty() {
            add_rows(&mut rows, &self.pushed(&ahead, by, sums)?);
        }
        let forward = ahead.iter().map(|output| output.name.clone()).collect();
        Ok(Gradients { rows, forward })
    }

    /// Gradients by forward mode.
    fn pushed(
        &mut self,
        outputs: &[&WeightedOutput],
        by: &[String],
        sums: usize,
    ) -> Result<Vec<Vec<f64>>, Vec<Diagnostic>> {
        let mut rows = vec![Vec::with_capacity(by.len()); sums];
        self.passes(by, |document, evaluation, count| {
            let mut known = Wholes::default();
            let mut found = vec![[0.0; 4]; sums];
            for output in outputs {
                let numbers = document.numbers_in_pass(evaluation, &output.name, &mut known)?;
                for (found, weights) in found.iter_mut().zip(output.checked(numbers.len())?) {
                    for (x, w) in numbers.iter().zip(weights).filter(|(_, w)| **w != 0.0) {
                        found.iter_mut().zip(x.eps).for_each(|(f, eps)| *f += w * eps);
                    }
                }
            }
            for (row, found) in rows.iter_mut().zip(found) {
                row.extend(&found[..count]);
            }
            Ok(())
        })?;
        Ok(rows)
    }

    /// Directional derivatives of outputs (all numbers of each) when the inputs change at these
    /// rates.
    ///
    /// # Errors
    /// What is wrong with an output or a name.
    pub fn jvp(
        &mut self,
        outputs: &[String],
        directions: &[(String, f64)],
    ) -> Result<Vec<Vec<f64>>, Vec<Diagnostic>> {
        self.complete()?;
        let names: Vec<String> = directions.iter().map(|(name, _)| name.clone()).collect();
        let seeds = self.seeds(&names)?;
        let rates = |direction: usize| [directions[direction].1, 0.0, 0.0, 0.0];
        let mut changes = Vec::with_capacity(outputs.len());
        self.pass(&seeds, &rates, |document, evaluation| {
            let mut known = Wholes::default();
            for output in outputs {
                let numbers = document.numbers_in_pass(evaluation, output, &mut known)?;
                changes.push(numbers.iter().map(|x| x.eps[0]).collect());
            }
            Ok(())
        })?;
        Ok(changes)
    }

    /// All numbers of an output in a pass.
    fn numbers_in_pass(
        &mut self,
        evaluation: &mut Evaluation<Dual4>,
        name: &str,
        known: &mut Wholes,
    ) -> Result<Vec<Dual4>, Vec<Diagnostic>> {
        let flat = |points: Vec<Vec3<Dual4>>| points.iter().flat_map(|p| p.to_array()).collect();
        match name {
            "mesh" => self.vertices_in_pass(evaluation).map(flat),
            "blocks" => self.block_vertices_in_pass(evaluation).map(flat),
            _ => {
                let value = self.value_in_pass(evaluation, name, known)?;
                numbers(&value).ok_or_else(|| vec![not_numbers(name, &value)])
            }
        }
    }

    /// The names of the literals with respect to which the model can be differentiated, in the
    /// order of declaration: numbers in the arguments of objects, without counts and other
    /// integers.
    pub fn literals(&self) -> Vec<String> {
        let mut found = Vec::new();
        for object in self.plain.graph.objects() {
            let fields = object.row.fields.iter().zip(&object.args);
            for (field, value) in fields.filter(|(field, _)| field.class != Class::Integer) {
                let base = format!("{}.{}", object.name, field.name);
                let mut names = Vec::new();
                number_names(&base, value, field.many, &mut names);
                found.extend(names.into_iter().filter(|name| self.is_own_literal(name)));
            }
        }
        found
    }

    /// True for a literal of the text itself, not of a file that it loads.
    fn is_own_literal(&self, name: &str) -> bool {
        match self.literal(name, 0.0).map(|edit| edit.place) {
            Ok(LiteralPlace::Program((module, _))) => module == 0,
            Ok(LiteralPlace::ModelFile(_)) => true,
            Err(_) => false,
        }
    }

    /// A version number that changes whenever derivatives may change: with values, parameters or
    /// the text.
    pub fn state(&self) -> u64 {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hasher = DefaultHasher::new();
        (self.plain.graph.last_change(), self.text()).hash(&mut hasher);
        for (name, value) in &self.overrides {
            (name, value.to_bits()).hash(&mut hasher);
        }
        hasher.finish()
    }
}

impl WeightedOutput {
    /// The weights of an output with `count` numbers.
    ///
    /// # Errors
    /// When there are more or fewer.
    pub(crate) fn checked(&self, count: usize) -> Result<&[Vec<f64>], Vec<Diagnostic>> {
        match self.weights.iter().find(|weights| weights.len() != count) {
            None => Ok(&self.weights),
            Some(weights) => Err(vec![
                Diagnostic::error(
                    "wrong-shape",
                    format!("the weights of `{}` do not fit it", self.name),
                )
                .expected(format!("{count}, one for each of its numbers"))
                .found(weights.len().to_string()),
            ]),
        }
    }
}

/// All numbers of a value in the order in which an array of it has them; `None` when it is more than numbers.
pub(crate) fn numbers<T: Scalar>(value: &Value<T>) -> Option<Vec<T>> {
    if !is_numbers(value) {
        return None;
    }
    let Value::Block(layers) = value else { return value.numbers() };
    // An array has the axis of the layers last, before that of coordinates.
    let layers: Vec<Vec<T>> = layers.iter().map(Value::numbers).collect::<Option<_>>()?;
    let size = match value {
        Value::Block(layers) if matches!(layers.first(), Some(Value::Vectors(_))) => 3,
        _ => 1,
    };
    let count = layers.first().map_or(0, Vec::len) / size;
    Some(
        (0..count)
            .flat_map(|at| layers.iter().flat_map(move |layer| &layer[at * size..][..size]))
            .copied()
            .collect(),
    )
}

/// The names of the numbers in an argument.
fn number_names<T: Real>(base: &str, value: &Value<T>, many: bool, names: &mut Vec<String>) {
    match value {
        Value::Number(_) => names.push(base.to_owned()),
        Value::Vector(_) if many => names.extend((1..=3).map(|k| format!("{base}[{k}]"))),
        Value::Vector(_) => names.extend(["x", "y", "z"].map(|axis| format!("{base}.{axis}"))),
        Value::List(items) if many => {
            for (k, item) in items.iter().enumerate() {
                number_names(&format!("{base}[{}]", k + 1), item, false, names);
            }
        }
        _ => {}
    }
}

fn add_rows(rows: &mut [Vec<f64>], more: &[Vec<f64>]) {
    for (row, more) in rows.iter_mut().zip(more) {
        row.iter_mut().zip(more).for_each(|(x, more)| *x += more);
    }
}
