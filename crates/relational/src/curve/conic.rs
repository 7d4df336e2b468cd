//! Conic sections by three points and a shape factor.

use crate::curve::Ended;
use moldloft_num::trace::Key;
use moldloft_num::{CurveFormula, Jet, Pace, Rational, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, Point, Value};

/// A conic section in the plane of three points: C = P1 + f(a) (P2 - P1) + g(a) (P3 - P1), where
/// a = a1 + t (a2 - a1).
///
/// Type 1 is an ellipse, f = cos a and g = sin a, with its centre at p1 and p2, p3 the ends of
/// conjugate half diameters (of the half axes where they are perpendicular). Type 2 is a branch of
/// a hyperbola, f = cosh a and g = sinh a, and type 3 a parabola, f = a^2 and g = a (our numbers).
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel type p1 p2 p3 a1 a2",
    example = "AbsPoint O(0, 0, 0); AbsPoint A(3, 0, 0); AbsPoint B(0.2, 2, 1); \
               Conic e(O, A, B, a1 = 0.25, a2 = 4); Conic h(O, A, B, -1, 1, 2); \
               Conic p(O, A, B, -0.5, 1, type = 3);"
)]
pub struct Conic<T: Real> {
    /// Centre, or vertex of a parabola.
    p1: Point<T>,
    /// The point of a = 0 on an ellipse or hyperbola.
    p2: Point<T>,
    /// The end of the conjugate half diameter.
    p3: Point<T>,
    /// Start of the curve.
    #[field(angle, default = 0)]
    a1: T,
    /// End angle; default: a full turn.
    #[field(angle, default = std::f64::consts::TAU)]
    a2: T,
    /// 1 for an ellipse, 2 for a hyperbola, 3 for a parabola.
    #[field(default = 1, min = 1, max = 3)]
    r#type: u32,
}

impl<T: Real> Build<T> for Conic<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { p1, p2, p3, a1, a2, r#type } = self;
        let (first, second) = (p2.xyz - p1.xyz, p3.xyz - p1.xyz);
        let shape = Oblique { centre: p1.xyz, first, second, a1, a2, kind: r#type };
        let ends = shape.ends([p2.key, p3.key]);
        Ok(Value::Curve(CurveRef::new(Ended::between(shape, ends), 0)))
    }
}

/// The path of a conic; also in the parameter plane of a surface.
pub struct Oblique<T> {
    /// P1.
    pub centre: Vec3<T>,
    /// P2 - P1.
    pub first: Vec3<T>,
    /// P3 - P1.
    pub second: Vec3<T>,
    /// Start.
    pub a1: T,
    /// End.
    pub a2: T,
    /// Its type, 1 to 3.
    pub kind: u32,
}

impl<T: Real> Oblique<T> {
    /// The point objects at its two ends, of those at the ends of its half diameters: the first where it
    /// begins or ends at 0 or after a full turn, the second at a right angle.
    pub fn ends(&self, [first, second]: [Option<Key>; 2]) -> [Option<Key>; 2] {
        use std::f64::consts::{FRAC_PI_2, TAU};
        let at = |angle: f64| match self.kind {
            1 if angle == 0.0 || angle.abs() == TAU => first,
            1 if angle == FRAC_PI_2 || angle == FRAC_PI_2 + TAU => second,
            // Only an ellipse passes through the end of its second half diameter.
            2 if angle == 0.0 => first,
            _ => None,
        };
        [at(self.a1.re()), at(self.a2.re())]
    }
}

impl<T: Real> CurveFormula for Oblique<T> {
    type Scalar = T;
    fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        let a = (-t + 1.0).scaled(self.a1) + t.scaled(self.a2);
        let (f, g) = match self.kind {
            1 => (a.cos(), a.sin()),
            2 => (a.cosh(), a.sinh()),
            _ => (a * a, a),
        };
        self.centre.map(J::fixed)
            + self.first.map(|x| f.scaled(x))
            + self.second.map(|x| g.scaled(x))
    }

    fn rational(&self) -> Rational<1> {
        match self.kind {
            1 => Rational::paced([Pace::Angle((self.a2 - self.a1).re())]),
            _ => Rational::none(),
        }
    }

    moldloft_num::curve_facts!(smooth, open);
}
