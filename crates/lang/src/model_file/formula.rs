//! Numbers of model files: variables, formulas, and formulas in columns.

use crate::model_file::names::{bare, words};
use crate::model_file::producer::Producer;
use crate::model_file::source::{Outcome, Sorted, Trouble, wrong};
use crate::source::env::Param;
use crate::source::scope::{Binding, ScopedBinding};
use crate::value::variables::Called as _;
use moldloft_diag::{Diagnostic, Span};
use moldloft_registry::{Scalar, Value};
use moldloft_syntax::model_file::{EntryField as Written, FieldKind, ObjectEntry as Line};

impl<T: Scalar> Producer<'_, '_, T> {
    /// The value of a `Variable` or `Formula`.
    pub fn real(&mut self, line: &Line, sorted: &Sorted) -> Result<T, Trouble> {
        let source = self.source;
        let (entity, name) = (source.model().slice(line.entity), source.model().slice(line.name));
        let fields = &sorted.head;
        let end = Span::point(line.span.file, line.span.end.saturating_sub(1));
        if entity == "Formula" {
            let Some(written) = fields.iter().find(|f| f.kind == FieldKind::Formula) else {
                return Err(wrong(
                    Diagnostic::error("missing-field", format!("`{name}` needs an expression"))
                        .at(end)
                        .expected("an expression in brackets: Formula area [length*beam];"),
                ));
            };
            return self.formula(written);
        }
        let slash = fields.iter().position(|f| f.kind == FieldKind::Slash);
        let numbers = |fields: &[Written]| -> Vec<f64> {
            let number = |f: &Written| match f.kind {
                FieldKind::Number(id) => Some(source.model()[id].value),
                _ => None,
            };
            fields.iter().filter_map(number).collect()
        };
        let mut data = numbers(slash.map_or(&fields[..], |at| &fields[at + 1..]));
        // Without a slash, colour and visibility may precede.
        if slash.is_none() && data.len() == 5 {
            data.drain(..2);
        }
        let (default, range) = match data[..] {
            [value] => (value, None),
            [value, low, high] if low <= high => (value, Some((low, high))),
            _ => {
                return Err(wrong(
                    Diagnostic::error("missing-field", format!("`{name}` needs a value"))
                        .at(end)
                        .expected("a value, or a value and its range: Variable beam 5 3 7;")
                        .found(format!("{} numbers", data.len())),
                ));
            }
        };
        let x = self.inputs.overrides.get(name).copied().unwrap_or(default);
        if let Some((low, high)) = range
            && !(low..=high).contains(&x)
        {
            return Err(wrong(
                Diagnostic::error("out-of-range", format!("`{name}` = {x} is out of its range"))
                    .at(line.name)
                    .expected(format!("a number from {low} to {high}"))
                    .found(x.to_string()),
            ));
        }
        let value = (self.inputs.seed)(name, T::from(x));
        self.env.params.push(Param {
            name: name.to_string(),
            value: value.re(),
            default,
            range,
            is_int: false,
            span: line.name,
        });
        self.env.param_values.push(value);
        Ok(value)
    }

    /// The value of `=name` or `[expression]`, in the names of the file.
    pub fn formula(&mut self, written: &Written) -> Result<T, Trouble> {
        let source = self.source;
        let spelled = source.written(written);
        for (_, word) in words(spelled) {
            let outcome = source.names.get(word).and_then(|&at| self.outcomes[at]);
            if let Some(Outcome::Missing(root)) = outcome {
                return Err(Trouble::Blocked { root, span: written.span });
            }
        }
        let bad = |message: String| {
            wrong(
                Diagnostic::error("bad-formula", format!("the formula `{spelled}`: {message}"))
                    .at(written.span)
                    .expected("a number computed from variables, formulas and objects above it"),
            )
        };
        let (program, expr, found) =
            moldloft_syntax::sdl::parse_expr(bare(spelled).to_string(), source.model().file());
        if let Some(first) = found.iter().find(|d| d.is_error()) {
            return Err(bad(first.message.clone()));
        }
        let modules = &mut *self.host.modules;
        let at = modules.add_expression(program, self.registry);
        let module = modules.get(at).clone();
        self.env.scope.globals.clear();
        self.env.scope.make_room(modules.name_count());
        for &name in &module.names {
            let Some(&line) = source.names.get(&**modules.text(name)) else { continue };
            let what = match self.outcomes[line] {
                Some(Outcome::Built(key)) => Binding::Object(key),
                Some(Outcome::Real) => Binding::variable(
                    moldloft_syntax::sdl::Type::Float,
                    Value::Number(self.reals[&line]),
                ),
                _ => continue,
            };
            self.env.scope.globals[name.0 as usize] =
                Some(ScopedBinding { span: Span::UNKNOWN, what });
        }
        let mut reported = Vec::new();
        let loader = crate::source::module::Loader {
            world: self.host.world,
            registry: self.registry,
            sources: &mut *self.host.sources,
            diagnostics: &mut reported,
            converted: self.host.converted,
        };
        let mut interpreter = crate::run::interpreter::Interpreter::new(
            modules,
            loader,
            &mut *self.run,
            &mut *self.env,
            self.inputs.again(),
        );
        interpreter.current = at;
        // Only deeply nested formulas need a stack of their own.
        let nests = spelled.bytes().filter(|b| b"([{^-!".contains(b)).count() > 8;
        let mut evaluate = || interpreter.operand(&module, expr);
        let value = if nests { crate::run::program::with_stack(evaluate) } else { evaluate() };
        drop(module);
        self.host.modules.remove_expression(at);
        self.env.scope.globals.clear();
        match value {
            Ok(Value::Number(x)) if x.is_finite() => Ok(x),
            Ok(other) => Err(bad(format!("it is {}, not a finite number", other.called()))),
            Err(diagnostic) if diagnostic.id == crate::run::interpreter::SILENT => {
                Err(bad("it depends on something that failed".into()))
            }
            Err(diagnostic) => Err(bad(diagnostic.message.clone())),
        }
    }
}
