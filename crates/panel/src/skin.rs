//! The skin of a model as a body for measures: its surfaces, their orientation, and their open
//! edges.

use crate::panelling::Panelling;
use moldloft_hydro::{
    Body, BodyMeasures, HullSide, PulledBody, Symmetry, TrimCurve, bounds_part, part_measures,
    pull_hydrostatics,
};
use moldloft_mesh::{Closes, EdgeName, Mesh, OpenEdge, closure};
use moldloft_model::Graph;
use moldloft_num::{Adjoints, Rev, Vec3};
use moldloft_registry::{Border, Scalar, SurfaceRef, Value};
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

/// The surfaces and panels that bound the body; independent of the scalar.
#[derive(Clone, Debug)]
pub struct Skin {
    sides: Vec<SkinSide>,
    /// Faces of bodies of triangles, and of surfaces of very many pieces, which are their panels.
    faces: Vec<usize>,
    /// Open panel edges where no whole edge of a surface is open.
    rims: Vec<[u32; 2]>,
    /// About the diagonal.
    size: f64,
    on_panels: Vec<String>,
    /// The patches with an edge that nothing closes.
    open: Vec<String>,
}

#[derive(Clone, Debug)]
struct SkinSide {
    name: Arc<str>,
    reversed: bool,
    open_edges: [bool; 4],
    /// True for a part of a surface within loops.
    trimmed: bool,
}

/// The shape of a side: a surface, or a part of one.
enum SideShape<T: Scalar> {
    Whole(SurfaceRef<T>),
    Trimmed(Border<T>),
}

/// A surface of more pieces than this is measured on its panels.
const MOST_PIECES: usize = 2500;

impl Skin {
    /// The skin of the mesh of `panelling` and `graph`: the patches that bound the body. `mirrors`
    /// are the axes normal to the model's planes of symmetry; these planes close edges.
    pub fn new<T: Scalar>(
        panelling: &Panelling,
        mesh: &Mesh<f64>,
        graph: &Graph<T>,
        mirrors: &[u8],
    ) -> Self {
        let names: Vec<Arc<str>> = panelling.surfaces().cloned().collect();
        let open = closure(mesh, mirrors, None);
        let mut skin = Self {
            sides: Vec::new(),
            faces: Vec::new(),
            rims: Vec::new(),
            size: mesh.bounds().diagonal(),
            on_panels: Vec::new(),
            open: Vec::new(),
        };
        // The sheet of each patch of a body of triangles, and its orientation.
        let sheets: Vec<Option<(&Arc<str>, bool)>> = (panelling.bodies.iter())
            .flat_map(|body| {
                let sheet = body.has_border().then_some((&body.name, body.reversed));
                vec![sheet; body.facets.groups.len().max(1)]
            })
            .collect();
        let mut in_parts: HashSet<usize> = HashSet::new();
        let shared = shared_edges(panelling, mesh);
        for (k, patch) in mesh.patches().iter().enumerate() {
            if !patch.info.tag.is_skin() {
                continue;
            }
            let few = |surface: &SurfaceRef<T>| {
                let [u, v] = surface.joints();
                (u.len() + 1) * (v.len() + 1) <= MOST_PIECES
            };
            let whole = |name: &Arc<str>| match shape(graph, name, false) {
                Some(SideShape::Whole(surface)) => few(&surface),
                _ => false,
            };
            let side = names.get(k).zip(patch.block.as_ref()).filter(|(name, _)| whole(name));
            let sheet = k.checked_sub(names.len()).and_then(|k| sheets.get(k).copied().flatten());
            let sheet = sheet.filter(|(name, _)| match shape(graph, name, true) {
                Some(SideShape::Trimmed(border)) => {
                    let surface = border.0.surface();
                    few(surface) && bounds_part(&**surface, &loops(&border))
                }
                _ => false,
            });
            let mut open_edges = [false; 4];
            let closed =
                |edge: EdgeName| matches!(edge, EdgeName::Side(n) if shared.contains(&(k, n)));
            let bare = |e: &&OpenEdge| e.closes == Closes::Nothing && !closed(e.edge);
            for edge in open.open.iter().filter(|e| e.patch == k).filter(bare) {
                if skin.open.last() != Some(&patch.info.name) {
                    skin.open.push(patch.info.name.clone());
                }
                match (edge.edge, side) {
                    (EdgeName::Side(n), Some((_, block))) => {
                        let count = if n % 2 == 0 { block.nu } else { block.nv } - 1;
                        open_edges[usize::from(n)] = edge.panels == count;
                        if edge.panels != count {
                            in_parts.insert(k);
                        }
                    }
                    _ => {
                        in_parts.insert(k);
                    }
                }
            }
            match side {
                Some((name, block)) => {
                    if in_parts.contains(&k) {
                        open_edges = [false; 4];
                    }
                    let (name, reversed) = (name.clone(), block.reversed);
                    skin.sides.push(SkinSide { name, reversed, open_edges, trimmed: false });
                }
                None if let Some((name, reversed)) = sheet => {
                    let (name, open_edges) = (name.clone(), [false; 4]);
                    skin.sides.push(SkinSide { name, reversed, open_edges, trimmed: true });
                }
                None => {
                    skin.faces.extend(patch.faces.clone());
                    skin.on_panels.push(patch.info.name.clone());
                }
            }
        }
        if !in_parts.is_empty() {
            let mirrored = |edge: &[u32; 2]| {
                mirrors.iter().any(|&axis| {
                    edge.iter().all(|&v| mesh.positions()[v as usize][usize::from(axis)] == 0.0)
                })
            };
            let edges = mesh.open_skin_edges();
            let edges = edges.into_iter().filter(|(patch, _)| in_parts.contains(patch));
            skin.rims = edges.map(|(_, edge)| edge).filter(|e| !mirrored(e)).collect();
        }
        skin
    }

    /// The patches measured by their panels: they have no surface, the surface has too many pieces,
    /// or the loops of a part cross.
    pub fn on_panels(&self) -> &[String] {
        &self.on_panels
    }

    /// The name of a surface, by its index among the sides of the body.
    pub fn side(&self, index: usize) -> &str {
        &self.sides[index].name
    }

    /// The patches with an open edge, closed neither by a neighbour nor by a mirror image.
    pub fn open(&self) -> &[String] {
        &self.open
    }

    /// True when there is no body.
    pub fn is_empty(&self) -> bool {
        self.sides.is_empty() && self.faces.is_empty()
    }

    /// The body with the scalar of `graph`; `None` if a surface has no value there or is not
    /// finite.
    pub fn body<T: Scalar>(
        &self,
        panelling: &Panelling,
        graph: &Graph<T>,
        accuracy: f64,
    ) -> Option<Body<T>> {
        let mut panels: Vec<[Vec3<T>; 4]> = Vec::new();
        let mut rims: Vec<Vec<Vec3<T>>> = Vec::new();
        if !self.faces.is_empty() || !self.rims.is_empty() {
            let mesh = panelling.mesh(graph)?;
            let at = |v: u32| mesh.positions()[v as usize];
            panels.extend(self.faces.iter().map(|&f| mesh.faces()[f].map(at)));
            rims.extend(self.rims.iter().map(|edge| edge.map(at).to_vec()));
        }
        self.with_sides(graph, |sides| Body::new(sides, panels, rims, self.size, accuracy))
    }

    /// The result of a function of the sides; `None` if a surface has no value in `graph`.
    fn with_sides<T: Scalar, R>(
        &self,
        graph: &Graph<T>,
        made: impl FnOnce(&[HullSide<'_, T>]) -> Option<R>,
    ) -> Option<R> {
        let shapes = self.sides.iter().map(|side| shape(graph, &side.name, side.trimmed));
        let shapes: Vec<_> = shapes.collect::<Option<_>>()?;
        let parts: Vec<Option<_>> = (shapes.iter())
            .map(|shape| match shape {
                SideShape::Whole(_) => None,
                SideShape::Trimmed(border) => Some(loops(border)),
            })
            .collect();
        let sides: Vec<HullSide<'_, T>> = (self.sides.iter().zip(&shapes).zip(&parts))
            .map(|((side, shape), loops)| HullSide {
                surface: match shape {
                    SideShape::Whole(surface) => &**surface,
                    SideShape::Trimmed(border) => &**border.0.surface(),
                },
                reversed: side.reversed,
                open_edges: side.open_edges,
                loops: loops.as_deref(),
            })
            .collect();
        made(&sides)
    }

    /// Adds the derivatives of weighted sums of hydrostatic figures with respect to the nodes of
    /// this thread's tape, on which `graph` was recorded ([`pull_hydrostatics`]), and returns those
    /// by the vertices of `mesh` on whose panels the skin is measured. `weights` are those of each
    /// sum by the name of the figure, `mirrors` as for [`Skin::new`].
    pub fn pull_hydrostatics(
        &self,
        mesh: &Mesh<f64>,
        graph: &Graph<Rev>,
        accuracy: f64,
        mirrors: &[u8],
        weights: &[Vec<(&str, f64)>],
        adjoints: &mut [Adjoints],
    ) -> Option<Vec<Vec<Vec3>>> {
        let at = |v: u32| mesh.positions()[v as usize];
        let panels: Vec<_> = self.faces.iter().map(|&f| mesh.faces()[f].map(at)).collect();
        let mirrored = mirrors.contains(&1);
        let body = PulledBody {
            panels: &panels,
            size: self.size,
            accuracy,
            lengthwise: mirrors.contains(&0),
            symmetry: if mirrored { Symmetry::MirroredTwice } else { Symmetry::None },
        };
        let corners =
            self.with_sides(graph, |sides| pull_hydrostatics(sides, body, weights, adjoints))?;
        let of_sum = |corners: Vec<[Vec3; 4]>| {
            let mut vertices = vec![Vec3::zero(); mesh.positions().len()];
            for (&f, corners) in self.faces.iter().zip(corners) {
                for (&v, w) in mesh.faces()[f].iter().zip(corners) {
                    vertices[v as usize] += w;
                }
            }
            vertices
        };
        Some(corners.into_iter().map(of_sum).collect())
    }

    /// The patches of `mesh` that bound a body of [`Self::body`], each with its cells there.
    pub fn parts<T: Scalar>(
        &self,
        mesh: &Mesh<f64>,
        body: &Body<T>,
    ) -> Vec<(String, Range<usize>)> {
        let names = self.sides.iter().map(|side| side.name.to_string());
        let mut parts: Vec<_> = names.zip(body.side_cells()).collect();
        let first = parts.last().map_or(0, |(_, cells)| cells.end);
        let of_face = |k: usize| mesh.topology().patch_of(self.faces[k]);
        let mut start = 0;
        for end in 1..=self.faces.len() {
            if end == self.faces.len() || of_face(end) != of_face(start) {
                let name = mesh.patches()[of_face(start)].info.name.clone();
                parts.push((name, first + start..first + end));
                start = end;
            }
        }
        parts
    }

    /// True when a part of the skin is measured by panels.
    pub fn has_panels(&self) -> bool {
        !self.faces.is_empty()
    }
}

/// The shape of a side, by the name of its object.
fn shape<T: Scalar>(graph: &Graph<T>, name: &str, trimmed: bool) -> Option<SideShape<T>> {
    match graph.get(graph.find(name)?)?.value()? {
        Value::Surface(surface) if !trimmed => Some(SideShape::Whole(surface.clone())),
        Value::Body(facets) if trimmed => facets.border.clone().map(SideShape::Trimmed),
        _ => None,
    }
}

/// The measures of a surface object, or of a part of a surface within loops; `None` for other objects, and if it has no measures.
pub fn object_measures<T: Scalar>(
    graph: &Graph<T>,
    name: &str,
    accuracy: f64,
) -> Option<BodyMeasures<T>> {
    match shape(graph, name, false).or_else(|| shape(graph, name, true))? {
        SideShape::Whole(surface) => part_measures(&*surface, None, accuracy),
        SideShape::Trimmed(border) => {
            part_measures(&**border.0.surface(), Some(&loops(&border)), accuracy)
        }
    }
}

/// The loops of a part of a surface.
fn loops<T: Scalar>(border: &Border<T>) -> Vec<Vec<TrimCurve<'_, T>>> {
    let curves = border.0.curves();
    let of = |&(k, backwards): &(usize, bool)| TrimCurve { curve: &*curves[k].curve, backwards };
    border.0.cycles().iter().map(|cycle| cycle.iter().map(of).collect()).collect()
}

/// The edges (patch of the mesh, edge 0..4) all of whose intervals belong to another edge of the
/// skin too: there the surfaces are joined, even where counts contradict and the panels are not.
fn shared_edges(panelling: &Panelling, mesh: &Mesh<f64>) -> HashSet<(usize, u8)> {
    let meshed = panelling.structure.patches.iter().filter(|f| f.meshed).enumerate();
    let skin = meshed.filter(|(k, _)| mesh.patches()[*k].info.tag.is_skin());
    let edges: Vec<_> = skin
        .flat_map(|(k, frame)| {
            (0..4u8).map(move |n| ((k, n), frame.runs[usize::from(n)].intervals()))
        })
        .collect();
    let mut users: HashMap<u32, usize> = HashMap::new();
    edges
        .iter()
        .flat_map(|(_, intervals)| intervals)
        .for_each(|&i| *users.entry(i).or_default() += 1);
    let shared =
        |intervals: &[u32]| !intervals.is_empty() && intervals.iter().all(|i| users[i] > 1);
    edges.into_iter().filter(|(_, intervals)| shared(intervals)).map(|(edge, _)| edge).collect()
}
