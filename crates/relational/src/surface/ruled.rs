//! Ruled surfaces between two curves.

use super::linear::LinearLoft;
use super::masters::Masters;
use moldloft_num::Real;
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, SurfaceRef, Value};
use moldloft_spline::KnotVector;

/// Straight rulings between two curves: S(u, v) = (1 - v) C1(u) + v C2(u).
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "relabel c1 c2",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m);"
)]
pub struct RuledSurf<T: Real> {
    /// Edge v = 0.
    c1: CurveRef<T>,
    /// Edge v = 1.
    c2: CurveRef<T>,
}

impl<T: Real> Build<T> for RuledSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let masters = Masters::new(vec![self.c1, self.c2], Self::C1)?;
        let knots = KnotVector::clamped_uniform(1, 2).expect("two knots at each end");
        Ok(Value::Surface(SurfaceRef::new(LinearLoft { masters, knots }, context.nesting)))
    }
}
