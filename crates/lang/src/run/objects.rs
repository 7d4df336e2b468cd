//! Runs a program: declarations of objects, and the names they get.

use crate::run::inserted::{Content, inserted_file};
use crate::run::interpreter::{Interpreter, silent};
use crate::run::tables;
use crate::source::env::DeclarationOrigin;
use crate::source::fault_location;
use crate::source::module::{Module, RoutineAt};
use crate::source::scope::{Binding, ScopedBinding};
use moldloft_diag::{Diagnostic, Span};
use moldloft_model::{Declaration, Extent};
use moldloft_num::trace::Key;
use moldloft_registry::{Class, FieldSpec, Given, Role, Row, Scalar, Value, bind_arguments};
use moldloft_syntax::number;
use moldloft_syntax::sdl::{Arg, Ident, NodeList, StmtId};
use std::sync::Arc;

impl<T: Scalar> Interpreter<'_, '_, T> {
    pub fn object(
        &mut self,
        m: &Module,
        id: StmtId,
        kind: Ident,
        name: Ident,
        args: NodeList<Arg>,
        span: Span,
    ) -> Result<(), Diagnostic> {
        if self.env.scope.is_given(m.names[name.symbol.0 as usize]) {
            return Ok(());
        }
        let outcome = self.object_of(m, id, kind, name, args, span);
        if outcome.is_err() {
            self.poison(m, name);
        }
        outcome
    }

    fn object_of(
        &mut self,
        m: &Module,
        id: StmtId,
        kind: Ident,
        name: Ident,
        args: NodeList<Arg>,
        span: Span,
    ) -> Result<(), Diagnostic> {
        let name_id = m.names[name.symbol.0 as usize];
        let word = m.program.name(kind.symbol);
        let row = match &m.rows[kind.symbol.0 as usize] {
            // The header of a file does not concern a program that inserts it.
            Some(row) if row.role == Role::Header && !self.components.is_empty() => return Ok(()),
            Some(row) if row.kind => row,
            other => {
                if let Some(&routine) =
                    self.env.scope.routines.get(&m.names[kind.symbol.0 as usize])
                {
                    return self.instance(m, routine, name, args, span);
                }
                if let Some(row) = inserted_file(word) {
                    return match row.content {
                        Content::Component => self.component(m, name, args, span),
                        Content::Sketch => self.sketch_object(m, id, name, args, span),
                    };
                }
                if other.is_some() {
                    return Err(Diagnostic::error(
                        "not-a-kind",
                        format!("`{word}` is a function, not a kind of object"),
                    )
                    .at(kind.span)
                    .help(format!("call it in an expression: curve x = {word}(...);")));
                }
                return Err(self.unknown_kind(word).at(kind.span));
            }
        };
        let mut given = Given { positional: Vec::with_capacity(args.len()), named: Vec::new() };
        let mut failed = None;
        for arg in &m.program[args] {
            match (self.expr(m, arg.value), arg.name) {
                (Ok(value), None) => given.positional.push(value),
                (Ok(value), Some(ident)) => {
                    given.named.push((m.program.name(ident.symbol), value));
                }
                // Continue: the other arguments may have errors too.
                (Err(diagnostic), _) => {
                    let shown = diagnostic.or_at(m.program[arg.value].span);
                    if let Some(earlier) = failed.replace(shown) {
                        self.report(earlier);
                    }
                }
            }
        }
        if let Some(diagnostic) = failed {
            return Err(diagnostic);
        }
        let positional = given.positional.len();
        spread_last_vector(row, &mut given);
        let (mut filled, head) = bind_arguments(row, given, |key| self.run.class_of(key))
            .map_err(|fault| fault_location::diagnostic(m, args, row, positional, &fault, span))
            .map_err(|diagnostic| self.with_parent(m, diagnostic))?;
        if row.role == Role::Table {
            let from = self.modules.get(0).path.clone();
            let files = &self.env.files;
            tables::fill(files, self.loader.world, &from, row, &mut filled).map_err(
                |(field, fault)| {
                    let given =
                        fault_location::argument(m, &m.program[args], row, positional, field);
                    fault.or_at(given.map_or(span, |expr| m.program[expr].span))
                },
            )?;
        }

        if self.run.extent() == Extent::Edit {
            return Err(Diagnostic::error("misplaced-object", "an expression declares no objects")
                .at(name.span)
                .help("call a function that declares none, or declare them in the text"));
        }
        let (full, turn) = self.full_name(m, name)?;
        if turn.is_none() {
            self.check_free(name_id, name.span, false)?;
        }
        let full = full.as_deref().unwrap_or_else(|| m.program.name(name.symbol));
        if !self.inputs.seeded_objects.is_empty() && self.inputs.seeded_objects.contains(full) {
            let seed = self.inputs.seed;
            crate::value::number_path::seed(row, &mut filled, full, seed);
        }
        if row.role == Role::SolveSet {
            self.solve_set(m, args, row, positional, &mut filled, full, name.span)?;
        }
        let origin = self.env.origins.len() as u32;
        let declaration = Declaration { name: full, row, args: filled, head, origin };
        let key = self.run.declare(declaration).map_err(|fault| {
            if fault.id == "too-many-objects" {
                let diagnostic = fault_location::unplaced(&fault).at(name.span);
                self.stop(diagnostic);
                return silent();
            }
            let diagnostic = fault_location::unplaced(&fault).at(name.span);
            let first = self.run.find(full).and_then(|key| self.run.graph().get(key));
            match first.and_then(|o| crate::run::program::declared_at(self.modules, self.env, o)) {
                Some(first) => diagnostic.note_at(first, "first declared here"),
                None => diagnostic,
            }
        })?;
        let frame = self.env.scope.frame();
        let repeated = !frame.global || !frame.loops.is_empty() || !frame.prefix.is_empty();
        self.env.origins.push(DeclarationOrigin {
            module: self.current as u32,
            stmt: id,
            repeated,
        });
        let what = match turn {
            None => Binding::Object(key),
            Some((family, turn)) => Binding::Turn { now: key, turn, family },
        };
        self.enter_families(full, key);
        self.env.scope.bind(name_id, name.span, what);
        Ok(())
    }

    /// Points to the declaration of a parent of the wrong class as well.
    fn with_parent(&self, m: &Module, diagnostic: Diagnostic) -> Diagnostic {
        let text = m.program.slice(diagnostic.span());
        let symbol = m.program.symbol(text).filter(|_| diagnostic.id == "wrong-class");
        match symbol.and_then(|symbol| self.env.scope.lookup(m.names[symbol.0 as usize])) {
            Some(ScopedBinding { span, what: Binding::Object(_) }) => {
                diagnostic.note_at(*span, format!("`{text}` is declared here"))
            }
            _ => diagnostic,
        }
    }

    /// The name of an object, when it differs from the one written: with the call it is made in
    /// and the values of the loop variables; and in loops the family and the turn.
    #[allow(clippy::type_complexity)]
    pub fn full_name(
        &mut self,
        m: &Module,
        name: Ident,
    ) -> Result<(Option<String>, Option<(Arc<str>, u64)>), Diagnostic> {
        let text = m.program.name(name.symbol);
        let frame = self.env.scope.frame();
        let family =
            if frame.prefix.is_empty() { None } else { Some(format!("{}{text}", frame.prefix)) };
        let Some(turn) = frame.loops.last() else { return Ok((family, None)) };
        let family: Arc<str> = family.as_deref().unwrap_or(text).into();
        let mut labels = Vec::new();
        for turn in &frame.loops {
            let Some(label) = &turn.label else {
                return Err(Diagnostic::error(
                    "no-loop-variable",
                    "an object in a loop takes its name from the loop variable, and this loop has \
                     none",
                )
                .at(name.span)
                .help("use `for (i = 1:n)`"));
            };
            labels.push(number::plain(*label));
        }
        Ok((Some(format!("{family}[{}]", labels.join(","))), Some((family, turn.id))))
    }

    /// Adds an object to its families.
    fn enter_families(&mut self, full: &str, key: Key) {
        if let Some((family, _)) = full.rsplit_once('[')
            && full.ends_with(']')
        {
            match self.env.families.get_mut(family) {
                Some(keys) => keys.push(key),
                None => drop(self.env.families.insert(family.into(), vec![key])),
            }
        }
    }

    /// A named call of a subroutine: `leg fore(...)`.
    fn instance(
        &mut self,
        m: &Module,
        routine: RoutineAt,
        name: Ident,
        args: NodeList<Arg>,
        span: Span,
    ) -> Result<(), Diagnostic> {
        let full = self.instance_name(m, name)?;
        let prefix: Arc<str> = format!("{full}.").into();
        self.call_routine(m, routine, args, Some(prefix), span)?;
        Ok(())
    }

    /// Makes `name` a group of objects; returns the prefix of their names.
    pub fn instance_name(&mut self, m: &Module, name: Ident) -> Result<Arc<str>, Diagnostic> {
        let name_id = m.names[name.symbol.0 as usize];
        let (full, turn) = self.full_name(m, name)?;
        if turn.is_none() {
            self.check_free(name_id, name.span, false)?;
        }
        let full: Arc<str> = match full {
            Some(full) => full.into(),
            None => m.program.name(name.symbol).into(),
        };
        let family = match turn {
            Some((family, _)) => family,
            None => full.clone(),
        };
        self.env.scope.bind(name_id, name.span, Binding::Instance(family));
        Ok(full)
    }
}

/// A vector given last in place of three coordinates: `AbsPoint M(0.5*(A + B))`, `RelPoint P(A, {1, 0, 2})`.
fn spread_last_vector<T: Scalar>(row: &Row, given: &mut Given<T>) {
    let Some(at) = given.positional.len().checked_sub(1) else { return };
    let Some(Value::Vector(v)) = given.positional.last().cloned() else { return };
    let Some([x, y, z]) = row.fields.get(at..at + 3) else { return };
    let coordinate = |field: &FieldSpec, axis: char| {
        field.class == Class::Number && !field.many && field.name.ends_with(axis)
    };
    if coordinate(x, 'x') && coordinate(y, 'y') && coordinate(z, 'z') {
        given.positional.truncate(at);
        given.positional.extend(v.to_array().map(Value::Number));
    }
}
