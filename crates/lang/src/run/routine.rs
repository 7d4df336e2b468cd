//! Runs a program: calls of subroutines and functions.

use crate::run::interpreter::{Flow, Interpreter, silent};
use crate::source::module::{Module, RoutineAt};
use crate::source::scope::{Binding, CallFrame, Multiple, Passed, ScopedBinding};
use crate::value::subarray::Place;
use crate::value::variables;
use moldloft_diag::{Diagnostic, Span};
use moldloft_registry::{Scalar, Value, argument_count};
use moldloft_syntax::sdl::{Arg, ExprId, Formal, ItemType, NodeList, Type};
use std::sync::Arc;

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// Calls a routine; `instance` is the prefix of the objects that it declares.
    pub fn call_routine(
        &mut self,
        m: &Module,
        at: RoutineAt,
        args: NodeList<Arg>,
        instance: Option<Arc<str>>,
        span: Span,
    ) -> Result<Option<Value<T>>, Diagnostic> {
        let callee = self.modules.get(at.module).clone();
        let routine = callee.program[at.routine];
        let name = callee.program.name(routine.name.symbol).to_string();
        let formals: Vec<Formal> = callee.program[routine.formals].to_vec();
        let given: Vec<Arg> = m.program[args].to_vec();
        let ordered = self.order_arguments(m, &callee, &name, &formals, &given, span)?;

        let prefix = instance.clone().unwrap_or_else(|| self.env.scope.frame().prefix.clone());
        let mut frame = CallFrame::new(false, prefix);
        if instance.is_none() {
            frame.loops = self.env.scope.frame().loops.clone();
        }
        frame.called = Some((span, self.current as u32));
        let mut returned: Vec<(Place, Span)> = Vec::new();
        let mut left_out: Vec<(&Formal, ExprId)> = Vec::new();
        for (formal, exprs) in formals.iter().zip(ordered) {
            if let (true, Some(default)) = (exprs.is_empty(), formal.default) {
                left_out.push((formal, default));
                continue;
            }
            let local = callee.names[formal.name.symbol.0 as usize];
            let what = if formal.multiple {
                let mut items = Vec::new();
                for expr in exprs {
                    if let Some(all) = self.multiple(m, expr) {
                        // A multiple argument is passed on as a whole.
                        for item in all {
                            if let (true, Passed::Place(place)) = (formal.returned, &item) {
                                returned.push((*place, m.program[expr].span));
                            }
                            items.push(item);
                        }
                    } else if formal.returned {
                        let place = self.returned(m, (&callee, &name), formal, expr)?;
                        returned.push((place, m.program[expr].span));
                        items.push(Passed::Place(place));
                    } else {
                        items.push(Passed::Value(self.argument(m, &callee, formal, expr)?));
                    }
                }
                Binding::Multiple(Box::new(Multiple { ty: formal.ty.0, items, read: 0 }))
            } else if formal.returned {
                let place = self.returned(m, (&callee, &name), formal, exprs[0])?;
                returned.push((place, m.program[exprs[0]].span));
                Binding::Reference(place)
            } else {
                self.passed_by_value(m, &callee, formal, exprs[0])?
            };
            frame.locals.push((local, ScopedBinding { span: formal.name.span, what }));
        }
        for (k, (place, at)) in returned.iter().enumerate() {
            if let Some((_, first)) = returned[..k].iter().find(|(p, _)| p.meets(place)) {
                let text = m.program.slice(*at).trim();
                return Err(Diagnostic::error(
                    "overlapping-arguments",
                    format!("`{text}` overlaps another returned argument of {name}"),
                )
                .labelled(*at, "these elements are written twice")
                .note_at(*first, "and here")
                .expected("returned arguments without common elements")
                .help("pass different sections, or a copy of one and assign it afterwards"));
            }
        }
        // A call takes about as long as five statements on numbers.
        self.usage.steps += 4;
        self.env.scope.frames.push(frame);
        let outer = std::mem::replace(&mut self.current, at.module);
        // In the callee's own scope, where the arguments before them are known.
        for (formal, default) in left_out {
            match self.passed_by_value(&callee, &callee, formal, default) {
                Ok(what) => {
                    let local = callee.names[formal.name.symbol.0 as usize];
                    self.env.scope.bind(local, formal.name.span, what);
                }
                Err(diagnostic) => {
                    self.current = outer;
                    self.env.scope.frames.pop();
                    return Err(diagnostic);
                }
            }
        }
        let flow = self.deeper_call(span, |this| match this.body_by_code(&callee, at.routine) {
            Some(flow) => flow,
            None => this.statements(&callee, routine.body),
        });
        self.current = outer;
        self.env.scope.frames.pop();
        let flow = flow.ok_or_else(silent)?;
        if callee.library && std::mem::take(&mut self.abandoned) {
            // Reported already; a caller in the library is left as well.
            self.abandoned = m.library;
            return Err(silent());
        }
        match flow {
            Flow::Return(Some(value)) => match routine.result {
                Some((ty, asked)) => {
                    let value = match self.record_checked(&callee, ty, value) {
                        Ok(value) if matches!(ty, Type::Other(_)) => Ok(value),
                        Ok(value) => variables::converted(self.variable_type(&callee, ty), value),
                        Err(d) => Err(d),
                    };
                    value.map(Some).map_err(|d| {
                        let message = format!("{name} returns another value: {}", d.message);
                        let mut d = d.or_at(span).note_at(asked, "declared here");
                        d.message = message;
                        d
                    })
                }
                None => Ok(Some(value)),
            },
            Flow::Return(None) => Ok(None),
            Flow::Stop => Err(silent()),
            _ => Ok(None),
        }
    }

    /// The arguments behind a name, if it is a multiple argument.
    pub fn multiple(&self, m: &Module, expr: ExprId) -> Option<Vec<Passed<T>>> {
        let symbol = m.program.as_name(expr)?;
        match &self.env.scope.lookup(m.names[symbol.0 as usize])?.what {
            Binding::Multiple(multiple) => Some(multiple.items.clone()),
            _ => None,
        }
    }

    /// The place to which a returned argument is written.
    fn returned(
        &mut self,
        m: &Module,
        (callee, name): (&Module, &str),
        formal: &Formal,
        expr: ExprId,
    ) -> Result<Place, Diagnostic> {
        let span = m.program[expr].span;
        let text = m.program.slice(span).trim().to_string();
        let place = self.place(m, expr).map_err(|d| match &*d.id {
            "not-assignable" => Diagnostic::error(
                "not-assignable",
                format!("`{text}` cannot be returned to: {name} writes to this argument"),
            )
            .at(span)
            .expected("a variable, or a part of one by [...] or .x .y .z")
            .found("an expression")
            .note_at(formal.name.span, "declared as returned here"),
            _ => d,
        })?;
        let Some(bound) = self.env.scope.root(&place) else { return Err(silent()) };
        let (ty, value) = match &bound.what {
            Binding::Variable { ty, value, .. } => (*ty, value),
            Binding::Poisoned => return Err(silent()),
            _ => {
                return Err(Diagnostic::error(
                    "not-assignable",
                    format!("`{text}` cannot be assigned to, but {name} writes to this argument"),
                )
                .at(span)
                .expected("a variable")
                .found("an object or parameter")
                .note_at(formal.name.span, "declared as returned here"));
            }
        };
        let found = variables::type_at(ty, value, &place);
        let asked = self.variable_type(callee, formal.ty.0);
        let number = |ty: Type| match ty {
            Type::Int | Type::File => Type::Float,
            Type::List(ItemType::String) => Type::String,
            other => other,
        };
        let same = number(found) == number(asked) || matches!(asked, Type::Other(_));
        if same {
            return Ok(place);
        }
        let (expected, found) = (variables::described(asked), variables::described(found));
        Err(Diagnostic::error("wrong-type", format!("expected {expected}, found {found}"))
            .at(span)
            .expected(expected)
            .found(found)
            .note_at(formal.ty.1, "requested here")
            .note_at(bound.span, "declared here"))
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
                        format!("{name} takes {}", argument_count(formals.len())),
                    )
                    .at(m.program[arg.value].span)
                    .expected(&signature)
                    .found(argument_count(given.len())));
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
            if ordered[k].is_empty() && !formal.multiple && formal.default.is_none() {
                return Err(Diagnostic::error(
                    "missing-argument",
                    format!("{name} needs `{}`", spelled[k]),
                )
                .at(span)
                .expected(&signature)
                .found(argument_count(given.len()))
                .note_at(formal.name.span, "declared here"));
            }
        }
        Ok(ordered)
    }

    /// The routine or function that an argument names.
    fn routine_argument(
        &self,
        m: &Module,
        formal: &Formal,
        expr: ExprId,
    ) -> Result<Binding<T>, Diagnostic> {
        let at = m.program.bare(expr);
        if let Some(symbol) = m.program.as_name(at) {
            let name = m.names[symbol.0 as usize];
            match self.env.scope.lookup(name).map(|bound| &bound.what) {
                Some(passed @ (Binding::Routine(_) | Binding::Function(_))) => {
                    return Ok(passed.clone());
                }
                Some(_) => {}
                None => {
                    if let Some(&routine) = self.env.scope.routines.get(&name) {
                        return Ok(Binding::Routine(routine));
                    }
                    if let Some(row) = m.rows[symbol.0 as usize].as_ref().filter(|row| !row.kind) {
                        return Ok(Binding::Function(row.clone()));
                    }
                }
            }
        }
        let expected = variables::described(Type::Routine);
        let found = m.program.slice(m.program[expr].span).trim();
        Err(Diagnostic::error("wrong-type", format!("expected {expected}, found `{found}`"))
            .at(m.program[expr].span)
            .expected(expected)
            .note_at(formal.ty.1, "requested here"))
    }

    /// Binding of an argument that is passed by value.
    fn passed_by_value(
        &mut self,
        m: &Module,
        callee: &Module,
        formal: &Formal,
        expr: ExprId,
    ) -> Result<Binding<T>, Diagnostic> {
        if formal.ty.0 == Type::Routine {
            return self.routine_argument(m, formal, expr);
        }
        Ok(match self.argument(m, callee, formal, expr)? {
            Value::Object(key) => Binding::Object(key),
            value => Binding::variable(self.variable_type(callee, formal.ty.0), value),
        })
    }

    /// The value of an argument of a routine, of the formal's type. An argument of an object class
    /// (`AbsPoint p`, or any other word) takes an object as it is.
    fn argument(
        &mut self,
        m: &Module,
        callee: &Module,
        formal: &Formal,
        expr: ExprId,
    ) -> Result<Value<T>, Diagnostic> {
        let span = m.program[expr].span;
        let value = match formal.ty.0 {
            Type::List(_) => self.list_operand(m, expr)?,
            _ => self.expr(m, expr)?,
        };
        let shape = matches!(formal.ty.0, Type::Pcurve | Type::Psurface | Type::Other(_));
        if shape && matches!(value, Value::Object(_)) {
            return Ok(value);
        }
        let value = self.read(value, span)?;
        let ty = self.variable_type(callee, formal.ty.0);
        self.record_checked(callee, formal.ty.0, value)
            .and_then(|value| variables::converted(ty, value))
            .map_err(|d| d.or_at(span).note_at(formal.ty.1, "requested here"))
    }
}
