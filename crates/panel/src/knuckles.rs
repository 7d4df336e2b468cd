//! Where the lines of a surface break: its knuckles, as parameters.
//!
//! A knuckle is a parameter line at which the surface is continuous and its tangents across are not: the
//! joint of a poly-curve, a knot of degree 1, a crease. It is a row of the patch, on all sides alike, so
//! that no panel spans it.

use moldloft_num::{Order, Surface, Vec3};

/// Tangents that differ in direction by more than this, in radians, make a knuckle.
const TURN: f64 = 1e-5;

/// A break is one to rounding, since it may have been shared out among pieces; tangents are taken so far
/// before and after it.
pub(crate) const ASIDE: f64 = 1e-9;

/// Each break is tried at so many places along it.
const TRIALS: usize = 5;

/// The knuckles along u and along v, ascending, between 0 and 1.
pub(crate) fn knuckles(surface: &dyn Surface<f64>) -> [Vec<f64>; 2] {
    let [mut us, mut vs] = surface.kinks();
    let along = |u| surface.line(u, &trials(), Order::First).into_iter().map(|jet| jet.u).collect();
    us.retain(|&at| turns(at, along));
    let across = |v| trials().iter().map(|&u| surface.jet(u, v, Order::First).v).collect();
    vs.retain(|&at| turns(at, across));
    [us, vs]
}

/// The places along a break.
fn trials() -> [f64; TRIALS] {
    std::array::from_fn(|i| (i as f64 + 0.37) / TRIALS as f64)
}

/// True when the tangents before and after a break differ in direction somewhere along it.
fn turns(at: f64, tangents: impl Fn(f64) -> Vec<Vec3>) -> bool {
    let differ = |(a, b): (Vec3, Vec3)| {
        let size = a.norm() * b.norm();
        size > 0.0 && (a.cross(b).norm() > TURN * size || a.dot(b) < 0.0)
    };
    let inside = ASIDE < at && at < 1.0 - ASIDE;
    inside && tangents(at - ASIDE).into_iter().zip(tangents(at + ASIDE)).any(differ)
}
