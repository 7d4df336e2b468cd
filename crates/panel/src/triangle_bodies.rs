//! Bodies of triangles among the panels: they come as they are, but for sheets with a border, whose
//! vertices there are those of their neighbours.

use crate::border_curves::{border, finer};
use crate::edges::along_edge;
use crate::joined_patches::JoinedPatches;
use crate::notes::PanelNote;
use crate::patch_values::PatchValues;
use moldloft_mesh::{MeshError, PatchInfo, Tag, Topology, TopologyBuilder};
use moldloft_model::{Graph, Object};
use moldloft_num::{Fineness, Real, Vec3};
use moldloft_registry::{Border, BorderCurve, CallError, Scalar, TriangleBody, Value};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Relative difference of measures that rounding explains.
const MEASURE_ROUNDING: f64 = 1e-9;

/// A shown object that is a body.
#[derive(Clone, Debug)]
pub(crate) struct MeshedBody {
    pub name: Arc<str>,
    kind: Arc<str>,
    pub colour: i32,
    pub tags: Vec<Arc<str>>,
    pub reversed: bool,
    /// True for a face of a cavity.
    pub cavity: bool,
    pub facets: Arc<TriangleBody<f64>>,
    /// The parameters of the divisions of its border, curve by curve; empty without a border.
    pub divided: Vec<Vec<f64>>,
    /// The patch without panels that represents each curve of its border, if there is one.
    border_curves: Vec<Option<usize>>,
    /// Its border, if a required accuracy of the triangles is given.
    finer: Option<Border<f64>>,
    /// Vertices of each curve.
    pub border_vertices: Vec<Vec<u32>>,
    /// The number of each of its vertices in the mesh, and which are its own.
    pub vertices: Vec<u32>,
    own: Vec<u32>,
}

/// The visible bodies in the order of declaration, without joins. `fineness`: the required accuracy
/// of sheets, if given.
///
/// # Errors
/// When the accuracy takes too many triangles.
pub(crate) fn bodies(
    graph: &Graph<f64>,
    fineness: Option<&Fineness>,
) -> Result<Vec<MeshedBody>, CallError> {
    let shown = graph.objects().filter(|o| o.head.shown());
    shown
        .filter_map(|object| {
            let Some(Value::Body(facets)) = object.value() else { return None };
            Some(finer(object, fineness).map(|finer| MeshedBody {
                name: object.name.clone(),
                kind: object.row.name.as_ref().into(),
                colour: object.head.colour,
                tags: object.head.panels.as_ref().map_or(Vec::new(), |p| p.tags.clone()),
                reversed: object.head.reversed(),
                cavity: object.head.cavity(),
                facets: facets.clone(),
                divided: Vec::new(),
                border_curves: Vec::new(),
                finer,
                border_vertices: Vec::new(),
                vertices: Vec::new(),
                own: Vec::new(),
            }))
        })
        .collect()
}

pub(crate) fn with_bodies(
    base: &Topology,
    bodies: &[MeshedBody],
) -> Result<Arc<Topology>, MeshError> {
    let mut builder = TopologyBuilder::extending(base.clone());
    for body in bodies {
        body.add(&mut builder)?;
    }
    Ok(builder.build().into())
}

/// Divides the borders of the bodies like the patches that represent them, and numbers all of their
/// vertices; `before` are those of an earlier state and its test for unchanged objects. Returns
/// notes about missing joins.
pub(crate) fn sewn(
    bodies: &mut [MeshedBody],
    known: &PatchValues<f64>,
    joined: &JoinedPatches,
    before: Option<(&[MeshedBody], &dyn Fn(&Object<f64>) -> bool)>,
) -> Vec<PanelNote> {
    let mut remarks = Vec::new();
    let mut border_curves: HashMap<(Arc<str>, u32), usize> = HashMap::new();
    for (patch, frame) in known.structure.patches.iter().enumerate() {
        if let Some(border_curve) = frame.border_curve {
            border_curves.insert((frame.name.clone(), border_curve), patch);
        }
    }
    let used = joined.topology.vertex_count() as u32;
    let mut next = used;
    // Vertices of borders that no panel has.
    let mut between: HashMap<u32, u32> = HashMap::new();
    let mut edges: Option<HashSet<(u32, u32)>> = None;
    for body in bodies {
        let object = known.graph.find(&body.name).and_then(|key| known.graph.get(key));
        let same = before.and_then(|(all, unchanged)| {
            let twin = all.iter().find(|b| b.name == body.name)?;
            object.is_some_and(unchanged).then_some(twin)
        });
        if let Some(divisions) = body.divide(object, &border_curves, known, same) {
            remarks.push(PanelNote::Border { patch: body.name.to_string(), divisions });
        }
        remarks.extend(body.missed_area());
        body.vertices = vec![u32::MAX; body.facets.points.len()];
        let numbers = |patch: usize| joined.vertices[patch].iter().step_by(2).copied();
        let mut pending = Vec::new();
        for (curve_vertices, patch) in body.border_vertices.iter().zip(&body.border_curves) {
            let Some(patch) = *patch else { continue };
            for (&vertex, number) in curve_vertices.iter().zip(numbers(patch)) {
                let slot = &mut body.vertices[vertex as usize];
                let found =
                    if number < used { Some(number) } else { between.get(&number).copied() };
                match found {
                    Some(found) if *slot == u32::MAX => *slot = found,
                    Some(_) => {}
                    None => pending.push((vertex, number)),
                }
            }
        }
        body.own.clear();
        for (vertex, slot) in body.vertices.iter_mut().enumerate() {
            if *slot == u32::MAX {
                *slot = next;
                next += 1;
                body.own.push(vertex as u32);
            }
        }
        for (vertex, number) in pending {
            between.entry(number).or_insert(body.vertices[vertex as usize]);
        }
        if !body.border_curves.is_empty() {
            let edges = edges.get_or_insert_with(|| directed(joined.topology.faces()));
            body.face_like(edges);
            edges.extend(body.faces().flat_map(sides));
        }
    }
    remarks
}

/// The directed edges of a panel.
fn sides([a, b, c, d]: [u32; 4]) -> impl Iterator<Item = (u32, u32)> {
    [(a, b), (b, c), (c, d), (d, a)].into_iter().filter(|(p, q)| p != q)
}

fn directed(faces: &[[u32; 4]]) -> HashSet<(u32, u32)> {
    faces.iter().copied().flat_map(sides).collect()
}

impl MeshedBody {
    /// True when it makes the same panels.
    pub fn is_like(&self, o: &MeshedBody) -> bool {
        let heads = (self.colour, &self.tags, self.reversed) == (o.colour, &o.tags, o.reversed);
        heads
            && (&self.name, &self.kind) == (&o.name, &o.kind)
            && self.vertices == o.vertices
            && self.facets.triangles == o.facets.triangles
            && self.facets.groups == o.facets.groups
    }

    /// Number of panels.
    pub fn panels(&self) -> u64 {
        (self.facets.triangles.len() - self.facets.quads) as u64
    }

    /// True when it may join neighbours.
    pub fn has_border(&self) -> bool {
        self.facets.border.is_some()
    }

    /// True when its border is divided like that of its neighbours.
    pub fn is_sewn(&self) -> bool {
        !self.border_curves.is_empty()
    }

    /// The note of a sheet that misses more of its area than promised.
    fn missed_area(&self) -> Option<PanelNote> {
        let border = &self.facets.border.as_ref().filter(|_| self.finer.is_none())?.0;
        let promise = border.promised()?;
        let area = [self.facets.of_triangles.area, border.measures()?.area];
        let misses = (area[0] - area[1]).abs() > promise * area[1];
        misses.then(|| PanelNote::MissedArea { patch: self.name.to_string(), area })
    }

    /// The note of a body whose triangles miss its measures and that has no border to be divided by.
    pub fn undivided(&self) -> Option<PanelNote> {
        let body = &self.facets;
        if self.has_border() {
            return None;
        }
        let triangles = TriangleBody::new(body.points.clone(), body.triangles.clone());
        let [own, exact] = [triangles.of_triangles, body.of_triangles];
        let relative = |a: f64, b: f64| if a == b { 0.0 } else { ((a - b) / b).abs() };
        let missed = [relative(own.area, exact.area), relative(own.volume, exact.volume)];
        let misses = missed.iter().any(|m| *m > MEASURE_ROUNDING);
        misses.then(|| PanelNote::Undivided { patch: self.name.to_string(), missed })
    }

    /// Divides its border; a border that would cross itself stays as it was and joins nothing, and the
    /// divisions that would make it are returned.
    fn divide(
        &mut self,
        object: Option<&Object<f64>>,
        border_curves: &HashMap<(Arc<str>, u32), usize>,
        known: &PatchValues<f64>,
        same: Option<&MeshedBody>,
    ) -> Option<Vec<usize>> {
        let border = match &self.finer {
            Some(finer) => &finer.0,
            None => border(object?)?,
        };
        let count = border.curves().len() as u32;
        let patches: Vec<_> =
            (0..count).map(|k| border_curves.get(&(self.name.clone(), k)).copied()).collect();
        let at = parameters(&patches, known, border.curves())?;
        let alike = |a: &[Vec<f64>], b: &[Vec<f64>]| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a == b)
        };
        let made = match same.filter(|b| alike(&b.divided, &at)) {
            Some(before) => Some((before.facets.clone(), before.border_vertices.clone())),
            None => border.divided(&at).map(|(mut facets, border_vertices)| {
                facets.border = self.facets.border.clone();
                (Arc::new(facets), border_vertices)
            }),
        };
        let Some((facets, border_vertices)) = made else {
            return Some(at.iter().map(|ts| ts.len() - 1).collect());
        };
        (self.facets, self.border_vertices) = (facets, border_vertices);
        (self.border_curves, self.divided) = (patches, at);
        None
    }

    /// Orients it like its neighbours, which have common edges in the opposite direction.
    fn face_like(&mut self, edges: &HashSet<(u32, u32)>) {
        let (mut alike, mut against) = (0, 0);
        for (a, b) in self.faces().flat_map(sides) {
            alike += usize::from(edges.contains(&(b, a)));
            against += usize::from(edges.contains(&(a, b)));
        }
        if against > alike {
            self.reversed = !self.reversed;
        }
    }

    /// Its panels in the numbers of the mesh; those that joins have made lines are left out.
    fn faces(&self) -> impl Iterator<Item = [u32; 4]> {
        let (halves, triangles) = self.facets.triangles.split_at(2 * self.facets.quads);
        let quads = halves.chunks_exact(2).flat_map(|pair| match self.quad(pair[0], pair[1][2]) {
            Some(quad) => [Some(quad), None],
            None => [self.face(&pair[0]), self.face(&pair[1])],
        });
        quads.flatten().chain(triangles.iter().filter_map(|t| self.face(t)))
    }

    /// A panel of four corners; `None` if joins have merged some.
    fn quad(&self, [a, b, c]: [u32; 3], d: u32) -> Option<[u32; 4]> {
        let at = [a, b, c, d].map(|v| self.vertices[v as usize]);
        let apart = (0..4).all(|i| (0..i).all(|k| at[i] != at[k]));
        let [a, b, c, d] = at;
        apart.then_some(if self.reversed { [d, c, b, a] } else { at })
    }

    fn face(&self, t: &[u32; 3]) -> Option<[u32; 4]> {
        let [a, b, c] = t.map(|v| self.vertices[v as usize]);
        let [a, c] = if self.reversed { [c, a] } else { [a, c] };
        (a != b && b != c && c != a).then_some([a, b, c, c])
    }

    /// Adds its vertices and panels.
    fn add(&self, builder: &mut TopologyBuilder) -> Result<(), MeshError> {
        builder.add_vertices(self.own.len())?;
        let info = PatchInfo {
            name: self.name.to_string(),
            tag: Tag::among(self.tags.iter().map(|t| &**t)),
            tags: self.tags.iter().map(|t| t.to_string()).collect(),
            colour: Some((self.colour & 15) as u8),
            kind: self.kind.to_string(),
        };
        if self.facets.groups.is_empty() {
            return builder.add_faces(info, self.faces());
        }
        for group in &self.facets.groups {
            let own = PatchInfo {
                name: format!("{}.{}", self.name, group.name),
                kind: group.kind.clone(),
                colour: group.colour.or(info.colour),
                tags: info.tags.iter().chain(&group.tags).cloned().collect(),
                ..info.clone()
            };
            let triangles = &self.facets.triangles[group.triangles.clone()];
            builder.add_faces(own, triangles.iter().filter_map(|t| self.face(t)))?;
        }
        Ok(())
    }

    /// Its facets with the scalar of `graph`, divided as here; `None` when it has no value there, or other
    /// triangles.
    pub fn facets_in<'k, T: Scalar>(
        &self,
        graph: &Graph<T>,
        known: impl FnOnce() -> &'k PatchValues<'k, T>,
    ) -> Option<Arc<TriangleBody<T>>> {
        let object = graph.get(graph.find(&self.name)?)?;
        let Some(Value::Body(facets)) = object.value() else { return None };
        let facets = match border(object).filter(|_| !self.border_curves.is_empty()) {
            None => facets.clone(),
            Some(border) => {
                let at = parameters(&self.border_curves, known(), border.curves())?;
                Arc::new(border.divided(&at)?.0)
            }
        };
        (facets.points.len() == self.facets.points.len()).then_some(facets)
    }

    /// The positions of its own vertices, from those of its facets and of the patches.
    pub fn own_points<T: Real>(
        &self,
        facets: &TriangleBody<T>,
        patches: &[Arc<Vec<Vec3<T>>>],
    ) -> impl Iterator<Item = Vec3<T>> {
        let mut points = facets.points.clone();
        for (curve_vertices, patch) in self.border_vertices.iter().zip(&self.border_curves) {
            let Some(patch) = *patch else { continue };
            for (&vertex, &p) in curve_vertices.iter().zip(patches[patch].iter().step_by(2)) {
                points[vertex as usize] = p;
            }
        }
        self.own.iter().map(move |&v| points[v as usize])
    }
}

/// The parameters of the divisions of a border's curves; the default of each without a patch.
fn parameters<T: Scalar>(
    patches: &[Option<usize>],
    known: &PatchValues<T>,
    curves: &[BorderCurve<T>],
) -> Option<Vec<Vec<T>>> {
    let of = |(patch, curve): (&Option<usize>, &BorderCurve<T>)| match patch {
        Some(patch) => along_edge(0, *patch as u32, known),
        None => Some(curve.divisions().into_iter().map(T::from).collect()),
    };
    patches.iter().zip(curves).map(of).collect()
}
