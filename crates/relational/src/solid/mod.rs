//! Solids: blocks between surfaces, nets and moving sections, for volume meshes.

mod blend;
mod face;
mod layers;
mod loft;
mod moved;
mod net;

pub use blend::BlendSolid;
pub use face::FaceSurf;
pub use loft::{BLoftSolid, CLoftSolid, RuledSolid};
pub use moved::{SweepSolid, TranSolid};
pub use net::BSolid;
