//! Circular arcs of networks: points of a curve on one circle, tangent to straight runs beside it.
//!
//! The circle is that of three of the points: its equations are those of the others, made linear at the
//! points as the search has them.

use crate::{Condition, Network};
use moldloft_num::{Dual4, Real, Vec3};

/// The area of the triangle of an arc, relative to the square of its chord, below which it is straight.
const STRAIGHT: f64 = 1e-9;

/// An arc of a faired network.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkArc {
    /// The curve.
    pub curve: usize,
    /// Indices of its first and last point on the curve.
    pub between: [usize; 2],
    /// Its radius.
    pub radius: f64,
    /// Its centre.
    pub centre: Vec3<f64>,
}

/// Centre and radius of the circle through three points.
fn circle<T: Real>([a, b, c]: [Vec3<T>; 3]) -> (Vec3<T>, T) {
    let (u, v) = (b - a, c - a);
    let normal = u.cross(v);
    let off = normal.cross(u) * v.norm_sq() + v.cross(normal) * u.norm_sq();
    let off = off / (normal.norm_sq() * T::from(2.0));
    (a + off, off.norm())
}

/// An equation f = 0 of points, made linear at them.
fn linear<const K: usize>(
    ids: [usize; K],
    points: &[Vec3<f64>],
    f: impl Fn([Vec3<Dual4>; K]) -> Dual4,
) -> Condition {
    let at = ids.map(|i| points[i].to_array());
    let mut slopes = [[0.0; 3]; K];
    let mut value = 0.0;
    for first in (0..3 * K).step_by(4) {
        let seeded = |j: usize, axis: usize| match (3 * j + axis).checked_sub(first) {
            Some(direction) if direction < 4 => Dual4::seeded(at[j][axis], direction),
            _ => Dual4::from(at[j][axis]),
        };
        let out = f(std::array::from_fn(|j| Vec3::new(seeded(j, 0), seeded(j, 1), seeded(j, 2))));
        value = out.re();
        for k in first..(first + 4).min(3 * K) {
            slopes[k / 3][k % 3] = out.eps[k - first];
        }
    }
    let entries = ids.into_iter().zip(slopes).map(|(i, slope)| (i, Vec3::from(slope))).collect();
    let mut condition = Condition { entries, value: 0.0 };
    condition.value = condition.at(points) - value;
    condition
}

impl Network {
    /// The arcs of curve `k`.
    pub(super) fn arcs_of(&self, k: usize) -> Vec<[usize; 2]> {
        self.arcs.iter().filter(|arc| arc.0 == k).map(|arc| arc.1).collect()
    }

    /// The three points that determine an arc's circle.
    fn on_arc(&self, k: usize, between: [usize; 2]) -> [usize; 3] {
        [between[0], between[0].midpoint(between[1]), between[1]].map(|c| self.strands[k].points[c])
    }

    /// The points of an arc on a circle in the plane that they had, which is tangent to straight runs that end
    /// at its ends or beside them.
    pub(super) fn arc(
        &self,
        k: usize,
        between: [usize; 2],
        points: &[Vec3<f64>],
    ) -> Result<Vec<Condition>, String> {
        let strand = &self.strands[k];
        let own = &strand.points[between[0]..=between[1]];
        let three = self.on_arc(k, between);
        let straight = |points: &[Vec3<f64>]| {
            let [a, b, c] = three.map(|i| points[i]);
            let normal = (b - a).cross(c - a);
            (normal.norm() > STRAIGHT * (c - a).norm_sq()).then_some(normal)
        };
        let line = "its points are on one line: a straight run";
        let normal = straight(&self.points).and_then(|n| n.normalized()).ok_or(line)?;
        straight(points).ok_or(line)?;
        let [a, b, c] = three;
        let mut out = Vec::new();
        for &i in own.iter().filter(|i| **i != a) {
            out.push(Condition { entries: vec![(a, -normal), (i, normal)], value: 0.0 });
        }
        for &i in own.iter().filter(|i| !three.contains(i)) {
            out.push(linear([a, b, c, i], points, |[a, b, c, p]| {
                let (centre, radius) = circle([a, b, c]);
                (p - centre).norm() - radius
            }));
        }
        for run in &strand.runs {
            let [from, to] = run.map(|c| strand.points[c]);
            let shared = own.iter().find(|&&i| i == from || i == to);
            let beside = run[1] + 1 == between[0] || run[0] == between[1] + 1;
            if let Some(&end) = shared {
                out.push(linear([a, b, c, from, to, end], points, |[a, b, c, from, to, end]| {
                    let (centre, _) = circle([a, b, c]);
                    let along = to - from;
                    (centre - end).dot(along) / along.norm()
                }));
            } else if beside {
                out.push(linear([a, b, c, from, to], points, |[a, b, c, from, to]| {
                    let (centre, radius) = circle([a, b, c]);
                    let along = to - from;
                    (centre - from).cross(along).norm() / along.norm() - radius
                }));
            }
        }
        Ok(out)
    }

    /// The arcs at these points.
    pub(super) fn arcs_at(&self, points: &[Vec3<f64>]) -> Vec<NetworkArc> {
        let arc = |&(curve, between): &(usize, [usize; 2])| {
            let (centre, radius) = circle(self.on_arc(curve, between).map(|i| points[i]));
            NetworkArc { curve, between, radius, centre }
        };
        self.arcs.iter().map(arc).collect()
    }
}
