//! Curves at a distance from others in a plane.

use moldloft_num::{Curve, CurveJet, Order, Plane, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, Value};

/// A curve at a distance from another, sideways in a plane: C(t) = c(t) + d T x n / |T x n|, with T
/// the tangent and n the normal of the plane; to the right of the direction of travel, seen from the
/// positive side, if d is positive.
///
/// It is refused where the distance exceeds the radius of curvature on that side, since the offset
/// has a cusp there.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel curve distance plane",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 2, 0.25); AbsPoint C(4, 0, 0); BCurve c({A, B, C}); \
               OffsetCurve outside(c, -0.5, \"z=0\"); OffsetCurve inside(c, 0.25, \"z=0\");"
)]
pub struct OffsetCurve<T: Real> {
    /// The curve that is offset.
    curve: CurveRef<T>,
    /// The distance.
    distance: T,
    /// The plane in which, or parallel to which, it is offset.
    plane: Plane<T>,
}

/// Each span of the curve is tried at so many places for cusps.
const TRIALS: usize = 32;

impl<T: Real> Build<T> for OffsetCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { curve, distance, plane } = self;
        let (nesting, key) = (curve.depth, curve.key);
        let mut ends = vec![0.0];
        ends.extend(curve.breaks());
        ends.push(1.0);
        let shape = ParallelCurve { curve, distance, normal: plane.normal, ends };
        // How fast the offset moves on, in units of the curve's own speed: at most 0 at a cusp.
        let mut worst = (f64::INFINITY, 0.0);
        for span in shape.ends.windows(2) {
            let at = |k: f64| span[0] + (span[1] - span[0]) * k / TRIALS as f64;
            for k in 0..=TRIALS {
                let t = at(k as f64).clamp(span[0].next_up(), span[1].next_down());
                let Some(progress) = shape.progress(t) else {
                    return Err(CallError::new(
                        "no-tangent",
                        "the curve has no sideways direction",
                    )
                    .expected("a tangent that is not along the normal of the plane")
                    .found(format!("none at t = {t}"))
                    .related(key, "is the curve")
                    .in_field(Self::CURVE));
                };
                if progress < worst.0 {
                    worst = (progress, t);
                }
            }
        }
        if worst.0 <= 0.0 {
            let (d, t) = (distance.re(), worst.1);
            let radius = d.abs() / (1.0 - worst.0);
            return Err(CallError::new("cusp", "the offset exceeds the radius of curvature")
                .expected(format!("a distance less than {radius} on that side"))
                .found(format!("{} where t = {t}", d.abs()))
                .help("offset by less, or to the other side, or only a part of the curve")
                .related(key, "is bent too much there")
                .in_field(Self::DISTANCE));
        }
        Ok(Value::Curve(CurveRef::new(shape, nesting)))
    }
}

struct ParallelCurve<T: Real> {
    curve: CurveRef<T>,
    distance: T,
    normal: Vec3<T>,
    /// The breaks of the curve, with 0 and 1.
    ends: Vec<f64>,
}

impl<T: Real> ParallelCurve<T> {
    /// The first curve of a chain of parallels in this plane, and the distance from it.
    fn base(&self) -> (&dyn Curve<T>, T) {
        match self.curve.parallel_to() {
            Some((base, normal, distance)) if (0..3).all(|k| normal[k].bits_eq(self.normal[k])) => {
                (base, distance + self.distance)
            }
            _ => (&*self.curve, self.distance),
        }
    }

    /// The unit vector sideways of a direction, and its derivative along the rate of that.
    fn sideways(&self, d: Vec3<T>, rate: Vec3<T>) -> (Vec3<T>, Vec3<T>) {
        let (a, b) = (d.cross(self.normal), rate.cross(self.normal));
        let size = a.norm();
        let e = a / size;
        (e, (b - e * e.dot(b)) / size)
    }

    /// The component of the offset's velocity along the curve's, in units of the latter.
    fn progress(&self, t: f64) -> Option<f64> {
        let [_, d, dd] = self.curve.jet(T::from(t), Order::Second);
        let across = d.re().cross(self.normal.re()).norm();
        let speed = d.re().norm();
        // Written so that NaN is refused.
        if !(across > 1e-9 * speed && speed > 0.0) {
            return None;
        }
        let (_, turning) = self.sideways(d, dd);
        Some(((d + turning * self.distance).dot(d) / d.norm_sq()).re())
    }

    /// The third derivative of the curve at `t`, from second derivatives beside it in its span:
    /// curves give two derivatives only, and this one counts in the offset's second alone. The
    /// rule is exact for polynomials of degree 6.
    fn third(&self, curve: &dyn Curve<T>, t: T) -> Vec3<T> {
        let k = self.ends[1..self.ends.len() - 1].partition_point(|end| *end <= t.re());
        let (low, high) = (self.ends[k], self.ends[k + 1]);
        let h = (high - low).min(1.0) * 2e-3;
        // Slopes at `t` of the polynomial through five values; near an end all on one side.
        let near_low = t.re() - low < 2.0 * h;
        let near_high = high - t.re() < 2.0 * h;
        let (steps, weights): ([f64; 5], [f64; 5]) = if near_low {
            ([0.0, 1.0, 2.0, 3.0, 4.0], [-25.0, 48.0, -36.0, 16.0, -3.0])
        } else if near_high {
            ([0.0, -1.0, -2.0, -3.0, -4.0], [25.0, -48.0, 36.0, -16.0, 3.0])
        } else {
            ([-2.0, -1.0, 0.0, 1.0, 2.0], [1.0, -8.0, 0.0, 8.0, -1.0])
        };
        let mut sum = Vec3::zero();
        for (step, weight) in steps.into_iter().zip(weights).filter(|(_, w)| *w != 0.0) {
            let second = curve.jet(t + step * h, Order::Second)[2];
            sum += second * T::from(weight / (12.0 * h));
        }
        sum
    }
}

impl<T: Real> Curve<T> for ParallelCurve<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        let of_curve = if order == Order::Zero { Order::First } else { Order::Second };
        let (curve, distance) = self.base();
        let [p, d, dd] = curve.jet(t, of_curve);
        let (e, turning) = self.sideways(d, dd);
        let mut jet = [p + e * distance, Vec3::zero(), Vec3::zero()];
        if order >= Order::First {
            jet[1] = d + turning * distance;
        }
        if order == Order::Second {
            // With a = T x n and e = a / |a|: e'' from a'' by the quotient rule.
            let (b, c) = (dd.cross(self.normal), self.third(curve, t).cross(self.normal));
            let size = d.cross(self.normal).norm();
            let rate = e.dot(b);
            let bend = turning.dot(b) + e.dot(c);
            let second = (c - turning * rate - e * bend - turning * rate) / size;
            jet[2] = dd + second * distance;
        }
        jet
    }

    fn breaks(&self) -> Vec<f64> {
        self.ends[1..self.ends.len() - 1].to_vec()
    }

    fn parallel_to(&self) -> Option<(&dyn Curve<T>, Vec3<T>, T)> {
        let (curve, distance) = self.base();
        Some((curve, self.normal, distance))
    }
}
