//! Runs a program: statements.

use crate::env::{Binding, Bound, Environment, Frame, Origin, Param, Turn};
use crate::module::{Loader, Module, Modules, Name, RoutineAt};
use crate::ops;
use crate::variables::{self, Taken};
use indexmap::IndexMap;
use moldloft_diag::{Diagnostic, Span, nearest};
use moldloft_model::{Declaration, Run};
use moldloft_num::trace::Key;
use moldloft_registry::{Given, Scalar, Value, arrange};
use moldloft_syntax::number;
use moldloft_syntax::sdl::{
    Arg, AssignOp, ChainItem, Declarator, ExprId, ExprKind, Formal, Ident, List, StmtId, StmtKind,
    Type,
};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The most statements and calls of a run.
pub const MOST_STEPS: u64 = 20_000_000;

/// Statements, expressions and calls nest at most this deep while running.
pub(crate) const DEEPEST: u32 = 2_500;

/// The stack that a run needs: the deepest nesting times the largest frame, with room to spare.
pub(crate) const STACK_BYTES: usize = 192 << 20;

/// The id of a diagnostic that is not shown, because its cause was reported already.
pub(crate) const SILENT: &str = "silent";

/// What a run is given besides the program.
pub(crate) struct Inputs<'a, T: Scalar> {
    /// Values of parameters that differ from the text's.
    pub overrides: &'a IndexMap<String, f64>,
    /// Gives a parameter or a literal of an object its derivative; for plain runs the identity.
    pub seed: Seed<'a, T>,
    /// Objects with seeded literals, by name.
    pub seeded_objects: &'a HashSet<String>,
    /// Set from outside to stop the run.
    pub cancelled: &'a AtomicBool,
}

/// Gives the number of that name its derivatives.
pub(crate) type Seed<'a, T> = &'a (dyn Fn(&str, T) -> T + Sync);

/// How a statement ended.
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
    pub frames: Vec<Frame<T>>,
    pub depth: u32,
    steps: u64,
    turns: u64,
    executed: HashSet<usize>,
    /// Names that are declared somewhere in the main file: for hints at what comes later.
    pub(crate) current: usize,
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
        env.globals.resize_with(modules.name_count(), || None);
        Self {
            modules,
            loader,
            run,
            env,
            inputs,
            frames: vec![Frame::new(true, "".into())],
            depth: 0,
            steps: 0,
            turns: 0,
            executed: HashSet::new(),
            current: 0,
        }
    }

    /// Runs a module from its first statement to its last, once.
    pub fn module(&mut self, at: usize) -> Flow<T> {
        if !self.executed.insert(at) {
            return Flow::Next;
        }
        let module = self.modules.get(at).clone();
        self.env.globals.resize_with(self.modules.name_count(), || None);
        self.declare_routines(&module, at);
        let outer = std::mem::replace(&mut self.current, at);
        let flow = self.statements(&module, module.program.body());
        self.current = outer;
        match flow {
            Flow::Stop => Flow::Stop,
            _ => Flow::Next,
        }
    }

    pub fn report(&mut self, diagnostic: Diagnostic) {
        if diagnostic.id != SILENT {
            self.loader.diagnostics.push(diagnostic);
        }
    }

    fn declare_routines(&mut self, module: &Module, at: usize) {
        for (k, routine) in module.program.routines().iter().enumerate() {
            let name = module.names[routine.name.symbol.0 as usize];
            let here = RoutineAt { module: at, routine: moldloft_syntax::sdl::RoutineId(k as u32) };
            let text = self.modules.text(name).clone();
            match self.env.routines.get(&name) {
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
                            format!("`{text}` of the program stands in for the library's"),
                        )
                        .at(first),
                    );
                }
                _ => drop(self.env.routines.insert(name, here)),
            }
        }
    }

    /// Counts a step; true when the run must stop.
    fn step(&mut self, span: Span) -> bool {
        self.steps += 1;
        if self.env.stopped {
            return true;
        }
        if self.steps > MOST_STEPS {
            return self.stop(
                Diagnostic::error("too-many-steps", "the program does not come to an end")
                    .at(span)
                    .expected(format!("at most {MOST_STEPS} statements"))
                    .help("look for a loop whose condition always holds"),
            );
        }
        if self.steps % 1024 == 0 && self.inputs.cancelled.load(Ordering::Relaxed) {
            return self.stop(Diagnostic::error("cancelled", "the run was cancelled").at(span));
        }
        false
    }

    pub fn stop(&mut self, diagnostic: Diagnostic) -> bool {
        if !self.env.stopped {
            self.env.stopped = true;
            self.report(diagnostic);
        }
        true
    }

    /// Goes one level deeper; false when that is too deep.
    pub fn deeper(&mut self, span: Span) -> bool {
        if self.depth >= DEEPEST {
            self.stop(
                Diagnostic::error("nested-too-deep", "calls nest too deep")
                    .at(span)
                    .expected(format!("at most {DEEPEST} levels of statements and calls"))
                    .help("look for a subroutine that calls itself without end"),
            );
            return false;
        }
        self.depth += 1;
        true
    }

    pub fn frame(&mut self) -> &mut Frame<T> {
        self.frames.last_mut().expect("there is always a frame")
    }

    pub fn bind(&mut self, name: Name, span: Span, what: Binding<T>) {
        let bound = Bound { span, what };
        let frame = self.frames.last_mut().expect("there is always a frame");
        if frame.global {
            let at = name.0 as usize;
            if at >= self.env.globals.len() {
                self.env.globals.resize_with(at + 1, || None);
            }
            self.env.globals[at] = Some(bound);
            return;
        }
        match frame.locals.iter_mut().find(|(n, _)| *n == name) {
            Some((_, old)) => *old = bound,
            None => frame.locals.push((name, bound)),
        }
    }

    pub fn lookup(&self, name: Name) -> Option<&Bound<T>> {
        let frame = self.frames.last().expect("there is always a frame");
        let local = frame.locals.iter().find(|(n, _)| *n == name).map(|(_, bound)| bound);
        local.or_else(|| self.env.globals.get(name.0 as usize)?.as_ref())
    }

    pub fn lookup_mut(&mut self, name: Name) -> Option<&mut Bound<T>> {
        let frame = self.frames.last_mut().expect("there is always a frame");
        if let Some(at) = frame.locals.iter().position(|(n, _)| *n == name) {
            return Some(&mut frame.locals[at].1);
        }
        self.env.globals.get_mut(name.0 as usize)?.as_mut()
    }

    fn statements(&mut self, m: &Module, list: List<StmtId>) -> Flow<T> {
        for &stmt in &m.program[list] {
            match self.statement(m, stmt) {
                Flow::Next => {}
                other => return other,
            }
        }
        Flow::Next
    }

    fn statement(&mut self, m: &Module, id: StmtId) -> Flow<T> {
        let stmt = m.program[id];
        if self.step(stmt.span) || !self.deeper(stmt.span) {
            return Flow::Stop;
        }
        let flow = self.statement_of(m, id, stmt.kind, stmt.span).unwrap_or_else(|diagnostic| {
            self.report(diagnostic.or_at(stmt.span));
            Flow::Next
        });
        self.depth -= 1;
        if self.env.stopped { Flow::Stop } else { flow }
    }

    fn statement_of(
        &mut self,
        m: &Module,
        id: StmtId,
        kind: StmtKind,
        span: Span,
    ) -> Result<Flow<T>, Diagnostic> {
        match kind {
            StmtKind::Object { kind, name, args } => self.object(m, id, kind, name, args, span)?,
            StmtKind::Block(list) => return Ok(self.statements(m, list)),
            StmtKind::Declare { global, ty, items } => {
                for item in &m.program[items] {
                    if let Err(diagnostic) = self.declare(m, global, ty.0, ty.1, item) {
                        self.report(diagnostic.or_at(item.name.span));
                        let name = m.names[item.name.symbol.0 as usize];
                        self.bind(name, item.name.span, Binding::Poisoned);
                    }
                }
            }
            StmtKind::Param { ty, name, value, range } => {
                if let Err(diagnostic) = self.param(m, ty, name, value, range) {
                    self.bind(m.names[name.symbol.0 as usize], name.span, Binding::Poisoned);
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
                    words.push(crate::show::plain(&value));
                }
                self.env.printed.push(words.join(" "));
            }
            StmtKind::Assert { condition, message } => self.assert(m, condition, message)?,
            StmtKind::Load(path) => {
                let path = m.program[path].to_string();
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
            StmtKind::Routine(_) | StmtKind::Error => {}
        }
        Ok(Flow::Next)
    }

    fn condition(&mut self, m: &Module, expr: ExprId) -> Result<bool, Diagnostic> {
        let value = self.expr(m, expr)?;
        match self.read(value, m.program[expr].span)? {
            Value::Number(x) => Ok(x.re() != 0.0),
            other => Err(Diagnostic::error("wrong-condition", "a condition must be a number")
                .at(m.program[expr].span)
                .expected("a comparison, or a number (0 is false)")
                .found(other.class().a())),
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
        let mut text = format!("this does not hold: {}", m.program.slice(span));
        if let Some(message) = message {
            let value = self.expr(m, message)?;
            text = crate::show::plain(&self.read(value, m.program[message].span)?);
        }
        let mut diagnostic = Diagnostic::error("assertion-failed", text).at(span);
        // Both sides of a comparison, so that the numbers are at hand.
        if let ExprKind::Binary { left, right, .. } = m.program[m.program.bare(condition)].kind {
            let mut sides = Vec::new();
            for side in [left, right] {
                let value = self.expr(m, side)?;
                sides.push(crate::show::plain(&self.read(value, span)?));
            }
            diagnostic = diagnostic.found(sides.join(" and "));
        }
        Err(diagnostic)
    }

    /// A turn of a loop.
    fn turn(&mut self, m: &Module, label: Option<String>, body: StmtId, span: Span) -> Flow<T> {
        if self.step(span) {
            return Flow::Stop;
        }
        self.turns += 1;
        let id = self.turns;
        self.frame().loops.push(Turn { label, id });
        let flow = self.statement(m, body);
        self.frame().loops.pop();
        flow
    }

    fn for_range(
        &mut self,
        m: &Module,
        variable: Ident,
        bounds: [Option<ExprId>; 3],
        body: StmtId,
        span: Span,
    ) -> Result<Flow<T>, Diagnostic> {
        let mut numbers = [T::one(); 3];
        for (number, expr) in numbers.iter_mut().zip(bounds) {
            if let Some(expr) = expr {
                *number = self.number(m, expr)?;
            }
        }
        let [from, to, step] = numbers;
        if step.re() == 0.0 || !from.re().is_finite() || !to.re().is_finite() {
            return Err(Diagnostic::error("endless-loop", "this loop cannot come to an end")
                .at(span)
                .expected("finite ends and a step other than 0")
                .found(format!("{}:{}:{}", from.re(), to.re(), step.re())));
        }
        // Half a millionth of a step of slack, so that 0:1:0.1 has its last turn.
        let count = ((to.re() - from.re()) / step.re() + 5e-7).floor();
        let name = m.names[variable.symbol.0 as usize];
        let mut k = 0.0;
        while k <= count {
            let value = from + step * k;
            let what =
                Binding::Variable { ty: Type::Float, value: Value::Number(value), fixed: false };
            self.bind(name, variable.span, what);
            match self.turn(m, Some(number::plain(value.re())), body, span) {
                Flow::Break => break,
                Flow::Next | Flow::Continue => {}
                other => return Ok(other),
            }
            k += 1.0;
        }
        Ok(Flow::Next)
    }

    fn for_classic(
        &mut self,
        m: &Module,
        [start, step]: [Option<StmtId>; 2],
        condition: Option<ExprId>,
        body: StmtId,
        span: Span,
    ) -> Result<Flow<T>, Diagnostic> {
        let mut variable = None;
        if let Some(start) = start {
            if let StmtKind::Assign { target, .. } = m.program[start].kind {
                variable = m.program.as_name(target);
            }
            match self.statement(m, start) {
                Flow::Next => {}
                other => return Ok(other),
            }
        }
        loop {
            if let Some(condition) = condition
                && !self.condition(m, condition)?
            {
                return Ok(Flow::Next);
            }
            let label = variable.and_then(|symbol| {
                match &self.lookup(m.names[symbol.0 as usize])?.what {
                    Binding::Variable { value: Value::Number(x), .. } => {
                        Some(number::plain(x.re()))
                    }
                    _ => None,
                }
            });
            match self.turn(m, label, body, span) {
                Flow::Break => return Ok(Flow::Next),
                Flow::Next | Flow::Continue => {}
                other => return Ok(other),
            }
            if let Some(step) = step {
                match self.statement(m, step) {
                    Flow::Next => {}
                    other => return Ok(other),
                }
            }
        }
    }

    fn foreach(
        &mut self,
        m: &Module,
        variable: Ident,
        list: ExprId,
        body: StmtId,
        span: Span,
    ) -> Result<Flow<T>, Diagnostic> {
        let value = self.expr(m, list)?;
        let items: Vec<Value<T>> = match &value {
            Value::List(items) => items.to_vec(),
            Value::Numbers(a) => a.items.iter().map(|&x| Value::Number(x)).collect(),
            Value::Vectors(a) => a.items.iter().map(|&v| Value::Vector(v)).collect(),
            other => {
                return Err(Diagnostic::error("not-a-list", "foreach walks through a list")
                    .at(m.program[list].span)
                    .expected("a list, farray or row of vectors")
                    .found(other.class().a()));
            }
        };
        let name = m.names[variable.symbol.0 as usize];
        for (k, item) in items.into_iter().enumerate() {
            let what = match item {
                Value::Object(key) => Binding::Object(key),
                value => {
                    Binding::Variable { ty: variables::type_of(&value), value, fixed: false }
                }
            };
            self.bind(name, variable.span, what);
            match self.turn(m, Some((k + 1).to_string()), body, span) {
                Flow::Break => break,
                Flow::Next | Flow::Continue => {}
                other => return Ok(other),
            }
        }
        Ok(Flow::Next)
    }

    fn declare(
        &mut self,
        m: &Module,
        global: bool,
        ty: Type,
        ty_span: Span,
        item: &Declarator,
    ) -> Result<(), Diagnostic> {
        if let Type::Other(symbol) = ty {
            return Err(self.unknown_type(m.program.name(symbol)).at(ty_span));
        }
        let mut dims = Vec::new();
        for &dim in &m.program[item.dims] {
            let n = self.number(m, dim)?.re();
            dims.push(variables::extent(n).map_err(|d| d.or_at(m.program[dim].span))?);
        }
        let value = match item.value {
            Some(expr) => {
                let span = m.program[expr].span;
                let value = self.expr(m, expr)?;
                let value = self.read(value, span)?;
                Some(variables::converted(ty, value).map_err(|d| d.or_at(span))?)
            }
            None => None,
        };
        let value = variables::initial(ty, &dims, value)?;
        let what = Binding::Variable { ty, value, fixed: !dims.is_empty() };
        let name = m.names[item.name.symbol.0 as usize];
        self.check_free(name, item.name.span, true)?;
        if global && !self.frame().global {
            self.env.globals[name.0 as usize] = Some(Bound { span: item.name.span, what });
        } else {
            self.bind(name, item.name.span, what);
        }
        Ok(())
    }

    fn unknown_type(&self, word: &str) -> Diagnostic {
        const TYPES: [&str; 11] = [
            "int", "float", "string", "vector", "farray", "curve", "surface", "pcurve", "psurface",
            "field", "param",
        ];
        Diagnostic::error("unknown-type", format!("there is no type `{word}`"))
            .suggest(word, TYPES)
            .help("an object is declared with its data in parentheses: AbsPoint P(0, 0, 1);")
    }

    /// An object must not take a name that means something already; a variable may be declared
    /// again in another turn of a loop.
    fn check_free(&self, name: Name, span: Span, variable: bool) -> Result<(), Diagnostic> {
        let frame = self.frames.last().expect("there is always a frame");
        let known = if frame.global {
            self.env.globals.get(name.0 as usize).and_then(Option::as_ref)
        } else {
            frame.locals.iter().find(|(n, _)| *n == name).map(|(_, b)| b)
        };
        let Some(known) = known else { return Ok(()) };
        let clash = match &known.what {
            Binding::Poisoned => false,
            Binding::Variable { .. } => !variable,
            Binding::Turn { .. } | Binding::Instance(_) => variable,
            Binding::Object(_) | Binding::Param(_) => true,
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
        if !self.frame().global || !self.frame().loops.is_empty() {
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
                return Err(Diagnostic::error("wrong-type", "a parameter is a float or an int")
                    .at(span));
            }
        };
        let text = self.modules.text(m.names[name.symbol.0 as usize]).to_string();
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
        if is_int && x.fract() != 0.0 {
            return Err(wrong("a whole number".into()));
        }
        let value = (self.inputs.seed)(&text, plain);
        let number = self.env.params.len();
        self.env.params.push(Param {
            name: text,
            value: x,
            default: default.re(),
            range,
            is_int,
            span: name.span,
        });
        self.env.param_values.push(value);
        self.bind(name_id, name.span, Binding::Param(number));
        Ok(())
    }

    fn assign(
        &mut self,
        m: &Module,
        target: ExprId,
        op: AssignOp,
        value: ExprId,
    ) -> Result<(), Diagnostic> {
        let right = self.expr(m, value)?;
        let right = self.read(right, m.program[value].span)?;
        let right = match op {
            AssignOp::Set => right,
            AssignOp::With(op) => {
                let old = self.expr(m, target)?;
                let old = self.read(old, m.program[target].span)?;
                ops::binary(op, &old, &right).map_err(|d| d.or_at(m.program[value].span))?
            }
        };
        let place = self.place(m, target)?;
        self.store(place, right).map_err(|d| d.or_at(m.program[target].span))
    }

    fn call_statement(&mut self, m: &Module, expr: ExprId) -> Result<Flow<T>, Diagnostic> {
        if let ExprKind::Call { callee, args } = m.program[expr].kind
            && let Some(symbol) = m.program.as_name(callee)
            && let Some(&routine) = self.env.routines.get(&m.names[symbol.0 as usize])
        {
            self.call_routine(m, routine, args, None, m.program[expr].span)?;
            return Ok(if self.env.stopped { Flow::Stop } else { Flow::Next });
        }
        // A call for its effect alone has none, but its errors are worth hearing.
        self.expr(m, expr)?;
        Ok(Flow::Next)
    }

    /// Calls a routine; `instance` goes before the names of the objects that it declares.
    pub fn call_routine(
        &mut self,
        m: &Module,
        at: RoutineAt,
        args: List<Arg>,
        instance: Option<Arc<str>>,
        span: Span,
    ) -> Result<Option<Value<T>>, Diagnostic> {
        let callee = self.modules.get(at.module).clone();
        let routine = callee.program[at.routine];
        let name = callee.program.name(routine.name.symbol).to_string();
        let formals: Vec<Formal> = callee.program[routine.formals].to_vec();
        let given: Vec<Arg> = m.program[args].to_vec();
        let ordered = self.order_arguments(m, &callee, &name, &formals, &given, span)?;

        let prefix = instance.clone().unwrap_or_else(|| self.frame().prefix.clone());
        let mut frame = Frame::new(false, prefix);
        if instance.is_none() {
            frame.loops = self.frame().loops.clone();
        }
        let mut returns = Vec::new();
        for (formal, exprs) in formals.iter().zip(ordered) {
            let local = callee.names[formal.name.symbol.0 as usize];
            let what = if formal.multiple {
                let mut items = Vec::new();
                for expr in exprs {
                    items.push(self.argument(m, formal, expr)?);
                }
                Binding::Variable { ty: formal.ty.0, value: Value::list(items), fixed: false }
            } else {
                let expr = exprs[0];
                if formal.returned {
                    returns.push((local, self.place(m, expr)?, m.program[expr].span));
                }
                match self.argument(m, formal, expr)? {
                    Value::Object(key) => Binding::Object(key),
                    value => {
                        // A returned argument keeps the shape of what is passed.
                        Binding::Variable { ty: formal.ty.0, value, fixed: formal.returned }
                    }
                }
            };
            frame.locals.push((local, Bound { span: formal.name.span, what }));
        }
        if !self.deeper(span) {
            return Err(silent());
        }
        self.frames.push(frame);
        let outer = std::mem::replace(&mut self.current, at.module);
        let flow = self.statements(&callee, routine.body);
        self.current = outer;
        let frame = self.frames.pop().expect("pushed above");
        self.depth -= 1;
        for (local, place, span) in returns {
            let bound = frame.locals.iter().find(|(n, _)| *n == local).map(|(_, b)| b);
            if let Some(Bound { what: Binding::Variable { value, .. }, .. }) = bound {
                self.store(place, value.clone()).map_err(|d| d.or_at(span))?;
            }
        }
        match flow {
            Flow::Return(value) => Ok(value),
            Flow::Stop => Err(silent()),
            _ => Ok(None),
        }
    }

    /// The expressions for each formal argument, in order.
    fn order_arguments(
        &self,
        m: &Module,
        callee: &Module,
        name: &str,
        formals: &[Formal],
        given: &[Arg],
        span: Span,
    ) -> Result<Vec<Vec<ExprId>>, Diagnostic> {
        let spelled: Vec<&str> =
            formals.iter().map(|f| callee.program.name(f.name.symbol)).collect();
        let signature = format!("{name}({})", spelled.join(", "));
        let mut ordered: Vec<Vec<ExprId>> = vec![Vec::new(); formals.len()];
        for (k, arg) in given.iter().enumerate() {
            let at = match arg.name {
                Some(ident) => {
                    let word = m.program.name(ident.symbol);
                    spelled.iter().position(|s| *s == word).ok_or_else(|| {
                        Diagnostic::error(
                            "unknown-argument",
                            format!("{name} has no argument `{word}`"),
                        )
                        .at(ident.span)
                        .expected(&signature)
                        .suggest(word, spelled.iter().copied())
                    })?
                }
                None if k < formals.len() => k,
                None if formals.last().is_some_and(|f| f.multiple) => formals.len() - 1,
                None => {
                    return Err(Diagnostic::error(
                        "too-many-arguments",
                        format!("{name} takes {} arguments", formals.len()),
                    )
                    .at(m.program[arg.value].span)
                    .expected(&signature)
                    .found(format!("{} arguments", given.len())));
                }
            };
            if !ordered[at].is_empty() && !formals[at].multiple {
                return Err(Diagnostic::error(
                    "argument-twice",
                    format!("`{}` of {name} is given twice", spelled[at]),
                )
                .at(m.program[arg.value].span));
            }
            ordered[at].push(arg.value);
        }
        for (k, formal) in formals.iter().enumerate() {
            if ordered[k].is_empty() && !formal.multiple {
                return Err(Diagnostic::error(
                    "missing-argument",
                    format!("{name} needs `{}`", spelled[k]),
                )
                .at(span)
                .expected(&signature)
                .found(format!("{} arguments", given.len()))
                .note_at(formal.name.span, "declared here"));
            }
        }
        Ok(ordered)
    }

    /// The value of an argument of a routine, of the formal's type. An argument of an object class
    /// (`AbsPoint p`, or any other word) takes an object as it is.
    fn argument(
        &mut self,
        m: &Module,
        formal: &Formal,
        expr: ExprId,
    ) -> Result<Value<T>, Diagnostic> {
        let span = m.program[expr].span;
        let value = self.expr(m, expr)?;
        let shape = matches!(formal.ty.0, Type::Pcurve | Type::Psurface | Type::Other(_));
        if shape && matches!(value, Value::Object(_)) {
            return Ok(value);
        }
        let value = self.read(value, span)?;
        if formal.returned && matches!(value, Value::Unset) {
            return Ok(value);
        }
        variables::converted(formal.ty.0, value)
            .map_err(|d| d.or_at(span).note_at(formal.ty.1, "asked for here"))
    }

    fn object(
        &mut self,
        m: &Module,
        id: StmtId,
        kind: Ident,
        name: Ident,
        args: List<Arg>,
        span: Span,
    ) -> Result<(), Diagnostic> {
        let outcome = self.object_of(m, id, kind, name, args, span);
        if outcome.is_err() {
            let name_id = m.names[name.symbol.0 as usize];
            let taken = self.lookup(name_id).is_some_and(|b| !matches!(b.what, Binding::Poisoned));
            if !taken {
                self.bind(name_id, name.span, Binding::Poisoned);
            }
        }
        outcome
    }

    fn object_of(
        &mut self,
        m: &Module,
        id: StmtId,
        kind: Ident,
        name: Ident,
        args: List<Arg>,
        span: Span,
    ) -> Result<(), Diagnostic> {
        let name_id = m.names[name.symbol.0 as usize];
        let word = m.program.name(kind.symbol);
        let row = match &m.rows[kind.symbol.0 as usize] {
            Some(row) if row.kind => row,
            other => {
                if let Some(&routine) = self.env.routines.get(&m.names[kind.symbol.0 as usize]) {
                    return self.instance(m, routine, name, args, span);
                }
                if other.is_some() {
                    return Err(Diagnostic::error(
                        "not-a-kind",
                        format!("`{word}` is a function, not a kind of object"),
                    )
                    .at(kind.span)
                    .help(format!("call it in an expression: curve x = {word}(...);")));
                }
                return Err(self.unknown_kind(word).at(kind.span));
            }
        };
        let mut given = Given { positional: Vec::with_capacity(args.len()), named: Vec::new() };
        let mut failed = None;
        for arg in &m.program[args] {
            match (self.expr(m, arg.value), arg.name) {
                (Ok(value), None) => given.positional.push(value),
                (Ok(value), Some(ident)) => {
                    given.named.push((m.program.name(ident.symbol), value));
                }
                // Go on: the other arguments may have errors worth telling as well.
                (Err(diagnostic), _) => {
                    let shown = diagnostic.or_at(m.program[arg.value].span);
                    if let Some(earlier) = failed.replace(shown) {
                        self.report(earlier);
                    }
                }
            }
        }
        if let Some(diagnostic) = failed {
            return Err(diagnostic);
        }
        let positional = given.positional.len();
        let (mut filled, head) = arrange(row, given, |key| self.run.class_of(key))
            .map_err(|fault| crate::place::diagnostic(m, args, row, positional, &fault, span))?;

        let (full, turn) = self.full_name(m, name)?;
        let known = self.lookup(name_id).map(|b| b.span);
        if turn.is_none() {
            self.check_free(name_id, name.span, false)?;
        }
        let full = full.as_deref().unwrap_or_else(|| m.program.name(name.symbol));
        if !self.inputs.seeded_objects.is_empty() && self.inputs.seeded_objects.contains(full) {
            let seed = self.inputs.seed;
            crate::place::seed(row, &mut filled, full, seed);
        }
        let origin = self.env.origins.len() as u32;
        let declaration = Declaration { name: full, row, args: filled, head, origin };
        let key = self.run.declare(declaration).map_err(|fault| {
            let diagnostic = crate::place::unplaced(&fault).at(name.span);
            match known {
                Some(first) => diagnostic.note_at(first, "first declared here"),
                None => diagnostic,
            }
        })?;
        let frame = self.frames.last().expect("there is always a frame");
        let repeated = !frame.global || !frame.loops.is_empty() || !frame.prefix.is_empty();
        self.env.origins.push(Origin { module: self.current as u32, stmt: id, repeated });
        let what = match turn {
            None => Binding::Object(key),
            Some((family, turn)) => Binding::Turn { now: key, turn, family },
        };
        self.enter_families(full, key);
        self.bind(name_id, name.span, what);
        Ok(())
    }

    /// The name of an object, when it differs from the one written: with the call it is made in
    /// and the values of the loop variables; and in loops the family and the turn.
    #[allow(clippy::type_complexity)]
    fn full_name(
        &mut self,
        m: &Module,
        name: Ident,
    ) -> Result<(Option<String>, Option<(Arc<str>, u64)>), Diagnostic> {
        let text = m.program.name(name.symbol);
        let frame = self.frames.last().expect("there is always a frame");
        let family = if frame.prefix.is_empty() { None } else { Some(format!("{}{text}", frame.prefix)) };
        let Some(turn) = frame.loops.last() else { return Ok((family, None)) };
        let family: Arc<str> = family.as_deref().unwrap_or(text).into();
        let mut labels = Vec::new();
        for turn in &frame.loops {
            let Some(label) = &turn.label else {
                return Err(Diagnostic::error(
                    "no-loop-variable",
                    "an object in a loop takes its name from the loop variable, and this loop has \
                     none",
                )
                .at(name.span)
                .help("use `for (i = 1:n)`"));
            };
            labels.push(label.as_str());
        }
        Ok((Some(format!("{family}[{}]", labels.join(","))), Some((family, turn.id))))
    }

    /// Lists an object under the names that stand for several.
    fn enter_families(&mut self, full: &str, key: Key) {
        if let Some((family, _)) = full.rsplit_once('[')
            && full.ends_with(']')
        {
            match self.env.families.get_mut(family) {
                Some(keys) => keys.push(key),
                None => drop(self.env.families.insert(family.into(), vec![key])),
            }
        }
    }

    /// A named call of a subroutine: `leg fore(...)`.
    fn instance(
        &mut self,
        m: &Module,
        routine: RoutineAt,
        name: Ident,
        args: List<Arg>,
        span: Span,
    ) -> Result<(), Diagnostic> {
        let name_id = m.names[name.symbol.0 as usize];
        let (full, turn) = self.full_name(m, name)?;
        if turn.is_none() {
            self.check_free(name_id, name.span, false)?;
        }
        let full: Arc<str> = match full {
            Some(full) => full.into(),
            None => m.program.name(name.symbol).into(),
        };
        let family = match turn {
            Some((family, _)) => family,
            None => full.clone(),
        };
        self.bind(name_id, name.span, Binding::Instance(family));
        let prefix: Arc<str> = format!("{full}.").into();
        self.call_routine(m, routine, args, Some(prefix), span)?;
        Ok(())
    }

    pub fn unknown_kind(&self, word: &str) -> Diagnostic {
        let kinds = self.loader.registry.rows().filter(|r| r.kind).map(|r| &*r.name);
        let routines = self.env.routines.keys().map(|&name| &**self.modules.text(name));
        Diagnostic::error("unknown-entity", format!("there is no kind `{word}`"))
            .expected("the name of an entity kind or of a subroutine")
            .suggest(word, kinds.chain(routines))
            .help("`moldloft doc --list` lists all kinds")
    }

    /// The most alike of the names that mean something here.
    pub fn nearest_name(&self, word: &str) -> Option<String> {
        let frame = self.frames.last().expect("there is always a frame");
        let locals = frame.locals.iter().map(|(name, _)| *name);
        let globals = self.env.globals.iter().enumerate();
        let globals = globals.filter(|(_, b)| b.is_some()).map(|(k, _)| Name(k as u32));
        let variables = locals.chain(globals).map(|name| &**self.modules.text(name));
        let functions = self.loader.registry.rows().filter(|r| !r.kind).map(|r| &*r.name);
        nearest(word, variables.chain(functions)).map(str::to_string)
    }

    /// True when a chain of operators has a set or field among its operands.
    pub fn has_set(&self, items: &[ChainItem], values: &HashMap<ExprId, Value<T>>) -> bool {
        items.iter().any(|item| match item {
            ChainItem::Operand(expr) => matches!(values.get(expr), Some(Value::Field(_))),
            _ => false,
        })
    }

    fn store(&mut self, place: variables::Place, value: Value<T>) -> Result<(), Diagnostic> {
        let name = place.name;
        let text = self.modules.text(name).clone();
        let Some(bound) = self.lookup_mut(name) else { return Err(silent()) };
        match &mut bound.what {
            Binding::Variable { ty, value: old, fixed } => {
                let taken = Taken { ty: *ty, fixed: *fixed, name: &text };
                variables::store(taken, old, &place, value)
            }
            Binding::Poisoned => Err(silent()),
            _ => Err(Diagnostic::error("not-assignable", format!("`{text}` cannot be assigned to"))
                .found("an object or parameter")
                .note_at(bound.span, "declared here")
                .help("objects are named once; change their data, or use a variable")),
        }
    }
}
