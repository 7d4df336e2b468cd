//! Statements on whole arrays to code: the element-wise part is one operation, a pass over the elements.
//!
//! The tape is that of the interpreter's lowering, made once for all kinds of operands; shapes are compared when it
//! is run. A statement that does not fit (another shape, a fault, an array without a value) is left to the
//! interpreter as a whole, which finds the first of several faults; so its numbers must come without calls.

use super::code::{ArrayKernel, CodeNote, CodeSection, CodeSubscript, KernelTarget, ScalarOp};
use super::compile::{RegionCompiler, Unfit, relation};
use super::vectors::{CodeValue, component};
use crate::array::lanes::{TapeArray, What};
use crate::array::lower::{Loose, Loosely, TapeBuilder, TapeNumber};
use crate::functions::elementary::{self, Elementary};
use crate::value::ops;
use moldloft_diag::Span;
use moldloft_elementwise::{Code, Src, Tape};
use moldloft_num::Real;
use moldloft_registry::{ArrayShape, Implementation, Scalar};
use moldloft_syntax::sdl::{
    Arg, AssignOp, BinaryOp, ChainItem, ExprId, ExprKind, Grouping, NodeList, Step, StmtId,
    Subscript, Type, UnaryOp,
};
use smallvec::SmallVec;

/// Stands for the shape of all arrays of a tape until it is run.
const ANY_SHAPE: ArrayShape = ArrayShape::Row(1);

/// An operand of an element-wise operation.
#[derive(Clone, Copy)]
enum Lane<T> {
    Literal(T),
    Single(CodeValue),
    Array(TapeArray),
}

/// A kernel under construction.
struct KernelBuilder<T: Real> {
    work: TapeBuilder<T>,
    leaves: Vec<CodeSection>,
    planes: Vec<(u16, u8)>,
    inputs: Vec<(u16, u16)>,
    charges: Vec<Span>,
}

impl<T: Real> KernelBuilder<T> {
    fn new() -> Self {
        Self {
            work: TapeBuilder { tape: Tape::default(), calls: Vec::new(), ieee: false },
            leaves: Vec::new(),
            planes: Vec::new(),
            inputs: Vec::new(),
            charges: Vec::new(),
        }
    }

    fn leaf(&mut self, section: CodeSection) -> u16 {
        let whole = |s: &CodeSection| s.array == section.array && s.subscripts.is_none();
        let known = self.leaves.iter().position(whole).filter(|_| section.subscripts.is_none());
        known.unwrap_or_else(|| {
            self.leaves.push(section);
            self.leaves.len() - 1
        }) as u16
    }

    fn plane(&mut self, leaf: u16, part: usize) -> Src {
        let plane = (leaf, part as u8);
        let known = self.planes.iter().position(|known| *known == plane);
        Src::Plane(known.unwrap_or_else(|| {
            self.planes.push(plane);
            self.planes.len() - 1
        }) as u16)
    }

    /// The rows of a leaf: its numbers, its vectors, or a component of them.
    fn rows(&mut self, leaf: u16, ty: Type, part: Option<usize>) -> TapeArray {
        let what = match (ty, part) {
            (Type::Farray, _) => What::Number(self.plane(leaf, 0)),
            (_, Some(part)) => What::Number(self.plane(leaf, part)),
            _ => What::Vector([0, 1, 2].map(|part| self.plane(leaf, part))),
        };
        TapeArray { shape: ANY_SHAPE, what }
    }

    fn input(&mut self, register: u16) -> TapeNumber<T> {
        let known = self.inputs.iter().find(|(_, from)| *from == register).map(|(at, _)| *at);
        let at = known.unwrap_or_else(|| {
            let at = self.work.tape.input();
            self.inputs.push((at, register));
            at
        });
        TapeNumber::Src(Src::Const(at))
    }

    fn loose(&mut self, lane: Lane<T>) -> Loose<T> {
        match lane {
            Lane::Literal(x) => (None, Loosely::Number(TapeNumber::Const(x))),
            Lane::Single(CodeValue::Number(at)) => (None, Loosely::Number(self.input(at))),
            Lane::Single(CodeValue::Vector(at)) => {
                (None, Loosely::Vector([at, at + 1, at + 2].map(|at| self.input(at))))
            }
            Lane::Array(TapeArray { what: What::Number(a), .. }) => {
                (Some(ANY_SHAPE), Loosely::Number(TapeNumber::Src(a)))
            }
            Lane::Array(TapeArray { what: What::Vector(v), .. }) => {
                (Some(ANY_SHAPE), Loosely::Vector(v.map(TapeNumber::Src)))
            }
        }
    }

    fn roots(&mut self, lane: Lane<T>) -> SmallVec<[Src; 3]> {
        match self.loose(lane).1 {
            Loosely::Number(x) => SmallVec::from_slice(&[self.work.src(&x)]),
            Loosely::Vector(v) => v.iter().map(|x| self.work.src(x)).collect(),
        }
    }
}

impl<T: Scalar> RegionCompiler<'_, T> {
    /// True when an expression gives an array, as far as code can say.
    pub fn is_whole(&mut self, id: ExprId) -> bool {
        let m = self.units[self.unit].m.clone();
        match m.program[id].kind {
            ExprKind::Name(_) => self.array_type(id).is_some(),
            ExprKind::Paren(inner)
            | ExprKind::Magnitude(inner)
            | ExprKind::Unary { op: UnaryOp::Minus | UnaryOp::Plus, operand: inner } => {
                self.is_whole(inner)
            }
            ExprKind::Binary { op, left, right } => {
                ops::is_elementwise(op) && (self.is_whole(left) || self.is_whole(right))
            }
            ExprKind::Chain(items) => {
                super::expressions::operands(&m.program[items]).any(|e| self.is_whole(e))
            }
            ExprKind::List(items) => {
                items.len() == 3 && m.program[items].iter().any(|&e| self.is_whole(e))
            }
            ExprKind::Index { base, subs } => {
                self.array_type(base).is_some()
                    && !m.program[subs].iter().all(|sub| matches!(sub, Subscript::At(_)))
            }
            ExprKind::Member { base, name, .. } => {
                component(m.program.name(name)).is_some() && self.is_whole(base)
            }
            ExprKind::Call { callee, args } => {
                self.elementary(callee, args).is_some()
                    && m.program[args].iter().any(|arg| self.is_whole(arg.value))
            }
            _ => false,
        }
    }

    /// The function of numbers that a call names.
    fn elementary(
        &mut self,
        callee: ExprId,
        args: NodeList<Arg>,
    ) -> Option<(&'static str, Elementary<T>)> {
        let m = self.units[self.unit].m.clone();
        let symbol = m.program.as_name(callee)?;
        let row = m.rows[symbol.0 as usize].as_ref()?;
        if !matches!(row.body, Implementation::Native { .. })
            || m.program[args].iter().any(|arg| arg.name.is_some())
            || self.scope.routines.contains_key(&m.names[symbol.0 as usize])
            || !self.is_free(symbol)
        {
            return None;
        }
        let (name, f) = elementary::elementary::<T>(&row.name)?;
        let wanted = if matches!(f, Elementary::Unary(_)) { 1 } else { 2 };
        (args.len() == wanted).then_some((name, f))
    }

    /// `target op value` for an array or a section of one.
    pub fn assigned_array(
        &mut self,
        id: StmtId,
        target: ExprId,
        op: AssignOp,
        value: ExprId,
    ) -> Result<(), Unfit> {
        if self.calls(value) || self.calls(target) {
            return Err(Unfit::Statement);
        }
        let start = self.here()?;
        let m = self.units[self.unit].m.clone();
        let mut kernel = KernelBuilder::new();
        let lane = match op {
            AssignOp::Set => self.evaluated(id, value, &mut kernel)?,
            AssignOp::With(op) => {
                let old = self.evaluated(id, target, &mut kernel)?;
                let right = self.lane(id, value, &mut kernel)?;
                let lane = self.operated(op, old, right, Span::UNKNOWN, &mut kernel)?;
                kernel.charges.push(m.program[value].span);
                lane
            }
        };
        let (section, ty, part) = self.section_named(id, target)?;
        let numbers = ty == Type::Farray || part.is_some();
        self.kernel(lane, numbers, KernelTarget::Section(section, part), kernel)?;
        let end = self.here()?;
        self.units[self.unit].inner.push((start, end, CodeNote::Assignment(id)));
        Ok(())
    }

    /// The initial value of an array that takes its shape.
    pub fn declared_array(
        &mut self,
        id: StmtId,
        (array, origin): (u16, u16),
        ty: Type,
        value: ExprId,
    ) -> Result<(), Unfit> {
        if self.calls(value) || !self.is_whole(value) {
            return Err(Unfit::Statement);
        }
        let mut kernel = KernelBuilder::new();
        let lane = self.evaluated(id, value, &mut kernel)?;
        let target = KernelTarget::Declared { array, origin };
        self.kernel(lane, ty == Type::Farray, target, kernel)
    }

    fn kernel(
        &mut self,
        lane: Lane<T>,
        numbers: bool,
        target: KernelTarget,
        mut kernel: KernelBuilder<T>,
    ) -> Result<(), Unfit> {
        let roots = kernel.roots(lane);
        let KernelBuilder { mut work, leaves, planes, inputs, charges } = kernel;
        if (roots.len() == 1) != numbers || work.tape.is_long() {
            return Err(Unfit::Statement);
        }
        work.tape.plan(&roots, ANY_SHAPE);
        let kernels = &mut self.units[self.unit].kernels;
        let tape = work.tape;
        kernels.push(ArrayKernel { tape, leaves, planes, inputs, roots, charges, target });
        let kernel = u16::try_from(kernels.len() - 1).map_err(|_| Unfit::Unit)?;
        self.emit(ScalarOp::Kernel { kernel }).map(drop)
    }

    /// The operand of an expression that the interpreter evaluates separately, so that its value counts as steps.
    fn evaluated(
        &mut self,
        stmt: StmtId,
        id: ExprId,
        kernel: &mut KernelBuilder<T>,
    ) -> Result<Lane<T>, Unfit> {
        let m = self.units[self.unit].m.clone();
        let (kind, span) = (m.program[id].kind, m.program[id].span);
        match kind {
            ExprKind::Paren(inner) if self.is_whole(id) => {
                let lane = self.evaluated(stmt, inner, kernel)?;
                kernel.charges.push(span);
                Ok(lane)
            }
            ExprKind::Name(_) | ExprKind::Index { .. } => self.lane(stmt, id, kernel),
            ExprKind::Member { base, .. } => match m.program[base].kind {
                ExprKind::Index { .. } => self.lane(stmt, id, kernel),
                _ if !self.is_whole(id) => self.lane(stmt, id, kernel),
                ExprKind::Name(_) => {
                    kernel.charges.push(span);
                    self.lane(stmt, id, kernel)
                }
                _ => Err(Unfit::Statement),
            },
            _ => {
                let lane = self.lane(stmt, id, kernel)?;
                if matches!(lane, Lane::Array(_)) {
                    kernel.charges.push(span);
                }
                Ok(lane)
            }
        }
    }

    /// The array, section and component that an expression names.
    fn section_named(
        &mut self,
        stmt: StmtId,
        id: ExprId,
    ) -> Result<(CodeSection, Type, Option<u8>), Unfit> {
        let m = self.units[self.unit].m.clone();
        match m.program[id].kind {
            ExprKind::Name(_) => {
                let (array, ty) = self.array_of(id)?;
                Ok((CodeSection { array, subscripts: None }, ty, None))
            }
            ExprKind::Index { base, subs } => {
                let (array, ty) = self.array_of(base)?;
                let mut all = Vec::new();
                for &sub in &m.program[subs] {
                    all.push(self.subscript(stmt, sub)?);
                }
                Ok((CodeSection { array, subscripts: Some(all.into()) }, ty, None))
            }
            ExprKind::Member { base, name, or_dot } => {
                let part = component(m.program.name(name)).ok_or(Unfit::Statement)?;
                let (section, ty, None) = self.section_named(stmt, base)? else {
                    return Err(Unfit::Statement);
                };
                if ty == Type::Farray || (or_dot && self.may_be_vector(name)) {
                    return Err(Unfit::Statement);
                }
                Ok((section, ty, Some(part as u8)))
            }
            _ => Err(Unfit::Statement),
        }
    }

    fn subscript(&mut self, stmt: StmtId, sub: Subscript) -> Result<CodeSubscript, Unfit> {
        Ok(match sub {
            Subscript::Whole => CodeSubscript::Whole,
            Subscript::At(at) => CodeSubscript::At(self.value(stmt, at, None)?),
            Subscript::Range { from, to, step } => {
                let mut all = [None; 3];
                for (register, expr) in all.iter_mut().zip([from, to, step]) {
                    if let Some(expr) = expr {
                        *register = Some(self.value(stmt, expr, None)?);
                    }
                }
                CodeSubscript::Range(all)
            }
        })
    }

    /// An operand of the tape: numbers and vectors are computed before.
    fn lane(
        &mut self,
        stmt: StmtId,
        id: ExprId,
        kernel: &mut KernelBuilder<T>,
    ) -> Result<Lane<T>, Unfit> {
        let m = self.units[self.unit].m.clone();
        let (kind, span) = (m.program[id].kind, m.program[id].span);
        if let Some(x) = self.literal(id) {
            return Ok(Lane::Literal(x));
        }
        if !self.is_whole(id) {
            return self.operand(stmt, id).map(Lane::Single);
        }
        match kind {
            ExprKind::Paren(inner) | ExprKind::Unary { op: UnaryOp::Plus, operand: inner } => {
                self.lane(stmt, inner, kernel)
            }
            ExprKind::Name(_) | ExprKind::Index { .. } => {
                let (section, ty, _) = self.section_named(stmt, id)?;
                let leaf = kernel.leaf(section);
                if matches!(kind, ExprKind::Index { .. }) {
                    kernel.charges.push(span);
                }
                Ok(Lane::Array(kernel.rows(leaf, ty, None)))
            }
            ExprKind::Member { base, name, or_dot } => match m.program[base].kind {
                ExprKind::Name(_) | ExprKind::Index { .. } => {
                    let (section, ty, part) = self.section_named(stmt, id)?;
                    let leaf = kernel.leaf(section);
                    if matches!(m.program[base].kind, ExprKind::Index { .. }) {
                        kernel.charges.extend([m.program[base].span, span]);
                    }
                    Ok(Lane::Array(kernel.rows(leaf, ty, part.map(usize::from))))
                }
                _ => {
                    let c = component(m.program.name(name)).ok_or(Unfit::Statement)?;
                    if or_dot && self.may_be_vector(name) {
                        return Err(Unfit::Statement);
                    }
                    match self.lane(stmt, base, kernel)? {
                        Lane::Array(TapeArray { shape, what: What::Vector(v) }) => {
                            let what = What::Number(v[c as usize]);
                            Ok(Lane::Array(TapeArray { shape, what }))
                        }
                        _ => Err(Unfit::Statement),
                    }
                }
            },
            ExprKind::Magnitude(inner) => match self.lane(stmt, inner, kernel)? {
                Lane::Array(lanes) => Ok(Lane::Array(kernel.work.magnitude(lanes, span))),
                _ => Err(Unfit::Statement),
            },
            ExprKind::Unary { op: UnaryOp::Minus, operand } => {
                let lane = self.lane(stmt, operand, kernel)?;
                self.negated(lane, kernel)
            }
            ExprKind::Binary { op, left, right } => {
                let a = self.lane(stmt, left, kernel)?;
                let b = self.lane(stmt, right, kernel)?;
                self.operated(op, a, b, span, kernel)
            }
            ExprKind::Chain(items) => self.lane_of_chain(stmt, items, kernel),
            ExprKind::List(items) => {
                let mut rows = Vec::new();
                for &item in &m.program[items] {
                    let lane = match crate::array::lower::is_operator(&m, item) {
                        true => self.lane(stmt, item, kernel)?,
                        false => self.evaluated(stmt, item, kernel)?,
                    };
                    let Lane::Array(TapeArray { what: What::Number(row), .. }) = lane else {
                        return Err(Unfit::Statement);
                    };
                    rows.push(row);
                }
                let what = What::Vector(rows.try_into().map_err(|_| Unfit::Statement)?);
                Ok(Lane::Array(TapeArray { shape: ANY_SHAPE, what }))
            }
            ExprKind::Call { callee, args } => {
                let (_, f) = self.elementary(callee, args).ok_or(Unfit::Statement)?;
                let mut all = Vec::new();
                for arg in &m.program[args] {
                    let lane = self.lane(stmt, arg.value, kernel)?;
                    let (_, Loosely::Number(x)) = kernel.loose(lane) else {
                        return Err(Unfit::Statement);
                    };
                    all.push(kernel.work.src(&x));
                }
                let (tape, check) = (&mut kernel.work.tape, Some(ANY_SHAPE));
                let src = match f {
                    Elementary::Unary(f) => tape.unary(f, all[0], check),
                    Elementary::Binary(f) => tape.binary(f, all[0], all[1], check),
                };
                Ok(Lane::Array(TapeArray { shape: ANY_SHAPE, what: What::Number(src) }))
            }
            _ => Err(Unfit::Statement),
        }
    }

    /// A number of the text, with its sign.
    fn literal(&self, id: ExprId) -> Option<T> {
        let m = &self.units[self.unit].m;
        match m.program[id].kind {
            ExprKind::Number(literal) => Some(T::from(m.program[literal].value)),
            ExprKind::Paren(inner) => self.literal(inner),
            ExprKind::Unary { op: UnaryOp::Minus, operand } => self.literal(operand).map(|x| -x),
            _ => None,
        }
    }

    /// The register of a number, or those of a vector.
    fn single(&mut self, lane: Lane<T>) -> Option<CodeValue> {
        match lane {
            Lane::Literal(x) => Some(CodeValue::Number(self.constant(x))),
            Lane::Single(value) => Some(value),
            Lane::Array(_) => None,
        }
    }

    fn negated(&mut self, lane: Lane<T>, kernel: &mut KernelBuilder<T>) -> Result<Lane<T>, Unfit> {
        Ok(match lane {
            Lane::Literal(x) => Lane::Literal(-x),
            Lane::Array(lanes) => Lane::Array(kernel.work.mapped(lanes, Code::Neg)),
            Lane::Single(CodeValue::Vector(a)) => {
                Lane::Single(CodeValue::Vector(self.negated_vector(a)?))
            }
            Lane::Single(CodeValue::Number(a)) => {
                let to = self.scratch();
                self.emit(ScalarOp::Negate { to, a })?;
                Lane::Single(CodeValue::Number(to))
            }
        })
    }

    fn operated(
        &mut self,
        op: BinaryOp,
        a: Lane<T>,
        b: Lane<T>,
        span: Span,
        kernel: &mut KernelBuilder<T>,
    ) -> Result<Lane<T>, Unfit> {
        if relation(op).is_some() {
            return Err(Unfit::Statement);
        }
        if let (Some(x), Some(y)) = (self.single(a), self.single(b)) {
            return self.combined(op, x, y, span).map(Lane::Single);
        }
        let (a, b) = (kernel.loose(a), kernel.loose(b));
        kernel.work.binary(op, a, b, span).map(Lane::Array).ok_or(Unfit::Statement)
    }

    fn lane_of_chain(
        &mut self,
        stmt: StmtId,
        items: NodeList<ChainItem>,
        kernel: &mut KernelBuilder<T>,
    ) -> Result<Lane<T>, Unfit> {
        let m = self.units[self.unit].m.clone();
        let mut stack: Vec<(Lane<T>, Span)> = Vec::new();
        for step in m.program.grouped(items, Grouping::Numbers) {
            let entry = match step {
                Step::Push(expr) => (self.lane(stmt, expr, kernel)?, m.program[expr].span),
                Step::Unary(op, span) => {
                    let (lane, inner) = stack.pop().ok_or(Unfit::Statement)?;
                    let lane = match op {
                        UnaryOp::Plus => lane,
                        UnaryOp::Minus => self.negated(lane, kernel)?,
                        UnaryOp::Not => return Err(Unfit::Statement),
                    };
                    (lane, span.to(inner))
                }
                Step::Binary(op, _) => {
                    let (b, of_right) = stack.pop().ok_or(Unfit::Statement)?;
                    let (a, of_left) = stack.pop().ok_or(Unfit::Statement)?;
                    let span = of_left.to(of_right);
                    (self.operated(op, a, b, span, kernel)?, span)
                }
            };
            stack.push(entry);
        }
        stack.pop().map(|(lane, _)| lane).ok_or(Unfit::Statement)
    }
}
