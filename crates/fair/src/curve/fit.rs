//! Splines through or near data points: the step before fairing.

use crate::error::check_finite;
use crate::optimum::HeldDirections;
use crate::optimum::problem::{self, NormBounds, Problem};
use crate::{FairError, Motion, RowNorm, Space, SparseRows};
use moldloft_num::{Order, Real, Vec3};
use moldloft_spline::KnotVector;

/// Parametrisation of data points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterSpacing {
    /// Equal steps.
    Uniform,
    /// By distance.
    Chord,
    /// Square root of the distance (Lee 1989): smoother at sharp turns.
    Centripetal,
    /// The coordinate along a direction: stations. It must rise or fall from point to point.
    Along(Vec3<f64>),
}

/// A fitted spline.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Its knots.
    pub space: Space,
    /// Its control points.
    pub points: Vec<Vec3<f64>>,
    /// The parameters of the data points.
    pub parameters: Vec<f64>,
    /// The largest distance of a data point from the curve at its parameter.
    pub largest: f64,
    /// The root mean square of those distances.
    pub rms: f64,
}

/// The parameters of the data points on [0, 1]. On a closed curve the last is less than 1, since
/// the first point follows it.
///
/// # Errors
/// [`FairError::Coincident`] if two neighbours coincide and the spacing uses distances,
/// [`FairError::TurnsAlong`] if the points are not monotone along the given direction.
pub fn parameters(
    points: &[Vec3<f64>],
    spacing: ParameterSpacing,
    closed: bool,
) -> Result<Vec<f64>, FairError> {
    check_finite(points)?;
    parameters_with(points, spacing, closed)
}

/// As `parameters`, for points that carry derivatives; the parameters then carry them as well.
///
/// # Errors
/// As [`parameters`].
pub fn parameters_with<T: Real>(
    points: &[Vec3<T>],
    spacing: ParameterSpacing,
    closed: bool,
) -> Result<Vec<T>, FairError> {
    let n = points.len();
    if n < 2 {
        return Err(FairError::TooFew { expected: 2, actual: n });
    }
    let steps = if closed { n } else { n - 1 };
    let along = |a: Vec3<f64>, k: usize| {
        let step = points[k + 1] - points[k];
        step.x * a.x + step.y * a.y + step.z * a.z
    };
    let mut at = vec![T::zero()];
    for k in 0..steps {
        let chord = || (points[(k + 1) % n] - points[k]).norm();
        let step = match spacing {
            ParameterSpacing::Uniform => T::one(),
            ParameterSpacing::Chord if chord().re() == 0.0 => T::zero(),
            ParameterSpacing::Chord => chord(),
            ParameterSpacing::Centripetal if chord().re() == 0.0 => T::zero(),
            ParameterSpacing::Centripetal => chord().sqrt(),
            ParameterSpacing::Along(_) if closed => {
                return Err(FairError::TurnsAlong { index: n - 1 });
            }
            ParameterSpacing::Along(a) => {
                let (first, own) = (along(a, 0), along(a, k));
                let step = if first.re() < 0.0 { -own } else { own };
                if step.re() < 0.0 || step.re().is_nan() {
                    return Err(FairError::TurnsAlong { index: k + 1 });
                }
                step
            }
        };
        if step.re() == 0.0 {
            return Err(FairError::Coincident { first: k });
        }
        at.push(at[k] + step);
    }
    let total = at[steps];
    at.truncate(n);
    let mut at: Vec<T> = at.into_iter().map(|t| t / total).collect();
    if !closed {
        at[n - 1] = T::one();
    }
    Ok(at)
}

/// Minimum ratio of a chord's projection to the chord for stations to be used.
const SHALLOW: f64 = 0.2;

/// Tolerance, relative to the extent, from which a datum counts as released.
const RELEASED: f64 = 0.5;

/// Released data: their tolerance is at least half the extent, while others have smaller ones.
/// Their positions carry no information about the curve.
pub(crate) fn released<T: Real>(points: &[Vec3<T>], radii: &[f64]) -> Vec<bool> {
    let first = points.first().map(|p| p.re()).unwrap_or_default();
    let extent = points.iter().map(|p| (p.re() - first).norm()).fold(0.0, f64::max);
    let wide = |r: &f64| *r >= RELEASED * extent;
    let some = radii.iter().any(|r| *r > 0.0 && !wide(r));
    (0..points.len()).map(|k| some && radii.get(k).is_some_and(wide)).collect()
}

/// The points with those that were released between their neighbours, beside where they were read: `seen` are
/// the points as far as they do not move.
fn placed_between<T: Real>(
    points: &[Vec3<T>],
    seen: &[Vec3<T>],
    radii: &[f64],
    closed: bool,
) -> Option<Vec<Vec3<T>>> {
    let n = points.len();
    let out_of_place = released(points, radii);
    if !out_of_place.contains(&true) {
        return None;
    }
    // The nearest datum that was not released, and its number of steps.
    let next = |k: usize, on: bool| {
        (1..n).find_map(|by| {
            let at = match (closed, on) {
                (true, true) => (k + by) % n,
                (true, false) => (k + n - by) % n,
                (false, true) => k + by,
                (false, false) => k.checked_sub(by)?,
            };
            (at < n && !out_of_place[at]).then_some((by, at))
        })
    };
    let mut out = points.to_vec();
    for k in (0..n).filter(|&k| out_of_place[k]) {
        let (Some((before, a)), Some((after, b))) = (next(k, false), next(k, true)) else {
            continue;
        };
        let chord = points[b] - points[a];
        let mut share = T::from(before as f64 / (before + after) as f64);
        let way = seen[b] - seen[a];
        if before + after == 2 && way.re().norm() > 0.0 {
            let own = (seen[k] - seen[a]).dot(way) / way.dot(way);
            if own.re() > 0.0 && own.re() < 1.0 {
                share = own;
            }
        }
        out[k] = points[a] + chord.map(|c| c * share);
    }
    Some(out)
}

/// As [`parameters_with`], for points that move in one direction only: chords are measured
/// perpendicular to it, so that the parameters of offsets are their stations, unless the curve is
/// too steep. The slope of a step is reduced by the tolerances `radii` of its two points, so that
/// noise between two close stations does not count. Chords skip released data (tolerance of at
/// least half the extent, while others are smaller).
///
/// # Errors
/// As [`parameters`].
pub fn parameters_across<T: Real>(
    points: &[Vec3<T>],
    spacing: ParameterSpacing,
    closed: bool,
    (motion, radii): (Motion, &[f64]),
) -> Result<Vec<T>, FairError> {
    let by_chords = matches!(spacing, ParameterSpacing::Chord | ParameterSpacing::Centripetal);
    let (Motion::Along(d), true) = (motion, by_chords) else {
        let placed = if by_chords { placed_between(points, points, radii, closed) } else { None };
        return parameters_with(placed.as_deref().unwrap_or(points), spacing, closed);
    };
    let flat = |p: &Vec3<T>| {
        let along = p.x * d.x + p.y * d.y + p.z * d.z;
        *p - Vec3::new(along * d.x, along * d.y, along * d.z)
    };
    let projected: Vec<Vec3<T>> = points.iter().map(flat).collect();
    // A point that moves along a direction keeps its station.
    let placed = placed_between(points, &projected, radii, closed);
    let points = placed.as_deref().unwrap_or(points);
    let n = points.len();
    let steps = if closed { n } else { n.saturating_sub(1) };
    let shallow = (0..steps).all(|k| {
        let next = (k + 1) % n;
        let across = (projected[next].re() - projected[k].re()).norm();
        let chord = (points[next].re() - points[k].re()).norm();
        let along = (chord * chord - across * across).max(0.0).sqrt();
        let allowed: f64 = [k, next].iter().filter_map(|&k| radii.get(k)).sum();
        let needed = (along - allowed).max(0.0);
        // Written so that NaN is steep.
        across > 0.0 && across >= SHALLOW * (needed * needed + across * across).sqrt()
    });
    parameters_with(if shallow { &projected } else { points }, spacing, closed)
}

/// The spline through all points: clamped knots that are means of `degree` parameters (de Boor
/// 1978, X(6)), or, for a closed curve, the parameters (odd degree) or the midpoints between them
/// (even degree).
///
/// # Errors
/// [`FairError`] when the points are too few, not finite or coincide.
///
/// # Example
/// ```
/// use moldloft_fair::{ParameterSpacing, interpolate};
/// use moldloft_num::Vec3;
/// let points: Vec<_> = (0..9).map(|i| Vec3::of(i as f64, (i * i) as f64, 0.0)).collect();
/// let fit = interpolate(3, &points, ParameterSpacing::Chord, false).unwrap();
/// assert!(fit.largest < 1e-12);
/// ```
pub fn interpolate(
    degree: usize,
    points: &[Vec3<f64>],
    spacing: ParameterSpacing,
    closed: bool,
) -> Result<Fit, FairError> {
    let at = parameters(points, spacing, closed)?;
    let n = points.len();
    let space = if closed {
        let shift = |k: usize| {
            let next = if k + 1 < n { at[k + 1] } else { 1.0 };
            if degree % 2 == 1 { at[k] } else { 0.5 * (at[k] + next) }
        };
        Space::periodic(degree, (0..n).map(shift).collect(), 1.0)?
    } else {
        if n < degree + 2 {
            return Err(FairError::TooFew { expected: degree + 2, actual: n });
        }
        let mut knots = vec![0.0; degree + 1];
        for j in 1..n - degree {
            knots.push(at[j..j + degree].iter().sum::<f64>() / degree as f64);
        }
        knots.extend(std::iter::repeat_n(1.0, degree + 1));
        Space::open(KnotVector::new(degree, knots)?)?
    };
    fit(space, points, at, &vec![1.0; n])
}

/// The spline with `count` control points nearest to the data points in the sum of squares, its
/// ends at the first and last point. Knots follow the density of the parameters (Piegl and Tiller
/// 1997, eq. 9.69); of a closed curve they are uniform.
///
/// # Errors
/// [`FairError`] when the points are fewer than `count`, not finite or coincide.
pub fn least_squares(
    degree: usize,
    points: &[Vec3<f64>],
    count: usize,
    spacing: ParameterSpacing,
    closed: bool,
) -> Result<Fit, FairError> {
    let at = parameters(points, spacing, closed)?;
    let n = points.len();
    if n < count {
        return Err(FairError::TooFew { expected: count, actual: n });
    }
    let space = if closed {
        Space::periodic(degree, (0..count).map(|k| k as f64 / count as f64).collect(), 1.0)?
    } else {
        if count < degree + 2 {
            return Err(FairError::TooFew { expected: degree + 2, actual: count });
        }
        let mut knots = vec![0.0; degree + 1];
        let stride = n as f64 / (count - degree) as f64;
        for j in 1..count - degree {
            let place = j as f64 * stride;
            let i = place.floor();
            let share = place - i;
            let i = i as usize;
            knots.push((1.0 - share) * at[i - 1] + share * at[i]);
        }
        knots.extend(std::iter::repeat_n(1.0, degree + 1));
        Space::open(KnotVector::new(degree, knots)?)?
    };
    fit(space, points, at, &vec![1.0; n])
}

/// The spline of a given space nearest to data points at given parameters, with a weight for each
/// squared distance; a clamped spline ends at the first and last point.
///
/// # Errors
/// [`FairError::Singular`] when the data do not determine the spline, [`FairError::Count`].
pub fn fit(
    space: Space,
    points: &[Vec3<f64>],
    parameters: Vec<f64>,
    weights: &[f64],
) -> Result<Fit, FairError> {
    check_finite(points)?;
    for (what, actual) in [("parameters", parameters.len()), ("weights", weights.len())] {
        if actual != points.len() {
            return Err(FairError::Count { what, expected: points.len(), actual });
        }
    }
    if points.is_empty() {
        return Err(FairError::TooFew { expected: 1, actual: 0 });
    }
    if let Some(index) = weights.iter().position(|w| !w.is_finite() || *w <= 0.0) {
        return Err(FairError::Weight { index, weight: weights[index] });
    }
    let n = space.count();
    let rows = values(&space, &parameters);
    let mut control = vec![points[0]; n];
    let mut frozen = vec![false; n];
    if space.is_clamped() {
        control[n - 1] = points[points.len() - 1];
        (frozen[0], frozen[n - 1]) = (true, true);
    }
    let roots: Vec<f64> = weights.iter().map(|w| w.sqrt()).collect();
    let mut weighted = SparseRows::new();
    for (k, root) in roots.iter().enumerate() {
        let (c, f) = rows.row(k);
        weighted.push(c.iter().map(|&c| c as usize).zip(f.iter().map(|x| x * root)));
    }
    // The normal equations, with their own residual solved for twice more.
    for _ in 0..3 {
        let off = |k: usize| ((rows.apply(k, &control) - points[k]) * roots[k]).to_array();
        let problem = Problem {
            held: HeldDirections::default(),
            dimension: 3,
            offsets: (0..weighted.len()).map(off).collect(),
            measure: weighted.clone(),
            norm: RowNorm::Square,
            bounds: NormBounds::none(),
            frozen: frozen.clone(),
            conditions: Vec::new(),
            refined: false,
            halves: Vec::new(),
            squares: None,
            reach: vec![f64::INFINITY; n],
            begin: Vec::new(),
        };
        let step = problem::solve(&problem, 0.0, 0.0, 0.0, None)?;
        for (c, x) in control.iter_mut().zip(step.x) {
            *c += Vec3::from(x);
        }
    }
    if control.iter().any(|c| !c.is_finite()) {
        return Err(FairError::Singular);
    }
    // Control points that no datum holds would stay where they began.
    let listeners = rows.transposed(n);
    if (0..n).any(|j| listeners.row(j).1.iter().all(|x| x.abs() < 1e-12)) {
        return Err(FairError::Singular);
    }
    let distances: Vec<f64> =
        (0..points.len()).map(|k| (rows.apply(k, &control) - points[k]).norm()).collect();
    let largest = distances.iter().copied().fold(0.0, f64::max);
    let rms = (distances.iter().map(|d| d * d).sum::<f64>() / points.len() as f64).sqrt();
    Ok(Fit { space, points: control, parameters, largest, rms })
}

/// The rational spline of a given space, with these weights of its control points, nearest to data
/// points at given parameters; it interpolates when there are as many points. The weights are
/// fixed, so the fit is linear: the homogeneous curve is fitted to points times their denominators.
///
/// # Errors
/// As [`fit`]; [`FairError::Weight`], [`FairError::Count`] of the weights.
pub fn fit_rational(
    space: Space,
    points: &[Vec3<f64>],
    parameters: Vec<f64>,
    weights: &[f64],
) -> Result<Fit, FairError> {
    let (expected, actual) = (space.count(), weights.len());
    if expected != actual {
        return Err(FairError::Count { what: "weights", expected, actual });
    }
    if let Some(index) = weights.iter().position(|w| !w.is_finite() || *w <= 0.0) {
        return Err(FairError::Weight { index, weight: weights[index] });
    }
    let rows = values(&space, &parameters);
    let under = |k: usize| {
        let (columns, factors) = rows.row(k);
        columns.iter().zip(factors).map(|(&c, x)| weights[c as usize] * x).sum::<f64>()
    };
    let totals: Vec<f64> = (0..rows.len()).map(under).collect();
    let raised: Vec<_> = points.iter().zip(&totals).map(|(&p, &w)| p * w).collect();
    // Distances of the curve itself count, not those of its homogeneous form.
    let counts: Vec<f64> = totals.iter().map(|w| 1.0 / (w * w)).collect();
    let mut fitted = fit(space, &raised, parameters, &counts)?;
    let away = |(k, p): (usize, &Vec3<f64>)| {
        (rows.apply(k, &fitted.points) * (1.0 / totals[k]) - *p).norm()
    };
    let distances: Vec<f64> = points.iter().enumerate().map(away).collect();
    fitted.largest = distances.iter().copied().fold(0.0, f64::max);
    fitted.rms = (distances.iter().map(|d| d * d).sum::<f64>() / points.len() as f64).sqrt();
    for (c, w) in fitted.points.iter_mut().zip(weights) {
        *c = *c * (1.0 / w);
    }
    Ok(fitted)
}

/// The basis functions at parameters, as rows over the control points.
pub(crate) fn values(space: &Space, parameters: &[f64]) -> SparseRows {
    let mut rows = SparseRows::new();
    // Neighbours are mostly on one span.
    let mut local = None;
    for &t in parameters {
        let (k, t) = space.locate(t);
        if local.as_ref().is_none_or(|(span, _)| *span != k) {
            local = Some((k, space.local_knots(k)));
        }
        let Some((_, knots)) = &local else { continue };
        let basis = knots.basis_in(space.degree(), t, Order::Zero);
        rows.push(space.columns(k).zip(basis.rows[0].iter().copied()));
    }
    rows
}

/// A sum of squares without limits.
fn squares(measure: SparseRows, offsets: Vec<[f64; 3]>, frozen: Vec<bool>) -> Problem {
    let reach = vec![f64::INFINITY; frozen.len()];
    let bounds = NormBounds::none();
    let conditions = Vec::new();
    Problem {
        held: HeldDirections::default(),
        dimension: 3,
        measure,
        norm: RowNorm::Square,
        offsets,
        bounds,
        frozen,
        conditions,
        refined: false,
        halves: Vec::new(),
        squares: None,
        reach,
        begin: Vec::new(),
    }
}

/// The control points of an unweighted fit for data that carry derivatives, whose real parts are
/// the fitted data. Knots and parameters are fixed, so a fit is linear in its data.
///
/// # Errors
/// As [`fit`].
pub fn fit_with<T: Real>(fit: &Fit, points: &[Vec3<T>]) -> Result<Vec<Vec3<T>>, FairError> {
    let n = fit.space.count();
    let rows = values(&fit.space, &fit.parameters);
    let mut frozen = vec![false; n];
    let change = |p: &Vec3<T>| *p - Vec3::lifted(p.re());
    let mut control: Vec<Vec3<T>> = fit.points.iter().map(|&p| Vec3::lifted(p)).collect();
    if fit.space.is_clamped() {
        (frozen[0], frozen[n - 1]) = (true, true);
        control[0] += change(&points[0]);
        control[n - 1] += change(&points[points.len() - 1]);
    }
    let offsets: Vec<[T; 3]> = (0..rows.len())
        .map(|k| {
            let (columns, factors) = rows.row(k);
            let ends = columns.iter().zip(factors).filter(|(c, _)| frozen[**c as usize]);
            let moved = ends
                .fold(Vec3::zero(), |s, (&c, &x)| s + change(&control[c as usize]).map(|v| v * x));
            (moved - change(&points[k])).to_array()
        })
        .collect();
    let problem = squares(rows, vec![[0.0; 3]; offsets.len()], frozen);
    let still = problem::solve(&problem, 0.0, 0.0, 0.0, None)?;
    for (c, x) in
        control.iter_mut().zip(problem::respond(&problem, &still, &offsets, &[], &[], &[])?)
    {
        *c += Vec3::from(x);
    }
    Ok(control)
}
