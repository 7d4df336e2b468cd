//! The second-order cone |u1| <= u0 with a scaling that maps slack and dual to one point.

/// A vector of the directions in use.
pub(crate) type V<const D: usize> = [f64; D];

/// A point of the cone's space: its axis part and the rest.
pub(crate) type Pair<const D: usize> = (f64, V<D>);

#[inline(always)]
pub(crate) fn dot<const D: usize>(a: V<D>, b: V<D>) -> f64 {
    let mut sum = a[0] * b[0];
    for c in 1..D {
        sum += a[c] * b[c];
    }
    sum
}

#[inline(always)]
pub(crate) fn axpy<const D: usize>(y: &mut V<D>, a: f64, x: V<D>) {
    for c in 0..D {
        y[c] += a * x[c];
    }
}

/// Slack, dual and their scaling point (Nesterov and Todd 1997).
#[derive(Clone, Debug)]
pub(crate) struct ConeScaling<const D: usize> {
    pub u: Pair<D>,
    pub y: Pair<D>,
    /// The scaling W = eta [w0, w1'; w1, I + w1 w1' / (1 + w0)].
    w: Pair<D>,
    eta: f64,
    /// W y = W^-1 u.
    middle: Pair<D>,
    /// Distances of slack and dual from the boundary, squared.
    inside: [f64; 2],
}

/// u0^2 - |u1|^2 without cancellation.
#[inline(always)]
fn det<const D: usize>(u: Pair<D>) -> f64 {
    let length = dot(u.1, u.1).sqrt();
    (u.0 - length) * (u.0 + length)
}

/// The Jordan product.
#[inline(always)]
fn product<const D: usize>(a: Pair<D>, b: Pair<D>) -> Pair<D> {
    let mut rest = [0.0; D];
    axpy(&mut rest, a.0, b.1);
    axpy(&mut rest, b.0, a.1);
    (a.0 * b.0 + dot(a.1, b.1), rest)
}

impl<const D: usize> ConeScaling<D> {
    pub fn new(u: Pair<D>, y: Pair<D>) -> Self {
        let mut cone = Self { u, y, w: (1.0, [0.0; D]), eta: 1.0, middle: u, inside: [1.0; 2] };
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
    #[inline]
    pub fn scale(&mut self) {
        // Rounding may put a point on its cone's surface: a trace inside is enough.
        let inner = |p: Pair<D>| det(p).max(1e-30 * p.0 * p.0).max(f64::MIN_POSITIVE);
        let (du, dy) = (inner(self.u), inner(self.y));
        let (ru, ry) = (du.sqrt(), dy.sqrt());
        let (per_u, per_y) = (1.0 / ru, 1.0 / ry);
        let a = (self.u.0 * per_u, self.u.1.map(|c| c * per_u));
        let b = (self.y.0 * per_y, self.y.1.map(|c| c * per_y));
        let gamma = ((1.0 + a.0 * b.0 + dot(a.1, b.1)) * 0.5).max(0.25).sqrt();
        let half = 0.5 / gamma;
        let mut w1 = a.1;
        axpy(&mut w1, -1.0, b.1);
        let w1 = w1.map(|c| c * half);
        // On the unit hyperbola by construction.
        self.w = ((1.0 + dot(w1, w1)).sqrt(), w1);
        self.eta = (ru * per_y).sqrt();
        self.inside = [du, dy];
        self.middle = self.map(self.y);
    }

    /// W p.
    #[inline(always)]
    fn map(&self, p: Pair<D>) -> Pair<D> {
        let along = dot(self.w.1, p.1);
        let mut rest = p.1;
        axpy(&mut rest, p.0 + along / (1.0 + self.w.0), self.w.1);
        (self.eta * (self.w.0 * p.0 + along), rest.map(|c| c * self.eta))
    }

    /// W^-1 p.
    #[inline(always)]
    fn unmap(&self, p: Pair<D>) -> Pair<D> {
        let along = dot(self.w.1, p.1);
        let per = 1.0 / self.eta;
        let mut rest = p.1;
        axpy(&mut rest, along / (1.0 + self.w.0) - p.0, self.w.1);
        ((self.w.0 * p.0 - along) * per, rest.map(|c| c * per))
    }

    /// The block of W^-2 from u1 to y1 (with the axis part eliminated when `free`): how hard the
    /// cone resists.
    #[inline(always)]
    pub fn stiffness(&self, free: bool) -> [V<D>; D] {
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
        let mut out = [[0.0; D]; D];
        for r in 0..D {
            for c in 0..D {
                let unit = f64::from(u8::from(r == c));
                out[r][c] = scale * (unit + factor * w1[r] * w1[c]);
            }
        }
        out
    }

    /// The side of W^-2 from u0 to y1: the force that a wider limit takes back, with its sign.
    pub fn side(&self) -> V<D> {
        let scale = -2.0 * self.w.0 / (self.eta * self.eta);
        self.w.1.map(|c| c * scale)
    }

    /// W^-1 (middle \ d), with d the goal of the scaled complementarity: the centre `mu` less what
    /// is there, and less the second-order term of an earlier direction. Without either it is the
    /// whole dual taken back.
    #[inline(always)]
    pub fn goal(&self, towards: Option<(f64, &Pair<D>, &Pair<D>)>) -> Pair<D> {
        let taken = (-self.y.0, self.y.1.map(|c| -c));
        let Some((mu, du, dy)) = towards else { return taken };
        let second = product(self.unmap(*du), self.map(*dy));
        let (d0, d1) = (mu - second.0, second.1);
        let m = self.middle;
        let under = det(m).max(f64::MIN_POSITIVE);
        let q0 = (m.0 * d0 + dot(m.1, d1)) / under;
        let per = -1.0 / m.0;
        let mut q1 = d1;
        axpy(&mut q1, q0, m.1);
        let mut goal = self.unmap((q0, q1.map(|c| c * per)));
        goal.0 += taken.0;
        axpy(&mut goal.1, 1.0, taken.1);
        goal
    }

    /// The part of the dual's change that does not depend on x. `free`: the axis part of the slack
    /// may change and that of the dual may not.
    #[inline(always)]
    pub fn fixed(&self, goal: &Pair<D>, free: bool) -> V<D> {
        let mut fixed = goal.1;
        if free {
            let (w0, w1) = self.w;
            let corner = 2.0 * w0 * w0 - 1.0;
            axpy(&mut fixed, 2.0 * w0 / corner * goal.0, w1);
        }
        fixed
    }

    /// The changes of slack and dual when the slack's rest changes by `de`.
    #[inline(always)]
    pub fn change(&self, goal: &Pair<D>, de: V<D>, free: bool) -> (Pair<D>, Pair<D>) {
        let scale = 1.0 / (self.eta * self.eta);
        let (w0, w1) = self.w;
        let along = dot(w1, de);
        let dt = if free {
            let corner = 2.0 * w0 * w0 - 1.0;
            (goal.0 / scale + 2.0 * w0 * along) / corner
        } else {
            0.0
        };
        // y = goal - W^-2 (dt, de)
        let y0 = if free { 0.0 } else { goal.0 + scale * 2.0 * w0 * along };
        let mut y1 = goal.1;
        axpy(&mut y1, -scale, de);
        axpy(&mut y1, scale * (2.0 * w0 * dt - 2.0 * along), w1);
        ((dt, de), (y0, y1))
    }

    /// The longest step of slack and dual along `du` and `dy` inside the cone, at most `step`.
    #[inline(always)]
    pub fn longest(&self, du: Pair<D>, dy: Pair<D>, mut step: f64) -> f64 {
        for (p, d, inside) in [(self.u, du, self.inside[0]), (self.y, dy, self.inside[1])] {
            // A cone is convex: where its end is inside, the step is.
            let b = p.0 * d.0 - dot(p.1, d.1);
            let a = d.0 * d.0 - dot(d.1, d.1);
            if inside + step * (2.0 * b + step * a) <= 0.0 || p.0 + step * d.0 <= 0.0 {
                step = step.min(farthest(p, d));
            }
        }
        step
    }
}

/// The longest step of `u` along `du` inside the cone, at most 2.
pub(crate) fn farthest<const D: usize>(u: Pair<D>, du: Pair<D>) -> f64 {
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
    use moldloft_testing::Lcg;

    fn some(random: &mut Lcg, inside: f64) -> Pair<3> {
        let v = [random.centred(), random.centred(), random.centred()];
        (dot(v, v).sqrt() * (1.0 + inside), v)
    }

    #[test]
    fn scaling_maps_dual_and_slack_to_one_point() {
        let mut random = Lcg::new(9);
        for inside in [1.0, 1e-2, 1e-6] {
            for _ in 0..50 {
                let cone = ConeScaling::new(some(&mut random, inside), some(&mut random, inside));
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
        let mut random = Lcg::new(2);
        for free in [false, true] {
            let cone = ConeScaling::new(some(&mut random, 0.5), some(&mut random, 0.3));
            let before = (some(&mut random, -0.5), some(&mut random, 0.0));
            let goal = cone.goal(Some((0.01, &before.0, &before.1)));
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
        let mut random = Lcg::new(4);
        let mut ended = 0;
        for _ in 0..200 {
            let u = some(&mut random, 0.2);
            let du = (random.centred(), [random.centred(), random.centred(), random.centred()]);
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
