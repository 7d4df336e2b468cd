//! Declarations and assignments to code.

use super::code::{Captured, CodeNote, NO_LABEL, Poisonable, ScalarOp};
use super::compile::{RegionCompiler, Unfit};
use super::names::Meaning;
use crate::value::variables::MOST_INT;
use moldloft_diag::Span;
use moldloft_registry::Scalar;
use moldloft_syntax::sdl::{AssignOp, Declarator, ExprId, ExprKind, StmtId, Type};

impl<T: Scalar> RegionCompiler<'_, T> {
    pub(super) fn declarator(
        &mut self,
        (ty, _): (Type, Span),
        item: &Declarator,
        (id, number): (StmtId, u32),
    ) -> Result<(), Unfit> {
        let unit = self.unit;
        let m = self.units[unit].m.clone();
        let name = m.names[item.name.symbol.0 as usize];
        let Some(&what) = self.names[unit].get(&name).filter(|_| !self.is_hidden(unit, name))
        else {
            return Err(Unfit::Statement);
        };
        let start = self.here()?;
        let origin = self.origin(item.name.span, ty)?;
        // The initial value refers to the previous meaning of the name.
        let fault = item.name.span;
        let mut sure = true;
        self.range(start, fault, fault, Some((what, origin)), |this| {
            match (what, item.dims.len()) {
                (Poisonable::Variable(variable), 0) if ty == Type::Vector => {
                    let to = this.units[unit].variables[variable as usize].register;
                    match item.value {
                        Some(value) if this.is_vector(value) => {
                            let a = this.vector(id, value)?;
                            sure = false;
                            this.emit(ScalarOp::CopyVector { to, a })?;
                        }
                        Some(_) => return Err(Unfit::Statement),
                        None => {
                            let a = this.constant(T::zero());
                            for c in 0..3 {
                                this.emit(ScalarOp::Copy { to: to + c, a })?;
                            }
                        }
                    }
                    this.emit(ScalarOp::Declare { variable, origin }).map(drop)
                }
                (Poisonable::Variable(variable), 0) => {
                    let to = this.units[unit].variables[variable as usize].register;
                    let (from, safe) = match item.value {
                        Some(value) => {
                            let before = this.here()?;
                            let from = this.value(id, value, None)?;
                            (from, this.here()? == before)
                        }
                        None => (this.constant(T::zero()), true),
                    };
                    let literal = item.value.is_none();
                    let whole = item
                        .value
                        .and_then(|value| m.program.as_literal(value))
                        .is_some_and(|literal| {
                            let x = m.program[literal].value;
                            x.fract() == 0.0 && x.abs() < MOST_INT
                        });
                    match (ty, item.value) {
                        (Type::Int, Some(value)) if !whole => {
                            let note = CodeNote::Convert(m.program[value].span);
                            this.noted(ScalarOp::Whole { to, a: from }, note)?;
                            sure = false;
                        }
                        _ => {
                            this.emit(ScalarOp::Copy { to, a: from })?;
                            sure = safe || literal;
                        }
                    }
                    this.emit(ScalarOp::Declare { variable, origin }).map(drop)
                }
                (Poisonable::Array(array), 0) if ty == Type::String => {
                    sure = this.declared_text(id, (array, origin), item.value)?;
                    Ok(())
                }
                (Poisonable::Array(array), 0) => {
                    let value = item.value.ok_or(Unfit::Statement)?;
                    let before = this.here()?;
                    sure = false;
                    this.declared_array(id, (array, origin), ty, value)?;
                    let end = this.here()?;
                    let code = &mut this.units[unit];
                    code.inner.push((before, end, CodeNote::Declaration(id, number)));
                    code.unfixed.push(origin);
                    Ok(())
                }
                (Poisonable::Array(_), 3..) => Err(Unfit::Statement),
                (Poisonable::Array(array), count) => {
                    let fits = match ty {
                        Type::Curve => count == 1,
                        Type::Surface => count == 2,
                        _ => true,
                    };
                    if item.value.is_some() || !fits {
                        return Err(Unfit::Statement);
                    }
                    let dims: Vec<ExprId> = m.program[item.dims].to_vec();
                    if dims.iter().any(|&dim| this.calls(dim)) {
                        return Err(Unfit::Statement);
                    }
                    let before = this.here()?;
                    let rows = this.value(id, dims[0], None)?;
                    let columns = match count {
                        2 => this.value(id, dims[1], None)?,
                        _ => NO_LABEL,
                    };
                    sure = false;
                    let op = ScalarOp::DeclareArray { array, m: rows, n: columns, origin };
                    let note = CodeNote::Declaration(id, number);
                    let end = this.here()?;
                    this.units[unit].inner.push((before, end, note));
                    this.noted(op, note).map(drop)
                }
                (Poisonable::Variable(_), _) => Err(Unfit::Statement),
            }
        })?;
        self.set_known(what, true, sure);
        Ok(())
    }

    pub(super) fn assign(
        &mut self,
        id: StmtId,
        target: ExprId,
        op: AssignOp,
        value: ExprId,
    ) -> Result<(), Unfit> {
        if self.assigned_text(id, target, op, value)? {
            return Ok(());
        }
        if self.is_whole(target) {
            return self.assigned_array(id, target, op, value);
        }
        if self.assigned_vector(id, target, op, value)? {
            return Ok(());
        }
        let m = self.units[self.unit].m.clone();
        let spans = [target, value].map(|e| m.program[e].span);
        match m.program[target].kind {
            ExprKind::Name(symbol) => {
                let what = self.meaning(symbol)?;
                let (variable, of_file) = match what {
                    Meaning::Own(Poisonable::Variable(k)) => (k, false),
                    Meaning::OfFile(Poisonable::Variable(k)) => (k, true),
                    _ => return Err(Unfit::Statement),
                };
                let owner = if of_file { 0 } else { self.unit };
                let held = self.units[owner].variables[variable as usize].clone();
                if matches!(held.captured, Some(Captured::Param(_))) {
                    return Err(Unfit::Statement);
                }
                let live = self.is_live(what);
                let plain = held.ty == Some(Type::Float) && !of_file;
                let note = CodeNote::Name(symbol, spans[0]);
                let want = Some(held.register).filter(|_| plain && live);
                let from = match op {
                    AssignOp::Set => {
                        let from = self.value(id, value, want)?;
                        self.live(what, note)?;
                        from
                    }
                    AssignOp::With(op) => {
                        let a = self.name(symbol, spans[0])?;
                        let a = self.kept(a, self.calls(value))?;
                        let b = self.value(id, value, None)?;
                        let to = want.unwrap_or_else(|| self.scratch());
                        self.arithmetic(op, to, a, b, spans[0].to(spans[1]))?;
                        to
                    }
                };
                let note = CodeNote::Convert(spans[0]);
                let (to, a) = (held.register, from);
                match (held.ty, of_file) {
                    (Some(Type::Int), false) => self.noted(ScalarOp::Whole { to, a }, note)?,
                    (Some(Type::Int), true) => {
                        self.noted(ScalarOp::WholeFile { of_file: to, a }, note)?
                    }
                    (None, false) => self.noted(ScalarOp::Assign { variable, to, a }, note)?,
                    (None, true) => {
                        self.noted(ScalarOp::AssignFile { variable, of_file: to, a }, note)?
                    }
                    (_, true) => self.emit(ScalarOp::StoreFile { of_file: to, a })?,
                    (_, false) if to == a => return Ok(()),
                    (_, false) => self.emit(ScalarOp::Copy { to, a })?,
                };
                Ok(())
            }
            ExprKind::Index { base, subs } => {
                if self.calls_in_subscripts(subs) {
                    return Err(Unfit::Statement);
                }
                let a = match op {
                    AssignOp::Set => self.value(id, value, None)?,
                    AssignOp::With(op) => {
                        let a = self.element(id, target, base, subs)?;
                        let b = self.value(id, value, None)?;
                        let to = self.scratch();
                        self.arithmetic(op, to, a, b, spans[0].to(spans[1]))?;
                        to
                    }
                };
                let (array, _, places) = self.places(id, base, subs, CodeNote::Target(target))?;
                let op = ScalarOp::Store { array, i: places[0], j: places[1], a };
                self.noted(op, CodeNote::Target(target)).map(drop)
            }
            _ => Err(Unfit::Statement),
        }
    }
}
