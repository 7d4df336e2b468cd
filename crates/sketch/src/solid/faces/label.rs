//! Selection of the solid cells.
//!
//! A drawn edge must be an edge of the solid: the cells around it are neither all solid nor all
//! void. A cut edge must not be one: at most one flat face passes through it. Every labelling with
//! these properties is a solution; they are ranked by features that are rarely intended: edges with
//! more than two faces, then edges between coplanar faces, then less volume.

use super::cells::CellComplex;
use super::regions::SheetRegion;
use super::wire::Wireframe;
use moldloft_num::union_find::UnionFind;

/// Maximum number of answers kept.
pub(super) const MAX_ANSWERS: usize = 64;

/// Search steps for one group of cells.
const MAX_STEPS: usize = 400_000;

/// A labelling with its rank.
#[derive(Clone, Debug)]
pub(super) struct Answer {
    pub solid: Vec<bool>,
    /// Edges with more than two faces.
    pub branching: usize,
    /// Drawn edges between two faces of one plane.
    pub scribed: usize,
    pub volume: f64,
}

/// The labels around one edge.
struct Around {
    cut: bool,
    /// Clockwise and counter-clockwise cell of each wing, with its sheet.
    wings: Vec<([Option<usize>; 2], usize)>,
    cells: Vec<usize>,
}

impl Around {
    /// The sheets of the boundary faces at the edge.
    fn boundary(&self, solid: &dyn Fn(Option<usize>) -> bool) -> Vec<usize> {
        let faces = self.wings.iter().filter(|(c, _)| solid(c[0]) != solid(c[1]));
        faces.map(|(_, sheet)| *sheet).collect()
    }

    fn allows(&self, solid: &dyn Fn(Option<usize>) -> bool) -> bool {
        match (self.cut, self.boundary(solid).as_slice()) {
            (false, faces) => faces.len() >= 2,
            (true, []) => true,
            (true, [a, b]) => a == b,
            (true, _) => false,
        }
    }
}

/// All labellings, best first, and whether the list is complete.
pub(super) fn label(
    wire: &Wireframe,
    regions: &[SheetRegion],
    cells: &CellComplex,
) -> (Vec<Answer>, bool) {
    let count = cells.volume.len();
    let mut edges: Vec<Around> = Vec::new();
    for (e, around) in cells.wings.iter().enumerate() {
        let wings: Vec<_> = (around.iter())
            .map(|&w| (CellComplex::sides(w).map(|s| cells.side[s]), regions[w.region].sheet))
            .collect();
        let mut own: Vec<usize> = wings.iter().flat_map(|(c, _)| *c).flatten().collect();
        own.sort_unstable();
        own.dedup();
        if !wings.is_empty() || !wire.edges[e].cut {
            edges.push(Around { cut: wire.edges[e].cut, wings, cells: own });
        }
    }
    // An edge that touches no cell can never be one of the solid.
    if edges.iter().any(|e| !e.cut && e.cells.is_empty()) {
        return (vec![], true);
    }
    let mut groups = UnionFind::new(count);
    let mut of_cell: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (k, e) in edges.iter().enumerate() {
        e.cells.windows(2).for_each(|w| groups.join(w[0], w[1]));
        e.cells.iter().for_each(|&c| of_cell[c].push(k));
    }
    let start = Answer { solid: vec![false; count], branching: 0, scribed: 0, volume: 0.0 };
    let (mut answers, mut complete) = (vec![start], true);
    for group in 0..count {
        if groups.find(group) != group {
            continue;
        }
        let members: Vec<usize> = (0..count).filter(|&c| groups.find(c) == group).collect();
        let mut search = LabelSearch {
            edges: &edges,
            of_cell: &of_cell,
            order: near_first(&members, &edges, &of_cell),
            label: vec![None; count],
            found: Vec::new(),
            steps: 0,
        };
        search.run();
        complete &= search.steps < MAX_STEPS && search.found.len() < MAX_ANSWERS * 4;
        let own: Vec<&Around> = (edges.iter())
            .filter(|e| e.cells.first().is_some_and(|&c| groups.find(c) == group))
            .collect();
        let part: Vec<Answer> = (search.found.iter())
            .map(|solid_cells| {
                let mut solid = vec![false; count];
                solid_cells.iter().for_each(|&c| solid[c] = true);
                let is = |c: Option<usize>| c.is_some_and(|c| solid[c]);
                let (mut branching, mut scribed) = (0, 0);
                for e in &own {
                    match e.boundary(&is).as_slice() {
                        [a, b] => scribed += usize::from(!e.cut && a == b),
                        faces => branching += usize::from(faces.len() > 2),
                    }
                }
                let volume = solid_cells.iter().map(|&c| cells.volume[c]).sum();
                Answer { solid, branching, scribed, volume }
            })
            .collect();
        let mut joined: Vec<Answer> = Vec::new();
        for a in &answers {
            for b in &part {
                joined.push(Answer {
                    solid: a.solid.iter().zip(&b.solid).map(|(x, y)| *x || *y).collect(),
                    branching: a.branching + b.branching,
                    scribed: a.scribed + b.scribed,
                    volume: a.volume + b.volume,
                });
            }
        }
        rank(&mut joined);
        complete &= joined.len() <= MAX_ANSWERS;
        joined.truncate(MAX_ANSWERS);
        answers = joined;
    }
    answers.retain(|a| a.solid.contains(&true));
    (answers, complete)
}

fn rank(answers: &mut [Answer]) {
    let largest = answers.iter().map(|a| a.volume).fold(0.0, f64::max);
    // Volumes that differ by rounding only must not decide.
    let rounded = |v: f64| if largest > 0.0 { (v / largest * 1e9).round() } else { 0.0 };
    answers.sort_by(|a, b| {
        (a.branching.cmp(&b.branching))
            .then(a.scribed.cmp(&b.scribed))
            .then(rounded(b.volume).total_cmp(&rounded(a.volume)))
            .then(b.solid.cmp(&a.solid))
    });
}

/// The cells of a group, ordered so that each shares an edge with an earlier one.
fn near_first(members: &[usize], edges: &[Around], of_cell: &[Vec<usize>]) -> Vec<usize> {
    let mut order: Vec<usize> = Vec::new();
    let mut seen = std::collections::BTreeSet::new();
    for &first in members {
        if !seen.insert(first) {
            continue;
        }
        let mut done = order.len();
        order.push(first);
        while let Some(&at) = order.get(done) {
            done += 1;
            for &c in of_cell[at].iter().flat_map(|&e| &edges[e].cells) {
                if seen.insert(c) {
                    order.push(c);
                }
            }
        }
    }
    order
}

struct LabelSearch<'a> {
    edges: &'a [Around],
    of_cell: &'a [Vec<usize>],
    order: Vec<usize>,
    label: Vec<Option<bool>>,
    found: Vec<Vec<usize>>,
    steps: usize,
}

impl LabelSearch<'_> {
    /// Depth first with unit propagation, without recursion.
    fn run(&mut self) {
        // Per decision: the cell, whether its second value was tried, and the cells set since.
        let mut decisions: Vec<(usize, bool, Vec<usize>)> = Vec::new();
        let mut trail = Vec::new();
        let all: Vec<usize> = self.order.clone();
        let mut alive = self.propagate(&all, &mut trail);
        loop {
            self.steps += 1;
            if self.steps >= MAX_STEPS || self.found.len() >= MAX_ANSWERS * 4 {
                return;
            }
            let open = self.order.iter().copied().find(|&c| self.label[c].is_none());
            match open {
                Some(cell) if alive => {
                    let mut set = vec![cell];
                    self.label[cell] = Some(true);
                    alive = self.propagate(&[cell], &mut set);
                    decisions.push((cell, false, set));
                    continue;
                }
                None if alive => {
                    let solid = |c: &&usize| self.label[**c] == Some(true);
                    let mut cells: Vec<usize> = self.order.iter().filter(solid).copied().collect();
                    cells.sort_unstable();
                    self.found.push(cells);
                }
                _ => {}
            }
            loop {
                let Some((cell, second, set)) = decisions.pop() else { return };
                set.iter().for_each(|&c| self.label[c] = None);
                if !second {
                    let mut set = vec![cell];
                    self.label[cell] = Some(false);
                    alive = self.propagate(&[cell], &mut set);
                    decisions.push((cell, true, set));
                    break;
                }
            }
        }
    }

    /// Sets the labels implied by those of `changed`; false at a contradiction.
    fn propagate(&mut self, changed: &[usize], set: &mut Vec<usize>) -> bool {
        let mut queue: Vec<usize> =
            changed.iter().flat_map(|&c| self.of_cell[c].iter().copied()).collect();
        queue.sort_unstable();
        queue.dedup();
        while let Some(k) = queue.pop() {
            let edge = &self.edges[k];
            let mut open = edge.cells.iter().copied().filter(|&c| self.label[c].is_none());
            let (first, second) = (open.next(), open.next());
            let allowed = |cell: Option<usize>, value: bool| {
                edge.allows(&|c| match c {
                    None => false,
                    c if c == cell => value,
                    Some(c) => self.label[c] == Some(true),
                })
            };
            match (first, second) {
                (None, _) if !allowed(None, false) => return false,
                (Some(cell), None) => {
                    let value = match (allowed(Some(cell), true), allowed(Some(cell), false)) {
                        (false, false) => return false,
                        (true, true) => continue,
                        (solid, _) => solid,
                    };
                    self.label[cell] = Some(value);
                    set.push(cell);
                    queue.extend(self.of_cell[cell].iter().copied());
                }
                _ => {}
            }
        }
        true
    }
}
