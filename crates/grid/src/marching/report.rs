//! Measures of a march: cells, corners, walls, and the criterion of an early end.

use super::front::{Front, MarchOutcome};
use super::outcome::{FailureCause, MarchReport, StopReason};
use super::settings::Hyperbolic;
use crate::surface_grid::SAME;
use crate::{Corner, GridError, GridSide};
use moldloft_num::{Real, Vec3};

/// The least scaled Jacobian of the cells of a layer, with the cell, and the greatest skewness.
#[derive(Clone, Copy, Debug)]
pub(super) struct Worst {
    pub jacobian: f64,
    pub cell: usize,
    pub skewness: f64,
}

impl Worst {
    pub fn none() -> Self {
        Self { jacobian: f64::INFINITY, cell: 0, skewness: 0.0 }
    }

    pub fn take(&mut self, cell: usize, [jacobian, skewness]: [f64; 2]) {
        // NaN is the worst.
        if !(jacobian >= self.jacobian) {
            (self.jacobian, self.cell) = (jacobian, cell);
        }
        self.skewness = self.skewness.max(skewness);
    }

    pub fn worse(self, other: Self) -> Self {
        let mut worst = self;
        worst.take(other.cell, [other.jacobian, other.skewness]);
        worst
    }
}

/// Scaled Jacobian and equiangle skewness of a quadrilateral, as seen against a normal.
pub(super) fn quad(corners: [Vec3; 4], up: Vec3) -> [f64; 2] {
    let (mut least, mut skew) = (f64::INFINITY, 0.0f64);
    for k in 0..4 {
        let (next, last) = (corners[(k + 1) % 4] - corners[k], corners[(k + 3) % 4] - corners[k]);
        let scale = next.norm() * last.norm();
        let sine = next.cross(last).dot(up) / scale;
        if !(sine >= least) {
            least = sine;
        }
        skew = skew.max(angle_skewness(next, last));
    }
    [least, skew]
}

/// Deviation of the angle between two edges from 90°, relative to 90°.
pub(super) fn angle_skewness(a: Vec3, b: Vec3) -> f64 {
    let angle = libm::atan2(a.cross(b).norm(), a.dot(b));
    (angle / std::f64::consts::FRAC_PI_2 - 1.0).abs()
}

/// Scaled Jacobian and skewness of a hexahedron with corners `p[a][b][c]`; corners at edges without length,
/// which poles have, do not count.
pub(crate) fn hexahedron(p: [[[Vec3; 2]; 2]; 2]) -> [f64; 2] {
    let (mut least, mut skew) = (f64::INFINITY, 0.0f64);
    for k in 0..8 {
        let (a, b, c) = (k >> 2, k >> 1 & 1, k & 1);
        let here = p[a][b][c];
        let turn = |x: usize| if x == 0 { 1.0 } else { -1.0 };
        let i = (p[1 - a][b][c] - here) * turn(a);
        let j = (p[a][1 - b][c] - here) * turn(b);
        let l = (p[a][b][1 - c] - here) * turn(c);
        let scale = i.norm() * j.norm() * l.norm();
        if scale == 0.0 {
            continue;
        }
        let det = i.cross(j).dot(l) / scale;
        if !(det >= least) {
            least = det;
        }
        for (x, y) in [(i, j), (j, l), (l, i)] {
            skew = skew.max(angle_skewness(x, y));
        }
    }
    [least, skew]
}

/// True when a first cell fits into a concave corner whose half angle has this sine and cosine; false when it is
/// so tight that the layer has to be approached by steps, which keep within 5 degrees of the normal there.
///
/// Lines off the neighbours of the corner, at the distance `spacing`, cross its bisector at the height
/// spacing tan(half angle), which no march can pass; beyond 0.95 of it nothing is left of the first edge.
///
/// # Errors
/// If the corner is sharper and the cell higher.
pub(super) fn fits_corner(
    [sine, cosine]: [f64; 2],
    spacing: f64,
    height: f64,
) -> Result<bool, FailureCause> {
    /// The tangent of the lean that is allowed, 5 degrees.
    const LEAN: f64 = 0.087_488_663_525_924;
    let cot = cosine / sine;
    let fits = 0.95 * spacing / cot;
    if height > fits && cot > LEAN {
        let angle = 2.0 * libm::atan2(sine, cosine).to_degrees();
        return Err(FailureCause::CornerTooTight { angle, spacing, height, fits });
    }
    Ok(height <= fits)
}

/// Weight of a layer by its distance from the wall: (s / last)^0.15, independent of the number of
/// layers.
pub(super) fn shift<T: Real>(s: T, last: T) -> T {
    (s / last).powf(T::from(0.15))
}

/// The sensor of converging lines: the ratio of the spans before and now to the power 2 / shift, between 0.1 and
/// 1000 (Chan and Steger 1992, section 6).
pub(super) fn convergence<T: Real>(ratio: T, shift: T) -> T {
    let plain = libm::pow(ratio.re(), 2.0 / shift.re());
    if !(plain > 0.1) {
        return T::from(0.1);
    }
    if plain > 1e3 {
        return T::from(1e3);
    }
    ratio.powf(T::from(2.0) / shift)
}

/// Refuses seams that do not close: pairs of points that shall be one, with their indices.
pub(super) fn check_seam<T: Real>(
    pairs: &[(Vec3, Vec3, [usize; 2])],
    points: &[Vec3<T>],
) -> Result<(), GridError> {
    let origin = points[0].re();
    let size = points.iter().map(|p| p.re().distance(origin)).fold(0.0, f64::max);
    for (a, b, at) in pairs {
        let gap = a.distance(*b);
        if gap > SAME * size {
            let corner = Corner { edge: GridSide::FirstI, other: GridSide::LastI, at: *at };
            return Err(GridError::EdgesApart { corner, gap });
        }
    }
    Ok(())
}

/// The layers up to where the options end the march, and the report of them.
///
/// # Errors
/// [`GridError::March`] where the march failed and its layers are not kept.
pub(super) fn settled<T: Real>(
    front: &impl Front<T>,
    options: &Hyperbolic<T>,
    outcome: MarchOutcome<T>,
    first: Vec<(f64, f64)>,
) -> Result<(Vec<Vec<Vec3<T>>>, MarchReport), GridError> {
    let MarchOutcome { mut layers, steps, rung, failure } = outcome;
    if let Some(failure) = &failure
        && !options.stop.keep
    {
        return Err(GridError::March(Box::new(failure.clone())));
    }
    let mut stopped = failure.map(StopReason::Failure);
    let mut worst = Worst::none();
    let (mut layer, mut at) = (1, front.cell_place(0).0);
    let mut growth = 1.0f64;
    let stop = &options.stop;
    for k in 1..layers.len() {
        let cells = front.worst_cell(&layers[k - 1], &layers[k]);
        let grown = if k > 1 { growth_of(&layers[k - 2..=k]) } else { 1.0 };
        let reason = if cells.jacobian < stop.jacobian {
            Some(StopReason::Jacobian(cells.jacobian))
        } else if cells.skewness > stop.skewness {
            Some(StopReason::Skewness(cells.skewness))
        } else if grown > stop.growth {
            Some(StopReason::Growth(grown))
        } else {
            None
        };
        if reason.is_some() {
            stopped = reason;
            layers.truncate(k);
            break;
        }
        if cells.jacobian < worst.jacobian {
            (layer, at) = (k + 1, front.cell_place(cells.cell).0);
        }
        worst = worst.worse(cells);
        growth = growth.max(grown);
        if stop.isotropic && k + 1 < layers.len() && isotropic(front, &layers[k - 1], &layers[k]) {
            stopped = Some(StopReason::Isotropic);
            layers.truncate(k + 1);
            break;
        }
    }
    let (mut low, mut high, mut angle) = (f64::INFINITY, 0.0f64, 0.0f64);
    for (distance, off) in first {
        (low, high, angle) = (low.min(distance), high.max(distance), angle.max(off));
    }
    let report = MarchReport {
        layers: layers.len(),
        steps,
        rung,
        jacobian: worst.jacobian,
        layer,
        at,
        skewness: worst.skewness,
        first_cell: [low, high],
        wall_angle: angle,
        growth,
        stopped,
    };
    Ok((layers, report))
}

/// The largest ratio of two cells of a line that follow each other.
fn growth_of<T: Real>(layers: &[Vec<Vec3<T>>]) -> f64 {
    let nodes = 0..layers[0].len();
    nodes.fold(1.0, |most, k| {
        let a = layers[1][k].re().distance(layers[0][k].re());
        let b = layers[2][k].re().distance(layers[1][k].re());
        if a > 0.0 && b > 0.0 { f64::max(most, (b / a).max(a / b)) } else { most }
    })
}

/// True when the mean height of a layer is that of its cells' mean length.
fn isotropic<T: Real>(front: &impl Front<T>, below: &[Vec3<T>], above: &[Vec3<T>]) -> bool {
    let heights = below.iter().zip(above).map(|(a, b)| a.re().distance(b.re()));
    heights.sum::<f64>() / below.len() as f64 >= front.mean_edge(above)
}

/// Refuses heights that do not ascend from 0.
pub(super) fn check_heights<T: Real>(heights: &[T]) -> Result<(), GridError> {
    for (k, height) in heights.iter().enumerate() {
        let before = if k == 0 { -f64::MIN_POSITIVE } else { heights[k - 1].re() };
        let ascends = height.re() > before && height.is_finite();
        if !ascends || (k == 0 && height.re() != 0.0) {
            return Err(GridError::Heights { at: k + 1, value: height.re() });
        }
    }
    Ok(())
}
