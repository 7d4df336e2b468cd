//! Runs a program: expressions.

use crate::functions::builtins;
use crate::run::interpreter::{Interpreter, silent};
use crate::source::env::SolveUnknown;
use crate::source::fault_location;
use crate::source::module::{Module, RoutineAt};
use crate::source::scope::{Binding, Passed, ScopedBinding};
use crate::value::ops;
use crate::value::variables;
use crate::value::variables::Called as _;
use moldloft_budget::Spent;
use moldloft_diag::{Diagnostic, Span};
use moldloft_model::{Failure, number_count};
use moldloft_num::{Order, Vec3};
use moldloft_registry::{
    Array, ArrayShape, Class, CurveRef, Given, Implementation, Role, Row, Scalar, SurfaceRef,
    Value, Vectors, argument_count, bind_arguments, many,
};
use moldloft_syntax::number;
use moldloft_syntax::sdl::{
    Arg, BinaryOp, ExprId, ExprKind, NodeList, Subscript, Symbol, UnaryOp, foreign_word,
};
use std::sync::Arc;

/// Bytes of the arguments of a function up to which memory is not looked at.
const SMALL_ARGUMENTS: usize = 1 << 20;

type Evaluated<T> = Result<Value<T>, Diagnostic>;

/// Arithmetic on numbers that nests no deeper than this is computed at once.
const SHALLOW: u32 = 4;

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// The value of an expression; an object comes as [`Value::Object`], unread.
    pub fn expr(&mut self, m: &Module, id: ExprId) -> Evaluated<T> {
        let expr = m.program[id];
        match expr.kind {
            ExprKind::Number(literal) => Ok(Value::Number(T::from(m.program[literal].value))),
            ExprKind::Name(symbol) => self.name(m, symbol, expr.span),
            _ => {
                if !self.deeper(expr.span) {
                    return Err(silent());
                }
                let value = self.compound(m, id, expr.kind, expr.span);
                self.usage.depth -= 1;
                let value = value.map_err(|d| d.or_at(expr.span))?;
                self.charge(&value, expr.span)?;
                Ok(value)
            }
        }
    }

    fn compound(&mut self, m: &Module, id: ExprId, kind: ExprKind, span: Span) -> Evaluated<T> {
        match kind {
            ExprKind::Number(_) | ExprKind::Name(_) => self.expr(m, id),
            ExprKind::Text(text) => Ok(Value::text(&m.program[text])),
            ExprKind::Paren(inner) => self.expr(m, inner),
            ExprKind::List(_)
            | ExprKind::Magnitude(_)
            | ExprKind::Chain(_)
            | ExprKind::Unary { op: UnaryOp::Minus | UnaryOp::Plus, .. } => self.arithmetic(m, id),
            ExprKind::Unary { op, operand } => {
                let value = self.operand(m, operand)?;
                ops::unary(op, &value)
            }
            ExprKind::Binary { op: op @ (BinaryOp::And | BinaryOp::Or), left, right } => {
                let first = self.operand(m, left)?;
                // Numbers decide at once, but do not change the kind of the value: a mask stays a
                // mask.
                if let Value::Number(x) = first
                    && !self.gives_array(m, right)
                {
                    let first = x.re() != 0.0;
                    if first == (op == BinaryOp::Or) {
                        return Ok(Value::Number(T::from(f64::from(u8::from(first)))));
                    }
                }
                // Masks are combined element by element.
                let second = self.operand(m, right)?;
                if [&first, &second].iter().any(|value| ops::is_array(value)) {
                    return ops::logical(op, &first, &second).map_err(|d| d.or_at(span));
                }
                let truth = |value: &Value<T>, id: ExprId| match value {
                    Value::Number(x) => Ok(x.re() != 0.0),
                    other => Err(Diagnostic::error("wrong-type", "expected a number")
                        .at(m.program[id].span)
                        .expected("a number")
                        .found(other.called())),
                };
                let (first, second) = (truth(&first, left)?, truth(&second, right)?);
                let holds = if op == BinaryOp::And { first && second } else { first || second };
                Ok(Value::Number(T::from(f64::from(u8::from(holds)))))
            }
            ExprKind::Binary { op, .. } if ops::is_elementwise(op) => {
                match self.scalar(m, id, SHALLOW) {
                    Some(x) => Ok(Value::Number(x)),
                    None => self.arithmetic(m, id),
                }
            }
            ExprKind::Binary { op, left, right } => {
                let (a, b) = (self.operand(m, left)?, self.operand(m, right)?);
                ops::binary(op, &a, &b)
            }
            ExprKind::Index { base, subs } => self.index(m, id, base, subs),
            ExprKind::Member { base, name, or_dot } => self.member(m, id, base, name, or_dot),
            ExprKind::Call { callee, args } if self.elementary(m, callee, args).is_some() => {
                self.arithmetic(m, id)
            }
            ExprKind::Call { callee, args } => self.call(m, callee, args, span),
            ExprKind::Error => Err(silent()),
        }
    }

    /// The value of arithmetic on numbers alone, to a maximum depth: literals, variables and
    /// parameters, which have no side effects and cannot fail.
    fn scalar(&self, m: &Module, id: ExprId, levels: u32) -> Option<T> {
        match m.program[id].kind {
            ExprKind::Number(literal) => Some(T::from(m.program[literal].value)),
            ExprKind::Name(symbol) => {
                let name = m.names[symbol.0 as usize];
                match self.env.scope.lookup(name)?.what {
                    Binding::Variable { value: Value::Number(x), .. } => Some(x),
                    Binding::Param(number) => Some(self.env.param_values[number]),
                    _ => None,
                }
            }
            ExprKind::Binary { op, left, right } => {
                let levels = levels.checked_sub(1).filter(|_| ops::is_elementwise(op))?;
                let (a, b) = (self.scalar(m, left, levels)?, self.scalar(m, right, levels)?);
                // Values that are not finite are judged where they can be reported.
                ops::of_numbers(op, a, b).filter(|x| x.is_finite())
            }
            _ => None,
        }
    }

    /// The value of an expression, objects read.
    pub fn operand(&mut self, m: &Module, id: ExprId) -> Evaluated<T> {
        let value = self.expr(m, id)?;
        self.read(value, m.program[id].span)
    }

    pub fn number(&mut self, m: &Module, id: ExprId) -> Result<T, Diagnostic> {
        match self.operand(m, id)? {
            Value::Number(x) => Ok(x),
            other => Err(Diagnostic::error("wrong-type", "expected a number")
                .at(m.program[id].span)
                .expected("a number")
                .found(other.called())),
        }
    }

    /// The value with every object in it replaced by its own value, evaluated now.
    pub fn read(&mut self, value: Value<T>, span: Span) -> Evaluated<T> {
        match value {
            Value::Object(key) => self.forced(key).map_err(|failure| {
                let root = match failure {
                    Failure::Blocked { by } => by,
                    Failure::CallError(_) => key,
                };
                // The first reader of a failed object is reported; the others would say the same.
                if !self.blocked.insert(root) {
                    return silent();
                }
                let object = self.run.graph().get(key);
                let name = object.map_or("", |o| &*o.name);
                let cause = self.run.graph().get(root).map_or("", |o| &*o.name);
                Diagnostic::error("blocked", format!("`{name}` has no value"))
                    .at(span)
                    .found(format!("blocked by `{cause}`, which failed"))
            }),
            Value::List(items)
                if items.iter().any(|v| matches!(v, Value::Object(_) | Value::List(_))) =>
            {
                self.charge(&Value::List(items.clone()), span)?;
                let mut read = Vec::with_capacity(items.len());
                for item in items.iter() {
                    read.push(self.read(item.clone(), span)?);
                }
                Ok(Value::list(read))
            }
            other => Ok(other),
        }
    }

    fn name(&mut self, m: &Module, symbol: Symbol, span: Span) -> Evaluated<T> {
        let name = m.names[symbol.0 as usize];
        let Some(bound) = self.env.scope.lookup(name) else {
            if let Some(x) = crate::functions::files::predeclared(m.program.name(symbol)) {
                return Ok(Value::Number(T::from(x)));
            }
            return Err(self.unknown_name(m, symbol, span));
        };
        match &bound.what {
            Binding::Object(key) => Ok(Value::Object(*key)),
            Binding::Variable { value: Value::Unset, .. } => {
                let text = m.program.name(symbol);
                Err(Diagnostic::error("no-value", format!("`{text}` has no value yet"))
                    .at(span)
                    .note_at(bound.span, "declared here"))
            }
            Binding::Variable { value, .. } => Ok(value.clone()),
            Binding::Reference(place) => {
                let text = m.program.name(symbol);
                let root = self.env.scope.root(place);
                let Some(Binding::Variable { value, .. }) = root.map(|b| &b.what) else {
                    return Err(silent());
                };
                if matches!(value, Value::Unset) {
                    return Err(Diagnostic::error(
                        "no-value",
                        format!("`{text}` has no value yet"),
                    )
                    .at(span)
                    .note_at(bound.span, "passed by reference here"));
                }
                variables::at_place(value, place).map_err(|d| d.or_at(span))
            }
            Binding::Multiple(multiple) => {
                let mut values = Vec::with_capacity(multiple.items.len());
                for item in &multiple.items {
                    values.push(self.passed(item)?);
                }
                Ok(Value::list(values))
            }
            Binding::Param(number) => Ok(Value::Number(self.env.param_values[*number])),
            Binding::Turn { now, turn, family } => {
                let frame = self.env.scope.frame();
                if frame.loops.iter().any(|t| t.id == *turn) {
                    return Ok(Value::Object(*now));
                }
                Ok(self.family(family))
            }
            Binding::Instance(family) => {
                let family = family.clone();
                Err(Diagnostic::error("not-a-value", format!("`{family}` is a group of objects"))
                    .at(span)
                    .help(format!("name one of its objects, as in {family}.name")))
            }
            Binding::Routine(_) | Binding::Function(_) => {
                let text = m.program.name(symbol);
                Err(Diagnostic::error("not-a-value", format!("`{text}` is a routine"))
                    .at(span)
                    .help(format!("call it: {text}(...)")))
            }
            Binding::Poisoned => Err(silent()),
        }
    }

    /// The value of one of the arguments of a multiple argument.
    pub fn passed(&self, item: &Passed<T>) -> Evaluated<T> {
        match item {
            Passed::Value(value) => Ok(value.clone()),
            Passed::Place(place) => match self.env.scope.root(place).map(|b| &b.what) {
                Some(Binding::Variable { value, .. }) => variables::at_place(value, place),
                _ => Err(silent()),
            },
        }
    }

    fn family(&self, family: &str) -> Value<T> {
        let keys = self.env.families.get(family);
        Value::list(keys.into_iter().flatten().map(|&key| Value::Object(key)))
    }

    pub fn unknown_name(&self, m: &Module, symbol: Symbol, span: Span) -> Diagnostic {
        let text = m.program.name(symbol);
        let diagnostic =
            Diagnostic::error("unknown-name", format!("unknown name `{text}`")).at(span);
        if !self.components.is_empty() {
            return diagnostic.help(format!(
                "a component sees only its arguments: Component name(\"file\", {text} = ...)"
            ));
        }
        if !self.hints() {
            return diagnostic;
        }
        match crate::run::forward_reference::declared_later(m, symbol, span) {
            Some(later) => later.explain(m, diagnostic),
            None => diagnostic.maybe_help(self.meant(text)),
        }
    }

    /// The full object name that an expression such as `fore[2].leg[3]` spells, if it begins with
    /// the name of a family.
    pub fn spelled(&mut self, m: &Module, id: ExprId) -> Result<Option<String>, Diagnostic> {
        Ok(match m.program[id].kind {
            ExprKind::Paren(inner) => self.spelled(m, inner)?,
            ExprKind::Name(symbol) => match self.env.scope.lookup(m.names[symbol.0 as usize]) {
                Some(bound) => match &bound.what {
                    Binding::Turn { family, .. } | Binding::Instance(family) => {
                        Some(family.to_string())
                    }
                    _ => None,
                },
                None => None,
            },
            ExprKind::Member { base, name, .. } => {
                self.spelled(m, base)?.map(|base| format!("{base}.{}", m.program.name(name)))
            }
            ExprKind::Index { base, subs } => {
                let Some(base) = self.spelled(m, base)? else { return Ok(None) };
                let mut labels = Vec::new();
                for sub in &m.program[subs] {
                    let Subscript::At(expr) = *sub else { return Ok(None) };
                    labels.push(match self.operand(m, expr)? {
                        Value::Number(x) => number::plain(x.re()),
                        Value::Text(text) => text.to_string(),
                        _ => return Ok(None),
                    });
                }
                Some(format!("{base}[{}]", labels.join(",")))
            }
            _ => None,
        })
    }

    /// The object or family of a spelled name.
    pub fn spelled_value(&self, text: &str) -> Option<Value<T>> {
        if let Some(key) = self.run.find(text) {
            return Some(Value::Object(key));
        }
        let members = &self.env.sketch_members;
        if let Some(value) = members.get(text).or_else(|| members.get(&text.to_ascii_lowercase())) {
            return Some(value.clone());
        }
        if let Some(number) = self.env.params.iter().position(|p| p.name == text) {
            return Some(Value::Number(self.env.param_values[number]));
        }
        self.env.families.contains_key(text).then(|| self.family(text))
    }

    /// The objects of an entity list, unread; any other value as it is.
    pub fn opened(&self, value: Value<T>) -> Value<T> {
        let Value::Object(key) = value else { return value };
        let list = self.run.graph().get(key).filter(|o| o.row.role == Role::List);
        match list.and_then(|o| o.args.first()) {
            Some(Value::List(items)) => {
                let mut all = Vec::with_capacity(items.len());
                for item in items.iter() {
                    match self.opened(item.clone()) {
                        Value::List(inner) => all.extend(inner.iter().cloned()),
                        other => all.push(other),
                    }
                }
                Value::list(all)
            }
            _ => value,
        }
    }

    pub fn no_such_object(&self, text: &str) -> Diagnostic {
        let sketch = text.strip_suffix(".body");
        if let Some(solid) = sketch.map(|s| format!("{s}.solid"))
            && self.run.find(&solid).is_some()
        {
            let text = format!(
                "`{text}` has no closed form: some of its round faces are bounded by others"
            );
            return Diagnostic::error("unknown-name", text)
                .help(format!("`set(inside({solid}))` is the body with chords in place of arcs"));
        }
        let diagnostic = Diagnostic::error("unknown-name", format!("unknown object `{text}`"));
        if !self.hints() {
            return diagnostic;
        }
        diagnostic
            .maybe_help(self.run.graph().nearest_name(text).map(|n| format!("did you mean `{n}`?")))
    }

    fn member(
        &mut self,
        m: &Module,
        id: ExprId,
        base: ExprId,
        name: Symbol,
        or_dot: bool,
    ) -> Evaluated<T> {
        if let Some(text) = self.spelled(m, id)? {
            if let Some(value) = self.spelled_value(&text) {
                return Ok(value);
            }
            // `fore.leg.x`: the object is spelled by the base, the member is its own.
            let base_text = self.spelled(m, base)?.unwrap_or_default();
            if self.spelled_value(&base_text).is_none() {
                return Err(self.no_such_object(&text));
            }
        }
        let word = m.program.name(name).to_string();
        // The extents of a variable passed by reference are known without reading it.
        if let Some(symbol) = m.program.as_name(base)
            && let Some(place) = self.env.scope.place_of(m.names[symbol.0 as usize])
            && let Some(section) = place.section
            && let Some(d) = ["d1", "d2", "d3"].iter().position(|d| *d == word)
        {
            let (extents, count) = section.extents();
            if d < count {
                return Ok(Value::Number(T::from(extents[d] as f64)));
            }
        }
        if let Some(number) = self.whole_member(m, base, &word, m.program[base].span) {
            return number;
        }
        let value = self.expr(m, base)?;
        let object = match value {
            Value::Object(key) => Some(key),
            _ => None,
        };
        let value = self.read(value, m.program[base].span)?;
        if let Some(member) = crate::value::member::of_value(&value, &word) {
            let vector = |b: &ScopedBinding<T>| {
                matches!(
                    &b.what,
                    Binding::Variable { value: Value::Vector(_) | Value::Vectors(_), .. }
                )
            };
            if or_dot && self.env.scope.lookup(m.names[name.0 as usize]).is_some_and(vector) {
                self.report(
                    Diagnostic::remark("two-readings", format!("`.{word}` is the member here"))
                        .at(m.program.member_span(id))
                        .help(format!(
                            "for the dot product with `{word}` put blanks around the dot"
                        )),
                );
            }
            return member;
        }
        if let Some(key) = object
            && let Some(member) = self.member_of_object(key, &word)
        {
            return member;
        }
        if or_dot && self.env.scope.lookup(m.names[name.0 as usize]).is_some() {
            let span = m.program.member_span(id);
            let right = self.name(m, name, span)?;
            let right = self.read(right, span)?;
            return ops::binary(BinaryOp::Dot, &value, &right);
        }
        if let (Value::Contours(contours), Some(key)) = (&value, object)
            && let Some(member) =
                self.contours_member(key, contours, &word, m.program.member_span(id))
        {
            return member;
        }
        let known = crate::value::member::names(&value);
        let habit = match &*word {
            "shape" | "size" | "dim" | "dims" | "length" | "len" if ops::is_array(&value) => {
                Some("the extents of an array are .d1 .d2 .d3; `length(c)` is that of a curve")
            }
            "T" if ops::is_array(&value) => Some("the transposed grid is `swap(s)`"),
            _ => None,
        };
        Err(Diagnostic::error("unknown-member", format!("{} has no `{word}`", value.called()))
            .at(m.program.member_span(id))
            .maybe_help(habit)
            .expected(known.join(", "))
            .suggest(&word, known.iter().map(|name| &**name)))
    }

    fn member_of_object(
        &mut self,
        key: moldloft_num::trace::Key,
        word: &str,
    ) -> Option<Evaluated<T>> {
        let object = self.run.graph().get(key)?;
        if let Some(member) = crate::value::member::of_patch(object, word) {
            return Some(member);
        }
        if let Some(member) = crate::run::weight::member(object, word) {
            return Some(Ok(member));
        }
        if object.row.role == Role::SolveSet
            && let Some(value) = self.member_of_solve(&object.name, word)
        {
            return Some(value);
        }
        let at = object.row.field(word)?;
        Some(Ok(object.args[at].clone()))
    }

    /// An unknown of a solve set, or a number of its report.
    fn member_of_solve(&self, set: &str, word: &str) -> Option<Evaluated<T>> {
        let solve = self.env.solves.iter().find(|s| &*s.name == set)?;
        let named =
            |u: &&SolveUnknown<T>| u.name == word || u.name.rsplit('.').next() == Some(word);
        if let Some(unknown) = solve.unknowns.iter().find(named) {
            return Some(Ok(Value::Number(unknown.value)));
        }
        let known = self.env.solved.get(set).copied();
        let later = || {
            Err(Diagnostic::error("no-value", format!("`{word}` is available only after the run"))
                .help("evaluate it with `moldloft eval`"))
        };
        Some(match word {
            "residual" => {
                let largest = solve.conditions.iter().map(|c| c.abs());
                Ok(Value::Number(largest.fold(T::zero(), T::max)))
            }
            "iterations" => match known {
                Some((steps, _)) => Ok(Value::Number(T::from(steps as f64))),
                None => later(),
            },
            "status" => match known {
                Some((_, status)) => Ok(Value::text(status.word())),
                None => later(),
            },
            _ => return None,
        })
    }

    fn call(
        &mut self,
        m: &Module,
        callee: ExprId,
        args: NodeList<Arg>,
        span: Span,
    ) -> Evaluated<T> {
        let Some(symbol) = m.program.as_name(callee) else {
            let value = self.operand(m, callee)?;
            return self.call_value(m, value, args, m.program[callee].span);
        };
        let name = m.names[symbol.0 as usize];
        // A subroutine is called as a statement, a function of its name in expressions.
        let valued = |at: &RoutineAt| {
            let known = m.rows[symbol.0 as usize].as_ref().is_some_and(|row| !row.kind);
            !known || self.modules.get(at.module).program[at.routine].result.is_some()
        };
        let routine = self.routine_named(name).filter(valued);
        match self.env.scope.lookup(name).map(|bound| &bound.what) {
            Some(Binding::Routine(_)) | None => {}
            Some(Binding::Function(row)) => {
                let row = row.clone();
                return self.call_row(m, row, args, span);
            }
            Some(_) => {
                let value = self.name(m, symbol, m.program[callee].span)?;
                let value = self.read(value, m.program[callee].span)?;
                return self.call_value(m, value, args, m.program[callee].span);
            }
        }
        if let Some(routine) = routine {
            let errors = self.error_count();
            let value = self.call_routine(m, routine, args, None, span)?;
            if value.is_none() && self.error_count() > errors {
                // The reason was reported.
                return Err(silent());
            }
            return value.ok_or_else(|| {
                let text = m.program.name(symbol);
                let callee = self.modules.get(routine.module);
                Diagnostic::error("no-value", format!("`{text}` returns no value")).help(
                    match callee.program[routine.routine].result {
                        Some(_) => {
                            "it ended without one: every path through it must `return` a value"
                        }
                        None => "only a function does: declare it as `function float f(...)`",
                    },
                )
            });
        }
        if let Some(&record) = self.env.scope.records.get(&name) {
            return self.new_record(m, record, args, span);
        }
        let Some(row) = self.row(m, symbol, args.len(), span) else {
            return Err(self.unknown_function(m, symbol).at(m.program[callee].span));
        };
        if let Implementation::Foreign(_) = row.body
            && let Some(body) = builtins::body(&row.name)
        {
            return self.call_in_run(m, (&row, body), args, span);
        }
        self.call_row(m, row, args, span)
    }

    /// The value of a function of the registry.
    fn call_row(
        &mut self,
        m: &Module,
        mut row: Arc<Row>,
        args: NodeList<Arg>,
        span: Span,
    ) -> Evaluated<T> {
        let mut given = Given { positional: Vec::with_capacity(args.len()), named: Vec::new() };
        for arg in &m.program[args] {
            let value = self.operand(m, arg.value)?;
            match arg.name {
                None => given.positional.push(value),
                Some(ident) => given.named.push((m.program.name(ident.symbol), value)),
            }
        }
        // A block is moved layer by layer.
        if matches!(&*row.name, "translate" | "scale" | "mirror" | "rotate")
            && let Some(Value::Block(layers)) = given.positional.first().cloned()
        {
            let mut moved = Vec::with_capacity(layers.len());
            for layer in layers.iter() {
                let mut given = given.clone();
                given.positional[0] = layer.clone();
                moved.push(self.call_given(m, &row, given, args, span)?);
            }
            return Ok(Value::Block(moved.into()));
        }
        // For numbers and points it is their mean, for a surface alone the mean curvature.
        if &*row.name == "mean"
            && given.positional.first().is_some_and(|value| {
                match &*moldloft_arrays::gathered(value) {
                    Value::Number(_) | Value::Numbers(_) | Value::Vector(_) => true,
                    Value::Vectors(a) => matches!(a.shape, ArrayShape::Row(_)) || args.len() > 1,
                    _ => false,
                }
            })
            && let Some(average) = self.loader.registry.get("average")
        {
            row = average.clone();
        }
        self.call_given(m, &row, given, args, span)
    }

    /// The value of a function of the registry with these arguments, those of `args`.
    fn call_given(
        &mut self,
        m: &Module,
        row: &Arc<Row>,
        given: Given<'_, T>,
        args: NodeList<Arg>,
        span: Span,
    ) -> Evaluated<T> {
        if let Some(measure) = self.shape_measure(&row.name, &given) {
            return measure.map_err(|d| d.or_at(span));
        }
        // Arguments of functions are finite but after `ieee();`.
        if self.arrays.ieee
            && given.named.is_empty()
            && let Some(value) =
                crate::functions::elementary::combined(&row.name, &given.positional)
        {
            return Ok(value);
        }
        let positional = given.positional.len();
        let (filled, _) = bind_arguments(row, given, |_| Class::Any)
            .map_err(|fault| fault_location::diagnostic(m, args, row, positional, &fault, span))?;
        let room = self.has_room_for(&filled);
        room.map_err(|fault| {
            fault_location::diagnostic(m, args, row, positional, &fault.into(), span)
        })?;
        // Values that are as fast to compute as to look up are not cached.
        let value = if let Some(nested) = self.nested_row(row, &filled, span) {
            nested
        } else if crate::functions::elementary::is_quick(row) {
            T::call(row, &filled, &self.run.graph().context())
        } else {
            self.charge_call();
            self.run.call(row, filled)
        };
        for remark in self.run.graph().context().take_remarks() {
            let diagnostic = Diagnostic::remark(remark.id, remark.message).at(span);
            self.report(diagnostic.help(remark.help));
        }
        let value = value
            .map_err(|fault| fault_location::diagnostic(m, args, row, positional, &fault, span))?;
        if !self.arrays.ieee && !value.is_finite() {
            return Err(Diagnostic::error(
                "not-finite",
                format!("the result of {} is not a finite number", row.name),
            )
            .at(span)
            .expected("arguments inside the function's domain"));
        }
        Ok(value)
    }

    /// Checks that memory suffices for the rows that a function makes of its arguments, and for a
    /// result of their size.
    fn has_room_for(&self, args: &[Value<T>]) -> Result<(), Spent> {
        let bytes = args.iter().map(number_count).sum::<usize>() * size_of::<f64>();
        match bytes {
            0..SMALL_ARGUMENTS => Ok(()),
            _ => self.inputs.budget.grow(2 * bytes as u64),
        }
    }

    fn unknown_function(&self, m: &Module, symbol: Symbol) -> Diagnostic {
        let text = m.program.name(symbol);
        let diagnostic = Diagnostic::error("unknown-name", format!("unknown function `{text}`"));
        diagnostic.maybe_help(self.meant(text))
    }

    /// Possible meaning of an unknown word: a name in a library, a word of another language, a
    /// misspelled name.
    fn meant(&self, text: &str) -> Option<String> {
        let near = || self.nearest_name(text).map(|near| format!("did you mean `{near}`?"));
        crate::source::library::defining(text)
            .or_else(|| foreign_word(text).map(str::to_string))
            .or_else(near)
    }

    /// A shape called with parameters: its point or points there.
    fn call_value(
        &mut self,
        m: &Module,
        value: Value<T>,
        args: NodeList<Arg>,
        span: Span,
    ) -> Evaluated<T> {
        let mut given = Vec::new();
        for arg in &m.program[args] {
            given.push(self.operand(m, arg.value)?);
        }
        shape_at(&value, &given).map_err(|d| d.or_at(span))
    }
}

/// A curve at t, a surface at (u, v), a field at a point; rows of parameters give rows.
pub(crate) fn shape_at<T: Scalar>(value: &Value<T>, args: &[Value<T>]) -> Evaluated<T> {
    let parameters = |arg: &Value<T>| -> Result<Option<Vec<T>>, Diagnostic> {
        match arg {
            Value::Number(_) => Ok(None),
            Value::Vector(v) => Ok(Some(v.to_array().to_vec())),
            other => many(other).map(Some).map_err(|f| fault_location::unplaced(&f)),
        }
    };
    let one = |arg: &Value<T>| match arg {
        Value::Number(x) => *x,
        _ => T::zero(),
    };
    let count = |expected: &str| {
        Diagnostic::error("wrong-count", format!("expected {expected}"))
            .expected(expected.to_string())
            .found(argument_count(args.len()))
    };
    let row = |points: Vec<Vec3<T>>| Value::Vectors(Arc::new(Vectors::row(points)));
    match (value, args) {
        (Value::Curve(curve), [t]) => {
            let at = |curve: &CurveRef<T>, t: T| curve.jet(t, Order::Zero)[0];
            Ok(match parameters(t)? {
                None => Value::Vector(at(curve, one(t))),
                Some(ts) => row(ts.into_iter().map(|t| at(curve, t)).collect()),
            })
        }
        (Value::Curve(_), _) => Err(count("one parameter t, as in c(0.5)")),
        (Value::Surface(surface), [u, v]) => {
            let at = |s: &SurfaceRef<T>, u: T, v: T| s.jet(u, v, Order::Zero).p;
            let (us, vs) = (parameters(u)?, parameters(v)?);
            let n = match (&us, &vs) {
                (None, None) => return Ok(Value::Vector(at(surface, one(u), one(v)))),
                (Some(us), Some(vs)) if us.len() != vs.len() => {
                    return Err(Diagnostic::error("shapes-differ", "u and v differ in length")
                        .found(format!("{} and {}", us.len(), vs.len())));
                }
                (Some(us), _) => us.len(),
                (None, Some(vs)) => vs.len(),
            };
            let pick = |all: &Option<Vec<T>>, single: &Value<T>, k: usize| {
                all.as_ref().map_or_else(|| one(single), |all| all[k])
            };
            Ok(row((0..n).map(|k| at(surface, pick(&us, u, k), pick(&vs, v, k))).collect()))
        }
        (Value::Surface(_), _) => Err(count("two parameters u and v, as in s(0.5, 0.25)")),
        (Value::Relabel(law), [t]) => {
            let at = |t: T| law.jet(t, Order::Zero)[0];
            Ok(match parameters(t)? {
                None => Value::Number(at(one(t))),
                Some(ts) => Value::Numbers(Arc::new(Array::row(ts.into_iter().map(at).collect()))),
            })
        }
        (Value::Relabel(_), _) => Err(count("one parameter t, as in r(0.5)")),
        (Value::Solid(solid), [u, v, w]) => {
            let (us, vs, ws) = (parameters(u)?, parameters(v)?, parameters(w)?);
            let rows = [&us, &vs, &ws];
            let lengths: Vec<usize> = rows.iter().filter_map(|r| Some(r.as_ref()?.len())).collect();
            let Some(&n) = lengths.first() else {
                return Ok(Value::Vector(solid.eval(one(u), one(v), one(w))));
            };
            if lengths.iter().any(|&m| m != n) {
                let found = lengths.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
                return Err(
                    Diagnostic::error("shapes-differ", "u, v and w differ in length").found(found)
                );
            }
            let pick = |all: &Option<Vec<T>>, single: &Value<T>, k: usize| {
                all.as_ref().map_or_else(|| one(single), |all| all[k])
            };
            let at = |k: usize| solid.eval(pick(&us, u, k), pick(&vs, v, k), pick(&ws, w, k));
            Ok(row((0..n).map(at).collect()))
        }
        (Value::Solid(_), _) => Err(count("three parameters u, v and w, as in s(0.5, 0.25, 0.75)")),
        (Value::Field(_) | Value::Set(_), [p]) => crate::value::implicit::at(value, p),
        (Value::Field(_) | Value::Set(_), _) => Err(count("one point, as in f({1, 2, 3})")),
        (other, _) => {
            let class = other.called();
            Err(Diagnostic::error("not-callable", format!("{class} cannot be called"))
                .expected("a curve, surface, relabel, field, set or function")
                .found(class))
        }
    }
}
