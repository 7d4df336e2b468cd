//! Curves beside another one, along its tangents.

use crate::third_derivatives::{standstill, tangent};
use moldloft_num::{Curve, CurveFormula, Jet, Order, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, Value};

/// The curve of points on the tangents of another curve, at a distance from the point of contact:
/// C(t) = c(t) + d c'(t) / |c'(t)|; the TanPoint of all beads.
///
/// A corner of the curve, where the tangent jumps, is an error.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel curve distance",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
               TanCurve ahead(c, 0.5); TanCurve behind(c, -0.25);"
)]
pub struct TanCurve<T: Real> {
    /// Curve of the tangents.
    curve: CurveRef<T>,
    /// The distance, in the direction of increasing parameter if positive.
    distance: T,
}

/// Points per smooth piece of the curve that are tested for a missing tangent.
const TRIALS: usize = 32;

/// Speed relative to the greatest below which the tangent counts as zero; tangents at a corner
/// differ by more than its square root.
const TOLERANCE: f64 = 1e-9;

impl<T: Real> Build<T> for TanCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { curve, distance } = self;
        let velocity = |t: f64| curve.jet(T::from(t), Order::First)[1].re();
        let mut ends = vec![0.0];
        ends.extend(curve.breaks());
        ends.push(1.0);
        let mut places: Vec<f64> = Vec::with_capacity(ends.len() * TRIALS);
        for span in ends.windows(2) {
            let at = |k: usize| span[0] + (span[1] - span[0]) * k as f64 / TRIALS as f64;
            places.extend(
                (0..=TRIALS).map(at).map(|t| t.clamp(span[0].next_up(), span[1].next_down())),
            );
        }
        let speeds: Vec<f64> = places.iter().map(|&t| velocity(t).norm()).collect();
        let most = speeds.iter().copied().fold(0.0, f64::max);
        let still = speeds.iter().position(|s| s.is_nan() || *s <= TOLERANCE * most);
        let least = TOLERANCE * most;
        let still = still.map(|k| places[k]).or_else(|| standstill(&curve, &ends, least));
        let fault = |message: &str, t: f64, help: &str| {
            CallError::new("no-tangent", message)
                .expected("a curve with one tangent everywhere")
                .found(format!("none at t = {t}"))
                .help(help)
                .related(curve.key, "is the curve")
                .in_field(Self::CURVE)
        };
        if let Some(t) = still {
            let help = "take a part of the curve without this point";
            return Err(fault("the curve has a zero tangent", t, help));
        }
        for &t in &ends[1..ends.len() - 1] {
            let [a, b] = [velocity(t.next_down()), velocity(t.next_up())];
            let [a, b] = [a / a.norm(), b / b.norm()];
            if (a - b).norm() > TOLERANCE.sqrt() {
                let help = "take a part of the curve on each side of the corner";
                return Err(fault("the curve has a corner, where its tangent jumps", t, help));
            }
        }
        let nesting = curve.depth;
        Ok(Value::Curve(CurveRef::new(AlongTangents { curve, distance }, nesting)))
    }
}

struct AlongTangents<T: Real> {
    curve: CurveRef<T>,
    distance: T,
}

impl<T: Real> CurveFormula for AlongTangents<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        let direction = tangent(|t, order| self.curve.jet(t, order), || self.curve.joints(), t);
        let size = direction.norm();
        self.curve.at(t) + direction * (J::fixed(self.distance) / size)
    }

    /// Its derivatives take one of the curve more.
    fn breaks(&self) -> Vec<f64> {
        self.curve.joints()
    }

    fn joints(&self) -> Vec<f64> {
        self.curve.joints()
    }

    fn kinks(&self) -> Vec<f64> {
        self.curve.breaks()
    }

    moldloft_num::curve_facts!(open, not_rational);
}
