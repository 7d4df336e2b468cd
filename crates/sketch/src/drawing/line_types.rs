//! Types of lines from their slopes, and from planes that their ends share.

use crate::drawing::noise::Verdict;
use crate::drawing::planes::Planes;
use crate::{CoordinateAxis, Drawing, DrawnLine, Free, LineId, LineTypeSource, PointId};
use moldloft_num::Real;
use std::collections::BTreeMap;

/// How far a line may lean off an axis and still be named after it: 5 % of the slope (manual, p. 10).
pub const NAMING_TOLERANCE: f64 = 0.05;

/// Below this a type is worth a look: of lines drawn within ±4 on 400, 1 to 3 % fall below.
pub const DOUBTFUL: f64 = 0.9;

/// The confidence of a line that is inclined only because it would leave others no length.
const MENDED: f64 = 0.85;

/// What a unit of the logarithm of a line's odds counts against a line that loses its length.
const SURENESS: f64 = 1.0;

/// Groups of parallel lines that are tried as inclined where types contradict each other, the least sure first.
const MOST_TRIED: usize = 60;

impl Drawing {
    /// The type that the slope of a line suggests, with its confidence.
    ///
    /// The axis with the smallest lean, if that is within 5 %. In a cross section every other line is
    /// inclined; in a pictorial nothing is said about it.
    pub fn slope_type(&self, line: &DrawnLine) -> Option<(Free, f64)> {
        let stroke = self.stroke(line);
        let axes = CoordinateAxis::ALL.into_iter().filter(|&a| self.section != Some(a));
        let best = axes
            .map(|axis| (axis, self.projection.lean(stroke, axis)))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        match (best, self.section) {
            (Some((axis, lean)), _) if lean <= NAMING_TOLERANCE => {
                Some((Free::along(axis), 1.0 - lean / NAMING_TOLERANCE))
            }
            (_, Some(normal)) => Some((Free::across(normal), 1.0)),
            _ => None,
        }
    }

    /// Types a line by its slope.
    pub fn type_by_slope(&mut self, id: LineId) {
        let Some(line) = self.lines.get(&id).copied() else { return };
        let (free, confidence) = match self.slope_type(&line) {
            Some((free, confidence)) => (Some(free), confidence),
            None => (None, 0.0),
        };
        self.lines.insert(id, DrawnLine { free, confidence, source: LineTypeSource::Auto, ..line });
    }

    /// Types every line that the user has not typed: by its stroke and those parallel to it in space,
    /// judged by the noise of the pen; then by the planes that ends share already, to a fixed point.
    /// Lines whose ends share nothing are proposed as oblique: that they are inclined is as sure as their strokes say, but
    /// not that all three coordinates change along them. Returns the lines so proposed.
    pub fn type_all(&mut self) -> Vec<LineId> {
        let ids: Vec<LineId> = self.lines.keys().copied().collect();
        let verdicts = self.verdicts();
        let share = |id: &LineId| verdicts.get(id).map_or(1.0, |v| v.share);
        for &id in &ids {
            let line = self.lines[&id];
            if line.source == LineTypeSource::User && line.free.is_some() {
                continue;
            }
            let Some(verdict) = verdicts.get(&id) else { continue };
            let free = match (verdict.axis, self.section) {
                (Some(axis), _) => Some(Free::along(axis)),
                (None, Some(normal)) => Some(Free::across(normal)),
                (None, None) => None,
            };
            let confidence = if free.is_some() { verdict.share } else { 0.0 };
            self.lines
                .insert(id, DrawnLine { free, confidence, source: LineTypeSource::Auto, ..line });
        }
        self.mend(&verdicts);
        loop {
            let planes = Planes::of(self);
            let mut changed = false;
            for id in &ids {
                let line = self.lines[id];
                if line.free.is_some() {
                    continue;
                }
                let free = Free::those(|a| !planes.same(a, line.p, line.q));
                if let Some(free) = free.filter(|&f| f != Free::OBLIQUE) {
                    let inferred = DrawnLine {
                        free: Some(free),
                        source: LineTypeSource::Inferred,
                        confidence: share(id),
                        ..line
                    };
                    self.lines.insert(*id, inferred);
                    changed = true;
                }
            }
            if !changed {
                break;
            }
        }
        let left: Vec<LineId> = ids.into_iter().filter(|i| self.lines[i].free.is_none()).collect();
        for id in &left {
            if let Some(line) = self.lines.get_mut(id) {
                line.free = Some(Free::OBLIQUE);
                line.source = LineTypeSource::Inferred;
                line.confidence = share(id);
            }
        }
        left
    }

    /// Inclined lines that happen to be drawn along an axis make planes of different places one, so that other
    /// lines lose their length: as long as that is so, the lines are taken as inclined with which most of it goes,
    /// against how sure they were.
    fn mend(&mut self, verdicts: &BTreeMap<LineId, Verdict>) {
        let mut groups: BTreeMap<usize, (f64, Vec<LineId>)> = BTreeMap::new();
        for (&id, verdict) in verdicts {
            let line = &self.lines[&id];
            if verdict.axis.is_some() && line.source == LineTypeSource::Auto {
                let group = groups.entry(verdict.group).or_insert((verdict.share, Vec::new()));
                group.1.push(id);
            }
        }
        let mut left: Vec<(f64, Vec<LineId>)> = groups.into_values().collect();
        left.sort_by(|a, b| a.0.total_cmp(&b.0));
        left.truncate(MOST_TRIED);
        let mut score = self.collapsed();
        while score > 0 {
            let inclined = self.section.map(Free::across);
            let mut best: Option<(f64, usize, usize)> = None;
            for (k, (share, ids)) in left.iter().enumerate() {
                let old: Vec<Option<Free>> = ids.iter().map(|id| self.lines[id].free).collect();
                self.retype(ids, |_| inclined);
                let found = self.collapsed();
                self.retype(ids, |k| old[k]);
                // What stays wrong, against how sure the lines were.
                let price = found as f64 + SURENESS * Real::ln(share / (1.0 - share).max(1e-12));
                if found < score && best.is_none_or(|b| price < b.0) {
                    best = Some((price, found, k));
                }
            }
            let Some((_, found, k)) = best else { return };
            let (_, ids) = left.remove(k);
            self.retype(&ids, |_| inclined);
            for id in &ids {
                if let Some(line) = self.lines.get_mut(id) {
                    line.confidence = MENDED;
                }
            }
            score = found;
        }
    }

    fn retype(&mut self, ids: &[LineId], free: impl Fn(usize) -> Option<Free>) {
        for (k, id) in ids.iter().enumerate() {
            if let Some(line) = self.lines.get_mut(id) {
                line.free = free(k);
            }
        }
    }

    /// How many lines along an axis have no length in the planes of the others or lie on one another, how many points
    /// coincide, and whether everything lies in one plane.
    fn collapsed(&self) -> usize {
        let planes = Planes::of(self);
        let lines = self.lines.values().filter(|l| {
            l.free.and_then(Free::single).is_some_and(|axis| planes.same(axis, l.p, l.q))
        });
        let mut places: Vec<[u32; 3]> = (0..planes.ids().len())
            .map(|k| CoordinateAxis::ALL.map(|axis| planes.classes(axis)[k]))
            .collect();
        places.sort_unstable();
        let coincident = places.windows(2).filter(|w| w[0] == w[1]).count();
        let closed = self.lines.len() > self.points.len();
        let flat = planes.counts().iter().filter(|n| **n == 1).count();
        let flat = if self.section.is_none() && closed { flat } else { 0 };
        lines.count() + coincident + flat + self.overlapping()
    }

    /// How many pairs of lines along one axis leave a point to the same side, or to both sides of it with a line
    /// between their far ends.
    fn overlapping(&self) -> usize {
        let mut leaving: BTreeMap<(PointId, CoordinateAxis), Vec<(bool, PointId)>> =
            BTreeMap::new();
        let mut joined: std::collections::BTreeSet<(PointId, PointId)> = Default::default();
        for line in self.lines.values() {
            joined.insert((line.p.min(line.q), line.p.max(line.q)));
            let Some(axis) = line.free.and_then(Free::single) else { continue };
            let ([du, dv], [x, y]) = (self.stroke(line), self.projection.unit(axis));
            let forward = du * x + dv * y > 0.0;
            leaving.entry((line.p, axis)).or_default().push((forward, line.q));
            leaving.entry((line.q, axis)).or_default().push((!forward, line.p));
        }
        let mut count = 0;
        for all in leaving.values() {
            for (k, a) in all.iter().enumerate() {
                for b in &all[..k] {
                    let across = joined.contains(&(a.1.min(b.1), a.1.max(b.1)));
                    count += usize::from(a.0 == b.0 || across);
                }
            }
        }
        count
    }
}
