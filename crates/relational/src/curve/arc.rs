//! Circular arcs by three points.

use crate::curve::Ended;
use crate::faults;
use moldloft_num::Real;
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, Point, Value};

/// A circular arc, uniform in angle.
///
/// Six types: 1 through p1, p2 and p3; 2 from p1 about the centre p2, along the shorter arc to the
/// direction of p3; 3 from p1, tangent to the line toward p2, to p3; 4 from p1 to p3, tangent there
/// to the line from p2; 5 the semicircle from p1 to p2 on the side of p3; 6 the full circle from p1
/// about the centre p2, starting toward the side of p3. The numbers of types 1 and 3 to 6 are
/// specific to this program.
///
/// Points in line make types 1 to 4 a straight line, which the arc approaches smoothly.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel type p1 p2 p3",
    example = "AbsPoint A(1, 0, 0); AbsPoint B(0.6, 0.8, 0.1); AbsPoint C(-1, 0, 0); \
               Arc a(A, B, C, type = 1);"
)]
pub struct Arc<T: Real> {
    /// First point.
    p1: Point<T>,
    /// Second point.
    p2: Point<T>,
    /// Third point.
    p3: Point<T>,
    /// One of the six types.
    #[field(default = 1, min = 1, max = 6)]
    r#type: u32,
}

impl<T: Real> Build<T> for Arc<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { p1, p2, p3, r#type } = self;
        let arc = moldloft_spline::CircularArc::of_type(r#type, [p1.xyz, p2.xyz, p3.xyz]);
        let arc = arc.ok_or_else(|| {
            CallError::new("out-of-range", format!("unknown arc type {}", r#type))
                .expected("a type from 1 to 6")
                .found(r#type.to_string())
                .in_field(Self::TYPE)
        })?;
        let end = match r#type {
            2 => None,
            5 => p2.key,
            6 => p1.key,
            _ => p3.key,
        };
        let curve = arc.map_err(|error| faults::of_arc(error, Self::P1))?;
        Ok(Value::Curve(CurveRef::new(Ended::between(curve, [p1.key, end]), 0)))
    }
}
