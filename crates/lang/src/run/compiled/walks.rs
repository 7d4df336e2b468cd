//! `foreach` over the elements of an array to code: those that it had when the loop began.

use super::code::{CodeNote, NO_LABEL, Poisonable, ScalarOp};
use super::compile::{RegionCompiler, Unfit};
use super::names::element_type;
use moldloft_registry::Scalar;
use moldloft_syntax::sdl::{ExprId, Ident, StmtId, Type};

impl<T: Scalar> RegionCompiler<'_, T> {
    pub(super) fn foreach(
        &mut self,
        variable: Ident,
        list: ExprId,
        body: StmtId,
    ) -> Result<(), Unfit> {
        let unit = self.unit;
        let m = self.units[unit].m.clone();
        let name = m.names[variable.symbol.0 as usize];
        let element = self.array_type(list).map(element_type).ok_or(Unfit::Statement)?;
        let Some(&what @ Poisonable::Variable(number)) =
            self.names[unit].get(&name).filter(|_| !self.is_hidden(unit, name))
        else {
            return Err(Unfit::Statement);
        };
        let held = self.units[unit].variables[number as usize].clone();
        if (held.ty == Some(Type::Vector)) != (element == Type::Vector) {
            return Err(Unfit::Statement);
        }
        let (from, ty) = self.array_of(list)?;
        self.noted(ScalarOp::HasValue { array: from }, CodeNote::Expression(list))?;
        let Poisonable::Array(array) = self.new_array(unit, None, ty, false, true) else {
            return Err(Unfit::Statement);
        };
        let at = self.label_registers();
        self.emit(ScalarOp::WalkBegin { array, from })?;
        self.forget(&[body])?;
        let before = self.sure();
        let origin = self.origin(variable.span, element)?;
        let sites = self.units[unit].sites.len();
        let register = held.register;
        let op = ScalarOp::WalkTest { at, array, variable: number, register, origin, exit: 0 };
        let test = self.emit(op)?;
        self.set_known(what, true, true);
        self.looped(at, true, body, None, |this| {
            this.emit(ScalarOp::WalkNext { test: test as u16 }).map(drop)
        })?;
        self.restore(&before);
        if self.units[unit].sites.len() == sites
            && let ScalarOp::WalkTest { at, .. } = &mut self.units[unit].code[test]
        {
            *at = NO_LABEL;
        }
        self.land(test)?;
        self.breaks_here()?;
        self.emit(ScalarOp::WalkEnd { array }).map(drop)
    }
}
