//! The faces of a model with the loops that bound them, as boundary representations need them: sides by the
//! numbers of their vertices, which are one by identity, and by their parameters.

use crate::border_curves::border;
use crate::edges::along_edge;
use crate::panelling::Panelling;
use crate::patch_values::PatchValues;
use crate::triangle_bodies::MeshedBody;
use moldloft_model::Graph;
use moldloft_registry::{CurveRef, SurfaceRef};
use std::sync::Arc;

/// A face: a surface and the loops that bound its visible part.
#[derive(Clone, Debug)]
pub struct FaceOutline {
    /// The name of its object.
    pub name: Arc<str>,
    /// Index of a palette colour.
    pub colour: i32,
    /// Its tags.
    pub tags: Vec<Arc<str>>,
    /// The surface.
    pub surface: SurfaceRef<f64>,
    /// True when its panels face against the natural normal.
    pub reversed: bool,
    /// The loops, the outer one first, with consecutive sides.
    pub loops: Vec<Vec<OutlineSide>>,
}

/// A side of a loop.
#[derive(Clone, Debug)]
pub struct OutlineSide {
    /// Curve of the side.
    pub along: OutlineCurve,
    /// True if the loop has the opposite direction.
    pub backwards: bool,
    /// The vertices of the mesh on the side, by increasing parameter.
    pub vertices: Vec<u32>,
    /// The parameters of these vertices, from 0 to 1.
    pub at: Vec<f64>,
}

/// Curve of a side.
#[derive(Clone, Debug)]
pub enum OutlineCurve {
    /// Edge 0..4 of the surface: v = 0, u = 1, v = 1, u = 0.
    Edge(u8),
    /// A snake on the surface.
    Snake(CurveRef<f64>),
}

impl Panelling {
    /// The faces of all shown surfaces and trimmed sheets, in the order of the mesh's patches, and
    /// the names of bodies of triangles without surfaces; `None` when a surface has no value.
    pub fn outlines(&self, graph: &Graph<f64>) -> Option<(Vec<FaceOutline>, Vec<Arc<str>>)> {
        let known = PatchValues::new(graph, &self.structure, &self.names);
        let mut faces = Vec::new();
        for (patch, frame) in self.structure.patches.iter().enumerate().filter(|(_, f)| f.meshed) {
            let side = |k: usize| {
                let indices = crate::draft::indices(frame.divisions, k as u8);
                Some(OutlineSide {
                    along: OutlineCurve::Edge(k as u8),
                    backwards: k > 1,
                    vertices: indices.map(|at| self.joined.vertices[patch][at]).collect(),
                    at: along_edge(k, patch as u32, &known)?,
                })
            };
            faces.push(FaceOutline {
                name: frame.name.clone(),
                colour: frame.colour,
                tags: frame.tags.clone(),
                surface: known.surfaces[patch].clone()?,
                reversed: self.joined.turned[patch],
                loops: vec![vec![side(0)?, side(1)?, side(2)?, side(3)?]],
            });
        }
        let mut others = Vec::new();
        for body in self.bodies.iter() {
            match trimmed(body, graph) {
                Some(face) => faces.push(face),
                None => others.push(body.name.clone()),
            }
        }
        Some((faces, others))
    }
}

/// The face of a trimmed sheet.
fn trimmed(body: &MeshedBody, graph: &Graph<f64>) -> Option<FaceOutline> {
    let border = border(graph.get(graph.find(&body.name)?)?)?;
    if body.divided.len() != border.curves().len() {
        return None;
    }
    let side = |&(curve, backwards): &(usize, bool)| OutlineSide {
        along: OutlineCurve::Snake(border.curves()[curve].curve.clone()),
        backwards,
        vertices: body.border_vertices[curve].iter().map(|&v| body.vertices[v as usize]).collect(),
        at: body.divided[curve].clone(),
    };
    Some(FaceOutline {
        name: body.name.clone(),
        colour: body.colour,
        tags: body.tags.clone(),
        surface: border.surface().clone(),
        reversed: body.reversed,
        loops: border.cycles().iter().map(|cycle| cycle.iter().map(side).collect()).collect(),
    })
}
