//! Work on all threads: Rayon's, on a pool that belongs to this process; or in a page, which has one thread, plain
//! iterators of the same names.
//!
//! Threads do not survive `fork`, which is how `multiprocessing` starts processes on Linux up to Python 3.13: a child that
//! waited for its parent's pool would wait for ever. So every loop ends in `pool::in_pool`, and no other crate calls Rayon.
//!
//! Rayon without threads would work too, but its generic code, instantiated for each closure, is a
//! fortieth of the page's engine. Methods of Rayon used by a crate must exist in both `many` and
//! `single`.
//!
//! ```
//! use moldloft_parallel::prelude::*;
//!
//! let squares: Vec<u64> = (0..4u64).into_par_iter().map(|k| k * k).collect();
//! assert_eq!(squares, [0, 1, 4, 9]);
//! ```

#[cfg(not(target_family = "wasm"))]
pub mod many;
#[cfg(not(target_family = "wasm"))]
mod pool;
#[cfg(any(target_family = "wasm", test))]
pub mod single;

#[cfg(not(target_family = "wasm"))]
pub use many as prelude;
#[cfg(target_family = "wasm")]
pub use single as prelude;

#[cfg(not(target_family = "wasm"))]
pub use pool::{is_alone, on_one_thread};

#[cfg(test)]
mod tests {
    /// Each result by both sets of traits.
    macro_rules! both {
        ($work:block) => {{
            let one = {
                use super::single::*;
                $work
            };
            let many = {
                use super::many::*;
                $work
            };
            assert_eq!(one, many);
            one
        }};
    }

    #[test]
    fn one_thread_gives_what_many_give() {
        let numbers: Vec<u32> = (0..1000).map(|k| k * 7919 % 1009).collect();
        let sum = both!({
            let parts: Vec<u32> =
                numbers.par_chunks(64).map(|part| part.iter().sum::<u32>()).collect();
            parts
        });
        assert_eq!(sum.len(), 16);
        both!({
            let found: Vec<u32> = numbers
                .par_iter()
                .with_min_len(16)
                .zip(&numbers)
                .map_init(Vec::new, |room, (a, b)| {
                    room.clear();
                    room.extend([*a, *b]);
                    room.iter().sum()
                })
                .collect();
            found
        });
        both!({
            let found: Vec<usize> =
                (0..40usize).into_par_iter().flat_map_iter(|k| (0..k).rev()).collect();
            found
        });
        both!({
            let mut all = numbers.clone();
            all.par_sort_unstable();
            all.par_iter_mut().for_each(|x| *x += 1);
            all.par_chunks_mut(3).enumerate().for_each(|(k, part)| part[0] += k as u32);
            all
        });
    }
}
