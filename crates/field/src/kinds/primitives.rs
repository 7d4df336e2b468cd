//! The primitives as rows of the registry.

use super::read::{NamedField, field};
use crate::Primitive;
use moldloft_num::{Axis, Plane, Real};
use moldloft_registry::{Build, CallError, Context, Kind, Point, Value};

/// The half-space behind a plane: the distance from it, positive on the side of the normal.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    function,
    name = "plane",
    example = "field floor = plane({0, 0, -1}, {0, 0, 0});"
)]
pub struct HalfSpace<T: Real> {
    /// Its normal, from solid to air.
    normal: Point<T>,
    /// A point of the plane.
    point: Point<T>,
}

impl<T: Real> Build<T> for HalfSpace<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        field(Primitive::plane(self.normal.xyz, self.point.xyz))
    }
}

/// The half-space behind a plane object or a coordinate plane: the distance from it, positive on the
/// side of its normal.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    function,
    name = "half_space",
    example = "ZPlane deck(3); field below = half_space(deck);"
)]
pub struct BehindPlane<T: Real> {
    /// The plane.
    plane: Plane<T>,
}

impl<T: Real> Build<T> for BehindPlane<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        field(Primitive::plane(self.plane.normal, self.plane.point))
    }
}

/// The ball |X - centre|^2 - radius^2; with `distance = 1` the distance |X - centre| - radius.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    function,
    name = "sphere",
    example = "field ball = sphere({1, 0, 2}, 1.5);"
)]
pub struct Sphere<T: Real> {
    /// Centre.
    centre: Point<T>,
    /// Radius.
    #[field(min = 0)]
    radius: T,
    /// 1 for the distance instead of the polynomial.
    #[field(default = 0, min = 0, max = 1)]
    distance: u32,
}

impl<T: Real> Build<T> for Sphere<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (centre, radius) = (self.centre.xyz, self.radius);
        field(match self.distance {
            0 => Primitive::sphere(centre, radius),
            _ => Primitive::sphere_distance(centre, radius),
        })
    }
}

/// The infinite cylinder p^2 + q^2 - radius^2 about a line; with `distance = 1` the distance
/// sqrt(p^2 + q^2) - radius.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    function,
    name = "cylinder",
    example = "AbsPoint a(0, 0, 0); AbsPoint b(1, 0, 1); Line axis(a, b); field pipe = cylinder(axis, 0.6);"
)]
pub struct Cylinder<T: Real> {
    /// A line along the axis.
    axis: Axis<T>,
    /// Radius.
    #[field(min = 0)]
    radius: T,
    /// 1 for the distance instead of the polynomial.
    #[field(default = 0, min = 0, max = 1)]
    distance: u32,
}

impl<T: Real> Build<T> for Cylinder<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        field(match self.distance {
            0 => Primitive::cylinder(self.axis, self.radius),
            _ => Primitive::cylinder_distance(self.axis, self.radius),
        })
    }
}

/// The double cone with its apex at the start of a line.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    function,
    name = "cone",
    example = "AbsPoint a(0, 0, 0); AbsPoint b(1, 0, 1); Line axis(a, b); field tip = cone(axis, 0.3);"
)]
pub struct Cone<T: Real> {
    /// A line along the axis, from the apex.
    axis: Axis<T>,
    /// Full angle at the apex, below half a turn.
    #[field(angle, min = 0)]
    angle: T,
}

impl<T: Real> Build<T> for Cone<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        field(Primitive::cone(self.axis, self.angle))
    }
}

/// The torus about a line, centred at its start.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    function,
    name = "torus",
    example = "AbsPoint a(0, 0, 0); AbsPoint b(0, 0, 1); Line axis(a, b); field ring = torus(axis, 2, 0.5);"
)]
pub struct Torus<T: Real> {
    /// A line along the axis, from the centre.
    axis: Axis<T>,
    /// Radius of the circle of centres.
    #[field(min = 0)]
    major: T,
    /// Radius of the tube.
    #[field(min = 0)]
    minor: T,
}

impl<T: Real> Build<T> for Torus<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        field(Primitive::torus(self.axis, self.major, self.minor))
    }
}

/// The Dupin cyclide about a line, centred at its start: a ring whose tube is thinner on one side.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    function,
    name = "cyclide",
    example = "AbsPoint a(0, 0, 0); AbsPoint b(0, 0, 1); Line axis(a, b); field ring = cyclide(axis, {1, 0, 0}, 2, 0.5, 0.2);"
)]
pub struct Cyclide<T: Real> {
    /// A line along the axis, from the centre.
    axis: Axis<T>,
    /// Direction of the thin side.
    along: Point<T>,
    /// Radius of the ring.
    #[field(min = 0)]
    major: T,
    /// Mean radius of the tube.
    #[field(min = 0)]
    minor: T,
    /// Variation of the tube's radius, less than the major radius.
    change: T,
}

impl<T: Real> Build<T> for Cyclide<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        field(Primitive::cyclide(self.axis, self.along.xyz, self.major, self.minor, self.change))
    }
}

/// A named implicit function: the declaration `field f = ...;`.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    name = "Field",
    example = "Field ball(sphere({0, 0, 0}, 1));"
)]
pub struct FieldObject<T: Real> {
    /// The function.
    field: NamedField<T>,
    /// Objects that it is computed from.
    #[field(default)]
    of: Option<Vec<Value<T>>>,
}

impl<T: Real> Build<T> for FieldObject<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        drop(self.of);
        Ok(self.field.value())
    }
}
