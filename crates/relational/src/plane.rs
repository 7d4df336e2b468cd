//! Planes: of constant coordinate, parallel to others, through points.

use crate::arguments::{Bead, Magnet};
use crate::normal::normal;
use crate::point::tangent;
use moldloft_num::{Order, Plane, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, Kind, Point, Value};
use std::sync::Arc;

fn plane<T: Real>(plane: Plane<T>) -> Result<Value<T>, CallError> {
    Ok(Value::Plane(Arc::new(plane)))
}

macro_rules! coordinate_plane {
    ($(#[$doc:meta])* $name:ident, $coordinate:ident, $example:literal, $point:expr, $normal:expr) => {
        $(#[$doc])*
        #[derive(Kind)]
        #[kind(class = Plane, columns = stringify!($coordinate), example = $example)]
        pub struct $name<T: Real> {
            /// The coordinate that all points of the plane have.
            $coordinate: T,
        }

        impl<T: Real> Build<T> for $name<T> {
            fn build(self, _: &Context) -> Result<Value<T>, CallError> {
                let point: fn(T, T) -> Vec3<T> = $point;
                let [x, y, z] = $normal;
                plane(Plane { point: point(self.$coordinate, T::zero()), normal: Vec3::of(x, y, z) })
            }
        }
    };
}

coordinate_plane!(
    /// The plane of the points with a given x; its normal is (1, 0, 0).
    XPlane, x, "XPlane amidships(15);", |x, o| Vec3::new(x, o, o), [1.0, 0.0, 0.0]
);
coordinate_plane!(
    /// The plane of the points with a given y; its normal is (0, 1, 0).
    YPlane, y, "YPlane centre(0);", |y, o| Vec3::new(o, y, o), [0.0, 1.0, 0.0]
);
coordinate_plane!(
    /// The plane of the points with a given z; its normal is (0, 0, 1).
    ZPlane, z, "ZPlane waterline(0.25);", |z, o| Vec3::new(o, o, z), [0.0, 0.0, 1.0]
);

/// The plane at a signed distance from another, positive along its normal.
#[derive(Kind)]
#[kind(
    class = Plane,
    columns = "plane distance",
    example = "ZPlane waterline(0); OffsetPlane deck(waterline, 1.5);"
)]
pub struct OffsetPlane<T: Real> {
    /// Reference plane.
    plane: Plane<T>,
    /// The distance.
    distance: T,
}

impl<T: Real> Build<T> for OffsetPlane<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Plane { point, normal } = self.plane;
        plane(Plane { point: point + normal * self.distance, normal })
    }
}

/// The plane through three points (3PtPlane of model files); its normal is along
/// (P2 - P1) x (P3 - P1).
#[derive(Kind)]
#[kind(
    class = Plane,
    columns = "p1 p2 p3",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0.5); AbsPoint C(0, 1, 0.25); \
               ThreePointPlane deck(A, B, C);"
)]
pub struct ThreePointPlane<T: Real> {
    /// First point.
    p1: Point<T>,
    /// Second point.
    p2: Point<T>,
    /// Third point.
    p3: Point<T>,
}

impl<T: Real> Build<T> for ThreePointPlane<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (a, b) = (self.p2.xyz - self.p1.xyz, self.p3.xyz - self.p1.xyz);
        let normal = a.cross(b);
        let size = a.re().norm() * b.re().norm();
        // Points in line by rounding only span a plane that means nothing.
        let flat = normal.re().norm() <= 8.0 * f64::EPSILON * size;
        match Plane::new(self.p1.xyz, normal) {
            Some(p) if !flat => plane(p),
            _ => Err(CallError::new("collinear-points", "the three points are collinear")
                .expected("three points that span a plane")
                .found("three points in line")
                .help("move the third point off the line through the others")
                .in_field(Self::P3)),
        }
    }
}

/// The plane through one point with its normal toward another (2PtPlane of model files).
#[derive(Kind)]
#[kind(
    class = Plane,
    columns = "p1 p2",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, -1, 2); TwoPointPlane deck(A, B);"
)]
pub struct TwoPointPlane<T: Real> {
    /// A point of the plane.
    p1: Point<T>,
    /// A point in the direction of the normal.
    p2: Point<T>,
}

impl<T: Real> Build<T> for TwoPointPlane<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let normal = self.p2.xyz - self.p1.xyz;
        match Plane::new(self.p1.xyz, normal) {
            Some(p) => plane(p),
            None => Err(CallError::new("coincident-points", "the two points coincide")
                .expected("two different points")
                .found("no direction between them")
                .in_field(Self::P2)),
        }
    }
}

/// The plane through a point, parallel to another plane.
#[derive(Kind)]
#[kind(
    class = Plane,
    columns = "point plane",
    example = "AbsPoint A(1, 2, 3); ZPlane water(0); PlaneThroughPoint deck(A, water);"
)]
pub struct PlaneThroughPoint<T: Real> {
    /// A point of the plane.
    point: Point<T>,
    /// Reference plane.
    plane: Plane<T>,
}

impl<T: Real> Build<T> for PlaneThroughPoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        plane(Plane { point: self.point.xyz, normal: self.plane.normal })
    }
}

/// The tangent plane of a surface at a magnet, with the surface's normal; at a pole the limit along
/// the parameter line through the magnet.
#[derive(Kind)]
#[kind(
    class = Plane,
    columns = "magnet",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.25, 0.5); \
               TanPlane t(p);"
)]
pub struct TanPlane<T: Real> {
    /// The point of contact.
    magnet: Magnet<T>,
}

impl<T: Real> Build<T> for TanPlane<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let normal = normal(&self.magnet).map_err(|fault| fault.in_field(Self::MAGNET))?;
        let [u, v] = self.magnet.uv;
        plane(Plane { point: self.magnet.surface.jet(u, v, Order::Zero).p, normal })
    }
}

/// The plane normal to a curve at a bead; its normal is the tangent, in the direction of increasing
/// parameter.
#[derive(Kind)]
#[kind(
    class = Plane,
    columns = "bead",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
               AbsBead b(c, 0.25); NormalPlane across(b);"
)]
pub struct NormalPlane<T: Real> {
    /// The point of intersection with the curve.
    bead: Bead<T>,
}

impl<T: Real> Build<T> for NormalPlane<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let normal = tangent(&self.bead, Self::BEAD)?;
        let point = self.bead.curve.jet(self.bead.t, Order::Zero)[0];
        plane(Plane { point, normal })
    }
}
