//! One curve to be faired: what its control points mean, how points become a spline, what may move
//! how far, and the step of knot removal.

pub(crate) mod bends;
mod bernstein;
pub(crate) mod breaks;
pub(crate) mod centre;
pub(crate) mod chain;
pub(crate) mod condition;
pub(crate) mod corners;
pub(crate) mod data;
pub(crate) mod demand;
mod draft;
pub(crate) mod exact;
pub(crate) mod fit;
pub(crate) mod job;
pub(crate) mod jumps;
pub(crate) mod knot_removal;
pub(crate) mod layout;
pub(crate) mod least_squares;
pub(crate) mod limit;
pub(crate) mod monotone;
pub(crate) mod moving;
pub(crate) mod multilevel;
pub(crate) mod near;
pub(crate) mod request;
pub(crate) mod shape_condition;
pub(crate) mod shaping;
pub(crate) mod space;
pub(crate) mod thinning;
pub(crate) mod turning;
