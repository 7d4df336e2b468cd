//! Lines, circles, ellipses and plane cubics in which two surfaces meet or touch.

use crate::extruded::{near_cubic, plane_of};
use crate::{SurfaceAxes, SurfaceImage, SurfaceShape};
use moldloft_num::Vec3;

/// A line, an ellipse, or a plane cubic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ExactCurve {
    /// A line through a point.
    Line {
        /// The point.
        point: Vec3,
        /// Its unit direction.
        direction: Vec3,
    },
    /// An ellipse: centre + x cos(t) + y sin(t).
    Ellipse {
        /// Centre.
        centre: Vec3,
        /// A semi-axis.
        x: Vec3,
        /// The other semi-axis.
        y: Vec3,
    },
    /// A plane cubic in Bézier form.
    Cubic([Vec3; 4]),
}

impl ExactCurve {
    /// A circle.
    pub fn circle(centre: Vec3, normal: Vec3, radius: f64) -> Self {
        let axes = SurfaceAxes::about(centre, normal);
        Self::Ellipse { centre, x: axes.x * radius, y: axes.y() * radius }
    }

    /// The approximate angle of the point of an ellipse nearest to a point; 0 for other curves.
    pub fn angle(&self, p: Vec3) -> f64 {
        match self {
            Self::Line { .. } | Self::Cubic(_) => 0.0,
            Self::Ellipse { centre, x, y } => {
                let d = p - *centre;
                libm::atan2(d.dot(*y) / y.norm_sq(), d.dot(*x) / x.norm_sq())
            }
        }
    }

    /// A point of the curve near another.
    pub fn near(&self, p: Vec3) -> Vec3 {
        match self {
            Self::Line { point, direction } => *point + *direction * (p - *point).dot(*direction),
            Self::Ellipse { centre, x, y } => {
                let t = self.angle(p);
                *centre + *x * libm::cos(t) + *y * libm::sin(t)
            }
            Self::Cubic(points) => near_cubic(points, p),
        }
    }

    /// Planes through the curve: two for a line, one for another curve.
    pub fn planes(&self, normal: Vec3) -> Vec<SurfaceShape> {
        let plane = |origin: Vec3, normal: Vec3| SurfaceShape::Plane {
            origin,
            normal,
            axis: normal.perpendicular(),
        };
        match self {
            Self::Line { point, direction } => {
                let Some(n) = (normal - *direction * normal.dot(*direction)).normalized() else {
                    return Vec::new();
                };
                vec![plane(*point, n), plane(*point, direction.cross(n))]
            }
            Self::Ellipse { centre, x, y } => {
                x.cross(*y).normalized().map(|n| plane(*centre, n)).into_iter().collect()
            }
            Self::Cubic(points) => {
                plane_of(points).map(|n| plane(points[0], n)).into_iter().collect()
            }
        }
    }
}

/// A piece of the profile of a surface of revolution, in (distance from the axis, height).
enum ProfilePiece {
    Line([f64; 2], [f64; 2]),
    Circle([f64; 2], f64),
}

/// The intersection of two surfaces, if it consists of lines, circles, ellipses or plane cubics; empty for
/// other curves.
pub fn meet(a: &SurfaceShape, b: &SurfaceShape, tolerance: f64, size: f64) -> Vec<ExactCurve> {
    use SurfaceShape::{Cone, Cylinder, Extruded, Image, Plane, Sphere, Torus};
    let parallel = |u: Vec3, v: Vec3| u.cross(v).norm() * size <= tolerance;
    let near = |u: f64, v: f64| (u - v).abs() <= tolerance;
    if let (Plane { origin, normal, .. }, Plane { origin: o, normal: n, .. }) = (a, b) {
        let Some(direction) = normal.cross(*n).normalized() else { return Vec::new() };
        let point = on_planes([*normal, *n, direction], [*origin, *o, *origin]);
        return point.map(|point| ExactCurve::Line { point, direction }).into_iter().collect();
    }
    match (a, b) {
        (Extruded(shape), other) | (other, Extruded(shape)) => {
            return shape.meet(other, tolerance, size);
        }
        (Image(image), Plane { origin, normal, .. })
        | (Plane { origin, normal, .. }, Image(image)) => {
            return plane_image(*origin, *normal, image, tolerance, size);
        }
        (Image(image), other) | (other, Image(image)) => {
            return turned_image(image, other, tolerance, size);
        }
        _ => {}
    }
    if let Some((origin, z)) = common_axis(a, b, tolerance, size) {
        return coaxial([a, b], origin, z, tolerance);
    }
    match (a, b) {
        (Plane { .. }, Cylinder { .. } | Cone { .. } | Torus { .. }) => {
            let Plane { origin, normal, .. } = a else { return Vec::new() };
            match b {
                Cylinder { axes, radius } => {
                    plane_cylinder(*origin, *normal, axes, *radius, tolerance, size)
                }
                Cone { half_angle, .. } => {
                    plane_cone(*origin, *normal, b, *half_angle, tolerance, size)
                }
                Torus { axes, major, minor } => {
                    let through = near((axes.origin - *origin).dot(*normal), 0.0);
                    if !through || (axes.z.dot(*normal) * size).abs() > tolerance {
                        return Vec::new();
                    }
                    let along = normal.cross(axes.z);
                    [-*major, *major]
                        .map(|r| ExactCurve::circle(axes.origin + along * r, *normal, *minor))
                        .into()
                }
                _ => Vec::new(),
            }
        }
        (Cylinder { .. } | Cone { .. } | Torus { .. }, Plane { .. }) => meet(b, a, tolerance, size),
        (Cylinder { axes, radius }, Cylinder { axes: o, radius: r }) => {
            if parallel(axes.z, o.z) {
                return parallel_cylinders([axes, o], [*radius, *r], tolerance);
            }
            crossed_cylinders([axes, o], [*radius, *r], tolerance, size)
        }
        (Cylinder { axes, radius }, Torus { axes: ring, major, minor }) => {
            // A straight pipe continued by a bent one.
            let foot = axes.origin + axes.z * (ring.origin - axes.origin).dot(axes.z);
            let level = near((foot - ring.origin).dot(ring.z), 0.0);
            let across = (axes.z.dot(ring.z) * size).abs() <= tolerance;
            let tangent = near(foot.distance(ring.origin), *major);
            if level && across && tangent && near(*radius, *minor) {
                return vec![ExactCurve::circle(foot, axes.z, *radius)];
            }
            Vec::new()
        }
        (Sphere { axes, radius }, Torus { axes: ring, major, minor }) => {
            let d = axes.origin - ring.origin;
            let level = near(d.dot(ring.z), 0.0);
            if level && near(d.norm(), *major) && near(*radius, *minor) {
                return vec![ExactCurve::circle(axes.origin, ring.z.cross(d), *radius)];
            }
            Vec::new()
        }
        (Torus { .. }, Cylinder { .. } | Sphere { .. }) => meet(b, a, tolerance, size),
        (Torus { axes, major, minor }, Torus { axes: o, major: r, minor: t })
            if near(*minor, *t) =>
        {
            touching_tori([axes, o], [*major, *r], *minor, tolerance, size)
        }
        _ => Vec::new(),
    }
}

/// The ellipses of two equal cylinders whose axes meet.
fn crossed_cylinders(
    [axes, o]: [&SurfaceAxes; 2],
    [radius, r]: [f64; 2],
    tolerance: f64,
    size: f64,
) -> Vec<ExactCurve> {
    let near = |u: f64, v: f64| (u - v).abs() <= tolerance;
    let normal = axes.z.cross(o.z).normalized().unwrap_or_default();
    if !near(radius, r) || !near((o.origin - axes.origin).dot(normal), 0.0) {
        return Vec::new();
    }
    let Some(centre) = on_planes(
        [normal, normal.cross(axes.z), normal.cross(o.z)],
        [axes.origin, axes.origin, o.origin],
    ) else {
        return Vec::new();
    };
    let planes = [axes.z - o.z, axes.z + o.z].map(|n| n.normalized());
    let cut = |n: Vec3| plane_cylinder(centre, n, axes, radius, tolerance, size);
    planes.into_iter().flatten().flat_map(cut).collect()
}

/// The circles of two bends of a pipe: their rings touch where the line of both planes touches them.
fn touching_tori(
    [axes, o]: [&SurfaceAxes; 2],
    [major, r]: [f64; 2],
    minor: f64,
    tolerance: f64,
    size: f64,
) -> Vec<ExactCurve> {
    let near = |u: f64, v: f64| (u - v).abs() <= tolerance;
    let mut made = Vec::new();
    let mut touch = |p: Vec3, direction: Vec3| {
        let on = near(p.distance(axes.origin), major) && near(p.distance(o.origin), r);
        if on {
            made.push(ExactCurve::circle(p, direction, minor));
        }
    };
    if axes.z.cross(o.z).norm() * size <= tolerance {
        if let Some(d) = (o.origin - axes.origin).normalized() {
            touch(axes.origin + d * major, axes.z.cross(d));
            touch(axes.origin - d * major, axes.z.cross(d));
        }
    } else if let Some(d) = axes.z.cross(o.z).normalized()
        && let Some(p) = on_planes([axes.z, o.z, d], [axes.origin, o.origin, axes.origin])
    {
        touch(p, d);
    }
    made
}

/// The intersection of an image surface with a plane, as the image of that of the originals.
fn plane_image(
    origin: Vec3,
    normal: Vec3,
    image: &SurfaceImage,
    tolerance: f64,
    size: f64,
) -> Vec<ExactCurve> {
    let Some(back) = image.normal_back(normal) else { return Vec::new() };
    let origin = image.local(origin);
    let plane = SurfaceShape::Plane { origin, normal: back, axis: back.perpendicular() };
    let scale = image.scale();
    let found = meet(&plane, image.of(), tolerance / scale, size / scale);
    let mapped = |curve: ExactCurve| match curve {
        ExactCurve::Line { point, direction } => {
            let direction = image.linear(direction).normalized()?;
            Some(ExactCurve::Line { point: image.world(point), direction })
        }
        ExactCurve::Ellipse { centre, x, y } => {
            let [x, y] = principal(image.linear(x), image.linear(y));
            Some(ExactCurve::Ellipse { centre: image.world(centre), x, y })
        }
        ExactCurve::Cubic(_) => None,
    };
    found.into_iter().filter_map(mapped).collect()
}

/// The semi-axes of an ellipse with these conjugate half diameters.
fn principal(x: Vec3, y: Vec3) -> [Vec3; 2] {
    let (d, e) = (x.norm_sq() - y.norm_sq(), 2.0 * x.dot(y));
    if e.abs() <= 1e-15 * (x.norm_sq() + y.norm_sq()) {
        return [x, y];
    }
    let (s, c) = libm::sincos(0.5 * libm::atan2(e, d));
    [x * c + y * s, y * c - x * s]
}

/// The square of the radius of a surface of revolution as a polynomial of the height along an axis, if it is one about that
/// axis.
fn squared_profile(s: &SurfaceShape, origin: Vec3, z: Vec3, near: [f64; 2]) -> Option<[f64; 3]> {
    let [tolerance, size] = near;
    let height = |p: Vec3| (p - origin).dot(z);
    let on_axis = |p: Vec3| (p - origin - z * height(p)).norm() <= tolerance;
    let along = |v: Vec3| v.cross(z).norm() * size <= tolerance * v.norm();
    // k2 (h - h0)^2 + k0.
    let about = |k2: f64, h: f64, k0: f64| Some([k0 + k2 * h * h, -2.0 * k2 * h, k2]);
    match s {
        SurfaceShape::Sphere { axes, radius } if on_axis(axes.origin) => {
            about(-1.0, height(axes.origin), radius * radius)
        }
        SurfaceShape::Cylinder { axes, radius } if on_axis(axes.origin) && along(axes.z) => {
            Some([radius * radius, 0.0, 0.0])
        }
        SurfaceShape::Cone { half_angle, axes, .. } if along(axes.z) => {
            let apex = s.apex().filter(|p| on_axis(*p))?;
            let steep = libm::tan(*half_angle);
            about(steep * steep, height(apex), 0.0)
        }
        SurfaceShape::Image(image) => {
            let own = image.of().axes()?;
            let [x, y, up] = [own.x, own.y(), own.z].map(|v| image.linear(v));
            let (a, b) = (x.norm(), y.norm());
            let round = (a - b).abs() <= tolerance && x.dot(y).abs() <= tolerance * a;
            let centre = image.world(image.of().apex().unwrap_or(own.origin));
            let square = up.dot(x).abs().max(up.dot(y).abs()) * size <= tolerance * a * up.norm();
            if !round || !square || !along(up) || !on_axis(centre) {
                return None;
            }
            let (h, steep) = (height(centre), a * a / up.norm_sq());
            match image.of() {
                SurfaceShape::Sphere { .. } => about(-steep, h, a * a),
                SurfaceShape::Cylinder { .. } => Some([a * a, 0.0, 0.0]),
                SurfaceShape::Cone { .. } => about(steep, h, 0.0),
                _ => None,
            }
        }
        _ => None,
    }
}

/// The circles that a spheroid, or another image that is a surface of revolution, has in common with a surface about the same
/// axis: those that touch count.
fn turned_image(
    image: &SurfaceImage,
    other: &SurfaceShape,
    tolerance: f64,
    size: f64,
) -> Vec<ExactCurve> {
    let own = SurfaceShape::Image(Box::new(image.clone()));
    let Some(origin) = image.of().axes().map(|a| image.world(a.origin)) else { return Vec::new() };
    let mut made: Vec<ExactCurve> = Vec::new();
    for v in [Vec3::of(1.0, 0.0, 0.0), Vec3::of(0.0, 1.0, 0.0), Vec3::of(0.0, 0.0, 1.0)] {
        // Any axis of a spheroid may be the one about which it is turned.
        let Some(z) = image.linear(v).normalized() else { continue };
        let turned = image.about(v);
        let shape = turned.as_ref().map_or(&own, |t| t);
        let near = [tolerance, size];
        let Some(f) = squared_profile(shape, origin, z, near) else { continue };
        let Some(g) = squared_profile(other, origin, z, near)
            .or_else(|| other.image_about(z).and_then(|o| squared_profile(&o, origin, z, near)))
        else {
            continue;
        };
        let [c, b, a] = [0, 1, 2].map(|k| f[k] - g[k]);
        let at = |h: f64| f[0] + h * (f[1] + h * f[2]);
        let mut heights = Vec::new();
        if a.abs() * size <= tolerance {
            if b.abs() > tolerance {
                heights.push(-c / b);
            }
        } else {
            let middle = -b / (2.0 * a);
            let (least, square) = (c - a * middle * middle, at(middle));
            if square > 0.0 && least.abs() <= 2.0 * square.sqrt() * tolerance {
                heights.push(middle);
            } else if -least / a > 0.0 {
                let half = (-least / a).sqrt();
                heights.extend([middle - half, middle + half]);
            }
        }
        for h in heights {
            let square = at(h);
            if square > tolerance * tolerance {
                made.push(ExactCurve::circle(origin + z * h, z, square.sqrt()));
            }
        }
        break;
    }
    made
}

fn on_planes(normals: [Vec3; 3], points: [Vec3; 3]) -> Option<Vec3> {
    let [a, b, c] = normals;
    let det = a.dot(b.cross(c));
    let origin = points[0];
    let [p, q, r] = [0, 1, 2].map(|k| normals[k].dot(points[k] - origin));
    (det.abs() > 1e-12).then(|| origin + (b.cross(c) * p + c.cross(a) * q + a.cross(b) * r) / det)
}

fn plane_cylinder(
    origin: Vec3,
    normal: Vec3,
    axes: &SurfaceAxes,
    radius: f64,
    tolerance: f64,
    size: f64,
) -> Vec<ExactCurve> {
    let along = normal.dot(axes.z);
    if (along * size).abs() > tolerance {
        let centre = axes.origin - axes.z * ((axes.origin - origin).dot(normal) / along);
        let Some(y) = normal.cross(axes.z).normalized() else {
            return vec![ExactCurve::circle(centre, axes.z, radius)];
        };
        if normal.cross(axes.z).norm() * size <= tolerance {
            return vec![ExactCurve::circle(centre, axes.z, radius)];
        }
        let Some(x) = y.cross(normal).normalized() else { return Vec::new() };
        return vec![ExactCurve::Ellipse { centre, x: x * (radius / along.abs()), y: y * radius }];
    }
    let far = (origin - axes.origin).dot(normal);
    let foot = axes.origin + normal * far;
    let half = radius * radius - far * far;
    let direction = axes.z;
    if (far.abs() - radius).abs() <= tolerance {
        let point = axes.origin + normal * if far < 0.0 { -radius } else { radius };
        return vec![ExactCurve::Line { point, direction }];
    }
    if half < 0.0 {
        return Vec::new();
    }
    let side = normal.cross(axes.z) * half.sqrt();
    [foot - side, foot + side].map(|point| ExactCurve::Line { point, direction }).into()
}

fn plane_cone(
    origin: Vec3,
    normal: Vec3,
    cone: &SurfaceShape,
    half_angle: f64,
    tolerance: f64,
    size: f64,
) -> Vec<ExactCurve> {
    let (Some(apex), Some(axes)) = (cone.apex(), cone.axes()) else { return Vec::new() };
    let along = normal.dot(axes.z);
    let Some(x) = (normal - axes.z * along).normalized() else { return Vec::new() };
    let (sin, cos) = (libm::sin(half_angle), libm::cos(half_angle));
    let far = (origin - apex).dot(normal);
    let across = normal.dot(x);
    if far.abs() <= tolerance {
        // Generators z cos + (x c + y s) sin with along cos + across c sin = 0.
        let c = -along * cos / (across * sin);
        let point = apex;
        if (c.abs() - 1.0).abs() * size <= tolerance {
            let direction = axes.z * cos + x * (sin * if c < 0.0 { -1.0 } else { 1.0 });
            return vec![ExactCurve::Line { point, direction }];
        }
        if c.abs() > 1.0 {
            return Vec::new();
        }
        let s = (1.0 - c * c).sqrt();
        let y = axes.z.cross(x);
        return [-s, s]
            .map(|s| axes.z * cos + (x * c + y * s) * sin)
            .map(|direction| ExactCurve::Line { point, direction })
            .into();
    }
    if along.abs() <= sin + 1e-9 {
        // A parabola or a hyperbola.
        return Vec::new();
    }
    // The ends of the long axis are on the generators in the plane of symmetry.
    let end = |s: f64| {
        let g = axes.z * cos + x * (s * sin);
        let t = far / g.dot(normal);
        apex + g * t
    };
    let [p, q] = [end(-1.0), end(1.0)];
    let centre = (p + q) * 0.5;
    let h = (centre - apex).dot(axes.z);
    let out = (centre - apex).dot(x);
    let y = (h * sin / cos) * (h * sin / cos) - out * out;
    if y <= 0.0 {
        return Vec::new();
    }
    vec![ExactCurve::Ellipse { centre, x: (q - p) * 0.5, y: axes.z.cross(x) * y.sqrt() }]
}

fn parallel_cylinders(
    [a, b]: [&SurfaceAxes; 2],
    [r, s]: [f64; 2],
    tolerance: f64,
) -> Vec<ExactCurve> {
    let d = b.origin - a.origin;
    let d = d - a.z * d.dot(a.z);
    let Some(x) = d.normalized() else { return Vec::new() };
    let places = two_circles([0.0, 0.0], r, [d.norm(), 0.0], s, tolerance);
    let y = a.z.cross(x);
    let line =
        |[u, v]: [f64; 2]| ExactCurve::Line { point: a.origin + x * u + y * v, direction: a.z };
    places.into_iter().map(line).collect()
}

/// The axis about which both surfaces are surfaces of revolution.
fn common_axis(
    a: &SurfaceShape,
    b: &SurfaceShape,
    tolerance: f64,
    size: f64,
) -> Option<(Vec3, Vec3)> {
    use SurfaceShape::{Extruded, Image, Nurbs, Plane, Sphere};
    match (a, b) {
        (Nurbs(_) | Image(_) | Extruded(_), _) | (_, Nurbs(_) | Image(_) | Extruded(_)) => None,
        (Plane { .. }, Plane { .. }) => None,
        (Plane { normal, .. }, Sphere { axes, .. })
        | (Sphere { axes, .. }, Plane { normal, .. }) => Some((axes.origin, *normal)),
        (Sphere { axes, .. }, Sphere { axes: o, .. }) => {
            Some((axes.origin, (o.origin - axes.origin).normalized()?))
        }
        (Plane { normal, .. }, other) | (other, Plane { normal, .. }) => {
            let axes = other.axes()?;
            let same = axes.z.cross(*normal).norm() * size <= tolerance;
            same.then_some((axes.origin, axes.z))
        }
        (Sphere { axes, .. }, other) | (other, Sphere { axes, .. }) => {
            let own = other.axes()?;
            let d = axes.origin - own.origin;
            let off = (d - own.z * d.dot(own.z)).norm();
            (off <= tolerance).then_some((own.origin, own.z))
        }
        _ => {
            let (axes, o) = (a.axes()?, b.axes()?);
            let d = o.origin - axes.origin;
            let off = (d - axes.z * d.dot(axes.z)).norm();
            let same = axes.z.cross(o.z).norm() * size <= tolerance;
            (same && off <= tolerance).then_some((axes.origin, axes.z))
        }
    }
}

fn profile(s: &SurfaceShape, origin: Vec3, z: Vec3) -> Vec<ProfilePiece> {
    let height = |p: Vec3| (p - origin).dot(z);
    match s {
        SurfaceShape::Plane { origin, .. } => {
            vec![ProfilePiece::Line([0.0, height(*origin)], [1.0, 0.0])]
        }
        SurfaceShape::Cylinder { radius, .. } => {
            vec![ProfilePiece::Line([*radius, 0.0], [0.0, 1.0])]
        }
        SurfaceShape::Cone { half_angle, .. } => {
            let h = s.apex().map_or(0.0, height);
            let (sin, cos) = (libm::sin(*half_angle), libm::cos(*half_angle));
            [cos, -cos].map(|c| ProfilePiece::Line([0.0, h], [sin, c])).into()
        }
        SurfaceShape::Sphere { axes, radius } => {
            vec![ProfilePiece::Circle([0.0, height(axes.origin)], *radius)]
        }
        SurfaceShape::Torus { axes, major, minor } => {
            vec![ProfilePiece::Circle([*major, height(axes.origin)], *minor)]
        }
        SurfaceShape::Image(_) | SurfaceShape::Extruded(_) | SurfaceShape::Nurbs(_) => Vec::new(),
    }
}

fn coaxial([a, b]: [&SurfaceShape; 2], origin: Vec3, z: Vec3, tolerance: f64) -> Vec<ExactCurve> {
    let mut made: Vec<[f64; 2]> = Vec::new();
    for p in profile(a, origin, z) {
        for q in profile(b, origin, z) {
            made.extend(match (&p, &q) {
                (ProfilePiece::Line(a, d), ProfilePiece::Line(b, e)) => {
                    let det = d[0] * e[1] - d[1] * e[0];
                    let w = [b[0] - a[0], b[1] - a[1]];
                    let t = (w[0] * e[1] - w[1] * e[0]) / det;
                    let one = [a[0] + d[0] * t, a[1] + d[1] * t];
                    if det.abs() > 1e-12 { vec![one] } else { Vec::new() }
                }
                (ProfilePiece::Line(a, d), ProfilePiece::Circle(c, r))
                | (ProfilePiece::Circle(c, r), ProfilePiece::Line(a, d)) => {
                    let t = (c[0] - a[0]) * d[0] + (c[1] - a[1]) * d[1];
                    let foot = [a[0] + d[0] * t, a[1] + d[1] * t];
                    let far = [foot[0] - c[0], foot[1] - c[1]];
                    let far = (far[0] * far[0] + far[1] * far[1]).sqrt();
                    if (far - r).abs() <= tolerance {
                        vec![foot]
                    } else if far < *r {
                        let half = (r * r - far * far).sqrt();
                        [-half, half].map(|s| [foot[0] + d[0] * s, foot[1] + d[1] * s]).into()
                    } else {
                        Vec::new()
                    }
                }
                (ProfilePiece::Circle(c, r), ProfilePiece::Circle(e, s)) => {
                    two_circles(*c, *r, *e, *s, tolerance)
                }
            });
        }
    }
    made.retain(|p| p[0] > tolerance);
    made.into_iter().map(|[r, h]| ExactCurve::circle(origin + z * h, z, r)).collect()
}

fn two_circles(a: [f64; 2], r: f64, b: [f64; 2], s: f64, tolerance: f64) -> Vec<[f64; 2]> {
    let d = [b[0] - a[0], b[1] - a[1]];
    let far = (d[0] * d[0] + d[1] * d[1]).sqrt();
    if far <= tolerance {
        return Vec::new();
    }
    let d = [d[0] / far, d[1] / far];
    let at = |t: f64, u: f64| [a[0] + d[0] * t - d[1] * u, a[1] + d[1] * t + d[0] * u];
    if (far - r - s).abs() <= tolerance {
        return vec![at(r, 0.0)];
    }
    if (far - (r - s).abs()).abs() <= tolerance {
        return vec![at(if r > s { r } else { -r }, 0.0)];
    }
    let t = (far * far + r * r - s * s) / (2.0 * far);
    let half = r * r - t * t;
    if half <= 0.0 { Vec::new() } else { vec![at(t, -half.sqrt()), at(t, half.sqrt())] }
}
