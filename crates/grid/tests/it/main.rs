//! Structured grids against closed forms.

// `!(a > b)` catches NaN, `a <= b` lets it pass.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod fronts;
mod grids;
mod marching;
mod pole_cells;
mod sections;
mod surfaces;
mod volumes;
mod walls;
