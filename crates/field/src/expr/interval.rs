//! Intervals of doubles, rounded outward.

use moldloft_num::Box3;
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::{Add, Mul, Neg, Sub};

/// The numbers between two ends. Every operation encloses all real results, and the result of plain
/// double arithmetic in any rounding mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Low end.
    pub low: f64,
    /// High end.
    pub high: f64,
}

/// A bound on the error of one rounded operation with result `x`: one unit in the last place is at
/// most 2^-52 |x|, the rounding error half of it; the constant covers underflow.
#[inline(always)]
fn ulp(x: f64) -> f64 {
    x.abs() * f64::EPSILON + f64::MIN_POSITIVE
}

/// A product of two ends; 0 times an infinite end is 0, because the values themselves are finite.
#[inline(always)]
fn product(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}

impl Interval {
    /// All numbers.
    pub const ENTIRE: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };
    /// Zero alone.
    pub const ZERO: Self = Self { low: 0.0, high: 0.0 };

    /// The interval of `low` and `high`, which must be in order.
    #[inline(always)]
    pub fn new(low: f64, high: f64) -> Self {
        debug_assert!(low <= high || low.is_nan() || high.is_nan(), "{low} > {high}");
        Self { low, high }
    }

    /// One number.
    #[inline(always)]
    pub fn point(x: f64) -> Self {
        Self { low: x, high: x }
    }

    /// Moves both ends outward by one rounding error.
    #[inline(always)]
    fn outward(low: f64, high: f64) -> Self {
        // A low end beyond the largest number is at least that, and likewise a high one.
        let low = if low > f64::MAX { f64::MAX } else { low };
        let high = if high < f64::MIN { f64::MIN } else { high };
        Self { low: low - ulp(low), high: high + ulp(high) }
    }

    /// True if `x` is in the interval.
    pub fn contains(self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }

    /// The middle.
    pub fn middle(self) -> f64 {
        0.5 * self.low + 0.5 * self.high
    }

    /// Length.
    pub fn width(self) -> f64 {
        self.high - self.low
    }

    /// The largest absolute value in it.
    pub fn magnitude(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// The smallest interval that contains both.
    pub fn hull(self, o: Self) -> Self {
        Self { low: self.low.min(o.low), high: self.high.max(o.high) }
    }

    /// The numbers in both. Two enclosures of one number always overlap; if rounding at infinity
    /// separates them, the result is the first.
    pub fn meet(self, o: Self) -> Self {
        let (low, high) = (self.low.max(o.low), self.high.min(o.high));
        if low <= high { Self { low, high } } else { self }
    }

    /// The minima of a number of each interval.
    #[inline(always)]
    pub fn min(self, o: Self) -> Self {
        Self { low: self.low.min(o.low), high: self.high.min(o.high) }
    }

    /// The maxima of a number of each interval.
    #[inline(always)]
    pub fn max(self, o: Self) -> Self {
        Self { low: self.low.max(o.low), high: self.high.max(o.high) }
    }

    /// Its numbers times `c`.
    #[inline(always)]
    pub fn scaled(self, c: f64) -> Self {
        let (a, b) = (product(self.low, c), product(self.high, c));
        if c < 0.0 { Self::outward(b, a) } else { Self::outward(a, b) }
    }

    /// The interval divided by `c`, which is not zero.
    pub fn divided(self, c: f64) -> Self {
        let (a, b) = (self.low / c, self.high / c);
        if c < 0.0 { Self::outward(b, a) } else { Self::outward(a, b) }
    }

    /// Absolute values.
    #[inline(always)]
    pub fn abs(self) -> Self {
        if self.low >= 0.0 {
            self
        } else if self.high <= 0.0 {
            -self
        } else {
            Self { low: 0.0, high: self.high.max(-self.low) }
        }
    }

    /// Squares.
    #[inline(always)]
    pub fn square(self) -> Self {
        let a = self.abs();
        let out = Self::outward(a.low * a.low, a.high * a.high);
        Self { low: out.low.max(0.0), high: out.high }
    }

    /// Powers with an integer exponent; even powers are not negative.
    pub fn powi(self, n: u32) -> Self {
        match n {
            0 => Self::point(1.0),
            1 => self,
            _ if n.is_multiple_of(2) => {
                let half = self.square().powi(n / 2);
                Self { low: half.low.max(0.0), ..half }
            }
            _ => {
                // Odd powers grow: the ends decide.
                let end = |x: f64| {
                    let even = Self::point(x).square().powi(n / 2);
                    even * Self::point(x)
                };
                Self { low: end(self.low).low, high: end(self.high).high }
            }
        }
    }

    /// Square roots; negative numbers count as zero.
    pub fn sqrt(self) -> Self {
        let root = |x: f64| x.max(0.0).sqrt();
        let out = Self::outward(root(self.low), root(self.high));
        Self { low: out.low.max(0.0), high: out.high }
    }

    /// sgn(x) sqrt|x|, which grows.
    pub fn signed_sqrt(self) -> Self {
        let root = |x: f64| x.abs().sqrt().copysign(x);
        Self::outward(root(self.low), root(self.high))
    }

    /// A growing function of `libm` whose error is below one unit in the last place; two are given.
    fn growing(self, f: fn(f64) -> f64) -> Self {
        let (a, b) = (f(self.low), f(self.high));
        Self { low: a - 2.0 * ulp(a), high: b + 2.0 * ulp(b) }
    }

    /// Exponentials.
    pub fn exp(self) -> Self {
        let e = self.growing(libm::exp);
        Self { low: e.low.max(0.0), high: e.high }
    }

    /// Cosines.
    pub fn cos(self) -> Self {
        if !(self.width() < 2.0 * PI && self.magnitude() < 1e9) {
            return Self { low: -1.0, high: 1.0 };
        }
        // Whole multiples of pi inside, with a margin that is wider than the error of k * PI below
        // the magnitude above: extremes are then counted too often rather than too seldom.
        let margin = 1e-6;
        let first = ((self.low - margin) / PI).ceil() as i64;
        let last = ((self.high + margin) / PI).floor() as i64;
        let (a, b) = (libm::cos(self.low), libm::cos(self.high));
        let widened = |x: f64| 2.0 * ulp(x);
        let mut out = Self { low: a.min(b), high: a.max(b) };
        out.low -= widened(out.low);
        out.high += widened(out.high);
        for k in first..=last {
            if k % 2 == 0 {
                out.high = 1.0;
            } else {
                out.low = -1.0;
            }
        }
        Self { low: out.low.max(-1.0), high: out.high.min(1.0) }
    }

    /// Sines, as cosines shifted by a quarter turn.
    pub fn sin(self) -> Self {
        (self - Self { low: FRAC_PI_2, high: FRAC_PI_2.next_up() }).cos()
    }

    /// Angles of the points (`x`, `self`).
    pub fn atan2(self, x: Self) -> Self {
        if x.low <= 0.0 && self.contains(0.0) {
            let top = PI.next_up();
            return Self { low: -top, high: top };
        }
        // Off the cut the angle has no extremum inside: the corners decide.
        let corners =
            [(self.low, x.low), (self.low, x.high), (self.high, x.low), (self.high, x.high)];
        let angles = corners.map(|(y, x)| libm::atan2(y, x));
        let low = angles.into_iter().fold(f64::INFINITY, f64::min);
        let high = angles.into_iter().fold(f64::NEG_INFINITY, f64::max);
        Self { low: low - 2.0 * ulp(low), high: high + 2.0 * ulp(high) }
    }

    /// Natural logarithms of the positive part.
    pub fn ln(self) -> Self {
        if self.high <= 0.0 {
            return Self::ENTIRE;
        }
        let end = |x: f64| if x > 0.0 { libm::log(x) } else { f64::NEG_INFINITY };
        let (a, b) = (end(self.low), end(self.high));
        Self { low: a - 2.0 * ulp(a), high: b + 2.0 * ulp(b) }
    }

    /// Tangents; [`Self::ENTIRE`] if the interval contains a pole.
    pub fn tan(self) -> Self {
        // Poles are counted too often rather than too seldom, as extremes of the cosine are.
        let turn = |x: f64| ((x - FRAC_PI_2) / PI).floor();
        let margin = 1e-6;
        let clear = self.magnitude() < 1e9 && turn(self.low - margin) == turn(self.high + margin);
        if clear { self.growing(libm::tan) } else { Self::ENTIRE }
    }

    /// The whole quotient of all numbers by all numbers of `o`, rounded down, when there is one.
    pub(crate) fn turns(self, o: Self) -> Option<f64> {
        if o.low <= 0.0 && o.high >= 0.0 {
            return None;
        }
        let ratio = self * o.reciprocal();
        let n = ratio.low.floor();
        (ratio.low.is_finite() && n == ratio.high.floor()).then_some(n)
    }

    /// x - y floor(x / y).
    pub fn remainder(self, o: Self) -> Self {
        if o.low <= 0.0 && o.high >= 0.0 {
            return Self::ENTIRE;
        }
        match self.turns(o) {
            Some(n) => self - o.scaled(n),
            None => {
                let (low, high) = (o.low.min(0.0), o.high.max(0.0));
                Self { low: low - ulp(low), high: high + ulp(high) }
            }
        }
    }

    /// The reciprocals of the positive numbers in it.
    pub(crate) fn reciprocal_above_zero(self) -> Self {
        if self.low > 0.0 {
            self.reciprocal()
        } else if self.high > 0.0 {
            Self { low: (1.0 / self.high) * (1.0 - f64::EPSILON), high: f64::INFINITY }
        } else {
            Self::ENTIRE
        }
    }

    /// Reciprocals; [`Self::ENTIRE`] if the interval contains zero.
    pub fn reciprocal(self) -> Self {
        if self.low > 0.0 || self.high < 0.0 {
            Self::outward(1.0 / self.high, 1.0 / self.low)
        } else {
            Self::ENTIRE
        }
    }
}

impl Neg for Interval {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }
}

impl Add for Interval {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::outward(self.low + o.low, self.high + o.high)
    }
}

impl Sub for Interval {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::outward(self.low - o.high, self.high - o.low)
    }
}

impl Mul for Interval {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        let (a, b) = (product(self.low, o.low), product(self.low, o.high));
        let (c, d) = (product(self.high, o.low), product(self.high, o.high));
        Self::outward(a.min(b).min(c.min(d)), a.max(b).max(c.max(d)))
    }
}

/// The eight halves of a box along all three axes; bit k of the number is the upper half along axis k.
pub(crate) fn octants(sides: &[Interval; 3]) -> [[Interval; 3]; 8] {
    std::array::from_fn(|corner| {
        [0, 1, 2].map(|axis| {
            let middle = sides[axis].middle();
            match corner >> axis & 1 {
                0 => Interval::new(sides[axis].low, middle),
                _ => Interval::new(middle, sides[axis].high),
            }
        })
    })
}

pub(crate) fn sides(b: &Box3) -> [Interval; 3] {
    [0, 1, 2].map(|k| Interval { low: b.low[k], high: b.high[k] })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples of pairs of intervals and of numbers inside them, from a fixed sequence.
    fn samples(mut check: impl FnMut(Interval, Interval, f64, f64)) {
        let mut random = moldloft_testing::Random::new(7);
        for _ in 0..3000 {
            let mut interval = || {
                let scale = [1e-3, 1.0, 30.0][random.below(3)];
                let (a, b) = (random.between(-scale, scale), random.between(-scale, scale));
                (Interval::new(a.min(b), a.max(b)), random.between(0.0, 1.0))
            };
            let ((a, s), (b, t)) = (interval(), interval());
            let inside = |i: Interval, t: f64| (i.low + t * (i.high - i.low)).clamp(i.low, i.high);
            check(a, b, inside(a, s), inside(b, t));
        }
    }

    #[test]
    fn results_contain_every_sample() {
        samples(|a, b, x, y| {
            let pairs = [
                (a + b, x + y),
                (a - b, x - y),
                (a * b, x * y),
                (-a, -x),
                (a.scaled(-1.7), x * -1.7),
                (a.divided(0.3), x / 0.3),
                (a.abs(), x.abs()),
                (a.square(), x * x),
                (a.powi(3), x * x * x),
                (a.powi(4), (x * x) * (x * x)),
                (a.abs().sqrt(), x.abs().sqrt()),
                (a.signed_sqrt(), x.abs().sqrt().copysign(x)),
                (a.exp(), libm::exp(x)),
                (a.sin(), libm::sin(x)),
                (a.cos(), libm::cos(x)),
                (a.atan2(b), libm::atan2(x, y)),
                (a.min(b), x.min(y)),
                (a.max(b), x.max(y)),
            ];
            for (k, (range, value)) in pairs.into_iter().enumerate() {
                assert!(
                    range.contains(value),
                    "operation {k}: {value} not in {range:?}, {a:?} {b:?}"
                );
            }
        });
    }

    #[test]
    fn ranges_are_tight() {
        let near = |i: Interval, low: f64, high: f64| {
            assert!((i.low - low).abs() < 1e-12 && (i.high - high).abs() < 1e-12, "{i:?}");
        };
        near(Interval::new(-1.0, 2.0).powi(3), -1.0, 8.0);
        near(Interval::new(-3.0, 2.0).square(), 0.0, 9.0);
        near(Interval::new(0.5, 2.0).sin(), libm::sin(0.5), 1.0);
        near(Interval::new(1.0, 2.0).cos(), libm::cos(2.0), libm::cos(1.0));
        near(
            Interval::new(1.0, 2.0).atan2(Interval::new(1.0, 1.0)),
            PI / 4.0,
            libm::atan2(2.0, 1.0),
        );
        assert_eq!(Interval::new(-1.0, 1.0).reciprocal(), Interval::ENTIRE);
    }
}
