//! The observation transformation: how space was drawn on the page.

use crate::CoordinateAxis;
use moldloft_num::{Real, Vec3};

/// The screen directions of the three axes, in degrees counter-clockwise from screen right, and the
/// length of a unit along each.
///
/// x' = Σ s cos(angle) · coordinate, y' = Σ s sin(angle) · coordinate (manual, observation
/// transformations; there with unit scales).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Screen angle of +X, +Y, +Z in degrees.
    pub angle_deg: [f64; 3],
    /// Screen length of a unit along X, Y, Z.
    pub scale: [f64; 3],
}

impl Default for Projection {
    fn default() -> Self {
        Projection::preset("TRIM")
            .unwrap_or(Projection { angle_deg: [345.0, 40.0, 90.0], scale: [1.0; 3] })
    }
}

/// Cosine and sine of an angle in degrees, exact at quarter turns.
fn direction(angle_deg: f64) -> [f64; 2] {
    let turn = angle_deg.rem_euclid(360.0);
    match turn {
        0.0 => [1.0, 0.0],
        90.0 => [0.0, 1.0],
        180.0 => [-1.0, 0.0],
        270.0 => [0.0, -1.0],
        _ => {
            let a = turn.to_radians();
            [Real::cos(a), Real::sin(a)]
        }
    }
}

impl Projection {
    /// The names of the presets.
    pub const PRESETS: [&'static str; 6] =
        ["ISO", "TRIM", "CAVALIER", "CABINET", "MILITARY", "DIN"];

    /// A common pictorial projection. `DIN` is the dimetric one of ISO 5456-3 (42°, 7°, depth halved).
    /// Beware of `ISO`: it draws (1, 0, 1) and (0, 1, 0) of a cube at the same spot.
    pub fn preset(name: &str) -> Option<Projection> {
        let (angle_deg, scale) = match name.to_ascii_uppercase().as_str() {
            "ISO" => ([330.0, 30.0, 90.0], [1.0; 3]),
            "TRIM" => ([345.0, 40.0, 90.0], [1.0; 3]),
            "CAVALIER" => ([0.0, 45.0, 90.0], [1.0; 3]),
            "CABINET" => ([0.0, 45.0, 90.0], [1.0, 0.5, 1.0]),
            "MILITARY" => ([315.0, 45.0, 90.0], [1.0; 3]),
            "DIN" => ([353.0, 42.0, 90.0], [1.0, 0.5, 1.0]),
            _ => return None,
        };
        Some(Projection { angle_deg, scale })
    }

    /// The axes of a cross section perpendicular to `normal`: the first of the two others to the
    /// right, the second up. The normal is drawn at 45°, for later extrusion.
    pub fn section(normal: CoordinateAxis) -> Projection {
        let mut angle_deg = [0.0, 90.0, 90.0];
        match normal {
            CoordinateAxis::X => angle_deg = [225.0, 0.0, 90.0],
            CoordinateAxis::Y => angle_deg[1] = 45.0,
            CoordinateAxis::Z => angle_deg = [0.0, 90.0, 225.0],
        }
        Projection { angle_deg, scale: [1.0; 3] }
    }

    /// Screen vector of a unit along `axis`.
    pub fn unit(&self, axis: CoordinateAxis) -> [f64; 2] {
        let k = axis.index();
        let [c, s] = direction(self.angle_deg[k]);
        [self.scale[k] * c, self.scale[k] * s]
    }

    /// Image of a point of space.
    pub fn project(&self, p: Vec3) -> [f64; 2] {
        let mut at = [0.0; 2];
        for axis in CoordinateAxis::ALL {
            let [c, s] = self.unit(axis);
            at[0] += c * p[axis.index()];
            at[1] += s * p[axis.index()];
        }
        at
    }

    /// The sight vector, on the side of `up`: its image is a single point. Two points have the same
    /// image if and only if their difference is parallel to it.
    pub fn sight(&self, up: CoordinateAxis) -> Vec3 {
        let [a, b, c] = CoordinateAxis::ALL.map(|axis| self.unit(axis));
        let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
        let n = Vec3::new(cross(b, c), cross(c, a), cross(a, b));
        if n[up.index()] < 0.0 { -n } else { n }
    }

    /// Inclination of a drawn vector to an axis: |d × a| / |d · a|; infinite if perpendicular.
    pub fn lean(&self, d: [f64; 2], axis: CoordinateAxis) -> f64 {
        let [c, s] = direction(self.angle_deg[axis.index()]);
        let along = (d[0] * c + d[1] * s).abs();
        let off = (d[0] * s - d[1] * c).abs();
        if along > 0.0 { off / along } else { f64::INFINITY }
    }
}
