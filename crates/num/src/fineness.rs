//! Accuracy of panels: chord error and angle, and the resulting divisions.

use crate::{SurfJet, Vec3};

/// Accuracy of panels relative to a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// Maximum turn of the surface, or of its border, along a panel, in radians.
    pub angle: f64,
    /// Maximum distance of a panel from the surface, in the unit of length.
    pub chord: f64,
    /// Maximum side of a panel, in the unit of length.
    pub side: f64,
}

/// Maximum ratio of a panel's longest side to the shortest that curvature requires there.
const MAX_ASPECT: f64 = 6.0;

/// A point where the sine between S_u and S_v is below this has no normal.
const NO_NORMAL: f64 = 1e-9;

impl Fineness {
    /// Divisions per parameter of a curve, from its first and second derivative and the turn of the
    /// surface's normal along it per parameter: a chord of length h across curvature k deviates by
    /// k h^2 / 8 and turns by k h.
    pub fn along(&self, d: Vec3, dd: Vec3, normal_turn: f64) -> f64 {
        let speed = d.norm();
        if speed.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
            return 0.0;
        }
        let turn = d.cross(dd).norm() / (speed * speed);
        let sag = (turn * speed / (8.0 * self.chord)).sqrt();
        let density = (turn.max(normal_turn) / self.angle).max(sag).max(speed / self.side);
        if density.is_finite() { density } else { 0.0 }
    }

    /// The metric in which the sides of a panel have length 1, approximately, at a point: its
    /// entries u u and v v; `None` if the surface has no normal. The sides follow the principal
    /// curvatures, with a ratio of at most six.
    pub fn metric(&self, s: &SurfJet<f64>) -> Option<[f64; 2]> {
        let (n, _) = unit_normal(s)?;
        let (e, f, g) = (s.u.dot(s.u), s.u.dot(s.v), s.v.dot(s.v));
        // Orthonormal axes of the tangent plane: C C' is the first fundamental form.
        let (c00, c10) = (e.sqrt(), f / e.sqrt());
        let c11 = (g - c10 * c10).max(0.0).sqrt();
        if c00 <= 0.0 || c11 <= 0.0 {
            return None;
        }
        let second = [s.uu, s.uv, s.vv].map(|x| x.dot(n));
        let b00 = second[0] / (c00 * c00);
        let b01 = (second[1] / c00 - b00 * c10) / c11;
        let b11 = (second[2] - c10 * (c10 * b00 + 2.0 * c11 * b01)) / (c11 * c11);
        let (mean, half) = (0.5 * (b00 + b11), 0.5 * (b00 - b11));
        let reach = (half * half + b01 * b01).sqrt();
        let k = [(mean + reach).abs(), (mean - reach).abs()];
        let (most, least) = (k[0].max(k[1]), k[0].min(k[1]));
        // The errors of both directions add up; so do those of the volume, which is less for its area.
        let both = if most > 0.0 { least / most } else { 0.0 };
        let side = |k: f64| {
            let by_angle = self.angle / (k * (1.0 + 2.0 * both).sqrt());
            by_angle.min((8.0 * self.chord / (k * (1.0 + both))).sqrt()).min(self.side)
        };
        let sides = k.map(side);
        let short = sides[0].min(sides[1]);
        let [p, q] = sides.map(|x| x.min(MAX_ASPECT * short)).map(|x| 1.0 / (x * x));
        // The first principal axis by the cosine and sine of twice its angle.
        let (cos, sin) = if reach > 0.0 { (half / reach, b01 / reach) } else { (1.0, 0.0) };
        let (d00, d11) = (0.5 * (p + q + cos * (p - q)), 0.5 * (p + q - cos * (p - q)));
        let d01 = 0.5 * sin * (p - q);
        let uu = e * d00;
        let vv = c10 * c10 * d00 + 2.0 * c10 * c11 * d01 + c11 * c11 * d11;
        (uu.is_finite() && vv.is_finite()).then_some([uu, vv])
    }
}

/// The unit normal S_u x S_v and its length before normalisation; `None` if undefined.
pub fn unit_normal(s: &SurfJet<f64>) -> Option<(Vec3, f64)> {
    let n = s.u.cross(s.v);
    let size = n.norm();
    (size > NO_NORMAL * s.u.norm() * s.v.norm()).then(|| (n / size, size))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cylinder_is_divided_round_it() {
        // (2 cos u, 2 sin u, v) at u = 0.
        let (o, x, y, z) = (
            Vec3::zero(),
            Vec3::of(2.0, 0.0, 0.0),
            Vec3::of(0.0, 2.0, 0.0),
            Vec3::of(0.0, 0.0, 1.0),
        );
        let jet = SurfJet { p: x, u: y, v: z, uu: -x, uv: o, vv: o };
        let fineness = Fineness { angle: 0.1, chord: f64::INFINITY, side: f64::INFINITY };
        let [u, v] = fineness.metric(&jet).unwrap();
        assert!((u.sqrt() - 10.0).abs() < 1e-12 && (v.sqrt() - 1.0 / 1.2).abs() < 1e-12, "{u} {v}");
        assert!((fineness.along(jet.u, jet.uu, 0.0) - 10.0).abs() < 1e-12);
        // A chord of 0.02: sides of sqrt(8 * 0.02 * 2).
        let fineness = Fineness { angle: f64::INFINITY, chord: 0.02, side: f64::INFINITY };
        let [u, _] = fineness.metric(&jet).unwrap();
        assert!((u.sqrt() - 2.0 / 0.32f64.sqrt()).abs() < 1e-12, "{u}");
    }
}
