//! B-spline surfaces fitted to others by least squares.

use super::free_knots::{FreeKnots, FreeNet};
use crate::curve::fitted::{clamped, near_enough, no_fit, report};
use crate::faults;
use moldloft_num::{Order, Real, Surface, Vec3};
use moldloft_registry::{Build, CallError, Context, FieldId, Kind, Scalar, SurfaceRef, Value};
use moldloft_spline::{KnotVector, SplineWithKnotDerivatives};

/// A B-spline surface fitted to another by least squares, with clamped uniform knots and the
/// corners of the surface.
///
/// The lines v = const are fitted first, then their control points across, which is the fit of the
/// tensor product; each edge is the fit of the surface's edge. The member `residual` is the
/// greatest distance between surface and fit at equal parameters; a residual above `accuracy` is an
/// error.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "surface degree_u degree_v nu nv",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(2, 2, 2.5); AbsPoint F(4, 1, 3); CCurve l({A, B, C}); CCurve m({D, E, F}); \
               RuledSurf S(l, m); BFitSurf fit(S, 3, 2, 5, 3, 0.05);"
)]
pub struct BFitSurf<T: Real> {
    /// The surface to approximate.
    surface: SurfaceRef<T>,
    /// Polynomial degree in u.
    #[field(default = 3, min = 1, max = 25)]
    degree_u: usize,
    /// Polynomial degree in v.
    #[field(default = 3, min = 1, max = 25)]
    degree_v: usize,
    /// Number of control points along u, more than the degree.
    #[field(default = 8, min = 2, max = 1000)]
    nu: usize,
    /// Number of control points along v, more than the degree.
    #[field(default = 8, min = 2, max = 1000)]
    nv: usize,
    /// The greatest distance allowed between the two at equal parameters.
    #[field(min = 0)]
    accuracy: Option<T>,
}

impl<T: Scalar> Build<T> for BFitSurf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { surface, degree_u, degree_v, nu, nv, accuracy } = self;
        let knots = |degree: usize, n: usize, k: usize| -> Result<FreeKnots<T>, CallError> {
            let number = [Self::NU, Self::NV][k];
            let of = [Self::DEGREE_U, Self::DEGREE_V][k];
            let knots = KnotVector::clamped_uniform(degree, n)
                .map_err(|error| faults::of_spline(error.into(), number, of))?;
            let knots = knots.as_slice().iter().map(|&k| T::from(k)).collect();
            Ok(FreeKnots { degree, knots })
        };
        let knots = [knots(degree_u, nu, 0)?, knots(degree_v, nv, 1)?];
        fit(&surface, knots, accuracy, [Self::NU, Self::NV, Self::ACCURACY])
    }
}

/// A B-spline surface fitted to another as in BFitSurf, with given knots.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "surface degree_u degree_v knots_u knots_v",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(2, 2, 2.5); AbsPoint F(4, 1, 3); CCurve l({A, B, C}); CCurve m({D, E, F}); \
               RuledSurf S(l, m); NUBFitSurf fit(S, 3, 1, {0, 0.4, 1}, {0, 1});"
)]
pub struct NUBFitSurf<T: Real> {
    /// The surface to come near to.
    surface: SurfaceRef<T>,
    /// Polynomial degree in u.
    #[field(default = 3, min = 1, max = 25)]
    degree_u: usize,
    /// Polynomial degree in v.
    #[field(default = 3, min = 1, max = 25)]
    degree_v: usize,
    /// The parameters u of the joints between pieces, from 0 to 1, each once.
    #[field(min_items = 2)]
    knots_u: Vec<T>,
    /// The parameters v of the joints between pieces, from 0 to 1, each once.
    #[field(min_items = 2)]
    knots_v: Vec<T>,
    /// The greatest distance allowed between the two at equal parameters.
    #[field(min = 0)]
    accuracy: Option<T>,
}

impl<T: Scalar> Build<T> for NUBFitSurf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { surface, degree_u, degree_v, knots_u, knots_v, accuracy } = self;
        let knots =
            |degree: usize, knots: &[T], field: FieldId| -> Result<FreeKnots<T>, CallError> {
                Ok(FreeKnots { degree, knots: clamped(degree, knots, field)? })
            };
        let knots =
            [knots(degree_u, &knots_u, Self::KNOTS_U)?, knots(degree_v, &knots_v, Self::KNOTS_V)?];
        fit(&surface, knots, accuracy, [Self::KNOTS_U, Self::KNOTS_V, Self::ACCURACY])
    }
}

/// Points of the surface compared per control point and direction.
const SAMPLES: usize = 6;

/// The fit with these knots; the fields are theirs, or those of the numbers of points, and that of the
/// accuracy.
fn fit<T: Real>(
    surface: &SurfaceRef<T>,
    knots: [FreeKnots<T>; 2],
    accuracy: Option<T>,
    fields: [FieldId; 3],
) -> Result<Value<T>, CallError> {
    let points = [0, 1].map(|k| knots[k].knots.len() - knots[k].degree - 1);
    let places = points.map(|n| {
        let count = (SAMPLES * n).max(24);
        (0..=count).map(|k| k as f64 / count as f64).collect::<Vec<f64>>()
    });
    let [us, vs] = &places;
    let mut samples = vec![Vec3::zero(); us.len() * vs.len()];
    surface.grid(us, vs, &mut samples, None);
    let along = |k: usize, row: &[(f64, Vec3<T>)]| {
        SplineWithKnotDerivatives::fitted(
            knots[k].degree,
            Some(knots[k].knots.clone()),
            points[k],
            row,
        )
        .map_err(|error| no_fit(error).in_field(fields[k]))
    };
    // rows[j] are the control points of the fit along u at v_j.
    let mut rows = Vec::with_capacity(vs.len());
    for j in 0..vs.len() {
        let row: Vec<_> =
            us.iter().enumerate().map(|(i, &u)| (u, samples[i * vs.len() + j])).collect();
        rows.push(along(0, &row)?.control_points().collect::<Vec<_>>());
    }
    let mut net = Vec::with_capacity(points[0] * points[1]);
    for i in 0..points[0] {
        let column: Vec<_> = vs.iter().zip(&rows).map(|(&v, row)| (v, row[i])).collect();
        net.extend(along(1, &column)?.control_points());
    }
    let corners = surface.edges().corners;
    let fitted = FreeNet { knots, points: net, weights: None, corners, rows: Default::default() };
    let mut residual = 0.0f64;
    for (i, &u) in us.iter().enumerate() {
        for (j, &v) in vs.iter().enumerate() {
            let p = fitted.jet(T::from(u), T::from(v), Order::Zero).p.re();
            residual = residual.max(p.distance(samples[i * vs.len() + j].re()));
        }
    }
    near_enough(residual, accuracy, "surface")
        .map_err(|fault| fault.related(surface.key, "is the surface").in_field(fields[2]))?;
    Ok(Value::Surface(SurfaceRef::new(fitted, 0).with_found(report(residual))))
}
