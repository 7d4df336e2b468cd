//! Frames: three points, or roll, pitch and yaw.

use moldloft_num::{Axis, Frame, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, Kind, Point, Value};
use std::sync::Arc;

/// The frame of three points: the first is the origin, the second is on the positive x axis, and
/// the third is in the xy plane with y > 0.
#[derive(Kind)]
#[kind(
    class = Frame,
    columns = "p1 p2 p3",
    example = "AbsPoint A(1, 0, 0); AbsPoint B(2, 0.5, 0); AbsPoint C(0, 1, 0.25); \
               ThreePointFrame f(A, B, C); FramePoint p(A, f, 1, 2, 3);"
)]
pub struct ThreePointFrame<T: Real> {
    /// Origin.
    p1: Point<T>,
    /// A point of the positive x axis.
    p2: Point<T>,
    /// A point of the xy plane.
    p3: Point<T>,
}

impl<T: Real> Build<T> for ThreePointFrame<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let [o, x, xy] = [self.p1.xyz, self.p2.xyz, self.p3.xyz];
        let (a, b) = ((x - o).re(), (xy - o).re());
        // Points in line by rounding only span no plane.
        let flat = a.cross(b).norm() <= 8.0 * f64::EPSILON * a.norm() * b.norm();
        match Frame::through(o, x, xy) {
            Some(frame) if !flat => Ok(Value::Frame(Arc::new(frame))),
            _ => Err(CallError::new("collinear-points", "the three points are collinear")
                .expected("three points that span a plane")
                .found("three points in line")
                .help("move the third point off the line through the others")
                .in_field(Self::P3)),
        }
    }
}

/// The frame at a point, rotated from the axes of another frame (default: world) by yaw about z,
/// then pitch about the new y, then roll about the new x; all right-handed.
#[derive(Kind)]
#[kind(
    class = Frame,
    columns = "point roll pitch yaw",
    example = "AbsPoint A(1, 0, 0); RPYFrame keel(A, 0.35, 0, 0.1); FramePoint p(A, keel, 0, 0, -3); \
               RPYFrame bulb(p, 0, -0.2, 0, keel); FramePoint q(p, bulb, 1, 2, 3);"
)]
pub struct RPYFrame<T: Real> {
    /// Origin.
    point: Point<T>,
    /// Angle about the x axis.
    #[field(angle, default = 0)]
    roll: T,
    /// Angle about the y axis.
    #[field(angle, default = 0)]
    pitch: T,
    /// Angle about the z axis.
    #[field(angle, default = 0)]
    yaw: T,
    /// Frame of the initial axes; default: world axes.
    frame: Option<Frame<T>>,
}

impl<T: Real> Build<T> for RPYFrame<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let base = self.frame.unwrap_or_else(Frame::world).axes;
        // Rotations about the fixed axes in the opposite order, which is the same.
        let turned = |d: Vec3<T>| {
            let about = |k: usize, d: Vec3<T>, angle: T| {
                Axis { point: Vec3::zero(), direction: base[k] }.rotated(d, angle)
            };
            about(2, about(1, about(0, d, self.roll), self.pitch), self.yaw)
        };
        let frame = Frame { origin: self.point.xyz, axes: base.map(turned) };
        Ok(Value::Frame(Arc::new(frame)))
    }
}
