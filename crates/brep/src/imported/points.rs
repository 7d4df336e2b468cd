//! Points of NURBS, one at a time.

use moldloft_num::{Order, Vec3};
use moldloft_spline::KnotVector;
use moldloft_spline::nurbs::Nurbs;

/// A NURBS for many evaluations, one at a time.
#[derive(Clone, Debug)]
pub struct NurbsPoints<const D: usize> {
    knots: [KnotVector; D],
    counts: [usize; D],
    /// Positions times weights, and weights.
    values: Vec<[f64; 4]>,
}

impl<const D: usize> NurbsPoints<D> {
    /// The points of a NURBS.
    ///
    /// # Panics
    /// When its knots are not clamped and ascending.
    pub fn new(nurbs: &Nurbs<D>) -> Self {
        let knots = std::array::from_fn(|d| {
            let knots = KnotVector::new(nurbs.degrees[d], nurbs.knots[d].clone());
            knots.expect("clamped ascending knots")
        });
        let weight = |k: usize| nurbs.weights.as_ref().map_or(1.0, |w| w[k]);
        let homogeneous = |(k, p): (usize, &Vec3)| {
            let w = weight(k);
            [p.x * w, p.y * w, p.z * w, w]
        };
        let values = nurbs.points.iter().enumerate().map(homogeneous).collect();
        Self { knots, counts: nurbs.counts(), values }
    }

    /// The position of a homogeneous point.
    fn projected([x, y, z, w]: [f64; 4]) -> Vec3 {
        if w == 1.0 { Vec3::of(x, y, z) } else { Vec3::of(x / w, y / w, z / w) }
    }
}

fn add(sum: &mut [f64; 4], by: f64, value: &[f64; 4]) {
    for (s, x) in sum.iter_mut().zip(value) {
        *s += by * x;
    }
}

/// The derivative of a position from those of its homogeneous coordinates.
fn slope(p: Vec3, w: f64, d: [f64; 4]) -> Vec3 {
    (Vec3::of(d[0], d[1], d[2]) - p * d[3]) / w
}

impl NurbsPoints<1> {
    /// The point at a parameter.
    pub fn at(&self, [t]: [f64; 1]) -> Vec3 {
        let basis = self.knots[0].basis(t, Order::Zero);
        let mut sum = [0.0; 4];
        for (b, value) in basis.rows[0].iter().zip(&self.values[basis.first..]) {
            add(&mut sum, *b, value);
        }
        Self::projected(sum)
    }

    /// The point at a parameter, and its derivative.
    pub(super) fn jet(&self, t: f64) -> [Vec3; 2] {
        let basis = self.knots[0].basis(t, Order::First);
        let (mut sum, mut rate) = ([0.0; 4], [0.0; 4]);
        for (i, value) in (0..basis.rows[0].len()).zip(&self.values[basis.first..]) {
            add(&mut sum, basis.rows[0][i], value);
            add(&mut rate, basis.rows[1][i], value);
        }
        let p = Self::projected(sum);
        [p, slope(p, sum[3], rate)]
    }
}

impl NurbsPoints<2> {
    /// The point at parameters.
    pub fn at(&self, [u, v]: [f64; 2]) -> Vec3 {
        let [along, across] = [(0, u), (1, v)].map(|(d, t)| self.knots[d].basis(t, Order::Zero));
        let mut sum = [0.0; 4];
        for (i, b) in along.rows[0].iter().enumerate() {
            let first = (along.first + i) * self.counts[1] + across.first;
            for (c, value) in across.rows[0].iter().zip(&self.values[first..]) {
                add(&mut sum, b * c, value);
            }
        }
        Self::projected(sum)
    }

    /// The point at parameters, and its derivatives by both.
    pub(super) fn jet(&self, [u, v]: [f64; 2]) -> [Vec3; 3] {
        let [along, across] = [(0, u), (1, v)].map(|(d, t)| self.knots[d].basis(t, Order::First));
        let (mut sum, mut by_u, mut by_v) = ([0.0; 4], [0.0; 4], [0.0; 4]);
        for i in 0..along.rows[0].len() {
            let first = (along.first + i) * self.counts[1] + across.first;
            let (b, db) = (along.rows[0][i], along.rows[1][i]);
            for (j, value) in (0..across.rows[0].len()).zip(&self.values[first..]) {
                let (c, dc) = (across.rows[0][j], across.rows[1][j]);
                add(&mut sum, b * c, value);
                add(&mut by_u, db * c, value);
                add(&mut by_v, b * dc, value);
            }
        }
        let p = Self::projected(sum);
        [p, slope(p, sum[3], by_u), slope(p, sum[3], by_v)]
    }
}
