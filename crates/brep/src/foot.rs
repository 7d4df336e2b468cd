//! Points on several surfaces at once, which are known by functions: Newton's steps of least length.

use crate::SurfaceField;
use moldloft_num::Vec3;

const STEPS: usize = 80;

/// Distance relative to the accuracy below which a point is on the surfaces.
const ON: f64 = 1e-6;

/// The point near another that is on all the surfaces given by number in a field, within half the
/// accuracy; `None` if there is no such point within `reach`.
pub fn foot(
    field: &SurfaceField<'_>,
    surfaces: &[u32],
    start: Vec3,
    reach: f64,
    [accuracy, size]: [f64; 2],
) -> Option<Vec3> {
    const NEAR_ENOUGH: f64 = 0.1;
    const ACROSS: usize = 3;
    let off = |p: Vec3| {
        surfaces.iter().map(move |&l| {
            let (f, slope) = field(l, p);
            let norm = slope.norm();
            if f == 0.0 {
                (0.0, slope / norm.max(f64::MIN_POSITIVE))
            } else {
                (f / norm, slope / norm)
            }
        })
    };
    let worst = |rows: &[(f64, Vec3)]| {
        let far = |m: f64, (d, _): &(f64, Vec3)| {
            if d.is_nan() { f64::INFINITY } else { m.max(d.abs()) }
        };
        rows.iter().fold(0.0f64, far)
    };
    if let [only] = surfaces {
        return foot_on_one(field, *only, start, reach, [accuracy, size]);
    }
    let mut p = start;
    let mut rows: Vec<(f64, Vec3)> = off(p).collect();
    let mut best = (worst(&rows), start);
    let on = (ON * accuracy).max(1e-15 * size);
    for k in 0..STEPS {
        if best.0 <= on {
            break;
        }
        // Surfaces that touch are one within the accuracy in a whole strip: the nearest point of it suffices, and
        // others may be on another branch of their intersection.
        let touching = touch(&rows);
        if touching && best.0 <= NEAR_ENOUGH * accuracy {
            break;
        }
        let across = rows.iter().fold(Vec3::zero(), |s, (d, n)| s + *n * *d) / rows.len() as f64;
        let mut step = if touching && k < ACROSS { across } else { nearest_step(&rows) };
        if !step.is_finite() {
            break;
        }
        // Far from surfaces that nearly touch the first steps are too long.
        let long = step.norm();
        if long > 0.5 * reach {
            step = step * (0.5 * reach / long);
        }
        p -= step;
        rows.clear();
        rows.extend(off(p));
        let now = worst(&rows);
        if now < best.0 {
            best = (now, p);
        }
        if long <= 1e-16 * size {
            break;
        }
    }
    let (off, p) = best;
    (off <= 0.5 * accuracy && p.distance(start) <= reach).then_some(p)
}

/// The point of a single surface next to `start`.
fn foot_on_one(
    field: &SurfaceField<'_>,
    surface: u32,
    start: Vec3,
    reach: f64,
    [accuracy, size]: [f64; 2],
) -> Option<Vec3> {
    let off = |p: Vec3| {
        let (f, slope) = field(surface, p);
        let norm = slope.norm();
        if f == 0.0 { (0.0, slope / norm.max(f64::MIN_POSITIVE)) } else { (f / norm, slope / norm) }
    };
    let far = |d: f64| if d.is_nan() { f64::INFINITY } else { d.abs() };
    let on = (ON * accuracy).max(1e-15 * size);
    let mut p = start;
    let (mut d, mut n) = off(p);
    let mut best = (far(d), start);
    for _ in 0..STEPS {
        let mut step = n * d;
        if best.0 <= on || !step.is_finite() {
            break;
        }
        let long = step.norm();
        if long > 0.5 * reach {
            step = step * (0.5 * reach / long);
        }
        p -= step;
        (d, n) = off(p);
        if far(d) < best.0 {
            best = (far(d), p);
        }
        if long <= 1e-16 * size {
            break;
        }
    }
    let (off, p) = best;
    (off <= 0.5 * accuracy && p.distance(start) <= reach).then_some(p)
}

/// True if two of the planes are nearly parallel.
fn touch(rows: &[(f64, Vec3)]) -> bool {
    const SINE: f64 = 0.2;
    let near = |(a, b): (&Vec3, &Vec3)| a.cross(*b).norm() < SINE;
    (0..rows.len()).any(|i| (0..i).any(|j| near((&rows[i].1, &rows[j].1))))
}

/// The least step that takes a point onto planes at these distances along these normals, or nearly so where two of them
/// nearly are one: surfaces that touch have no point of their own along the common tangent.
fn nearest_step(rows: &[(f64, Vec3)]) -> Vec3 {
    const LEAST_OF_TWO: f64 = 1e-10;
    const LEAST: f64 = 1e-6;
    match rows {
        [] => Vec3::zero(),
        [(d, n)] => *n * *d,
        [(d, n), (e, m)] => {
            let (a, c) = (1.0 + LEAST_OF_TWO, n.dot(*m));
            let det = a * a - c * c;
            *n * ((a * d - c * e) / det) + *m * ((a * e - c * d) / det)
        }
        more => {
            let mut m = [[LEAST, 0.0, 0.0], [0.0, LEAST, 0.0], [0.0, 0.0, LEAST]];
            let mut r = Vec3::zero();
            for (d, n) in more {
                r += *n * *d;
                let n = n.to_array();
                for i in 0..3 {
                    for j in 0..3 {
                        m[i][j] += n[i] * n[j];
                    }
                }
            }
            let [a, b, c] = m.map(Vec3::from);
            let det = a.dot(b.cross(c));
            (b.cross(c) * r.x + c.cross(a) * r.y + a.cross(b) * r.z) / det
        }
    }
}
