//! Reparametrizations by arc length.

use super::derived::{NO_SLOPE, continued};
use crate::faults::parameter;
use crate::third_derivatives::standstill;
use moldloft_num::{Order, Real, Reparametrization, ReparametrizationJet};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, ReparametrizationRef, Value};
use moldloft_spline as spline;
use std::f64::consts::PI;

/// A redistribution by arc length: R is the inverse of s(t) / L, with s the arc length along a
/// curve and L its total, so that equal steps of t are equal lengths.
///
/// Intended as the relabel of a curve of the same shape: a copy, a neighbour, or a curve on the
/// same points. The curve must have non-zero speed everywhere.
#[derive(Kind)]
#[kind(
    class = Relabel,
    columns = "curve",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(4, 2, 1); BCurve c({A, B, C}); \
               ArcLenRelabel r(c); BCurve even({A, B, C}, relabel = r);"
)]
pub struct ArcLenRelabel<T: Real> {
    /// Curve whose arc length is used.
    curve: CurveRef<T>,
}

/// Accuracy of lengths, relative to the whole length.
const LENGTH_ACCURACY: f64 = 1e-14;

/// Number of samples of the speed on a piece.
const NODES: usize = 16;

/// Maximum number of halvings of a piece: beyond, a kink remains.
const MOST_HALVINGS: u32 = 24;

impl<T: Real> Build<T> for ArcLenRelabel<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let curve = self.curve;
        let rough = spline::arclen(&*curve, T::zero(), T::one(), 1e-6).re();
        let slope = |t: f64| curve.jet(T::from(t), Order::First)[1].re().norm();
        if !rough.is_finite() || slope(0.0).min(slope(1.0)) <= NO_SLOPE * rough || rough == 0.0 {
            return Err(CallError::new("zero-slope", "zero tangent at an end")
                .expected("a curve that moves at t = 0 and t = 1")
                .found(format!("the speeds {} and {}", slope(0.0), slope(1.0)))
                .related(curve.key, "is the curve")
                .help("take the curve without a relabel that is dense at its ends")
                .in_field(Self::CURVE));
        }
        let ends = spline::smooth_pieces(&*curve, T::zero(), T::one());
        let plain: Vec<f64> = ends.iter().map(|t| t.re()).collect();
        if let Some(t) = standstill(&curve, &plain, NO_SLOPE * rough) {
            return Err(CallError::new("zero-slope", "the curve has zero speed at an inner point")
                .expected("a curve that moves everywhere")
                .found(format!("no speed at t = {}", parameter(t)))
                .related(curve.key, "is the curve")
                .help("take a part of the curve without this point")
                .in_field(Self::CURVE));
        }
        let law = ByLength::of(curve, &ends, LENGTH_ACCURACY * rough);
        Ok(Value::Relabel(ReparametrizationRef::new(law, context.nesting)))
    }
}

/// A part of a curve with its length as a polynomial.
struct LengthPiece<T> {
    /// Parameters at its ends.
    ends: [T; 2],
    /// The length before it.
    before: T,
    /// The rate of the length by y, which is from -1 to 1 along the piece, and the length from y = -1: coefficients
    /// of Chebyshev polynomials.
    rate: [T; NODES],
    length: [T; NODES + 1],
}

/// Clenshaw's recurrence at `y`.
fn chebyshev<T: Real>(coefficients: &[T], y: f64) -> T {
    let (mut b, mut c) = (T::zero(), T::zero());
    for a in coefficients[1..].iter().rev() {
        (b, c) = (*a + b * (2.0 * y) - c, b);
    }
    coefficients[0] + b * y - c
}

impl<T: Real> LengthPiece<T> {
    /// The piece between two parameters, and the magnitude of its last coefficients.
    fn new(curve: &CurveRef<T>, ends: [T; 2], before: T) -> (Self, f64) {
        let [middle, half] = [(ends[0] + ends[1]) * 0.5, (ends[1] - ends[0]) * 0.5];
        let angle = |k: usize| PI * (k as f64 + 0.5) / NODES as f64;
        let samples: [T; NODES] = std::array::from_fn(|k| {
            let t = middle + half * Real::cos(angle(k));
            curve.jet(t, Order::First)[1].norm() * half
        });
        let coefficient = |j: usize| {
            let term = |k: usize| samples[k] * Real::cos(j as f64 * angle(k));
            let sum = (0..NODES).fold(T::zero(), |sum, k| sum + term(k));
            sum * (if j == 0 { 1.0 } else { 2.0 } / NODES as f64)
        };
        let rate: [T; NODES] = std::array::from_fn(coefficient);
        let mut length = [T::zero(); NODES + 1];
        for j in 1..=NODES {
            let lower = rate[j - 1] * if j == 1 { 2.0 } else { 1.0 };
            let upper = rate.get(j + 1).copied().unwrap_or_else(T::zero);
            length[j] = (lower - upper) * (0.5 / j as f64);
        }
        length[0] = -chebyshev(&length, -1.0);
        let rest = rate[NODES - 2..].iter().map(|c| c.re().abs()).sum();
        (Self { ends, before, rate, length }, rest)
    }

    fn whole(&self) -> T {
        chebyshev(&self.length, 1.0)
    }

    /// The parameter at a length from its beginning.
    fn parameter(&self, rest: T, accuracy: f64) -> T {
        let (rate, length) = (self.rate.map(|c| c.re()), self.length.map(|c| c.re()));
        let wanted = rest.re();
        let (mut below, mut above) = (-1.0, 1.0);
        let mut y = (2.0 * wanted / chebyshev(&length, 1.0) - 1.0).clamp(below, above);
        // The bracket halves or Newton doubles the digits.
        for _ in 0..64 {
            let miss = chebyshev(&length, y) - wanted;
            if miss.abs() <= accuracy {
                break;
            }
            if miss > 0.0 {
                above = y;
            } else {
                below = y;
            }
            let next = y - miss / chebyshev(&rate, y);
            let next = if below < next && next < above { next } else { 0.5 * (below + above) };
            if next == y {
                break;
            }
            y = next;
        }
        // One step in `T` has the derivatives, and the last digits.
        let step = (rest - chebyshev(&self.length, y)) / chebyshev(&rate, y);
        let [low, high] = self.ends;
        (low + high) * 0.5 + (high - low) * 0.5 * (step + y)
    }
}

struct ByLength<T: Real> {
    curve: CurveRef<T>,
    pieces: Vec<LengthPiece<T>>,
    total: T,
    /// Fractions of the length at the breaks of the curve.
    breaks: Vec<f64>,
    accuracy: f64,
}

impl<T: Real> ByLength<T> {
    /// The law of a curve between `ends` of its smooth pieces.
    fn of(curve: CurveRef<T>, ends: &[T], accuracy: f64) -> Self {
        let (mut pieces, mut breaks) = (Vec::new(), Vec::new());
        let mut total = T::zero();
        for w in ends.windows(2) {
            breaks.push(total.re());
            let mut begin = w[0];
            let mut open = vec![(w[1], 0)];
            while let Some((end, halvings)) = open.pop() {
                let (piece, rest) = LengthPiece::new(&curve, [begin, end], total);
                if rest > accuracy && halvings < MOST_HALVINGS {
                    let middle = (begin + end) * 0.5;
                    open.extend([(end, halvings + 1), (middle, halvings + 1)]);
                    continue;
                }
                total += piece.whole();
                pieces.push(piece);
                begin = end;
            }
        }
        let breaks = breaks[1..].iter().map(|s| s / total.re()).collect();
        Self { curve, pieces, total, breaks, accuracy }
    }

    /// The parameter at the fraction `t` of the length, with derivatives.
    fn parameter(&self, t: T) -> T {
        if t.re() == 0.0 || t.re() == 1.0 {
            // Exact; a derivative of t itself counts.
            let speed = self.curve.jet(T::from(t.re()), Order::First)[1].norm();
            return (t - t.re()) * (self.total / speed) + t.re();
        }
        let wanted = t * self.total;
        let at = self.pieces[1..].partition_point(|piece| piece.before.re() <= wanted.re());
        let piece = &self.pieces[at];
        piece.parameter(wanted - piece.before, self.accuracy)
    }

    fn inside(&self, t: T, order: Order) -> ReparametrizationJet<T> {
        let r = self.parameter(t);
        if order == Order::Zero {
            return [r, T::zero(), T::zero()];
        }
        let [_, d, dd] = self.curve.jet(r, order);
        let speed = d.norm();
        let slope = self.total / speed;
        let bend = match order {
            Order::Second => -slope * slope * (d.dot(dd) / (speed * speed)),
            _ => T::zero(),
        };
        [r, slope, bend]
    }
}

impl<T: Real> Reparametrization<T> for ByLength<T> {
    fn jet(&self, t: T, order: Order) -> ReparametrizationJet<T> {
        continued(t, order, |t, order| self.inside(t, order))
    }

    fn breaks(&self) -> Vec<f64> {
        self.breaks.clone()
    }
}
