//! Report of a mesh from the sides of its faces: closed or open with positions, manifold, oriented,
//! outward.

use crate::half_edge::{HalfEdge, edges, half_edges};
use crate::sum::chunked_sum;
use crate::{Mesh, Topology};
use moldloft_num::union_find::UnionFind;
use moldloft_num::{Box3, Real, Vec3};

/// Result of matching the sides of all faces by vertex index.
///
/// Joins are by identity: two patches that only touch in space are open along the seam.
/// Intersections of faces are not tested.
#[derive(Clone, Debug, PartialEq)]
pub struct TopologyReport {
    /// Vertices that some face uses.
    pub vertices: usize,
    /// Edges.
    pub edges: usize,
    /// Faces.
    pub faces: usize,
    /// Every edge belongs to two or more faces (and there is a face).
    pub closed: bool,
    /// No edge has more than two faces, and the faces around each vertex form one fan.
    pub manifold: bool,
    /// True when any two faces at an edge traverse it in opposite directions.
    pub oriented: bool,
    /// For a closed, manifold, oriented mesh: true if it encloses a positive volume, so that its
    /// normals point outward. `None` for other meshes.
    pub outward: Option<bool>,
    /// Parts not joined by edges.
    pub components: usize,
    /// Parts that enclose a negative volume, when `outward` is known: cavities, or bodies turned
    /// inside out.
    pub negative_components: usize,
    /// Vertices - edges + faces; 2 for a sphere, 0 for a torus, 1 for a disc.
    pub euler: i64,
    /// Edges with more than two faces.
    pub branching_edges: usize,
    /// Edges that both faces traverse in the same direction.
    pub misoriented_edges: usize,
    /// Vertices whose faces form several fans.
    pub pinched_vertices: usize,
    /// Open loops of the mesh: the edges of one face only, chained, in the order of their lowest
    /// face.
    pub open_loops: Vec<OpenLoop>,
}

/// A chain of open edges.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenLoop {
    /// The vertices in order; the first is not repeated at the end.
    pub vertices: Vec<u32>,
    /// True when the chain returns to its first vertex.
    pub closed: bool,
    /// Indices of the patches it borders, with the number of edges of each, ascending.
    pub patches: Vec<(usize, usize)>,
    /// Its length in the model's unit.
    pub length: f64,
    /// Box around it.
    pub bounds: Box3,
}

impl OpenLoop {
    /// Number of its edges.
    pub fn edge_count(&self) -> usize {
        self.patches.iter().map(|p| p.1).sum()
    }
}

impl<T: Real> Mesh<T> {
    /// Checks the topology, in time proportional to its size (vertices of bounded valence).
    pub fn report(&self) -> TopologyReport {
        report(self)
    }
}

fn report<T: Real>(mesh: &Mesh<T>) -> TopologyReport {
    let topology = mesh.topology();
    let faces = topology.faces();
    let sorted = half_edges(topology);

    let mut parts = UnionFind::new(faces.len());
    let mut fans = UnionFind::new(4 * faces.len());
    let (mut edge_count, mut branching_edges, mut misoriented_edges) = (0, 0, 0);
    let mut open = Vec::new();
    for edge in edges(&sorted) {
        edge_count += 1;
        for side in &edge[1..] {
            parts.join(edge[0].face() as u32, side.face() as u32);
        }
        match edge {
            [side] => open.push(*side),
            [a, b] => {
                let (a_to, b_to) = (a.next_corner(faces), b.next_corner(faces));
                if a.from == b.from {
                    misoriented_edges += 1;
                    fans.join(a.corner, b.corner);
                    fans.join(a_to, b_to);
                } else {
                    fans.join(a.corner, b_to);
                    fans.join(a_to, b.corner);
                }
            }
            _ => branching_edges += 1,
        }
    }
    open.sort_unstable_by_key(|e| e.corner);

    let (vertices, pinched_vertices) = count_fans(topology, &mut fans);
    let components = (0..faces.len() as u32).filter(|&f| parts.find(f) == f).count();
    let closed = open.is_empty() && !faces.is_empty();
    let manifold = branching_edges == 0 && pinched_vertices == 0;
    let oriented = misoriented_edges == 0 && branching_edges == 0;
    let (outward, negative_components) = if closed && manifold && oriented {
        let volumes = part_volumes(mesh, &mut parts);
        let total: f64 = volumes.iter().sum();
        (Some(total > 0.0), volumes.iter().filter(|&&v| v < 0.0).count())
    } else {
        (None, 0)
    };

    TopologyReport {
        vertices,
        edges: edge_count,
        faces: faces.len(),
        closed,
        manifold,
        oriented,
        outward,
        components,
        negative_components,
        euler: vertices as i64 - edge_count as i64 + faces.len() as i64,
        branching_edges,
        misoriented_edges,
        pinched_vertices,
        open_loops: chain(mesh, open),
    }
}

/// Counts used vertices, and those of them whose corners belong to more than one fan.
fn count_fans(topology: &Topology, fans: &mut UnionFind) -> (usize, usize) {
    const UNSEEN: u32 = u32::MAX;
    const PINCHED: u32 = u32::MAX - 1;
    let mut fan_of = vec![UNSEEN; topology.vertex_count()];
    for (f, &face) in topology.faces().iter().enumerate() {
        let corners = if crate::is_triangle(face) { 3 } else { 4 };
        for k in 0..corners {
            let root = fans.find((4 * f + k) as u32);
            let fan = &mut fan_of[face[k] as usize];
            if *fan == UNSEEN {
                *fan = root;
            } else if *fan != root {
                *fan = PINCHED;
            }
        }
    }
    let used = fan_of.iter().filter(|&&f| f != UNSEEN).count();
    (used, fan_of.iter().filter(|&&f| f == PINCHED).count())
}

/// The volume each part encloses, measured about the centre of the mesh, by lowest face.
fn part_volumes<T: Real>(mesh: &Mesh<T>, parts: &mut UnionFind) -> Vec<f64> {
    let origin = mesh.bounds().centre();
    let positions: Vec<Vec3> = mesh.positions().iter().map(|p| p.re() - origin).collect();
    let mut volumes = vec![0.0; mesh.faces().len()];
    for (f, &face) in mesh.faces().iter().enumerate() {
        volumes[parts.find(f as u32) as usize] += crate::Panel::of(face, &positions).cone_volume();
    }
    (0..volumes.len() as u32).filter(|&f| parts.find(f) == f).map(|f| volumes[f as usize]).collect()
}

/// Chains open edges, following each face's direction where possible.
fn chain<T: Real>(mesh: &Mesh<T>, open: Vec<HalfEdge>) -> Vec<OpenLoop> {
    // The open edges at each vertex, those that leave it first: a neighbour of the wrong
    // orientation has none.
    let mut at: Vec<(u32, bool, usize)> = Vec::with_capacity(2 * open.len());
    for (k, e) in open.iter().enumerate() {
        at.extend([(e.from, false, k), (e.to, true, k)]);
    }
    at.sort_unstable();
    let mut used = vec![false; open.len()];
    // Number of used leading entries of each vertex's group, stored at its first entry; it makes
    // the search linear over all calls.
    let mut spent = vec![0usize; at.len()];
    let mut next = |used: &[bool], vertex: u32| {
        let first = at.partition_point(|&(v, ..)| v < vertex);
        while let Some(&(v, _, k)) = at.get(first + spent[first]) {
            if v != vertex {
                break;
            }
            if !used[k] {
                return Some(k);
            }
            spent[first] += 1;
        }
        None
    };
    let mut loops = Vec::new();
    for start in 0..open.len() {
        if used[start] {
            continue;
        }
        used[start] = true;
        let mut members = vec![start];
        let mut vertices = std::collections::VecDeque::from([open[start].from, open[start].to]);
        let mut closed = false;
        while let Some(k) = next(&used, *vertices.back().unwrap_or(&0)) {
            let end = *vertices.back().unwrap_or(&0);
            let other = if open[k].from == end { open[k].to } else { open[k].from };
            used[k] = true;
            members.push(k);
            if other == vertices[0] {
                closed = true;
                break;
            }
            vertices.push_back(other);
        }
        while let (false, Some(k)) = (closed, next(&used, vertices[0])) {
            let other = if open[k].to == vertices[0] { open[k].from } else { open[k].to };
            used[k] = true;
            members.push(k);
            vertices.push_front(other);
        }
        loops.push(described(mesh, &open, &members, vertices.into(), closed));
    }
    loops
}

fn described<T: Real>(
    mesh: &Mesh<T>,
    open: &[HalfEdge],
    members: &[usize],
    vertices: Vec<u32>,
    closed: bool,
) -> OpenLoop {
    let position = |v: u32| mesh.positions()[v as usize].re();
    let mut owners: Vec<usize> =
        members.iter().map(|&k| mesh.topology().patch_of(open[k].face())).collect();
    owners.sort_unstable();
    let patches = owners.chunk_by(|a, b| a == b).map(|run| (run[0], run.len())).collect();
    let length = chunked_sum(
        0..members.len(),
        || 0.0,
        |sum, k| {
            let e = open[members[k]];
            *sum += position(e.from).distance(position(e.to));
        },
        |sum, part| *sum += part,
    );
    let bounds = Box3::around(vertices.iter().map(|&v| position(v)));
    OpenLoop { vertices, closed, patches, length, bounds }
}

/// Small meshes that the tests of this crate share.
#[cfg(test)]
pub(crate) mod fixtures {
    use super::*;
    use crate::{PatchInfo, TopologyBuilder};

    /// The box 0..2 x 0..1 x 0..3 without its side y = 0; patches bottom, top, side, aft, fore.
    pub fn open_half_box() -> Mesh {
        let mut b = TopologyBuilder::new();
        b.add_vertices(8).unwrap();
        // Vertex bits: x, y, z.
        for (name, face) in [
            ("bottom", [0, 2, 3, 1]),
            ("top", [4, 5, 7, 6]),
            ("side", [2, 6, 7, 3]),
            ("aft", [0, 4, 6, 2]),
            ("fore", [1, 3, 7, 5]),
        ] {
            b.add_faces(PatchInfo::new(name), [face]).unwrap();
        }
        let corner = |k: u32| {
            let bit = |n: u32| f64::from((k >> n) & 1);
            Vec3::of(2.0 * bit(0), bit(1), 3.0 * bit(2))
        };
        Mesh::new(b.build().into(), (0..8).map(corner).collect()).unwrap()
    }

    /// A surface over the parameter square, (nu - 1) x (nv - 1) panels, every vertex its own, but
    /// for the rows that `same` calls equal.
    pub fn grid<T: Real>(nu: usize, nv: usize, at: impl Fn(f64, f64) -> Vec3<T>) -> Mesh<T> {
        let mut b = TopologyBuilder::new();
        b.add_vertices(nu * nv).unwrap();
        b.add_block(PatchInfo::new("grid"), nu, nv, (0..(nu * nv) as u32).collect(), false)
            .unwrap();
        let part = |k: usize, n: usize| k as f64 / (n - 1) as f64;
        let positions =
            (0..nu * nv).map(|k| at(part(k / nv, nu), part(k % nv, nv))).collect::<Vec<_>>();
        Mesh::new(b.build().into(), positions).unwrap()
    }

    /// A sphere of radius `r` about `c`, `n` panels from pole to pole and `2 n` around, closed by
    /// identity.
    pub fn sphere<T: Real>(n: usize, r: T, c: Vec3<T>) -> Mesh<T> {
        let (nu, nv) = (2 * n + 1, n + 1);
        let id = |i: usize, j: usize| match j {
            0 => 0,
            j if j == n => 1,
            _ => (2 + (i % (2 * n)) * (n - 1) + j - 1) as u32,
        };
        let mut b = TopologyBuilder::new();
        let count = 2 + 2 * n * (n - 1);
        b.add_vertices(count).unwrap();
        let ids = (0..nu * nv).map(|k| id(k / nv, k % nv)).collect();
        b.add_block(PatchInfo::new("sphere"), nu, nv, ids, false).unwrap();
        let mut positions = vec![Vec3::zero(); count];
        for k in 0..nu * nv {
            let (i, j) = (k / nv % (2 * n), k % nv);
            let (phi, theta) = (
                std::f64::consts::PI * i as f64 / n as f64,
                std::f64::consts::PI * j as f64 / n as f64,
            );
            let d = Vec3::of(theta.sin() * phi.cos(), theta.sin() * phi.sin(), -theta.cos());
            positions[id(i, j) as usize] = c + d * r;
        }
        Mesh::new(b.build().into(), positions).unwrap()
    }
}

#[cfg(test)]
mod tests {
    use super::fixtures::*;
    use super::*;
    use crate::{PatchInfo, TopologyBuilder};

    fn of_faces(count: usize, faces: &[[u32; 4]]) -> TopologyReport {
        let mut b = TopologyBuilder::new();
        b.add_vertices(count).unwrap();
        b.add_faces(PatchInfo::new("a"), faces.iter().copied()).unwrap();
        let corner = |k: usize| Vec3::of((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2) as f64);
        Mesh::<f64>::new(b.build().into(), (0..count).map(corner).collect()).unwrap().report()
    }

    #[test]
    fn a_sphere_is_closed_and_outward() {
        let mut r = sphere(8, 1.0, Vec3::of(9.0, 0.0, 0.0)).report();
        assert!(r.closed && r.manifold && r.oriented && r.open_loops.is_empty());
        assert_eq!((r.outward, r.euler, r.components), (Some(true), 2, 1));
        r = sphere(8, -1.0, Vec3::zero()).report();
        assert_eq!((r.outward, r.negative_components), (Some(false), 1));
    }

    #[test]
    fn an_open_box_names_its_edge() {
        let r = open_half_box().report();
        assert!(!r.closed && r.manifold && r.oriented && r.outward.is_none());
        let [open] = r.open_loops.as_slice() else { panic!("one loop") };
        assert!(open.closed && open.vertices.len() == 4);
        assert_eq!(open.patches, [(0, 1), (1, 1), (3, 1), (4, 1)]);
        assert_eq!((open.length, open.edge_count()), (10.0, 4));
        assert_eq!(open.bounds.high, Vec3::of(2.0, 0.0, 3.0));
        assert_eq!(r.euler, 1);
    }

    #[test]
    fn small_and_strange_meshes() {
        let none = of_faces(0, &[]);
        assert!(!none.closed && none.manifold && none.components == 0 && none.euler == 0);
        let one = of_faces(3, &[[0, 1, 2, 2]]);
        assert_eq!((one.open_loops[0].vertices.clone(), one.euler), (vec![0, 1, 2], 1));
        // Two triangles on one edge, the second with the wrong orientation.
        let turned = of_faces(4, &[[0, 1, 2, 2], [0, 1, 3, 3]]);
        assert!(!turned.oriented && turned.manifold && turned.misoriented_edges == 1);
        assert!(turned.open_loops.len() == 1 && turned.open_loops[0].edge_count() == 4);
        // Three faces on one edge.
        let branch = of_faces(5, &[[0, 1, 2, 2], [1, 0, 3, 3], [0, 1, 4, 4]]);
        assert!(!branch.manifold && branch.branching_edges == 1 && branch.components == 1);
        // Two triangles that touch in a vertex.
        let pinch = of_faces(5, &[[0, 1, 2, 2], [2, 3, 4, 4]]);
        assert!(!pinch.manifold && pinch.pinched_vertices == 1 && pinch.components == 2);
    }

    #[test]
    fn a_million_panels() {
        let r = grid(1001, 1001, |u, v| Vec3::<f64>::of(u, v, 0.0)).report();
        assert_eq!((r.faces, r.components, r.euler), (1_000_000, 1, 1));
        assert_eq!(r.open_loops.len(), 1);
        assert_eq!(r.open_loops[0].vertices.len(), 4000);
    }
}
