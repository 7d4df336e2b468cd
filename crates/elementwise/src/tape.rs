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

/// See the head of this file.
#[derive(Debug)]
pub struct Tape<T: Real> {
    planes: Vec<NumberSource<T>>,
    consts: Vec<T>,
    /// The constants that another run may replace.
    inputs: Vec<u16>,
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
            consts: Vec::new(),
            inputs: Vec::new(),
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
        self.consts.clear();
        self.inputs.clear();
        self.code.clear();
        self.program.unary.clear();
        self.program.binary.clear();
        self.checked.clear();
    }

    /// True when it should be run before more is added.
    pub fn is_long(&self) -> bool {
        self.code.len() + self.planes.len() + self.consts.len() > LONGEST
    }

    /// Equal numbers are one constant.
    pub fn constant(&mut self, x: T) -> Src {
        let fixed = |k: &usize| !self.inputs.contains(&(*k as u16));
        let alike = |k: &usize| self.consts[*k].bits_eq(x) && fixed(k);
        let at = (0..self.consts.len()).rev().find(alike).unwrap_or_else(|| {
            self.consts.push(x);
            self.consts.len() - 1
        });
        Src::Const(at as u16)
    }

    /// A number that is given for each run, by its place among the constants.
    pub fn input(&mut self) -> u16 {
        let at = self.consts.len() as u16;
        self.consts.push(T::zero());
        self.inputs.push(at);
        at
    }

    /// The constants, with zeros for the inputs.
    pub fn constants(&self) -> &[T] {
        &self.consts
    }

    /// A source of numbers; the same array is one source.
    pub fn numbers(&mut self, array: &Arc<Array<T>>) -> Src {
        let same =
            |p: &NumberSource<T>| matches!(p, NumberSource::Numbers(a) if Arc::ptr_eq(a, array));
        let at = self.planes.iter().position(same).unwrap_or_else(|| {
            self.planes.push(NumberSource::Numbers(array.clone()));
            self.planes.len() - 1
        });
        Src::Plane(at as u16)
    }

    /// The sources of the three components of a row or grid of vectors.
    pub fn vectors(&mut self, array: &Arc<Vectors<T>>) -> [Src; 3] {
        let same = |p: &NumberSource<T>| matches!(p, NumberSource::Component(a, 0) if Arc::ptr_eq(a, array));
        let at = self.planes.iter().position(same).unwrap_or_else(|| {
            self.planes.extend((0..3).map(|c| NumberSource::Component(array.clone(), c)));
            self.planes.len() - 3
        });
        [0, 1, 2].map(|c| Src::Plane((at + c) as u16))
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
    pub fn first_failure(&mut self) -> Option<usize> {
        let mut counts: Vec<usize> = self.checked.iter().map(|(_, count)| *count).collect();
        counts.sort_unstable();
        counts.dedup();
        counts.into_iter().filter_map(|count| self.failure(count)).min()
    }

    /// The first failing check, in the order of the instructions, among those with `count`
    /// elements. Each is run for itself, so call it only after a failure.
    fn failure(&mut self, count: usize) -> Option<usize> {
        let mut out = [vec![T::zero(); count]];
        (0..self.checked.len()).find(|&check| {
            let (at, of) = self.checked[check];
            if of != count {
                return false;
            }
            let roots = [Src::Reg(at)];
            self.planner.plan(&self.code, &roots, |_| false, &mut self.program);
            self.program.finite = false;
            let _ = self.execute(&self.rows(), &self.consts, &roots, count, &mut out);
            out[0].iter().any(|x| !x.is_finite())
        })
    }

    fn rows(&self) -> SmallVec<[&Vec<T>; 16]> {
        self.planes.iter().map(NumberSource::numbers).collect()
    }

    /// A whole power, by the same multiplications as [`Real::powi`], a negative one as the reciprocal of the positive one, which must be finite when there is a
    /// shape.
    pub fn powi(&mut self, a: Src, exponent: i32, checked: Option<ArrayShape>) -> Src {
        let one = self.constant(T::one());
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
        self.plan(roots, shape);
        let count = shape.count();
        let sound = self.execute(&self.rows(), &self.consts, roots, count, outs);
        match sound {
            true => Ok(()),
            false => self.failure(count).map_or(Ok(()), Err),
        }
    }

    /// Makes the program that computes the roots, of that shape each.
    pub fn plan(&mut self, roots: &[Src], shape: ArrayShape) {
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
    }

    /// Runs the planned program on these sources and constants; a row of `count` elements for each root is
    /// written. False when something that must be finite is not.
    pub fn execute(
        &self,
        planes: &[&Vec<T>],
        consts: &[T],
        roots: &[Src],
        count: usize,
        outs: &mut [Vec<T>],
    ) -> bool {
        let sound = self.program.run(planes, consts, outs, count);
        // Roots that are no result of their own: sources, constants, the same result twice.
        for (k, root) in roots.iter().enumerate() {
            match *root {
                Src::Plane(p) => outs[k].copy_from_slice(&planes[p as usize][..count]),
                Src::Const(c) => outs[k].fill(consts[c as usize]),
                Src::Reg(_) => {
                    if let Some(first) = roots[..k].iter().position(|r| r == root) {
                        let (done, rest) = outs.split_at_mut(k);
                        rest[0].copy_from_slice(&done[first]);
                    }
                }
            }
        }
        sound
    }
}
