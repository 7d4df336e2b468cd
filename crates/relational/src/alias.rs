//! Curves that follow other roots than their own.

use moldloft_num::trace::Trace;
use moldloft_num::{Curve, CurveJet, Order, Real, Vec3};
use moldloft_registry::CurveRef;

/// A curve with the roots of another name: along an edge, or of an intersection.
pub(crate) struct AliasCurve<T: Real> {
    pub curve: CurveRef<T>,
    pub trace: Trace<T>,
}

impl<T: Real> Curve<T> for AliasCurve<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        self.curve.jet(t, order)
    }
    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        self.curve.grid(ts, out);
    }
    fn trace(&self) -> Trace<T> {
        self.trace.clone()
    }
    fn on_surface(&self, t: T, order: Order) -> Option<CurveJet<T>> {
        self.curve.on_surface(t, order)
    }

    moldloft_num::curve_facts!(breaks of [self.curve], closed of [self.curve], rational of [self.curve]);
}
