//! Chains of cubics.

use moldloft_num::trace::{Key, Trace};
use moldloft_num::{CurveFormula, Jet, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, Point, Value};

/// A chain of cubic Bézier pieces, each over an equal part of t; neighbours share a point.
///
/// The quadratics and Overhauser cubics of sketches are of this kind.
#[derive(Kind)]
#[kind(
    forward,
    class = Curve,
    example = "CubicChain c({{0,0,0}, {1,1,0}, {2,1,0}, {3,0,0}, {4,-1,0}, {5,0,1}, {6,0,0}});"
)]
pub struct CubicChain<T: Real> {
    /// The Bézier points: 3 n + 1 of n pieces.
    #[field(min_items = 4)]
    points: Vec<Point<T>>,
}

impl<T: Real> Build<T> for CubicChain<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let n = self.points.len();
        if n % 3 != 1 {
            return Err(CallError::new(
                "wrong-count",
                format!("{n} points make no chain of cubics"),
            )
            .expected("4, 7, 10, … points: 3 n + 1 for n pieces")
            .found(format!("{n} points"))
            .in_field(Self::POINTS));
        }
        let ends = [self.points.first(), self.points.last()].map(|p| p.and_then(|p| p.key));
        let points = self.points.into_iter().map(|p| p.xyz).collect();
        Ok(Value::Curve(CurveRef::new(PiecewiseBezier { points, ends }, 0)))
    }
}

struct PiecewiseBezier<T> {
    points: Vec<Vec3<T>>,
    ends: [Option<Key>; 2],
}

impl<T: Real> CurveFormula for PiecewiseBezier<T> {
    type Scalar = T;
    fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        let n = (self.points.len() - 1) / 3;
        let piece = (t.value().re() * n as f64).floor().clamp(0.0, (n - 1) as f64);
        let s = t * n as f64 - piece;
        let w = -s + 1.0;
        let weights = [w * w * w, w * w * s * 3.0, w * s * s * 3.0, s * s * s];
        let own = &self.points[3 * piece as usize..];
        (weights.iter().zip(own))
            .fold(Vec3::<T>::zero().map(J::fixed), |sum, (w, p)| sum + p.map(|x| w.scaled(x)))
    }

    fn breaks(&self) -> Vec<f64> {
        let n = (self.points.len() - 1) / 3;
        (1..n).map(|k| k as f64 / n as f64).collect()
    }

    fn trace(&self) -> Trace<T> {
        Trace::Own(self.ends)
    }

    moldloft_num::curve_facts!(broken, open, not_rational);
}
