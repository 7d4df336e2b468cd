//! Direct edits: parameters and literals of objects set to numbers, equivalent to an edit of the
//! text.

use crate::document::{Document, ObjectSource};
use crate::{degenerate, faired};
use moldloft_diag::{Diagnostic, Span};
use moldloft_lang::run::program;
use moldloft_lang::value::number_path::NumberPath;
use moldloft_model::{Applied, Extent};
use moldloft_registry::{Class, Value};

impl Document {
    /// Sets parameters and literals of objects (`P21.y`), all or none, and evaluates the objects
    /// that depend on them.
    ///
    /// # Errors
    /// The errors of the assignments; the model is unchanged.
    pub fn set(&mut self, assignments: &[(String, f64)]) -> Result<Applied, Vec<Diagnostic>> {
        self.complete()?;
        let before = self.overrides.clone();
        let mut edits = Vec::new();
        let mut errors = Vec::new();
        let mut rerun = false;
        for (name, value) in assignments {
            // Minus zero is written as zero.
            let value = &(value + 0.0);
            if self.params().iter().any(|p| p.name == *name) {
                if let Err(diagnostic) = self.check_param(name, *value) {
                    errors.push(diagnostic);
                }
                self.overrides.insert(name.clone(), *value);
                rerun = true;
            } else {
                match self.literal(name, *value).and_then(|edit| self.in_range(name, edit)) {
                    Ok(edit) => edits.push(edit),
                    Err(diagnostic) => errors.push(diagnostic),
                }
            }
        }
        if !errors.is_empty() {
            self.overrides = before;
            return Err(errors);
        }
        // Conditions of solve sets may have changed.
        rerun |= !self.solved.is_empty();
        for edit in &edits {
            rerun |= edit.within || self.must_rerun(edit);
        }
        for edit in &edits {
            self.write_literal(edit).map_err(|d| vec![d])?;
        }
        if rerun {
            return Ok(self.run());
        }
        self.edit(&edits);
        Ok(self.applied)
    }

    fn check_param(&self, name: &str, value: f64) -> Result<(), Diagnostic> {
        let Some(param) = self.params().iter().find(|p| p.name == name) else { return Ok(()) };
        let wrong = |expected: String| {
            Diagnostic::error("out-of-range", format!("`{name}` = {value} is out of its range"))
                .at(param.span)
                .expected(expected)
                .found(value.to_string())
        };
        if !value.is_finite() {
            return Err(wrong("a finite number".into()));
        }
        match param.range {
            Some((low, high)) if !(low..=high).contains(&value) => {
                Err(wrong(format!("a number from {low} to {high}")))
            }
            _ if param.is_int && value.fract() != 0.0 => Err(wrong("a whole number".into())),
            _ => Ok(()),
        }
    }

    /// The coefficients in the expression that defines `name` (`P21.y`), with the derivative of the
    /// expression with respect to each: numbers in which the expression or its reciprocal is
    /// linear, such as 5.046 in `5.046 * beam` and 2 in `beam / 2`.
    pub fn coefficients(&mut self, name: &str) -> Vec<LiteralCoefficient> {
        let Some((span, literals)) = self.literals_within(name) else { return Vec::new() };
        let program = &self.modules.get(0).program;
        let text = program.text().clone();
        let spans: Vec<(Span, f64)> =
            literals.iter().map(|l| (program[*l].span, program[*l].value)).collect();
        let spelled = |at: usize, x: f64| {
            let mut out = String::from("(");
            let mut from = span.start as usize;
            for (k, (s, value)) in spans.iter().enumerate() {
                out.push_str(&text[from..s.start as usize]);
                out.push_str(&format!("({:?})", if k == at { x } else { *value }));
                from = s.end as usize;
            }
            out.push_str(&text[from..span.end as usize]);
            out.push(')');
            out
        };
        let mut found = Vec::new();
        for (k, (s, value)) in spans.iter().enumerate() {
            let step = if *value == 0.0 { 1.0 } else { value.abs() / 4.0 };
            let mut at = |share: f64| match self.eval(&spelled(k, value + share * step)) {
                Ok(Value::Number(x)) => Some(x),
                _ => None,
            };
            let (Some(less), Some(now), Some(more)) = (at(-1.0), at(0.0), at(1.0)) else {
                continue;
            };
            let straight = |a: f64, b: f64, c: f64| {
                (a - 2.0 * b + c).abs() <= STRAIGHT * (a.abs() + b.abs() + c.abs())
            };
            let slope = if straight(less, now, more) {
                (more - less) / (2.0 * step)
            } else if straight(1.0 / less, 1.0 / now, 1.0 / more) {
                -now * now * (1.0 / more - 1.0 / less) / (2.0 * step)
            } else {
                continue;
            };
            if slope != 0.0 && slope.is_finite() {
                let name = format!("{name}#{}", k + 1);
                found.push(LiteralCoefficient { name, value: *value, slope, span: *s });
            }
        }
        found
    }

    /// Span of the expression that defines a number of an object, and the literals in it.
    fn literals_within(&self, name: &str) -> Option<(Span, Vec<moldloft_syntax::sdl::LiteralId>)> {
        if !matches!(self.source, ObjectSource::Program) {
            return None;
        }
        let (key, path) = self.number_path(name)?;
        let object = self.plain.graph.get(key)?;
        program::literals_within(&self.modules, &self.plain.env, object, &path)
    }

    /// The object and the argument that a name such as `P21.y` refers to.
    fn number_path(&self, name: &str) -> Option<(moldloft_num::trace::Key, NumberPath)> {
        let graph = &self.plain.graph;
        // Object names may contain dots: the longest match wins.
        let split = name.char_indices().rev().filter(|(_, c)| *c == '.').map(|(k, _)| k);
        let (key, path) =
            split.map(|k| name.split_at(k)).find_map(|(o, path)| Some((graph.find(o)?, path)))?;
        Some((key, NumberPath::parse(&graph.get(key)?.row, path)?))
    }

    /// The value and range of a number of an object, or of one in its expression.
    pub(crate) fn object_number(&self, name: &str) -> Option<(f64, Option<(f64, f64)>)> {
        if let Some((base, at)) = coefficient_name(name) {
            let (_, literals) = self.literals_within(base)?;
            return Some((self.modules.get(0).program[*literals.get(at)?].value, None));
        }
        let (key, path) = self.number_path(name)?;
        let object = self.plain.graph.get(key)?;
        let field = &object.row.fields[path.field];
        let range = field.min.zip(field.max).filter(|(a, b)| a.is_finite() && b.is_finite());
        let mut value = None;
        path.change(&mut object.args.clone(), |x| {
            value = Some(x);
            x
        })?;
        Some((value?, range))
    }

    /// The literal that `P21.y` refers to, or that in its expression which `P21.y#1` refers to.
    pub(crate) fn literal(&self, name: &str, value: f64) -> Result<LiteralEdit, Diagnostic> {
        if let Some((base, at)) = coefficient_name(name)
            && value.is_finite()
            && let Some((key, path)) = self.number_path(base)
            && let Some((_, literals)) = self.literals_within(base)
            && let Some(literal) = literals.get(at)
        {
            let place = LiteralPlace::Program((0, *literal));
            return Ok(LiteralEdit { key, path, place, value, within: true });
        }
        if !value.is_finite() {
            return Err(Diagnostic::error("not-finite", format!("`{name}` cannot be {value}"))
                .expected("a finite number")
                .found(value.to_string()));
        }
        let graph = &self.plain.graph;
        // Object names may contain dots: the longest match wins.
        let split = name.char_indices().rev().filter(|(_, c)| *c == '.').map(|(k, _)| k);
        let found =
            split.map(|k| name.split_at(k)).find_map(|(o, path)| Some((graph.find(o)?, path)));
        let Some((key, path)) = found else {
            let params = self.params().iter().map(|p| p.name.as_str());
            let objects = graph.objects().map(|o| o.name.as_ref());
            let stem = name.split('.').next().unwrap_or(name);
            return Err(Diagnostic::error(
                "unknown-name",
                format!("no parameter or number named `{name}`"),
            )
            .expected("a parameter, or a number of an object such as P21.y")
            .suggest(stem, params.chain(objects)));
        };
        let object = graph.get(key).expect("found above");
        let fields = || object.row.fields.iter().map(|f| f.name).collect::<Vec<_>>().join(", ");
        let Some(path) = NumberPath::parse(&object.row, path) else {
            return Err(Diagnostic::error(
                "unknown-member",
                format!("{} `{}` has no number `{}`", object.row.name, object.name, &path[1..]),
            )
            .expected(fields()));
        };
        let mut args = object.args.clone();
        if path.change(&mut args, |_| value).is_none() {
            return Err(Diagnostic::error("not-a-number", format!("`{name}` is not a number"))
                .help(
                    "only numbers can be set; edit the text to change the parents of an object",
                ));
        }
        if let Some(sketch) = self.plain.env.sketches.iter().find(|s| {
            object.name.strip_prefix(s.as_str()).is_some_and(|rest| rest.starts_with('.'))
        }) {
            let start = format!("{sketch}.");
            let params = self.params().iter().filter(|p| p.name.starts_with(&start));
            let params: Vec<&str> = params.map(|p| p.name.as_str()).collect();
            return Err(Diagnostic::error(
                "not-a-literal",
                format!("`{name}` follows from the dimensions of the sketch"),
            )
            .help(format!("set a dimension: {}", params.join(", "))));
        }
        let place = match &self.source {
            ObjectSource::Program | ObjectSource::Sketch(_) => {
                program::literal(&self.modules, &self.plain.env, object, &path)
                    .map(LiteralPlace::Program)
            }
            ObjectSource::ModelFile(source) => {
                source.literal(object, &path).map(LiteralPlace::ModelFile)
            }
            ObjectSource::None => unreachable!("there are objects"),
        };
        let place = place.map_err(|why| self.not_literal(name, why))?;
        Ok(LiteralEdit { key, path, place, value, within: false })
    }

    /// The edit, if a run of the edited text would accept the number.
    fn in_range(&self, name: &str, edit: LiteralEdit) -> Result<LiteralEdit, Diagnostic> {
        if edit.within {
            return Ok(edit);
        }
        let object = self.plain.graph.get(edit.key).expect("the object of an edit");
        if let LiteralPlace::Program((module, _)) = edit.place
            && module != 0
        {
            let file = &self.modules.get(module).path;
            return Err(Diagnostic::error("not-here", format!("`{name}` cannot be set here"))
                .found(format!("a number in the loaded file `{file}`"))
                .help("edit that file, or make the number a parameter of this one"));
        }
        let (field, x) = (&object.row.fields[edit.path.field], edit.value);
        let low = field.min.unwrap_or(f64::NEG_INFINITY);
        let high = field.max.unwrap_or(f64::INFINITY);
        let whole = field.class != Class::Integer || x.fract() == 0.0;
        if whole && (low..=high).contains(&x) {
            return Ok(edit);
        }
        let kind = if field.class == Class::Integer { "a whole number" } else { "a number" };
        Err(Diagnostic::error("out-of-range", format!("`{name}` = {x} is out of range"))
            .expected(format!("{kind} from {low} to {high}"))
            .found(x.to_string()))
    }

    fn not_literal(&self, name: &str, why: program::NotLiteral) -> Diagnostic {
        match why {
            program::NotLiteral::Expression { span, names } => {
                let params: Vec<&str> = self
                    .params()
                    .iter()
                    .map(|p| p.name.as_str())
                    .filter(|p| names.iter().any(|n| n == p))
                    .collect();
                let diagnostic = Diagnostic::error(
                    "not-a-literal",
                    format!("`{name}` is given by an expression and cannot be set"),
                )
                .at(span)
                .expected("a literal number");
                if params.is_empty() {
                    diagnostic.help("edit the expression")
                } else {
                    diagnostic.help(format!("set its parameters: {}", params.join(", ")))
                }
            }
            program::NotLiteral::Shared { span } => Diagnostic::error(
                "not-a-literal",
                format!("`{name}` shares its number with other objects made by the same statement"),
            )
            .at(span)
            .help("edit the text, or make the number a parameter"),
            program::NotLiteral::Default => Diagnostic::error(
                "not-a-literal",
                format!("`{name}` is not written in the text: it is a default"),
            )
            .help("write it in the text first"),
        }
    }

    fn must_rerun(&self, edit: &LiteralEdit) -> bool {
        let graph = &self.plain.graph;
        let read = |key| graph.get(key).is_some_and(|o| o.read_by_program);
        read(edit.key) || (graph.any_read() && graph.dependents(edit.key).into_iter().any(read))
    }

    fn write_literal(&mut self, edit: &LiteralEdit) -> Result<(), Diagnostic> {
        match (&edit.place, &mut self.source) {
            (LiteralPlace::Program((module, literal)), _) => {
                self.modules.get_mut(*module).program.set_literal(*literal, edit.value)
            }
            (LiteralPlace::ModelFile(number), ObjectSource::ModelFile(source)) => {
                source.set(*number, edit.value)
            }
            _ => Ok(()),
        }
    }

    /// The direct edit: the same change as a run with the new literals would make.
    fn edit(&mut self, edits: &[LiteralEdit]) {
        let failed = self.plain.graph.failed();
        let remarked = self.plain.graph.remarked();
        let ((), applied) = self.plain.graph.apply(Extent::Edit, |run| {
            for edit in edits {
                let Some(object) = run.graph().get(edit.key) else { continue };
                let mut args = object.args.clone();
                if edit.path.change(&mut args, |_| edit.value).is_some() {
                    // The parents are unchanged, so there is no cycle.
                    let _ = run.set_args(edit.key, args);
                }
            }
        });
        self.applied = applied;
        if failed > 0 || applied.failed > 0 || remarked > 0 || self.plain.graph.remarked() > 0 {
            let evaluation = std::mem::take(&mut self.plain);
            self.run_diagnostics.retain(|d| d.object.is_none());
            let failures = self.failures(&evaluation);
            self.run_diagnostics.extend(failures);
            let remarks = self.remarks(&evaluation);
            self.run_diagnostics.extend(remarks);
            self.plain = evaluation;
        }
        let evaluation = std::mem::take(&mut self.plain);
        let own = |id: &str| degenerate::IDS.contains(&id) || faired::IDS.contains(&id);
        self.run_diagnostics.retain(|d| !own(&d.id));
        let degeneracies = self.degeneracies(&evaluation);
        self.run_diagnostics.extend(degeneracies);
        self.plain = evaluation;
    }
}

/// A coefficient in the expression of a number, such as 5.046 in `y = 5.046 * beam`.
#[derive(Clone, Debug, PartialEq)]
pub struct LiteralCoefficient {
    /// Its name: that of the number, `#`, and its index in the expression from 1, as in `P21.y#1`.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Derivative of the expression with respect to it.
    pub slope: f64,
    /// Its position in the text.
    pub span: Span,
}

/// Second differences, relative to the values, that are rounding.
const STRAIGHT: f64 = 1e-12;

/// `P21.y#1` is the first number in the expression of `P21.y`.
pub(crate) fn coefficient_name(name: &str) -> Option<(&str, usize)> {
    let (base, at) = name.rsplit_once('#')?;
    Some((base, at.parse::<usize>().ok()?.checked_sub(1)?))
}

/// A change of one number in the text.
pub(crate) struct LiteralEdit {
    pub key: moldloft_num::trace::Key,
    pub path: NumberPath,
    pub place: LiteralPlace,
    pub value: f64,
    /// True for a number in the expression of an argument.
    pub within: bool,
}

/// Position of a number.
pub(crate) enum LiteralPlace {
    Program((usize, moldloft_syntax::sdl::LiteralId)),
    ModelFile(moldloft_lang::model_file::ModelNumber),
}
