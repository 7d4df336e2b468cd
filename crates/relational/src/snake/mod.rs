//! Snakes: curves on surfaces, defined in the surface's parameter plane.

mod contact;
mod foil;
mod isoparametric;
mod more;
mod on_surface;
mod through;

pub use contact::ContactSnake;
pub use foil::FoilSnake;
pub use isoparametric::{EdgeSnake, UVSnake, edge, edge_trace};
pub use more::{ArcSnake, CSnake, ConicSnake, CopySnake, NURBSnake, RelSnake};
pub use on_surface::{OnSurface, PathOnSurface};
pub use through::{BSnake, LineSnake, on_surface};
