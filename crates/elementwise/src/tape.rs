//! Element-wise statements in one pass.
//!
//! `expression -> tape -> orders -> chunks`
//!
//! A tape is the element-wise part of an expression, one instruction for each operation on one
//! component, without duplicates. When it is run, its instructions become a program of the
//! [`machine`](crate::vm), through which the elements are processed in chunks, so that a statement
//! reads its sources once and writes its result once, whatever the number of its operators.
//!
//! Values are those of the operators in sequence, bit for bit: products and sums keep their order
//! and are rounded separately.

use crate::codegen::Planner;
use crate::vm::VmProgram;
use moldloft_num::Real;
use moldloft_registry::{Array, ArrayShape, Vectors};
use smallvec::SmallVec;
use std::sync::Arc;

/// Location of an instruction's operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Src {
    /// A row or grid of numbers.
    Plane(u16),
    /// The same number for all elements.
    Const(u16),
    /// The result of an instruction.
    Reg(u16),
}

/// The operation of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Code {
    /// The sum of two numbers.
    Add,
    /// The difference of two numbers.
    Sub,
    /// The product of two numbers.
    Mul,
    /// The quotient of two numbers.
    Div,
    /// The negative of a number.
    Neg,
    /// The absolute value of a number.
    Abs,
    /// The square root of a number.
    Sqrt,
    /// A function of one number, by its index in the tape's list.
    Unary(u16),
    /// A function of two numbers.
    Binary(u16),
}

/// One operation on one component, carried out for every element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instr {
    /// The operation.
    pub code: Code,
    /// Its operands; of those with one, twice the same.
    pub of: [Src; 2],
}

impl Instr {
    /// Operands.
    pub fn operands(&self) -> &[Src] {
        match self.code {
            Code::Neg | Code::Abs | Code::Sqrt | Code::Unary(_) => &self.of[..1],
            _ => &self.of,
        }
    }
}

#[derive(Clone, Debug)]
enum NumberSource<T: Real> {
    Numbers(Arc<Array<T>>),
    Component(Arc<Vectors<T>>, usize),
}

impl<T: Real> NumberSource<T> {
    fn numbers(&self) -> &Vec<T> {
        match self {
            NumberSource::Numbers(a) => &a.items,
            NumberSource::Component(a, c) => &a.planes[*c],
        }
    }
}

/// A value that a recorded expression finds before its tape is run: the result of one of its entries
/// (see `array::cache` of the crate `lang`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell(pub u16);

impl Cell {
    /// The cell of a value that a recording cannot find again.
    pub const NONE: Cell = Cell(u16::MAX);
}

/// Origin of a source or constant of a tape: a component of a cell, or the number itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Origin {
    /// The entry of the recording.
    pub cell: Cell,
    /// The component of its value.
    pub part: u8,
}

impl Origin {
    /// The origin of a constant that does not depend on the values.
    pub const FIXED: Origin = Origin { cell: Cell(u16::MAX - 1), part: 0 };

    /// A number, or component `part` of a vector or row of vectors.
    pub fn of(cell: Cell, part: usize) -> Self {
        Self { cell, part: part as u8 }
    }
}

/// See the head of this file.
#[derive(Debug)]
pub struct Tape<T: Real> {
    planes: Vec<NumberSource<T>>,
    /// Origins of the sources and the constants.
    pub plane_origins: Vec<Origin>,
    /// The origin of each constant.
    pub const_origins: Vec<Origin>,
    /// Cells that were the same array when the tape was made.
    pub aliases: Vec<[Cell; 2]>,
    code: Vec<Instr>,
    /// Instructions whose results must be finite, in order, and their numbers of elements.
    checked: Vec<(u16, usize)>,
    planner: Planner,
    program: VmProgram<T>,
}

/// Maximum number of instructions, sources and constants of a tape; a longer expression is divided.
pub const LONGEST: usize = 4_000;

impl<T: Real> Default for Tape<T> {
    fn default() -> Self {
        Self {
            planes: Vec::new(),
            plane_origins: Vec::new(),
            const_origins: Vec::new(),
            aliases: Vec::new(),
            code: Vec::new(),
            checked: Vec::new(),
            planner: Planner::default(),
            program: VmProgram::default(),
        }
    }
}

/// Number of preceding instructions searched for a duplicate.
const ALIKE: usize = 64;

impl<T: Real> Tape<T> {
    /// Empties it and keeps its memory.
    pub fn clear(&mut self) {
        self.planes.clear();
        self.program.consts.clear();
        self.plane_origins.clear();
        self.const_origins.clear();
        self.aliases.clear();
        self.code.clear();
        self.program.unary.clear();
        self.program.binary.clear();
        self.checked.clear();
    }

    /// True when it should be run before more is added.
    pub fn is_long(&self) -> bool {
        self.code.len() + self.planes.len() + self.program.consts.len() > LONGEST
    }

    /// Equal numbers of one origin are one constant.
    pub fn constant(&mut self, x: T, origin: Origin) -> Src {
        let mut known = self.program.consts.iter().zip(&self.const_origins);
        let at = known.rposition(|(c, o)| *o == origin && c.bits_eq(x)).unwrap_or_else(|| {
            self.program.consts.push(x);
            self.const_origins.push(origin);
            self.program.consts.len() - 1
        });
        Src::Const(at as u16)
    }

    /// Notes that a cell is an array that another cell brought already.
    fn alias(&mut self, at: usize, cell: Cell) {
        let first = self.plane_origins[at].cell;
        if first != cell && !self.aliases.contains(&[first, cell]) {
            self.aliases.push([first, cell]);
        }
    }

    /// A source of numbers; the same array is one source.
    pub fn numbers(&mut self, array: &Arc<Array<T>>, cell: Cell) -> Src {
        let same =
            |p: &NumberSource<T>| matches!(p, NumberSource::Numbers(a) if Arc::ptr_eq(a, array));
        if let Some(at) = self.planes.iter().position(same) {
            self.alias(at, cell);
            return Src::Plane(at as u16);
        }
        self.planes.push(NumberSource::Numbers(array.clone()));
        self.plane_origins.push(Origin::of(cell, 0));
        Src::Plane((self.planes.len() - 1) as u16)
    }

    /// The sources of the three components of a row or grid of vectors.
    pub fn vectors(&mut self, array: &Arc<Vectors<T>>, cell: Cell) -> [Src; 3] {
        let same = |p: &NumberSource<T>| matches!(p, NumberSource::Component(a, 0) if Arc::ptr_eq(a, array));
        let at = match self.planes.iter().position(same) {
            Some(at) => {
                self.alias(at, cell);
                at
            }
            None => {
                self.planes.extend((0..3).map(|c| NumberSource::Component(array.clone(), c)));
                self.plane_origins.extend((0..3).map(|c| Origin::of(cell, c)));
                self.planes.len() - 3
            }
        };
        [0, 1, 2].map(|c| Src::Plane((at + c) as u16))
    }

    /// Lets go of the arrays, for a tape that is kept: others are found for each run.
    pub fn release(&mut self) {
        self.planes.clear();
    }

    /// The constants, to be set before a run of a cached tape.
    pub fn constants_mut(&mut self) -> &mut [T] {
        &mut self.program.consts
    }

    /// The same instruction is recorded once, and so is its check.
    fn push(&mut self, instr: Instr, checked: Option<ArrayShape>) -> Src {
        let from = self.code.len().saturating_sub(ALIKE);
        if let Some(at) = self.code[from..].iter().position(|i| *i == instr) {
            return Src::Reg((from + at) as u16);
        }
        let at = self.code.len() as u16;
        self.code.push(instr);
        if let Some(shape) = checked {
            self.checked.push((at, shape.count()));
        }
        Src::Reg(at)
    }

    /// The result of an operation on two operands; it must be finite when there is a shape.
    pub fn op(&mut self, code: Code, a: Src, b: Src, checked: Option<ArrayShape>) -> Src {
        self.push(Instr { code, of: [a, b] }, checked)
    }

    /// The result of an operation on one operand that is as finite as that one.
    pub fn op1(&mut self, code: Code, a: Src) -> Src {
        self.push(Instr { code, of: [a, a] }, None)
    }

    /// The function of each element; its results must be finite when there is a shape.
    pub fn unary(&mut self, f: fn(T) -> T, a: Src, checked: Option<ArrayShape>) -> Src {
        self.program.unary.push(f);
        let code = Code::Unary((self.program.unary.len() - 1) as u16);
        self.push(Instr { code, of: [a, a] }, checked)
    }

    /// The function of each pair of elements; its results must be finite when there is a shape.
    pub fn binary(&mut self, f: fn(T, T) -> T, a: Src, b: Src, checked: Option<ArrayShape>) -> Src {
        self.program.binary.push(f);
        let code = Code::Binary((self.program.binary.len() - 1) as u16);
        self.push(Instr { code, of: [a, b] }, checked)
    }

    /// Number of checks so far.
    pub fn checks(&self) -> usize {
        self.checked.len()
    }

    /// The first failing check, over the whole tape.
    pub fn first_failure(&self) -> Option<usize> {
        let rows: SmallVec<[&Vec<T>; 16]> = self.planes.iter().map(NumberSource::numbers).collect();
        let mut counts: Vec<usize> = self.checked.iter().map(|(_, count)| *count).collect();
        counts.sort_unstable();
        counts.dedup();
        counts.into_iter().filter_map(|count| self.failure(&rows, count)).min()
    }

    /// The first failing check, in the order of the instructions, among those with `count`
    /// elements. Evaluates one instruction at a time, so call it only after a failure.
    fn failure(&self, planes: &[&Vec<T>], count: usize) -> Option<usize> {
        let mut first = self.checked.len();
        // Shorter operands have no value here.
        let mut results: Vec<Option<T>> = vec![None; self.code.len()];
        for element in 0..count {
            let mut check = 0;
            for (k, instr) in self.code.iter().enumerate() {
                let [a, b] = instr.of.map(|src| match src {
                    Src::Plane(p) => planes[p as usize].get(element).copied(),
                    Src::Const(c) => Some(self.program.consts[c as usize]),
                    Src::Reg(r) => results[r as usize],
                });
                results[k] = a.zip(b).map(|(a, b)| match instr.code {
                    Code::Add => a + b,
                    Code::Sub => a - b,
                    Code::Mul => a * b,
                    Code::Div => a / b,
                    Code::Neg => -a,
                    Code::Abs => a.abs(),
                    Code::Sqrt => a.sqrt(),
                    Code::Unary(f) => self.program.unary[f as usize](a),
                    Code::Binary(f) => self.program.binary[f as usize](a, b),
                });
                let Some((at, of)) = self.checked.get(check) else { continue };
                if *at as usize == k {
                    if check < first && *of == count && results[k].is_some_and(|x| !x.is_finite()) {
                        first = check;
                    }
                    check += 1;
                }
            }
        }
        (first < self.checked.len()).then_some(first)
    }

    /// A whole power, by the same multiplications as [`Real::powi`], a negative one as the reciprocal of the positive one, which must be finite when there is a
    /// shape.
    pub fn powi(&mut self, a: Src, exponent: i32, checked: Option<ArrayShape>) -> Src {
        let one = self.constant(T::one(), Origin::FIXED);
        // A divisor that is too large has the reciprocal 0.
        let whole = if exponent < 0 { None } else { checked };
        let mut base = a;
        let mut left = exponent.unsigned_abs();
        let mut power = one;
        while left > 0 {
            if left & 1 == 1 {
                // 1 * x is x for plain numbers; a derivative of minus zero would lose its sign.
                let skip = power == one && T::PARTS == 1;
                power = if skip { base } else { self.op(Code::Mul, power, base, whole) };
            }
            left >>= 1;
            if left > 0 {
                base = self.op(Code::Mul, base, base, whole);
            }
        }
        if exponent < 0 { self.op(Code::Div, one, power, checked) } else { power }
    }

    /// Writes the values of the roots, of that shape each, into rows.
    ///
    /// # Errors
    /// The number of the first check that failed, in the order of the instructions.
    pub fn run(
        &mut self,
        roots: &[Src],
        shape: ArrayShape,
        outs: &mut [Vec<T>],
    ) -> Result<(), usize> {
        let Self { code, checked, planner, program, .. } = self;
        // Infinite sums and products show in the results, or in the quotients and functions that read them.
        let check = |k: usize| {
            !matches!(code[k].code, Code::Add | Code::Sub | Code::Mul)
                && checked
                    .binary_search_by_key(&(k as u16), |c| c.0)
                    .is_ok_and(|at| checked[at].1 == shape.count())
        };
        planner.plan(code, roots, check, program);
        program.finite = !checked.is_empty();
        let rows: SmallVec<[&Vec<T>; 16]> = self.planes.iter().map(NumberSource::numbers).collect();
        self.execute(&rows, roots, shape.count(), outs)
    }

    /// Runs a tape that was run before with the same roots and shape, on other rows; a row of `count`
    /// elements for each root is written.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn execute(
        &self,
        planes: &[&Vec<T>],
        roots: &[Src],
        count: usize,
        outs: &mut [Vec<T>],
    ) -> Result<(), usize> {
        if !self.program.run(planes, outs, count)
            && let Some(check) = self.failure(planes, count)
        {
            return Err(check);
        }
        // Roots that are no result of their own: sources, constants, the same result twice.
        for (k, root) in roots.iter().enumerate() {
            match *root {
                Src::Plane(p) => outs[k].copy_from_slice(&planes[p as usize][..count]),
                Src::Const(c) => outs[k].fill(self.program.consts[c as usize]),
                Src::Reg(_) => {
                    if let Some(first) = roots[..k].iter().position(|r| r == root) {
                        let (done, rest) = outs.split_at_mut(k);
                        rest[0].copy_from_slice(&done[first]);
                    }
                }
            }
        }
        Ok(())
    }

    /// True when a run may fail.
    pub fn is_checked(&self) -> bool {
        !self.checked.is_empty()
    }
}
