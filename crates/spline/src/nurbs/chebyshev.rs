//! Chebyshev polynomials on a span: nodes, coefficients, derivatives at its ends.

use super::data::Value;
use std::f64::consts::PI;

/// The nodes and the matrix of one degree.
pub struct Chebyshev {
    /// The degree: there is one node more.
    pub degree: usize,
    /// cos(k j pi / degree), with the divisors of the discrete transform.
    matrix: Vec<f64>,
}

impl Chebyshev {
    pub fn new(degree: usize) -> Self {
        let n = degree as f64;
        let half = |k: usize| if k == 0 || k == degree { 0.5 } else { 1.0 };
        let entry = |k: usize, j: usize| {
            // The nodes ascend: x_j = -cos(j pi / n).
            let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
            let angle = ((k * j) % (2 * degree)) as f64 * PI / n;
            2.0 / n * half(k) * half(j) * sign * libm::cos(angle)
        };
        let matrix = (0..=degree).flat_map(|k| (0..=degree).map(move |j| (k, j)));
        Self { degree, matrix: matrix.map(|(k, j)| entry(k, j)).collect() }
    }

    /// The nodes in [0, 1], both ends included, ascending.
    pub fn nodes(&self) -> Vec<f64> {
        let n = self.degree;
        let at = |j: usize| {
            let s = libm::sin(j as f64 * PI / (2.0 * n as f64));
            s * s
        };
        (0..=n).map(|j| if j == n { 1.0 } else { at(j) }).collect()
    }

    /// The nodes of all spans between these ends, common ends once.
    pub fn nodes_of(&self, ends: &[f64]) -> Vec<f64> {
        let nodes = self.nodes();
        let mut all = vec![ends[0]];
        for span in ends.windows(2) {
            let inner = nodes[1..self.degree].iter().map(|x| span[0] + (span[1] - span[0]) * x);
            all.extend(inner);
            all.push(span[1]);
        }
        all
    }

    /// The coefficients of the interpolant of values at the nodes.
    pub fn coefficients(&self, values: &[Value], out: &mut [Value]) {
        let n = self.degree + 1;
        for (c, row) in out.iter_mut().zip(self.matrix.chunks_exact(n)) {
            *c = [0.0; 4];
            for (m, value) in row.iter().zip(values) {
                for (c, x) in c.iter_mut().zip(value) {
                    *c += m * x;
                }
            }
        }
    }
}

/// The derivative of order `k` of the Chebyshev polynomial of degree `n` at 1: the product of
/// (n^2 - i^2) / (2 i + 1) for i below k. At -1 it has the sign of (-1)^(n + k).
pub fn derivative_at_end(n: usize, k: usize) -> f64 {
    let n = n as f64;
    (0..k).map(|i| i as f64).map(|i| (n * n - i * i) / (2.0 * i + 1.0)).product()
}

/// The derivative of order `k` of a series at an end (-1 or 1) of [-1, 1].
pub fn series_derivative(coefficients: &[Value], k: usize, high: bool) -> Value {
    let mut sum = [0.0; 4];
    for (n, c) in coefficients.iter().enumerate() {
        let sign = if high || (n + k).is_multiple_of(2) { 1.0 } else { -1.0 };
        let factor = sign * derivative_at_end(n, k);
        for (s, x) in sum.iter_mut().zip(c) {
            *s += factor * x;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_and_end_derivatives_of_a_cubic() {
        let t = Chebyshev::new(7);
        let f = |x: f64| 2.0 + x - 3.0 * x * x + 0.5 * x * x * x;
        let nodes: Vec<f64> = t.nodes().iter().map(|x| 2.0 * x - 1.0).collect();
        let values: Vec<Value> = nodes.iter().map(|&x| [f(x), 0.0, 1.0, 1.0]).collect();
        let mut c = vec![[0.0; 4]; 8];
        t.coefficients(&values, &mut c);
        // x^2 = (T0 + T2) / 2, x^3 = (3 T1 + T3) / 4.
        for (c, e) in c.iter().zip([0.5, 1.375, -1.5, 0.125, 0.0, 0.0, 0.0, 0.0]) {
            assert!((c[0] - e).abs() < 1e-15 && c[1] == 0.0);
        }
        for (k, high, low) in [(0, 0.5, -2.5), (1, -3.5, 8.5), (2, -3.0, -9.0), (3, 3.0, 3.0)] {
            assert!((series_derivative(&c[..4], k, true)[0] - high).abs() < 1e-14);
            assert!((series_derivative(&c[..4], k, false)[0] - low).abs() < 1e-14);
        }
    }
}
