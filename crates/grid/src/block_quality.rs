//! Measures of the cells of a block.

use crate::VolumeGrid;
use moldloft_budget::{Budget, Spent};
use moldloft_num::{Real, Vec3};
use std::f64::consts::FRAC_PI_2;

/// Quality metric of a block's cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockMetric {
    /// Scaled Jacobian: the least triple product of the unit edges at a corner, 1 at best; negative where a corner is
    /// turned over against the block's own hand.
    ScaledJacobian,
    /// Equiangular skewness: deviation of the worst angle of a face from 90°, relative to 90°; 0 is
    /// best.
    Skew,
    /// The longest over the shortest of the three lines that join the middles of opposite faces.
    Aspect,
    /// The longest over the shortest edge.
    EdgeRatio,
    /// The larger ratio of the cell's length along i (0), j (1) or k (2) to that of its neighbours there.
    Growth(usize),
    /// The volume, of the trilinear cell.
    Volume,
}

impl BlockMetric {
    /// All, in the order of the reference.
    pub const ALL: [BlockMetric; 8] = [
        BlockMetric::ScaledJacobian,
        BlockMetric::Skew,
        BlockMetric::Aspect,
        BlockMetric::EdgeRatio,
        BlockMetric::Growth(0),
        BlockMetric::Growth(1),
        BlockMetric::Growth(2),
        BlockMetric::Volume,
    ];

    /// The name in the language.
    pub fn word(self) -> &'static str {
        match self {
            BlockMetric::ScaledJacobian => "sj",
            BlockMetric::Skew => "skew",
            BlockMetric::Aspect => "aspect",
            BlockMetric::EdgeRatio => "edge_ratio",
            BlockMetric::Growth(0) => "growth_i",
            BlockMetric::Growth(1) => "growth_j",
            BlockMetric::Growth(_) => "growth_k",
            BlockMetric::Volume => "volume",
        }
    }
}

/// The corners of a cell, by their steps along i, j and k.
type Cell<T> = [[[Vec3<T>; 2]; 2]; 2];

/// The metric of each cell, cell (i, j, k) at `(i * (nj - 1) + j) * (nk - 1) + k`.
///
/// Corners at edges without length, which poles have, do not count. A left-handed block is measured as its mirror
/// image.
pub fn block_quality<T: Real>(grid: &VolumeGrid<T>, metric: BlockMetric) -> Vec<T> {
    measured(grid, metric, &|| Ok(())).expect("nothing ends it")
}

/// As [`block_quality`]; ends early when `budget` is spent.
///
/// # Errors
/// The exceeded limit.
pub fn block_quality_until<T: Real>(
    grid: &VolumeGrid<T>,
    metric: BlockMetric,
    budget: &Budget,
) -> Result<Vec<T>, Spent> {
    measured(grid, metric, &|| budget.poll())
}

fn measured<T: Real>(
    grid: &VolumeGrid<T>,
    metric: BlockMetric,
    go_on: &dyn Fn() -> Result<(), Spent>,
) -> Result<Vec<T>, Spent> {
    let size = grid.size.map(|n| n.saturating_sub(1));
    let [ci, cj, ck] = size;
    let hand = if grid.re().volume_while(go_on)? < 0.0 { -1.0 } else { 1.0 };
    let cell = |[i, j, k]: [usize; 3]| -> Cell<T> {
        std::array::from_fn(|a| {
            std::array::from_fn(|b| std::array::from_fn(|c| grid.at(i + a, j + b, k + c)))
        })
    };
    let mut all = Vec::with_capacity(ci * cj * ck);
    for i in 0..ci {
        for j in 0..cj {
            go_on()?;
            for k in 0..ck {
                let at = [i, j, k];
                let here = cell(at);
                all.push(match metric {
                    BlockMetric::ScaledJacobian => scaled_jacobian(&here, hand),
                    BlockMetric::Skew => skew(&here),
                    BlockMetric::Aspect => {
                        let lengths = middles(&here);
                        spread(&lengths)
                    }
                    BlockMetric::EdgeRatio => spread(&edges(&here)),
                    BlockMetric::Growth(axis) => {
                        let length = middles(&here)[axis];
                        let mut most = T::one();
                        for step in [at[axis].checked_sub(1), Some(at[axis] + 1)] {
                            let Some(step) = step.filter(|step| *step < size[axis]) else {
                                continue;
                            };
                            let mut beside = at;
                            beside[axis] = step;
                            most = most.max(spread(&[length, middles(&cell(beside))[axis]]));
                        }
                        most
                    }
                    BlockMetric::Volume => volume(&here) * hand,
                });
            }
        }
    }
    Ok(all)
}

/// The edges at a corner, away from it, along i, j and k.
fn at_corner<T: Real>(p: &Cell<T>, [a, b, c]: [usize; 3]) -> [Vec3<T>; 3] {
    let here = p[a][b][c];
    [p[1 - a][b][c] - here, p[a][1 - b][c] - here, p[a][b][1 - c] - here]
}

const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [0, 0, 1], [0, 1, 0], [0, 1, 1], [1, 0, 0], [1, 0, 1], [1, 1, 0], [1, 1, 1]];

fn length<T: Real>(v: Vec3<T>) -> T {
    // The root at zero has no derivative.
    if v.re().norm_sq() == 0.0 { T::zero() } else { v.norm() }
}

fn scaled_jacobian<T: Real>(p: &Cell<T>, hand: f64) -> T {
    let mut least: Option<T> = None;
    for corner in CORNERS {
        let [u, v, w] = at_corner(p, corner);
        let scale = length(u) * length(v) * length(w);
        if scale.re() == 0.0 {
            continue;
        }
        let turned = if corner.iter().sum::<usize>() % 2 == 0 { hand } else { -hand };
        let jacobian = u.cross(v).dot(w) / scale * turned;
        least = Some(least.map_or(jacobian, |least| least.min(jacobian)));
    }
    least.unwrap_or_else(T::zero)
}

fn skew<T: Real>(p: &Cell<T>) -> T {
    let mut most = T::zero();
    for corner in CORNERS {
        let [u, v, w] = at_corner(p, corner);
        for (a, b) in [(u, v), (v, w), (w, u)] {
            if (length(a) * length(b)).re() == 0.0 {
                continue;
            }
            let angle = length(a.cross(b)).atan2(a.dot(b));
            most = most.max((angle * (1.0 / FRAC_PI_2) - T::one()).abs());
        }
    }
    most
}

/// The lengths between the middles of opposite faces.
fn middles<T: Real>(p: &Cell<T>) -> [T; 3] {
    std::array::from_fn(|axis| {
        let mut line = Vec3::zero();
        for corner in CORNERS {
            let [a, b, c] = corner;
            let way = if corner[axis] == 1 { 0.25 } else { -0.25 };
            line += p[a][b][c] * T::from(way);
        }
        length(line)
    })
}

fn edges<T: Real>(p: &Cell<T>) -> Vec<T> {
    let mut all = Vec::with_capacity(12);
    for corner in CORNERS {
        for (axis, edge) in at_corner(p, corner).into_iter().enumerate() {
            let long = length(edge);
            // Each edge once; those of poles do not count.
            if corner[axis] == 0 && long.re() > 0.0 {
                all.push(long);
            }
        }
    }
    all
}

/// The greatest over the least; infinite where that is nothing.
fn spread<T: Real>(lengths: &[T]) -> T {
    let most = lengths.iter().copied().reduce(T::max).unwrap_or_else(T::one);
    let least = lengths.iter().copied().reduce(T::min).unwrap_or_else(T::one);
    if most.re() == least.re() { T::one() } else { most / least }
}

/// The volume of the trilinear cell, positive when right-handed: of the triple product of its rates, which has at most
/// the second degree in each direction, by two points of Gauss along each.
fn volume<T: Real>(p: &Cell<T>) -> T {
    let near = 0.5 - 0.5 / 3f64.sqrt();
    let mut sum = T::zero();
    for corner in CORNERS {
        let at = corner.map(|c| if c == 0 { near } else { 1.0 - near });
        let mut rates = [Vec3::zero(); 3];
        for node in CORNERS {
            let weight = |axis: usize| if node[axis] == 1 { at[axis] } else { 1.0 - at[axis] };
            let [a, b, c] = node;
            for (axis, rate) in rates.iter_mut().enumerate() {
                let way = if node[axis] == 1 { 1.0 } else { -1.0 };
                let others = (0..3).filter(|other| *other != axis).map(weight);
                *rate += p[a][b][c] * T::from(way * others.product::<f64>());
            }
        }
        sum += rates[0].cross(rates[1]).dot(rates[2]) * 0.125;
    }
    sum
}
