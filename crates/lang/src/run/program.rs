//! A program as a producer of objects.

use crate::model_file::names::plain_name;
#[cfg(not(target_arch = "wasm32"))]
pub use crate::run::interpreter::STACK_BYTES;
use crate::run::interpreter::{Inputs, Interpreter};
use crate::run::sketches::Site;
use crate::source::env::{Environment, Evaluation};
use crate::source::fault_location;
use crate::source::module::{Convert, Loader, Module, Modules};
use crate::source::scope::{Binding, ScopedBinding};
use crate::source::sketch_file::SketchFile;
use crate::source::world::World;
use crate::value::number_path::NumberPath;
use moldloft_budget::Budget;
use moldloft_diag::{Diagnostic, Sources, Span};
use moldloft_model::{Applied, Extent, Graph, Object};
use moldloft_registry::{CallError, Registry, Scalar, Value};
use moldloft_syntax::sdl::{self, ExprId, ExprKind, LiteralId, StmtKind, Type};
use std::sync::Arc;

/// Context of a run.
pub struct RunContext<'a> {
    /// The modules parsed up to now.
    pub modules: &'a mut Modules,
    /// The files that may be read.
    pub world: &'a dyn World,
    /// The rows of everything that can be called.
    pub registry: &'a Registry,
    /// The source texts, for spans in diagnostics.
    pub sources: &'a mut Sources,
    /// The sketch, if the model is one instead of a program.
    pub sketch: Option<Arc<SketchFile>>,
    /// The program of a loaded model file.
    pub converted: Convert,
}

/// Reason why a number of an object is not a literal of the text.
pub enum NotLiteral {
    /// It is computed from other names.
    Expression {
        /// The span of the expression.
        span: Span,
        /// The names that it reads.
        names: Vec<String>,
    },
    /// The statement declares several objects.
    Shared {
        /// The span of the statement.
        span: Span,
    },
    /// It is a default.
    Default,
}

/// Position of an object's argument in the main text, or for its insertion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArgumentInText {
    /// The expression.
    Written(Span),
    /// It is omitted: it can be inserted by its name at the end of this range.
    After(Span),
}

/// Runs `f` with sufficient stack for a deeply nested program: on a thread of its own, or on the
/// current thread, whose stack has [`STACK_BYTES`], if all work stays on one thread.
#[cfg(not(target_arch = "wasm32"))]
pub fn with_stack<R: Send>(f: impl FnOnce() -> R + Send) -> R {
    if moldloft_parallel::is_alone() {
        return f();
    }
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, f);
        match thread.expect("a thread can be started").join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}

/// Stack of a part of a run with deep calls: [`STACK_BYTES`] covers large frames of native
/// functions at all levels, this only a few.
#[cfg(not(target_arch = "wasm32"))]
const MORE_STACK: u32 = 64 << 20;

/// Runs `f` on a stack of its own, which counts as memory; `None` without memory for it, and where all work stays on
/// one thread.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn on_new_stack<R: Send>(budget: &Budget, f: impl FnOnce() -> R + Send) -> Option<R> {
    if moldloft_parallel::is_alone() {
        return None;
    }
    budget.grow(MORE_STACK.into()).ok()?;
    let _held = moldloft_budget::beside(MORE_STACK);
    std::thread::scope(|scope| {
        let thread =
            std::thread::Builder::new().stack_size(MORE_STACK as usize).spawn_scoped(scope, f);
        match thread.ok()?.join() {
            Ok(result) => Some(result),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}

/// There is one stack in a browser.
#[cfg(target_arch = "wasm32")]
pub(crate) fn on_new_stack<R: Send>(_: &Budget, f: impl FnOnce() -> R + Send) -> Option<R> {
    Some(f())
}

/// Runs `f` on the current stack: a page in a browser has no threads, and the size of its stack is
/// given.
#[cfg(target_arch = "wasm32")]
pub fn with_stack<R: Send>(f: impl FnOnce() -> R + Send) -> R {
    f()
}

impl RunContext<'_> {
    /// Runs module 0 and the modules that it loads.
    pub(crate) fn run<T: Scalar>(
        self,
        evaluation: &mut Evaluation<T>,
        inputs: Inputs<'_, T>,
        found: &mut Vec<Diagnostic>,
    ) -> Applied {
        evaluation.env = Environment::default();
        let Evaluation { graph, env } = evaluation;
        let loader = Loader {
            world: self.world,
            registry: self.registry,
            sources: self.sources,
            diagnostics: found,
            converted: self.converted,
        };
        // Evaluation that remains after the run uses the caller's thread pool.
        let (modules, sketch) = (self.modules, self.sketch);
        graph
            .apply(Extent::Whole, |run| {
                with_stack(|| {
                    let mut interpreter = Interpreter::new(modules, loader, run, env, inputs);
                    interpreter.module(0);
                    interpreter.judge();
                    interpreter.judge_units();
                    if let Some(sketch) = &sketch {
                        let span = Span::new(sketch.file, 0, 0);
                        interpreter.sketch(sketch, Site { origin: u32::MAX, span });
                    }
                });
            })
            .1
    }

    /// The value of an expression in the names of the last run, with its warnings.
    pub(crate) fn eval<T: Scalar>(
        self,
        evaluation: &mut Evaluation<T>,
        inputs: Inputs<'_, T>,
        text: &str,
    ) -> Result<(Value<T>, Vec<Diagnostic>), Vec<Diagnostic>> {
        // One name for all expressions, since a long session has many.
        const NAME: &str = "expression";
        let known = self.sources.find(NAME).filter(|&file| self.sources.ids().next() != Some(file));
        let file = match known {
            Some(file) => {
                self.sources.replace(file, text);
                file
            }
            None => self.sources.add(NAME, text),
        };
        let (program, expr, mut found) = sdl::parse_expr(text, file);
        if found.iter().any(Diagnostic::is_error) {
            return Err(found);
        }
        let at = self.modules.add_expression(program, self.registry);
        let module = self.modules.get(at).clone();
        let Evaluation { graph, env } = evaluation;
        bind_objects(self.modules, &module, graph, env);
        let stopped = std::mem::take(&mut env.stopped);
        let loader = Loader {
            world: self.world,
            registry: self.registry,
            sources: self.sources,
            diagnostics: &mut found,
            converted: self.converted,
        };
        let modules = &mut *self.modules;
        let (value, _) = with_stack(|| {
            graph.apply(Extent::Edit, |run| {
                let mut interpreter = Interpreter::new(modules, loader, run, env, inputs);
                interpreter.current = at;
                interpreter.operand(&module, expr)
            })
        });
        drop(module);
        self.modules.remove_expression(at);
        evaluation.env.stopped = stopped;
        match value {
            Ok(value) if !found.iter().any(Diagnostic::is_error) => Ok((value, found)),
            Ok(_) => Err(found),
            Err(diagnostic) => {
                if diagnostic.id != crate::run::interpreter::SILENT {
                    found.push(diagnostic);
                }
                if found.is_empty() {
                    found.push(Diagnostic::error(
                        "no-value",
                        "this depends on something that failed; see the model's own errors",
                    ));
                }
                Err(found)
            }
        }
    }
}

/// Position of an object's fault in the text.
pub fn fault_span<T: Scalar>(
    modules: &Modules,
    env: &Environment<T>,
    object: &Object<T>,
    fault: &CallError,
) -> Option<Span> {
    let origin = env.origins.get(object.origin as usize)?;
    let m = modules.get(origin.module as usize);
    let stmt = m.program[origin.stmt];
    let StmtKind::Object { args, .. } = stmt.kind else { return Some(stmt.span) };
    let unnamed = m.program[args].iter().filter(|a| a.name.is_none()).count();
    Some(fault_location::diagnostic(m, args, &object.row, unnamed, fault, stmt.span).span())
}

/// Position of an object's declaration in the text.
pub fn declared_at<T: Scalar>(
    modules: &Modules,
    env: &Environment<T>,
    object: &Object<T>,
) -> Option<Span> {
    let origin = env.origins.get(object.origin as usize)?;
    let m = modules.get(origin.module as usize);
    match m.program[origin.stmt].kind {
        StmtKind::Object { name, .. } => Some(name.span),
        StmtKind::Declare { items, .. } => {
            let mut items = m.program[items].iter();
            let item = items.find(|item| m.program.name(item.name.symbol) == &*object.name)?;
            Some(item.name.span)
        }
        _ => None,
    }
}

/// The literal of the text for a number of an object.
pub fn literal<T: Scalar>(
    modules: &Modules,
    env: &Environment<T>,
    object: &Object<T>,
    path: &NumberPath,
) -> Result<(usize, LiteralId), NotLiteral> {
    let (module, expr, repeated) = expression(modules, env, object, path)?;
    let m = modules.get(module);
    let Some(literal) = m.program.as_literal(expr) else {
        return Err(computed(m, expr));
    };
    if repeated {
        return Err(NotLiteral::Shared { span: m.program[expr].span });
    }
    Ok((module, literal))
}

/// The numbers in the expression of the main text that determines a number of an object, in the
/// order of the text, and the position of the expression; empty for objects declared with others in
/// one statement.
pub fn literals_within<T: Scalar>(
    modules: &Modules,
    env: &Environment<T>,
    object: &Object<T>,
    path: &NumberPath,
) -> Option<(Span, Vec<LiteralId>)> {
    let (module, expr, repeated) = expression(modules, env, object, path).ok()?;
    let m = modules.get(module);
    if repeated || module != 0 || m.program.as_literal(expr).is_some() {
        return None;
    }
    let mut found = Vec::new();
    let mut stack = vec![expr];
    while let Some(expr) = stack.pop() {
        match m.program[expr].kind {
            ExprKind::Number(literal) => found.push(literal),
            _ => stack.extend(crate::run::parts::of_expression(m, expr)),
        }
    }
    found.sort_by_key(|literal| m.program[*literal].span.start);
    Some((m.program[expr].span, found))
}

/// The expression that gives a number of an object: its module, and whether its statement may be executed more than once.
fn expression<T: Scalar>(
    modules: &Modules,
    env: &Environment<T>,
    object: &Object<T>,
    path: &NumberPath,
) -> Result<(usize, ExprId, bool), NotLiteral> {
    let Some(origin) = env.origins.get(object.origin as usize) else {
        return Err(NotLiteral::Default);
    };
    let m = modules.get(origin.module as usize);
    let stmt = m.program[origin.stmt];
    let StmtKind::Object { args, .. } = stmt.kind else { return Err(NotLiteral::Default) };
    let args = &m.program[args];
    let unnamed = args.iter().filter(|a| a.name.is_none()).count();
    let mut expr = fault_location::argument(m, args, &object.row, unnamed, path.field)
        .ok_or(NotLiteral::Default)?;
    for k in [path.item, path.component].into_iter().flatten() {
        match fault_location::item(m, expr, k) {
            Some(item) => expr = item,
            None => return Err(computed(m, expr)),
        }
    }
    Ok((origin.module as usize, expr, origin.repeated))
}

/// Position of an object's argument in the main text, or for its insertion; `None` for objects
/// declared with others in one statement.
pub fn argument_place<T: Scalar>(
    modules: &Modules,
    env: &Environment<T>,
    object: &Object<T>,
    field: usize,
) -> Option<ArgumentInText> {
    let origin = env.origins.get(object.origin as usize)?;
    if origin.repeated || origin.module != 0 {
        return None;
    }
    let m = modules.get(0);
    let StmtKind::Object { args, .. } = m.program[origin.stmt].kind else { return None };
    let args = &m.program[args];
    let spans: Vec<Span> = args.iter().map(|a| m.program[a.value].span).collect();
    let unnamed = args.iter().filter(|a| a.name.is_none()).count();
    let row = &object.row;
    if row.fields.get(field)?.variadic && unnamed > field + 1 {
        // A list given as separate arguments.
        let unnamed: Vec<Span> =
            args.iter().zip(&spans).filter(|(a, _)| a.name.is_none()).map(|(_, s)| *s).collect();
        let (first, last) = (unnamed.get(field)?, unnamed.last()?);
        return Some(ArgumentInText::Written(Span { end: last.end, ..*first }));
    }
    Some(match fault_location::argument(m, args, row, unnamed, field) {
        Some(expr) => ArgumentInText::Written(m.program[expr].span),
        None => ArgumentInText::After(*spans.last()?),
    })
}

fn computed(m: &crate::source::module::Module, expr: ExprId) -> NotLiteral {
    let mut names = Vec::new();
    crate::run::forward_reference::names_in(m, expr, &mut |symbol| {
        names.push(m.program.name(symbol).to_string())
    });
    NotLiteral::Expression { span: m.program[expr].span, names }
}

/// Makes the objects of a model file available to an expression, by their names or the equivalent
/// identifiers.
fn bind_objects<T: Scalar>(
    modules: &Modules,
    expression: &Module,
    graph: &Graph<T>,
    env: &mut Environment<T>,
) {
    env.scope.make_room(modules.name_count());
    for &name in &expression.names {
        let text = modules.text(name);
        let known = &mut env.scope.globals[name.0 as usize];
        if known.is_none()
            && let Some(key) = graph.find(text).or_else(|| graph.find(&plain_name(text)))
        {
            *known = Some(ScopedBinding { span: Span::UNKNOWN, what: Binding::Object(key) });
        } else if known.is_none()
            && let Some(&x) = env.numbers.get(&**text)
        {
            let ty = Type::Float;
            let what = Binding::variable(ty, Value::Number(x));
            *known = Some(ScopedBinding { span: Span::UNKNOWN, what });
        }
    }
}
