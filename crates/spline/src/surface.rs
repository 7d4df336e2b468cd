//! Tensor-product B-spline surfaces of any degrees, rational ones among them.

use crate::curve::check_net;
use crate::patches::Patches;
use crate::{Basis, KnotVector, SplineError};
use moldloft_num::{Order, Rational, Real, SurfJet, Surface, Vec3};
use std::sync::OnceLock;

/// A tensor-product B-spline surface of any degrees on [0, 1] x [0, 1], rational if it has weights.
///
/// Outside the unit square the polynomials of the nearest patch continue.
#[derive(Clone, Debug)]
pub struct BSplineSurface<T> {
    u: KnotVector,
    v: KnotVector,
    points: Vec<Vec3<T>>,
    weights: Option<Vec<T>>,
    /// For scattered points, made on first use; `None` inside if degrees are too high.
    pub(crate) patches: OnceLock<Option<Patches<T>>>,
}

impl<T: Real> BSplineSurface<T> {
    /// The surface of these knots (over [0, 1]); control point (i, j) and its weight have the index
    /// `i * v.points() + j`.
    ///
    /// # Errors
    /// [`SplineError`] when they do not fit each other or are not finite.
    pub fn new(
        u: KnotVector,
        v: KnotVector,
        control_points: Vec<Vec3<T>>,
        weights: Option<Vec<T>>,
    ) -> Result<Self, SplineError> {
        check_net(&[&u, &v], &control_points, weights.as_deref())?;
        Ok(Self { u, v, points: control_points, weights, patches: OnceLock::new() })
    }

    /// The knots in both directions.
    pub fn knots(&self) -> [&KnotVector; 2] {
        [&self.u, &self.v]
    }

    /// The control points, (i, j) at `i * knots()[1].points() + j`.
    pub fn control_points(&self) -> &[Vec3<T>] {
        &self.points
    }

    /// The weights of a rational surface, in the order of the control points.
    pub fn weights(&self) -> Option<&[T]> {
        self.weights.as_deref()
    }

    /// The jet from the basis functions of both directions; see `BSplineCurve::combine`.
    #[inline(always)]
    fn combine<S: Real>(
        &self,
        [bu, bv]: [&Basis<S>; 2],
        order: Order,
        times: impl Fn(T, S) -> T,
    ) -> SurfJet<T> {
        let columns = self.v.points();
        let top = order as usize;
        // a[k][l]: derivative k by u and l by v of the (weighted) points, w of the weights.
        let mut a = [[Vec3::zero(); 3]; 3];
        let mut w = [[T::zero(); 3]; 3];
        for i in 0..bu.rows[0].len() {
            let start = (bu.first + i) * columns + bv.first;
            let mut line = [Vec3::zero(); 3];
            let mut line_w = [T::zero(); 3];
            for j in 0..bv.rows[0].len() {
                let mut p = self.points[start + j];
                if let Some(weights) = &self.weights {
                    let weight = weights[start + j];
                    p = p * weight;
                    for l in 0..=top {
                        line_w[l] += times(weight, bv.rows[l][j]);
                    }
                }
                for l in 0..=top {
                    line[l] += p.map(|x| times(x, bv.rows[l][j]));
                }
            }
            for k in 0..=top {
                let b = bu.rows[k][i];
                for l in 0..=top - k {
                    a[k][l] += line[l].map(|x| times(x, b));
                    if self.weights.is_some() {
                        w[k][l] += times(line_w[l], b);
                    }
                }
            }
        }
        if self.weights.is_none() {
            let [[p, v, vv], [u, uv, _], [uu, ..]] = a;
            return SurfJet { p, u, v, uu, uv, vv };
        }
        quotient(a, w)
    }
}

/// The jet of a(u, v) / w(u, v) (Piegl and Tiller 1997, eq. 4.20).
#[inline(always)]
pub(crate) fn quotient<T: Real>(a: [[Vec3<T>; 3]; 3], w: [[T; 3]; 3]) -> SurfJet<T> {
    let shrink = T::one() / w[0][0];
    let p = a[0][0] * shrink;
    let u = (a[1][0] - p * w[1][0]) * shrink;
    let v = (a[0][1] - p * w[0][1]) * shrink;
    let uu = (a[2][0] - u * (w[1][0] * 2.0) - p * w[2][0]) * shrink;
    let vv = (a[0][2] - v * (w[0][1] * 2.0) - p * w[0][2]) * shrink;
    let uv = (a[1][1] - u * w[0][1] - v * w[1][0] - p * w[1][1]) * shrink;
    SurfJet { p, u, v, uu, uv, vv }
}

impl<T: Real> Surface<T> for BSplineSurface<T> {
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        if u.is_constant() && v.is_constant() {
            let bases = [self.u.basis(u.re(), order), self.v.basis(v.re(), order)];
            self.combine(bases.each_ref(), order, |x, b: f64| x * b)
        } else {
            let bases = [self.u.basis(u, order), self.v.basis(v, order)];
            self.combine(bases.each_ref(), order, |x, b: T| x * b)
        }
    }

    fn grid(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        normals: Option<&mut [Vec3<T>]>,
    ) {
        self.tensor_grid(us, vs, points, normals);
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        [self.u.breaks(), self.v.breaks()]
    }

    fn joints(&self) -> [Vec<f64>; 2] {
        [self.u.joints(), self.v.joints()]
    }

    fn rational(&self) -> Rational<2> {
        let Some(weights) = &self.weights else { return Rational::none() };
        let weights: Vec<f64> = weights.iter().map(|w| w.re()).collect();
        let (u_knots, v_knots) = (self.u.clone(), self.v.clone());
        let columns = v_knots.points();
        let weight = move |[u, v]: [f64; 2]| {
            let (bu, bv) = (u_knots.basis(u, Order::Zero), v_knots.basis(v, Order::Zero));
            let row = |i: usize| {
                let from = (bu.first + i) * columns + bv.first;
                bv.rows[0].iter().zip(&weights[from..]).map(|(b, w)| b * w).sum::<f64>()
            };
            bu.rows[0].iter().enumerate().map(|(i, b)| b * row(i)).sum()
        };
        Rational { weight: Some(Box::new(weight)), ..Rational::none() }
    }

    moldloft_num::surface_facts!(kinks_at_breaks, breaks_along_lines, open);
    moldloft_num::surface_one_by_one!(T: line, scattered);
}
