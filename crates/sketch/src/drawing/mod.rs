//! What was drawn: points, typed lines and alignments on a page.

pub(crate) mod axis;
pub(crate) mod estimate;
pub(crate) mod line_types;
pub(crate) mod planes;
pub(crate) mod projection;

use axis::{Axis, Free, Letters};
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

/// A point as drawn. Where it is in space follows from its planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Screen right.
    pub u: f64,
    /// Screen up.
    pub v: f64,
}

/// Who said which type a line has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Its slope, within the tolerance.
    Auto,
    /// The user.
    User,
    /// The planes that its ends share.
    Inferred,
}

impl Source {
    /// The word for files.
    pub fn word(self) -> &'static str {
        match self {
            Source::Auto => "auto",
            Source::User => "user",
            Source::Inferred => "inferred",
        }
    }
}

/// A line between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Where it starts.
    pub p: PointId,
    /// End.
    pub q: PointId,
    /// Its type; `None` while unknown.
    pub free: Option<Free>,
    /// Where the type is from.
    pub source: Source,
    /// How sure the type is, 0 to 1; below 0.6 it is listed by CHECK.
    pub confidence: f64,
}

/// Two points said to lie in the same plane perpendicular to `axis`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Align {
    /// The axis whose coordinate they share.
    pub axis: Axis,
    /// One point.
    pub p: PointId,
    /// The other.
    pub q: PointId,
}

/// The flat picture of one object.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// For a cross section, the axis it is perpendicular to.
    pub section: Option<Axis>,
    /// How the axes were drawn.
    pub projection: Projection,
    /// What H, P and F mean.
    pub letters: Letters,
    /// The points by label.
    pub points: BTreeMap<PointId, Point>,
    /// The lines by label.
    pub lines: BTreeMap<LineId, Line>,
    /// Points in common planes beyond what lines say.
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
        let same = |l: &Line| (l.p == a && l.q == b) || (l.p == b && l.q == a);
        self.lines.iter().find(|(_, l)| same(l)).map(|(id, _)| *id)
    }

    /// The drawn vector of a line, from its start to its end.
    pub fn stroke(&self, line: &Line) -> [f64; 2] {
        let at = |id| self.points.get(&id).map_or([0.0; 2], |p| [p.u, p.v]);
        let (a, b) = (at(line.p), at(line.q));
        [b[0] - a[0], b[1] - a[1]]
    }

    /// `3-7 (X)`: a line for people.
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

    /// Makes `gone` the same point as `kept`: its lines are moved, doubled ones dropped.
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
