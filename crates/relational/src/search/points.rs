//! Points in space that need a search.

use super::arguments::{Onto, Target};
use super::magnets::foot;
use moldloft_num::{Order, Real, Vec3, slope_scale, solve_dense};
use moldloft_registry::{
    Build, CallError, Class, Context, FieldRef, FromValue, Kind, MirrorArgument, Point, Value,
};

/// A mirror, or a surface.
pub enum MirrorOrSurface<T: Real> {
    /// A plane, line or point.
    MirrorArgument(MirrorArgument<T>),
    /// A surface, or a magnet of it.
    Surface(Onto<T>),
    /// The zero set of an implicit function.
    Field(FieldRef<T>),
}

impl<T: Real> FromValue<T> for MirrorOrSurface<T> {
    const CLASS: Class = Class::Target;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match Target::from_value(value)? {
            Target::Surface(onto) => Ok(Self::Surface(onto)),
            Target::Field(field) => Ok(Self::Field(field)),
            Target::Plane(plane) => Ok(Self::MirrorArgument(MirrorArgument::Plane(plane))),
            Target::Point(point) => Ok(Self::MirrorArgument(MirrorArgument::Point(point))),
            Target::Curve(_) => MirrorArgument::from_value(value).map(Self::MirrorArgument),
        }
    }
}

/// The foot of the perpendicular from a point to a plane, line, surface or the zero set of a field;
/// if the target is a point, that point.
///
/// On the zero set of a field it is the foot found by descent along the field.
///
/// On a surface it is the nearest foot; from a magnet of the surface, the foot found by descent
/// from there. A foot beyond an edge is clamped to the edge and reported.
#[derive(Kind)]
#[kind(
    class = Point,
    columns = "point mirror",
    example = "AbsPoint A(1, 2, 0.5); AbsPoint B(0, 0, 0); AbsPoint C(3, 1, 0); Line axis(B, C); \
               ProjPoint foot(A, axis); AbsPoint D(0, 3, 2); Line m(D, A); RuledSurf S(axis, m); \
               ProjPoint on(D, S);"
)]
pub struct ProjPoint<T: Real> {
    /// The point to project.
    point: Point<T>,
    /// The target of the projection.
    mirror: MirrorOrSurface<T>,
}

impl<T: Real> Build<T> for ProjPoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let point = match self.mirror {
            MirrorOrSurface::MirrorArgument(mirror) => {
                Point::image(mirror.foot(self.point.xyz), &self.point)
            }
            MirrorOrSurface::Surface(onto) => {
                let ([u, v], found) = foot(&onto, self.point.xyz, false)?;
                Point::free(onto.surface.jet(u, v, Order::Zero).p).with_found(found)
            }
            MirrorOrSurface::Field(field) => Point::free(
                foot_on_level(&field, self.point.xyz).map_err(|f| f.in_field(Self::MIRROR))?,
            ),
        };
        Ok(Value::Point(Box::new(point)))
    }
}

/// Maximum number of steps of a descent, and its relative tolerances in the level and across.
const STEPS: usize = 200;
const NEAR: f64 = 1e-13;

/// The point x of f = 0 with P - x along its gradient, that is reached down the field from P.
pub(super) fn foot_on_level<T: Real>(
    field: &FieldRef<T>,
    point: Vec3<T>,
) -> Result<Vec3<T>, CallError> {
    let p = point.re();
    let mut x = p;
    let mut done = false;
    for _ in 0..STEPS {
        let (f, g) = field.value_and_gradient(Vec3::lifted(x));
        let (f, g) = (f.re(), g.re());
        let size = g.norm_sq();
        if size.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
            break;
        }
        // Onto the level, and along it towards the point.
        let across = g * (-f / size);
        let away = p - x;
        let along = away - g * (away.dot(g) / size);
        let step = across + along * 0.5;
        x += step;
        if step.norm() <= NEAR * (1.0 + x.norm()) {
            done = true;
            break;
        }
    }
    let lost = |x: Vec3| {
        CallError::new("no-solution", "descent along the field finds no foot of the point")
            .expected("a field with a surface near the point")
            .found(format!("({}, {}, {}) after {STEPS} steps", x.x, x.y, x.z))
    };
    x = match polished(field, p, x) {
        Some(better) => better,
        // Steps along a strongly bent level may have circled it.
        None if done => x,
        None => return Err(lost(x)),
    };
    newton_step(field, point, x).map(|s| Vec3::lifted(x) + s).ok_or_else(|| lost(x))
}

/// The system of Newton's method for x - P + l grad f = 0, f = 0 at `x`: its matrix, l, and the value and
/// gradient as lengths.
fn foot_system<T: Real>(field: &FieldRef<T>, p: Vec3, x: Vec3) -> ([T; 16], f64, T, Vec3<T>) {
    let (f, g, h) = field.second_order(Vec3::lifted(x));
    let scale = slope_scale(g.re());
    let (f, g, h) = (f * scale, g * T::from(scale), h.map(|row| row * T::from(scale)));
    let l = g.re().dot(p - x) / g.re().norm_sq();
    let mut a = [T::zero(); 16];
    for i in 0..3 {
        for j in 0..3 {
            a[4 * i + j] = h[i][j] * l;
        }
        a[4 * i + i] += T::one();
        a[4 * i + 3] = g[i];
        a[12 + i] = g[i];
    }
    (a, l, f, g)
}

/// Derivative of the foot for that of the point.
pub(super) fn foot_rate<T: Real>(
    field: &FieldRef<T>,
    point: Vec3<T>,
    rate: Vec3<T>,
) -> Option<[Vec3<T>; 2]> {
    let foot = foot_on_level(field, point).ok()?;
    // The matrix at the foot, derivatives included: at its real position, then moved along.
    let (_, g, h) = field.second_order(foot);
    let scale = T::one() / g.norm();
    let (g, h) = (g * scale, h.map(|row| row * scale));
    let l = g.dot(point - foot);
    let mut a = [T::zero(); 16];
    for i in 0..3 {
        for j in 0..3 {
            a[4 * i + j] = h[i][j] * l;
        }
        a[4 * i + i] += T::one();
        a[4 * i + 3] = g[i];
        a[12 + i] = g[i];
    }
    let mut b = [rate.x, rate.y, rate.z, T::zero()];
    solve_dense(&mut a, &mut b).ok()?;
    Some([foot, Vec3::new(b[0], b[1], b[2])])
}

/// A few of Newton's steps towards the foot.
fn polished<T: Real>(field: &FieldRef<T>, p: Vec3, mut x: Vec3) -> Option<Vec3> {
    for _ in 0..30 {
        let step = newton_step(field, Vec3::lifted(p), x)?.re();
        x += step;
        if step.norm() <= NEAR * (1.0 + x.norm()) {
            return Some(x);
        }
    }
    None
}

/// The step of Newton's method for x - P + l grad f = 0, f = 0 from `x`.
fn newton_step<T: Real>(field: &FieldRef<T>, p: Vec3<T>, x: Vec3) -> Option<Vec3<T>> {
    let (mut a, l, f, g) = foot_system(field, p.re(), x);
    let away = p - Vec3::lifted(x) - g * T::from(l);
    let mut b = [away.x, away.y, away.z, -f];
    solve_dense(&mut a, &mut b).ok()?;
    let step = Vec3::new(b[0], b[1], b[2]);
    step.is_finite().then_some(step)
}
