//! Calls of functions that need the run: which expression each argument is.

use crate::run::interpreter::Interpreter;
use crate::source::module::Module;
use moldloft_diag::{Diagnostic, Span};
use moldloft_registry::{Row, Scalar, Value, argument_count};
use moldloft_syntax::sdl::{Arg, ExprId, NodeList};

/// The body of a function.
pub(crate) type RunBody<T> =
    fn(&mut Interpreter<'_, '_, T>, &RunCall<'_>) -> Result<Value<T>, Diagnostic>;

/// Use of a multiple argument or of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SequenceUse {
    More,
    Next,
    Rewind,
    Count,
}

/// A call with the expressions of its arguments.
pub(crate) struct RunCall<'a> {
    pub m: &'a Module,
    pub row: &'a Row,
    pub span: Span,
    /// Number of the field, and expression, in the order of the fields; repeated ones in that of the call.
    given: Vec<(usize, ExprId)>,
}

/// `name(a, [b], ...)`: optional arguments in brackets, dots if the last ones may be repeated.
fn signature(row: &Row) -> String {
    let mut arguments: Vec<String> = Vec::new();
    for field in row.fields.iter() {
        let optional = field.default.is_some();
        arguments.push(if optional { format!("[{}]", field.name) } else { field.name.into() });
    }
    if row.fields.iter().any(|field| field.variadic) {
        arguments.push("...".into());
    }
    format!("{}({})", row.name, arguments.join(", "))
}

impl<'a> RunCall<'a> {
    /// The arguments by field: positional ones in order, others by name. An optional one before required ones that is
    /// given by name, or not at all, takes no position.
    ///
    /// # Errors
    /// Unknown names, arguments given twice, missing or too many.
    pub fn new(
        m: &'a Module,
        row: &'a Row,
        args: NodeList<Arg>,
        span: Span,
    ) -> Result<Self, Diagnostic> {
        let fault = |id: &'static str, message: String, at: Span| {
            Diagnostic::error(id, message).at(at).expected(signature(row))
        };
        let fields = &row.fields;
        let twice = |word: &str, at: Span| {
            fault("argument-twice", format!("`{word}` of {} is given twice", row.name), at)
        };
        let (mut named, mut positional) = (Vec::new(), Vec::new());
        for arg in &m.program[args] {
            let Some(ident) = arg.name else {
                positional.push(arg.value);
                continue;
            };
            let word = m.program.name(ident.symbol);
            let Some(at) = row.field(word) else {
                let message = format!("{} has no argument `{word}`", row.name);
                let names = fields.iter().map(|field| field.name);
                return Err(fault("unknown-argument", message, ident.span).suggest(word, names));
            };
            if named.iter().any(|(own, _)| *own == at) {
                return Err(twice(word, ident.span));
            }
            named.push((at, arg.value));
        }
        let required = |at: usize| fields[at].default.is_none();
        let skipped = |at: usize| !required(at) && (at + 1..fields.len()).any(required);
        let is_named = |at: usize| named.iter().any(|(own, _)| *own == at);
        let order: Vec<usize> =
            (0..fields.len()).filter(|&at| !(skipped(at) && is_named(at))).collect();
        let mut given = Vec::with_capacity(positional.len() + named.len());
        let repeats = fields.iter().any(|field| field.variadic);
        for (k, value) in positional.into_iter().enumerate() {
            let at = match order.get(k) {
                Some(&at) => at,
                None if repeats => fields.len() - 1,
                None => {
                    let message = format!("{} takes {}", row.name, argument_count(fields.len()));
                    let found = argument_count(args.len());
                    return Err(fault("too-many-arguments", message, span).found(found));
                }
            };
            if is_named(at) {
                return Err(twice(fields[at].name, m.program[value].span));
            }
            given.push((at, value));
        }
        given.extend(&named);
        given.sort_by_key(|(at, _)| *at);
        let enough = given.len() >= (0..fields.len()).filter(|&at| required(at)).count();
        let missing = |at: &usize| {
            let displaced = (0..*at).any(skipped) && enough;
            required(*at) && !displaced && given.iter().all(|(own, _)| own != at)
        };
        if let Some(at) = (0..fields.len()).find(missing) {
            let message = format!("{} needs `{}`", row.name, fields[at].name);
            let found = argument_count(args.len());
            return Err(fault("missing-argument", message, span).found(found));
        }
        Ok(Self { m, row, span, given })
    }

    /// The argument of a field.
    pub fn at(&self, field: usize) -> Option<ExprId> {
        self.given.iter().find(|(at, _)| *at == field).map(|(_, value)| *value)
    }

    /// The argument of the first field, which is required.
    pub fn first(&self) -> ExprId {
        self.given[0].1
    }

    /// All arguments but the first.
    pub fn rest(&self) -> impl Iterator<Item = ExprId> + '_ {
        self.given[1..].iter().map(|(_, value)| *value)
    }
}

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// The value of a function that needs the run.
    pub(crate) fn call_in_run(
        &mut self,
        m: &Module,
        (row, body): (&Row, RunBody<T>),
        args: NodeList<Arg>,
        span: Span,
    ) -> Result<Value<T>, Diagnostic> {
        let call = RunCall::new(m, row, args, span)?;
        body(self, &call).map_err(|d| d.or_at(span))
    }
}
