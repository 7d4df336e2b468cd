//! Monotone reparametrizations R of [0, 1]: their jets, inverses and composition.

use crate::Real;
use crate::jet::Jet;
use crate::roots::find_root;
use crate::shape::Order;
use std::sync::Arc;

/// Value, first and second derivative of a law; entries above the requested order are zero.
pub type ReparametrizationJet<T> = [T; 3];

/// A monotone law R of [0, 1] with R(0) = 0 and R(1) = 1 exactly: it redistributes the parameter of
/// a curve c to C(t) = c(R(t)). Partial laws have other values at the ends, and select a part of
/// the curve.
///
/// Its slope is positive inside; at the ends it may vanish. Outside [0, 1] it is the natural
/// continuation of its formula.
pub trait Reparametrization<T: Real>: Send + Sync {
    /// Value and derivatives at `t`, to `order`.
    fn jet(&self, t: T, order: Order) -> ReparametrizationJet<T>;

    /// Interior parameters at which a derivative up to the second may jump, ascending.
    fn breaks(&self) -> Vec<f64> {
        Vec::new()
    }

    /// True when the law is straight between its breaks.
    fn is_straight(&self) -> bool {
        false
    }
}

/// The law at a parameter that is a jet: the chain rule by Taylor's formula.
#[inline(always)]
pub fn lift_reparametrization<T: Real, J: Jet<T>>(jet: &ReparametrizationJet<T>, t: J) -> J {
    if J::ORDER == Order::Zero {
        return J::fixed(jet[0]);
    }
    let dt = t - J::fixed(t.value());
    let mut r = J::fixed(jet[0]) + dt.scaled(jet[1]);
    if J::ORDER == Order::Second {
        r += (dt * dt * 0.5).scaled(jet[2]);
    }
    r
}

/// The law's jet of a formula `at(t)` that is generic over jets, computed to the requested order.
#[doc(hidden)]
#[macro_export]
macro_rules! reparametrization_jet_of {
    ($self:expr, $at:path, $t:expr, $order:expr) => {{
        let (law, t, order) = ($self, $t, $order);
        match order {
            $crate::Order::Zero => [$at(law, t), Default::default(), Default::default()],
            $crate::Order::First => {
                let r = $at(law, $crate::Uni1::parameter(t));
                [r.f, r.t, Default::default()]
            }
            $crate::Order::Second => {
                let r = $at(law, $crate::Uni2::parameter(t));
                [r.f, r.t, r.tt]
            }
        }
    }};
}

/// The parameter t in [0, 1] with R(t) = `r`; 0 or 1 for values beyond the ends.
pub fn inv_reparametrization<T: Real>(law: &dyn Reparametrization<T>, r: f64) -> f64 {
    if r <= 0.0 {
        return 0.0;
    }
    if r >= 1.0 {
        return 1.0;
    }
    let above = |t: f64| law.jet(T::from(t), Order::Zero)[0].re() - r;
    find_root(above, 0.0, 1.0).unwrap_or(r)
}

/// As `inv_reparametrization`, with derivatives: the root in plain numbers, then one Newton step in
/// `T` (implicit function theorem). If the slope is zero the root has no derivatives.
pub fn inv_reparametrization_in<T: Real>(law: &dyn Reparametrization<T>, r: T) -> T {
    let t = inv_reparametrization(law, r.re());
    let [at, slope, _] = law.jet(T::from(t), Order::First);
    if slope.re() == 0.0 {
        return T::from(t);
    }
    let step = (r - at) / slope;
    step - step.re() + t
}

/// The composition of two laws: R(t) = `second`(`first`(t)).
pub struct Composed<T: Real> {
    /// The law applied to t.
    pub first: Arc<dyn Reparametrization<T>>,
    /// The law applied to the result of the first.
    pub second: Arc<dyn Reparametrization<T>>,
}

impl<T: Real> Reparametrization<T> for Composed<T> {
    fn jet(&self, t: T, order: Order) -> ReparametrizationJet<T> {
        let [a, a1, a2] = self.first.jet(t, order);
        let [b, b1, b2] = self.second.jet(a, order);
        [b, b1 * a1, b2 * a1 * a1 + b1 * a2]
    }

    fn breaks(&self) -> Vec<f64> {
        let mut all = self.first.breaks();
        let [low, high] = [0.0, 1.0].map(|t| self.first.jet(T::from(t), Order::Zero)[0].re());
        let reached = self.second.breaks().into_iter().filter(|b| low < *b && *b < high);
        all.extend(reached.map(|b| inv_reparametrization(&*self.first, b)));
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }

    fn is_straight(&self) -> bool {
        self.first.is_straight() && self.second.is_straight()
    }
}

impl<T: Real> dyn Reparametrization<T> + '_ {
    /// R at a parameter that is a jet of the caller's own parameters.
    pub fn at<J: Jet<T>>(&self, t: J) -> J {
        lift_reparametrization(&self.jet(t.value(), J::ORDER), t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Uni2;

    struct Square;
    impl Reparametrization<f64> for Square {
        fn jet(&self, t: f64, _: Order) -> ReparametrizationJet<f64> {
            [t * t, 2.0 * t, 2.0]
        }
    }

    #[test]
    fn laws_compose_and_invert() {
        let law = Composed { first: Arc::new(Square), second: Arc::new(Square) };
        let [r, d, dd] = law.jet(0.5, Order::Second);
        assert_eq!((r, d, dd), (0.0625, 0.5, 3.0));
        assert!((inv_reparametrization(&law, 0.0625) - 0.5).abs() < 1e-15);
        assert_eq!(
            (inv_reparametrization(&law, 0.0), inv_reparametrization(&law, 1.0)),
            (0.0, 1.0)
        );
        let lifted = (&law as &dyn Reparametrization<f64>).at(Uni2::parameter(0.5));
        assert_eq!((lifted.f, lifted.t, lifted.tt), (0.0625, 0.5, 3.0));
    }
}
