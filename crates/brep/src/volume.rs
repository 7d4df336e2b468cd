//! The volume that faces enclose, by integrals along their edges.
//!
//! The flux of p/3 out of a face is (O . S + D)/3 about a point O: S is its vector area, by Stokes half the integral
//! of p x dp along its border, and D the integral of (p - O) . n, which is zero on planes and on cones about their apex, the
//! radius times the area on cylinders and spheres, an integral over both angles on tori, and one over the parameter on extruded curves.

use crate::{Brep, BrepFace, Coedge, SurfaceAxes, SurfaceImage, SurfaceShape};
use moldloft_num::Vec3;
use std::f64::consts::{PI, TAU};

/// Steps of the integral along a part of an edge; refined to twice and four times as many.
const STEPS: usize = 16;
/// Maximum deviation of a winding number from an integer.
const WHOLE: f64 = 1e-3;

/// A volume with an estimate of the error of its integrals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrepVolume {
    /// The volume.
    pub volume: f64,
    /// Error of the integrals along the edges. The error of the edges themselves is [`Brep::gap`]
    /// times the area.
    pub error: f64,
}

/// Integrals along a loop: of p x dp / 2, of a weight by the angle about the axis, and the angle
/// itself; and the change of the angle of the tube.
#[derive(Clone, Copy, Default)]
struct LoopIntegrals {
    area: Vec3,
    weighted: f64,
    angle: f64,
    tube: f64,
    error: f64,
}

/// Integrand about the axis, by the local coordinates of a point and the angle of the tube.
type Weight<'a> = &'a dyn Fn([f64; 3], f64) -> f64;

fn turn(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1])
}

/// Romberg's table of three rows: the value of sums of steps of four, two and one, and its error.
pub(crate) fn romberg(coarse: f64, middle: f64, fine: f64) -> (f64, f64) {
    let two = |f: f64, c: f64| f + (f - c) / 3.0;
    let (b, a) = (two(fine, middle), two(middle, coarse));
    (b + (b - a) / 15.0, (b - a).abs() / 15.0)
}

/// The integrals along points on a smooth curve: of one step between neighbours, of two and of four.
fn along(
    points: &[Vec3],
    origin: Vec3,
    axes: &SurfaceAxes,
    ring: f64,
    tube: &mut f64,
    weight: Weight,
) -> LoopIntegrals {
    let local: Vec<[f64; 3]> = points.iter().map(|p| axes.local(*p)).collect();
    // The tube's angle as it grows along the points.
    let direction = |q: &[f64; 3]| [libm::hypot(q[0], q[1]) - ring, q[2]];
    let mut angles = vec![*tube];
    for pair in local.windows(2) {
        *tube += turn(direction(&pair[0]), direction(&pair[1]));
        angles.push(*tube);
    }
    let size = local.iter().map(|q| libm::hypot(q[0], q[1])).fold(0.0, f64::max);
    let by = |stride: usize| {
        let (mut area, mut weighted, mut angle) = (Vec3::zero(), 0.0, 0.0);
        for k in (stride..points.len()).step_by(stride) {
            let (i, j) = (k - stride, k);
            area += (points[i] - origin).cross(points[j] - origin) * 0.5;
            let (p, q) = (local[i], local[j]);
            // At a pole there is no angle.
            if libm::hypot(p[0], p[1]).min(libm::hypot(q[0], q[1])) > 1e-9 * size {
                let by = turn([p[0], p[1]], [q[0], q[1]]);
                angle += by;
                weighted += 0.5 * by * (weight(p, angles[i]) + weight(q, angles[j]));
            }
        }
        (area, weighted, angle)
    };
    let (coarse, middle, fine) = (by(4), by(2), by(1));
    let parts = [0, 1, 2].map(|k| romberg(coarse.0[k], middle.0[k], fine.0[k]));
    let (weighted, off) = romberg(coarse.1, middle.1, fine.1);
    let error = off + size.max(ring) * parts.iter().map(|p| p.1).sum::<f64>();
    let area = Vec3::from(parts.map(|p| p.0));
    LoopIntegrals { area, weighted, angle: fine.2, tube: 0.0, error }
}

impl Brep {
    fn loop_integrals(
        &self,
        cycle: &[Coedge],
        origin: Vec3,
        axes: &SurfaceAxes,
        ring: f64,
        weight: Weight,
    ) -> LoopIntegrals {
        let mut sum = LoopIntegrals::default();
        let mut tube: Option<f64> = None;
        let mut first = 0.0;
        for side in cycle {
            let curve = &self.edges[side.edge].curve;
            let mut knots = curve.knots[0].clone();
            knots.dedup();
            let spans: Vec<[f64; 2]> = knots.windows(2).map(|w| [w[0], w[1]]).collect();
            let order: Vec<usize> = match side.forward {
                true => (0..spans.len()).collect(),
                false => (0..spans.len()).rev().collect(),
            };
            for k in order {
                let [a, b] = spans[k];
                let n = 4 * STEPS;
                let ts = (0..=n).map(|i| a + (b - a) * i as f64 / n as f64).collect();
                let mut points = curve.grid(&[ts]);
                if !side.forward {
                    points.reverse();
                }
                let q = axes.local(points[0]);
                let mut at = *tube.get_or_insert_with(|| {
                    first = libm::atan2(q[2], libm::hypot(q[0], q[1]) - ring);
                    first
                });
                let part = along(&points, origin, axes, ring, &mut at, weight);
                tube = Some(at);
                sum.area += part.area;
                sum.weighted += part.weighted;
                sum.angle += part.angle;
                sum.error += part.error;
            }
        }
        sum.tube = tube.map_or(0.0, |t| t - first);
        sum
    }

    /// Three times the flux of p/3 through a face along its surface's normal, about a point, with its error.
    fn flux(&self, face: &BrepFace, about: Vec3) -> Option<(f64, f64)> {
        if let SurfaceShape::Image(image) = &face.surface {
            return self.flux_of_image(face, image, about);
        }
        if let SurfaceShape::Extruded(shape) = &face.surface {
            return Some(shape.flux(self, face, about));
        }
        let plain =
            SurfaceAxes { origin: about, z: Vec3::of(0.0, 0.0, 1.0), x: Vec3::of(1.0, 0.0, 0.0) };
        let axes = face.surface.axes().unwrap_or(&plain);
        let height = |q: [f64; 3], _: f64| q[2];
        // The integral of (M cos + m)(M + m cos) m over the tube's angle.
        let tube = |m: f64, n: f64, angle: f64| {
            let (s, c) = libm::sincos(angle);
            n * ((m * m + n * n) * s + m * n * (0.5 * (angle + s * c) + angle))
        };
        let (ring, weight): (f64, Box<dyn Fn([f64; 3], f64) -> f64>) = match &face.surface {
            SurfaceShape::Torus { major, minor, .. } => {
                let (m, n) = (*major, *minor);
                (m, Box::new(move |_, angle| tube(m, n, angle)))
            }
            SurfaceShape::Cylinder { .. } | SurfaceShape::Sphere { .. } => (0.0, Box::new(height)),
            _ => (0.0, Box::new(|_, _| 0.0)),
        };
        let sense = if face.reversed { -1.0 } else { 1.0 };
        let (mut area, mut weighted, mut angle, mut error) = (Vec3::zero(), 0.0, 0.0, 0.0);
        for cycle in &face.loops {
            let part = self.loop_integrals(cycle, axes.origin, axes, ring, &*weight);
            let closed = part.angle.abs() < WHOLE && part.tube.abs() < WHOLE;
            if matches!(face.surface, SurfaceShape::Torus { .. }) && !closed {
                return None;
            }
            area += part.area * sense;
            weighted -= part.weighted * sense;
            angle += part.angle * sense;
            error += part.error;
        }
        let winding = (angle / TAU).round();
        let about_axis =
            matches!(face.surface, SurfaceShape::Cylinder { .. } | SurfaceShape::Sphere { .. });
        if about_axis && (angle / TAU - winding).abs() > WHOLE {
            return None;
        }
        let from = |origin: Vec3| (origin - about).dot(area);
        let whole = |value: f64, scale: f64| Some((value, error * scale));
        match &face.surface {
            SurfaceShape::Plane { origin, .. } => whole(from(*origin), 1.0),
            SurfaceShape::Cone { axes, radius, half_angle } => {
                whole(from(axes.origin - axes.z * (radius / libm::tan(*half_angle))), 1.0)
            }
            SurfaceShape::Cylinder { axes, radius } => {
                let across = radius * weighted;
                (winding == 0.0).then_some(())?;
                whole(from(axes.origin) + radius * across, radius * radius)
            }
            SurfaceShape::Sphere { axes, radius } => {
                let (all, cap) = (4.0 * PI * radius * radius, TAU * radius * radius);
                // A face with one pole includes the area up to it; one with both or none has the
                // positive value.
                let known = radius * weighted + cap * winding.abs();
                let surface = match winding == 0.0 && known <= 1e-9 * all {
                    true => known + all,
                    false => known,
                };
                let sound = winding.abs() <= 1.0 && surface > 0.0 && surface <= all * (1.0 + 1e-9);
                sound.then_some(())?;
                whole(from(axes.origin) + radius * surface, radius * radius)
            }
            SurfaceShape::Torus { axes, .. } => whole(from(axes.origin) + weighted, 1.0),
            SurfaceShape::Image(_) | SurfaceShape::Extruded(_) | SurfaceShape::Nurbs(_) => None,
        }
    }

    /// The flux through the image of a face: cones over parts of a surface, from the image's centre, are those over the parts
    /// that they are images of, enlarged.
    fn flux_of_image(
        &self,
        face: &BrepFace,
        image: &SurfaceImage,
        about: Vec3,
    ) -> Option<(f64, f64)> {
        let mut edges = Vec::new();
        let mut loops = face.loops.clone();
        for side in loops.iter_mut().flatten() {
            let mut edge = self.edges[side.edge].clone();
            edge.curve.points.iter_mut().for_each(|p| *p = image.local(*p));
            side.edge = edges.len();
            edges.push(edge);
        }
        let local = BrepFace { surface: image.of().clone(), loops, ..face.clone() };
        let made = Self { edges, ..Self::default() };
        let (own, error) = made.flux(&local, Vec3::zero())?;
        let scale = image.volume_scale();
        // The vector area of the face, from that of the preimage.
        let axes = SurfaceAxes {
            origin: Vec3::zero(),
            z: Vec3::of(0.0, 0.0, 1.0),
            x: Vec3::of(1.0, 0.0, 0.0),
        };
        let (mut area, mut off) = (Vec3::zero(), 0.0);
        for cycle in &local.loops {
            let part = made.loop_integrals(cycle, Vec3::zero(), &axes, 0.0, &|_, _| 0.0);
            area += part.area * if face.reversed { -1.0 } else { 1.0 };
            off += part.error;
        }
        let from = image.linear_back(image.world(Vec3::zero()) - about);
        Some((scale * (own + from.dot(area)), scale * (error + from.norm() * off)))
    }

    /// The volume enclosed by all faces, which must be oriented out of the material; `None` if a
    /// face is a NURBS, encircles an axis so that its border does not determine the part of the
    /// surface, or has an edge through a pole.
    pub fn volume(&self) -> Option<BrepVolume> {
        let about = self.vertices.first().copied().unwrap_or_default();
        let (mut volume, mut error) = (0.0, 0.0);
        for face in &self.faces {
            let (flux, off) = self.flux(face, about)?;
            volume += if face.reversed { -flux } else { flux } / 3.0;
            error += off / 3.0;
        }
        Some(BrepVolume { volume, error })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LabelledFacets;

    /// Triangles of a profile (radius, height) rotated about an axis; seen from outside, its sides
    /// go upwards. A profile that is not closed begins and ends on the axis.
    fn turned(
        profile: &[[f64; 2]],
        labels: &[u32],
        surfaces: Vec<SurfaceShape>,
        closed: bool,
    ) -> Brep {
        const ROUND: usize = 48;
        let axes = axes();
        let mut positions = Vec::new();
        let mut number = Vec::new();
        for [r, h] in profile {
            let ring: Vec<u32> = (0..ROUND)
                .map(|k| {
                    if k > 0 && *r == 0.0 {
                        return positions.len() as u32 - 1;
                    }
                    let (s, c) = libm::sincos(TAU * (k as f64 + 0.37) / ROUND as f64);
                    positions
                        .push(axes.origin + axes.x * (r * c) + axes.y() * (r * s) + axes.z * *h);
                    positions.len() as u32 - 1
                })
                .collect();
            number.push(ring);
        }
        let (mut triangles, mut of) = (Vec::new(), Vec::new());
        let n = profile.len();
        for i in 0..if closed { n } else { n - 1 } {
            for k in 0..ROUND {
                let (low, high) = (&number[i], &number[(i + 1) % n]);
                let [a, b, c, d] = [low[k], low[(k + 1) % ROUND], high[(k + 1) % ROUND], high[k]];
                for t in [[a, b, c], [a, c, d]] {
                    if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
                        triangles.push(t);
                        of.push(labels[i]);
                    }
                }
            }
        }
        let count = surfaces.len();
        let facets = LabelledFacets {
            positions,
            triangles,
            labels: of,
            surfaces: surfaces.into_iter().map(Some).collect(),
            names: (0..count).map(|k| format!("face {k}")).collect(),
            colours: vec![None; count],
            layers: vec![Vec::new(); count],
            step: 0.2,
            certain: true,
        };
        let mut brep = Brep::default();
        brep.add_facets(facets, 1e-6, 4.0).unwrap();
        brep
    }

    fn axes() -> SurfaceAxes {
        SurfaceAxes::about(Vec3::of(3.0, -1.0, 2.0), Vec3::of(0.3, 0.5, 0.8))
    }

    fn plane(height: f64, up: bool) -> SurfaceShape {
        let a = axes();
        let normal = if up { a.z } else { a.z * -1.0 };
        SurfaceShape::Plane { origin: a.origin + a.z * height, normal, axis: a.x }
    }

    fn arc(radius: f64, centre: [f64; 2], from: f64, to: f64, n: usize) -> Vec<[f64; 2]> {
        let at = |k: usize| {
            let (s, c) = libm::sincos(from + (to - from) * k as f64 / n as f64);
            let on_axis = (centre[0] + radius * c).abs() < 1e-12;
            [if on_axis { 0.0 } else { centre[0] + radius * c }, centre[1] + radius * s]
        };
        (0..=n).map(at).collect()
    }

    fn is(brep: &Brep, exact: f64, name: &str) {
        let found = brep.volume().unwrap_or_else(|| panic!("{name}: no volume"));
        assert!(
            (found.volume - exact).abs() < 1e-7 * exact.abs(),
            "{name}: {found:?}, not {exact}"
        );
        assert!(found.error < 1e-6 * exact.abs(), "{name}: {found:?}");
    }

    #[test]
    fn turned_bodies_have_the_volumes_of_their_formulas() {
        let a = axes();
        let bar = SurfaceShape::Cylinder { axes: a, radius: 1.2 };
        let profile = [[0.0, -1.0], [1.2, -1.0], [1.2, 0.0], [1.2, 1.5], [0.0, 1.5]];
        let surfaces = vec![plane(-1.0, false), bar, plane(1.5, true)];
        is(&turned(&profile, &[0, 1, 1, 2], surfaces, false), PI * 1.44 * 2.5, "bar");

        let cone = SurfaceShape::Cone { axes: a, radius: 0.0, half_angle: 0.5 };
        let r = 1.5 * libm::tan(0.5);
        let profile = [[0.0, 0.0], [0.5 * r, 0.75], [r, 1.5], [0.0, 1.5]];
        let exact = PI * r * r * 1.5 / 3.0;
        is(&turned(&profile, &[0, 0, 1], vec![cone, plane(1.5, true)], false), exact, "cone");

        let ball = || SurfaceShape::Sphere { axes: a, radius: 1.3 };
        let profile = arc(1.3, [0.0, 0.0], -0.5 * PI, 0.5 * PI, 24);
        let all = 4.0 / 3.0 * PI * 1.3f64.powi(3);
        is(&turned(&profile, &[0; 24], vec![ball()], false), all, "ball");

        for cut in [-0.9, -0.2, 0.4, 1.1f64] {
            let mut profile = arc(1.3, [0.0, 0.0], -0.5 * PI, libm::asin(cut / 1.3), 24);
            profile.push([0.0, cut]);
            let mut labels = vec![0; 24];
            labels.push(1);
            let h = 1.3 + cut;
            let exact = PI * h * h * (1.3 - h / 3.0);
            is(&turned(&profile, &labels, vec![ball(), plane(cut, true)], false), exact, "cap");
        }

        let ring = || SurfaceShape::Torus { axes: a, major: 2.0, minor: 0.5 };
        let mut profile = arc(0.5, [2.0, 0.0], 0.0, TAU, 24);
        profile.pop();
        let exact = 2.0 * PI * PI * 2.0 * 0.25;
        is(&turned(&profile, &[0; 24], vec![ring()], true), exact, "ring");

        let t = libm::asin(0.2 / 0.5);
        let profile = arc(0.5, [2.0, 0.0], t, PI - t, 24);
        let mut labels = vec![0; 24];
        labels.push(1);
        let surfaces = vec![ring(), plane(0.2, false)];
        is(&turned(&profile, &labels, surfaces, true), 2.490_257_008_987_22, "half a ring");
    }
}
