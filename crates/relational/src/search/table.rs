//! Unknowns along a curve as polynomials, where these are the solutions to rounding: a table that
//! places are read from instead of being solved for.

use moldloft_num::{Real, solve_dense};

/// Points that a polynomial goes through.
const NODES: usize = 10;

/// Stretches are halved this many times at most.
const MOST_HALVINGS: u32 = 5;

/// Where polynomials are compared with solutions, in a stretch from -1 to 1.
const CHECKS: [f64; 4] = [-1.0, -0.3, 0.62, 1.0];

/// N unknowns along a parameter from 0 to 1.
pub(super) struct Table<const N: usize> {
    spans: Vec<Span<N>>,
}

struct Span<const N: usize> {
    from: f64,
    until: f64,
    /// In powers of y from -1 to 1; `None` where the unknowns are no polynomial.
    powers: Option<[[f64; N]; NODES]>,
}

fn node(k: usize) -> f64 {
    -Real::cos((k as f64 + 0.5) * std::f64::consts::PI / NODES as f64)
}

fn horner<const N: usize>(powers: &[[f64; N]; NODES], y: f64) -> [f64; N] {
    let mut q = powers[NODES - 1];
    for p in powers[..NODES - 1].iter().rev() {
        q = std::array::from_fn(|k| q[k] * y + p[k]);
    }
    q
}

impl<const N: usize> Table<N> {
    /// The table of `solved` between the ascending `ends`, 0 and 1 included. `same` says whether two
    /// values are one place.
    pub fn new(
        ends: &[f64],
        solved: impl Fn(f64) -> Option<[f64; N]>,
        same: impl Fn(&[f64; N], &[f64; N]) -> bool,
    ) -> Self {
        let matrix: [[f64; NODES]; NODES] = std::array::from_fn(|column| {
            let mut all: Vec<f64> =
                (0..NODES).flat_map(|k| (0..NODES).map(move |p| node(k).powi(p as i32))).collect();
            let mut unit: [f64; NODES] = std::array::from_fn(|k| f64::from(u8::from(k == column)));
            solve_dense(&mut all, &mut unit).expect("the nodes are different");
            unit
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
                    // From a value in the middle, so that rounding is a share of what changes.
                    let base = values[NODES / 2];
                    let mut powers: [[f64; N]; NODES] = std::array::from_fn(|p| {
                        std::array::from_fn(|n| {
                            (0..NODES).map(|k| (values[k][n] - base[n]) * matrix[k][p]).sum()
                        })
                    });
                    for (p, b) in powers[0].iter_mut().zip(base) {
                        *p += b;
                    }
                    for y in CHECKS {
                        if !same(&at(y)?, &horner(&powers, y)) {
                            return None;
                        }
                    }
                    Some(powers)
                };
                let powers = fitted();
                if powers.is_some() || halvings >= MOST_HALVINGS {
                    spans.push(Span { from, until, powers });
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
        Some(horner(span.powers.as_ref()?, y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A smooth way near the edge of a surface is read to rounding everywhere; one with a corner is
    /// solved for around that only.
    #[test]
    fn smooth_ways_need_no_search() {
        let way = |t: f64| [0.97 + 0.02 * (3.0 * t).sin(), 0.4 + 0.3 * (2.0 * t).cos(), 7.0 * t];
        let same = |a: &[f64; 3], b: &[f64; 3]| (0..3).all(|k| (a[k] - b[k]).abs() <= 1e-14);
        let table = Table::new(&[0.0, 1.0], |t| Some(way(t)), same);
        assert!(table.spans.len() <= 8);
        for k in 0..=1000 {
            let t = f64::from(k) / 1000.0;
            let (found, exact) = (table.at(t).unwrap(), way(t));
            assert!(
                (0..3).all(|k| (found[k] - exact[k]).abs() <= 2e-14),
                "{t} {found:?} {exact:?}"
            );
        }
        assert!(table.at(-0.1).is_none() && table.at(1.1).is_none());
        let bent = |t: f64| Some([(t - 0.3).abs()]);
        let table = Table::new(&[0.0, 1.0], bent, |a, b| (a[0] - b[0]).abs() <= 1e-14);
        let open: Vec<_> = table.spans.iter().filter(|s| s.powers.is_none()).collect();
        assert!(open.len() == 1 && open[0].from < 0.3 && open[0].until > 0.3);
        assert!(table.at(0.3).is_none() && table.at(0.5).is_some());
    }
}
