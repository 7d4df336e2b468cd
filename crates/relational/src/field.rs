//! The first implicit primitive: fields are rows like everything else.

use moldloft_num::{Field, Real, Vec3};
use moldloft_registry::{Build, Context, Fault, FieldRef, Kind, Point, Value};

/// The field |X - centre| - radius: the distance from a sphere, negative inside.
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
        let ball = Ball { centre: self.centre.xyz, radius: self.radius };
        Ok(Value::Field(FieldRef::new(ball)))
    }
}

struct Ball<T> {
    centre: Vec3<T>,
    radius: T,
}

impl<T: Real> Field<T> for Ball<T> {
    /// The gradient at the centre, where there is none, is zero.
    fn value_and_gradient(&self, p: Vec3<T>) -> (T, Vec3<T>) {
        let d = p - self.centre;
        let distance = d.norm();
        let gradient = if distance.re() > 0.0 { d / distance } else { Vec3::zero() };
        (distance - self.radius, gradient)
    }
}
