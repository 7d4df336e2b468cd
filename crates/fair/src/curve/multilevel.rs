//! Long waves by coarser levels.

use crate::{FairError, Job, Measure, Motion};
use moldloft_num::Vec3;

/// The uniform cubic B-spline at `x`, 2/3 at its middle.
fn bump(x: f64) -> f64 {
    let x = x.abs();
    if x < 1.0 {
        2.0 / 3.0 - x * x + 0.5 * x * x * x
    } else if x < 2.0 {
        (2.0 - x).powi(3) / 6.0
    } else {
        0.0
    }
}

/// Sweeps over smooth bumps of falling width, the last over single control points.
///
/// Steps of one point damp a wave of L points in about 3 (L / 2 pi)^4 sweeps: 12 for L = 8, 328
/// for L = 20. A bump that is 2^k points wide moves as one, so each level damps the waves of its
/// own width. Every move is the exact minimiser of the measure along its bump, halved until every
/// point is within its limit, so the measure never rises and the limits hold. Bumps that would move a
/// point that stays fixed are left out.
///
/// One cycle costs O(n) per level. For the certified end of that road see [`crate::optimum`].
///
/// # Errors
/// [`FairError`] when the measure does not exist for the degree or is not a sum of squares.
pub fn multilevel(
    job: &Job,
    measure: Measure,
    cycles: usize,
    deepest: u32,
) -> Result<Vec<Vec3<f64>>, FairError> {
    job.check()?;
    let n = job.points.len();
    let rows = job.measure_rows(measure)?;
    let gram = rows.gram(n);
    let frozen = job.frozen();
    let closed = job.space.is_closed();
    let mut points = job.points.clone();
    let mut relative = job.relative(&points);
    let origin = job.origin();
    let mut value = vec![0.0; n];
    for _ in 0..cycles {
        for level in (0..=deepest).rev() {
            // Bumps that are wider than the curve do not fit on it.
            let Some(stride) = 1usize.checked_shl(level).filter(|&s| s <= n / 4) else { continue };
            for centre in (0..n).step_by(stride) {
                // The bump's points, in order; level 0 is a single point.
                let half = if level == 0 { 0 } else { 2 * stride as isize - 1 };
                let place = |o: isize| {
                    let i = centre as isize + o;
                    if closed {
                        Some(i.rem_euclid(n as isize) as usize)
                    } else {
                        usize::try_from(i).ok().filter(|&i| i < n)
                    }
                };
                let support: Option<Vec<(usize, f64)>> = (-half..=half)
                    .map(|o| place(o).map(|i| (i, bump(o as f64 / stride as f64))))
                    .collect();
                let Some(support) = support else { continue };
                if support.iter().any(|&(i, _)| frozen[i]) {
                    continue;
                }
                for &(i, b) in &support {
                    value[i] = b;
                }
                let (mut slope, mut stiffness) = (Vec3::zero(), 0.0);
                for &(i, b) in &support {
                    slope += gram.apply(i, &relative) * b;
                    let (columns, factors) = gram.row(i);
                    let along = columns.iter().zip(factors).map(|(&c, &a)| a * value[c as usize]);
                    stiffness += b * along.sum::<f64>();
                }
                for &(i, _) in &support {
                    value[i] = 0.0;
                }
                if stiffness <= 0.0 {
                    continue;
                }
                let way = slope * (-1.0 / stiffness);
                let way = match job.limit.motion {
                    Motion::Ball | Motion::Box => way,
                    Motion::Along(d) => d * way.dot(d),
                    Motion::Across(d) => way - d * way.dot(d),
                };
                let mut share = 1.0;
                for _ in 0..60 {
                    let fits = |&(i, b): &(usize, f64)| {
                        let away = points[i] + way * (b * share) - job.points[i];
                        let size = match job.limit.motion {
                            Motion::Box => away.x.abs().max(away.y.abs()).max(away.z.abs()),
                            _ => away.norm(),
                        };
                        size <= job.limit.radii[i]
                    };
                    if support.iter().all(fits) {
                        break;
                    }
                    share *= 0.5;
                }
                if share < 1e-12 {
                    continue;
                }
                for &(i, b) in &support {
                    let to = points[i] + way * (b * share);
                    points[i] = job.limit.nearest(i, job.points[i], points[i], to);
                    relative[i] = points[i] - origin;
                }
            }
        }
    }
    Ok(points)
}
