//! Marching off several surfaces as one front: their common edges, sides and conditions.

use super::fault::JoinFault;
use super::front;
use super::marched::MarchedBlocks;
use super::outcome::MarchPlace;
use super::report;
use super::settings::{Hyperbolic, MarchBoundary};
use super::surface_front::SurfaceFront;
use super::topology::{FanFault, FrontTopology, PatchNodes, Pole, fans, polygon};
use crate::{GridError, GridSide, SurfaceGrid, VolumeGrid};
use moldloft_budget::Budget;
use moldloft_num::union_find::UnionFind;
use moldloft_num::{Box3, BoxTree, Real, Vec3};
use std::collections::{BTreeMap, HashMap, VecDeque};

/// Conditions at the edges of surfaces that are not joined.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenFrontEdges {
    /// Stated conditions, for each surface at `s[1,]`, `s[m,]`, `s[,1]` and `s[,n]`.
    pub stated: Vec<[Option<MarchBoundary>; 4]>,
    /// The condition of all other open edges.
    pub others: MarchBoundary,
    /// Distance, relative to the greatest extent, within which points of edges are one point.
    pub tolerance: f64,
}

impl OpenFrontEdges {
    /// The same condition at all open edges of this number of surfaces, and a tolerance of 1e-8.
    pub fn all(surfaces: usize, others: MarchBoundary) -> Self {
        Self { stated: vec![[None; 4]; surfaces], others, tolerance: 1e-8 }
    }
}

/// Distance of open edges of two surfaces, relative to the length between two points, up to which
/// they are meant to be one.
const NEARLY: f64 = 0.1;

/// The blocks marched off surfaces whose common edges are found: points of edges nearer than the
/// tolerance are one node, which has one line.
///
/// The grid is on the side of s_i x s_j of the first surface; others are taken from the same side,
/// so a block may be left-handed. Nodes with another number of edges than four, as the corners of a
/// cube, take the equations in parameters that are spread evenly round them (as in
/// pyHyp, Secco et al. 2021); a collapsed edge is a pole; an edge may be joined with another of the same surface; a pinched edge,
/// joined with itself, is refused, since a cell at each of its ends would be flat. Surfaces that are not connected are separate fronts,
/// with the side of their own first one. The sides of `options` do not apply.
///
/// # Errors
/// [`GridError::Join`] where the surfaces are no front; those of [`super::hyperbolic`].
pub fn hyperbolic_surfaces<T: Real>(
    surfaces: &[SurfaceGrid<T>],
    edges: &OpenFrontEdges,
    options: &Hyperbolic<T>,
) -> Result<MarchedBlocks<T>, GridError> {
    hyperbolic_surfaces_until(surfaces, edges, options, &Budget::default())
}

/// As [`hyperbolic_surfaces`]; ends when `budget` is spent.
///
/// # Errors
/// Also [`GridError::Spent`].
pub fn hyperbolic_surfaces_until<T: Real>(
    surfaces: &[SurfaceGrid<T>],
    edges: &OpenFrontEdges,
    options: &Hyperbolic<T>,
    budget: &Budget,
) -> Result<MarchedBlocks<T>, GridError> {
    let join = |fault: JoinFault| GridError::Join(Box::new(fault));
    if surfaces.is_empty() || edges.stated.len() != surfaces.len() {
        let (surfaces, conditions) = (surfaces.len(), edges.stated.len());
        return Err(join(JoinFault::Count { surfaces, conditions }));
    }
    for (k, surface) in surfaces.iter().enumerate() {
        surface
            .check_count(3)
            .and_then(|()| surface.check_finite())
            .map_err(|cause| join(JoinFault::Surface { surface: k + 1, cause: Box::new(cause) }))?;
    }
    report::check_heights(&options.heights)?;
    let (front, patches) = joined(surfaces, edges).map_err(join)?;
    budget.poll()?;
    front.check_normals()?;
    let outcome = front::march(&front, options, budget)?;
    let angles = front.wall_angles(&outcome.layers);
    let (layers, report) = report::settled(&front, options, outcome, angles)?;
    let block = |patch: &PatchNodes| {
        let [m, n] = patch.size;
        VolumeGrid::from_fn([m, n, layers.len()], |i, j, k| layers[k][patch.node(i, j)])
    };
    Ok(MarchedBlocks { blocks: patches.iter().map(block).collect(), report })
}

fn joined<T: Real>(
    surfaces: &[SurfaceGrid<T>],
    edges: &OpenFrontEdges,
) -> Result<(SurfaceFront<T>, Vec<PatchNodes>), JoinFault> {
    let join = Joints::new(surfaces, edges.tolerance);
    let wall = join.wall(surfaces);
    let is_hub = join.hubs()?;
    let mut patches = join.patches;
    let pairs = pairs(&patches, &wall.places)?;
    turn(&mut patches, &pairs, &wall.places)?;
    let conditions = conditions(&patches, &pairs, edges, &is_hub)?;
    check_planes(&conditions, &wall, join.distance)?;
    check_hanging(surfaces, &patches, &conditions, &wall, join.distance)?;
    check_gaps(&patches, &conditions, &wall)?;
    let condition =
        |[a, b]: [usize; 2]| conditions.get(&[a.min(b), a.max(b)]).copied().unwrap_or_default();
    let place = |node: usize| wall.places[node];
    let named = |fault: FanFault| match fault {
        FanFault::Edge(node, _) => JoinFault::ThreeMeet { at: place(node) },
        FanFault::Pinched(node) => JoinFault::Pinched { at: place(node) },
        FanFault::Flat(node) => JoinFault::TwoCells { at: place(node) },
        FanFault::Crowded(node, cells) => JoinFault::Crowded { at: place(node), cells },
    };
    let fans = fans(&patches, wall.points.len(), &is_hub).map_err(named)?;
    let poles = poles(&patches, &is_hub, &conditions);
    let topology = FrontTopology::new(&patches, &fans, poles, &condition).map_err(named)?;
    Ok((SurfaceFront { wall: wall.points, topology, is_joined: true }, patches))
}

/// The nodes of surfaces: points of edges that coincide are one.
struct Joints {
    patches: Vec<PatchNodes>,
    count: usize,
    /// Points nearer than this are one.
    distance: f64,
}

/// The points of the nodes, and the first point of the surfaces at each.
struct StartLayer<T> {
    points: Vec<Vec3<T>>,
    places: Vec<MarchPlace>,
}

impl Joints {
    fn new<T: Real>(surfaces: &[SurfaceGrid<T>], tolerance: f64) -> Self {
        let all = surfaces.iter().flat_map(SurfaceGrid::points).map(|p| p.re());
        let bounds = Box3::around(all);
        let extent = bounds.high - bounds.low;
        let distance = tolerance * extent.x.max(extent.y).max(extent.z);
        let mut starts = vec![0];
        for surface in surfaces {
            starts.push(starts[starts.len() - 1] + surface.m * surface.n);
        }
        let total = starts[surfaces.len()];
        let mut rim: Vec<(usize, Vec3)> = Vec::new();
        for (surface, start) in surfaces.iter().zip(&starts) {
            let (m, n) = (surface.m, surface.n);
            for k in 0..m * n {
                let (i, j) = (k / n, k % n);
                if i == 0 || j == 0 || i + 1 == m || j + 1 == n {
                    rim.push((start + k, surface.at(i, j).re()));
                }
            }
        }
        rim.sort_by(|a, b| a.1.x.total_cmp(&b.1.x).then(a.0.cmp(&b.0)));
        let mut joined = UnionFind::new(total);
        for (k, (a, p)) in rim.iter().enumerate() {
            for (b, q) in &rim[k + 1..] {
                if q.x - p.x > distance {
                    break;
                }
                if p.distance(*q) <= distance {
                    joined.join(*a, *b);
                }
            }
        }
        let mut numbers = vec![usize::MAX; total];
        let mut count = 0;
        let mut number = |k: usize| {
            let first = joined.find(k);
            if numbers[first] == usize::MAX {
                numbers[first] = count;
                count += 1;
            }
            numbers[first]
        };
        let each = surfaces.iter().zip(&starts);
        let patches = each
            .map(|(surface, start)| {
                let nodes = (0..surface.m * surface.n).map(|k| number(start + k)).collect();
                PatchNodes { size: [surface.m, surface.n], nodes, crossed: false }
            })
            .collect();
        Self { patches, count, distance }
    }

    fn wall<T: Real>(&self, surfaces: &[SurfaceGrid<T>]) -> StartLayer<T> {
        let none = MarchPlace { surface: None, at: [0, 0] };
        let mut wall =
            StartLayer { points: vec![Vec3::zero(); self.count], places: vec![none; self.count] };
        for (k, (patch, surface)) in self.patches.iter().zip(surfaces).enumerate() {
            for (point, &node) in patch.nodes.iter().enumerate() {
                if wall.places[node].surface.is_none() {
                    let (i, j) = (point / surface.n, point % surface.n);
                    wall.points[node] = surface.at(i, j);
                    wall.places[node] = MarchPlace { surface: Some(k + 1), at: [i + 1, j + 1] };
                }
            }
        }
        wall
    }

    /// The nodes that are collapsed edges.
    fn hubs(&self) -> Result<Vec<bool>, JoinFault> {
        let mut is_hub = vec![false; self.count];
        for (k, patch) in self.patches.iter().enumerate() {
            for side in GridSide::ALL {
                let line = side_points(patch.size, side);
                let node = |[i, j]: [usize; 2]| patch.node(i, j);
                if line.iter().all(|at| node(*at) == node(line[0])) {
                    is_hub[node(line[0])] = true;
                } else if let Some(pair) = line.windows(2).find(|p| node(p[0]) == node(p[1])) {
                    let [i, j] = pair[1];
                    let at = MarchPlace { surface: Some(k + 1), at: [i + 1, j + 1] };
                    return Err(JoinFault::Coincident { at });
                }
            }
        }
        Ok(is_hub)
    }
}

/// The points of an edge of a patch, in ascending index.
fn side_points([m, n]: [usize; 2], side: GridSide) -> Vec<[usize; 2]> {
    match side {
        GridSide::FirstI => (0..n).map(|j| [0, j]).collect(),
        GridSide::LastI => (0..n).map(|j| [m - 1, j]).collect(),
        GridSide::FirstJ => (0..m).map(|i| [i, 0]).collect(),
        GridSide::LastJ => (0..m).map(|i| [i, n - 1]).collect(),
    }
}

/// The cells at an edge between two nodes: the patch, and if its boundary passes the edge from the lesser node to
/// the greater one.
type Pairs = BTreeMap<[usize; 2], Vec<(usize, bool)>>;

fn pairs(patches: &[PatchNodes], places: &[MarchPlace]) -> Result<Pairs, JoinFault> {
    let mut pairs = Pairs::new();
    for (p, patch) in patches.iter().enumerate() {
        for (corners, _) in patch.cells() {
            let corners = polygon(corners);
            for (k, &a) in corners.iter().enumerate() {
                let b = corners[(k + 1) % corners.len()];
                let cells = pairs.entry([a.min(b), a.max(b)]).or_default();
                cells.push((p, a < b));
                if cells.len() > 2 {
                    return Err(JoinFault::ThreeMeet { at: places[a] });
                }
            }
        }
    }
    Ok(pairs)
}

/// Takes all patches from the side of the first one that each is connected with.
fn turn(patches: &mut [PatchNodes], pairs: &Pairs, places: &[MarchPlace]) -> Result<(), JoinFault> {
    let mut links: Vec<Vec<(usize, bool, usize)>> = vec![Vec::new(); patches.len()];
    for ([node, _], cells) in pairs {
        if let [(a, forward), (b, other)] = cells[..] {
            // Two cells of one side pass their common edge in opposite directions.
            links[a].push((b, forward == other, *node));
            links[b].push((a, forward == other, *node));
        }
    }
    let mut turned: Vec<Option<bool>> = vec![None; patches.len()];
    for first in 0..patches.len() {
        if turned[first].is_some() {
            continue;
        }
        turned[first] = Some(false);
        let mut queue = VecDeque::from([first]);
        while let Some(k) = queue.pop_front() {
            let here = turned[k].expect("it was turned before it was queued");
            for &(other, opposite, node) in &links[k] {
                match turned[other] {
                    None => {
                        turned[other] = Some(here != opposite);
                        queue.push_back(other);
                    }
                    Some(there) if there != (here != opposite) => {
                        return Err(JoinFault::NotOrientable { at: places[node] });
                    }
                    Some(_) => {}
                }
            }
        }
    }
    for (patch, turned) in patches.iter_mut().zip(turned) {
        patch.crossed = turned == Some(true);
    }
    Ok(())
}

type Conditions = BTreeMap<[usize; 2], MarchBoundary>;

/// The conditions of the open edges, between two nodes each.
fn conditions(
    patches: &[PatchNodes],
    pairs: &Pairs,
    edges: &OpenFrontEdges,
    is_hub: &[bool],
) -> Result<Conditions, JoinFault> {
    let mut conditions = Conditions::new();
    for (k, patch) in patches.iter().enumerate() {
        for (side, stated) in GridSide::ALL.into_iter().zip(edges.stated[k]) {
            let line = side_points(patch.size, side);
            let node = |[i, j]: [usize; 2]| patch.node(i, j);
            let collapsed = is_hub[node(line[0])] && node(line[0]) == node(line[1]);
            let mut is_open = false;
            for pair in line.windows(2).filter(|_| !collapsed) {
                let (a, b) = (node(pair[0]), node(pair[1]));
                let pair = [a.min(b), a.max(b)];
                if pairs[&pair].len() == 1 {
                    is_open = true;
                    conditions.insert(pair, stated.unwrap_or(edges.others));
                }
            }
            let (surface, edge) = (k + 1, side);
            match stated {
                Some(MarchBoundary::Pole) if collapsed => {}
                Some(MarchBoundary::Periodic) if !is_open && !collapsed => {}
                Some(MarchBoundary::Pole | MarchBoundary::Periodic) => {
                    return Err(JoinFault::Open { surface, edge });
                }
                Some(_) if !is_open => return Err(JoinFault::NotOpen { surface, edge }),
                _ => {}
            }
        }
    }
    Ok(conditions)
}

/// Refuses planes of symmetry in which an edge is not.
fn check_planes<T: Real>(
    conditions: &Conditions,
    wall: &StartLayer<T>,
    distance: f64,
) -> Result<(), JoinFault> {
    let mut worst: Option<(MarchPlace, usize, f64)> = None;
    for ([a, b], condition) in conditions {
        let MarchBoundary::Symmetry(axis) = *condition else { continue };
        let gap = (wall.points[*a][axis].re() - wall.points[*b][axis].re()).abs();
        let later =
            |at: &MarchPlace| (at.surface, at.at) < (wall.places[*b].surface, wall.places[*b].at);
        if gap > distance && !worst.as_ref().is_some_and(|(at, ..)| later(at)) {
            worst = Some((wall.places[*b], axis, gap));
        }
    }
    worst.map_or(Ok(()), |(at, axis, gap)| Err(JoinFault::NotPlane { at, axis, gap }))
}

/// Refuses open edges with points inside another surface or between the points of another open edge.
fn check_hanging<T: Real>(
    surfaces: &[SurfaceGrid<T>],
    patches: &[PatchNodes],
    conditions: &Conditions,
    wall: &StartLayer<T>,
    distance: f64,
) -> Result<(), JoinFault> {
    let mut open: Vec<[usize; 2]> = conditions.keys().copied().collect();
    open.sort_unstable();
    let mut nodes: Vec<usize> = open.iter().flatten().copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    let point = |node: usize| wall.points[node].re();
    nodes.sort_by(|a, b| point(*a).x.total_cmp(&point(*b).x).then(a.cmp(b)));
    let near = |low: f64, high: f64| {
        let start = nodes.partition_point(|k| point(*k).x < low - distance);
        nodes[start..].iter().copied().take_while(move |k| point(*k).x <= high + distance)
    };
    for [a, b] in open {
        let (p, q) = (point(a), point(b));
        let line = q - p;
        for node in near(p.x.min(q.x), p.x.max(q.x)).filter(|k| ![a, b].contains(k)) {
            let along = (point(node) - p).dot(line) / line.norm_sq();
            if (0.0..=1.0).contains(&along) && point(node).distance(p + line * along) <= distance {
                let [at, other] = [node, a].map(|node| wall.places[node]);
                return Err(JoinFault::Hanging { at, other });
            }
        }
    }
    for (k, (surface, patch)) in surfaces.iter().zip(patches).enumerate() {
        for i in 1..surface.m - 1 {
            for j in 1..surface.n - 1 {
                let p = surface.at(i, j).re();
                let found = near(p.x, p.x).find(|node| point(*node).distance(p) <= distance);
                if let Some(node) = found.filter(|node| *node != patch.node(i, j)) {
                    let other = MarchPlace { surface: Some(k + 1), at: [i + 1, j + 1] };
                    return Err(JoinFault::Hanging { at: wall.places[node], other });
                }
            }
        }
    }
    Ok(())
}

/// Refuses an open edge that is nearly joined: all of its points are nearer to other open edges
/// than [`NEARLY`] of the length between two of its points.
fn check_gaps<T: Real>(
    patches: &[PatchNodes],
    conditions: &Conditions,
    wall: &StartLayer<T>,
) -> Result<(), JoinFault> {
    let point = |node: usize| wall.points[node].re();
    let mut open: Vec<(usize, [Vec3; 2])> = Vec::new();
    let mut edges = Vec::new();
    let sides = patches.iter().flat_map(|patch| GridSide::ALL.map(|side| (patch, side)));
    for (k, (patch, side)) in sides.enumerate() {
        let line = side_points(patch.size, side);
        let nodes: Vec<usize> = line.iter().map(|[i, j]| patch.node(*i, *j)).collect();
        let is_open = |p: &[usize]| conditions.contains_key(&[p[0].min(p[1]), p[0].max(p[1])]);
        open.extend(
            nodes.windows(2).filter(|p| is_open(p)).map(|p| (k, [point(p[0]), point(p[1])])),
        );
        if nodes.windows(2).all(is_open) {
            edges.push((k, nodes));
        }
    }
    let tree = BoxTree::new(open.iter().map(|(_, ends)| Box3::around(*ends)).collect());
    let mut met = Vec::new();
    for (k, nodes) in edges {
        let steps = nodes.windows(2).map(|p| point(p[0]).distance(point(p[1])));
        let near = NEARLY * steps.fold(f64::INFINITY, f64::min);
        let mut worst = (0.0, nodes[0]);
        let all_near = nodes.iter().all(|&node| {
            let p = point(node);
            met.clear();
            tree.meeting(Box3::around([p]).grown(near), &mut met);
            let others = met.iter().map(|&at| &open[at]).filter(|(other, _)| *other != k);
            let gap = others.map(|(_, ends)| distance_from(p, *ends)).fold(f64::INFINITY, f64::min);
            if gap > worst.0 {
                worst = (gap, node);
            }
            gap <= near
        });
        if all_near && worst.0 > 0.0 {
            return Err(JoinFault::Apart { at: wall.places[worst.1], gap: worst.0 });
        }
    }
    Ok(())
}

/// The distance of a point from a straight edge.
fn distance_from(p: Vec3, [from, to]: [Vec3; 2]) -> f64 {
    let line = to - from;
    let along = ((p - from).dot(line) / line.norm_sq()).clamp(0.0, 1.0);
    p.distance(from + line * along)
}

/// The poles, with the nodes around them and the planes of symmetry that they are in.
fn poles(patches: &[PatchNodes], is_hub: &[bool], conditions: &Conditions) -> Vec<Pole> {
    let mut rings: HashMap<usize, Vec<usize>> = HashMap::new();
    for (corners, _) in patches.iter().flat_map(PatchNodes::cells) {
        let corners = polygon(corners);
        for (k, &node) in corners.iter().enumerate().filter(|(_, node)| is_hub[**node]) {
            let ring = rings.entry(node).or_default();
            for step in [1, corners.len() - 1] {
                let beside = corners[(k + step) % corners.len()];
                if !ring.contains(&beside) {
                    ring.push(beside);
                }
            }
        }
    }
    let mut found: Vec<Pole> = rings
        .into_iter()
        .map(|(hub, ring)| {
            let mut planes: Vec<usize> = conditions
                .iter()
                .filter(|(pair, _)| pair.contains(&hub))
                .filter_map(|(_, condition)| match condition {
                    MarchBoundary::Symmetry(plane) => Some(*plane),
                    _ => None,
                })
                .collect();
            planes.sort_unstable();
            planes.dedup();
            Pole { members: vec![hub], ring, planes }
        })
        .collect();
    found.sort_by_key(|pole| pole.members[0]);
    found
}
