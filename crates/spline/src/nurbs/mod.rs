//! Shapes as NURBS: exact where they are piecewise polynomial or rational, else fitted within an accuracy, with a
//! bound of the error.
//!
//! `shape -> samples between joints -> spline space of each parameter -> control points -> bound`
//!
//! In each parameter the samples between joints decide: where their Chebyshev coefficients end below rounding, the
//! shape is a polynomial there and its spline space has that degree, with the continuity found at the joints; else
//! the space is that of cubics, with knots added until the fit is near enough. Control points follow from
//! interpolation at the means of knots (Greville's abscissae). The error is bounded on every cell between knots by
//! the sum of the Chebyshev coefficients of the difference, with an allowance for those that were not computed: a
//! proof for shapes that are analytic between joints and as smooth as those coefficients show, not a sample.

mod axis;
mod chebyshev;
mod data;
mod edit;
mod fit;

pub use fit::{FitOptions, NotFitted, SampledShape, fit};

use moldloft_num::{Curve, Pace, Real, Solid, Surface, Vec3};

/// A curve (D = 1), surface (2) or solid (3) as a NURBS with clamped knots over [0, 1] in each parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Nurbs<const D: usize> {
    /// Polynomial degrees.
    pub degrees: [usize; D],
    /// Knots, end knots included, `degree + 1` times.
    pub knots: [Vec<f64>; D],
    /// Control points, the last index fastest; not multiplied by weights.
    pub points: Vec<Vec3>,
    /// Weights in the order of the points; `None` if all are 1.
    pub weights: Option<Vec<f64>>,
    /// A bound on the distance from the shape at equal parameters.
    pub error: f64,
    /// True when the shape equals this NURBS up to rounding.
    pub exact: bool,
    /// The shape's parameters as functions of those of the NURBS.
    pub paces: [Pace; D],
}

impl<const D: usize> Nurbs<D> {
    /// The numbers of control points.
    pub fn counts(&self) -> [usize; D] {
        std::array::from_fn(|d| self.knots[d].len() - self.degrees[d] - 1)
    }

    /// The control points times their weights, and the weights.
    pub(crate) fn homogeneous(&self) -> Vec<[f64; 4]> {
        let weight = |k: usize| self.weights.as_ref().map_or(1.0, |w| w[k]);
        let one = |(k, p): (usize, &Vec3)| {
            let w = weight(k);
            [p.x * w, p.y * w, p.z * w, w]
        };
        self.points.iter().enumerate().map(one).collect()
    }

    /// The points on a grid of its parameters, the last one fastest.
    pub fn grid(&self, axes: &[Vec<f64>; D]) -> Vec<Vec3> {
        let mut data = data::HomogeneousGrid { dims: self.counts(), values: self.homogeneous() };
        for d in 0..D {
            let rows = axis::basis_rows(self.degrees[d], &self.knots[d], &axes[d]);
            data = data.along(d, axes[d].len(), |line, out| axis::apply(&rows, line, out));
        }
        data.values.into_iter().map(data::point).collect()
    }

    /// The points at the given parameters.
    pub fn scattered(&self, places: &[[f64; D]]) -> Vec<Vec3> {
        let counts = self.counts();
        let rows: [Vec<axis::BasisRow>; D] = std::array::from_fn(|d| {
            let at: Vec<f64> = places.iter().map(|s| s[d]).collect();
            axis::basis_rows(self.degrees[d], &self.knots[d], &at)
        });
        let values = self.homogeneous();
        let one = |k: usize| {
            // Index and weight of each control point that affects the point.
            let mut terms = vec![(0, 1.0)];
            for d in 0..D {
                let (first, row) = &rows[d][k];
                let more = |&(at, w): &(usize, f64)| {
                    let each = move |(i, b): (usize, &f64)| (at * counts[d] + first + i, w * b);
                    row.iter().enumerate().map(each).collect::<Vec<_>>()
                };
                terms = terms.iter().flat_map(more).collect();
            }
            let mut sum = [0.0; 4];
            for (at, w) in terms {
                for (s, x) in sum.iter_mut().zip(values[at]) {
                    *s += w * x;
                }
            }
            data::point(sum)
        };
        (0..places.len()).map(one).collect()
    }

    /// The point at parameters of the NURBS.
    pub fn at(&self, s: [f64; D]) -> Vec3 {
        self.grid(&s.map(|x| vec![x]))[0]
    }
}

/// A curve as a NURBS.
///
/// # Errors
/// [`NotFitted`].
pub fn of_curve<T: Real>(
    curve: &dyn Curve<T>,
    options: &FitOptions,
) -> Result<Nurbs<1>, NotFitted> {
    let sample = |[ts]: &[Vec<f64>; 1]| {
        let mut out = vec![Vec3::zero(); ts.len()];
        curve.grid(ts, &mut out);
        out.into_iter().map(Vec3::re).collect()
    };
    fit(
        &SampledShape { sample: &sample, joints: [curve.joints()], rational: curve.rational() },
        options,
    )
}

/// A surface as a NURBS.
///
/// # Errors
/// [`NotFitted`].
pub fn of_surface<T: Real>(
    surface: &dyn Surface<T>,
    options: &FitOptions,
) -> Result<Nurbs<2>, NotFitted> {
    let sample = |[us, vs]: &[Vec<f64>; 2]| {
        let mut out = vec![Vec3::zero(); us.len() * vs.len()];
        surface.grid(us, vs, &mut out, None);
        out.into_iter().map(Vec3::re).collect()
    };
    fit(
        &SampledShape { sample: &sample, joints: surface.joints(), rational: surface.rational() },
        options,
    )
}

/// A solid as a NURBS.
///
/// # Errors
/// [`NotFitted`].
pub fn of_solid<T: Real>(
    solid: &dyn Solid<T>,
    joints: [Vec<f64>; 3],
    options: &FitOptions,
) -> Result<Nurbs<3>, NotFitted> {
    let sample = |[us, vs, ws]: &[Vec<f64>; 3]| {
        let mut out = vec![Vec3::zero(); us.len() * vs.len() * ws.len()];
        solid.grid(us, vs, ws, &mut out);
        out.into_iter().map(Vec3::re).collect()
    };
    fit(
        &SampledShape { sample: &sample, joints, rational: moldloft_num::Rational::none() },
        options,
    )
}
