//! The surfaces of faces as NURBS, each once, and planes among them.

use crate::ExportFailure;
use moldloft_brep::SurfaceShape;
use moldloft_diag::Diagnostic;
use moldloft_num::Vec3;
use moldloft_panel::FaceOutline;
use moldloft_spline::nurbs::{FitOptions, NotFitted, Nurbs, of_surface};
use std::sync::Arc;

/// Control points within this share of the largest coordinate from a plane lie in it.
const IN_PLANE: f64 = 1e-12;

/// The NURBS of each outline's surface.
pub fn all(outlines: &[FaceOutline], accuracy: f64) -> Result<Vec<Arc<Nurbs<2>>>, ExportFailure> {
    let options = FitOptions::within(accuracy);
    let mut made: Vec<Arc<Nurbs<2>>> = Vec::with_capacity(outlines.len());
    for (k, outline) in outlines.iter().enumerate() {
        let known = outlines[..k].iter().position(|o| o.surface.same(&outline.surface));
        made.push(match known {
            Some(known) => made[known].clone(),
            None => Arc::new(
                of_surface(&*outline.surface, &options)
                    .map_err(|e| not_fitted(&outline.name, &e, accuracy))?,
            ),
        });
    }
    Ok(made)
}

/// The fault of a shape without a fit.
pub fn not_fitted(name: &str, error: &NotFitted, accuracy: f64) -> ExportFailure {
    Diagnostic::error("not-fitted", format!("no B-spline comes within {accuracy:.2e} of `{name}`"))
        .found(error.to_string())
        .help("ask for less with a larger tolerance")
        .into()
}

/// The plane that a surface lies in, its normal being that of the surface.
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
