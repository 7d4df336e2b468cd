//! Compiled primitives and sets.
//!
//! `Primitive, Set -> flat list of instructions -> value, gradient, range, bulk values`
//!
//! Equal parts become one instruction (value numbering), so sharing is free and equality of
//! expressions is equality of tapes. [`ExprTape::pruned`] keeps the part of a set that decides over
//! a box.

use crate::expr::algebra::{Algebra, GradientRange, Unary};
use crate::expr::interval::Interval;
use crate::expr::oracle::{Affine, Oracle};
use crate::expr::primitive::{Binary, Op, Primitive, PrimitiveNode};
use moldloft_num::{Box3, Real, Vec3};
use smallvec::{SmallVec, smallvec};
use std::collections::HashMap;
use std::sync::Arc;

/// For an instruction that is the value of a leaf of a set, the number of the leaf; `NO_LEAF` for
/// inner ones.
pub(crate) const NO_LEAF: u32 = u32::MAX;

/// One instruction; operands are positions of earlier ones.
#[derive(Clone, Copy)]
pub(crate) enum ExprInstruction<T> {
    Real(T),
    Plane(Vec3<T>, T),
    User(u32),
    Unary(Unary, u32),
    PlusReal(u32, T),
    TimesReal(u32, T),
    OverReal(u32, T),
    Power(u32, u32),
    Add(u32, u32),
    Sub(u32, u32),
    Mul(u32, u32),
    Min(u32, u32),
    Max(u32, u32),
    Atan2(u32, u32),
    Div(u32, u32),
    Mod(u32, u32),
    /// A minimum whose sign and, near zero, value matter only: a union of sets.
    Union(u32, u32),
    /// Likewise a maximum: an intersection of sets.
    Common(u32, u32),
}

/// A compiled expression; its value is that of the last instruction.
pub(crate) struct ExprTape<T: Real> {
    pub(crate) code: Vec<ExprInstruction<T>>,
    /// The leaf of each instruction, or [`NO_LEAF`].
    pub(crate) leaf: Vec<u32>,
    /// Register of each instruction, for [`ExprTape::bulk`].
    register: Vec<u32>,
    registers: usize,
    users: Arc<Vec<(Arc<dyn Oracle<T>>, Affine<T>)>>,
}

/// The nodes of an expression, operands before their users, each once.
pub(crate) fn order<T: Real>(root: &Primitive<T>) -> Vec<Primitive<T>> {
    let mut done: HashMap<*const PrimitiveNode<T>, ()> = HashMap::new();
    let mut out = Vec::new();
    let mut stack = vec![(root, false)];
    while let Some((p, ready)) = stack.pop() {
        let key = Arc::as_ptr(&p.0);
        if ready {
            if done.insert(key, ()).is_none() {
                out.push(p.clone());
            }
        } else if !done.contains_key(&key) {
            stack.push((p, true));
            stack.extend(p.0.op.children().into_iter().rev().flatten().map(|c| (c, false)));
        }
    }
    out
}

type NumberKey = (u8, u32, u32, [u64; 4]);

/// Builds a tape; equal instructions are one.
pub(crate) struct Builder<T: Real> {
    code: Vec<ExprInstruction<T>>,
    leaf: Vec<u32>,
    known: HashMap<NumberKey, u32>,
    nodes: HashMap<*const PrimitiveNode<T>, u32>,
    users: Vec<(Arc<dyn Oracle<T>>, Affine<T>)>,
}

impl<T: Real> Builder<T> {
    pub(crate) fn new() -> Self {
        Self {
            code: Vec::new(),
            leaf: Vec::new(),
            known: HashMap::new(),
            nodes: HashMap::new(),
            users: Vec::new(),
        }
    }

    pub(crate) fn push(&mut self, code: ExprInstruction<T>) -> u32 {
        if let Some(key) = key(&code) {
            if let Some(&at) = self.known.get(&key) {
                return at;
            }
            self.known.insert(key, self.code.len() as u32);
        }
        self.code.push(code);
        self.leaf.push(NO_LEAF);
        self.code.len() as u32 - 1
    }

    /// The position of the primitive's value.
    pub(crate) fn primitive(&mut self, root: &Primitive<T>) -> u32 {
        for node in order(root) {
            let pointer = Arc::as_ptr(&node.0);
            if self.nodes.contains_key(&pointer) {
                continue;
            }
            let of = |p: &Primitive<T>, nodes: &HashMap<*const PrimitiveNode<T>, u32>| {
                nodes[&Arc::as_ptr(&p.0)]
            };
            let constant = |p: &Primitive<T>| match p.0.op {
                Op::Real(c) => Some(c),
                _ => None,
            };
            let nodes = &self.nodes;
            let code = match &node.0.op {
                Op::Real(c) => ExprInstruction::Real(*c),
                Op::Plane { normal, offset } => ExprInstruction::Plane(*normal, *offset),
                Op::User { oracle, map } => {
                    self.users.push((oracle.clone(), **map));
                    ExprInstruction::User(self.users.len() as u32 - 1)
                }
                Op::Unary(f, a) => ExprInstruction::Unary(*f, of(a, nodes)),
                Op::Over(a, c) => ExprInstruction::OverReal(of(a, nodes), *c),
                Op::Power(a, n) => ExprInstruction::Power(of(a, nodes), *n),
                Op::Binary(f, a, b) => {
                    let (i, j) = (of(a, nodes), of(b, nodes));
                    match (f, constant(a), constant(b)) {
                        (Binary::Add, _, Some(c)) => ExprInstruction::PlusReal(i, c),
                        (Binary::Add, Some(c), _) => ExprInstruction::PlusReal(j, c),
                        (Binary::Sub, _, Some(c)) => ExprInstruction::PlusReal(i, -c),
                        (Binary::Mul, _, Some(c)) => ExprInstruction::TimesReal(i, c),
                        (Binary::Mul, Some(c), _) => ExprInstruction::TimesReal(j, c),
                        (Binary::Add, ..) => ExprInstruction::Add(i, j),
                        (Binary::Sub, ..) => ExprInstruction::Sub(i, j),
                        (Binary::Mul, ..) => ExprInstruction::Mul(i, j),
                        (Binary::Min, ..) => ExprInstruction::Min(i, j),
                        (Binary::Max, ..) => ExprInstruction::Max(i, j),
                        (Binary::Atan2, ..) => ExprInstruction::Atan2(i, j),
                        (Binary::Div, ..) => ExprInstruction::Div(i, j),
                        (Binary::Mod, ..) => ExprInstruction::Mod(i, j),
                    }
                }
            };
            let at = self.push(code);
            self.nodes.insert(pointer, at);
        }
        self.nodes[&Arc::as_ptr(&root.0)]
    }

    /// Says that instruction `at` is the value of `leaf`, unless it is another leaf's already.
    pub(crate) fn mark(&mut self, at: u32, leaf: u32) {
        let slot = &mut self.leaf[at as usize];
        *slot = (*slot).min(leaf);
    }

    pub(crate) fn leaf_of(&self, at: u32) -> u32 {
        self.leaf[at as usize]
    }

    pub(crate) fn build(self, root: u32) -> ExprTape<T> {
        let all = ExprTape::with(self.code, self.leaf, self.users.into());
        all.reduced(root, |_, _, _| None)
    }
}

/// The identity of an instruction; `None` when its numbers carry derivatives.
fn key<T: Real>(code: &ExprInstruction<T>) -> Option<NumberKey> {
    let bits = |c: T| c.is_constant().then(|| c.re().to_bits());
    Some(match *code {
        ExprInstruction::Real(c) => (0, 0, 0, [bits(c)?, 0, 0, 0]),
        ExprInstruction::Plane(n, d) => (1, 0, 0, [bits(n.x)?, bits(n.y)?, bits(n.z)?, bits(d)?]),
        ExprInstruction::User(_) => return None,
        ExprInstruction::Unary(f, a) => (2, a, f as u32, [0; 4]),
        ExprInstruction::PlusReal(a, c) => (3, a, 0, [bits(c)?, 0, 0, 0]),
        ExprInstruction::TimesReal(a, c) => (4, a, 0, [bits(c)?, 0, 0, 0]),
        ExprInstruction::OverReal(a, c) => (5, a, 0, [bits(c)?, 0, 0, 0]),
        ExprInstruction::Power(a, n) => (6, a, n, [0; 4]),
        ExprInstruction::Add(a, b) => (7, a, b, [0; 4]),
        ExprInstruction::Sub(a, b) => (8, a, b, [0; 4]),
        ExprInstruction::Mul(a, b) => (9, a, b, [0; 4]),
        ExprInstruction::Min(a, b) => (10, a, b, [0; 4]),
        ExprInstruction::Max(a, b) => (11, a, b, [0; 4]),
        ExprInstruction::Atan2(a, b) => (12, a, b, [0; 4]),
        ExprInstruction::Union(a, b) => (13, a, b, [0; 4]),
        ExprInstruction::Common(a, b) => (14, a, b, [0; 4]),
        ExprInstruction::Div(a, b) => (15, a, b, [0; 4]),
        ExprInstruction::Mod(a, b) => (16, a, b, [0; 4]),
    })
}

impl<T> ExprInstruction<T> {
    pub(crate) fn operands(&self) -> [Option<u32>; 2] {
        match *self {
            ExprInstruction::Real(_) | ExprInstruction::Plane(..) | ExprInstruction::User(_) => {
                [None, None]
            }
            ExprInstruction::Unary(_, a)
            | ExprInstruction::PlusReal(a, _)
            | ExprInstruction::TimesReal(a, _)
            | ExprInstruction::OverReal(a, _)
            | ExprInstruction::Power(a, _) => [Some(a), None],
            ExprInstruction::Add(a, b)
            | ExprInstruction::Sub(a, b)
            | ExprInstruction::Mul(a, b)
            | ExprInstruction::Min(a, b)
            | ExprInstruction::Max(a, b)
            | ExprInstruction::Union(a, b)
            | ExprInstruction::Common(a, b)
            | ExprInstruction::Div(a, b)
            | ExprInstruction::Mod(a, b)
            | ExprInstruction::Atan2(a, b) => [Some(a), Some(b)],
        }
    }

    /// The operands of a minimum or maximum.
    fn choice(&self) -> Option<(u32, u32)> {
        match *self {
            ExprInstruction::Min(a, b)
            | ExprInstruction::Max(a, b)
            | ExprInstruction::Union(a, b)
            | ExprInstruction::Common(a, b) => Some((a, b)),
            _ => None,
        }
    }

    pub(crate) fn renumbered(mut self, of: impl Fn(u32) -> u32) -> Self {
        match &mut self {
            ExprInstruction::Real(_) | ExprInstruction::Plane(..) | ExprInstruction::User(_) => {}
            ExprInstruction::Unary(_, a)
            | ExprInstruction::PlusReal(a, _)
            | ExprInstruction::TimesReal(a, _)
            | ExprInstruction::OverReal(a, _)
            | ExprInstruction::Power(a, _) => *a = of(*a),
            ExprInstruction::Add(a, b)
            | ExprInstruction::Sub(a, b)
            | ExprInstruction::Mul(a, b)
            | ExprInstruction::Min(a, b)
            | ExprInstruction::Max(a, b)
            | ExprInstruction::Union(a, b)
            | ExprInstruction::Common(a, b)
            | ExprInstruction::Div(a, b)
            | ExprInstruction::Mod(a, b)
            | ExprInstruction::Atan2(a, b) => {
                *a = of(*a);
                *b = of(*b);
            }
        }
        self
    }
}

/// Points are taken in chunks of this many.
pub(crate) const CHUNK: usize = 64;

type Chunk = [f64; CHUNK];

/// Reusable memory of [`ExprTape::bulk`].
#[derive(Default)]
pub(crate) struct Room {
    #[expect(clippy::vec_box, reason = "chunks are exchanged by pointer")]
    registers: Vec<Box<Chunk>>,
    spare: Option<Box<Chunk>>,
}

/// Reusable memory of the interval evaluators.
#[derive(Default)]
pub(crate) struct RangeRoom {
    pub(crate) ranges: Vec<Interval>,
    gradients: Vec<GradientRange>,
}

impl<T: Real> ExprTape<T> {
    pub(crate) fn of_primitive(p: &Primitive<T>) -> Self {
        let mut builder = Builder::new();
        let root = builder.primitive(p);
        builder.build(root)
    }

    fn with(
        code: Vec<ExprInstruction<T>>,
        leaf: Vec<u32>,
        users: Arc<Vec<(Arc<dyn Oracle<T>>, Affine<T>)>>,
    ) -> Self {
        // Linear scan: a register is free again after the last use of its value.
        let mut last = vec![0; code.len()];
        for (k, c) in code.iter().enumerate() {
            for a in c.operands().into_iter().flatten() {
                last[a as usize] = k;
            }
        }
        let (mut free, mut registers) = (Vec::new(), 0u32);
        let mut register = vec![0; code.len()];
        for (k, c) in code.iter().enumerate() {
            register[k] = free.pop().unwrap_or_else(|| {
                registers += 1;
                registers - 1
            });
            let [a, b] = c.operands();
            for x in [a, b.filter(|b| a != Some(*b))].into_iter().flatten() {
                if last[x as usize] == k {
                    free.push(register[x as usize]);
                }
            }
        }
        Self { code, leaf, register, registers: registers as usize, users }
    }

    /// A tape of other instructions; the last is its value.
    pub(crate) fn with_code(&self, code: Vec<ExprInstruction<T>>, leaf: Vec<u32>) -> Self {
        Self::with(code, leaf, self.users.clone())
    }

    /// The tape reduced to `root`; `decide(position, a, b)` may name the operand that a minimum or
    /// maximum equals.
    fn reduced(&self, root: u32, decide: impl Fn(usize, u32, u32) -> Option<u32>) -> Self {
        let n = self.code.len();
        let mut alias: Vec<u32> = (0..n as u32).collect();
        for (k, c) in self.code.iter().enumerate() {
            if let Some((a, b)) = c.choice()
                && let Some(winner) = decide(k, a, b)
            {
                alias[k] = alias[winner as usize];
            }
        }
        let root = alias[root as usize];
        let mut needed = vec![false; n];
        needed[root as usize] = true;
        for k in (0..=root as usize).rev() {
            if needed[k] {
                for a in self.code[k].operands().into_iter().flatten() {
                    needed[alias[a as usize] as usize] = true;
                }
            }
        }
        let mut number = vec![0; n];
        let (mut code, mut leaf) = (Vec::new(), Vec::new());
        for k in 0..=root as usize {
            if needed[k] {
                number[k] = code.len() as u32;
                code.push(self.code[k].renumbered(|a| number[alias[a as usize] as usize]));
                leaf.push(self.leaf[k]);
            }
        }
        Self::with(code, leaf, self.users.clone())
    }

    /// True when both are the same instructions on the same numbers.
    pub(crate) fn same(&self, o: &Self) -> bool {
        self.code.len() == o.code.len()
            && self.code.iter().zip(&o.code).all(|(a, b)| match (a, b) {
                (ExprInstruction::User(i), ExprInstruction::User(j)) => {
                    let ((f, m), (g, n)) = (&self.users[*i as usize], &o.users[*j as usize]);
                    Arc::ptr_eq(f, g) && m == n
                }
                _ => key(a).is_some() && key(a) == key(b),
            })
    }

    /// True if an external primitive may have an edge of its own in a box.
    pub fn creased_in(&self, over: &Box3) -> bool {
        self.users.iter().any(|(oracle, map)| {
            let corners = (0..8).map(|k| {
                let pick = |a: usize| if k >> a & 1 == 0 { over.low[a] } else { over.high[a] };
                map.apply(Vec3::lifted(Vec3::of(pick(0), pick(1), pick(2)))).re()
            });
            oracle.creased_in(&Box3::around(corners))
        })
    }

    #[inline(always)]
    fn step<A: Algebra<T>>(
        &self,
        code: &ExprInstruction<T>,
        at: &A::At,
        of: impl Fn(u32) -> A,
    ) -> A {
        match *code {
            ExprInstruction::Real(c) => A::real(c),
            ExprInstruction::Plane(n, d) => A::plane(n, d, at),
            ExprInstruction::User(k) => {
                let (oracle, map) = &self.users[k as usize];
                A::user(&**oracle, map, at)
            }
            ExprInstruction::Unary(f, a) => of(a).unary(f),
            ExprInstruction::PlusReal(a, c) => of(a).plus_real(c),
            ExprInstruction::TimesReal(a, c) => of(a).times_real(c),
            ExprInstruction::OverReal(a, c) => of(a).over_real(c),
            ExprInstruction::Power(a, n) => of(a).power(n),
            ExprInstruction::Add(a, b) => of(a).sum(of(b)),
            ExprInstruction::Sub(a, b) => of(a).difference(of(b)),
            ExprInstruction::Mul(a, b) => of(a).times(of(b)),
            ExprInstruction::Min(a, b) | ExprInstruction::Union(a, b) => of(a).smaller(of(b)),
            ExprInstruction::Max(a, b) | ExprInstruction::Common(a, b) => of(a).larger(of(b)),
            ExprInstruction::Atan2(a, b) => of(a).angle(of(b)),
            ExprInstruction::Div(a, b) => of(a).quotient(of(b)),
            ExprInstruction::Mod(a, b) => of(a).remainder(of(b)),
        }
    }

    /// The value of the whole; `values` holds that of every instruction afterwards.
    #[inline]
    pub(crate) fn eval<A: Algebra<T>>(&self, at: &A::At, values: &mut Vec<A>) -> A {
        values.clear();
        for code in &self.code {
            let value = self.step::<A>(code, at, |a| values[a as usize]);
            values.push(value);
        }
        values[self.code.len() - 1]
    }

    /// True if it calls external primitives, which are faster in batches.
    pub(crate) fn has_users(&self) -> bool {
        self.code.iter().any(|c| matches!(c, ExprInstruction::User(_)))
    }

    /// As [`ExprTape::eval`] at many points, instruction by instruction: a column of values for
    /// each.
    pub(crate) fn eval_many<A: Algebra<T>>(&self, at: &[A::At]) -> Vec<Vec<A>> {
        let mut columns: Vec<Vec<A>> = Vec::with_capacity(self.code.len());
        for code in &self.code {
            let mut column = Vec::with_capacity(at.len());
            match code {
                ExprInstruction::User(k) => {
                    let (oracle, map) = &self.users[*k as usize];
                    A::users(&**oracle, map, at, &mut column);
                }
                _ => {
                    let each = at.iter().enumerate();
                    let step = |(i, at)| self.step::<A>(code, at, |a| columns[a as usize][i]);
                    column.extend(each.map(step));
                }
            }
            columns.push(column);
        }
        columns
    }

    /// The instruction of the leaf that decides, given the value of every instruction; the first
    /// operand on a tie. The leaves' own minima and maxima are not entered.
    pub(crate) fn winner<A: Copy>(&self, values: &[A], re: impl Fn(A) -> f64) -> usize {
        self.winner_by(|a| re(values[a as usize]))
    }

    fn winner_by(&self, of: impl Fn(u32) -> f64) -> usize {
        let mut k = self.code.len() - 1;
        while self.leaf[k] == NO_LEAF {
            k = match self.code[k] {
                ExprInstruction::Union(a, b) => (if of(b) < of(a) { b } else { a }) as usize,
                ExprInstruction::Common(a, b) => (if of(b) > of(a) { b } else { a }) as usize,
                _ => break,
            };
        }
        k
    }
}

/// State of [`ExprTape::bulk`]. A struct instead of closures, since code in closures that are not
/// inlined does not use the wide registers.
struct Bulk<'a> {
    tape: &'a ExprTape<f64>,
    points: &'a [Vec3],
    out: &'a mut [f64],
    room: &'a mut Room,
}

impl pulp::NullaryFnOnce for Bulk<'_> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        self.tape.bulk_loops(self.points, self.out, self.room);
    }
}

impl ExprTape<f64> {
    /// The leaves that decide at some points.
    pub(crate) fn winners(&self, points: &[Vec3], values: &mut Vec<f64>) -> Vec<u32> {
        if self.has_users() {
            let columns = self.eval_many::<f64>(points);
            let at = |i: usize| self.leaf[self.winner_by(|a| columns[a as usize][i])];
            return (0..points.len()).map(at).collect();
        }
        let mut at = |p: &Vec3| {
            self.eval::<f64>(p, values);
            self.leaf[self.winner(values, |v| v)]
        };
        points.iter().map(&mut at).collect()
    }

    /// The range over a box by plain interval arithmetic; `ranges` holds that of every instruction.
    pub(crate) fn range(&self, at: &[Interval; 3], ranges: &mut Vec<Interval>) -> Interval {
        self.eval::<Interval>(at, ranges)
    }

    /// Ranges of value and gradient, the value tightened by f(c) + f'(box) (box - c).
    pub(crate) fn mean_value(&self, at: &[Interval; 3], room: &mut RangeRoom) -> GradientRange {
        let mut range = self.eval::<GradientRange>(at, &mut room.gradients);
        let centre = at.map(|side| Interval::point(side.middle()));
        let mut value = self.range(&centre, &mut room.ranges);
        for k in 0..3 {
            value = value + range.slope[k] * (at[k] - centre[k]);
        }
        range.value = range.value.meet(value);
        range
    }

    /// The tape of the same surface over a box, given the range of every instruction there: operands
    /// that never decide are left out, and of sets those that are all air in a union or all solid in
    /// an intersection, so that the sign is the same everywhere and the value where it is zero. `None`
    /// when nothing can be left out.
    pub(crate) fn pruned(&self, ranges: &[Interval]) -> Option<Self> {
        let decide = |k: usize, a: u32, b: u32| self.decided(k, a, b, ranges);
        let mut choices = self.code.iter().enumerate().filter_map(|(k, c)| Some((k, c.choice()?)));
        let decided = choices.any(|(k, (a, b))| decide(k, a, b).is_some());
        decided.then(|| self.reduced(self.code.len() as u32 - 1, decide))
    }

    /// The operand that alone decides an instruction, given the ranges.
    fn decided(&self, k: usize, a: u32, b: u32, ranges: &[Interval]) -> Option<u32> {
        let (x, y) = (ranges[a as usize], ranges[b as usize]);
        let (a_smaller, b_smaller) = (x.high < y.low, y.high < x.low);
        match self.code[k] {
            ExprInstruction::Min(..) | ExprInstruction::Union(..) if a_smaller => Some(a),
            ExprInstruction::Min(..) | ExprInstruction::Union(..) if b_smaller => Some(b),
            ExprInstruction::Max(..) | ExprInstruction::Common(..) if a_smaller => Some(b),
            ExprInstruction::Max(..) | ExprInstruction::Common(..) if b_smaller => Some(a),
            ExprInstruction::Union(..) if y.low > 0.0 => Some(a),
            ExprInstruction::Union(..) if x.low > 0.0 => Some(b),
            ExprInstruction::Common(..) if y.high < 0.0 => Some(a),
            ExprInstruction::Common(..) if x.high < 0.0 => Some(b),
            _ => None,
        }
    }

    /// True when a leaf that is not `known` may be on the surface over a box, given the range of every instruction there.
    pub(crate) fn may_show_other(&self, ranges: &[Interval], known: impl Fn(u32) -> bool) -> bool {
        let count = self.code.len();
        let mut open: SmallVec<[bool; 64]> = smallvec![false; count];
        open[count - 1] = true;
        // Operands precede their uses.
        for k in (0..count).rev() {
            if !open[k] || !ranges[k].contains(0.0) {
                continue;
            }
            if self.leaf[k] != NO_LEAF {
                if !known(self.leaf[k]) {
                    return true;
                }
                continue;
            }
            match self.code[k].choice().and_then(|(a, b)| self.decided(k, a, b, ranges)) {
                Some(one) => open[one as usize] = true,
                None => {
                    let operands = self.code[k].operands();
                    operands.into_iter().flatten().for_each(|o| open[o as usize] = true);
                }
            }
        }
        false
    }

    /// The values at many points: bit for bit those of [`ExprTape::eval`], in the widest registers at hand.
    pub(crate) fn bulk(&self, points: &[Vec3], out: &mut [f64], room: &mut Room) {
        assert_eq!(points.len(), out.len(), "one value per point");
        pulp::Arch::new().dispatch(Bulk { tape: self, points, out, room });
    }

    #[inline(always)]
    fn bulk_loops(&self, points: &[Vec3], out: &mut [f64], room: &mut Room) {
        while room.registers.len() < self.registers {
            room.registers.push(Box::new([0.0; CHUNK]));
        }
        let mut spare = room.spare.take().unwrap_or_else(|| Box::new([0.0; CHUNK]));
        let (mut x, mut y, mut z) = ([0.0; CHUNK], [0.0; CHUNK], [0.0; CHUNK]);
        let root = self.register[self.code.len() - 1] as usize;
        for (points, out) in points.chunks(CHUNK).zip(out.chunks_mut(CHUNK)) {
            for (k, p) in points.iter().enumerate() {
                (x[k], y[k], z[k]) = (p.x, p.y, p.z);
            }
            for (code, &register) in self.code.iter().zip(&self.register) {
                self.bulk_step(code, [&x, &y, &z], points.len(), &room.registers, &mut spare);
                std::mem::swap(&mut spare, &mut room.registers[register as usize]);
            }
            out.copy_from_slice(&room.registers[root][..out.len()]);
        }
        room.spare = Some(spare);
    }

    #[inline(always)]
    fn bulk_step(
        &self,
        code: &ExprInstruction<f64>,
        xyz: [&Chunk; 3],
        count: usize,
        registers: &[Box<Chunk>],
        out: &mut Chunk,
    ) {
        let of = |a: u32| -> &Chunk { &registers[self.register[a as usize] as usize] };
        #[inline(always)]
        fn one(out: &mut Chunk, a: &Chunk, f: impl Fn(f64) -> f64) {
            for (o, a) in out.iter_mut().zip(a) {
                *o = f(*a);
            }
        }
        #[inline(always)]
        fn two(out: &mut Chunk, a: &Chunk, b: &Chunk, f: impl Fn(f64, f64) -> f64) {
            for ((o, a), b) in out.iter_mut().zip(a).zip(b) {
                *o = f(*a, *b);
            }
        }
        match *code {
            ExprInstruction::Real(c) => out.fill(c),
            ExprInstruction::Plane(n, d) => {
                let [x, y, z] = xyz;
                let weights = [n.x, n.y, n.z].map(|w| w != 0.0);
                // Terms of weight zero add nothing, not even rounding.
                match weights {
                    [true, false, false] => one(out, x, |x| n.x * x + d),
                    [false, true, false] => one(out, y, |y| n.y * y + d),
                    [false, false, true] => one(out, z, |z| n.z * z + d),
                    [true, true, false] => two(out, x, y, |x, y| n.x * x + n.y * y + d),
                    [true, false, true] => two(out, x, z, |x, z| n.x * x + n.z * z + d),
                    [false, true, true] => two(out, y, z, |y, z| n.y * y + n.z * z + d),
                    _ => {
                        for k in 0..CHUNK {
                            out[k] = n.x * x[k] + n.y * y[k] + n.z * z[k] + d;
                        }
                    }
                }
            }
            ExprInstruction::User(k) => {
                let (oracle, map) = &self.users[k as usize];
                let mut points = [Vec3::zero(); CHUNK];
                for (k, p) in points[..count].iter_mut().enumerate() {
                    *p = map.apply(Vec3::new(xyz[0][k], xyz[1][k], xyz[2][k]));
                }
                oracle.values(&points[..count], &mut out[..count]);
            }
            ExprInstruction::Unary(f, a) => match f {
                Unary::Neg => one(out, of(a), |a| -a),
                Unary::Abs => one(out, of(a), f64::abs),
                Unary::Sign => one(out, of(a), |a| if a > 0.0 { 1.0 } else { -1.0 }),
                Unary::Sqrt => one(out, of(a), |a| if a > 0.0 { a.sqrt() } else { 0.0 }),
                // The lanes beyond the points hold old numbers: skip their cost.
                _ => {
                    for (o, a) in out[..count].iter_mut().zip(of(a)) {
                        *o = f.of(*a);
                    }
                }
            },
            ExprInstruction::PlusReal(a, c) => one(out, of(a), |a| a + c),
            ExprInstruction::TimesReal(a, c) => one(out, of(a), |a| a * c),
            ExprInstruction::OverReal(a, c) => one(out, of(a), |a| a / c),
            ExprInstruction::Power(a, 2) => one(out, of(a), |a| a * a),
            ExprInstruction::Power(a, n) => one(out, of(a), |a| crate::expr::algebra::power(a, n)),
            ExprInstruction::Add(a, b) => two(out, of(a), of(b), |a, b| a + b),
            ExprInstruction::Sub(a, b) => two(out, of(a), of(b), |a, b| a - b),
            ExprInstruction::Mul(a, b) => two(out, of(a), of(b), |a, b| a * b),
            ExprInstruction::Min(a, b) | ExprInstruction::Union(a, b) => {
                two(out, of(a), of(b), |a, b| if b < a { b } else { a })
            }
            ExprInstruction::Max(a, b) | ExprInstruction::Common(a, b) => {
                two(out, of(a), of(b), |a, b| if b > a { b } else { a })
            }
            ExprInstruction::Div(a, b) => two(out, of(a), of(b), |a, b| a / b),
            ExprInstruction::Mod(a, b) => two(out, of(a), of(b), crate::expr::algebra::remainder),
            ExprInstruction::Atan2(a, b) => {
                for ((o, a), b) in out[..count].iter_mut().zip(of(a)).zip(of(b)) {
                    *o = libm::atan2(*a, *b);
                }
            }
        }
    }
}
