//! Jumps of the highest derivative at the knots: where a spline is less than perfectly fair.

use crate::{Space, SparseRows};
use moldloft_num::Vec3;

/// One row per simple interior knot, and the control point whose step removes the knot.
#[derive(Clone, Debug)]
pub struct KnotJumps {
    /// Row k times the control points is the jump of the derivative of order `degree`, times the
    /// local span length to that power, which makes it independent of the parameter's unit. On
    /// uniform cubics it is the fourth difference 1, -4, 6, -4, 1.
    pub rows: SparseRows,
    /// Knot of each row, by its index in the space's knots.
    pub knots: Vec<usize>,
    /// The control point that a removal of this knot moves.
    pub moved: Vec<usize>,
}

impl KnotJumps {
    /// The jumps of a space.
    ///
    /// Basis function s is a divided difference of the truncated power, so at a simple knot m its
    /// derivative of order p jumps by (-1)^(p+1) p! `(u[s+p+1] - u[s]) / prod (u[m] - u[l])` over
    /// the other knots l of its support. Exact for any knots; no derivative is sampled.
    pub fn of(space: &Space) -> Self {
        let p = space.degree() as isize;
        let factorial: f64 = (1..=p).map(|i| i as f64).product();
        let sign = if p % 2 == 0 { -1.0 } else { 1.0 };
        let mut all = Self { rows: SparseRows::new(), knots: Vec::new(), moved: Vec::new() };
        for m in space.simple_knots() {
            let um = space.knot(m);
            let h = 0.5 * (space.knot(m + 1) - space.knot(m - 1));
            let size = sign * factorial * h.powi(p as i32);
            let entries = (m - p - 1..=m).map(|s| {
                let width = space.knot(s + p + 1) - space.knot(s);
                let others = (s..=s + p + 1).filter(|&l| l != m);
                let product: f64 = others.map(|l| um - space.knot(l)).product();
                (space.column(s), size * width / product)
            });
            all.rows.push(entries);
            all.knots.push(m.rem_euclid(space.knots().len() as isize) as usize);
            // The function whose middle knot is m (for even degrees the knot left of the middle).
            all.moved.push(space.column(m - (p + 1) / 2));
        }
        all
    }

    /// The length of each jump.
    pub fn lengths(&self, points: &[Vec3<f64>]) -> Vec<f64> {
        (0..self.rows.len()).map(|k| self.rows.apply(k, points).norm()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use moldloft_spline::KnotVector;
    use moldloft_testing::Lcg;

    #[test]
    fn uniform_cubic_jumps_are_fourth_differences() {
        for space in [Space::floating(3, 9).unwrap(), Space::closed(3, 9).unwrap()] {
            let jumps = KnotJumps::of(&space);
            for k in 0..jumps.rows.len() {
                let (columns, factors) = jumps.rows.row(k);
                assert_eq!(factors, [1.0, -4.0, 6.0, -4.0, 1.0]);
                assert_eq!(columns[2] as usize, jumps.moved[k]);
            }
            assert_eq!(jumps.rows.len(), if space.is_closed() { 9 } else { 5 });
        }
    }

    /// Farin, Rein, Sapidis and Worsey (1987): the two lines through the neighbours, and their mean.
    #[test]
    fn removing_the_jump_is_the_published_formula() {
        let mut random = Lcg::new(7);
        for _ in 0..200 {
            let mut u = vec![0.0];
            for _ in 0..11 {
                u.push(u.last().unwrap() + 0.02 + (random.centred() + 0.5));
            }
            let space = Space::open(KnotVector::new(3, u.clone()).unwrap()).unwrap();
            let mut d: Vec<Vec3<f64>> = (0..8)
                .map(|_| Vec3::of(random.centred(), random.centred(), random.centred()))
                .collect();
            let jumps = KnotJumps::of(&space);
            for k in 0..jumps.rows.len() {
                // d[j] has the middle knot u[j + 2].
                let j = jumps.moved[k];
                let at = |i: isize| u[(j as isize + 2 + i) as usize];
                let l =
                    (d[j - 1] * (at(1) - at(-3)) - d[j - 2] * (at(1) - at(0))) / (at(0) - at(-3));
                let r =
                    (d[j + 1] * (at(3) - at(-1)) - d[j + 2] * (at(0) - at(-1))) / (at(3) - at(0));
                let wanted = (l * (at(2) - at(0)) + r * (at(0) - at(-2))) / (at(2) - at(-2));
                let (columns, factors) = jumps.rows.row(k);
                let own = columns.iter().position(|&c| c as usize == j).unwrap();
                let before = jumps.rows.apply(k, &d);
                let step = before / factors[own];
                assert!((d[j] - step - wanted).norm() < 1e-11 * (1.0 + wanted.norm()));
                let old = std::mem::replace(&mut d[j], wanted);
                let scale: f64 = factors.iter().map(|f| f.abs()).sum();
                assert!(jumps.rows.apply(k, &d).norm() < 1e-12 * scale * 10.0);
                d[j] = old;
            }
        }
    }

    /// The formula against the two one-sided derivatives, for all degrees and with multiple knots.
    #[test]
    fn jumps_are_differences_of_one_sided_derivatives() {
        let mut random = Lcg::new(3);
        for degree in 1..=6 {
            let mut knots = vec![0.0; degree + 1];
            for k in 1..7 {
                let t = f64::from(k) + 0.6 * random.centred();
                knots.extend(std::iter::repeat_n(t, if k == 4 && degree > 1 { 2 } else { 1 }));
            }
            knots.extend(vec![7.0; degree + 1]);
            let space = Space::open(KnotVector::new(degree, knots).unwrap()).unwrap();
            let jumps = KnotJumps::of(&space);
            assert_eq!(jumps.rows.len(), if degree > 1 { 5 } else { 6 });
            for (k, &m) in jumps.knots.iter().enumerate() {
                let (m, t) = (m as isize, space.knots()[m]);
                let h = 0.5 * (space.knot(m + 1) - space.knot(m - 1));
                let mut wanted = vec![0.0; space.count()];
                for (side, sign) in [(m, 1.0), (m - 1, -1.0)] {
                    let values = space.derivative(side, t, degree);
                    for (c, x) in space.columns(side).zip(values) {
                        wanted[c] += sign * x * h.powi(degree as i32);
                    }
                }
                let (columns, factors) = jumps.rows.row(k);
                let scale = factors.iter().fold(1.0f64, |m, f| m.max(f.abs()));
                for (&c, &f) in columns.iter().zip(factors) {
                    assert!((wanted[c as usize] - f).abs() < 1e-10 * scale, "{degree} {k}");
                    wanted[c as usize] = 0.0;
                }
                assert!(wanted.iter().all(|w| w.abs() < 1e-10 * scale));
            }
        }
    }
}
