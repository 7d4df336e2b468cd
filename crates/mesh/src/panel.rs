//! One panel as a bilinear patch or a triangle: centre, area, volume of its cone, quadrature.

use moldloft_num::GAUSS_2_UNIT;
use moldloft_num::{Real, Vec3};

/// The corners of one panel: the bilinear patch between four points, or a plane triangle.
///
/// A quad is S(s, t) = (1-s)(1-t) A + s(1-t) B + s t C + (1-s) t D for s, t in [0, 1], so a panel with
/// corners out of plane is a hyperbolic paraboloid, and neighbours meet along straight edges without
/// gap or overlap.
#[derive(Clone, Copy, Debug)]
pub enum Panel<T> {
    /// Three corners.
    Triangle([Vec3<T>; 3]),
    /// Four corners.
    Quad([Vec3<T>; 4]),
}

impl<T: Real> Panel<T> {
    /// The panel of a face.
    #[inline]
    pub fn of(face: [u32; 4], positions: &[Vec3<T>]) -> Self {
        let [a, b, c, d] = face.map(|v| positions[v as usize]);
        if crate::is_triangle(face) { Self::Triangle([a, b, c]) } else { Self::Quad([a, b, c, d]) }
    }

    /// The corners in order.
    pub fn corners(&self) -> &[Vec3<T>] {
        match self {
            Self::Triangle(corners) => corners,
            Self::Quad(corners) => corners,
        }
    }

    /// Mean of the corners.
    pub fn centre(&self) -> Vec3<T> {
        let corners = self.corners();
        let sum = corners.iter().fold(Vec3::zero(), |s, &p| s + p);
        sum / T::from(corners.len() as f64)
    }

    /// The vector area: the integral of the unit normal, half the product of the diagonals.
    #[inline]
    pub fn vector_area(&self) -> Vec3<T> {
        let half = T::from(0.5);
        match *self {
            Self::Triangle([a, b, c]) => (b - a).cross(c - a) * half,
            Self::Quad([a, b, c, d]) => (c - a).cross(d - b) * half,
        }
    }

    /// Points with vector areas, such that the sum of f times vector area is the integral of f n
    /// dA: exactly for every polynomial f up to degree 2 in space.
    ///
    /// A quad has the 2 x 2 Gauss rule: S is linear and S_s x S_t at most linear in each parameter,
    /// so f n is cubic in each. A triangle has the midpoints of its sides, exact to degree 2
    /// (Strang and Fix 1973, Table 4.1).
    #[inline]
    pub fn quadrature(&self, mut at: impl FnMut(Vec3<T>, Vec3<T>)) {
        match *self {
            Self::Triangle([a, b, c]) => {
                let weight = self.vector_area() / T::from(3.0);
                let half = T::from(0.5);
                at((a + b) * half, weight);
                at((b + c) * half, weight);
                at((c + a) * half, weight);
            }
            Self::Quad([a, b, c, d]) => {
                let quarter = T::from(0.25);
                for s in GAUSS_2_UNIT.map(T::from) {
                    let (low, high) = (a.lerp(b, s), d.lerp(c, s));
                    let along_t = (high - low) * quarter;
                    for t in GAUSS_2_UNIT.map(T::from) {
                        let along_s = (b - a).lerp(c - d, t);
                        at(low.lerp(high, t), along_s.cross(along_t));
                    }
                }
            }
        }
    }

    /// The area: exact for triangles and plane convex quads, otherwise the 2 x 2 Gauss value of the
    /// bilinear patch, with an error of fourth order in the warp.
    #[inline]
    pub fn area(&self) -> T {
        match self {
            Self::Triangle(_) => length(self.vector_area()),
            Self::Quad(_) => {
                let mut area = T::zero();
                self.quadrature(|_, weight| area += length(weight));
                area
            }
        }
    }

    /// The signed volume of the cone from the origin to the panel.
    ///
    /// For a quad this is exact for the bilinear patch, which halves the tetrahedron of its corners
    /// and so gives the mean of both splits of the quad into triangles: (|abc| + |acd| + |abd| +
    /// |bcd|) / 12.
    #[inline]
    pub fn cone_volume(&self) -> T {
        match *self {
            Self::Triangle([a, b, c]) => a.cross(b).dot(c) / 6.0,
            Self::Quad([a, b, c, d]) => {
                let (ab, cd) = (a.cross(b), c.cross(d));
                (ab.dot(c + d) + cd.dot(a + b)) / 12.0
            }
        }
    }
}

/// The length of a vector, with zero slope for the zero vector.
#[inline]
pub(crate) fn length<T: Real>(v: Vec3<T>) -> T {
    let square = v.norm_sq();
    if square.re() > 0.0 { square.sqrt() } else { T::zero() }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WARPED: [[f64; 3]; 4] =
        [[0.3, 0.1, 0.5], [1.2, -0.2, 0.9], [1.5, 1.1, 0.2], [-0.1, 0.8, 1.3]];

    #[test]
    fn the_cone_volume_is_that_of_the_bilinear_patch() {
        let quad = Panel::Quad(WARPED.map(Vec3::from));
        let mut divergence = 0.0;
        quad.quadrature(|p, n| divergence += p.dot(n) / 3.0);
        assert!((quad.cone_volume() - divergence).abs() < 1e-15);
        let [a, b, c, d] = WARPED.map(Vec3::from);
        let split = |p, q, r| Panel::<f64>::Triangle([p, q, r]).cone_volume();
        let mean = (split(a, b, c) + split(a, c, d) + split(a, b, d) + split(b, c, d)) / 2.0;
        assert!((quad.cone_volume() - mean).abs() < 1e-15);
    }

    #[test]
    fn quadrature_sums_to_the_vector_area() {
        for panel in [
            Panel::Quad(WARPED.map(Vec3::from)),
            Panel::Triangle([0, 1, 2].map(|k| Vec3::from(WARPED[k]))),
        ] {
            let mut sum = Vec3::<f64>::zero();
            panel.quadrature(|_, n| sum += n);
            assert!(sum.distance(panel.vector_area()) < 1e-15);
        }
    }

    #[test]
    fn plane_quads_have_their_exact_area() {
        let trapezium = Panel::<f64>::Quad([
            Vec3::of(0.0, 0.0, 2.0),
            Vec3::of(4.0, 0.0, 2.0),
            Vec3::of(3.0, 1.0, 2.0),
            Vec3::of(1.0, 1.0, 2.0),
        ]);
        assert!((trapezium.area() - 3.0).abs() < 1e-15);
        assert_eq!(Panel::<f64>::Triangle([Vec3::zero(); 3]).area(), 0.0);
    }
}
