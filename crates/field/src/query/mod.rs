//! Questions to sets: bounds, nearest points, distances, rays and pictures.

pub(crate) mod bounds;
pub(crate) mod distance;
pub(crate) mod foot;
pub(crate) mod nearest;
pub(crate) mod ray;
pub(crate) mod ray_index;
pub(crate) mod ray_trace;
pub(crate) mod separation;
