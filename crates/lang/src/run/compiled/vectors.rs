//! Vectors to code: three registers, one behind the other, worked on component by component.
//!
//! Operators have the order of operations of [`moldloft_num::Vec3`], so that the bits are those of the interpreter. A
//! result is made in registers of its own and copied at the end: a fault in its second component leaves the variable
//! as it was.

use super::code::{Captured, CodeNote, Poisonable, ScalarOp};
use super::compile::{RegionCompiler, Unfit, relation};
use super::names::Meaning;
use crate::functions::elementary::Elementary;
use moldloft_diag::Span;
use moldloft_registry::Scalar;
use moldloft_syntax::sdl::{
    AssignOp, BinaryOp, ChainItem, ExprId, ExprKind, Grouping, NodeList, Step, StmtId, Subscript,
    Symbol, Type, UnaryOp,
};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CodeValue {
    Number(u16),
    /// The first of three.
    Vector(u16),
}

/// The component that a member's name means.
pub(super) fn component(word: &str) -> Option<u16> {
    ["x", "y", "z"].iter().position(|c| *c == word).map(|c| c as u16)
}

impl<T: Scalar> RegionCompiler<'_, T> {
    /// True when an expression gives a vector, as far as code can say; it is not when it cannot.
    pub fn is_vector(&mut self, id: ExprId) -> bool {
        let m = self.units[self.unit].m.clone();
        match m.program[id].kind {
            ExprKind::Name(symbol) => {
                let Ok(what) = self.meaning(symbol) else { return false };
                self.variable_type(what) == Some(Type::Vector)
            }
            ExprKind::Paren(inner)
            | ExprKind::Unary { op: UnaryOp::Minus | UnaryOp::Plus, operand: inner } => {
                self.is_vector(inner)
            }
            ExprKind::Binary { op, left, right } => match op {
                BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div => {
                    self.is_vector(left) || self.is_vector(right)
                }
                BinaryOp::Cross => self.is_vector(left) && self.is_vector(right),
                _ => false,
            },
            ExprKind::Chain(items) => self.is_vector_chain(items),
            ExprKind::List(items) => items.len() == 3,
            ExprKind::Index { base, subs } => {
                let single = m.program[subs].iter().all(|sub| matches!(sub, Subscript::At(_)));
                single && matches!(self.array_type(base), Some(Type::Curve | Type::Surface))
            }
            ExprKind::Call { callee, .. } => {
                let Some(symbol) = m.program.as_name(callee) else { return false };
                let name = m.names[symbol.0 as usize];
                let Some(at) = self.scope.routines.get(&name).copied() else { return false };
                let of = self.modules.get(at.module);
                of.program[at.routine].result.is_some_and(|(ty, _)| ty == Type::Vector)
                    && self.is_free(symbol)
            }
            _ => false,
        }
    }

    fn is_vector_chain(&mut self, items: NodeList<ChainItem>) -> bool {
        let m = self.units[self.unit].m.clone();
        let mut stack: Vec<bool> = Vec::new();
        for step in m.program.grouped(items, Grouping::Numbers) {
            match step {
                Step::Push(expr) => {
                    let vector = self.is_vector(expr);
                    stack.push(vector);
                }
                Step::Unary(..) => {}
                Step::Binary(op, _) => {
                    let (Some(b), Some(a)) = (stack.pop(), stack.pop()) else { return false };
                    stack.push(match op {
                        BinaryOp::Dot | BinaryOp::Caret => false,
                        BinaryOp::Cross => a && b,
                        _ => a || b,
                    });
                }
            }
        }
        stack.pop().unwrap_or(false)
    }

    /// The type of the variable that a name means.
    pub fn variable_type(&self, what: Meaning) -> Option<Type> {
        match what {
            Meaning::Own(Poisonable::Variable(k)) => self.units[self.unit].variables[k as usize].ty,
            Meaning::OfFile(Poisonable::Variable(k)) => self.units[0].variables[k as usize].ty,
            _ => None,
        }
    }

    /// The type of the array that an expression names.
    pub fn array_type(&mut self, id: ExprId) -> Option<Type> {
        let m = self.units[self.unit].m.clone();
        let symbol = m.program.as_name(id)?;
        match self.meaning(symbol).ok()? {
            Meaning::Own(Poisonable::Array(k)) => Some(self.units[self.unit].arrays[k as usize].ty),
            Meaning::OfFile(Poisonable::Array(k)) => Some(self.units[0].arrays[k as usize].ty),
            _ => None,
        }
        .filter(|ty| *ty != Type::String)
    }

    /// The value of an expression, a number or a vector.
    pub fn operand(&mut self, stmt: StmtId, id: ExprId) -> Result<CodeValue, Unfit> {
        Ok(match self.is_vector(id) {
            true => CodeValue::Vector(self.vector(stmt, id)?),
            false => CodeValue::Number(self.value(stmt, id, None)?),
        })
    }

    /// The first of the three registers of a vector: those of a variable, or its own.
    pub fn vector(&mut self, stmt: StmtId, id: ExprId) -> Result<u16, Unfit> {
        let m = self.units[self.unit].m.clone();
        let expr = m.program[id];
        match expr.kind {
            ExprKind::Name(symbol) => self.vector_name(symbol, expr.span),
            ExprKind::Paren(inner) | ExprKind::Unary { op: UnaryOp::Plus, operand: inner } => {
                self.vector(stmt, inner)
            }
            ExprKind::Unary { op: UnaryOp::Minus, operand } => {
                let a = self.vector(stmt, operand)?;
                self.negated_vector(a)
            }
            ExprKind::Binary { op, left, right } => {
                let (a, b) = self.both_operands(stmt, left, right)?;
                let span = m.program[left].span.to(m.program[right].span);
                match self.combined(op, a, b, span)? {
                    CodeValue::Vector(at) => Ok(at),
                    CodeValue::Number(_) => Err(Unfit::Statement),
                }
            }
            ExprKind::Chain(items) => match self.chain_of(stmt, items)? {
                CodeValue::Vector(at) => Ok(at),
                CodeValue::Number(_) => Err(Unfit::Statement),
            },
            ExprKind::List(items) => {
                let to = self.scratch_vector();
                let items: Vec<ExprId> = m.program[items].to_vec();
                for (k, &item) in items.iter().enumerate() {
                    self.value(stmt, item, Some(to + k as u16))?;
                }
                Ok(to)
            }
            ExprKind::Index { base, subs } => {
                if self.calls_in_subscripts(subs) {
                    return Err(Unfit::Statement);
                }
                let note = CodeNote::Expression(id);
                let (array, ty, places) = self.places(stmt, base, subs, note)?;
                if ty == Type::Farray {
                    return Err(Unfit::Statement);
                }
                let to = self.scratch_vector();
                let op = ScalarOp::LoadVector { to, array, i: places[0], j: places[1] };
                self.noted(op, note)?;
                Ok(to)
            }
            ExprKind::Call { callee, args } => {
                let to = self.scratch_vector();
                self.routine_call(stmt, id, callee, args, Some(to)).map(|()| to)
            }
            _ => Err(Unfit::Statement),
        }
    }

    fn vector_name(&mut self, symbol: Symbol, span: Span) -> Result<u16, Unfit> {
        let what = self.meaning(symbol)?;
        if self.variable_type(what) != Some(Type::Vector) {
            return Err(Unfit::Statement);
        }
        self.live(what, CodeNote::Name(symbol, span))?;
        match what {
            Meaning::Own(Poisonable::Variable(k)) => {
                Ok(self.units[self.unit].variables[k as usize].register)
            }
            Meaning::OfFile(Poisonable::Variable(k)) => {
                let of_file = self.units[0].variables[k as usize].register;
                let to = self.scratch_vector();
                for c in 0..3 {
                    self.emit(ScalarOp::LoadFile { to: to + c, of_file: of_file + c })?;
                }
                Ok(to)
            }
            _ => Err(Unfit::Statement),
        }
    }

    /// The register of `base.x`, when that is the component of a vector.
    pub fn component_of(
        &mut self,
        stmt: StmtId,
        base: ExprId,
        name: Symbol,
        or_dot: bool,
    ) -> Result<u16, Unfit> {
        let m = self.units[self.unit].m.clone();
        let c = component(m.program.name(name)).ok_or(Unfit::Statement)?;
        if !self.is_vector(base) || (or_dot && self.may_be_vector(name)) {
            return Err(Unfit::Statement);
        }
        Ok(self.vector(stmt, base)? + c)
    }

    /// True when a name may mean vectors: then a dot before it may be a product, which is left to the interpreter.
    pub fn may_be_vector(&mut self, name: Symbol) -> bool {
        match self.meaning(name) {
            Ok(Meaning::Constant(_)) => false,
            Ok(
                what @ (Meaning::Own(Poisonable::Variable(_))
                | Meaning::OfFile(Poisonable::Variable(_))),
            ) => self.variable_type(what) == Some(Type::Vector),
            Ok(Meaning::Own(Poisonable::Array(k))) => {
                self.units[self.unit].arrays[k as usize].ty != Type::Farray
            }
            Ok(Meaning::OfFile(Poisonable::Array(k))) => {
                self.units[0].arrays[k as usize].ty != Type::Farray
            }
            Err(_) => !self.is_free(name),
        }
    }

    /// Two operands, the left one as it is before the right one is computed.
    fn both_operands(
        &mut self,
        stmt: StmtId,
        left: ExprId,
        right: ExprId,
    ) -> Result<(CodeValue, CodeValue), Unfit> {
        let a = self.operand(stmt, left)?;
        let later = self.calls(right);
        let a = self.kept_value(a, later)?;
        Ok((a, self.operand(stmt, right)?))
    }

    /// The registers, or copies when a call may change the variable that they are.
    pub fn kept_value(&mut self, a: CodeValue, copied: bool) -> Result<CodeValue, Unfit> {
        Ok(match a {
            CodeValue::Number(a) => CodeValue::Number(self.kept(a, copied)?),
            CodeValue::Vector(a) => CodeValue::Vector(self.kept_vector(a, copied)?),
        })
    }

    pub fn kept_vector(&mut self, a: u16, copied: bool) -> Result<u16, Unfit> {
        let variable = self.units[self.unit].variables.iter().any(|v| v.register == a);
        if !copied || !variable {
            return Ok(a);
        }
        let to = self.scratch_vector();
        self.emit(ScalarOp::CopyVector { to, a })?;
        Ok(to)
    }

    pub fn negated_vector(&mut self, a: u16) -> Result<u16, Unfit> {
        let to = self.scratch_vector();
        for c in 0..3 {
            self.emit(ScalarOp::Negate { to: to + c, a: a + c })?;
        }
        Ok(to)
    }

    /// `a op b`, one of them a vector.
    pub fn combined(
        &mut self,
        op: BinaryOp,
        a: CodeValue,
        b: CodeValue,
        span: Span,
    ) -> Result<CodeValue, Unfit> {
        use CodeValue::{Number, Vector};
        let each = |this: &mut Self, a: [u16; 3], b: [u16; 3]| {
            let to = this.scratch_vector();
            for c in 0..3 {
                this.arithmetic(op, to + c as u16, a[c], b[c], span)?;
            }
            Ok(Vector(to))
        };
        let parts = |a: u16| [a, a + 1, a + 2];
        match (op, a, b) {
            (
                BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div,
                Vector(a),
                Vector(b),
            ) => each(self, parts(a), parts(b)),
            (BinaryOp::Mul | BinaryOp::Div, Vector(a), Number(b)) => each(self, parts(a), [b; 3]),
            // As the interpreter has it: the vector times the number.
            (BinaryOp::Mul, Number(a), Vector(b)) => each(self, parts(b), [a; 3]),
            (BinaryOp::Dot, Vector(a), Vector(b)) => {
                Ok(Number(self.dot(a, b, CodeNote::Finite(op.spelling(), span))?))
            }
            (BinaryOp::Cross, Vector(a), Vector(b)) => {
                let to = self.scratch_vector();
                let note = CodeNote::Finite(op.spelling(), span);
                for c in 0..3 {
                    let (i, j) = ((c + 1) % 3, (c + 2) % 3);
                    let (plus, minus) = (self.scratch(), self.scratch());
                    self.noted(ScalarOp::Mul { to: plus, a: a + i, b: b + j }, note)?;
                    self.noted(ScalarOp::Mul { to: minus, a: a + j, b: b + i }, note)?;
                    self.noted(ScalarOp::Sub { to: to + c, a: plus, b: minus }, note)?;
                }
                Ok(Vector(to))
            }
            (BinaryOp::Dot | BinaryOp::Cross, ..) => Err(Unfit::Statement),
            (_, Number(a), Number(b)) => {
                let to = self.scratch();
                self.arithmetic(op, to, a, b, span)?;
                Ok(Number(to))
            }
            _ => Err(Unfit::Statement),
        }
    }

    fn dot(&mut self, a: u16, b: u16, note: CodeNote) -> Result<u16, Unfit> {
        let (to, next) = (self.scratch(), self.scratch());
        self.noted(ScalarOp::Mul { to, a, b }, note)?;
        for c in 1..3 {
            self.noted(ScalarOp::Mul { to: next, a: a + c, b: b + c }, note)?;
            self.noted(ScalarOp::Add { to, a: to, b: next }, note)?;
        }
        Ok(to)
    }

    /// `a . b` of two vectors.
    pub fn dot_product(&mut self, stmt: StmtId, left: ExprId, right: ExprId) -> Result<u16, Unfit> {
        let m = self.units[self.unit].m.clone();
        let span = m.program[left].span.to(m.program[right].span);
        let (a, b) = self.both_operands(stmt, left, right)?;
        match self.combined(BinaryOp::Dot, a, b, span)? {
            CodeValue::Number(at) => Ok(at),
            CodeValue::Vector(_) => Err(Unfit::Statement),
        }
    }

    /// `|a|` of a vector.
    pub fn length(&mut self, stmt: StmtId, inner: ExprId, span: Span) -> Result<u16, Unfit> {
        let a = self.vector(stmt, inner)?;
        let note = CodeNote::Finite("||", span);
        let square = self.dot(a, a, note)?;
        let to = self.scratch();
        let f = self.function("||", Elementary::Unary(T::sqrt))?;
        self.noted(ScalarOp::Apply { to, a: square, f }, note)?;
        Ok(to)
    }

    /// A chain of operators, numbers and vectors in it.
    pub fn chain_of(
        &mut self,
        stmt: StmtId,
        items: NodeList<ChainItem>,
    ) -> Result<CodeValue, Unfit> {
        let m = self.units[self.unit].m.clone();
        let all: Vec<ExprId> = super::expressions::operands(&m.program[items]).collect();
        let mut values = Vec::with_capacity(all.len());
        for (k, &operand) in all.iter().enumerate() {
            let a = self.operand(stmt, operand)?;
            let later = all[k + 1..].iter().any(|&next| self.calls(next));
            values.push(self.kept_value(a, later)?);
        }
        let mut next = values.into_iter();
        let mut stack: Vec<(CodeValue, Span)> = Vec::new();
        for step in m.program.grouped(items, Grouping::Numbers) {
            let entry = match step {
                Step::Push(expr) => (next.next().ok_or(Unfit::Statement)?, m.program[expr].span),
                Step::Unary(op, span) => {
                    let (a, inner) = stack.pop().ok_or(Unfit::Statement)?;
                    let signed = match (op, a) {
                        (UnaryOp::Plus, a) => a,
                        (UnaryOp::Minus, CodeValue::Vector(a)) => {
                            CodeValue::Vector(self.negated_vector(a)?)
                        }
                        (UnaryOp::Minus, CodeValue::Number(a)) => {
                            let to = self.scratch();
                            self.emit(ScalarOp::Negate { to, a })?;
                            CodeValue::Number(to)
                        }
                        (UnaryOp::Not, CodeValue::Number(a)) => {
                            let to = self.scratch();
                            self.emit(ScalarOp::Not { to, a })?;
                            CodeValue::Number(to)
                        }
                        (UnaryOp::Not, CodeValue::Vector(_)) => return Err(Unfit::Statement),
                    };
                    (signed, span.to(inner))
                }
                Step::Binary(op, _) => {
                    let (b, of_right) = stack.pop().ok_or(Unfit::Statement)?;
                    let (a, of_left) = stack.pop().ok_or(Unfit::Statement)?;
                    if relation(op).is_some() {
                        return Err(Unfit::Statement);
                    }
                    let span = of_left.to(of_right);
                    (self.combined(op, a, b, span)?, span)
                }
            };
            stack.push(entry);
        }
        stack.pop().map(|(at, _)| at).ok_or(Unfit::Statement)
    }

    /// Puts a vector into a variable.
    fn set_vector(&mut self, what: Meaning, a: u16) -> Result<(), Unfit> {
        match what {
            Meaning::Own(Poisonable::Variable(k)) => {
                let to = self.units[self.unit].variables[k as usize].register;
                self.emit(ScalarOp::CopyVector { to, a })?;
            }
            Meaning::OfFile(Poisonable::Variable(k)) => {
                let of_file = self.units[0].variables[k as usize].register;
                for c in 0..3 {
                    self.emit(ScalarOp::StoreFile { of_file: of_file + c, a: a + c })?;
                }
            }
            _ => return Err(Unfit::Statement),
        }
        Ok(())
    }

    /// An assignment to a vector variable, to a vector element, or to a component; false for other
    /// targets.
    pub fn assigned_vector(
        &mut self,
        id: StmtId,
        target: ExprId,
        op: AssignOp,
        value: ExprId,
    ) -> Result<bool, Unfit> {
        let m = self.units[self.unit].m.clone();
        let spans = [target, value].map(|e| m.program[e].span);
        match m.program[target].kind {
            ExprKind::Name(symbol) => {
                let what = self.meaning(symbol)?;
                if self.variable_type(what) != Some(Type::Vector) {
                    return Ok(false);
                }
                let from = self.new_value(id, target, op, value, spans)?;
                let CodeValue::Vector(from) = from else { return Err(Unfit::Statement) };
                self.live(what, CodeNote::Name(symbol, spans[0]))?;
                self.set_vector(what, from)?;
            }
            ExprKind::Index { base, subs } => {
                if !matches!(self.array_type(base), Some(Type::Curve | Type::Surface)) {
                    return Ok(false);
                }
                if self.calls_in_subscripts(subs) {
                    return Err(Unfit::Statement);
                }
                let from = self.new_value(id, target, op, value, spans)?;
                let CodeValue::Vector(a) = from else { return Err(Unfit::Statement) };
                let note = CodeNote::Target(target);
                let (array, _, places) = self.places(id, base, subs, note)?;
                let op = ScalarOp::StoreVector { array, i: places[0], j: places[1], a };
                self.noted(op, note)?;
            }
            ExprKind::Member { base, name, or_dot } => {
                let part = component(m.program.name(name)).ok_or(Unfit::Statement)?;
                if !self.is_vector(base) || (or_dot && self.may_be_vector(name)) {
                    return Err(Unfit::Statement);
                }
                self.assigned_part(id, (target, base, part), op, value, spans)?;
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn assigned_part(
        &mut self,
        id: StmtId,
        (target, base, part): (ExprId, ExprId, u16),
        op: AssignOp,
        value: ExprId,
        spans: [Span; 2],
    ) -> Result<(), Unfit> {
        let m = self.units[self.unit].m.clone();
        match m.program[m.program.bare(base)].kind {
            ExprKind::Name(symbol) => {
                let what = self.meaning(symbol)?;
                let CodeValue::Number(from) = self.new_value(id, target, op, value, spans)? else {
                    return Err(Unfit::Statement);
                };
                self.live(what, CodeNote::Name(symbol, m.program[m.program.bare(base)].span))?;
                match what {
                    Meaning::Own(Poisonable::Variable(k)) => {
                        let to = self.units[self.unit].variables[k as usize].register + part;
                        self.emit(ScalarOp::Copy { to, a: from })?;
                    }
                    Meaning::OfFile(Poisonable::Variable(k)) => {
                        let of_file = self.units[0].variables[k as usize].register + part;
                        self.emit(ScalarOp::StoreFile { of_file, a: from })?;
                    }
                    _ => return Err(Unfit::Statement),
                }
                Ok(())
            }
            ExprKind::Index { base, subs } => {
                if self.calls_in_subscripts(subs) {
                    return Err(Unfit::Statement);
                }
                let CodeValue::Number(a) = self.new_value(id, target, op, value, spans)? else {
                    return Err(Unfit::Statement);
                };
                let note = CodeNote::Target(target);
                let (array, ty, places) = self.places(id, base, subs, note)?;
                if ty == Type::Farray {
                    return Err(Unfit::Statement);
                }
                let part = part as u8;
                let op = ScalarOp::StorePart { array, i: places[0], j: places[1], a, part };
                self.noted(op, note).map(drop)
            }
            _ => Err(Unfit::Statement),
        }
    }

    /// The new value of an assignment's target.
    fn new_value(
        &mut self,
        id: StmtId,
        target: ExprId,
        op: AssignOp,
        value: ExprId,
        spans: [Span; 2],
    ) -> Result<CodeValue, Unfit> {
        let AssignOp::With(op) = op else { return self.operand(id, value) };
        let a = self.operand(id, target)?;
        let a = self.kept_value(a, self.calls(value))?;
        let b = self.operand(id, value)?;
        self.combined(op, a, b, spans[0].to(spans[1]))
    }

    /// True if the captured name is a parameter, which cannot be assigned.
    pub fn is_param(&self, what: Meaning) -> bool {
        let captured = match what {
            Meaning::Own(Poisonable::Variable(k)) => {
                self.units[self.unit].variables[k as usize].captured
            }
            Meaning::OfFile(Poisonable::Variable(k)) => {
                self.units[0].variables[k as usize].captured
            }
            _ => None,
        };
        matches!(captured, Some(Captured::Param(_)))
    }
}
