//! Scattered points of a surface on a tape: values by the patches of plain numbers, derivatives as one node a coordinate.
//!
//! Patches of a tape's numbers would be nodes, and a shape that keeps them would refer to a recording that is forgotten.

use crate::BSplineSurface;
use moldloft_num::{Order, Real, SurfJet, Surface, Vec3};

impl<T: Real> BSplineSurface<T> {
    /// The surface of the plain numbers.
    fn plain(&self) -> BSplineSurface<f64> {
        let [u, v] = self.knots().map(Clone::clone);
        let points = self.control_points().iter().map(|p| p.re()).collect();
        let weights = self.weights().map(|all| all.iter().map(|w| w.re()).collect());
        BSplineSurface::new(u, v, points, weights).expect("the net of a surface")
    }

    pub(crate) fn scattered_on_tape(&self, uv: &[[f64; 2]], out: &mut [Vec3<T>]) {
        let mut values = vec![Vec3::zero(); uv.len()];
        self.plain().scattered(uv, &mut values);
        let mut terms: [Vec<(f64, T)>; 3] = Default::default();
        for ((x, value), &[u, v]) in out.iter_mut().zip(values).zip(uv) {
            terms.iter_mut().for_each(Vec::clear);
            self.for_each_share(u, v, |share, p, w| {
                for (axis, terms) in terms.iter_mut().enumerate() {
                    match w {
                        None => terms.push((share, p[axis])),
                        // X = N / w: dX = sum of B (w_ij dP_ij + (P_ij - X) dw_ij) / w.
                        Some(w) => {
                            terms.push((share * w.re(), p[axis]));
                            terms.push((share * (p[axis].re() - value[axis]), w));
                        }
                    }
                }
            });
            *x = Vec3::from([0, 1, 2].map(|axis| T::linear(value[axis], &terms[axis])));
        }
    }

    pub(crate) fn scattered_first_on_tape(&self, uv: &[[f64; 2]], out: &mut [SurfJet<T>]) {
        let mut values = vec![SurfJet::default(); uv.len()];
        self.plain().scattered_first(uv, &mut values);
        let with = |value: Vec3, x: Vec3<T>| {
            Vec3::from([0, 1, 2].map(|axis| T::linear(value[axis], &[(1.0, x[axis])])))
        };
        for ((x, value), &[u, v]) in out.iter_mut().zip(values).zip(uv) {
            let jet = self.jet(u.into(), v.into(), Order::First);
            let (p, u, v) = (with(value.p, jet.p), with(value.u, jet.u), with(value.v, jet.v));
            *x = SurfJet { p, u, v, ..SurfJet::default() };
        }
    }

    /// The control points in charge of (u, v) with their weights, and their basis functions over the sum of weights.
    fn for_each_share(&self, u: f64, v: f64, mut each: impl FnMut(f64, Vec3<T>, Option<T>)) {
        let [bu, bv] = {
            let [knots_u, knots_v] = self.knots();
            [knots_u.basis(u, Order::Zero), knots_v.basis(v, Order::Zero)]
        };
        let columns = self.knots()[1].points();
        let places = || {
            bu.rows[0].iter().enumerate().flat_map(|(i, &a)| {
                let row = (bu.first + i) * columns + bv.first;
                bv.rows[0].iter().enumerate().map(move |(j, &b)| (a * b, row + j))
            })
        };
        let total: f64 = match self.weights() {
            None => 1.0,
            Some(weights) => places().map(|(b, at)| b * weights[at].re()).sum(),
        };
        for (b, at) in places() {
            each(b / total, self.control_points()[at], self.weights().map(|w| w[at]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::KnotVector;
    use moldloft_num::{Adjoints, DerivativeTape, Dual, Rev};

    /// A surface of inputs `x`: coordinates, then weights.
    fn surface<T: Real>(x: &[T], rational: bool) -> BSplineSurface<T> {
        let (u, v) = (KnotVector::clamped_uniform(3, 6), KnotVector::clamped_uniform(2, 4));
        let points = x[..72].chunks(3).map(|c| Vec3::new(c[0], c[1], c[2])).collect();
        let weights = rational.then(|| x[72..].to_vec());
        BSplineSurface::new(u.unwrap(), v.unwrap(), points, weights).unwrap()
    }

    /// Points by all ways, as numbers.
    fn numbers<T: Real>(s: &BSplineSurface<T>) -> Vec<T> {
        let uv = [[0.13, 0.92], [0.5, 0.5], [1.0, 0.0], [0.77, 0.31]];
        let mut points = vec![Vec3::zero(); 4];
        s.scattered(&uv, &mut points);
        let mut jets = vec![SurfJet::default(); 4];
        s.scattered_first(&uv, &mut jets);
        let mut grid = vec![Vec3::zero(); 6];
        s.grid(&[0.0, 0.4, 0.9], &[0.2, 0.7], &mut grid, None);
        points.extend(jets.iter().flat_map(|j| [j.p, j.u, j.v]));
        points.extend(grid);
        points.iter().flat_map(|p| p.to_array()).collect()
    }

    #[test]
    fn the_transposed_jacobian_is_that_of_forward_mode() {
        let x: Vec<f64> = (0..96).map(|k| 1.0 + 0.3 * f64::from(k * k % 17).sin()).collect();
        for rational in [false, true] {
            let plain = numbers(&surface(&x, rational));
            DerivativeTape::clear();
            let inputs: Vec<Rev> = x.iter().map(|&x| DerivativeTape::input(x)).collect();
            let taped = numbers(&surface(&inputs, rational));
            let weight = |k: usize| f64::from(k as u32 * 7919 % 101) / 50.0 - 1.0;
            let mut adjoints = Adjoints::new();
            taped.iter().enumerate().for_each(|(k, y)| adjoints.add(*y, weight(k)));
            adjoints.pull();
            assert!(DerivativeTape::is_sound() && adjoints.are_sound());
            assert!(taped.iter().zip(&plain).all(|(a, b)| a.re() == *b));
            for (at, input) in inputs.iter().enumerate() {
                let seeded = x.iter().enumerate().map(|(k, &x)| match k == at {
                    true => Dual::<1>::seeded(x, 0),
                    false => x.into(),
                });
                let dual = numbers(&surface(&seeded.collect::<Vec<_>>(), rational));
                let exact: f64 = dual.iter().enumerate().map(|(k, y)| weight(k) * y.eps[0]).sum();
                assert!((adjoints.of(*input) - exact).abs() < 1e-12, "input {at}");
            }
        }
    }
}
