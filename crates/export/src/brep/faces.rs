//! The surfaces of faces as NURBS, each once, and planes among them.

use crate::ExportFailure;
use moldloft_brep::SurfaceShape;
use moldloft_diag::Diagnostic;
use moldloft_num::{Surface, Vec3};
use moldloft_panel::FaceOutline;
use moldloft_parallel::prelude::*;
use moldloft_spline::nurbs::{FitOptions, NotFitted, Nurbs, of_surface};
use std::sync::Arc;

/// Distance of control points from a plane, relative to the largest coordinate, within which they
/// are in it.
const IN_PLANE: f64 = 1e-12;

/// The NURBS of each outline's surface: of one that is another, turned and shifted, that fit moved; fits are made side by
/// side.
pub fn all(outlines: &[FaceOutline], accuracy: f64) -> Result<Vec<Arc<Nurbs<2>>>, ExportFailure> {
    let options = FitOptions::within(accuracy);
    let fitted = |which: &[usize]| -> Vec<Result<Arc<Nurbs<2>>, ExportFailure>> {
        let fit = |&k: &usize| {
            let fit = of_surface(&*outlines[k].surface, &options);
            fit.map(Arc::new).map_err(|e| not_fitted(&outlines[k].name, &e, accuracy))
        };
        which.par_iter().map(fit).collect()
    };
    let first = |k: usize| outlines.iter().position(|o| o.surface.same(&outlines[k].surface));
    let firsts: Vec<usize> = (0..outlines.len()).map(|k| first(k).unwrap_or(k)).collect();
    let (mut leaders, mut followers): (Vec<usize>, Vec<(usize, usize)>) = (Vec::new(), Vec::new());
    for k in (0..outlines.len()).filter(|&k| firsts[k] == k) {
        let alike = |l: &&usize| motion(&*outlines[**l].surface, &*outlines[k].surface).is_some();
        match leaders.iter().find(alike) {
            Some(&leader) => followers.push((k, leader)),
            None => leaders.push(k),
        }
    }
    let mut made: Vec<Option<Arc<Nurbs<2>>>> = vec![None; outlines.len()];
    for (k, fit) in leaders.iter().zip(fitted(&leaders)) {
        made[*k] = Some(fit?);
    }
    let mut others = Vec::new();
    for (k, leader) in followers {
        let (from, to) = (&*outlines[leader].surface, &*outlines[k].surface);
        let copied = made[leader].as_ref().and_then(|fit| moved(fit, from, to, accuracy));
        match copied {
            Some(copied) => made[k] = Some(Arc::new(copied)),
            None => others.push(k),
        }
    }
    for (k, fit) in others.iter().zip(fitted(&others)) {
        made[*k] = Some(fit?);
    }
    Ok(firsts.iter().filter_map(|&k| made[k].clone()).collect())
}

/// Distances below this, relative to the size, count as rounding between a surface and its moved
/// copy.
const COPIED: f64 = 1e-11;

/// Rigid motion from one surface to another.
struct RigidMotion {
    /// A point of each, and axes there.
    origins: [Vec3; 2],
    axes: [[Vec3; 3]; 2],
    /// Points nearer to each other than this are one.
    near: f64,
}

impl RigidMotion {
    fn place(&self, p: Vec3) -> Vec3 {
        let d = p - self.origins[0];
        (0..3).fold(self.origins[1], |sum, k| sum + self.axes[1][k] * d.dot(self.axes[0][k]))
    }

    fn apart(&self, own: &[Vec3], theirs: &[Vec3]) -> f64 {
        own.iter().zip(theirs).map(|(p, q)| self.place(*p).distance(*q)).fold(0.0, f64::max)
    }
}

fn sampled(surface: &dyn Surface<f64>, axes: &[Vec<f64>; 2]) -> Vec<Vec3> {
    let mut out = vec![Vec3::zero(); axes[0].len() * axes[1].len()];
    surface.grid(&axes[0], &axes[1], &mut out, None);
    out
}

/// The motion that moves a few points of a surface to those of another, if there is one.
fn motion(from: &dyn Surface<f64>, to: &dyn Surface<f64>) -> Option<RigidMotion> {
    const FEW: usize = 5;
    if from.joints() != to.joints() {
        return None;
    }
    let even = || (0..FEW).map(|k| k as f64 / (FEW - 1) as f64).collect::<Vec<f64>>();
    let few = [even(), even()];
    let (own, theirs) = (sampled(from, &few), sampled(to, &few));
    let far = |p: &Vec3| p.to_array().iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let near = COPIED * own.iter().chain(&theirs).map(far).fold(0.0, f64::max);
    // Axes of three points that are far apart.
    let furthest = |of: &dyn Fn(Vec3) -> f64| {
        (0..own.len()).max_by(|&a, &b| of(own[a]).total_cmp(&of(own[b])))
    };
    let b = furthest(&|p| p.distance(own[0]))?;
    let line = (own[b] - own[0]).normalized()?;
    let c = furthest(&|p| line.cross(p - own[0]).norm())?;
    let axes = |points: &[Vec3]| {
        let x = (points[b] - points[0]).normalized()?;
        let z = x.cross(points[c] - points[0]).normalized()?;
        Some([x, z.cross(x), z])
    };
    let axes = [axes(&own)?, axes(&theirs)?];
    let motion = RigidMotion { origins: [own[0], theirs[0]], axes, near };
    (motion.apart(&own, &theirs) <= near).then_some(motion)
}

/// The fit of a surface, turned and shifted onto a copy of that surface, as are the blades of a propeller: a fit is
/// the spline through its interpolation points, so that it is the copy's where these are turned and shifted alike.
/// Points between them are compared as well.
fn moved(
    fit: &Nurbs<2>,
    from: &dyn Surface<f64>,
    to: &dyn Surface<f64>,
    accuracy: f64,
) -> Option<Nurbs<2>> {
    if fit.exact || fit.weights.is_some() {
        return None;
    }
    let motion = motion(from, to)?;
    let means: [Vec<f64>; 2] = std::array::from_fn(|d| {
        let p = fit.degrees[d];
        let mean = |w: &[f64]| fit.paces[d].parameter(w.iter().sum::<f64>() / p as f64);
        fit.knots[d][1..fit.knots[d].len() - 1].windows(p).map(mean).collect()
    });
    let between = means.clone().map(|all| all.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect());
    let mut off = 0.0f64;
    for axes in [means, between] {
        off = off.max(motion.apart(&sampled(from, &axes), &sampled(to, &axes)));
        if off > motion.near {
            return None;
        }
    }
    // Splines amplify errors of their points by a small factor.
    let error = fit.error + 10.0 * off;
    let points = fit.points.iter().map(|p| motion.place(*p)).collect();
    (error <= accuracy).then(|| Nurbs { points, error, ..fit.clone() })
}

/// The fault of a shape without a fit.
pub fn not_fitted(name: &str, error: &NotFitted, accuracy: f64) -> ExportFailure {
    Diagnostic::error("not-fitted", format!("no B-spline comes within {accuracy:.2e} of `{name}`"))
        .found(error.to_string())
        .help("ask for less with a larger tolerance")
        .into()
}

/// The plane of a surface, with the normal of the surface.
pub fn plane(surface: &Nurbs<2>) -> Option<SurfaceShape> {
    let [nu, nv] = surface.counts();
    let at = |i: usize, j: usize| surface.points[i * nv + j];
    let largest = |p: &Vec3| p.to_array().iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let near = IN_PLANE * surface.points.iter().map(largest).fold(0.0, f64::max);
    let origin = at(0, 0);
    let mut normal = Vec3::zero();
    for i in 0..nu - 1 {
        for j in 0..nv - 1 {
            normal += (at(i + 1, j + 1) - at(i, j)).cross(at(i, j + 1) - at(i + 1, j));
        }
    }
    let normal = normal.normalized()?;
    if surface.points.iter().any(|&p| (p - origin).dot(normal).abs() > near) {
        return None;
    }
    // Any direction in the plane: of the net's first long enough side.
    let axis = surface.points.iter().find_map(|&p| {
        let d = p - origin - normal * (p - origin).dot(normal);
        (d.norm() > 1e3 * near).then(|| d.normalized()).flatten()
    })?;
    let axis = (axis - normal * axis.dot(normal)).normalized()?;
    Some(SurfaceShape::Plane { origin, normal, axis })
}
