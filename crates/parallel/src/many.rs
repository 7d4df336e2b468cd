//! Loops on all threads of this process: Rayon's iterators, with each method that runs one taken to the pool.

use crate::pool::in_pool;
use rayon::iter::{
    Enumerate, FlatMapIter, FromParallelIterator, IndexedParallelIterator, Map, MapInit, MinLen,
    Zip,
};
use rayon::prelude::{
    IntoParallelIterator as RayonItems, ParallelIterator as RayonIterator,
    ParallelSlice as RayonSlice, ParallelSliceMut as RayonSliceMut,
};
use rayon::slice::{Chunks, ChunksMut, Iter, IterMut};

/// An iterator over items that all threads share.
#[derive(Clone, Debug)]
#[must_use = "an iterator does nothing until it is collected"]
pub struct Parallel<I>(I);

/// `into_par_iter`.
pub trait IntoParallelIterator: RayonItems + Sized {
    /// The items, shared among threads.
    fn into_par_iter(self) -> Parallel<Self::Iter> {
        Parallel(RayonItems::into_par_iter(self))
    }
}

impl<I: RayonItems> IntoParallelIterator for I {}

/// Methods of slices.
pub trait ParallelSlice<T: Sync> {
    /// `iter`.
    fn par_iter(&self) -> Parallel<Iter<'_, T>>;
    /// `chunks`.
    fn par_chunks(&self, size: usize) -> Parallel<Chunks<'_, T>>;
}

impl<T: Sync> ParallelSlice<T> for [T] {
    fn par_iter(&self) -> Parallel<Iter<'_, T>> {
        Parallel(RayonItems::into_par_iter(self))
    }
    fn par_chunks(&self, size: usize) -> Parallel<Chunks<'_, T>> {
        Parallel(RayonSlice::par_chunks(self, size))
    }
}

/// Methods of slices that change.
pub trait ParallelSliceMut<T: Send> {
    /// `iter_mut`.
    fn par_iter_mut(&mut self) -> Parallel<IterMut<'_, T>>;
    /// `chunks_mut`.
    fn par_chunks_mut(&mut self, size: usize) -> Parallel<ChunksMut<'_, T>>;
    /// `sort_unstable`.
    fn par_sort_unstable(&mut self)
    where
        T: Ord;
}

impl<T: Send> ParallelSliceMut<T> for [T] {
    fn par_iter_mut(&mut self) -> Parallel<IterMut<'_, T>> {
        Parallel(RayonItems::into_par_iter(self))
    }
    fn par_chunks_mut(&mut self, size: usize) -> Parallel<ChunksMut<'_, T>> {
        Parallel(RayonSliceMut::par_chunks_mut(self, size))
    }
    fn par_sort_unstable(&mut self)
    where
        T: Ord,
    {
        in_pool(|| RayonSliceMut::par_sort_unstable(self));
    }
}

impl<I: RayonIterator> Parallel<I> {
    /// `map`.
    pub fn map<R: Send, F>(self, each: F) -> Parallel<Map<I, F>>
    where
        F: Fn(I::Item) -> R + Send + Sync,
    {
        Parallel(self.0.map(each))
    }

    /// `map`, with something that a thread makes once.
    pub fn map_init<S, R: Send, G, F>(self, init: G, each: F) -> Parallel<MapInit<I, G, F>>
    where
        G: Fn() -> S + Send + Sync,
        F: Fn(&mut S, I::Item) -> R + Send + Sync,
    {
        Parallel(self.0.map_init(init, each))
    }

    /// `flat_map`.
    pub fn flat_map_iter<R, F>(self, each: F) -> Parallel<FlatMapIter<I, F>>
    where
        R: IntoIterator<Item: Send>,
        F: Fn(I::Item) -> R + Send + Sync,
    {
        Parallel(self.0.flat_map_iter(each))
    }

    /// `for_each`.
    pub fn for_each(self, each: impl Fn(I::Item) + Send + Sync) {
        in_pool(|| self.0.for_each(each));
    }

    /// `try_for_each`: the first failure, in time, ends the loop.
    ///
    /// # Errors
    /// That failure.
    pub fn try_for_each<E: Send>(
        self,
        each: impl Fn(I::Item) -> Result<(), E> + Send + Sync,
    ) -> Result<(), E> {
        in_pool(|| self.0.try_for_each(each))
    }

    /// `collect`.
    pub fn collect<C: FromParallelIterator<I::Item> + Send>(self) -> C {
        in_pool(|| self.0.collect())
    }
}

impl<I: IndexedParallelIterator> Parallel<I> {
    /// `enumerate`.
    pub fn enumerate(self) -> Parallel<Enumerate<I>> {
        Parallel(self.0.enumerate())
    }

    /// `zip`.
    pub fn zip<Z>(self, other: Z) -> Parallel<Zip<I, Z::Iter>>
    where
        Z: RayonItems<Iter: IndexedParallelIterator>,
    {
        Parallel(self.0.zip(other))
    }

    /// No thread is given fewer items.
    pub fn with_min_len(self, len: usize) -> Parallel<MinLen<I>> {
        Parallel(self.0.with_min_len(len))
    }
}

impl<I: RayonIterator> RayonItems for Parallel<I> {
    type Iter = I;
    type Item = I::Item;
    fn into_par_iter(self) -> I {
        self.0
    }
}
