//! Shapes of the kinds.

use crate::Space;
use moldloft_num::trace::{Key, Trace};
use moldloft_num::{Curve, CurveJet, Order, Real, Vec3};
use moldloft_registry::SurfaceRef;
use moldloft_spline::{BSplineCurve, SplineError};

/// A spline curve that begins and ends at point objects.
pub(crate) struct AnchoredSpline<C> {
    pub curve: C,
    pub ends: [Option<Key>; 2],
}

/// Spline curve over [0, 1].
pub(crate) fn curve<T: Real>(
    space: &Space,
    points: &[Vec3<T>],
) -> Result<BSplineCurve<T>, SplineError> {
    let (knots, places) = space.knot_vector();
    BSplineCurve::new(knots, places.into_iter().map(|i| points[i]).collect(), None)
}

/// Rational spline curve over [0, 1].
pub(crate) fn rational<T: Real>(
    space: &Space,
    points: &[Vec3<T>],
    weights: &[f64],
) -> Result<BSplineCurve<T>, SplineError> {
    let (knots, places) = space.knot_vector();
    let each = places.iter().map(|&i| T::from(weights[i])).collect();
    BSplineCurve::new(knots, places.into_iter().map(|i| points[i]).collect(), Some(each))
}

impl<T: Real, C: Curve<T>> Curve<T> for AnchoredSpline<C> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        self.curve.jet(t, order)
    }
    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        self.curve.grid(ts, out);
    }
    fn breaks(&self) -> Vec<f64> {
        self.curve.breaks()
    }
    fn trace(&self) -> Trace<T> {
        Trace::Own(self.ends)
    }

    moldloft_num::curve_facts!(broken, open, not_rational);
}

/// The curve X(t) = S(w(t)) of a spline path w(t) = (u, v, 0) in the parameter plane of a surface.
pub(crate) struct SplineOnSurface<T: Real, P> {
    pub surface: SurfaceRef<T>,
    pub path: P,
    pub ends: [Option<Key>; 2],
}

impl<T: Real, P: Curve<T>> Curve<T> for SplineOnSurface<T, P> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        let [w, d, dd] = self.path.jet(t, order);
        let s = self.surface.jet(w.x, w.y, order);
        let mut jet = [s.p, s.u * d.x + s.v * d.y, s.u * dd.x + s.v * dd.y];
        jet[2] += s.uu * (d.x * d.x) + s.uv * (d.x * d.y * 2.0) + s.vv * (d.y * d.y);
        jet
    }
    fn breaks(&self) -> Vec<f64> {
        self.path.breaks()
    }
    fn trace(&self) -> Trace<T> {
        Trace::Own(self.ends)
    }
    fn on_surface(&self, t: T, order: Order) -> Option<CurveJet<T>> {
        Some(self.path.jet(t, order))
    }

    moldloft_num::curve_facts!(broken, open, not_rational);
    moldloft_num::curve_one_by_one!(T);
}
