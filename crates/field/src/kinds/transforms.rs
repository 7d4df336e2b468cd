//! Translated, rotated, mirrored and scaled fields and sets.

use super::read::{fault, field, primitive_of, set, set_of};
use crate::Affine;
use moldloft_num::{Axis, Plane, Real, Vec3};
use moldloft_registry::{
    Build, CallError, Class, Context, FromValue, Kind, MirrorArgument, Point, Value,
};

/// A field or a set.
pub struct Movable<T: Real>(Value<T>);

impl<T: Real> FromValue<T> for Movable<T> {
    const CLASS: Class = Class::Set;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Field(_) | Value::Set(_) | Value::Plane(_) => Ok(Self(value.clone())),
            other => Err(CallError::wrong_class(Class::Set, other.class())),
        }
    }
}

impl<T: Real> Movable<T> {
    /// It moved; a field stays a field.
    fn mapped(self, world_from: &Affine<T>) -> Result<Value<T>, CallError> {
        match &self.0 {
            Value::Set(_) => match set_of(&self.0) {
                Some(s) => set(s.mapped(world_from)),
                None => Err(CallError::wrong_class(Class::Set, self.0.class())),
            },
            value => match primitive_of(value) {
                Some(f) => field(f.mapped(world_from)),
                None => Err(CallError::wrong_class(Class::Field, value.class())),
            },
        }
    }
}

/// A field or set moved by a vector.
#[derive(Kind)]
#[kind(
    forward,
    class = Any,
    function,
    name = "translated",
    example = "set ball = translated(set(sphere({0, 0, 0}, 1)), {3, 0, 0});"
)]
pub struct Translated<T: Real> {
    /// The field or set to move.
    shape: Movable<T>,
    /// Translation vector.
    by: Point<T>,
}

impl<T: Real> Build<T> for Translated<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        self.shape.mapped(&Affine::translation(self.by.xyz))
    }
}

/// A field or set rotated about a line.
#[derive(Kind)]
#[kind(
    forward,
    class = Any,
    function,
    name = "turned",
    example = "AbsPoint a(0, 0, 0); AbsPoint b(0, 0, 1); Line axis(a, b); set s = turned(cuboid({0, 0, 0}, {2, 1, 1}), axis, 0.5);"
)]
pub struct Turned<T: Real> {
    /// The field or set to turn.
    shape: Movable<T>,
    /// The axis, right-handed.
    axis: Axis<T>,
    /// The angle.
    #[field(angle)]
    angle: T,
}

impl<T: Real> Build<T> for Turned<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        self.shape.mapped(&Affine::rotation(&self.axis, self.angle))
    }
}

/// The mirror image of a field or set.
#[derive(Kind)]
#[kind(
    forward,
    class = Any,
    function,
    name = "mirrored",
    example = "set both = set(sphere({0, 2, 0}, 1)); both = both | mirrored(both, \"y=0\");"
)]
pub struct Mirrored<T: Real> {
    /// The field or set to mirror.
    shape: Movable<T>,
    /// A plane, line or point.
    mirror: MirrorArgument<T>,
}

impl<T: Real> Build<T> for Mirrored<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let map = match &self.mirror {
            MirrorArgument::Plane(plane) => Affine::reflection(&unit(plane)),
            MirrorArgument::Line(axis) => Affine::rotation(axis, T::from(std::f64::consts::PI)),
            MirrorArgument::Point(p) => Affine::scaling(*p, T::from(-1.0)),
        };
        self.shape.mapped(&map)
    }
}

fn unit<T: Real>(plane: &Plane<T>) -> Plane<T> {
    Plane { normal: plane.normal.normalized().unwrap_or(plane.normal), ..*plane }
}

/// A field or set scaled about a point.
#[derive(Kind)]
#[kind(
    forward,
    class = Any,
    function,
    name = "scaled",
    example = "set half = scaled(cuboid({0, 0, 0}, {2, 1, 1}), 0.5);"
)]
pub struct Scaled<T: Real> {
    /// The field or set to scale.
    shape: Movable<T>,
    /// The factor, not 0.
    factor: T,
    /// Fixed point; default: the origin.
    #[field(default)]
    centre: Option<Point<T>>,
}

impl<T: Real> Build<T> for Scaled<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let centre = self.centre.map_or_else(Vec3::zero, |p| p.xyz);
        let map = Affine::scaling(centre, self.factor);
        self.shape.mapped(&map).map_err(|f| f.in_field(Self::FACTOR))
    }
}

/// A field or set stretched along a line; the plane across the line's start is fixed.
#[derive(Kind)]
#[kind(
    forward,
    class = Any,
    function,
    name = "stretched",
    example = "AbsPoint a(0, 0, 0); AbsPoint b(0, 0, 1); Line axis(a, b); set egg = stretched(set(sphere({0, 0, 0}, 1)), axis, 1.5);"
)]
pub struct Stretched<T: Real> {
    /// The field or set to stretch.
    shape: Movable<T>,
    /// The line.
    axis: Axis<T>,
    /// The factor, not 0.
    factor: T,
}

impl<T: Real> Build<T> for Stretched<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        if self.factor.re() == 0.0 {
            let zero = crate::FieldError::Degenerate { what: "factor: it is 0" };
            return Err(fault(&zero).in_field(Self::FACTOR));
        }
        self.shape.mapped(&Affine::stretch(&self.axis, self.factor))
    }
}
