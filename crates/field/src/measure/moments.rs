//! Integrals of monomials over a body, as best values and as proved ranges.

use crate::expr::interval::Interval;
use moldloft_num::{Real, Vec3};

/// Integrals over a body of 1; x, y, z; xx, yy, zz; xy, yz, zx.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments<N>(pub [N; 10]);

/// The exponents of the monomials.
pub(crate) const POWERS: [[u32; 3]; 10] = [
    [0, 0, 0],
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [2, 0, 0],
    [0, 2, 0],
    [0, 0, 2],
    [1, 1, 0],
    [0, 1, 1],
    [1, 0, 1],
];

impl<N: Copy> Moments<N> {
    /// Volume.
    pub fn volume(&self) -> N {
        self.0[0]
    }
}

impl<T: Real> Moments<T> {
    /// The centre of mass.
    pub fn centroid(&self) -> Vec3<T> {
        let m = &self.0;
        Vec3::new(m[1], m[2], m[3]) / m[0]
    }

    /// The rows of the matrix of inertia about the centroid, for unit density.
    pub fn inertia(&self) -> [Vec3<T>; 3] {
        let (m, c) = (&self.0, self.centroid());
        let central = |k: usize, i: usize, j: usize| m[k] - m[0] * c[i] * c[j];
        let (xx, yy, zz) = (central(4, 0, 0), central(5, 1, 1), central(6, 2, 2));
        let (xy, yz, zx) = (central(7, 0, 1), central(8, 1, 2), central(9, 2, 0));
        [Vec3::new(yy + zz, -xy, -zx), Vec3::new(-xy, zz + xx, -yz), Vec3::new(-zx, -yz, xx + yy)]
    }
}

impl Moments<Interval> {
    pub(super) const ZERO: Self = Self([Interval::ZERO; 10]);

    /// Adds those of another part.
    pub(super) fn add(&mut self, o: &Self) {
        for (a, b) in self.0.iter_mut().zip(&o.0) {
            *a = *a + *b;
        }
    }

    /// A bracket of each coordinate of the centroid; everything when the volume may be zero.
    pub fn centroid(&self) -> [Interval; 3] {
        let one = self.0[0].reciprocal();
        [1, 2, 3].map(|k| self.0[k] * one)
    }

    /// Brackets of the matrix of inertia about the centroid, for unit density; everything when the volume
    /// may be zero. Each moment stands in several terms, so they are wider than those of the moments.
    pub fn inertia(&self) -> [[Interval; 3]; 3] {
        let m = &self.0;
        let one = m[0].reciprocal();
        let central = |k: usize, i: usize, j: usize| m[k] - m[1 + i] * m[1 + j] * one;
        let square = |k: usize, i: usize| m[k] - m[1 + i].square() * one;
        let (xx, yy, zz) = (square(4, 0), square(5, 1), square(6, 2));
        let (xy, yz, zx) = (central(7, 0, 1), central(8, 1, 2), central(9, 2, 0));
        [[yy + zz, -xy, -zx], [-xy, zz + xx, -yz], [-zx, -yz, xx + yy]]
    }

    /// True when all of `m` lies inside.
    pub fn contains(&self, m: &Moments<f64>) -> bool {
        self.0.iter().zip(&m.0).all(|(range, x)| range.contains(*x))
    }

    /// Adds what a box contributes of which at least `part.low` and at most `part.high` is solid.
    pub(super) fn take(&mut self, b: &[Interval; 3], part: Interval, whole: bool) {
        for (sum, powers) in self.0.iter_mut().zip(POWERS) {
            let term = if whole {
                (0..3).fold(Interval::point(1.0), |product, k| product * integral(b[k], powers[k]))
            } else {
                (0..3).fold(part, |product, k| product * b[k].powi(powers[k]))
            };
            *sum = *sum + term;
        }
    }
}

/// The integral of x^n over a side, rounded outward.
pub(super) fn integral(side: Interval, n: u32) -> Interval {
    let (a, b) = (Interval::point(side.low), Interval::point(side.high));
    let width = b - a;
    match n {
        0 => width,
        1 => width * (a + b).scaled(0.5),
        _ => width * (a.square() + a * b + b.square()).divided(3.0),
    }
}
