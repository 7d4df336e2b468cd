//! Origin of facets: exact faces and edges of bodies, and positions on them.

use super::coincidence::Kink;
use super::curve::SmoothPiece;
use super::revolved::{arc_share, is_circle};
use super::surface::FaceSurface;
use moldloft_num::{Real, Vec3};
use std::sync::Arc;

/// Distance from a surface, relative to its size, within which a point is on it.
pub(super) const ON_SURFACE: f64 = 1e-8;

/// Origin of the facets of bodies.
pub(super) struct FacetSource<T> {
    pub(super) surfaces: Vec<FaceSurface<T>>,
    /// By surface: the names of its face.
    pub(super) names: Vec<Vec<Arc<str>>>,
    /// By edge: its curve where it has a closed form, and the surfaces beside it.
    pub(super) edges: Vec<(Option<SmoothPiece<T>>, Vec<u32>)>,
    /// By surface: the directed edges around its face, empty for a face in triangles; and whether
    /// outward is the surface's own normal.
    pub(super) borders: Vec<(Vec<(u32, bool)>, bool)>,
    /// By edge: where it begins and ends on its curve.
    pub(super) ranges: Vec<[f64; 2]>,
    /// By edge: points along it with directions, where it has no closed form.
    pub(super) traced: Vec<Vec<(Vec3, Vec3)>>,
    /// By edge: where it begins and ends.
    pub(super) ends: Vec<[Vec3; 2]>,
    /// Plane faces, by surface, that do not stay plane.
    pub(super) warped: Vec<(u32, Kink)>,
}

/// The parameter of the point of a piece nearest to `p`.
pub(super) fn along<T: Real>(piece: &SmoothPiece<T>, p: Vec3) -> f64 {
    if let SmoothPiece::Conic { centre, a, b, sweep } = piece
        && is_circle(a.re(), b.re())
    {
        let by = p - centre.re();
        return arc_share(libm::atan2(by.dot(b.re()), by.dot(a.re())), sweep.re(), 0.5)
            .clamp(-0.1, 1.1);
    }
    let at = |s: f64| piece.at(T::from(s)).re();
    let mut s = (0..=16)
        .map(|k| f64::from(k) / 16.0)
        .min_by(|a, b| at(*a).distance(p).total_cmp(&at(*b).distance(p)))
        .unwrap_or(0.5);
    for _ in 0..12 {
        let d = piece.velocity(T::from(s)).re();
        let step = d.dot(p - at(s)) / d.norm_sq();
        if !step.is_finite() {
            break;
        }
        s = (s + step).clamp(-0.1, 1.1);
    }
    s
}

/// The parameters of a point of a surface by Gauss-Newton steps, or of the foot of a point within a
/// fraction of its size; `None` if the steps converge to another point.
pub(super) fn settled<T: Real>(
    surface: &FaceSurface<T>,
    p: Vec3,
    start: [f64; 2],
    share: f64,
) -> Option<[f64; 2]> {
    let mut at = start;
    for _ in 0..8 {
        let [s, du, dv] = surface.jet(T::from(at[0]), T::from(at[1])).map(Vec3::re);
        let r = p - s;
        let (a, b, c) = (du.norm_sq(), du.dot(dv), dv.norm_sq());
        let det = a * c - b * b;
        if det <= 1e-20 * a * c {
            break;
        }
        let (x, y) = (du.dot(r), dv.dot(r));
        let step = [(c * x - b * y) / det, (a * y - b * x) / det];
        at = [at[0] + step[0], at[1] + step[1]];
        if step[0].abs().max(step[1].abs()) < 1e-15 {
            break;
        }
    }
    let [s, du, dv] = surface.jet(T::from(at[0]), T::from(at[1])).map(Vec3::re);
    let near = |x: f64| (-0.5..=1.5).contains(&x);
    let size = du.norm() + dv.norm();
    // The rest is perpendicular to the surface.
    let left = p - s;
    let along = |d: Vec3| left.dot(d).abs() / d.norm().max(f64::MIN_POSITIVE);
    let foot = left.norm() <= share * size && along(du) + along(dv) <= ON_SURFACE * size;
    (near(at[0]) && near(at[1]) && foot).then_some(at)
}

/// Newell's normal: twice the vector area.
pub(super) fn newell<T: Real>(ring: &[Vec3<T>]) -> Vec3<T> {
    let first = ring[0];
    (1..ring.len().saturating_sub(1))
        .fold(Vec3::zero(), |s, k| s + (ring[k] - first).cross(ring[k + 1] - first))
}
