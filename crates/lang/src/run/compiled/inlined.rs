//! Inlining of short functions.
//!
//! A function of numbers that only returns arithmetic on its arguments needs no registers of its
//! own. A fault in it is reported at its own position, and the caller's statement has no value, as
//! with compiled code of its own.

use super::code::{CodeNote, CodeRange, ScalarOp};
use super::compile::{RegionCompiler, Unfit};
use crate::functions::elementary;
use crate::source::module::{Module, RoutineAt};
use moldloft_registry::{Implementation, Scalar};
use moldloft_syntax::sdl::{
    Arg, BinaryOp, ExprId, ExprKind, NodeList, Routine, StmtId, StmtKind, Symbol, Type, UnaryOp,
};

/// The most operators of a function that is put where it is called.
const MOST_OPERATORS: usize = 24;

impl<T: Scalar> RegionCompiler<'_, T> {
    /// Puts the code of a routine here, if it is a short function; false when it must be called.
    pub fn stands_here(
        &mut self,
        stmt: StmtId,
        id: ExprId,
        at: RoutineAt,
        args: NodeList<Arg>,
        to: u16,
    ) -> Result<bool, Unfit> {
        let of = self.modules.get(at.module).clone();
        let routine = of.program[at.routine];
        let Some((returns, value)) = returned(&of, &routine) else { return Ok(false) };
        let m = self.units[self.unit].m.clone();
        let given: Vec<ExprId> = m.program[args].iter().map(|arg| arg.value).collect();
        let formals = &of.program[routine.formals];
        let names: Vec<Symbol> = formals.iter().map(|formal| formal.name.symbol).collect();
        let distinct = names.iter().enumerate().all(|(k, name)| !names[..k].contains(name));
        let plain = |formal: &moldloft_syntax::sdl::Formal| {
            formal.ty.0 == Type::Float && !formal.returned && !formal.multiple
        };
        let float = routine.result.is_some_and(|(ty, _)| ty == Type::Float);
        if of.library != m.library
            || !float
            || !distinct
            || !formals.iter().all(plain)
            || given.len() != formals.len()
            || !self.is_short(&of, value, &names)
        {
            return Ok(false);
        }
        let mut values = Vec::with_capacity(given.len());
        for (k, &arg) in given.iter().enumerate() {
            let a = self.value(stmt, arg, None)?;
            let later = given[k + 1..].iter().any(|&next| self.calls(next));
            values.push(self.kept(a, later)?);
        }
        let start = self.here()?;
        self.emit(ScalarOp::Called)?;
        let unit = self.unit;
        let number = self.units[unit].statements.len();
        self.units[unit].statements.push((at.module, returns));
        self.emit(ScalarOp::Step(number as u16))?;
        let (span, fault) = (of.program[returns].span, m.program[id].span);
        let end = self.here()?;
        self.units[unit].ranges.push(CodeRange { start, end, span, fault, poison: None });
        let from = self.of_formals(&of, value, &names, &values)?;
        self.emit(ScalarOp::Copy { to, a: from })?;
        Ok(true)
    }

    /// True for arithmetic and functions of the formal arguments alone.
    fn is_short(&mut self, of: &Module, value: ExprId, formals: &[Symbol]) -> bool {
        let mut stack = vec![value];
        let mut operators = 0;
        while let Some(id) = stack.pop() {
            operators += 1;
            match of.program[id].kind {
                ExprKind::Number(_) => {}
                ExprKind::Name(symbol) if formals.contains(&symbol) => {}
                ExprKind::Paren(e) | ExprKind::Magnitude(e) => stack.push(e),
                ExprKind::Unary { op: UnaryOp::Minus | UnaryOp::Plus, operand } => {
                    stack.push(operand);
                }
                ExprKind::Binary {
                    op:
                        BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div | BinaryOp::Caret,
                    left,
                    right,
                } => stack.extend([left, right]),
                ExprKind::Call { callee, args } => {
                    if !self.is_elementary(of, callee, args, formals) {
                        return false;
                    }
                    stack.extend(of.program[args].iter().map(|arg| arg.value));
                }
                _ => return false,
            }
        }
        operators <= MOST_OPERATORS
    }

    fn is_elementary(
        &mut self,
        of: &Module,
        callee: ExprId,
        args: NodeList<Arg>,
        formals: &[Symbol],
    ) -> bool {
        let Some(symbol) = of.program.as_name(callee) else { return false };
        let Some(row) = &of.rows[symbol.0 as usize] else { return false };
        let name = of.names[symbol.0 as usize];
        let count = match elementary::elementary::<T>(&row.name) {
            Some((_, elementary::Elementary::Unary(_))) => 1,
            Some((_, elementary::Elementary::Binary(_))) => 2,
            None => return false,
        };
        matches!(row.body, Implementation::Native { .. })
            && args.len() == count
            && of.program[args].iter().all(|arg| arg.name.is_none())
            && !formals.contains(&symbol)
            && !self.scope.routines.contains_key(&name)
            && self.is_free_in_file(name)
    }

    /// The register of an expression of the formal arguments, which are these registers.
    fn of_formals(
        &mut self,
        of: &Module,
        id: ExprId,
        formals: &[Symbol],
        given: &[u16],
    ) -> Result<u16, Unfit> {
        let inner = |this: &mut Self, e: ExprId| this.of_formals(of, e, formals, given);
        Ok(match of.program[id].kind {
            ExprKind::Number(literal) => self.constant(T::from(of.program[literal].value)),
            ExprKind::Name(symbol) => {
                let at = formals.iter().position(|formal| *formal == symbol);
                given[at.ok_or(Unfit::Statement)?]
            }
            ExprKind::Paren(e) => inner(self, e)?,
            ExprKind::Magnitude(e) => {
                let a = inner(self, e)?;
                let to = self.scratch();
                self.emit(ScalarOp::Magnitude { to, a })?;
                to
            }
            ExprKind::Unary { op, operand } => {
                let a = inner(self, operand)?;
                if op == UnaryOp::Plus {
                    return Ok(a);
                }
                let to = self.scratch();
                self.emit(ScalarOp::Negate { to, a })?;
                to
            }
            ExprKind::Binary { op, left, right } => {
                let (a, b) = (inner(self, left)?, inner(self, right)?);
                let to = self.scratch();
                let span = of.program[left].span.to(of.program[right].span);
                self.arithmetic(op, to, a, b, span)?;
                to
            }
            ExprKind::Call { callee, args } => {
                let symbol = of.program.as_name(callee).ok_or(Unfit::Statement)?;
                let row = of.rows[symbol.0 as usize].clone().ok_or(Unfit::Statement)?;
                let (name, function) =
                    elementary::elementary::<T>(&row.name).ok_or(Unfit::Statement)?;
                let all: Vec<ExprId> = of.program[args].iter().map(|arg| arg.value).collect();
                let mut values = Vec::with_capacity(2);
                for &arg in &all {
                    values.push(inner(self, arg)?);
                }
                let (to, f) = (self.scratch(), self.function(name, function)?);
                let note = CodeNote::Finite(name, of.program[id].span);
                match values[..] {
                    [a] => self.noted(ScalarOp::Apply { to, a, f }, note)?,
                    [a, b] => self.noted(ScalarOp::Apply2 { to, a, b, f }, note)?,
                    _ => return Err(Unfit::Statement),
                };
                to
            }
            _ => return Err(Unfit::Statement),
        })
    }
}

/// The only statement of a function, and its value.
fn returned(of: &Module, routine: &Routine) -> Option<(StmtId, ExprId)> {
    let [only] = of.program[routine.body] else { return None };
    match of.program[only].kind {
        StmtKind::Return(Some(value)) => Some((only, value)),
        _ => None,
    }
}
