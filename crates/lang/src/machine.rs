//! What runs a tape: a machine with two registers that are several packs of numbers wide.
//!
//! A program goes over rows of elements in chunks: every order is carried out for all elements of a
//! chunk before the next one, so that deciding what an order is costs little, and results on the way
//! stay in registers, or in slots of the size of a chunk. Packs are as wide as the processor's registers
//! ([`pulp`] finds out), and an order rounds each of its operations by itself: the same bits
//! whatever the width.

use moldloft_num::Real;
use pulp::bytemuck::cast_slice_mut;
use pulp::{Arch, Simd, WithSimd};
use smallvec::SmallVec;
use std::any::Any;
use std::marker::PhantomData;
use std::sync::LazyLock;

/// One of the two registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reg {
    A,
    B,
}

/// Where the elements of a chunk are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Row {
    /// In a row of the sources.
    Plane(u16),
    /// In a row of the results.
    Out(u16),
    /// In memory of the machine.
    Slot(u16),
}

/// An operand of an order: elements, or the same number for all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operand {
    Row(Row),
    Const(u16),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Op {
    Add,
    Sub,
    Mul,
    Div,
}

/// What the machine does with the elements of a chunk. Products and sums are rounded each by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Order {
    /// r = x
    Load(Reg, Operand),
    /// r = x op y
    Rows(Reg, Op, Row, Row),
    /// r = x op c
    RowConst(Reg, Op, Row, u16),
    /// r = c op x
    ConstRow(Reg, Op, u16, Row),
    /// r = r op x
    By(Reg, Op, Operand),
    /// r = x op r
    From(Reg, Op, Operand),
    /// a = a op b
    Join(Op),
    /// a = b op a
    JoinFrom(Op),
    /// a = a + x y, or a - x y
    Product(Sign, Row, Row),
    /// a = a + x c, or a - x c
    ProductConst(Sign, Row, u16),
    /// a = a + b x, or a - b x
    Times(Sign, Operand),
    Neg(Reg),
    Abs(Reg),
    Sqrt(Reg),
    /// The row becomes a.
    Store(Row),
    /// Each element of a row becomes its function. The last number is that of a check: results must be
    /// finite.
    Unary(u16, Row, Option<u16>),
    /// Each element of a row becomes the function of itself and the operand's.
    Binary(u16, Row, Operand, Option<u16>),
}

/// Whether a product is added or taken away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sign {
    Plus,
    Minus,
}

/// Orders with what they refer to.
#[derive(Debug)]
pub(crate) struct Program<T> {
    pub orders: Vec<Order>,
    pub consts: Vec<T>,
    pub unary: Vec<fn(T) -> T>,
    pub binary: Vec<fn(T, T) -> T>,
    /// How many slots the orders use.
    pub slots: usize,
}

impl<T> Default for Program<T> {
    fn default() -> Self {
        Self {
            orders: Vec::new(),
            consts: Vec::new(),
            unary: Vec::new(),
            binary: Vec::new(),
            slots: 0,
        }
    }
}

impl<T: Real> Program<T> {
    /// Carries the orders out for the first `count` elements of the planes and results; planes that are
    /// shorter are not used by the orders. The number of the first check that failed.
    pub fn run(&self, planes: &[&Vec<T>], outs: &mut [Vec<T>], count: usize) -> Option<u16> {
        // The processor does not change, and asking it takes longer than a short row.
        static ARCH: LazyLock<Arch> = LazyLock::new(Arch::new);
        if let Some(program) = (self as &dyn Any).downcast_ref::<Program<f64>>() {
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
            let (planes, outs) = (planes.collect(), outs.collect());
            return ARCH.dispatch(Wide { program, planes, outs, count });
        }
        let planes = planes.iter().map(|row| row.get(..count).unwrap_or(&[]));
        let mut rows = Rows {
            planes: planes.collect(),
            outs: outs.iter_mut().map(|row| &mut row[..count]).collect(),
        };
        let mut failed = None;
        let one = Single(PhantomData);
        let whole = count - count % AT_ONCE;
        go::<Single<T>, AT_ONCE>(one, self, &mut rows, [0, whole], &mut failed);
        go::<Single<T>, 1>(one, self, &mut rows, [whole, count], &mut failed);
        failed
    }
}

/// Numbers with derivatives that go through a program together: each is a pack by itself.
const AT_ONCE: usize = 4;

/// The rows that a program reads and writes.
struct Rows<'a, T> {
    planes: SmallVec<[&'a [T]; 16]>,
    outs: SmallVec<[&'a mut [T]; 3]>,
}

/// A run on packs of plain numbers, compiled for each width of them.
struct Wide<'a> {
    program: &'a Program<f64>,
    planes: SmallVec<[&'a [f64]; 16]>,
    outs: SmallVec<[&'a mut [f64]; 3]>,
    count: usize,
}

impl WithSimd for Wide<'_> {
    type Output = Option<u16>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Option<u16> {
        let Self { program, planes, outs, count } = self;
        let (packs, lanes) = (Packed(simd), S::F64_LANES);
        let mut rows = Rows { planes, outs };
        let mut failed = None;
        // Both registers and an operand, or two, in those of the processor.
        let most = if S::REGISTER_COUNT >= 32 { 8 } else { 4 };
        let whole = count - count % (most * lanes);
        match most {
            8 => go::<_, 8>(packs, program, &mut rows, [0, whole], &mut failed),
            _ => go::<_, 4>(packs, program, &mut rows, [0, whole], &mut failed),
        }
        // The rest as one chunk that ends with the last element: what it has in common with the one
        // before comes out the same again.
        let rest = count - whole;
        let mut width = rest.div_ceil(lanes).next_power_of_two();
        if count < width * lanes {
            // Two of half the size, one from the first element on.
            width /= 2;
        }
        let ends = match rest {
            0 => [None, None],
            _ if whole > 0 || width * lanes >= rest => [None, Some(count)],
            _ => [Some(width * lanes), Some(count)],
        };
        for end in ends.into_iter().flatten() {
            let range = [end.wrapping_sub(width * lanes), end];
            match width {
                8 => go::<_, 8>(packs, program, &mut rows, range, &mut failed),
                4 => go::<_, 4>(packs, program, &mut rows, range, &mut failed),
                2 => go::<_, 2>(packs, program, &mut rows, range, &mut failed),
                1 => go::<_, 1>(packs, program, &mut rows, range, &mut failed),
                _ => {
                    let one = Single(PhantomData);
                    go::<Single<f64>, 1>(one, program, &mut rows, [0, count], &mut failed);
                }
            }
        }
        failed
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

/// A register's worth of plain numbers.
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

/// A chunk on its own, at a place where no pack lies across the border of two cache lines: reading back
/// what was just written is slow there.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Slot<P, const W: usize>([P; W]);

/// The memory of a run: chunks are `W` packs.
struct Machine<'a, 'r, P: Packs, const W: usize> {
    planes: &'a [&'r [P::Pack]],
    outs: &'a mut [&'r mut [P::Pack]],
    slots: &'a mut [Slot<P::Pack, W>],
    consts: &'a [P::Pack],
}

impl<P: Packs, const W: usize> Machine<'_, '_, P, W> {
    /// A row's packs of the chunk that begins with pack `at`.
    #[inline(always)]
    fn row(&self, row: Row, at: usize) -> &[P::Pack; W] {
        let all: &[P::Pack] = match row {
            Row::Plane(k) => self.planes[k as usize],
            Row::Out(k) => &*self.outs[k as usize],
            Row::Slot(k) => return &self.slots[k as usize].0,
        };
        all[at..].first_chunk().expect("chunks lie inside")
    }

    #[inline(always)]
    fn row_mut(&mut self, row: Row, at: usize) -> &mut [P::Pack; W] {
        let all: &mut [P::Pack] = match row {
            Row::Out(k) => &mut *self.outs[k as usize],
            Row::Slot(k) => return &mut self.slots[k as usize].0,
            Row::Plane(_) => unreachable!("sources are not written to"),
        };
        all[at..].first_chunk_mut().expect("chunks lie inside")
    }
}

/// All chunks of the elements in `range`, which are whole ones.
#[inline(always)]
fn go<P: Packs, const W: usize>(
    packs: P,
    program: &Program<P::Number>,
    rows: &mut Rows<'_, P::Number>,
    [from, to]: [usize; 2],
    failed: &mut Option<u16>,
) {
    if from == to {
        return;
    }
    let zero = packs.of(<P::Number as From<f64>>::from(0.0));
    let planes: SmallVec<[&[P::Pack]; 16]> =
        rows.planes.iter().map(|row| P::packs(row.get(from..to).unwrap_or(&[]))).collect();
    let mut outs: SmallVec<[&mut [P::Pack]; 3]> =
        rows.outs.iter_mut().map(|row| P::packs_mut(&mut row[from..to])).collect();
    let mut slots: SmallVec<[Slot<P::Pack, W>; 8]> =
        SmallVec::from_elem(Slot([zero; W]), program.slots);
    let mut consts: SmallVec<[P::Pack; 16]> = SmallVec::new();
    for x in &program.consts {
        consts.push(packs.of(*x));
    }
    // Slices, since asking a small vector each time where its elements are takes longer than an order.
    let mut machine =
        Machine::<P, W> { planes: &planes, outs: &mut outs, slots: &mut slots, consts: &consts };
    for at in (0..(to - from) / P::LANES).step_by(W) {
        chunk(packs, program, &mut machine, at, failed);
    }
}

/// Carries the orders out for one chunk. Loops are written out instead of closures, which need not be
/// inlined and would be compiled for narrow registers then.
#[inline(always)]
fn chunk<P: Packs, const W: usize>(
    p: P,
    program: &Program<P::Number>,
    m: &mut Machine<'_, '_, P, W>,
    at: usize,
    failed: &mut Option<u16>,
) {
    let zero = [p.of(<P::Number as From<f64>>::from(0.0)); W];
    let (mut a, mut b) = (zero, zero);
    // r[k] = x op y for all k, where x and y are expressions of k.
    macro_rules! each {
        ($r:ident[$k:ident] = $value:expr) => {
            for $k in 0..W {
                $r[$k] = $value;
            }
        };
    }
    macro_rules! operate {
        ($op:expr, $r:ident[$k:ident], $x:expr, $y:expr) => {
            match $op {
                Op::Add => each!($r[$k] = p.add($x, $y)),
                Op::Sub => each!($r[$k] = p.sub($x, $y)),
                Op::Mul => each!($r[$k] = p.mul($x, $y)),
                Op::Div => each!($r[$k] = p.div($x, $y)),
            }
        };
    }
    // An order that names a register, for each of the two.
    macro_rules! either {
        ($reg:expr, |$r:ident| $work:expr) => {
            match $reg {
                Reg::A => {
                    let $r = &mut a;
                    $work
                }
                Reg::B => {
                    let $r = &mut b;
                    $work
                }
            }
        };
    }
    // An expression of an operand's packs, for rows and for constants.
    macro_rules! with {
        ($operand:expr, |$x:ident[$k:ident]| $work:expr) => {
            match $operand {
                Operand::Row(row) => {
                    let $x = m.row(row, at);
                    $work
                }
                Operand::Const(c) => {
                    let $x = [m.consts[c as usize]; W];
                    $work
                }
            }
        };
    }
    macro_rules! signed {
        ($sign:expr, $k:ident, $product:expr) => {
            match $sign {
                Sign::Plus => each!(a[$k] = p.add(a[$k], $product)),
                Sign::Minus => each!(a[$k] = p.sub(a[$k], $product)),
            }
        };
    }
    for order in &program.orders {
        match *order {
            Order::Load(reg, x) => {
                either!(reg, |r| with!(x, |x[k]| each!(r[k] = x[k])));
            }
            Order::Rows(reg, op, x, y) => {
                let (x, y) = (m.row(x, at), m.row(y, at));
                either!(reg, |r| operate!(op, r[k], x[k], y[k]));
            }
            Order::RowConst(reg, op, x, c) => {
                let (x, c) = (m.row(x, at), m.consts[c as usize]);
                either!(reg, |r| operate!(op, r[k], x[k], c));
            }
            Order::ConstRow(reg, op, c, x) => {
                let (x, c) = (m.row(x, at), m.consts[c as usize]);
                either!(reg, |r| operate!(op, r[k], c, x[k]));
            }
            Order::By(reg, op, x) => {
                either!(reg, |r| with!(x, |x[k]| operate!(op, r[k], r[k], x[k])));
            }
            Order::From(reg, op, x) => {
                either!(reg, |r| with!(x, |x[k]| operate!(op, r[k], x[k], r[k])));
            }
            Order::Join(op) => operate!(op, a[k], a[k], b[k]),
            Order::JoinFrom(op) => operate!(op, a[k], b[k], a[k]),
            Order::Product(sign, x, y) => {
                let (x, y) = (m.row(x, at), m.row(y, at));
                signed!(sign, k, p.mul(x[k], y[k]));
            }
            Order::ProductConst(sign, x, c) => {
                let (x, c) = (m.row(x, at), m.consts[c as usize]);
                signed!(sign, k, p.mul(x[k], c));
            }
            Order::Times(sign, x) => with!(x, |x[k]| signed!(sign, k, p.mul(b[k], x[k]))),
            Order::Neg(reg) => either!(reg, |r| each!(r[k] = p.neg(r[k]))),
            Order::Abs(reg) => either!(reg, |r| each!(r[k] = p.abs(r[k]))),
            Order::Sqrt(reg) => either!(reg, |r| each!(r[k] = p.sqrt(r[k]))),
            Order::Store(to) => *m.row_mut(to, at) = a,
            Order::Unary(f, to, check) => {
                let f = program.unary[f as usize];
                let numbers = P::numbers_mut(m.row_mut(to, at));
                for x in &mut *numbers {
                    *x = f(*x);
                }
                tested(numbers, check, failed);
            }
            Order::Binary(f, to, y, check) => {
                let f = program.binary[f as usize];
                let mut y = match y {
                    Operand::Row(row) => *m.row(row, at),
                    Operand::Const(c) => [m.consts[c as usize]; W],
                };
                let y = P::numbers_mut(&mut y);
                let numbers = P::numbers_mut(m.row_mut(to, at));
                for (x, y) in numbers.iter_mut().zip(y) {
                    *x = f(*x, *y);
                }
                tested(numbers, check, failed);
            }
        }
    }
}

/// Notes the check when it is the first that fails.
#[inline(always)]
fn tested<T: Real>(numbers: &[T], check: Option<u16>, failed: &mut Option<u16>) {
    if let Some(check) = check
        && failed.is_none_or(|first| check < first)
        && !numbers.iter().all(|x| x.is_finite())
    {
        *failed = Some(check);
    }
}
