//! Bodies that are kept: a body is a function of an object and the values of its numbers, and most operands of a feature
//! do not change with it.

use super::SketchSolid;
use super::feature::NoBody;
use crate::{DimensionLayout, SketchObject};
use moldloft_num::Real;
use std::any::Any;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Maximum number of bodies that are kept.
const MAX_KEPT: usize = 64;

/// Maximum number of vertices of all of them.
const MAX_VERTICES: usize = 100_000;

type Made = Result<SketchSolid<f64>, NoBody>;

/// A body, and of what it was made.
#[derive(Debug)]
struct KeptBody {
    object: Arc<SketchObject>,
    numbers: Vec<u64>,
    made: Arc<Made>,
}

/// The latest bodies of a session.
#[derive(Debug, Default)]
pub(crate) struct KeptBodies(Mutex<VecDeque<KeptBody>>);

/// The bits of all that a body of an object depends on.
fn numbers(layout: &DimensionLayout<f64>) -> Vec<u64> {
    let coordinates = layout.coordinates.iter().flatten();
    let coordinates = coordinates.map(|x| x.map_or(u64::MAX, f64::to_bits));
    coordinates.chain(layout.values.values().map(|x| x.to_bits())).collect()
}

impl KeptBodies {
    /// The body of an object, made if it is not kept. Bodies with derivatives are not.
    pub fn get<T: Real>(
        &self,
        object: &Arc<SketchObject>,
        layout: &DimensionLayout<T>,
        make: impl FnOnce() -> Result<SketchSolid<T>, NoBody>,
    ) -> Result<SketchSolid<T>, NoBody> {
        let Some(plain) = (layout as &dyn Any).downcast_ref::<DimensionLayout<f64>>() else {
            return make();
        };
        let numbers = numbers(plain);
        let same = |k: &KeptBody| Arc::ptr_eq(&k.object, object) && k.numbers == numbers;
        let found = {
            let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            let at = kept.iter().position(same);
            at.and_then(|at| kept.remove(at)).map(|body| {
                let made = Arc::clone(&body.made);
                kept.push_back(body);
                made
            })
        };
        if let Some(known) = found.as_deref().and_then(|m| (m as &dyn Any).downcast_ref()) {
            return Result::clone(known);
        }
        let made: Result<SketchSolid<T>, NoBody> = make();
        if let Some(plain) = (&made as &dyn Any).downcast_ref::<Made>() {
            let made = Arc::new(plain.clone());
            let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            kept.push_back(KeptBody { object: Arc::clone(object), numbers, made });
            let size = |k: &KeptBody| k.made.as_ref().as_ref().map_or(1, |b| b.vertices.len());
            let mut vertices: usize = kept.iter().map(size).sum();
            while kept.len() > MAX_KEPT || (vertices > MAX_VERTICES && kept.len() > 1) {
                vertices -= kept.pop_front().as_ref().map_or(0, size);
            }
        }
        made
    }
}
