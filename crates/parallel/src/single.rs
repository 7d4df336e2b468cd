//! The same loops on one thread: plain iterators.

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

/// Methods of parallel iterators that sequential ones lack.
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
