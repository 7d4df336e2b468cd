//! B-spline lofts: attracted by their master curves.

use super::linear::LinearLoft;
use super::masters::Masters;
use crate::faults;
use moldloft_num::Real;
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, SurfaceRef, Value};
use moldloft_spline::KnotVector;

/// A surface that approximates its master curves: S(u, v) = sum N_i(v) C_i(u), with N_i the
/// B-splines of clamped uniform knots. It interpolates only the first and the last master.
///
/// With N masters the degree is at most N - 1: a higher one is lowered to that (Letcher and Shook
/// 1995).
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "relabel degree curves",
    example = "AbsPoint A(0, 0, 2); AbsPoint B(1, 0, -1); AbsPoint C(4, 2, 2); AbsPoint D(4, 1.5, -1); \
               AbsPoint E(4, 0, -1.5); AbsPoint F(8, 1.5, 2); AbsPoint G(8, 0, -0.5); Line a(A, B); \
               BCurve b({C, D, E}); Line c(F, G); BLoftSurf S({a, b, c}, degree = 2);"
)]
pub struct BLoftSurf<T: Real> {
    /// Master curves, two or more, in order of v.
    #[field(min_items = 2)]
    curves: Vec<CurveRef<T>>,
    /// Polynomial degree across the masters.
    #[field(default = 3, min = 1, max = 25)]
    degree: usize,
}

impl<T: Real> Build<T> for BLoftSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { curves, degree } = self;
        let count = curves.len();
        let masters = Masters::new(curves, Self::CURVES)?;
        let knots = KnotVector::clamped_uniform(degree.min(count - 1), count)
            .map_err(|error| faults::of_spline(error.into(), Self::CURVES, Self::DEGREE))?;
        Ok(Value::Surface(SurfaceRef::new(LinearLoft { masters, knots }, context.nesting)))
    }
}
