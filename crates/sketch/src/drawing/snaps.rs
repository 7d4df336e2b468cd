//! Snaps of a pointer: positions on the page that it may mean.

use crate::{CoordinateAxis, Drawing, DrawingHit, LineId, PointId};

/// Sine of the angle below which two directions have no crossing.
const PARALLEL: f64 = 0.1;

/// Sine of the angle to an axis below which a line has no direction of its own.
const ALONG: f64 = 0.02;

/// Part of a line's length around its middle that is the middle.
const MIDDLE: f64 = 0.04;

/// Kind of a snap, from the strongest to the weakest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SnapKind {
    /// A point.
    Point,
    /// The crossing of two directions.
    Cross,
    /// The middle of a line.
    Middle,
    /// A line.
    Line,
    /// An axis through the start or a point.
    Axis,
    /// The extension of a line.
    Extension,
    /// The parallel of a line through the start.
    Parallel,
}

impl SnapKind {
    /// The word for data.
    pub fn word(self) -> &'static str {
        match self {
            SnapKind::Point => "point",
            SnapKind::Cross => "cross",
            SnapKind::Middle => "mid",
            SnapKind::Line => "line",
            SnapKind::Axis => "axis",
            SnapKind::Extension => "extension",
            SnapKind::Parallel => "parallel",
        }
    }
}

/// A direction on the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SnapDirection {
    /// Along an axis.
    Axis(CoordinateAxis),
    /// Along a line.
    Line(LineId),
}

impl std::fmt::Display for SnapDirection {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            SnapDirection::Axis(axis) => write!(f, "{axis}"),
            SnapDirection::Line(line) => write!(f, "line {line}"),
        }
    }
}

/// A position on the page to which a pointer snaps.
#[derive(Clone, Debug, PartialEq)]
pub struct Snap {
    /// The position.
    pub at: [f64; 2],
    /// Its kind.
    pub kind: SnapKind,
    /// The point or line there.
    pub hit: Option<DrawingHit>,
    /// The directions through it: two of a crossing.
    pub directions: Vec<SnapDirection>,
    /// The points that the directions start from; the start of the line has none.
    pub of: Vec<PointId>,
}

/// A direction through a point, or through the start, near the pointer.
#[derive(Clone, Copy)]
struct SnapRay {
    off: f64,
    direction: SnapDirection,
    point: Option<PointId>,
    through: [f64; 2],
    along: [f64; 2],
    kind: SnapKind,
}

impl Drawing {
    /// Meanings of a position on the page within `reach`, the likeliest first.
    ///
    /// In this order: the nearest point; crossings of a direction through `start` with one through a
    /// point, or of two through points of `awake`, by distance; the middle of the nearest line; that line;
    /// directions through the start and the points of `awake`, by distance; axes through other points. Directions
    /// are the axes, the lines that end at a point of `awake`, as extensions of it, and their parallels through
    /// the start, at which a line under construction begins.
    pub fn snaps(
        &self,
        at: [f64; 2],
        reach: f64,
        start: Option<[f64; 2]>,
        awake: &[PointId],
    ) -> Vec<Snap> {
        let mut out = Vec::new();
        let hit = self.hit(at, reach);
        if let Some(DrawingHit::Point(point)) = hit {
            let p = self.points[&point];
            let at = [p.u, p.v];
            out.push(Snap { at, kind: SnapKind::Point, hit, directions: vec![], of: vec![] });
        }
        let axes: Vec<(SnapDirection, [f64; 2])> = (CoordinateAxis::ALL.into_iter())
            .filter(|a| self.section != Some(*a))
            .filter_map(|a| Some((SnapDirection::Axis(a), unit(self.projection.unit(a))?)))
            .collect();
        let ray = |point, through: [f64; 2], (direction, along): (_, [f64; 2]), kind| {
            let off = cross(to(through, at), along).abs();
            SnapRay { off, direction, point, through, along, kind }
        };
        let mut all: Vec<SnapRay> = Vec::new();
        for (&id, p) in &self.points {
            all.extend(axes.iter().map(|a| ray(Some(id), [p.u, p.v], *a, SnapKind::Axis)));
        }
        let (mut strong, mut lively) = (Vec::new(), Vec::new());
        if let Some(start) = start {
            strong.extend(axes.iter().map(|a| ray(None, start, *a, SnapKind::Axis)));
        }
        lively.extend(all.iter().filter(|r| r.point.is_some_and(|p| awake.contains(&p))));
        for (&id, line) in &self.lines {
            let Some(way) = unit(self.stroke(line)) else { continue };
            if axes.iter().any(|a| cross(way, a.1).abs() < ALONG) {
                continue;
            }
            let own = (SnapDirection::Line(id), way);
            for end in [line.p, line.q].into_iter().filter(|p| awake.contains(p)) {
                let Some(p) = self.points.get(&end) else { continue };
                lively.push(ray(Some(end), [p.u, p.v], own, SnapKind::Extension));
                strong.extend(start.map(|s| ray(None, s, own, SnapKind::Parallel)));
            }
        }
        for rays in [&mut all, &mut strong, &mut lively] {
            rays.retain(|r| r.off <= reach);
            rays.sort_by(|a, b| a.off.total_cmp(&b.off));
        }
        let mut crossings: Vec<(f64, Snap)> = Vec::new();
        let pairs = (strong.iter().flat_map(|s| all.iter().map(move |r| (s, r)))).chain(
            lively.iter().enumerate().flat_map(|(k, r)| lively[..k].iter().map(move |s| (s, r))),
        );
        for (one, two) in pairs {
            let Some(place) = crossing(one, two) else { continue };
            let off = distance(place, at);
            if off <= reach && start.is_none_or(|s| distance(place, s) > reach) {
                let of = [one.point, two.point].into_iter().flatten().collect();
                let directions = vec![one.direction, two.direction];
                let kind = SnapKind::Cross;
                crossings.push((off, Snap { at: place, kind, hit: None, directions, of }));
            }
        }
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        out.extend(crossings.into_iter().map(|c| c.1));
        if let Some(DrawingHit::Line { line, part }) = self.hit_line(at, reach) {
            let l = self.lines[&line];
            let [a, b] = [l.p, l.q].map(|p| self.points[&p]);
            let on = |s: f64| [a.u + (b.u - a.u) * s, a.v + (b.v - a.v) * s];
            let snap = |part: f64, kind| {
                let hit = Some(DrawingHit::Line { line, part });
                Snap { at: on(part), kind, hit, directions: vec![], of: vec![] }
            };
            if (part - 0.5).abs() <= MIDDLE {
                out.push(snap(0.5, SnapKind::Middle));
            }
            if part > 0.0 && part < 1.0 {
                out.push(snap(part, SnapKind::Line));
            }
        }
        let mut near: Vec<SnapRay> = strong.iter().chain(&lively).copied().collect();
        near.sort_by(|a, b| a.off.total_cmp(&b.off));
        let asleep = |r: &&SnapRay| r.point.is_some_and(|p| !awake.contains(&p));
        near.extend(all.iter().filter(asleep));
        for r in near {
            let s = dot(to(r.through, at), r.along);
            if s.abs() > reach {
                out.push(Snap {
                    at: [r.through[0] + s * r.along[0], r.through[1] + s * r.along[1]],
                    kind: r.kind,
                    hit: None,
                    directions: vec![r.direction],
                    of: r.point.into_iter().collect(),
                });
            }
        }
        out
    }
}

fn crossing(one: &SnapRay, two: &SnapRay) -> Option<[f64; 2]> {
    let sine = cross(one.along, two.along);
    let t = cross(to(one.through, two.through), two.along) / sine;
    (sine.abs() >= PARALLEL)
        .then(|| [one.through[0] + t * one.along[0], one.through[1] + t * one.along[1]])
}

fn unit([x, y]: [f64; 2]) -> Option<[f64; 2]> {
    let size = libm::hypot(x, y);
    (size > 0.0).then(|| [x / size, y / size])
}

fn to(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [b[0] - a[0], b[1] - a[1]]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(b[0] - a[0], b[1] - a[1])
}
