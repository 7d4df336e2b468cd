//! Curves of their own between point objects: what joins them to their neighbours.

use moldloft_num::trace::{Key, Trace};
use moldloft_num::{Curve, CurveJet, Order, Rational, Real, Vec3};

/// A curve of its own that begins and ends at point objects.
pub struct Ended<C> {
    /// The curve.
    pub curve: C,
    /// The point objects at its ends, where it has them.
    pub ends: [Option<Key>; 2],
}

impl<T: Real, C: Curve<T>> Curve<T> for Ended<C> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        self.curve.jet(t, order)
    }
    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        self.curve.grid(ts, out);
    }
    fn breaks(&self) -> Vec<f64> {
        self.curve.breaks()
    }
    fn joints(&self) -> Vec<f64> {
        self.curve.joints()
    }
    fn trace(&self) -> Trace<T> {
        Trace::Own(self.ends)
    }
    fn rational(&self) -> Rational<1> {
        self.curve.rational()
    }
}
