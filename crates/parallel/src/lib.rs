//! Work on all threads: Rayon's, or in a page, which has one thread, plain iterators of the same names.
//!
//! Rayon without threads is right as well, but its plumbing, made anew for each closure, is a fortieth of the page's engine.
//! What a crate uses of Rayon must stand in `single` too.
//!
//! ```
//! use moldloft_parallel::prelude::*;
//!
//! let squares: Vec<u64> = (0..4u64).into_par_iter().map(|k| k * k).collect();
//! assert_eq!(squares, [0, 1, 4, 9]);
//! ```

#[cfg(not(target_family = "wasm"))]
pub use rayon::prelude;

#[cfg(target_family = "wasm")]
pub use single as prelude;

/// The traits, for one thread.
#[cfg(any(target_family = "wasm", test))]
pub mod single {
    /// `into_par_iter`.
    pub trait IntoParallelIterator: IntoIterator + Sized {
        /// Its iterator.
        fn into_par_iter(self) -> Self::IntoIter {
            self.into_iter()
        }
    }

    impl<I: IntoIterator> IntoParallelIterator for I {}

    /// Methods of slices.
    pub trait ParallelSlice<T> {
        /// `iter`.
        fn par_iter(&self) -> std::slice::Iter<'_, T>;
        /// `chunks`.
        fn par_chunks(&self, size: usize) -> std::slice::Chunks<'_, T>;
    }

    impl<T> ParallelSlice<T> for [T] {
        fn par_iter(&self) -> std::slice::Iter<'_, T> {
            self.iter()
        }
        fn par_chunks(&self, size: usize) -> std::slice::Chunks<'_, T> {
            self.chunks(size)
        }
    }

    /// Methods of slices that change.
    pub trait ParallelSliceMut<T> {
        /// `iter_mut`.
        fn par_iter_mut(&mut self) -> std::slice::IterMut<'_, T>;
        /// `chunks_mut`.
        fn par_chunks_mut(&mut self, size: usize) -> std::slice::ChunksMut<'_, T>;
        /// `sort_unstable`.
        fn par_sort_unstable(&mut self)
        where
            T: Ord;
    }

    impl<T> ParallelSliceMut<T> for [T] {
        fn par_iter_mut(&mut self) -> std::slice::IterMut<'_, T> {
            self.iter_mut()
        }
        fn par_chunks_mut(&mut self, size: usize) -> std::slice::ChunksMut<'_, T> {
            self.chunks_mut(size)
        }
        fn par_sort_unstable(&mut self)
        where
            T: Ord,
        {
            self.sort_unstable();
        }
    }

    /// Methods that iterators have not.
    pub trait ParallelIterator: Iterator + Sized {
        /// `map`, with something that a thread makes once.
        fn map_init<R, S>(
            self,
            init: impl Fn() -> R,
            mut each: impl FnMut(&mut R, Self::Item) -> S,
        ) -> impl Iterator<Item = S> {
            let mut room = init();
            self.map(move |item| each(&mut room, item))
        }

        /// `flat_map`.
        fn flat_map_iter<I: IntoIterator>(
            self,
            each: impl FnMut(Self::Item) -> I,
        ) -> impl Iterator<Item = I::Item> {
            self.flat_map(each)
        }

        /// Itself: one thread does not share.
        fn with_min_len(self, _: usize) -> Self {
            self
        }
    }

    impl<I: Iterator> ParallelIterator for I {}
}

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
                use rayon::prelude::*;
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
