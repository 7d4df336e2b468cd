//! Element-wise statements in one pass.
//!
//! `expression -> tape -> steps -> blocks`
//!
//! A tape is the element-wise part of an expression, one instruction for each operation on one
//! component; what is alike is written once. When it is run, the elements go through it in blocks
//! that stay in the nearest cache, so that a statement reads its sources once and writes its result
//! once, whatever the number of its operators.
//!
//! Values are those of the operators one after the other, bit for bit: products and sums keep their
//! order and are rounded each by itself.

use moldloft_num::Real;
use moldloft_registry::{Array, ArrayShape, Vectors};
use smallvec::SmallVec;
use std::sync::Arc;

/// Plain numbers that go through a tape together: few enough for the first caches, and so many that what
/// a step costs besides is shared (256 took a fifth longer).
const BLOCK_PARTS: usize = 512;

/// Numbers between rows for results on the way, so that their beginnings do not meet in the same sets
/// of the cache: five lines of it.
const APART: usize = 40;

/// Where an instruction finds an operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Src {
    /// A row or grid of numbers.
    Plane(u16),
    /// The same number for all elements.
    Const(u16),
    /// The result of an instruction.
    Reg(u16),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Code {
    Add,
    Sub,
    Mul,
    Div,
    Neg,
    Abs,
    Sqrt,
    /// a * b + c, rounded twice.
    MulAdd,
    /// a * b - c
    MulSub,
    /// c - a * b
    SubMul,
    /// (a * b) * c
    MulMul,
    /// (a * b) * c + d, each rounded
    MulMulAdd,
    /// A function of one number, by its place in the tape's list.
    Unary(u16),
    /// A function of two numbers.
    Binary(u16),
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Instr {
    code: Code,
    a: Src,
    b: Src,
    c: Src,
    d: Src,
}

/// A source of numbers.
#[derive(Clone, Debug)]
enum Plane<T: Real> {
    Numbers(Arc<Array<T>>),
    Component(Arc<Vectors<T>>, usize),
}

impl<T: Real> Plane<T> {
    #[inline(always)]
    fn numbers(&self) -> &[T] {
        match self {
            Plane::Numbers(a) => &a.items,
            Plane::Component(a, c) => &a.planes[*c],
        }
    }
}

/// A value that a recorded expression finds before its tape is run: the result of one of its entries
/// (see [`crate::recipe`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Cell(pub u16);

impl Cell {
    /// Of a value that a recording does not know to find again.
    pub const NONE: Cell = Cell(u16::MAX);
}

/// Where a source or constant of a tape comes from: a component of a cell, or the number itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Origin {
    pub cell: Cell,
    pub part: u8,
}

impl Origin {
    /// Of a constant that is the same whatever the values are.
    pub const FIXED: Origin = Origin { cell: Cell(u16::MAX - 1), part: 0 };

    /// A number, or component `part` of a vector or row of vectors.
    pub fn of(cell: Cell, part: usize) -> Self {
        Self { cell, part: part as u8 }
    }
}

/// See the head of this file.
#[derive(Debug)]
pub(crate) struct Tape<T: Real> {
    planes: Vec<Plane<T>>,
    consts: Vec<T>,
    /// Where the sources and the constants come from.
    pub plane_origins: Vec<Origin>,
    pub const_origins: Vec<Origin>,
    /// Cells that were the same array when the tape was made.
    pub aliases: Vec<[Cell; 2]>,
    code: Vec<Instr>,
    unary: Vec<fn(T) -> T>,
    binary: Vec<fn(T, T) -> T>,
    /// Instructions whose results must be finite, in order, and their shapes.
    checked: Vec<(u16, ArrayShape)>,
    steps: Vec<Step>,
    /// Rows for results on the way that the steps need.
    slots: usize,
    uses: Vec<u16>,
    homes: Vec<Home>,
    last: Vec<usize>,
    free: Vec<u16>,
}

/// Where the result of an instruction is kept while the steps are made.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Home {
    /// Merged into its only user.
    Nowhere,
    Slot(u16),
    Out(u16),
}

/// An operand of a step.
#[derive(Clone, Copy, Debug)]
enum Operand {
    Plane(u16),
    Const(u16),
    Slot(u16),
    Out(u16),
}

#[derive(Clone, Copy, Debug)]
struct Step {
    code: Code,
    a: Operand,
    b: Operand,
    c: Operand,
    d: Operand,
    to: Home,
    /// The place in `checked`.
    check: Option<u16>,
}

/// The most instructions, sources and constants of a tape; a longer expression goes in parts.
pub(crate) const LONGEST: usize = 4_000;

impl<T: Real> Default for Tape<T> {
    fn default() -> Self {
        Self {
            planes: Vec::new(),
            consts: Vec::new(),
            plane_origins: Vec::new(),
            const_origins: Vec::new(),
            aliases: Vec::new(),
            code: Vec::new(),
            unary: Vec::new(),
            binary: Vec::new(),
            checked: Vec::new(),
            steps: Vec::new(),
            slots: 0,
            uses: Vec::new(),
            homes: Vec::new(),
            last: Vec::new(),
            free: Vec::new(),
        }
    }
}

/// How far back an instruction is sought that does the same.
const ALIKE: usize = 64;

impl<T: Real> Tape<T> {
    /// Empties it and keeps its memory.
    pub fn clear(&mut self) {
        self.planes.clear();
        self.consts.clear();
        self.plane_origins.clear();
        self.const_origins.clear();
        self.aliases.clear();
        self.code.clear();
        self.unary.clear();
        self.binary.clear();
        self.checked.clear();
    }

    /// True when it should be run before more is added.
    pub fn is_long(&self) -> bool {
        self.code.len() + self.planes.len() + self.consts.len() > LONGEST
    }

    /// Equal numbers of one origin are one constant.
    pub fn constant(&mut self, x: T, origin: Origin) -> Src {
        let mut known = self.consts.iter().zip(&self.const_origins);
        let at = known.rposition(|(c, o)| *o == origin && c.bits_eq(x)).unwrap_or_else(|| {
            self.consts.push(x);
            self.const_origins.push(origin);
            self.consts.len() - 1
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

    pub fn numbers(&mut self, array: &Arc<Array<T>>, cell: Cell) -> Src {
        let same = |p: &Plane<T>| matches!(p, Plane::Numbers(a) if Arc::ptr_eq(a, array));
        if let Some(at) = self.planes.iter().position(same) {
            self.alias(at, cell);
            return Src::Plane(at as u16);
        }
        self.planes.push(Plane::Numbers(array.clone()));
        self.plane_origins.push(Origin::of(cell, 0));
        Src::Plane((self.planes.len() - 1) as u16)
    }

    pub fn vectors(&mut self, array: &Arc<Vectors<T>>, cell: Cell) -> [Src; 3] {
        let same = |p: &Plane<T>| matches!(p, Plane::Component(a, 0) if Arc::ptr_eq(a, array));
        let at = match self.planes.iter().position(same) {
            Some(at) => {
                self.alias(at, cell);
                at
            }
            None => {
                self.planes.extend((0..3).map(|c| Plane::Component(array.clone(), c)));
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

    /// The constants, to be set anew before a run of a kept tape.
    pub fn constants_mut(&mut self) -> &mut [T] {
        &mut self.consts
    }

    fn push(&mut self, instr: Instr) -> Src {
        let from = self.code.len().saturating_sub(ALIKE);
        if let Some(at) = self.code[from..].iter().position(|i| *i == instr) {
            return Src::Reg((from + at) as u16);
        }
        self.code.push(instr);
        Src::Reg((self.code.len() - 1) as u16)
    }

    pub fn op(&mut self, code: Code, a: Src, b: Src) -> Src {
        self.push(Instr { code, a, b, c: b, d: b })
    }

    pub fn op1(&mut self, code: Code, a: Src) -> Src {
        self.push(Instr { code, a, b: a, c: a, d: a })
    }

    /// The function of each element; its results must be finite.
    pub fn unary(&mut self, f: fn(T) -> T, a: Src, shape: ArrayShape) -> Src {
        self.unary.push(f);
        let code = Code::Unary((self.unary.len() - 1) as u16);
        let at = self.push(Instr { code, a, b: a, c: a, d: a });
        self.checked.push(((self.code.len() - 1) as u16, shape));
        at
    }

    /// The function of each pair of elements; its results must be finite when there is a shape.
    pub fn binary(&mut self, f: fn(T, T) -> T, a: Src, b: Src, checked: Option<ArrayShape>) -> Src {
        self.binary.push(f);
        let code = Code::Binary((self.binary.len() - 1) as u16);
        let at = self.push(Instr { code, a, b, c: b, d: b });
        if let Some(shape) = checked {
            self.checked.push(((self.code.len() - 1) as u16, shape));
        }
        at
    }

    /// How many checks there are so far.
    pub fn checks(&self) -> usize {
        self.checked.len()
    }

    /// The first check that fails, when nothing but the checks is asked for.
    pub fn first_failure(&mut self, slots: &mut Vec<Vec<T>>) -> Option<usize> {
        let mut shapes: Vec<ArrayShape> = Vec::new();
        for (_, shape) in &self.checked {
            if !shapes.contains(shape) {
                shapes.push(*shape);
            }
        }
        let mut failure = |shape| self.run(&[], shape, slots, |_| Vec::new()).err();
        shapes.into_iter().filter_map(&mut failure).min()
    }

    /// A whole power, by the same multiplications as [`Real::powi`].
    pub fn powi(&mut self, a: Src, exponent: i32) -> Src {
        let one = self.constant(T::one(), Origin::FIXED);
        let mut base = if exponent < 0 { self.op(Code::Div, one, a) } else { a };
        let mut left = exponent.unsigned_abs();
        let mut power = one;
        while left > 0 {
            if left & 1 == 1 {
                // 1 * x is x for plain numbers; a derivative of minus zero would lose its sign.
                let skip = power == one && T::PARTS == 1;
                power = if skip { base } else { self.op(Code::Mul, power, base) };
            }
            left >>= 1;
            if left > 0 {
                base = self.op(Code::Mul, base, base);
            }
        }
        power
    }

    /// Makes steps of the instructions that the roots need: products are merged into the sums and
    /// products that alone use them, results go to as few slots as possible.
    fn plan(&mut self, roots: &[Src], shape: ArrayShape) {
        let Self { code, uses, homes, steps, checked, last, free, .. } = self;
        let check_of = |k: usize| {
            let at = checked.binary_search_by_key(&(k as u16), |c| c.0).ok()?;
            (checked[at].1 == shape).then_some(at as u16)
        };
        let n = code.len();
        uses.clear();
        uses.resize(n, 0);
        let root_of = |k: usize| roots.iter().position(|r| *r == Src::Reg(k as u16));
        for root in roots {
            if let Src::Reg(k) = root {
                uses[*k as usize] = uses[*k as usize].saturating_add(1);
            }
        }
        // Uses by what is itself used; checked instructions always are.
        for k in (0..n).rev() {
            if uses[k] == 0 && check_of(k).is_none() {
                continue;
            }
            let i = code[k];
            let operands: &[Src] = match i.code {
                Code::Neg | Code::Abs | Code::Sqrt | Code::Unary(_) => &[i.a],
                Code::MulAdd | Code::MulSub | Code::SubMul | Code::MulMul => &[i.a, i.b, i.c],
                Code::MulMulAdd => &[i.a, i.b, i.c, i.d],
                _ => &[i.a, i.b],
            };
            for operand in operands {
                if let Src::Reg(k) = operand {
                    uses[*k as usize] = uses[*k as usize].saturating_add(1);
                }
            }
        }
        homes.clear();
        homes.resize(n, Home::Slot(u16::MAX));
        for k in 0..n {
            let i = code[k];
            // The product that the operand is, when nothing else uses it.
            let only = |s: Src, is: Code| match s {
                Src::Reg(p) => {
                    let p = p as usize;
                    let alone = uses[p] == 1 && code[p].code == is && root_of(p).is_none();
                    (alone && homes[p] != Home::Nowhere).then_some(p)
                }
                _ => None,
            };
            let product = |s: Src| only(s, Code::Mul);
            let live = uses[k] > 0 || check_of(k).is_some();
            let merged = match (i.code, product(i.a), product(i.b)) {
                _ if !live || i.a == i.b => None,
                (Code::Add, Some(p), _) => Some((Code::MulAdd, p, i.b)),
                (Code::Add, _, Some(p)) => Some((Code::MulAdd, p, i.a)),
                (Code::Sub, Some(p), _) => Some((Code::MulSub, p, i.b)),
                (Code::Sub, _, Some(p)) => Some((Code::SubMul, p, i.a)),
                (Code::Mul, Some(p), _) => Some((Code::MulMul, p, i.b)),
                (Code::Mul, _, Some(p)) => Some((Code::MulMul, p, i.a)),
                _ => None,
            };
            let triple = match (merged, i.code) {
                (None, Code::Add) if live && i.a != i.b => {
                    let of = |s: Src, other: Src| Some((only(s, Code::MulMul)?, other));
                    of(i.a, i.b).or_else(|| of(i.b, i.a))
                }
                _ => None,
            };
            if let Some((code_of, p, c)) = merged {
                homes[p] = Home::Nowhere;
                code[k] = Instr { code: code_of, a: code[p].a, b: code[p].b, c, d: c };
            }
            if let Some((p, d)) = triple {
                homes[p] = Home::Nowhere;
                code[k] = Instr { code: Code::MulMulAdd, d, ..code[p] };
            }
            if !live {
                homes[k] = Home::Nowhere;
            }
        }
        // Slots, freed after the last use.
        last.clear();
        last.resize(n, 0);
        for k in 0..n {
            if homes[k] != Home::Nowhere {
                for s in [code[k].a, code[k].b, code[k].c, code[k].d] {
                    if let Src::Reg(p) = s {
                        last[p as usize] = k;
                    }
                }
            }
        }
        steps.clear();
        free.clear();
        let mut count = 0;
        for k in 0..n {
            if homes[k] == Home::Nowhere {
                continue;
            }
            let i = code[k];
            homes[k] = match root_of(k) {
                Some(out) => Home::Out(out as u16),
                None => Home::Slot(free.pop().unwrap_or_else(|| {
                    count += 1;
                    count - 1
                })),
            };
            let operand = |s: Src| match s {
                Src::Plane(p) => Operand::Plane(p),
                Src::Const(c) => Operand::Const(c),
                Src::Reg(r) => match homes[r as usize] {
                    Home::Slot(s) => Operand::Slot(s),
                    Home::Out(o) => Operand::Out(o),
                    Home::Nowhere => unreachable!("merged products have one user"),
                },
            };
            let check = check_of(k);
            let [a, b, c, d] = [i.a, i.b, i.c, i.d].map(operand);
            steps.push(Step { code: i.code, a, b, c, d, to: homes[k], check });
            let mut freed = [None; 4];
            for (f, s) in freed.iter_mut().zip([i.a, i.b, i.c, i.d]) {
                if let Src::Reg(p) = s
                    && last[p as usize] == k
                    && let Home::Slot(slot) = homes[p as usize]
                {
                    *f = Some(slot);
                }
            }
            for (at, f) in freed.into_iter().enumerate() {
                if let Some(slot) = f
                    && !freed[..at].contains(&f)
                {
                    free.push(slot);
                }
            }
            if uses[k] == 0
                && let Home::Slot(slot) = homes[k]
            {
                free.push(slot);
            }
        }
        self.slots = count as usize;
    }

    /// The values of the roots, elements of that shape each. `take` gives rows of a length to write
    /// into, `slots` is memory for results on the way.
    ///
    /// # Errors
    /// The number of the first check that failed, in the order of the instructions.
    pub fn run(
        &mut self,
        roots: &[Src],
        shape: ArrayShape,
        slots: &mut Vec<Vec<T>>,
        take: impl FnMut(usize) -> Vec<T>,
    ) -> Result<SmallVec<[Vec<T>; 3]>, usize> {
        self.plan(roots, shape);
        let rows: SmallVec<[&[T]; 16]> = self.planes.iter().map(Plane::numbers).collect();
        self.execute(&rows, roots, shape.count(), slots, take)
    }

    /// Runs a tape that was run before with the same roots and shape, on other rows.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn execute(
        &self,
        planes: &[&[T]],
        roots: &[Src],
        count: usize,
        slots: &mut Vec<Vec<T>>,
        mut take: impl FnMut(usize) -> Vec<T>,
    ) -> Result<SmallVec<[Vec<T>; 3]>, usize> {
        while slots.len() < self.slots {
            slots.push(vec![T::zero(); block::<T>() + APART]);
        }
        let mut outs: SmallVec<[Vec<T>; 3]> = roots.iter().map(|_| take(count)).collect();
        let failed =
            pulp::Arch::new().dispatch(Pass { tape: self, planes, outs: &mut outs, slots, count });
        if let Some(check) = failed {
            return Err(check as usize);
        }
        // Roots that are no result of their own: sources, constants, the same result twice.
        for (k, root) in roots.iter().enumerate() {
            match *root {
                Src::Plane(p) => outs[k].copy_from_slice(&planes[p as usize][..count]),
                Src::Const(c) => outs[k].fill(self.consts[c as usize]),
                Src::Reg(_) => {
                    if let Some(first) = roots[..k].iter().position(|r| r == root) {
                        let (done, rest) = outs.split_at_mut(k);
                        rest[0].copy_from_slice(&done[first]);
                    }
                }
            }
        }
        Ok(outs)
    }
}

/// All blocks of a tape, compiled for wide registers as well.
struct Pass<'a, T: Real> {
    tape: &'a Tape<T>,
    planes: &'a [&'a [T]],
    outs: &'a mut [Vec<T>],
    slots: &'a mut [Vec<T>],
    count: usize,
}

impl<T: Real> pulp::NullaryFnOnce for Pass<'_, T> {
    /// The first check that failed.
    type Output = Option<u16>;

    #[inline(always)]
    fn call(self) -> Option<u16> {
        let Self { tape, planes, outs, slots, count } = self;
        let mut failed: Option<u16> = None;
        let mut lo = 0;
        while lo < count {
            let hi = (lo + block::<T>()).min(count);
            for step in &tape.steps {
                let held = match step.to {
                    Home::Slot(s) => &mut slots[s as usize],
                    Home::Out(o) => &mut outs[o as usize],
                    Home::Nowhere => unreachable!("only kept results are steps"),
                };
                // Taken out for the moment, so that operands can be read beside it.
                let mut held = std::mem::take(held);
                let to = match step.to {
                    Home::Out(_) => &mut held[lo..hi],
                    _ => &mut held[..hi - lo],
                };
                let operand = |o: Operand| match o {
                    Operand::Plane(p) => In::Row(&planes[p as usize][lo..hi]),
                    Operand::Const(c) => In::Const(tape.consts[c as usize]),
                    Operand::Slot(s) => In::Row(&slots[s as usize][..hi - lo]),
                    Operand::Out(o) => In::Row(&outs[o as usize][lo..hi]),
                };
                let (a, b, c) = (operand(step.a), operand(step.b), operand(step.c));
                match step.code {
                    Code::Add => two(to, a, b, |a, b| a + b),
                    Code::Sub => two(to, a, b, |a, b| a - b),
                    Code::Mul => two(to, a, b, |a, b| a * b),
                    Code::Div => two(to, a, b, |a, b| a / b),
                    Code::Neg => one(to, a, |a| -a),
                    Code::Abs => one(to, a, |a| a.abs()),
                    Code::Sqrt => one(to, a, |a| a.sqrt()),
                    Code::MulAdd => three(to, a, b, c, |a, b, c| a * b + c),
                    Code::MulSub => three(to, a, b, c, |a, b, c| a * b - c),
                    Code::SubMul => three(to, a, b, c, |a, b, c| c - a * b),
                    Code::MulMul => three(to, a, b, c, |a, b, c| a * b * c),
                    Code::MulMulAdd => triple_sum(to, a, b, c, operand(step.d)),
                    Code::Unary(f) => one(to, a, tape.unary[f as usize]),
                    Code::Binary(f) => two(to, a, b, tape.binary[f as usize]),
                }
                if let Some(check) = step.check
                    && failed.is_none_or(|first| check < first)
                    && !to.iter().all(|x| x.is_finite())
                {
                    failed = Some(check);
                }
                match step.to {
                    Home::Slot(s) => slots[s as usize] = held,
                    Home::Out(o) => outs[o as usize] = held,
                    Home::Nowhere => {}
                }
            }
            lo = hi;
        }
        failed
    }
}

/// Elements that go through together.
fn block<T: Real>() -> usize {
    (BLOCK_PARTS / T::PARTS).max(64)
}

/// An operand in a block.
#[derive(Clone, Copy)]
enum In<'a, T> {
    Row(&'a [T]),
    Const(T),
}

#[inline(always)]
fn one<T: Real>(to: &mut [T], a: In<'_, T>, f: impl Fn(T) -> T) {
    match a {
        In::Row(a) => to.iter_mut().zip(a).for_each(|(t, &a)| *t = f(a)),
        In::Const(a) => to.fill(f(a)),
    }
}

#[inline(always)]
fn two<T: Real>(to: &mut [T], a: In<'_, T>, b: In<'_, T>, f: impl Fn(T, T) -> T) {
    match (a, b) {
        (In::Row(a), In::Row(b)) => {
            to.iter_mut().zip(a).zip(b).for_each(|((t, &a), &b)| *t = f(a, b));
        }
        (In::Row(a), In::Const(b)) => to.iter_mut().zip(a).for_each(|(t, &a)| *t = f(a, b)),
        (In::Const(a), In::Row(b)) => to.iter_mut().zip(b).for_each(|(t, &b)| *t = f(a, b)),
        (In::Const(a), In::Const(b)) => to.fill(f(a, b)),
    }
}

/// (a * b) * c + d
#[inline(always)]
fn triple_sum<T: Real>(to: &mut [T], a: In<'_, T>, b: In<'_, T>, c: In<'_, T>, d: In<'_, T>) {
    match (a, b, c, d) {
        (In::Const(a), In::Row(b), In::Row(c), In::Row(d))
        | (In::Row(b), In::Const(a), In::Row(c), In::Row(d)) => {
            let rows = b.iter().zip(c).zip(d);
            to.iter_mut().zip(rows).for_each(|(t, ((&b, &c), &d))| *t = a * b * c + d);
        }
        (In::Row(a), In::Row(b), In::Row(c), In::Row(d)) => {
            let rows = a.iter().zip(b).zip(c).zip(d);
            to.iter_mut().zip(rows).for_each(|(t, (((&a, &b), &c), &d))| *t = a * b * c + d);
        }
        (In::Row(a), In::Row(b), In::Const(c), In::Row(d)) => {
            let rows = a.iter().zip(b).zip(d);
            to.iter_mut().zip(rows).for_each(|(t, ((&a, &b), &d))| *t = a * b * c + d);
        }
        _ => {
            let at = |x: In<'_, T>, k: usize| match x {
                In::Row(row) => row[k],
                In::Const(x) => x,
            };
            for (k, t) in to.iter_mut().enumerate() {
                *t = at(a, k) * at(b, k) * at(c, k) + at(d, k);
            }
        }
    }
}

#[inline(always)]
fn three<T: Real>(
    to: &mut [T],
    a: In<'_, T>,
    b: In<'_, T>,
    c: In<'_, T>,
    f: impl Fn(T, T, T) -> T,
) {
    match (a, b, c) {
        (In::Row(a), In::Row(b), In::Row(c)) => {
            let rows = a.iter().zip(b).zip(c);
            to.iter_mut().zip(rows).for_each(|(t, ((&a, &b), &c))| *t = f(a, b, c));
        }
        (In::Row(a), In::Row(b), In::Const(c)) => {
            to.iter_mut().zip(a).zip(b).for_each(|((t, &a), &b)| *t = f(a, b, c));
        }
        (In::Row(a), In::Const(b), c) => two(to, In::Row(a), c, |a, c| f(a, b, c)),
        (In::Const(a), In::Row(b), c) => two(to, In::Row(b), c, |b, c| f(a, b, c)),
        (In::Const(a), In::Const(b), c) => one(to, c, |c| f(a, b, c)),
    }
}
