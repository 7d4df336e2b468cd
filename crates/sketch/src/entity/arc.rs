//! Arcs by conjugate half-diameters.

use moldloft_num::trace::Trace;
use moldloft_num::{CurveFormula, Jet, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, Point, Value};

/// An arc of a circle or ellipse by two conjugate half-diameters:
/// C(t) = M + (S - M) cos(t sweep) + (Q - M) sin(t sweep).
///
/// It is circular when both half-diameters are perpendicular and equally long. The fillets, circles
/// and ellipses of sketches are of this kind.
#[derive(Kind)]
#[kind(
    forward,
    class = Curve,
    example = "AbsPoint M(0, 0, 0); AbsPoint S(2, 0, 0); AbsPoint Q(0, 1, 0); \
               ConjugateArc c(M, S, Q, 1.5707963267948966);"
)]
pub struct ConjugateArc<T: Real> {
    /// Centre M.
    centre: Point<T>,
    /// Start S, at t = 0.
    start: Point<T>,
    /// The point Q a quarter turn after the start.
    quarter: Point<T>,
    /// The angle swept from t = 0 to 1, in radians; negative turns away from Q.
    sweep: T,
    /// The point object at t = 1, if any.
    #[field(default)]
    end: Option<Point<T>>,
}

impl<T: Real> Build<T> for ConjugateArc<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let centre = self.centre.xyz;
        let end = self.end.and_then(|p| p.key);
        let arc = EllipticArc {
            centre,
            a: self.start.xyz - centre,
            b: self.quarter.xyz - centre,
            sweep: self.sweep,
            ends: [self.start.key, end],
        };
        Ok(Value::Curve(CurveRef::new(arc, 0)))
    }
}

struct EllipticArc<T> {
    centre: Vec3<T>,
    a: Vec3<T>,
    b: Vec3<T>,
    sweep: T,
    ends: [Option<moldloft_num::trace::Key>; 2],
}

impl<T: Real> CurveFormula for EllipticArc<T> {
    type Scalar = T;
    fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        let angle = t.scaled(self.sweep);
        let (c, s) = (angle.cos(), angle.sin());
        self.centre.map(J::fixed) + self.a.map(|a| c.scaled(a)) + self.b.map(|b| s.scaled(b))
    }

    fn trace(&self) -> Trace<T> {
        Trace::Own(self.ends)
    }

    moldloft_num::curve_facts!(smooth, open, not_rational);
}
