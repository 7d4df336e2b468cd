//! Values of expressions, panels and hydrostatics of a model, and their derivatives.

use crate::document::{Document, ObjectSource};
use crate::measures::bodied::{Numbers, Whole};
use crate::set::coefficient_name;
use indexmap::IndexMap;
use moldloft_diag::Diagnostic;
use moldloft_hydro::USUAL_ACCURACY;
use moldloft_lang::RunScalar;
use moldloft_lang::run::interpreter::Inputs;
use moldloft_lang::run::program::RunContext;
use moldloft_lang::run::whole::{WHOLE_GROUPS, body_numbers, not_finite, one_of, panel_numbers};
use moldloft_lang::source::env::Evaluation;
use moldloft_lang::source::fault_location::unplaced;
use moldloft_lang::value::variables::Called as _;
use moldloft_num::{Dual4, Vec3};
use moldloft_registry::{CallError, Scalar, Value};
use std::collections::{HashMap, HashSet};

impl Document {
    /// The value of an expression in the names of the model, `mesh.area`, `mesh.volume` and the
    /// numbers of the hydrostatics, such as `hydrostatics.volume`.
    ///
    /// # Errors
    /// The errors of the expression.
    pub fn eval(&mut self, text: &str) -> Result<Value<f64>, Vec<Diagnostic>> {
        self.complete()?;
        self.expression_remarks.clear();
        if let Some((group, number)) = self.whole_name(text) {
            let found = self.whole_numbers(group).map_err(|d| vec![d])?;
            return one_of(found, group, number).map_err(|d| vec![d]);
        }
        let mut evaluation = std::mem::take(&mut self.plain);
        let value = self.eval_in(&mut evaluation, text);
        self.plain = evaluation;
        value
    }

    /// Warnings about the last value of [`Document::eval`], such as a volume that misses its
    /// accuracy.
    pub fn expression_remarks(&self) -> &[Diagnostic] {
        &self.expression_remarks
    }

    /// The numbers of one of [`WHOLE_GROUPS`], cached until the model changes: most callers read
    /// several.
    fn whole_numbers(&mut self, group: &'static str) -> Result<Numbers, Diagnostic> {
        let clock = self.plain.graph.last_change();
        let symmetry = self.symmetry();
        if let Some(known) = self.whole.get(group)
            && known.clock == clock
            && known.symmetry == symmetry
        {
            return Ok(known.numbers.clone());
        }
        let numbers = if group != "hydrostatics" {
            panel_numbers(group, &self.entire_panels()?.mesh)
        } else {
            let bodied = self.bodied(USUAL_ACCURACY)?;
            body_numbers(&bodied.body, &bodied.skin, &symmetry, self.partial())?
        };
        self.whole.insert(group, Whole { clock, symmetry, numbers: numbers.clone() });
        Ok(numbers)
    }

    pub(crate) fn eval_in<T: RunScalar>(
        &mut self,
        evaluation: &mut Evaluation<T>,
        text: &str,
    ) -> Result<Value<T>, Vec<Diagnostic>> {
        let seeded_objects = HashSet::new();
        let no_overrides = IndexMap::new();
        let budget = self.budget();
        let inputs = Inputs {
            overrides: &no_overrides,
            seed: &|_, x| x,
            seeded_objects: &seeded_objects,
            budget: &budget,
            settings: self.settings,
        };
        let program = RunContext {
            modules: &mut self.modules,
            world: &*self.world,
            registry: &self.registry,
            sources: &mut self.sources,
            sketch: None,
            converted: moldloft_lang::model_file::converted,
        };
        let (value, remarks) = T::eval(program, evaluation, inputs, text)?;
        self.expression_remarks = remarks;
        // Array statements may compute with infinity, as in programs of 1992; it is not a result.
        let finite = match &value {
            Value::Number(x) => x.is_finite(),
            Value::Vector(v) => v.is_finite(),
            _ => true,
        };
        let alone = match &value {
            Value::Number(x) => x.re().is_finite(),
            Value::Vector(v) => v.re().is_finite(),
            _ => true,
        };
        if !finite && alone {
            let message = format!("`{}` has no derivative here", text.trim());
            let next =
                "it may have one on each side: change the parameter a little, or take differences";
            return Err(vec![Diagnostic::error("no-derivative", message).help(next)]);
        }
        if !finite {
            let message = format!("`{}` is not a finite number", text.trim());
            return Err(vec![Diagnostic::error("not-finite", message).expected("a finite number")]);
        }
        Ok(value)
    }

    /// Group and member of a name such as `mesh.area` (joined panels) or `hydrostatics.volume`
    /// (surfaces); `None` if the model has an object of the group's name.
    pub(crate) fn whole_name<'t>(&self, text: &'t str) -> Option<(&'static str, &'t str)> {
        let (group, number) = text.trim().rsplit_once('.')?;
        let word = number.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        let group = WHOLE_GROUPS.into_iter().find(|g| *g == group)?;
        (word && self.graph().find(group).is_none()).then_some((group, number))
    }

    /// Derivatives of expressions by parameters (or literals of objects): `[expression][by]`,
    /// each of the expression's own shape.
    ///
    /// # Errors
    /// Errors in an expression or a name.
    pub fn derivatives(
        &mut self,
        expressions: &[String],
        by: &[String],
    ) -> Result<Vec<Vec<Value<f64>>>, Vec<Diagnostic>> {
        let mut columns: Vec<Vec<Value<f64>>> = vec![Vec::new(); expressions.len()];
        self.passes(by, |document, evaluation, count| {
            let mut known = Wholes::default();
            for (text, column) in expressions.iter().zip(&mut columns) {
                let value = document.value_in_pass(evaluation, text, &mut known)?;
                for k in 0..count {
                    let part = derivative_part(&value, k);
                    column.push(part.ok_or_else(|| vec![not_numbers(text, &value)])?);
                }
            }
            Ok(())
        })?;
        Ok(columns)
    }

    /// The value of an expression in a pass. The numbers of the whole model are found once for all expressions.
    pub(crate) fn value_in_pass(
        &mut self,
        evaluation: &mut Evaluation<Dual4>,
        text: &str,
        known: &mut Wholes,
    ) -> Result<Value<Dual4>, Vec<Diagnostic>> {
        let Some((group, number)) = self.whole_name(text) else {
            // The reason why derivatives alone failed is known only here, so it is passed on.
            return self.eval_in(evaluation, text).map_err(|mut found| {
                if found.iter().any(|d| d.id == "blocked") {
                    found.extend(self.failures(evaluation));
                }
                found
            });
        };
        if !known.contains_key(group) {
            let panelled = self.entire_panels().map_err(|d| vec![d])?;
            let found = if group != "hydrostatics" {
                let mesh = panelled.panelling.mesh(&evaluation.graph);
                panel_numbers(group, &mesh.ok_or_else(|| vec![self.or_spent(no_mesh())])?)
            } else {
                let bodied = self.bodied(USUAL_ACCURACY).map_err(|d| vec![d])?;
                let graph = &evaluation.graph;
                let body = bodied.skin.body(&panelled.panelling, graph, USUAL_ACCURACY);
                let body = body.ok_or_else(|| vec![self.or_spent(not_finite())])?;
                let (symmetry, partial) = (self.symmetry(), self.partial());
                body_numbers(&body, &bodied.skin, &symmetry, partial).map_err(|d| vec![d])?
            };
            known.insert(group, found);
        }
        one_of(known[group].clone(), group, number).map_err(|d| vec![d])
    }

    /// Derivatives of all mesh vertices: `[by][vertex]`.
    ///
    /// # Errors
    /// Errors in a name or in the mesh.
    pub fn jacobian(&mut self, by: &[String]) -> Result<Vec<Vec<Vec3>>, Vec<Diagnostic>> {
        let mut columns = Vec::with_capacity(by.len());
        self.passes(by, |document, evaluation, count| {
            let positions = document.vertices_in_pass(evaluation)?;
            for k in 0..count {
                columns.push(positions.iter().map(|p| p.map(|x| x.eps[k])).collect());
            }
            Ok(())
        })?;
        Ok(columns)
    }

    /// The vertices of the mesh in a pass.
    pub(crate) fn vertices_in_pass(
        &mut self,
        evaluation: &Evaluation<Dual4>,
    ) -> Result<Vec<Vec3<Dual4>>, Vec<Diagnostic>> {
        let panelled = self.entire_panels().map_err(|d| vec![d])?;
        let positions = panelled.panelling.positions(&evaluation.graph);
        positions.ok_or_else(|| vec![self.or_spent(no_mesh())])
    }

    /// The seeded numbers of derivatives by these names.
    ///
    /// # Errors
    /// A name that is no parameter and no number.
    pub(crate) fn seeds(&mut self, by: &[String]) -> Result<Seeds, Vec<Diagnostic>> {
        let mut seeds = Seeds::default();
        for (direction, name) in by.iter().enumerate() {
            let mut add = |base: &str, rate: f64| {
                seeds.rates.entry(base.to_owned()).or_default().push((direction, rate));
            };
            if self.params().iter().any(|p| p.name == *name) {
                add(name, 1.0);
                continue;
            }
            match coefficient_name(name) {
                // A coefficient counts by what it does to its number.
                Some((base, _)) => {
                    let found = self.coefficients(base).into_iter().find(|c| c.name == *name);
                    add(base, found.map_or(0.0, |c| c.slope));
                }
                None => add(name, 1.0),
            }
            let edit = self.literal(name, 0.0).map_err(|d| vec![d])?;
            let object = self.plain.graph.get(edit.key).expect("found just now");
            seeds.objects.insert(object.name.to_string());
        }
        Ok(seeds)
    }

    /// Runs the model with seeded numbers, four directions per pass, and calls the consumer with
    /// each pass and the number of its directions.
    pub(crate) fn passes(
        &mut self,
        by: &[String],
        mut each: impl FnMut(&mut Self, &mut Evaluation<Dual4>, usize) -> Result<(), Vec<Diagnostic>>,
    ) -> Result<(), Vec<Diagnostic>> {
        self.complete()?;
        let seeds = self.seeds(by)?;
        for from in (0..by.len()).step_by(4) {
            let rate = |direction: usize| {
                let mut eps = [0.0; 4];
                if let Some(e) = direction.checked_sub(from).and_then(|k| eps.get_mut(k)) {
                    *e = 1.0;
                }
                eps
            };
            let count = (by.len() - from).min(4);
            self.pass(&seeds, &rate, |document, evaluation| each(document, evaluation, count))?;
        }
        Ok(())
    }

    /// Runs the model once, with the numbers of direction k seeded by `rates(k)`, and hands the run on.
    pub(crate) fn pass(
        &mut self,
        seeds: &Seeds,
        rates: &(dyn Fn(usize) -> [f64; 4] + Sync),
        each: impl FnOnce(&mut Self, &mut Evaluation<Dual4>) -> Result<(), Vec<Diagnostic>>,
    ) -> Result<(), Vec<Diagnostic>> {
        let seed = |name: &str, mut x: Dual4| {
            for &(direction, rate) in seeds.of(name) {
                let by = rates(direction);
                x.eps.iter_mut().zip(by).for_each(|(eps, by)| *eps += rate * by);
            }
            x
        };
        let mut evaluation = self.dual.take().unwrap_or_default();
        let unknowns = self.seeded_unknowns(&mut evaluation, &seed, &seeds.objects);
        let seed =
            |name: &str, x: Dual4| unknowns.get(name).copied().unwrap_or_else(|| seed(name, x));
        self.evaluate(&mut evaluation, &seed, &seeds.objects, false);
        // Values that this run did not reach would look like missing ones.
        let outcome = match self.budget().poll() {
            Err(spent) => Err(vec![unplaced(&CallError::from(spent))]),
            Ok(()) => each(self, &mut evaluation),
        };
        self.dual = Some(evaluation);
        outcome
    }

    /// The options of the model's hydrostatics: water at z = 0, mirrored as its header says.
    pub fn hydrostatic_options(&self) -> crate::measures::hydrostatics::HydrostaticsOptions {
        crate::measures::hydrostatics::HydrostaticsOptions {
            mirrored: self.symmetry().contains('y'),
            ..Default::default()
        }
    }

    /// True when objects come from a program.
    pub fn is_program(&self) -> bool {
        matches!(self.source, ObjectSource::Program)
    }
}

pub(crate) fn no_mesh() -> Diagnostic {
    Diagnostic::error("no-mesh", "the model has no panels")
        .help("declare a surface, and show it (visible = 1)")
}

/// Numbers of the whole model, found in a pass.
pub(crate) type Wholes = HashMap<&'static str, Vec<(&'static str, Value<Dual4>)>>;

/// Numbers that derivatives are by.
#[derive(Debug, Default)]
pub(crate) struct Seeds {
    /// The directions in which a number is seeded, and the rates.
    rates: HashMap<String, Vec<(usize, f64)>>,
    /// The objects that have some of them.
    pub objects: HashSet<String>,
}

impl Seeds {
    /// The directions in which the number of that name is seeded, and the rates.
    pub fn of(&self, name: &str) -> &[(usize, f64)] {
        self.rates.get(name).map_or(&[], Vec::as_slice)
    }
}

/// The fault of an expression whose derivatives would be none.
pub(crate) fn not_numbers<T: Scalar>(text: &str, value: &Value<T>) -> Diagnostic {
    Diagnostic::error("not-a-number", format!("`{text}` has no derivative"))
        .expected("a number, a vector, or a row or grid of them")
        .found(value.called())
}

/// True for a number, a vector, a point, and arrays and lists of them.
pub(crate) fn is_numbers<T: Scalar>(value: &Value<T>) -> bool {
    match value {
        Value::List(items) | Value::Block(items) => items.iter().all(is_numbers),
        Value::Number(_)
        | Value::Vector(_)
        | Value::Point(_)
        | Value::Numbers(_)
        | Value::Vectors(_) => true,
        _ => false,
    }
}

/// The derivative in direction `k`, in the shape of the value.
fn derivative_part(value: &Value<Dual4>, k: usize) -> Option<Value<f64>> {
    is_numbers(value).then(|| value.map_numbers(&mut |x: Dual4| x.eps[k]))?
}
