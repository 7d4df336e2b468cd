//! Volume, centroid and inertia: certified brackets by ranges, and best values by facets.

use super::curved::Curved;
use super::moments::{Moments, integral};
use crate::error::solid_box;
use crate::expr::interval::{Interval, sides};
use crate::expr::tape::{NO_LEAF, RangeRoom, Tape};
use crate::facet::Facets;
use crate::facet::sheets::solid_part;
use crate::facet::types::Flat;
use crate::{FieldError, Primitive, Set};
use moldloft_num::Box3;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Certified brackets of the moments of a set within a box, from ranges over boxes halved `depth`
/// times along each axis at most.
///
/// Boxes that are proved solid count fully. In the smallest boxes where one primitive decides, the
/// solid part is bracketed by two parallel planes, from the range of the gradient; in others it is
/// anything from nothing to the whole. Both make the brackets close at second order.
///
/// # Errors
/// A box without volume, a depth above 12.
///
/// # Example
/// ```
/// use moldloft_field::{Primitive, Set, bracket};
/// use moldloft_num::{Box3, Vec3};
///
/// let ball = Set::new(&Primitive::sphere(Vec3::zero(), 1.0)?);
/// let over = Box3 { low: Vec3::of(-1.1, -1.1, -1.1), high: Vec3::of(1.1, 1.1, 1.1) };
/// let volume = bracket(&ball, &over, 5)?.volume();
/// assert!(volume.contains(4.0 / 3.0 * std::f64::consts::PI) && volume.width() < 0.1);
/// # Ok::<(), moldloft_field::FieldError>(())
/// ```
pub fn bracket(set: &Set, over: &Box3, depth: u32) -> Result<Moments<Interval>, FieldError> {
    bracket_until(set, over, depth, &AtomicBool::new(false))
}

/// As [`bracket`]; ends early when `cancel` is set.
///
/// # Errors
/// As [`bracket`]; [`FieldError::Cancelled`].
pub fn bracket_until(
    set: &Set,
    over: &Box3,
    depth: u32,
    cancel: &AtomicBool,
) -> Result<Moments<Interval>, FieldError> {
    let over = solid_box(*over)?;
    if depth > 12 {
        return Err(FieldError::TooFine { boxes: 4f64.powi(depth as i32), limit: 4f64.powi(12) });
    }
    // Sheets have no volume.
    let tape = solid_part(set).compiled().tape;
    // The first two levels are spread over threads; sums are taken in order of the boxes.
    let spread = depth.min(2);
    let n = 1usize << spread;
    let boxes: Vec<[Interval; 3]> = (0..n * n * n)
        .map(|k| {
            let place = [k / (n * n), k / n % n, k % n];
            let all = sides(&over);
            [0, 1, 2].map(|axis| {
                let cut = |j: usize| {
                    if j == n {
                        all[axis].high
                    } else {
                        all[axis].low + all[axis].width() * j as f64 / n as f64
                    }
                };
                Interval::new(cut(place[axis]), cut(place[axis] + 1))
            })
        })
        .collect();
    let parts: Vec<Moments<Interval>> = boxes
        .par_iter()
        .map(|b| {
            let mut sum = Moments::ZERO;
            let mut room = RangeRoom::default();
            halve(&tape, b, depth - spread, cancel, (&mut room, &mut sum));
            sum
        })
        .collect();
    if cancel.load(Ordering::Relaxed) {
        return Err(FieldError::Cancelled);
    }
    let mut sum = Moments::ZERO;
    for part in &parts {
        sum.add(part);
    }
    Ok(sum)
}

fn halve(
    tape: &Arc<Tape<f64>>,
    b: &[Interval; 3],
    depth: u32,
    cancel: &AtomicBool,
    (room, sum): (&mut RangeRoom, &mut Moments<Interval>),
) {
    if cancel.load(Ordering::Relaxed) {
        return;
    }
    let range = tape.range(b, &mut room.ranges);
    if range.low > 0.0 {
        return;
    }
    let volume = b.iter().fold(Interval::point(1.0), |v, side| v * integral(*side, 0));
    if range.high < 0.0 {
        sum.take(b, volume, true);
        return;
    }
    let tape = tape.pruned(&room.ranges).map_or_else(|| tape.clone(), Arc::new);
    if depth == 0 {
        let single = tape.leaf.last().is_some_and(|l| *l != NO_LEAF);
        let fraction =
            if single { solid_fraction(&tape, b, room) } else { Interval::new(0.0, 1.0) };
        sum.take(b, volume * fraction, false);
        return;
    }
    for k in 0..8 {
        let half = [0, 1, 2].map(|axis| {
            let middle = b[axis].middle();
            if k >> axis & 1 == 0 {
                Interval::new(b[axis].low, middle)
            } else {
                Interval::new(middle, b[axis].high)
            }
        });
        halve(&tape, &half, depth - 1, cancel, (&mut *room, &mut *sum));
    }
}

/// A bracket of the part of a box in which one primitive is negative.
///
/// With g the middle of the gradient's range, f lies within e of f(c) + g (X - c), where e sums
/// the half widths of the gradient's range times those of the box, and the error of f(c).
fn solid_fraction(tape: &Tape<f64>, b: &[Interval; 3], room: &mut RangeRoom) -> Interval {
    let range = tape.mean_value(b, room);
    if range.value.low > 0.0 {
        return Interval::ZERO;
    }
    if range.value.high < 0.0 {
        return Interval::point(1.0);
    }
    let centre = b.map(|side| Interval::point(side.middle()));
    let value = tape.range(&centre, &mut room.ranges);
    let mut error = Interval::ZERO;
    let mut widths = [0.0; 3];
    for k in 0..3 {
        let reach = (b[k] - centre[k]).magnitude();
        let middle = range.slope[k].middle();
        error = error + (range.slope[k] - Interval::point(middle)).abs().scaled(reach);
        widths[k] = middle.abs() * b[k].width();
    }
    if !(error.high.is_finite() && widths.iter().all(|w| w.is_finite())) {
        return Interval::new(0.0, 1.0);
    }
    // Directions in which hardly anything changes join the error, to keep the formula well conditioned.
    let top = widths.iter().copied().fold(0.0, f64::max);
    let mut slack = error.high;
    for w in &mut widths {
        if *w < 1e-3 * top {
            slack += *w;
            *w = 0.0;
        }
    }
    slack *= 1.0 + 1e-9;
    // 8 terms of at most 5e6 each with a few roundings: below 1e-7.
    let low = below(widths, -value.high - slack) - 1e-7;
    let high = below(widths, -value.low + slack) + 1e-7;
    Interval::new(low.clamp(0.0, 1.0), high.clamp(0.0, 1.0))
}

/// The part of the unit cube about the origin in which w . X <= t, for weights that are zero or of like
/// size: by inclusion and exclusion of corners (Barrow and Smith, Am. Math. Monthly 86, 1979).
fn below(w: [f64; 3], t: f64) -> f64 {
    let kept: Vec<f64> = w.into_iter().filter(|w| *w > 0.0).collect();
    let n = kept.len();
    let t = t + 0.5 * kept.iter().sum::<f64>();
    if n == 0 {
        return if t >= 0.0 { 1.0 } else { 0.0 };
    }
    if t >= kept.iter().sum() {
        return 1.0;
    }
    let mut sum = 0.0;
    for corner in 0..1usize << n {
        let inside: f64 = (0..n).filter(|k| corner >> k & 1 == 1).map(|k| kept[k]).sum();
        let term = (t - inside).max(0.0).powi(n as i32);
        sum += if corner.count_ones().is_multiple_of(2) { term } else { -term };
    }
    let factorial = [1.0, 1.0, 2.0, 6.0][n];
    sum / (factorial * kept.iter().product::<f64>())
}

/// A bracket and the best value inside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mass {
    /// Proved.
    pub bracket: Moments<Interval>,
    /// From facets, curved and corrected for their distance from the surface; within the bracket.
    pub best: Moments<f64>,
}

/// The moments of a set within a box: a proved bracket and a best value, from boxes halved `depth`
/// times.
///
/// # Errors
/// As [`bracket`] and [`crate::facet`].
pub fn mass(set: &Set, over: &Box3, depth: u32) -> Result<Mass, FieldError> {
    let bracket = bracket(set, over, depth)?;
    let resolution = crate::Resolution::Level(depth);
    let options = crate::Options { sharp: true, ..crate::Options::new(resolution) };
    let facets = crate::facet(&solid_part(set), over, &options)?;
    let mut best = facets.moments();
    for (x, range) in best.0.iter_mut().zip(&bracket.0) {
        *x = x.clamp(range.low, range.high);
    }
    Ok(Mass { bracket, best })
}

impl Facets {
    /// The moments of the body, of sixth order in the size of the facets away from its edges and of fourth,
    /// with small factors, along these.
    pub fn moments(&self) -> Moments<f64> {
        let primitives: Vec<Option<Primitive>> =
            self.leaves.iter().map(|l| Some(l.primitive.clone())).collect();
        Curved::new(&self.flat()).moments(self.mesh.positions(), &primitives)
    }

    /// The area of the set's surface, of the order of [`Facets::moments`]; faces of the box do not count.
    pub fn area(&self) -> f64 {
        let primitives: Vec<Option<Primitive>> =
            self.leaves.iter().map(|l| Some(l.primitive.clone())).collect();
        let own = |leaf: u32| (leaf as usize) < self.own_leaves;
        Curved::new(&self.flat()).area(self.mesh.positions(), &primitives, own)
    }

    /// The triangles with the leaves that they and their corners are on.
    pub(crate) fn flat(&self) -> Flat<'_> {
        let ranges = self.mesh.patches().iter().zip(&self.patch_leaves);
        Flat {
            positions: self.mesh.positions(),
            faces: self.mesh.faces(),
            patches: ranges.map(|(p, &leaf)| (leaf as u32, p.faces.clone())).collect(),
            leaves: &self.leaves,
            surfaces: &self.surfaces,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cut_cube_equals_counting() {
        for (w, t) in [
            ([1.0, 0.7, 0.4], 0.3),
            ([1.0, 0.0, 0.4], -0.2),
            ([0.0, 0.0, 2.0], 0.5),
            ([1.0, 1.0, 1.0], 0.0),
        ] {
            let n = 60;
            let at = |k: usize| (k as f64 + 0.5) / n as f64 - 0.5;
            let mut count = 0;
            for i in 0..n {
                for j in 0..n {
                    count +=
                        (0..n).filter(|&k| w[0] * at(i) + w[1] * at(j) + w[2] * at(k) <= t).count();
                }
            }
            let counted = count as f64 / (n * n * n) as f64;
            assert!((below(w, t) - counted).abs() < 0.01, "{w:?} {t}: {} {counted}", below(w, t));
        }
        assert_eq!(below([1.0, 1.0, 1.0], 1.5), 1.0);
        assert_eq!(below([1.0, 1.0, 1.0], -1.5), 0.0);
    }
}
