//! The machine that runs a tape: it executes each instruction on a chunk of elements before the
//! next one.
//!
//! Chunks are long enough for the dispatch of instructions to be negligible, and short enough for
//! all their data to stay in the first cache. Sources are first copied to aligned memory of the
//! machine, so that no pack of numbers crosses a cache line; results are written to their rows
//! directly. An instruction that adds products computes them too, so that few numbers pass through
//! memory. Packs are as wide as the processor's registers ([`pulp`] detects the width), and each
//! operation is rounded separately: the same bits for any width.

use moldloft_num::Real;
use pulp::bytemuck::cast_slice_mut;
use pulp::{Arch, Simd, WithSimd};
use smallvec::SmallVec;
use std::any::Any;
use std::cell::Cell;
use std::marker::PhantomData;
use std::sync::LazyLock;

/// Location of the elements of a chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowLocation {
    /// In a row of the results.
    Out(u16),
    /// In memory of the machine.
    Slot(u16),
}

/// An operand of a function: elements, or the same number for all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operand {
    Row(RowLocation),
    Const(u16),
}

/// An operand of a sum or product: numbers below `c` are rows, those from it constants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Term {
    /// x
    Row(RowLocation),
    /// x c
    Scaled(RowLocation, u16),
    /// x y
    Product(RowLocation, RowLocation),
    /// (x c) y
    ScaledProduct(RowLocation, u16, RowLocation),
}

/// Sign of a term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    Plus,
    Minus,
}

/// An operation on the elements of a chunk, whose result is written to a row. Products and sums are
/// rounded separately.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VmInstruction {
    /// The elements of a source.
    Source(u16),
    /// c
    Fill(u16),
    /// A product.
    Term(Term),
    /// x + y, or x - y
    Sum(Term, Sign, Term),
    /// (x + y) + z, or with other signs
    Sums(RowLocation, [(Sign, Term); 2]),
    /// x + c, or x - c
    Shifted(Term, Sign, u16),
    /// c - x
    From(u16, Term),
    /// x / y. The last is true for a check, here and below: results must be finite, and so must the
    /// operands, since these operations make finite numbers of infinite ones.
    Ratio(RowLocation, RowLocation, bool),
    /// x / c
    Part(RowLocation, u16, bool),
    /// c / x
    Over(u16, RowLocation, bool),
    Neg(RowLocation),
    Abs(RowLocation),
    Sqrt(RowLocation),
    /// A function of each element.
    Unary(u16, Operand, bool),
    /// A function of two.
    Binary(u16, [Operand; 2], bool),
}

/// Instructions with their operands.
#[derive(Debug)]
pub struct VmProgram<T> {
    /// Operations, and the row of each result.
    pub orders: Vec<(VmInstruction, RowLocation)>,
    pub unary: Vec<fn(T) -> T>,
    pub binary: Vec<fn(T, T) -> T>,
    /// Number of slots used.
    pub slots: usize,
    /// True when the results must be finite.
    pub finite: bool,
}

impl<T> Default for VmProgram<T> {
    fn default() -> Self {
        Self { orders: Vec::new(), unary: Vec::new(), binary: Vec::new(), slots: 0, finite: false }
    }
}

impl<T: Real> VmProgram<T> {
    /// Carries the orders out for the first `count` elements of the planes and results; planes that are
    /// shorter are not used by the orders. False when something that must be finite is not.
    pub fn run(&self, planes: &[&Vec<T>], consts: &[T], outs: &mut [Vec<T>], count: usize) -> bool {
        // The processor does not change, and asking it takes longer than a short row.
        static ARCH: LazyLock<Arch> = LazyLock::new(Arch::new);
        thread_local! {
            /// Memory for the slots of plain numbers: an allocation takes longer than a short row.
            static MEMORY: Cell<Vec<f64>> = const { Cell::new(Vec::new()) };
        }
        if count == 0 {
            return true;
        }
        if let Some(program) = (self as &dyn Any).downcast_ref::<VmProgram<f64>>() {
            // Numbers without derivatives, so all rows are of those.
            let planes = planes.iter().map(|row| {
                let row: &dyn Any = *row;
                let row: Option<&Vec<f64>> = row.downcast_ref();
                row.and_then(|row| row.get(..count)).unwrap_or(&[])
            });
            let outs = outs.iter_mut().filter_map(|row| {
                let row: &mut dyn Any = row;
                let row: Option<&mut Vec<f64>> = row.downcast_mut();
                row.map(|row| &mut row[..count])
            });
            let consts = consts.iter().map(|x| x.re()).collect::<SmallVec<[f64; 16]>>();
            let mut memory = MEMORY.take();
            let rows =
                Rows { planes: planes.collect(), consts: &consts, outs: outs.collect(), count };
            let sound = ARCH.dispatch(Wide { program, rows, memory: &mut memory });
            MEMORY.set(memory);
            return sound;
        }
        let planes = planes.iter().map(|row| row.get(..count).unwrap_or(&[]));
        let outs = outs.iter_mut().map(|row| &mut row[..count]);
        let rows = Rows { planes: planes.collect(), consts, outs: outs.collect(), count };
        go(Single(PhantomData), self, rows, &mut Vec::new())
    }
}

/// The rows that a program reads and writes, and their number of elements.
struct Rows<'a, T> {
    planes: SmallVec<[&'a [T]; 16]>,
    consts: &'a [T],
    outs: SmallVec<[&'a mut [T]; 3]>,
    count: usize,
}

/// A run on packs of plain numbers, compiled for each width of them.
struct Wide<'a> {
    program: &'a VmProgram<f64>,
    rows: Rows<'a, f64>,
    memory: &'a mut Vec<f64>,
}

impl WithSimd for Wide<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        go(Packed(simd), self.program, self.rows, self.memory)
    }
}

/// Numbers side by side that an operation takes at once.
trait Packs: Copy {
    type Number: Real;
    type Pack: Copy;
    /// Numbers of a pack.
    const LANES: usize;
    fn of(self, x: Self::Number) -> Self::Pack;
    /// Rows of whole packs as packs.
    fn packs(row: &[Self::Number]) -> &[Self::Pack];
    fn packs_mut(row: &mut [Self::Number]) -> &mut [Self::Pack];
    fn numbers_mut(packs: &mut [Self::Pack]) -> &mut [Self::Number];
    fn add(self, a: Self::Pack, b: Self::Pack) -> Self::Pack;
    fn sub(self, a: Self::Pack, b: Self::Pack) -> Self::Pack;
    fn mul(self, a: Self::Pack, b: Self::Pack) -> Self::Pack;
    fn div(self, a: Self::Pack, b: Self::Pack) -> Self::Pack;
    fn neg(self, a: Self::Pack) -> Self::Pack;
    fn abs(self, a: Self::Pack) -> Self::Pack;
    fn sqrt(self, a: Self::Pack) -> Self::Pack;
}

/// A register of plain numbers.
#[derive(Clone, Copy)]
struct Packed<S>(S);

impl<S: Simd> Packs for Packed<S> {
    type Number = f64;
    type Pack = S::f64s;
    const LANES: usize = S::F64_LANES;
    #[inline(always)]
    fn of(self, x: f64) -> S::f64s {
        self.0.splat_f64s(x)
    }
    #[inline(always)]
    fn packs(row: &[f64]) -> &[S::f64s] {
        S::as_simd_f64s(row).0
    }
    #[inline(always)]
    fn packs_mut(row: &mut [f64]) -> &mut [S::f64s] {
        S::as_mut_simd_f64s(row).0
    }
    #[inline(always)]
    fn numbers_mut(packs: &mut [S::f64s]) -> &mut [f64] {
        cast_slice_mut(packs)
    }
    #[inline(always)]
    fn add(self, a: S::f64s, b: S::f64s) -> S::f64s {
        self.0.add_f64s(a, b)
    }
    #[inline(always)]
    fn sub(self, a: S::f64s, b: S::f64s) -> S::f64s {
        self.0.sub_f64s(a, b)
    }
    #[inline(always)]
    fn mul(self, a: S::f64s, b: S::f64s) -> S::f64s {
        self.0.mul_f64s(a, b)
    }
    #[inline(always)]
    fn div(self, a: S::f64s, b: S::f64s) -> S::f64s {
        self.0.div_f64s(a, b)
    }
    #[inline(always)]
    fn neg(self, a: S::f64s) -> S::f64s {
        self.0.neg_f64s(a)
    }
    #[inline(always)]
    fn abs(self, a: S::f64s) -> S::f64s {
        self.0.abs_f64s(a)
    }
    #[inline(always)]
    fn sqrt(self, a: S::f64s) -> S::f64s {
        self.0.sqrt_f64s(a)
    }
}

/// One number of any kind.
struct Single<T>(PhantomData<T>);

impl<T> Clone for Single<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Single<T> {}

impl<T: Real> Packs for Single<T> {
    type Number = T;
    type Pack = T;
    const LANES: usize = 1;
    fn of(self, x: T) -> T {
        x
    }
    fn packs(row: &[T]) -> &[T] {
        row
    }
    fn packs_mut(row: &mut [T]) -> &mut [T] {
        row
    }
    fn numbers_mut(packs: &mut [T]) -> &mut [T] {
        packs
    }
    #[inline(always)]
    fn add(self, a: T, b: T) -> T {
        a + b
    }
    #[inline(always)]
    fn sub(self, a: T, b: T) -> T {
        a - b
    }
    #[inline(always)]
    fn mul(self, a: T, b: T) -> T {
        a * b
    }
    #[inline(always)]
    fn div(self, a: T, b: T) -> T {
        a / b
    }
    #[inline(always)]
    fn neg(self, a: T) -> T {
        -a
    }
    #[inline(always)]
    fn abs(self, a: T) -> T {
        a.abs()
    }
    #[inline(always)]
    fn sqrt(self, a: T) -> T {
        a.sqrt()
    }
}

/// Packs of a block: an instruction reads a whole block before it writes the same, so that a row
/// may become a function of itself, and the latency of operations is hidden.
const BLOCK: usize = 4;

/// Packs that are read and written together. A cell, since orders write to memory that others read.
type Block<P> = Cell<[<P as Packs>::Pack; BLOCK]>;

/// The memory that all rows of a stretch take together at most, in bytes: well inside a first cache of 32 KiB.
const STRETCH: usize = 30 << 10;

/// Memory of the rows of a stretch for sources and results that exceed the cache: writing to such memory waits for it,
/// less so when there is other work between.
const STRETCH_FAR: usize = 16 << 10;

/// Size of sources and results, in bytes, above which they are assumed to exceed the cache.
const FAR: usize = 16 << 20;

/// Carries the orders out for all elements, stretch by stretch.
#[inline(always)]
fn go<P: Packs>(
    p: P,
    program: &VmProgram<P::Number>,
    rows: Rows<'_, P::Number>,
    memory: &mut Vec<P::Number>,
) -> bool {
    let Rows { planes, consts: numbers, outs, count } = rows;
    let zero = <P::Number as From<f64>>::from(0.0);
    let block = BLOCK * P::LANES;
    let all = program.slots + outs.len();
    let (read, written) = (planes.len(), outs.len());
    let large = count * size_of::<P::Number>() * (read + written) > FAR;
    let most =
        if large { STRETCH_FAR } else { STRETCH } / (size_of::<P::Number>() * block * all.max(1));
    let blocks = most.clamp(2, 32).min(count.div_ceil(block));
    // Slots, and rows for the remainders of results, aligned to cache lines. They are separated by
    // one block, since rows a power of two apart would map to the same cache sets.
    let stride = blocks + 1;
    let needed = all * stride * block;
    let line = 64 / size_of::<P::Number>().min(64);
    if memory.len() < needed + line {
        memory.resize(needed + line, zero);
    }
    let start = memory.as_ptr().align_offset(64).min(line);
    let packs = P::packs_mut(&mut memory[start..start + needed]);
    let cells = Cell::from_mut(packs.as_chunks_mut::<BLOCK>().0).as_slice_of_cells();
    let mut consts: SmallVec<[P::Pack; 16]> = SmallVec::new();
    consts.extend(numbers.iter().map(|x| p.of(*x)));
    let mut failed = false;
    let length = blocks * block;
    let whole = count - count % length;
    let mut left: SmallVec<[&mut [P::Number]; 3]> = SmallVec::new();
    let mut direct: SmallVec<[&[Block<P>]; 3]> = SmallVec::new();
    for out in outs {
        let (rows, rest) = out.split_at_mut(whole);
        left.push(rest);
        let packs = P::packs_mut(rows).as_chunks_mut::<BLOCK>().0;
        direct.push(Cell::from_mut(packs).as_slice_of_cells());
    }
    for at in (0..count).step_by(length) {
        let end = (at + length).min(count);
        if at == whole {
            // Remainders of results pass through the machine's memory.
            let rows = cells[program.slots * stride..].chunks(stride);
            direct.iter_mut().zip(rows).for_each(|(row, here)| *row = here);
        }
        let m = Machine::<P> {
            planes: &planes,
            range: [at, end],
            outs: &direct,
            from: if at == whole { 0 } else { at / block },
            slots: cells,
            blocks: (end - at).div_ceil(block),
            stride,
            consts: &consts,
        };
        carry_out(p, program, &m, &mut failed);
    }
    for (out, row) in left.into_iter().zip(&direct) {
        for (to, from) in out.chunks_mut(block).zip(*row) {
            let mut packs = from.get();
            to.copy_from_slice(&P::numbers_mut(&mut packs)[..to.len()]);
        }
    }
    !failed
}

/// Data of a chunk's instructions.
struct Machine<'a, P: Packs> {
    planes: &'a [&'a [P::Number]],
    /// The elements of the planes.
    range: [usize; 2],
    outs: &'a [&'a [Block<P>]],
    /// The first block of the results.
    from: usize,
    slots: &'a [Block<P>],
    /// The blocks of a stretch, and those from one slot to the next.
    blocks: usize,
    stride: usize,
    consts: &'a [P::Pack],
}

impl<'a, P: Packs> Machine<'a, P> {
    #[inline(always)]
    fn row(&self, row: RowLocation) -> &'a [Block<P>] {
        let (all, from) = match row {
            RowLocation::Out(k) => (self.outs[k as usize], self.from),
            RowLocation::Slot(k) => (self.slots, k as usize * self.stride),
        };
        &all[from..][..self.blocks]
    }
}

/// The packs of an operand or term.
trait At<P: Packs> {
    fn at(&self, p: P, k: usize) -> [P::Pack; BLOCK];
}

struct PlainTerm<'a, P: Packs>(&'a [Block<P>]);
struct ScaledTerm<'a, P: Packs>(&'a [Block<P>], P::Pack);
struct ProductTerm<'a, P: Packs>(&'a [Block<P>], &'a [Block<P>]);
struct ScaledProduct<'a, P: Packs>(&'a [Block<P>], P::Pack, &'a [Block<P>]);

/// r[j] = x for the packs of a block, where x is an expression of j. Written out instead of closures, which
/// need not be inlined and would be compiled for narrow registers then.
macro_rules! packs {
    ($x:ident[$j:ident] = $value:expr) => {{
        let mut r = $x;
        for $j in 0..BLOCK {
            r[$j] = $value;
        }
        r
    }};
}

impl<P: Packs> At<P> for PlainTerm<'_, P> {
    #[inline(always)]
    fn at(&self, _: P, k: usize) -> [P::Pack; BLOCK] {
        self.0[k].get()
    }
}

impl<P: Packs> At<P> for ScaledTerm<'_, P> {
    #[inline(always)]
    fn at(&self, p: P, k: usize) -> [P::Pack; BLOCK] {
        let x = self.0[k].get();
        packs!(x[j] = p.mul(x[j], self.1))
    }
}

impl<P: Packs> At<P> for ProductTerm<'_, P> {
    #[inline(always)]
    fn at(&self, p: P, k: usize) -> [P::Pack; BLOCK] {
        let (x, y) = (self.0[k].get(), self.1[k].get());
        packs!(x[j] = p.mul(x[j], y[j]))
    }
}

impl<P: Packs> At<P> for ScaledProduct<'_, P> {
    #[inline(always)]
    fn at(&self, p: P, k: usize) -> [P::Pack; BLOCK] {
        let (x, y) = (self.0[k].get(), self.2[k].get());
        packs!(x[j] = p.mul(p.mul(x[j], self.1), y[j]))
    }
}

/// Carries the orders out for one stretch.
#[inline(always)]
fn carry_out<P: Packs>(
    p: P,
    program: &VmProgram<P::Number>,
    m: &Machine<'_, P>,
    failed: &mut bool,
) {
    for &(order, to) in &program.orders {
        let to = m.row(to);
        // Each block becomes the value of an expression of its number.
        macro_rules! set {
            (|$k:ident| $value:expr) => {
                for $k in 0..to.len() {
                    to[$k].set($value);
                }
            };
        }
        // An expression of a term, for each kind.
        macro_rules! term {
            ($term:expr, |$x:ident| $work:expr) => {
                match $term {
                    Term::Row(x) => {
                        let $x = PlainTerm::<P>(&m.row(x)[..to.len()]);
                        $work
                    }
                    Term::Scaled(x, c) => {
                        let $x = ScaledTerm::<P>(&m.row(x)[..to.len()], m.consts[c as usize]);
                        $work
                    }
                    Term::Product(x, y) => {
                        let $x = ProductTerm::<P>(&m.row(x)[..to.len()], &m.row(y)[..to.len()]);
                        $work
                    }
                    Term::ScaledProduct(x, c, y) => {
                        let (x, y) = (&m.row(x)[..to.len()], &m.row(y)[..to.len()]);
                        let $x = ScaledProduct::<P>(x, m.consts[c as usize], y);
                        $work
                    }
                }
            };
        }
        // An expression of a row's block.
        macro_rules! row {
            ($row:expr, |$x:ident| $work:expr) => {{
                let row = &m.row($row)[..to.len()];
                set!(|k| {
                    let $x = row[k].get();
                    $work
                });
            }};
        }
        match order {
            VmInstruction::Source(plane) => {
                let [from, end] = m.range;
                let plane = &m.planes[plane as usize][from..end];
                let (packs, _) = P::packs(plane).as_chunks::<BLOCK>();
                for (to, x) in to.iter().zip(packs) {
                    to.set(*x);
                }
                // The remainder, padded with its last element, which cannot fail another check.
                let done = packs.len() * BLOCK * P::LANES;
                if let (Some(to), Some(last)) = (to.get(packs.len()), plane.last()) {
                    let mut packs = [p.of(*last); BLOCK];
                    let numbers = P::numbers_mut(&mut packs);
                    numbers[..plane.len() - done].copy_from_slice(&plane[done..]);
                    to.set(packs);
                }
            }
            VmInstruction::Fill(c) => {
                let c = m.consts[c as usize];
                set!(|_k| [c; BLOCK]);
            }
            VmInstruction::Term(x) => term!(x, |x| set!(|k| x.at(p, k))),
            VmInstruction::Sum(x, sign, y) => term!(x, |x| term!(y, |y| match sign {
                Sign::Plus => set!(|k| {
                    let (x, y) = (x.at(p, k), y.at(p, k));
                    packs!(x[j] = p.add(x[j], y[j]))
                }),
                Sign::Minus => set!(|k| {
                    let (x, y) = (x.at(p, k), y.at(p, k));
                    packs!(x[j] = p.sub(x[j], y[j]))
                }),
            })),
            VmInstruction::Sums(x, [(first, y), (second, z)]) => {
                let x = &m.row(x)[..to.len()];
                macro_rules! sums {
                    ($add:ident, $then:ident) => {
                        term!(y, |y| term!(z, |z| set!(|k| {
                            let (x, y, z) = (x[k].get(), y.at(p, k), z.at(p, k));
                            packs!(x[j] = p.$then(p.$add(x[j], y[j]), z[j]))
                        })))
                    };
                }
                match (first, second) {
                    (Sign::Plus, Sign::Plus) => sums!(add, add),
                    (Sign::Plus, Sign::Minus) => sums!(add, sub),
                    (Sign::Minus, Sign::Plus) => sums!(sub, add),
                    (Sign::Minus, Sign::Minus) => sums!(sub, sub),
                }
            }
            VmInstruction::Shifted(x, sign, c) => {
                let c = m.consts[c as usize];
                term!(x, |x| match sign {
                    Sign::Plus => set!(|k| {
                        let x = x.at(p, k);
                        packs!(x[j] = p.add(x[j], c))
                    }),
                    Sign::Minus => set!(|k| {
                        let x = x.at(p, k);
                        packs!(x[j] = p.sub(x[j], c))
                    }),
                });
            }
            VmInstruction::From(c, x) => {
                let c = m.consts[c as usize];
                term!(x, |x| set!(|k| {
                    let x = x.at(p, k);
                    packs!(x[j] = p.sub(c, x[j]))
                }));
            }
            VmInstruction::Ratio(x, y, check) => {
                let y = &m.row(y)[..to.len()];
                let x = &m.row(x)[..to.len()];
                set!(|k| {
                    let (x, mut y) = (x[k].get(), y[k].get());
                    *failed |= check && !all_finite::<P>(&mut y);
                    packs!(x[j] = p.div(x[j], y[j]))
                });
                *failed |= check && !row_is_finite::<P>(to);
            }
            VmInstruction::Part(x, c, check) => {
                let c = m.consts[c as usize];
                row!(x, |x| packs!(x[j] = p.div(x[j], c)));
                *failed |= check && !row_is_finite::<P>(to);
            }
            VmInstruction::Over(c, x, check) => {
                let c = m.consts[c as usize];
                let x = &m.row(x)[..to.len()];
                set!(|k| {
                    let mut x = x[k].get();
                    *failed |= check && !all_finite::<P>(&mut x);
                    packs!(x[j] = p.div(c, x[j]))
                });
                *failed |= check && !row_is_finite::<P>(to);
            }
            VmInstruction::Neg(x) => row!(x, |x| packs!(x[j] = p.neg(x[j]))),
            VmInstruction::Abs(x) => row!(x, |x| packs!(x[j] = p.abs(x[j]))),
            VmInstruction::Sqrt(x) => row!(x, |x| packs!(x[j] = p.sqrt(x[j]))),
            VmInstruction::Unary(f, x, check) => {
                let f = program.unary[f as usize];
                for k in 0..to.len() {
                    let mut x = operand(m, x, k);
                    *failed |= check && !all_finite::<P>(&mut x);
                    let numbers = P::numbers_mut(&mut x);
                    for x in &mut *numbers {
                        *x = f(*x);
                    }
                    *failed |= check && !all_finite::<P>(&mut x);
                    to[k].set(x);
                }
            }
            VmInstruction::Binary(f, of, check) => {
                let f = program.binary[f as usize];
                for k in 0..to.len() {
                    let [mut x, mut y] = [operand(m, of[0], k), operand(m, of[1], k)];
                    *failed |= check && !(all_finite::<P>(&mut x) && all_finite::<P>(&mut y));
                    let (numbers, y) = (P::numbers_mut(&mut x), P::numbers_mut(&mut y));
                    for (x, y) in numbers.iter_mut().zip(y) {
                        *x = f(*x, *y);
                    }
                    *failed |= check && !all_finite::<P>(&mut x);
                    to[k].set(x);
                }
            }
        }
    }
    if program.finite {
        for out in 0..m.outs.len() {
            *failed |= !row_is_finite::<P>(m.row(RowLocation::Out(out as u16)));
        }
    }
}

/// An operand's packs of block `k`.
#[inline(always)]
fn operand<P: Packs>(m: &Machine<'_, P>, x: Operand, k: usize) -> [P::Pack; BLOCK] {
    match x {
        Operand::Row(row) => m.row(row)[k].get(),
        Operand::Const(c) => [m.consts[c as usize]; BLOCK],
    }
}

/// True when all numbers of a row are finite.
#[inline(always)]
fn row_is_finite<P: Packs>(row: &[Block<P>]) -> bool {
    row.iter().fold(true, |finite, block| finite & all_finite::<P>(&mut block.get()))
}

/// True when all numbers of a block are finite: without an early exit, so that the loop is of whole packs.
#[inline(always)]
fn all_finite<P: Packs>(block: &mut [P::Pack; BLOCK]) -> bool {
    P::numbers_mut(block).iter().fold(true, |finite, x| finite & x.is_finite())
}
