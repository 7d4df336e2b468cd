//! The division of a box wherever the range of a set contains zero, down to blocks of cells.

use super::block::{Scratch, compute};
use super::grid::Grid;
use super::types::{FacetBlock, FacetOptions, Reuse, SIDE};
use crate::FieldError;
use crate::expr::interval::Interval;
use crate::expr::tape::ExprTape;
use crate::set::Leaf;
use moldloft_parallel::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The blocks that the surface may pass through, in a fixed order, with their pruned tapes.
pub(super) struct Divided {
    pub(super) blocks: Vec<(Arc<ExprTape<f64>>, Arc<FacetBlock>)>,
    /// Number of blocks computed; the others were reused.
    pub(super) computed: usize,
}

/// Bytes that a block with the surface takes until its triangles are a mesh: 60 000 were measured for spheres.
const BYTES: u64 = 60_000;

/// Fraction of cells with surface above which a block is rough. Beyond `MOST_ROUGH` such blocks the
/// waves of a set are smaller than the cells and triangles cannot represent them.
const ROUGH: f64 = 0.75;
const CELLS: usize = SIDE * SIDE * SIDE;
const MOST_ROUGH: usize = 128;

struct Division<'a> {
    grid: &'a Grid,
    leaves: &'a [Leaf],
    options: &'a FacetOptions,
    reuse: Option<&'a Reuse<'a>>,
    computed: AtomicUsize,
    active: AtomicUsize,
    rough: AtomicUsize,
}

/// Divides the grid wherever the range of the set contains zero, and computes the blocks there.
pub(super) fn divide(
    grid: &Grid,
    tape: &Arc<ExprTape<f64>>,
    leaves: &[Leaf],
    options: &FacetOptions,
    reuse: Option<&Reuse>,
) -> Result<Divided, FieldError> {
    let blocks = grid.cells.map(|n| n / SIDE);
    let size = blocks.into_iter().max().unwrap_or(1).next_power_of_two();
    let [computed, active, rough] = [0; 3].map(AtomicUsize::new);
    let division = Division { grid, leaves, options, reuse, computed, active, rough };
    let mut out = Vec::new();
    // Leaves of the division in the order of the tree; the first levels alone, then in parallel.
    let mut front = vec![([0usize; 3], size, tape.clone())];
    while let Some(&(_, size, _)) = front.first() {
        let last = size == 1;
        // About half of the parts of a node that holds the surface hold it, too.
        let expected = front.len() as u64 * if last { 1 } else { 4 } / 2;
        if size <= 2 {
            options.budget.grow(expected * BYTES)?;
        }
        let next: Vec<Result<_, FieldError>> = front
            .par_chunks(8)
            .map_init(Scratch::default, |scratch, nodes| {
                let mut room = Vec::new();
                let (mut deeper, mut done) = (Vec::new(), Vec::new());
                for (at, size, tape) in nodes {
                    let Some(tape) = division.surface_in(*at, *size, tape, &mut room)? else {
                        continue;
                    };
                    if last {
                        done.extend(division.block(*at, tape, scratch)?);
                    } else {
                        deeper.extend(
                            children(*at, size / 2, blocks).map(|c| (c, size / 2, tape.clone())),
                        );
                    }
                }
                Ok((deeper, done))
            })
            .collect();
        front = Vec::new();
        for part in next {
            let (deeper, done) = part?;
            front.extend(deeper);
            out.extend(done);
        }
    }
    Ok(Divided { blocks: out, computed: division.computed.into_inner() })
}

/// The halves of a node within the grid, by their low corners.
fn children(at: [usize; 3], half: usize, blocks: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..8)
        .map(move |c| {
            [at[0] + (c >> 2) * half, at[1] + (c >> 1 & 1) * half, at[2] + (c & 1) * half]
        })
        .filter(move |c| (0..3).all(|k| c[k] < blocks[k]))
}

impl Division<'_> {
    /// The tape for a node of `size` blocks, or `None` when it is all solid or all air.
    fn surface_in(
        &self,
        at: [usize; 3],
        size: usize,
        tape: &Arc<ExprTape<f64>>,
        room: &mut Vec<Interval>,
    ) -> Result<Option<Arc<ExprTape<f64>>>, FieldError> {
        self.options.budget.poll()?;
        let low = at.map(|x| x * SIDE);
        let high = [0, 1, 2].map(|k| (low[k] + size * SIDE).min(self.grid.cells[k]));
        let range = tape.range(&self.grid.sides(low, high), room);
        if range.low > 0.0 || range.high < 0.0 {
            return Ok(None);
        }
        Ok(Some(tape.pruned(room).map_or_else(|| tape.clone(), Arc::new)))
    }

    fn block(
        &self,
        at: [usize; 3],
        tape: Arc<ExprTape<f64>>,
        scratch: &mut Scratch,
    ) -> Result<Option<(Arc<ExprTape<f64>>, Arc<FacetBlock>)>, FieldError> {
        let at = at.map(|x| x as u32);
        if let Some(old) = self.reuse.and_then(|reuse| reuse.get(at, &tape)) {
            return Ok(Some((tape, old)));
        }
        // An error ends the work on all threads.
        if self.rough.load(Ordering::Relaxed) > MOST_ROUGH {
            return Err(self.too_rough());
        }
        self.computed.fetch_add(1, Ordering::Relaxed);
        let block = compute(self.grid, at, &tape, self.leaves, scratch)
            .map_err(|at| FieldError::NoValue { at })?;
        let active = self.active.fetch_add(block.active, Ordering::Relaxed) + block.active;
        if active as f64 > self.options.limit {
            return Err(FieldError::TooFine { boxes: active as f64, limit: self.options.limit });
        }
        if block.active as f64 > ROUGH * CELLS as f64
            && self.rough.fetch_add(1, Ordering::Relaxed) >= MOST_ROUGH
        {
            return Err(self.too_rough());
        }
        Ok(Some((tape, Arc::new(block))))
    }

    fn too_rough(&self) -> FieldError {
        FieldError::TooRough { cells: CELLS * MOST_ROUGH, step: self.grid.step }
    }
}
