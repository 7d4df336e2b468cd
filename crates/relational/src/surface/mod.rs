//! Surfaces: lofts, revolutions, translations, and those made from other surfaces.

mod bloft;
mod bsurf;
mod chunk;
mod cloft;
mod linear;
mod masters;
mod mirrored;
mod revolved;
mod ruled;
mod sub;
mod translated;

pub use bloft::BLoftSurf;
pub use bsurf::BSurf;
pub use cloft::CLoftSurf;
pub use mirrored::MirrSurf;
pub use revolved::RevSurf;
pub use ruled::RuledSurf;
pub use sub::SubSurf;
pub use translated::TranSurf;
