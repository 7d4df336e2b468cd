//! Points by coordinates, by offsets and by mirroring.

use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, CallError, Context, Kind, MirrorArgument, Point, Value};

fn free<T: Real>(xyz: Vec3<T>) -> Result<Value<T>, CallError> {
    Ok(Value::Point(Box::new(Point::free(xyz))))
}

/// A point given by its coordinates: X = (x, y, z).
///
/// Three degrees of freedom (Letcher and Shook 1995).
#[derive(Kind)]
#[kind(class = Point, columns = "x y z", example = "AbsPoint A(1, 2, 0.5);")]
pub struct AbsPoint<T: Real> {
    /// First coordinate.
    x: T,
    /// Second coordinate.
    y: T,
    /// Third coordinate.
    z: T,
}

impl<T: Real> Build<T> for AbsPoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        free(Vec3::new(self.x, self.y, self.z))
    }
}

/// A point at a fixed offset from another: X = P + (dx, dy, dz).
#[derive(Kind)]
#[kind(
    class = Point,
    columns = "point dx dy dz",
    example = "AbsPoint A(1, 2, 0.5); RelPoint B(A, 0, 0, 1.5);"
)]
pub struct RelPoint<T: Real> {
    /// Reference point.
    point: Point<T>,
    /// Offset along x.
    #[field(default = 0)]
    dx: T,
    /// Offset along y.
    #[field(default = 0)]
    dy: T,
    /// Offset along z.
    #[field(default = 0)]
    dz: T,
}

impl<T: Real> Build<T> for RelPoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        free(self.point.xyz + Vec3::new(self.dx, self.dy, self.dz))
    }
}

/// The mirror image of a point: X = 2 F - P, with F the foot of the perpendicular from P to the
/// plane or line, or the centre of a point reflection.
#[derive(Kind)]
#[kind(
    class = Point,
    columns = "point mirror",
    example = "AbsPoint A(1, 2, 0.5); MirrPoint B(A, \"y=0\");"
)]
pub struct MirrPoint<T: Real> {
    /// The point to mirror.
    point: Point<T>,
    /// The mirror: a plane, line or point.
    mirror: MirrorArgument<T>,
}

impl<T: Real> Build<T> for MirrPoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let image = Point::image(self.mirror.image(self.point.xyz), &self.point);
        Ok(Value::Point(Box::new(image)))
    }
}
