//! Sums whose bits do not depend on the number of threads.

use moldloft_parallel::prelude::*;
use std::ops::Range;

/// Terms per chunk; part of the result's bits, so it is a constant and not a tuning knob.
const CHUNK: usize = 1024;

/// Below this many chunks the work is done on the calling thread; the bits are the same.
const PARALLEL_CHUNKS: usize = 8;

/// Sums `term(first..last)` over fixed chunks of `range`, each summed in order, the chunk sums added
/// in order.
pub(crate) fn chunked_sum<A: Send>(
    range: Range<usize>,
    zero: impl Fn() -> A + Sync,
    term: impl Fn(&mut A, usize) + Sync,
    add: impl Fn(&mut A, A),
) -> A {
    let chunks = range.len().div_ceil(CHUNK);
    let one = |c: usize| {
        let first = range.start + c * CHUNK;
        let mut sum = zero();
        for k in first..(first + CHUNK).min(range.end) {
            term(&mut sum, k);
        }
        sum
    };
    let mut total = zero();
    if chunks < PARALLEL_CHUNKS {
        (0..chunks).for_each(|c| add(&mut total, one(c)));
    } else {
        let parts: Vec<A> = (0..chunks).into_par_iter().map(one).collect();
        parts.into_iter().for_each(|part| add(&mut total, part));
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_bits_on_any_number_of_threads() {
        let sum = || {
            chunked_sum(
                3..100_000,
                || 0.0,
                |s: &mut f64, k| *s += 1.0 / k as f64,
                |s, part| *s += part,
            )
        };
        let bits: Vec<u64> = [1, 2, 3]
            .into_iter()
            .map(|n| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
                pool.install(sum).to_bits()
            })
            .collect();
        assert!(bits.iter().all(|&b| b == bits[0]));
    }
}
