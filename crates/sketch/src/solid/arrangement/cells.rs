//! Winding numbers of the operands in the cells between regions.

use super::plane::{PlaneCoordinates, facet_winding};
use super::pool::Pool;
use super::{ArrangeError, ArrangedRegion, Facet};
use moldloft_num::union_find::UnionFind;
use moldloft_num::{Real, Vec3};
use std::collections::BTreeMap;

/// Numbers of windings, by operand.
pub(super) type Turns = [i32; 2];

/// The windings in front of and behind each region.
pub(super) fn windings(
    pool: &Pool,
    facets: &[Facet],
    frames: &[PlaneCoordinates],
    sheets: &[PlaneCoordinates],
    regions: &[ArrangedRegion],
) -> Result<Vec<[Turns; 2]>, ArrangeError> {
    // The sides of regions, by their lower and higher end; the flag tells that they begin there.
    let mut wings: Vec<(u32, u32, usize, bool)> = Vec::new();
    for (r, region) in regions.iter().enumerate() {
        for cycle in &region.loops {
            for k in 0..cycle.len() {
                let (a, b) = (cycle[k], cycle[(k + 1) % cycle.len()]);
                wings.push((a.min(b), a.max(b), r, a < b));
            }
        }
    }
    wings.sort_unstable();
    let angle = |&(low, high, r, up): &(u32, u32, usize, bool)| {
        let d = pool.at(high) - pool.at(low);
        let x = d.perpendicular();
        let y = d.cross(x).normalized().unwrap_or_default();
        let x = x.normalized().unwrap_or_default();
        let along = if up { d } else { -d };
        let inward = sheets[regions[r].sheet].normal.cross(along);
        Real::atan2(inward.dot(y), inward.dot(x))
    };
    let mut sets = UnionFind::new(2 * regions.len());
    let mut parts = UnionFind::new(regions.len());
    for own in wings.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        // Two are neighbours on both sides, at any angle.
        let turned = |w| if own.len() > 2 { angle(w) } else { 0.0 };
        let mut around: Vec<(f64, usize, bool)> =
            own.iter().map(|w| (turned(w), w.2, w.3)).collect();
        around.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let n = around.len();
        for k in 0..n {
            let (here, next) = (around[k], around[(k + 1) % n]);
            let (front, back) = (2 * here.1 as u32, 2 * here.1 as u32 + 1);
            let ahead = if here.2 { front } else { back };
            let (front, back) = (2 * next.1 as u32, 2 * next.1 as u32 + 1);
            let behind = if next.2 { back } else { front };
            sets.join(ahead, behind);
            parts.join(here.1 as u32, next.1 as u32);
        }
    }
    let mut sides: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for s in 0..2 * regions.len() as u32 {
        sides.entry(sets.find(s)).or_default().push(s);
    }
    let mut known: BTreeMap<u32, Turns> = BTreeMap::new();
    for start in 0..regions.len() as u32 {
        if parts.find(start) != start {
            continue;
        }
        let root = sets.find(2 * start);
        known.insert(root, in_front(pool, facets, frames, sheets, &regions[start as usize])?);
        let mut waiting = vec![root];
        while let Some(root) = waiting.pop() {
            let here = known[&root];
            for &s in &sides[&root] {
                let region = &regions[s as usize / 2];
                let sign = if s % 2 == 0 { 1 } else { -1 };
                let there: Turns = [0, 1].map(|k| here[k] + sign * region.turns[k]);
                let other = sets.find(s ^ 1);
                match known.get(&other) {
                    Some(found) if *found != there => {
                        return Err(ArrangeError::Inconsistent(region.inner));
                    }
                    Some(_) => {}
                    None => {
                        known.insert(other, there);
                        waiting.push(other);
                    }
                }
            }
        }
    }
    Ok((0..regions.len() as u32)
        .map(|r| [2 * r, 2 * r + 1].map(|s| known[&sets.find(s)]))
        .collect())
}

/// The windings in front of a region: the number of exits of a ray from it, less the entries.
fn in_front(
    pool: &Pool,
    facets: &[Facet],
    frames: &[PlaneCoordinates],
    sheets: &[PlaneCoordinates],
    region: &ArrangedRegion,
) -> Result<Turns, ArrangeError> {
    let from = region.inner;
    let frame = &sheets[region.sheet];
    let size = pool.tolerance * 1e9;
    'directions: for turn in 0..24 {
        // Directions in front of the region that no drawing prefers.
        let angle = 0.7 + 2.399_963 * f64::from(turn);
        let lean = 0.37 + 0.02 * f64::from(turn);
        let side = frame.lift([Real::cos(angle), Real::sin(angle)]) - frame.origin;
        let direction = frame.normal + side * lean;
        let mut turns = [0; 2];
        for (facet, own) in facets.iter().zip(frames) {
            let rate = own.normal.dot(direction);
            if rate.abs() < 1e-9 {
                continue;
            }
            let t = -own.height(from) / rate;
            if t <= pool.tolerance {
                continue;
            }
            let hit = from + direction * t;
            let low = facet.bounds[0];
            let high = facet.bounds[1];
            let margin = 1e-6 * size;
            if (0..3).any(|k| hit[k] < low[k] - margin || hit[k] > high[k] + margin) {
                continue;
            }
            if near_border(pool, facet, hit, 1e-7 * size) {
                continue 'directions;
            }
            let count = facet_winding(pool, facet, own, hit);
            turns[facet.operand] += if rate > 0.0 { count } else { -count };
        }
        return Ok(turns);
    }
    Err(ArrangeError::Inconsistent(from))
}

fn near_border(pool: &Pool, facet: &Facet, p: Vec3, margin: f64) -> bool {
    super::edges_of(facet).any(|[a, b]| {
        let (a, b) = (pool.at(a), pool.at(b));
        let d = b - a;
        let t = ((p - a).dot(d) / d.norm_sq()).clamp(0.0, 1.0);
        (a + d * t).distance(p) <= margin
    })
}
