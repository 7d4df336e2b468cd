//! Orientation of surfaces given as grids: consistent with neighbours, and outward for bodies.
//!
//! A body is closed at common edges, by coordinate planes that contain its rims (mirrors, the
//! water), and by flat openings, such as that of a half body with an open base. Its surfaces are
//! then turned so that its volume is positive. Other surfaces keep their own orientation, along r_i
//! x r_j, and neighbours follow the first of them.

use crate::StructuredGrid;
use moldloft_grid::{VolumeGrid, shared_nodes};
use moldloft_num::Vec3;
use moldloft_num::union_find::{SignedUnionFind, UnionFind};
use std::collections::{BTreeMap, HashMap};

/// Distance of a step from a coordinate plane, relative to its length, within which it is in the
/// plane.
const IN_PLANE: f64 = 1e-9;

/// An opening is flat when its points are within this of a plane, relative to its size.
const FLAT: f64 = 1e-6;

/// Volume, relative to the sum of the absolute volumes of its cones, below which it is zero: a
/// sheet in its own plane.
const NO_VOLUME: f64 = 1e-9;

/// A step along the rim of a grid.
#[derive(Clone, Copy)]
struct RimStep {
    grid: usize,
    /// Its nodes, and its points, in the order of a walk with the surface on the left.
    nodes: [usize; 2],
    points: [Vec3; 2],
}

impl RimStep {
    fn pair(&self) -> (usize, usize) {
        let [a, b] = self.nodes;
        (a.min(b), a.max(b))
    }

    /// The coordinate plane that contains it.
    fn plane(&self) -> Option<usize> {
        let [a, b] = self.points;
        let near = IN_PLANE * a.distance(b);
        (0..3).find(|&axis| a[axis].abs().max(b[axis].abs()) <= near)
    }
}

/// For each surface, whether its facets are to be turned against r_i x r_j; `None` once `go_on` says that the work ends.
pub fn turned(surfaces: &[StructuredGrid], go_on: &dyn Fn() -> bool) -> Option<Vec<bool>> {
    let points: Vec<Vec<Vec3>> = surfaces.iter().map(|surface| surface.layer(0)).collect();
    let mut steps = rim_steps(surfaces, &points);
    steps.sort_by_key(|step| (step.pair(), step.grid, step.nodes));
    let mut bodies = SignedUnionFind::new(surfaces.len());
    let mut free: Vec<RimStep> = Vec::new();
    for run in steps.chunk_by(|a, b| a.pair() == b.pair()) {
        match run {
            // Neighbours with the same orientation traverse a common edge in opposite directions.
            [a, b] if a.grid != b.grid => bodies.join(a.grid, b.grid, a.nodes == b.nodes),
            // A seam of a grid with itself.
            [_, _] => {}
            _ => free.extend(run),
        }
    }
    let sides: Vec<(usize, bool)> = (0..surfaces.len()).map(|k| bodies.find(k)).collect();
    let mut inward = vec![false; surfaces.len()];
    for body in (0..surfaces.len()).filter(|&k| sides[k].0 == k) {
        let rims: Vec<RimStep> =
            free.iter().filter(|step| sides[step.grid].0 == body).copied().collect();
        let Some(caps) = Caps::of(&rims) else { continue };
        let (mut volume, mut size) = (0.0, 0.0);
        for (k, surface) in surfaces.iter().enumerate().filter(|(k, _)| sides[*k].0 == body) {
            let (mut own, all) = cone(surface.size, &points[k], caps.centre, go_on)?;
            size += all;
            for (step, middle) in caps.steps.iter().filter(|(step, _)| step.grid == k) {
                let [a, b] = step.points.map(|p| p - caps.centre);
                let cap = (*middle - caps.centre).dot(b.cross(a));
                own += cap;
                size += cap.abs();
            }
            volume += if sides[k].1 { -own } else { own };
        }
        inward[body] = volume < -NO_VOLUME * size;
    }
    Some(sides.into_iter().map(|(body, against)| against != inward[body]).collect())
}

/// The steps round each surface, those at poles left out.
fn rim_steps(surfaces: &[StructuredGrid], points: &[Vec<Vec3>]) -> Vec<RimStep> {
    let rims: Vec<Vec<Vec3>> = surfaces
        .iter()
        .zip(points)
        .map(|(surface, points)| rim(surface.size).into_iter().map(|k| points[k]).collect())
        .collect();
    let rows: Vec<VolumeGrid<f64>> =
        rims.iter().map(|rim| VolumeGrid::from_fn([rim.len(), 1, 1], |k, _, _| rim[k])).collect();
    let (_, nodes) = shared_nodes(&rows);
    let mut steps = Vec::new();
    for (grid, (rim, ids)) in rims.iter().zip(&nodes).enumerate() {
        for k in (1..rim.len()).filter(|k| ids[*k] != ids[k - 1]) {
            let (nodes, points) = ([ids[k - 1], ids[k]], [rim[k - 1], rim[k]]);
            steps.push(RimStep { grid, nodes, points });
        }
    }
    steps
}

/// The path round a grid of `m` by `n` points along its four edges and back to the first, as
/// indices in memory.
fn rim([m, n, _]: [usize; 3]) -> Vec<usize> {
    let low = (0..m - 1).map(|i| i * n);
    let last = (0..n - 1).map(|j| (m - 1) * n + j);
    let high = (1..m).rev().map(|i| i * n + n - 1);
    low.chain(last).chain(high).chain((0..n).rev()).collect()
}

/// Closure of a body: none, coordinate planes, flat openings.
struct Caps {
    /// A point of the coordinate planes: from there they have no cone.
    centre: Vec3,
    /// The steps round flat openings, each with the middle of its opening.
    steps: Vec<(RimStep, Vec3)>,
}

impl Caps {
    /// `None` when planes do not close it.
    fn of(rims: &[RimStep]) -> Option<Self> {
        let mut used = [false; 3];
        let mut rest: Vec<RimStep> = Vec::new();
        for step in rims {
            match step.plane() {
                Some(axis) => used[axis] = true,
                None => rest.push(*step),
            }
        }
        let within = |p: Vec3| {
            let p = p.to_array();
            let [x, y, z] = [0, 1, 2].map(|axis| if used[axis] { 0.0 } else { p[axis] });
            Vec3::of(x, y, z)
        };
        let sum = rims.iter().fold(Vec3::zero(), |sum, step| sum + step.points[0]);
        let centre = within(if rims.is_empty() { sum } else { sum / rims.len() as f64 });
        // Openings are chains of steps with common nodes.
        let mut numbers: HashMap<usize, usize> = HashMap::new();
        for node in rest.iter().flat_map(|step| step.nodes) {
            let next = numbers.len();
            numbers.entry(node).or_insert(next);
        }
        let mut chains = UnionFind::new(numbers.len());
        rest.iter().for_each(|step| chains.join(numbers[&step.nodes[0]], numbers[&step.nodes[1]]));
        let mut openings: BTreeMap<usize, Vec<RimStep>> = BTreeMap::new();
        for step in rest {
            openings.entry(chains.find(numbers[&step.nodes[0]])).or_default().push(step);
        }
        let mut steps = Vec::new();
        for opening in openings.into_values() {
            let middle = within(flat_middle(&opening)?);
            // Chains that do not come back end in a plane that continues them.
            let mut ends: HashMap<usize, (i32, Vec3)> = HashMap::new();
            for step in &opening {
                for (node, p) in step.nodes.into_iter().zip(step.points) {
                    ends.entry(node).or_insert((0, p)).0 += 1;
                }
            }
            let size = opening.iter().map(|s| s.points[0].distance(s.points[1])).sum::<f64>();
            let in_plane = |p: Vec3| (0..3).any(|axis| used[axis] && p[axis].abs() <= FLAT * size);
            if !ends.values().all(|(count, p)| *count == 2 || in_plane(*p)) {
                return None;
            }
            steps.extend(opening.into_iter().map(|step| (step, middle)));
        }
        Some(Self { centre, steps })
    }
}

/// The middle of an opening's points; `None` when they are not in one plane.
fn flat_middle(opening: &[RimStep]) -> Option<Vec3> {
    let points: Vec<Vec3> = opening.iter().flat_map(|step| step.points).collect();
    let middle = points.iter().fold(Vec3::zero(), |sum, p| sum + *p) / points.len() as f64;
    let size = points.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
    let farthest =
        points.iter().copied().max_by(|a, b| a.distance(middle).total_cmp(&b.distance(middle)))?;
    let across = |p: &Vec3| (farthest - middle).cross(*p - middle);
    let normal = points
        .iter()
        .map(across)
        .max_by(|a, b| a.norm().total_cmp(&b.norm()))
        .and_then(Vec3::normalized);
    match normal {
        Some(normal) => {
            let off = |p: &Vec3| (*p - middle).dot(normal).abs() > FLAT * size;
            (!points.iter().any(off)).then_some(middle)
        }
        None => Some(middle),
    }
}

/// Six times the signed volume of the cones from `centre` to the cells of a surface, and the same without signs.
fn cone(
    [m, n, _]: [usize; 3],
    points: &[Vec3],
    centre: Vec3,
    go_on: &dyn Fn() -> bool,
) -> Option<(f64, f64)> {
    let at = |i: usize, j: usize| points[i * n + j] - centre;
    let (mut volume, mut size) = (0.0, 0.0);
    for i in 0..m - 1 {
        if !go_on() {
            return None;
        }
        for j in 0..n - 1 {
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            let cone = (a + c).dot((c - a).cross(d - b));
            volume += cone;
            size += cone.abs();
        }
    }
    Some((volume, size))
}
