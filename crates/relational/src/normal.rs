//! The normal of a surface at a magnet, also where the surface is singular.

use crate::arguments::Magnet;
use moldloft_num::{Order, Real, SurfJet, Vec3};
use moldloft_registry::CallError;

/// Below this the sine of the angle between S_u and S_v, or the ratio of their lengths, is rounding.
const SINGULAR: f64 = 1e-10;

/// The unit normal S_u x S_v at a magnet. If one of the two vanishes (a pole), the limit from
/// inside along the parameter line that ends there.
///
/// # Errors
/// `no-normal` where there is no such limit either.
pub fn normal<T: Real>(magnet: &Magnet<T>) -> Result<Vec3<T>, CallError> {
    let [u, v] = magnet.uv;
    let jet = magnet.surface.jet(u, v, Order::Second);
    let product = product(&jet, [u.re(), v.re()]);
    product.and_then(Vec3::normalized).ok_or_else(|| {
        CallError::new("no-normal", "the surface has no normal there")
            .expected("a point where the surface has a tangent plane")
            .found(format!("none at (u, v) = ({}, {})", u.re(), v.re()))
            .help("move the magnet off the pole or crease")
            .related(magnet.key, "is there")
    })
}

/// A vector along the normal, or its limit; `None` if neither exists.
fn product<T: Real>(jet: &SurfJet<T>, [u, v]: [f64; 2]) -> Option<Vec3<T>> {
    let regular = |a: Vec3<T>, b: Vec3<T>| {
        let n = a.cross(b);
        let size = a.re().norm() * b.re().norm();
        (n.re().norm() > SINGULAR * size).then_some(n)
    };
    let (along, across) = (jet.u.re().norm(), jet.v.re().norm());
    // Inside is at smaller parameters when the pole is at the far edge: there the vector that
    // vanishes comes from the other side.
    let inward = |t: f64, d: Vec3<T>| if t > 0.5 { -d } else { d };
    if along <= SINGULAR * across {
        return regular(inward(v, jet.uv), jet.v);
    }
    if across <= SINGULAR * along {
        return regular(jet.u, inward(u, jet.uv));
    }
    regular(jet.u, jet.v)
}
