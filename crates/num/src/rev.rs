//! Numbers of reverse differentiation: each knows its node on a tape, which holds what it was made of.
//!
//! `f64 in -> Rev ... Rev -> DerivativeTape (rows of a sparse, lower triangular matrix) -> Adjoints (products with its transpose)`
//!
//! A tape belongs to its thread, so that a recording runs on one. It never gives a number that may be wrong: a part of a
//! [`Rev`] that does not exist, a node that was forgotten and a tape beyond its limit make it unsound
//! ([`DerivativeTape::is_sound`]), and what was recorded is then of no use.

use crate::real::Real;
use std::cell::RefCell;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A number with its node on the tape of its thread.
///
/// # Example
/// ```
/// use moldloft_num::{Adjoints, Real, Rev, DerivativeTape};
/// DerivativeTape::clear();
/// let (x, y) = (DerivativeTape::input(3.0), DerivativeTape::input(4.0));
/// let length = (x * x + y * y).sqrt();
/// let mut adjoints = Adjoints::new();
/// adjoints.add(length, 1.0);
/// adjoints.pull();
/// assert_eq!(length.re(), 5.0);
/// assert!(DerivativeTape::is_sound() && adjoints.are_sound());
/// assert!((adjoints.of(x) - 0.6).abs() < 1e-15 && (adjoints.of(y) - 0.8).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rev {
    value: f64,
    /// Its node, from 1; 0 when it does not depend on any input. [`INFINITE`] is added where a derivative is not finite.
    node: u64,
}

/// The bit of a node of a number whose derivative is not finite, as at a square root of zero.
const INFINITE: u64 = 1 << 63;

/// Maximum size of a tape in bytes.
const MAX_TAPE_BYTES: usize = 2 << 30;

/// Maximum number of nodes that a tape has at a time.
const MAX_NODES: usize = 1 << 30;

/// One dependence: on the node at index `of`, at `rate`. 12 bytes.
#[derive(Clone, Copy)]
#[repr(C, packed(4))]
struct Dependence {
    of: u32,
    rate: f64,
}

/// A recording: for each node, the nodes that it depends on and the partial derivatives.
///
/// Nodes up to [`DerivativeTape::keep`] stay; those after it are *local*, until [`DerivativeTape::forget`].
#[derive(Debug)]
pub struct DerivativeTape {
    /// End of the dependences of each node.
    ends: Vec<u32>,
    dependences: Vec<Dependence>,
    inputs: u32,
    /// Nodes that stay, and the end of their dependences.
    kept: u32,
    /// Local nodes that were forgotten: their numbers are never used again.
    forgotten: u64,
    sound: bool,
    /// The greatest size so far.
    peak: usize,
    /// The derivative of each node in one direction, if [`DerivativeTape::probe`] was called.
    probes: Option<Vec<f64>>,
}

impl std::fmt::Debug for Dependence {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (of, rate) = (self.of, self.rate);
        write!(f, "{rate} of {of}")
    }
}

thread_local! {
    static TAPE: RefCell<DerivativeTape> = const { RefCell::new(DerivativeTape::empty()) };
}

impl DerivativeTape {
    const fn empty() -> Self {
        Self {
            ends: Vec::new(),
            dependences: Vec::new(),
            inputs: 0,
            kept: 0,
            forgotten: 0,
            sound: true,
            peak: 0,
            probes: None,
        }
    }

    /// Begins a recording on this thread. Numbers of an earlier recording become invalid.
    pub fn clear() {
        TAPE.with_borrow_mut(|tape| *tape = Self::empty());
    }

    /// Provides the derivative of each number in one direction, [`Real::probe`], in the recording
    /// that has just begun.
    pub fn probe() {
        TAPE.with_borrow_mut(|tape| {
            debug_assert!(tape.ends.is_empty(), "before the first number");
            tape.probes = Some(Vec::new());
        });
    }

    /// An independent variable.
    pub fn input(value: f64) -> Rev {
        TAPE.with_borrow_mut(|tape| {
            tape.inputs += 1;
            let node = tape.node();
            if let Some(last) = tape.probes.as_mut().and_then(|probes| probes.last_mut()) {
                // Of about the same size for all inputs, and in no simple ratio.
                *last = 1.0 + 0.5 * Real::sin(f64::from(tape.inputs) * 1.618_033_988_749_895);
            }
            Rev { value, node }
        })
    }

    /// Number of inputs.
    pub fn inputs() -> usize {
        TAPE.with_borrow(|tape| tape.inputs as usize)
    }

    /// False when an operation without a reverse mode occurred, so that gradients would be wrong.
    pub fn is_sound() -> bool {
        TAPE.with_borrow(|tape| tape.sound)
    }

    /// Declares the recording unsound.
    #[cold]
    pub fn refuse() {
        TAPE.with_borrow_mut(|tape| tape.sound = false);
    }

    /// Keeps everything recorded so far; later nodes are local.
    pub fn keep() {
        TAPE.with_borrow_mut(|tape| {
            debug_assert_eq!(tape.forgotten, 0, "a tape keeps once");
            tape.kept = tape.ends.len() as u32;
        });
    }

    /// Forgets the local nodes.
    pub fn forget() {
        TAPE.with_borrow_mut(|tape| {
            tape.peak = tape.bytes();
            let local = tape.ends.len() as u32 - tape.kept;
            tape.truncate(tape.kept as usize);
            tape.forgotten += u64::from(local);
        });
    }

    /// The result of `work`, whose numbers are all dropped: what it records is removed, and its nodes are given again.
    /// Shapes that keep what they evaluate must not be evaluated in it.
    pub fn unrecorded<R>(work: impl FnOnce() -> R) -> R {
        let nodes = TAPE.with_borrow(|tape| tape.ends.len());
        let result = work();
        TAPE.with_borrow_mut(|tape| {
            tape.peak = tape.bytes();
            tape.truncate(nodes);
        });
        result
    }

    /// Removes all nodes but these.
    fn truncate(&mut self, nodes: usize) {
        self.ends.truncate(nodes);
        let end = self.ends.last().map_or(0, |end| *end as usize);
        self.dependences.truncate(end);
        if let Some(probes) = &mut self.probes {
            probes.truncate(nodes);
        }
    }

    /// Maximum size of this recording so far, in bytes.
    pub fn peak() -> usize {
        TAPE.with_borrow(Self::bytes)
    }

    fn bytes(&self) -> usize {
        self.peak.max(
            self.ends.len() * size_of::<u32>()
                + self.dependences.len() * size_of::<Dependence>()
                + self.probes.as_ref().map_or(0, |probes| probes.len() * size_of::<f64>()),
        )
    }

    /// The number of a new node that depends on what was appended since the last.
    #[inline]
    fn node(&mut self) -> u64 {
        let end = self.dependences.len();
        let node = self.ends.len() as u64 + 1 + self.forgotten;
        if end * size_of::<Dependence>() > MAX_TAPE_BYTES || self.ends.len() >= MAX_NODES {
            self.sound = false;
            return 0;
        }
        if let Some(probes) = &mut self.probes {
            let begin = self.ends.last().map_or(0, |end| *end as usize);
            let of = |d: &Dependence| d.rate * probes[d.of as usize];
            let derivative = self.dependences[begin..].iter().map(of).sum();
            probes.push(derivative);
        }
        self.ends.push(end as u32);
        node
    }

    /// The index of a node; `None`, and unsound, when it was forgotten.
    #[inline]
    fn index(&mut self, node: u64) -> Option<u32> {
        let kept = u64::from(self.kept);
        if node <= kept {
            return Some((node - 1) as u32);
        }
        if node <= kept + self.forgotten {
            self.sound = false;
            return None;
        }
        Some((node - self.forgotten - 1) as u32)
    }

    /// Appends a dependence of the next node; gives the part of its number that says whether it is finite.
    #[inline]
    fn depend(&mut self, on: u64, rate: f64) -> u64 {
        let (infinite, node) = (on & INFINITE, on & !INFINITE);
        // A rate of zero reaches nothing, were it infinity further down.
        if node != 0
            && rate != 0.0
            && let Some(of) = self.index(node)
        {
            self.dependences.push(Dependence { of, rate });
        }
        if on == 0 || rate.is_finite() { infinite } else { INFINITE }
    }

    /// The number `value` of the next node, if that has dependences.
    #[inline]
    fn number(&mut self, value: f64, before: usize, infinite: u64) -> Rev {
        if self.dependences.len() == before {
            return Rev { value, node: infinite };
        }
        if !self.sound {
            self.dependences.truncate(before);
            return Rev { value, node: infinite };
        }
        Rev { value, node: self.node() | infinite }
    }
}

/// Derivatives of a weighted sum with respect to the nodes of this thread's tape.
#[derive(Clone, Debug, Default)]
pub struct Adjoints {
    weights: Vec<f64>,
    infinite: bool,
}

impl Adjoints {
    /// Zero for all nodes.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds `weight * x` to the sum.
    pub fn add(&mut self, x: Rev, weight: f64) {
        if x.node == 0 || weight == 0.0 {
            return;
        }
        self.infinite |= x.node & INFINITE != 0 || !weight.is_finite();
        TAPE.with_borrow_mut(|tape| {
            self.weights.resize(tape.ends.len().max(self.weights.len()), 0.0);
            let node = x.node & !INFINITE;
            if node != 0
                && let Some(k) = tape.index(node)
            {
                self.weights[k as usize] += weight;
            }
        });
    }

    /// False when the sum has no finite derivative.
    pub fn are_sound(&self) -> bool {
        !self.infinite
    }

    /// Propagates the weights of local nodes to the kept ones.
    pub fn pull_local(&mut self) {
        TAPE.with_borrow(|tape| {
            self.pull_down_to(tape, tape.kept as usize);
            self.weights.truncate(tape.kept as usize);
        });
    }

    /// Propagates all weights to the inputs.
    pub fn pull(&mut self) {
        TAPE.with_borrow(|tape| self.pull_down_to(tape, 0));
    }

    fn pull_down_to(&mut self, tape: &DerivativeTape, last: usize) {
        self.weights.resize(tape.ends.len(), 0.0);
        for k in (last..tape.ends.len()).rev() {
            let weight = self.weights[k];
            if weight == 0.0 {
                continue;
            }
            let begin = if k == 0 { 0 } else { tape.ends[k - 1] as usize };
            for dependence in &tape.dependences[begin..tape.ends[k] as usize] {
                let (of, rate) = (dependence.of, dependence.rate);
                self.weights[of as usize] += rate * weight;
            }
        }
    }

    /// The derivative with respect to an input.
    pub fn of(&self, input: Rev) -> f64 {
        match input.node {
            0 => 0.0,
            node => self.weights.get(node as usize - 1).copied().unwrap_or(0.0),
        }
    }
}

// The operations are calls, not inlined: a third less code of everything that is generic, for a fiftieth of the time.
impl Rev {
    #[inline(never)]
    fn one(value: f64, a: Self, rate: f64) -> Self {
        if a.node == 0 {
            return Self { value, node: 0 };
        }
        TAPE.with_borrow_mut(|tape| {
            let before = tape.dependences.len();
            let infinite = tape.depend(a.node, rate);
            tape.number(value, before, infinite)
        })
    }

    #[inline(never)]
    fn two(value: f64, a: Self, by_a: f64, b: Self, by_b: f64) -> Self {
        if a.node | b.node == 0 {
            return Self { value, node: 0 };
        }
        TAPE.with_borrow_mut(|tape| {
            let before = tape.dependences.len();
            let infinite = tape.depend(a.node, by_a) | tape.depend(b.node, by_b);
            tape.number(value, before, infinite)
        })
    }

    /// Its node; 0 for a constant. Two numbers have the same node only if their derivatives are the
    /// same.
    pub fn node(self) -> u64 {
        self.node
    }
}

impl From<f64> for Rev {
    #[inline(always)]
    fn from(value: f64) -> Self {
        Self { value, node: 0 }
    }
}

impl Neg for Rev {
    type Output = Self;
    #[inline(never)]
    fn neg(self) -> Self {
        Self::one(-self.value, self, -1.0)
    }
}

impl Add for Rev {
    type Output = Self;
    #[inline(never)]
    fn add(self, o: Self) -> Self {
        let value = self.value + o.value;
        // A sum with a constant is the same node.
        match (self.node, o.node) {
            (node, 0) | (0, node) => Self { value, node },
            _ => Self::two(value, self, 1.0, o, 1.0),
        }
    }
}

impl Sub for Rev {
    type Output = Self;
    #[inline(never)]
    fn sub(self, o: Self) -> Self {
        let value = self.value - o.value;
        match (self.node, o.node) {
            (node, 0) => Self { value, node },
            (0, _) => Self::one(value, o, -1.0),
            _ => Self::two(value, self, 1.0, o, -1.0),
        }
    }
}

impl Mul for Rev {
    type Output = Self;
    #[inline(never)]
    fn mul(self, o: Self) -> Self {
        Self::two(self.value * o.value, self, o.value, o, self.value)
    }
}

impl Div for Rev {
    type Output = Self;
    #[inline(never)]
    fn div(self, o: Self) -> Self {
        let r = 1.0 / o.value;
        Self::two(self.value / o.value, self, r, o, -(self.value * (r * r)))
    }
}

impl Add<f64> for Rev {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: f64) -> Self {
        Self { value: self.value + o, ..self }
    }
}

impl Sub<f64> for Rev {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: f64) -> Self {
        Self { value: self.value - o, ..self }
    }
}

impl Mul<f64> for Rev {
    type Output = Self;
    #[inline(never)]
    fn mul(self, o: f64) -> Self {
        if o == 1.0 {
            return self;
        }
        Self::one(self.value * o, self, o)
    }
}

impl Div<f64> for Rev {
    type Output = Self;
    #[inline(never)]
    fn div(self, o: f64) -> Self {
        Self::one(self.value / o, self, 1.0 / o)
    }
}

impl AddAssign for Rev {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl SubAssign for Rev {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

impl MulAssign for Rev {
    #[inline(always)]
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}

impl Real for Rev {
    /// More than one, for searches that ask whether there are derivatives to be had.
    const PARTS: usize = 2;
    const FIRST_ORDER: bool = false;
    const TAPED: bool = true;

    #[inline(always)]
    fn re(self) -> f64 {
        self.value
    }
    #[inline(always)]
    fn part(self, k: usize) -> f64 {
        match k {
            0 => self.value,
            _ if self.node == 0 => 0.0,
            _ => {
                DerivativeTape::refuse();
                f64::NAN
            }
        }
    }
    fn probe(self, k: usize) -> f64 {
        let node = self.node & !INFINITE;
        match k {
            0 => self.value,
            _ if node == 0 => 0.0,
            _ => TAPE.with_borrow_mut(|tape| {
                let at = tape.index(node).map(|at| at as usize);
                let found = tape.probes.as_ref().zip(at).and_then(|(all, at)| all.get(at).copied());
                tape.sound &= found.is_some();
                found.unwrap_or(f64::NAN)
            }),
        }
    }
    #[inline(always)]
    fn from_parts(mut part: impl FnMut(usize) -> f64) -> Self {
        let value = part(0);
        if part(1) != 0.0 {
            DerivativeTape::refuse();
        }
        Self { value, node: 0 }
    }
    #[inline(never)]
    fn linear(value: f64, terms: &[(f64, Self)]) -> Self {
        if let [(1.0, x)] = terms {
            return Self { value, node: x.node };
        }
        if terms.iter().all(|(_, x)| x.node == 0) {
            return Self { value, node: 0 };
        }
        TAPE.with_borrow_mut(|tape| {
            let before = tape.dependences.len();
            let infinite = terms.iter().fold(0, |all, &(rate, x)| all | tape.depend(x.node, rate));
            tape.number(value, before, infinite)
        })
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.value.is_finite() && self.node & INFINITE == 0
    }
    #[inline(always)]
    fn bits_eq(self, o: Self) -> bool {
        self.value.to_bits() == o.value.to_bits() && self.node == o.node
    }
    #[inline(always)]
    fn is_constant(self) -> bool {
        self.node == 0
    }
    #[inline(never)]
    fn sqrt(self) -> Self {
        let s = Real::sqrt(self.value);
        Self::one(s, self, 0.5 / s)
    }
    #[inline(never)]
    fn sin(self) -> Self {
        Self::one(Real::sin(self.value), self, Real::cos(self.value))
    }
    #[inline(never)]
    fn cos(self) -> Self {
        Self::one(Real::cos(self.value), self, -Real::sin(self.value))
    }
    #[inline(never)]
    fn tan(self) -> Self {
        let t = Real::tan(self.value);
        Self::one(t, self, t * t + 1.0)
    }
    #[inline(never)]
    fn asin(self) -> Self {
        let x = self.value;
        Self::one(Real::asin(x), self, 1.0 / Real::sqrt(-(x * x) + 1.0))
    }
    #[inline(never)]
    fn acos(self) -> Self {
        let x = self.value;
        Self::one(Real::acos(x), self, -1.0 / Real::sqrt(-(x * x) + 1.0))
    }
    #[inline(never)]
    fn atan(self) -> Self {
        let x = self.value;
        Self::one(Real::atan(x), self, 1.0 / (x * x + 1.0))
    }
    #[inline(never)]
    fn atan2(self, x: Self) -> Self {
        let (y, x_value) = (self.value, x.value);
        // Of numbers of any size: the squares of both need not be in range.
        let (by_y, by_x) = if y.abs() > x_value.abs() {
            let q = x_value / y;
            let share = 1.0 / (q * q + 1.0) / y;
            (q * share, -share)
        } else {
            let q = y / x_value;
            let share = 1.0 / (q * q + 1.0) / x_value;
            (share, -(q * share))
        };
        Self::two(Real::atan2(y, x_value), self, by_y, x, by_x)
    }
    #[inline(never)]
    fn exp(self) -> Self {
        let e = Real::exp(self.value);
        Self::one(e, self, e)
    }
    #[inline(never)]
    fn ln(self) -> Self {
        Self::one(Real::ln(self.value), self, 1.0 / self.value)
    }
    #[inline(never)]
    fn sinh(self) -> Self {
        Self::one(Real::sinh(self.value), self, Real::cosh(self.value))
    }
    #[inline(never)]
    fn cosh(self) -> Self {
        Self::one(Real::cosh(self.value), self, Real::sinh(self.value))
    }
    #[inline(never)]
    fn tanh(self) -> Self {
        let t = Real::tanh(self.value);
        Self::one(t, self, -(t * t) + 1.0)
    }
    #[inline(never)]
    fn powf(self, exponent: Self) -> Self {
        let (x, e) = (self.value, exponent.value);
        let value = Real::powf(x, e);
        // x^e ln x, the derivative by the exponent, tends to 0 with x.
        if exponent.node == 0 || (x == 0.0 && e > 0.0) {
            let slope = if e == 0.0 { 0.0 } else { e * Real::powf(x, e - 1.0) };
            return Self::one(value, self, slope);
        }
        let log = Real::ln(x);
        let power = Real::exp(log * e);
        Self::two(value, self, power * (e / x), exponent, power * log)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bi2, Dual, Jet, Vec3};

    type D = Dual<2>;

    /// Formulas over all operations, in two variables.
    fn formulas<T: Real>(x: T, y: T) -> Vec<T> {
        let one = T::one();
        let half = x * 0.5 - 0.2;
        vec![
            x * y - x / y + -x,
            (x * 1.0 + 3.0 - y) / 7.0,
            (one - y) * (x - one) + T::from(2.0) / x,
            x.sqrt() + y.sin() * x.cos() - half.tan(),
            half.asin() + half.acos() * y + (x * y).atan(),
            y.atan2(x) * 3.0 + x.atan2(-y) + (-y).atan2(-x),
            x.exp() * y.ln() + x.sinh() / y.cosh() - half.tanh(),
            x.powf(y) + x.powf(T::from(2.5)) + y.powf(T::from(0.0)) + x.powi(-3),
            x.abs().min(y).max(half) + (-x).abs(),
            x.atan2(y * 1e-3) * (y * 1e3).atan2(x * 1e3),
            Vec3::new(x, y, x * y).norm()
                + Vec3::new(x, y, half).cross(Vec3::new(y, x, x)).dot(Vec3::new(one, x, y)),
            T::linear(x.re() * 2.0 - y.re(), &[(2.0, x), (-1.0, y)]),
            crate::log10(x) * x,
        ]
    }

    fn gradient(y: Rev, of: [Rev; 2]) -> [f64; 2] {
        let mut adjoints = Adjoints::new();
        adjoints.add(y, 1.0);
        adjoints.pull();
        assert!(DerivativeTape::is_sound() && adjoints.are_sound());
        of.map(|x| adjoints.of(x))
    }

    #[test]
    fn the_gradient_is_that_of_forward_mode() {
        for (a, b) in [(0.7, 1.3), (1.1, 0.4), (0.2, 2.9)] {
            let dual = formulas(D::seeded(a, 0), D::seeded(b, 1));
            let plain = formulas(a, b);
            DerivativeTape::clear();
            let of = [DerivativeTape::input(a), DerivativeTape::input(b)];
            let taped = formulas(of[0], of[1]);
            for (k, ((d, r), p)) in dual.iter().zip(&taped).zip(&plain).enumerate() {
                assert_eq!(r.re().to_bits(), p.to_bits(), "formula {k}");
                let found = gradient(*r, of);
                let size = 1.0 + d.eps[0].abs() + d.eps[1].abs();
                for (found, exact) in found.into_iter().zip(d.eps) {
                    assert!((found - exact).abs() < 2e-14 * size, "formula {k}: {found} {exact}");
                }
            }
        }
    }

    #[test]
    fn a_jet_over_a_tape_has_gradients_of_second_derivatives() {
        fn second<T: Real>(a: T) -> [T; 3] {
            let (u, v) = Bi2::parameters(T::from(0.3), T::from(0.8));
            let f = (u * v).sin().scaled(a) * (u + v.scaled(a)).exp();
            [f.uu, f.uv, f.vv]
        }
        DerivativeTape::clear();
        let a = DerivativeTape::input(0.6);
        let (taped, dual) = (second(a), second(Dual::<1>::seeded(0.6, 0)));
        for (r, d) in taped.into_iter().zip(dual) {
            assert!((gradient(r, [a, a])[0] - d.eps[0]).abs() < 1e-13);
        }
    }

    #[test]
    fn local_recordings_are_pulled_and_forgotten() {
        DerivativeTape::clear();
        let x = DerivativeTape::input(2.0);
        let y = x * x;
        DerivativeTape::keep();
        let mut adjoints = Adjoints::new();
        let mut last = y;
        for k in 0..3 {
            let z = y * y * f64::from(k);
            adjoints.add(z, 1.0);
            adjoints.pull_local();
            DerivativeTape::forget();
            last = z;
        }
        adjoints.pull();
        // 3 x^4 by x.
        assert_eq!((adjoints.of(x), DerivativeTape::is_sound()), (96.0, true));
        // A number of a local recording is of no use after it.
        let _ = last + y;
        assert!(!DerivativeTape::is_sound());
    }

    #[test]
    fn what_is_unrecorded_takes_no_space() {
        DerivativeTape::clear();
        let x = DerivativeTape::input(2.0);
        let y = x * x;
        let value = DerivativeTape::unrecorded(|| (y * y + x).re());
        let z = y * x;
        assert_eq!((value, z.node()), (18.0, y.node() + 1));
        assert_eq!((gradient(z, [x, y])[0], DerivativeTape::is_sound()), (12.0, true));
    }

    #[test]
    fn what_has_no_derivative_is_not_finite() {
        DerivativeTape::clear();
        let x = DerivativeTape::input(0.0);
        assert!(Rev::from(0.0).sqrt().is_finite() && x.is_finite());
        let root = x.sqrt();
        assert!(!root.is_finite() && !(root * 0.0).is_finite() && !(x + root).is_finite());
        let mut adjoints = Adjoints::new();
        adjoints.add(root * 2.0, 1.0);
        assert!(!adjoints.are_sound() && DerivativeTape::is_sound());
        assert!(D::seeded(0.0, 0).sqrt().is_finite() == root.is_finite());
    }

    #[test]
    fn a_probe_is_the_derivative_in_one_direction() {
        DerivativeTape::clear();
        DerivativeTape::probe();
        let of = [DerivativeTape::input(0.7), DerivativeTape::input(1.3)];
        DerivativeTape::keep();
        for _ in 0..2 {
            for y in formulas(of[0], of[1]) {
                let rates = of.map(|x| x.probe(1));
                assert!(rates[0] != rates[1] && rates.iter().all(|r| (0.5..=1.5).contains(r)));
                let by = gradient(y, of);
                let exact = by[0] * rates[0] + by[1] * rates[1];
                assert!((y.probe(1) - exact).abs() < 1e-13 * (1.0 + exact.abs()));
            }
            DerivativeTape::forget();
        }
        assert_eq!((Rev::from(2.0).probe(0), Rev::from(2.0).probe(1)), (2.0, 0.0));
        DerivativeTape::clear();
        // Without probes it is something that a tape does not have.
        let _ = DerivativeTape::input(1.0).probe(1);
        assert!(!DerivativeTape::is_sound());
    }

    #[test]
    fn parts_that_do_not_exist_make_the_tape_unsound() {
        DerivativeTape::clear();
        let x = DerivativeTape::input(1.0);
        assert_eq!((Rev::from(2.0).part(1), x.part(0)), (0.0, 1.0));
        assert!(DerivativeTape::is_sound());
        let _ = Rev::from_parts(|k| x.part(k));
        assert!(!DerivativeTape::is_sound());
        DerivativeTape::clear();
        assert!(DerivativeTape::is_sound());
    }
}
