//! The face loops of a wireframe that its lines alone tell, before any of them has a type.
//!
//! In a planar graph that no two points disconnect, the borders of faces are the chordless cycles
//! whose removal leaves the rest connected; each line is then in exactly two of them, and only then
//! (W. T. Tutte, *How to draw a graph*, Proc. London Math. Soc. 13, 1963, (2.5) and (2.6)). Other
//! graphs give no result.

use crate::{DrawnLine, Free, LineId, PointId};
use std::collections::{BTreeMap, BTreeSet};

/// Larger figures, longer loops and longer searches tell nothing.
const MOST_POINTS: usize = 64;
const LONGEST: usize = 14;
const MOST_STEPS: usize = 60_000;

/// The face loops of the parts of a figure where its lines tell them.
pub(super) fn face_loops(lines: &BTreeMap<LineId, DrawnLine>) -> Vec<Vec<LineId>> {
    let mut at: BTreeMap<PointId, Vec<(PointId, LineId)>> = BTreeMap::new();
    for (&id, line) in lines {
        at.entry(line.p).or_default().push((line.q, id));
        at.entry(line.q).or_default().push((line.p, id));
    }
    let mut left: BTreeSet<PointId> = at.keys().copied().collect();
    let mut out = Vec::new();
    while let Some(&first) = left.iter().next() {
        let part = reached(&at, first, &BTreeSet::new());
        left.retain(|p| !part.contains(p));
        out.extend(of_part(&at, &part).unwrap_or_default());
    }
    out
}

type Neighbours = BTreeMap<PointId, Vec<(PointId, LineId)>>;

/// The points connected with one, without those in `without`.
fn reached(at: &Neighbours, first: PointId, without: &BTreeSet<PointId>) -> BTreeSet<PointId> {
    let mut seen = BTreeSet::from([first]);
    let mut open = vec![first];
    while let Some(p) = open.pop() {
        for &(q, _) in &at[&p] {
            if !without.contains(&q) && seen.insert(q) {
                open.push(q);
            }
        }
    }
    seen
}

fn of_part(at: &Neighbours, part: &BTreeSet<PointId>) -> Option<Vec<Vec<LineId>>> {
    if part.len() < 4 || part.len() > MOST_POINTS || part.iter().any(|p| at[p].len() < 3) {
        return None;
    }
    let mut search = LoopSearch { at, part, found: Vec::new(), steps: 0 };
    for &p in part {
        search.extend(&mut vec![p], &mut Vec::new())?;
    }
    let mut count: BTreeMap<LineId, usize> = BTreeMap::new();
    search.found.iter().flatten().for_each(|l| *count.entry(*l).or_default() += 1);
    let lines: BTreeSet<LineId> = part.iter().flat_map(|p| at[p].iter().map(|n| n.1)).collect();
    let twice = lines.iter().all(|l| count.get(l) == Some(&2));
    // Euler's formula for the sphere.
    let whole = part.len() + search.found.len() == lines.len() + 2;
    (twice && whole).then_some(search.found)
}

struct LoopSearch<'a> {
    at: &'a Neighbours,
    part: &'a BTreeSet<PointId>,
    found: Vec<Vec<LineId>>,
    steps: usize,
}

impl LoopSearch<'_> {
    /// Extends a path whose first point is its lowest, and whose second is lower than its last will
    /// be.
    fn extend(&mut self, way: &mut Vec<PointId>, lines: &mut Vec<LineId>) -> Option<()> {
        self.steps += 1;
        if self.steps > MOST_STEPS {
            return None;
        }
        let (first, last) = (way[0], *way.last()?);
        let at = self.at;
        for &(next, line) in &at[&last] {
            if lines.last() == Some(&line) {
                continue;
            }
            if next == first && way.len() > 2 {
                if way[1] < last {
                    lines.push(line);
                    self.close(way, lines);
                    lines.pop();
                }
                continue;
            }
            // A chord: a point that is joined with another point of the path than the last.
            let chord =
                way[1..way.len().max(2) - 1].iter().any(|p| at[&next].iter().any(|n| n.0 == *p));
            if next < first || way.contains(&next) || chord || way.len() >= LONGEST {
                continue;
            }
            // Joined with the first: only if it closes the cycle at once.
            let closes = at[&next].iter().find(|n| n.0 == first);
            if let (Some(&(_, back)), true) = (closes, way.len() > 1) {
                if way[1] < next {
                    way.push(next);
                    lines.extend([line, back]);
                    self.close(way, lines);
                    lines.truncate(lines.len() - 2);
                    way.pop();
                }
                continue;
            }
            way.push(next);
            lines.push(line);
            self.extend(way, lines)?;
            way.pop();
            lines.pop();
        }
        Some(())
    }

    /// Keeps a cycle that does not divide the rest.
    fn close(&mut self, way: &[PointId], lines: &[LineId]) {
        let own: BTreeSet<PointId> = way.iter().copied().collect();
        let rest = self.part.iter().find(|p| !own.contains(p));
        let whole =
            rest.is_none_or(|&p| reached(self.at, p, &own).len() + own.len() == self.part.len());
        if whole {
            self.found.push(lines.to_vec());
        }
    }
}

/// True if a loop of lines of these types cannot bound a plane face: it does not close, has no
/// area, or is not in one plane. `None` is a line of unknown inclination.
pub(super) fn impossible(types: impl Iterator<Item = Option<Free>>) -> bool {
    let (mut along, mut inclined) = ([0; 3], 0);
    let mut leaves = [false; 3];
    for free in types {
        match free.and_then(Free::single) {
            Some(axis) => along[axis.index()] += 1,
            None => {
                inclined += 1;
                free.iter().flat_map(|f| f.axes()).for_each(|a| leaves[a.index()] = true);
            }
        }
    }
    let used: Vec<usize> = (0..3).filter(|k| along[*k] > 0).collect();
    match used[..] {
        [] => false,
        // Back along an axis leads one inclined line alone.
        [_] => inclined < 2,
        [a, b] => {
            let third = 3 - a - b;
            leaves[third] || (inclined == 0 && (along[a] < 2 || along[b] < 2))
        }
        _ => true,
    }
}
