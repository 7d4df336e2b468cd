//! Types of lines from their slopes, and from planes that their ends share.

use crate::drawing::planes::Planes;
use crate::{Axis, Drawing, Free, Line, LineId, Source};

/// How far a line may lean off an axis and still be named after it: 5 % of the slope (manual, p. 10).
pub const NAMING_TOLERANCE: f64 = 0.05;

/// Below this a type is worth a look.
pub const DOUBTFUL: f64 = 0.6;

impl Drawing {
    /// The type that the slope of a line suggests, with its confidence.
    ///
    /// The axis with the smallest lean, if that is within 5 %. In a cross section every other line is
    /// inclined; in a pictorial nothing is said about it.
    pub fn slope_type(&self, line: &Line) -> Option<(Free, f64)> {
        let stroke = self.stroke(line);
        let axes = Axis::ALL.into_iter().filter(|&a| self.section != Some(a));
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
        self.lines.insert(id, Line { free, confidence, source: Source::Auto, ..line });
    }

    /// Types every line that the user has not typed: by slope, then by the planes that ends share
    /// already, to a fixed point. Lines whose ends share nothing are proposed as oblique, confidence
    /// one half. Returns the lines so proposed.
    pub fn type_all(&mut self) -> Vec<LineId> {
        let ids: Vec<LineId> = self.lines.keys().copied().collect();
        for &id in &ids {
            if self.lines[&id].source != Source::User || self.lines[&id].free.is_none() {
                self.type_by_slope(id);
            }
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
                    let inferred = Line {
                        free: Some(free),
                        source: Source::Inferred,
                        confidence: 1.0,
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
                line.source = Source::Inferred;
                line.confidence = 0.5;
            }
        }
        left
    }
}
