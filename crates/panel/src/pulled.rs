//! Reverse differentiation of panels: weights of vertices become weights of what the surfaces are made of.
//!
//! `weights (dJ/dvertex) -> owners -> patch by patch: record some points, add, pull, forget -> Adjoints of the graph's nodes`
//!
//! So a tape holds the graph, and of the vertices a few thousand at a time.

use crate::edges::{PatchParameters, along_edge, evaluated_in_parts};
use crate::panelling::Panelling;
use crate::patch_values::PatchValues;
use moldloft_model::Graph;
use moldloft_num::{Adjoints, DerivativeTape, Rev, Vec3};
use std::ops::Range;

/// Number of points that are recorded together: their tape stays in the cache.
const PART: usize = 2048;

impl Panelling {
    /// Adds the derivatives of weighted sums of the vertices with respect to the nodes of this
    /// thread's tape, on which `graph` was recorded; there is one of `weights` and `adjoints` for
    /// each sum. Nodes recorded before are kept ([`DerivativeTape::keep`]); nothing can be recorded
    /// afterwards.
    ///
    /// `None` when a surface has no value there, or another one than the panelling was made of.
    pub fn pull(
        &self,
        graph: &Graph<Rev>,
        weights: &[Vec<Vec3>],
        adjoints: &mut [Adjoints],
    ) -> Option<()> {
        if !self.bodies.is_empty() {
            return self.pull_at_once(graph, weights, adjoints);
        }
        let known = PatchValues::new(graph, &self.structure, &self.names);
        let owned = self.owned(weights);
        let parameters = |patch: usize| {
            let edge = |k: usize| along_edge(k, patch as u32, &known);
            let edges = [edge(0)?, edge(1)?, edge(2)?, edge(3)?];
            let surface = known.surfaces[patch].as_ref()?;
            Some(PatchParameters::of(surface, &self.structure.patches[patch], &edges))
        };
        // Marks on edges are nodes that several parts of a patch refer to.
        let parameters: Option<Vec<_>> =
            owned.iter().map(|(patch, _)| parameters(*patch)).collect();
        DerivativeTape::keep();
        for ((patch, owned), parameters) in owned.iter().zip(parameters?) {
            graph.budget().poll().ok()?;
            let plain = self.own_points(*patch);
            let of = |range: Range<usize>| {
                let at = |k: usize| owned.partition_point(|(at, _)| *at < k);
                &owned[at(range.start)..at(range.end)]
            };
            let mut same = true;
            let wanted = |range: Range<usize>| !of(range).is_empty();
            let surface = known.surfaces[*patch].as_ref()?;
            evaluated_in_parts(surface, &parameters, PART, wanted, |first, points| {
                same &= points.iter().zip(&plain[first..]).all(|(p, plain)| p.re() == *plain);
                for (weights, adjoints) in weights.iter().zip(adjoints.iter_mut()) {
                    for &(at, vertex) in of(first..first + points.len()) {
                        add(adjoints, points[at - first], weights[vertex]);
                    }
                    adjoints.pull_local();
                }
                DerivativeTape::forget();
            });
            if !same {
                return None;
            }
        }
        Some(())
    }

    /// The patches with the points that give a vertex of some weight its position, and that vertex; in order.
    fn owned(&self, weights: &[Vec<Vec3>]) -> Vec<(usize, Vec<(usize, usize)>)> {
        let mut owners = vec![(0, 0); self.topology().vertex_count()];
        self.for_each_place(|vertex, patch, at| owners[vertex] = (patch, at));
        let mut owned: Vec<(usize, Vec<(usize, usize)>)> =
            (0..self.structure.patches.len()).map(|patch| (patch, Vec::new())).collect();
        for (vertex, (patch, at)) in owners.into_iter().enumerate() {
            if weights.iter().any(|weights| weights[vertex] != Vec3::zero()) {
                owned[patch].1.push((at, vertex));
            }
        }
        owned.retain(|(_, owned)| !owned.is_empty());
        owned.iter_mut().for_each(|(_, owned)| owned.sort_unstable());
        owned
    }

    /// [`Self::pull`] with all vertices in one recording: bodies of triangles take points of the patches.
    fn pull_at_once(
        &self,
        graph: &Graph<Rev>,
        weights: &[Vec<Vec3>],
        adjoints: &mut [Adjoints],
    ) -> Option<()> {
        let positions = self.positions(graph)?;
        let plain = self.own_mesh()?;
        if !positions.iter().zip(plain.positions()).all(|(p, plain)| p.re() == *plain) {
            return None;
        }
        for (weights, adjoints) in weights.iter().zip(adjoints) {
            positions.iter().zip(weights).for_each(|(p, w)| add(adjoints, *p, *w));
        }
        Some(())
    }
}

fn add(adjoints: &mut Adjoints, p: Vec3<Rev>, weight: Vec3) {
    for axis in 0..3 {
        adjoints.add(p[axis], weight[axis]);
    }
}
