//! Curves through and near points, and curves made from others.

mod arc;
mod bcurve;
mod ccurve;
mod ended;
mod line;
mod mirrored;
mod sub;

pub use arc::Arc;
pub use bcurve::BCurve;
pub use ccurve::CCurve;
pub use ended::Ended;
pub use line::{Line, Segment};
pub use mirrored::MirrCurve;
pub use sub::{SubCurve, SubSnake};
