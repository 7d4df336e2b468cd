//! Curves through and near points, and curves made from others.

mod arc;
mod bcurve;
mod ccurve;
mod conic;
mod ended;
mod foil;
mod helix;
mod line;
mod mirrored;
mod poly;
mod sub;

pub use arc::Arc;
pub use bcurve::BCurve;
pub use ccurve::CCurve;
pub use conic::Conic;
pub use ended::Ended;
pub use foil::FoilCurve;
pub use helix::Helix;
pub use line::{Line, Segment};
pub use mirrored::MirrCurve;
pub use poly::{PolyCurve, PolySnake};
pub use sub::{SubCurve, SubSnake};
