//! Runs a program: loops.

use crate::run::interpreter::{Flow, Interpreter};
use crate::source::module::Module;
use crate::source::scope::{Binding, LoopIteration, Passed};
use crate::value::variables;
use moldloft_diag::{Diagnostic, Span};
use moldloft_registry::{Scalar, Value};
use moldloft_syntax::sdl::{ExprId, Ident, StmtId, StmtKind, Type};

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// A turn of a loop.
    pub fn turn(&mut self, m: &Module, label: Option<f64>, body: StmtId, span: Span) -> Flow<T> {
        if self.step(span) {
            return Flow::Stop;
        }
        self.turns += 1;
        let id = self.turns;
        self.env.scope.frame_mut().loops.push(LoopIteration { label, id });
        let flow = self.statement(m, body);
        self.env.scope.frame_mut().loops.pop();
        flow
    }

    /// `for (i = a:b:c)`: both ends included.
    pub fn for_range(
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
            return Err(Diagnostic::error("endless-loop", "this loop cannot end")
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
            let what = Binding::variable(Type::Float, Value::Number(value));
            self.env.scope.bind(name, variable.span, what);
            match self.turn(m, Some(value.re()), body, span) {
                Flow::Break => break,
                Flow::Next | Flow::Continue => {}
                other => return Ok(other),
            }
            k += 1.0;
        }
        Ok(Flow::Next)
    }

    /// `for (start; condition; step)` and `while`.
    pub fn for_classic(
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
                match &self.env.scope.lookup(m.names[symbol.0 as usize])?.what {
                    Binding::Variable { value: Value::Number(x), .. } => Some(x.re()),
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

    /// `foreach (x in list)`.
    pub fn foreach(
        &mut self,
        m: &Module,
        variable: Ident,
        list: ExprId,
        body: StmtId,
        span: Span,
    ) -> Result<Flow<T>, Diagnostic> {
        if let Some(symbol) = m.program.as_name(list)
            && let Some(bound) = self.env.scope.lookup(m.names[symbol.0 as usize])
            && let Binding::Multiple(multiple) = &bound.what
        {
            let (items, ty) = (multiple.items.clone(), multiple.ty);
            return self.foreach_passed(m, variable, items, ty, body, span);
        }
        let value = self.expr(m, list)?;
        let value = self.opened(value);
        let value = match value {
            Value::Object(_) => self.read(value, m.program[list].span)?,
            other => other,
        };
        let items: Vec<Value<T>> = match &value {
            Value::List(items) | Value::Block(items) => items.to_vec(),
            Value::Numbers(a) => a.items.iter().map(|&x| Value::Number(x)).collect(),
            Value::Vectors(a) => a.iter().map(Value::Vector).collect(),
            // Three numbers in braces.
            Value::Vector(v) => v.to_array().map(Value::Number).to_vec(),
            other => {
                return Err(Diagnostic::error("not-a-list", "foreach walks through a list")
                    .at(m.program[list].span)
                    .expected("a list, an farray or a curve")
                    .found(variables::a(other)));
            }
        };
        let name = m.names[variable.symbol.0 as usize];
        for (k, item) in items.into_iter().enumerate() {
            let what = match item {
                Value::Object(key) => Binding::Object(key),
                value => Binding::variable(variables::type_of(&value), value),
            };
            self.env.scope.bind(name, variable.span, what);
            match self.turn(m, Some((k + 1) as f64), body, span) {
                Flow::Break => break,
                Flow::Next | Flow::Continue => {}
                other => return Ok(other),
            }
        }
        Ok(Flow::Next)
    }

    /// Loop over a multiple argument: the variable is an alias of each argument.
    fn foreach_passed(
        &mut self,
        m: &Module,
        variable: Ident,
        items: Vec<Passed<T>>,
        ty: Type,
        body: StmtId,
        span: Span,
    ) -> Result<Flow<T>, Diagnostic> {
        let name = m.names[variable.symbol.0 as usize];
        for (k, item) in items.into_iter().enumerate() {
            let what = match item {
                Passed::Place(place) => Binding::Reference(place),
                Passed::Value(Value::Object(key)) => Binding::Object(key),
                Passed::Value(value) => Binding::variable(ty, value),
            };
            self.env.scope.bind(name, variable.span, what);
            match self.turn(m, Some((k + 1) as f64), body, span) {
                Flow::Break => break,
                Flow::Next | Flow::Continue => {}
                other => return Ok(other),
            }
        }
        Ok(Flow::Next)
    }
}
