//! Runs a program: statements.

use crate::array::machine::ArrayMachine;
use crate::run::compiled::kept::ScalarCode;
use crate::run::read_log::ReadLog;
use crate::run::refined::RefinedNumbers;
use crate::run::semantics::{self, Executed, Semantics};
use crate::run::usage::{self, Usage};
use crate::source::env::{Environment, Param, Seed};
use crate::source::module::{Loader, Module, Modules, Name, RoutineAt};
use crate::source::scope::{Binding, ScopedBinding};
use crate::value::chosen::Chosen;
use crate::value::subarray::Place;
use crate::value::variables::Called as _;
use crate::value::variables::{self, Taken};
use indexmap::IndexMap;
use moldloft_budget::{Budget, Limits, Spent};
use moldloft_diag::{Diagnostic, Span, nearest};
use moldloft_model::{Extent, Run};
use moldloft_num::trace::Key;
use moldloft_registry::{Scalar, Value};
use moldloft_syntax::number;
use moldloft_syntax::sdl::{
    AssignOp, ExprId, ExprKind, Ident, NodeList, StmtId, StmtKind, Symbol, Type,
};
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};

/// Maximum number of errors of a run; hints that need a search accompany only the first ones.
const MOST_ERRORS: usize = 1_000;
const MOST_HINTS: usize = 100;

/// The most bytes of all printed lines.
const MOST_PRINTED: usize = 16 << 20;

/// Statements, expressions and calls nest at most this deep while running.
pub(crate) const DEEPEST: u32 = 2_500;

/// Maximum depth of routine calls.
pub(super) const MOST_CALLS: usize = 12_000;

/// Stack size of a run: maximum nesting times the largest frame, with a reserve.
#[cfg(not(target_arch = "wasm32"))]
pub const STACK_BYTES: usize = 192 << 20;

/// The id of a diagnostic that is not shown, because its cause was reported already.
pub(crate) const SILENT: &str = "silent";

/// Inputs of a run besides the program.
pub struct Inputs<'a, T: Scalar> {
    /// Values of parameters that differ from the text's.
    pub overrides: &'a IndexMap<String, f64>,
    /// Gives a parameter or a literal of an object its derivative; the identity for plain runs.
    pub seed: Seed<'a, T>,
    /// Objects with seeded literals, by name.
    pub seeded_objects: &'a HashSet<String>,
    /// Limits of the run; the host can end it through them.
    pub budget: &'a Budget,
    /// Settings by the host.
    pub settings: Settings,
}

/// Settings of a run besides parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Settings {
    /// Number of halvings of `refined` intervals.
    pub refine: u32,
    /// True for the reference that compiled code is tested against: one statement and one operator
    /// at a time, on whole arrays.
    pub reference: bool,
    /// Maximum number of steps instead of that of the limits, without the discount for compiled
    /// code; for tests.
    pub most_steps: Option<u64>,
}

impl<'a, T: Scalar> Inputs<'a, T> {
    /// Another copy of these inputs.
    pub fn again(&self) -> Inputs<'a, T> {
        let &Inputs { overrides, seed, seeded_objects, budget, settings } = self;
        Inputs { overrides, seed, seeded_objects, budget, settings }
    }
}

/// Result of a statement.
pub(crate) enum Flow<T: Scalar> {
    Next,
    Break,
    Continue,
    Return(Option<Value<T>>),
    /// The run is over: too many steps, too deep, or cancelled.
    Stop,
}

pub(crate) struct Interpreter<'a, 'g, T: Scalar> {
    pub modules: &'a mut Modules,
    pub loader: Loader<'a>,
    pub run: &'a mut Run<'g, T>,
    pub env: &'a mut Environment<T>,
    pub inputs: Inputs<'a, T>,
    pub usage: Usage,
    /// The limits that the run began with.
    pub(super) limits: Limits,
    pub turns: u64,
    /// The active components, by module.
    pub components: Vec<usize>,
    /// Reported faults: a repeated statement reports each fault once.
    reported: HashSet<(Cow<'static, str>, Span)>,
    /// Failed objects reported to the program when it read them.
    pub blocked: HashSet<Key>,
    /// Objects read by the current expression, while the log is open.
    pub reads: ReadLog,
    /// The names that statements of a module assign to, by module.
    pub assigned: HashMap<usize, HashSet<Symbol>>,
    /// Names declared anywhere in the main file, for hints about later declarations.
    pub(crate) current: usize,
    pub arrays: ArrayMachine<T>,
    /// Refined numbers of a refined run.
    pub(crate) refined: RefinedNumbers<T>,
    /// Numbers of the whole model that were read last.
    pub(crate) measured: Option<(usize, String, Vec<(&'static str, Value<T>)>)>,
    /// True once the note on the misprint of 1992 has been given.
    pub misprint_told: bool,
    /// True while returning from a library routine because of an error in it.
    pub abandoned: bool,
    /// The statements that were executed.
    pub(super) executed: Executed,
    /// The code of loops and routines.
    pub(super) code: ScalarCode<T>,
}

/// Steps of an array of `n` elements. Arrays count for the time they take: a statement on a number takes as
/// long as an operator on some sixty elements.
pub(super) fn of_array(n: usize) -> usize {
    3 + n / 64
}

pub(crate) fn silent() -> Diagnostic {
    Diagnostic::error(SILENT, "")
}

impl<'a, 'g, T: Scalar> Interpreter<'a, 'g, T> {
    pub fn new(
        modules: &'a mut Modules,
        loader: Loader<'a>,
        run: &'a mut Run<'g, T>,
        env: &'a mut Environment<T>,
        inputs: Inputs<'a, T>,
    ) -> Self {
        env.scope.enter(modules.name_count());
        let plain_operators = inputs.settings.reference;
        let mut limits = moldloft_budget::limits();
        limits.steps = inputs.settings.most_steps.unwrap_or(limits.steps);
        Self {
            modules,
            loader,
            run,
            env,
            inputs,
            usage: Usage::default(),
            limits,
            turns: 0,
            components: Vec::new(),
            reported: HashSet::new(),
            blocked: HashSet::new(),
            reads: ReadLog::default(),
            assigned: HashMap::new(),
            current: 0,
            arrays: ArrayMachine { plain_operators, ..ArrayMachine::default() },
            refined: RefinedNumbers::default(),
            measured: None,
            misprint_told: false,
            abandoned: false,
            executed: Executed::default(),
            code: ScalarCode::default(),
        }
    }

    /// Runs a module once, from its first statement to its last.
    pub fn module(&mut self, at: usize) -> Flow<T> {
        if !self.env.scope.executed.insert(at) {
            return Flow::Next;
        }
        let module = self.modules.get(at).clone();
        module.faults.iter().for_each(|fault| self.report(fault.clone()));
        self.env.scope.make_room(self.modules.name_count());
        self.declare_routines(&module, at);
        self.declare_records(&module, at);
        let outer = std::mem::replace(&mut self.current, at);
        let flow = self.statements(&module, module.program.body());
        self.current = outer;
        self.abandoned = false;
        match flow {
            Flow::Stop => Flow::Stop,
            _ => Flow::Next,
        }
    }

    /// Checks the statements that were not executed, unless the run was stopped.
    pub fn judge(&mut self) {
        self.env.steps = self.usage.steps;
        if self.env.stopped || T::PARTS > 1 {
            return;
        }
        let scope = &self.env.scope;
        let run: Vec<usize> = scope.executed.iter().copied().collect();
        // The tree of a text with faults has gaps.
        if run.iter().any(|&at| semantics::has_gaps(self.modules.get(at))) {
            return;
        }
        let open = !scope.sketches_done.is_empty() || !scope.given.is_empty();
        let (modules, registry) = (&*self.modules, self.loader.registry);
        let semantics = Semantics::new(
            modules,
            registry,
            run,
            (&scope.routines, &scope.records),
            &self.executed,
            open,
        );
        for diagnostic in semantics.judged() {
            self.report(diagnostic);
        }
    }

    pub fn report(&mut self, diagnostic: Diagnostic) {
        if diagnostic.id == SILENT {
            return;
        }
        let diagnostic = self.at_call(diagnostic);
        self.usage.errors += usize::from(diagnostic.is_error());
        let span = diagnostic.span();
        // What has grown so far stays: later statements would take time and more memory.
        self.env.stopped |= diagnostic.id == Spent::Refused.id();
        if self.reported.insert((diagnostic.id.clone(), span)) {
            self.loader.diagnostics.push(diagnostic);
        }
        if self.usage.errors >= MOST_ERRORS && !self.env.stopped {
            self.stop(
                Diagnostic::error("too-many-errors", "the run was given up: too many errors")
                    .at(span)
                    .expected(format!("fewer than {MOST_ERRORS} errors"))
                    .help("fix the first ones, then run again"),
            );
        }
    }

    /// A fault inside a built-in library is reported at the call that led there.
    fn at_call(&self, mut diagnostic: Diagnostic) -> Diagnostic {
        let inside = diagnostic.span();
        let library = |module: u32| self.modules.get(module as usize).library;
        let of_library = |m: &Module| m.library && m.program.file() == inside.file;
        if !inside.is_known() || !of_library(self.modules.get(self.current)) {
            return diagnostic;
        }
        let calls = self.env.scope.frames.iter().rev().filter_map(|frame| frame.called);
        let Some((call, _)) = calls.into_iter().find(|(_, module)| !library(*module)) else {
            return diagnostic;
        };
        let text = diagnostic.primary.take().map(|label| label.text).unwrap_or_default();
        let text = if text.is_empty() { "found in the library here".into() } else { text };
        diagnostic.at(call).note_at(inside, text)
    }

    /// Counts the elements of a new value as steps, to limit the memory of a program.
    ///
    /// # Errors
    /// When the run must stop; that was reported.
    pub fn charge(&mut self, value: &Value<T>, span: Span) -> Result<(), Diagnostic> {
        // Lists are read item by item; memory has a limit of its own.
        self.usage.steps += match value {
            Value::Numbers(a) => of_array(a.items.len()),
            Value::Vectors(a) => of_array(a.len()),
            Value::List(items) => 4 * items.len(),
            Value::Block(layers) => layers
                .iter()
                .map(|layer| match layer {
                    Value::Numbers(a) => of_array(a.items.len()),
                    Value::Vectors(a) => of_array(a.len()),
                    _ => 0,
                })
                .sum(),
            _ => return Ok(()),
        } as u64;
        if self.usage.cost() > self.limits.steps && self.step(span) {
            return Err(silent());
        }
        Ok(())
    }

    /// Charges a call of a function that takes longer than a statement.
    pub fn charge_call(&mut self) {
        self.usage.steps += 40;
    }

    fn declare_routines(&mut self, module: &Module, at: usize) {
        for (k, routine) in module.program.routines().iter().enumerate() {
            let name = module.names[routine.name.symbol.0 as usize];
            let here = RoutineAt { module: at, routine: moldloft_syntax::sdl::RoutineId(k as u32) };
            let text = self.modules.text(name).clone();
            match self.env.scope.routines.get(&name) {
                Some(known) if known.module == at => {
                    let first = module.program[known.routine].name.span;
                    self.report(
                        Diagnostic::error("duplicate-name", format!("`{text}` is defined twice"))
                            .at(routine.name.span)
                            .note_at(first, "first defined here")
                            .help("give one of them another name"),
                    );
                }
                Some(known) if known.module == 0 => {
                    let first = self.modules.get(0).program[known.routine].name.span;
                    self.report(
                        Diagnostic::remark(
                            "redefined",
                            format!("`{text}` of the program replaces the library's"),
                        )
                        .at(first),
                    );
                }
                _ => drop(self.env.scope.routines.insert(name, here)),
            }
        }
    }

    /// Counts a step; true when the run must stop.
    pub fn step(&mut self, span: Span) -> bool {
        self.usage.steps += 1;
        if self.env.stopped {
            return true;
        }
        let most = self.limits.steps;
        if self.usage.cost() > most {
            return self.stop(
                Diagnostic::error("too-many-steps", "the program takes too many steps")
                    .at(span)
                    .expected(format!(
                        "at most {most} statements, calls and elements of values, {} of them as one in loops on \
                         numbers",
                        usage::STEPS_OF_CODE
                    ))
                    .help("look for a loop whose condition always holds, or for arrays too large")
                    .help("allow more: `--limit steps=1e9`, `moldloft.limits(steps=...)`"),
            );
        }
        match self.inputs.budget.poll() {
            Ok(()) => false,
            Err(spent) => self.stop(usage::spent(spent).at(span)),
        }
    }

    pub fn stop(&mut self, diagnostic: Diagnostic) -> bool {
        if !self.env.stopped {
            self.env.stopped = true;
            self.report(diagnostic);
        }
        true
    }

    /// Runs the body of a routine at one more level of calls. The stack does not suffice for the
    /// maximum nesting, so some levels start a new one.
    pub fn deeper_call(
        &mut self,
        span: Span,
        body: impl FnOnce(&mut Self) -> Flow<T> + Send,
    ) -> Option<Flow<T>>
    where
        Self: Send,
    {
        if self.env.scope.frames.len() > MOST_CALLS {
            self.too_many_calls(span);
            return None;
        }
        if cfg!(target_arch = "wasm32") || self.usage.depth < DEEPEST / 2 {
            if !self.deeper(span) {
                return None;
            }
            let flow = body(self);
            self.usage.depth -= 1;
            return Some(flow);
        }
        self.on_enough_stack(span, body)
    }

    /// Runs deeply nested work with sufficient stack; `None` without memory for it, which is
    /// reported.
    pub fn on_enough_stack<R: Send>(
        &mut self,
        span: Span,
        body: impl FnOnce(&mut Self) -> R + Send,
    ) -> Option<R>
    where
        Self: Send,
    {
        if cfg!(target_arch = "wasm32") || self.usage.depth < DEEPEST / 2 {
            return Some(body(self));
        }
        let depth = std::mem::take(&mut self.usage.depth);
        let budget = self.inputs.budget;
        let flow = crate::run::program::on_new_stack(budget, || body(self));
        self.usage.depth = depth;
        if flow.is_none() {
            self.stop(
                Diagnostic::error(
                    "nested-too-deep",
                    "there is no memory for the stack of more calls",
                )
                .at(span)
                .found(format!("{} calls under way", self.env.scope.frames.len()))
                .help("look for a subroutine that calls itself without end"),
            );
        }
        flow
    }

    /// Ends the run: the maximum depth of calls is exceeded.
    pub fn too_many_calls(&mut self, span: Span) {
        self.stop(
            Diagnostic::error("nested-too-deep", "calls nest too deep")
                .at(span)
                .expected(format!("at most {MOST_CALLS} calls under way"))
                .help("look for a subroutine that calls itself without end"),
        );
    }

    /// Enters one more level; false at the maximum depth.
    pub fn deeper(&mut self, span: Span) -> bool {
        if self.usage.depth >= DEEPEST {
            self.stop(
                Diagnostic::error("nested-too-deep", "calls nest too deep")
                    .at(span)
                    .expected(format!("at most {DEEPEST} levels of statements and calls"))
                    .help("look for a subroutine that calls itself without end"),
            );
            return false;
        }
        self.usage.depth += 1;
        true
    }

    /// The current value of a variable, read through references.
    pub fn peek(&self, bound: &ScopedBinding<T>) -> Option<Value<T>> {
        match &bound.what {
            Binding::Variable { value, .. } => Some(value.clone()),
            Binding::Reference(place) => match &self.env.scope.root(place)?.what {
                Binding::Variable { value, .. } => variables::at_place(value, place).ok(),
                _ => None,
            },
            Binding::Param(number) => Some(Value::Number(self.env.param_values[*number])),
            _ => None,
        }
    }

    pub fn statements(&mut self, m: &Module, list: NodeList<StmtId>) -> Flow<T> {
        for &stmt in &m.program[list] {
            match self.statement(m, stmt) {
                Flow::Next => {}
                other => return other,
            }
        }
        Flow::Next
    }

    pub fn statement(&mut self, m: &Module, id: StmtId) -> Flow<T> {
        let stmt = m.program[id];
        if self.step(stmt.span) || !self.deeper(stmt.span) {
            return Flow::Stop;
        }
        self.executed.note(self.current, id);
        let flow = self.statement_of(m, id, stmt.kind, stmt.span).unwrap_or_else(|diagnostic| {
            self.report(diagnostic.or_at(stmt.span));
            // A library routine ends at an error, since further ones would be consequences.
            self.abandoned |= m.library;
            Flow::Next
        });
        self.usage.depth -= 1;
        match flow {
            _ if self.env.stopped => Flow::Stop,
            _ if self.abandoned && m.library => Flow::Return(None),
            flow => flow,
        }
    }

    fn statement_of(
        &mut self,
        m: &Module,
        id: StmtId,
        kind: StmtKind,
        span: Span,
    ) -> Result<Flow<T>, Diagnostic> {
        let is_loop = matches!(
            kind,
            StmtKind::While { .. }
                | StmtKind::ForRange { .. }
                | StmtKind::For { .. }
                | StmtKind::Foreach { .. }
        );
        if is_loop && let Some(flow) = self.loop_by_code(m, id) {
            return Ok(flow);
        }
        match kind {
            StmtKind::Object { kind, name, args } => self.object(m, id, kind, name, args, span)?,
            StmtKind::Block(list) => return Ok(self.statements(m, list)),
            StmtKind::Declare { global, ty, items } => {
                for item in &m.program[items] {
                    if self.env.scope.is_given(m.names[item.name.symbol.0 as usize]) {
                        continue;
                    }
                    if let Err(diagnostic) = self.declare(m, id, global, ty, item) {
                        self.report(diagnostic.or_at(item.name.span));
                        self.poison(m, item.name);
                    }
                }
            }
            StmtKind::Param { name, .. }
                if self.env.scope.is_given(m.names[name.symbol.0 as usize]) => {}
            StmtKind::Param { ty, name, value, range } => {
                if let Err(diagnostic) = self.param(m, ty, name, value, range) {
                    self.poison(m, name);
                    return Err(diagnostic);
                }
            }
            StmtKind::Assign { target, op, value } => self.assign(m, target, op, value)?,
            StmtKind::Call(expr) => return self.call_statement(m, expr),
            StmtKind::If { condition, then, otherwise } => {
                if self.condition(m, condition)? {
                    return Ok(self.statement(m, then));
                }
                if let Some(otherwise) = otherwise {
                    return Ok(self.statement(m, otherwise));
                }
            }
            StmtKind::While { condition, body } => {
                while self.condition(m, condition)? {
                    match self.turn(m, None, body, span) {
                        Flow::Break => break,
                        Flow::Next | Flow::Continue => {}
                        other => return Ok(other),
                    }
                }
            }
            StmtKind::ForRange { variable, from, to, step, body } => {
                return self.for_range(m, variable, [Some(from), Some(to), step], body, span);
            }
            StmtKind::For { start, condition, step, body } => {
                return self.for_classic(m, [start, step], condition, body, span);
            }
            StmtKind::Foreach { variable, list, body } => {
                return self.foreach(m, variable, list, body, span);
            }
            StmtKind::Print(list) => {
                let mut words = Vec::new();
                for &expr in &m.program[list] {
                    let value = self.expr(m, expr)?;
                    let value = self.read(value, m.program[expr].span)?;
                    words.push(crate::value::display::by_rows(&value));
                }
                self.print(words.join(" "), span)?;
            }
            StmtKind::Assert { condition, message } => self.assert(m, condition, message)?,
            StmtKind::Load(path) => {
                let path = m.program[path].to_string();
                if crate::source::sketch_file::is_sketch(&path) {
                    self.load_sketch(&path, id, span)?;
                    return Ok(Flow::Next);
                }
                let module = self.modules.load(self.current, &path, span, &mut self.loader)?;
                return Ok(self.module(module));
            }
            StmtKind::Break => return Ok(Flow::Break),
            StmtKind::Continue => return Ok(Flow::Continue),
            StmtKind::Return(value) => {
                let value = match value {
                    Some(expr) => {
                        let value = self.expr(m, expr)?;
                        Some(self.read(value, m.program[expr].span)?)
                    }
                    None => None,
                };
                return Ok(Flow::Return(value));
            }
            StmtKind::Routine(_) | StmtKind::Record { .. } | StmtKind::Error => {}
        }
        Ok(Flow::Next)
    }

    /// Keeps a printed line.
    ///
    /// # Errors
    /// When the program has printed too much; that was reported, and the run is over.
    pub fn print(&mut self, line: String, span: Span) -> Result<(), Diagnostic> {
        self.usage.printed += line.len() + 24;
        if self.usage.printed > MOST_PRINTED {
            self.stop(
                Diagnostic::error("too-much-output", "the program prints too much")
                    .at(span)
                    .expected(format!("at most {} MB", MOST_PRINTED >> 20))
                    .help("write large results to a file: open(\"name\", \"w\")"),
            );
            return Err(silent());
        }
        self.env.printed.push(line);
        Ok(())
    }

    pub fn condition(&mut self, m: &Module, expr: ExprId) -> Result<bool, Diagnostic> {
        let value = self.expr(m, expr)?;
        match self.read(value, m.program[expr].span)? {
            Value::Number(x) => Ok(x.re() != 0.0),
            other => Err(Diagnostic::error("wrong-condition", "a condition must be a number")
                .at(m.program[expr].span)
                .expected("a comparison, or a number (0 is false)")
                .found(other.called())),
        }
    }

    fn assert(
        &mut self,
        m: &Module,
        condition: ExprId,
        message: Option<ExprId>,
    ) -> Result<(), Diagnostic> {
        if self.condition(m, condition)? {
            return Ok(());
        }
        let span = m.program[condition].span;
        let mut text = format!("assertion failed: {}", m.program.slice(span));
        if let Some(message) = message {
            let value = self.expr(m, message)?;
            text = crate::value::display::plain(&self.read(value, m.program[message].span)?);
        }
        let mut diagnostic = Diagnostic::error("assertion-failed", text).at(span);
        // Both sides of a comparison, so that the numbers are at hand.
        if let ExprKind::Binary { left, right, .. } = m.program[m.program.bare(condition)].kind {
            let mut sides = Vec::new();
            for side in [left, right] {
                let value = self.expr(m, side)?;
                sides.push(crate::value::display::plain(&self.read(value, span)?));
            }
            diagnostic = diagnostic.found(sides.join(" and "));
        }
        Err(diagnostic)
    }

    /// Marks the name of a failed declaration, so that its uses are not reported; a name with
    /// another valid meaning keeps it.
    pub fn poison(&mut self, m: &Module, ident: Ident) {
        let name = m.names[ident.symbol.0 as usize];
        let turn = self.env.scope.frame().loops.last().map(|turn| turn.id);
        let kept = self.env.scope.own(name).is_some_and(|known| match known.what {
            Binding::Turn { turn: made, .. } => turn == Some(made),
            Binding::Object(_) | Binding::Param(_) | Binding::Instance(_) => true,
            Binding::Routine(_)
            | Binding::Function(_)
            | Binding::Variable { .. }
            | Binding::Reference(_)
            | Binding::Multiple(_)
            | Binding::Poisoned => false,
        });
        if !kept {
            self.env.scope.bind(name, ident.span, Binding::Poisoned);
        }
    }

    /// An object must not take a name that is already in use; a variable may be declared
    /// again in another turn of a loop.
    pub fn check_free(&self, name: Name, span: Span, variable: bool) -> Result<(), Diagnostic> {
        let Some(known) = self.env.scope.own(name) else { return Ok(()) };
        let clash = match &known.what {
            Binding::Poisoned => false,
            Binding::Variable { .. } | Binding::Reference(_) | Binding::Multiple(_) => !variable,
            Binding::Turn { .. } | Binding::Instance(_) => variable,
            Binding::Object(_) | Binding::Param(_) | Binding::Routine(_) | Binding::Function(_) => {
                true
            }
        };
        if !clash {
            return Ok(());
        }
        let text = self.modules.text(name);
        Err(Diagnostic::error("duplicate-name", format!("`{text}` is declared twice"))
            .labelled(span, "declared again here")
            .note_at(known.span, "first declared here")
            .help("give one of them another name"))
    }

    fn param(
        &mut self,
        m: &Module,
        ty: Option<(Type, Span)>,
        name: Ident,
        value: ExprId,
        range: Option<(ExprId, ExprId)>,
    ) -> Result<(), Diagnostic> {
        if !self.env.scope.frame().global || !self.env.scope.frame().loops.is_empty() {
            return Err(Diagnostic::error(
                "misplaced-param",
                "a parameter belongs at file level, outside loops and subroutines",
            )
            .at(name.span));
        }
        let is_int = match ty {
            None | Some((Type::Float, _)) => false,
            Some((Type::Int, _)) => true,
            Some((_, span)) => {
                return Err(
                    Diagnostic::error("wrong-type", "a parameter is a float or an int").at(span)
                );
            }
        };
        let text = self.modules.text(m.names[name.symbol.0 as usize]);
        let text = format!("{}{text}", self.env.scope.frames.last().map_or("", |f| &*f.prefix));
        let name_id = m.names[name.symbol.0 as usize];
        self.check_free(name_id, name.span, false)?;
        let default = self.number(m, value)?;
        let range = match range {
            Some((low, high)) => {
                let (low, high) = (self.number(m, low)?.re(), self.number(m, high)?.re());
                if low > high {
                    return Err(Diagnostic::error("empty-range", format!("`{text}` has no value"))
                        .at(name.span)
                        .expected("[low, high] with low <= high")
                        .found(format!("[{low}, {high}]")));
                }
                Some((low, high))
            }
            None => None,
        };
        let given = self.inputs.overrides.get(&text).copied();
        let plain = given.map_or(default, T::from);
        let x = plain.re();
        let wrong = |expected: String| {
            Diagnostic::error("out-of-range", format!("`{text}` = {x} is out of its range"))
                .at(name.span)
                .expected(expected)
                .found(number::plain(x))
        };
        if let Some((low, high)) = range
            && !(low..=high).contains(&x)
        {
            return Err(wrong(format!("a number from {low} to {high}")));
        }
        if !x.is_finite() {
            return Err(wrong("a finite number".into()));
        }
        if is_int && (x.fract() != 0.0 || x.abs() >= variables::MOST_INT) {
            return Err(wrong("a whole number below 2^53".into()));
        }
        let value = (self.inputs.seed)(&text, plain);
        let number = self.env.params.len();
        self.env.params.push(Param {
            name: text,
            value: value.re(),
            default: default.re(),
            range,
            is_int,
            span: name.span,
        });
        self.env.param_values.push(value);
        self.env.scope.bind(name_id, name.span, Binding::Param(number));
        Ok(())
    }

    pub(super) fn assign(
        &mut self,
        m: &Module,
        target: ExprId,
        op: AssignOp,
        value: ExprId,
    ) -> Result<(), Diagnostic> {
        let right = match op {
            AssignOp::Set => {
                if self.names_list(m, target) {
                    self.list_operand(m, value)?
                } else {
                    self.operand(m, value)?
                }
            }
            AssignOp::With(op) => self.updated(m, target, op, value)?,
        };
        let (place, chosen) = self.target(m, target)?;
        if let Some(chosen) = chosen {
            let at = m.program[target].span;
            return self.store_chosen(place, &chosen, right).map_err(|d| d.or_at(at));
        }
        let shape = variables::shape_of(&right);
        self.store(place, right).map_err(|d| {
            let spans = [target, value].map(|e| m.program[e].span);
            let to = match self.env.scope.root(&place).map(|bound| &bound.what) {
                Some(Binding::Variable { value, .. }) if d.id == "shapes-differ" => {
                    variables::shape_at(value, &place)
                }
                _ => String::new(),
            };
            self.differing(m, d, spans, [&to, &shape.to_string()]).or_at(spans[0])
        })
    }

    fn call_statement(&mut self, m: &Module, expr: ExprId) -> Result<Flow<T>, Diagnostic> {
        if let ExprKind::Call { callee, args } = m.program[expr].kind
            && let Some(symbol) = m.program.as_name(callee)
            && let Some(routine) = self.routine_named(m.names[symbol.0 as usize])
        {
            self.call_routine(m, routine, args, None, m.program[expr].span)?;
            return Ok(if self.env.stopped { Flow::Stop } else { Flow::Next });
        }
        // Such a call has no value, but its errors are reported.
        self.expr(m, expr)?;
        Ok(Flow::Next)
    }

    /// The routine of that name: one passed as an argument, or one of the program.
    pub fn routine_named(&self, name: Name) -> Option<RoutineAt> {
        match self.env.scope.lookup(name).map(|bound| &bound.what) {
            Some(Binding::Routine(at)) => Some(*at),
            Some(Binding::Function(_)) => None,
            _ => self.env.scope.routines.get(&name).copied(),
        }
    }

    pub fn unknown_kind(&self, word: &str) -> Diagnostic {
        let kinds = self.loader.registry.rows().filter(|r| r.kind).map(|r| &*r.name);
        let routines = self.env.scope.routines.keys().map(|&name| &**self.modules.text(name));
        Diagnostic::error("unknown-entity", format!("unknown kind `{word}`"))
            .expected("the name of an entity kind or of a subroutine")
            .suggest(word, kinds.chain(routines))
            .help("`moldloft doc --list` lists all kinds")
    }

    /// Number of errors so far.
    pub fn error_count(&self) -> usize {
        self.usage.errors
    }

    /// True while searches for hints are worthwhile.
    pub fn hints(&self) -> bool {
        self.usage.errors < MOST_HINTS
    }

    /// The most similar name that has a meaning here.
    pub fn nearest_name(&self, word: &str) -> Option<String> {
        if !self.hints() {
            return None;
        }
        let frame = self.env.scope.frame();
        let locals = frame.locals.iter().map(|(name, _)| *name);
        let globals = self.env.scope.globals.iter().enumerate();
        let globals = globals.filter(|(_, b)| b.is_some()).map(|(k, _)| Name(k as u32));
        let variables = locals.chain(globals).map(|name| &**self.modules.text(name));
        let functions = self.loader.registry.rows().filter(|r| !r.kind).map(|r| &*r.name);
        let scope = &self.env.scope;
        let mut own: Vec<&str> = scope
            .routines
            .keys()
            .chain(scope.records.keys())
            .map(|&name| &**self.modules.text(name))
            .collect();
        own.sort_unstable();
        let all = variables.chain(own).chain(["PI"]);
        // The first of equally near names.
        nearest(word, all.chain(functions)).map(str::to_string)
    }

    /// Stores a value into elements of a place selected by masks or index arrays.
    fn store_chosen(
        &mut self,
        place: Place,
        chosen: &Chosen,
        value: Value<T>,
    ) -> Result<(), Diagnostic> {
        let whole = Place { component: None, ..place };
        let Some(bound) = self.env.scope.root(&whole) else { return Err(silent()) };
        let Binding::Variable { value: old, known, .. } = &bound.what else {
            return Err(silent());
        };
        let mut part = variables::at_place(old, &whole)?;
        let mut known = known.clone();
        chosen.put(&mut part, place.component, value)?;
        self.store(whole, part)?;
        // The other elements are as unset as they were.
        if whole.section.is_none()
            && whole.path.is_empty()
            && let Some(bound) = self.env.scope.root_mut(&whole)
            && let Binding::Variable { value, known: now, .. } = &mut bound.what
        {
            known.give_each(&chosen.positions, value);
            *now = known;
        }
        Ok(())
    }

    pub fn store(&mut self, place: Place, value: Value<T>) -> Result<(), Diagnostic> {
        let text = self.modules.text(place.name).clone();
        if place.frame.is_none() && self.run.extent() == Extent::Edit {
            return Err(Diagnostic::error(
                "misplaced-assignment",
                format!("`{text}` is not assigned here: the expression is not part of the program"),
            )
            .expected("an expression that reads the program's variables")
            .help("put the statement into the program"));
        }
        if !place.path.is_empty() {
            return self.store_inside(place, value);
        }
        let Some(bound) = self.env.scope.root_mut(&place) else { return Err(silent()) };
        match &mut bound.what {
            Binding::Variable { ty, value: old, fixed, known } => {
                let taken = Taken { ty: *ty, fixed: *fixed, name: &text };
                let replaced = variables::store(taken, old, &place, value)?;
                known.give(place.section, old);
                if let Some(replaced) = replaced {
                    self.arrays.spare.give(replaced);
                }
                Ok(())
            }
            Binding::Poisoned => Err(silent()),
            _ => {
                Err(Diagnostic::error("not-assignable", format!("`{text}` cannot be assigned to"))
                    .found("an object or parameter")
                    .note_at(bound.span, "declared here")
                    .help("objects are named once; change their data, or use a variable"))
            }
        }
    }
}
