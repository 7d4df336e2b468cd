//! An open model: its text, its graph, the parameter values that were set, and the results of a
//! run.

use crate::solve::SolveReport;
use crate::{degenerate, faired};
use indexmap::IndexMap;
use moldloft_budget::{Budget, Spent};
use moldloft_diag::{Diagnostic, Sources};
use moldloft_io::NamedGrid;
use moldloft_lang::functions::plots::grids_of;
use moldloft_lang::run::interpreter::{Inputs, Settings};
use moldloft_lang::run::program::{self, RunContext};
use moldloft_lang::run::weight::mass_and_centre;
use moldloft_lang::source::env::{Evaluation, Param, Seed};
use moldloft_lang::source::fault_location::unplaced;
use moldloft_lang::source::module::Modules;
use moldloft_lang::source::scope::Binding;
use moldloft_lang::source::sketch_file::{self, SketchFile};
use moldloft_lang::{RunScalar, World};
use moldloft_mesh::Mesh;
use moldloft_model::{Applied, Extent, Graph};
use moldloft_num::{Dual4, Fineness};
use moldloft_panel::{Nominal, PanelNote, Panelling};
use moldloft_registry::{CallError, Kept, Registry, Role, Row, Scalar, Value};
use moldloft_sketch::SketchSolid;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// An open model: its text, its parameters, the objects that the text declares, and the values
/// computed from them. Opening never fails; errors are in [`Document::diagnostics`].
pub struct Document {
    pub(crate) registry: Registry,
    pub(crate) world: Box<dyn World>,
    pub(crate) sources: Sources,
    pub(crate) text_diagnostics: Vec<Diagnostic>,
    pub(crate) run_diagnostics: Vec<Diagnostic>,
    pub(crate) expression_remarks: Vec<Diagnostic>,
    pub(crate) export_remarks: Vec<Diagnostic>,
    pub(crate) source: ObjectSource,
    pub(crate) modules: Modules,
    /// Values of parameters, and of literals of objects, that differ from those in the text.
    pub(crate) overrides: IndexMap<String, f64>,
    pub(crate) plain: Evaluation<f64>,
    pub(crate) dual: Option<Box<Evaluation<Dual4>>>,
    pub(crate) panelled: Option<(u64, Arc<Panelled>)>,
    pub(crate) bodied: Option<Arc<crate::measures::bodied::Bodied>>,
    /// See [`Document::inner_skins`].
    pub(crate) inner_skins: Option<(Arc<Panelled>, Vec<Diagnostic>)>,
    pub(crate) whole: HashMap<&'static str, crate::measures::bodied::Whole>,
    pub(crate) blocked: Option<(u64, Arc<crate::measures::blocks::Blocked>)>,
    /// Division counts at the parameter values of the text, and the version of the text.
    nominal: Option<(u64, Nominal)>,
    pub(crate) applied: Applied,
    /// Reports on the solve sets of the last run.
    pub(crate) solved: Vec<SolveReport>,
    /// The objects whose numbers are unknowns of solve sets.
    pub(crate) solved_objects: HashSet<String>,
    budget: Arc<Budget>,
    /// True when the last run was cancelled: objects it did not reach are missing.
    cut_short: bool,
    /// Results cached between calls, for the plain run and for runs with derivatives.
    kept: Kept,
    pub(crate) settings: Settings,
    /// True when a text with errors is run as far as it can be parsed.
    tolerant: bool,
    /// True when figures and files of an incomplete model are allowed.
    partial: bool,
    /// See [`Document::preview`].
    coarser: u32,
}

/// Source of the objects.
pub(crate) enum ObjectSource {
    /// A program; its text is module 0.
    Program,
    /// A model file.
    ModelFile(Box<moldloft_lang::model_file::ModelFileSource>),
    /// A sketch file: module 0 is an empty program, and the sketch is loaded after it.
    Sketch(Arc<SketchFile>),
    /// Nothing: the file could not be read.
    None,
}

/// The panels of a model and their positions.
#[derive(Debug)]
pub struct Panelled {
    /// The objects that compute each vertex.
    pub panelling: Panelling,
    /// The mesh.
    pub mesh: Mesh<f64>,
}

impl Document {
    /// Opens the model at `path`.
    pub fn open(registry: Registry, world: Box<dyn World>, path: &str) -> Self {
        Self::open_within(registry, world, path, Arc::default())
    }

    /// As [`Self::open`], with a budget that limits and can cancel every run, including the first.
    pub fn open_within(
        registry: Registry,
        world: Box<dyn World>,
        path: &str,
        budget: Arc<Budget>,
    ) -> Self {
        Self { budget, ..Self::empty(registry, world) }.opened(path)
    }

    /// As [`Self::open_within`], for a text in an editor: it is run as in [`Self::edited`].
    pub fn open_edited(
        registry: Registry,
        world: Box<dyn World>,
        path: &str,
        budget: Arc<Budget>,
    ) -> Self {
        Self { budget, tolerant: true, ..Self::empty(registry, world) }.opened(path)
    }

    fn opened(mut self, path: &str) -> Self {
        match self.world.read(path, None) {
            Ok(read) => match moldloft_syntax::decode(&read.bytes, &read.name) {
                Ok(text) => self.take_text(&read.name, text.to_string()),
                Err(diagnostic) => self.text_diagnostics.push(diagnostic),
            },
            Err(error) => {
                let diagnostic = Diagnostic::error("cannot-read", error.message);
                self.text_diagnostics.push(diagnostic.maybe_help(error.help));
            }
        }
        self
    }

    /// A model from a text. The extension of `name` distinguishes a model file (`.ms2`) from a
    /// program; without an extension the first word does.
    pub fn from_text(registry: Registry, world: Box<dyn World>, name: &str, text: &str) -> Self {
        let mut document = Self::empty(registry, world);
        document.take_text(name, text.to_string());
        document
    }

    /// As [`Self::from_text`], with a budget that limits and can cancel every run, including this
    /// first one.
    pub fn from_text_within(
        registry: Registry,
        world: Box<dyn World>,
        (name, text): (&str, &str),
        budget: Arc<Budget>,
    ) -> Self {
        let mut document = Self { budget, ..Self::empty(registry, world) };
        document.take_text(name, text.to_string());
        document
    }

    /// As [`Self::from_text_within`], for a text in an editor: the statements that can be parsed
    /// are run despite errors elsewhere, so that names have values while the user types.
    pub fn edited(
        registry: Registry,
        world: Box<dyn World>,
        (name, text): (&str, &str),
        budget: Arc<Budget>,
    ) -> Self {
        let mut document = Self { budget, tolerant: true, ..Self::empty(registry, world) };
        document.take_text(name, text.to_string());
        document
    }

    fn empty(registry: Registry, world: Box<dyn World>) -> Self {
        Self {
            registry,
            world,
            sources: Sources::new(),
            text_diagnostics: Vec::new(),
            run_diagnostics: Vec::new(),
            expression_remarks: Vec::new(),
            export_remarks: Vec::new(),
            source: ObjectSource::None,
            modules: Modules::default(),
            overrides: IndexMap::new(),
            plain: Evaluation::default(),
            dual: None,
            panelled: None,
            bodied: None,
            inner_skins: None,
            whole: HashMap::new(),
            blocked: None,
            nominal: None,
            applied: Applied { evaluated: 0, objects: 0, failed: 0 },
            solved: Vec::new(),
            solved_objects: HashSet::new(),
            budget: Arc::default(),
            cut_short: false,
            kept: Kept::default(),
            settings: Settings::default(),
            partial: false,
            coarser: 0,
            tolerant: false,
        }
    }

    fn take_text(&mut self, name: &str, text: String) {
        let file = self.sources.add(name, text.clone());
        self.parse(name, text, file);
        self.run();
    }

    fn parse(&mut self, name: &str, text: String, file: moldloft_diag::FileId) {
        // Division counts that follow from lengths are those at the parameter values of the text.
        if let Some((at, panelled)) = &mut self.panelled
            && panelled.panelling.is_measured()
        {
            *at = u64::MAX;
        }
        let lower = name.to_ascii_lowercase();
        let model_file = lower.ends_with(".ms2")
            || (!lower.ends_with(".sdl") && text.trim_start().starts_with("MultiSurf"));
        let at = (!self.modules.is_empty()).then_some(0);
        if sketch_file::is_sketch(&lower) {
            let (program, _) = moldloft_syntax::sdl::parse("", file);
            self.modules.add(name, program, &self.registry, at);
            self.text_diagnostics = Vec::new();
            let sketch = SketchFile::open(name, &text, file, &*self.world);
            self.source = ObjectSource::Sketch(Arc::new(sketch));
        } else if model_file {
            let (source, diagnostics) =
                moldloft_lang::model_file::ModelFileSource::parse(text, file);
            self.text_diagnostics = diagnostics;
            self.source = ObjectSource::ModelFile(Box::new(source));
        } else {
            let (program, diagnostics) = moldloft_syntax::sdl::parse(text, file);
            self.text_diagnostics = diagnostics;
            self.modules.add(name, program, &self.registry, at);
            self.source = ObjectSource::Program;
        }
    }

    /// Replaces the text and runs it; fast enough for every keystroke of an editor.
    pub fn set_text(&mut self, text: &str) -> Applied {
        let file = self.sources.ids().next();
        let name = file.and_then(|f| self.sources.name(f)).unwrap_or("model.sdl").to_string();
        let file = match file {
            Some(file) => {
                self.sources.replace(file, text);
                file
            }
            None => self.sources.add(name.clone(), text),
        };
        // Changed literals of objects belong to the old text.
        let params = &self.plain.env.params;
        self.overrides
            .retain(|name, _| !name.contains('.') || params.iter().any(|p| p.name == *name));
        self.parse(&name, text.to_string(), file);
        self.run();
        self.applied
    }

    /// Runs the model again; only changed objects are evaluated.
    pub fn run(&mut self) -> Applied {
        self.run_diagnostics.clear();
        let mut evaluation = std::mem::take(&mut self.plain);
        let seeds = HashSet::new();
        evaluation.graph.set_coarser(self.coarser);
        let earlier = evaluation.graph.objects().next().is_some();
        self.applied = self.evaluate(&mut evaluation, &|_, x| x, &seeds, true);
        let refused = self.budget.poll() == Err(Spent::Refused);
        let short = self.run_diagnostics.iter().any(|d| d.id == "out-of-memory");
        if earlier && short && !refused {
            // Results of earlier runs may be what fills the memory.
            evaluation = Evaluation::default();
            evaluation.graph.set_coarser(self.coarser);
            self.forget_results();
            self.run_diagnostics.clear();
            self.applied = self.evaluate(&mut evaluation, &|_, x| x, &seeds, true);
        }
        let cut = |d: &Diagnostic| d.id == "cancelled" || (d.id == "out-of-memory" && refused);
        self.cut_short = self.run_diagnostics.iter().any(cut);
        self.plain = evaluation;
        self.solved.clear();
        self.solved_objects.clear();
        if !self.plain.env.solves.is_empty() {
            self.solve();
        }
        self.applied
    }

    /// Runs the model with cells of bodies of sets that are larger than stated by a number of
    /// halvings: a preview while a number moves. True if the number differs from the last one.
    ///
    /// Derivatives are those of the stated cells.
    pub fn preview(&mut self, coarser: u32) -> bool {
        if std::mem::replace(&mut self.coarser, coarser) == coarser {
            return false;
        }
        self.run();
        true
    }

    /// Frees results of the plain run that are cached for the next one.
    fn forget_results(&mut self) {
        self.dual = None;
        self.panelled = None;
        self.bodied = None;
        self.inner_skins = None;
        self.whole.clear();
        self.blocked = None;
        self.nominal = None;
        self.kept = Kept::default();
    }

    /// Completes a run that was cancelled or that ran out of memory.
    ///
    /// # Errors
    /// The reason, if the run is still incomplete: objects it did not reach are not unknown names.
    pub(crate) fn complete(&mut self) -> Result<(), Vec<Diagnostic>> {
        let again = !matches!(self.budget.poll(), Err(Spent::Cancelled | Spent::Refused));
        if self.cut_short && again {
            self.run();
        }
        self.finished()
    }

    /// Allows figures and files of an incomplete model: one with failed objects or panels that do
    /// not join.
    pub fn allow_partial(&mut self, partial: bool) {
        self.partial = partial;
    }

    /// True when figures and files of an incomplete model are allowed.
    pub fn partial(&self) -> bool {
        self.partial
    }

    /// Succeeds when the model is complete, or an incomplete one is allowed.
    ///
    /// # Errors
    /// Errors of objects, and contradictory panel counts, unless an incomplete model is allowed.
    pub fn entire(&mut self) -> Result<(), Vec<Diagnostic>> {
        self.complete()?;
        if self.partial {
            return Ok(());
        }
        let errors = self.lacking()?;
        if errors.is_empty() { Ok(()) } else { Err(errors) }
    }

    /// Reasons why the model is incomplete: errors of objects, and contradictory panel counts.
    ///
    /// # Errors
    /// If panels cannot be generated.
    pub fn lacking(&mut self) -> Result<Vec<Diagnostic>, Vec<Diagnostic>> {
        let run = self.text_diagnostics.iter().chain(&self.run_diagnostics);
        let mut errors: Vec<Diagnostic> = run.filter(|d| d.is_error()).cloned().collect();
        // Causes come before the objects they block.
        errors.sort_by_key(|d| d.id == "blocked");
        if errors.is_empty() {
            let panelled = self.panelled().map_err(|d| vec![d])?;
            let notes = panelled.panelling.remarks().iter().filter(|note| note.is_error());
            errors.extend(notes.map(|note| self.reported(note)));
        }
        Ok(errors)
    }

    /// The panels of the whole model; see [`Self::entire`].
    ///
    /// # Errors
    /// The first reason why there are no panels.
    pub fn entire_panels(&mut self) -> Result<Arc<Panelled>, Diagnostic> {
        self.entire().map_err(|mut faults| faults.swap_remove(0))?;
        self.panelled()
    }

    /// The fault to report: `fault`, or exhausted memory or time if that came first.
    pub(crate) fn or_spent(&self, fault: Diagnostic) -> Diagnostic {
        match self.budget.poll() {
            Ok(()) => fault,
            Err(spent) => unplaced(&CallError::from(spent)),
        }
    }

    /// True if the last run was cancelled or ran out of memory.
    pub fn is_cut_short(&self) -> bool {
        self.cut_short
    }

    /// Succeeds when the last run is complete.
    ///
    /// # Errors
    /// The reason why it is incomplete.
    pub(crate) fn finished(&self) -> Result<(), Vec<Diagnostic>> {
        if !self.cut_short {
            return Ok(());
        }
        Err(self.run_diagnostics.iter().filter(|d| Spent::is_id(&d.id)).cloned().collect())
    }

    /// Runs the source on a graph. `report` is false for runs with derivatives: their diagnostics
    /// would repeat those of the plain run.
    pub(crate) fn evaluate<T: RunScalar>(
        &mut self,
        evaluation: &mut Evaluation<T>,
        seed: Seed<'_, T>,
        seeded_objects: &HashSet<String>,
        report: bool,
    ) -> Applied {
        let mut found = Vec::new();
        let both: HashSet<String>;
        let seeded_objects = if self.solved_objects.is_empty() {
            seeded_objects
        } else {
            both = seeded_objects.union(&self.solved_objects).cloned().collect();
            &both
        };
        evaluation.graph.set_budget(self.budget.clone());
        evaluation.graph.keep_in(self.kept.clone());
        let inputs = Inputs {
            overrides: &self.overrides,
            seed,
            seeded_objects,
            budget: &self.budget,
            settings: self.settings,
        };
        let sketch = match &self.source {
            ObjectSource::Sketch(sketch) => Some(sketch.clone()),
            _ => None,
        };
        let program = RunContext {
            modules: &mut self.modules,
            world: &*self.world,
            registry: &self.registry,
            sources: &mut self.sources,
            sketch,
            converted: moldloft_lang::model_file::converted,
        };
        // A program with a syntax error may mean something else than its author intended.
        let faulty = !self.tolerant && self.text_diagnostics.iter().any(Diagnostic::is_error);
        let applied = match &self.source {
            ObjectSource::Program if faulty => {
                evaluation.env = Default::default();
                evaluation.graph.apply(Extent::Whole, |_| ()).1
            }
            ObjectSource::Program | ObjectSource::Sketch(_) => {
                T::run_program(program, evaluation, inputs, &mut found)
            }
            ObjectSource::ModelFile(source) => {
                T::run_model_file(source, program, evaluation, inputs, &mut found)
            }
            ObjectSource::None => evaluation.graph.apply(Extent::Whole, |_| ()).1,
        };
        if report {
            found.extend(self.failures(evaluation));
            found.extend(self.remarks(evaluation));
            found.extend(self.degeneracies(evaluation));
            found.extend(self.doubled(evaluation));
            found.extend(self.half_weights(evaluation));
            self.run_diagnostics = found;
        }
        applied
    }

    /// The diagnostics of failed objects; the objects blocked by one are listed in its diagnostic.
    pub(crate) fn failures<T: Scalar>(&self, evaluation: &Evaluation<T>) -> Vec<Diagnostic> {
        if evaluation.graph.failed() == 0 {
            return Vec::new();
        }
        let mut blocked: IndexMap<_, Vec<String>> = IndexMap::new();
        for object in evaluation.graph.objects() {
            if let Some(by) = object.blocked_by() {
                blocked.entry(by).or_default().push(object.name.to_string());
            }
        }
        let mut diagnostics = Vec::new();
        for object in evaluation.graph.objects() {
            let Some(fault) = object.fault() else { continue };
            let mut diagnostic = moldloft_lang::source::fault_location::unplaced(fault);
            diagnostic.message = format!("`{}`: {}", object.name, diagnostic.message);
            let span = match &self.source {
                ObjectSource::Program | ObjectSource::Sketch(_) => {
                    program::fault_span(&self.modules, &evaluation.env, object, fault)
                }
                ObjectSource::ModelFile(source) => source.fault_span(object, fault),
                ObjectSource::None => None,
            };
            diagnostic = diagnostic.object(&*object.name);
            if let Some(span) = span {
                diagnostic = diagnostic.at(span);
            }
            for (key, label) in &fault.related {
                if let Some(span) =
                    evaluation.graph.get(*key).and_then(|o| self.declared_at(evaluation, o))
                {
                    diagnostic = diagnostic.note_at(span, label.clone());
                }
            }
            if let Some(names) = blocked.get(&object.key) {
                let shown = names.iter().take(5).map(String::as_str).collect::<Vec<_>>().join(", ");
                let more = names.len().saturating_sub(5);
                let more = if more > 0 { format!(" and {more} more") } else { String::new() };
                diagnostic =
                    diagnostic.note(format!("blocked by `{}`: {shown}{more}", object.name));
            }
            diagnostics.push(diagnostic);
        }
        diagnostics
    }

    /// Surfaces shown together with their mirror image in a symmetry plane of the model.
    fn doubled<T: Scalar>(&self, evaluation: &Evaluation<T>) -> Vec<Diagnostic> {
        let letters = match &self.source {
            ObjectSource::ModelFile(source) => source.symmetry(),
            _ => moldloft_lang::model_file::header::text(&evaluation.graph, "symmetry"),
        };
        let mut found = Vec::new();
        if letters.is_empty() {
            return found;
        }
        let surface = |object: &moldloft_model::Object<T>| match object.value() {
            Some(Value::Surface(surface)) => Some(surface.clone()),
            _ => None,
        };
        for image in evaluation.graph.objects().filter(|o| o.head.shown()) {
            let Some((key, true)) = surface(image).and_then(|s| s.image_of()) else { continue };
            let Some(original) = evaluation.graph.get(key).filter(|o| o.head.shown()) else {
                continue;
            };
            let (Some(a), Some(b)) = (surface(original), surface(image)) else { continue };
            let places = [(0.21, 0.33), (0.5, 0.71), (0.87, 0.12)];
            let at = |s: &moldloft_registry::SurfaceRef<T>| {
                places.map(|(u, v)| s.jet(u.into(), v.into(), moldloft_num::Order::Zero).p.re())
            };
            let (p, q) = (at(&a), at(&b));
            let size = p.iter().fold(0.0f64, |m, p| m.max(p.norm()));
            let mirrored = |axis: usize| {
                p.iter().zip(&q).all(|(p, q)| {
                    let mut p = p.to_array();
                    p[axis] = -p[axis];
                    moldloft_num::Vec3::from(p).distance(*q) <= 1e-9 * size
                })
            };
            let axes = (0..3).filter(|&k| letters.contains(['x', 'y', 'z'][k]));
            let Some(axis) = axes.into_iter().find(|&k| mirrored(k)) else { continue };
            let plane = ["x = 0", "y = 0", "z = 0"][axis];
            let message = format!(
                "`{}` is the mirror image of `{}` in {plane}, a symmetry plane of the model: it \
                would count twice",
                image.name, original.name
            );
            let mut diagnostic = Diagnostic::error("mirrored-twice", message)
                .help(format!("hide `{}` (visible = 0), or leave the symmetry out", image.name))
                .object(&*image.name);
            if let Some(span) = self.declared_at(evaluation, image) {
                diagnostic = diagnostic.at(span);
            }
            if let Some(span) = self.declared_at(evaluation, original) {
                diagnostic = diagnostic.note_at(span, "the original");
            }
            found.push(diagnostic);
        }
        found
    }

    /// Weights of shapes of one half of a mirrored model that leave open whether the other half is
    /// included.
    fn half_weights<T: Scalar>(&self, evaluation: &Evaluation<T>) -> Vec<Diagnostic> {
        let letters = match &self.source {
            ObjectSource::ModelFile(source) => source.symmetry(),
            _ => moldloft_lang::model_file::header::text(&evaluation.graph, "symmetry"),
        };
        let mut found = Vec::new();
        for object in evaluation.graph.objects().filter(|o| o.row.role == Role::Weight) {
            let stated = |name: &str| {
                let argument = object.row.field(name).and_then(|k| object.args.get(k));
                argument.is_some_and(|a| !matches!(a, Value::Unset))
            };
            let Some((_, centre)) = object.value().and_then(mass_and_centre) else { continue };
            let (size, centre) = (centre.re().norm(), centre.re().to_array());
            let aside = |axis: usize| centre[axis].abs() > 1e-9 * size;
            let planes: String = ['x', 'y', 'z']
                .into_iter()
                .enumerate()
                .filter_map(|(k, c)| (letters.contains(c) && aside(k)).then_some(c))
                .collect();
            if !stated("per") || stated("images") || planes.is_empty() {
                continue;
            }
            let message = format!(
                "`{}` is the weight of one side: the model is mirrored, and the other side is not counted",
                object.name
            );
            let mut diagnostic = Diagnostic::error("half-weight", message)
                .help(format!("`images = \"{planes}\"` includes the mirror images"))
                .help("`images = \"\"` states a single weight")
                .object(&*object.name);
            if let Some(span) = self.declared_at(evaluation, object) {
                diagnostic = diagnostic.at(span);
            }
            found.push(diagnostic);
        }
        found
    }

    /// Warnings about objects.
    pub(crate) fn remarks<T: Scalar>(&self, evaluation: &Evaluation<T>) -> Vec<Diagnostic> {
        if evaluation.graph.remarked() == 0 {
            return Vec::new();
        }
        let mut diagnostics = Vec::new();
        for object in evaluation.graph.objects() {
            for remark in object.value().map(Value::remarks).unwrap_or_default() {
                let message = format!("`{}`: {}", object.name, remark.message);
                let mut diagnostic = Diagnostic::warning(remark.id, message).object(&*object.name);
                if !remark.advice.is_empty() {
                    diagnostic = diagnostic.help(remark.advice);
                }
                if let Some(span) = self.declared_at(evaluation, object) {
                    diagnostic = diagnostic.at(span);
                }
                diagnostics.push(diagnostic);
            }
        }
        diagnostics
    }

    /// Warnings about curves of zero length, surfaces of zero area, and doubtful fairings.
    pub(crate) fn degeneracies<T: Scalar>(&self, evaluation: &Evaluation<T>) -> Vec<Diagnostic> {
        let warned = |object| {
            let found = degenerate::remark(object, &evaluation.graph);
            let (id, message, advice) = found.or_else(|| faired::remark(object))?;
            let message = format!("`{}`: {message}", object.name);
            let warning = Diagnostic::warning(id, message).help(advice).object(&*object.name);
            Some(match self.declared_at(evaluation, object) {
                Some(span) => warning.at(span),
                None => warning,
            })
        };
        evaluation.graph.objects().filter_map(warned).collect()
    }

    pub(crate) fn declared_at<T: Scalar>(
        &self,
        evaluation: &Evaluation<T>,
        object: &moldloft_model::Object<T>,
    ) -> Option<moldloft_diag::Span> {
        match &self.source {
            ObjectSource::Program | ObjectSource::Sketch(_) => {
                program::declared_at(&self.modules, &evaluation.env, object)
            }
            ObjectSource::ModelFile(source) => source.declared_at(object),
            ObjectSource::None => None,
        }
    }

    /// The fault of a step after the run, at the declaration of the object that it concerns.
    pub(crate) fn at_object(&self, fault: &CallError) -> Diagnostic {
        let diagnostic = unplaced(fault);
        let Some(object) = fault.related.first().and_then(|(key, _)| self.plain.graph.get(*key))
        else {
            return diagnostic;
        };
        let diagnostic = diagnostic.object(&*object.name);
        match self.declared_at(&self.plain, object) {
            Some(span) => diagnostic.at(span),
            None => diagnostic,
        }
    }

    /// Division counts at the parameter values of the text, when a parameter has another value:
    /// counts that follow from lengths do not change with parameters.
    fn nominal(&mut self) -> Option<Nominal> {
        if !self.overrides.keys().any(|name| self.params().iter().any(|p| p.name == *name)) {
            return None;
        }
        let version = self.text_version();
        if let Some((at, nominal)) = &self.nominal
            && *at == version
        {
            return Some(nominal.clone());
        }
        let overrides = std::mem::take(&mut self.overrides);
        let mut evaluation = Evaluation::default();
        self.evaluate(&mut evaluation, &|_, x| x, &HashSet::new(), false);
        self.overrides = overrides;
        let nominal = Panelling::new(&evaluation.graph).ok()?.nominal();
        self.nominal = Some((version, nominal.clone()));
        Some(nominal)
    }

    /// A hash of the text with edited literals.
    fn text_version(&self) -> u64 {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hasher = DefaultHasher::new();
        self.text().hash(&mut hasher);
        hasher.finish()
    }

    /// All errors and warnings: first those of the text, then those of the run, then those of joins
    /// between panels.
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let mut all: Vec<_> =
            self.text_diagnostics.iter().chain(&self.run_diagnostics).cloned().collect();
        if let Some((clock, panelled)) = &self.panelled
            && *clock == self.plain.graph.last_change()
        {
            all.extend(panelled.panelling.remarks().iter().map(|remark| self.reported(remark)));
        }
        all
    }

    /// Unjoined coincident edges of patches, and corners on open edges of other patches: errors,
    /// for checks.
    ///
    /// # Errors
    /// If the panels exceed the limit.
    pub fn junctions(&mut self) -> Result<Vec<Diagnostic>, Diagnostic> {
        let panelled = self.panelled()?;
        let remarks = panelled.panelling.junctions(&self.plain.graph);
        Ok(remarks.iter().map(|remark| self.reported(remark)).collect())
    }

    fn reported(&self, remark: &PanelNote) -> Diagnostic {
        let severity = if remark.is_error() { Diagnostic::error } else { Diagnostic::warning };
        let mut diagnostic = severity(remark.id(), remark.to_string()).help(remark.help());
        let object =
            remark.object().and_then(|name| self.plain.graph.get(self.plain.graph.find(name)?));
        if let Some(object) = object {
            diagnostic = diagnostic.object(&*object.name);
            if let Some(span) = self.declared_at(&self.plain, object) {
                diagnostic = diagnostic.at(span);
            }
        }
        diagnostic
    }

    /// True when there is an error.
    pub fn has_errors(&self) -> bool {
        self.text_diagnostics.iter().chain(&self.run_diagnostics).any(|d| d.is_error())
    }

    /// The texts that spans of diagnostics refer to.
    pub fn sources(&self) -> &Sources {
        &self.sources
    }

    /// The design parameters in order of declaration.
    pub fn params(&self) -> &[Param] {
        &self.plain.env.params
    }

    /// The objects.
    pub fn graph(&self) -> &Graph<f64> {
        &self.plain.graph
    }

    /// The solid of a sketch, by the name of its mesh.
    pub fn sketch_body(&self, name: &str) -> Option<&SketchSolid<f64>> {
        self.plain.env.sketch_bodies.get(name).map(|body| &**body)
    }

    /// Result of the last change.
    pub fn applied(&self) -> Applied {
        self.applied
    }

    /// The rows that the model can call.
    pub fn registry(&self) -> &Registry {
        &self.registry
    }

    /// Adds or replaces a registry row, such as a user's function, and runs the model.
    pub fn add_row(&mut self, row: Row) -> Applied {
        self.registry.add(row);
        self.modules.relink(&self.registry);
        self.run()
    }

    /// Sets the refinement level and runs the model; each level halves the spacings declared by
    /// `refined`.
    ///
    /// # Errors
    /// If `times` exceeds [`moldloft_lang::MOST_REFINED`].
    pub fn refine(&mut self, times: u32) -> Result<Applied, Diagnostic> {
        if times > moldloft_lang::MOST_REFINED {
            return Err(Diagnostic::error("out-of-range", "the refinement is too fine")
                .expected(format!("a whole number from 0 to {}", moldloft_lang::MOST_REFINED))
                .found(times.to_string()));
        }
        self.settings.refine = times;
        Ok(self.run())
    }

    /// Runs the program in the interpreter, statement by statement and operator by operator: the reference for tests.
    #[doc(hidden)]
    pub fn by_reference(&mut self) -> Applied {
        self.settings.reference = true;
        self.run()
    }

    /// Runs the program with a maximum number of steps, for tests of that limit.
    #[doc(hidden)]
    pub fn with_steps(&mut self, most: u64) -> Applied {
        self.settings.most_steps = Some(most);
        self.run()
    }

    /// Number of steps of the last run.
    #[doc(hidden)]
    pub fn steps(&self) -> u64 {
        self.plain.env.steps
    }

    /// Files written by the program, by name; they are not on disk yet.
    pub fn written(&self) -> impl Iterator<Item = (&str, &[u8])> {
        self.plain.env.files.written()
    }

    /// The variables that the program's own files declare: name, type with extents, and value.
    pub fn variables(&self) -> Vec<(String, String, Value<f64>)> {
        let names = (0..self.modules.name_count() as u32).map(moldloft_lang::source::module::Name);
        let mut found = Vec::new();
        for name in names {
            let Some(Some(bound)) = self.plain.env.scope.globals.get(name.0 as usize) else {
                continue;
            };
            let Binding::Variable { value, .. } = &bound.what else { continue };
            let modules = (0..self.modules.len()).map(|k| self.modules.get(k));
            let of_library =
                modules.clone().any(|m| m.library && m.program.file() == bound.span.file);
            if !of_library && bound.span.is_known() && !matches!(value, Value::Unset) {
                let shape = moldloft_lang::value::variables::shape_text(value);
                found.push((bound.span, self.modules.text(name).to_string(), shape, value.clone()));
            }
        }
        found.sort_by_key(|(span, ..)| (span.file.0, span.start));
        found.into_iter().map(|(_, name, shape, value)| (name, shape, value)).collect()
    }

    /// The curves, surfaces and blocks of points among the variables, with those in records and
    /// lists (`name.member`, `name[number]`), that have an extent.
    pub fn grids(&self) -> Vec<NamedGrid> {
        let variables = self.variables();
        grids_of(variables.iter().map(|(name, _, value)| (name.as_str(), value)))
    }

    /// The lines printed by the program.
    pub fn printed(&self) -> &[String] {
        &self.plain.env.printed
    }

    /// The budget of its work, which can also cancel it.
    pub fn budget(&self) -> Arc<Budget> {
        self.budget.clone()
    }

    /// The text, with direct edits included.
    pub fn text(&self) -> String {
        match &self.source {
            ObjectSource::Program => self.modules.get(0).program.text_with_edits(),
            ObjectSource::Sketch(sketch) => {
                self.sources.text(sketch.file).map_or(String::new(), |text| text.to_string())
            }
            ObjectSource::ModelFile(source) => source.text(),
            ObjectSource::None => String::new(),
        }
    }

    /// The symmetry planes of the model, as "y" or "xy"; empty without symmetry.
    pub fn symmetry(&self) -> String {
        match &self.source {
            ObjectSource::ModelFile(source) => source.symmetry(),
            _ => moldloft_lang::model_file::header::symmetry(&self.plain.graph),
        }
    }

    /// The panels, divided until they are within `fineness` of their surfaces; see
    /// [`Panelling::within`]. Panels that stay farther away are among [`Document::export_remarks`].
    ///
    /// # Errors
    /// If the panels exceed the limit, or there are no surfaces.
    pub fn panelled_within(&mut self, fineness: &Fineness) -> Result<Arc<Panelled>, Diagnostic> {
        self.complete().map_err(|mut faults| faults.swap_remove(0))?;
        let graph = &self.plain.graph;
        let panelling = Panelling::within(graph, fineness).map_err(|f| self.at_object(&f))?;
        let mesh = panelling.own_mesh().ok_or_else(|| {
            let none = Diagnostic::error("no-mesh", "the model has no panels");
            self.or_spent(none.help("show a surface"))
        })?;
        let is_coarse =
            |n: &&PanelNote| matches!(n, PanelNote::Coarse { .. } | PanelNote::Undivided { .. });
        let coarse = panelling.remarks().iter().filter(is_coarse);
        let coarse: Vec<Diagnostic> = coarse.map(|note| self.reported(note)).collect();
        self.export_remarks.extend(coarse);
        Ok(Arc::new(Panelled { panelling, mesh }))
    }

    /// The panels of all shown surfaces, cached until the model changes.
    ///
    /// # Errors
    /// If the panels exceed the limit.
    pub fn panelled(&mut self) -> Result<Arc<Panelled>, Diagnostic> {
        // The panels of an incomplete model look like those of a complete one.
        self.complete().map_err(|mut faults| faults.swap_remove(0))?;
        let clock = self.plain.graph.last_change();
        if let Some((at, panelled)) = &self.panelled
            && *at == clock
        {
            return Ok(panelled.clone());
        }
        let before = self.panelled.as_ref().map(|(_, p)| p.clone());
        let before = before.as_ref().map(|p| &p.panelling);
        // Counts that followed from lengths before probably do so again: compute those of the text
        // at once.
        let mut nominal = match before {
            Some(before) if before.is_measured() => self.nominal(),
            _ => None,
        };
        let graph = &self.plain.graph;
        let mut panelling =
            Panelling::renewed(graph, nominal.as_ref(), before).map_err(|f| self.at_object(&f))?;
        if panelling.is_measured() && nominal.is_none() {
            nominal = self.nominal();
            if nominal.is_some() {
                let graph = &self.plain.graph;
                panelling = Panelling::renewed(graph, nominal.as_ref(), before)
                    .map_err(|f| self.at_object(&f))?;
            }
        }
        let mesh = panelling.own_mesh().ok_or_else(|| {
            let none = Diagnostic::error("no-mesh", "the model has no panels");
            self.or_spent(none.help("show a surface"))
        })?;
        let panelled = Arc::new(Panelled { panelling, mesh });
        self.panelled = Some((clock, panelled.clone()));
        Ok(panelled)
    }
}
