//! Triangles of a region of the plane with points inside it: Delaunay's, as far as the rim allows.

use spade::handles::{FixedFaceHandle, InnerTag};
use spade::{
    ConstrainedDelaunayTriangulation, HasPosition, Point2, PositionInTriangulation, Triangulation,
};
use std::collections::HashMap;

/// A vertex and its number.
struct PlanarVertex {
    at: [f64; 2],
    number: usize,
}

impl HasPosition for PlanarVertex {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        // The triangulation takes no numbers below 1e-42.
        let [x, y] = self.at.map(|x| if x.abs() < spade::MIN_ALLOWED_VALUE { 0.0 } else { x });
        Point2::new(x, y)
    }
}

/// Triangles, counter-clockwise, of the region between `loops` (the first counter-clockwise around
/// the others, which are clockwise), with the points `inner` inside it as vertices. Every edge of
/// the loops is an edge of a triangle; no vertex is in the circumcircle of a triangle unless an
/// edge of a loop is between them (Chew 1989). A point of `inner` on an edge of a loop or outside
/// the region is left out. The result is empty if edges of the loops cross or a coordinate is not
/// finite.
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
    planar_triangles_along(points, loops, &[], inner)
}

/// As [`planar_triangles`], with `lines` inside the region as edges of triangles; empty, too, if one of them crosses another
/// one or an edge of a loop.
pub fn planar_triangles_along(
    points: &[[f64; 2]],
    loops: &[Vec<usize>],
    lines: &[[usize; 2]],
    inner: &[usize],
) -> Vec<[usize; 3]> {
    // Coincident vertices are one.
    let mut placed: HashMap<[u64; 2], usize> = HashMap::new();
    let mut corners: Vec<PlanarVertex> = Vec::new();
    let mut corner_of = |number: usize| {
        let at = points[number];
        *placed.entry(at.map(|x| (x + 0.0).to_bits())).or_insert_with(|| {
            corners.push(PlanarVertex { at, number });
            corners.len() - 1
        })
    };
    // An edge used by loops an even number of times separates nothing.
    let mut uses: HashMap<(usize, usize), u32> = HashMap::new();
    let mut edges = Vec::new();
    for l in loops {
        for k in 0..l.len() {
            let (a, b) = (corner_of(l[k]), corner_of(l[(k + 1) % l.len()]));
            if a == b {
                continue;
            }
            let count = uses.entry((a.min(b), a.max(b))).or_default();
            *count += 1;
            if *count == 1 {
                edges.push([a, b]);
            }
        }
    }
    edges.extend(lines.iter().map(|line| line.map(&mut corner_of)).filter(|[a, b]| a != b));
    let mut crossed = false;
    let made =
        ConstrainedDelaunayTriangulation::<PlanarVertex>::try_bulk_load_cdt(corners, edges, |_| {
            crossed = true
        });
    let Ok(mut net) = made else { return Vec::new() };
    if crossed {
        return Vec::new();
    }
    for &number in inner {
        let corner = PlanarVertex { at: points[number], number };
        let free = match net.locate(corner.position()) {
            PositionInTriangulation::OnFace(_) => true,
            PositionInTriangulation::OnEdge(e) => !net.is_constraint_edge(e.as_undirected()),
            _ => false,
        };
        if free && net.insert(corner).is_err() {
            return Vec::new();
        }
    }
    within(&net, &uses)
}

/// The triangles that an odd number of loop edges part from the outside.
fn within(
    net: &ConstrainedDelaunayTriangulation<PlanarVertex>,
    uses: &HashMap<(usize, usize), u32>,
) -> Vec<[usize; 3]> {
    let mut inside: Vec<Option<bool>> = vec![None; net.num_inner_faces() + 1];
    let mut reached: Vec<(FixedFaceHandle<InnerTag>, bool)> = Vec::new();
    let parts = |a: usize, b: usize| uses.get(&(a.min(b), a.max(b))).is_some_and(|n| n % 2 == 1);
    for edge in net.convex_hull() {
        // Hull edges have the outside on their left.
        let edge = edge.rev();
        if let Some(face) = edge.face().as_inner() {
            let [a, b] = edge.vertices().map(|v| v.index());
            reached.push((face.fix(), parts(a, b)));
        }
    }
    while let Some((face, state)) = reached.pop() {
        if inside[face.index()].is_some() {
            continue;
        }
        inside[face.index()] = Some(state);
        for edge in net.face(face).adjacent_edges() {
            if let Some(other) = edge.rev().face().as_inner() {
                let [a, b] = edge.vertices().map(|v| v.index());
                reached.push((other.fix(), state != parts(a, b)));
            }
        }
    }
    let kept = net.inner_faces().filter(|f| inside[f.fix().index()] == Some(true));
    kept.map(|f| f.vertices().map(|v| v.data().number)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(a: usize, b: usize) -> (usize, usize) {
        (a.min(b), a.max(b))
    }

    /// Twice the area of a triangle.
    fn turn(points: &[[f64; 2]], [a, b, c]: [usize; 3]) -> f64 {
        let [a, b, c] = [a, b, c].map(|k| points[k]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }

    /// Positive if `d` is in the circumcircle of a triangle; and a bound of the rounding error.
    fn in_circle(points: &[[f64; 2]], corners: [usize; 3], d: usize) -> (f64, f64) {
        let o = points[d];
        let [a, b, c] = corners.map(|k| {
            let (x, y) = (points[k][0] - o[0], points[k][1] - o[1]);
            [x, y, x * x + y * y]
        });
        let part = |p: [f64; 3], q: [f64; 3], r: [f64; 3]| (p[0] * q[1] - p[1] * q[0]) * r[2];
        let parts = [part(b, c, a), part(c, a, b), part(a, b, c)];
        let size = parts.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        (parts.iter().sum(), 32.0 * f64::EPSILON * size)
    }

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

    /// When an ear is cut off, the remaining vertices may be on one line, with orientations by
    /// rounding.
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
        let areas: Vec<f64> = triangles.iter().map(|t| turn(&points, *t)).collect();
        assert!(areas.iter().all(|a| *a > 0.0));
        let polygon = |n: f64, r: f64| n * r * r * (std::f64::consts::TAU / n).sin();
        assert!(
            (areas.iter().sum::<f64>() - polygon(24.0, 2.0) + polygon(12.0, 0.5)).abs() < 1e-12
        );
        // No vertex in another's circle.
        for t in &triangles {
            for p in 0..points.len() {
                let (inside, rounding) = in_circle(&points, *t, p);
                assert!(t.contains(&p) || inside <= 1e3 * rounding.max(1e-13), "{t:?} {p}");
            }
        }
    }
}
