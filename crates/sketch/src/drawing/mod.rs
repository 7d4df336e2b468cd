//! A drawing: points, typed lines and alignments on a page.

pub(crate) mod axis;
pub(crate) mod estimate;
mod face_loops;
pub(crate) mod line_types;
mod noise;
mod open_depths;
mod picture_axes;
pub(crate) mod planes;
pub(crate) mod projection;
pub(crate) mod proposals;
pub(crate) mod snaps;
pub(crate) mod stroke;

use axis::{CoordinateAxis, Free, Letters};
use projection::Projection;
use std::collections::BTreeMap;
use std::fmt;

macro_rules! numbered {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);
        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{}", self.0)
            }
        }
    };
}

numbered!(
    /// The label of a point, from 1.
    PointId
);
numbered!(
    /// The label of a line, from 1.
    LineId
);
numbered!(
    /// The label of a face, from 1.
    FaceId
);

/// A point as drawn. Its position in space follows from its planes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DrawnPoint {
    /// Screen right.
    pub u: f64,
    /// Screen up.
    pub v: f64,
}

/// Source of a line's type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineTypeSource {
    /// Its slope, within the tolerance.
    Auto,
    /// The user.
    User,
    /// The planes that its ends share.
    Inferred,
}

impl LineTypeSource {
    /// The word for files.
    pub fn word(self) -> &'static str {
        match self {
            LineTypeSource::Auto => "auto",
            LineTypeSource::User => "user",
            LineTypeSource::Inferred => "inferred",
        }
    }
}

/// A line between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnLine {
    /// Start.
    pub p: PointId,
    /// End.
    pub q: PointId,
    /// Its type; `None` while unknown.
    pub free: Option<Free>,
    /// Source of the type.
    pub source: LineTypeSource,
    /// Confidence of the type, 0 to 1; below [`DOUBTFUL`](crate::DOUBTFUL) it is listed by CHECK.
    pub confidence: f64,
}

impl DrawnLine {
    /// True for a line that is inclined as drawn and taken as oblique because nothing determines a
    /// constant coordinate.
    pub fn proposed(&self) -> bool {
        self.source == LineTypeSource::Inferred && self.free == Some(Free::OBLIQUE)
    }
}

/// Two points in the same plane perpendicular to `axis`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Align {
    /// The axis whose coordinate they share.
    pub axis: CoordinateAxis,
    /// One point.
    pub p: PointId,
    /// The other point.
    pub q: PointId,
}

/// A part of a drawing near a position on the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DrawingHit {
    /// A point.
    Point(PointId),
    /// A line, at a part of its length.
    Line {
        /// The line.
        line: LineId,
        /// 0 at its start, 1 at its end.
        part: f64,
    },
}

/// The flat picture of one object.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// For a cross section, the axis it is perpendicular to.
    pub section: Option<CoordinateAxis>,
    /// True if positions on the page of a section are its coordinates: types and suggested
    /// dimensions are as drawn.
    pub exact: bool,
    /// Probability from which TYPE AUTO types a line; 0 for every line.
    pub certainty: f64,
    /// Directions of the axes.
    pub projection: Projection,
    /// Meaning of H, P and F.
    pub letters: Letters,
    /// The points by label.
    pub points: BTreeMap<PointId, DrawnPoint>,
    /// The lines by label.
    pub lines: BTreeMap<LineId, DrawnLine>,
    /// Common planes of points in addition to those of lines.
    pub aligns: Vec<Align>,
}

impl Drawing {
    /// The label after the highest one.
    pub fn next_point(&self) -> PointId {
        PointId(self.points.keys().last().map_or(1, |p| p.0.saturating_add(1)))
    }

    /// The label after the highest one.
    pub fn next_line(&self) -> LineId {
        LineId(self.lines.keys().last().map_or(1, |l| l.0.saturating_add(1)))
    }

    /// The line between two points, in either direction.
    pub fn line_between(&self, a: PointId, b: PointId) -> Option<LineId> {
        let same = |l: &DrawnLine| (l.p == a && l.q == b) || (l.p == b && l.q == a);
        self.lines.iter().find(|(_, l)| same(l)).map(|(id, _)| *id)
    }

    /// The drawn vector of a line, from its start to its end.
    pub fn stroke(&self, line: &DrawnLine) -> [f64; 2] {
        let at = |id| self.points.get(&id).map_or([0.0; 2], |p| [p.u, p.v]);
        let (a, b) = (at(line.p), at(line.q));
        [b[0] - a[0], b[1] - a[1]]
    }

    /// The coordinate of a point of a section along one of its axes, as drawn.
    pub fn drawn_coordinate(&self, axis: CoordinateAxis, p: PointId) -> Option<f64> {
        let first = CoordinateAxis::ALL.into_iter().find(|a| self.section != Some(*a));
        let at = self.points.get(&p).filter(|_| self.section != Some(axis))?;
        Some(if first == Some(axis) { at.u } else { at.v })
    }

    /// `3-7 (X)`: a line in text form.
    pub fn line_text(&self, id: LineId) -> String {
        match self.lines.get(&id) {
            Some(l) => match l.free {
                Some(free) => {
                    format!("{}-{} ({})", l.p, l.q, self.letters.letter(free, self.section))
                }
                None => format!("{}-{} (untyped)", l.p, l.q),
            },
            None => format!("line {id}"),
        }
    }

    /// Removes a point with its lines and alignments.
    pub fn remove_point(&mut self, id: PointId) {
        self.points.remove(&id);
        self.lines.retain(|_, l| l.p != id && l.q != id);
        self.aligns.retain(|a| a.p != id && a.q != id);
    }

    /// The greater of width and height on the page.
    pub fn extent(&self) -> f64 {
        let far = |f: &dyn Fn(&DrawnPoint) -> f64| {
            let all = self.points.values().map(f);
            let (low, high) =
                all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            (high - low).max(0.0)
        };
        far(&|p| p.u).max(far(&|p| p.v))
    }

    /// Distance of two points on the page; 0 if one is missing.
    pub fn distance(&self, p: PointId, q: PointId) -> f64 {
        let (Some(a), Some(b)) = (self.points.get(&p), self.points.get(&q)) else { return 0.0 };
        libm::hypot(a.u - b.u, a.v - b.v)
    }

    /// Pairs of points closer than `reach` without a line between them, one of them the end of a
    /// single line: point to keep, point to remove and distance. Default of `reach`: 0.005 of the
    /// drawing's extent.
    pub fn gaps(&self, reach: Option<f64>) -> Vec<(PointId, PointId, f64)> {
        let mut uses: BTreeMap<PointId, usize> = BTreeMap::new();
        self.lines.values().flat_map(|l| [l.p, l.q]).for_each(|p| *uses.entry(p).or_default() += 1);
        let given = reach.is_some();
        let reach = reach.unwrap_or(0.005 * self.extent());
        let mut order: Vec<(PointId, DrawnPoint)> =
            self.points.iter().map(|(k, p)| (*k, *p)).collect();
        order.sort_by(|a, b| a.1.u.total_cmp(&b.1.u).then(a.0.cmp(&b.0)));
        let mut pairs = Vec::new();
        for (k, &(a, p)) in order.iter().enumerate() {
            for &(b, q) in order[k + 1..].iter().take_while(|x| x.1.u - p.u <= reach) {
                let distance = libm::hypot(p.u - q.u, p.v - q.v);
                let single = [a, b].iter().any(|p| uses.get(p).copied().unwrap_or(0) == 1);
                if distance <= reach && (given || single) && self.line_between(a, b).is_none() {
                    pairs.push((a.min(b), a.max(b), distance));
                }
            }
        }
        pairs.sort_by(|a, b| a.2.total_cmp(&b.2).then((a.0, a.1).cmp(&(b.0, b.1))));
        pairs
    }

    /// The nearest point within `reach` of a position on the page, otherwise the nearest line and
    /// the fraction of its length.
    pub fn hit(&self, [u, v]: [f64; 2], reach: f64) -> Option<DrawingHit> {
        let square = reach * reach;
        let mut best: Option<(f64, DrawingHit)> = None;
        for (&id, p) in &self.points {
            let d = (p.u - u) * (p.u - u) + (p.v - v) * (p.v - v);
            if d <= square && best.as_ref().is_none_or(|b| d < b.0) {
                best = Some((d, DrawingHit::Point(id)));
            }
        }
        best.map(|b| b.1).or_else(|| self.hit_line([u, v], reach))
    }

    /// The nearest line within `reach` of a position on the page, and the fraction of its length.
    fn hit_line(&self, [u, v]: [f64; 2], reach: f64) -> Option<DrawingHit> {
        let square = reach * reach;
        let mut best: Option<(f64, DrawingHit)> = None;
        for (&id, line) in &self.lines {
            let (Some(a), Some(b)) = (self.points.get(&line.p), self.points.get(&line.q)) else {
                continue;
            };
            let (du, dv) = (b.u - a.u, b.v - a.v);
            let length = du * du + dv * dv;
            if length == 0.0 {
                continue;
            }
            let part = (((u - a.u) * du + (v - a.v) * dv) / length).clamp(0.0, 1.0);
            let (x, y) = (a.u + du * part - u, a.v + dv * part - v);
            let d = x * x + y * y;
            if d <= square && best.as_ref().is_none_or(|b| d < b.0) {
                best = Some((d, DrawingHit::Line { line: id, part }));
            }
        }
        best.map(|b| b.1)
    }

    /// Merges the point `gone` into `kept`: its lines are moved, duplicates are removed.
    pub fn weld(&mut self, kept: PointId, gone: PointId) {
        self.points.remove(&gone);
        let mut seen = std::collections::BTreeSet::new();
        self.lines.retain(|_, l| {
            for end in [&mut l.p, &mut l.q] {
                if *end == gone {
                    *end = kept;
                }
            }
            l.p != l.q && seen.insert((l.p.min(l.q), l.p.max(l.q)))
        });
        for a in &mut self.aligns {
            for end in [&mut a.p, &mut a.q] {
                if *end == gone {
                    *end = kept;
                }
            }
        }
        self.aligns.retain(|a| a.p != a.q);
    }
}
