//! Marching off one surface.

use super::front;
use super::marched::Marched;
use super::outcome::MarchPlace;
use super::report;
use super::settings::{Hyperbolic, MarchBoundary};
use super::surface_front::SurfaceFront;
use super::topology::{FanFault, FrontTopology, PatchNodes, Pole, fans};
use crate::{GridError, SurfaceGrid};
use moldloft_budget::Budget;
use moldloft_num::{Real, Vec3};
use std::collections::HashMap;

/// The layers of a grid marched off a surface, along its normals s_i x s_j: the surface first.
///
/// Lines leave the surface on the bisecting normals with the first height, at corners and sharp
/// edges too. Each further layer solves r_i . r_k = 0, r_j . r_k = 0, r_k . (r_i x r_j) = V,
/// linearised about the layer below and factored along j and along i (Chan and Steger 1992), in
/// steps of at most half the shortest edge; where lines converge, second differences separate them.
/// Every cell is tested before it is accepted; a step that folds is repeated with less constraint,
/// then with more smoothing, and otherwise is an error.
///
/// # Errors
/// Heights that do not ascend from 0; surfaces without a normal; periodic edges that differ;
/// [`GridError::March`] with the layer, the position and the cause.
pub fn hyperbolic<T: Real>(
    surface: &SurfaceGrid<T>,
    options: &Hyperbolic<T>,
) -> Result<Marched<T>, GridError> {
    hyperbolic_until(surface, options, &Budget::default())
}

/// As [`hyperbolic`]; ends when `budget` is spent.
///
/// # Errors
/// Also [`GridError::Spent`].
pub fn hyperbolic_until<T: Real>(
    surface: &SurfaceGrid<T>,
    options: &Hyperbolic<T>,
    budget: &Budget,
) -> Result<Marched<T>, GridError> {
    surface.check_count(3)?;
    surface.check_finite()?;
    report::check_heights(&options.heights)?;
    let sides = options.sides;
    let closed = [0, 1].map(|axis| {
        sides[2 * axis] == MarchBoundary::Periodic || sides[2 * axis + 1] == MarchBoundary::Periodic
    });
    let (m, n) = (surface.m, surface.n);
    let size = [m - usize::from(closed[0]), n - usize::from(closed[1])];
    if size[0] < 3 || size[1] < 3 {
        return Err(GridError::TooFew { expected: 4, actual: [m, n] });
    }
    check_seams(surface, closed)?;
    let wall: Vec<Vec3<T>> =
        (0..size[0] * size[1]).map(|k| surface.at(k / size[1], k % size[1])).collect();
    let nodes = |k: usize| k / n % size[0] * size[1] + k % n % size[1];
    let patch = PatchNodes { size: [m, n], nodes: (0..m * n).map(nodes).collect(), crossed: false };
    let topology = topology(patch, size, closed, sides).map_err(|fault| {
        let (FanFault::Edge(k, _)
        | FanFault::Pinched(k)
        | FanFault::Flat(k)
        | FanFault::Crowded(k, _)) = fault;
        let at = MarchPlace { surface: None, at: [k / size[1] + 1, k % size[1] + 1] };
        GridError::NoNormal { at }
    })?;
    let front = SurfaceFront { wall, topology, is_joined: false };
    front.check_normals()?;
    let outcome = front::march(&front, options, budget)?;
    let angles = front.wall_angles(&outcome.layers);
    let (layers, report) = report::settled(&front, options, outcome, angles)?;
    let whole = |layer: Vec<Vec3<T>>| {
        SurfaceGrid::from_fn(m, n, |i, j| layer[i % size[0] * size[1] + j % size[1]])
    };
    Ok(Marched { layers: layers.into_iter().map(whole).collect(), report })
}

fn check_seams<T: Real>(surface: &SurfaceGrid<T>, closed: [bool; 2]) -> Result<(), GridError> {
    let (m, n) = (surface.m, surface.n);
    let mut seams = Vec::new();
    if closed[0] {
        let pair = |j: usize| (surface.at(0, j).re(), surface.at(m - 1, j).re(), [m, j + 1]);
        seams.extend((0..n).map(pair));
    }
    if closed[1] {
        let pair = |i: usize| (surface.at(i, 0).re(), surface.at(i, n - 1).re(), [i + 1, n]);
        seams.extend((0..m).map(pair));
    }
    let all: Vec<Vec3<T>> = surface.points().collect();
    report::check_seam(&seams, &all)
}

/// The front of one patch with stated conditions; the points of a collapsed edge stay nodes of their own.
fn topology(
    patch: PatchNodes,
    size: [usize; 2],
    closed: [bool; 2],
    sides: [MarchBoundary; 4],
) -> Result<FrontTopology, FanFault> {
    let line = |axis: usize, along: usize| -> Vec<usize> {
        let node = |k: usize| if axis == 0 { along * size[1] + k } else { k * size[1] + along };
        (0..size[1 - axis]).map(node).collect()
    };
    let mut conditions = HashMap::new();
    let mut poles = Vec::new();
    for axis in (0..2).filter(|axis| !closed[*axis]) {
        for (end, along, beside) in [(0, 0, 1), (1, size[axis] - 1, size[axis] - 2)] {
            let condition = sides[2 * axis + end];
            let members = line(axis, along);
            let count = members.len();
            for k in 0..count - usize::from(!closed[1 - axis]) {
                let (a, b) = (members[k], members[(k + 1) % count]);
                conditions.insert([a.min(b), a.max(b)], condition);
            }
            if condition == MarchBoundary::Pole {
                let across = [2 * (1 - axis), 2 * (1 - axis) + 1].map(|k| sides[k]);
                let plane = |side: MarchBoundary| match side {
                    MarchBoundary::Symmetry(plane) => Some(plane),
                    _ => None,
                };
                let planes = across.into_iter().filter_map(plane).collect();
                poles.push(Pole { members, ring: line(axis, beside), planes });
            }
        }
    }
    let condition =
        |[a, b]: [usize; 2]| conditions.get(&[a.min(b), a.max(b)]).copied().unwrap_or_default();
    let count = size[0] * size[1];
    let patches = [patch];
    let fans = fans(&patches, count, &vec![false; count])?;
    FrontTopology::new(&patches, &fans, poles, &condition)
}
