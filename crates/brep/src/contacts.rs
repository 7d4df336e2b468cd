//! Bodies that touch themselves along lines: every side of a triangle gets one other triangle.

use moldloft_num::Vec3;
use moldloft_num::union_find::UnionFind;
use std::collections::BTreeMap;

/// A triangle at a side: its number, true if it runs from the side's lower vertex to the higher one,
/// and the direction of its third corner across the side.
struct Fan {
    triangle: usize,
    forward: bool,
    away: Vec3,
}

/// Triangles with a vertex for each part of the body round a place where the body touches itself, so
/// that a side has two triangles: those with material between them. `None` if all have, or if they do
/// not alternate round a side.
pub(crate) fn parted(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
) -> Option<(Vec<Vec3>, Vec<[u32; 3]>)> {
    let mut sides: BTreeMap<(u32, u32), Vec<Fan>> = BTreeMap::new();
    for (triangle, t) in triangles.iter().enumerate() {
        for side in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|k| t[(side + k) % 3]);
            let [low, high] = [a.min(b), a.max(b)].map(|v| positions[v as usize]);
            let axis = (high - low).normalized()?;
            let off = positions[c as usize] - low;
            let away = off - axis * axis.dot(off);
            sides.entry((a.min(b), a.max(b))).or_default().push(Fan {
                triangle,
                forward: a < b,
                away,
            });
        }
    }
    if sides.values().all(|round| round.len() == 2) {
        return None;
    }
    let mut corners = UnionFind::new(3 * triangles.len());
    for ((a, b), mut round) in sides {
        let axis = (positions[b as usize] - positions[a as usize]).normalized()?;
        if round.len() != 2 {
            let x = round[0].away.normalized()?;
            let y = axis.cross(x);
            let angle = |f: &Fan| libm::atan2(f.away.dot(y), f.away.dot(x));
            round.sort_by(|f, g| angle(f).total_cmp(&angle(g)).then(f.forward.cmp(&g.forward)));
        }
        // Material is counter-clockwise of a triangle that runs backward, up to the next one.
        let n = round.len();
        for k in 0..n {
            let (one, next) = (&round[k], &round[(k + 1) % n]);
            if one.forward {
                continue;
            }
            if !next.forward {
                return None;
            }
            let corner = |f: &Fan, v: u32| {
                let at = triangles[f.triangle].iter().position(|w| *w == v)?;
                Some(3 * f.triangle + at)
            };
            for v in [a, b] {
                corners.join(corner(one, v)?, corner(next, v)?);
            }
        }
        if round.iter().filter(|f| f.forward).count() * 2 != n {
            return None;
        }
    }
    let mut positions = positions.to_vec();
    let mut own: BTreeMap<usize, u32> = BTreeMap::new();
    let mut taken = vec![false; positions.len()];
    let mut out = triangles.to_vec();
    for (k, t) in triangles.iter().enumerate() {
        for (i, &v) in t.iter().enumerate() {
            let class = corners.find(3 * k + i);
            out[k][i] = *own.entry(class).or_insert_with(|| {
                if !std::mem::replace(&mut taken[v as usize], true) {
                    return v;
                }
                positions.push(positions[v as usize]);
                positions.len() as u32 - 1
            });
        }
    }
    Some((positions, out))
}
