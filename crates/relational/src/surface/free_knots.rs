//! Rational B-spline surfaces with scalar knots, for derivatives with respect to the knots.

use moldloft_num::trace::{Edges, Key};
use moldloft_num::{Jet, Rational, Real, SurfaceFormula, Uni1, Vec3};
use smallvec::SmallVec;

/// The knots in one direction.
pub struct FreeKnots<T> {
    pub degree: usize,
    /// Ascending, on [0, 1].
    pub knots: Vec<T>,
}

impl<T: Real> FreeKnots<T> {
    /// These knots scaled so that the domain is [0, 1].
    pub fn normalized(degree: usize, knots: &[T]) -> Self {
        let (low, high) = (knots[degree], knots[knots.len() - degree - 1]);
        Self { degree, knots: knots.iter().map(|&k| (k - low) / (high - low)).collect() }
    }

    /// The basis functions that do not vanish at `t`, and the number of the first (Piegl and
    /// Tiller 1997, algorithm A2.2).
    fn basis<J: Jet<T>>(&self, t: J) -> (usize, SmallVec<[J; 8]>) {
        let (p, last) = (self.degree, self.knots.len() - self.degree - 2);
        let inner = (p..=last).rev().find(|&i| self.knots[i].re() <= t.re());
        let mut span = inner.unwrap_or(p);
        // At the end of the domain: the last interval of non-zero length.
        while span > p && self.knots[span].re() == self.knots[span + 1].re() {
            span -= 1;
        }
        let mut n: SmallVec<[J; 8]> = SmallVec::from_elem(J::zero(), p + 1);
        n[0] = J::one();
        let left = |j: usize| t - J::fixed(self.knots[span + 1 - j]);
        let right = |j: usize| J::fixed(self.knots[span + j]) - t;
        for j in 1..=p {
            let mut saved = J::zero();
            for r in 0..j {
                let share = n[r] / (right(r + 1) + left(j - r));
                n[r] = saved + right(r + 1) * share;
                saved = left(j - r) * share;
            }
            n[j] = saved;
        }
        (span - p, n)
    }

    fn breaks(&self) -> Vec<f64> {
        let mut all: Vec<f64> =
            self.knots.iter().map(|k| k.re()).filter(|k| *k > 0.0 && *k < 1.0).collect();
        all.dedup();
        all
    }
}

/// The surface.
pub struct FreeNet<T: Real> {
    pub knots: [FreeKnots<T>; 2],
    /// v fastest.
    pub points: Vec<Vec3<T>>,
    /// One weight per control point; default: all 1.
    pub weights: Option<Vec<T>>,
    pub corners: [Option<Key>; 4],
    /// The point objects along the edges.
    pub rows: super::bsurf::Rows,
}

impl<T: Real> SurfaceFormula for FreeNet<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        let [(first_u, by_u), (first_v, by_v)] = [self.knots[0].basis(u), self.knots[1].basis(v)];
        let nv = self.knots[1].knots.len() - self.knots[1].degree - 1;
        let (mut sum, mut total) = (Vec3::zero(), J::zero());
        for (i, &a) in by_u.iter().enumerate() {
            for (j, &b) in by_v.iter().enumerate() {
                let k = (first_u + i) * nv + first_v + j;
                let share = a * b;
                let share = self.weights.as_ref().map_or(share, |w| share.scaled(w[k]));
                sum += self.points[k].map(|x| share.scaled(x));
                total += share;
            }
        }
        if self.weights.is_some() { sum / total } else { sum }
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        [self.knots[0].breaks(), self.knots[1].breaks()]
    }

    fn edges(&self) -> Edges<T> {
        Edges { corners: self.corners, ..Edges::own() }
    }

    fn edge_made_of(&self, k: usize) -> Vec<Key> {
        self.rows[k].to_vec()
    }

    fn rational(&self) -> Rational<2> {
        let Some(weights) = &self.weights else { return Rational::none() };
        let weights: Vec<f64> = weights.iter().map(|w| w.re()).collect();
        let plain = |k: &FreeKnots<T>| FreeKnots {
            degree: k.degree,
            knots: k.knots.iter().map(|k| k.re()).collect::<Vec<f64>>(),
        };
        let [u_knots, v_knots] = self.knots.each_ref().map(plain);
        let columns = v_knots.knots.len() - v_knots.degree - 1;
        let weight = move |[u, v]: [f64; 2]| {
            // These jets carry slopes that are not used; jets of order zero do not exist.
            let [(first_u, by_u), (first_v, by_v)] =
                [u_knots.basis(Uni1 { f: u, t: 0.0 }), v_knots.basis(Uni1 { f: v, t: 0.0 })];
            let row = |i: usize| {
                let from = (first_u + i) * columns + first_v;
                by_v.iter().zip(&weights[from..]).map(|(b, w)| b.f * w).sum::<f64>()
            };
            by_u.iter().enumerate().map(|(i, b)| b.f * row(i)).sum()
        };
        Rational { weight: Some(Box::new(weight)), ..Rational::none() }
    }

    moldloft_num::surface_facts!(broken, open);
}
