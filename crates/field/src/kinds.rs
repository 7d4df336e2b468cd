//! The primitives as rows of the registry.

use crate::{FieldError, Primitive};
use moldloft_num::{Axis, Real};
use moldloft_registry::{Build, Context, Fault, FieldRef, Kind, Point, Value};

/// A primitive as the value of a row, or its error as a fault.
fn field<T: Real>(primitive: Result<Primitive<T>, FieldError>) -> Result<Value<T>, Fault> {
    match primitive {
        Ok(f) => Ok(Value::Field(FieldRef::new(f))),
        Err(error) => Err(Fault::new("no-field", error.to_string())),
    }
}

/// The half-space behind a plane: the distance from it, positive on the side of the normal.
#[derive(Kind)]
#[kind(
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
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        field(Primitive::plane(self.normal.xyz, self.point.xyz))
    }
}

/// The ball |X - centre|^2 - radius^2.
#[derive(Kind)]
#[kind(
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
}

impl<T: Real> Build<T> for Sphere<T> {
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        field(Primitive::sphere(self.centre.xyz, self.radius))
    }
}

/// The infinite cylinder about a line.
#[derive(Kind)]
#[kind(
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
}

impl<T: Real> Build<T> for Cylinder<T> {
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        field(Primitive::cylinder(self.axis, self.radius))
    }
}

/// The double cone whose apex is the start of a line.
#[derive(Kind)]
#[kind(
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
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        field(Primitive::cone(self.axis, self.angle))
    }
}

/// The torus about a line, centred at its start.
#[derive(Kind)]
#[kind(
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
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        field(Primitive::torus(self.axis, self.major, self.minor))
    }
}

/// The Dupin cyclide about a line, centred at its start: a ring whose tube is thinner on one side.
#[derive(Kind)]
#[kind(
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
    /// How much thinner the tube is there, and thicker opposite; below the major radius.
    change: T,
}

impl<T: Real> Build<T> for Cyclide<T> {
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        field(Primitive::cyclide(self.axis, self.along.xyz, self.major, self.minor, self.change))
    }
}
