//! Curves through and near points, and curves made from others.

mod arc;
mod bcurve;
mod ccurve;
mod conic;
mod ended;
mod explicit;
pub mod fitted;
mod foil;
mod helix;
mod join;
mod line;
mod mirrored;
mod nurbs;
mod offset;
mod poly;
mod relative;
mod sub;
pub mod swept;

pub use arc::Arc;
pub use bcurve::BCurve;
pub use ccurve::{CCurve, clamped_ends};
pub use conic::{Conic, Oblique};
pub use ended::Ended;
pub use explicit::XCurve;
pub use fitted::{BFitCurve, NUBFitCurve};
pub use foil::FoilCurve;
pub use helix::Helix;
pub use join::Join;
pub use line::{Line, Segment};
pub use mirrored::MirrCurve;
pub use nurbs::{NURBCurve, spline};
pub use offset::OffsetCurve;
pub use poly::{PolyCurve, PolySnake, shares};
pub use relative::{CopyCurve, Moved, RelCurve, RotatCurve};
pub use sub::{BSubCurve, BSubSnake, SubCurve, SubSnake};
pub use swept::ProcCurve;
