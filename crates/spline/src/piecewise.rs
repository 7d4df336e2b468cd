//! Curves of cubic polynomials between knots that are scalars of their own, so that derivatives by them are known.

use moldloft_num::{Curve, CurveJet, Order, Real, Vec3};
use smallvec::SmallVec;

/// A curve of cubic polynomials between knots that may carry derivatives.
///
/// Piece `k` holds the coefficients of 1, s, s^2, s^3 with `s = t - knots[k]`. There is one piece per
/// knot: the last continues the one before from its far end, so the value at each knot, the last
/// included, is its constant coefficient to the bit.
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseCubic<T: Real> {
    knots: SmallVec<[T; 5]>,
    coefficients: SmallVec<[[Vec3<T>; 4]; 5]>,
}

impl<T: Real> PiecewiseCubic<T> {
    /// The cubic Hermite curve through `points` at ascending `knots` with the given `slopes`; the
    /// three lists have the same length, at least two.
    pub fn hermite(knots: &[T], points: &[Vec3<T>], slopes: &[Vec3<T>]) -> Self {
        let mut coefficients = SmallVec::with_capacity(knots.len());
        for k in 0..knots.len() - 1 {
            let shrink = T::one() / (knots[k + 1] - knots[k]);
            let chord = (points[k + 1] - points[k]) * shrink;
            let (at_start, at_end) = (slopes[k] - chord, slopes[k + 1] - chord);
            let cubic = (at_start + at_end) * shrink;
            let quadratic = -(at_start * shrink) - cubic;
            coefficients.push([points[k], slopes[k], quadratic, cubic * shrink]);
        }
        Self::closed_off(knots, coefficients, points[points.len() - 1])
    }

    /// The curve of these polynomials, one per knot except the last, where it passes through `end`;
    /// see the type. Continuity at the knots is not enforced.
    pub fn of_pieces(knots: &[T], coefficients: &[[Vec3<T>; 4]], end: Vec3<T>) -> Self {
        Self::closed_off(knots, SmallVec::from_slice(coefficients), end)
    }

    /// The piecewise curve of these coefficients, one set per knot but the last, where it passes
    /// through `end`.
    pub(crate) fn closed_off(
        knots: &[T],
        mut coefficients: SmallVec<[[Vec3<T>; 4]; 5]>,
        end: Vec3<T>,
    ) -> Self {
        let last = coefficients.len() - 1;
        let (s, [_, b, c, d]) = (knots[last + 1] - knots[last], coefficients[last]);
        let slope = (d * (s * 3.0) + c.map(|x| x * 2.0)) * s + b;
        coefficients.push([end, slope, d * (s * 3.0) + c, d]);
        Self { knots: SmallVec::from_slice(knots), coefficients }
    }

    /// The knots, first and last parameter included.
    pub fn knots(&self) -> &[T] {
        &self.knots
    }

    /// The coefficients of each piece; see the type.
    pub fn coefficients(&self) -> &[[Vec3<T>; 4]] {
        &self.coefficients
    }

    /// The piece in charge at `t`: the first for `t` before all knots, the last after them.
    #[inline(always)]
    fn piece(&self, t: f64) -> usize {
        let inner = &self.knots[1..];
        if inner.len() <= 8 {
            inner.iter().map(|k| usize::from(k.re() <= t)).sum()
        } else {
            inner.partition_point(|k| k.re() <= t)
        }
    }

    /// The position at `t`.
    #[inline(always)]
    pub fn eval(&self, t: T) -> Vec3<T> {
        let k = self.piece(t.re());
        let (s, [a, b, c, d]) = (t - self.knots[k], self.coefficients[k]);
        ((d * s + c) * s + b) * s + a
    }

    /// The positions at `ts`, in any order.
    ///
    /// The polynomials are first moved to the real parts of their knots, so that each point takes
    /// products with plain numbers only, whatever the scalar.
    pub fn eval_many(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        let fixed = self.with_fixed_knots();
        for (x, &t) in out.iter_mut().zip(ts) {
            let (s, [a, b, c, d]) = fixed.at(t);
            *x = step(step(step(*d, s, *c), s, *b), s, *a);
        }
    }

    /// Positions and derivatives at `ts` to `order`, in any order of `ts`; see
    /// [`PiecewiseCubic::eval_many`].
    pub fn jets_many(&self, ts: &[f64], order: Order, out: &mut [CurveJet<T>]) {
        let fixed = self.with_fixed_knots();
        for (x, &t) in out.iter_mut().zip(ts) {
            let (s, [a, b, c, d]) = fixed.at(t);
            *x = [step(step(step(*d, s, *c), s, *b), s, *a), Vec3::default(), Vec3::default()];
            if order >= Order::First {
                x[1] = step(step(d.map(|x| x * 3.0), s, c.map(|x| x * 2.0)), s, *b);
            }
            if order == Order::Second {
                x[2] = step(d.map(|x| x * 6.0), s, c.map(|x| x * 2.0));
            }
        }
    }

    /// The same curve in powers of the distance from the real part of each knot.
    fn with_fixed_knots(&self) -> FixedKnots<T> {
        let mut fixed = FixedKnots {
            knots: self.knots.iter().map(|k| k.re()).collect(),
            coefficients: self.coefficients.clone(),
        };
        for (k, c) in self.knots.iter().zip(&mut fixed.coefficients) {
            if k.is_constant() {
                continue;
            }
            // Taylor's shift by the derivative part of the knot, as repeated Horner steps.
            let shift = -*k + k.re();
            for from in 0..3 {
                for j in (from..3).rev() {
                    let higher = c[j + 1] * shift;
                    c[j] += higher;
                }
            }
        }
        fixed
    }
}

/// See [`PiecewiseCubic::with_fixed_knots`].
struct FixedKnots<T> {
    knots: SmallVec<[f64; 5]>,
    coefficients: SmallVec<[[Vec3<T>; 4]; 5]>,
}

impl<T: Real> FixedKnots<T> {
    /// The distance from the knot before `t`, and the coefficients there.
    #[inline(always)]
    fn at(&self, t: f64) -> (f64, &[Vec3<T>; 4]) {
        let inner = &self.knots[1..];
        let k = if inner.len() <= 8 {
            inner.iter().map(|&k| usize::from(k <= t)).sum()
        } else {
            inner.partition_point(|&k| k <= t)
        };
        (t - self.knots[k], &self.coefficients[k])
    }
}

/// One step of Horner's rule with a plain number: high * s + low.
#[inline(always)]
fn step<T: Real>(high: Vec3<T>, s: f64, low: Vec3<T>) -> Vec3<T> {
    high.map(|x| x * s) + low
}

impl<T: Real> Curve<T> for PiecewiseCubic<T> {
    #[inline]
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        let k = self.piece(t.re());
        let (s, [a, b, c, d]) = (t - self.knots[k], self.coefficients[k]);
        let mut jet = [Vec3::zero(); 3];
        if s.is_constant() {
            // The same operations, without the products of derivatives that are zero.
            let s = s.re();
            jet[0] = step(step(step(d, s, c), s, b), s, a);
            if order >= Order::First {
                jet[1] = step(step(d, s * 3.0, c.map(|x| x * 2.0)), s, b);
            }
            if order == Order::Second {
                jet[2] = step(d, s * 6.0, c.map(|x| x * 2.0));
            }
            return jet;
        }
        jet[0] = ((d * s + c) * s + b) * s + a;
        if order >= Order::First {
            jet[1] = (d * (s * 3.0) + c.map(|x| x * 2.0)) * s + b;
        }
        if order == Order::Second {
            jet[2] = d * (s * 6.0) + c.map(|x| x * 2.0);
        }
        jet
    }

    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        self.eval_many(ts, out);
    }

    fn breaks(&self) -> Vec<f64> {
        // Between pieces that are the same polynomial nothing jumps, but rounding hides which.
        self.knots[1..self.knots.len() - 1].iter().map(|k| k.re()).collect()
    }

    moldloft_num::curve_facts!(broken, open, not_rational);
}
