//! Integrals of monomials over a body, as best values and as proved ranges.

use crate::expr::interval::Interval;
use moldloft_num::{Real, Vec3};

/// Integrals over a body about a point near it; about the origin they would be differences of large
/// numbers for a distant body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments<N> {
    /// The reference point, a constant.
    pub about: Vec3,
    /// Integrals of 1; x, y, z; xx, yy, zz; xy, yz, zx.
    pub terms: [N; 10],
}

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
        self.terms[0]
    }
}

impl<T: Real> Moments<T> {
    /// The centre of mass.
    pub fn centroid(&self) -> Vec3<T> {
        let m = &self.terms;
        Vec3::new(m[1], m[2], m[3]) / m[0] + Vec3::lifted(self.about)
    }

    /// The rows of the matrix of inertia about the centroid, for unit density.
    pub fn inertia(&self) -> [Vec3<T>; 3] {
        let m = &self.terms;
        let c = Vec3::new(m[1], m[2], m[3]) / m[0];
        let central = |k: usize, i: usize, j: usize| m[k] - m[0] * c[i] * c[j];
        let (xx, yy, zz) = (central(4, 0, 0), central(5, 1, 1), central(6, 2, 2));
        let (xy, yz, zx) = (central(7, 0, 1), central(8, 1, 2), central(9, 2, 0));
        [Vec3::new(yy + zz, -xy, -zx), Vec3::new(-xy, zz + xx, -yz), Vec3::new(-zx, -yz, xx + yy)]
    }
}

impl Moments<f64> {
    /// These, limited to a bracket.
    pub(crate) fn clamped(&self, bracket: &Moments<Interval>) -> Self {
        let mut out = *self;
        for (x, range) in out.terms.iter_mut().zip(&bracket.terms) {
            *x = x.clamp(range.low, range.high);
        }
        out
    }
}

impl Moments<Interval> {
    /// Moments of the empty set.
    pub(super) fn zero(about: Vec3) -> Self {
        Self { about, terms: [Interval::ZERO; 10] }
    }

    /// Adds those of another part, about the same point.
    pub(super) fn add(&mut self, part: &[Interval; 10]) {
        for (a, b) in self.terms.iter_mut().zip(part) {
            *a = *a + *b;
        }
    }

    /// The same about another point.
    fn moved(&self, about: Vec3) -> Self {
        let m = &self.terms;
        let d = [0, 1, 2].map(|k| Interval::point(self.about[k]) - Interval::point(about[k]));
        let mut terms = *m;
        for i in 0..3 {
            terms[1 + i] = m[1 + i] + m[0] * d[i];
        }
        for (k, [i, j]) in super::polytope::SECOND.into_iter().enumerate() {
            let square = if i == j { d[i].square() } else { d[i] * d[j] };
            terms[4 + k] = m[4 + k] + m[1 + i] * d[j] + m[1 + j] * d[i] + m[0] * square;
        }
        Self { about, terms }
    }

    /// About the middle of the centroid's bracket: there the products of first moments are of second order.
    fn central(&self) -> Self {
        let one = self.terms[0].reciprocal();
        let middle = [1, 2, 3].map(|k| (self.terms[k] * one).middle());
        if middle.iter().all(|x| x.is_finite()) {
            self.moved(self.about + Vec3::from(middle))
        } else {
            *self
        }
    }

    /// A bracket of each coordinate of the centroid; unbounded when the volume may be zero.
    pub fn centroid(&self) -> [Interval; 3] {
        let one = self.terms[0].reciprocal();
        [0, 1, 2].map(|k| self.terms[1 + k] * one + Interval::point(self.about[k]))
    }

    /// Brackets of the matrix of inertia about the centroid, for unit density; unbounded when the
    /// volume may be zero.
    pub fn inertia(&self) -> [[Interval; 3]; 3] {
        let m = &self.central().terms;
        let one = m[0].reciprocal();
        let central = |k: usize, i: usize, j: usize| m[k] - m[1 + i] * m[1 + j] * one;
        let square = |k: usize, i: usize| m[k] - m[1 + i].square() * one;
        let (xx, yy, zz) = (square(4, 0), square(5, 1), square(6, 2));
        let (xy, yz, zx) = (central(7, 0, 1), central(8, 1, 2), central(9, 2, 0));
        [[yy + zz, -xy, -zx], [-xy, zz + xx, -yz], [-zx, -yz, xx + yy]]
    }

    /// True if all integrals of `m`, about the same point, are inside.
    pub fn contains(&self, m: &Moments<f64>) -> bool {
        self.terms.iter().zip(&m.terms).all(|(range, x)| range.contains(*x))
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
