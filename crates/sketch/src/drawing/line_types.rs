//! Types of lines from their slopes, and from planes that their ends share.

use crate::drawing::planes::Planes;
use crate::{CoordinateAxis, Drawing, DrawnLine, Free, LineId, LineTypeSource};

/// How far a line may lean off an axis and still be named after it: 5 % of the slope (manual, p. 10).
pub const NAMING_TOLERANCE: f64 = 0.05;

/// Below this a type is worth a look: of lines drawn within ±2 on 400, 1.8 % fall below.
pub const DOUBTFUL: f64 = 0.95;

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
    /// Lines whose ends share nothing are proposed as oblique, confidence one half at most. Returns the
    /// lines so proposed.
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
                line.confidence = 0.5f64.min(share(id));
            }
        }
        left
    }
}
