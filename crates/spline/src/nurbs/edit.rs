//! Parts, reversals and edges of NURBS.

use super::{Nurbs, data};
use moldloft_num::{Pace, Vec3};

impl Nurbs<1> {
    /// The same curve run backwards.
    pub fn reversed(&self) -> Self {
        let [knots] = &self.knots;
        let mut other = self.clone();
        other.knots = [knots.iter().rev().map(|k| 1.0 - k).collect()];
        other.points.reverse();
        if let Some(weights) = &mut other.weights {
            weights.reverse();
        }
        other
    }

    /// The part from `a` to `b`, its knots again over [0, 1] (by insertion of knots: Boehm 1980).
    pub fn part(&self, a: f64, b: f64) -> Self {
        let (p, [knots]) = (self.degrees[0], &self.knots);
        let (mut knots, mut values) = (knots.clone(), self.homogeneous());
        for t in [a, b] {
            if t <= 0.0 || t >= 1.0 {
                continue;
            }
            let times = knots.iter().filter(|&&k| k == t).count();
            for _ in times..p {
                insert(p, &mut knots, &mut values, t);
            }
        }
        let first = if a <= 0.0 { 0 } else { knots.partition_point(|&k| k < a) - 1 };
        let last = if b >= 1.0 { values.len() - 1 } else { knots.partition_point(|&k| k < b) - 1 };
        let inner = knots.iter().filter(|&&k| a < k && k < b).map(|k| (k - a) / (b - a));
        let mut own = vec![0.0; p + 1];
        own.extend(inner);
        own.extend(std::iter::repeat_n(1.0, p + 1));
        let values = &values[first..=last];
        let all_one = self.weights.is_none();
        let position =
            |v: &data::Value| if all_one { Vec3::of(v[0], v[1], v[2]) } else { data::point(*v) };
        Self {
            degrees: self.degrees,
            knots: [own],
            points: values.iter().map(position).collect(),
            weights: (!all_one).then(|| values.iter().map(|v| v[3]).collect()),
            paces: [Pace::Even],
            ..*self
        }
    }
}

fn insert(p: usize, knots: &mut Vec<f64>, values: &mut Vec<data::Value>, t: f64) {
    let k = knots.partition_point(|&x| x <= t) - 1;
    let mut new = Vec::with_capacity(values.len() + 1);
    for i in 0..=values.len() {
        new.push(if i + p <= k {
            values[i]
        } else if i > k {
            values[i - 1]
        } else {
            let width = knots[i + p] - knots[i];
            let share = if width > 0.0 { (t - knots[i]) / width } else { 0.0 };
            std::array::from_fn(|c| {
                let before = if i == 0 { 0.0 } else { values[i - 1][c] };
                let here = if i == values.len() { 0.0 } else { values[i][c] };
                (1.0 - share) * before + share * here
            })
        });
    }
    *values = new;
    knots.insert(k + 1, t);
}

impl Nurbs<2> {
    /// Edge 0..4 (v = 0, u = 1, v = 1, u = 0) in increasing parameter.
    pub fn edge(&self, k: usize) -> Nurbs<1> {
        let [nu, nv] = self.counts();
        let along = k % 2;
        let index = |i: usize| match k {
            0 => i * nv,
            1 => (nu - 1) * nv + i,
            2 => i * nv + nv - 1,
            _ => i,
        };
        let count = [nu, nv][along];
        let weights: Option<Vec<f64>> =
            self.weights.as_ref().map(|w| (0..count).map(|i| w[index(i)]).collect());
        Nurbs {
            degrees: [self.degrees[along]],
            knots: [self.knots[along].clone()],
            points: (0..count).map(|i| self.points[index(i)]).collect(),
            // A common factor of all weights changes nothing.
            weights: weights.filter(|w| w.iter().any(|x| (x - w[0]).abs() > 1e-14 * w[0])),
            error: self.error,
            exact: self.exact,
            paces: [self.paces[along]],
        }
    }
}
