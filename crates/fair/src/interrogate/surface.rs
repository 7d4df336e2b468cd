//! Curvature and reflections of a surface, as numbers.

use moldloft_num::{Order, Real, Surface, Vec3};

/// Curvatures of a surface at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceCurvatures {
    /// K, the product of the principal curvatures.
    pub gaussian: f64,
    /// H, half their sum; its sign is that of bending towards the natural normal.
    pub mean: f64,
    /// The principal curvatures, larger first.
    pub principal: [f64; 2],
}

impl SurfaceCurvatures {
    /// |k1| + |k2|: zero on planes only, where K is blind on cylinders and H on minimal surfaces.
    pub fn absolute(&self) -> f64 {
        self.principal[0].abs() + self.principal[1].abs()
    }
}

/// A surface at (u, v): position, natural normal and curvatures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceAnalysis {
    /// Position.
    pub point: Vec3<f64>,
    /// Unit normal along S_u x S_v.
    pub normal: Vec3<f64>,
    /// Curvatures.
    pub curvatures: SurfaceCurvatures,
}

/// Looks at a surface at (`u`, `v`); `None` where it is singular.
///
/// With N the normal, E = S_u S_u, F = S_u S_v, G = S_v S_v, L = S_uu N, M = S_uv N, P = S_vv N:
/// K = (L P - M^2) / (E G - F^2), H = (E P - 2 F M + G L) / (2 (E G - F^2)) (do Carmo 1976, 3.3).
pub fn look(surface: &dyn Surface<f64>, u: f64, v: f64) -> Option<SurfaceAnalysis> {
    let s = surface.jet(u, v, Order::Second);
    let normal = s.u.cross(s.v).normalized().filter(|n| n.is_finite())?;
    let (e, f, g) = (s.u.dot(s.u), s.u.dot(s.v), s.v.dot(s.v));
    let (l, m, p) = (s.uu.dot(normal), s.uv.dot(normal), s.vv.dot(normal));
    let area = e * g - f * f;
    if area <= 0.0 {
        return None;
    }
    let gaussian = (l * p - m * m) / area;
    let mean = (e * p - 2.0 * f * m + g * l) / (2.0 * area);
    let root = (mean * mean - gaussian).max(0.0).sqrt();
    let principal = [mean + root, mean - root];
    Some(SurfaceAnalysis {
        point: s.p,
        normal,
        curvatures: SurfaceCurvatures { gaussian, mean, principal },
    })
}

/// Cosine between the normal and the light; its level lines are the isophotes.
pub fn isophote(look: &SurfaceAnalysis, light: Vec3<f64>) -> f64 {
    look.normal.dot(light.normalized().unwrap_or_default())
}

/// The signed distance of the normal line from a light line a + t s: highlight lines are where it
/// vanishes, highlight bands where it is small (Beier and Chen 1994).
pub fn highlight(look: &SurfaceAnalysis, a: Vec3<f64>, s: Vec3<f64>) -> f64 {
    let across = s.cross(look.normal);
    let size = across.norm();
    if size == 0.0 { 0.0 } else { across.dot(a - look.point) / size }
}

/// The determinant det(r, s, x - a) of the mirrored view direction r: zero where the eye sees the
/// line a + t s reflected (Klass 1980). `view` points from the surface to the eye.
pub fn reflection(look: &SurfaceAnalysis, view: Vec3<f64>, a: Vec3<f64>, s: Vec3<f64>) -> f64 {
    let view = view.normalized().unwrap_or_default();
    let mirrored = look.normal * (2.0 * look.normal.dot(view)) - view;
    mirrored.dot(s.cross(look.point - a))
}

/// Zebra stripes: +1 or -1 by the angle of the mirrored view direction round an axis, `stripes`
/// pairs to a turn.
pub fn zebra(look: &SurfaceAnalysis, view: Vec3<f64>, axis: Vec3<f64>, stripes: f64) -> f64 {
    let view = view.normalized().unwrap_or_default();
    let mirrored = look.normal * (2.0 * look.normal.dot(view)) - view;
    let axis = axis.normalized().unwrap_or(Vec3::of(0.0, 0.0, 1.0));
    let side = axis.perpendicular().normalized().unwrap_or_default();
    let other = axis.cross(side);
    let angle = Real::atan2(mirrored.dot(other), mirrored.dot(side));
    if Real::sin(stripes * angle) >= 0.0 { 1.0 } else { -1.0 }
}

impl SurfaceAnalysis {
    /// The analysis of the surface seen from its other side: with the opposite normal, and opposite
    /// signs of the mean and the principal curvatures.
    pub fn turned(&self) -> Self {
        let SurfaceCurvatures { gaussian, mean, principal: [k1, k2] } = self.curvatures;
        let curvatures = SurfaceCurvatures { gaussian, mean: -mean, principal: [-k2, -k1] };
        Self { point: self.point, normal: -self.normal, curvatures }
    }
}

/// Numbers at the points of a mesh, for viewers.
#[derive(Clone, Debug, PartialEq)]
pub struct PointField {
    /// The name that viewers show.
    pub name: &'static str,
    /// Numbers per point: 1, or 3 of a vector.
    pub components: usize,
    /// The numbers, point by point; NaN where the surface is singular.
    pub values: Vec<f64>,
}

/// Fields for viewers: curvatures, isophotes of light along +z, zebra stripes of a view along +z
/// around the x axis (eight to a turn), and normals.
pub fn fields(looks: &[Option<SurfaceAnalysis>]) -> Vec<PointField> {
    let (x, z) = (Vec3::of(1.0, 0.0, 0.0), Vec3::of(0.0, 0.0, 1.0));
    let numbers = |name, of: &dyn Fn(&SurfaceAnalysis) -> f64| PointField {
        name,
        components: 1,
        values: looks.iter().map(|l| l.as_ref().map_or(f64::NAN, of)).collect(),
    };
    let normal =
        |l: &Option<SurfaceAnalysis>| l.as_ref().map_or([f64::NAN; 3], |l| l.normal.to_array());
    vec![
        numbers("gaussian_curvature", &|l| l.curvatures.gaussian),
        numbers("mean_curvature", &|l| l.curvatures.mean),
        numbers("largest_curvature", &|l| l.curvatures.principal[0]),
        numbers("smallest_curvature", &|l| l.curvatures.principal[1]),
        numbers("isophote", &|l| isophote(l, z)),
        numbers("zebra", &|l| zebra(l, z, x, 8.0)),
        PointField {
            name: "normal",
            components: 3,
            values: looks.iter().flat_map(normal).collect(),
        },
    ]
}

/// A point of the orthotomic surface p + k ((x - p) . n) n; singular where K = 0.
pub fn orthotomic(look: &SurfaceAnalysis, p: Vec3<f64>, k: f64) -> Vec3<f64> {
    p + look.normal * (k * (look.point - p).dot(look.normal))
}

/// The metric eta_y of a plane grid whose point (i, j) has the index `i * n + j`: with xi along i
/// and eta along j in steps of 1, eta_y = x_xi / (x_xi y_eta - x_eta y_xi). Differences are central
/// inside and one-sided at the rims; zero for cells without area.
///
/// # Errors
/// [`crate::FairError`] unless the grid is at least 2 by 2 and has m n points.
pub fn eta_y(points: &[Vec3<f64>], m: usize, n: usize) -> Result<Vec<f64>, crate::FairError> {
    if m < 2 || n < 2 {
        return Err(crate::FairError::TooFew { expected: 2, actual: m.min(n) });
    }
    if points.len() != m * n {
        let (expected, actual) = (m * n, points.len());
        return Err(crate::FairError::Count { what: "grid points", expected, actual });
    }
    let slope = |at: usize, count: usize, of: &dyn Fn(usize) -> Vec3<f64>| {
        let (low, high) = (at.saturating_sub(1), (at + 1).min(count - 1));
        (of(high) - of(low)) * (1.0 / (high - low) as f64)
    };
    let mut out = Vec::with_capacity(m * n);
    for i in 0..m {
        for j in 0..n {
            let xi = slope(i, m, &|i| points[i * n + j]);
            let eta = slope(j, n, &|j| points[i * n + j]);
            let area = xi.x * eta.y - eta.x * xi.y;
            out.push(if area == 0.0 { 0.0 } else { xi.x / area });
        }
    }
    Ok(out)
}
