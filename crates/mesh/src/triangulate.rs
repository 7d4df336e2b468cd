//! Triangles of a plane polygon with holes, by cutting ears.

use moldloft_num::Vec3;

/// Triangles of a polygon as indices into `points`; loops wind counter-clockwise about `normal`,
/// holes clockwise. Every edge of the loops is an edge of a triangle; no vertex is added. A
/// self-intersecting polygon gives the same number of triangles, some with the wrong orientation.
pub fn triangulate(points: &[Vec3], loops: &[Vec<usize>], normal: Vec3) -> Vec<[usize; 3]> {
    let u = if normal.norm_sq() > 0.0 { normal.perpendicular() } else { Vec3::of(1.0, 0.0, 0.0) };
    let v = normal.normalized().unwrap_or_default().cross(u);
    let flat: Vec<[f64; 2]> = points.iter().map(|p| [p.dot(u), p.dot(v)]).collect();
    let Some((outer, holes)) = loops.split_first() else { return vec![] };
    let mut ring = outer.clone();
    let right =
        |hole: &Vec<usize>| hole.iter().map(|&k| flat[k][0]).fold(f64::NEG_INFINITY, f64::max);
    let mut order: Vec<&Vec<usize>> = holes.iter().filter(|h| !h.is_empty()).collect();
    order.sort_by(|a, b| right(b).total_cmp(&right(a)));
    for hole in order {
        bridge(&flat, &mut ring, hole, holes);
    }
    ears(&flat, ring)
}

fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Joins a hole to the ring by a bridge to a corner that its rightmost point sees
/// (D. Eberly, *Triangulation by Ear Clipping*, section 5).
fn bridge(flat: &[[f64; 2]], ring: &mut Vec<usize>, hole: &[usize], holes: &[Vec<usize>]) {
    let start = (0..hole.len()).max_by(|&a, &b| flat[hole[a]][0].total_cmp(&flat[hole[b]][0]));
    let start = start.unwrap_or(0);
    let m = flat[hole[start]];
    // The corner nearest to the hole's point whose connection crosses no edge of the ring or of a hole.
    let clear = |k: usize| {
        let p = flat[ring[k]];
        let cycles = std::iter::once(&*ring).chain(holes);
        let mut sides =
            cycles.flat_map(|c| (0..c.len()).map(|i| (flat[c[i]], flat[c[(i + 1) % c.len()]])));
        sides.all(|(a, b)| {
            if [a, b].iter().any(|x| *x == p || *x == m) {
                return true;
            }
            let (s, t) = (turn(m, p, a), turn(m, p, b));
            let (x, y) = (turn(a, b, m), turn(a, b, p));
            let crosses = (s > 0.0) != (t > 0.0) && (x > 0.0) != (y > 0.0);
            // A corner exactly on the connection blocks it too.
            let between = |q: [f64; 2]| {
                turn(m, p, q) == 0.0
                    && (q[0] - m[0]) * (q[0] - p[0]) + (q[1] - m[1]) * (q[1] - p[1]) < 0.0
            };
            !crosses && !between(a)
        })
    };
    // Inside the corner's angle, where a corner occurs twice.
    let within = |k: usize| {
        let n = ring.len();
        let (a, p, b) = (flat[ring[(k + n - 1) % n]], flat[ring[k]], flat[ring[(k + 1) % n]]);
        if turn(a, p, b) >= 0.0 {
            turn(a, p, m) >= 0.0 && turn(p, b, m) >= 0.0
        } else {
            turn(a, p, m) >= 0.0 || turn(p, b, m) >= 0.0
        }
    };
    let far = |k: usize| {
        let p = flat[ring[k]];
        (p[0] - m[0]) * (p[0] - m[0]) + (p[1] - m[1]) * (p[1] - m[1])
    };
    let mut order: Vec<usize> = (0..ring.len()).collect();
    order.sort_by(|&a, &b| far(a).total_cmp(&far(b)).then(a.cmp(&b)));
    let seen = order.iter().copied().find(|&k| within(k) && clear(k));
    let at = seen.or(order.first().copied()).unwrap_or(0);
    let mut path: Vec<usize> = hole[start..].iter().chain(&hole[..=start]).copied().collect();
    path.push(ring[at]);
    ring.splice(at + 1..at + 1, path);
}

fn ears(flat: &[[f64; 2]], mut ring: Vec<usize>) -> Vec<[usize; 3]> {
    let mut triangles = Vec::with_capacity(ring.len());
    while ring.len() > 3 {
        let n = ring.len();
        let corner = |k: usize| [ring[(k + n - 1) % n], ring[k], ring[(k + 1) % n]];
        let ear = |k: usize| {
            let [a, b, c] = corner(k).map(|i| flat[i]);
            turn(a, b, c) > 0.0
                && ring.iter().all(|&i| {
                    let p = flat[i];
                    p == a
                        || p == b
                        || p == c
                        // On the cut itself it would be left outside; on the sides it cannot be.
                        || turn(a, b, p) <= 0.0
                        || turn(b, c, p) <= 0.0
                        || turn(c, a, p) < 0.0
                })
        };
        // The fattest ear: its smallest height over its longest side.
        let quality = |k: usize| {
            let [a, b, c] = corner(k).map(|i| flat[i]);
            let side = |p: [f64; 2], q: [f64; 2]| {
                (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1])
            };
            turn(a, b, c) / side(a, b).max(side(b, c)).max(side(c, a))
        };
        let best = if n <= 64 {
            let ears = (0..n).filter(|&k| ear(k));
            ears.max_by(|&a, &b| quality(a).total_cmp(&quality(b)))
        } else {
            (0..n).find(|&k| ear(k))
        };
        // A flat or crossed rest has no ear: take the corner that turns most.
        let k = best.unwrap_or_else(|| {
            let all = (0..n).map(|k| (k, quality(k)));
            all.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |x| x.0)
        });
        triangles.push(corner(k));
        ring.remove(k);
    }
    if let [a, b, c] = ring[..] {
        triangles.push([a, b, c]);
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plate_with_two_holes() {
        let square = |x: f64, y: f64, s: f64| {
            [[x, y], [x + s, y], [x + s, y + s], [x, y + s]].map(|[x, y]| Vec3::of(x, y, 1.0))
        };
        let mut points = square(0.0, 0.0, 10.0).to_vec();
        points.extend(square(1.0, 1.0, 3.0));
        points.extend(square(5.0, 1.0, 3.0));
        let loops = vec![vec![0, 1, 2, 3], vec![7, 6, 5, 4], vec![11, 10, 9, 8]];
        let triangles = triangulate(&points, &loops, Vec3::of(0.0, 0.0, 2.0));
        let area = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|k| points[k]);
            (b - a).cross(c - a).z / 2.0
        };
        let areas: Vec<f64> = triangles.iter().map(area).collect();
        assert!(areas.iter().all(|a| *a > 0.0), "{triangles:?} {areas:?}");
        assert!((triangles.iter().map(area).sum::<f64>() - 82.0).abs() < 1e-12);
        assert_eq!(triangles.len(), 12 + 2 * 2 - 2);
    }
}
