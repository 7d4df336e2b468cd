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

    /// The axes of an untyped picture, from the slopes of its strokes (du, dv): the three highest peaks
    /// of a length-weighted histogram (bins of 1°, Gaussian of 2°, peaks 10° apart), refined by the mean
    /// within 4°. The steepest is taken for Z, the flatter of the others for X. `None` when there are not
    /// three directions.
    pub fn cluster(strokes: &[[f64; 2]]) -> Option<Projection> {
        let polar: Vec<(f64, f64)> = (strokes.iter())
            .filter(|d| d[0] != 0.0 || d[1] != 0.0)
            .map(|d| {
                let angle = Real::atan2(d[1], d[0]).to_degrees().rem_euclid(180.0);
                (angle, Real::sqrt(d[0] * d[0] + d[1] * d[1]))
            })
            .collect();
        let apart = |a: f64, b: f64| (a - b + 90.0).rem_euclid(180.0) - 90.0;
        let mut height = [0.0; 180];
        for (k, h) in height.iter_mut().enumerate() {
            let centre = k as f64 + 0.5;
            for &(angle, length) in &polar {
                let z = apart(angle, centre) / 2.0;
                *h += length * Real::exp(-0.5 * z * z);
            }
        }
        let mut peaks: Vec<f64> = Vec::new();
        let mut order: Vec<usize> = (0..180).collect();
        order.sort_by(|&a, &b| height[b].total_cmp(&height[a]).then(a.cmp(&b)));
        for k in order {
            let (h, centre) = (height[k], k as f64 + 0.5);
            let highest = h > 0.0 && h >= height[(k + 179) % 180] && h >= height[(k + 1) % 180];
            if highest && peaks.len() < 3 && peaks.iter().all(|&p| apart(p, centre).abs() >= 10.0) {
                peaks.push(centre);
            }
        }
        if peaks.len() < 3 {
            return None;
        }
        for peak in &mut peaks {
            let near = polar.iter().filter(|(angle, _)| apart(*angle, *peak).abs() <= 4.0);
            let (sum, weight) = near.fold((0.0, 0.0), |(s, w), &(angle, length)| {
                (s + length * apart(angle, *peak), w + length)
            });
            if weight > 0.0 {
                *peak = (*peak + sum / weight).rem_euclid(180.0);
            }
        }
        peaks.sort_by(|a, b| apart(*a, 90.0).abs().total_cmp(&apart(*b, 90.0).abs()));
        let (up, mut sides) = (peaks[0], [peaks[1], peaks[2]]);
        sides.sort_by(|a, b| apart(*a, 0.0).abs().total_cmp(&apart(*b, 0.0).abs()));
        // Both ground axes point to the right.
        let right = |a: f64| if a > 90.0 { a + 180.0 } else { a };
        Some(Projection { angle_deg: [right(sides[0]), right(sides[1]), up], scale: [1.0; 3] })
    }
}
