//! Ranges of second derivatives, which bound the remainder of a Taylor form of second order.

use super::algebra::{Algebra, Unary};
use super::interval::Interval;
use super::oracle::{Affine, Oracle};
use moldloft_num::{Box3, Vec3};

/// Ranges of value, gradient and second derivatives over a box. With a kink in the box the second
/// derivatives are unbounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HessianRange {
    pub value: Interval,
    pub slope: [Interval; 3],
    /// xx, yy, zz, xy, yz, zx.
    pub second: [Interval; 6],
}

/// The axes of each second derivative.
pub(crate) const PAIRS: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]];

/// All numbers, as every second derivative.
const UNKNOWN: [Interval; 6] = [Interval::ENTIRE; 6];

fn is_zero(x: Interval) -> bool {
    x.low == 0.0 && x.high == 0.0
}

/// A product in which zero times anything is zero.
fn product(a: Interval, b: Interval) -> Interval {
    if is_zero(a) || is_zero(b) { Interval::ZERO } else { a * b }
}

/// A sum that adds nothing to zero, not even rounding.
fn plus(a: Interval, b: Interval) -> Interval {
    match (is_zero(a), is_zero(b)) {
        (true, _) => b,
        (_, true) => a,
        _ => a + b,
    }
}

impl HessianRange {
    fn constant(value: Interval) -> Self {
        Self { value, slope: [Interval::ZERO; 3], second: [Interval::ZERO; 6] }
    }

    /// f(self), from the ranges of f and its derivatives over the range of `self`.
    fn chained(self, value: Interval, d1: Interval, d2: Interval) -> Self {
        let slope = self.slope.map(|g| product(g, d1));
        let mut second = [Interval::ZERO; 6];
        for (k, [i, j]) in PAIRS.into_iter().enumerate() {
            let outer = if i == j {
                if is_zero(self.slope[i]) { Interval::ZERO } else { self.slope[i].square() }
            } else {
                product(self.slope[i], self.slope[j])
            };
            second[k] = plus(product(self.second[k], d1), product(outer, d2));
        }
        Self { value, slope, second }
    }

    fn zip(self, o: Self, f: impl Fn(Interval, Interval) -> Interval) -> Self {
        Self {
            value: f(self.value, o.value),
            slope: [0, 1, 2].map(|k| f(self.slope[k], o.slope[k])),
            second: [0, 1, 2, 3, 4, 5].map(|k| f(self.second[k], o.second[k])),
        }
    }

    fn map(self, f: impl Fn(Interval) -> Interval) -> Self {
        Self { value: f(self.value), slope: self.slope.map(&f), second: self.second.map(&f) }
    }

    /// One of two values whose order may change in the box.
    fn either(self, o: Self, value: Interval) -> Self {
        let slope = [0, 1, 2].map(|k| self.slope[k].hull(o.slope[k]));
        Self { value, slope, second: UNKNOWN }
    }
}

impl Algebra<f64> for HessianRange {
    type At = [Interval; 3];
    fn real(x: f64) -> Self {
        Self::constant(Interval::point(x))
    }
    fn plane(n: Vec3, offset: f64, at: &[Interval; 3]) -> Self {
        let slope = [n.x, n.y, n.z].map(Interval::point);
        Self { value: Interval::plane(n, offset, at), slope, second: [Interval::ZERO; 6] }
    }
    fn user(oracle: &dyn Oracle<f64>, map: &Affine<f64>, at: &[Interval; 3]) -> Self {
        let local = map.range(at);
        let low = Vec3::new(local[0].low, local[1].low, local[2].low);
        let high = Vec3::new(local[0].high, local[1].high, local[2].high);
        let b = Box3 { low, high };
        let slope = map.pull_back_range(oracle.gradient_range(&b));
        Self { value: oracle.range(&b), slope, second: UNKNOWN }
    }
    fn sum(self, o: Self) -> Self {
        self.zip(o, plus)
    }
    fn difference(self, o: Self) -> Self {
        self.zip(o, |a, b| plus(a, -b))
    }
    fn times(self, o: Self) -> Self {
        let slope = [0, 1, 2]
            .map(|k| plus(product(self.slope[k], o.value), product(o.slope[k], self.value)));
        let mut second = [Interval::ZERO; 6];
        for (k, [i, j]) in PAIRS.into_iter().enumerate() {
            let outer =
                plus(product(self.slope[i], o.slope[j]), product(self.slope[j], o.slope[i]));
            let own = plus(product(self.second[k], o.value), product(o.second[k], self.value));
            second[k] = plus(own, outer);
        }
        Self { value: self.value * o.value, slope, second }
    }
    fn plus_real(self, c: f64) -> Self {
        Self { value: self.value.plus_real(c), ..self }
    }
    fn times_real(self, c: f64) -> Self {
        self.map(|x| if is_zero(x) { x } else { x.scaled(c) })
    }
    fn over_real(self, c: f64) -> Self {
        self.map(|x| if is_zero(x) { x } else { x.divided(c) })
    }
    fn power(self, n: u32) -> Self {
        match n {
            0 => Self::real(1.0),
            1 => self,
            _ => {
                let d1 = self.value.powi(n - 1).scaled(f64::from(n));
                let d2 = self.value.powi(n - 2).scaled(f64::from(n) * f64::from(n - 1));
                self.chained(self.value.power(n), d1, d2)
            }
        }
    }
    fn unary(self, f: Unary) -> Self {
        self.chained(f.range(self.value), f.slope(self.value), f.curvature(self.value))
    }
    fn smaller(self, o: Self) -> Self {
        if self.value.high < o.value.low {
            self
        } else if o.value.high < self.value.low {
            o
        } else {
            self.either(o, self.value.min(o.value))
        }
    }
    fn larger(self, o: Self) -> Self {
        if self.value.low > o.value.high {
            self
        } else if o.value.low > self.value.high {
            o
        } else {
            self.either(o, self.value.max(o.value))
        }
    }
    fn quotient(self, o: Self) -> Self {
        let value = Algebra::quotient(self.value, o.value);
        Self { value, ..self.times(o.unary(Unary::Reciprocal)) }
    }
    fn remainder(self, o: Self) -> Self {
        let value = Interval::remainder(self.value, o.value);
        match Interval::turns(self.value, o.value) {
            Some(n) => Self { value, ..self.difference(o.times_real(n)) },
            None => Self { value, slope: [Interval::ENTIRE; 3], second: UNKNOWN },
        }
    }
    fn angle(self, x: Self) -> Self {
        let value = self.value.atan2(x.value);
        let size = (self.value.square() + x.value.square()).reciprocal();
        let cut = x.value.low <= 0.0 && self.value.contains(0.0);
        let slope = [0, 1, 2].map(|k| {
            if cut {
                Interval::ENTIRE
            } else {
                (self.slope[k] * x.value - x.slope[k] * self.value) * size
            }
        });
        Self { value, slope, second: UNKNOWN }
    }
}
