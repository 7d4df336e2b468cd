use super::tables::{FAMILIES, Family};
use super::thickness::Thickness;
use crate::{End, Ends, InterpolatingSpline};
use moldloft_num::{Curve, Order, Real, Vec3, find_root};
use std::f64::consts::PI;
use std::sync::Arc;

/// Intervals of s at which the mapping is sampled: their spline is within 1e-7 of it.
const STEPS: usize = 128;

/// Ratios of thickness that the scale polynomials serve; beyond, the nearest form is stretched.
const RATIOS: (f64, f64) = (0.02, 0.24);

/// The mapping of a circle to a thickness form (Theodorsen 1931; Abbott and von Doenhoff 1959,
/// section 3.6): the point exp(psi_0 + i phi) goes to z = exp(psi + i (phi - epsilon)), and that to
/// z + 1/z, which is normalised to the unit chord.
struct Mapping<T: Real> {
    epsilon: InterpolatingSpline<f64>,
    psi: InterpolatingSpline<f64>,
    scale: T,
}

impl<T: Real> Mapping<T> {
    fn new(family: &Family, scale: T) -> Self {
        let n = family.psi.len() - 1;
        let knots: Vec<f64> = (0..=n).map(|k| k as f64 * PI / n as f64).collect();
        // Epsilon is odd about both ends, psi even.
        let spline = |values: &[u16; 41], end: End<f64>| {
            let points: Vec<Vec3> =
                values.iter().map(|&x| Vec3::of(f64::from(x) * 1e-5, 0.0, 0.0)).collect();
            InterpolatingSpline::with_knots(&knots, &points, Ends::Open(end, end))
                .expect("the table ascends")
        };
        Self {
            epsilon: spline(&family.epsilon, End::Natural),
            psi: spline(&family.psi, End::Clamped(Vec3::zero())),
            scale,
        }
    }

    /// The scaled functions psi and phi - epsilon, and their derivatives by phi.
    fn parts(&self, phi: T) -> [(T, T); 2] {
        let of = |spline: &InterpolatingSpline<f64>| {
            let [p, d, _] = spline.jet(phi.re(), Order::First);
            ((phi - phi.re()) * d.x + p.x, d.x)
        };
        let ((psi, psi_rate), (epsilon, epsilon_rate)) = (of(&self.psi), of(&self.epsilon));
        let scaled = |x: f64| self.scale * x;
        [
            (psi * self.scale, scaled(psi_rate)),
            (phi - epsilon * self.scale, -scaled(epsilon_rate) + 1.0),
        ]
    }

    /// The ordinates (x, y) at phi, with the nose at 0 and the tail at 1, and dx/dphi.
    ///
    /// z + 1/z is 2 (cosh psi cos angle + i sinh psi sin angle). The distance from the nose is a
    /// sum of two squares, so that it keeps its digits near the nose.
    fn at(&self, phi: T) -> (T, T, T) {
        let [(nose, _), _] = self.parts(T::zero());
        let [(tail, _), _] = self.parts(T::from(PI));
        let [(psi, psi_rate), (angle, angle_rate)] = self.parts(phi);
        let (ch, sh, c, s) = (psi.cosh(), psi.sinh(), angle.cos(), angle.sin());
        let chord = nose.cosh() + tail.cosh();
        let half = (angle * 0.5).sin();
        let bend = ((nose + psi) * 0.5).sinh() * ((nose - psi) * 0.5).sinh();
        let x = (bend + ch * half * half) * 2.0 / chord;
        let rate = (ch * s * angle_rate - sh * c * psi_rate) / chord;
        (x, sh * s / chord, rate)
    }
}

/// The thickness form of a family at the thickness ratio `ratio`; `None` for another name.
pub(super) fn thickness<T: Real>(name: &str, ratio: T) -> Option<Thickness<T>> {
    let family = FAMILIES.iter().find(|family| family.name == name)?;
    let ratio = if (RATIOS.0..=RATIOS.1).contains(&ratio.re()) {
        ratio
    } else {
        T::from(ratio.re().clamp(RATIOS.0, RATIOS.1))
    };
    let scale = family.scale.iter().rev().fold(T::zero(), |sum, &c| (sum + c) * ratio);
    let mapping = Mapping::new(family, scale);
    let mut knots = Vec::with_capacity(STEPS + 1);
    let mut points = Vec::with_capacity(STEPS + 1);
    let mut top = (0.0, 0.0);
    for k in 0..=STEPS {
        let s = k as f64 / STEPS as f64;
        let y = match k {
            0 => T::zero(),
            _ if k == STEPS => mapping.at(T::from(PI)).1,
            _ => {
                let at = |phi: f64| mapping.at(T::from(phi));
                let phi = find_root(|phi| at(phi).0.re() - s * s, 0.0, PI).unwrap_or(s * PI);
                // One step in T gives the derivatives of the root.
                let (x, _, rate) = at(phi);
                let step = -(x - s * s) / rate;
                mapping.at(step - step.re() + phi).1
            }
        };
        let y = y * 2.0 / ratio;
        if y.re() > top.1 {
            top = (s * s, y.re());
        }
        knots.push(T::from(s));
        points.push(Vec3::new(T::from(s), y, T::zero()));
    }
    let spline = InterpolatingSpline::with_knots(&knots, &points, Ends::default());
    let spline = Arc::new(spline.expect("the samples ascend"));
    Some(Thickness::Spline { spline, at: top.0, cambered: false })
}
