//! Derivatives of points that a search found: one Newton step in numbers that carry them.

use crate::measure::moved::moved_by;
use crate::set::body::{SurfacedSet, is_one_surface};
use crate::{Leaf, Primitive, Ray, Set, ValueGradient};
use moldloft_num::solve_dense;
use moldloft_num::{Real, Vec3};

/// The primitives among `leaves` on whose zero sets the body ends at a point, three at most, as they are without a sheet.
fn active<T: Real>(
    leaves: &[Leaf<T>],
    body: &SurfacedSet,
    at: Vec3,
    tolerance: f64,
) -> Vec<Primitive<T>> {
    let mut found: Vec<Primitive<T>> = Vec::new();
    let shown = body.shown_at(at, tolerance);
    for leaf in leaves {
        let f = leaf.primitive.of_sheet();
        let ValueGradient { value, slope } = f.gradient(Vec3::lifted(at));
        let near = value.re().abs() <= tolerance * slope.re().norm();
        // Two of the same tangent plane determine no edge.
        let new = || {
            let n = slope.re().normalized().unwrap_or_default();
            found.iter().all(|g| {
                let m = g.gradient(Vec3::lifted(at)).slope.re().normalized().unwrap_or_default();
                n.cross(m).norm() > 1e-9
            })
        };
        let shows = || {
            let plain = f.re();
            shown.iter().any(|s| is_one_surface(s, &plain))
        };
        if near && found.len() < 3 && new() && shows() {
            found.push(f.clone());
        }
    }
    found
}

/// The point `at` of a set's surface nearest to `p`, with its derivatives: the stationary point of
/// |x - p|^2 / 2 + sum of l_k f_k.
pub fn nearest<T: Real>(set: &Set<T>, p: Vec3<T>, at: Vec3, tolerance: f64) -> Vec3<T> {
    let body = set.re().as_body();
    match step(&active(&set.leaves(), &body, at, tolerance), p, at) {
        Some(step) => moved_by(at, step),
        None => Vec3::lifted(at),
    }
}

/// The point near `at` on the same primitives that is nearest to `p` to rounding; `at` itself when Newton's
/// method does not lead to a nearer one at once.
pub fn polished(body: &SurfacedSet, p: Vec3, at: Vec3, tolerance: f64) -> Vec3 {
    let surfaces = active(&body.compiled.leaves, body, at, tolerance);
    let mut x = at;
    for _ in 0..20 {
        let Some(step) = step(&surfaces, p, x) else { return at };
        x += step;
        if step.norm() <= 1e-15 * (1.0 + x.norm()) {
            break;
        }
    }
    let size = 1.0 + x.norm();
    let near = x.distance(at) <= 0.1 * (p.distance(at) + tolerance)
        && x.distance(p) <= at.distance(p) + 1e-12 * size;
    let shown = || body.member(x, 1e-12 * size, &surfaces) == crate::Membership::Surface;
    if x.is_finite() && near && shown() { x } else { at }
}

/// Newton's step from `at` towards the stationary point of |x - p|^2 / 2 + sum of l_k f_k.
fn step<T: Real>(surfaces: &[Primitive<T>], p: Vec3<T>, at: Vec3) -> Option<Vec3<T>> {
    let m = surfaces.len();
    if m == 0 {
        return None;
    }
    let jets: Vec<_> = surfaces.iter().map(|f| f.hessian(Vec3::lifted(at))).collect();
    // The multipliers by least squares: p - x = sum of l_k n_k.
    let away = p.re() - at;
    let mut normal = vec![0.0; m * m];
    let mut l = vec![0.0; m];
    for i in 0..m {
        let n = jets[i].slope.re();
        l[i] = n.dot(away);
        for j in 0..m {
            normal[i * m + j] = n.dot(jets[j].slope.re());
        }
    }
    solve_dense(&mut normal, &mut l).ok()?;
    let n = 3 + m;
    let mut a = vec![T::zero(); n * n];
    let mut b = vec![T::zero(); n];
    for i in 0..3 {
        a[i * n + i] = T::one();
        b[i] = p[i] - at[i];
        for (k, jet) in jets.iter().enumerate() {
            b[i] -= jet.slope[i] * l[k];
            for j in 0..3 {
                a[i * n + j] += jet.second[i][j] * l[k];
            }
            a[i * n + 3 + k] = jet.slope[i];
            a[(3 + k) * n + i] = jet.slope[i];
        }
    }
    for (k, jet) in jets.iter().enumerate() {
        b[3 + k] = -jet.value;
    }
    solve_dense(&mut a, &mut b).ok()?;
    Some(Vec3::new(b[0], b[1], b[2]))
}

/// The parameter `t` at which a ray meets the surface of `f`, with its derivatives.
pub fn along<T: Real>(f: &Primitive<T>, start: Vec3<T>, direction: Vec3<T>, t: f64) -> T {
    let g = f.gradient(start + direction * T::from(t));
    let slope = g.slope.dot(direction);
    if slope.re() == 0.0 {
        return T::from(t);
    }
    let step = g.value / slope;
    T::from_parts(|k| if k == 0 { t } else { -step.part(k) })
}

/// A ray from plain parts.
pub fn ray<T: Real>(start: Vec3<T>, direction: Vec3<T>, length: f64) -> Ray {
    Ray { start: start.re(), direction: direction.re(), length }
}
