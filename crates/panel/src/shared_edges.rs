//! Common edges of patches, for writers of solids and of topology.

use crate::edges::along_edge;
use crate::panelling::Panelling;
use crate::patch_values::PatchValues;
use crate::topology::EdgeRun;
use moldloft_model::Graph;
use std::sync::Arc;

/// A part of an edge of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeStretch {
    /// Its number: edges with stretches of the same number coincide there.
    pub id: u32,
    /// True if the edge has the opposite direction to the stretch.
    pub backwards: bool,
    /// The range of the edge's parameter on the stretch, ascending.
    pub range: [f64; 2],
    /// The vertices of the mesh on it.
    pub vertices: [u32; 2],
}

/// An edge of a patch.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchEdge {
    /// The surface.
    pub patch: Arc<str>,
    /// Its edge, 0..4: v = 0, u = 1, v = 1, u = 0.
    pub edge: u8,
    /// Its stretches, in increasing parameter; empty for a pole.
    pub stretches: Vec<EdgeStretch>,
    /// The vertices of the mesh at the ends of the edge.
    pub vertices: [u32; 2],
}

impl Panelling {
    /// The edges of all patches with panels, four per patch, in the order of the topology's
    /// patches.
    ///
    /// Numbers of stretches are those of this panelling. An edge whose divisions contradict those
    /// of its neighbours, which is reported, has no stretches although it has a length.
    pub fn patch_edges(&self, graph: &Graph<f64>) -> Vec<PatchEdge> {
        let known = PatchValues::new(graph, &self.structure, &self.names);
        let mut all = Vec::new();
        for (patch, frame) in self.structure.patches.iter().enumerate().filter(|(_, f)| f.meshed) {
            let [nu, nv] = frame.divisions;
            for k in 0..4usize {
                let places: Vec<usize> = crate::draft::indices(frame.divisions, k as u8).collect();
                let vertex = |i: usize| self.joined.vertices[patch][places[i]];
                let count = if k % 2 == 0 { nu } else { nv };
                let run = match &frame.runs[k] {
                    EdgeRun::Same(other) => &frame.runs[usize::from(*other)],
                    own => own,
                };
                let mut stretches = Vec::new();
                if let (EdgeRun::Along(spans), Some(ts)) =
                    (run, along_edge(k, patch as u32, &known))
                {
                    let mut at = 0;
                    for (span, n) in spans {
                        let end = at + *n as usize;
                        if let Some(id) = span.interval {
                            stretches.push(EdgeStretch {
                                id,
                                backwards: span.backwards,
                                range: [ts[at], ts[end]],
                                vertices: [vertex(at), vertex(end)],
                            });
                        }
                        at = end;
                    }
                }
                all.push(PatchEdge {
                    patch: frame.name.clone(),
                    edge: k as u8,
                    stretches,
                    vertices: [vertex(0), vertex(count)],
                });
            }
        }
        all
    }
}
