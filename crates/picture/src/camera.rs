//! The camera: directions, projections and the fit of the scene into the picture.

use moldloft_num::{Box3, Vec3};

/// Direction of view; distance and aim follow from the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Direction from the model to the viewer about z, from x towards y, in degrees.
    pub azimuth_deg: f64,
    /// Height of the viewer above the horizon in degrees, -90 to 90.
    pub elevation_deg: f64,
    /// Full angle of view along the picture's height in degrees; `None` for parallel projection.
    pub view_angle_deg: Option<f64>,
}

impl Default for Camera {
    /// From ahead (low x), the side of low y and a little above, with slight perspective.
    fn default() -> Self {
        Self { azimuth_deg: -130.0, elevation_deg: 20.0, view_angle_deg: Some(18.0) }
    }
}

/// A point on the picture: pixels from the top left corner, and nearness, which grows towards the
/// viewer and is linear across every plane on the picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScreenPoint {
    pub x: f32,
    pub y: f32,
    pub near: f32,
}

/// A camera aimed at points.
pub(crate) struct Aimed {
    centre: Vec3,
    /// To the right, up, and towards the viewer.
    axes: [Vec3; 3],
    /// Distance from the viewer to the centre; `None` for parallel projection.
    distance: Option<f64>,
    /// Pixels per unit (parallel) or per unit of slope (perspective).
    scale: f64,
    /// Picture coordinates of the centre.
    middle: [f64; 2],
}

/// Part of the picture left free on each side.
const MARGIN: f64 = 0.06;

impl Aimed {
    /// Aims so that all points are seen and fill the picture of `width` x `height` pixels.
    pub fn at(camera: &Camera, points: &[Vec3], width: f64, height: f64) -> Self {
        let angles = [camera.azimuth_deg, camera.elevation_deg.clamp(-90.0, 90.0)];
        let [azimuth, elevation] = angles.map(f64::to_radians);
        let (sa, ca) = (libm::sin(azimuth), libm::cos(azimuth));
        let (se, ce) = (libm::sin(elevation), libm::cos(elevation));
        let axes = [
            Vec3::of(-sa, ca, 0.0),
            Vec3::of(-se * ca, -se * sa, ce),
            Vec3::of(ce * ca, ce * sa, se),
        ];
        let bounds = Box3::around(points.iter().copied());
        let size = bounds.diagonal();
        let mut aimed = Self {
            centre: bounds.centre(),
            axes,
            distance: None,
            scale: 1.0,
            middle: [0.5 * width, 0.5 * height],
        };
        let (w, h) = ((0.5 - MARGIN) * width, (0.5 - MARGIN) * height);
        match camera.view_angle_deg {
            None => {
                let [x0, x1, y0, y1] = aimed.extent(points);
                aimed.centre += axes[0] * (0.5 * (x0 + x1)) + axes[1] * (0.5 * (y0 + y1));
                let (x, y) = (0.5 * (x1 - x0), 0.5 * (y1 - y0));
                let scale = (w / x).min(h / y);
                aimed.scale = if scale.is_finite() { scale } else { 1.0 };
            }
            Some(angle) => {
                let half = 0.5 * angle.clamp(0.1, 150.0).to_radians();
                aimed.scale = 0.5 * height / libm::tan(half);
                // Perspective shifts the middle a little: aim, step back far enough, aim again.
                let step_back = |aimed: &Self| {
                    let reach = points.iter().map(|&p| {
                        let [x, y, z] = aimed.local(p);
                        // Never closer to any point than a twentieth of the model's size.
                        z + (aimed.scale * (x.abs() / w).max(y.abs() / h)).max(0.05 * size)
                    });
                    let distance = reach.fold(0.0, f64::max);
                    if distance > 0.0 { distance } else { 1.0 }
                };
                for _ in 0..4 {
                    let distance = step_back(&aimed);
                    aimed.distance = Some(distance);
                    let [x0, x1, y0, y1] = aimed.slopes(points);
                    aimed.centre += axes[0] * (0.5 * (x0 + x1) * distance)
                        + axes[1] * (0.5 * (y0 + y1) * distance);
                }
                aimed.distance = Some(step_back(&aimed));
            }
        }
        aimed
    }

    /// Coordinates along the axes from the centre.
    fn local(&self, p: Vec3) -> [f64; 3] {
        let d = p - self.centre;
        self.axes.map(|axis| axis.dot(d))
    }

    fn extent(&self, points: &[Vec3]) -> [f64; 4] {
        spread(points.iter().map(|&p| {
            let [x, y, _] = self.local(p);
            [x, y]
        }))
    }

    fn slopes(&self, points: &[Vec3]) -> [f64; 4] {
        let distance = self.distance.unwrap_or(1.0);
        spread(points.iter().map(|&p| {
            let [x, y, z] = self.local(p);
            [x / (distance - z), y / (distance - z)]
        }))
    }

    /// Position of a point in the picture.
    pub fn see(&self, p: Vec3) -> ScreenPoint {
        let [x, y, z] = self.local(p);
        let (factor, near) = match self.distance {
            None => (self.scale, z),
            // Nearness 1 / (depth / distance), which is linear on the picture.
            Some(d) => (self.scale / (d - z), d / (d - z)),
        };
        ScreenPoint {
            x: (self.middle[0] + x * factor) as f32,
            y: (self.middle[1] - y * factor) as f32,
            near: near as f32,
        }
    }

    /// Unit vector from a point to the viewer.
    pub fn towards(&self, p: Vec3) -> Vec3 {
        match self.distance {
            None => self.axes[2],
            Some(d) => (self.centre + self.axes[2] * d - p).normalized().unwrap_or(self.axes[2]),
        }
    }

    /// A direction seen from the camera: right, up, towards the viewer.
    pub fn turned(&self, v: Vec3) -> [f64; 3] {
        self.axes.map(|axis| axis.dot(v))
    }

    /// A direction given from the camera, in the model's axes.
    pub fn world(&self, [right, up, towards]: [f64; 3]) -> Vec3 {
        self.axes[0] * right + self.axes[1] * up + self.axes[2] * towards
    }
}

fn spread(points: impl Iterator<Item = [f64; 2]>) -> [f64; 4] {
    let start = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
    let b =
        points.fold(start, |[x0, x1, y0, y1], [x, y]| [x0.min(x), x1.max(x), y0.min(y), y1.max(y)]);
    if b[0] <= b[1] { b } else { [0.0; 4] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_is_seen_and_fills_the_picture() {
        let points: Vec<Vec3> = (0..200)
            .map(|k| {
                let t = k as f64 * 0.37;
                Vec3::of(30.0 * libm::sin(t), 5.0 * libm::cos(1.7 * t), 3.0 * libm::sin(2.3 * t))
            })
            .collect();
        for view_angle_deg in [None, Some(18.0), Some(60.0)] {
            for azimuth_deg in [0.0, -130.0, 90.0] {
                let camera = Camera { azimuth_deg, elevation_deg: 25.0, view_angle_deg };
                let aimed = Aimed::at(&camera, &points, 800.0, 500.0);
                let seen: Vec<ScreenPoint> = points.iter().map(|&p| aimed.see(p)).collect();
                let [x0, x1, y0, y1] = spread(seen.iter().map(|s| [s.x as f64, s.y as f64]));
                assert!(x0 > 40.0 && x1 < 760.0 && y0 > 25.0 && y1 < 475.0, "{x0} {x1} {y0} {y1}");
                assert!(x1 - x0 > 600.0 || y1 - y0 > 350.0, "{x0} {x1} {y0} {y1}");
            }
        }
    }
}
