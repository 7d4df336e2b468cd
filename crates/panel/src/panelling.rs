//! From surfaces to panels: patches from their own parameters and divisions, joined by identity.
//!
//! `surfaces -> drafts -> roots cut into stretches -> counts -> skeleton -> joined vertices -> panels`
//!
//! A patch of nu x nv divisions has a grid of vertices. Its edges run along stretches of roots (see
//! `moldloft_num::trace` and [`crate::roots`]); counts flow from patch to patch along these
//! ([`crate::counts`]), and where an edge has several stretches their ends fall on divisions
//! ([`crate::edges`]). Vertices of different patches become one when they are the same division of the
//! same stretch, or lie at the same point object ([`crate::join`]); never because they look close. The
//! position of a shared vertex is computed once, by the first patch in the order of declaration.

use crate::draft::{drafts, indices};
use crate::edges::{self, EdgePlan, along_edge};
use crate::joined_patches::Joint;
use crate::notes::Remark;
use crate::patch_values::{Known, evaluated_all, names};
use crate::roots::Roots;
use crate::topology::{self, Counts, Frame, Nominal, Rim, Skeleton};
use crate::triangle_bodies::{self, Body};
use moldloft_mesh::{Mesh, Topology};
use moldloft_model::{Graph, Object};
use moldloft_num::trace::Key;
use moldloft_num::{Box3, Real, Vec3};
use moldloft_registry::{Fault, Scalar, SurfaceRef};
use std::cell::LazyCell;
use std::collections::HashMap;
use std::sync::Arc;

/// The most panels of a model.
pub const MOST_PANELS: u64 = 20_000_000;

/// The fault of `count` panels.
pub fn too_many_panels(count: u64) -> Fault {
    Fault::new("too-many-panels", format!("{count} panels are too many"))
        .expected(format!("at most {MOST_PANELS}"))
        .found(count.to_string())
        .help("lower the divisions of the surfaces")
}

/// An edge, or a whole patch, within this share of the model's size from a coordinate plane lies in
/// it: rounding of a sine must not open a seam or leave slivers at a plane of symmetry.
const IN_PLANE: f64 = 1e-12;

/// Which vertices there are and who computes them; independent of the scalar.
#[derive(Clone, Debug)]
pub struct Panelling {
    pub(crate) skeleton: Arc<Skeleton>,
    pub(crate) joint: Arc<Joint>,
    /// Bodies of triangles; their vertices come after all others.
    bodies: Arc<Vec<Body>>,
    /// The joint's topology and that of the bodies.
    topology: Arc<Topology>,
    /// The points of each patch by itself, in the order of the skeleton, at the state that this was
    /// made of: as they were evaluated, and with exact zeros.
    raw: Vec<Arc<Vec<Vec3>>>,
    pub(crate) points: Vec<Arc<Vec<Vec3>>>,
    /// Parts of patches whose coordinate is exactly zero: patch, edge (4 for all of it), axis.
    zeros: Vec<(u32, u8, u8)>,
    /// Point objects whose parameters divide edges, by their identity where this was made.
    pub(crate) names: Arc<HashMap<Key, Arc<str>>>,
    remarks: Vec<Remark>,
    measured: bool,
    /// What the graph called its last change then.
    clock: u64,
}

impl Panelling {
    /// The panelling of all shown surfaces that have a value.
    ///
    /// # Errors
    /// A [`Fault`] when there would be too many panels.
    pub fn new(graph: &Graph<f64>) -> Result<Self, Fault> {
        Self::renewed(graph, None, None)
    }

    /// The same with the counts of `nominal` wherever nothing else determines them. Of `before`, a
    /// panelling of the same graph at an earlier state, what has not changed is taken over; the
    /// result is the same without it.
    ///
    /// # Errors
    /// A [`Fault`] when there would be too many panels.
    pub fn renewed(
        graph: &Graph<f64>,
        nominal: Option<&Nominal>,
        before: Option<&Panelling>,
    ) -> Result<Self, Fault> {
        let drafts = drafts(graph);
        let made = topology::make(graph, Roots::new(graph, &drafts), &drafts, nominal);
        let count = |frame: &Frame| frame.divisions[0] as u64 * frame.divisions[1] as u64;
        let mut bodies = triangle_bodies::bodies(graph);
        let total = made.skeleton.frames.iter().map(count).sum::<u64>()
            + bodies.iter().map(Body::panels).sum::<u64>();
        if total > MOST_PANELS {
            return Err(too_many_panels(total));
        }
        let before = before.filter(|b| *b.skeleton == made.skeleton);
        let skeleton = before.map_or_else(|| Arc::new(made.skeleton), |b| b.skeleton.clone());
        let names = match before {
            Some(before) => before.names.clone(),
            None => Arc::new(names(graph, &skeleton)),
        };
        // Divisions that hang on marks of other objects move with these.
        let hangs = |frame: &Frame| {
            frame.plans.iter().any(|p| matches!(p, EdgePlan::Segments(_) | EdgePlan::Like(_)))
        };
        let kept = |patch: usize| {
            let before = before?;
            let unchanged = drafts[patch].object.changed_at <= before.clock;
            (unchanged && !hangs(&skeleton.frames[patch])).then(|| before.raw[patch].clone())
        };
        let evaluated = evaluated_all(&skeleton, &names, graph, kept);
        // Every draft has a value in its own graph.
        let raw: Vec<_> = evaluated.into_iter().flatten().collect();
        let mut points = raw.clone();
        let size = points.iter().flat_map(|p| p.iter()).fold(Box3::EMPTY, |b, &p| b.including(p));
        let zeros = zeros(&skeleton, &points, size.diagonal());
        set_zeros(&skeleton, &zeros, &mut points);
        let fixed = fixed(&skeleton, &points);
        let joint = match before.filter(|b| b.joint.fixed == fixed) {
            Some(before) if before.joint.turned == before.joint.facing(&skeleton, &points) => {
                before.joint.clone()
            }
            _ => {
                let joint = Joint::new(&skeleton, &points, fixed);
                Arc::new(joint.map_err(|e| Fault::new("too-many-panels", e.to_string()))?)
            }
        };
        let mut remarks = made.remarks;
        remarks.extend(joint.apart(&skeleton, &points, size.diagonal()));
        {
            let known = if bodies.iter().any(Body::has_border) {
                Known::new(graph, &skeleton, &names)
            } else {
                Known::empty(graph, &skeleton, &names)
            };
            let clock = before.map_or(0, |b| b.clock);
            let unchanged = |object: &Object<f64>| object.changed_at <= clock;
            let earlier = before.map(|b| (b.bodies.as_slice(), &unchanged as _));
            remarks.extend(triangle_bodies::sewn(&mut bodies, &known, &joint, earlier));
        }
        let whole = before.filter(|b| {
            let alike = b.bodies.len() == bodies.len()
                && b.bodies.iter().zip(&bodies).all(|(a, b)| a.is_like(b));
            alike && Arc::ptr_eq(&b.joint, &joint)
        });
        let topology = match whole {
            Some(before) => before.topology.clone(),
            None if bodies.is_empty() => joint.topology.clone(),
            None => triangle_bodies::with_bodies(&joint.topology, &bodies)
                .map_err(|e| Fault::new("too-many-panels", e.to_string()))?,
        };
        Ok(Self {
            skeleton,
            joint,
            bodies: Arc::new(bodies),
            topology,
            raw,
            points,
            zeros,
            names,
            remarks,
            measured: made.measured,
            clock: graph.last_change(),
        })
    }

    /// The connectivity.
    pub fn topology(&self) -> &Arc<Topology> {
        &self.topology
    }

    /// What was noticed at the joins.
    pub fn remarks(&self) -> &[Remark] {
        &self.remarks
    }

    /// True when some count follows from lengths, so that it may change with the shape.
    pub fn is_measured(&self) -> bool {
        self.measured
    }

    /// Its counts, for [`Self::like`].
    pub fn nominal(&self) -> Nominal {
        let counts = self.skeleton.frames.iter().map(|frame| {
            let edges = std::array::from_fn(|k| match &frame.rims[k] {
                Rim::Along(spans) => {
                    spans.iter().filter(|(s, _)| s.stretch.is_some()).map(|(_, n)| *n).collect()
                }
                _ => Vec::new(),
            });
            ((frame.name.clone(), frame.hem), Counts { divisions: frame.divisions, edges })
        });
        Nominal(counts.collect())
    }

    /// The names of the patches' surfaces, in the order of the topology's patches; bodies of
    /// triangles come after them.
    pub fn surfaces(&self) -> impl Iterator<Item = &Arc<str>> {
        self.skeleton.frames.iter().filter(|f| f.meshed).map(|f| &f.name)
    }

    /// The positions of all vertices, evaluated with the scalar of `graph`; `None` when a surface
    /// has no value there.
    pub fn positions<T: Scalar>(&self, graph: &Graph<T>) -> Option<Vec<Vec3<T>>> {
        let points = evaluated_all(&self.skeleton, &self.names, graph, |_| None);
        let mut points = points.into_iter().collect::<Option<Vec<_>>>()?;
        set_zeros(&self.skeleton, &self.zeros, &mut points);
        Some(self.gathered(&points, &self.body_points(graph, &points)?))
    }

    /// Of each structured patch, in the order of the topology's: its surface, and (u, v) of each
    /// vertex of its block; `None` when a surface has no value.
    pub fn parameters(&self, graph: &Graph<f64>) -> Option<Vec<(SurfaceRef<f64>, Vec<[f64; 2]>)>> {
        let known = Known::new(graph, &self.skeleton, &self.names);
        let meshed = (0..self.skeleton.frames.len()).filter(|&k| self.skeleton.frames[k].meshed);
        meshed
            .map(|patch| {
                let edge = |k: usize| along_edge(k, patch as u32, &known);
                let edges = [edge(0)?, edge(1)?, edge(2)?, edge(3)?];
                Some((known.surfaces[patch].clone()?, edges::parameters(&edges)))
            })
            .collect()
    }

    /// The mesh, evaluated with the scalar of `graph`.
    pub fn mesh<T: Scalar>(&self, graph: &Graph<T>) -> Option<Mesh<T>> {
        Mesh::new(self.topology().clone(), self.positions(graph)?).ok()
    }

    /// The mesh at the state that the panelling was made of.
    pub fn own_mesh(&self) -> Option<Mesh<f64>> {
        Mesh::new(self.topology().clone(), self.gathered(&self.points, &self.own_body_points()))
            .ok()
    }

    /// The vertices of the bodies' own, evaluated with the scalar of `graph`; `None` when one has no
    /// value there, or other triangles. `patches` are the points of the patches.
    fn body_points<T: Scalar>(
        &self,
        graph: &Graph<T>,
        patches: &[Arc<Vec<Vec3<T>>>],
    ) -> Option<Vec<Vec3<T>>> {
        if self.bodies.is_empty() {
            return Some(Vec::new());
        }
        let known = LazyCell::new(|| Known::new(graph, &self.skeleton, &self.names));
        let mut points = Vec::new();
        for body in self.bodies.iter() {
            let facets = body.facets_in(graph, || &*known)?;
            points.extend(body.own_points(&facets, patches));
        }
        Some(points)
    }

    /// The same at the state that the panelling was made of.
    fn own_body_points(&self) -> Vec<Vec3> {
        self.bodies.iter().flat_map(|b| b.own_points(&b.facets, &self.points)).collect()
    }

    /// The vertices' positions from those of the patches by themselves, and those of the bodies.
    fn gathered<T: Real>(&self, points: &[Arc<Vec<Vec3<T>>>], bodies: &[Vec3<T>]) -> Vec<Vec3<T>> {
        let mut positions = vec![Vec3::zero(); self.topology().vertex_count()];
        let last = positions.len() - bodies.len();
        positions[last..].copy_from_slice(bodies);
        let patches = self.skeleton.frames.iter().zip(points).zip(&self.joint.vertices);
        // Backwards, so that the first patch has the last word.
        for ((_, points), vertices) in patches.rev().filter(|((f, _), _)| f.meshed) {
            for (&vertex, &p) in vertices.iter().zip(points.iter()) {
                positions[vertex as usize] = p;
            }
        }
        positions
    }
}

/// The parts of patches that lie in a coordinate plane but for rounding.
fn zeros(skeleton: &Skeleton, points: &[Arc<Vec<Vec3>>], size: f64) -> Vec<(u32, u8, u8)> {
    let near = IN_PLANE * size;
    let mut found = Vec::new();
    for (patch, (frame, points)) in skeleton.frames.iter().zip(points).enumerate() {
        for axis in 0..3u8 {
            let at = |k: usize| points[k][usize::from(axis)];
            let inside = |part| indices(frame.divisions, part).all(|k| at(k).abs() <= near);
            let edges: Vec<u8> = (0..4).filter(|&k| inside(k)).collect();
            let whole = edges.len() == 4 && inside(4);
            let parts = if whole { vec![4] } else { edges };
            for part in parts {
                found.push((patch as u32, part, axis));
            }
        }
    }
    found
}

/// Makes the coordinates zero; their derivatives stay.
fn set_zeros<T: Real>(
    skeleton: &Skeleton,
    zeros: &[(u32, u8, u8)],
    points: &mut [Arc<Vec<Vec3<T>>>],
) {
    for &(patch, part, axis) in zeros {
        let divisions = skeleton.frames[patch as usize].divisions;
        let points = &mut points[patch as usize];
        let zero = |k: usize| points[k][usize::from(axis)].re().to_bits() == 0;
        if indices(divisions, part).all(zero) {
            continue;
        }
        let points = Arc::make_mut(points);
        for k in indices(divisions, part) {
            let mut p = points[k].to_array();
            let x = &mut p[usize::from(axis)];
            *x = T::from_parts(|part| if part == 0 { 0.0 } else { x.part(part) });
            points[k] = p.into();
        }
    }
}

/// For each patch that is an image, which points of its boundary are those of its original.
fn fixed(skeleton: &Skeleton, points: &[Arc<Vec<Vec3>>]) -> Vec<Vec<bool>> {
    let of_patch = |(patch, frame): (usize, &Frame)| {
        let Some((original, _)) = frame.image else { return Vec::new() };
        if skeleton.frames[original].divisions != frame.divisions {
            return Vec::new();
        }
        let boundary = (0..4).flat_map(|k| indices(frame.divisions, k));
        // -0 and 0 are one place.
        boundary.map(|k| points[patch][k] == points[original][k]).collect()
    };
    skeleton.frames.iter().enumerate().map(of_patch).collect()
}
