//! Facets in their planes: winding of loops, and where two facets meet.

use super::pool::Pool;
use super::{Facet, edges_of};
use moldloft_num::Vec3;

#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneCoordinates {
    pub normal: Vec3,
    pub origin: Vec3,
    u: Vec3,
    v: Vec3,
}

impl PlaneCoordinates {
    pub fn new(normal: Vec3, origin: Vec3) -> PlaneCoordinates {
        let u = normal.perpendicular();
        let u = u.normalized().unwrap_or(u);
        PlaneCoordinates { normal, origin, u, v: normal.cross(u) }
    }

    pub fn flat(&self, p: Vec3) -> [f64; 2] {
        let d = p - self.origin;
        [self.u.dot(d), self.v.dot(d)]
    }

    pub fn lift(&self, [x, y]: [f64; 2]) -> Vec3 {
        self.origin + self.u * x + self.v * y
    }

    pub fn height(&self, p: Vec3) -> f64 {
        self.normal.dot(p - self.origin)
    }
}

/// Winding number of edges about a point, counter-clockwise positive.
pub(super) fn winding(edges: impl Iterator<Item = [[f64; 2]; 2]>, [x, y]: [f64; 2]) -> i32 {
    let mut turns = 0;
    for [a, b] in edges {
        if (a[1] > y) == (b[1] > y) {
            continue;
        }
        let side = (b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1]);
        if b[1] > a[1] && side > 0.0 {
            turns -= 1;
        } else if b[1] < a[1] && side < 0.0 {
            turns += 1;
        }
    }
    -turns
}

/// The winding of a facet at a point of its plane, in a frame of that plane.
pub(super) fn facet_winding(pool: &Pool, facet: &Facet, frame: &PlaneCoordinates, p: Vec3) -> i32 {
    let edges = edges_of(facet).map(|[a, b]| [frame.flat(pool.at(a)), frame.flat(pool.at(b))]);
    winding(edges, frame.flat(p))
}

/// A stop on the common line of two planes: the parameter on the line, and the exact point.
type Stop = (f64, Vec3);

/// The intervals of a line in the plane of a facet that are in it, its border included.
fn intervals(
    pool: &Pool,
    facet: &Facet,
    frame: &PlaneCoordinates,
    other: &PlaneCoordinates,
    [origin, direction]: [Vec3; 2],
) -> Vec<[Stop; 2]> {
    let tolerance = pool.tolerance;
    let along = |p: Vec3| (p - origin).dot(direction);
    let snapped = |p: Vec3| {
        let h = other.height(p);
        if h.abs() <= tolerance { 0.0 } else { h }
    };
    let mut stops: Vec<Stop> = Vec::new();
    let mut taken: Vec<[f64; 2]> = Vec::new();
    for [a, b] in edges_of(facet) {
        let (p, q) = (pool.at(a), pool.at(b));
        let (hp, hq) = (snapped(p), snapped(q));
        if hp == 0.0 {
            stops.push((along(p), p));
            if hq == 0.0 {
                let (s, t) = (along(p), along(q));
                taken.push([s.min(t), s.max(t)]);
            }
        }
        if hp * hq < 0.0 {
            let x = p + (q - p) * (hp / (hp - hq));
            stops.push((along(x), x));
        }
    }
    stops.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut found: Vec<[Stop; 2]> = Vec::new();
    for pair in stops.windows(2) {
        if pair[1].0 - pair[0].0 <= tolerance {
            continue;
        }
        let middle = 0.5 * (pair[0].0 + pair[1].0);
        let on_edge = taken.iter().any(|i| i[0] <= middle && middle <= i[1]);
        let inside = on_edge || facet_winding(pool, facet, frame, origin + direction * middle) != 0;
        if !inside {
            continue;
        }
        match found.last_mut() {
            // Stops within the tolerance of each other are one.
            Some(last) if pair[0].0 - last[1].0 <= tolerance => last[1] = pair[1],
            _ => found.push([pair[0], pair[1]]),
        }
    }
    found
}

/// The segments in which two facets of different planes meet.
pub(super) fn common_segments(
    pool: &Pool,
    [a, b]: [&Facet; 2],
    [fa, fb]: [&PlaneCoordinates; 2],
) -> Vec<[Vec3; 2]> {
    let Some(direction) = fa.normal.cross(fb.normal).normalized() else { return vec![] };
    // The common line through the foot of the first origin.
    let cos = fa.normal.dot(fb.normal);
    let det = 1.0 - cos * cos;
    if det < 1e-20 {
        return vec![];
    }
    let base = fa.origin;
    let h = -fb.height(base);
    let origin = base + (fb.normal - fa.normal * cos) * (h / det);
    let first = intervals(pool, a, fa, fb, [origin, direction]);
    if first.is_empty() {
        return vec![];
    }
    let second = intervals(pool, b, fb, fa, [origin, direction]);
    let mut segments = Vec::new();
    for i in &first {
        for j in &second {
            let low = if i[0].0 >= j[0].0 { i[0] } else { j[0] };
            let high = if i[1].0 <= j[1].0 { i[1] } else { j[1] };
            if high.0 - low.0 > pool.tolerance {
                segments.push([low.1, high.1]);
            }
        }
    }
    segments
}
