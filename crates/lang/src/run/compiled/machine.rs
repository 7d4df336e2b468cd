//! The machine that executes code.

use super::code::{CodeRegion, CodeUnit, NO_LABEL, OF_FILE, Relation, ScalarOp, UNDECLARED};
use super::registers::{
    ArrayItems, ArrayRegister, RegisterMachine, declaration, declared_by, is_live,
};
use super::texts::{ArraysByNumber, formatted};
use crate::functions::elementary::{Elementary, small_remainder};
use crate::run::interpreter::{Flow, Interpreter, MOST_CALLS, silent};
use crate::run::usage;
use crate::value::initialised::Known;
use crate::value::ops;
use crate::value::variables::{self, is_no_int};
use moldloft_diag::Diagnostic;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{ArrayShape, Scalar, Value};
use moldloft_syntax::sdl::Type;
use std::cmp::Ordering;

/// Number of steps between checks of limits.
const STEPS_BETWEEN_LOOKS: u64 = 256;

/// Continuation after an operation outside the registers.
pub(super) enum CodeOutcome<T: Scalar> {
    Next,
    Return(Option<Value<T>>),
    Stop,
}

/// Why the machine leaves the operations on registers.
enum Departure<T> {
    /// The next step may be one too many, or it is time to look for a request to stop.
    Look,
    Fault,
    TooDeep,
    /// What the caller does not take as it is.
    Return(T),
    ReturnVector([T; 3]),
    Leave,
    End,
    Interpret {
        site: u16,
    },
    Condition {
        to: u16,
        site: u16,
    },
    Kernel(u16),
}

/// Zero-based index of a subscript, rounded as in the interpreter.
#[inline(always)]
fn place(x: f64, count: usize) -> Option<usize> {
    // No array has more elements than an i32 counts.
    let at = x as i32;
    (f64::from(at) == x && at >= 1 && at as usize <= count).then(|| at as usize - 1)
}

/// Position in memory of an element; `None` when the array has no such.
#[inline(always)]
fn element(shape: ArrayShape, i: f64, j: Option<f64>) -> Option<usize> {
    match (shape, j) {
        (ArrayShape::Row(n), None) => place(i, n),
        (ArrayShape::Grid(m, n), Some(j)) => Some(place(i, m)? * n + place(j, n)?),
        _ => None,
    }
}

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// Executes code from the first operation of its entry to the end.
    pub(super) fn execute(
        &mut self,
        region: &CodeRegion<T>,
        machine: &mut RegisterMachine<T>,
    ) -> Flow<T> {
        let most = self.limits.steps;
        let mut look_at = self.usage.steps;
        loop {
            let (mut steps, mut turns) = (self.usage.steps, self.turns);
            let departure = self.of_call(region, machine, &mut steps, &mut turns, look_at);
            self.quick(steps - self.usage.steps);
            self.turns = turns;
            let outcome = match departure {
                Departure::Return(x) => self.returned_from(region, machine, Some(Value::Number(x))),
                Departure::ReturnVector(v) => {
                    let v = Value::Vector(Vec3::from(v));
                    self.returned_from(region, machine, Some(v))
                }
                Departure::Look => match self.may_not_go_on(region, machine) {
                    true => CodeOutcome::Stop,
                    false => CodeOutcome::Next,
                },
                Departure::Fault => self.fault(region, machine),
                Departure::TooDeep => {
                    let code = &region.units[machine.unit];
                    let span = match code.code[machine.pc] {
                        ScalarOp::Call { site, .. } => code.sites[site as usize].span,
                        _ => code.range(machine.pc).fault,
                    };
                    self.too_many_calls(span);
                    CodeOutcome::Stop
                }
                Departure::Leave => self.returned_from(region, machine, None),
                Departure::End => return Flow::Next,
                Departure::Interpret { site } => self.interpret(region, machine, site),
                Departure::Condition { to, site } => {
                    self.interpreted_condition(region, machine, to, site)
                }
                Departure::Kernel(kernel) => {
                    // Steps that do not suffice are found by the pass.
                    let due = self.usage.steps >= look_at && self.usage.cost() < most;
                    if due && self.may_not_go_on(region, machine) {
                        CodeOutcome::Stop
                    } else {
                        match self.pass(region, machine, kernel) {
                            // Passes do not put off the next look.
                            Some(CodeOutcome::Next) if !due => continue,
                            Some(outcome) => outcome,
                            None => self.fault(region, machine),
                        }
                    }
                }
            };
            let rest = most.saturating_sub(self.usage.cost());
            look_at = self.usage.steps + 1 + rest.min(STEPS_BETWEEN_LOOKS);
            match outcome {
                CodeOutcome::Next => {}
                CodeOutcome::Return(value) => return Flow::Return(value),
                CodeOutcome::Stop => return Flow::Stop,
            }
        }
    }

    /// Counts steps of code.
    #[inline]
    fn quick(&mut self, steps: u64) {
        self.usage.steps += steps;
        if self.inputs.settings.most_steps.is_none() {
            self.usage.quick += steps;
        }
    }

    /// Executes code up to an operation outside the registers, at which the machine stops.
    fn of_call(
        &self,
        region: &CodeRegion<T>,
        machine: &mut RegisterMachine<T>,
        steps: &mut u64,
        turns: &mut u64,
        look_at: u64,
    ) -> Departure<T> {
        let ieee = self.arrays.ieee;
        let (mut now, mut turned) = (*steps, *turns);
        'call: loop {
            let code = &region.units[machine.unit];
            let ops = &code.code[..];
            let executed = &mut machine.executed[machine.unit][..];
            let (file, own) = machine.registers.split_at_mut(machine.first);
            let own = &mut own[..code.registers];
            let (marks_of_file, marks) = machine.marks.split_at_mut(machine.first_mark);
            let (arrays_of_file, arrays) = machine.arrays.split_at_mut(machine.first_array);
            let mut pc = machine.pc;
            macro_rules! at {
                ($r:expr) => {
                    own[$r as usize]
                };
            }
            macro_rules! array {
                ($a:expr) => {{
                    let a = $a;
                    match a & OF_FILE {
                        0 => &mut arrays[a as usize],
                        _ => &mut arrays_of_file[(a & !OF_FILE) as usize],
                    }
                }};
            }
            macro_rules! text {
                ($a:expr) => {{
                    let a = $a;
                    match a & OF_FILE {
                        0 => arrays[a as usize].text(),
                        _ => arrays_of_file[(a & !OF_FILE) as usize].text(),
                    }
                }};
            }
            macro_rules! three {
                ($r:expr) => {
                    own[$r as usize..$r as usize + 3]
                };
            }
            macro_rules! leave {
                ($why:expr) => {{
                    machine.pc = pc - 1;
                    (*steps, *turns) = (now, turned);
                    return $why;
                }};
            }
            macro_rules! fault {
                () => {
                    leave!(Departure::Fault)
                };
            }
            macro_rules! element {
                ($array:expr, $i:expr, $j:expr) => {{
                    let j = if $j == NO_LABEL { None } else { Some(at!($j).re()) };
                    let i = at!($i).re();
                    let array = array!($array);
                    let Some(k) = element(array.shape, i, j) else { fault!() };
                    (array, k)
                }};
            }
            macro_rules! finite {
                ($to:expr, $x:expr) => {{
                    let x = $x;
                    if !x.is_finite() && !ieee {
                        fault!();
                    }
                    at!($to) = x;
                }};
            }
            macro_rules! by_number {
                () => {
                    ArraysByNumber { own: arrays, of_file: arrays_of_file }
                };
            }
            // A step is counted once it is certain that the run may continue.
            macro_rules! step {
                () => {{
                    if now + 1 >= look_at {
                        leave!(Departure::Look);
                    }
                    now += 1;
                }};
            }
            // A statement that follows.
            macro_rules! next_statement {
                () => {
                    if let ScalarOp::Step(statement) = ops[pc]
                        && now + 1 < look_at
                    {
                        executed[statement as usize] = true;
                        now += 1;
                        pc += 1;
                    }
                };
            }
            macro_rules! while_test {
                ($relation:expr, $a:expr, $b:expr, $exit:expr) => {{
                    if !$relation.holds(at!($a).re(), at!($b).re()) {
                        pc = $exit as usize;
                    } else if now + 1 < look_at {
                        now += 1;
                        turned += 1;
                        pc += 1;
                        next_statement!();
                    }
                }};
            }
            macro_rules! for_test {
                ($at:expr, $variable:expr, $register:expr, $origin:expr, $exit:expr, $kept:expr) => {{
                    let at = $at;
                    let k = at!(at + 3).re();
                    // NaN as the number of iterations means zero.
                    if k <= at!(at + 1).re() {
                        let x = at!(at) + at!(at + 2) * k;
                        at!($register) = x;
                        marks[$variable as usize] = declared_by($origin);
                        step!();
                        turned += 1;
                        if $kept {
                            at!(at + 4) = x;
                            at!(at + 5) = T::from(turned as f64);
                        }
                        next_statement!();
                    } else {
                        pc = $exit as usize;
                    }
                }};
            }
            macro_rules! walk_test {
                ($at:expr, $array:expr, $variable:expr, $register:expr, $origin:expr, $exit:expr) => {{
                    let walked = &mut arrays[$array as usize];
                    let (k, to) = (walked.turn, $register as usize);
                    let goes_on = match &walked.items {
                        ArrayItems::Shared(array) => match array.items.get(k) {
                            Some(&x) => {
                                own[to] = x;
                                true
                            }
                            None => false,
                        },
                        ArrayItems::SharedVectors(array) => {
                            let goes_on = k < array.planes[0].len();
                            if goes_on {
                                let v = array.planes.each_ref().map(|plane| plane[k]);
                                own[to..to + 3].copy_from_slice(&v);
                            }
                            goes_on
                        }
                        _ => false,
                    };
                    if goes_on {
                        marks[$variable as usize] = declared_by($origin);
                        step!();
                        walked.turn = k + 1;
                        turned += 1;
                        if $at != NO_LABEL {
                            at!($at) = T::from((k + 1) as f64);
                            at!($at + 1) = T::from(turned as f64);
                        }
                        next_statement!();
                    } else {
                        pc = $exit as usize;
                    }
                }};
            }
            loop {
                pc += 1;
                match ops[pc - 1] {
                    ScalarOp::Step(statement) => {
                        executed[statement as usize] = true;
                        step!();
                    }
                    ScalarOp::Steps(statement) => {
                        executed[statement as usize] = true;
                        if now + 2 >= look_at {
                            step!();
                        } else {
                            executed[statement as usize + 1] = true;
                            now += 2;
                            pc += 1;
                        }
                    }
                    ScalarOp::Branch { statement, relation, a, b, to } => {
                        executed[statement as usize] = true;
                        if now + 2 >= look_at {
                            step!();
                        } else if relation.holds(at!(a).re(), at!(b).re()) {
                            executed[statement as usize + 1] = true;
                            now += 2;
                            pc += 2;
                        } else {
                            now += 1;
                            pc = to as usize;
                        }
                    }
                    ScalarOp::Copy { to, a } => at!(to) = at!(a),
                    ScalarOp::CopyVector { to, a } => {
                        own.copy_within(a as usize..a as usize + 3, to as usize);
                    }
                    ScalarOp::Add { to, a, b } => finite!(to, at!(a) + at!(b)),
                    ScalarOp::AddThenWhole { to, a, b, whole } => {
                        finite!(to, at!(a) + at!(b));
                        let x = at!(to);
                        // What is no integer is reported by the next operation.
                        if !is_no_int(x.re()) {
                            at!(whole) = x;
                            pc += 1;
                        }
                    }
                    ScalarOp::Sub { to, a, b } => finite!(to, at!(a) - at!(b)),
                    ScalarOp::Mul { to, a, b } => finite!(to, at!(a) * at!(b)),
                    ScalarOp::MulThenAdd { to, a, b, sum, c } => {
                        finite!(to, at!(a) * at!(b));
                        let x = at!(to) + at!(c);
                        // A sum that is not finite is reported by the next operation.
                        if x.is_finite() || ieee {
                            at!(sum) = x;
                            pc += 1;
                        }
                    }
                    ScalarOp::Div { to, a, b } => finite!(to, at!(a) / at!(b)),
                    ScalarOp::Power { to, a, b } => finite!(to, ops::power(at!(a), at!(b))),
                    // As `powi` does it.
                    ScalarOp::Square { to, a } => finite!(to, T::one() * (at!(a) * at!(a))),
                    ScalarOp::PowerWhole { to, a, k } => {
                        finite!(to, ops::power_whole(at!(a), i32::from(k)))
                    }
                    ScalarOp::Negate { to, a } => at!(to) = -at!(a),
                    ScalarOp::Magnitude { to, a } => at!(to) = at!(a).abs(),
                    ScalarOp::Not { to, a } => {
                        at!(to) = T::from(f64::from(u8::from(at!(a).re() == 0.0)));
                    }
                    ScalarOp::Compare { relation, to, a, b } => {
                        let holds = relation.holds(at!(a).re(), at!(b).re());
                        at!(to) = T::from(f64::from(u8::from(holds)));
                    }
                    ScalarOp::Apply { to, a, f } => {
                        let Elementary::Unary(f) = region.functions[f as usize].1 else { fault!() };
                        finite!(to, f(at!(a)));
                    }
                    ScalarOp::Apply2 { to, a, b, f } => {
                        let Elementary::Binary(f) = region.functions[f as usize].1 else {
                            fault!()
                        };
                        finite!(to, f(at!(a), at!(b)));
                    }
                    ScalarOp::Remainder { to, a, b, f } => {
                        let (x, y) = (at!(a), at!(b));
                        match small_remainder(x.re(), y.re()).filter(|_| T::PARTS == 1) {
                            Some(rest) => at!(to) = T::from(rest),
                            None => {
                                let Elementary::Binary(f) = region.functions[f as usize].1 else {
                                    fault!()
                                };
                                finite!(to, f(x, y));
                            }
                        }
                    }
                    ScalarOp::Combine { to, a, b, f } => {
                        let Elementary::Binary(f) = region.functions[f as usize].1 else {
                            fault!()
                        };
                        at!(to) = f(at!(a), at!(b));
                    }
                    ScalarOp::Finite { a } => {
                        if !at!(a).is_finite() && !ieee {
                            fault!();
                        }
                    }
                    ScalarOp::Jump { to } => pc = to as usize,
                    ScalarOp::JumpUnless { a, to } => {
                        if at!(a).re() == 0.0 {
                            pc = to as usize;
                        }
                    }
                    ScalarOp::JumpIfNot { relation, a, b, to } => {
                        if relation.holds(at!(a).re(), at!(b).re()) {
                            next_statement!();
                        } else {
                            pc = to as usize;
                        }
                    }
                    ScalarOp::Load { to, array, i, j } => {
                        let (array, k) = element!(array, i, j);
                        at!(to) = array.read()[k];
                    }
                    ScalarOp::Store { array, i, j, a } => {
                        let (array, k) = element!(array, i, j);
                        array.write()[k] = at!(a);
                        array.known.give_at(k);
                    }
                    ScalarOp::LoadVector { to, array, i, j } => {
                        let (array, k) = element!(array, i, j);
                        three!(to).copy_from_slice(&array.vector(k));
                    }
                    ScalarOp::StoreVector { array, i, j, a } => {
                        let (array, k) = element!(array, i, j);
                        array.put_vector(k, [at!(a), at!(a + 1), at!(a + 2)], None);
                    }
                    ScalarOp::StorePart { array, i, j, a, part } => {
                        let (array, k) = element!(array, i, j);
                        array.put_vector(k, [at!(a); 3], Some(part));
                    }
                    ScalarOp::Extent { to, array, k } => {
                        let array = array!(array);
                        let n = match (array.shape, k) {
                            (ArrayShape::Row(n), 0) | (ArrayShape::Grid(n, _), 0) => n,
                            (ArrayShape::Grid(_, n), 1) => n,
                            _ => fault!(),
                        };
                        if n == 0 {
                            fault!();
                        }
                        at!(to) = T::from(n as f64);
                    }
                    ScalarOp::Whole { to, a } => {
                        let x = at!(a);
                        if is_no_int(x.re()) {
                            fault!();
                        }
                        at!(to) = x;
                    }
                    ScalarOp::Assign { variable, to, a } => {
                        let x = at!(a);
                        let mark = marks[variable as usize];
                        if type_by(code, variable, mark) == Type::Int && is_no_int(x.re()) {
                            fault!();
                        }
                        at!(to) = x;
                    }
                    ScalarOp::Live { variable } => {
                        if !is_live(marks[variable as usize]) {
                            fault!();
                        }
                    }
                    ScalarOp::LiveArray { array } => {
                        if !is_live(array!(array).mark) {
                            fault!();
                        }
                    }
                    ScalarOp::HasValue { array } => {
                        if matches!(array!(array).items, ArrayItems::Nothing) {
                            fault!();
                        }
                    }
                    ScalarOp::Declare { variable, origin } => {
                        marks[variable as usize] = declared_by(origin);
                    }
                    ScalarOp::DeclareArray { array, m, n, origin } => {
                        let m = at!(m).re();
                        let n = if n == NO_LABEL { None } else { Some(at!(n).re()) };
                        let extents = (variables::extent(m).ok(), n.map(variables::extent));
                        let shape = match extents {
                            (Some(m), None) => ArrayShape::Row(m),
                            (Some(m), Some(Ok(n))) => ArrayShape::Grid(m, n),
                            _ => fault!(),
                        };
                        let count = m * n.unwrap_or(1.0);
                        let ty = code.arrays[array as usize].ty;
                        match variables::has_room::<T>(ty, count, self.inputs.budget) {
                            Ok(of_elements) => now += of_elements,
                            Err(_) => fault!(),
                        }
                        let zeros = || vec![T::zero(); count as usize];
                        let items = match ty {
                            Type::Farray => ArrayItems::Owned(zeros()),
                            _ => ArrayItems::OwnedVectors([zeros(), zeros(), zeros()]),
                        };
                        *array!(array) = ArrayRegister {
                            items,
                            shape,
                            known: Known::nothing(count as usize),
                            mark: declared_by(origin),
                            turn: 0,
                        };
                    }
                    ScalarOp::CopyText { to, a } => {
                        let text = array!(a).shared_text();
                        array!(to).items = ArrayItems::SharedText(text);
                    }
                    ScalarOp::MoveText { to, a } => by_number!().exchange(to, a),
                    ScalarOp::JoinTexts { to, a, b } => {
                        if by_number!().join(to, a, b).is_none() {
                            fault!();
                        }
                    }
                    ScalarOp::CompareTexts { relation, to, a, b } => {
                        let (a, b) = (text!(a), text!(b));
                        let holds = match relation {
                            Relation::Eq => a == b,
                            Relation::Ne => a != b,
                            _ => relation.holds(a.cmp(b), Ordering::Equal),
                        };
                        at!(to) = T::from(f64::from(u8::from(holds)));
                    }
                    ScalarOp::FormatText { to, format } => {
                        let format = &code.formats[format as usize];
                        let Some(text) = formatted(format, own, &by_number!()) else { fault!() };
                        array!(to).items = ArrayItems::OwnedText(text);
                    }
                    ScalarOp::DeclareText { array, origin } => {
                        array!(array).mark = declared_by(origin);
                    }
                    ScalarOp::LoadFile { to, of_file } => at!(to) = file[of_file as usize],
                    ScalarOp::StoreFile { of_file, a } => file[of_file as usize] = at!(a),
                    ScalarOp::WholeFile { of_file, a } => {
                        let x = at!(a);
                        if is_no_int(x.re()) {
                            fault!();
                        }
                        file[of_file as usize] = x;
                    }
                    ScalarOp::AssignFile { variable, of_file, a } => {
                        let x = at!(a);
                        let mark = marks_of_file[variable as usize];
                        if type_by(&region.units[0], variable, mark) == Type::Int
                            && is_no_int(x.re())
                        {
                            fault!();
                        }
                        file[of_file as usize] = x;
                    }
                    ScalarOp::LiveFile { variable } => {
                        if !is_live(marks_of_file[variable as usize]) {
                            fault!();
                        }
                    }
                    ScalarOp::ForBegin { at } => {
                        let [from, to, step] = [at!(at), at!(at + 1), at!(at + 2)].map(T::re);
                        if step == 0.0 || !from.is_finite() || !to.is_finite() {
                            fault!();
                        }
                        // Half a millionth of a step of slack, so that 0:1:0.1 has its last turn.
                        at!(at + 1) = T::from(((to - from) / step + 5e-7).floor());
                        at!(at + 3) = T::zero();
                    }
                    ScalarOp::WhileTest { relation, a, b, exit } => {
                        while_test!(relation, a, b, exit);
                    }
                    ScalarOp::WhileNext { test } => {
                        pc = test as usize + 1;
                        if let ScalarOp::WhileTest { relation, a, b, exit } = ops[test as usize] {
                            while_test!(relation, a, b, exit);
                        }
                    }
                    ScalarOp::ForTest { at, variable, register, origin, exit, kept } => {
                        for_test!(at, variable, register, origin, exit, kept);
                    }
                    ScalarOp::ForNext { at, test } => {
                        at!(at + 3) = T::from(at!(at + 3).re() + 1.0);
                        pc = test as usize + 1;
                        if let ScalarOp::ForTest { at, variable, register, origin, exit, kept } =
                            ops[test as usize]
                        {
                            for_test!(at, variable, register, origin, exit, kept);
                        }
                    }
                    ScalarOp::WalkBegin { array, from } => {
                        let walked = array!(from).passed(declared_by(0));
                        arrays[array as usize] = walked;
                    }
                    ScalarOp::WalkTest { at, array, variable, register, origin, exit } => {
                        walk_test!(at, array, variable, register, origin, exit);
                    }
                    ScalarOp::WalkNext { test } => {
                        pc = test as usize + 1;
                        if let ScalarOp::WalkTest { at, array, variable, register, origin, exit } =
                            ops[test as usize]
                        {
                            walk_test!(at, array, variable, register, origin, exit);
                        }
                    }
                    ScalarOp::WalkEnd { array } => {
                        arrays[array as usize] = ArrayRegister::nothing(UNDECLARED);
                    }
                    ScalarOp::Label { at, variable } => {
                        let live = is_live(marks[variable as usize]);
                        let register = code.variables[variable as usize].register;
                        at!(at) = if live { at!(register) } else { T::from(f64::NAN) };
                    }
                    ScalarOp::Turn { at, label } => {
                        step!();
                        turned += 1;
                        if label != NO_LABEL {
                            at!(at) = at!(label);
                        }
                        if at != NO_LABEL {
                            at!(at + 1) = T::from(turned as f64);
                        }
                    }
                    ScalarOp::Called => {
                        now += 4;
                        if machine.frames + machine.waiting.len() >= MOST_CALLS {
                            leave!(Departure::TooDeep);
                        }
                    }
                    ScalarOp::Call { to, site } => {
                        machine.pc = pc - 1;
                        now += 4;
                        if machine.enters(region, to, site, self.usage.errors) {
                            continue 'call;
                        }
                        leave!(Departure::TooDeep)
                    }
                    ScalarOp::Return { a } => {
                        let x = at!(a);
                        machine.pc = pc - 1;
                        if machine.returns_plainly(code.result, &[x]) {
                            continue 'call;
                        }
                        leave!(Departure::Return(x))
                    }
                    ScalarOp::ReturnVector { a } => {
                        let v = [at!(a), at!(a + 1), at!(a + 2)];
                        machine.pc = pc - 1;
                        if machine.returns_plainly(code.result, &v) {
                            continue 'call;
                        }
                        leave!(Departure::ReturnVector(v))
                    }
                    ScalarOp::Leave => leave!(Departure::Leave),
                    ScalarOp::End => leave!(Departure::End),
                    ScalarOp::Interpret { site } => leave!(Departure::Interpret { site }),
                    ScalarOp::Condition { to, site } => leave!(Departure::Condition { to, site }),
                    ScalarOp::Kernel { kernel } => leave!(Departure::Kernel(kernel)),
                }
            }
        }
    }

    /// Looks whether the run must stop, which is reported then.
    #[cold]
    fn may_not_go_on(&mut self, region: &CodeRegion<T>, machine: &RegisterMachine<T>) -> bool {
        let span = || region.units[machine.unit].range(machine.pc).span;
        if self.usage.cost() >= self.limits.steps {
            return self.in_module(region, machine, |this| this.step(span()));
        }
        match self.inputs.budget.poll() {
            Ok(()) => false,
            Err(spent) => {
                self.usage.steps += 1;
                let diagnostic = usage::spent(spent).at(span());
                self.in_module(region, machine, |this| this.stop(diagnostic))
            }
        }
    }

    pub(super) fn in_module<R>(
        &mut self,
        region: &CodeRegion<T>,
        machine: &RegisterMachine<T>,
        work: impl FnOnce(&mut Self) -> R,
    ) -> R {
        let current = std::mem::replace(&mut self.current, region.units[machine.unit].module);
        let done = work(self);
        self.current = current;
        done
    }

    /// A statement that the interpreter executes.
    fn interpret(
        &mut self,
        region: &CodeRegion<T>,
        machine: &mut RegisterMachine<T>,
        site: u16,
    ) -> CodeOutcome<T> {
        let code = &region.units[machine.unit];
        let site = &code.sites[site as usize];
        let flow = self.on_enough_stack(site.span, |this| {
            this.interpreted(region, machine, &site.loops, |this| {
                this.statement(&code.m, site.stmt)
            })
        });
        match flow.unwrap_or(Flow::Stop) {
            _ if self.is_abandoned(region) => CodeOutcome::Return(None),
            Flow::Return(value) => self.returned_from(region, machine, value),
            Flow::Stop => CodeOutcome::Stop,
            // No statement that is left to the interpreter ends a loop of the code.
            Flow::Next | Flow::Break | Flow::Continue => {
                machine.pc += 1;
                CodeOutcome::Next
            }
        }
    }

    fn interpreted_condition(
        &mut self,
        region: &CodeRegion<T>,
        machine: &mut RegisterMachine<T>,
        to: u16,
        site: u16,
    ) -> CodeOutcome<T> {
        let code = &region.units[machine.unit];
        let site = &code.sites[site as usize];
        let holds = self.on_enough_stack(site.span, |this| {
            this.interpreted(region, machine, &site.loops, |this| {
                this.condition(&code.m, site.expr)
            })
        });
        match holds.unwrap_or_else(|| Err(silent())) {
            _ if self.env.stopped => CodeOutcome::Stop,
            Ok(holds) => {
                let to = machine.first + to as usize;
                machine.registers[to] = T::from(f64::from(u8::from(holds)));
                machine.pc += 1;
                CodeOutcome::Next
            }
            Err(diagnostic) => self.faulty(region, machine, diagnostic),
        }
    }

    /// The current call ends with a value or without.
    fn returned_from(
        &mut self,
        region: &CodeRegion<T>,
        machine: &mut RegisterMachine<T>,
        value: Option<Value<T>>,
    ) -> CodeOutcome<T> {
        let Some(call) = machine.waiting.pop() else { return CodeOutcome::Return(value) };
        let depth = machine.waiting.len();
        self.env.scope.frames.truncate(machine.frames + depth);
        machine.framed = self.env.scope.frames.len() > machine.frames;
        let callee = machine.unit;
        machine.back_to(call);
        let caller = &region.units[call.unit as usize];
        let site = &caller.sites[call.site as usize];
        let callee = &region.units[callee];
        let routine = callee.m.program[callee.routine.expect("a routine was called").routine];
        let name = callee.m.program.name(routine.name.symbol);
        let value = match (value, routine.result) {
            (Some(value), Some((ty, asked))) => {
                variables::converted(ty, value).map(Some).map_err(|d| {
                    let message = format!("{name} returns another value: {}", d.message);
                    let mut d = d.or_at(site.span).note_at(asked, "declared here");
                    d.message = message;
                    d
                })
            }
            (value, _) => Ok(value),
        };
        let value = match value {
            Err(diagnostic) => return self.faulty(region, machine, diagnostic),
            Ok(value) => value,
        };
        if !site.valued {
            machine.pc += 1;
            return CodeOutcome::Next;
        }
        match value {
            Some(Value::Number(x)) => {
                let to = machine.first + call.to as usize;
                machine.registers[to] = x;
                machine.pc += 1;
                CodeOutcome::Next
            }
            Some(Value::Vector(v)) => {
                let to = machine.first + call.to as usize;
                machine.registers[to..to + 3].copy_from_slice(&v.to_array());
                machine.pc += 1;
                CodeOutcome::Next
            }
            None if self.usage.errors > call.errors as usize => {
                self.faulty(region, machine, silent())
            }
            _ => {
                let diagnostic =
                    Diagnostic::error("no-value", format!("`{name}` returns no value"))
                        .help("it ended without one: every path through it must `return` a value")
                        .at(site.span);
                self.faulty(region, machine, diagnostic)
            }
        }
    }
}

/// The type of a variable that was declared with different types.
fn type_by<T: Real>(code: &CodeUnit<T>, variable: u16, mark: u32) -> Type {
    match (declaration(mark), code.variables[variable as usize].captured) {
        (Some((origin, _)), _) => code.origins[origin].1,
        (None, Some(super::code::Captured::Variable(ty) | super::code::Captured::Passed(ty))) => ty,
        _ => Type::Float,
    }
}
