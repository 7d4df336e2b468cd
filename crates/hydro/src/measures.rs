//! Lengths and volumes with their centres, by quadrature on the shapes themselves.

use crate::gauss::gauss;
use moldloft_num::{Curve, Order, Real, Solid, Vec3, integrate};

/// Relative differences below this count as none.
const ACCURACY: f64 = 1e-11;

/// The length of a curve and the centre of its length.
pub fn curve_measures<T: Real>(curve: &dyn Curve<T>) -> (T, Vec3<T>) {
    let mut ends = vec![0.0];
    let mut breaks = curve.joints();
    breaks.extend(curve.breaks());
    breaks.retain(|t| *t > 0.0 && *t < 1.0);
    breaks.sort_by(f64::total_cmp);
    ends.extend(breaks);
    ends.push(1.0);
    let (mut length, mut moment) = (T::zero(), Vec3::zero());
    for pair in ends.windows(2).filter(|p| p[1] > p[0]) {
        let [a, b] = [pair[0], pair[1]].map(T::from);
        let speed = |t: T| {
            let square = curve.jet(t, Order::First)[1].norm_sq();
            if square.re() > 0.0 { square.sqrt() } else { T::zero() }
        };
        let rough = moldloft_num::gauss_legendre(a, b, speed).re().abs();
        let reach = curve.jet(a, Order::Zero)[0].re().norm() + rough;
        length += integrate(a, b, ACCURACY * rough, speed);
        let along = |axis: usize| {
            integrate(a, b, ACCURACY * rough * reach, |t| {
                speed(t) * curve.jet(t, Order::Zero)[0][axis]
            })
        };
        moment += Vec3::new(along(0), along(1), along(2));
    }
    let centre =
        if length.re() > 0.0 { moment / length } else { curve.jet(T::zero(), Order::Zero)[0] };
    (length, centre)
}

/// The volume of a solid and its centre: eight Gauss points along each parameter of so many equal pieces that
/// twice as many change nothing. `None` when a place is not finite.
pub fn solid_measures<T: Real>(solid: &dyn Solid<T>) -> Option<(T, Vec3<T>)> {
    let sums = |pieces: usize| {
        let (mut volume, mut moment) = (T::zero(), Vec3::zero());
        let rule: Vec<(f64, f64)> = (0..pieces)
            .flat_map(|k| {
                let step = 1.0 / pieces as f64;
                gauss(8).iter().map(move |(s, w)| ((k as f64 + s) * step, w * step))
            })
            .collect();
        for &(u, a) in &rule {
            for &(v, b) in &rule {
                for &(w, c) in &rule {
                    let jet = solid.jet(u.into(), v.into(), w.into());
                    let part = jet.u.cross(jet.v).dot(jet.w) * (a * b * c);
                    volume += part;
                    moment += jet.p * part;
                }
            }
        }
        (volume, moment)
    };
    let mut last = sums(1);
    for pieces in [2, 4] {
        let next = sums(pieces);
        let off = (next.0 - last.0).re().abs();
        let near = off <= 1e-9 * next.0.re().abs();
        last = next;
        if near {
            break;
        }
    }
    let (volume, moment) = last;
    if !volume.is_finite() || !moment.is_finite() {
        return None;
    }
    if volume.re() == 0.0 {
        return Some((T::zero(), solid.eval(0.5.into(), 0.5.into(), 0.5.into())));
    }
    Some((volume.abs(), moment / volume))
}
