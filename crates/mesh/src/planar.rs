//! Triangles of a region of the plane with points inside it: Delaunay's, as far as the rim allows.

use crate::triangulate;
use moldloft_num::Vec3;
use std::collections::{HashMap, HashSet};

/// Points with less than this share of the area to an edge lie on it.
const ON_EDGE: f64 = 1e-9;

/// Triangles of less than this share of the region's box have three corners in one line.
const FLAT: f64 = 1e-13;

/// Triangles, counter-clockwise, of the region between `loops` (the first counter-clockwise round the
/// others, which are clockwise), with the points `inner` inside it as vertices. Every edge of the loops
/// is an edge of a triangle; within them edges are flipped until no vertex lies in the circumcircle of a
/// neighbouring triangle (Lawson 1977). A point of `inner` that lies in no triangle is left out.
///
/// # Example
/// ```
/// let points = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [2.0, 2.0]];
/// let triangles = moldloft_mesh::planar_triangles(&points, &[vec![0, 1, 2, 3]], &[4]);
/// assert_eq!(triangles.len(), 4);
/// ```
pub fn planar_triangles(
    points: &[[f64; 2]],
    loops: &[Vec<usize>],
    inner: &[usize],
) -> Vec<[usize; 3]> {
    let lifted: Vec<Vec3> = points.iter().map(|&[x, y]| Vec3::of(x, y, 0.0)).collect();
    // The plane's own axes would be turned, which changes nothing here.
    let ears = triangulate(&lifted, loops, Vec3::of(0.0, 0.0, 1.0));
    let rim = loops.iter().flat_map(|l| (0..l.len()).map(|k| key(l[k], l[(k + 1) % l.len()])));
    let mut net = PlanarTriangulation {
        points,
        rim: rim.collect(),
        triangles: Vec::new(),
        sides: HashMap::new(),
    };
    let extent = |k: usize| {
        let all = loops.iter().flatten().map(|&p| points[p][k]);
        let (low, high) =
            all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        high - low
    };
    let flat = FLAT * extent(0) * extent(1);
    for t in ears {
        if net.turn(t[0], t[1], t[2]) > -flat {
            net.add(t);
        }
    }
    net.open_flat(flat);
    let mut edges: Vec<(usize, usize)> = Vec::new();
    for t in net.triangles.clone() {
        edges.extend([(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]);
    }
    net.settle(edges);
    for &point in inner {
        net.insert(point);
    }
    net.triangles
}

fn key(a: usize, b: usize) -> (usize, usize) {
    (a.min(b), a.max(b))
}

struct PlanarTriangulation<'p> {
    points: &'p [[f64; 2]],
    /// Edges that stay.
    rim: HashSet<(usize, usize)>,
    triangles: Vec<[usize; 3]>,
    /// The triangle on the left of each directed edge.
    sides: HashMap<(usize, usize), usize>,
}

impl PlanarTriangulation<'_> {
    /// Twice the area of a triangle.
    fn turn(&self, a: usize, b: usize, c: usize) -> f64 {
        let [a, b, c] = [a, b, c].map(|k| self.points[k]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }

    /// Positive when `d` lies in the circumcircle of the triangle a, b, c; and by how much rounding may
    /// change it.
    fn in_circle(&self, a: usize, b: usize, c: usize, d: usize) -> (f64, f64) {
        let o = self.points[d];
        let [a, b, c] = [a, b, c].map(|k| {
            let p = self.points[k];
            let (x, y) = (p[0] - o[0], p[1] - o[1]);
            [x, y, x * x + y * y]
        });
        let part = |p: [f64; 3], q: [f64; 3], r: [f64; 3]| (p[0] * q[1] - p[1] * q[0]) * r[2];
        let parts = [part(b, c, a), part(c, a, b), part(a, b, c)];
        let size = parts.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        (parts.iter().sum(), 32.0 * f64::EPSILON * size)
    }

    fn set(&mut self, at: usize, t: [usize; 3]) {
        self.triangles[at] = t;
        for k in 0..3 {
            self.sides.insert((t[k], t[(k + 1) % 3]), at);
        }
    }

    fn add(&mut self, t: [usize; 3]) -> usize {
        self.triangles.push(t);
        let at = self.triangles.len() - 1;
        self.set(at, t);
        at
    }

    /// The triangle on the left of an edge, and its third corner.
    fn left(&self, a: usize, b: usize) -> Option<(usize, usize)> {
        let at = *self.sides.get(&(a, b))?;
        let third = self.triangles[at].into_iter().find(|&c| c != a && c != b)?;
        Some((at, third))
    }

    /// Gives triangles with three corners in one line, which vertices of the rim in one line make, the third corner of
    /// the neighbour along their longest side; those without such a neighbour are left out.
    fn open_flat(&mut self, flat: f64) {
        let is_flat = |net: &Self, t: [usize; 3]| net.turn(t[0], t[1], t[2]) <= flat;
        loop {
            let mut flipped = false;
            for at in 0..self.triangles.len() {
                let t = self.triangles[at];
                if !is_flat(self, t) {
                    continue;
                }
                let length = |k: &usize| {
                    let [p, q] = [t[*k], t[(k + 1) % 3]].map(|v| self.points[v]);
                    (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2)
                };
                let Some(k) = (0..3).max_by(|i, j| length(i).total_cmp(&length(j))) else {
                    continue;
                };
                let (a, b, c) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
                let Some((other, d)) = self.left(b, a) else { continue };
                let new = [[c, a, d], [c, d, b]];
                if self.rim.contains(&key(a, b)) || new.iter().any(|n| is_flat(self, *n)) {
                    continue;
                }
                self.sides.remove(&(a, b));
                self.sides.remove(&(b, a));
                self.set(at, new[0]);
                self.set(other, new[1]);
                flipped = true;
            }
            if !flipped {
                break;
            }
        }
        let kept: Vec<[usize; 3]> =
            self.triangles.iter().copied().filter(|t| !is_flat(self, *t)).collect();
        if kept.len() < self.triangles.len() {
            self.triangles.clear();
            self.sides.clear();
            for t in kept {
                self.add(t);
            }
        }
    }

    /// Flips edges until each is Delaunay's.
    fn settle(&mut self, mut edges: Vec<(usize, usize)>) {
        // Each flip makes the smallest angles larger; the bound is for rounding only.
        let mut most = 64 * (self.triangles.len() + 16);
        while let Some((a, b)) = edges.pop() {
            if most == 0 || self.rim.contains(&key(a, b)) {
                continue;
            }
            let (Some((one, c)), Some((other, d))) = (self.left(a, b), self.left(b, a)) else {
                continue;
            };
            let (inside, rounding) = self.in_circle(a, b, c, d);
            if inside <= rounding || self.turn(c, a, d) <= 0.0 || self.turn(c, d, b) <= 0.0 {
                continue;
            }
            most -= 1;
            self.sides.remove(&(a, b));
            self.sides.remove(&(b, a));
            self.set(one, [c, a, d]);
            self.set(other, [c, d, b]);
            edges.extend([(a, d), (d, b), (b, c), (c, a)]);
        }
    }

    /// Puts a point in the triangle that it lies in.
    fn insert(&mut self, p: usize) {
        let inside =
            |net: &Self, t: &[usize; 3]| (0..3).all(|k| net.turn(t[k], t[(k + 1) % 3], p) >= 0.0);
        let Some(at) = (0..self.triangles.len()).find(|&k| inside(self, &self.triangles[k])) else {
            return;
        };
        let t = self.triangles[at];
        let size = self.turn(t[0], t[1], t[2]);
        // On an edge, the triangles of both sides are split.
        let on = (0..3).find(|&k| self.turn(t[k], t[(k + 1) % 3], p) <= ON_EDGE * size);
        if let Some(k) = on {
            let (a, b, c) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
            let Some((other, d)) = self.left(b, a) else { return };
            if self.rim.contains(&key(a, b)) {
                return;
            }
            self.sides.remove(&(a, b));
            self.sides.remove(&(b, a));
            self.set(at, [a, p, c]);
            self.add([p, b, c]);
            self.set(other, [b, p, d]);
            self.add([p, a, d]);
            self.settle(vec![(b, c), (c, a), (a, d), (d, b)]);
            return;
        }
        let [a, b, c] = t;
        self.set(at, [a, b, p]);
        self.add([b, c, p]);
        self.add([c, a, p]);
        self.settle(vec![(a, b), (b, c), (c, a)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plate_with_a_slot_and_points_inside() {
        // A plate with a slot whose mouth is between two stretches of one line, each of several vertices.
        let line = |a: [f64; 2], b: [f64; 2]| {
            (0..12).map(move |k| {
                let s = f64::from(k) / 12.0;
                [a[0] + (b[0] - a[0]) * s, a[1] + (b[1] - a[1]) * s]
            })
        };
        let mut state = 7u64;
        for round in 0..20 {
            // Rounding: each vertex its own.
            let mut noise = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                f64::from((state >> 62) as u32) * 0.5 * f64::EPSILON
            };
            let corners = [
                [0.5, 1.0],
                [0.0, 1.0],
                [0.0, 0.0],
                [1.0, 0.0],
                [1.0, 0.68],
                [0.72, 0.68],
                [0.72, 0.46],
                [0.5, 0.46],
                [0.5, 0.68],
                [0.055, 0.68],
                [0.055, 0.75],
                [0.5, 0.75],
            ];
            let scale = [4.1494, 2.6675];
            let mut points: Vec<[f64; 2]> = (0..12)
                .flat_map(|k| line(corners[k], corners[(k + 1) % 12]).collect::<Vec<_>>())
                .map(|[x, y]| [scale[0] * (x - noise()), scale[1] * (y - noise())])
                .collect();
            let loops = [(0..points.len()).collect::<Vec<usize>>()];
            let rim = points.len();
            if round % 2 == 1 {
                for (i, j) in (1..12).flat_map(|i| (1..12).map(move |j| (i, j))) {
                    let [x, y] = [f64::from(i) / 12.0, f64::from(j) / 12.0];
                    let cut = x > 0.03 && x < 0.53 && y > 0.66 && y < 0.77
                        || x > 0.47 && y > 0.64
                        || x > 0.47 && x < 0.75 && y > 0.43;
                    if !cut {
                        points.push([scale[0] * x, scale[1] * y]);
                    }
                }
            }
            let inner: Vec<usize> = (rim..points.len()).collect();
            let triangles = planar_triangles(&points, &loops, &inner);
            let mut sides: HashMap<(usize, usize), u32> = HashMap::new();
            for t in &triangles {
                for k in 0..3 {
                    *sides.entry(key(t[k], t[(k + 1) % 3])).or_default() += 1;
                }
            }
            let once = sides.values().filter(|n| **n == 1).count();
            assert_eq!(once, rim, "{round}");
            assert_eq!(triangles.len(), 2 * points.len() - rim - 2, "{round}");
        }
    }

    /// Where an ear is cut off, what is left may be vertices of one line, of which rounding says anything.
    #[test]
    fn rims_with_vertices_in_one_line_leave_no_slit() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        for round in 0..400 {
            let corners = [[random(), random()], [4.0 + random(), random()], [1.0 + random(), 3.0]];
            let points: Vec<[f64; 2]> = (0..3)
                .flat_map(|k| {
                    let ([a, b], [c, d]) = (corners[k], corners[(k + 1) % 3]);
                    let n = [11, 1, 1][k];
                    (0..n).map(move |i| {
                        let s = f64::from(i) / f64::from(n);
                        [a + (c - a) * s, b + (d - b) * s]
                    })
                })
                .collect();
            let rim: Vec<usize> = (0..points.len()).collect();
            let triangles = planar_triangles(&points, &[rim], &[]);
            assert_eq!(triangles.len(), points.len() - 2, "{round}");
            let mut sides: HashMap<(usize, usize), u32> = HashMap::new();
            for t in &triangles {
                for k in 0..3 {
                    *sides.entry(key(t[k], t[(k + 1) % 3])).or_default() += 1;
                }
            }
            assert_eq!(sides.values().filter(|n| **n == 1).count(), points.len(), "{round}");
        }
    }

    #[test]
    fn a_disc_with_a_hole_and_points_inside() {
        let ring = |n: usize, r: f64| {
            (0..n).map(move |k| {
                let angle = k as f64 * std::f64::consts::TAU / n as f64;
                [r * moldloft_num::Real::cos(angle), r * moldloft_num::Real::sin(angle)]
            })
        };
        let mut points: Vec<[f64; 2]> = ring(24, 2.0).chain(ring(12, 0.5)).collect();
        let loops = vec![(0..24).collect::<Vec<usize>>(), (24..36).rev().collect()];
        for (i, j) in (-6..=6).flat_map(|i| (-6..=6).map(move |j| (i, j))) {
            let p = [0.3 * f64::from(i), 0.3 * f64::from(j)];
            let r = p[0].hypot(p[1]);
            if r > 0.65 && r < 1.8 {
                points.push(p);
            }
        }
        let inner: Vec<usize> = (36..points.len()).collect();
        let triangles = planar_triangles(&points, &loops, &inner);
        // Euler's formula: 2 n - rim - 2 + 2 holes.
        assert_eq!(triangles.len(), 2 * points.len() - 36);
        let net = PlanarTriangulation {
            points: &points,
            rim: HashSet::new(),
            triangles: vec![],
            sides: HashMap::new(),
        };
        let areas: Vec<f64> = triangles.iter().map(|t| net.turn(t[0], t[1], t[2])).collect();
        assert!(areas.iter().all(|a| *a > 0.0));
        let polygon = |n: f64, r: f64| n * r * r * (std::f64::consts::TAU / n).sin();
        assert!(
            (areas.iter().sum::<f64>() - polygon(24.0, 2.0) + polygon(12.0, 0.5)).abs() < 1e-12
        );
        // No vertex in another's circle.
        for t in &triangles {
            for p in 0..points.len() {
                let (inside, rounding) = net.in_circle(t[0], t[1], t[2], p);
                assert!(t.contains(&p) || inside <= 1e3 * rounding.max(1e-13), "{t:?} {p}");
            }
        }
    }
}
