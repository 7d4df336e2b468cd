use crate::curve::Ended;
use moldloft_num::{CurveFormula, Jet, Real, Vec3};
use moldloft_registry::{Build, Context, CurveRef, Fault, Kind, Point, Value};

/// A straight line: C(t) = (1 - t) P1 + t P2.
///
/// Coincident points are allowed, but then the line serves no purpose that needs a direction.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel p1 p2",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); Line l(A, B);"
)]
pub struct Line<T: Real> {
    /// Start.
    p1: Point<T>,
    /// End.
    p2: Point<T>,
}

impl<T: Real> Build<T> for Line<T> {
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        let curve = Segment { from: self.p1.xyz, to: self.p2.xyz };
        let line = Ended { curve, ends: [self.p1.key, self.p2.key] };
        Ok(Value::Curve(CurveRef::new(line, 0)))
    }
}

/// The line between two positions, linear in t.
#[derive(Clone, Copy, Debug)]
pub struct Segment<T> {
    /// Position at t = 0.
    pub from: Vec3<T>,
    /// Position at t = 1.
    pub to: Vec3<T>,
}

impl<T: Real> CurveFormula for Segment<T> {
    type Scalar = T;
    fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        // This form, unlike a + t (b - a), is exact at both ends.
        let s = -t + 1.0;
        self.from.map(|a| s.scaled(a)) + self.to.map(|b| t.scaled(b))
    }
}
