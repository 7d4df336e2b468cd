//! The skin of a model as a body for measures: its surfaces, their orientation, and their open
//! edges.

use crate::panelling::Panelling;
use moldloft_hydro::{Body, HullSide};
use moldloft_mesh::{Closes, EdgeName, Mesh, OpenEdge, closure};
use moldloft_model::Graph;
use moldloft_num::Vec3;
use moldloft_registry::{Scalar, Value};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Surfaces and panels that bound the body; independent of the scalar.
#[derive(Clone, Debug)]
pub struct Skin {
    sides: Vec<SkinSide>,
    /// Faces of bodies of triangles, and of grids of very many pieces, which are their panels.
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
}

/// A surface of more pieces than this is measured on its panels.
const MOST_PIECES: usize = 2500;

impl Skin {
    /// The skin of a mesh that `panelling` made of `graph`: the patches that bound the body.
    /// `mirrors` are the axes normal to the model's planes of symmetry; edges open at these are not
    /// open.
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
        let mut in_parts: HashSet<usize> = HashSet::new();
        let shared = shared_edges(panelling, mesh);
        for (k, patch) in mesh.patches().iter().enumerate() {
            if !patch.info.tag.is_skin() {
                continue;
            }
            let pieces = |name: &Arc<str>| {
                let object = graph.get(graph.find(name)?)?;
                let Value::Surface(surface) = object.value()? else { return None };
                let [u, v] = surface.joints();
                Some((u.len() + 1) * (v.len() + 1))
            };
            let side = names.get(k).zip(patch.block.as_ref());
            let side = side.filter(|(name, _)| pieces(name).is_some_and(|n| n <= MOST_PIECES));
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
                    skin.sides.push(SkinSide { name, reversed, open_edges });
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

    /// The patches that are measured on their panels: they have no surface, or it has very many pieces.
    pub fn on_panels(&self) -> &[String] {
        &self.on_panels
    }

    /// The patches with an edge that nothing closes: neither a neighbour nor a mirror image.
    pub fn open(&self) -> &[String] {
        &self.open
    }

    /// True when nothing bounds a body.
    pub fn is_empty(&self) -> bool {
        self.sides.is_empty() && self.faces.is_empty()
    }

    /// The body with the scalar of `graph`; `None` if a surface has no value there, or one that is
    /// not finite.
    pub fn body<T: Scalar>(
        &self,
        panelling: &Panelling,
        graph: &Graph<T>,
        accuracy: f64,
    ) -> Option<Body<T>> {
        let surface = |side: &SkinSide| match graph.get(graph.find(&side.name)?)?.value()? {
            Value::Surface(surface) => Some(surface.clone()),
            _ => None,
        };
        let surfaces: Vec<_> = self.sides.iter().map(surface).collect::<Option<_>>()?;
        let sides: Vec<HullSide<'_, T>> = self
            .sides
            .iter()
            .zip(&surfaces)
            .map(|(side, surface)| HullSide {
                surface: &**surface,
                reversed: side.reversed,
                open_edges: side.open_edges,
            })
            .collect();
        let mut panels: Vec<[Vec3<T>; 4]> = Vec::new();
        let mut rims: Vec<Vec<Vec3<T>>> = Vec::new();
        if !self.faces.is_empty() || !self.rims.is_empty() {
            let mesh = panelling.mesh(graph)?;
            let at = |v: u32| mesh.positions()[v as usize];
            panels.extend(self.faces.iter().map(|&f| mesh.faces()[f].map(at)));
            rims.extend(self.rims.iter().map(|edge| edge.map(at).to_vec()));
        }
        Body::new(&sides, panels, rims, self.size, accuracy)
    }
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
