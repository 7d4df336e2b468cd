//! The intrinsics of the array language: distributions, splines, measures, moves, meetings,
//! structured grids.
//!
//! Each is a documented struct whose fields are its arguments; the derive macro generates its row
//! of the registry. A new function needs a struct and a line in [`rows`]. All are generic over the
//! scalar and propagate derivatives.
//!
//! `farray, curve, surface (arrays); pcurve, psurface (shapes) -> intrinsic -> array or shape`
//!
//! Only `value` depends on the representation of arrays.
//!
//! Invariant: no dependency on graph, language or files.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
// `!(a > b)` refuses NaN, `a <= b` lets it pass.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod curvature;
mod distribution;
mod evaluate;
mod grids;
mod locate;
mod marching;
mod masks;
mod moves;
mod reduce;
mod section_grids;
mod shape;
mod spacing;
mod spline;
mod texts;
mod value;
mod volumes;

pub use distribution::halved;
pub use value::{MORE_MEMORY, gathered, type_name, within_share};

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
        reduce::Prod,
        reduce::Argmin,
        reduce::Argmax,
        reduce::Dot,
        reduce::Norm,
        reduce::Len,
        reduce::Cumlen,
        reduce::Centroid,
        reduce::BboxMin,
        reduce::BboxMax,
        masks::Where,
        masks::Clamp,
        masks::Any,
        masks::All,
        masks::Find,
        masks::Sort,
        masks::CumSum,
        masks::Diff,
        masks::Interp,
        texts::CutText,
        texts::NumberOf,
        texts::Replace,
        texts::SplitText,
        texts::TrimText,
        texts::Lower,
        texts::Upper,
        texts::Append,
        shape::List,
        shape::PointsOf,
        shape::Concatenation,
        shape::Stack,
        shape::Reverse,
        shape::Swap,
        shape::SpreadI,
        shape::SpreadJ,
        shape::D1,
        shape::D2,
        moves::Translate,
        moves::Scale,
        moves::Mirror,
        moves::Rotate,
        moves::Revolve,
        moves::Tangents,
        moves::FrameOf,
        curvature::Curvatures,
        curvature::Torsions,
        curvature::Gauss,
        curvature::Mean,
        curvature::Normals,
        locate::Closest,
        locate::Project,
        locate::Intersect,
        locate::Intersections,
        grids::Tfi,
        grids::EllipticGrid,
        marching::HyperbolicGrid,
        volumes::EllipticBlock,
        section_grids::OGrid,
        section_grids::CGrid,
        section_grids::HGrid,
        grids::QualityOf,
        grids::Folds,
        grids::Report,
    ]
}
