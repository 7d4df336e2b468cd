//! Faults of code: their diagnostics, and where the code goes on.

use super::code::{CodeNote, CodeRegion, OF_FILE, ScalarOp, UNDECLARED};
use super::machine::CodeOutcome;
use super::registers::{RegisterMachine, declaration};
use crate::array::lanes::not_finite;
use crate::run::interpreter::{Interpreter, silent};
use crate::value::variables;
use moldloft_diag::Diagnostic;
use moldloft_num::Real;
use moldloft_registry::{Scalar, Value};
use moldloft_syntax::sdl::{StmtKind, Type};

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// The fault at the machine's position.
    #[cold]
    pub(super) fn fault(
        &mut self,
        region: &CodeRegion<T>,
        machine: &mut RegisterMachine<T>,
    ) -> CodeOutcome<T> {
        let code = &region.units[machine.unit];
        let at =
            |machine: &RegisterMachine<T>, r: u16| machine.registers[machine.first + r as usize];
        let op = code.code[machine.pc];
        let range = code.range(machine.pc);
        let diagnostic = match (code.note(machine.pc), op) {
            (Some(CodeNote::Assignment(stmt)), _) => {
                let StmtKind::Assign { target, op, value } = code.m.program[stmt].kind else {
                    unreachable!("an assignment was noted")
                };
                match self.interpreted(region, machine, &[], |this| {
                    this.assign(&code.m, target, op, value)
                }) {
                    Ok(()) => {
                        machine.pc = range.end as usize;
                        return CodeOutcome::Next;
                    }
                    Err(diagnostic) => diagnostic,
                }
            }
            (Some(CodeNote::Finite(name, span)), _) => not_finite(name).at(span),
            (Some(CodeNote::Expression(expr)), _) => {
                self.again(region, machine, |this| this.operand(&code.m, expr).map(drop))
            }
            (Some(CodeNote::Target(target)), _) => {
                self.again(region, machine, |this| this.target(&code.m, target).map(drop))
            }
            (Some(CodeNote::Declaration(stmt, number)), _) => {
                let StmtKind::Declare { global, ty, items } = code.m.program[stmt].kind else {
                    unreachable!("a declaration was noted")
                };
                let item = code.m.program[items][number as usize];
                self.again(region, machine, |this| this.declare(&code.m, stmt, global, ty, &item))
            }
            (Some(CodeNote::Name(symbol, span)), op) => {
                let mark = match op {
                    ScalarOp::Live { variable } => {
                        machine.marks[machine.first_mark + variable as usize]
                    }
                    ScalarOp::LiveFile { variable } => machine.marks[variable as usize],
                    ScalarOp::LiveArray { array } => {
                        let own = machine.first_array + array as usize;
                        let of_file = (array & !OF_FILE) as usize;
                        machine.arrays[if array & OF_FILE == 0 { own } else { of_file }].mark
                    }
                    _ => UNDECLARED,
                };
                match declaration(mark) {
                    Some(_) => silent(),
                    None => self.again(region, machine, |this| {
                        Err(this.unknown_name(&code.m, symbol, span))
                    }),
                }
            }
            (Some(CodeNote::Convert(span)), _) => {
                let a = match op {
                    ScalarOp::Whole { a, .. }
                    | ScalarOp::WholeFile { a, .. }
                    | ScalarOp::Assign { a, .. }
                    | ScalarOp::AssignFile { a, .. } => a,
                    other => unreachable!("{other:?} converts nothing"),
                };
                no_int(at(machine, a)).or_at(span)
            }
            (Some(CodeNote::Argument(span, asked)), ScalarOp::Whole { a, .. }) => {
                no_int(at(machine, a)).or_at(span).note_at(asked, "requested here")
            }
            (None, ScalarOp::ForBegin { at: k }) => {
                let [from, to, step] = [k, k + 1, k + 2].map(|r| at(machine, r).re());
                Diagnostic::error("endless-loop", "this loop cannot end")
                    .at(range.span)
                    .expected("finite ends and a step other than 0")
                    .found(format!("{from}:{to}:{step}"))
            }
            (note, op) => unreachable!("{op:?} has no such fault: {note:?}"),
        };
        self.faulty(region, machine, diagnostic)
    }

    /// The interpreter's diagnostic for the same fault, with all variables handed over.
    fn again(
        &mut self,
        region: &CodeRegion<T>,
        machine: &mut RegisterMachine<T>,
        work: impl FnOnce(&mut Self) -> Result<(), Diagnostic>,
    ) -> Diagnostic {
        let outcome = self.interpreted(region, machine, &[], work);
        outcome.expect_err("the interpreter finds the same fault")
    }

    /// Reports a fault and continues after its statement.
    pub(super) fn faulty(
        &mut self,
        region: &CodeRegion<T>,
        machine: &mut RegisterMachine<T>,
        diagnostic: Diagnostic,
    ) -> CodeOutcome<T> {
        let range = region.units[machine.unit].range(machine.pc);
        self.in_module(region, machine, |this| this.report(diagnostic.or_at(range.fault)));
        machine.poison(region);
        if self.env.stopped {
            return CodeOutcome::Stop;
        }
        self.abandoned |= region.units[region.entry].m.library;
        if self.is_abandoned(region) {
            return CodeOutcome::Return(None);
        }
        machine.pc = range.end as usize;
        CodeOutcome::Next
    }

    /// True if an error has ended the active library routines.
    pub(super) fn is_abandoned(&self, region: &CodeRegion<T>) -> bool {
        self.abandoned && region.units[region.entry].m.library
    }
}

/// The error for a number that an int cannot represent.
fn no_int<T: Real>(x: T) -> Diagnostic {
    match variables::converted(Type::Int, Value::Number(x)) {
        Err(diagnostic) => diagnostic,
        Ok(_) => unreachable!("an int holds it"),
    }
}
