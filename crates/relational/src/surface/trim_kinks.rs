//! Kinks of a surface inside a trimmed part of it, as lines of vertices along which its triangles meet.

use std::collections::{HashMap, HashSet};

/// Distance from a line within which a vertex is on it, relative to the extent of the region.
const ON_LINE: f64 = 1e-7;

/// The part of a side that the first vertex keeps from it where the line meets the side between its vertices.
const CUT: f64 = 0.5;

/// The region: its polygons, the outer one counter-clockwise and the holes clockwise, in a plane that
/// is stretched along the axes.
pub(crate) struct KinkPlane<'a> {
    pub polygons: &'a [Vec<[f64; 2]>],
    /// Values of u and of v at kinks.
    pub kinks: &'a [Vec<f64>; 2],
    /// Values of u and of v at which the region has inner vertices.
    pub lines: &'a [Vec<f64>; 2],
    /// The least distance of those vertices.
    pub margin: f64,
    /// The coordinate for a parameter along an axis, and the parameter for a coordinate.
    pub forward: &'a dyn Fn(usize, f64) -> f64,
    pub back: &'a dyn Fn(usize, f64) -> f64,
}

/// Vertices on kinks, and the edges between them.
#[derive(Default)]
pub(crate) struct KinkLines {
    /// Parameters (u, v) of the vertices.
    pub places: Vec<[f64; 2]>,
    /// The vertices in the plane.
    pub points: Vec<[f64; 2]>,
    /// Edges; numbers from the number of vertices of the polygons on are those of `points`.
    pub edges: Vec<[usize; 2]>,
}

/// Where a line enters or leaves the region.
#[derive(Clone, Copy)]
struct RimMeeting {
    at: f64,
    /// The vertex there, or the length of the side that is cut.
    how: Result<usize, f64>,
}

impl KinkPlane<'_> {
    /// The kinks within the region.
    pub fn lines(&self) -> KinkLines {
        let mut found = KinkLines::default();
        if self.kinks.iter().all(Vec::is_empty) {
            return found;
        }
        let mut shared = HashMap::new();
        for axis in 0..2 {
            for number in 0..self.kinks[axis].len() {
                self.add(&mut found, &mut shared, axis, number);
            }
        }
        found
    }

    /// True for a coordinate along an axis that is too near to a kink for other vertices.
    pub fn near(&self, axis: usize, x: f64) -> bool {
        let near = 0.8 * self.margin;
        self.kinks[axis].iter().any(|&k| ((self.forward)(axis, k) - x).abs() < near)
    }

    fn near_enough(&self) -> f64 {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in self.polygons.iter().flatten() {
            for k in 0..2 {
                (low[k], high[k]) = (low[k].min(p[k]), high[k].max(p[k]));
            }
        }
        ON_LINE * (high[0] - low[0]).max(high[1] - low[1])
    }

    /// Where the line at `x` of an axis meets the rim, in order, and the sides along it.
    fn meetings(&self, axis: usize, x: f64) -> (Vec<RimMeeting>, HashSet<(usize, usize)>) {
        let near = self.near_enough();
        let (mut met, mut along) = (Vec::new(), HashSet::new());
        let mut first = 0;
        for polygon in self.polygons {
            for k in 0..polygon.len() {
                let next = (k + 1) % polygon.len();
                let (a, b) = (polygon[k], polygon[next]);
                let [s, t] = [a[axis] - x, b[axis] - x];
                if s.abs() <= near {
                    met.push(RimMeeting { at: a[1 - axis], how: Ok(first + k) });
                    if t.abs() <= near {
                        along.insert((first + k, first + next));
                        along.insert((first + next, first + k));
                    }
                } else if t.abs() > near && s * t < 0.0 {
                    let share = s / (s - t);
                    let at = a[1 - axis] + share * (b[1 - axis] - a[1 - axis]);
                    let length = ((b[0] - a[0]).powi(2) + (b[1] - a[1]).powi(2)).sqrt();
                    met.push(RimMeeting { at, how: Err(length) });
                }
            }
            first += polygon.len();
        }
        met.sort_by(|a, b| a.at.total_cmp(&b.at));
        (met, along)
    }

    fn add(
        &self,
        found: &mut KinkLines,
        shared: &mut HashMap<(usize, usize), usize>,
        axis: usize,
        number: usize,
    ) {
        let kink = self.kinks[axis][number];
        let (x, near) = ((self.forward)(axis, kink), self.near_enough());
        let (met, along) = self.meetings(axis, x);
        let rim: usize = self.polygons.iter().map(Vec::len).sum();
        for (from, to) in met.iter().zip(met.iter().skip(1)) {
            let is_rim = matches!((from.how, to.how), (Ok(a), Ok(b)) if along.contains(&(a, b)));
            let middle = 0.5 * (from.at + to.at);
            let middle = if axis == 0 { [x, middle] } else { [middle, x] };
            if to.at - from.at <= near
                || is_rim
                || !super::trim_region::within(self.polygons, middle)
            {
                continue;
            }
            let mut chain: Vec<usize> = from.how.ok().into_iter().collect();
            for (at, parameter, crossed) in self.between(axis, *from, *to, near) {
                let mut add = || {
                    let (mut place, mut point) = ([kink; 2], [x; 2]);
                    (place[1 - axis], point[1 - axis]) = (parameter, at);
                    found.places.push(place);
                    found.points.push(point);
                    rim + found.points.len() - 1
                };
                let vertex = match crossed {
                    Some(other) if axis == 0 => *shared.entry((number, other)).or_insert_with(add),
                    Some(other) => *shared.entry((other, number)).or_insert_with(add),
                    None => add(),
                };
                chain.push(vertex);
            }
            chain.extend(to.how.ok());
            found.edges.extend(chain.windows(2).map(|w| [w[0], w[1]]));
        }
    }

    /// Coordinates of the vertices between two meetings, their parameters, and the kinks that cross there.
    fn between(
        &self,
        axis: usize,
        from: RimMeeting,
        to: RimMeeting,
        near: f64,
    ) -> Vec<(f64, f64, Option<usize>)> {
        let other = 1 - axis;
        let length = to.at - from.at;
        let mut held: Vec<(f64, f64, Option<usize>)> = Vec::new();
        for (number, &kink) in self.kinks[other].iter().enumerate() {
            let at = (self.forward)(other, kink);
            if at > from.at + near && at < to.at - near {
                held.push((at, kink, Some(number)));
            }
        }
        // A side that is cut between its vertices is no end: the first vertex is short of it.
        let ends = [(from, 1.0), (to, -1.0)].map(|(end, way)| match end.how {
            Ok(_) => end.at,
            Err(side) => end.at + way * (CUT * side).min(0.5 * length),
        });
        for (end, at) in [from, to].into_iter().zip(ends) {
            let short = held.iter().all(|(other, ..)| (other - at).abs() > (at - end.at).abs());
            if end.how.is_err() && short {
                held.push((at, (self.back)(other, at), None));
            }
        }
        let fixed: Vec<f64> = held.iter().map(|(at, ..)| *at).chain(ends).collect();
        for &parameter in &self.lines[other] {
            let at = (self.forward)(other, parameter);
            let inside = at > from.at && at < to.at;
            if inside && fixed.iter().all(|other| (other - at).abs() >= 0.8 * self.margin) {
                held.push((at, parameter, None));
            }
        }
        held.sort_by(|a, b| a.0.total_cmp(&b.0));
        held.dedup_by(|next, kept| next.2.is_none() && next.0 - kept.0 <= near);
        held
    }
}
