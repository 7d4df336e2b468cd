//! Positions of objects and numbers in the text, for interactive changes.

use crate::document::{Document, ObjectSource};
use moldloft_diag::{Diagnostic, Span};
use moldloft_lang::run::program::{self, ArgumentInText};
use moldloft_syntax::sdl::StmtKind;

impl Document {
    /// Span of the name of an object in its declaration, in whichever text that is.
    pub fn declaration(&self, name: &str) -> Option<Span> {
        let graph = self.graph();
        self.declared_at(&self.plain, graph.get(graph.find(name)?)?)
    }

    /// Position of an argument of an object in the main text, or where it can be inserted; `None`
    /// for model files and for objects declared with others in one statement.
    pub fn argument_place(&self, object: &str, field: &str) -> Option<ArgumentInText> {
        if !matches!(self.source, ObjectSource::Program) {
            return None;
        }
        let graph = self.graph();
        let object = graph.get(graph.find(object)?)?;
        let field = object.row.field(field)?;
        program::argument_place(&self.modules, &self.plain.env, object, field)
    }

    /// Succeeds when [`Document::set`] can change the number of an object, such as `P21.y`.
    ///
    /// # Errors
    /// The reason, and an alternative to set.
    pub fn settable(&self, name: &str) -> Result<(), Diagnostic> {
        self.literal(name, 0.0).map(drop)
    }

    /// True when the text states the value of a parameter as a number.
    pub fn param_is_number(&self, name: &str) -> bool {
        self.param_literal(name).is_some()
    }

    /// Writes changed values of parameters into the text where it states them as numbers; other
    /// parameters keep the values that were set. Returns the names of the written and the other
    /// parameters.
    pub fn write_params(&mut self) -> (Vec<String>, Vec<String>) {
        let set: Vec<(String, f64)> = self.overrides.iter().map(|(n, x)| (n.clone(), *x)).collect();
        let (mut written, mut kept) = (Vec::new(), Vec::new());
        for (name, value) in set {
            let Some(literal) = self.param_literal(&name) else {
                kept.push(name);
                continue;
            };
            if self.modules.get_mut(0).program.set_literal(literal, value).is_ok() {
                self.overrides.shift_remove(&name);
                written.push(name);
            }
        }
        (written, kept)
    }

    /// Resets all parameters except `but` to the values of the text, from the next run on.
    pub fn forget_params(&mut self, but: &[String]) {
        self.overrides.retain(|name, _| but.contains(name));
    }

    fn param_literal(&self, name: &str) -> Option<moldloft_syntax::sdl::LiteralId> {
        if !matches!(self.source, ObjectSource::Program) {
            return None;
        }
        let param = self.params().iter().find(|p| p.name == name)?;
        let program = &self.modules.get(0).program;
        if param.span.file != program.file() {
            return None;
        }
        program[program.body()].iter().find_map(|&stmt| match program[stmt].kind {
            StmtKind::Param { name: ident, value, .. } if program.name(ident.symbol) == name => {
                program.as_literal(value)
            }
            _ => None,
        })
    }
}
