//! Curves at a distance from others in a plane.

use crate::faults::{digits, parameter};
use crate::third_derivatives::{direction, standstill};
use moldloft_num::{Curve, CurveFormula, Jet, Order, Plane, Real, Uni1, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, Value};

/// A curve at a distance from another in a plane: C(t) = c(t) + d T x n / |T x n|, with T the
/// tangent and n the normal of the plane. A positive d is to the right of the direction of travel,
/// seen from the positive side of the plane.
///
/// At an end of zero speed, such as a double control point, T is the limit from inside. Zero speed
/// inside, or a distance beyond the radius of curvature on that side (a cusp of the offset), is an
/// error.
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
    /// Plane of the offset, or a plane parallel to it.
    plane: Plane<T>,
}

/// Points per span that are tested for cusps.
const CUSP_TRIALS: usize = 32;

/// Sine of the angle between the tangent and the plane's normal below which there is no offset
/// direction, and speed relative to the greatest speed below which there is no tangent.
const NO_TANGENT: f64 = 1e-9;

impl<T: Real> Build<T> for OffsetCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { curve, distance, plane } = self;
        let nesting = curve.depth;
        let shape = ParallelCurve { curve, distance, normal: plane.normal };
        shape.check()?;
        Ok(Value::Curve(CurveRef::new(shape, nesting)))
    }
}

struct ParallelCurve<T: Real> {
    curve: CurveRef<T>,
    distance: T,
    normal: Vec3<T>,
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

    /// Refuses a curve without a tangent somewhere, and a distance beyond a radius of curvature.
    fn check(&self) -> Result<(), CallError> {
        let mut ends = vec![0.0];
        ends.extend(self.curve.breaks());
        ends.push(1.0);
        let mut places = Vec::with_capacity(ends.len() * (CUSP_TRIALS + 1));
        for span in ends.windows(2) {
            let at = |k: usize| span[0] + (span[1] - span[0]) * k as f64 / CUSP_TRIALS as f64;
            // Breaks are tested from both sides, both ends from inside.
            let inside = |t: f64| match t {
                0.0 | 1.0 => t,
                _ => t.clamp(span[0].next_up(), span[1].next_down()),
            };
            places.extend((0..=CUSP_TRIALS).map(at).map(inside));
        }
        let speed = |t: &f64| self.curve.jet(T::from(*t), Order::First)[1].re().norm();
        let fastest = places.iter().map(speed).fold(0.0, f64::max);
        if let Some(t) = standstill(&self.curve, &ends, NO_TANGENT * fastest) {
            return Err(self.no_tangent(t));
        }
        // Speed of the offset relative to the curve's own: at most 0 at a cusp.
        let mut worst = (f64::INFINITY, 0.0);
        for t in places {
            let progress = self.progress(t).ok_or_else(|| self.no_tangent(t))?;
            if progress < worst.0 {
                worst = (progress, t);
            }
        }
        if worst.0 > 0.0 {
            return Ok(());
        }
        let (d, t) = (self.distance.re(), worst.1);
        let radius = d.abs() / (1.0 - worst.0);
        Err(CallError::new("cusp", "the offset exceeds the radius of curvature")
            .expected(format!("a distance less than {} on that side", digits(radius)))
            .found(format!("{} where t = {}", d.abs(), parameter(t)))
            .help("offset by less, or to the other side, or only a part of the curve")
            .related(self.curve.key, "has too large a curvature there")
            .in_field(OffsetCurve::<T>::DISTANCE))
    }

    fn no_tangent(&self, t: f64) -> CallError {
        CallError::new("no-tangent", "the curve has no sideways direction")
            .expected("a tangent that is not along the normal of the plane")
            .found(format!("none at t = {}", parameter(t)))
            .related(self.curve.key, "is the curve")
            .in_field(OffsetCurve::<T>::CURVE)
    }

    /// A vector along the curve at a parameter that may be a jet.
    fn direction<J: Jet<T>>(curve: &dyn Curve<T>, t: J) -> Vec3<J> {
        direction(|t, order| curve.jet(t, order), || curve.joints(), t)
    }

    /// The component of the offset's velocity along the curve's, relative to the latter; at zero
    /// speed, a number with the sign of the limit from inside.
    fn progress(&self, t: f64) -> Option<f64> {
        let along = Self::direction(&*self.curve, Uni1::parameter(T::from(t)));
        let (d, rate) = (along.map(|a| a.f.re()), along.map(|a| a.t.re()));
        let normal = self.normal.re();
        let across = d.cross(normal);
        let (size, square) = (across.norm(), d.norm_sq());
        // Written so that NaN is refused.
        if !(size > NO_TANGENT * square.sqrt() && square > 0.0) {
            return None;
        }
        let e = across / size;
        let b = rate.cross(normal);
        let turning = (b - e * e.dot(b)) / size * self.distance.re();
        let velocity = self.curve.jet(T::from(t), Order::First)[1].re();
        if velocity.norm_sq() > 0.0 {
            return Some((velocity + turning).dot(velocity) / velocity.norm_sq());
        }
        // Curvature is infinite there unless the curve is straight.
        let gain = turning.dot(d);
        Some(if gain.abs() <= NO_TANGENT * square { 1.0 } else { gain / square })
    }
}

impl<T: Real> CurveFormula for ParallelCurve<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        let (curve, distance) = self.base();
        let sideways = Self::direction(curve, t).cross(self.normal.map(J::fixed));
        curve.at(t) + sideways * (J::fixed(distance) / sideways.norm())
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

    fn parallel_to(&self) -> Option<(&dyn Curve<T>, Vec3<T>, T)> {
        let (curve, distance) = self.base();
        Some((curve, self.normal, distance))
    }

    moldloft_num::curve_facts!(open, not_rational);
}
