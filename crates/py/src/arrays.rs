//! Vectors and NumPy arrays.

use crate::error::plain_error;
use moldloft::budget::{Budget, Spent};
use moldloft::num::Vec3;
use numpy::ndarray::Dimension;
use numpy::{PyArray, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use std::ptr::NonNull;

/// Numbers, a whole number of threes, as vectors.
fn vectors(numbers: &mut [f64]) -> &mut [Vec3] {
    // SAFETY: Vec3<f64> is repr(C) with three f64 and nothing else, of the same alignment, so 3 n
    // numbers are n vectors; a remainder of one or two numbers is left out.
    #[allow(unsafe_code)]
    unsafe {
        std::slice::from_raw_parts_mut(numbers.as_mut_ptr().cast(), numbers.len() / 3)
    }
}

/// The most points of one array.
const MOST_POINTS: usize = 1 << 27;

/// Refuses more points, of `bytes` each, than the limits allow, before any allocation: neither Rust
/// nor NumPy could give a proper error later.
pub fn room(shape: [usize; 2], bytes: usize) -> PyResult<usize> {
    let [m, n] = shape;
    let count = m.checked_mul(n).filter(|count| *count <= MOST_POINTS);
    let count = count
        .ok_or_else(|| plain_error(format!("{m} x {n} are more than {MOST_POINTS} points")))?;
    // At most 2^27 times some hundred.
    let bytes = count * bytes;
    let spent =
        |spent: Spent| plain_error(format!("{m} x {n} points: {spent}\nhelp: {}", spent.help()));
    Budget::default().grow(bytes as u64).map_err(spent)?;
    let tried = Vec::<u8>::new().try_reserve_exact(bytes);
    tried.map_err(|_| spent(Spent::Refused))?;
    Ok(count)
}

/// A new array of vectors, its last extent 3, without other references: another thread fills it,
/// and interrupted work keeps it alive.
pub struct Unshared<D> {
    array: Py<PyArray<f64, D>>,
    first: NonNull<f64>,
    count: usize,
}

// SAFETY: the numbers belong to the array, which lives as long as this and is not handed out before; a reference to an
// object of Python may be moved and dropped in any thread.
#[allow(unsafe_code)]
unsafe impl<D> Send for Unshared<D> {}

impl<D: Dimension> Unshared<D> {
    /// Zeros; the system gives memory for them as they are written.
    pub fn new(py: Python<'_>, shape: impl numpy::ndarray::IntoDimension<Dim = D>) -> Self {
        let array = PyArray::<f64, D>::zeros(py, shape, false);
        let (first, count) =
            (NonNull::new(array.data()).unwrap_or(NonNull::dangling()), array.len());
        Self { array: array.unbind(), first, count }
    }

    /// The vectors.
    pub fn vectors(&mut self) -> &mut [Vec3] {
        // SAFETY: a new array is contiguous, and nobody else has it.
        #[allow(unsafe_code)]
        vectors(unsafe { std::slice::from_raw_parts_mut(self.first.as_ptr(), self.count) })
    }

    /// The array, filled.
    pub fn shared(self, py: Python<'_>) -> Bound<'_, PyArray<f64, D>> {
        self.array.into_bound(py)
    }
}

/// A new array of vectors, its last extent 3, filled by `fill` without a copy.
pub fn filled<'py, D: Dimension, R>(
    py: Python<'py>,
    shape: impl numpy::ndarray::IntoDimension<Dim = D>,
    fill: impl FnOnce(&mut [Vec3]) -> R,
) -> (Bound<'py, PyArray<f64, D>>, R) {
    let array = PyArray::<f64, D>::zeros(py, shape, false);
    let result = {
        let mut access = array.readwrite();
        let slice = access.as_slice_mut().expect("a new array is contiguous");
        fill(vectors(slice))
    };
    (array, result)
}
