//! Structured grids against closed forms.

mod grids;
mod marching;
