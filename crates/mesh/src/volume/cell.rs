//! One hexahedron as a trilinear map: volume, Jacobians, aspect.

use crate::Panel;
use moldloft_num::GAUSS_2_UNIT;
use moldloft_num::{Real, Vec3};

/// An edge shorter than this, relative to its cell, has collapsed.
const COLLAPSED: f64 = 1e-12;

/// The corners of a hexahedron: the trilinear map of the unit cube; bits 0, 1 and 2 of a corner's
/// number are its u, v and w.
#[derive(Clone, Copy, Debug)]
pub struct Hexahedron<T>(pub [Vec3<T>; 8]);

/// The corners of the six faces, counter-clockwise seen from outside of a right-handed cell.
const FACES: [[usize; 4]; 6] =
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

impl<T: Real> Hexahedron<T> {
    /// The exact volume of the trilinear map: the cones over its six bilinear faces. Neighbours
    /// share faces, so the volumes of cells add up to that of the whole.
    pub fn volume(&self) -> T {
        // About a corner, for the sake of cells far from the origin; three faces have it.
        let about = self.0[0];
        let mut sum = T::zero();
        for face in FACES {
            sum += Panel::Quad(face.map(|c| self.0[c] - about)).cone_volume();
        }
        sum
    }

    /// The edges X_u, X_v, X_w of the map at (u, v, w) in the unit cube.
    pub fn tangents(&self, [u, v, w]: [f64; 3]) -> [Vec3<T>; 3] {
        let x = &self.0;
        let side = |axis: usize, s: f64, t: f64| {
            let (p, q) = [(1, 2), (0, 2), (0, 1)][axis];
            let mut sum = Vec3::zero();
            for (a, b) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let weight =
                    (if a == 1 { s } else { 1.0 - s }) * (if b == 1 { t } else { 1.0 - t });
                let low = (a << p) | (b << q);
                sum += (x[low | 1 << axis] - x[low]) * T::from(weight);
            }
            sum
        };
        [side(0, v, w), side(1, u, w), side(2, u, v)]
    }

    /// The Jacobian det(X_u, X_v, X_w) at (u, v, w) in the unit cube.
    pub fn jacobian(&self, at: [f64; 3]) -> T {
        let [u, v, w] = self.tangents(at);
        u.cross(v).dot(w)
    }
}

impl Hexahedron<f64> {
    /// The corners and the 2 x 2 x 2 Gauss points.
    pub fn probes() -> impl Iterator<Item = ([f64; 3], bool)> {
        let of = |low: f64, high: f64| {
            move |c: usize| [0, 1, 2].map(|axis| if c >> axis & 1 == 1 { high } else { low })
        };
        let corners = (0..8).map(of(0.0, 1.0)).map(|p| (p, true));
        corners.chain((0..8).map(of(GAUSS_2_UNIT[0], GAUSS_2_UNIT[1])).map(|p| (p, false)))
    }

    /// The smallest scaled Jacobian det(X_u, X_v, X_w) / (|X_u| |X_v| |X_w|) at the corners and the
    /// Gauss points, with its position: 1 for a brick, 0 or less for a folded cell. Corners at an
    /// edge of zero length, as at a pole, are ignored; a cell of zero volume has 0.
    pub fn scaled_jacobian(&self) -> (f64, [f64; 3]) {
        let size = self.0.iter().map(|p| p.distance(self.0[0])).fold(0.0, f64::max);
        let mut worst = (f64::INFINITY, [0.5; 3]);
        for (at, corner) in Self::probes() {
            let [u, v, w] = self.tangents(at);
            let lengths = [u.norm(), v.norm(), w.norm()];
            if corner && lengths.iter().any(|&l| l <= COLLAPSED * size) {
                continue;
            }
            let volume = lengths.iter().product::<f64>();
            let scaled = if volume > 0.0 { u.cross(v).dot(w) / volume } else { 0.0 };
            if scaled < worst.0 {
                worst = (scaled, at);
            }
        }
        worst
    }

    /// The position at (u, v, w) in the unit cube.
    pub fn position(&self, [u, v, w]: [f64; 3]) -> Vec3 {
        let x = &self.0;
        let low = x[0].lerp(x[1], u).lerp(x[2].lerp(x[3], u), v);
        low.lerp(x[4].lerp(x[5], u).lerp(x[6].lerp(x[7], u), v), w)
    }

    /// The ratio of the longest edge to the shortest of nonzero length.
    pub fn aspect(&self) -> f64 {
        let (mut short, mut long) = (f64::INFINITY, 0.0_f64);
        for axis in 0..3 {
            for low in (0..8).filter(|c| c >> axis & 1 == 0) {
                let length = self.0[low].distance(self.0[low | 1 << axis]);
                long = long.max(length);
                if length > 0.0 {
                    short = short.min(length);
                }
            }
        }
        if long > 0.0 { long / short } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> Hexahedron<f64> {
        Hexahedron(std::array::from_fn(|c| {
            Vec3::of((c & 1) as f64, (c >> 1 & 1) as f64, (c >> 2) as f64)
        }))
    }

    #[test]
    fn a_brick() {
        let brick =
            Hexahedron::<f64>(cube().0.map(|p| Vec3::of(2.0 * p.x + 9.0, 3.0 * p.y, 0.5 * p.z)));
        assert!((brick.volume() - 3.0).abs() < 1e-14);
        assert!((brick.jacobian([0.3, 0.1, 0.9]) - 3.0).abs() < 1e-14);
        assert!((brick.scaled_jacobian().0 - 1.0).abs() < 1e-15);
        assert!((brick.aspect() - 6.0).abs() < 1e-15);
    }

    /// The 2 x 2 x 2 rule is exact for the Jacobian of a trilinear map, of degree 2 in each.
    #[test]
    fn the_volume_is_the_integral_of_the_jacobian() {
        let mut warped = cube();
        for (c, p) in warped.0.iter_mut().enumerate() {
            let wiggle = |k: usize| 0.1 * ((7 * c + 3 * k) as f64).sin();
            *p += Vec3::of(wiggle(0), wiggle(1), wiggle(2));
        }
        let gauss = Hexahedron::probes().filter(|(_, corner)| !corner);
        let sum: f64 = gauss.map(|(at, _)| warped.jacobian(at) / 8.0).sum();
        assert!((sum - warped.volume()).abs() < 1e-14, "{sum} {}", warped.volume());
    }

    #[test]
    fn a_corner_pushed_through_is_found() {
        let mut cell = cube();
        cell.0[7] = Vec3::of(0.2, 0.2, 0.2);
        let (worst, at) = cell.scaled_jacobian();
        assert!(worst < 0.0 && at == [1.0; 3], "{worst} {at:?}");
        let wedge = Hexahedron::<f64>(cube().0.map(|p| Vec3::of(p.x * p.y, p.y, p.z)));
        assert!((wedge.volume() - 0.5).abs() < 1e-15);
        assert!(wedge.scaled_jacobian().0 > 0.5);
        let flat = Hexahedron::<f64>(cube().0.map(|p| Vec3::of(p.x, p.y, 0.0)));
        assert_eq!(flat.scaled_jacobian().0, 0.0);
    }
}
