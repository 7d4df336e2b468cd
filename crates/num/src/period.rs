//! Closed shapes: which parameters of a curve or surface wrap, and their values within the first
//! turn.

use crate::{Curve, Order, Real, SurfJet, Surface, Vec3};

/// Distance beyond 0 and 1 at which a parameter still belongs to the end.
const NEAR: f64 = 1e-9;

/// Ends nearer to each other than this, relative to the size, are one.
const GAP: f64 = 1e-9;

/// Derivatives that differ by less than this, relatively, are one.
const SMOOTH: f64 = 1e-9;

/// Positions along two opposite sides at which they are compared, corners included.
const PLACES: [f64; 9] = [0.37, 0.0, 0.11, 0.25, 0.5, 0.63, 0.79, 0.93, 1.0];

/// The parameter reduced to [0, 1] by whole periods; within `NEAR` of 0 and 1 it is unchanged.
pub fn principal<J: Real>(t: J) -> J {
    let re = t.re();
    if (-NEAR..=1.0 + NEAR).contains(&re) { t } else { turned_back(t) }
}

/// Parameters on a surface, reduced across closed directions; see [`principal`].
pub fn within<J: Real>(closed: [bool; 2], w: [J; 2]) -> [J; 2] {
    [0, 1].map(|a| if closed[a] { principal(w[a]) } else { w[a] })
}

/// The parameter for an evaluation, reduced to [0, 1]; values from 0 to 1 are unchanged.
pub fn turned_back<J: Real>(t: J) -> J {
    let re = t.re();
    if (0.0..=1.0).contains(&re) || !re.is_finite() { t } else { t - re.floor() }
}

/// Distance of two parameters, across the seam if that is shorter.
pub fn parameter_distance(a: f64, b: f64, closed: bool) -> f64 {
    let d = (a - b).abs();
    if closed { (d - d.round()).abs() } else { d }
}

/// The breaks of a shape in `low` .. `high`, which may extend beyond 0 and 1: those of a closed
/// shape are repeated in each period, with its seam if that is a break.
pub fn breaks_between(breaks: &[f64], closed: bool, low: f64, high: f64) -> Vec<f64> {
    let (low, high) = (low.min(high), low.max(high));
    if !closed || low >= 0.0 && high <= 1.0 || high - low > 1e4 {
        return breaks.iter().copied().filter(|b| *b > low && *b < high).collect();
    }
    let turns = low.floor() as i64..=high.floor() as i64;
    let of_turn = |k: i64| {
        let seam = k as f64;
        std::iter::once(seam).chain(breaks.iter().map(move |b| seam + b))
    };
    turns.flat_map(of_turn).filter(|b| *b > low && *b < high).collect()
}

/// True when a curve ends where it begins, up to rounding, and is not a single point.
pub fn closes<T: Real>(curve: &dyn Curve<T>) -> bool {
    let at = |t: f64| curve.jet(T::from(t), Order::Zero)[0].re();
    let (first, last) = (at(0.0), at(1.0));
    let gap = first.distance(last);
    let reach = |t: f64| at(t).distance(first);
    // A curve may return to its start however far away it is elsewhere.
    gap.is_finite() && {
        let size = reach(0.37).max(reach(0.63)).max(reach(0.5));
        size > 0.0 && gap <= GAP * size
    }
}

/// For u and v of a surface, true if closed: the two sides are the same line, up to rounding. A
/// side that is a single point, a pole, does not count.
pub fn closed_sides<T: Real>(surface: &dyn Surface<T>) -> [bool; 2] {
    let at = |axis: usize, end: f64, w: f64| {
        let [u, v] = if axis == 0 { [end, w] } else { [w, end] };
        surface.jet(T::from(u), T::from(v), Order::Zero).p.re()
    };
    [0, 1].map(|axis| {
        let first = [at(axis, 0.0, PLACES[0]), at(axis, 1.0, PLACES[0])];
        let size = at(axis, 0.5, PLACES[0]).distance(first[0]);
        // Half a turn of a shape may pass near its beginning: a quarter does not then.
        let size = size.max(at(axis, 0.25, PLACES[0]).distance(first[0]));
        let near = |[a, b]: [Vec3; 2]| a.distance(b) <= GAP * size;
        if size <= 0.0 || !near(first) {
            return false;
        }
        let pairs = PLACES[1..].iter().map(|w| [at(axis, 0.0, *w), at(axis, 1.0, *w)]);
        let mut long = false;
        for pair in pairs {
            if !near(pair) {
                return false;
            }
            long |= pair[0].distance(first[0]) > GAP * size;
        }
        long
    })
}

/// For u and v, true if `closed` with continuous first derivatives across the seam, up to rounding,
/// at samples.
pub fn smooth_seams<T: Real>(surface: &dyn Surface<T>, closed: [bool; 2]) -> [bool; 2] {
    let jet = |axis: usize, end: f64, w: f64| {
        let [u, v] = if axis == 0 { [end, w] } else { [w, end] };
        let jet = surface.jet(T::from(u), T::from(v), Order::First);
        [jet.u.re(), jet.v.re()]
    };
    let near = |[a, b]: [Vec3; 2]| a.distance(b) <= SMOOTH * a.norm().max(b.norm());
    [0, 1].map(|axis| {
        closed[axis]
            && PLACES.iter().all(|&w| {
                let (low, high) = (jet(axis, 0.0, w), jet(axis, 1.0, w));
                near([low[0], high[0]]) && near([low[1], high[1]])
            })
    })
}

/// The derivatives of the parameter `t` of a corner of a curve, as a number whose real part is 0;
/// both sides are evaluated, at the distance `near` from it. `None` if the tangent is continuous:
/// the parameter does not affect a first derivative then.
///
/// Both sides of a corner meet there whatever becomes of it: with C- and C+ the sides,
/// dt = (dC+ - dC-) . n / n . n with n = C-' - C+'.
pub fn corner_rate<T: Real>(curve: &dyn Curve<T>, t: f64, near: f64) -> Option<T> {
    let side = |h: f64| {
        let [p, d, _] = curve.jet(T::from(t + h), Order::First);
        (p - d * T::from(h), d.re())
    };
    let ((low, before), (high, after)) = (side(-near), side(near));
    let turn = before - after;
    let square = turn.norm_sq();
    if square <= 1e-16 * before.norm_sq().max(after.norm_sq()) {
        return None;
    }
    let gap = high - low;
    let along = (gap.x * turn.x + gap.y * turn.y + gap.z * turn.z) / square;
    Some(along - along.re())
}

/// Positions along a crease at which its rate is sampled.
const ALONG: [f64; 7] = [0.03, 0.19, 0.37, 0.52, 0.68, 0.83, 0.96];

/// The derivatives of the parameter of a crease of a surface, the parameter `at` of u (0) or v (1),
/// as a number whose real part is 0; both sides are evaluated, at the given distances from it.
///
/// Both sides meet at the corner whatever the derivatives: with S- and S+ the sides, dt = (dS+ -
/// dS-) . n / n . n with n = S-' - S+', over positions along the break. Zero where the tangent does
/// not turn: there the parameter does not affect a first derivative.
pub fn crease_rate<T: Real>(
    surface: &dyn Surface<T>,
    along: usize,
    at: f64,
    [before, after]: [f64; 2],
) -> T {
    let side = |h: f64| -> Vec<(Vec3<T>, Vec3)> {
        let t = T::from(at + h);
        let jets = match along {
            0 => surface.line(t, &ALONG, Order::First),
            _ => ALONG.iter().map(|&u| surface.jet(T::from(u), t, Order::First)).collect(),
        };
        let place = |jet: &SurfJet<T>| {
            let slope = if along == 0 { jet.u } else { jet.v };
            (jet.p - slope * T::from(h), slope.re())
        };
        jets.iter().map(place).collect()
    };
    let (mut gaps, mut squares, mut size) = (T::zero(), 0.0, 0.0f64);
    for ((p, low), (q, high)) in side(-before).into_iter().zip(side(after)) {
        let turn = low - high;
        let gap = q - p;
        gaps += gap.x * turn.x + gap.y * turn.y + gap.z * turn.z;
        squares += turn.norm_sq();
        size = size.max(low.norm_sq()).max(high.norm_sq());
    }
    if squares > 1e-16 * size && gaps.is_finite() {
        let rate = gaps / squares;
        rate - rate.re()
    } else {
        T::zero()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CurveJet;

    struct Circle(f64);

    impl Curve<f64> for Circle {
        fn jet(&self, t: f64, _: Order) -> CurveJet<f64> {
            let (s, c) = (libm::sin(self.0 * t), libm::cos(self.0 * t));
            [Vec3::of(c + 1e3, s, 0.0), Vec3::of(-s, c, 0.0) * self.0, Vec3::zero()]
        }

        crate::curve_one_by_one!(f64);
        crate::curve_facts!(smooth, open, not_rational);
    }

    #[test]
    fn a_whole_turn_is_closed_and_a_part_is_not() {
        let tau = std::f64::consts::TAU;
        assert!(closes(&Circle(tau)) && closes(&Circle(2.0 * tau)));
        assert!(!closes(&Circle(tau - 1e-6)) && !closes(&Circle(0.0)));
    }

    #[test]
    fn parameters_come_back_with_each_turn() {
        assert_eq!(principal(2.25), 0.25);
        assert_eq!(principal(-0.25), 0.75);
        assert_eq!(
            (principal(1.0), principal(0.0), principal(1.0 + 1e-12)),
            (1.0, 0.0, 1.0 + 1e-12)
        );
        assert!((parameter_distance(0.02, 0.97, true) - 0.05).abs() < 1e-15);
        assert_eq!(breaks_between(&[0.5], true, -0.75, 1.75), [-0.5, 0.0, 0.5, 1.0, 1.5]);
        assert_eq!(breaks_between(&[0.5], false, -0.75, 1.75), [0.5]);
    }
}
