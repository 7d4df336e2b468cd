//! Sections of meshes by planes and other level surfaces, chained into polylines.

use crate::half_edge::{edges, half_edges};
use crate::{Mesh, is_triangle};
use moldloft_num::{Plane, Vec3, find_root};

/// The root of the chord is taken where the height there is at most this, relative to those at the
/// ends.
const FLAT_HEIGHT: f64 = 1e-12;

/// A run of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Polyline {
    /// The points in order; the first is not repeated at the end.
    pub points: Vec<Vec3>,
    /// True when the last point is joined to the first.
    pub closed: bool,
}

/// The cut of a mesh with a plane, as polylines in the order of their lowest face.
///
/// Each panel side is cut once, so lines pass through joined panels without gaps. A vertex in the
/// plane counts to its positive side; panels in the plane give nothing, but open edges in it do (so
/// the section of half a hull with its centre plane is its profile).
pub fn section(mesh: &Mesh, plane: &Plane<f64>) -> Vec<Polyline> {
    section_where(mesh, |p| plane.distance(p), |_| true)
}

/// As [`section`], with the surface on which `height` is zero, restricted by `holds`: a cylinder, a
/// half-plane. Each side of a panel is cut at most once, so two crossings of one side are missed.
pub fn section_where(
    mesh: &Mesh,
    height: impl Fn(Vec3) -> f64,
    holds: impl Fn(Vec3) -> bool,
) -> Vec<Polyline> {
    let distance: Vec<f64> = mesh.positions().iter().map(|&p| height(p)).collect();
    let d = |v: u32| distance[v as usize];
    let mut pieces: Vec<[SectionVertex; 2]> = Vec::new();
    for &face in mesh.faces() {
        let n = if is_triangle(face) { 3 } else { 4 };
        let side = |k: usize| (face[k % n], face[(k + 1) % n]);
        for k in 0..n {
            let (p, q) = side(k);
            if d(p) >= 0.0 || d(q) < 0.0 {
                continue;
            }
            // Entered the positive side here; it is left at the next side that leads back.
            let Some(m) = (k + 1..k + n).find(|&m| d(side(m).1) < 0.0) else { continue };
            let (from, to) = (
                SectionVertex::of(p, q, d(q)),
                SectionVertex::of(side(m).1, side(m).0, d(side(m).0)),
            );
            if from != to {
                pieces.push([from, to]);
            }
        }
    }
    let sides = half_edges(mesh.topology());
    for edge in edges(&sides).filter(|e| e.len() == 1) {
        let (p, q) = (edge[0].from, edge[0].to);
        let ahead = || mesh.faces()[edge[0].face()].iter().all(|&v| d(v) >= 0.0);
        let beyond = || mesh.faces()[edge[0].face()].iter().any(|&v| d(v) > 0.0);
        if d(p) == 0.0 && d(q) == 0.0 && ahead() && beyond() {
            pieces.push([SectionVertex::of(p, p, 0.0), SectionVertex::of(q, q, 0.0)]);
        }
    }
    let place = |node: SectionVertex| {
        let (p, q) = (mesh.positions()[node.low as usize], mesh.positions()[node.high as usize]);
        if node.low == node.high {
            return p;
        }
        let (a, b) = (d(node.low), d(node.high));
        let flat = p.lerp(q, a / (a - b));
        // If the height is not linear along the side, its root.
        if height(flat).abs() <= FLAT_HEIGHT * (a.abs() + b.abs()) {
            return flat;
        }
        find_root(|t| height(p.lerp(q, t)), 0.0, 1.0).map_or(flat, |t| p.lerp(q, t))
    };
    pieces.retain(|piece| piece.iter().all(|&node| holds(place(node))));
    chained(&pieces)
        .into_iter()
        .map(|(nodes, closed)| Polyline { points: nodes.into_iter().map(place).collect(), closed })
        .collect()
}

/// Intersection of the plane with a panel side: between two vertices, or at one (twice the same).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct SectionVertex {
    low: u32,
    high: u32,
}

impl SectionVertex {
    /// The crossing between `behind` and `ahead`, which is at `distance` in front of the plane.
    fn of(behind: u32, ahead: u32, distance: f64) -> Self {
        if distance == 0.0 {
            return Self { low: ahead, high: ahead };
        }
        Self { low: behind.min(ahead), high: behind.max(ahead) }
    }
}

/// Joins pieces end to end; each piece is used once.
fn chained(pieces: &[[SectionVertex; 2]]) -> Vec<(Vec<SectionVertex>, bool)> {
    let mut at: Vec<(SectionVertex, usize)> = Vec::with_capacity(2 * pieces.len());
    for (k, piece) in pieces.iter().enumerate() {
        at.extend(piece.map(|node| (node, k)));
    }
    at.sort_unstable();
    let run = |node: SectionVertex| {
        let first = at.partition_point(|a| a.0 < node);
        at[first..].iter().take_while(move |a| a.0 == node).map(|a| a.1)
    };
    let mut used = vec![false; pieces.len()];
    let mut lines = Vec::new();
    // Lines with ends first, from their ends; then the rings.
    let ends = (0..pieces.len()).flat_map(|k| [(k, 0), (k, 1)]);
    let open_starts = ends.filter(|&(k, e)| run(pieces[k][e]).count() % 2 == 1);
    for (k, end) in open_starts.chain((0..pieces.len()).map(|k| (k, 0))) {
        if used[k] {
            continue;
        }
        used[k] = true;
        let mut nodes = vec![pieces[k][end], pieces[k][1 - end]];
        let mut closed = false;
        while let Some(next) = run(nodes[nodes.len() - 1]).find(|&k| !used[k]) {
            used[next] = true;
            let [a, b] = pieces[next];
            let other = if a == nodes[nodes.len() - 1] { b } else { a };
            if other == nodes[0] {
                closed = true;
                break;
            }
            nodes.push(other);
        }
        lines.push((nodes, closed));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixtures::{grid, open_half_box, sphere};

    fn plane(point: [f64; 3], normal: [f64; 3]) -> Plane<f64> {
        Plane::new(point.into(), normal.into()).unwrap()
    }

    #[test]
    fn a_sphere_is_cut_in_one_ring() {
        let ball = sphere(24, 2.0, Vec3::zero());
        for (c, n) in [([0.1, 0.0, 0.0], [1.0, 0.0, 0.0]), ([0.0; 3], [0.3, -0.4, 0.7])] {
            let lines = section(&ball, &plane(c, n));
            let [ring] = lines.as_slice() else { panic!("one ring, not {}", lines.len()) };
            assert!(ring.closed && ring.points.len() > 40);
            for p in &ring.points {
                assert!(plane(c, n).distance(*p).abs() < 1e-14 && p.norm() > 1.96);
            }
        }
    }

    #[test]
    fn through_rows_of_vertices() {
        // The equator and a meridian are rows of vertices: no doubled points, no gaps.
        let ball = sphere(8, 1.0, Vec3::zero());
        let equator = section(&ball, &plane([0.0; 3], [0.0, 0.0, 1.0]));
        assert_eq!((equator.len(), equator[0].closed), (1, true));
        assert!(equator[0].points.len() <= 32);
        assert!(section(&ball, &plane([0.0, 0.0, 2.0], [0.0, 0.0, 1.0])).is_empty());
    }

    #[test]
    fn the_centre_plane_of_a_half_is_its_profile() {
        let half = open_half_box();
        for sign in [1.0, -1.0] {
            let profile = section(&half, &plane([0.0; 3], [0.0, sign, 0.0]));
            assert_eq!((profile.len(), profile[0].points.len(), profile[0].closed), (1, 4, true));
        }
        let frame = section(&half, &plane([1.0, 0.0, 0.0], [1.0, 0.0, 0.0]));
        assert_eq!((frame.len(), frame[0].points.len(), frame[0].closed), (1, 4, false));
    }

    #[test]
    fn a_cylinder_and_a_half_plane_cut_too() {
        let ball = sphere(48, 2.0, Vec3::zero());
        let radius = |p: Vec3| (p.x * p.x + p.y * p.y).sqrt();
        let rings = section_where(&ball, |p| radius(p) - 1.0, |_| true);
        assert_eq!((rings.len(), rings[0].closed, rings[1].closed), (2, true, true));
        for p in rings.iter().flat_map(|r| &r.points) {
            assert!((radius(*p) - 1.0).abs() < 1e-12 && (p.z.abs() - 3f64.sqrt()).abs() < 0.01);
        }
        let half = section_where(&ball, |p| p.y - 0.1 * p.x, |p| p.x > 0.0);
        assert_eq!((half.len(), half[0].closed), (1, false));
        assert!(half[0].points.iter().all(|p| p.x > 0.0));
    }

    #[test]
    fn a_sheet_gives_open_lines() {
        let sheet = grid(9, 9, |u, v| Vec3::of(u, v, (u - 0.5) * (v - 0.5)));
        let lines = section(&sheet, &plane([0.0, 0.0, 0.1], [0.0, 0.0, 1.0]));
        assert_eq!(lines.iter().filter(|l| !l.closed).count(), 2);
    }
}
