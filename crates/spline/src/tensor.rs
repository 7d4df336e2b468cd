//! Surfaces through grids of points: bicubic and twice differentiable, or bilinear.

use crate::{Ends, InterpolatingSpline, InterpolationError};
use moldloft_num::{Order, Real, SurfJet, Surface, Vec3};

/// A surface through a grid of points: bicubic and twice differentiable, or bilinear.
///
/// Knots are one per line of the grid in each direction, from 0 to 1; they are scalars and may move
/// with the points. The bicubic one is the tensor product of interpolating splines: along each line
/// of the grid it is that line's spline at the common knots. At a knot pair it passes through the
/// point to the bit. Lines that are a single point (poles) are allowed. Outside the unit square the
/// nearest cell continues.
///
/// # Example
/// ```
/// use moldloft_num::{Order, Surface, Vec3};
/// use moldloft_spline::{Ends, GridSpline};
/// let knots = vec![0.0, 0.5, 1.0];
/// let grid = knots.iter().flat_map(|&u| knots.iter().map(move |&v| Vec3::of(u, v, u * v)));
/// let s = GridSpline::bicubic(knots.clone(), knots.clone(), grid.collect(), Ends::default());
/// assert!((s.unwrap().jet(0.3f64, 0.6, Order::Zero).p.z - 0.18).abs() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct GridSpline<T: Real> {
    u: Vec<T>,
    v: Vec<T>,
    /// Point (i, j) at `i * v.len() + j`.
    points: Vec<Vec3<T>>,
    /// Derivatives with respect to u, v and both, at the points; `None` for a bilinear surface.
    slopes: Option<[Vec<Vec3<T>>; 3]>,
}

/// The cell in charge of a parameter, with the weights of the two points beside it and of their
/// slopes: values, first and second derivatives.
struct HermiteWeights<T> {
    cell: usize,
    points: [[T; 2]; 3],
    slopes: [[T; 2]; 3],
}

impl<T: Real> GridSpline<T> {
    /// The bicubic spline surface through `points`, (i, j) at `i * v.len() + j`, at the ascending
    /// knots `u` and `v`, with the same end conditions at all edges.
    ///
    /// # Errors
    /// [`InterpolationError`] as for [`InterpolatingSpline::with_knots`]; periodic ends require
    /// equal first and last lines, clamped ones are for curves.
    pub fn bicubic(
        u: Vec<T>,
        v: Vec<T>,
        points: Vec<Vec3<T>>,
        ends: Ends<T>,
    ) -> Result<Self, InterpolationError> {
        Self::bicubic_with(u, v, points, [ends, ends])
    }

    /// As `bicubic`, with end conditions for each direction: of the lines along u, and along v.
    ///
    /// # Errors
    /// As [`Self::bicubic`].
    pub fn bicubic_with(
        u: Vec<T>,
        v: Vec<T>,
        points: Vec<Vec3<T>>,
        ends: [Ends<T>; 2],
    ) -> Result<Self, InterpolationError> {
        let surface = Self::bicubic_while(u, v, points, ends, &|| true)?;
        Ok(surface.expect("nothing ends it"))
    }

    /// As [`Self::bicubic_with`]; stops and returns `None` when `go_on`, which is called for each
    /// line, returns false.
    ///
    /// # Errors
    /// As [`Self::bicubic`].
    pub fn bicubic_while(
        u: Vec<T>,
        v: Vec<T>,
        points: Vec<Vec3<T>>,
        ends: [Ends<T>; 2],
        go_on: &dyn Fn() -> bool,
    ) -> Result<Option<Self>, InterpolationError> {
        check(&u, &v, &points)?;
        let slopes =
            |points: &[Vec3<T>], axis: usize| slopes([&u, &v], points, axis, ends[axis], go_on);
        let Some(by_u) = slopes(&points, 0)? else { return Ok(None) };
        let Some(by_v) = slopes(&points, 1)? else { return Ok(None) };
        let Some(by_uv) = slopes(&by_u, 1)? else { return Ok(None) };
        Ok(Some(Self { u, v, points, slopes: Some([by_u, by_v, by_uv]) }))
    }

    /// The bilinear surface through `points`.
    ///
    /// # Errors
    /// [`InterpolationError`] for knots that do not ascend, or counts that do not fit.
    pub fn bilinear(
        u: Vec<T>,
        v: Vec<T>,
        points: Vec<Vec3<T>>,
    ) -> Result<Self, InterpolationError> {
        check(&u, &v, &points)?;
        Ok(Self { u, v, points, slopes: None })
    }

    /// The knots along u and along v.
    pub fn knots(&self) -> [&[T]; 2] {
        [&self.u, &self.v]
    }

    #[inline(always)]
    fn combine(
        &self,
        a: &HermiteWeights<T>,
        b: &HermiteWeights<T>,
        du: usize,
        dv: usize,
    ) -> Vec3<T> {
        let n = self.v.len();
        let mut sum = Vec3::zero();
        for i in 0..2 {
            for j in 0..2 {
                let k = (a.cell + i) * n + b.cell + j;
                sum += self.points[k] * (a.points[du][i] * b.points[dv][j]);
                if let Some([by_u, by_v, by_uv]) = &self.slopes {
                    sum += by_u[k] * (a.slopes[du][i] * b.points[dv][j]);
                    sum += by_v[k] * (a.points[du][i] * b.slopes[dv][j]);
                    sum += by_uv[k] * (a.slopes[du][i] * b.slopes[dv][j]);
                }
            }
        }
        sum
    }

    fn jet_of(&self, a: &HermiteWeights<T>, b: &HermiteWeights<T>, order: Order) -> SurfJet<T> {
        let mut jet = SurfJet { p: self.combine(a, b, 0, 0), ..SurfJet::default() };
        if order >= Order::First {
            jet.u = self.combine(a, b, 1, 0);
            jet.v = self.combine(a, b, 0, 1);
        }
        if order == Order::Second {
            jet.uu = self.combine(a, b, 2, 0);
            jet.uv = self.combine(a, b, 1, 1);
            jet.vv = self.combine(a, b, 0, 2);
        }
        jet
    }

    fn weights(&self, knots: &[T], t: T) -> HermiteWeights<T> {
        if self.slopes.is_some() { cubic(knots, t) } else { linear(knots, t) }
    }
}

fn check<T: Real>(u: &[T], v: &[T], points: &[Vec3<T>]) -> Result<(), InterpolationError> {
    let actual = u.len().min(v.len());
    if actual < 2 {
        return Err(InterpolationError::TooFew { expected: 2, actual });
    }
    if points.len() != u.len() * v.len() {
        let expected = points.len();
        return Err(InterpolationError::Knots { expected, actual: u.len() * v.len() });
    }
    if let Some(index) = points.iter().position(|p| !p.is_finite()) {
        return Err(InterpolationError::NotFinite { index });
    }
    for knots in [u, v] {
        for k in 1..knots.len() {
            let gap = knots[k] - knots[k - 1];
            if !(gap.re() > 0.0 && gap.is_finite()) {
                return Err(InterpolationError::Coincident { first: k - 1, second: k });
            }
        }
    }
    Ok(())
}

/// The slopes at all points of the splines along u (`axis` 0) or v (1).
fn slopes<T: Real>(
    [u, v]: [&[T]; 2],
    points: &[Vec3<T>],
    axis: usize,
    ends: Ends<T>,
    go_on: &dyn Fn() -> bool,
) -> Result<Option<Vec<Vec3<T>>>, InterpolationError> {
    let n = v.len();
    let (knots, lines, step, start) = if axis == 0 { (u, n, n, 1) } else { (v, u.len(), 1, n) };
    let mut slopes = vec![Vec3::zero(); points.len()];
    let mut line = vec![Vec3::zero(); knots.len()];
    for l in 0..lines {
        if !go_on() {
            return Ok(None);
        }
        let at = |k: usize| l * start + k * step;
        for (k, p) in line.iter_mut().enumerate() {
            *p = points[at(k)];
        }
        let spline = InterpolatingSpline::with_knots(knots, &line, ends)?;
        for (k, [_, slope, ..]) in spline.pieces().coefficients().iter().enumerate() {
            slopes[at(k)] = *slope;
        }
    }
    Ok(Some(slopes))
}

/// The cell of `t`, the position in it as a fraction, and the inverse of its width.
fn cell<T: Real>(knots: &[T], t: T) -> (usize, T, T) {
    let inner = &knots[1..knots.len() - 1];
    let k = inner.partition_point(|knot| knot.re() <= t.re());
    let width = knots[k + 1] - knots[k];
    (k, (t - knots[k]) / width, T::one() / width)
}

fn linear<T: Real>(knots: &[T], t: T) -> HermiteWeights<T> {
    let (cell, s, shrink) = cell(knots, t);
    let zero = T::zero();
    let points = [[-s + 1.0, s], [-shrink, shrink], [zero, zero]];
    HermiteWeights { cell, points, slopes: [[zero; 2]; 3] }
}

/// Hermite's cubics: the weights of the points are 1 - q and q with q = s^2 (3 - 2 s), those of the
/// slopes, h s (1 - s)^2 and h s^2 (s - 1).
fn cubic<T: Real>(knots: &[T], t: T) -> HermiteWeights<T> {
    let (cell, s, shrink) = cell(knots, t);
    let width = knots[cell + 1] - knots[cell];
    let r = -s + 1.0;
    let q = s * s * (-(s * 2.0) + 3.0);
    let rise = s * r * shrink * 6.0;
    let bend = (-(s * 2.0) + 1.0) * shrink * shrink * 6.0;
    HermiteWeights {
        cell,
        points: [[-q + 1.0, q], [-rise, rise], [-bend, bend]],
        slopes: [
            [s * r * r * width, -(s * s * r * width)],
            [r * (-(s * 3.0) + 1.0), s * (s * 3.0 - 2.0)],
            [(s * 6.0 - 4.0) * shrink, (s * 6.0 - 2.0) * shrink],
        ],
    }
}

impl<T: Real> Surface<T> for GridSpline<T> {
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        self.jet_of(&self.weights(&self.u, u), &self.weights(&self.v, v), order)
    }

    fn grid(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        mut normals: Option<&mut [Vec3<T>]>,
    ) {
        let across: Vec<HermiteWeights<T>> =
            vs.iter().map(|&v| self.weights(&self.v, T::from(v))).collect();
        for (i, &u) in us.iter().enumerate() {
            let along = self.weights(&self.u, T::from(u));
            for (j, across) in across.iter().enumerate() {
                let k = i * vs.len() + j;
                match normals.as_deref_mut() {
                    None => points[k] = self.combine(&along, across, 0, 0),
                    Some(normals) => {
                        let jet = self.jet_of(&along, across, Order::First);
                        (points[k], normals[k]) = (jet.p, jet.normal());
                    }
                }
            }
        }
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        [&self.u, &self.v].map(|knots| knots[1..knots.len() - 1].iter().map(|k| k.re()).collect())
    }

    moldloft_num::surface_facts!(broken, open, not_rational);
    moldloft_num::surface_one_by_one!(T: line, scattered);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::End;

    fn knots() -> Vec<f64> {
        vec![0.0, 0.1, 0.35, 0.7, 1.0]
    }

    fn sampled(f: impl Fn(f64, f64) -> Vec3) -> Vec<Vec3> {
        knots()
            .iter()
            .flat_map(|&u| knots().into_iter().map(move |v| (u, v)))
            .map(|(u, v)| f(u, v))
            .collect()
    }

    #[test]
    fn bicubics_are_reproduced_and_knots_are_points_to_the_bit() {
        let f =
            |u: f64, v: f64| Vec3::of(u * u * u - 2.0 * v, u * v * v * v, 1.0 + u * u * v - v * v);
        let points = sampled(f);
        let s = GridSpline::bicubic(knots(), knots(), points.clone(), Ends::default()).unwrap();
        for (u, v) in [(0.05, 0.5), (0.93, 0.2), (1.0, 0.99), (-0.1, 1.2)] {
            let jet = s.jet(u, v, Order::Second);
            assert!((jet.p - f(u, v)).norm() < 2e-14);
            assert!((jet.u - Vec3::of(3.0 * u * u, v * v * v, 2.0 * u * v)).norm() < 1e-12);
            assert!((jet.uv - Vec3::of(0.0, 3.0 * v * v, 2.0 * u)).norm() < 1e-11);
            assert!((jet.vv - Vec3::of(0.0, 6.0 * u * v, -2.0)).norm() < 1e-10);
        }
        for (k, p) in points.iter().enumerate() {
            let (u, v) = (knots()[k / 5], knots()[k % 5]);
            assert_eq!(s.jet(u, v, Order::Zero).p, *p);
        }
        let mut grid = vec![Vec3::zero(); 4];
        let mut normals = grid.clone();
        s.grid(&[0.2, 0.9], &[0.0, 0.4], &mut grid, Some(&mut normals));
        assert_eq!(grid[3], s.jet(0.9, 0.4, Order::Zero).p);
        assert_eq!(normals[2], s.jet(0.9, 0.0, Order::First).normal());
    }

    #[test]
    fn bilinear_and_ends() {
        let points = sampled(|u, v| Vec3::of(u, v, u * v));
        let s = GridSpline::bilinear(knots(), knots(), points.clone()).unwrap();
        let jet = s.jet(0.4, 0.6, Order::Second);
        assert!((jet.p - Vec3::of(0.4, 0.6, 0.24)).norm() < 1e-15);
        assert!((jet.uv.z - 1.0).abs() < 1e-12 && jet.uu == Vec3::zero());
        let natural = Ends::Open(End::Natural, End::Natural);
        let bowl = sampled(|u, v| Vec3::of(u, v, u * u + v.powi(3)));
        let s = GridSpline::bicubic(knots(), knots(), bowl, natural).unwrap();
        let jet = s.jet(0.0, 1.0, Order::Second);
        assert!(jet.uu.norm() < 1e-13 && jet.vv.norm() < 1e-12);
        let few = GridSpline::bilinear(vec![0.0], knots(), vec![Vec3::zero(); 5]);
        assert_eq!(few, Err(InterpolationError::TooFew { expected: 2, actual: 1 }));
        let back = GridSpline::bilinear(vec![0.0, 0.5, 0.5, 0.8, 1.0], knots(), points);
        assert_eq!(back, Err(InterpolationError::Coincident { first: 1, second: 2 }));
    }
}
