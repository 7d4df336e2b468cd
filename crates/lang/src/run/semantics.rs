//! Faults that a run does not meet, in routines that are not called and branches that are not
//! taken; and warnings for any program: repeated declarations, statements that are never reached.
//!
//! The pass follows a run. It checks only statements that the run has not executed, since executed
//! ones have reported their faults with actual values. Names are known if they are declared
//! anywhere at file level in the loaded files, or anywhere in the routine: the pass reports no
//! error in a program that would run correctly.

use crate::functions::files::predeclared;
use crate::run::declared_lists::declared_list;
use crate::run::parts::{self, StatementParts};
use crate::run::unused;
use crate::run::whole_groups::WHOLE_GROUPS;
use crate::source::module::{Module, Modules, Name, RoutineAt};
use crate::source::scope::RecordAt;
use crate::value::variables::described;
use moldloft_diag::{Diagnostic, Severity, Span, nearest};
use moldloft_registry::{Registry, Row, argument_count};
use moldloft_syntax::sdl::{
    Arg, AssignOp, BinaryOp, Declarator, ExprId, ExprKind, Formal, Ident, NodeList, Routine,
    StmtId, StmtKind, Symbol, Type, UnaryOp,
};
use std::collections::{HashMap, HashSet};

/// The statements that a run has executed, by module.
#[derive(Debug, Default)]
pub(crate) struct Executed(Vec<Vec<u64>>);

impl Executed {
    /// Space for the statements of the modules; later modules add their own.
    pub fn note(&mut self, module: usize, stmt: StmtId) {
        let (word, bit) = (stmt.0 as usize / 64, 1 << (stmt.0 % 64));
        if let Some(known) = self.0.get_mut(module).and_then(|words| words.get_mut(word)) {
            *known |= bit;
            return;
        }
        if self.0.len() <= module {
            self.0.resize(module + 1, Vec::new());
        }
        let words = &mut self.0[module];
        if words.len() <= word {
            words.resize(word + 1, 0);
        }
        words[word] |= bit;
    }

    fn has(&self, module: usize, stmt: StmtId) -> bool {
        let words = self.0.get(module).map_or(&[][..], Vec::as_slice);
        words.get(stmt.0 as usize / 64).is_some_and(|word| word & (1 << (stmt.0 % 64)) != 0)
    }
}

/// True when a text had faults that left gaps in its tree.
pub(crate) fn has_gaps(m: &Module) -> bool {
    let error = |k: u32| matches!(m.program[StmtId(k)].kind, StmtKind::Error);
    let unread = |k: u32| matches!(m.program[ExprId(k)].kind, ExprKind::Error);
    m.faults.iter().any(Diagnostic::is_error)
        || (0..m.program.stmt_count() as u32).any(error)
        || (0..m.program.expr_count() as u32).any(unread)
}

/// Class of a declared name.
#[derive(Clone)]
struct Declared {
    span: Span,
    /// The type; `None` for objects and for names that are declared with several types.
    ty: Option<Type>,
    /// Dimensions that are numbers of the text.
    dims: Option<Vec<f64>>,
}

/// State of the pass.
pub(crate) struct Semantics<'a> {
    pub modules: &'a Modules,
    pub registry: &'a Registry,
    /// The modules that were run, in order.
    pub run: Vec<usize>,
    pub routines: &'a HashMap<Name, RoutineAt>,
    pub records: &'a HashMap<Name, RecordAt>,
    pub executed: &'a Executed,
    /// True when names come from elsewhere, too: sketches, components.
    pub open: bool,
    globals: HashMap<Name, Declared>,
    found: Vec<Diagnostic>,
}

struct JudgedScope<'a> {
    m: &'a Module,
    module: usize,
    locals: &'a HashMap<Name, Declared>,
    /// The routine, in one.
    routine: Option<&'a Routine>,
}

impl<'a> Semantics<'a> {
    pub fn new(
        modules: &'a Modules,
        registry: &'a Registry,
        mut run: Vec<usize>,
        (routines, records): (&'a HashMap<Name, RoutineAt>, &'a HashMap<Name, RecordAt>),
        executed: &'a Executed,
        open: bool,
    ) -> Self {
        run.sort_unstable();
        let (globals, found) = (HashMap::new(), Vec::new());
        Self { modules, registry, run, routines, records, executed, open, globals, found }
    }

    /// Diagnostics of the program.
    pub fn judged(mut self) -> Vec<Diagnostic> {
        let modules = self.modules;
        let run = self.run.clone();
        for &at in &run {
            let m = modules.get(at);
            let mut globals = std::mem::take(&mut self.globals);
            collect(m, m.program.body(), &mut globals, false);
            for routine in m.program.routines() {
                collect(m, routine.body, &mut globals, true);
            }
            self.globals = globals;
        }
        let nothing = HashMap::new();
        let main = modules.get(0);
        let uncalled = !self.open && run.contains(&0) && unused::does_something(main);
        let mentioned: HashSet<Name> = match uncalled {
            true => run.iter().flat_map(|&at| unused::mentioned(modules.get(at))).collect(),
            false => HashSet::new(),
        };
        for &at in &run {
            let m = modules.get(at);
            if m.library || m.path.to_ascii_lowercase().ends_with(".ms2") {
                continue;
            }
            let file = JudgedScope { m, module: at, locals: &nothing, routine: None };
            self.list(&file, m.program.body());
            self.declared_again(m, m.program.body());
            let of_file = variables_of_file(m);
            for routine in m.program.routines() {
                self.routine(m, at, &of_file, routine);
                let name = m.names[routine.name.symbol.0 as usize];
                if at == 0 && uncalled && !mentioned.contains(&name) {
                    let word = m.program.name(routine.name.symbol);
                    self.say(
                        Diagnostic::remark("unused", format!("nothing calls `{word}`"))
                            .at(routine.name.span)
                            .help("leave it out, or move it to a file that others load"),
                    );
                }
            }
        }
        self.found
    }

    fn say(&mut self, diagnostic: Diagnostic) {
        self.found.push(diagnostic);
    }

    fn routine(&mut self, m: &Module, module: usize, of_file: &HashSet<Symbol>, routine: &Routine) {
        let mut locals: HashMap<Name, Declared> = HashMap::new();
        for formal in &m.program[routine.formals] {
            let ty = Some(formal.ty.0).filter(|ty| !formal.multiple && *ty != Type::Routine);
            let declared = Declared { span: formal.name.span, ty, dims: None };
            locals.insert(m.names[formal.name.symbol.0 as usize], declared);
        }
        collect(m, routine.body, &mut locals, false);
        let place = JudgedScope { m, module, locals: &locals, routine: Some(routine) };
        let before = self.found.len();
        self.list(&place, routine.body);
        let sound = self.found[before..].iter().all(|d| d.severity == Severity::Note);
        self.declared_again(m, routine.body);
        self.shadows(m, of_file, routine.body);
        // Variables of a faulty routine may be unread because of its faults.
        if sound {
            self.found.extend(unused::unread(m, routine));
        }
        let word = m.program.name(routine.name.symbol);
        if routine.result.is_some() && !ends(m, routine.body) {
            self.say(
                Diagnostic::warning(
                    "missing-return",
                    format!("not every path through `{word}` returns a value"),
                )
                .at(routine.name.span)
                .expected("`return` with a value at the end of each path")
                .help("add one at the end of the function"),
            );
        }
        // A subroutine is called as a statement, a function in expressions: they are distinguished.
        let known = self.registry.get(word).is_some_and(|row| !row.kind);
        if routine.result.is_none() {
            return;
        }
        if known {
            self.say(
                Diagnostic::remark(
                    "redefined",
                    format!("`{word}` of the program replaces the function of that name"),
                )
                .at(routine.name.span),
            );
        }
    }

    fn list(&mut self, place: &JudgedScope<'_>, list: NodeList<StmtId>) {
        let m = place.m;
        let all = &m.program[list];
        for (k, &stmt) in all.iter().enumerate() {
            self.statement(place, stmt);
            let leaves = leaves(m, stmt);
            if let Some(&next) = all.get(k + 1).filter(|_| leaves) {
                let routine = matches!(m.program[next].kind, StmtKind::Routine(_));
                if !routine {
                    self.say(
                        Diagnostic::remark("unreachable", "this statement is never reached")
                            .at(m.program[next].span)
                            .note_at(m.program[stmt].span, "the statement before it always leaves"),
                    );
                    break;
                }
            }
        }
    }

    fn statement(&mut self, place: &JudgedScope<'_>, id: StmtId) {
        let m = place.m;
        let judged = !self.executed.has(place.module, id);
        let stmt = m.program[id];
        let StatementParts { values, inner } = parts::of_statement(m, id);
        match stmt.kind {
            StmtKind::Block(list) => return self.list(place, list),
            StmtKind::Declare { ty, items, .. } => {
                for item in &m.program[items] {
                    if judged {
                        self.declaration(place, ty, item);
                    }
                    self.pi(m, item.name, item.value);
                }
            }
            StmtKind::Object { kind, args, .. } => {
                let word = m.program.name(kind.symbol);
                let name = m.names[kind.symbol.0 as usize];
                if judged && word != "Component" {
                    if let Some(&routine) = self.routines.get(&name) {
                        self.arity(m, routine, args, stmt.span);
                    } else if m.rows[kind.symbol.0 as usize].is_none() {
                        let rows =
                            self.registry.rows().filter(|row| row.kind).map(|row| &*row.name);
                        let diagnostic =
                            Diagnostic::warning("unknown-entity", format!("unknown kind `{word}`"))
                                .at(kind.span)
                                .expected("the name of an entity kind or of a subroutine")
                                .suggest(word, rows);
                        self.say(diagnostic);
                    }
                }
            }
            StmtKind::Assign { target, op, value } => {
                if judged && op == AssignOp::Set {
                    self.assignment(place, target, value);
                }
                if let (Some(symbol), AssignOp::Set) = (m.program.as_name(target), op) {
                    let name = Ident { symbol, span: m.program[target].span };
                    self.pi(m, name, Some(value));
                }
            }
            StmtKind::Return(value) => {
                if let (true, Some(value), Some(result)) =
                    (judged, value, place.routine.and_then(|routine| routine.result))
                {
                    self.fits(place, result.0, false, value, None);
                }
            }
            _ => {}
        }
        inner.into_iter().for_each(|stmt| self.statement(place, stmt));
        if judged {
            values.into_iter().for_each(|expr| self.expression(place, expr));
        }
    }

    /// Names, calls and shapes of an expression.
    fn expression(&mut self, place: &JudgedScope<'_>, expr: ExprId) {
        let m = place.m;
        let mut stack = vec![expr];
        while let Some(id) = stack.pop() {
            let expr = m.program[id];
            let mut inner = parts::of_expression(m, id);
            match expr.kind {
                ExprKind::Name(symbol) => self.name(place, symbol, expr.span),
                ExprKind::Binary { op, left, right } => {
                    let named = [left, right].map(|side| self.dims(place, side, None));
                    if let ([Some(a), Some(b)], true) = (named, op != BinaryOp::Dot)
                        && a != b
                    {
                        self.differ(place, [left, right], [&a, &b], expr.span);
                    }
                }
                ExprKind::Member { base, .. } => {
                    // `hydrostatics.volume` belongs to the whole model.
                    let word = m.program.as_name(base).map(|symbol| m.program.name(symbol));
                    if word.is_some_and(|word| WHOLE_GROUPS.contains(&word)) {
                        inner.clear();
                    }
                }
                ExprKind::Call { callee, args } => {
                    if let Some(symbol) = m.program.as_name(callee) {
                        inner.remove(0);
                        self.call(place, symbol, callee, args, expr.span);
                    }
                }
                _ => {}
            }
            stack.extend(inner.into_iter().rev());
        }
    }

    fn declared<'b>(&'b self, place: &'b JudgedScope<'_>, symbol: Symbol) -> Option<&'b Declared> {
        let name = place.m.names[symbol.0 as usize];
        place.locals.get(&name).or_else(|| self.globals.get(&name))
    }

    fn name(&mut self, place: &JudgedScope<'_>, symbol: Symbol, span: Span) {
        let m = place.m;
        let word = m.program.name(symbol);
        let name = m.names[symbol.0 as usize];
        let known = place.locals.contains_key(&name)
            || self.globals.contains_key(&name)
            || self.routines.contains_key(&name)
            || m.rows[symbol.0 as usize].is_some()
            || predeclared(word).is_some();
        if known || self.open {
            return;
        }
        let all = place.locals.keys().chain(self.globals.keys());
        let near = nearest(word, all.map(|name| &**self.modules.text(*name))).map(str::to_string);
        let hint = crate::source::library::defining(word);
        let diagnostic =
            Diagnostic::warning("unknown-name", format!("unknown name `{word}`")).at(span);
        let diagnostic = match (hint, near) {
            (Some(hint), _) => diagnostic.help(hint),
            (None, Some(near)) => diagnostic.help(format!("did you mean `{near}`?")),
            (None, None) => diagnostic,
        };
        self.say(diagnostic);
    }

    fn call(
        &mut self,
        place: &JudgedScope<'_>,
        symbol: Symbol,
        callee: ExprId,
        args: NodeList<Arg>,
        span: Span,
    ) {
        let m = place.m;
        let word = m.program.name(symbol);
        let name = m.names[symbol.0 as usize];
        if place.locals.contains_key(&name) || self.globals.contains_key(&name) {
            return;
        }
        if let Some(&routine) = self.routines.get(&name) {
            return self.arity(m, routine, args, span);
        }
        if self.records.contains_key(&name) {
            return;
        }
        match &m.rows[symbol.0 as usize] {
            Some(row) if !row.kind => self.row_arguments(m, &row.clone(), args, span),
            Some(_) => {}
            None if self.open || matches!(word, "makeecc") => {}
            None => {
                let functions = self.registry.rows().filter(|r| !r.kind).map(|r| &*r.name);
                let routines = self.routines.keys().map(|name| &**self.modules.text(*name));
                let near = nearest(word, routines.chain(functions)).map(str::to_string);
                let diagnostic =
                    Diagnostic::warning("unknown-name", format!("unknown function `{word}`"))
                        .at(m.program[callee].span);
                let hint = crate::source::library::defining(word);
                let near = near.map(|near| format!("did you mean `{near}`?"));
                self.say(diagnostic.maybe_help(hint.or(near)));
            }
        }
    }

    /// Checks the number and names of arguments of a function of the registry.
    fn row_arguments(&mut self, m: &Module, row: &Row, args: NodeList<Arg>, span: Span) {
        let given = &m.program[args];
        let positional = given.iter().filter(|arg| arg.name.is_none()).count();
        let fields = &row.fields;
        let variadic = fields.iter().any(|field| field.variadic || field.many);
        if positional > fields.len() && !variadic {
            let most = fields.len();
            self.say(
                Diagnostic::warning(
                    "too-many-arguments",
                    format!("{} takes {}", row.name, argument_count(most)),
                )
                .at(span)
                .expected(signature(row))
                .found(argument_count(positional)),
            );
        }
        let mut named: HashSet<&str> = HashSet::new();
        for ident in given.iter().filter_map(|arg| arg.name) {
            let word = m.program.name(ident.symbol);
            named.insert(word);
            if fields.iter().all(|field| field.name != word) {
                let message = format!("{} has no argument `{word}`", row.name);
                let diagnostic = Diagnostic::warning("unknown-argument", message)
                    .at(ident.span)
                    .expected(signature(row))
                    .suggest(word, fields.iter().map(|field| field.name));
                self.say(diagnostic);
            }
        }
        let missing = fields.iter().skip(positional).find(|field| {
            field.default.is_none() && !field.variadic && !field.many && !named.contains(field.name)
        });
        if let Some(field) = missing.filter(|_| positional <= fields.len()) {
            self.say(
                Diagnostic::warning(
                    "missing-argument",
                    format!("{} needs `{}`", row.name, field.name),
                )
                .at(span)
                .expected(signature(row)),
            );
        }
    }

    /// Checks the number and names of arguments of a program's routine.
    fn arity(&mut self, m: &Module, routine: RoutineAt, args: NodeList<Arg>, span: Span) {
        let callee = self.modules.get(routine.module);
        let routine = callee.program[routine.routine];
        let name = callee.program.name(routine.name.symbol);
        let formals: &[Formal] = &callee.program[routine.formals];
        let spelled: Vec<&str> =
            formals.iter().map(|f| callee.program.name(f.name.symbol)).collect();
        let signature = format!("{name}({})", spelled.join(", "));
        let given = &m.program[args];
        let mut filled = vec![false; formals.len()];
        for (k, arg) in given.iter().enumerate() {
            match arg.name {
                Some(ident) => {
                    let word = m.program.name(ident.symbol);
                    match spelled.iter().position(|s| *s == word) {
                        Some(at) => filled[at] = true,
                        None => {
                            let message = format!("{name} has no argument `{word}`");
                            let diagnostic = Diagnostic::warning("unknown-argument", message)
                                .at(ident.span)
                                .expected(&signature)
                                .suggest(word, spelled.iter().copied());
                            return self.say(diagnostic);
                        }
                    }
                }
                None if k < formals.len() => filled[k] = true,
                None if formals.last().is_some_and(|formal| formal.multiple) => {}
                None => {
                    return self.say(
                        Diagnostic::warning(
                            "too-many-arguments",
                            format!("{name} takes {}", argument_count(formals.len())),
                        )
                        .at(m.program[arg.value].span)
                        .expected(&signature)
                        .found(argument_count(given.len())),
                    );
                }
            }
        }
        let needed = |k: &usize| !formals[*k].multiple && formals[*k].default.is_none();
        let missing = (0..formals.len()).filter(needed).find(|&k| !filled[k]);
        if let Some(k) = missing {
            self.say(
                Diagnostic::warning("missing-argument", format!("{name} needs `{}`", spelled[k]))
                    .at(span)
                    .expected(&signature)
                    .found(argument_count(given.len()))
                    .note_at(formals[k].name.span, "declared here"),
            );
        }
    }

    fn declaration(&mut self, place: &JudgedScope<'_>, ty: (Type, Span), item: &Declarator) {
        let m = place.m;
        if let Type::Other(symbol) = ty.0 {
            if self.records.contains_key(&m.names[symbol.0 as usize]) {
                return;
            }
            let word = m.program.name(symbol);
            let diagnostic = Diagnostic::warning("unknown-type", format!("unknown type `{word}`"))
                .at(ty.1)
                .suggest(word, moldloft_syntax::sdl::declaring_words());
            return self.say(diagnostic);
        }
        if declared_list(m, ty.0, item).is_some() {
            return;
        }
        let Some(value) = item.value else { return };
        let dims = numbers(m, item.dims);
        self.fits(place, ty.0, !item.dims.is_empty(), value, Some(ty.1));
        if let (Some(to), Some(from)) =
            (dims.filter(|d| !d.is_empty()), self.dims(place, value, Some(ty.0)))
            && to != from
        {
            let name = item.name.span;
            self.say(
                Diagnostic::warning("shapes-differ", "shapes differ")
                    .at(m.program[value].span)
                    .expected(bracketed(&to))
                    .found(bracketed(&from))
                    .note_at(name, "declared here"),
            );
        }
    }

    fn assignment(&mut self, place: &JudgedScope<'_>, target: ExprId, value: ExprId) {
        let m = place.m;
        let Some(declared) =
            m.program.as_name(target).and_then(|symbol| self.declared(place, symbol)).cloned()
        else {
            return;
        };
        if let Some(ty) = declared.ty {
            // A number fills an array that has its dimensions.
            self.fits(place, ty, true, value, Some(declared.span));
        }
        if let (Some(to), Some(from)) = (declared.dims, self.dims(place, value, declared.ty))
            && to != from
        {
            self.differ(place, [target, value], [&to, &from], m.program[target].span);
        }
    }

    /// Checks, as far as types are known, that an expression fits a variable.
    fn fits(
        &mut self,
        place: &JudgedScope<'_>,
        ty: Type,
        filled: bool,
        value: ExprId,
        asked: Option<Span>,
    ) {
        let Some(kind) = self.kind(place, value) else { return };
        let number = matches!(kind, Type::Int | Type::Float);
        let takes = match ty {
            Type::Int | Type::Float | Type::File => number,
            Type::String => kind == Type::String,
            Type::Vector => kind == Type::Vector,
            Type::Farray => matches!(kind, Type::Farray | Type::Vector) || (filled && number),
            Type::Curve => kind == Type::Curve || (filled && kind == Type::Vector),
            Type::Surface => kind == Type::Surface || (filled && kind == Type::Vector),
            _ => return,
        };
        if takes {
            return;
        }
        let (expected, found) = (described(ty), described(kind));
        let diagnostic =
            Diagnostic::warning("wrong-type", format!("expected {expected}, found {found}"))
                .at(place.m.program[value].span)
                .expected(expected)
                .found(found);
        self.say(match asked {
            Some(asked) => diagnostic.note_at(asked, "requested here"),
            None => diagnostic,
        });
    }

    /// The type of an expression, where the text alone says it.
    fn kind(&self, place: &JudgedScope<'_>, id: ExprId) -> Option<Type> {
        let m = place.m;
        Some(match m.program[m.program.bare(id)].kind {
            ExprKind::Number(_) => Type::Float,
            ExprKind::Text(_) => Type::String,
            ExprKind::Name(symbol) => self.declared(place, symbol)?.ty?,
            ExprKind::Unary { op: UnaryOp::Minus, operand } => {
                self.kind(place, operand).filter(|ty| *ty != Type::String)?
            }
            ExprKind::Binary { op, left, right } => {
                let number =
                    |side: ExprId| matches!(self.kind(place, side), Some(Type::Int | Type::Float));
                let arithmetic =
                    matches!(op, BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div);
                if !(arithmetic && number(left) && number(right)) {
                    return None;
                }
                Type::Float
            }
            ExprKind::Call { callee, .. } => {
                let symbol = m.program.as_name(callee)?;
                let name = m.names[symbol.0 as usize];
                if self.declared(place, symbol).is_some() {
                    return None;
                }
                let at = self.routines.get(&name)?;
                let (ty, _) = self.modules.get(at.module).program[at.routine].result?;
                if matches!(ty, Type::Other(_)) {
                    return None;
                }
                ty
            }
            _ => return None,
        })
    }

    /// The dimensions of an array named by an expression, if declared by numbers, or spelled in
    /// braces for a row of `ty`.
    fn dims(&self, place: &JudgedScope<'_>, id: ExprId, ty: Option<Type>) -> Option<Vec<f64>> {
        let m = place.m;
        let bare = m.program.bare(id);
        if let ExprKind::List(items) = m.program[bare].kind {
            let number =
                |item: ExprId| matches!(self.kind(place, item), Some(Type::Int | Type::Float));
            let point = |item: ExprId| match m.program[m.program.bare(item)].kind {
                ExprKind::List(of) => of.len() == 3 && m.program[of].iter().all(|x| number(*x)),
                _ => self.kind(place, item) == Some(Type::Vector),
            };
            let row = match ty? {
                Type::Farray => m.program[items].iter().all(|item| number(*item)),
                Type::Curve => m.program[items].iter().all(|item| point(*item)),
                _ => false,
            };
            return (row && !items.is_empty()).then(|| vec![items.len() as f64]);
        }
        let symbol = m.program.as_name(bare)?;
        self.declared(place, symbol)?.dims.clone()
    }

    fn differ(
        &mut self,
        place: &JudgedScope<'_>,
        sides: [ExprId; 2],
        dims: [&[f64]; 2],
        span: Span,
    ) {
        let m = place.m;
        let [a, b] = sides.map(|side| m.program.slice(m.program[side].span).trim().to_string());
        let [m1, m2] = dims.map(bracketed);
        self.say(
            Diagnostic::warning(
                "shapes-differ",
                format!("shapes differ: `{a}` is {m1}, `{b}` is {m2}"),
            )
            .at(span)
            .expected("equal shapes, or a single value on one side")
            .found(format!("{m1} and {m2}")),
        );
    }

    /// Names that one list of statements declares twice, and variables of one scope with two types.
    fn declared_again(&mut self, m: &Module, list: NodeList<StmtId>) {
        let mut first: HashMap<Symbol, (Type, Span, StmtId)> = HashMap::new();
        let mut lists = vec![list];
        while let Some(list) = lists.pop() {
            let mut here: HashSet<Symbol> = HashSet::new();
            for &stmt in &m.program[list] {
                let StmtKind::Declare { ty, items, .. } = m.program[stmt].kind else {
                    lists.extend(inner_lists(m, stmt));
                    continue;
                };
                // These may be objects, whose names are guarded by the run.
                if matches!(ty.0, Type::Field | Type::Set) {
                    continue;
                }
                for item in &m.program[items] {
                    let symbol = item.name.symbol;
                    let again = !here.insert(symbol);
                    match first.get(&symbol) {
                        Some(&(before, span, _)) if again || before != ty.0 => {
                            let word = m.program.name(symbol);
                            self.say(
                                Diagnostic::remark(
                                    "declared-again",
                                    format!("`{word}` is declared again"),
                                )
                                .at(item.name.span)
                                .note_at(span, "first declared here")
                                .help("the first variable is lost: give one of them another name"),
                            );
                        }
                        Some(_) => {}
                        None => {
                            first.insert(symbol, (ty.0, item.name.span, stmt));
                        }
                    }
                }
            }
        }
    }

    /// Variables of a routine that hide one of the file.
    fn shadows(&mut self, m: &Module, of_file: &HashSet<Symbol>, list: NodeList<StmtId>) {
        let mut lists = vec![list];
        while let Some(list) = lists.pop() {
            for &stmt in &m.program[list] {
                lists.extend(inner_lists(m, stmt));
                let StmtKind::Declare { items, global: false, .. } = m.program[stmt].kind else {
                    continue;
                };
                for item in &m.program[items] {
                    let name = m.names[item.name.symbol.0 as usize];
                    let hidden = self.globals.get(&name).filter(|global| {
                        of_file.contains(&item.name.symbol)
                            && global.span.file == item.name.span.file
                    });
                    if let Some(hidden) = hidden {
                        let word = m.program.name(item.name.symbol);
                        let (at, before) = (item.name.span, hidden.span);
                        self.say(
                            Diagnostic::remark(
                                "shadowed",
                                format!("`{word}` hides the variable of the file with that name"),
                            )
                            .at(at)
                            .note_at(before, "declared here"),
                        );
                    }
                }
            }
        }
    }

    /// A variable PI with another value.
    fn pi(&mut self, m: &Module, name: Ident, value: Option<ExprId>) {
        if m.program.name(name.symbol) != "PI" {
            return;
        }
        let literal = value.and_then(|value| m.program.as_literal(value));
        if let Some(literal) = literal
            && (m.program[literal].value - std::f64::consts::PI).abs() > 1e-3
        {
            self.say(
                Diagnostic::remark("redefined", "`PI` of the program replaces the number")
                    .at(name.span)
                    .found(moldloft_syntax::number::plain(m.program[literal].value)),
            );
        }
    }
}

/// The variables that routines of a file may read; those of loops at file level are excluded.
fn variables_of_file(m: &Module) -> HashSet<Symbol> {
    let mut names = HashSet::new();
    for &stmt in &m.program[m.program.body()] {
        if let StmtKind::Declare { items, .. } = m.program[stmt].kind {
            names.extend(m.program[items].iter().map(|item| item.name.symbol));
        }
    }
    names
}

/// The names that statements declare: variables, parameters, objects, those of loops. `global` takes in only those
/// that a routine declares global.
fn collect(
    m: &Module,
    list: NodeList<StmtId>,
    into: &mut HashMap<Name, Declared>,
    global_only: bool,
) {
    let mut lists = vec![list];
    while let Some(list) = lists.pop() {
        for &stmt in &m.program[list] {
            lists.extend(inner_lists(m, stmt));
            let mut add = |ident: Ident, ty: Option<Type>, dims: Option<Vec<f64>>| {
                let name = m.names[ident.symbol.0 as usize];
                let declared = Declared { span: ident.span, ty, dims };
                into.entry(name)
                    .and_modify(|known| {
                        if known.ty != declared.ty {
                            known.ty = None;
                        }
                        if known.dims != declared.dims {
                            known.dims = None;
                        }
                    })
                    .or_insert(declared);
            };
            match m.program[stmt].kind {
                StmtKind::Declare { global, ty, items } if global || !global_only => {
                    for item in &m.program[items] {
                        let list = declared_list(m, ty.0, item).is_some();
                        let known = !matches!(ty.0, Type::Other(_)) && !list;
                        let dims = numbers(m, item.dims).filter(|dims| !dims.is_empty() && !list);
                        add(item.name, Some(ty.0).filter(|_| known), dims);
                    }
                }
                _ if global_only => {}
                StmtKind::Param { name, .. } => add(name, Some(Type::Float), None),
                StmtKind::Object { name, .. } => add(name, None, None),
                StmtKind::ForRange { variable, .. } | StmtKind::Foreach { variable, .. } => {
                    add(variable, None, None);
                }
                _ => {}
            }
        }
    }
}

/// The lists of statements inside a statement; a single statement instead of a block is a list of
/// its own.
fn inner_lists(m: &Module, stmt: StmtId) -> Vec<NodeList<StmtId>> {
    let mut lists = Vec::new();
    let mut stack = vec![stmt];
    while let Some(at) = stack.pop() {
        match m.program[at].kind {
            StmtKind::Block(list) => lists.push(list),
            StmtKind::If { then, otherwise, .. } => {
                stack.push(then);
                stack.extend(otherwise);
            }
            StmtKind::While { body, .. }
            | StmtKind::ForRange { body, .. }
            | StmtKind::For { body, .. }
            | StmtKind::Foreach { body, .. } => stack.push(body),
            _ => {}
        }
    }
    lists
}

/// The numbers of the text that dimensions are; `None` when one is computed.
fn numbers(m: &Module, dims: NodeList<ExprId>) -> Option<Vec<f64>> {
    let literal = |dim: &ExprId| m.program.as_literal(*dim).map(|at| m.program[at].value);
    m.program[dims].iter().map(literal).collect()
}

fn bracketed(dims: &[f64]) -> String {
    let all: Vec<String> = dims.iter().map(f64::to_string).collect();
    format!("[{}]", all.join(","))
}

fn signature(row: &Row) -> String {
    let fields: Vec<&str> = row.fields.iter().map(|field| field.name).collect();
    format!("{}({})", row.name, fields.join(", "))
}

/// True if the statements after it are never reached.
fn leaves(m: &Module, stmt: StmtId) -> bool {
    match m.program[stmt].kind {
        StmtKind::Return(_) | StmtKind::Break | StmtKind::Continue => true,
        StmtKind::Block(list) => m.program[list].iter().any(|&stmt| leaves(m, stmt)),
        StmtKind::If { then, otherwise: Some(otherwise), .. } => {
            leaves(m, then) && leaves(m, otherwise)
        }
        _ => false,
    }
}

/// True if every path through the statements returns, or never ends.
fn ends(m: &Module, list: NodeList<StmtId>) -> bool {
    m.program[list].iter().any(|&stmt| returns(m, stmt))
}

fn returns(m: &Module, stmt: StmtId) -> bool {
    match m.program[stmt].kind {
        StmtKind::Return(_) => true,
        StmtKind::Block(list) => ends(m, list),
        StmtKind::If { then, otherwise: Some(otherwise), .. } => {
            returns(m, then) && returns(m, otherwise)
        }
        StmtKind::While { condition, .. } => {
            let literal = m.program.as_literal(condition);
            literal.is_some_and(|at| m.program[at].value != 0.0)
        }
        StmtKind::For { condition: None, .. } => true,
        // `assert 0, "..."` is an error there.
        StmtKind::Assert { condition, .. } => {
            let literal = m.program.as_literal(condition);
            literal.is_some_and(|at| m.program[at].value == 0.0)
        }
        _ => false,
    }
}
