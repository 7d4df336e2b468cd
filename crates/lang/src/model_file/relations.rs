//! Numbers of a program that its model file keeps as relations: parameters as `Variable`, variables as `Formula`,
//! arguments as `=name` or `[expression]`.
//!
//! A relation is kept if its expression has the same meaning in the file: it names parameters,
//! variables that are assigned once, and objects of the main program. Results of routines and loops
//! become numbers.

use crate::functions::files::predeclared;
use crate::model_file::names::plain_name;
use crate::run::forward_reference::names_in;
use crate::source::env::{DeclarationOrigin, Evaluation};
use crate::source::fault_location;
use crate::source::module::Module;
use indexmap::IndexMap;
use moldloft_diag::Span;
use moldloft_model::Object;
use moldloft_registry::Unit;
use moldloft_syntax::number;
use moldloft_syntax::sdl::{AssignOp, ExprId, ExprKind, StmtId, StmtKind, Symbol, Type};
use std::cell::RefCell;
use std::collections::HashSet;

/// Radians per degree, as spelled in programs converted from model files.
pub(super) const RADIANS: &str = "0.017453292519943295";

/// Representation of a number in a model file.
pub(super) enum NumberForm {
    /// It is stated, or the same whatever the parameters are.
    Constant,
    /// `=name` or `[expression]`.
    Relation(String),
    /// Computed in a form that the file has no words for.
    Computed,
}

/// A `Variable` or `Formula`.
struct RealLine {
    start: u32,
    text: String,
    names: Vec<Symbol>,
}

/// The relations of a program's main module.
pub(super) struct Relations<'a> {
    module: &'a Module,
    evaluation: &'a Evaluation<f64>,
    reals: IndexMap<Symbol, RealLine>,
    /// Spans of numbers changed since the text was parsed.
    edited: Vec<Span>,
    /// Names that arguments mention, directly or through formulas.
    used: RefCell<HashSet<Symbol>>,
}

impl<'a> Relations<'a> {
    pub fn new(module: &'a Module, evaluation: &'a Evaluation<f64>) -> Self {
        let mut relations = Self {
            module,
            evaluation,
            reals: IndexMap::new(),
            edited: module.program.edits().into_iter().map(|(at, _)| at).collect(),
            used: RefCell::new(HashSet::new()),
        };
        let program = &module.program;
        let assigned = relations.assigned();
        for &id in &program[program.body()] {
            match program[id].kind {
                StmtKind::Param { name, .. } if !assigned.contains(&name.symbol) => {
                    relations.variable(name.symbol, program[id].span.start);
                }
                StmtKind::Declare { ty: (Type::Float, _), items, .. } => {
                    for item in &program[items] {
                        if let (Some(value), true) = (item.value, item.dims.is_empty())
                            && !assigned.contains(&item.name.symbol)
                        {
                            relations.formula(item.name.symbol, value, program[id].span.start);
                        }
                    }
                }
                StmtKind::Assign { target, op: AssignOp::Set, value } => {
                    let name = program.as_name(target);
                    if let Some(name) = name.filter(|name| !assigned.contains(name)) {
                        relations.formula(name, value, program[id].span.start);
                    }
                }
                _ => {}
            }
        }
        relations
    }

    /// The names that more than one statement, or one inside another, gives a value.
    fn assigned(&self) -> HashSet<Symbol> {
        let program = &self.module.program;
        let mut once = HashSet::new();
        let mut again = HashSet::new();
        let top: HashSet<StmtId> = program[program.body()].iter().copied().collect();
        for id in (0..program.stmt_count() as u32).map(StmtId) {
            let mut given: Vec<Symbol> = Vec::new();
            match program[id].kind {
                StmtKind::Param { name, .. } => given.push(name.symbol),
                StmtKind::Declare { items, .. } => {
                    given.extend(program[items].iter().map(|item| item.name.symbol));
                }
                StmtKind::Assign { target, op, .. } => {
                    let mut base = program.bare(target);
                    while let ExprKind::Index { base: inner, .. }
                    | ExprKind::Member { base: inner, .. } = program[base].kind
                    {
                        base = program.bare(inner);
                    }
                    let whole = program.as_name(target).is_some() && op == AssignOp::Set;
                    if let Some(name) = program.as_name(base) {
                        given.push(name);
                        if !whole {
                            again.insert(name);
                        }
                    }
                }
                StmtKind::ForRange { variable, .. } | StmtKind::Foreach { variable, .. } => {
                    again.insert(variable.symbol);
                }
                _ => {}
            }
            for name in given {
                if !once.insert(name) || !top.contains(&id) {
                    again.insert(name);
                }
            }
        }
        again
    }

    fn variable(&mut self, symbol: Symbol, start: u32) {
        let name = self.module.program.name(symbol);
        let Some(param) = self.evaluation.env.params.iter().find(|p| p.name == name) else {
            return;
        };
        // A whole number divides otherwise than a variable of a model file.
        if param.is_int || plain_name(name) != name {
            return;
        }
        let mut text = format!("Variable {name} {}", number::plain(param.value));
        if let Some((low, high)) = param.range {
            text += &format!(" {} {}", number::plain(low), number::plain(high));
        }
        text += ";\n";
        self.reals.insert(symbol, RealLine { start, text, names: Vec::new() });
    }

    fn formula(&mut self, symbol: Symbol, value: ExprId, start: u32) {
        let name = self.module.program.name(symbol);
        if plain_name(name) != name {
            return;
        }
        if let Some((spelled, names)) = self.expression(value) {
            let text = format!("Formula {name} [{spelled}];\n");
            self.reals.insert(symbol, RealLine { start, text, names });
        }
    }

    /// The text of an expression in the names of the file, and those names; `None` when the file has no words for it.
    fn expression(&self, expr: ExprId) -> Option<(String, Vec<Symbol>)> {
        let program = &self.module.program;
        let span = program[expr].span;
        if self.edited.iter().any(|at| span.start <= at.start && at.end <= span.end) {
            return None;
        }
        let text = program.slice(span).trim();
        if text.contains(['[', ']', '#', '\n', '"', ';']) {
            return None;
        }
        let mut names = Vec::new();
        let mut known = true;
        names_in(self.module, expr, &mut |symbol| {
            let name = program.name(symbol);
            if self.reals.contains_key(&symbol) || self.is_main_object(name) {
                names.push(symbol);
            } else {
                // A function or constant of the language means the same there.
                known &= self.is_known(symbol) && self.evaluation.graph.find(name).is_none();
            }
        });
        known.then(|| (text.to_string(), names))
    }

    /// True for a function or constant of the language.
    fn is_known(&self, symbol: Symbol) -> bool {
        let name = self.module.program.name(symbol);
        self.module.rows[symbol.0 as usize].is_some() || predeclared(name).is_some()
    }

    /// True when names of the program are in the expression.
    fn is_named(&self, expr: ExprId) -> bool {
        let mut named = false;
        names_in(self.module, expr, &mut |symbol| named |= !self.is_known(symbol));
        named
    }

    fn is_main_object(&self, name: &str) -> bool {
        let graph = &self.evaluation.graph;
        let object = graph.find(name).and_then(|key| graph.get(key));
        let origin = object.and_then(|o| self.origin(o));
        plain_name(name) == name && origin.is_some_and(|o| o.module == 0 && !o.repeated)
    }

    fn origin(&self, object: &Object<f64>) -> Option<&DeclarationOrigin> {
        self.evaluation.env.origins.get(object.origin as usize)
    }

    /// Representation of an argument, or an item of it, in the file.
    pub fn number(
        &self,
        object: &Object<f64>,
        field: usize,
        item: Option<usize>,
        unit: Unit,
    ) -> NumberForm {
        let Some(origin) = self.origin(object).filter(|o| o.module == 0 && !o.repeated) else {
            return NumberForm::Computed;
        };
        let program = &self.module.program;
        let StmtKind::Object { args, .. } = program[origin.stmt].kind else {
            return NumberForm::Computed;
        };
        let args = &program[args];
        let unnamed = args.iter().filter(|a| a.name.is_none()).count();
        let argument = fault_location::argument(self.module, args, &object.row, unnamed, field);
        // Left to its default.
        let Some(mut expr) = argument else { return NumberForm::Constant };
        if !self.is_named(expr) {
            return NumberForm::Constant;
        }
        if let Some(k) = item {
            match fault_location::item(self.module, expr, k) {
                Some(item) => expr = item,
                None => return NumberForm::Computed,
            }
        }
        if !self.is_named(expr) {
            return NumberForm::Constant;
        }
        let Some((mut text, names)) = self.expression(expr) else { return NumberForm::Computed };
        self.used.borrow_mut().extend(&names);
        if unit == Unit::Angle {
            let degrees =
                text.strip_suffix(RADIANS).and_then(|rest| rest.trim_end().strip_suffix('*'));
            text = match degrees.map(str::trim) {
                Some(degrees) => {
                    match degrees.strip_prefix('(').and_then(|d| d.strip_suffix(')')) {
                        Some(inside) if !inside.contains(['(', ')']) => inside.to_string(),
                        _ => degrees.to_string(),
                    }
                }
                None => format!("({text})*{}", number::plain(1_f64.to_degrees())),
            };
        }
        let word = names.first().map(|&name| program.name(name));
        NumberForm::Relation(match word {
            Some(word) if word == text && self.reals.contains_key(&names[0]) => format!("={word}"),
            _ => format!("[{text}]"),
        })
    }

    /// The variables and formulas of the statement that begins there: names and lines.
    pub fn reals_at(&self, start: u32) -> Vec<(String, String)> {
        // They are in the order of the text.
        let first = self.reals.partition_point(|_, line| line.start < start);
        let lines = self.reals.iter().skip(first).take_while(|(_, line)| line.start == start);
        let program = &self.module.program;
        lines.map(|(name, line)| (program.name(*name).to_string(), line.text.clone())).collect()
    }

    /// The variables and formulas that arguments mention, directly or through others.
    pub fn used_reals(&self) -> HashSet<String> {
        let mut wanted: Vec<Symbol> = self.used.borrow().iter().copied().collect();
        let mut seen: HashSet<Symbol> = wanted.iter().copied().collect();
        while let Some(symbol) = wanted.pop() {
            let Some(line) = self.reals.get(&symbol) else { continue };
            wanted.extend(line.names.iter().filter(|name| seen.insert(**name)));
        }
        seen.iter().map(|symbol| self.module.program.name(*symbol).to_string()).collect()
    }
}
