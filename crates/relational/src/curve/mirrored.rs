//! Mirror images of curves; they refer to their originals.

use moldloft_num::{Curve, CurveJet, Order, Real, Reparametrization, Vec3};
use moldloft_registry::{CurveRef, Kind, MirrorArgument};
use std::sync::Arc;

/// The mirror image of a curve in a plane, line or point, point by point: C(t) = 2 F(t) - P(t),
/// with F the foot of the perpendicular from P.
#[derive(Kind)]
#[kind(
    class = Curve,
    shape,
    columns = "relabel curve mirror",
    example = "AbsPoint A(0, 1, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); \
               BCurve c({A, B, C}); MirrCurve port(c, \"y=0\");"
)]
pub struct MirrCurve<T: Real> {
    /// The curve to mirror.
    curve: CurveRef<T>,
    /// The mirror: a plane, line or point.
    mirror: MirrorArgument<T>,
}

impl<T: Real> Curve<T> for MirrCurve<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        let [p, d, dd] = self.curve.jet(t, order);
        let turned = |v| self.mirror.direction(v, false);
        [self.mirror.image(p), turned(d), turned(dd)]
    }

    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        self.curve.grid(ts, out);
        for p in out {
            *p = self.mirror.image(*p);
        }
    }
    fn image_of(&self) -> Option<moldloft_num::trace::Key> {
        self.curve.key
    }

    fn law(&self) -> Option<Arc<dyn Reparametrization<T>>> {
        self.curve.law()
    }
    moldloft_num::curve_facts!(breaks of [self.curve], closed of [self.curve], rational of [self.curve]);
}
