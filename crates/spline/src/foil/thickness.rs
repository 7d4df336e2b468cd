//! Thickness forms of foils: four-digit, modified, 16-series, and those of propellers.

use super::error::FoilError;
use super::six_series::{Blended, STEPS};
use crate::{End, Ends, InterpolatingSpline};
use moldloft_num::{Curve, Jet, Real, Vec3, lift_curve};
use std::sync::Arc;

/// Half thickness over the chord, in units of half the (nominal) greatest thickness, as a function
/// of s >= 0 with x = s^2.
#[derive(Clone)]
pub enum Thickness<T: Real> {
    /// Coefficients of s, s^2, s^4, s^6 and s^8.
    Polynomial([f64; 5]),
    /// Two polynomials that meet at `at`: in s, x, x^2 and x^3 before it, and in the powers 0 to 3
    /// of 1 - x behind it.
    Joined {
        /// In front of the greatest thickness.
        nose: [T; 4],
        /// Behind it.
        tail: [T; 4],
        /// The position x of the greatest thickness.
        at: T,
    },
    /// A spline over s, whose y is the thickness (and z the camber).
    Spline {
        /// The spline.
        spline: Arc<InterpolatingSpline<T>>,
        /// The approximate position x of the greatest thickness.
        at: f64,
        /// True when its z is the camber.
        cambered: bool,
    },
    /// A form of the 6-series, which depends on the ratio of thickness.
    Family(Blended<T>),
    /// A curve of (x, thickness, camber).
    Curve(Arc<dyn Curve<T>>),
    /// Another form, minus its thickness at the trailing edge times the cube of the relative
    /// position behind `at`.
    Closed {
        /// The form.
        open: Box<Thickness<T>>,
        /// Start of the correction, as x.
        at: T,
        /// Thickness at the tail.
        rest: T,
    },
}

/// NACA 66 (TMB modified): x and half thickness in units of half the greatest (Brockett 1966,
/// DTMB Report 1780, as tabulated by OpenProp).
pub(super) const TMB: [(f64, f64); 21] = [
    (0.005, 0.1330),
    (0.0075, 0.1624),
    (0.0125, 0.2088),
    (0.025, 0.2932),
    (0.05, 0.4132),
    (0.075, 0.5050),
    (0.1, 0.5814),
    (0.15, 0.7042),
    (0.2, 0.8000),
    (0.25, 0.8726),
    (0.3, 0.9274),
    (0.35, 0.9664),
    (0.4, 0.9904),
    (0.45, 1.0),
    (0.5, 0.9924),
    (0.6, 0.9306),
    (0.7, 0.8070),
    (0.8, 0.6220),
    (0.9, 0.3754),
    (0.95, 0.2286),
    (1.0, 0.0666),
];

/// The radius of the nose in units of thickness^2 / chord (Brockett's published figure), which
/// gives d(thickness)/ds at the nose.
const TMB_NOSE_RADIUS: f64 = 0.448;

impl<T: Real> Thickness<T> {
    /// The NACA four-digit form (Jacobs, Ward and Pinkerton, NACA Report 460, 1933): the half
    /// thickness is 5 T (0.2969 s - 0.1260 s^2 - 0.3516 s^4 + 0.2843 s^6 - 0.1015 s^8).
    pub fn four_digit(closed: bool) -> Self {
        let last = if closed { -1.036 } else { -1.015 };
        Thickness::Polynomial([2.969, -1.260, -3.516, 2.843, last])
    }

    /// The modified four-digit form (Stack and von Doenhoff, NACA Report 492, 1934) with the nose
    /// index `index` and the greatest thickness at x = `m`: both polynomials have the same value,
    /// zero slope and the same curvature there.
    pub fn modified(index: T, m: T) -> Self {
        // Nose: 0.296904 index / 6 at the thickness 0.2; index 9 means sqrt 3.
        let a0 = if index.re() > 8.0 {
            // Linear from index 8 to 9, to the step in the tables.
            let low = T::from(8.0 / 6.0);
            low + (index - 8.0) * (3f64.sqrt() - 8.0 / 6.0)
        } else {
            index / 6.0
        } * 0.296_904;
        let d1 = tail_angle(m);
        let n = -m + 1.0;
        let d2 = (-(n * d1 * 2.0) + 0.294) / (n * n);
        let d3 = (n * d1 - 0.196) / (n * n * n);
        let radius = n * n * 0.2 / (-(n * d1 * 2.0) + 0.588);
        let root = m.sqrt();
        let a1 = T::from(0.3) / m - a0 / root * (15.0 / 8.0) - m / (radius * 10.0);
        let a2 = -(T::from(0.3) / (m * m)) + a0 / (m * root) * 1.25 + T::one() / (radius * 5.0);
        let a3 = T::from(0.1) / (m * m * m)
            - a0 / (m * m * root) * 0.375
            - T::one() / (m * radius * 10.0);
        let scaled = |c: [T; 4]| c.map(|c| c * 10.0);
        Thickness::Joined {
            nose: scaled([a0, a1, a2, a3]),
            tail: scaled([T::from(0.002), d1, d2, d3]),
            at: m,
        }
    }

    /// NACA 66 (TMB modified): a spline through its table in s, with the published leading-edge
    /// radius.
    pub fn tmb() -> Self {
        // thickness / s is even and tame at the nose: half thickness = (t/2) y, x = s^2, so the
        // radius of the nose is (t/2 y')^2 / 2.
        let slope = (8.0 * TMB_NOSE_RADIUS).sqrt();
        let mut knots = vec![T::zero()];
        let mut points = vec![Vec3::zero()];
        for (x, y) in TMB {
            knots.push(T::from(x.sqrt()));
            points.push(Vec3::of(x.sqrt(), y, 0.0));
        }
        let ends = Ends::Open(End::Clamped(Vec3::of(1.0, slope, 0.0)), End::NotAKnot);
        let spline = InterpolatingSpline::with_knots(&knots, &points, ends);
        let spline = Arc::new(spline.expect("the table ascends"));
        Thickness::Spline { spline, at: 0.45, cambered: false }
    }

    /// The spline through ordinates (x, thickness, camber) over the square root of x.
    ///
    /// # Errors
    /// [`FoilError::Ordinates`] unless x ascends from 0 to 1.
    pub fn of_ordinates(ordinates: &[Vec3<T>]) -> Result<Self, FoilError> {
        let wrong = |index, what| Err(FoilError::Ordinates { index, what });
        if ordinates.len() < 3 {
            return wrong(ordinates.len(), "is missing: three at least are needed");
        }
        if let Some(index) = ordinates.iter().position(|p| !p.is_finite()) {
            return wrong(index, "is not finite");
        }
        let last = ordinates.len() - 1;
        if ordinates[0].x.re() != 0.0 {
            return wrong(0, "is not at x = 0, the leading edge");
        }
        if ordinates[last].x.re() != 1.0 {
            return wrong(last, "is not at x = 1, the trailing edge");
        }
        if let Some(k) = (1..=last).find(|&k| ordinates[k].x.re() <= ordinates[k - 1].x.re()) {
            return wrong(k, "is not behind the one before");
        }
        let knots: Vec<T> = (0..=last)
            .map(|k| match k {
                0 => T::zero(),
                _ if k == last => T::one(),
                _ => ordinates[k].x.sqrt(),
            })
            .collect();
        let mut highest = 0;
        for k in 1..=last {
            if ordinates[k].y.re() > ordinates[highest].y.re() {
                highest = k;
            }
        }
        let points: Vec<Vec3<T>> =
            knots.iter().zip(ordinates).map(|(&s, p)| Vec3::new(s, p.y, p.z)).collect();
        let spline = InterpolatingSpline::with_knots(&knots, &points, Ends::default());
        match spline {
            Ok(spline) => Ok(Thickness::Spline {
                spline: Arc::new(spline),
                at: ordinates[highest].x.re(),
                cambered: true,
            }),
            Err(_) => wrong(last, "does not form a spline with the others"),
        }
    }

    /// The form with a closed trailing edge; a closed form is unchanged, up to rounding.
    pub fn closed(self) -> Self {
        let rest = self.at::<T>(T::one()).1;
        let at = match &self {
            Thickness::Joined { at, .. } => *at,
            Thickness::Spline { at, .. } => T::from(*at),
            Thickness::Family(form) => form.top(),
            // Only rounding is left there.
            Thickness::Polynomial(_) => T::from(0.3),
            _ => return self,
        };
        Thickness::Closed { open: Box::new(self), at, rest }
    }

    /// x, half thickness and, if the form has one, camber at `s` >= 0.
    pub fn at<J: Jet<T>>(&self, s: J) -> (J, J, Option<J>) {
        let x = s * s;
        match self {
            Thickness::Polynomial([a, b, c, d, e]) => {
                let even = ((x * *e + *d) * x + *c) * x + *b;
                (x, (even * s + *a) * s, None)
            }
            Thickness::Joined { nose: [a, b, c, d], tail: [p, q, r, u], at } => {
                let y = if x.re() < at.re() {
                    let inner = (x.scaled(*d) + J::fixed(*c)) * x + J::fixed(*b);
                    (inner * s + J::fixed(*a)) * s
                } else {
                    let z = -x + 1.0;
                    ((z.scaled(*u) + J::fixed(*r)) * z + J::fixed(*q)) * z + J::fixed(*p)
                };
                (x, y, None)
            }
            Thickness::Spline { spline, cambered, .. } => {
                let p = lift_curve(&spline.jet(s.value(), J::ORDER), s);
                (x, p.y, cambered.then_some(p.z))
            }
            Thickness::Family(form) => (x, form.at(s), None),
            Thickness::Curve(curve) => {
                let p = lift_curve(&curve.jet(s.value(), J::ORDER), s);
                (p.x, p.y, Some(p.z))
            }
            Thickness::Closed { open, at, rest } => {
                let (x, y, camber) = open.at(s);
                if x.re() <= at.re() {
                    return (x, y, camber);
                }
                let way = (x - J::fixed(*at)) / J::fixed(-*at + 1.0);
                (x, y - (way * way * way).scaled(*rest), camber)
            }
        }
    }

    /// The form, prepared for evaluation at many parameters.
    pub fn settled(self) -> Self {
        match self {
            Thickness::Family(form) => Thickness::Family(form.settled()),
            Thickness::Closed { open, at, rest } => {
                Thickness::Closed { open: Box::new(open.settled()), at, rest }
            }
            other => other,
        }
    }

    /// The parameters s at which a second derivative may jump.
    pub fn breaks(&self) -> Vec<f64> {
        match self {
            Thickness::Polynomial(_) => Vec::new(),
            // Third derivatives jump there, which quadrature wants to know.
            Thickness::Spline { spline, .. } => {
                let knots = spline.knots();
                knots[1..knots.len() - 1].iter().map(|k| k.re()).collect()
            }
            Thickness::Family(_) => (1..STEPS).map(|k| k as f64 / STEPS as f64).collect(),
            Thickness::Closed { open, .. } => open.breaks(),
            _ => self.second_order_breaks(),
        }
    }

    /// [`Self::breaks`] without the parameters at which only third derivatives jump.
    pub fn second_order_breaks(&self) -> Vec<f64> {
        match self {
            Thickness::Joined { at, .. } => vec![at.re().sqrt()],
            Thickness::Curve(curve) => curve.breaks(),
            Thickness::Closed { open, .. } => open.second_order_breaks(),
            _ => Vec::new(),
        }
    }
}

/// d1, the slope of the tail at the thickness 0.2, for the greatest thickness at x = `m`: the
/// polynomial through the five published values.
fn tail_angle<T: Real>(m: T) -> T {
    const KNOWN: [(f64, f64); 5] =
        [(0.2, 0.200), (0.3, 0.234), (0.4, 0.315), (0.5, 0.465), (0.6, 0.700)];
    // Newton's divided differences: exact at the five points up to rounding.
    let mut table = KNOWN.map(|(_, d)| d);
    for level in 1..5 {
        for k in (level..5).rev() {
            table[k] = (table[k] - table[k - 1]) / (KNOWN[k].0 - KNOWN[k - level].0);
        }
    }
    (0..4).rev().fold(T::from(table[4]), |sum, k| sum * (m - KNOWN[k].0) + table[k])
}
