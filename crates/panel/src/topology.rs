//! The skeleton of a model's panels: patches, the stretches of their edges, and the counts of
//! divisions on these.

use crate::counts::{Conflict, CountProblem, Links, Node, Sum};
use crate::draft::Draft;
use crate::edges::{DivisionRun, EdgePlan, Shares, reversed, shares_of};
use crate::identity::Alias;
use crate::knuckles::Knuckles;
use crate::notes::{ChainStep, PanelNote};
use crate::roots::{EdgeInterval, EdgeParameter, IntervalId, RootTable};
use moldloft_model::Graph;
use moldloft_num::trace::{Edge, Key, Named, Root};
use moldloft_num::{Real, Vec3};
use moldloft_registry::Spacing;
use smallvec::SmallVec;
use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

/// Excess of a length over a whole number of panels, in panels, that needs no further panel.
const COUNT_SLACK: f64 = 1e-6;

/// The most contradictions that are reported one by one.
const MOST_REPORTED: usize = 20;

/// Steps in which the length of an edge is measured, for sizes and shares.
const LENGTH_STEPS: usize = 32;

/// Any count of panels beyond this is refused elsewhere.
const MOST_DIVISIONS: f64 = 1e6;

/// Stretches of a patch's edge.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum EdgeRun {
    /// Stretches of lines of the graph, with the count on each.
    Along(Vec<(EdgeInterval, u32)>),
    /// Stretches whose counts do not add up to that of the patch, so that it is joined at its two ends alone.
    Loose(Vec<EdgeInterval>),
    /// The line of another edge 0..4 of the same patch.
    Same(u8),
    /// One point.
    Pole(Option<Key>),
}

impl EdgeRun {
    /// The stretches of the edge, whether or not its panels end where these end.
    pub fn spans(&self) -> impl Iterator<Item = &EdgeInterval> {
        let (along, loose): (&[(EdgeInterval, u32)], &[EdgeInterval]) = match self {
            EdgeRun::Along(spans) => (spans, &[]),
            EdgeRun::Loose(spans) => (&[], spans),
            EdgeRun::Same(_) | EdgeRun::Pole(_) => (&[], &[]),
        };
        along.iter().map(|(span, _)| span).chain(loose)
    }

    /// The intervals of roots among them.
    pub fn intervals(&self) -> Vec<IntervalId> {
        self.spans().filter_map(|s| s.interval).collect()
    }
}

/// A patch without its shape.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PatchTopology {
    pub key: Key,
    pub name: Arc<str>,
    pub kind: Arc<str>,
    pub colour: i32,
    pub tags: Vec<Arc<str>>,
    pub divisions: [usize; 2],
    pub runs: [EdgeRun; 4],
    pub plans: [EdgePlan; 4],
    pub corners: [Option<Key>; 4],
    /// The patch of which it is the image, and the number of the map.
    pub image: Option<(usize, u32)>,
    /// Its knuckles, if some are those of the whole that cross it.
    pub knuckles: Option<Arc<Knuckles>>,
    /// True if these are rows.
    pub conformal: bool,
    /// True if its panels are opposite to its natural normal, by the declaration of its surface.
    pub reversed: bool,
    /// True for a face of a cavity.
    pub cavity: bool,
    /// False for a hidden surface with a visible image, and for a hem.
    pub meshed: bool,
    /// For a hem, which of its sheet's.
    pub border_curve: Option<u32>,
}

/// All of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PanelTopology {
    pub patches: Vec<PatchTopology>,
    /// The point objects at each mark.
    pub points: Vec<Vec<Key>>,
    /// The stretches of declared joins, with the maximum distance of their edges.
    pub declared: Vec<(IntervalId, f64)>,
    /// The aliases of roots.
    pub aliases: Vec<Alias>,
}

/// The skeleton and the notes from its construction.
pub(crate) struct SolvedTopology {
    pub structure: PanelTopology,
    pub remarks: Vec<PanelNote>,
    /// True when some count may follow from lengths, so that it may change with any parameter.
    pub measured: bool,
}

/// Weights of the parts of a sum: the lengths of a patch's lines between parameters, or, without
/// lines, the parameters themselves.
struct PartLengths {
    patch: usize,
    /// Edges 0..4; the longest counts.
    lines: SmallVec<[usize; 2]>,
    ranges: Vec<[f64; 2]>,
}

/// Direction 0 (u) or 1 (v) of a patch, as a node of the divider.
fn side(patch: usize, direction: usize) -> Node {
    2 * patch + direction
}

/// Spacing of stretches with a given number of divisions: that of the first patch along them, and
/// whether its direction is reversed.
type IntervalShares = HashMap<(IntervalId, u32), (bool, Shares)>;

/// The counts of divisions of a model in another state, used where counts are free.
#[derive(Clone, Debug, Default)]
pub struct Nominal(pub(crate) Arc<HashMap<(Arc<str>, Option<u32>), Counts>>);

#[derive(Clone, Debug)]
pub(crate) struct Counts {
    pub divisions: [usize; 2],
    pub edges: [Vec<u32>; 4],
}

struct TopologySolver<'a, 'g> {
    graph: &'g Graph<f64>,
    drafts: &'a [Draft<'g>],
    roots: RootTable,
    spans: Vec<[Option<Vec<EdgeInterval>>; 4]>,
    divider: CountProblem,
    /// The patch and edge of each sum.
    summed: Vec<(usize, usize)>,
    lengths: Vec<PartLengths>,
    /// For each link, true if the two have opposite directions.
    turned: Vec<bool>,
    /// For each patch, the nodes of its stretches between knuckles along u and along v.
    stretches: Vec<[Vec<Node>; 2]>,
}

pub(crate) fn solve<'g>(
    graph: &'g Graph<f64>,
    roots: RootTable,
    drafts: &[Draft<'g>],
    nominal: Option<&Nominal>,
) -> SolvedTopology {
    let spans: Vec<_> = drafts
        .iter()
        .map(|draft| {
            std::array::from_fn(|k| {
                let pieces = super::roots::pieces(&draft.edges.edges[k], draft.object.key, k)?;
                Some(roots.spans(&pieces))
            })
        })
        .collect();
    let mut maker = TopologySolver {
        graph,
        drafts,
        roots,
        spans,
        divider: CountProblem::default(),
        summed: Vec::new(),
        lengths: Vec::new(),
        turned: Vec::new(),
        stretches: vec![Default::default(); drafts.len()],
    };
    maker.state();
    let measured = maker.is_measured();
    match nominal.filter(|_| measured) {
        Some(nominal) => maker.recall(nominal),
        None => maker.wish(),
    }
    let divided = maker.divider.solve(&|sum| maker.weights(sum));
    let mut remarks = maker.reported(&divided.conflicts, &divided.counts);
    remarks.extend(maker.unnamed());
    let structure = maker.finish(&divided.counts);
    if divided.conflicts.is_empty() {
        remarks.extend(maker.unexplained(&structure, &divided.counts));
    }
    SolvedTopology { structure, remarks, measured }
}

impl TopologySolver<'_, '_> {
    fn interval(&self, interval: IntervalId) -> Node {
        2 * self.drafts.len() + interval as usize
    }

    /// Nodes, links and sums.
    fn state(&mut self) {
        for draft in self.drafts {
            let (usual, stated) = (draft.usual(), draft.stated());
            for direction in 0..2 {
                self.divider.node(stated[direction], Some(usual[direction]));
            }
        }
        for _ in 0..self.roots.len() {
            self.divider.node(None, None);
        }
        for patch in 0..self.drafts.len() {
            if let Some((original, _)) = self.drafts[patch].image {
                let stated = self.drafts[patch].object.head.divided;
                for direction in 0..2 {
                    if !stated || self.divider.stated[side(patch, direction)].is_none() {
                        // An image without divisions has those of its original.
                        self.divider.stated[side(patch, direction)] = None;
                        self.link(side(patch, direction), side(original, direction), false);
                    }
                }
            }
            for k in 0..4 {
                let whole = side(patch, k % 2);
                if let Edge::SameAs(other) = self.drafts[patch].edges.edges[k]
                    && usize::from(other) % 2 != k % 2
                {
                    self.link(whole, side(patch, usize::from(other) % 2), false);
                }
                let Some(spans) = &self.spans[patch][k] else { continue };
                if !self.drafts[patch].knuckles.rows(k % 2).is_empty() {
                    self.state_stretches(patch, k);
                    continue;
                }
                let along: Vec<(IntervalId, bool)> =
                    spans.iter().filter_map(|s| Some((s.interval?, s.backwards))).collect();
                match along[..] {
                    [] => {}
                    [(interval, backwards)] => self.link(whole, self.interval(interval), backwards),
                    _ => {
                        let parts = along.iter().map(|s| self.interval(s.0)).collect();
                        let stops = self.stops(patch, k);
                        let ranges = stops.windows(2).zip(spans);
                        let ranges = ranges.filter(|(_, span)| span.interval.is_some());
                        let ranges = ranges.map(|(w, _)| [w[0], w[1]]).collect();
                        self.sum(whole, parts, (patch, k), &[k], ranges);
                    }
                }
            }
        }
        // Images break where their originals do, and are divided as these are.
        for patch in 0..self.drafts.len() {
            let Some((original, _)) = self.drafts[patch].image else { continue };
            for direction in 0..2 {
                let [own, others] = [patch, original].map(|p| self.stretches[p][direction].clone());
                if own.len() == others.len() {
                    own.into_iter().zip(others).for_each(|(a, b)| self.link(a, b, false));
                }
            }
        }
    }

    /// A count that is the sum of others, which share it by lengths where it is known.
    fn sum(
        &mut self,
        whole: Node,
        parts: Vec<Node>,
        (patch, k): (usize, usize),
        lines: &[usize],
        ranges: Vec<[f64; 2]>,
    ) {
        self.divider.sums.push(Sum { whole, parts });
        self.summed.push((patch, k));
        self.lengths.push(PartLengths { patch, lines: lines.into(), ranges });
    }

    /// True when lengths may decide some count.
    fn is_measured(&self) -> bool {
        !self.summed.is_empty()
            || self.drafts.iter().enumerate().any(|(patch, draft)| {
                if let Some(border_curve) = &draft.border_curve {
                    return border_curve.density.is_some() && border_curve.stated.is_none();
                }
                let Some(panels) = &draft.object.head.panels else { return false };
                (0..2).any(|direction| {
                    let stated = self.divider.stated[side(patch, direction)];
                    panels.size[direction].is_some() && stated.is_none()
                })
            })
    }

    /// The stretches of a patch between its knuckles, which both of its edges across them have alike: they
    /// add up to the count of the patch, and the intervals of an edge in each of them to its count.
    fn state_stretches(&mut self, patch: usize, k: usize) {
        let direction = k % 2;
        let knuckles = self.drafts[patch].knuckles.rows(direction);
        if self.stretches[patch][direction].is_empty() {
            let nodes: Vec<Node> =
                (0..=knuckles.len()).map(|_| self.divider.node(None, None)).collect();
            let mut ends = vec![0.0];
            ends.extend(knuckles.iter().map(|[a, b]| 0.5 * (a + b)));
            ends.push(1.0);
            let sides = if direction == 0 { [0, 2] } else { [3, 1] };
            // Pieces divide by length. Within one curve, equal steps of the parameter are kept.
            let chained = sides.iter().any(
                |&k| matches!(&self.drafts[patch].edges.edges[k], Edge::Pieces(p) if p.len() > 1),
            );
            let lines: &[usize] = if chained { &sides } else { &[] };
            let ranges = ends.windows(2).map(|w| [w[0], w[1]]).collect();
            self.sum(side(patch, direction), nodes.clone(), (patch, k), lines, ranges);
            self.stretches[patch][direction] = nodes;
        }
        let stops = self.stops(patch, k);
        let spans = self.spans[patch][k].as_deref().unwrap_or_default();
        let mut within: Vec<Vec<(IntervalId, bool, [f64; 2])>> =
            vec![Vec::new(); knuckles.len() + 1];
        for (span, stop) in spans.iter().zip(stops.windows(2)) {
            let Some(interval) = span.interval else { continue };
            let middle = 0.5 * (stop[0] + stop[1]);
            let at = knuckles.partition_point(|row| row[usize::from(k == 1 || k == 2)] <= middle);
            within[at].push((interval, span.backwards, [stop[0], stop[1]]));
        }
        for (at, intervals) in within.into_iter().enumerate() {
            let whole = self.stretches[patch][direction][at];
            match intervals[..] {
                [] => {}
                [(interval, backwards, _)] => self.link(whole, self.interval(interval), backwards),
                _ => {
                    let parts = intervals.iter().map(|&(i, ..)| self.interval(i)).collect();
                    let ranges = intervals.iter().map(|&(_, _, range)| range).collect();
                    self.sum(whole, parts, (patch, k), &[k], ranges);
                }
            }
        }
    }

    fn link(&mut self, a: Node, b: Node, turned: bool) {
        self.divider.links.push((a, b));
        self.turned.push(turned);
    }

    /// The parameters of an edge between its spans.
    fn stops(&self, patch: usize, k: usize) -> Vec<f64> {
        let draft = &self.drafts[patch];
        let Some(pieces) = super::roots::pieces(&draft.edges.edges[k], draft.object.key, k) else {
            return vec![0.0, 1.0];
        };
        let begin = |p: u16| if p == 0 { 0.0 } else { pieces[usize::from(p) - 1].until };
        let mut stops = vec![0.0];
        for span in self.spans[patch][k].iter().flatten() {
            stops.push(match span.until {
                EdgeParameter::Piece(p) => pieces[usize::from(p)].until,
                EdgeParameter::Inside(p, _, alias) => {
                    let piece = &pieces[usize::from(p)];
                    let t = self.roots.places()[span.ends[1] as usize].parameter();
                    let t = self.roots.own_parameter(alias, t);
                    let share = (t - piece.from.t) / (piece.to.t - piece.from.t);
                    begin(p) + (piece.until - begin(p)) * share
                }
            });
        }
        stops
    }

    fn weights(&self, sum: usize) -> Vec<f64> {
        let PartLengths { patch, lines, ranges } = &self.lengths[sum];
        let weight = |&[from, to]: &[f64; 2]| {
            let lengths = lines.iter().map(|&k| self.length(*patch, k, from, to));
            if lines.is_empty() { to - from } else { lengths.fold(0.0, f64::max) }
        };
        ranges.iter().map(weight).collect()
    }

    /// The length of an edge (0..4) or middle line (4 along u, 5 along v) between two parameters.
    fn length(&self, patch: usize, k: usize, from: f64, to: f64) -> f64 {
        let surface = &self.drafts[patch].surface;
        let n = LENGTH_STEPS as f64;
        let ts: Vec<f64> =
            (0..=LENGTH_STEPS).map(|i| from + (to - from) * (i as f64 / n)).collect();
        let fixed = [match k {
            0 | 3 => 0.0,
            1 | 2 => 1.0,
            _ => 0.5,
        }];
        let mut points = vec![Vec3::zero(); ts.len()];
        match k % 2 {
            0 => surface.grid(&ts, &fixed, &mut points, None),
            _ => surface.grid(&fixed, &ts, &mut points, None),
        }
        points.windows(2).map(|w| w[0].distance(w[1])).sum()
    }

    /// Counts that follow from sizes.
    fn wish(&mut self) {
        for (patch, draft) in self.drafts.iter().enumerate().filter(|(_, d)| d.fine.is_none()) {
            let Some(panels) = &draft.object.head.panels else { continue };
            for direction in 0..2 {
                let Some(size) = panels.size[direction] else { continue };
                if self.divider.stated[side(patch, direction)].is_some() {
                    continue;
                }
                let lines = if direction == 0 { [0, 2, 4] } else { [3, 1, 5] };
                let length = lines.map(|k| self.length(patch, k, 0.0, 1.0)).into_iter();
                let count = count_of(length.fold(0.0, f64::max), size, panels.spacing[direction]);
                self.divider.wished[side(patch, direction)] = Some(count);
            }
        }
    }

    /// The counts of another state of the model, where they are free.
    fn recall(&mut self, nominal: &Nominal) {
        for (patch, draft) in self.drafts.iter().enumerate() {
            let Some(counts) = nominal.0.get(&draft.identity()) else { continue };
            for direction in 0..2 {
                self.divider.wished[side(patch, direction)] =
                    Some(counts.divisions[direction] as u32);
            }
            for k in 0..4 {
                let spans = self.spans[patch][k].iter().flatten();
                let along: Vec<IntervalId> = spans.filter_map(|s| s.interval).collect();
                if along.len() == counts.edges[k].len() {
                    for (interval, &n) in along.into_iter().zip(&counts.edges[k]) {
                        let node = self.interval(interval);
                        self.divider.wished[node] = Some(n);
                    }
                }
            }
        }
    }

    fn reported(&self, conflicts: &[Conflict], counts: &[u32]) -> Vec<PanelNote> {
        let mut remarks: Vec<PanelNote> = conflicts
            .iter()
            .take(MOST_REPORTED)
            .map(|conflict| match conflict {
                Conflict::Chain(path) => self.chain(path),
                Conflict::Sum(sum) => self.pieces(*sum, counts),
            })
            .collect();
        if conflicts.len() > MOST_REPORTED {
            remarks.push(PanelNote::More(conflicts.len() - MOST_REPORTED));
        }
        remarks
    }

    /// Edges whose counts do not add up though no sum is contradicted: a crack is never without a word.
    fn unexplained(&self, structure: &PanelTopology, counts: &[u32]) -> Vec<PanelNote> {
        let edges = structure.patches.iter().flat_map(|p| (0..4).map(move |k| (p, k)));
        let loose = edges.filter_map(|(patch, k)| {
            let EdgeRun::Loose(spans) = &patch.runs[k] else { return None };
            let intervals = spans.iter().filter_map(|s| s.interval);
            let pieces = intervals.map(|i| (self.curve(i), counts[self.interval(i)])).collect();
            Some(PanelNote::Pieces {
                patch: patch.name.to_string(),
                along: Self::letter(k % 2),
                divisions: patch.divisions[k % 2] as u32,
                pieces,
            })
        });
        loose.take(MOST_REPORTED).collect()
    }

    fn letter(direction: usize) -> char {
        if direction == 0 { 'u' } else { 'v' }
    }

    fn chain(&self, path: &[Node]) -> PanelNote {
        let patches = 2 * self.drafts.len();
        let mut chain: Vec<ChainStep> = Vec::new();
        for (at, &node) in path.iter().enumerate() {
            if node >= patches {
                continue;
            }
            let next = path[at + 1..].iter().find(|&&n| n < patches || self.is_interval(n));
            let shares = match next {
                Some(&next) if next >= patches => self.curve((next - patches) as IntervalId),
                Some(_) => "being its image".into(),
                None => String::new(),
            };
            chain.push(ChainStep {
                patch: self.drafts[node / 2].object.name.to_string(),
                along: Self::letter(node % 2),
                shares,
            });
        }
        let stated = |node: Option<&Node>| node.and_then(|&n| self.divider.stated[n]).unwrap_or(0);
        PanelNote::Divisions { chain, divisions: [stated(path.first()), stated(path.last())] }
    }

    fn pieces(&self, sum: usize, counts: &[u32]) -> PanelNote {
        let (patch, k) = self.summed[sum];
        let Sum { whole, parts } = &self.divider.sums[sum];
        let patches = 2 * self.drafts.len();
        let pieces = parts
            .iter()
            .map(|&node| {
                let words = if self.is_interval(node) {
                    self.curve((node - patches) as IntervalId)
                } else {
                    "between two knuckles".into()
                };
                (words, counts[node])
            })
            .collect();
        PanelNote::Pieces {
            patch: self.drafts[patch].object.name.to_string(),
            along: Self::letter(k % 2),
            divisions: counts[*whole],
            pieces,
        }
    }

    /// The declared joins of parts whose ends are not named.
    fn unnamed(&self) -> impl Iterator<Item = PanelNote> {
        self.roots.unnamed().iter().map(|&(join, end)| PanelNote::PartEnds {
            join: self.graph.get(join).map_or_else(String::new, |o| o.name.to_string()),
            end: end.map(|end| words_for(self.graph, end)),
        })
    }

    /// True for the node of an interval of a root.
    fn is_interval(&self, node: Node) -> bool {
        let first = 2 * self.drafts.len();
        (first..first + self.roots.len()).contains(&node)
    }

    /// The description of a stretch.
    fn curve(&self, interval: IntervalId) -> String {
        let name = |key: Key| words_for(self.graph, key);
        match self.roots.root_of(interval) {
            Root::Curve(key) => name(key),
            Root::Segment(a, b) | Root::Governed(a, b, _) => {
                format!("the line from {} to {}", name(a), name(b))
            }
            Root::Edge(key, k) => key.edge(usize::from(k)).map_or_else(String::new, name),
        }
    }

    /// The spacing of each direction of each patch: its own, else that of the nearest in its chain.
    fn spacings(&self) -> Vec<Spacing> {
        let nodes = self.divider.stated.len();
        let mut spacing: Vec<Option<Spacing>> = vec![None; nodes];
        let mut queue = VecDeque::new();
        for (patch, draft) in self.drafts.iter().enumerate() {
            let Some(panels) = &draft.object.head.panels else { continue };
            for direction in 0..2 {
                if let Some(own) = panels.spacing[direction] {
                    spacing[side(patch, direction)] = Some(own);
                    queue.push_back(side(patch, direction));
                }
            }
        }
        if !queue.is_empty() {
            let links = Links::new(nodes, &self.divider.links);
            let turned: HashMap<(Node, Node), bool> =
                self.divider.links.iter().copied().zip(self.turned.iter().copied()).collect();
            while let Some(node) = queue.pop_front() {
                for &next in links.of(node) {
                    if spacing[next].is_none() {
                        let turned = turned.get(&(node, next)).or(turned.get(&(next, node)));
                        let here = spacing[node].unwrap_or_default();
                        let turned = turned.is_some_and(|t| *t);
                        spacing[next] = Some(if turned { here.reversed() } else { here });
                        queue.push_back(next);
                    }
                }
            }
        }
        spacing.into_iter().map(Option::unwrap_or_default).collect()
    }

    fn finish(&self, counts: &[u32]) -> PanelTopology {
        let spacings = self.spacings();
        let mut settled = IntervalShares::new();
        let mut patches = Vec::with_capacity(self.drafts.len());
        for (patch, draft) in self.drafts.iter().enumerate() {
            let divisions = [0, 1].map(|d| counts[side(patch, d)]);
            let mut runs: [EdgeRun; 4] = std::array::from_fn(|_| EdgeRun::Pole(None));
            let mut plans: [EdgePlan; 4] =
                std::array::from_fn(|k| EdgePlan::Whole(divisions[k % 2], None));
            for k in 0..4 {
                let n = divisions[k % 2];
                let law = &spacings[side(patch, k % 2)];
                (runs[k], plans[k]) = match &draft.edges.edges[k] {
                    Edge::Pole(point) => {
                        let point = point.map(|p| self.roots.point(p));
                        (EdgeRun::Pole(point), EdgePlan::Whole(n, None))
                    }
                    Edge::SameAs(other) => (EdgeRun::Same(*other), EdgePlan::As(*other)),
                    _ => self.edge((patch, k), n, law, counts, &mut settled),
                };
            }
            for k in 0..4 {
                let opposite = (k + 2) % 4;
                if matches!(plans[k], EdgePlan::As(other) if usize::from(other) % 2 != k % 2) {
                    plans[k] = EdgePlan::Whole(divisions[k % 2], None);
                }
                if !matches!(runs[k], EdgeRun::Pole(_)) {
                    continue;
                }
                plans[k] = match runs[opposite] {
                    EdgeRun::Pole(_) | EdgeRun::Same(_) => {
                        let n = divisions[k % 2];
                        EdgePlan::Whole(n, shares_of(&spacings[side(patch, k % 2)], 0, n, n))
                    }
                    _ => EdgePlan::As(opposite as u8),
                };
            }
            if let Some((original, _)) = draft.image
                && counts[side(original, 0)] == divisions[0]
                && counts[side(original, 1)] == divisions[1]
            {
                for k in 0..4 {
                    // Its vertices are the images of those of its original, at any position.
                    if matches!(&runs[k], EdgeRun::Along(spans) if spans.len() == 1) {
                        plans[k] = EdgePlan::Like(original as u32);
                    }
                }
            }
            let across = !draft.knuckles.across.is_empty();
            patches.push(PatchTopology {
                key: draft.object.key,
                name: draft.object.name.clone(),
                kind: draft.object.row.name.as_ref().into(),
                colour: draft.object.head.colour,
                tags: draft.object.head.panels.as_ref().map_or(Vec::new(), |p| p.tags.clone()),
                divisions: divisions.map(|n| n as usize),
                runs,
                plans,
                corners: draft.edges.corners.map(|c| c.map(|c| self.roots.point(c))),
                image: draft.image,
                knuckles: across.then(|| draft.knuckles.clone()),
                conformal: across,
                reversed: draft.reversed,
                cavity: draft.cavity,
                meshed: draft.meshed,
                border_curve: draft.border_curve.as_ref().map(|h| h.index),
            });
        }
        let points = self.roots.places().iter().map(|p| p.points.to_vec()).collect();
        let intervals = 0..self.roots.len() as u32;
        let declared = if self.roots.has_declared() {
            intervals.filter_map(|i| Some((i, self.roots.tolerance(i)?))).collect()
        } else {
            Vec::new()
        };
        PanelTopology { patches, points, declared, aliases: self.roots.aliases().to_vec() }
    }

    fn edge(
        &self,
        (patch, k): (usize, usize),
        n: u32,
        law: &Spacing,
        counts: &[u32],
        settled: &mut IntervalShares,
    ) -> (EdgeRun, EdgePlan) {
        let spans = self.spans[patch][k].as_deref().unwrap_or_default();
        let border_curve = self.drafts[patch].border_curve.as_ref();
        // A border that curvature divides is spaced by it, unless a neighbour has a law of its own.
        let density = border_curve.and_then(|b| b.density.as_ref()).filter(|_| law.is_even());
        let stops = density.map(|_| self.stops(patch, k));
        let along = spans.iter().filter(|s| s.interval.is_some()).count();
        let count = |span: &EdgeInterval| match span.interval {
            None => 0,
            // The only stretch has the patch's own count, even where a chain was cut.
            Some(_) if along == 1 => n,
            Some(interval) => counts[self.interval(interval)],
        };
        let Some(first) = spans.first() else {
            return (EdgeRun::Pole(None), EdgePlan::Whole(n, None));
        };
        if along == 0 {
            let point = self.roots.places()[first.ends[0] as usize].points.first().copied();
            return (EdgeRun::Pole(point), EdgePlan::Whole(n, None));
        }
        if spans.iter().map(count).sum::<u32>() != n {
            return (EdgeRun::Loose(spans.to_vec()), EdgePlan::Whole(n, None));
        }
        let mut begin = 0;
        let mut segments = Vec::with_capacity(along);
        for (at, span) in spans.iter().enumerate() {
            let Some(interval) = span.interval else { continue };
            let count = count(span);
            let own = || {
                let shares = match (density, &stops) {
                    (Some(density), Some(stops)) if count > 1 => {
                        Some(density.shares(stops[at], stops[at + 1], count).into())
                    }
                    _ => shares_of(law, begin, begin + count, n),
                };
                (span.backwards, shares)
            };
            let (backwards, shares) = settled.entry((interval, count)).or_insert_with(own);
            let same_way = *backwards == span.backwards;
            let shares = if same_way { shares.clone() } else { reversed(shares) };
            segments.push(DivisionRun { until: span.until, count, shares });
            begin += count;
        }
        let plan = match &segments[..] {
            [only] => EdgePlan::Whole(n, only.shares.clone()),
            _ => EdgePlan::Segments(segments),
        };
        (EdgeRun::Along(spans.iter().map(|s| (*s, count(s))).collect()), plan)
    }
}

/// The words for an object or a part of one.
pub(crate) fn words_for(graph: &Graph<f64>, key: Key) -> String {
    let name = |key: Key| graph.get(key).map_or("", |o| &*o.name);
    match key.named() {
        Named::Object(key) => format!("`{}`", name(key)),
        Named::Corner(key, k) => {
            let corner = ["(0, 0)", "(1, 0)", "(1, 1)", "(0, 1)"][k];
            format!("corner {corner} of `{}`", name(key))
        }
        Named::Edge(key, k) => {
            let edge = ["v = 0", "u = 1", "v = 1", "u = 0"][k];
            format!("edge {edge} of `{}`", name(key))
        }
        Named::End(key, k) => format!("the {} of `{}`", ["begin", "end"][k], name(key)),
        Named::Joint(key, k) => format!("joint {} of `{}`", k + 1, name(key)),
    }
}

/// Number of panels of about `size` in a length: equal ones are not longer; the smallest of growing
/// ones has that size.
fn count_of(length: f64, size: f64, spacing: Option<Spacing>) -> u32 {
    let ratio = length / size;
    let n = match spacing {
        Some(Spacing::Growth(q)) if q != 1.0 => {
            // size (q^n - 1) / (q - 1) = length, with the growth above 1.
            let q = q.max(1.0 / q);
            Real::ln(1.0 + ratio * (q - 1.0)) / Real::ln(q)
        }
        _ => ratio,
    };
    // Rounding must not turn 10.000000001 panels into 11.
    (n - COUNT_SLACK).ceil().clamp(1.0, MOST_DIVISIONS) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_make_counts() {
        assert_eq!(count_of(10.0, 0.5, None), 20);
        assert_eq!(count_of(10.1, 0.5, None), 21);
        assert_eq!(count_of(0.0, 0.5, None), 1);
        // 1 + 2 + 4 + 8 = 15.
        assert_eq!(count_of(15.0, 1.0, Some(Spacing::Growth(2.0))), 4);
        assert_eq!(count_of(15.0, 1.0, Some(Spacing::Growth(0.5))), 4);
        assert_eq!(count_of(1e30, 1e-9, None), 1_000_000);
    }
}
