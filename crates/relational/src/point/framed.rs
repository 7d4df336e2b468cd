//! Points in the axes of frames, Cartesian and polar.

use moldloft_num::{Frame, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, Kind, Point, Value};

/// The position at an offset from a point, or from the frame's origin without one, in the axes of a
/// frame.
fn placed<T: Real>(
    point: Option<Point<T>>,
    frame: Option<Frame<T>>,
    offset: Vec3<T>,
) -> Result<Value<T>, CallError> {
    let frame = frame.unwrap_or_else(Frame::world);
    let origin = point.map_or(frame.origin, |p| p.xyz);
    let xyz = Frame { origin, ..frame }.world_from(offset);
    Ok(Value::Point(Box::new(Point::free(xyz))))
}

/// A point at an offset from another, in the axes of a frame.
///
/// Type 0: Cartesian offset (a, b, c). Type 1: cylindrical, with a the distance from the z axis, b
/// the angle from x toward y, c the height. Type 2: spherical, with a the distance, b the
/// longitude, c the latitude. The point defaults to the frame's origin. A point given as `frame`
/// means the world axes at that point.
#[derive(Kind)]
#[kind(
    class = Point,
    columns = "type point frame a b c",
    example = "AbsPoint A(1, 0, 0); RPYFrame keel(A, 0.35, 0, 0.1); FramePoint p(A, keel, 0, 0, -3); \
               FramePoint q(p, keel, 2, 0.5, 1, type = 1); FramePoint r(q, A, 2, 0.5, 1, 2);"
)]
pub struct FramePoint<T: Real> {
    /// Reference point; default: the frame's origin.
    point: Option<Point<T>>,
    /// Frame of the axes; default: world axes.
    frame: Option<Frame<T>>,
    /// First coordinate.
    #[field(default = 0)]
    a: T,
    /// Second coordinate; an angle in types 1 and 2.
    #[field(default = 0)]
    b: T,
    /// Third coordinate; an angle in type 2.
    #[field(default = 0)]
    c: T,
    /// 0 Cartesian, 1 cylindrical, 2 spherical.
    #[field(default = 0, min = 0, max = 2)]
    r#type: u32,
}

impl<T: Real> Build<T> for FramePoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { point, frame, a, b, c, r#type } = self;
        let offset = match r#type {
            0 => Vec3::new(a, b, c),
            1 => Vec3::new(a * b.cos(), a * b.sin(), c),
            _ => spherical(a, b, c),
        };
        placed(point, frame, offset)
    }
}

fn spherical<T: Real>(r: T, longitude: T, latitude: T) -> Vec3<T> {
    let across = r * latitude.cos();
    Vec3::new(across * longitude.cos(), across * longitude.sin(), r * latitude.sin())
}

/// A point at a distance and direction from another, in the axes of a frame:
/// X = P + r (cos phi cos theta, cos phi sin theta, sin phi).
#[derive(Kind)]
#[kind(
    class = Point,
    columns = "point frame r theta phi",
    example = "AbsPoint A(1, 0, 0); RPYFrame keel(A, 0.35, 0, 0.1); PolarPoint p(A, keel, 2, 0.5, 0.2);"
)]
pub struct PolarPoint<T: Real> {
    /// Reference point; default: the frame's origin.
    point: Option<Point<T>>,
    /// Frame of the axes; default: world axes.
    frame: Option<Frame<T>>,
    /// Distance.
    r: T,
    /// Longitude, from x toward y.
    #[field(angle, default = 0)]
    theta: T,
    /// Latitude, from the xy plane toward z.
    #[field(angle, default = 0)]
    phi: T,
}

impl<T: Real> Build<T> for PolarPoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        placed(self.point, self.frame, spherical(self.r, self.theta, self.phi))
    }
}
