//! Reparametrizations from others: by arc length, copied, inverted.

use crate::faults::parameter;
use crate::third_derivatives::standstill;
use moldloft_num::{
    Composed, Order, Real, Reparametrization, ReparametrizationJet, inv_reparametrization_in,
};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, ReparametrizationRef, Value};
use moldloft_spline as spline;
use std::sync::Arc;

/// Slope of a law below which its inverse has no derivative.
const NO_SLOPE: f64 = 1e-9;

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

/// Accuracy of lengths relative to the total length.
const LENGTH_ACCURACY: f64 = 1e-13;

/// Entries of the arc-length table per smooth piece.
const PLACES: usize = 16;

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
        let mut ends = vec![0.0];
        ends.extend(curve.breaks());
        ends.push(1.0);
        if let Some(t) = standstill(&curve, &ends, NO_SLOPE * rough) {
            return Err(CallError::new("zero-slope", "the curve has zero speed at an inner point")
                .expected("a curve that moves everywhere")
                .found(format!("no speed at t = {}", parameter(t)))
                .related(curve.key, "is the curve")
                .help("take a part of the curve without this point")
                .in_field(Self::CURVE));
        }
        let mut places = vec![0.0];
        for &end in &ends[1..] {
            let begin = places[places.len() - 1];
            places.extend((1..PLACES).map(|k| begin + (end - begin) * k as f64 / PLACES as f64));
            places.push(end);
        }
        let accuracy = LENGTH_ACCURACY * rough;
        let mut lengths = vec![T::zero()];
        for w in places.windows(2) {
            let step = spline::arclen(&*curve, T::from(w[0]), T::from(w[1]), accuracy);
            lengths.push(lengths[lengths.len() - 1] + step);
        }
        let law = ByLength { curve, places, lengths, accuracy };
        Ok(Value::Relabel(ReparametrizationRef::new(law, context.nesting)))
    }
}

struct ByLength<T: Real> {
    curve: CurveRef<T>,
    /// Parameters from 0 to 1.
    places: Vec<f64>,
    /// The length up to each of them.
    lengths: Vec<T>,
    accuracy: f64,
}

impl<T: Real> ByLength<T> {
    fn total(&self) -> T {
        self.lengths[self.lengths.len() - 1]
    }

    /// The parameter at the fraction `t` of the length, with derivatives.
    fn parameter(&self, t: T) -> T {
        let total = self.total();
        if t.re() == 0.0 || t.re() == 1.0 {
            // Exact; a derivative of t itself counts.
            let speed = self.curve.jet(T::from(t.re()), Order::First)[1].norm();
            return (t - t.re()) * (total / speed) + t.re();
        }
        let wanted = t * total;
        let at = self.lengths.partition_point(|s| s.re() < wanted.re());
        let at = at.clamp(1, self.places.len() - 1);
        let (low, high) = (self.places[at - 1], self.places[at]);
        let rest = wanted - self.lengths[at - 1];
        let along =
            |to: f64| spline::arclen(&*self.curve, T::from(low), T::from(to), self.accuracy);
        let speed = |t: f64| self.curve.jet(T::from(t), Order::First)[1].norm();
        let step = self.lengths[at].re() - self.lengths[at - 1].re();
        let (mut below, mut above) = (low, high);
        let mut x = low + (high - low) * (rest.re() / step).clamp(0.0, 1.0);
        // The bracket halves or Newton doubles the digits.
        for _ in 0..64 {
            let miss = along(x).re() - rest.re();
            if miss.abs() <= self.accuracy {
                break;
            }
            if miss > 0.0 {
                above = x
            } else {
                below = x
            }
            let next = x - miss / speed(x).re();
            let next = if below < next && next < above { next } else { 0.5 * (below + above) };
            if next == x {
                break;
            }
            x = next;
        }
        let correction = (rest - along(x)) / speed(x);
        correction - correction.re() + x
    }

    fn inside(&self, t: T, order: Order) -> ReparametrizationJet<T> {
        let r = self.parameter(t);
        if order == Order::Zero {
            return [r, T::zero(), T::zero()];
        }
        let [_, d, dd] = self.curve.jet(r, order);
        let (speed, total) = (d.norm(), self.total());
        let slope = total / speed;
        [
            r,
            slope,
            if order == Order::Second {
                -slope * slope * (d.dot(dd) / (speed * speed))
            } else {
                T::zero()
            },
        ]
    }
}

/// Linear continuation outside [0, 1].
fn continued<T: Real>(
    t: T,
    order: Order,
    inside: impl Fn(T, Order) -> ReparametrizationJet<T>,
) -> ReparametrizationJet<T> {
    let end = match t.re() {
        x if x < 0.0 => 0.0,
        x if x > 1.0 => 1.0,
        _ => return inside(t, order),
    };
    let [r, slope, _] = inside(T::from(end), Order::First);
    [r + slope * (t - end), slope, T::zero()]
}

impl<T: Real> Reparametrization<T> for ByLength<T> {
    fn jet(&self, t: T, order: Order) -> ReparametrizationJet<T> {
        continued(t, order, |t, order| self.inside(t, order))
    }

    fn breaks(&self) -> Vec<f64> {
        let breaks = self.curve.breaks();
        let total = self.total().re();
        let length = |b: &f64| {
            let at = self.places.partition_point(|p| p < b);
            self.lengths[at].re() / total
        };
        breaks.iter().map(length).collect()
    }
}

/// A copy of the reparametrisation of another curve, so that neighbours match: the identity for a
/// curve without one, that of the original for an image.
#[derive(Kind)]
#[kind(
    class = Relabel,
    columns = "curve",
    example = "CosRelabel cosine(); AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(4, 2, 1); \
               BCurve c({A, B, C}, relabel = cosine); CopyRelabel r(c); Line l(A, C, relabel = r);"
)]
pub struct CopyRelabel<T: Real> {
    /// Curve whose relabel is copied.
    curve: CurveRef<T>,
}

impl<T: Real> Build<T> for CopyRelabel<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        Ok(Value::Relabel(match self.curve.law() {
            Some(law) => ReparametrizationRef::shared(law, context.nesting),
            None => ReparametrizationRef::new(spline::ReparametrizationForm::identity(), 0),
        }))
    }
}

/// The inverse of a relabel: R(t) is the parameter at which the other has the value t. The other
/// must have a nonzero slope at both ends.
#[derive(Kind)]
#[kind(
    class = Relabel,
    columns = "relabel",
    example = "CosRelabel cosine(\"both\", 0.9); InvRelabel r(cosine);"
)]
pub struct InvRelabel<T: Real> {
    /// The relabel to undo.
    relabel: ReparametrizationRef<T>,
}

impl<T: Real> Build<T> for InvRelabel<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let law = self.relabel;
        for end in [0.0, 1.0] {
            let [value, slope, _] = law.jet(T::from(end), Order::First).map(Real::re);
            if value != end {
                return Err(CallError::new("wrong-ends", "a partial relabel cannot be undone")
                    .expected(format!("the value {end} at t = {end}"))
                    .found(value.to_string())
                    .related(law.key, "is the relabel")
                    .in_field(Self::RELABEL));
            }
            if slope < NO_SLOPE {
                return Err(CallError::new("zero-slope", "this relabel cannot be undone")
                    .expected("a slope at both ends")
                    .found(format!("the slope {slope} at t = {end}"))
                    .related(law.key, "is the relabel")
                    .help("give it a weight below 1, or leave it away on the parent")
                    .in_field(Self::RELABEL));
            }
        }
        Ok(Value::Relabel(ReparametrizationRef::new(Inverse { law }, context.nesting)))
    }
}

struct Inverse<T: Real> {
    law: ReparametrizationRef<T>,
}

impl<T: Real> Reparametrization<T> for Inverse<T> {
    fn jet(&self, t: T, order: Order) -> ReparametrizationJet<T> {
        continued(t, order, |t, order| {
            let x = inv_reparametrization_in(&*self.law, t);
            if order == Order::Zero {
                return [x, T::zero(), T::zero()];
            }
            let [_, d, dd] = self.law.jet(x, order);
            let slope = T::one() / d;
            [x, slope, -dd * slope * slope * slope]
        })
    }

    fn breaks(&self) -> Vec<f64> {
        let value = |b: f64| self.law.jet(T::from(b), Order::Zero)[0].re();
        self.law.breaks().into_iter().map(value).collect()
    }

    fn is_straight(&self) -> bool {
        self.law.is_straight()
    }
}

/// Composition of relabels: {a, b} gives R(t) = b(a(t)).
///
/// On a curve that is relabelled by b already, a relabel by a is the same.
#[derive(Kind)]
#[kind(
    class = Relabel,
    columns = "relabels",
    example = "CosRelabel cosine(); GeoRelabel growth(3); ComposeRelabel r({growth, cosine});"
)]
pub struct ComposeRelabel<T: Real> {
    /// Relabels in order of application.
    #[field(min_items = 1)]
    relabels: Vec<ReparametrizationRef<T>>,
}

impl<T: Real> Build<T> for ComposeRelabel<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let laws = self.relabels.iter().map(|r| r.law().clone());
        let law = laws.reduce(|first, second| Arc::new(Composed { first, second }));
        Ok(Value::Relabel(match law {
            Some(law) => ReparametrizationRef::shared(law, context.nesting),
            None => ReparametrizationRef::new(spline::ReparametrizationForm::identity(), 0),
        }))
    }
}
