//! Deleting and renaming objects, in the text and in the model.

use crate::document::{Document, ObjectSource};
use moldloft_diag::{Diagnostic, FileId, Span};
use moldloft_lang::source::module::Module;
use moldloft_model::Applied;
use moldloft_syntax::sdl::{self, ExprId, ExprKind, StmtId, StmtKind, Symbol};

impl Document {
    /// Deletes an object without dependents, and its statement.
    ///
    /// # Errors
    /// If there is no such object, other objects or expressions depend on it, or its statement
    /// declares other objects as well.
    pub fn delete(&mut self, name: &str) -> Result<Applied, Diagnostic> {
        if matches!(self.source, ObjectSource::ModelFile(_)) {
            return self.delete_line(name);
        }
        let (stmt, span) = self.sole_statement(name)?;
        let graph = self.graph();
        // A component or a named subroutine call is not an object.
        let object = graph.find(name).and_then(|key| graph.get(key));
        if let Some(object) = object.filter(|o| !o.children.is_empty()) {
            let names: Vec<_> = object.children.iter().filter_map(|&c| graph.get(c)).collect();
            let mut shown: Vec<_> = names.iter().take(5).map(|o| o.name.to_string()).collect();
            if names.len() > shown.len() {
                shown.push(format!("{} more", names.len() - shown.len()));
            }
            return Err(Diagnostic::error("has-dependents", format!("`{name}` cannot be deleted"))
                .at(span)
                .found(format!("built on it: {}", shown.join(", ")))
                .help("delete or rebuild those first"));
        }
        let m = self.modules.get(0);
        let symbol = m.program.symbol(name).expect("it stands in the text");
        if let Some(used) = uses(m, symbol).into_iter().next() {
            return Err(Diagnostic::error("has-dependents", format!("`{name}` cannot be deleted"))
                .at(span)
                .note_at(used, "it is used here"));
        }
        let whole = m.program[stmt].span;
        let mut text = m.program.text_with_edits();
        if m.program.is_edited() {
            // Edited numbers have moved positions: run the current text and search again.
            self.set_text(&text);
            return self.delete(name);
        }
        let mut end = whole.end as usize;
        let rest = &text[end..];
        let blank = rest.len() - rest.trim_start_matches([' ', '\t']).len();
        if rest[blank..].starts_with('\n') {
            end += blank + 1;
        }
        text.replace_range(whole.start as usize..end, "");
        Ok(self.set_text(&text))
    }

    /// Renames an object everywhere in the text.
    ///
    /// # Errors
    /// If there is no such object, the new name is taken or invalid, or the old name has another
    /// meaning as well.
    pub fn rename(&mut self, old: &str, new: &str) -> Result<Applied, Diagnostic> {
        if matches!(self.source, ObjectSource::ModelFile(_)) {
            return self.rename_line(old, new);
        }
        let (_, span) = self.sole_statement(old)?;
        let word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let head = new.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        // A reserved word cannot be declared.
        let declared = || sdl::parse(format!("float {new};"), FileId(0)).1.is_empty();
        if !head || !new.chars().all(word) || !declared() {
            return Err(Diagnostic::error("not-a-name", format!("`{new}` is not a valid name"))
                .expected("a letter, then letters, digits and _, and no reserved word"));
        }
        let m = self.modules.get(0);
        if m.program.is_edited() {
            let text = m.program.text_with_edits();
            self.set_text(&text);
            return self.rename(old, new);
        }
        let known = self.registry.get(new).is_some() || m.program.symbol(new).is_some();
        if known || self.graph().find(new).is_some() {
            return Err(Diagnostic::error("duplicate-name", format!("`{new}` is used already"))
                .at(span)
                .help("choose another name"));
        }
        let symbol = m.program.symbol(old).expect("it stands in the text");
        if let Some(other) = other_meaning(m, symbol) {
            return Err(Diagnostic::error(
                "two-meanings",
                format!("`{old}` names something else as well"),
            )
            .at(span)
            .note_at(other, "here")
            .help("rename that first"));
        }
        let mut places = uses(m, symbol);
        places.push(span);
        places.sort_unstable_by_key(|s| s.start);
        let mut text = m.program.text().to_string();
        for place in places.into_iter().rev() {
            text.replace_range(place.range(), new);
        }
        Ok(self.set_text(&text))
    }

    /// Writes edited numbers into the text of a model file, so that positions refer to that text.
    fn settle_model_file(&mut self) {
        if let ObjectSource::ModelFile(source) = &self.source
            && source.model().is_edited()
        {
            let text = source.text();
            self.set_text(&text);
        }
    }

    fn delete_line(&mut self, name: &str) -> Result<Applied, Diagnostic> {
        self.settle_model_file();
        let ObjectSource::ModelFile(source) = &self.source else { return Ok(self.applied()) };
        let Some(line) = source.line(name) else { return Err(self.no_object(name)) };
        let mentions = source.mentions(&self.registry, name);
        if !mentions.is_empty() {
            let mut users: Vec<&str> = Vec::new();
            for (at, _) in &mentions {
                let user = source.model().slice(source.lines()[*at].name);
                if users.last() != Some(&user) {
                    users.push(user);
                }
            }
            let more = users.len().saturating_sub(5);
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            let shown = users[..users.len().min(5)].join(", ");
            return Err(Diagnostic::error("has-dependents", format!("`{name}` cannot be deleted"))
                .at(line.name)
                .found(format!("built on it: {shown}{more}"))
                .note_at(mentions[0].1, "it is used here")
                .help("delete or rebuild those first"));
        }
        let mut text = source.model().text().to_string();
        let mut end = line.span.end as usize;
        let rest = &text[end..];
        let blank = rest.len() - rest.trim_start_matches([' ', '\t', '\r']).len();
        if rest[blank..].starts_with('\n') {
            end += blank + 1;
        }
        text.replace_range(line.span.start as usize..end, "");
        Ok(self.set_text(&text))
    }

    fn rename_line(&mut self, old: &str, new: &str) -> Result<Applied, Diagnostic> {
        self.settle_model_file();
        let ObjectSource::ModelFile(source) = &self.source else { return Ok(self.applied()) };
        let Some(line) = source.line(old) else { return Err(self.no_object(old)) };
        let word = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.');
        let reserved = ["rem", "beginmodel", "endmodel"].contains(&&*new.to_ascii_lowercase());
        if reserved || !new.starts_with(|c: char| c.is_ascii_alphabetic()) || !new.chars().all(word)
        {
            return Err(Diagnostic::error("not-a-name", format!("`{new}` is not a valid name"))
                .at(line.name)
                .expected("a letter, then letters, digits, _, - and ."));
        }
        if source.has(new) {
            let diagnostic =
                Diagnostic::error("duplicate-name", format!("`{new}` is used already"))
                    .at(line.name);
            return Err(diagnostic.help("choose another name"));
        }
        let mut places: Vec<Span> =
            source.mentions(&self.registry, old).into_iter().map(|(_, span)| span).collect();
        places.push(line.name);
        places.sort_unstable_by_key(|s| s.start);
        let mut text = source.model().text().to_string();
        for place in places.into_iter().rev() {
            text.replace_range(place.range(), new);
        }
        if let Some(value) = self.overrides.shift_remove(old) {
            self.overrides.insert(new.to_string(), value);
        }
        Ok(self.set_text(&text))
    }

    fn no_object(&self, name: &str) -> Diagnostic {
        let near = match &self.source {
            ObjectSource::ModelFile(source) => {
                let names = source.lines().iter().map(|l| source.model().slice(l.name));
                moldloft_diag::nearest(name, names).map(str::to_string)
            }
            _ => None,
        };
        Diagnostic::error("unknown-name", format!("unknown object `{name}`"))
            .maybe_help(near.map(|n| format!("did you mean `{n}`?")))
    }

    /// The statement of a component or of a named call of a subroutine, in the main file.
    fn instance_statement(&self, name: &str) -> Option<(StmtId, Span)> {
        if !matches!(self.source, ObjectSource::Program) {
            return None;
        }
        let program = &self.modules.get(0).program;
        let found = |id: &&StmtId| match program[**id].kind {
            StmtKind::Object { kind, name: ident, .. } => {
                let kind = program.name(kind.symbol);
                program.name(ident.symbol) == name
                    && self.registry.get(kind).is_none_or(|row| !row.kind)
            }
            _ => false,
        };
        let &stmt = program[program.body()].iter().find(found)?;
        match program[stmt].kind {
            StmtKind::Object { name, .. } => Some((stmt, name.span)),
            _ => None,
        }
    }

    /// The statement of the main file that declares this object only, and the span of its name.
    pub(crate) fn sole_statement(&self, name: &str) -> Result<(StmtId, Span), Diagnostic> {
        let graph = self.graph();
        let Some(object) = graph.find(name).and_then(|key| graph.get(key)) else {
            if let Some(found) = self.instance_statement(name) {
                return Ok(found);
            }
            return Err(Diagnostic::error("unknown-name", format!("unknown object `{name}`"))
                .maybe_help(graph.nearest_name(name).map(|n| format!("did you mean `{n}`?"))));
        };
        let elsewhere = |why: &str| {
            Err(Diagnostic::error("not-here", format!("`{name}` cannot be changed separately"))
                .found(why.to_string())
                .help("edit the text"))
        };
        if !matches!(self.source, ObjectSource::Program) {
            return elsewhere("the model comes from a sketch");
        }
        let Some(origin) = self.plain.env.origins.get(object.origin as usize) else {
            return elsewhere("it has no statement");
        };
        if origin.module != 0 {
            return elsewhere("it is declared in a loaded file");
        }
        if origin.repeated {
            return elsewhere("its statement makes several objects");
        }
        match self.modules.get(0).program[origin.stmt].kind {
            StmtKind::Object { name, .. } => Ok((origin.stmt, name.span)),
            // `field f = ...;` and `set s = ...;`
            StmtKind::Declare { items, .. } => match &self.modules.get(0).program[items] {
                [item] => Ok((origin.stmt, item.name.span)),
                _ => elsewhere("its statement makes several objects"),
            },
            _ => elsewhere("it has no statement"),
        }
    }
}

/// Uses of a name in expressions.
fn uses(m: &Module, symbol: Symbol) -> Vec<Span> {
    (0..m.program.expr_count() as u32)
        .map(|k| &m.program[ExprId(k)])
        .filter(|e| matches!(e.kind, ExprKind::Name(s) if s == symbol))
        .map(|e| e.span)
        .collect()
}

/// Declaration of a name as a variable, parameter, argument or routine.
fn other_meaning(m: &Module, symbol: Symbol) -> Option<Span> {
    for routine in m.program.routines() {
        let formals = m.program[routine.formals].iter().map(|f| f.name);
        if let Some(other) = formals.chain([routine.name]).find(|n| n.symbol == symbol) {
            return Some(other.span);
        }
    }
    let mut stack: Vec<StmtId> = m.program[m.program.body()].to_vec();
    stack.extend(m.program.routines().iter().flat_map(|r| &m.program[r.body]));
    let mut objects = 0;
    while let Some(id) = stack.pop() {
        match m.program[id].kind {
            StmtKind::Declare { items, ty, .. } => {
                if let Some(item) = m.program[items].iter().find(|d| d.name.symbol == symbol) {
                    objects += 1;
                    // A field or set is an object.
                    if objects > 1 || !matches!(ty.0, sdl::Type::Field | sdl::Type::Set) {
                        return Some(item.name.span);
                    }
                }
            }
            StmtKind::Param { name, .. } if name.symbol == symbol => return Some(name.span),
            StmtKind::Object { name, .. } if name.symbol == symbol => {
                objects += 1;
                if objects > 1 {
                    return Some(name.span);
                }
            }
            StmtKind::Block(list) => stack.extend(&m.program[list]),
            StmtKind::If { then, otherwise, .. } => {
                stack.push(then);
                stack.extend(otherwise);
            }
            StmtKind::ForRange { variable, body, .. }
            | StmtKind::Foreach { variable, body, .. } => {
                if variable.symbol == symbol {
                    return Some(variable.span);
                }
                stack.push(body);
            }
            StmtKind::While { body, .. } | StmtKind::For { body, .. } => stack.push(body),
            _ => {}
        }
    }
    None
}
