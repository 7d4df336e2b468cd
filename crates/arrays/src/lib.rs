//! The intrinsics of the array language: distributions, splines and their evaluation.
//!
//! Each is a documented struct whose fields are its arguments and which builds its value; the
//! derive macro makes a row of the registry of it. Adding one is adding a struct and a line in
//! [`rows`]. All are generic over the scalar, so derivatives flow through every one.
//!
//! `farray, curve, surface (arrays); pcurve, psurface (shapes) -> intrinsic -> array or shape`
//!
//! How arrays are held is known to `value` only.
//!
//! Invariant: this crate knows no graph, no language and no file.

mod distribution;
mod evaluate;
mod spacing;
mod spline;
mod value;

use moldloft_registry::Row;
use moldloft_registry::export::StaticRow;

macro_rules! rows {
    ($($kind:path),* $(,)?) => {
        vec![$({
            use $kind as Kind;
            <Kind<f64> as StaticRow>::row()
        }),*]
    };
}

/// All functions of this crate, in the order of the reference.
///
/// # Example
/// ```
/// let rows = moldloft_arrays::rows();
/// assert!(rows.iter().any(|row| row.name == "d_tanhx" && !row.kind));
/// ```
pub fn rows() -> Vec<Row> {
    rows![
        distribution::Uniform,
        distribution::Cosine,
        distribution::Geometric,
        distribution::Geometric2,
        distribution::DSinh,
        distribution::DTanh,
        distribution::DTanhX,
        distribution::Redist,
        spacing::CountFor,
        spacing::FirstFor,
        spacing::FirstCell,
        spacing::LastCell,
        spacing::Growth,
        spline::Makecc,
        spline::Makelc,
        spline::Makecs,
        spline::Makels,
        evaluate::Distc,
        evaluate::Dists,
        evaluate::Evalc,
        evaluate::Evals,
        evaluate::Derivc,
        evaluate::Derivs,
        evaluate::Curvc,
        evaluate::Lengthc,
        evaluate::Length,
    ]
}
