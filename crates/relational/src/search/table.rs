//! Unknowns along a curve as polynomials, where these agree with the solutions to rounding: a table
//! to read instead of solving.

use moldloft_num::Real;

/// Number of interpolation points of a polynomial.
const NODES: usize = 10;

/// Stretches are halved this many times at most.
const MOST_HALVINGS: u32 = 5;

/// Positions in a piece, from -1 to 1, at which polynomials are compared with solutions.
const CHECKS: [f64; 4] = [-1.0, -0.3, 0.62, 1.0];

/// N unknowns along a parameter from 0 to 1.
pub struct Table<const N: usize> {
    spans: Vec<TableSpan<N>>,
}

struct TableSpan<const N: usize> {
    from: f64,
    until: f64,
    /// By Chebyshev's polynomials of y from -1 to 1; `None` where the unknowns are no polynomial.
    terms: Option<[[f64; N]; NODES]>,
}

fn angle(k: usize) -> f64 {
    (k as f64 + 0.5) * std::f64::consts::PI / NODES as f64
}

fn node(k: usize) -> f64 {
    Real::cos(angle(k))
}

/// The sum of the terms at y (Clenshaw 1955), exact to rounding where powers are not.
fn sum<const N: usize>(terms: &[[f64; N]; NODES], y: f64) -> [f64; N] {
    let (mut b, mut c) = ([0.0; N], [0.0; N]);
    for term in terms[1..].iter().rev() {
        (b, c) = (std::array::from_fn(|n| 2.0 * y * b[n] - c[n] + term[n]), b);
    }
    std::array::from_fn(|n| y * b[n] - c[n] + terms[0][n])
}

impl<const N: usize> Table<N> {
    /// The stretches, each with whether it is left to the search.
    pub fn stretches(&self) -> impl Iterator<Item = (f64, f64, bool)> {
        self.spans.iter().map(|span| (span.from, span.until, span.terms.is_none()))
    }

    /// The table of `solved` between the ascending `ends`, 0 and 1 included. `same` compares two
    /// values.
    pub fn new(
        ends: &[f64],
        solved: impl Fn(f64) -> Option<[f64; N]>,
        same: impl Fn(&[f64; N], &[f64; N]) -> bool,
    ) -> Self {
        // From values at the nodes to coefficients.
        let matrix: [[f64; NODES]; NODES] = std::array::from_fn(|j| {
            let share = if j == 0 { 1.0 } else { 2.0 } / NODES as f64;
            std::array::from_fn(|k| share * Real::cos(j as f64 * angle(k)))
        });
        let mut spans = Vec::new();
        for pair in ends.windows(2) {
            let mut open = vec![(pair[0], pair[1], 0)];
            while let Some((from, until, halvings)) = open.pop() {
                let at = |y: f64| solved(0.5 * (from + until) + 0.5 * (until - from) * y);
                let fitted = || {
                    let mut values = [[0.0; N]; NODES];
                    for (k, value) in values.iter_mut().enumerate() {
                        *value = at(node(k))?;
                    }
                    let terms: [[f64; N]; NODES] = std::array::from_fn(|j| {
                        std::array::from_fn(|n| {
                            (0..NODES).map(|k| values[k][n] * matrix[j][k]).sum()
                        })
                    });
                    for y in CHECKS {
                        if !same(&at(y)?, &sum(&terms, y)) {
                            return None;
                        }
                    }
                    Some(terms)
                };
                let terms = fitted();
                if terms.is_some() || halvings >= MOST_HALVINGS {
                    spans.push(TableSpan { from, until, terms });
                } else {
                    let middle = 0.5 * (from + until);
                    open.push((middle, until, halvings + 1));
                    open.push((from, middle, halvings + 1));
                }
            }
        }
        Self { spans }
    }

    /// The unknowns at `t`; `None` where they must be solved for, as outside of 0 .. 1.
    pub fn at(&self, t: f64) -> Option<[f64; N]> {
        if !(0.0..=1.0).contains(&t) {
            return None;
        }
        let k = self.spans.partition_point(|span| span.until < t);
        let span = self.spans.get(k)?;
        let y = (2.0 * t - span.from - span.until) / (span.until - span.from);
        Some(sum(span.terms.as_ref()?, y))
    }
}
