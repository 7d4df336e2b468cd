//! Bodies that chamfers and fillets take away or add: the section beside an edge, moved along it or turned
//! about an axis, and the corner round the ball where three fillets meet.

use super::curve::SmoothPiece;
use super::facet_source::newell;
use super::meshing::by_angle;
use super::surface::FaceSurface;
use super::{CombinedMesh, SketchSolid, SolidEdge, SolidFace, Trim, Vertex};
use crate::PointId;
use moldloft_num::{Axis as Line, Real, Vec3};
use std::sync::Arc;

/// A position along an edge, as the map that moves the section there.
#[derive(Clone, Copy, Debug)]
pub(super) enum SectionPlacing<T> {
    /// Moved along a direction into a plane.
    Plane { along: Vec3<T>, at: Vec3<T>, normal: Vec3<T> },
    /// Turned about an axis.
    Turned { axis: Line<T>, angle: T },
}

impl<T: Real> SectionPlacing<T> {
    pub fn point(&self, p: Vec3<T>) -> Vec3<T> {
        match *self {
            SectionPlacing::Plane { along, at, normal } => {
                p + along * (normal.dot(at - p) / normal.dot(along))
            }
            SectionPlacing::Turned { axis, angle } => axis.rotated(p, angle),
        }
    }

    fn piece(&self, piece: &SmoothPiece<T>) -> SmoothPiece<T> {
        match *piece {
            SmoothPiece::Conic { centre, a, b, sweep } => {
                let c = self.point(centre);
                let [a, b] = [a, b].map(|d| self.point(centre + d) - c);
                SmoothPiece::Conic { centre: c, a, b, sweep }
            }
            SmoothPiece::Cubic(points) => SmoothPiece::Cubic(points.map(|p| self.point(p))),
        }
    }
}

/// The section of a tool: the edge's point, a point in each face, and the curve from one to the other.
#[derive(Clone, Debug)]
pub(super) struct BlendSection<T> {
    pub corners: [Vec3<T>; 3],
    /// Curve from the second corner to the third; straight if `None`.
    pub round: Option<SmoothPiece<T>>,
    /// Names of the faces that its sides make.
    pub names: [Vec<Arc<str>>; 3],
}

/// Vertices, points, edges and faces as they are made.
struct ToolParts<T> {
    solid: SketchSolid<T>,
    mesh: CombinedMesh<T>,
}

impl<T: Real> ToolParts<T> {
    fn new(vertices: Vec<Vec3<T>>) -> Self {
        let vertex = |(k, at): (usize, &Vec3<T>)| Vertex { id: PointId(k as u32 + 1), at: *at };
        let solid = SketchSolid {
            vertices: vertices.iter().enumerate().map(vertex).collect(),
            ..SketchSolid::default()
        };
        let mesh = CombinedMesh { points: vertices, ..CombinedMesh::default() };
        ToolParts { solid, mesh }
    }

    fn point(&mut self, at: Vec3<T>) -> u32 {
        self.mesh.points.push(at);
        self.mesh.points.len() as u32 - 1
    }

    fn edge(&mut self, chain: Vec<u32>, piece: Option<SmoothPiece<T>>) -> usize {
        let ends = [chain[0], chain[chain.len() - 1]].map(|v| v as usize);
        self.solid.edges.push(SolidEdge { ends, piece, ..SolidEdge::default() });
        self.mesh.chains.push(chain);
        self.solid.edges.len() - 1
    }

    fn face(
        &mut self,
        cycle: Vec<(usize, bool)>,
        surface: Option<FaceSurface<T>>,
        names: &[Arc<str>],
        triangles: Vec<[u32; 3]>,
    ) {
        let face = self.solid.faces.len();
        let trim = surface.map(|surface| {
            self.solid.trims.push(Trim { surface, face });
            self.solid.trims.len() - 1
        });
        let (loops, names) = (vec![cycle], names.to_vec());
        self.solid.faces.push(SolidFace { id: None, ruled: false, loops, trim, names });
        self.mesh.faces.push(triangles);
    }

    fn finish(mut self) -> SketchSolid<T> {
        self.solid.facets = Some(self.mesh);
        if self.solid.mass().volume.re() < 0.0 {
            self.solid.turn_over();
        }
        self.solid
    }
}

/// The body that a section sweeps through stations, each with whether its points are vertices; the
/// first is, and for an open sweep the last. A closed one continues from the last to the first.
pub(super) fn swept<T: Real>(
    section: &BlendSection<T>,
    stations: &[(SectionPlacing<T>, bool)],
    closed: bool,
) -> SketchSolid<T> {
    let n = section.round.as_ref().map_or(1, by_angle);
    let [corner, first, second] = section.corners;
    let mut ring = vec![corner, first];
    if let Some(piece) = &section.round {
        ring.extend((1..n).map(|k| piece.at(T::from(k as f64 / n as f64))));
    }
    ring.push(second);
    // The indices of the corners in the ring.
    let places = [0, 1, n + 1];
    let own: Vec<usize> = (0..stations.len()).filter(|&k| stations[k].1).collect();
    let vertices = own.iter().flat_map(|&k| section.corners.map(|c| stations[k].0.point(c)));
    let mut parts = ToolParts::new(vertices.collect());
    let mut number = vec![vec![0u32; ring.len()]; stations.len()];
    for (k, (station, vertex)) in stations.iter().enumerate() {
        for (r, &p) in ring.iter().enumerate() {
            let known = places.iter().position(|x| *x == r).filter(|_| *vertex);
            number[k][r] = match known {
                Some(c) => (3 * own.iter().position(|x| *x == k).unwrap_or(0) + c) as u32,
                None => parts.point(station.point(p)),
            };
        }
    }
    let across: Vec<[usize; 3]> = (own.iter())
        .map(|&k| {
            [0, 1, 2].map(|s| {
                let round = section.round.as_ref().filter(|_| s == 1);
                let chain = match s {
                    0 => number[k][0..=1].to_vec(),
                    1 => number[k][1..=n + 1].to_vec(),
                    _ => vec![number[k][n + 1], number[k][0]],
                };
                parts.edge(chain, round.map(|piece| stations[k].0.piece(piece)))
            })
        })
        .collect();
    let intervals = if closed { own.len() } else { own.len() - 1 };
    for i in 0..intervals {
        let (from, next) = (own[i], (i + 1) % own.len());
        let to = if next > i { own[next] } else { stations.len() };
        let way: Vec<usize> = (from..=to).map(|k| k % stations.len()).collect();
        let turn = match (stations[from].0, stations[own[next]].0) {
            (SectionPlacing::Turned { axis, angle }, SectionPlacing::Turned { angle: end, .. }) => {
                let full = T::from(if next > i { 0.0 } else { 2.0 * std::f64::consts::PI });
                Some((axis, angle, end - angle + full))
            }
            _ => None,
        };
        let along = places.map(|r| {
            let chain: Vec<u32> = way.iter().map(|&k| number[k][r]).collect();
            let piece = turn.map(|(axis, _, sweep)| {
                let p = parts.mesh.points[chain[0] as usize];
                let centre = axis.foot(p);
                let a = p - centre;
                SmoothPiece::Conic { centre, a, b: axis.direction.cross(a), sweep }
            });
            parts.edge(chain, piece)
        });
        for s in 0..3 {
            let (c, d) = (s, (s + 1) % 3);
            let cycle = vec![
                (across[i][s], true),
                (along[d], true),
                (across[next][s], false),
                (along[c], false),
            ];
            let run = |k: usize| -> Vec<u32> {
                match s {
                    0 => number[k][0..=1].to_vec(),
                    1 => number[k][1..=n + 1].to_vec(),
                    _ => vec![number[k][n + 1], number[k][0]],
                }
            };
            let mut triangles = Vec::new();
            for w in way.windows(2) {
                let (here, there) = (run(w[0]), run(w[1]));
                for r in 0..here.len() - 1 {
                    triangles.push([here[r], here[r + 1], there[r + 1]]);
                    triangles.push([here[r], there[r + 1], there[r]]);
                }
            }
            let profile = || {
                let straight = SmoothPiece::straight(section.corners[c], section.corners[d]);
                let piece = section.round.filter(|_| s == 1).unwrap_or(straight);
                stations[from].0.piece(&piece)
            };
            let surface = match turn {
                Some((axis, _, sweep)) => {
                    let way = (section.corners[d] - section.corners[c]).re();
                    let round = section.round.is_some() && s == 1;
                    let level = way.dot(axis.direction.re()).abs() <= 1e-10 * way.norm();
                    (round || !level).then(|| FaceSurface::Turned {
                        centre: axis.point,
                        axis: axis.direction,
                        profile: profile(),
                        sweep,
                    })
                }
                None => section.round.filter(|_| s == 1).map(|piece| FaceSurface::Ruled {
                    near: stations[from].0.piece(&piece),
                    far: stations[own[next]].0.piece(&piece),
                }),
            };
            parts.face(cycle, surface, &section.names[s], triangles);
        }
    }
    if !closed {
        let fan = |k: usize| -> Vec<[u32; 3]> {
            (1..=n).map(|r| [number[k][0], number[k][r], number[k][r + 1]]).collect()
        };
        let (start, end) = (own[0], own[own.len() - 1]);
        let back = fan(start).into_iter().map(|[a, b, c]| [a, c, b]).collect();
        let cycle = [2, 1, 0].map(|s| (across[0][s], false)).to_vec();
        parts.face(cycle, None, &[], back);
        let cycle = [0, 1, 2].map(|s| (across[own.len() - 1][s], true)).to_vec();
        parts.face(cycle, None, &[], fan(end));
    }
    parts.finish()
}

/// The part between a corner of three planes and the ball that touches them.
pub(super) struct BallCorner<T> {
    pub corner: Vec3<T>,
    pub centre: Vec3<T>,
    /// By plane: where the ball touches it.
    pub feet: [Vec3<T>; 3],
    /// By plane: the point of the edge of the two others that is nearest to the centre.
    pub on_edges: [Vec3<T>; 3],
    pub names: [Vec<Arc<str>>; 3],
}

impl<T: Real> BallCorner<T> {
    /// The body; `None` when the ball touches the planes along one line.
    pub fn solid(&self) -> Option<SketchSolid<T>> {
        let [e, f] = [self.on_edges, self.feet];
        let mut parts = ToolParts::new(vec![self.corner, e[0], e[1], e[2], f[0], f[1], f[2]]);
        let straight = |parts: &mut ToolParts<T>, a: usize, b: usize| {
            parts.edge(vec![a as u32, b as u32], None)
        };
        let spokes = [0, 1, 2].map(|k| straight(&mut parts, 0, 1 + k));
        // From the point on edge k to the foot in plane i, by k and whether i is the first of the
        // other two.
        let ribs = [0, 1, 2]
            .map(|k| [(k + 1) % 3, (k + 2) % 3].map(|i| straight(&mut parts, 1 + k, 4 + i)));
        let mut arcs = [0; 3];
        for (k, arc) in arcs.iter_mut().enumerate() {
            let [i, j] = [(k + 1) % 3, (k + 2) % 3];
            let [a, to] = [f[i] - self.centre, f[j] - self.centre];
            let side = (to - a * (a.dot(to) / a.norm_sq())).normalized()?;
            let sweep = a.cross(to).norm().atan2(a.dot(to));
            let piece = SmoothPiece::Conic { centre: self.centre, a, b: side * a.norm(), sweep };
            let n = by_angle(&piece);
            let mut chain = vec![4 + i as u32];
            for s in 1..n {
                let p = piece.at(T::from(s as f64 / n as f64));
                chain.push(parts.point(p));
            }
            chain.push(4 + j as u32);
            *arc = parts.edge(chain, Some(piece));
        }
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            // Plane i: to the edge of i and j, to the foot, to the edge of i and k.
            let cycle = vec![
                (spokes[k], true),
                (ribs[k][0], true),
                (ribs[j][1], false),
                (spokes[j], false),
            ];
            let [a, b, c] = [1 + k as u32, 4 + i as u32, 1 + j as u32];
            parts.face(cycle, None, &self.names[i], vec![[0, a, b], [0, b, c]]);
        }
        for k in 0..3 {
            let [i, j] = [(k + 1) % 3, (k + 2) % 3];
            let cycle = vec![(ribs[k][0], false), (ribs[k][1], true), (arcs[k], false)];
            let chain = parts.mesh.chains[arcs[k]].clone();
            let hub = 1 + k as u32;
            let fan = chain.windows(2).map(|w| [hub, w[1], w[0]]).collect();
            let _ = (i, j);
            parts.face(cycle, None, &[], fan);
        }
        self.ball_face(&mut parts, [arcs[2], arcs[0], arcs[1]])?;
        Some(parts.finish())
    }

    fn ball_face(&self, parts: &mut ToolParts<T>, arcs: [usize; 3]) -> Option<()> {
        let spokes = self.feet.map(|f| f - self.centre);
        let radius = spokes[0].norm();
        let middle = newell(&self.feet).normalized()?;
        let middle = if middle.dot(spokes[0]).re() < 0.0 { -middle } else { middle };
        let mut border: Vec<u32> = Vec::new();
        for e in arcs {
            let chain = &parts.mesh.chains[e];
            border.extend(&chain[..chain.len() - 1]);
        }
        let towards: Vec<Vec3<T>> =
            border.iter().map(|&v| parts.mesh.points[v as usize] - self.centre).collect();
        let widest =
            towards.iter().map(|d| d.re().normalized().unwrap_or_default().dot(middle.re()));
        let widest = libm::acos(widest.fold(1.0, f64::min)).to_degrees();
        let rows = (widest / 5.0).ceil().max(1.0) as usize;
        let mut triangles = Vec::new();
        let hub = parts.point(self.centre + middle * radius);
        let m = border.len();
        let mut inner: Vec<u32> = vec![hub; m];
        for row in 1..=rows {
            let part = T::from(row as f64 / rows as f64);
            let outer: Vec<u32> = if row == rows {
                border.clone()
            } else {
                (towards.iter())
                    .map(|d| {
                        let way = (middle * radius).lerp(*d, part).normalized().unwrap_or(middle);
                        parts.point(self.centre + way * radius)
                    })
                    .collect()
            };
            for k in 0..m {
                let l = (k + 1) % m;
                triangles.push([inner[k], outer[k], outer[l]]);
                if row > 1 {
                    triangles.push([inner[k], outer[l], inner[l]]);
                }
            }
            inner = outer;
        }
        // Half of a great circle about an axis square to the middle, which is far from its poles.
        let axis = middle.cross(spokes[0]).normalized()?;
        let side = middle.cross(axis);
        let profile = SmoothPiece::Conic {
            centre: self.centre,
            a: -axis * radius,
            b: side * radius,
            sweep: T::from(std::f64::consts::PI),
        };
        let surface = FaceSurface::Turned {
            centre: self.centre,
            axis,
            profile,
            sweep: T::from(std::f64::consts::PI),
        };
        let cycle = arcs.map(|e| (e, true)).to_vec();
        let names: Vec<Arc<str>> = self.names.iter().flatten().cloned().collect();
        let joined: Vec<Arc<str>> = joined(&[&names]).into_iter().collect();
        parts.face(cycle, Some(surface), &joined, triangles);
        Some(())
    }
}

/// The name of a face between others.
pub(super) fn joined(names: &[&[Arc<str>]]) -> Option<Arc<str>> {
    let first: Vec<&str> = names.iter().flat_map(|n| n.iter()).map(|n| &**n).collect();
    (!first.is_empty()).then(|| first.join("+").into())
}
