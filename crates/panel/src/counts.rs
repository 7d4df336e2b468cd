//! Counts of divisions that are equal along chains and add up along edges of several pieces.
//!
//! Nodes are unknown counts: those of patches along u or v, and those of stretches of curves. Links
//! make counts equal, sums make a count the sum of others; some counts are given. Given counts
//! propagate along links and through sums as intervals; free ones get their wish, their part of a
//! known sum, or the default. Contradictions do not stop the rest: the chain is cut between the
//! given counts, or the sum is left out, and both are reported.

use std::collections::{BTreeSet, VecDeque};

/// A count of divisions is below this.
const MOST: u32 = 1_000_000;

/// Maximum number of evaluations of a sum; more indicate a divergent one (a chain in a ring whose
/// count would be larger than itself).
const MAX_ROUNDS: u32 = 2000;

/// Maximum number of sums examined for one step of a repair.
const REACH: usize = 20_000;

/// Maximum number of steps of repairs in total.
const MOST_STEPS: usize = 2000;

/// The number of a count to be found.
pub(crate) type Node = usize;

/// A count that is the sum of others.
#[derive(Clone, Debug)]
pub(crate) struct Sum {
    pub whole: Node,
    /// Two or more.
    pub parts: Vec<Node>,
}

/// The counts, their constraints and wishes.
#[derive(Debug, Default)]
pub(crate) struct CountProblem {
    /// By node.
    pub stated: Vec<Option<u32>>,
    pub wished: Vec<Option<u32>>,
    /// The default count of a node; only for counts of patches.
    pub usual: Vec<Option<u32>>,
    pub links: Vec<(Node, Node)>,
    pub sums: Vec<Sum>,
}

/// Statements that cannot all hold.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Conflict {
    /// The nodes from one stated count to another that should be equal.
    Chain(Vec<Node>),
    /// A sum, by its index, that does not come out.
    Sum(usize),
}

/// The counts by node, and the contradictions among the statements.
#[derive(Debug)]
pub(crate) struct CountSolution {
    pub counts: Vec<u32>,
    pub conflicts: Vec<Conflict>,
}

/// Neighbours of all nodes, those of one node in the order of the links.
pub(crate) struct Links {
    start: Vec<usize>,
    to: Vec<Node>,
}

impl Links {
    pub fn new(nodes: usize, links: &[(Node, Node)]) -> Self {
        let mut start = vec![0; nodes + 1];
        for &(a, b) in links {
            start[a + 1] += 1;
            start[b + 1] += 1;
        }
        for k in 0..nodes {
            start[k + 1] += start[k];
        }
        let mut free = start.clone();
        let mut to = vec![0; 2 * links.len()];
        for &(a, b) in links {
            to[free[a]] = b;
            free[a] += 1;
            to[free[b]] = a;
            free[b] += 1;
        }
        Self { start, to }
    }

    pub fn of(&self, node: Node) -> &[Node] {
        &self.to[self.start[node]..self.start[node + 1]]
    }
}

const NONE: usize = usize::MAX;

/// Nodes whose counts are equal.
#[derive(Clone, Copy, Debug)]
struct CountClass {
    low: u32,
    high: u32,
    wish: Option<u32>,
    usual: Option<u32>,
    stated: bool,
}

struct CountSolver<'d> {
    sums: &'d [Sum],
    /// The weights by which the parts of a sum divide a known whole; evaluated only if needed.
    weights: &'d dyn Fn(usize) -> Vec<f64>,
    weighed: Vec<Option<Vec<f64>>>,
    class_of: Vec<usize>,
    classes: Vec<CountClass>,
    /// The sums that a class takes part in.
    in_sums: Vec<Vec<usize>>,
    broken: Vec<bool>,
    visits: Vec<u32>,
    queue: VecDeque<usize>,
    queued: Vec<bool>,
    /// Sums whose whole is known and some part is not, perhaps.
    to_share: BTreeSet<usize>,
    conflicts: Vec<Conflict>,
}

impl CountProblem {
    /// Adds a count to be found.
    pub fn node(&mut self, stated: Option<u32>, usual: Option<u32>) -> Node {
        self.stated.push(stated);
        self.wished.push(None);
        self.usual.push(usual);
        self.stated.len() - 1
    }

    /// The counts. Takes time linear in nodes, links and sums except for chains in rings. `weights`
    /// gives, for a sum, those by which its parts divide a known whole; it is called only where
    /// that is to be decided.
    pub fn solve(&self, weights: &dyn Fn(usize) -> Vec<f64>) -> CountSolution {
        let mut conflicts = Vec::new();
        let (class_of, count) = self.classes(&mut conflicts);
        let free = CountClass { low: 1, high: MOST, wish: None, usual: None, stated: false };
        let mut classes = vec![free; count];
        for (node, &class) in class_of.iter().enumerate() {
            let class = &mut classes[class];
            if let Some(n) = self.stated[node] {
                (class.low, class.high) = (n, n);
                class.stated = true;
            }
            class.wish = class.wish.max(self.wished[node]);
            class.usual = class.usual.max(self.usual[node]);
        }
        let mut in_sums = vec![Vec::new(); count];
        for (k, sum) in self.sums.iter().enumerate() {
            for node in sum.parts.iter().copied().chain([sum.whole]) {
                in_sums[class_of[node]].push(k);
            }
        }
        in_sums.iter_mut().for_each(Vec::dedup);
        let sums = self.sums.len();
        let mut solver = CountSolver {
            sums: &self.sums,
            weights,
            weighed: vec![None; sums],
            class_of,
            classes,
            in_sums,
            broken: vec![false; sums],
            visits: vec![0; sums],
            queue: (0..sums).collect(),
            queued: vec![true; sums],
            to_share: (0..sums).collect(),
            conflicts,
        };
        solver.propagate();
        solver.choose();
        solver.repair();
        let counts = solver.class_of.iter().map(|&c| solver.classes[c].low).collect();
        CountSolution { counts, conflicts: solver.conflicts }
    }

    /// The class of each node, and the number of classes. If the given counts in a chain differ,
    /// each node belongs to the nearest of them.
    fn classes(&self, conflicts: &mut Vec<Conflict>) -> (Vec<usize>, usize) {
        let nodes = self.stated.len();
        let links = Links::new(nodes, &self.links);
        let mut class_of = vec![NONE; nodes];
        let mut count = 0;
        let mut members: Vec<Node> = Vec::new();
        let mut origin = vec![NONE; nodes];
        let mut before = vec![NONE; nodes];
        for first in 0..nodes {
            if class_of[first] != NONE {
                continue;
            }
            let class = count;
            count += 1;
            members.clear();
            members.push(first);
            class_of[first] = class;
            let mut at = 0;
            while at < members.len() {
                for &next in links.of(members[at]) {
                    if class_of[next] == NONE {
                        class_of[next] = class;
                        members.push(next);
                    }
                }
                at += 1;
            }
            let mut values: Vec<u32> = members.iter().filter_map(|&n| self.stated[n]).collect();
            values.sort_unstable();
            values.dedup();
            if values.len() < 2 {
                continue;
            }
            // One class for each value, from the nearest statement.
            count += values.len() - 1;
            let mut sources: Vec<Node> =
                members.iter().copied().filter(|&n| self.stated[n].is_some()).collect();
            sources.sort_unstable();
            for &n in &sources {
                origin[n] = n;
            }
            let mut queue: VecDeque<Node> = sources.into();
            while let Some(node) = queue.pop_front() {
                for &next in links.of(node) {
                    if origin[next] == NONE {
                        origin[next] = origin[node];
                        before[next] = node;
                        queue.push_back(next);
                    }
                }
            }
            members.sort_unstable();
            let mut reported = BTreeSet::new();
            for &node in &members {
                let value = self.stated[origin[node]];
                let place = values.binary_search(&value.unwrap_or(0)).unwrap_or(0);
                class_of[node] = class + place;
                for &next in links.of(node) {
                    if next > node && self.stated[origin[next]] != value {
                        let (a, b) = (origin[node], origin[next]);
                        if reported.insert((a.min(b), a.max(b))) {
                            conflicts.push(Conflict::Chain(path(&before, node, next)));
                        }
                    }
                }
            }
        }
        (class_of, count)
    }
}

/// From the source of `a` through the link to `b` to the source of that.
fn path(before: &[usize], a: Node, b: Node) -> Vec<Node> {
    let back = |mut node: Node| {
        let mut nodes = vec![node];
        while before[node] != NONE {
            node = before[node];
            nodes.push(node);
        }
        nodes
    };
    let mut nodes = back(a);
    nodes.reverse();
    nodes.extend(back(b));
    nodes
}

impl CountSolver<'_> {
    fn class(&self, node: Node) -> &CountClass {
        &self.classes[self.class_of[node]]
    }

    fn known(&self, node: Node) -> bool {
        let class = self.class(node);
        class.low == class.high
    }

    fn narrow(&mut self, class: usize, low: u32, high: u32) {
        let was = self.classes[class];
        if (was.low, was.high) == (low, high) {
            return;
        }
        (self.classes[class].low, self.classes[class].high) = (low, high);
        for at in 0..self.in_sums[class].len() {
            let sum = self.in_sums[class][at];
            if !self.broken[sum] && !std::mem::replace(&mut self.queued[sum], true) {
                self.queue.push_back(sum);
            }
        }
    }

    fn assign(&mut self, class: usize, count: u32) {
        let CountClass { low, high, .. } = self.classes[class];
        let count = count.clamp(low, high);
        self.narrow(class, count, count);
        self.propagate();
    }

    /// Narrows the intervals until all sums agree with them.
    fn propagate(&mut self) {
        while let Some(sum) = self.queue.pop_front() {
            self.queued[sum] = false;
            self.visits[sum] += 1;
            if self.broken[sum] {
                continue;
            }
            if self.visits[sum] > MAX_ROUNDS || !self.weigh(sum) {
                self.broken[sum] = true;
                self.conflicts.push(Conflict::Sum(sum));
            } else {
                self.to_share.insert(sum);
            }
        }
    }

    /// Narrows the terms of one sum; false if it cannot hold.
    fn weigh(&mut self, sum: usize) -> bool {
        let Sum { whole, parts } = &self.sums[sum];
        let whole = self.class_of[*whole];
        let mut terms: Vec<(usize, u64)> = Vec::with_capacity(parts.len());
        for node in parts {
            let class = self.class_of[*node];
            match terms.iter_mut().find(|t| t.0 == class) {
                Some(term) => term.1 += 1,
                None => terms.push((class, 1)),
            }
        }
        if terms.iter().any(|t| t.0 == whole) {
            return false;
        }
        let low = |k: usize| u64::from(self.classes[k].low);
        let high = |k: usize| u64::from(self.classes[k].high);
        let least: u64 = terms.iter().map(|&(k, m)| m * low(k)).sum();
        let most: u64 = terms.iter().map(|&(k, m)| m * high(k)).sum();
        let (from, to) = (low(whole).max(least), high(whole).min(most));
        if from > to {
            return false;
        }
        let mut narrowed = vec![(whole, from, to)];
        for &(k, m) in &terms {
            let (rest_least, rest_most) = (least - m * low(k), most - m * high(k));
            let high = high(k).min((to - rest_least) / m);
            let low = low(k).max(from.saturating_sub(rest_most).div_ceil(m));
            if low > high {
                return false;
            }
            narrowed.push((k, low, high));
        }
        for (class, low, high) in narrowed {
            self.narrow(class, low as u32, high as u32);
        }
        true
    }

    /// Gives every count that is still free a value.
    fn choose(&mut self) {
        for class in 0..self.classes.len() {
            if let Some(wish) = self.classes[class].wish {
                self.assign(class, wish);
            }
        }
        self.share();
        let mut is_part = vec![false; self.classes.len()];
        for (k, sum) in self.sums.iter().enumerate() {
            for node in &sum.parts {
                is_part[self.class_of[*node]] |= !self.broken[k];
            }
        }
        // Wholes first: their parts divide the result.
        for parts_too in [false, true] {
            for class in 0..self.classes.len() {
                let CountClass { low, high, usual, .. } = self.classes[class];
                if low == high || (is_part[class] && !parts_too) {
                    continue;
                }
                self.assign(class, usual.unwrap_or(low).max(2 * low - 1));
                self.share();
            }
        }
    }

    /// Repairs sums that did not come out because free counts were chosen one by one: a step of one
    /// is passed on from sum to sum, along counts that are not stated, to where it changes nothing
    /// else. (Counts of patches are a flow through them, and this its augmenting path: Ford and
    /// Fulkerson 1956.)
    fn repair(&mut self) {
        let mut steps = 0;
        for sum in 0..self.sums.len() {
            if !self.broken[sum] {
                continue;
            }
            while self.excess(sum) != 0 && steps < MOST_STEPS && self.step(sum) {
                steps += 1;
            }
        }
        let mended = |s: &Self, sum: usize| s.broken[sum] && s.excess(sum) == 0;
        for sum in 0..self.sums.len() {
            if mended(self, sum) {
                self.broken[sum] = false;
                self.conflicts.retain(|c| *c != Conflict::Sum(sum));
            }
        }
    }

    /// Excess of a whole over its parts.
    fn excess(&self, sum: usize) -> i64 {
        let value = |node: Node| i64::from(self.class(node).low);
        let Sum { whole, parts } = &self.sums[sum];
        value(*whole) - parts.iter().map(|&p| value(p)).sum::<i64>()
    }

    /// Coefficient of a class in the excess of a sum: 1 as its whole, negative as its part.
    fn weight(&self, sum: usize, class: usize) -> i64 {
        let Sum { whole, parts } = &self.sums[sum];
        let parts = parts.iter().filter(|&&p| self.class_of[p] == class).count() as i64;
        i64::from(self.class_of[*whole] == class) - parts
    }

    /// Brings the excess of a violated sum one nearer to zero without violating another; false if
    /// that is impossible.
    fn step(&mut self, start: usize) -> bool {
        /// The excess of a sum is to change by `by`; it was reached from another sum through a
        /// class.
        struct Visit {
            sum: usize,
            by: i64,
            from: usize,
            class: usize,
            delta: i64,
        }
        let by = -self.excess(start).signum();
        let mut visits = vec![Visit { sum: start, by, from: NONE, class: NONE, delta: 0 }];
        let mut seen = BTreeSet::from([(start, by)]);
        let mut at = 0;
        while at < visits.len() && visits.len() < REACH {
            let Visit { sum, by, class: came_by, .. } = visits[at];
            let Sum { whole, parts } = &self.sums[sum];
            let nodes: Vec<Node> = parts.iter().copied().chain([*whole]).collect();
            for node in nodes {
                let class = self.class_of[node];
                let weight = self.weight(sum, class);
                let CountClass { low, stated, .. } = self.classes[class];
                if class == came_by || stated || weight.abs() != 1 {
                    continue;
                }
                let delta = by * weight;
                if i64::from(low) + delta < 1 {
                    continue;
                }
                let others: Vec<usize> =
                    self.in_sums[class].iter().copied().filter(|&s| s != sum).collect();
                // The sums that this step unsettles; a broken one may gain by it.
                let unsettled: Vec<(usize, i64)> = others
                    .into_iter()
                    .map(|s| (s, self.weight(s, class) * delta))
                    .filter(|&(s, change)| {
                        let excess = self.excess(s);
                        change != 0 && (excess + change).abs() >= excess.abs()
                    })
                    .collect();
                match unsettled[..] {
                    [] => {
                        let mut changes = vec![(class, delta)];
                        let mut back = at;
                        while visits[back].from != NONE {
                            changes.push((visits[back].class, visits[back].delta));
                            back = visits[back].from;
                        }
                        return self.change(start, &changes);
                    }
                    [(next, change)] if seen.insert((next, -change)) => {
                        visits.push(Visit { sum: next, by: -change, from: at, class, delta });
                    }
                    _ => {}
                }
            }
            at += 1;
        }
        false
    }

    /// Applies the changes unless a satisfied sum would be violated, or a count would be zero.
    fn change(&mut self, start: usize, changes: &[(usize, i64)]) -> bool {
        let before = self.excess(start).abs();
        let mut touched: Vec<usize> =
            changes.iter().flat_map(|&(class, _)| self.in_sums[class].iter().copied()).collect();
        touched.sort_unstable();
        touched.dedup();
        let old: Vec<(usize, i64)> = touched.iter().map(|&s| (s, self.excess(s).abs())).collect();
        let apply = |s: &mut Self, sign: i64| {
            for &(class, delta) in changes {
                let class = &mut s.classes[class];
                let count = i64::from(class.low) + sign * delta;
                (class.low, class.high) = (count as u32, count as u32);
            }
        };
        let mut counts: Vec<(usize, i64)> = Vec::new();
        for &(class, delta) in changes {
            match counts.iter_mut().find(|c| c.0 == class) {
                Some(count) => count.1 += delta,
                None => counts.push((class, i64::from(self.classes[class].low) + delta)),
            }
        }
        if counts.iter().any(|c| !(1..=i64::from(MOST)).contains(&c.1)) {
            return false;
        }
        apply(self, 1);
        let good = self.excess(start).abs() < before
            && old.iter().all(|&(sum, was)| self.excess(sum).abs() <= was);
        if !good {
            apply(self, -1);
        }
        good
    }

    /// Divides known wholes among their free parts by weight, one part after the other, so that
    /// other sums have their say in between.
    fn share(&mut self) {
        while let Some(sum) = self.to_share.pop_first() {
            let Sum { whole, parts } = &self.sums[sum];
            if self.broken[sum] || !self.known(*whole) {
                continue;
            }
            let mut rest = f64::from(self.class(*whole).low);
            let mut free = Vec::new();
            for (at, &node) in parts.iter().enumerate() {
                if self.known(node) {
                    rest -= f64::from(self.class(node).low);
                } else {
                    free.push(at);
                }
            }
            let Some(&first) = free.first() else { continue };
            let node = parts[first];
            let weights = self.weighed[sum].get_or_insert_with(|| (self.weights)(sum));
            let weight: f64 = free.iter().fold(0.0, |sum, &at| sum + weights[at]);
            let share = if weight > 0.0 { (rest * weights[first] / weight).round() } else { 1.0 };
            self.to_share.insert(sum);
            self.assign(self.class_of[node], share.clamp(1.0, f64::from(MOST)) as u32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl CountProblem {
        /// With equal weights.
        fn solved(&self) -> CountSolution {
            self.solve(&|sum| vec![1.0; self.sums[sum].parts.len()])
        }
    }

    fn divider(
        stated: &[Option<u32>],
        links: &[(Node, Node)],
        sums: &[(Node, &[Node])],
    ) -> CountProblem {
        let mut d = CountProblem::default();
        stated.iter().for_each(|&n| {
            let _ = d.node(n, Some(8));
        });
        d.links = links.to_vec();
        d.sums = sums
            .iter()
            .map(|(whole, parts)| Sum { whole: *whole, parts: parts.to_vec() })
            .collect();
        d
    }

    #[test]
    fn counts_flow_along_links() {
        let d = divider(&[None, Some(5), None, None], &[(0, 1), (0, 2)], &[]).solved();
        assert_eq!(d.counts, [5, 5, 5, 8]);
        assert!(d.conflicts.is_empty());
    }

    #[test]
    fn a_sum_gives_and_takes() {
        let d = divider(&[None, Some(4), Some(3)], &[], &[(0, &[1, 2])]).solved();
        assert_eq!(d.counts, [7, 4, 3]);
        let d = divider(&[Some(9), Some(4), None], &[], &[(0, &[1, 2])]).solved();
        assert_eq!(d.counts, [9, 4, 5]);
        let d = divider(&[Some(10), None, None, None], &[], &[(0, &[1, 2, 3])]).solved();
        assert_eq!(d.counts, [10, 3, 4, 3]);
        // The same part twice, and one that is shared by two sums.
        let d =
            divider(&[Some(8), None, Some(5), None], &[], &[(0, &[1, 1]), (2, &[1, 3])]).solved();
        assert_eq!(d.counts, [8, 4, 5, 1]);
        // Without constraints the whole has its default count.
        let d = divider(&[None, None, None], &[], &[(0, &[1, 2])]).solved();
        assert_eq!(d.counts, [8, 4, 4]);
    }

    #[test]
    fn a_later_sum_has_its_say_in_time() {
        // 10 = a + b and 4 = a + c: an equal part of the ten would leave c nothing.
        let sums: [(Node, &[Node]); 2] = [(0, &[2, 3]), (1, &[2, 4])];
        let d = divider(&[Some(10), Some(4), None, None, None], &[], &sums).solved();
        assert_eq!((d.counts[2] + d.counts[3], d.counts[2] + d.counts[4]), (10, 4));
        assert!(d.conflicts.is_empty());
    }

    #[test]
    fn contradictions_are_told_and_do_not_spread() {
        let links = [(0, 1), (1, 2), (2, 3), (3, 4)];
        let d = divider(&[Some(5), None, None, None, Some(7)], &links, &[]).solved();
        assert_eq!(d.counts, [5, 5, 5, 7, 7]);
        assert_eq!(d.conflicts, [Conflict::Chain(vec![0, 1, 2, 3, 4])]);
        let d = divider(&[Some(5), Some(4), Some(3), None], &[], &[(0, &[1, 2])]).solved();
        assert_eq!((d.counts, d.conflicts), (vec![5, 4, 3, 8], vec![Conflict::Sum(0)]));
        // Too few for three pieces.
        let d = divider(&[Some(2), None, None, None], &[], &[(0, &[1, 2, 3])]).solved();
        assert_eq!(d.conflicts, [Conflict::Sum(0)]);
    }

    #[test]
    fn chosen_counts_are_mended() {
        // Two bands of two patches each over a middle line cut in three: the counts of the lower
        // two (0, 1) and of the upper two (2, 3) are chosen apart from each other, and 9 is stated.
        let sums: [(Node, &[Node]); 4] = [(0, &[4, 5]), (1, &[6, 7]), (2, &[4]), (3, &[5, 6, 7])];
        let d = divider(&[Some(9), Some(3), None, Some(4), None, None, None, None], &[], &sums);
        let d = d.solved();
        assert!(d.conflicts.is_empty(), "{d:?}");
        assert_eq!((d.counts[4] + d.counts[5], d.counts[5] + d.counts[6] + d.counts[7]), (9, 4));
    }

    #[test]
    fn chains_in_rings_end() {
        // A whole that is its own part, directly and round a corner.
        let d = divider(&[None, None], &[], &[(0, &[0, 1])]).solved();
        assert_eq!(d.conflicts, [Conflict::Sum(0)]);
        let d = divider(&[None; 4], &[], &[(0, &[1, 2]), (1, &[0, 3])]).solved();
        assert_eq!(d.conflicts.len(), 1);
        assert!(d.counts.iter().all(|&n| n >= 1));
    }

    #[test]
    fn long_chains_take_linear_time() {
        let n = 200_000;
        let mut d = CountProblem::default();
        (0..n).for_each(|k| {
            let _ = d.node((k == 0).then_some(3), Some(8));
        });
        d.links = (1..n).map(|k| (k - 1, k)).collect();
        assert!(d.solved().counts.iter().all(|&c| c == 3));
        d.stated[n - 1] = Some(4);
        let cut = d.solved();
        assert!(matches!(&cut.conflicts[..], [Conflict::Chain(path)] if path.len() == n));
        // All alone, all sums.
        let mut d = CountProblem::default();
        (0..n).for_each(|_| {
            let _ = d.node(None, Some(8));
        });
        d.sums =
            (0..n / 3).map(|k| Sum { whole: 3 * k, parts: vec![3 * k + 1, 3 * k + 2] }).collect();
        assert!(d.solved().conflicts.is_empty());
    }
}
