//! The second-order cone |u1| <= u0 with a scaling that maps slack and dual to one point.

use crate::solver::{V, axpy, dot};

/// A point of the cone's space: its axis part and the rest.
pub(crate) type Pair = (f64, V);

/// Slack, dual and their scaling point (Nesterov and Todd 1997).
#[derive(Clone, Debug)]
pub(crate) struct Cone {
    pub u: Pair,
    pub y: Pair,
    /// The scaling W = eta [w0, w1'; w1, I + w1 w1' / (1 + w0)].
    w: Pair,
    eta: f64,
    /// W y = W^-1 u.
    middle: Pair,
}

/// u0^2 - |u1|^2 without cancellation.
fn det(u: Pair) -> f64 {
    let length = dot(u.1, u.1).sqrt();
    (u.0 - length) * (u.0 + length)
}

/// The Jordan product.
fn product(a: Pair, b: Pair) -> Pair {
    let mut rest = [0.0; 3];
    axpy(&mut rest, a.0, b.1);
    axpy(&mut rest, b.0, a.1);
    (a.0 * b.0 + dot(a.1, b.1), rest)
}

impl Cone {
    pub fn new(u: Pair, y: Pair) -> Self {
        let mut cone = Self { u, y, w: (1.0, [0.0; 3]), eta: 1.0, middle: u };
        cone.scale();
        cone
    }

    /// The cone with its dual moved to the central path: off the path the scaling's sideways
    /// stiffness is not that of the solution.
    pub fn centred(&self) -> Self {
        let share = self.y.0 / self.u.0;
        Self::new(self.u, (self.y.0, self.u.1.map(|c| -c * share)))
    }

    /// Recomputes the scaling from slack and dual.
    pub fn scale(&mut self) {
        // Rounding may put a point on its cone's surface: a trace inside is enough.
        let inner = |p: Pair| det(p).max(1e-30 * p.0 * p.0).max(f64::MIN_POSITIVE);
        let (du, dy) = (inner(self.u), inner(self.y));
        let (ru, ry) = (du.sqrt(), dy.sqrt());
        let a = (self.u.0 / ru, self.u.1.map(|c| c / ru));
        let b = (self.y.0 / ry, self.y.1.map(|c| c / ry));
        let gamma = ((1.0 + a.0 * b.0 + dot(a.1, b.1)) * 0.5).max(0.25).sqrt();
        let mut w1 = a.1;
        axpy(&mut w1, -1.0, b.1);
        let w1 = w1.map(|c| c / (2.0 * gamma));
        // On the unit hyperbola by construction.
        self.w = ((1.0 + dot(w1, w1)).sqrt(), w1);
        self.eta = (du / dy).sqrt().sqrt();
        self.middle = self.map(self.y);
    }

    /// W p.
    fn map(&self, p: Pair) -> Pair {
        let along = dot(self.w.1, p.1);
        let mut rest = p.1;
        axpy(&mut rest, p.0 + along / (1.0 + self.w.0), self.w.1);
        (self.eta * (self.w.0 * p.0 + along), rest.map(|c| c * self.eta))
    }

    /// W^-1 p.
    fn unmap(&self, p: Pair) -> Pair {
        let along = dot(self.w.1, p.1);
        let mut rest = p.1;
        axpy(&mut rest, along / (1.0 + self.w.0) - p.0, self.w.1);
        ((self.w.0 * p.0 - along) / self.eta, rest.map(|c| c / self.eta))
    }

    /// The block of W^-2 from u1 to y1 (with the axis part eliminated when `free`): how hard the
    /// cone resists.
    pub fn stiffness(&self, free: bool) -> [V; 3] {
        let scale = 1.0 / (self.eta * self.eta);
        // W^-2 = (2 (Jw)(Jw)' - J) / eta^2: corner 2 w0^2 - 1, side -2 w0 w1, block 2 w1 w1' + I.
        let (w0, w1) = self.w;
        let factor = if free {
            let corner = 2.0 * w0 * w0 - 1.0;
            // 2 - 4 w0^2 / corner
            -2.0 / corner
        } else {
            2.0
        };
        let mut out = [[0.0; 3]; 3];
        for r in 0..3 {
            for c in 0..3 {
                let unit = f64::from(u8::from(r == c));
                out[r][c] = scale * (unit + factor * w1[r] * w1[c]);
            }
        }
        out
    }

    /// The side of W^-2 from u0 to y1: the force that a wider limit takes back, with its sign.
    pub fn side(&self) -> V {
        let scale = -2.0 * self.w.0 / (self.eta * self.eta);
        self.w.1.map(|c| c * scale)
    }

    /// W^-1 (middle \ d), with d the goal of the scaled complementarity: the centre `mu`, less the
    /// second-order term of an earlier direction.
    pub fn goal(&self, mu: f64, before: Option<(&Pair, &Pair)>) -> Pair {
        let mut d = product(self.middle, self.middle);
        d = (mu - d.0, d.1.map(|c| -c));
        if let Some((du, dy)) = before {
            let second = product(self.unmap(*du), self.map(*dy));
            d.0 -= second.0;
            axpy(&mut d.1, -1.0, second.1);
        }
        let m = self.middle;
        let under = det(m).max(f64::MIN_POSITIVE);
        let q0 = (m.0 * d.0 - dot(m.1, d.1)) / under;
        let mut q1 = d.1;
        axpy(&mut q1, -q0, m.1);
        self.unmap((q0, q1.map(|c| c / m.0)))
    }

    /// The part of the dual's change that does not depend on x. `free`: the axis part of the slack
    /// may change and that of the dual may not.
    pub fn fixed(&self, goal: &Pair, free: bool) -> V {
        let mut fixed = goal.1;
        if free {
            let (w0, w1) = self.w;
            let corner = 2.0 * w0 * w0 - 1.0;
            axpy(&mut fixed, 2.0 * w0 / corner * goal.0, w1);
        }
        fixed
    }

    /// The changes of slack and dual when the slack's rest changes by `de`.
    pub fn change(&self, goal: &Pair, de: V, free: bool) -> (Pair, Pair) {
        let scale = 1.0 / (self.eta * self.eta);
        let (w0, w1) = self.w;
        let corner = 2.0 * w0 * w0 - 1.0;
        let along = dot(w1, de);
        let dt = if free { (goal.0 / scale + 2.0 * w0 * along) / corner } else { 0.0 };
        // y = goal - W^-2 (dt, de)
        let y0 = if free { 0.0 } else { goal.0 + scale * 2.0 * w0 * along };
        let mut y1 = goal.1;
        axpy(&mut y1, -scale, de);
        axpy(&mut y1, scale * (2.0 * w0 * dt - 2.0 * along), w1);
        ((dt, de), (y0, y1))
    }
}

/// How far `u` can go along `du` inside the cone, at most 2.
pub(crate) fn farthest(u: Pair, du: Pair) -> f64 {
    // The first positive root of det(u + t du) = c + 2 b t + a t^2.
    let a = du.0 * du.0 - dot(du.1, du.1);
    let b = u.0 * du.0 - dot(u.1, du.1);
    let c = det(u).max(0.0);
    let under = b * b - a * c;
    let mut t: f64 = 2.0;
    if under >= 0.0 {
        let root = under.sqrt();
        // Roots c / (-b + root) and c / (-b - root), stable for a near 0.
        for q in [-b + root, -b - root] {
            if q > 0.0 {
                t = t.min(c / q);
            }
        }
    }
    if du.0 < 0.0 {
        t = t.min(-u.0 / du.0);
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    fn some(random: &mut Random, inside: f64) -> Pair {
        let v = [random.unit(), random.unit(), random.unit()];
        (dot(v, v).sqrt() * (1.0 + inside), v)
    }

    #[test]
    fn scaling_maps_dual_and_slack_to_one_point() {
        let mut random = Random::new(9);
        for inside in [1.0, 1e-2, 1e-6] {
            for _ in 0..50 {
                let cone = Cone::new(some(&mut random, inside), some(&mut random, inside));
                let (a, b) = (cone.map(cone.y), cone.unmap(cone.u));
                let size = a.0.abs();
                assert!((a.0 - b.0).abs() < 1e-6 * size, "{a:?} {b:?}");
                for c in 0..3 {
                    assert!((a.1[c] - b.1[c]).abs() < 1e-6 * size);
                }
                let back = cone.unmap(cone.map(cone.u));
                assert!((back.0 - cone.u.0).abs() < 1e-6 * cone.u.0 / inside.sqrt());
            }
        }
    }

    #[test]
    fn changes_solve_the_linearised_complementarity() {
        let mut random = Random::new(2);
        for free in [false, true] {
            let cone = Cone::new(some(&mut random, 0.5), some(&mut random, 0.3));
            let goal = cone.goal(0.01, None);
            let de = [0.3, -0.2, 0.1];
            let (du, dy) = cone.change(&goal, de, free);
            // W dy + W^-1 du = W goal
            let (p, q, r) = (cone.map(dy), cone.unmap(du), cone.map(goal));
            assert!((p.0 + q.0 - r.0).abs() < 1e-12);
            for c in 0..3 {
                assert!((p.1[c] + q.1[c] - r.1[c]).abs() < 1e-12);
            }
            assert_eq!(if free { dy.0 } else { du.0 }, 0.0);
            // The dual's change is the fixed part less stiffness times de.
            let (fixed, k) = (cone.fixed(&goal, free), cone.stiffness(free));
            for c in 0..3 {
                assert!((fixed[c] - dot(k[c], de) - dy.1[c]).abs() < 1e-12, "{free}");
            }
        }
    }

    #[test]
    fn the_farthest_step_ends_on_the_cone() {
        let mut random = Random::new(4);
        let mut ended = 0;
        for _ in 0..200 {
            let u = some(&mut random, 0.2);
            let du = (random.unit(), [random.unit(), random.unit(), random.unit()]);
            let t = farthest(u, du);
            let at = |t: f64| {
                let mut v = u.1;
                axpy(&mut v, t, du.1);
                (u.0 + t * du.0) - dot(v, v).sqrt()
            };
            assert!(at(0.999 * t) > 0.0);
            if t < 2.0 {
                ended += 1;
                assert!(at(1.001 * t) < 0.0);
            }
        }
        assert!(ended > 50);
    }
}
