//! Distances of points from curves and surfaces, ends and edges included.

use super::arguments::{Along, Onto};
use super::{beads, magnets};
use moldloft_num::{Order, Real, Vec3};
use moldloft_registry::{CallError, CurveRef, SurfaceRef};

/// The distance of a point from the whole of a curve.
///
/// # Errors
/// `diverged` where no nearest point is found.
pub fn distance_from_curve<T: Real>(curve: &CurveRef<T>, point: Vec3<T>) -> Result<T, CallError> {
    let along = Along { curve: curve.clone(), start: None };
    let (t, _) = beads::foot(&along, point, true)?;
    let [place, ..] = curve.jet(t, Order::Zero);
    Ok(separation(place, point))
}

/// The distance of a point from the whole of a surface.
///
/// # Errors
/// `diverged` where no nearest point is found.
pub fn distance_from_surface<T: Real>(
    surface: &SurfaceRef<T>,
    point: Vec3<T>,
) -> Result<T, CallError> {
    let onto = Onto { surface: surface.clone(), start: None };
    let ([u, v], _) = magnets::foot(&onto, point, true)?;
    Ok(separation(surface.jet(u, v, Order::Zero).p, point))
}

/// The distance of two points; where they meet it has no derivative, and none is given.
pub fn separation<T: Real>(a: Vec3<T>, b: Vec3<T>) -> T {
    let away = a - b;
    if away.re().norm_sq() > 0.0 { away.norm() } else { T::zero() }
}
