//! Lengths and volumes with their centres, by quadrature on the exact shapes.

use moldloft_num::{Curve, Order, Real, Solid, Vec3, gauss_legendre, gauss_rule};
use moldloft_spline::curve_integral;

/// Negligible relative difference.
const ACCURACY: f64 = 1e-11;

/// Relative change of the volume of a solid by halving of its parts at which it is converged.
const SETTLED: f64 = 1e-11;

/// The length of a curve and its centroid.
pub fn curve_measures<T: Real>(curve: &dyn Curve<T>) -> (T, Vec3<T>) {
    let speed = |t: T| {
        let square = curve.jet(t, Order::First)[1].norm_sq();
        if square.re() > 0.0 { square.sqrt() } else { T::zero() }
    };
    let whole =
        |accuracy: f64, f: &dyn Fn(T) -> T| curve_integral(curve, T::zero(), T::one(), accuracy, f);
    let rough = gauss_legendre(T::zero(), T::one(), speed).re().abs();
    let middle = curve.jet(T::from(0.5), Order::Zero)[0];
    let length = whole(ACCURACY * rough, &speed);
    if length.re() <= 0.0 {
        return (length, curve.jet(T::zero(), Order::Zero)[0]);
    }
    // About a point of the curve, so that a distant origin costs no digits.
    let moment = |axis: usize| {
        let arm = |t: T| speed(t) * (curve.jet(t, Order::Zero)[0][axis] - middle[axis]);
        whole(ACCURACY * rough * rough, &arm)
    };
    let moment = Vec3::new(moment(0), moment(1), moment(2));
    (length, middle + moment / length)
}

/// A part of a solid that may be halved, ordered by error and then by index.
struct AdaptiveBox<T> {
    low: [f64; 3],
    high: [f64; 3],
    sums: VolumeMoments<T>,
    /// Maximum difference between its integral and the sum of its halves, and the parameter of this
    /// difference.
    error: f64,
    along: usize,
    halves: [VolumeMoments<T>; 2],
    depth: u32,
}

/// A volume and its first moments.
#[derive(Clone, Copy)]
struct VolumeMoments<T> {
    volume: T,
    moment: Vec3<T>,
}

/// Maximum number of parts of a solid, and maximum depth of halving.
const MOST_PARTS: usize = 1000;
const DEEPEST: u32 = 48;

/// Rounding error of a point, in units of the rounding of its coordinates; derivatives are
/// differences of points.
const ROUNDINGS: f64 = 4.0;

/// Depth of halving beyond which a part contains a kink.
const KINKED: u32 = 20;

/// Error of the volume of a solid due to rounding of its points: sum over Gauss points of the
/// rounding error times the face areas of the part.
fn rounding<T: Real>(solid: &dyn Solid<T>) -> f64 {
    let mut sum = 0.0;
    for (u, a) in gauss_rule(8) {
        for (v, b) in gauss_rule(8) {
            for (w, c) in gauss_rule(8) {
                let jet = solid.jet((*u).into(), (*v).into(), (*w).into());
                let [x, y, z] = [jet.u, jet.v, jet.w].map(|d| d.re().norm());
                sum += a * b * c * jet.p.re().norm() * (x * y + y * z + z * x);
            }
        }
    }
    ROUNDINGS * f64::EPSILON * sum
}

/// The volume of a solid, negative if it is left-handed, its centre, and an estimate of the error
/// of the volume. `None` if a point is not finite.
/// Quadrature with eight Gauss points along each parameter of a part. The part that differs most
/// from the sum of its halves is halved along the parameter of that difference, which isolates a
/// kink. With a kink derivatives have no bound, and the error is infinite.
pub fn solid_measures<T: Real>(solid: &dyn Solid<T>) -> Option<(T, Vec3<T>, f64)> {
    let sums = |low: [f64; 3], high: [f64; 3]| -> VolumeMoments<T> {
        let (mut volume, mut moment) = (T::zero(), Vec3::zero());
        let rule = |k: usize| {
            let (low, step) = (low[k], high[k] - low[k]);
            gauss_rule(8).iter().map(move |(s, w)| (low + step * s, w * step))
        };
        for (u, a) in rule(0) {
            for (v, b) in rule(1) {
                for (w, c) in rule(2) {
                    let jet = solid.jet(u.into(), v.into(), w.into());
                    let part = jet.jacobian() * (a * b * c);
                    volume += part;
                    moment += jet.p * part;
                }
            }
        }
        VolumeMoments { volume, moment }
    };
    let part =
        |low: [f64; 3], high: [f64; 3], whole: VolumeMoments<T>, depth: u32| -> AdaptiveBox<T> {
            let tried = [0, 1, 2].map(|axis| {
                let middle = 0.5 * (low[axis] + high[axis]);
                let (mut end, mut start) = (high, low);
                (end[axis], start[axis]) = (middle, middle);
                let halves = [sums(low, end), sums(start, high)];
                let both = halves[0].volume + halves[1].volume;
                ((both - whole.volume).re().abs(), halves)
            });
            let along = (0..3).fold(0, |k, j| if tried[j].0 > tried[k].0 { j } else { k });
            let (error, halves) = tried[along];
            AdaptiveBox { low, high, sums: whole, error, along, halves, depth }
        };
    let (low, high) = ([0.0; 3], [1.0; 3]);
    let rounding = rounding(solid);
    let mut open = vec![part(low, high, sums(low, high), 0)];
    let mut settled: Vec<AdaptiveBox<T>> = Vec::new();
    let mut size = open[0].sums.volume.re().abs();
    while let Some(at) =
        (0..open.len()).reduce(|a, b| if open[b].error > open[a].error { b } else { a })
    {
        let left: f64 = open.iter().map(|p| p.error).sum();
        if left <= (SETTLED * size).max(rounding)
            || !left.is_finite()
            || open.len() + settled.len() >= MOST_PARTS
        {
            break;
        }
        let worst = open.swap_remove(at);
        if worst.depth >= DEEPEST {
            settled.push(worst);
            continue;
        }
        let middle = 0.5 * (worst.low[worst.along] + worst.high[worst.along]);
        let (mut end, mut start) = (worst.high, worst.low);
        (end[worst.along], start[worst.along]) = (middle, middle);
        let [lower, upper] = worst.halves;
        open.push(part(worst.low, end, lower, worst.depth + 1));
        open.push(part(start, worst.high, upper, worst.depth + 1));
        size = size.max(open.iter().chain(&settled).map(|p| p.sums.volume.re()).sum::<f64>().abs());
    }
    let (mut volume, mut moment, mut error) = (T::zero(), Vec3::zero(), 0.0);
    for part in open.iter().chain(&settled) {
        for half in &part.halves {
            volume += half.volume;
            moment += half.moment;
        }
        error += part.error;
    }
    // An isolated kink may move with a parameter, and the volume it sweeps is in no part.
    let kinked = open.iter().chain(&settled).any(|part| part.depth > KINKED);
    if T::PARTS > 1
        && kinked
        && !(volume.is_constant() && [moment.x, moment.y, moment.z].iter().all(|x| x.is_constant()))
    {
        error = f64::INFINITY;
    }
    // Parts may agree by chance to less than their rounding.
    if rounding > SETTLED * size {
        error = error.max(rounding);
    }
    if !volume.is_finite() || !moment.is_finite() {
        return None;
    }
    if volume.re() == 0.0 {
        return Some((T::zero(), solid.eval(0.5.into(), 0.5.into(), 0.5.into()), error));
    }
    Some((volume, moment / volume, error))
}
