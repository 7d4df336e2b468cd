//! Rigid motions of arrays of points, and frames along curves.

use crate::value::{Points, Shaped, distinct_neighbours, vectors};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{ArrayShape, Build, CallError, Context, FieldId, Kind, Scalar, Value};
use std::f64::consts::FRAC_PI_2;

/// Cosine and sine, exact on the axes: of whole quarter turns, as doubles spell them, 0, 1 or -1.
fn cos_sin<T: Real>(angle: T) -> [T; 2] {
    let quarters = (angle.re() / FRAC_PI_2).round();
    let rest = angle - quarters * FRAC_PI_2;
    if rest.re() != 0.0 {
        return [angle.cos(), angle.sin()];
    }
    let (c, s) = (rest.cos(), rest.sin());
    match quarters.rem_euclid(4.0) as u8 {
        0 => [c, s],
        1 => [-s, c],
        2 => [-c, -s],
        _ => [s, -c],
    }
}

fn direction<T: Real>(v: Vec3<T>, field: FieldId) -> Result<Vec3<T>, CallError> {
    v.normalized().ok_or_else(|| {
        CallError::new("no-direction", "the vector has no direction: it is zero")
            .expected("a non-zero vector")
            .in_field(field)
    })
}

/// A vector, curve, surface or block shifted by a vector.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    cheap,
    name = "translate",
    example = "vector p = translate({1, 0, 0}, {0, 2, 0}); assert p.y == 2;"
)]
pub struct Translate<T: Scalar> {
    /// The points to shift.
    o: Shaped<T>,
    /// The shift.
    v: Vec3<T>,
}

impl<T: Scalar> Build<T> for Translate<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(self.o.mapped(|p| p + self.v))
    }
}

/// A vector, curve, surface or block with its coordinates multiplied by those of a vector, or all by a
/// number.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    cheap,
    name = "scale",
    example = "vector p = scale({1, 2, 3}, {1, 1, 2}); assert p.z == 6;"
)]
pub struct Scale<T: Scalar> {
    /// The points to scale, about the origin.
    o: Shaped<T>,
    /// The three factors, or one.
    by: Value<T>,
}

impl<T: Scalar> Build<T> for Scale<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let by = match &self.by {
            Value::Number(x) => Vec3::new(*x, *x, *x),
            other => <Vec3<T> as moldloft_registry::FromValue<T>>::from_value(other)
                .map_err(|fault| fault.in_field(Self::BY))?,
        };
        Ok(self.o.mapped(|p| Vec3::new(p.x * by.x, p.y * by.y, p.z * by.z)))
    }
}

/// A vector, curve, surface or block mirrored in the plane through a point with a normal.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    cheap,
    name = "mirror",
    example = "vector p = mirror({1, 2, 3}, {0, 0, 0}, {0, 1, 0}); assert p.y == -2;"
)]
pub struct Mirror<T: Scalar> {
    /// The points to mirror.
    o: Shaped<T>,
    /// A point of the plane.
    p: Vec3<T>,
    /// Normal of the plane, of any length.
    n: Vec3<T>,
}

impl<T: Scalar> Build<T> for Mirror<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { o, p, n } = self;
        let square = direction(n, Self::N).map(|_| n.norm_sq())?;
        // 2 (r - p) . n / n^2 without a root: planes of whole normals mirror exactly.
        Ok(o.mapped(|r| r - n * ((r - p).dot(n) * 2.0 / square)))
    }
}

/// A vector, curve, surface or block rotated about an axis, right-handed: rotate(o, axis, angle)
/// about the axis through the origin, rotate(o, p, axis, angle) about the one through p (Rodrigues
/// 1840). Rotations by multiples of PI/2 are exact.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    cheap,
    name = "rotate",
    example = "vector p = rotate({1, 0, 0}, {0, 0, 1}, 1.5707963267948966); \
               assert |p - {0, 1, 0}| < 1e-15; \
               vector q = rotate({2, 0, 0}, {1, 0, 0}, {0, 0, 1}, 1.5707963267948966); \
               assert |q - {1, 1, 0}| < 1e-15;"
)]
pub struct Rotate<T: Scalar> {
    /// The points to turn.
    o: Shaped<T>,
    /// A point of the axis with four arguments; the direction of the axis with three.
    p: Vec3<T>,
    /// Direction of the axis; or the angle, in radians.
    axis: Value<T>,
    /// The angle, in radians.
    #[field(angle)]
    angle: Option<T>,
}

impl<T: Scalar> Build<T> for Rotate<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (p, axis, angle, field) = match (&self.axis, self.angle) {
            (Value::Number(angle), None) => (Vec3::zero(), self.p, *angle, Self::P),
            (axis, Some(angle)) => {
                let axis = <Vec3<T> as moldloft_registry::FromValue<T>>::from_value(axis);
                (self.p, axis.map_err(|fault| fault.in_field(Self::AXIS))?, angle, Self::AXIS)
            }
            (_, None) => {
                return Err(CallError::new("missing-argument", "the angle is missing")
                    .expected("rotate(o, axis, angle) or rotate(o, p, axis, angle)")
                    .in_field(Self::ANGLE));
            }
        };
        let k = direction(axis, field)?;
        let [cos, sin] = cos_sin(angle);
        Ok(self.o.mapped(|r| {
            let d = r - p;
            p + d * cos + k.cross(d) * sin + k * (k.dot(d) * (-cos + 1.0))
        }))
    }
}

/// The surface of revolution of a curve about the x axis: line s[,j] is at the j-th of `n` equally
/// spaced angles from `a0` to `a1`.
///
/// A point (x, y, z) maps to (x, y cos a - z sin a, y sin a + z cos a). Points on the axis stay
/// there exactly: the surface has a pole. Lines at multiples of PI/2 are exactly in the coordinate
/// planes.
#[derive(Kind)]
#[kind(
    class = Vectors,
    function,
    name = "revolve",
    example = "surface s = revolve(points({0, 0, 0}, {1, 1, 0}), 0, 3.141592653589793, 5); \
               assert |s[2,3] - {1, 0, 1}| < 1e-15;"
)]
pub struct Revolve<T: Scalar> {
    /// The meridian.
    curve: Points<T>,
    /// First angle.
    #[field(angle)]
    a0: T,
    /// Last angle.
    #[field(angle)]
    a1: T,
    /// Number of lines.
    #[field(min = 2, max = 1e6)]
    n: usize,
}

impl<T: Scalar> Build<T> for Revolve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (points, n) = (self.curve.0, self.n);
        let angles: Vec<[T; 2]> = (0..n)
            .map(|j| cos_sin(self.a0 + (self.a1 - self.a0) * (j as f64 / (n - 1) as f64)))
            .collect();
        let mut all = Vec::with_capacity(points.len() * n);
        for p in &points {
            for [cos, sin] in &angles {
                all.push(Vec3::new(p.x, p.y * *cos - p.z * *sin, p.y * *sin + p.z * *cos));
            }
        }
        Ok(vectors(ArrayShape::Grid(points.len(), n), all))
    }
}

/// Unit tangents of a curve of points: those of the circle through a point and its neighbours.
fn tangents<T: Real>(points: &[Vec3<T>], field: FieldId) -> Result<Vec<Vec3<T>>, CallError> {
    let n = points.len();
    if n < 2 {
        return Err(CallError::new("too-few-items", "one point has no tangent")
            .expected("at least two points")
            .found(n.to_string())
            .in_field(field));
    }
    let mut chords = Vec::with_capacity(n - 1);
    distinct_neighbours(points, field)?;
    for pair in points.windows(2) {
        let d = pair[1] - pair[0];
        chords.push((d, d.norm()));
    }
    // The derivative of the parabola through three points by chord length.
    let inner = |k: usize| {
        let ((d, h), (e, g)) = (chords[k - 1], chords[k]);
        d / h * (g / (h + g)) + e / g * (h / (h + g))
    };
    let mut all: Vec<Vec3<T>> = Vec::with_capacity(n);
    for k in 0..n {
        let raw = match k {
            0 if n == 2 => chords[0].0,
            0 => chords[0].0 / chords[0].1 * T::from(2.0) - inner(1),
            k if k + 1 == n && n == 2 => chords[0].0,
            k if k + 1 == n => chords[k - 1].0 / chords[k - 1].1 * T::from(2.0) - inner(k - 1),
            k => inner(k),
        };
        all.push(raw.normalized().ok_or_else(|| {
            CallError::new("no-direction", format!("the curve turns back at point {}", k + 1))
                .in_item(k)
                .in_field(field)
        })?);
    }
    Ok(all)
}

/// The unit tangents of a curve of points.
///
/// At an inner point that of the parabola through it and its neighbours, at an end that of the
/// nearest parabola.
#[derive(Kind)]
#[kind(
    class = Vectors,
    function,
    name = "tangents",
    example = "curve t = tangents(points({0, 0, 0}, {1, 0, 0}, {2, 0, 0})); assert t[2].x == 1;"
)]
pub struct Tangents<T: Scalar> {
    /// The points.
    curve: Points<T>,
}

impl<T: Scalar> Build<T> for Tangents<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let all = tangents(&self.curve.0, Self::CURVE)?;
        Ok(vectors(ArrayShape::Row(all.len()), all))
    }
}

/// Unit normals of a curve of points with the least rotation about its tangents; together with
/// `tangents(c)` and their vector product they are a frame at each point (double reflection: Wang
/// and others, ACM Trans. Graph. 27, 2008).
///
/// The first normal is the component of `n0` normal to the first tangent; by default `n0` is the
/// coordinate axis with the largest angle to the tangent.
#[derive(Kind)]
#[kind(
    class = Vectors,
    function,
    name = "frame",
    example = "curve n = frame(points({0, 0, 0}, {1, 0, 0}, {2, 0, 0}), {0, 0, 3}); \
               assert |n[3] - {0, 0, 1}| < 1e-15;"
)]
pub struct FrameOf<T: Scalar> {
    /// The points.
    curve: Points<T>,
    /// The first normal.
    n0: Option<Vec3<T>>,
}

impl<T: Scalar> Build<T> for FrameOf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let points = self.curve.0;
        let tangents = tangents(&points, Self::CURVE)?;
        let t = tangents[0];
        let start = match self.n0 {
            Some(n0) => direction(n0 - t * t.dot(n0), Self::N0)?,
            None => t.perpendicular(),
        };
        let mut all = vec![start];
        for k in 1..points.len() {
            let (r, t) = (all[k - 1], tangents[k - 1]);
            let reflected = |v: Vec3<T>, m: Vec3<T>, square: T| v - m * (m.dot(v) * 2.0 / square);
            let d = points[k] - points[k - 1];
            let square = d.norm_sq();
            let (r, t) = (reflected(r, d, square), reflected(t, d, square));
            let turn = tangents[k] - t;
            let square = turn.norm_sq();
            let next = if square.re() > 0.0 { reflected(r, turn, square) } else { r };
            // Rounding would drift over many points.
            let normal = next - tangents[k] * tangents[k].dot(next);
            all.push(normal.normalized().unwrap_or(next));
        }
        Ok(vectors(ArrayShape::Row(all.len()), all))
    }
}
