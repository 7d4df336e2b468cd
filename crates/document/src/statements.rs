//! Statements of the text: inserted, copied, moved.

use crate::document::{Document, ObjectSource};
use moldloft_diag::{Diagnostic, FileId, Severity};
use moldloft_syntax::sdl::{self, StmtId, StmtKind};
use std::ops::Range;

impl Document {
    /// Inserts a statement after the last statement of its kind and after those that it depends on,
    /// or at the end.
    ///
    /// # Errors
    /// If it is not a statement, its object fails, or its name is taken; the model is then
    /// unchanged.
    pub fn add(&mut self, statement: &str) -> Result<(), Diagnostic> {
        let statement = statement.trim();
        let (parsed, faults) = sdl::parse(statement.to_string(), FileId(0));
        if let Some(fault) = faults.into_iter().next() {
            return Err(Diagnostic::error("not-a-statement", fault.message.clone()));
        }
        let made: Vec<StmtId> = parsed[parsed.body()].to_vec();
        let named = |id: &StmtId| match parsed[*id].kind {
            StmtKind::Object { kind, name, .. } => {
                Some((Some(parsed.name(kind.symbol)), parsed.name(name.symbol)))
            }
            StmtKind::Param { name, .. } => Some((None, parsed.name(name.symbol))),
            _ => None,
        };
        let [Some((kind, name))] = made.iter().map(named).collect::<Vec<_>>()[..] else {
            return Err(Diagnostic::error(
                "not-a-statement",
                "one object or parameter is added at a time",
            )
            .expected("a statement such as `AbsPoint P(1, 2, 3);`")
            .found(statement.to_string()));
        };
        if !matches!(self.source, ObjectSource::Program | ObjectSource::None) {
            return Err(Diagnostic::error("not-here", "objects are added to programs only")
                .help("convert the model to a program (`moldloft convert`)"));
        }
        let before = self.text();
        if self.is_taken(name) {
            return Err(Diagnostic::error("duplicate-name", format!("`{name}` is used already"))
                .help("choose another name"));
        }
        if self.modules.get(0).program.is_edited() {
            self.set_text(&before);
        }
        let text = self.with(statement, kind, name);
        self.set_text(&text);
        let fault = match self.graph().find(name).and_then(|key| self.graph().get(key)) {
            Some(object) => object.fault().map(|f| f.message.to_string()),
            None if kind.is_some() => {
                let said = self.diagnostics().first().map(|d| d.message.clone());
                Some(said.unwrap_or_else(|| format!("the program does not come to `{name}`")))
            }
            None => None,
        };
        if let Some(why) = fault {
            self.set_text(&before);
            return Err(Diagnostic::error("cannot-add", why));
        }
        Ok(())
    }

    /// Copies the statement of an object, after it and under a new name; returns the name.
    ///
    /// # Errors
    /// If the statement declares other objects as well, or is in another file.
    pub fn duplicate(&mut self, name: &str) -> Result<String, Diagnostic> {
        let (stmt, _) = self.sole_statement(name)?;
        if self.modules.get(0).program.is_edited() {
            let text = self.text();
            self.set_text(&text);
            return self.duplicate(name);
        }
        let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let new = (1..)
            .map(|k| format!("{stem}{k}"))
            .find(|n| !self.is_taken(n))
            .expect("there are more numbers than names");
        let (_, at) = self.sole_statement(name)?;
        let program = &self.modules.get(0).program;
        let span = program[stmt].span;
        let mut text = program.text().to_string();
        let (from, to) = (span.start as usize, span.end as usize);
        let copy = format!("{}{new}{}", &text[from..at.start as usize], &text[at.end as usize..to]);
        insert_behind(&mut text, to, &copy);
        self.set_text(&text);
        Ok(new)
    }

    /// Moves the statement of an object before that of another one, or behind it, with the comment
    /// that ends its line.
    ///
    /// # Errors
    /// If one of them is not a statement of its own at the top level of the text, or if the program
    /// then has a new error, such as a name that is read before it is declared; the model is then
    /// unchanged.
    pub fn reorder(&mut self, name: &str, beside: &str, behind: bool) -> Result<(), Diagnostic> {
        let (moved, _) = self.sole_statement(name)?;
        let (target, _) = self.sole_statement(beside)?;
        if moved == target {
            return Ok(());
        }
        if self.modules.get(0).program.is_edited() {
            let text = self.text();
            self.set_text(&text);
            return self.reorder(name, beside, behind);
        }
        let program = &self.modules.get(0).program;
        for (one, id) in [(name, moved), (beside, target)] {
            if !program[program.body()].contains(&id) {
                let why = format!("`{one}` cannot be moved, nor another statement beside it");
                return Err(Diagnostic::error("not-here", why)
                    .at(program[id].span)
                    .found("its statement is inside another one".to_string())
                    .help("edit the text"));
            }
        }
        let before = program.text().to_string();
        let errors = |document: &Self| -> Vec<Diagnostic> {
            let all = document.diagnostics().into_iter();
            all.filter(|d| d.severity == Severity::Error).collect()
        };
        let known: Vec<String> = errors(self).into_iter().map(|d| d.message.clone()).collect();
        let text = moved_beside(
            &before,
            program[moved].span.range(),
            program[target].span.range(),
            behind,
        );
        if text.trim_end() == before.trim_end() {
            return Ok(());
        }
        self.set_text(&text);
        if let Some(new) = errors(self).into_iter().find(|d| !known.contains(&d.message)) {
            self.set_text(&before);
            return Err(Diagnostic::error("not-here", format!("`{name}` cannot be moved there"))
                .found(new.message.clone())
                .help("a statement comes after those that it reads"));
        }
        Ok(())
    }

    fn is_taken(&self, name: &str) -> bool {
        let program = &self.modules.get(0).program;
        self.registry.get(name).is_some()
            || self.graph().find(name).is_some()
            || program.symbol(name).is_some()
    }

    /// The text with the statement inserted.
    fn with(&self, statement: &str, kind: Option<&str>, name: &str) -> String {
        let program = &self.modules.get(0).program;
        let mut text = program.text().to_string();
        let word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let read = statement.split_once(name).map_or("", |(_, rest)| rest);
        let words: Vec<&str> =
            read.split(|c| !word(c)).filter(|w| !w.is_empty() && *w != "in").collect();
        let behind = program[program.body()].iter().rev().find(|id| match program[**id].kind {
            StmtKind::Object { kind: k, name, .. } => {
                kind == Some(program.name(k.symbol)) || words.contains(&program.name(name.symbol))
            }
            StmtKind::Param { name, .. } => {
                kind.is_none() || words.contains(&program.name(name.symbol))
            }
            // The header stays first.
            _ => {
                let inside = program[**id].span.range();
                text[inside].split(|c| !word(c)).any(|w| words.contains(&w))
            }
        });
        match behind {
            Some(id) => insert_behind(&mut text, program[*id].span.end as usize, statement),
            // Parameters come before their uses.
            None if kind.is_none() => {
                let first = program[program.body()].iter().find(|id| {
                    !matches!(program[**id].kind, StmtKind::Object { kind, .. } if program.name(kind.symbol) == "Model")
                });
                match first {
                    Some(id) => {
                        let at = program[*id].span.start as usize;
                        let line = text[..at].rfind('\n').map_or(0, |k| k + 1);
                        text.insert_str(line, &format!("{statement}\n"));
                    }
                    None => append(&mut text, statement),
                }
            }
            None => append(&mut text, statement),
        }
        text
    }
}

/// The text with one statement moved beside another. One that has its lines for itself takes them
/// along, with the comment that ends them.
fn moved_beside(text: &str, moved: Range<usize>, target: Range<usize>, behind: bool) -> String {
    let line_start = |at: usize| text[..at].rfind('\n').map_or(0, |k| k + 1);
    let line_end = |at: usize| text[at..].find('\n').map_or(text.len(), |k| at + k);
    let begins = |at: usize| text[line_start(at)..at].trim().is_empty();
    let ends = |at: usize| {
        let rest = text[at..line_end(at)].trim_start();
        rest.is_empty() || rest.starts_with('#')
    };
    let whole = begins(moved.start) && ends(moved.end);
    let (taken, cut) = if whole {
        let lines = line_start(moved.start)..line_end(moved.end);
        (&text[lines.clone()], lines.start..(lines.end + 1).min(text.len()))
    } else if ends(moved.end) {
        // Without the blanks that separate it from what is before it.
        let before = text[..moved.start].trim_end_matches([' ', '\t']).len();
        (&text[moved.clone()], before..moved.end)
    } else {
        let rest = &text[moved.end..];
        let blank = rest.len() - rest.trim_start_matches([' ', '\t']).len();
        (&text[moved.clone()], moved.start..moved.end + blank)
    };
    let (at, put) = match behind {
        false if begins(target.start) => (line_start(target.start), format!("{taken}\n")),
        true if ends(target.end) => (line_end(target.end), format!("\n{taken}")),
        // Inside of a line, of which a comment would swallow the rest.
        _ if whole => (if behind { target.end } else { target.start }, format!("\n{taken}\n")),
        false => (target.start, format!("{taken} ")),
        true => (target.end, format!(" {taken}")),
    };
    if at <= cut.start {
        [&text[..at], &put, &text[at..cut.start], &text[cut.end..]].concat()
    } else {
        [&text[..cut.start], &text[cut.end..at.max(cut.end)], &put, &text[at.max(cut.end)..]]
            .concat()
    }
}

/// Inserts the statement on a line of its own if the previous statement ends its line.
fn insert_behind(text: &mut String, at: usize, statement: &str) {
    let line = text[at..].find('\n').map_or(text.len(), |k| at + k);
    let rest = text[at..line].trim_start();
    if rest.is_empty() || rest.starts_with('#') {
        text.insert_str(line, &format!("\n{statement}"));
    } else {
        text.insert_str(at, &format!(" {statement}"));
    }
}

fn append(text: &mut String, statement: &str) {
    if !text.is_empty() && !text.ends_with('\n') {
        text.push('\n');
    }
    text.push_str(statement);
    text.push('\n');
}
