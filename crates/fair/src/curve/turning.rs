//! Parameters that advance faster where a curve turns, and the budget for which the curve is
//! nearest to the truth.
//!
//! With arc length as the parameter, a nose is a short interval with large third derivatives, which
//! a fair curve compensates by gaps beside it. Steps of ds (1 + (k / 2m)^2)^(1/4), with the
//! curvature k and its mean m, make the interval longer: they are between the arc length and the
//! square root of the tangent angle. The curvature is that of the curve with the full squares of
//! noise: a curve nearer to the data would turn with their noise.

use crate::curve::data::{Data, DataOptions};
use crate::curve::data_moved::{MovingFit, fair_data_with};
use crate::curve::moving::MovingSpace;
use crate::measure::gauss;
use crate::optimum::goal::Goal;
use crate::{FairError, Measure, Motion};
use moldloft_num::{Real, Vec3};

/// The curvature, in means, from which on parameters run faster.
const SHARP: f64 = 2.0;

/// Budget of the goal `near` for plane curves and for others: the part of isotropic noise that is
/// across the curve; the part along it is absorbed by the parameters.
const PLANE_BUDGET: f64 = 0.5;
const SPACE_BUDGET: f64 = 0.8;

/// Relative deviation from a plane up to which points are plane.
const FLAT: f64 = 1e-9;

/// Budget of the curve whose curvature is used, in thirds of the squared tolerances: that of noise.
const TURNS_BUDGET: f64 = 1.0;

/// A turn of the tangent, in radians, below which a curve is straight.
const NO_TURN: f64 = 1e-6;

/// The budget of the goal `near`, as a fraction of the variance of noise that fills the tolerances
/// evenly. The part of the noise across the curve is all of it if points move along one direction,
/// two thirds in space and half in a plane; the rest is along the curve.
///
/// # Example
/// ```
/// use moldloft_fair::{Motion, near_budget};
/// use moldloft_num::Vec3;
/// let arc: Vec<_> = (0..9).map(|k| 0.2 * k as f64).map(|t| Vec3::of(t.cos(), t.sin(), 0.0)).collect();
/// assert_eq!(near_budget(&arc, Motion::Ball), 0.5);
/// assert_eq!(near_budget(&arc, Motion::Along(Vec3::of(0.0, 1.0, 0.0))), 0.8);
/// ```
pub fn near_budget(points: &[Vec3<f64>], motion: Motion) -> f64 {
    if matches!(motion, Motion::Along(_)) || !is_plane(points) {
        return SPACE_BUDGET;
    }
    PLANE_BUDGET
}

fn is_plane(points: &[Vec3<f64>]) -> bool {
    let Some(&first) = points.first() else { return true };
    let far = |of: &dyn Fn(Vec3<f64>) -> Vec3<f64>| {
        let all = points.iter().map(|&p| of(p - first));
        all.fold(Vec3::zero(), |a, b| if b.norm_sq() > a.norm_sq() { b } else { a })
    };
    let longest = far(&|v| v);
    let size = longest.norm();
    let Some(a) = longest.normalized() else { return true };
    let across = far(&|v| v - a * a.dot(v));
    let Some(b) = across.normalized().filter(|_| across.norm() > FLAT * size) else { return true };
    let normal = a.cross(b);
    points.iter().all(|&p| (p - first).dot(normal).abs() <= FLAT * size)
}

/// Parameters of data that advance faster where the curve turns, for data with any parameters;
/// points, `tolerances` and parameters `at` may carry derivatives. Exact points and points without
/// tolerances keep their parameters.
///
/// # Errors
/// [`FairError`] of the spaces of splines.
///
/// # Example
/// ```
/// use moldloft_fair::{Data, EndContinuity, InterpolationSpace, Limit, ParameterSpacing, curvature_parameters,
///     parameters};
/// use moldloft_num::Vec3;
/// // A catenary: its vertex gets more of the range than of the length. (Conics and cubics would be exact.)
/// let y = |x: f64| (2.0 * x).cosh();
/// let points: Vec<_> = (-10..11).map(|k| 0.2 * k as f64).map(|x| Vec3::of(x, y(x), 0.0)).collect();
/// let at = parameters(&points, ParameterSpacing::Chord, false).unwrap();
/// let data = Data {
///     limit: Limit::ball(points.len(), 1e-3).unwrap(),
///     layout: InterpolationSpace::new(3, &at, &[], false).unwrap(),
///     ends: [EndContinuity::Free; 2],
///     points: points.clone(),
/// };
/// let own = curvature_parameters(&data, &points, &[1e-3; 21], &at).unwrap();
/// assert!(own[11] - own[9] > 2.0 * (at[11] - at[9]));
/// ```
pub fn curvature_parameters<T: Real>(
    data: &Data,
    points: &[Vec3<T>],
    tolerances: &[T],
    at: &[T],
) -> Result<Vec<T>, FairError> {
    let Some(options) = turns_of(data) else { return Ok(at.to_vec()) };
    let (made, _) = fair_data_with(data, &options, points, tolerances, at)?;
    Ok(turned(data, &made, at))
}

/// Options of the curve whose turns are counted; `None` if the parameters do not change.
fn turns_of(data: &Data) -> Option<DataOptions> {
    let degree = data.layout.space.degree();
    if degree < 2 || data.exact_parts() || data.limit.radii.iter().all(|&r| r == 0.0) {
        return None;
    }
    let measure = if degree > 2 { Measure::Variation } else { Measure::Bending };
    Some(DataOptions::of(measure, Goal::Budget(TURNS_BUDGET)))
}

/// [`curvature_parameters`] by the turns of a draft.
pub(super) fn drafted_parameters(data: &Data, at: &[f64]) -> Result<Vec<f64>, FairError> {
    let Some(options) = turns_of(data) else { return Ok(at.to_vec()) };
    let fit = data.drafted(&options)?;
    Ok(turned(data, &MovingFit::still(&data.layout, &fit), at))
}

/// The parameters by the turns of a curve.
fn turned<T: Real>(data: &Data, made: &MovingFit<T>, at: &[T]) -> Vec<T> {
    let steps = steps(data, made, &data.layout.moving(at).0);
    // If a part of the curve has zero length the parameters are unchanged.
    steps.map_or_else(|| at.to_vec(), |steps| numbered(data, &steps, at.len()))
}

/// The steps of the parameter from site to site: lengths, longer where the curve turns.
fn steps<T: Real>(data: &Data, made: &MovingFit<T>, sites: &[T]) -> Option<Vec<T>> {
    let own = &data.layout.space;
    let space = MovingSpace { space: own, knots: &made.knots };
    let m = sites.len();
    let last = if own.is_closed() { m } else { m - 1 };
    let (start, end) = own.domain();
    let rule = gauss(3);
    // Lengths and angles of parts.
    let mut parts: Vec<(usize, T, T)> = Vec::new();
    for j in 0..last {
        let (a, mut b) = (sites[j], sites[(j + 1) % m]);
        if j + 1 == m {
            b += T::from(end - start);
        }
        let h = b - a;
        for &(x, w) in &rule {
            let t = a + h * (0.5 * (1.0 + x));
            let (k, moved) = own.locate(t.re());
            let t = t + T::from(moved - t.re());
            let at = |order: usize| {
                let factors = space.derivative(k, t, order);
                let both = own.columns(k).zip(factors);
                both.fold(Vec3::zero(), |s: Vec3<T>, (c, f)| s + made.points[c].map(|x| x * f))
            };
            let (speed, bend) = (at(1), at(2));
            let square = speed.norm_sq();
            if square.re() <= 0.0 || !square.re().is_finite() {
                return None;
            }
            let length = square.sqrt() * h * (0.5 * w);
            let cross = speed.cross(bend).norm_sq() / (square * square);
            let floor = NO_TURN / (end - start);
            let turn = (cross + T::from(floor * floor)).sqrt() * h * (0.5 * w);
            parts.push((j, length, turn));
        }
    }
    let sum = |of: fn(&(usize, T, T)) -> T| parts.iter().fold(T::zero(), |s, p| s + of(p));
    let mean = sum(|p| p.2) / sum(|p| p.1) * SHARP;
    let mut out = vec![T::zero(); last];
    for (j, length, turn) in parts {
        let ratio = turn / (length * mean);
        out[j] += length * (T::one() + ratio * ratio).sqrt().sqrt();
    }
    out.iter().all(|s| s.re() > 0.0 && s.is_finite()).then_some(out)
}

/// The parameters of the data, in their order, by the lengths between the sites.
fn numbered<T: Real>(data: &Data, steps: &[T], count: usize) -> Vec<T> {
    let layout = &data.layout;
    let mut run = vec![T::zero()];
    for &step in steps {
        run.push(*run.last().unwrap_or(&T::zero()) + step);
    }
    let total = *run.last().unwrap_or(&T::one());
    let closed = layout.space.is_closed() || layout.owner.first() == layout.owner.last();
    let mut out = vec![T::zero(); count];
    for (site, owner) in layout.owner.iter().enumerate().rev() {
        if let Some(i) = *owner {
            out[i] = run[site] / total;
        }
    }
    let start = out[0];
    for t in &mut out {
        *t -= start;
        if closed && t.re() < 0.0 {
            *t += T::one();
        }
    }
    if !closed {
        out[count - 1] = T::one();
    }
    out
}
