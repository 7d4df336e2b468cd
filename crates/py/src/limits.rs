//! The limits of the process.

use moldloft::budget::Limits;
use pyo3::prelude::*;

/// Memory as the machine has it.
pub fn take_usual() {
    let memory = moldloft::budget::usual_memory();
    moldloft::budget::set_limits(Limits { memory, ..Limits::USUAL });
}

/// Bytes, steps, objects and seconds that a run may use.
#[pyfunction]
pub fn limits() -> (u64, u64, u64, f64) {
    let Limits { memory, steps, objects, seconds } = moldloft::budget::limits();
    (memory, steps, objects, seconds)
}

/// Sets the limits of runs.
#[pyfunction]
pub fn set_limits(memory: u64, steps: u64, objects: u64, seconds: f64) {
    moldloft::budget::set_limits(Limits { memory, steps, objects, seconds });
}

/// Bytes that the extension holds; NumPy's arrays are not counted.
#[pyfunction]
pub fn held_memory() -> u64 {
    moldloft::budget::held()
}
