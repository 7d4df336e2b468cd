//! What a run may use, and how much of it is used.

/// Counts of a run, compared with the limits in [`super::interpreter`].
#[derive(Debug, Default)]
pub(crate) struct Budget {
    /// Statements and calls, and the elements of values.
    pub steps: u64,
    /// How deep statements, expressions and calls nest.
    pub depth: u32,
    /// Elements of the declared arrays.
    pub held: usize,
    /// Bytes that were printed.
    pub printed: usize,
    /// Errors that were reported.
    pub errors: usize,
}
