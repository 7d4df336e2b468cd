//! The numbers that a tape can be evaluated with: plain and dual scalars, jets in space, intervals,
//! and intervals with gradients. Each operation has one meaning in all of them.

use crate::expr::interval::Interval;
use crate::expr::oracle::{Affine, Oracle};
use moldloft_num::{Box3, Real, Vec3};

/// A function of one variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unary {
    /// -x.
    Neg,
    /// |x|; at zero it has the slope of x, so that sheets have normals.
    Abs,
    /// 1 if positive, else -1.
    Sign,
    /// Square root; of negative numbers zero, and at zero with slope zero.
    Sqrt,
    /// sgn(x) sqrt|x|; at zero with slope 1, the direction of x.
    SignedSqrt,
    /// Sine.
    Sin,
    /// Cosine.
    Cos,
    /// Exponential.
    Exp,
    /// Natural logarithm; without a value unless x is positive.
    Ln,
    /// Tangent; it has poles.
    Tan,
    /// 1 / x; it has a pole at 0.
    Reciprocal,
}

impl Unary {
    #[inline(always)]
    pub(crate) fn of<T: Real>(self, x: T) -> T {
        match self {
            Unary::Neg => -x,
            Unary::Abs => x.abs(),
            Unary::Sign => T::from(if x.re() > 0.0 { 1.0 } else { -1.0 }),
            Unary::Sqrt => {
                if x.re() > 0.0 {
                    x.sqrt()
                } else {
                    T::zero()
                }
            }
            Unary::SignedSqrt => {
                if x.re() > 0.0 {
                    x.sqrt()
                } else if x.re() < 0.0 {
                    -(-x).sqrt()
                } else {
                    x
                }
            }
            Unary::Sin => x.sin(),
            Unary::Cos => x.cos(),
            Unary::Exp => x.exp(),
            Unary::Ln => x.ln(),
            Unary::Tan => x.tan(),
            Unary::Reciprocal => T::one() / x,
        }
    }

    /// Value, first and second derivative.
    pub(crate) fn jet<T: Real>(self, x: T) -> (T, T, T) {
        let (zero, one) = (T::zero(), T::one());
        let f = self.of(x);
        match self {
            Unary::Neg => (f, -one, zero),
            Unary::Abs => (f, if x.re() < 0.0 { -one } else { one }, zero),
            Unary::Sign => (f, zero, zero),
            Unary::Sqrt if x.re() > 0.0 => {
                let d = T::from(0.5) / f;
                (f, d, -(d / x) * 0.5)
            }
            Unary::Sqrt => (f, zero, zero),
            Unary::SignedSqrt if x.re() != 0.0 => {
                let d = T::from(0.5) / f.abs();
                (f, d, -(d / x) * 0.5)
            }
            Unary::SignedSqrt => (f, one, zero),
            Unary::Sin => (f, x.cos(), -f),
            Unary::Cos => (f, -x.sin(), -f),
            Unary::Exp => (f, f, f),
            Unary::Ln => {
                let d = one / x;
                (f, d, -(d * d))
            }
            Unary::Tan => {
                let d = f * f + one;
                (f, d, f * d * 2.0)
            }
            Unary::Reciprocal => (f, -(f * f), f * f * f * 2.0),
        }
    }

    pub(crate) fn range(self, x: Interval) -> Interval {
        match self {
            Unary::Neg => -x,
            Unary::Abs => x.abs(),
            Unary::Sign => Interval {
                low: if x.low > 0.0 { 1.0 } else { -1.0 },
                high: if x.high <= 0.0 { -1.0 } else { 1.0 },
            },
            Unary::Sqrt => x.sqrt(),
            Unary::SignedSqrt => x.signed_sqrt(),
            Unary::Sin => x.sin(),
            Unary::Cos => x.cos(),
            Unary::Exp => x.exp(),
            Unary::Ln => x.ln(),
            Unary::Tan => x.tan(),
            Unary::Reciprocal => x.reciprocal(),
        }
    }

    /// A range of the slope between any two points: for kinked functions the slopes of all chords,
    /// so that the mean-value form holds; everything where it is unbounded.
    pub(crate) fn slope(self, x: Interval) -> Interval {
        let (one, both) = (Interval::point(1.0), Interval { low: -1.0, high: 1.0 });
        match self {
            Unary::Neg => -one,
            Unary::Abs if x.low >= 0.0 => one,
            Unary::Abs if x.high < 0.0 => -one,
            Unary::Abs => both,
            Unary::Sign if x.low > 0.0 || x.high <= 0.0 => Interval::ZERO,
            Unary::Sign => Interval::ENTIRE,
            Unary::Sqrt | Unary::SignedSqrt if x.low > 0.0 || x.high < 0.0 => {
                if self == Unary::Sqrt && x.high < 0.0 {
                    return Interval::ZERO;
                }
                x.abs().sqrt().scaled(2.0).reciprocal()
            }
            Unary::Sqrt | Unary::SignedSqrt => Interval::ENTIRE,
            Unary::Sin => x.cos(),
            Unary::Cos => -x.sin(),
            Unary::Exp => x.exp(),
            Unary::Ln => x.reciprocal_above_zero(),
            Unary::Tan => x.tan().square().plus_real(1.0),
            Unary::Reciprocal => -x.reciprocal().square(),
        }
    }

    /// A range of the second derivative; everything where the slope jumps or is unbounded.
    pub(crate) fn curvature(self, x: Interval) -> Interval {
        let smooth = x.low > 0.0 || x.high < 0.0;
        match self {
            Unary::Neg => Interval::ZERO,
            Unary::Abs | Unary::Sign if smooth => Interval::ZERO,
            Unary::Sqrt if x.high < 0.0 => Interval::ZERO,
            // -+ 1 / (4 |x| sqrt |x|)
            Unary::Sqrt | Unary::SignedSqrt if smooth => {
                let bend = (x.abs() * x.abs().sqrt()).scaled(4.0).reciprocal();
                if x.low > 0.0 { -bend } else { bend }
            }
            Unary::Abs | Unary::Sign | Unary::Sqrt | Unary::SignedSqrt => Interval::ENTIRE,
            Unary::Sin => -x.sin(),
            Unary::Cos => -x.cos(),
            Unary::Exp => x.exp(),
            Unary::Ln => -x.reciprocal_above_zero().square(),
            Unary::Tan => {
                let t = x.tan();
                (t * t.square().plus_real(1.0)).scaled(2.0)
            }
            Unary::Reciprocal => x.reciprocal().powi(3).scaled(2.0),
        }
    }
}

/// A number on which formulas can be computed.
pub(crate) trait Algebra<T: Real>: Copy {
    type At;
    fn real(x: T) -> Self;
    fn plane(normal: Vec3<T>, offset: T, at: &Self::At) -> Self;
    fn user(oracle: &dyn Oracle<T>, map: &Affine<T>, at: &Self::At) -> Self;
    /// As [`Algebra::user`] at many points: appended to `out`.
    fn users(oracle: &dyn Oracle<T>, map: &Affine<T>, at: &[Self::At], out: &mut Vec<Self>) {
        out.extend(at.iter().map(|p| Self::user(oracle, map, p)));
    }
    fn sum(self, o: Self) -> Self;
    fn difference(self, o: Self) -> Self;
    fn times(self, o: Self) -> Self;
    fn plus_real(self, c: T) -> Self;
    fn times_real(self, c: T) -> Self;
    fn over_real(self, c: T) -> Self;
    fn power(self, n: u32) -> Self;
    fn unary(self, f: Unary) -> Self;
    fn smaller(self, o: Self) -> Self;
    fn larger(self, o: Self) -> Self;
    fn angle(self, x: Self) -> Self;
    fn quotient(self, o: Self) -> Self;
    /// x - y floor(x / y).
    fn remainder(self, o: Self) -> Self;
}

/// x - y floor(x / y), of the sign of y.
pub(crate) fn remainder<T: Real>(x: T, y: T) -> T {
    x - y * (x.re() / y.re()).floor()
}

/// x^n by squaring; the same order of multiplications for every scalar.
pub(crate) fn power<T: Real>(x: T, n: u32) -> T {
    x.powi(n as i32)
}

impl<T: Real> Algebra<T> for T {
    type At = Vec3<T>;
    #[inline(always)]
    fn real(x: T) -> Self {
        x
    }
    #[inline(always)]
    fn plane(n: Vec3<T>, offset: T, p: &Vec3<T>) -> Self {
        n.x * p.x + n.y * p.y + n.z * p.z + offset
    }
    fn user(oracle: &dyn Oracle<T>, map: &Affine<T>, p: &Vec3<T>) -> Self {
        oracle.value(map.apply(*p))
    }
    fn users(oracle: &dyn Oracle<T>, map: &Affine<T>, at: &[Vec3<T>], out: &mut Vec<Self>) {
        let points: Vec<Vec3<T>> = at.iter().map(|p| map.apply(*p)).collect();
        out.resize(at.len(), T::zero());
        oracle.values(&points, out);
    }
    #[inline(always)]
    fn sum(self, o: Self) -> Self {
        self + o
    }
    #[inline(always)]
    fn difference(self, o: Self) -> Self {
        self - o
    }
    #[inline(always)]
    fn times(self, o: Self) -> Self {
        self * o
    }
    #[inline(always)]
    fn plus_real(self, c: T) -> Self {
        self + c
    }
    #[inline(always)]
    fn times_real(self, c: T) -> Self {
        self * c
    }
    #[inline(always)]
    fn over_real(self, c: T) -> Self {
        self / c
    }
    #[inline(always)]
    fn power(self, n: u32) -> Self {
        power(self, n)
    }
    #[inline(always)]
    fn unary(self, f: Unary) -> Self {
        f.of(self)
    }
    #[inline(always)]
    fn smaller(self, o: Self) -> Self {
        self.min(o)
    }
    #[inline(always)]
    fn larger(self, o: Self) -> Self {
        self.max(o)
    }
    fn angle(self, x: Self) -> Self {
        self.atan2(x)
    }
    #[inline(always)]
    fn quotient(self, o: Self) -> Self {
        self / o
    }
    fn remainder(self, o: Self) -> Self {
        remainder(self, o)
    }
}

/// A value with its gradient.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ValueGradient<T> {
    /// The value.
    pub value: T,
    /// The derivatives by x, y and z.
    pub slope: Vec3<T>,
}

impl<T: Real> ValueGradient<T> {
    #[inline(always)]
    fn chained(self, value: T, d1: T) -> Self {
        Self { value, slope: self.slope * d1 }
    }
}

impl<T: Real> Algebra<T> for ValueGradient<T> {
    type At = Vec3<T>;
    #[inline(always)]
    fn real(x: T) -> Self {
        Self { value: x, slope: Vec3::zero() }
    }
    #[inline(always)]
    fn plane(n: Vec3<T>, offset: T, p: &Vec3<T>) -> Self {
        Self { value: T::plane(n, offset, p), slope: n }
    }
    fn user(oracle: &dyn Oracle<T>, map: &Affine<T>, p: &Vec3<T>) -> Self {
        let (value, g) = oracle.value_and_gradient(map.apply(*p));
        Self { value, slope: map.pull_back(g) }
    }
    fn users(oracle: &dyn Oracle<T>, map: &Affine<T>, at: &[Vec3<T>], out: &mut Vec<Self>) {
        let points: Vec<Vec3<T>> = at.iter().map(|p| map.apply(*p)).collect();
        let found = oracle.values_and_gradients(&points).into_iter();
        out.extend(found.map(|(value, g)| Self { value, slope: map.pull_back(g) }));
    }
    #[inline(always)]
    fn sum(self, o: Self) -> Self {
        Self { value: self.value + o.value, slope: self.slope + o.slope }
    }
    #[inline(always)]
    fn difference(self, o: Self) -> Self {
        Self { value: self.value - o.value, slope: self.slope - o.slope }
    }
    #[inline(always)]
    fn times(self, o: Self) -> Self {
        let slope = self.slope * o.value + o.slope * self.value;
        Self { value: self.value * o.value, slope }
    }
    #[inline(always)]
    fn plus_real(self, c: T) -> Self {
        Self { value: self.value + c, ..self }
    }
    #[inline(always)]
    fn times_real(self, c: T) -> Self {
        self.chained(self.value * c, c)
    }
    #[inline(always)]
    fn over_real(self, c: T) -> Self {
        Self { value: self.value / c, slope: self.slope / c }
    }
    #[inline(always)]
    fn power(self, n: u32) -> Self {
        if n == 0 {
            return Self::real(T::one());
        }
        self.chained(power(self.value, n), power(self.value, n - 1) * f64::from(n))
    }
    #[inline(always)]
    fn unary(self, f: Unary) -> Self {
        let (value, d1, _) = f.jet(self.value);
        self.chained(value, d1)
    }
    #[inline(always)]
    fn smaller(self, o: Self) -> Self {
        if o.value.re() < self.value.re() { o } else { self }
    }
    #[inline(always)]
    fn larger(self, o: Self) -> Self {
        if o.value.re() > self.value.re() { o } else { self }
    }
    fn angle(self, x: Self) -> Self {
        let (y, x0) = (self.value, x.value);
        let size = x0 * x0 + y * y;
        let slope = if size.re() > 0.0 {
            self.slope * (x0 / size) + x.slope * -(y / size)
        } else {
            Vec3::zero()
        };
        Self { value: y.atan2(x0), slope }
    }
    #[inline(always)]
    fn quotient(self, o: Self) -> Self {
        let value = self.value / o.value;
        Self { value, slope: (self.slope - o.slope * value) / o.value }
    }
    fn remainder(self, o: Self) -> Self {
        let turns = (self.value.re() / o.value.re()).floor();
        Self { value: remainder(self.value, o.value), slope: self.slope - o.slope * T::from(turns) }
    }
}

/// A value with its gradient and its matrix of second derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hessian<T> {
    /// The value.
    pub value: T,
    /// The gradient.
    pub slope: Vec3<T>,
    /// The rows of second derivatives; symmetric.
    pub second: [Vec3<T>; 3],
}

impl<T: Real> Hessian<T> {
    fn chained(self, (value, d1, d2): (T, T, T)) -> Self {
        let mut second = self.second.map(|row| row * d1);
        for k in 0..3 {
            second[k] += self.slope * (self.slope[k] * d2);
        }
        Self { value, slope: self.slope * d1, second }
    }

    fn zip(self, o: Self, f: impl Fn(T, T) -> T) -> Self {
        let rows = |a: Vec3<T>, b: Vec3<T>| Vec3::new(f(a.x, b.x), f(a.y, b.y), f(a.z, b.z));
        let second = [0, 1, 2].map(|k| rows(self.second[k], o.second[k]));
        Self { value: f(self.value, o.value), slope: rows(self.slope, o.slope), second }
    }
}

impl<T: Real> Algebra<T> for Hessian<T> {
    type At = Vec3<T>;
    fn real(x: T) -> Self {
        Self { value: x, ..Self::default() }
    }
    fn plane(n: Vec3<T>, offset: T, p: &Vec3<T>) -> Self {
        Self { value: T::plane(n, offset, p), slope: n, ..Self::default() }
    }
    fn user(oracle: &dyn Oracle<T>, map: &Affine<T>, p: &Vec3<T>) -> Self {
        let (value, g, second) = oracle.second_order(map.apply(*p));
        Self { value, slope: map.pull_back(g), second: map.pull_back_matrix(second) }
    }
    fn sum(self, o: Self) -> Self {
        self.zip(o, |a, b| a + b)
    }
    fn difference(self, o: Self) -> Self {
        self.zip(o, |a, b| a - b)
    }
    fn times(self, o: Self) -> Self {
        let second = [0, 1, 2].map(|k| {
            self.second[k] * o.value
                + o.second[k] * self.value
                + self.slope * o.slope[k]
                + o.slope * self.slope[k]
        });
        let slope = self.slope * o.value + o.slope * self.value;
        Self { value: self.value * o.value, slope, second }
    }
    fn plus_real(self, c: T) -> Self {
        Self { value: self.value + c, ..self }
    }
    fn times_real(self, c: T) -> Self {
        self.chained((self.value * c, c, T::zero()))
    }
    fn over_real(self, c: T) -> Self {
        Self { value: self.value / c, slope: self.slope / c, second: self.second.map(|r| r / c) }
    }
    fn power(self, n: u32) -> Self {
        let x = self.value;
        match n {
            0 => Self::real(T::one()),
            1 => self,
            _ => {
                let d1 = power(x, n - 1) * f64::from(n);
                let d2 = power(x, n - 2) * (f64::from(n) * f64::from(n - 1));
                self.chained((power(x, n), d1, d2))
            }
        }
    }
    fn unary(self, f: Unary) -> Self {
        self.chained(f.jet(self.value))
    }
    fn smaller(self, o: Self) -> Self {
        if o.value.re() < self.value.re() { o } else { self }
    }
    fn larger(self, o: Self) -> Self {
        if o.value.re() > self.value.re() { o } else { self }
    }
    fn angle(self, x: Self) -> Self {
        // The angle's gradient is (x dy - y dx) / (x^2 + y^2); once more by the quotient rule.
        let (y0, x0) = (self.value, x.value);
        let size = x0 * x0 + y0 * y0;
        if size.re() == 0.0 {
            return Self::real(y0.atan2(x0));
        }
        let (yx, yy) = (x0 / size, -(y0 / size));
        let (ss, cross) = (size * size, x0 * y0 * 2.0);
        let (a_yy, a_xy) = (-(cross / ss), (y0 * y0 - x0 * x0) / ss);
        let (gy, gx) = (self.slope, x.slope);
        let second = [0, 1, 2].map(|k| {
            self.second[k] * yx
                + x.second[k] * yy
                + gy * (gy[k] * a_yy)
                + (gy * gx[k] + gx * gy[k]) * a_xy
                + gx * (gx[k] * -a_yy)
        });
        Self { value: y0.atan2(x0), slope: gy * yx + gx * yy, second }
    }
    fn quotient(self, o: Self) -> Self {
        let value = self.value / o.value;
        let inverse = o.unary(Unary::Reciprocal);
        Self { value, ..self.times(inverse) }
    }
    fn remainder(self, o: Self) -> Self {
        let turns = T::from((self.value.re() / o.value.re()).floor());
        Self {
            value: remainder(self.value, o.value),
            slope: self.slope - o.slope * turns,
            second: [0, 1, 2].map(|k| self.second[k] - o.second[k] * turns),
        }
    }
}

impl Algebra<f64> for Interval {
    type At = [Interval; 3];
    #[inline(always)]
    fn real(x: f64) -> Self {
        Interval::point(x)
    }
    #[inline(always)]
    fn plane(n: Vec3, offset: f64, at: &[Interval; 3]) -> Self {
        // Terms without weight are exact zeros, left out to keep the range tight.
        let mut sum = Interval::ZERO;
        let mut first = true;
        for k in 0..3 {
            if n[k] == 0.0 {
                continue;
            }
            let term = if n[k] == 1.0 { at[k] } else { at[k].scaled(n[k]) };
            sum = if first { term } else { sum + term };
            first = false;
        }
        if offset == 0.0 { sum } else { sum + Interval::point(offset) }
    }
    fn user(oracle: &dyn Oracle<f64>, map: &Affine<f64>, at: &[Interval; 3]) -> Self {
        let local = map.range(at);
        let low = Vec3::new(local[0].low, local[1].low, local[2].low);
        let high = Vec3::new(local[0].high, local[1].high, local[2].high);
        oracle.range(&Box3 { low, high })
    }
    #[inline(always)]
    fn sum(self, o: Self) -> Self {
        self + o
    }
    #[inline(always)]
    fn difference(self, o: Self) -> Self {
        self - o
    }
    #[inline(always)]
    fn times(self, o: Self) -> Self {
        self * o
    }
    #[inline(always)]
    fn plus_real(self, c: f64) -> Self {
        self + Interval::point(c)
    }
    #[inline(always)]
    fn times_real(self, c: f64) -> Self {
        self.scaled(c)
    }
    fn over_real(self, c: f64) -> Self {
        self.divided(c)
    }
    #[inline(always)]
    fn power(self, n: u32) -> Self {
        if n == 2 { self.square() } else { self.powi(n) }
    }
    fn unary(self, f: Unary) -> Self {
        f.range(self)
    }
    #[inline(always)]
    fn smaller(self, o: Self) -> Self {
        self.min(o)
    }
    #[inline(always)]
    fn larger(self, o: Self) -> Self {
        self.max(o)
    }
    fn angle(self, x: Self) -> Self {
        self.atan2(x)
    }
    fn quotient(self, o: Self) -> Self {
        if o.low == o.high && o.low != 0.0 { self.divided(o.low) } else { self * o.reciprocal() }
    }
    fn remainder(self, o: Self) -> Self {
        Interval::remainder(self, o)
    }
}

/// The ranges of a value and of its slopes over a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GradientRange {
    /// Range of the value.
    pub value: Interval,
    /// Ranges of the derivatives; at a kink of the function, ranges of the slopes of its chords.
    pub slope: [Interval; 3],
}

impl GradientRange {
    fn chained(self, value: Interval, d1: Interval) -> Self {
        let flat = self.slope == [Interval::ZERO; 3];
        let slope = if flat { self.slope } else { self.slope.map(|g| g * d1) };
        Self { value, slope }
    }

    fn zip(self, o: Self, f: impl Fn(Interval, Interval) -> Interval) -> Self {
        let slope = [0, 1, 2].map(|k| f(self.slope[k], o.slope[k]));
        Self { value: f(self.value, o.value), slope }
    }
}

impl Algebra<f64> for GradientRange {
    type At = [Interval; 3];
    fn real(x: f64) -> Self {
        Self { value: Interval::point(x), slope: [Interval::ZERO; 3] }
    }
    fn plane(n: Vec3, offset: f64, at: &[Interval; 3]) -> Self {
        let slope = [n.x, n.y, n.z].map(Interval::point);
        Self { value: Interval::plane(n, offset, at), slope }
    }
    fn user(oracle: &dyn Oracle<f64>, map: &Affine<f64>, at: &[Interval; 3]) -> Self {
        let local = map.range(at);
        let low = Vec3::new(local[0].low, local[1].low, local[2].low);
        let high = Vec3::new(local[0].high, local[1].high, local[2].high);
        let b = Box3 { low, high };
        Self { value: oracle.range(&b), slope: map.pull_back_range(oracle.gradient_range(&b)) }
    }
    fn sum(self, o: Self) -> Self {
        self.zip(o, |a, b| a + b)
    }
    fn difference(self, o: Self) -> Self {
        self.zip(o, |a, b| a - b)
    }
    fn times(self, o: Self) -> Self {
        let slope = [0, 1, 2].map(|k| self.slope[k] * o.value + o.slope[k] * self.value);
        Self { value: self.value * o.value, slope }
    }
    fn plus_real(self, c: f64) -> Self {
        Self { value: self.value.plus_real(c), ..self }
    }
    fn times_real(self, c: f64) -> Self {
        Self { value: self.value.scaled(c), slope: self.slope.map(|g| g.scaled(c)) }
    }
    fn over_real(self, c: f64) -> Self {
        Self { value: self.value.divided(c), slope: self.slope.map(|g| g.divided(c)) }
    }
    fn power(self, n: u32) -> Self {
        if n == 0 {
            return Self::real(1.0);
        }
        let d1 = self.value.powi(n - 1).scaled(f64::from(n));
        self.chained(self.value.power(n), d1)
    }
    fn unary(self, f: Unary) -> Self {
        self.chained(f.range(self.value), f.slope(self.value))
    }
    fn smaller(self, o: Self) -> Self {
        if self.value.high < o.value.low {
            self
        } else if o.value.high < self.value.low {
            o
        } else {
            let value = self.value.min(o.value);
            Self { value, slope: [0, 1, 2].map(|k| self.slope[k].hull(o.slope[k])) }
        }
    }
    fn larger(self, o: Self) -> Self {
        if self.value.low > o.value.high {
            self
        } else if o.value.low > self.value.high {
            o
        } else {
            let value = self.value.max(o.value);
            Self { value, slope: [0, 1, 2].map(|k| self.slope[k].hull(o.slope[k])) }
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
        Self { value, slope }
    }
    fn quotient(self, o: Self) -> Self {
        let inverse = o.unary(Unary::Reciprocal);
        Self { value: Algebra::quotient(self.value, o.value), ..self.times(inverse) }
    }
    fn remainder(self, o: Self) -> Self {
        let value = Interval::remainder(self.value, o.value);
        let slope = match Interval::turns(self.value, o.value) {
            Some(n) => [0, 1, 2].map(|k| self.slope[k] - o.slope[k].scaled(n)),
            None => [Interval::ENTIRE; 3],
        };
        Self { value, slope }
    }
}
