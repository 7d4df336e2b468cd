//! Foil sections as curves.

use super::Ended;
use crate::foil::foil_kind;
use moldloft_num::Real;
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, Point, Value};

foil_kind!(
    /// A foil section between 3, 4 or 5 points: the thickness form and mean line of a NACA family,
    /// or given ordinates.
    ///
    /// Three points: nose, thickness point and tail of half a section, from nose to tail. Four:
    /// tail, thickness point, nose and lower tail of a symmetric section. Five: a lower thickness
    /// point before the lower tail; the camber is half the sum of the two signed thicknesses.
    /// Sections of four and five points extend from the tail along the upper side to the nose at t
    /// = 1/2, and back along the lower side. Only the distance of a thickness point from the chord
    /// matters: it is half the nominal thickness.
    ///
    /// The parameter is the square root of the position along the chord, so that the nose is smooth; the
    /// speed vanishes nowhere. Forms: NACA Reports 460, 492, 537 and 824, TM X-3069 (6-series, for the
    /// thickness ratio that the points have), Brockett 1966 (66tmb).
    #[derive(Kind)]
    #[kind(
        class = Curve,
        columns = "relabel family points",
        example = "AbsPoint N(0, 0, 0); AbsPoint U(0.3, 0.1, 0); AbsPoint D(0.5, -0.02, 0.01); \
                   AbsPoint T(1, 0.01, 0); FoilCurve naca4412({T, U, N, D, T}, offset = \"normal\"); \
                   FoilCurve half({N, U, T}, \"16\"); FoilCurve own({N, U, T}, ordinates = {{0, 0, 0}, {0.3, 1, 0}, {1, 0, 0}});"
    )]
    FoilCurve {
        /// Three, four or five points.
        points (POINTS): Point<T>,
    }
);

impl<T: Real> Build<T> for FoilCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (points, arguments) = self.parts();
        let places: Vec<_> = points.iter().map(|p| p.xyz).collect();
        let (curve, closed, nesting) = arguments.profile(&places)?;
        let [first, last] = [0, points.len() - 1].map(|k| points[k].key);
        let tail = |key| if closed { key } else { None };
        let start = if curve.layout.is_half() { first } else { tail(first) };
        Ok(Value::Curve(CurveRef::new(Ended::between(curve, [start, tail(last)]), nesting)))
    }
}
