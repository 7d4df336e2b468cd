//! Panels cut at the water.

use crate::Panel;
use moldloft_num::{Real, Vec3};

/// The part of a panel below a level, at most six corners.
#[derive(Clone, Copy)]
pub(crate) struct Cut<T> {
    points: [Vec3<T>; 6],
    /// Whether each corner lies on the level.
    wet: [bool; 6],
    len: usize,
}

impl<T: Real> Cut<T> {
    fn push(&mut self, point: Vec3<T>, on_level: bool) {
        self.points[self.len] = point;
        self.wet[self.len] = on_level;
        self.len += 1;
    }

    /// The sides that lie in the level, in the panel's direction.
    pub fn waterline(&self) -> impl Iterator<Item = (Vec3<T>, Vec3<T>)> + '_ {
        let next = |k: usize| (k + 1) % self.len;
        (0..self.len)
            .filter(move |&k| self.wet[k] && self.wet[next(k)])
            .map(move |k| (self.points[k], self.points[next(k)]))
    }

    /// The pieces to integrate: the panel itself where it is not cut, else a triangle, a bilinear
    /// quad, or a fan of triangles about the mean of the corners.
    pub fn pieces(&self, mut at: impl FnMut(Panel<T>)) {
        match *self.corners() {
            [a, b, c] => at(Panel::Triangle([a, b, c])),
            [a, b, c, d] => at(Panel::Quad([a, b, c, d])),
            ref corners => {
                let n = corners.len();
                let sum = corners.iter().fold(Vec3::zero(), |s, &p| s + p);
                let middle = sum / T::from(n as f64);
                for k in 0..n {
                    at(Panel::Triangle([corners[k], corners[(k + 1) % n], middle]));
                }
            }
        }
    }

    /// The corners in order.
    pub fn corners(&self) -> &[Vec3<T>] {
        &self.points[..self.len]
    }
}

/// The part of the panel below `z = level`, or `None` when no corner is strictly below it, so a
/// panel that lies in the level counts as above. The real parts decide; corners made on the level
/// have z equal to it. Panels that share a side are cut at the same point, to the bit.
pub(crate) fn below<T: Real>(panel: &Panel<T>, level: T) -> Option<Cut<T>> {
    let corners = panel.corners();
    let c = level.re();
    if corners.iter().all(|p| p.z.re() >= c) {
        return None;
    }
    let mut cut = Cut { points: [Vec3::zero(); 6], wet: [false; 6], len: 0 };
    for (k, &p) in corners.iter().enumerate() {
        let q = corners[(k + 1) % corners.len()];
        let (pz, qz) = (p.z.re(), q.z.re());
        if pz <= c {
            cut.push(p, pz == c);
        }
        if pz < c && qz > c {
            cut.push(crossing(p, q, level), true);
        } else if pz > c && qz < c {
            cut.push(crossing(q, p, level), true);
        }
    }
    Some(cut)
}

/// Where the line from `low` to `high` passes the level.
fn crossing<T: Real>(low: Vec3<T>, high: Vec3<T>, level: T) -> Vec3<T> {
    let t = (level - low.z) / (high.z - low.z);
    Vec3 { z: level, ..low + (high - low) * t }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(z: [f64; 4]) -> Panel<f64> {
        let xy = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        Panel::Quad([0, 1, 2, 3].map(|k| Vec3::of(xy[k].0, xy[k].1, z[k])))
    }

    #[test]
    fn corners_on_the_level_are_not_doubled() {
        assert!(below(&square([0.0; 4]), 0.0).is_none());
        assert!(below(&square([0.0, 0.0, 1.0, 1.0]), 0.0).is_none());
        let whole = below(&square([-1.0, -1.0, 0.0, 0.0]), 0.0).unwrap();
        assert_eq!((whole.corners().len(), whole.waterline().count()), (4, 1));
        let half = below(&square([-1.0, 0.0, 1.0, 0.0]), 0.0).unwrap();
        assert_eq!((half.corners().len(), half.waterline().count()), (3, 1));
        let five = below(&square([-1.0, -1.0, -1.0, 1.0]), 0.0).unwrap();
        assert_eq!((five.corners().len(), five.waterline().count()), (5, 1));
        let saddle = below(&square([-1.0, 1.0, -1.0, 1.0]), 0.0).unwrap();
        assert_eq!((saddle.corners().len(), saddle.waterline().count()), (6, 2));
    }

    #[test]
    fn pieces_cover_the_cut() {
        for z in [[-1.0, -1.0, -1.0, -1.0], [-1.0, 1.0, 1.0, -1.0], [-1.0, -1.0, -1.0, 2.0]] {
            let mut sum = Vec3::zero();
            let cut = below(&square(z), 0.0).unwrap();
            cut.pieces(|p| sum += p.vector_area());
            let corners = cut.corners();
            let boundary = (0..corners.len())
                .fold(Vec3::zero(), |s, k| s + corners[k].cross(corners[(k + 1) % corners.len()]));
            assert!(sum.distance(boundary * 0.5) < 1e-15);
        }
    }
}
