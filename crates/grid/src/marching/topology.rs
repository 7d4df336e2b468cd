//! The nodes of a front, their neighbours, and the grid lines through them.
//!
//! A node with four edges, ghosts beyond open edges included, has two directions, and grid lines
//! pass through it along both. A node with another number of edges is a [`NodeKind::Star`], at which
//! lines end; a collapsed edge is a [`NodeKind::Hub`].
//!
//! `cells -> fans of edges round nodes -> directions -> lines -> sweeps of lines that do not cross`

use super::settings::MarchBoundary;
use std::collections::{HashSet, VecDeque};

/// The neighbour of a node at one end of a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Reach {
    Node(usize),
    /// The ghost beyond an open edge, made from the opposite neighbour.
    Beyond(MarchBoundary),
}

/// Edge of a star: the neighbour, reflected in a plane of symmetry of constant x, y or z where it
/// belongs to the image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spoke {
    pub node: usize,
    pub mirror: Option<usize>,
    /// Cosine and sine of its angle in the plane of the parameters.
    pub angle: [f64; 2],
}

#[derive(Clone, Debug)]
pub(super) enum NodeKind {
    /// Two directions, each with the next and the last neighbour.
    Regular([[Reach; 2]; 2]),
    /// Edges in counterclockwise order, none of them opposite to another.
    Star(Vec<Spoke>),
    /// A collapsed edge.
    Hub,
}

/// A node as part of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct LineNode {
    pub node: usize,
    /// The node's direction along the line.
    pub axis: usize,
    /// The line passes the node's last neighbour before its next one.
    pub forward: bool,
    /// The node is beyond the end of the line, whose equations need it.
    pub held: bool,
}

#[derive(Clone, Debug)]
pub(super) struct GridLine {
    pub nodes: Vec<LineNode>,
    pub closed: bool,
}

/// A collapsed edge: nodes that move as one, the ring around them, and the planes of symmetry in
/// which they stay.
#[derive(Clone, Debug)]
pub(super) struct Pole {
    pub members: Vec<usize>,
    pub ring: Vec<usize>,
    pub planes: Vec<usize>,
}

/// Corners of a cell in counterclockwise order as seen from the grid's side, beginning with its
/// first point; the patch, and the indices of the cell, from 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrontCell {
    pub corners: [usize; 4],
    pub patch: usize,
    pub at: [usize; 2],
}

pub(super) struct FrontTopology {
    pub nodes: Vec<NodeKind>,
    pub lines: Vec<GridLine>,
    /// Lines of which no two cross, in the order of their first node.
    pub sweeps: Vec<Vec<usize>>,
    /// The lines through each node.
    pub lines_of: Vec<[Option<usize>; 2]>,
    /// For each line, if one of its nodes is at a pole.
    pub ends_in_pole: Vec<bool>,
    pub cells: Vec<FrontCell>,
    /// Edges whose length limits a step.
    pub limits: Vec<[usize; 2]>,
    /// All edges.
    pub edges: Vec<[usize; 2]>,
    /// Open edges.
    pub borders: Vec<[usize; 2]>,
    pub poles: Vec<Pole>,
    pub is_pole: Vec<bool>,
    /// Nodes at open edges, and the coordinates that they keep.
    pub kept: Vec<(usize, [bool; 3])>,
    /// Patch and indices, from 1, of the first point that is the node.
    pub places: Vec<(usize, [usize; 2])>,
}

/// A place at which cells do not form a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FanFault {
    /// More than two cells at an edge, or cells of opposite sides.
    Edge(usize, usize),
    /// Cells that have only this node in common.
    Pinched(usize),
    /// One or two cells, all around the node.
    Flat(usize),
    /// Number of cells that are too many at a free edge.
    Crowded(usize, usize),
}

/// The cells around a node in counterclockwise order.
pub(super) struct CellFan {
    /// The neighbours; of an open fan one more than cells.
    spokes: Vec<usize>,
    closed: bool,
}

impl CellFan {
    pub fn cells(&self) -> usize {
        self.spokes.len() - usize::from(!self.closed)
    }

    /// The fan of corners, each between two edges.
    fn of(node: usize, mut corners: Vec<[usize; 2]>) -> Result<Self, FanFault> {
        let count = corners.len();
        for (k, [from, to]) in corners.iter().enumerate() {
            for [other_from, other_to] in &corners[..k] {
                if from == other_from || to == other_to {
                    let end = if from == other_from { *from } else { *to };
                    return Err(FanFault::Edge(node, end));
                }
            }
        }
        let first = corners.iter().position(|[from, _]| corners.iter().all(|c| c[1] != *from));
        let closed = first.is_none();
        let mut spokes = Vec::with_capacity(count + 1);
        let mut at = Some(first.unwrap_or(0));
        while let Some(k) = at {
            let [from, to] = corners.swap_remove(k);
            spokes.push(from);
            at = corners.iter().position(|c| c[0] == to);
            if at.is_none() && !closed {
                spokes.push(to);
            }
        }
        if !corners.is_empty() {
            return Err(FanFault::Pinched(node));
        }
        Ok(Self { spokes, closed })
    }

    /// The node's kind. `ahead` and `behind` are its neighbours along the first index of the patch, of which
    /// one may be missing; `condition` is that of an open edge.
    pub fn kind(
        &self,
        node: usize,
        [ahead, behind]: [Option<usize>; 2],
        condition: impl Fn([usize; 2]) -> MarchBoundary,
    ) -> Result<NodeKind, FanFault> {
        let count = self.cells();
        if self.closed {
            return match count {
                1 | 2 => Err(FanFault::Flat(node)),
                4 => {
                    let ring = [0, 1, 2, 3].map(|k| Reach::Node(self.spokes[k]));
                    Ok(regular(ring, [ahead, behind]))
                }
                _ => Ok(star(self.spokes.iter().map(|node| (*node, None)).collect())),
            };
        }
        let last = self.spokes[count];
        let ends = [condition([node, self.spokes[0]]), condition([node, last])];
        let spoke = |k: usize| Reach::Node(self.spokes[k]);
        match (count, ends) {
            (1, [a, b]) => {
                let ring = [spoke(0), spoke(1), Reach::Beyond(b), Reach::Beyond(a)];
                Ok(regular(ring, [ahead, behind]))
            }
            (2, [a, b]) => {
                let is_symmetric = matches!(b, MarchBoundary::Symmetry(_));
                let beyond = if is_symmetric { b } else { a };
                let ring = [spoke(0), spoke(1), spoke(2), Reach::Beyond(beyond)];
                Ok(regular(ring, [ahead, behind]))
            }
            (_, [MarchBoundary::Symmetry(a), MarchBoundary::Symmetry(b)]) if a == b => {
                let real = self.spokes.iter().map(|node| (*node, None));
                let image = self.spokes[1..count].iter().rev().map(|node| (*node, Some(a)));
                Ok(star(real.chain(image).collect()))
            }
            (3, _) => Ok(regular([spoke(0), spoke(1), spoke(2), spoke(3)], [ahead, behind])),
            _ => Err(FanFault::Crowded(node, count)),
        }
    }

    /// The open edges at the node.
    fn open(&self) -> Option<[usize; 2]> {
        (!self.closed).then(|| [self.spokes[0], self.spokes[self.spokes.len() - 1]])
    }
}

/// The node of four neighbours in counterclockwise order, turned so that its first direction is
/// that of the patch.
fn regular(ring: [Reach; 4], [ahead, behind]: [Option<usize>; 2]) -> NodeKind {
    let find =
        |node: Option<usize>| node.and_then(|k| ring.iter().position(|r| *r == Reach::Node(k)));
    let start = find(ahead).or_else(|| find(behind).map(|k| k + 2)).unwrap_or(0);
    let at = |k: usize| ring[(start + k) % 4];
    NodeKind::Regular([[at(0), at(2)], [at(1), at(3)]])
}

fn star(spokes: Vec<(usize, Option<usize>)>) -> NodeKind {
    let count = spokes.len() as f64;
    let each = spokes.into_iter().enumerate();
    let spokes = each.map(|(k, (node, mirror))| {
        let (sine, cosine) = libm::sincos(std::f64::consts::TAU * k as f64 / count);
        Spoke { node, mirror, angle: [cosine, sine] }
    });
    NodeKind::Star(spokes.collect())
}

/// A patch as nodes: its size, the node of each of its points, and if its indices are exchanged so
/// that its normal is on the side of the others.
pub(super) struct PatchNodes {
    pub size: [usize; 2],
    pub nodes: Vec<usize>,
    pub crossed: bool,
}

impl PatchNodes {
    pub fn node(&self, i: usize, j: usize) -> usize {
        self.nodes[i * self.size[1] + j]
    }

    /// The cells with a positive area, as [`FrontCell::corners`].
    pub fn cells(&self) -> impl Iterator<Item = ([usize; 4], [usize; 2])> + '_ {
        let [m, n] = self.size;
        let each = (0..m - 1).flat_map(move |i| (0..n - 1).map(move |j| [i, j]));
        each.map(move |[i, j]| {
            let [a, b, c, d] =
                [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(|[i, j]| self.node(i, j));
            (if self.crossed { [a, d, c, b] } else { [a, b, c, d] }, [i + 1, j + 1])
        })
    }

    /// The next and the last node along the first direction.
    fn along(&self, i: usize, j: usize) -> [Option<usize>; 2] {
        let [m, n] = self.size;
        if self.crossed {
            [(j + 1 < n).then(|| self.node(i, j + 1)), (j > 0).then(|| self.node(i, j - 1))]
        } else {
            [(i + 1 < m).then(|| self.node(i + 1, j)), (i > 0).then(|| self.node(i - 1, j))]
        }
    }
}

/// The corners of a cell, without repeated ones.
pub(super) fn polygon(corners: [usize; 4]) -> Vec<usize> {
    let mut found: Vec<usize> = Vec::with_capacity(4);
    for (k, node) in corners.into_iter().enumerate() {
        if node != corners[(k + 3) % 4] {
            found.push(node);
        }
    }
    found
}

/// The fans of all nodes; of hubs `None`.
pub(super) fn fans(
    patches: &[PatchNodes],
    count: usize,
    is_hub: &[bool],
) -> Result<Vec<Option<CellFan>>, FanFault> {
    let mut corners: Vec<Vec<[usize; 2]>> = vec![Vec::new(); count];
    for (cell, _) in patches.iter().flat_map(PatchNodes::cells) {
        let polygon = polygon(cell);
        let n = polygon.len();
        for k in 0..n {
            let at = |step: usize| polygon[(k + step) % n];
            corners[polygon[k]].push([at(1), at(n - 1)]);
        }
    }
    let each = corners.into_iter().enumerate();
    each.map(|(node, corners)| match is_hub[node] {
        true => Ok(None),
        false => CellFan::of(node, corners).map(Some),
    })
    .collect()
}

impl FrontTopology {
    /// The front of these patches. `condition` is that of an open edge between two nodes, `poles` are its
    /// collapsed edges, whose nodes are hubs where several points are one node.
    pub fn new(
        patches: &[PatchNodes],
        fans: &[Option<CellFan>],
        poles: Vec<Pole>,
        condition: &impl Fn([usize; 2]) -> MarchBoundary,
    ) -> Result<Self, FanFault> {
        let count = fans.len();
        let mut places = vec![None; count];
        let mut along = vec![[None; 2]; count];
        let mut cells = Vec::new();
        for (p, patch) in patches.iter().enumerate() {
            for (k, &node) in patch.nodes.iter().enumerate() {
                let (i, j) = (k / patch.size[1], k % patch.size[1]);
                if places[node].is_none() {
                    places[node] = Some((p, [i + 1, j + 1]));
                    along[node] = patch.along(i, j);
                }
            }
            cells.extend(patch.cells().map(|(corners, at)| FrontCell { corners, patch: p, at }));
        }
        let mut nodes = Vec::with_capacity(count);
        let mut kept = Vec::new();
        for (node, fan) in fans.iter().enumerate() {
            let Some(fan) = fan else {
                nodes.push(NodeKind::Hub);
                continue;
            };
            nodes.push(fan.kind(node, along[node], condition)?);
            for end in fan.open().into_iter().flatten() {
                let coordinates = condition([node, end]).kept();
                if coordinates != [false; 3] {
                    kept.push((node, coordinates));
                }
            }
        }
        let mut is_pole = vec![false; count];
        for node in poles.iter().flat_map(|pole| &pole.members) {
            is_pole[*node] = true;
        }
        let (limits, edges) = edges(patches, &is_pole);
        let borders = borders(patches, fans);
        let (lines, lines_of) = traced(&nodes);
        let sweeps = sweeps(&lines, &lines_of);
        let at_pole = |line: &GridLine| line.nodes.iter().any(|at| is_pole[at.node]);
        let ends_in_pole = lines.iter().map(at_pole).collect();
        let places = places.into_iter().map(|place| place.expect("a point at each node")).collect();
        Ok(Self {
            nodes,
            lines,
            sweeps,
            lines_of,
            ends_in_pole,
            cells,
            limits,
            edges,
            borders,
            poles,
            is_pole,
            kept,
            places,
        })
    }
}

/// The edges whose length limits a step, and all edges, direction by direction.
fn edges(patches: &[PatchNodes], is_pole: &[bool]) -> (Vec<[usize; 2]>, Vec<[usize; 2]>) {
    let (mut limits, mut all) = (Vec::new(), Vec::new());
    let mut seen = HashSet::new();
    for patch in patches {
        let [m, n] = patch.size;
        let collapsed = [0, 1].map(|axis| {
            let line = |end: usize| {
                let other = patch.size[1 - axis];
                let last = end * (patch.size[axis] - 1);
                (0..other).all(|k| {
                    is_pole[if axis == 0 { patch.node(last, k) } else { patch.node(k, last) }]
                })
            };
            line(0) || line(1)
        });
        for axis in 0..2 {
            let (count, lines) = if axis == 0 { (m, n) } else { (n, m) };
            for line in 0..lines {
                for k in 0..count - 1 {
                    let at = |k: usize| match axis {
                        0 => patch.node(k, line),
                        _ => patch.node(line, k),
                    };
                    let edge = [at(k), at(k + 1)];
                    let [a, b] = edge;
                    if a == b || !seen.insert([a.min(b), a.max(b)]) {
                        continue;
                    }
                    all.push(edge);
                    // Edges round a pole are short by right.
                    let round = collapsed[1 - axis] && !collapsed[axis];
                    if !round && !edge.iter().all(|node| is_pole[*node]) {
                        limits.push(edge);
                    }
                }
            }
        }
    }
    (limits, all)
}

/// The open edges, side by side of the patches.
fn borders(patches: &[PatchNodes], fans: &[Option<CellFan>]) -> Vec<[usize; 2]> {
    let mut found = Vec::new();
    let is_open = |[a, b]: [usize; 2]| {
        a != b
            && [(a, b), (b, a)].iter().any(|(node, other)| {
                let open = fans[*node].as_ref().and_then(CellFan::open);
                open.is_some_and(|ends| ends.contains(other))
            })
    };
    for patch in patches {
        let [m, n] = patch.size;
        for (i, line) in [(true, 0), (true, m - 1), (false, 0), (false, n - 1)] {
            let at = |k: usize| if i { patch.node(line, k) } else { patch.node(k, line) };
            let count = if i { n } else { m };
            found.extend((0..count - 1).map(|k| [at(k), at(k + 1)]).filter(|edge| is_open(*edge)));
        }
    }
    found
}

/// The grid lines: of each direction of each regular node one.
fn traced(nodes: &[NodeKind]) -> (Vec<GridLine>, Vec<[Option<usize>; 2]>) {
    let mut of = vec![[None; 2]; nodes.len()];
    let mut lines = Vec::new();
    for node in 0..nodes.len() {
        for axis in 0..2 {
            if of[node][axis].is_none() && matches!(nodes[node], NodeKind::Regular(_)) {
                let line = line_through(nodes, &mut of, [node, axis], lines.len());
                lines.push(line);
            }
        }
    }
    (lines, of)
}

fn line_through(
    nodes: &[NodeKind],
    of: &mut [[Option<usize>; 2]],
    [node, axis]: [usize; 2],
    number: usize,
) -> GridLine {
    of[node][axis] = Some(number);
    let start = LineNode { node, axis, forward: true, held: false };
    let mut halves = [Vec::new(), Vec::new()];
    // Backward first, then forward.
    for (half, ahead) in [(0, false), (1, true)] {
        let mut here = start;
        while let NodeKind::Regular(ways) = &nodes[here.node] {
            let slot = usize::from(here.forward != ahead);
            let Reach::Node(next) = ways[here.axis][slot] else { break };
            let held = LineNode { node: next, axis: 0, forward: true, held: true };
            let NodeKind::Regular(others) = &nodes[next] else {
                halves[half].push(held);
                break;
            };
            let back = (0..4).find(|k| others[k / 2][k % 2] == Reach::Node(here.node));
            let Some(back) = back else { break };
            let (b, entered) = (back / 2, back % 2);
            if (next, b) == (node, axis) && !ahead && entered == 0 {
                let mut nodes = vec![start];
                nodes.extend(halves[0].iter().rev());
                return GridLine { nodes, closed: true };
            }
            if of[next][b].is_some() || of[next][1 - b] == Some(number) {
                halves[half].push(held);
                break;
            }
            of[next][b] = Some(number);
            // A line that is followed forward enters a node from its last neighbour.
            here = LineNode { node: next, axis: b, forward: (entered == 1) == ahead, held: false };
            halves[half].push(here);
        }
    }
    let mut line: Vec<LineNode> = halves[0].iter().rev().copied().collect();
    line.push(start);
    line.extend(&halves[1]);
    GridLine { nodes: line, closed: false }
}

/// The lines in as few sets of lines that do not cross as a greedy choice finds.
fn sweeps(lines: &[GridLine], of: &[[Option<usize>; 2]]) -> Vec<Vec<usize>> {
    let mut colours: Vec<Option<usize>> = vec![None; lines.len()];
    for first in 0..lines.len() {
        if colours[first].is_some() {
            continue;
        }
        let mut queue = VecDeque::from([first]);
        while let Some(line) = queue.pop_front() {
            if colours[line].is_some() {
                continue;
            }
            let mut used = Vec::new();
            for at in lines[line].nodes.iter().filter(|at| !at.held) {
                let Some(other) = of[at.node][1 - at.axis] else { continue };
                match colours[other] {
                    Some(colour) => used.push(colour),
                    None => queue.push_back(other),
                }
            }
            colours[line] = (0..).find(|colour| !used.contains(colour));
        }
    }
    let count = colours.iter().flatten().max().map_or(0, |most| most + 1);
    let mut sweeps = vec![Vec::new(); count];
    for (line, colour) in colours.into_iter().enumerate() {
        sweeps[colour.expect("each line has one")].push(line);
    }
    sweeps
}
