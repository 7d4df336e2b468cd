//! Helices.

use super::Ended;
use moldloft_num::{Axis, CurveFormula, Jet, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, Point, Value};
use std::f64::consts::PI;

/// A helix: the point rotated about the line by t angle, right-handed, and translated along it by t
/// pitch angle / (2 pi), with pitch the advance per turn.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel point line angle pitch",
    example = "AbsPoint A(1, 0, 0.5); AbsPoint O(0, 0, 0); AbsPoint Z(0.1, 0, 2); Line axis(O, Z); \
               Helix h(A, axis, 9.5, 0.75);"
)]
pub struct Helix<T: Real> {
    /// Start.
    point: Point<T>,
    /// Its axis, from the line's first end to its last.
    line: Axis<T>,
    /// Total angle of rotation.
    #[field(angle)]
    angle: T,
    /// Advance per turn.
    #[field(default = 0)]
    pitch: T,
}

impl<T: Real> Build<T> for Helix<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { point, line, angle, pitch } = self;
        let away = point.xyz - line.foot(point.xyz);
        let curve = Turning {
            start: point.xyz,
            away,
            side: line.direction.cross(away),
            angle,
            advance: line.direction * (pitch * angle / (2.0 * PI)),
        };
        Ok(Value::Curve(CurveRef::new(Ended::between(curve, [point.key, None]), 0)))
    }
}

struct Turning<T> {
    start: Vec3<T>,
    /// Vector from the axis to the start.
    away: Vec3<T>,
    /// The direction of turning, as long as `away`.
    side: Vec3<T>,
    angle: T,
    advance: Vec3<T>,
}

impl<T: Real> CurveFormula for Turning<T> {
    type Scalar = T;
    fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        let angle = t.scaled(self.angle);
        // Exact at the start.
        let (lost, sine) = (angle.cos() - 1.0, angle.sin());
        self.start.map(J::fixed)
            + self.away.map(|x| lost.scaled(x))
            + self.side.map(|x| sine.scaled(x))
            + self.advance.map(|x| t.scaled(x))
    }

    moldloft_num::curve_facts!(smooth, open, not_rational);
}
