//! Runs a program: operators on arrays, element by element.
//!
//! The element-wise part of an expression becomes a [`Tape`] that is run once, when its value is
//! needed. Kinds and shapes are compared at each operator, so that faults come in the order of the
//! text and before any element is computed; parts without arrays are computed at once.

use crate::array::lanes::{Calls, TapeArray, What, not_finite};
use crate::functions::elementary;
use crate::run::interpreter::{Interpreter, silent};
use crate::source::module::Module;
use crate::source::scope::Binding;
use crate::value::ops;
use crate::value::variables::Called as _;
use crate::value::variables::{self, shape_text};
use moldloft_diag::{Diagnostic, Span};
use moldloft_elementwise::{Code, Src, Tape};
use moldloft_num::Real;
use moldloft_registry::{ArrayShape, Implementation, Scalar, Value};
use moldloft_syntax::sdl::{
    Arg, BinaryOp, ChainItem, ExprId, ExprKind, Grouping, NodeList, Step, Symbol, UnaryOp,
};
use smallvec::SmallVec;

/// An operand: a value, or rows of a tape.
#[derive(Clone, Debug)]
pub(crate) enum LoweredOperand<T: Real> {
    Value(Value<T>),
    Lanes(TapeArray),
}

type Operated<T> = Result<LoweredOperand<T>, Diagnostic>;

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// The value of an expression whose outermost operator is element-wise.
    pub fn arithmetic(&mut self, m: &Module, id: ExprId) -> Result<Value<T>, Diagnostic> {
        self.worked(|this, work| this.operated(m, id, work))
    }

    /// The value of `target op value`, for `+=` and its like.
    pub fn updated(
        &mut self,
        m: &Module,
        target: ExprId,
        op: BinaryOp,
        value: ExprId,
    ) -> Result<Value<T>, Diagnostic> {
        let spans = [target, value].map(|e| m.program[e].span);
        let value = self.worked(|this, work| {
            let old = this.leaf(m, target, true)?;
            let right = this.operated(m, value, work)?;
            this.combined(m, op, old, right, spans, work).map_err(|d| d.or_at(spans[1]))
        })?;
        self.charge(&value, spans[1])?;
        Ok(value)
    }

    /// The value of an expression that `tree` lowers.
    fn worked(
        &mut self,
        tree: impl Fn(&mut Self, &mut TapeBuilder<T>) -> Operated<T>,
    ) -> Result<Value<T>, Diagnostic> {
        let tape = self.arrays.tapes.pop().unwrap_or_default();
        let mut work = TapeBuilder { tape, calls: Vec::new(), ieee: self.arrays.ieee };
        let value = match tree(self, &mut work) {
            Ok(operand) => self.value_of(operand, &mut work),
            Err(diagnostic) => Err(work.earlier(diagnostic)),
        };
        work.tape.clear();
        self.arrays.tapes.push(work.tape);
        value
    }

    /// The elements of rows of a tape.
    fn computed(
        &mut self,
        lanes: &TapeArray,
        work: &mut TapeBuilder<T>,
    ) -> Result<Value<T>, Diagnostic> {
        let (roots, count) = (lanes.roots(), lanes.shape.count());
        let mut rows: SmallVec<[Vec<T>; 3]> =
            roots.iter().map(|_| self.arrays.spare.take(count)).collect();
        match work.tape.run(&roots, lanes.shape, &mut rows) {
            Ok(()) => Ok(lanes.value(rows)),
            Err(check) => {
                let (span, name) = work.calls[check];
                Err(not_finite(name).at(span))
            }
        }
    }

    /// A part of an expression other than an operator; an object is read if `read`.
    fn leaf(&mut self, m: &Module, id: ExprId, read: bool) -> Operated<T> {
        if let ExprKind::Number(literal) = m.program[id].kind {
            let x = T::from(m.program[literal].value);
            return Ok(LoweredOperand::Value(Value::Number(x)));
        }
        let value = self.expr(m, id)?;
        let value = if read { self.read(value, m.program[id].span)? } else { value };
        Ok(LoweredOperand::Value(value))
    }

    fn value_of(
        &mut self,
        operand: LoweredOperand<T>,
        work: &mut TapeBuilder<T>,
    ) -> Result<Value<T>, Diagnostic> {
        match operand {
            LoweredOperand::Value(value) => Ok(value),
            LoweredOperand::Lanes(lanes) => self.computed(&lanes, work),
        }
    }

    /// True when an expression names a variable that holds vectors.
    fn names_vectors(&self, m: &Module, id: ExprId) -> bool {
        let bound =
            m.program.as_name(id).and_then(|s| self.env.scope.lookup(m.names[s.0 as usize]));
        let what = match bound.map(|bound| &bound.what) {
            Some(Binding::Reference(place)) if place.is_whole() => {
                self.env.scope.root(place).map(|root| &root.what)
            }
            what => what,
        };
        matches!(what, Some(Binding::Variable { value: Value::Vectors(_), .. }))
    }

    /// The operand that an expression is, objects read.
    fn operated(&mut self, m: &Module, id: ExprId, work: &mut TapeBuilder<T>) -> Operated<T> {
        let expr = m.program[id];
        let inner = match expr.kind {
            ExprKind::Paren(_)
            | ExprKind::Magnitude(_)
            | ExprKind::Unary { op: UnaryOp::Minus | UnaryOp::Plus, .. }
            | ExprKind::Chain(_)
            | ExprKind::List(_) => true,
            ExprKind::Binary { op, .. } => ops::is_elementwise(op),
            ExprKind::Member { base, name, .. } => {
                // A component of an expression or of rows; components of other names are evaluated
                // as members.
                axis(m.program.name(name)).is_some()
                    && (self.names_vectors(m, base)
                        || !matches!(
                            m.program[base].kind,
                            ExprKind::Name(_) | ExprKind::Index { .. }
                        ))
            }
            ExprKind::Call { callee, args } => self.elementary(m, callee, args).is_some(),
            _ => false,
        };
        if !inner {
            return self.leaf(m, id, true);
        }
        if !self.deeper(expr.span) {
            return Err(silent());
        }
        let operand = self.operator(m, expr.kind, expr.span, work);
        self.usage.depth -= 1;
        operand.map_err(|d| d.or_at(expr.span))
    }

    fn operator(
        &mut self,
        m: &Module,
        kind: ExprKind,
        span: Span,
        work: &mut TapeBuilder<T>,
    ) -> Operated<T> {
        match kind {
            ExprKind::Paren(inner) => self.operated(m, inner, work),
            ExprKind::Magnitude(inner) => {
                let operand = self.operated(m, inner, work)?;
                let lanes = match &operand {
                    LoweredOperand::Lanes(lanes) => Some(*lanes),
                    LoweredOperand::Value(value) => work.lanes(value, !self.arrays.plain_operators),
                };
                Ok(match (lanes, operand) {
                    (None, LoweredOperand::Value(value)) => {
                        let value = ops::magnitude(&value)?;
                        if !self.arrays.ieee && !value.is_finite() {
                            return Err(not_finite("||").at(span));
                        }
                        LoweredOperand::Value(value)
                    }
                    (None, lanes) => lanes,
                    (Some(lanes), _) => LoweredOperand::Lanes(work.magnitude(lanes, span)),
                })
            }
            ExprKind::Unary { op, operand } => {
                let operand = self.operated(m, operand, work)?;
                self.signed(op, operand, work)
            }
            ExprKind::Binary { op, left, right } => {
                let a = self.operated(m, left, work)?;
                let b = self.operated(m, right, work)?;
                let spans = [left, right].map(|e| m.program[e].span);
                self.combined(m, op, a, b, spans, work)
            }
            ExprKind::Chain(items) => self.chained(m, items, work),
            ExprKind::List(items) => self.braces(m, items, work),
            ExprKind::Member { base, name, .. } => {
                let operand = self.operated(m, base, work)?;
                let c = axis(m.program.name(name)).expect("checked by the caller");
                match operand {
                    LoweredOperand::Lanes(TapeArray { shape, what: What::Vector(v) }) => {
                        Ok(LoweredOperand::Lanes(TapeArray { shape, what: What::Number(v[c]) }))
                    }
                    LoweredOperand::Value(value @ Value::Vectors(_))
                        if !self.arrays.plain_operators && !work.tape.is_long() =>
                    {
                        let Some(TapeArray { shape, what: What::Vector(v) }) =
                            work.lanes(&value, true)
                        else {
                            return Err(silent());
                        };
                        Ok(LoweredOperand::Lanes(TapeArray { shape, what: What::Number(v[c]) }))
                    }
                    other => {
                        let value = self.value_of(other, work)?;
                        match variables::component(&value, c) {
                            Some(component) => Ok(LoweredOperand::Value(component)),
                            None => {
                                let found = value.called();
                                Err(Diagnostic::error(
                                    "unknown-member",
                                    format!("{found} has no `{}`", m.program.name(name)),
                                )
                                .expected(crate::value::member::names(&value).join(", ")))
                            }
                        }
                    }
                }
            }
            ExprKind::Call { callee, args } => {
                let (name, function) = self.elementary(m, callee, args).expect("checked above");
                let args: Vec<ExprId> = m.program[args].iter().map(|a| a.value).collect();
                self.elementwise(m, name, function, &args, span, work)
            }
            _ => Err(silent()),
        }
    }

    fn signed(
        &mut self,
        op: UnaryOp,
        operand: LoweredOperand<T>,
        work: &mut TapeBuilder<T>,
    ) -> Operated<T> {
        if op == UnaryOp::Plus {
            return Ok(operand);
        }
        let lanes = match &operand {
            LoweredOperand::Lanes(lanes) => Some(*lanes),
            LoweredOperand::Value(value) => work.lanes(value, !self.arrays.plain_operators),
        };
        Ok(match (lanes, operand) {
            (Some(lanes), _) => LoweredOperand::Lanes(work.mapped(lanes, Code::Neg)),
            (None, LoweredOperand::Value(value)) => LoweredOperand::Value(ops::negated(&value)?),
            (None, lanes) => lanes,
        })
    }

    fn chained(
        &mut self,
        m: &Module,
        items: NodeList<ChainItem>,
        work: &mut TapeBuilder<T>,
    ) -> Operated<T> {
        let mut operands = Vec::new();
        let mut sets = false;
        for item in &m.program[items] {
            if let ChainItem::Operand(expr) = item {
                let operand = self.operated(m, *expr, work)?;
                sets |= matches!(&operand, LoweredOperand::Value(value) if ops::is_set(value));
                operands.push(Some((*expr, operand)));
            }
        }
        let grouping = if sets { Grouping::Sets } else { Grouping::Numbers };
        let mut stack: Vec<(LoweredOperand<T>, Span)> = Vec::new();
        let mut next = operands.iter_mut();
        for step in m.program.grouped(items, grouping) {
            let operand = match step {
                // Operands are pushed in the order of the text.
                Step::Push(expr) => {
                    let (at, operand) = next.next().and_then(Option::take).ok_or_else(silent)?;
                    debug_assert_eq!(at, expr);
                    (operand, m.program[expr].span)
                }
                Step::Unary(op, span) => {
                    let (operand, inner) = stack.pop().ok_or_else(silent)?;
                    let signed = match (op, operand) {
                        (UnaryOp::Not, operand) => {
                            let value = self.value_of(operand, work)?;
                            let value = ops::unary(op, &value).map_err(|d| d.or_at(span))?;
                            LoweredOperand::Value(value)
                        }
                        (op, operand) => {
                            self.signed(op, operand, work).map_err(|d| d.or_at(span))?
                        }
                    };
                    (signed, span.to(inner))
                }
                Step::Binary(op, span) => {
                    let (right, of_right) = stack.pop().ok_or_else(silent)?;
                    let (left, of_left) = stack.pop().ok_or_else(silent)?;
                    let value = self
                        .combined(m, op, left, right, [of_left, of_right], work)
                        .map_err(|d| d.or_at(span))?;
                    (value, of_left.to(of_right))
                }
            };
            stack.push(operand);
        }
        stack.pop().map(|(operand, _)| operand).ok_or_else(silent)
    }

    /// `{a, b, c}`: three rows of numbers make a row of vectors; else a vector or list.
    fn braces(
        &mut self,
        m: &Module,
        items: NodeList<ExprId>,
        work: &mut TapeBuilder<T>,
    ) -> Operated<T> {
        let mut values = Vec::with_capacity(items.len());
        for &item in &m.program[items] {
            // Objects stay unread in lists.
            let array = items.len() == 3 && is_operator(m, item);
            values.push(match array {
                true => self.operated(m, item, work)?,
                false => self.leaf(m, item, false)?,
            });
        }
        if values.len() == 3 && !self.arrays.plain_operators && !work.tape.is_long() {
            let lanes: Vec<TapeArray> = values
                .iter()
                .filter_map(|value| match value {
                    LoweredOperand::Lanes(lanes) => Some(*lanes),
                    LoweredOperand::Value(value) => work.lanes(value, true),
                })
                .collect();
            if let [
                TapeArray { shape, what: What::Number(x) },
                TapeArray { shape: s, what: What::Number(y) },
                TapeArray { shape: t, what: What::Number(z) },
            ] = lanes[..]
                && shape == s
                && shape == t
            {
                return Ok(LoweredOperand::Lanes(TapeArray {
                    shape,
                    what: What::Vector([x, y, z]),
                }));
            }
        }
        let mut all = Vec::with_capacity(values.len());
        for value in values {
            all.push(self.value_of(value, work)?);
        }
        let spans: Vec<Span> = m.program[items].iter().map(|&e| m.program[e].span).collect();
        ops::braces(all.clone()).map(LoweredOperand::Value).map_err(|d| {
            let shapes: Vec<String> = all.iter().map(shape_text).collect();
            let first = shapes.iter().position(|s| *s != shapes[0]).unwrap_or(0);
            self.differing(m, d, [spans[0], spans[first]], [&shapes[0], &shapes[first]])
        })
    }

    /// `a op b`.
    fn combined(
        &mut self,
        m: &Module,
        op: BinaryOp,
        a: LoweredOperand<T>,
        b: LoweredOperand<T>,
        spans: [Span; 2],
        work: &mut TapeBuilder<T>,
    ) -> Operated<T> {
        let arrays = [&a, &b].map(|o| match o {
            LoweredOperand::Lanes(_) => true,
            LoweredOperand::Value(value) => {
                matches!(value, Value::Numbers(_) | Value::Vectors(_))
            }
        });
        if !self.arrays.plain_operators && arrays.contains(&true) && !work.tape.is_long() {
            let operands = [&a, &b].map(|o| work.operand(o));
            if let [Some(x), Some(y)] = operands {
                if let (Some(s), Some(t)) = (x.0, y.0)
                    && s != t
                    && is_defined(op, x, y)
                {
                    let d = ops::shapes_differ(s, t);
                    let shapes = [described(x), described(y)];
                    return Err(self.differing(m, d, spans, [&shapes[0], &shapes[1]]));
                }
                let alike = x.0.is_none() || y.0.is_none() || x.0 == y.0;
                if alike && let Some(lanes) = work.binary(op, x, y, spans[0].to(spans[1])) {
                    return Ok(LoweredOperand::Lanes(lanes));
                }
            }
        }
        let (a, b) = (self.value_of(a, work)?, self.value_of(b, work)?);
        let value = ops::binary(op, &a, &b)
            .map_err(|d| self.differing(m, d, spans, [&shape_text(&a), &shape_text(&b)]))?;
        if !self.arrays.ieee && !value.is_finite() {
            return Err(not_finite(op.spelling()).at(spans[0].to(spans[1])));
        }
        Ok(LoweredOperand::Value(value))
    }

    /// A fault of shapes with both expressions, their shapes, and where these were declared.
    pub fn differing(
        &self,
        m: &Module,
        diagnostic: Diagnostic,
        spans: [Span; 2],
        shapes: [&str; 2],
    ) -> Diagnostic {
        if diagnostic.id != "shapes-differ" {
            return diagnostic;
        }
        let mut texts = spans.map(|span| m.program.slice(span).trim().to_string());
        for (text, side) in texts.iter_mut().zip(["the left side", "the right side"]) {
            let long = text.chars().count() > 40 || text.contains('\n') || text.is_empty();
            *text = if long { side.into() } else { format!("`{text}`") };
        }
        let mut reported = diagnostic;
        reported.message =
            format!("shapes differ: {} is {}, {} is {}", texts[0], shapes[0], texts[1], shapes[1]);
        reported = reported.labelled(spans[0], shapes[0]).note_at(spans[1], shapes[1]);
        let mut seen = Vec::new();
        for span in spans {
            if let Some((name, at, shape)) = self.origin_of_shape(m, span)
                && !seen.contains(&at)
                && !shape.is_empty()
            {
                seen.push(at);
                reported = reported.note_at(at, format!("`{name}` is declared here: {shape}"));
            }
        }
        let grid = |s: &str| s.contains(',');
        if grid(shapes[0]) != grid(shapes[1]) {
            reported = reported.help(
                "spread_i(a, n) and spread_j(a, m) repeat a row over a grid; nothing is repeated \
                 silently",
            );
        }
        reported
    }

    /// The first array named in a part of the text: its name, declaration and shape.
    fn origin_of_shape(&self, m: &Module, span: Span) -> Option<(String, Span, String)> {
        let text = m.program.slice(span);
        let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'));
        for word in words.filter(|w| !w.is_empty()) {
            let Some(symbol) = m.program.symbol(word) else { continue };
            let Some(bound) = self.env.scope.lookup(m.names[symbol.0 as usize]) else { continue };
            let value = self.peek(bound)?;
            if matches!(value, Value::Numbers(_) | Value::Vectors(_)) {
                return Some((word.to_string(), bound.span, shape_text(&value)));
            }
        }
        None
    }

    /// The function that a call names, when it is one of numbers, called with plain arguments.
    pub fn elementary(
        &self,
        m: &Module,
        callee: ExprId,
        args: NodeList<Arg>,
    ) -> Option<(&'static str, elementary::Elementary<T>)> {
        if args.len() > 2 {
            return None;
        }
        let symbol = m.program.as_name(callee)?;
        let row = m.rows[symbol.0 as usize].as_ref()?;
        if !matches!(row.body, Implementation::Native { .. }) {
            return None;
        }
        let (name, function) = elementary::elementary::<T>(&row.name)?;
        let wanted = match function {
            elementary::Elementary::Unary(_) => 1,
            elementary::Elementary::Binary(_) => 2,
        };
        let plain = args.len() == wanted && m.program[args].iter().all(|a| a.name.is_none());
        (plain && !self.hides_function(m, symbol)).then_some((name, function))
    }

    /// True when a name means something of the program's own.
    pub fn hides_function(&self, m: &Module, symbol: Symbol) -> bool {
        let name = m.names[symbol.0 as usize];
        self.env.scope.lookup(name).is_some() || self.env.scope.routines.contains_key(&name)
    }

    fn elementwise(
        &mut self,
        m: &Module,
        name: &'static str,
        function: elementary::Elementary<T>,
        args: &[ExprId],
        span: Span,
        work: &mut TapeBuilder<T>,
    ) -> Operated<T> {
        let mut operands = Vec::with_capacity(2);
        for &arg in args {
            operands.push(self.operated(m, arg, work)?);
        }
        let mut all: Vec<_> = operands.iter().map(|o| work.operand(o)).collect();
        if self.arrays.plain_operators {
            all.clear();
            all.push(None);
        }
        let number = |o: &Option<Loose<T>>| match o {
            Some((shape, Loosely::Number(src))) => Some((*shape, *src)),
            _ => None,
        };
        let numbers: Option<Vec<_>> = all.iter().map(number).collect();
        let long = work.tape.is_long();
        if let Some(numbers) = numbers.filter(|n| !long && n.iter().any(|(s, _)| s.is_some())) {
            let shapes: Vec<ArrayShape> = numbers.iter().filter_map(|(s, _)| *s).collect();
            if shapes.iter().all(|s| *s == shapes[0]) {
                let srcs: Vec<Src> = numbers.iter().map(|(_, s)| work.src(s)).collect();
                let src = match function {
                    elementary::Elementary::Unary(f) => {
                        work.tape.unary(f, srcs[0], work.checked(shapes[0]))
                    }
                    elementary::Elementary::Binary(f) => {
                        work.tape.binary(f, srcs[0], srcs[1], work.checked(shapes[0]))
                    }
                };
                work.name_checks(span, name);
                return Ok(LoweredOperand::Lanes(TapeArray {
                    shape: shapes[0],
                    what: What::Number(src),
                }));
            }
        }
        let mut values = Vec::with_capacity(2);
        for operand in operands {
            values.push(self.value_of(operand, work)?);
        }
        let spans: Vec<Span> = args.iter().map(|&a| m.program[a].span).collect();
        // Scalars, and whatever is not taken, by the row itself.
        let value = elementary::apply(name, function, &values).map_err(|fault| {
            let at = fault.field().map_or(span, |field| spans[field]);
            let d = crate::source::fault_location::unplaced(&fault);
            match &values[..] {
                [a, b] => {
                    self.differing(m, d, [spans[0], spans[1]], [&shape_text(a), &shape_text(b)])
                }
                _ => d,
            }
            .or_at(at)
        })?;
        if !self.arrays.ieee && !value.is_finite() {
            return Err(not_finite(name).at(span));
        }
        Ok(LoweredOperand::Value(value))
    }
}

fn axis(word: &str) -> Option<usize> {
    ["x", "y", "z"].iter().position(|c| *c == word)
}

/// True when the outermost part of an expression is an operator, so that it is not an object.
pub(crate) fn is_operator(m: &Module, id: ExprId) -> bool {
    match m.program[m.program.bare(id)].kind {
        ExprKind::Chain(_) | ExprKind::Magnitude(_) | ExprKind::Unary { .. } => true,
        ExprKind::Binary { op, .. } => ops::is_elementwise(op),
        ExprKind::Call { .. } => true,
        _ => false,
    }
}

/// An operand that a tape can take: its shape, if it is an array, and its numbers.
pub(crate) type Loose<T> = (Option<ArrayShape>, Loosely<T>);

#[derive(Clone, Copy)]
pub(crate) enum Loosely<T> {
    Number(TapeNumber<T>),
    Vector([TapeNumber<T>; 3]),
}

/// A number of an operand; constants enter the tape when they are used.
#[derive(Clone, Copy)]
pub(crate) enum TapeNumber<T> {
    Src(Src),
    Const(T),
}

/// The components of a vector as constants.
fn constants<T: Real>(v: moldloft_num::Vec3<T>) -> Loosely<T> {
    Loosely::Vector(v.to_array().map(TapeNumber::Const))
}

/// True when the operator takes such kinds, whatever their shapes.
fn is_defined<T>(op: BinaryOp, a: Loose<T>, b: Loose<T>) -> bool {
    let vector = |o: &Loosely<T>| matches!(o, Loosely::Vector(_));
    match (op, vector(&a.1), vector(&b.1)) {
        (BinaryOp::Mul, ..) => true,
        (BinaryOp::Add | BinaryOp::Sub, v, w) => v == w,
        (BinaryOp::Div, v, w) => v || !w,
        (BinaryOp::Caret, v, w) => !v && !w,
        (BinaryOp::Dot | BinaryOp::Cross, v, w) => v && w,
        _ => false,
    }
}

fn described<T>(operand: Loose<T>) -> String {
    match operand {
        (Some(shape), Loosely::Number(_)) => format!("farray{shape}"),
        (Some(shape @ ArrayShape::Row(_)), Loosely::Vector(_)) => format!("curve{shape}"),
        (Some(shape), Loosely::Vector(_)) => format!("surface{shape}"),
        (None, Loosely::Number(_)) => "number".into(),
        (None, Loosely::Vector(_)) => "vector".into(),
    }
}

/// A tape under construction.
pub(crate) struct TapeBuilder<T: Real> {
    pub tape: Tape<T>,
    pub calls: Calls,
    /// True to let infinite results and NaN pass.
    pub ieee: bool,
}

impl<T: Real> TapeBuilder<T> {
    /// The shape of results that must be finite.
    fn checked(&self, shape: ArrayShape) -> Option<ArrayShape> {
        Some(shape).filter(|_| !self.ieee)
    }

    /// Names the subject of the checks added last.
    fn name_checks(&mut self, span: Span, name: &'static str) {
        while self.calls.len() < self.tape.checks() {
            self.calls.push((span, name));
        }
    }

    /// The fault of a check that comes before another fault in the order of the text.
    fn earlier(&mut self, diagnostic: Diagnostic) -> Diagnostic {
        if self.calls.is_empty() {
            return diagnostic;
        }
        match self.tape.first_failure() {
            Some(check) => {
                let (span, name) = self.calls[check];
                not_finite(name).at(span)
            }
            None => diagnostic,
        }
    }

    /// An array as rows of the tape.
    fn lanes(&mut self, value: &Value<T>, wanted: bool) -> Option<TapeArray> {
        if !wanted || self.tape.is_long() {
            return None;
        }
        Some(match value {
            Value::Numbers(a) => {
                TapeArray { shape: a.shape, what: What::Number(self.tape.numbers(a)) }
            }
            Value::Vectors(a) => {
                TapeArray { shape: a.shape, what: What::Vector(self.tape.vectors(a)) }
            }
            _ => return None,
        })
    }

    fn operand(&mut self, operand: &LoweredOperand<T>) -> Option<Loose<T>> {
        let lanes = match operand {
            LoweredOperand::Lanes(lanes) => *lanes,
            LoweredOperand::Value(Value::Number(x)) => {
                return Some((None, Loosely::Number(TapeNumber::Const(*x))));
            }
            LoweredOperand::Value(Value::Vector(v)) => return Some((None, constants(*v))),
            LoweredOperand::Value(Value::Point(p)) => return Some((None, constants(p.xyz))),
            LoweredOperand::Value(value) => self.lanes(value, true)?,
        };
        Some((
            Some(lanes.shape),
            match lanes.what {
                What::Number(a) => Loosely::Number(TapeNumber::Src(a)),
                What::Vector(v) => Loosely::Vector(v.map(TapeNumber::Src)),
            },
        ))
    }

    pub fn src(&mut self, number: &TapeNumber<T>) -> Src {
        match number {
            TapeNumber::Src(src) => *src,
            TapeNumber::Const(x) => self.tape.constant(*x),
        }
    }

    pub fn mapped(&mut self, lanes: TapeArray, code: Code) -> TapeArray {
        let what = match lanes.what {
            What::Number(a) => What::Number(self.tape.op1(code, a)),
            What::Vector(v) => What::Vector(v.map(|a| self.tape.op1(code, a))),
        };
        TapeArray { what, ..lanes }
    }

    pub fn magnitude(&mut self, lanes: TapeArray, span: Span) -> TapeArray {
        let what = match lanes.what {
            What::Number(a) => What::Number(self.tape.op1(Code::Abs, a)),
            What::Vector(v) => {
                let square = self.dot(v, v, self.checked(lanes.shape));
                self.name_checks(span, "||");
                What::Number(self.tape.op1(Code::Sqrt, square))
            }
        };
        TapeArray { what, ..lanes }
    }

    fn dot(&mut self, a: [Src; 3], b: [Src; 3], checked: Option<ArrayShape>) -> Src {
        let mut product = |c: usize| self.tape.op(Code::Mul, a[c], b[c], checked);
        let (x, y, z) = (product(0), product(1), product(2));
        let xy = self.tape.op(Code::Add, x, y, checked);
        self.tape.op(Code::Add, xy, z, checked)
    }

    /// `a op b` where at least one is an array and the shapes agree; `None` where the operator is
    /// not defined.
    pub fn binary(
        &mut self,
        op: BinaryOp,
        a: Loose<T>,
        b: Loose<T>,
        span: Span,
    ) -> Option<TapeArray> {
        use Loosely::{Number, Vector};
        let shape = a.0.or(b.0)?;
        let checked = self.checked(shape);
        let apply = |this: &mut Self, x: Src, y: Src| match op {
            BinaryOp::Add => this.tape.op(Code::Add, x, y, checked),
            BinaryOp::Sub => this.tape.op(Code::Sub, x, y, checked),
            BinaryOp::Mul => this.tape.op(Code::Mul, x, y, checked),
            _ => this.tape.op(Code::Div, x, y, checked),
        };
        let what = match (op, a.1, b.1) {
            (
                BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div,
                Number(x),
                Number(y),
            ) => {
                let (x, y) = (self.src(&x), self.src(&y));
                What::Number(apply(self, x, y))
            }
            (
                BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div,
                Vector(v),
                Vector(w),
            ) => {
                let (v, w) = (v.map(|x| self.src(&x)), w.map(|x| self.src(&x)));
                What::Vector([0, 1, 2].map(|c| apply(self, v[c], w[c])))
            }
            (BinaryOp::Mul, Number(x), Vector(v)) | (BinaryOp::Mul, Vector(v), Number(x)) => {
                let (x, v) = (self.src(&x), v.map(|x| self.src(&x)));
                What::Vector(v.map(|y| apply(self, y, x)))
            }
            (BinaryOp::Div, Vector(v), Number(x)) => {
                let (x, v) = (self.src(&x), v.map(|x| self.src(&x)));
                What::Vector(v.map(|y| apply(self, y, x)))
            }
            (BinaryOp::Dot, Vector(v), Vector(w)) => {
                let (v, w) = (v.map(|x| self.src(&x)), w.map(|x| self.src(&x)));
                What::Number(self.dot(v, w, checked))
            }
            (BinaryOp::Cross, Vector(v), Vector(w)) => {
                let (v, w) = (v.map(|x| self.src(&x)), w.map(|x| self.src(&x)));
                What::Vector([0, 1, 2].map(|c| {
                    let (i, j) = ((c + 1) % 3, (c + 2) % 3);
                    let plus = self.tape.op(Code::Mul, v[i], w[j], checked);
                    let minus = self.tape.op(Code::Mul, v[j], w[i], checked);
                    self.tape.op(Code::Sub, plus, minus, checked)
                }))
            }
            (BinaryOp::Caret, Number(x), Number(y)) => {
                let whole = match y {
                    TapeNumber::Const(k) => ops::whole_power(k),
                    TapeNumber::Src(_) => None,
                };
                let x = self.src(&x);
                What::Number(match whole {
                    Some(k) => self.tape.powi(x, k, checked),
                    None => {
                        let y = self.src(&y);
                        self.tape.binary(ops::power, x, y, checked)
                    }
                })
            }
            _ => return None,
        };
        self.name_checks(span, op.spelling());
        Some(TapeArray { shape, what })
    }
}
