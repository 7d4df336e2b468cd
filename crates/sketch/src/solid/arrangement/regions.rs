//! The regions into which edges divide a plane.

use super::plane::{PlaneCoordinates, winding};
use super::pool::Pool;
use moldloft_num::union_find::UnionFind;
use std::collections::{BTreeMap, BTreeSet};

/// A region of a sheet: loops with the region to their left, the outer one first.
pub(super) type Loops = Vec<Vec<u32>>;

/// All bounded regions between edges that meet at their ends only.
pub(super) fn regions(
    pool: &Pool,
    frame: &PlaneCoordinates,
    edges: &BTreeSet<(u32, u32)>,
) -> Vec<Loops> {
    let flat = |v: u32| frame.flat(pool.at(v));
    let mut leaving: BTreeMap<u32, Vec<(f64, u32)>> = BTreeMap::new();
    for &(a, b) in edges {
        for (p, q) in [(a, b), (b, a)] {
            let (s, t) = (flat(p), flat(q));
            let angle = moldloft_num::Real::atan2(t[1] - s[1], t[0] - s[0]);
            leaving.entry(p).or_default().push((angle, q));
        }
    }
    for out in leaving.values_mut() {
        out.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }
    // The next edge along a region: the one just clockwise of the reverse direction.
    let next = |(a, b): (u32, u32)| -> (u32, u32) {
        let out = &leaving[&b];
        let back = out.iter().position(|o| o.1 == a).unwrap_or(0);
        (b, out[(back + out.len() - 1) % out.len()].1)
    };
    let mut used: BTreeSet<(u32, u32)> = BTreeSet::new();
    let (mut outer, mut inner): (Vec<(f64, Loops)>, Vec<Vec<u32>>) = (Vec::new(), Vec::new());
    for &(a, b) in edges {
        for start in [(a, b), (b, a)] {
            let (mut cycle, mut at) = (Vec::new(), start);
            while used.insert(at) {
                cycle.push(at.0);
                at = next(at);
            }
            if cycle.is_empty() {
                continue;
            }
            let area = area(&cycle.iter().map(|&v| flat(v)).collect::<Vec<_>>());
            if area > pool.tolerance * pool.tolerance {
                outer.push((area, vec![cycle]));
            } else {
                inner.push(cycle);
            }
        }
    }
    if inner.len() <= 1 {
        // One connected figure: its inner loop is its own outside.
        return outer.into_iter().map(|o| o.1).collect();
    }
    let figure = figures(edges);
    for cycle in inner {
        let own = figure[&cycle[0]];
        let at = flat(cycle[0]);
        let around = outer.iter_mut().filter(|(_, loops)| {
            let ring = &loops[0];
            let n = ring.len();
            let sides = (0..n).map(|k| [flat(ring[k]), flat(ring[(k + 1) % n])]);
            figure[&ring[0]] != own && winding(sides, at) != 0
        });
        if let Some((_, loops)) = around.min_by(|a, b| a.0.total_cmp(&b.0)) {
            loops.push(cycle);
        }
    }
    outer.into_iter().map(|o| o.1).collect()
}

/// Twice the area inside a polygon.
pub(super) fn area(points: &[[f64; 2]]) -> f64 {
    let n = points.len();
    let o = points[0];
    (0..n)
        .map(|k| {
            let (p, q) = (points[k], points[(k + 1) % n]);
            (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])
        })
        .sum()
}

/// The connected figure of each vertex, by its lowest vertex.
fn figures(edges: &BTreeSet<(u32, u32)>) -> BTreeMap<u32, u32> {
    let all: BTreeSet<u32> = edges.iter().flat_map(|&(a, b)| [a, b]).collect();
    let all: Vec<u32> = all.into_iter().collect();
    let index = |v: u32| all.partition_point(|&w| w < v);
    let mut sets = UnionFind::new(all.len());
    edges.iter().for_each(|&(a, b)| sets.join(index(a), index(b)));
    all.iter().enumerate().map(|(k, &v)| (v, all[sets.find(k)])).collect()
}

/// A point inside a region: halfway from the middle of its longest edge to the opposite side.
pub(super) fn inner_point(
    pool: &Pool,
    frame: &PlaneCoordinates,
    loops: &Loops,
) -> Option<[f64; 2]> {
    let sides: Vec<[[f64; 2]; 2]> = loops
        .iter()
        .flat_map(|c| {
            (0..c.len())
                .map(|k| [frame.flat(pool.at(c[k])), frame.flat(pool.at(c[(k + 1) % c.len()]))])
        })
        .collect();
    let long = |s: &[[f64; 2]; 2]| (s[1][0] - s[0][0]).powi(2) + (s[1][1] - s[0][1]).powi(2);
    let outer = loops.first()?.len();
    let longest = (0..outer).max_by(|&a, &b| long(&sides[a]).total_cmp(&long(&sides[b])))?;
    let [a, b] = sides[longest];
    let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    let length = moldloft_num::Real::sqrt(long(&sides[longest]));
    let left = [-(b[1] - a[1]) / length, (b[0] - a[0]) / length];
    let mut nearest = f64::INFINITY;
    for (k, [p, q]) in sides.iter().enumerate() {
        if k == longest {
            continue;
        }
        // Coordinates across and along the direction to the left.
        let local = |x: &[f64; 2]| {
            let d = [x[0] - middle[0], x[1] - middle[1]];
            [d[0] * left[1] - d[1] * left[0], d[0] * left[0] + d[1] * left[1]]
        };
        let (p, q) = (local(p), local(q));
        // Sides that only touch the path count too: half the distance to them is certainly inside.
        let margin = pool.tolerance;
        if p[0].min(q[0]) > margin || p[0].max(q[0]) < -margin {
            continue;
        }
        let t = if (p[0] - q[0]).abs() <= 2.0 * margin {
            p[1].min(q[1])
        } else {
            let part = (p[0] / (p[0] - q[0])).clamp(0.0, 1.0);
            p[1] + (q[1] - p[1]) * part
        };
        if t > pool.tolerance && t < nearest {
            nearest = t;
        }
    }
    let t = 0.5 * nearest;
    t.is_finite().then(|| [middle[0] + left[0] * t, middle[1] + left[1] * t])
}
