//! Reparametrizations from others: copied, inverted, composed.

use moldloft_num::{
    Composed, Order, Real, Reparametrization, ReparametrizationJet, inv_reparametrization_in,
};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, ReparametrizationRef, Value};
use moldloft_spline as spline;
use std::sync::Arc;

/// Slope of a law below which its inverse has no derivative.
pub(super) const NO_SLOPE: f64 = 1e-9;

/// Linear continuation outside [0, 1].
pub(super) fn continued<T: Real>(
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
