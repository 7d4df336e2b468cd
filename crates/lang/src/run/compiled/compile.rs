//! Statements to code.
//!
//! Unsupported statements are left to the interpreter. A name declared by such a statement belongs
//! to the interpreter alone; if that is found after a use of the name, the region is compiled
//! again.

use super::code::{
    ActiveLoop, CallMoves, Captured, CodeArgument, CodeNote, CodeRange, CodeRegion, CodeSite,
    CodeUnit, Generation, NO_LABEL, NamePlace, Poisonable, RegionStart, Relation, ScalarOp,
    UNDECLARED,
};
use super::names::{Meaning, ids};
use super::registers::declared_by;
use crate::functions::elementary::Elementary;
use crate::source::module::{Modules, Name, RoutineAt};
use crate::source::scope::Scope;
use moldloft_diag::Span;
use moldloft_registry::Scalar;
use moldloft_syntax::sdl::{
    BinaryOp, ExprId, ExprKind, Ident, NodeList, StmtId, StmtKind, Subscript, Type, UnaryOp,
};
use std::collections::{HashMap, HashSet};

/// The most operations of a unit: indices in it are small numbers.
const MOST_CODE: usize = 30_000;

/// The most units of a region, and the most times it is compiled until all names are settled.
const MOST_UNITS: usize = 400;
const MOST_ATTEMPTS: usize = 24;

/// Why something is not compiled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Unfit {
    /// The interpreter executes the statement.
    Statement,
    /// The interpreter executes the whole routine or loop.
    Unit,
}

/// Known state of a variable at a position of the text.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sure {
    /// It was declared.
    pub bound: bool,
    /// Its declaration did not fail.
    pub live: bool,
}

/// A unit while it is compiled.
#[derive(Default)]
pub(super) struct UnitProgress<T> {
    pub variables: Vec<Sure>,
    pub arrays: Vec<Sure>,
    loops: Vec<LoopProgress>,
    constants: Vec<(T, u16)>,
    free: Vec<u16>,
    taken: Vec<u16>,
    free_vectors: Vec<u16>,
    taken_vectors: Vec<u16>,
    free_texts: Vec<u16>,
    pub taken_texts: Vec<u16>,
    registers: u16,
    compiled: usize,
    left: usize,
}

/// A loop while it is compiled.
struct LoopProgress {
    active: ActiveLoop,
    breaks: Vec<usize>,
    continues: Vec<usize>,
}

pub(super) struct RegionCompiler<'a, T: Scalar> {
    pub modules: &'a Modules,
    pub scope: &'a Scope<T>,
    pub units: Vec<CodeUnit<T>>,
    pub progress: Vec<UnitProgress<T>>,
    pub names: Vec<HashMap<Name, Poisonable>>,
    /// The formal arguments of each unit that are variables of the file, and which.
    pub references: Vec<HashMap<Name, Name>>,
    pub entry: usize,
    /// The current unit.
    pub unit: usize,
    pub guards: Vec<(Name, NamePlace, Captured)>,
    pub functions: Vec<(&'static str, Elementary<T>)>,
    /// The units of routines, one for each choice of the file's variables that are passed by reference.
    by_routine: HashMap<(usize, u32, Vec<Option<Name>>), usize>,
    hidden: HashSet<((u8, usize, u32), Name)>,
    refused: HashSet<(usize, u32)>,
    restart: bool,
    /// Jumps out of loops that were closed and are yet to land.
    closed: Vec<Vec<usize>>,
}

/// The code of a loop or a routine's body in `module`; `None` if compilation has no advantage.
pub(super) fn compile<T: Scalar>(
    modules: &Modules,
    scope: &Scope<T>,
    module: usize,
    start: RegionStart,
    of_file: &HashSet<Name>,
    generation: Generation,
) -> Option<CodeRegion<T>> {
    let mut hidden: HashSet<_> = of_file.iter().map(|&name| ((0, 0, 0), name)).collect();
    let mut refused = HashSet::new();
    for _ in 0..MOST_ATTEMPTS {
        let global = scope.frame().global;
        let mut compiler = RegionCompiler {
            modules,
            scope,
            units: Vec::new(),
            progress: Vec::new(),
            names: Vec::new(),
            references: Vec::new(),
            entry: usize::from(!global),
            unit: 0,
            guards: Vec::new(),
            functions: Vec::new(),
            by_routine: HashMap::new(),
            hidden: std::mem::take(&mut hidden),
            refused: std::mem::take(&mut refused),
            restart: false,
            closed: Vec::new(),
        };
        let outcome = compiler.region(module, start);
        if outcome.is_err() {
            return None;
        }
        if !compiler.restart {
            compiler.link();
            let RegionCompiler { units, entry, guards, functions, .. } = compiler;
            return Some(CodeRegion { units, entry, guards, functions, generation });
        }
        (hidden, refused) = (compiler.hidden, compiler.refused);
    }
    None
}

impl<T: Scalar> RegionCompiler<'_, T> {
    fn region(&mut self, module: usize, start: RegionStart) -> Result<(), Unfit> {
        let m = self.modules.get(module).clone();
        for _ in 0..=self.entry {
            self.new_unit(module, None);
        }
        self.unit = self.entry;
        let list = match start {
            RegionStart::Loop(stmt) => vec![stmt],
            RegionStart::Body(routine) => ids(&m, m.program.routines()[routine as usize].body),
        };
        self.reserve(self.entry, &list)?;
        match start {
            RegionStart::Loop(stmt) => {
                let at = self.here()?;
                let span = m.program[stmt].span;
                self.range(at, span, span, None, |this| this.compound(stmt))?;
                self.emit(ScalarOp::End)?;
            }
            RegionStart::Body(_) => {
                self.list(&list)?;
                self.emit(ScalarOp::End)?;
            }
        }
        let last = self.here()?;
        let span = list.first().map_or(Span::UNKNOWN, |&stmt| m.program[stmt].span);
        self.cover(0, last, span);
        self.finish(self.entry);
        if self.entry > 0 {
            self.finish(0);
        }
        let (compiled, left) = self
            .progress
            .iter()
            .fold((0, 0), |(compiled, left), unit| (compiled + unit.compiled, left + unit.left));
        // Handing variables over and back takes its time.
        if compiled == 0 || left > 3 * compiled {
            return Err(Unfit::Unit);
        }
        Ok(())
    }

    fn new_unit(&mut self, module: usize, routine: Option<RoutineAt>) -> usize {
        let m = self.modules.get(module).clone();
        self.units.push(CodeUnit::new(module, m, routine));
        self.progress.push(UnitProgress::default());
        self.names.push(HashMap::new());
        self.references.push(HashMap::new());
        self.units.len() - 1
    }

    /// All code that is of no statement is of the whole.
    fn cover(&mut self, start: u16, end: u16, span: Span) {
        let range = CodeRange { start, end: end.max(start + 1), span, fault: span, poison: None };
        self.units[self.unit].ranges.push(range);
    }

    fn finish(&mut self, unit: usize) {
        let progress = &self.progress[unit];
        self.units[unit].registers = progress.registers as usize;
        self.units[unit].constants =
            progress.constants.iter().map(|&(x, register)| (register, x)).collect();
        let code = &mut self.units[unit];
        code.marks = vec![UNDECLARED; code.variables.len()];
        for (k, formal) in code.formals.iter().enumerate() {
            if let Some(Poisonable::Variable(v)) = formal {
                code.marks[*v as usize] = declared_by(k as u16);
            }
        }
        for (few, mark) in code.few_marks.iter_mut().zip(&code.marks) {
            *few = *mark;
        }
        super::joins::join(&mut code.code);
    }

    /// What each call moves, now that all routines have their registers.
    fn link(&mut self) {
        for unit in 0..self.units.len() {
            let mut sites = std::mem::take(&mut self.units[unit].sites);
            for site in &mut sites {
                let callee = &self.units[site.unit];
                let (mut numbers, mut arrays) = (Vec::new(), Vec::new());
                for (k, (formal, argument)) in callee.formals.iter().zip(&site.args).enumerate() {
                    let register = |v: u16| callee.variables[v as usize].register;
                    match (*formal, *argument) {
                        (None, CodeArgument::OfFile) => {}
                        (Some(Poisonable::Variable(v)), CodeArgument::Vector { from }) => {
                            numbers.extend((0..3).map(|c| (from + c, register(v) + c)));
                        }
                        (Some(Poisonable::Variable(v)), CodeArgument::Number { from }) => {
                            numbers.push((from, register(v)));
                        }
                        (Some(Poisonable::Array(a)), CodeArgument::Array { from }) => {
                            arrays.push((from, a, k as u16));
                        }
                        _ => unreachable!("arguments are of their formals' kinds"),
                    }
                }
                site.moves = CallMoves { numbers: numbers.into(), arrays: arrays.into() };
            }
            self.units[unit].sites = sites;
        }
    }

    /// The unit of a routine; `roots` are the variables of the file that it gets by reference.
    ///
    /// # Errors
    /// When the interpreter must call it.
    pub fn routine(&mut self, at: RoutineAt, roots: &[Option<Name>]) -> Result<usize, Unfit> {
        let key = (at.module, at.routine.0);
        if self.refused.contains(&key) || self.units.len() >= MOST_UNITS {
            return Err(Unfit::Statement);
        }
        let with_roots = (key.0, key.1, roots.to_vec());
        if let Some(&unit) = self.by_routine.get(&with_roots) {
            return Ok(unit);
        }
        let outer = self.unit;
        let unit = self.new_unit(at.module, Some(at));
        self.by_routine.insert(with_roots, unit);
        self.unit = unit;
        let outcome = self.routine_of(unit, at, roots);
        self.unit = outer;
        self.finish(unit);
        if outcome.is_err() {
            self.refused.insert(key);
            self.restart = true;
            return Err(Unfit::Statement);
        }
        Ok(unit)
    }

    fn routine_of(
        &mut self,
        unit: usize,
        at: RoutineAt,
        roots: &[Option<Name>],
    ) -> Result<(), Unfit> {
        let m = self.units[unit].m.clone();
        let routine = m.program[at.routine];
        let plain = |ty: Type| matches!(ty, Type::Int | Type::Float | Type::Vector);
        // The handling of a fault depends on the kind of the routine.
        if m.library != self.units[self.entry].m.library
            || routine.result.is_some_and(|(ty, _)| !plain(ty))
        {
            return Err(Unfit::Unit);
        }
        for (formal, root) in m.program[routine.formals].iter().zip(roots) {
            let name = m.names[formal.name.symbol.0 as usize];
            if formal.multiple
                || self.is_hidden(unit, name)
                || self.names[unit].contains_key(&name)
                || self.references[unit].contains_key(&name)
            {
                return Err(Unfit::Unit);
            }
            let ty = formal.ty.0;
            if let Some(root) = root {
                self.references[unit].insert(name, *root);
                self.units[unit].references.push((name, formal.name.span, *root));
                self.units[unit].formals.push(None);
                self.units[unit].origins.push((formal.name.span, ty));
                continue;
            }
            let what = match ty {
                Type::Int | Type::Float | Type::Vector => {
                    self.new_variable(unit, name, Some(ty), None, false)
                }
                Type::Farray | Type::Curve | Type::Surface | Type::String => {
                    self.new_array(unit, Some(name), ty, false, false)
                }
                _ => return Err(Unfit::Unit),
            };
            self.set_known(what, true, true);
            self.units[unit].formals.push(Some(what));
            self.units[unit].origins.push((formal.name.span, ty));
        }
        let list = ids(&m, routine.body);
        self.reserve(unit, &list)?;
        self.list(&list)?;
        self.emit(ScalarOp::Leave)?;
        let last = self.here()?;
        self.cover(0, last, routine.span);
        Ok(())
    }

    pub fn key(&self, unit: usize) -> (u8, usize, u32) {
        match self.units[unit].routine {
            _ if unit == 0 => (0, 0, 0),
            Some(at) => (2, at.module, at.routine.0),
            None => (1, 0, 0),
        }
    }

    pub fn is_hidden(&self, unit: usize, name: Name) -> bool {
        self.hidden.contains(&(self.key(unit), name))
    }

    /// Leaves a name to the interpreter.
    pub fn hide(&mut self, unit: usize, name: Name) {
        let new = self.hidden.insert((self.key(unit), name));
        self.restart |= new && (unit == 0 || self.names[unit].contains_key(&name));
    }

    pub fn known(&self, what: Poisonable) -> Sure {
        let progress = &self.progress[self.unit];
        match what {
            Poisonable::Variable(k) => progress.variables[k as usize],
            Poisonable::Array(k) => progress.arrays[k as usize],
        }
    }

    pub fn set_known(&mut self, what: Poisonable, bound: bool, live: bool) {
        self.set_known_in(self.unit, what, bound, live);
    }

    pub fn set_known_in(&mut self, unit: usize, what: Poisonable, bound: bool, live: bool) {
        let progress = &mut self.progress[unit];
        let (all, k) = match what {
            Poisonable::Variable(k) => (&mut progress.variables, k as usize),
            Poisonable::Array(k) => (&mut progress.arrays, k as usize),
        };
        if all.len() <= k {
            all.resize(k + 1, Sure::default());
        }
        all[k] = Sure { bound, live };
    }

    /// A register of its own.
    pub fn register(&mut self, unit: usize) -> u16 {
        let progress = &mut self.progress[unit];
        let register = progress.registers;
        progress.registers += 1;
        // Every variable and array has its entry.
        let (n, k) = (self.units[unit].variables.len() + 1, self.units[unit].arrays.len() + 1);
        if progress.variables.len() < n {
            progress.variables.resize(n, Sure::default());
        }
        if progress.arrays.len() < k {
            progress.arrays.resize(k, Sure::default());
        }
        register
    }

    /// A register until the end of the statement.
    pub fn scratch(&mut self) -> u16 {
        let register = match self.progress[self.unit].free.pop() {
            Some(register) => register,
            None => self.register(self.unit),
        };
        self.progress[self.unit].taken.push(register);
        register
    }

    /// Three registers of their own, one behind the other.
    pub fn three_registers(&mut self, unit: usize) -> u16 {
        let first = self.register(unit);
        self.register(unit);
        self.register(unit);
        first
    }

    /// Three registers until the end of the statement.
    pub fn scratch_vector(&mut self) -> u16 {
        let first = match self.progress[self.unit].free_vectors.pop() {
            Some(first) => first,
            None => self.three_registers(self.unit),
        };
        self.progress[self.unit].taken_vectors.push(first);
        first
    }

    /// A text until the end of the statement.
    pub fn scratch_text(&mut self) -> u16 {
        let unit = self.unit;
        let array = match self.progress[unit].free_texts.pop() {
            Some(array) => array,
            None => {
                let text = self.new_array(unit, None, Type::String, false, true);
                let Poisonable::Array(array) = text else { unreachable!("an array was made") };
                self.set_known(text, true, true);
                array
            }
        };
        self.progress[unit].taken_texts.push(array);
        array
    }

    pub fn constant(&mut self, x: T) -> u16 {
        let known = self.progress[self.unit].constants.iter().find(|(y, _)| y.bits_eq(x));
        if let Some((_, register)) = known {
            return *register;
        }
        let register = self.register(self.unit);
        self.progress[self.unit].constants.push((x, register));
        register
    }

    pub fn here(&self) -> Result<u16, Unfit> {
        let at = self.units[self.unit].code.len();
        let registers = self.progress[self.unit].registers as usize;
        if at > MOST_CODE || registers > MOST_CODE { Err(Unfit::Unit) } else { Ok(at as u16) }
    }

    pub fn emit(&mut self, op: ScalarOp) -> Result<usize, Unfit> {
        let at = self.here()?;
        self.units[self.unit].code.push(op);
        Ok(at as usize)
    }

    pub fn noted(&mut self, op: ScalarOp, note: CodeNote) -> Result<usize, Unfit> {
        let at = self.emit(op)?;
        self.units[self.unit].notes.push((at as u16, note));
        Ok(at)
    }

    /// Sets the target of the jump at a position to here.
    pub fn land(&mut self, jump: usize) -> Result<(), Unfit> {
        let here = self.here()?;
        match &mut self.units[self.unit].code[jump] {
            ScalarOp::Jump { to }
            | ScalarOp::JumpUnless { to, .. }
            | ScalarOp::JumpIfNot { to, .. }
            | ScalarOp::ForTest { exit: to, .. }
            | ScalarOp::WalkTest { exit: to, .. } => *to = here,
            other => unreachable!("{other:?} does not jump"),
        }
        Ok(())
    }

    /// The code that `inner` makes, as that of a statement.
    pub(super) fn range(
        &mut self,
        start: u16,
        span: Span,
        fault: Span,
        poison: Option<(Poisonable, u16)>,
        inner: impl FnOnce(&mut Self) -> Result<(), Unfit>,
    ) -> Result<(), Unfit> {
        inner(self)?;
        let end = self.here()?;
        self.units[self.unit].ranges.push(CodeRange { start, end, span, fault, poison });
        Ok(())
    }

    fn list(&mut self, list: &[StmtId]) -> Result<(), Unfit> {
        list.iter().try_for_each(|&stmt| self.statement(stmt))
    }

    fn statement(&mut self, id: StmtId) -> Result<(), Unfit> {
        let unit = self.unit;
        let m = self.units[unit].m.clone();
        let span = m.program[id].span;
        let start = self.here()?;
        let code = &self.units[unit];
        let before = (code.notes.len(), code.ranges.len(), code.sites.len(), code.statements.len());
        let inner = code.inner.len();
        let (origins, kernels) = (code.origins.len(), code.kernels.len());
        let sure = (self.progress[unit].variables.clone(), self.progress[unit].arrays.clone());
        let counts = (self.progress[unit].compiled, self.progress[unit].left);
        let outcome = self.range(start, span, span, None, |this| {
            let number = this.units[unit].statements.len();
            let module = this.units[unit].module;
            this.units[unit].statements.push((module, id));
            this.emit(ScalarOp::Step(number as u16))?;
            this.compound(id)
        });
        let done = &mut self.progress[unit];
        let taken = std::mem::take(&mut done.taken);
        done.free.extend(taken);
        let taken = std::mem::take(&mut done.taken_vectors);
        done.free_vectors.extend(taken);
        let taken = std::mem::take(&mut done.taken_texts);
        done.free_texts.extend(taken);
        match outcome {
            Err(Unfit::Statement) => {
                let code = &mut self.units[unit];
                code.code.truncate(start as usize);
                code.notes.truncate(before.0);
                code.ranges.truncate(before.1);
                code.sites.truncate(before.2);
                code.statements.truncate(before.3);
                code.origins.truncate(origins);
                code.kernels.truncate(kernels);
                code.inner.truncate(inner);
                let done = &mut self.progress[unit];
                // Names met for the first time keep their state.
                sure.0.iter().enumerate().for_each(|(k, sure)| done.variables[k] = *sure);
                sure.1.iter().enumerate().for_each(|(k, sure)| done.arrays[k] = *sure);
                (done.compiled, done.left) = counts;
                done.left += 1;
                self.hide_declared(&[id])?;
                self.range(start, span, span, None, |this| {
                    let site = this.site(id, None, span)?;
                    this.emit(ScalarOp::Interpret { site }).map(drop)
                })
            }
            other => other,
        }
    }

    /// A point where the interpreter takes over, or a routine is called.
    pub fn site(&mut self, stmt: StmtId, expr: Option<ExprId>, span: Span) -> Result<u16, Unfit> {
        let loops = self.progress[self.unit].loops.iter().map(|l| l.active).collect();
        let sites = &mut self.units[self.unit].sites;
        let at = u16::try_from(sites.len()).map_err(|_| Unfit::Unit)?;
        sites.push(CodeSite {
            stmt,
            expr: expr.unwrap_or(ExprId(0)),
            span,
            loops,
            unit: 0,
            args: Box::default(),
            valued: false,
            moves: CallMoves::default(),
        });
        Ok(at)
    }

    /// The code of a statement without its step.
    fn compound(&mut self, id: StmtId) -> Result<(), Unfit> {
        let m = self.units[self.unit].m.clone();
        let stmt = m.program[id];
        let simple = |this: &mut Self| this.progress[this.unit].compiled += 1;
        match stmt.kind {
            StmtKind::Block(list) => self.list(&ids(&m, list)),
            StmtKind::Declare { global, ty, items } => {
                simple(self);
                if global && !(self.entry == 0 && self.unit == 0) {
                    return Err(Unfit::Statement);
                }
                for (number, item) in m.program[items].iter().enumerate() {
                    self.declarator(ty, item, (id, number as u32))?;
                }
                Ok(())
            }
            StmtKind::Assign { target, op, value } => {
                simple(self);
                self.assign(id, target, op, value)
            }
            StmtKind::Call(expr) => {
                simple(self);
                match m.program[expr].kind {
                    ExprKind::Call { callee, args } => {
                        self.routine_call(id, expr, callee, args, None).map(drop)
                    }
                    _ => Err(Unfit::Statement),
                }
            }
            StmtKind::If { condition, then, otherwise } => {
                let unless = self.condition(id, condition)?;
                let before = self.sure();
                self.statement(then)?;
                let after = self.sure();
                self.restore(&before);
                match otherwise {
                    Some(otherwise) => {
                        let end = self.emit(ScalarOp::Jump { to: 0 })?;
                        self.land_all(&unless)?;
                        self.statement(otherwise)?;
                        self.land(end)?;
                    }
                    None => self.land_all(&unless)?,
                }
                self.meet(&after);
                Ok(())
            }
            StmtKind::While { condition, body } => {
                let at = self.label_registers();
                self.forget(&[body])?;
                let top = self.here()?;
                let exits = self.condition(id, condition)?;
                let sites = self.units[self.unit].sites.len();
                let turn = self.emit(ScalarOp::Turn { at, label: NO_LABEL })?;
                self.looped(at, false, body, None, |this| {
                    this.emit(ScalarOp::Jump { to: top }).map(drop)
                })?;
                self.unless_read(turn, sites);
                self.land_all(&exits)?;
                self.breaks_here()
            }
            StmtKind::ForRange { variable, from, to, step, body } => {
                self.for_range(id, variable, [Some(from), Some(to), step], body)
            }
            StmtKind::For { start, condition, step, body } => {
                let mut label = None;
                if let Some(start) = start {
                    if let StmtKind::Assign { target, .. } = m.program[start].kind {
                        label = m.program.as_name(target);
                    }
                    self.statement(start)?;
                }
                let all: Vec<StmtId> = [Some(body), step].into_iter().flatten().collect();
                self.forget(&all)?;
                let mut sure = true;
                let mut variable = 0;
                let label = match label.map(|symbol| self.meaning(symbol)) {
                    None => NO_LABEL,
                    // Numbers alone make labels.
                    Some(Ok(Meaning::Own(what @ Poisonable::Variable(k)))) => {
                        (sure, variable) = (self.known(what).live, k);
                        let variable = &self.units[self.unit].variables[k as usize];
                        let param = matches!(variable.captured, Some(Captured::Param(_)));
                        if param || variable.ty == Some(Type::Vector) {
                            return Err(Unfit::Statement);
                        }
                        variable.register
                    }
                    Some(_) => return Err(Unfit::Statement),
                };
                let at = self.label_registers();
                let top = self.here()?;
                let exits = match condition {
                    Some(condition) => self.condition(id, condition)?,
                    None => Vec::new(),
                };
                if !sure {
                    self.emit(ScalarOp::Label { at, variable })?;
                }
                let copied = if sure { label } else { NO_LABEL };
                let sites = self.units[self.unit].sites.len();
                let turn = self.emit(ScalarOp::Turn { at, label: copied })?;
                self.looped(at, label != NO_LABEL, body, step, |this| {
                    this.emit(ScalarOp::Jump { to: top }).map(drop)
                })?;
                self.unless_read(turn, sites);
                self.land_all(&exits)?;
                self.breaks_here()
            }
            StmtKind::Break | StmtKind::Continue => {
                if self.progress[self.unit].loops.is_empty() {
                    // It ends the routine.
                    return match self.unit == self.entry {
                        true => Err(Unfit::Statement),
                        false => self.emit(ScalarOp::Leave).map(drop),
                    };
                }
                let jump = self.emit(ScalarOp::Jump { to: 0 })?;
                let last = self.progress[self.unit].loops.last_mut().expect("there is a loop");
                match stmt.kind {
                    StmtKind::Break => last.breaks.push(jump),
                    _ => last.continues.push(jump),
                }
                Ok(())
            }
            StmtKind::Return(value) => {
                simple(self);
                match value {
                    Some(value) if self.is_vector(value) => {
                        let a = self.vector(id, value)?;
                        self.emit(ScalarOp::ReturnVector { a }).map(drop)
                    }
                    Some(value) => {
                        let a = self.value(id, value, None)?;
                        self.emit(ScalarOp::Return { a }).map(drop)
                    }
                    None => self.emit(ScalarOp::Leave).map(drop),
                }
            }
            StmtKind::Routine(_) | StmtKind::Record { .. } => Ok(()),
            StmtKind::Load(_) => Err(Unfit::Unit),
            StmtKind::Foreach { variable, list, body } => self.foreach(variable, list, body),
            StmtKind::Object { .. }
            | StmtKind::Param { .. }
            | StmtKind::Print(_)
            | StmtKind::Assert { .. }
            | StmtKind::Error => Err(Unfit::Statement),
        }
    }

    /// The numbers of turns are kept only for calls and for the interpreter: `sites` were there before the loop's body.
    fn unless_read(&mut self, turn: usize, sites: usize) {
        let unit = &mut self.units[self.unit];
        if unit.sites.len() == sites
            && let ScalarOp::Turn { at, label } = &mut unit.code[turn]
        {
            (*at, *label) = (NO_LABEL, NO_LABEL);
        }
    }

    /// The registers of the number of a loop in names, and of its turn.
    pub fn label_registers(&mut self) -> u16 {
        let at = self.register(self.unit);
        self.register(self.unit);
        at
    }

    /// The body of a loop and the code after each iteration; the loop stays open for jumps out of
    /// it.
    pub(super) fn looped(
        &mut self,
        at: u16,
        labelled: bool,
        body: StmtId,
        step: Option<StmtId>,
        next: impl FnOnce(&mut Self) -> Result<(), Unfit>,
    ) -> Result<(), Unfit> {
        let before = self.sure();
        let active = ActiveLoop { at, labelled };
        let inner = LoopProgress { active, breaks: Vec::new(), continues: Vec::new() };
        self.progress[self.unit].loops.push(inner);
        let open = self.progress[self.unit].loops.len();
        let outcome = self.statement(body);
        let mut inner = match self.progress[self.unit].loops.len() == open {
            true => self.progress[self.unit].loops.pop().expect("it was opened here"),
            false => return Err(Unfit::Unit),
        };
        outcome?;
        for jump in std::mem::take(&mut inner.continues) {
            self.land(jump)?;
        }
        self.restore(&before);
        if let Some(step) = step {
            self.statement(step)?;
        }
        next(self)?;
        self.restore(&before);
        let done = LoopProgress { breaks: inner.breaks, ..inner };
        self.closed.push(done.breaks);
        Ok(())
    }

    pub(super) fn breaks_here(&mut self) -> Result<(), Unfit> {
        let breaks = self.closed.pop().unwrap_or_default();
        self.land_all(&breaks)
    }

    fn land_all(&mut self, jumps: &[usize]) -> Result<(), Unfit> {
        jumps.iter().try_for_each(|&jump| self.land(jump))
    }

    /// Declarations in a loop are not certain at its head.
    pub(super) fn forget(&mut self, list: &[StmtId]) -> Result<(), Unfit> {
        let m = self.units[self.unit].m.clone();
        let mut all = Vec::new();
        super::names::declared(&m, list, &mut |name, _, _| all.push(name));
        for name in all {
            if let Some(&what) = self.names[self.unit].get(&name) {
                let Sure { bound, .. } = self.known(what);
                self.set_known(what, bound, false);
            }
        }
        Ok(())
    }

    pub(super) fn sure(&self) -> (Vec<Sure>, Vec<Sure>) {
        let progress = &self.progress[self.unit];
        (progress.variables.clone(), progress.arrays.clone())
    }

    /// Restores an earlier state; names met since keep theirs.
    pub(super) fn restore(&mut self, (variables, arrays): &(Vec<Sure>, Vec<Sure>)) {
        let (n, k) = (self.units[self.unit].variables.len(), self.units[self.unit].arrays.len());
        let captured: Vec<bool> = (0..n)
            .map(|v| {
                let variable = &self.units[self.unit].variables[v];
                variable.captured.is_some() && !variable.declared
            })
            .collect();
        let held: Vec<bool> = (0..k)
            .map(|a| {
                let array = &self.units[self.unit].arrays[a];
                array.captured && !array.declared
            })
            .collect();
        let progress = &mut self.progress[self.unit];
        for (v, sure) in variables.iter().enumerate() {
            if !captured.get(v).copied().unwrap_or(false) {
                progress.variables[v] = *sure;
            }
        }
        for (a, sure) in arrays.iter().enumerate() {
            if !held.get(a).copied().unwrap_or(false) {
                progress.arrays[a] = *sure;
            }
        }
    }

    /// State that is certain on both paths.
    fn meet(&mut self, (variables, arrays): &(Vec<Sure>, Vec<Sure>)) {
        let both = |a: &mut Sure, b: &Sure| {
            a.bound &= b.bound;
            a.live &= b.live;
        };
        let progress = &mut self.progress[self.unit];
        progress.variables.iter_mut().zip(variables).for_each(|(a, b)| both(a, b));
        progress.arrays.iter_mut().zip(arrays).for_each(|(a, b)| both(a, b));
    }

    fn for_range(
        &mut self,
        id: StmtId,
        variable: Ident,
        bounds: [Option<ExprId>; 3],
        body: StmtId,
    ) -> Result<(), Unfit> {
        let unit = self.unit;
        let m = self.units[unit].m.clone();
        let at = self.register(unit);
        for _ in 0..5 {
            self.register(unit);
        }
        for (k, bound) in bounds.into_iter().enumerate() {
            let to = at + k as u16;
            match bound {
                Some(bound) => drop(self.value(id, bound, Some(to))?),
                None => {
                    let a = self.constant(T::one());
                    self.emit(ScalarOp::Copy { to, a })?;
                }
            }
        }
        self.emit(ScalarOp::ForBegin { at })?;
        let name = m.names[variable.symbol.0 as usize];
        let Some(&what) = self.names[unit].get(&name).filter(|_| !self.is_hidden(unit, name))
        else {
            return Err(Unfit::Statement);
        };
        let Poisonable::Variable(number) = what else { return Err(Unfit::Statement) };
        self.forget(&[body])?;
        let before = self.sure();
        let origin = self.origin(variable.span, Type::Float)?;
        let register = self.units[unit].variables[number as usize].register;
        let sites = self.units[unit].sites.len();
        let kept = true;
        let op = ScalarOp::ForTest { at, variable: number, register, origin, exit: 0, kept };
        let test = self.emit(op)?;
        self.set_known(what, true, true);
        // Its number follows the four registers of the loop.
        self.looped(at + 4, true, body, None, |this| {
            this.emit(ScalarOp::ForNext { at, test: test as u16 }).map(drop)
        })?;
        self.restore(&before);
        if self.units[unit].sites.len() == sites
            && let ScalarOp::ForTest { kept, .. } = &mut self.units[unit].code[test]
        {
            *kept = false;
        }
        self.land(test)?;
        self.breaks_here()
    }

    pub fn origin(&mut self, span: Span, ty: Type) -> Result<u16, Unfit> {
        let origins = &mut self.units[self.unit].origins;
        origins.push((span, ty));
        u16::try_from(origins.len() - 1).map_err(|_| Unfit::Unit)
    }

    /// Jumps to patch, taken when the condition does not hold.
    fn condition(&mut self, stmt: StmtId, condition: ExprId) -> Result<Vec<usize>, Unfit> {
        let unit = self.unit;
        let start = self.here()?;
        let (notes, inner) = (self.units[unit].notes.len(), self.units[unit].inner.len());
        let sites = self.units[unit].sites.len();
        // Functions that were put in place have ranges and statements of their own.
        let (ranges, statements) =
            (self.units[unit].ranges.len(), self.units[unit].statements.len());
        let mut unless = Vec::new();
        match self.unless(stmt, condition, &mut unless) {
            Ok(()) => Ok(unless),
            Err(Unfit::Statement) => {
                let m = self.units[unit].m.clone();
                self.units[unit].code.truncate(start as usize);
                self.units[unit].notes.truncate(notes);
                self.units[unit].inner.truncate(inner);
                self.units[unit].sites.truncate(sites);
                self.units[unit].ranges.truncate(ranges);
                self.units[unit].statements.truncate(statements);
                self.progress[unit].left += 1;
                let span = m.program[condition].span;
                let site = self.site(stmt, Some(condition), span)?;
                let to = self.scratch();
                self.emit(ScalarOp::Condition { to, site })?;
                Ok(vec![self.emit(ScalarOp::JumpUnless { a: to, to: 0 })?])
            }
            Err(other) => Err(other),
        }
    }

    /// Code that continues if the expression is true, and otherwise jumps.
    pub fn unless(
        &mut self,
        stmt: StmtId,
        id: ExprId,
        jumps: &mut Vec<usize>,
    ) -> Result<(), Unfit> {
        let m = self.units[self.unit].m.clone();
        match m.program[id].kind {
            ExprKind::Paren(inner) => self.unless(stmt, inner, jumps),
            ExprKind::Binary { op: BinaryOp::And, left, right } => {
                self.unless(stmt, left, jumps)?;
                self.unless(stmt, right, jumps)
            }
            ExprKind::Binary { op: BinaryOp::Or, left, right } => {
                let mut first = Vec::new();
                self.unless(stmt, left, &mut first)?;
                let holds = self.emit(ScalarOp::Jump { to: 0 })?;
                self.land_all(&first)?;
                self.unless(stmt, right, jumps)?;
                self.land(holds)
            }
            ExprKind::Unary { op: UnaryOp::Not, operand } => {
                let mut holds_not = Vec::new();
                self.unless(stmt, operand, &mut holds_not)?;
                jumps.push(self.emit(ScalarOp::Jump { to: 0 })?);
                self.land_all(&holds_not)
            }
            ExprKind::Binary { op, left, right } if relation(op).is_some() => {
                let relation = relation(op).expect("asked before");
                if self.is_text(left) || self.is_text(right) {
                    let a = self.value(stmt, id, None)?;
                    jumps.push(self.emit(ScalarOp::JumpUnless { a, to: 0 })?);
                    return Ok(());
                }
                let (a, b) = self.both(stmt, left, right)?;
                jumps.push(self.emit(ScalarOp::JumpIfNot { relation, a, b, to: 0 })?);
                Ok(())
            }
            _ => {
                let a = self.value(stmt, id, None)?;
                jumps.push(self.emit(ScalarOp::JumpUnless { a, to: 0 })?);
                Ok(())
            }
        }
    }

    pub fn calls_in_subscripts(&self, subs: NodeList<Subscript>) -> bool {
        let m = &self.units[self.unit].m;
        m.program[subs].iter().any(|sub| match sub {
            Subscript::At(at) => self.calls(*at),
            _ => true,
        })
    }
}

/// The comparison that an operator is.
pub(super) fn relation(op: BinaryOp) -> Option<Relation> {
    Some(match op {
        BinaryOp::Lt => Relation::Lt,
        BinaryOp::Gt => Relation::Gt,
        BinaryOp::Le => Relation::Le,
        BinaryOp::Ge => Relation::Ge,
        BinaryOp::Eq => Relation::Eq,
        BinaryOp::Ne => Relation::Ne,
        _ => return None,
    })
}
