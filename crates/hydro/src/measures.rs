//! Lengths and volumes with their centres, by quadrature on the shapes themselves.

use moldloft_num::{Curve, Order, Real, Solid, Vec3, gauss_legendre, gauss_rule};
use moldloft_spline::curve_integral;

/// Relative differences below this count as none.
const ACCURACY: f64 = 1e-11;

/// The volume of a solid has settled when halves of its parts change no more than this share of it.
const SETTLED: f64 = 1e-11;

/// The length of a curve and the centre of its length.
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
    // About a place of the curve, so that one far away loses no digits.
    let moment = |axis: usize| {
        let arm = |t: T| speed(t) * (curve.jet(t, Order::Zero)[0][axis] - middle[axis]);
        whole(ACCURACY * rough * rough, &arm)
    };
    let moment = Vec3::new(moment(0), moment(1), moment(2));
    (length, middle + moment / length)
}

/// A part of a solid that may be halved: the worst first, the earlier of two alike.
struct AdaptiveBox<T> {
    low: [f64; 3],
    high: [f64; 3],
    sums: VolumeMoments<T>,
    /// How far the sums of its halves are from its own, and the parameter along which they are farthest.
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

/// The most parts of a solid, and how often one is halved.
const MOST_PARTS: usize = 1000;
const DEEPEST: u32 = 48;

/// Derivatives of a shape are differences of its places, each known to so many roundings of how far away it is.
const ROUNDINGS: f64 = 4.0;

/// A part that was halved more often has a kink inside.
const KINKED: u32 = 20;

/// What the rounding of places makes of the volume of a solid: a sum over Gauss points of how far these are known
/// times the sides of the parts about them.
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

/// The volume of a solid, negative when it is left-handed, its centre, and an estimate of the error of the volume. `None`
/// when a place is not finite.
///
/// By Gauss points, eight along each parameter of a part; the part whose halves differ most from it is halved along
/// the parameter of that difference, so that a kink inside is closed in upon. Where there is one, derivatives have
/// no bound: the error is infinite then.
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
    // A kink that was closed in upon may move when a parameter does, and what passes over it is in no part.
    let kinked = open.iter().chain(&settled).any(|part| part.depth > KINKED);
    if T::PARTS > 1
        && kinked
        && !(volume.is_constant() && [moment.x, moment.y, moment.z].iter().all(|x| x.is_constant()))
    {
        error = f64::INFINITY;
    }
    // Parts may agree by chance better than their places are known.
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
