//! Splines through points that are only continuous at some of them: intended breaks.

use crate::error::check_finite;
use crate::{FairError, Fit, ParameterSpacing, Space, fit, fit_with, parameters};
use moldloft_num::{Real, Vec3};
use moldloft_spline::KnotVector;

/// A spline through points, with corners at the intended breaks.
#[derive(Clone, Debug)]
pub struct FitWithCorners<T> {
    /// The fitted spline (real parts).
    pub fit: Fit,
    /// Its control points.
    pub points: Vec<Vec3<T>>,
    /// Control points at the breaks; they coincide with the data points there.
    pub marks: Vec<usize>,
    /// The parameter of each given point, in the order of the points.
    pub at: Vec<f64>,
}

/// The interpolating spline that is continuous but not smooth at the points `breaks` (from 0):
/// knots of multiplicity `degree` separate the pieces, each of which interpolates its own points
/// alone. A piece of fewer than `degree + 1` points is the polynomial through them.
///
/// A closed curve with a break becomes an open one that begins and ends at its first break: its
/// parameters count from there. Without breaks this is [`crate::interpolate`]. Parameters are those of
/// the real parts.
///
/// # Errors
/// As [`crate::interpolate`]; [`FairError::Mark`] when there is no such point.
///
/// # Example
/// ```
/// use moldloft_fair::{ParameterSpacing, interpolate_with_corners, shape};
/// use moldloft_num::Vec3;
/// let roof: Vec<Vec3<f64>> =
///     (-5..=5).map(|i: i32| Vec3::of(i.into(), -f64::from(i.abs()), 0.0)).collect();
/// let sharp = interpolate_with_corners(3, &roof, ParameterSpacing::Chord, false, &[5]).unwrap();
/// assert!(sharp.points[sharp.marks[0]].bits_eq(roof[5]));
/// let near = shape::sample_at(&sharp.fit.space, &sharp.points, None, 0.45).point;
/// assert!((near.y + 0.5).abs() < 1e-12);
/// ```
pub fn interpolate_with_corners<T: Real>(
    degree: usize,
    points: &[Vec3<T>],
    spacing: ParameterSpacing,
    closed: bool,
    breaks: &[usize],
) -> Result<FitWithCorners<T>, FairError> {
    let plain: Vec<Vec3<f64>> = points.iter().map(|p| p.re()).collect();
    check_finite(&plain)?;
    let count = points.len();
    if let Some(&index) = breaks.iter().find(|&&b| b >= count) {
        return Err(FairError::Mark { index, count });
    }
    let mut breaks = breaks.to_vec();
    breaks.sort_unstable();
    breaks.dedup();
    let at = parameters(&plain, spacing, closed)?;
    let Some(&first) = breaks.first() else {
        let fit = crate::interpolate(degree, &plain, spacing, closed)?;
        let points = fit_with(&fit, points)?;
        return Ok(FitWithCorners { fit, points, marks: Vec::new(), at });
    };
    if !closed {
        return open(degree, points, &at, &breaks);
    }
    let (mut turned, mut from) = (Vec::with_capacity(count + 1), Vec::with_capacity(count + 1));
    for k in 0..count {
        let i = (first + k) % count;
        turned.push(points[i]);
        from.push(at[i] - at[first] + if i < first { 1.0 } else { 0.0 });
    }
    turned.push(points[first]);
    from.push(1.0);
    let mut moved: Vec<usize> = breaks.iter().map(|b| b - first).collect();
    moved.push(count);
    let mut sharp = open(degree, &turned, &from, &moved)?;
    let turned_at = std::mem::take(&mut sharp.at);
    sharp.at = vec![0.0; count];
    for (k, t) in turned_at.into_iter().take(count).enumerate() {
        sharp.at[(first + k) % count] = t;
    }
    Ok(sharp)
}

/// The interpolating spline of an open curve at given parameters; `breaks` ascend.
fn open<T: Real>(
    degree: usize,
    points: &[Vec3<T>],
    at: &[f64],
    breaks: &[usize],
) -> Result<FitWithCorners<T>, FairError> {
    let last = points.len() - 1;
    if points.len() < 2 {
        return Err(FairError::TooFew { expected: 2, actual: points.len() });
    }
    let inner = breaks.iter().copied().filter(|&b| 0 < b && b < last);
    let ends: Vec<usize> = std::iter::once(0).chain(inner).chain([last]).collect();
    let mut knots = vec![at[0]; degree + 1];
    let (mut data, mut parameters) = (vec![points[0]], vec![at[0]]);
    let mut corner_of = vec![(0, 0)];
    for pair in ends.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let (mut own, mut own_at) = filled(degree, &points[from..=to], &at[from..=to]);
        let m = own.len();
        for j in 1..m - degree {
            knots.push(own_at[j..j + degree].iter().sum::<f64>() / degree as f64);
        }
        let times = if to == last { degree + 1 } else { degree };
        knots.extend(std::iter::repeat_n(at[to], times));
        data.extend(own.drain(1..));
        parameters.extend(own_at.drain(1..));
        corner_of.push((to, data.len() - 1));
    }
    let space = Space::open(KnotVector::new(degree, knots)?)?;
    let plain: Vec<Vec3<f64>> = data.iter().map(|p| p.re()).collect();
    let weights = vec![1.0; plain.len()];
    let mut fit = fit(space, &plain, parameters, &weights)?;
    let mut control = fit_with(&fit, &data)?;
    let of = |b: &usize| corner_of.iter().find(|(i, _)| i == b).map(|&(_, c)| c);
    let marks: Vec<usize> = breaks.iter().filter_map(of).collect();
    // A break is a data point by its bits, not by the grace of a solver.
    for &(i, c) in &corner_of {
        control[c] = points[i];
        fit.points[c] = points[i].re();
    }
    Ok(FitWithCorners { fit, points: control, marks, at: at.to_vec() })
}

/// A piece with at least `degree + 1` points: those that are missing are taken from the polynomial
/// through the others, spread over its gaps.
fn filled<T: Real>(degree: usize, points: &[Vec3<T>], at: &[f64]) -> (Vec<Vec3<T>>, Vec<f64>) {
    let m = points.len();
    if m > degree {
        return (points.to_vec(), at.to_vec());
    }
    let (missing, gaps) = (degree + 1 - m, m - 1);
    let (mut out, mut out_at) = (Vec::new(), Vec::new());
    for gap in 0..gaps {
        out.push(points[gap]);
        out_at.push(at[gap]);
        let share = missing / gaps + usize::from(gap < missing % gaps);
        for k in 1..=share {
            let t = at[gap] + (at[gap + 1] - at[gap]) * k as f64 / (share + 1) as f64;
            let mut sum = Vec3::zero();
            for (j, &p) in points.iter().enumerate() {
                let others = (0..m).filter(|&i| i != j);
                let factor: f64 = others.map(|i| (t - at[i]) / (at[j] - at[i])).product();
                sum += p.map(|x| x * factor);
            }
            out.push(sum);
            out_at.push(t);
        }
    }
    out.push(points[m - 1]);
    out_at.push(at[m - 1]);
    (out, out_at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interrogate::shape::sample_at;

    #[test]
    fn pieces_pass_through_their_points_and_know_nothing_of_each_other() {
        // A box with one arc: pieces of two, three and many points.
        let mut points = vec![Vec3::of(0.0, 0.0, 0.0), Vec3::of(2.0, 0.0, 0.0)];
        points.push(Vec3::of(2.3, 0.5, 0.0));
        points.push(Vec3::of(2.0, 1.0, 0.0));
        points.extend((1..9).map(|i| Vec3::of(2.0 - 0.25 * f64::from(i), 1.0, 0.0)));
        for closed in [false, true] {
            for degree in [2, 3, 5] {
                let breaks = [0, 1, 3, 11];
                let s = interpolate_with_corners(
                    degree,
                    &points,
                    ParameterSpacing::Chord,
                    closed,
                    &breaks,
                )
                .unwrap();
                assert!(s.fit.largest < 1e-12, "{}", s.fit.largest);
                assert_eq!(s.marks.len(), if closed { 5 } else { 4 });
                for (&m, b) in s.marks.iter().zip(breaks) {
                    assert!(s.points[m].bits_eq(points[b]));
                }
                let p = |t| sample_at(&s.fit.space, &s.points, None, t).point;
                for (&t, &q) in s.at.iter().zip(&points) {
                    assert!((p(t) - q).norm() < 1e-12);
                }
                // Straight sides are straight to the corner.
                let corner = s.fit.parameters[1..]
                    .iter()
                    .copied()
                    .find(|&t| (p(t) - points[1]).norm() < 1e-12)
                    .unwrap();
                for k in 0..=8 {
                    assert!(p(corner * f64::from(k) / 8.0).y.abs() < 1e-14);
                }
            }
        }
        let refused = interpolate_with_corners(3, &points, ParameterSpacing::Chord, false, &[12]);
        assert_eq!(refused.unwrap_err(), FairError::Mark { index: 12, count: 12 });
    }
}
