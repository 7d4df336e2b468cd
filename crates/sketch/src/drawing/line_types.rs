//! Types of lines from their slopes, and from planes that their ends share.

use crate::drawing::face_loops::{face_loops, impossible};
use crate::drawing::noise::Verdict;
use crate::drawing::planes::Planes;
use crate::{CoordinateAxis, Drawing, DrawnLine, Free, LineId, LineTypeSource, PointId};
use moldloft_num::Real;
use std::collections::BTreeMap;

/// Maximum inclination to an axis, as a slope, of a line named after it: 5 % (manual, p. 10).
pub const NAMING_TOLERANCE: f64 = 0.05;

/// Relative tolerance of equal coordinates in an exact drawing.
const AS_DRAWN: f64 = 1e-12;

/// Confidence below which a type should be checked. Of lines drawn with errors of ±1, ±2 and ±4 on
/// 400, 0.6, 1.6 and 4 % are below it, including half of the wrong ones.
pub const DOUBTFUL: f64 = 0.97;

/// The confidence of a line that is inclined only because it would leave others no length.
const MENDED: f64 = 0.85;

/// Penalty for a line of zero length, or a face loop that cannot be plane, in logarithms of odds.
pub(super) const FAULT: f64 = 9.0;

/// Gain of odds for each further line of a group.
const FELLOW: f64 = 1.7;

/// Penalty for a line that is not parallel to lines to which it seems parallel.
const LEAVES: f64 = 1.0;

/// A line is a copy of another if the angle between them has a sine below `COPY_LEAN` and the
/// lengths have at least this ratio: measured for copies drawn within 5 on 400.
const COPY_LEAN: f64 = 0.12;
const COPY_SIZE: f64 = 0.7;

/// So is a line whose ends differ from those of a copy by less than this multiple of the noise of an
/// end: the difference of four ends has twice that noise.
const COPY_NOISE: f64 = 5.0;

/// Maximum number of groups for which pairs are tried too.
const MOST_PAIRED: usize = 12;

/// Groups of parallel lines that are tried as inclined where types contradict each other, the least sure first.
const MOST_TRIED: usize = 60;

impl Drawing {
    /// The type that the slope of a line suggests, with its confidence.
    ///
    /// The axis with the smallest inclination, if within 5 %. In a cross section every other line
    /// is inclined; in a pictorial such a line has no type.
    pub fn slope_type(&self, line: &DrawnLine) -> Option<(Free, f64)> {
        let stroke = self.stroke(line);
        if let (Some(normal), true) = (self.section, self.exact) {
            let ends = [line.p, line.q].map(|p| self.points.get(&p).copied().unwrap_or_default());
            let size = ends.iter().fold(0.0, |s: f64, p| s.max(p.u.abs()).max(p.v.abs()));
            let plane = CoordinateAxis::ALL.into_iter().filter(|a| *a != normal);
            // Along the first axis v does not change, along the second one u.
            let still = [stroke[1], stroke[0]].map(|x| x.abs() <= AS_DRAWN * size);
            let along = plane.zip(still).find(|(_, still)| *still).map(|(axis, _)| axis);
            return Some((along.map_or(Free::across(normal), Free::along), 1.0));
        }
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

    /// Confidence of the types of lines that were not typed by hand: from the noise of the pen, for
    /// types by slope as for types from the whole drawing.
    pub fn confidences(&self) -> BTreeMap<LineId, f64> {
        let verdicts = self.verdicts();
        let of = |id: &LineId, line: &DrawnLine| {
            let stored = line.confidence;
            let Some(verdict) = verdicts.get(id) else { return stored };
            if line.source != LineTypeSource::Auto || line.free.is_none() || stored == MENDED {
                return stored;
            }
            let same = line.free.and_then(Free::single) == verdict.axis;
            if same { verdict.share } else { 1.0 - verdict.share }
        };
        self.lines.iter().map(|(id, line)| (*id, of(id, line))).collect()
    }

    /// Types every line that the user has not typed: by its stroke and those parallel to it in
    /// space, given the noise of the pen; then by the planes that its ends already share, until
    /// nothing changes. Lines whose ends share no plane are proposed as oblique: their strokes
    /// determine the confidence that they are inclined, but not that all three coordinates vary.
    /// Returns the proposed lines.
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
        self.infer(&share);
        for (id, axis) in self.across_by_copies(self.noise_of_hand()) {
            if let Some(line) = self.lines.get_mut(&id) {
                line.free = Some(Free::across(axis));
                line.source = LineTypeSource::Inferred;
                line.confidence = share(&id);
            }
        }
        self.infer(&share);
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

    /// Types all lines, and counts the contradictions that remain.
    pub(super) fn typed_contradictions(&mut self) -> usize {
        self.type_all();
        self.collapsed(&self.plane_loops())
    }

    /// Loops of lines that bound plane faces; none in a cross section.
    fn plane_loops(&self) -> Vec<Vec<LineId>> {
        if self.section.is_none() { face_loops(&self.lines) } else { vec![] }
    }

    /// Types lines by the planes that their ends share, as long as that types any.
    fn infer(&mut self, share: &dyn Fn(&LineId) -> f64) {
        loop {
            let planes = Planes::of(self);
            let mut changed = false;
            for (id, line) in &mut self.lines {
                let free = Free::those(|a| !planes.same(a, line.p, line.q));
                if let Some(free) = free.filter(|&f| line.free.is_none() && f != Free::OBLIQUE) {
                    line.free = Some(free);
                    line.source = LineTypeSource::Inferred;
                    line.confidence = share(id);
                    changed = true;
                }
            }
            if !changed {
                return;
            }
        }
    }

    /// Types of untyped lines that have copies at the other ends of two lines along one axis: they
    /// are sides of a prism along it, perpendicular to it. Lines whose copies have different axes
    /// are left out.
    fn across_by_copies(&self, sigma: f64) -> BTreeMap<LineId, CoordinateAxis> {
        if self.section.is_some() {
            return BTreeMap::new();
        }
        let mut along: BTreeMap<PointId, Vec<(PointId, CoordinateAxis)>> = BTreeMap::new();
        let mut between: BTreeMap<(PointId, PointId), LineId> = BTreeMap::new();
        for (&id, line) in &self.lines {
            between.insert((line.p.min(line.q), line.p.max(line.q)), id);
            if let Some(axis) = line.free.and_then(Free::single) {
                along.entry(line.p).or_default().push((line.q, axis));
                along.entry(line.q).or_default().push((line.p, axis));
            }
        }
        let way = |p: PointId, q: PointId| {
            let [p, q] = [p, q].map(|p| self.points.get(&p).copied().unwrap_or_default());
            [q.u - p.u, q.v - p.v]
        };
        let copied = |a: [f64; 2], b: [f64; 2]| {
            let [m, n] = [a, b].map(|w| Real::sqrt(w[0] * w[0] + w[1] * w[1]));
            let (cross, dot) = (a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
            let apart = (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
            let alike = cross.abs() < COPY_LEAN * m * n && m.min(n) > COPY_SIZE * m.max(n);
            dot > 0.0 && (alike || apart < (COPY_NOISE * sigma).powi(2))
        };
        let ends = |p: &PointId| along.get(p).map_or(&[][..], Vec::as_slice);
        let mut found = BTreeMap::new();
        for (&id, line) in self.lines.iter().filter(|l| l.1.free.is_none()) {
            let own = way(line.p, line.q);
            let pairs =
                ends(&line.p).iter().flat_map(|a| ends(&line.q).iter().map(move |b| (a, b)));
            let mut axes: Vec<CoordinateAxis> = pairs
                .filter(|((r, a), (s, b))| {
                    let other = between.get(&(*r.min(s), *r.max(s)));
                    a == b && other.is_some_and(|o| *o != id) && copied(own, way(*r, *s))
                })
                .map(|(a, _)| a.1)
                .collect();
            axes.dedup();
            if let [axis] = axes[..] {
                found.insert(id, axis);
            }
        }
        found
    }

    /// Inclined lines that happen to be drawn along an axis make different planes one, so that other
    /// lines lose their length, and face loops cannot be plane: the groups of parallel lines are taken as inclined
    /// that make the whole likeliest, one or two at a time, as long as that gains anything.
    fn mend(&mut self, verdicts: &BTreeMap<LineId, Verdict>) {
        let mut groups: BTreeMap<usize, (f64, Vec<LineId>)> = BTreeMap::new();
        for (&id, verdict) in verdicts {
            let line = &self.lines[&id];
            if verdict.axis.is_some() && line.source == LineTypeSource::Auto {
                let odds = Real::ln(verdict.share / (1.0 - verdict.share).max(1e-12));
                let group = groups.entry(verdict.group).or_insert((odds, Vec::new()));
                // The prior probability that a line of a group is along an axis is high.
                group.0 += if group.1.is_empty() { 0.0 } else { FELLOW };
                group.1.push(id);
            }
        }
        let odds = |share: f64| Real::ln(share.max(1e-12) / (1.0 - share).max(1e-12));
        let mut left: Vec<(f64, Vec<LineId>)> = groups.into_values().collect();
        // One line of a group is inclined and the others are not, if it only seemed to be parallel to them.
        let single: Vec<(f64, Vec<LineId>)> = (left.iter().filter(|g| g.1.len() > 1))
            .flat_map(|g| g.1.iter())
            .map(|id| (odds(verdicts[id].alone).max(0.0) + LEAVES, vec![*id]))
            .collect();
        left.extend(single);
        left.sort_by(|a, b| a.0.total_cmp(&b.0));
        left.truncate(MOST_TRIED);
        let loops = self.plane_loops();
        let inclined = self.section.map(Free::across);
        let mut score = self.collapsed(&loops);
        while score > 0 {
            let mut best: Option<(f64, usize, Vec<usize>)> = None;
            let singles = (0..left.len()).map(|k| vec![k]);
            let few = left.len().min(MOST_PAIRED);
            let pairs = (0..few).flat_map(|k| (0..k).map(move |j| vec![k, j]));
            for tried in singles.chain(pairs) {
                let cost: f64 = tried.iter().map(|&k| left[k].0).sum();
                let ids: Vec<LineId> =
                    tried.iter().flat_map(|&k| left[k].1.iter().copied()).collect();
                let old: Vec<Option<Free>> = ids.iter().map(|id| self.lines[id].free).collect();
                self.retype(&ids, |_| inclined);
                let found = self.collapsed(&loops);
                self.retype(&ids, |k| old[k]);
                let price = FAULT * (found as f64 - score as f64) + cost;
                if found < score && price < best.as_ref().map_or(0.0, |b| b.0) {
                    best = Some((price, found, tried));
                }
            }
            let Some((_, found, mut tried)) = best else { return };
            tried.sort_unstable_by(|a, b| b.cmp(a));
            for k in tried {
                let (_, ids) = left.remove(k);
                self.retype(&ids, |_| inclined);
                for id in &ids {
                    if let Some(line) = self.lines.get_mut(id) {
                        line.confidence = MENDED;
                    }
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

    /// Number of faults: lines along an axis of zero length in the planes of the others, coincident
    /// points, axes with a single plane (for closed drawings), overlapping lines, and loops that
    /// cannot be plane.
    fn collapsed(&self, loops: &[Vec<LineId>]) -> usize {
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
        // A line without a type is along an axis if the planes of its ends imply that.
        let free = |id: &LineId| {
            let line = &self.lines[id];
            let by_planes = || Free::those(|a| !planes.same(a, line.p, line.q));
            line.free.or_else(|| by_planes().filter(|f| f.single().is_some()))
        };
        let bent = loops.iter().filter(|l| impossible(l.iter().map(free))).count();
        lines.count() + coincident + flat + self.overlapping() + bent
    }

    /// Number of pairs of lines along one axis that leave a point to the same side, or to both
    /// sides of it with a line between their far ends.
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
