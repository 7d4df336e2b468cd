//! Runs a program: declarations of variables.

use crate::run::declared_lists::declared_list;
use crate::run::interpreter::Interpreter;
use crate::source::module::Module;
use crate::source::scope::{Binding, ScopedBinding};
use crate::value::initialised::Known;
use crate::value::variables;
use moldloft_diag::{Diagnostic, Span};
use moldloft_registry::Scalar;
use moldloft_syntax::sdl::{Declarator, ExprId, Ident, NodeList, StmtId, Type, foreign_word};

impl<T: Scalar> Interpreter<'_, '_, T> {
    pub(super) fn declare(
        &mut self,
        m: &Module,
        id: StmtId,
        global: bool,
        (ty, ty_span): (Type, Span),
        item: &Declarator,
    ) -> Result<(), Diagnostic> {
        let object = self.makes_object(m, ty, item);
        let record = self.record_type(m, ty);
        if let (Type::Other(symbol), None) = (ty, record) {
            return Err(self.unknown_type(m.program.name(symbol)).at(ty_span));
        }
        if let Some(list) = declared_list(m, ty, item) {
            return self.declare_list(m, global, (ty, list), item);
        }
        if let Some(record) = record {
            return self.declare_record(m, global, (ty, record), item);
        }
        let dims = self.extents(m, item.dims)?;
        let value = match item.value {
            Some(expr) => {
                let span = m.program[expr].span;
                let value = self.noting(object, |this| {
                    let value = this.expr(m, expr)?;
                    this.read(value, span)
                })?;
                // A single value fills a dimensioned array.
                let value = match dims.is_empty() {
                    true => variables::converted(ty, value).map_err(|d| d.or_at(span))?,
                    false => value,
                };
                Some(crate::value::implicit::called(ty, value, m.program.name(item.name.symbol)))
            }
            None => None,
        };
        if let (true, Some(value)) = (object, &value) {
            return self.implicit_object(m, id, ty, item, value.clone());
        }
        if !dims.is_empty() {
            let count = dims.iter().map(|&n| n as f64).product();
            self.usage.steps += variables::has_room::<T>(ty, count, self.inputs.budget)?;
        }
        let known = match (&value, &dims[..]) {
            (Some(_), _) | (_, [] | [_, _, _]) => Known::default(),
            _ if ty == Type::String => Known::default(),
            _ => Known::nothing(dims.iter().product()),
        };
        let shape = value.as_ref().map(variables::shape_of);
        let value = variables::initial(ty, &dims, value).map_err(|d| match item.value {
            Some(expr) => {
                let declared =
                    Span::new(item.name.span.file, item.name.span.start, span_end(m, item));
                let of = |dims: &[usize]| {
                    let all: Vec<String> = dims.iter().map(usize::to_string).collect();
                    format!("{}[{}]", m.program.slice(ty_span), all.join(","))
                };
                let found = shape.map_or(String::new(), |s| s.to_string());
                let span = m.program[expr].span;
                self.differing(m, d, [declared, span], [&of(&dims), &found]).or_at(span)
            }
            None => d,
        })?;
        let what = Binding::Variable { ty, value, fixed: !dims.is_empty(), known };
        self.bind_variable(m, global, item.name, what)
    }

    /// Declared dimensions.
    pub(super) fn extents(
        &mut self,
        m: &Module,
        dims: NodeList<ExprId>,
    ) -> Result<Vec<usize>, Diagnostic> {
        let mut all = Vec::with_capacity(dims.len());
        for &dim in &m.program[dims] {
            let n = self.number(m, dim)?.re();
            all.push(variables::extent(n).map_err(|d| d.or_at(m.program[dim].span))?);
        }
        Ok(all)
    }

    /// Gives a declared variable its name.
    pub(super) fn bind_variable(
        &mut self,
        m: &Module,
        global: bool,
        ident: Ident,
        what: Binding<T>,
    ) -> Result<(), Diagnostic> {
        let name = m.names[ident.symbol.0 as usize];
        self.check_free(name, ident.span, true)?;
        if global && !self.env.scope.frame().global {
            self.env.scope.globals[name.0 as usize] =
                Some(ScopedBinding { span: ident.span, what });
        } else {
            self.env.scope.bind(name, ident.span, what);
        }
        Ok(())
    }

    fn unknown_type(&self, word: &str) -> Diagnostic {
        let diagnostic = Diagnostic::error("unknown-type", format!("unknown type `{word}`"));
        if let Some(hint) = foreign_word(word) {
            return diagnostic.help(hint);
        }
        diagnostic
            .suggest(word, moldloft_syntax::sdl::declaring_words())
            .help("an object is declared with its data in parentheses: AbsPoint P(0, 0, 1);")
    }
}

/// End of a declarator's name and dimensions.
fn span_end(m: &Module, item: &Declarator) -> u32 {
    let last = m.program[item.dims].last();
    // The bracket after the last dimension.
    last.map_or(item.name.span.end, |&dim| {
        let end = m.program[dim].span.end;
        let rest = m.program.text().get(end as usize..).unwrap_or("");
        end + rest.find(']').map_or(0, |k| k as u32 + 1)
    })
}
