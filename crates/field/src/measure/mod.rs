//! Integrals over sets: proved brackets by ranges, best values by curved facets, and their derivatives.

pub(crate) mod certified;
pub(crate) mod curved;
pub(crate) mod implicit_derivatives;
pub(crate) mod mass;
pub(crate) mod moments;
pub(crate) mod moved;
mod polytope;
pub(crate) mod taylor;
