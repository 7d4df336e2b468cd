//! Third derivatives of shapes with respect to their parameters, for fillets, sweeps and offsets.
//!
//! A shape has derivatives up to the second. First derivatives of a shape made of tangents are
//! exact, therefore; its second derivatives need third ones of its parents, which are differences
//! of their second derivatives: five points, fourth order, never across a break. Their error is
//! about 1e-11 of the size of the seventh derivative; positions and panels never need them.

use moldloft_num::{CurveJet, Jet, Order, Real, Surface, Vec3, find_root};
use moldloft_registry::CurveRef;

/// The step of the differences. The error of fourth order, h^4 / 30, is then 2e-12 and that of
/// rounding, 1.5 epsilon / h, 2e-13.
const STEP: f64 = 1.0 / 512.0;

/// Weights of the first derivative at point s of five equally spaced ones (Abramowitz and Stegun
/// 1964, table 25.2), times 12.
const WEIGHTS: [[f64; 5]; 5] = [
    [-25.0, 48.0, -36.0, 16.0, -3.0],
    [-3.0, -10.0, 18.0, -6.0, 1.0],
    [1.0, -8.0, 0.0, 8.0, -1.0],
    [-1.0, 6.0, -18.0, 10.0, 3.0],
    [3.0, -16.0, 36.0, -48.0, 25.0],
];

/// The derivative of `f` at `t` by differences within the smooth stretch around it.
pub fn slope<T: Real, const N: usize>(
    f: impl Fn(T) -> [Vec3<T>; N],
    t: T,
    breaks: &[f64],
) -> [Vec3<T>; N] {
    let at = t.re();
    let inner = breaks.iter().copied().filter(|b| *b > 0.0 && *b < 1.0);
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for b in inner.chain([0.0, 1.0]) {
        // At a break the stretch after it counts, at 1 the one before.
        if b < at || (b == at && b < 1.0) {
            low = low.max(b);
        } else {
            high = high.min(b);
        }
    }
    let step = STEP.min((high - low) / 5.0);
    let least = (4.0 - (high - at) / step).ceil().clamp(0.0, 4.0);
    let most = ((at - low) / step).floor().clamp(0.0, 4.0);
    let s = 2.0_f64.max(least).min(most);
    let mut sum = [Vec3::zero(); N];
    for (k, weight) in WEIGHTS[s as usize].into_iter().enumerate() {
        if weight != 0.0 {
            let there = f(t + (k as f64 - s) * step);
            for (sum, x) in sum.iter_mut().zip(there) {
                *sum += x * T::from(weight / (12.0 * step));
            }
        }
    }
    sum
}

/// C'(t), of a curve given by its jet and breaks.
pub fn tangent<T: Real, J: Jet<T>>(
    jet: impl Fn(T, Order) -> CurveJet<T>,
    breaks: impl FnOnce() -> Vec<f64>,
    t: J,
) -> Vec3<J> {
    let at = t.value();
    let [_, d, dd] = jet(at, if J::ORDER == Order::Zero { Order::First } else { Order::Second });
    let mut x = d.map(J::fixed);
    if J::ORDER == Order::Zero {
        return x;
    }
    let dt = t - J::fixed(at);
    x += dd.map(|a| dt.scaled(a));
    if J::ORDER == Order::Second {
        let half = dt * dt * 0.5;
        let [ddd] = slope(|t| [jet(t, Order::Second)[2]], at, &breaks());
        x += ddd.map(|a| half.scaled(a));
    }
    x
}

/// Derivative relative to the next one below which it counts as zero speed.
const STILL: f64 = 1e-12;

/// Distance in t from an end of zero speed within which the direction is evaluated as a series,
/// since the tangent is mostly rounding there. The neglected part is of the fourth power of this at
/// a double end, of the third at a triple one.
const NEAR_END: f64 = 1e-3;

/// A vector along the tangent, at t = 0 and 1 its limit from inside: at a double or triple end of
/// zero speed, the direction of the first derivative that does not vanish. Zero if undefined.
///
/// With C2 .. C5 the derivatives at the end t0 and s = t - t0, the first derivative is s (C2 + C3 s / 2 + C4 s^2 / 6 + C5 s^3 /
/// 24) at a double end and s^2 (C3 / 2 + C4 s / 6 + C5 s^2 / 24) at a triple one; the factor in brackets counts.
pub fn direction<T: Real, J: Jet<T>>(
    jet: impl Fn(T, Order) -> CurveJet<T>,
    breaks: impl FnOnce() -> Vec<f64>,
    t: J,
) -> Vec3<J> {
    let at = t.re();
    let end = if at < 0.5 { 0.0 } else { 1.0 };
    if (at - end).abs() > NEAR_END {
        return tangent(jet, breaks, t);
    }
    let [_, d, dd] = jet(T::from(end), Order::Second);
    if d.re().norm() > STILL * dd.re().norm() {
        return tangent(jet, breaks, t);
    }
    let breaks = breaks();
    if breaks.iter().any(|b| (b - end).abs() <= 2.0 * NEAR_END) && at != end {
        return tangent(jet, || breaks, t);
    }
    let third = |t: T| slope(|t| [jet(t, Order::Second)[2]], t, &breaks);
    let fourth = |t: T| slope(third, t, &breaks);
    let ([c3], [c4], [c5]) =
        (third(T::from(end)), fourth(T::from(end)), slope(fourth, T::from(end), &breaks));
    let s = t - J::from(end);
    let series = |parts: [(Vec3<T>, f64); 4]| {
        let mut x = Vec3::zero();
        for ((part, share), power) in parts.into_iter().zip([J::from(1.0), s, s * s, s * s * s]) {
            x += part.map(|a| power.scaled(a * share));
        }
        x
    };
    if dd.re().norm() > STILL * c3.re().norm() {
        // Inside is before the far end.
        let side = if end == 0.0 { 1.0 } else { -1.0 };
        return series([(dd, side), (c3, 0.5 * side), (c4, side / 6.0), (c5, side / 24.0)]);
    }
    series([(c3, 0.5), (c4, 1.0 / 6.0), (c5, 1.0 / 24.0), (Vec3::zero(), 0.0)])
}

/// Parts of each smooth piece of a curve that are searched for zero speed.
const STANDSTILL_TRIALS: usize = 32;

/// An interior parameter of zero speed (at most `least`), if there is one. `ends` are the ascending
/// ends of the smooth pieces, from 0 to 1; the inner ones are tested.
pub fn standstill<T: Real>(curve: &CurveRef<T>, ends: &[f64], least: f64) -> Option<f64> {
    let jet = |t: f64| {
        let [_, d, dd] = curve.jet(T::from(t), Order::Second);
        [d.re(), dd.re()]
    };
    let still = |t: &f64| {
        let speed = jet(*t)[0].norm();
        speed.is_nan() || speed <= least
    };
    let gain = |t: f64| {
        let [d, dd] = jet(t);
        d.dot(dd)
    };
    for span in ends.windows(2) {
        let at = |k: usize| {
            let t = span[0] + (span[1] - span[0]) * k as f64 / STANDSTILL_TRIALS as f64;
            t.clamp(span[0].next_up(), span[1].next_down())
        };
        // Between two parameters the speed has a minimum if it falls at the first and rises at the
        // second.
        let slowest = (1..=STANDSTILL_TRIALS)
            .filter(|&k| gain(at(k - 1)) < 0.0 && gain(at(k)) > 0.0)
            .filter_map(|k| find_root(gain, at(k - 1), at(k)).ok());
        let places = (1..STANDSTILL_TRIALS).map(at).chain(slowest);
        let join = (span[1] < 1.0).then(|| [span[1].next_down(), span[1]]);
        if let Some(t) = places.chain(join.into_iter().flatten()).find(still) {
            return Some(t);
        }
    }
    None
}

/// The derivatives (S_uuu, S_uuv, S_uvv, S_vvv).
fn thirds<T: Real>(surface: &dyn Surface<T>, u: T, v: T) -> [Vec3<T>; 4] {
    let [bu, bv] = surface.breaks();
    let by_u = |u: T| {
        let jet = surface.jet(u, v, Order::Second);
        [jet.uu, jet.uv, jet.vv]
    };
    let [uuu, uuv, uvv] = slope(by_u, u, &bu);
    let [vvv] = slope(|v| [surface.jet(u, v, Order::Second).vv], v, &bv);
    [uuu, uuv, uvv, vvv]
}

/// S_u and S_v at parameters that are jets.
pub fn tangents<T: Real, J: Jet<T>>(surface: &dyn Surface<T>, u: J, v: J) -> [Vec3<J>; 2] {
    let (at, to) = (u.value(), v.value());
    let order = if J::ORDER == Order::Zero { Order::First } else { Order::Second };
    let jet = surface.jet(at, to, order);
    let fixed = |v: Vec3<T>| v.map(J::fixed);
    let (mut x, mut y) = (fixed(jet.u), fixed(jet.v));
    if J::ORDER == Order::Zero {
        return [x, y];
    }
    let (du, dv) = (u - J::fixed(at), v - J::fixed(to));
    let times = |v: Vec3<T>, j: J| v.map(|a| j.scaled(a));
    x += times(jet.uu, du) + times(jet.uv, dv);
    y += times(jet.uv, du) + times(jet.vv, dv);
    if J::ORDER == Order::Second {
        let [uuu, uuv, uvv, vvv] = thirds(surface, at, to);
        let (a, b, c) = (du * du * 0.5, du * dv, dv * dv * 0.5);
        x += times(uuu, a) + times(uuv, b) + times(uvv, c);
        y += times(uuv, a) + times(uvv, b) + times(vvv, c);
    }
    [x, y]
}

/// S_uu, S_uv and S_vv at parameters that are jets: their first derivatives are differences, their
/// second ones differences of those.
pub fn bends<T: Real, J: Jet<T>>(surface: &dyn Surface<T>, u: J, v: J) -> [Vec3<J>; 3] {
    let (at, to) = (u.value(), v.value());
    let jet = surface.jet(at, to, Order::Second);
    let fixed = |v: Vec3<T>| v.map(J::fixed);
    let mut all = [jet.uu, jet.uv, jet.vv].map(fixed);
    if J::ORDER == Order::Zero {
        return all;
    }
    let (du, dv) = (u - J::fixed(at), v - J::fixed(to));
    let times = |v: Vec3<T>, j: J| v.map(|a| j.scaled(a));
    let [uuu, uuv, uvv, vvv] = thirds(surface, at, to);
    for (x, (by_u, by_v)) in all.iter_mut().zip([(uuu, uuv), (uuv, uvv), (uvv, vvv)]) {
        *x += times(by_u, du) + times(by_v, dv);
    }
    if J::ORDER == Order::Second {
        let [bu, bv] = surface.breaks();
        let [uuuu, uuuv, uuvv, uvvv] = slope(|u| thirds(surface, u, to), at, &bu);
        let [.., vvvv] = slope(|v| thirds(surface, at, v), to, &bv);
        let (a, b, c) = (du * du * 0.5, du * dv, dv * dv * 0.5);
        let fourths = [(uuuu, uuuv, uuvv), (uuuv, uuvv, uvvv), (uuvv, uvvv, vvvv)];
        for (x, (p, q, r)) in all.iter_mut().zip(fourths) {
            *x += times(p, a) + times(q, b) + times(r, c);
        }
    }
    all
}
