//! Declarations of statements, and bindings of names in compiled code.

use super::code::{Captured, CodeArray, CodeVariable, NamePlace, Poisonable};
use super::compile::{RegionCompiler, Unfit};
use crate::functions::files::predeclared;
use crate::source::module::{Module, Name};
use crate::source::scope::{Binding, Scope, ScopedBinding};
use moldloft_registry::{Scalar, Value};
use moldloft_syntax::sdl::{ExprId, NodeList, StmtId, StmtKind, Symbol, Type};

/// Kind of a declaration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Declares {
    /// A number or a vector.
    Variable(Type),
    Array(Type),
    /// An element of the expression's value.
    Element(ExprId),
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
                        (_, 1) if ty.0 == Type::Surface => Declares::Other,
                        _ if item.list.is_some() => Declares::Other,
                        (Type::Int | Type::Float | Type::Vector, 0) => Declares::Variable(ty.0),
                        (Type::Farray | Type::Curve | Type::Surface, _) | (Type::String, 0) => {
                            Declares::Array(ty.0)
                        }
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
                f(name(variable.symbol), Declares::Variable(Type::Float), false);
                stack.push(body);
            }
            StmtKind::For { start, step, body, .. } => {
                stack.extend([start, step, Some(body)].into_iter().flatten());
            }
            StmtKind::Foreach { variable, list, body } => {
                f(name(variable.symbol), Declares::Element(list), false);
                stack.push(body);
            }
            StmtKind::Load(_) => loads = true,
            StmtKind::Routine(_)
            | StmtKind::Record { .. }
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

/// Storage class of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
enum RoomKind {
    /// A number; `None` if its type depends on the executed path.
    Number(Option<Type>),
    Vector,
    Array(Type),
}

impl RoomKind {
    /// The storage class for these declarations; `None` if they need different ones.
    fn of(hows: &[Declares]) -> Option<Self> {
        let (&first, rest) = hows.split_first()?;
        let alike = rest.iter().all(|how| *how == first);
        match first {
            Declares::Array(ty) if alike => Some(RoomKind::Array(ty)),
            Declares::Variable(Type::Vector) if alike => Some(RoomKind::Vector),
            Declares::Variable(ty) => {
                let number =
                    |how: &Declares| matches!(how, Declares::Variable(Type::Int | Type::Float));
                hows.iter().all(number).then_some(RoomKind::Number(Some(ty).filter(|_| alike)))
            }
            _ => None,
        }
    }

    /// True if the previous binding has the same storage class.
    fn takes(self, captured: Captured) -> bool {
        match captured {
            Captured::Variable(Type::Vector) => self == RoomKind::Vector,
            Captured::Variable(_) => matches!(self, RoomKind::Number(_)),
            Captured::Array(ty) => self == RoomKind::Array(ty),
            _ => false,
        }
    }
}

/// Meaning of a name in code.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meaning {
    /// A variable or array of the current call.
    Own(Poisonable),
    /// One of the file, in a routine.
    OfFile(Poisonable),
    Constant(f64),
}

/// A binding, if code supports it.
pub(super) fn held<T: Scalar>(scope: &Scope<T>, bound: &ScopedBinding<T>) -> Option<Captured> {
    match &bound.what {
        Binding::Variable { ty, value, .. } => match (ty, value) {
            (Type::Int | Type::Float, Value::Number(_)) | (Type::Vector, Value::Vector(_)) => {
                Some(Captured::Variable(*ty))
            }
            (Type::String, Value::Text(_))
            | (Type::Farray, Value::Numbers(_) | Value::Unset)
            | (Type::Curve | Type::Surface, Value::Vectors(_) | Value::Unset) => {
                Some(Captured::Array(*ty))
            }
            _ => None,
        },
        Binding::Param(number) => Some(Captured::Param(*number)),
        Binding::Reference(place) if place.is_whole() => {
            match (held(scope, scope.root(place)?)?, place.frame) {
                (Captured::Variable(_) | Captured::Array(_), None) => {
                    Some(Captured::OfFile(place.name))
                }
                (Captured::Variable(ty), Some(_)) => Some(Captured::Passed(ty)),
                (Captured::Array(ty), Some(_)) => Some(Captured::PassedArray(ty)),
                _ => None,
            }
        }
        _ => None,
    }
}

pub(super) fn element_type(ty: Type) -> Type {
    if ty == Type::Farray { Type::Float } else { Type::Vector }
}

impl<T: Scalar> RegionCompiler<'_, T> {
    /// Reserves registers for the variables that statements of a unit declare.
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
            if self.is_hidden(unit, name)
                || self.names[unit].contains_key(&name)
                || self.references[unit].contains_key(&name)
            {
                // A formal argument that is declared again.
                self.redeclared(unit, name);
                continue;
            }
            let hows: Vec<Declares> = all
                .iter()
                .filter(|(n, _)| *n == name)
                .map(|(_, how)| self.resolved(unit, *how, &all))
                .collect();
            let Some(kind) = RoomKind::of(&hows) else {
                self.hide(unit, name);
                continue;
            };
            // Binding before the region begins.
            let before = match unit == self.entry {
                true => self.bound_here(name),
                false => None,
            };
            let captured = match before {
                Some(bound) => match held(self.scope, bound) {
                    Some(captured) if kind.takes(captured) => Some(captured),
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
            let what = match kind {
                RoomKind::Array(ty) => {
                    self.new_array(unit, Some(name), ty, captured.is_some(), true)
                }
                RoomKind::Vector => {
                    self.new_variable(unit, name, Some(Type::Vector), captured, true)
                }
                RoomKind::Number(ty) => {
                    let same = |captured| ty.map(Captured::Variable) == Some(captured);
                    let ty = ty.filter(|_| captured.is_none_or(same));
                    self.new_variable(unit, name, ty, captured, true)
                }
            };
            if captured.is_some() {
                self.set_known(what, true, true);
            }
        }
        Ok(())
    }

    /// The declaration of a `foreach` depends on its sequence.
    fn resolved(&self, unit: usize, how: Declares, all: &[(Name, Declares)]) -> Declares {
        let Declares::Element(list) = how else { return how };
        let m = &self.units[unit].m;
        let Some(symbol) = m.program.as_name(list) else { return Declares::Other };
        let name = m.names[symbol.0 as usize];
        let mut declared = all.iter().filter(|(n, _)| *n == name).map(|(_, how)| *how);
        let array = match (declared.next(), self.names[unit].get(&name)) {
            (Some(Declares::Array(ty)), _) => Some(ty),
            (Some(_), _) => None,
            (None, Some(Poisonable::Array(k))) => Some(self.units[unit].arrays[*k as usize].ty),
            (None, Some(Poisonable::Variable(_))) => None,
            (None, None) => {
                let own = || self.scope.frame().local(name).filter(|_| unit == self.entry);
                let bound = match self.references[unit].get(&name) {
                    Some(of_file) => self.scope.global(*of_file),
                    None => own().or_else(|| self.scope.global(name)),
                };
                match bound.and_then(|bound| held(self.scope, bound)) {
                    Some(Captured::Array(ty) | Captured::PassedArray(ty)) => Some(ty),
                    Some(Captured::OfFile(name)) => {
                        match self.scope.global(name).and_then(|bound| held(self.scope, bound)) {
                            Some(Captured::Array(ty)) => Some(ty),
                            _ => None,
                        }
                    }
                    _ => None,
                }
            }
        };
        array
            .filter(|ty| *ty != Type::String)
            .map_or(Declares::Other, |ty| Declares::Variable(element_type(ty)))
    }

    /// Excludes a formal argument that is declared again in its routine, since its type may change.
    fn redeclared(&mut self, unit: usize, name: Name) {
        if self.names[unit].contains_key(&name) || self.references[unit].contains_key(&name) {
            self.hide(unit, name);
        }
    }

    /// The binding of a name in the frame of the region's start.
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
        let register = match ty {
            Some(Type::Vector) => self.three_registers(unit),
            _ => self.register(unit),
        };
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
        name: Option<Name>,
        ty: Type,
        captured: bool,
        declared: bool,
    ) -> Poisonable {
        let at = self.units[unit].arrays.len() as u16;
        self.units[unit].arrays.push(CodeArray { name, ty, captured, declared, text: None });
        let what = Poisonable::Array(at);
        if let Some(name) = name {
            self.names[unit].insert(name, what);
        }
        what
    }

    pub fn guard(&mut self, name: Name, place: NamePlace, what: Captured) {
        let guard = (name, place, what);
        if !self.guards.contains(&guard) {
            self.guards.push(guard);
        }
    }

    /// The meaning of a name in the current unit.
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
        let mut name = name;
        if let Some(&of_file) = self.references[unit].get(&name) {
            name = of_file;
        } else if unit == self.entry && unit != 0 {
            if let Some(bound) = self.scope.frame().local(name) {
                let captured = held(self.scope, bound).ok_or(Unfit::Statement)?;
                self.guard(name, NamePlace::Frame, captured);
                match captured {
                    Captured::OfFile(of_file) => name = of_file,
                    _ => return Ok(Meaning::Own(self.capture(unit, name, captured))),
                }
            } else {
                self.guard(name, NamePlace::Frame, Captured::Nothing);
            }
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
                let captured = held(self.scope, bound).ok_or(Unfit::Statement)?;
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
            Captured::Array(ty) | Captured::PassedArray(ty) => {
                self.new_array(unit, Some(name), ty, true, false)
            }
            Captured::Variable(ty) | Captured::Passed(ty) => {
                self.new_variable(unit, name, Some(ty), Some(captured), false)
            }
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
        let taken = |u: usize| {
            self.names[u].contains_key(&name)
                || self.references[u].contains_key(&name)
                || self.is_hidden(u, name)
        };
        if taken(unit) || taken(0) {
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
