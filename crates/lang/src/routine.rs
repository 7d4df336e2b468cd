//! Runs a program: calls of subroutines and functions.

use crate::env::{Binding, Bound, Frame};
use crate::interpreter::{Flow, Interpreter, silent};
use crate::module::{Module, RoutineAt};
use crate::variables;
use moldloft_diag::{Diagnostic, Span};
use moldloft_registry::{Scalar, Value};
use moldloft_syntax::sdl::{Arg, ExprId, Formal, List, Type};
use std::sync::Arc;

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// Calls a routine; `instance` goes before the names of the objects that it declares.
    pub fn call_routine(
        &mut self,
        m: &Module,
        at: RoutineAt,
        args: List<Arg>,
        instance: Option<Arc<str>>,
        span: Span,
    ) -> Result<Option<Value<T>>, Diagnostic> {
        let callee = self.modules.get(at.module).clone();
        let routine = callee.program[at.routine];
        let name = callee.program.name(routine.name.symbol).to_string();
        let formals: Vec<Formal> = callee.program[routine.formals].to_vec();
        let given: Vec<Arg> = m.program[args].to_vec();
        let ordered = self.order_arguments(m, &callee, &name, &formals, &given, span)?;

        let prefix = instance.clone().unwrap_or_else(|| self.frame().prefix.clone());
        let mut frame = Frame::new(false, prefix);
        if instance.is_none() {
            frame.loops = self.frame().loops.clone();
        }
        let mut returns = Vec::new();
        for (formal, exprs) in formals.iter().zip(ordered) {
            let local = callee.names[formal.name.symbol.0 as usize];
            let what = if formal.multiple {
                let mut items = Vec::new();
                for expr in exprs {
                    items.push(self.argument(m, formal, expr)?);
                }
                Binding::Variable { ty: formal.ty.0, value: Value::list(items), fixed: false }
            } else {
                let expr = exprs[0];
                if formal.returned {
                    returns.push((local, self.place(m, expr)?, m.program[expr].span));
                }
                match self.argument(m, formal, expr)? {
                    Value::Object(key) => Binding::Object(key),
                    value => {
                        // A returned argument keeps the shape of what is passed.
                        Binding::Variable { ty: formal.ty.0, value, fixed: formal.returned }
                    }
                }
            };
            frame.locals.push((local, Bound { span: formal.name.span, what }));
        }
        if !self.deeper(span) {
            return Err(silent());
        }
        let held = self.held;
        self.frames.push(frame);
        let outer = std::mem::replace(&mut self.current, at.module);
        let flow = self.statements(&callee, routine.body);
        self.current = outer;
        let frame = self.frames.pop().expect("pushed above");
        self.depth -= 1;
        self.held = held;
        for (local, place, span) in returns {
            let bound = frame.locals.iter().find(|(n, _)| *n == local).map(|(_, b)| b);
            if let Some(Bound { what: Binding::Variable { value, .. }, .. }) = bound {
                self.store(place, value.clone()).map_err(|d| d.or_at(span))?;
            }
        }
        match flow {
            Flow::Return(value) => Ok(value),
            Flow::Stop => Err(silent()),
            _ => Ok(None),
        }
    }

    /// The expressions for each formal argument, in order.
    fn order_arguments(
        &self,
        m: &Module,
        callee: &Module,
        name: &str,
        formals: &[Formal],
        given: &[Arg],
        span: Span,
    ) -> Result<Vec<Vec<ExprId>>, Diagnostic> {
        let spelled: Vec<&str> =
            formals.iter().map(|f| callee.program.name(f.name.symbol)).collect();
        let signature = format!("{name}({})", spelled.join(", "));
        let mut ordered: Vec<Vec<ExprId>> = vec![Vec::new(); formals.len()];
        for (k, arg) in given.iter().enumerate() {
            let at = match arg.name {
                Some(ident) => {
                    let word = m.program.name(ident.symbol);
                    spelled.iter().position(|s| *s == word).ok_or_else(|| {
                        Diagnostic::error(
                            "unknown-argument",
                            format!("{name} has no argument `{word}`"),
                        )
                        .at(ident.span)
                        .expected(&signature)
                        .suggest(word, spelled.iter().copied())
                    })?
                }
                None if k < formals.len() => k,
                None if formals.last().is_some_and(|f| f.multiple) => formals.len() - 1,
                None => {
                    return Err(Diagnostic::error(
                        "too-many-arguments",
                        format!("{name} takes {} arguments", formals.len()),
                    )
                    .at(m.program[arg.value].span)
                    .expected(&signature)
                    .found(format!("{} arguments", given.len())));
                }
            };
            if !ordered[at].is_empty() && !formals[at].multiple {
                return Err(Diagnostic::error(
                    "argument-twice",
                    format!("`{}` of {name} is given twice", spelled[at]),
                )
                .at(m.program[arg.value].span));
            }
            ordered[at].push(arg.value);
        }
        for (k, formal) in formals.iter().enumerate() {
            if ordered[k].is_empty() && !formal.multiple {
                return Err(Diagnostic::error(
                    "missing-argument",
                    format!("{name} needs `{}`", spelled[k]),
                )
                .at(span)
                .expected(&signature)
                .found(format!("{} arguments", given.len()))
                .note_at(formal.name.span, "declared here"));
            }
        }
        Ok(ordered)
    }

    /// The value of an argument of a routine, of the formal's type. An argument of an object class
    /// (`AbsPoint p`, or any other word) takes an object as it is.
    fn argument(
        &mut self,
        m: &Module,
        formal: &Formal,
        expr: ExprId,
    ) -> Result<Value<T>, Diagnostic> {
        let span = m.program[expr].span;
        let value = self.expr(m, expr)?;
        let shape = matches!(formal.ty.0, Type::Pcurve | Type::Psurface | Type::Other(_));
        if shape && matches!(value, Value::Object(_)) {
            return Ok(value);
        }
        let value = self.read(value, span)?;
        if formal.returned && matches!(value, Value::Unset) {
            return Ok(value);
        }
        variables::converted(formal.ty.0, value)
            .map_err(|d| d.or_at(span).note_at(formal.ty.1, "asked for here"))
    }
}
