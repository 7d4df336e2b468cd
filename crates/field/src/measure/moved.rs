//! Points on surfaces, moved as the surfaces move: the implicit function theorem at a point.

use crate::{Primitive, ValueGradient};
use moldloft_num::{Real, Vec3};
use smallvec::SmallVec;

/// Points on surfaces, as these take them along.
pub(crate) fn moved<T: Real>(
    points: &[Vec3],
    surfaces: &[SmallVec<[u32; 3]>],
    primitives: &[Option<Primitive<T>>],
) -> Vec<Vec3<T>> {
    let mut values = Vec::new();
    let mut positions = Vec::with_capacity(surfaces.len());
    for (plain, surfaces) in points.iter().zip(surfaces) {
        let p = Vec3::lifted(*plain);
        let rows: SmallVec<[(Vec3<T>, T); 3]> = surfaces
            .iter()
            .filter_map(|&leaf| {
                let tape = primitives[leaf as usize].as_ref()?.tape();
                let g = tape.eval::<ValueGradient<T>>(&p, &mut values);
                Some((g.slope, g.value))
            })
            .collect();
        positions.push(p + shortest(&rows));
    }
    positions
}

/// The point with the derivatives of a step; the step's real part is a rounding residue.
pub(crate) fn moved_by<T: Real>(plain: Vec3, step: Vec3<T>) -> Vec3<T> {
    let part = |x: f64, d: T| T::from_parts(|k| if k == 0 { x } else { d.part(k) });
    Vec3::new(part(plain.x, step.x), part(plain.y, step.y), part(plain.z, step.z))
}

/// The shortest s with n . s = -f for the rows (n, f); rows that repeat a direction are left out.
fn shortest<T: Real>(rows: &[(Vec3<T>, T)]) -> Vec3<T> {
    let mut kept: SmallVec<[(Vec3<T>, T); 3]> = SmallVec::new();
    // By Gram and Schmidt, each row less its part in those before.
    for &(n, f) in rows {
        let (mut m, mut g) = (n, f);
        for &(q, h) in &kept {
            let part = n.dot(q);
            m -= q * part;
            g -= h * part;
        }
        let size = m.norm_sq();
        if size.re() > 1e-12 * n.norm_sq().re() && kept.len() < 3 {
            let length = size.sqrt();
            kept.push((m / length, g / length));
        }
    }
    let mut step = Vec3::zero();
    for (q, h) in kept {
        step -= q * h;
    }
    step
}
