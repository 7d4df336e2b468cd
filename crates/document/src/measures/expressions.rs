//! Values of expressions, panels and hydrostatics of a model, and their derivatives.

use crate::document::{Document, ObjectSource};
use crate::measures::bodied::{Numbers, Whole};
use crate::set::coefficient_name;
use indexmap::IndexMap;
use moldloft_diag::Diagnostic;
use moldloft_hydro::USUAL_ACCURACY;
use moldloft_lang::run::interpreter::Inputs;
use moldloft_lang::run::program::RunContext;
use moldloft_lang::run::whole::{body_numbers, mesh_numbers, not_finite, one_of};
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

    /// The numbers of `mesh` or `hydrostatics`, cached until the model changes: most callers read
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
        let numbers = if group == "mesh" {
            mesh_numbers(&self.entire_panels()?.mesh)
        } else {
            let bodied = self.bodied(USUAL_ACCURACY)?;
            body_numbers(&bodied.body, &bodied.skin, &symmetry, self.partial())?
        };
        self.whole.insert(group, Whole { clock, symmetry, numbers: numbers.clone() });
        Ok(numbers)
    }

    fn eval_in<T: Scalar>(
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
        let (value, remarks) = program.eval(evaluation, inputs, text)?;
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
    /// (surfaces); `None` if the model has an object `mesh` or `hydrostatics`.
    fn whole_name<'t>(&self, text: &'t str) -> Option<(&'static str, &'t str)> {
        let (group, number) = text.trim().rsplit_once('.')?;
        let word = number.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        let group = ["mesh", "hydrostatics"].into_iter().find(|g| *g == group)?;
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
            // The numbers of the whole model are computed once for all expressions.
            let mut known: HashMap<&str, Vec<(&'static str, Value<Dual4>)>> = HashMap::new();
            for (text, column) in expressions.iter().zip(&mut columns) {
                let value = match document.whole_name(text) {
                    Some((group, number)) if known.contains_key(group) => {
                        one_of(known[group].clone(), group, number).map_err(|d| vec![d])?
                    }
                    Some((group, number)) => {
                        let panelled = document.entire_panels().map_err(|d| vec![d])?;
                        let found = if group == "mesh" {
                            let mesh = panelled.panelling.mesh(&evaluation.graph);
                            mesh_numbers(&mesh.ok_or_else(|| vec![document.or_spent(no_mesh())])?)
                        } else {
                            let bodied = document.bodied(USUAL_ACCURACY).map_err(|d| vec![d])?;
                            let graph = &evaluation.graph;
                            let body = bodied.skin.body(&panelled.panelling, graph, USUAL_ACCURACY);
                            let body = body.ok_or_else(|| vec![document.or_spent(not_finite())])?;
                            let (symmetry, partial) = (document.symmetry(), document.partial());
                            body_numbers(&body, &bodied.skin, &symmetry, partial)
                                .map_err(|d| vec![d])?
                        };
                        known.insert(group, found.clone());
                        one_of(found, group, number).map_err(|d| vec![d])?
                    }
                    // A failure of the run with derivatives is known only here: its reason is
                    // added.
                    None => document.eval_in(evaluation, text).map_err(|mut found| {
                        if found.iter().any(|d| d.id == "blocked") {
                            found.extend(document.failures(evaluation));
                        }
                        found
                    })?,
                };
                for k in 0..count {
                    column.push(derivative_part(&value, k).ok_or_else(|| {
                        vec![
                            Diagnostic::error(
                                "not-a-number",
                                format!("`{text}` has no derivative"),
                            )
                            .expected("a number, a vector, or a row or grid of them")
                            .found(value.called()),
                        ]
                    })?);
                }
            }
            Ok(())
        })?;
        Ok(columns)
    }

    /// Derivatives of all mesh vertices: `[by][vertex]`.
    ///
    /// # Errors
    /// Errors in a name or in the mesh.
    pub fn jacobian(&mut self, by: &[String]) -> Result<Vec<Vec<Vec3>>, Vec<Diagnostic>> {
        let mut columns = Vec::with_capacity(by.len());
        self.passes(by, |document, evaluation, count| {
            let panelled = document.entire_panels().map_err(|d| vec![d])?;
            let positions = panelled.panelling.positions(&evaluation.graph);
            let positions = positions.ok_or_else(|| vec![document.or_spent(no_mesh())])?;
            for k in 0..count {
                columns.push(positions.iter().map(|p| p.map(|x| x.eps[k])).collect());
            }
            Ok(())
        })?;
        Ok(columns)
    }

    /// Runs the model with seeded numbers, four directions per pass, and calls the consumer with
    /// each pass and the number of its directions.
    pub(crate) fn passes(
        &mut self,
        by: &[String],
        mut each: impl FnMut(&mut Self, &mut Evaluation<Dual4>, usize) -> Result<(), Vec<Diagnostic>>,
    ) -> Result<(), Vec<Diagnostic>> {
        self.complete()?;
        let mut seeded_objects = HashSet::new();
        // Seeded names and seeds: a coefficient is seeded with the derivative of its number.
        let mut seeds: Vec<(&str, f64)> = Vec::with_capacity(by.len());
        for name in by {
            if self.params().iter().any(|p| p.name == *name) {
                seeds.push((name, 1.0));
                continue;
            }
            seeds.push(match coefficient_name(name) {
                Some((base, _)) => {
                    let found = self.coefficients(base).into_iter().find(|c| c.name == *name);
                    (base, found.map_or(0.0, |c| c.slope))
                }
                None => (name, 1.0),
            });
            let edit = self.literal(name, 0.0).map_err(|d| vec![d])?;
            let object = self.plain.graph.get(edit.key).expect("found just now");
            seeded_objects.insert(object.name.to_string());
        }
        let mut evaluation = self.dual.take().unwrap_or_default();
        let mut outcome = Ok(());
        for pass in seeds.chunks(4) {
            let seed = |name: &str, mut x: Dual4| {
                for (eps, (_, size)) in x.eps.iter_mut().zip(pass).filter(|(_, p)| p.0 == name) {
                    *eps = *size;
                }
                x
            };
            let unknowns = self.seeded_unknowns(&mut evaluation, &seed, &seeded_objects);
            let seed =
                |name: &str, x: Dual4| unknowns.get(name).copied().unwrap_or_else(|| seed(name, x));
            self.evaluate(&mut evaluation, &seed, &seeded_objects, false);
            // Objects that an interrupted run did not reach would look like missing ones.
            if let Err(spent) = self.budget().poll() {
                outcome = Err(vec![unplaced(&CallError::from(spent))]);
                break;
            }
            outcome = each(self, &mut evaluation, pass.len());
            if outcome.is_err() {
                break;
            }
        }
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

/// The derivative in direction `k`, in the shape of the value.
fn derivative_part(value: &Value<Dual4>, k: usize) -> Option<Value<f64>> {
    use moldloft_registry::{Array, Vectors};
    use std::sync::Arc;
    let part = |x: Dual4| x.eps[k];
    Some(match value {
        Value::Number(x) => Value::Number(part(*x)),
        Value::Vector(v) => Value::Vector(v.map(part)),
        Value::Point(p) => Value::Vector(p.xyz.map(part)),
        Value::Numbers(a) => Value::Numbers(Arc::new(Array {
            shape: a.shape,
            items: a.items.iter().map(|&x| part(x)).collect(),
        })),
        Value::Vectors(a) => {
            let planes = a.planes.each_ref().map(|p| p.iter().map(|&x| part(x)).collect());
            Value::Vectors(Arc::new(Vectors { shape: a.shape, planes }))
        }
        Value::List(items) => {
            let parts: Option<Vec<_>> = items.iter().map(|v| derivative_part(v, k)).collect();
            Value::list(parts?)
        }
        Value::Block(layers) => {
            let parts: Option<Vec<_>> = layers.iter().map(|v| derivative_part(v, k)).collect();
            Value::block(parts?)?
        }
        _ => return None,
    })
}
