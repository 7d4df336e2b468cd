//! Solve sets in a run: the kind, and the record for the solver of a statement that declares one.

use crate::run::interpreter::Interpreter;
use crate::run::program;
use crate::source::env::{Solve, SolveUnknown};
use crate::source::fault_location;
use crate::source::module::Module;
use crate::source::scope::Binding;
use crate::value::number_path::NumberPath;
use moldloft_diag::{Diagnostic, Span};
use moldloft_num::Real;
use moldloft_registry::export::StaticRow;
use moldloft_registry::{Array, Build, CallError, Class, Context, Kind, Row, Scalar, Value, many};
use moldloft_syntax::sdl::{Arg, ExprId, ExprKind, NodeList};
use std::sync::Arc;

/// Solves for parameters and numbers of objects that make an equal number of expressions zero, by
/// damped Newton iteration from their given values.
///
/// An unknown is a parameter of the program, or a literal number in the declaration of an object:
/// `P21.y` of a point, `b.t` of a bead. Objects that depend on it use the solution; ranges of
/// parameters and arguments bound the search. The program text keeps the initial value. The
/// conditions are expressions, zero when satisfied: `hull.volume - 100`. `s.x` is the solution for
/// the unknown x, `s.residual` the largest remaining condition, `s.iterations` the number of steps.
#[derive(Kind)]
#[kind(
    class = Numbers,
    role = SolveSet,
    example = "param float x = 1 in [0, 5]; param float y = 1; AbsPoint A(x, y, 0); \
               AbsPoint B(0, 0, 0); Line l(A, B); SolveSet s({x, y}, {l.length - 5, A.x - 0.75*A.y});"
)]
pub struct SolveSet<T: Real> {
    /// Unknowns: parameters, and numbers of objects.
    #[field(min_items = 1)]
    unknowns: Vec<T>,
    /// Conditions, as many as unknowns: expressions that become zero.
    #[field(min_items = 1)]
    conditions: Vec<T>,
    /// Maximum number of steps.
    #[field(default = 50, min = 1, max = 1000)]
    steps: u32,
}

impl<T: Real> Build<T> for SolveSet<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let _ = (self.conditions, self.steps);
        Ok(Value::Numbers(Arc::new(Array::row(self.unknowns))))
    }
}

pub(crate) fn row() -> Row {
    <SolveSet<f64> as StaticRow>::row()
}

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// Takes note of a solve set; its conditions are read.
    #[allow(clippy::too_many_arguments)]
    pub fn solve_set(
        &mut self,
        m: &Module,
        args: NodeList<Arg>,
        row: &Row,
        positional: usize,
        filled: &mut [Value<T>],
        full: &str,
        span: Span,
    ) -> Result<(), Diagnostic> {
        if !self.env.scope.frame().global || !self.env.scope.frame().loops.is_empty() {
            return Err(Diagnostic::error(
                "misplaced-param",
                "a solve set belongs at file level, outside loops and subroutines",
            )
            .at(span));
        }
        let items: Vec<ExprId> = fault_location::argument(m, &m.program[args], row, positional, 0)
            .map(|expr| match m.program[m.program.bare(expr)].kind {
                ExprKind::List(items) => m.program[items].to_vec(),
                _ => vec![expr],
            })
            .unwrap_or_default();
        let mut unknowns: Vec<SolveUnknown<T>> = Vec::new();
        for item in items {
            let at = m.program[item].span;
            let unknown = self.unknown(m, item)?;
            let others = self.env.solves.iter().flat_map(|s| &s.unknowns);
            if unknowns.iter().chain(others).any(|other| other.name == unknown.name) {
                return Err(Diagnostic::error(
                    "not-an-unknown",
                    format!("`{}` is an unknown already", unknown.name),
                )
                .at(at)
                .help("an unknown belongs to one solve set, once"));
            }
            unknowns.push(unknown);
        }
        let expr = fault_location::argument(m, &m.program[args], row, positional, 1);
        let at = expr.map_or(span, |expr| m.program[expr].span);
        filled[1] = self.read(filled[1].clone(), at)?;
        let conditions: Vec<T> = match &filled[1] {
            Value::Vector(v) => v.to_array().to_vec(),
            other => many(other).map_err(|fault| fault_location::unplaced(&fault).at(at))?,
        };
        if conditions.len() != unknowns.len() {
            return Err(Diagnostic::error(
                "wrong-count",
                format!(
                    "{} conditions do not determine {} unknowns",
                    conditions.len(),
                    unknowns.len()
                ),
            )
            .at(at)
            .expected(format!("{} conditions", unknowns.len()))
            .found(conditions.len().to_string())
            .help("state one number that becomes zero for each unknown"));
        }
        let steps = match &filled[2] {
            Value::Number(x) => x.re() as usize,
            _ => 50,
        };
        self.env.solves.push(Solve { name: full.into(), span, unknowns, conditions, steps });
        Ok(())
    }

    /// The parameter, or the literal of an object, that an item of the list names.
    fn unknown(&mut self, m: &Module, item: ExprId) -> Result<SolveUnknown<T>, Diagnostic> {
        let at = m.program[item].span;
        let name = m.program.as_name(item).map(|symbol| m.names[symbol.0 as usize]);
        if let Some(Binding::Param(number)) =
            name.and_then(|name| self.env.scope.lookup(name)).map(|b| &b.what)
        {
            let param = &self.env.params[*number];
            if param.is_int {
                return Err(Diagnostic::error("not-an-unknown", "an unknown varies continuously")
                    .at(at)
                    .expected("a parameter of type float")
                    .found("an int"));
            }
            return Ok(SolveUnknown {
                name: param.name.clone(),
                value: self.env.param_values[*number],
                range: param.range,
                object: None,
            });
        }
        let text: String = m.program.slice(at).chars().filter(|c| !c.is_whitespace()).collect();
        let refused = |found: String| {
            Diagnostic::error(
                "not-an-unknown",
                "an unknown is a parameter or a number of an object",
            )
            .at(at)
            .expected("a parameter, or a number such as P21.y")
            .found(found)
            .help("declare it: param float x = 1 in [0, 5];")
        };
        // The object's own name may contain dots: the longest that is one wins.
        let dots = text.char_indices().rev().filter(|(_, c)| *c == '.').map(|(k, _)| k);
        let owner = dots.map(|k| text.split_at(k)).find_map(|(o, p)| Some((self.run.find(o)?, p)));
        let Some((key, path)) = owner else { return Err(refused(format!("`{text}`"))) };
        let graph = self.run.graph();
        let Some(object) = graph.get(key) else { return Err(refused(format!("`{text}`"))) };
        let mut value = None;
        let path = NumberPath::parse(&object.row, path).filter(|path| {
            let keep = |x| {
                value = Some(x);
                x
            };
            path.change(&mut object.args.clone(), keep).is_some()
        });
        let (Some(path), Some(value)) = (path, value) else {
            return Err(refused(format!(
                "`{text}`, which {} does not have as a number",
                object.row.name
            )));
        };
        if program::literal(self.modules, self.env, object, &path).is_err() {
            return Err(refused(format!("`{text}`, which is not a number of its own in the text"))
                .help("make it a parameter, or name the parameters that it is computed from"));
        }
        let field = &object.row.fields[path.field];
        if field.class == Class::Integer {
            return Err(refused(format!("`{text}`, an integer")));
        }
        let range = match (field.min, field.max) {
            (None, None) => None,
            (low, high) => Some((low.unwrap_or(f64::MIN), high.unwrap_or(f64::MAX))),
        };
        Ok(SolveUnknown { name: text, value, range, object: Some(object.name.to_string()) })
    }
}
