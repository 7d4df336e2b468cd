//! Measures of unfairness as sparse rows over control points.

use crate::curve::jumps::KnotJumps;
use crate::{FairError, Space, SparseRows};
use moldloft_num::Vec3;

/// A measure of unfairness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Sum of squared second differences, sum `|d[i-1] - 2 d[i] + d[i+1]|^2` on uniform knots: for
    /// cubics the squared second derivatives at the knots. Removing a knot is its exact
    /// one-vertex minimiser.
    Second,
    /// Sum of squared third differences.
    Third,
    /// Sum of squared jumps of the highest derivative.
    Jumps,
    /// Sum of the lengths of the jumps: most become exactly zero, so that few polynomial pieces
    /// remain.
    JumpLengths,
    /// The integral of the squared second derivative.
    Bending,
    /// The integral of the squared third derivative.
    Variation,
}

/// Norm of the rows of a measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowNorm {
    /// Sum of squares.
    Square,
    /// Sum of lengths.
    Length,
}

impl Measure {
    /// All measures.
    pub const ALL: [Measure; 6] = [
        Measure::Second,
        Measure::Third,
        Measure::Jumps,
        Measure::JumpLengths,
        Measure::Bending,
        Measure::Variation,
    ];

    /// The name in the language and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Measure::Second => "second",
            Measure::Third => "third",
            Measure::Jumps => "jumps",
            Measure::JumpLengths => "jump-lengths",
            Measure::Bending => "bending",
            Measure::Variation => "variation",
        }
    }

    /// The measure called `name`.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|m| m.name() == name)
    }

    /// Norm of its rows.
    pub fn norm(self) -> RowNorm {
        if self == Measure::JumpLengths { RowNorm::Length } else { RowNorm::Square }
    }

    /// The rows of the measure on a space, independent of the parameter's unit: a row times the
    /// control points is a length.
    ///
    /// # Errors
    /// [`FairError::Degree`] when the spline has no derivative of that order.
    pub fn rows(self, space: &Space) -> Result<SparseRows, FairError> {
        let actual = space.degree();
        let need = |expected| {
            if actual < expected { Err(FairError::Degree { expected, actual }) } else { Ok(()) }
        };
        match self {
            Measure::Jumps | Measure::JumpLengths => Ok(KnotJumps::of(space).rows),
            // A polyline's second derivative is the jump of its first.
            Measure::Second if actual == 1 => Ok(KnotJumps::of(space).rows),
            Measure::Second => Ok(differences(space, 2)),
            Measure::Third => need(3).map(|()| differences(space, 3)),
            Measure::Bending => need(2).map(|()| integrated(space, 2)),
            Measure::Variation => need(3).map(|()| integrated(space, 3)),
        }
    }
}

/// The value of a measure given by its rows.
pub fn value(rows: &SparseRows, norm: RowNorm, points: &[Vec3<f64>]) -> f64 {
    match norm {
        RowNorm::Square => rows.sum_sq(points),
        RowNorm::Length => rows.sum_abs(points),
    }
}

/// The control points of the derivative of order `order`, each weighted with the root of its basis
/// function's integral, in units of the mean span: plain differences on uniform knots.
fn differences(space: &Space, order: usize) -> SparseRows {
    let p = space.degree() as isize;
    let n = space.count() as isize;
    let mean = space.mean_span();
    let mut rows = SparseRows::new();
    let first = if space.is_closed() { 0 } else { order as isize };
    'rows: for s in first..n {
        // Factors of the control points s - order ..= s.
        let mut c = vec![0.0; order + 1];
        c[order] = 1.0;
        // The functional is built from the outermost difference inwards: derivative control point
        // s of order q is (p - q + 1) (c[s] - c[s-1]) / (u[s+p-q+1] - u[s]) of order q - 1.
        for q in (1..=order as isize).rev() {
            let mut next = vec![0.0; order + 1];
            for i in 0..=order {
                if c[i] == 0.0 {
                    continue;
                }
                let at = s - order as isize + i as isize;
                let width = space.knot(at + p - q + 1) - space.knot(at);
                if width <= 0.0 {
                    continue 'rows;
                }
                let factor = (p - q + 1) as f64 * mean / width;
                next[i] += c[i] * factor;
                next[i - 1] -= c[i] * factor;
            }
            c = next;
        }
        let left = p - order as isize;
        let integral = (space.knot(s + left + 1) - space.knot(s)) / (left + 1) as f64;
        let scale = (integral / mean).sqrt();
        let entries = c.iter().enumerate();
        rows.push(
            entries.map(|(i, &x)| (space.column(s - order as isize + i as isize), x * scale)),
        );
    }
    rows
}

/// SparseRows whose squares add up to the integral of the squared derivative, by Gauss quadrature of
/// sufficient order, in units of the mean span.
fn integrated(space: &Space, order: usize) -> SparseRows {
    let p = space.degree();
    let mean = space.mean_span();
    let unit = unit_of(mean, order);
    let rule = gauss((p - order + 1).max(1));
    let mut rows = SparseRows::new();
    for k in space.spans() {
        let (a, b) = (space.knot(k), space.knot(k + 1));
        for &(x, w) in &rule {
            let t = a + (b - a) * 0.5 * (1.0 + x);
            let scale = (0.5 * (b - a) * w * unit).sqrt();
            let values = space.derivative(k, t, order);
            rows.push(space.columns(k).zip(values.into_iter().map(|v| v * scale)));
        }
    }
    rows
}

/// Factor that makes an integral of squared derivatives independent of the parameter's unit.
pub(crate) fn unit_of(mean: f64, order: usize) -> f64 {
    mean.powi(2 * order as i32 - 1)
}

impl Measure {
    /// The order of the differences that the measure is of.
    pub(crate) fn order(self, degree: usize) -> usize {
        match self {
            Measure::Second | Measure::Bending => 2,
            Measure::Third | Measure::Variation => 3,
            Measure::Jumps | Measure::JumpLengths => degree + 1,
        }
    }

    /// The order of the derivatives of a measure that is zero for polynomials below that degree alone.
    pub(crate) fn derivative_order(self) -> Option<usize> {
        match self {
            Measure::Bending => Some(2),
            Measure::Variation => Some(3),
            _ => None,
        }
    }

    /// The measure of the points themselves, at parameters with a total range of 1 (closed curve:
    /// from the first point round to itself): divided differences, each weighted with the square
    /// root of its interval, so that the sum of squares approximates the integral of the squared
    /// derivative. Zero for polynomials of degree below the order, at any spacing.
    pub fn divided<T: moldloft_num::Real>(
        self,
        at: &[T],
        closed: bool,
        degree: usize,
    ) -> Vec<Vec<(usize, T)>> {
        let (n, order) = (at.len(), self.order(degree));
        let count = if closed { n } else { n.saturating_sub(order) };
        let place = |k: usize| at[k % n] + T::from((k / n) as f64);
        let factorial: f64 = (1..=order).map(|i| i as f64).product();
        let row = |first: usize| {
            let span = place(first + order) - place(first);
            let weight = (span / order as f64).sqrt() * factorial;
            let entry = |k: usize| {
                let others = (0..=order).filter(|&l| l != k);
                let product =
                    others.fold(T::one(), |s, l| s * (place(first + k) - place(first + l)));
                ((first + k) % n, weight / product)
            };
            (0..=order).map(entry).collect()
        };
        (0..count).map(row).collect()
    }
}

/// Nodes and weights of the Gauss-Legendre rule with `n` points on [-1, 1], exact to degree
/// 2n - 1: Newton's method from Tricomi's starting values (Press et al. 2007, section 4.6).
pub(crate) fn gauss(n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|i| {
            let start = std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5);
            let mut x = -moldloft_num::Real::cos(start);
            let mut slope = 1.0;
            for _ in 0..8 {
                let (mut before, mut value) = (1.0, x);
                for k in 2..=n {
                    let k = k as f64;
                    let next = ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k;
                    (before, value) = (value, next);
                }
                slope = n as f64 * (x * value - before) / (x * x - 1.0);
                x -= value / slope;
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use moldloft_spline::KnotVector;

    #[test]
    fn gauss_rules_are_exact() {
        for n in 1..=20 {
            for power in 0..2 * n {
                let sum: f64 = gauss(n).iter().map(|(x, w)| w * x.powi(power as i32)).sum();
                let wanted = if power % 2 == 0 { 2.0 / (power as f64 + 1.0) } else { 0.0 };
                assert!((sum - wanted).abs() < 1e-13, "{n} {power} {sum}");
            }
        }
    }

    #[test]
    fn uniform_differences_are_plain() {
        let space = Space::floating(3, 9).unwrap();
        let rows = Measure::Second.rows(&space).unwrap();
        assert_eq!(rows.len(), 7);
        for k in 0..7 {
            assert_eq!(rows.row(k).1, [1.0, -2.0, 1.0]);
        }
        let rows = Measure::Third.rows(&Space::closed(5, 13).unwrap()).unwrap();
        assert_eq!((rows.len(), rows.row(4).1), (13, &[-1.0, 3.0, -3.0, 1.0][..]));
    }

    /// x(t) = t^3 on [0, 2]: the integrals of (6t)^2 and 6^2 are 96 and 72, on any knots.
    #[test]
    fn integrals_of_a_cubic() {
        let knots = vec![0.0, 0.0, 0.0, 0.0, 0.3, 0.9, 0.9, 1.4, 2.0, 2.0, 2.0, 2.0];
        let space = Space::open(KnotVector::new(3, knots.clone()).unwrap()).unwrap();
        // The polar form of t^3 is the product of its arguments.
        let points: Vec<_> = (0..8)
            .map(|i| Vec3::of(knots[i + 1] * knots[i + 2] * knots[i + 3], 0.0, 0.0))
            .collect();
        let mean = space.mean_span();
        for (measure, wanted, unit) in
            [(Measure::Bending, 96.0, mean.powi(3)), (Measure::Variation, 72.0, mean.powi(5))]
        {
            let got = measure.rows(&space).unwrap().sum_sq(&points);
            assert!((got / unit - wanted).abs() < 1e-11 * wanted, "{measure:?} {got}");
        }
        for measure in [Measure::Jumps, Measure::JumpLengths] {
            assert!(measure.rows(&space).unwrap().sum_abs(&points) < 1e-13);
        }
    }

    #[test]
    fn measures_vanish_on_what_they_call_fair() {
        let knots = [0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.4, 0.5, 0.8, 1.0, 1.0, 1.0, 1.0, 1.0];
        let space = Space::open(KnotVector::new(4, knots.to_vec()).unwrap()).unwrap();
        // Greville abscissae: the control points of a straight line.
        let line: Vec<_> =
            (0..9).map(|i| Vec3::of(knots[i + 1..i + 5].iter().sum(), 1.0, 0.0)).collect();
        for measure in Measure::ALL {
            let rows = measure.rows(&space).unwrap();
            let size = value(&rows, RowNorm::Length, &line);
            assert!(size < 1e-10 * rows.len() as f64, "{measure:?} {size}");
            assert_eq!(Measure::named(measure.name()), Some(measure));
        }
        let low = Space::clamped(2, 6).unwrap();
        let refused = Measure::Third.rows(&low);
        assert_eq!(refused, Err(FairError::Degree { expected: 3, actual: 2 }));
    }
}
