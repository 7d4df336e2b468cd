//! Planes, cylinders, cones, spheres and tori: distances, angles, and identity of two of them.

use crate::SurfaceShape;
use moldloft_num::{Pace, Vec3};
use moldloft_spline::nurbs::Nurbs;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A point, the axis through it and the direction of angle 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceAxes {
    /// The point.
    pub origin: Vec3,
    /// The unit vector along the axis.
    pub z: Vec3,
    /// The unit vector of angle 0, across the axis.
    pub x: Vec3,
}

impl SurfaceAxes {
    /// Axes about a line, with any direction of angle 0.
    pub fn about(origin: Vec3, direction: Vec3) -> Self {
        let z = direction.normalized().unwrap_or(Vec3::of(0.0, 0.0, 1.0));
        Self { origin, z, x: z.perpendicular() }
    }

    /// The third axis.
    pub fn y(&self) -> Vec3 {
        self.z.cross(self.x)
    }

    /// Coordinates along the three axes.
    pub fn local(&self, p: Vec3) -> [f64; 3] {
        let d = p - self.origin;
        [d.dot(self.x), d.dot(self.y()), d.dot(self.z)]
    }

    /// The angle of a point about the axis, from -pi to pi.
    pub fn angle(&self, p: Vec3) -> f64 {
        let [x, y, _] = self.local(p);
        libm::atan2(y, x)
    }

    /// The distance from the axis and the unit vector away from it, if the point is not on it.
    fn away(&self, p: Vec3) -> (f64, Vec3) {
        let d = p - self.origin;
        let across = d - self.z * d.dot(self.z);
        (across.norm(), across.normalized().unwrap_or(self.x))
    }
}

impl SurfaceShape {
    /// The signed distance from the surface, positive where its normal points; from cones it is that of both their
    /// halves, from images it is right to first order. None for a NURBS.
    pub fn distance(&self, p: Vec3) -> Option<f64> {
        Some(match self {
            SurfaceShape::Plane { origin, normal, .. } => (p - *origin).dot(*normal),
            SurfaceShape::Cylinder { axes, radius } => axes.away(p).0 - radius,
            SurfaceShape::Sphere { axes, radius } => (p - axes.origin).norm() - radius,
            SurfaceShape::Cone { axes, radius, half_angle } => {
                let (sin, cos) = (libm::sin(*half_angle), libm::cos(*half_angle));
                let h = (p - axes.origin).dot(axes.z) + radius * cos / sin;
                axes.away(p).0 * cos - h.abs() * sin
            }
            SurfaceShape::Torus { axes, major, minor } => {
                let ring = axes.away(p).0 - major;
                let h = (p - axes.origin).dot(axes.z);
                (ring * ring + h * h).sqrt() - minor
            }
            SurfaceShape::Image(image) => return image.distance(p),
            SurfaceShape::Extruded(shape) => shape.distance(p),
            SurfaceShape::Nurbs(_) => return None,
        })
    }

    /// The gradient of [`SurfaceShape::distance`]: the unit normal at points of the surface.
    pub fn normal(&self, p: Vec3) -> Vec3 {
        match self {
            SurfaceShape::Plane { normal, .. } => *normal,
            SurfaceShape::Cylinder { axes, .. } => axes.away(p).1,
            SurfaceShape::Sphere { axes, .. } => (p - axes.origin).normalized().unwrap_or(axes.z),
            SurfaceShape::Cone { axes, radius, half_angle } => {
                let (sin, cos) = (libm::sin(*half_angle), libm::cos(*half_angle));
                let h = (p - axes.origin).dot(axes.z) + radius * cos / sin;
                axes.away(p).1 * cos - axes.z * if h < 0.0 { -sin } else { sin }
            }
            SurfaceShape::Torus { axes, major, .. } => {
                let out = axes.away(p).1;
                (p - axes.origin - out * *major).normalized().unwrap_or(out)
            }
            SurfaceShape::Image(image) => image.normal(p),
            SurfaceShape::Extruded(shape) => shape.normal(p),
            SurfaceShape::Nurbs(_) => Vec3::zero(),
        }
    }

    /// A point of the surface near another: the nearest one, of an image that of the nearest one to the coordinates.
    pub(crate) fn onto(&self, p: Vec3) -> Vec3 {
        if let SurfaceShape::Image(image) = self {
            return image.world(image.of().onto(image.local(p)));
        }
        p - self.normal(p) * self.distance(p).unwrap_or(0.0)
    }

    /// The axes of a surface of revolution.
    pub fn axes(&self) -> Option<&SurfaceAxes> {
        match self {
            SurfaceShape::Cylinder { axes, .. }
            | SurfaceShape::Cone { axes, .. }
            | SurfaceShape::Sphere { axes, .. }
            | SurfaceShape::Torus { axes, .. } => Some(axes),
            _ => None,
        }
    }

    /// This surface with other axes.
    pub(crate) fn with_axes(&self, with: SurfaceAxes) -> Self {
        let mut made = self.clone();
        match &mut made {
            SurfaceShape::Cylinder { axes, .. }
            | SurfaceShape::Cone { axes, .. }
            | SurfaceShape::Sphere { axes, .. }
            | SurfaceShape::Torus { axes, .. } => *axes = with,
            _ => {}
        }
        made
    }

    /// The image of a sphere with its axis along another direction; `None` for other surfaces.
    pub(crate) fn image_about(&self, z: Vec3) -> Option<Self> {
        let SurfaceShape::Image(image) = self else { return None };
        image.linear_back(z).normalized().and_then(|v| image.about(v))
    }

    /// The apex of a cone.
    pub fn apex(&self) -> Option<Vec3> {
        match self {
            SurfaceShape::Cone { axes, radius, half_angle } => {
                Some(axes.origin - axes.z * (radius / libm::tan(*half_angle)))
            }
            SurfaceShape::Image(image) => image.apex(),
            _ => None,
        }
    }

    /// True for one and the same set of points but for the tolerance, whichever side is solid; cones count with
    /// both halves.
    pub fn is_same(&self, o: &Self, tolerance: f64, size: f64) -> bool {
        let parallel = |a: Vec3, b: Vec3| a.cross(b).norm() * size <= tolerance;
        let near = |a: f64, b: f64| (a - b).abs() <= tolerance;
        let on_axis = |a: &SurfaceAxes, p: Vec3| a.away(p).0 <= tolerance;
        match (self, o) {
            (
                SurfaceShape::Plane { origin, normal, .. },
                SurfaceShape::Plane { origin: p, normal: n, .. },
            ) => parallel(*normal, *n) && near((*p - *origin).dot(*normal), 0.0),
            (
                SurfaceShape::Cylinder { axes, radius },
                SurfaceShape::Cylinder { axes: other, radius: r },
            ) => parallel(axes.z, other.z) && on_axis(axes, other.origin) && near(*radius, *r),
            (
                SurfaceShape::Sphere { axes, radius },
                SurfaceShape::Sphere { axes: other, radius: r },
            ) => axes.origin.distance(other.origin) <= tolerance && near(*radius, *r),
            (
                SurfaceShape::Cone { axes, half_angle, .. },
                SurfaceShape::Cone { half_angle: a, axes: b, .. },
            ) => {
                let apexes = self.apex().zip(o.apex());
                parallel(axes.z, b.z)
                    && near(half_angle * size, a * size)
                    && apexes.is_some_and(|(p, q)| p.distance(q) <= tolerance)
            }
            (
                SurfaceShape::Torus { axes, major, minor },
                SurfaceShape::Torus { axes: other, major: r, minor: t },
            ) => {
                let one = axes.origin.distance(other.origin) <= tolerance;
                one && parallel(axes.z, other.z) && near(*major, *r) && near(*minor, *t)
            }
            (SurfaceShape::Image(a), SurfaceShape::Image(b)) => a.is_same(b, tolerance),
            (SurfaceShape::Extruded(a), SurfaceShape::Extruded(b)) => a.is_same(b, tolerance, size),
            _ => false,
        }
    }

    /// A surface of revolution as a NURBS, u round its axis; of cylinders, cones and extruded curves the part between two
    /// heights.
    pub fn nurbs(&self, heights: [f64; 2]) -> Option<Nurbs<2>> {
        let (x, y) = (Vec3::of(1.0, 0.0, 0.0), Vec3::of(0.0, 0.0, 1.0));
        let line = |radius: [f64; 2]| Nurbs {
            degrees: [1],
            knots: [vec![0.0, 0.0, 1.0, 1.0]],
            points: [0, 1].map(|k| Vec3::of(radius[k], 0.0, heights[k])).into(),
            weights: Some(vec![1.0; 2]),
            error: 0.0,
            exact: true,
            paces: [Pace::Even],
        };
        let profile = match self {
            SurfaceShape::Cylinder { radius, .. } => line([*radius; 2]),
            SurfaceShape::Cone { radius, half_angle, .. } => {
                line(heights.map(|h| (radius + h * libm::tan(*half_angle)).max(0.0)))
            }
            SurfaceShape::Sphere { radius, .. } => {
                arc(Vec3::zero(), x * *radius, y * *radius, -FRAC_PI_2, PI)
            }
            SurfaceShape::Torus { major, minor, .. } => {
                arc(x * *major, x * *minor, y * *minor, 0.0, TAU)
            }
            SurfaceShape::Image(image) => return image.nurbs(heights),
            SurfaceShape::Extruded(shape) => return Some(shape.nurbs(heights)),
            _ => return None,
        };
        let axes = self.axes()?;
        let round = arc(Vec3::zero(), axes.x, axes.y(), 0.0, TAU);
        let weights = |n: &Nurbs<1>| n.weights.clone().unwrap_or_default();
        let (mut points, mut all) = (Vec::new(), Vec::new());
        for (r, w) in round.points.iter().zip(weights(&round)) {
            for (p, v) in profile.points.iter().zip(weights(&profile)) {
                points.push(axes.origin + *r * p.x + axes.z * p.z);
                all.push(w * v);
            }
        }
        let [knots_u, knots_v] = [round.knots, profile.knots].map(|[k]| k);
        Some(Nurbs {
            degrees: [2, profile.degrees[0]],
            knots: [knots_u, knots_v],
            points,
            weights: Some(all),
            error: 0.0,
            exact: true,
            paces: [Pace::Even; 2],
        })
    }
}

/// A part of an ellipse as rational arcs of 90 degrees at most (Piegl and Tiller 1997, 7.3).
pub(crate) fn arc(centre: Vec3, x: Vec3, y: Vec3, start: f64, sweep: f64) -> Nurbs<1> {
    let pieces = (sweep / FRAC_PI_2 - 1e-9).ceil().max(1.0);
    let half = 0.5 * sweep / pieces;
    let w = libm::cos(half);
    let at = |t: f64, s: f64| centre + (x * libm::cos(t) + y * libm::sin(t)) / s;
    let (mut points, mut weights, mut knots) = (vec![at(start, 1.0)], vec![1.0], vec![0.0; 3]);
    for k in 0..pieces as usize {
        let t = start + 2.0 * half * k as f64;
        points.extend([at(t + half, w), at(t + 2.0 * half, 1.0)]);
        weights.extend([w, 1.0]);
        knots.extend([(k + 1) as f64 / pieces; 2]);
    }
    knots.push(1.0);
    Nurbs {
        degrees: [2],
        knots: [knots],
        points,
        weights: Some(weights),
        error: 0.0,
        exact: true,
        paces: [Pace::Even],
    }
}
