//! Points in space that need a search.

use super::arguments::{Onto, Target};
use super::magnets::foot;
use moldloft_num::{Order, Real};
use moldloft_registry::{Build, Class, Context, Fault, FromValue, Kind, Mirror, Point, Value};

/// A mirror, or a surface.
pub enum MirrorOrSurface<T: Real> {
    /// A plane, line or point.
    Mirror(Mirror<T>),
    /// A surface, or a magnet of it.
    Surface(Onto<T>),
}

impl<T: Real> FromValue<T> for MirrorOrSurface<T> {
    const CLASS: Class = Class::Target;
    fn from_value(value: &Value<T>) -> Result<Self, Fault> {
        match Target::from_value(value)? {
            Target::Surface(onto) => Ok(Self::Surface(onto)),
            Target::Plane(plane) => Ok(Self::Mirror(Mirror::Plane(plane))),
            Target::Point(point) => Ok(Self::Mirror(Mirror::Point(point))),
            Target::Curve(_) => Mirror::from_value(value).map(Self::Mirror),
        }
    }
}

/// The foot of the perpendicular from a point to a plane, line or surface; for a mirror that is a
/// point, that point.
///
/// On a surface it is the nearest foot; from a magnet of the surface the one that descent from
/// there leads to. A foot that would lie beyond an edge is held at the edge and reported.
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
    /// What to project it to.
    mirror: MirrorOrSurface<T>,
}

impl<T: Real> Build<T> for ProjPoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        let point = match self.mirror {
            MirrorOrSurface::Mirror(mirror) => Point::free(mirror.foot(self.point.xyz)),
            MirrorOrSurface::Surface(onto) => {
                let ([u, v], found) = foot(&onto, self.point.xyz, false)?;
                Point::free(onto.surface.jet(u, v, Order::Zero).p).with_found(found)
            }
        };
        Ok(Value::Point(Box::new(point)))
    }
}
