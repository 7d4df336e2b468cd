//! Surfaces: lofts, revolutions, sweeps, patches between curves, fillets, and those made from other
//! surfaces.

mod arcloft;
mod bloft;
mod bsurf;
mod chunk;
mod cloft;
mod column;
mod coons;
mod corners;
mod fillet;
mod free_knots;
mod linear;
mod mapped;
mod masters;
mod mirrored;
mod revolved;
mod ribbon;
mod ruled;
mod sub;
mod sweep;
mod translated;

pub use arcloft::ArcLoftSurf;
pub use bloft::BLoftSurf;
pub use bsurf::{BSurf, NURBSurf};
pub use cloft::{CLoftSurf, XLoftSurf};
pub use coons::{BlendCenter, BlendSurf};
pub use fillet::FilletSurf;
pub use mapped::{CopySurf, ProjSurf, RelSurf, RotatSurf};
pub use mirrored::MirrSurf;
pub use revolved::RevSurf;
pub use ruled::RuledSurf;
pub use sub::SubSurf;
pub use sweep::{Mode, Moving, SweepSurf};
pub use translated::TranSurf;
