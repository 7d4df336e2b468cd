//! The registers of compiled code, and their exchange with the interpreter's variables.

use super::code::{
    ActiveLoop, Captured, CodeRegion, CodeSite, FEW, NO_LABEL, OF_FILE, Poisonable, UNDECLARED,
};
use crate::run::interpreter::{Interpreter, MOST_CALLS};
use crate::source::module::Name;
use crate::source::scope::{Binding, CallFrame, LoopIteration, ScopedBinding};
use crate::value::initialised::Known;
use crate::value::subarray::Place;
use crate::value::variables::is_no_int;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Array, ArrayShape, Scalar, Value, Vectors};
use moldloft_syntax::sdl::Type;
use std::sync::Arc;

/// The elements of an array in code.
#[derive(Debug)]
pub(super) enum ArrayItems<T> {
    /// It has no value, or its declaration failed.
    Nothing,
    Owned(Vec<T>),
    /// Something else holds it as well.
    Shared(Arc<Array<T>>),
    /// All x, all y, all z of vectors.
    OwnedVectors([Vec<T>; 3]),
    SharedVectors(Arc<Vectors<T>>),
    OwnedText(String),
    SharedText(Arc<str>),
}

/// An array of numbers or vectors in code, or a text.
#[derive(Debug)]
pub(super) struct ArrayRegister<T> {
    pub items: ArrayItems<T>,
    pub shape: ArrayShape,
    pub known: Known,
    pub mark: u32,
    /// The turn of the `foreach` that walks through it.
    pub turn: usize,
}

/// Mark of a variable that is as it was when the region began; others are [`UNDECLARED`], or declared by
/// one of the unit's declarations, which may have failed.
pub(super) const AS_BEFORE: u32 = 1;

/// Mark of a variable made by that declaration.
#[inline(always)]
pub(super) fn declared_by(origin: u16) -> u32 {
    2 + 2 * u32::from(origin)
}

pub(super) fn poisoned_by(origin: u16) -> u32 {
    3 + 2 * u32::from(origin)
}

/// The declaration of a mark, and whether it failed.
pub(super) fn declaration(mark: u32) -> Option<(usize, bool)> {
    (mark > AS_BEFORE).then(|| ((mark as usize - 2) / 2, mark % 2 == 1))
}

/// True when a variable of this mark has a value.
#[inline(always)]
pub(super) fn is_live(mark: u32) -> bool {
    mark == AS_BEFORE || (mark > AS_BEFORE && mark & 1 == 0)
}

impl<T: Real> ArrayRegister<T> {
    pub fn nothing(mark: u32) -> Self {
        let (items, shape) = (ArrayItems::Nothing, ArrayShape::Row(0));
        Self { items, shape, known: Known::default(), mark, turn: 0 }
    }

    /// The elements, to read.
    #[inline(always)]
    pub fn read(&self) -> &[T] {
        match &self.items {
            ArrayItems::Owned(items) => items,
            ArrayItems::Shared(array) => &array.items,
            _ => &[],
        }
    }

    /// The text.
    #[inline(always)]
    pub fn text(&self) -> &str {
        match &self.items {
            ArrayItems::OwnedText(text) => text,
            ArrayItems::SharedText(text) => text,
            _ => unreachable!("a string holds a text"),
        }
    }

    /// The text, which others hold from now on as well.
    pub fn shared_text(&mut self) -> Arc<str> {
        let text = match std::mem::replace(&mut self.items, ArrayItems::Nothing) {
            ArrayItems::OwnedText(text) => Arc::from(text),
            ArrayItems::SharedText(text) => text,
            _ => unreachable!("a string holds a text"),
        };
        self.items = ArrayItems::SharedText(text.clone());
        text
    }

    /// The room of the text, for another one in its place, which may begin with it.
    pub fn text_room(&mut self, with_text: bool) -> String {
        match std::mem::replace(&mut self.items, ArrayItems::Nothing) {
            ArrayItems::OwnedText(mut text) => {
                if !with_text {
                    text.clear();
                }
                text
            }
            ArrayItems::SharedText(text) if with_text => String::from(&*text),
            _ => String::new(),
        }
    }

    /// The vector at a position in memory.
    #[inline(always)]
    pub fn vector(&self, k: usize) -> [T; 3] {
        match &self.items {
            ArrayItems::OwnedVectors(planes) => planes.each_ref().map(|plane| plane[k]),
            ArrayItems::SharedVectors(array) => array.planes.each_ref().map(|plane| plane[k]),
            _ => unreachable!("a curve or a surface holds vectors"),
        }
    }

    /// Puts a vector to a position in memory, all of it or one component.
    #[inline(always)]
    pub fn put_vector(&mut self, k: usize, v: [T; 3], part: Option<u8>) {
        if let ArrayItems::SharedVectors(_) = &self.items {
            self.own();
        }
        let ArrayItems::OwnedVectors(planes) = &mut self.items else { return };
        match part {
            Some(part) => planes[part as usize][k] = v[part as usize],
            None => planes.iter_mut().zip(v).for_each(|(plane, x)| plane[k] = x),
        }
        match self.shape {
            ArrayShape::Row(_) => self.known.give_at(k),
            ArrayShape::Grid(m, n) => {
                let point = || Vec3::from(planes.each_ref().map(|plane| plane[k].re()));
                self.known.give_vector_at(k, [m, n], point);
            }
        }
    }

    /// The elements, to write: nothing else holds them then.
    #[inline(always)]
    pub fn write(&mut self) -> &mut [T] {
        if let ArrayItems::Shared(_) = &self.items {
            self.own();
        }
        match &mut self.items {
            ArrayItems::Owned(items) => items,
            _ => &mut [],
        }
    }

    #[cold]
    pub(super) fn own(&mut self) {
        self.items = match std::mem::replace(&mut self.items, ArrayItems::Nothing) {
            ArrayItems::Shared(array) => ArrayItems::Owned(Arc::unwrap_or_clone(array).items),
            ArrayItems::SharedVectors(array) => {
                ArrayItems::OwnedVectors(Arc::unwrap_or_clone(array).planes)
            }
            other => other,
        };
    }

    /// Takes the value of a variable.
    fn take(&mut self, value: &mut Value<T>, known: &mut Known) {
        self.known = std::mem::take(known);
        match std::mem::replace(value, Value::Unset) {
            Value::Numbers(array) => {
                self.shape = array.shape;
                self.items = match Arc::try_unwrap(array) {
                    Ok(array) => ArrayItems::Owned(array.items),
                    Err(array) => ArrayItems::Shared(array),
                };
            }
            Value::Vectors(array) => {
                self.shape = array.shape;
                self.items = match Arc::try_unwrap(array) {
                    Ok(array) => ArrayItems::OwnedVectors(array.planes),
                    Err(array) => ArrayItems::SharedVectors(array),
                };
            }
            Value::Text(text) => self.items = ArrayItems::SharedText(text),
            other => {
                *value = other;
                (self.items, self.shape) = (ArrayItems::Nothing, ArrayShape::Row(0));
            }
        }
    }

    /// The value with its initialised elements; the register is empty afterwards.
    fn give(&mut self) -> (Value<T>, Known) {
        let value = match std::mem::replace(&mut self.items, ArrayItems::Nothing) {
            ArrayItems::Owned(items) => {
                Value::Numbers(Arc::new(Array { shape: self.shape, items }))
            }
            ArrayItems::Shared(array) => Value::Numbers(array),
            ArrayItems::OwnedVectors(planes) => {
                Value::Vectors(Arc::new(Vectors { shape: self.shape, planes }))
            }
            ArrayItems::SharedVectors(array) => Value::Vectors(array),
            ArrayItems::OwnedText(text) => Value::Text(text.into()),
            ArrayItems::SharedText(text) => Value::Text(text),
            ArrayItems::Nothing => Value::Unset,
        };
        (value, std::mem::take(&mut self.known))
    }

    /// The array as the argument of a routine, which gets it by value.
    pub fn passed(&mut self, mark: u32) -> Self {
        let shape = self.shape;
        self.items = match std::mem::replace(&mut self.items, ArrayItems::Nothing) {
            ArrayItems::Owned(items) => ArrayItems::Shared(Arc::new(Array { shape, items })),
            ArrayItems::OwnedVectors(planes) => {
                ArrayItems::SharedVectors(Arc::new(Vectors { shape, planes }))
            }
            ArrayItems::OwnedText(text) => ArrayItems::SharedText(text.into()),
            other => other,
        };
        let items = match &self.items {
            ArrayItems::Shared(array) => ArrayItems::Shared(array.clone()),
            ArrayItems::SharedVectors(array) => ArrayItems::SharedVectors(array.clone()),
            ArrayItems::SharedText(text) => ArrayItems::SharedText(text.clone()),
            _ => ArrayItems::Nothing,
        };
        Self { items, shape: self.shape, known: Known::default(), mark, turn: 0 }
    }
}

/// A call that waits for the one that it made.
#[derive(Clone, Copy, Debug)]
pub(super) struct WaitingCall {
    pub unit: u32,
    pub pc: u32,
    pub registers: u32,
    pub marks: u32,
    pub arrays: u32,
    pub errors: u32,
    /// Register for the value of the call, and its position.
    pub to: u16,
    pub site: u16,
}

/// State of running code.
#[derive(Debug)]
pub(super) struct RegisterMachine<T> {
    pub registers: Vec<T>,
    pub marks: Vec<u32>,
    pub arrays: Vec<ArrayRegister<T>>,
    pub waiting: Vec<WaitingCall>,
    pub unit: usize,
    pub pc: usize,
    /// Start of the current call's registers, marks and arrays.
    pub first: usize,
    pub first_mark: usize,
    pub first_array: usize,
    /// The interpreter's frames when the region began.
    pub frames: usize,
    /// True once the interpreter has a frame for a call.
    pub framed: bool,
    /// The statements that were executed, by unit.
    pub executed: Vec<Vec<bool>>,
}

impl<T: Scalar> RegisterMachine<T> {
    pub fn new(region: &CodeRegion<T>, frames: usize) -> Self {
        let mut machine = Self {
            registers: Vec::new(),
            marks: Vec::new(),
            arrays: Vec::new(),
            waiting: Vec::new(),
            unit: region.entry,
            pc: 0,
            first: 0,
            first_mark: 0,
            first_array: 0,
            frames,
            framed: false,
            executed: region.units.iter().map(|u| vec![false; u.statements.len()]).collect(),
        };
        for unit in 0..=region.entry {
            machine.first = machine.registers.len();
            machine.first_mark = machine.marks.len();
            machine.first_array = machine.arrays.len();
            let code = &region.units[unit];
            machine.registers.resize(machine.first + code.registers, T::zero());
            for &(register, x) in &code.constants {
                machine.registers[machine.first + register as usize] = x;
            }
            for variable in &code.variables {
                let before = variable.captured.is_some();
                machine.marks.push(if before { AS_BEFORE } else { UNDECLARED });
            }
            for array in &code.arrays {
                let mark = if array.captured { AS_BEFORE } else { UNDECLARED };
                let mut register = ArrayRegister::nothing(mark);
                if let Some(text) = &array.text {
                    register.items = ArrayItems::SharedText(text.clone());
                }
                machine.arrays.push(register);
            }
        }
        machine
    }

    /// Returns to a waiting call, at its call instruction.
    #[inline(always)]
    pub fn back_to(&mut self, call: WaitingCall) {
        let arrays = self.first_array.max(call.arrays as usize);
        if self.arrays.len() > arrays {
            self.arrays.truncate(arrays);
        }
        self.unit = call.unit as usize;
        self.pc = call.pc as usize;
        self.first = call.registers as usize;
        self.first_mark = call.marks as usize;
        self.first_array = call.arrays as usize;
    }

    /// Begins the call of a site; false when there are too many calls.
    #[inline(always)]
    pub fn enters(&mut self, region: &CodeRegion<T>, to: u16, site: u16, errors: usize) -> bool {
        if self.frames + self.waiting.len() >= MOST_CALLS {
            return false;
        }
        let code = &region.units[self.unit];
        let called = &code.sites[site as usize];
        let callee = &region.units[called.unit];
        self.waiting.push(WaitingCall {
            unit: self.unit as u32,
            pc: self.pc as u32,
            registers: self.first as u32,
            marks: self.first_mark as u32,
            arrays: self.first_array as u32,
            errors: errors as u32,
            to,
            site,
        });
        let first = self.first + code.registers;
        let marks = self.first_mark + code.variables.len();
        let (end, end_of_marks) = (first + callee.registers, marks + callee.marks.len().max(FEW));
        if self.registers.len() < end || self.marks.len() < end_of_marks {
            self.make_room(end, end_of_marks);
        }
        let (outer, own) = self.registers.split_at_mut(first);
        let outer = &outer[self.first..];
        for &(from, to) in &called.moves.numbers {
            own[to as usize] = outer[from as usize];
        }
        for &(register, x) in &callee.constants {
            own[register as usize] = x;
        }
        self.marks[marks..marks + FEW].copy_from_slice(&callee.few_marks);
        if callee.marks.len() > FEW {
            self.marks[marks + FEW..end_of_marks].copy_from_slice(&callee.marks[FEW..]);
        }
        let arrays = self.arrays.len();
        if !callee.arrays.is_empty() {
            self.pass_arrays(called, arrays + callee.arrays.len());
        }
        (self.unit, self.pc) = (called.unit, 0);
        (self.first, self.first_mark, self.first_array) = (first, marks, arrays);
        true
    }

    #[cold]
    fn make_room(&mut self, registers: usize, marks: usize) {
        let most = |now: usize, asked: usize| if now < asked { 2 * asked } else { now };
        self.registers.resize(most(self.registers.len(), registers), T::zero());
        self.marks.resize(most(self.marks.len(), marks), UNDECLARED);
    }

    /// Makes the arrays of a call up to number `end`, those passed to it among them.
    fn pass_arrays(&mut self, called: &CodeSite, end: usize) {
        let first = self.arrays.len();
        self.arrays.resize_with(end, || ArrayRegister::nothing(UNDECLARED));
        for &(from, to, formal) in &called.moves.arrays {
            let own = self.first_array + from as usize;
            let of_file = (from & !OF_FILE) as usize;
            let from = if from & OF_FILE == 0 { own } else { of_file };
            let passed = self.arrays[from].passed(declared_by(formal));
            self.arrays[first + to as usize] = passed;
        }
    }

    /// Goes back to the call that waits with a number of the routine's type, or a vector for a vector, when no frame of
    /// the interpreter was made: the usual case. False when it is another.
    #[inline(always)]
    pub fn returns_plainly(&mut self, result: Option<Type>, x: &[T]) -> bool {
        let fits = match result {
            Some(Type::Float) => x.len() == 1,
            Some(Type::Int) => x.len() == 1 && !is_no_int(x[0].re()),
            Some(Type::Vector) => x.len() == 3,
            _ => false,
        };
        if !fits || self.framed {
            return false;
        }
        let Some(call) = self.waiting.pop() else { return false };
        self.back_to(call);
        self.pc += 1;
        if call.to != NO_LABEL {
            let to = self.first + call.to as usize;
            self.registers[to..to + x.len()].copy_from_slice(x);
        }
        true
    }

    /// Makes the variable of the failed current declaration undefined.
    pub fn poison(&mut self, region: &CodeRegion<T>) {
        let Some((what, origin)) = region.units[self.unit].poison(self.pc) else { return };
        match what {
            Poisonable::Variable(k) => {
                self.marks[self.first_mark + k as usize] = poisoned_by(origin);
            }
            Poisonable::Array(k) => {
                self.arrays[self.first_array + k as usize] =
                    ArrayRegister::nothing(poisoned_by(origin));
            }
        }
    }

    /// Leaves the current calls; the region's own part remains.
    pub fn unwind(&mut self) {
        if let Some(&call) = self.waiting.first() {
            self.back_to(call);
            self.waiting.clear();
        }
    }

    /// Start of the part of call number `at`, 0 for the region itself: unit, registers, marks,
    /// arrays.
    fn part(&self, at: usize) -> [usize; 4] {
        match self.waiting.get(at) {
            Some(call) => [call.unit, call.registers, call.marks, call.arrays].map(|x| x as usize),
            None => [self.unit, self.first, self.first_mark, self.first_array],
        }
    }
}

/// A frame of the interpreter: that of the file, or a call's.
#[derive(Clone, Copy, Debug, PartialEq)]
enum VariableFrame {
    File,
    Call(usize),
}

impl<T: Scalar> Interpreter<'_, '_, T> {
    fn bound_in(&mut self, frame: VariableFrame, name: Name) -> Option<&mut ScopedBinding<T>> {
        match frame {
            VariableFrame::File => self.env.scope.globals.get_mut(name.0 as usize)?.as_mut(),
            VariableFrame::Call(at) => {
                let locals = &mut self.env.scope.frames.get_mut(at)?.locals;
                locals.iter_mut().find(|(n, _)| *n == name).map(|(_, bound)| bound)
            }
        }
    }

    /// The binding, or its target if it was passed by reference.
    fn root_in(&mut self, frame: VariableFrame, name: Name) -> Option<&mut ScopedBinding<T>> {
        match self.bound_in(frame, name)?.what {
            Binding::Reference(place) => self.env.scope.root_mut(&place),
            _ => self.bound_in(frame, name),
        }
    }

    fn bind_in(&mut self, frame: VariableFrame, name: Name, bound: ScopedBinding<T>) {
        if let Some(old) = self.bound_in(frame, name) {
            *old = bound;
            return;
        }
        match frame {
            VariableFrame::File => {
                self.env.scope.make_room(self.modules.name_count());
                self.env.scope.globals[name.0 as usize] = Some(bound);
            }
            VariableFrame::Call(at) => self.env.scope.frames[at].locals.push((name, bound)),
        }
    }

    /// Puts the variables of a part into the interpreter's frame; arrays as well, if they are wanted.
    fn put_back(
        &mut self,
        region: &CodeRegion<T>,
        machine: &mut RegisterMachine<T>,
        [unit, registers, marks, arrays]: [usize; 4],
        frame: VariableFrame,
        with_arrays: bool,
    ) {
        let code = &region.units[unit];
        for (k, variable) in code.variables.iter().enumerate() {
            let mark = machine.marks[marks + k];
            let at = registers + variable.register as usize;
            let value = match variable.ty {
                Some(Type::Vector) => {
                    let [x, y, z] = [0, 1, 2].map(|c| machine.registers[at + c]);
                    Value::Vector(Vec3 { x, y, z })
                }
                _ => Value::Number(machine.registers[at]),
            };
            let Some((origin, failed)) = declaration(mark) else {
                if let (AS_BEFORE, Some(Captured::Variable(_) | Captured::Passed(_))) =
                    (mark, variable.captured)
                    && let Some(bound) = self.root_in(frame, variable.name)
                    && let Binding::Variable { value: old, .. } = &mut bound.what
                {
                    *old = value;
                }
                continue;
            };
            let (span, ty) = code.origins[origin];
            let what = if failed { Binding::Poisoned } else { Binding::variable(ty, value) };
            self.bind_in(frame, variable.name, ScopedBinding { span, what });
        }
        if !with_arrays {
            return;
        }
        for (k, array) in code.arrays.iter().enumerate() {
            let Some(name) = array.name else { continue };
            let register = &mut machine.arrays[arrays + k];
            let mark = register.mark;
            if mark == UNDECLARED {
                continue;
            }
            let (value, known) = register.give();
            let Some((origin, failed)) = declaration(mark) else {
                if let Some(bound) = self.root_in(frame, name)
                    && let Binding::Variable { value: old, known: of, .. } = &mut bound.what
                {
                    (*old, *of) = (value, known);
                }
                continue;
            };
            let (span, ty) = code.origins[origin];
            // An argument takes any shape, and so does an array declared without dimensions.
            let fixed = !code.formals.contains(&Some(Poisonable::Array(k as u16)))
                && !code.unfixed.contains(&(origin as u16));
            let what = match failed {
                true => Binding::Poisoned,
                false => Binding::Variable { ty, value, fixed, known },
            };
            self.bind_in(frame, name, ScopedBinding { span, what });
        }
    }

    /// Takes the variables of a part from the interpreter's frame.
    fn take_over(
        &mut self,
        region: &CodeRegion<T>,
        machine: &mut RegisterMachine<T>,
        [unit, registers, marks, arrays]: [usize; 4],
        frame: VariableFrame,
    ) {
        let code = &region.units[unit];
        for (k, variable) in code.variables.iter().enumerate() {
            let to = registers + variable.register as usize;
            if let Some(Captured::Param(number)) = variable.captured {
                machine.registers[to] = self.env.param_values[number];
                continue;
            }
            if !is_live(machine.marks[marks + k]) {
                continue;
            }
            match self.root_in(frame, variable.name).map(|bound| &bound.what) {
                Some(Binding::Variable { value: Value::Number(x), .. }) => {
                    machine.registers[to] = *x;
                }
                Some(Binding::Variable { value: Value::Vector(v), .. }) => {
                    machine.registers[to..to + 3].copy_from_slice(&v.to_array());
                }
                other => unreachable!("a variable in code has become {other:?}"),
            }
        }
        for (k, array) in code.arrays.iter().enumerate() {
            let Some(name) = array.name else { continue };
            let register = &mut machine.arrays[arrays + k];
            if !is_live(register.mark) {
                continue;
            }
            match self.root_in(frame, name).map(|bound| &mut bound.what) {
                Some(Binding::Variable { value, known, .. }) => register.take(value, known),
                other => unreachable!("an array in code has become {other:?}"),
            }
        }
    }

    /// Starts of the parts visible to the interpreter: the file's, the region's own, the current
    /// call's.
    fn visible(
        &self,
        region: &CodeRegion<T>,
        machine: &RegisterMachine<T>,
    ) -> Vec<([usize; 4], VariableFrame)> {
        let mut all = vec![([0; 4], VariableFrame::File)];
        if region.entry > 0 {
            all.push((machine.part(0), VariableFrame::Call(machine.frames - 1)));
        }
        let depth = machine.waiting.len();
        if depth > 0 {
            all.push((machine.part(depth), VariableFrame::Call(machine.frames - 1 + depth)));
        }
        all
    }

    /// The active loops at a position of a part.
    fn loops_at(
        &self,
        machine: &RegisterMachine<T>,
        registers: usize,
        loops: &[ActiveLoop],
    ) -> Vec<LoopIteration> {
        let number = |at: u16| machine.registers[registers + at as usize].re();
        loops
            .iter()
            .map(|l| LoopIteration {
                label: l.labelled.then(|| number(l.at)).filter(|x| !x.is_nan()),
                id: number(l.at + 1) as u64,
            })
            .collect()
    }

    /// Hands all variables to the interpreter; frames are made for calls without one.
    pub(super) fn hand_over(&mut self, region: &CodeRegion<T>, machine: &mut RegisterMachine<T>) {
        let depth = machine.waiting.len();
        for at in self.env.scope.frames.len() - machine.frames + 1..=depth {
            let caller = machine.waiting[at - 1];
            let unit = caller.unit as usize;
            let site = &region.units[unit].sites[caller.site as usize];
            let outer = self.env.scope.frame();
            let mut frame = CallFrame::new(false, outer.prefix.clone());
            frame.loops = outer.loops.clone();
            let registers = caller.registers as usize;
            frame.loops.extend(self.loops_at(machine, registers, &site.loops));
            frame.called = Some((site.span, region.units[unit].module as u32));
            for &(name, span, of_file) in &region.units[machine.part(at)[0]].references {
                let what = Binding::Reference(Place::whole(None, of_file));
                frame.locals.push((name, ScopedBinding { span, what }));
            }
            self.env.scope.frames.push(frame);
            machine.framed = true;
            if at < depth {
                let part = machine.part(at);
                let frame = VariableFrame::Call(machine.frames - 1 + at);
                self.put_back(region, machine, part, frame, false);
            }
        }
        for (part, frame) in self.visible(region, machine) {
            self.put_back(region, machine, part, frame, true);
        }
    }

    /// Takes all variables back.
    pub(super) fn take_back(&mut self, region: &CodeRegion<T>, machine: &mut RegisterMachine<T>) {
        for (part, frame) in self.visible(region, machine) {
            self.take_over(region, machine, part, frame);
        }
    }

    /// Runs work of the interpreter at a position of the code, with all variables handed over.
    pub(super) fn interpreted<R>(
        &mut self,
        region: &CodeRegion<T>,
        machine: &mut RegisterMachine<T>,
        loops: &[ActiveLoop],
        work: impl FnOnce(&mut Self) -> R,
    ) -> R {
        self.hand_over(region, machine);
        let inner = self.loops_at(machine, machine.first, loops);
        let known = self.env.scope.frame().loops.len();
        self.env.scope.frame_mut().loops.extend(inner);
        let current = std::mem::replace(&mut self.current, region.units[machine.unit].module);
        let done = work(self);
        self.current = current;
        self.env.scope.frame_mut().loops.truncate(known);
        self.take_back(region, machine);
        done
    }

    /// The binding of a name, if code supports it.
    pub(super) fn guarded(&self, name: Name, of_file: bool) -> Option<Captured> {
        let bound = match of_file {
            true => self.env.scope.global(name),
            false => self.env.scope.frame().local(name),
        };
        match bound {
            Some(bound) => super::names::held(&self.env.scope, bound),
            None => Some(Captured::Nothing),
        }
    }
}
