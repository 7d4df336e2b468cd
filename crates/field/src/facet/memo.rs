//! Cache of recent facets: equal requests return them, similar ones reuse their blocks.
//!
//! This changes no result: [`crate::refacet`] gives the same bits whatever it takes over.

use super::{FacetOptions, Facets, Resolution, refacet};
use crate::{FieldError, Set};
use moldloft_num::Box3;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

struct MemoEntry {
    set: Set,
    over: Box3,
    resolution: Resolution,
    sharp: bool,
    facets: Arc<Facets>,
}

/// Maximum number of cached facets, and of their cells in total.
const MOST: usize = 12;
const MOST_CELLS: usize = 1_500_000;

/// The facets computed last for a model.
#[derive(Default)]
pub struct FacetMemo(Mutex<VecDeque<MemoEntry>>);

fn same_box(a: &Box3, b: &Box3) -> bool {
    a.low.bits_eq(b.low) && a.high.bits_eq(b.high)
}

impl FacetMemo {
    /// As [`crate::facet`].
    ///
    /// # Errors
    /// As [`crate::facet`].
    pub fn facet(
        &self,
        set: &Set,
        over: &Box3,
        options: &FacetOptions,
    ) -> Result<Arc<Facets>, FieldError> {
        let mut before = None;
        {
            let entries = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            let alike = |k: &&MemoEntry| {
                let same = k.resolution == options.resolution && k.sharp == options.sharp;
                same && same_box(&k.over, over)
            };
            // The latest first: it is the most alike.
            for entry in entries.iter().rev().filter(alike) {
                if entry.set.same(set) {
                    return Ok(entry.facets.clone());
                }
                before = before.or_else(|| Some(entry.facets.clone()));
            }
        }
        let facets = Arc::new(refacet(set, over, options, before.as_deref())?);
        let mut entries = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        entries.push_back(MemoEntry {
            set: set.clone(),
            over: *over,
            resolution: options.resolution,
            sharp: options.sharp,
            facets: facets.clone(),
        });
        let cells = |all: &VecDeque<MemoEntry>| all.iter().map(|k| k.facets.cells).sum::<usize>();
        while entries.len() > MOST || entries.len() > 1 && cells(&entries) > MOST_CELLS {
            entries.pop_front();
        }
        Ok(facets)
    }
}
