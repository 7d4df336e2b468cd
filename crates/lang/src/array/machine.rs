//! State that a run keeps for array expressions: memory and tapes.

use moldloft_elementwise::Tape;
use moldloft_num::Real;
use moldloft_registry::Value;
use std::sync::Arc;

/// The memory of array expressions.
#[derive(Debug)]
pub(crate) struct ArrayMachine<T: Real> {
    /// Tapes that are not in use.
    pub tapes: Vec<Tape<T>>,
    pub spare: Spare<T>,
    /// True to apply operators one after the other.
    pub plain_operators: bool,
    /// True to let infinite results and NaN pass.
    pub ieee: bool,
}

impl<T: Real> Default for ArrayMachine<T> {
    fn default() -> Self {
        Self { tapes: Vec::new(), spare: Spare::default(), plain_operators: false, ieee: false }
    }
}

/// Rows of memory that are not in use: a statement that makes an array of the size of one that was
/// replaced takes its memory.
#[derive(Debug)]
pub(crate) struct Spare<T> {
    rows: Vec<Vec<T>>,
}

impl<T> Default for Spare<T> {
    fn default() -> Self {
        Self { rows: Vec::new() }
    }
}

/// The most rows that are kept, and the most elements of all.
const MOST_SPARE: usize = 12;
const MOST_SPARE_ELEMENTS: usize = 16_000_000;

impl<T: Real> Spare<T> {
    /// A row of `n` elements of any content.
    pub fn take(&mut self, n: usize) -> Vec<T> {
        match self.rows.iter().rposition(|row| row.len() == n) {
            Some(at) => self.rows.swap_remove(at),
            None => vec![T::zero(); n],
        }
    }

    /// Keeps the memory of a value that nobody else holds.
    pub fn give(&mut self, value: Value<T>) {
        match value {
            Value::Numbers(a) => {
                if let Ok(array) = Arc::try_unwrap(a) {
                    self.keep(array.items);
                }
            }
            Value::Vectors(a) => {
                if let Ok(array) = Arc::try_unwrap(a) {
                    array.planes.into_iter().for_each(|plane| self.keep(plane));
                }
            }
            _ => {}
        }
    }

    /// Keeps a row.
    pub fn keep(&mut self, row: Vec<T>) {
        if self.rows.len() >= MOST_SPARE {
            self.rows.remove(0);
        }
        let held: usize = self.rows.iter().map(Vec::len).sum();
        if held + row.len() <= MOST_SPARE_ELEMENTS {
            self.rows.push(row);
        }
    }
}
