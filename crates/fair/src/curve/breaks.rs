//! Detection of intended corners and of single wrong points by outliers among the jumps.

use crate::{Job, KnotJumps};
use moldloft_num::Vec3;

/// Ratio to the median above which a jump is an outlier.
const OUTSTANDING: f64 = 8.0;

/// Minimum number of jumps that form a pattern.
const FEWEST: usize = 3;

/// An irregularity that noise does not explain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finding {
    /// The polygon turns at this control point: probably an intended break.
    Corner {
        /// The control point.
        index: usize,
        /// The change of the polygon's direction per unit of the parameter.
        turn: Vec3<f64>,
    },
    /// This control point alone is displaced: probably a wrong digit.
    Outlier {
        /// The control point.
        index: usize,
        /// The displacement: the point minus this agrees with its neighbours.
        error: Vec3<f64>,
    },
}

impl Finding {
    /// The control point of the finding.
    pub fn index(&self) -> usize {
        match *self {
            Finding::Corner { index, .. } | Finding::Outlier { index, .. } => index,
        }
    }
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let number = self.index() + 1;
        match self {
            Finding::Corner { .. } => write!(f, "point {number} looks like an intended break"),
            Finding::Outlier { error, .. } => {
                write!(f, "point {number} is off by {:.3e}: a wrong digit?", error.norm())
            }
        }
    }
}

/// Outliers among the jumps, largest first.
///
/// A single wrong point spreads over the jumps as its column of the jump matrix (on uniform cubics
/// 1, -4, 6, -4, 1), a corner as the jumps of a hinge (1, -2, 1). While some jump exceeds eight
/// times the median, the better fit of the two patterns is subtracted and reported. These are
/// proposals: a sharp turn on few control points is an outlier too.
pub fn findings(job: &Job) -> Vec<Finding> {
    let space = &job.space;
    let n = space.count();
    let jumps = KnotJumps::of(space);
    let rows = job.own_rows(&jumps.rows);
    let relative = job.relative(&job.points);
    let mut left: Vec<Vec3<f64>> = (0..rows.len()).map(|k| rows.apply(k, &relative)).collect();
    let listeners = rows.transposed(n);
    let size = relative.iter().map(|p| p.norm()).fold(0.0, f64::max);
    let mut found = Vec::new();
    // Jumps that neither pattern explains: sharp bends, and the ends, where too few jumps see a
    // point to tell whose fault it is.
    let mut plain = vec![false; left.len()];
    for _ in 0..n / 4 + 1 {
        let mut lengths: Vec<f64> = left.iter().map(|e| e.norm()).collect();
        for (length, plain) in lengths.iter_mut().zip(&plain) {
            if *plain {
                *length = 0.0;
            }
        }
        let worst = (0..left.len()).fold(0, |w, k| if lengths[k] > lengths[w] { k } else { w });
        let largest = lengths[worst];
        lengths.sort_by(f64::total_cmp);
        let median = lengths[lengths.len() / 2].max(1e-10 * size);
        if largest < OUTSTANDING * median {
            break;
        }
        let mut best: Option<(f64, Finding, Vec<(usize, Vec3<f64>)>)> = None;
        let (columns, _) = rows.row(worst);
        for &k in columns {
            for corner in [false, true] {
                let pattern = pattern(job, &jumps, &listeners, k as usize, corner);
                if pattern.len() < FEWEST {
                    continue;
                }
                let square: f64 = pattern.iter().map(|(_, x)| x * x).sum();
                if square == 0.0 {
                    continue;
                }
                let sum = pattern.iter().fold(Vec3::zero(), |s, &(r, x)| s + left[r] * x);
                let factor = sum * (1.0 / square);
                let explained = factor.norm_sq() * square;
                if best.as_ref().is_none_or(|(most, ..)| explained > most * (1.0 + 1e-9)) {
                    let index = k as usize;
                    let finding = if corner {
                        Finding::Corner { index, turn: factor }
                    } else {
                        Finding::Outlier { index, error: factor }
                    };
                    let change = pattern.iter().map(|&(r, x)| (r, factor * x)).collect();
                    best = Some((explained, finding, change));
                }
            }
        }
        let near = |change: &[(usize, Vec3<f64>)]| -> f64 {
            change.iter().map(|&(r, _)| left[r].norm_sq()).sum()
        };
        let Some((.., finding, change)) = best.filter(|(e, _, c)| *e >= 0.5 * near(c)) else {
            plain[worst] = true;
            continue;
        };
        for (r, e) in change {
            left[r] -= e;
        }
        found.push(finding);
    }
    found
}

/// The jumps that a wrong point or a corner at control point `k` makes, by jump row.
fn pattern(
    job: &Job,
    jumps: &KnotJumps,
    listeners: &crate::SparseRows,
    k: usize,
    corner: bool,
) -> Vec<(usize, f64)> {
    let (rows, factors) = listeners.row(k);
    if !corner {
        return rows.iter().map(|&r| r as usize).zip(factors.iter().copied()).collect();
    }
    let space = &job.space;
    let p = space.degree() as isize;
    let n = space.count() as isize;
    let own = if space.is_closed() { k as isize - (p + 1) / 2 } else { k as isize };
    let greville = |s: isize| (1..=p).map(|i| space.knot(s + i)).sum::<f64>() / p as f64;
    let zero = greville(own);
    rows.iter()
        .map(|&r| {
            let mut m = jumps.knots[r as usize] as isize;
            if space.is_closed() {
                m = own + (m - own).rem_euclid(n);
            }
            let (_, factors) = jumps.rows.row(r as usize);
            let hinge = factors.iter().zip(m - p - 1..).map(|(&x, s)| {
                let above = greville(s) - zero;
                if above > 0.0 { x * above } else { 0.0 }
            });
            (r as usize, hinge.sum())
        })
        .collect()
}

/// The job with corners as marks, and with the radius of a displaced point extended by its error,
/// so that the point can move to its neighbours and these stay.
pub fn with_findings(job: &Job, found: &[Finding]) -> Job {
    let mut job = job.clone();
    for finding in found {
        match *finding {
            Finding::Corner { index, .. } => job.marks.push(index),
            Finding::Outlier { index, error } => {
                if !job.marks.contains(&index) && job.limit.radii[index] > 0.0 {
                    job.limit.radii[index] += error.norm();
                }
            }
        }
    }
    job.marks.sort_unstable();
    job.marks.dedup();
    job
}
