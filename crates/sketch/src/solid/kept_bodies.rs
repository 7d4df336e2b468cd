//! The bodies of a session that are kept between changes.

use super::outline::FacetDensity;
use crate::{DimensionLayout, SketchObject};
use moldloft_num::Real;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Maximum number of bodies that are kept.
const MAX_KEPT: usize = 256;

/// Maximum number of vertices of all of them.
const MAX_VERTICES: usize = 100_000;

/// A body, and of what it was made.
#[derive(Debug)]
pub(super) struct KeptBody<M> {
    pub object: Arc<SketchObject>,
    pub numbers: Vec<u64>,
    pub inherited: FacetDensity,
    /// The facets that it needed.
    pub own: FacetDensity,
    pub made: Option<Arc<M>>,
    /// Its number of vertices.
    pub size: usize,
}

impl<M> KeptBody<M> {
    fn is_of(&self, object: &Arc<SketchObject>, numbers: &[u64], inherited: &FacetDensity) -> bool {
        Arc::ptr_eq(&self.object, object) && self.numbers == numbers && self.inherited == *inherited
    }
}

/// The latest bodies of a session.
#[derive(Debug)]
pub(crate) struct KeptBodies<M>(Mutex<VecDeque<KeptBody<M>>>);

impl<M> Default for KeptBodies<M> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

/// The bits of all that a body of an object depends on.
pub(super) fn numbers<T: Real>(layout: &DimensionLayout<T>) -> Vec<u64> {
    let coordinates = layout.coordinates.iter().flatten();
    let coordinates = coordinates.map(|x| x.map_or(u64::MAX, |x| x.re().to_bits()));
    coordinates.chain(layout.values.values().map(|x| x.re().to_bits())).collect()
}

impl<M> KeptBodies<M> {
    /// The facets that an object needed, and its body.
    pub(super) fn find(
        &self,
        object: &Arc<SketchObject>,
        numbers: &[u64],
        inherited: &FacetDensity,
    ) -> Option<(FacetDensity, Option<Arc<M>>)> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let at = kept.iter().position(|k| k.is_of(object, numbers, inherited))?;
        let body = kept.remove(at)?;
        let found = (body.own.clone(), body.made.clone());
        kept.push_back(body);
        Some(found)
    }

    pub(super) fn keep(&self, body: KeptBody<M>) {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.retain(|k| !k.is_of(&body.object, &body.numbers, &body.inherited));
        kept.push_back(body);
        let mut vertices: usize = kept.iter().map(|k| k.size).sum();
        while kept.len() > MAX_KEPT || (vertices > MAX_VERTICES && kept.len() > 1) {
            vertices -= kept.pop_front().as_ref().map_or(0, |k| k.size);
        }
    }
}
