//! Straight lines.

use moldloft_num::trace::{Key, Trace};
use moldloft_num::{CurveFormula, Jet, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, Point, Value};

/// A straight line: C(t) = (1 - t) P1 + t P2.
///
/// Coincident points are allowed, but then the line serves no purpose that needs a direction. A line
/// from a point to itself is that point: as a master it makes a pole. Lines between the same two
/// points are one for meshes, and so are the straight edges of surfaces between them.
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
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let segment = Segment { from: self.p1.xyz, to: self.p2.xyz };
        let line = Straight { segment, ends: [self.p1.key, self.p2.key] };
        Ok(Value::Curve(CurveRef::new(line, 0)))
    }
}

struct Straight<T> {
    segment: Segment<T>,
    ends: [Option<Key>; 2],
}

impl<T: Real> CurveFormula for Straight<T> {
    type Scalar = T;
    fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        self.segment.at(t)
    }
    fn trace(&self) -> Trace<T> {
        Trace::straight(self.ends)
    }

    moldloft_num::curve_facts!(smooth, open, not_rational);
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

    moldloft_num::curve_facts!(smooth, open, not_rational);
}
