//! Evaluation of curves and surfaces at given parameters.

use crate::value::{Farray, Numbers, Points, vectors};
use moldloft_num::{Order, Real, Vec3, gauss_legendre};
use moldloft_registry::{
    ArrayShape, Build, CallError, Context, CurveRef, FieldId, FromValue, Kind, Scalar, SurfaceRef,
    Value,
};
use moldloft_spline::arclen;

/// Accuracy of lengths relative to a rough estimate.
const LENGTH_ACCURACY: f64 = 1e-12;

/// The fault of a parameter outside [0, 1], in field `field`.
fn inside<T: Real>(parameters: &[T], field: FieldId) -> Result<(), CallError> {
    let outside = |t: &T| !(0.0..=1.0).contains(&t.re());
    let Some(k) = parameters.iter().position(outside) else { return Ok(()) };
    let found = parameters[k].re();
    Err(CallError::new("out-of-range", format!("parameter {} is {found}", k + 1))
        .expected("parameters from 0 to 1")
        .found(found.to_string())
        .in_item(k)
        .in_field(field))
}

fn positions<T: Real>(curve: &CurveRef<T>, parameters: &[T]) -> Vec<Vec3<T>> {
    if parameters.iter().all(|t| t.is_constant()) {
        let ts: Vec<f64> = parameters.iter().map(|t| t.re()).collect();
        let mut points = vec![Vec3::zero(); ts.len()];
        curve.grid(&ts, &mut points);
        return points;
    }
    parameters.iter().map(|&t| curve.jet(t, Order::Zero)[0]).collect()
}

/// The points of a curve at given parameters: C(s[1]), C(s[2]), ...
///
/// Parameters are in [0, 1]; at 0 and 1 the points are the curve's ends to the bit.
#[derive(Kind)]
#[kind(
    class = Vectors,
    function,
    name = "distc",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
               farray s = cosine(0, 1, 11); curve points = distc(c, s);"
)]
pub struct Distc<T: Scalar> {
    /// The curve.
    curve: CurveRef<T>,
    /// Parameters.
    parameters: Farray<T>,
}

impl<T: Scalar> Build<T> for Distc<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let parameters = self.parameters.row().map_err(|fault| fault.in_field(Self::PARAMETERS))?;
        inside(&parameters, Self::PARAMETERS)?;
        let points = positions(&self.curve, &parameters);
        Ok(vectors(ArrayShape::Row(points.len()), points))
    }
}

/// The points of a surface at given parameters: S(u[i], v[j]) for rows u[m] and v[n], or
/// S(u[i,j], v[i,j]) for parameters that are arrays [m,n] themselves.
///
/// Parameters are in [0, 1].
#[derive(Kind)]
#[kind(
    class = Vectors,
    function,
    name = "dists",
    example = "Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 1, 0}, {1, 1, 1}); RuledSurf r(a, b); \
               surface s = dists(r, uniform(0, 1, 5), d_tanh(0, 1, 0.1, 0, 7));"
)]
pub struct Dists<T: Scalar> {
    /// The surface.
    surface: SurfaceRef<T>,
    /// Parameters u.
    u: Farray<T>,
    /// Parameters v.
    v: Farray<T>,
}

impl<T: Scalar> Build<T> for Dists<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { surface, u, v } = self;
        inside(&u.items, Self::U)?;
        inside(&v.items, Self::V)?;
        let at = |u: T, v: T| surface.jet(u, v, Order::Zero).p;
        let constant = |a: &Farray<T>| a.items.iter().all(|t| t.is_constant());
        let plain = |a: &Farray<T>| a.items.iter().map(|t| t.re()).collect::<Vec<f64>>();
        match (u.shape, v.shape) {
            (ArrayShape::Row(m), ArrayShape::Row(n)) => {
                let mut points = vec![Vec3::zero(); m * n];
                if constant(&u) && constant(&v) {
                    surface.grid(&plain(&u), &plain(&v), &mut points, None);
                } else {
                    for (k, p) in points.iter_mut().enumerate() {
                        *p = at(u.items[k / n], v.items[k % n]);
                    }
                }
                Ok(vectors(ArrayShape::Grid(m, n), points))
            }
            (a, b) if a == b => {
                let points = if constant(&u) && constant(&v) {
                    let uv = plain(&u).into_iter().zip(plain(&v)).map(|(u, v)| [u, v]);
                    let mut points = vec![Vec3::zero(); u.items.len()];
                    surface.scattered(&uv.collect::<Vec<_>>(), &mut points);
                    points
                } else {
                    u.items.iter().zip(&v.items).map(|(&u, &v)| at(u, v)).collect()
                };
                Ok(vectors(a, points))
            }
            (a, b) => Err(CallError::new("shapes-differ", format!("shapes differ: {a} and {b}"))
                .expected("two rows, or two arrays of equal shape")
                .found(format!("u is {a}, v is {b}"))
                .in_field(Self::V)),
        }
    }
}

/// The point of a curve at a parameter, or the points at those of an farray.
///
/// Outside [0, 1] the curve's natural continuation.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    name = "evalc",
    example = "Line l({0, 0, 0}, {1, 2, 0}); vector p = evalc(l, 0.5); assert p.y == 1;"
)]
pub struct Evalc<T: Scalar> {
    /// The curve.
    curve: CurveRef<T>,
    /// A parameter, or an farray of them.
    u: Numbers<T>,
}

impl<T: Scalar> Build<T> for Evalc<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let points = positions(&self.curve, self.u.items());
        Ok(self.u.vectors(points))
    }
}

/// The derivative of a curve by its parameter, d^k C / du^k, at a parameter or at those of an farray.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    name = "derivc",
    example = "Line l({0, 0, 0}, {1, 2, 0}); vector d = derivc(l, 0.5); assert |d - {1, 2, 0}| == 0;"
)]
pub struct Derivc<T: Scalar> {
    /// The curve.
    curve: CurveRef<T>,
    /// A parameter, or an farray of them.
    u: Numbers<T>,
    /// Order of the derivative: 0, 1 or 2.
    #[field(default = 1, min = 0, max = 2)]
    k: usize,
}

fn order(k: usize) -> Order {
    [Order::Zero, Order::First, Order::Second][k.min(2)]
}

impl<T: Scalar> Build<T> for Derivc<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { curve, u, k } = self;
        let all = u.items().iter().map(|&t| curve.jet(t, order(k))[k]).collect();
        Ok(u.vectors(all))
    }
}

/// The curvature of a curve, |C' x C''| / |C'|^3, at a parameter or at those of an farray.
///
/// Not signed; a zero tangent is an error.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    name = "curvc",
    example = "Arc a({1, 0, 0}, {0, 1, 0}, {-1, 0, 0}); assert abs(curvc(a, 0.3) - 1) < 1e-12;"
)]
pub struct Curvc<T: Scalar> {
    /// The curve.
    curve: CurveRef<T>,
    /// A parameter, or an farray of them.
    u: Numbers<T>,
}

impl<T: Scalar> Build<T> for Curvc<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { curve, u } = self;
        let mut all = Vec::with_capacity(u.items().len());
        for (k, &t) in u.items().iter().enumerate() {
            let [_, d, dd] = curve.jet(t, Order::Second);
            let (square, bend) = (d.norm_sq(), d.cross(dd));
            if square.re() == 0.0 {
                let message = format!("zero tangent at u = {}", t.re());
                return Err(CallError::new("no-direction", message)
                    .expected("a curve with a non-zero tangent")
                    .in_item(k)
                    .in_field(Self::U));
            }
            // The root of an exact zero has no derivative; a straight line's curvature is zero.
            let size = bend.norm_sq();
            let size = if size.re() == 0.0 { T::zero() } else { size.sqrt() };
            all.push(size / (square * square.sqrt()));
        }
        Ok(u.numbers(all))
    }
}

/// The point of a surface at a pair of parameters, or the points at those of two farrays of equal
/// shape.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    name = "evals",
    example = "Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 1, 0}, {1, 1, 1}); RuledSurf r(a, b); \
               vector p = evals(r, 1, 0.5); assert p.z == 0.5;"
)]
pub struct Evals<T: Scalar> {
    /// The surface.
    surface: SurfaceRef<T>,
    /// Parameter u, or an farray.
    u: Numbers<T>,
    /// Parameter v, or an farray.
    v: Numbers<T>,
}

/// Equal shapes, or one pair.
fn paired<T: Real>(u: &Numbers<T>, v: &Numbers<T>, field: FieldId) -> Result<(), CallError> {
    let shape = |a: &Numbers<T>| match a {
        Numbers::One(_) => "a number".to_string(),
        Numbers::Many(a) => format!("an farray {}", a.shape),
    };
    let (a, b) = (shape(u), shape(v));
    if a == b {
        return Ok(());
    }
    Err(CallError::new("shapes-differ", format!("shapes differ: u is {a}, v is {b}"))
        .expected("two numbers, or two farrays of equal shape")
        .found(format!("{a} and {b}"))
        .help("for all pairs of two rows there is dists(surface, u, v)")
        .in_field(field))
}

impl<T: Scalar> Build<T> for Evals<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { surface, u, v } = self;
        paired(&u, &v, Self::V)?;
        let pairs = u.items().iter().zip(v.items());
        let points = pairs.map(|(&u, &v)| surface.jet(u, v, Order::Zero).p).collect();
        Ok(u.vectors(points))
    }
}

/// The derivative of a surface, `ku` times by u and `kv` times by v, at a pair of parameters or at
/// those of two farrays of equal shape.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    name = "derivs",
    example = "Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 1, 0}, {1, 1, 1}); RuledSurf r(a, b); \
               vector twist = derivs(r, 0.5, 0.5, 1, 1); assert |twist - {0, 0, 1}| < 1e-15;"
)]
pub struct Derivs<T: Scalar> {
    /// The surface.
    surface: SurfaceRef<T>,
    /// Parameter u, or an farray.
    u: Numbers<T>,
    /// Parameter v, or an farray.
    v: Numbers<T>,
    /// Order of the derivative by u.
    #[field(default = 1, min = 0, max = 2)]
    ku: usize,
    /// Order of the derivative by v.
    #[field(default = 0, min = 0, max = 2)]
    kv: usize,
}

impl<T: Scalar> Build<T> for Derivs<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { surface, u, v, ku, kv } = self;
        paired(&u, &v, Self::V)?;
        if ku + kv > 2 {
            let message = format!("no derivative of order {}", ku + kv);
            return Err(CallError::new("out-of-range", message)
                .expected("ku + kv of 2 at most")
                .found((ku + kv).to_string())
                .in_field(Self::KV));
        }
        let pick = |(&u, &v): (&T, &T)| {
            let jet = surface.jet(u, v, order(ku + kv));
            match (ku, kv) {
                (0, 0) => jet.p,
                (1, 0) => jet.u,
                (0, 1) => jet.v,
                (2, 0) => jet.uu,
                (1, 1) => jet.uv,
                _ => jet.vv,
            }
        };
        let all = u.items().iter().zip(v.items()).map(pick).collect();
        Ok(u.vectors(all))
    }
}

fn whole_length<T: Real>(curve: &CurveRef<T>) -> Value<T> {
    let curve = &**curve;
    let speed = |t: f64| curve.jet(T::from(t), Order::First)[1].re().norm();
    let rough = gauss_legendre(0.0, 1.0, speed);
    Value::Number(match rough {
        0.0 => T::zero(),
        rough => arclen(curve, T::zero(), T::one(), LENGTH_ACCURACY * rough),
    })
}

/// The length of a curve: the integral of |C'(t)| from 0 to 1, to about twelve digits.
#[derive(Kind)]
#[kind(
    class = Number,
    function,
    name = "lengthc",
    example = "Arc a({1, 0, 0}, {0, 1, 0}, {-1, 0, 0}); assert abs(lengthc(a) - 3.141592653589793) < 1e-11;"
)]
pub struct Lengthc<T: Real> {
    /// The curve.
    curve: CurveRef<T>,
}

impl<T: Real> Build<T> for Lengthc<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(whole_length(&self.curve))
    }
}

/// The length of a curve: for a pcurve the same as `lengthc`, for points the sum of the distances
/// of neighbours.
#[derive(Kind)]
#[kind(
    class = Number,
    function,
    name = "length",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
               float l = length(c);"
)]
pub struct Length<T: Scalar> {
    /// A pcurve, or a curve of points.
    curve: Value<T>,
}

impl<T: Scalar> Build<T> for Length<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let place = |fault: CallError| fault.in_field(Self::CURVE);
        if let Value::Vectors(_) | Value::List(_) = &self.curve {
            let Points(points) = Points::from_value(&self.curve).map_err(place)?;
            return Ok(Value::Number(crate::reduce::polyline_length(&points)));
        }
        CurveRef::from_value(&self.curve).map_err(place).map(|curve| whole_length(&curve))
    }
}
