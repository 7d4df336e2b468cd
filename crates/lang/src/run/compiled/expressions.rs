//! Expressions of numbers to code.

use super::code::{CodeArgument, CodeNote, CodeVariable, NO_LABEL, Poisonable, ScalarOp};
use super::compile::{RegionCompiler, Unfit, relation};
use super::names::Meaning;
use super::vectors::CodeValue;
use crate::functions::elementary::{self, Elementary};
use crate::run::parts;
use crate::source::module::Name;
use crate::value::ops;
use moldloft_diag::Span;
use moldloft_registry::{Implementation, Scalar};
use moldloft_syntax::sdl::{
    Arg, BinaryOp, ChainItem, ExprId, ExprKind, NodeList, StmtId, Subscript, Symbol, Type, UnaryOp,
};

impl<T: Scalar> RegionCompiler<'_, T> {
    /// The register of the value; `want`, if given. `want` is overwritten only by the last
    /// operation.
    pub fn value(&mut self, stmt: StmtId, id: ExprId, want: Option<u16>) -> Result<u16, Unfit> {
        let m = self.units[self.unit].m.clone();
        let expr = m.program[id];
        let at = match expr.kind {
            ExprKind::Number(literal) => self.constant(T::from(m.program[literal].value)),
            ExprKind::Name(symbol) => self.name(symbol, expr.span)?,
            ExprKind::Paren(inner) => return self.value(stmt, inner, want),
            ExprKind::Magnitude(inner) if self.is_vector(inner) => {
                self.length(stmt, inner, expr.span)?
            }
            ExprKind::Magnitude(inner) => {
                let a = self.value(stmt, inner, None)?;
                let to = self.result(want);
                self.emit(ScalarOp::Magnitude { to, a })?;
                to
            }
            ExprKind::Unary { op, operand } => {
                let a = self.value(stmt, operand, None)?;
                let to = self.result(want);
                match op {
                    UnaryOp::Plus => a,
                    UnaryOp::Minus => {
                        self.emit(ScalarOp::Negate { to, a })?;
                        to
                    }
                    UnaryOp::Not => {
                        self.emit(ScalarOp::Not { to, a })?;
                        to
                    }
                }
            }
            ExprKind::Binary { op: BinaryOp::And | BinaryOp::Or, .. } => {
                let mut unless = Vec::new();
                self.unless(stmt, id, &mut unless)?;
                let to = self.scratch();
                let [zero, one] = [T::zero(), T::one()].map(|x| self.constant(x));
                self.emit(ScalarOp::Copy { to, a: one })?;
                let end = self.emit(ScalarOp::Jump { to: 0 })?;
                for jump in unless {
                    self.land(jump)?;
                }
                self.emit(ScalarOp::Copy { to, a: zero })?;
                self.land(end)?;
                to
            }
            ExprKind::Binary { op: BinaryOp::Dot, left, right } => {
                self.dot_product(stmt, left, right)?
            }
            ExprKind::Binary { op, left, right }
                if relation(op).is_some() && (self.is_text(left) || self.is_text(right)) =>
            {
                let to = self.result(want);
                let relation = relation(op).expect("a comparison");
                self.compared_texts(stmt, relation, left, right, to)?;
                to
            }
            ExprKind::Binary { op, left, right } => {
                let (a, b) = self.both(stmt, left, right)?;
                let to = self.result(want);
                match relation(op) {
                    Some(relation) => {
                        self.emit(ScalarOp::Compare { relation, to, a, b })?;
                    }
                    None => {
                        let spans = [left, right].map(|e| m.program[e].span);
                        let span = spans[0].to(spans[1]);
                        match (op, self.whole_exponent(right)) {
                            (BinaryOp::Caret, Some(k)) => {
                                let note = CodeNote::Finite("^", span);
                                let op = match k {
                                    2 => ScalarOp::Square { to, a },
                                    _ => ScalarOp::PowerWhole { to, a, k },
                                };
                                self.noted(op, note)?;
                            }
                            _ => self.arithmetic(op, to, a, b, span)?,
                        }
                    }
                }
                to
            }
            ExprKind::Chain(items) => match self.chain_of(stmt, items)? {
                CodeValue::Number(at) => at,
                CodeValue::Vector(_) => return Err(Unfit::Statement),
            },
            ExprKind::Index { base, subs } => self.element(stmt, id, base, subs)?,
            ExprKind::Member { base, name, or_dot } => {
                let k = match m.program.name(name) {
                    "d1" => Some(0),
                    "d2" => Some(1),
                    _ => None,
                };
                match k {
                    Some(k) => {
                        let (array, _) = self.array_of(base)?;
                        let to = self.scratch();
                        self.noted(ScalarOp::Extent { to, array, k }, CodeNote::Expression(id))?;
                        to
                    }
                    None => self.component_of(stmt, base, name, or_dot)?,
                }
            }
            ExprKind::Call { callee, args } => self.call(stmt, id, callee, args)?,
            ExprKind::Text(_) | ExprKind::List(_) | ExprKind::Error => {
                return Err(Unfit::Statement);
            }
        };
        match want {
            Some(to) if to != at => {
                self.emit(ScalarOp::Copy { to, a: at })?;
                Ok(to)
            }
            _ => Ok(at),
        }
    }

    fn result(&mut self, want: Option<u16>) -> u16 {
        want.unwrap_or_else(|| self.scratch())
    }

    /// An exponent that is a small whole number of the text.
    fn whole_exponent(&self, id: ExprId) -> Option<i16> {
        let m = &self.units[self.unit].m;
        let literal = m.program.as_literal(id)?;
        ops::whole_power(m.program[literal].value).map(|k| k as i16)
    }

    /// Two operands, the left one as it is before the right one is computed.
    pub fn both(&mut self, stmt: StmtId, left: ExprId, right: ExprId) -> Result<(u16, u16), Unfit> {
        let a = self.value(stmt, left, None)?;
        let a = self.kept(a, self.calls(right))?;
        Ok((a, self.value(stmt, right, None)?))
    }

    /// The register, or a copy when a call may change the variable that it is.
    pub fn kept(&mut self, a: u16, copied: bool) -> Result<u16, Unfit> {
        let holds = |v: &CodeVariable| {
            let count = if v.ty == Some(Type::Vector) { 3 } else { 1 };
            (v.register..v.register + count).contains(&a)
        };
        if !copied || !self.units[self.unit].variables.iter().any(holds) {
            return Ok(a);
        }
        let to = self.scratch();
        self.emit(ScalarOp::Copy { to, a })?;
        Ok(to)
    }

    /// True when an expression calls a routine of the program.
    pub fn calls(&self, id: ExprId) -> bool {
        let m = &self.units[self.unit].m;
        let mut stack = vec![id];
        while let Some(id) = stack.pop() {
            let mut inner = parts::of_expression(m, id);
            if let ExprKind::Call { callee, .. } = m.program[id].kind {
                let Some(symbol) = m.program.as_name(callee) else { return true };
                if self.scope.routines.contains_key(&m.names[symbol.0 as usize]) {
                    return true;
                }
                inner.remove(0);
            }
            stack.extend(inner);
        }
        false
    }

    /// The code of `a op b`, an operator that gives a number.
    pub fn arithmetic(
        &mut self,
        op: BinaryOp,
        to: u16,
        a: u16,
        b: u16,
        span: Span,
    ) -> Result<(), Unfit> {
        let code = match op {
            BinaryOp::Add => ScalarOp::Add { to, a, b },
            BinaryOp::Sub => ScalarOp::Sub { to, a, b },
            BinaryOp::Mul => ScalarOp::Mul { to, a, b },
            BinaryOp::Div => ScalarOp::Div { to, a, b },
            BinaryOp::Caret => ScalarOp::Power { to, a, b },
            _ => return Err(Unfit::Statement),
        };
        self.noted(code, CodeNote::Finite(op.spelling(), span)).map(drop)
    }

    /// True if a variable has a value whenever this position of the code is reached.
    pub fn is_live(&self, what: Meaning) -> bool {
        match what {
            Meaning::Own(what) => self.known(what).live,
            Meaning::OfFile(Poisonable::Variable(k)) => {
                let variable = &self.units[0].variables[k as usize];
                variable.captured.is_some() && !variable.declared
            }
            Meaning::OfFile(Poisonable::Array(k)) => {
                let array = &self.units[0].arrays[k as usize];
                array.captured && !array.declared
            }
            Meaning::Constant(_) => true,
        }
    }

    /// The look at a variable before it is used, where that is needed.
    pub fn live(&mut self, what: Meaning, note: CodeNote) -> Result<(), Unfit> {
        if self.is_live(what) {
            return Ok(());
        }
        let op = match what {
            Meaning::Own(Poisonable::Variable(variable)) => ScalarOp::Live { variable },
            Meaning::OfFile(Poisonable::Variable(variable)) => ScalarOp::LiveFile { variable },
            Meaning::Own(Poisonable::Array(array)) => ScalarOp::LiveArray { array },
            Meaning::OfFile(Poisonable::Array(array)) => {
                ScalarOp::LiveArray { array: array | super::code::OF_FILE }
            }
            Meaning::Constant(_) => return Ok(()),
        };
        self.noted(op, note).map(drop)
    }

    /// The register of a name.
    pub fn name(&mut self, symbol: Symbol, span: Span) -> Result<u16, Unfit> {
        let what = self.meaning(symbol)?;
        if self.variable_type(what) == Some(Type::Vector) {
            return Err(Unfit::Statement);
        }
        self.live(what, CodeNote::Name(symbol, span))?;
        Ok(match what {
            Meaning::Constant(x) => self.constant(T::from(x)),
            Meaning::Own(Poisonable::Variable(k)) => {
                self.units[self.unit].variables[k as usize].register
            }
            Meaning::OfFile(Poisonable::Variable(k)) => {
                let of_file = self.units[0].variables[k as usize].register;
                let to = self.scratch();
                self.emit(ScalarOp::LoadFile { to, of_file })?;
                to
            }
            Meaning::Own(Poisonable::Array(_)) | Meaning::OfFile(Poisonable::Array(_)) => {
                return Err(Unfit::Statement);
            }
        })
    }

    /// The number of an array that an expression names, and its type.
    pub fn array_of(&mut self, id: ExprId) -> Result<(u16, Type), Unfit> {
        let m = self.units[self.unit].m.clone();
        let ExprKind::Name(symbol) = m.program[id].kind else { return Err(Unfit::Statement) };
        let what = self.meaning(symbol)?;
        let array = match what {
            Meaning::Own(Poisonable::Array(k)) => (k, self.units[self.unit].arrays[k as usize].ty),
            Meaning::OfFile(Poisonable::Array(k)) => {
                (k | super::code::OF_FILE, self.units[0].arrays[k as usize].ty)
            }
            _ => return Err(Unfit::Statement),
        };
        if array.1 == Type::String {
            return Err(Unfit::Statement);
        }
        self.live(what, CodeNote::Name(symbol, m.program[id].span))?;
        Ok(array)
    }

    /// An array, its type, and the registers of its one or two subscripts.
    pub fn places(
        &mut self,
        stmt: StmtId,
        base: ExprId,
        subs: NodeList<Subscript>,
        note: CodeNote,
    ) -> Result<(u16, Type, [u16; 2]), Unfit> {
        let m = self.units[self.unit].m.clone();
        let (array, ty) = self.array_of(base)?;
        let start = self.here()?;
        let mut places = [NO_LABEL; 2];
        if !(1..=2).contains(&subs.len()) {
            return Err(Unfit::Statement);
        }
        for (place, sub) in places.iter_mut().zip(&m.program[subs]) {
            let Subscript::At(at) = *sub else { return Err(Unfit::Statement) };
            *place = self.value(stmt, at, None)?;
        }
        let end = self.here()?;
        self.units[self.unit].inner.push((start, end, note));
        Ok((array, ty, places))
    }

    /// The element that an expression names.
    pub fn element(
        &mut self,
        stmt: StmtId,
        id: ExprId,
        base: ExprId,
        subs: NodeList<Subscript>,
    ) -> Result<u16, Unfit> {
        // A fault is located by a second evaluation.
        if self.calls_in_subscripts(subs) {
            return Err(Unfit::Statement);
        }
        let note = CodeNote::Expression(id);
        let (array, ty, places) = self.places(stmt, base, subs, note)?;
        if ty != Type::Farray {
            return Err(Unfit::Statement);
        }
        let to = self.scratch();
        let op = ScalarOp::Load { to, array, i: places[0], j: places[1] };
        self.noted(op, note)?;
        Ok(to)
    }

    pub fn function(&mut self, name: &'static str, f: Elementary<T>) -> Result<u16, Unfit> {
        let at = match self.functions.iter().position(|(known, _)| *known == name) {
            Some(at) => at,
            None => {
                self.functions.push((name, f));
                self.functions.len() - 1
            }
        };
        u16::try_from(at).map_err(|_| Unfit::Unit)
    }

    fn call(
        &mut self,
        stmt: StmtId,
        id: ExprId,
        callee: ExprId,
        args: NodeList<Arg>,
    ) -> Result<u16, Unfit> {
        let m = self.units[self.unit].m.clone();
        let symbol = m.program.as_name(callee).ok_or(Unfit::Statement)?;
        let name = m.names[symbol.0 as usize];
        if self.scope.routines.contains_key(&name) {
            if self.is_vector(id) {
                return Err(Unfit::Statement);
            }
            let to = self.scratch();
            return self.routine_call(stmt, id, callee, args, Some(to)).map(|_| to);
        }
        if !self.is_free(symbol) || m.program[args].iter().any(|arg| arg.name.is_some()) {
            return Err(Unfit::Statement);
        }
        let given: Vec<ExprId> = m.program[args].iter().map(|arg| arg.value).collect();
        let row = m.rows[symbol.0 as usize].as_ref().ok_or(Unfit::Statement)?;
        if !matches!(row.body, Implementation::Native { .. }) {
            return Err(Unfit::Statement);
        }
        let span = m.program[id].span;
        let mut values = Vec::with_capacity(given.len());
        let known = elementary::elementary::<T>(&row.name);
        let several =
            elementary::combining::<T>(&row.name).filter(|_| (2..=4).contains(&given.len()));
        if known.is_none() && several.is_none() {
            return Err(Unfit::Statement);
        }
        for (k, &arg) in given.iter().enumerate() {
            let a = self.value(stmt, arg, None)?;
            let later = given[k + 1..].iter().any(|&next| self.calls(next));
            values.push(self.kept(a, later)?);
        }
        let to = self.scratch();
        match (known, &values[..]) {
            (Some((name, f @ Elementary::Unary(_))), &[a]) => {
                let f = self.function(name, f)?;
                self.noted(ScalarOp::Apply { to, a, f }, CodeNote::Finite(name, span))?;
            }
            (Some((name, f @ Elementary::Binary(_))), &[a, b]) => {
                let f = self.function(name, f)?;
                let op = match name {
                    "mod" => ScalarOp::Remainder { to, a, b, f },
                    _ => ScalarOp::Apply2 { to, a, b, f },
                };
                self.noted(op, CodeNote::Finite(name, span))?;
            }
            (None, &[first, ref rest @ ..]) => {
                let (name, f) = several.ok_or(Unfit::Statement)?;
                let f = self.function(name, f)?;
                let mut a = first;
                for &b in rest {
                    self.emit(ScalarOp::Combine { to, a, b, f })?;
                    a = to;
                }
                self.noted(ScalarOp::Finite { a: to }, CodeNote::Finite(name, span))?;
            }
            _ => return Err(Unfit::Statement),
        }
        Ok(to)
    }

    /// The variable of the file that a returned argument names.
    ///
    /// # Errors
    /// For other arguments by reference, and invalid ones.
    fn root_of(&mut self, arg: ExprId, asked: Type) -> Result<Name, Unfit> {
        let m = self.units[self.unit].m.clone();
        let symbol = m.program.as_name(m.program.bare(arg)).ok_or(Unfit::Statement)?;
        let what = self.meaning(symbol)?;
        if !self.is_live(what) || self.is_param(what) {
            return Err(Unfit::Statement);
        }
        let file = &self.units[0];
        let (name, found) = match what {
            Meaning::Own(_) if self.unit != 0 => return Err(Unfit::Statement),
            Meaning::Own(Poisonable::Variable(k)) | Meaning::OfFile(Poisonable::Variable(k)) => {
                let variable = &file.variables[k as usize];
                (Some(variable.name), variable.ty.unwrap_or(Type::Float))
            }
            Meaning::Own(Poisonable::Array(k)) | Meaning::OfFile(Poisonable::Array(k)) => {
                let array = &file.arrays[k as usize];
                (array.name, array.ty)
            }
            Meaning::Constant(_) => return Err(Unfit::Statement),
        };
        let number = |ty: Type| if ty == Type::Int { Type::Float } else { ty };
        match name {
            Some(name) if number(found) == number(asked) => Ok(name),
            _ => Err(Unfit::Statement),
        }
    }

    /// The call of a routine of the program; its value is put into `to`, where one is wanted.
    pub fn routine_call(
        &mut self,
        stmt: StmtId,
        id: ExprId,
        callee: ExprId,
        args: NodeList<Arg>,
        to: Option<u16>,
    ) -> Result<(), Unfit> {
        let m = self.units[self.unit].m.clone();
        let symbol = m.program.as_name(callee).ok_or(Unfit::Statement)?;
        let name = m.names[symbol.0 as usize];
        let at = *self.scope.routines.get(&name).ok_or(Unfit::Statement)?;
        if !self.is_free(symbol) || m.program[args].iter().any(|arg| arg.name.is_some()) {
            return Err(Unfit::Statement);
        }
        if let Some(to) = to
            && self.stands_here(stmt, id, at, args, to)?
        {
            return Ok(());
        }
        let of = self.modules.get(at.module).clone();
        let routine = of.program[at.routine];
        let formals = &of.program[routine.formals];
        let given: Vec<ExprId> = m.program[args].iter().map(|arg| arg.value).collect();
        if given.len() != formals.len() || (to.is_some() && routine.result.is_none()) {
            return Err(Unfit::Statement);
        }
        let mut roots = Vec::with_capacity(given.len());
        for (&arg, formal) in given.iter().zip(formals) {
            let root = if formal.returned { Some(self.root_of(arg, formal.ty.0)?) } else { None };
            // Elements that are written twice are the interpreter's to refuse.
            if root.is_some() && roots.contains(&root) {
                return Err(Unfit::Statement);
            }
            roots.push(root);
        }
        let unit = self.routine(at, &roots)?;
        let mut all = Vec::with_capacity(given.len());
        for (k, (&arg, formal)) in given.iter().zip(formals).enumerate() {
            all.push(match formal.ty.0 {
                _ if formal.returned => CodeArgument::OfFile,
                Type::Vector => {
                    if !self.is_vector(arg) {
                        return Err(Unfit::Statement);
                    }
                    let a = self.vector(stmt, arg)?;
                    let later = given[k + 1..].iter().any(|&next| self.calls(next));
                    CodeArgument::Vector { from: self.kept_vector(a, later)? }
                }
                Type::Int | Type::Float => {
                    let a = self.value(stmt, arg, None)?;
                    let later = given[k + 1..].iter().any(|&next| self.calls(next));
                    let mut from = self.kept(a, later)?;
                    // A fault of the conversion comes before the next argument is computed.
                    if formal.ty.0 == Type::Int {
                        let to = self.scratch();
                        let note = CodeNote::Argument(m.program[arg].span, formal.ty.1);
                        self.noted(ScalarOp::Whole { to, a: from }, note)?;
                        from = to;
                    }
                    CodeArgument::Number { from }
                }
                Type::String => {
                    if !self.is_text(arg) || given[k + 1..].iter().any(|&next| self.calls(next)) {
                        return Err(Unfit::Statement);
                    }
                    CodeArgument::Array { from: self.text(stmt, arg, None)? }
                }
                _ => {
                    // An array that a later argument may change would have to be copied now.
                    if given[k + 1..].iter().any(|&next| self.calls(next)) {
                        return Err(Unfit::Statement);
                    }
                    let (from, ty) = self.array_of(arg)?;
                    if ty != formal.ty.0 {
                        return Err(Unfit::Statement);
                    }
                    self.noted(ScalarOp::HasValue { array: from }, CodeNote::Expression(arg))?;
                    CodeArgument::Array { from }
                }
            });
        }
        let site = self.site(stmt, Some(id), m.program[id].span)?;
        let here = &mut self.units[self.unit].sites[site as usize];
        here.unit = unit;
        here.args = all.into();
        here.valued = to.is_some();
        self.emit(ScalarOp::Call { to: to.unwrap_or(NO_LABEL), site }).map(drop)
    }
}

/// The operands of a chain, in the order of the text.
pub(super) fn operands(items: &[ChainItem]) -> impl Iterator<Item = ExprId> + '_ {
    items.iter().filter_map(|item| match item {
        ChainItem::Operand(operand) => Some(*operand),
        _ => None,
    })
}
