//! Reverse mode: the model is run with numbers of a tape, and weights of its outputs are pulled back to its inputs.
//!
//! `inputs -> run (one thread) -> expressions, blocks -> panels a part at a time -> Adjoints -> gradients`
//!
//! Run, graph and tape live for one gradient. What a tape cannot do is no error: the outputs that need it are named, and
//! forward mode has the last word, also on what is wrong with the model.

use crate::document::{Document, Panelled};
use crate::measures::expressions::Seeds;
use crate::measures::gradients::{WeightedOutput, numbers};
use indexmap::IndexMap;
use moldloft_diag::Diagnostic;
use moldloft_hydro::USUAL_ACCURACY;
use moldloft_lang::SolveStatus;
use moldloft_lang::run::program::STACK_BYTES;
use moldloft_lang::source::env::Evaluation;
use moldloft_lang::source::fault_location::unplaced;
use moldloft_mesh::{Mesh, pulled_measures, pulled_quality};
use moldloft_num::{Adjoints, DerivativeTape, Real, Rev, Vec3, solve_pivoting_fully};
use moldloft_parallel::on_one_thread;
use moldloft_registry::CallError;
use std::collections::HashSet;
use std::sync::Arc;

/// The mesh with the weights of its vertices in each sum.
struct WeightedMesh {
    panelled: Arc<Panelled>,
    weights: Vec<Vec<Vec3>>,
    /// The outputs that they are of.
    names: Vec<String>,
}

/// An attempt to find gradients by reverse mode.
pub(crate) enum Pulled {
    /// The gradients of all sums.
    Gradients(Vec<Vec<f64>>),
    /// The names of some outputs that have no reverse mode.
    Refused(Vec<String>),
}

/// Gradients of sums, and the vertices on whose panels a part of the figures is measured, with their weights.
pub(crate) type PulledFigures = (Vec<Vec<f64>>, Option<WeightedOutput>);

/// Outputs that are the mesh's, and all others.
type Split<'a> = (Option<WeightedMesh>, Vec<&'a WeightedOutput>);

impl Document {
    /// The gradients of the sums of outputs by reverse mode, if all of them have one.
    ///
    /// # Errors
    /// What is wrong with an output, its weights or a name.
    pub(crate) fn pulled(
        &mut self,
        outputs: &[&WeightedOutput],
        by: &[String],
    ) -> Result<Pulled, Vec<Diagnostic>> {
        let seeds = self.seeds(by)?;
        let (mesh, others) = self.split(outputs)?;
        let sums = outputs.first().map_or(0, |output| output.weights.len());
        let all = || outputs.iter().map(|output| output.name.clone()).collect();
        let pulled = on_one_thread(STACK_BYTES, || {
            DerivativeTape::clear();
            let inputs: Vec<Rev> = by.iter().map(|_| DerivativeTape::input(0.0)).collect();
            let mut adjoints = vec![Adjoints::new(); sums];
            let refused = self.recorded(&seeds, &inputs, mesh.as_ref(), &others, &mut adjoints)?;
            if let Some(names) = refused {
                return Ok(Pulled::Refused(if names.is_empty() { all() } else { names }));
            }
            let rows = gradients(&mut adjoints, &inputs);
            Ok(rows.map_or_else(|| Pulled::Refused(all()), Pulled::Gradients))
        });
        pulled.unwrap_or_else(|| Ok(Pulled::Refused(all())))
    }

    /// The weights of vertices, those that follow from measures of the mesh included; and the other outputs.
    fn split<'a>(&mut self, outputs: &[&'a WeightedOutput]) -> Result<Split<'a>, Vec<Diagnostic>> {
        let mut mesh: Option<WeightedMesh> = None;
        let mut others = Vec::new();
        for output in outputs {
            let rates = match self.whole_name(&output.name) {
                Some((group, number)) if group != "hydrostatics" => {
                    let panelled = self.entire_panels().map_err(|d| vec![d])?;
                    slopes_by_vertices(&panelled.mesh, group, number)
                }
                _ => None,
            };
            if rates.is_none() && output.name != "mesh" {
                others.push(*output);
                continue;
            }
            if mesh.is_none() {
                let panelled = self.entire_panels().map_err(|d| vec![d])?;
                let none = vec![Vec3::zero(); panelled.mesh.positions().len()];
                let weights = vec![none; output.weights.len()];
                mesh = Some(WeightedMesh { panelled, weights, names: Vec::new() });
            }
            let Some(WeightedMesh { panelled, weights, names }) = &mut mesh else { continue };
            names.push(output.name.clone());
            let count = if rates.is_some() { 1 } else { 3 * panelled.mesh.positions().len() };
            let given = output.checked(count)?;
            for (weights, given) in weights.iter_mut().zip(given) {
                for (at, weight) in weights.iter_mut().enumerate() {
                    *weight += match &rates {
                        Some(rates) => rates[at] * given[0],
                        None => Vec3::of(given[3 * at], given[3 * at + 1], given[3 * at + 2]),
                    };
                }
            }
        }
        Ok((mesh, others))
    }

    /// Runs the model on the tape of this thread and adds the outputs; returns the names of those
    /// without reverse mode; empty if the model itself has no reverse mode.
    fn recorded(
        &mut self,
        seeds: &Seeds,
        inputs: &[Rev],
        mesh: Option<&WeightedMesh>,
        others: &[&WeightedOutput],
        adjoints: &mut [Adjoints],
    ) -> Result<Option<Vec<String>>, Vec<Diagnostic>> {
        let Some(mut evaluation) = self.taped_run(seeds, inputs)? else {
            return Ok(Some(Vec::new()));
        };
        let budget = self.budget();
        let spent = || budget.poll().map_err(|spent| vec![unplaced(&CallError::from(spent))]);
        for output in others {
            let numbers = self.taped_numbers(&mut evaluation, &output.name)?;
            spent()?;
            // Results that are kept for later outputs may depend on what the tape does not have.
            let sound = |numbers: &Vec<Rev>| {
                DerivativeTape::is_sound() && numbers.iter().all(|x| x.is_finite())
            };
            let Some(numbers) = numbers.filter(sound) else {
                return Ok(Some(vec![output.name.clone()]));
            };
            for (adjoints, weights) in adjoints.iter_mut().zip(output.checked(numbers.len())?) {
                numbers.iter().zip(weights).for_each(|(x, w)| adjoints.add(*x, *w));
            }
        }
        let Some(WeightedMesh { panelled, weights, names }) = mesh else { return Ok(None) };
        let pulled = panelled.panelling.pull(&evaluation.graph, weights, adjoints);
        spent()?;
        Ok((pulled.is_none() || !DerivativeTape::is_sound()).then(|| names.clone()))
    }

    /// The model on the tape of this thread; `None` when it has no reverse mode.
    fn taped_run(
        &mut self,
        seeds: &Seeds,
        inputs: &[Rev],
    ) -> Result<Option<Evaluation<Rev>>, Vec<Diagnostic>> {
        let seed = |name: &str, x: Rev| seeded(x, seeds.of(name), inputs);
        let mut evaluation = Evaluation::<Rev>::default();
        let unknowns = self.taped_unknowns(&mut evaluation, &seed, &seeds.objects);
        let seed =
            |name: &str, x: Rev| unknowns.get(name).copied().unwrap_or_else(|| seed(name, x));
        self.evaluate(&mut evaluation, &seed, &seeds.objects, false);
        // Outputs that this run did not reach would look like outputs without reverse mode.
        self.budget().poll().map_err(|spent| vec![unplaced(&CallError::from(spent))])?;
        Ok(DerivativeTape::is_sound().then_some(evaluation))
    }

    /// The gradients of sums of hydrostatic figures, and the weights of vertices that what is
    /// measured on panels leaves; `None` when they have no reverse mode.
    ///
    /// # Errors
    /// As [`Document::pulled`].
    pub(crate) fn pulled_floating(
        &mut self,
        outputs: &[&WeightedOutput],
        by: &[String],
    ) -> Result<Option<PulledFigures>, Vec<Diagnostic>> {
        let seeds = self.seeds(by)?;
        let mut figures: Vec<Vec<(&str, f64)>> = Vec::new();
        for output in outputs {
            // An unknown name is an error here.
            self.eval(&output.name)?;
            let name = self.whole_name(&output.name).map_or("", |(_, number)| number);
            let weights = output.checked(1)?;
            figures.resize(weights.len(), Vec::new());
            figures.iter_mut().zip(weights).for_each(|(sum, w)| sum.push((name, w[0])));
        }
        let bodied = self.bodied(USUAL_ACCURACY).map_err(|d| vec![d])?;
        let panelled = self.entire_panels().map_err(|d| vec![d])?;
        let mirrors = self.mirrors();
        type Found = Option<(Vec<Vec<f64>>, Vec<Vec<Vec3>>)>;
        let pulled = on_one_thread(STACK_BYTES, || -> Result<Found, Vec<Diagnostic>> {
            DerivativeTape::clear();
            DerivativeTape::probe();
            let inputs: Vec<Rev> = by.iter().map(|_| DerivativeTape::input(0.0)).collect();
            let Some(evaluation) = self.taped_run(&seeds, &inputs)? else { return Ok(None) };
            let mut adjoints = vec![Adjoints::new(); figures.len()];
            let vertices = bodied.skin.pull_hydrostatics(
                &panelled.mesh,
                &evaluation.graph,
                bodied.accuracy,
                &mirrors,
                &figures,
                &mut adjoints,
            );
            let Some(vertices) = vertices.filter(|_| DerivativeTape::is_sound()) else {
                return Ok(None);
            };
            Ok(gradients(&mut adjoints, &inputs).map(|rows| (rows, vertices)))
        });
        let Some((rows, vertices)) = pulled.unwrap_or(Ok(None))? else { return Ok(None) };
        let flat = |sum: Vec<Vec3>| sum.iter().flat_map(|w| w.to_array()).collect();
        let on_panels = bodied.skin.has_panels().then(|| WeightedOutput {
            name: "mesh".to_owned(),
            weights: vertices.into_iter().map(flat).collect(),
        });
        Ok(Some((rows, on_panels)))
    }

    /// The unknowns on the tape of this thread: x_j with the derivatives of -(J^-1)_ji c_i, by the conditions c at the
    /// solution (implicit function theorem).
    fn taped_unknowns(
        &mut self,
        evaluation: &mut Evaluation<Rev>,
        seed: &(dyn Fn(&str, Rev) -> Rev + Sync),
        seeded_objects: &HashSet<String>,
    ) -> IndexMap<String, Rev> {
        let reports = self.solved.clone();
        let solution = reports.iter().flat_map(|r| r.unknowns.iter().zip(&r.values));
        let mut known: IndexMap<String, Rev> =
            solution.map(|(name, x)| (name.clone(), Rev::from(*x))).collect();
        for (at, report) in reports.iter().enumerate() {
            if report.status != SolveStatus::Solved {
                continue;
            }
            let with =
                |name: &str, x: Rev| known.get(name).copied().unwrap_or_else(|| seed(name, x));
            self.evaluate(evaluation, &with, seeded_objects, false);
            let Some(solve) = evaluation.env.solves.get(at) else { continue };
            let mut terms = vec![Vec::new(); report.unknowns.len()];
            for (i, condition) in solve.conditions.iter().enumerate() {
                let unit: Vec<f64> =
                    (0..solve.conditions.len()).map(|k| f64::from(u8::from(k == i))).collect();
                let Some(changes) = solve_pivoting_fully(&report.jacobian, &unit) else { continue };
                for (terms, change) in terms.iter_mut().zip(changes) {
                    terms.push((-change, *condition));
                }
            }
            for (name, terms) in report.unknowns.iter().zip(&terms) {
                if let Some(x) = known.get_mut(name) {
                    *x = Rev::linear(x.re(), terms);
                }
            }
        }
        known
    }

    /// All numbers of an output on the tape; `None` when it has no reverse mode.
    fn taped_numbers(
        &mut self,
        evaluation: &mut Evaluation<Rev>,
        name: &str,
    ) -> Result<Option<Vec<Rev>>, Vec<Diagnostic>> {
        if name == "blocks" {
            let blocked = self.blocked().map_err(|d| vec![d])?;
            let positions = blocked.blocking.positions(&evaluation.graph);
            return Ok(positions.map(|all| all.iter().flat_map(|p| p.to_array()).collect()));
        }
        Ok(self.eval_in(evaluation, name).ok().and_then(|value| numbers(&value)))
    }
}

/// The derivatives of a number of the mesh by each vertex; `None` for numbers without this way.
fn slopes_by_vertices(mesh: &Mesh, group: &str, number: &str) -> Option<Vec<Vec3>> {
    match (group, number) {
        ("mesh", "area") => Some(pulled_measures(mesh, 1.0, 0.0)),
        ("mesh", "volume") => Some(pulled_measures(mesh, 0.0, 1.0)),
        ("mesh_quality", number) => pulled_quality(mesh, number),
        _ => None,
    }
}

/// The derivatives of all sums by the inputs; `None` when some are not finite.
fn gradients(adjoints: &mut [Adjoints], inputs: &[Rev]) -> Option<Vec<Vec<f64>>> {
    let row = |adjoints: &mut Adjoints| -> Vec<f64> {
        adjoints.pull();
        inputs.iter().map(|input| adjoints.of(*input)).collect()
    };
    let rows: Vec<Vec<f64>> = adjoints.iter_mut().map(row).collect();
    let finite = rows.iter().flatten().all(|x| x.is_finite());
    (finite && adjoints.iter().all(Adjoints::are_sound)).then_some(rows)
}

/// A number that the inputs of some directions are added to, each zero.
fn seeded(x: Rev, directions: &[(usize, f64)], inputs: &[Rev]) -> Rev {
    if directions.is_empty() {
        return x;
    }
    let mut terms = vec![(1.0, x)];
    terms.extend(directions.iter().map(|&(direction, rate)| (rate, inputs[direction])));
    Rev::linear(x.re(), &terms)
}
