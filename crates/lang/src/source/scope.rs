//! Bindings of names during a run.

use crate::source::module::{Name, RoutineAt};
use crate::value::initialised::Known;
use crate::value::subarray::Place;
use moldloft_diag::Span;
use moldloft_num::trace::Key;
use moldloft_registry::{Row, Scalar, Value};
use moldloft_syntax::sdl::{StmtId, Type};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Binding of a name.
#[derive(Clone, Debug)]
pub enum Binding<T: Scalar> {
    /// A variable of a type; `fixed` if its dimensions were declared.
    Variable {
        /// The declared type.
        ty: Type,
        /// The value now.
        value: Value<T>,
        /// True when the dimensions were declared.
        fixed: bool,
        /// The elements that have a value, and whether edges are closed.
        known: Known,
    },
    /// A part of a variable of a caller, passed by reference.
    Reference(Place),
    /// The arguments of a multiple argument.
    Multiple(Box<Multiple<T>>),
    /// A design parameter, by its number.
    Param(usize),
    /// An object.
    Object(Key),
    /// An object or variable made in a loop: `now` in the iteration `turn`, afterwards the list of
    /// all.
    Turn {
        /// The object of this iteration.
        now: Key,
        /// The iteration, by its number.
        turn: u64,
        /// The name of the list of all iterations.
        family: Arc<str>,
    },
    /// A named call of a subroutine: the list of its objects.
    Instance(Arc<str>),
    /// A routine of a program passed as an argument.
    Routine(RoutineAt),
    /// A function of the registry passed as an argument.
    Function(Arc<Row>),
    /// The declaration failed and was reported; uses are not reported.
    Poisoned,
}

impl<T: Scalar> Binding<T> {
    /// A variable with the dimensions of the assigned value.
    pub fn variable(ty: Type, value: Value<T>) -> Self {
        Binding::Variable { ty, value, fixed: false, known: Known::default() }
    }
}

/// A multiple argument, read item by item.
#[derive(Clone, Debug)]
pub struct Multiple<T: Scalar> {
    /// The declared type of every argument.
    pub ty: Type,
    /// The arguments, in order.
    pub items: Vec<Passed<T>>,
    /// Number of arguments read by `next`.
    pub read: usize,
}

/// An argument as passed.
#[derive(Clone, Debug)]
pub enum Passed<T: Scalar> {
    /// A value, copied.
    Value(Value<T>),
    /// A variable of the caller, passed by reference.
    Place(Place),
}

/// A binding with its origin.
#[derive(Clone, Debug)]
pub struct ScopedBinding<T: Scalar> {
    /// The span of the declaration.
    pub span: Span,
    /// The meaning of the name.
    pub what: Binding<T>,
}

/// The variables of a routine's call, or of the file level of a load.
#[derive(Debug)]
pub struct CallFrame<T: Scalar> {
    /// The variables, in the order of their declaration.
    pub locals: Vec<(Name, ScopedBinding<T>)>,
    /// True at file level, where names are global.
    pub global: bool,
    /// Prefix of the names of objects: "fore." in the call `leg fore(...)`.
    pub prefix: Arc<str>,
    /// The active loops, outermost first.
    pub loops: Vec<LoopIteration>,
    /// The call of the frame, and the module that contains it.
    pub called: Option<(Span, u32)>,
}

/// An iteration of an active loop.
#[derive(Clone, Debug)]
pub struct LoopIteration {
    /// The loop variable's value as used in names; `None` in a `while`.
    pub label: Option<f64>,
    /// Unique among the iterations of a run.
    pub id: u64,
}

impl<T: Scalar> CallFrame<T> {
    /// A frame without variables.
    pub fn new(global: bool, prefix: Arc<str>) -> Self {
        Self { locals: Vec::new(), global, prefix, loops: Vec::new(), called: None }
    }

    /// The variable of that name.
    pub fn local(&self, name: Name) -> Option<&ScopedBinding<T>> {
        self.locals.iter().find(|(n, _)| *n == name).map(|(_, bound)| bound)
    }
}

/// Declaration of a record type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordAt {
    /// The module.
    pub module: usize,
    /// The statement in it.
    pub stmt: StmtId,
}

/// The state of one file during a run: a component runs in another scope than its user.
#[derive(Debug)]
pub struct Scope<T: Scalar> {
    /// Bindings at file level, by number of the name.
    pub globals: Vec<Option<ScopedBinding<T>>>,
    /// Subroutines and functions.
    pub routines: HashMap<Name, RoutineAt>,
    /// Types of records.
    pub records: HashMap<Name, RecordAt>,
    /// The active calls; the first is the file itself.
    pub frames: Vec<CallFrame<T>>,
    /// The modules that were run.
    pub executed: HashSet<usize>,
    /// Sketch files already loaded.
    pub sketches_done: HashSet<String>,
    /// The names given by the user of a component.
    pub given: HashSet<Name>,
}

impl<T: Scalar> Default for Scope<T> {
    fn default() -> Self {
        Self::of_file("".into(), 0)
    }
}

impl<T: Scalar> Scope<T> {
    /// The scope of a file before its run, with the prefix of its objects and the number of known
    /// names.
    pub fn of_file(prefix: Arc<str>, names: usize) -> Self {
        let mut globals = Vec::new();
        globals.resize_with(names, || None);
        Self {
            globals,
            routines: HashMap::new(),
            records: HashMap::new(),
            frames: vec![CallFrame::new(true, prefix)],
            executed: HashSet::new(),
            sketches_done: HashSet::new(),
            given: HashSet::new(),
        }
    }

    /// Prepares statements, or an expression, at file level; bindings are kept.
    pub fn enter(&mut self, names: usize) {
        let Self { globals, routines, records, .. } = std::mem::take(self);
        *self = Self { globals, routines, records, ..Self::default() };
        self.make_room(names);
    }

    /// Reserves space for `names` names.
    pub fn make_room(&mut self, names: usize) {
        self.globals.resize_with(names, || None);
    }

    /// The innermost frame.
    pub fn frame(&self) -> &CallFrame<T> {
        self.frames.last().expect("there is always a frame")
    }

    /// The innermost frame, mutable.
    pub fn frame_mut(&mut self) -> &mut CallFrame<T> {
        self.frames.last_mut().expect("there is always a frame")
    }

    /// Gives a name a meaning in the innermost frame.
    pub fn bind(&mut self, name: Name, span: Span, what: Binding<T>) {
        let bound = ScopedBinding { span, what };
        if self.frame().global {
            let at = name.0 as usize;
            if at >= self.globals.len() {
                self.make_room(at + 1);
            }
            self.globals[at] = Some(bound);
            return;
        }
        let locals = &mut self.frame_mut().locals;
        match locals.iter_mut().find(|(n, _)| *n == name) {
            Some((_, old)) => *old = bound,
            None => locals.push((name, bound)),
        }
    }

    /// The binding of a name at file level.
    pub fn global(&self, name: Name) -> Option<&ScopedBinding<T>> {
        self.globals.get(name.0 as usize)?.as_ref()
    }

    /// The binding of a name in the current scope.
    pub fn lookup(&self, name: Name) -> Option<&ScopedBinding<T>> {
        self.frame().local(name).or_else(|| self.global(name))
    }

    /// The binding of a name in the innermost frame alone.
    pub fn own(&self, name: Name) -> Option<&ScopedBinding<T>> {
        if self.frame().global { self.global(name) } else { self.frame().local(name) }
    }

    /// The variable that contains a place.
    pub fn root(&self, place: &Place) -> Option<&ScopedBinding<T>> {
        match place.frame {
            None => self.global(place.name),
            Some(frame) => self.frames.get(frame as usize)?.local(place.name),
        }
    }

    /// The variable that contains a place, mutable.
    pub fn root_mut(&mut self, place: &Place) -> Option<&mut ScopedBinding<T>> {
        match place.frame {
            None => self.globals.get_mut(place.name.0 as usize)?.as_mut(),
            Some(frame) => {
                let locals = &mut self.frames.get_mut(frame as usize)?.locals;
                locals.iter_mut().find(|(n, _)| *n == place.name).map(|(_, bound)| bound)
            }
        }
    }

    /// The whole variable of a name, as a place; for one passed by reference, the caller's
    /// variable.
    pub fn place_of(&self, name: Name) -> Option<Place> {
        let at = self.frames.len() - 1;
        let (bound, frame) = match self.frames[at].local(name) {
            Some(bound) => (bound, Some(at as u32)),
            None => (self.global(name)?, None),
        };
        Some(match &bound.what {
            Binding::Reference(place) => *place,
            _ => Place::whole(frame, name),
        })
    }

    /// True for a name at file level given by the user of a component.
    pub fn is_given(&self, name: Name) -> bool {
        !self.given.is_empty() && self.frame().global && self.given.contains(&name)
    }
}
