//! Chains of polynomials through samples, for functions that can be evaluated only at some
//! parameters.

use moldloft_num::{CurveFormula, Jet, Real, Vec3};
use std::f64::consts::PI;

const DEGREE: usize = 16;

/// Number of samples of one polynomial.
pub const NODES: usize = DEGREE + 1;

/// Maximum number of halvings of a piece, and of pieces: beyond, a kink remains.
pub const DEEPEST: u32 = 16;
pub const MOST_PIECES: usize = 256;

/// cos(pi k / DEGREE), exact at the ends.
fn cosine(k: usize) -> f64 {
    match k {
        0 => 1.0,
        DEGREE => -1.0,
        _ => Real::cos(PI * k as f64 / DEGREE as f64),
    }
}

/// The parameters of the samples between `a` and `b`, both included, ascending.
pub fn nodes<T: Real>(a: T, b: T) -> impl Iterator<Item = T> {
    (0..NODES).map(move |k| (a + b) * 0.5 - (b - a) * 0.5 * cosine(k))
}

/// A polynomial on a stretch of the parameter, by its Chebyshev coefficients.
pub struct ChebyshevPiece<T> {
    /// Start, which may move with the variables of the model.
    pub from: T,
    /// End.
    pub to: T,
    coefficients: Vec<Vec3<T>>,
}

impl<T: Real> ChebyshevPiece<T> {
    /// The polynomial through `samples` at the nodes between `from` and `to` (Trefethen 2013, ch. 3).
    pub fn through(from: T, to: T, samples: &[Vec3<T>]) -> Self {
        let n = DEGREE;
        let coefficient = |j: usize| {
            let mut sum = Vec3::zero();
            for (k, &p) in samples.iter().enumerate() {
                // T_j at -cosine(k) is cos(j pi (1 - k / n)), an integer multiple of pi / n.
                let m = j * (n - k) % (2 * n);
                let value = if m <= n { cosine(m) } else { cosine(2 * n - m) };
                let share = if k == 0 || k == n { 0.5 } else { 1.0 };
                sum += p * T::from(value * share);
            }
            let share = if j == 0 || j == n { 1.0 } else { 2.0 };
            sum * T::from(share / n as f64)
        };
        Self { from, to, coefficients: (0..=n).map(coefficient).collect() }
    }

    /// Magnitude of the last coefficients.
    pub fn rest(&self) -> f64 {
        self.coefficients[DEGREE - 2..].iter().map(|c| c.re().norm()).fold(0.0, f64::max)
    }
}

/// The piece in charge at `t` among pieces that begin at these parameters.
pub fn in_charge<P>(pieces: &[P], from: impl Fn(&P) -> f64, t: f64) -> usize {
    pieces[1..].partition_point(|piece| from(piece) <= t)
}

/// The curve of such pieces.
pub struct PiecewiseChebyshev<T> {
    /// The pieces, in order.
    pub pieces: Vec<ChebyshevPiece<T>>,
}

impl<T: Real> CurveFormula for PiecewiseChebyshev<T> {
    type Scalar = T;

    /// Clenshaw's recurrence.
    fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        let k = in_charge(&self.pieces, |piece| piece.from.re(), t.re());
        let ChebyshevPiece { from, to, coefficients } = &self.pieces[k];
        let [from, to] = [*from, *to].map(J::fixed);
        let x = ((t - from) * 2.0 / (to - from)) - 1.0;
        let (mut b, mut c) = (Vec3::<J>::zero(), Vec3::<J>::zero());
        for coefficient in coefficients[1..].iter().rev() {
            let next = coefficient.map(J::fixed) + b * (x * 2.0) - c;
            c = b;
            b = next;
        }
        coefficients[0].map(J::fixed) + b * x - c
    }

    fn breaks(&self) -> Vec<f64> {
        self.pieces[1..].iter().map(|piece| piece.from.re()).collect()
    }

    moldloft_num::curve_facts!(broken, open, not_rational);
}
