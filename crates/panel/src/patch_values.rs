//! Values of a graph, of any scalar, for the patches of a topology: surfaces, edges, the points
//! that divide them; and the vertices of each patch.

use crate::border_curves;
use crate::draft::surface_of;
use crate::edges::{EdgePlan, PatchLookup, PatchParameters, along_edge, evaluated};
use crate::identity::{AliasStep, PartEnd, on_part};
use crate::knuckles::{ASIDE, rate_across};
use crate::roots::{AliasId, EdgeParameter, MarkSource, on_its_root};
use crate::topology::{PanelTopology, PatchTopology};
use moldloft_model::Graph;
use moldloft_num::Vec3;
use moldloft_num::period::crease_rate;
use moldloft_num::trace::{Edges, Key};
use moldloft_parallel::prelude::*;
use moldloft_registry::{Point, Scalar, SurfaceRef, Value};
use std::collections::HashMap;
use std::sync::Arc;

/// Patches of fewer points than this are evaluated on the calling thread.
const WORTH_A_THREAD: usize = 4096;

/// The points of each patch, evaluated with the scalar of `graph`; those in `kept` are reused.
pub(crate) fn evaluated_all<T: Scalar>(
    structure: &PanelTopology,
    names: &HashMap<Key, Arc<str>>,
    graph: &Graph<T>,
    kept: impl Fn(usize) -> Option<Arc<Vec<Vec3<T>>>> + Sync,
) -> Vec<Option<Arc<Vec<Vec3<T>>>>> {
    let known = PatchValues::new(graph, structure, names);
    let one = |patch: usize| {
        if let Some(points) = kept(patch) {
            return Some(points);
        }
        let surface = known.surfaces[patch].as_ref()?;
        if graph.budget().is_spent() {
            return None;
        }
        let edge = |k: usize| along_edge(k, patch as u32, &known);
        let edges = [edge(0)?, edge(1)?, edge(2)?, edge(3)?];
        let parameters = PatchParameters::of(surface, &structure.patches[patch], &edges);
        Some(Arc::new(evaluated(surface, &parameters)))
    };
    let count = structure.patches.len();
    let points = |f: &PatchTopology| (f.divisions[0] + 1) * (f.divisions[1] + 1);
    if count < 2 || structure.patches.iter().map(points).sum::<usize>() < WORTH_A_THREAD {
        return (0..count).map(one).collect();
    }
    (0..count).into_par_iter().map(one).collect()
}

/// The names of the point objects that plans of edges refer to, and of the joins of aliases.
pub(crate) fn names(graph: &Graph<f64>, structure: &PanelTopology) -> HashMap<Key, Arc<str>> {
    let mut names = HashMap::new();
    let mut add = |key: Key| {
        if let Some(object) = graph.get(key) {
            names.insert(key, object.name.clone());
        }
    };
    for step in structure.aliases.iter().flatten() {
        match step {
            AliasStep::Turned => {}
            AliasStep::Part { join, .. } => add(*join),
            AliasStep::Between(ends) => ends.iter().for_each(|end| {
                if let PartEnd::Point { point, .. } = end {
                    add(*point);
                }
            }),
        }
    }
    for plan in structure.patches.iter().flat_map(|f| &f.plans) {
        let EdgePlan::Segments(segments) = plan else { continue };
        for segment in segments {
            if let EdgeParameter::Inside(_, source, _) = segment.until
                && let MarkSource::Bead { point: key, .. } | MarkSource::Magnet { point: key, .. } =
                    source
            {
                add(key);
            }
        }
    }
    names
}

/// Values of a graph, of any scalar, for the patches of a skeleton.
pub(crate) struct PatchValues<'a, T: Scalar> {
    pub graph: &'a Graph<T>,
    pub structure: &'a PanelTopology,
    names: &'a HashMap<Key, Arc<str>>,
    keys: Vec<Option<Key>>,
    pub surfaces: Vec<Option<SurfaceRef<T>>>,
    edges: Vec<Option<Edges<T>>>,
}

impl<'a, T: Scalar> PatchValues<'a, T> {
    pub fn new(
        graph: &'a Graph<T>,
        structure: &'a PanelTopology,
        names: &'a HashMap<Key, Arc<str>>,
    ) -> Self {
        let keys: Vec<Option<Key>> =
            structure.patches.iter().map(|f| graph.find(&f.name)).collect();
        let surface = |(key, frame): (&Option<Key>, &PatchTopology)| {
            let object = graph.get((*key)?)?;
            match frame.border_curve {
                Some(border_curve) => border_curves::line(
                    border_curves::border(object)?.curves().get(border_curve as usize)?,
                ),
                None => surface_of(object).cloned(),
            }
        };
        let surfaces: Vec<_> = keys.iter().zip(&structure.patches).map(surface).collect();
        let edges = surfaces.iter().map(|s| Some(s.as_ref()?.edges())).collect();
        Self { graph, structure, names, keys, surfaces, edges }
    }

    /// No values, for uses that need none.
    pub fn empty(
        graph: &'a Graph<T>,
        structure: &'a PanelTopology,
        names: &'a HashMap<Key, Arc<str>>,
    ) -> Self {
        Self { graph, structure, names, keys: vec![], surfaces: vec![], edges: vec![] }
    }

    /// The parameter, on its root, of the end of a part.
    fn part_end(&self, end: PartEnd) -> Option<T> {
        Some(match end {
            PartEnd::Begin => T::zero(),
            PartEnd::End => T::one(),
            PartEnd::Point { point, turned, .. } => {
                let t = on_its_root(PatchLookup::point(self, point)?, end.source()?)?;
                if turned { -t + 1.0 } else { t }
            }
        })
    }
}

impl<T: Scalar> PatchLookup<T> for PatchValues<'_, T> {
    fn plans(&self, draft: u32) -> &[EdgePlan; 4] {
        &self.structure.patches[draft as usize].plans
    }

    fn edges(&self, draft: u32) -> Option<&Edges<T>> {
        self.edges[draft as usize].as_ref()
    }

    fn owner(&self, draft: u32) -> Key {
        self.keys[draft as usize].unwrap_or(Key(u32::MAX))
    }

    fn point(&self, key: Key) -> Option<&Point<T>> {
        let object = self.graph.get(self.graph.find(self.names.get(&key)?)?)?;
        match object.value()? {
            Value::Point(point) => Some(point),
            _ => None,
        }
    }

    fn alias_ends(&self, alias: AliasId) -> Option<[T; 2]> {
        let mut ends = [T::zero(), T::one()];
        for step in self.structure.aliases.get(alias as usize)? {
            match step {
                AliasStep::Turned => ends = ends.map(|t| -t + 1.0),
                AliasStep::Part { join, edge } => {
                    let object = self.graph.get(self.graph.find(self.names.get(join)?)?)?;
                    let Value::Curve(curve) = object.value()? else { return None };
                    let part = &curve.joins.as_ref()?.edges[usize::from(*edge)];
                    let piece = part.pieces().first().copied()?;
                    ends = ends.map(|t| on_part([piece.from.t, piece.to.t], t));
                }
                AliasStep::Between([from, to]) => {
                    let part = [self.part_end(*from)?, self.part_end(*to)?];
                    ends = ends.map(|t| on_part(part, t));
                }
            }
        }
        Some(ends)
    }

    fn knuckle_rate(&self, draft: u32, k: usize, at: f64) -> Option<T> {
        let surface = self.surfaces[draft as usize].as_ref()?;
        let knuckles = self.structure.patches[draft as usize].knuckles.as_deref();
        if !knuckles.is_some_and(|knuckles| knuckles.is_across(k, at)) {
            return Some(crease_rate(&**surface, k % 2, at, [ASIDE; 2]));
        }
        let across = if k == 1 || k == 2 { 1.0 } else { 0.0 };
        let (place, along) = if k.is_multiple_of(2) {
            ([at, across], [1.0, 0.0])
        } else {
            ([across, at], [0.0, 1.0])
        };
        Some(rate_across(&**surface, place.map(T::from), along.map(T::from)))
    }
}
