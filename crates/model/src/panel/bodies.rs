//! Bodies of triangles among the panels: they come as they are, joined to nothing.

use super::Panelling;
use crate::Graph;
use moldloft_mesh::{MeshError, PatchInfo, Tag, Topology, TopologyBuilder};
use moldloft_num::Vec3;
use moldloft_registry::{Facets, Scalar, Value};
use std::sync::Arc;

/// A shown object that is a body.
#[derive(Clone, Debug)]
pub(super) struct Body {
    name: Arc<str>,
    kind: Arc<str>,
    colour: i32,
    reversed: bool,
    facets: Arc<Facets<f64>>,
}

/// The shown bodies in the order of declaration.
pub(super) fn bodies(graph: &Graph<f64>) -> Vec<Body> {
    let shown = graph.objects().filter(|o| o.head.shown());
    shown
        .filter_map(|object| {
            let Some(Value::Mesh(facets)) = object.value() else { return None };
            Some(Body {
                name: object.name.clone(),
                kind: object.row.name.as_ref().into(),
                colour: object.head.colour,
                reversed: object.head.orientation == 1,
                facets: facets.clone(),
            })
        })
        .collect()
}

/// A topology and the bodies after it.
pub(super) fn with_bodies(base: &Topology, bodies: &[Body]) -> Result<Arc<Topology>, MeshError> {
    let mut builder = TopologyBuilder::extending(base.clone());
    for body in bodies {
        body.add(&mut builder)?;
    }
    Ok(builder.build().into())
}

impl Body {
    /// True when it makes the same panels.
    pub fn is_like(&self, o: &Body) -> bool {
        let heads = (self.colour, self.reversed) == (o.colour, o.reversed);
        heads
            && (&self.name, &self.kind) == (&o.name, &o.kind)
            && self.facets.points.len() == o.facets.points.len()
            && self.facets.triangles == o.facets.triangles
            && self.facets.groups == o.facets.groups
    }

    /// How many panels it has.
    pub fn panels(&self) -> u64 {
        self.facets.triangles.len() as u64
    }

    /// Adds its vertices and panels.
    fn add(&self, builder: &mut TopologyBuilder) -> Result<(), MeshError> {
        let start = builder.add_vertices(self.facets.points.len())?.start;
        let info = PatchInfo {
            name: self.name.to_string(),
            tag: Tag::Wetted,
            colour: Some((self.colour & 15) as u8),
            kind: self.kind.to_string(),
            ..PatchInfo::default()
        };
        let turned = |[a, b, c]: [u32; 3]| if self.reversed { [c, b, a] } else { [a, b, c] };
        let face = |t: &[u32; 3]| {
            let [a, b, c] = turned(*t).map(|v| v + start);
            [a, b, c, c]
        };
        if self.facets.groups.is_empty() {
            return builder.add_faces(info, self.facets.triangles.iter().map(face));
        }
        for group in &self.facets.groups {
            let own = PatchInfo {
                name: format!("{}.{}", self.name, group.name),
                kind: group.kind.clone(),
                colour: group.colour.or(info.colour),
                ..info.clone()
            };
            let triangles = &self.facets.triangles[group.triangles.clone()];
            builder.add_faces(own, triangles.iter().map(face))?;
        }
        Ok(())
    }
}

impl Panelling {
    /// The vertices of the bodies, evaluated with the scalar of `graph`; `None` when one has no value
    /// there, or other triangles.
    pub(super) fn body_points<T: Scalar>(&self, graph: &Graph<T>) -> Option<Vec<Vec3<T>>> {
        let mut points = Vec::new();
        for body in self.bodies.iter() {
            let object = graph.get(graph.find(&body.name)?)?;
            let Some(Value::Mesh(facets)) = object.value() else { return None };
            if facets.points.len() != body.facets.points.len() {
                return None;
            }
            points.extend_from_slice(&facets.points);
        }
        Some(points)
    }

    /// The same at the state that the panelling was made of.
    pub(super) fn own_body_points(&self) -> Vec<Vec3> {
        self.bodies.iter().flat_map(|b| b.facets.points.iter().copied()).collect()
    }
}
