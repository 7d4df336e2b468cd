//! The names that statements declare, and what names mean where code is compiled.

use super::code::{Captured, CodeArray, CodeVariable, NamePlace, Poisonable};
use super::compile::{RegionCompiler, Unfit};
use crate::functions::files::predeclared;
use crate::source::module::{Module, Name};
use crate::source::scope::{Binding, ScopedBinding};
use moldloft_registry::{Scalar, Value};
use moldloft_syntax::sdl::{NodeList, StmtId, StmtKind, Symbol, Type};

/// How a statement gives names a meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Declares {
    Number(Type),
    Array,
    /// Something that code does not hold.
    Other,
}

/// Calls `f` with the names that statements declare in their own frame, those of `global` declarations with true.
/// False when a file is loaded.
pub(super) fn declared(
    m: &Module,
    list: &[StmtId],
    f: &mut impl FnMut(Name, Declares, bool),
) -> bool {
    let mut stack: Vec<StmtId> = list.to_vec();
    let mut loads = false;
    while let Some(id) = stack.pop() {
        let name = |symbol: Symbol| m.names[symbol.0 as usize];
        match m.program[id].kind {
            StmtKind::Block(list) => stack.extend(&m.program[list]),
            StmtKind::Declare { global, ty, items } => {
                for item in &m.program[items] {
                    let how = match (ty.0, item.dims.len()) {
                        (Type::Int | Type::Float, 0) => Declares::Number(ty.0),
                        (Type::Farray, _) => Declares::Array,
                        _ => Declares::Other,
                    };
                    f(name(item.name.symbol), how, global);
                }
            }
            StmtKind::Param { name: ident, .. } | StmtKind::Object { name: ident, .. } => {
                f(name(ident.symbol), Declares::Other, false);
            }
            StmtKind::If { then, otherwise, .. } => {
                stack.push(then);
                stack.extend(otherwise);
            }
            StmtKind::While { body, .. } => stack.push(body),
            StmtKind::ForRange { variable, body, .. } => {
                f(name(variable.symbol), Declares::Number(Type::Float), false);
                stack.push(body);
            }
            StmtKind::For { start, step, body, .. } => {
                stack.extend([start, step, Some(body)].into_iter().flatten());
            }
            StmtKind::Foreach { variable, body, .. } => {
                f(name(variable.symbol), Declares::Other, false);
                stack.push(body);
            }
            StmtKind::Load(_) => loads = true,
            StmtKind::Routine(_)
            | StmtKind::Assign { .. }
            | StmtKind::Call(_)
            | StmtKind::Print(_)
            | StmtKind::Assert { .. }
            | StmtKind::Break
            | StmtKind::Continue
            | StmtKind::Return(_)
            | StmtKind::Error => {}
        }
    }
    !loads
}

/// What a name means in code.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meaning {
    /// A variable or array of the call under way.
    Own(Poisonable),
    /// One of the file, in a routine.
    OfFile(Poisonable),
    Constant(f64),
}

/// What is bound, as far as code can hold it.
pub(super) fn held<T: Scalar>(bound: &ScopedBinding<T>) -> Option<Captured> {
    match &bound.what {
        Binding::Variable {
            ty: ty @ (Type::Int | Type::Float), value: Value::Number(_), ..
        } => Some(Captured::Number(*ty)),
        Binding::Variable { ty: Type::Farray, value: Value::Numbers(_) | Value::Unset, .. } => {
            Some(Captured::Array)
        }
        Binding::Param(number) => Some(Captured::Param(*number)),
        _ => None,
    }
}

impl<T: Scalar> RegionCompiler<'_, T> {
    /// Makes room for the variables that statements of a unit declare.
    pub fn reserve(&mut self, unit: usize, list: &[StmtId]) -> Result<(), Unfit> {
        let m = self.units[unit].m.clone();
        let mut all: Vec<(Name, Declares)> = Vec::new();
        let of_file = self.entry == 0 && unit == 0;
        let only_known = declared(&m, list, &mut |name, how, global| {
            if !global || of_file {
                all.push((name, how));
            }
        });
        if !only_known {
            return Err(Unfit::Unit);
        }
        let mut names: Vec<Name> = Vec::new();
        for (name, _) in &all {
            if !names.contains(name) {
                names.push(*name);
            }
        }
        for name in names {
            if self.is_hidden(unit, name) || self.names[unit].contains_key(&name) {
                // A formal argument that is declared again.
                self.redeclared(unit, name);
                continue;
            }
            let mut hows = all.iter().filter(|(n, _)| *n == name).map(|(_, how)| *how);
            let first = hows.next().unwrap_or(Declares::Other);
            let array = first == Declares::Array;
            let alike = hows.all(|how| (how == Declares::Array) == array && how != Declares::Other);
            if first == Declares::Other || !alike {
                self.hide(unit, name);
                continue;
            }
            // What it is before the region begins.
            let before = match unit == self.entry {
                true => self.bound_here(name),
                false => None,
            };
            let captured = match before {
                Some(bound) => match held(bound) {
                    Some(Captured::Array) if array => Some(Captured::Array),
                    Some(Captured::Number(ty)) if !array => Some(Captured::Number(ty)),
                    _ => {
                        self.hide(unit, name);
                        continue;
                    }
                },
                None => None,
            };
            if unit == self.entry {
                let place = if of_file { NamePlace::File } else { NamePlace::Frame };
                self.guard(name, place, captured.unwrap_or(Captured::Nothing));
            }
            let mut tys: Vec<Type> = all
                .iter()
                .filter_map(|(n, how)| match how {
                    Declares::Number(ty) if *n == name => Some(*ty),
                    _ => None,
                })
                .collect();
            if let Some(Captured::Number(ty)) = captured {
                tys.push(ty);
            }
            let what = match array {
                true => self.new_array(unit, name, captured.is_some(), true),
                false => {
                    let ty = tys.first().copied().filter(|ty| tys.iter().all(|t| t == ty));
                    self.new_variable(unit, name, ty, captured, true)
                }
            };
            if captured.is_some() {
                self.set_known(what, true, true);
            }
        }
        Ok(())
    }

    /// Notes that a formal argument is declared again in its routine: code does not hold what changes its type.
    fn redeclared(&mut self, unit: usize, name: Name) {
        if self.names[unit].contains_key(&name) {
            self.hide(unit, name);
        }
    }

    /// What a name is in the frame that the region begins in.
    fn bound_here(&self, name: Name) -> Option<&ScopedBinding<T>> {
        match self.entry {
            0 => self.scope.global(name),
            _ => self.scope.frame().local(name),
        }
    }

    pub fn new_variable(
        &mut self,
        unit: usize,
        name: Name,
        ty: Option<Type>,
        captured: Option<Captured>,
        declared: bool,
    ) -> Poisonable {
        let register = self.register(unit);
        let at = self.units[unit].variables.len() as u16;
        let variable = CodeVariable { name, register, ty, captured, declared };
        self.units[unit].variables.push(variable);
        let what = Poisonable::Variable(at);
        self.names[unit].insert(name, what);
        what
    }

    pub fn new_array(
        &mut self,
        unit: usize,
        name: Name,
        captured: bool,
        declared: bool,
    ) -> Poisonable {
        let at = self.units[unit].arrays.len() as u16;
        self.units[unit].arrays.push(CodeArray { name, captured, declared });
        let what = Poisonable::Array(at);
        self.names[unit].insert(name, what);
        what
    }

    pub fn guard(&mut self, name: Name, place: NamePlace, what: Captured) {
        let guard = (name, place, what);
        if !self.guards.contains(&guard) {
            self.guards.push(guard);
        }
    }

    /// What a name means in the unit under way.
    pub fn meaning(&mut self, symbol: Symbol) -> Result<Meaning, Unfit> {
        let unit = self.unit;
        let m = self.units[unit].m.clone();
        let name = m.names[symbol.0 as usize];
        if self.is_hidden(unit, name) {
            return Err(Unfit::Statement);
        }
        if let Some(&what) = self.names[unit].get(&name) {
            // Before it is declared the name is that of the file.
            if unit != 0 && !self.known(what).bound && self.means_something_in_file(name) {
                return Err(Unfit::Unit);
            }
            return Ok(Meaning::Own(what));
        }
        if unit == self.entry && unit != 0 {
            if let Some(bound) = self.scope.frame().local(name) {
                let captured = held(bound).ok_or(Unfit::Statement)?;
                self.guard(name, NamePlace::Frame, captured);
                return Ok(Meaning::Own(self.capture(unit, name, captured)));
            }
            self.guard(name, NamePlace::Frame, Captured::Nothing);
        }
        let of_file = |what| if unit == 0 { Meaning::Own(what) } else { Meaning::OfFile(what) };
        if self.is_hidden(0, name) {
            return Err(Unfit::Statement);
        }
        if let Some(&what) = self.names[0].get(&name) {
            return Ok(of_file(what));
        }
        match self.scope.global(name) {
            Some(bound) => {
                let captured = held(bound).ok_or(Unfit::Statement)?;
                self.guard(name, NamePlace::File, captured);
                Ok(of_file(self.capture(0, name, captured)))
            }
            None => {
                self.guard(name, NamePlace::File, Captured::Nothing);
                predeclared(m.program.name(symbol)).map(Meaning::Constant).ok_or(Unfit::Statement)
            }
        }
    }

    fn capture(&mut self, unit: usize, name: Name, captured: Captured) -> Poisonable {
        let what = match captured {
            Captured::Array => self.new_array(unit, name, true, false),
            Captured::Number(ty) => self.new_variable(unit, name, Some(ty), Some(captured), false),
            _ => self.new_variable(unit, name, Some(Type::Float), Some(captured), false),
        };
        self.set_known_in(unit, what, true, true);
        what
    }

    fn means_something_in_file(&mut self, name: Name) -> bool {
        if self.scope.global(name).is_some()
            || self.names[0].contains_key(&name)
            || self.is_hidden(0, name)
        {
            return true;
        }
        self.guard(name, NamePlace::File, Captured::Nothing);
        false
    }

    /// True when a name means nothing of the program's own but possibly a routine: then it is called.
    pub fn is_free(&mut self, symbol: Symbol) -> bool {
        let unit = self.unit;
        let name = self.units[unit].m.names[symbol.0 as usize];
        if [unit, 0].iter().any(|&u| self.names[u].contains_key(&name) || self.is_hidden(u, name)) {
            return false;
        }
        if unit == self.entry && unit != 0 {
            if self.scope.frame().local(name).is_some() {
                return false;
            }
            self.guard(name, NamePlace::Frame, Captured::Nothing);
        }
        let free = self.scope.global(name).is_none();
        if free {
            self.guard(name, NamePlace::File, Captured::Nothing);
        }
        free
    }

    /// True when the file gives a name no meaning but possibly that of a routine.
    pub fn is_free_in_file(&mut self, name: Name) -> bool {
        let taken = self.names[0].contains_key(&name) || self.is_hidden(0, name);
        if taken || self.scope.global(name).is_some() {
            return false;
        }
        self.guard(name, NamePlace::File, Captured::Nothing);
        true
    }

    /// Leaves all names that a statement declares to the interpreter.
    pub fn hide_declared(&mut self, list: &[StmtId]) -> Result<(), Unfit> {
        let unit = self.unit;
        let m = self.units[unit].m.clone();
        let mut all = Vec::new();
        let only_known = declared(&m, list, &mut |name, _, global| all.push((name, global)));
        if !only_known {
            return Err(Unfit::Unit);
        }
        for (name, global) in all {
            self.hide(if global { 0 } else { unit }, name);
        }
        Ok(())
    }
}

/// The statements of a list, as ids.
pub(super) fn ids(m: &Module, list: NodeList<StmtId>) -> Vec<StmtId> {
    m.program[list].to_vec()
}
